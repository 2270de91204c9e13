//! The figures of a sampled loop, against the limits that it must keep.

use std::f64::consts::PI;

use counterpoise_linalg::{C64, CMat, Mat, dot};
use counterpoise_lti::{
    CandidateMargins, Discretisation, Response, StateSpace, Timebase, c2d, candidate_margins,
    candidate_sensitivity, feedback as closed, frequency_response, h2norm, is_stable_pole, linfnorm,
    parallel, poles, series,
};

use super::Circumstances;
use crate::bandwidth::LimitKind;
use crate::modes::{light_modes, shifted_modes};
use crate::sampling::sampled_plant;
use crate::tolerance::{
    CEILING, CONTROL_PEAK_BY, DRIFTING_POLE, EQUAL, NEIGHBOUR_MS, NOISE_SHARE, NORM_TOLERANCE, OVERSHOOT_BY,
    SEEN_ABOVE,
};
use crate::{DesignPlant, Error, Sampling};

/// Margins that a loop must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RequiredMargins {
    /// Smallest gain margin either way, dB.
    pub gain_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Largest complementary sensitivity; infinite if none is asked for.
    pub max_complementary: f64,
    /// Largest overshoot of a step of the demand as a share of it; infinite if none is asked for.
    pub overshoot: f64,
    /// Smallest radius of the disk margin; 0 if none is asked for.
    pub disk: f64,
    /// Smallest delay margin, s; 0 if none is asked for.
    pub delay_s: f64,
}

impl Default for RequiredMargins {
    /// 6 dB, 40 degrees and 1.7: inside what Åström and Murray (Feedback Systems, section 10.3) call reasonable, 2 to 5,
    /// 30 to 60 degrees and 1.4 to 2.
    fn default() -> Self {
        Self {
            gain_db: 6.0,
            phase_deg: 40.0,
            max_sensitivity: 1.7,
            max_complementary: f64::INFINITY,
            overshoot: f64::INFINITY,
            disk: 0.0,
            delay_s: 0.0,
        }
    }
}

/// The figures of a sampled loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopJudgement {
    /// Lowest frequency at which the loop's gain falls to 1, rad/s: disturbances are attenuated up to it.
    pub bandwidth_rad_s: f64,
    /// Highest frequency at which the closed loop has fallen by no more than 3 dB, rad/s.
    pub closed_loop_rad_s: f64,
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Frequency of that, rad/s.
    pub sensitivity_peak_rad_s: f64,
    /// Largest complementary sensitivity; 0 if it is not asked for.
    pub max_complementary: f64,
    /// Overshoot of a step of the demand as a share of it; 0 if it is not asked for.
    pub overshoot: f64,
    /// Radius of the disk of simultaneous changes of gain and phase that the loop bears; infinite if it is not asked for.
    pub disk_margin: f64,
    /// Smallest delay that makes the loop unstable, s.
    pub delay_margin_s: f64,
    /// Largest sensitivity, also with every lightly damped mode shifted; infinite if the loop is then not stable.
    pub shifted_sensitivity: f64,
    /// Largest sensitivity with the plants beside the plant; infinite if the loop with one of them is not stable.
    pub sensitivity_of_others: f64,
    /// Largest sensitivity with values at the ends of their tolerances, 0 without any; infinite if the loop is not stable at
    /// one of them.
    pub sensitivity_within_tolerances: f64,
    /// Largest sensitivity over what is not stated at the ends of its usual range, as a share of what is allowed there; 0 if nothing of that kind is
    /// open.
    pub share_within_usual_ranges: f64,
    /// RMS control that the noise of the readings costs, V.
    pub noise_v: f64,
    /// RMS control that their quantisation costs, V.
    pub quantisation_v: f64,
    /// Largest control that the step of the demand takes, V.
    pub step_v: f64,
    /// Largest control over the size of a step of the demand, V over the measured unit.
    pub step_gain: f64,
}

/// A plant under the hold.
struct HeldPlant {
    system: StateSpace,
    /// The same, prepared for its frequency response.
    response: Response,
}

impl HeldPlant {
    fn of(plant: &DesignPlant, sampling: &Sampling) -> Result<Self, Error> {
        let system = sampled_plant(plant, sampling)?;
        Ok(Self { response: Response::of(&system)?, system })
    }

    fn all(plants: &[DesignPlant], sampling: &Sampling) -> Result<Vec<Self>, Error> {
        plants.iter().map(|plant| Self::of(plant, sampling)).collect()
    }

