"""A simulator of one stabilised axis, written from the equations of motion and sharing no code with Counterpoise.

A truth file states the machine (README.md lists its keys). `Machine` turns it into ordinary differential equations, writes them out as straight-line Python
with every number as a constant, and integrates them with the classical Runge-Kutta method at a fixed step. Writing the equations out makes the inner loop
about four times as fast as general code: a run of 10 s at 1 kHz takes a few seconds.

Angles are in rad, positive nose-up. Hub and beam are inertial; the motor's angle is relative to the platform. Heave is the upward acceleration of the pivot
without gravity.
"""

import math
import random
import tomllib

# Steps of a sample unless the equations are stiff.
SUBSTEPS = 20

# Largest product of step and spectral radius of the Jacobian. The method is stable up to 2.8; at 0.5 its error is about 1e-4 of the quickest motion a step.
STEP_LIMIT = 0.5

# Most steps of a sample: a machine that needs more is refused, because a run of it would take minutes.
MOST_SUBSTEPS = 2000

# Columns of a recording, each with its unit on a rotary axis.
UNITS = {
    "demand": "rad/s",
    "control": "V",
    "hub_rate": "rad/s",
    "platform_rate": "rad/s",
    "platform_accel": "m/s^2",
    "motor_rate": "rad/s",
    "hub_position": "rad",
    "motor_position": "rad",
    "motor_current": "A",
}

FRICTION = {
    "model": "dahl", "coulomb": 0.0, "static_ratio": 1.0, "stribeck_rate": 0.01, "stiffness": None, "bristle_damping": 0.0, "smoothing_rate": 1e-3,
    "viscous": 0.0, "quadratic": 0.0, "asymmetry": 0.0, "drift": 0.0, "load_coefficient": 0.0, "tight_spots": [],
    "aging_ratio": 0.0, "aging_time": 1.0, "aging_slip": 0.01,
}
RIPPLE = {"amplitude": 0.0, "order": 1.0, "phase": 0.0}
SENSOR = {
    "natural_frequency": None, "damping_ratio": 0.7, "noise": 0.0, "gain": 1.0, "bias": 0.0, "drift": 0.0, "walk": 0.0, "g_sensitivity": 0.0, "scale": None,
    "counts": None, "eccentricity": 0.0, "eccentricity_phase": 0.0, "delay_samples": 0, "period_samples": 1, "dropouts": 0.0, "relative": False,
}
# Every key of a truth file with its value if absent. `None` stands for: none, or derived from other keys.
KEYS = {
    "seed": 1,
    "loop": "hub_rate",
    "base_moves": True,
    "structure": {
        "hub_inertia": None, "beam_inertia": 0.0, "stiffness": None, "damping": 0.0, "out_of_balance": 0.0, "vertical_offset": 0.0, "gravity": 9.80665,
        "cable": {"stiffness": 0.0, "centre": 0.0, "cubic": 0.0},
        "hose": {"torque": 0.0, "stiffness": 1.0},
        "roughness": {"rms": 0.0, "length": 0.05, "terms": 6},
    },
    "gear": {"ratio": 1.0, "stiffness": None, "damping": 0.0, "backlash": 0.0, "ripple": RIPPLE},
    "motor": {
        "inertia": 0.0, "torque_constant": 1.0, "back_emf_constant": None, "resistance": 1.0, "inductance": 0.0, "cogging": RIPPLE, "torque_ripple": RIPPLE,
    },
    "drive": {
        "kind": "torque", "limit": 10.0, "bandwidth": None, "gain": 1.0, "current_feedback": 0.0, "time_constant": 0.0, "input_limit": None,
        "bus_voltage": None, "current_limit": None, "dead_zone": 0.0,
    },
    "friction": {"pivot": FRICTION, "motor": FRICTION},
    "sensors": {name: SENSOR for name in UNITS if name not in ("demand", "control")},
    "interface": {"input_bits": None, "output_bits": None, "delay_samples": 0},
}


