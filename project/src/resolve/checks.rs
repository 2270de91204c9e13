//! What no single key can say: names that must differ or exist, sections that must adjoin, descriptions that must agree.

use counterpoise_models::{Beam, Parameters, SectionShape};
use counterpoise_recordings::{Mapping, Unit};

use super::Project;
use super::import::ImportedStructure;
use super::model::StructureChoice;
use crate::diagnostic::{Diagnostic, Problem, Severity, did_you_mean};
use crate::file::Document;
use crate::file::source::Remark;
use crate::file::visit::Choice;

/// Two ends of sections closer than this fraction of the beam's length adjoin.
const ADJOINING: f64 = 1e-9;
/// Lumped and distributed description may differ by this fraction.
const AGREEMENT: f64 = 0.02;
/// A mass lies on the beam if it is within this fraction of the beam's length beyond its ends.
const OVERHANG: f64 = 0.1;

/// Findings of one check.
struct Findings<'a> {
    document: &'a Document,
    list: Vec<Diagnostic>,
}

impl Findings<'_> {
    fn add(&mut self, severity: Severity, remark: Remark) {
        self.list.push(self.document.finding(severity, remark));
    }
}

/// All findings about values that do not fit each other.
pub(crate) fn all(document: &Document, project: &Project) -> Vec<Diagnostic> {
    let mut findings = Findings { document, list: Vec::new() };
    let plant = &project.plant;
    let described = ["plant.beam", "plant.lumped", "plant.import"].iter().any(|path| document.has(path));
    if document.has("plant") && !described {
        let remark = Remark::new(
            Problem::Missing,
            "plant",
            "the structure is missing: give [plant.beam], [plant.lumped] or [plant.import]",
        );
        findings.add(Severity::Error, remark);
    }
    if let Some(beam) = &plant.beam {
        sections(&mut findings, beam);
        masses(&mut findings, beam);
    }
    let imported = project.import.iter().flat_map(|import| &import.masses);
    duplicates(&mut findings, "plant.import.mass", imported.map(|mass| mass.name.as_str()));
    configurations(&mut findings, project);
    structure(&mut findings, project);
    map(&mut findings, plant);
    coupling(&mut findings, plant);
    delays(&mut findings, plant);
    without_effect(&mut findings, plant);
    agreement(&mut findings, plant);
    units(&mut findings, &project.recording);
    configuration(&mut findings, project);
    findings.list
}

/// Names in a list must differ.
fn duplicates<'n>(findings: &mut Findings<'_>, list: &str, names: impl Iterator<Item = &'n str>) {
    let mut seen: Vec<&str> = Vec::new();
    for (index, name) in names.enumerate() {
        if let Some(first) = seen.iter().position(|n| *n == name && !name.is_empty()) {
            let allowed = format!("the name is taken by {list}[{first}]; names must differ");
            let remark = Remark::new(Problem::Duplicate, &format!("{list}[{index}].name"), allowed);
            findings.add(Severity::Error, remark.found(format!("\"{name}\"")));
        }
        seen.push(name);
    }
}

fn sections(findings: &mut Findings<'_>, beam: &Beam) {
    const LIST: &str = "plant.beam.section";
    duplicates(findings, LIST, beam.sections.iter().map(|s| s.name.as_str()));
    let length = length(beam);
    for (index, section) in beam.sections.iter().enumerate() {
        if section.to_m <= section.from_m {
            let allowed = format!("must lie beyond the section's near end {} m", section.from_m);
            let remark = Remark::new(Problem::Conflict, &format!("{LIST}[{index}].to"), allowed);
            findings.add(Severity::Error, remark.found(section.to_m.to_string()));
        }
        hollow(findings, &format!("{LIST}[{index}].inner_diameter"), &section.shape);
    }
    for (index, two) in beam.sections.windows(2).enumerate() {
        let gap = two[1].from_m - two[0].to_m;
        if gap.abs() > ADJOINING * length {
            let what = if gap > 0.0 { "leaves a gap of" } else { "overlaps by" };
            let allowed = format!(
                "{what} {} m: section \"{}\" ends at {} m; sections must adjoin in order",
                tidy(gap.abs()),
                two[0].name,
                two[0].to_m
            );
            let remark = Remark::new(Problem::Conflict, &format!("{LIST}[{}].from", index + 1), allowed);
            findings.add(Severity::Error, remark.found(two[1].from_m.to_string()));
        }
    }
    pivot(findings, beam);
}

