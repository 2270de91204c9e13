//! The certificate's own runs, with noise and quantisation: at rest, and in motion.

use counterpoise_simulate::{
    Imperfections, Initial, PlantState, PlatformMotion, Scenario, Signal, Simulator,
};

use super::floor::Subject;
use crate::Error;
use crate::signals::period::fundamental_hz;
use crate::signals::statistics::subtract_mean;
use crate::signals::{mean, rms};
use crate::tolerance::{
    ALIKE_HALVES, CYCLE_BAND, CYCLE_RUNS, GROWS, MOST_CREST, MOVES_FLOORS, MOVES_UNSTABLE_FLOORS, MULTIPLE,
    RATTLES_FLOORS, RECURRING_AMPLITUDE, RECURRING_FREQUENCY, REPEATED_RUNS, RUN_S, SETTLING_S,
};

/// A cycle of the hub's rate, or of what else the loop controls, in its unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct HubCycle {
    /// Half the range, rad/s.
    pub amplitude_rad_s: f64,
    /// Frequency, Hz; 0 if there are no cycles.
    pub frequency_hz: f64,
}

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
    /// `true` if runs that differ only in noise have the same cycle, or if none was needed.
    pub recurs: bool,
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

    /// Returns whether the run has this cycle: what runs with other noise share.
    fn has_cycle(&self, cycle: HubCycle) -> bool {
        (self.amplitude_rad_s / cycle.amplitude_rad_s - 1.0).abs() <= RECURRING_AMPLITUDE
            && (self.frequency_hz / cycle.frequency_hz - 1.0).abs() <= RECURRING_FREQUENCY
    }

    /// Returns whether the second half moves distinctly more than the first.
    pub fn grows(&self) -> bool {
        self.second_half_rad_s > GROWS * self.first_half_rad_s
    }
}

/// Whether the stability of a case is proved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Proof {
    /// It is.
    Given,
    /// It is not.
    Missing,
}

/// The mechanism at rest: the run that moves more of one with the gear as the load leaves it, and one with its teeth on a flank. It is repeated with
/// other noise unless it is quiet: with backlash or an observer, runs that differ in noise alone can differ by half, and a gear with backlash can stay
/// in its gap or begin to rattle. An estimator that learns always has these repetitions: what noise teaches it goes on step by step, and a single run
/// need not get as far as friction lets it. A motion that is larger than noise is repeated to see whether its cycle is the same with other noise.
pub(super) fn at_rest(subject: &Subject<'_>, proof: Proof) -> Result<Run, Error> {
    let mut found = at_rest_with(subject, subject.procedure.seed)?;
    let others = (1..=repetitions(subject, &found, proof))
        .map(|more| at_rest_with(subject, subject.procedure.seed.wrapping_add(more)))
        .collect::<Result<Vec<Run>, Error>>()?;
    if others.is_empty() || found.diverges() {
        return Ok(found);
    }
    let least = others.iter().map(|run| run.rms_rad_s).fold(found.rms_rad_s, f64::min);
    let mut all = others;
    all.push(found.clone());
    for run in &all {
        if run.rms_rad_s > found.rms_rad_s {
            found = run.clone();
        }
    }
    found.spread_rad_s = found.rms_rad_s - least;
    let Run { amplitude_rad_s, frequency_hz, .. } = found;
    found.recurs = all.iter().all(|run| run.has_cycle(HubCycle { amplitude_rad_s, frequency_hz }));
    Ok(found)
}

/// How often a run at rest is repeated with other noise.
fn repetitions(subject: &Subject<'_>, found: &Run, proof: Proof) -> u64 {
    let floor = subject.noise_floor_rad_s();
    let learns = subject.controller.parts().estimator.is_some();
    let rattles = proof == Proof::Missing && subject.case.plant.parameters().gearbox.backlash_rad > 0.0;
    let quiet = if rattles { RATTLES_FLOORS } else { MOVES_UNSTABLE_FLOORS } * floor;
    match found.rms_rad_s {
        moves if moves > MOVES_FLOORS * floor => CYCLE_RUNS,
        rms if learns || rms > quiet => REPEATED_RUNS,
        _ => 0,
    }
}