    /// Returns whether the control acts on the reading as in another plant: states that differ are not seen.
    fn acts_like(&self, other: &Self) -> bool {
        let Timebase::Discrete { period_s } = self.system.timebase else { return false };
        let rates: Vec<f64> = (0..RATES_COMPARED).map(|k| 2.0 / period_s * 0.5f64.powi(k)).collect();
        let values = |plant: &Self| plant.response.at_all(&rates).ok();
        let (Some(own), Some(others)) = (values(self), values(other)) else { return false };
        let is_equal = |own: &CMat, other: &CMat| (own - other).norm_max() <= EQUAL * own.norm_max();
        own.iter().zip(&others).all(|(own, other)| is_equal(own, other))
    }
}

/// Frequencies at which two plants are compared, each half of the one before.
const RATES_COMPARED: i32 = 16;

/// A controller from the reading to the control, sampled, and prepared for its frequency response.
struct HeldController {
    system: StateSpace,
    response: Response,
}

impl HeldController {
    fn of(controller: &StateSpace, sampling: &Sampling) -> Result<Self, Error> {
        let system = sampled_controller(controller, sampling)?.select(&[0], &[1]);
        Ok(Self { response: Response::of(&system)?, system })
    }
}

/// A plant beside the plant.
struct Neighbour {
    plant: HeldPlant,
    /// Its lightly damped modes.
    modes_rad_s: Vec<f64>,
}

/// Loops to be judged: the plants under the hold, computed once.
pub(super) struct Judge<'a> {
    circumstances: &'a Circumstances,
    /// The sampling on which loops are judged, coarser than the real one if the delay is long.
    sampling: Sampling,
    held: HeldPlant,
    neighbours: Vec<Neighbour>,
    others: Vec<HeldPlant>,
    within_tolerances: Vec<HeldPlant>,
    within_usual_ranges: Vec<UsualPlant>,
    /// Those with the lags that are usual.
    with_usual_lags: Vec<HeldPlant>,
}

/// A plant at an end of what is usual.
struct UsualPlant {
    plant: HeldPlant,
    /// Largest sensitivity that the loop may have with it.
    max_sensitivity: f64,
}

impl<'a> Judge<'a> {
    /// Prepares the plants.
    ///
    /// # Errors
    /// Those of the discretisation.
    pub fn new(circumstances: &'a Circumstances, neighbours: &[DesignPlant]) -> Result<Self, Error> {
        let sampling = &coarsen_sampling(&circumstances.sampling, &circumstances.plant);
        let all = |plants: &[DesignPlant]| HeldPlant::all(plants, sampling);
        let held = HeldPlant::of(&circumstances.plant, sampling)?;
        let mut others = all(&circumstances.others)?;
        // What the linear plant leaves out of a loop of position is nothing.
        others.retain(|other| other.system != held.system);
        let modes = neighbours.iter().map(light_modes).collect::<Result<Vec<_>, _>>()?;
        let neighbours = all(neighbours)?.into_iter().zip(modes);
        let neighbours = neighbours.map(|(plant, modes)| Neighbour {
            plant,
            modes_rad_s: modes.iter().map(|mode| mode.norm()).collect(),
        });
        let sampling = sampling.clone();
        Ok(Self {
            circumstances,
            held,
            neighbours: neighbours.collect(),
            others,
            within_tolerances: all(&circumstances.within_tolerances)?,
            within_usual_ranges: usual_plants(circumstances, &sampling)?,
            with_usual_lags: all(&circumstances.usual.with_lags)?,
            sampling,
        })
    }

    /// Returns the order of the largest plant under the hold.
    pub fn largest_order(&self) -> usize {
        let usual = self.within_usual_ranges.iter().map(|usual| &usual.plant);
        let all = [&self.held].into_iter().chain(usual).chain(&self.with_usual_lags);
        all.map(|plant| plant.system.order()).max().unwrap_or(0)
    }

    /// Puts the plants at the ends of what is usual into the order in which a loop uses up what is allowed with them, the hardest first: what is not borne
    /// is then seen sooner.
    ///
    /// # Errors
    /// Those of the discretisation and the margins.
    pub fn put_hardest_first(&mut self, controller: &StateSpace, found: &LoopJudgement) -> Result<(), Error> {
        let K = HeldController::of(controller, &self.sampling)?;
        let mut by_share = Vec::new();
        for usual in std::mem::take(&mut self.within_usual_ranges) {
            let sensitivity = sensitivity_beside(&usual.plant, &K, rates_near_peaks(found), held_loop)?;
            by_share.push((sensitivity / usual.max_sensitivity, usual));
        }
        by_share.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        self.within_usual_ranges = by_share.into_iter().map(|(_, plant)| plant).collect();
        Ok(())
    }

