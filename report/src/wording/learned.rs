//! Free functions that model an unidentified effect, in sentences: what a free function acts on, over which range, and what its curve says.

use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_diagnose::learning::reading::{CurveForm, CurveReading, ReadElement};
use counterpoise_diagnose::learning::visited_ranges::RangeExceedance;
use counterpoise_diagnose::learning::{LearnedModel, LearnedPart};
use counterpoise_models::{LearnedElement, LearnedPlace, LearnedQuantity, RegimeVariable};
use counterpoise_plot::number::short_number;
use serde::Serialize;

use crate::tolerance::NO_READING;

/// Free functions that model an unidentified effect, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnedText {
    /// One sentence on what it explains.
    pub summary: String,
    /// Largest RMS error over its noise floor on held-out data, the model before.
    pub worst_held_out_before: f64,
    /// The same, with the functions fitted to the rest.
    pub worst_held_out_after: f64,
    /// Share of the power of the residual that is left on held-out data.
    pub power_left: f64,
    /// The functions, the one that explains most first.
    pub functions: Vec<LearnedFunctionText>,
    /// Fit of all data with the functions.
    pub after: PooledFits,
}

/// A free function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnedFunctionText {
    /// The component at which it acts.
    pub place: &'static str,
    /// Quantity that it adds to or multiplies.
    pub quantity: &'static str,
    /// Variable of the function.
    pub variable: &'static str,
    /// Unit of the variable.
    pub variable_unit: &'static str,
    /// Unit of the values; empty for a factor.
    pub value_unit: &'static str,
    /// Values of the variable.
    pub points: Vec<f64>,
    /// The function there.
    pub values: Vec<f64>,
    /// Half width of its 95 % band.
    pub half_width: Vec<f64>,
    /// Ends of that band at each point; not part of the JSON.
    #[serde(skip)]
    pub band: Vec<[f64; 2]>,
    /// Share of the recorded samples nearest to each point.
    pub coverage: Vec<f64>,
    /// Interpretation of the curve.
    pub reading: String,
    /// Over which range it is known.
    pub range: String,
}

/// Describes free functions that model an unidentified effect.
pub fn describe_learned(model: &LearnedModel) -> LearnedText {
    let [before, after] = model.worst_held_out;
    LearnedText {
        summary: format!(
            "On held-out data the worst channel falls from {before:.2} to {after:.2} noise floors, and {:.0} % of the residual's power is removed.",
            100.0 * (1.0 - model.power_left).max(0.0)
        ),
        worst_held_out_before: before,
        worst_held_out_after: after,
        power_left: model.power_left,
        functions: model.parts.iter().map(describe_function).collect(),
        after: model.after.clone(),
    }
}

/// Describes the free functions of a mechanism.
pub fn describe_elements(elements: &[ReadElement]) -> Vec<LearnedFunctionText> {
    elements.iter().map(|each| describe_element(&each.element, each.reading.as_ref())).collect()
}

fn describe_function(part: &LearnedPart) -> LearnedFunctionText {
    describe_element(&part.element, part.reading.as_ref())
}

fn describe_element(element: &LearnedElement, reading: Option<&CurveReading>) -> LearnedFunctionText {
    LearnedFunctionText {
        place: place(element.place),
        quantity: quantity(element.quantity),
        variable: variable(element.variable),
        variable_unit: element.variable_unit(),
        value_unit: element.value_unit(),
        points: element.points.clone(),
        values: element.values.clone(),
        half_width: element.half_width.clone(),
        band: element.band(),
        coverage: element.coverage.clone(),
        reading: describe_reading(element, reading),
        range: range(element),
    }
}

/// Describes that a recording leaves the range over which a free function is known.
pub fn describe_beyond(beyond: &RangeExceedance) -> String {
    let range = |[low, high]: [f64; 2]| {
        format!("{} to {}", describe_value(beyond.unit, low), describe_value(beyond.unit, high))
    };
    format!(
        "the free function \"{}\" is known for {} from {} and is flat outside, but the recording goes from {}: {:.1} % of the samples are beyond; \
         diagnose a recording with this range as well",
        beyond.name,
        variable(beyond.variable),
        range(beyond.known),
        range(beyond.reached),
        100.0 * beyond.share
    )
}

