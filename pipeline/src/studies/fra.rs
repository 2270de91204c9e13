//! The frequency response analyser over a map of amplitudes and frequencies, with what linear theory expects beside it.
//!
//! Each point of the map is measured by [`counterpoise_simulate::fra`] on the nonlinear plant (or on a recording), and
//! compared with two linear models, sampled exactly: dry friction left out, and dry friction as its describing function
//! at the amplitude that this model itself gives.

use counterpoise_controller::{Controller, ProportionalIntegral, SampledController};
use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, response_at};
use counterpoise_models::plant::{Angles, FrictionLinearisation, Plant};
use counterpoise_models::{ControlledQuantity, FrictionLaw, OperatingPoint};
use counterpoise_pool::{Pool, map};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::ensemble::SIDE_BY_SIDE;
use counterpoise_simulate::fra::{
    self, MeasuredResponse, Measurement, PlannedPoint, Settings, Test, TestSine,
};
use counterpoise_verify::linear_loop::SampledPlant;
use counterpoise_verify::linear_loop::closed_loop::resolver_use;
use counterpoise_verify::linear_loop::plant::Resolver;
use ndarray::Array2;
use serde::Serialize;
use std::f64::consts::TAU;

use super::fra_points::{MapPoints, ResponseMapPoint, gain_db, pair, phase_deg};
use super::fra_summary::MapSummary;
use crate::exchange::{RunHistory, RunSignal};
use crate::recordings::ColumnRemark;
use crate::recordings::read::{GapTreatment, ReadRecording, RecordingFile, read_files, recording_controller};
use crate::tolerance::{EXCITED_ABOVE_NOISE, LEAST_SWING_RAD, MOST_SWING_TRIALS, SELF_CONSISTENT_SWING};
use crate::{PipelineError, PlantModel, build_plant_model, cannot_hold, reduce_plant, synthesise};
use counterpoise_project::Project;
use counterpoise_project::resolve::model::StructureChoice;

/// Loop that is excited and measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopUnderTest {
    /// From the control to the hub gyroscope, a constant control holding the weight.
    Plant,
    /// From the demand to the hub gyroscope, with the controller.
    Closed,
    /// From the platform gyroscope to the hub gyroscope, with the controller.
    Disturbance,
    /// From the platform gyroscope to the hub gyroscope of the balanced mechanism, the motor disconnected.
    Disconnected,
}

/// The points of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementPlan {
    /// Loop that is excited.
    pub around: LoopUnderTest,
    /// Amplitudes: V for the plant, in the demand's unit for the closed loop, rad/s otherwise.
    pub amplitudes: Vec<f64>,
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Heave per pitch acceleration of the platform, m.
    pub offset_m: f64,
}

/// Remark that belongs to the numbers of a response map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapRemark {
    /// The loop is closed by the controller of the recordings.
    RecordingController,
    /// The mechanism is taken as balanced: with the motor disconnected nothing holds its out-of-balance.
    TakenAsBalanced {
        /// The out-of-balance that it has, kg m.
        out_of_balance_kg_m: f64,
    },
}

/// Input and output of a response map: quantities of the machine's own loop, with their units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct MapSignals {
    /// Excited signal.
    pub input: &'static str,
    /// Unit.
    pub input_unit: &'static str,
    /// Measured signal.
    pub output: &'static str,
    /// Unit.
    pub output_unit: &'static str,
}

impl MapSignals {
    /// Returns the unit of a gain, for example "rad/s per V"; empty if it has none.
    pub fn gain_unit(&self) -> String {
        if self.input_unit == self.output_unit {
            String::new()
        } else {
            format!("{} per {}", self.output_unit, self.input_unit)
        }
    }
}

