//! The needs of a loop of torque, force or current: something between motor and sensor that has a state, and something that holds the machine.

use counterpoise_models::parameters::AmplifierDynamics;
use counterpoise_models::{AxisKind, FeedbackSignal, Parameters};

use super::Project;
use super::findings::Findings;
use crate::diagnostic::{DiagnosticKind, Severity};
use crate::file::source::Remark;

/// Checks a loop whose sensor measures a torque, a force or a current.
pub(super) fn check_effort_loop(findings: &mut Findings<'_>, project: &Project) {
    let plant = &project.plant;
    let key = match plant.sensors.measured {
        FeedbackSignal::Torque => "plant.sensors.torque",
        FeedbackSignal::Current => "plant.sensors.current",
        _ => return,
    };
    let missing = match plant.sensors.measured {
        FeedbackSignal::Torque if plant.gearbox.is_rigid() => Some((
            "measures the torque of a transmission that gives, and this one is rigid",
            "state plant.gearbox.stiffness, or that of another transmission (that of the sensor itself if the rest is stiff), and the inertia of the motor: gearbox = { ratio = 1.0, stiffness = ... } and motor = { inertia = ... }",
        )),
        FeedbackSignal::Current => no_current(plant),
        _ => None,
    };
    if let Some((problem, hint)) = missing {
        add(findings, key, problem, hint);
    } else if runs_away(plant) {
        let inertia = match plant.axis {
            AxisKind::Rotary => "hub_inertia",
            AxisKind::Linear => "mass",
        };
        let hint = format!(
            "state friction = {{ pivot = {{ viscous = ... }} }}, or what the load presses against as lumped = {{ {inertia} = ..., position_stiffness = ... }}"
        );
        add(
            findings,
            key,
            "does not see a steady rate, and nothing brakes this machine: it would run away",
            &hint,
        );
    }
    without_rate(findings, project);
}

/// Why the motor's current cannot be controlled, and what to state.
fn no_current(plant: &Parameters) -> Option<(&'static str, &'static str)> {
    match plant.amplifier.dynamics {
        AmplifierDynamics::TorqueCommand => Some((
            "cannot be the sensor of the loop, because a drive that takes a torque has no current",
            "write drive = { kind = \"voltage\", ... } with the motor's resistance and inductance",
        )),
        AmplifierDynamics::CurrentCommand => Some((
            "cannot be the sensor of the loop, because a current loop without a bandwidth follows its command at once",
            "state plant.drive.bandwidth, from the drive's data sheet",
        )),
        AmplifierDynamics::Modelled if plant.motor.inductance_h == 0.0 => Some((
            "cannot be the sensor of the loop, because without an inductance the current follows the voltage at once",
            "state plant.motor.inductance, from the motor's data sheet",
        )),
        _ => None,
    }
}

/// Returns whether a constant torque would turn the machine ever faster.
fn runs_away(plant: &Parameters) -> bool {
    let is_braked = plant.motor_friction.viscous_nm_s_rad > 0.0
        || plant.pivot_friction.viscous_nm_s_rad > 0.0
        || (plant.amplifier.dynamics == AmplifierDynamics::Modelled && plant.motor.back_emf_v_s_rad != 0.0);
    let is_held = plant.lumped.as_ref().is_some_and(|lumped| lumped.position_stiffness_nm_rad > 0.0);
    !is_braked && !is_held
}

/// Parts of a project that need a rate or a position in the loop's reading.
fn without_rate(findings: &mut Findings<'_>, project: &Project) {
    let synth = project.synth.as_ref();
    let specification = synth.map(|synth| &synth.specification);
    let options = synth.map(|synth| &synth.options);
    let sight = project.verify.as_ref().is_some_and(|v| v.procedure.line_of_sight.is_some());
    let parts = [
        (specification.is_some_and(|s| s.heave.is_some()), "synth.heave"),
        (specification.is_some_and(|s| s.pitch.is_some()), "synth.pitch"),
        (options.is_some_and(|o| o.observer.is_some()), "synth.observer"),
        (options.is_some_and(|o| o.adaptation.is_some()), "synth.adaptation"),
        (sight, "verify.line_of_sight"),
    ];
    for (_, key) in parts.into_iter().filter(|(is_stated, _)| *is_stated) {
        let hint = "leave it out, or give the loop hub_gyro, tachometer, encoder or resolver";
        let problem =
            "needs the rate or the position of the load, which a loop of torque or current does not measure";
        add(findings, key, problem, hint);
    }
}

fn add(findings: &mut Findings<'_>, key: &str, problem: &str, hint: &str) {
    let remark = Remark::new(DiagnosticKind::Conflict, key, problem).hint(Some(hint.to_owned()));
    findings.add(Severity::Error, remark);
}
