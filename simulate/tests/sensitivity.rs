//! The derivatives along a run are those that differences of runs show.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Friction, FrictionLaw, Parameters, Plant, Ripple, StribeckCurve, reference};
use counterpoise_simulate::history::{ReadingColumn, TrueColumn};
use counterpoise_simulate::sensitivity::{
    DifferentiablePi, Direction, Member, PiGains, SensitiveRun, SensitivityRefusal, Side,
};
use counterpoise_simulate::{
    Error, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};

/// Defect of a step in these runs: differences of runs need steps whose error is far below the difference.
const TIGHT: f64 = 1e-11;

/// Numbers between 0 and 1, the same for one seed (Marsaglia's xorshift).
struct RandomGenerator(u64);

impl RandomGenerator {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn draw_between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn draw_below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// Returns a factor within a decade around 1.
    fn factor(&mut self) -> f64 {
        10f64.powf(self.draw_between(-0.5, 0.5))
    }
}

/// A parameter that is multiplied by 1 + s.
#[derive(Clone, Copy)]
struct Factor {
    name: &'static str,
    place: fn(&mut Parameters) -> &mut f64,
}

const FACTORS: [Factor; 12] = [
    Factor { name: "gear stiffness", place: |p| &mut p.gearbox.stiffness_nm_rad },
    Factor { name: "gear damping", place: |p| &mut p.gearbox.damping_nm_s_rad },
    Factor { name: "motor inertia", place: |p| &mut p.motor.inertia_kg_m2 },
    Factor { name: "torque constant", place: |p| &mut p.motor.torque_constant_nm_a },
    Factor { name: "resistance", place: |p| &mut p.motor.resistance_ohm },
    Factor { name: "pivot viscous", place: |p| &mut p.pivot_friction.viscous_nm_s_rad },
    Factor { name: "motor level", place: |p| coulomb(&mut p.motor_friction) },
    Factor { name: "pivot level", place: |p| coulomb(&mut p.pivot_friction) },
    Factor { name: "out of balance", place: |p| &mut p.lumped.as_mut().unwrap().out_of_balance_kg_m },
    Factor { name: "beam inertia", place: |p| &mut p.lumped.as_mut().unwrap().beam_inertia_kg_m2 },
    Factor { name: "sensor frequency", place: |p| &mut p.sensors.hub_gyro.natural_frequency_rad_s },
    Factor { name: "amplifier gain", place: |p| &mut p.amplifier.gain },
];

fn coulomb(friction: &mut Friction) -> &mut f64 {
    match &mut friction.law {
        FrictionLaw::Dahl { coulomb_nm, .. }
        | FrictionLaw::Lugre { coulomb_nm, .. }
        | FrictionLaw::Coulomb { coulomb_nm }
        | FrictionLaw::ResetIntegrator { coulomb_nm, .. }
        | FrictionLaw::Stribeck { coulomb_nm, .. }
        | FrictionLaw::Karnopp { coulomb_nm, .. }
        | FrictionLaw::Walrath { coulomb_nm, .. }
        | FrictionLaw::Bristle { coulomb_nm, .. } => coulomb_nm,
        FrictionLaw::None => &mut friction.viscous_nm_s_rad,
    }
}

/// A run whose derivatives are compared.
struct Case {
    parameters: Parameters,
    scenario: Scenario,
    controller: ProportionalIntegral,
}

impl Case {
    fn plant(&self, factor: Factor, by: f64) -> Plant {
        let mut parameters = self.parameters.clone();
        *(factor.place)(&mut parameters) *= 1.0 + by;
        Plant::from_lumped(&parameters).unwrap()
    }

    fn plain(&self, plant: &Plant) -> Result<TimeHistory, Error> {
        Simulator::with_tolerance(plant, TIGHT)?.run(&mut self.controller.clone(), &self.scenario)
    }

    fn exact(&self, gains: &[PiGains]) -> Result<SensitiveRun, SensitivityRefusal> {
        let members: Vec<_> = FACTORS
            .iter()
            .map(|factor| move |by: f64| Ok(Member { plant: self.plant(*factor, by), start: None }))
            .collect();
        let still = |_: f64| Ok(Member { plant: Plant::from_lumped(&self.parameters)?, start: None });
        let mut directions: Vec<Direction> =
            members.iter().map(|member| Direction { member, step: 1e-3, side: Side::Both }).collect();
        for _ in FACTORS.len()..gains.len() {
            directions.push(Direction { member: &still, step: 1e-3, side: Side::Both });
        }
        let plant = Plant::from_lumped(&self.parameters).unwrap();
        let mut controller = DifferentiablePi::new(&self.controller, gains);
        Simulator::with_tolerance(&plant, TIGHT)?.run_with_slopes(&mut controller, &self.scenario, &directions)
    }

