//! The values that a project file leaves open, at the worst that is usual, for a first design to hold.
//!
//! A transmission whose stiffness is not stated is rigid in model and simulator, and a sensor has neither noise nor lag. A loop that is as quick as they allow may be
//! unstable, or drown in noise, on the machine. So the loop must hold the machine with the softest transmission and the latest sensor that are usual, and its
//! control must bear the noise and the steps of a usual sensor. A control whose delay is not stated acts at once in model and simulator, and up to a
//! sample later on the machine: the loop keeps its margins with that delay too. Other ranges are covered otherwise: damping by the modes that are taken as half as damped, the
//! ten percent of a back-EMF by the margins; what is known within decades, such as the torque at full control, by the ceiling of the
//! bandwidth.

use counterpoise_lti::{pade, series};
use counterpoise_models::parameters::Transmission;
use counterpoise_models::{AxisKind, FeedbackSignal, IDEAL_CONVERTER_BITS, Parameters};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::{Assumption, LATEST_USUAL_READING_S, Project};
use counterpoise_synth::{DesignPlant, LateReading, Unknown, UsualReading};

use super::with_angles;
use crate::synth::design_plant;
use crate::tolerance::WHOLE_SAMPLES;
use crate::{PipelineError, build_plant_model, reduce_plant};

/// Last parts of the keys whose values set modes.
const MODES: [&str; 2] = ["stiffness", "bulk_modulus"];
/// Last parts of the keys that state the step of a reading, and whether a low number means a large step.
const STEPS: [(&str, bool); 2] = [("counts", true), ("resolution", false)];
/// Noise density of a gyroscope of which nothing is known, rad/s over the root of a hertz: 0.01 degrees a second, as the data sheets of most
/// micromechanical gyroscopes state it. Fibre-optic and ring laser gyroscopes are a hundred times quieter.
const GYROSCOPE_NOISE: f64 = 1.7e-4;
/// Shares of the inertia at the hub that the rotor of a transmission usually has, seen through it: a tenth, up to the half that a motor chosen for the largest acceleration
/// has.
const USUAL_ROTORS: [f64; 2] = [0.1, 0.5];
/// Key of the rotor's inertia.
const ROTOR_INERTIA: &str = "plant.motor.inertia";
/// Key of the delay of the control.
const CONTROL_DELAY: &str = "plant.interface.output_delay_samples";
/// Key of the delay of a drive that controls its current.
const DRIVE_DELAY: &str = "plant.drive.delay";
/// Order of the approximation of a delay that is usual: its phase is right to 1e-5 rad up to the inverse of the delay.
const DELAY_ORDER: usize = 3;

/// Returns the key of a project that states what is not known.
pub fn unknown_key(project: &Project, fact: Unknown) -> String {
    match fact {
        Unknown::Structure => project.key_of_stiffness(),
        Unknown::Noise => project.key_of_loop_sensor("noise"),
        Unknown::Sensor => project.key_of_loop_sensor("delay"),
        Unknown::Delay => CONTROL_DELAY.to_owned(),
        Unknown::Demand => "verify.step.rate".to_owned(),
        Unknown::DriveLimit => "plant.drive.limit".to_owned(),
    }
}

/// The values that a project leaves open.
pub(super) struct OpenValues {
    assumptions: Vec<Assumption>,
    /// Latest reading that is usual for the loop's sensor, s.
    latest_usual_reading_s: f64,
    /// The facts of which the file states that there is nothing: they are not open.
    known_absent: Vec<Unknown>,
}

impl OpenValues {
    /// Lists what a project leaves open.
    pub fn of(project: &Project) -> Self {
        let sensor = |key: &str| project.key_of_loop_sensor(key);
        let facts = [
            (Unknown::Delay, CONTROL_DELAY.to_owned()),
            (Unknown::Sensor, sensor("delay")),
            (Unknown::Noise, sensor("noise")),
        ];
        let stated = facts.into_iter().filter(|(_, key)| project.stated_defaults.contains(key));
        let mut known_absent: Vec<Unknown> = stated.map(|(fact, _)| fact).collect();
        let assumptions = project.assumptions();
        let states_rigid = project.stated_defaults.iter().any(|key| MODES.contains(&last_part(key)));
        // Of one body the file may assume that it is rigid, without a range.
        let is_open = |open: &Assumption| MODES.contains(&last_part(&open.key)) && open.usual.is_some();
        if states_rigid && !assumptions.iter().any(is_open) {
            known_absent.push(Unknown::Structure);
        }
        let delay = assumptions.iter().find(|assumption| assumption.key == sensor("delay"));
        let usual = delay.and_then(|assumption| assumption.usual);
        let latest_usual_reading_s = usual.map_or(LATEST_USUAL_READING_S, |[_, latest]| latest);
        Self { assumptions, latest_usual_reading_s, known_absent }
    }

