//! What a diagnosis left over, in pictures: loops of control against rate, spectra of the errors, responses, correlations.

use counterpoise_diagnose::fitting::residual_tests::{ResidualTest, test_residual};
use counterpoise_verify::signals::welch::{Spectra, WelchOptions, welch};

use crate::{Cell, Column, Section, Table, Tone};
use counterpoise_pipeline::recordings::tracks::Track;
use counterpoise_plot::thin::MOST_POINTS;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

/// Recordings whose loops, and channels whose spectra are drawn.
const DRAWN: usize = 4;
/// Longest segment of a spectrum, samples, and the number of segments below which it is shorter.
const SEGMENT: (usize, usize) = (2048, 6);
/// Coherence above which a frequency response is drawn.
const COHERENT: f64 = 0.5;

/// Every section on what is left over.
pub fn sections(tracks: &[Track]) -> Vec<Section> {
    let mut out = Vec::new();
    let loops: Vec<Figure> =
        recordings(tracks).into_iter().filter_map(|r| loop_figure(tracks, r)).take(DRAWN).collect();
    if !loops.is_empty() {
        out.push(Section::new("Control against rate").saying(LOOPS).showing(loops));
    }
    let responses: Vec<Figure> =
        recordings(tracks).into_iter().filter_map(|r| response(tracks, r)).take(DRAWN).collect();
    if !responses.is_empty() {
        out.push(
            Section::new("Frequency response, measured and simulated").saying(RESPONSES).showing(responses),
        );
    }
    let spectra: Vec<Figure> = tracks.iter().filter_map(spectrum).take(2 * DRAWN).collect();
    if !spectra.is_empty() {
        out.push(Section::new("Spectra of the errors").showing(spectra));
    }
    out.push(tests(tracks));
    out
}

const LOOPS: &str = "Offset: out-of-balance; step at rate zero: dry friction; slope: viscous friction and back-EMF; width: inertia.";
const RESPONSES: &str = "From the control to the hub's rate, by averaged spectra, where measured rate and control are coherent. The runs are in closed loop \
     or under its control, so noise biases the curves; it biases all of them alike.";

fn recordings(tracks: &[Track]) -> Vec<&str> {
    let mut names: Vec<&str> = tracks.iter().map(|t| t.recording.as_str()).collect();
    names.dedup();
    names
}

fn track<'a>(tracks: &'a [Track], recording: &str, channel: &str) -> Option<&'a Track> {
    tracks.iter().find(|t| t.recording == recording && t.channel == channel)
}

