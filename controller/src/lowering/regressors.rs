//! The regressors by which an estimator of the out-of-balance explains the control.

use crate::lowering::Writer;
use crate::lowering::schedule::Layout;
use crate::program::{ProgramTerm, Slot};
use crate::{Estimator, Parts, PathSignal};

/// The inputs of an estimator in a sample.
pub(crate) struct EstimatorInputs<'a> {
    /// The parts that it belongs to.
    pub parts: &'a Parts,
    /// States of the out-of-balance.
    pub layout: &'a Layout,
    /// Slot of a signal.
    pub signal: &'a dyn Fn(PathSignal) -> Slot,
    /// The limited control, in volts of a linear drive.
    pub control: Slot,
}

/// Writes the terms of g (cos(theta) - 1): the cosine by its series, whose error is below 2e-5 up to 1 rad.
pub(super) fn write_gravity_change(
    inputs: &EstimatorInputs<'_>,
    estimator: &Estimator,
    writer: &mut Writer,
) -> Vec<ProgramTerm> {
    let g = estimator.gravity_m_s2;
    if g == 0.0 {
        return Vec::new();
    }
    let angle = (inputs.signal)(PathSignal::HubPosition);
    let square = writer.product("angle_square", angle, angle);
    let fourth = writer.product("angle_fourth", square, square);
    let sixth = writer.product("angle_sixth", square, fourth);
    vec![-g / 2.0 * square, g / 24.0 * fourth, -g / 720.0 * sixth]
}

/// Writes g cos(theta) + a_p.
fn lift(inputs: &EstimatorInputs<'_>, estimator: &Estimator, writer: &mut Writer) -> Slot {
    let lift = writer.local("lift_m_s2");
    let heave = (inputs.signal)(PathSignal::PlatformAcceleration);
    let terms: Vec<ProgramTerm> =
        std::iter::once(1.0 * heave).chain(write_gravity_change(inputs, estimator, writer)).collect();
    writer.sum_into(lift, Some(estimator.gravity_m_s2), &terms);
    lift
}

/// Writes the regressors of the control: gravity and heave along the beam, the direction of motion, the rate.
pub(crate) fn regressors(
    inputs: &EstimatorInputs<'_>,
    estimator: &Estimator,
    writer: &mut Writer,
) -> [Slot; 3] {
    let lift = lift(inputs, estimator, writer);
    let rate = (inputs.signal)(estimator.rate);
    let speed = writer.magnitude("estimator_speed_rad_s", rate);
    let softened = writer.local("softened_speed_rad_s");
    writer.sum_into(softened, Some(estimator.half_rate_rad_s), &[1.0 * speed]);
    [lift, writer.quotient("direction", rate, softened), rate]
}

/// Writes the control less what the regressors explain of it.
pub(crate) fn write_unexplained(control: Slot, p: &[Slot], phi: &[Slot], writer: &mut Writer) -> Slot {
    let mut terms = vec![1.0 * control];
    for (i, (p, phi)) in p.iter().zip(phi).enumerate() {
        terms.push(-1.0 * writer.product(format!("explained_{i}_v"), *p, *phi));
    }
    writer.sum("unexplained_v", &terms)
}
