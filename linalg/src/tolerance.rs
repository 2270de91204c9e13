//! The tolerances and iteration limits of the crate: all of them, all relative.

/// Unit roundoff times two: the distance from one to the next double.
pub const EPS: f64 = f64::EPSILON;

/// Largest relative difference from its transpose that an input still called symmetric may have.
pub const SYMMETRY: f64 = 1e-10;

/// A swap of two diagonal blocks of a Schur form may cost this much backward error, relative to the blocks.
pub const SWAP: f64 = 1e-13;

/// QR iterations allowed for each eigenvalue.
pub const QR_ITERATIONS: usize = 40;

/// Sweeps allowed to balance a matrix; each sweep lowers the norm, most matrices take three or four.
pub const BALANCE_SWEEPS: usize = 24;

/// A sweep of balancing must lower a row and column by this factor to count.
pub const BALANCE_GAIN: f64 = 0.95;

/// A balanced matrix whose states were scaled by factors farther apart than this may consist of magnified rounding errors: what is computed from it is
/// then checked against the matrix as it was given. Balancing changes matrices in units of one scale by less.
pub const WIDE_BALANCE: f64 = 1e3;

/// The residual of an equation, entry by entry over the sum of the moduli of its terms, up to which a solution fits the data: some thousand
/// roundings. One that balancing has spoilt leaves 1e-9 or more.
pub const CONSISTENT: f64 = 1e-12;

/// Newton steps allowed to refine a Riccati solution.
pub const NEWTON_STEPS: usize = 12;

/// Doubling or sign iterations allowed; quadratic convergence takes about twelve.
pub const DOUBLING_STEPS: usize = 60;

/// Relative residual above which a Riccati solution is refused.
pub const RICCATI_RESIDUAL: f64 = 1e-9;

/// A residual is rounding where it is below this times the norms of the data and of the solution: then the solution is
/// the best that doubles can hold.
pub const ROUNDING: f64 = 16.0 * EPS;

/// A Newton step in 32 digits is the last one if it is below this, relative to each pair of states: the step after it would
/// be below the last digit of a double, as convergence is quadratic.
pub const PRECISE_CONVERGED: f64 = 1e-18;

/// An approximation in 32 digits is near enough for Newton's method to follow, and a solution good enough to be returned, if
/// its last step is below this, relative to each pair of states.
pub const PRECISE_SETTLED: f64 = 1e-13;

/// Entries of a solution below this share of the largest count as zero when steps are measured: 2^-80, which leaves room
/// for the twelve decades that the squares of states in the same problem may differ by after scaling.
pub const PRECISE_FLOOR: f64 = 8.3e-25;

/// Doublings allowed in 32 digits: closed-loop poles 1e-15 from the boundary take about 56.
pub const PRECISE_DOUBLINGS: usize = 70;

/// Squarings of the closed loop allowed when a Lyapunov equation is solved in 32 digits: enough for a pole 1e-30 from the
/// boundary, the nearest that 32 digits tell from one on it.
pub const PRECISE_SQUARINGS: usize = 110;

/// Newton steps allowed in 32 digits: near a double pole on the boundary each step only halves the error, and so it does on the way to a closed-loop pole
/// 1e-20 from it, from a start that moves every pole by one.
pub const PRECISE_NEWTON_STEPS: usize = 80;

/// A power of the closed loop below this contributes less than 1e-32 to the sum that solves a Lyapunov equation.
pub const PRECISE_POWER: f64 = 1e-16;

/// Problems with more states than this are not solved in 32 digits, which would take longer than a second.
pub const PRECISE_STATES: usize = 64;

/// The largest error, relative to each pair of states, that a solution in doubles may be estimated to have; beyond, it is
/// solved again in 32 digits. A benign problem leaves 1e-15; more than this is not judged right, because the entries of the data mean more.
pub const RICCATI_ERROR: f64 = 1e-12;

/// Up to this many states, a solution in 32 digits takes a few milliseconds and is computed even where rounding the data changes the
/// solution by more than the error that is left.
pub const DATA_LIMITED_STATES: usize = 24;

/// The Lyapunov operator of the closed loop, computed in doubles, is trusted if its separation exceeds this times its
/// norm: it is then known to four digits.
pub const TRUSTED_SEPARATION: f64 = 1e-12;

/// A solution is marked as sensitive if its condition number times the rounding of the data (or the residual) exceeds this.
pub const SENSITIVE: f64 = 1e-3;

