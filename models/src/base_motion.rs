//! Motion of the base in six degrees of freedom, and what of it the elevation axis feels.
//!
//! Axes fixed to the base: x forward, y to the left, z up, right-handed. A rate about x is roll (the left side rises), a rate about
//! -y is pitch (the nose rises), a rate about z is yaw (the nose turns left). The specific force is what an accelerometer reads:
//! inertial acceleration less gravity, g upward at rest.
//!
//! The elevation axis stands on a traverse ring that is turned by psi about z. On the ring let P, Q and R be the inertial rates about
//! its forward, right (the elevation axis) and upward axes, R with the ring's own rate. phi is the integral of Q. Turned back by phi about the
//! elevation axis, the ring's axes do not rotate about it: in them the specific force of the pivot has the forward component s_X and the
//! upward one s_Z, and the rates about them are P' and R'. Then with the hub's inertial angle theta_h (the integral of its rate about the axis)
//!
//! ```text
//!     T_oob  = mu (s_Z cos theta_h - s_X sin theta_h) - nu (s_Z sin theta_h + s_X cos theta_h)
//!     T_gyro = -J' (P' cos theta_h + R' sin theta_h) (R' cos theta_h - P' sin theta_h)
//! ```
//!
//! exactly, whatever the angles are: all four are functions of time alone. J' is the moment of inertia about the normal of the beam in its plane
//! of elevation less that about the beam. `docs/theory/base-motion.md` has the derivation.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// The base at one instant, in axes fixed to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseState {
    /// Specific force of the pivot along x, y and z, m/s^2.
    pub specific_force_m_s2: [f64; 3],
    /// Inertial rate about x, y and z, rad/s.
    pub rate_rad_s: [f64; 3],
}

/// The ring on which the elevation axis stands.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Traverse {
    /// Angle about the base's z axis at the start, rad, positive to the left.
    pub angle_rad: f64,
    /// Rate relative to the base, rad/s.
    pub rate_rad_s: f64,
}

/// Motion of the base that acts on the elevation axis at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FeltMotion {
    /// Upward acceleration s_Z - g, m/s^2.
    pub heave_m_s2: f64,
    /// Forward acceleration s_X, m/s^2.
    pub surge_m_s2: f64,
    /// Rate about the elevation axis Q, rad/s, positive nose-up.
    pub pitch_rate_rad_s: f64,
    /// Rate about the forward axis P', rad/s.
    pub roll_rate_rad_s: f64,
    /// Rate about the upward axis R', rad/s.
    pub yaw_rate_rad_s: f64,
}

/// Mounting of an inertial measurement unit on the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting {
    /// From the unit's axes to those of the base.
    pub rotation: Rotation3<f64>,
    /// From the unit to the pivot, in axes of the base, m.
    pub lever_arm_m: Vector3<f64>,
}

impl Mounting {
    /// Returns the mounting of a unit that is turned from the base's axes about x, then y, then z (fixed axes), rad.
    pub fn new(angles_rad: [f64; 3], lever_arm_m: [f64; 3]) -> Self {
        let [x, y, z] = angles_rad;
        Self { rotation: Rotation3::from_euler_angles(x, y, z), lever_arm_m: Vector3::from(lever_arm_m) }
    }

    /// Returns the base's motion at the pivot from samples of the unit: s + w' x r + w x (w x r), with w' by central differences.
    pub fn at_pivot(&self, unit: &[BaseState], period_s: f64) -> Vec<BaseState> {
        let rates: Vec<Vector3<f64>> =
            unit.iter().map(|state| self.rotation * Vector3::from(state.rate_rad_s)).collect();
        let arm = self.lever_arm_m;
        let of = |(k, state): (usize, &BaseState)| {
            let (low, high) = (k.saturating_sub(1), (k + 1).min(rates.len() - 1));
            let span_s = (high - low) as f64 * period_s;
            let turned = if high > low { (rates[high] - rates[low]) / span_s } else { Vector3::zeros() };
            let rate = rates[k];
            let read = self.rotation * Vector3::from(state.specific_force_m_s2);
            let felt = read + turned.cross(&arm) + rate.cross(&rate.cross(&arm));
            BaseState { specific_force_m_s2: felt.into(), rate_rad_s: rate.into() }
        };
        unit.iter().enumerate().map(of).collect()
    }
}