    /// The largest complementary sensitivity of a loop; 0 if it is not asked for.
    fn complementary_peak(&self, loop_gain: &StateSpace) -> Result<f64, Error> {
        if self.circumstances.margins.max_complementary.is_infinite() {
            return Ok(0.0);
        }
        Ok(linfnorm(&complementary(loop_gain)?, NORM_TOLERANCE)?.value)
    }

    fn asks_for_overshoot(&self) -> bool {
        self.circumstances.margins.overshoot.is_finite()
    }

    /// The time up to which the response to a step is looked at, s: the largest control comes early, the largest reading later.
    fn step_end(&self, bandwidth_rad_s: f64) -> f64 {
        let bandwidths = if self.asks_for_overshoot() { OVERSHOOT_BY } else { CONTROL_PEAK_BY };
        bandwidths / bandwidth_rad_s
    }

    /// The radius of the disk margin of a loop without skew, the inverse of the largest |(S - T) / 2| = |1/2 - T|; infinite if it is not asked for.
    fn disk_margin(&self, loop_gain: &StateSpace) -> Result<f64, Error> {
        if self.circumstances.margins.disk == 0.0 {
            return Ok(f64::INFINITY);
        }
        let half = StateSpace::gain(Mat::eye(1).scale(0.5), loop_gain.timebase)?;
        let difference = parallel(&half, &complementary(loop_gain)?.negate())?;
        Ok(linfnorm(&difference, NORM_TOLERANCE)?.value.recip())
    }

    /// Judges a continuous controller from (demand, reading) to the control; `None` if its sampled loop is not stable or its gain never falls to 1.
    /// Shifted plants and those of other circumstances are left out, and their sensitivity is taken as the plant's, if `is_out` says so of what is
    /// judged before them.
    ///
    /// # Errors
    /// Those of the discretisation and the margins.
    pub fn judge(
        &self,
        controller: &StateSpace,
        is_out: impl Fn(&LoopJudgement) -> bool,
    ) -> Result<Option<LoopJudgement>, Error> {
        let Circumstances { demand_step, .. } = self.circumstances;
        let [noise_rms, reading_step] = self.circumstances.reading();
        let sampling = &self.sampling;
        let both = sampled_controller(controller, sampling)?;
        let K = HeldController::of(controller, sampling)?;
        let held = &self.held.system;
        let Some(loop_gain) = stable_loop(held, &K.system)? else { return Ok(None) };
        let nominal = candidate_margins(&loop_gain)?;
        let Some(bandwidth_rad_s) = lowest_fall(&loop_gain, &nominal) else { return Ok(None) };
        let crossover = nominal.phase.iter().map(|margin| margin.rate_rad_s).fold(0.0, f64::max);
        // The density of the noise is what the coarser samples keep.
        let thinned = (self.circumstances.sampling.period_s / sampling.period_s).sqrt();
        let gain = thinned * noise_gain(held, &K.system)?;
        let until_s = self.step_end(bandwidth_rad_s);
        let step = step_response(held, &both, until_s, sampling)?;
        let mut found = LoopJudgement {
            bandwidth_rad_s,
            closed_loop_rad_s: closed_loop_bandwidth(held, &K.system, crossover)?,
            gain_margin_db: nominal.gain_margin_db(),
            phase_margin_deg: nominal.phase_margin().map_or(f64::INFINITY, |margin| margin.deg.abs()),
            max_sensitivity: nominal.ms.value,
            sensitivity_peak_rad_s: nominal.ms.rate_rad_s,
            max_complementary: self.complementary_peak(&loop_gain)?,
            overshoot: if self.asks_for_overshoot() { step.overshoot } else { 0.0 },
            disk_margin: self.disk_margin(&loop_gain)?,
            delay_margin_s: nominal.phase.iter().map(|margin| margin.delay_s).fold(f64::INFINITY, f64::min),
            shifted_sensitivity: nominal.ms.value,
            sensitivity_of_others: nominal.ms.value,
            sensitivity_within_tolerances: 0.0,
            share_within_usual_ranges: 0.0,
            noise_v: gain * noise_rms,
            quantisation_v: gain * reading_step / 12f64.sqrt(),
            step_v: demand_step.abs() * step.largest_control,
            step_gain: step.largest_control,
        };
        if is_out(&found) {
            return Ok(Some(found));
        }
        found.sensitivity_of_others = worst_beside(&self.others, &K, &found)?.max(nominal.ms.value);
        found.shifted_sensitivity = self.shifted_sensitivity(&K, &found)?;
        if is_out(&found) {
            return Ok(Some(found));
        }
        found.sensitivity_within_tolerances = worst_beside(&self.within_tolerances, &K, &found)?;
        if is_out(&found) {
            return Ok(Some(found));
        }
        found.share_within_usual_ranges = self.share_over_usual_ranges(&K, &found)?;
        Ok(Some(found))
    }

