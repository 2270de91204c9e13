//! The numbers that decide in this crate, each with where it comes from.

/// A pole nearer than this to 1 in the z-plane is neutral: it belongs to a constant that nothing changes, such as the offset between
/// the state of a friction observer and the friction itself. At 1 kHz it stands for a growth by a factor of e in 100 s, which no run
/// of 20 s shows.
pub const NEUTRAL: f64 = 1e-5;

/// A motion that grows or fades more slowly than this, 1/s, is taken as one that stays: by a factor of 1.5 in 20 s.
pub const STEADY_GROWTH: f64 = 0.02;

/// Share of the step of the verification below which no motion counts in a loop that controls no rate: a run of the simulator is that accurate,
/// and a sensor without noise gives no floor of its own.
pub const ROUNDED_STEP: f64 = 1e-6;

/// Hub rate RMS at rest above this many noise floors is a motion, not noise. Two is what the verdicts on recordings use as well.
pub const MOVES_FLOORS: f64 = 2.0;

/// Stiffness that stands for a joint that truly sticks, as a multiple of the gear's. At 1000 times, the joint's motion changes the
/// loop by a part in a thousand; more only worsens the condition of the matrices.
pub const STUCK: f64 = 1e3;

/// Share of the gear's stiffness that stands for open teeth: small against 1, yet a plant that can be sampled.
pub const OPEN: f64 = 1e-6;

/// Amplitude of the hub's rate over which a harmonic balance is sought: from this many noise floors ...
pub const LEAST_AMPLITUDE_FLOORS: f64 = 0.05;
/// ... to this, rad/s: faster than any axis that these controllers stabilise moves in a limit cycle before its drive saturates.
pub const MOST_AMPLITUDE_RAD_S: f64 = 1.0;
/// Amplitudes a decade. Describing functions change by at most half over a factor of two in the amplitude.
pub const AMPLITUDES_PER_DECADE: f64 = 4.0;
/// Rounds in which the frequency of the describing functions follows the pole.
pub const FREQUENCY_ROUNDS: usize = 3;
/// Halvings of the interval, in the logarithm of the amplitude, in which a limit cycle was found: to 1 %.
pub const CYCLE_HALVINGS: usize = 6;

/// A loop is taken as a low-pass where the third harmonic returns with at most this share of the first, a third of which is what a
/// relay excites. Above it a harmonic balance says nothing reliable (D. Atherton, *Nonlinear Control Engineering*, 1975, ch. 3).
pub const THIRD_HARMONIC: f64 = 0.5;
/// Relative difference between the frequency of a pole and the one for which its describing functions hold, above which a prediction is not
/// consistent: the rounds that seek both have then gone from one pole to another.
pub const FREQUENCY_ERROR: f64 = 0.1;

/// Periods of a sine over which an observer's gain is read, after as many to settle; its state forgets its start in one.
pub const OBSERVER_PERIODS: usize = 3;
/// Fewest and most samples of a period in that reading.
pub const OBSERVER_SAMPLES: [usize; 2] = [8, 4000];

/// Time in which a run from rest finds its operating point before it is disturbed, s: ten time constants of a loop of 0.5 Hz.
pub const SETTLING_S: f64 = 3.0;
/// Periods of the burst that brings the mechanism near a predicted limit cycle.
pub const BURST_PERIODS: f64 = 3.0;
/// A motion after a burst is observed in stretches of this many periods, at least of this time, s: four periods of the slowest hunting.
pub const STRETCH_PERIODS: f64 = 10.0;
/// See [`STRETCH_PERIODS`].
pub const STRETCH_S: f64 = 4.0;
/// Longest stretch, s: a slow motion has time for four, so that it can be seen to settle or to fade.
pub const LONGEST_STRETCH_S: f64 = 10.0;
/// Crossings count a motion more than once a period where it repeats itself less often than this share of them.
pub const MULTIPLE: f64 = 0.9;
/// Most time for which it is observed, s: twice the 20 s of a run that is to be predicted.
pub const OBSERVED_S: f64 = 40.0;
/// Relative change of the RMS from stretch to stretch below which a motion has settled.
pub const SETTLED: f64 = 0.01;
/// If it has not settled, it still fades where it is below this share of what it was half the time ago.
pub const STILL_FADES: f64 = 0.8;
/// RMS in noise floors below which a motion has faded.
pub const FADED_FLOORS: f64 = 0.2;
/// Length of the certificate's own runs at rest and in motion, s.
pub const RUN_S: f64 = 20.0;
/// A motion grows where its RMS over the second half of a run is more than this many times that over the first half.
pub const GROWS: f64 = 1.5;