/// Returns the base's motion from accelerations in axes that do not turn (x forward and z up at the start) and rates in axes of the base. The
/// base's attitude is the integral of its rates, from level.
pub fn from_inertial(
    acceleration_m_s2: &[[f64; 3]],
    rate_rad_s: &[[f64; 3]],
    period_s: f64,
    gravity_m_s2: f64,
) -> Vec<BaseState> {
    let mut attitude = UnitQuaternion::identity();
    let mut states = Vec::with_capacity(acceleration_m_s2.len());
    for (k, (acceleration, rate)) in acceleration_m_s2.iter().zip(rate_rad_s).enumerate() {
        if k > 0 {
            let turned = turn(rate_rad_s[k - 1].into(), (*rate).into(), period_s);
            attitude *= UnitQuaternion::from_scaled_axis(turned);
        }
        let force = Vector3::from(*acceleration) + Vector3::new(0.0, 0.0, gravity_m_s2);
        let specific_force_m_s2 = attitude.inverse_transform_vector(&force).into();
        states.push(BaseState { specific_force_m_s2, rate_rad_s: *rate });
    }
    states
}

/// The turn over a period in which the rate goes straight from one value to the next: Magnus' expansion to its second term (A. Iserles and
/// S. Norsett, Philosophical Transactions A 357, 1999), of fourth order.
fn turn(before: Vector3<f64>, after: Vector3<f64>, period_s: f64) -> Vector3<f64> {
    0.5 * period_s * (before + after) + period_s * period_s / 12.0 * before.cross(&after)
}

/// Returns what the elevation axis feels of a base's motion; `level` says how the axes that do not turn are chosen at the start.
pub fn motion_at_elevation_axis(
    base: &[BaseState],
    period_s: f64,
    traverse: Traverse,
    gravity_m_s2: f64,
    level: Level,
) -> Vec<FeltMotion> {
    let ring: Vec<Ring> =
        base.iter().enumerate().map(|(k, state)| Ring::of(state, traverse, k as f64 * period_s)).collect();
    let angle = integral(&ring.iter().map(|at| at.pitch).collect::<Vec<f64>>(), period_s);
    let turned: Vec<[f64; 4]> = ring.iter().zip(&angle).map(|(at, phi)| at.turned_back(*phi)).collect();
    let tilt = match level {
        Level::Known => 0.0,
        Level::ByMean => {
            let sum = turned.iter().fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]]);
            if sum == [0.0; 2] { 0.0 } else { sum[0].atan2(sum[1]) }
        }
    };
    let (sin, cos) = tilt.sin_cos();
    let of = |(at, [x, z, roll, yaw]): (&Ring, &[f64; 4])| FeltMotion {
        heave_m_s2: x * sin + z * cos - gravity_m_s2,
        surge_m_s2: x * cos - z * sin,
        pitch_rate_rad_s: at.pitch,
        roll_rate_rad_s: roll * cos - yaw * sin,
        yaw_rate_rad_s: roll * sin + yaw * cos,
    };
    ring.iter().zip(&turned).map(of).collect()
}

/// Returns what a traverse axis feels of a base's motion: its yaw as the rate about the axis, and as heave and surge the specific force to the
/// left and forward in axes that are turned back by the integral of the yaw.
pub fn motion_at_traverse_axis(base: &[BaseState], period_s: f64) -> Vec<FeltMotion> {
    let yaw: Vec<f64> = base.iter().map(|state| state.rate_rad_s[2]).collect();
    let of = |(state, turned): (&BaseState, &f64)| {
        let ((sin, cos), [x, y, _]) = (turned.sin_cos(), state.specific_force_m_s2);
        FeltMotion {
            heave_m_s2: x * sin + y * cos,
            surge_m_s2: x * cos - y * sin,
            pitch_rate_rad_s: state.rate_rad_s[2],
            ..FeltMotion::default()
        }
    };
    base.iter().zip(&integral(&yaw, period_s)).map(of).collect()
}

