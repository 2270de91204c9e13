//! Solves the problems that come in on standard input, one JSON object a line, and writes one JSON object a line: the
//! answer, `refused` with a reason, `failed` with an error, or `panicked`. The scripts in `tests/peers/linear` judge the answers.
//! A problem with `repeat_s` is solved again and again for so many seconds, and `seconds` is the shortest time.
#![allow(non_snake_case, clippy::print_stdout)]

use std::cell::Cell;
use std::io::BufRead;
use std::time::Instant;

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    C64, Mat, Outcome, Riccati,
    sparse::{Entry, Sparse},
};
use counterpoise_lti::{Descriptor, Discretisation, QuadraticCost, StateSpace, Timebase};
use counterpoise_reduce::{
    LargeStructure, Method, Order, balred, balred_large, error_at, minimal_realisation,
};
use counterpoise_report::wording::design_findings::describe_synthesis_error;
use counterpoise_report::wording::reduction::describe_reduction_warning;
use counterpoise_synth::{Error as SynthesisError, GeneralisedPlant, HInfinity, hinfsyn};
use serde_json::{Map, Value, json};

type Answer = Result<Value, String>;

fn main() {
    std::panic::set_hook(Box::new(|_| ()));
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let Ok(problem) = serde_json::from_str::<Value>(&line) else { continue };
        let begun = Instant::now();
        let (mut answer, mut seconds) = time_problem(&problem);
        while begun.elapsed().as_secs_f64() < number(&problem, "repeat_s", 0.0) {
            seconds = seconds.min(time_problem(&problem).1);
        }
        answer["seconds"] = json!(seconds);
        println!("{answer}");
    }
}

thread_local! {
    /// Time that the last call of [`measure_time`] took, s; infinite if there was none.
    static SECONDS: Cell<f64> = const { Cell::new(f64::INFINITY) };
}

/// The answer to a problem, and the time that it took, s: that from matrices to matrices if the kind of problem is [`measure_time`], otherwise with the text.
fn time_problem(problem: &Value) -> (Value, f64) {
    SECONDS.set(f64::INFINITY);
    let (answer, seconds) = run_clocked(|| std::panic::catch_unwind(|| solve(problem)));
    let answer = match answer {
        Ok(Ok(value)) => value,
        Ok(Err(why)) => json!({ "failed": why }),
        Err(_) => json!({ "panicked": true }),
    };
    (answer, seconds.min(SECONDS.get()))
}

/// Returns what a computation returns; its time is that of the problem.
fn measure_time<T>(run: impl FnOnce() -> T) -> T {
    let (found, seconds) = run_clocked(run);
    SECONDS.set(seconds);
    found
}

/// Returns what a computation returns, and the time that it took, s: the processor's time, or the time of the clock if that is below a millisecond, because
/// reading the processor's time takes some microseconds.
fn run_clocked<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let (before, start) = (processor_seconds(), Instant::now());
    let found = run();
    let elapsed = start.elapsed().as_secs_f64();
    (found, if elapsed < 1e-3 { elapsed } else { processor_seconds() - before })
}

/// The processor's time of this thread in seconds, which a busy machine does not change; zero if the system does not tell.
fn processor_seconds() -> f64 {
    // The kernel books the time of a thread when it gives way.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|word| word.parse::<f64>().ok()).map_or(0.0, |ns| 1e-9 * ns)
}

fn solve(problem: &Value) -> Answer {
    match problem["kind"].as_str().unwrap_or_default() {
        "care" | "dare" | "care_g" => riccati(problem),
        "gcare" | "gdare" => generalised_riccati(problem),
        "glyap" => whole_solution(linalg::glyap(
            &matrix(problem, "A")?,
            &matrix(problem, "E")?,
            &matrix(problem, "Q")?,
        )),
        "gdlyap" => whole_solution(linalg::gdlyap(
            &matrix(problem, "A")?,
            &matrix(problem, "E")?,
            &matrix(problem, "Q")?,
        )),
        "hinfsyn" | "level" => hinfinity(problem),
        "place" => placement(problem),
        "delayed" => delay_margins(problem),
        "multiloop" => multiloop(problem),
        "lyap" => {
            let (A, Q) = (matrix(problem, "A")?, matrix(problem, "Q")?);
            whole_solution(measure_time(|| linalg::lyap(&A, &Q)))
        }
        "dlyap" => {
            let (A, Q) = (matrix(problem, "A")?, matrix(problem, "Q")?);
            whole_solution(measure_time(|| linalg::dlyap(&A, &Q)))
        }
        "sylvester" => whole_solution(linalg::sylvester(
            &matrix(problem, "A")?,
            &matrix(problem, "B")?,
            &matrix(problem, "C")?,
        )),
        "zeros" | "mzeros" => {
            let g = system(problem)?;
            values(measure_time(|| counterpoise_lti::zeros(&g)))
        }
        "poles" => values(counterpoise_lti::poles(&system(problem)?)),
        "linfnorm" => {
            let (g, tolerance) = (system(problem)?, number(problem, "tolerance", 1e-10));
            peak(measure_time(|| counterpoise_lti::linfnorm(&g, tolerance)))
        }
        "hinfnorm" => {
            peak(counterpoise_lti::hinfnorm(&system(problem)?, number(problem, "tolerance", 1e-10)))
        }
        "bounds" => bounds(problem),
        "c2d" | "c2d_delayed" | "d2c" => mapped_system(problem),
        "cost" => period_cost(problem),
        "minimal" => minimal_part(problem),
        "mh2" => square_norm(counterpoise_lti::h2norm(&system(problem)?)),
        "h2norm" => {
            let g = system(problem)?;
            Ok(json!({ "value": text(measure_time(|| counterpoise_lti::h2norm(&g)))? }))
        }
        "margins" => margins(problem),
        "descriptor" => descriptor(problem),
        "balred" => reduction(problem),
        "balred_large" => large_reduction(problem),
        other => Err(format!("unknown kind {other}")),
    }
}