/// Which run of a track is meant, with its name and colour.
type Run = (&'static str, Colour, fn(&Track) -> &[f64]);

const RUNS: [Run; 3] = [
    ("measured", Colour::Muted, |t| &t.measured),
    ("model as it was", Colour::Second, |t| &t.before),
    ("improved model", Colour::First, |t| &t.after),
];

fn loop_figure(tracks: &[Track], recording: &str) -> Option<Figure> {
    let (control, rate) = (track(tracks, recording, "control")?, track(tracks, recording, "hub_rate")?);
    let series = RUNS.iter().filter(|(_, _, of)| !of(rate).is_empty()).map(|(name, colour, of)| {
        let step = of(rate).len().div_ceil(MOST_POINTS).max(1);
        let pairs = of(rate).iter().copied().zip(of(control).iter().copied());
        Series::solid(name, *colour, pairs.step_by(step))
    });
    let panel = Panel::new(Axis::linear("control", control.unit), series.collect()).with_height(300.0);
    let title = format!("{recording}: control against hub rate");
    Some(Figure::new(&title, Axis::linear("hub rate", rate.unit), vec![panel]))
}

/// Segments as long as the record allows.
fn averaged(x: &[f64], y: &[f64], period_s: f64) -> Option<Spectra> {
    let segment = SEGMENT.0.min(2 * x.len() / (SEGMENT.1 + 1)) / 2 * 2;
    welch(x, y, period_s, WelchOptions { segment, confidence: 0.95 }).ok()
}

fn response(tracks: &[Track], recording: &str) -> Option<Figure> {
    let (control, rate) = (track(tracks, recording, "control")?, track(tracks, recording, "hub_rate")?);
    let of = |run: &Run| averaged(run.2(control), run.2(rate), rate.period_s);
    let measured = of(&RUNS[0])?;
    let drawn = |k: &usize| measured.coherence[*k] > COHERENT && measured.frequency_hz[*k] > 0.0;
    let indices: Vec<usize> = (1..measured.frequency_hz.len()).filter(drawn).collect();
    if indices.len() < DRAWN {
        return None;
    }
    let line = |name: &str, colour, values: &[f64], at: &Spectra| {
        let finite = indices.iter().filter(|k| values.get(**k).is_some_and(|v| v.is_finite()));
        Series::solid(name, colour, finite.map(|&k| (at.frequency_hz[k], values[k])))
    };
    let (mut gains, mut phases) = (Vec::new(), Vec::new());
    for run in RUNS.iter().filter(|run| !run.2(rate).is_empty()) {
        let Some(found) = of(run) else { continue };
        let phase: Vec<f64> = found.transfer.iter().map(|c| c.arg().to_degrees()).collect();
        gains.push(line(run.0, run.1, &found.ratio_db(), &found));
        phases.push(line(run.0, run.1, &phase, &found));
    }
    let panels = vec![
        Panel::new(Axis::linear("gain", "dB re rad/s per V"), gains).with_height(200.0),
        Panel::new(Axis::linear("phase", "deg").over(-180.0, 180.0), phases).with_height(120.0),
    ];
    let title = format!("{recording}: control to hub rate");
    Some(Figure::new(&title, Axis::logarithmic("frequency", "Hz"), panels))
}

fn spectrum(track: &Track) -> Option<Figure> {
    if track.channel != "control" && track.channel != "hub_rate" {
        return None;
    }
    let line = |name: &str, colour, series: &[f64]| {
        let found = averaged(series, series, track.period_s)?;
        let pairs = found.frequency_hz.iter().zip(&found.pxx).skip(1);
        Some(Series::solid(name, colour, pairs.map(|(f, p)| (*f, p.sqrt())).filter(|p| p.1 > 0.0)))
    };
    let error = |run: &[f64]| -> Vec<f64> { run.iter().zip(&track.measured).map(|(s, m)| s - m).collect() };
    let mut series = vec![
        line("measured", Colour::Muted, &track.measured)?,
        line("error of the model as it was", Colour::Second, &error(&track.before)).unwrap_or_else(nothing),
    ];
    if !track.after.is_empty() {
        series.extend(line("error of the improved model", Colour::First, &error(&track.after)));
    }
    series.retain(|s| !s.points.is_empty());
    let unit = format!("{}/\u{221A}Hz", track.unit);
    let panel = Panel::new(Axis::logarithmic("density", &unit), series).with_height(220.0);
    let title = format!("{}: {}", track.recording, track.channel.replace('_', " "));
    Some(Figure::new(&title, Axis::logarithmic("frequency", "Hz"), vec![panel]))
}

fn nothing() -> Series {
    Series::solid("", Colour::Muted, Vec::new())
}

/// Whiteness and cross-correlation of every residual, before and after.
fn tests(tracks: &[Track]) -> Section {
    let columns = [
        Column::Text("recording"),
        Column::Text("channel"),
        Column::Text("model"),
        Column::Number("lags outside the band of white noise"),
        Column::Number("correlation with the control / band"),
        Column::Number("with the hub rate / band"),
    ];
    let mut table =
        Table::new("Is anything left in the residuals? 5 % and below 1 are what noise gives", &columns);
    let mut figures = Vec::new();
    for track in tracks {
        let found = [("as it was", &track.before), ("improved", &track.after)]
            .map(|(name, run)| (name, test(tracks, track, run)));
        for (name, test) in &found {
            table.rows.extend(test.as_ref().map(|test| row(track, name, test)));
        }
        if track.channel == "control" || track.channel == "hub_rate" {
            figures.extend(autocorrelation(track, &found));
        }
    }
    figures.truncate(DRAWN);
    Section::new("Residual tests").listing(table).showing(figures)
}

fn test(tracks: &[Track], track: &Track, run: &[f64]) -> Option<ResidualTest> {
    let residual: Vec<f64> = run.iter().zip(&track.measured).map(|(s, m)| s - m).collect();
    let drivers = ["control", "hub_rate"]
        .map(|name| self::track(tracks, &track.recording, name).map(|t| (name, &t.measured[..])));
    let drivers: Vec<(&'static str, &[f64])> = drivers.into_iter().flatten().collect();
    test_residual(&residual, &drivers)
}

fn row(track: &Track, model: &str, test: &ResidualTest) -> Vec<Cell> {
    let share = Cell::text(format!("{:.0} %", 100.0 * test.outside));
    let of = |name: &str| {
        let found = test.cross.iter().find(|c| c.with == name && track.channel != name);
        found.map_or_else(
            || Cell::text("\u{2013}"),
            |c| {
                let size = format!("{:.1}", c.size());
                if c.size() < 1.0 { Cell::Verdict(Tone::Good, size) } else { Cell::text(size) }
            },
        )
    };
    vec![
        Cell::text(&track.recording),
        Cell::text(track.channel.replace('_', " ")),
        Cell::text(model),
        share,
        of("control"),
        of("hub_rate"),
    ]
}

fn autocorrelation(track: &Track, found: &[(&str, Option<ResidualTest>); 2]) -> Option<Figure> {
    let colours = [Colour::Second, Colour::First];
    let line = |((name, test), colour): (&(&str, Option<ResidualTest>), Colour)| {
        let values = test.as_ref()?.autocorrelation.iter().enumerate();
        Some(Series::solid(name, colour, values.map(|(k, r)| (1e3 * k as f64 * track.period_s, *r))))
    };
    let series: Vec<Series> = found.iter().zip(colours).filter_map(line).collect();
    let band = found.iter().find_map(|(_, test)| test.as_ref())?.band;
    let marks = [band, -band].map(|y| Mark::Level { y, text: "95 % band of white noise".to_owned() });
    let panel = Panel::new(Axis::linear("autocorrelation", "").over(-1.0, 1.0), series)
        .with_height(150.0)
        .with_marks(marks.to_vec());
    let title = format!("{}: residual of {}", track.recording, track.channel.replace('_', " "));
    Some(Figure::new(&title, Axis::linear("lag", "ms"), vec![panel]))
}