    /// Returns the plants at the ends of the usual ranges of what is left open, given the plant as it is modelled. A plant that cannot be built is left out.
    ///
    /// # Errors
    /// Those of the approximation of a delay.
    pub fn plants_at_ends(
        &self,
        project: &Project,
        asked: &DesignRequest,
        nominal: &BothPlants,
    ) -> Result<PlantsAtEnds, PipelineError> {
        let of_modes =
            self.assumptions.iter().filter(|assumption| MODES.contains(&last_part(&assumption.key)));
        let ends = of_modes.flat_map(|assumption| {
            let ends = assumption.usual.into_iter().flatten();
            ends.filter(|end| end.is_finite() && *end != assumption.value).map(|end| (&assumption.key, end))
        });
        let machines = with_usual_rotors(project);
        let at_end = |(key, value): (&String, f64)| -> Vec<BothPlants> {
            machines.iter().filter_map(|machine| plant_with(machine, asked, key, value)).collect()
        };
        let ends: Vec<BothPlants> = ends.flat_map(at_end).collect();
        let of_form = |form: fn(&BothPlants) -> &DesignPlant| {
            self.with_usual_delays(&project.plant, form(nominal), ends.iter().map(form))
        };
        Ok(PlantsAtEnds {
            as_designed: of_form(|plants| &plants.as_designed)?,
            with_angles: of_form(|plants| &plants.with_angles)?,
        })
    }

    /// Returns the plant whose control acts later by what is usual, if the delay of the control or that of its drive is not stated.
    ///
    /// # Errors
    /// Those of the sensor.
    pub fn plants_with_delay(
        &self,
        machine: &Parameters,
        nominal: &DesignPlant,
    ) -> Result<Vec<DesignPlant>, PipelineError> {
        match self.open_control_samples(machine) {
            0 => Ok(Vec::new()),
            samples => Ok(vec![delay_control(nominal, machine, samples)?]),
        }
    }

    /// Returns the samples by which the control and its drive usually act later than is stated: each of the two delays is open by itself.
    fn open_control_samples(&self, machine: &Parameters) -> usize {
        let latest = |key: &str| {
            let open = self.assumptions.iter().find(|open| open.key == key);
            open.and_then(|open| open.usual).map_or(0.0, |[_, latest]| latest)
        };
        let of_drive = latest(DRIVE_DELAY) / machine.interface.sample_period_s;
        (latest(CONTROL_DELAY) + (of_drive - WHOLE_SAMPLES).ceil().max(0.0)) as usize
    }

    /// Returns the step of a reading that is known, in the measured unit; 0 if none is.
    pub fn known_step(&self, plant: &Parameters) -> f64 {
        let sensor = &plant.sensors.hub_gyro;
        if sensor.resolution > 0.0 {
            return if self.usual_step(plant) > 0.0 { 0.0 } else { sensor.resolution };
        }
        // The steps of an ideal converter say nothing of the real one.
        match plant.interface.input_bits {
            ..IDEAL_CONVERTER_BITS => plant.interface.converter_step(sensor),
            _ => 0.0,
        }
    }

    /// Returns what is known to be absent.
    pub fn known_absent(&self) -> Vec<Unknown> {
        self.known_absent.clone()
    }

    /// Returns noise and step that are usual for the sensor of the loop where the file states neither.
    pub fn usual_reading(&self, plant: &Parameters) -> UsualReading {
        let is_gyroscope =
            plant.sensors.measured == FeedbackSignal::HubRate && plant.axis == AxisKind::Rotary;
        let nyquist_hz = 0.5 / plant.interface.sample_period_s;
        let noise_rms = if is_gyroscope { GYROSCOPE_NOISE * nyquist_hz.sqrt() } else { 0.0 };
        UsualReading { noise_rms, step: self.usual_step(plant) }
    }

    /// The largest usual step of a digital sensor whose resolution is not stated, in the measured unit; 0 if it is stated.
    fn usual_step(&self, plant: &Parameters) -> f64 {
        let step = |assumption: &Assumption| {
            let [low, high] = assumption.usual?;
            let (_, falls) = STEPS.into_iter().find(|(key, _)| *key == last_part(&assumption.key))?;
            // The resolution is the step of the load: what is assumed over what is usual.
            let resolution = plant.sensors.hub_gyro.resolution;
            Some(if falls { resolution * assumption.value / low } else { high })
        };
        self.assumptions.iter().filter_map(step).fold(0.0, f64::max)
    }

    /// The delay that is usual for a sensor of which no lag is known, s.
    fn usual_delay_s(&self, plant: &Parameters) -> f64 {
        let reading = &plant.sensors.hub_gyro;
        let states_delay = reading.delay_s > 0.0 || self.known_absent.contains(&Unknown::Sensor);
        let knows_lag = reading.natural_frequency_rad_s.is_finite() || states_delay;
        match knows_lag {
            true => 0.0,
            false => self.latest_usual_reading_s,
        }
    }

