//! The triangle-wave method: out-of-balance, friction, inertia and the amplifier's gain curve from closed-loop
//! recordings, without a test of its own for any of them.
//!
//! While the joint slides, the torque of the motor is a sum of known signals with the unknowns as factors
//! ([`rows`]), so that one least-squares problem gives them all, with intervals ([`regression`]). Plotted, it is the
//! control against the hub's rate: the offset is the out-of-balance, the step at rate zero the Coulomb friction, the
//! slope of the lobes the viscous friction, the width of the loop the inertia (after C. T. Johnson and R. D. Lorenz,
//! IEEE Trans. Industry Applications 28(6), 1992, who used a three-term controller).
//!
//! The amplifier's curve is a piecewise linear change d(u) of its static map, odd, zero where the amplifier is linear
//! anyway: its knots are further unknowns of the same problem. Runs at two out-of-balances tell it from friction: the
//! one holds the control where the amplifier is linear, the other takes it through zero.
//!
//! Samples in presliding, at a limit, or missing do not enter, nor those whose filter window touches one. From one
//! recording at one place the parts of pivot and motor in friction cannot be told apart: only their sum acts.

pub mod improvement;
pub mod outcome;
pub mod regression;
pub mod rows;
pub mod signal;

mod alignment;
mod breakaway;
mod gain;
mod problem;

pub use improvement::apply_identified;
pub use outcome::{
    BalanceRegression, BalanceState, BalanceUnknown, Estimate, FrictionPicture, GainCurveObstacle, GainPoint,
    Identification, IdentifiedAmplifier, Lobes, Note, SensorErrors,
};
pub use regression::NormalEquations;

use counterpoise_models::Parameters;
use counterpoise_models::parameters::Friction;
use counterpoise_recordings::{Channel, Recording};

use crate::Error;
use crate::machine::SteadyDrive;
use crate::tolerance::identification::*;
use problem::{IdentificationProblem, Layout};

/// Identifies a mechanism from closed-loop recordings, one group for each state of balance (usually one; a second with
/// other balance masses fitted makes the amplifier's curve sure).
///
/// Known and taken from the parameters: gravity, gear ratio, motor, amplifier but for its curve, sensors' lags, how
/// the beam hangs on the hub. Friction is taken to be the same in all states.
///
/// # Errors
/// No recording, no control or hub rate, too little sliding, motions that cannot be told apart.
pub fn identify(p: &Parameters, states: &[&[Recording]]) -> Result<Identification, Error> {
    if states.iter().all(|state| state.is_empty()) {
        return Err(Error::NoRecording);
    }
    let mut found = round(p, states, &PriorValues::of(p))?;
    for _ in 1..ROUNDS {
        found = round(&improvement::apply_except_amplifier(p, &found), states, &PriorValues::of(p))?;
    }
    Ok(found)
}

/// One round, with the beam and the presliding distances of a mechanism.
fn round(p: &Parameters, states: &[&[Recording]], before: &PriorValues) -> Result<Identification, Error> {
    let mut plain = IdentificationProblem::new(p, states, &[])?;
    let sliding_s = plain.sliding_s();
    if sliding_s < LEAST_SLIDING_S {
        return Err(Error::TooLittleSliding { sliding_s, needed_s: LEAST_SLIDING_S });
    }
    let mut linear = plain.fit().ok_or(Error::NotTold)?;
    let mut found = gain::identify_amplifier(p, states, &plain, &linear)?;
    let negative = negative_viscous(plain.layout, found.curved.as_ref().map_or(&linear, |(_, fit)| fit));
    if negative.is_some() {
        plain = plain.with_held_viscous(Some(before.viscous.max(0.0)));
        linear = plain.fit().ok_or(Error::NotTold)?;
        found = gain::identify_amplifier(p, states, &plain, &linear)?;
    }
    let (problem, fit) = found.curved.as_ref().map_or((&plain, &linear), |(problem, fit)| (problem, fit));
    let layout = problem.layout;
    let estimate = |k: usize, before: f64| Estimate::new(fit.value[k], fit.half_width[k], before);
    let balance = |s: usize| BalanceState {
        out_of_balance_kg_m: estimate(layout.moment(s), before.moment),
        inertia_kg_m2: estimate(layout.inertia(s), before.inertia),
    };
    Ok(Identification {
        balances: (0..states.len()).map(balance).collect(),
        coulomb_nm: estimate(layout.coulomb(), before.coulomb),
        viscous_nm_s_rad: estimate(layout.viscous(), before.viscous),
        breakaway_nm: breakaway::identify_breakaway(p, states, problem, fit, before.breakaway)?,
        lobes: lobes(p, problem, &fit.value),
        loops: loops(p, problem, &fit.value),
        residual_nm: fit.residual_rms,
        noise_share: fit.noise_share,
        sliding_s,
        notes: notes(p, states, &found.amplifier, fit, layout).into_iter().chain(negative).collect(),
        sensors: alignment::sensor_errors(p, states, fit, layout),
        regression: BalanceRegression { unknowns: problem.unknowns(), equations: fit.equations.clone() },
        amplifier: found.amplifier,
    })
}

