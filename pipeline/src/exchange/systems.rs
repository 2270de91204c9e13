//! Linear systems, transfer functions and frequency responses as plain data.

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Response, StateSpace, Timebase};
use counterpoise_models::{ControlledQuantity, LinearPlant};
use counterpoise_synth::{Design, DisturbanceChannel, Weight};
use serde::Serialize;

/// A signal by its name and unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SignalResult {
    /// Name.
    pub name: String,
    /// Unit; empty for a pure number and for a state without meaning of its own.
    pub unit: &'static str,
}

/// A linear system.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct SystemResult {
    /// Name.
    pub name: String,
    /// Sample time, s; 0 in continuous time.
    pub sample_time_s: f64,
    /// State matrix, a list of rows.
    pub A: Vec<Vec<f64>>,
    /// Input matrix.
    pub B: Vec<Vec<f64>>,
    /// Output matrix.
    pub C: Vec<Vec<f64>>,
    /// Direct path.
    pub D: Vec<Vec<f64>>,
    /// States.
    pub states: Vec<SignalResult>,
    /// Inputs.
    pub inputs: Vec<SignalResult>,
    /// Outputs.
    pub outputs: Vec<SignalResult>,
}

/// A transfer function of s with one input and one output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransferFunctionResult {
    /// Name, for example `feedback.error`.
    pub name: String,
    /// Coefficients of the numerator, highest power of s first.
    pub numerator: Vec<f64>,
    /// Coefficients of the denominator, highest power of s first.
    pub denominator: Vec<f64>,
    /// Zeros, rad/s.
    pub zeros: Vec<[f64; 2]>,
    /// Poles, rad/s.
    pub poles: Vec<[f64; 2]>,
    /// Factor before the products of (s - zero) and (s - pole).
    pub gain: f64,
}

/// A frequency response.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseResult {
    /// Name.
    pub name: String,
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Real parts.
    pub real: Vec<f64>,
    /// Imaginary parts.
    pub imaginary: Vec<f64>,
}

/// Endings of names that carry a unit, longest first.
const UNITS: [(&str, &str); 12] = [
    ("_nm_s_rad", "N m s/rad"),
    ("_m_s2", "m/s^2"),
    ("_rad_s", "rad/s"),
    ("_kg_m", "kg m"),
    ("_rad", "rad"),
    ("_mpa", "MPa"),
    ("_m_s", "m/s"),
    ("_nm", "N m"),
    ("_v", "V"),
    ("_a", "A"),
    ("_n", "N"),
    ("_m", "m"),
];

impl SignalResult {
    /// Returns a signal whose name ends in its unit, for example `hub_rate_rad_s`.
    pub fn of(name: &str) -> Self {
        let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending)).map_or("", |(_, unit)| unit);
        Self { name: name.to_owned(), unit }
    }

    /// Returns signals whose names end in their units.
    pub fn all<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<Self> {
        names.into_iter().map(Self::of).collect()
    }

    /// Returns the states x1, x2, ... of a system whose states have no meaning of their own.
    pub fn numbered_states(count: usize) -> Vec<Self> {
        Self::numbered_beyond(&[], "x", count)
    }

    /// Returns as many signals as a system has: those with a name, then numbered ones.
    fn numbered_beyond(names: &[&str], letter: &str, count: usize) -> Vec<Self> {
        let numbered = |k| Self { name: format!("{letter}{k}"), unit: "" };
        let named = names.iter().take(count).map(|name| Self::of(name));
        named.chain((names.len() + 1..=count).map(numbered)).collect()
    }
}

/// The signals of a design plant by name.
#[derive(Debug, Clone, Copy)]
pub struct DesignSignals<'a> {
    /// The quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// The plant's outputs.
    pub outputs: &'a [String],
}

impl SystemResult {
    /// Returns a design plant behind its sensor: the measured quantity, then every output.
    pub fn of_design_plant(system: &StateSpace, signals: DesignSignals) -> Self {
        let measured = signals.controlled.named_signal("measured_rate_rad_s");
        let outputs = std::iter::once(measured.as_str()).chain(signals.outputs.iter().map(String::as_str));
        Self::new("design plant", system, &LinearPlant::INPUTS, &outputs.collect::<Vec<_>>())
    }

    /// Returns the sampled plant of a feedback loop, from the control to the reading.
    pub fn of_plant(plant: &StateSpace, controlled: ControlledQuantity) -> Self {
        Self::new("plant", plant, &["control_v"], &["reading_of_hub_rate_rad_s"]).of_loop(controlled)
    }

    /// Returns the sampled feedback of a loop, from the error to the control.
    pub fn of_feedback(name: &str, feedback: &StateSpace, controlled: ControlledQuantity) -> Self {
        Self::new(name, feedback, &["rate_error_rad_s"], &["control_v"]).of_loop(controlled)
    }

