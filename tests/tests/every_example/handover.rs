//! A stuck sensor on every example, in every precision: it is flagged, the application hands over to feedback alone, and the loop then moves as
//! the loop of the certified feedback does, within a stated time. Settings that are not numbers change nothing on the way.

use std::path::Path;
use std::sync::Mutex;

use counterpoise_controller::guard::{ALONE, REFUSED};
use counterpoise_controller::{
    COMMON_READINGS, Controller, Number, Readings, Runner, SampledController, SensorUse, Status,
};
use counterpoise_export::{FixedRunner, Ranges, plan_fixed_point};
use counterpoise_models::plant::Plant;
use counterpoise_simulate::{Simulator, TimeHistory};
use counterpoise_tests::examples;

use crate::every_example::fault_injection::{EXAMPLES, readings, scenario};

/// Instant at which the sensor sticks, s.
const STICKS_S: f64 = 0.5;
/// Time from the handover until the hub moves as the loop of feedback alone does, s.
const SETTLES_S: f64 = 0.5;
/// Length of a run, s: the sensor is flagged a second after it stuck.
const DURATION_S: f64 = STICKS_S + 1.1 + SETTLES_S + 0.3;
/// Largest difference of the hub's rate from the loop of feedback alone that counts as settled, rad/s.
const SETTLED_RAD_S: f64 = 2e-3;
/// The first readings are the demand and the measured output: without the output there is no loop, and nothing to hand over to.
const FIRST_OTHER: usize = 2;

/// A controller as an application sees it.
trait Target: SampledController {
    fn set(&mut self, out_of_balance_kg_m: f64);
    fn hand_over(&mut self);
    fn says(&self) -> Status;
    /// Returns what must be said after the handover.
    fn expected_status(&self) -> u32;
}

/// Passes on to what both runners call alike.
macro_rules! pass_on {
    ($expected:expr) => {
        fn set(&mut self, out_of_balance_kg_m: f64) {
            self.set_out_of_balance(out_of_balance_kg_m);
        }

        fn hand_over(&mut self) {
            self.use_sensors(SensorUse::FeedbackAlone);
        }

        fn says(&self) -> Status {
            self.status()
        }

        fn expected_status(&self) -> u32 {
            $expected
        }
    };
}

impl<N: Number> Target for Runner<N>
where
    Self: SampledController,
{
    pass_on!(ALONE | REFUSED);
}

/// A setting in fixed point is an integer, so none can be no number.
impl Target for FixedRunner {
    pass_on!(ALONE);
}

/// The application: it tries a setting that is no number, and hands over as soon as a sensor is flagged.
struct Application<'a> {
    inner: Box<dyn Target + 'a>,
    limit_v: f64,
    channel: usize,
    sticks: usize,
    now: usize,
    held: f64,
}

impl SampledController for Application<'_> {
    fn reset(&mut self) {
        self.inner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let mut values = readings.to_array();
        if self.now < self.sticks {
            self.held = values[self.channel];
        }
        values[self.channel] = self.held;
        if self.now == self.sticks / 2 {
            [f64::NAN, f64::INFINITY].into_iter().for_each(|value| self.inner.set(value));
        }
        let control_v = self.inner.step(&Readings::from_array(values));
        assert!(control_v.abs() <= self.limit_v, "{control_v} V, channel {}", self.channel);
        if self.now > self.sticks && self.inner.says().flags & (0x100 << self.channel) != 0 {
            self.inner.hand_over();
        }
        self.now += 1;
        control_v
    }
}

/// One example's machine and controller.
struct Example {
    controller: Controller,
    simulator: Simulator,
}

type Start<'a> = Box<dyn Fn() -> Box<dyn Target + 'a> + 'a>;

impl Example {
    fn new(plant: &Plant, controller: &Controller) -> Self {
        Self { controller: controller.clone(), simulator: Simulator::new(plant).unwrap() }
    }

    fn drive(&mut self, acting: &mut dyn SampledController) -> TimeHistory {
        self.simulator.run(acting, &scenario(DURATION_S)).unwrap()
    }

    /// Returns the longest time from a handover until the hub moves as with feedback alone, s, over the sensors that can stick.
    fn slowest(&mut self, start: &Start) -> f64 {
        let alone = self.drive(&mut self.controller.feedback_alone().unwrap().runner());
        let channels = FIRST_OTHER..COMMON_READINGS;
        channels.map(|channel| self.settling_s(channel, start(), &alone)).fold(0.0, f64::max)
    }

    fn settling_s<'a>(&mut self, channel: usize, inner: Box<dyn Target + 'a>, alone: &TimeHistory) -> f64 {
        let period_s = self.controller.sample_period_s();
        let sticks = (STICKS_S / period_s) as usize;
        let limit_v = self.controller.limit_v() * (1.0 + 1e-6);
        let mut application = Application { inner, limit_v, channel, sticks, now: 0, held: 0.0 };
        let found = self.drive(&mut application);
        let flags = application.inner.says().flags;
        assert_eq!(
            flags & (ALONE | REFUSED),
            application.inner.expected_status(),
            "channel {channel}: {flags:x}"
        );
        let handed_over = sticks + (1.0 / period_s) as usize;
        let off = |k: &usize| {
            let (a, b) = (found.truth.hub_rate_rad_s()[*k], alone.truth.hub_rate_rad_s()[*k]);
            (a - b).abs() >= SETTLED_RAD_S || a.is_nan()
        };
        let last = (handed_over..found.len()).rfind(off);
        last.map_or(0.0, |k| (k - handed_over) as f64 * period_s)
    }
}

/// Returns the longest settling on an example in every precision, s; `None` if the example has no design.
fn slowest(path: &Path) -> Option<f64> {
    let designed = examples::design_example(path)?;
    let controller = &designed.made.sampled.controller;
    let mut example = Example::new(&designed.modelled.plant, controller);
    let history = readings(&example.drive(&mut controller.runner()));
    let known = Ranges::from_readings(controller, std::slice::from_ref(&history), 4.0);
    let fixed = plan_fixed_point(controller, &known, 1.0, history.len()).ok();
    let double: Start = Box::new(|| Box::new(controller.runner()));
    let single: Start = Box::new(|| Box::new(controller.runner_in::<f32>()));
    let mut all = vec![example.slowest(&double), example.slowest(&single)];
    if let Some(fixed) = &fixed {
        let start: Start = Box::new(|| Box::new(FixedRunner::new(fixed)));
        all.push(example.slowest(&start));
    }
    println!("{}: settled after {all:.3?} s (double, single, fixed point)", examples::name(path));
    all.into_iter().reduce(f64::max)
}

#[test]
fn a_stuck_sensor_is_handed_over_to_feedback_alone() {
    let files = examples::chosen_files();
    let tried = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| {
        let slowest = slowest(&files[k]);
        tried.lock().unwrap().extend(slowest);
    });
    let tried = tried.into_inner().unwrap();
    assert!(tried.len() >= EXAMPLES, "{}", tried.len());
    assert!(tried.iter().all(|settling_s| *settling_s <= SETTLES_S), "{tried:?}");
}
