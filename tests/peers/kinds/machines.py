"""Servo machines as their data sheets state them: every kind of drive, transmission, structure, axis, sensor and loop, over decades of size.

Each entry is a name and the text of its project file. Values are those of catalogues (order of magnitude and ratios): Maxon, Kollmorgen,
Faulhaber, Dynamixel, Harmonic Drive, THK, HIWIN, Gates, Renishaw, Heidenhain, KVH, Analog Devices.
"""

P = "format = 2\n"

MACHINES = {
    # direct drives
    "watch-size galvanometer": P + """
plant.inertia = "0.028 g cm^2"
plant.motor = { torque_constant = "2.79 mN m/A", resistance = "2.8 ohm", inductance = "0.18 mH" }
plant.drive = { kind = "current", limit = "8 A", bandwidth = "5 kHz" }
plant.sensors.encoder = { counts = 1048576 }
plant.interface = { sample_period = "20 us" }
""",
    "camera gimbal, brushless motor": P + """
plant.inertia = "1200 g cm^2"
plant.motor = { torque_constant = "35 mN m/A" }
plant.drive = { kind = "current", limit = "2 A", bandwidth = "800 Hz", delay = "100 us" }
plant.friction.pivot = { model = "coulomb", coulomb = "1 mN m", viscous = 2e-5 }
plant.sensors.hub_gyro = { natural_frequency = "250 Hz", noise = "0.05 deg/s" }
plant.interface = { sample_period = "1 ms" }
""",
    "airborne turret, torque motor and resolver": P + """
plant.inertia = "2.4 kg m^2"
plant.drive = { kind = "torque", limit = "35 N m" }
plant.friction.pivot = { model = "coulomb", coulomb = 1.2, viscous = 0.4 }
plant.sensors.resolver = { natural_frequency = "400 Hz", noise = "20 arcsec" }
plant.interface = { sample_period = "0.5 ms" }
""",
    "telescope azimuth, direct drive": P + """
plant.inertia = 48e3
plant.drive = { kind = "torque", limit = "25 kN m" }
plant.friction.pivot = { viscous = 900.0 }
plant.sensors.encoder = { counts = 268435456 }
plant.interface = { sample_period = "2 ms" }
""",
    "rate table, tachometer": P + """
plant.inertia = "0.11 kg m^2"
plant.motor = { torque_constant = 1.3, resistance = 4.1, inductance = "9 mH" }
plant.drive = { kind = "voltage", limit = "48 V" }
plant.friction.pivot = { coulomb = 0.05, model = "coulomb", viscous = 0.002 }
plant.sensors.tachometer = { noise = "0.02 deg/s", natural_frequency = "200 Hz" }
plant.interface = { sample_period = "1 ms" }
""",
    "hanging pendulum on a hobby servo": P + """
model.hub_angle = -1.5
plant.lumped = { hub_inertia = 0.00695, out_of_balance = 0.05 }
plant.motor = { inertia = 0.01195, torque_constant = 1.6225, resistance = 3.949 }
plant.drive = { kind = "voltage", limit = 12.0 }
plant.friction.pivot = { viscous = 0.01169 }
plant.sensors.encoder = { counts = 4096 }
plant.interface = { sample_period = 5e-3 }
""",
    "upright pendulum": P + """
model.hub_angle = "88 deg"
plant.lumped = { hub_inertia = 0.02, out_of_balance = 0.06 }
plant.drive = { kind = "torque", limit = "4 N m" }
plant.sensors.encoder = { counts = 65536 }
plant.interface = { sample_period = "1 ms" }
""",
    "direct drive with a flexible head": P + """
plant.lumped = { hub_inertia = 0.9, beam_inertia = 0.5, stiffness = "50 kN m/rad" }
plant.drive = { kind = "torque", limit = "60 N m" }
plant.sensors.hub_gyro = { natural_frequency = "100 Hz", noise = "0.01 deg/s" }
plant.interface = { sample_period = "1 ms" }
""",
    # gearboxes
    "gun in elevation": P + """
plant.lumped = { hub_inertia = 310.0, beam_inertia = 35.0, stiffness = "2.5 MN m/rad", out_of_balance = 150.0 }
plant.gearbox = { ratio = "200:1", stiffness = "2.4 MN m/rad", backlash = "0.5 mrad" }
plant.motor = { inertia = "70 kg cm^2", torque_constant = 0.86, resistance = 0.9, inductance = "4 mH" }
plant.drive = { kind = "current", limit = "40 A", bandwidth = "200 Hz" }
plant.friction.motor = { model = "coulomb", coulomb = 0.4, viscous = 0.002 }
plant.friction.pivot = { model = "coulomb", coulomb = 60.0, viscous = 40.0 }
plant.sensors.hub_gyro = { natural_frequency = "80 Hz", noise = "0.01 deg/s" }
plant.sensors.platform_gyro = { natural_frequency = "80 Hz", noise = "0.01 deg/s" }
plant.interface = { sample_period = "1 ms" }
""",
    "servo gearmotor, encoder on the motor": P + """
plant.inertia = "0.02 kg m^2"
plant.gearbox = { ratio = 66.0, stiffness = 900.0, backlash = "0.8 deg" }
plant.motor = { inertia = "14 g cm^2", torque_constant = "25.9 mN m/A", resistance = 2.07, inductance = "0.62 mH" }
plant.drive = { kind = "voltage", limit = "24 V" }
plant.friction.motor = { model = "coulomb", coulomb = "2 mN m", viscous = 1e-6 }
plant.sensors.encoder = { place = "motor", counts = 4096 }
plant.interface = { sample_period = "1 ms" }
""",
    "valve actuator, rigid worm gear": P + """
plant.inertia = "0.4 kg m^2"
plant.gearbox = { ratio = 120.0 }
plant.motor = { inertia = "1.1 kg cm^2", torque_constant = 0.12, resistance = 0.6 }
plant.drive = { kind = "voltage", limit = "24 V" }
plant.friction.motor = { model = "coulomb", coulomb = 0.03, viscous = 1e-4 }
plant.sensors.tachometer = { place = "motor", noise = "1 rpm" }
plant.interface = { sample_period = "2 ms" }
""",
    "radar pedestal, cascade": P + """
synth.loop = "cascade"
plant.inertia = 2600.0
plant.gearbox = { ratio = 710.0, stiffness = "9 MN m/rad" }
plant.motor = { inertia = "95 kg cm^2" }
plant.drive = { kind = "torque", limit = "30 N m" }
plant.friction.pivot = { viscous = 500.0 }
plant.sensors.encoder = { counts = 16777216 }
plant.interface = { sample_period = "1 ms" }
""",
    "sight with a base gyroscope": P + """
plant.inertia = "3.2 kg m^2"
plant.gearbox = { ratio = 20.0, stiffness = "60 kN m/rad" }
plant.motor = { inertia = "1.6 kg cm^2" }
plant.drive = { kind = "torque", limit = "1.9 N m" }
plant.friction.pivot = { model = "coulomb", coulomb = 0.5, viscous = 0.8 }
plant.sensors.hub_gyro = { natural_frequency = "120 Hz", noise = "0.02 deg/s" }
plant.sensors.platform_gyro = { natural_frequency = "120 Hz", noise = "0.02 deg/s" }
plant.interface = { sample_period = "1 ms" }
""",
    # belts
    "antenna azimuth on a toothed belt": P + """
plant.inertia = 1.0
plant.belt = { ratio = 10.0, stiffness = 2000.0 }
plant.motor = { inertia = 0.02, torque_constant = 0.5, resistance = 8.0 }
plant.drive = { kind = "voltage", limit = 100.0 }
plant.friction.motor = { viscous = 0.01 }
plant.friction.pivot = { viscous = 1.0 }
plant.sensors.encoder = { counts = 65536 }
plant.interface = { sample_period = 2e-3 }
""",
    "pan unit on a stiff belt, rate": P + """
plant.inertia = "0.05 kg m^2"
plant.belt = { ratio = 4.0, stiffness = "3 kN m/rad" }
plant.motor = { inertia = "0.3 kg cm^2", torque_constant = 0.07 }
plant.drive = { kind = "current", limit = "6 A", bandwidth = "1 kHz" }
plant.friction.pivot = { model = "coulomb", coulomb = 0.05, viscous = 0.01 }
plant.sensors.hub_gyro = { natural_frequency = "150 Hz", noise = "0.03 deg/s" }
plant.interface = { sample_period = "1 ms" }
""",
    "printer carriage on a belt": P + """
plant.axis = "linear"
plant.mass = "320 g"
plant.belt = { ratio = 157.0, stiffness = "90 kN/m" }
plant.motor = { inertia = "5 g cm^2", torque_constant = "21 mN m/A", resistance = 6.2 }
plant.drive = { kind = "voltage", limit = "24 V" }
plant.friction.pivot = { model = "coulomb", coulomb = 0.8, viscous = 2.0 }
plant.sensors.encoder = { resolution = "40 um" }
plant.interface = { sample_period = "1 ms" }
""",
    # harmonic drives
    "robot shoulder, cascade on the motor's encoder": P + """
synth.loop = "cascade"
plant.inertia = 1.5
plant.harmonic_drive = { ratio = 100.0, stiffness = 16e3, hysteresis = 2.0, kinematic_error = "0.5 arcmin" }
plant.motor = { inertia = 5.5e-5, torque_constant = 0.11 }
plant.drive = { kind = "current", limit = 8.0 }
plant.sensors.encoder = { place = "motor", counts = 65536 }
plant.interface = { sample_period = 0.5e-3 }
""",
    "robot elbow, encoder on the load": P + """
plant.inertia = "0.35 kg m^2"
plant.harmonic_drive = { ratio = 80.0, stiffness = "9 kN m/rad" }
plant.motor = { inertia = "0.2 kg cm^2", torque_constant = 0.06 }
plant.drive = { kind = "current", limit = "10 A", bandwidth = "1 kHz" }
plant.friction.motor = { model = "coulomb", coulomb = 0.02, viscous = 2e-5 }
plant.sensors.encoder = { counts = 524288 }
plant.interface = { sample_period = "1 ms" }
""",
    "satellite antenna hinge": P + """
plant.inertia = 4.0
plant.harmonic_drive = { ratio = 160.0, stiffness = "12 kN m/rad" }
plant.motor = { inertia = "30 g cm^2", torque_constant = 0.05, resistance = 12.0 }
plant.drive = { kind = "voltage", limit = "28 V" }
plant.sensors.resolver = { noise = "10 arcsec" }
plant.interface = { sample_period = "10 ms" }
""",
    # ball screws and linear axes
    "ball-screw axis, position cascade": P + """
synth.loop = "cascade"
verify.step.rate = 1e-3
plant.axis = "linear"
plant.mass = 70.0
plant.ball_screw = { lead = 0.04, stiffness = 2.467e8, damping = 2467.0 }
plant.motor = { inertia = 4.1e-3 }
plant.drive = { kind = "torque", limit = 20.0 }
plant.friction.pivot = { viscous = 1.0 }
plant.sensors.encoder = { place = "motor", counts = 1048576 }
plant.interface = { sample_period = 1e-3 }
""",
    "milling table, scale on the table": P + """
verify.step.rate = "0.1 mm"
plant.axis = "linear"
plant.mass = "480 kg"
plant.ball_screw = { lead = "10 mm", stiffness = "180 N/um", backlash = "4 um" }
plant.motor = { inertia = "62 kg cm^2" }
plant.drive = { kind = "torque", limit = "27 N m" }
plant.friction.pivot = { model = "coulomb", coulomb = "150 N", viscous = 900.0 }
plant.sensors.encoder = { resolution = "0.1 um" }
plant.interface = { sample_period = "0.5 ms" }
""",
    "Z axis with a rigid screw": P + """
plant.axis = "linear"
plant.mass = "35 kg"
plant.ball_screw = { lead = "5 mm" }
plant.motor = { inertia = "1.3 kg cm^2", torque_constant = 0.36, resistance = 1.1 }
plant.drive = { kind = "current", limit = "9 A", bandwidth = "600 Hz" }
plant.friction.pivot = { viscous = 300.0 }
plant.sensors.encoder = { place = "motor", counts = 131072 }
plant.interface = { sample_period = "1 ms" }
""",
    "linear motor with a scale": P + """
plant.axis = "linear"
plant.mass = 6.0
plant.motor = { torque_constant = 45.0 }
plant.drive = { kind = "current", limit = 9.0 }
plant.sensors.encoder = { resolution = 1e-6 }
plant.interface = { sample_period = 0.25e-3 }
""",
    "wafer stage": P + """
verify.step.rate = "10 um"
plant.axis = "linear"
plant.lumped = { mass = "22 kg", tip_mass = "4 kg", stiffness = "60 N/um" }
plant.motor = { torque_constant = 70.0 }
plant.drive = { kind = "current", limit = "12 A", bandwidth = "2 kHz" }
plant.sensors.encoder = { resolution = "1 nm" }
plant.interface = { sample_period = "0.1 ms" }
""",
    "hydraulic-size linear axis, tachometer": P + """
plant.axis = "linear"
plant.mass = "2.5 t"
plant.drive = { kind = "torque", limit = "40 kN" }
plant.friction.pivot = { viscous = 8000.0 }
plant.sensors.tachometer = { noise = "0.2 mm/s" }
plant.interface = { sample_period = "2 ms" }
""",
    # cables
    "cable-driven sight": P + """
plant.inertia = 4.0
plant.cable = { ratio = 30.0, stiffness = "25 kN m/rad" }
plant.motor = { inertia = 2e-3, torque_constant = 0.3 }
plant.drive = { kind = "current", limit = 12.0, bandwidth = "300 Hz" }
plant.friction.pivot = { model = "dahl", coulomb = 1.0, rest_stiffness = 5e3, viscous = 0.6 }
plant.sensors.hub_gyro = { natural_frequency = "100 Hz", noise = "0.01 deg/s" }
plant.interface = { sample_period = 1e-3 }
""",
    "cable crane trolley": P + """
plant.axis = "linear"
plant.mass = "900 kg"
plant.cable = { ratio = 12.0, stiffness = "2 MN/m" }
plant.motor = { inertia = "0.3 kg m^2" }
plant.drive = { kind = "torque", limit = "250 N m" }
plant.friction.pivot = { viscous = 400.0 }
plant.sensors.encoder = { place = "motor", counts = 8192 }
plant.interface = { sample_period = "5 ms" }
""",
    "cable-driven surgical wrist": P + """
plant.inertia = "18 g cm^2"
plant.cable = { ratio = 12.0, stiffness = 30.0 }
plant.motor = { inertia = "4.4 g cm^2", torque_constant = "13.9 mN m/A" }
plant.drive = { kind = "current", limit = "1.2 A" }
plant.friction.motor = { model = "coulomb", coulomb = "0.6 mN m", viscous = 1e-7 }
plant.sensors.encoder = { place = "motor", counts = 65536 }
plant.interface = { sample_period = "1 ms" }
""",
    # n inertias
    "five inertias in a chain": P + """
plant.motor = { inertia = 2e-4 }
plant.gearbox = { ratio = 60.0, stiffness = 4e4 }
plant.drive = { limit = 3.0 }
plant.sensors.encoder = { counts = 4194304 }
plant.interface = { sample_period = 1e-3 }
[plant.lumped]
hub_inertia = 1.2
beam_inertia = 0.8
stiffness = 9e4
chain = [{ inertia = 0.5, stiffness = 7e4 }, { inertia = 0.3, stiffness = 7e4 }, { inertia = 0.1, stiffness = 5e4 }]
""",
    "mast of four lumps, gyroscope": P + """
plant.drive = { kind = "torque", limit = "900 N m" }
plant.sensors.hub_gyro = { natural_frequency = "60 Hz", noise = "0.01 deg/s" }
plant.interface = { sample_period = "2 ms" }
[plant.lumped]
hub_inertia = 40.0
beam_inertia = 25.0
stiffness = "400 kN m/rad"
chain = [{ inertia = 12.0, stiffness = "250 kN m/rad" }, { inertia = 6.0, stiffness = "150 kN m/rad" }]
""",
    # the smallest files
    "inertia and sample period": P + """
plant.inertia = 0.5
plant.interface.sample_period = 1e-3
""",
    "inertia, torque constant and sample period": P + """
plant.inertia = "3 kg cm^2"
plant.motor.torque_constant = "50 mN m/A"
plant.interface.sample_period = "1 ms"
""",
    "mass and a word": P + """
plant.axis = "linear"
plant.mass = "12 kg"
plant.drive = "torque"
plant.sensors.encoder = { resolution = "5 um" }
plant.interface.sample_period = "1 ms"
""",
    # tolerances on every kind
    "tolerances on a belt axis": P + """
plant.inertia = { value = 1.0, tolerance = 0.1 }
plant.belt = { ratio = 10.0, stiffness = { value = 2000.0, tolerance = 0.3 } }
plant.motor = { inertia = 0.02, torque_constant = { value = 0.5, tolerance = 0.1 }, resistance = { value = 8.0, tolerance = 0.15 } }
plant.drive = { kind = "voltage", limit = 100.0 }
plant.friction.pivot = { viscous = 1.0 }
plant.sensors.encoder = { counts = 65536 }
plant.interface = { sample_period = 2e-3 }
""",
    "tolerances on a direct drive": P + """
plant.inertia = { value = "0.5 kg m^2", tolerance = "0.05 kg m^2" }
plant.drive = { kind = "torque", limit = 60.0 }
plant.friction.pivot = { model = "coulomb", coulomb = { value = 0.4, tolerance = 0.5 }, viscous = 0.3 }
plant.sensors.hub_gyro = { natural_frequency = { value = 400.0, tolerance = 0.2 }, noise = 2e-4 }
plant.interface = { sample_period = 1e-3 }
""",
    "tolerances on a screw": P + """
synth.loop = "cascade"
verify.step.rate = 1e-3
plant.axis = "linear"
plant.mass = { value = 70.0, tolerance = 0.2 }
plant.ball_screw = { lead = 0.04, stiffness = { value = 2.467e8, tolerance = 0.3 } }
plant.motor = { inertia = 4.1e-3 }
plant.drive = { kind = "torque", limit = 20.0 }
plant.friction.pivot = { viscous = 1.0 }
plant.sensors.encoder = { place = "motor", counts = 1048576 }
plant.interface = { sample_period = 1e-3 }
""",
}

