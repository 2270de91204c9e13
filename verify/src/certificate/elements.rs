//! The substitutes of the nonlinear parts of the loop in one regime: an impedance at each joint, a share of the gear's stiffness, and a
//! linear path for each friction observer.

use counterpoise_controller::{Controller, FrictionObserver, Parts, Path, PathSignal, Scaling};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, lft, poles, series};
use counterpoise_models::Parameters;
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::plant::{Angles, FrictionLinearisation, Impedance, Plant, friction_impedance};

use super::CertifiedCase;
use super::floor::Subject;
use crate::Error;
use crate::linear_loop::SampledPlant;
use crate::linear_loop::closed_loop::resolver_use;
use crate::linear_loop::plant::port;
use crate::structured::places::joint_stiffness;
use crate::tolerance::{
    NEUTRAL, OBSERVER_PERIODS, OBSERVER_SAMPLES, OBSERVER_SMALL_DEFLECTION_RAD, OBSERVER_SMALL_SHARE, STUCK,
    UNLIMITED_V,
};

/// A friction observer as a linear path: volts = direct x rate + integral x the rate's integral.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ObserverGain {
    /// Volts per rate, V s/rad.
    pub direct: f64,
    /// Volts per angle, V/rad.
    pub integral: f64,
}

impl ObserverGain {
    /// Returns the gain of the part that is cancelled when a level that is learnt is right.
    fn times(self, part: f64) -> Self {
        Self { direct: part * self.direct, integral: part * self.integral }
    }
}

/// Linear replacements of the nonlinear parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Elements {
    /// Friction at the motor shaft.
    pub motor: Impedance,
    /// Friction at the pivot.
    pub pivot: Impedance,
    /// Share of the gear's stiffness and damping that acts.
    pub mesh_share: f64,
    /// The friction observers, in the controller's order.
    pub observers: Vec<ObserverGain>,
}

/// A sinusoidal motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sinusoid {
    /// Amplitude of the hub's rate, rad/s.
    pub rate_rad_s: f64,
    /// Frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Motion of the motor over that of the hub, in amplitude: the gear's ratio if the gear is stiff.
    pub motor_over_hub: f64,
}

/// Returns the stiffness and damping of dry friction at rest, at the motor's shaft and at the pivot; a joint that truly sticks is held by a spring
/// that is stiff against the transmission.
///
/// # Errors
/// Friction parameters out of range.
pub fn rest_impedances(plant: &Plant) -> Result<[Impedance; 2], Error> {
    let parameters = plant.parameters();
    // The body of a plant holds the rotor of a rigid transmission already.
    let inertia = plant.body().inertia_kg_m2 - parameters.reflected_inertia_kg_m2();
    let (gear, ratio) = (joint_stiffness(parameters, inertia), parameters.gearbox.ratio);
    let of = |friction, most: f64| -> Result<Impedance, Error> {
        let model = FrictionModel::new(friction)?;
        let stiffness = model.rest_stiffness_nm_rad().min(STUCK * most);
        Ok(Impedance { stiffness, damping: model.law().rest_damping_nm_s_rad() })
    };
    Ok([of(&parameters.motor_friction, gear / (ratio * ratio))?, of(&parameters.pivot_friction, gear)?])
}

impl Elements {
    /// Returns the elements at rest, for motions that are small against the presliding deflection.
    pub(super) fn at_rest(subject: &Subject<'_>) -> Result<Self, Error> {
        let [motor, pivot] = rest_impedances(&subject.case.plant)?;
        Ok(Self {
            motor,
            pivot,
            mesh_share: 1.0,
            observers: Self::observers_at_rest(subject.case, subject.controller)?,
        })
    }

    /// Returns the friction observers at rest, for motions that are small against their presliding deflection.
    ///
    /// # Errors
    /// Those of the controller.
    pub fn observers_at_rest(
        case: &CertifiedCase,
        controller: &Controller,
    ) -> Result<Vec<ObserverGain>, Error> {
        let parameters = case.plant.parameters();
        let (ratio, period_s) = (parameters.gearbox.ratio, parameters.interface.sample_period_s);
        controller
            .parts()
            .observers
            .iter()
            .map(|observer| {
                Ok(presliding_gain(observer, period_s, ratio)?.times(controller.parts().cancelled_part()))
            })
            .collect()
    }

    /// Returns the elements for a hub that turns at a rate: the slopes of the sliding levels.
    pub(super) fn sliding(subject: &Subject<'_>, rate_rad_s: f64) -> Result<Self, Error> {
        let parameters = subject.case.plant.parameters();
        let ratio = parameters.gearbox.ratio;
        let slope = |friction, rate: f64| -> Result<Impedance, Error> {
            let law = *FrictionModel::new(friction)?.law();
            Ok(Impedance { stiffness: 0.0, damping: law.steady_slope(rate, 1.0) })
        };
        let observer = |observer: &FrictionObserver| {
            let rate = if observer.rate == PathSignal::MotorRate { ratio * rate_rad_s } else { rate_rad_s };
            let level = observer.coulomb_nm * level_slope(&observer.level, rate);
            let whole = ObserverGain { direct: observer.volts_per_nm * level, integral: 0.0 };
            whole.times(subject.controller.parts().cancelled_part())
        };
        Ok(Self {
            motor: slope(&parameters.motor_friction, ratio * rate_rad_s)?,
            pivot: slope(&parameters.pivot_friction, rate_rad_s)?,
            mesh_share: 1.0,
            observers: subject.controller.parts().observers.iter().map(observer).collect(),
        })
    }

