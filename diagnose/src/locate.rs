//! Where and when: balances of motion and torque formed from the measured signals alone.
//!
//! All signals pass the same low-pass Q, so that a derivative brings no bias:
//!
//! ```text
//!     twist   Q[w_h - w_p - w_m / N] + d/dt (T_2 / K)            gear kinematics and elasticity
//!     drive   Q[J w_h' + N J_m w_m' - N K_t i + N F_m + F_p + T_oob]   everything that makes torque, either side
//!     hub     Q[J w_h' + F_p + T_oob - K deadzone(delta)]        what acts on the hub side of the gear
//! ```
//!
//! A mismatch shows in the balances that contain its component, and in no other; which balances there are depends on
//! the sensors. What is left of a balance is then looked at as a function of one regime variable at a time.

use counterpoise_models::Parameters;
use serde::Serialize;

use crate::answer::MapCell;
use crate::shape::shape;

/// What was measured, as the balances need it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Sample period, s.
    pub period_s: f64,
    /// Control, V.
    pub control: Vec<f64>,
    /// Hub rate, rad/s.
    pub hub_rate: Vec<f64>,
    /// Platform rate, rad/s.
    pub platform_rate: Vec<f64>,
    /// Heave, m/s^2.
    pub platform_accel: Vec<f64>,
    /// Motor rate, rad/s.
    pub motor_rate: Option<Vec<f64>>,
    /// Hub angle on the platform, rad.
    pub hub_position: Option<Vec<f64>>,
}

/// A balance, what it needs and what it sees.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Signature {
    /// Name of the balance.
    pub balance: &'static str,
    /// Whether these sensors allow it.
    pub available: bool,
    /// Components whose mismatch shows in it.
    pub sees: Vec<&'static str>,
}

/// The balances that a set of sensors allows.
pub fn isolability(motor_rate: bool, hub_position: bool) -> Vec<Signature> {
    let row =
        |balance, available, sees: &[&'static str]| Signature { balance, available, sees: sees.to_vec() };
    vec![
        row("current", false, &["amplifier"]),
        row("twist", motor_rate, &["gearbox", "hub_gyro", "platform_gyro"]),
        row("drive", true, &["amplifier", "motor", "gearbox", "pivot", "structure", "control", "hub_gyro"]),
        row("hub", motor_rate && hub_position, &["gearbox", "pivot", "structure", "hub_gyro"]),
    ]
}

/// A balance's residual, and the regime variables along it.
pub(crate) struct Balance {
    pub(crate) component: &'static str,
    pub(crate) residual: Vec<f64>,
    regimes: Vec<(&'static str, Vec<f64>)>,
}

/// Component x regime: the share of each balance's residual that follows each regime variable.
pub fn regime_map(parameters: &Parameters, recordings: &[Measured]) -> Vec<MapCell> {
    cells(&recordings.iter().map(|r| balances(parameters, r)).collect::<Vec<_>>())
}

/// The cells of the balances of several recordings.
pub(crate) fn cells(balances: &[Vec<Balance>]) -> Vec<MapCell> {
    let mut cells: Vec<MapCell> = Vec::new();
    for component in ["twist", "drive", "hub"] {
        let here: Vec<&Balance> = balances.iter().flatten().filter(|b| b.component == component).collect();
        let Some(first) = here.first() else { continue };
        for (k, &(regime, _)) in first.regimes.iter().enumerate() {
            let residual: Vec<f64> = here.iter().flat_map(|b| b.residual.iter().copied()).collect();
            let variable: Vec<f64> = here.iter().flat_map(|b| b.regimes[k].1.iter().copied()).collect();
            let explained = explained(&residual, &variable);
            let shape =
                if explained > SHAPED { shape(&residual, &variable, unit(regime)) } else { String::new() };
            cells.push(MapCell { component, regime, explained, shape });
        }
    }
    cells
}

/// Share of a balance's power from which its shape along a variable is described.
const SHAPED: f64 = 0.1;

/// The unit of a regime variable, with a space before it.
fn unit(regime: &str) -> &'static str {
    match regime {
        "rate" | "amplitude" => " rad/s",
        "position" | "motor angle" => " rad",
        "load" => " N m",
        "control" => " V",
        "time" => " s",
        "acceleration" => " rad/s^2",
        _ => "",
    }
}

/// The measured signals after the low-pass, and what follows from them.
struct Signals<'a> {
    p: &'a Parameters,
    period_s: f64,
    control: Vec<f64>,
    hub: Vec<f64>,
    platform: Vec<f64>,
    motor: Vec<f64>,
    relative: Vec<f64>,
    angle: Vec<f64>,
    hub_acceleration: Vec<f64>,
    /// Torque that the load side needs, N m.
    load: Vec<f64>,
    /// Torque that the motor gives to the gear, at its output, N m.
    mesh: Vec<f64>,
}

