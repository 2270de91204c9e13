//! Free functions in the plant: tables that are ready for evaluation, and what they add to the torques.

use std::f64::consts::TAU;

use super::mesh_loss::MeshLoss;
use super::{Mesh, Plant};
use crate::Error;
use crate::parameters::{
    Gearbox, Interpolation, LearnedElement, LearnedPlace, LearnedQuantity, Parameters, RegimeVariable,
    Sensors,
};
use crate::tolerance::{LEARNED_SPACING, LEAST_LEVEL, PERIODIC_COPIES};

/// A function through points, constant outside them.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedTable {
    points: Vec<f64>,
    /// Powers of the distance from the point below, interval by interval.
    powers: Vec<[f64; 4]>,
    last: f64,
    /// Intervals per unit of the variable if all are equally long.
    per_unit: Option<f64>,
    period: Option<f64>,
}

impl LearnedTable {
    /// Returns the function of an element; `None` if it has no points, or not one value for each.
    pub fn new(element: &LearnedElement) -> Option<Self> {
        let (points, values) = (&element.points, &element.values);
        let last = *values.last()?;
        if values.len() != points.len() {
            return None;
        }
        if element.variable != RegimeVariable::Turn || points.len() < 2 {
            let powers = pieces(element.interpolation, points, values);
            return Some(Self {
                per_unit: spacing(points),
                points: points.clone(),
                powers,
                last,
                period: None,
            });
        }
        let (points, powers) = periodic_points(element.interpolation, points, values);
        Some(Self { per_unit: spacing(&points), points, powers, last: values[0], period: Some(TAU) })
    }

    /// Returns the points between which the pieces lie; of a function over a turn with the first one again, a turn on.
    pub fn points(&self) -> &[f64] {
        &self.points
    }

    /// Returns the powers of the distance from the point below, piece by piece.
    pub fn powers(&self) -> &[[f64; 4]] {
        &self.powers
    }

    /// Returns the value from the last point on.
    pub fn last_value(&self) -> f64 {
        self.last
    }

    /// Returns the period of a function over a turn, rad.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// Returns the value at a place of the variable.
    #[inline]
    pub fn at(&self, variable: f64) -> f64 {
        match self.piece(variable) {
            Ok((distance, [a, b, c, d])) => a + distance * (b + distance * (c + distance * d)),
            Err(end) => end,
        }
    }

    /// Returns the derivative by the variable; 0 outside the points.
    pub fn slope_at(&self, variable: f64) -> f64 {
        match self.piece(variable) {
            Ok((distance, [_, b, c, d])) => b + distance * (2.0 * c + 3.0 * distance * d),
            Err(_) => 0.0,
        }
    }

    /// Returns the distance from the point below with the powers of that interval; outside the points their end value.
    #[inline]
    fn piece(&self, variable: f64) -> Result<(f64, [f64; 4]), f64> {
        let (first, end) = (self.points[0], self.points[self.points.len() - 1]);
        let place = self.period.map_or(variable, |period| (variable - first).rem_euclid(period) + first);
        if place.is_nan() || place < first || self.powers.is_empty() {
            return Err(self.powers.first().map_or(self.last, |powers| powers[0]));
        }
        if place >= end {
            return Err(self.last);
        }
        let most = self.powers.len() - 1;
        let guess = match self.per_unit {
            Some(per_unit) => ((place - first) * per_unit) as usize,
            None => self.points.partition_point(|point| *point <= place) - 1,
        };
        let index = guess.min(most);
        Ok((place - self.points[index], self.powers[index]))
    }
}

/// Returns the intervals per unit if all are equally long within rounding.
fn spacing(points: &[f64]) -> Option<f64> {
    let count = points.len().checked_sub(1).filter(|count| *count > 0)?;
    let step = (points[count] - points[0]) / count as f64;
    let even =
        |(k, point): (usize, &f64)| (point - points[0] - k as f64 * step).abs() < LEARNED_SPACING * step;
    points.iter().enumerate().all(even).then(|| 1.0 / step)
}