/// A measured map. Its remarks are typed as it is measured, and sentences as it is presented.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseMap<Remark = String> {
    /// Name of the machine.
    pub name: String,
    /// Loop that was excited and measured.
    pub around: LoopUnderTest,
    /// The signals that it relates, and their units.
    pub signals: MapSignals,
    /// Name of the recording, where the instrument ran on one.
    pub recording: Option<String>,
    /// The numbers of its points.
    pub points: MapPoints,
    /// The same numbers in a few.
    #[serde(skip)]
    pub summary: MapSummary,
    /// The signals of every point over the last two windows, point by point; empty unless they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<RunHistory>,
    /// Simulated time of the mechanism, s.
    pub simulated_s: f64,
    /// Remarks that belong to the numbers.
    pub remarks: Vec<Remark>,
}

/// A map that was measured on a recording, and what was found about the columns of that.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedMap {
    /// The map.
    pub map: ResponseMap<MapRemark>,
    /// Remarks on the columns.
    pub columns: Vec<ColumnRemark>,
}

/// Runs the instrument on every recording of files, over the frequencies of the plan.
///
/// # Errors
/// Those of [`Analyser::new`] and [`Analyser::measure_recording`], and a file that cannot be read as the project maps its columns.
pub fn map_recordings(
    project: &Project,
    modelled: &PlantModel,
    plan: &MeasurementPlan,
    files: &[RecordingFile],
) -> Result<Vec<RecordedMap>, PipelineError> {
    let analyser = Analyser::new(project, modelled, plan, LoopController::Recording)?;
    let controller = recording_controller(project)?;
    let one = |item: ReadRecording| {
        let map = analyser.measure_recording(&item.recording, &plan.frequencies_hz)?;
        Ok(RecordedMap { map: ResponseMap { recording: Some(item.file), ..map }, columns: item.remarks })
    };
    read_files(project, controller.as_ref(), files, GapTreatment::Repaired)?.into_iter().map(one).collect()
}

impl LoopUnderTest {
    /// Returns what is excited and what is measured in a loop of a quantity.
    fn signals(self, controlled: ControlledQuantity) -> MapSignals {
        let (input, input_unit) = match self {
            Self::Plant => ("control", "V"),
            Self::Closed => ("demand", controlled.unit()),
            Self::Disturbance | Self::Disconnected => ("platform rate", "rad/s"),
        };
        MapSignals { input, input_unit, output: controlled.name(), output_unit: controlled.unit() }
    }

    fn test(self) -> Test {
        match self {
            Self::Plant => Test::Plant,
            Self::Closed => Test::ClosedLoop,
            Self::Disturbance | Self::Disconnected => Test::PlatformToHub,
        }
    }
}

/// The controller in the loop.
#[derive(Debug, Clone)]
enum AnalysedController {
    /// None is needed.
    Absent,
    /// The designed one, with its linear part.
    Designed(Box<Controller>, StateSpace),
    /// The one of the recordings.
    Recorded(ProportionalIntegral),
}

/// The instrument, connected to a plant.
#[derive(Debug, Clone)]
pub struct Analyser {
    plant: Plant,
    acting: AnalysedController,
    point: OperatingPoint,
    around: LoopUnderTest,
    offset_m: f64,
    keeps_signals: bool,
    name: String,
    remarks: Vec<MapRemark>,
}

impl Analyser {
    /// Connects the instrument: with a controller in the loop it is the designed one, or that of the recordings where the
    /// project asks for no design or where `recorded` says so.
    ///
    /// # Errors
    /// A loop that is to be closed by a project without a controller, and those of model and design.
    pub fn new(
        project: &Project,
        modelled: &PlantModel,
        plan: &MeasurementPlan,
        on: LoopController,
    ) -> Result<Self, PipelineError> {
        if let (LoopUnderTest::Plant, LoopController::Simulation, Some(why)) =
            (plan.around, on, cannot_hold(modelled))
        {
            return Err(why);
        }
        let mut remarks = Vec::new();
        let plant = match plan.around {
            LoopUnderTest::Disconnected => disconnect_motor(project, modelled, &mut remarks)?,
            _ => modelled.plant.clone(),
        };
        let acting = match plan.around {
            LoopUnderTest::Plant | LoopUnderTest::Disconnected => AnalysedController::Absent,
            LoopUnderTest::Closed | LoopUnderTest::Disturbance => {
                acting_controller(project, modelled, on, &mut remarks)?
            }
        };
        Ok(Self {
            plant,
            acting,
            point: project.model.operating_point,
            around: plan.around,
            offset_m: plan.offset_m,
            keeps_signals: false,
            name: modelled.parameters.name.clone(),
            remarks,
        })
    }

