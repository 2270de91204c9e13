"""Recordings of a rig whose gyroscope errs in a way that no law of the library has, by a simulator of its own.

Classical Runge-Kutta steps of 50 us of the equations of docs/theory/plant.md, the loop with its converters at 1 kHz; four recordings of 10 s to fit
and two to be held out. Nothing of the product is used. With numba a machine takes seconds, without it some minutes.

    python sensor_errors.py FOLDER dead-band|saturation|ripple|threshold|none PROJECT
    counterpoise diagnose FOLDER FOLDER/fit --held-out FOLDER/held

PROJECT is the file of the reference rig with the PI controller of its recordings (18 V s/rad, 80 V/rad, bias 2.88 V); it is copied into FOLDER.
"""

import pathlib
import shutil
import sys

import numpy as np

try:
    from numba import njit
except ImportError:
    def njit(function):
        return function

ERRORS = ["none", "dead-band", "saturation", "ripple", "threshold"]
SAMPLES, PERIOD, STEPS = 10000, 1e-3, 20
SCALES = (10.0, 10.0, 0.5, 0.1, 20.0)  # V per unit: gyroscopes, accelerometer, tachometer, resolver
NOISE = (2e-4, 2e-4, 5e-3, 2e-2, 2e-5)


@njit
def reading(kind, rate, angle):
    """What the gyroscope shows of a rate at an angle of the hub on the platform."""
    if kind == 1:
        return np.sign(rate) * max(abs(rate) - 3e-3, 0.0)
    if kind == 2:
        return min(max(rate, -0.11), 0.11)
    if kind == 3:
        return rate + 4e-3 * np.sin(2 * np.pi * angle / 0.04 + 0.5)
    if kind == 4:
        return 0.0 if abs(rate) < 4e-3 else rate
    return rate


@njit
def slopes(s, drive, platform_rate, platform_angle, heave, out):
    voltage, current, motor, motor_rate, hub, hub_rate, tip, tip_rate, motor_dry, pivot_dry, shown, shown_slope = s
    out[0] = (-voltage + 30 * (drive - 0.3067 * current)) / 1.5e-3
    out[1] = (voltage - 0.8 * current - 0.86 * motor_rate) / 4e-3
    wind_up, gap = motor / 200 + platform_angle - hub, 0.25e-3
    winding = motor_rate / 200 + platform_rate - hub_rate
    mesh = 0.0
    if abs(wind_up) > gap:
        mesh = 2.4e6 * (wind_up - np.sign(wind_up) * gap) + 2500 * winding
    out[2] = motor_rate
    out[3] = (0.86 * current - motor_dry - 0.002 * motor_rate - mesh / 200) / 4e-3
    relative = hub_rate - platform_rate
    beam = 3.305e6 * (hub - tip) + 277 * (hub_rate - tip_rate)
    torque = mesh - beam - pivot_dry - 60 * relative - (9.80665 + heave) * 151.67 * np.cos(hub)
    out[4], out[5] = hub_rate, torque / 74.1
    out[6], out[7] = tip_rate, beam / 271.6
    out[8] = 1.3 * motor_rate * (1 - motor_dry / 0.065 * (1.0 if motor_rate > 0 else -1.0))
    out[9] = 2.4e5 * relative * (1 - pivot_dry / 117 * (1.0 if relative > 0 else -1.0))
    out[10], out[11] = shown_slope, 377.0**2 * (hub_rate - shown) - 1.4 * 377 * shown_slope


