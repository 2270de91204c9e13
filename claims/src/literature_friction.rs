//! Laws of friction that the thesis names and does not use: the second-order law of Bliman and Sorine, and the seven-parameter model of
//! Armstrong-Hélouvry, Dupont and Canudas de Wit, each on the rigid, balanced mechanism with its motor disconnected.

use std::collections::VecDeque;
use std::f64::consts::{LN_10, TAU};

use counterpoise_linalg::C64;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_plot::{Axis, Figure as Drawing, Point};

use super::drawing::{ClaimCurve, make_figure, make_panel};
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::LEAST_LENGTH;
use counterpoise_pipeline::PipelineError;

/// Pitch rates of the platform, rad/s, and the frequencies of the map, Hz: those of the row on the laws that the thesis compares.
const RATES_RAD_S: [f64; 5] = [0.2, 0.1334, 0.0666, 0.0334, 0.0166];
const FREQUENCIES_HZ: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Step of the integration, s, and the cycles before and while the response is measured.
const STEP_S: f64 = 2e-4;
const CYCLES: (usize, usize) = (12, 4);
/// Static friction over the sliding one, as mechanisms with lubricated contacts have it (Armstrong-Hélouvry 1994, table 1).
const STATIC: f64 = 1.3;
/// Length of the weakening element over that of the other one in the law of Bliman and Sorine.
const LENGTHS: f64 = 5.0;
/// Usual values of the seven-parameter model: Stribeck rate, rad/s, frictional memory, s, and rise of static friction, s.
const STRIBECK_RAD_S: f64 = 0.01;
const MEMORY_S: f64 = 0.02;
const RISE_S: f64 = 1.0;
/// By how much a parameter is changed to see what it does, and the error of a measured response, dB.
const CHANGE: f64 = 0.05;
const MEASURED_WITHIN_DB: f64 = 0.1;

/// A small displacement, in lengths of the law: Dahl's torque over it is 0.5 % below its stiffness.
const SMALL: f64 = 0.01;

/// Friction between platform and hub, without its viscous part.
trait Law {
    /// Returns the torque on the hub after the platform has turned by `turn_rad` relative to it in a step.
    fn torque(&mut self, turn_rad: f64) -> f64;
}

/// Dahl's law: a torque that follows its level over a length of turn.
#[derive(Debug, Clone, Copy)]
struct Element {
    level_nm: f64,
    length_rad: f64,
    torque_nm: f64,
}

impl Element {
    fn new(level_nm: f64, length_rad: f64) -> Self {
        Self { level_nm, length_rad, torque_nm: 0.0 }
    }
}

impl Law for Element {
    /// dF = (F_c sgn(x') - F) |dx| / length, exact in the displacement.
    fn torque(&mut self, turn_rad: f64) -> f64 {
        let goal = self.level_nm * turn_rad.signum();
        self.torque_nm = goal + (self.torque_nm - goal) * (-turn_rad.abs() / self.length_rad).exp();
        self.torque_nm
    }
}

/// Bliman and Sorine, *Easy-to-use realistic dry friction models for automatic control*, ECC 1995: a Dahl element less a slower one, so
/// that the torque of a first displacement passes a static peak and falls to the Coulomb level.
struct BlimanSorine {
    fast: Element,
    slow: Element,
}

impl BlimanSorine {
    /// Returns the law of a Coulomb level, a stiffness at rest, and a peak over the Coulomb level.
    fn new(coulomb_nm: f64, stiffness_nm_rad: f64, peak: f64) -> Self {
        // the peak rises with the slow element's level: bisection
        let (mut low, mut high) = (0.0, 10.0 * coulomb_nm);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if peak_of(coulomb_nm + middle, middle) < peak * coulomb_nm {
                low = middle
            } else {
                high = middle
            }
        }
        let slow = 0.5 * (low + high);
        let length_rad = ((coulomb_nm + slow) * LENGTHS - slow) / stiffness_nm_rad;
        Self {
            fast: Element::new(coulomb_nm + slow, length_rad / LENGTHS),
            slow: Element::new(slow, length_rad),
        }
    }
}

/// Returns the largest torque of a first displacement: f1 (1 - e^(-n x)) - f2 (1 - e^(-x)), x over the slow
/// element's length.
fn peak_of(fast_nm: f64, slow_nm: f64) -> f64 {
    if slow_nm <= 0.0 {
        return fast_nm;
    }
    let x = (LENGTHS * fast_nm / slow_nm).ln() / (LENGTHS - 1.0);
    fast_nm * (1.0 - (-LENGTHS * x).exp()) - slow_nm * (1.0 - (-x).exp())
}