    /// Returns the same instrument and controller on another structure of the project's mechanism.
    ///
    /// # Errors
    /// Those of the model.
    pub fn with_structure(
        self,
        project: &Project,
        structure: StructureChoice,
        plan: &MeasurementPlan,
    ) -> Result<Self, PipelineError> {
        let mut other = project.clone();
        other.model.structure = structure;
        let modelled = build_plant_model(&other)?;
        let plant = match plan.around {
            LoopUnderTest::Disconnected => disconnect_motor(&other, &modelled, &mut Vec::new())?,
            _ => modelled.plant,
        };
        Ok(Self { plant, ..self })
    }

    /// Returns the same instrument, which keeps the signals of every point.
    pub fn with_signals(self) -> Self {
        Self { keeps_signals: true, ..self }
    }

    /// Measures every point on the simulated mechanism, in parallel, and returns the measurements, frequency x amplitude.
    ///
    /// # Errors
    /// The first point that cannot be measured.
    pub fn measure(
        &self,
        plan: &MeasurementPlan,
        pool: &dyn Pool,
    ) -> Result<Array2<Measurement>, PipelineError> {
        let count = plan.amplitudes.len() * plan.frequencies_hz.len();
        let settings = Settings {
            hub_angle_rad: self.point.hub_angle_rad,
            offset_m: self.offset_m,
            keeps_signals: self.keeps_signals,
            ..Settings::default()
        };
        let done = std::sync::atomic::AtomicUsize::new(0);
        pool.progress("point", 0, count);
        // points of one frequency are neighbours, because they take about as long
        let frequencies =
            plan.frequencies_hz.iter().flat_map(|hz| plan.amplitudes.iter().map(move |a| (hz, a)));
        let sines: Vec<TestSine> = frequencies
            .map(|(hz, amplitude)| TestSine { frequency_rad_s: TAU * hz, amplitude: *amplitude })
            .collect();
        let few: Vec<&[TestSine]> = sines.chunks(SIDE_BY_SIDE).collect();
        let measured = map(pool, few.len(), |index| {
            let mut controllers: Vec<_> = few[index].iter().map(|_| self.runner()).collect();
            let points = controllers.iter_mut().zip(few[index]);
            let mut points: Vec<PlannedPoint> = points
                .map(|(controller, at)| PlannedPoint { controller: controller.as_mut(), at: *at })
                .collect();
            let found = fra::measure_each(&self.plant, self.around.test(), &mut points, &settings);
            let before = done.fetch_add(found.len(), std::sync::atomic::Ordering::Relaxed);
            pool.progress("point", before + found.len(), count);
            found
        });
        let measured: Vec<_> = measured.into_iter().flatten().collect();
        let (frequencies, amplitudes) = (plan.frequencies_hz.len(), plan.amplitudes.len());
        let by_amplitude = (0..amplitudes).flat_map(|k| measured.iter().skip(k).step_by(amplitudes));
        let points: Vec<Measurement> = by_amplitude.cloned().collect::<Result<_, _>>()?;
        let at = |(frequency, amplitude): (usize, usize)| points[amplitude * frequencies + frequency].clone();
        Ok(Array2::from_shape_fn((frequencies, amplitudes), at))
    }

