//! A few figures, at the cost of no more experiments than they need.

use counterpoise_controller::Controller;
use counterpoise_lti::margins;
use counterpoise_models::plant::Plant;
use counterpoise_simulate::Simulator;

use crate::history::{Experiment, History};
use crate::line_of_sight;
use crate::linear_loop::closed_loop::resolver_use;
use crate::linear_loop::{ArrangedLoop, ClosedLoop, SampledPlant, arrange_controller, surge};
use crate::measure::{MeasuredFigure, Value, history_figures, infinite_figures, loop_figures};
use crate::verification::{linear_history, linear_plant, rejection_figures};
use crate::{Arrangement, Error, MissingReason, Model, PerformanceFigure, Procedure, nonlinear_runs};

/// Measures `wanted`, in that order: infinite if the loop diverges, absent if there is no such number.
///
/// # Errors
/// As [`crate::verify`].
pub fn figures_of(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    wanted: &[PerformanceFigure],
) -> Result<Vec<Value>, Error> {
    let mut found = Vec::new();
    let mut linear: Option<LinearLoop> = None;
    let mut simulator = Simulator::new(plant)?;
    for need in needs(wanted, procedure) {
        let measured = match need {
            Need::Nothing => Vec::new(),
            Need::Simulated(experiment) => {
                simulate_figures(&mut simulator, controller, procedure, experiment)?
            }
            other => {
                let loops = linear.get_or_insert(LinearLoop::new(plant, controller, procedure)?);
                loops.measure(other, procedure)?
            }
        };
        found.extend(measured);
    }
    let value = |figure: &PerformanceFigure| {
        let absent = Value::Absent { why: MissingReason::NotRun };
        found
            .iter()
            .find(|measured| measured.figure == *figure)
            .map_or(absent, |measured| measured.value.clone())
    };
    Ok(wanted.iter().map(value).collect())
}

/// Returns the time history from which a figure is measured; `None` if it is measured from none, or the loop diverges.
///
/// # Errors
/// As [`figures_of`].
pub fn history_of(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    figure: &PerformanceFigure,
) -> Result<Option<History>, Error> {
    match need_of(figure, procedure) {
        Need::Margins | Need::Tone(..) | Need::Nothing => Ok(None),
        Need::Linear(experiment) => {
            LinearLoop::new(plant, controller, procedure)?.history(experiment, procedure)
        }
        Need::Simulated(experiment) => {
            match nonlinear_runs::run_history(&mut Simulator::new(plant)?, controller, procedure, experiment)
            {
                Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => Ok(None),
                other => other.map(Some),
            }
        }
    }
}

/// The work that a figure needs.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Need {
    Margins,
    Tone(Arrangement, f64),
    Linear(Experiment),
    Simulated(Experiment),
    /// No work: a figure of the stability certificate, which is not computed for one of many mechanisms.
    Nothing,
}

fn needs(wanted: &[PerformanceFigure], procedure: &Procedure) -> Vec<Need> {
    let mut needs = Vec::new();
    for figure in wanted {
        let need = need_of(figure, procedure);
        if !needs.contains(&need) {
            needs.push(need);
        }
    }
    needs
}

fn need_of(figure: &PerformanceFigure, procedure: &Procedure) -> Need {
    let on = |model: Model, experiment| match model {
        Model::Linear => Need::Linear(experiment),
        Model::Nonlinear => Need::Simulated(experiment),
    };
    match *figure {
        PerformanceFigure::Loop(_) => Need::Margins,
        PerformanceFigure::Step(model, _) => on(model, Experiment::Step),
        PerformanceFigure::Triangle(model, _) => on(model, Experiment::Triangle),
        PerformanceFigure::Disturbance(model, source, arrangement, _) => {
            on(model, Experiment::Disturbance(source, arrangement))
        }
        PerformanceFigure::Rejection { arrangement, frequency_hz, .. } => {
            Need::Tone(arrangement, frequency_hz)
        }
        PerformanceFigure::Certificate(_) => Need::Nothing,
        PerformanceFigure::Rest(_) => Need::Simulated(Experiment::Rest),
        PerformanceFigure::Sight(_) => Need::Simulated(line_of_sight::sight_experiment(procedure)),
    }
}

