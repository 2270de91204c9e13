//! The checks that no single key allows: names that must differ or exist, sections that must adjoin, descriptions that must agree.

use std::collections::BTreeSet;

use counterpoise_lti::Timebase;
use counterpoise_models::{Parameters, Sensor, converter_step_v};
use counterpoise_recordings::{Channel, ChannelUnits, Mapping, Unit};

use super::controller::RecordingController;
use super::design::ReductionMethod;
use super::findings::{Findings, report_duplicates};
use super::fixed_structure::TunedWeights;
use super::model::StructureChoice;
use super::sensor::IDEAL_SCALE;
use super::synthesis::LoopKind;
use super::{Project, base_motion_checks, beam_checks, cylinder, effort_checks, loop_sensor};
use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity, did_you_mean};
use crate::file::Document;
use crate::file::source::Remark;
use crate::file::visit::NamedChoice;
use crate::tolerance::{MOST_SENSOR_DELAY_SAMPLES, ROUNDED_PERIOD, SAME_SAMPLE_PERIOD};

/// Keys and sections that describe the structure.
const DESCRIPTIONS: [&str; 5] = ["plant.inertia", "plant.mass", "plant.lumped", "plant.beam", "plant.import"];

/// Returns all findings about values that do not fit each other.
pub(crate) fn check_project(document: &Document, project: &Project) -> Vec<Diagnostic> {
    let mut findings = Findings::new(document);
    let plant = &project.plant;
    let described = DESCRIPTIONS.iter().any(|path| document.has(path));
    if document.has("plant") && !described && !is_without_structure(project) {
        let remark = Remark::new(
            DiagnosticKind::Missing,
            "plant",
            "the structure is missing: the smallest is `inertia` (`mass` if the axis is linear); or give [plant.lumped], [plant.beam] or [plant.import]",
        );
        findings.add(Severity::Error, remark);
    }
    if let Some(beam) = &plant.beam {
        beam_checks::sections(&mut findings, beam);
        beam_checks::masses(&mut findings, beam);
    }
    let imported = project.import.iter().flat_map(|import| &import.masses);
    report_duplicates(&mut findings, "plant.import.mass", imported.map(|mass| mass.name.as_str()));
    configurations(&mut findings, project);
    structure(&mut findings, project);
    map(&mut findings, plant);
    coupling(&mut findings, plant);
    compliance(&mut findings, plant);
    rotor(&mut findings, plant);
    feedforwards(&mut findings, project);
    cascade(&mut findings, project);
    effort_checks::check_effort_loop(&mut findings, project);
    cylinder::fitting(&mut findings, project);
    delays(&mut findings, plant);
    own_periods(&mut findings, plant);
    coarse_readings(&mut findings, plant);
    base_motion_checks::check_elevated(&mut findings, project);
    base_motion_checks::check_slide(&mut findings, project);
    base_motion_checks::check_projection(&mut findings, project);
    recorded_period(&mut findings, project);
    imported_period(&mut findings, project);
    without_effect(&mut findings, plant);
    beam_checks::agreement(&mut findings, plant);
    units(&mut findings, &project.recording, project.channel_units());
    configuration(&mut findings, project);
    tolerances(&mut findings, project);
    nothing_to_tune(&mut findings, project);
    findings.into_list()
}

/// Returns whether the structure that the model takes is missing, and with it the masses that configurations name.
fn is_without_structure(project: &Project) -> bool {
    match project.model.structure {
        StructureChoice::Lumped => false,
        StructureChoice::Beam => project.plant.beam.is_none(),
        StructureChoice::Import => project.import.is_none(),
    }
}

/// A rotor behind a transmission that gives moves by itself, and needs an inertia.
fn rotor(findings: &mut Findings<'_>, plant: &Parameters) {
    if !plant.gearbox.is_rigid() && plant.motor.inertia_kg_m2 == 0.0 {
        let allowed =
            "must be stated and above 0 where the transmission has a stiffness: the rotor moves by itself";
        let hint = "if it is not known, leave the stiffness out: rotor and load are then one body";
        let remark = Remark::new(DiagnosticKind::Missing, "plant.motor.inertia", allowed);
        findings.add(Severity::Error, remark.hint(Some(hint.to_owned())));
    }
}

