//! Parts, tolerances, formats and assumptions of project files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_project::{
    Attachments, Document, FORMAT, ParsedProject, Project, SettingValue, ToleranceKind,
};

const GOOD: &str = include_str!("data/rig.toml");
const MOTOR: &str = "[plant.motor]\ninertia = \"40 kg cm^2\"  # with the pinion\ntorque_constant = { value = 0.86, tolerance = 0.1 }\nresistance = 0.8\ninductance = \"4 mH\"\n";

fn resolve_with_files(text: &str, files: &[(&str, &str)]) -> Result<ParsedProject, Vec<String>> {
    let document = Document::parse(text, "rig.toml");
    Project::resolve(&document, &attachments_of(files))
        .map_err(|errors| errors.iter().map(ToString::to_string).collect())
}

fn attachments_of(files: &[(&str, &str)]) -> Attachments {
    files.iter().fold(Attachments::none(), |all, (name, text)| all.with(name, text.as_bytes().to_vec()))
}

/// Returns the good file without its motor, which a part has.
fn without_motor(include: &str) -> String {
    let start = GOOD.find("[plant.motor]").unwrap();
    let end = start + GOOD[start..].find("\n[").unwrap() + 1;
    format!("{include}\n{}{}", &GOOD[..start], &GOOD[end..])
}

#[test]
fn a_motor_in_a_file_of_its_own_is_the_same_machine() {
    let same = resolve_with_files(GOOD, &[]).unwrap().project.plant;
    let parsed =
        resolve_with_files(&without_motor("include = \"parts/motor.toml\""), &[("parts/motor.toml", MOTOR)])
            .unwrap();
    assert_eq!(parsed.project.plant, same);
    let inside = without_motor("").replacen(
        "[plant.amplifier]",
        "[plant.motor]\ninclude = \"m.toml\"\n[plant.amplifier]",
        1,
    );
    let table = MOTOR.replace("[plant.motor]\n", "format = 2\n");
    assert_eq!(resolve_with_files(&inside, &[("m.toml", &table)]).unwrap().project.plant, same);
}

#[test]
fn mistakes_in_parts_name_the_right_file_and_line() {
    let text = without_motor("include = [\"motor.toml\"]");
    let told = |motor: &str| resolve_with_files(&text, &[("motor.toml", motor)]).unwrap_err().join("\n");
    assert_eq!(
        told(&MOTOR.replace("\"4 mH\"", "\"4 mV\"")),
        "motor.toml:5:14: error: plant.motor.inductance = \"4 mV\": must be an inductance, in a unit like H; \"4 mV\" is a voltage"
    );
    assert_eq!(told("[plant.motor\n"), "motor.toml:1:13: error: unclosed table, expected `]`");
    let twice = told(&format!("{MOTOR}[plant.gearbox]\nbacklash = 1e-3\n"));
    assert!(
        twice.starts_with("motor.toml:7:1: error: plant.gearbox.backlash: is given here and in rig.toml:"),
        "{twice}"
    );
    let missing = resolve_with_files(&text, &[]).unwrap_err().join("\n");
    assert_eq!(
        missing,
        "rig.toml:1:12: error: include: the file \"motor.toml\" was not found in the folder of the project file"
    );
    let newer = told(&format!("format = {}\n{MOTOR}", FORMAT + 1));
    assert!(newer.contains("motor.toml:1:10") && newer.contains("use a newer version"), "{newer}");
    let document = Document::parse(&text, "rig.toml")
        .with_parts(&attachments_of(&[("motor.toml", "[plant.motor]\ninertia = -1\n")]));
    let errors =
        Project::resolve(&document, &attachments_of(&[("motor.toml", "[plant.motor]\ninertia = -1\n")]))
            .unwrap_err();
    assert!(document.excerpt(&errors[0]).contains("2 | inertia = -1"), "{}", document.excerpt(&errors[0]));
}