    /// Returns the map of what was measured, with the linear models beside it.
    ///
    /// # Errors
    /// Those of the linearisation.
    pub fn compare(
        &self,
        measured: &Array2<Measurement>,
        pool: &dyn Pool,
    ) -> Result<ResponseMap<MapRemark>, PipelineError> {
        let frequencies = measured.nrows();
        let points = map(pool, measured.len(), |k| {
            let one = &measured[(k % frequencies, k / frequencies)];
            let point = self.point_of(&one.response, one.amplitude)?;
            Ok(ResponseMapPoint { last_change: Some(one.last_change), settled: one.settled, ..point })
        });
        let points: Vec<ResponseMapPoint> = points.into_iter().collect::<Result<_, PipelineError>>()?;
        let points = MapPoints::of(&points, frequencies);
        Ok(ResponseMap {
            name: self.name.clone(),
            around: self.around,
            signals: self.around.signals(self.plant.parameters().controlled_quantity()),
            recording: None,
            summary: MapSummary::of(&points, None),
            points,
            histories: measured.t().iter().filter_map(|one| self.point_history(one)).collect(),
            simulated_s: measured.t().iter().map(|one| one.simulated_s).sum(),
            remarks: self.remarks.clone(),
        })
    }

    /// Returns the same instrument on the columns of a recording, over the last whole cycles of each
    /// frequency.
    ///
    /// # Errors
    /// A channel that was not recorded, a frequency that does not fit into the recording, and those of the linearisation.
    pub fn measure_recording(
        &self,
        recording: &Recording,
        frequencies_hz: &[f64],
    ) -> Result<ResponseMap<MapRemark>, PipelineError> {
        let input = match self.around {
            LoopUnderTest::Plant => Channel::Control,
            LoopUnderTest::Closed => Channel::Demand,
            LoopUnderTest::Disturbance | LoopUnderTest::Disconnected => Channel::PlatformRate,
        };
        let recorded = |channel: Channel| {
            let (name, channel_name) = (recording.name.clone(), channel.name());
            let lacking = PipelineError::Channel { recording: name, channel: channel_name };
            recording.samples(channel).ok_or(lacking)
        };
        let (input, output) = (recorded(input)?, recorded(Channel::HubRate)?);
        let mut points = Vec::with_capacity(frequencies_hz.len());
        for hz in frequencies_hz {
            let found = fra::cycle_response(input, output, recording.sample_period_s, TAU * hz, usize::MAX)?;
            let point = self.point_of(&found, found.input.harmonics[0].norm())?;
            points.push(ResponseMapPoint { settled: is_excited(&found, recording.sample_period_s), ..point });
        }
        let points = MapPoints::of(&points, frequencies_hz.len());
        Ok(ResponseMap {
            name: self.name.clone(),
            around: self.around,
            signals: self.around.signals(self.plant.parameters().controlled_quantity()),
            recording: Some(recording.name.clone()),
            summary: MapSummary::of(&points, Some(&recording.name)),
            points,
            histories: Vec::new(),
            simulated_s: 0.0,
            remarks: self.remarks.clone(),
        })
    }

    /// Returns the signals of a point; `None` if they were not kept.
    fn point_history(&self, measured: &Measurement) -> Option<RunHistory> {
        let kept = measured.signals.as_ref()?;
        let hz = measured.response.frequency_rad_s / TAU;
        let signals = [("input", &kept.input), ("output", &kept.output)];
        let signals = signals.map(|(name, samples)| RunSignal::new(name, samples.as_slice()));
        Some(RunHistory::new(format!("{} at {hz} Hz", measured.amplitude), kept.period_s, signals))
    }

    fn point_of(
        &self,
        response: &MeasuredResponse,
        amplitude: f64,
    ) -> Result<ResponseMapPoint, PipelineError> {
        let rate = response.frequency_rad_s;
        let linear = self.expected_response(FrictionLinearisation::Viscous, rate)?;
        let describing = self.describing_response(&linear, rate, amplitude)?;
        Ok(ResponseMapPoint {
            amplitude,
            frequency_hz: rate / TAU,
            response: pair(response.value),
            gain_db: gain_db(response.value),
            phase_deg: phase_deg(response.value),
            mean_rad_s: response.output.mean,
            distortion: response.distortion(),
            cycles: response.cycles,
            last_change: None,
            settled: true,
            linear: pair(linear.response),
            describing: describing.map(|found| pair(found.response)),
        })
    }

    fn runner(&self) -> Box<dyn SampledController> {
        match &self.acting {
            AnalysedController::Absent => Box::new(IdleController),
            AnalysedController::Designed(controller, _) => Box::new(controller.runner()),
            AnalysedController::Recorded(controller) => Box::new(controller.clone()),
        }
    }

