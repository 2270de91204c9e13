//! The friction observers of a step.

use crate::lowering::{Limits, States, Writer, curve};
use crate::program::{OnRestart, Slot};
use crate::tolerance::{BREAKS_FROM, FARTHEST, POWER_POINTS, TANH_AT};
use crate::{FrictionObserver, ObserverLaw};

/// The parts of an observer's step.
struct Step<'a> {
    observer: &'a FrictionObserver,
    rate: Slot,
    /// Torque gained in a sample per rad/s of rate: sigma T.
    grip: f64,
}

/// The torque of a damped bond, N m: before and after its step, and that which acts.
struct Bond {
    before: Slot,
    after: Slot,
    torque: Slot,
}

/// Writes the observer's step; returns its volts.
pub(crate) fn observe(
    observer: &FrictionObserver,
    rate: Slot,
    period_s: f64,
    states: &mut States,
    writer: &mut Writer,
) -> Slot {
    writer.section(format!("friction observer {}: {}", observer.name, observer.law.says()));
    let step = Step { observer, rate, grip: observer.rest_stiffness_nm_rad * period_s };
    let torque = match &observer.law {
        ObserverLaw::Dahl => step.dahl(states, writer).1,
        ObserverLaw::DahlPower { exponent } => step.power(*exponent, states, writer),
        ObserverLaw::Lugre { damping_nm_s_rad } => {
            let (before, after) = step.dahl(states, writer);
            step.write_damped_torque(
                *damping_nm_s_rad / step.grip,
                &Bond { before, after, torque: after },
                writer,
            )
        }
        ObserverLaw::ResetIntegrator { static_ratio, damping_nm_s_rad } => {
            step.bond(*static_ratio, *damping_nm_s_rad, states, writer)
        }
        ObserverLaw::Sliding { sign_rate_rad_s } => step.sliding(*sign_rate_rad_s, writer),
        ObserverLaw::Walrath { sign_rate_rad_s, time_constant_s } => {
            step.walrath(*sign_rate_rad_s, period_s / time_constant_s, states, writer)
        }
    };
    let terms = [observer.volts_per_nm * torque, observer.viscous_v_s_rad * rate];
    writer.sum(step.signal_name("v"), &terms)
}

impl ObserverLaw {
    /// Returns the law in words, for the reader of target code.
    pub fn says(&self) -> &'static str {
        match self {
            ObserverLaw::Dahl => "Dahl, implicit step",
            ObserverLaw::DahlPower { .. } => "Dahl with an exponent, bounded step",
            ObserverLaw::Lugre { .. } => "LuGre, implicit step",
            ObserverLaw::ResetIntegrator { .. } => "reset integrator",
            ObserverLaw::Sliding { .. } => "sliding level with a softened sign",
            ObserverLaw::Walrath { .. } => "Walrath, implicit step",
        }
    }
}