class TruthError(Exception):
    """A truth file that does not describe a machine."""


def read_truth(path):
    """Returns the truth file with every absent key filled in. Sensors that the file does not name are not fitted."""
    with open(path, "rb") as file:
        return complete_truth(tomllib.load(file))


def complete_truth(stated):
    """Returns what `stated` says with every absent key filled in; raises `TruthError` with all keys that are unknown."""
    unknown = []
    truth = _complete(stated, KEYS, "", unknown)
    if unknown:
        raise TruthError("unknown keys in the truth file: " + ", ".join(unknown))
    truth["sensors"] = {name: truth["sensors"][name] for name in stated.get("sensors", {})}
    if truth["structure"]["hub_inertia"] is None:
        raise TruthError("the truth file has no structure.hub_inertia (kg m^2, with its load): state it")
    if truth["structure"]["beam_inertia"] > 0.0 and truth["structure"]["stiffness"] is None:
        raise TruthError("structure.beam_inertia needs structure.stiffness, N m/rad: state it, or add the beam to hub_inertia")
    if truth["gear"]["stiffness"] is not None and truth["motor"]["inertia"] <= 0.0:
        raise TruthError("gear.stiffness needs motor.inertia, kg m^2: state it, or leave the stiffness out for a rigid gear")
    if truth["gear"]["backlash"] > 0.0 and truth["gear"]["stiffness"] is None:
        raise TruthError("gear.backlash needs gear.stiffness, N m/rad: state it")
    return truth


def _complete(stated, keys, path, unknown):
    unknown += [path + key for key in stated if key not in keys]
    result = {}
    for key, default in keys.items():
        if isinstance(default, dict):
            result[key] = _complete(stated.get(key, {}), default, f"{path}{key}.", unknown)
        else:
            result[key] = stated.get(key, default)
    return result


def _ripple(table, angle):
    return f"{table['amplitude']!r} * sin({table['order']!r} * {angle} + {table['phase']!r})"