/// Points of a frequency grid from the lowest frequency to half the sample rate, and that lowest frequency, Hz. Eighty a decade
/// resolve a resonance of 1 % damping; the lowest lies below every crossover of a stabilised axis.
pub const GRID_POINTS: usize = 320;
/// See [`GRID_POINTS`].
pub const GRID_LOWEST_HZ: f64 = 0.05;

/// Corners of the kernels of a Zames-Falb multiplier: two decades to either side of the peak of the loop, at half a decade each.
pub const KERNELS: usize = 9;
/// Lowest reference rate of a multiplier, rad/s: below it a loop of servo bandwidth has no peak.
pub const MULTIPLIER_START: f64 = 1e-3;
/// Intervals into which a range of frequencies is split at most: ten times what a loop with resonances of 1 % damping needs.
pub const MULTIPLIER_SPLITS: usize = 20_000;
/// The least eigenvalue, in units of the loop's largest gain, below which a multiplier is not told from 0: ten times the accuracy of the cone
/// program, 1e-8.
pub const HOPELESS_EIGENVALUE: f64 = 1e-7;
/// Rounds in which the frequency at which a multiplier fails is added to its grid.
pub const MULTIPLIER_ROUNDS: usize = 6;
/// Range of frequencies of a proof: from this, Hz (a period of 500 s, below which nothing about a loop changes any more) ...
/// ... to this multiple of half the sample rate, beyond which the condition is that of an inertia.
pub const MULTIPLIER_RANGE: [f64; 2] = [2e-3, 20.0];
/// Aliases to either side that are summed; they fall faster than the square of their number.
pub const ALIASES: i32 = 20;

/// Swings of the gear's wind-up over which limit cycles with parting teeth are sought: from the least that parts them to this many
/// times as much, where the gap hardly matters any more.
pub const MOST_GAP_SWING: f64 = 30.0;
/// See [`MOST_GAP_SWING`].
pub const GAP_SWINGS: usize = 16;
/// With an unstable regime or a predicted limit cycle near which a motion stays, a run that moves more than this many noise floors is not called stable: a run
/// with other noise can move twice as much.
pub const MOVES_UNSTABLE_FLOORS: f64 = 1.0;
/// The same for a gear with backlash whose stability is not proved: with one noise its teeth stay in the gap at 0.7 noise floors, with another they
/// rattle at 2.5.
pub const RATTLES_FLOORS: f64 = 0.5;
/// A run at rest between these limits and [`MOVES_FLOORS`] is repeated so often with other noise: of eight runs that rattle with a chance of one half each,
/// all are quiet once in 256.
pub const REPEATED_RUNS: u64 = 7;
/// A motion is a limit cycle only if so many runs with other noise have it too ...
pub const CYCLE_RUNS: u64 = 2;
/// ... with the same amplitude and frequency to this: half of what is promised of a limit cycle, 20 % and 5 %.
pub const RECURRING_AMPLITUDE: f64 = 0.1;
/// See [`RECURRING_AMPLITUDE`].
pub const RECURRING_FREQUENCY: f64 = 0.025;
/// The halves of a run of a limit cycle have the same motion to this: its amplitude is constant, and noise changes it by a few percent. Motion that noise
/// starts anew again and again differs by more.
pub const ALIKE_HALVES: f64 = 0.2;
/// Largest half range over RMS of a limit cycle: 1.4 of a sine, 1.7 of a triangle, 2 of stick and slip; bursts have more.
pub const MOST_CREST: f64 = 3.0;
/// A motion at rest is called a limit cycle from this many cycles in a run on; below, it is a slow wandering.
pub const LEAST_CYCLES: f64 = 10.0;
/// A cycle counts when the rate leaves a band of this share of its range about the mean, to either side: what noise does not cross.
pub const CYCLE_BAND: f64 = 0.25;

