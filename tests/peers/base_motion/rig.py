#!/usr/bin/env python3
"""The reference rig on the full recorded motion, by a simulation that is independent of the product's.

    python3 -m venv .venv && .venv/bin/pip install numpy scipy pyarrow
    .venv/bin/python tests/peers/base_motion/rig.py target/release/counterpoise [--little-friction] [FOLDER]

For elevations of 0, 5 and 15 degrees it writes three projects from examples/reference-rig: one whose accelerometer stands upright, one whose
accelerometer stands on the elevated mass, and one with accelerometers of heave and surge on the platform, which the controller projects across the beam. The program designs and exports both. Their C code then controls the lumped rig here: classical
Runge-Kutta at 50 kHz, equations from the rig's description, sensors with noise, quantised converters. The road's columns are low-passed here with
SciPy. With --little-friction the rig has a tenth of its motor's and a small part of its pivot's Coulomb friction, so that what surge leaves is not
hidden under what friction leaves. Prints the RMS of the hub rate from 2 s on, without and with surge, beside what the program's own verification says. Exits with 1
unless surge with the elevated accelerometer, and with the projection of two, leaves at most 1.3 times the residual without surge at every elevation.
"""
import ctypes
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import numpy as np
import pyarrow.parquet as parquet
from scipy.signal import butter, sosfiltfilt

HERE = pathlib.Path(__file__).resolve().parents[3]
EXAMPLE = HERE / "examples/reference-rig"
ELEVATIONS = (0.0, 5.0, 15.0)
ALLOWED = 1.3
SETTLE_S = 2.0

PLANT = r"""
#include <math.h>
#include <stdint.h>
#include <string.h>
#include "controller.h"
typedef struct { double g, Jh, Jb, Kh, Dh, mu, nu, N, Kgb, Dgb, gap, Jm, Kt, Ke, R, L, Kv, Kifb, tau, limit, bus,
    Fm, sm, vm, Fp, sp, vp, wg, zg, wp, zp, wa, za, sg, ssp, sa, sr, sk, ng, np_, na, nm, nr, ibits, obits, T; } rig;
typedef struct { double angle, rate, heave, surge; } base;
enum { V, I, WM, DELTA, TH, WH, TB, WB, FM, FP, G0, G1, P0, P1, A0, A1, S0, S1, COUNT };
static double dead(double x, double c) { return fabs(x) <= c ? 0.0 : x - copysign(c, x); }
static double dahl(double F, double Fc, double s, double w) { return s * w * (1.0 - F / Fc * (w > 0 ? 1.0 : w < 0 ? -1.0 : 0.0)); }
static void slope(const rig *r, const double *x, double u, const base *b, int elevated, double *d) {
    double v = fmin(fmax(u, -r->limit), r->limit);
    double wm = x[WM], wh = x[WH], rel = wh - b->rate, dd = wm / r->N + b->rate - wh;
    double T2 = r->Kgb * dead(x[DELTA], 0.5 * r->gap) + (fabs(x[DELTA]) > 0.5 * r->gap ? r->Dgb * dd : 0.0);
    double Th = r->Kh * (x[TH] - x[TB]) + r->Dh * (wh - x[WB]), s = sin(x[TH]), c = cos(x[TH]), up = r->g + b->heave;
    double oob = r->mu * (up * c - b->surge * s) - r->nu * (up * s + b->surge * c);
    d[V] = (-x[V] + r->Kv * (v - r->Kifb * x[I])) / r->tau;
    if (fabs(x[V]) >= r->bus && d[V] * x[V] > 0.0) d[V] = 0.0;
    d[I] = (x[V] - r->R * x[I] - r->Ke * wm) / r->L;
    d[WM] = (r->Kt * x[I] - x[FM] - r->vm * wm - T2 / r->N) / r->Jm;
    d[DELTA] = dd;
    d[TH] = wh; d[TB] = x[WB];
    d[WH] = (T2 - Th - x[FP] - r->vp * rel - oob) / r->Jh;
    d[WB] = Th / r->Jb;
    d[FM] = dahl(x[FM], r->Fm, r->sm, wm);
    d[FP] = dahl(x[FP], r->Fp, r->sp, rel);
    double a = elevated ? b->heave * c - b->surge * s : b->heave;
    d[G0] = x[G1]; d[G1] = r->wg * r->wg * (wh - x[G0]) - 2 * r->zg * r->wg * x[G1];
    d[P0] = x[P1]; d[P1] = r->wp * r->wp * (b->rate - x[P0]) - 2 * r->zp * r->wp * x[P1];
    d[A0] = x[A1]; d[A1] = r->wa * r->wa * (a - x[A0]) - 2 * r->za * r->wa * x[A1];
    d[S0] = x[S1]; d[S1] = r->wa * r->wa * (b->surge - x[S0]) - 2 * r->za * r->wa * x[S1];
}
static double quantised(double value, double scale, double bits) {
    double step = 20.0 / exp2(bits), volts = fmin(fmax(value * scale, -10.0), 10.0);
    return round(volts / step) * step / scale;
}
/* base motion at half steps: 2 n steps + 1 rows a sample; noise: 6 a sample */
void simulate(const rig *r, int samples, int steps, const base *motion, const double *noise, double angle, int elevated, double *rate) {
    double x[COUNT] = {0}, k1[COUNT], k2[COUNT], k3[COUNT], k4[COUNT], y[COUNT], h = r->T / steps;
    double load = r->mu * r->g * cos(angle) - r->nu * r->g * sin(angle);
    x[TH] = x[TB] = angle;
    x[DELTA] = load / r->Kgb + copysign(0.5 * r->gap, load);
    x[I] = load / (r->N * r->Kt);
    x[V] = r->R * x[I];
    controller_state c;
    controller_init(&c);
    for (int k = 0; k < samples; k++) {
        const base *b = motion + (size_t)k * 2 * steps;
        const double *n = noise + 6 * (size_t)k;
        controller_readings in = {0};
        in.hub_rate_rad_s = quantised(x[G0] + r->ng * n[0], r->sg, r->ibits);
        in.platform_rate_rad_s = quantised(x[P0] + r->np_ * n[1], r->ssp, r->ibits);
        in.platform_accel_m_s2 = quantised(x[A0] + r->na * n[2], r->sa, r->ibits);
        in.motor_rate_rad_s = quantised(x[WM] + r->nm * n[3], r->sr, r->ibits);
        in.hub_position_rad = quantised(x[TH] - b->angle + r->nr * n[4], r->sk, r->ibits);
#ifdef PROJECTED
        in.platform_surge_m_s2 = quantised(x[S0] + r->na * n[5], r->sa, r->ibits);
#endif
        rate[k] = x[WH];
        double u = quantised(controller_step(&c, &in), 1.0, r->obits);
        for (int s = 0; s < steps; s++, b += 2) {
            slope(r, x, u, b, elevated, k1);
            for (int i = 0; i < COUNT; i++) y[i] = x[i] + 0.5 * h * k1[i];
            slope(r, y, u, b + 1, elevated, k2);
            for (int i = 0; i < COUNT; i++) y[i] = x[i] + 0.5 * h * k2[i];
            slope(r, y, u, b + 1, elevated, k3);
            for (int i = 0; i < COUNT; i++) y[i] = x[i] + h * k3[i];
            slope(r, y, u, b + 2, elevated, k4);
            for (int i = 0; i < COUNT; i++) x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
}
"""


