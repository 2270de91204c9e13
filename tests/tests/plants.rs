//! The same machine described in several ways, driven in several ways: what must agree does, in the closed loop too.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use counterpoise_linalg::Mat;
use counterpoise_models::structure::{FeModel, Support, undamped_modes};
use counterpoise_pipeline::{
    SynthesisedDesign, build_plant_model, finite_elements, project_procedure, reduce_plant, synthesise,
    verify_on,
};
use counterpoise_project::{Attachments, Document, Project, SettingValue, StructureChoice};
use counterpoise_tests::ExampleFolder;
use counterpoise_verify::{PerformanceFigure, Verification};

fn folder(example: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example)
}

fn document(example: &str) -> Document {
    let text = std::fs::read_to_string(folder(example).join("project.toml")).unwrap();
    Document::parse(&text, example)
}

/// A project with the files beside it; those of `files` take the place of what lies there.
fn resolve_project(document: &Document, example: &str, files: &[(&str, String)]) -> Project {
    let read = |name: &str| match files.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => text.clone().into_bytes(),
        None => std::fs::read(folder(example).join(name)).unwrap(),
    };
    let attach = |all: Attachments, name: String| all.with(&name, read(&name));
    let attachments = document.attachments().into_iter().fold(Attachments::none(), attach);
    match Project::resolve(document, &attachments) {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{errors:?}"),
    }
}

fn design_project(project: &Project) -> SynthesisedDesign {
    let modelled = build_plant_model(project).unwrap();
    synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap()).unwrap()
}

/// A controller verified on the plant of another structure.
fn verify_on_structure(
    project: &Project,
    made: &SynthesisedDesign,
    structure: StructureChoice,
    example: &str,
) -> Verification {
    let mut other = project.clone();
    other.model.structure = structure;
    let plant = build_plant_model(&other).unwrap().plant;
    let procedure = project_procedure(project, &ExampleFolder(folder(example))).unwrap();
    verify_on(project, &plant, made, &procedure).unwrap().into_parts().1
}

fn value(found: &Verification, key: &str) -> f64 {
    let figure = PerformanceFigure::from_key(key).unwrap();
    found.value(figure).unwrap_or_else(|| panic!("{key} was not measured"))
}

/// Figure, how far it may differ between the two inertias and the finite elements, relative (absolute for dB and degrees).
///
/// Both have the same inertia, moment, and first pinned and hub-locked frequencies, and the loop crosses at a tenth of the first of
/// them. So what lives below that agrees within a percent: margins, steps, rejection of pitch, motion under heave and pitch and on
/// the road. Rejection of heave with the feedforward is a difference of nearly equal torques, of which the elements' own modes,
/// bent by heave, are 1 part in 2e4: -84 dB instead of -87 dB. At rest there is only noise, to which the higher modes answer.
const AGREE: [(&str, f64); 12] = [
    ("gain_margin_db", 0.1),
    ("phase_margin_deg", 0.1),
    ("max_sensitivity", 0.003),
    ("delay_margin_s", 0.003),
    ("linear_step_overshoot_percent", 0.03),
    ("nonlinear_step_overshoot_percent", 0.03),
    ("nonlinear_step_settling_time_s", 0.03),
    ("pitch_compensated_drr_db at 1 Hz", 0.05),
    ("heave_compensated_drr_db at 1 Hz", 5.0),
    ("nonlinear_both_compensated_hub_rms_rad_s", 0.005),
    ("nonlinear_road_compensated_hub_rms_rad_s", 0.01),
    ("rest_hub_rms_rad_s", 0.1),
];

fn absolute(key: &str) -> bool {
    key.contains("_db") || key.contains("_deg")
}

#[test]
fn two_inertias_and_finite_elements_agree_in_the_closed_loop() {
    let project = resolve_project(&document("reference-rig"), "reference-rig", &[]);
    let made = design_project(&project);
    let lumped = verify_on_structure(&project, &made, StructureChoice::Lumped, "reference-rig");
    let beam = verify_on_structure(&project, &made, StructureChoice::Beam, "reference-rig");
    for (key, allowed) in AGREE {
        let (a, b) = (value(&lumped, key), value(&beam, key));
        let apart = if absolute(key) { (a - b).abs() } else { (b / a - 1.0).abs() };
        assert!(apart <= allowed, "{key}: lumped {a}, finite elements {b}");
    }
    assert!(lumped.passes() && beam.passes());
}

