/* Runs the self test of a controller called axis and counts the instructions of a step: with QEMU's -icount shift=0 the
 * system timer ticks once every 40 instructions. On a board the same timer counts cycles: set INSTRUCTIONS_A_TICK to 1. */
#include <stdint.h>
#include <stdio.h>

#include "axis.h"

#define ROUNDS 1000
#define PATTERNS 5
#define INSTRUCTIONS_A_TICK 40

static volatile uint32_t *const control = (volatile uint32_t *)0xE000E010U;
static volatile uint32_t *const reload = (volatile uint32_t *)0xE000E014U;
static volatile uint32_t *const current = (volatile uint32_t *)0xE000E018U;

#ifdef AXIS_FIXED
int axis_self_test(void);
typedef int32_t axis_real;
#else
int axis_self_test(axis_real *largest_difference_v);
#endif

static axis_state state;
static axis_readings in;
static axis_real set;

/* What the timer counts. */
typedef enum { STEP, SET, NOTHING } work;

__attribute__((noinline)) static void idle(axis_state *c, const axis_readings *r)
{
    __asm volatile("" : : "r"(c), "r"(r) : "memory");
}

/* Readings of a pattern: rest, each sign, alternating, and ever larger up to the limiter. */
static void read(int pattern, int k)
{
    static const int signs[PATTERNS] = { 0, 1, -1, 1, 1 };
    const int sign = (pattern == 3) && ((k & 1) != 0) ? -1 : signs[pattern];
    const int size = (pattern == 4) ? 1 + k / 100 : 1;
    const axis_real value = (axis_real)(sign * size);
    axis_real *const each = (axis_real *)&in;
    for (unsigned int i = 0; i < sizeof in / sizeof value; i++) {
        each[i] = value;
    }
    set = (axis_real)(20 * sign * size);
}

static unsigned long ticks(work what, int pattern)
{
    *reload = 0xFFFFFFU;
    *current = 0U;
    *control = 5U;
    for (int k = 0; k < ROUNDS; k++) {
        read(pattern, k);
        if (what == STEP) {
            (void)axis_step(&state, &in);
        } else if (what == SET) {
            axis_set_out_of_balance(&state, set);
        } else {
            idle(&state, &in);
        }
    }
    const uint32_t now = *current;
    *control = 0U;
    return 0xFFFFFFUL - now;
}

/* The largest count of a call over all patterns. */
static unsigned long largest(work what)
{
    unsigned long most = 0UL;
    for (int pattern = 0; pattern < PATTERNS; pattern++) {
        axis_init(&state);
        const unsigned long with = ticks(what, pattern);
        const unsigned long without = ticks(NOTHING, pattern);
        const unsigned long each = (with - without) * INSTRUCTIONS_A_TICK / ROUNDS;
        most = (each > most) ? each : most;
    }
    return most;
}

int main(void)
{
#ifdef AXIS_FIXED
    const int wrong = axis_self_test();
#else
    axis_real difference = 0;
    const int wrong = axis_self_test(&difference);
#endif
    printf("wrong %d step %lu set %lu state %lu\n", wrong, largest(STEP), largest(SET), (unsigned long)sizeof state);
    return wrong != 0;
}