#[test]
fn cycles_devices_and_thousands_of_parts_are_refused() {
    let told = |text: &str, files: &[(&str, &str)]| resolve_with_files(text, files).unwrap_err().join("\n");
    assert!(
        told("include = \"rig.toml\"", &[("rig.toml", "include = \"rig.toml\"")]).contains("includes itself")
    );
    let two = [("a.toml", "include = \"b.toml\""), ("b.toml", "[plant]\ninclude = \"x/../a.toml\"")];
    assert!(told("include = \"a.toml\"", &two).contains("rig.toml includes a.toml includes b.toml"));
    for bad in ["/dev/zero", "C:/motor.toml", "", "..\\\\motor.toml", "a\\u001bb"] {
        let said = told(&format!("include = \"{bad}\""), &[]);
        assert!(said.contains("must be relative to the file"), "{bad}: {said}");
    }
    assert!(told("include = 3", &[]).contains("must be the name of a file"));
    let many: Vec<String> = (0..10_000).map(|k| format!("\"p{k}.toml\"")).collect();
    let said = told(&format!("include = [{}]", many.join(", ")), &[]);
    assert!(said.lines().count() <= 100 && said.contains("at most 64 parts"), "{}", said.lines().count());
    let tree = "[plant]\ninclude = [\"t.toml\", \"t.toml\"]";
    assert!(
        told(tree, &[("t.toml", "[x]\ninclude = [\"u.toml\", \"u.toml\"]"), ("u.toml", "k = 1")])
            .contains("is given here and in")
    );
}

#[test]
fn files_that_a_part_names_lie_beside_the_part() {
    let part = "[plant.amplifier]\nmap = \"map.csv\"\n";
    let files = attachments_of(&[("drive/part.toml", part)]);
    let document = Document::parse("include = \"drive/part.toml\"", "rig.toml");
    assert_eq!(document.attachments(), ["drive/part.toml"]);
    assert_eq!(document.with_parts(&files).attachments(), ["drive/map.csv", "drive/part.toml"]);
}

#[test]
fn what_stands_in_a_part_is_changed_there_alone() {
    let files = attachments_of(&[("motor.toml", MOTOR)]);
    let document = Document::parse(&without_motor("include = \"motor.toml\""), "rig.toml").with_parts(&files);
    let told = document.set("plant.motor.inertia", &SettingValue::Number(1.0)).unwrap_err().to_string();
    assert_eq!(
        told,
        "\"plant.motor.inertia\" stands in the part \"motor.toml\", which other projects may share: change it in that file"
    );
    assert!(document.remove("plant.motor.inertia").is_err());
    let own = document.set("plant.gearbox.backlash", &SettingValue::Number(1e-3)).unwrap();
    assert!(own.text().contains("include = \"motor.toml\""));
    let changed = Project::resolve(&own, &files).unwrap().project;
    assert_eq!((changed.plant.gearbox.backlash_rad, changed.plant.motor.resistance_ohm), (1e-3, 0.8));
    assert_eq!(own.parts(), ["motor.toml"], "the parts stay in their places");
    let added = own.set("plant.motor.platform_coupling", &SettingValue::Number(1.0)).unwrap();
    assert_eq!(Project::resolve(&added, &files).unwrap().project.plant.motor.platform_coupling, 1.0);
}