// ---- spectral ----

/// Longest segment, samples; shorter where the record would give fewer than [`FEWEST_SEGMENTS`].
/// At 1 kHz a resolution of 0.25 Hz, finer than any crossover needs.
pub const LONGEST_SEGMENT: usize = 4096;

/// See the one above.
/// With fewer the confidence radius exceeds the ratio itself.
pub const FEWEST_SEGMENTS: usize = 6;

// ---- robustness::statistics ----

/// The distance from 1 is told only where its correlation is larger than the factor's own by this.
/// Over 200 samples the standard deviation of a rank correlation by chance is 0.07.
pub const CLEAR_RANK: f64 = 0.1;

// ---- robustness::sampling ----

/// Standard deviations at which a normal factor is cut off.
/// Beyond three a factor of 0.33 deviation would turn negative.
pub const NORMAL_CUT: f64 = 3.0;

// ---- robustness::worst_case ----

/// First step, in quantiles.
/// A fifth of a range leaves the neighbourhood of the worst sample.
pub const FIRST_QUANTILE_STEP: f64 = 0.2;

/// The search ends at this step.
/// A fiftieth of a range is as fine as ranges of parameters are known.
pub const LAST_QUANTILE_STEP: f64 = 0.02;

// ---- signals::welch ----

/// See the one above.
/// A window of fewer has no shape.
pub const FEWEST_SAMPLES_A_SEGMENT: usize = 8;

// ---- signals::step ----

/// See the one above.
/// Rise and settling need a few samples to either side.
pub const FEWEST_STEP_SAMPLES: usize = 10;

// ---- structured::nearest_mechanism ----

/// Candidates that are closed exactly.
/// The largest lower bounds lie at neighbouring frequencies; six span both sides of a peak.
pub const NEAREST_CANDIDATES: usize = 6;

/// A limit is found to this, relative.
/// Below the six digits in which a limit is printed.
pub const LIMIT_NEARNESS: f64 = 1e-6;

// ---- structured::problem ----

/// Frequencies of the first grid.
/// Peaks between them are refined.
pub const MU_POINTS: usize = 80;

/// Lowest frequency, Hz.
/// Below it the loop's gain is so large that no deviation matters.
pub const MU_LOWEST_HZ: f64 = 0.05;

/// Most refinements about peaks.
/// Each halves the spacing about a peak: 64 times in all.
pub const MU_REFINEMENTS: usize = 6;

/// Neighbours of a peak that differ by more than this are refined.
/// One percent of the bound is what is printed.
pub const MU_STEEP: f64 = 0.01;

/// Share of the highest peak from which on a peak is refined: lower ones hardly become the highest by a refinement.
pub const MU_HIGH_PEAK: f64 = 0.8;

/// Ratio of neighbouring frequencies about a peak above which a further one is put between them: two percent resolve a mode of one percent of
/// damping.
pub const MU_SPARSE: f64 = 1.02;

/// Frequencies at which the parameters are searched.
/// A bound on the effort: fewer give a smaller lower bound, never a wrong one.
pub const MU_SEARCHED: usize = 16;

// ---- structured::stability ----

/// Ranges are widened at most so far.
/// A loop that nothing destabilises is reported as stable to so many times.
pub const WIDEST_RANGES: f64 = 1e3;

