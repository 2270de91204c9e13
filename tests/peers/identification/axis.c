/* A servo axis of one or two inertias for textbook.py: key=value arguments in, a recording as CSV out.

   Bodies with dry friction are stopped by Moreau's time stepping: a step first moves a body without its friction, and friction then takes away
   as much of its rate as its level can within the step. Nothing of it is taken from the product. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int count;
static char **words;

static double get(const char *key, double absent) {
    size_t n = strlen(key);
    for (int i = 1; i < count; i++)
        if (!strncmp(words[i], key, n) && words[i][n] == '=') return atof(words[i] + n + 1);
    return absent;
}

static unsigned long long seed_state = 88172645463325252ULL;

static double uniform(void) {
    seed_state ^= seed_state << 13;
    seed_state ^= seed_state >> 7;
    seed_state ^= seed_state << 17;
    return (seed_state >> 11) / 9007199254740992.0;
}

static double normal(void) {
    double a = uniform(), b = uniform();
    return sqrt(-2 * log(a + 1e-300)) * cos(6.283185307179586 * b);
}

static double stopped(double rate, double change) { return fabs(rate) <= change ? 0 : rate - copysign(change, rate); }

int main(int argc, char **argv) {
    count = argc;
    words = argv;
    /* sampling and machine, SI units; the hub's angle x, the motor's angle y = ratio x where the transmission is rigid */
    double period = get("period", 1e-3), length = get("length", 10);
    int steps = (int)get("steps", 100);
    double h = period / steps;
    double rotor = get("rotor", 0), ratio = get("ratio", 1), spring = get("stiffness", 0), damping = get("damping", 0), inertia = get("inertia", 1);
    double viscous_m = get("motor_viscous", 0), viscous = get("viscous", 0), dry_m = get("motor_coulomb", 0), dry = get("coulomb", 0);
    double moment = get("out_of_balance", 0), kt = get("torque_constant", 1);
    double voltage = get("voltage_drive", 0), R = get("resistance", 1), L = get("inductance", 0), gain = get("gain", 1), lag = get("bandwidth", 0);
    double limit = get("current_limit", 1e9);
    /* what may be concealed */
    double base_spring = get("spring", 0), bump = get("bump", 0), bump_at = get("bump_at", 0), bump_width = get("bump_width", 0.1);
    double stribeck = get("stribeck", 0), stribeck_rate = get("stribeck_rate", 0.05), drift = get("drift", 0), cubic = get("cubic", 0);
    double cogging = get("cogging", 0), order = get("order", 12), kt_wave = get("kt_wave", 0), hard = get("hard", 0);
    int late = (int)get("late", 0);
    /* controller: e = demand - reading, or kp (demand - reading) - rate where position = 1; u = kv e + q, q += ki T e unless u is limited */
    double kp = get("kp", 0), kv = get("kv", 1), ki = get("ki", 0), step = get("converter", 20.0 / 65536);
    int position = (int)get("position", 0), on_motor = (int)get("on_motor", 0);
    double count_rad = get("count", 0), noise = get("noise", 0), sensor = get("sensor", 0);
    double f1 = get("f1", 0.5), a1 = get("a1", 1), f2 = get("f2", 0), a2 = get("a2", 0), triangle = get("triangle", 0), ft = get("ft", 0.2);
    double square = get("square", 0), fs = get("fs", 0.25);
    seed_state += (unsigned long long)(get("seed", 1) * 1e12);
    for (int i = 0; i < 20; i++) uniform();

    double x = 0, v = 0, y = 0, w = 0, current = 0, q = 0, before = 0, u = 0, s1 = 0, s2 = 0, past[64] = {0};
    printf("time,demand,control,reading\n");
    for (int k = 0; k < (int)(length / period + 0.5); k++) {
        double t = k * period;
        double truth = position ? (on_motor ? y / ratio : x) : (on_motor ? w / ratio : v);
        double reading = (sensor > 0 ? s1 : truth) + noise * normal();
        if (count_rad > 0) reading = count_rad * floor(reading / count_rad + 0.5);
        double demand = a1 * sin(2 * M_PI * f1 * t) + a2 * sin(2 * M_PI * f2 * t + 1);
        double phase = fmod(ft * t, 1);
        demand += triangle * (phase < 0.25 ? 4 * phase : phase < 0.75 ? 2 - 4 * phase : 4 * phase - 4);
        demand += square * (fmod(fs * t, 1) < 0.5 ? 1 : -1);
        if (t < 0.05) demand *= t / 0.05;
        if (k == 0) before = reading;
        double error = position ? kp * (demand - reading) - (reading - before) / period : demand - reading;
        before = reading;
        double wanted = kv * error + q;
        if (fabs(wanted) < 10) q += ki * period * error;
        u = fmax(-10, fmin(10, wanted));
        if (step > 0) u = step * floor(u / step + 0.5);
        printf("%.9g,%.9g,%.9g,%.12g\n", t, demand, u, reading);
        past[k % 64] = u;
        double applied = k >= late ? past[(k - late + 64) % 64] : 0;
        for (int j = 0; j < steps; j++) {
            double wave = 1 + kt_wave * sin(order * (spring > 0 ? y : ratio * x)), torque;
            if (voltage > 0) {
                double back = kt * wave * (spring > 0 ? w : ratio * v);
                if (L > 0) current += h * (applied * gain - R * current - back) / L;
                else current = (applied * gain - back) / R;
                current = fmax(-limit, fmin(limit, current));
            } else {
                double command = fmax(-limit, fmin(limit, applied * gain));
                current = lag > 0 ? current + (1 - exp(-lag * h)) * (command - current) : command;
            }
            torque = kt * wave * current + cogging * sin(order * (spring > 0 ? y : ratio * x) + 0.4);
            double level = dry * (1 + drift * (t + j * h)) * (1 + bump * exp(-0.5 * pow((x - bump_at) / bump_width, 2)));
            level *= 1 + stribeck * exp(-pow(v / stribeck_rate, 2));
            double outer = -moment * 9.80665 * cos(x) - base_spring * x - hard * x * x * x - viscous * v - cubic * v * v * v;
            if (spring > 0) {
                double mesh = spring * (y / ratio - x) + damping * (w / ratio - v);
                w = stopped(w + h * (torque - mesh / ratio - viscous_m * w) / rotor, h * dry_m / rotor);
                v = stopped(v + h * (mesh + outer) / inertia, h * level / inertia);
                y += h * w;
                x += h * v;
            } else {
                double whole = inertia + rotor * ratio * ratio;
                v += h * (torque * ratio + outer - viscous_m * ratio * ratio * v) / whole;
                v = stopped(v, h * (level + dry_m * ratio) / whole);
                x += h * v;
                w = ratio * v;
                y = ratio * x;
            }
            if (sensor > 0) {
                double input = position ? (on_motor ? y / ratio : x) : (on_motor ? w / ratio : v);
                s2 += h * (sensor * sensor * (input - s1) - 1.4 * sensor * s2);
                s1 += h * s2;
            }
        }
    }
    return 0;
}