#[test]
fn an_edit_keeps_the_unit_and_the_tolerance() {
    let text = GOOD
        .replacen("backlash = 0.5e-3 ", "backlash = \"0.5 mrad\" ", 1)
        .replacen("ratio = 200.0 ", "ratio = \"200:1\" ", 1)
        .replacen("input_bits = 16", "input_bits = \"16 bit\"", 1)
        .replacen(
            "torque_constant = 0.86 ",
            "torque_constant = { value = \"860 mN m/A\", tolerance = 0.1 } ",
            1,
        )
        .replacen("outer_diameter = [0.105, 0.070]", "outer_diameter = [\"105 mm\", 0.070]", 1);
    let document = Document::parse(&text, "rig.toml");
    let parsed = Project::resolve(&document, &Attachments::none()).unwrap();
    assert_eq!(parsed.project.plant, resolve_with_files(GOOD, &[]).unwrap().project.plant);
    let mut changed = parsed.project.clone();
    changed.plant.gearbox.backlash_rad = 0.7e-3;
    changed.plant.gearbox.ratio = 250.0;
    changed.plant.interface.input_bits = 14;
    changed.plant.motor.torque_constant_nm_a = 0.9;
    let beam = changed.plant.beam.as_mut().unwrap();
    if let counterpoise_models::SectionShape::Tube { outer_diameter_m, .. } = &mut beam.sections[2].shape {
        outer_diameter_m[0] = 0.11;
    }
    let saved = changed.update(&document, &parsed.project).unwrap();
    for kept in [
        "\"0.7 mrad\"",
        "\"250:1\"",
        "\"14 bit\"",
        "{ value = \"900 mN m/A\", tolerance = 0.1 }",
        "[\"110 mm\", 0.07]",
    ] {
        assert!(saved.text().contains(kept), "{kept} is missing in\n{}", saved.text());
    }
    let again = Project::resolve(&saved, &Attachments::none()).unwrap().project;
    assert_eq!(again.plant, changed.plant);
}

#[test]
fn a_tolerance_is_relative_or_absolute() {
    let text = GOOD
        .replacen("backlash = 0.5e-3 ", "backlash = { value = 0.5e-3, tolerance = \"0.1 mrad\" } ", 1)
        .replacen("hub_inertia = 74.1 ", "hub_inertia = { value = 74.1, tolerance = \"10 %\" } ", 1);
    let project = resolve_with_files(&text, &[]).unwrap().project;
    let found: Vec<_> = project.tolerances.iter().map(|t| (t.key.as_str(), t.half_width, t.kind)).collect();
    assert_eq!(found.len(), 2);
    assert_eq!((found[0].0, found[0].2), ("plant.lumped.hub_inertia", ToleranceKind::Relative));
    assert!((found[0].1 - 7.41).abs() < 1e-12);
    assert_eq!(found[1], ("plant.gearbox.backlash", 1e-4, ToleranceKind::Absolute));
    let again = resolve_with_files(&project.to_text(), &[]).unwrap().project;
    assert_eq!(again, project, "the canonical text keeps tolerances");
    let told = |tolerance: &str| {
        let with = format!("backlash = {{ value = 0.5e-3, {tolerance} }} ");
        resolve_with_files(&GOOD.replacen("backlash = 0.5e-3 ", &with, 1), &[]).unwrap_err().join("\n")
    };
    assert!(
        told("tolerance = 2.0").contains("reaches from -0.0005 to 0.0015 rad"),
        "{}",
        told("tolerance = 2.0")
    );
    assert!(told("tolerance = -0.1").contains("must be a finite number that is at least 0"));
    assert!(told("tolerance = \"3 mm\"").contains("is a length"));
    assert!(told("tolerence = 0.1").contains("there is no such key; known here: value, tolerance"));
    assert!(told("tolerance = nan").contains("must be a finite number that is at least 0"));
}

#[test]
fn older_formats_are_read_migrated_and_newer_ones_refused() {
    assert!(resolve_with_files(GOOD, &[]).unwrap().warnings.is_empty(), "format 1 is read");
    let migrated = Document::parse(GOOD, "rig.toml").migrate().unwrap();
    assert_eq!(migrated.text(), GOOD.replacen("format = 1", "format = 2", 1), "every comment stays");
    let windows = GOOD.replace('\n', "\r\n");
    let migrated_there = Document::parse(&windows, "rig.toml").migrate().unwrap();
    assert_eq!(migrated_there.text(), migrated.text().replace('\n', "\r\n"), "line ends stay");
    let bare = GOOD.replacen("format = 1\n", "", 1);
    let migrated = Document::parse(&bare, "rig.toml").migrate().unwrap();
    assert_eq!(migrated.text().replacen("format = 2\n", "", 1), bare);
    assert_eq!(
        resolve_with_files(migrated.text(), &[]).unwrap().project,
        resolve_with_files(GOOD, &[]).unwrap().project
    );
    let newer =
        resolve_with_files(&GOOD.replacen("format = 1", "format = 3\nanything = 7", 1), &[]).unwrap_err();
    assert_eq!(
        newer,
        [
            "rig.toml:1:10: error: format: the file is of format 3, but this version of Counterpoise reads formats up to 2: use a newer version"
        ]
    );
    let mixed =
        resolve_with_files(&GOOD.replacen("backlash = 0.5e-3 ", "backlash = \"0.5 mrad\" ", 1), &[]).unwrap();
    assert!(mixed.warnings[0].to_string().contains("check --migrate"), "{:?}", mixed.warnings);
}

