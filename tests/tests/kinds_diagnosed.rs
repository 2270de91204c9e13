//! Every kind of machine back from its recordings: a clean machine is consistent, a concealed effect is named, and what is identified
//! contains the truth. The recordings are simulated under the kind's own designed controller.
//!
//! A part of the kinds runs by default; `COUNTERPOISE_KINDS=all` runs every one, and `COUNTERPOISE_KINDS=NAME` one of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::Controller;
use counterpoise_diagnose::diagnosis::Diagnosis;
use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict};
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_diagnose::identification::{Estimate, Note, identify};
use counterpoise_diagnose::library::{Component, EffectName};
use counterpoise_models::{AmplifierDynamics, Parameters, Plant, Ripple};
use counterpoise_pipeline::{build_plant_model, reduce_plant, synthesise, with_chosen_weights};
use counterpoise_pool::Serial;
use counterpoise_project::{Document, Project, Purpose};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{RecordedController, ReplayLoop};
use counterpoise_simulate::signal::{Signal, Sine};
use counterpoise_simulate::{Detail, Imperfections, Initial, PlatformMotion, Scenario, Simulator};

use Component as C;
use EffectName as E;

/// A kind of machine, and the effect that one machine of it conceals.
struct Kind {
    name: &'static str,
    file: &'static str,
    conceals: fn(&mut Parameters),
    /// Names that explain the effect: itself, and what this machine cannot tell from it.
    names: &'static [(C, E)],
}

