//! Results as plain data that serialises: what `--json` prints, and what another program reads.

use std::collections::BTreeMap;

use counterpoise_simulate::replay::{ChannelFit, Divergence, ReplayMode, SelectedReplay};
use counterpoise_verify::{Value, Verdict, Verification};
use serde::Serialize;

use crate::{Designed, Modelled, Reduced, Synthesised};

/// A complex number as real and imaginary part.
pub type Pair = [f64; 2];

/// The plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelResult {
    /// Name of the machine.
    pub name: String,
    /// Order of the linear plant.
    pub order: usize,
    /// What each state is.
    pub states: Vec<String>,
    /// Poles of the linear plant, rad/s.
    pub poles_rad_s: Vec<Pair>,
    /// Control that holds the mechanism at its operating point, V.
    pub holding_v: f64,
    /// First moment of mass about the pivot, kg m.
    pub out_of_balance_kg_m: f64,
}

/// The reduction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReduceResult {
    /// Order before and after.
    pub order: [usize; 2],
    /// Values by which states were ranked.
    pub ranked: Vec<f64>,
    /// A priori bound on the largest error.
    pub bound: Option<f64>,
    /// Largest error as measured, and its frequency in rad/s.
    pub error: Option<Pair>,
    /// What a designer should know.
    pub warnings: Vec<String>,
}

/// The design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthResult {
    /// Order of the design plant with sensors and delay.
    pub plant_order: usize,
    /// States of each path of the sampled controller.
    pub path_orders: BTreeMap<String, usize>,
    /// Poles of the closed sampled loop, in the z-plane.
    pub closed_loop_poles: Vec<Pair>,
    /// Largest relative difference between a cost as predicted and as computed on the assembled loop.
    pub cost_difference: Option<f64>,
    /// What a designer should know.
    pub warnings: Vec<String>,
}

/// A figure with its value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureResult {
    /// Key, as in a project file.
    pub figure: String,
    /// Value; `None` if it could not be measured.
    pub value: Option<f64>,
    /// Unit.
    pub unit: &'static str,
}

/// A requirement with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerdictResult {
    /// Key of the figure.
    pub figure: String,
    /// `holds`, `fails` or `not applicable`.
    pub verdict: &'static str,
    /// Value.
    pub value: Option<f64>,
    /// Limit.
    pub limit: Option<f64>,
    /// Why it is not applicable.
    pub why: Option<String>,
}

/// The verification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifyResult {
    /// Whether no requirement fails and the loop is stable.
    pub passes: bool,
    /// Verdicts, in the order of the project file.
    pub verdicts: Vec<VerdictResult>,
    /// Every figure.
    pub figures: Vec<FigureResult>,
}

/// The whole road.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignResult {
    /// The plant.
    pub model: ModelResult,
    /// The reduction.
    pub reduce: ReduceResult,
    /// The design.
    pub synth: SynthResult,
    /// The verification.
    pub verify: VerifyResult,
    /// Names of the files of code.
    pub files: Vec<String>,
    /// Code that the project asks for and cannot have, with the reason.
    pub left_out: Vec<String>,
}

/// Fit of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelResult {
    /// RMS error.
    pub rms_error: f64,
    /// What noise and quantisation leave of a perfect model, RMS.
    pub floor: f64,
    /// Variance accounted for, percent.
    pub vaf: f64,
}

/// Fit of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingResult {
    /// File.
    pub file: String,
    /// Channels.
    pub channels: BTreeMap<&'static str, ChannelResult>,
    /// `free`: over its whole length; `windows`: over short horizons, each from a state of its own.
    pub followed: &'static str,
    /// Length of a window, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// What replay over the whole length left, where the recording was followed over windows.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub free: BTreeMap<&'static str, ChannelResult>,
    /// How far two runs of the model itself part over the whole length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parting: Option<PartingResult>,
    /// What was found about the recording itself.
    pub remarks: Vec<String>,
}

/// How far two runs of one model part that differ in noise and in what is not known of their start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartingResult {
    /// The channel in which they part most.
    pub channel: &'static str,
    /// RMS of their difference over the channel's floor.
    pub floors: f64,
}

/// Fits of all recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReplayResult {
    /// Recordings.
    pub recordings: Vec<RecordingResult>,
}

impl From<&Modelled> for ModelResult {
    fn from(modelled: &Modelled) -> Self {
        let linear = &modelled.linear;
        Self {
            name: modelled.parameters.name.clone(),
            order: linear.system.order(),
            states: linear.state_names.clone(),
            poles_rad_s: pairs(&counterpoise_lti::poles(&linear.system).unwrap_or_default()),
            holding_v: linear.equilibrium.control_v,
            out_of_balance_kg_m: modelled.plant.body().out_of_balance_kg_m,
        }
    }
}

