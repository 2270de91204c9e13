//! Claims on the friction laws: their frequency maps, their cost, and what fitting them to one map gives.

use counterpoise_linalg::C64;
use counterpoise_models::plant::Plant;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_simulate::fra::{Settings, Test, TestSine, disconnect_motor, measure_point};
use counterpoise_simulate::{Scenario, Signal, Simulator};

use super::drawing::{ClaimCurve, frequency_axis, make_figure, make_panel};
use super::explicit_solver::SlidingInertia;
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::{LAST_FACTOR_STEP, LAWS_AGREE_DB, LEAST_FACTOR};
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing, Point};
use ndarray::{Array2, ArrayView1};

/// Full amplitude of the platform's pitch rate, rad/s, the thesis' shares of it, and the frequencies of the map, Hz.
const PITCH_RAD_S: f64 = 0.2;
const SHARES: [f64; 5] = [1.0, 0.667, 0.333, 0.167, 0.083];
const FREQUENCIES_HZ: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Damping of a bristle as a fraction of critical at the hub: what a user who knows nothing better writes.
const BRISTLE_DAMPING: f64 = 0.3;

/// Complex responses, amplitude x frequency.
type AmplitudeMap = Array2<C64>;

/// A law by its name, from what it shares with all others: level and stiffness at rest.
type LawConstructor = fn(LawConstants) -> FrictionLaw;

/// The parameters that the laws share.
#[derive(Clone, Copy)]
struct LawConstants {
    coulomb_nm: f64,
    stiffness_nm_rad: f64,
    inertia_kg_m2: f64,
}

impl LawConstants {
    fn damping(self) -> f64 {
        2.0 * BRISTLE_DAMPING * (self.stiffness_nm_rad * self.inertia_kg_m2).sqrt()
    }
}

/// Static laws first, then those with presliding.
const STATIC: [(&str, LawConstructor); 2] = [
    ("Coulomb", |s| FrictionLaw::Coulomb { coulomb_nm: s.coulomb_nm }),
    ("Karnopp", |s| FrictionLaw::Karnopp { coulomb_nm: s.coulomb_nm, stick_rate_rad_s: 1e-3 }),
];
const DYNAMIC: [(&str, LawConstructor); 3] = [
    ("Dahl", |s| FrictionLaw::Dahl {
        coulomb_nm: s.coulomb_nm,
        rest_stiffness_nm_rad: s.stiffness_nm_rad,
        exponent: 1.0,
    }),
    ("LuGre", |s| FrictionLaw::Lugre {
        coulomb_nm: s.coulomb_nm,
        bristle_stiffness_nm_rad: s.stiffness_nm_rad,
        bristle_damping_nm_s_rad: s.damping(),
    }),
    ("reset integrator", |s| FrictionLaw::ResetIntegrator {
        coulomb_nm: s.coulomb_nm,
        deflection_rad: s.coulomb_nm / s.stiffness_nm_rad,
        damping_nm_s_rad: s.damping(),
    }),
];

/// Bristles of the machine that the laws are compared with, and how far one stretches over the deflection of the law before it slips. A
/// brush of bristles is none of the compared laws: a real machine differs from its model in structure.
const BRUSH: (usize, f64) = (12, 2.0);

/// Returns the law of the machine that the laws are compared with.
fn brush(s: LawConstants) -> FrictionLaw {
    FrictionLaw::Bristle {
        coulomb_nm: s.coulomb_nm,
        bristles: BRUSH.0,
        bond_rad: BRUSH.1 * s.coulomb_nm / s.stiffness_nm_rad,
    }
}

/// Returns the mechanism balanced, with its motor disconnected.
fn free_mechanism(tested: &TestedDesign<'_>) -> Result<Parameters, PipelineError> {
    let mut parameters = tested.parameters().clone();
    if let Some(lumped) = &mut parameters.lumped {
        lumped.out_of_balance_kg_m = 0.0;
        lumped.vertical_offset_kg_m = 0.0;
    }
    Ok(disconnect_motor(&parameters)?)
}

