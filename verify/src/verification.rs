//! The verification of one controller on one mechanism.

use counterpoise_controller::Controller;
use counterpoise_linalg::C64;
use counterpoise_lti::{Margins, StateSpace, margins};
use counterpoise_models::ControlledQuantity;
use counterpoise_models::plant::{LinearPlant, Plant};
use counterpoise_simulate::Simulator;

use crate::Quantity;
use crate::certificate::{Regime, StabilityCertificate};
use crate::error_budget::{ErrorBudget, error_budget};
use crate::history::{Experiment, History};
use crate::line_of_sight;
use crate::linear_loop::closed_loop::is_feedforward;
use crate::linear_loop::frequency::compute_rejections;
use crate::linear_loop::{self, ArrangedLoop, ClosedLoop, Curves, SampledPlant, arrange_controller};
use crate::measure::{MeasuredFigure, Value, history_figures, infinite_figures, loop_figures};
use crate::tolerance::WORSE_FEEDFORWARD;
use crate::{
    ARRANGEMENTS, Arrangement, CertificateFigure, Error, HeaveAndPitch, MissingReason, Model,
    PerformanceFigure, Procedure, Requirement, Source, Verdict, nonlinear_runs,
};

/// Result of a verification: the measured figures, their verdicts, and the records that they were computed from.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Every figure that was measured.
    pub figures: Vec<MeasuredFigure>,
    /// Every requirement with its verdict, in the order given.
    pub verdicts: Vec<(Requirement, Verdict)>,
    /// Records from which the figures were read.
    pub evidence: Evidence,
    /// Error budget of the line of sight; `None` if the procedure does not request it.
    pub error_budget: Option<ErrorBudget>,
    /// The case and the regime of the certificate that are nearest to instability; `None` without a certificate.
    pub worst_regime: Option<WorstRegime>,
}

/// The regime that is nearest to instability, or furthest beyond it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorstRegime {
    /// Name of the case.
    pub case: String,
    /// The regime.
    pub regime: Regime,
}

/// Curves and time histories.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// The control that holds the mechanism at rest, V.
    pub holding_v: f64,
    /// Poles of the closed loop with the whole controller, in the z-plane.
    pub poles: Vec<C64>,
    /// The loop broken at the plant's input, for negative feedback: 1 + L is the return difference.
    pub broken: StateSpace,
    /// All crossings and peaks of the loop broken at the plant's input.
    pub margins: Margins,
    /// Frequency responses.
    pub curves: Curves,
    /// Time histories: linear first.
    pub histories: Vec<History>,
    /// The procedure that was applied to the mechanism.
    pub procedure: Procedure,
    /// Quantity that the loop controls; figures and histories have its names and unit.
    pub controlled: ControlledQuantity,
}

impl Evidence {
    /// Returns the largest sensitivity of the loop, dB.
    pub fn largest_sensitivity_db(&self) -> f64 {
        20.0 * self.margins.ms.value.log10()
    }
}

/// A controller that has been verified: the only thing that can be exported. It is made by [`verify`] alone, whatever the verdicts,
/// and cannot be changed afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifiedController {
    controller: Controller,
    verification: Verification,
}

impl VerifiedController {
    /// Returns the controller.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Returns what its verification found.
    pub fn verification(&self) -> &Verification {
        &self.verification
    }

    /// Takes the figures of a certificate of the same controller into its verification, and judges the requirements on them.
    pub fn take_certificate(&mut self, found: &StabilityCertificate) {
        self.verification.take_certificate(found);
    }

    /// Returns the controller with what its verification found.
    pub fn into_parts(self) -> (Controller, Verification) {
        (self.controller, self.verification)
    }
}

/// A motion of the platform under which the feedforwards make what the loop controls worse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorseFeedforward {
    /// On which plant.
    pub model: Model,
    /// Under which motion.
    pub source: Source,
    /// RMS with feedback alone.
    pub without: f64,
    /// RMS with the feedforwards.
    pub with: f64,
}

impl Verification {
    /// Returns the motions of the platform under which the feedforwards make the RMS of what the loop controls worse.
    pub fn worse_feedforwards(&self) -> Vec<WorseFeedforward> {
        let mut worse = Vec::new();
        for model in [Model::Nonlinear, Model::Linear] {
            for source in [Source::Heave, Source::Pitch, Source::Both, Source::Road] {
                let rms = |arrangement| {
                    self.value(PerformanceFigure::Disturbance(model, source, arrangement, Quantity::HubRms))
                };
                let both = rms(Arrangement::Feedback).zip(rms(Arrangement::Compensated));
                let found = both.filter(|(without, with)| *with > WORSE_FEEDFORWARD * without);
                worse.extend(found.map(|(without, with)| WorseFeedforward { model, source, without, with }));
            }
        }
        worse
    }

