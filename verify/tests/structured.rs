//! The structured singular value against what is known: closed forms, a published example, brute force, and the loop itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use counterpoise_linalg::{C64, CMat};
use counterpoise_verify::Procedure;
use counterpoise_verify::robustness::{Distribution, Variation, VariedParameter};
use counterpoise_verify::structured::factor::Reach;
use counterpoise_verify::structured::{
    PerturbationBlock, PerturbationStructure, Uncertainty, lower_bound, robust_stability, upper_bound,
    vertex_bound,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use support::{controller, rig};

const REAL: PerturbationBlock = PerturbationBlock::Real { repeated: 1 };

struct Source(ChaCha8Rng);

impl Source {
    fn of(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn number(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn complex(&mut self) -> C64 {
        C64::new(self.number(), self.number())
    }

    fn matrix(&mut self, n: usize) -> CMat {
        CMat::from_fn(n, n, |_, _| self.complex())
    }
}

/// M = u v*: det(I - M Delta) = 1 - sum of a_k delta_k. By duality the least size is 1 over the minimum over x of
/// sum over real blocks of |Re a + x Im a| + sqrt(1 + x^2) sum over complex blocks of |a|.
fn rank_one(a: &[C64], structure: &PerturbationStructure) -> f64 {
    let at = |x: f64| -> f64 {
        let one = |(a, block): (&C64, &PerturbationBlock)| match block {
            PerturbationBlock::Real { .. } => (a.re + x * a.im).abs(),
            PerturbationBlock::Complex => (1.0 + x * x).sqrt() * a.norm(),
        };
        a.iter().zip(&structure.blocks).map(one).sum()
    };
    let (mut low, mut high) = (-1e4_f64, 1e4_f64);
    for _ in 0..400 {
        let (p, q) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(p) < at(q) { high = q } else { low = p }
    }
    at(0.5 * (low + high))
}

#[test]
fn a_matrix_of_rank_one_has_the_value_of_its_closed_form() {
    let mut source = Source::of(3);
    for case in 0..40 {
        let n = 2 + case % 5;
        let mut blocks = vec![REAL; n];
        (0..case % (n + 1)).for_each(|k| blocks[k] = PerturbationBlock::Complex);
        let structure = PerturbationStructure::of(&blocks);
        let u: Vec<C64> = (0..n).map(|_| source.complex()).collect();
        let v: Vec<C64> = (0..n).map(|_| source.complex()).collect();
        let M = CMat::from_fn(n, n, |i, j| u[i] * v[j].conj());
        let a: Vec<C64> = u.iter().zip(&v).map(|(u, v)| u * v.conj()).collect();
        let exact = rank_one(&a, &structure);
        let upper = upper_bound(&M, &structure, None);
        assert!(upper.proves(&M), "case {case}");
        assert!(
            upper.beta > 0.9999 * exact && upper.beta < 1.02 * exact,
            "case {case}: {} {exact}",
            upper.beta
        );
        if let Some(lower) = lower_bound(&M, &structure) {
            assert!(lower.beta < 1.0001 * exact, "case {case}: {} {exact}", lower.beta);
        }
    }
}

#[test]
fn two_complex_blocks_leave_no_gap_between_the_bounds() {
    // Doyle 1982: the scaled upper bound is mu itself for up to three full complex blocks
    let mut source = Source::of(7);
    for n in [2, 3] {
        for case in 0..20 {
            let (M, structure) =
                (source.matrix(n), PerturbationStructure::of(&vec![PerturbationBlock::Complex; n]));
            let upper = upper_bound(&M, &structure, None).beta;
            let found = lower_bound(&M, &structure).or_else(|| vertex_bound(&M, &structure, &[], &[], upper));
            let lower = found.unwrap().beta;
            assert!(lower < 1.0001 * upper && upper < 1.02 * lower, "n {n} case {case}: {lower} to {upper}");
        }
    }
}

#[test]
fn two_real_parameters_and_a_complex_one_agree_with_brute_force() {
    let mut source = Source::of(11);
    for case in 0..6 {
        let (M, structure) =
            (source.matrix(3), PerturbationStructure::of(&[REAL, REAL, PerturbationBlock::Complex]));
        let exact = brute_force(&M);
        let upper = upper_bound(&M, &structure, None).beta;
        assert!(upper > 0.999 * exact && upper < 1.15 * exact, "case {case}: {upper} {exact}");
        let lower = vertex_bound(&M, &structure, &[0.0, 0.0], &[Reach { least: -1e9, most: 1e9 }; 2], upper)
            .unwrap()
            .beta;
        assert!(lower < 1.001 * exact && lower > 0.9 * exact, "case {case}: {lower} {exact}");
        if let Some(iterated) = lower_bound(&M, &structure) {
            assert!(iterated.beta < 1.001 * exact, "case {case}: {} {exact}", iterated.beta);
        }
    }
}

/// 1 over the least of max(|d1|, |d2|, |d3|) with det(I - M Delta) = 0, d1 and d2 real on a grid, d3 what the determinant needs.
fn brute_force(M: &CMat) -> f64 {
    let needed = |d1: f64, d2: f64| {
        let I = |i: usize, j: usize| C64::new(f64::from(u8::from(i == j)), 0.0);
        let d = [d1, d2];
        let t = |i: usize, j: usize| I(i, j) - M[(i, j)] * d[j];
        // the determinant is alpha - beta d3
        let minor =
            |r: [usize; 2], c: [usize; 2]| t(r[0], c[0]) * t(r[1], c[1]) - t(r[0], c[1]) * t(r[1], c[0]);
        let alpha = minor([0, 1], [0, 1]);
        let beta = M[(0, 2)] * minor([1, 2], [0, 1]) - M[(1, 2)] * minor([0, 2], [0, 1]) + M[(2, 2)] * alpha;
        d1.abs().max(d2.abs()).max((alpha / beta).norm())
    };
    let (mut centre, mut span, mut best) = ([0.0, 0.0], 5.0, f64::INFINITY);
    for _ in 0..6 {
        let from = centre;
        for i in -100..=100 {
            for j in -100..=100 {
                let at = [from[0] + span * f64::from(i) / 100.0, from[1] + span * f64::from(j) / 100.0];
                let size = needed(at[0], at[1]);
                if size < best {
                    (best, centre) = (size, at);
                }
            }
        }
        span *= 0.1;
    }
    1.0 / best
}

/// de Gaston and Safonov 1988: 800 (1 + 0.1 e1) (s + 2) / (s (s + 4 + 0.2 e2) (s + 6 + 0.3 e3) (s + 10)) in a unity feedback loop is
/// stable for all |e| < 3.4174.
fn de_gaston_safonov(rate: f64) -> CMat {
    let s = C64::new(0.0, rate);
    let one = C64::new(1.0, 0.0);
    let (g1, g2, g3) = (800.0 * (s + 2.0) / (s * (s + 10.0)), one / (s + 4.0), one / (s + 6.0));
    let open = one / (one + g1 * g2 * g3);
    let inputs = [
        [one, C64::new(0.0, 0.0), C64::new(0.0, 0.0)],
        [-one * 0.0, -one, C64::new(0.0, 0.0)],
        [one * 0.0, one * 0.0, -one],
    ];
    CMat::from_fn(3, 3, |i, j| {
        let w = inputs[j];
        let y = open * g3 * (g2 * (w[0] + w[1]) + w[2]);
        let x2 = g2 * (-g1 * y + w[0] + w[1]);
        [-g1 * y * 0.1, x2 * 0.2, y * 0.3][i]
    })
}

#[test]
fn a_published_margin_of_three_real_parameters_is_found() {
    const PUBLISHED: f64 = 3.4174;
    let structure = PerturbationStructure::of(&[REAL; 3]);
    let (mut upper, mut lower) = (0.0_f64, 0.0_f64);
    for k in 0..=250 {
        let M = de_gaston_safonov(8.1 + 0.001 * f64::from(k));
        upper = upper.max(upper_bound(&M, &structure, None).beta);
        lower = lower_bound(&M, &structure).map_or(lower, |found| lower.max(found.beta));
    }
    assert!(1.0 / upper < 1.0001 * PUBLISHED && 1.0 / upper > 0.99 * PUBLISHED, "upper {}", 1.0 / upper);
    assert!(lower <= upper, "lower {lower}");
}

fn vary(parameter: VariedParameter, low: f64, high: f64) -> Variation {
    Variation { parameter, distribution: Distribution::Uniform { low, high } }
}

/// The gap that may lie between the bound that holds for certain and the nearest mechanism that was found.
const WIDEST_GAP: f64 = 2.2;

/// With a perturbation that was found at a frequency of M, the sampled loop has a pole on the unit circle at that frequency: the
/// uncertain parts were pulled out of the loop as it is.
#[test]
fn the_loop_closed_with_the_worst_mechanism_is_at_its_limit() {
    let cases = [
        vec![vary(VariedParameter::Inertia, 0.5, 2.0)],
        vec![vary(VariedParameter::TorqueConstant, 0.8, 1.2), vary(VariedParameter::GyroBandwidth, 0.5, 1.5)],
        vec![
            vary(VariedParameter::HubInertia, 0.5, 2.0),
            vary(VariedParameter::Inertia, 0.8, 1.25),
            vary(VariedParameter::StructureStiffness, 0.7, 1.3),
        ],
        vec![
            vary(VariedParameter::GearStiffness, 0.5, 1.5),
            vary(VariedParameter::MotorInertia, 0.5, 1.5),
            vary(VariedParameter::Resistance, 0.5, 2.0),
        ],
        vec![
            vary(VariedParameter::HubInertia, 0.8, 1.25),
            vary(VariedParameter::Friction, 0.5, 2.0),
            vary(VariedParameter::Viscous, 0.5, 2.0),
            vary(VariedParameter::StructureDamping, 0.5, 2.0),
            vary(VariedParameter::GearStiffness, 0.8, 1.2),
            vary(VariedParameter::TorqueConstant, 0.9, 1.1),
            vary(VariedParameter::Backlash, 0.0, 3.0),
        ],
    ];
    for (k, variations) in cases.into_iter().enumerate() {
        let uncertainty = Uncertainty { variations, input_error: 0.1, output_error: 0.1 };
        let found =
            robust_stability(&rig(), &controller(), &Procedure::default(), &uncertainty).unwrap().unwrap();
        let limit = found.found.expect("a perturbation");
        assert!((limit.pole.norm() - 1.0).abs() < 1e-5, "case {k}");
        assert!(
            limit.scale > 0.999 * found.guaranteed && limit.scale < WIDEST_GAP * found.guaranteed,
            "case {k}"
        );
    }
}