/// Returns the points of one period, closed, and the pieces between them: those of a function that repeats on either side.
fn periodic_points(how: Interpolation, points: &[f64], values: &[f64]) -> (Vec<f64>, Vec<[f64; 4]>) {
    let count = points.len();
    let copies = PERIODIC_COPIES.div_ceil(count);
    let turns = -(copies as i64)..=copies as i64;
    let moved = |turn: i64| points.iter().map(move |point| point + TAU * turn as f64);
    let all: Vec<f64> = turns.clone().flat_map(moved).collect();
    let repeated: Vec<f64> = turns.flat_map(|_| values.iter().copied()).collect();
    let powers = pieces(how, &all, &repeated);
    let first = copies * count;
    let mut closed = points.to_vec();
    closed.push(points[0] + TAU);
    (closed, powers[first..first + count].to_vec())
}

/// Returns the powers of each interval.
fn pieces(how: Interpolation, points: &[f64], values: &[f64]) -> Vec<[f64; 4]> {
    let bends = match how {
        Interpolation::Cubic => curvatures(points, values),
        Interpolation::Linear => vec![0.0; points.len()],
    };
    let one = |k: usize| {
        let h = points[k + 1] - points[k];
        let slope = (values[k + 1] - values[k]) / h - h * (2.0 * bends[k] + bends[k + 1]) / 6.0;
        [values[k], slope, 0.5 * bends[k], (bends[k + 1] - bends[k]) / (6.0 * h)]
    };
    (0..points.len().saturating_sub(1)).map(one).collect()
}

/// Returns the second derivatives of the natural cubic spline at its points (de Boor 1978), by Thomas' algorithm.
fn curvatures(points: &[f64], values: &[f64]) -> Vec<f64> {
    let n = points.len();
    let mut bends = vec![0.0; n];
    if n < 3 {
        return bends;
    }
    let h = |k: usize| points[k + 1] - points[k];
    let rise = |k: usize| (values[k + 1] - values[k]) / h(k);
    let mut factors = vec![0.0; n];
    for k in 1..n - 1 {
        let pivot = 2.0 * (h(k - 1) + h(k)) - h(k - 1) * factors[k - 1];
        factors[k] = h(k) / pivot;
        bends[k] = (6.0 * (rise(k) - rise(k - 1)) - h(k - 1) * bends[k - 1]) / pivot;
    }
    for k in (1..n - 1).rev() {
        bends[k] -= factors[k] * bends[k + 1];
    }
    bends
}

/// Regime variables of a plant, as its free functions use them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LearnedRegime {
    /// Time since the start, s.
    pub time_s: f64,
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    /// Current, A.
    pub current_a: f64,
    /// Angle and rate of the motor on the platform, rad and rad/s.
    pub motor: JointMotion,
    /// Angle and rate of the hub on the platform, rad and rad/s.
    pub hub: JointMotion,
    /// Wind-up of the transmission, rad.
    pub wind_up_rad: f64,
    /// Torque of the mesh at the output, N m.
    pub mesh_torque_nm: f64,
}

/// Angle and rate of a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JointMotion {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Rate, rad/s.
    pub rate_rad_s: f64,
}

/// The free functions of a plant, ready for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedFunctions {
    pub(super) all: Vec<LearnedFunction>,
    ratio: f64,
}

/// One free function of a plant, ready for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedFunction {
    /// The component at which it acts.
    pub place: LearnedPlace,
    /// Quantity that it adds to or multiplies.
    pub quantity: LearnedQuantity,
    /// The variable that it is a function of.
    pub variable: RegimeVariable,
    /// Values.
    pub table: LearnedTable,
}

impl LearnedFunctions {
    /// Returns the functions of a machine that act on its mechanism; `None` if it has none.
    pub fn of(parameters: &Parameters) -> Option<Self> {
        let acting = parameters.learned.iter().filter(|element| !element.place.is_sensor());
        let one = |element: &LearnedElement| {
            Some(LearnedFunction {
                place: element.place,
                quantity: element.quantity,
                variable: element.variable,
                table: LearnedTable::new(element)?,
            })
        };
        let all: Vec<LearnedFunction> = acting.filter_map(one).collect();
        (!all.is_empty()).then_some(Self { all, ratio: parameters.gearbox.ratio })
    }

