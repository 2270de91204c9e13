//! Frequency responses of a design ready to be drawn: plants, weights, and the controllers of every state of balance.

use counterpoise_linalg::C64;
use counterpoise_lti::{Response, StateSpace};
use counterpoise_models::plant::LinearPlant;
use counterpoise_synth::{Design, DisturbanceChannel, ScheduleEntry, Specification, Weight};
use ndarray::Array2;

use crate::frequencies::logarithmic_hz;
use crate::{PipelineError, PlantModel, ReducedPlant, SynthesisedDesign};

/// A frequency response, as a plane and as a Bode diagram show it.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Whose response it is.
    pub name: String,
    /// One row a frequency, columns frequency in Hz, real part and imaginary part.
    pub points: Array2<f64>,
}

impl FrequencyResponse {
    /// Returns a response from its points: frequency in Hz, real part and imaginary part, by rising frequency.
    pub fn new(name: &str, points: Vec<[f64; 3]>) -> Self {
        Self { name: name.to_owned(), points: Array2::from(points) }
    }

    /// Returns the response of a system at frequencies in Hz.
    pub fn of(name: &str, frequency_hz: &[f64], response: &[C64]) -> Self {
        Self::new(name, frequency_hz.iter().zip(response).map(|(hz, h)| [*hz, h.re, h.im]).collect())
    }

    /// Returns frequency in Hz and magnitude in dB.
    pub fn magnitude_db(&self) -> Vec<[f64; 2]> {
        let points = self.points.rows().into_iter();
        points.map(|row| [row[0], 20.0 * row[1].hypot(row[2]).log10()]).collect()
    }

    /// Returns frequency in Hz and phase in degrees, without jumps of a whole turn; it starts between -270 and 90 degrees.
    pub fn phase_deg(&self) -> Vec<[f64; 2]> {
        let mut before: Option<f64> = None;
        let mut unwrapped = |re: f64, im: f64| {
            let raw = im.atan2(re).to_degrees();
            let start = if raw > 90.0 { raw - 360.0 } else { raw };
            let phase = before.map_or(start, |last| raw + 360.0 * ((last - raw) / 360.0).round());
            before = Some(phase);
            phase
        };
        self.points.rows().into_iter().map(|row| [row[0], unwrapped(row[1], row[2])]).collect()
    }
}

/// Hub rate for one input of the plant, before and after the reduction.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantResponse {
    /// The input.
    pub input: &'static str,
    /// The plant as it was modelled.
    pub full: FrequencyResponse,
    /// The plant that the design took.
    pub reduced: FrequencyResponse,
}

/// The weights of one part of the design.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightResponses {
    /// The part, for example `Feedback`.
    pub part: &'static str,
    /// Its weights.
    pub curves: Vec<FrequencyResponse>,
}

/// One controller over the states of balance.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerFamily {
    /// The controller, for example `Feedback`.
    pub name: &'static str,
    /// Unit of its gain.
    pub unit: &'static str,
    /// One curve a state of balance.
    pub curves: Vec<FrequencyResponse>,
}

/// The frequency responses of a design.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DesignViews {
    /// Hub rate for control, heave and pitch rate.
    pub plants: Vec<PlantResponse>,
    /// The weights.
    pub weights: Vec<WeightResponses>,
    /// Each controller over the states of balance; none without a schedule.
    pub families: Vec<ControllerFamily>,
}

/// Frequencies of plants and weights: points, lowest and highest, Hz.
const WIDE: Grid = Grid { points: 500, lowest_hz: 0.02, highest_hz: 500.0 };
/// Frequencies of the controllers over the states of balance.
const CONTROL_BAND: Grid = Grid { points: 200, lowest_hz: 0.1, highest_hz: 20.0 };

/// Frequencies in equal ratios.
struct Grid {
    points: usize,
    lowest_hz: f64,
    highest_hz: f64,
}

impl Grid {
    fn frequencies_hz(&self) -> Vec<f64> {
        logarithmic_hz([self.lowest_hz, self.highest_hz], self.points)
    }
}

/// Returns the frequency responses of a design.
///
/// # Errors
/// A frequency response that does not exist.
pub fn design_views(
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    made: &SynthesisedDesign,
) -> Result<DesignViews, PipelineError> {
    Ok(DesignViews {
        plants: plant_responses(modelled, reduced)?,
        weights: weight_responses(&made.design.specification),
        families: controller_families(&made.balance)?,
    })
}

