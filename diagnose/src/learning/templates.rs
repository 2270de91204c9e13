//! The free functions that are tried: at which place, of what, over which variable, with which points.

use std::f64::consts::TAU;

use counterpoise_models::{
    Interpolation, LearnedElement, LearnedPlace, LearnedQuantity, Parameters, RegimeVariable,
};

use crate::learning::reading::{FittedForm, nearest_forms};
use crate::learning::visited_ranges::VisitedRanges;
use crate::library::{Component, Effect, component_of, make_learned_effect};
use crate::localisation::error_hypotheses::Regime;
use crate::localisation::error_map::MapCell;
use crate::localisation::trend::{Repetition, Trend};
use crate::tolerance::learning::{
    ERROR_STEP, FACTOR_STEP, FORM_POINTS, LEAST_TURNS, POINTS_A_PERIOD, SAME_POINT, TIME_POINTS_AT_MOST,
    TORQUE_STEP, ZOOM,
};

use LearnedPlace::{
    Gearbox, HubResolver, LoopSensor, Motor, MotorTachometer, Pivot, PlatformAccelerometer, PlatformGyro,
};
use LearnedQuantity::{Damping, Error, FrictionLevel, Stiffness, Torque, TorqueConstant};
use RegimeVariable::{Angle, Control, Load, Rate, Reading, Time, Turn};

/// A free function to be tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Template {
    pub place: LearnedPlace,
    pub quantity: LearnedQuantity,
    pub variable: RegimeVariable,
}

/// All that are tried. A torque over the motor's angle beyond one turn is one over the hub's angle. A factor over one variable on a torque
/// that is proportional to another is a function of both: damping over the angle is a torque over angle and rate, a torque constant over the
/// angle is one over elevation and torque. Sensors that are not in the loop are tried where the localisation points at them.
const TEMPLATES: [Template; 26] = [
    Template { place: Pivot, quantity: Damping, variable: Angle },
    Template { place: Pivot, quantity: FrictionLevel, variable: Angle },
    Template { place: Pivot, quantity: FrictionLevel, variable: Load },
    Template { place: Pivot, quantity: FrictionLevel, variable: Time },
    Template { place: Pivot, quantity: Torque, variable: Angle },
    Template { place: Pivot, quantity: Torque, variable: Rate },
    Template { place: Pivot, quantity: Torque, variable: Time },
    Template { place: Pivot, quantity: FrictionLevel, variable: Turn },
    Template { place: Pivot, quantity: Torque, variable: Turn },
    Template { place: Motor, quantity: FrictionLevel, variable: Load },
    Template { place: Motor, quantity: FrictionLevel, variable: Turn },
    Template { place: Motor, quantity: Torque, variable: Rate },
    Template { place: Motor, quantity: Torque, variable: Turn },
    Template { place: Motor, quantity: TorqueConstant, variable: Angle },
    Template { place: Motor, quantity: TorqueConstant, variable: Control },
    Template { place: Motor, quantity: TorqueConstant, variable: Rate },
    Template { place: Motor, quantity: TorqueConstant, variable: Time },
    Template { place: Motor, quantity: TorqueConstant, variable: Turn },
    Template { place: Gearbox, quantity: Stiffness, variable: Load },
    Template { place: LoopSensor, quantity: Error, variable: Reading },
    Template { place: LoopSensor, quantity: Error, variable: Angle },
    Template { place: LoopSensor, quantity: Error, variable: Time },
    Template { place: MotorTachometer, quantity: Error, variable: Reading },
    Template { place: HubResolver, quantity: Error, variable: Reading },
    Template { place: PlatformGyro, quantity: Error, variable: Reading },
    Template { place: PlatformAccelerometer, quantity: Error, variable: Reading },
];
/// Points over a turn of the motor, as a multiple of those over a range: cogging has many periods.
const TURN_POINTS: usize = 2;
/// The same over a turn of the hub: a motor without a gear has its cogging there, and its harmonics.
const HUB_TURN_POINTS: usize = 4;

/// The purpose of templates.
pub(crate) struct TemplateContext<'a> {
    /// The mechanism.
    pub base: &'a Parameters,
    /// Values that the recordings visit.
    pub visited: &'a VisitedRanges,
    /// The localisation.
    pub map: &'a [MapCell],
    /// The components at which an error explains most.
    pub components: &'a [Component],
    /// Turns of the motor, as the model counts them, per turn of the machine's own motor.
    pub motor_turns: f64,
}

