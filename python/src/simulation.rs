//! Runs of the nonlinear machine under the controller that is exported.

use anyhow::ensure;
use counterpoise_pipeline::{build_plant_model, reduce_plant, synthesise};
use counterpoise_project::Purpose;
use counterpoise_simulate::{
    Firing, Imperfections, Initial, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background;
use crate::project::NativeProject;

/// Signals of a run, one value a sample each; those that are left out are zero.
struct Signals {
    demand: Option<Vec<f64>>,
    heave_m_s2: Option<Vec<f64>>,
    pitch_rate_rad_s: Option<Vec<f64>>,
}

impl Signals {
    /// Returns the scenario over the common length of the signals.
    fn scenario(self, period_s: f64, start: Start) -> anyhow::Result<Scenario> {
        let given = [&self.demand, &self.heave_m_s2, &self.pitch_rate_rad_s];
        let mut lengths: Vec<usize> =
            given.iter().filter_map(|signal| signal.as_ref().map(Vec::len)).collect();
        lengths.dedup();
        ensure!(lengths.len() <= 1, "the signals have different lengths: {lengths:?} samples");
        let own = lengths.first().map(|samples| *samples as f64 * period_s);
        let Some(duration_s) = start.duration_s.or(own) else {
            anyhow::bail!("without a signal the duration must be given, in seconds")
        };
        let finite = given.iter().all(|s| s.iter().flat_map(|v| v.iter()).all(|value| value.is_finite()));
        ensure!(finite, "a signal holds a value that is not a finite number");
        let smooth = |values: Option<Vec<f64>>| {
            values.map_or(Signal::ZERO, |values| Signal::Samples { period_s, values })
        };
        let held = |values: Option<Vec<f64>>| {
            values.map_or(Signal::ZERO, |values| Signal::Held { period_s, values })
        };
        Ok(Scenario {
            demand_rad_s: held(self.demand),
            platform: PlatformMotion {
                heave_m_s2: smooth(self.heave_m_s2),
                pitch_rate_rad_s: smooth(self.pitch_rate_rad_s),
                ..PlatformMotion::STILL
            },
            imperfections: match start.seed {
                Some(seed) => Imperfections::NoiseAndQuantisation { seed },
                None => Imperfections::None,
            },
            initial: Initial::Rest { hub_angle_rad: start.hub_angle_rad },
            firing: Firing::Stated,
            ..Scenario::at_rest(duration_s)
        })
    }
}

struct Start {
    duration_s: Option<f64>,
    hub_angle_rad: f64,
    seed: Option<u64>,
}

/// Runs the machine under the project's controller: columns of the readings and of the true motion, and the time.
#[pyfunction]
#[pyo3(signature = (project, demand, heave_m_s2, pitch_rate_rad_s, duration_s, hub_angle_rad, seed, progress))]
pub fn simulate<'py>(
    py: Python<'py>,
    project: &NativeProject,
    demand: Option<PyReadonlyArray1<'py, f64>>,
    heave_m_s2: Option<PyReadonlyArray1<'py, f64>>,
    pitch_rate_rad_s: Option<PyReadonlyArray1<'py, f64>>,
    duration_s: Option<f64>,
    hub_angle_rad: f64,
    seed: Option<u64>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let values = |signal: Option<PyReadonlyArray1<'py, f64>>| signal.map(|s| s.as_array().to_vec());
    let signals = Signals {
        demand: values(demand),
        heave_m_s2: values(heave_m_s2),
        pitch_rate_rad_s: values(pitch_rate_rad_s),
    };
    let folder = project.folder();
    let (project, start) = (project.clone(), Start { duration_s, hub_angle_rad, seed });
    let history = background::run(py, folder, progress, move |_| {
        let loaded = project.load_for(Purpose::Synth)?;
        let modelled = build_plant_model(&loaded.project)?;
        let made = synthesise(&loaded.project, &modelled, &reduce_plant(&loaded.project, &modelled)?)?;
        let controller = made.sampled.controller;
        let scenario = signals.scenario(controller.sample_period_s(), start)?;
        Ok(Simulator::new(&modelled.plant)?.run(&mut controller.runner(), &scenario)?)
    })?;
    columns(py, history)
}

/// The columns of a run as arrays; columns that were not kept are left out.
fn columns(py: Python<'_>, history: TimeHistory) -> PyResult<Bound<'_, PyDict>> {
    let (readings, truth, dict) = (&history.readings, &history.truth, PyDict::new(py));
    let count = readings.len();
    let time_s = history.time_s();
    for (name, values) in [
        ("time_s", time_s.as_slice()),
        ("demand_rad_s", readings.demand_rad_s()),
        ("control_v", readings.control_v()),
        ("measured_hub_rate_rad_s", readings.hub_rate_rad_s()),
        ("measured_platform_rate_rad_s", readings.platform_rate_rad_s()),
        ("measured_platform_accel_m_s2", readings.platform_accel_m_s2()),
        ("measured_motor_rate_rad_s", readings.motor_rate_rad_s()),
        ("measured_hub_position_rad", readings.hub_position_rad()),
        ("hub_rate_rad_s", truth.hub_rate_rad_s()),
        ("tip_rate_rad_s", truth.tip_rate_rad_s()),
        ("motor_rate_rad_s", truth.motor_rate_rad_s()),
        ("hub_angle_rad", truth.hub_angle_rad()),
        ("platform_angle_rad", truth.platform_angle_rad()),
        ("platform_rate_rad_s", truth.platform_rate_rad_s()),
        ("heave_m_s2", truth.heave_m_s2()),
        ("current_a", truth.current_a()),
        ("wind_up_rad", truth.wind_up_rad()),
        ("mesh_torque_nm", truth.mesh_torque_nm()),
        ("motor_friction_nm", truth.motor_friction_nm()),
        ("pivot_friction_nm", truth.pivot_friction_nm()),
    ] {
        if values.len() == count {
            dict.set_item(name, PyArray1::from_slice(py, values))?;
        }
    }
    Ok(dict)
}
