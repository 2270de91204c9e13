//! Random mechanisms and controllers: the stability certificate of each, against an independent simulator.
//!
//! A certificate contradicts a run if it says "stable" and the run moves more than two noise floors at rest, or grows in motion.

use std::f64::consts::TAU;

use counterpoise_controller::{READINGS, Runner};
use counterpoise_models::plant::Plant;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_pipeline::studies::certificate::{certified_cases, certify_controller};
use counterpoise_pipeline::{PlantModel, SynthesisedDesign, build_plant_model, reduce_plant, synthesise};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{
    AdaptationMethod, AdaptationOptions, AdaptationRuns, AdaptationUse, ObserverFriction, ObserverOptions,
    ScheduleLaw, ScheduleOptions,
};
use counterpoise_synth::{Drives, Weight};
use counterpoise_verify::Procedure;
use counterpoise_verify::certificate::{CaseCertificate, CertifiedCase, Stability, StabilityCertificate};
use counterpoise_verify::signals::period::fundamental_hz;

use crate::sealed::Dice;
use crate::sealed::machine::{Gyro, Machine, Platform, STATES};
use crate::sealed::truth::machine;

/// Length of a run, s, after the time in which the controller settles, s.
const RUN_S: f64 = 20.0;
const SETTLE_S: f64 = 3.0;
/// Steps of the independent integrator a sample.
const STEPS: usize = 16;

/// Figures of a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunObservation {
    /// RMS of the hub's rate about its mean, rad/s: over the whole run, and its second half over its first.
    pub rms: f64,
    pub growth: f64,
    /// Half the range of the hub's rate, rad/s, and the frequency of its crossings, Hz, over the second half.
    pub amplitude: f64,
    pub hz: f64,
}

/// One mechanism with its controller, what the certificate says, and what the runs show.
#[derive(Debug, Clone)]
pub struct CertificateRow {
    pub seed: u64,
    pub blocks: String,
    pub certificate: CaseCertificate,
    pub rest: RunObservation,
    pub motion: RunObservation,
    /// If a limit cycle is certified: what stays after the mechanism was set moving at its amplitude.
    pub kicked: Option<RunObservation>,
}

impl CertificateRow {
    /// Returns whether the runs stay quiet: below two noise floors at rest, and without growth in motion.
    pub fn is_quiet(&self) -> bool {
        self.rest.rms <= 2.0 * self.certificate.noise_floor_rad_s && self.motion.growth <= 1.5
    }

    pub fn is_stable(&self) -> bool {
        self.certificate.stability == Stability::Stable
    }

    pub fn contradicts(&self) -> bool {
        self.is_stable() && !self.is_quiet()
    }

    /// Returns whether a certified limit cycle stays in the independent simulator; `None` if none is certified.
    pub fn is_confirmed(&self) -> Option<bool> {
        self.kicked.map(|kicked| kicked.rms > self.certificate.noise_floor_rad_s)
    }

    /// Returns the relative errors of the certified limit cycle's amplitude and frequency; `None` if the certificate or the run has none. A
    /// mechanism with a limit cycle can have a second motion beside it, so both start from the same one.
    pub fn cycle_errors(&self) -> Option<[f64; 2]> {
        let Stability::LimitCycle { amplitude_rad_s, frequency_hz } = self.certificate.stability else {
            return None;
        };
        let kicked = self.kicked.filter(|_| self.is_confirmed() == Some(true))?;
        Some([amplitude_rad_s / kicked.amplitude - 1.0, frequency_hz / kicked.hz - 1.0])
    }
}

/// Returns the trial of a seed with the load that the controller was designed for; `None` if no controller exists for its weights.
pub fn trial(seed: u64, base: &Project) -> Option<CertificateRow> {
    let mut dice = Dice::new(seed);
    let (project, blocks) = draw_case(base, &mut dice);
    let drawn = DrawnDesign::new(project)?;
    let mut alone = drawn.project.clone();
    if let Some(synth) = &mut alone.synth {
        synth.options.schedule = None;
    }
    let found = drawn.certify(&alone, seed);
    let plant = &drawn.modelled.plant;
    let controller = drawn.made.sampled.controller.runner();
    Some(drawn.observe(
        CertificateRow::new(seed, blocks, found.cases[0].clone()),
        plant,
        &controller,
        &mut dice,
    ))
}