    /// Returns the sampled loops of a controller, broken at the control: that of the plant, then those of the plants beside it.
    ///
    /// # Errors
    /// Those of the discretisation.
    pub fn loops(&self, controller: &StateSpace) -> Result<Vec<StateSpace>, Error> {
        let K = sampled_controller(controller, &self.sampling)?.select(&[0], &[1]).negate();
        let beside = self.neighbours.iter().map(|neighbour| &neighbour.plant);
        std::iter::once(&self.held).chain(beside).map(|plant| Ok(series(&plant.system, &K)?)).collect()
    }

    /// Returns the first of [`Self::loops`].
    ///
    /// # Errors
    /// Those of the discretisation.
    pub fn nominal_loop(&self, controller: &StateSpace) -> Result<StateSpace, Error> {
        let K = sampled_controller(controller, &self.sampling)?.select(&[0], &[1]).negate();
        Ok(series(&self.held.system, &K)?)
    }

    /// Returns whether the loop of a controller with the plant certainly exceeds the required sensitivity: a few frequencies about an aim show it.
    ///
    /// # Errors
    /// Those of the discretisation.
    pub fn exceeds_sensitivity(&self, controller: &StateSpace, aim_rad_s: f64) -> Result<bool, Error> {
        let K = HeldController::of(controller, &self.sampling)?;
        let seen = largest_sensitivity(&self.held, &K, rates_about(aim_rad_s));
        Ok(seen > (1.0 + SEEN_ABOVE) * self.circumstances.margins.max_sensitivity)
    }

    /// The largest sensitivity over the plant and its neighbours; beyond what is borne, that of the first plant that exceeds it.
    fn shifted_sensitivity(&self, K: &HeldController, nominal: &LoopJudgement) -> Result<f64, Error> {
        let mut worst = nominal.max_sensitivity;
        for Neighbour { plant, modes_rad_s } in &self.neighbours {
            if worst > NEIGHBOUR_MS {
                break;
            }
            let rates =
                modes_rad_s.iter().copied().flat_map(rates_near).chain(rates_about(nominal.bandwidth_rad_s));
            worst = worst.max(sensitivity_beside(plant, K, rates, stable_loop)?);
        }
        Ok(worst)
    }

    /// The largest sensitivity over the plants at the ends of what is usual, over what is allowed with each, and what the margins with usual lags
    /// need over what they have; above 1, that of the first plant that exceeds it.
    fn share_over_usual_ranges(&self, K: &HeldController, nominal: &LoopJudgement) -> Result<f64, Error> {
        if let Some(seen) = self.seen_above_usual_ranges(K, nominal) {
            return Ok(seen);
        }
        let mut worst = 0.0_f64;
        for UsualPlant { plant, max_sensitivity } in &self.within_usual_ranges {
            if worst > 1.0 {
                break;
            }
            worst = worst.max(sensitivity_of(held_loop(&plant.system, &K.system)?)? / max_sensitivity);
        }
        for plant in &self.with_usual_lags {
            if worst > 1.0 {
                break;
            }
            worst = worst.max(self.share_of_margins(&plant.system, &K.system)?);
        }
        Ok(worst)
    }

    /// The share of a plant at an end of what is usual that a few frequencies show to exceed what is allowed; `None` if they show none.
    fn seen_above_usual_ranges(&self, K: &HeldController, nominal: &LoopJudgement) -> Option<f64> {
        let required = self.circumstances.margins.max_sensitivity;
        let with_lags = self.with_usual_lags.iter().map(|plant| (plant, required));
        let at_ends = self.within_usual_ranges.iter().map(|usual| (&usual.plant, usual.max_sensitivity));
        let mut shares = at_ends
            .chain(with_lags)
            .map(|(plant, allowed)| largest_sensitivity(plant, K, rates_near_peaks(nominal)) / allowed);
        shares.find(|share| *share > 1.0 + SEEN_ABOVE)
    }

