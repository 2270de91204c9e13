//! Replay of the practice machines, recorded by an independent simulator: with the concealed truth entered by hand
//! every channel fits to within 1.5 times the floor.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::{controller, recording};
use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{FeedbackSignal, MapPoint, Parameters, Plant, Ripple, reference};
use counterpoise_recordings::Channel;
use counterpoise_simulate::replay::COMPARED;
use counterpoise_simulate::replay::{
    ReplayMode, ReplayRequest, ReplayVariant, Replayer, SelectedReplay, replay_each,
};
use counterpoise_simulate::{Detail, Imperfections, Replay, ReplayLoop, Scenario, Signal, Simulator, replay};

/// RMS error over floor that counts as a fit.
const FIT: f64 = 1.5;

const EXPERIMENTS: [&str; 4] = ["triangle", "steps", "road", "multisine"];

fn truth(machine: &str) -> Parameters {
    let mut rig = reference::rig();
    match machine {
        "p01" => {
            rig.pivot_friction.static_ratio = 1.55;
            rig.pivot_friction.stribeck_rate_rad_s = 0.012;
        }
        "p02" => rig.gearbox.backlash_rad = 0.006,
        "p03" => rig.amplifier.map = measured_map(),
        "p04" => rig.lumped.as_mut().unwrap().out_of_balance_kg_m = 186.0,
        "p05" => rig.motor.cogging = Ripple { amplitude: 0.16, order: 6.0, phase_rad: 0.7 },
        "p06" => rig.interface.output_delay_samples = 6,
        "p07" => {
            let lumped = rig.lumped.as_mut().unwrap();
            lumped.position_stiffness_nm_rad = 900.0;
            lumped.position_stiffness_centre_rad = -0.04;
        }
        _ => {}
    }
    if is_nearly_balanced(machine) {
        rig.lumped.as_mut().unwrap().out_of_balance_kg_m = 20.0;
    }
    rig
}

fn measured_map() -> Vec<MapPoint> {
    let input = [0.12, 0.22, 0.28, 0.34, 0.42, 0.51, 0.57, 0.8, 1.04, 1.13, 1.2, 1.27, 1.34, 2.0];
    let current = [0.27, 0.48, 0.6, 0.7, 0.83, 0.96, 1.08, 1.86, 2.79, 3.04, 3.3, 3.53, 3.81, 6.0];
    input.into_iter().zip(current).map(|(input_v, current_a)| MapPoint { input_v, current_a }).collect()
}

fn is_nearly_balanced(machine: &str) -> bool {
    matches!(machine, "p02" | "p03")
}

fn closed_loop(machine: &str) -> ReplayLoop {
    let bias_v = if is_nearly_balanced(machine) { 0.38 } else { 2.88 };
    ReplayLoop::Closed(ProportionalIntegral { bias_v, ..controller() }.into())
}

fn replay_experiment(machine: &str, experiment: &str, control: &ReplayLoop) -> Replay {
    let recording = recording(&format!("{machine}/{experiment}"));
    replay(&truth(machine), &recording, control).unwrap()
}

fn assert_fits(replay: &Replay, channels: &[Channel], what: &str) {
    for fit in replay.channels.iter().filter(|fit| channels.contains(&fit.channel)) {
        let ratio = fit.residual_over_floor();
        assert!(ratio <= FIT, "{what}: {} at {ratio:.2} floors", fit.channel.name());
    }
}

#[test]
fn the_machine_as_modelled_fits_on_every_channel_in_closed_loop() {
    for experiment in EXPERIMENTS {
        let replay = replay_experiment("p08", experiment, &closed_loop("p08"));
        assert_eq!(replay.channels.len(), COMPARED.len());
        assert_fits(&replay, &COMPARED, experiment);
    }
}

#[test]
fn the_true_machines_fit_on_every_channel_in_closed_loop() {
    for machine in ["p01", "p04", "p05", "p06", "p07"] {
        for experiment in EXPERIMENTS {
            let replay = replay_experiment(machine, experiment, &closed_loop(machine));
            assert_fits(&replay, &COMPARED, &format!("{machine} {experiment}"));
        }
    }
}

/// Hardly out of balance, these two cross their gap: in closed loop two runs that differ in sensor noise alone part
/// by many floors, so they are judged under the recorded control, which does not feed the parting back. With the
/// platform in motion even the noise of its sensors decides when the gap is crossed: `road` is left out.
#[test]
fn the_hunting_machines_fit_in_open_loop() {
    for machine in ["p02", "p03"] {
        for experiment in ["triangle", "steps", "multisine"] {
            let replay = replay_experiment(machine, experiment, &ReplayLoop::Open);
            let rates = [Channel::HubRate, Channel::MotorRate];
            assert_fits(&replay, &rates, &format!("{machine} {experiment}"));
        }
    }
}

