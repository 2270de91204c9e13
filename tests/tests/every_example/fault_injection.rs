//! Faults of every channel, on every example, in every precision: the control stays finite and within its limits, and after the
//! fault the machine moves again as if nothing had happened, within a stated time. Good readings give the controls of the bare
//! programs, to the last bit.

use std::path::Path;
use std::sync::Mutex;

use counterpoise_controller::compiled_program::CompiledProgram;
use counterpoise_controller::{COMMON_READINGS, Controller, READINGS, Readings, SampledController};
use counterpoise_export::{FixedRunner, Ranges, plan_fixed_point};
use counterpoise_models::plant::Plant;
use counterpoise_simulate::{PlatformMotion, Scenario, Signal, Simulator, TimeHistory};
use counterpoise_tests::examples;

/// Starts a controller in one kind of numbers.
type Start<'a> = Box<dyn Fn() -> Box<dyn SampledController> + 'a>;

/// Time after the end of a short fault within which the hub moves again as without it, s.
const RECOVERY_S: f64 = 0.6;
/// Time that is added for each second that a fault lasts, s: while the measured output is held, the integral action winds up, and
/// its return takes a time in proportion.
const RECOVERY_PER_FAULT: f64 = 2.0;
/// A loop of position that limits its demanded rate brings the machine back at that rate, from wherever it has run to. So long is
/// its simulation, relative to the time that other machines may take.
const RETURN_SIMULATED: f64 = 12.0;
/// Instant at which a fault begins, s.
const BEGINS_S: f64 = 0.5;
/// Largest difference of the hub's rate from the run without a fault that counts as recovered, rad/s.
const RECOVERED_RAD_S: f64 = 2e-3;

/// Examples with a controller, at least.
pub const EXAMPLES: usize = 8;

/// The effect of a fault on a reading.
#[derive(Debug, Clone, Copy)]
enum Kind {
    NoNumber,
    Infinite,
    FarOut,
    Stuck,
}

const KINDS: [Kind; 4] = [Kind::NoNumber, Kind::Infinite, Kind::FarOut, Kind::Stuck];
/// Lengths of the faults, samples. In single precision and in fixed point the last one is tried alone: the guard has the same steps there.
const LENGTHS: [usize; 2] = [1, 100];
/// Lengths that are tried in every precision if `EVERY_FAULT` is set.
const MORE_LENGTHS: [usize; 6] = [1, 3, 30, 100, 400, 1000];

/// Returns the lengths of the faults in double precision, and in the others.
fn lengths() -> [&'static [usize]; 2] {
    match std::env::var_os("EVERY_FAULT") {
        Some(_) => [&MORE_LENGTHS, &MORE_LENGTHS],
        None => [&LENGTHS, &LENGTHS[1..]],
    }
}

/// A controller whose readings pass a faulty channel.
struct FaultyController {
    inner: Box<dyn SampledController>,
    limit_v: f64,
    channel: usize,
    kind: Kind,
    samples: std::ops::Range<usize>,
    now: usize,
    held: f64,
}

impl SampledController for FaultyController {
    fn reset(&mut self) {
        self.inner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let mut values = readings.to_array();
        if self.samples.contains(&self.now) {
            values[self.channel] = match self.kind {
                Kind::NoNumber => f64::NAN,
                Kind::Infinite => f64::NEG_INFINITY,
                Kind::FarOut => 1e9,
                Kind::Stuck => self.held,
            };
        } else {
            self.held = values[self.channel];
        }
        self.now += 1;
        let control_v = self.inner.step(&Readings::from_array(values));
        assert!(control_v.abs() <= self.limit_v, "{control_v} V, channel {} {:?}", self.channel, self.kind);
        control_v
    }
}

/// A step of the demand, on a platform that heaves and pitches.
pub fn scenario(duration_s: f64) -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: Signal::sine(0.5, 9.0),
        pitch_rate_rad_s: Signal::sine(0.02, 7.0),
        ..PlatformMotion::STILL
    };
    Scenario { demand_rad_s: Signal::step(0.02, 0.1), platform, ..Scenario::at_rest(duration_s) }
}

/// The part of an example's design that is tried.
struct Design {
    plant: Plant,
    controller: Controller,
    /// The largest rate that its loop of position demands, rad/s.
    return_rate_rad_s: Option<f64>,
}

/// Returns the design of an example; `None` if its machine is not to be controlled.
fn design(path: &Path) -> Option<Design> {
    let designed = examples::design_example(path)?;
    Some(Design {
        plant: designed.modelled.plant.clone(),
        controller: designed.made.sampled.controller.clone(),
        return_rate_rad_s: designed.made.demanded_rate.map(|demanded| demanded.rate),
    })
}

pub fn readings(run: &TimeHistory) -> Vec<[f64; READINGS]> {
    let r = &run.readings;
    let columns = [
        &r.demand_rad_s(),
        &r.hub_rate_rad_s(),
        &r.platform_rate_rad_s(),
        &r.platform_accel_m_s2(),
        &r.motor_rate_rad_s(),
        &r.hub_position_rad(),
    ];
    let row = |k: usize| std::array::from_fn(|i| columns.get(i).map_or(0.0, |column| column[k]));
    (0..run.len()).map(row).collect()
}

/// The bare programs give the same controls for good readings, to the last bit: the guard changes nothing.
fn guard_is_transparent(controller: &Controller, history: &[[f64; READINGS]]) {
    let programs = controller.programs();
    let step = CompiledProgram::<f64>::new(&programs.step, programs.state_count());
    let mut memory = vec![0.0; step.memory()];
    memory[..programs.state_count()].copy_from_slice(&programs.initial());
    let mut runner = controller.runner();
    for readings in history {
        let bare = step.run(&mut memory, readings).unwrap();
        assert_eq!(runner.step_array(readings).to_bits(), bare.to_bits());
    }
}

