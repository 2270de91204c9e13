//! The propagation through the linear loop of each source of the line of sight's error.
//!
//! - Heave, pitch and surge are the recorded motion, marched through the sampled linear loop.
//! - Roll and yaw, dry friction, backlash, ripple and recoil act as torques. Their torques in the run with all sources are marched through the linear
//!   loop as disturbances from outside: what the loop would make of them if they did not depend on its motion.
//! - Noise, drift and the steps of converters are propagated as densities: the mean square about the mean over a time T is
//!   `int S (1 - sinc^2(pi f T)) df`. A converter's step q is white noise of the variance q^2/12 (B. Widrow, 1956).
//!
//! Friction observers and estimators of the controller stand still in the linear loop. Viscous friction is part of it: what pitch makes through it
//! is pitch's here, and friction's where sources are switched. Gains of sensors that are wrong belong to the motion that they measure. Bending and the clock have no place in it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use counterpoise_controller::Controller;
use counterpoise_models::plant::{FrictionLinearisation, Plant, SinCos};
use counterpoise_models::{Drift, LoadPoint, Parameters, Ripple, Sensor};
use counterpoise_simulate::TimeHistory;
use counterpoise_simulate::tolerance::FLICKER_LONGEST_S;

use super::LinearContribution;
use super::sources::ErrorSource;
use crate::history::History;
use crate::line_of_sight::SightAngles;
use crate::linear_loop::closed_loop::resolver_use;
use crate::linear_loop::noise::{NoiseEntry, NoiseResponse, noise_responses};
use crate::linear_loop::{
    ClosedLoop, SampledPlant, arrange_controller, simulate_disturbance, surge::acting_arrangement,
};
use crate::sight_spectrum::{Bands, SightSpectrum};
use crate::tolerance::{MEAN_SERIES, SIGHT_POINTS_A_BAND};
use crate::{Arrangement, Error, HeaveAndPitch, LineOfSight, Procedure, Source};

/// The linear loop with what its noise makes.
pub struct Propagation<'a> {
    plant: &'a Plant,
    procedure: &'a Procedure,
    sight: LineOfSight,
    bands: &'a Bands,
    sampled: SampledPlant,
    closed: ClosedLoop,
    /// The loop as surge meets it.
    closed_for_surge: ClosedLoop,
    torqued: SampledPlant,
    closed_for_torques: ClosedLoop,
    grid: Grid,
    noise: Vec<NoiseResponse>,
}

/// Frequencies over which densities are summed.
struct Grid {
    frequency_hz: Vec<f64>,
    width_hz: Vec<f64>,
    /// The band of each.
    band: Vec<usize>,
}

impl Grid {
    /// Returns points that are even in the logarithm within each band. The lowest band is followed down to the slowest part of a flicker.
    fn of(bands: &Bands) -> Self {
        let mut grid = Self { frequency_hz: Vec::new(), width_hz: Vec::new(), band: Vec::new() };
        let lowest = 1.0 / (TAU * FLICKER_LONGEST_S.max(bands.duration_s()));
        for (band, edges) in bands.edges_hz.windows(2).enumerate() {
            let (from, decades) = (edges[0].max(lowest), (edges[1] / edges[0].max(lowest)).log10());
            let points = (SIGHT_POINTS_A_BAND * (1.0 + 16.0 * decades).floor()) as usize;
            let ratio = (edges[1] / from).powf(1.0 / points as f64);
            for k in 0..points {
                let (low, high) = (from * ratio.powi(k as i32), from * ratio.powi(k as i32 + 1));
                grid.frequency_hz.push((low * high).sqrt());
                grid.width_hz.push(high - low);
                grid.band.push(band);
            }
        }
        grid
    }
}

/// Noise of a reading or of the control.
struct Noise {
    entry: NoiseEntry,
    /// Constant error.
    bias: f64,
    /// Variance of what is white at the sample rate.
    variance: f64,
    drift: Drift,
}

