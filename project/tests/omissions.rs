//! A file with one section or key left out: it is read, with what is assumed, or fails with one sentence that names what to add.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_project::resolve::synthesis::LoopKind;
use counterpoise_project::{Attachments, Document, Project};
use counterpoise_verify::robustness::VariedParameter;

const GOOD: &str = include_str!("data/rig.toml");

/// Keys whose absence means something else than a value: names, choices, lists.
fn is_no_quantity(key: &str) -> bool {
    let last = key.rsplit('.').next().unwrap_or(key);
    key.contains('[')
        || ["name", "model", "shape", "map", "place", "acts", "kind", "curve", "axis", "dynamics", "reads"]
            .contains(&last)
}

/// Returns every key of a project, and every section, in the order of its file.
fn paths(project: &Project) -> Vec<String> {
    let sections = project.statements();
    let keys = sections.iter().flat_map(|s| s.values.iter().map(move |v| format!("{}.{}", s.path, v.key)));
    let named = sections.iter().map(|s| s.path.clone()).filter(|path| !path.ends_with(']'));
    named.chain(keys).collect()
}

/// Checks what is said of a file without one key or section.
pub(crate) fn check_omission(document: &Document, path: &str) -> Option<String> {
    match Project::resolve(document, &Attachments::none()) {
        Ok(parsed) => {
            let physical = path.starts_with("plant.") && !is_no_quantity(path);
            let is_key = !parsed.project.statements().iter().any(|s| s.path == path);
            let listed =
                parsed.assumptions.iter().any(|a| a.key == path || a.key.starts_with(&format!("{path}.")));
            (physical && is_key && !listed && !is_optional_section(path))
                .then(|| format!("{path}: read, but not listed as assumed"))
        }
        Err(errors) => {
            let said: Vec<String> = errors.iter().map(ToString::to_string).collect();
            let parent = path.rsplit_once('.').map_or(path, |(parent, _)| parent);
            let last = path.rsplit('.').next().unwrap_or(path);
            let names = |line: &String| {
                line.contains(path)
                    || (line.contains(parent) && line.contains(last.split('[').next().unwrap()))
            };
            (said.len() != 1 || !said.iter().any(names)).then(|| format!("{path}: {}", said.join("\n    ")))
        }
    }
}

/// Sections whose absence is a machine without the thing: nothing is assumed of what is not there.
fn is_optional_section(path: &str) -> bool {
    let sections = [
        "beam",
        "lumped",
        "import",
        "configuration",
        "motor_tachometer",
        "hub_resolver",
        "amplifier",
        "friction",
        "sensors",
        "gearbox",
        "motor",
    ];
    path.split('.').skip(1).any(|part| sections.contains(&part)) && path.matches('.').count() < 3
}

#[test]
fn each_key_left_out_is_assumed_or_asked_for_in_one_sentence() {
    let document = Document::parse(GOOD, "rig.toml");
    let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let paths = paths(&project);
    assert!(paths.len() > 150, "{}", paths.len());
    let wrong: Vec<String> = paths
        .iter()
        .filter_map(|path| {
            let without = document.remove(path).unwrap();
            check_omission(&without, path)
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), paths.len(), wrong.join("\n"));
}

#[test]
fn feedforwards_without_their_sensors_are_one_error_that_names_what_to_add() {
    let document = Document::parse(GOOD, "rig.toml");
    let told = |paths: &[&str]| {
        let without = paths.iter().fold(document.clone(), |document, path| document.remove(path).unwrap());
        let errors = Project::resolve(&without, &Attachments::none()).unwrap_err();
        assert_eq!(errors.len(), 1, "{errors:?}");
        errors[0].to_string()
    };
    let one = told(&["plant.sensors.platform_gyro"]);
    assert!(one.contains("[synth.pitch]") && one.contains("add [plant.sensors.platform_gyro]"), "{one}");
    assert!(!one.contains("heave"), "{one}");
    let both = told(&["plant.sensors.platform_gyro", "plant.sensors.platform_accelerometer"]);
    assert!(both.contains("[synth.heave] and [synth.pitch]"), "{both}");
    assert!(
        both.contains("[plant.sensors.platform_accelerometer] and [plant.sensors.platform_gyro]"),
        "{both}"
    );
}

const SLIDE: &str =
    "format = 2\n[plant]\naxis = \"linear\"\nmass = 70.0\n[plant.interface]\nsample_period = \"1 ms\"\n";

