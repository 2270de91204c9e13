//! The numbers that decide in linear systems, in one place: what each decides, and why it has this size.
//!
//! If a comment names no source, the number was set on the loops of `lti/tests` and on the reference rig's; the closed forms,
//! the benchmarks of the literature and the second methods of those tests hold with it.

// ---- where the grid of a loop ends ----

/// The grid ends this factor beyond the frequency at which the asymptote crosses one.
pub const ASYMPTOTE_MARGIN: f64 = 30.0;

/// A crossing this near to an end of the grid, as a ratio, may be missed by the grid itself.
pub const ASYMPTOTE_AT_END: f64 = 0.99;

/// Zeros and poles whose response differs by this share from that of the states at the start of the grid do not tell how the response goes on below it: a
/// double pole at the origin that rounding has split changes its slope.
pub const ASYMPTOTE_DEPARTS: f64 = 0.1;

/// The response is at its limit this factor beyond the grid, which ends a thousand times beyond the last root: what is left of
/// the difference is 1e-12 of itself, and its square, by which the gain changes, far below rounding.
pub const ASYMPTOTE_LIMIT: f64 = 1e9;

// ---- closing a loop ----

/// Smallest reciprocal condition of a loop matrix I - D K that is still inverted. The relative error of an inverse is about the
/// unit roundoff over it (N. Higham, Accuracy and Stability of Numerical Algorithms, section 7.1): below, no digit is left.
pub const LOOP_RCOND: f64 = 1e-14;

// ---- sampling with a delay ----

/// A delay within this share of a period of whole periods is one of whole periods: the rounding of their quotient.
pub const WHOLE_PERIODS: f64 = 1e-12;

// ---- margins with a delay ----

/// A pole counts as on the imaginary axis if its real part is below this share of its size: the resolution of the grid, on which the
/// response jumps there.
pub const DELAYED_POLE_ON_AXIS: f64 = 1e-9;

// ---- descriptor systems ----

/// Sweeps of the scaling of rows and columns. More would only even out factors below two, and the scales are powers of two.
pub const DESCRIPTOR_SWEEPS: usize = 10;

/// Derivatives of the input below this share of the gains that they were summed from are rounding errors.
pub const IMPROPER: f64 = 1e-9;

// ---- peaks of a response by level sets ----

/// Eigenvalues this near to the imaginary axis, relative to their size, are taken as frequencies. A false one costs one
/// evaluation.
pub const NEAR_AXIS: f64 = 1e-6;

/// Distance of [`NEAR_AXIS`], relative to the norm of the Hamiltonian.
pub const NEAR_AXIS_NORM: f64 = 1e-12;

/// Frequencies closer than this, relative, are one.
pub const LEVEL_SAME_RATE: f64 = 1e-9;

/// So many of the highest summits of the response are climbed.
pub const SUMMITS: usize = 4;

/// A summit of the sampled response below this share of the peak is not climbed.
pub const LOW_SUMMIT: f64 = 0.1;

/// A hill rises above the highest of three points on it by less than this times the difference between that and the lowest. A parabola through points at
/// even distances rises by an eighth of it at most; the rest is for uneven distances and for hills that are no parabolas.
pub const HIGHEST_RISE: f64 = 3.0;

/// A point closer to the top of a hill than this share of its width, 2^-20, is that top: a parabola changes between the two by the square of the share,
/// 1e-12 of its height, so that rounding decides which is higher.
pub const SAME_POINT: f64 = 1.0 / 1_048_576.0;

/// Rounds of a climb at most: an even one shrinks the interval at least fourfold, so that the peak is flat to rounding at the end; rounds
/// about the vertex of a parabola take three or four.
pub const CLIMB_ROUNDS: usize = 15;

// ---- margins ----

/// A crossing of the negative real axis is one where the imaginary part is below this share of the real one.
pub const REAL_CROSSING: f64 = 1e-6;

/// A crossing of the unit circle is one where the gain is one within this.
pub const UNIT_CROSSING: f64 = 1e-6;

