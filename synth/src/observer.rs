//! Cancelling dry friction by a nonlinear observer: identified levels in, observers for the controller out.

use counterpoise_controller::{FrictionObserver, ObserverLaw, PathSignal};

use crate::Error;

/// Side of the gear on which a friction acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionSide {
    /// At the motor shaft: levels are torques there, per angle of the shaft.
    Motor,
    /// At the load: levels are torques at the hub.
    Load,
}

/// A friction as it was identified.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedFriction {
    /// A lower-case identifier.
    pub name: String,
    /// Side of the gear on which it acts.
    pub side: FrictionSide,
    /// Law, with rates and damping of the side where it acts.
    pub law: ObserverLaw,
    /// Coulomb level, N m.
    pub coulomb_nm: f64,
    /// Rest stiffness, N m/rad; laws that slide alone do not use it.
    pub rest_stiffness_nm_rad: f64,
    /// The level over the Coulomb level by the speed, (rad/s, 1); empty for a constant level.
    pub level: Vec<[f64; 2]>,
    /// Viscous coefficient, N m s/rad; 0 leaves the viscous part to the linear design, which knows it.
    pub viscous_nm_s_rad: f64,
}

/// Gain and dynamics of the drive from volts to torque at the hub.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Motor turns per hub turn.
    pub ratio: f64,
    /// Torque at the stalled hub for one volt, N m/V.
    pub stall_nm_v: f64,
}

/// Signal that drives the observer's friction state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drives {
    /// The measured rate of the hub relative to the platform: feedback.
    MeasuredRate,
    /// The demanded rate: feedforward, which noise and backlash cannot excite.
    Demand,
}

/// Returns one observer for each friction, in torque at the hub: a motor's level counts `ratio` times, its stiffness ratio^2
/// times (the gear taken as rigid: its wind-up is small against presliding at the motor).
///
/// `share` is the part that is cancelled, 0 to 1: what is cancelled beyond what is there makes the loop hunt.
///
/// # Errors
/// [`Error::Range`] for a share outside 0 to 1, a drive without torque, or levels that are not positive.
pub fn friction_observers(
    frictions: &[ObservedFriction],
    drive: Drive,
    drives: Drives,
    share: f64,
) -> Result<Vec<FrictionObserver>, Error> {
    require("share", share, "from 0 to 1", |share| (0.0..=1.0).contains(&share))?;
    require("gear ratio", drive.ratio, "positive", |ratio| ratio > 0.0)?;
    require("stall torque a volt", drive.stall_nm_v, "not zero", |torque| torque != 0.0)?;
    frictions.iter().map(|friction| observer(friction, drive, drives, share)).collect()
}

fn observer(
    friction: &ObservedFriction,
    drive: Drive,
    drives: Drives,
    share: f64,
) -> Result<FrictionObserver, Error> {
    let (level, stiffness) = (friction.coulomb_nm, friction.rest_stiffness_nm_rad);
    require("Coulomb level in N m", level, "positive", |level| level > 0.0)?;
    let slides = matches!(friction.law, ObserverLaw::Sliding { .. } | ObserverLaw::Walrath { .. });
    require("rest stiffness in N m/rad", stiffness, "positive", |stiffness| stiffness > 0.0 || slides)?;
    let turns = match friction.side {
        FrictionSide::Motor => drive.ratio,
        FrictionSide::Load => 1.0,
    };
    let volts = share / drive.stall_nm_v;
    Ok(FrictionObserver {
        name: friction.name.clone(),
        rate: match drives {
            Drives::MeasuredRate => PathSignal::RelativeRate,
            Drives::Demand => PathSignal::Demand,
        },
        law: at_the_hub(&friction.law, turns),
        coulomb_nm: level * turns,
        rest_stiffness_nm_rad: stiffness * turns * turns,
        level: friction.level.iter().map(|[speed, level]| [speed / turns, *level]).collect(),
        volts_per_nm: volts,
        viscous_v_s_rad: volts * friction.viscous_nm_s_rad * turns * turns,
    })
}

/// A law of a side that turns so many times as fast, by the hub's rate and in torque at the hub.
fn at_the_hub(law: &ObserverLaw, turns: f64) -> ObserverLaw {
    let mut law = law.clone();
    match &mut law {
        ObserverLaw::Dahl | ObserverLaw::DahlPower { .. } => {}
        ObserverLaw::Lugre { damping_nm_s_rad } | ObserverLaw::ResetIntegrator { damping_nm_s_rad, .. } => {
            *damping_nm_s_rad *= turns * turns;
        }
        ObserverLaw::Sliding { sign_rate_rad_s } | ObserverLaw::Walrath { sign_rate_rad_s, .. } => {
            *sign_rate_rad_s /= turns;
        }
    }
    law
}

fn require(
    what: &'static str,
    value: f64,
    allowed: &'static str,
    is_allowed: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    if is_allowed(value) && value.is_finite() { Ok(()) } else { Err(Error::Range { what, value, allowed }) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_controller::{Controller, Parts, Readings, SampledController};

    fn identified_friction(side: FrictionSide) -> ObservedFriction {
        ObservedFriction {
            name: "dry".into(),
            side,
            law: ObserverLaw::Dahl,
            coulomb_nm: 0.065,
            rest_stiffness_nm_rad: 1.3,
            level: Vec::new(),
            viscous_nm_s_rad: 0.0,
        }
    }

    #[test]
    fn a_sliding_motor_is_given_the_volts_that_its_friction_takes() {
        let drive = Drive { ratio: 200.0, stall_nm_v: 516.0 };
        let observers =
            friction_observers(&[identified_friction(FrictionSide::Motor)], drive, Drives::MeasuredRate, 1.0)
                .unwrap();
        let mut parts = Parts::new(1e-3, 10.0);
        parts.observers = observers;
        let mut runner = Controller::new(parts).unwrap().runner();
        let sliding = Readings { hub_rate_rad_s: 0.2, platform_rate_rad_s: -0.1, ..Readings::default() };
        let last = (0..4000).map(|_| runner.step(&sliding)).last().unwrap();
        assert!((last - 200.0 * 0.065 / 516.0).abs() < 1e-6, "{last}");
        let back = Readings { hub_rate_rad_s: -0.2, platform_rate_rad_s: 0.1, ..Readings::default() };
        let last = (0..4000).map(|_| runner.step(&back)).last().unwrap();
        assert!((last + 200.0 * 0.065 / 516.0).abs() < 1e-6, "{last}");
    }

    #[test]
    fn what_is_not_a_share_or_a_level_is_refused() {
        let drive = Drive { ratio: 200.0, stall_nm_v: 516.0 };
        let try_share = |share| {
            friction_observers(&[identified_friction(FrictionSide::Load)], drive, Drives::Demand, share)
        };
        assert!(try_share(1.2).is_err() && try_share(f64::NAN).is_err() && try_share(0.8).is_ok());
        let none = ObservedFriction { coulomb_nm: 0.0, ..identified_friction(FrictionSide::Load) };
        assert!(friction_observers(&[none], drive, Drives::Demand, 0.8).is_err());
    }
}
