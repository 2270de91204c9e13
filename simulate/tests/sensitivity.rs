//! The derivatives along a run are those that differences of runs show.

use crate::common::{RandomGenerator, controller};
use counterpoise_controller::{AntiWindup, ProportionalIntegral};
use counterpoise_models::plant::core::state;
use counterpoise_models::{Friction, FrictionLaw, Parameters, Plant, Ripple, StribeckCurve, reference};
use counterpoise_simulate::history::{ReadingColumn, TrueColumn};
use counterpoise_simulate::sensitivity::{
    DifferentiablePi, Direction, Member, PiGains, SensitiveRun, SensitivityRefusal, Side,
};
use counterpoise_simulate::{
    Error, Imperfections, Initial, PlantState, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};

/// Defect of a step in these runs: differences of runs need steps whose error is far below the difference.
const TIGHT: f64 = 1e-11;

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
        Simulator::with_tolerance(&plant, TIGHT)?.run_with_slopes(
            &mut controller,
            &self.scenario,
            &directions,
        )
    }

    /// Returns how far the derivatives along a parameter are from differences of runs.
    fn compare_along(&self, found: &SensitiveRun, direction: usize) -> Comparison {
        let places: Vec<f64> =
            STEPS.iter().flat_map(|step| [-2.0, -1.0, 1.0, 2.0].map(|k| k * step)).collect();
        let runs: Vec<TimeHistory> =
            places.iter().map(|by| self.plain(&self.plant(FACTORS[direction], *by)).unwrap()).collect();
        let mut worst = Comparison::default();
        let mut compare = |exact: &[f64], column: &dyn Fn(&TimeHistory) -> Vec<f64>| {
            let of: Vec<Vec<f64>> = runs.iter().map(column).collect();
            let differences = Differences::new(&of);
            let value = of[1].iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            let size = exact.iter().fold(1e-2 * value + f64::MIN_POSITIVE, |m: f64, e| m.max(e.abs()));
            // a parameter whose doubling moves the output by less than a hundredth is compared with that: the runs are known no better
            worst = worst.worse(&differences.compare(exact, size));
        };
        for column in [
            ReadingColumn::HubRate,
            ReadingColumn::Control,
            ReadingColumn::MotorRate,
            ReadingColumn::HubPosition,
        ] {
            let of = |run: &TimeHistory| run.readings.signals.column(column).to_vec();
            compare(found.slopes.reading(direction, column), &of);
        }
        for column in [TrueColumn::TipRate, TrueColumn::HubAngle, TrueColumn::Voltage, TrueColumn::WindUp] {
            let of = |run: &TimeHistory| run.truth.signals.column(column).to_vec();
            compare(found.slopes.truth(direction, column), &of);
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
        let apart =
            |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / size;
        let judged = self.0.windows(2).map(|pair| Comparison {
            error: apart(&pair[1], exact).min(apart(&pair[0], exact)),
            doubt: apart(&pair[0], &pair[1]),
        });
        judged.min_by(|a, b| a.doubt.total_cmp(&b.doubt)).unwrap()
    }
}

impl Case {
    /// Returns whether nothing in the motion has a corner that the engine does not seek: no gap, no true stick, no law that turns at once.
    fn is_smooth(&self) -> bool {
        let turns = |friction: &Friction| {
            matches!(
                friction.law,
                FrictionLaw::None
                    | FrictionLaw::Walrath { .. }
                    | FrictionLaw::Lugre { .. }
                    | FrictionLaw::Dahl { .. }
            )
        };
        self.parameters.gearbox.backlash_rad == 0.0
            && turns(&self.parameters.motor_friction)
            && turns(&self.parameters.pivot_friction)
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
        4 => FrictionLaw::ResetIntegrator {
            coulomb_nm,
            deflection_rad: 5e-4 * random.factor(),
            damping_nm_s_rad: 0.0,
        },
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
        friction.asymmetry = if random.next() > 0.8 { random.draw_between(-0.2, 0.2) } else { 0.0 };
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

fn scenario() -> Scenario {
    Scenario {
        demand_rad_s: Signal::sine(0.05, 12.0),
        platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.05, 9.0), ..PlatformMotion::STILL },
        ..Scenario::at_rest(0.4)
    }
}

/// Share of a comparison's doubt by which the derivatives may miss the differences.
const DOUBTS: f64 = 3.0;

#[test]
fn the_derivatives_of_the_reference_rig_are_those_of_differences() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let found = case.exact(&[PiGains::default(); FACTORS.len()]).unwrap();
    for (k, factor) in FACTORS.iter().enumerate() {
        let Comparison { error, doubt } = case.compare_along(&found, k);
        assert!(error < 1e-6 + DOUBTS * doubt && error < 5e-6, "{}: {error:.1e}, {doubt:.1e}", factor.name);
    }
}

#[test]
fn a_run_with_derivatives_leaves_the_bytes_of_the_plain_run() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let plain = case.plain(&Plant::from_lumped(&case.parameters).unwrap()).unwrap();
    assert_eq!(case.exact(&[PiGains::default(); FACTORS.len()]).unwrap().history, plain);
}