#[test]
fn the_loop_is_what_its_sensor_measures_or_a_cascade_of_a_position() {
    let read = |more: &str| {
        let text = format!("{SLIDE}{more}");
        Project::resolve(&Document::parse(&text, "slide.toml"), &Attachments::none())
            .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    };
    let encoder = "[plant.sensors.encoder]\nresolution = \"1 um\"\n";
    let with_step = "[verify.step]\nrate = \"2 mm\"\n";
    let cascade = "[synth]\nloop = \"cascade\"\nposition_gain = \"4 Hz\"\n";
    let project = read(&format!("{encoder}{cascade}{with_step}")).unwrap().project;
    let synth = project.synth.as_ref().unwrap();
    assert_eq!(synth.loop_kind, LoopKind::Cascade);
    assert!((synth.specification.position_gain.unwrap() - 4.0 * std::f64::consts::TAU).abs() < 1e-9);
    assert_eq!(project.verify.as_ref().unwrap().procedure.step.rate_rad_s, 2e-3);
    let again = Project::parse(&project.to_text(), "again.toml").unwrap().project;
    assert_eq!(again, project, "the canonical text keeps the cascade");
    assert!(read(&format!("{encoder}[synth]\nloop = \"rate\"\n")).unwrap_err().contains("tachometer"));
    assert!(read("[synth]\nloop = \"cascade\"\n").unwrap_err().contains("[plant.sensors.encoder]"));
    let with_method = format!("{encoder}{cascade}method = \"lqg-ltr\"\n");
    assert!(read(&with_method).unwrap_err().contains("must not be \"cascade\" with `method`"));
    let reduced = format!("{encoder}{cascade}[reduce]\nmethod = \"balanced\"\n");
    assert!(read(&reduced).unwrap_err().contains("rate loop is designed on the plant as it is"));
    assert!(read(&format!("{encoder}{}", with_step.replace("mm", "mm/s"))).unwrap_err().contains("a speed"));
}

#[test]
fn tolerances_of_every_kind_of_machine_are_varied() {
    let text = SLIDE.replace("70.0", "{ value = 70.0, tolerance = 0.2 }")
        + "[plant.ball_screw]\nlead = 0.04\nstiffness = { value = 2e8, tolerance = 0.3 }\n[plant.motor]\ninertia = 4e-3\n";
    let parsed = Project::parse(&text, "slide.toml").unwrap();
    assert!(parsed.warnings.is_empty(), "{:?}", parsed.warnings);
    let varied: Vec<_> = parsed.project.campaign().unwrap().variations.iter().map(|v| v.parameter).collect();
    assert_eq!(varied, [VariedParameter::HubInertia, VariedParameter::GearStiffness]);
}

#[test]
fn a_beam_without_damping_has_the_usual_ratio_which_is_listed_and_can_be_varied() {
    let without = Document::parse(GOOD, "rig.toml").remove("plant.beam.modal_damping").unwrap();
    let parsed = Project::resolve(&without, &Attachments::none()).unwrap();
    assert_eq!(parsed.project.plant.beam.as_ref().unwrap().modal_damping, [0.01]);
    let assumed = parsed.assumptions.iter().find(|a| a.key == "plant.beam.modal_damping").unwrap();
    assert_eq!((assumed.value, assumed.usual), (0.01, Some([0.005, 0.03])));
    let varied = parsed.project.with_number(&assumed.key, 0.02).unwrap();
    assert_eq!(varied.plant.beam.unwrap().modal_damping, [0.02]);
}

