//! The feedback's weights for a bandwidth that they aim at.

use std::f64::consts::SQRT_2;

use counterpoise_linalg::C64;
use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_lti::response::Response;
use counterpoise_lti::{StateSpace, zeros};

use super::Circumstances;
use crate::tolerance::{BLIND_BELOW, BLIND_FALL, BLIND_SPAN, LARGEST_LOAD, LARGEST_MULTIPLE, LIGHTLY_DAMPED};
use crate::{Error, FeedbackWeights, LightModes, Weight};

/// Multiples of the bandwidth that shape the weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    /// The error weight integrates below the bandwidth over this.
    integral: f64,
    /// The observer is this many times as quick as the bandwidth.
    observer: f64,
    /// The control weight rises above this many times the bandwidth.
    roll_off: f64,
    /// The weight of control at the modes that are lightly damped.
    modes: Modes,
    /// The lightly damped modes in the plant that the feedback is designed on.
    in_plant: LightModes,
    /// At the slowest lightly damped zero, the cost of what the load does over that of the control that moves it; 0 leaves the load out.
    load: f64,
}

impl Shape {
    /// Returns the shapes with each multiple smaller and larger by a factor.
    pub fn variations(&self, factor: f64) -> [Self; 6] {
        let Self { integral, observer, roll_off, .. } = *self;
        [
            Self { integral: integral / factor, ..*self },
            Self { integral: integral * factor, ..*self },
            Self { observer: observer / factor, ..*self },
            Self { observer: observer * factor, ..*self },
            Self { roll_off: roll_off / factor, ..*self },
            Self { roll_off: roll_off * factor, ..*self },
        ]
    }

    /// Returns the shapes of every kind for some forms of the plant and costs of the load's motion, each with its multiples at three sizes: as for the
    /// quickest observer, so large that what is left is nearly a constant gain with an integral, and those of a slow observer.
    pub fn kinds(plants: &[LightModes], loads: &[f64]) -> Vec<Self> {
        let mut kinds = Vec::new();
        for &in_plant in plants {
            for modes in [Modes::Plain, Modes::Dear] {
                for &load in loads {
                    let kind = Self { modes, in_plant, load, ..QUICKEST };
                    let flat = Self { integral: FLAT, observer: FLAT, roll_off: FLAT, ..kind };
                    let slow = Self { observer: SLOW, roll_off: SLOW, ..kind };
                    kinds.extend([kind, flat, slow]);
                }
            }
        }
        kinds
    }

    /// Returns the shapes beside this one, [`Self::variations`] and those with another cost of the load, always in the same order; `None` for one that is out of
    /// range or no other.
    pub fn steps(&self, factor: f64) -> [Option<Self>; 8] {
        let [less_integral, more_integral, slower, quicker, earlier, later] = self.variations(factor);
        let [dearer, cheaper] = [self.load * factor, self.load / factor].map(|load| Self { load, ..*self });
        [more_integral, less_integral, quicker, slower, later, earlier, dearer, cheaper]
            .map(|shape| (shape != *self && shape.is_in_range()).then_some(shape))
    }

    fn is_in_range(&self) -> bool {
        let multiples = [self.integral, self.observer, self.roll_off];
        let has_load = (1.0 / LARGEST_LOAD..=LARGEST_LOAD).contains(&self.load);
        multiples.iter().all(|multiple| (1.0..=LARGEST_MULTIPLE).contains(multiple))
            && (self.load == 0.0 || has_load)
    }
}

/// The form of the control weight at lightly damped modes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Modes {
    /// Nothing.
    Plain,
    /// It is larger by [`PEAK`] there: the controller's gain has a broad notch.
    Dear,
}

const USUAL: Shape = Shape {
    integral: 5.0,
    observer: 4.0,
    roll_off: 4.0,
    modes: Modes::Plain,
    in_plant: LightModes::Kept,
    load: 0.0,
};
const QUICK: Shape = Shape { integral: 8.0, observer: 8.0, roll_off: 8.0, ..USUAL };
const QUICKEST: Shape = Shape { integral: 16.0, observer: 16.0, roll_off: 16.0, ..USUAL };

