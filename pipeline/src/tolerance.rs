//! The numbers that decide in the pipeline, each with its reason and what breaks if it is changed.

/// Relative residual up to which an equation counts as solved. Riccati equations of the examples are solved to 1e-11 and better;
/// at 1e-8 the gain loses digits that a controller's coefficients would show.
pub(crate) const SOLVED_RESIDUAL: f64 = 1e-8;

/// Relative difference up to which a sampled controller has kept its response through the bilinear map and back: rounding, amplified by a
/// pole near z = -1, stays below the step of any converter.
pub(crate) const SAME_CONTROLLER: f64 = 1e-7;

/// Relative difference up to which a predicted cost agrees with the cost of the assembled loop.
pub(crate) const SAME_COST: f64 = 1e-6;

/// Share of the whole mass or inertia below which a modal mass is rounding: a mode orthogonal to the rigid motion gives about 1e-16.
pub(crate) const NEGLIGIBLE_MASS_SHARE: f64 = 1e-14;

/// Relative size of a singular value below which a state counts as neither controllable nor observable.
pub(crate) const MINIMAL_TOLERANCE: f64 = 1e-10;

/// A hub rate below this is none: rounding of the simulator, not motion, rad/s.
pub(crate) const STILL_RAD_S: f64 = 1e-9;

/// Swing of the hub below which its friction is not told apart, rad.
pub(crate) const LEAST_SWING_RAD: f64 = 1e-12;

/// Distance of a pole from the unit circle that is rounding: a pole that only drifts (an integrator, a free angle) is off by less.
pub(crate) const DRIFTING_POLE: f64 = 1e-6;

/// Smallest modulus that is stated in dB: below it lies rounding, and 0 has no logarithm.
pub(crate) const SMALLEST_MODULUS: f64 = 1e-30;

/// Modulus of a pole, relative to the largest, that is rounding of an eigenvalue at the origin: a few units in the last place. A pair that
/// rounding splits by more is shown as it was computed.
pub(crate) const ROUNDED_POLE: f64 = 1e-14;

/// Share of the largest Hankel value from which on a state is kept if the project states no order: the a priori bound of the error is then
/// about 1e-6 of the response, below what a drawing shows or a margin feels.
pub(crate) const KEPT_HANKEL_SHARE: f64 = 1e-6;

/// A limit that a mechanism of the sweep misses by less than this share counts as kept.
pub(crate) const TUNED_LIMIT_KEPT: f64 = 1e-3;

/// Lines nearer than this, relatively, become one: no feedback tells them apart.
pub(crate) const SAME_LINE: f64 = 0.03;

/// Share of the power that the lines leave out at the upper end.
pub(crate) const LINES_LEFT_OUT: f64 = 1e-4;

/// A reading may exceed the range by this fraction: decimals of the file, and an offset that was removed.
pub(crate) const CONVERTER_RANGE_MARGIN: f64 = 1e-2;

/// Beyond this many times the range, a reading is no reading but a mark or an error of transmission. The guard of exported code draws the
/// same line.
pub(crate) const IMPOSSIBLE_READING: f64 = 2.0;

/// Relative change of the swing at which the describing function agrees with itself.
pub(crate) const SELF_CONSISTENT_SWING: f64 = 5e-3;

/// Trials to find that swing.
pub(crate) const MOST_SWING_TRIALS: usize = 30;

/// A line of a recording's input counts as excitation when it stands this many times above what noise leaves of it.
pub(crate) const EXCITED_ABOVE_NOISE: f64 = 5.0;

/// A level nearer than this to the one of the point before is left out.
pub(crate) const SAME_FRICTION_LEVEL: f64 = 1e-4;

/// Share of the hub rate by which a trial of an adaptation may exceed that without one: two runs of the same controller that differ in noise alone differ by less.
pub(crate) const NEVER_WORSE: f64 = 1e-3;

