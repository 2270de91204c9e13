//! Two axes together: conservation of energy and angular momentum, one axis at rest under the other, and the gyroscope on the elevated mass.
#![allow(clippy::unwrap_used)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::plant::SinCos;
use counterpoise_models::plant::core::state;
use counterpoise_models::two_axes::{
    BodyInertia, Coupling, ElevatedBody, ElevationMotion, PivotPosition, TraverseGyroscope,
};
use counterpoise_models::{
    AmplifierDynamics, Friction, FrictionLaw, Gearbox, LumpedStructure, Parameters, Plant, reference,
};
use counterpoise_simulate::{
    AxisScenario, BaseMotion, Controllers, Detail, Firing, FurtherMotion, Imperfections, Initial,
    PlatformMotion, Playback, Scenario, Signal, Simulator, Sine, TwoAxisHistory, TwoAxisScenario,
    TwoAxisSimulator,
};

const G: f64 = 9.80665;
const SAMPLES: usize = 10_000;

/// One inertia that nothing drives or brakes.
fn free_plant(inertia: f64, out_of_balance: f64, offset: f64, gravity: f64) -> Plant {
    let mut p = reference::rig();
    let lumped = LumpedStructure {
        out_of_balance_kg_m: out_of_balance,
        vertical_offset_kg_m: offset,
        ..LumpedStructure::rigid(inertia)
    };
    (p.beam, p.lumped, p.gearbox) = (None, Some(lumped), Gearbox::DIRECT);
    p.gravity_m_s2 = gravity;
    p.motor.inertia_kg_m2 = 0.0;
    p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
    p.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    Plant::from_lumped(&p).unwrap()
}

