//! The friction toolbox: laws of dry friction with their parameters checked, evaluated without allocation.
//!
//! In comes [`crate::parameters::Friction`]; out goes a [`FrictionModel`] that gives torque, state derivative, exact
//! advance at constant rate, partial derivatives, steady curve and, for laws that truly stick, the breakaway levels.
//! Rates are those of the first body relative to the second, and a positive torque opposes a positive rate.
//!
//! | law | state | holds a constant torque at rest | paper |
//! |---|---|---|---|
//! | Coulomb, stiction | none | yes, by stick | Coulomb 1785; Morin 1833 |
//! | Tustin, exponential, Gaussian | none | yes, by stick | Tustin 1947; Bo and Pavelescu 1982 |
//! | Lorentzian, polynomial | none | yes, by stick | Hess and Soom 1990; Armstrong-Helouvry 1991 |
//! | Karnopp | none | yes, by stick | Karnopp 1985 |
//! | Dahl | torque | yes, after an elastic deflection | Dahl 1968, 1976 |
//! | Walrath | torque | no: it creeps | Walrath 1984 |
//! | bristle | deflection and count of each | yes, after an elastic deflection | Haessig and Friedland 1991 |
//! | reset integrator | deflection | yes, after an elastic deflection | Haessig and Friedland 1991 |
//! | LuGre | deflection | yes, but drifts under dither | Canudas de Wit et al. 1995 |
//!
//! *Invariant*: nothing here knows an inertia or marches a mechanism in time.
//!
//! Modules in reading order: [`ranges`], [`properties`], [`real`], [`stribeck`], [`partials`], [`sliding`], [`dahl`], [`lugre`], [`reset`], [`walrath`], [`bristle`],
//! [`law`], [`model`], [`dry_friction`], [`mod@contact`], [`describing_function`].
//!
//! ```
//! use counterpoise_models::{Friction, FrictionLaw, friction::FrictionModel};
//! let law = FrictionLaw::Dahl { coulomb_nm: 2.0, rest_stiffness_nm_rad: 1e3, exponent: 1.0 };
//! let model = FrictionModel::new(&Friction::with_viscous_part(law, 0.5))?;
//! let mut torque = [0.0];
//! model.advance(0.1, 1.0, 1.0, &mut torque); // 0.1 rad at 0.1 rad/s
//! assert!((model.torque(0.1, 1.0, &torque) - model.steady_torque(0.1)).abs() < 1e-12);
//! # Ok::<(), counterpoise_models::Error>(())
//! ```

pub mod bristle;
mod build;
pub mod contact;
pub mod dahl;
pub mod describing_function;
pub mod dry_friction;
pub mod law;
pub mod lugre;
pub mod model;
pub mod partials;
pub mod properties;
pub mod ranges;
pub mod real;
pub mod reset;
pub mod sliding;
pub mod stribeck;
pub mod walrath;

pub use bristle::Bristle;
pub use contact::{Contact, Joint, contact_torques};
pub use dahl::Dahl;
pub use dry_friction::{DryFriction, SmoothLaw};
pub use law::Law;
pub use lugre::Lugre;
pub use model::{FrictionConditions, FrictionModel};
pub use partials::Partials;
pub use properties::Similarity;
pub use real::Real;
pub use reset::ResetIntegrator;
pub use sliding::{Sliding, Stick};
pub use stribeck::StribeckLevel;
pub use walrath::Walrath;