#[test]
fn what_is_left_out_of_the_plant_is_listed() {
    let text = GOOD.replacen("back_emf_constant = 0.86", "# back_emf_constant", 1).replacen(
        "backlash = 0.5e-3 ",
        "# ",
        1,
    );
    let parsed = resolve_with_files(&text, &[]).unwrap();
    assert_eq!(parsed.project.plant.motor.back_emf_v_s_rad, 0.86);
    let of = |key: &str| parsed.assumptions.iter().find(|a| a.key == key).unwrap();
    let emf = of("plant.motor.back_emf_constant");
    assert_eq!((emf.value, emf.unit), (0.86, "V s/rad"));
    assert_eq!(emf.rule, "equal to the torque constant in SI units");
    assert_eq!(of("plant.gearbox.backlash").value, 0.0);
    let other = parsed.project.with_number("plant.motor.back_emf_constant", 0.5).unwrap();
    assert_eq!(other.plant.motor.back_emf_v_s_rad, 0.5);
    assert!(parsed.project.with_number("plant.motor.colour", 0.5).is_none());
    let saved = other.update(&Document::parse(&text, "rig.toml"), &parsed.project).unwrap();
    assert_eq!(resolve_with_files(saved.text(), &[]).unwrap().project, other);
    let mut stronger = parsed.project.clone();
    stronger.plant.motor.torque_constant_nm_a = 1.0;
    let saved = stronger.update(&Document::parse(&text, "rig.toml"), &parsed.project).unwrap();
    let again = resolve_with_files(saved.text(), &[]).unwrap().project.plant.motor;
    assert_eq!(
        (again.torque_constant_nm_a, again.back_emf_v_s_rad),
        (1.0, 0.86),
        "what was assumed is written down"
    );
}

#[test]
fn a_hundred_thousand_mistakes_take_no_longer_than_their_number() {
    let lines: String = (0..100_000).map(|k| format!("k{k} = 1\n")).collect();
    let errors = resolve_with_files(&format!("{GOOD}\n[nowhere]\n{lines}"), &[]).unwrap_err();
    assert_eq!(errors.len(), 1);
    let items: String =
        (0..100_000).map(|_| "[[plant.beam.mass]]\nname = \"m\"\nposition = 1.0\nmass = -1\n").collect();
    let errors = resolve_with_files(&format!("{GOOD}\n{items}"), &[]).unwrap_err();
    assert!(errors.len() <= 2100, "{}", errors.len());
    let one_line = format!("modes = [{}]", vec!["\"x\""; 200_000].join(", "));
    let errors = resolve_with_files(&format!("{GOOD}\n[measured]\n{one_line}\n"), &[]).unwrap_err();
    assert!(errors.len() <= 1100, "{}", errors.len());
}

#[test]
fn control_characters_of_a_file_reach_no_terminal() {
    let text = GOOD.replacen("name = \"reference rig\"", "name = \"a\\u001b[31mb\"\n\"\\u001b[2J\" = 3", 1);
    for line in resolve_with_files(&text, &[]).unwrap_err() {
        assert!(!line.chars().any(char::is_control), "{line:?}");
    }
    let raw = format!("name = \u{202e}3\n{GOOD}");
    let document = Document::parse(&raw, "rig\u{1b}.toml");
    for error in Project::resolve(&document, &Attachments::none()).unwrap_err() {
        let shown = document.excerpt(&error);
        assert!(!shown.contains(['\u{202e}', '\u{1b}']), "{shown:?}");
    }
}
