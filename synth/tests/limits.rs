//! The limit that a first design names alone is one whose relaxing raises the bandwidth. How often relaxing another one does as well is printed.
#![allow(non_snake_case, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_synth::{
    Bandwidth, BandwidthLimit, Circumstances, ControlLimit, DesignPlant, LimitKind, RequiredMargins,
    Sampling, UsualPlants, UsualReading, first_design,
};

/// Two inertias on a spring with a gyroscope, and everything else that can limit their loop.
#[derive(Debug, Clone, Copy)]
struct Machine {
    mode_hz: f64,
    mode_damping: f64,
    /// Share of the second inertia.
    share: f64,
    sensor_hz: f64,
    delay_samples: usize,
    period_s: f64,
    /// Noise density, rad/s per root of s.
    noise: f64,
    reading_step: f64,
    demand_step: f64,
}

impl Machine {
    fn circumstances(&self) -> Circumstances {
        let w = TAU * self.mode_hz;
        // theta_1'' = u/J_1 - k/J_1 x - d/J_1 x', with k/J_1 = share w^2 and k/J_2 = (1 - share) w^2
        let (mu, d) = (self.share, 2.0 * self.mode_damping * w);
        let A = Mat::from_rows(&[
            &[0.0, 1.0, -1.0],
            &[-mu * w * w, -mu * d - 0.05, mu * d],
            &[(1.0 - mu) * w * w, (1.0 - mu) * d, -(1.0 - mu) * d],
        ]);
        let B = Mat::col(&[0.0, 5.0 / (1.0 - mu), 0.0]);
        let C = Mat::row(&[0.0, 1.0, 0.0]);
        let system = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        let delay_s = self.delay_samples as f64 * self.period_s;
        let plant = DesignPlant {
            hub_sensor: Some(sensor(TAU * self.sensor_hz)),
            delay_s,
            pade_order: 2,
            ..DesignPlant::ideal(system, 0, 0)
        };
        let delay_samples = self.delay_samples;
        Circumstances {
            plant,
            others: Vec::new(),
            within_tolerances: Vec::new(),
            known_absent: Vec::new(),
            usual: UsualPlants::default(),
            usual_reading: UsualReading::default(),
            load_output: None,
            sampling: Sampling { delay_samples, ..Sampling::new(self.period_s, 10.0) },
            control_limit: ControlLimit::OfDrive,
            noise_rms: self.noise / self.period_s.sqrt(),
            reading_step: self.reading_step,
            holding_v: 0.0,
            demand_step: self.demand_step,
            margins: RequiredMargins::default(),
            may_stiffen_modes: true,
            position_gain: None,
            asked_rad_s: None,
            heave: None,
            pitch: None,
        }
    }

    /// The machine with one limit relaxed as an engineer would.
    fn relax_limit(&self, kind: LimitKind) -> Self {
        let mut other = *self;
        match kind {
            LimitKind::SampleRate => {
                (other.period_s, other.delay_samples) = (self.period_s / 4.0, 4 * self.delay_samples);
            }
            LimitKind::Margins => {
                // what is not known would lower the bandwidth again, so some delay stays
                other.delay_samples = self.delay_samples.div_ceil(4);
                other.sensor_hz *= 8.0;
            }
            LimitKind::Resonance => (other.mode_hz, other.mode_damping) = (6.0 * self.mode_hz, 0.2),
            LimitKind::Noise => other.noise /= 8.0,
            LimitKind::Quantisation => other.reading_step /= 8.0,
            LimitKind::Control => other.demand_step /= 8.0,
            LimitKind::AtRest | LimitKind::Tolerances | LimitKind::UsualRanges | LimitKind::Asked => {}
        }
        other
    }

    fn bandwidth(&self) -> Option<Bandwidth> {
        first_design(&self.circumstances()).ok().map(|found| found.bandwidth)
    }
}

fn sensor(w: f64) -> StateSpace {
    let A = Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -1.4 * w]]);
    let (B, C) = (Mat::col(&[0.0, w * w]), Mat::row(&[1.0, 0.0]));
    StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
}

/// Marsaglia's xorshift generator.
struct RandomGenerator(u64);

impl RandomGenerator {
    /// A number between two, even in its logarithm.
    fn draw_between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low * (high / low).powf((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn machine(&mut self) -> Machine {
        Machine {
            mode_hz: self.draw_between(3.0, 300.0),
            mode_damping: self.draw_between(0.005, 0.05),
            share: self.draw_between(0.1, 0.7),
            sensor_hz: self.draw_between(30.0, 500.0),
            delay_samples: self.draw_between(1.0, 6.0) as usize,
            period_s: self.draw_between(2e-4, 5e-3),
            noise: self.draw_between(1e-8, 1e-2),
            reading_step: self.draw_between(1e-8, 1e-1),
            demand_step: self.draw_between(1e-3, 1.0),
        }
    }
}

/// The rise of a bandwidth that counts.
const RISES: f64 = 1.03;
/// The rise by which a limit that is not named counts as one after all. A quicker clock or sensor also helps margins that are spoilt by another
/// cause, and one shape of the weights gives way to the next in steps, so such limits exist.
const OTHERS: f64 = 1.12;
/// Machines of the default run: the first ones that are limited by two different things, and some more.
const FEW: usize = 6;

/// `COUNTERPOISE_LIMITS` has a number of machines, of which the limits that are not named are relaxed as well.
#[test]
fn relaxing_the_limit_that_is_named_raises_the_bandwidth() {
    let asked = std::env::var("COUNTERPOISE_LIMITS").ok().and_then(|text| text.parse().ok());
    let count: usize = asked.unwrap_or(FEW);
    let mut random = RandomGenerator(20_261_125);
    let (mut wrong, mut named) = (Vec::new(), std::collections::BTreeMap::new());
    let (mut unnamed, mut silent) = (0, 0);
    for _ in 0..count {
        let machine = random.machine();
        let Some(found) = machine.bandwidth() else { continue };
        *named.entry(format!("{:?}", found.limited_by)).or_insert(0) += 1;
        let is_checked = |limit: &&BandwidthLimit| asked.is_some() || found.limited_by == [limit.kind];
        for limit in found.limits.iter().filter(is_checked) {
            let relaxed = machine.relax_limit(limit.kind).bandwidth().map_or(0.0, |b| b.bandwidth_rad_s);
            let rise = relaxed / found.bandwidth_rad_s;
            if limit.lifted_rad_s.is_none() {
                unnamed += 1;
                silent += i32::from(rise < OTHERS);
            }
            if found.limited_by == [limit.kind] && limit.lifted_rad_s.is_some() && rise <= RISES {
                let claimed = limit.lifted_rad_s.map(|rate| rate / found.bandwidth_rad_s);
                wrong.push(format!(
                    "{machine:?}\n  {:?}: {:?} {rise:.3}, claimed {claimed:?}",
                    found.limited_by, limit.kind
                ));
            }
        }
    }
    println!(
        "{named:?}; of {unnamed} limits that are not said to limit, {silent} bring nothing when they are relaxed"
    );
    assert!(named.len() >= 2, "{named:?}");
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
}
