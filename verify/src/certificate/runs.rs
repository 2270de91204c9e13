//! The certificate's own runs, with noise and quantisation: at rest, and in motion.

use counterpoise_simulate::{
    Imperfections, Initial, PlantState, PlatformMotion, Scenario, Signal, Simulator,
};

use super::floor::Subject;
use super::orbit::cycle_of;
use crate::Error;
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;
use crate::tolerance::{
    ALIKE_HALVES, GROWS, MOST_CREST, MOVES_FLOORS, MOVES_UNSTABLE_FLOORS, REPEATED_RUNS, RUN_S, SETTLING_S,
};

/// A run of 20 s after the controller has settled. What moves is the hub's rate, or what else the loop controls, in its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// RMS of the hub's rate about its mean over the whole run, rad/s; infinite if it diverged.
    pub rms_rad_s: f64,
    /// The same over the first half.
    pub first_half_rad_s: f64,
    /// The same over the second half.
    pub second_half_rad_s: f64,
    /// Half the range of the hub's rate over the second half, rad/s.
    pub amplitude_rad_s: f64,
    /// Frequency of its cycles over the second half, Hz; 0 if there are none.
    pub frequency_hz: f64,
    /// By how much the RMS of runs that differ only in noise differs, rad/s; 0 if one run is quiet enough to decide alone.
    pub spread_rad_s: f64,
    /// The hub's rate about its mean, rad/s; empty if it diverged.
    pub rates_rad_s: Vec<f64>,
}

impl Run {
    /// Returns whether the motion diverged.
    pub fn diverges(&self) -> bool {
        self.rms_rad_s.is_infinite()
    }

    /// Returns whether the motion repeats itself: both halves of the run have the same motion, without bursts that stand out.
    pub fn is_periodic(&self) -> bool {
        let halves = self.second_half_rad_s / self.first_half_rad_s;
        (halves - 1.0).abs() <= ALIKE_HALVES && self.amplitude_rad_s <= MOST_CREST * self.second_half_rad_s
    }

    /// Returns whether the second half moves distinctly more than the first.
    pub fn grows(&self) -> bool {
        self.second_half_rad_s > GROWS * self.first_half_rad_s
    }
}

/// The mechanism at rest: the run that moves more of one with the gear as the load leaves it, and one with its teeth on a flank. If that
/// one moves more than noise alone but not clearly so, it is repeated with other noise: with backlash or an observer, runs that differ
/// in noise alone can differ by half. An estimator that learns always has these repetitions: what noise teaches it goes on step by step, and a
/// single run need not get as far as friction lets it.
pub(super) fn at_rest(subject: &Subject<'_>) -> Result<Run, Error> {
    let mut found = at_rest_with(subject, subject.procedure.seed)?;
    let floor = subject.noise_floor_rad_s();
    let learns = subject.controller.parts().estimator.is_some();
    let is_quiet = !learns && found.rms_rad_s <= MOVES_UNSTABLE_FLOORS * floor;
    if is_quiet || found.rms_rad_s > MOVES_FLOORS * floor {
        return Ok(found);
    }
    let (mut most, mut least) = (found.rms_rad_s, found.rms_rad_s);
    for more in 1..=REPEATED_RUNS {
        let other = at_rest_with(subject, subject.procedure.seed.wrapping_add(more))?;
        (most, least) = (most.max(other.rms_rad_s), least.min(other.rms_rad_s));
        if other.rms_rad_s > found.rms_rad_s {
            found = other;
        }
    }
    found.spread_rad_s = most - least;
    Ok(found)
}

fn at_rest_with(subject: &Subject<'_>, seed: u64) -> Result<Run, Error> {
    let point = &subject.procedure.operating_point;
    let from_rest = run(subject, PlatformMotion::STILL, None, seed)?;
    let half = 0.5 * subject.case.plant.parameters().gearbox.backlash_rad;
    if half == 0.0 || subject.case.plant.equilibrium(point).mesh_torque_nm != 0.0 {
        return Ok(from_rest);
    }
    let simulator = Simulator::new(&subject.case.plant)?;
    let mut state = simulator.rest(point.hub_angle_rad, point.platform_angle_rad, 0.0);
    state.core[counterpoise_models::plant::core::state::WINDUP] = half;
    let on_flank = run(subject, PlatformMotion::STILL, Some(state), seed)?;
    Ok(if on_flank.rms_rad_s > from_rest.rms_rad_s { on_flank } else { from_rest })
}

/// Heave and pitch of the procedure together.
pub(super) fn run_in_motion(subject: &Subject<'_>) -> Result<Run, Error> {
    let sine = |sine: &crate::Sine| Signal::sine(sine.amplitude, std::f64::consts::TAU * sine.frequency_hz);
    let heave_m_s2 = sine(&subject.procedure.heave);
    let pitch_rate_rad_s = sine(&subject.procedure.pitch);
    let platform = PlatformMotion { heave_m_s2, pitch_rate_rad_s, ..PlatformMotion::STILL };
    run(subject, platform, None, subject.procedure.seed)
}

fn run(
    subject: &Subject<'_>,
    platform: PlatformMotion,
    start: Option<PlantState>,
    seed: u64,
) -> Result<Run, Error> {
    let point = &subject.procedure.operating_point;
    let mut runner = subject.controller.runner();
    runner.set_out_of_balance(subject.case.out_of_balance_kg_m);
    let scenario = Scenario {
        platform: PlatformMotion { initial_angle_rad: point.platform_angle_rad, ..platform },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        initial: start.map_or(Initial::Rest { hub_angle_rad: point.hub_angle_rad }, |state| {
            Initial::State(Box::new(state))
        }),
        ..Scenario::at_rest(SETTLING_S + RUN_S)
    };
    let history = match Simulator::new(&subject.case.plant)?.run(&mut runner, &scenario) {
        Err(counterpoise_simulate::Error::Diverged { .. }) => {
            let infinite = f64::INFINITY;
            return Ok(Run {
                rms_rad_s: infinite,
                first_half_rad_s: infinite,
                second_half_rad_s: infinite,
                amplitude_rad_s: infinite,
                frequency_hz: 0.0,
                spread_rad_s: 0.0,
                rates_rad_s: Vec::new(),
            });
        }
        other => other?,
    };
    let first = (SETTLING_S / history.sample_period_s) as usize;
    let rates = &subject.motion(&history.truth, first);
    let (early, late) = rates.split_at(rates.len() / 2);
    let spread = |part: &[f64]| rms(&subtract_mean(part));
    let [amplitude_rad_s, frequency_hz] = cycle_of(late, history.sample_period_s);
    Ok(Run {
        rms_rad_s: spread(rates),
        first_half_rad_s: spread(early),
        second_half_rad_s: spread(late),
        amplitude_rad_s,
        frequency_hz,
        spread_rad_s: 0.0,
        rates_rad_s: subtract_mean(rates),
    })
}