class Equations:
    """The equations of motion of a truth as lines of Python, with the names of the states in their order.

    The lines compute `d_NAME` for each state from the states, the control `u` and, if the base moves, its angle `th_p`, rate `w_p`, angular
    acceleration `alpha_p` and heave `a_p`.
    """

    def __init__(self, truth, base_moves):
        self.truth = truth
        self.base_moves = base_moves
        self.states = ["th_h", "w_h"]
        self.lines = []
        self.rigid_gear = truth["gear"]["stiffness"] is None
        self._kinematics()
        self._drive()
        self._hub_torques()
        self._accelerations()
        self._sensor_lags()

    def _add(self, *lines):
        self.lines += lines

    def _kinematics(self):
        self._add("phi = th_h - th_p" if self.base_moves else "phi = th_h")
        self._add("om = w_h - w_p" if self.base_moves else "om = w_h")
        ratio = self.truth["gear"]["ratio"]
        if self.rigid_gear:
            self._add(f"th_m = {ratio!r} * phi", f"w_m = {ratio!r} * om")
        else:
            self.states += ["th_m", "w_m"]
            self._add("d_th_m = w_m")
        self._add("d_th_h = w_h")

    def _drive(self):
        drive, motor = self.truth["drive"], self.truth["motor"]
        torque_constant = motor["torque_constant"]
        back_emf = torque_constant if motor["back_emf_constant"] is None else motor["back_emf_constant"]
        kind = drive["kind"]
        limit = drive["current_limit"]
        ripple = motor["torque_ripple"]
        factor = f" * (1.0 + {_ripple(ripple, 'th_m')})" if ripple["amplitude"] else ""
        if kind == "torque":
            self._add(f"i = {drive['limit'] / 10.0 / torque_constant!r} * u")
        elif kind == "current":
            reference = f"{drive['limit'] / 10.0!r} * u"
            if drive["bandwidth"] is None:
                self._add(f"i = {reference}")
            else:
                self.states.append("i")
                self._add(f"d_i = {drive['bandwidth']!r} * ({reference} - i)")
        elif kind in ("voltage", "amplifier"):
            self._voltage_drive(kind, back_emf, limit)
        else:
            raise TruthError(f'drive.kind = "{kind}": must be "torque", "current", "voltage" or "amplifier"')
        self._add(f"T_m = {torque_constant!r} * i{factor}")
        cogging = motor["cogging"]
        if cogging["amplitude"]:
            self._add(f"T_m -= {_ripple(cogging, 'th_m')}")

    def _voltage_drive(self, kind, back_emf, limit):
        """Amplifier and armature: `tau dV/dt = -V + gain (v - feedback i)`, `L di/dt = V - R i - K_e w_m`, each algebraic where its lag is zero."""
        drive, motor = self.truth["drive"], self.truth["motor"]
        resistance, inductance = motor["resistance"], motor["inductance"]
        if kind == "voltage":
            gain, feedback, lag, bus = drive["limit"] / 10.0, 0.0, 0.0, drive["limit"]
        else:
            gain, feedback, lag, bus = drive["gain"], drive["current_feedback"], drive["time_constant"], drive["bus_voltage"]
        if inductance > 0.0:
            self.states.append("i")
        if lag > 0.0:
            self.states.append("V")
        elif inductance > 0.0 or feedback == 0.0:
            self._add(f"V = {gain!r} * (u - {feedback!r} * i)" if feedback else f"V = {gain!r} * u")
        else:
            # Voltage and current are both algebraic: the voltage follows from v and the back-EMF.
            self._add(f"V = {gain!r} * ({resistance!r} * u + {feedback * back_emf!r} * w_m) / {resistance + gain * feedback!r}")
        if bus is not None:
            clip = [f"if V > {bus!r}:", f"    V = {bus!r}", f"elif V < {-bus!r}:", f"    V = {-bus!r}"]
            self._add(*clip)
        if inductance > 0.0:
            if limit is not None:
                self._add(f"if i > {limit!r}:", f"    i = {limit!r}", f"elif i < {-limit!r}:", f"    i = {-limit!r}")
            self._add(f"d_i = (V - {resistance!r} * i - {back_emf!r} * w_m) * {1.0 / inductance!r}")
            if limit is not None:
                self._add(f"if (i >= {limit!r} and d_i > 0.0) or (i <= {-limit!r} and d_i < 0.0):", "    d_i = 0.0")
        else:
            self._add(f"i = (V - {back_emf!r} * w_m) * {1.0 / resistance!r}")
            if limit is not None:
                self._add(f"if i > {limit!r}:", f"    i = {limit!r}", f"elif i < {-limit!r}:", f"    i = {-limit!r}")
        if lag > 0.0:
            self._add(f"d_V = ({gain!r} * (u - {feedback!r} * i) - V) * {1.0 / lag!r}")
            if bus is not None:
                self._add(f"if (V >= {bus!r} and d_V > 0.0) or (V <= {-bus!r} and d_V < 0.0):", "    d_V = 0.0")

    def _friction(self, place, rate, angle, load):
        """Adds the lines of `F_PLACE`, the whole torque of the friction at `place`."""
        law = self.truth["friction"][place]
        force = f"F_{place}"
        drag = []
        if law["viscous"]:
            drag.append(f"{law['viscous']!r} * {rate}")
        if law["quadratic"]:
            drag.append(f"{law['quadratic']!r} * {rate} * abs({rate})")
        drag = " + ".join(drag) or "0.0"
        if law["coulomb"] <= 0.0:
            self._add(f"{force} = {drag}")
            return
        self._friction_level(place, law, rate, angle, load)
        if law["model"] == "smooth":
            self._add(f"{force} = g_{place} * tanh({rate} * {1.0 / law['smoothing_rate']!r}) + {drag}")
        elif law["model"] in ("dahl", "lugre"):
            # With no stiffness stated, the friction at rest yields by a tenth of a milliradian before it slides.
            stiffness = law["coulomb"] / 1e-4 if law["stiffness"] is None else law["stiffness"]
            bristle = f"z_{place}"
            self.states.append(bristle)
            self._add(f"d_{bristle} = {rate} - {stiffness!r} * abs({rate}) * {bristle} / g_{place}")
            damping = f" + {law['bristle_damping']!r} * d_{bristle}" if law["model"] == "lugre" and law["bristle_damping"] else ""
            self._add(f"{force} = {stiffness!r} * {bristle}{damping} + {drag}")
        else:
            raise TruthError(f'friction.{place}.model = "{law["model"]}": must be "dahl", "lugre" or "smooth"')

    def _friction_level(self, place, law, rate, angle, load):
        """Adds the lines of `g_PLACE`, the level that the dry friction tends to at this rate, angle, load and time."""
        level = f"g_{place}"
        excess = law["static_ratio"] - 1.0
        if law["aging_ratio"]:
            # Contacts age while they rest and are renewed by slip: da/dt = (1 - a) / t - a |w| / x.
            age = f"a_{place}"
            self.states.append(age)
            self._add(f"d_{age} = (1.0 - {age}) * {1.0 / law['aging_time']!r} - {age} * abs({rate}) * {1.0 / law['aging_slip']!r}")
            factor = f"({excess!r} + {law['aging_ratio']!r} * {age})"
        else:
            factor = repr(excess) if excess else None
        if factor:
            self._add(f"q = {rate} * {1.0 / law['stribeck_rate']!r}")
            self._add(f"{level} = {law['coulomb']!r} * (1.0 + {factor} * exp(-q * q)) if -5.0 < q < 5.0 else {law['coulomb']!r}")
        else:
            self._add(f"{level} = {law['coulomb']!r}")
        if law["asymmetry"]:
            self._add(f"{level} *= 1.0 + {law['asymmetry']!r} * tanh({rate} * {1.0 / law['smoothing_rate']!r})")
        if law["drift"]:
            self._add(f"{level} *= 1.0 + {law['drift']!r} * t")
        if law["load_coefficient"]:
            self._add(f"{level} *= 1.0 + {law['load_coefficient']!r} * abs({load})")
        for spot in law["tight_spots"]:
            self._add(f"q = ({angle} - {spot['angle']!r}) * {1.0 / spot['width']!r}")
            self._add("if -5.0 < q < 5.0:", f"    {level} *= 1.0 + {spot['height']!r} * exp(-q * q)")

    def _hub_torques(self):
        """Adds the lines of `T`, the torque on the hub but for that of the gear."""
        structure = self.truth["structure"]
        mu, nu, gravity = structure["out_of_balance"], structure["vertical_offset"], structure["gravity"]
        field = f"({gravity!r} + a_p)" if self.base_moves else repr(gravity)
        self._add("T = 0.0")
        if mu or nu:
            moment = f"{mu!r} * cos(th_h)" + (f" - {nu!r} * sin(th_h)" if nu else "")
            self._add(f"T_oob = {field} * ({moment})", "T -= T_oob")
        else:
            self._add("T_oob = 0.0")
        cable = structure["cable"]
        if cable["stiffness"] or cable["cubic"]:
            self._add(f"q = phi - {cable['centre']!r}", f"T -= q * ({cable['stiffness']!r} + {cable['cubic']!r} * q * q)")
        hose = structure["hose"]
        if hose["torque"]:
            self.states.append("hose")
            self._add(f"d_hose = {hose['stiffness']!r} * (om - abs(om) * hose * {1.0 / hose['torque']!r})", "T -= hose")
        terms = self._roughness()
        if terms:
            self._add("T -= " + " + ".join(terms))
        ripple = self.truth["gear"]["ripple"]
        if ripple["amplitude"]:
            self._add(f"T -= {_ripple(ripple, 'th_m')}")
        self._friction("pivot", "om", "phi", "T_oob")
        self._add("T -= F_pivot")
        if structure["beam_inertia"] > 0.0:
            self.states += ["th_b", "w_b"]
            self._add(
                f"T_b = {structure['stiffness']!r} * (th_h - th_b) + {structure['damping']!r} * (w_h - w_b)",
                "T -= T_b",
                "d_th_b = w_b",
                f"d_w_b = T_b * {1.0 / structure['beam_inertia']!r}",
            )

    def _roughness(self):
        """Returns the terms of a smooth random torque of the angle: sines of random phase with a Gaussian spectrum of the correlation length."""
        roughness = self.truth["structure"]["roughness"]
        if not roughness["rms"]:
            return []
        source = random.Random(f"roughness {self.truth['seed']}")
        count = roughness["terms"]
        amplitude = roughness["rms"] * math.sqrt(2.0 / count)
        waves = [(abs(source.gauss(0.0, 1.0)) / roughness["length"], source.uniform(0.0, 2.0 * math.pi)) for _ in range(count)]
        return [f"{amplitude!r} * sin({number!r} * phi + {phase!r})" for number, phase in waves]

    def _accelerations(self):
        gear, motor, structure = self.truth["gear"], self.truth["motor"], self.truth["structure"]
        ratio = gear["ratio"]
        if self.rigid_gear:
            self._friction("motor", "w_m", "th_m", "T_m")
            reflected = ratio * ratio * motor["inertia"]
            self._add(f"T += {ratio!r} * (T_m - F_motor)")
            if self.base_moves and reflected:
                self._add(f"T += {reflected!r} * alpha_p")
            self._add(f"d_w_h = T * {1.0 / (structure['hub_inertia'] + reflected)!r}")
            return
        self._add(f"delta = th_m * {1.0 / ratio!r} - phi", f"d_delta = w_m * {1.0 / ratio!r} - om")
        half = 0.5 * gear["backlash"]
        mesh = f"{gear['stiffness']!r} * %s + {gear['damping']!r} * d_delta"
        if half > 0.0:
            self._add(
                f"if delta > {half!r}:", f"    T_2 = {mesh % f'(delta - {half!r})'}",
                f"elif delta < {-half!r}:", f"    T_2 = {mesh % f'(delta + {half!r})'}",
                "else:", "    T_2 = 0.0",
            )
        else:
            self._add(f"T_2 = {mesh % 'delta'}")
        self._friction("motor", "w_m", "th_m", f"(T_2 * {1.0 / ratio!r})")
        self._add(
            f"d_w_h = (T + T_2) * {1.0 / structure['hub_inertia']!r}",
            f"d_w_m = (T_m - F_motor - T_2 * {1.0 / ratio!r}) * {1.0 / motor['inertia']!r}",
        )

    def _sensor_lags(self):
        """Adds `w_n^2 / (s^2 + 2 z w_n s + w_n^2)` of every sensor with a lag, as the states `y_NAME` and `dy_NAME`."""
        for name, sensor in self.truth["sensors"].items():
            if sensor["natural_frequency"] is None or (name.startswith("platform") and not self.base_moves):
                continue
            frequency, damping = sensor["natural_frequency"], sensor["damping_ratio"]
            self.states += [f"y_{name}", f"dy_{name}"]
            self._add(
                f"d_y_{name} = dy_{name}",
                f"d_dy_{name} = {frequency ** 2!r} * ({signal(name, sensor)} - y_{name}) - {2.0 * damping * frequency!r} * dy_{name}",
            )

    def source(self):
        """Returns the source of `advance(y, t0, step, count, u, base)` and of `derivatives(y, t, u, base)`, and of `observe(y, t, u, base)`."""
        names = self.states
        unpack = f"    ({', '.join(names)},) = y"
        base = ["    th_0, w_0, a_0, alpha_p, jerk_p = base"] if self.base_moves else []
        text = ["def derivatives(y, t, u, base):", unpack]
        # `t` is the time since the start of the run, `s` that since the last sample.
        motion = ["w_p = w_0 + alpha_p * s", "th_p = th_0 + s * (w_0 + 0.5 * alpha_p * s)", "a_p = a_0 + jerk_p * s"] if self.base_moves else []
        text += base + ["    s = 0.0"] + ["    " + line for line in motion + self.lines]
        text += [f"    return ({', '.join('d_' + name for name in names)},)", ""]

        text += ["def observe(y, t, u, base):", unpack] + base + ["    s = 0.0"]
        text += ["    " + line for line in motion + self.lines]
        if not self.base_moves:
            text += ["    th_p = w_p = a_p = 0.0"]
        text += ["    return {name: value for name, value in locals().items() if isinstance(value, (int, float))}", ""]

        text += ["def advance(y, t0, step, count, u, base):", unpack] + base + ["    half, sixth = 0.5 * step, step / 6.0", "    for n in range(count):"]
        start = [f"o_{name} = {name}" for name in names]
        text += ["        " + line for line in start]
        for stage in range(4):
            shift = ("0.0", "half", "half", "step")[stage]
            lines = []
            if stage:
                lines += [f"{name} = o_{name} + {shift} * d_{name}" for name in names]
            if stage in (0, 1, 3):
                lines += [f"s = n * step + {shift}", "t = t0 + s"] + motion
            lines += self.lines
            if stage == 0:
                lines += [f"k_{name} = d_{name}" for name in names]
            elif stage < 3:
                lines += [f"k_{name} += d_{name} + d_{name}" for name in names]
            text += ["        " + line for line in lines]
        text += [f"        {name} = o_{name} + sixth * (k_{name} + d_{name})" for name in names]
        text += [f"    return ({', '.join(names)},)", ""]
        return "\n".join(text)