fn text<T, E: std::fmt::Display>(result: Result<T, E>) -> Result<T, String> {
    result.map_err(|why| why.to_string())
}

/// A matrix as a list of rows; one without rows or columns as `{"rows": 0, "cols": 3}`.
fn matrix(problem: &Value, key: &str) -> Result<Mat, String> {
    let value = &problem[key];
    let size = |name: &str| value[name].as_u64().map(|n| n as usize);
    if let (Some(rows), Some(cols)) = (size("rows"), size("cols")) {
        return Ok(Mat::zeros(rows, cols));
    }
    let rows = value.as_array().ok_or(format!("no matrix {key}"))?;
    let entries = |row: &Value| -> Vec<f64> {
        row.as_array().map_or(Vec::new(), |row| row.iter().map(|e| e.as_f64().unwrap_or(f64::NAN)).collect())
    };
    Ok(Mat::from_rows(&rows.iter().map(entries).collect::<Vec<_>>()))
}

fn number(problem: &Value, key: &str, default: f64) -> f64 {
    problem[key].as_f64().unwrap_or(default)
}

fn system(problem: &Value) -> Result<StateSpace, String> {
    let timebase = match problem["period"].as_f64() {
        Some(period_s) => Timebase::Discrete { period_s },
        None => Timebase::Continuous,
    };
    let get = |key| matrix(problem, key);
    text(StateSpace::new(get("A")?, get("B")?, get("C")?, get("D")?, timebase))
}

fn rows(M: &Mat) -> Value {
    json!((0..M.nrows()).map(|i| M.row_vec(i)).collect::<Vec<_>>())
}

fn complex(list: &[C64]) -> Value {
    json!(list.iter().map(|l| [l.re, l.im]).collect::<Vec<_>>())
}

fn whole_solution(solution: Result<Mat, linalg::Error>) -> Answer {
    Ok(json!({ "X": rows(&text(solution)?) }))
}

fn values(list: Result<Vec<C64>, counterpoise_lti::Error>) -> Answer {
    Ok(json!({ "values": complex(&text(list)?) }))
}

fn peak(found: Result<counterpoise_lti::Peak, counterpoise_lti::Error>) -> Answer {
    let found = text(found)?;
    Ok(json!({ "value": found.value, "rate": found.rate_rad_s, "infinite": found.value.is_infinite() }))
}

fn square_norm(found: Result<f64, counterpoise_lti::Error>) -> Answer {
    let value = text(found)?;
    Ok(json!({ "value": value, "infinite": value.is_infinite() }))
}

fn bounds(problem: &Value) -> Answer {
    let found =
        text(counterpoise_lti::linfnorm_bounds(&system(problem)?, number(problem, "tolerance", 1e-10)))?;
    Ok(json!({ "value": found.lower.value, "rate": found.lower.rate_rad_s, "upper": found.upper }))
}

/// The sampled system, or the continuous one of a sampled one.
fn mapped_system(problem: &Value) -> Answer {
    if problem["kind"] == "d2c" {
        return Ok(whole_system(&text(counterpoise_lti::d2c_tustin(&system(problem)?, None))?));
    }
    let (g, period_s) = (system(problem)?, number(problem, "h", 1.0));
    let method = match problem["method"].as_str() {
        Some("foh") => Discretisation::FirstOrderHold,
        Some("tustin") => Discretisation::Tustin { prewarp_rad_s: None },
        _ => Discretisation::ZeroOrderHold,
    };
    let made = match problem["delay"].as_f64() {
        Some(delay_s) => counterpoise_lti::c2d_delayed(&g, period_s, delay_s),
        None => counterpoise_lti::c2d(&g, period_s, method),
    };
    Ok(whole_system(&text(made)?))
}

