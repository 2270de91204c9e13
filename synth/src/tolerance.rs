//! Every tolerance of this crate, with what it rests on.

/// A singular value of D12 or D21 below this, relative to the largest, counts as zero: three digits above the rounding of
/// a decomposition in double precision.
pub const FULL_RANK: f64 = 1e-13;
/// A gain smaller than this, relative to the plant's largest, counts as zero: a controller would need the inverse of it as
/// gain, nine decades above what the plant needs elsewhere.
pub const ZERO_GAIN: f64 = 1e-9;
/// A mode counts as out of reach if the smallest singular value of \[A - pI, B\] is below this, relative to A. It is the
/// rounding of the pencil times a thousand; a plant that is nearer to losing the mode loses it to rounding.
pub const OUT_OF_REACH: f64 = 1e-12;
/// A pole counts as lying on the axis if its real part is below this, relative to the largest pole: eigenvalues of a
/// balanced matrix are no more accurate.
pub const ON_AXIS: f64 = 1e-12;
/// A response at a transmission zero is at most this share of the response beside it. Computed zeros of plants with fast
/// modes that are none (seen from rounding near the origin) leave a tenth and more.
pub const VANISHES: f64 = 1e-3;
/// Phase that the delay may cost at the crossover of the weights before a warning, rad: half of the 60 degrees that a
/// phase margin usually has.
pub const DELAY_PHASE: f64 = 0.5;
/// Roots whose imaginary part is smaller than this, relative to their modulus, are taken as real.
pub(crate) const REAL_ROOT: f64 = 1e-12;
/// A root lacks its conjugate if no other root is nearer to it than this, relative to its modulus: what a file keeps of
/// nine digits.
pub(crate) const CONJUGATE: f64 = 1e-9;
/// Relative difference below which two matrices of plants count as equal: derived parameters carry rounding of 1e-12, and
/// a change that matters is far above 1e-9.
pub const EQUAL: f64 = 1e-9;
/// Largest deviation in the band up to which the gain law stands in for a redesign, relative to the redesigned module: a
/// cancellation that is 2 % off still removes 34 dB, more than accelerometer and drive are known to.
pub const GAIN_LAW: f64 = 0.02;
/// Place to which the poles on the axis of an error weight go in a textbook's plant, rad/s: its equations need them to decay, and at
/// a thousandth of a radian per second they do so in a quarter of an hour.
pub const SLOWEST_RAD_S: f64 = 1e-3;
/// Relative accuracy of the H-infinity bound of an alternative design: 0.01 dB.
pub(crate) const ALTERNATIVE_BOUND: f64 = 1e-3;
/// The bandwidth is at most this share of the sample rate in rad/s: a twentieth (Franklin, Powell and Workman, Digital
/// Control of Dynamic Systems, section 11.2), where the hold costs 9 degrees.
pub const CEILING: f64 = 1.0 / 20.0;
/// Factor on the ceiling of the bandwidth for each fact of the loop that is not known. A structure, a sensor or a delay
/// that no file states is there nevertheless: 3 dB for each keep the loop at a sixth of its ceiling if nothing is known.
pub const CAUTION: f64 = 0.7;
/// A bandwidth is at most this many times its aim.
pub const ABOVE_AIM: f64 = 1.35;
/// Highest aims of the shapes for stiff modes over the bandwidth so far: first near it, then, where a notch may make the bandwidth much lower than the
/// aim, far above.
pub const STIFF_REACHES: [f64; 2] = [3.0, 8.0];
/// Bandwidth of a design for stiff modes over that of one for the plant as it is, at least, for the first to be taken.
pub const CLEARLY_QUICKER: f64 = 1.05;
/// Share of the ceiling above which the answer is not refined.
pub const NEAR_CEILING: f64 = 0.97;
/// Relative rise of the bandwidth that makes a variation the answer.
pub const RISE: f64 = 0.01;
/// A mode below this damping ratio counts as lightly damped: it shows a peak of more than 4 dB.
pub const LIGHTLY_DAMPED: f64 = 0.3;
/// A lightly damped mode may be off by this share of its frequency: finite elements with joints are known to 10 or 20 %
/// (Preumont, Vibration Control of Active Structures, section 4.5).
pub const MODE_SHIFT: f64 = 0.15;
/// Largest sensitivity that the loop may have with its modes shifted: half the distance to instability is left.
pub const NEIGHBOUR_MS: f64 = 2.0;
/// Distance above a limit that the sensitivity at a few frequencies must be to count as above it, relative to it: beyond every rounding.
pub const SEEN_ABOVE: f64 = 1e-6;
/// Share of the control's limit that the noise of the readings may take, as RMS: three deviations are 15 % of the range.
pub const NOISE_SHARE: f64 = 0.05;
/// A search must improve by this share to go on: below it, it would walk a factor that hardly matters to its end.
pub(crate) const LEAST_GAIN: f64 = 1e-5;
/// The least positive value of a fitted numerator or denominator, relative to the mean, that counts as positive: the
/// accuracy of the interior-point solver.
pub(crate) const POSITIVE: f64 = 1e-9;
/// Leading Chebyshev coefficients below this, relative to the largest, are left out before roots are computed.
pub(crate) const LEADING: f64 = 1e-12;
/// The bisection over the deviation of a fitted table ends within this share, in dB of the deviation.
pub(crate) const TABLE_DEVIATION: f64 = 1e-3;
/// A limit of a tuned loop that is exceeded by less than this share counts as kept: far below what a plant is known to.
pub(crate) const LIMIT_KEPT: f64 = 5e-4;