/// One example's machine and controller.
struct Example<'a> {
    name: &'a str,
    controller: &'a Controller,
    return_rate_rad_s: Option<f64>,
    simulator: Simulator,
}

impl<'a> Example<'a> {
    fn new(name: &'a str, design: &'a Design) -> Self {
        let simulator = Simulator::new(&design.plant).unwrap();
        Self { name, controller: &design.controller, return_rate_rad_s: design.return_rate_rad_s, simulator }
    }

    fn drive(&mut self, acting: &mut dyn SampledController) -> TimeHistory {
        let longest = *lengths()[0].last().unwrap();
        let fault_s = longest as f64 * self.controller.sample_period_s();
        let simulated = if self.return_rate_rad_s.is_some() { RETURN_SIMULATED } else { 1.0 };
        let after_s = simulated * self.allowed_s(longest) + 0.2;
        self.simulator.run(acting, &scenario(BEGINS_S + fault_s + after_s)).unwrap()
    }

    /// Returns the time that the recovery after a fault of `length` samples may take, s, beside the way back of a loop of position.
    fn allowed_s(&self, length: usize) -> f64 {
        let fault_s = length as f64 * self.controller.sample_period_s();
        RECOVERY_S + RECOVERY_PER_FAULT * fault_s
    }

    /// Returns the longest recovery after all faults of all channels, as a part of the allowed time.
    fn slowest_recovery(&mut self, numbers: &str, lengths: &[usize], start: &Start) -> f64 {
        let undisturbed = self.drive(start().as_mut());
        let mut slowest = 0.0_f64;
        for channel in 0..COMMON_READINGS {
            for kind in KINDS {
                for &length in lengths {
                    let after = self.run_after_fault((channel, kind, length), start(), &undisturbed);
                    let way_back_s = self.return_rate_rad_s.map_or(0.0, |rate| after.distance_rad / rate);
                    let allowed_s = self.allowed_s(length) + way_back_s;
                    if after.recovery_s > allowed_s {
                        let took_s = after.recovery_s;
                        println!(
                            "{} {numbers} channel {channel} {kind:?} x {length}: {took_s:.2} s of {allowed_s:.2} s",
                            self.name
                        );
                    }
                    slowest = slowest.max(after.recovery_s / allowed_s);
                }
            }
        }
        slowest
    }

    /// Returns what follows a fault.
    fn run_after_fault(
        &mut self,
        (channel, kind, length): (usize, Kind, usize),
        inner: Box<dyn SampledController>,
        undisturbed: &TimeHistory,
    ) -> FaultRecovery {
        let period_s = self.controller.sample_period_s();
        let begins = (BEGINS_S / period_s) as usize;
        let limit_v = self.controller.limit_v() * (1.0 + 1e-6);
        let samples = begins..begins + length;
        let mut faulty = FaultyController { inner, limit_v, channel, kind, samples, now: 0, held: 0.0 };
        let found = self.drive(&mut faulty);
        let off = |k: &usize| {
            let (a, b) = (found.truth.hub_rate_rad_s()[*k], undisturbed.truth.hub_rate_rad_s()[*k]);
            (a - b).abs() >= RECOVERED_RAD_S || a.is_nan()
        };
        let last = (begins + length..found.len()).rfind(off);
        let angles = found.truth.hub_angle_rad().iter().zip(undisturbed.truth.hub_angle_rad());
        let distance_rad = angles.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        FaultRecovery {
            recovery_s: last.map_or(0.0, |k| (k - begins - length) as f64 * period_s),
            distance_rad,
        }
    }
}

/// The consequence of a fault.
struct FaultRecovery {
    /// Time for which the hub still moves otherwise than without the fault, after the fault has ended, s.
    recovery_s: f64,
    /// Distance by which it went from where it would have been, rad.
    distance_rad: f64,
}

/// Tries every fault on an example. Returns the longest recovery as a part of the allowed time, or `None` if the example has no design.
fn slowest_recovery(path: &Path) -> Option<f64> {
    let design = design(path)?;
    let controller = &design.controller;
    let name = examples::name(path);
    let mut example = Example::new(&name, &design);
    let history = readings(&example.drive(&mut controller.runner()));
    guard_is_transparent(controller, &history);
    let known = Ranges::from_readings(controller, std::slice::from_ref(&history), 4.0);
    let fixed = plan_fixed_point(controller, &known, 1.0, history.len()).ok();
    let double: Start = Box::new(|| Box::new(controller.runner()));
    let single: Start = Box::new(|| Box::new(controller.runner_in::<f32>()));
    let mut slowest = example.slowest_recovery("double", lengths()[0], &double);
    slowest = slowest.max(example.slowest_recovery("single", lengths()[1], &single));
    if let Some(fixed) = &fixed {
        let start: Start = Box::new(|| Box::new(FixedRunner::new(fixed)));
        slowest = slowest.max(example.slowest_recovery("fixed", lengths()[1], &start));
    }
    println!("{name}: fixed point {}, largest part of the allowed time {slowest:.3}", fixed.is_some());
    Some(slowest)
}

#[test]
fn every_fault_of_every_channel_is_survived_by_examples() {
    let files = examples::chosen_files();
    let tried = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| {
        let slowest = slowest_recovery(&files[k]);
        tried.lock().unwrap().extend(slowest);
    });
    let tried = tried.into_inner().unwrap();
    assert!(tried.len() >= EXAMPLES, "{}", tried.len());
    assert!(tried.iter().all(|part| *part <= 1.0), "{tried:?}");
}
