//! `counterpoise fra`: the frequency response analyser, on the simulated mechanism or on recordings.

use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};
use clap::{Args, ValueEnum};
use counterpoise_pipeline as pipeline;
use counterpoise_pipeline::frequencies::logarithmic_hz;
use counterpoise_pipeline::studies::fra::{
    Analyser, LoopController, LoopUnderTest, MeasurementPlan, ResponseMap, map_recordings,
};
use counterpoise_pipeline::studies::fra_plan::usual_frequencies_hz;
use counterpoise_pipeline::studies::fra_summary::MeasuringPace;
use counterpoise_pipeline::studies::fra_totals::MapTotals;
use counterpoise_project::{Project, Purpose, StructureChoice};
use counterpoise_report::fra::fra_report;
use counterpoise_report::terminal::response_map::{map_lines, pace_lines};
use counterpoise_report::wording::recordings::{describe_map, describe_recorded_map};
use counterpoise_simulate::fra::Measurement;
use ndarray::Array2;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::{CommandOutputs, WRITTEN};
use crate::output;
use counterpoise_host::clock::Moment;
use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_host::workers::{ProgressPool, QuietPool, run_on};
use counterpoise_pool::Pool;

/// Arguments of `fra`.
#[derive(Args)]
pub struct FraOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// What is excited and measured; if not given, `disturbance` with a gyroscope on the platform, else `closed`
    #[arg(long = "loop", value_enum)]
    pub around: Option<LoopName>,
    /// The plant that is measured; the controller stays the project's
    #[arg(long, value_enum, default_value_t = PlantName::Project, conflicts_with = "recording")]
    pub plant: PlantName,
    /// Amplitudes of the sine: V for `plant`, in the unit of the demand for `closed`, rad/s otherwise
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub amplitudes: Vec<f64>,
    /// Frequencies in Hz: a list, or FROM:TO:COUNT on a logarithmic scale
    #[arg(long, value_name = "F,...|FROM:TO:COUNT")]
    pub frequencies: Option<String>,
    /// Distance of the mechanism in front of the platform's pitch axis, m: heave = this x pitch acceleration
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub offset: f64,
    /// Run the instrument on these recordings instead of the simulation (needs --frequencies)
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub recording: Vec<PathBuf>,
    /// Measure the map again on 1, 2, 4, ... threads, and print how the time falls
    #[arg(long, conflicts_with = "recording")]
    pub scaling: bool,
    /// With --json or --data: also the signals of every point, from which the responses can be recomputed
    #[arg(long, requires = WRITTEN, conflicts_with = "recording")]
    pub histories: bool,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// The plants by name; the linear one is compared with every map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlantName {
    /// As the project's [model] says
    Project,
    /// The two lumped inertias
    Lumped,
    /// The finite elements' modes
    Fe,
}

/// The loops by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LoopName {
    /// Control to what the loop controls, without a controller
    Plant,
    /// Demand to what the loop controls, with the controller
    Closed,
    /// Platform rate to what the loop controls, with the controller
    Disturbance,
    /// Platform rate to what the loop controls, balanced, the motor disconnected
    Disconnected,
}

impl From<LoopName> for LoopUnderTest {
    fn from(name: LoopName) -> Self {
        match name {
            LoopName::Plant => Self::Plant,
            LoopName::Closed => Self::Closed,
            LoopName::Disturbance => Self::Disturbance,
            LoopName::Disconnected => Self::Disconnected,
        }
    }
}

/// Most frequencies of one map.
const MOST_FREQUENCIES: usize = 10_000;