impl<'a> Signals<'a> {
    fn new(p: &'a Parameters, m: &Measured) -> Self {
        let smooth = |series: &[f64]| low_pass(series, SMOOTHING);
        let (hub, platform) = (smooth(&m.hub_rate), smooth(&m.platform_rate));
        let relative: Vec<f64> = hub.iter().zip(&platform).map(|(h, p)| h - p).collect();
        let geared = || relative.iter().map(|w| w * p.gearbox.ratio).collect();
        let motor = m.motor_rate.as_ref().map_or_else(geared, |w| smooth(w));
        let angle = m.hub_position.as_ref().map_or_else(|| integral(&relative, m.period_s), |a| smooth(a));
        let hub_acceleration = derivative(&hub, m.period_s);
        let control = smooth(&m.control);
        let (load, mesh) = (Vec::new(), Vec::new());
        let period_s = m.period_s;
        let mut signals = Self {
            p,
            period_s,
            control,
            hub,
            platform,
            motor,
            relative,
            angle,
            hub_acceleration,
            load,
            mesh,
        };
        signals.load = signals.load_torque(&smooth(&m.platform_accel));
        signals.mesh = signals.motor_torque();
        signals
    }

    /// J w_h' + F_p + T_oob.
    fn load_torque(&self, heave: &[f64]) -> Vec<f64> {
        let p = self.p;
        let (inertia, moment) = p
            .lumped
            .as_ref()
            .map_or((0.0, 0.0), |l| (l.hub_inertia_kg_m2 + l.beam_inertia_kg_m2, l.out_of_balance_kg_m));
        let dry = dry_along(p.pivot_friction.coulomb_nm(), &self.relative);
        let at = |k: usize| {
            let weight = (p.gravity_m_s2 + heave[k]) * moment * self.angle[k].cos();
            inertia * self.hub_acceleration[k]
                + dry[k]
                + p.pivot_friction.viscous_nm_s_rad * self.relative[k]
                + weight
        };
        (0..self.hub.len()).map(at).collect()
    }

    /// N (K_t i - F_m - J_m w_m').
    fn motor_torque(&self) -> Vec<f64> {
        let p = self.p;
        let loss = p.motor.resistance_ohm + p.amplifier.gain * p.amplifier.current_feedback_v_a;
        let dry = dry_along(p.motor_friction.coulomb_nm(), &self.motor);
        let acceleration = derivative(&self.motor, self.period_s);
        let at = |k: usize| {
            let current =
                (p.amplifier.gain * self.control[k] - p.motor.back_emf_v_s_rad * self.motor[k]) / loss;
            let friction = dry[k] + p.motor_friction.viscous_nm_s_rad * self.motor[k];
            let inertial = p.motor.inertia_kg_m2 * acceleration[k];
            p.gearbox.ratio * (p.motor.torque_constant_nm_a * current - friction - inertial)
        };
        (0..self.hub.len()).map(at).collect()
    }

    fn drive(&self) -> Vec<f64> {
        self.load.iter().zip(&self.mesh).map(|(load, mesh)| load - mesh).collect()
    }

    fn twist(&self) -> Vec<f64> {
        let windup = derivative(&self.mesh, self.period_s);
        let gear = &self.p.gearbox;
        let at = |k: usize| {
            self.hub[k] - self.platform[k] - self.motor[k] / gear.ratio + windup[k] / gear.stiffness_nm_rad
        };
        (0..self.hub.len()).map(at).collect()
    }

    /// The gear's wind-up from both encoders, its start from the load, against the load torque.
    fn hub_side(&self) -> Vec<f64> {
        let gear = &self.p.gearbox;
        let turned = integral(&self.motor, self.period_s);
        let gap = 0.5 * gear.backlash_rad;
        let first = self.load.first().copied().unwrap_or(0.0);
        let start =
            first / gear.stiffness_nm_rad + gap * first.signum() + self.angle.first().copied().unwrap_or(0.0);
        let at = |k: usize| {
            let delta: f64 = start + turned[k] / gear.ratio - self.angle[k];
            self.load[k] - gear.stiffness_nm_rad * (delta.abs() - gap).max(0.0) * delta.signum()
        };
        (0..self.hub.len()).map(at).collect()
    }