def rig(project):
    p = project["plant"]
    lumped, gear, motor, amplifier = p["lumped"], p["gearbox"], p["motor"], p["amplifier"]
    fm, fp, s = p["friction"]["motor"], p["friction"]["pivot"], p["sensors"]
    gyros = [s["hub_gyro"], s["platform_gyro"], s["platform_accelerometer"]]
    others = [s["motor_tachometer"], s["hub_resolver"]]
    numbers = [p["gravity"], lumped["hub_inertia"], lumped["beam_inertia"], lumped["stiffness"], lumped["damping"]]
    numbers += [lumped["out_of_balance"], lumped["vertical_offset"], gear["ratio"], gear["stiffness"], gear["damping"]]
    numbers += [gear["backlash"], motor["inertia"], motor["torque_constant"], motor["back_emf_constant"]]
    numbers += [motor["resistance"], motor["inductance"], amplifier["gain"], amplifier["current_feedback"]]
    numbers += [amplifier["time_constant"], amplifier["input_limit"], amplifier["bus_voltage"]]
    for f in (fm, fp):
        numbers += [f["coulomb"], f["rest_stiffness"], f["viscous"]]
    for g in gyros:
        numbers += [g["natural_frequency"], g["damping_ratio"]]
    numbers += [g["scale"] for g in [*gyros, *others]] + [g["noise"] for g in [*gyros, *others]]
    face = p["interface"]
    return numbers + [face["input_bits"], face["output_bits"], face["sample_period"]]


def road(project, surge):
    """Heave, surge, pitch rate and pitch angle at half steps."""
    asked = project["verify"]["road"]
    table = parquet.read_table(EXAMPLE / asked["recording"])
    # a column is named "az [m/s^2]"
    table = table.rename_columns([name.split(" [")[0] for name in table.column_names])
    clock = table.column("time").to_numpy()
    period = (clock[-1] - clock[0]) / (len(clock) - 1)
    low = butter(4, asked["low_pass"], fs=1.0 / period, output="sos")
    first, count = round(asked["start"] / period), round(asked["duration"] / period) + 1

    def column(name, scale):
        part = scale * sosfiltfilt(low, table.column(name).to_numpy())[first : first + count]
        part = part - part.mean()
        edge = np.minimum(np.arange(count), np.arange(count)[::-1]) * period
        return part * np.where(edge >= asked["fade"], 1.0, 0.5 - 0.5 * np.cos(np.pi * edge / asked["fade"]))

    steps = 50
    samples = round(asked["duration"] / 1e-3)
    fine = np.arange(samples * 2 * steps + 1) * (1e-3 / (2 * steps))
    coarse = np.arange(count) * period
    smooth = lambda values: np.interp(fine, coarse, values)
    heave, rate = smooth(column(asked["heave"], asked["heave_scale"])), smooth(column(asked["pitch"], asked["pitch_scale"]))
    forward = smooth(column("ax", 1.0)) if surge else np.zeros_like(fine)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * (fine[1] - fine[0]))])
    return samples, steps, np.ascontiguousarray(np.column_stack([angle, rate, heave, forward]))


