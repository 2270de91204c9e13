//! Keys of the project file that decide what runs on the target, followed to the exported C: the realisation (it is the same
//! controller, and its coefficients are as sensitive as was predicted), and the correction of the sensors' errors.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, non_snake_case)]

use std::process::Command;

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_export::forms::{PathForm, convert_to_form};
use counterpoise_export::{CodeOptions, ExportSource, Ranges, c99, single_precision};
use counterpoise_pipeline::export::path_forms;
use counterpoise_pipeline::{World, build_plant_model, reduce_plant, synthesise, verify};
use counterpoise_project::Project;
use counterpoise_verify::{PerformanceFigure, VerifiedController};

use crate::every_example::support;
use support::{RandomGenerator, Request, STRICT, Target, folder, is_there, provenance, run, server, write};

struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("{name} is not needed"))
    }
}

const KEY: &str = "discretisation = \"tustin\"";

/// The example of the sixth chapter with lines in the place of lines.
fn verify_example(changes: &[(&str, &str)]) -> VerifiedController {
    let file = format!("{}/../examples/appendix-5/chapter-6.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).unwrap();
    let text = changes.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    let project =
        Project::parse(&text, "project.toml").map_err(|errors| errors[0].to_string()).unwrap().project;
    let modelled = build_plant_model(&project).unwrap();
    let reduced = reduce_plant(&project, &modelled).unwrap();
    let made = synthesise(&project, &modelled, &reduced).unwrap();
    verify(&project, &modelled, &made, &EmptyWorld).unwrap()
}

fn gain_margin_db(verified: &VerifiedController) -> f64 {
    let figure =
        PerformanceFigure::all().into_iter().find(|figure| figure.key() == "gain_margin_db").unwrap();
    verified.verification().value(figure).unwrap()
}

/// Small readings, so that the limiter stays out.
fn readings() -> Vec<[f64; counterpoise_controller::READINGS]> {
    let mut random = RandomGenerator(3);
    (0..1500).map(|_| random.readings().map(|value| 0.02 * value)).collect()
}

/// Returns what the C in single precision answers.
fn answers<'a>(controller: impl Into<ExportSource<'a>>, name: &str) -> Vec<f64> {
    let folder = folder(&format!("realisation_{}", name.replace(' ', "_")));
    write(&folder, &c99(controller, &provenance(), &CodeOptions::single("axis")).unwrap());
    std::fs::write(folder.join("server.c"), server(&["axis".into()])).unwrap();
    let sources = ["server.c", "axis.c", "-o", "server"];
    assert_eq!(run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources)), "");
    let asked: Vec<(usize, Request)> = readings().into_iter().map(|r| (0, Request::Step(r))).collect();
    Target::start(&folder.join("server")).ask_all(&asked)
}

#[test]
fn the_form_asked_for_is_what_is_exported_and_as_sensitive_as_predicted() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let mut margins = Vec::new();
    for (name, expected) in [
        ("modal", Some(RealisationForm::Modal)),
        ("balanced", Some(RealisationForm::Balanced)),
        ("least-sensitive", None),
    ] {
        let verified = verify_example(&[(KEY, &format!("{KEY}\nrealisation = \"{name}\""))]);
        let controller = verified.controller();
        for each in path_forms(&verified).unwrap() {
            let chosen = each.candidates.iter().find(|one| one.form == each.chosen).unwrap();
            let least = each.candidates.iter().map(|one| one.predicted).fold(f64::INFINITY, f64::min);
            println!(
                "{name}, {}: {:?}, {} coefficients, response off by {:.1e} predicted, {:.1e} measured",
                each.path, each.chosen, chosen.coefficients, chosen.predicted, chosen.measured
            );
            match expected {
                Some(form) => assert_eq!(each.chosen, form, "{name}"),
                None => assert!(chosen.predicted <= 10.0 * least, "{name}"),
            }
            assert!(chosen.measured < 6.0 * chosen.predicted, "{name}");
        }
        let (given, mut reference, mut single) =
            (readings(), controller.runner(), controller.runner_in::<f32>());
        let known = Ranges::from_readings(controller, std::slice::from_ref(&given), 4.0);
        let predicted = single_precision(controller, &known, given.len());
        let mut largest = 0.0_f64;
        for (readings, answer) in given.iter().zip(answers(&verified, name)) {
            assert_eq!(single.step_array(readings).to_bits(), answer.to_bits(), "{name}");
            largest = largest.max((reference.step_array(readings) - answer).abs());
        }
        println!("{name}: C in single is off by {largest:.1e} V, {:.1e} V predicted", predicted.likely_v);
        assert!(largest > 0.0 && largest <= predicted.likely_v);
        margins.push(gain_margin_db(&verified));
    }
    assert!(margins.iter().all(|margin| (margin - margins[0]).abs() < 1e-6), "{margins:?}");
}

