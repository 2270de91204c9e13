//! Data that the rows share: the design of the project's mechanism, variants of it, and the experiments on them.

use counterpoise_controller::Controller;
use counterpoise_lti::{Response, StateSpace};
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_simulate::Simulator;
use counterpoise_verify::history::{Experiment, History};
use counterpoise_verify::robustness::figures_of;
use counterpoise_verify::{
    Arrangement, Model, PerformanceFigure, Procedure, Quantity, Source, StepFigure, Value, nonlinear_runs,
};

use super::drawing::{
    ClaimCurve, factor_axis, hub_from, hub_panel, hub_rates, make_figure, make_panel, time_axis,
};
use super::friction_identification::{IdentifiedFriction, identify_friction, with_observer};
use counterpoise_pipeline::{DesignStages, PipelineError, World, run_stages, synthesise};
use counterpoise_plot::{Axis, Figure as Drawing, Point};
use counterpoise_project::Project;

/// A design that is put to the test.
pub struct TestedDesign<'a> {
    /// The project.
    pub project: &'a Project,
    /// Files beside it.
    pub world: &'a (dyn World + Sync),
    /// Design.
    pub designed: DesignStages,
    /// Procedure of the verification.
    pub procedure: Procedure,
    /// The friction as it was identified from a recording.
    pub friction: IdentifiedFriction,
    /// The project whose controller observes the identified friction, as the thesis uses it on the nonlinear plant.
    pub observing_project: Project,
    /// The controller that the design of this project exports.
    pub observed: Controller,
}

/// Figures of a step and of the platform in motion on the nonlinear plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonlinearBehaviour {
    /// Step overshoot, %.
    pub overshoot_percent: f64,
    /// Step peak time, s.
    pub peak_time_s: f64,
    /// Step steady-state error, %.
    pub steady_error_percent: f64,
    /// RMS hub rate under heave and pitch with all feedforwards, rad/s.
    pub residual_rad_s: f64,
    /// Fraction of the time during which the gear teeth are apart.
    pub gear_open: f64,
}

/// A mechanism and its controller, to be drawn beside others.
pub struct DrawnMechanism<'a> {
    /// Name in the legend.
    pub name: String,
    /// The mechanism.
    pub parameters: Parameters,
    /// The controller.
    pub controller: &'a Controller,
}

/// Part of a step that is drawn, s.
const DRAWN_S: f64 = 0.8;

/// A level that is drawn across a panel, with its name.
#[derive(Debug, Clone, Copy)]
pub struct NamedLevel<'a> {
    /// Position, in the unit of the panel.
    pub y: f64,
    /// Name in the legend.
    pub text: &'a str,
}

