//! A plant beside its reduction: poles, Hankel singular values and responses; the modes of a beam; friction brought to the hub.

use counterpoise_linalg::{C64, CMat};
use counterpoise_lti::{StateSpace, damping_ratio, hankel_values, poles, response};
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::parameters::Beam;
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::structure::{
    AttachedMasses, FeModel, FeOptions, Modes, Profile, Support, undamped_modes,
};
use counterpoise_models::{Friction, Parameters};

use crate::{PlantModel, ReducedPlant};

/// Points of a frequency response.
const POINTS: usize = 300;
/// Lowest frequency of the responses, rad/s, and the factor from it to the highest: from 0.01 Hz to 1 kHz.
const LOWEST_RAD_S: f64 = 0.06;
const RANGE: f64 = 1e5;
/// Smallest modulus of the error: below it lies rounding.
const SMALLEST_ERROR: f64 = 1e-16;

/// The full plant beside the reduced one.
#[derive(Debug, Clone)]
pub struct ReductionComparison {
    /// Number of states of the full plant and of the reduced one.
    pub states: [usize; 2],
    /// Poles of the full plant, slow ones first; one of each conjugate pair.
    pub poles: Vec<PlantPole>,
    /// Hankel singular values of the full plant; empty if it is not stable.
    pub hankel: Vec<f64>,
    /// Frequencies of the responses, rad/s.
    pub frequencies_rad_s: Vec<f64>,
    /// Moduli from control to hub rate, rad/s per V: full, then reduced.
    pub control_moduli: [Vec<f64>; 2],
    /// Moduli from heave to hub rate, rad/s per m/s^2: full, then reduced.
    pub heave_moduli: [Vec<f64>; 2],
    /// Moduli from platform pitch rate to hub rate: full, then reduced.
    pub pitch_moduli: [Vec<f64>; 2],
    /// Modulus of the reduction's error from control to hub rate.
    pub error: Vec<f64>,
}

/// A pole, or one of a conjugate pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantPole {
    /// Modulus, rad/s.
    pub modulus_rad_s: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// States that it belongs to: two for a pair.
    pub states: usize,
}

/// Compares a plant with its reduction. A response that cannot be computed is left empty.
pub fn compare_reduction(modelled: &PlantModel, reduced: &ReducedPlant) -> ReductionComparison {
    let (full, small) = (&modelled.linear.system, &reduced.system);
    let frequency = |k: usize| LOWEST_RAD_S * RANGE.powf(k as f64 / (POINTS - 1) as f64);
    let frequencies_rad_s: Vec<f64> = (0..POINTS).map(frequency).collect();
    let at =
        |system: &StateSpace| response::frequency_response(system, &frequencies_rad_s).unwrap_or_default();
    let (full_at, small_at) = (at(full), at(small));
    let modulus = |all: &[CMat], input: usize| -> Vec<f64> {
        all.iter().map(|h| h[(LinearPlant::HUB_RATE, input)].norm()).collect()
    };
    let moduli = |input: usize| [modulus(&full_at, input), modulus(&small_at, input)];
    let entry = (LinearPlant::HUB_RATE, LinearPlant::CONTROL);
    let error = full_at.iter().zip(&small_at).map(|(a, b)| (a[entry] - b[entry]).norm().max(SMALLEST_ERROR));
    ReductionComparison {
        states: [reduced.order_before(), small.order()],
        poles: slow_poles_first(full),
        hankel: hankel_values(full).unwrap_or_default(),
        error: error.collect(),
        control_moduli: moduli(LinearPlant::CONTROL),
        heave_moduli: moduli(LinearPlant::HEAVE),
        pitch_moduli: moduli(LinearPlant::PITCH_RATE),
        frequencies_rad_s,
    }
}

fn slow_poles_first(system: &StateSpace) -> Vec<PlantPole> {
    let mut all = poles(system).unwrap_or_default();
    all.retain(|p| p.im >= 0.0);
    all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    let pole = |pole: C64| PlantPole {
        modulus_rad_s: pole.norm(),
        damping_ratio: damping_ratio(pole),
        states: if pole.im > 0.0 { 2 } else { 1 },
    };
    all.into_iter().map(pole).collect()
}

/// The modes of a beam that is pinned at the hub.
#[derive(Debug, Clone)]
pub struct PinnedModes {
    /// Positions of the nodes along the beam, m.
    pub nodes_m: Vec<f64>,
    /// The modes at these nodes.
    pub modes: Modes,
}

/// Returns the modes of a beam that is pinned at the hub, or `None` if its finite-element model cannot be built.
pub fn pinned_modes(beam: &Beam) -> Option<PinnedModes> {
    let options = FeOptions::default();
    let model = FeModel::beam(beam, &AttachedMasses::default(), &options).ok()?;
    let nodes_m = options.mesh.nodes_m(&Profile::new(beam).ok()?, beam.pivot_m).ok()?;
    Some(PinnedModes { nodes_m, modes: undamped_modes(&model, Support::Pinned).ok()? })
}

/// Place of a friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionPlace {
    /// At the pivot.
    Pivot,
    /// At the motor, brought to the hub through the gear.
    Motor,
}

/// Returns steady friction brought to the hub, as hub rate (rad/s) and torque (N m), or `None` if the law's numbers are not allowed.
pub fn steady_friction_at_hub(
    plant: &Parameters,
    place: FrictionPlace,
    hub_rates_rad_s: impl Iterator<Item = f64>,
) -> Option<Vec<[f64; 2]>> {
    let (friction, ratio): (&Friction, f64) = match place {
        FrictionPlace::Pivot => (&plant.pivot_friction, 1.0),
        FrictionPlace::Motor => (&plant.motor_friction, plant.gearbox.ratio),
    };
    let model = FrictionModel::new(friction).ok()?;
    Some(hub_rates_rad_s.map(|rate| [rate, ratio * model.steady_torque(ratio * rate)]).collect())
}
