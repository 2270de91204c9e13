//! Effects that act together: the pairs of looks whose signatures explain most of the misfit in each other's company.

use counterpoise_models::Parameters;

use crate::bench::Judged;
use crate::look::{Look, dot, thinned, weighted};

/// Effects that together explain more than any of them alone.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Places of the two in the list of looks.
    pub members: [usize; 2],
    /// Share of the weighted residual that their signatures explain together.
    pub explained: f64,
    /// What each member's change counts for beside the other.
    pub shares: [f64; 2],
}

impl Pair {
    /// Both looks, their starts where the two together would start.
    pub fn looks(&self, looks: &[Look], base: &Parameters) -> [Look; 2] {
        [0, 1].map(|k| looks[self.members[k]].scaled(self.shares[k], base))
    }
}

/// Effects with more parameters than this are not tried in pairs.
const PAIRED_KNOBS: usize = 4;

/// The best pairs of looks at different effects, by linear regression on both of their traces; best first.
pub fn pairs(judged: &[Judged], looks: &[Look], count: usize) -> Vec<Pair> {
    let here = weighted(judged);
    let target: Vec<f64> = thinned(&here, |r, k| here.residuals[r][k]);
    let total = dot(&target, &target).max(f64::MIN_POSITIVE);
    let simple = |i: &usize| looks[*i].effect.knobs.len() <= PAIRED_KNOBS;
    let usable: Vec<usize> =
        (0..looks.len()).filter(|&i| is_best_of_its_effect(looks, i)).filter(simple).collect();
    let mut out = Vec::new();
    for (place, &i) in usable.iter().enumerate() {
        for &j in &usable[place + 1..] {
            let (explained, shares) = together(&looks[i].trace, &looks[j].trace, &target);
            out.push(Pair { members: [i, j], explained: explained / total, shares });
        }
    }
    out.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    out.truncate(count);
    out
}

/// Whether no earlier (hence better) look is at the same effect.
fn is_best_of_its_effect(looks: &[Look], index: usize) -> bool {
    !looks[..index].iter().any(|l| std::ptr::eq(l.effect, looks[index].effect))
}

/// Power of the target that two traces explain together, and their coefficients.
fn together(a: &[f64], b: &[f64], target: &[f64]) -> (f64, [f64; 2]) {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    let (at, bt) = (dot(a, target), dot(b, target));
    let determinant = aa * bb - ab * ab;
    if determinant <= 1e-6 * aa * bb {
        return (0.0, [1.0, 1.0]);
    }
    let (x, y) = ((bb * at - ab * bt) / determinant, (aa * bt - ab * at) / determinant);
    (x * at + y * bt, [x, y])
}
