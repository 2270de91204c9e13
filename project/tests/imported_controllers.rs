//! A feedback that was made elsewhere: every form in every kind of file gives its response, and what is wrong is said.

use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, Timebase, response_at};
use counterpoise_project::resolve::imported_controller::parse_controller;
use counterpoise_project::{Attachments, Document, Project};

/// The controller of all tests: 3 (z - 0.9)(z^2 - 1.6 z + 0.65) / ((z - 1)(z^2 - 0.4 z + 0.13)), sampled at 1 ms.
fn response(z: C64) -> C64 {
    let poly = |c: [f64; 3]| (z * c[0] + c[1]) * z + c[2];
    (z - 0.9) * poly([1.0, -1.6, 0.65]) * 3.0 / ((z - 1.0) * poly([1.0, -0.4, 0.13]))
}

const NUMERATOR: [f64; 4] = [3.0, -7.5, 6.27, -1.755];
const DENOMINATOR: [f64; 4] = [1.0, -1.4, 0.53, -0.13];

fn is_the_controller(system: &StateSpace) {
    assert_eq!(system.timebase, Timebase::Discrete { period_s: 1e-3 });
    for rate in [0.3, 7.0, 90.0, 800.0, 3000.0] {
        let (found, wanted) =
            (response_at(system, rate).unwrap()[(0, 0)], response(C64::from_polar(1.0, rate * 1e-3)));
        assert!((found - wanted).norm() < 1e-11 * wanted.norm(), "{rate}: {found} {wanted}");
    }
}

fn read(text: &str) -> Result<StateSpace, String> {
    parse_controller(text.as_bytes(), "c.json", "")
}

/// The companion form of the transfer function.
fn state_space_json() -> String {
    let [b0, b1, b2, b3] = NUMERATOR;
    let [_, a1, a2, a3] = DENOMINATOR;
    let c = [b1 - a1 * b0, b2 - a2 * b0, b3 - a3 * b0];
    format!(
        r#"{{"A": [[{}, {}, {}], [1, 0, 0], [0, 1, 0]], "B": [[1], [0], [0]], "C": [{c:?}], "D": [[{b0}]], "Ts": 0.001}}"#,
        -a1, -a2, -a3
    )
}