/// The weights of state and input over one period, as one matrix.
fn period_cost(problem: &Value) -> Answer {
    let (Q, R, S) = (matrix(problem, "Q")?, matrix(problem, "R")?, matrix(problem, "S")?);
    let cost = QuadraticCost { Q: &Q, R: &R, S: &S };
    let (A, B) = (matrix(problem, "A")?, matrix(problem, "B")?);
    let made = text(counterpoise_lti::sampled_cost(&A, &B, cost, number(problem, "h", 1.0)))?;
    Ok(json!({ "X": rows(&made.Q.hstack(&made.S).vstack(&made.S.t().hstack(&made.R))) }))
}

fn minimal_part(problem: &Value) -> Answer {
    let found = text(minimal_realisation(&system(problem)?, number(problem, "tolerance", 1e-11)))?;
    let mut answer = whole_system(&found.system);
    answer["kept"] = json!(found.smallest_kept);
    answer["dropped"] = json!(found.largest_dropped);
    Ok(answer)
}

fn whole_system(g: &StateSpace) -> Value {
    json!({ "A": rows(&g.A), "B": rows(&g.B), "C": rows(&g.C), "D": rows(&g.D) })
}

fn riccati(problem: &Value) -> Answer {
    let get = |key| matrix(problem, key);
    let cross = if problem["S"].is_null() { None } else { Some(get("S")?) };
    let kind = problem["kind"].as_str().unwrap_or_default();
    if kind == "care_g" {
        return solution_json(text(linalg::care_g(&get("A")?, &get("G")?, &get("Q")?))?);
    }
    let solver = if kind == "care" { linalg::care } else { linalg::dare };
    let (A, B, Q, R) = (get("A")?, get("B")?, get("Q")?, get("R")?);
    solution_json(text(measure_time(|| solver(&A, &B, &Q, &R, cross.as_ref())))?)
}

fn generalised_riccati(problem: &Value) -> Answer {
    let get = |key| matrix(problem, key);
    let (Q, R) = (get("Q")?, get("R")?);
    let weights = linalg::CostWeights { Q: &Q, R: &R, S: None };
    let (A, E, B) = (get("A")?, get("E")?, get("B")?);
    solution_json(text(match problem["kind"].as_str() {
        Some("gcare") => linalg::gcare(&A, &E, &B, &weights),
        _ => linalg::gdare(&A, &E, &B, &weights),
    })?)
}

fn solution_json(outcome: Outcome<Riccati>) -> Answer {
    let Riccati { X, F, closed_loop, certificate } = match outcome {
        Outcome::Solved(found) => found,
        Outcome::Infeasible(reason) => return Ok(json!({ "refused": reason.to_string() })),
    };
    Ok(json!({
        "X": rows(&X), "F": rows(&F), "closed_loop": complex(&closed_loop),
        "condition": certificate.condition, "separation": certificate.separation,
        "relative_residual": certificate.relative_residual, "forward_error": rows(&certificate.forward_error),
        "residual_norm": certificate.residual_norm, "term_norm": certificate.term_norm,
        "sensitive": certificate.is_sensitive(), "method": certificate.method.to_string(),
        "steps": certificate.newton_steps,
    }))
}

fn margins(problem: &Value) -> Answer {
    let found = text(counterpoise_lti::margins(&system(problem)?))?;
    let gain: Vec<[f64; 2]> = found.gain.iter().map(|m| [m.factor, m.rate_rad_s]).collect();
    let phase: Vec<[f64; 3]> = found.phase.iter().map(|m| [m.deg, m.rate_rad_s, m.delay_s]).collect();
    Ok(json!({
        "gain": gain, "phase": phase, "delay": found.delay_s, "ms": found.ms.value, "mt": found.mt.value,
        "alpha": found.disk.alpha, "stable": found.closed_loop_stable,
        "all_pass": found.is_all_pass,
    }))
}

fn descriptor(problem: &Value) -> Answer {
    let descriptor = text(Descriptor::new(matrix(problem, "E")?, system(problem)?))?;
    let found = text(descriptor.reduce_index())?;
    let mut answer = Map::new();
    for (key, M) in
        [("A", &found.system.A), ("B", &found.system.B), ("C", &found.system.C), ("D", &found.system.D)]
    {
        answer.insert(key.into(), rows(M));
    }
    answer.insert("derivatives".into(), json!(found.derivatives.iter().map(rows).collect::<Vec<_>>()));
    answer.insert("rounds".into(), json!(found.rounds));
    Ok(Value::Object(answer))
}