fn plant_responses(
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> Result<Vec<PlantResponse>, PipelineError> {
    let (full, small) = (&modelled.linear.system, &reduced.system);
    let inputs = [
        (LinearPlant::CONTROL, "control"),
        (LinearPlant::HEAVE, "heave"),
        (LinearPlant::PITCH_RATE, "pitch rate"),
    ];
    let one = |(input, name): (usize, &'static str)| {
        Ok(PlantResponse {
            input: name,
            full: response(
                &format!("full plant, order {}", full.order()),
                full,
                LinearPlant::HUB_RATE,
                input,
                &WIDE,
            )?,
            reduced: response(
                &format!("design plant, order {}", small.order()),
                small,
                LinearPlant::HUB_RATE,
                input,
                &WIDE,
            )?,
        })
    };
    inputs.into_iter().map(one).collect()
}

fn response(
    name: &str,
    system: &StateSpace,
    output: usize,
    input: usize,
    grid: &Grid,
) -> Result<FrequencyResponse, PipelineError> {
    let hz = grid.frequencies_hz();
    let rates: Vec<f64> = hz.iter().map(|f| std::f64::consts::TAU * f).collect();
    let all = Response::of(system)?.at_all(&rates)?;
    let points: Vec<[f64; 3]> =
        hz.iter().zip(&all).map(|(f, h)| [*f, h[(output, input)].re, h[(output, input)].im]).collect();
    Ok(FrequencyResponse::new(name, points))
}

/// Returns the responses of the weights of a specification.
pub fn weight_responses(asked: &Specification) -> Vec<WeightResponses> {
    let named = |name, weight| NamedWeight { name, weight };
    let feedback = [named("error", &asked.feedback.error), named("control", &asked.feedback.control)];
    let mut all = vec![weights_of("Feedback", &feedback)];
    for (part, weights) in [("Heave feedforward", &asked.heave), ("Pitch feedforward", &asked.pitch)] {
        all.extend(weights.as_ref().map(|w| {
            let weights =
                [named("error", &w.error), named("control", &w.control), named("disturbance", &w.generator)];
            weights_of(part, &weights)
        }));
    }
    all
}

/// A weight with its part in the design problem.
struct NamedWeight<'a> {
    name: &'a str,
    weight: &'a Weight,
}

fn weights_of(part: &'static str, weights: &[NamedWeight<'_>]) -> WeightResponses {
    let one = |NamedWeight { name, weight }: &NamedWeight<'_>| {
        let value = |f: f64| {
            let h = weight.response(std::f64::consts::TAU * f);
            [f, h.re, h.im]
        };
        let points: Vec<[f64; 3]> = WIDE.frequencies_hz().into_iter().map(value).collect();
        FrequencyResponse::new(name, points)
    };
    WeightResponses { part, curves: weights.iter().map(one).collect() }
}

/// A controller taken from a design; `None` if the design has none of its kind.
type ControllerSelector = fn(&Design) -> Option<StateSpace>;

fn controller_families(balance: &[ScheduleEntry]) -> Result<Vec<ControllerFamily>, PipelineError> {
    if balance.len() < 2 {
        return Ok(Vec::new());
    }
    let kinds: [(&'static str, &'static str, usize, ControllerSelector); 3] = [
        ("Feedback", "V s/rad", 1, |d| Some(d.feedback_controller())),
        ("Heave feedforward", "V s^2/m", 0, |d| d.feedforward_controller(DisturbanceChannel::Heave)),
        ("Pitch feedforward", "V s/rad", 0, |d| d.feedforward_controller(DisturbanceChannel::Pitch)),
    ];
    let mut all = Vec::new();
    for (name, unit, input, of) in kinds {
        let systems: Option<Vec<(&str, StateSpace)>> =
            balance.iter().map(|entry| Some((entry.name.as_str(), of(&entry.design)?))).collect();
        let Some(systems) = systems else { continue };
        let curve = |(state, system): &(&str, StateSpace)| response(state, system, 0, input, &CONTROL_BAND);
        let curves = systems.iter().map(curve).collect::<Result<Vec<_>, _>>()?;
        all.push(ControllerFamily { name, unit, curves });
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_integrators_end_at_minus_270_degrees_without_a_jump() {
        let lag = |f: f64| {
            // 1 / (1 + jf)^3
            let angle = -3.0 * f.atan();
            let size = (1.0 + f * f).powf(-1.5);
            [f, size * angle.cos(), size * angle.sin()]
        };
        let points = (0..200).map(|k| lag(10f64.powf(-2.0 + 0.025 * f64::from(k)))).collect();
        let response = FrequencyResponse::new("lag", points);
        let phase = response.phase_deg();
        assert!(phase.windows(2).all(|pair| (pair[1][1] - pair[0][1]).abs() < 20.0));
        assert!((phase[199][1] + 270.0).abs() < 2.0, "{:?}", phase[199]);
        assert!(response.magnitude_db()[0][1].abs() < 0.01);
    }
}