#[test]
fn gains_and_the_integral_at_the_start_have_derivatives() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let one = PiGains::default();
    let kinds = [
        PiGains { kp_v_s_rad: 1.0, ..one },
        PiGains { ki_v_rad: 1.0, ..one },
        PiGains { bias_v: 1.0, ..one },
        PiGains { integral_v: 1.0, ..one },
    ];
    let gains: Vec<PiGains> = vec![one; FACTORS.len()].into_iter().chain(kinds).collect();
    let found = case.exact(&gains).unwrap();
    let plant = Plant::from_lumped(&case.parameters).unwrap();
    for (k, kind) in kinds.iter().enumerate() {
        let moved = |by: f64| {
            let mut controller = case.controller.clone();
            controller.kp_v_s_rad += by * kind.kp_v_s_rad;
            controller.ki_v_rad += by * kind.ki_v_rad;
            controller.bias_v += by * kind.bias_v;
            controller.integral_v += by * kind.integral_v;
            let run = Simulator::with_tolerance(&plant, TIGHT).unwrap().run(&mut controller, &case.scenario);
            run.unwrap().readings.control_v().to_vec()
        };
        let exact = found.slopes.reading(FACTORS.len() + k, ReadingColumn::Control);
        let worst = miss(exact, 2e-4, moved);
        assert!(worst < 2e-6, "{kind:?}: {worst:.1e}");
    }
}

/// Returns by how much a difference of fourth order misses derivatives, relative to the largest of them.
fn miss(exact: &[f64], step: f64, mut run: impl FnMut(f64) -> Vec<f64>) -> f64 {
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|place| run(place * step));
    let size = exact.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
    let difference = |k: usize| (8.0 * (c[k] - b[k]) - (d[k] - a[k])) / (12.0 * step);
    (0..exact.len()).map(|k| (difference(k) - exact[k]).abs() / size).fold(0.0, f64::max)
}

#[test]
fn gains_have_derivatives_while_the_control_is_limited() {
    let rules = [AntiWindup::Hold(3.1), AntiWindup::HoldOutward(3.1), AntiWindup::Clamp(0.02)];
    for anti_windup in rules {
        let controller = ProportionalIntegral { anti_windup, ..controller() };
        let case = Case { parameters: reference::rig(), scenario: scenario(), controller };
        let one = PiGains::default();
        let gains = [vec![one; FACTORS.len()], vec![PiGains { kp_v_s_rad: 1.0, ..one }]].concat();
        let found = case.exact(&gains).unwrap();
        let plant = Plant::from_lumped(&case.parameters).unwrap();
        let run = |rule: AntiWindup, by: f64| {
            let mut moved = ProportionalIntegral { anti_windup: rule, ..case.controller.clone() };
            moved.kp_v_s_rad += by;
            let run = Simulator::with_tolerance(&plant, TIGHT).unwrap().run(&mut moved, &case.scenario);
            run.unwrap().readings.control_v().to_vec()
        };
        assert!(run(anti_windup, 0.0) != run(AntiWindup::None, 0.0), "{anti_windup:?} does nothing");
        let exact = found.slopes.reading(FACTORS.len(), ReadingColumn::Control);
        // at a sample where the control just reaches its limit, a difference sees the integral of both sides
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| run(anti_windup, k * 1e-5));
        let size = exact.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        let difference = |k: usize| (8.0 * (c[k] - b[k]) - (d[k] - a[k])) / 12e-5;
        let wrong = (0..exact.len()).filter(|k| (difference(*k) - exact[*k]).abs() > 1e-4 * size).count();
        assert!(100 * wrong <= exact.len(), "{anti_windup:?}: {wrong} of {}", exact.len());
    }
}

#[test]
fn freedoms_of_the_start_have_derivatives() {
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let mut simulator = Simulator::with_tolerance(&plant, TIGHT).unwrap();
    let rest = simulator.rest(0.0, 0.0, 0.05);
    let moved = |freedom: usize, by: f64| {
        let mut start = rest.clone();
        match freedom {
            0 => start.core[state::ANGLE] += 1e-4 * by,
            1 => start.core[state::RATE] += 1e-3 * by,
            2 => start.friction.pivot += by,
            _ => start.hub_gyro[0] += 1e-3 * by,
        }
        start
    };
    let members: Vec<_> = (0..4)
        .map(|k| {
            let (plant, moved) = (&plant, &moved);
            move |by: f64| Ok(Member { plant: plant.clone(), start: Some(moved(k, by)) })
        })
        .collect();
    let directions: Vec<Direction> =
        members.iter().map(|member| Direction { member, step: 1e-2, side: Side::Both }).collect();
    let from = |start: PlantState| Scenario { initial: Initial::State(Box::new(start)), ..scenario() };
    let mut exact = DifferentiablePi::new(&controller(), &[]);
    let found = simulator.run_with_slopes(&mut exact, &from(rest.clone()), &directions).unwrap();
    for freedom in 0..4 {
        let run = |by: f64| {
            let history = simulator.run(&mut controller(), &from(moved(freedom, by))).unwrap();
            history.truth.signals.column(TrueColumn::HubRate).to_vec()
        };
        let worst = miss(found.slopes.truth(freedom, TrueColumn::HubRate), 0.02, run);
        assert!(worst < 1e-5, "{freedom}: {worst:.1e}");
    }
}