impl From<&Reduced> for ReduceResult {
    fn from(reduced: &Reduced) -> Self {
        Self {
            order: [reduced.order_before, reduced.system.order()],
            ranked: reduced.ranked.clone(),
            bound: reduced.bound,
            error: reduced.error.map(|(value, rate)| [value, rate]),
            warnings: reduced.warnings.clone(),
        }
    }
}

impl From<&Synthesised> for SynthResult {
    fn from(made: &Synthesised) -> Self {
        let paths = &made.sampled.controller.parts().paths;
        Self {
            plant_order: made.design.plant.measured().map_or(0, |p| p.order()),
            path_orders: paths.iter().map(|p| (p.name.clone(), p.system.order())).collect(),
            closed_loop_poles: pairs(&made.sampled.closed_loop),
            cost_difference: [made.design.worst_cost_difference(), made.sampled.worst_cost_difference()]
                .into_iter()
                .flatten()
                .max_by(f64::total_cmp),
            warnings: made.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl From<&Verification> for VerifyResult {
    fn from(found: &Verification) -> Self {
        let figures = found.figures.iter().map(|measured| FigureResult {
            figure: measured.figure.key(),
            value: match measured.value {
                Value::Is(value) => Some(value),
                Value::Absent { .. } => None,
            },
            unit: measured.figure.unit(),
        });
        let verdicts = found.verdicts.iter().map(|(requirement, verdict)| {
            let figure = requirement.figure.key();
            let judged = |verdict, value, limit| VerdictResult {
                figure: figure.clone(),
                verdict,
                value: Some(value),
                limit: Some(limit),
                why: None,
            };
            match verdict {
                Verdict::Holds { value, limit, .. } => judged("holds", *value, limit.value()),
                Verdict::Fails { value, limit, .. } => judged("fails", *value, limit.value()),
                Verdict::NotApplicable { why } => VerdictResult {
                    figure: figure.clone(),
                    verdict: "not applicable",
                    value: None,
                    limit: None,
                    why: Some(why.clone()),
                },
            }
        });
        Self { passes: found.passes(), verdicts: verdicts.collect(), figures: figures.collect() }
    }
}

impl From<&Designed> for DesignResult {
    fn from(made: &Designed) -> Self {
        Self {
            model: (&made.modelled).into(),
            reduce: (&made.reduced).into(),
            synth: (&made.synthesised).into(),
            verify: made.verified.verification().into(),
            files: made.files.iter().map(|f| f.name.clone()).collect(),
            left_out: made.left_out.iter().map(ToString::to_string).collect(),
        }
    }
}

impl RecordingResult {
    /// The fit of a replayed recording.
    pub fn new(file: &str, followed: &SelectedReplay, remarks: Vec<String>) -> Self {
        let (way, window_s, free) = match &followed.mode {
            ReplayMode::Free => ("free", None, BTreeMap::new()),
            ReplayMode::Windowed { window_s, free } => ("windows", Some(*window_s), channels(free)),
        };
        let parting = |p: Divergence| PartingResult { channel: p.channel.name(), floors: p.floors };
        Self {
            file: file.to_owned(),
            channels: channels(&followed.replay.channels),
            followed: way,
            window_s,
            free,
            parting: followed.divergence.map(parting),
            remarks,
        }
    }

    /// How the recording was followed, in a line.
    pub fn way(&self) -> String {
        let Some(window_s) = self.window_s else {
            return "from start to end".to_owned();
        };
        let by = format!("over windows of {window_s} s, each from a state fitted to its first half");
        let Some(parting) = &self.parting else { return by };
        let of_machine = self.free.iter().filter(|(name, _)| !name.starts_with("platform"));
        let left: Vec<String> =
            of_machine.map(|(name, c)| format!("{name} {:.2}", c.rms_error / c.floor)).collect();
        format!(
            "{by}: the machine hunts, two runs of the model itself part by {:.1} floors in {}; from start to end error over floor is {}",
            parting.floors,
            parting.channel,
            left.join(", ")
        )
    }
}

fn channels(fits: &[ChannelFit]) -> BTreeMap<&'static str, ChannelResult> {
    let channel = |fit: &ChannelFit| {
        let result = ChannelResult { rms_error: fit.rms_error, floor: fit.floor, vaf: fit.vaf };
        (fit.channel.name(), result)
    };
    fits.iter().map(channel).collect()
}

fn pairs(values: &[counterpoise_lti::C64]) -> Vec<Pair> {
    values.iter().map(|v| [v.re, v.im]).collect()
}