/// Shapes that are tried in order: the usual one, one with more phase at the cost of noise, one that attenuates modes, and
/// one with the roll-off of the quickest filter and little integral action for long delays. The usual one leaves a loop of
/// one integrator 57 degrees of phase. Then those that attenuate modes and leave more phase, those that damp the load, and the first eight
/// for the plant with stiff modes.
pub(super) const SHAPES: [Shape; 23] = [
    USUAL,
    QUICK,
    QUICKEST,
    Shape { integral: 8.0, modes: Modes::Dear, ..USUAL },
    Shape { integral: 12.0, observer: 2.5, modes: Modes::Dear, ..USUAL },
    Shape { modes: Modes::Dear, ..QUICKEST },
    Shape { roll_off: 8.0, modes: Modes::Dear, ..QUICKEST },
    Shape { roll_off: 4.0, modes: Modes::Dear, ..QUICKEST },
    Shape { load: 3.0, ..USUAL },
    Shape { load: 3.0, ..QUICK },
    Shape { load: 1.0, ..QUICKEST },
    Shape { load: 3.0, ..QUICKEST },
    Shape { load: 10.0, ..QUICK },
    Shape { load: 10.0, ..QUICKEST },
    Shape { modes: Modes::Dear, load: 1.0, ..QUICKEST },
    Shape { in_plant: LightModes::Stiffened, ..USUAL },
    Shape { in_plant: LightModes::Stiffened, ..QUICK },
    Shape { in_plant: LightModes::Stiffened, ..QUICKEST },
    Shape { integral: 8.0, modes: Modes::Dear, in_plant: LightModes::Stiffened, ..USUAL },
    Shape { integral: 12.0, observer: 2.5, modes: Modes::Dear, in_plant: LightModes::Stiffened, ..USUAL },
    Shape { modes: Modes::Dear, in_plant: LightModes::Stiffened, ..QUICKEST },
    Shape { roll_off: 8.0, modes: Modes::Dear, in_plant: LightModes::Stiffened, ..QUICKEST },
    Shape { roll_off: 4.0, modes: Modes::Dear, in_plant: LightModes::Stiffened, ..QUICKEST },
];
/// The shapes that attenuate modes with the usual observer: 3 and 4.
pub(super) const DEAR: std::ops::Range<usize> = 3..5;
/// The shapes from here on attenuate modes and leave more phase. They are tried where 3 or 4 lacks nothing but phase, by a loop that its clock
/// does not limit: a quick clock leaves a resonance in the phase in which it harms, where the lag of a slow one had turned it away.
pub(super) const MORE_PHASE: usize = 5;
/// The shapes from here on damp the load where the reading has a lightly damped zero. Regulators without it put poles on such a zero, where the
/// reading shows nothing of them: a load that is a little heavier, or a transmission a little softer, then makes the loop unstable.
pub(super) const DAMPED_LOAD: usize = 8;
/// The shapes from here on are for the plant with stiff modes: their observer follows no lightly damped mode, and costs less phase than
/// one that follows a mode which the feedback cannot damp.
pub(super) const STIFF_MODES: usize = 15;

/// Multiples of the bandwidth so large that observer, roll-off and integral do not show near it.
const FLAT: f64 = 50.0;
/// Multiples of the bandwidth of a slow observer, which attenuates everything above it.
const SLOW: f64 = 2.0;
/// Factor on the control weight at a lightly damped mode: 20 dB.
const PEAK: f64 = 10.0;
/// Relative half width of that: covers the shift of [`crate::tolerance::MODE_SHIFT`] either way.
const PEAK_WIDTH: f64 = 0.3;
/// Modes at which control is made dear, at most: each adds two states to the controller.
const MOST_PEAKS: usize = 3;
/// Share of the control's limit whose square, over a sample, is the noise that the observer assumes at the control if the
/// sensor's noise is not known; the controller depends on the quotient of the two noises alone.
const CONTROL_NOISE: f64 = 1e-2;
/// An error weight that may not be infinite at zero frequency is level below its corner over this.
const LEVEL: f64 = 100.0;
/// Points over a factor of [`SPREAD`] either way over which the plant's gain is averaged: a resonance is not its gain.
const POINTS: i32 = 4;
const SPREAD: f64 = 1.5;