    /// Returns the functions, in the order of the machine's elements.
    pub fn iter(&self) -> impl Iterator<Item = &LearnedFunction> {
        self.all.iter()
    }

    /// Returns whether a function needs the torque of the mesh.
    pub fn needs_mesh_torque(&self) -> bool {
        let needs =
            |f: &LearnedFunction| f.variable == RegimeVariable::Load || f.place == LearnedPlace::Gearbox;
        self.all.iter().any(needs)
    }

    /// Returns the factor on the level of dry friction at a joint.
    #[inline]
    pub fn friction_level(&self, place: LearnedPlace, at: &LearnedRegime) -> f64 {
        let levels =
            self.all.iter().filter(|f| f.quantity == LearnedQuantity::FrictionLevel && f.place == place);
        levels.fold(1.0, |product, f| product * f.table.at(self.variable(f, at)).max(LEAST_LEVEL))
    }

    /// Returns the torques that the functions add beside those of the levels of dry friction.
    #[inline]
    pub fn torques(&self, plant: &Plant, at: &LearnedRegime) -> MeshLoss {
        let mut sum = MeshLoss::default();
        for function in &self.all {
            let value = function.table.at(self.variable(function, at));
            let torque = value_torque_nm(function, value, plant, at);
            self.add(function.place, torque, &mut sum);
        }
        sum
    }

    /// Adds a torque at its place; at the gearbox it acts on both sides.
    #[inline]
    pub(super) fn add(&self, place: LearnedPlace, torque_nm: f64, sum: &mut MeshLoss) {
        match place {
            LearnedPlace::Pivot => sum.hub_nm += torque_nm,
            LearnedPlace::Motor => sum.motor_nm += torque_nm,
            LearnedPlace::Gearbox => {
                sum.hub_nm += torque_nm;
                sum.motor_nm -= torque_nm / self.ratio;
            }
            _ => {}
        }
    }

    #[inline]
    pub(super) fn variable(&self, function: &LearnedFunction, at: &LearnedRegime) -> f64 {
        let joint = match function.place {
            LearnedPlace::Pivot => at.hub,
            LearnedPlace::Motor => at.motor,
            LearnedPlace::Gearbox => JointMotion {
                angle_rad: at.wind_up_rad,
                rate_rad_s: at.motor.rate_rad_s / self.ratio - at.hub.rate_rad_s,
            },
            _ => JointMotion::default(),
        };
        match function.variable {
            RegimeVariable::Angle | RegimeVariable::Turn => joint.angle_rad,
            RegimeVariable::Rate => joint.rate_rad_s,
            RegimeVariable::Load if function.place == LearnedPlace::Motor => at.mesh_torque_nm / self.ratio,
            RegimeVariable::Load => at.mesh_torque_nm,
            RegimeVariable::Control => at.drive_v,
            RegimeVariable::Time => at.time_s,
            RegimeVariable::Reading => 0.0,
        }
    }
}