// ---- structured::lower ----

/// Most iterations from one start.
/// A bound on the effort: the power iteration need not converge (A. Packard and J. Doyle, Automatica 29, 1993).
pub const POWER_ITERATIONS: usize = 200;

/// Starts that are tried.
/// A bound on the effort: fewer starts give a smaller lower bound, never a wrong one.
pub const POWER_STARTS: usize = 6;

/// An iteration has converged where M Delta a = beta a holds to this.
/// A perturbation is checked exactly afterwards.
pub const POWER_RESIDUAL: f64 = 1e-6;

// ---- structured::factor ----

/// Distance to which a deviation goes towards a factor of 0 or of infinity.
/// At the end itself a parameter is 0 or infinite, which makes no mechanism.
pub const INSIDE_REACH: f64 = 0.999;

// ---- structured::vertices ----

/// Phases that are tried between two complex numbers, then refined.
/// Fifteen degrees, finer than the lobes of a two by two matrix.
pub const TRIED_PHASES: usize = 24;

/// The angle between the phases is found to this, rad: at the end, and while parameters are compared.
/// The eigenvalue is stationary in the phase, so that its error is of the order of the square.
pub const PHASE_NEARNESS: f64 = 1e-7;

/// See the one above.
/// Enough to compare two values of a parameter.
pub const ROUGH_PHASE: f64 = 1e-2;

/// Values that a parameter is tried at first, evenly from -1 to 1: a resonance is met only where it falls on the frequency.
/// An eighth of a range.
pub const TRIED_LEVELS: usize = 17;

/// Most rounds over all parameters; from the second on each moves by steps that are halved.
/// The last step is a thousandth of a range.
pub const ASCENT_ROUNDS: usize = 7;

/// Steps by which x is raised before its crossing is bisected, and by how much.
/// Sixty times 3 % reach six times the first guess.
pub const CROSSING_RAISES: (usize, f64) = (60, 1.03);

/// The search begins at these multiples of 1 / `upper`: the larger, the more a parameter moves.
/// The largest is beyond the most by which ranges are usually widened.
pub const SEARCH_BEGINNINGS: [f64; 3] = [1.0, 1.5, 2.3];

/// Factor on x at which the parameters ascend again, and above which a further crossing gains nothing: a tenth of a percent is below what is
/// printed of a bound.
pub const SEARCH_SHRINK: f64 = 0.999;

/// Most times that x is shrunk from one beginning.
/// A bound on the effort: fewer shrinks give a smaller lower bound, never a wrong one.
pub const SEARCH_SHRINKS: usize = 3;

// ---- structured::upper ----

/// The search ends where a step gains less than this, relative.
/// A fifth of a percent of the bound's square is a tenth of a percent of the bound.
pub const SCALING_GAIN: f64 = 2e-3;

/// Most steps of the method of centres.
/// A bound on the effort: the pair that is left proves its bound all the same.
pub const SCALING_STEPS: usize = 60;

/// Most steps of Newton's method a centre.
/// A bound on the effort, as above.
pub const SCALING_NEWTON: usize = 25;

/// Newton's method ends at this decrement: a rough centre is enough.
/// Inside the region of quadratic convergence of a self-concordant barrier, 0.25 (Y. Nesterov and A. Nemirovskii, 1994).
pub const SCALING_DECREMENT: f64 = 0.05;

/// Distance by which the next bound stays behind what the centre proves.
/// Between 0, which is no progress, and 1, which is the bound that is already proved.
pub const SCALING_BEHIND: f64 = 0.25;

/// The first bound that is centred, over what the start proves.
/// The first scalings are not optimised, so their bound is loose.
pub const SCALING_FIRST: f64 = 1.5;

/// A bound is near what its centre proves below this ratio: only then does a small gain end the search.
/// Three tenths of a percent of the bound.
pub const SCALING_NEAR: f64 = 1.006;