impl Noise {
    /// Returns the one-sided density at a frequency. A random walk of the rate starts at 0 with the run: at `amid_s`, in the middle of the record, it
    /// has the variance K^2 `amid_s`, which is that of its density from 1/(2 pi^2 `amid_s`) on.
    fn density(&self, frequency_hz: f64, period_s: f64, amid_s: f64) -> f64 {
        let drift = &self.drift;
        let has_walked = 2.0 * PI * PI * amid_s * frequency_hz >= 1.0;
        let walk =
            if has_walked { 2.0 * (drift.rate_random_walk / (TAU * frequency_hz)).powi(2) } else { 0.0 };
        2.0 * (period_s * self.variance + drift.angle_random_walk.powi(2))
            + drift.bias_instability.powi(2) / (PI * frequency_hz)
            + walk
    }
}

impl<'a> Propagation<'a> {
    /// Returns the loop of a controller on the linearised plant; `None` if it is unstable.
    ///
    /// # Errors
    /// Those of the linearisation and of the controller.
    pub fn new(
        plant: &'a Plant,
        controller: &Controller,
        procedure: &'a Procedure,
        bands: &'a Bands,
    ) -> Result<Option<Self>, Error> {
        let (parameters, resolver) = (plant.parameters(), resolver_use(controller));
        // dry friction enters as a torque, so the linear plant has none
        let equilibrium = plant.equilibrium(&procedure.operating_point);
        let linear = plant.linearise(&equilibrium, FrictionLinearisation::Viscous, plant.angles())?;
        let sampled = SampledPlant::new(&linear, parameters, resolver)?;
        let torqued = SampledPlant::with_torque_inputs(&linear, parameters, resolver)?;
        let moment = controller.parts().design_out_of_balance_kg_m;
        let closed = ClosedLoop::new(&sampled, Some(controller), moment)?;
        if closed.pole_radius() >= 1.0 {
            return Ok(None);
        }
        let meets_surge =
            arrange_controller(controller, acting_arrangement(&sampled, Arrangement::Compensated))?;
        let closed_for_surge = ClosedLoop::new(&sampled, meets_surge.as_ref(), moment)?;
        let closed_for_torques = ClosedLoop::new(&torqued, Some(controller), moment)?;
        let grid = Grid::of(bands);
        let noise = noise_responses(&sampled, &closed, grid.frequency_hz.clone())?;
        let sight = procedure.line_of_sight.unwrap_or_default();
        Ok(Some(Self {
            plant,
            procedure,
            sight,
            bands,
            sampled,
            closed,
            closed_for_surge,
            torqued,
            closed_for_torques,
            grid,
            noise,
        }))
    }

    /// Returns what the loop makes of a source; `whole` is the run with all sources. `None` if the source has no place in a linear loop.
    ///
    /// # Errors
    /// Those of the march.
    pub fn of(&self, source: ErrorSource, whole: &TimeHistory) -> Result<Option<LinearContribution>, Error> {
        if let Some(angles) = self.angles(source, whole)? {
            return Ok(Some(LinearContribution {
                rad: angles.error(self.sight.exposure_s).values(),
                spectrum: self.bands.spectrum(&angles),
            }));
        }
        let noises = noises(source, self.plant.parameters());
        Ok(if noises.is_empty() { None } else { self.of_noise(&noises) })
    }

    /// Returns the angles that the loop makes of a source which moves the base or acts as a torque; `None` of every other source.
    ///
    /// # Errors
    /// Those of the march.
    pub fn angles(&self, source: ErrorSource, whole: &TimeHistory) -> Result<Option<SightAngles>, Error> {
        let history = match source {
            ErrorSource::Heave | ErrorSource::Pitch | ErrorSource::Surge => self.of_motion(source)?,
            ErrorSource::Roll | ErrorSource::Yaw => {
                self.of_torques(&self.gyroscopic_torques(source, whole))?
            }
            ErrorSource::Friction => self.of_torques(&Torques::of_friction(whole))?,
            ErrorSource::Backlash => self.of_torques(&self.gap_torques(whole))?,
            ErrorSource::Ripple => self.of_torques(&self.ripple_torques(whole))?,
            ErrorSource::Recoil => self.of_torques(&self.recoil_torques(whole))?,
            _ => return Ok(None),
        };
        let angles = SightAngles::of(&history, self.procedure.sight_settle_s());
        // the linear march may have one sample more than the run
        let samples = (self.bands.duration_s() / self.sampled.sample_period_s).round() as usize;
        Ok(angles.map(|angles| angles.first_samples(samples)))
    }