fn place(place: LearnedPlace) -> &'static str {
    match place {
        LearnedPlace::Pivot => "pivot",
        LearnedPlace::Motor => "motor",
        LearnedPlace::Gearbox => "gearbox",
        LearnedPlace::LoopSensor => "loop-sensor",
        LearnedPlace::MotorTachometer => "motor-tachometer",
        LearnedPlace::HubResolver => "hub-resolver",
        LearnedPlace::PlatformGyro => "platform-gyro",
        LearnedPlace::PlatformAccelerometer => "platform-accelerometer",
    }
}

fn quantity(quantity: LearnedQuantity) -> &'static str {
    match quantity {
        LearnedQuantity::Torque => "torque",
        LearnedQuantity::FrictionLevel => "friction",
        LearnedQuantity::Stiffness => "stiffness",
        LearnedQuantity::Damping => "damping",
        LearnedQuantity::TorqueConstant => "torque-constant",
        LearnedQuantity::Error => "error",
    }
}

fn variable(variable: RegimeVariable) -> &'static str {
    match variable {
        RegimeVariable::Angle => "angle",
        RegimeVariable::Turn => "turn",
        RegimeVariable::Rate => "rate",
        RegimeVariable::Load => "load",
        RegimeVariable::Control => "control",
        RegimeVariable::Time => "time",
        RegimeVariable::Reading => "reading",
    }
}

/// Returns the name of a sensor in a sentence.
fn sensor(place: LearnedPlace) -> &'static str {
    match place {
        LearnedPlace::MotorTachometer => "motor's tachometer",
        LearnedPlace::HubResolver => "hub's resolver",
        LearnedPlace::PlatformGyro => "platform's gyroscope",
        LearnedPlace::PlatformAccelerometer => "platform's accelerometer",
        _ => "loop's sensor",
    }
}

/// Returns the subject of a sentence about a function.
fn subject(element: &LearnedElement) -> String {
    let at = place(element.place);
    match element.quantity {
        LearnedQuantity::Torque => format!("a torque at the {at}"),
        LearnedQuantity::FrictionLevel => format!("the friction at the {at}"),
        LearnedQuantity::Stiffness => format!("the stiffness at the {at}"),
        LearnedQuantity::Damping => format!("the damping at the {at}"),
        LearnedQuantity::TorqueConstant => "the torque constant".to_owned(),
        LearnedQuantity::Error => format!("the error of the {}", sensor(element.place)),
    }
}

fn range(element: &LearnedElement) -> String {
    let (Some(low), Some(high)) = (element.points.first(), element.points.last()) else {
        return String::new();
    };
    if element.variable == RegimeVariable::Turn {
        return format!("known over the whole turn of the {}", place(element.place));
    }
    let value = |at: f64| describe_value(element.variable_unit(), at);
    let over = variable(element.variable);
    match visited_points(element) {
        Some([first, last]) if first > *low || last < *high => format!(
            "the recordings go for {over} from {} to {}; its simple form is taken to hold for half of that range further, \
             from {} to {}, and is flat beyond",
            value(first),
            value(last),
            value(*low),
            value(*high)
        ),
        _ => format!(
            "known for {over} from {} to {}; flat outside, where the recordings do not go",
            value(*low),
            value(*high)
        ),
    }
}

/// Returns the first and the last point near which recordings have samples; `None` if the coverage is not known.
fn visited_points(element: &LearnedElement) -> Option<[f64; 2]> {
    let mut visited =
        element.points.iter().zip(&element.coverage).filter(|(_, share)| **share > 0.0).map(|(at, _)| *at);
    let first = visited.next()?;
    Some([first, visited.next_back().unwrap_or(first)])
}

/// Returns a value with a unit of its size.
fn describe_value(unit: &str, value: f64) -> String {
    if unit.starts_with("rad") && value.abs() < 0.5 && value != 0.0 {
        return format!("{} m{unit}", short_number(1e3 * value));
    }
    format!("{} {unit}", short_number(value))
}

/// Returns a change of the function, with its interval: in percent for a factor.
fn change(element: &LearnedElement, value: f64, half: f64) -> String {
    if element.quantity.is_factor() {
        return format!(
            "{:.0} % ({:.0} to {:.0} %)",
            100.0 * value,
            100.0 * (value - half),
            100.0 * (value + half)
        );
    }
    let unit = element.value_unit();
    let small = unit.starts_with("rad") && value.abs() + half < 0.5;
    let (factor, prefix) = if small { (1e3, "m") } else { (1.0, "") };
    let [value, low, high] = [value, value - half, value + half].map(|x| short_number(factor * x));
    format!("{value} {prefix}{unit} ({low} to {high})")
}