def variant(folder, elevation, kind, surge, little_friction):
    folder.mkdir(parents=True, exist_ok=True)
    text = (EXAMPLE / "project.toml").read_text()
    text = text.replace("hub_angle = 0.0", f"hub_angle = {np.radians(elevation)!r}".replace("np.float64(", "").replace(")", ""))
    if little_friction:
        text = text.replace("coulomb = 0.065", "coulomb = 0.0065").replace("coulomb = 117.0", "coulomb = 5.0")
    if kind == "projected":
        own_section = "[plant.sensors.platform_accelerometer]\n"
        keys = text.split(own_section)[1].split("\n\n")[0]
        text = text.replace(own_section, f"[plant.sensors.surge_accelerometer]\n{keys}\n\n{own_section}")
    if kind == "elevated":
        text = text.replace("[plant.sensors.platform_accelerometer]", '[plant.sensors.platform_accelerometer]\naxis = "elevated"')
    if surge:
        text = text.replace('heave = "az"', 'surge = "ax"\nheave = "az"')
    (folder / "project.toml").write_text(text)
    (folder / "sandy-loam.parquet").write_bytes((EXAMPLE / "sandy-loam.parquet").read_bytes())
    return tomllib.loads(text)


def code(program, folder, kind):
    out = folder / "out"
    # a requirement that fails at an elevation is a verdict: the code is exported as well
    subprocess.run([program, "design", str(folder), "-o", str(out)], capture_output=True, check=False)
    (out / "plant.c").write_text(PLANT)
    library = out / "plant.so"
    command = ["gcc", "-O2", "-shared", "-fPIC", *(["-DPROJECTED"] if kind == "projected" else []), "-o", str(library), str(out / "plant.c"), str(out / "controller.c"), "-lm"]
    subprocess.run(command, check=True)
    return ctypes.CDLL(str(library))


def own(program, folder):
    """The hub's RMS that the program's verification finds, mrad/s."""
    found = subprocess.run([program, "verify", str(folder), "--json"], capture_output=True, text=True, check=False)
    for row in json.loads(found.stdout)["figures"]:
        if row.get("key", row.get("figure")) == "nonlinear_road_compensated_hub_rms_rad_s":
            return 1e3 * row["value"]
    return float("nan")


def simulated(library, project, elevation, kind, surge):
    numbers = (ctypes.c_double * 64)(*rig(project))
    samples, steps, motion = road(project, surge)
    # the sixth column is that of the second accelerometer: the others stay as they are without it
    noise = np.column_stack([np.random.default_rng(3).standard_normal((samples, 5)), np.random.default_rng(4).standard_normal(samples)])
    noise = np.ascontiguousarray(noise)
    rate = np.zeros(samples)
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    library.simulate(numbers, samples, steps, pointer(motion), pointer(noise), ctypes.c_double(np.radians(elevation)),
                     int(kind == "elevated"), pointer(rate))
    return 1e3 * np.sqrt(np.mean(rate[round(SETTLE_S / 1e-3) :] ** 2))


def main():
    program, *options = sys.argv[1:]
    little_friction = "--little-friction" in options
    folders = [option for option in options if not option.startswith("--")]
    root = pathlib.Path(folders[0]) if folders else pathlib.Path(tempfile.mkdtemp())
    good = True
    print("| elevation, deg | accelerometer | surge | RMS of hub rate here, mrad/s | by the program | over no surge |")
    print("|---|---|---|---|---|---|")
    for elevation in ELEVATIONS:
        none = None
        for kind, surge in (("upright", False), ("upright", True), ("elevated", True), ("projected", True)):
            folder = root / f"{elevation:g}-{kind}-{'surge' if surge else 'none'}"
            project = variant(folder, elevation, kind, surge, little_friction)
            found = simulated(code(program, folder, kind), project, elevation, kind, surge)
            none = none or found
            print(f"| {elevation:g} | {kind} | {'yes' if surge else 'no'} | {found:.2f} | {own(program, folder):.2f} | {found / none:.2f} |", flush=True)
            good = good and not (kind != "upright" and found > ALLOWED * none)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
