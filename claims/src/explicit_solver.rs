//! One inertia on one law of friction by an explicit method: what a general solver pays for each law.

use counterpoise_models::friction::FrictionModel;
use counterpoise_models::{Friction, FrictionLaw};

use crate::tolerance::LEAST_STEP_ERROR;
use crate::tolerance::STEP_TOLERANCE;
use counterpoise_pipeline::PipelineError;

/// Least and most factor of a step's length, and what is left of the length that the error would allow.
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
const SAFETY: f64 = 0.9;
/// Order of the error estimate, plus one.
const ORDER: f64 = 5.0;
/// Dormand and Prince, *J. Comput. Appl. Math.* 6 (1980) 19: stages, the last of which is the answer of order 5.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const TIMES: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// Answer of order 5 less that of order 4.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// An inertia that a sine of torque moves on a law of friction.
pub struct SlidingInertia {
    model: FrictionModel,
    inertia_kg_m2: f64,
    torque_nm: f64,
    rate_rad_s: f64,
    size: [f64; 2],
}

impl SlidingInertia {
    /// Returns a machine that is moved at `hz` to and fro with a rate of about `amplitude_rad_s`, friction included.
    ///
    /// # Errors
    /// A law whose parameters are out of range.
    pub fn new(
        law: FrictionLaw,
        inertia_kg_m2: f64,
        hz: f64,
        amplitude_rad_s: f64,
    ) -> Result<Self, PipelineError> {
        let friction = Friction::with_viscous_part(law, 0.0);
        let coulomb = friction.coulomb_nm();
        let rate_rad_s = std::f64::consts::TAU * hz;
        let model = FrictionModel::new(&friction)?;
        let stiffness = model.rest_stiffness_nm_rad();
        // Dahl's state is a torque, a bristle's an angle
        let state =
            if matches!(friction.law, FrictionLaw::Dahl { .. }) { coulomb } else { coulomb / stiffness };
        Ok(Self {
            model,
            inertia_kg_m2,
            torque_nm: inertia_kg_m2 * rate_rad_s * amplitude_rad_s + coulomb,
            rate_rad_s,
            size: [amplitude_rad_s, state],
        })
    }

    fn slope(&self, time_s: f64, x: [f64; 2]) -> [f64; 2] {
        let (rate, state) = (self.size[0] * x[0], [self.size[1] * x[1]]);
        let mut slope = [0.0];
        self.model.derivative(rate, 1.0, &state, &mut slope);
        let torque = self.torque_nm * (self.rate_rad_s * time_s).sin() - self.model.torque(rate, 1.0, &state);
        [torque / (self.inertia_kg_m2 * self.size[0]), slope[0] / self.size[1]]
    }

    /// Returns the evaluations of the equations that an explicit method of order 5 with its own steps takes.
    pub fn evaluations(&self, duration_s: f64) -> usize {
        let (mut time, mut x, mut step, mut count) = (0.0, [0.0; 2], 1e-4, 0);
        while time < duration_s {
            step = f64::min(step, duration_s - time);
            let (next, error) = self.try_step(time, x, step);
            count += STAGES.len();
            if error <= 1.0 {
                (time, x) = (time + step, next);
                let mut state = [self.size[1] * x[1]];
                self.model.project(&mut state);
                x[1] = state[0] / self.size[1];
            }
            let wanted = SAFETY * error.max(LEAST_STEP_ERROR).powf(-1.0 / ORDER);
            step *= wanted.clamp(SHRINK, GROW);
        }
        count
    }

    /// Returns the state after a step, and its error over the tolerance.
    fn try_step(&self, time: f64, x: [f64; 2], step: f64) -> ([f64; 2], f64) {
        let mut k = [[0.0; 2]; 7];
        k[0] = self.slope(time, x);
        let mut at = x;
        for (stage, weights) in STAGES.iter().enumerate() {
            at = x;
            for (weight, slope) in weights.iter().zip(&k) {
                at = [at[0] + step * weight * slope[0], at[1] + step * weight * slope[1]];
            }
            k[stage + 1] = self.slope(time + TIMES[stage] * step, at);
        }
        let off = |i: usize| {
            let sum: f64 = ERROR.iter().zip(&k).map(|(e, slope)| e * slope[i]).sum();
            (step * sum / (STEP_TOLERANCE * (1.0 + x[i].abs().max(at[i].abs())))).powi(2)
        };
        (at, (0.5 * (off(0) + off(1))).sqrt())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Without friction the rate is A (1 - cos w t): after whole cycles nothing is left.
    #[test]
    fn without_friction_the_inertia_comes_back_to_rest() {
        let sliding = SlidingInertia {
            model: FrictionModel::new(&Friction::with_viscous_part(FrictionLaw::None, 0.0)).unwrap(),
            inertia_kg_m2: 2.0,
            torque_nm: 3.0,
            rate_rad_s: std::f64::consts::TAU,
            size: [1.0, 1.0],
        };
        let (mut x, steps) = ([0.0; 2], 200);
        for k in 0..steps {
            x = sliding.try_step(f64::from(k) / f64::from(steps), x, 1.0 / f64::from(steps)).0;
        }
        assert!(x[0].abs() < 1e-10, "{x:?}");
        let half = (0..100).fold([0.0; 2], |x, k| sliding.try_step(f64::from(k) / 200.0, x, 1.0 / 200.0).0);
        assert!((half[0] - 2.0 * 1.5 / std::f64::consts::TAU).abs() < 1e-10, "{half:?}");
    }
}