/// Returns the base's motion from what an elevation axis feels of it that points forward, and one that points to the left, both in axes that do
/// not turn about their own axis. An axis that points to the left may be missing: then nothing acts across the plane of the first.
pub fn base_of_felt(
    forward: &[FeltMotion],
    left: Option<&[FeltMotion]>,
    period_s: f64,
    gravity_m_s2: f64,
) -> Vec<BaseState> {
    let on_ring = |felt: &[FeltMotion]| -> Vec<Ring> {
        let rates: Vec<f64> = felt.iter().map(|at| at.pitch_rate_rad_s).collect();
        let of = |(at, phi): (&FeltMotion, &f64)| {
            let turned = Ring {
                forward: at.surge_m_s2,
                up: at.heave_m_s2 + gravity_m_s2,
                roll: at.roll_rate_rad_s,
                pitch: at.pitch_rate_rad_s,
                yaw: at.yaw_rate_rad_s,
            };
            let [forward, up, roll, yaw] = turned.turned_back(-phi);
            Ring { forward, up, roll, yaw, ..turned }
        };
        felt.iter().zip(&integral(&rates, period_s)).map(of).collect()
    };
    let sideways = left.map(on_ring);
    let of = |(k, at): (usize, Ring)| BaseState {
        specific_force_m_s2: [at.forward, sideways.as_ref().map_or(0.0, |left| left[k].forward), at.up],
        rate_rad_s: [at.roll, -at.pitch, at.yaw],
    };
    on_ring(forward).into_iter().enumerate().map(of).collect()
}

/// Choice of the axes that do not turn at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// The base is level at the start.
    Known,
    /// The mean of the specific force points upward: for a recording whose initial attitude was not measured.
    ByMean,
}

/// Specific force and rates in axes of the traverse ring.
#[derive(Debug, Clone, Copy)]
struct Ring {
    forward: f64,
    up: f64,
    roll: f64,
    pitch: f64,
    yaw: f64,
}

impl Ring {
    fn of(base: &BaseState, traverse: Traverse, time_s: f64) -> Self {
        let (sin, cos) = (traverse.angle_rad + traverse.rate_rad_s * time_s).sin_cos();
        let (s, w) = (&base.specific_force_m_s2, &base.rate_rad_s);
        Self {
            forward: s[0] * cos + s[1] * sin,
            up: s[2],
            roll: w[0] * cos + w[1] * sin,
            pitch: w[0] * sin - w[1] * cos,
            yaw: w[2] + traverse.rate_rad_s,
        }
    }

    /// Forward and upward specific force, roll and yaw rate in axes that are turned back by phi about the elevation axis.
    fn turned_back(&self, phi: f64) -> [f64; 4] {
        let (sin, cos) = phi.sin_cos();
        [
            self.forward * cos - self.up * sin,
            self.forward * sin + self.up * cos,
            self.roll * cos - self.yaw * sin,
            self.roll * sin + self.yaw * cos,
        ]
    }
}

