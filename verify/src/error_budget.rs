//! The error budget: how much of the line of sight's error each source makes, by switching sources on and off in the simulator.
//!
//! The mean square of the error with all sources is divided among them. Sources are switched on one after the other, and each is charged with
//! what the mean square grows by; this is done in one order and in the opposite one, and the two charges are averaged. The shares add
//! up to the simulated mean square whatever is nonlinear (they are Shapley values over these two orders; L. Shapley, 1953). A negative share
//! belongs to a source whose presence reduces the error of the others, as friction may.
//!
//! Beside it stands what each source makes alone. If the loop were linear and the sources independent, the squares of those would add up, too:
//! the difference says how far superposition holds.

use counterpoise_controller::Controller;
use counterpoise_models::{Clock, Drift, Friction, FrictionLaw, Parameters, Plant, Ripple, Sensor};
use counterpoise_simulate::Simulator;

use crate::line_of_sight::{SightAngles, SightError, experiment};
use crate::{Error, FurtherRoad, Procedure, nonlinear};

/// A source of the line of sight's error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorSource {
    /// Upward acceleration of the base.
    Heave,
    /// Forward acceleration of the base.
    Surge,
    /// Rate of the base about the elevation axis.
    Pitch,
    /// Rates of the base about its other axes.
    RollAndYaw,
    /// Friction of motor and pivot, hoses and hysteresis.
    Friction,
    /// The gap of the gear.
    Backlash,
    /// Cogging, torque ripple, mesh ripple and the kinematic error of the transmission.
    Ripple,
    /// Noise, bias and drift of the gyroscope in the loop.
    HubGyro,
    /// Those of the gyroscope on the platform.
    PlatformGyro,
    /// Those of the accelerometer.
    Accelerometer,
    /// Those of the other sensors.
    OtherSensors,
    /// Steps of the converters and missing codes.
    Quantisation,
    /// Errors of the clock.
    Clock,
}

impl ErrorSource {
    /// Every source, in the order in which they are switched on.
    pub const ALL: [Self; 13] = [
        Self::Heave,
        Self::Surge,
        Self::Pitch,
        Self::RollAndYaw,
        Self::Friction,
        Self::Backlash,
        Self::Ripple,
        Self::HubGyro,
        Self::PlatformGyro,
        Self::Accelerometer,
        Self::OtherSensors,
        Self::Quantisation,
        Self::Clock,
    ];

    /// Returns the source's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Heave => "heave",
            Self::Surge => "surge",
            Self::Pitch => "pitch",
            Self::RollAndYaw => "roll and yaw",
            Self::Friction => "friction",
            Self::Backlash => "backlash",
            Self::Ripple => "cogging and ripple",
            Self::HubGyro => "hub gyroscope",
            Self::PlatformGyro => "platform gyroscope",
            Self::Accelerometer => "platform accelerometer",
            Self::OtherSensors => "other sensors",
            Self::Quantisation => "converters",
            Self::Clock => "clock",
        }
    }
}

/// What one source makes of the error: values in the order of [`SightError::values`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contribution {
    /// The source.
    pub source: ErrorSource,
    /// Its share of the mean square, rad^2; negative if it reduces the error of the others.
    pub share_rad2: [f64; 5],
    /// RMS with this source alone, rad.
    pub alone_rad: [f64; 5],
}

/// The error of the line of sight and what it is made of: values in the order of [`SightError::values`].
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBudget {
    /// RMS with all sources, rad.
    pub total_rad: [f64; 5],
    /// RMS with none: what the start of the run leaves, rad.
    pub none_rad: [f64; 5],
    /// Every source that the machine and its motion have.
    pub contributions: Vec<Contribution>,
    /// The runs from which all of this is computed.
    pub runs: Vec<BudgetRun>,
}

/// The error of the line of sight in a run with some of the sources.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetRun {
    /// The sources that are switched on.
    pub on: Vec<ErrorSource>,
    /// RMS, rad, in the order of [`SightError::values`].
    pub error_rad: [f64; 5],
}

impl ErrorBudget {
    /// Returns the root of the sum of all shares, rad: the simulated RMS.
    pub fn sum_rad(&self) -> [f64; 5] {
        std::array::from_fn(|j| {
            let shares: f64 = self.contributions.iter().map(|one| one.share_rad2[j]).sum();
            (shares + self.none_rad[j].powi(2)).max(0.0).sqrt()
        })
    }

