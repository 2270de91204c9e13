//! The derivatives along a run are those that differences of runs show.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Friction, FrictionLaw, Parameters, Plant, Ripple, StribeckCurve, reference};
use counterpoise_simulate::history::{ReadingColumn, TrueColumn};
use counterpoise_simulate::sensitivity::{
    DifferentiablePi, Direction, Member, PiGains, SensitiveRun, SensitivityRefusal, Side,
};
use counterpoise_simulate::{
    Error, Imperfections, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};

/// Defect of a step in these runs: differences of runs need steps whose error is far below the difference.
const TIGHT: f64 = 1e-10;

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

    /// Returns the largest relative error of the derivatives along a parameter, over all outputs.
    fn error_along(&self, found: &SensitiveRun, direction: usize) -> f64 {
        let step = 1e-4;
        let runs = [-2.0, -1.0, 1.0, 2.0]
            .map(|place| self.plain(&self.plant(FACTORS[direction], place * step)).unwrap());
        let mut worst: f64 = 0.0;
        let mut compare = |exact: &[f64], column: &dyn Fn(&TimeHistory) -> Vec<f64>| {
            let of = runs.each_ref().map(column);
            let size = exact.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            let value = of[1].iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            for (k, exact) in exact.iter().enumerate() {
                let difference = (8.0 * (of[2][k] - of[1][k]) - (of[3][k] - of[0][k])) / (12.0 * step);
                let error = (difference - exact).abs() / (size + 1e-6 * value + f64::MIN_POSITIVE);
                worst = worst.max(error);
            }
        };
        for column in [ReadingColumn::HubRate, ReadingColumn::Control, ReadingColumn::MotorRate, ReadingColumn::HubPosition] {
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

fn controller() -> ProportionalIntegral {
    ProportionalIntegral { kp_v_s_rad: 18.0, ki_v_rad: 80.0, bias_v: 2.88, sample_period_s: 1e-3, integral_v: 0.0 }
}

fn scenario() -> Scenario {
    Scenario {
        demand_rad_s: Signal::sine(0.05, 12.0),
        platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.05, 9.0), ..PlatformMotion::STILL },
        imperfections: Imperfections::None,
        ..Scenario::at_rest(0.4)
    }
}

#[test]
fn the_derivatives_of_the_reference_rig_are_those_of_differences() {
    let case = Case { parameters: reference::rig(), scenario: scenario(), controller: controller() };
    let found = case.exact(&[PiGains::default(); FACTORS.len()]).unwrap();
    for (k, factor) in FACTORS.iter().enumerate() {
        let error = case.error_along(&found, k);
        println!("{}: {error:.2e}", factor.name);
    }
}
