//! The inner loop of the frequency response: C inv(s I - H) B for several s at a time, H upper Hessenberg.

use crate::{C64, Mat};

/// Number of points that are worked on side by side if there are many. A lane's numbers do not depend on how many others there are.
pub(crate) const LANES: usize = 8;

/// One complex number for each point, real and imaginary parts apart so that the compiler vectorises.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lane<const N: usize> {
    re: [f64; N],
    im: [f64; N],
}

impl<const N: usize> Lane<N> {
    pub(crate) const ZERO: Self = Self { re: [0.0; N], im: [0.0; N] };

    pub(crate) fn new(values: &[C64; N]) -> Self {
        Self { re: values.map(|v| v.re), im: values.map(|v| v.im) }
    }

    fn from_real(x: f64) -> Self {
        Self { re: [x; N], im: [0.0; N] }
    }

    pub(crate) fn get(&self, lane: usize) -> C64 {
        C64::new(self.re[lane], self.im[lane])
    }

    /// self += a.
    pub(crate) fn add(&mut self, a: &Self) {
        for l in 0..N {
            self.re[l] += a.re[l];
            self.im[l] += a.im[l];
        }
    }

    #[inline(always)]
    fn negative(&self) -> Self {
        Self { re: self.re.map(|v| -v), im: self.im.map(|v| -v) }
    }

    /// self += a b.
    #[inline(always)]
    fn add_product(&mut self, a: &Self, b: &Self) {
        for l in 0..N {
            self.re[l] += a.re[l] * b.re[l] - a.im[l] * b.im[l];
            self.im[l] += a.re[l] * b.im[l] + a.im[l] * b.re[l];
        }
    }

    /// a / b lane by lane (Smith, Comm. ACM 5 (1962) 435); only O(n) of these are needed. One rounding where b is real or
    /// imaginary, as it is at a resonance, which magnifies every further one by its quality factor.
    #[inline(always)]
    fn quotient(a: &Self, b: &Self) -> Self {
        let mut out = Self::ZERO;
        for l in 0..N {
            // Where the imaginary part is the larger, both numbers are turned by a right angle first.
            let upright = b.re[l].abs() >= b.im[l].abs();
            let (large, small) = if upright { (b.re[l], b.im[l]) } else { (b.im[l], -b.re[l]) };
            let (re, im) = if upright { (a.re[l], a.im[l]) } else { (a.im[l], -a.re[l]) };
            let ratio = small / large;
            let size = large + small * ratio;
            out.re[l] = (re + im * ratio) / size;
            out.im[l] = (im - re * ratio) / size;
        }
        out
    }
}

/// C inv(s I - H) B, column-major, one [`Lane`] an entry; a pole gives infinities or NaN.
///
/// The columns of s I - H are combined from the last to the first so that it becomes upper triangular; each finished
/// column is used for the back substitution at once and forgotten.
pub(crate) fn sweep<const N: usize>(H: &Mat, B: &Mat, C: &Mat, s: &Lane<N>) -> Vec<Lane<N>> {
    let mut state = Sweep::start(H, B, C, s);
    pulp::Arch::new().dispatch(Run(&mut state));
    state.answer
}

/// The work as pulp wants it: compiled once for each instruction set, chosen when the program runs.
struct Run<'a, 'b, const N: usize>(&'b mut Sweep<'a, N>);

impl<const N: usize> pulp::NullaryFnOnce for Run<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run();
    }
}

struct Sweep<'a, const N: usize> {
    H: &'a Mat,
    C: &'a Mat,
    s: &'a Lane<N>,
    /// For each row the entry of the column of s I - H that is being combined, then what is left of that row of B.
    rows: Vec<Lane<N>>,
    /// The column of C, combined likewise.
    out: Vec<Lane<N>>,
    /// p x m.
    answer: Vec<Lane<N>>,
    n: usize,
    m: usize,
    p: usize,
}

impl<'a, const N: usize> Sweep<'a, N> {
    fn start(H: &'a Mat, B: &Mat, C: &'a Mat, s: &'a Lane<N>) -> Self {
        let (n, m, p) = (H.nrows(), B.ncols(), C.nrows());
        let mut rows = Vec::with_capacity(n * (m + 1));
        for i in 0..n {
            rows.push(entry(H, s, i, n - 1));
            rows.extend((0..m).map(|j| Lane::from_real(B[(i, j)])));
        }
        let out = (0..p).map(|i| if n > 0 { Lane::from_real(C[(i, n - 1)]) } else { Lane::ZERO }).collect();
        Self { H, C, s, rows, out, answer: vec![Lane::ZERO; p * m], n, m, p }
    }

    #[inline(always)]
    fn run(&mut self) {
        let mut unknowns = vec![Lane::ZERO; self.m];
        for k in (1..self.n).rev() {
            self.combine(k, &mut unknowns);
        }
        if self.n > 0 {
            for j in 0..self.m {
                let x = Lane::quotient(&self.rows[1 + j], &self.rows[0]);
                for i in 0..self.p {
                    self.answer[j * self.p + i].add_product(&self.out[i], &x);
                }
            }
        }
    }

