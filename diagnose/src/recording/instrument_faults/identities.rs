//! The identities that the columns of one recording must satisfy, whatever the mechanism's physics.
//!
//! ```text
//!     motor_rate / N     = hub_rate - platform_rate + lag x (their slopes) + J / K x hub_rate''
//!     d hub_position/dt  = hub_rate - platform_rate + lag x (their slopes)
//!     control            = kp (demand - hub_rate) + ki integral (demand - hub_rate) + constant
//! ```
//!
//! The first two are the kinematics (the gear's wind-up is the second slope; the lag is the gyroscopes'), smoothed alike; the third
//! is the controller as the project has it. A factor on a column is the ratio of two coefficients that should be one.

use crate::tolerance::recording::{IDENTITY_DOUBT, NEAR_LIMIT_V, PLATFORM_MOVES_RAD_S, SMOOTHING_S};
use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;

use super::column::RecorderColumn;
use super::regression::{Regression, delay_series, regress};
use crate::recording::series::{derivative, deviation, low_pass};

/// Factor of one column over the factor of another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ratio {
    pub above: RecorderColumn,
    pub below: RecorderColumn,
    pub value: f64,
    /// Relative.
    pub doubt: f64,
}

/// The result of one identity.
#[derive(Debug, Clone)]
pub(super) struct Identity {
    pub of: RecorderColumn,
    pub ratios: Vec<Ratio>,
    /// Lead of the column before the gyroscopes, s, and its uncertainty.
    pub lead_s: (f64, f64),
    /// Offset to be added to the gyroscopes, and its uncertainty.
    pub constant: (f64, f64),
    /// Share that is left.
    pub share: f64,
    /// RMS that is left, in the unit of the left side.
    pub left: f64,
    /// Share of the left side that the right side with all factors at one does not give.
    pub broken: f64,
}

/// All identities that a recording allows.
pub(super) fn list_identities(base: &Parameters, control: &ReplayLoop, r: &Recording) -> Vec<Identity> {
    let ratio = base.gearbox.ratio;
    let motor = r.samples(Channel::MotorRate).map(|w| w.iter().map(|v| v / ratio).collect::<Vec<f64>>());
    let angle = r.samples(Channel::HubPosition).map(|a| derivative(a, r.sample_period_s));
    let kinematic = [
        motor.and_then(|w| kinematic_identity(RecorderColumn::MotorRate, &w, r)),
        angle.and_then(|w| kinematic_identity(RecorderColumn::HubPosition, &w, r)),
    ];
    let loops = proportional_integral(control)
        .and_then(|controller| controller_identity(controller, r, ColumnShift::NONE));
    kinematic.into_iter().flatten().chain(loops).collect()
}

/// Returns the proportional-integral controller of a loop. The identity of another controller is not linear in the columns' factors, so
/// that it finds no factor; `control_fit` of the simulator compares its control as a whole.
pub(super) fn proportional_integral(control: &ReplayLoop) -> Option<&ProportionalIntegral> {
    match control {
        ReplayLoop::Closed(controller) => controller.as_proportional_integral(),
        ReplayLoop::Open => None,
    }
}

/// The kinematics of one sensor's rate of the hub on the platform.
pub(super) fn kinematic_identity(of: RecorderColumn, rate: &[f64], r: &Recording) -> Option<Identity> {
    let half = (SMOOTHING_S / r.sample_period_s).round().max(1.0) as usize;
    let margin = 4 * half;
    let ready = |series: &[f64]| {
        let mut out = low_pass(series, half);
        let last = out.len();
        out[..margin.min(last)].fill(f64::NAN);
        out[last.saturating_sub(margin)..].fill(f64::NAN);
        out
    };
    let hub = ready(r.samples(Channel::HubRate)?);
    let platform =
        r.samples(Channel::PlatformRate).map(ready).filter(|p| deviation(p) > PLATFORM_MOVES_RAD_S);
    let y = ready(rate);
    let first = derivative(&hub, r.sample_period_s);
    let second = derivative(&first, r.sample_period_s);
    let turning = platform.as_ref().map(|p| derivative(p, r.sample_period_s));
    let one = vec![1.0; y.len()];
    let mut columns: Vec<&[f64]> = vec![&one, &hub, &first];
    columns.extend(platform.iter().chain(&turning).map(Vec::as_slice));
    if of == RecorderColumn::MotorRate {
        columns.push(&second);
    }
    let found = regress(&columns, &y)?;
    let mut ratios = vec![column_ratio(
        of,
        RecorderColumn::HubRate,
        &Coefficient { value: found.value[1], doubt: found.doubt[1] },
        IDENTITY_DOUBT.0,
    )];
    if platform.is_some() {
        ratios.push(column_ratio(
            of,
            RecorderColumn::PlatformRate,
            &Coefficient { value: -found.value[3], doubt: found.doubt[3] },
            IDENTITY_DOUBT.0,
        ));
    }
    let still = vec![0.0; y.len()];
    let platform = platform.as_deref().unwrap_or(&still);
    let expected = |k: usize| y[k] - hub[k] + platform[k];
    let broken = deviation(&(0..y.len()).map(expected).collect::<Vec<f64>>());
    // the lag shows in what moves more: the hub, or the platform beneath it
    let (rate, lag) = if deviation(platform) > deviation(&hub) { (3, 4) } else { (1, 2) };
    let size = found.value[rate].abs().max(f64::MIN_POSITIVE);
    Some(Identity {
        of,
        ratios,
        lead_s: (found.value[lag] / found.value[rate], found.doubt[lag] / size),
        constant: (found.value[0], found.doubt[0]),
        broken: broken / deviation(&y).max(f64::MIN_POSITIVE),
        share: found.share,
        left: found.left,
    })
}