# Drawn after the programs were finished with MACHINES: sizes over nine decades and combinations that those do not have.
OTHERS = {
    "optical chopper mirror, resolver": P + """
plant.inertia = "0.9 g cm^2"
plant.motor = { torque_constant = "1.1 mN m/A", resistance = "9 ohm" }
plant.drive = { kind = "voltage", limit = "6 V" }
plant.sensors.resolver = { natural_frequency = "3 kHz", noise = "1 arcmin" }
plant.interface = { sample_period = "0.2 ms" }
""",
    "wind turbine yaw, four gearmotors as one": P + """
plant.inertia = 6.0e6
plant.gearbox = { ratio = 1200.0, stiffness = "900 MN m/rad" }
plant.motor = { inertia = "0.12 kg m^2" }
plant.drive = { kind = "torque", limit = "160 N m" }
plant.friction.pivot = { model = "coulomb", coulomb = "12 kN m", viscous = 60e3 }
plant.sensors.encoder = { counts = 1048576 }
plant.interface = { sample_period = "10 ms" }
""",
    "linear-motor pick and place, tachometer cascade": P + """
plant.axis = "linear"
plant.lumped = { mass = "3.1 kg", tip_mass = "0.6 kg", stiffness = "0.9 N/um" }
plant.motor = { torque_constant = 38.0, resistance = 3.3, inductance = "2.4 mH" }
plant.drive = { kind = "voltage", limit = "300 V" }
plant.sensors.tachometer = { noise = "1 mm/s", natural_frequency = "800 Hz" }
plant.interface = { sample_period = "0.25 ms" }
""",
    "cable-driven haptic handle, torque drive, position": P + """
plant.inertia = "9 kg cm^2"
plant.cable = { ratio = 9.5, stiffness = "180 N m/rad" }
plant.motor = { inertia = "54 g cm^2" }
plant.drive = { kind = "torque", limit = "0.18 N m" }
plant.friction.motor = { model = "coulomb", coulomb = "1 mN m", viscous = 4e-7 }
plant.sensors.encoder = { place = "motor", counts = 16384 }
plant.interface = { sample_period = "0.5 ms" }
""",
    "crane slewing ring on a harmonic drive, gyroscope": P + """
plant.lumped = { hub_inertia = 900.0, beam_inertia = 2400.0, stiffness = "1.2 MN m/rad" }
plant.harmonic_drive = { ratio = 160.0, stiffness = "2.2 MN m/rad" }
plant.motor = { inertia = "21 kg cm^2", torque_constant = 0.9 }
plant.drive = { kind = "current", limit = "70 A", bandwidth = "400 Hz" }
plant.sensors.hub_gyro = { natural_frequency = "50 Hz", noise = "0.02 deg/s" }
plant.interface = { sample_period = "2 ms" }
""",
    "syringe pump, rigid screw, cascade": P + """
synth.loop = "cascade"
verify.step.rate = "0.2 mm"
plant.axis = "linear"
plant.mass = "250 g"
plant.ball_screw = { lead = "1 mm" }
plant.motor = { inertia = "11 g cm^2", torque_constant = "31 mN m/A", resistance = 7.4 }
plant.drive = { kind = "voltage", limit = "24 V" }
plant.friction.pivot = { viscous = 400.0 }
plant.sensors.encoder = { place = "motor", counts = 8000 }
plant.interface = { sample_period = "1 ms" }
""",
    "rate table under gravity, tachometer on the motor": P + """
model.hub_angle = "30 deg"
plant.lumped = { hub_inertia = 0.6, out_of_balance = 0.4 }
plant.gearbox = { ratio = 36.0 }
plant.motor = { inertia = "0.7 kg cm^2", torque_constant = 0.11, resistance = 0.8, inductance = "1.9 mH" }
plant.drive = { kind = "voltage", limit = "48 V" }
plant.friction.motor = { model = "coulomb", coulomb = 0.01, viscous = 2e-5 }
plant.sensors.tachometer = { place = "motor", noise = "2 rpm" }
plant.interface = { sample_period = "1 ms" }
""",
    "belt gantry with a slow clock": P + """
plant.axis = "linear"
plant.mass = "140 kg"
plant.belt = { ratio = 52.0, stiffness = "1.6 MN/m" }
plant.motor = { inertia = "19 kg cm^2" }
plant.drive = { kind = "torque", limit = "18 N m" }
plant.friction.pivot = { model = "coulomb", coulomb = "40 N", viscous = 210.0 }
plant.sensors.encoder = { resolution = "10 um" }
plant.interface = { sample_period = "8 ms" }
""",
    "six masses in a chain, current loop, resolver": P + """
plant.motor = { torque_constant = 2.1 }
plant.drive = { kind = "current", limit = "20 A", bandwidth = "700 Hz" }
plant.sensors.resolver = { natural_frequency = "500 Hz", noise = "5 arcsec" }
plant.interface = { sample_period = "1 ms" }
[plant.lumped]
hub_inertia = 3.0
beam_inertia = 1.0
stiffness = "220 kN m/rad"
chain = [{ inertia = 0.7, stiffness = "150 kN m/rad" }, { inertia = 0.5, stiffness = "120 kN m/rad" }, { inertia = 0.3, stiffness = "90 kN m/rad" }, { inertia = 0.2, stiffness = "60 kN m/rad" }]
""",
    "micro stage, tolerance on everything": P + """
verify.step.rate = "1 um"
plant.axis = "linear"
plant.mass = { value = "40 g", tolerance = 0.1 }
plant.motor = { torque_constant = { value = 2.4, tolerance = 0.1 } }
plant.drive = { kind = "current", limit = "1.5 A" }
plant.friction.pivot = { viscous = { value = 0.5, tolerance = 0.5 } }
plant.sensors.encoder = { resolution = "5 nm" }
plant.interface = { sample_period = "0.1 ms" }
""",
}
