//! The order in which poles and zeros are listed.

use crate::C64;

/// Sorts roots by real part, then by imaginary part.
pub(crate) fn sort_roots(roots: &mut [C64]) {
    roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
}