/// Returns the torque that a function's value stands for at its place, N m; 0 for a level of dry friction.
#[inline]
fn value_torque_nm(function: &LearnedFunction, value: f64, plant: &Plant, at: &LearnedRegime) -> f64 {
    let p = plant.parameters();
    let mesh_damping = || {
        let touches = plant.mesh(at.wind_up_rad).0 == Mesh::Touching && !plant.is_rigid();
        let rate = at.motor.rate_rad_s / p.gearbox.ratio - at.hub.rate_rad_s;
        if touches { p.gearbox.damping_nm_s_rad * rate } else { 0.0 }
    };
    let more = value - 1.0;
    match (function.quantity, function.place) {
        (LearnedQuantity::Torque, _) => value,
        (LearnedQuantity::FrictionLevel | LearnedQuantity::Error, _) => 0.0,
        (LearnedQuantity::Stiffness, LearnedPlace::Gearbox) => more * (at.mesh_torque_nm - mesh_damping()),
        (LearnedQuantity::Stiffness, _) => more * plant.spring_torque_nm(at.hub.angle_rad),
        (LearnedQuantity::Damping, LearnedPlace::Gearbox) => more * mesh_damping(),
        (LearnedQuantity::Damping, LearnedPlace::Motor) => {
            -more * p.motor_friction.viscous_nm_s_rad * at.motor.rate_rad_s
        }
        (LearnedQuantity::Damping, _) => -more * p.pivot_friction.viscous_nm_s_rad * at.hub.rate_rad_s,
        (LearnedQuantity::TorqueConstant, _) => {
            let limit = p.amplifier.current_limit_a;
            let ripple = 1.0 + p.motor.torque_ripple.at(at.motor.angle_rad);
            more * p.motor.torque_constant_nm_a * at.current_a.clamp(-limit, limit) * ripple
        }
    }
}

impl Plant {
    /// Returns the free functions of the plant; `None` if it has none.
    pub fn learned_functions(&self) -> Option<&LearnedFunctions> {
        self.learned.as_ref()
    }

    /// Returns the factor of the free functions on the level of dry friction at a joint.
    pub fn learned_level(&self, place: LearnedPlace, at: &LearnedRegime) -> f64 {
        self.learned.as_ref().map_or(1.0, |functions| functions.friction_level(place, at))
    }

    /// Returns the torques that the free functions add beside those of the levels of dry friction.
    pub fn learned_torques(&self, at: &LearnedRegime) -> MeshLoss {
        self.learned.as_ref().map_or_else(MeshLoss::default, |functions| functions.torques(self, at))
    }
}

/// Refuses a free function that has no meaning, or acts on what the machine does not have.
pub(super) fn check(parameters: &Parameters) -> Result<(), Error> {
    parameters.learned.iter().enumerate().try_for_each(|(k, element)| {
        let refuse = |refusal: LearnedRefusal| {
            let parameter = format!("learned[{k}].{}", refusal.key);
            Err(Error::Parameter { parameter, value: refusal.value, allowed: refusal.allowed.into() })
        };
        element.refusal(&parameters.gearbox, &parameters.sensors).map_or(Ok(()), refuse)
    })
}

/// Why a free function is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedRefusal {
    /// The key of the element, with the index in its list.
    pub key: String,
    /// Value; the length of a list that is too long or too short; 0 for a word.
    pub value: f64,
    /// Allowed values, as a phrase that follows "it".
    pub allowed: &'static str,
}

impl LearnedRefusal {
    fn of(key: impl Into<String>, value: f64, allowed: &'static str) -> Option<Self> {
        Some(Self { key: key.into(), value, allowed })
    }
}

impl LearnedElement {
    /// Returns why the element is refused behind a transmission, beside sensors; `None` if it is sound.
    pub fn refusal(&self, gearbox: &Gearbox, sensors: &Sensors) -> Option<LearnedRefusal> {
        let place = match self.place.is_sensor() {
            true => self.refused_sensor(sensors),
            false => self.refused_place(gearbox),
        };
        place.or_else(|| self.refused_points()).or_else(|| self.refused_values())
    }

    fn refused_sensor(&self, sensors: &Sensors) -> Option<LearnedRefusal> {
        let fitted = match self.place {
            LearnedPlace::MotorTachometer => sensors.motor_tachometer.is_some(),
            LearnedPlace::HubResolver => sensors.hub_resolver.is_some(),
            LearnedPlace::PlatformGyro => sensors.platform_gyro.is_fitted(),
            LearnedPlace::PlatformAccelerometer => sensors.platform_accelerometer.is_fitted(),
            _ => true,
        };
        if !fitted {
            return LearnedRefusal::of("place", 0.0, "is a sensor that this machine does not have");
        }
        if self.quantity != LearnedQuantity::Error {
            return LearnedRefusal::of("quantity", 0.0, "must be \"error\" at a sensor");
        }
        let on_platform = self.place.is_platform_sensor();
        let of_hub = matches!(self.variable, RegimeVariable::Angle | RegimeVariable::Turn) && !on_platform;
        let own = matches!(self.variable, RegimeVariable::Reading | RegimeVariable::Time);
        let allowed = "must be \"reading\" or \"time\" at a sensor, or at one of the hub or the motor \"angle\" or \"turn\"";
        if own || of_hub { None } else { LearnedRefusal::of("variable", 0.0, allowed) }
    }

