//! The time of a run with derivatives along 1 to 16 parameters, over that of a plain run and of an ensemble of differences.
//!
//! `cargo run --release -p counterpoise-simulate --example jacobian_pace`; with `plain`, `exact` or `differences`, a number of parameters and a
//! duration in seconds it runs that alone, for a count of instructions.
#![allow(clippy::unwrap_used, clippy::panic)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{FrictionLaw, Parameters, Plant, reference};
use counterpoise_simulate::sensitivity::{DifferentiablePi, Direction, Member, Side};
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
        ..ProportionalIntegral::default()
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

/// The runs whose time is compared.
struct Pace {
    plant: Plant,
    scenario: Scenario,
}

impl Pace {
    fn new(duration_s: f64) -> Self {
        Self {
            plant: Plant::from_lumped(&reference::rig()).unwrap(),
            scenario: Scenario {
                demand_rad_s: Signal::sine(0.05, 12.0),
                platform: PlatformMotion {
                    pitch_rate_rad_s: Signal::sine(0.05, 9.0),
                    ..PlatformMotion::STILL
                },
                detail: Detail::Recording,
                ..Scenario::at_rest(duration_s)
            },
        }
    }

    fn plain(&self) {
        Simulator::new(&self.plant).unwrap().run(&mut controller(), &self.scenario).unwrap();
    }

    fn exact(&self, count: usize) {
        let members: Vec<_> = PARAMETERS[..count]
            .iter()
            .map(|place| move |by: f64| Ok(Member { plant: moved(*place, by), start: None }))
            .collect();
        let directions: Vec<Direction> =
            members.iter().map(|member| Direction { member, step: 1e-3, side: Side::Both }).collect();
        let mut controller = DifferentiablePi::new(&controller(), &[]);
        let mut simulator = Simulator::new(&self.plant).unwrap();
        simulator.run_with_slopes(&mut controller, &self.scenario, &directions).unwrap();
    }

    /// Runs the variants of one-sided differences side by side.
    fn differences(&self, count: usize) {
        let mut simulators: Vec<Simulator> =
            PARAMETERS[..count].iter().map(|place| Simulator::new(&moved(*place, 1e-3)).unwrap()).collect();
        let mut controllers = vec![controller(); count];
        let pairs = simulators.iter_mut().zip(&mut controllers);
        let mut runs: Vec<EnsembleRun> = pairs
            .map(|(simulator, controller)| EnsembleRun {
                simulator,
                controller,
                scenario: &self.scenario,
                watch: None,
            })
            .collect();
        run_ensemble(&mut runs);
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [kind, count, duration_s] = words.as_slice() {
        let (pace, count) = (Pace::new(duration_s.parse().unwrap()), count.parse().unwrap());
        return match kind.as_str() {
            "exact" => pace.exact(count),
            "differences" => pace.differences(count),
            _ => pace.plain(),
        };
    }
    let pace = Pace::new(10.0);
    let plain = least_ms(|| pace.plain());
    println!("a plain run of 10 s: {plain:.2} ms");
    for count in [1, 4, 8, 16] {
        let (exact, differences) = (least_ms(|| pace.exact(count)), least_ms(|| pace.differences(count)));
        println!(
            "{count:2} parameters: {:.2} plain runs; differences, side by side: {:.2} and the run itself",
            exact / plain,
            differences / plain
        );
    }
}