/// Eigenvalues nearer to the boundary of stability than this share of the norm are examined with their eigenvectors. The square
/// root of the rounding error is what a double eigenvalue splits by; the factor leaves room for its condition.
pub const BOUNDARY_SUSPECT: f64 = 1e-7;

/// A movement of an eigenvalue is that of first order if it is below this share of the distance to the nearest other eigenvalue.
pub const FIRST_ORDER: f64 = 1e-2;

/// The error of a computed eigenvalue, as a multiple of the dimension times the effect of rounding each entry of the matrix
/// (the constant of the QR iteration's backward error, LAPACK Users' Guide, section 4.8).
pub const EIGENVALUE_ERROR: f64 = 4.0;

/// Entries of a computed eigenvector of a balanced matrix are known to this share of its largest entry, times the dimension:
/// the error of the QR iteration over a gap of a few hundredths of the norm.
pub const VECTOR_NOISE: f64 = 100.0 * EPS;

/// A Lyapunov equation is examined further if two eigenvalues meet within this share of the norm of the matrix, or if the
/// solution exceeds the data by the reciprocal: half of the digits may then be lost.
pub const DOUBTFUL_SEPARATION: f64 = 1e-8;

/// The solution of a Lyapunov equation, times the norm of the matrix, that exceeds the data by this is magnified, and the rounding errors of its
/// computation with it: one decimal digit.
pub const MAGNIFIED: f64 = 10.0;

/// A magnified solution with up to this many states is corrected once, which takes a third of its time; of larger ones the residual in twice the
/// working precision takes as long as the solution.
pub const CORRECTED_STATES: usize = 16;

/// Corrections allowed for the solution of a doubtful Lyapunov equation; each gains two digits or more where it is worth while.
pub const LYAPUNOV_REFINEMENTS: usize = 20;

/// A refined solution is accepted if its last correction was below this share of it.
pub const REFINED: f64 = 1e-12;

/// The error of a product in twice the working precision, relative to the norms of its factors: 2^-95 (Ozaki and others 2012,
/// with three slices).
pub const EXTENDED_ERROR: f64 = 2.5e-29;

/// Shapes in a block of the Lanczos iteration: modes that are repeated up to four times are found as often, and a solution with
/// four right-hand sides takes little longer than one.
pub const LANCZOS_BLOCK: usize = 4;

/// Blocks of the Lanczos iteration beyond two for each mode. Twelve modes of a structure take about ten blocks; modes far closer
/// together than to the rest take longer.
pub const LANCZOS_BLOCKS: usize = 40;

/// A shape that keeps less than this share of its length, once it is made orthogonal to others, depends on them: a hundred roundings.
pub const LANCZOS_DEPENDENT: f64 = 2e-14;

/// A pivot of a factorisation without pivoting that exceeds the diagonal entry of its row by this follows one that was nearly zero: the signs
/// of the pivots are then not to be trusted. Ten digits of a double are left for the signs of the others.
pub const PIVOT_GROWTH: f64 = 1e6;

/// Two neighbouring modes are told apart by a count between them if their squares differ by more than this share: a thousand times the
/// residual that a mode may have.
pub const COUNTING_GAP: f64 = 1e-4;

/// An eigenvalue of a pencil counts as found if its last correction is below this share of it: the next one is below the last
/// digit of a double, as convergence is cubic.
pub const PENCIL_CONVERGED: f64 = 1e-17;

/// ... or if its corrections below this share no longer shrink: digits that a double hardly holds.
pub const PENCIL_STALLED: f64 = 1e-15;

/// Sweeps of the simultaneous iteration for the eigenvalues of a pencil: simple ones take four to ten, multiple ones one for each
/// three bits.
pub const PENCIL_SWEEPS: usize = 60;

/// Rows of a matrix up to which eigenvalues beside the boundary of stability are corrected in 32 digits: one of the largest takes some ten milliseconds.
pub const PENCIL_MODES: usize = 32;

/// Angle in rad by which real approximations of eigenvalues are turned off the axis before they are corrected.
pub const PENCIL_TURN: f64 = 0.3;

/// An eigenvalue of a real pencil is real if its imaginary part is below this share of it: a few roundings of a double.
pub const PENCIL_REAL: f64 = 1e-15;

/// A conjugate pair of approximations whose imaginary part is below this share of them may belong to two real eigenvalues: rounding splits a double one
/// by 1e-8 of itself.
pub const PENCIL_NEARLY_REAL: f64 = 1e-6;

