//! Condenses a large structure from Matrix Market files and prints times and frequencies as JSON; `tests/peers/linear/large.py`
//! compares them with SciPy's.
//!
//!     cargo run --release -p counterpoise-models --example large_structure FOLDER COUNT [balanced]
//!
//! The folder holds `mass.mtx`, `stiffness.mtx` and `nodes.map`.
#![allow(non_snake_case, clippy::print_stdout, clippy::print_stderr)]

use counterpoise_models::structure::import::{Imported, NodeMap, matrix_market};
use counterpoise_models::structure::{Condensation, Shapes, Support, undamped_modes};
use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("the folder is missing")?;
    let count: usize = arguments.next().ok_or("the number of modes is missing")?.parse()?;
    let read = |name: &str| std::fs::read_to_string(format!("{folder}/{name}"));
    let start = Instant::now();
    let map = NodeMap::parse(&read("nodes.map")?)?;
    let (M, K) = (matrix_market(&read("mass.mtx")?)?, matrix_market(&read("stiffness.mtx")?)?);
    let imported = Imported::from_row_order(&map, M, None, K);
    let read_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let balanced = arguments.next().is_some_and(|word| word == "balanced");
    let shapes = if balanced { Shapes::Balanced } else { Shapes::Modes };
    let wanted = Condensation { modes: count, shapes, damping_ratio: 0.01 };
    let small = imported.to_sparse_structure(&map)?.condense(&wanted, &mut |at| {
        eprintln!("{:8.2} s  {} {}/{}", start.elapsed().as_secs_f64(), at.stage, at.done, at.of);
        ControlFlow::Continue(())
    })?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(left_out) = small.truncation {
        eprintln!("{left_out:?}");
    }
    let hertz = |support: Support| -> Result<String, Box<dyn Error>> {
        let found = undamped_modes(&small, support)?;
        let list: Vec<String> = found.flexible_rad_s().iter().take(count).map(|w| format!("{w:?}")).collect();
        Ok(list.join(", "))
    };
    println!(
        "{{\"unknowns\": {}, \"read_s\": {read_s:.3}, \"condense_s\": {seconds:.3},",
        imported.rows.len()
    );
    println!(" \"pinned\": [{}], \"clamped\": [{}]}}", hertz(Support::Pinned)?, hertz(Support::Clamped)?);
    Ok(())
}