#[test]
fn the_nonlinear_plant_without_its_nonlinearities_is_the_linear_one() {
    let still =
        ["backlash = 0.5e-3", "coulomb = 0.065 ", "coulomb = 117.0 ", "noise = 2.0e-4", "noise = 5.0e-3"];
    let ideal = ["backlash = 0.0", "coulomb = 1e-9 ", "coulomb = 1e-6 ", "noise = 0.0", "noise = 0.0"];
    let mut text = document("reference-rig")
        .text()
        .replace("_bits = 16", "_bits = 32")
        .replace("_bits = 12", "_bits = 32");
    for (from, to) in still.iter().zip(ideal) {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let project = resolve_project(&Document::parse(&text, "ideal"), "reference-rig", &[]);
    let made = design_project(&project);
    for structure in [StructureChoice::Lumped, StructureChoice::Beam] {
        let found = verify_on_structure(&project, &made, structure, "reference-rig");
        for kind in
            ["step_overshoot_percent", "both_compensated_hub_rms_rad_s", "road_compensated_hub_rms_rad_s"]
        {
            let (a, b) =
                (value(&found, &format!("linear_{kind}")), value(&found, &format!("nonlinear_{kind}")));
            assert!((b / a - 1.0).abs() < 0.02, "{structure:?} {kind}: linear {a}, nonlinear {b}");
        }
    }
}

fn frequencies(fe: &FeModel, support: Support) -> Vec<f64> {
    undamped_modes(fe, support).unwrap().flexible_rad_s()[..4].to_vec()
}

#[test]
fn the_rigs_beam_as_imported_matrices_is_the_rigs_beam() {
    let rig = resolve_project(&document("reference-rig"), "reference-rig", &[]);
    let imported = resolve_project(&document("imported-structure"), "imported-structure", &[]);
    let (beam, _) = finite_elements(&rig, StructureChoice::Beam).unwrap();
    let (matrices, _) = finite_elements(&imported, StructureChoice::Import).unwrap();
    for support in [Support::Free, Support::Pinned, Support::Clamped] {
        for (a, b) in frequencies(&beam, support).iter().zip(frequencies(&matrices, support)) {
            assert!((a / b - 1.0).abs() < 1e-9, "{support:?}: {a} {b}");
        }
    }
    let made = design_project(&imported);
    let mut with_beam = imported.clone();
    with_beam.plant.beam.clone_from(&rig.plant.beam);
    let run = |structure| verify_on_structure(&with_beam, &made, structure, "imported-structure");
    let (a, b) = (run(StructureChoice::Beam), run(StructureChoice::Import));
    for (key, _) in AGREE {
        let (a, b) = (value(&a, key), value(&b, key));
        assert!((b / a - 1.0).abs() < 1e-6, "{key}: beam {a}, matrices {b}");
    }
}

#[test]
fn inertias_derived_from_matrices_are_the_rigs() {
    let mut imported = resolve_project(&document("imported-structure"), "imported-structure", &[]);
    imported.model.structure = StructureChoice::Lumped;
    let derived = build_plant_model(&imported).unwrap().parameters.lumped.unwrap();
    let given = resolve_project(&document("reference-rig"), "reference-rig", &[]).plant.lumped.unwrap();
    for (a, b) in [
        (derived.hub_inertia_kg_m2, given.hub_inertia_kg_m2),
        (derived.beam_inertia_kg_m2, given.beam_inertia_kg_m2),
        (derived.stiffness_nm_rad, given.stiffness_nm_rad),
        (derived.out_of_balance_kg_m, given.out_of_balance_kg_m),
    ] {
        assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
    }
    imported.model.configuration = Some("balanced".to_owned());
    let balanced = build_plant_model(&imported).unwrap().parameters.lumped.unwrap();
    assert!(balanced.out_of_balance_kg_m.abs() < 0.2, "{}", balanced.out_of_balance_kg_m);
}

/// Every entry of the lower half as free-field DMIG.
fn dmig(name: &str, A: &Mat, grid: impl Fn(usize) -> (usize, u8)) -> String {
    let mut text = format!("DMIG,{name},0,6,2,0\n");
    for j in 0..A.ncols() {
        let (at, component) = grid(j);
        for i in (j..A.nrows()).filter(|&i| A[(i, j)] != 0.0) {
            let (row, turned) = grid(i);
            writeln!(text, "DMIG,{name},{at},{component},,{row},{turned},{:e}", A[(i, j)]).unwrap();
        }
    }
    text
}

/// A dense matrix as OUTPUT4 text.
fn op4(name: &str, A: &Mat) -> String {
    let n = A.nrows();
    let mut text = format!("{n:8}{n:8}{:8}{:8}{name:<8}1P,3E24.16\n", 6, 2);
    for j in 0..n {
        writeln!(text, "{:8}{:8}{n:8}", j + 1, 1).unwrap();
        for three in A.column(j).chunks(3) {
            three.iter().for_each(|v| write!(text, "{:>24}", format!("{v:.16E}")).unwrap());
            text.push('\n');
        }
    }
    writeln!(text, "{:8}{:8}{:8}\n{:>24}", n + 1, 1, 1, "1.0000000000000000E+00").unwrap();
    text
}

#[test]
fn matrices_in_nastrans_formats_make_the_same_plant() {
    let market = resolve_project(&document("imported-structure"), "imported-structure", &[]);
    let content = market.import.as_ref().unwrap().content.as_ref().unwrap();
    let rows = &content.matrices.rows;
    let grid = |i: usize| (rows[i].grid as usize, rows[i].component);
    let expected = build_plant_model(&market).unwrap().plant.body().clone();
    let both = |format: &str| {
        let text = |key: &str, value: &str| (key.to_owned(), SettingValue::Text(value.to_owned()));
        let settings = [
            text("plant.import.format", format),
            text("plant.import.mass_matrix", "all.dat"),
            text("plant.import.stiffness_matrix", "all.dat"),
            text("plant.import.mass_name", "MGG"),
            text("plant.import.stiffness_name", "KGG"),
        ];
        settings.iter().fold(document("imported-structure"), |d, (key, value)| d.set(key, value).unwrap())
    };
    let (M, K) = (&content.matrices.M.to_dense(), &content.matrices.K.to_dense());
    for (format, file) in
        [("dmig", dmig("MGG", M, grid) + &dmig("KGG", K, grid)), ("op4", op4("MGG", M) + &op4("KGG", K))]
    {
        let project = resolve_project(&both(format), "imported-structure", &[("all.dat", file)]);
        let found = build_plant_model(&project).unwrap().plant.body().clone();
        assert!((found.inertia_kg_m2 / expected.inertia_kg_m2 - 1.0).abs() < 1e-9, "{format}");
        for (a, b) in found.modes.iter().zip(&expected.modes) {
            assert!((a.frequency_rad_s / b.frequency_rad_s - 1.0).abs() < 1e-9, "{format}");
            assert!((a.hub_shape.abs() / b.hub_shape.abs() - 1.0).abs() < 1e-6, "{format}");
        }
    }
}

#[test]
fn matrices_of_abaqus_and_calculix_make_the_same_plant() {
    let market = resolve_project(&document("imported-structure"), "imported-structure", &[]);
    let content = market.import.as_ref().unwrap().content.as_ref().unwrap();
    let rows = &content.matrices.rows;
    let expected = build_plant_model(&market).unwrap().plant.body().clone();
    let lines = |A: &Mat, word: &dyn Fn(usize) -> String| -> String {
        let places = (0..A.ncols()).flat_map(|j| (0..=j).map(move |i| (i, j)));
        let line = |(i, j): (usize, usize)| format!("{},{},{:.15e}\n", word(i), word(j), A[(i, j)]);
        places.filter(|&place| A[place] != 0.0).map(line).collect()
    };
    let label = |i: usize| format!("{},{}", rows[i].grid, rows[i].component);
    let number = |i: usize| (i + 1).to_string();
    let (M, K) = (&content.matrices.M.to_dense(), &content.matrices.K.to_dense());
    let names: String = rows.iter().map(|row| format!("{}.{}\n", row.grid, row.component)).collect();
    let map = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/imported-structure/nodes.map"
    ));
    let map = map.unwrap();
    let without_rows: String =
        map.lines().filter(|line| !line.starts_with("row")).map(|l| format!("{l}\n")).collect();
    let text = |key: &str, value: &str| (format!("plant.import.{key}"), SettingValue::Text(value.to_owned()));
    let files =
        [text("mass_matrix", "m.dat"), text("stiffness_matrix", "k.dat"), text("node_map", "some.map")];
    for (format, word, map) in [
        ("abaqus", &label as &dyn Fn(usize) -> String, &without_rows),
        ("abaqus", &number, &map),
        ("calculix", &number, &without_rows),
    ] {
        let mut settings = vec![text("format", format)];
        settings.extend(files.iter().cloned());
        settings.extend((format == "calculix").then(|| text("row_names", "rows.dof")));
        let written = settings
            .iter()
            .fold(document("imported-structure"), |d, (key, value)| d.set(key, value).unwrap());
        let content = [
            ("m.dat", lines(M, word)),
            ("k.dat", lines(K, word)),
            ("some.map", map.clone()),
            ("rows.dof", names.clone()),
        ];
        let found = build_plant_model(&resolve_project(&written, "imported-structure", &content)).unwrap();
        assert!((found.plant.body().inertia_kg_m2 / expected.inertia_kg_m2 - 1.0).abs() < 1e-9, "{format}");
        for (a, b) in found.plant.body().modes.iter().zip(&expected.modes) {
            assert!((a.frequency_rad_s / b.frequency_rad_s - 1.0).abs() < 1e-9, "{format}");
        }
    }
}

