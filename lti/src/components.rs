//! The dependence of states on each other: a system made of blocks in series is block triangular, and is computed block by block.
//!
//! An integrator behind a plant keeps its pole at exactly zero, and a slow weight its digits beside a fast structure.

use crate::{Mat, StateSpace};

/// Returns the groups of states that act on each other, ordered so that A is block upper triangular in them.
pub fn components(A: &Mat) -> Vec<Vec<usize>> {
    let n = A.nrows();
    let reach = reachability(A);
    let size: Vec<u32> = reach.iter().map(|row| row.iter().map(|word| word.count_ones()).sum()).collect();
    let mutual = |i: usize, j: usize| has(&reach[i], j) && has(&reach[j], i);
    let mut taken = vec![false; n];
    let mut groups = Vec::new();
    for i in 0..n {
        if !taken[i] {
            let group: Vec<usize> = (i..n).filter(|&j| mutual(i, j)).collect();
            group.iter().for_each(|&j| taken[j] = true);
            groups.push(group);
        }
    }
    // Who acts on more comes later; a stable sort keeps independent groups in the order of their states.
    groups.sort_by_key(|group| size[group[0]]);
    groups
}

/// Returns the groups of states that have nothing to do with each other: A is block diagonal in them.
pub fn independent_blocks(A: &Mat) -> Vec<Vec<usize>> {
    let n = A.nrows();
    let mut group: Vec<usize> = (0..n).collect();
    for j in 0..n {
        for i in (0..n).filter(|&i| A[(i, j)] != 0.0) {
            let (a, b) = (root(&mut group, i), root(&mut group, j));
            group[a.max(b)] = a.min(b);
        }
    }
    let mut groups = vec![Vec::new(); n];
    for i in 0..n {
        groups[root(&mut group, i)].push(i);
    }
    groups.retain(|members| !members.is_empty());
    groups
}

/// Returns the first member of a state's group (union-find with path halving).
fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

/// For each state the set of states it acts on, itself among them, as bits (Warshall's closure).
fn reachability(A: &Mat) -> Vec<Vec<u64>> {
    let n = A.nrows();
    let mut reach = vec![vec![0_u64; n.div_ceil(64)]; n];
    for (j, row) in reach.iter_mut().enumerate() {
        for (i, _) in A.column(j).iter().enumerate().filter(|&(i, &a)| a != 0.0 || i == j) {
            row[i / 64] |= 1 << (i % 64);
        }
    }
    for k in 0..n {
        let through = reach[k].clone();
        for row in reach.iter_mut().filter(|row| has(row, k)) {
            row.iter_mut().zip(&through).for_each(|(word, more)| *word |= more);
        }
    }
    reach
}

fn has(row: &[u64], bit: usize) -> bool {
    row[bit / 64] >> (bit % 64) & 1 == 1
}

/// Returns the states to which couplings lead from an input, in rising order.
pub fn driven_states(g: &StateSpace) -> Vec<usize> {
    let mut is_reached: Vec<bool> =
        (0..g.order()).map(|i| (0..g.inputs()).any(|k| g.B[(i, k)] != 0.0)).collect();
    let mut open: Vec<usize> = (0..g.order()).filter(|&i| is_reached[i]).collect();
    while let Some(j) = open.pop() {
        for i in 0..g.order() {
            if !is_reached[i] && g.A[(i, j)] != 0.0 {
                is_reached[i] = true;
                open.push(i);
            }
        }
    }
    (0..g.order()).filter(|&i| is_reached[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_connected_is_independent() {
        let mut A = Mat::eye(5);
        (A[(0, 3)], A[(4, 3)]) = (1.0, 1.0);
        assert_eq!(independent_blocks(&A), vec![vec![0, 3, 4], vec![1], vec![2]]);
    }

    #[test]
    fn a_cascade_falls_into_its_parts_in_upper_triangular_order() {
        // 0 <-> 2 drive 1; 1 drives 3.
        let mut A = Mat::zeros(4, 4);
        for (to, from) in [(0, 2), (2, 0), (1, 0), (3, 1)] {
            A[(to, from)] = 1.0;
        }
        assert_eq!(components(&A), vec![vec![3], vec![1], vec![0, 2]]);
    }
}