/// Returns that viscous friction came out below zero, if its whole interval is there: friction that falls with speed, a lag that the project
/// leaves out, or a motion at nearly one speed.
fn negative_viscous(layout: Layout, fit: &regression::RegressionFit) -> Option<Note> {
    let (value, half_width) = (fit.value[layout.viscous()], fit.half_width[layout.viscous()]);
    (value + half_width < 0.0).then_some(Note::NegativeViscous)
}

/// The project's values of the unknowns.
struct PriorValues {
    moment: f64,
    inertia: f64,
    coulomb: f64,
    viscous: f64,
    breakaway: f64,
}

impl PriorValues {
    fn of(p: &Parameters) -> Self {
        let ratio = p.gearbox.ratio;
        let lumped = p.lumped.as_ref();
        let highest = |friction: &Friction| friction.coulomb_nm() * friction.static_ratio;
        Self {
            breakaway: highest(&p.pivot_friction) + ratio * highest(&p.motor_friction),
            moment: lumped.map_or(f64::NAN, |l| l.out_of_balance_kg_m),
            inertia: lumped.map_or(f64::NAN, |l| l.inertia_kg_m2()),
            coulomb: p.pivot_friction.coulomb_nm() + ratio * p.motor_friction.coulomb_nm(),
            viscous: p.pivot_friction.viscous_nm_s_rad + ratio * ratio * p.motor_friction.viscous_nm_s_rad,
        }
    }
}

/// Torque at the output per volt of control, N m/V, motor stalled, amplifier linear.
fn torque_per_volt(p: &Parameters) -> f64 {
    p.gearbox.ratio * p.motor.torque_constant_nm_a * p.amplifier.stall_gain_a_v(&p.motor)
}

fn lobes(p: &Parameters, problem: &IdentificationProblem, value: &[f64]) -> Lobes {
    let IdentificationProblem { layout, held_viscous, .. } = *problem;
    let (gain, ratio) = (torque_per_volt(p), p.gearbox.ratio);
    let drive = SteadyDrive::of(p);
    let back_emf = ratio * drive.back_emf / drive.gain;
    let rotor = ratio * ratio * p.motor.inertia_kg_m2;
    let moment = value[layout.moment(0)];
    Lobes {
        offset_v: if moment.is_finite() { moment * p.gravity_m_s2 / gain } else { 0.0 },
        step_v: 2.0 * value[layout.coulomb()] / gain,
        slope_v_s_rad: held_viscous.unwrap_or(value[layout.viscous()]) / gain + back_emf,
        width_v_s2_rad: 2.0 * (value[layout.inertia(0)] + rotor) / gain,
    }
}

fn loops(p: &Parameters, problem: &IdentificationProblem, value: &[f64]) -> Vec<FrictionPicture> {
    let gain = torque_per_volt(p);
    let one = |(index, part): (usize, &problem::RecordingRows)| {
        let rows = &part.rows;
        let (rates, controls) = (rows.smooth_rate_rad_s(), rows.smooth_control_v());
        let left = problem.residual(index, value);
        let step = rows.signals.len().div_ceil(LOOP_POINTS).max(1);
        let point = |k: usize| {
            let control = controls[k];
            [rates[k], control, control - left[k] / gain]
        };
        let edge = (LOW_PASS_S * 4.0 / rows.period_s) as usize;
        let inside = edge..rows.signals.len().saturating_sub(edge);
        FrictionPicture {
            recording: part.name.clone(),
            balance: part.state,
            points: inside.step_by(step).map(point).collect(),
        }
    };
    problem.parts.iter().enumerate().map(one).collect()
}

fn notes(
    p: &Parameters,
    states: &[&[Recording]],
    amplifier: &IdentifiedAmplifier,
    fit: &regression::RegressionFit,
    layout: Layout,
) -> Vec<Note> {
    let mut out = vec![Note::FrictionIsASum, Note::KnownTakenAsExact];
    if p.gearbox.hysteresis_nm > 0.0 || p.gearbox.kinematic_error.amplitude != 0.0 {
        out.push(Note::TransmissionNotLinear);
    }
    if fit.value[layout.moment(0)].is_nan() {
        out.push(Note::NoWeight);
    }
    let left = fit.residual_rms / fit.value[layout.coulomb()];
    if left.abs() > RESIDUAL_DOUBT {
        out.push(Note::SomethingElseActs { share: left.abs() });
    }
    let all = || states.iter().flat_map(|state| state.iter());
    if all().any(|r| !r.has(Channel::MotorRate)) && !p.gearbox.is_rigid() {
        out.push(Note::NoMotorRate);
    }
    if all().any(|r| !r.has(Channel::HubPosition)) && !p.sensors.measured.is_position() {
        out.push(Note::NoHubPosition);
    }
    if p.lumped.is_none() {
        out.push(Note::RigidBeam);
    }
    if matches!(amplifier, IdentifiedAmplifier::Curve { .. }) && states.len() == 1 {
        out.push(Note::CurveFromOneState);
    }
    out
}