/// The integral from 0 of the cubic through the samples with slopes by central differences, as the simulator joins them.
fn integral(values: &[f64], period_s: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |k: usize| {
        let (low, high) = (k.saturating_sub(1), (k + 1).min(last));
        if high == low { 0.0 } else { (values[high] - values[low]) / (high - low) as f64 }
    };
    let mut sum = 0.0;
    let mut all = Vec::with_capacity(values.len());
    for k in 0..values.len() {
        if k > 0 {
            sum += period_s * (0.5 * (values[k - 1] + values[k]) + (slope(k - 1) - slope(k)) / 12.0);
        }
        all.push(sum);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const G: f64 = 9.80665;

    fn base_at_rest(count: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        (vec![[0.0; 3]; count], vec![[0.0; 3]; count])
    }

    #[test]
    fn in_a_plane_the_felt_motion_is_the_inertial_one() {
        let (mut acceleration, mut rate) = base_at_rest(2001);
        for k in 0..2001 {
            let t = 1e-3 * k as f64;
            acceleration[k] = [2.0 * (5.0 * t).sin(), 0.0, (7.0 * t).cos()];
            rate[k] = [0.0, -0.8 * (6.0 * t).cos(), 0.0];
        }
        let base = from_inertial(&acceleration, &rate, 1e-3, G);
        for (k, at) in
            motion_at_elevation_axis(&base, 1e-3, Traverse::default(), G, Level::Known).iter().enumerate()
        {
            // the attitude joins the rates by straight lines: it is off by h^2/12 times the change of their slope, 8e-7 rad at most, and gravity with it
            assert!((at.heave_m_s2 - acceleration[k][2]).abs() < 8e-6, "{k}: {at:?}");
            assert!((at.surge_m_s2 - acceleration[k][0]).abs() < 8e-6, "{k}: {at:?}");
            assert!((at.pitch_rate_rad_s + rate[k][1]).abs() < 1e-15 && at.roll_rate_rad_s == 0.0);
        }
    }

    #[test]
    fn a_traverse_of_a_quarter_turn_makes_roll_to_pitch_and_sway_to_surge() {
        let (mut acceleration, mut rate) = base_at_rest(3);
        acceleration.fill([0.0, 1.5, 0.0]);
        rate.fill([0.2, 0.0, 0.0]);
        let traverse = Traverse { angle_rad: FRAC_PI_2, rate_rad_s: 0.0 };
        let base = from_inertial(&acceleration, &rate, 1e-4, G);
        let at = motion_at_elevation_axis(&base, 1e-4, traverse, G, Level::Known)[0];
        assert!((at.pitch_rate_rad_s - 0.2).abs() < 1e-15 && (at.surge_m_s2 - 1.5).abs() < 1e-12, "{at:?}");
    }

    #[test]
    fn two_axes_that_point_forward_and_to_the_left_tell_the_whole_motion_of_the_base() {
        let at = |t: f64| BaseState {
            specific_force_m_s2: [2.0 * (5.0 * t).sin(), (3.0 * t).cos(), G + (7.0 * t).sin()],
            rate_rad_s: [0.3 * (2.0 * t).cos(), -0.8 * (6.0 * t).cos(), 0.5 * (4.0 * t).sin()],
        };
        let base: Vec<BaseState> = (0..2000).map(|k| at(1e-3 * f64::from(k))).collect();
        let felt = |angle_rad| {
            let traverse = Traverse { angle_rad, rate_rad_s: 0.0 };
            motion_at_elevation_axis(&base, 1e-3, traverse, G, Level::Known)
        };
        let found = base_of_felt(&felt(0.0), Some(&felt(FRAC_PI_2)), 1e-3, G);
        for (a, b) in found.iter().zip(&base) {
            for axis in 0..3 {
                assert!((a.specific_force_m_s2[axis] - b.specific_force_m_s2[axis]).abs() < 1e-12);
                assert!((a.rate_rad_s[axis] - b.rate_rad_s[axis]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_rolled_base_feels_less_of_gravity() {
        let (acceleration, mut rate) = base_at_rest(1001);
        rate.fill([0.5, 0.0, 0.0]);
        let base = from_inertial(&acceleration, &rate, 1e-3, G);
        let at = motion_at_elevation_axis(&base, 1e-3, Traverse::default(), G, Level::Known)[1000];
        assert!((at.heave_m_s2 - G * (0.5f64.cos() - 1.0)).abs() < 1e-9, "{at:?}");
    }

    #[test]
    fn a_unit_at_a_distance_reads_the_pivot_s_motion_after_its_lever_arm_is_taken_out() {
        // a base that turns about the pivot: the pivot itself feels gravity alone
        let (period_s, arm) = (1e-3, Vector3::new(0.4, -0.3, 0.7));
        let rate = |t: f64| Vector3::new(0.3 * t.sin(), 0.9 * (2.0 * t).cos(), -0.4 * t.cos());
        let slope = |t: f64| Vector3::new(0.3 * t.cos(), -1.8 * (2.0 * t).sin(), 0.4 * t.sin());
        let times = (0..500).map(|k| period_s * k as f64);
        let unit: Vec<BaseState> = times
            .map(|t| {
                let (w, a) = (rate(t), slope(t));
                let force = Vector3::new(0.0, 0.0, G) - a.cross(&arm) - w.cross(&w.cross(&arm));
                BaseState { specific_force_m_s2: force.into(), rate_rad_s: w.into() }
            })
            .collect();
        let found = Mounting::new([0.0; 3], arm.into()).at_pivot(&unit, period_s);
        for state in &found[1..499] {
            let off = Vector3::from(state.specific_force_m_s2) - Vector3::new(0.0, 0.0, G);
            assert!(off.norm() < 1e-5, "{state:?}");
        }
    }
}
