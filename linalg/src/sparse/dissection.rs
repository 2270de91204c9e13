//! The order in which a large structure's unknowns are eliminated: nested dissection.
//!
//! A set of unknowns whose removal parts the structure in two is eliminated last, and each part is ordered in the same way. For a
//! structure in space the factors then have a fraction of the entries that a minimum degree leaves. Sources: George, SIAM J. Numer.
//! Anal. 10 (1973) 345; for the separators, level sets (George and Liu 1981, chapter 8), refined as Fiduccia and Mattheyses (DAC 1982) do, on
//! separators of vertices (Ashcraft and Liu, SIAM J. Matrix Anal. 19 (1998) 325).

use std::collections::BinaryHeap;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::matrix::Sparse;
use crate::error::Error;
use crate::tolerance::LARGEST_PART;

/// Parts of at most this many unknowns are ordered by minimum degree, which is as good there.
const LEAF: usize = 120;

/// Unknowns of the larger part that count as much as one of the separator.
const SIZE_OF_PART: usize = 100;

/// Rounds of refinement of a separator; the third one seldom finds anything.
const ROUNDS: usize = 4;

/// Moves without a smaller separator after which a round of refinement ends, as a share of the separator, and at least so many.
const PATIENCE: (f64, usize) = (0.5, 60);

/// The place of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    First,
    Second,
    Separator,
}

impl Side {
    fn opposite(self) -> Self {
        match self {
            Self::First => Self::Second,
            _ => Self::First,
        }
    }
}

/// Two parts that are coupled only through a separator.
struct Separation {
    parts: [Vec<u32>; 2],
    separator: Vec<u32>,
}

/// Who is coupled with whom, without the diagonal.
#[derive(Debug)]
pub(super) struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph of a symmetric matrix.
    pub(super) fn of(A: &Sparse) -> Self {
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(A.entry_count()));
        for j in 0..A.ncols() {
            neighbours.extend(A.column(j).filter(|(i, _)| *i != j).map(|(i, _)| i as u32));
            starts.push(neighbours.len() as u32);
        }
        Self { starts, neighbours }
    }

    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn of_vertex(&self, v: u32) -> &[u32] {
        &self.neighbours[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }

    /// The graph of some of the vertices; `place` has a number for each vertex and is left as it was.
    fn part(&self, vertices: &[u32], place: &mut [u32]) -> Self {
        vertices.iter().enumerate().for_each(|(k, &v)| place[v as usize] = k as u32);
        let (mut starts, mut neighbours) = (vec![0], Vec::new());
        for &v in vertices {
            let inside = self.of_vertex(v).iter().map(|&u| place[u as usize]);
            neighbours.extend(inside.filter(|&k| k != u32::MAX));
            starts.push(neighbours.len() as u32);
        }
        vertices.iter().for_each(|&v| place[v as usize] = u32::MAX);
        Self { starts, neighbours }
    }

    /// The distance of each vertex from one, and the vertices in the order of their distance; those out of reach are not among them.
    fn levels(&self, from: u32) -> (Vec<u32>, Vec<u32>) {
        let mut level = vec![u32::MAX; self.len()];
        let mut reached = vec![from];
        level[from as usize] = 0;
        let mut next = 0;
        while let Some(&v) = reached.get(next) {
            next += 1;
            for &u in self.of_vertex(v) {
                if level[u as usize] == u32::MAX {
                    level[u as usize] = level[v as usize] + 1;
                    reached.push(u);
                }
            }
        }
        (level, reached)
    }
}

/// Returns the order of elimination: the k-th is the vertex that is eliminated as the k-th.
///
/// # Errors
/// [`Error::TooLarge`] if there is no memory for the ordering.
pub(super) fn nested_dissection(graph: &Graph) -> Result<Vec<u32>, Error> {
    let names: Vec<u32> = (0..graph.len() as u32).collect();
    let mut order = Vec::with_capacity(names.len());
    dissect(graph, &names, &mut order)?;
    Ok(order)
}

fn dissect(graph: &Graph, names: &[u32], order: &mut Vec<u32>) -> Result<(), Error> {
    if graph.len() <= LEAF {
        return leaf(graph, names, order);
    }
    let apart = components(graph);
    let (parts, separator) = match apart.len() {
        1 => match separate_parts(graph) {
            Some(found) => (found.parts.into(), found.separator),
            None => return leaf(graph, names, order),
        },
        _ => (apart, Vec::new()),
    };
    let mut place = vec![u32::MAX; graph.len()];
    for part in &parts {
        let named: Vec<u32> = part.iter().map(|&v| names[v as usize]).collect();
        let smaller = graph.part(part, &mut place);
        dissect(&smaller, &named, order)?;
    }
    order.extend(separator.iter().map(|&v| names[v as usize]));
    Ok(())
}