/// Weight of |G|^2, which keeps the centre bounded.
/// It keeps G bounded where it does not matter.
pub const SCALING_REGULAR: f64 = 1e-7;

/// A bound below this part of the largest singular value counts as none.
/// A bound below a millionth of the matrix is 0 for every purpose.
pub const SCALING_FLOOR: f64 = 1e-6;

/// Most samples by which control and sensors together may be late in the linear loop: a dense matrix of 2000 states takes 32 MB,
/// and its eigenvalues about a minute. Real loops have a few dozen.
pub const MOST_DELAY_STATES: usize = 2000;

/// Instants that differ by less than this are one, s: far below every sample period, far above the rounding of a time.
pub const SAME_INSTANT_S: f64 = 1e-9;

/// Deflection at which a friction observer without presliding stiffness counts as still, rad at the hub.
pub const OBSERVER_SMALL_DEFLECTION_RAD: f64 = 1e-6;

/// Share of its presliding deflection at which a friction observer is a spring, to the same share.
pub const OBSERVER_SMALL_SHARE: f64 = 1e-3;

/// A limit of the control that no observer reaches, V.
pub const UNLIMITED_V: f64 = 1e9;

/// A term of a multiplier with a weight below this is left out: the weights sum up to 1, and the cone program is no more accurate.
pub const NEGLIGIBLE_TERM: f64 = 1e-9;

/// A sensitivity beyond which loops are not told apart: it orders stable loops before unstable ones.
pub const LARGEST_SENSITIVITY: f64 = 1e12;

/// Below this exponent a power law is integrated as a logarithm: the difference is below the rounding of either form.
pub const FLAT_EXPONENT: f64 = 1e-9;

/// Neighbouring sample periods that differ by more than this share are uneven, and no parabola is laid through their samples.
pub const EVEN_SPACING: f64 = 1e-6;

/// Degrees of freedom that a coherence keeps at least: with a single segment nothing is known, and the interval becomes as wide as it can.
pub const FEWEST_DEGREES_OF_FREEDOM: f64 = 1e-3;

/// Sample periods that differ by less than this share are equal: what a file keeps of nine digits.
pub const SAME_PERIOD: f64 = 1e-9;

/// Another candidate must destabilise at a scale that is smaller by this share: less would be the accuracy of the scale itself.
pub const LIMIT_GAIN: f64 = 1e-4;

/// Steps of the scaling that are shortened below this lead nowhere: the barrier is then flat to rounding.
pub const SCALING_SHORTEST_STEP: f64 = 1e-6;

/// Relative accuracy of the scale at which an eigenvalue crosses the circle: that of the eigenvalue.
pub const CROSSING_NEARNESS: f64 = 1e-9;

/// Gains of a root locus in a decade before any are added where a pole moves fast.
pub const LOCUS_GAINS_PER_DECADE: f64 = 20.0;
/// A pole that moves farther than this share of its distance from z = 1 between two gains gets a gain between them: a few pixels of a
/// drawing in which that pole is seen well.
pub const LOCUS_STEP: f64 = 0.05;
/// Added to that distance: poles nearer than this to z = 1 are not told apart.
pub const NEAREST_POLE: f64 = 1e-3;
/// Most gains of a root locus: they bound its time where a pole leaves towards infinity.
pub const MOST_LOCUS_GAINS: usize = 600;

/// Neighbours on the path of a loop are at most this far apart on the Riemann sphere of diameter 2, a hundredth of a great circle:
/// a few pixels of a chart.
pub const PATH_STEP: f64 = 0.04;
/// They differ by at most this in the logarithm as well, 1.3 dB or 9 degrees, while the loop gain is above [`LOWEST_PATH_GAIN`].
pub const PATH_LOGARITHM: f64 = 0.15;
/// Loop gain below which a Nichols chart shows nothing, -60 dB.
pub const LOWEST_PATH_GAIN: f64 = 1e-3;
/// Most points of such a path: four times as many as its grid, for lightly damped modes.
pub const MOST_PATH_POINTS: usize = 3000;