/// Returns what the pivot's law shares with the others; `None` if it is not Dahl's.
fn shared_quantities(parameters: &Parameters) -> Option<LawConstants> {
    let inertia_kg_m2 = parameters.lumped.as_ref().map(|l| l.hub_inertia_kg_m2 + l.beam_inertia_kg_m2)?;
    let pivot = &parameters.pivot_friction;
    if !matches!(pivot.law, FrictionLaw::Dahl { .. }) {
        return None;
    }
    let stiffness_nm_rad = pivot.presliding_stiffness_nm_rad()?;
    Some(LawConstants { coulomb_nm: pivot.coulomb_nm(), stiffness_nm_rad, inertia_kg_m2 })
}

fn with_law(parameters: &Parameters, law: FrictionLaw) -> Parameters {
    let mut out = parameters.clone();
    out.pivot_friction.law = law;
    out
}

/// Platform gyroscope to hub gyroscope over amplitudes and frequencies.
fn map(parameters: &Parameters) -> Result<AmplitudeMap, PipelineError> {
    let plant = Plant::from_lumped(parameters)?;
    let settings = Settings { least_duration_s: 1.0, settled_below: 1e-3, ..Settings::default() };
    let one = |share: f64, hz: f64| -> Result<C64, PipelineError> {
        let at = TestSine { frequency_rad_s: std::f64::consts::TAU * hz, amplitude: share * PITCH_RAD_S };
        Ok(measure_point(&plant, &mut ZeroControl, Test::PlatformToHub, at, &settings)?.response.value)
    };
    let mut map = AmplitudeMap::zeros((SHARES.len(), FREQUENCIES_HZ.len()));
    for ((row, column), value) in map.indexed_iter_mut() {
        *value = one(SHARES[row], FREQUENCIES_HZ[column])?;
    }
    Ok(map)
}

/// A control of nothing.
struct ZeroControl;

impl counterpoise_controller::SampledController for ZeroControl {
    fn reset(&mut self) {}
    fn step(&mut self, _: &counterpoise_controller::Readings) -> f64 {
        0.0
    }
}

/// Returns the RMS over the frequencies of the difference between two responses, in dB of the larger change of
/// gain or phase.
fn apart_db(a: ArrayView1<'_, C64>, b: ArrayView1<'_, C64>) -> f64 {
    let one = |(x, y): (&C64, &C64)| (20.0 * (1.0 + (x / y - 1.0).norm()).log10()).powi(2);
    (a.iter().zip(b).map(one).sum::<f64>() / a.len() as f64).sqrt()
}

fn distances(a: &AmplitudeMap, b: &AmplitudeMap) -> Vec<f64> {
    a.rows().into_iter().zip(b.rows()).map(|(x, y)| apart_db(x, y)).collect()
}

