//! The plant that the design takes: the linear plant, or a smaller one with its error.

use counterpoise_lti::StateSpace;
use counterpoise_reduce::{Method, Order, Residual, Warning, balred, minimal_realisation, modal_truncation};

use crate::tolerance::KEPT_HANKEL_SHARE;
use crate::tolerance::MINIMAL_TOLERANCE;
use crate::{PipelineError, PlantModel};
use counterpoise_project::Project;
use counterpoise_project::resolve::design::ReductionMethod;

/// The reduced plant; inputs and outputs are those of the linear plant.
#[derive(Debug, Clone)]
pub struct ReducedPlant {
    /// The method.
    pub method: ReductionMethod,
    /// The system.
    pub system: StateSpace,
    /// The plant before.
    pub before: StateSpace,
    /// Names of the outputs.
    pub output_names: Vec<String>,
    /// Values by which states were ranked, largest first; empty if the method ranks none.
    pub ranked: Vec<f64>,
    /// A priori bound on the largest error over all frequencies and directions.
    pub bound: Option<f64>,
    /// Measured error of the reduction, with the frequency at which it is largest, rad/s.
    pub error: Option<(f64, f64)>,
    /// Warnings for the designer.
    pub warnings: Vec<Warning>,
}

impl ReducedPlant {
    /// Returns the order of the plant before.
    pub fn order_before(&self) -> usize {
        self.before.order()
    }
}

/// Reduces the linear plant as the project asks.
///
/// # Errors
/// A method that the chosen structure does not allow, an order that is missing, and those of the reduction.
pub fn reduce_plant(project: &Project, modelled: &PlantModel) -> Result<ReducedPlant, PipelineError> {
    let system = &modelled.linear.system;
    let asked = project.reduce;
    let plain = |system: StateSpace| ReducedPlant {
        method: asked.method,
        before: modelled.linear.system.clone(),
        output_names: modelled.linear.output_names.clone(),
        system,
        ranked: Vec::new(),
        bound: None,
        error: None,
        warnings: Vec::new(),
    };
    match asked.method {
        ReductionMethod::None => Ok(plain(system.clone())),
        ReductionMethod::Minimal => {
            let small = minimal_realisation(system, MINIMAL_TOLERANCE)?;
            Ok(ReducedPlant { warnings: small.warnings, ..plain(small.system) })
        }
        ReductionMethod::Balanced => {
            let order = asked.order.map_or(Order::Relative { share: KEPT_HANKEL_SHARE }, Order::States);
            Ok(ranked_reduction(balred(system, order, Method::BalancingFree)?, plain))
        }
        ReductionMethod::Modal => {
            let rate = slowest_dropped(system, asked.order)?;
            Ok(ranked_reduction(modal_truncation(system, rate, Residual::Drop)?, plain))
        }
        ReductionMethod::Guyan => Err(PipelineError::Reduction {
            method: "guyan",
            problem: "it condenses a structure of nodes; the plant here is already in modes: choose [model] modes, or another method".to_owned(),
        }),
    }
}

fn ranked_reduction(
    reduction: counterpoise_reduce::Reduction,
    plain: impl Fn(StateSpace) -> ReducedPlant,
) -> ReducedPlant {
    ReducedPlant {
        ranked: reduction.hankel,
        bound: reduction.bound,
        error: Some((reduction.measured_error.value, reduction.measured_error.rate_rad_s)),
        warnings: reduction.warnings,
        ..plain(reduction.system)
    }
}

/// Returns the rate that keeps `order` poles: between the last pole kept and the first dropped.
fn slowest_dropped(system: &StateSpace, order: Option<usize>) -> Result<f64, PipelineError> {
    let mut rates: Vec<f64> = counterpoise_lti::poles(system)?.iter().map(|p| p.norm()).collect();
    rates.sort_by(f64::total_cmp);
    let Some(order) = order.filter(|&n| n > 0 && n < rates.len()) else {
        return Err(PipelineError::Reduction {
            method: "modal",
            problem: format!("[reduce] order must be between 1 and {}", rates.len().saturating_sub(1)),
        });
    };
    Ok((rates[order - 1] * rates[order]).sqrt())
}