/// Orders the vertices by minimum degree.
fn leaf(graph: &Graph, names: &[u32], order: &mut Vec<u32>) -> Result<(), Error> {
    order.extend(minimum_degree(graph)?.into_iter().map(|v| names[v as usize]));
    Ok(())
}

/// Returns the order of elimination by approximate minimum degree.
///
/// # Errors
/// [`Error::TooLarge`] if there is no memory for the ordering.
pub(super) fn minimum_degree(graph: &Graph) -> Result<Vec<u32>, Error> {
    let n = graph.len();
    if n == 0 {
        return Ok(Vec::new());
    }
    let too_large = || Error::TooLarge { what: "the ordering of a sparse matrix", rows: n };
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, &graph.starts, None, &graph.neighbours);
    let need = amd::order_maybe_unsorted_scratch::<u32>(n, graph.neighbours.len());
    let mut buffer = MemBuffer::try_new(need).map_err(|_| too_large())?;
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    let stack = MemStack::new(&mut buffer);
    amd::order_maybe_unsorted(&mut order, &mut place, pattern, amd::Control::default(), stack)
        .map_err(|_| too_large())?;
    Ok(order)
}

/// The parts that are not coupled with each other. A graph in one piece is returned as one part.
fn components(graph: &Graph) -> Vec<Vec<u32>> {
    let mut is_reached = vec![false; graph.len()];
    let mut parts = Vec::new();
    for v in 0..graph.len() as u32 {
        if !is_reached[v as usize] {
            let mut part = vec![v];
            is_reached[v as usize] = true;
            let mut next = 0;
            while let Some(&u) = part.get(next) {
                next += 1;
                for &w in graph.of_vertex(u) {
                    if !std::mem::replace(&mut is_reached[w as usize], true) {
                        part.push(w);
                    }
                }
            }
            // Rows of a pattern rise, and so do those of its parts.
            part.sort_unstable();
            parts.push(part);
        }
    }
    parts
}

/// Two parts and what separates them; `None` if there are no two parts, as in a full matrix.
fn separate_parts(graph: &Graph) -> Option<Separation> {
    let mut sides = by_levels(graph)?;
    for _ in 0..ROUNDS {
        if !Refinement::new(graph, &mut sides).run() {
            break;
        }
    }
    let of =
        |side: Side| (0..graph.len() as u32).filter(|&v| sides[v as usize] == side).collect::<Vec<u32>>();
    let parts = [of(Side::First), of(Side::Second)];
    let is_parted = parts.iter().all(|part| !part.is_empty());
    is_parted.then(|| Separation { parts, separator: of(Side::Separator) })
}

/// The level set about a vertex at the border that separates best.
fn by_levels(graph: &Graph) -> Option<Vec<Side>> {
    let mut from = 0;
    for _ in 0..2 {
        from = *graph.levels(from).1.last()?;
    }
    let (level, reached) = graph.levels(from);
    let depth = level[*reached.last()? as usize] as usize + 1;
    let mut sizes = vec![0_usize; depth];
    level.iter().for_each(|&l| sizes[l as usize] += 1);
    let (n, mut before) = (graph.len(), 0);
    let mut best: Option<((usize, usize), usize)> = None;
    for (l, &size) in sizes.iter().enumerate() {
        let (first, second) = (before, n - before - size);
        before += size;
        // A small separator is sought among those that leave parts of like size; among the others, like parts.
        let largest = first.max(second);
        let excess = largest.saturating_sub((LARGEST_PART * n as f64) as usize);
        let cost = (excess, size + largest / SIZE_OF_PART);
        if first > 0 && second > 0 && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, l));
        }
    }
    let (_, middle) = best?;
    let side = |&l: &u32| match (l as usize).cmp(&middle) {
        std::cmp::Ordering::Less => Side::First,
        std::cmp::Ordering::Equal => Side::Separator,
        std::cmp::Ordering::Greater => Side::Second,
    };
    Some(level.iter().map(side).collect())
}

/// A vertex of the separator that may go to a side; `gain` is by how many the separator becomes smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Move {
    gain: i32,
    vertex: std::cmp::Reverse<u32>,
    to_first: bool,
}

/// A vertex that went to another side, for the way back.
struct SideChange {
    vertex: u32,
    before: Side,
}

/// One round: vertices leave the separator one by one, the best first, also for the worse; what was smallest is kept.
struct Refinement<'a> {
    graph: &'a Graph,
    sides: &'a mut [Side],
    sizes: [usize; 3],
    queue: BinaryHeap<Move>,
    is_moved: Vec<bool>,
}

impl<'a> Refinement<'a> {
    fn new(graph: &'a Graph, sides: &'a mut [Side]) -> Self {
        let mut sizes = [0; 3];
        sides.iter().for_each(|&side| sizes[side as usize] += 1);
        let is_moved = vec![false; graph.len()];
        let mut out = Self { graph, sides, sizes, queue: BinaryHeap::new(), is_moved };
        (0..graph.len() as u32).for_each(|v| out.enqueue(v));
        out
    }

