//! The inner loop of the frequency response: C inv(s I - H) B for several s at a time, H upper Hessenberg.

use crate::{C64, Mat};

/// How many points are worked on side by side.
pub(crate) const LANES: usize = 8;

/// One complex number for each point, real and imaginary parts apart so that the compiler vectorises.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lane {
    re: [f64; LANES],
    im: [f64; LANES],
}

impl Lane {
    const ZERO: Self = Self { re: [0.0; LANES], im: [0.0; LANES] };

    pub(crate) fn new(values: &[C64; LANES]) -> Self {
        Self { re: values.map(|v| v.re), im: values.map(|v| v.im) }
    }

    fn real(x: f64) -> Self {
        Self { re: [x; LANES], im: [0.0; LANES] }
    }

    pub(crate) fn get(&self, lane: usize) -> C64 {
        C64::new(self.re[lane], self.im[lane])
    }

    /// self += a b.
    #[inline(always)]
    fn add_product(&mut self, a: &Self, b: &Self) {
        for l in 0..LANES {
            self.re[l] += a.re[l] * b.re[l] - a.im[l] * b.im[l];
            self.im[l] += a.re[l] * b.im[l] + a.im[l] * b.re[l];
        }
    }

    /// a / b by complex division lane by lane; only O(n) of these are needed.
    #[inline(always)]
    fn quotient(a: &Self, b: &Self) -> Self {
        let mut out = Self::ZERO;
        for l in 0..LANES {
            let scale = 1.0 / b.re[l].abs().max(b.im[l].abs());
            let (x, y) = (b.re[l] * scale, b.im[l] * scale);
            let size = scale / (x * x + y * y);
            out.re[l] = (a.re[l] * x + a.im[l] * y) * size;
            out.im[l] = (a.im[l] * x - a.re[l] * y) * size;
        }
        out
    }
}

/// C inv(s I - H) B, column-major, one [`Lane`] an entry; a pole gives infinities or NaN.
///
/// The columns of s I - H are combined from the last to the first so that it becomes upper triangular; each finished
/// column is used for the back substitution at once and forgotten.
pub(crate) fn sweep(H: &Mat, B: &Mat, C: &Mat, s: &Lane) -> Vec<Lane> {
    let mut state = Sweep::start(H, B, C, s);
    pulp::Arch::new().dispatch(|| state.run());
    state.answer
}

struct Sweep<'a> {
    H: &'a Mat,
    C: &'a Mat,
    s: &'a Lane,
    /// The column of s I - H that is being combined.
    column: Vec<Lane>,
    /// The same column of C, combined likewise.
    out: Vec<Lane>,
    /// What is left of B, n x m.
    rhs: Vec<Lane>,
    /// p x m.
    answer: Vec<Lane>,
    n: usize,
    m: usize,
    p: usize,
}

impl<'a> Sweep<'a> {
    fn start(H: &'a Mat, B: &Mat, C: &'a Mat, s: &'a Lane) -> Self {
        let (n, m, p) = (H.nrows(), B.ncols(), C.nrows());
        let mut start = Self {
            H,
            C,
            s,
            column: Vec::with_capacity(n),
            out: Vec::with_capacity(p),
            rhs: B.as_slice().iter().map(|&b| Lane::real(b)).collect(),
            answer: vec![Lane::ZERO; p * m],
            n,
            m,
            p,
        };
        if n > 0 {
            start.column = (0..n).map(|i| start.entry(i, n - 1)).collect();
            start.out = C.column(n - 1).iter().map(|&c| Lane::real(c)).collect();
        }
        start
    }

    /// Entry (i, j) of s I - H.
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> Lane {
        let h = Lane::real(-self.H[(i, j)]);
        if i != j {
            return h;
        }
        let mut diagonal = *self.s;
        for l in 0..LANES {
            diagonal.re[l] += h.re[l];
        }
        diagonal
    }

