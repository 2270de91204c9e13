//! Processor time that Riccati equations take which have no solution, or hardly one, beside benign ones of the same size.
//!
//! `cargo run --release -p counterpoise-tests --example refusals` (Linux: the time is that of this thread alone.)
#![allow(clippy::unwrap_used, non_snake_case)]

use counterpoise_linalg::{Mat, Outcome, Riccati, care, care_g, dare, inverse};

/// Returns the processor time of this thread, s.
fn processor_time_s() -> f64 {
    // The kernel books the time of a thread when it gives way.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}

/// Numbers of a seed.
struct RandomGenerator(u64);

impl RandomGenerator {
    fn next_uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A matrix of about normal numbers.
    fn matrix(&mut self, rows: usize, cols: usize) -> Mat {
        Mat::from_fn(rows, cols, |_, _| (0..12).map(|_| self.next_uniform()).sum::<f64>() - 6.0)
    }
}

fn print(states: usize, problem: &str, solve: impl Fn() -> Outcome<Riccati>) {
    let (mut least_s, mut said) = (f64::INFINITY, String::new());
    for _ in 0..3 {
        let begun = processor_time_s();
        let outcome = solve();
        least_s = least_s.min(processor_time_s() - begun);
        said = match outcome {
            Outcome::Solved(found) => format!("solved: {}", found.certificate),
            Outcome::Infeasible(reason) => format!("refused: {reason}"),
        };
    }
    println!("{states:4} {problem:34} {:8.1} ms  {said}", 1e3 * least_s);
}

/// The matrix with a first state that is alone, with the given pole.
fn isolate_first_state(A: &Mat, pole: f64) -> Mat {
    Mat::from_fn(A.nrows(), A.ncols(), |i, j| match (i, j) {
        (0, 0) => pole,
        (0, _) | (_, 0) => 0.0,
        _ => A[(i, j)],
    })
}

fn without_first_row(B: &Mat) -> Mat {
    Mat::from_fn(B.nrows(), B.ncols(), |i, j| if i == 0 { 0.0 } else { B[(i, j)] })
}

fn problems(states: usize) {
    let mut random = RandomGenerator(states as u64);
    let (A, B, C) =
        (random.matrix(states, states), random.matrix(states, states / 3), random.matrix(states, states));
    let (Q, R) = (&C * &C.t(), Mat::eye(states / 3));
    let T = random.matrix(states, states);
    let back = inverse(&T).unwrap();
    let turned = |A: &Mat| &T * A * &back;
    print(states, "benign", || care(&A, &B, &Q, &R, None).unwrap());
    let (lost, unreached) = (turned(&isolate_first_state(&A, 1.5)), &T * &without_first_row(&B));
    print(states, "unstable mode out of reach", || care(&lost, &unreached, &Q, &R, None).unwrap());
    let seen = without_first_row(&C);
    let weight = (back.t() * (&seen * &seen.t()) * &back).symmetric_part();
    let (still, reached) = (turned(&isolate_first_state(&A, 0.0)), &T * &B);
    print(states, "mode on the axis out of sight", || care(&still, &reached, &weight, &R, None).unwrap());
    let G = ((&B * &B.t()) - Q.scale(0.5)).symmetric_part();
    print(states, "Hamiltonian with modes on the axis", || care_g(&A, &G, &Mat::eye(states)).unwrap());
    let few = random.matrix(states, 2);
    print(states, "two inputs, half unstable", || care(&A, &few, &Q, &Mat::eye(2), None).unwrap());
    let slower = A.scale(1.2 / (states as f64).sqrt());
    print(states, "discrete, benign", || dare(&slower, &B, &Q, &R, None).unwrap());
    let lost = turned(&isolate_first_state(&slower, 1.5));
    print(states, "discrete, out of reach", || dare(&lost, &unreached, &Q, &R, None).unwrap());
    print(states, "discrete, two inputs, many unstable", || dare(&A, &few, &Q, &Mat::eye(2), None).unwrap());
}

fn main() {
    [50, 100, 200].into_iter().for_each(problems);
}