fn total_distance(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

fn words(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ")
}

fn no_dahl(named: [&'static str; 4]) -> Claim {
    let why = "the mechanism's pivot friction is not Dahl's law, or it has no lumped structure";
    Claim::not_measured(named, why)
}

/// Returns row C15: the laws' frequency maps.
///
/// # Errors
/// Those of the simulator.
pub fn friction_laws_over_amplitude(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "C15",
        "friction models",
        "7.2, figs 7-2 to 7-5",
        "at large amplitude all friction models agree; at small amplitude the static ones differ from the dynamic ones; Dahl fits the (Dahl-like) rig best",
    ];
    let free = free_mechanism(tested)?;
    let Some(shared) = shared_quantities(&free) else { return Ok(no_dahl(named)) };
    let maps = friction_laws_over_amplitude_maps(&free, shared)?;
    let truth = &maps[0].map;
    let row = |one: &LawMap| LawDistances { law: one.law, db: distances(&one.map, truth) };
    let rows: Vec<LawDistances> = maps[1..].iter().map(row).collect();
    let large = rows.iter().map(|row| row.db[0]).fold(0.0, f64::max);
    let table: Vec<String> = rows.iter().map(|row| format!("{} {}", row.law, words(&row.db))).collect();
    let measured = format!(
        "balanced, motor disconnected, 0.5 to 4 Hz; distance of each law, of the same level and presliding stiffness, from a machine with a brush of {} bristles, in dB at pitch rates of 1 / 0.667 / 0.333 / 0.167 / 0.083 of {PITCH_RAD_S} rad/s: {}",
        BRUSH.0,
        table.join("; ")
    );
    let why = format!(
        "at the largest amplitude the laws are still up to {large:.1} dB apart, for a reversal passes through presliding at every amplitude"
    );
    Ok(Claim {
        measured,
        criteria: friction_laws_over_amplitude_criteria(&rows, large),
        why,
        drawings: friction_laws_over_amplitude_figures(&rows, &maps),
        ..Claim::of(named)
    })
}

/// Returns what is asked of the laws' distances from the machine, the largest one at the largest amplitude given.
fn friction_laws_over_amplitude_criteria(rows: &[LawDistances], large: f64) -> Vec<Criterion> {
    let (fixed, moving) = rows.split_at(STATIC.len());
    let smallest = SHARES.len() - 1;
    let least_static = fixed.iter().map(|row| row.db[smallest]).fold(f64::MAX, f64::min);
    let most_dynamic = moving.iter().map(|row| row.db[smallest]).fold(0.0, f64::max);
    let overall =
        |name: &str| rows.iter().find(|row| row.law == name).map_or(f64::NAN, |row| total_distance(&row.db));
    let others = rows
        .iter()
        .filter(|row| row.law != "Dahl")
        .map(|row| total_distance(&row.db))
        .fold(f64::INFINITY, f64::min);
    vec![
        Criterion::at_most(
            "largest amplitude: farthest law from the machine, dB",
            "all agree",
            large,
            LAWS_AGREE_DB,
            "1 dB is the width of a line in the figures",
        )
        .with_explained_range(LAWS_AGREE_DB, 2.0),
        Criterion::at_least(
            "smallest amplitude: nearest static law over farthest dynamic law",
            "the static ones differ",
            least_static / most_dynamic,
            1.2,
            "a fifth farther can be seen",
        ),
        Criterion::at_most(
            "Dahl over the nearest other law, RMS over the map",
            "Dahl fits best",
            overall("Dahl") / others,
            1.0,
            "no other law may be nearer",
        ),
    ]
}

/// A law with its frequency map.
struct LawMap {
    law: &'static str,
    map: AmplitudeMap,
}

/// Distance of the map of a law from that of the machine.
struct LawDistances {
    law: &'static str,
    /// At each amplitude, dB.
    db: Vec<f64>,
}

/// Returns the rig's map and every law's.
fn friction_laws_over_amplitude_maps(
    free: &Parameters,
    shared: LawConstants,
) -> Result<Vec<LawMap>, PipelineError> {
    let mut all =
        vec![LawMap { law: "a brush of bristles (the machine)", map: map(&with_law(free, brush(shared)))? }];
    for (name, make) in STATIC.iter().chain(&DYNAMIC) {
        all.push(LawMap { law: name, map: map(&with_law(free, make(shared)))? });
    }
    Ok(all)
}

fn friction_laws_over_amplitude_figures(rows: &[LawDistances], maps: &[LawMap]) -> Vec<Drawing> {
    let over = |values: &[f64]| SHARES.iter().copied().zip(values.iter().copied()).map(Point::from).collect();
    let distance = rows.iter().map(|row| ClaimCurve::points(row.law, over(&row.db))).collect();
    let distances = make_panel(Axis::linear("distance from the rig's map", "dB"), distance)
        .with_level(LAWS_AGREE_DB, "agree below this");
    let x = Axis::logarithmic("pitch rate over the largest", "");
    let mut all =
        vec![make_figure("Distance of each friction law from the rig's, over amplitude", x, vec![distances])];
    for (k, share) in SHARES.iter().enumerate().filter(|(k, _)| [0, SHARES.len() - 1].contains(k)) {
        let of = |what: &dyn Fn(&C64) -> f64| -> Vec<ClaimCurve> {
            let points = |map: &AmplitudeMap| {
                FREQUENCIES_HZ
                    .iter()
                    .copied()
                    .zip(map.row(k).into_iter().map(what))
                    .map(Point::from)
                    .collect()
            };
            maps.iter().map(|one| ClaimCurve::points(one.law, points(&one.map))).collect()
        };
        let panels = vec![
            make_panel(Axis::linear("hub over platform", "dB"), of(&|h| 20.0 * h.norm().log10())),
            make_panel(Axis::degrees("phase"), of(&|h| h.arg().to_degrees())),
        ];
        all.push(make_figure(format!("Platform to hub at amplitude {share}"), frequency_axis(), panels));
    }
    all
}

/// Returns row C16: what a law costs. Work is counted, not timed: evaluations of the nonlinear parts, at one
/// tolerance.
///
/// # Errors
/// Those of the simulator.
pub fn cost_of_friction_laws(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "C16",
        "cost of a model",
        "7.2",
        "simulations with Dahl run 1.5 times as fast as with the reset integrator and 3 times as fast as with LuGre",
    ];
    let Some(shared) = shared_quantities(tested.parameters()) else { return Ok(no_dahl(named)) };
    let laws = [
        ("Dahl", tested.parameters().pivot_friction.law.clone()),
        ("reset integrator", DYNAMIC[2].1(shared)),
        ("LuGre", DYNAMIC[1].1(shared)),
    ];
    let mut own = [0; 3];
    let pitch = &tested.procedure.pitch;
    let steps = |law: &FrictionLaw| -> Result<usize, PipelineError> {
        let sliding =
            SlidingInertia::new(law.clone(), shared.inertia_kg_m2, pitch.frequency_hz, pitch.amplitude)?;
        Ok(sliding.evaluations(WORKED_S))
    };
    let mut explicit = [0; 3];
    for (k, (_, law)) in laws.iter().enumerate() {
        own[k] = work(tested, &with_law(tested.parameters(), law.clone()))?;
        explicit[k] = steps(law)?;
    }
    let stiffer = |times: f64| steps(&lugre(shared, times));
    let damped = [stiffer(10.0)?, stiffer(100.0)?].map(|count| count as f64 / explicit[0] as f64);
    let ratio = |count: [usize; 3], k: usize| count[k] as f64 / count[0] as f64;
    let why = format!(
        "neither solver tried shows it. The studio's integrator carries friction by its closed form in the displacement and hardly notices which law it has. The hypothesis that an explicit solver pays for stiffness was tried: one of order 5 with its own steps, on one inertia with the same three laws, takes {:.2} and {:.2} times as many evaluations for the reset integrator and LuGre as for Dahl ({}). LuGre costs more only with more bristle damping, {:.1} times Dahl's with ten times as much and {:.1} with a hundred times: the ratio is one of parameters and of the simulation language, neither of which the thesis prints",
        ratio(explicit, 1),
        ratio(explicit, 2),
        explicit[0],
        damped[0],
        damped[1]
    );
    Ok(Claim {
        measured: format!(
            "{WORKED_S} s of the closed loop under heave and pitch, one tolerance: {} evaluations with Dahl, {:.2} times that with the reset integrator, {:.2} times with LuGre",
            own[0],
            ratio(own, 1),
            ratio(own, 2)
        ),
        criteria: cost_criteria([ratio(own, 1), ratio(own, 2)], damped[1]),
        why,
        drawings: vec![cost_of_friction_laws_figure([own, explicit])],
        ..Claim::of(named)
    })
}

