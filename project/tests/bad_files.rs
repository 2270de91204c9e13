//! Bad project files: each mistake, and exactly what is said about it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_project::{Attachments, Document, Project, Purpose};

const GOOD: &str = include_str!("data/rig.toml");
const CASES: &str = include_str!("data/bad_files.txt");

/// A mistake: what is replaced in the good file (first place), by what, and every line that must be said.
struct Case {
    from: String,
    to: String,
    said: Vec<String>,
}

/// Cases are separated by empty lines: `- old` lines, `+ new` lines, and the expected findings.
fn cases() -> Vec<Case> {
    CASES.split("\n\n").filter(|block| !block.trim().is_empty()).map(case).collect()
}

fn case(block: &str) -> Case {
    let lines =
        |mark: &str| block.lines().filter_map(|l| l.strip_prefix(mark)).collect::<Vec<_>>().join("\n");
    let said = block.lines().filter(|l| l.starts_with("rig.toml")).map(str::to_owned).collect();
    Case { from: lines("- "), to: lines("+ "), said }
}

fn findings(text: &str) -> Vec<String> {
    match Project::parse(text, "rig.toml") {
        Ok(parsed) => parsed.warnings.iter().map(ToString::to_string).collect(),
        Err(errors) => errors.iter().map(ToString::to_string).collect(),
    }
}

#[test]
fn each_mistake_is_told_exactly() {
    let mut wrong = String::new();
    let cases = cases();
    assert!(cases.len() >= 60, "{} cases", cases.len());
    for Case { from, to, said } in cases {
        assert!(GOOD.contains(&from), "the good file has no {from:?}");
        let found = findings(&GOOD.replacen(&from, &to, 1));
        if found != said {
            wrong += &format!("{}\n{}\n{}\n\n", mark("- ", &from), mark("+ ", &to), found.join("\n"));
        }
    }
    assert!(wrong.is_empty(), "found instead:\n{wrong}");
}

