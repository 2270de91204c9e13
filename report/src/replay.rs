//! The report of a replay: how each recording was followed, how well each channel fits, measured and simulated.

use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};
use counterpoise_recordings::Channel;
use std::collections::BTreeMap;

use counterpoise_pipeline::recordings::ReplayedRecording;
use counterpoise_pipeline::results::{ChannelResult, RecordingResult, ReplayResult};

use counterpoise_pipeline::recordings::amplitude_density::AmplitudeDensity;
use counterpoise_pipeline::recordings::tracks::ChannelTrack;

use crate::diagnosis::{comparison, worst_track};
use crate::tolerance::FITS_FLOORS;
use crate::wording::recordings::describe_replay_mode;
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};

/// Returns the report of replayed recordings and their result.
pub fn replay_report(
    title: &str,
    command: &str,
    result: &ReplayResult,
    replayed: &[ReplayedRecording],
) -> Report {
    let worst = worst_track(replayed.iter().flat_map(|one| &one.tracks));
    Report {
        title: title.to_owned(),
        subtitle: "simulation of the recordings with the model".to_owned(),
        headline: headline(result),
        tiles: tiles(result),
        verdicts: ways(result),
        glance: worst.map(|track| comparison(track, command)).into_iter().collect(),
        sections: result.recordings.iter().zip(replayed).map(|(r, one)| section(r, &one.tracks)).collect(),
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

/// Returns the largest error over its floor, and its channel.
fn largest(channels: &BTreeMap<&'static str, ChannelResult>) -> Option<(f64, &'static str)> {
    let ratios = channels.iter().map(|(name, c)| (c.residual_over_floor, *name));
    ratios.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Returns the largest of all recordings, with its recording.
fn largest_ratio(result: &ReplayResult) -> Option<(f64, &'static str, &str)> {
    let each = result.recordings.iter().filter_map(|r| {
        let (ratio, channel) = largest(&r.channels)?;
        Some((ratio, channel, name(&r.file)))
    });
    each.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Returns a file without its folders.
fn name(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

fn headline(result: &ReplayResult) -> Headline {
    let (tone, text) = match largest_ratio(result) {
        None => (OutcomeTone::Neutral, "No recorded channel can be compared with the model".to_owned()),
        Some((ratio, ..)) if ratio <= FITS_FLOORS => (
            OutcomeTone::Good,
            format!("The model fits every channel to within {FITS_FLOORS} times its noise floor"),
        ),
        Some((ratio, channel, recording)) => {
            let channel = channel.replace('_', " ");
            (
                OutcomeTone::Bad,
                format!("The model does not fit: {channel} of {recording} is off by {ratio:.1} noise floors"),
            )
        }
    };
    let hunting = result.recordings.iter().filter(|r| r.parting.is_some() && r.window_s.is_some()).count();
    let detail = if hunting > 0 { WAYS.to_owned() } else { String::new() };
    Headline { tone, text, detail }
}

const WAYS: &str = "A recording of a machine that hunts cannot be simulated from start to end, because two runs of the same model that differ only in the noise \
     of a gyroscope diverge. The model is therefore started again in each window, from a state that is fitted to the first half of the window, under \
     the recorded control. The recorded control is compared with the control that the recorded controller computes from the recorded measurements.";

fn tiles(result: &ReplayResult) -> Vec<FigureTile> {
    let count = result.recordings.len();
    let over = result.recordings.iter().filter(|r| r.window_s.is_some()).count();
    let mut out = Vec::new();
    if let Some((ratio, channel, recording)) = largest_ratio(result) {
        let tile = FigureTile::plain("largest residual over noise floor", format!("{ratio:.2}"), "");
        out.push(tile.with_note(&format!("{}, {recording}", channel.replace('_', " "))));
    }
    let tile = FigureTile::plain("recordings", count.to_string(), "");
    out.push(tile.with_note(&format!("{} from start to end, {over} over windows", count - over)));
    out
}

fn ways(result: &ReplayResult) -> ReportTable {
    let columns = [
        ReportColumn::Text("recording"),
        ReportColumn::Text("followed"),
        ReportColumn::Text("largest residual over noise floor"),
        ReportColumn::Text("the same from start to end"),
        ReportColumn::Text("two runs of the model diverge by"),
    ];
    let mut table = ReportTable::new("How each recording was followed", &columns);
    let worst = |channels| largest(channels).map_or(String::new(), |(r, name)| format!("{r:.2} in {name}"));
    for r in &result.recordings {
        let way = r.window_s.map_or("from start to end".to_owned(), |s| format!("over windows of {s} s"));
        let free = if r.window_s.is_some() { &r.free } else { &r.channels };
        let parting =
            r.parting.map_or(String::new(), |p| format!("{:.1} noise floors in {}", p.floors, p.channel));
        let cells = [name(&r.file).to_owned(), way, worst(&r.channels), worst(free), parting];
        table.rows.push(cells.into_iter().map(ReportCell::text).collect());
    }
    table
}

fn section(recording: &RecordingResult, tracks: &[ChannelTrack]) -> ReportSection {
    let columns = [
        ReportColumn::Text("channel"),
        ReportColumn::Number("RMS error"),
        ReportColumn::Number("floor"),
        ReportColumn::Number("error over floor"),
        ReportColumn::Number("VAF, %"),
    ];
    let mut table = ReportTable::new(&format!("Followed {}", describe_replay_mode(recording)), &columns);
    for (channel, c) in &recording.channels {
        table.rows.push(vec![
            ReportCell::text(*channel),
            ReportCell::number(c.rms_error),
            ReportCell::number(c.floor),
            ReportCell::text(format!("{:.2}", c.residual_over_floor)),
            ReportCell::text(format!("{:.4}", c.vaf)),
        ]);
    }
    let figures = tracks.iter().filter(|t| matches!(t.channel, Channel::Control | Channel::HubRate));
    let section = ReportSection::new(name(&recording.file)).with_table(table);
    let section =
        recording.remarks.iter().fold(section, |section, remark| section.with_text(remark.as_str()));
    section.with_figures(
        figures.flat_map(|track| [Some(comparison(track, "")), density_figure(track)]).flatten(),
    )
}

/// Returns the amplitude spectral densities of a channel and of what the model leaves of it; `None` if it has none.
fn density_figure(track: &ChannelTrack) -> Option<Figure> {
    let series = |name: &str, colour, found: &AmplitudeDensity| {
        let points: Vec<(f64, f64)> =
            found.frequency_hz.iter().copied().zip(found.density.iter().copied()).collect();
        Series::solid_line(name, colour, points)
    };
    let measured = series("measured", Colour::Muted, &track.measured_density()?);
    let residual = track.residual_density().map(|found| series("residual", Colour::Second, &found));
    let unit = format!("{}/root Hz", track.words.unit);
    let curves = std::iter::once(measured).chain(residual).collect();
    let panel = Panel::new(Axis::logarithmic(track.words.name, &unit), curves);
    let title = format!("Spectrum of {} in {}", track.words.name.replace('_', " "), track.recording);
    let figure = Figure::new(&title, Axis::logarithmic("frequency", "Hz"), vec![panel]);
    Some(figure.with_caption("Amplitude spectral density by Welch's method."))
}