    /// The largest share of the required margins, and of the highest frequency of the closed loop, that a loop with another plant uses up;
    /// infinite if it is not stable.
    fn share_of_margins(&self, held: &StateSpace, K: &StateSpace) -> Result<f64, Error> {
        let required = &self.circumstances.margins;
        let Some(loop_gain) = held_loop(held, K)? else { return Ok(f64::INFINITY) };
        let found = candidate_margins(&loop_gain)?;
        let phase_deg = found.phase_margin().map_or(f64::INFINITY, |margin| margin.deg.abs());
        let crossover = found.phase.iter().map(|margin| margin.rate_rad_s).fold(0.0, f64::max);
        let highest = CEILING * self.circumstances.sampling.rate_rad_s();
        let shares = [
            found.ms.value / required.max_sensitivity,
            required.gain_db / found.gain_margin_db(),
            required.phase_deg / phase_deg,
            closed_loop_bandwidth(held, K, crossover)? / highest,
        ];
        Ok(shares.into_iter().fold(0.0, f64::max))
    }
}

/// Returns the plants at the ends of what is usual with the sensitivities that are allowed, without those that the reading does not tell from one before them.
fn usual_plants(given: &Circumstances, sampling: &Sampling) -> Result<Vec<UsualPlant>, Error> {
    let mut usual: Vec<UsualPlant> = Vec::new();
    let mut add = |plant: &DesignPlant, max_sensitivity: f64| -> Result<(), Error> {
        let plant = HeldPlant::of(plant, sampling)?;
        if !usual.iter().any(|known| known.plant.acts_like(&plant)) {
            usual.push(UsualPlant { plant, max_sensitivity });
        }
        Ok(())
    };
    for plant in &given.usual.within_ranges {
        add(plant, given.margins.max_sensitivity)?;
        // Modes are shifted as the plant's own are: at the delay that is known.
        if plant.late_reading == given.plant.late_reading {
            for shifted in shifted_modes(plant, &light_modes(plant)?)? {
                add(&shifted, NEIGHBOUR_MS)?;
            }
        }
    }
    for plant in &given.usual.with_lags {
        for shifted in shifted_modes(plant, &light_modes(plant)?)? {
            add(&shifted, NEIGHBOUR_MS)?;
        }
    }
    for plant in &given.usual.others_at_ends {
        add(plant, NEIGHBOUR_MS)?;
    }
    Ok(usual)
}

/// Returns the sampling with a longer period if its delay has more samples than [`MOST_DELAY_SAMPLES`]; the delay is not
/// shortened, so the loop that is judged is never better than the real one.
fn coarsen_sampling(sampling: &Sampling, plant: &DesignPlant) -> Sampling {
    let late_samples = plant.late_reading.as_ref().map_or(0, |reading| reading.samples(sampling.period_s));
    let factor = (sampling.delay_samples + late_samples).div_ceil(MOST_DELAY_SAMPLES).max(1);
    Sampling {
        period_s: factor as f64 * sampling.period_s,
        delay_samples: sampling.delay_samples.div_ceil(factor),
        ..sampling.clone()
    }
}

/// Samples of delay beyond which loops are judged on a coarser grid. Each is a state of the sampled plant; no bandwidth above
/// 2 over the delay is looked at, so that a grid of 24 samples in the delay costs 5 degrees at the most.
const MOST_DELAY_SAMPLES: usize = 24;

impl LoopJudgement {
    /// Returns whether the margins hold.
    pub(super) fn keeps_margins(&self, required: &RequiredMargins) -> bool {
        self.gain_margin_db >= required.gain_db
            && self.phase_margin_deg >= required.phase_deg
            && self.max_sensitivity <= required.max_sensitivity
            && self.max_complementary <= required.max_complementary
            && self.overshoot <= required.overshoot
            && self.disk_margin >= required.disk
            && self.delay_margin_s >= required.delay_s
    }