fn mark(mark: &str, text: &str) -> String {
    text.split('\n').map(|line| format!("{mark}{line}")).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_good_file_is_good() {
    assert_eq!(findings(GOOD), Vec::<String>::new());
}

#[test]
fn many_mistakes_come_at_once_wrong_values_first_then_unknown_keys_each_in_order_of_place() {
    let text = GOOD
        .replacen("gravity = 9.80665", "gravity = -1", 1)
        .replacen("backlash = 0.5e-3", "backlsh = 0.5e-3", 1)
        .replacen("hub_inertia = 74.1", "hub_inertia = 0", 1)
        .replacen("kp = 18.0", "kp = \"much\"", 1);
    let found = findings(&text);
    let lines: Vec<&str> = found.iter().filter_map(|f| f.split(':').nth(1)).collect();
    assert_eq!(lines, ["12", "67", "175", "79"], "{found:#?}");
}

#[test]
fn not_text_not_toml_not_there() {
    let bytes = Project::from_bytes(b"[plant]\nname = \"\xff\"", "rig.toml").unwrap_err();
    assert_eq!(
        bytes[0].to_string(),
        "rig.toml:2:9: error: byte 0xff is not UTF-8 text (save the file as UTF-8)"
    );
    let empty = findings("");
    assert_eq!(
        empty,
        [
            "rig.toml:1:1: error: plant: section [plant] is missing; it is required: the mechanism; the smallest is `plant = { inertia = \"1 kg m^2\", drive = \"torque\", interface = { sample_period = \"1 ms\" } }`"
        ]
    );
    assert!(
        findings("what is this").iter().all(|f| f.starts_with("rig.toml:1:")),
        "{:?}",
        findings("what is this")
    );
}

#[test]
fn a_command_needs_its_own_sections_only() {
    let plant_and_controller = &GOOD[..GOOD.find("[synth]").unwrap()];
    let document = Document::parse(plant_and_controller, "rig.toml");
    let purpose = |purpose| Project::resolve_for(&document, &Attachments::none(), purpose);
    for enough in [Purpose::Model, Purpose::Identify, Purpose::Replay, Purpose::Diagnose, Purpose::Reduce] {
        assert!(purpose(enough).is_ok(), "{enough:?}");
    }
    assert!(purpose(Purpose::Design).unwrap().project.verify.is_some(), "the usual procedure");
    let plant = Document::parse(&GOOD[..GOOD.find("[recording_controller]").unwrap()], "rig.toml");
    let refused = Project::resolve_for(&plant, &Attachments::none(), Purpose::Replay).unwrap_err();
    let missing: Vec<String> = refused.iter().map(ToString::to_string).collect();
    let expected = "rig.toml:1:1: error: recording_controller: section [recording_controller] is missing; `replay` needs it \
        (for recordings under this project's own design add recording_controller = { kind = \"project\" }, under an exported one \
        { kind = \"exported\", file = \"controller.json\" })";
    assert_eq!(missing, [expected]);
}

#[test]
fn an_excerpt_shows_the_line_with_a_mark() {
    let text = GOOD.replacen("backlash = 0.5e-3 ", "backlash = -0.001", 1);
    let error = &Project::parse(&text, "rig.toml").unwrap_err()[0];
    let expected = "rig.toml:79:12: error: plant.gearbox.backlash = -0.001: must be at least 0 rad\n   |\n\
                    79 | backlash = -0.001           # rad, total gap at the output\n   |            ^";
    assert_eq!(error.excerpt(&text), expected);
    let json = serde_json::to_value(error).unwrap();
    assert_eq!(json["path"], "plant.gearbox.backlash");
    assert_eq!(
        (&json["line"], &json["problem"], &json["severity"]),
        (&79.into(), &"out-of-range".into(), &"error".into())
    );
}

#[test]
fn an_amplifier_map_is_read_from_the_file_beside() {
    let text = GOOD.replacen("bus_voltage = 150.0", "map = \"amplifier-map.csv\"\nbus_voltage = 150.0", 1);
    let document = Document::parse(&text, "rig.toml");
    assert_eq!(document.attachments(), ["amplifier-map.csv"]);
    let resolve = |csv: &str| {
        let files = Attachments::none().with("amplifier-map.csv", csv.as_bytes().to_vec());
        Project::resolve(&document, &files)
    };
    let map = resolve("# points\ninput_v,current_a,table\n1.24,3.45,b\n0.12,0.27,a\n1.24,3.42,b\n")
        .unwrap()
        .project
        .plant
        .amplifier
        .map;
    let points: Vec<_> = map.iter().map(|p| (p.input_v, p.current_a)).collect();
    assert_eq!(points, [(0.12, 0.27), (1.24, 3.435)]);
    let told = |csv: &str| resolve(csv).unwrap_err()[0].to_string();
    let at = "rig.toml:93:7: error: plant.amplifier.map = \"amplifier-map.csv\": ";
    assert_eq!(
        told("v,i\n0.1,x\n"),
        format!("{at}\"amplifier-map.csv\" line 2 column 2: \"x\" is not a number")
    );
    assert_eq!(
        told("v,i\n0.1\n"),
        format!("{at}\"amplifier-map.csv\" line 2 column 2: \"\" is not a number")
    );
    let absent = Project::resolve(&document, &Attachments::none()).unwrap_err()[0].to_string();
    assert_eq!(
        absent,
        format!("{at}the file \"amplifier-map.csv\" was not found in the folder of the project file")
    );
}

#[test]
fn an_unknown_language_is_told_with_those_that_there_are() {
    let found = findings(&GOOD.replacen("[\"c99\", \"rust\"]", "[\"c99\", \"rost\"]", 1));
    let [finding] = &found[..] else { panic!("{found:?}") };
    assert!(
        finding
            .starts_with("rig.toml:309:13: error: export.languages = [\"c99\", \"rost\"]: may hold \"c99\""),
        "{finding}"
    );
    assert!(finding.ends_with("(did you mean \"rust\"?)"), "{finding}");
}