#[test]
fn each_form_of_json_gives_the_response() {
    is_the_controller(&read(&state_space_json()).unwrap());
    let function = format!(r#"{{"num": {NUMERATOR:?}, "den": {DENOMINATOR:?}, "dt": 1e-3}}"#);
    is_the_controller(&read(&function).unwrap());
    let roots = r#" {"controllers": [{"name": "K", "zeros": [[0.9, 0], [0.8, 0.1], [0.8, -0.1]], "poles": [[1, 0], [0.2, 0.3], [0.2, -0.3]], "gain": 3, "sample_time_s": 0.001}]}"#;
    is_the_controller(&read(roots).unwrap());
    let gain = read(r#"{"D": 2.5, "Ts": 0}"#).unwrap();
    assert_eq!((gain.order(), gain.D[(0, 0)], gain.timebase), (0, 2.5, Timebase::Continuous));
}

#[test]
fn one_of_several_is_chosen_by_its_name() {
    let outermost = r#"{"D": 1.5, "Ts": 0, "K": {"D": 2, "Ts": 0.001}}"#;
    assert_eq!(parse_controller(outermost.as_bytes(), "c.json", ".").unwrap().D[(0, 0)], 1.5);
    let both =
        format!(r#"{{"old": {{"k": 2, "p": [-1], "Ts": 0}}, "design": {{"new": {}}}}}"#, state_space_json());
    let said = read(&both).unwrap_err();
    assert!(said.contains("\"design.new\", \"old\""), "{said}");
    is_the_controller(&parse_controller(both.as_bytes(), "c.json", "design.new").unwrap());
    let said = parse_controller(both.as_bytes(), "c.json", "newer").unwrap_err();
    assert!(said.contains("no controller \"newer\"") && said.contains("design.new"), "{said}");
}

/// An element of a MATLAB file of version 5: type, length, bytes, filled to 8.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A real matrix of a MATLAB file, by columns.
fn matrix(name: &str, shape: [i32; 2], values: &[f64]) -> Vec<u8> {
    let bytes = |all: &[i32]| all.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let numbers: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let parts = [
        element(6, &bytes(&[6, 0])),
        element(5, &bytes(&shape)),
        element(1, name.as_bytes()),
        element(9, &numbers),
    ];
    element(14, &parts.concat())
}

fn matlab(arrays: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(arrays.concat());
    bytes
}

#[test]
fn matlab_files_hold_state_space_and_transfer_functions() {
    let function = matlab(&[
        matrix("num", [1, 4], &NUMERATOR),
        matrix("den", [1, 4], &DENOMINATOR),
        matrix("Ts", [1, 1], &[1e-3]),
    ]);
    is_the_controller(&parse_controller(&function, "c.mat", "").unwrap());
    let [b0, b1, b2, b3] = NUMERATOR;
    let [_, a1, a2, a3] = DENOMINATOR;
    let space = matlab(&[
        matrix("A", [3, 3], &[-a1, 1.0, 0.0, -a2, 0.0, 1.0, -a3, 0.0, 0.0]),
        matrix("B", [3, 1], &[1.0, 0.0, 0.0]),
        matrix("C", [1, 3], &[b1 - a1 * b0, b2 - a2 * b0, b3 - a3 * b0]),
        matrix("D", [1, 1], &[b0]),
        matrix("Ts", [1, 1], &[1e-3]),
    ]);
    is_the_controller(&parse_controller(&space, "c.mat", "").unwrap());
    assert!(parse_controller(&space[..space.len() - 9], "c.mat", "").is_err());
    // a variable that holds complex numbers is not left out silently
    let complex = matlab(&[
        element(
            14,
            &[element(6, &[6, 8, 0, 0, 0, 0, 0, 0]), element(5, &[1, 0, 0, 0, 1, 0, 0, 0]), element(1, b"p")]
                .concat(),
        ),
        matrix("k", [1, 1], &[2.0]),
        matrix("Ts", [1, 1], &[1e-3]),
    ]);
    let said = parse_controller(&complex, "c.mat", "").unwrap_err();
    assert!(said.contains("p: it holds complex numbers"), "{said}");
}

#[test]
fn what_is_wrong_is_said() {
    let cases = [
        ("{", "not valid JSON"),
        (r#"{"a": 1}"#, "holds no controller"),
        ("1,2\n3,4\n", "JSON, MATLAB (.mat)"),
        (r#"{"num": [1], "den": [1, 2]}"#, "sample time is missing"),
        (r#"{"num": [1], "den": [1, 2], "Ts": -1}"#, "Ts = -1"),
        (r#"{"num": [1, 0, 0], "den": [1, 2], "Ts": 0}"#, "higher degree"),
        (r#"{"num": [1], "den": [0, 0], "Ts": 0}"#, "denominator is zero"),
        (r#"{"num": [1], "den": [[1, 2], [3, 4]], "Ts": 0}"#, "den must be a vector; it is 2 x 2"),
        (r#"{"z": [1, 2], "p": [3], "k": 1, "Ts": 0}"#, "more zeros than poles"),
        (r#"{"p": [[1, 2]], "k": 1, "Ts": 0}"#, "conjugate"),
        (r#"{"k": [1, 2], "p": [3], "Ts": 0}"#, "k must be one number, not 2"),
        (
            r#"{"A": [[1, 2]], "B": [1], "C": [1], "D": 0, "Ts": 0}"#,
            "A must be square; it has 1 rows and 2 columns",
        ),
        (r#"{"A": [[1]], "B": [[1, 1]], "C": [1], "D": [[0, 0]], "Ts": 0}"#, "B has 2 numbers"),
        (r#"{"D": 0, "Ts": 0}"#, "the controller is zero"),
        (
            r#"{"z": [[-1, 2], [-1, -2], -3], "p": [-1, -2, -3], "k": 1, "Ts": 0}"#,
            "z: it is not a number, a list",
        ),
        (r#"{"z": ["-1+2j"], "p": [-1], "k": 1, "Ts": 0}"#, "z: it is not a number, a list"),
        (r#"{"k": 2, "p": [-1], "Ts": null}"#, "Ts: it is not a number"),
        (r#"{"num": [1], "den": [1, 2], "k": 3, "Ts": 0}"#, "it states several of"),
        (r#"{"k": 1, "Ts": 0.001, "K": {"D": 2, "Ts": 0.001}}"#, "one of \".\", \"K\""),
    ];
    for (text, expected) in cases {
        let said = read(text).unwrap_err();
        assert!(said.contains(expected), "{text}: {said}");
    }
    let many = vec![0.5; 250];
    let said = read(&format!(r#"{{"p": {many:?}, "k": 1, "Ts": 0}}"#)).unwrap_err();
    assert!(said.contains("order 250"), "{said}");
}

fn resolve_section(section: &str, file: Option<&str>) -> Result<Project, String> {
    let text = format!(
        "format = 2\n[plant]\nname = \"axis\"\ninertia = 0.5\nmotor = {{ torque_constant = 0.4, resistance = 1.0 }}\n\
         interface = {{ sample_period = 1e-3 }}\n{section}"
    );
    let with =
        |all: Attachments| file.map_or(all.clone(), |file| all.with("c.json", file.as_bytes().to_vec()));
    let resolved = Project::resolve(&Document::parse(&text, "axis.toml"), &with(Attachments::none()));
    resolved
        .map(|parsed| parsed.project)
        .map_err(|findings| findings.iter().map(|f| format!("{f}\n")).collect())
}

#[test]
fn a_project_names_the_file_and_says_what_does_not_go_with_it() {
    let controller = state_space_json();
    let section = "[synth.controller]\nfile = \"c.json\"\n";
    let read = resolve_section(section, Some(&controller)).unwrap();
    is_the_controller(read.synth.unwrap().options.imported.unwrap().system.as_ref().unwrap());
    let other_period = controller.replace("0.001", "0.002");
    let block = format!("{section}[[synth.block]]\nkind = \"gain\"\ngain = 1.0\n");
    let cases = [
        (section.to_owned(), None, "was not found"),
        (section.to_owned(), Some(other_period.as_str()), "this one has 0.002 s"),
        (section.to_owned(), Some("{}"), "holds no controller"),
        (block, Some(controller.as_str()), "both make the feedback"),
        (
            format!("[synth]\nmethod = \"lqg-ltr\"\n{section}"),
            Some(controller.as_str()),
            "where [synth.controller] makes the feedback",
        ),
        (format!("[synth]\nprewarp = 30.0\n{section}"), Some(controller.as_str()), "it runs as it is"),
        (format!("[synth.tune]\n{section}"), Some(controller.as_str()), "nothing of it is open"),
    ];
    for (section, file, expected) in cases {
        let said = resolve_section(&section, file).unwrap_err();
        assert!(said.contains(expected), "{section}: {said}");
    }
}