/// Returns the trials of a seed with every other load of its schedule, of which the controller is told; none without a schedule.
pub fn scheduled_trials(seed: u64, base: &Project) -> Vec<CertificateRow> {
    let (project, blocks) = draw_case(base, &mut Dice::new(seed));
    let has_schedule = project.synth.as_ref().is_some_and(|synth| synth.options.schedule.is_some());
    let Some(drawn) = has_schedule.then(|| DrawnDesign::new(project)).flatten() else { return Vec::new() };
    let cases = certified_cases(&drawn.project, &drawn.modelled, &drawn.made)
        .unwrap_or_else(|error| panic!("{seed}: {error}"));
    let found = drawn.certify(&drawn.project, seed);
    let mut dice = Dice::new(seed + SCHEDULED);
    let of_setting = |(case, certificate): (&CertifiedCase, &CaseCertificate)| {
        let mut controller = drawn.made.sampled.controller.runner();
        controller.set_out_of_balance(case.out_of_balance_kg_m);
        let row = CertificateRow::new(seed, format!("{blocks}, {}", case.name), certificate.clone());
        drawn.observe(row, &case.plant, &controller, &mut dice)
    };
    cases.iter().zip(&found.cases).skip(1).map(of_setting).collect()
}

/// What is added to a seed for the noise of the runs with the other loads of a schedule.
const SCHEDULED: u64 = 1_000_000;

impl CertificateRow {
    fn new(seed: u64, blocks: String, certificate: CaseCertificate) -> Self {
        let (rest, motion) = (RunObservation::default(), RunObservation::default());
        Self { seed, blocks, certificate, rest, motion, kicked: None }
    }
}

/// A mechanism and a controller that were drawn, designed.
struct DrawnDesign {
    project: Project,
    modelled: PlantModel,
    made: SynthesisedDesign,
    procedure: Procedure,
}

impl DrawnDesign {
    fn new(project: Project) -> Option<Self> {
        let modelled = build_plant_model(&project).ok()?;
        let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).ok()?).ok()?;
        let procedure = Procedure { road: None, ..project.verify.as_ref()?.procedure.clone() };
        Some(Self { project, modelled, made, procedure })
    }

    fn certify(&self, project: &Project, seed: u64) -> StabilityCertificate {
        certify_controller(project, &self.modelled, &self.made, &self.procedure)
            .unwrap_or_else(|error| panic!("{seed}: {error}"))
    }

    /// Runs the controller on the independent simulator at rest, in motion, and set moving in a certified limit cycle.
    fn observe(
        &self,
        mut row: CertificateRow,
        plant: &Plant,
        controller: &Runner,
        dice: &mut Dice,
    ) -> CertificateRow {
        let parameters = plant.parameters();
        let truth = Machine { moment: plant.body().out_of_balance_kg_m, ..machine(parameters) };
        let still = |_: f64| Platform::default();
        let moving = |t: f64| platform_at(&self.procedure, t);
        row.rest = run(&truth, parameters, controller, &still, Start::Rest, dice);
        row.motion = run(&truth, parameters, controller, &moving, Start::Rest, dice);
        let kick = start(&row.certificate);
        row.kicked = kick.map(|start| run(&truth, parameters, controller, &still, start, dice));
        row
    }
}

/// The start of the motion of a run, once the controller has settled.
#[derive(Debug, Clone, Copy)]
enum Start {
    /// Not at all.
    Rest,
    /// With this rate of hub, beam and motor, the gear's teeth moving along, rad/s.
    Rate(f64),
    /// By three periods of a sine that is added to the control.
    Burst { volts: f64, hz: f64 },
}

/// Returns how the certified limit cycle was started in the product's simulator; `None` if none is certified. One that its run from rest meets starts
/// at its amplitude.
fn start(certificate: &CaseCertificate) -> Option<Start> {
    let Stability::LimitCycle { amplitude_rad_s, .. } = certificate.stability else { return None };
    let own = certificate.orbits.iter().find(|orbit| orbit.amplitude_rad_s == amplitude_rad_s);
    Some(own.map_or(Start::Rate(amplitude_rad_s), |orbit| Start::Burst {
        volts: orbit.burst_v,
        hz: orbit.start_hz,
    }))
}

/// A mechanism and a controller from seeded numbers: sizes, friction, weights, observer, schedule and adaptation.
fn draw_case(base: &Project, dice: &mut Dice) -> (Project, String) {
    let mut project = base.clone();
    let mut blocks = Vec::new();
    mechanism(&mut project.plant, dice);
    let synth = project.synth.as_mut().expect("the base project designs a controller");
    if let Weight::ZeroPoleGain { gain, .. } = &mut synth.specification.feedback.error {
        *gain *= log_uniform(dice, 0.5, 2.0);
    }
    if dice.draw_below(2) == 0 {
        blocks.push("observer");
        synth.options.observer = Some(observer(&project.plant, dice));
    }
    match dice.draw_below(4) {
        0 => {
            blocks.push("gain schedule");
            synth.options.schedule = Some(schedule(ScheduleLaw::Gain));
        }
        1 => {
            blocks.push("redesigns");
            synth.options.schedule = Some(schedule(ScheduleLaw::Redesign));
        }
        _ => {}
    }
    if dice.draw_below(3) == 0 {
        blocks.push("adaptation");
        synth.options.adaptation = Some(adaptation(dice.draw_below(3)));
    }
    (project, blocks.join(", "))
}