def signal(name, sensor):
    """Returns the expression of the quantity that the sensor of a column measures, in the states of `Equations`."""
    if name == "hub_rate":
        return "om" if sensor["relative"] else "w_h"
    return {
        "platform_rate": "w_p", "platform_accel": "a_p", "motor_rate": "w_m", "hub_position": "phi", "motor_position": "th_m", "motor_current": "i",
    }[name]


class Base:
    """The motion of the base: rate and heave at the samples, straight lines between them, and the angle as the integral of the rate."""

    def __init__(self, period, rates, heaves):
        self.period, self.rates, self.heaves = period, rates, heaves
        self.angles = [0.0]
        for before, after in zip(rates, rates[1:]):
            self.angles.append(self.angles[-1] + 0.5 * period * (before + after))

    def at(self, sample):
        """Returns angle, rate, heave, and the slopes of rate and heave until the next sample."""
        following = min(sample + 1, len(self.rates) - 1)
        slope = (self.rates[following] - self.rates[sample]) / self.period
        jerk = (self.heaves[following] - self.heaves[sample]) / self.period
        return (self.angles[sample], self.rates[sample], self.heaves[sample], slope, jerk)


class Sensor:
    """What a sensor makes of the quantity that it measures, one reading a sample."""

    def __init__(self, name, settings, input_bits, period, source):
        self.settings = settings
        self.source = source
        self.period = period
        self.sample = 0
        self.walk = 0.0
        self.reading = 0.0
        self.past = []
        self.turn = 2.0 * math.pi
        bits = input_bits if settings["scale"] is not None else None
        self.step = None if bits is None else 20.0 / 2.0**bits / settings["scale"]
        self.range = None if settings["scale"] is None else 10.0 / settings["scale"]

    def read(self, value, heave):
        """Returns the reading of `value`: errors, delay, noise and converter, in that order."""
        settings = self.settings
        if settings["eccentricity"]:
            value += settings["eccentricity"] * math.sin(value + settings["eccentricity_phase"])
        if settings["walk"]:
            self.walk += settings["walk"] * math.sqrt(self.period) * self.source.gauss(0.0, 1.0)
        value = settings["gain"] * value + settings["bias"] + settings["drift"] * self.sample * self.period + settings["g_sensitivity"] * heave + self.walk
        if settings["delay_samples"]:
            self.past.append(value)
            value = self.past[0]
            if len(self.past) > settings["delay_samples"]:
                self.past.pop(0)
        if settings["noise"]:
            value += self.source.gauss(0.0, settings["noise"])
        if settings["counts"] is not None:
            step = self.turn / settings["counts"]
            value = step * round(value / step)
        if self.range is not None:
            value = min(max(value, -self.range), self.range)
        if self.step is not None:
            value = self.step * round(value / self.step)
        keeps = self.sample % settings["period_samples"] != 0
        if settings["dropouts"] and self.sample and self.source.random() < settings["dropouts"]:
            keeps = True
        self.sample += 1
        if not keeps:
            self.reading = value
        return self.reading


