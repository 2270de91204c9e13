//! Frequency responses of plant, controller, loop and platform to hub.

use counterpoise_linalg::{C64, CMat};

use super::loop_responses::{LoopResponse, loop_responses};
use super::plant::port;
use super::plant_response::{ACCELEROMETER, HUB_GYRO, PLATFORM_GYRO, PlantResponse, hold_and_delay};
use super::{ArrangedLoop, ClosedLoop, SampledPlant};
use crate::{Arrangement, Error, Source};

/// One complex response over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseCurve {
    /// Name, for a legend.
    pub name: String,
    /// One value a frequency of [`Curves::frequency_hz`].
    pub response: Vec<C64>,
}

/// All curves over one grid of frequencies up to half the sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Hub rate for the control, heave and pitch rate, continuous, without sensors.
    pub plant: Vec<ResponseCurve>,
    /// The discrete controller from the hub gyroscope (with the sign of the rate error), the accelerometer and the platform gyroscope.
    pub controller: Vec<ResponseCurve>,
    /// The loop broken at the plant's input.
    pub broken: ResponseCurve,
    /// 1 / (1 + L) and L / (1 + L).
    pub sensitivities: Vec<ResponseCurve>,
    /// The responses of the loop to its demand, of a disturbance of the control, and of the noise of each sensor that the feedback reads: with
    /// the two sensitivities, the gang of six.
    pub loop_responses: Vec<LoopResponse>,
    /// Hub rate over platform motion.
    pub rejection: Vec<Rejection>,
}

/// Hub rate over platform motion in one arrangement.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejection {
    /// Heave or pitch.
    pub source: Source,
    /// Part of the controller that acts.
    pub arrangement: Arrangement,
    /// Hub rate over heave, rad/s per m/s^2, or over pitch rate.
    pub response: Vec<C64>,
}

const POINTS: usize = 700;
const LOWEST_HZ: f64 = 0.02;

/// Returns a logarithmic grid from 0.02 Hz to just below half the sample rate.
pub fn grid_hz(sample_period_s: f64) -> Vec<f64> {
    let highest = 0.499 / sample_period_s;
    let ratio = (highest / LOWEST_HZ).ln() / (POINTS - 1) as f64;
    (0..POINTS).map(|k| LOWEST_HZ * (ratio * k as f64).exp()).collect()
}

impl Curves {
    /// Returns the curves of `loops`, one an arrangement (the last one is the whole controller).
    ///
    /// # Errors
    /// A response that does not exist because of a pole on the axis.
    pub fn of(plant: &SampledPlant, loops: &[ArrangedLoop]) -> Result<Self, Error> {
        Self::with(plant, &PlantResponse::of(plant, grid_hz(plant.sample_period_s))?, loops)
    }

    /// Returns the same as [`Curves::of`], with what the plant contributes already at hand.
    ///
    /// # Errors
    /// As [`Curves::of`].
    pub fn with(plant: &SampledPlant, at: &PlantResponse, loops: &[ArrangedLoop]) -> Result<Self, Error> {
        let truth = |input: usize| at.continuous.iter().map(|m| m[(port::HUB, input)]).collect();
        let names = ["control", "heave", "pitch"];
        let plant_curves =
            (0..3).map(|j| ResponseCurve { name: names[j].to_owned(), response: truth(j) }).collect();
        let (mut rejection, mut controller) = (Vec::new(), None);
        for ArrangedLoop { arrangement, closed } in loops {
            let K = at.controller(closed)?;
            rejection.extend(rejection_of(plant, at, K.as_deref(), *arrangement));
            controller = K.or(controller);
        }
        let broken = controller.as_deref().map_or(Vec::new(), |K| break_loop(K, &at.readings));
        Ok(Self {
            plant: plant_curves,
            controller: controller.as_deref().map_or(Vec::new(), controller_curves),
            sensitivities: sensitivities(&broken),
            loop_responses: controller
                .as_deref()
                .map_or(Vec::new(), |K| loop_responses(plant, at, K, &broken)),
            broken: ResponseCurve { name: "loop".to_owned(), response: broken },
            rejection,
            frequency_hz: at.frequency_hz.clone(),
        })
    }
}

/// L = -K P.
pub(super) fn break_loop(K: &[CMat], P: &[CMat]) -> Vec<C64> {
    let at = |(K, P): (&CMat, &CMat)| -(0..P.nrows()).map(|i| K[(0, i)] * P[(i, 0)]).sum::<C64>();
    K.iter().zip(P).map(at).collect()
}

