//! The plant as the design sees it, and how the controller is sampled.

use counterpoise_lti::delay::pade;
use counterpoise_lti::{StateSpace, series};
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::{CONVERTER_RANGE_V, Parameters, ReadingDelay, Sensor, Sensors};
use counterpoise_synth::cascade::difference_lag;
use counterpoise_synth::{DesignPlant, LateReading, RateLoop, Sampling};

use crate::model::cannot_carry;
use crate::{PipelineError, PlantModel, ReducedPlant};
use counterpoise_project::resolve::synthesis::{DesignRequest, LoopKind};
use counterpoise_project::resolve::synthesis_options::Compensation;

/// Returns the plant as the design sees it: the reduced plant, the sensors, the loop's delay.
pub fn design_plant(
    asked: &DesignRequest,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> Result<DesignPlant, PipelineError> {
    let sensors = design_sensors(asked, &modelled.parameters.sensors);
    let delays = SensorDelays {
        period_s: modelled.parameters.interface.sample_period_s,
        pade_order: asked.pade_order,
    };
    let plant = DesignPlant {
        system: reduced.system.clone(),
        control: LinearPlant::CONTROL,
        heave: vec![LinearPlant::HEAVE],
        pitch: vec![LinearPlant::PITCH_RATE],
        rate: modelled.linear.measured,
        hub_sensor: Some(delays.reading_of(&sensors.hub_gyro)?),
        late_reading: delays.late_reading(&sensors.hub_gyro)?,
        heave_sensor: Some(delays.heave_sensor(
            &sensors,
            sensors.share_of_heave(modelled.linear.equilibrium.point.hub_angle_rad),
        )?),
        pitch_sensor: Some(delays.reading_of(&sensors.platform_gyro)?),
        delay_s: asked.delay_samples * modelled.parameters.interface.sample_period_s,
        pade_order: asked.pade_order,
        rate_loop: None,
    };
    let rate_loop = rate_loop(asked, modelled, &plant)?.map(Box::new);
    Ok(DesignPlant { rate_loop, ..plant })
}

/// Returns the inner loop of a cascade: its sensor is that of the position, with the lag of the difference of two
/// readings.
fn rate_loop(
    asked: &DesignRequest,
    modelled: &PlantModel,
    plant: &DesignPlant,
) -> Result<Option<RateLoop>, PipelineError> {
    let (LoopKind::Cascade, Some(linear)) = (asked.loop_kind, &modelled.rate) else { return Ok(None) };
    let period_s = modelled.parameters.interface.sample_period_s;
    let lag = difference_lag(period_s)?;
    let hub_sensor = match &plant.hub_sensor {
        Some(sensor) => series(sensor, &lag)?,
        None => lag,
    };
    let plant = DesignPlant {
        system: linear.system.clone(),
        rate: linear.measured,
        hub_sensor: Some(hub_sensor),
        late_reading: None,
        ..plant.clone()
    };
    Ok(Some(RateLoop { plant, period_s }))
}

/// The treatment of the delays of readings in a design: in whole samples of the controller, as a Padé approximation.
#[derive(Clone, Copy)]
struct SensorDelays {
    period_s: f64,
    /// Order of the approximation; 0 leaves the delays out.
    pade_order: usize,
}

impl SensorDelays {
    /// Returns a sensor's dynamics with its delay.
    fn reading_of(self, sensor: &Sensor) -> Result<StateSpace, PipelineError> {
        let ReadingDelay { samples, rest_s } = sensor.mean_delay(self.period_s);
        let delay_s = samples as f64 * self.period_s + rest_s;
        match self.pade_order {
            order if order > 0 && delay_s > 0.0 => Ok(series(&sensor.dynamics()?, &pade(delay_s, order)?)?),
            _ => Ok(sensor.dynamics()?),
        }
    }

    /// Returns what a sampled loop takes for a sensor whose readings are late; `None` if they are not.
    fn late_reading(self, sensor: &Sensor) -> Result<Option<LateReading>, PipelineError> {
        let delay = sensor.mean_delay(self.period_s);
        if delay.samples == 0 && delay.rest_s == 0.0 {
            return Ok(None);
        }
        let dynamics = series(&sensor.dynamics()?, &delay.dynamics_of_rest()?)?;
        Ok(Some(LateReading { dynamics, delay_s: delay.samples as f64 * self.period_s }))
    }

    /// Returns the accelerometer with its share of heave: on the elevated mass it reads what the out-of-balance feels, and so does the
    /// projection of two.
    fn heave_sensor(self, sensors: &Sensors, share: f64) -> Result<StateSpace, PipelineError> {
        let mut sensor = self.reading_of(&sensors.platform_accelerometer)?;
        (sensor.C, sensor.D) = (sensor.C.scale(share), sensor.D.scale(share));
        Ok(sensor)
    }
}

/// Returns the design plant with its sensors as they are: what a projection makes of them is part of the
/// controller.
pub(crate) fn attach_sensors(
    plant: &DesignPlant,
    parameters: &Parameters,
    hub_angle_rad: f64,
) -> Result<DesignPlant, PipelineError> {
    let sensors = &parameters.sensors;
    let delays =
        SensorDelays { period_s: parameters.interface.sample_period_s, pade_order: plant.pade_order };
    Ok(DesignPlant {
        hub_sensor: Some(delays.reading_of(&sensors.hub_gyro)?),
        late_reading: delays.late_reading(&sensors.hub_gyro)?,
        heave_sensor: Some(
            delays.heave_sensor(sensors, sensors.accelerometer_share_of_heave(hub_angle_rad))?,
        ),
        pitch_sensor: Some(delays.reading_of(&sensors.platform_gyro)?),
        ..plant.clone()
    })
}

/// Returns the sensors as the design takes them: where the controller undoes their errors, without.
pub(crate) fn design_sensors(asked: &DesignRequest, sensors: &Sensors) -> Sensors {
    let mut sensors = sensors.clone();
    if asked.options.sensor_errors == Compensation::Applied {
        let all = [&mut sensors.hub_gyro, &mut sensors.platform_gyro, &mut sensors.platform_accelerometer];
        all.into_iter().for_each(|sensor| sensor.gain = 1.0);
    }
    sensors
}

pub(crate) fn sampling(asked: &DesignRequest, modelled: &PlantModel) -> Result<Sampling, PipelineError> {
    if let Some(beyond) = cannot_carry(modelled) {
        return Err(beyond);
    }
    let p = &modelled.parameters;
    let moment = modelled.plant.body().out_of_balance_kg_m;
    let volts_per_nm = 1.0 / torque_per_volt(p);
    let bias_v_per_kg_m = p.gravity_m_s2 * volts_per_nm;
    let limit_v = p.amplifier.input_limit_v.min(CONVERTER_RANGE_V);
    let felt_m_s2 = if p.gravity_m_s2 == 0.0 { STANDARD_GRAVITY_M_S2 } else { p.gravity_m_s2 };
    let reach = limit_v / (volts_per_nm * felt_m_s2);
    if moment.abs() > reach {
        let needed_v = moment.abs() * volts_per_nm * felt_m_s2;
        return Err(PipelineError::CannotHold { moment_kg_m: moment, needed_v, limit_v });
    }
    Ok(Sampling {
        method: asked.discretisation,
        form: asked.form,
        delay_samples: p.interface.output_delay_samples,
        out_of_balance_kg_m: moment,
        out_of_balance_range_kg_m: (-reach, reach),
        bias_v_per_kg_m,
        transfer_time_s: asked.transfer_time_s,
        ..Sampling::new(p.interface.sample_period_s, limit_v)
    })
}

/// The acceleration that an out-of-balance is judged by where no gravity acts on it, m/s^2.
const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// Returns the torque at the stalled hub for one volt of control, N m/V.
pub(crate) fn torque_per_volt(p: &Parameters) -> f64 {
    p.gearbox.ratio * p.motor.torque_constant_nm_a * p.amplifier.stall_gain_a_v(&p.motor)
}