#[test]
fn a_damping_matrix_takes_the_place_of_ratios() {
    let market = resolve_project(&document("imported-structure"), "imported-structure", &[]);
    let content = market.import.as_ref().unwrap().content.as_ref().unwrap();
    let K = &content.matrices.K.to_dense();
    let mut text = format!("%%MatrixMarket matrix array real general\n{} {}\n", K.nrows(), K.ncols());
    K.as_slice().iter().for_each(|k| writeln!(text, "{:e}", 1e-5 * k).unwrap());
    let damped = document("imported-structure")
        .set("plant.import.damping_matrix", &SettingValue::Text("damping.mtx".to_owned()))
        .unwrap();
    let project = resolve_project(&damped, "imported-structure", &[("damping.mtx", text)]);
    for mode in &build_plant_model(&project).unwrap().plant.body().modes {
        assert!((mode.damping_ratio / (0.5e-5 * mode.frequency_rad_s) - 1.0).abs() < 1e-6);
    }
}

/// The reference rig on another platform.
fn on_platform(settings: &[(&str, SettingValue)]) -> Verification {
    let bare = document("reference-rig").remove("verify.road").unwrap();
    let moved =
        settings.iter().fold(bare, |d, (key, value)| d.set(&format!("verify.road.{key}"), value).unwrap());
    let psd = "Hz,density\n0.3,0.02\n1.5,0.4\n8.0,0.004\n".to_owned();
    let project = resolve_project(&moved, "reference-rig", &[("heave.csv", psd)]);
    let made = design_project(&project);
    verify_on_structure(&project, &made, StructureChoice::Lumped, "reference-rig")
}