    /// Returns the describing function at the hub amplitude that it leads to itself, by damped iteration.
    fn describing_response(
        &self,
        linear: &ExpectedResponse,
        rate: f64,
        amplitude: f64,
    ) -> Result<Option<ExpectedResponse>, PipelineError> {
        let p = self.plant.parameters();
        if [&p.motor_friction.law, &p.pivot_friction.law].iter().all(|law| **law == FrictionLaw::None) {
            return Ok(None);
        }
        let per_travel = if p.sensors.measured.is_position() { 1.0 } else { rate };
        let swing =
            |found: &ExpectedResponse| (found.relative.norm() * amplitude / per_travel).max(LEAST_SWING_RAD);
        let mut hub_amplitude_rad = swing(linear);
        for _ in 0..MOST_SWING_TRIALS {
            let friction =
                FrictionLinearisation::DescribingFunction { hub_amplitude_rad, frequency_rad_s: rate };
            let found = self.expected_response(friction, rate)?;
            let next = swing(&found);
            if (next / hub_amplitude_rad - 1.0).abs() < SELF_CONSISTENT_SWING {
                return Ok(Some(found));
            }
            hub_amplitude_rad = (next * hub_amplitude_rad).sqrt();
        }
        Ok(None)
    }

    /// Returns what the sampled linear model gives at one frequency.
    fn expected_response(
        &self,
        friction: FrictionLinearisation,
        rate: f64,
    ) -> Result<ExpectedResponse, PipelineError> {
        let equilibrium = self.plant.equilibrium(&self.point);
        // the outputs of a loop of position are positions, which the plant shows only in that form
        let is_position = self.plant.parameters().sensors.measured.is_position();
        let angles = if is_position { Angles::Position } else { Angles::Keep };
        let linear = self.plant.linearise(&equilibrium, friction, angles)?;
        let resolver = match &self.acting {
            AnalysedController::Designed(controller, _) => resolver_use(controller),
            AnalysedController::Absent | AnalysedController::Recorded(_) => Resolver::Unread,
        };
        let sampled = SampledPlant::new(&linear, self.plant.parameters(), resolver)?.sampled;
        let period = self.plant.parameters().interface.sample_period_s;
        let all = response_at(&sampled, rate)?;
        let [heave, pitch, control] = [1, 2, 3].map(|input| column(&all, input));
        let gains = self.gains(rate, period)?;
        let through =
            |tones: &[C64]| gains.iter().zip(&tones[FIRST_READING..]).map(|(k, r)| k * r).sum::<C64>();
        let closed = C64::new(1.0, 0.0) - through(&control);
        Ok(match self.around {
            LoopUnderTest::Plant => ExpectedResponse { response: control[HUB_GYRO], relative: control[HUB] },
            LoopUnderTest::Closed => {
                let u = gains[0] / closed;
                ExpectedResponse { response: control[HUB_GYRO] * u, relative: control[HUB] * u }
            }
            LoopUnderTest::Disturbance | LoopUnderTest::Disconnected => {
                let share = C64::new(0.0, rate * self.offset_m);
                let tone: Vec<C64> = pitch.iter().zip(&heave).map(|(p, h)| p + h * share).collect();
                let u = through(&tone) / closed;
                let response = (tone[HUB_GYRO] + control[HUB_GYRO] * u) / tone[PLATFORM_GYRO];
                let platform = if is_position { 0.0 } else { 1.0 };
                ExpectedResponse { response, relative: tone[HUB] + control[HUB] * u - platform }
            }
        })
    }