/// The structure that the model takes must be there.
fn structure(findings: &mut Findings<'_>, project: &Project) {
    let (section, there) = match project.model.structure {
        StructureChoice::Lumped => ("plant", true),
        StructureChoice::Beam => ("plant.beam", project.plant.beam.is_some()),
        StructureChoice::Import => ("plant.import", project.import.is_some()),
    };
    if !there {
        let allowed = format!("needs the section [{section}]");
        let found = format!("\"{}\"", project.model.structure.name());
        findings.add(
            Severity::Error,
            Remark::new(DiagnosticKind::Missing, "model.structure", allowed).with_value(found),
        );
    }
}

fn configurations(findings: &mut Findings<'_>, project: &Project) {
    const LIST: &str = "plant.configuration";
    let plant = &project.plant;
    if is_without_structure(project) {
        return;
    }
    report_duplicates(findings, LIST, plant.configurations.iter().map(|c| c.name.as_str()));
    let of_beam = plant.beam.iter().flat_map(|b| &b.masses);
    let of_import = project.import.iter().flat_map(|i| &i.masses);
    let known: Vec<&str> = of_beam.chain(of_import).map(|m| m.name.as_str()).collect();
    let names: BTreeSet<&str> = known.iter().copied().collect();
    // A mass without name is reported already, and may be the one that is meant.
    let nameless = names.contains("");
    let mut unknown: BTreeSet<&str> = BTreeSet::new();
    for (index, configuration) in plant.configurations.iter().enumerate() {
        for (place, name) in configuration.masses.iter().enumerate() {
            let path = format!("{LIST}[{index}].masses[{place}]");
            let found = format!("\"{name}\"");
            if !names.contains(name.as_str()) {
                let first =
                    if known.is_empty() { unknown.is_empty() } else { !unknown.contains(name.as_str()) };
                unknown.insert(name);
                if nameless || !first {
                    continue;
                }
                let allowed = match &known[..] {
                    [] => {
                        "there is no such mass: add [[plant.beam.mass]] or [[plant.import.mass]]".to_owned()
                    }
                    known => format!("the beam has no such mass; it has {}", quote_names(known)),
                };
                let remark = Remark::new(DiagnosticKind::UnknownName, &path, allowed).with_value(found);
                findings.add(Severity::Error, remark.hint(did_you_mean(name, known.iter().copied())));
            } else if configuration.masses[..place].contains(name) {
                findings.add(
                    Severity::Error,
                    Remark::new(DiagnosticKind::Duplicate, &path, "a mass can be fitted only once")
                        .with_value(found),
                );
            }
        }
    }
}

/// The configuration that the model names must be one of the plant's.
fn configuration(findings: &mut Findings<'_>, project: &Project) {
    let Some(name) = &project.model.configuration else { return };
    let known: Vec<&str> = project.plant.configurations.iter().map(|c| c.name.as_str()).collect();
    if !known.contains(&name.as_str()) {
        let allowed = format!("there is no such configuration; known are {}", quote_names(&known));
        let remark = Remark::new(DiagnosticKind::UnknownName, "model.configuration", allowed)
            .with_value(format!("\"{name}\""));
        findings.add(Severity::Error, remark.hint(did_you_mean(name, known.iter().copied())));
    }
}

/// Warns of tolerances that no campaign varies.
fn tolerances(findings: &mut Findings<'_>, project: &Project) {
    for tolerance in &project.tolerances {
        let mut varied = super::sweep::keys_with_tolerances();
        if tolerance.value == 0.0 || !varied.any(|key| key == tolerance.key) {
            let keys: Vec<&str> = super::sweep::keys_with_tolerances().collect();
            let why =
                if tolerance.value == 0.0 { "the value is 0" } else { "campaigns do not vary this key" };
            let allowed = format!("the tolerance has no effect: {why}; they vary {}", keys.join(", "));
            findings.add(Severity::Warning, Remark::new(DiagnosticKind::Conflict, &tolerance.key, allowed));
        }
    }
}

fn quote_names(names: &[&str]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ")
    }
}

fn map(findings: &mut Findings<'_>, plant: &Parameters) {
    let limit = plant.amplifier.input_limit_v;
    if let Some(point) =
        plant.amplifier.map.iter().find(|p| p.input_v > limit || p.input_v <= 0.0 || p.current_a <= 0.0)
    {
        let allowed = format!(
            "points must have a voltage above 0 and up to the input limit {limit} V, and a current above 0"
        );
        let remark = Remark::new(DiagnosticKind::Conflict, "plant.amplifier.map", allowed);
        findings.add(Severity::Error, remark.with_value(format!("[{}, {}]", point.input_v, point.current_a)));
    }
}