    /// Returns plants that differ from the nominal one, then these and the nominal one with a usual delay of the reading, then all with one of the control,
    /// where no such delay is known.
    fn with_usual_delays<'a>(
        &self,
        machine: &Parameters,
        nominal: &DesignPlant,
        ends: impl Iterator<Item = &'a DesignPlant>,
    ) -> Result<Vec<DesignPlant>, PipelineError> {
        let mut plants: Vec<DesignPlant> = ends.filter(|plant| *plant != nominal).cloned().collect();
        let delay_s = self.usual_delay_s(machine);
        if delay_s > 0.0 {
            let late = plants.iter().chain([nominal]).map(|plant| delay_reading(plant, machine, delay_s));
            let late = late.collect::<Result<Vec<_>, _>>()?;
            plants.extend(late);
        }
        let samples = self.open_control_samples(machine);
        if samples > 0 {
            let delayed = plants.iter().map(|plant| delay_control(plant, machine, samples));
            let delayed = delayed.collect::<Result<Vec<_>, _>>()?;
            plants.extend(delayed);
        }
        Ok(plants)
    }
}

fn last_part(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// Returns a plant whose readings come later.
fn delay_reading(
    plant: &DesignPlant,
    machine: &Parameters,
    delay_s: f64,
) -> Result<DesignPlant, PipelineError> {
    let known = plant.late_reading.clone();
    let (dynamics, known_s) = match known {
        Some(reading) => (reading.dynamics, reading.delay_s),
        None => (machine.sensors.hub_gyro.dynamics()?, 0.0),
    };
    let dynamics = series(&dynamics, &pade(delay_s, DELAY_ORDER)?)?;
    Ok(DesignPlant { late_reading: Some(LateReading { dynamics, delay_s: known_s }), ..plant.clone() })
}

/// Returns a plant whose control acts some samples later: in a loop of one signal it does not matter where a delay is.
fn delay_control(
    plant: &DesignPlant,
    machine: &Parameters,
    samples: usize,
) -> Result<DesignPlant, PipelineError> {
    let late_reading = match plant.late_reading.clone() {
        Some(reading) => reading,
        None => LateReading { dynamics: machine.sensors.hub_gyro.dynamics()?, delay_s: 0.0 },
    };
    let delay_s = late_reading.delay_s + samples as f64 * machine.interface.sample_period_s;
    Ok(DesignPlant { late_reading: Some(LateReading { delay_s, ..late_reading }), ..plant.clone() })
}

/// A plant as the design takes it, and with the hub's angles among its states, where gravity's gradient and a spring act.
pub(super) struct BothPlants {
    pub as_designed: DesignPlant,
    pub with_angles: DesignPlant,
}

/// The plants at the ends of usual ranges, in both forms.
pub(super) struct PlantsAtEnds {
    pub as_designed: Vec<DesignPlant>,
    pub with_angles: Vec<DesignPlant>,
}

/// Returns the machine as it is, or, if a transmission drives it from a rotor of which nothing is known, with a part of its inertia in that rotor: a transmission that
/// yields shows only between two inertias.
fn with_usual_rotors(project: &Project) -> Vec<Project> {
    let plant = &project.plant;
    let is_known = plant.motor.inertia_kg_m2 > 0.0 || project.stated_defaults.contains(ROTOR_INERTIA);
    let transmits = plant.gearbox.kind != Transmission::Direct && plant.cylinder.is_none();
    let Some(lumped) = plant.lumped.as_ref().filter(|_| transmits && !is_known) else {
        return vec![project.clone()];
    };
    let with_share = |share: f64| {
        let mut split = project.clone();
        let rotor = share * lumped.hub_inertia_kg_m2;
        split.plant.motor.inertia_kg_m2 = rotor / (plant.gearbox.ratio * plant.gearbox.ratio);
        if let Some(own) = &mut split.plant.lumped {
            own.hub_inertia_kg_m2 -= rotor;
        }
        split
    };
    USUAL_ROTORS.map(with_share).to_vec()
}

/// Returns the plants of the design with a value of the file changed; `None` if there are none.
fn plant_with(project: &Project, asked: &DesignRequest, key: &str, value: f64) -> Option<BothPlants> {
    let changed = project.with_number(key, value)?;
    let made = build_plant_model(&changed).ok()?;
    let as_designed = design_plant(asked, &made, &reduce_plant(&changed, &made).ok()?).ok()?;
    let with_angles = with_angles(&changed, &made, &as_designed).ok()?;
    Some(BothPlants { as_designed, with_angles })
}