/// The C of the same controller with its paths in each form: sections and balanced states are as near as single precision is, the
/// coefficients of a polynomial are not the controller any more. In double all are the same.
#[test]
fn the_c_tells_the_forms_apart() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let verified = verify_example(&[]);
    let controller = verified.controller();
    let mut off = Vec::new();
    for form in PathForm::ALL {
        let other = convert_to_form(controller, form).unwrap();
        let (mut reference, mut double) = (controller.runner(), other.runner());
        let (mut single, mut worst) = (other.runner_in::<f32>(), [0.0_f64; 2]);
        for (readings, answer) in
            readings().iter().zip(answers(ExportSource::Unverified(&other), form.name()))
        {
            assert_eq!(single.step_array(readings).to_bits(), answer.to_bits(), "{form:?}");
            let right = reference.step_array(readings);
            let found = [double.step_array(readings), answer].map(|value| (value - right).abs());
            worst = [worst[0].max(found[0]), worst[1].max(found[1])];
        }
        println!("{}: C in double off by {:.1e} V, in single by {:.1e} V", form.name(), worst[0], worst[1]);
        assert!(worst[0] < 1e-4, "{form:?}: {worst:?}");
        off.push(worst[1]);
    }
    assert!(off[..3].iter().all(|off| *off < 1e-3) && off[3] > 100.0 * off[1], "{off:?}");
}

/// A gyroscope that reads 5 % too much and has a bias: left alone it moves the gain margin; corrected, the loop is the one of
/// an ideal gyroscope, and the C carries the correction.
#[test]
fn known_sensor_errors_are_taken_out_of_the_readings() {
    let sensor = "[plant.sensors.hub_gyro]\n";
    let wrong = (sensor, &*format!("{sensor}gain = 1.05\nbias = 0.002\n"));
    let undo = format!("{KEY}\nsensor_errors = \"undo\"");
    let (ideal, left, undone) =
        (verify_example(&[]), verify_example(&[wrong]), verify_example(&[wrong, (KEY, &undo)]));
    let [margin, moved, back] = [&ideal, &left, &undone].map(gain_margin_db);
    println!("gain margin {margin:.4} dB with an ideal gyroscope, {moved:.4} left, {back:.4} corrected");
    assert!((back - margin).abs() < 1e-6 && (moved - margin).abs() > 0.02);
    let corrections = &undone.controller().parts().corrections;
    assert_eq!(corrections.len(), 1);
    assert!((corrections[0].gain - 1.0 / 1.05).abs() < 1e-15);
    assert!(
        (corrections[0].offset + 0.002 / 1.05).abs() < 1e-15
            && left.controller().parts().corrections.is_empty()
    );
    let code = c99(&undone, &provenance(), &CodeOptions::double("axis")).unwrap()[1].text.clone();
    assert!(code.contains("corrected_hub_rate_rad_s = -0.0019047619047619048"), "{code}");
}
