//! The level of the friction that is learnt while the friction slides.

use crate::LevelLearning;
use crate::lowering::{Limits, States, Writer};
use crate::program::{OnRestart, ProgramTerm, Slot};
use crate::tolerance::MOST_LEARNT;

/// States of the learning.
pub(super) const LEVEL: &str = "friction_level";
pub(super) const SLOPE: &str = "friction_slope";
pub(super) const OFFSET: &str = "friction_offset";

/// The level in a step.
pub(super) struct LearntLevel {
    learning: LevelLearning,
    level: Slot,
    slope: Slot,
    offset: Slot,
    /// The sum of the observers' volts.
    whole: Slot,
    /// The volts of the friction at its level.
    levelled: Slot,
    /// The volts that act.
    pub cancelled: Slot,
}

impl LearntLevel {
    /// Writes the volts that act.
    pub fn write_volts(
        learning: LevelLearning,
        observed: &[Slot],
        states: &mut States,
        writer: &mut Writer,
    ) -> Self {
        writer.section("friction at its learnt level");
        let level = states.scalar(LEVEL, learning.lowest, OnRestart::Restart);
        let slope = states.scalar(SLOPE, 0.0, OnRestart::Restart);
        let offset = states.scalar(OFFSET, 0.0, OnRestart::Restart);
        let all: Vec<ProgramTerm> = observed.iter().map(|volts| 1.0 * *volts).collect();
        let whole = writer.sum("friction_v", &all);
        let levelled = writer.product("friction_at_level_v", level, whole);
        let cancelled = writer.sum("cancelled_v", &[learning.cancelled * levelled]);
        Self { learning, level, slope, offset, whole, levelled, cancelled }
    }

    /// Writes the learning from what the feedback paths give.
    pub fn write_learning(&self, feedback: &[Slot], rate: Slot, period_s: f64, writer: &mut Writer) {
        let LevelLearning {
            lowest,
            highest,
            cancelled,
            gain_per_s,
            volts,
            sliding_rate_rad_s,
            rate_scale_rad_s,
        } = self.learning;
        writer.section("learning of the level from the feedback, while the friction slides");
        let speed = writer.magnitude("friction_speed_rad_s", rate);
        let beyond = writer.local("friction_beyond");
        writer.sum_into(beyond, Some(-1.0), &[1.0 / sliding_rate_rad_s * speed]);
        let slides = writer.clamp("friction_slides", beyond, Limits::UNIT);
        let phi = writer.sum("friction_phi", &[1.0 / volts * self.whole]);
        let rho = writer.sum("friction_rho", &[1.0 / rate_scale_rad_s * rate]);
        let drawn = writer.product("friction_drawn", self.slope, rho);
        let mut left: Vec<ProgramTerm> = feedback.iter().map(|output| 1.0 / volts * *output).collect();
        left.extend([-(1.0 - cancelled) / volts * self.levelled, -1.0 * drawn, -1.0 * self.offset]);
        let left = writer.sum("friction_left", &left);
        let bounded = writer.clamp("friction_left_bounded", left, Limits::symmetric(1.0));
        let told = writer.product("friction_told", bounded, slides);
        let square = writer.product("friction_rho_square", rho, rho);
        let size = writer.local("friction_size");
        writer.sum_into(size, Some(1.0), &[1.0 * square]);
        let push = writer.quotient("friction_push", told, size);
        let step = gain_per_s * period_s;
        let range = Limits { low: lowest, high: highest };
        self.follow(Learnt { state: self.level, name: LEVEL, range, by: Some(phi) }, push, step, writer);
        let range = Limits::symmetric(MOST_LEARNT);
        self.follow(Learnt { state: self.slope, name: SLOPE, range, by: Some(rho) }, push, step, writer);
        self.follow(Learnt { state: self.offset, name: OFFSET, range, by: None }, push, step, writer);
    }

    fn follow(&self, learnt: Learnt, push: Slot, step: f64, writer: &mut Writer) {
        let Learnt { state, name, range, by } = learnt;
        let along = by.map_or(push, |by| writer.product(format!("{name}_along"), push, by));
        let free = writer.sum(format!("{name}_free"), &[1.0 * state, step * along]);
        let next = writer.clamp(format!("{name}_next"), free, range);
        writer.copy(state, next);
    }
}

/// A state that is learnt.
struct Learnt {
    state: Slot,
    name: &'static str,
    range: Limits,
    /// The regressor; `None` for 1.
    by: Option<Slot>,
}