    /// Returns the controller's gain from each reading.
    fn gains(&self, rate: f64, period: f64) -> Result<Vec<C64>, PipelineError> {
        let mut gains = vec![C64::new(0.0, 0.0); counterpoise_controller::COMMON_READINGS];
        match &self.acting {
            AnalysedController::Absent => {}
            AnalysedController::Designed(_, linear) => {
                let from_readings = response_at(linear, rate)?;
                gains.iter_mut().enumerate().for_each(|(i, gain)| *gain = from_readings[(0, i)]);
            }
            AnalysedController::Recorded(pi) => {
                let z = C64::from_polar(1.0, rate * period);
                gains[0] = pi.kp_v_s_rad + pi.ki_v_rad * pi.sample_period_s / (z - 1.0);
                gains[1] = -gains[0];
            }
        }
        Ok(gains)
    }
}

/// Source of the controller in the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopController {
    /// The simulated mechanism: the designed controller.
    Simulation,
    /// A recording: the controller that was in its loop.
    Recording,
}

/// The responses of a linear model.
struct ExpectedResponse {
    /// The response as the instrument reads it.
    response: C64,
    /// Hub rate relative to the platform, in a loop of position its position there, per unit of excitation.
    relative: C64,
}

/// Outputs of the sampled plant: the true hub rate; the readings, of which the first is the demand.
const HUB: usize = 0;
const FIRST_READING: usize = 5;
const HUB_GYRO: usize = FIRST_READING + 1;
const PLATFORM_GYRO: usize = FIRST_READING + 2;

/// Returns whether the input has a line at the frequency: n samples of noise leave an amplitude of about sqrt(2 / n) of
/// their RMS.
fn is_excited(found: &MeasuredResponse, period_s: f64) -> bool {
    let samples = found.cycles as f64 * TAU / (found.frequency_rad_s * period_s);
    found.input.harmonics[0].norm() > EXCITED_ABOVE_NOISE * found.input.residual_rms * (2.0 / samples).sqrt()
}

fn column(all: &counterpoise_linalg::CMat, input: usize) -> Vec<C64> {
    (0..all.nrows()).map(|i| all[(i, input)]).collect()
}

/// A controller that does nothing: the test without one does not ask it.
struct IdleController;

impl SampledController for IdleController {
    fn reset(&mut self) {}

    fn step(&mut self, _readings: &counterpoise_controller::Readings) -> f64 {
        0.0
    }
}

fn acting_controller(
    project: &Project,
    modelled: &PlantModel,
    on: LoopController,
    remarks: &mut Vec<MapRemark>,
) -> Result<AnalysedController, PipelineError> {
    let recorded = project.recording_controller.as_ref().and_then(|c| c.as_proportional_integral());
    if let Some(pi) = recorded.filter(|_| on == LoopController::Recording || project.synth.is_none()) {
        remarks.push(MapRemark::RecordingController);
        return Ok(AnalysedController::Recorded(pi.clone()));
    }
    let made = synthesise(project, modelled, &reduce_plant(project, modelled)?)?;
    let controller = made.sampled.controller;
    let linear = controller
        .linear(modelled.plant.body().out_of_balance_kg_m)
        .map_err(counterpoise_verify::Error::from)?;
    Ok(AnalysedController::Designed(Box::new(controller), linear))
}

/// Returns the plant without a motor, balanced: nothing would hold a weight.
fn disconnect_motor(
    project: &Project,
    modelled: &PlantModel,
    remarks: &mut Vec<MapRemark>,
) -> Result<Plant, PipelineError> {
    let mut parameters = modelled.parameters.clone();
    if let Some(lumped) = &mut parameters.lumped {
        (lumped.out_of_balance_kg_m, lumped.vertical_offset_kg_m) = (0.0, 0.0);
    }
    let moment = modelled.plant.body().out_of_balance_kg_m;
    if moment != 0.0 {
        remarks.push(MapRemark::TakenAsBalanced { out_of_balance_kg_m: moment });
    }
    let open = fra::disconnect_motor(&parameters)?;
    Ok(match project.model.structure {
        StructureChoice::Lumped => Plant::from_lumped(&open)?,
        StructureChoice::Beam | StructureChoice::Import => {
            let body = counterpoise_models::plant::Body {
                out_of_balance_kg_m: 0.0,
                vertical_offset_kg_m: 0.0,
                ..modelled.plant.body().clone()
            };
            Plant::with_whole_body(&open, body)?
        }
    })
}