/// Returns what is conserved along a free motion, from its start: the largest change of energy and of angular momentum, relative to the
/// kinetic energy and the angular momentum at the start.
fn drift(inertia: BodyInertia, pivot: PivotPosition) -> ([f64; 2], TwoAxisHistory) {
    let (elevation, traverse) = (free_plant(12.0, 1.5, 0.4, G), free_plant(30.0, 0.7, 0.0, 0.0));
    let body = ElevatedBody::of_plant(&elevation, inertia, pivot, SinCos::of(0.2));
    let coupling = Coupling { body, gyroscope: TraverseGyroscope::Ring };
    let mut turning = Simulator::new(&traverse).unwrap().rest(0.3, 0.0, 0.0);
    turning.core[state::RATE] = 0.8;
    let scenario = TwoAxisScenario {
        duration_s: SAMPLES as f64 * 1e-3,
        base: BaseMotion::at_rest(G),
        elevation: AxisScenario::at_rest(0.4),
        traverse: AxisScenario { initial: Initial::State(Box::new(turning)), ..AxisScenario::at_rest(0.3) },
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
        let (ring, angle) = (found.traverse.truth.hub_rate_rad_s()[k], found.elevation_rad()[k]);
        let elevation = ElevationMotion {
            tilt: SinCos::of(angle),
            rate_rad_s: found.elevation.truth.hub_rate_rad_s()[k],
            acceleration_rad_s2: 0.0,
        };
        let kinetic = 0.5 * own * ring * ring + body.kinetic_energy_j(ring, &elevation);
        let weight = G * (1.5 * angle.sin() + 0.4 * angle.cos());
        let momentum = own * ring + body.angular_momentum_nm_s(ring, &elevation);
        [kinetic + weight, momentum, kinetic]
    };
    let start = conserved(0);
    let worst = (0..found.elevation.len()).map(conserved).fold([0.0_f64; 2], |worst, now| {
        [
            worst[0].max((now[0] - start[0]).abs() / start[2]),
            worst[1].max((now[1] - start[1]).abs() / start[1]),
        ]
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
        let rates = found.traverse.truth.hub_rate_rad_s();
        let spread = rates.iter().fold([f64::MAX, f64::MIN], |[l, h], r| [l.min(*r), h.max(*r)]);
        println!("{energy:e} {momentum:e} {spread:?} {} {}", found.passes_per_sample, found.unconverged);
        assert!(spread[1] - spread[0] > 0.2, "the axes are coupled: {spread:?}");
        assert!(energy < 1e-8 && momentum < 1e-8, "{energy:e} {momentum:e}");
        assert_eq!(found.unconverged, 0);
    }
}

const PI_GAINS: ProportionalIntegral = ProportionalIntegral {
    kp_v_s_rad: 18.0,
    ki_v_rad: 80.0,
    bias_v: 0.0,
    sample_period_s: 1e-3,
    integral_v: 0.0,
    anti_windup: counterpoise_controller::AntiWindup::None,
};

/// The reference rig, and a ring with its drive whose hub carries it.
fn rigs() -> [Plant; 2] {
    let lumped = LumpedStructure {
        hub_inertia_kg_m2: 450.0,
        beam_inertia_kg_m2: 60.0,
        ..reference::rig().lumped.unwrap()
    };
    let upright = Parameters { gravity_m_s2: 0.0, lumped: Some(lumped), ..reference::rig() };
    [Plant::from_lumped(&reference::rig()).unwrap(), Plant::from_lumped(&upright).unwrap()]
}

fn on_a_base(base: BaseMotion, imperfections: Imperfections) -> TwoAxisScenario {
    let axis = |hub_angle_rad, rate| AxisScenario {
        demand_rad_s: Signal::Steps(vec![(0.5, rate), (1.5, 0.0)]),
        imperfections,
        ..AxisScenario::at_rest(hub_angle_rad)
    };
    TwoAxisScenario {
        duration_s: 3.0,
        base,
        elevation: axis(0.1, 0.1),
        traverse: axis(0.0, -0.05),
        detail: Detail::Everything,
        firing: Firing::Silent,
    }
}

fn run_both(plants: &[Plant; 2], coupling: Coupling, scenario: &TwoAxisScenario) -> TwoAxisHistory {
    let mut controllers = Controllers {
        elevation: &mut ProportionalIntegral { bias_v: 2.88, ..PI_GAINS },
        traverse: &mut PI_GAINS.clone(),
    };
    let mut both = TwoAxisSimulator::new(&plants[0], &plants[1], coupling).unwrap();
    both.run(&mut controllers, scenario).unwrap()
}

fn coupling(inertia: BodyInertia, plant: &Plant, gyroscope: TraverseGyroscope) -> Coupling {
    let body = ElevatedBody::of_plant(plant, inertia, PivotPosition::default(), SinCos::of(0.1));
    Coupling { body, gyroscope }
}

/// Heave and pitch of the base, level in the plane of elevation.
fn heave_and_pitch() -> [Signal; 2] {
    [Signal::sine(1.0, 9.0), Signal::sine(0.1, 7.0)]
}

/// The traverse axis feels nothing of a base that heaves while the ring stands still, and the elevation axis moves as it does alone.
#[test]
fn an_elevation_axis_on_a_ring_at_rest_moves_as_it_does_alone() {
    let plants = rigs();
    let [heave, _] = heave_and_pitch();
    let base = BaseMotion {
        specific_force_m_s2: [
            Signal::ZERO,
            Signal::ZERO,
            Signal::Sum(vec![Signal::Constant(G), heave.clone()]),
        ],
        ..BaseMotion::at_rest(G)
    };
    let mut scenario = on_a_base(base, Imperfections::None);
    scenario.traverse.demand_rad_s = Signal::ZERO;
    let inertia = BodyInertia::of_plant(&plants[0]);
    let both = run_both(&plants, coupling(inertia, &plants[0], TraverseGyroscope::Ring), &scenario);
    let alone = Scenario {
        demand_rad_s: scenario.elevation.demand_rad_s.clone(),
        platform: PlatformMotion { heave_m_s2: heave, ..PlatformMotion::STILL },
        initial: Initial::Rest { hub_angle_rad: 0.1 },
        ..Scenario::at_rest(3.0)
    };
    let mut controller = ProportionalIntegral { bias_v: 2.88, ..PI_GAINS };
    let alone = Simulator::new(&plants[0]).unwrap().run(&mut controller, &alone).unwrap();
    for (a, b) in both.elevation.truth.hub_rate_rad_s().iter().zip(alone.truth.hub_rate_rad_s()) {
        assert!((a - b).abs() < 1e-7, "{a} {b}");
    }
    assert!(both.traverse.truth.hub_rate_rad_s().iter().all(|rate| rate.abs() < 1e-9));
}

/// A gyroscope on the elevated mass sees the ring's rate less by the cosine of the elevation, so its loop turns the ring faster by that.
#[test]
fn a_gyroscope_on_the_elevated_mass_reads_cross_elevation() {
    let plants = rigs();
    let mut scenario = on_a_base(BaseMotion::at_rest(G), Imperfections::None);
    scenario.elevation = AxisScenario::at_rest(0.6);
    scenario.traverse.demand_rad_s = Signal::step(0.5, -0.05);
    let inertia = BodyInertia::of_plant(&plants[0]);
    let found = run_both(&plants, coupling(inertia, &plants[0], TraverseGyroscope::ElevatedMass), &scenario);
    let last = found.elevation.len() - 1;
    let (ring, cross) =
        (found.traverse.truth.hub_rate_rad_s()[last], found.cross_elevation_rate_rad_s()[last]);
    assert!((cross + 0.05).abs() < 1e-3, "{cross}");
    assert!((ring * found.elevation_rad()[last].cos() - cross).abs() < 1e-12, "{ring} {cross}");
    assert!((found.traverse.readings.hub_rate_rad_s()[last] - cross).abs() < 1e-4);
}

/// Gravity and a sine, as one sum of sines.
fn weighing(amplitude: f64, frequency_rad_s: f64) -> Signal {
    let gravity = Sine { amplitude: G, frequency_rad_s: 0.0, phase_rad: std::f64::consts::FRAC_PI_2 };
    Signal::Sines(vec![gravity, Sine { amplitude, frequency_rad_s, phase_rad: 0.0 }])
}

fn further_motion(
    surge_m_s2: Signal,
    roll_rate_rad_s: Signal,
    yaw_rate_rad_s: Signal,
) -> Option<FurtherMotion> {
    Some(FurtherMotion { surge_m_s2, roll_rate_rad_s, yaw_rate_rad_s })
}

/// Both loops with noise on a base that moves about all its axes: what two axes cost beside one. The work is counted in evaluations of the
/// nonlinear parts; `docs/evidence/base-motion.md` has the instructions.
#[test]
fn two_axes_seldom_take_a_sample_twice() {
    let plants = rigs();
    let sine = Signal::sine;
    let base = BaseMotion {
        specific_force_m_s2: [sine(2.0, 6.0), sine(1.0, 5.0), weighing(1.0, 9.0)],
        rate_rad_s: [sine(0.1, 8.0), sine(0.1, 7.0), sine(0.1, 6.0)],
        initial_pitch_rad: 0.0,
    };
    let noisy = Imperfections::NoiseAndQuantisation { seed: 3 };
    let mut scenario = on_a_base(base, noisy);
    scenario.duration_s = 10.0;
    let inertia = BodyInertia::of_plant(&plants[0]);
    let both = run_both(&plants, coupling(inertia, &plants[0], TraverseGyroscope::Ring), &scenario);
    println!("{} passes, {} unconverged", both.passes_per_sample, both.unconverged);
    let alone = Scenario {
        demand_rad_s: scenario.elevation.demand_rad_s.clone(),
        platform: PlatformMotion {
            heave_m_s2: sine(1.0, 9.0),
            pitch_rate_rad_s: sine(-0.1, 7.0),
            further: further_motion(sine(2.0, 6.0), sine(0.1, 8.0), sine(0.1, 6.0)),
            ..PlatformMotion::STILL
        },
        imperfections: noisy,
        initial: Initial::Rest { hub_angle_rad: 0.1 },
        ..Scenario::at_rest(10.0)
    };
    let mut controller = ProportionalIntegral { bias_v: 2.88, ..PI_GAINS };
    let alone = Simulator::new(&plants[0]).unwrap().run(&mut controller, &alone).unwrap();
    let scenario_below = Scenario {
        demand_rad_s: scenario.traverse.demand_rad_s.clone(),
        platform: PlatformMotion {
            heave_m_s2: sine(1.0, 5.0),
            pitch_rate_rad_s: sine(0.1, 6.0),
            further: further_motion(sine(2.0, 6.0), Signal::ZERO, Signal::ZERO),
            ..PlatformMotion::STILL
        },
        imperfections: noisy,
        ..Scenario::at_rest(10.0)
    };
    let below = Simulator::new(&plants[1]).unwrap().run(&mut PI_GAINS.clone(), &scenario_below).unwrap();
    println!("{:?} {:?} {:?} {:?}", both.elevation.effort, both.traverse.effort, alone.effort, below.effort);
    assert!(both.passes_per_sample < 1.1 && both.unconverged == 0);
}