/// Share of the hub rate that a changed load must add before it counts as something that an adaptation could remove.
pub(crate) const LEAST_ADDED: f64 = 0.05;

/// Times the difference of two runs whose histories alone differ that a changed load must add: below, friction decides what is measured.
pub(crate) const LEAST_ADDED_OVER_HYSTERESIS: f64 = 3.0;

/// Share of what a changed load adds that an adaptation must remove.
pub(crate) const LEAST_REMOVED: f64 = 0.8;

/// Times the liveliest moment of a motion that a dead-band must be for the estimate to stand still on it: its noise differs from run to run by less.
pub(crate) const DEAD_BAND_MARGIN: f64 = 1.05;

/// Least dead-band over the acceleration of the quietest motion that was tried: below, no trial shows what an estimate is worth.
pub(crate) const BELOW_TRIED: f64 = 0.5;

/// Multiple of its noise floor from which on a channel has a residual that a model could remove: the level below which the diagnosis calls a
/// channel explained. Nearer to 1, the power that is removed of pure noise would be counted.
pub(crate) const RESIDUAL_ABOVE_FLOOR: f64 = 1.5;

/// Share of a simpler hypothesis' error below which a more complicated one of a measured structure is preferred: a further parameter
/// always fits a little more, and a fifth of the error is more than that.
pub(crate) const WORTH_COMPLICATING: f64 = 0.8;

/// Factor over the best hypothesis' error within which another one cannot be told from it: a smaller factor would choose by the scatter of the
/// measured modes, a larger one would leave hypotheses that the modes refute.
pub(crate) const ALIKE_HYPOTHESES: f64 = 1.15;

/// Relative RMS error of the held-out modes below which the structure is explained: a smaller value would search for
/// causes of what a drawing and a modal test leave open.
pub(crate) const EXPLAINED_STRUCTURE: f64 = 0.02;

/// Fewest modes from which a fitted hypothesis can be judged on held-out modes: with one held out, two are left for its two parameters.
pub(crate) const FEWEST_JUDGED_MODES: usize = 3;

/// Share of the worst residual below which a fitted initial state is believed to be what was wrong. A start that removes less may only hide what
/// the model lacks.
pub(crate) const START_WORTH: f64 = 0.75;

/// Factor on the hub rate without adaptation above which a method is refused: thirty times what noise alone changes, [`NEVER_WORSE`],
/// and less than a changed load must add, [`LEAST_ADDED`].
pub(crate) const REFUSED_ABOVE: f64 = 1.03;

/// An interval of a trial counts as adapted if adaptation starts at most this share of the run after it: the RMS is taken over the interval's
/// later part, after what is learnt in so short a time.
pub(crate) const ADAPTED_FROM_SHARE: f64 = 0.05;

/// Share of its reach that a stretch of a measured curve has at least: shorter ones follow the scatter of single points.
pub(crate) const SHORTEST_STRETCH_SHARE: f64 = 0.03;

/// A curve that rises less than this share of a linear drive's is taken as noise: its inverse would be too steep.
pub(crate) const LEAST_SLOPE: f64 = 0.2;

/// Torque of the out-of-balance under heave, RMS over the dry friction on the hub, below which the estimate stands still: there an
/// adaptation, even one that is told the load, does not lower the hub rate (`docs/evidence/robustness.md`).
pub(crate) const LEAST_TORQUE_OVER_FRICTION: f64 = 0.5;

/// The same without gravity, where heave alone shows the load: a lower value lets friction move the estimate.
pub(crate) const LEAST_TORQUE_WITHOUT_GRAVITY: f64 = 1.2;

/// Share of the friction that counts at least with an observer, whose errors the estimate would else follow: with gravity, and without.
pub(crate) const LEAST_UNOBSERVED: [f64; 2] = [0.3, 0.55];

/// Least default of the dead-band, m/s^2: above the noise of an accelerometer and the vibration of a standing vehicle.
pub(crate) const LEAST_DEAD_BAND_M_S2: f64 = 0.1;

