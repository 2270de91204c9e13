//! One parameter at a time, and the ways to load the mechanism.

use counterpoise_controller::Controller;
use counterpoise_models::parameters::Parameters;
use counterpoise_models::plant::Plant;

use super::{VariedParameter, figures_of};
use crate::measure::Value;
use crate::{Error, PerformanceFigure, Procedure};

/// A parameter that varies alone, and its factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Family {
    /// The parameter.
    pub parameter: VariedParameter,
    /// Factors.
    pub factors: Vec<f64>,
}

/// Difference of a mechanism from the nominal one.
#[derive(Debug, Clone, PartialEq)]
pub enum MemberDifference {
    /// One parameter is multiplied by a factor.
    Scaled {
        /// The parameter.
        parameter: VariedParameter,
        /// Factor.
        factor: f64,
    },
    /// It is in the configuration of this name.
    Configuration(String),
}

/// One mechanism of a family, and its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyMember {
    /// Difference from the nominal mechanism.
    pub difference: MemberDifference,
    /// The figures, in the order asked for.
    pub values: Vec<Value>,
}

/// Returns the figures with each parameter in turn at each factor.
///
/// # Errors
/// As [`figures_of`], and factors that make no mechanism.
pub fn one_at_a_time(
    nominal: &Parameters,
    controller: &Controller,
    procedure: &Procedure,
    figures: &[PerformanceFigure],
    families: &[Family],
) -> Result<Vec<FamilyMember>, Error> {
    let mut members = Vec::new();
    for Family { parameter: varied, factors } in families {
        for &factor in factors {
            let mut parameters = nominal.clone();
            varied.scale(&mut parameters, factor)?;
            let controller = varied.scaled_controller(controller, factor)?;
            let values = figures_of(&Plant::from_lumped(&parameters)?, &controller, procedure, figures)?;
            members.push(FamilyMember {
                difference: MemberDifference::Scaled { parameter: *varied, factor },
                values,
            });
        }
    }
    Ok(members)
}

/// Returns the figures in each configuration of the mechanism, the controller being told nothing.
///
/// # Errors
/// As [`figures_of`], and configurations that fit masses which are not there.
pub fn compare_configurations(
    nominal: &Parameters,
    controller: &Controller,
    procedure: &Procedure,
    figures: &[PerformanceFigure],
) -> Result<Vec<FamilyMember>, Error> {
    let member = |configuration| {
        let plant = Plant::from_lumped(&nominal.with_configuration(configuration)?)?;
        let values = figures_of(&plant, controller, procedure, figures)?;
        Ok(FamilyMember { difference: MemberDifference::Configuration(configuration.name.clone()), values })
    };
    nominal.configurations.iter().map(member).collect()
}
