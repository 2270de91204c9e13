//! Pictures of what a diagnosis left unexplained: loops of control against rate, spectra of the residuals, responses, correlations.

use counterpoise_diagnose::fitting::residual_tests::ResidualTest;
use counterpoise_models::{ControlledQuantity, QuantityKind};
use counterpoise_pipeline::recordings::residuals::{
    ControlResponse, ResidualSpectra, ResidualStudy, TestedResidual,
};
use counterpoise_recordings::Channel;
use counterpoise_verify::signals::welch::Spectra;

use crate::tolerance::COHERENT;
use crate::{OutcomeTone, ReportCell, ReportColumn, ReportSection, ReportTable};
use counterpoise_pipeline::recordings::tracks::{ChannelTrack, TrackColumn};
use counterpoise_plot::thinning::MOST_POINTS;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

/// Recordings whose loops, and channels whose spectra are drawn.
const DRAWN: usize = 4;

/// Returns every section on what the models leave unexplained.
pub fn residual_sections(tracks: &[ChannelTrack], study: &ResidualStudy) -> Vec<ReportSection> {
    let mut out = Vec::new();
    let reading = tracks.iter().find(|t| t.channel == Channel::HubRate);
    let controlled = reading.map_or(ControlledQuantity::RATE, |track| track.controlled_quantity());
    let loops: Vec<Figure> =
        recordings(tracks).into_iter().filter_map(|r| loop_figure(tracks, r)).take(DRAWN).collect();
    if !loops.is_empty() {
        let section = match controlled.kind {
            QuantityKind::Rate => ReportSection::new("Control against rate").with_text(LOOPS),
            _ => ReportSection::new(&format!("Control against {}", controlled.short_name())),
        };
        out.push(section.with_figures(loops));
    }
    let responses: Vec<Figure> =
        study.responses.iter().filter_map(|found| response(found, controlled)).take(DRAWN).collect();
    if !responses.is_empty() {
        let (name, short) = (controlled.name(), controlled.short_name());
        let (of_hub, of_reading) = match controlled.kind {
            QuantityKind::Rate => ("the hub's rate".to_owned(), "measured rate".to_owned()),
            _ => (format!("the {name}"), format!("measured {short}")),
        };
        out.push(
            ReportSection::new("Frequency response, measured and simulated")
                .with_text(responses_sentence(&of_hub, &of_reading))
                .with_figures(responses),
        );
    }
    if !study.spectra.is_empty() {
        let figures = study.spectra.iter().take(2 * DRAWN).map(spectrum);
        out.push(ReportSection::new("Spectra of the errors").with_figures(figures));
    }
    out.push(tests(&study.tests));
    out
}

const LOOPS: &str = "Offset: out-of-balance; step at rate zero: dry friction; slope: viscous friction and back-EMF; width: inertia.";

/// Returns what the frequency responses show, with what the hub's motion and its reading are called.
fn responses_sentence(of_hub: &str, of_reading: &str) -> String {
    format!(
        "From the control to {of_hub}, by averaged spectra, where {of_reading} and control are coherent. The runs are in closed loop \
         or under its control, so noise biases the curves; it biases all of them alike."
    )
}

fn recordings(tracks: &[ChannelTrack]) -> Vec<&str> {
    let mut names: Vec<&str> = tracks.iter().map(|t| t.recording.as_str()).collect();
    names.dedup();
    names
}

fn track<'a>(tracks: &'a [ChannelTrack], recording: &str, channel: Channel) -> Option<&'a ChannelTrack> {
    tracks.iter().find(|t| t.recording == recording && t.channel == channel)
}

