//! The choices of `[synth]` and `[reduce]` through the project file: sampling, prefilter, the feedforward's basis, weights from
//! tables, laws of the friction observer, reduced plants.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use counterpoise_pipeline::studies::comparison::{DesignComparison, compare_designs};
use counterpoise_pipeline::{
    PlantModel, SynthesisedDesign, World, build_plant_model, reduce_plant, study_synthesis, synthesise,
    verify,
};
use counterpoise_project::{Project, Purpose, TunedWeights};
use counterpoise_report::wording::errors::describe_pipeline_error;
use counterpoise_tests::examples;
use counterpoise_verify::{PerformanceFigure, Verification};

struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("{name} is not needed"))
    }
}

fn text(file: &str) -> String {
    std::fs::read_to_string(format!("{}/../examples/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// The file with lines in the place of lines.
fn with(file: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text(file), |text, (from, to)| {
        assert!(text.contains(from), "{file} has no {from:?}");
        text.replacen(from, to, 1)
    })
}

fn project(text: &str) -> Project {
    match Project::parse(text, "project.toml") {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{errors:?}"),
    }
}

fn make_design(project: &Project) -> (PlantModel, SynthesisedDesign) {
    let modelled = build_plant_model(project).unwrap();
    let reduced = reduce_plant(project, &modelled).unwrap();
    let made = synthesise(project, &modelled, &reduced).unwrap_or_else(|error| panic!("{error}"));
    (modelled, made)
}

fn verify_project(project: &Project) -> Verification {
    let (modelled, made) = make_design(project);
    verify(project, &modelled, &made, &EmptyWorld).unwrap().verification().clone()
}

fn value(found: &Verification, key: &str) -> f64 {
    let figure = PerformanceFigure::all()
        .into_iter()
        .find(|figure| figure.key() == key)
        .unwrap_or_else(|| panic!("{key}"));
    found.value(figure).unwrap()
}

fn compare(project: &Project) -> DesignComparison {
    let modelled = build_plant_model(project).unwrap();
    let reduced = reduce_plant(project, &modelled).unwrap();
    let made = synthesise(project, &modelled, &reduced).unwrap();
    compare_designs(project, &modelled, &made, None).unwrap()
}

const CHAPTER_6: &str = "appendix-5/chapter-6.toml";
const TUSTIN: &str = "discretisation = \"tustin\"";

/// At 1 kHz every sampling gives the loop that was designed.
#[test]
fn every_sampling_gives_nearly_the_same_loop() {
    let base = compare(&project(&text(CHAPTER_6))).methods[0].figures.unwrap();
    for choice in [
        "discretisation = \"tustin\"\nprewarp = 15.0",
        "discretisation = \"zero-order-hold\"",
        "discretisation = \"first-order-hold\"",
        "discretisation = \"matched\"",
    ] {
        let found = compare(&project(&with(CHAPTER_6, &[(TUSTIN, choice)]))).methods[0].figures.unwrap();
        println!("{choice}: {found:?}");
        assert!((found.gain_margin_db - base.gain_margin_db).abs() < 0.7, "{choice}");
        assert!((found.phase_margin_deg - base.phase_margin_deg).abs() < 1.5, "{choice}");
    }
}

const SAMPLED_DATA: &str = "discretisation = \"sampled-data\"";

/// On the nonlinear plant too, with both feedforwards, the figures are those of the converted controller.
#[test]
fn a_design_in_sampled_time_verifies_as_the_converted_one_at_1_khz() {
    let converted = verify_project(&project(&text(CHAPTER_6)));
    let anew = project(&with(CHAPTER_6, &[(TUSTIN, SAMPLED_DATA)]));
    let (_, own) = make_design(&anew);
    assert!(own.sampled.worst_cost_difference().is_some_and(|difference| difference < 1e-6));
    let found = verify_project(&anew);
    let same = [("gain_margin_db", 0.7), ("phase_margin_deg", 1.5), ("linear_step_overshoot_percent", 0.5)];
    for (key, within) in same {
        println!("{key}: {} {}", value(&converted, key), value(&found, key));
        assert!((value(&found, key) - value(&converted, key)).abs() < within, "{key}");
    }
}

/// At 40 ms the converted controller loses its margins, at 80 ms the sampled loop; the one designed for the period keeps both.
#[test]
fn a_design_in_sampled_time_holds_a_coarse_period() {
    let at = |period: &str, choice: &str| {
        project(&with(CHAPTER_6, &[("sample_period = 1.0e-3", period), (TUSTIN, choice)]))
    };
    let (slow, slower) = ("sample_period = 4.0e-2", "sample_period = 8.0e-2");
    let [converted, anew] = [TUSTIN, SAMPLED_DATA].map(|choice| verify_project(&at(slow, choice)));
    assert!(value(&converted, "gain_margin_db") < 9.0 && value(&anew, "gain_margin_db") > 13.0);
    let converted = at(slower, TUSTIN);
    let modelled = build_plant_model(&converted).unwrap();
    let reduced = reduce_plant(&converted, &modelled).unwrap();
    let refused =
        synthesise(&converted, &modelled, &reduced).err().map(|error| describe_pipeline_error(&error));
    assert!(refused.as_ref().is_some_and(|said| said.contains("sample faster")), "{refused:?}");
    let anew = verify_project(&at(slower, SAMPLED_DATA));
    assert!(value(&anew, "gain_margin_db") > 8.0 && value(&anew, "phase_margin_deg") > 45.0);
}

/// What is not the three-part design cannot be designed anew in sampled time, and says so at its key.
#[test]
fn sampled_data_with_another_feedback_is_refused_at_its_key() {
    for other in ["method = \"lqg-ltr\"", "controller_order = 5"] {
        let written = with(CHAPTER_6, &[(TUSTIN, &format!("{SAMPLED_DATA}\n{other}"))]);
        let errors = Project::parse(&written, "p.toml").err().unwrap();
        let said = errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert!(said.contains("synth.discretisation") && said.contains("use \"tustin\""), "{other}: {said}");
    }
}

#[test]
fn a_prefilter_takes_the_overshoot_and_nothing_else() {
    let filter = "[synth.prefilter]\nform = \"lag\"\ngain = 1.0\ntime = 0.12\n\n[synth.feedback]";
    let filtered = project(&with(CHAPTER_6, &[("[synth.feedback]", filter)]));
    let (plain, filtered) = (verify_project(&project(&text(CHAPTER_6))), verify_project(&filtered));
    let overshoot = |found| value(found, "linear_step_overshoot_percent");
    assert!(overshoot(&filtered) < 0.3 * overshoot(&plain), "{} {}", overshoot(&filtered), overshoot(&plain));
    assert_eq!(value(&filtered, "gain_margin_db"), value(&plain, "gain_margin_db"));
    assert!(value(&filtered, "linear_step_steady_state_error_percent") < 0.1);
}

/// On the plant with the feedback around it, the feedforward reckons with what the feedback does anyway.
#[test]
fn a_feedforward_on_the_closed_loop_costs_what_is_predicted_and_needs_no_more_effort() {
    let heave = [("[synth.heave]\n", "[synth.heave]\nbasis = \"closed-loop\"\n")];
    let (_, closed) = make_design(&project(&with(CHAPTER_6, &heave)));
    let (_, open) = make_design(&project(&text(CHAPTER_6)));
    let (closed, open) = (closed.design.heave.unwrap(), open.design.heave.unwrap());
    assert!(
        closed.cost.relative_difference().is_some_and(|difference| difference < 1e-6),
        "{:?}",
        closed.cost
    );
    assert!(closed.cost.predicted <= open.cost.predicted, "{:?} {:?}", closed.cost, open.cost);
}

const TABLE: &str = "form = \"table\"\norder = 2\npoints = [[0.1, 300.0], [1.0, 300.0], [5.0, 290.0], [15.0, 260.0], [40.0, 200.0], [100.0, 170.0], [300.0, 160.0]]";
const HEAVE_ERROR: &str = "[synth.heave.error]\nform = \"constant\"\ngain = 300.0";

#[test]
fn a_weight_from_a_table_is_fitted_designed_with_and_kept_in_the_file() {
    let written = with(CHAPTER_6, &[(HEAVE_ERROR, &format!("[synth.heave.error]\n{TABLE}"))]);
    let project = project(&written);
    let weight = project.synth.as_ref().unwrap().specification.heave.as_ref().unwrap().error.clone();
    assert!(weight.worst_db() < 1.0 && weight.to_string().starts_with("table of 7 points"), "{weight}");
    let (_, made) = make_design(&project);
    assert!(made.design.heave.unwrap().cost.relative_difference().unwrap() < 1e-6);
    let again = Project::parse(&project.to_text(), "again.toml").unwrap().project;
    assert_eq!(again.synth, project.synth);
}

#[test]
fn a_table_that_no_function_meets_is_refused_with_what_helps() {
    let jagged = "[synth.heave.error]\nform = \"table\"\norder = 1\npoints = [[0.1, 1.0], [1.0, 100.0], [2.0, 1.0], [5.0, 100.0], [10.0, 1.0]]";
    let errors = Project::parse(&with(CHAPTER_6, &[(HEAVE_ERROR, jagged)]), "p.toml").err().unwrap();
    let said = errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    for word in ["synth.heave.error.points", "within 3 dB", "raise order"] {
        assert!(said.contains(word), "{word}: {said}");
    }
}

const PIVOT: &str = "[plant.friction.pivot]\nmodel = \"dahl\"\ncoulomb = 117.0              # N m\nrest_stiffness = 2.4e5       # N m/rad";

/// Each law of the toolbox in the plant and, by itself, in the observer: the hub is held better than without.
#[test]
fn an_observer_of_every_law_holds_the_hub_better() {
    let observer = "[synth.observer]\nlaw = \"plant\"\nshare = 0.7\nsign_rate = 0.02\n\n[synth.feedback]";
    let laws = [
        "model = \"dahl\"\nexponent = 2.0\nrest_stiffness = 2.4e5\ncoulomb = 117.0",
        "model = \"lugre\"\nbristle_stiffness = 2.4e5\nbristle_damping = 500.0\nstatic_ratio = 1.3\nstribeck_rate = 0.01\ncoulomb = 117.0",
        "model = \"coulomb\"\ncoulomb = 117.0",
        "model = \"stribeck\"\nstatic_ratio = 1.3\nstribeck_rate = 0.02\ncoulomb = 117.0",
        "model = \"karnopp\"\nstick_rate = 1e-3\ncoulomb = 117.0",
        "model = \"reset-integrator\"\ndeflection = 5e-4\ndamping = 500.0\nstatic_ratio = 1.2\ncoulomb = 117.0",
        "model = \"walrath\"\ntime_constant = 0.005\nsmoothing_rate = 0.01\ncoulomb = 117.0",
        "model = \"bristle\"\nbristles = 20\nbond = 1e-3\ncoulomb = 117.0",
    ];
    for law in laws {
        let plant = format!("[plant.friction.pivot]\n{law}");
        let plain = with(CHAPTER_6, &[(PIVOT, &plant), ("duration = 10.0 ", "duration = 4.0 ")]);
        let observed = plain.replacen("[synth.feedback]", observer, 1);
        let rms =
            |text: &str| value(&verify_project(&project(text)), "nonlinear_both_compensated_hub_rms_rad_s");
        let (without, with) = (rms(&plain), rms(&observed));
        println!("{}: {:.3} -> {:.3} mrad/s", law.lines().next().unwrap(), 1e3 * without, 1e3 * with);
        assert!(with < 0.9 * without, "{law}: {without} {with}");
    }
}

/// Feedback and feedforwards designed on every mode that the file may keep, converted and in sampled time: the costs are kept,
/// and rounding is not taken for a right half plane zero.
#[test]
fn a_design_on_the_full_beam_needs_no_reduction() {
    let beam = ("structure = \"lumped\"", "structure = \"beam\"\nmodes = 40");
    for choice in [TUSTIN, SAMPLED_DATA] {
        let (_, made) = make_design(&project(&with(CHAPTER_6, &[beam, (TUSTIN, choice)])));
        assert!(made.design.plant.system.order() > 80 && made.warnings.is_empty(), "{:?}", made.warnings);
        let costs = [made.design.worst_cost_difference(), made.sampled.worst_cost_difference()];
        assert!(costs.into_iter().flatten().all(|difference| difference < 1e-6), "{costs:?}");
    }
}

/// Modal and balanced plants from the file: the design is made on fewer states and holds on the beam with every mode of its elements.
#[test]
fn designs_on_modal_and_balanced_plants_hold_on_the_full_beam() {
    let beam = ("structure = \"lumped\"", "structure = \"beam\"\nmodes = 6");
    for (method, order) in [("modal", 9), ("balanced", 9)] {
        let reduction = format!("[reduce]\nmethod = \"{method}\"\norder = {order}\n\n[synth]\n");
        let lowered = "controller_order = 8\nassembly = \"simple-add\"";
        let file =
            with(CHAPTER_6, &[beam, ("[synth]\n", &reduction), ("assembly = \"simple-add\"", lowered)]);
        let project = project(&file);
        let modelled = build_plant_model(&project).unwrap();
        let reduced = reduce_plant(&project, &modelled).unwrap();
        assert!(reduced.system.order() <= order && modelled.linear.system.order() > order, "{method}");
        let found = compare(&project);
        let (lowered, spill) = (found.lowered.unwrap(), found.spillover.unwrap());
        println!("{method}: {lowered:?} {spill:?}");
        assert_eq!(lowered.order[1], 8);
        assert!(lowered.loop_change < 0.05, "{lowered:?}");
        assert!(spill.modes > 40 && spill.largest_pole < 1.0, "{method}: {spill:?}");
    }
}

#[test]
fn a_pi_tuned_under_the_limits_of_weights_that_a_file_states_is_put_beside_them() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let project = examples::resolve_example(&path, Purpose::Synth).unwrap();
    let world = examples::world(&path);
    let row =
        study_synthesis(&project, &world).unwrap().comparison.tuned_pi.expect("the file states weights");
    assert_eq!(row.missed, 0.0);
    assert!((0.05..0.10).contains(&row.improvement()), "{}", row.improvement());
    // weights that were tuned themselves, or chosen for the bandwidth, have nothing to learn from it
    for other in ["reference-rig/tuned-weights.toml", "servo-pendulum/project.toml"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(other);
        let project = examples::resolve_example(&path, Purpose::Synth).unwrap();
        let mut quick = project.clone();
        if let Some(tuning) = quick.synth.as_mut().and_then(|synth| synth.options.tuning.as_mut()) {
            tuning.weights = TunedWeights::Tuned;
        }
        let study = study_synthesis(&quick, &examples::world(&path)).unwrap();
        assert!(study.comparison.tuned_pi.is_none(), "{other}");
    }
}