#[test]
fn a_rounded_reading_passes_the_derivatives_of_the_signal_before_it() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let rounded = Case {
        scenario: Scenario { imperfections: Imperfections::Quantisation, ..scenario() },
        parameters: case.parameters.clone(),
        controller: controller(),
    };
    let gains = [PiGains::default(); FACTORS.len()];
    let [smooth, rounded] = [case, rounded].map(|case| case.exact(&gains).unwrap());
    // the motion differs by the rounding alone, and the derivatives with it
    for direction in [0, 3, 8] {
        let [a, b] = [&smooth, &rounded].map(|run| run.slopes.reading(direction, ReadingColumn::HubRate));
        let apart: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
        let size: f64 = a.iter().map(|a| a * a).sum();
        assert!(apart < 0.01 * size, "{direction}: {}", (apart / size).sqrt());
    }
}

#[test]
fn what_has_no_derivative_is_refused_with_its_reason() {
    let refusal = |change: &dyn Fn(&mut Parameters), member: &dyn Fn(&mut Parameters, f64)| {
        let with = |by: f64| {
            let mut parameters = reference::rig();
            change(&mut parameters);
            member(&mut parameters, by);
            Ok(Member { plant: Plant::from_lumped(&parameters)?, start: None })
        };
        let directions = [Direction { member: &with, step: 1e-3, side: Side::Above }];
        let plant = with(0.0).unwrap().plant;
        let mut exact = DifferentiablePi::new(&controller(), &[]);
        Simulator::new(&plant).unwrap().run_with_slopes(&mut exact, &scenario(), &directions).unwrap_err()
    };
    let same = |_: &mut Parameters, _: f64| {};
    let bristles = |p: &mut Parameters| {
        p.pivot_friction.law = FrictionLaw::Bristle { coulomb_nm: 117.0, bristles: 20, bond_rad: 1e-4 };
    };
    assert!(matches!(refusal(&bristles, &same), SensitivityRefusal::Jump { .. }));
    let lossy = |p: &mut Parameters| p.gearbox.mesh_efficiency = 0.9;
    assert!(matches!(refusal(&lossy, &same), SensitivityRefusal::Part { .. }));
    let closed = |p: &mut Parameters| p.gearbox.backlash_rad = 0.0;
    let opens = |p: &mut Parameters, by: f64| p.gearbox.backlash_rad += by;
    assert!(matches!(refusal(&closed, &opens), SensitivityRefusal::Structure { direction: 0, .. }));
}

/// The comparisons over random machines; MACHINES is their number, 24 if it is not set.
#[test]
fn the_derivatives_of_random_machines_are_those_of_differences() {
    let count = std::env::var("MACHINES").map_or(24, |count| count.parse().unwrap());
    let mut random = RandomGenerator(0x1234_5678_9abc);
    let (mut refused, mut found) = (0, Vec::new());
    for machine in 0..count {
        let (case, text) = random_case(&mut random);
        let run = match case.exact(&[PiGains::default(); FACTORS.len()]) {
            Ok(run) => run,
            Err(refusal) => {
                refused += 1;
                println!("{machine} {text}: {refusal}");
                continue;
            }
        };
        for _ in 0..3 {
            let direction = random.draw_below(FACTORS.len());
            let one = case.compare_along(&run, direction);
            if one.error > 1e-6 + DOUBTS * one.doubt {
                println!(
                    "{machine} {text}: {} {:.1e}, doubt {:.1e}",
                    FACTORS[direction].name, one.error, one.doubt
                );
            }
            found.push((case.is_smooth(), one));
        }
    }
    for (name, smooth) in
        [("no corner in the motion", true), ("gap, true stick or corners of friction", false)]
    {
        let few: Vec<Comparison> =
            found.iter().filter(|(kind, _)| *kind == smooth).map(|(_, one)| *one).collect();
        let share = |most: &dyn Fn(&Comparison) -> bool| {
            few.iter().filter(|one| most(one)).count() as f64 / few.len() as f64
        };
        let within = share(&|one| one.error <= 1e-6 + DOUBTS * one.doubt);
        let close = share(&|one| one.error <= 1e-4);
        let far = share(&|one| one.error > 5e-3);
        println!(
            "{name}: {} comparisons, within 1e-6 or the doubt {:.1} %, within 1e-4 {:.1} %, beyond 5e-3 {:.1} %",
            few.len(),
            100.0 * within,
            100.0 * close,
            100.0 * far
        );
        assert!(far < 0.03 && close > 0.9 && (!smooth || (within > 0.8 && close == 1.0)), "{name}");
    }
    println!("{refused} of {count} refused");
    assert!(refused * 20 <= count + 20);
}