/// Relative accuracy of the norms of candidate loops.
pub(crate) const HINF_NORM: f64 = 1e-9;

/// By how much the norm that was found is rounded up, so that the claim is not below what is reached.
pub(crate) const HINF_ROUNDED_UP: f64 = 1e-7;

/// By how much a bound is first raised whose loop does not keep it: what rounding of a controller near the optimum costs. The raise
/// doubles with each attempt.
pub(crate) const HINF_FIRST_RAISE: f64 = 1e-6;

/// A loop whose norm is above its own bound is preferred to one that keeps a higher bound if its norm is lower by this share: a hundredth of a decibel is
/// twelve times as much.
pub(crate) const HINF_WORTHWHILE: f64 = 1e-4;

/// Bounds tried at most, upward and in the bisection.
pub(crate) const HINF_TRIALS: usize = 80;

/// Share of the first bound that was reached below which a bound counts as nothing: where the controller can cancel all of w, the optimum is zero,
/// no bound is the last, and a loop in doubles is exact to about 1e-15.
pub(crate) const HINF_NOTHING: f64 = 1e-10;

/// Share of the rates of the two Riccati equations above which the rate of the plant tells where the search starts. A first bound that is too high by less than ten
/// decades only takes longer; beyond, it would end at what counts as nothing ([`HINF_NOTHING`]).
pub(crate) const HINF_SLOWEST: f64 = 1e-6;

/// X and Y count as indefinite below minus this, relatively. A loose test: the loop itself is looked at afterwards.
pub(crate) const HINF_INDEFINITE: f64 = 1e-7;

/// Relative change of a gain from which its slope is taken.
pub(crate) const GAIN_STEP: f64 = 1e-3;

/// A pole slower than this is one at zero, rad/s: it decays in more than a week.
pub(crate) const POLE_AT_ZERO_RAD_S: f64 = 1e-6;

/// Relative half-width that a pole has at least where a grid is made dense around it.
pub(crate) const NARROWEST_POLE: f64 = 1e-9;

/// Shares of a mode that differ by less than this, relatively, are equal, and the first of them is named.
pub(crate) const SAME_SHARE: f64 = 1e-6;

/// A pole nearer to 1 than this is an angle that the loop does not see or does not hold: it drifts, and stays where it is.
pub(crate) const DRIFTING_POLE: f64 = 1e-6;

/// Frequencies below this share of half the sample rate are far below every bandwidth that is looked at.
pub(crate) const BLIND_BELOW: f64 = 1e-6;

/// Eigenvectors of unit length with a product below this belong to a mode that is all but double: moving it by its
/// projector would blow rounding up by as much.
pub(crate) const DEFECTIVE_MODE: f64 = 1e-8;

/// Steps at most. The examples need between 15 and 60.
pub(crate) const DESCENT_STEPS: usize = 300;

/// First size of the trust region, as a factor on the parameters in natural logarithms: a factor of 1.6.
pub(crate) const REGION_FIRST: f64 = 0.5;

/// Size of the trust region, in natural logarithms, below which the descent ends: a millionth on a parameter changes nothing that counts.
pub(crate) const REGION_LAST: f64 = 1e-6;

/// Largest size of the trust region, in natural logarithms: a factor of 7.
pub(crate) const REGION_LARGEST: f64 = 2.0;

/// Size of the trust region after it has shrunk to nothing.
pub(crate) const REGION_AGAIN: f64 = 0.1;

/// Gain since the last time that makes it worth while to open the trust region again.
pub(crate) const DESCENT_WORTHWHILE: f64 = 1e-4;

/// A step is taken if it brings this share of what it promised.
pub(crate) const STEP_TAKEN: f64 = 0.05;

/// The trust region grows if a step brings this share of what it promised.
pub(crate) const STEP_GOOD: f64 = 0.6;

