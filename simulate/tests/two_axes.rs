//! Two axes together: conservation of energy and angular momentum, one axis at rest under the other, and the gyroscope on the elevated mass.
#![allow(clippy::unwrap_used)]

use counterpoise_models::plant::core::state;
use counterpoise_models::two_axes::{BodyInertia, ElevatedBody, ElevationMotion, PivotPosition};
use counterpoise_models::{
    AmplifierDynamics, Friction, FrictionLaw, Gearbox, Lumped, Plant, reference,
};
use counterpoise_simulate::{
    AxisScenario, BaseMotion, Controllers, Coupling, Detail, Firing, Initial, Playback, Simulator, TraverseGyroscope, TwoAxisHistory, TwoAxisScenario, TwoAxisSimulator,
};

const G: f64 = 9.80665;
const SAMPLES: usize = 10_000;

/// One inertia that nothing drives or brakes.
fn free(inertia: f64, out_of_balance: f64, offset: f64, gravity: f64) -> Plant {
    let mut p = reference::rig();
    let lumped = Lumped {
        out_of_balance_kg_m: out_of_balance,
        vertical_offset_kg_m: offset,
        ..Lumped::rigid(inertia)
    };
    (p.beam, p.lumped, p.gearbox) = (None, Some(lumped), Gearbox::DIRECT);
    p.gravity_m_s2 = gravity;
    p.motor.inertia_kg_m2 = 0.0;
    p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
    p.motor_friction = Friction::plain(FrictionLaw::None, 0.0);
    p.pivot_friction = Friction::plain(FrictionLaw::None, 0.0);
    Plant::lumped(&p).unwrap()
}

/// What is conserved along a free motion, from its start: the largest change of energy and of angular momentum, relative to the
/// kinetic energy and the angular momentum at the start.
fn drift(inertia: BodyInertia, pivot: PivotPosition) -> ([f64; 2], TwoAxisHistory) {
    let (elevation, traverse) = (free(12.0, 1.5, 0.4, G), free(30.0, 0.7, 0.0, 0.0));
    let body = ElevatedBody::of_plant(&elevation, inertia, pivot, 0.2_f64.sin_cos().into());
    let coupling = Coupling { body, gyroscope: TraverseGyroscope::Ring };
    let mut turning = Simulator::new(&traverse).unwrap().rest(0.3, 0.0, 0.0);
    turning.core[state::RATE] = 0.8;
    let scenario = TwoAxisScenario {
        duration_s: SAMPLES as f64 * 1e-3,
        base: BaseMotion::still(G),
        elevation: AxisScenario::still(0.4),
        traverse: AxisScenario { initial: Initial::State(Box::new(turning)), ..AxisScenario::still(0.3) },
        detail: Detail::Everything,
        firing: Firing::Silent,
    };
    let zeros = vec![0.0; SAMPLES + 1];
    let mut controllers =
        Controllers { elevation: &mut Playback::new(&zeros), traverse: &mut Playback::new(&zeros) };
    let found = TwoAxisSimulator::new(&elevation, &traverse, coupling)
        .unwrap()
        .run(&mut controllers, &scenario)
        .unwrap();
    let own = 30.0 - body.inertia_about_ring_kg_m2(body.included_at);
    let conserved = |k: usize| {
        let (ring, angle) = (found.traverse.truth.hub_rate_rad_s[k], found.elevation_rad[k]);
        let elevation = ElevationMotion {
            tilt: angle.sin_cos().into(),
            rate_rad_s: found.elevation.truth.hub_rate_rad_s[k],
            acceleration_rad_s2: 0.0,
        };
        let kinetic = 0.5 * own * ring * ring + body.kinetic_energy_j(ring, &elevation);
        let weight = G * (1.5 * angle.sin() + 0.4 * angle.cos());
        let momentum = own * ring + body.angular_momentum_nm_s(ring, &elevation);
        [kinetic + weight, momentum, kinetic]
    };
    let start = conserved(0);
    let worst = (0..found.elevation.len()).map(conserved).fold([0.0_f64; 2], |worst, now| {
        [worst[0].max((now[0] - start[0]).abs() / start[2]), worst[1].max((now[1] - start[1]).abs() / start[1])]
    });
    (worst, found)
}

/// A free motion over ten seconds in which the elevation swings and the ring turns faster and slower with it.
#[test]
fn energy_and_angular_momentum_are_conserved_without_friction() {
    let bodies = [
        (BodyInertia::slender(12.0), PivotPosition::default()),
        (BodyInertia::slender(12.0), PivotPosition { forward_m: 0.4, left_m: 0.0 }),
        (
            BodyInertia {
                about_axis_kg_m2: 12.0,
                about_beam_kg_m2: 2.0,
                about_normal_kg_m2: 13.0,
                product_kg_m2: 0.7,
            },
            PivotPosition { forward_m: 0.4, left_m: -0.6 },
        ),
    ];
    for (inertia, pivot) in bodies {
        let ([energy, momentum], found) = drift(inertia, pivot);
        let rates = &found.traverse.truth.hub_rate_rad_s;
        let spread = rates.iter().fold([f64::MAX, f64::MIN], |[l, h], r| [l.min(*r), h.max(*r)]);
        println!("{energy:e} {momentum:e} {spread:?} {} {}", found.passes_per_sample, found.unconverged);
        assert!(spread[1] - spread[0] > 0.2, "the axes are coupled: {spread:?}");
        assert!(energy < 1e-8 && momentum < 1e-8, "{energy:e} {momentum:e}");
        assert_eq!(found.unconverged, 0);
    }
}