fn simulate_figures(
    simulator: &mut Simulator,
    controller: &Controller,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<Vec<MeasuredFigure>, Error> {
    match nonlinear_runs::run_history(simulator, controller, procedure, experiment) {
        Ok(history) => {
            let mut figures = history_figures(&history, procedure.settle_s);
            figures.extend(line_of_sight::figures(&history, procedure, simulator.plant().into()));
            Ok(figures)
        }
        Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => {
            let mut figures = infinite_figures(Model::Nonlinear, experiment);
            figures.extend(line_of_sight::infinite_figures(procedure, experiment));
            Ok(figures)
        }
        Err(error) => Err(error),
    }
}

/// The linear plant with the controller that closes it.
struct LinearLoop<'a> {
    sampled: SampledPlant,
    controller: &'a Controller,
}

impl<'a> LinearLoop<'a> {
    fn new(plant: &Plant, controller: &'a Controller, procedure: &Procedure) -> Result<Self, Error> {
        let linear = linear_plant(plant, procedure)?;
        let sampled = SampledPlant::new(&linear, plant.parameters(), resolver_use(controller))?;
        Ok(Self { sampled, controller })
    }

    fn close_loop(&self, arrangement: Arrangement) -> Result<ClosedLoop, Error> {
        let moment = self.controller.parts().design_out_of_balance_kg_m;
        ClosedLoop::new(&self.sampled, arrange_controller(self.controller, arrangement)?.as_ref(), moment)
    }

    fn measure(&self, need: Need, procedure: &Procedure) -> Result<Vec<MeasuredFigure>, Error> {
        match need {
            Need::Nothing => Ok(Vec::new()),
            Need::Margins => {
                let closed = self.close_loop(Arrangement::Compensated)?;
                let broken = closed.broken.as_ref().ok_or(Error::NoController)?;
                Ok(loop_figures(&margins(broken)?, closed.pole_radius()))
            }
            Need::Tone(arrangement, hz) => {
                rejection_figures(&self.sampled, &self.close_loop(arrangement)?, arrangement, &[hz])
            }
            Need::Linear(experiment) | Need::Simulated(experiment) => {
                let found = self.history(experiment, procedure)?;
                Ok(found.map_or_else(
                    || infinite_figures(Model::Linear, experiment),
                    |history| history_figures(&history, procedure.settle_s),
                ))
            }
        }
    }

    /// The history of an experiment on the linear plant; `None` if the loop is unstable.
    fn history(&self, experiment: Experiment, procedure: &Procedure) -> Result<Option<History>, Error> {
        let arrangement = match experiment {
            Experiment::Disturbance(_, arrangement) => arrangement,
            Experiment::Step | Experiment::Triangle | Experiment::Rest => Arrangement::Compensated,
        };
        let closed = self.close_loop(arrangement)?;
        let Some(mut history) = linear_history(&self.sampled, &closed, procedure, experiment)? else {
            return Ok(None);
        };
        let loops = self.loops_with_surge(arrangement, closed)?;
        surge::add_surge(&mut history, &self.sampled, &loops, procedure)?;
        Ok(Some(history))
    }

    /// Returns the loop of an arrangement with the one that meets surge, where that is another.
    fn loops_with_surge(
        &self,
        arrangement: Arrangement,
        closed: ClosedLoop,
    ) -> Result<Vec<ArrangedLoop>, Error> {
        let meets = surge::acting_arrangement(&self.sampled, arrangement);
        let mut loops = vec![ArrangedLoop { arrangement, closed }];
        if meets != arrangement {
            loops.push(ArrangedLoop { arrangement: meets, closed: self.close_loop(meets)? });
        }
        Ok(loops)
    }
}