/// Runs the command.
pub fn run(options: &FraOptions) -> CommandResult {
    let mut loaded = projects::load_project(&options.project, Purpose::Model)?;
    let around = options.around.map_or_else(|| LoopUnderTest::usual_of(&loaded.project), LoopUnderTest::from);
    let has_controller = matches!(around, LoopUnderTest::Closed | LoopUnderTest::Disturbance);
    if has_controller && options.recording.is_empty() && pipeline::leaves_weights_open(&loaded.project) {
        loaded = projects::load_project(&options.project, Purpose::Synth)?;
    }
    output::print_warnings(&loaded, options.outputs.results.progress());
    if options.recording.is_empty() {
        check_platform_is_measured(&loaded, around)?;
    }
    let plan = plan(options, &loaded.project, around)?;
    let (maps, speed) = if options.recording.is_empty() {
        map_simulated_mechanism(&loaded, &plan, options)?
    } else {
        (map_project_recordings(&loaded, &plan, options)?, Vec::new())
    };
    if let Some(path) = &options.outputs.report {
        let command = std::iter::once("counterpoise".to_owned())
            .chain(std::env::args().skip_while(|argument| argument != "fra"))
            .collect::<Vec<_>>()
            .join(" ");
        let page = fra_report(&maps, MapTotals::of(&maps), &speed, &command);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_list(&options.outputs.results, "maps", &maps)? {
        maps.iter().for_each(|map| output::print_lines(&map_lines(map)));
        output::print_lines(&pace_lines(MapTotals::of(&maps), &speed));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Refuses a response to the platform's motion if the machine has no gyroscope on the platform, against whose reading it is measured.
fn check_platform_is_measured(loaded: &ProjectOnDisk, around: LoopUnderTest) -> Result<()> {
    let is_to_platform = matches!(around, LoopUnderTest::Disturbance | LoopUnderTest::Disconnected);
    if is_to_platform && !loaded.project.plant.sensors.platform_gyro.is_fitted() {
        bail!(
            "the response to the platform's motion is measured against the gyroscope on the platform, and {} has none: add \
             [plant.sensors.platform_gyro], or choose --loop closed or --loop plant",
            loaded.path.display()
        );
    }
    Ok(())
}

/// Returns the map of the simulated mechanism, and how fast it was: on all threads, then, where that was asked for,
/// on fewer.
fn map_simulated_mechanism(
    loaded: &ProjectOnDisk,
    plan: &MeasurementPlan,
    options: &FraOptions,
) -> Result<(Vec<ResponseMap>, Vec<MeasuringPace>)> {
    let modelled = pipeline::build_plant_model(&loaded.project)?;
    let project = &loaded.project;
    let analyser = Analyser::new(project, &modelled, plan, LoopController::Simulation)?;
    let analyser = if options.histories { analyser.with_signals() } else { analyser };
    let analyser = match options.plant {
        PlantName::Project => analyser,
        PlantName::Lumped => analyser.with_structure(project, StructureChoice::Lumped, plan)?,
        PlantName::Fe => {
            let structure = pipeline::finite_elements_of(project)
                .context("--plant fe: the project has neither [plant.beam] nor [plant.import]")?;
            analyser.with_structure(project, structure, plan)?
        }
    };
    let workers = ProgressPool::new(options.outputs.results.progress());
    let start = Moment::now();
    let measured = analyser.measure(plan, &workers);
    let seconds = start.elapsed().as_secs_f64();
    workers.finish();
    let measured = measured?;
    let mut speed = vec![MeasuringPace { threads: QuietPool.processors(), seconds }];
    if options.scaling {
        speed = scaling(&analyser, plan, &measured)?;
    }
    let map = analyser.compare(&measured, &ProgressPool::new(ProgressDisplay::Quiet))?;
    Ok((vec![describe_map(map)], speed))
}

/// Returns the time of the same map on 1, 2, 4 ... threads and on all of them; it must be the same map to the
/// last bit.
fn scaling(
    analyser: &Analyser,
    plan: &MeasurementPlan,
    expected: &Array2<Measurement>,
) -> Result<Vec<MeasuringPace>> {
    let all = QuietPool.processors();
    let doubling = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|n| *n < all);
    let mut paces = Vec::new();
    for threads in doubling.chain([all]) {
        let start = Moment::now();
        let measured =
            run_on(threads, || analyser.measure(plan, &ProgressPool::new(ProgressDisplay::Quiet)))??;
        paces.push(MeasuringPace { threads, seconds: start.elapsed().as_secs_f64() });
        if measured != *expected {
            bail!("the map on {threads} threads is not the one on {all}: a defect of this program");
        }
    }
    Ok(paces)
}

fn map_project_recordings(
    loaded: &ProjectOnDisk,
    plan: &MeasurementPlan,
    options: &FraOptions,
) -> Result<Vec<ResponseMap>> {
    let modelled = pipeline::build_plant_model(&loaded.project)?;
    let files = projects::read_recordings(&options.recording)?;
    let found = map_recordings(&loaded.project, &modelled, plan, &files)?;
    Ok(found.into_iter().map(describe_recorded_map).collect())
}

fn plan(options: &FraOptions, project: &Project, around: LoopUnderTest) -> Result<MeasurementPlan> {
    let usual = || around.usual_amplitudes(project).to_vec();
    let amplitudes = if options.amplitudes.is_empty() { usual() } else { options.amplitudes.clone() };
    if let Some(bad) = amplitudes.iter().find(|size| !(**size > 0.0 && size.is_finite())) {
        bail!("--amplitudes {bad}: an amplitude must be positive and finite");
    }
    let frequencies_hz = match &options.frequencies {
        Some(text) => frequencies(text)?,
        None if options.recording.is_empty() => usual_frequencies_hz(project),
        None => {
            bail!("--recording needs --frequencies: the frequencies in Hz at which the recording was excited")
        }
    };
    let half_rate_hz = 0.5 / project.plant.interface.sample_period_s;
    if let Some(above) = frequencies_hz.iter().find(|hz| **hz >= half_rate_hz) {
        bail!(
            "--frequencies: {above} Hz cannot be measured: the controller samples at {} Hz, and only sines below half of that, \
             {half_rate_hz} Hz, are sampled as what they are",
            2.0 * half_rate_hz
        );
    }
    Ok(MeasurementPlan { around, amplitudes, frequencies_hz, offset_m: options.offset })
}

/// `1,2,5` or `0.3:30:25`.
fn frequencies(text: &str) -> Result<Vec<f64>> {
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(hz) if hz > 0.0 && hz.is_finite() => Ok(hz),
        _ => bail!("--frequencies {text}: \"{part}\" is not a positive number of Hz"),
    };
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [list] => list.split(',').map(number).collect(),
        [from, to, count] => match count.trim().parse::<usize>() {
            Ok(count) if (2..=MOST_FREQUENCIES).contains(&count) => {
                Ok(logarithmic_hz([number(from)?, number(to)?], count))
            }
            _ => bail!("--frequencies {text}: COUNT must be a whole number from 2 to {MOST_FREQUENCIES}"),
        },
        _ => bail!("--frequencies {text}: write a list as 1,2,5 or a range as FROM:TO:COUNT"),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn frequencies_are_a_list_or_a_range() {
        assert_eq!(frequencies("1, 2.5,10").unwrap(), [1.0, 2.5, 10.0]);
        let range = frequencies("0.1:10:3").unwrap();
        assert!((range[1] - 1.0).abs() < 1e-12 && (range[2] - 10.0).abs() < 1e-12);
        for bad in ["", "0", "-1", "1:2", "1:2:1", "1:x:4", "nan"] {
            assert!(frequencies(bad).unwrap_err().to_string().contains("--frequencies"), "{bad}");
        }
    }
}