@njit
def run(kind, demand, rates, heaves, noise):
    """Returns demand, control and the five readings, sample by sample."""
    h = PERIOD / STEPS
    s, y = np.zeros(12), np.zeros(12)
    k = np.zeros((4, 12))
    weight = 151.67 * 9.80665
    s[1] = weight / 200 / 0.86
    s[0], s[2] = 0.8 * s[1], 200 * (weight / 2.4e6 + 0.25e-3)
    integral, angle = 0.0, 0.0
    sensed = np.zeros(4)  # platform gyroscope and accelerometer with their slopes
    out = np.zeros((len(demand), 7))
    for n in range(len(demand)):
        truth = [reading(kind, s[10], s[4] - angle), sensed[0], sensed[2], s[3], s[4] - angle]
        for j in range(5):
            step = 20.0 / 65536 / SCALES[j]
            out[n, 2 + j] = np.round((truth[j] + NOISE[j] * noise[n, j]) / step) * step
        error = demand[n] - out[n, 2]
        control = np.round((18 * error + integral + 2.88) / (20 / 4096)) * (20 / 4096)
        control = min(10.0, max(-10.0, control))
        integral += 80 * PERIOD * error
        out[n, 0], out[n, 1] = demand[n], control
        for j in range(STEPS):
            at = np.array([j, j + 0.5, j + 0.5, j + 1.0]) / STEPS
            w = rates[n] + (rates[n + 1] - rates[n]) * at
            a = heaves[n] + (heaves[n + 1] - heaves[n]) * at
            turned = np.array([0.0, h / 4 * (w[0] + w[1]), h / 4 * (w[0] + w[1]), h * w[1]])
            for m in range(4):
                reach = 0.0 if m == 0 else (h if m == 3 else 0.5 * h)
                y[:] = s + reach * k[max(m - 1, 0)]
                slopes(y, control, w[m], angle + turned[m], a[m], k[m])
            s += h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
            angle += turned[3]
            for first, frequency, felt in ((0, 377.0, w[1]), (2, 628.0, a[1])):
                sensed[first + 1] += h * (frequency**2 * (felt - sensed[first]) - 1.4 * frequency * sensed[first + 1])
                sensed[first] += h * sensed[first + 1]
    return out


def scenarios(rng):
    """Returns the demand, the platform's rate and the heave of each recording."""
    t = np.arange(SAMPLES) * PERIOD
    still = np.zeros(SAMPLES + 1)

    def triangle(size, period):
        return size * 2 / np.pi * np.arcsin(np.sin(2 * np.pi * t / period))

    def waves(frequencies, time):
        return sum(np.sin(2 * np.pi * f * time + rng.uniform(0, 2 * np.pi)) for f in frequencies)

    def steps(size):
        demand, k, place, sign = np.zeros(SAMPLES), 0, 0.0, 1.0
        while k < SAMPLES:
            length = int(rng.integers(300, 900))
            value = sign * size * rng.uniform(0.3, 1)
            if abs(place + value * length * PERIOD) > 0.06:
                value = -np.sign(place) * abs(value)
            demand[k : k + length] = value
            place += value * min(length, SAMPLES - k) * PERIOD
            k, sign = k + length, -sign
        return demand

    def sized(series, size):
        return size * series / np.max(np.abs(series))

    longer = np.arange(SAMPLES + 1) * PERIOD
    begins = np.minimum(longer / 0.3, 1)
    road = [begins * sized(waves(f, longer), size) for f, size in [([0.35, 0.8, 1.3, 2.1, 3.7], 0.2), ([0.6, 1.5, 2.9, 4.5], 1.5)]]
    sines = waves([0.2, 0.5, 1.1, 2.3, 4.1, 7.3], t)
    return {
        "fit/triangle": (triangle(0.13, 2.0), still, still),
        "fit/steps": (steps(0.15), still, still),
        "fit/road": (np.zeros(SAMPLES), *road),
        "fit/multisine": (sized(sines - sines[0] * np.exp(-t / 0.05), 0.12), still, still),
        "held/triangle": (triangle(0.1, 2.6), still, still),
        "held/steps": (steps(0.13), still, still),
    }


def main():
    folder, kind = pathlib.Path(sys.argv[1]), ERRORS.index(sys.argv[2])
    rng = np.random.default_rng(100 + kind)
    head = "time [s],demand [rad/s],control [V],hub_rate [rad/s],platform_rate [rad/s],platform_accel [m/s^2],motor_rate [rad/s],hub_position [rad]"
    for name, (demand, rates, heaves) in scenarios(rng).items():
        out = run(kind, demand, rates, heaves, rng.standard_normal((SAMPLES, 5)))
        path = folder / f"{name}.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = np.column_stack([np.arange(SAMPLES) * PERIOD, out])
        np.savetxt(path, rows, delimiter=",", fmt="%.9g", header=head, comments="")
    shutil.copy(sys.argv[3], folder / "project.toml")


main()