/// A direct path below this share of the loop's largest gain is zero.
pub const NEGLIGIBLE_GAIN: f64 = 1e-12;

/// The sign of an imaginary part, and a gain at an end of the axis, are certain if they exceed this many times what one rounding of each
/// operand changes: the reduction to Hessenberg form and the elimination make a few roundings each.
pub const CERTAIN_SIGN: f64 = 100.0;

// ---- margins of several loops ----

/// Relative accuracy of the norms.
pub const MULTILOOP_NORM: f64 = 1e-9;

/// Points a decade of the grid on which the structured singular value is computed; peaks are then closed in on.
pub const MULTILOOP_PER_DECADE: f64 = 40.0;

/// Decades that the grid goes beyond the slowest and the fastest pole.
pub const MULTILOOP_BEYOND: f64 = 100.0;

/// Rounds of closing in on a peak, each by a factor of four.
pub const MULTILOOP_ROUNDS: usize = 14;

/// Sweeps over the scales of the loops; each ends within a thousandth of the smallest norm, and three sweeps settle four loops.
pub const MULTILOOP_SWEEPS: usize = 8;

/// Steps of a golden-section search for one scale: the logarithm is then known to 1e-7.
pub const GOLDEN_STEPS: usize = 36;

// ---- norms ----

/// Steps of the Hamiltonian iteration; it converges quadratically (N. Bruinsma and M. Steinbuch, Systems and Control
/// Letters 14, 1990), four to six are usual.
pub const HAMILTONIAN_STEPS: usize = 40;

/// An upper bound is looked for up to this, relative to the lower one.
pub const LARGEST_EXCESS: f64 = 10.0;

/// A Gramian larger than its data by this is refined: its modes are so close to the boundary that rounding their damping costs six of sixteen digits.
pub const MAGNIFIED_GRAMIAN: f64 = 1e6;

/// An output that sees less than this share of the states' RMS values, both by their norms, as at the end of a chain, has lost four of sixteen digits to the
/// other states. Hankel values below this share of the factors' norms have lost as many.
pub const FADED_OUTPUT: f64 = 1e-4;

/// Poles this near to the border of stability, relative to the largest, are on it.
pub const NORM_POLE_ON_AXIS: f64 = 1e-14;

// ---- modes on the boundary that the response does not contain ----

/// Poles closer to one on the boundary than this share of the largest belong to it: rounding splits a triple one by the cube root of the unit roundoff.
pub const SAME_BOUNDARY_POLE: f64 = 1e-5;

/// Radius of the circle about such a pole, as a share of the distance to the nearest other one. The linear equations on the circle stay regular to
/// three digits beyond what the system itself costs, and a residue stands out as much beside the other poles.
pub const CONTOUR_RADIUS: f64 = 1e-3;

/// Points on the circle: the contribution of the other poles to a moment falls with the radius to the power of the points that are left, so that
/// sixteen leave it at rounding for [`MOST_HIDDEN_MODES`].
pub const CONTOUR_POINTS: usize = 16;

/// Poles on the boundary at most for which the question is asked.
pub const MOST_HIDDEN_MODES: usize = 8;

/// A moment below this share of the response on the circle is zero: a few roundings of the response, of which the mean is taken.
pub const ABSENT_RESIDUE: f64 = 1e-15;

// ---- pole placement ----

/// Sweeps over the eigenvectors (J. Kautsky, N. Nichols and P. Van Dooren, International Journal of Control 41, 1985); five usually
/// settle them.
pub const PLACEMENT_SWEEPS: usize = 30;

/// The sweeps end if the condition number of the eigenvectors improves by less than this share.
pub const PLACEMENT_SETTLED: f64 = 1e-3;

/// A singular value below this share of the largest counts as zero: an input that is a combination of others, or a mode that
/// the inputs do not reach.
pub const PLACEMENT_RANK: f64 = 1e-12;

/// A pole that the gain in doubles misses by more than this share is placed with 32 digits: a well-conditioned plant is met to some 1e-14.
pub const PLACEMENT_MET: f64 = 1e-12;