impl TemplateContext<'_> {
    /// Returns the templates that a machine allows.
    pub fn all(&self) -> Vec<Template> {
        let rigid = self.base.gearbox.is_rigid();
        let slides = |place: LearnedPlace| match place {
            Motor => self.base.motor_friction.coulomb_nm() > 0.0,
            _ => self.base.pivot_friction.coulomb_nm() > 0.0,
        };
        let allowed = |t: &&Template| {
            let of_gear = t.place == Gearbox || t.variable == Load;
            let turns = t.variable != Turn || self.repeats(t.place);
            let damped = t.quantity != Damping || self.base.pivot_friction.viscous_nm_s_rad > 0.0;
            self.has_place(t.place)
                && !(of_gear && rigid)
                && turns
                && damped
                && (t.quantity != FrictionLevel || slides(t.place))
        };
        TEMPLATES.iter().filter(allowed).copied().collect()
    }

    /// Returns whether the machine has a place; a sensor was recorded, too, and is the loop's or one that was located.
    fn has_place(&self, place: LearnedPlace) -> bool {
        let sensors = &self.base.sensors;
        let fitted = match place {
            MotorTachometer => sensors.motor_tachometer.is_some(),
            HubResolver => sensors.hub_resolver.is_some(),
            PlatformGyro => sensors.platform_gyro.is_fitted(),
            PlatformAccelerometer => sensors.platform_accelerometer.is_fitted(),
            _ => return true,
        };
        fitted && self.visited.has_recorded(place) && self.components.contains(&component_of(place))
    }

    /// Returns whether a turn at a place is a turn of the machine's own joint, and the recordings show it repeat.
    fn repeats(&self, place: LearnedPlace) -> bool {
        match place {
            Pivot => {
                let range = self.visited.range(Pivot, Angle);
                range.is_some_and(|[low, high]| high - low > LEAST_TURNS * TAU)
            }
            _ => self.motor_turns == 1.0,
        }
    }

    /// Returns the element of a template with a number of points over what the recordings visit; `None` if the variable does not move.
    pub fn element(&self, template: Template, count: usize) -> Option<LearnedElement> {
        let Template { place, quantity, variable } = template;
        let points = if variable == Turn {
            let count = count * if place == Pivot { HUB_TURN_POINTS } else { TURN_POINTS };
            (0..count).map(|k| TAU * k as f64 / count as f64).collect()
        } else {
            let [low, high] = self.visited.range(place, variable)?;
            let count = if variable == Time { self.time_points(high - low, count) } else { count };
            place_points(variable, [low, high], count)
        };
        // an error of a sensor has corners
        let interpolation =
            if variable == Reading { Interpolation::Linear } else { Interpolation::default() };
        let measured = match place {
            LoopSensor => self.base.sensors.measured,
            _ => Default::default(),
        };
        let mut element = LearnedElement::neutral(place, quantity, variable, points);
        if let Some(form) = self.shown_form(&element) {
            add_corners(&mut element.points, &form.corners());
            element.values = vec![quantity.neutral(); element.points.len()];
        }
        Some(LearnedElement { interpolation, measured, ..element })
    }

    /// Returns the form, without a level, that an error of the loop's sensor has which other sensors show; `None` for another element, or if no
    /// other sensor shows it. A bias moves everything, and the means of other sensors do not show one so exactly.
    pub fn shown_form(&self, element: &LearnedElement) -> Option<FittedForm> {
        if element.place != LoopSensor || element.variable != Reading {
            return None;
        }
        let points = place_points(Reading, self.visited.range(LoopSensor, Reading)?, FORM_POINTS);
        let dense = LearnedElement::neutral(LoopSensor, Error, Reading, points);
        let values = self.visited.shown_error(&dense)?;
        let mut form = nearest_forms(&LearnedElement { values, ..dense }).into_iter().next()?;
        form.linear[0] = 0.0;
        Some(form)
    }

    /// Returns how many points a function of time needs: more if the mismatch repeats in time.
    fn time_points(&self, length_s: f64, count: usize) -> usize {
        let period = self.map.iter().filter(|cell| cell.regime == Regime::Time).filter_map(|cell| match cell
            .trend
        {
            Some(Trend::Periodic { repetition: Some(Repetition::InTime { period_s, .. }) }) => Some(period_s),
            _ => None,
        });
        let shortest = period.fold(f64::INFINITY, f64::min);
        let needed = (POINTS_A_PERIOD * length_s / shortest) as usize;
        if shortest.is_finite() && needed <= TIME_POINTS_AT_MOST { needed.max(count) } else { count }
    }

    /// Returns the effect by which an element is fitted.
    pub fn effect(&self, element: &LearnedElement) -> &'static Effect {
        let at_hub = TORQUE_STEP * self.visited.drive_torque_nm;
        let step = match (element.quantity.is_factor(), element.place) {
            _ if element.quantity == Error => ERROR_STEP * self.visited.reading_rms(element.place),
            (true, _) => FACTOR_STEP,
            (false, Motor) => at_hub / self.base.gearbox.ratio,
            (false, _) => at_hub,
        };
        make_learned_effect(element, step)
    }
}

/// Returns points over a range: evenly, but those over a reading closer together towards zero, where a sensor errs most for its reading.
pub(crate) fn place_points(variable: RegimeVariable, [low, high]: [f64; 2], count: usize) -> Vec<f64> {
    let share = |k: usize| k as f64 / (count - 1) as f64;
    let zoomed = |at: f64| at * (ZOOM + (1.0 - ZOOM) * at * at);
    match variable == Reading && low < 0.0 && high > 0.0 {
        true => {
            let size = high.max(-low);
            let all = (0..count).map(|k| size * zoomed(2.0 * share(k) - 1.0));
            all.map(|at| if at < 0.0 { at * -low / size } else { at * high / size }).collect()
        }
        false => (0..count).map(|k| low + (high - low) * share(k)).collect(),
    }
}

/// Adds corners to points, in the place of those that are hardly apart from one.
pub(crate) fn add_corners(points: &mut Vec<f64>, corners: &[f64]) {
    let (first, last) = (points[0], points[points.len() - 1]);
    let near = SAME_POINT * (last - first);
    let within = corners.iter().filter(|corner| (first + near..last - near).contains(*corner));
    for corner in within {
        points.retain(|point| (point - corner).abs() > near);
        points.push(*corner);
    }
    points.sort_by(f64::total_cmp);
}

/// Returns the components at which an error explains most and that a place belongs to.
pub(crate) fn is_at(component: Component, place: LearnedPlace) -> bool {
    match place {
        Pivot => matches!(component, Component::Pivot | Component::Structure),
        Motor => matches!(component, Component::Motor | Component::Amplifier | Component::Control),
        _ => component == component_of(place),
    }
}