fn pivot(findings: &mut Findings<'_>, beam: &Beam) {
    let (Some(first), Some(last)) = (beam.sections.first(), beam.sections.last()) else { return };
    if beam.pivot_m < first.from_m || beam.pivot_m > last.to_m {
        let allowed = format!("must lie on the beam, between {} and {} m", first.from_m, last.to_m);
        findings.add(
            Severity::Error,
            Remark::new(Problem::Conflict, "plant.beam.pivot", allowed).found(beam.pivot_m.to_string()),
        );
    }
}

/// A length without the noise of a subtraction.
fn tidy(length: f64) -> f64 {
    (length * 1e9).round() / 1e9
}

fn hollow(findings: &mut Findings<'_>, path: &str, shape: &SectionShape) {
    let SectionShape::Tube { outer_diameter_m, inner_diameter_m } = shape else { return };
    if inner_diameter_m.iter().zip(outer_diameter_m).any(|(inner, outer)| inner >= outer) {
        let allowed = format!("must be below the outer diameter {outer_diameter_m:?} m at both ends");
        findings.add(
            Severity::Error,
            Remark::new(Problem::Conflict, path, allowed).found(format!("{inner_diameter_m:?}")),
        );
    }
}

fn length(beam: &Beam) -> f64 {
    beam.sections.iter().map(|s| s.to_m - s.from_m).filter(|l| *l > 0.0).sum()
}

fn masses(findings: &mut Findings<'_>, beam: &Beam) {
    const LIST: &str = "plant.beam.mass";
    duplicates(findings, LIST, beam.masses.iter().map(|m| m.name.as_str()));
    let (Some(first), Some(last)) = (beam.sections.first(), beam.sections.last()) else { return };
    let beyond = OVERHANG * length(beam);
    for (index, mass) in beam.masses.iter().enumerate() {
        if mass.position_m < first.from_m - beyond || mass.position_m > last.to_m + beyond {
            let allowed = format!(
                "mass \"{}\" is not on the beam, which reaches from {} to {} m",
                mass.name, first.from_m, last.to_m
            );
            let remark = Remark::new(Problem::Conflict, &format!("{LIST}[{index}].position"), allowed);
            findings.add(Severity::Error, remark.found(mass.position_m.to_string()));
        }
    }
}

/// The structure that the model takes must be there, and imported matrices must be damped.
fn structure(findings: &mut Findings<'_>, project: &Project) {
    let (section, there) = match project.model.structure {
        StructureChoice::Lumped => ("plant", true),
        StructureChoice::Beam => ("plant.beam", project.plant.beam.is_some()),
        StructureChoice::Import => ("plant.import", project.import.is_some()),
    };
    if !there {
        let allowed = format!("needs the section [{section}]");
        let found = format!("\"{}\"", project.model.structure.name());
        findings.add(Severity::Error, Remark::new(Problem::Missing, "model.structure", allowed).found(found));
    }
    let undamped =
        |import: &ImportedStructure| import.damping.file.is_empty() && import.modal_damping.is_empty();
    if project.import.as_ref().is_some_and(undamped) {
        let allowed = "the structure has no damping: give modal_damping or a damping matrix";
        findings.add(Severity::Error, Remark::new(Problem::Missing, "plant.import", allowed));
    }
}

