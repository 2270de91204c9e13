//! The checks of the beam that no single key allows: sections must adjoin, masses lie on it, and lumped inertias agree with it.

use counterpoise_models::{Beam, Parameters, SectionShape};

use super::findings::{Findings, report_duplicates};
use crate::diagnostic::{DiagnosticKind, Severity};
use crate::file::source::Remark;
use crate::tolerance::{ADJOINING_SHARE, BEAM_AGREEMENT, BEAM_OVERHANG};

pub(super) fn sections(findings: &mut Findings<'_>, beam: &Beam) {
    const LIST: &str = "plant.beam.section";
    report_duplicates(findings, LIST, beam.sections.iter().map(|s| s.name.as_str()));
    let length = length(beam);
    for (index, section) in beam.sections.iter().enumerate() {
        if section.to_m <= section.from_m {
            let allowed = format!("must lie beyond the section's near end {} m", section.from_m);
            let remark = Remark::new(DiagnosticKind::Conflict, &format!("{LIST}[{index}].to"), allowed);
            findings.add(Severity::Error, remark.with_value(section.to_m.to_string()));
        }
        check_tube(findings, &format!("{LIST}[{index}].inner_diameter"), &section.shape);
    }
    for (index, two) in beam.sections.windows(2).enumerate() {
        let gap = two[1].from_m - two[0].to_m;
        if gap.abs() > ADJOINING_SHARE * length {
            let what = if gap > 0.0 { "leaves a gap of" } else { "overlaps by" };
            let allowed = format!(
                "{what} {} m: section \"{}\" ends at {} m; sections must adjoin in order",
                tidy(gap.abs()),
                two[0].name,
                two[0].to_m
            );
            let remark =
                Remark::new(DiagnosticKind::Conflict, &format!("{LIST}[{}].from", index + 1), allowed);
            findings.add(Severity::Error, remark.with_value(two[1].from_m.to_string()));
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
            Remark::new(DiagnosticKind::Conflict, "plant.beam.pivot", allowed)
                .with_value(beam.pivot_m.to_string()),
        );
    }
}

/// Returns a length without the noise of a subtraction.
fn tidy(length: f64) -> f64 {
    (length * 1e9).round() / 1e9
}

fn check_tube(findings: &mut Findings<'_>, path: &str, shape: &SectionShape) {
    let SectionShape::Tube { outer_diameter_m, inner_diameter_m } = shape else { return };
    if inner_diameter_m.iter().zip(outer_diameter_m).any(|(inner, outer)| inner >= outer) {
        let allowed = format!("must be below the outer diameter {outer_diameter_m:?} m at both ends");
        findings.add(
            Severity::Error,
            Remark::new(DiagnosticKind::Conflict, path, allowed).with_value(format!("{inner_diameter_m:?}")),
        );
    }
}

fn length(beam: &Beam) -> f64 {
    beam.sections.iter().map(|s| s.to_m - s.from_m).filter(|l| *l > 0.0).sum()
}

pub(super) fn masses(findings: &mut Findings<'_>, beam: &Beam) {
    const LIST: &str = "plant.beam.mass";
    report_duplicates(findings, LIST, beam.masses.iter().map(|m| m.name.as_str()));
    let (Some(first), Some(last)) = (beam.sections.first(), beam.sections.last()) else { return };
    if beam.pivot_m < first.from_m || beam.pivot_m > last.to_m {
        // The beam lacks a section, which is reported at its pivot.
        return;
    }
    let beyond = BEAM_OVERHANG * length(beam);
    for (index, mass) in beam.masses.iter().enumerate() {
        if mass.position_m < first.from_m - beyond || mass.position_m > last.to_m + beyond {
            let allowed = format!(
                "mass \"{}\" is not on the beam, which reaches from {} to {} m",
                mass.name, first.from_m, last.to_m
            );
            let remark = Remark::new(DiagnosticKind::Conflict, &format!("{LIST}[{index}].position"), allowed);
            findings.add(Severity::Error, remark.with_value(mass.position_m.to_string()));
        }
    }
}

/// Warns where the lumped inertia or out-of-balance is not the beam's.
pub(super) fn agreement(findings: &mut Findings<'_>, plant: &Parameters) {
    let (Some(beam), Some(lumped)) = (&plant.beam, &plant.lumped) else { return };
    let Some((moment, inertia)) = rigid_moments(beam) else { return };
    let total = lumped.inertia_kg_m2();
    let mut compare = |path: &str, value: f64, of_beam: f64, what: &str, unit: &str| {
        let scale = of_beam.abs().max(value.abs());
        if (value - of_beam).abs() > BEAM_AGREEMENT * scale {
            let allowed = format!("{what} {value:.2} {unit}, but the beam's is {of_beam:.2} {unit}");
            findings.add(Severity::Warning, Remark::new(DiagnosticKind::Conflict, path, allowed));
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

/// Returns the first moment and inertia of the bare beam about the pivot, by Gauss quadrature exact for
/// tapered tubes (the density times area is a polynomial of degree 2, times x^2: degree 4), rotary inertia
/// neglected.
fn rigid_moments(beam: &Beam) -> Option<(f64, f64)> {
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

/// Returns the area at a fraction of a section's length.
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