    /// Returns what the loop controls.
    pub fn controlled_quantity(&self) -> ControlledQuantity {
        self.evidence.controlled
    }

    /// Returns the value of a figure; `None` if it was not measured.
    pub fn value(&self, figure: PerformanceFigure) -> Option<f64> {
        value_of(&self.figures, figure)
    }

    /// Returns how many requirements hold, fail, and could not be judged.
    pub fn counts(&self) -> (usize, usize, usize) {
        let count =
            |which: fn(&Verdict) -> bool| self.verdicts.iter().filter(|(_, verdict)| which(verdict)).count();
        (
            count(|v| matches!(v, Verdict::Holds { .. })),
            count(|v| matches!(v, Verdict::Fails { .. })),
            count(|v| matches!(v, Verdict::NotApplicable { .. })),
        )
    }

    /// Returns whether no requirement fails, the closed loop is stable and, by the certificate if there is one, no motion grows by itself.
    pub fn passes(&self) -> bool {
        let cycle = self.value(PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak));
        let grows = cycle == Some(f64::INFINITY);
        self.counts().1 == 0 && self.evidence.margins.closed_loop_stable && !grows
    }

    /// Returns a time history, where it was run.
    pub fn history(&self, model: Model, experiment: Experiment) -> Option<&History> {
        self.evidence
            .histories
            .iter()
            .find(|history| (history.model, history.experiment) == (model, experiment))
    }

    /// Why a figure was not measured.
    fn not_run(&self, figure: PerformanceFigure) -> MissingReason {
        let simulated = self.evidence.histories.iter().any(|history| history.model == Model::Nonlinear);
        match figure {
            PerformanceFigure::Disturbance(_, Source::Road, ..) if !self.saw_a_road() => {
                MissingReason::NoRoad
            }
            PerformanceFigure::Sight(_) if self.evidence.procedure.line_of_sight.is_none() => {
                MissingReason::NoLineOfSight
            }
            PerformanceFigure::Sight(figure)
                if self.evidence.procedure.line_of_sight.is_some_and(|sight| !sight.has(figure)) =>
            {
                line_of_sight::missing_section(figure)
            }
            PerformanceFigure::Certificate(_) => MissingReason::NoCertificate,
            PerformanceFigure::Triangle(..) if !self.saw_a_triangle() => MissingReason::NoTriangle,
            PerformanceFigure::Step(Model::Nonlinear, _)
            | PerformanceFigure::Triangle(Model::Nonlinear, _)
            | PerformanceFigure::Disturbance(Model::Nonlinear, ..)
            | PerformanceFigure::Rest(_)
            | PerformanceFigure::Sight(_)
                if !simulated =>
            {
                MissingReason::LinearPlantAlone
            }
            _ => MissingReason::NotRun,
        }
    }

    /// Returns what the loop may reach at most in the step, for a largest overshoot in percent: the demand at its end, raised by that; 0
    /// if no step was run on the plant.
    pub fn highest_allowed_rad_s(&self, model: Model, overshoot_percent: f64) -> f64 {
        let step = self.history(model, Experiment::Step);
        let demand = step.and_then(|step| step.demand_rad_s().last().copied()).unwrap_or_default();
        demand * (1.0 + 0.01 * overshoot_percent)
    }

    fn saw_a_road(&self) -> bool {
        let on_road = |figure| matches!(figure, PerformanceFigure::Disturbance(_, Source::Road, ..));
        self.figures.iter().any(|measured| on_road(measured.figure))
    }

    fn saw_a_triangle(&self) -> bool {
        self.figures.iter().any(|measured| matches!(measured.figure, PerformanceFigure::Triangle(..)))
    }

    /// Takes the figures of the certificate of the controller that was verified, and judges the requirements on them.
    pub fn take_certificate(&mut self, found: &StabilityCertificate) {
        self.worst_regime = found
            .nearest_to_instability()
            .map(|(case, at)| WorstRegime { case: case.name.clone(), regime: at.regime });
        self.figures.retain(|measured| !matches!(measured.figure, PerformanceFigure::Certificate(_)));
        self.figures.extend(found.figures());
        let requirements: Vec<Requirement> = self.verdicts.drain(..).map(|(required, _)| required).collect();
        self.judge(&requirements);
    }

    fn judge(&mut self, requirements: &[Requirement]) {
        let verdict = |requirement: &Requirement| match self
            .figures
            .iter()
            .find(|measured| measured.figure == requirement.figure)
            .map(|m| &m.value)
        {
            Some(Value::Is(number)) => requirement.judge(*number),
            Some(Value::Absent { why }) => Verdict::NotApplicable { why: why.clone() },
            None => Verdict::NotApplicable { why: self.not_run(requirement.figure) },
        };
        self.verdicts =
            requirements.iter().map(|requirement| (requirement.clone(), verdict(requirement))).collect();
    }
}

