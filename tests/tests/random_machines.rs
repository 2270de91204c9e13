//! A first design for machines at random: every size, resonance, delay, noise and out-of-balance above the pivot.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Mutex;

use counterpoise_models::{Friction, FrictionLaw, Parameters};
use counterpoise_pipeline::{
    FirstDesignResult, PipelineError, World, build_plant_model, reduce_plant, synthesise, verify,
    with_chosen_weights,
};
use counterpoise_project::Project;
use counterpoise_report::wording::design_findings::{describe_design_finding, join_limits};
use counterpoise_report::wording::errors::describe_pipeline_error;
use counterpoise_verify::{LoopFigure, Model, PerformanceFigure, RestFigure, Sine, StepFigure, Verification};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Machines that are tried; `COUNTERPOISE_MACHINES` asks for another number.
const MACHINES: usize = 5;

struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("{name} is not here"))
    }
}

/// Numbers at random.
struct Dice(ChaCha8Rng);

impl Dice {
    fn share(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.0.next_u32() as usize) % all.len()]
    }
}

/// A machine like the starter's in everything but size, frequencies, damping, delay, noise, ratio and balance.
fn machine(dice: &mut Dice) -> Project {
    let mut project = Project::parse(counterpoise_project::STARTER, "project.toml").unwrap().project;
    (project.synth, project.sweep) = (None, None);
    let p = &mut project.plant;
    let before = p.lumped.clone().unwrap();
    let size = dice.log_between(1e-9, 1e7) / (before.hub_inertia_kg_m2 + before.beam_inertia_kg_m2);
    let (hub, beam) = (before.hub_inertia_kg_m2 * size, before.beam_inertia_kg_m2 * size);
    let parallel = hub * beam / (hub + beam);
    let (twist, mesh) = (dice.log_between(20.0, 2000.0), dice.log_between(20.0, 1000.0));
    let rotor = p.motor.inertia_kg_m2 * p.gearbox.ratio.powi(2) * size * dice.log_between(0.3, 3.0);
    let scale = dice.log_between(1.0, 300.0) / p.gearbox.ratio;
    p.gearbox.ratio *= scale;
    p.motor.inertia_kg_m2 = rotor / p.gearbox.ratio.powi(2);
    let series = rotor * (hub + beam) / (rotor + hub + beam);
    p.gearbox.stiffness_nm_rad = series * mesh * mesh;
    p.gearbox.damping_nm_s_rad = 2.0 * dice.log_between(0.01, 0.2) * series * mesh;
    p.gearbox.backlash_rad = 0.0;
    // Torque, and with it current, grow with the size; volts stay.
    p.motor.torque_constant_nm_a /= scale;
    p.motor.back_emf_v_s_rad /= scale;
    p.motor.resistance_ohm /= size;
    p.motor.inductance_h /= size;
    p.amplifier.current_feedback_v_a /= size;
    let torque_nm =
        10.0 * p.gearbox.ratio * p.motor.torque_constant_nm_a * p.amplifier.stall_gain_a_v(&p.motor);
    let lumped = p.lumped.as_mut().unwrap();
    (lumped.hub_inertia_kg_m2, lumped.beam_inertia_kg_m2) = (hub, beam);
    lumped.stiffness_nm_rad = parallel * twist * twist;
    lumped.damping_nm_s_rad = 2.0 * dice.log_between(0.002, 0.05) * parallel * twist;
    lumped.out_of_balance_kg_m = dice.one_of(&[0.0, 0.03, 0.1]) * torque_nm / 9.81;
    let fall = dice.one_of(&[0.0, 1.0, 3.0]);
    lumped.vertical_offset_kg_m = fall * fall * (hub + beam + rotor) / 9.81;
    let dry = dice.one_of(&[0.0, 1e-3, 1e-2]) * torque_nm;
    let law = |level: f64| match level > 0.0 {
        true => FrictionLaw::Dahl { coulomb_nm: level, rest_stiffness_nm_rad: 2e3 * level, exponent: 1.0 },
        false => FrictionLaw::None,
    };
    p.pivot_friction = Friction::with_viscous_part(law(dry), p.pivot_friction.viscous_nm_s_rad * size);
    p.motor_friction = Friction::with_viscous_part(
        FrictionLaw::None,
        p.motor_friction.viscous_nm_s_rad * size / scale.powi(2),
    );
    p.interface.sample_period_s = dice.one_of(&[2.5e-4, 1e-3, 4e-3]);
    p.interface.output_delay_samples = dice.one_of(&[0, 0, 1, 5, 20]);
    p.sensors.hub_gyro.noise_rms = dice.one_of(&[0.0, 1e-5, 2e-4, 2e-3]);
    project
}

