//! The time of a run with derivatives along 1 to 16 parameters, over that of a plain run and of an ensemble of differences.
//!
//! `cargo run --release -p counterpoise-simulate --example jacobian_pace`
#![allow(clippy::unwrap_used)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{FrictionLaw, Parameters, Plant, reference};
use counterpoise_simulate::sensitivity::{DifferentiablePi, Direction, Member, PiGains, Side};
use counterpoise_simulate::{Detail, EnsembleRun, PlatformMotion, Scenario, Signal, Simulator, run_ensemble};
use std::time::Instant;

type Place = fn(&mut Parameters) -> &mut f64;

/// Eight parameters of the linear core, five of friction, three of both or of neither.
const PARAMETERS: [Place; 16] = [
    |p| &mut p.gearbox.stiffness_nm_rad,
    |p| &mut p.gearbox.damping_nm_s_rad,
    |p| &mut p.motor.inertia_kg_m2,
    |p| &mut p.motor.torque_constant_nm_a,
    |p| &mut p.motor.resistance_ohm,
    |p| &mut p.lumped.as_mut().unwrap().out_of_balance_kg_m,
    |p| &mut p.lumped.as_mut().unwrap().beam_inertia_kg_m2,
    |p| &mut p.motor.back_emf_v_s_rad,
    |p| level(&mut p.motor_friction.law),
    |p| level(&mut p.pivot_friction.law),
    |p| &mut p.motor_friction.static_ratio,
    |p| &mut p.pivot_friction.static_ratio,
    |p| &mut p.pivot_friction.stribeck_rate_rad_s,
    |p| &mut p.pivot_friction.viscous_nm_s_rad,
    |p| &mut p.sensors.hub_gyro.gain,
    |p| &mut p.amplifier.gain,
];

fn level(law: &mut FrictionLaw) -> &mut f64 {
    match law {
        FrictionLaw::Dahl { coulomb_nm, .. } | FrictionLaw::Lugre { coulomb_nm, .. } => coulomb_nm,
        other => panic!("{other:?}"),
    }
}

fn moved(place: Place, by: f64) -> Plant {
    let mut parameters = reference::rig();
    *place(&mut parameters) *= 1.0 + by;
    Plant::from_lumped(&parameters).unwrap()
}

fn controller() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: 2.88,
        sample_period_s: 1e-3,
        integral_v: 0.0,
    }
}

/// Returns the least time of several calls, ms.
fn least_ms(mut call: impl FnMut()) -> f64 {
    let once = |call: &mut dyn FnMut()| {
        let begin = Instant::now();
        call();
        begin.elapsed().as_secs_f64() * 1e3
    };
    (0..9).map(|_| once(&mut call)).fold(f64::INFINITY, f64::min)
}

fn main() {
    let scenario = Scenario {
        demand_rad_s: Signal::sine(0.05, 12.0),
        platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.05, 9.0), ..PlatformMotion::STILL },
        detail: Detail::Recording,
        ..Scenario::at_rest(std::env::args().nth(1).map_or(10.0, |word| word.parse().unwrap()))
    };
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let plain = least_ms(|| {
        Simulator::new(&plant).unwrap().run(&mut controller(), &scenario).unwrap();
    });
    println!("a plain run of {} samples: {plain:.2} ms", scenario.duration_s * 1e3);
    for count in [1, 2, 4, 8, 16] {
        let members: Vec<_> = PARAMETERS[..count]
            .iter()
            .map(|place| move |by: f64| Ok(Member { plant: moved(*place, by), start: None }))
            .collect();
        let exact = least_ms(|| {
            let directions: Vec<Direction> =
                members.iter().map(|member| Direction { member, step: 1e-3, side: Side::Both }).collect();
            let mut controller = DifferentiablePi::new(&controller(), &[PiGains::default(); 16][..count]);
            Simulator::new(&plant).unwrap().run_with_slopes(&mut controller, &scenario, &directions).unwrap();
        });
        let differences = least_ms(|| {
            let mut simulators: Vec<Simulator> = PARAMETERS[..count]
                .iter()
                .map(|place| Simulator::new(&moved(*place, 1e-3)).unwrap())
                .collect();
            let mut controllers = vec![controller(); count];
            let pairs = simulators.iter_mut().zip(&mut controllers);
            let mut runs: Vec<EnsembleRun> = pairs
                .map(|(simulator, controller)| EnsembleRun {
                    simulator,
                    controller,
                    scenario: &scenario,
                    watch: None,
                })
                .collect();
            run_ensemble(&mut runs);
        });
        println!(
            "{count:2} parameters: {exact:.2} ms, {:.2} plain runs; differences with one run each, side by side: {differences:.2} ms, {:.2}",
            exact / plain,
            differences / plain + 1.0
        );
    }
}