    /// Returns the root of the sum of squares of what each source makes alone, rad: the RMS if superposition held.
    pub fn superposed_rad(&self) -> [f64; 5] {
        std::array::from_fn(|j| {
            self.contributions.iter().map(|one| one.alone_rad[j].powi(2)).sum::<f64>().sqrt()
        })
    }
}

/// Divides the error of the line of sight of a controller on a plant among its sources; `None` if a motion with some of them diverges, if the
/// procedure does not ask for the line of sight, or if the loop holds a position.
///
/// # Errors
/// Those of the plant, the controller and the simulator.
pub fn error_budget(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<Option<ErrorBudget>, Error> {
    if procedure.line_of_sight.is_none() || plant.parameters().sensors.measured.is_position() {
        return Ok(None);
    }
    let mut runs = Runs::new(plant, controller, procedure);
    let found = runs.budget();
    match found {
        Ok(budget) => Ok(Some(budget)),
        Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Returns the error of the line of sight in samples in a run with some of the sources alone; `None` if the run is shorter than two samples.
///
/// # Errors
/// Those of the plant, the controller and the simulator.
pub fn budget_angles(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    on: &[ErrorSource],
) -> Result<Option<SightAngles>, Error> {
    Runs::new(plant, controller, procedure).angles(on)
}

/// Runs with some of the sources.
struct Runs<'a> {
    plant: &'a Plant,
    controller: &'a Controller,
    procedure: &'a Procedure,
    done: Vec<BudgetRun>,
}

impl<'a> Runs<'a> {
    fn new(plant: &'a Plant, controller: &'a Controller, procedure: &'a Procedure) -> Self {
        Self { plant, controller, procedure, done: Vec::new() }
    }

    fn budget(&mut self) -> Result<ErrorBudget, Error> {
        let present: Vec<ErrorSource> =
            ErrorSource::ALL.into_iter().filter(|source| self.has(*source)).collect();
        let n = present.len();
        let forwards = self.switched_on(&present)?;
        let reversed: Vec<ErrorSource> = present.iter().rev().copied().collect();
        let backwards = self.switched_on(&reversed)?;
        let square = |value: f64| value * value;
        let mut contributions = Vec::with_capacity(n);
        for (k, source) in present.iter().enumerate() {
            let (on, back) = (&forwards[k..k + 2], &backwards[n - 1 - k..n + 1 - k]);
            let grown = |j: usize, pair: &[[f64; 5]]| square(pair[1][j]) - square(pair[0][j]);
            contributions.push(Contribution {
                source: *source,
                share_rad2: std::array::from_fn(|j| 0.5 * (grown(j, on) + grown(j, back))),
                alone_rad: self.error(&[*source])?,
            });
        }
        let runs = std::mem::take(&mut self.done);
        Ok(ErrorBudget { total_rad: forwards[n], none_rad: forwards[0], contributions, runs })
    }

    /// Returns the errors with none of the sources, with the first, with the first two, and so on.
    fn switched_on(&mut self, order: &[ErrorSource]) -> Result<Vec<[f64; 5]>, Error> {
        (0..=order.len()).map(|count| self.error(&order[..count])).collect()
    }

    /// The errors with some of the sources; a run that was done before is not repeated.
    fn error(&mut self, on: &[ErrorSource]) -> Result<[f64; 5], Error> {
        let mut on = on.to_vec();
        on.sort_by_key(|source| ErrorSource::ALL.iter().position(|one| one == source));
        if let Some(done) = self.done.iter().find(|run| run.on == on) {
            return Ok(done.error_rad);
        }
        let exposure_s = self.procedure.line_of_sight.unwrap_or_default().exposure_s;
        let error: SightError = self.angles(&on)?.map(|angles| angles.error(exposure_s)).unwrap_or_default();
        self.done.push(BudgetRun { on, error_rad: error.values() });
        Ok(error.values())
    }

    fn angles(&self, on: &[ErrorSource]) -> Result<Option<SightAngles>, Error> {
        let mut parameters = self.plant.parameters().clone();
        let mut procedure = self.procedure.clone();
        for source in ErrorSource::ALL.into_iter().filter(|source| !on.contains(source)) {
            switch_off(source, &mut parameters, &mut procedure);
        }
        let plant = Plant::with_whole_body(&parameters, self.plant.body().clone())?;
        let mut simulator = Simulator::new(&plant)?;
        let history =
            nonlinear::history(&mut simulator, self.controller, &procedure, experiment(&procedure))?;
        Ok(SightAngles::of(&history, procedure.sight_settle_s()))
    }

    /// Returns whether switching a source off changes anything.
    fn has(&self, source: ErrorSource) -> bool {
        let (mut parameters, mut procedure) = (self.plant.parameters().clone(), self.procedure.clone());
        switch_off(source, &mut parameters, &mut procedure);
        let moved = |procedure: &Procedure| match &procedure.road {
            Some(road) => (road.heave_m_s2.clone(), road.pitch_rate_rad_s.clone(), road.further.clone()),
            None => (vec![procedure.heave.amplitude], vec![procedure.pitch.amplitude], None),
        };
        parameters != *self.plant.parameters() || moved(&procedure) != moved(self.procedure)
    }
}

/// Takes a source out of the machine or of its motion.
fn switch_off(source: ErrorSource, p: &mut Parameters, procedure: &mut Procedure) {
    match source {
        ErrorSource::Friction => frictionless(p),
        ErrorSource::Backlash => p.gearbox.backlash_rad = p.gearbox.backlash_rad.min(0.0),
        ErrorSource::Ripple => {
            (p.motor.cogging, p.motor.torque_ripple) = (Ripple::NONE, Ripple::NONE);
            (p.gearbox.mesh_ripple, p.gearbox.kinematic_error) = (Ripple::NONE, Ripple::NONE);
        }
        ErrorSource::HubGyro => exact(&mut p.sensors.hub_gyro),
        ErrorSource::PlatformGyro => exact(&mut p.sensors.platform_gyro),
        ErrorSource::Accelerometer => {
            exact(&mut p.sensors.platform_accelerometer);
            p.sensors.surge_accelerometer.iter_mut().for_each(exact);
        }
        ErrorSource::OtherSensors => {
            p.sensors.motor_tachometer.iter_mut().chain(&mut p.sensors.hub_resolver).for_each(exact);
        }
        ErrorSource::Quantisation => {
            // as fine as doubles resolve the range of +/- 10 V
            (p.interface.input_bits, p.interface.output_bits) = (FINEST_BITS, FINEST_BITS);
            p.interface.missing_codes = 0.0;
        }
        ErrorSource::Clock => p.interface.clock = Clock::IDEAL,
        ErrorSource::Heave | ErrorSource::Surge | ErrorSource::Pitch | ErrorSource::RollAndYaw => {
            still(source, procedure);
        }
    }
}

/// Bits of converters whose steps are lost in the rounding of doubles.
const FINEST_BITS: u32 = 32;

fn frictionless(p: &mut Parameters) {
    let none = Friction::plain(FrictionLaw::None, 0.0);
    (p.motor_friction, p.pivot_friction) = (none.clone(), none);
    p.gearbox.hysteresis_nm = 0.0;
    if let Some(lumped) = &mut p.lumped {
        lumped.hysteresis_nm = 0.0;
    }
}

/// A sensor without noise, bias, drift and error of its gain; its dynamics and its delay stay, for the loop is designed on them.
fn exact(sensor: &mut Sensor) {
    (sensor.noise_rms, sensor.bias, sensor.drift) = (0.0, 0.0, Drift::NONE);
    (sensor.resolution, sensor.g_sensitivity) = (0.0, 0.0);
    if sensor.is_fitted() {
        sensor.gain = 1.0;
    }
}

fn still(source: ErrorSource, procedure: &mut Procedure) {
    let Some(road) = &mut procedure.road else {
        match source {
            ErrorSource::Heave => procedure.heave.amplitude = 0.0,
            ErrorSource::Pitch => procedure.pitch.amplitude = 0.0,
            _ => {}
        }
        return;
    };
    match (source, &mut road.further) {
        (ErrorSource::Heave, _) => road.heave_m_s2.fill(0.0),
        (ErrorSource::Pitch, _) => road.pitch_rate_rad_s.fill(0.0),
        (ErrorSource::Surge, Some(FurtherRoad { surge_m_s2, .. })) => surge_m_s2.fill(0.0),
        (ErrorSource::RollAndYaw, Some(FurtherRoad { roll_rate_rad_s, yaw_rate_rad_s, .. })) => {
            roll_rate_rad_s.fill(0.0);
            yaw_rate_rad_s.fill(0.0);
        }
        _ => {}
    }
}