/// The descent ends if a step promises less than this share of the residual rate.
pub(crate) const DESCENT_PROMISED: f64 = 1e-7;

/// Halvings of the gain, and of the corner below which it integrates, of a start that is not stable.
pub(crate) const START_HALVINGS: usize = 24;

/// Relative half-width that a root has at least where a grid is made dense around it: undamped modes would otherwise get one frequency.
pub(crate) const NARROWEST_ROOT: f64 = 1e-4;

/// Frequencies nearer than this, relatively, are one.
pub(crate) const SAME_FREQUENCY: f64 = 1e-9;

/// A limit that was exceeded is tightened by this share more than it was exceeded by, so that one round usually suffices.
pub(crate) const LIMIT_TIGHTENING: f64 = 1e-4;

/// Relative accuracy of the largest |KS|.
pub(crate) const CONTROL_PEAK: f64 = 1e-6;

/// Poles nearer to 0 than this settle within a sample or two: they have no rate that matters.
pub(crate) const FASTEST_POLE: f64 = 1e-6;

/// Curvature that is added to a tangent program in every direction, so that it has one solution.
pub(crate) const TANGENT_RIDGE: f64 = 1e-6;

/// Directions of a basis below this, relative to the strongest, are left out: rounding has them.
pub(crate) const WEAKEST_DIRECTION: f64 = 1e-9;

/// Least deviation from a table at which the bisection looks, dB: a smaller deviation is below the width of a line in a chart.
pub(crate) const TABLE_LEAST_DB: f64 = 1e-4;

/// Largest deviation from a table at which the bisection looks, dB: beyond it the function has nothing to do with the table.
pub(crate) const TABLE_MOST_DB: f64 = 80.0;

/// The norm of the assembled loop may exceed the bound by this, relatively: the accuracy of the norm itself.
pub const HINF_VERIFIED: f64 = 1e-6;

/// Modulus below which a zero of the plant adds no function to the basis of the best feedback: near the origin it is a delay, which the basis
/// has already.
pub(crate) const SMALLEST_ZERO: f64 = 1e-6;

/// Least response of the plant, relative to its largest, by which the usual range of a gain is bounded: keeps the range finite at a zero of
/// the plant on the grid.
pub(crate) const LEAST_RESPONSE: f64 = 1e-12;

/// Step in the logarithms of the parameters by which the slopes of poles, and of designed feedbacks, are taken.
pub(crate) const POLE_STEP: f64 = 1e-5;

/// A limit that is exceeded by less than this share on the fine grid counts as kept.
pub(crate) const BEST_LOOP_LIMIT_KEPT: f64 = 2e-3;

/// Rounds in which the frequencies that the last answer violates join the program.
pub(crate) const BEST_LOOP_ROUNDS: usize = 6;

/// A zero of the sampled plant beyond this radius makes a function that outlasts every other one.
pub const LARGEST_ZERO: f64 = 0.99995;

/// A bandwidth is higher if it is by this share: the answer itself is known to 0.7 %.
pub const HIGHER_BANDWIDTH: f64 = 0.015;

/// Share of what a limit allows from which on it is nearly used up: half a decibel below it. The search meets a limit that decides to a few percent.
pub const NEARLY_USED_UP: f64 = 0.944;

/// Above this many times the ceiling of the bandwidth only the usual shape is tried: such aims serve to tell the other limits.
pub const FAR_ABOVE_CEILING: f64 = 1.5;

/// A loop that reaches less than this share of what the clock allows is not limited by the clock; the more so at any quicker one.
pub const CLOCK_SHARE: f64 = 0.5;

/// Peaks lower than this below their limit, as a natural logarithm, have no row in the program of a tuning step: no step of the trust region reaches them.
pub const FAR_BELOW_LIMIT: f64 = -0.7;

/// Ratio of the two frequencies at which a gain is compared to see whether it has a zero at zero frequency: see [`BLIND_FALL`].
pub const BLIND_SPAN: f64 = 1e-2;

/// A gain that falls to less than this over [`BLIND_SPAN`] has a zero at zero frequency: one of order one falls to a hundredth, and one that
/// stays does not fall.
pub const BLIND_FALL: f64 = 0.1;

/// Crossovers up to which the damping of a pole counts: faster poles do not shape the loop's response.
pub const REGION_REACH: f64 = 2.0;

/// A delay of so little more than whole samples is one of whole samples: the quotient of two decimal numbers is rounded.
pub const ROUNDED_SAMPLE: f64 = 1e-6;

