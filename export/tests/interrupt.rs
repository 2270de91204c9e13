//! The block for the sampling interrupt, as it is generated, between a board's counts: it answers as the controller does between
//! converters.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use counterpoise_controller::{COMMON_READINGS, Controller, READINGS};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{
    CodeOptions, Converters, File, Provenance, Ranges, c99, fixed_c99, plan_fixed_point,
};
use counterpoise_models::reference;
use support::{RandomGenerator, STRICT, folder, is_there, provenance, run, typical_controller, write};

const SAMPLES: usize = 400;

const BOARD: &str = r#"#include <stdint.h>
#include <stdio.h>

void board_read(int32_t counts[6]);
void board_write(int32_t count);
void board_start(void);
void board_sample_interrupt(void);

static int32_t next[6];

void board_read(int32_t counts[6])
{
    for (int i = 0; i < 6; i++) {
        counts[i] = next[i];
    }
}

void board_write(int32_t count)
{
    printf("%ld\n", (long)count);
}

int main(void)
{
    long in[6];
    board_start();
    while (scanf("%ld %ld %ld %ld %ld %ld", &in[0], &in[1], &in[2], &in[3], &in[4], &in[5]) == 6) {
        for (int i = 0; i < 6; i++) {
            next[i] = (int32_t)in[i];
        }
        board_sample_interrupt();
    }
    return 0;
}
"#;

/// Returns the reference rig's own converters.
fn converters() -> Converters {
    Converters::of(&reference::rig())
}

fn origin() -> Provenance {
    Provenance { converters: converters(), ..provenance() }
}

/// Counts of small readings, sample by sample.
fn counts() -> Vec<[i32; COMMON_READINGS]> {
    let mut random = RandomGenerator(11);
    let per_count = converters().units_per_count();
    let sample = |readings: [f64; READINGS]| {
        std::array::from_fn(|i| (0.02 * readings[i] / per_count[i]).round() as i32)
    };
    (0..SAMPLES).map(|_| sample(random.readings())).collect()
}

/// Returns what the generated block writes to the output converter.
fn block_outputs(folder: &Path, files: &[File]) -> Vec<i32> {
    write(folder, files);
    std::fs::write(folder.join("board.c"), BOARD).unwrap();
    let sources = ["axis.c", "axis_interrupt.c", "board.c", "-o", "board"];
    assert_eq!(
        run(Command::new("cc").current_dir(folder).args(STRICT).arg("-ffp-contract=off").args(sources)),
        ""
    );
    let mut rows = String::new();
    for row in counts() {
        writeln!(rows, "{}", row.map(|count| count.to_string()).join(" ")).unwrap();
    }
    let mut started =
        Command::new(folder.join("board")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = started.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || stdin.write_all(rows.as_bytes()).unwrap());
    let output = started.wait_with_output().unwrap();
    feeder.join().unwrap();
    String::from_utf8(output.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

/// Returns what the controller asks for between the same converters.
fn expected_outputs(controller: &Controller) -> Vec<i32> {
    let (per_count, per_volt) = (converters().units_per_count(), converters().counts_per_volt());
    let mut runner = controller.runner();
    let answer = |row: [i32; COMMON_READINGS]| {
        let mut readings = [0.0; READINGS];
        let pairs = readings.iter_mut().zip(per_count).zip(row);
        pairs.for_each(|((reading, one), count)| *reading = one * f64::from(count));
        (runner.step_array(&readings) * per_volt).round().clamp(-2047.0, 2047.0) as i32
    };
    counts().into_iter().map(answer).collect()
}

#[test]
fn the_block_in_double_answers_count_by_count() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controller = typical_controller();
    let files = c99(Unverified(&controller), &origin(), &CodeOptions::double("axis")).unwrap();
    let found = block_outputs(&folder("interrupt_double"), &files);
    assert_eq!(found, expected_outputs(&controller));
    assert!(found.iter().any(|count| count.abs() > 100), "{found:?}");
}

#[test]
fn the_blocks_in_small_numbers_answer_within_a_count() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controller = typical_controller();
    let per_count = converters().units_per_count();
    let history = counts()
        .iter()
        .map(|row| std::array::from_fn(|i| row.get(i).map_or(0.0, |n| per_count[i] * f64::from(*n))))
        .collect();
    let known = Ranges::from_readings(&controller, &[history], 4.0);
    let fixed = plan_fixed_point(&controller, &known, 2.5e-3, SAMPLES).unwrap();
    let kinds = [
        ("single", c99(Unverified(&controller), &origin(), &CodeOptions::single("axis")).unwrap()),
        ("fixed", fixed_c99(Unverified(&controller), &fixed, &origin(), "axis").unwrap()),
    ];
    let expected = expected_outputs(&controller);
    for (kind, files) in &kinds {
        let found = block_outputs(&folder(&format!("interrupt_{kind}")), files);
        assert_eq!(found.len(), SAMPLES);
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).max().unwrap();
        let same = found.iter().zip(&expected).filter(|(a, b)| a == b).count();
        println!("{kind}: {same} of {SAMPLES} counts alike, at most {off} off");
        assert!(off <= 1 && same * 10 > 9 * SAMPLES, "{kind}: {same} alike, {off} off");
    }
}
