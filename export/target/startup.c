/* Start of a Cortex-M program on QEMU's MPS2 boards, bare metal, with input and output by semihosting. */
#include <stdint.h>

extern uint32_t stack_top, data_start, data_end, data_load, bss_start, bss_end;
extern void initialise_monitor_handles(void);
extern int main(void);
extern void exit(int status) __attribute__((noreturn));

void reset_handler(void);
void fault_handler(void);
void _init(void);
void _fini(void);

void _init(void) {}
void _fini(void) {}

void fault_handler(void)
{
    exit(99);
}

void reset_handler(void)
{
    volatile uint32_t *const coprocessor_access = (volatile uint32_t *)0xE000ED88U;
    *coprocessor_access |= 0xFU << 20;
    __asm volatile("dsb\nisb");
    for (uint32_t *to = &data_start, *from = &data_load; to < &data_end; to++, from++) {
        *to = *from;
    }
    for (uint32_t *to = &bss_start; to < &bss_end; to++) {
        *to = 0U;
    }
    initialise_monitor_handles();
    exit(main());
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void))&stack_top, reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
};