/// Measures every figure of `controller` on `plant`, linear and nonlinear, and judges it against `requirements`.
///
/// The controller is the discrete one that will be exported; nothing is taken from its design. "Without control" means the constant
/// voltage that holds the out-of-balance: a mechanism left to itself would fall. The out-of-balance that the controller is told is
/// the one it was designed for.
///
/// # Errors
/// [`Error::Period`] if controller and interface have two clocks, [`Error::Range`] and others for a procedure that cannot be run,
/// and those of the plant, the controller and the simulator. A requirement that fails is a verdict, not an error.
pub fn verify(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    requirements: &[Requirement],
) -> Result<VerifiedController, Error> {
    procedure.check()?;
    let mut found = linear_part(plant, controller, procedure, requirements)?;
    nonlinear_part(plant, controller, procedure, &mut found, &mut |_| true)?;
    found.judge(requirements);
    Ok(VerifiedController { controller: controller.clone(), verification: found })
}

/// Verifies as [`verify`] does and calls `watch` with the findings so far, first after the linear part and then after each run on
/// the nonlinear plant. Returns `None` if `watch` returns `false`, which cancels the verification.
///
/// # Errors
/// As [`verify`].
pub fn verify_watched(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    requirements: &[Requirement],
    watch: &mut dyn FnMut(&Verification) -> bool,
) -> Result<Option<VerifiedController>, Error> {
    procedure.check()?;
    let mut found = linear_part(plant, controller, procedure, requirements)?;
    found.judge(requirements);
    if !watch(&found) {
        return Ok(None);
    }
    let mut judging = |found: &mut Verification| {
        found.judge(requirements);
        watch(found)
    };
    let whole = nonlinear_part(plant, controller, procedure, &mut found, &mut judging)?;
    Ok(whole.then(|| VerifiedController { controller: controller.clone(), verification: found }))
}

/// Runs every experiment on the nonlinear plant; a motion that diverges has infinite figures and no history. Says whether it came
/// to the end: `go_on` is asked after each.
fn nonlinear_part(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    found: &mut Verification,
    go_on: &mut dyn FnMut(&mut Verification) -> bool,
) -> Result<bool, Error> {
    let mut simulator = Simulator::new(plant)?;
    for experiment in nonlinear_runs::list_experiments(procedure) {
        let known = same_run(controller, experiment, &found.evidence.histories);
        let run = || nonlinear_runs::run_history(&mut simulator, controller, procedure, experiment);
        match known.map_or_else(run, Ok) {
            Ok(history) => {
                found.figures.extend(history_figures(&history, procedure.settle_s));
                found.figures.extend(line_of_sight::figures(&history, procedure, plant.into()));
                found.evidence.histories.push(history);
            }
            Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => {
                found.figures.extend(infinite_figures(Model::Nonlinear, experiment));
                found.figures.extend(line_of_sight::infinite_figures(procedure, experiment));
            }
            Err(error) => return Err(error),
        }
        if !go_on(found) {
            return Ok(false);
        }
    }
    found.error_budget = error_budget(plant, controller, procedure)?;
    Ok(true)
}

/// Returns the history of an experiment that is the same run as one before: without feedforward the feedback is the whole controller.
fn same_run(controller: &Controller, experiment: Experiment, histories: &[History]) -> Option<History> {
    let Experiment::Disturbance(source, arrangement) = experiment else { return None };
    if controller.parts().paths.iter().any(is_feedforward) {
        return None;
    }
    let other = match arrangement {
        Arrangement::Uncontrolled => return None,
        Arrangement::Feedback => Arrangement::Compensated,
        Arrangement::Compensated => Arrangement::Feedback,
    };
    let same = Experiment::Disturbance(source, other);
    let known = histories.iter().find(|h| h.model == Model::Nonlinear && h.experiment == same)?;
    let mut history = known.clone();
    history.experiment = experiment;
    Some(history)
}