    /// Returns what the loop has over what is allowed, for each figure with the limit that it belongs to; above 1 it misses it.
    pub(super) fn shares_of_limits(
        &self,
        required: &RequiredMargins,
        sampling: &Sampling,
        holding_v: f64,
    ) -> [(LimitKind, f64); 15] {
        let limit_v = sampling.limit_v;
        let highest = CEILING * sampling.rate_rad_s();
        [
            (LimitKind::SampleRate, self.bandwidth_rad_s.max(self.closed_loop_rad_s) / highest),
            (LimitKind::Margins, required.gain_db / self.gain_margin_db.max(f64::MIN_POSITIVE)),
            (LimitKind::Margins, required.phase_deg / self.phase_margin_deg.max(f64::MIN_POSITIVE)),
            (LimitKind::Margins, self.max_sensitivity / required.max_sensitivity),
            (LimitKind::Margins, self.max_complementary / required.max_complementary),
            (LimitKind::Margins, (1.0 + self.overshoot) / (1.0 + required.overshoot)),
            (LimitKind::Margins, required.disk / self.disk_margin),
            (LimitKind::Margins, required.delay_s / self.delay_margin_s.max(f64::MIN_POSITIVE)),
            (LimitKind::Resonance, self.shifted_sensitivity / NEIGHBOUR_MS),
            (LimitKind::AtRest, self.sensitivity_of_others / NEIGHBOUR_MS),
            (LimitKind::Tolerances, self.sensitivity_within_tolerances / NEIGHBOUR_MS),
            (LimitKind::UsualRanges, self.share_within_usual_ranges),
            (LimitKind::Noise, self.noise_v / (NOISE_SHARE * limit_v)),
            (LimitKind::Quantisation, self.quantisation_v / (NOISE_SHARE * limit_v)),
            (LimitKind::Control, self.step_v / (limit_v - holding_v.abs()).max(f64::MIN_POSITIVE)),
        ]
    }

    /// Returns whether the loop bears shifted modes.
    pub(super) fn bears_shifted_modes(&self) -> bool {
        self.shifted_sensitivity <= NEIGHBOUR_MS
    }

    /// Returns whether the loop holds the machine with what the linear plant leaves out.
    pub(super) fn holds_others(&self) -> bool {
        self.sensitivity_of_others <= NEIGHBOUR_MS
    }

    /// Returns whether the loop bears values at the ends of their tolerances.
    pub(super) fn bears_tolerances(&self) -> bool {
        self.sensitivity_within_tolerances <= NEIGHBOUR_MS
    }

    /// Returns whether the loop bears what is not stated at the ends of its usual range.
    pub(super) fn bears_usual_ranges(&self) -> bool {
        self.share_within_usual_ranges <= 1.0
    }

    /// Returns whether noise leaves the control's range to its work.
    pub(super) fn bears_noise(&self, limit_v: f64) -> bool {
        self.noise_v <= NOISE_SHARE * limit_v
    }

    /// Returns whether quantisation leaves the control's range to its work.
    pub(super) fn bears_quantisation(&self, limit_v: f64) -> bool {
        self.quantisation_v <= NOISE_SHARE * limit_v
    }

    /// Returns whether the step of the demand stays inside the control's limit.
    pub(super) fn bears_step(&self, room_v: f64) -> bool {
        self.step_v <= room_v
    }

    /// Returns whether the loop is slow enough for its sample rate.
    pub(super) fn bears_sampling(&self, sampling: &Sampling) -> bool {
        self.bandwidth_rad_s.max(self.closed_loop_rad_s) <= CEILING * sampling.rate_rad_s()
    }
}

/// The controller from demand and reading to the control, sampled as the exported one will be.
fn sampled_controller(controller: &StateSpace, sampling: &Sampling) -> Result<StateSpace, Error> {
    // poles and zeros are matched path by path; the bilinear map stands in for that on both paths at once
    let method = match sampling.method.conversion() {
        Discretisation::Matched => Discretisation::Tustin { prewarp_rad_s: None },
        method => method,
    };
    Ok(c2d(&controller.select(&[0], &[0, 1]), sampling.period_s, method)?)
}

/// Returns the lowest frequency at which the gain of a loop falls to 1, rad/s; `None` if it never does. At a resonance far above it the gain may
/// rise above 1 once more and fall again.
fn lowest_fall(loop_gain: &StateSpace, margins: &CandidateMargins) -> Option<f64> {
    let mut below = None;
    for margin in &margins.phase {
        let rate = margin.rate_rad_s;
        let between = below.map_or(0.5 * rate, |below: f64| (below * rate).sqrt());
        let response = frequency_response(loop_gain, &[between]);
        if response.map_or(f64::INFINITY, |values| values[0][(0, 0)].norm()) > 1.0 {
            return Some(rate);
        }
        below = Some(rate);
    }
    None
}

/// The complementary sensitivity of a loop.
fn complementary(loop_gain: &StateSpace) -> Result<StateSpace, Error> {
    Ok(closed(loop_gain, &StateSpace::gain(Mat::eye(1), loop_gain.timebase)?)?)
}