fn configurations(findings: &mut Findings<'_>, project: &Project) {
    const LIST: &str = "plant.configuration";
    let plant = &project.plant;
    duplicates(findings, LIST, plant.configurations.iter().map(|c| c.name.as_str()));
    let of_beam = plant.beam.iter().flat_map(|b| &b.masses);
    let of_import = project.import.iter().flat_map(|i| &i.masses);
    let known: Vec<&str> = of_beam.chain(of_import).map(|m| m.name.as_str()).collect();
    for (index, configuration) in plant.configurations.iter().enumerate() {
        for (place, name) in configuration.masses.iter().enumerate() {
            let path = format!("{LIST}[{index}].masses[{place}]");
            let found = format!("\"{name}\"");
            if !known.contains(&name.as_str()) {
                let allowed = format!("the beam has no such mass; it has {}", quoted(&known));
                let remark = Remark::new(Problem::UnknownName, &path, allowed).found(found);
                findings.add(Severity::Error, remark.hint(did_you_mean(name, known.iter().copied())));
            } else if configuration.masses[..place].contains(name) {
                findings.add(
                    Severity::Error,
                    Remark::new(Problem::Duplicate, &path, "a mass can be fitted only once").found(found),
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
        let allowed = format!("there is no such configuration; known are {}", quoted(&known));
        let remark =
            Remark::new(Problem::UnknownName, "model.configuration", allowed).found(format!("\"{name}\""));
        findings.add(Severity::Error, remark.hint(did_you_mean(name, known.iter().copied())));
    }
}

fn quoted(names: &[&str]) -> String {
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
        let remark = Remark::new(Problem::Conflict, "plant.amplifier.map", allowed);
        findings.add(Severity::Error, remark.found(format!("[{}, {}]", point.input_v, point.current_a)));
    }
}

fn coupling(findings: &mut Findings<'_>, plant: &Parameters) {
    let value = plant.motor.platform_coupling;
    if value.abs() < 1.0 && value != 0.0 {
        let remark = Remark::new(Problem::OutOfRange, "plant.motor.platform_coupling", "must be -1, 0 or 1");
        findings.add(Severity::Error, remark.found(value.to_string()));
    }
}

/// Most samples by which a sensor may be late: each is a state of the sampled plant.
const MOST_DELAY_SAMPLES: f64 = 1000.0;

/// A sensor's delay is at most so many samples.
fn delays(findings: &mut Findings<'_>, plant: &Parameters) {
    let (sensors, period) = (&plant.sensors, plant.interface.sample_period_s);
    let all = [
        ("hub_gyro", Some(&sensors.hub_gyro)),
        ("platform_gyro", Some(&sensors.platform_gyro)),
        ("platform_accelerometer", Some(&sensors.platform_accelerometer)),
        ("motor_tachometer", sensors.motor_tachometer.as_ref()),
        ("hub_resolver", sensors.hub_resolver.as_ref()),
    ];
    for (name, sensor) in all {
        let delay_s = sensor.map_or(0.0, |sensor| sensor.delay_s);
        if period > 0.0 && delay_s > MOST_DELAY_SAMPLES * period {
            let most = MOST_DELAY_SAMPLES * period;
            let allowed = format!("must be at most {MOST_DELAY_SAMPLES} sample periods, {most} s");
            let remark = Remark::new(Problem::OutOfRange, &format!("plant.sensors.{name}.delay"), allowed);
            findings.add(Severity::Error, remark.found(delay_s.to_string()));
        }
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
        let remark = Remark::new(Problem::Conflict, &path, allowed).found(value.to_string());
        findings.add(Severity::Warning, remark);
    };
    for (name, sensor) in given.clone().filter(|(_, sensor)| sensor.natural_frequency_rad_s.is_finite()) {
        let why = "this sensor is simulated without dynamics (give its lag as `delay`)";
        warn(format!("plant.sensors.{name}.natural_frequency"), sensor.natural_frequency_rad_s, why);
    }
    let accelerometer = ("platform_accelerometer", &sensors.platform_accelerometer);
    for (name, sensor) in given.chain([accelerometer]).filter(|(_, sensor)| sensor.g_sensitivity != 0.0) {
        let why = "only the gyroscopes feel heave besides what they measure";
        warn(format!("plant.sensors.{name}.g_sensitivity"), sensor.g_sensitivity, why);
    }
}

/// Warns where the lumped inertia or out-of-balance is not the beam's.
fn agreement(findings: &mut Findings<'_>, plant: &Parameters) {
    let (Some(beam), Some(lumped)) = (&plant.beam, &plant.lumped) else { return };
    let Some((moment, inertia)) = rigid(beam) else { return };
    let total = lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2;
    let mut compare = |path: &str, value: f64, of_beam: f64, what: &str, unit: &str| {
        let scale = of_beam.abs().max(value.abs());
        if (value - of_beam).abs() > AGREEMENT * scale {
            let allowed = format!("{what} {value:.2} {unit}, but the beam's is {of_beam:.2} {unit}");
            findings.add(Severity::Warning, Remark::new(Problem::Conflict, path, allowed));
        }
    };
    compare("plant.lumped.hub_inertia", total, inertia, "hub and beam inertia together are", "kg m^2");
    compare(
        "plant.lumped.out_of_balance",
        lumped.out_of_balance_kg_m,
        moment,
        "the out-of-balance is",
        "kg m",
    );
}

/// First moment and inertia of the bare beam about the pivot, by Gauss quadrature exact for tapered tubes
/// (the density times area is a polynomial of degree 2, times x^2: degree 4), rotary inertia neglected.
fn rigid(beam: &Beam) -> Option<(f64, f64)> {
    let (mut moment, mut inertia) = (0.0, 0.0);
    for section in &beam.sections {
        let (centre, half) = (0.5 * (section.from_m + section.to_m), 0.5 * (section.to_m - section.from_m));
        for (node, weight) in GAUSS {
            let x = centre + half * node - beam.pivot_m;
            let mass = beam.density_kg_m3 * area(&section.shape, 0.5 * (1.0 + node)) * half * weight;
            moment += mass * x;
            inertia += mass * x * x;
        }
    }
    (moment.is_finite() && inertia.is_finite() && !beam.sections.is_empty()).then_some((moment, inertia))
}

/// Three-point Gauss-Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Area at a fraction of a section's length.
fn area(shape: &SectionShape, at: f64) -> f64 {
    let along = |ends: &[f64; 2]| ends[0] + at * (ends[1] - ends[0]);
    match shape {
        SectionShape::Tube { outer_diameter_m, inner_diameter_m } => {
            std::f64::consts::FRAC_PI_4 * (along(outer_diameter_m).powi(2) - along(inner_diameter_m).powi(2))
        }
        SectionShape::Rectangle { height_m, width_m } => along(height_m) * along(width_m),
        SectionShape::Given { area_m2, .. } => along(area_m2),
    }
}

/// Units in the mapping of channels must be known and of the channel's quantity.
fn units(findings: &mut Findings<'_>, mapping: &Mapping) {
    let time = mapping.time.iter().map(|s| ("time", "s", s));
    let channels = mapping.channels.iter().map(|(c, s)| (c.name(), s.unit_of_column(c.unit()), s));
    for (name, wanted, source) in time.chain(channels) {
        let Some(written) = &source.unit else { continue };
        let target = Unit::parse(wanted).unwrap_or(Unit::ONE);
        let fits = Unit::parse(written).is_some_and(|u| u.is_like(&target) || u.is_like(&Unit::ONE));
        if !fits {
            let path = format!("recording.channels.{name}.unit");
            let remark = Remark::new(Problem::OutOfRange, &path, format!("must be a unit like {wanted}"));
            findings.add(Severity::Error, remark.found(format!("\"{written}\"")));
        }
    }
}