/// The plant's gain as the weights need it.
pub(super) struct PlantGain {
    response: Response,
    /// `true` if the measured signal shows nothing of a steady control.
    is_blind_at_zero: bool,
    /// Lightly damped modes, rad/s, rising.
    pub modes: Vec<f64>,
    /// The motion of the load where the reading shows nothing of it.
    pub load: Option<LoadGain>,
}

/// The load's motion at the slowest lightly damped zero of the reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadGain {
    /// The output of the plant.
    output: usize,
    /// Its modulus over that of the control.
    gain: f64,
}

impl PlantGain {
    /// Returns the gain of what the feedback sees.
    ///
    /// # Errors
    /// Those of the plant.
    pub fn of(circumstances: &Circumstances, modes: Vec<f64>) -> Result<Self, Error> {
        let plant = circumstances.plant.weighted_plant();
        let measured = plant.measured_plant()?;
        let seen = measured.select(&[0], &[plant.control]);
        let response = Response::of(&seen)?;
        let gain = |rate: f64| response.at(rate).map_or(f64::INFINITY, |value| value.norm_max());
        // Two decades apart far below everything: a gain that falls with frequency towards zero has a zero there.
        let lowest = BLIND_BELOW * circumstances.sampling.highest_rad_s();
        let is_blind_at_zero = gain(BLIND_SPAN * lowest) < BLIND_FALL * gain(lowest);
        Ok(Self { response, is_blind_at_zero, modes, load: load_gain(circumstances, &measured)? })
    }

    /// The modulus around a frequency, as a geometric mean.
    fn mean_modulus(&self, rate_rad_s: f64) -> f64 {
        let step = SPREAD.powf(1.0 / f64::from(POINTS));
        let points = (-POINTS..=POINTS).map(|k| {
            let value = self.response.at(rate_rad_s * step.powi(k));
            value.map_or(f64::INFINITY, |value| value.norm_max()).ln()
        });
        (points.sum::<f64>() / f64::from(2 * POINTS + 1)).exp()
    }

    /// The fall of the modulus with frequency, as a power between 0 and 3.
    fn slope(&self, rate_rad_s: f64) -> f64 {
        let (below, above) = (self.mean_modulus(rate_rad_s / 2.0), self.mean_modulus(rate_rad_s * 2.0));
        ((below / above).ln() / 4f64.ln()).clamp(0.0, 3.0)
    }
}

/// Returns the feedback's weights for an aim in rad/s; `None` if the plant has no gain there.
pub(super) fn weights(
    circumstances: &Circumstances,
    gain: &PlantGain,
    aim_rad_s: f64,
    shape: Shape,
) -> Option<FeedbackWeights> {
    let combination = match (shape.load, gain.load) {
        (0.0, _) => Vec::new(),
        (cost, Some(load)) => vec![VectorEntry::new(load.output, round_weight(cost / load.gain))],
        (_, None) => return None,
    };
    let level = gain.mean_modulus(aim_rad_s);
    if !(level > 0.0 && level.is_finite()) {
        return None;
    }
    let at_observer = level * shape.observer.powf(-gain.slope(aim_rad_s));
    let period_s = circumstances.sampling.period_s;
    let noise_rms = noise_rms(circumstances);
    let (measurement_noise, loop_recovery) = if noise_rms > 0.0 {
        let density = noise_rms.powi(2) * period_s;
        (density, density / at_observer.powi(2))
    } else {
        let density = (CONTROL_NOISE * circumstances.sampling.limit_v).powi(2) * period_s;
        (density * at_observer.powi(2), density)
    };
    Some(FeedbackWeights {
        error: error(gain, round_weight(aim_rad_s / shape.integral), round_weight(1.0 / level)),
        control: control(gain, aim_rad_s, shape)?,
        combination,
        measurement_noise: round_weight(measurement_noise),
        disturbances: Vec::new(),
        loop_recovery: round_weight(loop_recovery),
        modes: shape.in_plant,
    })
}