/// Smallest out-of-balance from which the estimator takes the size of its first parameter, kg m.
pub(crate) const SMALL_KG_M: f64 = 10.0;

/// Times a sensor's full scale beyond which its reading cannot be right. A reading at full scale is still good: it is what a
/// sensor gives that is driven beyond its range.
pub(crate) const BEYOND_FULL_SCALE: f64 = 2.0;

/// Most memory that one run may take, bytes: a quarter of the memory of a small computer, 8 GB.
pub(crate) const MOST_BYTES: f64 = 2e9;

/// Margins are kept with this share to spare: the verification judges the loop with every block and converter in it.
pub(crate) const MARGINS_TO_SPARE: f64 = 0.02;
/// Share of the bandwidth that a requirement on the overshoot leaves, at least: a slower loop settles later than one that overshoots.
pub(crate) const OVERSHOOT_COST: f64 = 0.5;

/// Share of the control that the usual step of the demand takes from which on a first design is looked for without it, too: 3 dB below its limit. What nobody stated may
/// not decide, and a search that meets it ends a little below it.
pub(crate) const STEP_THAT_DECIDES: f64 = 0.7;

/// Ratio of the bandwidth that a limit alone allows to that which is reached from which on the limit acts only together with others: the search
/// finds what is reached to 0.7 %, and a smaller ratio would call its error a limit.
pub(crate) const ALLOWS_MORE: f64 = 1.015;

/// Least share of the control that counts as available for a demanded motion, where weight and friction take nearly all of it: at 0 such a machine
/// would get no demand, and its loop would not be verified.
pub(crate) const LEAST_LEFT: f64 = 0.1;

/// RMS of the hub rate over that of the run without a change up to which an adaptation counts as having brought it back: ten percent is less than a
/// third of what the changed load of the runs adds.
pub(crate) const RETURNED: f64 = 1.10;

/// Share of the limits of a machine up to which the experiment is planned that tells machines apart: a machine that is not the model goes farther.
pub(crate) const PLANNED_SHARE: f64 = 0.8;

/// Noise floors beyond the machines within the tolerances that a recording may differ from its prediction: of 10 000 samples of white noise the largest is
/// four standard deviations off.
pub(crate) const BAND_FLOORS: f64 = 6.0;

/// Largest share of the samples of a recording that may lie outside their predicted band.
pub(crate) const BAND_SHARE: f64 = 0.02;

/// Residual over the noise floor up to which a model explains a recording: two careful simulators of one machine differ by 1.33
/// (`docs/evidence/diagnosis.md`), and the control of a loop that follows its noise by up to twice the floor.
pub(crate) const EXPLAINED_FLOORS: f64 = 2.0;

/// Least tolerance that recordings leave, as a share of the value: below it the model's own errors count.
pub(crate) const LEAST_TOLERANCE: f64 = 0.005;

/// Difference for a derivative, as a share of the half-width within which a value is sought: far above the steps of converters, and small beside the width of a
/// valley of the cost, which a friction that sticks makes narrow.
pub(crate) const POSTERIOR_DIFFERENCE: f64 = 0.005;

/// Most Gauss-Newton steps: those within a tolerance settle in three or four, those with an effect beside it in ten.
pub(crate) const POSTERIOR_STEPS: usize = 16;

/// Gauss-Newton steps after which effects are compared: most of what one explains is there by then.
pub(crate) const RANKING_STEPS: usize = 3;

/// Damping of the first Gauss-Newton step, as a share of the diagonal.
pub(crate) const FIRST_DAMPING: f64 = 1e-3;

/// Dampings that are tried for a step, each ten times the one before: the last leaves a step as short as those of differences.
pub(crate) const POSTERIOR_DAMPINGS: i32 = 6;

/// Share of the cost that a Gauss-Newton step must gain for another one to be taken.
pub(crate) const POSTERIOR_SETTLED: f64 = 1e-3;