/// Time, heave and pitch rate of the run on the road.
fn road(found: &Verification) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    use counterpoise_verify::{Experiment, Model, Source};
    let wanted = |e: &Experiment| matches!(e, Experiment::Disturbance(Source::Road, _));
    let all = &found.evidence.histories;
    let run = all.iter().find(|h| h.model == Model::Nonlinear && wanted(&h.experiment)).unwrap();
    (run.time_s().to_vec(), run.heave_m_s2().to_vec(), run.pitch_rate_rad_s().to_vec())
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
}

#[test]
fn the_platform_moves_by_a_spectrum() {
    let settings = |seed| {
        vec![
            ("kind", SettingValue::Text("spectrum".to_owned())),
            ("heave_psd", SettingValue::Text("heave.csv".to_owned())),
            ("pitch_psd", SettingValue::Pairs(vec![[0.2, 2e-3], [1.0, 6e-3], [5.0, 1e-4]])),
            ("duration", SettingValue::Number(20.0)),
            ("seed", SettingValue::Whole(seed)),
        ]
    };
    let found = on_platform(&settings(3));
    let (_, heave, pitch) = road(&found);
    // integral of the density from 0.3 to 8 Hz, straight between its points on logarithmic scales
    assert!((rms(&heave) / 0.627 - 1.0).abs() < 0.2, "{} m/s^2", rms(&heave));
    assert!(rms(&pitch) > 0.05 && rms(&pitch) < 0.12, "{} rad/s", rms(&pitch));
    let hub = value(&found, "nonlinear_road_compensated_hub_rms_rad_s");
    assert!(hub > 1e-4 && hub < 0.2 * rms(&pitch), "{hub} rad/s");
    assert_eq!(found.figures, on_platform(&settings(3)).figures, "a seed repeats");
    assert_ne!(hub, value(&on_platform(&settings(4)), "nonlinear_road_compensated_hub_rms_rad_s"));
}

