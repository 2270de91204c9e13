//! A proof by passivity: stable whatever the friction at the joints, as long as it only takes energy.
//!
//! Dry friction takes energy out of the motion whatever its law and level (Dahl's and LuGre's included: P.-A. Bliman 1992,
//! N. Barahanov and R. Ortega 2000). If the rest of the loop, from torques at the joints to their rates, is strictly positive real,
//! the whole is stable for every such friction (C. Desoer and M. Vidyasagar, *Feedback Systems*, 1975, ch. VI):
//!
//! ```text
//!     H(jw) + H(jw)^* > 0 at all w,     H: (torque at the motor, torque at the pivot) -> (motor rate, pivot rate)
//! ```
//!
//! The sampled loop is taken at one tone at a time; what a torque sends round through the aliases of that tone, which hold and plant
//! weaken, is left out. It does not apply to friction observers in the loop, which give energy, nor to a gap that opens.

use counterpoise_lti::CMat;

use super::Subject;
use super::elements::{ObserverGain, quasi_linear};
use super::regime::{Teeth, grid_rad_s, teeth};
use crate::Error;
use crate::structured::closing::{GainErrors, outermost_pole};
use crate::structured::factor::Factor;
use crate::structured::loops::{Uncertain, UncertainLoop};
use crate::structured::places::{Dry, Place, without_dry};
use crate::tolerance::PASSIVITY_SCALINGS;

/// How much energy the rest of the loop takes, relative to what it passes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passivity {
    /// Least eigenvalue of H + H^* over twice the largest singular value of H, over all frequencies; above 0 the proof holds.
    pub least: f64,
    /// Frequency at which it is least, Hz.
    pub frequency_hz: f64,
}

impl Passivity {
    /// Returns whether the proof holds.
    pub fn holds(&self) -> bool {
        self.least > 0.0
    }
}

/// Tries the proof; `None` if it does not apply: with a friction observer that follows a measured rate, with a gap that can open, with
/// a structure that is not lumped, or if the loop without dry friction is not stable.
pub(super) fn prove(subject: &Subject<'_>) -> Result<Option<Passivity>, Error> {
    let parts = subject.controller.parts();
    let fed_back =
        parts.observers.iter().any(|observer| observer.rate != counterpoise_controller::Signal::Demand);
    let parameters = subject.case.plant.parameters();
    let point = &subject.procedure.operating_point;
    if fed_back || parameters.lumped.is_none() || teeth(subject.case, point)? == Teeth::CanOpen {
        return Ok(None);
    }
    let gains = vec![ObserverGain::default(); parts.observers.len()];
    let controller = quasi_linear(subject.controller, &gains)?;
    let rates = Dry { viscous: [-1.0; 2], springs: [0.0; 2] };
    let nominal = without_dry(parameters, [0.0; 2]);
    let whole = Factor { centre: 1.0, a: 1.0, b: 0.0 };
    let joint = |place| Uncertain { factor: whole, places: vec![place] };
    let joints = [joint(Place::MotorDry), joint(Place::PivotDry)];
    let pulled = UncertainLoop::new(&nominal, rates, &controller, point, &joints, [0.0; 2])?;
    let exact = GainErrors { at: [counterpoise_lti::C64::new(0.0, 0.0); 2], rate_rad_s: 1.0 };
    let still = Dry { viscous: [0.0; 2], springs: [0.0; 2] };
    if outermost_pole(&nominal, &still, &controller, point, &exact)?.norm() >= 1.0 {
        return Ok(None);
    }
    let frequencies = grid_rad_s(pulled.sample_period_s());
    let all = pulled.at(&frequencies)?;
    let scaled = |k: usize| {
        let ratio = parameters.gearbox.ratio;
        let power = 2.0 * k as f64 / (PASSIVITY_SCALINGS - 1) as f64 - 1.0;
        least(&all, &frequencies, 10f64.powf(power) / ratio)
    };
    Ok((0..PASSIVITY_SCALINGS).map(scaled).max_by(|a, b| a.least.total_cmp(&b.least)))
}

/// The least over all frequencies, the motor's torque and rate scaled so that their product stays.
fn least(all: &[CMat], frequencies: &[f64], scale: f64) -> Passivity {
    let at = |(H, rate): (&CMat, &f64)| {
        // by the similarity diag(scale, 1) H diag(1 / scale, 1) the product torque x rate of the motor stays
        let (a, d) = (H[(0, 0)], H[(1, 1)]);
        let (b, c) = (H[(0, 1)] * scale, H[(1, 0)] / scale);
        let (p, r) = (2.0 * a.re, 2.0 * d.re);
        let q = b + c.conj();
        let smallest = 0.5 * (p + r) - (0.25 * (p - r).powi(2) + q.norm_sqr()).sqrt();
        let size = (a.norm_sqr() + b.norm_sqr() + c.norm_sqr() + d.norm_sqr()).sqrt();
        Passivity {
            least: smallest / (2.0 * size.max(f64::MIN_POSITIVE)),
            frequency_hz: rate / std::f64::consts::TAU,
        }
    };
    let worst = all.iter().zip(frequencies).map(at).min_by(|a, b| a.least.total_cmp(&b.least));
    worst.unwrap_or(Passivity { least: f64::NEG_INFINITY, frequency_hz: 0.0 })
}
