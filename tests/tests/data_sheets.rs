//! Machines as a new user would write them from data sheets: from a watch's balance to a radio telescope, rotary and linear, direct, on belts,
//! cables, gears, harmonic drives and ball screws, with every sensor of the loop. Each is designed and verified, or refused in one sentence.
//!
//! Every sixth machine runs by default; `COUNTERPOISE_SHEETS=all` runs every one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::{World, run_stages, with_chosen_weights};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::errors::describe_pipeline_error;

/// Name and file of each machine.
const MACHINES: [(&str, &str); 23] = [
    (
        "balance wheel of a watch on its hairspring (ETA 2824)",
        "# Escapement test bench: balance wheel, 12 mg cm^2, hairspring, voice coil (ETA 2824 balance, 4 Hz)
         format = 2
         [plant]
         name = \"balance wheel\"
         drive = { limit = \"2 uN m\" }
         [plant.lumped]
         hub_inertia = \"12 mg cm^2\"
         position_stiffness = \"0.758 uN m/rad\"
         [plant.sensors.resolver]
         noise = \"0.05 deg\"
         [plant.interface]
         sample_period = \"0.5 ms\"",
    ),
    (
        "azimuth of a radio telescope of 100 m",
        "# Effelsberg-like 100 m dish azimuth: 2e8 kg m^2, drives through gears 1:12000, first resonance 0.8 Hz
         format = 2
         [plant]
         name = \"100 m telescope azimuth\"
         lumped = { hub_inertia = \"60e6 kg m^2\", beam_inertia = \"140e6 kg m^2\", stiffness = \"1.1 GN m/rad\" }
         gearbox = { ratio = \"12000:1\", stiffness = \"8 GN m/rad\" }
         motor = { inertia = \"0.5 kg m^2\", torque_constant = \"2.1 N m/A\" }
         drive = { kind = \"current\", limit = \"150 A\", bandwidth = \"100 Hz\" }
         sensors = { encoder = { counts = \"26 bit\" } }
         interface = { sample_period = \"10 ms\" }",
    ),
    (
        "galvanometer scanner (Cambridge Technology 6215H)",
        "# Cambridge Technology 6215H: rotor 0.028 g cm^2, Kt 3.78e4 dyne cm/A, 2.5 ohm, 94 uH, mirror 0.02 g cm^2
         format = 2
         [plant]
         name = \"galvanometer scanner\"
         inertia = \"0.02 g cm^2\"
         motor = { inertia = \"0.028 g cm^2\", torque_constant = \"3.78e4 dyne cm/A\", resistance = \"2.5 ohm\", inductance = \"94 uH\" }
         drive = { kind = \"voltage\", limit = \"24 V\" }
         sensors = { resolver = { noise = \"8 urad\" } }
         interface = { sample_period = \"20 us\" }",
    ),
    (
        "actuator of a hard disk",
        "# Hard-disk VCM arm; IEEJ benchmark style, VCM with one 2.7 kHz arm mode
         format = 2
         [plant]
         name = \"disk actuator\"
         lumped = { hub_inertia = \"1.2e-6 kg m^2\", beam_inertia = \"0.3e-6 kg m^2\", stiffness = \"70 N m/rad\" }
         motor = { torque_constant = \"0.05 N m/A\" }
         drive = { kind = \"current\", limit = \"1 A\", delay = \"10 us\" }
         sensors = { encoder = { counts = \"24 bit\" } }
         interface = { sample_period = \"40 us\" }",
    ),
    (
        "stage on a linear voice coil",
        "# Linear voice coil BEI LA13-12: 8.9 N/A... moving mass 0.25 kg, 1 um encoder
         format = 2
         [plant]
         axis = \"linear\"
         mass = \"250 g\"
         motor = { torque_constant = \"8.9 N/A\", resistance = \"3.4 ohm\", inductance = \"1.1 mH\" }
         drive = { kind = \"voltage\", limit = \"24 V\" }
         friction = { pivot = { viscous = \"2 N s/m\" } }
         sensors = { encoder = { resolution = \"1 um\" } }
         interface = { sample_period = \"200 us\" }",
    ),
    (
        "wafer stage on a linear motor",
        "# Iron-core linear motor Aerotech BLMC: 40 kg, 68 N/A, laser scale 1 nm
         format = 2
         [plant]
         axis = \"linear\"
         mass = \"40 kg\"
         motor = { torque_constant = \"68 N/A\" }
         drive = { kind = \"current\", limit = \"15 A\", bandwidth = \"1.5 kHz\" }
         sensors = { encoder = { resolution = \"1 nm\" } }
         interface = { sample_period = \"100 us\" }",
    ),
    (
        "table of a machine tool, cascade over a ball screw",
        "# Machine tool X axis: 600 kg, ball screw 40x10, 180 N/um, Siemens 1FT7
         format = 2
         [plant]
         axis = \"linear\"
         mass = \"600 kg\"
         ball_screw = { lead = \"10 mm/rev\", stiffness = \"180 N/um\" }
         motor = { inertia = \"0.0085 kg m^2\", torque_constant = \"1.58 N m/A\" }
         drive = { kind = \"current\", limit = \"24 A\", bandwidth = \"500 Hz\" }
         friction = { pivot = { viscous = \"4 kN s/m\" } }
         sensors = { encoder = { place = \"motor\", counts = \"20 bit\" } }
         interface = { sample_period = \"0.25 ms\" }
         [synth]
         loop = \"cascade\"",
    ),
    (
        "carriage of a printer on a belt",
        "# Ink-jet carriage on a toothed belt: 0.4 kg, pulley 10 mm radius, linear strip 600 lpi
         format = 2
         [plant]
         axis = \"linear\"
         mass = \"400 g\"
         belt = { ratio = \"100 rad/m\", stiffness = \"30 kN/m\" }
         motor = { inertia = \"20 g cm^2\", torque_constant = \"22 mN m/A\", resistance = \"4.5 ohm\", inductance = \"3 mH\" }
         drive = { kind = \"voltage\", limit = \"24 V\" }
         sensors = { encoder = { resolution = \"10.6 um\" } }
         interface = { sample_period = \"1 ms\" }",
    ),
    (
        "equatorial mount on a worm gear",
        "# Amateur equatorial mount: worm 180:1, 3 kg m^2
         format = 2
         [plant]
         name = \"equatorial mount\"
         inertia = \"3 kg m^2\"
         gearbox = { ratio = \"180:1\", backlash = \"20 arcsec\", stiffness = \"10 kN m/rad\" }
         motor = { inertia = \"120 g cm^2\", torque_constant = \"0.06 N m/A\" }
         drive = { kind = \"current\", limit = \"2 A\" }
         sensors = { encoder = { counts = \"10000 counts\" } }
         interface = { sample_period = \"5 ms\" }",
    ),
    (
        "joint of a robot on a harmonic drive",
        "# UR-like joint 3: HD CSG-25-100, 31 kN m/rad, rotor 0.5 kg cm^2
         format = 2
         [plant]
         name = \"cobot joint\"
         inertia = \"2.5 kg m^2\"
         harmonic_drive = { ratio = \"101:1\", stiffness = \"31 kN m/rad\", hysteresis = \"3 N m\", kinematic_error = \"0.8 arcmin\" }
         motor = { inertia = \"0.5 kg cm^2\", torque_constant = \"0.12 N m/A\" }
         drive = { kind = \"current\", limit = \"10 A\", bandwidth = \"1 kHz\" }
         sensors = { encoder = { place = \"motor\", counts = \"17 bit\" } }
         interface = { sample_period = \"0.5 ms\" }",
    ),
    (
        "haptic handle on a cable (maxon RE30)",
        "# Capstan haptic handle: 12:1 cable, maxon RE30 (138 mN m stall 25.9 mN m/A, 33.5 g cm^2)
         format = 2
         [plant]
         name = \"haptic handle\"
         inertia = \"15 kg cm^2\"
         cable = { ratio = \"12:1\", stiffness = \"350 N m/rad\" }
         motor = { inertia = \"33.5 g cm^2\", torque_constant = \"25.9 mN m/A\" }
         drive = { kind = \"current\", limit = \"6 A\" }
         sensors = { encoder = { place = \"motor\", counts = \"4000 cpr\" } }
         interface = { sample_period = \"1 ms\" }",
    ),
    (
        "traverse of a turret",
        "# Tank turret traverse: 23000 kg m^2, 400:1
         format = 2
         [plant]
         name = \"turret traverse\"
         inertia = \"23000 kg m^2\"
         gearbox = { ratio = \"400:1\", stiffness = \"15 MN m/rad\", backlash = \"0.5 mrad\" }
         motor = { inertia = \"0.06 kg m^2\" }
         drive = { limit = \"120 N m\" }
         sensors = { hub_gyro = { noise = \"0.005 deg/s\", natural_frequency = \"80 Hz\" } }
         interface = { sample_period = \"1 ms\" }",
    ),
    (
        "camera gimbal with a brushless motor (GM3506)",
        "# Brushless gimbal motor GM3506: Kt 0.11, 5.6 ohm, MPU gyro
         format = 2
         [plant]
         name = \"camera gimbal\"
         inertia = \"9 kg cm^2\"
         motor = { torque_constant = \"0.11 N m/A\", resistance = \"5.6 ohm\" }
         drive = { kind = \"voltage\", limit = \"11.1 V\" }
         sensors = { hub_gyro = { noise = \"0.05 dps\", natural_frequency = \"188 Hz\", delay = \"2 ms\" } }
         interface = { sample_period = \"1 ms\" }",
    ),
    (
        "solar tracker on a slew drive",
        "# Solar tracker: slew drive 62:1 + gearmotor 3300 rpm 24 V, 800 kg m^2
         format = 2
         [plant]
         name = \"tracker\"
         inertia = \"800 kg m^2\"
         gearbox = { ratio = \"18000:1\", backlash = \"0.1 deg\", stiffness = \"400 kN m/rad\" }
         motor = { inertia = \"600 g cm^2\", torque_constant = \"0.065 N m/A\", resistance = \"0.6 ohm\" }
         drive = { kind = \"voltage\", limit = \"24 V\" }
         sensors = { encoder = { counts = \"12 bit\" } }
         interface = { sample_period = \"50 ms\" }",
    ),
    (
        "pitch of a wind turbine's blade",
        "# Wind turbine pitch drive: blade 12000 kg m^2, 1500:1
         format = 2
         [plant]
         name = \"blade pitch\"
         inertia = \"12000 kg m^2\"
         gearbox = { ratio = \"1500:1\", stiffness = \"30 MN m/rad\" }
         motor = { inertia = \"0.02 kg m^2\", torque_constant = \"1.2 N m/A\" }
         drive = { kind = \"current\", limit = \"60 A\" }
         friction = { pivot = { model = \"coulomb\", coulomb = \"4 kN m\" } }
         sensors = { encoder = { place = \"motor\", counts = \"13 bit\" } }
         interface = { sample_period = \"5 ms\" }",
    ),
    (
        "flexure stage without damping",
        "# Flexure stage: 0.3 kg, 4 N/um, voice coil 20 N/A
         format = 2
         [plant]
         axis = \"linear\"
         lumped = { mass = \"0.3 kg\", position_stiffness = \"0.2 N/um\" }
         motor = { torque_constant = \"20 N/A\" }
         drive = { kind = \"current\", limit = \"4 A\" }
         sensors = { encoder = { resolution = \"5 nm\" } }
         interface = { sample_period = \"0.1 ms\" }",
    ),
    (
        "hobby servo (MG996R)",
        "# MG996R: 11 kg cm at 6 V, 0.17 s/60 deg, pot feedback 10 bit, 310:1
         format = 2
         [plant]
         name = \"rc servo\"
         inertia = \"20 kg cm^2\"
         gearbox = { ratio = \"310:1\" }
         motor = { inertia = \"1 g cm^2\", torque_constant = \"3.5 mN m/A\", resistance = \"2.2 ohm\" }
         drive = { kind = \"voltage\", limit = \"6 V\" }
         sensors = { encoder = { counts = \"10 bit\" } }
         interface = { sample_period = \"20 ms\" }",
    ),
    (
        "lift on a rope, gearless",
        "# Elevator car 1600 kg on a linear axis, gearless machine, sheave 0.5 m diameter, rope 1 MN/m
         format = 2
         [plant]
         axis = \"linear\"
         gravity = 0
         mass = \"3000 kg\"
         cable = { ratio = \"4 rad/m\", stiffness = \"1 MN/m\" }
         motor = { inertia = \"18 kg m^2\" }
         drive = { limit = \"900 N m\" }
         sensors = { tachometer = { place = \"motor\" } }
         interface = { sample_period = \"4 ms\" }",
    ),
    (
        "spindle of a centrifuge",
        "# Centrifuge spindle speed loop 3000 rpm, 1.2 kg m^2
         format = 2
         [plant]
         name = \"centrifuge\"
         inertia = \"1.2 kg m^2\"
         motor = { torque_constant = \"0.7 N m/A\", resistance = \"0.4 ohm\", inductance = \"3 mH\" }
         drive = { kind = \"voltage\", limit = \"300 V\" }
         sensors = { tachometer = { noise = \"1 rpm\" } }
         interface = { sample_period = \"2 ms\" }",
    ),
    (
        "antenna on a vehicle, gyroscopes on antenna and platform",
        "# Ka band antenna elevation: 0.9 kg m^2, belt 8:1, maxon EC60 (Kt 0.0533, 1210 g cm^2), gyro, base moves
         format = 2
         [plant]
         name = \"satcom elevation\"
         lumped = { hub_inertia = \"0.9 kg m^2\", out_of_balance = \"0.1 kg m\" }
         belt = { ratio = \"8:1\", stiffness = \"3 kN m/rad\" }
         motor = { inertia = \"1210 g cm^2\", torque_constant = \"53.3 mN m/A\" }
         drive = { kind = \"current\", limit = \"20 A\" }
         [plant.sensors]
         hub_gyro = { noise = \"0.02 deg/s\", natural_frequency = \"200 Hz\" }
         platform_gyro = { noise = \"0.02 deg/s\" }
         [plant.interface]
         sample_period = \"1 ms\"",
    ),
    (
        "series elastic knee, torque against a spring",
        "# Series elastic actuator: spring 300 N m/rad, torque loop against the leg
         format = 2
         [plant]
         name = \"series elastic knee\"
         lumped = { hub_inertia = \"0.3 kg m^2\", position_stiffness = \"60 N m/rad\" }
         gearbox = { ratio = \"50:1\", stiffness = \"300 N m/rad\" }
         motor = { inertia = \"0.6 kg cm^2\", torque_constant = \"0.1 N m/A\" }
         drive = { kind = \"current\", limit = \"15 A\", bandwidth = \"800 Hz\" }
         sensors = { torque = { noise = \"0.05 N m\" } }
         interface = { sample_period = \"1 ms\" }",
    ),
    (
        "current loop of a motor (maxon RE40)",
        "# Current loop of a dc motor, maxon RE40: 24 V, 0.3 ohm, 82 uH, 30 mN m/A, 142 g cm^2
         format = 2
         [plant]
         name = \"current loop\"
         inertia = \"142 g cm^2\"
         motor = { torque_constant = \"30.2 mN m/A\", resistance = \"0.299 ohm\", inductance = \"0.0823 mH\" }
         drive = { kind = \"voltage\", limit = \"24 V\" }
         friction = { pivot = { viscous = \"5 uN m s/rad\" } }
         sensors = { current = { noise = \"20 mA\" } }
         interface = { sample_period = \"50 us\" }",
    ),
    (
        "servo press with a load cell",
        "# Servo press: ball screw 5 mm, 200 N/um, pushes on a part of 20 N/um, load cell
         format = 2
         [plant]
         axis = \"linear\"
         lumped = { mass = \"60 kg\", position_stiffness = \"20 N/um\" }
         ball_screw = { lead = \"5 mm/rev\", stiffness = \"200 N/um\" }
         motor = { inertia = \"5 kg cm^2\" }
         drive = { limit = \"8 N m\" }
         sensors = { torque = { noise = \"5 N\" } }
         interface = { sample_period = \"0.5 ms\" }",
    ),
];

/// The fault of a file, the file, and what the one sentence about it must name.
const REFUSED: [(&str, &str, &[&str]); 6] = [
    (
        "an accelerometer alone",
        "format = 2
         plant.inertia = 0.3
         plant.drive = { limit = 5.0 }
         plant.sensors.accelerometer = { noise = 0.01 }
         plant.interface = { sample_period = 1e-3 }",
        &["plant.sensors.accelerometer", "steady rate", "hub_gyro"],
    ),
    (
        "a torque loop of a load that nothing holds",
        "format = 2
         plant.inertia = 0.3
         plant.gearbox = { ratio = 50.0, stiffness = 300.0 }
         plant.motor = { inertia = 6e-5, torque_constant = 0.1 }
         plant.drive = { kind = \"current\", limit = 15.0 }
         plant.sensors.torque = { noise = 0.05 }
         plant.interface = { sample_period = 1e-3 }",
        &["plant.sensors.torque", "run away", "viscous", "position_stiffness"],
    ),
    (
        "a torque sensor in a rigid transmission",
        "format = 2
         plant.inertia = 0.3
         plant.gearbox = { ratio = 50.0 }
         plant.drive = { limit = 15.0 }
         plant.sensors.torque = { noise = 0.05 }
         plant.interface = { sample_period = 1e-3 }",
        &["plant.sensors.torque", "rigid", "stiffness"],
    ),
    (
        "a current loop without an inductance",
        "format = 2
         plant.inertia = 1e-5
         plant.motor = { torque_constant = 0.03, resistance = 0.3 }
         plant.drive = { kind = \"voltage\", limit = 24.0 }
         plant.sensors.current = { noise = 0.02 }
         plant.interface = { sample_period = 1e-4 }",
        &["plant.sensors.current", "inductance"],
    ),
    (
        "a current loop of a drive that takes a torque",
        "format = 2
         plant.inertia = 1e-5
         plant.drive = { limit = 1.0 }
         plant.sensors.current = { noise = 0.02 }
         plant.interface = { sample_period = 1e-4 }",
        &["plant.sensors.current", "takes a torque", "voltage"],
    ),
    (
        "a torque constant as a voltage per rate",
        "format = 2
         plant.inertia = 1.2
         plant.motor = { torque_constant = \"0.7 V/(rad/s)\", resistance = 0.4 }
         plant.drive = { kind = \"voltage\", limit = 300.0 }
         plant.sensors.tachometer = { noise = \"1 rpm\" }
         plant.interface = { sample_period = 2e-3 }",
        &["torque_constant", "torque per current", "voltage per angular rate"],
    ),
];

struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("there is no {name}"))
    }
}

fn read(text: &str) -> Result<Project, Vec<String>> {
    let document = Document::parse(text, "project.toml");
    Project::resolve_for(&document, &Attachments::none(), Purpose::Design)
        .map(|parsed| parsed.project)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect())
}

#[test]
fn every_machine_of_a_data_sheet_is_designed_and_its_loop_is_stable() {
    let step = if std::env::var_os("COUNTERPOISE_SHEETS").is_some() { 1 } else { 6 };
    let mut wrong = Vec::new();
    for (name, text) in MACHINES.into_iter().step_by(step) {
        assert!(text.lines().count() <= 16, "{name} is a short file");
        let made = read(text).map_err(|errors| errors.join("; ")).and_then(|project| {
            let chosen =
                with_chosen_weights(&project).map_err(|error| describe_pipeline_error(&error))?.unwrap();
            run_stages(&chosen.project, &HeaderText, &EmptyWorld)
                .map_err(|error| describe_pipeline_error(&error))
        });
        match made {
            Err(error) => wrong.push(format!("{name}: {error}")),
            Ok(stages) => {
                let margins = &stages.verified.verification().evidence.margins;
                let (gain, phase) =
                    (margins.gain_margin_db(), margins.phase_margin().map_or(180.0, |m| m.deg));
                // what a first design keeps, within the rounding of its weights
                if !margins.closed_loop_stable || gain < 5.9 || phase.abs() < 39.0 {
                    wrong.push(format!("{name}: {gain} dB, {phase} degrees"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_no_loop_can_do_is_refused_in_one_sentence_that_says_what_to_add() {
    for (name, text, names) in REFUSED {
        let said = read(text).expect_err(name);
        assert_eq!(said.len(), 1, "{name}: {said:?}");
        for word in names {
            assert!(said[0].contains(word), "{name}: {word} in {}", said[0]);
        }
    }
}
