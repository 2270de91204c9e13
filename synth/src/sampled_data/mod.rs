//! The three-part design in sampled time: what [`crate::design_feedback()`] and [`crate::design_feedforward()`] do for signals that flow,
//! done for a control that is held over each period and readings that are taken once in it.
//!
//! The plant, its sensors and its disturbances stay continuous: their cost is that of the whole period, between the
//! samples too (Van Loan). The delay is that of the loop as it runs, in whole samples, exactly. The weights are asked of
//! the samples: a control weight and the states of an error weight are filters inside the controller, which cost by their
//! modulus; the bilinear map keeps that modulus. The direct part of an error weight, constant weights on further outputs
//! and the whole error weight of a feedforward act on the continuous motion.
//!
//! A reading carries the noise of the continuous design averaged over the period: density over period.

mod feedback;
mod feedforward;
mod held_plant;
mod rows;

use counterpoise_lti::StateSpace;

use crate::certificate::PartCertificates;

pub(crate) use feedback::feedback;
pub(crate) use feedforward::feedforward;

/// A part of the controller in sampled time.
pub(crate) struct DraftedPart {
    /// Feedback: from (demand, rate) to the control. Feedforward: from the measured disturbance to (control, hub rate that
    /// is expected of the sensor).
    pub system: StateSpace,
    /// Certificates.
    pub certified: PartCertificates,
}
