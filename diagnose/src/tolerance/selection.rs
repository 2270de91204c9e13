//! Limits of scans, pairs and knots during the selection of effects. More points cost replays in proportion; fewer miss narrow optima.

/// Step of a point of the fine curve, as a fraction of the linear gain.
pub const CURVE_STEP: f64 = 1e-3;
/// Curvature, in floors squared, of the preference for a fraction as it is: 0.3 costs one unit. It holds what no recording shows.
pub const CURVE_PREFERENCE: f64 = 11.0;
/// Effects with more parameters than this are not tried in pairs.
pub const PAIRED_PARAMETERS: usize = 4;
/// Orders at which a torque is sought that repeats with an angle, per turn.
pub const SCANNED_ORDERS: [f64; 25] = [
    1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 15.0, 16.0, 18.0, 20.0, 21.0, 22.0,
    24.0, 28.0, 30.0, 36.0, 45.0, 60.0,
];
/// Orders that go on from the spectrum of the drive's balance over the motor's angle.
pub const ORDER_PEAKS: usize = 3;
/// Least share of the balance that one of these explains.
pub const ORDER_PEAK_SHARE: f64 = 0.05;
/// Steps of that spectrum for the width of a line, which is a period over the travel.
pub const ORDER_STEPS_A_LINE: f64 = 4.0;
/// Most lines of the spectrum.
pub const ORDER_SPECTRUM_LINES: usize = 4000;
/// Most samples that a line is computed from.
pub const ORDER_SPECTRUM_SAMPLES: usize = 2000;
/// Points of a scan of a parameter over its range.
pub const SCAN_POINTS: usize = 64;
/// Points of each of the two refinements of a scan.
pub const SCAN_REFINEMENT_POINTS: usize = 9;
/// Number of points of a scan with assessments, and of each of its refinements.
pub const ASSESSED_SCAN_POINTS: [usize; 3] = [32, 8, 8];
/// Share of the distance that the best point of a scan must remove for the scan to be refined.
pub const SCAN_REFINEMENT_SHARE: f64 = 0.15;
/// Number of orders of a repeating torque that go on from the scan.
pub const ORDERS_KEPT: usize = 3;
/// Largest multiple of a direction that a signature may ask for.
pub const LARGEST_MULTIPLE: f64 = 30.0;
/// Largest multiple of a plain quantity's direction if the typical sizes are not the machine's.
pub const LARGEST_SCALED_MULTIPLE: f64 = 3e3;
/// Largest change of a logarithm if the typical sizes are not the machine's.
pub const LARGEST_SCALED_LOGARITHM: f64 = 3.0;
/// Largest multiple of a torque that repeats if the typical sizes are not the machine's.
pub const LARGEST_SCALED_RIPPLE: f64 = 500.0;
/// Factors on the value of a quantity that is positive by nature at which it is tried if the machine's sizes are unknown: dry
/// friction that a model nearly lacks, for example.
pub const SCALED_FACTORS: [f64; 2] = [4.0, 16.0];
/// Number of starts of an effect that are evaluated at full size.
pub const STARTS_VISITED: usize = 3;
/// Perturbations whose replays run side by side: more of one shape fill the registers, and each holds the residuals of its recordings.
pub const PERTURBATIONS_TOGETHER: usize = 8;
/// Interval in samples at which a trace is kept.
pub const TRACE_STRIDE: usize = 7;

/// Part of a spacing by which a last knot may stand on the grid, so that the grid does not repeat it.
pub const SAME_GRID_PLACE: f64 = 1e-6;

/// Determinant of the normal equations of two signatures, relative to the product of their powers, up to which they are one signature.
pub const INDEPENDENT_SIGNATURES: f64 = 1e-6;
/// Relative distance of a ripple's order from a whole number up to which it is rounded: teeth and poles are counted, and a fit that misses a
/// whole order by so little has found it.
pub const WHOLE_ORDER: f64 = 0.004;
/// Factor on the cost up to which the fit with the rounded order is preferred.
pub const ROUNDED_ORDER_COST: f64 = 1.01;
/// Share of the knots' spacing within which two knots are one: a curve with both would be steep between them by rounding alone.
pub const SAME_KNOT: f64 = 0.1;
/// Rate of the hub of a machine like the reference rig, rad/s: its experiments go to 0.1 and 0.15 rad/s.
pub const TYPICAL_RATE_RAD_S: f64 = 0.1;
/// Rates of Stribeck's curve from which a fit starts on a machine of any size, as shares of the hub's usual rate.
pub const STRIBECK_STARTS: [f64; 4] = [0.02, 0.06, 0.2, 0.5];
/// Limits of the current from which a fit starts on such a machine, as shares of the current that the largest control drives through the
/// motor at rest.
pub const CURRENT_LIMIT_STARTS: [f64; 6] = [0.7, 0.4, 0.25, 0.15, 0.08, 0.04];
/// The least and the largest of such limits that are scanned.
pub const CURRENT_LIMIT_SHARES: [f64; 2] = [0.02, 0.9];