    /// Makes entry (k, k-1) zero with columns k-1 and k, solves for unknown k, and leaves the new column k-1.
    #[inline(always)]
    fn combine(&mut self, k: usize, unknowns: &mut [Lane<N>]) {
        let sub = Lane::from_real(-self.H[(k, k - 1)]);
        let current = self.rows[k * (self.m + 1)];
        let mut swap = [0.0; N];
        let (mut large, mut small) = (current, sub);
        for l in 0..N {
            if current.re[l].abs() + current.im[l].abs() < sub.re[l].abs() {
                swap[l] = 1.0;
                (large.re[l], small.re[l]) = (sub.re[l], current.re[l]);
                (large.im[l], small.im[l]) = (sub.im[l], current.im[l]);
            }
        }
        // Where both are zero the pivot is zero and the answer not finite: s is a pole.
        let factor = Lane::quotient(&small, &large).negative();
        self.solve(k, &large, &swap, unknowns);
        self.columns(k, &factor, &swap, unknowns);
    }

    /// The unknowns k, negated, one for each input.
    #[inline(always)]
    fn solve(&mut self, k: usize, pivot: &Lane<N>, swap: &[f64; N], unknowns: &mut [Lane<N>]) {
        let row = &self.rows[k * (self.m + 1)..(k + 1) * (self.m + 1)];
        for (j, unknown) in unknowns.iter_mut().enumerate() {
            let x = Lane::quotient(&row[1 + j], pivot);
            for i in 0..self.p {
                let (kept, _) = choose(self.C[(i, k - 1)], &self.out[i], swap);
                self.answer[j * self.p + i].add_product(&kept, &x);
            }
            *unknown = x.negative();
        }
    }

    /// Column k is finished and taken out of the right-hand sides; column k-1 is the other one plus factor times it.
    #[inline(always)]
    fn columns(&mut self, k: usize, factor: &Lane<N>, swap: &[f64; N], unknowns: &[Lane<N>]) {
        let width = self.m + 1;
        let raw = &self.H.column(k - 1)[..k];
        let (upper, last) = self.rows[..k * width].split_at_mut((k - 1) * width);
        for (row, &h) in upper.chunks_exact_mut(width).zip(raw) {
            let (kept, other) = choose(-h, &row[0], swap);
            update(row, &kept, other, factor, unknowns);
        }
        let (mut kept, mut other) = choose(-raw[k - 1], &last[0], swap);
        add_diagonal(&mut kept, &mut other, self.s, swap);
        update(last, &kept, other, factor, unknowns);
        for i in 0..self.p {
            let (kept, mut other) = choose(self.C[(i, k - 1)], &self.out[i], swap);
            other.add_product(&kept, factor);
            self.out[i] = other;
        }
    }
}

/// One row: the new column's entry, and its right-hand sides less what unknown k explains.
#[inline(always)]
fn update<const N: usize>(
    row: &mut [Lane<N>],
    kept: &Lane<N>,
    mut other: Lane<N>,
    factor: &Lane<N>,
    unknowns: &[Lane<N>],
) {
    other.add_product(kept, factor);
    row[0] = other;
    for (rhs, x) in row[1..].iter_mut().zip(unknowns) {
        rhs.add_product(kept, x);
    }
}

/// Entry (i, j) of s I - H.
fn entry<const N: usize>(H: &Mat, s: &Lane<N>, i: usize, j: usize) -> Lane<N> {
    let mut entry = if i == j { *s } else { Lane::ZERO };
    for l in 0..N {
        entry.re[l] -= H[(i, j)];
    }
    entry
}

/// (kept, other): the raw real entry and the current one, exchanged in the lanes where `swap` is one.
#[inline(always)]
fn choose<const N: usize>(raw: f64, current: &Lane<N>, swap: &[f64; N]) -> (Lane<N>, Lane<N>) {
    let (mut kept, mut other) = (Lane::ZERO, Lane::ZERO);
    for l in 0..N {
        let exchanged = swap[l] != 0.0;
        kept.re[l] = if exchanged { raw } else { current.re[l] };
        kept.im[l] = if exchanged { 0.0 } else { current.im[l] };
        other.re[l] = if exchanged { current.re[l] } else { raw };
        other.im[l] = if exchanged { current.im[l] } else { 0.0 };
    }
    (kept, other)
}

/// Adds s to whichever of the two came from the raw column.
#[inline(always)]
fn add_diagonal<const N: usize>(kept: &mut Lane<N>, other: &mut Lane<N>, s: &Lane<N>, swap: &[f64; N]) {
    let stay = swap.map(|w| 1.0 - w);
    for l in 0..N {
        kept.re[l] += swap[l] * s.re[l];
        kept.im[l] += swap[l] * s.im[l];
        other.re[l] += stay[l] * s.re[l];
        other.im[l] += stay[l] * s.im[l];
    }
}
