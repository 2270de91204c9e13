//! The answer of a search for weights: rejection against sensitivity and effort, point by point.

use counterpoise_pipeline::ProjectIdentity;
use counterpoise_pipeline::studies::search::{JudgedWeights, SearchAnswer, TradeOffPoint};
use counterpoise_synth::Figures;

use crate::design::weight_section;
use crate::results::front::VerdictSummary;
use crate::wording::weights::describe_weights;
use crate::{
    FigureTile, Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportOrigin, ReportSection,
    ReportTable,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

/// The verdicts on the weights of a point of the trade-off curve.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct VerifiedPoint {
    /// Limit of Ms under which the weights were found; `None` for the answer itself.
    pub max_sensitivity_limit: Option<f64>,
    /// |S| over the band, on the design plant.
    pub rejection: f64,
    /// Verdicts that hold, that fail, and that do not apply.
    pub verdicts: [usize; 3],
    /// Requirements that fail, with their values.
    pub failing: Vec<String>,
    /// `true` if everything holds.
    pub holds: bool,
}

impl From<&JudgedWeights> for VerifiedPoint {
    fn from(point: &JudgedWeights) -> Self {
        let found = VerdictSummary::from(point.verified.verification());
        Self {
            max_sensitivity_limit: point.ms_limit,
            rejection: point.found.best.figures.rejection,
            verdicts: found.verdicts,
            failing: found.failing,
            holds: point.holds(),
        }
    }
}

/// Returns the report of a search for weights; `points` are the verdicts on the answer and on the points of its curve.
pub fn trade_off_report(
    identity: &ProjectIdentity,
    found: &SearchAnswer,
    points: &[VerifiedPoint],
    origin: &ReportOrigin,
) -> Report {
    let best = &found.found.best;
    let holds = best.missed == 0.0 && found.missed_on_full_plant == 0.0;
    let (tone, text) = match holds {
        true => (OutcomeTone::Good, "The requirements on the loop hold"),
        false => (OutcomeTone::Bad, "Requirements on the loop are missed"),
    };
    let detail = format!("{} designs were tried for the answer.", found.found.trials);
    let mut trade_off = ReportSection::new("Trade-off")
        .with_text("Each point is a search of its own under a limit of the sensitivity; every other requirement is kept.");
    if !found.curve.is_empty() {
        trade_off =
            trade_off.with_figures([figure(best, &found.curve)]).with_table(points_table(&found.curve));
    }
    let report = Report {
        title: format!("Weights for {}", identity.name),
        subtitle: "from requirements to weights".to_owned(),
        headline: Headline { tone, text: text.to_owned(), detail },
        tiles: tiles(&best.figures),
        verdicts: verified_table(points),
        glance: Vec::new(),
        sections: vec![trade_off, weight_section(&describe_weights(&found.asked), &found.weight_responses)],
        provenance: origin.provenance(identity),
    };
    report.with_command(&origin.command)
}

fn verified_table(points: &[VerifiedPoint]) -> ReportTable {
    let columns = [
        ReportColumn::Text("weights"),
        ReportColumn::Number("|S| over the band"),
        ReportColumn::Number("hold"),
        ReportColumn::Number("fail"),
        ReportColumn::Text("verdict"),
        ReportColumn::Text("what fails"),
    ];
    let mut table = ReportTable::new("Verified on the full nonlinear plant", &columns);
    for point in points {
        let name = point
            .max_sensitivity_limit
            .map_or("the answer".to_owned(), |limit| format!("Ms at most {limit}"));
        let verdict = if point.holds {
            ReportCell::Verdict(OutcomeTone::Good, "holds".to_owned())
        } else {
            ReportCell::Verdict(OutcomeTone::Bad, "fails".to_owned())
        };
        table.rows.push(vec![
            ReportCell::text(name),
            ReportCell::number(point.rejection),
            ReportCell::text(point.verdicts[0].to_string()),
            ReportCell::text(point.verdicts[1].to_string()),
            verdict,
            ReportCell::text(point.failing.join("; ")),
        ]);
    }
    table
}

fn tiles(f: &Figures) -> Vec<FigureTile> {
    vec![
        FigureTile::plain("rejection |S|", short_number(f.rejection), ""),
        FigureTile::plain("largest sensitivity", short_number(f.ms), ""),
        FigureTile::plain("gain margin", short_number(f.gain_margin_db), "dB"),
        FigureTile::plain("noise gain", short_number(f.noise_gain), "V s/rad"),
    ]
}

fn figure(best: &counterpoise_synth::SearchTrial, curve: &[TradeOffPoint]) -> Figure {
    let over = |of: &dyn Fn(&Figures) -> f64| {
        let mut points: Vec<(f64, f64)> =
            curve.iter().map(|point| &point.found.best.figures).map(|found| (found.ms, of(found))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let answer = |y: f64| {
        let (text, colour) = ("the answer".to_owned(), Colour::Second);
        vec![Mark::Point { x: best.figures.ms, y, text, colour }]
    };
    let panel = |name: &str, unit: &str, of: &dyn Fn(&Figures) -> f64| {
        let series = vec![Series::solid_line("", Colour::First, over(of))];
        Panel::new(Axis::linear(name, unit), series).with_marks(answer(of(&best.figures)))
    };
    let panels = vec![
        panel("|S| over the band", "", &|f| f.rejection),
        panel("noise gain", "V s/rad", &|f| f.noise_gain).with_height(140.0),
    ];
    Figure::new(
        "Rejection and effort against sensitivity",
        Axis::linear("largest sensitivity Ms", ""),
        panels,
    )
    .with_caption("Less |S| is more rejection. Where the curve is flat another requirement than Ms stops it.")
}

fn points_table(curve: &[TradeOffPoint]) -> ReportTable {
    let columns = [
        ReportColumn::Number("limit of Ms"),
        ReportColumn::Number("Ms"),
        ReportColumn::Number("|S| over the band"),
        ReportColumn::Number("noise gain [V s/rad]"),
        ReportColumn::Number("gain margin [dB]"),
        ReportColumn::Number("phase margin [deg]"),
        ReportColumn::Number("overshoot [%]"),
        ReportColumn::Text("requirements"),
    ];
    let mut table = ReportTable::new("", &columns);
    for TradeOffPoint { ms_limit, found } in curve {
        let f = &found.best.figures;
        let mut cells: Vec<ReportCell> = [
            *ms_limit,
            f.ms,
            f.rejection,
            f.noise_gain,
            f.gain_margin_db,
            f.phase_margin_deg,
            100.0 * f.overshoot,
        ]
        .into_iter()
        .map(ReportCell::number)
        .collect();
        cells.push(match found.best.missed == 0.0 {
            true => ReportCell::Verdict(OutcomeTone::Good, "hold".to_owned()),
            false => ReportCell::Verdict(OutcomeTone::Bad, "are missed".to_owned()),
        });
        table.rows.push(cells);
    }
    table
}