/// Returns what is asked of the work over Dahl's: in the closed loop for the reset integrator and LuGre, and by the explicit solver.
fn cost_criteria(own: [f64; 2], damped: f64) -> Vec<Criterion> {
    vec![
        Criterion::with_range(
            "closed loop: work with the reset integrator over Dahl",
            "1.5",
            own[0],
            [1.25, 1.8],
            "a fifth: the thesis rounds to halves",
        )
        .with_explained_range(0.8, 1.25),
        Criterion::with_range(
            "closed loop: work with LuGre over Dahl",
            "3",
            own[1],
            [2.4, 3.6],
            "a fifth: the thesis rounds to halves",
        )
        .with_explained_range(0.8, 1.25),
        Criterion::with_range(
            "explicit solver: work with LuGre of a hundred times the bristle damping over Dahl",
            "3",
            damped,
            [2.0, 4.5],
            "if stiffness is the reason, enough damping must give the thesis' ratio",
        ),
    ]
}

/// LuGre's law with so many times the damping of [`DYNAMIC`]'s.
fn lugre(shared: LawConstants, times: f64) -> FrictionLaw {
    FrictionLaw::Lugre {
        coulomb_nm: shared.coulomb_nm,
        bristle_stiffness_nm_rad: shared.stiffness_nm_rad,
        bristle_damping_nm_s_rad: times * shared.damping(),
    }
}