/// Approximations of eigenvalues of a pencil are moved apart if they are nearer than this, relatively: as near as a double eigenvalue is
/// split by rounding.
pub const PENCIL_TOGETHER: f64 = 1e-8;

/// Corrections of one simple eigenvalue at most: each gains at least one digit of the 17 that are needed.
pub const PENCIL_CORRECTIONS: usize = 20;

/// A correction of a simple eigenvalue is at most this share of the one before; otherwise the iteration does not converge.
pub const PENCIL_APPROACH: f64 = 0.1;

/// Correction of an eigenvector with the largest entry 1 below which it counts as found: the eigenvalue's error is of second order in it.
pub const PENCIL_VECTOR: f64 = 1e-9;

/// A simple eigenvalue is at most this share of the distance to the nearest other approximation from its own: none is found twice.
pub const PENCIL_NEAR: f64 = 0.1;

/// Corrections allowed for the solution of an equation with a matrix `E`; each gains as many digits as the condition of `E` leaves.
pub const GENERALISED_REFINEMENTS: usize = 6;

/// Sweeps that bring rows and columns of a matrix to one size: each leaves the root of their ratio, so that eight leave a factor of two of seventy decades.
pub const EQUILIBRATION_SWEEPS: usize = 8;

/// Corrections of a solution with a sparse matrix at a complex frequency; each gains as many digits as the missing pivoting left.
pub const SHIFTED_CORRECTIONS: usize = 4;

/// A residual of a solution at a complex frequency, relative to the right-hand side, that needs no correction: some roundings of a row's sum,
/// multiplied by the condition of a lightly damped mode at its frequency.
pub const SHIFTED_RESIDUAL: f64 = 1e-13;

/// A residual of a solution at a complex frequency beyond which the frequency counts as an eigenvalue.
pub const SHIFTED_RESIDUAL_LARGEST: f64 = 1e-6;

/// Iterations of the interior-point method allowed for a convex program: Clarabel's own default; most programs take 10 to 30.
pub const CONE_PROGRAM_STEPS: u32 = 200;

/// Distance from an eigenvalue at which its shape is sought, relative to it.
pub const RITZ_SHIFT_OFFSET: f64 = 1e-9;

/// A pole whose distance from the imaginary axis is below this share of its size has no damping but rounding.
pub const RITZ_LEAST_DAMPING: f64 = 1e-12;

/// A shape adds a direction to a subspace if this share of its length is left once it is made orthogonal: well above the rounding of the
/// others.
pub const RITZ_INDEPENDENT: f64 = 1e4 * LANCZOS_DEPENDENT;

/// If the closed loop moves by more than this, relative to its norm, while a solution is refined, its eigenvalues are computed anew: they are
/// known to a few parts in 1e10 otherwise.
pub const RICCATI_SPECTRUM_MOVES: f64 = 1e6 * EPS;

/// ... or by more than this share of the separation, which bounds how far the eigenvalues are from the boundary of stability: the slowest is
/// known to four digits otherwise.
pub const RICCATI_SPECTRUM_SHARE: f64 = 1e-4;

/// Below this separation, relative to the data, a solution is examined twice: rounding may have moved a mode that
/// cannot be moved.
pub const RICCATI_DOUBTFUL_SEPARATION: f64 = 1e-7;

/// A solution in 32 digits is refused for a lost mode only if its condition number times the rounding of the data exceeds
/// this: the rounding alone may then have put the mode within reach.
pub const RICCATI_UNDETERMINED: f64 = 1.0;

/// A solution whose condition number times the rounding of the data is below this is determined by the data.
pub const RICCATI_DETERMINED: f64 = 1e-2;

/// A mode whose relative distance from reach is below this is named when no solution could be certified. Beyond, the input reaches it well
/// enough, and the equation as a whole is too sensitive for doubles.
pub const RICCATI_HARDLY_REACHED: f64 = 1e-6;

/// Reciprocal condition of `R` below which the equation is shifted first.
pub const RICCATI_REGULAR: f64 = 1e-6;

/// Convergence is quadratic: below this change the next one would be rounding, and Newton steps follow anyhow.
pub const DOUBLING_SETTLED: f64 = 1e-7;

/// The same as [`DOUBLING_EARLY`] for a large problem, whose doublings take long beside the question; the steps of benign ones are small
/// by then.
pub const DOUBLING_EARLY_LARGE: usize = 6;

