/* Runs the self test of a controller called axis and counts the instructions of a step: with QEMU's -icount shift=0 the
 * system timer ticks once every 40 instructions. */
#include <stdint.h>
#include <stdio.h>

#include "axis.h"

#define ROUNDS 4000
#define INSTRUCTIONS_A_TICK 40

static volatile uint32_t *const control = (volatile uint32_t *)0xE000E010U;
static volatile uint32_t *const reload = (volatile uint32_t *)0xE000E014U;
static volatile uint32_t *const current = (volatile uint32_t *)0xE000E018U;

#ifdef AXIS_FIXED
int axis_self_test(void);
#else
int axis_self_test(axis_real *largest_difference_v);
#endif

static axis_state state;
static axis_readings in;

__attribute__((noinline)) static void idle(axis_state *c, const axis_readings *r)
{
    __asm volatile("" : : "r"(c), "r"(r) : "memory");
}

static unsigned long ticks(int steps)
{
    *reload = 0xFFFFFFU;
    *current = 0U;
    *control = 5U;
    for (int k = 0; k < ROUNDS; k++) {
        if (steps) {
            (void)axis_step(&state, &in);
        } else {
            idle(&state, &in);
        }
    }
    const uint32_t now = *current;
    *control = 0U;
    return 0xFFFFFFUL - now;
}

int main(void)
{
#ifdef AXIS_FIXED
    const int wrong = axis_self_test();
#else
    axis_real largest = 0;
    const int wrong = axis_self_test(&largest);
#endif
    axis_init(&state);
    in.demand_rad_s = (__typeof__(in.demand_rad_s))1;
    in.hub_rate_rad_s = (__typeof__(in.hub_rate_rad_s))0.25;
    const unsigned long with = ticks(1);
    const unsigned long without = ticks(0);
    printf("wrong %d instructions %lu state_bytes %lu\n", wrong,
        (with - without) * INSTRUCTIONS_A_TICK / ROUNDS, (unsigned long)sizeof state);
    return wrong != 0;
}