impl Law for BlimanSorine {
    fn torque(&mut self, turn_rad: f64) -> f64 {
        self.fast.torque(turn_rad) - self.slow.torque(turn_rad)
    }
}

/// Parameters of the seven-parameter model.
#[derive(Debug, Clone, Copy)]
struct SevenParameters {
    stiffness_nm_rad: f64,
    coulomb_nm: f64,
    viscous_nm_s_rad: f64,
    static_nm: f64,
    stribeck_rad_s: f64,
    memory_s: f64,
    rise_s: f64,
}

impl SevenParameters {
    const NAMES: [&'static str; 7] =
        ["stiffness", "Coulomb", "viscous", "static", "Stribeck rate", "memory", "rise of static friction"];

    /// Returns the same parameters with one of them times a factor.
    fn with_scaled_parameter(mut self, which: usize, factor: f64) -> Self {
        let all = [
            &mut self.stiffness_nm_rad,
            &mut self.coulomb_nm,
            &mut self.viscous_nm_s_rad,
            &mut self.static_nm,
            &mut self.stribeck_rad_s,
            &mut self.memory_s,
            &mut self.rise_s,
        ];
        if let Some(value) = all.into_iter().nth(which) {
            *value *= factor;
        }
        self
    }
}

/// Armstrong-Hélouvry, Dupont and Canudas de Wit, *A survey of models, analysis tools and compensation methods for the control of machines
/// with friction*, Automatica 30 (1994) 1083, eq. 12 to 14: at rest a spring up to F_c + F_s t / (t + gamma) after the dwell time t, sliding
/// F_c + F_s / (1 + (x'(time - tau) / v_s)^2).
struct SevenParameterModel {
    parameters: SevenParameters,
    /// Deflection at rest, rad, or direction and static level of the sliding, N m.
    state: Contact,
    past_rad_s: VecDeque<f64>,
}

enum Contact {
    Rest { deflection_rad: f64, dwell_s: f64 },
    Sliding { direction: f64, static_nm: f64 },
}

impl SevenParameterModel {
    fn new(parameters: SevenParameters) -> Self {
        let length = ((parameters.memory_s / STEP_S).round() as usize).max(1);
        let state = Contact::Rest { deflection_rad: 0.0, dwell_s: 0.0 };
        Self { parameters, state, past_rad_s: VecDeque::from(vec![0.0; length]) }
    }
}

impl Law for SevenParameterModel {
    fn torque(&mut self, turn_rad: f64) -> f64 {
        let p = self.parameters;
        self.past_rad_s.push_back(turn_rad / STEP_S);
        let past = self.past_rad_s.pop_front().unwrap_or(0.0);
        let weakened = |static_nm: f64| p.coulomb_nm + static_nm / (1.0 + (past / p.stribeck_rad_s).powi(2));
        match &mut self.state {
            Contact::Rest { deflection_rad, dwell_s } => {
                *deflection_rad += turn_rad;
                *dwell_s += STEP_S;
                let static_nm = p.static_nm * *dwell_s / (*dwell_s + p.rise_s);
                let torque = p.stiffness_nm_rad * *deflection_rad;
                if torque.abs() <= p.coulomb_nm + static_nm {
                    return torque;
                }
                let direction = torque.signum();
                self.state = Contact::Sliding { direction, static_nm };
                direction * (p.coulomb_nm + static_nm)
            }
            Contact::Sliding { direction, static_nm } => {
                let torque = *direction * weakened(*static_nm);
                if *direction * turn_rad < 0.0 {
                    let deflection_rad = torque / p.stiffness_nm_rad + turn_rad;
                    self.state = Contact::Rest { deflection_rad, dwell_s: 0.0 };
                    return p.stiffness_nm_rad * deflection_rad;
                }
                torque
            }
        }
    }
}

/// The rigid hub on the moving platform: J w' = F + d (w_p - w).
#[derive(Debug, Clone, Copy)]
struct Hub {
    inertia_kg_m2: f64,
    viscous_nm_s_rad: f64,
}

impl Hub {
    /// Returns hub rate over the platform's rate at one frequency, by correlation over whole cycles.
    fn response(self, law: &mut dyn Law, hz: f64, amplitude_rad_s: f64) -> C64 {
        let cycle = (1.0 / (hz * STEP_S)).round() as usize;
        let (mut rate, mut sum) = (0.0, C64::new(0.0, 0.0));
        for k in 0..(CYCLES.0 + CYCLES.1) * cycle {
            let phase = TAU * (k as f64 + 0.5) / cycle as f64;
            let relative = amplitude_rad_s * phase.sin() - rate;
            let torque = law.torque(STEP_S * relative) + self.viscous_nm_s_rad * relative;
            let change = STEP_S * torque / self.inertia_kg_m2;
            if k >= CYCLES.0 * cycle {
                sum += C64::new(phase.sin(), phase.cos()) * (rate + 0.5 * change);
            }
            rate += change;
        }
        sum * (2.0 / (amplitude_rad_s * (CYCLES.1 * cycle) as f64))
    }