    /// Returns a system with numbered states; `inputs` and `outputs` are names that end in their units. Signals beyond those that have a name
    /// are numbered: u1, u2, ... and y1, y2, ...
    pub fn new(name: &str, system: &StateSpace, inputs: &[&str], outputs: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            sample_time_s: match system.timebase {
                Timebase::Continuous => 0.0,
                Timebase::Discrete { period_s } => period_s,
            },
            A: rows(&system.A),
            B: rows(&system.B),
            C: rows(&system.C),
            D: rows(&system.D),
            states: SignalResult::numbered_states(system.order()),
            inputs: SignalResult::numbered_beyond(inputs, "u", system.inputs()),
            outputs: SignalResult::numbered_beyond(outputs, "y", system.outputs()),
        }
    }

    /// Returns the same system with the signals of a loop of rate under their names in the loop of another quantity.
    pub fn of_loop(mut self, controlled: ControlledQuantity) -> Self {
        for signal in self.inputs.iter_mut().chain(&mut self.outputs) {
            let (reading, name) = match signal.name.strip_prefix("reading_of_") {
                Some(name) => ("reading_of_", name),
                None => ("", signal.name.as_str()),
            };
            *signal = SignalResult::of(&format!("{reading}{}", controlled.named_signal(name)));
        }
        self
    }

    /// Returns the same system with signals that are pure numbers.
    pub fn without_units(mut self) -> Self {
        self.inputs.iter_mut().chain(&mut self.outputs).for_each(|signal| signal.unit = "");
        self
    }

    /// Returns the same system with states by name.
    pub fn with_states<'a>(self, names: impl IntoIterator<Item = &'a str>) -> Self {
        Self { states: SignalResult::all(names), ..self }
    }
}

fn rows(matrix: &Mat) -> Vec<Vec<f64>> {
    (0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect()).collect()
}

impl TransferFunctionResult {
    /// Returns a weight as a transfer function.
    pub fn of(name: &str, weight: &Weight) -> Self {
        let rational = weight.rational();
        let numerator = expand_roots(&rational.zeros).iter().map(|c| rational.gain * c).collect();
        let pair = |root: &C64| [root.re, root.im];
        Self {
            name: name.to_owned(),
            numerator,
            denominator: expand_roots(&rational.poles),
            zeros: rational.zeros.iter().map(pair).collect(),
            poles: rational.poles.iter().map(pair).collect(),
            gain: rational.gain,
        }
    }
}

/// Returns the monic polynomial with the given roots, highest power first; roots come in conjugate pairs.
fn expand_roots(roots: &[C64]) -> Vec<f64> {
    let mut all = vec![C64::new(1.0, 0.0)];
    for root in roots {
        let mut next = all.clone();
        next.push(C64::new(0.0, 0.0));
        for (k, coefficient) in all.iter().enumerate() {
            next[k + 1] -= coefficient * root;
        }
        all = next;
    }
    all.iter().map(|coefficient| coefficient.re).collect()
}

impl ResponseResult {
    /// Returns a response from its values.
    pub fn new(name: &str, frequency_hz: &[f64], values: &[C64]) -> Self {
        Self {
            name: name.to_owned(),
            frequency_hz: frequency_hz.to_vec(),
            real: values.iter().map(|h| h.re).collect(),
            imaginary: values.iter().map(|h| h.im).collect(),
        }
    }

    /// Returns the response of one element of a system; `None` if it does not exist at one of the frequencies.
    pub fn of_system(
        name: &str,
        system: &StateSpace,
        output: usize,
        input: usize,
        frequency_hz: &[f64],
    ) -> Option<Self> {
        let rates: Vec<f64> = frequency_hz.iter().map(|f| std::f64::consts::TAU * f).collect();
        let values = Response::of(system).ok()?.at_all(&rates).ok()?;
        let values: Vec<C64> = values.iter().map(|h| h[(output, input)]).collect();
        Some(Self::new(name, frequency_hz, &values))
    }
}

/// Returns frequencies of the stored responses, Hz: 200 in equal ratios from 0.02 to 500.
pub fn stored_frequencies_hz() -> Vec<f64> {
    crate::frequencies::logarithmic_hz([0.02, 500.0], 200)
}

/// A controller as it is stored, and its system.
pub(crate) struct StoredController {
    /// Stored result.
    pub result: SystemResult,
    /// The system.
    pub system: StateSpace,
}

/// Returns the controllers of a design in continuous time.
pub(crate) fn controllers_of_design(
    design: &Design,
    controlled: ControlledQuantity,
) -> Vec<StoredController> {
    let feedback = design.feedback_controller();
    let inputs: &[&str] =
        if feedback.inputs() == 2 { &["demand_rad_s", "hub_rate_rad_s"] } else { &["rate_error_rad_s"] };
    let stored = |name: &str, system: StateSpace, inputs: &[&str]| {
        let result = SystemResult::new(name, &system, inputs, &["control_v"]).of_loop(controlled);
        StoredController { result, system }
    };
    let mut all = vec![stored("feedback", feedback.clone(), inputs)];
    for (channel, name, input) in [
        (DisturbanceChannel::Heave, "heave", "platform_accel_m_s2"),
        (DisturbanceChannel::Pitch, "pitch", "platform_rate_rad_s"),
    ] {
        all.extend(design.feedforward_controller(channel).map(|system| stored(name, system, &[input])));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_take_their_unit_from_their_name() {
        let units: Vec<&str> = ["hub_rate_rad_s", "heave_m_s2", "control_v", "x1", "twist_rad"]
            .map(|name| SignalResult::of(name).unit)
            .into();
        assert_eq!(units, ["rad/s", "m/s^2", "V", "", "rad"]);
    }

    #[test]
    fn a_weight_is_the_same_expanded_and_by_its_roots() {
        let weight = Weight::Quadratic { gain: 3.0, second_s2: 0.25, first_s: 0.4 };
        let found = TransferFunctionResult::of("w", &weight);
        let s = C64::new(0.0, 7.0);
        let at = |coefficients: &[f64]| coefficients.iter().fold(C64::new(0.0, 0.0), |sum, c| sum * s + c);
        let value = at(&found.numerator) / at(&found.denominator);
        assert!((value - weight.response(7.0)).norm() < 1e-12 * value.norm());
    }
}