    fn of_motion(&self, source: ErrorSource) -> Result<History, Error> {
        let ran = if self.procedure.road.is_some() { Source::Road } else { Source::Both };
        let tangent = self.sampled.hub_angle_rad.tan();
        let road = self.procedure.road.as_ref();
        let motion = |time_s: f64| {
            let motion = self.procedure.motion(ran, time_s);
            let of_surge = || -tangent * road.map_or(0.0, |road| road.surge_at(time_s));
            match source {
                ErrorSource::Heave => HeaveAndPitch { pitch_rate_rad_s: 0.0, ..motion },
                ErrorSource::Pitch => HeaveAndPitch { heave_m_s2: 0.0, ..motion },
                _ => HeaveAndPitch { heave_m_s2: of_surge(), pitch_rate_rad_s: 0.0 },
            }
        };
        let closed = if source == ErrorSource::Surge { &self.closed_for_surge } else { &self.closed };
        let duration_s = self.procedure.duration_of(ran);
        simulate_disturbance(&self.sampled, closed, ran, Arrangement::Compensated, duration_s, motion)
    }

    fn of_torques(&self, torques: &Torques) -> Result<History, Error> {
        let period_s = self.sampled.sample_period_s;
        let at = |time_s: f64| {
            let k = (time_s / period_s).round() as usize;
            let torque = |all: &[f64]| all.get(k).copied().unwrap_or(0.0);
            // the torqued plant has the motor's torque at the input of heave, and the hub's at that of the pitch rate
            HeaveAndPitch { heave_m_s2: torque(&torques.motor_nm), pitch_rate_rad_s: torque(&torques.hub_nm) }
        };
        let duration_s = torques.motor_nm.len().saturating_sub(1) as f64 * period_s;
        let arrangement = Arrangement::Compensated;
        simulate_disturbance(
            &self.torqued,
            &self.closed_for_torques,
            Source::Both,
            arrangement,
            duration_s,
            at,
        )
    }

    fn of_noise(&self, noises: &[Noise]) -> Option<LinearContribution> {
        let mut sum = Densities::at_rest(self.bands.len());
        for noise in noises {
            let response = self.noise.iter().find(|response| response.entry == noise.entry)?;
            self.add_noise(noise, response, &mut sum);
        }
        Some(sum.contribution())
    }

    fn add_noise(&self, noise: &Noise, response: &NoiseResponse, sum: &mut Densities) {
        let period_s = self.sampled.sample_period_s;
        let run_s = self.bands.duration_s();
        let exposure_s = self.exposure_s();
        let amid_s = self.procedure.sight_settle_s() + 0.5 * run_s;
        for (k, frequency_hz) in self.grid.frequency_hz.iter().enumerate() {
            let rate = TAU * frequency_hz;
            let power =
                noise.density(*frequency_hz, period_s, amid_s) * self.grid.width_hz[k] / (rate * rate);
            let (hub, tip) = (response.hub[k], response.tip[k]);
            let squares = [hub.norm_sqr(), tip.norm_sqr(), (tip - hub).norm_sqr()];
            let weights = [about_mean(frequency_hz * run_s), about_mean(frequency_hz * exposure_s)];
            sum.add(self.grid.band[k], squares.map(|square| power * square), weights);
        }
        // a constant error makes a straight line, whose mean square about its mean over T is (slope T)^2 / 12
        let slopes = [response.hub[0], response.tip[0], response.tip[0] - response.hub[0]];
        let squares = slopes.map(|slope| (slope.norm() * noise.bias).powi(2));
        sum.add(0, squares, [run_s, exposure_s].map(|time_s| time_s * time_s / 12.0));
    }