    /// Returns how far the derivatives along a parameter are from differences of runs.
    fn compare_along(&self, found: &SensitiveRun, direction: usize) -> Comparison {
        let places: Vec<f64> = STEPS.iter().flat_map(|step| [-2.0, -1.0, 1.0, 2.0].map(|k| k * step)).collect();
        let runs: Vec<TimeHistory> =
            places.iter().map(|by| self.plain(&self.plant(FACTORS[direction], *by)).unwrap()).collect();
        let mut worst = Comparison::default();
        let mut compare = |exact: &[f64], column: &dyn Fn(&TimeHistory) -> Vec<f64>| {
            let of: Vec<Vec<f64>> = runs.iter().map(column).collect();
            let differences = Differences::new(&of);
            let value = of[1].iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            let size = exact.iter().fold(1e-3 * value + f64::MIN_POSITIVE, |m: f64, e| m.max(e.abs()));
            // a derivative far below the output itself is known no better than the runs are
            worst = worst.worse(&differences.compare(exact, size));
        };
        for column in
            [ReadingColumn::HubRate, ReadingColumn::Control, ReadingColumn::MotorRate, ReadingColumn::HubPosition]
        {
            let of = |run: &TimeHistory| run.readings.signals.column(column).to_vec();
            compare(found.reading(direction, column), &of);
        }
        for column in [TrueColumn::TipRate, TrueColumn::HubAngle, TrueColumn::Voltage, TrueColumn::WindUp] {
            let of = |run: &TimeHistory| run.truth.signals.column(column).to_vec();
            compare(found.truth(direction, column), &of);
        }
        worst
    }
}

/// The relative error of derivatives, and how well the differences themselves are known.
#[derive(Debug, Clone, Copy, Default)]
struct Comparison {
    error: f64,
    doubt: f64,
}

impl Comparison {
    /// Returns the one whose error is larger beside its doubt.
    fn worse(self, other: &Self) -> Self {
        let by = |one: &Self| one.error / (1e-6 + one.doubt);
        if by(other) > by(&self) { *other } else { self }
    }
}

/// Differences of fourth order of one output, step by step.
struct Differences(Vec<Vec<f64>>);

impl Differences {
    fn new(of: &[Vec<f64>]) -> Self {
        let one = |(runs, step): (&[Vec<f64>], &f64)| -> Vec<f64> {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| &runs[k]);
            (0..a.len()).map(|k| (8.0 * (c[k] - b[k]) - (d[k] - a[k])) / (12.0 * step)).collect()
        };
        Self(of.chunks(4).zip(&STEPS).map(one).collect())
    }

    /// Compares with the difference that agrees best with that of the next smaller step.
    fn compare(&self, exact: &[f64], size: f64) -> Comparison {
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / size;
        let judged = self.0.windows(2).map(|pair| Comparison {
            error: apart(&pair[1], exact).min(apart(&pair[0], exact)),
            doubt: apart(&pair[0], &pair[1]),
        });
        judged.min_by(|a, b| a.doubt.total_cmp(&b.doubt)).unwrap()
    }
}

/// Steps of the differences, as shares of the parameter.
const STEPS: [f64; 5] = [1e-2, 3e-3, 1e-3, 2e-4, 3e-5];

fn law(kind: usize, coulomb_nm: f64, random: &mut RandomGenerator) -> FrictionLaw {
    let stiffness = coulomb_nm * 2000.0 * random.factor();
    match kind {
        0 => FrictionLaw::None,
        1 => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.0 },
        2 => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.5 },
        3 => FrictionLaw::Lugre {
            coulomb_nm,
            bristle_stiffness_nm_rad: stiffness,
            bristle_damping_nm_s_rad: 0.001 * stiffness * random.next(),
        },
        4 => FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: 5e-4 * random.factor(), damping_nm_s_rad: 0.0 },
        5 => FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 0.01 },
        6 => FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian },
        7 => FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 1e-3 * random.factor() },
        _ => FrictionLaw::Coulomb { coulomb_nm },
    }
}

const LAWS: usize = 9;