    /// Returns the responses at every rate and frequency.
    fn map(self, make: &dyn Fn() -> Box<dyn Law>) -> Vec<C64> {
        let points = RATES_RAD_S.iter().flat_map(|rate| FREQUENCIES_HZ.iter().map(move |hz| (*hz, *rate)));
        points.map(|(hz, rate)| self.response(make().as_mut(), hz, rate)).collect()
    }
}

/// Returns the RMS distance of two maps at one of the amplitudes, dB of the larger change of gain or phase.
fn apart_db(a: &[C64], b: &[C64], amplitude: usize) -> f64 {
    let count = FREQUENCIES_HZ.len();
    let of = amplitude * count..(amplitude + 1) * count;
    let one = |k: usize| (20.0 * (1.0 + (a[k] / b[k] - 1.0).norm()).log10()).powi(2);
    (of.map(one).sum::<f64>() / count as f64).sqrt()
}

/// Returns the relative standard deviation of each parameter that a map determines whose points are known within `MEASURED_WITHIN_DB`: the
/// error over the part of a parameter's effect that no combination of the others has.
fn deviations(count: usize, map: &dyn Fn(usize, f64) -> Vec<C64>) -> Vec<f64> {
    let nominal = map(0, 1.0);
    let column = |which: usize| -> Vec<f64> {
        let (up, down) = (map(which, 1.0 + CHANGE), map(which, 1.0 - CHANGE));
        let slope = |k: usize| (up[k] - down[k]) / (2.0 * CHANGE * nominal[k].norm());
        (0..nominal.len()).flat_map(|k| [slope(k).re, slope(k).im]).collect()
    };
    let columns: Vec<Vec<f64>> = (0..count).map(column).collect();
    let own = |which: usize| -> f64 {
        let others =
            columns.iter().enumerate().filter(|(k, _)| *k != which).map(|(_, column)| column.clone());
        let mut basis: Vec<Vec<f64>> = Vec::new();
        others.for_each(|other| basis.extend(unit(without(other, &basis))));
        norm(&without(columns[which].clone(), &basis))
    };
    let error = MEASURED_WITHIN_DB * LN_10 / 20.0;
    (0..count).map(|which| error / own(which).max(f64::MIN_POSITIVE)).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns the vector without what lies along an orthonormal basis, removed twice against rounding.
fn without(mut v: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    for along in basis.iter().chain(basis) {
        let part: f64 = v.iter().zip(along).map(|(a, b)| a * b).sum();
        v.iter_mut().zip(along).for_each(|(a, b)| *a -= part * b);
    }
    v
}

/// Returns the vector with length 1; `None` if nothing of it is left.
fn unit(v: Vec<f64>) -> Option<Vec<f64>> {
    let length = norm(&v);
    (length > LEAST_LENGTH).then(|| v.into_iter().map(|x| x / length).collect())
}

/// The measurements of the laws.
struct FrictionMeasurement {
    /// Distance of the maps from Dahl's at each amplitude, dB.
    bliman_sorine: Vec<f64>,
    seven_parameters: Vec<f64>,
    /// Largest torque of a slow first displacement over the Coulomb level: Dahl, Bliman and Sorine.
    peaks: [f64; 2],
    /// Stiffness of a small displacement with the law of Bliman and Sorine, over the one asked for.
    stiffness: f64,
    /// Relative standard deviations of Dahl's three parameters and of the seven.
    of_dahl: Vec<f64>,
    of_seven: Vec<f64>,
}

/// Returns the largest torque while the platform turns slowly over many lengths of the law.
fn slow_peak(law: &mut dyn Law, length_rad: f64) -> f64 {
    (0..20_000).map(|_| law.torque(1e-3 * length_rad)).fold(0.0, f64::max)
}

fn measure(parameters: &Parameters) -> Option<FrictionMeasurement> {
    let lumped = parameters.lumped.as_ref()?;
    let pivot = &parameters.pivot_friction;
    if !matches!(pivot.law, FrictionLaw::Dahl { .. }) {
        return None;
    }
    let (coulomb_nm, stiffness) = (pivot.coulomb_nm(), pivot.presliding_stiffness_nm_rad()?);
    let viscous = pivot.viscous_nm_s_rad;
    let inertia_kg_m2 = lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2;
    let hub = |viscous_nm_s_rad: f64| Hub { inertia_kg_m2, viscous_nm_s_rad };
    let dahl = |which: usize, factor: f64| {
        let by = |k: usize| if k == which { factor } else { 1.0 };
        let (level, stiffness) = (coulomb_nm * by(1), stiffness * by(0));
        hub(viscous * by(2)).map(&|| Box::new(Element::new(level, level / stiffness)))
    };
    let seven = SevenParameters {
        stiffness_nm_rad: stiffness,
        coulomb_nm,
        viscous_nm_s_rad: viscous,
        static_nm: (STATIC - 1.0) * coulomb_nm,
        stribeck_rad_s: STRIBECK_RAD_S,
        memory_s: MEMORY_S,
        rise_s: RISE_S,
    };
    let sevens = |which: usize, factor: f64| {
        let p = seven.with_scaled_parameter(which, factor);
        hub(p.viscous_nm_s_rad).map(&|| Box::new(SevenParameterModel::new(p)))
    };
    let peaked = || BlimanSorine::new(coulomb_nm, stiffness, STATIC);
    let (reference, weak) = (dahl(0, 1.0), hub(viscous).map(&|| Box::new(peaked())));
    let rich = sevens(0, 1.0);
    let distances = |map: &[C64]| (0..RATES_RAD_S.len()).map(|k| apart_db(map, &reference, k)).collect();
    let length = coulomb_nm / stiffness;
    Some(FrictionMeasurement {
        bliman_sorine: distances(&weak),
        seven_parameters: distances(&rich),
        peaks: [
            slow_peak(&mut Element::new(coulomb_nm, length), length) / coulomb_nm,
            slow_peak(&mut peaked(), length) / coulomb_nm,
        ],
        stiffness: peaked().torque(SMALL * length) / (stiffness * SMALL * length),
        of_dahl: deviations(3, &dahl),
        of_seven: deviations(7, &sevens),
    })
}

fn criteria(found: &FrictionMeasurement) -> Vec<Criterion> {
    let worst = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    vec![
        Criterion::at_least(
            "largest uncertainty of the seven parameters over that of Dahl's three, from the same map",
            "parameter measurements which are difficult to obtain",
            worst(&found.of_seven) / worst(&found.of_dahl),
            5.0,
            "what takes 25 times as long to measure is difficult to obtain",
        ),
        Criterion::with_range(
            "Bliman and Sorine: torque of a slow first displacement over the Coulomb level",
            "other dynamic models show stiction",
            found.peaks[1],
            [0.98 * STATIC, 1.02 * STATIC],
            "the law was given this static friction; the displacement is followed in steps of a thousandth",
        ),
        Criterion::at_most(
            "Dahl: torque of a slow first displacement over the Coulomb level",
            "does not include stiction",
            found.peaks[0],
            1.001,
            "no peak may show",
        ),
        Criterion::with_range(
            "Bliman and Sorine: stiffness of a small displacement over the one asked for",
            "another dynamic law",
            found.stiffness,
            [0.98, 1.02],
            "a displacement of a hundredth of the law's length",
        ),
        Criterion::at_most(
            "largest amplitude: distance of the seven-parameter model from Dahl's law, dB",
            "at large amplitude all models agree",
            found.seven_parameters[0],
            1.0,
            "1 dB is the width of a line in the figures",
        ),
        Criterion::at_least(
            "largest distance of the seven-parameter model at smaller amplitudes over that at the largest",
            "models differ at small amplitude",
            found.seven_parameters[1..].iter().copied().fold(0.0, f64::max) / found.seven_parameters[0],
            2.0,
            "twice as far can be seen",
        ),
    ]
}

fn figures(found: &FrictionMeasurement) -> Vec<Drawing> {
    let over =
        |values: &[f64]| RATES_RAD_S.iter().copied().zip(values.iter().copied()).map(Point::from).collect();
    let distances = vec![
        ClaimCurve::points("Bliman and Sorine", over(&found.bliman_sorine)),
        ClaimCurve::points("seven parameters", over(&found.seven_parameters)),
    ];
    let numbered = |values: &[f64]| {
        values.iter().enumerate().map(|(k, v)| Point::new((k + 1) as f64, 100.0 * v)).collect()
    };
    let uncertain = vec![
        ClaimCurve::points("seven parameters", numbered(&found.of_seven)),
        ClaimCurve::points("Dahl's three", numbered(&found.of_dahl)),
    ];
    let numbers =
        Axis::linear("1 stiffness, 2 Coulomb, 3 viscous, 4 static, 5 Stribeck rate, 6 memory, 7 rise", "");
    vec![
        make_figure(
            "Distance from Dahl's law, over amplitude",
            Axis::logarithmic("pitch rate", "rad/s"),
            vec![make_panel(Axis::linear("distance", "dB"), distances)],
        ),
        make_figure(
            "Uncertainty of each parameter",
            numbers,
            vec![make_panel(Axis::logarithmic("standard deviation", "%"), uncertain)],
        ),
    ]
}

/// Returns row C33: the laws that the thesis names and leaves aside.
///
/// # Errors
/// None beyond the tested design's.
pub fn laws_of_the_literature(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "C33",
        "seven-parameter and Bliman-Sorine friction",
        "2.3, 5.4",
        "the seven-parameter model is too complex, its parameters are difficult to measure; Dahl's law has no stiction; Bliman and Sorine developed another dynamic law",
    ];
    let Some(found) = measure(tested.parameters()) else {
        let why = "the mechanism's pivot friction is not Dahl's law, or it has no lumped structure";
        return Ok(Claim::not_measured(named, why));
    };
    let words = |values: &[f64]| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ");
    let percent = |name: &str, value: &f64| format!("{name} {:.1} %", 100.0 * value);
    let seven: Vec<String> = SevenParameters::NAMES
        .iter()
        .zip(&found.of_seven)
        .map(|(name, value)| percent(name, value))
        .collect();
    let dahl: Vec<String> =
        SevenParameters::NAMES.iter().zip(&found.of_dahl).map(|(name, value)| percent(name, value)).collect();
    Ok(Claim {
        measured: format!(
            "rigid and balanced, motor disconnected, 0.5 to 4 Hz; distance from Dahl's law of the same level and stiffness in dB at {} rad/s: Bliman and Sorine {}, seven parameters {}; uncertainty from a map known within {MEASURED_WITHIN_DB} dB: {}, with Dahl's law {}; torque of a slow first displacement over the Coulomb level: Dahl {:.3}, Bliman and Sorine {:.3}, which every reversal passes, so that this law stays apart from Dahl's at every amplitude",
            words(&RATES_RAD_S),
            words(&found.bliman_sorine),
            words(&found.seven_parameters),
            seven.join(", "),
            dahl.join(", "),
            found.peaks[0],
            found.peaks[1]
        ),
        criteria: criteria(&found),
        drawings: figures(&found),
        ..Claim::of(named)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No dry friction: J w' = d (w_p - w).
    struct FrictionlessLaw;

    impl Law for FrictionlessLaw {
        fn torque(&mut self, _: f64) -> f64 {
            0.0
        }
    }

    #[test]
    fn viscous_friction_alone_gives_a_first_order_response() {
        let hub = Hub { inertia_kg_m2: 3.0, viscous_nm_s_rad: 20.0 };
        for hz in FREQUENCIES_HZ {
            let exact = C64::new(20.0, 0.0) / C64::new(20.0, 3.0 * TAU * hz);
            let found = hub.response(&mut FrictionlessLaw, hz, 0.1);
            assert!((found / exact - 1.0).norm() < 1e-2, "{hz}: {found} {exact}");
        }
    }

    /// Between two reversals far apart, both laws end at the Coulomb level, and Bliman and Sorine's loses less than it stores never.
    #[test]
    fn both_laws_slide_at_the_coulomb_level_and_take_energy_over_a_cycle() {
        let mut all: [(Box<dyn Law>, f64); 2] = [
            (Box::new(BlimanSorine::new(100.0, 2e5, STATIC)), 1e-6),
            (
                Box::new(SevenParameterModel::new(SevenParameters {
                    stiffness_nm_rad: 2e5,
                    coulomb_nm: 100.0,
                    viscous_nm_s_rad: 0.0,
                    static_nm: 30.0,
                    stribeck_rad_s: STRIBECK_RAD_S,
                    memory_s: MEMORY_S,
                    rise_s: RISE_S,
                })),
                0.1,
            ),
        ];
        for (law, within) in &mut all {
            let (mut work, mut last) = (0.0, 0.0);
            for direction in [1.0, -1.0, 1.0] {
                for _ in 0..4000 {
                    let turn = direction * 5e-5;
                    last = law.torque(turn);
                    work += last * turn;
                }
                assert!((last - direction * 100.0).abs() < *within, "{last}");
            }
            assert!(work > 0.9 * 3.0 * 100.0 * 0.2, "{work}");
        }
    }
}