/// The run of a track that is meant, with its name and colour.
type Run = (&'static str, Colour, TrackColumn);

const RUNS: [Run; 3] = [
    ("measured", Colour::Muted, TrackColumn::Measured),
    ("model as it was", Colour::Second, TrackColumn::Before),
    ("improved model", Colour::First, TrackColumn::After),
];

fn loop_figure(tracks: &[ChannelTrack], recording: &str) -> Option<Figure> {
    let (control, rate) =
        (track(tracks, recording, Channel::Control)?, track(tracks, recording, Channel::HubRate)?);
    let series =
        RUNS.iter().filter(|(.., run)| !rate.signals.column(*run).is_empty()).map(|(name, colour, run)| {
            let step = rate.signals.column(*run).len().div_ceil(MOST_POINTS).max(1);
            let pairs =
                rate.signals.column(*run).iter().copied().zip(control.signals.column(*run).iter().copied());
            Series::solid_line(name, *colour, pairs.step_by(step))
        });
    let panel =
        Panel::new(Axis::linear("control", control.channel.unit()), series.collect()).with_height(300.0);
    let name = rate.controlled_quantity().name();
    let title = format!("{recording}: control against {name}");
    Some(Figure::new(&title, Axis::linear(name, rate.channel.unit()), vec![panel]))
}

fn response(found: &ControlResponse, controlled: ControlledQuantity) -> Option<Figure> {
    let measured = &found.measured;
    let drawn = |k: &usize| measured.coherence[*k] > COHERENT && measured.frequency_hz[*k] > 0.0;
    let indices: Vec<usize> = (1..measured.frequency_hz.len()).filter(drawn).collect();
    if indices.len() < DRAWN {
        return None;
    }
    let line = |name: &str, colour, values: &[f64], at: &Spectra| {
        let finite = indices.iter().filter(|k| values.get(**k).is_some_and(|v| v.is_finite()));
        Series::solid_line(name, colour, finite.map(|&k| (at.frequency_hz[k], values[k])))
    };
    let (mut gains, mut phases) = (Vec::new(), Vec::new());
    let runs = [Some(measured), found.before.as_ref(), found.after.as_ref()];
    for ((name, colour, _), spectra) in RUNS.iter().zip(runs) {
        let Some(spectra) = spectra else { continue };
        gains.push(line(name, *colour, &spectra.ratio_db, spectra));
        phases.push(line(name, *colour, &spectra.phase_deg, spectra));
    }
    let panels = vec![
        Panel::new(Axis::linear("gain", &format!("dB re {} per V", controlled.unit())), gains)
            .with_height(200.0),
        Panel::new(Axis::linear("phase", "deg").with_range(-180.0, 180.0), phases).with_height(120.0),
    ];
    let title = format!("{}: control to {}", found.recording, controlled.name());
    Some(Figure::new(&title, Axis::logarithmic("frequency", "Hz"), panels))
}

fn spectrum(found: &ResidualSpectra) -> Figure {
    let line = |name: &str, colour, spectra: Option<&Spectra>| {
        let spectra = spectra?;
        let density = spectra.amplitude_density_of_x();
        let pairs = spectra.frequency_hz.iter().copied().zip(density).skip(1);
        let series = Series::solid_line(name, colour, pairs.filter(|p| p.1 > 0.0));
        (!series.points.is_empty()).then_some(series)
    };
    let series = [
        line("measured", Colour::Muted, Some(&found.measured)),
        line("error of the model as it was", Colour::Second, found.before.as_ref()),
        line("error of the improved model", Colour::First, found.after.as_ref()),
    ];
    let unit = format!("{}/\u{221A}Hz", found.channel.unit());
    let series = series.into_iter().flatten().collect();
    let panel = Panel::new(Axis::logarithmic("density", &unit), series).with_height(220.0);
    let title = format!("{}: {}", found.recording, found.channel.name().replace('_', " "));
    Figure::new(&title, Axis::logarithmic("frequency", "Hz"), vec![panel])
}

/// Whiteness and cross-correlation of every residual, before and after.
fn tests(all: &[TestedResidual]) -> ReportSection {
    let columns = [
        ReportColumn::Text("recording"),
        ReportColumn::Text("channel"),
        ReportColumn::Text("model"),
        ReportColumn::Number("lags outside the band of white noise"),
        ReportColumn::Number("correlation with the control / band"),
        ReportColumn::Number("with the hub rate / band"),
    ];
    let mut table =
        ReportTable::new("Is anything left in the residuals? 5 % and below 1 are what noise gives", &columns);
    let mut figures = Vec::new();
    for tested in all {
        let found = [
            TestOfModel { name: "as it was", test: tested.before.as_ref() },
            TestOfModel { name: "improved", test: tested.after.as_ref() },
        ];
        for TestOfModel { name, test } in &found {
            table.rows.extend(test.map(|test| row(tested, name, test)));
        }
        if matches!(tested.channel, Channel::Control | Channel::HubRate) {
            figures.extend(autocorrelation(tested, &found));
        }
    }
    figures.truncate(DRAWN);
    ReportSection::new("Residual tests").with_table(table).with_figures(figures)
}

fn row(tested: &TestedResidual, model: &str, test: &ResidualTest) -> Vec<ReportCell> {
    let share = ReportCell::text(format!("{:.0} %", 100.0 * test.outside));
    let of = |channel: Channel| {
        let found = test.cross.iter().find(|c| c.with == channel && tested.channel != channel);
        found.map_or_else(
            || ReportCell::text("\u{2013}"),
            |c| {
                let size = format!("{:.1}", c.size());
                if c.size() < 1.0 {
                    ReportCell::Verdict(OutcomeTone::Good, size)
                } else {
                    ReportCell::text(size)
                }
            },
        )
    };
    vec![
        ReportCell::text(&tested.recording),
        ReportCell::text(tested.channel.name().replace('_', " ")),
        ReportCell::text(model),
        share,
        of(Channel::Control),
        of(Channel::HubRate),
    ]
}

/// The test of a residual with the name of the model that it was computed with; none if the residual could not be tested.
struct TestOfModel<'a> {
    name: &'a str,
    test: Option<&'a ResidualTest>,
}

fn autocorrelation(tested: &TestedResidual, found: &[TestOfModel<'_>; 2]) -> Option<Figure> {
    let colours = [Colour::Second, Colour::First];
    let line = |(one, colour): (&TestOfModel<'_>, Colour)| {
        let values = one.test?.autocorrelation.iter().enumerate();
        Some(Series::solid_line(
            one.name,
            colour,
            values.map(|(k, r)| (1e3 * k as f64 * tested.period_s, *r)),
        ))
    };
    let series: Vec<Series> = found.iter().zip(colours).filter_map(line).collect();
    let band = found.iter().find_map(|one| one.test)?.band;
    let marks = [band, -band].map(|y| Mark::Level { y, text: "95 % band of white noise".to_owned() });
    let panel = Panel::new(Axis::linear("autocorrelation", "").with_range(-1.0, 1.0), series)
        .with_height(150.0)
        .with_marks(marks.to_vec());
    let title = format!("{}: residual of {}", tested.recording, tested.channel.name().replace('_', " "));
    Some(Figure::new(&title, Axis::linear("lag", "ms"), vec![panel]))
}