    fn regimes(&self) -> Vec<(&'static str, Vec<f64>)> {
        let turn = |a: &f64| (a * self.p.gearbox.ratio).rem_euclid(std::f64::consts::TAU);
        let time = (0..self.hub.len()).map(|k| k as f64 * self.period_s).collect();
        let signals: [(&'static str, Vec<f64>); 9] = [
            ("rate", self.relative.clone()),
            ("reversal", self.relative.iter().map(|w| w.signum()).collect()),
            ("position", self.angle.clone()),
            ("motor angle", self.angle.iter().map(turn).collect()),
            ("load", self.mesh.clone()),
            ("control", self.control.clone()),
            ("time", time),
            ("acceleration", self.hub_acceleration.clone()),
            ("amplitude", envelope(&self.relative, self.period_s)),
        ];
        signals.map(|(name, series)| (name, thin(&series))).to_vec()
    }
}

/// The balances that a recording allows.
pub(crate) fn balances(p: &Parameters, m: &Measured) -> Vec<Balance> {
    let signals = Signals::new(p, m);
    let balance = |component, residual: Vec<f64>| Balance {
        component,
        residual: thin(&residual),
        regimes: signals.regimes(),
    };
    let mut out = vec![balance("drive", signals.drive())];
    if m.motor_rate.is_some() {
        out.push(balance("twist", signals.twist()));
    }
    if m.motor_rate.is_some() && m.hub_position.is_some() {
        out.push(balance("hub", signals.hub_side()));
    }
    out
}

/// Half width of the smoothing window, samples; two passes.
const SMOOTHING: usize = 10;
/// Every this many samples one is kept for the map.
const THINNING: usize = 5;
/// Bins of a regime variable.
const BINS: usize = 24;

fn low_pass(series: &[f64], half: usize) -> Vec<f64> {
    let once = moving_mean(series, half);
    moving_mean(&once, half)
}

fn moving_mean(series: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(series.len() + 1);
    sums.push(0.0);
    for &value in series {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mean = |k: usize| {
        let from = k.saturating_sub(half);
        let to = (k + half + 1).min(series.len());
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..series.len()).map(mean).collect()
}

fn derivative(series: &[f64], period: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        if to == from { 0.0 } else { (series[to] - series[from]) / ((to - from) as f64 * period) }
    };
    (0..series.len()).map(at).collect()
}

fn integral(series: &[f64], period: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let step = |w: &f64| {
        sum += w * period;
        sum
    };
    series.iter().map(step).collect()
}

/// Dry friction of one level along a rate: full against the motion, falling off near standstill.
fn dry_along(level: f64, rate: &[f64]) -> Vec<f64> {
    let scale = 0.02 * crate::bench::rms(rate).max(1e-9);
    rate.iter().map(|w| level * (w / scale).tanh()).collect()
}

fn envelope(series: &[f64], period: f64) -> Vec<f64> {
    let half = (0.25 / period).round() as usize;
    let squares: Vec<f64> = series.iter().map(|w| w * w).collect();
    moving_mean(&squares, half).iter().map(|s| s.sqrt()).collect()
}

fn thin(series: &[f64]) -> Vec<f64> {
    let margin = (4 * SMOOTHING).min(series.len() / 4);
    series[margin..series.len() - margin].iter().step_by(THINNING).copied().collect()
}

/// Share of the residual's power that a function of the variable explains, found on every other stretch of the data
/// and judged on the rest; never below 0.
fn explained(residual: &[f64], variable: &[f64]) -> f64 {
    let stretch = (residual.len() / 40).max(1);
    let is_training = |k: usize| (k / stretch).is_multiple_of(2);
    let edges = quantiles(variable);
    let bin = |v: f64| edges.partition_point(|&edge| edge < v);
    let mut sums = vec![(0.0, 0.0); BINS + 1];
    for k in (0..residual.len()).filter(|&k| is_training(k)) {
        let slot = &mut sums[bin(variable[k])];
        *slot = (slot.0 + residual[k], slot.1 + 1.0);
    }
    let (mut left, mut total) = (0.0, 0.0);
    for k in (0..residual.len()).filter(|&k| !is_training(k)) {
        let (sum, count) = sums[bin(variable[k])];
        let expected = if count > 0.0 { sum / count } else { 0.0 };
        left += (residual[k] - expected).powi(2);
        total += residual[k] * residual[k];
    }
    if total > 0.0 { (1.0 - left / total).max(0.0) } else { 0.0 }
}

fn quantiles(variable: &[f64]) -> Vec<f64> {
    let mut sorted = variable.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |q: usize| sorted.get(q * sorted.len() / BINS).copied().unwrap_or(0.0);
    (1..BINS).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_of_the_variable_is_found_and_noise_is_not() {
        let mut seed = 7u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        let variable: Vec<f64> = (0..4000).map(|k| (k as f64 * 0.013).sin() + 0.1 * noise()).collect();
        let follows: Vec<f64> = variable.iter().map(|v| v.abs() + 0.05 * noise()).collect();
        let free: Vec<f64> = (0..4000).map(|_| noise()).collect();
        assert!(explained(&follows, &variable) > 0.95);
        assert!(explained(&free, &variable) < 0.05);
    }
}
