//! Effects that act together: the pairs whose signatures together explain most of the residual.

use crate::tolerance::selection::PAIRED_PARAMETERS;
use counterpoise_models::Parameters;

use crate::recording::series::dot;
use crate::selection::signature::{EffectSignature, thin_weighted, weight_residuals};
use crate::simulator_access::Assessment;
use crate::tolerance::selection::INDEPENDENT_SIGNATURES;

/// Effects that together explain more than any of them alone.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Indices of the two in the list of signatures.
    pub members: [usize; 2],
    /// Share of the weighted residual that their signatures explain together.
    pub explained: f64,
    /// Weight of each member's change beside the other.
    pub shares: [f64; 2],
}

impl Pair {
    /// Returns both signatures, with the starts of a fit of the two together.
    pub fn signatures(&self, signatures: &[EffectSignature], base: &Parameters) -> [EffectSignature; 2] {
        [0, 1].map(|k| signatures[self.members[k]].scale_change(self.shares[k], base))
    }
}

/// Returns the best pairs of different effects, by linear regression on both of their traces; best first.
pub fn rank_pairs(judged: &[Assessment], signatures: &[EffectSignature], count: usize) -> Vec<Pair> {
    let here = weight_residuals(judged);
    let target: Vec<f64> = thin_weighted(&here, |r, k| here.residuals[r][k]);
    let total = dot(&target, &target).max(f64::MIN_POSITIVE);
    let simple = |i: &usize| signatures[*i].effect.parameters.len() <= PAIRED_PARAMETERS;
    let usable: Vec<usize> =
        (0..signatures.len()).filter(|&i| is_best_of_its_effect(signatures, i)).filter(simple).collect();
    let mut out = Vec::new();
    for (place, &i) in usable.iter().enumerate() {
        for &j in &usable[place + 1..] {
            let (explained, shares) = explain_by_pair(&signatures[i].trace, &signatures[j].trace, &target);
            out.push(Pair { members: [i, j], explained: explained / total, shares });
        }
    }
    out.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    out.truncate(count);
    out
}

/// Returns whether no earlier, hence better, signature is of the same effect.
fn is_best_of_its_effect(signatures: &[EffectSignature], index: usize) -> bool {
    !signatures[..index].iter().any(|l| std::ptr::eq(l.effect, signatures[index].effect))
}

/// Returns the power of the target that two traces explain together, and their coefficients.
fn explain_by_pair(a: &[f64], b: &[f64], target: &[f64]) -> (f64, [f64; 2]) {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    let (at, bt) = (dot(a, target), dot(b, target));
    let determinant = aa * bb - ab * ab;
    if determinant <= INDEPENDENT_SIGNATURES * aa * bb {
        return (0.0, [1.0, 1.0]);
    }
    let (x, y) = ((bb * at - ab * bt) / determinant, (aa * bt - ab * at) / determinant);
    (x * at + y * bt, [x, y])
}