    fn exposure_s(&self) -> f64 {
        let samples = (self.sight.exposure_s / self.sampled.sample_period_s).round().max(2.0);
        (samples * self.sampled.sample_period_s).min(self.bands.duration_s())
    }

    fn gyroscopic_torques(&self, source: ErrorSource, whole: &TimeHistory) -> Torques {
        let road = self.procedure.road.as_ref().filter(|road| road.has_further_motion());
        let hub = |k: usize| {
            let Some(road) = road else { return 0.0 };
            let at = |values: &[f64]| road.interpolate(values, k as f64 * whole.sample_period_s);
            let rates = match source {
                ErrorSource::Roll => [at(road.roll_rate_rad_s()), 0.0],
                _ => [0.0, at(road.yaw_rate_rad_s())],
            };
            self.plant.gyroscopic_torque_nm(SinCos::of(whole.truth.hub_angle_rad()[k]), rates)
        };
        Torques { motor_nm: vec![0.0; whole.len()], hub_nm: (0..whole.len()).map(hub).collect() }
    }

    /// Returns what the gap takes from the torque of teeth that always touch.
    fn gap_torques(&self, whole: &TimeHistory) -> Torques {
        let gearbox = &self.plant.parameters().gearbox;
        let truth = &whole.truth;
        let missing = |k: usize| {
            if gearbox.is_rigid() {
                return 0.0;
            }
            let rate = truth.motor_rate_rad_s()[k] / gearbox.ratio + truth.platform_rate_rad_s()[k]
                - truth.hub_rate_rad_s()[k];
            let touching =
                gearbox.stiffness_nm_rad * truth.wind_up_rad()[k] + gearbox.damping_nm_s_rad * rate;
            truth.mesh_torque_nm()[k] - touching
        };
        let hub_nm: Vec<f64> = (0..whole.len()).map(missing).collect();
        Torques { motor_nm: hub_nm.iter().map(|torque| -torque / gearbox.ratio).collect(), hub_nm }
    }

    /// The torque of the recoil along a run.
    fn recoil_torques(&self, whole: &TimeHistory) -> Torques {
        let truth = &whole.truth;
        let hub = |k: usize| {
            let loads = &self.plant.parameters().loads;
            let (_, cos) = self.plant.tilt(truth.hub_angle_rad()[k]);
            let at = LoadPoint {
                time_s: k as f64 * whole.sample_period_s,
                hub_rate_rad_s: truth.hub_rate_rad_s()[k],
                load_m_s2: (self.plant.parameters().gravity_m_s2 + truth.heave_m_s2()[k]) * cos,
                ..LoadPoint::default()
            };
            loads.recoil.as_ref().map_or(0.0, |recoil| recoil.torque_nm(&at))
        };
        Torques { motor_nm: vec![0.0; whole.len()], hub_nm: (0..whole.len()).map(hub).collect() }
    }

    fn ripple_torques(&self, whole: &TimeHistory) -> Torques {
        let (truth, p) = (&whole.truth, self.plant.parameters());
        let rippled = |k: usize| {
            let relative = truth.hub_angle_rad()[k] - truth.platform_angle_rad()[k];
            let angle = p.gearbox.ratio * (truth.wind_up_rad()[k] + relative);
            let error =
                self.plant.kinematic_error_nm(truth.mesh_torque_nm()[k], angle, truth.motor_rate_rad_s()[k]);
            let of = |ripple: &Ripple| ripple.at(angle);
            let torque = p.motor.torque_constant_nm_a * truth.current_a()[k];
            let motor = of(&p.motor.cogging) + torque * of(&p.motor.torque_ripple) + error.motor_nm;
            [motor, of(&p.gearbox.mesh_ripple) + error.hub_nm]
        };
        let both: Vec<[f64; 2]> = (0..whole.len()).map(rippled).collect();
        Torques {
            motor_nm: both.iter().map(|pair| pair[0]).collect(),
            hub_nm: both.iter().map(|pair| pair[1]).collect(),
        }
    }
}