#[test]
fn a_platform_simulator_heaves_with_its_pitch_acceleration() {
    let found = on_platform(&[
        ("kind", SettingValue::Text("simulator".to_owned())),
        ("offset", SettingValue::Number(1.2)),
        ("sines", SettingValue::Pairs(vec![[0.03, 0.5], [0.012, 1.1]])),
        ("duration", SettingValue::Number(12.0)),
    ]);
    let (time, heave, pitch) = road(&found);
    for k in (1..pitch.len() - 1).step_by(7) {
        let slope = (pitch[k + 1] - pitch[k - 1]) / (time[k + 1] - time[k - 1]);
        assert!((heave[k] - 1.2 * slope).abs() < 2e-3, "{}: {} {slope}", time[k], heave[k]);
    }
    assert!(value(&found, "nonlinear_road_compensated_hub_rms_rad_s") < 0.2 * rms(&pitch));
}

#[test]
fn a_road_of_iso_8608_stands_in_the_project_file() {
    let found = on_platform(&[
        ("kind", SettingValue::Text("iso-8608".to_owned())),
        ("class", SettingValue::Text("C".to_owned())),
        ("speed", SettingValue::Number(8.0)),
    ]);
    assert!(value(&found, "nonlinear_road_compensated_hub_rms_rad_s") > 1e-4);
}

#[test]
fn an_ideal_current_source_leaves_the_damping_by_back_emf_out() {
    let ideal = document("reference-rig")
        .set("plant.amplifier.dynamics", &SettingValue::Text("ideal-current".to_owned()))
        .unwrap();
    let simple = resolve_project(&ideal, "reference-rig", &[]);
    // J w' = -(F_p + N^2 F_m [+ N^2 K_t K_e / (R + K_v K_ifb)]) w, J with the motor's inertia as the hub feels it
    let p = &simple.plant;
    let (lumped, motor, square) = (p.lumped.as_ref().unwrap(), &p.motor, p.gearbox.ratio * p.gearbox.ratio);
    let inertia = lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2 + square * motor.inertia_kg_m2;
    let viscous = p.pivot_friction.viscous_nm_s_rad + square * p.motor_friction.viscous_nm_s_rad;
    let slowest = |project: &Project| {
        let poles = counterpoise_lti::poles(&build_plant_model(project).unwrap().linear.system).unwrap();
        poles.iter().map(|pole| pole.norm()).fold(f64::INFINITY, f64::min)
    };
    assert!((slowest(&simple) / (viscous / inertia) - 1.0).abs() < 0.01, "{}", slowest(&simple));
    let modelled = resolve_project(&document("reference-rig"), "reference-rig", &[]);
    let loop_ohm = motor.resistance_ohm + p.amplifier.gain * p.amplifier.current_feedback_v_a;
    let back_emf = square * motor.torque_constant_nm_a * motor.back_emf_v_s_rad / loop_ohm;
    assert!((slowest(&modelled) / ((viscous + back_emf) / inertia) - 1.0).abs() < 0.02);
    // designed and verified on it: what damped is gone, so the same weights leave less phase, and the road is held as well
    let (a, b) = (design_project(&modelled), design_project(&simple));
    let full = verify_on_structure(&modelled, &a, StructureChoice::Lumped, "reference-rig");
    let found = verify_on_structure(&simple, &b, StructureChoice::Lumped, "reference-rig");
    assert!(found.evidence.poles.iter().all(|pole| pole.norm() < 1.0));
    let (phase, phase_full) = (value(&found, "phase_margin_deg"), value(&full, "phase_margin_deg"));
    assert!(phase > 45.0 && phase < phase_full, "{phase} {phase_full} degrees");
    let road = "nonlinear_road_compensated_hub_rms_rad_s";
    assert!((value(&found, road) / value(&full, road) - 1.0).abs() < 0.15);
}
