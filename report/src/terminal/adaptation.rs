//! What `counterpoise adapt` prints of its runs.

use counterpoise_pipeline::studies::adapt::{AdaptRun, AdaptedIntervals};

use super::add_line;
use crate::wording::adaptation::describe_run;

/// Returns the lines on the runs of an adaptation, interval by interval.
pub fn adaptation_lines(runs: &[AdaptRun], adapted: AdaptedIntervals) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    for run in runs {
        add_line!(lines, "({}) {}", run.kind.letter(), describe_run(run.kind));
        for interval in &run.intervals {
            let [from, to] = interval.from_to_s;
            let verdict = match (interval.adapted, interval.has_returned()) {
                (true, true) => "holds",
                (true, false) => "FAILS",
                (false, _) => "",
            };
            add_line!(
                lines,
                "    {from:5.1} to {to:5.1} s: out-of-balance {:7.2} {}, controller uses {:7.2}; {} {:.3} {} RMS, {:.3} of (a)  {verdict}",
                interval.out_of_balance_kg_m,
                interval.rate.axis.unit("kg m"),
                interval.used_kg_m,
                interval.rate.name(),
                1e3 * interval.hub_rms_rad_s,
                interval.rate.milli_unit(),
                interval.over_default
            );
        }
    }
    add_line!(
        lines,
        "{} of {} adapted intervals are within 10 % of run (a)",
        adapted.returned,
        adapted.intervals
    );
    all
}