fn log_uniform(dice: &mut Dice, low: f64, high: f64) -> f64 {
    low * (high / low).powf(dice.uniform(0.0, 1.0))
}

fn mechanism(plant: &mut Parameters, dice: &mut Dice) {
    let lumped = plant.lumped.as_mut().expect("the base project is lumped");
    lumped.hub_inertia_kg_m2 *= log_uniform(dice, 0.6, 1.6);
    lumped.beam_inertia_kg_m2 *= log_uniform(dice, 0.6, 1.6);
    lumped.out_of_balance_kg_m *= [0.0, 0.4, 1.0][dice.draw_below(3)];
    plant.gearbox.stiffness_nm_rad *= log_uniform(dice, 0.5, 2.0);
    plant.gearbox.backlash_rad *= [0.0, 0.5, 1.0, 2.0][dice.draw_below(4)];
    plant.sensors.hub_gyro.noise_rms *= log_uniform(dice, 0.3, 2.0);
    for friction in [&mut plant.motor_friction, &mut plant.pivot_friction] {
        friction.law.scale_coulomb(log_uniform(dice, 0.3, 3.0));
        friction.scale_presliding_stiffness(log_uniform(dice, 0.3, 3.0));
        friction.viscous_nm_s_rad *= log_uniform(dice, 0.5, 2.0);
    }
}

/// An observer whose parameters were identified more or less well.
fn observer(plant: &Parameters, dice: &mut Dice) -> ObserverOptions {
    let wrong = [0.05, 0.2, 0.7][dice.draw_below(3)];
    let mut identified = |friction: &counterpoise_models::Friction| {
        let mut own = friction.clone();
        own.law.scale_coulomb((wrong * dice.uniform(-1.0, 1.0)).exp());
        own.scale_presliding_stiffness((wrong * dice.uniform(-1.0, 1.0)).exp());
        own
    };
    let (motor, pivot) = (identified(&plant.motor_friction), identified(&plant.pivot_friction));
    ObserverOptions {
        drives: if dice.draw_below(5) == 0 { Drives::Demand } else { Drives::MeasuredRate },
        share: dice.uniform(0.4, 1.0),
        motor: Some(motor),
        pivot: Some(pivot),
        model: ObserverFriction::Dahl,
        sign_rate_rad_s: 0.01,
        learning: None,
    }
}

fn schedule(law: ScheduleLaw) -> ScheduleOptions {
    ScheduleOptions { configurations: Vec::new(), factors: vec![0.5, 1.4], law }
}

fn adaptation(which: usize) -> AdaptationOptions {
    let method =
        [AdaptationMethod::Gradient, AdaptationMethod::WindowedMean, AdaptationMethod::Recursive][which];
    let trial = AdaptationRuns { duration_s: 20.0, changes: vec![1.0], amplifier_curve: Vec::new() };
    AdaptationOptions {
        method,
        window_s: 2.0,
        memory_s: 2.0,
        dead_band_m_s2: Some(0.1),
        filter_s: 0.02,
        hold_band: Some(0.0),
        step: 0.002,
        half_rate_rad_s: 5e-3,
        rate_limit_kg_m_s: 400.0,
        trial,
        use_in_code: AdaptationUse::Exported,
    }
}

/// Heave and pitch of the procedure.
fn platform_at(procedure: &Procedure, t: f64) -> Platform {
    let pitch = &procedure.pitch;
    let w = TAU * pitch.frequency_hz;
    Platform {
        angle: pitch.amplitude / w * (1.0 - (w * t).cos()),
        rate: pitch.at(t),
        acceleration: pitch.amplitude * w * (w * t).cos(),
        heave: procedure.heave.at(t),
    }
}