/// Returns whether a cycle that was started by a burst of the control, without noise, is the same in runs with noise.
pub(super) fn cycle_recurs(subject: &Subject<'_>, cycle: HubCycle, burst: &Signal) -> Result<bool, Error> {
    for more in 0..CYCLE_RUNS {
        let seed = subject.procedure.seed.wrapping_add(more);
        let disturbance = Disturbance { injection_v: burst.clone(), ..Disturbance::NONE };
        let with_noise = run(subject, disturbance, seed)?;
        if !with_noise.has_cycle(cycle) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn at_rest_with(subject: &Subject<'_>, seed: u64) -> Result<Run, Error> {
    let point = &subject.procedure.operating_point;
    let from_rest = run(subject, Disturbance::NONE, seed)?;
    let half = 0.5 * subject.case.plant.parameters().gearbox.backlash_rad;
    if half == 0.0 || subject.case.plant.equilibrium(point).mesh_torque_nm != 0.0 {
        return Ok(from_rest);
    }
    let simulator = Simulator::new(&subject.case.plant)?;
    let mut state = simulator.rest(point.hub_angle_rad, point.platform_angle_rad, 0.0);
    state.core[counterpoise_models::plant::core::state::WINDUP] = half;
    let on_flank = run(subject, Disturbance { state: Some(state), ..Disturbance::NONE }, seed)?;
    Ok(if on_flank.rms_rad_s > from_rest.rms_rad_s { on_flank } else { from_rest })
}

/// Heave and pitch of the procedure together.
pub(super) fn run_in_motion(subject: &Subject<'_>) -> Result<Run, Error> {
    let sine = |sine: &crate::Sine| Signal::sine(sine.amplitude, std::f64::consts::TAU * sine.frequency_hz);
    let heave_m_s2 = sine(&subject.procedure.heave);
    let pitch_rate_rad_s = sine(&subject.procedure.pitch);
    let platform = PlatformMotion { heave_m_s2, pitch_rate_rad_s, ..PlatformMotion::STILL };
    run(subject, Disturbance { platform, ..Disturbance::NONE }, subject.procedure.seed)
}

/// What moves the mechanism in a run.
struct Disturbance {
    /// Motion of the platform.
    platform: PlatformMotion,
    /// State at the start; `None` for rest at the operating point.
    state: Option<PlantState>,
    /// What is added to the control, V.
    injection_v: Signal,
}

impl Disturbance {
    const NONE: Self = Self { platform: PlatformMotion::STILL, state: None, injection_v: Signal::ZERO };
}

fn run(subject: &Subject<'_>, disturbance: Disturbance, seed: u64) -> Result<Run, Error> {
    let point = &subject.procedure.operating_point;
    let mut runner = subject.controller.runner();
    runner.set_out_of_balance(subject.case.out_of_balance_kg_m);
    let scenario = Scenario {
        platform: PlatformMotion { initial_angle_rad: point.platform_angle_rad, ..disturbance.platform },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        injection_v: disturbance.injection_v,
        initial: disturbance.state.map_or(Initial::Rest { hub_angle_rad: point.hub_angle_rad }, |state| {
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
                recurs: true,
                rates_rad_s: Vec::new(),
            });
        }
        other => other?,
    };
    let first = (SETTLING_S / history.sample_period_s) as usize;
    let rates = &subject.motion(&history.truth, first);
    let (early, late) = rates.split_at(rates.len() / 2);
    let spread = |part: &[f64]| rms(&subtract_mean(part));
    let HubCycle { amplitude_rad_s, frequency_hz } = cycle_of(late, history.sample_period_s);
    Ok(Run {
        rms_rad_s: spread(rates),
        first_half_rad_s: spread(early),
        second_half_rad_s: spread(late),
        amplitude_rad_s,
        frequency_hz,
        spread_rad_s: 0.0,
        recurs: true,
        rates_rad_s: subtract_mean(rates),
    })
}

/// Half the range of a rate, and its frequency by the upward crossings of a band about its mean, Hz; 0 with fewer than two. A motion with harmonics
/// that cross the band as well has the frequency with which it repeats itself.
pub(super) fn cycle_of(rates: &[f64], period_s: f64) -> HubCycle {
    let high = rates.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = rates.iter().copied().fold(f64::INFINITY, f64::min);
    let (middle, band) = (mean(rates), CYCLE_BAND * (high - low));
    let (mut is_above, mut crossings) = (true, Vec::new());
    for (k, rate) in rates.iter().enumerate() {
        if !is_above && *rate > middle + band {
            is_above = true;
            crossings.push(k);
        } else if *rate < middle - band {
            is_above = false;
        }
    }
    let hz = match (crossings.first(), crossings.last()) {
        (Some(first), Some(last)) if last > first => {
            let crossed = (crossings.len() - 1) as f64 / ((last - first) as f64 * period_s);
            fundamental_hz(rates, period_s).filter(|hz| *hz < MULTIPLE * crossed).unwrap_or(crossed)
        }
        _ => 0.0,
    };
    HubCycle { amplitude_rad_s: 0.5 * (high - low), frequency_hz: hz }
}
