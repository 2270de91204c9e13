//! The designer's bench through the project file: adaptation in the loop, states of balance, methods side by side, and
//! weights that are refused before anything is solved.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::studies::adapt::{AdaptRun, adapt};
use counterpoise_pipeline::studies::comparison::{DesignComparison, compare_designs};
use counterpoise_pipeline::{PipelineError, SynthesisedDesign, build_plant_model, reduce_plant, synthesise};
use counterpoise_project::Project;
use counterpoise_report::wording::design_findings::describe_design_finding;

fn text(example: &str) -> String {
    let path = format!("{}/../examples/{example}/project.toml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

fn project(text: &str) -> Project {
    match Project::parse(text, "project.toml") {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{errors:?}"),
    }
}

fn make_design(project: &Project) -> Result<SynthesisedDesign, PipelineError> {
    let modelled = build_plant_model(project).unwrap();
    synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap())
}

fn compare(project: &Project) -> DesignComparison {
    let modelled = build_plant_model(project).unwrap();
    let reduced = reduce_plant(project, &modelled).unwrap();
    let made = synthesise(project, &modelled, &reduced).unwrap();
    compare_designs(project, &modelled, &made, None).unwrap()
}

fn runs(example: &str) -> Vec<AdaptRun> {
    let project = project(&text(example));
    let modelled = build_plant_model(&project).unwrap();
    let runs = adapt(&project, &modelled, &make_design(&project).unwrap()).unwrap();
    for run in &runs {
        println!("({}) {:?}", run.kind.letter(), run.kind);
        run.intervals.iter().for_each(|interval| println!("    {interval:?}"));
    }
    runs
}

fn came_back(runs: &[AdaptRun]) {
    for interval in runs.iter().flat_map(|run| &run.intervals).filter(|interval| interval.adapted) {
        assert!(interval.over_default <= 1.10, "{interval:?}");
    }
}

#[test]
fn after_each_step_of_out_of_balance_the_hub_rate_comes_back() {
    let runs = runs("adaptation");
    let letters: String = runs.iter().map(|run| run.kind.letter()).collect();
    assert_eq!(letters, "abcdefgh");
    came_back(&runs);
    let worse = |letter: char| {
        let run = runs.iter().find(|run| run.kind.letter() == letter).unwrap();
        run.intervals.iter().map(|interval| interval.over_default).fold(0.0, f64::max)
    };
    assert!(worse('b') > 1.2 && worse('e') > 1.2, "{} {}", worse('b'), worse('e'));
}

/// As in the source: with the amplifier's curve left in the loop, the lowest out-of-balance comes back less well, and no other.
#[test]
fn with_the_amplifiers_curve_in_the_loop_the_lowest_out_of_balance_comes_back_less_well() {
    let left = text("adaptation").replacen("amplifier_curve = \"undo\"", "amplifier_curve = \"leave\"", 1);
    let project = project(&left);
    let modelled = build_plant_model(&project).unwrap();
    let runs = adapt(&project, &modelled, &make_design(&project).unwrap()).unwrap();
    let last = runs.iter().find(|run| run.kind.letter() == 'h').unwrap();
    for interval in &last.intervals {
        assert_eq!(interval.over_default > 1.10, interval.factor == 0.37, "{interval:?}");
    }
}

/// Distance from the truth at which the estimate ends without gravity, kg m.
const NEAR_KG_M: f64 = 4.0;

#[test]
fn without_gravity_the_lateral_acceleration_tells_the_out_of_balance() {
    let runs = runs("azimuth");
    came_back(&runs);
    for interval in runs.iter().flat_map(|run| &run.intervals).filter(|interval| interval.adapted) {
        let off = (interval.used_kg_m - interval.out_of_balance_kg_m).abs();
        assert!(off < NEAR_KG_M, "{interval:?}");
    }
}

#[test]
fn with_inertia_kept_only_the_heave_feedforward_changes_and_only_in_gain() {
    let found = compare(&project(&text("out-of-balance-schedule")));
    for row in &found.balance {
        println!("{row:?}");
    }
    let factors = found.balance.iter().filter(|row| row.name.contains('%'));
    for (row, factor) in factors.zip([0.37_f64, 1.48]) {
        let law = 20.0 * factor.log10();
        let [low, high] = row.heave_db.unwrap();
        assert!((low - law).abs() < 1e-6 && (high - law).abs() < 1e-6, "{row:?}");
        assert!(row.feedback_db[0].abs() < 1e-6 && row.pitch_db.unwrap()[1].abs() < 1e-6, "{row:?}");
        let (gain, redesign) = (row.error_gain_law_rad_s.unwrap(), row.error_after_rad_s.unwrap());
        assert!((gain - redesign).abs() < 1e-6 * redesign && redesign < row.error_before_rad_s.unwrap());
    }
    assert!(found.spillover.as_ref().unwrap().largest_pole < 1.0, "{:?}", found.spillover);
}

#[test]
fn every_method_gives_a_loop_with_the_same_figures() {
    let found = compare(&project(&text("lqg-ltr-and-hinf")));
    for row in &found.methods {
        println!("{row:?}");
    }
    assert_eq!(found.methods.len(), 8, "four methods with integral action, four without");
    assert!(found.methods.iter().all(|row| row.figures.is_some()));
}

/// The text that is replaced in the reference rig's file, by what, and words that the refusal must hold.
const REFUSED: [(&str, &str, &[&str]); 13] = [
    (
        "form = \"lead\"\ngain = 1.0\ntime = 0.005                 # s",
        "form = \"lag\"\ngain = 1.0\ntime = 0.005",
        &["feedback, control weight", "high frequency", "fast control would be free"],
    ),
    (
        "form = \"proportional-integral\"\ngain = 25.0\ncorner = 13.0                # rad/s",
        "form = \"lead\"\ngain = 25.0\ntime = 0.1",
        &["feedback, error weight", "high frequency", "as many poles as zeros"],
    ),
    (
        "form = \"second-order\"\ngain = 0.1\nnatural_frequency = 12.0     # rad/s\ndamping_ratio = 0.7",
        "form = \"constant\"\ngain = 0.1",
        &["pitch", "generator", "more poles than zeros"],
    ),
    (
        "form = \"lead\"\ngain = 1.0\ntime = 0.005                 # s",
        "form = \"zero-pole-gain\"\nzeros = [[-50.0, 0.0]]\npoles = [[0.0, 0.0]]\ngain = 1.0",
        &["feedback, control weight", "zero frequency", "both infinite"],
    ),
    (
        "[synth.heave.error]\nform = \"constant\"\ngain = 300.0",
        "[synth.heave.error]\nform = \"integral\"\ngain = 300.0\ntime = 1.0",
        &["heave", "zero frequency", "error weight that is finite"],
    ),
    (
        "[synth.pitch.error]\nform = \"constant\"\ngain = 300.0",
        "[synth.pitch.error]\nform = \"integral\"\ngain = 300.0\ntime = 1.0",
        &["pitch", "zero frequency", "error weight that is finite"],
    ),
    (
        "[synth.heave.error]\nform = \"constant\"\ngain = 300.0",
        "[synth.heave.error]\nform = \"lead\"\ngain = 300.0\ntime = 1.0",
        &["heave", "high frequency", "as many poles as zeros"],
    ),
    (
        "[synth.pitch.error]\nform = \"constant\"\ngain = 300.0",
        "[synth.pitch.error]\nform = \"lead\"\ngain = 300.0\ntime = 1.0",
        &["pitch", "high frequency", "as many poles as zeros"],
    ),
    (
        "form = \"quadratic\"\ngain = 1.0\nsecond = 1e-4                # s^2\nfirst = 1.4e-2               # s",
        "form = \"lag\"\ngain = 1.0\ntime = 0.01",
        &["heave", "control weight", "high frequency"],
    ),
    (
        "form = \"quadratic-free-at-zero\"\ngain = 1.0\nsecond = 1e-4                # s^2\nfirst = 1.4e-2               # s",
        "form = \"lag\"\ngain = 1.0\ntime = 0.01",
        &["pitch", "control weight", "high frequency"],
    ),
    (
        "form = \"second-order\"\ngain = 1.0\nnatural_frequency = 20.0     # rad/s\ndamping_ratio = 0.7",
        "form = \"constant\"\ngain = 1.0",
        &["heave", "generator", "more poles than zeros"],
    ),
    (
        "form = \"second-order\"\ngain = 1.0\nnatural_frequency = 20.0     # rad/s\ndamping_ratio = 0.7",
        "form = \"integral\"\ngain = 1.0\ntime = 1.0",
        &["heave", "generator", "zero frequency", "left half plane"],
    ),
    (
        "form = \"second-order\"\ngain = 0.1\nnatural_frequency = 12.0     # rad/s\ndamping_ratio = 0.7",
        "form = \"integral\"\ngain = 0.1\ntime = 1.0",
        &["pitch", "generator", "zero frequency", "left half plane"],
    ),
];

#[test]
fn weights_without_a_solution_are_refused_with_weight_frequency_and_suggestion() {
    let good = text("reference-rig");
    for (from, to, words) in REFUSED {
        assert!(good.contains(from), "the example has no {from:?}");
        let error = make_design(&project(&good.replacen(from, to, 1))).err();
        let Some(PipelineError::NoController(findings)) = &error else { panic!("{to}: {error:?}") };
        let said = findings.iter().map(describe_design_finding).collect::<Vec<_>>().join("\n");
        println!("{said}\n");
        words.iter().for_each(|word| assert!(said.contains(word), "{word} is not in: {said}"));
    }
}