/// Torques on the motor shaft and on the hub at the samples of a run.
struct Torques {
    motor_nm: Vec<f64>,
    hub_nm: Vec<f64>,
}

impl Torques {
    /// Dry friction of a run.
    fn of_friction(run: &TimeHistory) -> Self {
        let negative = |torques: &[f64]| torques.iter().map(|torque| -torque).collect();
        Self {
            motor_nm: negative(run.truth.motor_friction_nm()),
            hub_nm: negative(run.truth.pivot_friction_nm()),
        }
    }
}

/// Returns 1 - sinc^2: the share of a density that varies within a time, at a number of periods in it.
fn about_mean(periods: f64) -> f64 {
    let x = PI * periods;
    if x < MEAN_SERIES * FRAC_PI_2 {
        // the series of 1 - (sin x / x)^2: the difference itself would lose digits
        return x * x / 3.0 * (1.0 - 2.0 * x * x / 15.0);
    }
    1.0 - (x.sin() / x).powi(2)
}

/// Sums of densities: the mean squares of the five values and of the bands.
struct Densities {
    square: [f64; 5],
    spectrum: SightSpectrum,
}

impl Densities {
    fn at_rest(bands: usize) -> Self {
        Self { square: [0.0; 5], spectrum: SightSpectrum::at_rest(bands) }
    }

    /// Adds what a band of hub, tip and bending holds; the weights are those of the run and of an exposure.
    fn add(&mut self, band: usize, [hub, tip, bending]: [f64; 3], [run, exposure]: [f64; 2]) {
        let added = [hub * run, hub * exposure, tip * run, tip * exposure, bending * run];
        self.square.iter_mut().zip(added).for_each(|(sum, more)| *sum += more);
        self.spectrum.hub_rad2[band] += hub * run;
        self.spectrum.tip_rad2[band] += tip * run;
        self.spectrum.bending_rad2[band] += bending * run;
    }

    fn contribution(self) -> LinearContribution {
        LinearContribution { rad: self.square.map(f64::sqrt), spectrum: self.spectrum }
    }
}

/// The noises that a source of sensing has.
fn noises(source: ErrorSource, p: &Parameters) -> Vec<Noise> {
    let sensors = &p.sensors;
    let of = |place: usize, sensor: &Sensor| {
        let step = if sensor.resolution > 0.0 { p.interface.reading_step(sensor) } else { 0.0 };
        Noise {
            entry: NoiseEntry::Reading(place),
            bias: sensor.bias,
            variance: sensor.noise_rms.powi(2) + step.powi(2) / 12.0,
            drift: sensor.drift,
        }
    };
    let all = [
        (ErrorSource::HubGyro, 1, Some(&sensors.hub_gyro)),
        (ErrorSource::PlatformGyro, 2, Some(&sensors.platform_gyro)),
        (ErrorSource::Accelerometer, 3, Some(&sensors.platform_accelerometer)),
        (ErrorSource::MotorTachometer, 4, sensors.motor_tachometer.as_ref()),
        (ErrorSource::HubResolver, 5, sensors.hub_resolver.as_ref()),
    ];
    if source != ErrorSource::Quantisation {
        let own = all.into_iter().filter(|(of_sensor, ..)| *of_sensor == source);
        return own.filter_map(|(_, place, sensor)| Some(of(place, sensor?))).collect();
    }
    let white =
        |entry, step: f64| Noise { entry, bias: 0.0, variance: step * step / 12.0, drift: Drift::NONE };
    let fitted = all.into_iter().filter_map(|(_, place, sensor)| Some((place, sensor?)));
    let through_converter = fitted.filter(|(_, sensor)| sensor.resolution == 0.0 && sensor.is_fitted());
    let inputs = through_converter
        .map(|(place, sensor)| white(NoiseEntry::Reading(place), p.interface.converter_step(sensor)));
    inputs.chain([white(NoiseEntry::Control, p.interface.control_step_v())]).collect()
}