/// A coefficient of a regression.
struct Coefficient {
    value: f64,
    doubt: f64,
}

/// The factor of one column over that of another, from the coefficient that should be one.
fn column_ratio(
    above: RecorderColumn,
    below: RecorderColumn,
    coefficient: &Coefficient,
    least_doubt: f64,
) -> Ratio {
    let Coefficient { value, doubt } = *coefficient;
    Ratio { above, below, value, doubt: least_doubt + doubt / value.abs().max(f64::MIN_POSITIVE) }
}

/// A column that is taken as late.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColumnShift {
    /// The column.
    pub column: RecorderColumn,
    /// By how many samples it is late.
    pub samples: i32,
}

impl ColumnShift {
    /// No column is taken as late.
    pub const NONE: Self = Self { column: RecorderColumn::Control, samples: 0 };
}

/// The controller's identity with one column taken as late.
pub(super) fn controller_identity(
    controller: &ProportionalIntegral,
    r: &Recording,
    moved: ColumnShift,
) -> Option<Identity> {
    let shift = |column: RecorderColumn| {
        let series = column.of(r)?;
        let shifted = column == moved.column && moved.samples != 0;
        Some(if shifted { delay_series(series, -f64::from(moved.samples)) } else { series.to_vec() })
    };
    let (demand, hub) = (shift(RecorderColumn::Demand)?, shift(RecorderColumn::HubRate)?);
    let mut control = shift(RecorderColumn::Control)?;
    control.iter_mut().filter(|u| (u.abs() - 10.0).abs() < NEAR_LIMIT_V).for_each(|u| *u = f64::NAN);
    let driven = |series: &[f64]| apply_proportional_integral(controller, series, r.sample_period_s);
    let (wanted, had) = (driven(&demand), driven(&hub));
    let one = vec![1.0; control.len()];
    let moves = deviation(&demand) > 0.0;
    let mut columns: Vec<&[f64]> = vec![&one, &had];
    columns.extend(moves.then_some(wanted.as_slice()));
    let found: Regression = regress(&columns, &control)?;
    let mut ratios = vec![column_ratio(
        RecorderColumn::Control,
        RecorderColumn::HubRate,
        &Coefficient { value: -found.value[1], doubt: found.doubt[1] },
        IDENTITY_DOUBT.1,
    )];
    if moves {
        ratios.push(column_ratio(
            RecorderColumn::Control,
            RecorderColumn::Demand,
            &Coefficient { value: found.value[2], doubt: found.doubt[2] },
            IDENTITY_DOUBT.1,
        ));
    }
    let expected = |k: usize| control[k] - wanted[k] + had[k];
    let broken = deviation(&(0..control.len()).map(expected).collect::<Vec<f64>>());
    Some(Identity {
        of: RecorderColumn::Control,
        ratios,
        lead_s: (0.0, 0.0),
        constant: (found.value[0], found.doubt[0]),
        broken: broken / deviation(&control).max(f64::MIN_POSITIVE),
        share: found.share,
        left: found.left,
    })
}

/// kp x + ki (sum of x before); what is missing counts as the last value known in the sum, and stays missing itself.
pub(super) fn apply_proportional_integral(
    controller: &ProportionalIntegral,
    series: &[f64],
    period_s: f64,
) -> Vec<f64> {
    let (mut sum, mut last) = (0.0, 0.0);
    let step = |x: &f64| {
        let out = controller.kp_v_s_rad * x + sum;
        last = if x.is_finite() { *x } else { last };
        sum += controller.ki_v_rad * period_s * last;
        out
    };
    series.iter().map(step).collect()
}