/// Returns the plot of overshoot and residual rate over a factor; `says` are levels of the thesis' overshoot with their names.
pub fn plot_over_factor(
    what: &str,
    factors: &[f64],
    found: &[NonlinearBehaviour],
    says: &[NamedLevel<'_>],
    others: [Vec<ClaimCurve>; 2],
) -> Drawing {
    let over = |of: &dyn Fn(&NonlinearBehaviour) -> f64| {
        factors.iter().zip(found).map(|(x, b)| Point::new(*x, of(b))).collect()
    };
    let overshoot = ClaimCurve::points("with the observer", over(&|b| b.overshoot_percent));
    let residual = ClaimCurve::points("with the observer", over(&|b| 1e3 * b.residual_rad_s));
    let [others_over, others_left] = others;
    let with = |own: ClaimCurve, others: Vec<ClaimCurve>| std::iter::once(own).chain(others).collect();
    let first = make_panel(Axis::linear("overshoot", "%"), with(overshoot, others_over));
    let first = says.iter().fold(first, |panel, level| panel.with_level(level.y, level.text));
    let panels = vec![first, make_panel(Axis::linear("RMS hub rate", "mrad/s"), with(residual, others_left))];
    make_figure(format!("Overshoot and residual over {what}"), factor_axis(what), panels)
}

impl<'a> TestedDesign<'a> {
    /// Designs and verifies the project.
    ///
    /// # Errors
    /// Those of the pipeline.
    pub fn new(project: &'a Project, world: &'a (dyn World + Sync)) -> Result<Self, PipelineError> {
        let designed = run_stages(project, &HeaderText, world)?;
        let procedure = designed.procedure.clone();
        let friction = identify_friction(&designed.modelled.parameters)?;
        let observing_project = with_observer(project, &friction);
        let observed = run_stages(&observing_project, &HeaderText, world)?.verified.controller().clone();
        Ok(Self { project, world, designed, procedure, friction, observing_project, observed })
    }

    /// Returns the mechanism's parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.designed.modelled.parameters
    }

    /// Returns the controller as exported.
    pub fn controller(&self) -> &Controller {
        self.designed.verified.controller()
    }

    /// Returns the controller that a design would export if its observer were identified on another
    /// mechanism.
    ///
    /// # Errors
    /// Those of the identification and of the design.
    pub fn observing_on(&self, mechanism: &Parameters) -> Result<Controller, PipelineError> {
        let project = with_observer(self.project, &identify_friction(mechanism)?);
        let made = &self.designed;
        Ok(synthesise(&project, &made.modelled, &made.reduced)?.sampled.controller)
    }

    /// Returns a figure of the verification, NaN if it was not measured.
    pub fn value(&self, figure: PerformanceFigure) -> f64 {
        self.designed.verified.verification().value(figure).unwrap_or(f64::NAN)
    }

    /// Returns the design of a project that differs.
    ///
    /// # Errors
    /// Those of the pipeline.
    pub fn redesign(&self, change: impl FnOnce(&mut Project)) -> Result<DesignStages, PipelineError> {
        let mut project = self.project.clone();
        change(&mut project);
        run_stages(&project, &HeaderText, self.world)
    }

    /// Returns figures of a controller on a mechanism.
    ///
    /// # Errors
    /// Those of the verification.
    pub fn figures(
        &self,
        parameters: &Parameters,
        controller: &Controller,
        wanted: &[PerformanceFigure],
    ) -> Result<Vec<f64>, PipelineError> {
        let values = figures_of(&Plant::from_lumped(parameters)?, controller, &self.procedure, wanted)?;
        Ok(values
            .iter()
            .map(|value| if let Value::Is(number) = value { *number } else { f64::NAN })
            .collect())
    }

    /// Returns step and stabilisation of a controller on a mechanism.
    ///
    /// # Errors
    /// Those of the verification.
    pub fn behaviour(
        &self,
        parameters: &Parameters,
        controller: &Controller,
    ) -> Result<NonlinearBehaviour, PipelineError> {
        let step = |figure| PerformanceFigure::Step(Model::Nonlinear, figure);
        let under = |quantity| {
            PerformanceFigure::Disturbance(Model::Nonlinear, Source::Both, Arrangement::Compensated, quantity)
        };
        let wanted = [
            step(StepFigure::Overshoot),
            step(StepFigure::PeakTime),
            step(StepFigure::SteadyStateError),
            under(Quantity::HubRms),
            under(Quantity::GearOpen),
        ];
        let found = self.figures(parameters, controller, &wanted)?;
        Ok(NonlinearBehaviour {
            overshoot_percent: found[0],
            peak_time_s: found[1],
            steady_error_percent: found[2],
            residual_rad_s: found[3],
            gear_open: found[4],
        })
    }

    /// Returns members of a family, the step and the platform in motion drawn over each other, and its figures over the
    /// factor.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn family_drawings(
        &self,
        name: &str,
        members: &[DrawnMechanism<'_>],
    ) -> Result<Vec<Drawing>, PipelineError> {
        let moving = Experiment::Disturbance(Source::Both, Arrangement::Compensated);
        let (mut steps, mut motions) = (Vec::new(), Vec::new());
        for member in members {
            let run = |experiment| self.history(&member.parameters, member.controller, experiment);
            let step = hub_rates(&run(Experiment::Step)?);
            steps.push(ClaimCurve::line(
                member.name.clone(),
                step.into_iter().filter(|at| at.x <= DRAWN_S).collect(),
            ));
            motions.push(ClaimCurve::line(
                member.name.clone(),
                hub_from(&run(moving)?, self.procedure.settle_s),
            ));
        }
        let height = 1e3 * self.procedure.step.rate_rad_s;
        Ok(vec![
            make_figure(
                format!("Step of the demand, {name}"),
                time_axis(),
                vec![hub_panel(steps).with_level(height, "demand")],
            ),
            make_figure(
                format!("Heave and pitch with all feedforwards, {name}"),
                time_axis(),
                vec![hub_panel(motions)],
            ),
        ])
    }

    /// Returns a time history of a controller on a mechanism.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn history(
        &self,
        parameters: &Parameters,
        controller: &Controller,
        experiment: Experiment,
    ) -> Result<History, PipelineError> {
        let mut simulator = Simulator::new(&Plant::from_lumped(parameters)?)?;
        Ok(nonlinear_runs::run_history(&mut simulator, controller, &self.procedure, experiment)?)
    }
}

/// Returns the largest difference in dB between two systems of one output over a band, over the given input.
///
/// # Errors
/// A response that does not exist.
pub fn largest_db(
    a: &StateSpace,
    b: &StateSpace,
    input: usize,
    band_hz: [f64; 2],
) -> Result<f64, PipelineError> {
    let rates = rate_grid(band_hz);
    let (x, y) = (Response::of(a)?.at_all(&rates)?, Response::of(b)?.at_all(&rates)?);
    let difference = |k: usize| 20.0 * (x[k][(0, input)].norm() / y[k][(0, input)].norm()).log10();
    Ok((0..rates.len()).map(|k| difference(k).abs()).fold(0.0, f64::max))
}

/// Returns two hundred rates in rad/s over a band in Hz.
pub fn rate_grid([low, high]: [f64; 2]) -> Vec<f64> {
    let ratio: f64 = (high / low).ln() / 199.0;
    (0..200).map(|k| std::f64::consts::TAU * low * (ratio * f64::from(k)).exp()).collect()
}
