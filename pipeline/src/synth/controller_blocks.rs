//! The controller blocks beside the design's paths: the demand's prefilter, friction observers, the estimator.

use counterpoise_controller::signal::{HUB_POSITION, HUB_RATE};
use counterpoise_controller::{
    Correction, Estimator, FrictionObserver, Learning, LevelLearning, Parts, PathSignal, Projection, READINGS,
};
use counterpoise_lti::{StateSpace, c2d};
use counterpoise_models::{CONVERTER_RANGE_V, Friction, MapPoint, Parameters, Sensor, Sensors};
use counterpoise_synth::{
    DesignPlant, Drive, FrictionSide, ObservedFriction, SampledLoop, Sampling, check_sampled_loop,
    friction_observers,
};

use crate::synth::design_plant::{attach_sensors, torque_per_volt};
use crate::synth::friction_observers::observer_friction;
use crate::tolerance::{
    BEYOND_FULL_SCALE, LEAST_DEAD_BAND_M_S2, LEAST_SLOPE, LEAST_TORQUE_OVER_FRICTION,
    LEAST_TORQUE_WITHOUT_GRAVITY, LEAST_UNOBSERVED, SHORTEST_STRETCH_SHARE, SLIDING_RATES_AS_ONE, SMALL_KG_M,
};
use crate::{PipelineError, PlantModel};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::resolve::synthesis_options::{
    self as options, AdaptationMethod, AdaptationOptions, AdaptationUse, Compensation, ObserverFriction,
    ObserverOptions,
};

/// Standard deviation with which parameters other than the imbalance start, V or V s/rad.
const LOOSE: f64 = 10.0;
/// Time within which the platform's pitch angle is the integral of its gyroscope, s. Vehicles and ships pitch faster than this; a bias of 1e-3 rad/s
/// leaves 0.01 rad, a hundredth of surge. A longer time would follow slower pitch and let more of the bias through.
const PITCH_WASHOUT_S: f64 = 10.0;
/// Memories for which an estimate must stand before it is no longer followed: in two, what is still to come is less than a sixth of what was moved.
const FOLLOWED_MEMORIES: f64 = 2.0;
/// Usual hold band: a change of the load within it is never learnt. On every example the out-of-balance stands still when nothing changes.
pub(crate) const HOLD_BAND: f64 = 0.04;

/// Returns the sampled controller with the blocks beside its paths, checked again.
///
/// # Errors
/// Those of the controller.
pub(crate) fn with_controller_blocks(
    sampled: SampledLoop,
    asked: &DesignRequest,
    modelled: &PlantModel,
    plant: &DesignPlant,
    sampling: &Sampling,
) -> Result<SampledLoop, PipelineError> {
    let prefilter = prefilter(asked, sampling)?;
    let observers = match &asked.options.observer {
        Some(observer) => observers(observer, &modelled.parameters)?,
        None => Vec::new(),
    };
    let adaptation = asked.options.adaptation.as_ref();
    let observer = asked.options.observer.as_ref();
    let exported = adaptation.filter(|adaptation| adaptation.use_in_code == AdaptationUse::Exported);
    let estimator = exported.map(|adaptation| estimator(adaptation, modelled, observer));
    let amplifier = &modelled.parameters.amplifier;
    let drive_curve = match asked.options.amplifier_curve {
        Compensation::Absent => Vec::new(),
        Compensation::Applied => {
            drive_curve(&amplifier.map, amplifier.stall_gain_a_v(&modelled.parameters.motor))
        }
    };
    let corrections = corrections(asked, &modelled.parameters.sensors);
    let bare = prefilter.is_none() && observers.is_empty() && estimator.is_none() && drive_curve.is_empty();
    let projection = projection(asked, modelled);
    if bare && corrections.is_empty() && projection.is_none() {
        return Ok(sampled);
    }
    let learning = observer.and_then(|observer| observer.learning.map(|asked| (asked, observer.share)));
    let level_learning = learning.map(|(asked, share)| level_learning(asked, share, &observers));
    let change = |parts: &mut Parts| {
        parts.level_learning = level_learning;
        (parts.prefilter, parts.observers, parts.estimator) = (prefilter, observers, estimator);
        (parts.drive_curve, parts.corrections) = (drive_curve, corrections);
        parts.projection = projection;
    };
    let controller = sampled.controller.with(change).map_err(counterpoise_synth::Error::from)?;
    let hub_angle_rad = modelled.linear.equilibrium.point.hub_angle_rad;
    let plant = attach_sensors(plant, &modelled.parameters, hub_angle_rad)?;
    Ok(SampledLoop { certified: sampled.certified, ..check_sampled_loop(&plant, controller, sampling)? })
}