impl Step<'_> {
    fn signal_name(&self, what: &str) -> String {
        format!("{}_{what}", self.observer.name)
    }

    fn state(&self, states: &mut States) -> Slot {
        states.scalar(&self.signal_name("nm"), 0.0, OnRestart::Restart)
    }

    /// Writes the level over F_c; `None` if it is constant.
    fn level(&self, speed: Slot, writer: &mut Writer) -> Option<Slot> {
        let points = &self.observer.level;
        (!points.is_empty()).then(|| curve::level(writer, &self.signal_name("level"), speed, points))
    }

    /// Writes Dahl's implicit step; returns a copy of the torque before it, and the state after.
    fn dahl(&self, states: &mut States, writer: &mut Writer) -> (Slot, Slot) {
        let force = self.state(states);
        let before = writer.sum(self.signal_name("before_nm"), &[1.0 * force]);
        let speed = writer.magnitude(self.signal_name("speed_rad_s"), self.rate);
        let above = writer.sum(self.signal_name("above_nm"), &[1.0 * force, self.grip * self.rate]);
        let yields = match self.level(speed, writer) {
            Some(level) => writer.quotient(self.signal_name("yields_rad_s"), speed, level),
            None => speed,
        };
        let below = writer.local(self.signal_name("below"));
        writer.sum_into(below, Some(1.0), &[self.grip / self.observer.coulomb_nm * yields]);
        let next = writer.quotient(self.signal_name("next_nm"), above, below);
        writer.copy(force, next);
        (before, force)
    }

    /// torque + damping x (after - before).
    fn write_damped_torque(&self, damping: f64, bond: &Bond, writer: &mut Writer) -> Slot {
        let change = writer.sum(self.signal_name("change_nm"), &[1.0 * bond.after, -1.0 * bond.before]);
        writer.sum(self.signal_name("torque_nm"), &[1.0 * bond.torque, damping * change])
    }

    /// Dahl with an exponent. With the rate split by its sign, each part has its own distance from yielding.
    fn power(&self, exponent: f64, states: &mut States, writer: &mut Writer) -> Slot {
        let force = self.state(states);
        let speed = writer.magnitude(self.signal_name("speed_rad_s"), self.rate);
        let level = self.level(speed, writer);
        let level_nm = writer.local(self.signal_name("level_nm"));
        let (constant, share) = match level {
            Some(level) => (None, vec![self.observer.coulomb_nm * level]),
            None => (Some(self.observer.coulomb_nm), Vec::new()),
        };
        writer.sum_into(level_nm, constant, &share);
        let drawn = writer.quotient(self.signal_name("drawn"), force, level_nm);
        let forth = writer.sum(self.signal_name("forth_rad_s"), &[0.5 * speed, 0.5 * self.rate]);
        let back = writer.sum(self.signal_name("back_rad_s"), &[0.5 * speed, -0.5 * self.rate]);
        let yielding = [("forth", -1.0, forth), ("back", 1.0, back)].map(|(way, sign, rate)| {
            let distance = writer.local(self.signal_name(&format!("{way}_distance")));
            writer.sum_into(distance, Some(1.0), &[sign * drawn]);
            let y =
                curve::level(writer, &self.signal_name(&format!("{way}_power")), distance, &power(exponent));
            writer.product(self.signal_name(&format!("{way}_slip_rad_s")), rate, y)
        });
        let gained = self.grip / self.observer.coulomb_nm;
        let mut ratio =
            writer.sum(self.signal_name("gain_rad_s"), &[gained * yielding[0], -gained * yielding[1]]);
        if let Some(level) = level {
            ratio = writer.quotient(self.signal_name("gain"), ratio, level);
        }
        let free = writer.sum(self.signal_name("free"), &[1.0 * drawn, 1.0 * ratio]);
        let held = writer.clamp(self.signal_name("held"), free, Limits::symmetric(1.0));
        let next = writer.product(self.signal_name("next_nm"), held, level_nm);
        writer.copy(force, next);
        force
    }

    fn bond(&self, static_ratio: f64, damping: f64, states: &mut States, writer: &mut Writer) -> Slot {
        let bond = self.state(states);
        let limit = self.observer.coulomb_nm;
        let before = writer.sum(self.signal_name("before_nm"), &[1.0 * bond]);
        let free = writer.sum(self.signal_name("free_nm"), &[1.0 * bond, self.grip * self.rate]);
        let held = writer.clamp(self.signal_name("held_nm"), free, Limits::symmetric(limit));
        writer.copy(bond, held);
        let size = writer.magnitude(self.signal_name("size_nm"), bond);
        let factor = [[BREAKS_FROM * limit, static_ratio], [limit, 1.0]];
        let factor = curve::level(writer, &self.signal_name("factor"), size, &factor);
        let torque = writer.product(self.signal_name("bond_nm"), bond, factor);
        self.write_damped_torque(damping / self.grip, &Bond { before, after: bond, torque }, writer)
    }

    fn sliding(&self, sign_rate: f64, writer: &mut Writer) -> Slot {
        let soft = writer.clamp(self.signal_name("soft_rad_s"), self.rate, Limits::symmetric(sign_rate));
        let unit = writer.sum(self.signal_name("unit_nm"), &[self.observer.coulomb_nm / sign_rate * soft]);
        let speed = writer.magnitude(self.signal_name("speed_rad_s"), self.rate);
        match self.level(speed, writer) {
            Some(level) => writer.product(self.signal_name("torque_nm"), unit, level),
            None => unit,
        }
    }

    fn walrath(&self, sign_rate: f64, lags: f64, states: &mut States, writer: &mut Writer) -> Slot {
        let force = self.state(states);
        let points = TANH_AT.map(|x| [x * sign_rate, x.tanh()]);
        let sign = curve::write_odd_curve(writer, &self.signal_name("sign"), self.rate, &points);
        let keep = 1.0 / (1.0 + lags);
        let share = lags * keep * self.observer.coulomb_nm;
        let next = writer.sum(self.signal_name("next_nm"), &[keep * force, share * sign]);
        writer.copy(force, next);
        force
    }
}

/// Returns the points of r^i from 0 to the farthest distance, closer where the curve bends.
fn power(exponent: f64) -> Vec<[f64; 2]> {
    let bend = if exponent < 1.0 { 2.0 } else { 1.0 };
    (0..=POWER_POINTS)
        .map(|k| FARTHEST * (f64::from(k) / f64::from(POWER_POINTS)).powf(bend))
        .map(|r| [r, r.powf(exponent)])
        .collect()
}
