//! Chains of states that act on each other.

use std::collections::VecDeque;

use crate::kernel::vectorised;
use crate::mat::Mat;

/// What the places of the zeros of a matrix say of its powers.
pub(crate) struct Structure {
    /// The largest number of steps, each along an entry other than zero, that the shortest way from one state to another takes.
    pub(crate) longest_path: usize,
    /// For each state those that it never acts on, in whose rows every power of the matrix has a zero.
    unreached: Vec<Vec<usize>>,
}

impl Structure {
    /// Returns the structure of a square matrix: one breadth-first search from each state, n times the number of entries at most and n^2 operations
    /// if no entry is zero.
    pub(crate) fn of(A: &Mat) -> Self {
        let n = A.nrows();
        let targets: Vec<Vec<usize>> =
            (0..n).map(|j| (0..n).filter(|&i| i != j && A[(i, j)] != 0.0).collect()).collect();
        let steps = (0..n).map(|start| count_steps(&targets, start));
        let mut structure = Self { longest_path: 0, unreached: Vec::with_capacity(n) };
        for steps in steps {
            let depth = steps.iter().flatten().copied().max().unwrap_or(0);
            structure.longest_path = structure.longest_path.max(depth);
            structure.unreached.push((0..n).filter(|&i| steps[i].is_none()).collect());
        }
        structure
    }

    /// Returns the number of steps of the longest of the ways on which most of an entry of the exponential of `A`, the matrix of the structure, comes about, at least
    /// that of the longest of the shortest ways.
    ///
    /// Between two masses of a rod the shortest way leads through the dampers, and the terms of up to twice as many steps through the springs are larger.
    /// The moduli of the terms are computed along the entries other than zero.
    pub(crate) fn count_steps_of_largest_terms(&self, A: &Mat) -> usize {
        let mut terms = Moduli::of(A);
        let mut longest = self.longest_path;
        for k in 1..=2 * A.nrows() {
            if terms.advance(k, A.nrows()) > 1.0 {
                longest = longest.max(k);
            }
            // Of a matrix with two sorts of states every other term of an entry is zero.
            if k > longest + 2 {
                break;
            }
        }
        longest
    }

    /// Returns whether no other state both acts on a state and is acted on by it: the diagonal entry is then an eigenvalue, and no other entry moves it.
    pub(crate) fn is_alone(&self, i: usize) -> bool {
        (0..self.unreached.len())
            .all(|k| k == i || self.unreached[i].contains(&k) || self.unreached[k].contains(&i))
    }

    /// Sets the entries of a function of the matrix to zero where every power has a zero: pivoting leaves rounding errors there, which are
    /// not small beside the entries of states in other units.
    pub(crate) fn clear_unreached(&self, M: &mut Mat) {
        for (j, rows) in self.unreached.iter().enumerate() {
            rows.iter().for_each(|&i| M[(i, j)] = 0.0);
        }
    }

    /// Does the same for a function of the matrix times `B`.
    pub(crate) fn clear_unreached_by(&self, B: &Mat, M: &mut Mat) {
        if self.unreached.iter().all(Vec::is_empty) {
            return;
        }
        for k in 0..B.ncols() {
            let sources: Vec<usize> = (0..B.nrows()).filter(|&j| B[(j, k)] != 0.0).collect();
            for i in 0..B.nrows() {
                if sources.iter().all(|&j| self.unreached[j].contains(&i)) {
                    M[(i, k)] = 0.0;
                }
            }
        }
    }
}

/// Returns the number of steps to each state; `None` for one that is not reached.
fn count_steps(targets: &[Vec<usize>], start: usize) -> Vec<Option<usize>> {
    let n = targets.len();
    let mut steps = vec![None; n];
    steps[start] = Some(0);
    let (mut queue, mut reached) = (VecDeque::from([(start, 0)]), 1);
    while let Some((j, count)) = queue.pop_front().filter(|_| reached < n) {
        for &i in &targets[j] {
            if steps[i].is_none() {
                steps[i] = Some(count + 1);
                reached += 1;
                queue.push_back((i, count + 1));
            }
        }
    }
    steps
}

/// The moduli of a term `A^k / k!` of the exponential's series, and the largest ones of each entry so far, transposed.
pub(crate) struct Moduli {
    A: Mat,
    term: Mat,
    largest: Mat,
}

impl Moduli {
    /// Returns those of the first term, the identity.
    pub(crate) fn of(A: &Mat) -> Self {
        let first = Mat::eye(A.nrows());
        Self { A: A.map(f64::abs), term: first.clone(), largest: first }
    }

    /// Goes on to term `k`; returns its largest modulus over the largest one of the same entry before. An entry that is reached after more than `steps`
    /// steps does not count.
    pub(crate) fn advance(&mut self, k: usize, steps: usize) -> f64 {
        let n = self.A.nrows();
        let mut next = Mat::zeros(n, n);
        for l in 0..n {
            for (i, &a) in self.A.column(l).iter().enumerate().filter(|(_, a)| **a != 0.0) {
                add_scaled(next.column_mut(i), self.term.column(l), a / k as f64);
            }
        }
        let mut ratio = 0.0_f64;
        for (largest, &term) in self.largest.as_mut_slice().iter_mut().zip(next.as_slice()) {
            if *largest == 0.0 && term > 0.0 && k > steps {
                *largest = f64::INFINITY;
            }
            if term > ratio * *largest {
                ratio = term / *largest;
            }
            *largest = largest.max(term);
        }
        self.term = next;
        ratio
    }
}

vectorised! {
    fn add_scaled<'a>(sum: &'a mut [f64], term: &'a [f64], factor: f64) -> () {
        sum.iter_mut().zip(term).for_each(|(s, t)| *s += factor * t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_a_ring_and_a_full_matrix_have_their_depths() {
        let depth = |A: &Mat| Structure::of(A).longest_path;
        let chain = Mat::from_fn(7, 7, |i, j| if i == j + 1 || i == j { 1.0 } else { 0.0 });
        let ring = Mat::from_fn(7, 7, |i, j| if i == (j + 1) % 7 { 1.0 } else { 0.0 });
        assert_eq!([depth(&chain), depth(&ring)], [6, 6]);
        assert_eq!([depth(&Mat::from_fn(7, 7, |_, _| 1.0)), depth(&Mat::eye(3))], [1, 0]);
        assert_eq!(depth(&Mat::zeros(0, 0)), 0);
        let pair = Structure::of(&Mat::from_rows(&[&[1.0, 2.0, 0.0], &[3.0, 1.0, 0.0], &[4.0, 5.0, 1.0]]));
        assert_eq!([0, 1, 2].map(|i| pair.is_alone(i)), [false, false, true]);
    }

    #[test]
    fn what_no_state_reaches_is_cleared() {
        let A = Mat::from_rows(&[&[1.0, 0.0], &[1.0, 1.0]]);
        let (mut M, mut N) = (Mat::from_fn(2, 2, |_, _| 5.0), Mat::from_fn(2, 2, |_, _| 5.0));
        Structure::of(&A).clear_unreached(&mut M);
        assert_eq!(M, Mat::from_rows(&[&[5.0, 0.0], &[5.0, 5.0]]));
        Structure::of(&A).clear_unreached_by(&Mat::from_rows(&[&[0.0, 1.0], &[1.0, 0.0]]), &mut N);
        assert_eq!(N, Mat::from_rows(&[&[0.0, 5.0], &[5.0, 5.0]]));
    }
}