/// Describes what a curve says, with its numbers and intervals.
pub fn describe_reading(element: &LearnedElement, reading: Option<&CurveReading>) -> String {
    let subject = subject(element);
    let Some(reading) = reading else { return without_form(element, &subject) };
    let sized = |name: &str| (reading.value(name), reading.half_width(name));
    let factor = element.quantity.is_factor();
    match reading.form {
        CurveForm::Constant => {
            let (level, half) = sized("level");
            let off = change(element, level - element.quantity.neutral(), half);
            format!("{subject} is off by {off} wherever the recordings go")
        }
        CurveForm::Linear if factor => describe_proportional(element, &subject, reading),
        CurveForm::Linear => line(element, &subject, reading),
        CurveForm::DeadZone => stops(element, &subject, reading),
        CurveForm::Cubic => cubic(element, &subject, reading),
        CurveForm::Sine => sine(element, &subject, reading),
        CurveForm::Quadratic => {
            let bend = short_number(reading.value("bend"));
            format!(
                "{subject} bends with the square of the {}: {bend} per ({})^2",
                variable(element.variable),
                element.variable_unit()
            )
        }
        CurveForm::DeadBand => dead_band(element, &subject, reading),
        CurveForm::Bump | CurveForm::Sign | CurveForm::Saturation | CurveForm::ExponentialApproach => {
            step(element, &subject, reading)
        }
    }
}

/// Describes a curve that no simple form explains.
fn without_form(element: &LearnedElement, subject: &str) -> String {
    let [low, high] = element.value_range();
    let unit = match element.value_unit() {
        "" => " times its value".to_owned(),
        unit => format!(" {unit}"),
    };
    let over = variable(element.variable);
    format!(
        "{subject} follows the {over} by no simple form, between {} and {}{unit}",
        short_number(low),
        short_number(high)
    )
}

/// Describes a curve that goes from one level to another, or to another and back.
fn step(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let of = |name: &str| change(element, reading.value(name).abs(), reading.half_width(name));
    let rises = |name: &str| if reading.value(name) > 0.0 { "rises" } else { "falls" };
    let at = |name: &str| describe_value(element.variable_unit(), reading.value(name));
    match reading.form {
        CurveForm::Sign => format!(
            "{subject} changes its sign with the {}: {} either way",
            variable(element.variable),
            of("step")
        ),
        CurveForm::Saturation => format!(
            "{subject} {} by {} within {} of {}, and stays there",
            rises("rise"),
            of("rise"),
            at("width"),
            at("centre")
        ),
        CurveForm::ExponentialApproach => format!(
            "{subject} {} by {} with a constant of {} +- {} {}",
            rises("rise"),
            of("rise"),
            short_number(reading.value("constant")),
            short_number(reading.half_width("constant")),
            element.variable_unit()
        ),
        _ => format!(
            "{subject} {} by {} within {} of {}{}",
            rises("height"),
            of("height"),
            at("width"),
            at("centre"),
            spot(element, reading.value("height"))
        ),
    }
}

/// Describes a factor that changes in proportion to its variable.
fn describe_proportional(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let [size, half_width] = reading.change_over(element);
    let rises = if reading.value("slope") > 0.0 { "rises" } else { "falls" };
    let by = change(element, size, half_width);
    format!("{subject} {rises} evenly with the {}, by {by} over its range", variable(element.variable))
}

/// Returns what a bump is called where engineers have a word for it.
fn spot(element: &LearnedElement, height: f64) -> &'static str {
    match (element.quantity, height > 0.0) {
        (LearnedQuantity::FrictionLevel, true) => ": a tight spot",
        (LearnedQuantity::FrictionLevel, false) => ": a loose spot",
        _ => "",
    }
}

fn line(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let (slope, half_width) = (reading.value("slope"), reading.half_width("slope"));
    let size = format!(
        "{} {} per {} ({} to {})",
        short_number(slope.abs()),
        element.value_unit(),
        element.variable_unit(),
        short_number(slope.abs() - half_width),
        short_number(slope.abs() + half_width)
    );
    match (element.variable, slope > 0.0) {
        (RegimeVariable::Angle, true) if !element.place.is_sensor() => {
            format!("{subject} pushes away from its middle as a spring of negative stiffness does: {size}")
        }
        (RegimeVariable::Angle, false) if !element.place.is_sensor() => {
            format!("{subject} acts as a spring: {size}")
        }
        (RegimeVariable::Rate, false) => format!("{subject} acts as viscous friction: {size}"),
        _ => format!("{subject} is proportional to the {}: {size}", variable(element.variable)),
    }
}