#[test]
fn converters_that_read_an_unscaled_sensor_in_coarse_steps_are_told() {
    let text =
        |sensor: &str| format!("{}input_bits = 14\n[plant.motor]\ntorque_constant = 1.0\n{sensor}", SLIDE);
    let warned = |sensor: &str| {
        let parsed = Project::parse(&text(sensor), "slide.toml").unwrap();
        parsed.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let unscaled = warned("[plant.sensors.tachometer]\nnoise = 1e-3\n");
    assert!(
        unscaled.contains("plant.sensors.tachometer.scale") && unscaled.contains("steps of 1.22"),
        "{unscaled}"
    );
    assert_eq!(warned("[plant.sensors.tachometer]\nscale = 4.0\n"), "");
    assert_eq!(warned("[plant.sensors.encoder]\nresolution = \"1 um\"\n"), "");
}

#[test]
fn names_of_data_sheets_are_answered_with_the_key() {
    let said = |text: &str| {
        let errors =
            Project::resolve(&Document::parse(text, "slide.toml"), &Attachments::none()).unwrap_err();
        errors.iter().map(|error| format!("{error}\n")).collect::<String>()
    };
    for (wrong, meant) in [
        (format!("name = \"x\"\n{SLIDE}"), "did you mean \"plant.name\"?"),
        (format!("{SLIDE}[plant.motor]\nforce_constant = 12.0\n"), "did you mean \"torque_constant\"?"),
        (format!("{SLIDE}[plant.motor]\nke = 12.0\n"), "did you mean \"back_emf_constant\"?"),
        (SLIDE.replace("sample_period", "ts"), "did you mean \"sample_period\"?"),
    ] {
        assert!(said(&wrong).contains(meant), "{}", said(&wrong));
    }
}

/// A slide with everything that a first design needs.
const FORCED_SLIDE: &str = "format = 2
plant = { axis = \"linear\", mass = \"5 kg\", drive = { kind = \"torque\", limit = \"50 N\" }, interface = { sample_period = \"1 ms\" } }
";

fn first_finding(text: &str) -> String {
    Project::parse(text, "machine.toml").unwrap_err()[0].to_string()
}

#[test]
fn what_a_drive_needs_is_asked_for_and_what_is_missing_comes_first() {
    let voltage = "format = 2\nplant.inertia = 1.0\nplant.motor.resistance = 1.1\nplant.drive = { kind = \"voltage\", limit = 24.0 }\nplant.interface.sample_period = 1e-3\n";
    let found = first_finding(voltage);
    assert!(
        found.contains("the motor's torque constant decides") && found.contains("add `torque_constant`"),
        "{found}"
    );
    assert!(
        Project::parse(
            &voltage.replace("resistance = 1.1", "resistance = 1.1\nplant.motor.torque_constant = 0.04"),
            "machine.toml"
        )
        .is_ok()
    );
    let found = first_finding(&voltage.replace("\"voltage\"", "\"current\""));
    assert!(found.contains("takes a current"), "{found}");
    // Many wrong values do not hide that a whole section is missing.
    let wrong = "[plant]\ninertia = \"5 kg\"\ngearbox = { ratio = -3 }\n";
    let found = first_finding(wrong);
    assert!(found.contains("section [plant.interface] is missing"), "{found}");
    assert!(
        first_finding("format = 2\n").contains("the smallest is `plant = {"),
        "{}",
        first_finding("format = 2\n")
    );
    let found = first_finding(
        "format = 2\nplant = { inertia = 1.0, gearbox = { stiffness = 1e4 }, motor = { inertia = 1e-4 }, interface = { sample_period = 1e-3 } }\n",
    );
    assert!(found.contains("plant.gearbox.ratio") && found.contains("count the turns"), "{found}");
}

#[test]
fn a_key_that_is_left_out_is_asked_for_in_one_sentence() {
    let slide = "format = 2
plant = { axis = \"linear\", mass = \"5 kg\", motor = { torque_constant = \"60 N/A\" }, drive = { limit = \"9 A\", bandwidth = \"900 Hz\", delay = \"0.1 ms\" }, interface = { sample_period = \"1 ms\" } }
";
    let found = Project::parse(slide, "machine.toml").unwrap_err();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].to_string().contains("add kind = \"current\""), "{}", found[0]);
    let cascade = format!("{FORCED_SLIDE}synth.loop = \"cascade\"\nverify.step = {{ rate = \"0.5 mm\" }}\n");
    let found = Project::parse(&cascade, "machine.toml").unwrap_err();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].to_string().contains("[plant.sensors.encoder] or resolver"), "{}", found[0]);
}

#[test]
fn a_slide_is_moved_by_a_base_that_slides() {
    let slide = format!("{FORCED_SLIDE}verify.pitch = {{ amplitude = \"0.2 m/s\", frequency = 1.0 }}\n");
    let project = Project::parse(&slide, "machine.toml").unwrap().project;
    assert_eq!(project.verify.unwrap().procedure.pitch.amplitude, 0.2);
    let found = first_finding(&slide.replace("0.2 m/s", "0.2 rad/s"));
    assert!(found.contains("must be a speed"), "{found}");
}
