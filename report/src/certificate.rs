//! The stability certificate in words: what is proved, what is predicted, what the simulator shows.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::studies::certificate::RegimeRobustness;
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};
use counterpoise_verify::certificate::{
    CaseCertificate, Orbit, Regime, RegimeLoop, SectorProof, Stability, StabilityCertificate,
    StabilityCriterion, Teeth,
};
use counterpoise_verify::structured::Joints;

use crate::robustness::robustness_word;
use crate::wording::capitalise_first;
use crate::wording::figures::describe_modulus;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Returns the verdict of a case in a sentence without its full stop.
pub fn describe_verdict(case: &CaseCertificate) -> String {
    match case.stability {
        Stability::Stable => match case.sector.as_ref().filter(|proof| proof.holds()) {
            Some(proof) => format!("stable: proved {}, and quiet in the runs", scope(proof)),
            None => "stable: predicted in every regime, and quiet in the runs; not proved".to_owned(),
        },
        Stability::LimitCycle { amplitude_rad_s, frequency_hz } => format!(
            "NOT quiet at rest: a limit cycle of {} at {} Hz",
            with_unit_of_size(amplitude_rad_s, case.controlled),
            short_number(frequency_hz)
        ),
        Stability::Unstable => "NOT stable: the motion grows".to_owned(),
        Stability::NotPredicted => format!(
            "not predicted: the runs show neither rest nor a limit cycle; at rest the {} {} RMS",
            if case.controlled == case.rate {
                format!(
                    "{} moves",
                    if case.rate.axis == counterpoise_models::AxisKind::Rotary { "hub" } else { "slide" }
                )
            } else {
                format!("{} varies by", case.controlled.name())
            },
            with_unit_of_size(case.rest.rms_rad_s, case.controlled)
        ),
    }
}

/// For which frictions and motions a proof holds.
fn scope(proof: &SectorProof) -> String {
    let laws = match proof.criterion {
        StabilityCriterion::Passivity => "for every dry friction that only takes energy",
        StabilityCriterion::Circle => {
            "for every dry friction that yields as Dahl's does, at most as stiff as the stated one"
        }
        StabilityCriterion::Popov => "for every dry friction that is a function of the rate",
        StabilityCriterion::ZamesFalb => "for every dry friction that rises with the rate",
    };
    let teeth = if proof.teeth == Teeth::Pressed { ", while the gear teeth stay together" } else { "" };
    format!("{laws} (criterion: {}){teeth}", proof.criterion.key())
}

/// Returns what the sector argument says in a line; `None` if none applies.
fn sector(case: &CaseCertificate) -> String {
    let Some(proof) = &case.sector else {
        return "no proof: no sector argument applies (a friction observer or an estimator in the loop, a drive's curve, teeth that friction can hold apart, a law that may \
                give energy, or a loop that is unstable without friction)"
            .to_owned();
    };
    if proof.holds() {
        return format!(
            "proved by the criterion {}: least eigenvalue {} of its largest, at {} Hz, over all frequencies from {} Hz to {} kHz in {} \
             intervals; aliases {} of what they may be",
            proof.criterion.key(),
            short_number(proof.least),
            short_number(proof.frequency_hz),
            short_number(proof.range_hz[0]),
            short_number(1e-3 * proof.range_hz[1]),
            proof.intervals,
            short_number(proof.aliases)
        );
    }
    if proof.least > 0.0 {
        return format!(
            "no proof: aliases may pass on {} times as much as they may",
            short_number(proof.aliases)
        );
    }
    format!(
        "no proof that covers every friction law: what was tried fails at {} Hz",
        short_number(proof.frequency_hz)
    )
}

/// Returns a regime in words.
pub fn name_regime(regime: Regime) -> &'static str {
    match regime {
        Regime::Presliding => "at rest (presliding friction)",
        Regime::Sliding => "sliding friction",
        Regime::PreslidingLearning => "at rest, estimator learning",
        Regime::SlidingLearning => "sliding, estimator learning",
        Regime::Frictionless => "at rest and in motion",
        Regime::FrictionlessLearning => "estimator learning",
        Regime::TeethOpen => "gear teeth open",
    }
}

