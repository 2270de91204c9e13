//! The cost of smaller numbers: the controller in double, single and fixed point, side by side in the simulated loop.

use counterpoise_controller::{Controller, READINGS, Readings, SampledController};
use counterpoise_models::plant::Plant;
use counterpoise_pool::{Pool, Serial, map_all};
use counterpoise_simulate::Simulator;
use counterpoise_verify::{Arrangement, Experiment, Procedure, VerifiedController, nonlinear_runs};

use crate::{
    AdjustableController, Deviation, FixedError, FixedPointController, FixedRunner, FormFigures,
    MeasuredDeviation, Ranges, figures_by_form, plan_fixed_point, single_precision,
};

/// Margin of the ranges from which formats are chosen: two bits above what the verification's runs reach.
pub const RANGE_MARGIN: f64 = 4.0;

/// The numbers of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    /// Double: C and Rust, equal to the reference to the last bit.
    Double,
    /// Single: C and Rust.
    Single,
    /// 32-bit fixed point: C.
    Fixed,
}

impl Numbers {
    /// Returns the name of the numbers in results.
    pub fn name(self) -> &'static str {
        match self {
            Numbers::Double => "double",
            Numbers::Single => "single",
            Numbers::Fixed => "fixed",
        }
    }
}

/// The controller in some numbers, in the simulated loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetFigures {
    /// Kind of numbers.
    pub numbers: Numbers,
    /// Predicted deviation of the control from the reference for the same readings; exactly 0 for double.
    pub predicted: Deviation,
    /// The deviation that was measured, for the readings of the verification's runs and at every setting of the out-of-balance at which a gain
    /// has a corner, V: the runs that the prediction holds for.
    pub measured_v: f64,
    /// RMS of that difference in the run where it is largest, V.
    pub measured_rms_v: f64,
    /// Each experiment with the closed loop's hub rate error in these numbers.
    pub experiments: Vec<ExperimentFigures>,
    /// Readings and controls of the controller in each experiment's closed loop: code with the same controls moves the plant in the same way.
    pub closed_loops: Vec<Record>,
}

/// Readings of a run and the controls that were given, in V: one each a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Readings in the order of the controller's.
    pub readings: Vec<[f64; READINGS]>,
    /// Controls, V.
    pub controls_v: Vec<f64>,
}

/// The closed loop in one experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentFigures {
    /// Experiment that it belongs to.
    pub experiment: Experiment,
    /// RMS of demand less hub rate, rad/s.
    pub error_rms_rad_s: f64,
    /// That against double, dB: what the numbers cost in rejection. Nothing if the loop in double has no error at all.
    pub cost_db: Option<f64>,
    /// Demand less hub rate, rad/s, one each a sample.
    pub errors_rad_s: Vec<f64>,
}

/// The comparison of a verified controller's targets.
#[derive(Debug, Clone, PartialEq)]
pub struct Targets {
    /// Double, single and, where it exists, fixed point.
    pub figures: Vec<TargetFigures>,
    /// The fixed-point form, or why there is none.
    pub fixed: Result<FixedPointController, FixedError>,
}

/// Runs the verification's nonlinear experiments with the controller in each kind of numbers. The fixed-point formats come
/// from the readings of the runs in double; its control may deviate by at most `allowed_v` for the same readings.
///
/// # Errors
/// Those of the simulator.
pub fn compare_targets(
    verified: &VerifiedController,
    plant: &Plant,
    procedure: &Procedure,
    allowed_v: f64,
) -> Result<Targets, counterpoise_verify::Error> {
    let runs = TargetRuns::record(verified, plant, procedure, &Serial)?;
    Ok(Targets::of(&runs, runs.single()?, runs.fixed_point_form(allowed_v)?))
}

impl Targets {
    /// Puts the figures of each kind of numbers together.
    pub fn of(runs: &TargetRuns<'_>, single: TargetFigures, fixed: FixedFigures) -> Self {
        let FixedFigures { fixed, figures } = fixed;
        Self { figures: [runs.double(), single].into_iter().chain(figures).collect(), fixed }
    }
}

