//! The modes of a problem: how the input reaches each and how the cost sees it, computed once and when a question needs it.

use std::cell::OnceCell;

use crate::boundary::Boundary;
use crate::mat::C64;
use crate::spectrum::{Reach, Spectrum};
use crate::sylvester::Kind;

use super::scaling::Problem;

/// A problem with what is known of the modes of its `A`.
pub(super) struct Modes<'a> {
    pub(super) problem: &'a Problem,
    pub(super) kind: Kind,
    spectrum: OnceCell<Option<Table>>,
}

/// The spectrum of `A`, and for each mode with an imaginary part that is not negative its reach and its sight.
struct Table {
    spectrum: Spectrum,
    modes: Vec<C64>,
    reaches: Vec<OnceCell<Reach>>,
    sights: Vec<OnceCell<Reach>>,
}

/// One mode of a problem.
#[derive(Clone, Copy)]
pub(super) struct Mode<'a> {
    owner: &'a Table,
    problem: &'a Problem,
    index: usize,
}

impl<'a> Modes<'a> {
    pub(super) fn of(problem: &'a Problem, kind: Kind) -> Self {
        Self { problem, kind, spectrum: OnceCell::new() }
    }

    /// The modes with an imaginary part that is not negative; none if the spectrum cannot be computed.
    pub(super) fn all(&self) -> impl Iterator<Item = Mode<'_>> {
        let table = self.table();
        let count = table.map_or(0, |table| table.modes.len());
        table
            .into_iter()
            .flat_map(move |owner| (0..count).map(move |index| Mode { owner, problem: self.problem, index }))
    }

    /// Those on the boundary of stability as far as the entries of `A` say.
    pub(super) fn modes_on_boundary(&self, boundary: Boundary) -> Vec<Mode<'_>> {
        let Some(table) = self.table() else { return Vec::new() };
        let found = table.spectrum.eigenvalues_on_boundary(boundary);
        self.all().filter(|mode| found.contains(&mode.value())).collect()
    }

    fn table(&self) -> Option<&Table> {
        let make = || {
            let spectrum = Spectrum::of(&self.problem.A).ok()?;
            let modes = spectrum.modes();
            let empty = || modes.iter().map(|_| OnceCell::new()).collect();
            Some(Table { reaches: empty(), sights: empty(), modes, spectrum })
        };
        self.spectrum.get_or_init(make).as_ref()
    }
}

impl<'a> Mode<'a> {
    /// The eigenvalue.
    pub(super) fn value(self) -> C64 {
        self.owner.modes[self.index]
    }

    /// By how much rounding the entries of `A` may move it.
    pub(super) fn rounding_error(self) -> f64 {
        self.owner.spectrum.rounding_error(self.value())
    }

    /// Returns how the input reaches it.
    pub(super) fn reachability(self) -> &'a Reach {
        let make = || self.owner.spectrum.reachability(&self.problem.G, self.value());
        self.owner.reaches[self.index].get_or_init(make)
    }

    /// Returns how the cost sees it.
    pub(super) fn observability(self) -> &'a Reach {
        let make = || self.owner.spectrum.observability(&self.problem.Q, self.value());
        self.owner.sights[self.index].get_or_init(make)
    }
}