fn stops(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let (slope, over) = (reading.value("slope"), variable(element.variable));
    if element.quantity == LearnedQuantity::Error && element.variable == RegimeVariable::Reading {
        return saturation(element, reading);
    }
    let hard = slope < 0.0
        && element.variable == RegimeVariable::Angle
        && element.quantity == LearnedQuantity::Torque;
    format!(
        "{subject} sets in beyond {} of {over} to either side, with {} +- {} per {}{}",
        describe_value(element.variable_unit(), reading.value("distance")),
        short_number(slope),
        short_number(reading.half_width("slope")),
        element.variable_unit(),
        if hard { ": soft stops" } else { "" }
    )
}

/// Describes an error of a sensor that sets in beyond a reading.
fn saturation(element: &LearnedElement, reading: &CurveReading) -> String {
    let name = sensor(element.place);
    let distance = describe_distance(element, reading);
    let gain = short_number(100.0 * (1.0 + reading.value("slope")));
    match saturates(reading) {
        true => format!("the {name} saturates at {distance}: beyond it the reading stands still"),
        false => format!("beyond {distance} to either side the {name} shows {gain} % of what goes on"),
    }
}

/// Describes an error of a sensor within a band about zero.
fn dead_band(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let distance = describe_distance(element, reading);
    if element.quantity != LearnedQuantity::Error || element.variable != RegimeVariable::Reading {
        let slope = short_number(reading.value("slope"));
        let (over, unit) = (variable(element.variable), element.variable_unit());
        return format!(
            "{subject} grows with the {over} up to {distance} to either side, with {slope} per {unit}, and stays there"
        );
    }
    let name = sensor(element.place);
    let gain = short_number(100.0 * (1.0 + reading.value("slope")));
    match saturates(reading) {
        true => format!(
            "the {name} has a dead band of {distance} to either side: within it the reading is 0, beyond it it lacks as much"
        ),
        false => format!("within {distance} to either side the {name} shows {gain} % of what it measures"),
    }
}

/// Returns the distance of a form from zero with its interval.
fn describe_distance(element: &LearnedElement, reading: &CurveReading) -> String {
    let unit = element.variable_unit();
    let small = unit.starts_with("rad") && reading.value("distance") < 0.5;
    let (factor, prefix) = if small { (1e3, "m") } else { (1.0, "") };
    let [low, high] = reading.interval("distance").map(|x| short_number(factor * x));
    format!("{} {prefix}{unit} ({low} to {high})", short_number(factor * reading.value("distance")))
}

/// Returns whether an error takes all of what is measured where it sets in.
fn saturates(reading: &CurveReading) -> bool {
    (reading.value("slope") + 1.0).abs() < NO_READING
}

fn cubic(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let (slope, cube) = (reading.value("slope"), reading.value("cubic"));
    let what = match (element.quantity, element.variable, cube < 0.0) {
        (LearnedQuantity::Torque, RegimeVariable::Angle, true) => ": a spring that hardens",
        (LearnedQuantity::Torque, RegimeVariable::Rate, true) => {
            ": drag that grows with the cube of the rate"
        }
        _ => "",
    };
    let unit = element.variable_unit();
    format!(
        "{subject} is {} x + {} x^3 ({} to {}), x in {unit}{what}",
        short_number(slope),
        short_number(cube),
        short_number(reading.interval("cubic")[0]),
        short_number(reading.interval("cubic")[1])
    )
}

fn sine(element: &LearnedElement, subject: &str, reading: &CurveReading) -> String {
    let amplitude = change(element, reading.value("amplitude"), reading.half_width("amplitude"));
    let (order, half) = (reading.value("order"), reading.half_width("order"));
    match element.variable {
        RegimeVariable::Time => format!(
            "{subject} swings by {amplitude} at {} +- {} Hz",
            short_number(order / std::f64::consts::TAU),
            short_number(half / std::f64::consts::TAU)
        ),
        RegimeVariable::Angle | RegimeVariable::Turn => format!(
            "{subject} repeats {} +- {} times a turn, with an amplitude of {amplitude}",
            short_number(order),
            short_number(half)
        ),
        _ => format!(
            "{subject} repeats every {} of the {}, with an amplitude of {amplitude}",
            describe_value(element.variable_unit(), std::f64::consts::TAU / order),
            variable(element.variable)
        ),
    }
}
