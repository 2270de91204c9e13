//! A run of a trial: the exported controller with an adaptation, without one, or with the load known, on the simulator.

use counterpoise_controller::{Controller, Readings, Runner, SampledController};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{AdaptationMethod, AdaptationOptions};
use counterpoise_simulate::{Imperfections, Initial, PlantState, PlatformMotion, Scenario, Simulator};
use counterpoise_verify::Procedure;

use super::excitation::{
    CHANGE, TrialLoad, TrialMotion, load_parts, measured_from_s, motion_from, platform_motion,
};
use crate::synth::controller_blocks::estimator;
use crate::synth::schedule::scale_imbalance;
use crate::{PipelineError, PlantModel};

/// The controller that acts in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TrialController {
    Without,
    Told,
    Adapts(AdaptationMethod),
}

pub(crate) struct Stage<'a> {
    pub project: &'a Project,
    pub adaptation: &'a AdaptationOptions,
    pub modelled: &'a PlantModel,
    pub controller: &'a Controller,
    pub procedure: &'a Procedure,
}

/// The figures of a run of a trial.
#[derive(Debug, Clone, Default)]
pub(crate) struct TrialRun {
    /// The hub's rate after the load has settled; empty if the motion diverges.
    pub hub_rate_rad_s: Vec<f64>,
    /// The largest RMS of the platform's acceleration that the estimator found over its memory, m/s^2; 0 if it has no dead-band.
    pub peak_rms_m_s2: f64,
}

/// A controller with a note of how lively its estimator finds the platform.
struct MonitoredController {
    runner: Runner,
    /// Place of the mean square of the platform's acceleration among the states.
    place: Option<usize>,
    most_m2_s4: f64,
}

impl SampledController for MonitoredController {
    fn reset(&mut self) {
        self.runner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let control = self.runner.step(readings);
        let now = self.place.and_then(|place| self.runner.state(place)).unwrap_or(0.0);
        self.most_m2_s4 = self.most_m2_s4.max(now);
        control
    }
}

impl Stage<'_> {
    /// Runs the load on a motion of the platform.
    pub(crate) fn run(
        &self,
        platform: &PlatformMotion,
        load: TrialLoad,
        acts: TrialController,
    ) -> Result<TrialRun, PipelineError> {
        let mut watched = self.monitored_controller(acts)?;
        let design = self.modelled.plant.body().out_of_balance_kg_m;
        if load == TrialLoad::WrongStart && acts != TrialController::Told {
            watched.runner.set_out_of_balance((1.0 - CHANGE) * design);
        }
        let mut state: Option<PlantState> = None;
        let mut angle = self.procedure.operating_point.platform_angle_rad;
        let mut rates = Vec::new();
        for part in load_parts(load) {
            if acts == TrialController::Told {
                watched.runner.set_out_of_balance(part.factor * design);
            }
            let plant = scale_imbalance(&self.modelled.plant, part.factor)?;
            let rest = Initial::Rest { hub_angle_rad: self.procedure.operating_point.hub_angle_rad };
            let scenario = Scenario {
                platform: motion_from(platform, part.from_s, angle),
                imperfections: Imperfections::NoiseAndQuantisation { seed: self.procedure.seed },
                initial: state.take().map_or(rest, |state| Initial::State(Box::new(state))),
                ..Scenario::at_rest(part.to_s - part.from_s)
            };
            let run = match Simulator::new(&plant)?.run(&mut watched, &scenario) {
                Err(counterpoise_simulate::Error::Diverged { .. }) => return Ok(TrialRun::default()),
                other => other?,
            };
            rates.extend(run.truth.hub_rate_rad_s());
            angle = run.truth.platform_angle_rad().last().copied().unwrap_or(angle);
            state = Some(run.final_state);
        }
        let period_s = self.modelled.parameters.interface.sample_period_s;
        let first = ((measured_from_s(load) / period_s) as usize).min(rates.len());
        let peak_rms_m_s2 = watched.most_m2_s4.sqrt();
        Ok(TrialRun { hub_rate_rad_s: rates.split_off(first), peak_rms_m_s2 })
    }

    fn monitored_controller(&self, acts: TrialController) -> Result<MonitoredController, PipelineError> {
        let own = match acts {
            TrialController::Adapts(method) => {
                let adaptation = AdaptationOptions { method, ..self.adaptation.clone() };
                let synth = self.project.synth.as_ref();
                let observer = synth.and_then(|asked| asked.options.observer.as_ref());
                Some(estimator(&adaptation, self.modelled, observer))
            }
            TrialController::Without | TrialController::Told => None,
        };
        let controller = self.controller.with(|parts| parts.estimator = own);
        let controller = controller.map_err(counterpoise_synth::Error::from)?;
        let mut states = controller.programs().states.iter();
        let place = states.find(|group| group.name == "liveliness").map(|group| group.first);
        Ok(MonitoredController { runner: controller.runner(), place, most_m2_s4: 0.0 })
    }

    /// Returns a motion of the platform for the whole trial.
    pub(crate) fn platform(&self, motion: TrialMotion) -> Result<PlatformMotion, PipelineError> {
        platform_motion(self.procedure, self.modelled.parameters.gravity_m_s2, motion)
    }
}