fn coupling(findings: &mut Findings<'_>, plant: &Parameters) {
    let value = plant.motor.platform_coupling;
    if value.abs() < 1.0 && value != 0.0 {
        let remark =
            Remark::new(DiagnosticKind::OutOfRange, "plant.motor.platform_coupling", "must be -1, 0 or 1");
        findings.add(Severity::Error, remark.with_value(value.to_string()));
    }
}

/// A gap, losses and errors of the mesh act through a transmission that gives.
fn compliance(findings: &mut Findings<'_>, plant: &Parameters) {
    let gearbox = &plant.gearbox;
    let of_mesh = [
        ("backlash", gearbox.backlash_rad, 0.0),
        ("mesh_efficiency", gearbox.mesh_efficiency, 1.0),
        ("hysteresis", gearbox.hysteresis_nm, 0.0),
        ("kinematic_error", gearbox.kinematic_error.amplitude, 0.0),
    ];
    for (key, value, ideal) in of_mesh.into_iter().filter(|_| gearbox.is_rigid()) {
        let stated = ["gearbox", "ball_screw", "harmonic_drive"].map(|kind| format!("plant.{kind}.{key}"));
        let Some(path) = stated.iter().find(|path| findings.states(path) && value != ideal) else {
            continue;
        };
        let section = path.trim_end_matches(key);
        let allowed = format!(
            "acts through a transmission that gives: state {section}stiffness as well; if none is known, leave {key} out, and the transmission is rigid"
        );
        let written = findings.written_at(path).unwrap_or_else(|| value.to_string());
        let remark = Remark::new(DiagnosticKind::Conflict, path, allowed).with_value(written);
        findings.add(Severity::Error, remark);
        // The others follow from the same stiffness.
        return;
    }
}

/// The inner loop of a cascade is designed on the plant as it is.
fn cascade(findings: &mut Findings<'_>, project: &Project) {
    let is_cascade = project.synth.as_ref().is_some_and(|synth| synth.loop_kind == LoopKind::Cascade);
    if is_cascade && project.reduce.method != ReductionMethod::None {
        let allowed = "must be \"none\" where synth.loop is \"cascade\": its rate loop is designed on the plant as it is";
        let found = format!("\"{}\"", project.reduce.method.name());
        findings.add(
            Severity::Error,
            Remark::new(DiagnosticKind::Conflict, "reduce.method", allowed).with_value(found),
        );
    }
}

/// A feedforward needs the sensor of its disturbance; all that lack theirs are one finding.
fn feedforwards(findings: &mut Findings<'_>, project: &Project) {
    let Some(synth) = &project.synth else { return };
    let (asked, sensors) = (&synth.specification, &project.plant.sensors);
    let parts = [
        (asked.heave.is_some(), "heave", &sensors.platform_accelerometer, "platform_accelerometer"),
        (asked.pitch.is_some(), "pitch", &sensors.platform_gyro, "platform_gyro"),
    ];
    let blind: Vec<_> =
        parts.into_iter().filter(|(is_asked, _, sensor, _)| *is_asked && !sensor.is_fitted()).collect();
    let Some((_, first, ..)) = blind.first() else { return };
    let sections = |name: fn(&(bool, &str, &Sensor, &str)) -> String| {
        blind.iter().map(name).collect::<Vec<_>>().join(" and ")
    };
    let allowed = format!(
        "the feedforward {} has no sensor: add {} (a section without keys is an ideal sensor), or leave the feedforward out",
        sections(|(_, part, ..)| format!("[synth.{part}]")),
        sections(|(.., sensor)| format!("[plant.sensors.{sensor}]")),
    );
    findings.add(Severity::Error, Remark::new(DiagnosticKind::Missing, &format!("synth.{first}"), allowed));
}

