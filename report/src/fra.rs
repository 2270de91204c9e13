//! The report of the frequency response analyser: gain and phase over frequency for every amplitude, beside the linear models.

use counterpoise_pipeline::studies::fra::{Map, Point};

use crate::bode::{BodeCurve, Phase, ResponsePoint, bode_figure};
use crate::wording::capitalise_first;
use crate::{Cell, Column, Headline, ProvenanceEntry, Report, Section, Table, Tile, Tone};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Panel, Series};

/// How long the measuring of a map took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Threads that it was measured on.
    pub threads: usize,
    /// Time, s.
    pub seconds: f64,
}

impl Pace {
    /// Returns how many times as fast as the first of a list, which is on one thread.
    pub fn speed_up(&self, all: &[Pace]) -> f64 {
        all.first().map_or(1.0, |first| first.seconds / self.seconds)
    }
}

/// Returns the report of one or more maps of one machine, and of how fast they were measured.
pub fn fra_report(maps: &[Map], speed: &[Pace], command: &str) -> Report {
    let first = maps.first();
    let name = first.map_or("", |map| map.name.as_str());
    Report {
        title: format!("Frequency responses of {name}"),
        subtitle: first.map(|map| map.words()).unwrap_or_default(),
        headline: headline(maps),
        tiles: first.map(tiles).unwrap_or_default(),
        verdicts: first.map(extremes).unwrap_or_else(|| Table::new("", &[])),
        glance: first.map(|map| overview(map, command)).into_iter().collect(),
        sections: maps.iter().flat_map(|map| sections(map, command)).chain(pace(maps, speed)).collect(),
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

fn headline(maps: &[Map]) -> Headline {
    let points: Vec<&Point> = maps.iter().flat_map(|map| &map.points).collect();
    let unsettled = points.iter().filter(|p| !p.settled).count();
    let text = match unsettled {
        0 => format!("{} points measured, every one settled", points.len()),
        n => format!("{} points measured, {n} not settled or not excited", points.len()),
    };
    let spread = maps.first().map_or(0.0, widest_spread);
    let detail =
        format!("At one frequency the gain changes with the amplitude by up to {} dB.", short_number(spread));
    Headline { tone: if unsettled == 0 { Tone::Neutral } else { Tone::Bad }, text, detail }
}

/// Returns a sentence for each amplitude at which the joint sticks, with the next amplitude of the map that moves it at all of those frequencies.
pub fn sticking_lines(map: &Map) -> Vec<String> {
    let unit = &map.signals.input_unit;
    let all = families(map);
    let line = |family: &Family<'_>| {
        let stuck: Vec<f64> = family.points.iter().filter(|p| sticks(p)).map(|p| p.frequency_hz).collect();
        let (first, last) = (stuck.first()?, stuck.last()?);
        let moves = |other: &&Family<'_>| {
            let moving = |p: &&Point| !(sticks(p) && stuck.contains(&p.frequency_hz));
            other.amplitude > family.amplitude && other.points.iter().all(moving)
        };
        let larger = all.iter().filter(moves).map(|other| other.amplitude).min_by(f64::total_cmp);
        let next = match larger {
            Some(size) => format!("{} {unit} moves it", short_number(size)),
            None => "no larger amplitude of this map moves it: measure with larger --amplitudes".to_owned(),
        };
        let place = match first == last {
            true => format!("{} Hz", short_number(*first)),
            false => format!(
                "{} of its frequencies from {} to {} Hz",
                stuck.len(),
                short_number(*first),
                short_number(*last)
            ),
        };
        let (size, output) = (short_number(family.amplitude), map.signals.output);
        Some(format!(
            "the joint sticks at {size} {unit}, at {place}, and the {output} does not respond; {next}"
        ))
    };
    all.iter().filter_map(line).collect()
}

/// Returns whether nothing moves at a point: there is no response whose gain could be told in dB.
pub fn sticks(point: &Point) -> bool {
    point.gain_db == f64::NEG_INFINITY
}

/// The points of one amplitude; of a recording the amplitude is NaN.
struct Family<'a> {
    amplitude: f64,
    points: Vec<&'a Point>,
}