/// Returns the projection of heave and surge across the beam, where the machine has both accelerometers and the design a feedforward of
/// heave. The angle is that of the resolver, or of the loop's own sensor; without either it stays that of the design. With a gyroscope on
/// the platform its pitch angle is added, so that the angle is inertial.
fn projection(asked: &DesignRequest, modelled: &PlantModel) -> Option<Projection> {
    let sensors = &modelled.parameters.sensors;
    sensors.surge_accelerometer.as_ref()?;
    asked.specification.heave.as_ref()?;
    let angle_reading = match (&sensors.hub_resolver, sensors.measured.is_position()) {
        (Some(_), _) => Some(HUB_POSITION),
        (None, true) => Some(HUB_RATE),
        (None, false) => None,
    };
    let pitches = angle_reading.is_some() && sensors.platform_gyro.is_fitted();
    Some(Projection {
        design_angle_rad: modelled.linear.equilibrium.point.hub_angle_rad,
        angle_reading,
        pitch_washout_s: pitches.then_some(PITCH_WASHOUT_S),
    })
}

/// Returns what takes the known gain and bias of each sensor out of its reading, where the project asks for
/// it.
fn corrections(asked: &DesignRequest, sensors: &Sensors) -> Vec<Correction> {
    if asked.options.sensor_errors == Compensation::Absent {
        return Vec::new();
    }
    let fitted = [
        Some(&sensors.hub_gyro),
        Some(&sensors.platform_gyro),
        Some(&sensors.platform_accelerometer),
        sensors.motor_tachometer.as_ref(),
        sensors.hub_resolver.as_ref(),
        sensors.surge_accelerometer.as_ref().filter(|_| asked.specification.heave.is_some()),
    ];
    let wrong = |sensor: &Sensor| sensor.gain != 0.0 && (sensor.gain != 1.0 || sensor.bias != 0.0);
    let each = fitted.into_iter().enumerate().filter_map(|(i, sensor)| {
        let sensor = sensor.filter(|sensor| wrong(sensor))?;
        let (gain, offset) = (1.0 / sensor.gain, -sensor.bias / sensor.gain);
        // The first reading is the demand: no sensor.
        Some(Correction { reading: i + 1, gain, offset })
    });
    each.collect()
}

/// Returns the controller with the limits of its readings, which the sensors' scales give.
///
/// # Errors
/// Those of the controller.
pub(crate) fn with_reading_limits(
    sampled: SampledLoop,
    sensors: &Sensors,
) -> Result<SampledLoop, PipelineError> {
    let change = |parts: &mut Parts| parts.reading_limits = reading_limits(sensors, parts.reading_limits);
    let controller = sampled.controller.with(change).map_err(counterpoise_synth::Error::from)?;
    Ok(SampledLoop { controller, ..sampled })
}

/// Returns the largest good readings: [`BEYOND_FULL_SCALE`] times what a fitted sensor gives at its converter's end. The demand
/// has the scale of the hub gyroscope. `usual` stays if no sensor is fitted.
fn reading_limits(sensors: &Sensors, usual: [f64; READINGS]) -> [f64; READINGS] {
    let fitted = [
        Some(&sensors.hub_gyro),
        Some(&sensors.hub_gyro),
        Some(&sensors.platform_gyro),
        Some(&sensors.platform_accelerometer),
        sensors.motor_tachometer.as_ref(),
        sensors.hub_resolver.as_ref(),
        sensors.surge_accelerometer.as_ref(),
    ];
    std::array::from_fn(|i| match fitted[i] {
        Some(sensor) if sensor.scale_v_unit != 0.0 => {
            BEYOND_FULL_SCALE * CONVERTER_RANGE_V / sensor.scale_v_unit.abs()
        }
        _ => usual[i],
    })
}