/// The loop gain of a controller on a plant; `None` if its closed loop is not stable.
fn stable_loop(plant: &StateSpace, K: &StateSpace) -> Result<Option<StateSpace>, Error> {
    loop_with_poles(plant, K, |pole| is_stable_pole(pole, plant.timebase))
}

/// The loop gain of a controller on a plant; `None` if its closed loop is not stable but for what only drifts.
fn held_loop(plant: &StateSpace, K: &StateSpace) -> Result<Option<StateSpace>, Error> {
    loop_with_poles(plant, K, |pole| pole.norm() < 1.0 || (pole - C64::ONE).norm() < DRIFTING_POLE)
}

/// The loop gain of a controller on a plant; `None` if a pole of its closed loop is not allowed.
fn loop_with_poles(
    plant: &StateSpace,
    K: &StateSpace,
    is_allowed: impl Fn(C64) -> bool,
) -> Result<Option<StateSpace>, Error> {
    let loop_gain = series(plant, &K.negate())?;
    // Poles cost a hundredth of the margins, and most candidates that fail are not stable.
    let one = StateSpace::gain(Mat::eye(1), loop_gain.timebase)?;
    let found = poles(&closed(&loop_gain, &one)?)?;
    Ok(found.into_iter().all(is_allowed).then_some(loop_gain))
}

/// The largest sensitivity with a plant beside the plant, infinite if there is no such loop; that at some frequencies if they show already
/// that it is not borne.
fn sensitivity_beside(
    plant: &HeldPlant,
    K: &HeldController,
    rates_rad_s: impl Iterator<Item = f64>,
    loop_of: fn(&StateSpace, &StateSpace) -> Result<Option<StateSpace>, Error>,
) -> Result<f64, Error> {
    let seen = largest_sensitivity(plant, K, rates_rad_s);
    if seen > (1.0 + SEEN_ABOVE) * NEIGHBOUR_MS {
        return Ok(seen);
    }
    sensitivity_of(loop_of(&plant.system, &K.system)?)
}

/// The largest sensitivity of a loop; infinite if there is none.
fn sensitivity_of(loop_gain: Option<StateSpace>) -> Result<f64, Error> {
    loop_gain.map_or(Ok(f64::INFINITY), |loop_gain| Ok(candidate_sensitivity(&loop_gain)?.value))
}

/// The largest sensitivity over plants whose loops may drift, 0 without any; beyond what is borne, that of the first plant that exceeds it.
fn worst_beside(plants: &[HeldPlant], K: &HeldController, nominal: &LoopJudgement) -> Result<f64, Error> {
    let mut worst = 0.0_f64;
    for plant in plants {
        if worst > NEIGHBOUR_MS {
            break;
        }
        worst = worst.max(sensitivity_beside(plant, K, rates_near_peaks(nominal), held_loop)?);
    }
    Ok(worst)
}

/// Returns the frequencies about the bandwidth and the peak of the sensitivity of a loop, rad/s, where that with another plant is likely to be large.
fn rates_near_peaks(nominal: &LoopJudgement) -> impl Iterator<Item = f64> {
    let rates = rates_about(nominal.bandwidth_rad_s).chain(rates_about(nominal.sensitivity_peak_rad_s));
    rates.filter(|rate| *rate > 0.0)
}

/// The largest sensitivity at some frequencies; those above half the sample rate and on a pole are left out.
fn largest_sensitivity(plant: &HeldPlant, K: &HeldController, rates_rad_s: impl Iterator<Item = f64>) -> f64 {
    let Timebase::Discrete { period_s } = plant.system.timebase else { return 0.0 };
    let rates: Vec<f64> = rates_rad_s.filter(|rate| rate * period_s < PI).collect();
    let (Ok(P), Ok(K)) = (plant.response.at_all(&rates), K.response.at_all(&rates)) else { return 0.0 };
    P.iter().zip(&K).map(|(P, K)| (C64::ONE - P[(0, 0)] * K[(0, 0)]).norm().recip()).fold(0.0, f64::max)
}

/// A few frequencies from a quarter of one to sixteen times it: where a crossover leaves a peak.
fn rates_about(rate_rad_s: f64) -> impl Iterator<Item = f64> {
    (-4..=8).map(move |k| rate_rad_s * 2f64.powf(0.5 * f64::from(k)))
}

/// A few frequencies about a lightly damped mode.
fn rates_near(rate_rad_s: f64) -> impl Iterator<Item = f64> {
    (-3..=3).map(move |k| rate_rad_s * (1.0 + 0.01 * f64::from(k)))
}