    fn refused_place(&self, gearbox: &Gearbox) -> Option<LearnedRefusal> {
        let of_gear = self.place == LearnedPlace::Gearbox || self.variable == RegimeVariable::Load;
        let acts = match self.quantity {
            LearnedQuantity::Torque | LearnedQuantity::Damping => true,
            LearnedQuantity::FrictionLevel => self.place != LearnedPlace::Gearbox,
            LearnedQuantity::Stiffness => self.place != LearnedPlace::Motor,
            LearnedQuantity::TorqueConstant => self.place == LearnedPlace::Motor,
            LearnedQuantity::Error => false,
        };
        let turns = self.variable == RegimeVariable::Turn && self.place == LearnedPlace::Gearbox;
        if of_gear && gearbox.is_rigid() {
            let allowed = "needs a transmission that gives, because a rigid one has no torque of its own: state gearbox.stiffness as well";
            return LearnedRefusal::of("place", 0.0, allowed);
        }
        if !acts {
            let allowed = "cannot act at this place: friction acts at pivot and motor, stiffness at pivot and gearbox, torque-constant at the motor, error at a sensor";
            return LearnedRefusal::of("quantity", 0.0, allowed);
        }
        let drags =
            self.quantity == LearnedQuantity::FrictionLevel && self.variable == RegimeVariable::Control;
        if drags {
            let allowed = "cannot be \"control\" for friction, which does not feel it: take its angle, rate, load or time";
            return LearnedRefusal::of("variable", 0.0, allowed);
        }
        if self.variable == RegimeVariable::Reading {
            let allowed = "cannot be \"reading\" at a part that reads nothing: take it at a sensor";
            return LearnedRefusal::of("variable", 0.0, allowed);
        }
        let allowed = "cannot be \"turn\" at the gearbox, whose wind-up does not turn";
        if turns { LearnedRefusal::of("variable", 0.0, allowed) } else { None }
    }

    fn refused_points(&self) -> Option<LearnedRefusal> {
        let key = |k: usize| format!("points[{k}]");
        if self.points.is_empty() {
            return LearnedRefusal::of("points", 0.0, "must hold at least one number");
        }
        let turn = self.variable == RegimeVariable::Turn;
        for (k, point) in self.points.iter().enumerate() {
            if !point.is_finite() {
                return LearnedRefusal::of(key(k), *point, "must be finite");
            }
            if k > 0 && *point <= self.points[k - 1] {
                return LearnedRefusal::of(key(k), *point, "must be above the point before");
            }
            if turn && !(0.0..TAU).contains(point) {
                let allowed = "must be at least 0 and below 2 pi, because the function repeats with a turn";
                return LearnedRefusal::of(key(k), *point, allowed);
            }
        }
        None
    }

    fn refused_values(&self) -> Option<LearnedRefusal> {
        let count = self.points.len();
        let lists = [
            ("values", &self.values, true),
            ("half_width", &self.half_width, false),
            ("coverage", &self.coverage, false),
        ];
        for (key, list, needed) in lists {
            if list.len() != count && (needed || !list.is_empty()) {
                return LearnedRefusal::of(key, list.len() as f64, "must hold one number for each point");
            }
            let least = if key == "values" && !self.quantity.is_factor() { f64::NEG_INFINITY } else { 0.0 };
            if let Some(k) = list.iter().position(|v| !(v.is_finite() && *v >= least)) {
                let allowed = if least == 0.0 { "must be finite and at least 0" } else { "must be finite" };
                return LearnedRefusal::of(format!("{key}[{k}]"), list[k], allowed);
            }
        }
        None
    }
}