/// After this many doublings a solution that still grows is either that of a pole near the boundary or of a mode out of reach.
pub const DOUBLING_EARLY: usize = 10;

/// After this many doublings a solution that still grows belongs to a pole within 2^-30 of the boundary; doubles are
/// not the place to find it.
pub const DOUBLING_LATE: usize = 30;

/// A solution grows if a doubling changes it by more than this.
pub const DOUBLING_GROWING: f64 = 0.3;

/// Above this relative correction the closed loop is computed anew before the next step.
pub const NEWTON_STALE_LOOP: f64 = 1e-4;

/// The same once steps have shrunk by too little: a closed loop whose separation is 1e-8 of its norm, beyond which solutions are examined twice, then
/// moves by less than a hundredth of that.
pub const NEWTON_STALE_RENEWED: f64 = 1e-10;

/// The change that a step below this share of the solution makes to the residual is computed in working precision: its rounding errors are then below
/// 2^-80 of the norms, five digits below those of the solution's own entries.
pub const NEWTON_SHORT_STEP: f64 = 1e-9;

/// A gain whose correction is below this share of it is close enough to compute a residual with: what it leaves is of second order in that,
/// and is taken out but for rounding.
pub const GAIN_KNOWN: f64 = 1e-8;

/// Corrections of a gain at most; each gains the digits that the condition of the input's weight leaves.
pub const GAIN_CORRECTIONS: usize = 3;

/// The contraction of a step over its relative size, assumed before there are two steps to compare.
pub const NEWTON_FIRST_CONTRACTION: f64 = 1e6;

/// From a start whose closed loop is not stable, Newton's method leads to the stabilising solution only if the start is near: within this
/// share of it. Farther starts wander, and each of their steps costs as much as a solution.
pub const NEWTON_NEAR_START: f64 = 0.5;

/// Steps that shrink at least by this converge whatever the separation says: the error that is left is below the last one.
pub const NEWTON_CONTRACTS: f64 = 0.5;

/// Steps that shrink by less than this come from a derivative that rounding has spoilt.
pub const NEWTON_SPOILT: f64 = 0.02;

/// A mode is lost where its distance from reach or sight is below this, relative to the matrices.
pub const LOST_MODE: f64 = 1e-13;

/// An eigenvalue of the Hamiltonian counts as on the boundary within this, relative to its norm: the square root of the
/// rounding error, since a double eigenvalue on the boundary splits by that much.
pub const HAMILTONIAN_BOUNDARY: f64 = 1e-8;

/// Problems with more states than this are judged by left eigenvectors alone: singular values for each mode would take
/// longer than the solution.
pub const EXACT_MODE_STATES: usize = 64;

/// Of the modes that the input reaches least, by their eigenvectors, this many are judged by singular values.
pub const MODE_CANDIDATES: usize = 3;

/// An approximation whose feedback exceeds the plant by this may be that of a mode that rounding alone put within reach.
pub const LARGEST_FEEDBACK: f64 = 1e9;

/// An eigenvalue without a neighbour is on the axis for certain if its real part is below this share of its modulus.
pub const AXIS_REAL_PART: f64 = 1e-10;

/// An eigenvalue has no neighbour if no other one is nearer than this share of its modulus.
pub const AXIS_NEIGHBOUR: f64 = 1e-4;

/// The rounding of an eigenvalue of a Hamiltonian matrix, relative to its norm: a thousand roundings of a double.
pub const AXIS_ROUNDING: f64 = 1e3 * EPS;

/// Moduli of eigenvalues below this share of the size of the data are those of zero: four digits above rounding.
pub const VANISHED_MODULUS: f64 = 1e-12;

/// Distance by which equal approximations of eigenvalues of a pencil are moved apart, relatively: far enough for the iteration to separate them, near
/// enough to stay close.
pub const PENCIL_APART: f64 = 1e-4;

/// Balancing is used where it lowers the 1-norm at least to this part.
pub const EXPM_BALANCE_GAIN: f64 = 0.5;

/// Refinements of the solution by the residual in twice the working precision.
pub const GENERALISED_SYLVESTER_REFINEMENTS: usize = 4;

/// Refinements of a transfer matrix at most: each gains as many digits as the condition number leaves of sixteen.
pub const TRANSFER_REFINEMENTS: usize = 10;

