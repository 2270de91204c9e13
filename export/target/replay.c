/* Replays readings through a controller called axis: seven doubles a sample in, one double out, in the machine's own byte
 * order. A sample whose first reading is no number starts the controller anew. */
#include <stdio.h>

#include "axis.h"

#ifdef AXIS_FIXED
typedef int32_t axis_real;
#endif

static axis_state state;

int main(void)
{
    double in[7];
    axis_init(&state);
    while (fread(in, sizeof in, 1, stdin) == 1) {
        double out = 0.0;
        if (!(in[0] >= 0.0) && !(in[0] < 0.0)) {
            axis_init(&state);
        } else {
            axis_readings r;
            axis_real *const each = (axis_real *)&r;
            for (unsigned int i = 0; i < sizeof r / sizeof each[0]; i++) {
                each[i] = (axis_real)in[i];
            }
            out = (double)axis_step(&state, &r);
        }
        if (fwrite(&out, sizeof out, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}
