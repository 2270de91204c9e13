//! Free functions: `[[plant.learned]]`, a table over one regime variable at one component.

use counterpoise_models::{
    AxisKind, FeedbackSignal, Interpolation, LearnedElement, LearnedPlace, LearnedQuantity, Parameters,
    RegimeVariable,
};

use super::axis_words::Words;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Visit, choose, list};

impl NamedChoice for LearnedPlace {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("pivot", Self::Pivot),
        ("motor", Self::Motor),
        ("gearbox", Self::Gearbox),
        ("loop-sensor", Self::LoopSensor),
        ("motor-tachometer", Self::MotorTachometer),
        ("hub-resolver", Self::HubResolver),
        ("platform-gyro", Self::PlatformGyro),
        ("platform-accelerometer", Self::PlatformAccelerometer),
    ];
}

impl NamedChoice for LearnedQuantity {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("torque", Self::Torque),
        ("friction", Self::FrictionLevel),
        ("stiffness", Self::Stiffness),
        ("damping", Self::Damping),
        ("torque-constant", Self::TorqueConstant),
        ("error", Self::Error),
    ];
}

impl NamedChoice for RegimeVariable {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("angle", Self::Angle),
        ("turn", Self::Turn),
        ("rate", Self::Rate),
        ("load", Self::Load),
        ("control", Self::Control),
        ("time", Self::Time),
        ("reading", Self::Reading),
    ];
}

impl NamedChoice for Interpolation {
    const NAMES: &'static [(&'static str, Self)] = &[("cubic", Self::Cubic), ("linear", Self::Linear)];
}

const SECTION: TableField = TableField::optional(
    "learned",
    "a free function of one regime variable at a component, beside the laws of the library",
);
const NAME: Field = Field::new("name", "name of the function").or_text("");
const PLACE: Field = Field::new("place", "component at which it acts: a part of the machine, or a sensor")
    .or_text("pivot")
    .show_default();
const QUANTITY: Field = Field::new(
    "quantity",
    "what it is: an added torque, a factor on dry friction, stiffness, damping or torque constant, or an error that is added to the reading of a sensor",
)
.or_text("torque")
.show_default();
const VARIABLE: Field =
    Field::new("variable", "what it is a function of, at its place").or_text("angle").show_default();
const INTERPOLATION: Field = Field::new("interpolation", "how it goes from point to point").or_text("cubic");
const POINTS: Field = Field::new(
    "points",
    "values of the variable, rising, in its SI unit (rad, rad/s, N m, V, s, or that of a sensor); beyond them the end values hold",
);
const VALUES: Field = Field::new(
    "values",
    "values at the points: N m for a torque (at the motor on its shaft), the sensor's unit for an error, else factors",
);
const HALF_WIDTH: Field = Field::new("half_width", "half width of the 95 % band at each point").or_empty();
const COVERAGE: Field = Field::new("coverage", "share of the recorded samples nearest to each point")
    .limit(NumberRange::AtLeast(0.0))
    .or_empty();

/// Reads or lists the free functions.
pub(super) fn learned_functions(v: &mut dyn Visit, plant: &mut Parameters) {
    let (axis, gearbox, sensors) = (plant.axis, plant.gearbox.clone(), plant.sensors.clone());
    list(v, &SECTION, &mut plant.learned, LearnedElement::default(), |v, element| {
        function(v, axis, sensors.measured, element);
        if element.points.iter().chain(&element.values).any(|number| number.is_nan()) {
            return; // a number that could not be read is reported already
        }
        if let Some(refusal) = element.refusal(&gearbox, &sensors) {
            let key = refusal.key.split('[').next().unwrap_or_default();
            let allowed = match refusal.key.split_once('[') {
                Some((_, index)) => format!("{}: entry [{index} is {}", refusal.allowed, refusal.value),
                None => refusal.allowed.to_owned(),
            };
            v.complain(key, &allowed, None);
        }
    });
}

fn function(v: &mut dyn Visit, axis: AxisKind, measured: FeedbackSignal, element: &mut LearnedElement) {
    v.text(&NAME, &mut element.name);
    choose(v, &PLACE, &mut element.place);
    if element.place == LearnedPlace::LoopSensor {
        element.measured = measured;
    }
    choose(v, &QUANTITY, &mut element.quantity);
    choose(v, &VARIABLE, &mut element.variable);
    choose(v, &INTERPOLATION, &mut element.interpolation);
    let turns = matches!(element.place, LearnedPlace::Motor | LearnedPlace::MotorTachometer);
    let value_unit = element.value_unit();
    let variable_unit = element.variable_unit();
    let words = &mut Words::of(if turns { AxisKind::Rotary } else { axis }, v);
    words.numbers(&POINTS.unit(variable_unit), Count::AtLeastOne, &mut element.points);
    words.numbers(&VALUES.unit(value_unit), Count::AtLeastOne, &mut element.values);
    words.numbers(
        &HALF_WIDTH.unit(value_unit).limit(NumberRange::AtLeast(0.0)),
        Count::AtLeastOne,
        &mut element.half_width,
    );
    words.numbers(&COVERAGE, Count::AtLeastOne, &mut element.coverage);
}