/// States up to which a transfer matrix is computed in 32 digits if the corrections of doubles do not settle: the largest takes some ten milliseconds.
pub const PRECISE_TRANSFER_STATES: usize = 32;

/// The states of a transfer matrix are settled if a refinement is below this share of them: they are then known to 32 digits.
pub const TRANSFER_SETTLED: f64 = 1e-20;

/// Between these a sum of squares has neither overflowed nor lost small entries.
pub(crate) const SAFE_SQUARES: (f64, f64) = (1e-200, 1e300);

/// A subdiagonal of a Hessenberg matrix below this is zero whatever its neighbours: its rounding is below the smallest normal number.
pub const NEGLIGIBLE_SUBDIAGONAL: f64 = f64::MIN_POSITIVE / EPS;

/// Entries of an eigenvector beyond this are scaled down on the way, since those of a nilpotent matrix grow without bound.
pub const GROWN_ENTRIES: f64 = 1e100;

/// Share of the unknowns that neither part of a dissection may exceed: lopsided parts make deep trees.
pub const LARGEST_PART: f64 = 0.65;

/// Largest scale of a coordinate in which a block of two is a rotation: it bounds the digits lost by one, and other blocks are eliminated.
pub const ROUND: f64 = 8.0;

/// Matrices whose entries lie outside are left to the careful kernel: squares could overflow or vanish.
pub const SAFE_ENTRIES: (f64, f64) = (1e-100, 1e140);

/// A column below this is zero beside [`SAFE_ENTRIES`]: the square of the smallest of them is far above.
pub const ZERO_COLUMN: f64 = 1e-280;

/// Relative error that the approximant of an exponential may make in the entry at the end of a chain of states without ways around: some thousand
/// roundings, so that matrices of short chains keep the approximant that their norm asks for.
pub const EXPM_ENTRY: f64 = 1e-12;

/// A remainder below this share of a diagonal entry counts as zero when a positive semidefinite matrix is factored in 32 digits: 2^-96, what 32 digits
/// leave after the cancellations of some ten states.
pub const LONG_PIVOT: f64 = 1.3e-29;

/// Steps of a chain of states up to which an estimate from equal steps tells the error of an exponential's approximant: the lowest degree misses the
/// power 7. Of longer chains every entry is estimated.
pub const EXPM_SHORT_CHAIN: usize = 2;

/// An exponential commutes with its matrix up to this, entry by entry over the moduli of the products: some roundings of each. The response of a sampled
/// system near half the sampling rate magnifies what is left by up to a million.
pub const EXPM_COMMUTES: f64 = 1e-14;

/// Steps of a chain of states, for each factor of a power, beyond which an exponential is summed as a power series: an approximant of Padé has an error of
/// 2^d roundings in the entry d steps away, 6e-14 of it at this length.
pub const EXPM_LONG_CHAIN: f64 = 8.0;

/// States up to which a chain has its exponential summed as a series: that takes twice the products of an approximant at this size.
pub const SERIES_STATES: usize = 64;

/// Largest 1-norm of a matrix whose power series is summed: what the signs of the terms cancel is then below e^2.
pub const SERIES_NORM: f64 = 1.0;

/// A term of a power series below this share of the largest one of the same entry is rounding: a few roundings of the sum.
pub const SERIES_ENTRY: f64 = 8.0 * EPS;

/// States up to which an exponential that does not commute with its matrix is computed in 32 digits: the largest takes some ten milliseconds.
pub const PRECISE_EXPONENTIAL: usize = 32;

/// Squarings of an exponential in 32 digits at most: each may double the relative error, and 2^-53 is to be left of 2^-100.
pub const SERIES_SQUARINGS: i32 = 45;

/// Squarings of an exponential up to which its diagonal need not be kept as the change from one: 2^4 roundings are left.
pub const FEW_SQUARINGS: i32 = 4;

/// A diagonal entry of an exponential that has fallen by more than this is squared as it is: the change from one has fewer of its digits.
pub const SMALL_CHANGE: f64 = 0.5;

/// Halvings of a sampling interval at most: the exponential scales by itself what is left.
pub const MOST_HALVINGS: f64 = 60.0;

/// An entry of the factor of a Lyapunov equation above this share of its row determines the phase of the row to all but three digits.
pub const DETERMINES_PHASE: f64 = 1e-3;

/// A trace of `C X C'` below this share of the norms is computed in 32 digits throughout: a refined solution is known to some 1e-24 of its norm.
pub const FADED_TRACE: f64 = 1e-10;