fn reduction(problem: &Value) -> Answer {
    let order = Order::States(number(problem, "order", 1.0) as usize);
    let found = text(balred(&system(problem)?, order, Method::SquareRoot))?;
    Ok(json!({
        "A": rows(&found.system.A), "B": rows(&found.system.B), "C": rows(&found.system.C), "D": rows(&found.system.D),
        "measured": found.measured_error.value, "bound": found.bound, "hankel": found.hankel,
        "kept": found.kept, "untouched": found.untouched,
    }))
}

fn hinfinity(problem: &Value) -> Answer {
    let count = |key| problem[key].as_u64().unwrap_or(0) as usize;
    let plant = text(GeneralisedPlant::new(system(problem)?, count("controls"), count("measurements")))?;
    let found = match hinfsyn(&plant, number(problem, "tolerance", 1e-6)) {
        Err(why @ SynthesisError::Refused(_)) => {
            return Ok(json!({ "refused": describe_synthesis_error(&why) }));
        }
        other => text(other)?,
    };
    let HInfinity { controller: K, bound, achieved_norm, unreachable, trials, .. } = found;
    Ok(json!({
        "A": rows(&K.A), "B": rows(&K.B), "C": rows(&K.C), "D": rows(&K.D), "bound": bound, "value": achieved_norm,
        "unreachable": unreachable, "trials": trials,
    }))
}

fn placement(problem: &Value) -> Answer {
    let list = problem["poles"].as_array().ok_or("no poles")?;
    let part = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let wanted: Vec<C64> = list.iter().map(|p| C64::new(part(&p[0]), part(&p[1]))).collect();
    let found = text(counterpoise_lti::place(&matrix(problem, "A")?, &matrix(problem, "B")?, &wanted))?;
    Ok(json!({ "F": rows(&found.F), "values": complex(&found.poles), "condition": found.condition }))
}

fn delay_margins(problem: &Value) -> Answer {
    let delay_s = number(problem, "delay", 0.0);
    let found = text(counterpoise_lti::margins_with_delay(&system(problem)?, delay_s))?;
    let gain: Vec<[f64; 2]> = found.margins.gain.iter().map(|m| [m.factor, m.rate_rad_s]).collect();
    let phase: Vec<[f64; 3]> = found.margins.phase.iter().map(|m| [m.deg, m.rate_rad_s, m.delay_s]).collect();
    Ok(json!({
        "gain": gain, "phase": phase, "delay": found.margins.delay_s, "ms": found.margins.ms.value, "mt": found.margins.mt.value,
        "alpha": found.margins.disk.alpha, "unstable": found.unstable_poles,
        "least_gain": found.least_gain,
    }))
}

fn multiloop(problem: &Value) -> Answer {
    let found = text(counterpoise_lti::multiloop_margins(&system(problem)?))?;
    let each: Vec<f64> = found.each.iter().map(|margin| margin.alpha).collect();
    Ok(json!({
        "each": each, "diagonal": found.diagonal.alpha, "proved": found.diagonal_proved.alpha, "full": found.full.alpha,
        "stable": found.closed_loop_stable,
    }))
}

/// A sparse matrix as lists of rows, columns and values.
fn sparse_matrix(problem: &Value, key: &str, size: usize) -> Result<Sparse, String> {
    let list = |k: usize| problem[key][k].as_array().ok_or(format!("{key} is missing"));
    let (rows, cols, values) = (list(0)?, list(1)?, list(2)?);
    let place = |value: &Value| value.as_u64().unwrap_or(u64::MAX) as usize;
    let all = rows.iter().zip(cols).zip(values).map(|((row, col), value)| Entry {
        row: place(row),
        col: place(col),
        value: value.as_f64().unwrap_or(f64::NAN),
    });
    text(Sparse::from_entries(size, size, &all.collect::<Vec<_>>()))
}

/// Hankel values, the estimated bound, and the error at some rates.
fn large_reduction(problem: &Value) -> Answer {
    let F = matrix(problem, "F")?;
    let n = F.nrows();
    let (M, C, K) =
        (sparse_matrix(problem, "M", n)?, sparse_matrix(problem, "D", n)?, sparse_matrix(problem, "K", n)?);
    let g = LargeStructure { M, C, K, F, P: matrix(problem, "P")?, V: matrix(problem, "V")? };
    let order = Order::States(number(problem, "order", 10.0) as usize);
    let made = text(balred_large(&g, order, &mut |_| std::ops::ControlFlow::Continue(())))?;
    let rates = problem["rates"].as_array().cloned().unwrap_or_default();
    let errors: Result<Vec<f64>, String> =
        rates.iter().filter_map(Value::as_f64).map(|w| text(error_at(&g, &made.system, w))).collect();
    Ok(json!({
        "hankel": made.hankel, "bound": made.estimated_bound, "steps": made.steps, "errors": errors?,
        "warnings": made.warnings.iter().map(describe_reduction_warning).collect::<Vec<_>>(),
    }))
}