/// Up to this many states a gain is computed with 32 digits, which takes a tenth of a second for the largest.
pub const PLACEMENT_PRECISE_STATES: usize = 32;

/// Two poles within this of each other, relatively, are one.
pub const SAME_POLE: f64 = 1e-9;

// ---- poles and zeros ----

/// Two computed roots are one if they differ by less than this, relatively: rounding splits a triple root by the cube root of
/// the unit roundoff, 6e-6.
pub const SAME_ROOT: f64 = 1e-5;

/// Zeros on which two methods agree to this share need no correction in 32 digits.
pub const SETTLED_ROOT: f64 = 1e-12;

/// Rows of a system matrix up to which zeros are corrected in 32 digits: a zero of the largest takes some ten milliseconds.
pub const PRECISE_SIZE: usize = 32;

/// A system matrix is singular, and has a zero at the origin, unless rounding each entry by this many units leaves it regular.
pub const SINGULAR_ROUNDINGS: f64 = 100.0;

/// Steps of the power iteration for the componentwise condition of a system matrix. Any number of steps gives an upper bound; more steps make it closer.
pub const BAUER_STEPS: usize = 8;

/// Zeros that are not at the origin but were computed there start at this share of the smallest other one: closer to the origin than to it.
pub const DISPLACED_ZERO: f64 = 1e-3;

/// Rank decisions on the way to the zeros are taken relative to the norm of the scaled system matrix times this: some hundred
/// times the unit roundoff, for the rounding of the transformations (A. Emami-Naeini and P. Van Dooren, Automatica 18, 1982).
pub const ZERO_RANK: f64 = 1e-13;

/// The direct path of a reduced system is inverted for its zeros if that magnifies rounding errors at most by this: three of sixteen digits,
/// one fewer than the comparison with the other method allows ([`SETTLED_ROOT`]).
pub const DIRECT_GROWTH: f64 = 1e3;

/// Poles this near to the boundary, relative to the norm of A, are examined: rounding splits a double pole by the square root
/// of the unit roundoff, 1.5e-8.
pub const SUSPECT_POLE: f64 = 1e-7;

// ---- scaling of states ----

/// A scaling step that does not shrink the norms of a state's row and column by this factor is not taken
/// (B. Parlett and C. Reinsch, Numerische Mathematik 13, 1969).
pub const SCALING_GAIN: f64 = 0.95;

/// Sweeps over the states after which scaling stops; three or four are usual.
pub const SCALING_SWEEPS: usize = 60;

// ---- the grid of a loop ----

/// Grid points a decade, before refinement.
pub const SCAN_PER_DECADE: usize = 30;

/// Decades that the grid goes beyond the slowest and the fastest root.
pub const SCAN_BEYOND: f64 = 1e3;

/// Neighbouring points may differ by this much of the distance to the critical point, or of their own size.
pub const SCAN_STEP: f64 = 0.25;

/// ... and by this much where the loop gain is near one or the phase near -180 degrees.
pub const NEAR_STEP: f64 = 0.03;

/// |ln gain| or phase distance in rad that counts as near.
pub const NEAR_CRITICAL: f64 = 0.15;

/// Gains at which the phase counts as near: all of them, so that no crossing of the negative axis is missed.
pub const EVERY_GAIN: std::ops::Range<f64> = 0.0..f64::INFINITY;

/// ... and in one of many loops that are compared: beyond these a crossing is a gain margin of more than 26 dB, and no nearer to the critical
/// point than 0.95.
pub const CANDIDATE_GAINS: std::ops::Range<f64> = 0.05..20.0;

/// The response near rest is known if rounding changes it by less than this share; beside a pole at zero frequency it grows towards rest.
pub const KNOWN_AT_REST: f64 = 1e-7;

/// The response has a finite limit at rest if its real part changes by less than this share between two such frequencies, one twice the other:
/// the change is some 1e-6 far below all roots, and 3/4 for two integrators.
pub const LEVEL_AT_REST: f64 = 1e-4;

/// And if its imaginary part is below this share of the real one: it falls with the frequency, to some 1e-3 at the first one.
pub const REAL_AT_REST: f64 = 1e-2;

