//! What Plant and Reduce draw of a plant beside the design: poles, Hankel values, full against reduced response, modes that move.

use std::sync::Arc;

use counterpoise_lti::{C64, CMat, StateSpace, hankel_values, poles, response};
use counterpoise_models::parameters::Beam;
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::structure::{FeModel, FeOptions, Fitted, Modes, Profile, Support, modes};
use counterpoise_pipeline::{Modelled, Reduced};

use crate::live::Live;

/// Points of a frequency response.
const POINTS: usize = 300;

/// A plant and its reduction.
#[derive(Debug, Clone)]
pub struct Portrait {
    of: (Arc<Modelled>, Arc<Reduced>),
    /// States of the full plant, and of the reduced one.
    pub states: [usize; 2],
    /// Poles of the full plant, slow ones first; one of each pair.
    pub poles: Vec<C64>,
    /// Hankel values of the full plant; `None` if it is not stable.
    pub hankel: Vec<f64>,
    /// Frequencies, rad/s.
    pub rates: Vec<f64>,
    /// Hub rate for the control and for heave: full, then reduced.
    pub moduli: [[Vec<f64>; 2]; 2],
    /// Modulus of the reduction's error from control to hub rate.
    pub error: Vec<f64>,
}

impl Portrait {
    /// The portrait of a design's plant.
    pub fn of(live: &Live) -> Self {
        let (full, small) = (&live.modelled.linear.system, &live.reduced.system);
        let rates: Vec<f64> = rates().collect();
        let at = |system: &StateSpace| response::frequency_response(system, &rates).unwrap_or_default();
        let (full_at, small_at) = (at(full), at(small));
        let modulus = |all: &[CMat], input: usize| -> Vec<f64> {
            all.iter().map(|h| h[(LinearPlant::HUB_RATE, input)].norm()).collect()
        };
        let entry = (LinearPlant::HUB_RATE, LinearPlant::CONTROL);
        let error = full_at.iter().zip(&small_at).map(|(a, b)| (a[entry] - b[entry]).norm().max(1e-16));
        let moduli = [LinearPlant::CONTROL, LinearPlant::HEAVE]
            .map(|input| [modulus(&full_at, input), modulus(&small_at, input)]);
        let mut poles = poles(full).unwrap_or_default();
        poles.retain(|p| p.im >= 0.0);
        poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        Self {
            of: (Arc::clone(&live.modelled), Arc::clone(&live.reduced)),
            states: [live.reduced.order_before, small.order()],
            poles,
            hankel: hankel_values(full).unwrap_or_default(),
            error: error.collect(),
            moduli,
            rates,
        }
    }

    /// Whether it is of this design's plant.
    pub fn is_of(&self, live: &Live) -> bool {
        Arc::ptr_eq(&self.of.0, &live.modelled) && Arc::ptr_eq(&self.of.1, &live.reduced)
    }
}

fn rates() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|k| 0.06 * (1e5_f64).powf(k as f64 / (POINTS - 1) as f64))
}

/// A beam with its modes pinned at the hub.
#[derive(Debug, Clone)]
pub struct Swinging {
    /// The beam.
    pub beam: Beam,
    /// Nodes along it in m, with its modes; `None` if it has none.
    pub modes: Option<(Vec<f64>, Modes)>,
}

impl Swinging {
    /// The modes of a beam.
    pub fn of(beam: Beam) -> Self {
        let modes = modes_of(&beam);
        Self { beam, modes }
    }
}

fn modes_of(beam: &Beam) -> Option<(Vec<f64>, Modes)> {
    let options = FeOptions::default();
    let model = FeModel::beam(beam, &Fitted::default(), &options).ok()?;
    let nodes = options.mesh.nodes_m(&Profile::new(beam).ok()?, beam.pivot_m).ok()?;
    Some((nodes, modes(&model, Support::Pinned).ok()?))
}