    fn enqueue(&mut self, v: u32) {
        if self.sides[v as usize] == Side::Separator && !self.is_moved[v as usize] {
            for to in [Side::First, Side::Second] {
                let (vertex, to_first) = (std::cmp::Reverse(v), to == Side::First);
                self.queue.push(Move { gain: self.gain(v, to), vertex, to_first });
            }
        }
    }

    fn gain(&self, v: u32, to: Side) -> i32 {
        let pulled = self.graph.of_vertex(v).iter().filter(|&&u| self.sides[u as usize] == to.opposite());
        1 - pulled.count() as i32
    }

    /// Returns what is made small: the separator, and among equal ones the difference of the parts.
    fn cost(&self) -> (usize, usize) {
        (self.sizes[2], self.sizes[0].abs_diff(self.sizes[1]))
    }

    /// Returns whether the separator became better.
    fn run(mut self) -> bool {
        let start = self.cost();
        let (mut best, mut kept) = (start, 0);
        let mut log: Vec<SideChange> = Vec::new();
        let limit = ((self.sizes[2] as f64 * PATIENCE.0) as usize).max(PATIENCE.1);
        let (mut idle, largest) = (0, (LARGEST_PART * self.graph.len() as f64) as usize);
        while let Some(next) = self.queue.pop() {
            let (v, to) = (next.vertex.0, if next.to_first { Side::First } else { Side::Second });
            if self.sides[v as usize] != Side::Separator || self.is_moved[v as usize] {
                continue;
            }
            let gain = self.gain(v, to);
            if gain < next.gain {
                self.queue.push(Move { gain, ..next });
                continue;
            }
            if self.sizes[to as usize] >= largest {
                continue;
            }
            self.apply(v, to, &mut log);
            idle += 1;
            if self.cost() < best {
                (best, kept, idle) = (self.cost(), log.len(), 0);
            }
            if idle > limit {
                break;
            }
        }
        for change in log.drain(kept..).rev() {
            self.sides[change.vertex as usize] = change.before;
        }
        best < start
    }

    /// Moves a vertex out of the separator; its neighbours on the other side come into it.
    fn apply(&mut self, v: u32, to: Side, log: &mut Vec<SideChange>) {
        self.change(v, to, log);
        self.is_moved[v as usize] = true;
        let graph = self.graph;
        for &u in graph.of_vertex(v) {
            if self.sides[u as usize] == to.opposite() {
                self.change(u, Side::Separator, log);
                self.enqueue(u);
                graph.of_vertex(u).iter().for_each(|&w| self.enqueue(w));
            }
        }
    }

    fn change(&mut self, v: u32, to: Side, log: &mut Vec<SideChange>) {
        let old = std::mem::replace(&mut self.sides[v as usize], to);
        self.sizes[old as usize] -= 1;
        self.sizes[to as usize] += 1;
        log.push(SideChange { vertex: v, before: old });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sparse::Entry;

    /// A lattice of side x side x side points, each coupled with its neighbours.
    fn lattice(side: usize) -> Sparse {
        let n = side * side * side;
        let mut list = Vec::new();
        for i in 0..n {
            list.push(Entry { row: i, col: i, value: 6.0 });
            let place = [i % side, i / side % side, i / side / side];
            for (step, k) in [1, side, side * side].into_iter().zip(place) {
                if k + 1 < side {
                    list.push(Entry { row: i, col: i + step, value: -1.0 });
                    list.push(Entry { row: i + step, col: i, value: -1.0 });
                }
            }
        }
        Sparse::from_entries(n, n, &list).unwrap()
    }

    #[test]
    fn every_unknown_is_eliminated_once() {
        let mut two = lattice(8).entries().collect::<Vec<Entry>>();
        two.extend(lattice(8).entries().map(|e| Entry { row: e.row + 512, col: e.col + 512, ..e }));
        for A in [lattice(2), lattice(9), Sparse::from_entries(1024, 1024, &two).unwrap()] {
            let mut order = nested_dissection(&Graph::of(&A)).unwrap();
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(k, &v)| k == v as usize) && order.len() == A.nrows());
        }
    }

    #[test]
    fn a_separator_leaves_no_coupling_between_the_parts() {
        let graph = Graph::of(&lattice(10));
        let found = separate_parts(&graph).unwrap();
        assert!(found.separator.len() <= 110, "{}", found.separator.len());
        let is_first: Vec<bool> = (0..1000).map(|v| found.parts[0].contains(&v)).collect();
        let coupled = |v: &u32| graph.of_vertex(*v).iter().any(|&u| is_first[u as usize]);
        assert!(!found.parts[1].iter().any(coupled));
        assert!(found.parts.iter().all(|part| part.len() > 250));
    }
}