/// Returns the sensors by their names in the file.
fn named_sensors(plant: &Parameters) -> [(&'static str, Option<&Sensor>); 6] {
    let sensors = &plant.sensors;
    [
        (loop_sensor::section_of(sensors), Some(&sensors.hub_gyro)),
        ("platform_gyro", Some(&sensors.platform_gyro)),
        ("platform_accelerometer", Some(&sensors.platform_accelerometer)),
        ("motor_tachometer", sensors.motor_tachometer.as_ref()),
        ("hub_resolver", sensors.hub_resolver.as_ref()),
        ("surge_accelerometer", sensors.surge_accelerometer.as_ref()),
    ]
}

/// A sensor that is slower than the controller is read every whole number of samples.
fn own_periods(findings: &mut Findings<'_>, plant: &Parameters) {
    let period = plant.interface.sample_period_s;
    for (name, sensor) in named_sensors(plant) {
        let own_s = sensor.map_or(0.0, |sensor| sensor.own_period_s);
        let samples = own_s / period;
        let is_whole = (samples - samples.round()).abs() < ROUNDED_PERIOD * samples.max(1.0);
        if own_s == 0.0
            || period.is_nan()
            || period <= 0.0
            || is_whole && (0.5..=MOST_SENSOR_DELAY_SAMPLES).contains(&samples)
        {
            continue;
        }
        let allowed = format!(
            "must be a whole multiple of plant.interface.sample_period, {period} s, up to {MOST_SENSOR_DELAY_SAMPLES} of it, or 0 for a reading each sample"
        );
        let path = format!("plant.sensors.{name}.sample_period");
        let remark = Remark::new(DiagnosticKind::OutOfRange, &path, allowed);
        findings.add(Severity::Error, remark.with_value(own_s.to_string()));
    }
}

/// A sensor's delay is at most so many samples.
fn delays(findings: &mut Findings<'_>, plant: &Parameters) {
    let period = plant.interface.sample_period_s;
    for (name, sensor) in named_sensors(plant) {
        let delay_s = sensor.map_or(0.0, |sensor| sensor.delay_s);
        if period > 0.0 && delay_s > MOST_SENSOR_DELAY_SAMPLES * period {
            let most = MOST_SENSOR_DELAY_SAMPLES * period;
            let allowed = format!("must be at most {MOST_SENSOR_DELAY_SAMPLES} sample periods, {most} s");
            let remark =
                Remark::new(DiagnosticKind::OutOfRange, &format!("plant.sensors.{name}.delay"), allowed);
            findings.add(Severity::Error, remark.with_value(delay_s.to_string()));
        }
    }
}

/// Converters round the readings of a sensor whose scale is not stated far more coarsely than those of a real one.
fn coarse_readings(findings: &mut Findings<'_>, plant: &Parameters) {
    let bits = plant.interface.input_bits;
    if !findings.states("plant.interface.input_bits") {
        return;
    }
    for (name, sensor) in named_sensors(plant) {
        let Some(sensor) = sensor.filter(|sensor| sensor.is_fitted() && sensor.resolution == 0.0) else {
            continue;
        };
        if bits > 0 && sensor.scale_v_unit == IDEAL_SCALE {
            let step = converter_step_v(bits) / IDEAL_SCALE;
            let allowed = format!(
                "is not stated, and {bits} bits over +/- 10 V at 0.001 V per unit read in steps of {step:.2}: state the sensor's voltage per unit, or leave out \
                 plant.interface.input_bits"
            );
            let remark =
                Remark::new(DiagnosticKind::Missing, &format!("plant.sensors.{name}.scale"), allowed);
            findings.add(Severity::Warning, remark);
        }
    }
}

/// An exported controller that was in the loop runs at the sample period of the interface.
fn recorded_period(findings: &mut Findings<'_>, project: &Project) {
    let Some(RecordingController::Exported(source)) = &project.recording_controller else { return };
    let Some(content) = &source.content else { return };
    let file = NamedFile { path: "recording_controller.file", name: &source.file };
    runs_at_the_period(findings, project, &file, content.controller.sample_period_s(), "a controller with");
}

/// A controller in sampled time that was made elsewhere runs at the sample period of the interface.
fn imported_period(findings: &mut Findings<'_>, project: &Project) {
    let Some(imported) = project.synth.as_ref().and_then(|synth| synth.options.imported.as_ref()) else {
        return;
    };
    let Some(Timebase::Discrete { period_s }) = imported.system.as_ref().map(|system| system.timebase) else {
        return;
    };
    let file = NamedFile { path: "synth.controller.file", name: &imported.file };
    runs_at_the_period(
        findings,
        project,
        &file,
        period_s,
        "a controller in continuous time (Ts = 0), or one with",
    );
}

/// A file that a key names.
struct NamedFile<'a> {
    path: &'static str,
    name: &'a str,
}

