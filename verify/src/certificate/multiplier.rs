//! Multipliers: how much of what is known about a friction law can be used in a proof of stability.
//!
//! The rates w = -H F follow from the friction torques F through the rest of the loop. Everything that is known about F is a quadratic
//! inequality in w and F. If a combination of them is contradicted at every frequency,
//!
//! ```text
//!     N(jw) H(jw) + H(jw)^* N(jw)^* + R(w) > 0,      N, R diagonal, one entry a joint
//! ```
//!
//! then no motion can keep itself up (V. Yakubovich 1967; A. Megretski and A. Rantzer, IEEE TAC 42, 1997). The terms of N and R:
//!
//! | known of the law | term of N | of R | criterion |
//! |---|---|---|---|
//! | it takes energy out of the motion | 1 | | passivity |
//! | it is a function of the rate | +- jw | | Popov (V. Popov 1961) |
//! | that function is odd and rises | 1 less a kernel of absolute integral 1 at most | | Zames and Falb (G. Zames and P. Falb, SIAM J. Control 6, 1968) |
//! | the torque changes by 0 to k times the displacement (Dahl) | -jw k | 2 w^2 | circle criterion on the presliding stiffness |
//!
//! The search is a second-order cone program at the points of a grid. It is heuristic: what it finds is shown to hold between the
//! points by [`Multiplier::proves`].

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_linalg::{C64, CMat, Cone, ConeProgram};

use crate::structured::taylor::{RateInterval, Taylor};
use crate::tolerance::{HOPELESS_EIGENVALUE, KERNELS, MULTIPLIER_SPLITS, MULTIPLIER_START, NEGLIGIBLE_TERM};

/// Known properties of the friction at a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionKnowledge {
    /// The friction takes energy out of the motion.
    Dissipates,
    /// The friction is a function of the rate, of the rate's sign.
    FunctionOfRate,
    /// The friction is an odd function that never falls.
    Rises,
    /// The torque changes by at most this times the displacement, N m/rad, and never against it.
    Stiffness(f64),
}

/// The strongest criterion that a proof needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StabilityCriterion {
    /// Passivity.
    Passivity,
    /// The circle criterion on the presliding stiffness.
    Circle,
    /// Popov's criterion.
    Popov,
    /// A Zames-Falb multiplier.
    ZamesFalb,
}

impl StabilityCriterion {
    /// Returns the key of the criterion in results.
    pub fn key(self) -> &'static str {
        match self {
            StabilityCriterion::Passivity => "passivity",
            StabilityCriterion::Circle => "circle",
            StabilityCriterion::Popov => "popov",
            StabilityCriterion::ZamesFalb => "zames-falb",
        }
    }
}

/// A term of N at one joint, with its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MultiplierTerm {
    /// Joint.
    pub joint: usize,
    /// Kind of the term.
    pub kind: TermKind,
    /// Weight, 0 or more.
    pub weight: f64,
}

/// A kind of term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TermKind {
    /// 1.
    Constant,
    /// j w / reference, with a sign.
    Derivative(f64),
    /// -sign / (1 + j w / corner); a corner below 0 looks ahead.
    Kernel {
        /// Corner, rad/s.
        corner_rad_s: f64,
        /// Sign.
        sign: f64,
    },
    /// -j w / reference, and 2 w^2 / (reference k) in R.
    Stiffness(f64),
}

/// N and R of a proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Multiplier {
    /// Terms.
    pub terms: Vec<MultiplierTerm>,
    /// Rate by which derivatives are divided, rad/s.
    pub reference_rad_s: f64,
    joints: usize,
}

/// H over an interval.
pub type LoopOverInterval<'a> = dyn Fn(RateInterval) -> Option<Vec<Vec<Taylor>>> + 'a;