fn prefilter(asked: &DesignRequest, sampling: &Sampling) -> Result<Option<StateSpace>, PipelineError> {
    let Some(weight) = &asked.options.prefilter else { return Ok(None) };
    Ok(Some(c2d(&weight.realise()?, sampling.period_s, sampling.method.conversion())?))
}

/// Observers of the friction at motor and pivot: as identified, or the plant's.
fn observers(asked: &ObserverOptions, p: &Parameters) -> Result<Vec<FrictionObserver>, PipelineError> {
    let follow = |name: &str, side: FrictionSide, given: &Option<Friction>, of_plant: &Friction| match given {
        Some(own) => observer_friction(name, side, own, ObserverFriction::OwnLaw, asked.sign_rate_rad_s),
        None => observer_friction(name, side, of_plant, asked.model, asked.sign_rate_rad_s),
    };
    let pivot = follow("friction_pivot", FrictionSide::Load, &asked.pivot, &p.pivot_friction);
    let motor = follow("friction_motor", FrictionSide::Motor, &asked.motor, &p.motor_friction);
    let identified: Vec<ObservedFriction> = pivot.into_iter().chain(motor).collect();
    let drive = Drive { ratio: p.gearbox.ratio, stall_nm_v: torque_per_volt(p) };
    // A level that is learnt has its own share.
    let share = if asked.learning.is_some() { 1.0 } else { asked.share };
    Ok(friction_observers(&identified, drive, asked.drives, share)?)
}

/// Returns the learning of the level that observers of the whole friction have.
fn level_learning(
    asked: options::LevelLearning,
    share: f64,
    observers: &[FrictionObserver],
) -> LevelLearning {
    let volts = observers.iter().map(|observer| observer.volts_per_nm.abs() * observer.coulomb_nm).sum();
    LevelLearning {
        lowest: asked.lowest,
        highest: asked.highest,
        cancelled: share,
        gain_per_s: asked.time_constant_s.recip(),
        volts,
        sliding_rate_rad_s: asked.sliding_rate_rad_s,
        rate_scale_rad_s: SLIDING_RATES_AS_ONE * asked.sliding_rate_rad_s,
    }
}

/// Returns the estimator of the out-of-balance.
pub(crate) fn estimator(
    adaptation: &AdaptationOptions,
    modelled: &PlantModel,
    observer: Option<&ObserverOptions>,
) -> Estimator {
    let p = &modelled.parameters;
    let volts = 1.0 / torque_per_volt(p);
    let mean = adaptation.method == AdaptationMethod::WindowedMean;
    let band = hold_band(adaptation);
    let holds = band > 0.0;
    // the first estimates rest on few samples: until the memory is full they would leave the band for no reason
    let hold_s = if holds { adaptation.memory_s } else { 0.0 };
    Estimator {
        learning: learning(adaptation, modelled, observer),
        gravity_m_s2: p.gravity_m_s2,
        rate: PathSignal::RelativeRate,
        half_rate_rad_s: adaptation.half_rate_rad_s,
        volts_per_kg_m_s2: volts,
        rate_limit_kg_m_s: if mean { f64::INFINITY } else { adaptation.rate_limit_kg_m_s },
        hold_band_kg_m: band * modelled.plant.body().out_of_balance_kg_m.abs(),
        follow_samples: (FOLLOWED_MEMORIES * hold_s / p.interface.sample_period_s).round() as u32,
        hold_samples: (hold_s / p.interface.sample_period_s).round() as u32,
    }
}

/// Returns the share of the design's out-of-balance within which the estimate is not followed, as stated or the usual one; 0 for a method that has none.
pub(crate) fn hold_band(adaptation: &AdaptationOptions) -> f64 {
    match adaptation.method {
        AdaptationMethod::Recursive => adaptation.hold_band.unwrap_or(HOLD_BAND),
        AdaptationMethod::Gradient | AdaptationMethod::WindowedMean => 0.0,
    }
}