/// Beyond so many standard deviations the tail of a normal distribution is below half a unit in the last place of 1.
pub const FARTHEST_DEVIATIONS: f64 = 8.3;

/// Sine tapers of the spectrum of the line of sight: four halve the scatter of a single one and resolve 2.5 steps of the transform to either side.
pub const SIGHT_TAPERS: usize = 4;
/// Bands of the spectrum of the line of sight in a decade: each 15 % wide, as wide as the peak of a mode of 7 % of damping.
pub const SIGHT_BANDS_A_DECADE: f64 = 16.0;
/// Points over which a density is summed within a band, for 16 points resolve a mode of half a per cent of damping.
pub const SIGHT_POINTS_A_BAND: f64 = 8.0;
/// Relative distance of two frequencies of a path below which no point is added between them: a jump of the response is then an edge.
pub const SAME_FREQUENCY: f64 = 1e-6;

/// The response is settled once it stays within this fraction of the demand: one of the two usual bands, two and five per cent
/// (K. Ogata, *Modern Control Engineering*, 5th ed. 2010, section 5-3).
pub const SETTLING_BAND: f64 = 0.05;

/// The steady state is the mean over this last fraction of the record: long enough to average noise, and late enough that a step which settles
/// within the record has settled.
pub const STEADY_FRACTION: f64 = 0.1;

/// Rise is counted between these fractions of the demand, the usual ones of a response with noise (K. Ogata, as above).
pub const RISE_FROM_TO: (f64, f64) = (0.1, 0.9);

/// Correlation from which a motion is said to repeat itself.
pub const REPEATS: f64 = 0.6;

/// The shortest lag counts whose correlation reaches this share of the largest: whole multiples of a period correlate as well.
pub const SHORTEST_LAG_SHARE: f64 = 0.9;

/// RMS of the line of sight below which a relative difference says nothing, rad: it is printed as 0.
pub(crate) const LEAST_COMPARED_SIGHT_RAD: f64 = 0.05e-6;

/// Ratio of the RMS with feedforwards to that without from which on they are called worse; below, the difference is that of two noise records.
pub(crate) const WORSE_FEEDFORWARD: f64 = 1.01;

// ---- structured::upper ----

/// Ratio of the bracket's ends at which the bisection for the least upper bound of mu stops: a part in ten thousand of a factor on
/// parameters that are known to percents.
pub(crate) const BOUND_RATIO: f64 = 1.0001;

// ---- linear_loop::root_locus ----

/// Ratio of two neighbouring gains below which a root locus is not divided further: a step of a part in a thousand in the gain moves a pole by less
/// than a line's width, unless two poles meet, where no finer step helps.
pub(crate) const LOCUS_GAIN_RATIO: f64 = 1.001;

// ---- signals::sea ----

/// Argument below which sin x / x is computed by its series to x^2: the next term, x^4 / 120, is then below 1e-18, less than rounding.
pub(crate) const SINC_SERIES: f64 = 1e-4;

/// Argument below which 3 (sin x - x cos x) / x^3 is computed by its series to x^2: the next term, x^4 / 280, is then below 4e-11; the difference
/// itself loses 1e-16 / x^3, 1e-10 there.
pub(crate) const SLOPE_FACTOR_SERIES: f64 = 1e-2;

// ---- error_budget::propagation ----

/// Number of half periods within a time below which 1 - sinc^2 is computed by its series to x^4: the series is then right to 1e-9 of its value,
/// and the difference itself would lose four of sixteen digits.
pub(crate) const MEAN_SERIES: f64 = 1e-2;

/// Longest motion that is generated, s: an hour at a millisecond is 3.6 million samples of each axis.
pub(crate) const LONGEST_MOTION_S: f64 = 3600.0;