/// Returns the points of each amplitude, in the order of the map.
fn families(map: &Map) -> Vec<Family<'_>> {
    let mut out: Vec<Family<'_>> = Vec::new();
    if map.recording.is_some() {
        return vec![Family { amplitude: f64::NAN, points: map.points.iter().collect() }];
    }
    for point in &map.points {
        match out.last_mut() {
            Some(family) if family.amplitude == point.amplitude => family.points.push(point),
            _ => out.push(Family { amplitude: point.amplitude, points: vec![point] }),
        }
    }
    out
}

fn label(map: &Map, amplitude: f64) -> String {
    if amplitude.is_nan() {
        "recorded".to_owned()
    } else {
        format!("{} {}", short_number(amplitude), map.signals.input_unit)
    }
}

fn curve(name: &str, colour: Colour, points: &[&Point], of: fn(&Point) -> Option<[f64; 2]>) -> BodeCurve {
    let at = |p: &&Point| of(p).map(|h| ResponsePoint::new(p.frequency_hz, h[0], h[1]));
    BodeCurve::new(name, colour, points.iter().filter_map(at).collect())
}

/// Returns all amplitudes in one diagram, the linear model dashed.
fn overview(map: &Map, command: &str) -> Figure {
    let families = families(map);
    let mut curves: Vec<BodeCurve> = families
        .iter()
        .zip(Colour::CYCLE)
        .map(|(family, colour)| {
            curve(&label(map, family.amplitude), colour, &family.points, |p| Some(p.response))
        })
        .collect();
    if let Some(Family { points, .. }) = families.first() {
        curves.push(curve("linear", Colour::Muted, points, |p| Some(p.linear)).with_dashes());
    }
    let figure = bode_figure(
        "Measured at every amplitude",
        &map.signals.gain_unit(),
        &curves,
        Phase::Shown,
        Vec::new(),
    );
    let figure = figure.with_caption("Dashed: the linear model without dry friction, sampled exactly.");
    Figure { command: command.to_owned(), ..figure }
}

fn sections(map: &Map, command: &str) -> Vec<Section> {
    let title = map.recording.clone().unwrap_or_else(|| "Describing functions".to_owned());
    let mut beside = Section::new(&title)
        .saying(
            "Each amplitude beside the linear model with dry friction replaced by its describing function, at the swing of the hub \
             that this model gives itself. It leaves out harmonics, the bias that the weight gives to friction, and backlash.",
        )
        .showing(families(map).iter().zip(Colour::CYCLE).map(|(family, colour)| {
            let figure = beside_models(map, family, colour);
            Figure { command: command.to_owned(), ..figure }
        }));
    for line in sticking_lines(map) {
        beside = beside.saying(format!("{}.", capitalise_first(&line)));
    }
    for remark in &map.remarks {
        beside = beside.saying(remark);
    }
    let harmonics = Section::new("Harmonics and mean").showing([harmonics(map, command)]);
    vec![beside, harmonics, Section::new("Every point").listing(points_table(map))]
}

/// Returns how fast the maps were measured; nothing for recordings, which were not simulated.
fn pace(maps: &[Map], speed: &[Pace]) -> Option<Section> {
    let simulated_s: f64 = maps.iter().map(|map| map.simulated_s).sum();
    let columns = [
        Column::Number("threads"),
        Column::Number("time [s]"),
        Column::Number("times real time"),
        Column::Number("times as fast as on the first row"),
    ];
    let mut table =
        Table::new(&format!("{} s of motion were simulated", short_number(simulated_s)), &columns);
    for pace in speed {
        table.rows.push(vec![
            Cell::text(pace.threads.to_string()),
            Cell::number(pace.seconds),
            Cell::number(simulated_s / pace.seconds),
            Cell::number(pace.speed_up(speed)),
        ]);
    }
    let alone = "counterpoise fra --scaling measures the map on fewer threads as well; the map is the same to the last bit.";
    (!speed.is_empty()).then(|| Section::new("How fast it was measured").saying(alone).listing(table))
}