/// Points between the grid's start and half the sampling rate, each at half the distance of the one before: delays turn the response by
/// half a turn for each sample up to there, and a zero or a pole beside -1 has points of its own.
pub const SCAN_TO_NYQUIST: i32 = 10;

/// A crossing is known if its gain exceeds this many times what one rounding of each operand changes: a digit of its factor is left.
pub const CERTAIN_GAIN: f64 = 10.0;

/// The gain of zeros and poles is read off where rounding changes the response by less than this share: three of sixteen digits are lost.
pub const KNOWN_GAIN: f64 = 1e-13;

/// Points at which the gain of zeros and poles is looked for otherwise, each at a quarter of the one before: 24 decades.
pub const GAIN_POINTS: i32 = 40;

/// A root below this share of the largest one is a trace of one at the origin and does not set the start of the grid. Time constants
/// of one machine are at most 24 decades apart, so no root of a model is this small.
pub const AT_ORIGIN: f64 = 1e-30;

/// A response is computed with care where one rounding of each operand changes it by more than this share: crossings keep eight digits otherwise.
pub const BLURRED: f64 = 1e-9;

/// One of so many points of a grid is examined for that: a tenth of a decade is then the least width of a blurred part.
pub const BLURRED_STRIDE: usize = 4;

/// Relative error of a response with residuals in twice the working precision: a rounding of each part.
pub const CAREFUL_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Times that an interval with a crossing of an interpolated response is doubled to enclose that of the response itself: those points are a tenth of a decade
/// apart, and an interval of the grid is at least a thousandth of that where the phase is near -180 degrees.
pub const CROSSING_WIDENINGS: usize = 10;

/// Points of a run of one sign at which the sign is compared with rounding: the certain part of a run may be a tenth of it.
pub const SIGN_SAMPLES: usize = 12;

/// Roots inside this radius turn a sampled response as delays do, and have no frequency near which points would resolve them.
pub const NEAR_ORIGIN: f64 = 0.7;

/// Evenly spread points for each delay of a sampled loop: it turns the response by half a turn up to half the sampling rate, and an odd number
/// of points does not return to the same phase.
pub const SCAN_PER_DELAY: usize = 5;

/// Rounds of refinement, and points in all, at most; what is then unresolved is a jump of width 1e-9 or less.
pub const SCAN_ROUNDS: usize = 40;

/// Points of a grid at most, see [`SCAN_ROUNDS`].
pub const SCAN_POINTS: usize = 40_000;

/// The same for a loop with a delay, which turns the response thousands of times before the gain of an integrator has fallen to -60 dB.
pub const DELAYED_POINTS: usize = 400_000;

/// The gain, -60 dB, from which on a loop with delay is not followed: what it does there changes no margin that a design rests on,
/// and the delay turns it without end.
pub const LEAST_GAIN: f64 = 1e-3;

/// The same of a loop that its delay turns too often to be followed so far: -40 dB, or -20 dB, beyond which no requirement on a margin goes.
pub const LEAST_GAINS: [f64; 3] = [LEAST_GAIN, 1e-2, 1e-1];

/// Share of the frequency of a crossing at which it is read off whether the gain rises there: the cube root of the unit roundoff.
pub const CROSSING_SIDE: f64 = 1e-5;

/// Phase in rad by which a delay may turn the response between two points before refinement.
pub const DELAY_TURN: f64 = 0.5;

/// Frequencies closer than this, relative, are one.
pub const SCAN_RESOLUTION: f64 = 1e-9;

/// Rounds of zooming in on a crossing or extreme by a factor of four or more.
pub const ZOOMS: usize = 30;

// ---- modal form ----

/// Damping couples no two modes where its entries between them are below this share of its norm.
pub const UNCOUPLED: f64 = 1e-12;

// ---- sums that cancel ----

/// An entry that is below this share of what was summed to it is a zero.
pub const CANCELLED: f64 = 1e-11;

/// The same if another method must agree: some fifty roundings of the terms.
pub const CANCELLED_TO_ROUNDING: f64 = 1e-14;