/// Largest angle that a machine turns by during the step, rad: where it started, so that gravity stays what the design knows.
const SWING_RAD: f64 = 0.5;

/// The project with a verification that lasts as long as its loop is slow, on a platform that stands still.
fn with_procedure(project: &Project, bandwidth_rad_s: f64) -> Project {
    let mut project = project.clone();
    let asked = project.verify.as_mut().unwrap();
    asked.requirements.clear();
    let slow_s = (40.0 / bandwidth_rad_s).clamp(0.5, 40.0);
    let procedure = &mut asked.procedure;
    // The runs at rest and on a platform that does not move; the step alone lasts until the loop has settled.
    (procedure.duration_s, procedure.settle_s) = (0.4 * slow_s, 0.2 * slow_s);
    procedure.step.duration_s = slow_s;
    procedure.step.rate_rad_s = procedure.step.rate_rad_s.min(SWING_RAD / slow_s);
    procedure.heave = Sine { amplitude: 0.0, ..procedure.heave };
    procedure.pitch = Sine { amplitude: 0.0, ..procedure.pitch };
    (procedure.triangle, asked.road) = (None, None);
    project
}

/// Error in % that the weight of a machine that stands on its pivot may add, per square of its rate of falling over the bandwidth:
/// as the hub turns at a steady rate r, gravity's torque J p^2 r t rises as a ramp, which integral action of one order does not
/// cancel. What it leaves is (p / bandwidth)^2 r times a factor near 1.
const GRAVITY_RAMP: f64 = 80.0;

/// Returns the rate at which a machine falls over without control and friction, rad/s: p = sqrt(g V / J).
fn falling_rad_s(plant: &Parameters) -> f64 {
    let lumped = plant.lumped.as_ref().unwrap();
    let rotor = plant.motor.inertia_kg_m2 * plant.gearbox.ratio.powi(2);
    let inertia = lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2 + rotor;
    (plant.gravity_m_s2 * lumped.vertical_offset_kg_m / inertia).sqrt()
}

/// Returns what is wrong with a first design; empty if nothing is.
fn wrong(project: &Project, first: &FirstDesignResult, found: &Verification) -> Vec<String> {
    let value = |figure: PerformanceFigure| found.value(figure).unwrap_or(f64::NAN);
    let of_loop = |figure: LoopFigure| value(PerformanceFigure::Loop(figure));
    let mut wrong = Vec::new();
    let mut need = |holds: bool, what: String| {
        if !holds {
            wrong.push(what);
        }
    };
    let ceiling = TAU / project.plant.interface.sample_period_s / 20.0;
    let crossover = TAU * of_loop(LoopFigure::Crossover);
    need(crossover <= ceiling, format!("crossover {crossover} above {ceiling}"));
    // At a resonance above the bandwidth the gain may rise above 1 once more.
    let bandwidth = first.bandwidth_rad_s;
    need(bandwidth < 1.02 * crossover, format!("bandwidth {bandwidth} above crossover {crossover}"));
    for row in &first.limits {
        let above = row.bandwidth_rad_s.is_none_or(|limit| bandwidth <= 1.01 * limit);
        need(above, format!("bandwidth {bandwidth} above the limit {row:?}"));
    }
    need(of_loop(LoopFigure::MaxSensitivity) <= 1.72, format!("Ms {}", of_loop(LoopFigure::MaxSensitivity)));
    need(of_loop(LoopFigure::PhaseMargin) >= 39.0, format!("phase {}", of_loop(LoopFigure::PhaseMargin)));
    need(of_loop(LoopFigure::PoleRadius) < 1.0, format!("pole {}", of_loop(LoopFigure::PoleRadius)));
    let step = |figure| value(PerformanceFigure::Step(Model::Nonlinear, figure));
    let demand = project.verify.as_ref().unwrap().procedure.step.rate_rad_s;
    let rest = value(PerformanceFigure::Rest(RestFigure::HubRms));
    need(rest < 0.3 * demand + 4.0 * project.plant.sensors.hub_gyro.noise_rms, format!("at rest {rest}"));
    let ramp = GRAVITY_RAMP * (falling_rad_s(&project.plant) / first.bandwidth_rad_s).powi(2);
    let overshoot = step(StepFigure::Overshoot);
    need(overshoot < 80.0 + ramp, format!("overshoot {overshoot} %"));
    let left = step(StepFigure::SteadyStateError);
    need(left < 15.0 + ramp, format!("{left} % left"));
    wrong
}