/// Gain margin that a design is asked for whose model does not explain its recordings, dB: a lightly damped mode that is missing, or another damping of one,
/// doubles the gain, and a lag beside it turns it.
pub(crate) const CAUTIOUS_GAIN_MARGIN_DB: f64 = 12.0;

/// Room to its limit that a figure needs on the machine, as a share of the limit: a run repeats its figures to about a percent.
pub(crate) const ACCEPTANCE_MARGIN: f64 = 0.02;

/// Share by which a tolerance must shrink for a round to count as one that taught something.
pub(crate) const CHANGED_TOLERANCE: f64 = 0.1;

/// Effects that are fitted beside the values of a model before one is chosen, at most: those that screening or a diagnosis ranks first.
pub(crate) const MOST_CANDIDATES: usize = 4;

/// Effects that a round adds to a model, at most: recordings of a few experiments tell no more apart.
pub(crate) const MOST_EFFECTS: usize = 4;

/// Share of the residual's power that must be left or less for an effect to be added: what a wrong effect, fitted to what another one left, removes
/// is mostly less than a tenth.
pub(crate) const EFFECT_GAIN: f64 = 0.85;

/// Share of what the best effect explains by which another one may explain less to be tried again when the model has everything: a value that the next effect
/// brings moves either by that much.
pub(crate) const NEARLY_AS_GOOD: f64 = 0.01;

/// The residual's power that an effect leaves, over that of the best one, up to which the recordings cannot tell both apart: ten thousand samples of white noise vary
/// by 3 % at two standard deviations.
pub(crate) const AS_GOOD: f64 = 1.03;

/// Share of the residual's power that an effect must explain in a linearised trial to be fitted.
pub(crate) const SCREENED_SHARE: f64 = 0.05;

/// Most multiples of the library's typical size up to which a linearised trial is followed.
pub(crate) const SCREENED_MULTIPLE: f64 = 30.0;

/// Share of its square that a derivative must keep beside others to be independent of them: a hundred times what differences of replays leave of it.
pub(crate) const DEPENDENT: f64 = 1e-10;

/// Orders of a ripple that are tried, per turn of the motor: once and twice a turn, and the pole and slot counts of common motors.
pub(crate) const SCREENED_ORDERS: [f64; 9] = [1.0, 2.0, 4.0, 6.0, 8.0, 12.0, 18.0, 24.0, 36.0];

/// Reach of the phase of a ripple in one fit, rad.
pub(crate) const PHASE_REACH: f64 = 1.0;

/// Reach of the order of a ripple in one fit, as a share of it: orders are counted, and a tenth is more than gears and slots leave open.
pub(crate) const ORDER_REACH: f64 = 0.1;

/// Least reach of the place of an effect in one fit, rad.
pub(crate) const PLACE_REACH: f64 = 0.1;

/// Relative difference of sample periods that are the same: that of a decimal with seven digits.
pub(crate) const SAME_CLOCK: f64 = 1e-6;

/// Sliding rates that the learning of the friction's level counts as a rate of 1. Its steps fall with the square of the rate: with 5 of them the sines of the reference rig
/// leave 1.13 mrad/s after 14 s, with 20 they leave 0.84.
pub(crate) const SLIDING_RATES_AS_ONE: f64 = 20.0;

/// Part of a sample by which a delay may exceed whole samples and still be those: rounding of the decimals of a file.
pub(crate) const WHOLE_SAMPLES: f64 = 1e-9;

/// Widest change of a weight that is tried as advice, as a factor: beyond it the figures bend too far for one slope.
pub(crate) const WIDEST_ADVICE: f64 = 3.0;
/// Quotient of the frequencies of neighbouring stiffnesses that a first design holds, at least: the modes of each are shifted by 15 % either way as well.
pub(crate) const NEXT_STIFFNESS: f64 = 1.5;