fn learning(
    adaptation: &AdaptationOptions,
    modelled: &PlantModel,
    observer: Option<&ObserverOptions>,
) -> Learning {
    let p = &modelled.parameters;
    let volts = 1.0 / torque_per_volt(p);
    let moment = modelled.plant.body().out_of_balance_kg_m.abs().max(SMALL_KG_M);
    let (ratio, period_s) = (p.gearbox.ratio, p.interface.sample_period_s);
    match adaptation.method {
        AdaptationMethod::Gradient => {
            let dry = dry_nm(p);
            let viscous =
                p.pivot_friction.viscous_nm_s_rad + ratio * ratio * p.motor_friction.viscous_nm_s_rad;
            Learning::Gradient {
                step: adaptation.step,
                scale: [moment, dry, viscous].map(|size| size * volts),
            }
        }
        AdaptationMethod::WindowedMean => {
            Learning::Mean { window_samples: (adaptation.window_s / period_s).round() as u32 }
        }
        AdaptationMethod::Recursive => Learning::Squares {
            forget: (-period_s / adaptation.memory_s).exp(),
            dead_band_m_s2: dead_band_m_s2(adaptation, modelled, observer),
            deviation: [moment * volts, LOOSE, LOOSE, LOOSE],
            filter_s: adaptation.filter_s,
            inertia_v_s2_rad: inertia_v_s2_rad(modelled),
        },
    }
}

/// Returns the dry friction of pivot and motor on the hub, N m.
fn dry_nm(p: &Parameters) -> f64 {
    p.pivot_friction.coulomb_nm() + p.gearbox.ratio * p.motor_friction.coulomb_nm()
}

/// Returns the RMS of the platform's acceleration below which the estimate stands still: as the project states it, or where the torque of the
/// out-of-balance is so small against dry friction that knowing it better does not lower the hub rate.
pub(crate) fn dead_band_m_s2(
    adaptation: &AdaptationOptions,
    modelled: &PlantModel,
    observer: Option<&ObserverOptions>,
) -> f64 {
    let p = &modelled.parameters;
    let moment = modelled.plant.body().out_of_balance_kg_m.abs();
    let [with_gravity, without] = LEAST_UNOBSERVED;
    let (hidden, least) = if p.gravity_m_s2 == 0.0 {
        (LEAST_TORQUE_WITHOUT_GRAVITY, without)
    } else {
        (LEAST_TORQUE_OVER_FRICTION, with_gravity)
    };
    let share = hidden * observer.map_or(1.0, |observer| (1.0 - observer.share).max(least));
    let hidden = if moment > 0.0 { share * dry_nm(p) / moment } else { 0.0 };
    adaptation.dead_band_m_s2.unwrap_or(hidden.max(LEAST_DEAD_BAND_M_S2))
}

/// Returns volts that accelerate the hub with its structure, and the motor on the platform, by 1 rad/s^2 of
/// the hub.
pub(crate) fn inertia_v_s2_rad(modelled: &PlantModel) -> [f64; 2] {
    let p = &modelled.parameters;
    let volts = 1.0 / torque_per_volt(p);
    [modelled.plant.body().inertia_kg_m2 * volts, p.motor.inertia_kg_m2 * p.gearbox.ratio.powi(2) * volts]
}

/// Returns the inverse of the amplifier's measured curve: (volts of a linear amplifier, control), rising, from its
/// positive points. A point that would make a stretch steeper or shorter than the measurement can tell is left out.
pub(crate) fn drive_curve(map: &[MapPoint], gain_a_v: f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> =
        map.iter().map(|point| [point.current_a / gain_a_v, point.input_v]).filter(|p| p[1] > 0.0).collect();
    points.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let most = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut from = [0.0, 0.0];
    for point in points {
        let step = [point[0] - from[0], point[1] - from[1]];
        if step[0] > SHORTEST_STRETCH_SHARE * most && step[0] > LEAST_SLOPE * step[1] && step[1] > 0.0 {
            kept.push(point);
            from = point;
        }
    }
    kept
}