/// The outcome of a machine.
enum TriedMachine {
    /// A design that is limited by a kind of limit, and what is wrong with it.
    Designed { limited_by: String, wrong: Vec<String> },
    /// No bandwidth keeps the margins, or the drive cannot hold the machine.
    Refused(String),
    /// An error that is neither.
    Failed(String),
}

fn try_machine(seed: u64) -> TriedMachine {
    let project = machine(&mut Dice(ChaCha8Rng::seed_from_u64(seed)));
    let chosen = match with_chosen_weights(&project) {
        Ok(chosen) => chosen.unwrap(),
        Err(PipelineError::NoController(reasons)) => {
            return TriedMachine::Refused(describe_design_finding(&reasons[0]));
        }
        Err(error @ (PipelineError::CannotHold { .. } | PipelineError::CannotCarry { .. })) => {
            return TriedMachine::Refused(error.to_string());
        }
        Err(other) => return TriedMachine::Failed(describe_pipeline_error(&other)),
    };
    let first = FirstDesignResult::from(&chosen.first);
    let project = with_procedure(&chosen.project, first.bandwidth_rad_s);
    let modelled = build_plant_model(&project).unwrap();
    let reduced = reduce_plant(&project, &modelled).unwrap();
    let judged = synthesise(&project, &modelled, &reduced)
        .and_then(|made| verify(&project, &modelled, &made, &EmptyWorld));
    match judged {
        Ok(verified) => {
            let mut wrong = wrong(&project, &first, verified.verification());
            if !wrong.is_empty() {
                wrong.push(format!("{first:?}"));
            }
            TriedMachine::Designed { limited_by: join_limits(&first.limited_by), wrong }
        }
        Err(other) => TriedMachine::Failed(describe_pipeline_error(&other)),
    }
}

#[test]
fn a_first_design_holds_machines_of_every_kind_in_the_nonlinear_simulator() {
    let count = std::env::var("COUNTERPOISE_MACHINES").ok().and_then(|text| text.parse().ok());
    let all = count.unwrap_or(MACHINES);
    let outcomes = Mutex::new(BTreeMap::new());
    counterpoise_tests::run_in_parallel(all, &|k| {
        let outcome = try_machine(k as u64);
        outcomes.lock().unwrap().insert(k, outcome);
    });
    let (mut failures, mut refused, mut limits) = (Vec::new(), 0, BTreeMap::new());
    for (seed, outcome) in outcomes.into_inner().unwrap() {
        match outcome {
            TriedMachine::Designed { limited_by, wrong } => {
                *limits.entry(limited_by).or_insert(0) += 1;
                if !wrong.is_empty() {
                    failures.push(format!("{seed}: {wrong:?}"));
                }
            }
            TriedMachine::Refused(why) => {
                refused += 1;
                println!("{seed}: {why}");
            }
            TriedMachine::Failed(why) => failures.push(format!("{seed}: {why}")),
        }
    }
    println!("{all} machines, {refused} refused, limited by {limits:?}");
    assert!(failures.is_empty(), "{} of {all}:\n{}", failures.len(), failures.join("\n"));
    assert!(refused * 5 <= all, "{refused} of {all} refused");
}
