//! Multipliers against absolute stability limits that are known, and against simulation of the worst nonlinearities.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_verify::certificate::StabilityCriterion;
use counterpoise_verify::certificate::multiplier::{
    FrictionKnowledge, Multiplier, ProofOutcome, search_multiplier,
};
use counterpoise_verify::structured::taylor::{RateInterval, SchurSystem, Taylor};

const RANGE: [f64; 2] = [1e-3, 1e3];

/// numerator / denominator, from the highest power, as a companion form.
fn transfer(numerator: &[f64], denominator: &[f64]) -> StateSpace {
    let n = denominator.len() - 1;
    let lead = denominator[0];
    let A = Mat::from_fn(n, n, |i, j| match (i, j) {
        (0, j) => -denominator[j + 1] / lead,
        (i, j) if i == j + 1 => 1.0,
        _ => 0.0,
    });
    let B = Mat::from_fn(n, 1, |i, _| if i == 0 { 1.0 / lead } else { 0.0 });
    let missing = n - numerator.len();
    let C = Mat::from_fn(1, n, |_, j| if j < missing { 0.0 } else { numerator[j - missing] });
    StateSpace::new(A, B, C, Mat::row(&[0.0]), Timebase::Continuous).unwrap()
}

/// G + 1 / k: a nonlinearity of slopes from 0 to k round G is one of slopes from 0 to infinity round this.
fn shift_sector(system: &SchurSystem, k: f64, over: RateInterval) -> Option<Vec<Vec<Taylor>>> {
    let G = system.evaluate_over(over)?[0][0];
    Some(vec![vec![G + Taylor::constant(C64::new(1.0 / k, 0.0), over)]])
}

/// Returns whether stability is proved for all nonlinearities of what is known with slopes up to k.
fn proves(system: &StateSpace, k: f64, known: FrictionKnowledge, most: StabilityCriterion) -> bool {
    let system = &SchurSystem::of(system).unwrap();
    let mut rates: Vec<f64> =
        (0..160).map(|i| RANGE[0] * (RANGE[1] / RANGE[0]).powf(f64::from(i) / 159.0)).collect();
    for _ in 0..8 {
        let point = |rate: &f64| {
            shift_sector(system, k, RateInterval { middle_rad_s: *rate, half_rad_s: 0.0 }).unwrap()
        };
        let all: Vec<_> = rates.iter().map(point).collect();
        let found: Option<Multiplier> =
            search_multiplier(&[known], most, &all, &rates).map(|best| best.multiplier);
        let Some(multiplier) = found else { return false };
        match multiplier.proves(&|over| shift_sector(system, k, over), RANGE) {
            ProofOutcome::Holds { .. } => return true,
            ProofOutcome::FailsAt(rate) => rates.push(rate),
            ProofOutcome::Narrow(_) => return false,
        }
    }
    false
}

/// G = 1 / (s + 1)^3. The circle criterion ends at 1 / 0.25 = 4, where Re G = cos^3 x cos 3x with tan x = w is least, at 45 degrees. The
/// Popov line through -1 / 8 touches the Popov plot, so that Popov's criterion reaches the linear limit of 8
/// (M. Vidyasagar, *Nonlinear Systems Analysis*, 1993, section 5.6).
#[test]
fn circle_and_popov_criterion_reach_their_limits_on_a_triple_lag() {
    let lag = transfer(&[1.0], &[1.0, 3.0, 3.0, 1.0]);
    let function = FrictionKnowledge::FunctionOfRate;
    assert!(proves(&lag, 3.95, function, StabilityCriterion::Passivity));
    assert!(!proves(&lag, 4.05, function, StabilityCriterion::Passivity));
    assert!(proves(&lag, 7.8, function, StabilityCriterion::Popov));
    assert!(
        !proves(&lag, 8.1, FrictionKnowledge::Rises, StabilityCriterion::ZamesFalb),
        "no proof beyond the linear limit"
    );
}

/// G = (s^2 - 0.2 s - 0.1) / (s^3 + 2 s^2 + s + 1), an example of the literature on Zames-Falb multipliers (X. Chen and J. Wen, 1995). For
/// slope-restricted nonlinearities the linear limit is that of a plant of order three (N. Barabanov, Siberian Math. J. 29, 1988): Routh gives
/// k = (0.7 + sqrt(1.29)) / 0.4 = 4.589.
fn third_order() -> StateSpace {
    transfer(&[1.0, -0.2, -0.1], &[1.0, 2.0, 1.0, 1.0])
}

#[test]
fn a_zames_falb_multiplier_reaches_the_linear_limit_where_popov_does_not() {
    let system = third_order();
    assert!(
        proves(&system, 1.2, FrictionKnowledge::Rises, StabilityCriterion::Passivity),
        "circle criterion"
    );
    assert!(
        !proves(&system, 1.3, FrictionKnowledge::Rises, StabilityCriterion::Passivity),
        "circle criterion"
    );
    assert!(!proves(&system, 4.4, FrictionKnowledge::Rises, StabilityCriterion::Popov));
    assert!(proves(&system, 4.4, FrictionKnowledge::Rises, StabilityCriterion::ZamesFalb));
    assert!(!proves(&system, 4.65, FrictionKnowledge::Rises, StabilityCriterion::ZamesFalb));
}

/// The worst nonlinearities in simulation: saturations and dead zones of any level fade below the limit, and a linear gain
/// above it grows.
#[test]
fn what_is_proved_fades_in_simulation() {
    let system = third_order();
    let run = |slope: &dyn Fn(f64) -> f64| -> f64 {
        let (mut x, h) = ([3.0, -2.0, 4.0], 2e-3);
        let derivative = |x: [f64; 3]| -> [f64; 3] {
            let y: f64 = (0..3).map(|j| system.C[(0, j)] * x[j]).sum();
            let u = -slope(y);
            std::array::from_fn(|i| {
                (0..3).map(|j| system.A[(i, j)] * x[j]).sum::<f64>() + system.B[(i, 0)] * u
            })
        };
        let size = |x: [f64; 3]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
        let first = size(x);
        for _ in 0..200_000 {
            let along = |k: [f64; 3], s: f64| std::array::from_fn(|i| x[i] + s * k[i]);
            let k1 = derivative(x);
            let k2 = derivative(along(k1, 0.5 * h));
            let k3 = derivative(along(k2, 0.5 * h));
            let k4 = derivative(along(k3, h));
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            if !x.iter().all(|v| v.is_finite()) {
                return f64::INFINITY;
            }
        }
        size(x) / first
    };
    for level in [0.01, 0.1, 0.5, 2.0, 10.0] {
        let saturated = run(&|y| 4.4 * y.clamp(-level, level));
        let dead = run(&|y| 4.4 * (y - y.clamp(-level, level)));
        assert!(saturated < 0.5, "saturation at {level}: {saturated}");
        assert!(dead < 0.5, "dead zone of {level}: {dead}");
    }
    assert!(run(&|y| 5.0 * y) > 2.0, "beyond the linear limit");
}