/// The fixed-point form with its figures, or why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedFigures {
    fixed: Result<FixedPointController, FixedError>,
    figures: Option<TargetFigures>,
}

/// Returns the fixed-point form alone, with formats from the verification's nonlinear runs, or why there is none; see
/// [`compare_targets`].
///
/// # Errors
/// Those of the simulator.
pub fn fixed_form(
    verified: &VerifiedController,
    plant: &Plant,
    procedure: &Procedure,
    allowed_v: f64,
) -> Result<Result<FixedPointController, FixedError>, counterpoise_verify::Error> {
    let TargetRuns { controller, known, samples, .. } =
        TargetRuns::record(verified, plant, procedure, &Serial)?;
    Ok(plan_fixed_point(controller, &known, allowed_v, samples))
}

/// The runs of a controller in double, beside which other numbers are put. Each kind of numbers can be tried by itself.
pub struct TargetRuns<'a> {
    plant: &'a Plant,
    procedure: &'a Procedure,
    controller: &'a Controller,
    pool: &'a dyn Pool,
    runs: Vec<Run>,
    known: Ranges,
    /// Samples of the longest run.
    samples: usize,
}

/// A run of an experiment.
struct Run {
    experiment: Experiment,
    seen: Record,
    errors_rad_s: Vec<f64>,
}

impl<'a> TargetRuns<'a> {
    /// Runs every experiment with the whole controller in double, the experiments as jobs of a pool.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn record(
        verified: &'a VerifiedController,
        plant: &'a Plant,
        procedure: &'a Procedure,
        pool: &'a dyn Pool,
    ) -> Result<Self, counterpoise_verify::Error> {
        let controller = verified.controller();
        let acting = || Box::new(controller.runner()) as Box<dyn SampledController>;
        let runs = run_all(plant, procedure, &experiments(procedure), &acting, pool)?;
        let readings: Vec<_> = runs.iter().map(|run| run.seen.readings.clone()).collect();
        let samples = readings.iter().map(Vec::len).max().unwrap_or(0);
        let known = Ranges::from_readings(controller, &readings, RANGE_MARGIN);
        Ok(Self { plant, procedure, controller, pool, runs, known, samples })
    }

    /// Returns the figures in double.
    pub fn double(&self) -> TargetFigures {
        let predicted = Deviation::none(self.samples);
        let deviations =
            Deviations { numbers: Numbers::Double, predicted, measured: MeasuredDeviation::default() };
        let experiments = self.runs.iter().map(|run| run.compare_to_double(rms(&run.errors_rad_s))).collect();
        let closed_loops = self.runs.iter().map(|run| run.seen.clone()).collect();
        with_runs(deviations, experiments, closed_loops)
    }

    /// Returns the figures in single precision.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn single(&self) -> Result<TargetFigures, counterpoise_verify::Error> {
        let predicted = single_precision(self.controller, &self.known, self.samples);
        let acting = || Box::new(self.controller.runner_in::<f32>()) as Box<dyn AdjustableController>;
        let measured = self.known.measure(&acting);
        self.figures(Deviations { numbers: Numbers::Single, predicted, measured }, &acting)
    }

    /// Returns the fixed-point form with its figures, or why there is none; its control may deviate by at most `allowed_v`.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn fixed_point_form(&self, allowed_v: f64) -> Result<FixedFigures, counterpoise_verify::Error> {
        let fixed = plan_fixed_point(self.controller, &self.known, allowed_v, self.samples);
        let figures = match &fixed {
            Err(_) => None,
            Ok(form) => {
                let acting = || Box::new(FixedRunner::new(form)) as Box<dyn AdjustableController>;
                let (predicted, measured) = (form.deviation, self.known.measure(&acting));
                let deviations = Deviations { numbers: Numbers::Fixed, predicted, measured };
                Some(self.figures(deviations, &acting)?)
            }
        };
        Ok(FixedFigures { fixed, figures })
    }

    /// Returns the controller with its paths in every form, in double and in single precision.
    pub fn figures_by_form(&self) -> Vec<FormFigures> {
        figures_by_form(self.controller, &self.known)
    }

    fn figures(
        &self,
        deviations: Deviations,
        acting: &(dyn Fn() -> Box<dyn AdjustableController> + Sync),
    ) -> Result<TargetFigures, counterpoise_verify::Error> {
        let experiments: Vec<_> = self.runs.iter().map(|run| run.experiment).collect();
        let sampled = || acting() as Box<dyn SampledController>;
        let found = run_all(self.plant, self.procedure, &experiments, &sampled, self.pool)?;
        let in_double = self.runs.iter().map(|run| rms(&run.errors_rad_s));
        let experiments =
            found.iter().zip(in_double).map(|(run, known)| run.compare_to_double(known)).collect();
        let closed_loops = found.into_iter().map(|run| run.seen).collect();
        Ok(with_runs(deviations, experiments, closed_loops))
    }
}

