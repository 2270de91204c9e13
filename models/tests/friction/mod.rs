//! The friction toolbox against closed forms and against figures computed independently at tight tolerance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod contact;
mod dahl;
mod holding;
mod laws;
mod lugre;
mod properties;
mod stick_slip;

use counterpoise_models::friction::FrictionModel;
use counterpoise_models::{Friction, FrictionLaw};

/// A model of a law with a static ratio that has fallen at a rate, without drag.
pub(crate) fn model(law: FrictionLaw, static_ratio: f64, stribeck_rate_rad_s: f64) -> FrictionModel {
    FrictionModel::new(&Friction {
        static_ratio,
        stribeck_rate_rad_s,
        ..Friction::with_viscous_part(law, 0.0)
    })
    .unwrap()
}

/// The LuGre set of Canudas de Wit et al. 1995, table 1.
pub(crate) fn lugre() -> FrictionModel {
    let law = FrictionLaw::Lugre {
        coulomb_nm: 1.0,
        bristle_stiffness_nm_rad: 1e5,
        bristle_damping_nm_s_rad: 1e5_f64.sqrt(),
    };
    let friction =
        Friction { static_ratio: 1.5, stribeck_rate_rad_s: 1e-3, ..Friction::with_viscous_part(law, 0.4) };
    FrictionModel::new(&friction).unwrap()
}

pub(crate) fn dahl(coulomb_nm: f64, rest_stiffness_nm_rad: f64, exponent: f64) -> FrictionModel {
    model(FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent }, 1.0, 1.0)
}

pub(crate) fn reset_integrator() -> FrictionModel {
    let law = FrictionLaw::ResetIntegrator { coulomb_nm: 1.0, deflection_rad: 1e-4, damping_nm_s_rad: 100.0 };
    model(law, 1.5, 1.0)
}

/// A unit mass [position, rate, friction states] under a force that depends on time and position.
pub(crate) struct Mass<'a> {
    pub(crate) friction: &'a FrictionModel,
    pub(crate) state: Vec<f64>,
    pub(crate) time_s: f64,
}

impl<'a> Mass<'a> {
    pub(crate) fn new(friction: &'a FrictionModel) -> Self {
        Self { friction, state: vec![0.0; 2 + friction.states()], time_s: 0.0 }
    }

    pub(crate) fn torque(&self) -> f64 {
        self.friction.torque(self.state[1], 1.0, &self.state[2..])
    }

    /// One Runge-Kutta step of fourth order.
    pub(crate) fn step(&mut self, h: f64, force: &impl Fn(f64, f64) -> f64) {
        let k1 = self.slope(self.time_s, &self.state, force);
        let k2 = self.slope(self.time_s + 0.5 * h, &self.state_after(&k1, 0.5 * h), force);
        let k3 = self.slope(self.time_s + 0.5 * h, &self.state_after(&k2, 0.5 * h), force);
        let k4 = self.slope(self.time_s + h, &self.state_after(&k3, h), force);
        for i in 0..self.state.len() {
            self.state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        self.friction.project(&mut self.state[2..]);
        self.time_s += h;
    }

    fn state_after(&self, slope: &[f64; 3], h: f64) -> [f64; 3] {
        std::array::from_fn(|i| self.state.get(i).map_or(0.0, |s| s + h * slope[i]))
    }

    fn slope(&self, time: f64, state: &[f64], force: &impl Fn(f64, f64) -> f64) -> [f64; 3] {
        let mut slope = [0.0; 3];
        let friction = self.friction.torque(state[1], 1.0, &state[2..]);
        self.friction.derivative(state[1], 1.0, &state[2..], &mut slope[2..]);
        slope[0] = state[1];
        slope[1] = force(time, state[0]) - friction;
        slope
    }
}

/// Asserts that a figure agrees with a reference to the reference's last printed digit.
pub(crate) fn assert_close(figure: f64, reference: f64, tolerance: f64) {
    assert!(
        (figure - reference).abs() <= tolerance,
        "{figure} differs from {reference} by more than {tolerance}"
    );
}