/// Outcome of a check between points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProofOutcome {
    /// The condition holds at every frequency of the range.
    Holds {
        /// Least eigenvalue over the largest modulus of an eigenvalue, over all intervals.
        least: f64,
        /// Where, rad/s.
        rate_rad_s: f64,
        /// Intervals that were needed.
        intervals: usize,
    },
    /// The condition does not hold, or cannot be shown, at this rate, rad/s.
    FailsAt(f64),
    /// The condition holds wherever it was looked at, but so narrowly that [`MULTIPLIER_SPLITS`] intervals did not show it; up to this rate, rad/s.
    Narrow(f64),
}

impl Multiplier {
    /// The matrix N H + (N H)^* + R over an interval, as (0, 0), (1, 1) and (0, 1) entry; with one joint the last two are empty.
    fn form(&self, H: &[Vec<Taylor>], over: RateInterval) -> [Taylor; 3] {
        let n: Vec<Taylor> = (0..self.joints).map(|joint| self.at(joint, over)).collect();
        let none = Taylor::constant(C64::new(0.0, 0.0), over);
        let own = |k: usize| {
            let passed = n[k] * H[k][k];
            passed + passed.conj() + self.residue(k, over)
        };
        match self.joints {
            1 => [own(0), none, none],
            _ => [own(0), own(1), n[0] * H[0][1] + (n[1] * H[1][0]).conj()],
        }
    }

    /// Returns N at a joint over an interval.
    pub fn at(&self, joint: usize, over: RateInterval) -> Taylor {
        let own = self.terms.iter().filter(|term| term.joint == joint);
        own.fold(Taylor::constant(C64::new(0.0, 0.0), over), |sum, term| {
            sum + term.kind.multiplier(self.reference_rad_s, over) * term.weight
        })
    }

    /// R at a joint over an interval.
    fn residue(&self, joint: usize, over: RateInterval) -> Taylor {
        let own = self.terms.iter().filter(|term| term.joint == joint);
        let factor: f64 = own.map(|term| term.weight * term.kind.residue(self.reference_rad_s)).sum();
        let (w, half) = (over.middle_rad_s, over.half_rad_s);
        Taylor {
            value: C64::new(factor * w * w, 0.0),
            slope: C64::new(2.0 * factor * w, 0.0),
            rest: factor * half * half,
            half_rad_s: half,
        }
    }

    /// Returns the matrix of the condition at a rate.
    pub fn matrix(&self, H: &[Vec<Taylor>], over: RateInterval) -> CMat {
        let [a, d, b] = self.form(H, over);
        CMat::from_fn(self.joints, self.joints, |i, j| match (i, j) {
            (0, 0) => a.value,
            (0, 1) => b.value,
            (1, 0) => b.value.conj(),
            _ => d.value,
        })
    }

    /// Returns whether the condition holds at every rate of a range: the range is halved until it does in each interval. The tangent
    /// is a Hermitian matrix whose least eigenvalue is a concave function of the rate, so that its ends decide.
    pub fn proves(&self, H: &LoopOverInterval<'_>, [low, high]: [f64; 2]) -> ProofOutcome {
        let mut open = vec![[low, high]];
        let (mut least, mut rate_rad_s, mut intervals) = (f64::INFINITY, low, 0);
        while let Some([from, to]) = open.pop() {
            let over = RateInterval { middle_rad_s: 0.5 * (from + to), half_rad_s: 0.5 * (to - from) };
            intervals += 1;
            if let Some(found) = H(over) {
                let form = self.form(&found, over);
                let end = |x: f64| form.map(|entry| entry.value + entry.slope * x);
                let rest = form.iter().map(|entry| entry.rest.powi(2)).sum::<f64>() + form[2].rest.powi(2);
                let bound = least_eigenvalue(end(-over.half_rad_s), self.joints)
                    .min(least_eigenvalue(end(over.half_rad_s), self.joints))
                    - rest.sqrt();
                let middle = form.map(|entry| entry.value);
                let (here, size) = (least_eigenvalue(middle, self.joints), largest(middle, self.joints));
                if here <= 0.0 {
                    return ProofOutcome::FailsAt(over.middle_rad_s);
                }
                if bound > 0.0 {
                    if bound / size < least {
                        (least, rate_rad_s) = (bound / size, over.middle_rad_s);
                    }
                    continue;
                }
            }
            let middle = (from * to).sqrt();
            if !(from < middle && middle < to) {
                return ProofOutcome::FailsAt(middle);
            }
            if intervals > MULTIPLIER_SPLITS {
                return ProofOutcome::Narrow(middle);
            }
            open.extend([[middle, to], [from, middle]]);
        }
        ProofOutcome::Holds { least, rate_rad_s, intervals }
    }