/// Returns the plant linearised where the procedure has it stand. In a loop of rate its angles are left out, so that gravity's
/// gradient and a position spring appear in the nonlinear figures alone; in a loop of position they are part of it.
///
/// # Errors
/// Those of the linearisation.
pub fn linear_plant(plant: &Plant, procedure: &Procedure) -> Result<LinearPlant, Error> {
    Ok(plant.linearise(&plant.equilibrium(&procedure.operating_point), procedure.friction, plant.angles())?)
}

/// Returns the linear figures and evidence alone, judged against `requirements`: what needs no simulator.
///
/// # Errors
/// As [`verify`].
pub fn verify_linear(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    requirements: &[Requirement],
) -> Result<Verification, Error> {
    procedure.check()?;
    let mut found = linear_part(plant, controller, procedure, requirements)?;
    found.judge(requirements);
    Ok(found)
}

/// Returns the figures of the linear loop that need no motion: the loop's and its rejections at the procedure's frequencies.
///
/// # Errors
/// As [`verify`].
pub fn frequency_figures(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<FrequencyFigures, Error> {
    procedure.check()?;
    let LinearLoops { figures, margins, .. } = linear_loops(plant, controller, procedure, &[])?;
    Ok(FrequencyFigures { figures, is_stable: margins.closed_loop_stable })
}

/// Figures of a linear loop that need no motion.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyFigures {
    figures: Vec<MeasuredFigure>,
    /// `true` if the closed loop is stable.
    pub is_stable: bool,
}

impl FrequencyFigures {
    /// Returns the value of a figure; `None` if it was not measured.
    pub fn value(&self, figure: PerformanceFigure) -> Option<f64> {
        value_of(&self.figures, figure)
    }
}

fn value_of(figures: &[MeasuredFigure], figure: PerformanceFigure) -> Option<f64> {
    figures.iter().find(|measured| measured.figure == figure).and_then(|measured| match measured.value {
        Value::Is(number) => Some(number),
        Value::Absent { .. } => None,
    })
}

/// The sampled linear plant with its loops in every arrangement, and what they show in frequency.
struct LinearLoops {
    sampled: SampledPlant,
    loops: Vec<ArrangedLoop>,
    broken: StateSpace,
    margins: Margins,
    figures: Vec<MeasuredFigure>,
}

fn linear_loops(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    requirements: &[Requirement],
) -> Result<LinearLoops, Error> {
    let resolver = linear_loop::closed_loop::resolver_use(controller);
    let sampled = SampledPlant::new(&linear_plant(plant, procedure)?, plant.parameters(), resolver)?;
    let moment = controller.parts().design_out_of_balance_kg_m;
    let mut loops = Vec::new();
    for arrangement in ARRANGEMENTS {
        let closed =
            ClosedLoop::new(&sampled, arrange_controller(controller, arrangement)?.as_ref(), moment)?;
        loops.push(ArrangedLoop { arrangement, closed });
    }
    let whole = &loops[loops.len() - 1].closed;
    let broken = whole.broken.clone().ok_or(Error::NoController)?;
    let margins = margins(&broken)?;
    let mut figures = loop_figures(&margins, whole.pole_radius());
    let frequencies = rejection_frequencies(procedure, requirements);
    for ArrangedLoop { arrangement, closed } in &loops {
        figures.extend(rejection_figures(&sampled, closed, *arrangement, &frequencies)?);
    }
    Ok(LinearLoops { sampled, loops, broken, margins, figures })
}

fn linear_part(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    requirements: &[Requirement],
) -> Result<Verification, Error> {
    let LinearLoops { sampled, loops, broken, margins, mut figures } =
        linear_loops(plant, controller, procedure, requirements)?;
    let mut histories = Vec::new();
    linear_histories(&sampled, &loops, procedure, &mut figures, &mut histories)?;
    let curves = Curves::of(&sampled, &loops)?;
    let evidence = Evidence {
        sample_period_s: sampled.sample_period_s,
        holding_v: sampled.holding_v,
        poles: loops.last().map(|whole| whole.closed.poles.clone()).unwrap_or_default(),
        broken,
        margins,
        curves,
        histories,
        procedure: procedure.clone(),
        controlled: plant.parameters().controlled_quantity(),
    };
    Ok(Verification { figures, verdicts: Vec::new(), evidence, error_budget: None, worst_regime: None })
}