/// RMS control for readings with noise of unit RMS.
fn noise_gain(plant: &StateSpace, K: &StateSpace) -> Result<f64, Error> {
    Ok(h2norm(&closed(K, &plant.negate())?)?)
}

/// Highest frequency of a grid at which |T| is at least 0.707, rad/s.
fn closed_loop_bandwidth(plant: &StateSpace, K: &StateSpace, crossover: f64) -> Result<f64, Error> {
    let response = Response::of(&series(plant, &K.negate())?)?;
    let mut highest = crossover;
    for k in 0..=BANDWIDTH_POINTS {
        let rate = crossover * BANDWIDTH_REACH.powf(f64::from(k) / f64::from(BANDWIDTH_POINTS));
        let Ok(value) = response.at(rate) else { continue };
        let L = value[(0, 0)];
        if (L / (C64::ONE + L)).norm() >= std::f64::consts::FRAC_1_SQRT_2 {
            highest = rate;
        }
    }
    Ok(highest)
}

/// Up to how many times the crossover the closed loop's bandwidth is looked for, and at how many points.
const BANDWIDTH_REACH: f64 = 6.0;
const BANDWIDTH_POINTS: u32 = 60;

/// The response to a unit step of the demand.
struct StepResponse {
    largest_control: f64,
    /// What the largest reading exceeds the step by, as a share of it; 0 if it does not.
    overshoot: f64,
}

/// The response to a unit step of the demand, with the controller from demand and reading.
fn step_response(
    plant: &StateSpace,
    K: &StateSpace,
    until_s: f64,
    sampling: &Sampling,
) -> Result<StepResponse, Error> {
    let samples = ((until_s / sampling.period_s).ceil() as usize).clamp(2, MOST_SAMPLES);
    let (mut x, mut q) = (vec![0.0; plant.order()], vec![0.0; K.order()]);
    let (plant_row, controller_row) = (plant.C.row_vec(0), K.C.row_vec(0));
    let (mut largest_control, mut largest_reading) = (0.0_f64, 0.0_f64);
    for _ in 0..samples {
        let reading = dot(&plant_row, &x);
        largest_reading = largest_reading.max(reading);
        let u = dot(&controller_row, &q) + K.D[(0, 0)] + K.D[(0, 1)] * reading;
        largest_control = largest_control.max(u.abs());
        q = next_state(K, &q, &[1.0, reading]);
        x = next_state(plant, &x, &[u]);
    }
    Ok(StepResponse { largest_control, overshoot: (largest_reading - 1.0).max(0.0) })
}

/// The state of a sampled system a sample later, A x + B u.
fn next_state(system: &StateSpace, x: &[f64], u: &[f64]) -> Vec<f64> {
    let mut next = vec![0.0; system.order()];
    let columns = |M: &Mat, by: &[f64], next: &mut [f64]| {
        for (j, by) in by.iter().enumerate() {
            next.iter_mut().zip(M.column(j)).for_each(|(sum, entry)| *sum += entry * by);
        }
    };
    columns(&system.A, x, &mut next);
    columns(&system.B, u, &mut next);
    next
}

/// Samples of a step that are looked at, at most: the largest control comes early.
const MOST_SAMPLES: usize = 4000;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_resonance_far_above_the_fall_of_the_gain_is_not_the_bandwidth() {
        let system = |A: &[&[f64]], B: &[&[f64]], C: &[&[f64]]| {
            let (A, B, C) = (Mat::from_rows(A), Mat::from_rows(B), Mat::from_rows(C));
            StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
        };
        // 5/s, and a mode at 200 rad/s with a damping ratio of 0.005 whose peak is 3.
        let integrator = system(&[&[0.0]], &[&[1.0]], &[&[5.0]]);
        let mode = system(&[&[0.0, 1.0], &[-4e4, -2.0]], &[&[0.0], &[1.0]], &[&[0.0, 6.0]]);
        let both = parallel(&integrator, &mode).unwrap();
        let sampled = c2d(&both, 1e-3, Discretisation::ZeroOrderHold).unwrap();
        let margins = candidate_margins(&sampled).unwrap();
        assert_eq!(margins.phase.len(), 3, "{margins:?}");
        let fall = lowest_fall(&sampled, &margins).unwrap();
        assert!((fall / 5.0 - 1.0).abs() < 0.01, "{fall}");
        let highest = margins.phase.last().unwrap().rate_rad_s;
        assert!((highest / 200.0 - 1.0).abs() < 0.1, "{highest}");
    }
}
