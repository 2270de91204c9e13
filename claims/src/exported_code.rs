//! The claim that what is exported is what was verified.

use counterpoise_export::targets::TargetFigures;
use counterpoise_export::{Numbers, Record};
use counterpoise_lti::{Margins, margins};
use counterpoise_verify::{Arrangement, Experiment, Source};

use super::drawing::{ClaimCurve, make_figure, make_panel};
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::SAME_LOOP_DB;
use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::export::run_targets;
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// The experiment that is drawn.
const DRAWN: Experiment = Experiment::Disturbance(Source::Both, Arrangement::Compensated);

/// Returns row C25: what is exported is what was verified.
///
/// # Errors
/// Those of the verification.
pub fn exported_controller(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let design = margins(&tested.designed.synthesised.sampled.loop_gain)?;
    let exported = &tested.designed.verified.verification().evidence.margins;
    let (before, after) = (design.gain_margin_db(), exported.gain_margin_db());
    let (lag_before, lag_after) = (phase_margin_deg(&design), phase_margin_deg(exported));
    let made = &tested.designed;
    let ran = run_targets(&made.modelled, &made.verified, &made.procedure)?;
    let words: Vec<String> = ran.figures.iter().map(in_words).collect();
    let most_db = ran.figures.iter().map(cost_db).fold(0.0, f64::max);
    let files = made.files.len();
    Ok(Claim {
        id: "C25",
        title: "on the target",
        source: "8.6, A4",
        says: "controllers go to the z-domain and to C automatically, and give the same closed loop on the target",
        measured: format!(
            "{files} files written; margins of the design's sampled loop {before:.2} dB, {lag_before:.2} deg, of the exported coefficients {after:.2} dB, {lag_after:.2} deg; the exported operations in the simulated loop, all experiments: {}",
            words.join("; ")
        ),
        criteria: exported_criteria([&design, exported], most_db, ran.figures.len()),
        why: String::new(),
        drawings: drawings(&ran.figures),
    })
}

/// Returns what is asked of the margins before and after export, of what smaller numbers cost, and of the kinds of numbers that ran.
fn exported_criteria([before, after]: [&Margins; 2], most_db: f64, kinds: usize) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "gain margins apart, dB",
            "the same closed loop",
            (before.gain_margin_db() - after.gain_margin_db()).abs(),
            0.5,
            "half a decibel cannot be seen",
        ),
        Criterion::at_most(
            "phase margins apart, deg",
            "the same closed loop",
            (phase_margin_deg(before) - phase_margin_deg(after)).abs(),
            1.0,
            "a degree cannot be seen",
        ),
        Criterion::at_most(
            "most that smaller numbers cost, dB",
            "the same closed loop",
            most_db,
            SAME_LOOP_DB,
            "a hundredth of the hub rate",
        ),
        Criterion::at_least(
            "kinds of numbers that ran in the loop",
            "runs on the target",
            kinds as f64,
            3.0,
            "double, single and fixed point",
        ),
    ]
}

fn phase_margin_deg(margins: &Margins) -> f64 {
    margins.phase_margin().map_or(f64::NAN, |phase| phase.deg)
}

fn name(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Double => "double",
        Numbers::Single => "single precision",
        Numbers::Fixed => "fixed point",
    }
}

/// Returns the most that smaller numbers cost in any experiment, dB.
fn cost_db(one: &TargetFigures) -> f64 {
    one.experiments.iter().filter_map(|experiment| experiment.cost_db).fold(0.0, f64::max)
}

fn in_words(one: &TargetFigures) -> String {
    format!(
        "{} off by {:.1e} V at most, costs {:.4} dB of hub rate error",
        name(one.numbers),
        one.measured_v,
        cost_db(one)
    )
}

/// Returns the control by each kind of numbers in the loop that it closes itself, and how far it is from
/// double.
fn drawings(figures: &[TargetFigures]) -> Vec<Drawing> {
    let record = |one: &TargetFigures| -> Option<Record> {
        let at = one.experiments.iter().position(|experiment| experiment.experiment == DRAWN)?;
        one.closed_loops.get(at).cloned()
    };
    let mut all = figures.iter().filter_map(|one| record(one).map(|record| (name(one.numbers), record)));
    let Some((first, double)) = all.next() else { return Vec::new() };
    let points = |record: &Record, of: &dyn Fn(usize) -> f64| -> Vec<Point> {
        (0..record.controls_v.len()).map(|k| Point::new(k as f64, of(k))).collect()
    };
    let mut controls = vec![ClaimCurve::line(first, points(&double, &|k| double.controls_v[k]))];
    let mut apart = Vec::new();
    for (name, record) in all {
        let count = record.controls_v.len().min(double.controls_v.len());
        controls.push(ClaimCurve::reference(name, points(&record, &|k| record.controls_v[k])));
        let off =
            |k: usize| if k < count { 1e6 * (record.controls_v[k] - double.controls_v[k]) } else { f64::NAN };
        apart.push(ClaimCurve::line(format!("{name} less {first}"), points(&record, &off)));
    }
    let panels = vec![
        make_panel(Axis::linear("control", "V"), controls),
        make_panel(Axis::linear("difference", "µV"), apart),
    ];
    vec![
        make_figure("The control in the loop that each form closes", Axis::linear("sample", ""), panels)
            .with_caption("Heave and pitch on the nonlinear plant. Friction and converters amplify a difference of one rounding; the plant's motion is the same."),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::Agreement;
    use counterpoise_linalg::Mat;
    use counterpoise_lti::{StateSpace, Timebase, series};

    /// The margins of 0.02 / (z - 1) / (z - 0.9), its gain changed by a factor.
    fn margins_with(factor: f64) -> Margins {
        let timebase = Timebase::Discrete { period_s: 1e-3 };
        let integrator = StateSpace::new(one(1.0), one(0.02), one(1.0), one(0.0), timebase).unwrap();
        let lag = StateSpace::new(one(0.9), one(factor), one(1.0), one(0.0), timebase).unwrap();
        margins(&series(&lag, &integrator).unwrap()).unwrap()
    }

    fn one(value: f64) -> Mat {
        Mat::row(&[value])
    }

    fn disagreeing(after: &Margins, most_db: f64, kinds: usize) -> Vec<String> {
        let all = exported_criteria([&margins_with(1.0), after], most_db, kinds);
        all.into_iter().filter(|one| one.agreement() == Agreement::Disagrees).map(|one| one.what).collect()
    }

    #[test]
    fn a_controller_other_than_the_verified_one_fails() {
        assert!(disagreeing(&margins_with(1.0), 0.0, 3).is_empty());
        assert_eq!(
            disagreeing(&margins_with(1.1), 0.0, 3),
            ["gain margins apart, dB", "phase margins apart, deg"]
        );
        assert_eq!(disagreeing(&margins_with(1.0), 0.5, 3), ["most that smaller numbers cost, dB"]);
        assert_eq!(disagreeing(&margins_with(1.0), 0.0, 2), ["kinds of numbers that ran in the loop"]);
    }
}
