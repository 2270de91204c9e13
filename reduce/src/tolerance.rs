//! The numbers that decide in the reductions, in one place: what each decides, and why it has this size.
//!
//! If a comment names no source, the number was set on the systems of `reduce/tests` (the benchmarks of the literature among them),
//! which hold with it.

// ---- error of a reduction ----

/// Order of the error system up to which its norm is computed exactly: the Hamiltonian matrix has twice that order, and its
/// eigenvalues take a tenth of a second for each step.
pub const EXACT_ORDER: usize = 120;

/// Relative tolerance of the exact norm.
pub const EXACT_NORM: f64 = 1e-6;

/// Points of the logarithmic part of the grid.
pub const GRID_POINTS: usize = 300;

/// Decades that the grid goes beyond the poles.
pub const GRID_BEYOND: f64 = 100.0;

// ---- minimal realisations ----

/// A ratio of kept to dropped singular values smaller than this leaves the order in doubt.
pub const SAFE_GAP: f64 = 1e3;

/// A smallest value kept that is not so many times the largest one dropped, or the unit roundoff, may be rounding that small couplings before it have
/// magnified: eight of sixteen digits.
pub const CERTAIN_GAP: f64 = 1e8;

/// States up to which such a staircase is computed again in 32 digits: that of the largest takes some hundred milliseconds.
pub const PRECISE_STATES: usize = 32;

/// Share of a unit's own square that is added to the least squares of the logarithms of the couplings, so that a free unit stays as it is: units 1e12 apart
/// are then found to 1e-7 of their logarithm.
pub const FREE_UNIT: f64 = 1e-9;

/// A unit that does not shrink the norms of a state's row and column by this factor is not changed (B. Parlett and C. Reinsch, Numerische Mathematik
/// 13, 1969).
pub const UNIT_GAIN: f64 = 0.95;

/// Sweeps over the units at most; three to ten are usual. Those that a chain of many states would go on with do not depend on the given units either.
pub const UNIT_SWEEPS: usize = 60;

// ---- pairs of values ----

/// Values closer than this, relative, are a pair (a mode of damping 0.05 has two values so far apart).
pub const PAIRED_VALUES: f64 = 0.1;

// ---- reduced structures ----

/// Natural frequencies compared to measure an error; as many as the reduced structure has, at most this many.
pub const COMPARED_FREQUENCIES: usize = 6;

// ---- large structures ----

/// A step of the iteration for low-rank Gramians that contributes less than this share of the factor is idle. The Gramian, and with it the squares of
/// the Hankel values, is then right to about the square of it, relative to the largest.
pub const IDLE_CONTRIBUTION: f64 = 1e-7;

/// Factorisations of a large structure at most. It takes about one for each motion that matters, and two hundred take an hour at 200 000 unknowns.
pub const MOST_STEPS: usize = 200;

// ---- stable and unstable parts ----

/// A pole counts as on the border of stability within this share of its size.
pub const BORDER: f64 = 1e-9;

/// ... or within this share of the norm of the entries of the scaled A among which it is computed.
pub const BORDER_NORM: f64 = 1e-13;

/// Reordering moves a pole by less than this share of the norm of A: fifty times the unit roundoff, as its swaps are backward stable
/// (Z. Bai and J. Demmel, Linear Algebra and its Applications 186, 1993).
pub const REORDERING_SHIFT: f64 = 1e-14;

/// Poles this near to the boundary, relative to the norm of A, are examined one by one: both halves of a double pole there
/// that rounding has split lie within it.
pub const SUSPECT_POLE: f64 = 1e-7;

/// A pole belongs to a cluster on the boundary within this many times the distance of its farthest member.
pub const CLUSTER_REACH: f64 = 2.0;

/// A natural frequency below this share of the highest compared is that of a rigid motion, and its error is taken relative to the highest.
pub const RIGID_RATE: f64 = 1e-6;