    /// Returns the strongest criterion among the terms that matter.
    pub fn criterion(&self) -> StabilityCriterion {
        let of = |term: &MultiplierTerm| match term.kind {
            TermKind::Constant => StabilityCriterion::Passivity,
            TermKind::Stiffness(_) => StabilityCriterion::Circle,
            TermKind::Derivative(_) => StabilityCriterion::Popov,
            TermKind::Kernel { .. } => StabilityCriterion::ZamesFalb,
        };
        self.terms.iter().map(of).max().unwrap_or(StabilityCriterion::Passivity)
    }
}

/// The least eigenvalue of [[a, b], [b^*, d]].
fn least_eigenvalue([a, d, b]: [C64; 3], joints: usize) -> f64 {
    if joints == 1 {
        return a.re;
    }
    0.5 * (a.re + d.re) - (0.25 * (a.re - d.re).powi(2) + b.norm_sqr()).sqrt()
}

/// The largest modulus of an eigenvalue.
fn largest([a, d, b]: [C64; 3], joints: usize) -> f64 {
    if joints == 1 {
        return a.re.abs();
    }
    0.5 * (a.re + d.re).abs() + (0.25 * (a.re - d.re).powi(2) + b.norm_sqr()).sqrt()
}

impl TermKind {
    fn multiplier(self, reference_rad_s: f64, over: RateInterval) -> Taylor {
        match self {
            TermKind::Constant => Taylor::constant(C64::new(1.0, 0.0), over),
            TermKind::Derivative(sign) => Taylor::derivative(sign / reference_rad_s, over),
            TermKind::Stiffness(_) => Taylor::derivative(-1.0 / reference_rad_s, over),
            TermKind::Kernel { corner_rad_s, sign } => {
                let one = Taylor::constant(C64::new(1.0, 0.0), over);
                (one + Taylor::derivative(1.0 / corner_rad_s, over)).recip() * -sign
            }
        }
    }

    /// The factor of w^2 in R.
    fn residue(self, reference_rad_s: f64) -> f64 {
        match self {
            TermKind::Stiffness(stiffness) => 2.0 / (reference_rad_s * stiffness),
            _ => 0.0,
        }
    }
}

/// The kind of a term and the joint that it stands for: a term without its weight.
#[derive(Debug, Clone, Copy)]
struct JointKind {
    joint: usize,
    kind: TermKind,
}

/// The terms that what is known allows, up to a criterion.
fn allowed_terms(
    known: &[FrictionKnowledge],
    most: StabilityCriterion,
    reference_rad_s: f64,
) -> Vec<JointKind> {
    let mut all = Vec::new();
    for (joint, known) in known.iter().enumerate() {
        all.push(JointKind { joint, kind: TermKind::Constant });
        match *known {
            FrictionKnowledge::Stiffness(most_nm_rad) if most >= StabilityCriterion::Circle => {
                all.push(JointKind { joint, kind: TermKind::Stiffness(most_nm_rad) });
            }
            FrictionKnowledge::FunctionOfRate | FrictionKnowledge::Rises
                if most >= StabilityCriterion::Popov =>
            {
                all.extend([1.0, -1.0].map(|sign| JointKind { joint, kind: TermKind::Derivative(sign) }));
            }
            _ => {}
        }
        if *known == FrictionKnowledge::Rises && most >= StabilityCriterion::ZamesFalb {
            for k in 0..KERNELS {
                let corner_rad_s = reference_rad_s * 10f64.powf(4.0 * k as f64 / (KERNELS - 1) as f64 - 2.0);
                for (ahead, sign) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    all.push(JointKind {
                        joint,
                        kind: TermKind::Kernel { corner_rad_s: ahead * corner_rad_s, sign },
                    });
                }
            }
        }
    }
    all
}

