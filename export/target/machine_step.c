/* One interface before every exported controller: seven doubles a sample in, one double out. The readings are the demand, the
 * hub's sensor, the platform's rate, the platform's acceleration, the motor's rate, the hub's position and the surge, in SI
 * units; a sensor that is not fitted reads 0. With MACHINE_PROGRAM it is a program that does so from its standard input to its
 * standard output, in the machine's own byte order. */
#include "axis.h"
#include "axis.c"

static axis_state state;

void machine_start(void);
double machine_step(const double in[7]);

void machine_start(void)
{
    axis_init(&state);
}

double machine_step(const double in[7])
{
    axis_readings r;
    axis_real *const each = (axis_real *)&r;
    for (unsigned int i = 0; i < sizeof r / sizeof each[0]; i++) {
        each[i] = (axis_real)in[i];
    }
    return (double)axis_step(&state, &r);
}

#ifdef MACHINE_PROGRAM
#include <stdio.h>

int main(void)
{
    double in[7];
    machine_start();
    while (fread(in, sizeof in, 1, stdin) == 1) {
        const double out = machine_step(in);
        if (fwrite(&out, sizeof out, 1, stdout) != 1 || fflush(stdout) != 0) {
            return 1;
        }
    }
    return 0;
}
#endif