/// Time that is simulated to count the work, s.
const WORKED_S: f64 = 10.0;

fn cost_of_friction_laws_figure(counts: [[usize; 3]; 2]) -> Drawing {
    let names = ["studio's integrator, closed loop", "explicit, order 5, one inertia"];
    let curve = |(name, count): (&str, [usize; 3])| {
        let points = (0..3).map(|k| Point::new((k + 1) as f64, count[k] as f64 / count[0] as f64)).collect();
        ClaimCurve::points(name, points)
    };
    let thesis =
        ClaimCurve::reference("thesis", [(1.0, 1.0), (2.0, 1.5), (3.0, 3.0)].map(Point::from).to_vec());
    let curves = names.into_iter().zip(counts).map(curve).chain([thesis]).collect();
    let panel = make_panel(Axis::linear("work over that with Dahl", ""), curves);
    make_figure(
        "What a friction law costs",
        Axis::linear("1 Dahl, 2 reset integrator, 3 LuGre", ""),
        vec![panel],
    )
}

/// Evaluations in ten seconds of the closed loop while the platform heaves and pitches.
fn work(tested: &TestedDesign<'_>, parameters: &Parameters) -> Result<usize, PipelineError> {
    let sine =
        |s: &counterpoise_verify::Sine| Signal::sine(s.amplitude, std::f64::consts::TAU * s.frequency_hz);
    let mut scenario = Scenario::at_rest(10.0);
    scenario.platform.heave_m_s2 = sine(&tested.procedure.heave);
    scenario.platform.pitch_rate_rad_s = sine(&tested.procedure.pitch);
    let mut simulator = Simulator::new(&Plant::from_lumped(parameters)?)?;
    let run = simulator.run(&mut tested.controller().runner(), &scenario)?;
    Ok(run.effort.iterations + run.effort.rejected)
}

/// Returns row F3: LuGre and the reset integrator fitted to the map of the rig.
///
/// # Errors
/// Those of the simulator.
pub fn fitted_friction_laws(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "F3",
        "why the others fit worse",
        "9.2",
        "asks why LuGre and the reset integrator fitted worse than Dahl: parameters fitted to the same maps",
    ];
    let free = free_mechanism(tested)?;
    let Some(shared) = shared_quantities(&free) else { return Ok(no_dahl(named)) };
    let truth = map(&with_law(&free, brush(shared)))?;
    let dahl = total_distance(&distances(&map(&with_law(&free, DYNAMIC[0].1(shared)))?, &truth));
    let lugre = |x: [f64; 2]| FrictionLaw::Lugre {
        coulomb_nm: shared.coulomb_nm,
        bristle_stiffness_nm_rad: shared.stiffness_nm_rad * x[0],
        bristle_damping_nm_s_rad: shared.damping() * x[1],
    };
    let reset = |x: [f64; 2]| FrictionLaw::ResetIntegrator {
        coulomb_nm: shared.coulomb_nm,
        deflection_rad: shared.coulomb_nm / (shared.stiffness_nm_rad * x[0]),
        damping_nm_s_rad: shared.damping() * x[1],
    };
    let a = fit_factors(&|x| Ok(total_distance(&distances(&map(&with_law(&free, lugre(x)))?, &truth))))?;
    let b = fit_factors(&|x| Ok(total_distance(&distances(&map(&with_law(&free, reset(x)))?, &truth))))?;
    Ok(Claim {
        measured: format!(
            "RMS distance from the map of a machine with a brush of {} bristles: Dahl {dahl:.2} dB as matched; LuGre {:.2} dB as matched, {:.2} dB fitted (stiffness x{:.2}, damping x{:.3}); reset integrator {:.2} dB, {:.2} dB fitted (x{:.2}, x{:.3}). The usual bristle damping alone set both apart from the machine: with almost none they are no farther than Dahl's law",
            BRUSH.0, a.before, a.after, a.at[0], a.at[1], b.before, b.after, b.at[0], b.at[1]
        ),
        criteria: fitted_criteria(&a, &b, dahl),
        drawings: vec![fitted_friction_laws_figure(
            &truth,
            [
                LawMap { law: "LuGre as matched", map: map(&with_law(&free, lugre([1.0; 2])))? },
                LawMap { law: "LuGre fitted", map: map(&with_law(&free, lugre(a.at)))? },
                LawMap { law: "reset integrator as matched", map: map(&with_law(&free, reset([1.0; 2])))? },
                LawMap { law: "reset integrator fitted", map: map(&with_law(&free, reset(b.at)))? },
            ],
        )],
        ..Claim::of(named)
    })
}