/// Recordings that begin in the middle of the motion, of loops whose sensor is of each kind, with a delay and without.
#[test]
fn recordings_that_begin_in_motion_fit_from_their_first_sample_on() {
    let all = [FeedbackSignal::HubRate, FeedbackSignal::RelativeRate, FeedbackSignal::MotorRate];
    for (measured, delay_s) in all.into_iter().flat_map(|measured| [(measured, 0.0), (measured, 4.5e-3)]) {
        let mut machine = reference::rig();
        machine.sensors.measured = measured;
        machine.sensors.hub_gyro.delay_s = delay_s;
        if measured == FeedbackSignal::MotorRate {
            machine.sensors.hub_gyro.natural_frequency_rad_s = f64::INFINITY;
        }
        let loop_gains = ProportionalIntegral { kp_v_s_rad: 9.0, bias_v: 2.88, ..controller() };
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s: 2.0 },
            imperfections: Imperfections::NoiseAndQuantisation { seed: 3 },
            detail: Detail::Recording,
            ..Scenario::at_rest(8.0)
        };
        let mut simulator = Simulator::new(&Plant::from_lumped(&machine).unwrap()).unwrap();
        let history = simulator.run(&mut loop_gains.clone(), &scenario).unwrap();
        let whole = history.readings.recording("triangle", 1e-3);
        let control = ReplayLoop::Closed(loop_gains.into());
        for from in [1370, 2900] {
            let replayed = replay(&machine, &whole.part(from..8000), &control).unwrap();
            let worst = largest_ratio(&replayed);
            assert!(worst < 1.3, "{measured:?}, late by {delay_s} s, from sample {from}: {worst:.2} floors");
        }
    }
}

fn select_replay(parameters: &Parameters, machine: &str, experiment: &str) -> SelectedReplay {
    let recording = recording(&format!("{machine}/{experiment}"));
    let replayer = Replayer::new(parameters, &recording).unwrap();
    replayer.replay_free_or_windowed(parameters, &closed_loop(machine)).unwrap()
}

fn largest_ratio(replay: &Replay) -> f64 {
    replay.channels.iter().map(|fit| fit.residual_over_floor()).fold(0.0, f64::max)
}

const UNSEEN: [&str; 3] = ["unseen/triangle", "unseen/steps", "unseen/road"];

/// By itself the replay takes windows where the machine hunts, and only there; the true machine fits on every channel, the control too.
#[test]
fn the_true_machines_are_followed_by_themselves() {
    for machine in ["p01", "p02", "p03", "p05", "p06", "p08"] {
        for experiment in UNSEEN {
            let found = select_replay(&truth(machine), machine, experiment);
            assert_eq!(found.replay.channels.len(), COMPARED.len());
            assert_fits(&found.replay, &COMPARED, &format!("{machine} {experiment}"));
            let hunts = is_nearly_balanced(machine);
            assert_eq!(
                found.mode != ReplayMode::Free,
                hunts,
                "{machine} {experiment} {:?}",
                found.divergence
            );
        }
    }
}

/// Windows do not flatter: a model that lacks something is followed from start to end, and where the machine hunts it is far off in
/// windows, too.
#[test]
fn a_wrong_model_is_not_made_to_look_good() {
    for machine in ["p04", "p05", "p06", "p07"] {
        for experiment in UNSEEN {
            let found = select_replay(&truth("p08"), machine, experiment);
            assert_eq!(found.mode, ReplayMode::Free, "{machine} {experiment} {:?}", found.divergence);
            assert!(largest_ratio(&found.replay) > 3.0, "{machine} {experiment}");
        }
    }
    for machine in ["p02", "p03"] {
        for experiment in UNSEEN {
            let mut nominal = truth(machine);
            nominal.gearbox.backlash_rad = truth("p08").gearbox.backlash_rad;
            nominal.amplifier.map.clear();
            let found = select_replay(&nominal, machine, experiment);
            assert!(
                largest_ratio(&found.replay) > 30.0,
                "{machine} {experiment}: {}",
                largest_ratio(&found.replay)
            );
        }
    }
}

#[test]
fn the_wrong_machine_does_not_fit() {
    let recording = recording("p04/triangle");
    let replay = replay(&reference::rig(), &recording, &closed_loop("p04")).unwrap();
    let control = replay.channels.iter().find(|fit| fit.channel == Channel::Control).unwrap();
    assert!(control.rms_error > 20.0 * control.floor);
}

#[test]
fn variants_replayed_side_by_side_leave_the_same_bytes_as_each_alone() {
    for (machine, experiment) in
        [("p01", "steps"), ("p02", "triangle"), ("p05", "road"), ("p08", "multisine")]
    {
        let recording = recording(&format!("{machine}/{experiment}")).part(0..3000);
        let truth = truth(machine);
        let replayer = Replayer::new(&truth, &recording).unwrap();
        for control in [closed_loop(machine), ReplayLoop::Open] {
            let start = replayer.replay(&truth, &control).unwrap().start;
            let mechanisms: Vec<Parameters> = (0..6)
                .map(|k| {
                    let mut other = truth.clone();
                    other.pivot_friction.viscous_nm_s_rad *= 1.0 + 0.1 * f64::from(k);
                    other.gearbox.stiffness_nm_rad *= 1.0 + 0.05 * f64::from(k);
                    other
                })
                .collect();
            let steps = |k: usize| (k > 2).then(|| std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 }));
            let variant = |(k, parameters)| ReplayVariant { parameters, start: &start, steps: steps(k) };
            let variants: Vec<ReplayVariant> = mechanisms.iter().enumerate().map(variant).collect();
            let requests = variants.iter().map(|variant| ReplayRequest {
                replayer: &replayer,
                control: &control,
                variant: *variant,
            });
            let together = replay_each(&requests.collect::<Vec<_>>());
            for (variant, together) in variants.iter().zip(together) {
                let alone = match &variant.steps {
                    None => replayer.replay_from(variant.parameters, &control, &start),
                    Some(steps) => replayer.replay_nudged(variant.parameters, &control, &start, steps),
                };
                assert_eq!(format!("{:?}", together.unwrap()), format!("{:?}", alone.unwrap()), "{machine}");
            }
        }
    }
}