class Machine:
    """The true machine at one sample period: its state, and what its sensors read.

    `base` is the motion of the base, or `None` if it stands still. `run` names the run, so that each has a noise of its own.
    """

    def __init__(self, truth, period, start_angle=0.0, base=None, run="", substeps=None):
        self.truth = truth
        self.period = period
        self.base = base
        self.equations = Equations(truth, base is not None)
        self.names = self.equations.states
        self.code = {"sin": math.sin, "cos": math.cos, "exp": math.exp, "tanh": math.tanh}
        exec(compile(self.equations.source(), "<equations of motion>", "exec"), self.code)
        interface = truth["interface"]
        self.control_step = None if interface["output_bits"] is None else 20.0 / 2.0 ** interface["output_bits"]
        self.held = [0.0] * interface["delay_samples"]
        self.sensors = {
            name: Sensor(name, settings, interface["input_bits"], period, random.Random(f"{name} {run} {truth['seed']}"))
            for name, settings in truth["sensors"].items()
        }
        self.signals = {}
        for name, settings in truth["sensors"].items():
            lag = f"y_{name}" in self.names
            self.signals[name] = f"y_{name}" if lag else signal(name, settings)
        self.sample = 0
        self.control = 0.0
        self.state = self._start(start_angle)
        self.substeps = self._substeps() if substeps is None else substeps

    def _start(self, angle):
        """Returns the state at rest: the motor held by a brake, the load resting on the gear, and the filters of the sensors settled."""
        structure, gear = self.truth["structure"], self.truth["gear"]
        values = dict.fromkeys(self.names, 0.0)
        values["th_h"] = angle
        if "th_b" in values:
            values["th_b"] = angle
        for place in ("pivot", "motor"):
            if f"a_{place}" in values:
                values[f"a_{place}"] = 1.0
        if self.base is not None:
            # At rest on the platform, which may already turn.
            rate, heave = self.base.rates[0], self.base.heaves[0]
            values["w_h"] = rate
            if "w_b" in values:
                values["w_b"] = rate
            if "y_platform_rate" in values:
                values["y_platform_rate"] = rate
            if "y_platform_accel" in values:
                values["y_platform_accel"] = heave
        if "y_hub_rate" in values and not self.truth["sensors"]["hub_rate"]["relative"]:
            values["y_hub_rate"] = values["w_h"]
        if "y_hub_position" in values:
            values["y_hub_position"] = angle
        if "th_m" in values:
            field = structure["gravity"] + (self.base.heaves[0] if self.base else 0.0)
            weight = field * (structure["out_of_balance"] * math.cos(angle) - structure["vertical_offset"] * math.sin(angle))
            wind_up = weight / gear["stiffness"] + math.copysign(0.5 * gear["backlash"], weight)
            values["th_m"] = gear["ratio"] * (angle + wind_up)
        if "y_motor_position" in values:
            values["y_motor_position"] = values.get("th_m", gear["ratio"] * angle)
        return tuple(values[name] for name in self.names)

    def _base_at(self, sample):
        return None if self.base is None else self.base.at(min(sample, len(self.base.rates) - 1))

    def _substeps(self):
        """Returns the number of steps of a sample at which the quickest motion of the machine is well resolved."""
        radius = 0.0
        base = self._base_at(0)
        for rate in (0.0, 0.5):
            state = dict(zip(self.names, self.state))
            for name, factor in (("w_h", 1.0), ("w_b", 1.0), ("w_m", self.truth["gear"]["ratio"])):
                if name in state:
                    state[name] += rate * factor
            radius = max(radius, self._spectral_radius(tuple(state[name] for name in self.names), base))
        count = max(SUBSTEPS, math.ceil(radius * self.period / STEP_LIMIT))
        if count > MOST_SUBSTEPS:
            raise TruthError(f"the machine has a motion of {radius:.3g} rad/s, which needs {count} steps a sample: lower its stiffnesses or raise its lags")
        return count

    def _spectral_radius(self, state, base):
        """Returns the spectral radius of the Jacobian at a state, by repeated squaring (Gelfand's formula)."""
        derivatives = self.code["derivatives"]
        size = len(state)
        columns = []
        for index in range(size):
            change = 1e-7 * max(1.0, abs(state[index]))
            up, down = list(state), list(state)
            up[index] += change
            down[index] -= change
            above, below = derivatives(tuple(up), 0.0, 0.0, base), derivatives(tuple(down), 0.0, 0.0, base)
            columns.append([(a - b) / (2.0 * change) for a, b in zip(above, below)])
        matrix = [[columns[c][r] for c in range(size)] for r in range(size)]
        logarithm, power = 0.0, 1.0
        for _ in range(12):
            norm = max(sum(abs(entry) for entry in row) for row in matrix)
            if norm == 0.0:
                return 0.0
            logarithm += math.log(norm) / power
            matrix = [[entry / norm for entry in row] for row in matrix]
            matrix = [[sum(row[k] * matrix[k][c] for k in range(size)) for c in range(size)] for row in matrix]
            power *= 2.0
        return math.exp(logarithm)

    def set(self, **values):
        """Sets states by name, for tests."""
        self.state = tuple(values.pop(name, value) for name, value in zip(self.names, self.state))
        if values:
            raise KeyError(", ".join(values))

    def get(self, name):
        """Returns a state or an intermediate quantity of the equations by name."""
        return self.observe()[name]

    def observe(self):
        """Returns every state and every intermediate quantity of the equations at this sample."""
        return self.code["observe"](self.state, self.sample * self.period, self.control, self._base_at(self.sample))

    def read(self):
        """Returns the readings of all sensors at this sample, and the true quantities."""
        true = self.observe()
        heave = true["a_p"]
        return {name: sensor.read(true[self.signals[name]], heave) for name, sensor in self.sensors.items()}, true

    def convert(self, control):
        """Returns the control as the output converter gives it: within +/- 10 V, in its steps."""
        control = min(max(control, -10.0), 10.0)
        if self.control_step is None:
            return control
        return min(self.control_step * round(control / self.control_step), 10.0 - self.control_step)

    def advance(self, control):
        """Moves the machine by one sample under a control in volts, held and delayed as the interface says."""
        self.held.append(control)
        control = self.held.pop(0)
        drive = self.truth["drive"]
        dead_zone, limit = drive["dead_zone"], drive["input_limit"]
        if dead_zone:
            control = 0.0 if abs(control) <= dead_zone else control - math.copysign(dead_zone, control)
        if limit is not None:
            control = min(max(control, -limit), limit)
        self.control = control
        time = self.sample * self.period
        step = self.period / self.substeps
        self.state = self.code["advance"](self.state, time, step, self.substeps, control, self._base_at(self.sample))
        self.sample += 1
