//! Faults of every channel, on every example, in every precision: the control stays finite and within its limits, and after the
//! fault the machine moves again as if nothing had happened, within a stated time. Good readings give the controls of the bare
//! programs, to the last bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, non_snake_case)]

use std::path::{Path, PathBuf};

use counterpoise_controller::program::Compiled;
use counterpoise_controller::{Controller, READINGS, Readings, SampledController};
use counterpoise_export::{FixedRunner, Ranges, plan};
use counterpoise_models::plant::Plant;
use counterpoise_pipeline::{model, reduce, synthesise};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_simulate::{PlatformMotion, Scenario, Signal, Simulator, TimeHistory};

/// Starts a controller in one kind of numbers.
type Start<'a> = Box<dyn Fn() -> Box<dyn SampledController> + 'a>;

/// Time after the end of a fault within which the hub moves again as without it, s.
const RECOVERY_S: f64 = 0.5;
/// When a fault begins, s.
const BEGINS_S: f64 = 0.5;
/// Largest difference of the hub's rate from the run without a fault that counts as recovered, rad/s.
const RECOVERED_RAD_S: f64 = 2e-3;

/// What a fault makes of a reading.
#[derive(Debug, Clone, Copy)]
enum Kind {
    NoNumber,
    Infinite,
    FarOut,
    Stuck,
}

const KINDS: [Kind; 4] = [Kind::NoNumber, Kind::Infinite, Kind::FarOut, Kind::Stuck];
/// Lengths of the faults, samples.
const LENGTHS: [usize; 2] = [1, 100];

/// A controller whose readings pass a faulty channel.
struct Faulty {
    inner: Box<dyn SampledController>,
    limit_v: f64,
    channel: usize,
    kind: Kind,
    samples: std::ops::Range<usize>,
    now: usize,
    held: f64,
}

impl SampledController for Faulty {
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

fn scenario(duration_s: f64) -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: Signal::sine(0.5, 9.0),
        pitch_rate_rad_s: Signal::sine(0.02, 7.0),
        ..PlatformMotion::STILL
    };
    Scenario { demand_rad_s: Signal::step(0.02, 0.1), platform, ..Scenario::still(duration_s) }
}

/// Every project below `examples/` that asks for a controller.
fn designs() -> Vec<(String, Plant, Controller)> {
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples")];
    let mut files: Vec<PathBuf> = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => open.push(path),
                false if path.extension().is_some_and(|ending| ending == "toml") => files.push(path),
                false => {}
            }
        }
    }
    files.sort();
    files.iter().filter_map(|path| design(path)).collect()
}

fn design(path: &Path) -> Option<(String, Plant, Controller)> {
    let document = Document::from_bytes(&std::fs::read(path).unwrap(), "project.toml").ok()?;
    let read = |all: Attachments, name: String| match std::fs::read(path.parent().unwrap().join(&name)) {
        Ok(bytes) => all.with(&name, bytes),
        Err(_) => all,
    };
    let attached = document.attachments().into_iter().fold(Attachments::none(), read);
    let project = Project::resolve_for(&document, &attached, Purpose::Synth).ok()?.project;
    project.synth.as_ref()?;
    let modelled = model(&project).unwrap();
    let reduced = reduce(&project, &modelled).unwrap();
    let made = synthesise(&project, &modelled, &reduced).unwrap();
    Some((path.display().to_string(), modelled.plant, made.sampled.controller))
}

fn readings(run: &TimeHistory) -> Vec<[f64; READINGS]> {
    let r = &run.readings;
    let columns = [
        &r.demand_rad_s,
        &r.hub_rate_rad_s,
        &r.platform_rate_rad_s,
        &r.platform_accel_m_s2,
        &r.motor_rate_rad_s,
        &r.hub_position_rad,
    ];
    (0..run.len()).map(|k| columns.map(|column| column[k])).collect()
}

/// The bare programs give the same controls for good readings, to the last bit: the guard changes nothing.
fn guard_is_transparent(controller: &Controller, history: &[[f64; READINGS]]) {
    let programs = controller.programs();
    let step = Compiled::<f64>::new(&programs.step, programs.state_count());
    let mut memory = vec![0.0; step.memory()];
    memory[..programs.state_count()].copy_from_slice(&programs.initial());
    let mut runner = controller.runner();
    for readings in history {
        let bare = step.run(&mut memory, readings).unwrap();
        assert_eq!(runner.step_array(readings).to_bits(), bare.to_bits());
    }
}

#[test]
fn every_fault_of_every_channel_is_survived_by_every_example() {
    let designs = designs();
    assert!(designs.len() > 5);
    let (mut runs, mut slowest_s) = (0, 0.0_f64);
    for (name, plant, controller) in &designs {
        let period_s = controller.sample_period_s();
        let length_s = BEGINS_S + *LENGTHS.last().unwrap() as f64 * period_s + RECOVERY_S + 0.2;
        let mut simulator = Simulator::new(plant).unwrap();
        let mut drive =
            |acting: &mut dyn SampledController| simulator.run(acting, &scenario(length_s)).unwrap();
        let expected = drive(&mut controller.runner());
        let history = readings(&expected);
        guard_is_transparent(controller, &history);
        let known = Ranges::from_readings(controller, std::slice::from_ref(&history), 4.0);
        let fixed = plan(controller, &known, 1.0, history.len()).ok();
        let acting: Vec<(&str, Start)> = vec![
            ("double", Box::new(|| Box::new(controller.runner()))),
            ("single", Box::new(|| Box::new(controller.runner_in::<f32>()))),
        ];
        let with_fixed = fixed.as_ref().map(|fixed| {
            let start: Start = Box::new(|| Box::new(FixedRunner::new(fixed)));
            ("fixed", start)
        });
        for (numbers, start) in acting.into_iter().chain(with_fixed) {
            let undisturbed = drive(start().as_mut());
            for channel in 0..READINGS {
                for kind in KINDS {
                    for length in LENGTHS {
                        let begins = (BEGINS_S / period_s) as usize;
                        let mut faulty = Faulty {
                            inner: start(),
                            limit_v: controller.limit_v() * (1.0 + 1e-6),
                            channel,
                            kind,
                            samples: begins..begins + length,
                            now: 0,
                            held: 0.0,
                        };
                        let found = drive(&mut faulty);
                        let off = |k: &usize| {
                            let (a, b) =
                                (found.truth.hub_rate_rad_s[*k], undisturbed.truth.hub_rate_rad_s[*k]);
                            (a - b).abs() >= RECOVERED_RAD_S || a.is_nan()
                        };
                        let last = (begins + length..found.len()).rfind(off);
                        let took_s = last.map_or(0.0, |k| (k - begins - length) as f64 * period_s);
                        let largest = (0..found.len())
                            .map(|k| {
                                (found.truth.hub_rate_rad_s[k] - undisturbed.truth.hub_rate_rad_s[k]).abs()
                            })
                            .fold(0.0, f64::max);
                        if took_s > RECOVERY_S {
                            println!(
                                "{name} {numbers} channel {channel} {kind:?} x {length}: {took_s:.2} s, {largest:.4} rad/s"
                            );
                        }
                        slowest_s = slowest_s.max(took_s);
                        runs += 1;
                    }
                }
            }
        }
        println!("{name}: fixed point {}, slowest recovery so far {slowest_s:.3} s", fixed.is_some());
    }
    println!("{runs} faults on {} examples, slowest recovery {slowest_s:.3} s", designs.len());
    assert!(slowest_s <= RECOVERY_S, "{slowest_s}");
}