    /// Returns the elements for a sinusoidal motion: describing functions at each element's own amplitude.
    pub(super) fn harmonic(subject: &Subject<'_>, motion: &Sinusoid) -> Result<Self, Error> {
        let parameters = subject.case.plant.parameters();
        let hub_rad = motion.rate_rad_s / motion.frequency_rad_s;
        let frequency = motion.frequency_rad_s;
        let motor_rad = hub_rad * motion.motor_over_hub;
        let period_s = parameters.interface.sample_period_s;
        let gain = |observer: &FrictionObserver| {
            let felt = match observer.rate {
                PathSignal::MotorRate => motion.rate_rad_s * motion.motor_over_hub,
                _ => motion.rate_rad_s,
            };
            let whole = observer_gain(observer, felt, frequency, period_s)?;
            Ok(whole.times(subject.controller.parts().cancelled_part()))
        };
        Ok(Self {
            motor: friction_impedance(&parameters.motor_friction, motor_rad, frequency)?,
            pivot: friction_impedance(&parameters.pivot_friction, hub_rad, frequency)?,
            mesh_share: 1.0,
            observers: subject.controller.parts().observers.iter().map(gain).collect::<Result<_, Error>>()?,
        })
    }
}

/// The observer at a thousandth of its presliding deflection, at a tenth of half the sample rate: a spring, to a part in a thousand.
fn presliding_gain(observer: &FrictionObserver, period_s: f64, ratio: f64) -> Result<ObserverGain, Error> {
    let frequency = 0.1 * std::f64::consts::PI / period_s;
    let stiffness = observer.rest_stiffness_nm_rad;
    let side = if observer.rate == PathSignal::MotorRate { ratio } else { 1.0 };
    let deflection =
        if stiffness > 0.0 { observer.coulomb_nm / stiffness } else { OBSERVER_SMALL_DEFLECTION_RAD * side };
    observer_gain(observer, OBSERVER_SMALL_SHARE * deflection * frequency, frequency, period_s)
}

/// Slope of a level given by points (rad/s, 1), per rad/s.
fn level_slope(points: &[[f64; 2]], rate_rad_s: f64) -> f64 {
    let rate = rate_rad_s.abs();
    let around = points.windows(2).find(|pair| pair[0][0] <= rate && rate < pair[1][0]);
    around.map_or(0.0, |pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]))
}

/// The describing function of an observer, read from its own program: first harmonic of its volts over that of the rate.
///
/// An observer that follows the demand is outside the loop and has no gain.
fn observer_gain(
    observer: &FrictionObserver,
    rate_rad_s: f64,
    frequency_rad_s: f64,
    period_s: f64,
) -> Result<ObserverGain, Error> {
    if observer.rate == PathSignal::Demand {
        return Ok(ObserverGain::default());
    }
    let samples = (std::f64::consts::TAU / (frequency_rad_s * period_s)).round() as usize;
    let samples = samples.clamp(OBSERVER_SAMPLES[0], OBSERVER_SAMPLES[1]);
    let angle = std::f64::consts::TAU / samples as f64;
    let reading = observer.rate.reading().unwrap_or(1);
    let sign = if observer.rate == PathSignal::RateError { -1.0 } else { 1.0 };
    let mut parts = Parts::new(period_s, UNLIMITED_V);
    let alone = FrictionObserver { viscous_v_s_rad: 0.0, ..observer.clone() };
    parts.observers.push(alone);
    let mut runner = Controller::new(parts)?.runner();
    let mut harmonic = C64::new(0.0, 0.0);
    for k in 0..2 * OBSERVER_PERIODS * samples {
        let phase = C64::from_polar(1.0, angle * (k % samples) as f64);
        let mut readings = [0.0; counterpoise_controller::READINGS];
        readings[reading] = sign * rate_rad_s * phase.re;
        let volts = runner.step_array(&readings);
        if k >= OBSERVER_PERIODS * samples {
            harmonic += phase.conj() * volts;
        }
    }
    let gain = harmonic * (2.0 / (OBSERVER_PERIODS * samples) as f64 / rate_rad_s);
    // z / (z - 1) T is what the path's integrator gives at this angle
    let z = C64::from_polar(1.0, angle);
    let integrator = z / (z - 1.0) * period_s;
    let integral = gain.im / integrator.im;
    Ok(ObserverGain { direct: gain.re - integral * integrator.re, integral })
}