fn sensitivities(broken: &[C64]) -> Vec<ResponseCurve> {
    let one = C64::new(1.0, 0.0);
    let of = |name: &str, value: &dyn Fn(C64) -> C64| ResponseCurve {
        name: name.to_owned(),
        response: broken.iter().map(|&L| value(L)).collect(),
    };
    vec![of("sensitivity", &|L| one / (one + L)), of("complementary sensitivity", &|L| L / (one + L))]
}

fn controller_curves(response: &[CMat]) -> Vec<ResponseCurve> {
    let column = |name: &str, j: usize, sign: f64| ResponseCurve {
        name: name.to_owned(),
        response: response.iter().map(|m| m[(0, j)] * sign).collect(),
    };
    vec![
        column("feedback", HUB_GYRO, -1.0),
        column("heave feedforward", ACCELEROMETER, 1.0),
        column("pitch feedforward", PLATFORM_GYRO, 1.0),
    ]
}

/// Returns the hub rate over heave and over pitch rate at each frequency, in one arrangement.
///
/// A tone of the platform at w reaches the sampled readings as R(jw), exactly, for one tone has no aliases that matter. The control
/// samples then have the tone u = K R / (1 - K P), and the held control has at w the part H(jw) u, H being the hold. So the hub has
///
/// ```text
///     G_d(jw) + G_u(jw) H(jw) K (1 - K P)^-1 R,      H = (1 - exp(-jwT)) / (jwT)
/// ```
///
/// # Errors
/// A response that does not exist because of a pole.
pub fn compute_rejections(
    plant: &SampledPlant,
    closed: &ClosedLoop,
    arrangement: Arrangement,
    frequency_hz: &[f64],
) -> Result<Vec<Rejection>, Error> {
    let at = PlantResponse::of(plant, frequency_hz.to_vec())?;
    let K = at.controller(closed)?;
    Ok(rejection_of(plant, &at, K.as_deref(), arrangement).into())
}

fn rejection_of(
    plant: &SampledPlant,
    at: &PlantResponse,
    controller: Option<&[CMat]>,
    arrangement: Arrangement,
) -> [Rejection; 2] {
    let one = |k: usize, input: usize| {
        let (G, rate) = (&at.continuous[k], at.rates_rad_s[k]);
        let Some(K) = controller else { return G[(port::HUB, input)] };
        let tone = control_tone(plant, &K[k], &at.readings[k], &reading_tones(plant, G, input, rate));
        G[(port::HUB, input)] + G[(port::HUB, 0)] * hold_and_delay(plant, rate) * tone
    };
    [(Source::Heave, 1), (Source::Pitch, 2)].map(|(source, input)| Rejection {
        source,
        arrangement,
        response: (0..at.rates_rad_s.len()).map(|k| one(k, input)).collect(),
    })
}

/// Returns what a tone of the platform puts into the readings, without control.
fn reading_tones(plant: &SampledPlant, continuous: &CMat, input: usize, rate: f64) -> Vec<C64> {
    let delays = &plant.delays.readings;
    let late = |i: usize| C64::from_polar(1.0, -rate * plant.sample_period_s * delays[i].samples as f64);
    let sensed = (1..delays.len()).map(|i| continuous[(port::CURRENT + i, input)] * late(i));
    std::iter::once(C64::new(0.0, 0.0)).chain(sensed).collect()
}

/// K (1 - K P)^-1 R for one control.
fn control_tone(plant: &SampledPlant, K: &CMat, P: &CMat, R: &[C64]) -> C64 {
    debug_assert_eq!(R.len(), plant.delays.readings.len());
    let through = |column: &dyn Fn(usize) -> C64| (0..R.len()).map(|i| K[(0, i)] * column(i)).sum::<C64>();
    through(&|i| R[i]) / (C64::new(1.0, 0.0) - through(&|i| P[(i, 0)]))
}

/// Returns the rejection ratios in dB at some frequencies.
///
/// # Errors
/// As [`compute_rejections`].
pub fn rejection_db(
    plant: &SampledPlant,
    closed: &ClosedLoop,
    source: Source,
    frequency_hz: &[f64],
) -> Result<Vec<f64>, Error> {
    let both = compute_rejections(plant, closed, Arrangement::Compensated, frequency_hz)?;
    let one = both.iter().filter(|rejection| rejection.source == source);
    Ok(one.flat_map(|rejection| rejection.response.iter().map(|h| 20.0 * h.norm().log10())).collect())
}