/// The exported controller on the independent simulator, with noise and converters. Once it has settled, the motion starts.
fn run(
    truth: &Machine,
    p: &Parameters,
    controller: &Runner,
    platform: &dyn Fn(f64) -> Platform,
    start: Start,
    dice: &mut Dice,
) -> RunObservation {
    let (period, mut runner, mut x) = (p.interface.sample_period_s, controller.clone(), truth.at_rest());
    let samples = ((SETTLE_S + RUN_S) / period) as usize;
    let mut rates = Vec::with_capacity(samples);
    let ideal = |s: &Option<counterpoise_models::Sensor>| {
        let ideal = Channel { volts: 1.0, noise: 0.0 };
        s.as_ref().map_or(ideal, |s| Channel { volts: s.scale_v_unit, noise: s.noise_rms })
    };
    let others = [ideal(&p.sensors.motor_tachometer), ideal(&p.sensors.hub_resolver)];
    let settled = (SETTLE_S / period) as usize;
    for k in 0..samples {
        let t = k as f64 * period;
        let now = platform(t);
        if let Start::Rate(kick_rad_s) = start
            && k == settled
        {
            x[MOTOR_RATE] += p.gearbox.ratio * kick_rad_s;
            x[HUB_RATE] += kick_rad_s;
            x[BEAM_RATE] += kick_rad_s;
        }
        let bits = p.interface.input_bits;
        let sensed = |gyro: &Gyro, value: f64, dice: &mut Dice| {
            read(Channel { volts: gyro.volts, noise: gyro.noise }, value, bits, dice)
        };
        let readings: [f64; READINGS] = [
            0.0,
            sensed(&truth.hub_gyro, x[10], dice),
            sensed(&truth.platform_gyro, x[12], dice),
            sensed(&truth.accelerometer, x[14], dice),
            read(others[0], x[3], bits, dice),
            read(others[1], x[4] - now.angle, bits, dice),
            0.0,
        ];
        let control = quantise(runner.step_array(&readings) + added_v(start, t), p.interface.output_bits);
        let h = period / STEPS as f64;
        for s in 0..STEPS {
            let from = t + s as f64 * h;
            x = truth.step(from, h, &x, control, [0.0, 0.5, 1.0].map(|c| platform(from + c * h)));
        }
        if !x.iter().all(|value| value.is_finite()) {
            return RunObservation { rms: f64::INFINITY, growth: f64::INFINITY, ..RunObservation::default() };
        }
        if t >= SETTLE_S {
            rates.push(x[HUB_RATE]);
        }
    }
    judge_rates(&rates, period)
}

/// Returns what is added to the control, V.
fn added_v(start: Start, t: f64) -> f64 {
    match start {
        Start::Burst { volts, hz } if (0.0..3.0 / hz).contains(&(t - SETTLE_S)) => {
            volts * (TAU * hz * (t - SETTLE_S)).sin()
        }
        _ => 0.0,
    }
}

/// The rates of motor, hub and beam among the states.
const MOTOR_RATE: usize = 3;
const HUB_RATE: usize = 5;
const BEAM_RATE: usize = 7;
const _: () = assert!(BEAM_RATE < STATES);

fn quantise(value: f64, bits: u32) -> f64 {
    let step = 20.0 / f64::from(bits).exp2();
    ((value / step).round() * step).clamp(-10.0, 10.0)
}

/// The reading of a sensor per unit, V, and its noise, units.
#[derive(Clone, Copy)]
struct Channel {
    volts: f64,
    noise: f64,
}

fn read(Channel { volts, noise }: Channel, value: f64, bits: u32, dice: &mut Dice) -> f64 {
    quantise((value + noise * dice.normal()) * volts, bits) / volts
}

fn judge_rates(rates: &[f64], period: f64) -> RunObservation {
    let rms = |part: &[f64]| {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        (part.iter().map(|rate| (rate - mean).powi(2)).sum::<f64>() / part.len() as f64).sqrt()
    };
    let (early, late) = rates.split_at(rates.len() / 2);
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    let high = late.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = late.iter().copied().fold(f64::INFINITY, f64::min);
    // crossings with a band of a quarter of the range, which noise does not cross
    let band = 0.25 * (high - low);
    let (mut above, mut count, mut first, mut last) = (false, 0, 0.0, 0.0);
    for (k, rate) in late.iter().enumerate() {
        if !above && *rate > mean + band {
            above = true;
            if count == 0 {
                first = k as f64;
            }
            (count, last) = (count + 1, k as f64);
        } else if above && *rate < mean - band {
            above = false;
        }
    }
    let crossed = if count > 1 { f64::from(count - 1) / ((last - first) * period) } else { 0.0 };
    // harmonics can cross the band as well
    let hz = fundamental_hz(late, period).filter(|hz| *hz < 0.9 * crossed).unwrap_or(crossed);
    RunObservation { rms: rms(rates), growth: rms(late) / rms(early), amplitude: 0.5 * (high - low), hz }
}

/// Returns whether the friction of a base project is what the independent simulator has.
pub fn is_dahl(project: &Project) -> bool {
    let dahl = |law: &FrictionLaw| matches!(law, FrictionLaw::Dahl { exponent: 1.0, .. });
    dahl(&project.plant.motor_friction.law) && dahl(&project.plant.pivot_friction.law)
}