/// A rounding of the data may move a zero by this share of itself if the eliminations alone find it: three digits of it are left after a few roundings.
pub const DETERMINED_ZERO: f64 = 1e-3;

// ---- zeros and poles ----

/// Roots within this of their conjugate's place, relative to their size, count as a conjugate pair.
pub const CONJUGATE: f64 = 1e-8;

/// A pole of a delayed loop is one of those on the boundary if it is within this share of its modulus: a defective one splits by the square
/// root of the rounding and more.
pub const DELAYED_BOUNDARY_POLE: f64 = 1e-3;

/// A sweep over the scalings that gains less than this share of the norm is the last one.
pub const MULTILOOP_SETTLED: f64 = 1e-3 * MULTILOOP_NORM;

/// Scales of states that differ by more than this cost Tustin's method digits: a third of those that a double has.
pub const SPREAD_UNITS: f64 = 1e6;

/// Scales of states that differ by less than this cost Tustin's method no digit that matters; between the two, the result in scaled states tells.
pub const NARROW_UNITS: f64 = 1e3;

/// The operations of Tustin's method stay those on the system as it is given if the result in scaled states differs by less than this share.
pub const SAME_SAMPLED: f64 = 3e-13;

/// A solution of the Riccati equation of a level proves the level if its error, as estimated, is below this share of it: six digits of a
/// solution that does not exist are not settled by Newton's method.
pub const KNOWN_SOLUTION: f64 = 1e-6;

/// An eigenvalue in 32 digits is off the axis if its real part exceeds this share of its size: a hundred roundings of a double.
pub const CLEAR_OF_AXIS: f64 = 2e-14;

/// Frequencies a decade at which a response whose peak rounding has made uncertain is computed with care: a flat top is met, and resonances have
/// places of their own.
pub const CAREFUL_PER_DECADE: f64 = 8.0;

/// Decades that these frequencies go beyond the slowest and the fastest pole.
pub const CAREFUL_BEYOND: f64 = 10.0;

/// Half the width of a resonance, as a share of its frequency, up to which its top is looked for between two doubles: the gain at the nearer of two is
/// too low by the square of 1e-16 over it.
pub const NARROW_PEAK: f64 = 1e-8;

/// Rise of the inverse square of the gain at the points of a parabola: a million roundings, and little enough for a parabola.
pub const VERTEX_RISE: f64 = 1e-9;

/// Shares of the frequency by which the top of a hill is looked for beside a place that rounding has made uncertain.
pub const PEAK_WIDTHS: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];

/// Ratio of one of [`PEAK_WIDTHS`] to the one before it.
pub const PEAK_STEP: f64 = 10.0;

/// States of a delay at most: its matrices are dense, and take 128 MiB each at this size.
pub const MOST_DELAY_STATES: usize = 4096;

/// An eigenvalue of a Hamiltonian matrix may belong on the axis if its real part is below this share of its size: far beyond what rounding moves
/// those of systems that do not nearly cancel.
pub const DOUBTFUL_SHARE: f64 = 0.1;

/// ... or below this share of the norm of the matrix.
pub const DOUBTFUL_NORM: f64 = 1e-6;

/// Frequencies of poles closer than this, relative, are one place to start from.
pub const FIRST_SAME_RATE: f64 = 1e-3;

/// Points of a response in time at most: a response of one signal takes 160 MB at this size.
pub const MOST_POINTS: f64 = 1e7;

/// Share of a contour's radius within which the poles about its centre must lie: farther out they come too near to the contour's points.
pub const NEAR_CENTRE: f64 = 0.5;

/// Share of the largest norm of a grid from which on a summit is climbed: lower ones do not rise by so much between two points.
pub const HIGH_SUMMIT: f64 = 0.9;

/// A round about a vertex encloses the peak closely if it leaves at most this share of the width: an even round leaves about as much.
pub const ENCLOSED_WIDTH: f64 = 0.25;

/// Relative distance from every zero and pole at which a gain may be read: nearer, the response is rounding.
pub const APART_FROM_ROOTS: f64 = 0.1;
