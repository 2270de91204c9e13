//! The numbers that decide in the models, in one place: what each decides, why it has this size, and what another size costs.

// ---- friction ----

/// Normalised rate beyond which exp(-x^2) is 0: it is below 1e-21 there and no longer changes a level, and libraries are slow where
/// exp underflows.
pub(crate) const SPENT: f64 = 7.0;
/// Distance from the yielded torque, relative to the level, below which the slope of |r|^i with i < 1 is held: it is infinite
/// at 0.
pub(crate) const YIELDED: f64 = 1e-9;
/// The least factor on the Coulomb level: keeps laws that divide by it finite.
pub(crate) const LEAST_LEVEL: f64 = 1e-6;
/// A displacement beyond this many bonds has forgotten where it started: the excess is left out, so that a long travel does not cost
/// a snap for each of its bonds.
pub(crate) const MEMORY_BONDS: f64 = 64.0;
/// Rates at which the level of a polynomial curve is checked, evenly from rest to the Stribeck rate, beyond which it is
/// constant: the least level of the curve is at most 1/400 of the Stribeck rate away from one of them.
pub(crate) const POLYNOMIAL_CHECKS: i32 = 200;
/// Sweeps over the joints after which contact torques are returned as they are; see [`crate::friction::Contact::sweeps`].
pub const MOST_SWEEPS: usize = 500;
/// Change of a rate over a sweep, relative to the largest rate, that counts as none: about ninety roundings of double precision.
pub(crate) const SETTLED: f64 = 1e-14;
/// Steps per period of the motion under which a describing function is found.
pub(crate) const LOOP_STEPS: usize = 2000;
/// Periods after which a friction loop that has not closed is returned as it is.
pub(crate) const MOST_PERIODS: usize = 200;
/// A friction loop is closed when a state repeats to this fraction of its largest value.
pub(crate) const CLOSED: f64 = 1e-13;

// ---- drive ----

/// Motor rate over which the direction of the power through the mesh changes, rad/s: a jump there would be one of the torque at every reversal.
pub(crate) const POWER_REVERSAL_RATE: f64 = 0.05;

/// Iterations on the kinematic error at rest: each leaves ratio x order x amplitude of the error before, a few hundredths for a
/// harmonic drive, so that twenty reach double precision.
pub(crate) const KINEMATIC_ITERATIONS: usize = 20;

// ---- free functions ----

/// Deviation of a point from even spacing, relative to the spacing, that is rounding: the interval is then found without a search.
pub(crate) const LEARNED_SPACING: f64 = 1e-9;
/// Points on either side of a turn with which a repeating function is made a spline: the influence of a point falls by 0.27 with each
/// point between, so that ten leave a millionth.
pub(crate) const PERIODIC_COPIES: usize = 10;
/// Iterations on the equilibrium of a plant with free functions: those of an angle are settled by the first, those of load and
/// control come nearer with each.
pub(crate) const LEARNED_ITERATIONS: usize = 20;
/// Iterations on what a sensor would have read without its errors: each adds the width of a dead band at most, so that a reading of 50 of them
/// is still found.
pub(crate) const READING_ITERATIONS: usize = 50;
/// Relative change of that reading that is rounding.
pub(crate) const READING_ROUNDING: f64 = 1e-14;

// ---- structure ----

/// Gap between sections that still counts as adjoining, relative to the beam's length: rounding of stations in a file.
pub(crate) const ADJOINING: f64 = 1e-9;
/// Distance between the pivot and a station or node, relative to the beam, at which they are the same place.
pub(crate) const AT_PIVOT: f64 = 1e-9;
/// Difference of two cross sections, relative, that counts as none.
pub(crate) const SAME_SECTION: f64 = 1e-12;
/// Elements beyond which rounding spoils the first mode.
pub(crate) const MOST_ELEMENTS: usize = 2000;
/// Resistance of K to a rigid motion, relative to its norm, that counts as none: matrices written with six digits pass.
pub(crate) const FREE: f64 = 1e-6;
/// Asymmetry of an imported matrix that is taken for rounding and removed, relative to its largest entry.
pub(crate) const ASYMMETRY_OF_IMPORT: f64 = 1e-6;
/// Unknowns beyond which an imported matrix is refused: a structure of this size takes more memory than a workstation has.
pub(crate) const MOST_ROWS: usize = 2_000_000;
/// Unknowns beyond which an imported structure is condensed before it is analysed: dense algebra takes about a second there, and grows
/// with the third power.
pub const LARGE_STRUCTURE: usize = 600;
/// Nodes between hub and tip whose unknowns stay in a condensed structure: enough to draw the shapes of the first modes.
pub(crate) const LARGE_STRUCTURE_NODES: usize = 8;
/// Modes of a condensed structure beyond those that are asked for; what is left out acts statically.
pub const SPARE_MODES: usize = 6;
/// Residual at which a mode of a large structure counts as found: the frequency is then right to its square, beyond the
/// rounding of the stiffness matrix.
pub(crate) const MODE_RESIDUAL: f64 = 1e-8;
/// A mode that stores less than this many roundings of the terms of its energy is a rigid motion: the error of a sum of some
/// hundred terms.
pub(crate) const RIGID_MODE: f64 = 100.0;
/// A shape that keeps less than this share of its length once it is made orthogonal to others adds nothing: its square is the error
/// of a frequency.
pub(crate) const DEPENDENT_SHAPE: f64 = 1e-7;
/// Damping ratio below which balanced shapes are sought with this one: what ranks lightly damped modes does not depend on a common ratio, and
/// smaller ones cost digits.
pub(crate) const LEAST_RATIO: f64 = 1e-3;
/// Second frequency of proportional damping, relative to the lowest mode: between, the ratio stays above a third of the one given.
pub(crate) const RAYLEIGH_SPAN: f64 = 30.0;

/// A step of the iteration for the Gramians that contributes less than this share is idle: shapes need fewer digits than Hankel values.
pub(crate) const GRAMIAN_CONTRIBUTION: f64 = 1e-4;

/// A direction that differs from others by less than this share adds noise, whose frequencies would be taken for modes.
pub(crate) const SHAPE_NOISE: f64 = 10.0 * GRAMIAN_CONTRIBUTION;

/// Factorisations at most; each finds about one motion that matters.
pub(crate) const GRAMIAN_STEPS: usize = 80;

/// Searches for modes that the iteration missed. Each finds up to four copies of one that is repeated.
pub(crate) const MODE_SEARCHES: usize = 12;

/// Places between two modes at which they are counted: the second and third if the stiffness is nearly singular there by chance.
pub(crate) const CUT_SHARES: [f64; 3] = [0.5, 0.3, 0.7];

/// Relative rounding of moments of inertia that a file states with ten digits.
pub(crate) const SAME_INERTIA: f64 = 1e-9;

/// Most bits of a converter: beyond, double precision has no smaller step over its range.
pub const MOST_CONVERTER_BITS: f64 = 52.0;

// ---- sensors ----

/// Rest of a delay beyond whole samples, in samples, that the linear loop leaves out: its phase is 0.06 degrees at a sixth of the sample
/// rate, and a quotient of two decimal numbers is rounded.
pub(crate) const NEGLIGIBLE_REST: f64 = 1e-3;
/// Order of the Padé approximation of the rest of a delay. The phase of a rest of a whole sample is right to 1e-5 rad at a sixth of the
/// sample rate, and to 0.02 rad at half of it; order 4 would be right to 1e-3 rad there, and costs a state a sensor.
pub(crate) const REST_ORDER: usize = 3;