/// Returns whether a criterion has a term that weaker ones lack.
pub fn adds_terms(known: &[FrictionKnowledge], most: StabilityCriterion) -> bool {
    let added = |known: &FrictionKnowledge| match (most, *known) {
        (StabilityCriterion::Passivity, _) => true,
        (StabilityCriterion::Circle, known) => matches!(known, FrictionKnowledge::Stiffness(_)),
        (StabilityCriterion::Popov, known) => {
            matches!(known, FrictionKnowledge::FunctionOfRate | FrictionKnowledge::Rises)
        }
        (StabilityCriterion::ZamesFalb, known) => known == FrictionKnowledge::Rises,
    };
    known.iter().any(added)
}

/// The best multiplier at some rates.
#[derive(Debug, Clone, PartialEq)]
pub struct BestMultiplier {
    /// The multiplier.
    pub multiplier: Multiplier,
    /// The rate at which the condition costs most, rad/s: without it another multiplier would hold by more at the others.
    pub costliest_rad_s: f64,
    /// No multiplier of the same terms has a larger least eigenvalue at these rates: the dual value with its sign changed.
    pub bound: f64,
}

impl BestMultiplier {
    /// Returns whether no multiplier of the same terms holds at all of these rates by more than the accuracy of the program; a multiplier of 0
    /// holds by nothing.
    pub fn is_hopeless(&self) -> bool {
        self.bound < HOPELESS_EIGENVALUE
    }

    /// Returns whether every multiplier of the same terms misses the condition at one of these rates, by more than the accuracy of the program.
    pub fn is_ruled_out(&self) -> bool {
        self.bound < -HOPELESS_EIGENVALUE
    }
}

/// Returns the multiplier that makes the condition hold best at some rates, with the terms up to a criterion; `None` if the solver gives
/// up.
///
/// H is expected with diagonal entries of like size in every joint.
pub fn search_multiplier(
    known: &[FrictionKnowledge],
    most: StabilityCriterion,
    H: &[Vec<Vec<Taylor>>],
    rates: &[f64],
) -> Option<BestMultiplier> {
    let size = |at: &Vec<Vec<Taylor>>| {
        at.iter().flatten().map(|entry| entry.value.norm_sqr()).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)
    };
    let sizes: Vec<f64> = H.iter().map(size).collect();
    let (peak, most_size) =
        sizes.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map(|(k, s)| (k, *s))?;
    let reference_rad_s = rates[peak].max(MULTIPLIER_START);
    let kinds = allowed_terms(known, most, reference_rad_s);
    let joints = known.len();
    let one = |&JointKind { joint, kind }: &JointKind| Multiplier {
        terms: vec![MultiplierTerm { joint, kind, weight: 1.0 }],
        reference_rad_s,
        joints,
    };
    let each: Vec<Multiplier> = kinds.iter().map(one).collect();
    let mut program = Program::new(kinds.len() + 1);
    program.normalise(kinds.len());
    for joint in 0..joints {
        program.bound_kernels(joint, &kinds);
    }
    let before = program.0.rows();
    for ((at, rate), size) in H.iter().zip(rates).zip(&sizes) {
        let over = RateInterval { middle_rad_s: *rate, half_rad_s: 0.0 };
        let forms: Vec<[C64; 3]> =
            each.iter().map(|alone| alone.form(at, over).map(|entry| entry.value)).collect();
        program.require_positive(&forms, size * size / most_size, joints);
    }
    let rows_at_each = (program.0.rows() - before) / rates.len();
    let solved = program.0.solve().ok()?;
    let prices = solved.prices.iter().skip(before).step_by(rows_at_each);
    let costliest = prices.zip(rates).max_by(|a, b| a.0.total_cmp(b.0))?;
    let terms = kinds.iter().zip(&solved.x).filter(|(_, weight)| **weight > NEGLIGIBLE_TERM);
    let terms = terms.map(|(of, weight)| MultiplierTerm { joint: of.joint, kind: of.kind, weight: *weight });
    let multiplier = Multiplier { terms: terms.collect(), reference_rad_s, joints };
    Some(BestMultiplier { multiplier, costliest_rad_s: *costliest.1, bound: -solved.dual })
}