/// What quiets a limit cycle.
const QUIETING: &str = "less play, less dry friction or its compensation ([synth.observer]), a finer sensor or a slower loop ([synth] bandwidth, or the weights) quiets it";

/// Returns the certificate in lines, for a terminal and for the section's text: the worst case first.
pub fn certificate_lines(found: &StabilityCertificate) -> Vec<String> {
    let Some(worst) = found.worst_case() else { return Vec::new() };
    let mut lines = vec![format!("{} (worst case: {})", describe_verdict(worst), worst.name)];
    if matches!(worst.stability, Stability::LimitCycle { .. }) {
        lines.push(QUIETING.to_owned());
    }
    if let Some(at) = worst.worst_regime() {
        lines.push(format!("worst regime: {}, {}", name_regime(at.regime), loop_words(at)));
    }
    lines.push(sector(worst));
    lines.extend(worst.prediction.cycles.iter().map(|cycle| {
        let trust = if cycle.is_reliable() {
            "predicted by harmonic balance"
        } else if !cycle.is_consistent() {
            "not predicted reliably, because its describing functions hold for another frequency"
        } else {
            "not predicted reliably, because the loop is no low-pass there"
        };
        format!(
            "limit cycle of {} at {} Hz: {trust}",
            with_unit_of_size(cycle.rate_rad_s, worst.rate),
            short_number(cycle.frequency_hz)
        )
    }));
    lines.extend(
        worst.orbits.iter().filter(|orbit| orbit.rms_rad_s > 0.0).map(|orbit| orbit_words(orbit, worst)),
    );
    let others = found.cases.iter().filter(|case| case.name != worst.name);
    lines.extend(others.map(|case| format!("{}: {}", case.name, describe_verdict(case))));
    lines
}

fn loop_words(at: &RegimeLoop) -> String {
    if at.pole_radius >= 1.0 {
        return format!(
            "unstable: pole of modulus {} at {} Hz, growing by a factor of e in {} s",
            describe_modulus(at.pole_radius),
            short_number(at.frequency_hz),
            short_number(at.growth_time_s())
        );
    }
    format!(
        "gain margin {} dB, largest sensitivity {}",
        short_number(at.gain_margin_db),
        short_number(at.max_sensitivity)
    )
}

fn orbit_words(orbit: &Orbit, case: &CaseCertificate) -> String {
    let size = |value: f64| with_unit_of_size(value, case.controlled);
    if orbit.rms_rad_s.is_infinite() {
        return format!("simulated from {}: the motion diverges", size(orbit.start_rad_s));
    }
    format!(
        "simulated from {} at {} Hz: {} at {} Hz stays",
        size(orbit.start_rad_s),
        short_number(orbit.start_hz),
        size(orbit.amplitude_rad_s),
        short_number(orbit.frequency_hz)
    )
}

/// Returns a value in thousandths of the unit of a quantity, or in the unit if it is no less than 1.
fn with_unit_of_size(value: f64, quantity: ControlledQuantity) -> String {
    match value.abs() < 1.0 {
        true => format!("{} {}", short_number(1e3 * value), quantity.milli_unit()),
        false => format!("{} {}", short_number(value), quantity.unit()),
    }
}

/// Returns the structured singular value of the further cases and regimes in lines; the design's own case in the sliding regime is the
/// linear worst case and stands elsewhere.
pub fn robustness_lines(found: &[RegimeRobustness]) -> Vec<String> {
    let line = |at: &RegimeRobustness| match &at.found {
        Some(bounds) => format!(
            "{}: {}: stable within {} times the stated ranges",
            name_robust_regime(at),
            robustness_word(bounds),
            short_number(bounds.guaranteed)
        ),
        None => format!("{}: the loop is not stable without any deviation", name_robust_regime(at)),
    };
    found.iter().map(line).collect()
}

