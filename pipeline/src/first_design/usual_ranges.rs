//! The values that a project file leaves open, at the worst that is usual, for a first design to hold.
//!
//! A transmission whose stiffness is not stated is rigid in model and simulator, and a sensor has neither noise nor lag. A loop that is as quick as they allow may be
//! unstable, or drown in noise, on the machine. So the loop must hold the machine with transmissions and joints from the softest that are usual to rigid ones, with the
//! least damping and with the lags that are usual (`usual_lags`), and its
//! control must bear the noise and the steps of a usual sensor. Other ranges are covered otherwise: the
//! ten percent of a back-EMF by the margins; what is known within decades, such as the torque at full control, by the ceiling of the
//! bandwidth.

use crate::tolerance::NEXT_STIFFNESS;
use std::f64::consts::FRAC_PI_2;

use counterpoise_lti::poles;
use counterpoise_models::parameters::Transmission;
use counterpoise_models::{
    AmplifierDynamics, AxisKind, FeedbackSignal, IDEAL_CONVERTER_BITS, Parameters, Sensor,
};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::{Assumption, Project};
use counterpoise_synth::{DesignPlant, Unknown, UsualPlants, UsualReading};

use super::usual_lags::{CONTROL_DELAY, UsualLags};
use super::with_angles;
use crate::synth::design_plant;
use crate::{PipelineError, build_plant_model, reduce_plant};

/// Last parts of the keys whose values set modes.
const MODES: [&str; 2] = ["stiffness", "bulk_modulus"];
/// Last part of the keys whose values set modes up to rigid ones.
const STIFFNESS: &str = "stiffness";
/// Last parts of the keys whose values damp modes.
const DAMPING: [&str; 2] = ["damping", "modal_damping"];
/// Keys of the lags of a drive that takes a voltage, at the ends of their ranges.
const LAGS_OF_DRIVE: [&str; 3] =
    ["plant.motor.inductance", "plant.drive.time_constant", "plant.amplifier.time_constant"];
/// Stiffnesses from the softest that is usual to one whose mode the clock hides, at most. A collocated loop is limited by a mode near its bandwidth more than
/// by the softest.
const MOST_STIFFNESSES: usize = 4;
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
        let is_open = |open: &Assumption| MODES.contains(&last_part(&open.key)) && open.usual.is_some();
        if states_rigid && !assumptions.iter().any(is_open) {
            known_absent.push(Unknown::Structure);
        }
        Self { assumptions, known_absent }
    }

    /// Returns the plants at the worst that is usual for what is left open, given the plant as it is modelled. A plant that cannot be built is left out.
    ///
    /// # Errors
    /// Those of the lags.
    pub fn usual_plants(
        &self,
        project: &Project,
        asked: &DesignRequest,
        nominal: &BothPlants,
    ) -> Result<UsualPlants, PipelineError> {
        let lags = UsualLags::of(project, &self.assumptions);
        let undamped = with_least_damping(project);
        let machine = undamped.as_ref().unwrap_or(project);
        let slow = undamped.as_ref().and_then(|machine| plants_of(machine, asked));
        let at_ends = self.plants_at_ends(machine, asked);
        let mut plants = vec![(slow.clone(), at_ends, UsualLags::NONE)];
        if lags.has_reading_lags() {
            plants.push((slow.clone(), plants[0].1.clone(), lags.reading_lags()));
        }
        let lagging = self.with_lagging_drive(machine);
        if lags.has_control_lags() || lagging.is_some() {
            let at_ends = lagging.as_ref().map(|machine| self.plants_at_ends(machine, asked));
            let own = lagging.as_ref().and_then(|machine| plants_of(machine, asked));
            let at_ends = at_ends.unwrap_or_else(|| plants[0].1.clone());
            plants.push((own.or(slow), at_ends, lags));
        }
        let mut usual = UsualPlants::default();
        for (own, at_ends, lags) in plants {
            let late = |plant: &DesignPlant| lags.late_plant(plant, &project.plant);
            for plants in &at_ends {
                usual.within_ranges.push(late(&plants.as_designed)?);
                usual.others_at_ends.push(late(&plants.with_angles)?);
            }
            let own = own.as_ref().unwrap_or(nominal);
            if lags.is_none() && own == nominal {
                continue;
            }
            usual.others_at_ends.push(late(&own.with_angles)?);
            usual.with_lags.push(late(&own.as_designed)?);
        }
        Ok(usual)
    }

    /// Returns the plants of a machine at the ends of the usual ranges of what sets modes.
    fn plants_at_ends(&self, machine: &Project, asked: &DesignRequest) -> Vec<BothPlants> {
        let machines = with_usual_rotors(machine);
        let mut found = Vec::new();
        for open in self.assumptions.iter().filter(|open| MODES.contains(&last_part(&open.key))) {
            for machine in &machines {
                let at = |value: f64| plants_of(&with_least_damping_at(machine, &open.key, value)?, asked);
                let ends = open.usual.into_iter().flatten();
                let ends = ends.filter(|end| end.is_finite() && *end != open.value);
                let ends: Vec<(f64, BothPlants)> =
                    ends.filter_map(|value| Some((value, at(value)?))).collect();
                let stiffer = match ends.first() {
                    Some((softest, plants)) if last_part(&open.key) == STIFFNESS => {
                        stiffer_values(*softest, plants, machine)
                    }
                    _ => Vec::new(),
                };
                found.extend(ends.into_iter().map(|(_, plants)| plants));
                found.extend(stiffer.into_iter().filter_map(at));
            }
        }
        found
    }

    /// Returns the machine with the lags of a drive that takes a voltage at the ends of their usual ranges; `None` if none is open.
    fn with_lagging_drive(&self, machine: &Project) -> Option<Project> {
        if machine.plant.amplifier.dynamics != AmplifierDynamics::Modelled {
            return None;
        }
        // A drive that takes a voltage has become an amplifier, whose keys are not those that the file states.
        let states = |key: &str| match key.strip_prefix("plant.amplifier.") {
            Some(key) => machine.stated_defaults.contains(&format!("plant.drive.{key}")),
            None => false,
        };
        let open = self.assumptions.iter().filter(|open| LAGS_OF_DRIVE.contains(&open.key.as_str()));
        let open = open.filter(|open| !states(&open.key));
        let ends = open.filter_map(|open| Some((&open.key, open.usual?[1])));
        ends.fold(None, |lagging: Option<Project>, (key, end)| {
            let changed = lagging.as_ref().unwrap_or(machine).with_number(key, end);
            changed.or(lagging)
        })
    }

    /// Returns the step of a reading that is known, in the measured unit; 0 if none is.
    pub fn known_step(&self, plant: &Parameters) -> f64 {
        let sensor = &plant.sensors.hub_gyro;
        if sensor.resolution > 0.0 {
            return if self.usual_step(plant) > 0.0 { 0.0 } else { plant.interface.reading_step(sensor) };
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
            // What is stated is the step of the load: what is assumed over what is usual.
            let sensor = &plant.sensors.hub_gyro;
            let resolution = if falls { sensor.resolution * assumption.value / low } else { high };
            Some(plant.interface.reading_step(&Sensor { resolution, ..sensor.clone() }))
        };
        self.assumptions.iter().filter_map(step).fold(0.0, f64::max)
    }
}

