//! What smaller numbers cost: the controller in double, single and fixed point, side by side in the simulated loop.

use counterpoise_controller::{Controller, READINGS, Readings, SampledController};
use counterpoise_models::plant::Plant;
use counterpoise_simulate::Simulator;
use counterpoise_verify::{Arrangement, Experiment, History, Procedure, VerifiedController, nonlinear};

use crate::{
    Adjustable, Deviation, Fixed, FixedError, FixedRunner, Measured, Ranges, plan_fixed_point,
    single_precision,
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

/// The controller in some numbers, in the simulated loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetFigures {
    /// Which numbers.
    pub numbers: Numbers,
    /// How far the control can be from the reference for the same readings, predicted; exactly 0 for double.
    pub predicted: Deviation,
    /// How far it was, for the readings of the verification's runs and at every setting of the out-of-balance at which a gain
    /// has a corner, V: the runs that the prediction holds for.
    pub measured_v: f64,
    /// RMS of that difference in the run where it is largest, V.
    pub measured_rms_v: f64,
    /// Each experiment with the closed loop's hub rate error in these numbers.
    pub experiments: Vec<ExperimentFigures>,
    /// What the controller read and gave in each experiment's closed loop: code that gives the same moves the plant alike.
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
    /// Which.
    pub experiment: Experiment,
    /// RMS of demand less hub rate, rad/s.
    pub error_rms_rad_s: f64,
    /// That against double, dB: what the numbers cost in rejection. Nothing where the loop in double has no error at all.
    pub cost_db: Option<f64>,
}

/// The comparison of a verified controller's targets.
#[derive(Debug, Clone, PartialEq)]
pub struct Targets {
    /// Double, single and, where it exists, fixed point.
    pub figures: Vec<TargetFigures>,
    /// The fixed-point form, or why there is none.
    pub fixed: Result<Fixed, FixedError>,
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
    let controller = verified.controller();
    let mut bench = Bench { simulator: Simulator::new(plant)?, procedure, runs: Vec::new() };
    bench.record(controller)?;
    let (known, samples) = bench.ranges(controller);
    let fixed = plan_fixed_point(controller, &known, allowed_v, samples);
    let exact = Deviation::none(samples);
    let single = single_precision(controller, &known, samples);
    let in_single = || Box::new(controller.runner_in::<f32>()) as Box<dyn Adjustable>;
    let exactly = (Numbers::Double, exact, Measured::default());
    let singly = (Numbers::Single, single, known.measure(&in_single));
    let mut figures = vec![bench.recorded_figures(exactly), bench.figures(singly, &in_single)?];
    if let Ok(fixed) = &fixed {
        let acting = || Box::new(FixedRunner::new(fixed)) as Box<dyn Adjustable>;
        let found = (Numbers::Fixed, fixed.deviation, known.measure(&acting));
        figures.push(bench.figures(found, &acting)?);
    }
    Ok(Targets { figures, fixed })
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
) -> Result<Result<Fixed, FixedError>, counterpoise_verify::Error> {
    let controller = verified.controller();
    let mut bench = Bench { simulator: Simulator::new(plant)?, procedure, runs: Vec::new() };
    bench.record(controller)?;
    let (known, samples) = bench.ranges(controller);
    Ok(plan_fixed_point(controller, &known, allowed_v, samples))
}

/// What all runs share.
struct Bench<'a> {
    simulator: Simulator,
    procedure: &'a Procedure,
    /// The runs in double.
    runs: Vec<Run>,
}

/// A run of an experiment.
struct Run {
    experiment: Experiment,
    seen: Record,
    error_rms_rad_s: f64,
}

impl Bench<'_> {
    /// Returns the experiments with the whole controller.
    fn experiments(&self) -> Vec<Experiment> {
        let whole = |experiment: &Experiment| match experiment {
            Experiment::Step | Experiment::Triangle | Experiment::Rest => true,
            Experiment::Disturbance(_, arrangement) => *arrangement == Arrangement::Compensated,
        };
        nonlinear::experiments(self.procedure).into_iter().filter(whole).collect()
    }

    /// Runs everything in double and keeps it.
    fn record(&mut self, controller: &Controller) -> Result<(), counterpoise_verify::Error> {
        for experiment in self.experiments() {
            let run = self.run(Box::new(controller.runner()), experiment)?;
            self.runs.push(run);
        }
        Ok(())
    }

    fn run(
        &mut self,
        inner: Box<dyn SampledController>,
        experiment: Experiment,
    ) -> Result<Run, counterpoise_verify::Error> {
        let mut recorder = Recorder { inner, seen: Record::default() };
        let history = nonlinear::history_of(&mut self.simulator, &mut recorder, self.procedure, experiment)?;
        Ok(Run { experiment, seen: recorder.seen, error_rms_rad_s: error_rms(&history) })
    }

    /// Returns the ranges of the recorded runs, and the length of the longest.
    fn ranges(&self, controller: &Controller) -> (Ranges, usize) {
        let readings: Vec<_> = self.runs.iter().map(|run| run.seen.readings.clone()).collect();
        let samples = readings.iter().map(Vec::len).max().unwrap_or(0);
        (Ranges::from_readings(controller, &readings, RANGE_MARGIN), samples)
    }

    /// Returns the figures of the runs in double.
    fn recorded_figures(&self, judged: (Numbers, Deviation, Measured)) -> TargetFigures {
        let experiments = self.runs.iter().map(|run| run.compared(run.error_rms_rad_s)).collect();
        let closed_loops = self.runs.iter().map(|run| run.seen.clone()).collect();
        with_runs(judged, experiments, closed_loops)
    }

    fn figures(
        &mut self,
        judged: (Numbers, Deviation, Measured),
        acting: &dyn Fn() -> Box<dyn Adjustable>,
    ) -> Result<TargetFigures, counterpoise_verify::Error> {
        let (mut experiments, mut closed_loops) = (Vec::new(), Vec::new());
        for k in 0..self.runs.len() {
            let run = self.run(acting(), self.runs[k].experiment)?;
            experiments.push(run.compared(self.runs[k].error_rms_rad_s));
            closed_loops.push(run.seen);
        }
        Ok(with_runs(judged, experiments, closed_loops))
    }
}

impl Run {
    /// Returns the run's error against that in double.
    fn compared(&self, in_double: f64) -> ExperimentFigures {
        let error_rms_rad_s = self.error_rms_rad_s;
        let cost_db = (in_double > 0.0).then(|| 20.0 * (error_rms_rad_s / in_double).log10());
        ExperimentFigures { experiment: self.experiment, error_rms_rad_s, cost_db }
    }
}

fn with_runs(
    (numbers, predicted, measured): (Numbers, Deviation, Measured),
    experiments: Vec<ExperimentFigures>,
    closed_loops: Vec<Record>,
) -> TargetFigures {
    let Measured { largest_v: measured_v, rms_v: measured_rms_v } = measured;
    TargetFigures { numbers, predicted, measured_v, measured_rms_v, experiments, closed_loops }
}

fn error_rms(history: &History) -> f64 {
    let squares = history.demand_rad_s.iter().zip(&history.hub_rate_rad_s).map(|(r, y)| (r - y).powi(2));
    (squares.sum::<f64>() / history.time_s.len().max(1) as f64).sqrt()
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
