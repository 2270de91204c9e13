//! The report of the frequency response analyser: gain and phase over frequency for every amplitude, beside the linear models.

use counterpoise_pipeline::studies::fra::{LoopUnderTest, ResponseMap};
use counterpoise_pipeline::studies::fra_points::ResponseMapPoint;
use counterpoise_pipeline::studies::fra_summary::{AmplitudePoints, MeasuringPace, StickingAmplitude};
use counterpoise_pipeline::studies::fra_totals::MapTotals;

use crate::bode::{BodeCurve, PhasePanel, bode_figure, response_of};
use crate::wording::capitalise_first;
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Panel, Series};

/// Returns the report of one or more maps of one machine, with their numbers together, and of how fast they were measured.
pub fn fra_report(maps: &[ResponseMap], totals: MapTotals, speed: &[MeasuringPace], command: &str) -> Report {
    let first = maps.first();
    let name = first.map_or("", |map| map.name.as_str());
    Report {
        title: format!("Frequency responses of {name}"),
        subtitle: first.map(map_title).unwrap_or_default(),
        headline: headline(maps, totals),
        tiles: first.map(tiles).unwrap_or_default(),
        verdicts: first.map(extremes).unwrap_or_else(|| ReportTable::new("", &[])),
        glance: first.map(|map| overview(map, command)).into_iter().collect(),
        sections: maps.iter().flat_map(|map| sections(map, command)).chain(pace(totals, speed)).collect(),
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

fn headline(maps: &[ResponseMap], totals: MapTotals) -> Headline {
    let MapTotals { points: count, unsettled, .. } = totals;
    let text = match unsettled {
        0 => format!("{count} points measured, every one settled"),
        n => format!("{count} points measured, {n} not settled or not excited"),
    };
    let spread = maps.first().map_or(0.0, |map| map.summary.widest_spread_db);
    let detail =
        format!("At one frequency the gain changes with the amplitude by up to {} dB.", short_number(spread));
    Headline { tone: if unsettled == 0 { OutcomeTone::Neutral } else { OutcomeTone::Bad }, text, detail }
}

/// Describes what a map relates and what surrounds the measurement, for example "demand to hub rate, with the controller".
pub fn map_title(map: &ResponseMap) -> String {
    let surroundings = match map.around {
        LoopUnderTest::Plant => "without controller",
        LoopUnderTest::Closed | LoopUnderTest::Disturbance => "with the controller",
        LoopUnderTest::Disconnected => "balanced, the motor disconnected",
    };
    format!("{} to {}, {surroundings}", map.signals.input, map.signals.output)
}

/// Returns a sentence for each amplitude at which the joint sticks, with the next amplitude of the map that moves it at all of those frequencies.
pub fn sticking_lines(map: &ResponseMap) -> Vec<String> {
    map.summary.sticking.iter().map(|sticking| sticking_line(map, sticking)).collect()
}

fn sticking_line(map: &ResponseMap, sticking: &StickingAmplitude) -> String {
    let unit = &map.signals.input_unit;
    let next = match sticking.moved_by {
        Some(size) => format!("{} {unit} moves it", short_number(size)),
        None => "no larger amplitude of this map moves it: measure with larger --amplitudes".to_owned(),
    };
    let place = match sticking.frequencies_hz[..] {
        [one] => format!("{} Hz", short_number(one)),
        [first, .., last] => format!(
            "{} of its frequencies from {} to {} Hz",
            sticking.frequencies_hz.len(),
            short_number(first),
            short_number(last)
        ),
        [] => "no frequency".to_owned(),
    };
    let (size, output) = (short_number(sticking.amplitude), map.signals.output);
    format!("the joint sticks at {size} {unit}, at {place}, and the {output} does not respond; {next}")
}

fn label(map: &ResponseMap, amplitude: f64) -> String {
    if amplitude.is_nan() {
        "recorded".to_owned()
    } else {
        format!("{} {}", short_number(amplitude), map.signals.input_unit)
    }
}

fn curve(
    name: &str,
    colour: Colour,
    points: &[ResponseMapPoint],
    of: fn(&ResponseMapPoint) -> Option<[f64; 2]>,
) -> BodeCurve {
    let at = |p: &ResponseMapPoint| of(p).map(|h| [p.frequency_hz, h[0], h[1]]);
    BodeCurve::new(response_of(name, points.iter().filter_map(at)), colour)
}

/// Returns all amplitudes in one diagram, the linear model dashed.
fn overview(map: &ResponseMap, command: &str) -> Figure {
    let families = &map.summary.amplitudes;
    let mut curves: Vec<BodeCurve> = families
        .iter()
        .zip(Colour::CYCLE)
        .map(|(family, colour)| {
            curve(&label(map, family.amplitude), colour, &family.points, |p| Some(p.response))
        })
        .collect();
    if let Some(AmplitudePoints { points, .. }) = families.first() {
        curves.push(curve("linear", Colour::Muted, points, |p| Some(p.linear)).with_dashes());
    }
    let figure = bode_figure(
        "Measured at every amplitude",
        &map.signals.gain_unit(),
        &curves,
        PhasePanel::Shown,
        Vec::new(),
    );
    let figure = figure.with_caption("Dashed: the linear model without dry friction, sampled exactly.");
    Figure { command: command.to_owned(), ..figure }
}

fn sections(map: &ResponseMap, command: &str) -> Vec<ReportSection> {
    let title = map.recording.clone().unwrap_or_else(|| "Describing functions".to_owned());
    let mut beside = ReportSection::new(&title)
        .with_text(
            "Each amplitude beside the linear model with dry friction replaced by its describing function, at the swing of the hub \
             that this model gives itself. It leaves out harmonics, the bias that the weight gives to friction, and backlash.",
        )
        .with_figures(map.summary.amplitudes.iter().zip(Colour::CYCLE).map(|(family, colour)| {
            let figure = beside_models(map, family, colour);
            Figure { command: command.to_owned(), ..figure }
        }));
    for line in sticking_lines(map) {
        beside = beside.with_text(format!("{}.", capitalise_first(&line)));
    }
    for remark in &map.remarks {
        beside = beside.with_text(remark);
    }
    let harmonics = ReportSection::new("Harmonics and mean").with_figures([harmonics(map, command)]);
    vec![beside, harmonics, ReportSection::new("Every point").with_table(points_table(map))]
}

/// Returns how fast the maps were measured; nothing for recordings, which were not simulated.
fn pace(totals: MapTotals, speed: &[MeasuringPace]) -> Option<ReportSection> {
    let simulated_s = totals.simulated_s;
    let columns = [
        ReportColumn::Number("threads"),
        ReportColumn::Number("time [s]"),
        ReportColumn::Number("times real time"),
        ReportColumn::Number("times as fast as on the first row"),
    ];
    let mut table =
        ReportTable::new(&format!("{} s of motion were simulated", short_number(simulated_s)), &columns);
    for pace in speed {
        table.rows.push(vec![
            ReportCell::text(pace.threads.to_string()),
            ReportCell::number(pace.seconds),
            ReportCell::number(pace.times_real_time(simulated_s)),
            ReportCell::number(pace.speed_up(speed)),
        ]);
    }
    let alone = "counterpoise fra --scaling measures the map on fewer threads as well; the map is the same to the last bit.";
    (!speed.is_empty())
        .then(|| ReportSection::new("How fast it was measured").with_text(alone).with_table(table))
}

fn beside_models(map: &ResponseMap, family: &AmplitudePoints, colour: Colour) -> Figure {
    let (name, points) = (label(map, family.amplitude), &family.points);
    let mut described = curve("describing function", Colour::Second, points, |p| p.describing);
    described.dash = Dash::Dotted;
    if colour == Colour::Second {
        described.colour = Colour::First;
    }
    let curves = [
        curve(&name, colour, points, |p| Some(p.response)),
        described,
        curve("linear", Colour::Muted, points, |p| Some(p.linear)).with_dashes(),
    ];
    let kept: Vec<BodeCurve> = curves.into_iter().filter(|c| !c.response.points.is_empty()).collect();
    bode_figure(&name, &map.signals.gain_unit(), &kept, PhasePanel::Shown, Vec::new())
}

fn harmonics(map: &ResponseMap, command: &str) -> Figure {
    let of = |y: fn(&ResponseMapPoint) -> f64| -> Vec<Series> {
        let families = &map.summary.amplitudes;
        let series =
            families.iter().zip(Colour::CYCLE).map(|(AmplitudePoints { amplitude, points, .. }, colour)| {
                let line = points.iter().map(|p| (p.frequency_hz, y(p)));
                Series::solid_line(&label(map, *amplitude), colour, line)
            });
        series.collect()
    };
    let panels = vec![
        Panel::new(Axis::linear("harmonics", "%"), of(|p| 100.0 * p.distortion)).with_height(160.0),
        Panel::new(Axis::linear("mean", map.signals.output_unit), of(|p| p.mean_rad_s)).with_height(120.0),
    ];
    let figure = Figure::new("Harmonics over the fundamental", Axis::logarithmic("frequency", "Hz"), panels)
        .with_caption(&format!(
            "Harmonics two to five of the {}, as the root of their squares, and its mean.",
            map.signals.output
        ));
    Figure { command: command.to_owned(), ..figure }
}

fn tiles(map: &ResponseMap) -> Vec<FigureTile> {
    let relative = map.signals.gain_unit();
    let unit = if relative.is_empty() { "dB".to_owned() } else { format!("dB re {relative}") };
    vec![
        FigureTile::plain("points", map.points.len().to_string(), ""),
        FigureTile::plain("largest gain", short_number(map.summary.largest_gain_db), &unit),
        FigureTile::plain("spread over amplitudes", short_number(map.summary.widest_spread_db), "dB")
            .with_note("0 on a linear machine"),
        FigureTile::plain("largest harmonics", short_number(100.0 * map.summary.largest_distortion), "%")
            .with_note("of the fundamental"),
    ]
}

/// Returns one row an amplitude: where the gain is largest, and how far the models are from the measurement.
fn extremes(map: &ResponseMap) -> ReportTable {
    let columns = [
        ReportColumn::Text("amplitude"),
        ReportColumn::Number("largest gain [dB]"),
        ReportColumn::Number("at [Hz]"),
        ReportColumn::Number("linear [dB]"),
        ReportColumn::Number("describing [dB]"),
    ];
    let mut table = ReportTable::new(
        "Each amplitude; linear, describing: how far those models are off, median of the gain",
        &columns,
    );
    for group in &map.summary.amplitudes {
        let highest = group.highest;
        table.rows.push(vec![
            ReportCell::text(label(map, group.amplitude)),
            ReportCell::number(highest.map_or(f64::NAN, |p| p.gain_db)),
            ReportCell::number(highest.map_or(f64::NAN, |p| p.frequency_hz)),
            ReportCell::number(group.linear_error_db),
            ReportCell::number(group.describing_error_db),
        ]);
    }
    table
}

fn points_table(map: &ResponseMap) -> ReportTable {
    let columns = [
        ReportColumn::Number("amplitude"),
        ReportColumn::Number("frequency [Hz]"),
        ReportColumn::Number("gain [dB]"),
        ReportColumn::Number("phase [deg]"),
        ReportColumn::Number("harmonics [%]"),
        ReportColumn::Number("cycles"),
        ReportColumn::Text("settled"),
    ];
    let mut table = ReportTable::new(&format!("Amplitudes in {}", map.signals.input_unit), &columns);
    for p in map.points.iter() {
        table.rows.push(vec![
            ReportCell::number(p.amplitude),
            ReportCell::number(p.frequency_hz),
            ReportCell::number(p.gain_db),
            ReportCell::number(p.phase_deg),
            ReportCell::number(100.0 * p.distortion),
            ReportCell::number(p.cycles as f64),
            ReportCell::text(if p.settled { "yes" } else { "no" }),
        ]);
    }
    table
}