/// Highest corner of a block whose range is not stated, over the highest frequency of the grid. The bilinear map gives a corner at ten times half the sample rate a pole
/// at z = -0.88: a faster one would ring at half the sample rate.
pub(crate) const FASTEST_CORNER: f64 = 10.0;
/// The same of a low-pass, which the bilinear map gives a zero at z = -1 that cancels the pole: so fast, it does nothing.
pub(crate) const FASTEST_LOW_PASS: f64 = 1000.0;
/// A low-pass whose corner times the sample period exceeds this does nothing at any frequency of the loop.
pub(crate) const IDLE_LOW_PASS: f64 = 100.0;
/// A tuned parameter is at an end of its range if it is no further from it than this, as a natural logarithm: the last steps of a descent are smaller.
pub(crate) const AT_RANGE_END: f64 = 1e-3;
/// Share of the highest frequency of the tuning grid below which the plant's response does not widen the range of an open gain: three decades below
/// half the sampling rate the response of an integrating plant grows without limit, and no crossover lies there.
pub(crate) const GAIN_RANGE_SHARE: f64 = 1e-3;
/// Damping ratio below which a pole's resonance gets frequencies of its own in the grid of the total cost: at 0.3 the peak of a second-order
/// system is 1.75 times its static gain (1 / (2 zeta sqrt(1 - zeta^2))), which the even grid still resolves.
pub(crate) const RESONANT_DAMPING: f64 = 0.3;

/// Relative error of a norm that a requirement on a first design asks for: margins keep two percent to spare.
pub(crate) const NORM_TOLERANCE: f64 = 1e-3;

/// Bandwidth that an approach asks for over the highest so far: less is not worth another kind of feedback.
pub(crate) const APPROACH_RISE: f64 = 1.1;

/// Sum of the logarithms of what a loop has over what is allowed, at most, for an approach to start from it: 1.65 times in one limit.
pub(crate) const NARROW_MISS: f64 = 0.5;

/// Largest logarithm of what a loop has over what is allowed that counts: a loop that is not stable beside the plant has no size of its miss.
pub(crate) const LARGEST_EXCESS: f64 = 6.0;

/// Largest multiple of the bandwidth in a shape: beyond it nothing changes near the bandwidth.
pub(crate) const LARGEST_MULTIPLE: f64 = 100.0;

/// Largest cost of the load's motion over that of the control, and the inverse of the smallest.
pub(crate) const LARGEST_LOAD: f64 = 100.0;

/// Up to how many inverse bandwidths after a step the largest control is looked for: it comes early.
pub(crate) const CONTROL_PEAK_BY: f64 = 6.0;

/// Up to how many inverse bandwidths after a step the largest reading is looked for: an integral that begins at a twentieth of the bandwidth turns the response
/// back by then.
pub(crate) const OVERSHOOT_BY: f64 = 40.0;

/// Gain margin beyond which two loops of a front count as equal, dB: a factor of 1000 on the gain is no limit of any mechanism.
pub(crate) const LARGEST_MARGIN_DB: f64 = 60.0;

/// Phase margin beyond which two loops of a front count as equal, degrees: there is no larger angle to the negative real axis.
pub(crate) const LARGEST_MARGIN_DEG: f64 = 180.0;

/// Delay margin beyond which two loops of a front count as equal, s: no sampled controller waits longer.
pub(crate) const LARGEST_MARGIN_S: f64 = 1e3;

/// Least figure of a loop whose logarithm a front tells apart: below it there is nothing but rounding.
pub(crate) const LEAST_FIGURE: f64 = 1e-300;

/// Share by which a search for a front keeps the limits on its grid more tightly than they are asked: the grid resolves a peak to 1e-3, and a design
/// that misses a limit by its exact figures is left out at the end.
pub(crate) const FRONT_GRID_SHARE: f64 = 1e-3;

/// Work of the search for a first design, in designs times the third power of the order of the largest loop that is judged: a few seconds of one processor. The
/// search ends with the best that it has.
pub(crate) const WORK_OF_SEARCH: usize = 40_000_000;
/// Designs of such a search at least: with 200 the further searches of a table over a ball screw were cut off, and its bandwidth was 24 rad/s in place of 360.
pub(crate) const FEWEST_DESIGNS: usize = 1000;
/// Designs of such a search at most.
pub(crate) const MOST_DESIGNS: usize = 2000;
/// Share of the designs of the search that each search for what limits the answer may take again.
pub(crate) const SHARE_FOR_LIMITS: f64 = 0.3;

/// Last step of the search for weights, as a natural logarithm of a factor: 4 % of a weight changes no figure that is asked for by more than it is read to.
pub(crate) const LAST_WEIGHT_STEP: f64 = 0.04;
/// Largest factor on a parameter of that search, as a natural logarithm: three decades.
pub(crate) const WEIGHT_REACH: f64 = 6.9;
