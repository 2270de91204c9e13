"""Runs the generated FMI 3.0 units of controller and plant in FMPy and compares the closed loop with the studio's.

    pip install fmpy
    python check.py FOLDER...

Each FOLDER holds the units `axis.fmu` (controller) and `rig.fmu` (plant) and `expected.csv` with the columns time, demand,
heave, pitch_rate, control, hub_rate, one row a sample. The units are validated by FMPy and stepped: controller first,
then plant. Prints the largest differences; exit code 1 where they exceed the limits.
"""

import csv
import pathlib
import sys

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

# Both loops integrate the same equations by different methods: largest difference, relative to the largest value.
LIMIT_CONTROL = 1e-3
LIMIT_RATE = 1e-3


class Unit:
    """A unit at work, its variables by name."""

    def __init__(self, archive):
        problems = validate_fmu(str(archive))
        if problems:
            sys.exit(f"{archive.name} is not valid: {problems}")
        description = read_model_description(str(archive))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.unit = FMU3Slave(
            guid=description.guid,
            unzipDirectory=extract(str(archive)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=archive.stem,
        )
        self.unit.instantiate()
        self.unit.enterInitializationMode(startTime=0.0)
        self.unit.exitInitializationMode()

    def set(self, **values):
        references = [self.references[name] for name in values]
        self.unit.setFloat64(references, list(values.values()))

    def get(self, *names):
        return self.unit.getFloat64([self.references[name] for name in names])


READINGS = ["hub_rate_rad_s", "platform_rate_rad_s", "platform_accel_m_s2", "motor_rate_rad_s", "hub_position_rad"]


def main(folder):
    axis, rig = Unit(folder / "axis.fmu"), Unit(folder / "rig.fmu")
    with open(folder / "expected.csv", newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    period = rows[1]["time"] - rows[0]["time"]
    worst = {"control": 0.0, "hub_rate": 0.0}
    for k, row in enumerate(rows):
        now = k * period
        axis.set(demand_rad_s=row["demand"], **dict(zip(READINGS, rig.get(*READINGS))))
        axis.unit.doStep(currentCommunicationPoint=now, communicationStepSize=period)
        control = axis.get("control_v")[0]
        rate = rig.get("true_hub_rate_rad_s")[0]
        worst["control"] = max(worst["control"], abs(control - row["control"]))
        worst["hub_rate"] = max(worst["hub_rate"], abs(rate - row["hub_rate"]))
        rig.set(control_v=control, heave_m_s2=row["heave"], pitch_rate_rad_s=row["pitch_rate"])
        rig.unit.doStep(currentCommunicationPoint=now, communicationStepSize=period)
    outcome = 0
    for name, limit in [("control", LIMIT_CONTROL), ("hub_rate", LIMIT_RATE)]:
        relative = worst[name] / max(abs(row[name]) for row in rows)
        print(f"{folder.name}: {name}: largest difference {worst[name]:.3e}, {relative:.2e} of the largest value")
        outcome |= relative > limit
    return outcome


if __name__ == "__main__":
    sys.exit(max(main(pathlib.Path(folder)) for folder in sys.argv[1:]))
