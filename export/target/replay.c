/* Replays readings through a controller called axis: six doubles a sample in, one double out, in the machine's own byte
 * order. A sample whose first reading is no number starts the controller anew. */
#include <stdio.h>

#include "axis.h"

#ifdef AXIS_FIXED
typedef int32_t axis_real;
#endif

static axis_state state;

int main(void)
{
    double in[6];
    axis_init(&state);
    while (fread(in, sizeof in, 1, stdin) == 1) {
        double out = 0.0;
        if (!(in[0] >= 0.0) && !(in[0] < 0.0)) {
            axis_init(&state);
        } else {
            axis_readings r;
            r.demand_rad_s = (axis_real)in[0];
            r.hub_rate_rad_s = (axis_real)in[1];
            r.platform_rate_rad_s = (axis_real)in[2];
            r.platform_accel_m_s2 = (axis_real)in[3];
            r.motor_rate_rad_s = (axis_real)in[4];
            r.hub_position_rad = (axis_real)in[5];
            out = (double)axis_step(&state, &r);
        }
        if (fwrite(&out, sizeof out, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}
