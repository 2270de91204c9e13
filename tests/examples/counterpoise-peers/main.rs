//! One problem of the peers' benchmark, solved and timed: `counterpoise-peers KIND FAMILY N DATA_DIR OUT_DIR`.
//!
//! KIND is care, lyap, zoh, tustin, h2, hinf, bt or freq, or carex and darex with FAMILY and N the group and the number of an
//! example. `DATA_DIR/FAMILY_N` has the matrices as Matrix Market files
//! and the settings as `meta.json`; the answer goes to OUT_DIR as Matrix Market files, a line of JSON with the shortest
//! time in seconds to standard output. A refusal is an answer too: `{"refused": "why"}`.
#![allow(missing_docs, clippy::expect_used, clippy::panic)]

mod collections;
mod files;
mod kinds;

use std::path::Path;
use std::time::Instant;

use collections::Equation;
use kinds::{Answer, Problem};
use serde_json::json;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, family, n, data, out] = arguments.as_slice() else {
        panic!("usage: counterpoise-peers KIND FAMILY N DATA_DIR OUT_DIR")
    };
    let folder = Path::new(data).join(format!("{family}_{n}"));
    let result = if kind == "carex" || kind == "darex" {
        let equation = Equation::read(kind, &folder);
        best_time(|| equation.solve())
    } else {
        let (problem, solve) = (Problem::read(&folder), kinds::solver(kind));
        best_time(|| solve(&problem))
    };
    match result {
        (seconds, Ok(answer)) => {
            files::write(Path::new(out), &answer);
            println!("{}", json!({ "seconds": seconds }));
        }
        (_, Err(why)) => println!("{}", json!({ "refused": why })),
    }
}

/// Runs for half a second or three times, whichever is longer, but no longer than twenty seconds. The time is the shortest;
/// of a run of a millisecond or more the processor's time, where the system tells it: a busy machine interrupts such runs.
fn best_time(run: impl Fn() -> Result<Answer, String>) -> (f64, Result<Answer, String>) {
    let (mut shortest, mut total, mut times) = (f64::INFINITY, 0.0, 0);
    loop {
        let (used, start) = (processor_seconds(), Instant::now());
        let answer = run();
        let wall = start.elapsed().as_secs_f64();
        let seconds = match (used, processor_seconds()) {
            (Some(before), Some(after)) if wall > LONG => wall.min(after - before),
            _ => wall,
        };
        (shortest, total, times) = (seconds.min(shortest), total + wall, times + 1);
        let enough = (times > 3 && total > 0.5) || total > 20.0;
        if enough || answer.is_err() {
            return (shortest, answer);
        }
    }
}

/// Above this many seconds the processor's time is read well enough.
const LONG: f64 = 1e-3;

/// The processor time of this thread so far; the kernel books it when the thread gives way.
fn processor_seconds() -> Option<f64> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}
