//! The free functions of a plant as C writes them.

use counterpoise_models::plant::sensor_errors::SensorError;
use counterpoise_models::plant::{LearnedFunction, LearnedFunctions, LearnedTable, Plant, SensorErrors};
use counterpoise_models::{LearnedPlace, LearnedQuantity, RegimeVariable};

use super::machine::{list, number};

/// Returns the free functions: their tables, what they follow, and what they add at each place.
pub(crate) fn functions(plant: &Plant) -> Vec<minijinja::Value> {
    plant
        .learned_functions()
        .into_iter()
        .flat_map(LearnedFunctions::iter)
        .enumerate()
        .map(|(index, one)| function(index, one))
        .collect()
}

/// Returns the errors of the sensors, numbered on from the free functions of the mechanism: their tables, what they follow, and the index of
/// the sensor as the unit numbers them.
pub(crate) fn sensor_errors(plant: &Plant) -> Vec<minijinja::Value> {
    let first = plant.learned_functions().map_or(0, |functions| functions.iter().count());
    let of = |(sensor, place): (usize, LearnedPlace)| {
        let errors = SensorErrors::of(plant.parameters(), place);
        errors.iter().flat_map(SensorErrors::iter).map(|error| (sensor, error.clone())).collect::<Vec<_>>()
    };
    let all = SENSORS.into_iter().enumerate().flat_map(of);
    all.enumerate().map(|(k, (sensor, error))| sensor_error(first + k, sensor, &error)).collect()
}

/// The sensors in the order in which the unit numbers them.
const SENSORS: [LearnedPlace; 5] = [
    LearnedPlace::LoopSensor,
    LearnedPlace::PlatformGyro,
    LearnedPlace::PlatformAccelerometer,
    LearnedPlace::MotorTachometer,
    LearnedPlace::HubResolver,
];

fn sensor_error(index: usize, sensor: usize, error: &SensorError) -> minijinja::Value {
    let variable = match error.variable {
        RegimeVariable::Angle | RegimeVariable::Turn => "angle",
        RegimeVariable::Time => "s->time",
        _ => "clean",
    };
    minijinja::context! { index, sensor, variable, table => table_of(&error.table) }
}

fn table_of(table: &LearnedTable) -> minijinja::Value {
    let constant = [[table.last_value(), 0.0, 0.0, 0.0]];
    let powers = if table.powers().is_empty() { &constant[..] } else { table.powers() };
    let rows: Vec<String> = powers.iter().map(|row| list(row)).collect();
    minijinja::context! {
        points => list(table.points()),
        count => table.points().len(),
        rows,
        pieces => powers.len(),
        last => number(table.last_value()),
        period => number(table.period().unwrap_or(0.0)),
    }
}

fn function(index: usize, function: &LearnedFunction) -> minijinja::Value {
    minijinja::context! {
        index,
        table => table_of(&function.table),
        variable => variable(function),
        friction => friction(function),
        torque => torque(function),
        place => match function.place {
            LearnedPlace::Pivot => "pivot",
            LearnedPlace::Motor => "motor",
            _ => "gearbox",
        },
    }
}

/// Returns what a function follows, of the motion `v` at a time with a drive in volts.
fn variable(function: &LearnedFunction) -> &'static str {
    match (function.variable, function.place) {
        (RegimeVariable::Angle | RegimeVariable::Turn, LearnedPlace::Motor) => "v->angle[0]",
        (RegimeVariable::Angle | RegimeVariable::Turn, LearnedPlace::Pivot) => "v->angle[1]",
        (RegimeVariable::Angle | RegimeVariable::Turn, _) => "(v->angle[0] / m.ratio) - v->angle[1]",
        (RegimeVariable::Rate, LearnedPlace::Motor) => "v->rate[0]",
        (RegimeVariable::Rate, LearnedPlace::Pivot) => "v->rate[1]",
        (RegimeVariable::Rate, _) => "(v->rate[0] / m.ratio) - v->rate[1]",
        (RegimeVariable::Load, LearnedPlace::Motor) => "v->mesh / m.ratio",
        (RegimeVariable::Load, _) => "v->mesh",
        (RegimeVariable::Control, _) => "at->volts",
        (RegimeVariable::Time | RegimeVariable::Reading, _) => "time",
    }
}

/// Returns the joint whose level of dry friction a function multiplies; `None` if it adds a torque.
fn friction(function: &LearnedFunction) -> Option<usize> {
    let joint = usize::from(function.place == LearnedPlace::Pivot);
    (function.quantity == LearnedQuantity::FrictionLevel).then_some(joint)
}

/// Returns the torque that a function's `value` stands for.
fn torque(function: &LearnedFunction) -> &'static str {
    match (function.quantity, function.place) {
        (LearnedQuantity::Torque, _) => "value",
        (LearnedQuantity::FrictionLevel | LearnedQuantity::Error, _) => "0.0",
        (LearnedQuantity::Stiffness, LearnedPlace::Gearbox) => "(value - 1.0) * (v->mesh - damper)",
        (LearnedQuantity::Stiffness, _) => "(1.0 - value) * m.spring * (v->angle[1] - m.spring_centre)",
        (LearnedQuantity::Damping, LearnedPlace::Gearbox) => "(value - 1.0) * damper",
        (LearnedQuantity::Damping, LearnedPlace::Motor) => "(1.0 - value) * joints[0].viscous * v->rate[0]",
        (LearnedQuantity::Damping, _) => "(1.0 - value) * joints[1].viscous * v->rate[1]",
        (LearnedQuantity::TorqueConstant, _) => {
            "(value - 1.0) * m.torque_constant * current * (1.0 + ripple_at(&m.torque_ripple, v->angle[0]))"
        }
    }
}