/// The experiments with the whole controller.
fn experiments(procedure: &Procedure) -> Vec<Experiment> {
    let whole = |experiment: &Experiment| match experiment {
        Experiment::Step | Experiment::Triangle | Experiment::Rest => true,
        Experiment::Disturbance(_, arrangement) => *arrangement == Arrangement::Compensated,
    };
    nonlinear_runs::list_experiments(procedure).into_iter().filter(whole).collect()
}

/// Runs experiments with a controller, each as a job.
fn run_all(
    plant: &Plant,
    procedure: &Procedure,
    experiments: &[Experiment],
    acting: &(dyn Fn() -> Box<dyn SampledController> + Sync),
    pool: &dyn Pool,
) -> Result<Vec<Run>, counterpoise_verify::Error> {
    let run = |k: usize| run(&mut Simulator::new(plant)?, acting(), procedure, experiments[k]);
    map_all(pool, experiments.len(), run).into_iter().collect()
}

fn run(
    simulator: &mut Simulator,
    inner: Box<dyn SampledController>,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<Run, counterpoise_verify::Error> {
    let mut recorder = Recorder { inner, seen: Record::default() };
    let history = nonlinear_runs::history_of(simulator, &mut recorder, procedure, experiment)?;
    Ok(Run { experiment, seen: recorder.seen, errors_rad_s: history.tracking_error_rad_s() })
}

impl Run {
    /// Returns the run's error against that in double.
    fn compare_to_double(&self, in_double: f64) -> ExperimentFigures {
        let error_rms_rad_s = rms(&self.errors_rad_s);
        let cost_db = (in_double > 0.0).then(|| 20.0 * (error_rms_rad_s / in_double).log10());
        let errors_rad_s = self.errors_rad_s.clone();
        ExperimentFigures { experiment: self.experiment, error_rms_rad_s, cost_db, errors_rad_s }
    }
}

/// The deviation of the control from the reference in some numbers: what was predicted, and what was measured on recorded readings.
struct Deviations {
    numbers: Numbers,
    predicted: Deviation,
    measured: MeasuredDeviation,
}

fn with_runs(
    deviations: Deviations,
    experiments: Vec<ExperimentFigures>,
    closed_loops: Vec<Record>,
) -> TargetFigures {
    let Deviations { numbers, predicted, measured } = deviations;
    let MeasuredDeviation { largest_v: measured_v, rms_v: measured_rms_v } = measured;
    TargetFigures { numbers, predicted, measured_v, measured_rms_v, experiments, closed_loops }
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e.powi(2)).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

/// A controller whose readings and controls are kept.
struct Recorder {
    inner: Box<dyn SampledController>,
    seen: Record,
}

impl SampledController for Recorder {
    fn reset(&mut self) {
        self.inner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let control_v = self.inner.step(readings);
        self.seen.readings.push(readings.to_array());
        self.seen.controls_v.push(control_v);
        control_v
    }
}