/// Returns a case and a regime of friction in words.
pub fn name_robust_regime(at: &RegimeRobustness) -> String {
    match at.joints {
        Joints::Sliding => format!("{}, sliding friction", at.case),
        Joints::AtRest => format!("{}, at rest", at.case),
        Joints::Frictionless => at.case.clone(),
    }
}

/// Returns what the lines on the linear worst case of the design's own case begin with.
pub fn worst_case_heading(joints: Joints) -> &'static str {
    if joints == Joints::Frictionless { "linear" } else { "linear, sliding friction" }
}

/// Returns the section of a report.
pub fn certificate_section(found: &StabilityCertificate, robust: &[RegimeRobustness]) -> ReportSection {
    let mut section = ReportSection::new("Stability of the exported controller");
    for line in certificate_lines(found) {
        section = section.with_text(format!("{}.", capitalise_first(&line)));
    }
    section = section.with_text(
        "Every block of the exported controller is part of these loops: its friction observers, its estimator and the inverse of the \
         drive's curve. A friction level that is learnt counts as the stated one; the runs learn it. At rest, friction is the spring of its presliding stiffness. Limit cycles are predicted by harmonic balance, \
         and each prediction is the start of a run on the simulator, which is followed until the motion settles or fades. Stability is \
         called proved only where a sector argument holds: what is known of the friction laws (that they take energy, that they are functions \
         of the rate or yield as a spring does) contradicts any motion that keeps itself up, at every frequency, with a bound between the \
         points of the grid and for the aliases of sampling. It assumes that neither control nor current reaches its limit. Everything else \
         is predicted.",
    );
    section = section.with_table(regimes(found));
    if !robust.is_empty() {
        section = section.with_table(bounds(robust));
    }
    match found.worst_case() {
        Some(worst) if !worst.prediction.growth.is_empty() => section.with_figures([growth(worst)]),
        _ => section,
    }
}

fn regimes(found: &StabilityCertificate) -> ReportTable {
    let columns = [
        ReportColumn::Text("case"),
        ReportColumn::Text("regime"),
        ReportColumn::Number("pole modulus"),
        ReportColumn::Number("gain margin [dB]"),
        ReportColumn::Number("largest sensitivity"),
    ];
    let mut table = ReportTable::new("The linear loop in each regime", &columns);
    for case in &found.cases {
        for at in &case.regimes {
            table.rows.push(vec![
                ReportCell::text(case.name.clone()),
                ReportCell::text(name_regime(at.regime)),
                ReportCell::text(describe_modulus(at.pole_radius)),
                ReportCell::number(at.gain_margin_db),
                ReportCell::number(at.max_sensitivity),
            ]);
        }
    }
    table
}

/// Returns the section of a report on the other cases and regimes; `None` without any.
pub fn robustness_of_regimes(found: &[RegimeRobustness]) -> Option<ReportSection> {
    let section = ReportSection::new("Linear worst case in the other cases and regimes");
    (!found.is_empty()).then(|| section.with_table(bounds(found)))
}

fn bounds(found: &[RegimeRobustness]) -> ReportTable {
    let mut table =
        ReportTable::new("Stated ranges of the parameters in each regime", &[ReportColumn::Text("result")]);
    table.rows = robustness_lines(found).into_iter().map(|line| vec![ReportCell::text(line)]).collect();
    table
}

fn growth(case: &CaseCertificate) -> Figure {
    let points = case.prediction.growth.iter().map(|at| (1e3 * at.rate_rad_s, at.growth_per_s));
    let series = vec![Series::solid_line("growth", Colour::First, points)];
    let marks = vec![Mark::Level { y: 0.0, text: "the motion grows above this".to_owned() }];
    let panel = Panel::new(Axis::linear("growth of an oscillation", "1/s"), series).with_marks(marks);
    Figure::new(
        "Growth over the amplitude",
        Axis::logarithmic(&format!("amplitude of the {}", case.rate.name()), case.rate.milli_unit()),
        vec![panel],
    )
}
