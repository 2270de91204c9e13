//! What `counterpoise fra` prints: response maps, and the speed at which they were measured.

use counterpoise_pipeline::studies::fra::ResponseMap;
use counterpoise_pipeline::studies::fra_summary::MeasuringPace;
use counterpoise_pipeline::studies::fra_totals::MapTotals;

use super::add_line;
use crate::fra::{map_title, sticking_lines};

/// Returns the lines on a response map, with all its points.
pub fn map_lines(map: &ResponseMap) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    let from = map.recording.as_deref().unwrap_or("simulated");
    add_line!(lines, "{}: {} ({from})", map.name, map_title(map));
    add_line!(
        lines,
        "{:>10} {:>10} {:>9} {:>9} {:>11} {:>11} {:>9} {:>11}",
        map.signals.input_unit,
        "Hz",
        "gain dB",
        "phase deg",
        "linear dB",
        "descr. dB",
        "harmonics",
        format!("mean {}", map.signals.output_unit)
    );
    for p in map.points.iter() {
        let described = p.describing_gain_db().map_or("-".to_owned(), |gain| format!("{gain:.2}"));
        let [gain, phase] = match p.sticks() {
            true => ["sticks".to_owned(), "-".to_owned()],
            false => [format!("{:.2}", p.gain_db), format!("{:.2}", p.phase_deg)],
        };
        add_line!(
            lines,
            "{:10.4} {:10.4} {gain:>9} {phase:>9} {:11.2} {described:>11} {:8.2}% {:11.2e}{}",
            p.amplitude,
            p.frequency_hz,
            p.linear_gain_db(),
            100.0 * p.distortion,
            p.mean_rad_s,
            match (p.settled, &map.recording) {
                (true, _) => "",
                (false, None) => "  not settled",
                (false, Some(_)) => "  not excited",
            }
        );
    }
    map.remarks.iter().for_each(|remark| add_line!(lines, "note: {remark}"));
    sticking_lines(map).iter().for_each(|line| add_line!(lines, "note: {line}"));
    all
}

/// Returns the lines on the speed at which maps of these totals were measured, for each number of threads.
pub fn pace_lines(totals: MapTotals, speed: &[MeasuringPace]) -> Vec<String> {
    let MapTotals { points, simulated_s, .. } = totals;
    let line = |pace: &MeasuringPace| {
        let gained = match pace.speed_up(speed) {
            _ if pace.threads == 1 || speed.len() == 1 => String::new(),
            gained => format!(", {gained:.2} times as fast as on one"),
        };
        let times = pace.times_real_time(simulated_s);
        let noun = if pace.threads == 1 { "thread" } else { "threads" };
        format!(
            "{points} points, {simulated_s:.0} s of motion simulated in {:.2} s: {times:.0} times real time on {} {noun}{gained}",
            pace.seconds, pace.threads
        )
    };
    speed.iter().map(line).collect()
}