/// Returns a random machine in a random run.
fn random_case(random: &mut RandomGenerator) -> (Case, String) {
    let mut rig = reference::rig();
    let kinds = [random.draw_below(LAWS), random.draw_below(LAWS)];
    let friction = |kind: usize, level: f64, viscous: f64, random: &mut RandomGenerator| {
        let mut friction = Friction::with_viscous_part(law(kind, level * random.factor(), random), viscous);
        let falls = !matches!(kind, 0 | 4 | 5 | 8);
        if falls && random.next() > 0.5 {
            friction.static_ratio = random.draw_between(1.0, 1.6);
            friction.stribeck_rate_rad_s = 0.02 * random.factor();
        }
        friction.asymmetry = if random.next() > 0.7 { random.draw_between(-0.2, 0.2) } else { 0.0 };
        friction
    };
    rig.motor_friction = friction(kinds[0], 0.065, 0.002 * random.factor(), random);
    rig.pivot_friction = friction(kinds[1], 117.0, 60.0 * random.factor(), random);
    rig.gearbox.backlash_rad = if random.next() > 0.5 { 0.5e-3 * random.factor() } else { 0.0 };
    rig.gearbox.stiffness_nm_rad *= random.factor();
    rig.amplifier.bus_voltage_v = if random.next() > 0.7 { 20.0 } else { 150.0 };
    if random.next() > 0.6 {
        rig.motor.cogging = Ripple { amplitude: 0.05 * random.next(), ..rig.motor.cogging };
        rig.amplifier.current_limit_a = 30.0;
        rig.pivot_friction.quadratic_nm_s2_rad2 = 5.0;
    }
    rig.interface.output_delay_samples = random.draw_below(3);
    rig.sensors.hub_gyro.delay_s = if random.next() > 0.5 { 1.5e-3 } else { 0.0 };
    let lumped = rig.lumped.as_mut().unwrap();
    lumped.beam_inertia_kg_m2 *= random.factor();
    lumped.vertical_offset_kg_m = 20.0 * random.next();
    let text = format!(
        "laws {kinds:?} gap {:.1e} bus {} delay {}",
        rig.gearbox.backlash_rad, rig.amplifier.bus_voltage_v, rig.interface.output_delay_samples
    );
    let scenario = Scenario {
        demand_rad_s: Signal::sine(0.1 * random.next(), 40.0 * random.next()),
        injection_v: Signal::sine(random.next(), 60.0 * random.next()),
        platform: PlatformMotion {
            pitch_rate_rad_s: Signal::sine(0.1 * random.next(), 40.0 * random.next()),
            ..PlatformMotion::STILL
        },
        ..Scenario::at_rest(0.25)
    };
    (Case { parameters: rig, scenario, controller: controller() }, text)
}

fn controller() -> ProportionalIntegral {
    ProportionalIntegral { kp_v_s_rad: 18.0, ki_v_rad: 80.0, bias_v: 2.88, sample_period_s: 1e-3, integral_v: 0.0 }
}

fn scenario() -> Scenario {
    Scenario {
        demand_rad_s: Signal::sine(0.05, 12.0),
        platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.05, 9.0), ..PlatformMotion::STILL },
        ..Scenario::at_rest(0.4)
    }
}

#[test]
fn the_derivatives_of_the_reference_rig_are_those_of_differences() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let found = case.exact(&[PiGains::default(); FACTORS.len()]).unwrap();
    for (k, factor) in FACTORS.iter().enumerate() {
        let error = case.compare_along(&found, k);
        println!("{}: {error:?}", factor.name);
    }
}

#[test]
fn the_derivatives_of_random_machines_are_those_of_differences() {
    let count = std::env::var("MACHINES").map_or(60, |count| count.parse().unwrap());
    let mut random = RandomGenerator(0x1234_5678_9abc);
    let (mut refused, mut beyond, mut errors) = (0, 0, Vec::new());
    for machine in 0..count {
        let (case, text) = random_case(&mut random);
        let found = match case.exact(&[PiGains::default(); FACTORS.len()]) {
            Ok(found) => found,
            Err(SensitivityRefusal::Run(_)) => continue,
            Err(refusal) => {
                refused += 1;
                println!("{machine} {text}: {refusal}");
                continue;
            }
        };
        for _ in 0..3 {
            let direction = random.draw_below(FACTORS.len());
            let Comparison { error, doubt } = case.compare_along(&found, direction);
            if error > 1e-6 + 3.0 * doubt {
                println!("{machine} {text}: {} {error:.1e}, doubt {doubt:.1e}", FACTORS[direction].name);
            }
            errors.push(error);
            beyond += usize::from(error > 1e-6 + 3.0 * doubt);
        }
    }
    println!("beyond {beyond}");
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| errors[(share * (errors.len() - 1) as f64) as usize];
    println!("{} errors: median {:.1e}, 90 % {:.1e}, 95 % {:.1e}, 99 % {:.1e}, largest {:.1e}; {refused} refused",
        errors.len(), at(0.5), at(0.9), at(0.95), at(0.99), at(1.0));
}