/// A current loop on a voltage drive.
const CURRENT_LOOP: &str = "format = 2
            plant.inertia = 1.42e-5
            plant.motor = { torque_constant = 0.0302, resistance = 0.299, inductance = 8.23e-5 }
            plant.drive = { kind = \"voltage\", limit = 24.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 1e-3, viscous = 5e-6 }
            plant.sensors.current = { noise = 1e-3 }
            plant.interface = { sample_period = 2e-4, output_bits = 16 }";

/// A joint whose torque is measured behind an elastic gear, against a spring.
const ELASTIC_JOINT: &str = "format = 2
            verify.step.rate = 3.0
            plant.lumped = { hub_inertia = 0.3, position_stiffness = 60.0 }
            plant.gearbox = { ratio = 50.0, stiffness = 300.0 }
            plant.motor = { inertia = 6e-5, torque_constant = 0.1 }
            plant.drive = { kind = \"current\", limit = 15.0, bandwidth = \"800 Hz\" }
            plant.friction.pivot = { viscous = 0.1 }
            plant.friction.motor = { model = \"coulomb\", coulomb = 0.01, viscous = 1e-5 }
            plant.sensors.torque = { noise = 5e-3 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }";

/// A belt whose tension is measured, on a load that a spring holds.
const BELT_TENSION: &str = "format = 2
            verify.step.rate = 5.0
            plant.lumped = { hub_inertia = 0.8, position_stiffness = 150.0 }
            plant.belt = { ratio = 8.0, stiffness = 1500.0 }
            plant.motor = { inertia = 0.004, torque_constant = 0.4 }
            plant.drive = { kind = \"current\", limit = 20.0, bandwidth = \"500 Hz\" }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.4, viscous = 1.5 }
            plant.sensors.torque = { noise = 1e-2, natural_frequency = 2000.0 }
            plant.sensors.motor_tachometer = { noise = 2e-3 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }";

const KINDS: [Kind; 22] = [
    Kind {
        name: "direct torque drive, gyroscope",
        file: "format = 2
            plant.inertia = 0.5
            plant.drive = { kind = \"torque\", limit = 60.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.4, viscous = 0.3 }
            plant.sensors.hub_gyro = { natural_frequency = 400.0, noise = 2e-4 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.lumped.as_mut().unwrap().hub_inertia_kg_m2 *= 1.25,
        names: &[(C::Structure, E::Inertia), (C::Motor, E::TorqueConstant)],
    },
    Kind {
        name: "current loop, cable, tachometer on the motor",
        file: "format = 2
            plant.inertia = 4.0
            plant.cable = { ratio = 30.0 }
            plant.motor = { inertia = 2e-3, torque_constant = 0.3 }
            plant.drive = { kind = \"current\", limit = 12.0, bandwidth = \"300 Hz\" }
            plant.friction.pivot = { model = \"dahl\", coulomb = 4.0, rest_stiffness = 2e4, viscous = 2.0 }
            plant.sensors.tachometer = { place = \"motor\", noise = \"3 deg/s\" }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.pivot_friction.law.scale_coulomb(1.5),
        // a hysteresis of 2 N m over the angle beside a friction of 4 N m is a friction of 6 N m: the recordings cannot tell
        names: &[(C::Pivot, E::Coulomb), (C::Motor, E::Coulomb), (C::Structure, E::Hysteresis)],
    },
    Kind {
        name: "pendulum on a voltage drive, encoder",
        file: "format = 2
            model.hub_angle = -1.5
            plant.lumped = { hub_inertia = 0.00695, out_of_balance = 0.05 }
            plant.motor = { inertia = 0.01195, torque_constant = 1.6225, resistance = 3.949 }
            plant.drive = { kind = \"voltage\", limit = 12.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.02, viscous = 0.01169 }
            plant.sensors.encoder = { counts = 65536 }
            plant.interface = { sample_period = 2e-3, output_bits = 16 }",
        conceals: |p| p.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.08,
        names: &[(C::Structure, E::OutOfBalance), (C::Structure, E::VerticalOffset), (C::Structure, E::PositionStiffness)],
    },
    Kind {
        name: "chain of inertias behind a gearbox, encoder",
        file: "format = 2
            plant.motor = { inertia = 2e-4 }
            plant.gearbox = { ratio = 60.0, stiffness = 4e4, damping = 40.0 }
            plant.drive = { limit = 3.0 }
            plant.friction.pivot = { model = \"dahl\", coulomb = 2.0, rest_stiffness = 1e4, viscous = 1.0 }
            plant.sensors.encoder = { counts = 4194304 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }
            [plant.lumped]
            hub_inertia = 1.2
            beam_inertia = 0.8
            stiffness = 9e4
            chain = [{ inertia = 0.5, stiffness = 7e4 }, { inertia = 0.3, stiffness = 7e4 }]",
        conceals: |p| p.pivot_friction.viscous_nm_s_rad = 3.0,
        names: &[(C::Pivot, E::Viscous), (C::Motor, E::Viscous)],
    },
    Kind {
        name: "belt on a voltage drive, encoder on the load",
        file: "format = 2
            plant.inertia = 1.0
            plant.belt = { ratio = 10.0, stiffness = 2000.0 }
            plant.motor = { inertia = 0.02, torque_constant = 0.5, resistance = 8.0 }
            plant.drive = { kind = \"voltage\", limit = 100.0 }
            plant.friction = { motor = { viscous = 0.01 }, pivot = { model = \"coulomb\", coulomb = 0.5, viscous = 1.0 } }
            plant.sensors.encoder = { counts = 1048576 }
            plant.interface = { sample_period = 2e-3, output_bits = 16 }",
        conceals: |p| p.motor.torque_constant_nm_a *= 0.8,
        names: &[(C::Motor, E::TorqueConstant), (C::Motor, E::Inertia), (C::Structure, E::Inertia)],
    },
    Kind {
        name: "harmonic drive in a cascade, encoder on the motor",
        file: "format = 2
            synth.loop = \"cascade\"
            plant.inertia = 1.5
            plant.harmonic_drive = { ratio = 100.0, stiffness = 16e3, hysteresis = 2.0, kinematic_error = \"0.5 arcmin\" }
            plant.motor = { inertia = 5.5e-5, torque_constant = 0.11 }
            plant.drive = { kind = \"current\", limit = 8.0 }
            plant.friction.motor = { model = \"coulomb\", coulomb = 0.01, viscous = 1e-4 }
            plant.sensors.encoder = { place = \"motor\", counts = 65536 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.motor_friction.law.scale_coulomb(2.0),
        names: &[(C::Motor, E::Coulomb), (C::Pivot, E::Coulomb)],
    },
    Kind {
        name: "ball screw, linear axis in a cascade",
        file: "format = 2
            synth.loop = \"cascade\"
            verify.step.rate = 1e-2
            plant.axis = \"linear\"
            plant.mass = 70.0
            plant.ball_screw = { lead = 0.04, stiffness = 2.467e8, damping = 2467.0 }
            plant.motor = { inertia = 4.1e-3 }
            plant.drive = { kind = \"torque\", limit = 20.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 40.0, viscous = 100.0 }
            plant.sensors.encoder = { place = \"motor\", counts = 1048576 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.lumped.as_mut().unwrap().hub_inertia_kg_m2 *= 1.6,
        names: &[(C::Structure, E::Inertia), (C::Motor, E::Inertia), (C::Motor, E::TorqueConstant)],
    },
    Kind {
        name: "linear motor with a scale",
        file: "format = 2
            plant.axis = \"linear\"
            plant.mass = 6.0
            plant.motor = { torque_constant = 45.0 }
            plant.drive = { kind = \"current\", limit = 9.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 3.0, viscous = 4.0 }
            plant.sensors.encoder = { resolution = 1e-6 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.pivot_friction.asymmetry = 0.4,
        names: &[(C::Pivot, E::AsymmetricFriction), (C::Structure, E::OutOfBalance)],
    },
    Kind {
        name: "direct drive, resolver",
        file: "format = 2
            plant.inertia = 0.02
            plant.drive = { limit = 6.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.03, viscous = 0.01 }
            plant.sensors.resolver = { noise = \"5 arcsec\", natural_frequency = 4000.0 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.motor.cogging = Ripple { amplitude: 0.02, order: 72.0, phase_rad: 0.4 },
        names: &[(C::Motor, E::Cogging), (C::Motor, E::TorqueRipple), (C::Pivot, E::PositionDependentFriction)],
    },
    Kind {
        name: "gearbox on a torque drive, encoder on the motor",
        file: "format = 2
            plant.inertia = 2.0
            plant.gearbox = { ratio = 50.0 }
            plant.motor = { inertia = 3e-4 }
            plant.drive = { limit = 2.0 }
            plant.friction.pivot = { model = \"dahl\", coulomb = 2.0, rest_stiffness = 2e4, viscous = 1.0 }
            plant.sensors.encoder = { place = \"motor\", counts = 262144 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.interface.output_delay_samples = 3,
        names: &[(C::Control, E::Delay), (C::Amplifier, E::Bandwidth), (C::HubGyro, E::Delay), (C::HubGyro, E::Bandwidth)],
    },
    Kind {
        name: "voltage drive, tachometer on the axis",
        file: "format = 2
            plant.inertia = 3.0
            plant.gearbox = { ratio = 20.0 }
            plant.motor = { inertia = 1e-3, torque_constant = 0.4, resistance = 2.0 }
            plant.drive = { kind = \"voltage\", limit = 48.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 2.0, viscous = 1.0 }
            plant.sensors.tachometer = { noise = 2e-4 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| {
            let lumped = p.lumped.as_mut().unwrap();
            lumped.position_stiffness_nm_rad = 60.0;
        },
        names: &[(C::Structure, E::PositionStiffness), (C::Structure, E::OutOfBalance), (C::Structure, E::VerticalOffset)],
    },
    Kind {
        name: "current loop, gyroscope, no friction in the file",
        file: "format = 2
            plant.inertia = 0.8
            plant.motor = { torque_constant = 2.0 }
            plant.drive = { kind = \"current\", limit = 10.0, bandwidth = \"500 Hz\" }
            plant.sensors.hub_gyro = { natural_frequency = 600.0, noise = 1e-4 }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.pivot_friction.law.set_or_add_coulomb_nm(0.5),
        names: &[(C::Pivot, E::Coulomb)],
    },
    Kind {
        name: "current loop on a voltage drive, a weaker motor",
        file: CURRENT_LOOP,
        // the back-EMF constant stays: the current alone shows what the rate makes of it
        conceals: |p| p.motor.torque_constant_nm_a *= 0.8,
        names: &[(C::Motor, E::TorqueConstant), (C::Motor, E::BackEmf), (C::Structure, E::Inertia), (C::Motor, E::Inertia)],
    },
    Kind {
        name: "current loop on a voltage drive, friction at half",
        file: CURRENT_LOOP,
        conceals: |p| p.pivot_friction.law.scale_coulomb(0.5),
        names: &[(C::Pivot, E::Coulomb), (C::Motor, E::Coulomb)],
    },
    Kind {
        name: "torque loop of a series elastic joint, a weaker motor",
        file: ELASTIC_JOINT,
        conceals: |p| p.motor.torque_constant_nm_a *= 0.8,
        names: &[(C::Motor, E::TorqueConstant)],
    },
    Kind {
        name: "torque loop of a series elastic joint, the sensor's scale",
        file: ELASTIC_JOINT,
        conceals: |p| p.sensors.hub_gyro.gain *= 1.1,
        names: &[(C::HubGyro, E::Scale)],
    },
    Kind {
        name: "torque loop of a belt with a tachometer on the motor, more friction",
        file: BELT_TENSION,
        conceals: |p| p.pivot_friction.law.scale_coulomb(2.0),
        names: &[(C::Pivot, E::Coulomb), (C::Motor, E::Coulomb)],
    },
    Kind {
        name: "torque loop of a series elastic joint, friction of the motor",
        file: ELASTIC_JOINT,
        conceals: |p| p.motor_friction.law.scale_coulomb(2.0),
        names: &[(C::Motor, E::Coulomb)],
    },
    Kind {
        name: "torque loop of a series elastic joint, a stiffer gear",
        file: ELASTIC_JOINT,
        conceals: |p| p.gearbox.stiffness_nm_rad *= 1.3,
        names: &[(C::Gearbox, E::Stiffness)],
    },
    Kind {
        name: "direct torque drive, a late gyroscope",
        file: "format = 2
            plant.inertia = 0.5
            plant.drive = { kind = \"torque\", limit = 60.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.4, viscous = 0.3 }
            plant.sensors.hub_gyro = { natural_frequency = 400.0, noise = 2e-4, delay = \"8.4 ms\" }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.pivot_friction.law.scale_coulomb(1.5),
        names: &[(C::Pivot, E::Coulomb), (C::Motor, E::Coulomb)],
    },
    Kind {
        name: "pendulum on a voltage drive, a late encoder",
        file: "format = 2
            model.hub_angle = -1.5
            plant.lumped = { hub_inertia = 0.00695, out_of_balance = 0.05 }
            plant.motor = { inertia = 0.01195, torque_constant = 1.6225, resistance = 3.949 }
            plant.drive = { kind = \"voltage\", limit = 12.0 }
            plant.friction.pivot = { model = \"coulomb\", coulomb = 0.02, viscous = 0.01169 }
            plant.sensors.encoder = { counts = 65536, delay = \"7 ms\" }
            plant.interface = { sample_period = 2e-3, output_bits = 16 }",
        conceals: |p| p.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.08,
        names: &[(C::Structure, E::OutOfBalance), (C::Structure, E::VerticalOffset), (C::Structure, E::PositionStiffness)],
    },
    Kind {
        name: "gearbox on a current loop, a late encoder on the motor with a period of its own",
        file: "format = 2
            plant.inertia = 2.0
            plant.gearbox = { ratio = 50.0, stiffness = 5e4 }
            plant.motor = { inertia = 3e-4, torque_constant = 0.2 }
            plant.drive = { kind = \"current\", limit = 10.0, bandwidth = \"300 Hz\" }
            plant.friction.pivot = { model = \"dahl\", coulomb = 2.0, rest_stiffness = 2e4, viscous = 1.0 }
            plant.sensors.encoder = { place = \"motor\", counts = 262144, delay = \"3 ms\", sample_period = \"4 ms\" }
            plant.interface = { sample_period = 1e-3, output_bits = 16 }",
        conceals: |p| p.lumped.as_mut().unwrap().hub_inertia_kg_m2 *= 1.5,
        names: &[(C::Structure, E::Inertia), (C::Motor, E::Inertia), (C::Motor, E::TorqueConstant)],
    },
];

/// The kinds that run by default.
const DEFAULT: [usize; 1] = [0];

fn chosen_kinds() -> Vec<&'static Kind> {
    match std::env::var("COUNTERPOISE_KINDS") {
        Ok(all) if all == "all" => KINDS.iter().collect(),
        Ok(name) => KINDS.iter().filter(|kind| kind.name.contains(&name)).collect(),
        Err(_) => DEFAULT.iter().map(|&k| &KINDS[k]).collect(),
    }
}

/// Returns the length of a recording, s: shorter if the kinds are those that run by default.
fn length_s() -> f64 {
    if std::env::var_os("COUNTERPOISE_KINDS").is_some() { 8.0 } else { 5.0 }
}

/// A kind with its controller.
struct Machine {
    base: Parameters,
    controller: Controller,
    step: f64,
    angle_rad: f64,
}

impl Machine {
    fn of(kind: &Kind) -> Self {
        let document = Document::parse(kind.file, "project.toml");
        let files = counterpoise_project::Attachments::none();
        let project = Project::resolve_for(&document, &files, Purpose::Design).unwrap().project;
        let chosen = with_chosen_weights(&project).unwrap();
        let project = chosen.map_or(project, |chosen| chosen.project);
        let modelled = build_plant_model(&project).unwrap();
        let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).unwrap()).unwrap();
        Self {
            base: modelled.parameters,
            controller: made.sampled.controller,
            step: project.verify.as_ref().unwrap().procedure.step.rate_rad_s,
            angle_rad: project.model.operating_point.hub_angle_rad,
        }
    }

    /// Two recordings of a machine under the controller: slow and quick sines, with noise and quantisation; without the columns of
    /// sensors that it does not have.
    fn recordings(&self, truth: &Parameters) -> Vec<Recording> {
        let demands = [[(2.0, 0.23), (0.5, 1.3)], [(1.2, 0.71), (0.4, 2.9)]];
        let one = |(k, demand): (usize, [(f64, f64); 2])| {
            let plant = Plant::from_lumped(truth).unwrap();
            let sine = |(amplitude, hz): (f64, f64)| Sine {
                amplitude: amplitude * self.step,
                frequency_rad_s: std::f64::consts::TAU * hz,
                phase_rad: 0.0,
            };
            let scenario = Scenario {
                demand_rad_s: Signal::Sines(demand.into_iter().map(sine).collect()),
                platform: PlatformMotion::STILL,
                imperfections: Imperfections::NoiseAndQuantisation { seed: 11 + k as u64 },
                initial: Initial::Rest { hub_angle_rad: self.angle_rad },
                detail: Detail::Recording,
                ..Scenario::at_rest(length_s())
            };
            let mut runner = self.controller.runner();
            let history = Simulator::new(&plant).unwrap().run(&mut runner, &scenario).unwrap();
            let mut recording = history.readings.recording(&format!("run {k}"), history.sample_period_s);
            let sensors = &truth.sensors;
            let absent = [
                (Channel::MotorRate, sensors.motor_tachometer.is_none()),
                (Channel::HubPosition, sensors.hub_resolver.is_none()),
                (Channel::PlatformRate, !sensors.platform_gyro.is_fitted()),
                (Channel::PlatformAccel, !sensors.platform_accelerometer.is_fitted()),
            ];
            for (channel, _) in absent.into_iter().filter(|(_, is_absent)| *is_absent) {
                recording.remove(channel);
            }
            recording
        };
        demands.into_iter().enumerate().map(one).collect()
    }

    fn diagnose(&self, recordings: &[Recording]) -> Diagnosis {
        self.diagnosed_as(&self.base, recordings)
    }

    /// The diagnosis of recordings that a machine is thought to have made.
    fn diagnosed_as(&self, machine: &Parameters, recordings: &[Recording]) -> Diagnosis {
        let control = ReplayLoop::from_controller(machine, RecordedController::from(self.controller.clone()));
        counterpoise_diagnose::diagnose(machine, control, recordings, &Serial).unwrap()
    }

    /// Returns whether a residual in noise floors is that of a replay of the machine itself: a loop that the effect takes near its limit of stability makes more
    /// of the noise than the floors hold.
    fn is_replayed(&self, residual: f64, truth: &Parameters, recordings: &[Recording]) -> bool {
        let own = || worst_reading(&self.diagnosed_as(truth, recordings).answer.fit.before);
        residual <= REPLAYED || residual <= AS_THE_TRUTH * own()
    }
}

/// Largest residual over its noise floor.
fn largest_ratio(channels: &PooledFits) -> f64 {
    channels.values().map(|fit| fit.rms_error / fit.floor).fold(0.0, f64::max)
}

/// Largest residual of a sensor over its noise floor. The control of a quick loop carries the sensor's noise through the sensitivity, of
/// which its floor knows nothing: it is looked at by [`largest_ratio`] alone.
fn worst_reading(channels: &PooledFits) -> f64 {
    let readings = channels.iter().filter(|(channel, _)| *channel != Channel::Control);
    readings.map(|(_, fit)| fit.rms_error / fit.floor).fold(0.0, f64::max)
}

/// Every number of an answer that a person reads is finite.
fn check_finite(name: &str, answer: &Answer) {
    let fit = &answer.fit;
    for table in [&fit.before, &fit.after, &fit.held_out_before, &fit.held_out_after] {
        assert!(
            table.values().all(|fit| fit.rms_error.is_finite() && fit.floor.is_finite()),
            "{name}: {table:?}"
        );
    }
    for parameter in answer.findings.iter().flat_map(|finding| &finding.parameters) {
        let numbers = [parameter.value, parameter.before, parameter.ci95[0], parameter.ci95[1]];
        assert!(numbers.iter().all(|x| x.is_finite()), "{name}: {parameter:?}");
    }
    assert!(
        answer.map.iter().all(|cell| cell.explained.is_finite() && cell.log_likelihood_gain.is_finite()),
        "{name}"
    );
}

fn describe_answer(answer: &Answer) -> String {
    let one = |f: &counterpoise_diagnose::findings::answer::Finding| {
        let others: Vec<_> = f.alternatives.iter().map(|n| n.names()).collect();
        let values: Vec<_> = f.parameters.iter().map(|p| (p.name, p.value, p.ci95)).collect();
        format!("{:?} p {:.2} or {others:?}: {values:?}", f.name().names(), f.probability)
    };
    let all: Vec<String> = answer.findings.iter().map(one).collect();
    format!("{:?} {}", answer.verdict, all.join("; "))
}

#[test]
fn a_clean_machine_of_every_kind_is_consistent() {
    let mut wrong = Vec::new();
    for kind in chosen_kinds() {
        let machine = Machine::of(kind);
        let answer = machine.diagnose(&machine.recordings(&machine.base)).answer;
        check_finite(kind.name, &answer);
        println!(
            "{}: {} before {:.2}",
            kind.name,
            describe_answer(&answer),
            largest_ratio(&answer.fit.before)
        );
        if answer.verdict != DiagnosisVerdict::Consistent {
            wrong.push(format!("{}: {}", kind.name, describe_answer(&answer)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_concealed_effect_is_named_on_every_kind() {
    let mut wrong = Vec::new();
    for kind in chosen_kinds() {
        let machine = Machine::of(kind);
        let mut truth = machine.base.clone();
        (kind.conceals)(&mut truth);
        let recordings = machine.recordings(&truth);
        let answer = machine.diagnose(&recordings).answer;
        check_finite(kind.name, &answer);
        let named = answer.findings.iter().any(|finding| {
            let own = std::iter::once(finding.name()).chain(finding.alternatives.iter().copied());
            own.into_iter().any(|name| kind.names.contains(&(name.component, name.effect)))
        });
        let (before, held_out) =
            (largest_ratio(&answer.fit.before), worst_reading(&answer.fit.held_out_after));
        println!("{}: {} before {before:.2} held out {held_out:.2}", kind.name, describe_answer(&answer));
        if !named || !machine.is_replayed(held_out, &truth, &recordings) {
            wrong.push(format!("{}: {} held out {held_out:.2}", kind.name, describe_answer(&answer)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns whether an error of the out-of-balance weighs less than a hundredth of the friction: the start of an integrated angle leaves as much.
fn is_negligible(p: &Parameters, name: &str, error: f64) -> bool {
    let friction_nm = p.pivot_friction.coulomb_nm() + p.gearbox.ratio * p.motor_friction.coulomb_nm();
    name == "out-of-balance" && p.gravity_m_s2 * error.abs() < 0.01 * friction_nm
}

/// Relative error of an identified value that is not asked to be within its interval.
const NEAR: f64 = 0.03;

/// Ratio of residual to noise floor up to which a replay is that of the machine itself.
const REPLAYED: f64 = 1.5;

/// Factor by which a residual may exceed that of the machine that made the recordings, where its own is above [`REPLAYED`].
const AS_THE_TRUTH: f64 = 1.05;

#[test]
fn what_is_identified_contains_the_truth_or_is_refused() {
    let mut wrong = Vec::new();
    for kind in chosen_kinds() {
        let machine = Machine::of(kind);
        let p = &machine.base;
        let recordings = machine.recordings(p);
        let identified = match identify(p, &[&recordings]) {
            Ok(identified) => identified,
            Err(error) => {
                println!("{}: {error}", kind.name);
                assert!(error.to_string().len() > 40, "{}: {error}", kind.name);
                continue;
            }
        };
        let ratio = p.gearbox.ratio;
        let lumped = p.lumped.as_ref().unwrap();
        let balance = &identified.balances[0];
        let viscous = p.pivot_friction.viscous_nm_s_rad + ratio * ratio * p.motor_friction.viscous_nm_s_rad;
        let truths: [(&str, Estimate, f64); 4] = [
            ("out-of-balance", balance.out_of_balance_kg_m, lumped.out_of_balance_kg_m),
            ("inertia", balance.inertia_kg_m2, lumped.inertia_kg_m2()),
            (
                "coulomb",
                identified.coulomb_nm,
                p.pivot_friction.coulomb_nm() + ratio * p.motor_friction.coulomb_nm(),
            ),
            ("viscous", identified.viscous_nm_s_rad, viscous),
        ];
        for (name, estimate, truth) in truths {
            println!("{}: {name} {:?} truth {truth}", kind.name, estimate);
            // the intervals are of the noise alone; what the low-pass and the kinematics leave is far below a hundredth
            let is_near = (estimate.value - truth).abs() <= NEAR * truth.abs()
                || is_negligible(p, name, estimate.value - truth);
            let is_bent = identified.notes.contains(&Note::TransmissionNotLinear);
            if estimate.is_known() && !is_bent && !estimate.holds(truth) && !is_near {
                wrong.push(format!("{}: {name} {:?}, but it is {truth}", kind.name, estimate.ci95));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_drive_without_time_constants_is_seen_as_it_is() {
    let machine = Machine::of(&KINDS[1]);
    let lag = |p: &Parameters| match p.amplifier.dynamics {
        AmplifierDynamics::CurrentLoop { bandwidth_rad_s, .. } => bandwidth_rad_s,
        _ => f64::INFINITY,
    };
    assert!((lag(&machine.base) / (std::f64::consts::TAU * 300.0) - 1.0).abs() < 1e-9);
}
