//! The closed loop, and the loop broken at the plant's input.

use counterpoise_controller::{Controller, Path, PathSignal};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, lft, poles, series};

use super::SampledPlant;
use super::plant::{Resolver, port};
use crate::tolerance::SAME_PERIOD;
use crate::{Arrangement, Error};

/// A loop that has been closed.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    /// (demand, heave, pitch rate) -> (hub rate, tip rate, motor rate, current, control about its holding value).
    pub system: StateSpace,
    /// Poles, in the z-plane.
    pub poles: Vec<C64>,
    /// The loop broken at the plant's input, for negative feedback: 1 + L is the return difference. Absent without a controller.
    pub broken: Option<StateSpace>,
    /// The controller from readings to control; absent without a controller.
    pub controller: Option<StateSpace>,
}

/// The loop of an arrangement.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrangedLoop {
    /// Part of the controller that acts.
    pub arrangement: Arrangement,
    /// The loop, closed.
    pub closed: ClosedLoop,
}

impl ClosedLoop {
    /// Closes the loop with `controller`, or leaves it open where there is none.
    ///
    /// # Errors
    /// [`Error::Period`] if the clocks differ; those of the connection.
    pub fn new(
        plant: &SampledPlant,
        controller: Option<&Controller>,
        out_of_balance_kg_m: f64,
    ) -> Result<Self, Error> {
        let Some(controller) = controller else { return Self::open_loop(plant) };
        same_period(controller, plant.sample_period_s)?;
        let K = controller.linear(out_of_balance_kg_m)?;
        let system = lft(&plant.sampled, &K)?;
        let readings: Vec<usize> = (port::FIRST_READING..plant.sampled.outputs()).collect();
        let broken = series(&plant.sampled.select(&readings, &[port::CONTROL]), &K)?.negate();
        Ok(Self { poles: poles(&system)?, system, broken: Some(broken), controller: Some(K) })
    }

    fn open_loop(plant: &SampledPlant) -> Result<Self, Error> {
        let outputs: Vec<usize> = (0..port::FIRST_READING).collect();
        let mut system = plant.sampled.select(&outputs, &[port::DEMAND, port::HEAVE, port::PITCH]);
        (0..system.order()).for_each(|j| system.C[(port::CONTROL_OUT, j)] = 0.0);
        system.D.set_block(port::CONTROL_OUT, 0, &Mat::zeros(1, 3));
        Ok(Self { poles: poles(&system)?, system, broken: None, controller: None })
    }

    /// Returns the largest modulus of a pole; below 1 the loop is stable.
    pub fn pole_radius(&self) -> f64 {
        self.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
    }
}

fn same_period(controller: &Controller, interface_s: f64) -> Result<(), Error> {
    let controller_s = controller.sample_period_s();
    if (controller_s - interface_s).abs() <= SAME_PERIOD * interface_s {
        return Ok(());
    }
    Err(Error::Period { controller_s, interface_s })
}

/// Returns the controller in an arrangement: as it is, or without the paths that see the platform's motion alone; none without control.
///
/// # Errors
/// Those of the controller.
pub fn arrange_controller(
    controller: &Controller,
    arrangement: Arrangement,
) -> Result<Option<Controller>, Error> {
    match arrangement {
        Arrangement::Uncontrolled => Ok(None),
        Arrangement::Feedback => {
            Ok(Some(controller.with(|parts| parts.paths.retain(|path| !is_feedforward(path)))?))
        }
        Arrangement::Compensated => Ok(Some(controller.clone())),
    }
}

/// Returns whether a path sees nothing but the platform's motion.
pub fn is_feedforward(path: &Path) -> bool {
    path.inputs
        .iter()
        .all(|signal| matches!(signal, PathSignal::PlatformRate | PathSignal::PlatformAcceleration))
}

/// Returns whether any part of the controller reads the hub's angle.
pub fn resolver_use(controller: &Controller) -> Resolver {
    let reads = controller.parts().paths.iter().any(|path| path.inputs.contains(&PathSignal::HubPosition));
    if reads { Resolver::Read } else { Resolver::Unread }
}