/// The cone program: the weights and, last, the least eigenvalue that is to be largest.
struct Program(ConeProgram);

impl Program {
    fn new(variables: usize) -> Self {
        let mut cost = vec![0.0; variables];
        cost[variables - 1] = -1.0;
        Self(ConeProgram::new(cost))
    }

    /// Returns a row with the sum of some entries, the others 0.
    fn row(&self, entries: &[VectorEntry]) -> Vec<f64> {
        let mut row = vec![0.0; self.0.variables()];
        entries.iter().for_each(|entry| row[entry.index] += entry.value);
        row
    }

    /// The weights are 0 or more, and 1 in sum.
    fn normalise(&mut self, weights: usize) {
        let all: Vec<VectorEntry> = (0..weights).map(|k| VectorEntry::new(k, 1.0)).collect();
        let sum = self.row(&all);
        self.0.push(vec![sum], vec![1.0], Cone::Zero);
        let each = (0..weights).map(|k| self.row(&[VectorEntry::new(k, -1.0)])).collect();
        self.0.push(each, vec![0.0; weights], Cone::Nonnegative);
    }

    /// The kernels of a joint have together an absolute integral of at most its constant.
    fn bound_kernels(&mut self, joint: usize, kinds: &[JointKind]) {
        let own = kinds.iter().enumerate().filter(|(_, of)| of.joint == joint);
        let entries: Vec<VectorEntry> = own
            .filter_map(|(k, of)| match of.kind {
                TermKind::Constant => Some(VectorEntry::new(k, -1.0)),
                TermKind::Kernel { .. } => Some(VectorEntry::new(k, 1.0)),
                _ => None,
            })
            .collect();
        let row = self.row(&entries);
        self.0.push(vec![row], vec![0.0], Cone::Nonnegative);
    }

    /// The sum of the weighted forms less the last variable times `share` is positive: a + d >= |(a - d, 2 Re b, 2 Im b)|, in units of the largest
    /// entry.
    fn require_positive(&mut self, forms: &[[C64; 3]], share: f64, joints: usize) {
        let last = self.0.variables() - 1;
        let most = forms.iter().flatten().map(|entry| entry.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let of = |pick: &dyn Fn(&[C64; 3]) -> f64| -> Vec<VectorEntry> {
            forms.iter().enumerate().map(|(k, form)| VectorEntry::new(k, -pick(form) / most)).collect()
        };
        if joints == 1 {
            let mut row = of(&|form| form[0].re);
            row.push(VectorEntry::new(last, share / most));
            let row = self.row(&row);
            return self.0.push(vec![row], vec![0.0], Cone::Nonnegative);
        }
        let mut sum = of(&|form| form[0].re + form[1].re);
        sum.push(VectorEntry::new(last, 2.0 * share / most));
        let parts = [
            sum,
            of(&|form| form[0].re - form[1].re),
            of(&|form| 2.0 * form[2].re),
            of(&|form| 2.0 * form[2].im),
        ];
        let rows = parts.iter().map(|entries| self.row(entries)).collect();
        self.0.push(rows, vec![0.0; parts.len()], Cone::SecondOrder);
    }
}