    #[inline(always)]
    fn run(&mut self) {
        for k in (1..self.n).rev() {
            self.combine(k);
        }
        if self.n > 0 {
            let pivot = self.column[0];
            for j in 0..self.m {
                let x = Lane::quotient(&self.rhs[j * self.n], &pivot);
                for i in 0..self.p {
                    let c = self.out[i];
                    self.answer[j * self.p + i].add_product(&c, &x);
                }
            }
        }
    }

    /// Makes entry (k, k-1) zero with columns k-1 and k, solves for unknown k, and leaves the new column k-1.
    #[inline(always)]
    fn combine(&mut self, k: usize) {
        let sub = Lane::real(-self.H[(k, k - 1)]);
        let current = self.column[k];
        let mut swap = [0.0; LANES];
        let (mut large, mut small) = (current, sub);
        for l in 0..LANES {
            if current.re[l].abs() + current.im[l].abs() < sub.re[l].abs() {
                swap[l] = 1.0;
                (large.re[l], small.re[l]) = (sub.re[l], current.re[l]);
                (large.im[l], small.im[l]) = (sub.im[l], current.im[l]);
            }
        }
        // A column that is zero in both needs no combination: the pivot is zero and the answer infinite.
        let mut factor = Lane::quotient(&small, &large);
        for l in 0..LANES {
            factor.re[l] = -factor.re[l];
            factor.im[l] = -factor.im[l];
        }
        let unknowns = self.solve(k, &large, &swap);
        self.columns(k, &factor, &swap, &unknowns);
    }

    /// The unknowns k, negated, one for each input.
    #[inline(always)]
    fn solve(&mut self, k: usize, pivot: &Lane, swap: &[f64; LANES]) -> Vec<Lane> {
        let mut unknowns = Vec::with_capacity(self.m);
        for j in 0..self.m {
            let x = Lane::quotient(&self.rhs[j * self.n + k], pivot);
            for i in 0..self.p {
                let raw = self.C[(i, k - 1)];
                let (kept, _) = choose(raw, &self.out[i], swap);
                self.answer[j * self.p + i].add_product(&kept, &x);
            }
            unknowns.push(Lane { re: x.re.map(|v| -v), im: x.im.map(|v| -v) });
        }
        unknowns
    }

    /// Column k is finished and taken out of the right-hand sides; column k-1 is the other one plus factor times it.
    #[inline(always)]
    fn columns(&mut self, k: usize, factor: &Lane, swap: &[f64; LANES], unknowns: &[Lane]) {
        let raw = &self.H.column(k - 1)[..k];
        for (i, &h) in raw.iter().enumerate() {
            let (mut kept, mut other) = choose(-h, &self.column[i], swap);
            if i == k - 1 {
                add_diagonal(&mut kept, &mut other, self.s, swap);
            }
            other.add_product(&kept, factor);
            self.column[i] = other;
            for (j, x) in unknowns.iter().enumerate() {
                self.rhs[j * self.n + i].add_product(&kept, x);
            }
        }
        for i in 0..self.p {
            let (kept, mut other) = choose(self.C[(i, k - 1)], &self.out[i], swap);
            other.add_product(&kept, factor);
            self.out[i] = other;
        }
    }
}

/// (kept, other): the raw real entry and the current one, exchanged in the lanes where `swap` is one.
#[inline(always)]
fn choose(raw: f64, current: &Lane, swap: &[f64; LANES]) -> (Lane, Lane) {
    let (mut kept, mut other) = (Lane::ZERO, Lane::ZERO);
    for l in 0..LANES {
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
fn add_diagonal(kept: &mut Lane, other: &mut Lane, s: &Lane, swap: &[f64; LANES]) {
    let stay = swap.map(|w| 1.0 - w);
    for l in 0..LANES {
        kept.re[l] += swap[l] * s.re[l];
        kept.im[l] += swap[l] * s.im[l];
        other.re[l] += stay[l] * s.re[l];
        other.im[l] += stay[l] * s.im[l];
    }
}
