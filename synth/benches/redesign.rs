//! The cost of a dragged slider: redesign, sampled controller, margins, step.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case, missing_docs)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{rig, weights};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, append};
use counterpoise_synth::{
    DesignPlant, Sampling, SamplingMethod, design, discretise, sampled_loop_figures, stabilisation_error,
};
use criterion::{Criterion, criterion_group, criterion_main};

/// The rig with further flexible modes on the hub, to the given design order.
fn enlarged_rig(order: usize) -> DesignPlant {
    let mut plant = rig();
    let mut k = 0;
    while plant.measured_plant().unwrap().order() + 2 <= order {
        let w = 400.0 + 170.0 * f64::from(k);
        let A = Mat::from_rows(&[&[0.0, w], &[-w, -0.02 * w]]);
        let mode = StateSpace::new(
            A,
            Mat::col(&[0.0, 0.02]),
            Mat::row(&[0.0, 1.0]),
            Mat::zeros(1, 1),
            plant.system.timebase,
        );
        let both = append(&plant.system, &mode.unwrap()).unwrap();
        let (n, m) = (both.order(), both.inputs() - 1);
        let states: Vec<usize> = (0..n).collect();
        let mut B = both.B.select(&states, &[0, 1, 2]);
        let mut C = both.C.select(&[0, 1, 2], &states);
        for i in 0..n {
            B[(i, 0)] += both.B[(i, m)];
            C[(0, i)] += both.C[(both.outputs() - 1, i)];
        }
        plant.system = StateSpace::new(both.A, B, C, Mat::zeros(3, 3), plant.system.timebase).unwrap();
        plant.system.D = rig().system.D;
        k += 1;
    }
    plant
}

/// Feedback, both feedforwards, sampled controller, margins, step, disturbance responses.
fn redesign(plant: &DesignPlant, method: SamplingMethod) -> f64 {
    let design = design(plant, &weights()).unwrap();
    let sampling = Sampling { method, ..Sampling::new(1e-3, 10.0) };
    let sampled = discretise(&design, &sampling).unwrap();
    let found = sampled_loop_figures(plant, &sampled, &sampling, [1.26, 12.6]).unwrap();
    let errors =
        [counterpoise_synth::DisturbanceChannel::Heave, counterpoise_synth::DisturbanceChannel::Pitch]
            .map(|channel| stabilisation_error(plant, &design, channel, 1.0).unwrap());
    found.phase_margin_deg + errors[0] + errors[1]
}

fn benches(criterion: &mut Criterion) {
    for order in [11, 40] {
        let plant = enlarged_rig(order);
        for (name, method) in
            [("redesign", SamplingMethod::TUSTIN), ("redesign in sampled time", SamplingMethod::SampledData)]
        {
            let name = format!("{name} at order {order}");
            criterion.bench_function(&name, |b| b.iter(|| redesign(&plant, method)));
        }
        criterion.bench_function(&format!("design alone at order {order}"), |b| {
            b.iter(|| design(&plant, &weights()).unwrap());
        });
    }
}

criterion_group! { name = redesigns; config = Criterion::default().sample_size(20); targets = benches }
criterion_main!(redesigns);