/// The procedure's frequencies and those that requirements name.
fn rejection_frequencies(procedure: &Procedure, requirements: &[Requirement]) -> Vec<f64> {
    let named = requirements.iter().filter_map(|requirement| match requirement.figure {
        PerformanceFigure::Rejection { frequency_hz, .. } => Some(frequency_hz),
        _ => None,
    });
    let mut all: Vec<f64> = procedure.rejection_hz.iter().copied().chain(named).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

pub(crate) fn rejection_figures(
    sampled: &SampledPlant,
    closed: &ClosedLoop,
    arrangement: Arrangement,
    frequencies: &[f64],
) -> Result<Vec<MeasuredFigure>, Error> {
    let mut figures = Vec::new();
    let stable = arrangement == Arrangement::Uncontrolled || closed.pole_radius() < 1.0;
    for rejection in compute_rejections(sampled, closed, arrangement, frequencies)? {
        for (frequency_hz, h) in frequencies.iter().zip(&rejection.response) {
            let figure = PerformanceFigure::Rejection {
                source: rejection.source,
                arrangement,
                frequency_hz: *frequency_hz,
            };
            let db = if stable { 20.0 * h.norm().log10() } else { f64::INFINITY };
            figures.push(MeasuredFigure { figure, value: Value::Is(db) });
        }
    }
    Ok(figures)
}

/// Runs the step with the whole controller and every disturbance in every arrangement.
fn linear_histories(
    sampled: &SampledPlant,
    loops: &[ArrangedLoop],
    procedure: &Procedure,
    figures: &mut Vec<MeasuredFigure>,
    histories: &mut Vec<History>,
) -> Result<(), Error> {
    for ArrangedLoop { arrangement, closed } in loops {
        for experiment in experiments(procedure, *arrangement) {
            match linear_history(sampled, closed, procedure, experiment)? {
                None => figures.extend(infinite_figures(Model::Linear, experiment)),
                Some(mut history) => {
                    linear_loop::surge::add_surge(&mut history, sampled, loops, procedure)?;
                    figures.extend(history_figures(&history, procedure.settle_s));
                    histories.push(history);
                }
            }
        }
    }
    Ok(())
}

/// Runs one experiment on the linear plant. Returns `None` if the closed loop is unstable.
pub(crate) fn linear_history(
    sampled: &SampledPlant,
    closed: &ClosedLoop,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<Option<History>, Error> {
    if closed.controller.is_some() && closed.pole_radius() >= 1.0 {
        return Ok(None);
    }
    let history = match experiment {
        Experiment::Disturbance(source, arrangement) => {
            let motion = |time_s: f64| procedure.motion(source, time_s);
            let duration_s = procedure.duration_of(source);
            linear_loop::simulate_disturbance(sampled, closed, source, arrangement, duration_s, motion)?
        }
        Experiment::Step | Experiment::Rest => linear_loop::simulate_step(sampled, closed, procedure.step)?,
        Experiment::Triangle => {
            let Some(triangle) = procedure.triangle else { return Ok(None) };
            linear_loop::simulate_triangle(sampled, closed, triangle, procedure.duration_s)?
        }
    };
    Ok(Some(history))
}

/// Returns what is run in an arrangement on the linear plant: nothing to see at rest.
fn experiments(procedure: &Procedure, arrangement: Arrangement) -> Vec<Experiment> {
    let whole = arrangement == Arrangement::Compensated;
    let triangle = procedure.triangle.filter(|_| whole).map(|_| Experiment::Triangle);
    let disturbances =
        procedure.sources().into_iter().map(|source| Experiment::Disturbance(source, arrangement));
    whole.then_some(Experiment::Step).into_iter().chain(triangle).chain(disturbances).collect()
}

impl Procedure {
    /// Returns the disturbances that are run.
    pub fn sources(&self) -> Vec<Source> {
        let road = self.road.as_ref().map(|_| Source::Road);
        [Source::Heave, Source::Pitch, Source::Both].into_iter().chain(road).collect()
    }

    /// Returns how long a disturbance lasts, s.
    pub fn duration_of(&self, source: Source) -> f64 {
        match (source, &self.road) {
            (Source::Road, Some(road)) => road.duration_s(),
            _ => self.duration_s,
        }
    }

    /// Returns the platform's motion of a disturbance at a time.
    pub fn motion(&self, source: Source, time_s: f64) -> HeaveAndPitch {
        let (heave, pitch) = (|| self.heave.at(time_s), || self.pitch.at(time_s));
        match source {
            Source::Heave => HeaveAndPitch { heave_m_s2: heave(), pitch_rate_rad_s: 0.0 },
            Source::Pitch => HeaveAndPitch { heave_m_s2: 0.0, pitch_rate_rad_s: pitch() },
            Source::Both => HeaveAndPitch { heave_m_s2: heave(), pitch_rate_rad_s: pitch() },
            Source::Road => self.road.as_ref().map_or(HeaveAndPitch::default(), |road| road.at(time_s)),
        }
    }
}