fn beside_models(map: &Map, family: &Family<'_>, colour: Colour) -> Figure {
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
    let kept: Vec<BodeCurve> = curves.into_iter().filter(|c| !c.points.is_empty()).collect();
    bode_figure(&name, &map.signals.gain_unit(), &kept, Phase::Shown, Vec::new())
}

fn harmonics(map: &Map, command: &str) -> Figure {
    let of = |y: fn(&Point) -> f64| -> Vec<Series> {
        let families = families(map);
        let series = families.iter().zip(Colour::CYCLE).map(|(Family { amplitude, points }, colour)| {
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

fn db(h: [f64; 2]) -> f64 {
    20.0 * h[0].hypot(h[1]).log10()
}

/// Returns the largest difference of gain between amplitudes at one frequency, dB.
fn widest_spread(map: &Map) -> f64 {
    let families = families(map);
    let count = families.iter().map(|family| family.points.len()).min().unwrap_or(0);
    let spread = |k: usize| {
        let gains = families.iter().map(|family| family.points[k].gain_db);
        gains.clone().fold(f64::MIN, f64::max) - gains.fold(f64::MAX, f64::min)
    };
    (0..count).map(spread).fold(0.0, f64::max)
}

fn tiles(map: &Map) -> Vec<Tile> {
    let largest = map.points.iter().map(|p| p.gain_db).fold(f64::MIN, f64::max);
    let distortion = map.points.iter().map(|p| p.distortion).fold(0.0, f64::max);
    let relative = map.signals.gain_unit();
    let unit = if relative.is_empty() { "dB".to_owned() } else { format!("dB re {relative}") };
    vec![
        Tile::plain("points", map.points.len().to_string(), ""),
        Tile::plain("largest gain", short_number(largest), &unit),
        Tile::plain("spread over amplitudes", short_number(widest_spread(map)), "dB")
            .with_note("0 on a linear machine"),
        Tile::plain("largest harmonics", short_number(100.0 * distortion), "%")
            .with_note("of the fundamental"),
    ]
}

/// Returns one row an amplitude: where the gain is largest, and how far the models are from the measurement.
fn extremes(map: &Map) -> Table {
    let columns = [
        Column::Text("amplitude"),
        Column::Number("largest gain [dB]"),
        Column::Number("at [Hz]"),
        Column::Number("linear [dB]"),
        Column::Number("describing [dB]"),
    ];
    let mut table = Table::new(
        "Each amplitude; linear, describing: how far those models are off, median of the gain",
        &columns,
    );
    for Family { amplitude, points } in families(map) {
        let highest = points.iter().max_by(|a, b| a.gain_db.total_cmp(&b.gain_db));
        let off = |of: fn(&Point) -> Option<[f64; 2]>| {
            let distance = |p: &&Point| of(p).map(|h| (db(h) - p.gain_db).abs());
            median(points.iter().filter_map(distance).collect())
        };
        table.rows.push(vec![
            Cell::text(label(map, amplitude)),
            Cell::number(highest.map_or(f64::NAN, |p| p.gain_db)),
            Cell::number(highest.map_or(f64::NAN, |p| p.frequency_hz)),
            Cell::number(off(|p| Some(p.linear))),
            Cell::number(off(|p| p.describing)),
        ]);
    }
    table
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn points_table(map: &Map) -> Table {
    let columns = [
        Column::Number("amplitude"),
        Column::Number("frequency [Hz]"),
        Column::Number("gain [dB]"),
        Column::Number("phase [deg]"),
        Column::Number("harmonics [%]"),
        Column::Number("cycles"),
        Column::Text("settled"),
    ];
    let mut table = Table::new(&format!("Amplitudes in {}", map.signals.input_unit), &columns);
    for p in &map.points {
        table.rows.push(vec![
            Cell::number(p.amplitude),
            Cell::number(p.frequency_hz),
            Cell::number(p.gain_db),
            Cell::number(p.phase_deg),
            Cell::number(100.0 * p.distortion),
            Cell::number(p.cycles as f64),
            Cell::text(if p.settled { "yes" } else { "no" }),
        ]);
    }
    table
}