/// Returns what is asked of LuGre and of the reset integrator, fitted.
fn fitted_criteria(a: &FitResult, b: &FitResult, dahl: f64) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "LuGre: distance fitted over as matched",
            "its parameters are the reason",
            a.after / a.before,
            0.7,
            "a third nearer shows that the parameters were wrong",
        ),
        Criterion::at_most(
            "LuGre fitted: bristle damping over the usual one",
            "its damping sets it apart",
            a.at[1],
            0.3,
            "most of the damping must go",
        ),
        Criterion::at_most(
            "LuGre fitted over Dahl as matched, distance",
            "its parameters are the reason",
            a.after / dahl,
            1.0,
            "if the parameters were the reason, the fitted law is no farther than Dahl's",
        ),
        Criterion::at_most(
            "reset integrator fitted over Dahl as matched, distance",
            "its parameters are the reason",
            b.after / dahl,
            1.0,
            "if the parameters were the reason, the fitted law is no farther than Dahl's",
        ),
    ]
}

/// Returns the distance from the rig's map over amplitude, before and after the fit.
fn fitted_friction_laws_figure(truth: &AmplitudeMap, maps: [LawMap; 4]) -> Drawing {
    let one = |(k, LawMap { law, map }): (usize, LawMap)| {
        let points = SHARES.iter().copied().zip(distances(&map, truth)).map(Point::from).collect();
        if k % 2 == 0 { ClaimCurve::reference(law, points) } else { ClaimCurve::points(law, points) }
    };
    let curves = maps.into_iter().enumerate().map(one).collect();
    let panel = make_panel(Axis::linear("distance from the rig's map", "dB"), curves);
    let x = Axis::logarithmic("pitch rate over the largest", "");
    make_figure("Two laws fitted to the Dahl-like rig's map", x, vec![panel])
}

/// Start and end of a fit.
struct FitResult {
    before: f64,
    after: f64,
    at: [f64; 2],
}

/// Returns each of two factors up and down, the step's square root taken when nothing is better.
fn fit_factors(
    distance: &dyn Fn([f64; 2]) -> Result<f64, PipelineError>,
) -> Result<FitResult, PipelineError> {
    const FIRST_STEP: f64 = 4.0;
    let mut at = [1.0, 1.0];
    let before = distance(at)?;
    let (mut after, mut step) = (before, FIRST_STEP);
    while step > LAST_FACTOR_STEP {
        let mut moved = false;
        for (k, factor) in [(0, step), (0, 1.0 / step), (1, step), (1, 1.0 / step)] {
            let mut next = at;
            next[k] *= factor;
            let found = if next[k] < LEAST_FACTOR { f64::INFINITY } else { distance(next)? };
            if found < after {
                (at, after, moved) = (next, found, true);
            }
        }
        if !moved {
            step = step.sqrt();
        }
    }
    Ok(FitResult { before, after, at })
}