/// Returns what the load does at the slowest lightly damped zero from the control to the reading, given the
/// [measured plant](crate::DesignPlant::measured_plant); `None` if there is no such zero, or the load is
/// what is read.
fn load_gain(circumstances: &Circumstances, measured: &StateSpace) -> Result<Option<LoadGain>, Error> {
    let plant = circumstances.plant.weighted_plant();
    let Some(output) = circumstances.load_output.filter(|output| *output != plant.rate) else {
        return Ok(None);
    };
    let is_light = |zero: &C64| zero.im > 0.0 && zero.re.abs() < LIGHTLY_DAMPED * zero.norm();
    let rates =
        zeros(&measured.select(&[0], &[plant.control]))?.into_iter().filter(is_light).map(|zero| zero.norm());
    let slowest = rates.fold(f64::INFINITY, f64::min);
    if slowest > circumstances.sampling.highest_rad_s() {
        return Ok(None);
    }
    let motion = measured.select(&[1 + output], &[plant.control]);
    let gain = Response::of(&motion)?.at(slowest).map_or(0.0, |value| value.norm_max());
    Ok((gain > 0.0 && gain.is_finite()).then_some(LoadGain { output, gain }))
}

/// RMS noise of what the weights are for: the difference of two noisy readings over a period in a cascade.
fn noise_rms(circumstances: &Circumstances) -> f64 {
    let inner = circumstances.plant.rate_loop.as_ref();
    inner.map_or(circumstances.noise_rms, |inner| SQRT_2 * circumstances.noise_rms / inner.period_s)
}

/// The rate loop's aim over the gain of the position loop: the position loop then adds 11 degrees of lag at the rate loop's
/// crossover (the angle whose tangent is a fifth), which the shapes above have to spare.
const OUTER_RATIO: f64 = 5.0;

/// Returns the gain of the position loop for an aim of the rate loop; `None` if there is one loop.
pub(super) fn position_gain(circumstances: &Circumstances, aim_rad_s: f64) -> Option<f64> {
    circumstances.plant.rate_loop.as_ref()?;
    Some(circumstances.position_gain.unwrap_or_else(|| round_weight(aim_rad_s / OUTER_RATIO)))
}

/// Rounds to four significant digits, as a person would write a weight.
pub(super) fn round_weight(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    // A decimal of so many digits is read back as the nearest number, whatever its power of ten.
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// `gain (s + corner) / s`, or level below the corner where the plant has no gain at zero frequency.
fn error(plant: &PlantGain, corner_rad_s: f64, gain: f64) -> Weight {
    let pole = if plant.is_blind_at_zero { -corner_rad_s / LEVEL } else { 0.0 };
    Weight::ZeroPoleGain { zeros: vec![C64::new(-corner_rad_s, 0.0)], poles: vec![C64::new(pole, 0.0)], gain }
}

/// 1 below the roll-off, rising above it; dear at the modes above the aim. `None` if there are none to make it dear at.
fn control(plant: &PlantGain, aim_rad_s: f64, shape: Shape) -> Option<Weight> {
    let lead = Weight::Lead { gain: 1.0, time_s: round_weight(1.0 / (shape.roll_off * aim_rad_s)) };
    if shape.modes == Modes::Plain {
        return Some(lead);
    }
    let above = plant.modes.iter().filter(|mode| **mode > aim_rad_s).take(MOST_PEAKS);
    let peaks: Vec<Weight> = above
        .map(|&mode| Weight::Notch {
            gain: 1.0,
            centre_rad_s: round_weight(mode),
            width: PEAK_WIDTH,
            factor: PEAK,
        })
        .collect();
    if peaks.is_empty() {
        return None;
    }
    Some(Weight::Product(std::iter::once(lead).chain(peaks).collect()))
}
