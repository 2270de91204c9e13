//! The report of a verification.

use counterpoise_pipeline::loop_view::LoopView;
use counterpoise_pipeline::sight_views::SightView;
use counterpoise_verify::Verification;
use counterpoise_verify::rejection_spectra::HubRateSpectra;

use crate::{ProvenanceEntry, Report, ReportSection, error_budget, evidence, loop_charts, spectra, summary};

/// Context of a verification: what the verification itself does not contain.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VerificationContext {
    /// The machine's name.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// The loop as charts of the plane show it; without it those charts are left out.
    pub loop_view: Option<LoopView>,
    /// The spectra of the line of sight; empty if the verification did not ask for them.
    pub sight_views: Vec<SightView>,
    /// Sections that come after the verification's own: reduction, weights, certificates, times.
    pub more: Vec<ReportSection>,
    /// Pairs of name and value: version, project, command.
    pub provenance: Vec<ProvenanceEntry>,
}

/// Returns the report: the verdicts on the first screen, then the evidence, then what `context` adds. `on_road` are the rejection ratios
/// from the time histories on the road.
pub fn of_verification(
    found: &Verification,
    on_road: &[HubRateSpectra],
    context: VerificationContext,
) -> Report {
    let mut sections = evidence::evidence_sections(found);
    if let Some(view) = &context.loop_view {
        sections.insert(1, loop_charts::charts_section(found, view));
    }
    sections.extend(spectra::spectra_section(on_road, found.controlled_quantity()));
    sections.extend(error_budget::budget_section(found, &context.sight_views));
    sections.extend(context.more);
    sections.extend(summary::traceability_section(found));
    sections.push(evidence::figure_section(found));
    let mut headline = summary::summarise_verdicts(found);
    for line in summary::worse_feedforwards(found) {
        headline.detail = format!("{} {line}.", headline.detail).trim().to_owned();
    }
    Report {
        title: context.title,
        subtitle: context.subtitle,
        headline,
        tiles: summary::summary_tiles(found),
        verdicts: summary::verdict_table(found),
        glance: summary::summary_figures(found),
        sections,
        provenance: context.provenance,
    }
}
