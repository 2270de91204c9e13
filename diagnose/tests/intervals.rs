//! The identification's 95 % intervals counted: over many machines, noise levels and two sets of sensors they hold the truth
//! about as often as they say.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_diagnose::identification::identify;
use counterpoise_models::parameters::FrictionLaw;
use counterpoise_models::{Parameters, Plant, reference};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

/// Noise of the sensors over the reference's.
const LEVELS: [f64; 4] = [0.03, 0.3, 1.0, 3.0];
/// Machines at each level.
const MACHINES: u64 = 12;

/// A number from -0.5 to 0.5 for each seed and place (splitmix64).
fn spread(seed: u64, place: u64) -> f64 {
    let mut x = (seed * 64 + place + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

/// A machine that is not what its project says, with sensors of a noise level.
fn machine(seed: u64, level: f64) -> Parameters {
    let mut p = reference::rig();
    let lumped = p.lumped.as_mut().unwrap();
    lumped.out_of_balance_kg_m *= 1.0 + 0.3 * spread(seed, 0);
    let grown = 1.0 + 0.4 * spread(seed, 1);
    lumped.hub_inertia_kg_m2 *= grown;
    lumped.beam_inertia_kg_m2 *= grown;
    p.pivot_friction.viscous_nm_s_rad *= 1.0 + 0.6 * spread(seed, 2);
    if let FrictionLaw::Dahl { coulomb_nm, .. } = &mut p.pivot_friction.law {
        *coulomb_nm *= 1.0 + 0.6 * spread(seed, 3);
    }
    let s = &mut p.sensors;
    let always = [&mut s.hub_gyro, &mut s.platform_gyro, &mut s.platform_accelerometer];
    let fitted = s.motor_tachometer.as_mut().into_iter().chain(s.hub_resolver.as_mut());
    always.into_iter().chain(fitted).for_each(|sensor| sensor.noise_rms *= level);
    p
}

/// First moment, inertia, Coulomb and viscous friction at the hub.
fn truth(p: &Parameters) -> [f64; 4] {
    let (lumped, ratio) = (p.lumped.as_ref().unwrap(), p.gearbox.ratio);
    [
        lumped.out_of_balance_kg_m,
        lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2,
        p.pivot_friction.coulomb_nm() + ratio * p.motor_friction.coulomb_nm(),
        p.pivot_friction.viscous_nm_s_rad + ratio.powi(2) * p.motor_friction.viscous_nm_s_rad,
    ]
}

/// A triangle wave of 0.15 rad/s and 2 s for 10 s, in closed loop, with noise and quantisation.
fn triangle(p: &Parameters, seed: u64) -> Recording {
    let mut simulator = Simulator::new(&Plant::from_lumped(p).unwrap()).unwrap();
    let (kp_v_s_rad, ki_v_rad, sample_period_s) = (18.0, 80.0, 1e-3);
    let mut controller = ProportionalIntegral {
        kp_v_s_rad,
        ki_v_rad,
        bias_v: 2.88,
        sample_period_s,
        ..ProportionalIntegral::default()
    };
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s: 2.0 },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(10.0)
    };
    let history = simulator.run(&mut controller, &scenario).unwrap();
    history.readings.recording("triangle", sample_period_s)
}

/// For each unknown, whether its interval holds the truth.
fn intervals_with_truth(recording: &Recording, truth: [f64; 4]) -> [usize; 4] {
    let found = identify(&reference::rig(), &[std::slice::from_ref(recording)]).unwrap();
    let balance = &found.balances[0];
    let four = [balance.out_of_balance_kg_m, balance.inertia_kg_m2, found.coulomb_nm, found.viscous_nm_s_rad];
    [0, 1, 2, 3].map(|k| usize::from(four[k].holds(truth[k])))
}

/// Intervals of four unknowns that held the truth at a level: with all sensors, and with the gyroscopes alone.
fn count_intervals_with_truth(level: f64) -> [[usize; 4]; 2] {
    let mut inside = [[0; 4]; 2];
    for seed in 0..MACHINES {
        let p = machine(seed, level);
        let whole = triangle(&p, seed);
        let mut bare = whole.clone();
        bare.remove(Channel::MotorRate);
        bare.remove(Channel::HubPosition);
        for (sums, recording) in inside.iter_mut().zip([whole, bare]) {
            let one = intervals_with_truth(&recording, truth(&p));
            (0..4).for_each(|k| sums[k] += one[k]);
        }
    }
    inside
}

#[test]
fn intervals_of_95_percent_hold_the_truth_in_about_95_percent() {
    let mut all = 0;
    let each = 4 * MACHINES as usize;
    for level in LEVELS {
        for (sensors, inside) in
            ["all sensors", "gyroscopes alone"].iter().zip(count_intervals_with_truth(level))
        {
            let sum: usize = inside.iter().sum();
            println!("noise x {level}, {sensors}: {inside:?} of {MACHINES}, {sum} of {each}");
            assert!(sum * 100 >= each * 85, "noise x {level}, {sensors}: {inside:?}");
            all += sum;
        }
    }
    let of = 2 * each * LEVELS.len();
    println!("{all} of {of}: {:.1} %", 100.0 * all as f64 / of as f64);
    assert!(all * 100 >= of * 92 && all * 1000 <= of * 995, "{all} of {of}");
}