fn last_part(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// A plant as the design takes it, and with the hub's angles among its states, where gravity's gradient and a spring act.
#[derive(Clone, PartialEq)]
pub(super) struct BothPlants {
    pub as_designed: DesignPlant,
    pub with_angles: DesignPlant,
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

/// Returns the machine with every damping that is left open at its lowest usual value; `None` if none is open.
fn with_least_damping(machine: &Project) -> Option<Project> {
    let open = machine.assumptions();
    let open = open.iter().filter(|open| DAMPING.contains(&last_part(&open.key)));
    let lowest = open.filter_map(|open| Some((&open.key, open.usual?[0], open.value)));
    let lowest = lowest.filter(|(_, low, value)| low < value);
    lowest.fold(None, |changed: Option<Project>, (key, low, _)| {
        let lower = changed.as_ref().unwrap_or(machine).with_number(key, low);
        lower.or(changed)
    })
}

/// Returns the machine with another value, and every damping that is left open at its lowest usual value; `None` if there is none.
fn with_least_damping_at(machine: &Project, key: &str, value: f64) -> Option<Project> {
    let changed = machine.with_number(key, value)?;
    Some(with_least_damping(&changed).unwrap_or(changed))
}

/// Returns stiffnesses between the softest, whose plants are known, and one whose mode the clock hides.
fn stiffer_values(softest: f64, plants: &BothPlants, machine: &Project) -> Vec<f64> {
    let Ok(found) = poles(&plants.as_designed.system) else { return Vec::new() };
    let modes = found.iter().filter(|pole| pole.im > 0.0 && pole.re.abs() < 0.5 * pole.norm());
    let slowest = modes.map(|pole| pole.norm()).fold(f64::INFINITY, f64::min);
    // A quarter of the sample rate.
    let highest = FRAC_PI_2 / machine.plant.interface.sample_period_s;
    if slowest.is_infinite() || slowest * NEXT_STIFFNESS > highest {
        return Vec::new();
    }
    let steps = ((highest / slowest).ln() / NEXT_STIFFNESS.ln()).ceil();
    let steps = (steps as usize).clamp(1, MOST_STIFFNESSES - 1);
    let factor = (highest / slowest).powf(2.0 / steps as f64);
    (1..=steps).map(|k| softest * factor.powi(k as i32)).collect()
}

/// Returns the plants of a machine whose hystereses have not yielded: small motions bend their stiffness beside that of the compliance. `None` if the machine has no
/// hysteresis.
pub(super) fn plants_at_small_motions(machine: &Project, asked: &DesignRequest) -> Option<BothPlants> {
    let mut small = machine.clone();
    if small.plant.gearbox.hysteresis_nm > 0.0 {
        small.plant.gearbox.stiffness_nm_rad += small.plant.gearbox.hysteresis_stiffness_nm_rad;
    }
    if let Some(lumped) = small.plant.lumped.as_mut().filter(|lumped| lumped.hysteresis_nm > 0.0) {
        lumped.position_stiffness_nm_rad += lumped.hysteresis_stiffness_nm_rad;
    }
    if small == *machine { None } else { plants_of(&small, asked) }
}

/// Returns the plants of the design of a machine; `None` if there are none.
fn plants_of(machine: &Project, asked: &DesignRequest) -> Option<BothPlants> {
    let made = build_plant_model(machine).ok()?;
    let as_designed = design_plant(asked, &made, &reduce_plant(machine, &made).ok()?).ok()?;
    let with_angles = with_angles(machine, &made, &as_designed).ok()?;
    Some(BothPlants { as_designed, with_angles })
}