/// Reports a controller in a file whose sample period is not that of the interface; `wanted` says what the file must hold.
fn runs_at_the_period(
    findings: &mut Findings<'_>,
    project: &Project,
    file: &NamedFile<'_>,
    own_s: f64,
    wanted: &str,
) {
    let period = project.plant.interface.sample_period_s;
    if (own_s - period).abs() > SAME_SAMPLE_PERIOD * period {
        let allowed = format!(
            "must be {wanted} the sample period of plant.interface, {period} s; this one has {own_s} s"
        );
        let remark = Remark::new(DiagnosticKind::OutOfRange, file.path, allowed);
        findings.add(Severity::Error, remark.with_value(format!("\"{}\"", file.name)));
    }
}

/// Warns of a section that asks for a tuning where nothing can be tuned: two commands take their objective and their limits from it all the same.
fn nothing_to_tune(findings: &mut Findings<'_>, project: &Project) {
    let Some(options) = project.synth.as_ref().map(|synth| &synth.options) else { return };
    let Some(tuning) = &options.tuning else { return };
    if tuning.weights == TunedWeights::Stated
        && options.structure.blocks.is_empty()
        && options.imported.is_none()
    {
        let allowed = "tunes nothing, because there is no [[synth.block]] and no `weights = \"tune\"`: `compare` and `synth --search` alone take its objective and its limits";
        findings.add(Severity::Warning, Remark::new(DiagnosticKind::Conflict, "synth.tune", allowed));
    }
}

/// Warns of what a sensor is given and the simulator leaves out: the sensors of the drive have no dynamics, and heave moves
/// the gyroscopes' readings alone.
fn without_effect(findings: &mut Findings<'_>, plant: &Parameters) {
    let sensors = &plant.sensors;
    let drive = [("motor_tachometer", &sensors.motor_tachometer), ("hub_resolver", &sensors.hub_resolver)];
    let given = drive.iter().filter_map(|(name, sensor)| sensor.as_ref().map(|sensor| (*name, sensor)));
    let mut warn = |path: String, value: f64, why: &str| {
        let allowed = format!("has no effect: {why}");
        let remark = Remark::new(DiagnosticKind::Conflict, &path, allowed).with_value(value.to_string());
        findings.add(Severity::Warning, remark);
    };
    for (name, sensor) in given.clone().filter(|(_, sensor)| sensor.natural_frequency_rad_s.is_finite()) {
        let why = "this sensor is simulated without dynamics (give its lag as `delay`)";
        warn(format!("plant.sensors.{name}.natural_frequency"), sensor.natural_frequency_rad_s, why);
    }
    let accelerometer = ("platform_accelerometer", &sensors.platform_accelerometer);
    for (name, sensor) in given
        .chain([accelerometer])
        .chain(sensors.surge_accelerometer.iter().map(|sensor| ("surge_accelerometer", sensor)))
        .filter(|(_, sensor)| sensor.g_sensitivity != 0.0)
    {
        let why = "only the gyroscopes feel heave besides what they measure";
        warn(format!("plant.sensors.{name}.g_sensitivity"), sensor.g_sensitivity, why);
    }
}

/// Units in the mapping of channels must be known and of the channel's quantity.
fn units(findings: &mut Findings<'_>, mapping: &Mapping, of_machine: ChannelUnits) {
    let time = mapping.time.iter().map(|s| ("time", "s", s));
    let of = |c: &Channel| [of_machine.of(*c), c.unit()];
    let channels =
        mapping.channels.iter().map(|(c, s)| (c.name(), of(c).map(|unit| s.unit_of_column(unit)), s));
    let time = time.map(|(name, unit, source)| (name, [unit; 2], source));
    for (name, [wanted, usual], source) in time.chain(channels) {
        let Some(written) = &source.unit else { continue };
        let likes = [wanted, usual, "1"].map(|unit| Unit::parse(unit).unwrap_or(Unit::ONE));
        let fits = Unit::parse(written).is_some_and(|u| likes.iter().any(|like| u.is_like(like)));
        if !fits {
            let path = format!("recording.channels.{name}.unit");
            let allowed = format!(
                "must be a unit like {wanted}, unless `slope_over` or `slope_lag` says that its slope is meant"
            );
            let remark = Remark::new(DiagnosticKind::OutOfRange, &path, allowed);
            findings.add(Severity::Error, remark.with_value(format!("\"{written}\"")));
        }
    }
}