/// A linear loop at some elements.
pub(super) struct ElementLoop {
    pub plant: SampledPlant,
    /// The loop broken at the plant's input, for negative feedback.
    pub broken: StateSpace,
    /// The controller, from the readings to the control.
    pub controller: StateSpace,
    /// Poles of the closed loop that are not neutral.
    pub poles: Vec<C64>,
}

/// The action of the estimator in a linear loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Learning {
    /// The estimate stands still.
    Still,
    /// It learns, about the state in which it starts.
    Active,
}

impl ElementLoop {
    /// Closes the loop.
    pub fn close(subject: &Subject<'_>, elements: &Elements, learning: Learning) -> Result<Self, Error> {
        let body = with_mesh(&subject.case.plant, elements.mesh_share)?;
        let friction = FrictionLinearisation::Impedances { motor: elements.motor, pivot: elements.pivot };
        let at = body.equilibrium(&subject.procedure.operating_point);
        let linear = body.linearise(&at, friction, Angles::Relative)?;
        let controller = quasi_linear(subject.controller, &elements.observers)?;
        let plant = SampledPlant::new(&linear, body.parameters(), resolver_use(&controller))?;
        let slope = drive_slope(&subject.controller.parts().drive_curve, at.control_v);
        let mut K = match learning {
            Learning::Still => controller.linear(subject.case.out_of_balance_kg_m)?,
            Learning::Active => controller.linear_learning(subject.case.out_of_balance_kg_m)?,
        };
        K.C = K.C.scale(slope);
        K.D = K.D.scale(slope);
        let readings: Vec<usize> = (port::FIRST_READING..plant.sampled.outputs()).collect();
        let broken = series(&plant.sampled.select(&readings, &[port::CONTROL]), &K)?.negate();
        let all = poles(&lft(&plant.sampled, &K)?)?;
        let poles = all.into_iter().filter(|pole| (pole - 1.0).norm() > NEUTRAL).collect();
        Ok(Self { plant, broken, controller: K, poles })
    }

    /// Returns the pole of largest modulus; 0 without poles.
    pub fn largest_pole(&self) -> C64 {
        let zero = C64::new(0.0, 0.0);
        self.poles.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(zero)
    }

    /// Returns the pole that a harmonic balance looks at: the oscillating pole of largest modulus, or a real one that grows faster, as a
    /// negative stiffness gives; `None` if there is neither.
    pub fn least_stable_pole(&self) -> Option<C64> {
        let lively = |pole: &C64| pole.im > 0.0 || (pole.im == 0.0 && pole.re > 1.0);
        let all = self.poles.iter().copied().filter(lively);
        all.max_by(|a, b| a.norm().total_cmp(&b.norm()))
    }
}

/// The mechanism with a share of its gear's stiffness and damping.
pub(super) fn with_mesh(plant: &Plant, share: f64) -> Result<Plant, Error> {
    if share == 1.0 {
        return Ok(plant.clone());
    }
    let mut parameters: Parameters = plant.parameters().clone();
    parameters.gearbox.stiffness_nm_rad *= share;
    parameters.gearbox.damping_nm_s_rad *= share;
    Ok(Plant::with_body(&parameters, plant.body().clone())?)
}

/// Returns the controller with a linear path in the place of each friction observer, in volts of a linear drive.
///
/// # Errors
/// Those of the controller.
pub fn quasi_linear(controller: &Controller, gains: &[ObserverGain]) -> Result<Controller, Error> {
    let period_s = controller.sample_period_s();
    let timebase = Timebase::Discrete { period_s };
    let one = |x: f64| Mat::row(&[x]);
    let mut paths = Vec::new();
    for (k, (observer, gain)) in controller.parts().observers.iter().zip(gains).enumerate() {
        let direct = gain.direct + observer.viscous_v_s_rad;
        let system = if gain.integral == 0.0 {
            StateSpace::gain(one(direct), timebase)?
        } else {
            // x[k+1] = x[k] + T w[k],  volts = integral (x[k] + T w[k]) + direct w[k]
            let through = gain.integral * period_s + direct;
            StateSpace::new(one(1.0), one(period_s), one(gain.integral), one(through), timebase)?
        };
        let anti_windup = vec![0.0; system.order()];
        let name = format!("quasi_linear_{k}");
        paths.push(Path { name, inputs: vec![observer.rate], system, anti_windup, scaling: Scaling::Fixed });
    }
    Ok(controller.with(|parts| {
        parts.observers.clear();
        parts.paths.extend(paths);
        parts.drive_curve.clear();
    })?)
}

/// Slope of the inverse of the drive's curve at a control, V/V: 1 without a curve and beyond its last point.
fn drive_slope(curve: &[[f64; 2]], control_v: f64) -> f64 {
    let mut from = [0.0, 0.0];
    for point in curve {
        if control_v.abs() < point[1] {
            return (point[1] - from[1]) / (point[0] - from[0]);
        }
        from = *point;
    }
    1.0
}
