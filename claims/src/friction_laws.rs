//! Claims on the friction laws: their frequency maps, their cost, and what fitting them to one map gives.

use counterpoise_lti::C64;
use counterpoise_models::plant::Plant;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_simulate::fra::{Settings, Test, TestSine, disconnected, measure};
use counterpoise_simulate::{Scenario, Signal, Simulator};

use super::explicit::Sliding;
use super::picture::{Axis, Curve, Panel, Picture};
use super::{Bench, Claim, Finding};
use counterpoise_pipeline::PipelineError;

/// Full amplitude of the platform's pitch rate, rad/s, the thesis' shares of it, and the frequencies of the map, Hz.
const PITCH_RAD_S: f64 = 0.2;
const SHARES: [f64; 5] = [1.0, 0.667, 0.333, 0.167, 0.083];
const FREQUENCIES_HZ: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Damping of a bristle as a fraction of critical at the hub: what a user who knows nothing better writes.
const BRISTLE_DAMPING: f64 = 0.3;
/// Laws agree within this over the map's largest amplitude, dB.
const AGREES_DB: f64 = 1.0;

/// Complex responses at every frequency, amplitude after amplitude.
type Map = Vec<Vec<C64>>;

/// A law by its name, from what it shares with all others: level and stiffness at rest.
type Make = fn(Shared) -> FrictionLaw;

/// What the laws share.
#[derive(Clone, Copy)]
struct Shared {
    coulomb_nm: f64,
    stiffness_nm_rad: f64,
    inertia_kg_m2: f64,
}

impl Shared {
    fn damping(self) -> f64 {
        2.0 * BRISTLE_DAMPING * (self.stiffness_nm_rad * self.inertia_kg_m2).sqrt()
    }
}

/// Static laws first, then those with presliding.
const STATIC: [(&str, Make); 2] = [
    ("Coulomb", |s| FrictionLaw::Coulomb { coulomb_nm: s.coulomb_nm }),
    ("Karnopp", |s| FrictionLaw::Karnopp { coulomb_nm: s.coulomb_nm, stick_rate_rad_s: 1e-3 }),
];
const DYNAMIC: [(&str, Make); 2] = [
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

/// The mechanism balanced, with its motor disconnected.
fn free(bench: &Bench<'_>) -> Result<Parameters, PipelineError> {
    let mut parameters = bench.parameters().clone();
    if let Some(lumped) = &mut parameters.lumped {
        lumped.out_of_balance_kg_m = 0.0;
        lumped.vertical_offset_kg_m = 0.0;
    }
    Ok(disconnected(&parameters)?)
}

/// What the pivot's law shares with the others; `None` if it is not Dahl's.
fn shared(parameters: &Parameters) -> Option<Shared> {
    let inertia_kg_m2 = parameters.lumped.as_ref().map(|l| l.hub_inertia_kg_m2 + l.beam_inertia_kg_m2)?;
    match parameters.pivot_friction.law {
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } => {
            Some(Shared { coulomb_nm, stiffness_nm_rad: rest_stiffness_nm_rad, inertia_kg_m2 })
        }
        _ => None,
    }
}

fn with_law(parameters: &Parameters, law: FrictionLaw) -> Parameters {
    let mut out = parameters.clone();
    out.pivot_friction.law = law;
    out
}

/// Platform gyroscope to hub gyroscope over amplitudes and frequencies.
fn map(parameters: &Parameters) -> Result<Map, PipelineError> {
    let plant = Plant::lumped(parameters)?;
    let settings = Settings { least_duration_s: 1.0, settled_below: 1e-3, ..Settings::default() };
    let one = |share: f64, hz: f64| -> Result<C64, PipelineError> {
        let at = TestSine { frequency_rad_s: std::f64::consts::TAU * hz, amplitude: share * PITCH_RAD_S };
        Ok(measure(&plant, &mut Idle, Test::PlatformToHub, at, &settings)?.response.value)
    };
    SHARES.iter().map(|&share| FREQUENCIES_HZ.iter().map(|&hz| one(share, hz)).collect()).collect()
}

/// A control of nothing.
struct Idle;

impl counterpoise_controller::SampledController for Idle {
    fn reset(&mut self) {}
    fn step(&mut self, _: &counterpoise_controller::Readings) -> f64 {
        0.0
    }
}

/// RMS over the frequencies of the difference between two responses, in dB of the larger change of gain or phase.
fn apart_db(a: &[C64], b: &[C64]) -> f64 {
    let one = |(x, y): (&C64, &C64)| (20.0 * (1.0 + (x / y - 1.0).norm()).log10()).powi(2);
    (a.iter().zip(b).map(one).sum::<f64>() / a.len() as f64).sqrt()
}

fn distances(a: &Map, b: &Map) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| apart_db(x, y)).collect()
}

fn whole(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

fn words(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ")
}

/// What a row is called, where it stands and what it says.
type Named = (&'static str, &'static str, &'static str, &'static str);

fn no_dahl((id, title, source, says): Named) -> Claim {
    let why = "the mechanism's pivot friction is not Dahl's law, or it has no lumped structure";
    let finding = Finding::NotMeasured { why };
    Claim { id, title, source, says, measured: String::new(), finding, pictures: Vec::new() }
}

/// C15: the laws' frequency maps.
///
/// # Errors
/// Those of the simulator.
pub fn c15(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let (id, title, source) = ("C15", "friction models", "7.2, figs 7-2 to 7-5");
    let says = "at large amplitude all friction models agree; at small amplitude the static ones differ from the dynamic ones; Dahl fits the (Dahl-like) rig best";
    let free = free(bench)?;
    let Some(shared) = shared(&free) else { return Ok(no_dahl((id, title, source, says))) };
    let maps = c15_maps(&free, shared)?;
    let truth = &maps[0].1;
    let rows: Vec<(&'static str, Vec<f64>)> =
        maps[1..].iter().map(|(name, map)| (*name, distances(map, truth))).collect();
    let (fixed, moving) = rows.split_at(STATIC.len());
    let large = rows.iter().map(|row| row.1[0]).fold(0.0, f64::max);
    let smallest = SHARES.len() - 1;
    let least_static = fixed.iter().map(|row| row.1[smallest]).fold(f64::MAX, f64::min);
    let most_dynamic = moving.iter().map(|row| row.1[smallest]).fold(0.0, f64::max);
    let table: Vec<String> = rows.iter().map(|(name, row)| format!("{name} {}", words(row))).collect();
    let measured = format!(
        "balanced, motor disconnected, 0.5 to 4 Hz; distance from the rig's Dahl law in dB at pitch rates of 1 / 0.667 / 0.333 / 0.167 / 0.083 of {PITCH_RAD_S} rad/s: {}",
        table.join("; ")
    );
    let finding = match (large < AGREES_DB, least_static > most_dynamic) {
        (true, true) => Finding::Holds,
        (false, true) => Finding::Differs {
            why: format!(
                "below breakaway as claimed; at the largest amplitude the laws are still up to {large:.1} dB apart, for a reversal passes through presliding at every amplitude"
            ),
        },
        _ => Finding::Differs {
            why: format!(
                "at the smallest amplitude a dynamic law with bristle damping is {most_dynamic:.1} dB from Dahl, a static one {least_static:.1} dB: damping in presliding counts as much as stiffness"
            ),
        },
    };
    Ok(Claim { id, title, source, says, measured, finding, pictures: c15_pictures(&rows, &maps) })
}

/// A law and its map.
type Mapped = (&'static str, Map);

/// The rig's map and every law's.
fn c15_maps(free: &Parameters, shared: Shared) -> Result<Vec<Mapped>, PipelineError> {
    let mut all = vec![("Dahl (the rig)", map(free)?)];
    for (name, make) in STATIC.iter().chain(&DYNAMIC) {
        all.push((*name, map(&with_law(free, make(shared)))?));
    }
    Ok(all)
}

fn c15_pictures(rows: &[(&'static str, Vec<f64>)], maps: &[Mapped]) -> Vec<Picture> {
    let over = |values: &[f64]| SHARES.iter().copied().zip(values.iter().copied()).collect();
    let distance = rows.iter().map(|(name, row)| Curve::points(*name, over(row))).collect();
    let panel = Panel::of(Axis::even("distance from the rig's map", "dB"), distance)
        .level(AGREES_DB, "agree below this");
    let x = Axis::logarithmic("pitch rate over the largest", "");
    let mut all =
        vec![Picture::new("Distance of each friction law from the rig's, over amplitude", x, vec![panel])];
    for (k, share) in SHARES.iter().enumerate().filter(|(k, _)| [0, SHARES.len() - 1].contains(k)) {
        let of = |what: &dyn Fn(&C64) -> f64| -> Vec<Curve> {
            let points = |map: &Map| FREQUENCIES_HZ.iter().copied().zip(map[k].iter().map(what)).collect();
            maps.iter().map(|(name, map)| Curve::points(*name, points(map))).collect()
        };
        let panels = vec![
            Panel::of(Axis::even("hub over platform", "dB"), of(&|h| 20.0 * h.norm().log10())),
            Panel::of(Axis::even("phase", "deg"), of(&|h| h.arg().to_degrees())),
        ];
        all.push(Picture::new(format!("Platform to hub at amplitude {share}"), Axis::frequency(), panels));
    }
    all
}

/// C16: what a law costs. Work is counted, not timed: evaluations of the nonlinear parts, at one tolerance.
///
/// # Errors
/// Those of the simulator.
pub fn c16(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let (id, title, source) = ("C16", "cost of a model", "7.2");
    let says = "simulations with Dahl run 1.5 times as fast as with the reset integrator and 3 times as fast as with LuGre";
    let Some(shared) = shared(bench.parameters()) else { return Ok(no_dahl((id, title, source, says))) };
    let laws = [
        ("Dahl", bench.parameters().pivot_friction.law.clone()),
        ("reset integrator", DYNAMIC[1].1(shared)),
        ("LuGre", DYNAMIC[0].1(shared)),
    ];
    let mut own = [0; 3];
    let pitch = (bench.procedure.pitch.frequency_hz, bench.procedure.pitch.amplitude);
    let steps = |law: &FrictionLaw| -> Result<usize, PipelineError> {
        Ok(Sliding::new(law.clone(), shared.inertia_kg_m2, pitch)?.evaluations(WORKED_S))
    };
    let mut explicit = [0; 3];
    for (k, (_, law)) in laws.iter().enumerate() {
        own[k] = work(bench, &with_law(bench.parameters(), law.clone()))?;
        explicit[k] = steps(law)?;
    }
    let stiffer = |times: f64| steps(&lugre(shared, times));
    let damped = [stiffer(10.0)?, stiffer(100.0)?].map(|count| count as f64 / explicit[0] as f64);
    let ratio = |count: [usize; 3], k: usize| count[k] as f64 / count[0] as f64;
    let holds = ratio(own, 1) > 1.25 && ratio(own, 2) > 2.0;
    let why = format!(
        "neither solver tried shows it. The studio's integrator carries friction by its closed form in the displacement and hardly notices which law it has. The hypothesis that an explicit solver pays for stiffness was tried: one of order 5 with its own steps, on one inertia with the same three laws, takes {:.2} and {:.2} times as many evaluations for the reset integrator and LuGre as for Dahl ({}). LuGre costs more only with more bristle damping, {:.1} times Dahl's with ten times as much and {:.1} with a hundred times: the ratio is one of parameters and of the simulation language, neither of which the thesis prints",
        ratio(explicit, 1),
        ratio(explicit, 2),
        explicit[0],
        damped[0],
        damped[1]
    );
    Ok(Claim {
        id,
        title,
        source,
        says,
        measured: format!(
            "{WORKED_S} s of the closed loop under heave and pitch, one tolerance: {} evaluations with Dahl, {:.2} times that with the reset integrator, {:.2} times with LuGre",
            own[0],
            ratio(own, 1),
            ratio(own, 2)
        ),
        finding: if holds { Finding::Holds } else { Finding::Differs { why } },
        pictures: vec![c16_picture([own, explicit])],
    })
}

/// LuGre's law with so many times the damping of [`DYNAMIC`]'s.
fn lugre(shared: Shared, times: f64) -> FrictionLaw {
    FrictionLaw::Lugre {
        coulomb_nm: shared.coulomb_nm,
        bristle_stiffness_nm_rad: shared.stiffness_nm_rad,
        bristle_damping_nm_s_rad: times * shared.damping(),
    }
}

/// How long is simulated to count the work, s.
const WORKED_S: f64 = 10.0;

fn c16_picture(counts: [[usize; 3]; 2]) -> Picture {
    let names = ["studio's integrator, closed loop", "explicit, order 5, one inertia"];
    let curve = |(name, count): (&str, [usize; 3])| {
        let points = (0..3).map(|k| ((k + 1) as f64, count[k] as f64 / count[0] as f64)).collect();
        Curve::points(name, points)
    };
    let curves = names.into_iter().zip(counts).map(curve).collect();
    let thesis = Curve::beside("thesis", vec![(1.0, 1.0), (2.0, 1.5), (3.0, 3.0)]);
    let mut panel = Panel::of(Axis::even("work over that with Dahl", ""), curves);
    panel.curves.push(thesis);
    Picture::new(
        "What a friction law costs",
        Axis::even("1 Dahl, 2 reset integrator, 3 LuGre", ""),
        vec![panel],
    )
}

/// Evaluations in ten seconds of the closed loop while the platform heaves and pitches.
fn work(bench: &Bench<'_>, parameters: &Parameters) -> Result<usize, PipelineError> {
    let sine =
        |s: &counterpoise_verify::Sine| Signal::sine(s.amplitude, std::f64::consts::TAU * s.frequency_hz);
    let mut scenario = Scenario::still(10.0);
    scenario.platform.heave_m_s2 = sine(&bench.procedure.heave);
    scenario.platform.pitch_rate_rad_s = sine(&bench.procedure.pitch);
    let mut simulator = Simulator::new(&Plant::lumped(parameters)?)?;
    let run = simulator.run(&mut bench.controller().runner(), &scenario)?;
    Ok(run.effort.iterations + run.effort.rejected)
}

/// F3: LuGre and the reset integrator fitted to the map of the rig.
///
/// # Errors
/// Those of the simulator.
pub fn f3(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let (id, title, source) = ("F3", "why the others fit worse", "9.2");
    let says =
        "asks why LuGre and the reset integrator fitted worse than Dahl: parameters fitted to the same maps";
    let free = free(bench)?;
    let Some(shared) = shared(&free) else { return Ok(no_dahl((id, title, source, says))) };
    let truth = map(&free)?;
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
    let a = fitted(&|x| Ok(whole(&distances(&map(&with_law(&free, lugre(x)))?, &truth))))?;
    let b = fitted(&|x| Ok(whole(&distances(&map(&with_law(&free, reset(x)))?, &truth))))?;
    Ok(Claim {
        id,
        title,
        source,
        says,
        measured: format!(
            "RMS distance from the rig's map: LuGre {:.2} dB as matched, {:.2} dB fitted (stiffness x{:.2}, damping x{:.3}); reset integrator {:.2} dB, {:.2} dB fitted (x{:.2}, x{:.3}). LuGre without bristle damping is Dahl's law: damping alone set it apart; the reset integrator has no hysteresis before it slides, which neither its stiffness nor its damping supplies",
            a.before, a.after, a.at[0], a.at[1], b.before, b.after, b.at[0], b.at[1]
        ),
        finding: Finding::of(a.after < 0.5 * a.before && b.after <= b.before && a.after < b.after),
        pictures: vec![f3_picture(
            &truth,
            [
                ("LuGre as matched", map(&with_law(&free, lugre([1.0; 2])))?),
                ("LuGre fitted", map(&with_law(&free, lugre(a.at)))?),
                ("reset integrator as matched", map(&with_law(&free, reset([1.0; 2])))?),
                ("reset integrator fitted", map(&with_law(&free, reset(b.at)))?),
            ],
        )],
    })
}

/// Distance from the rig's map over amplitude, before and after the fit.
fn f3_picture(truth: &Map, maps: [Mapped; 4]) -> Picture {
    let one = |(k, (name, map)): (usize, Mapped)| {
        let points = SHARES.iter().copied().zip(distances(&map, truth)).collect();
        if k % 2 == 0 { Curve::beside(name, points) } else { Curve::points(name, points) }
    };
    let curves = maps.into_iter().enumerate().map(one).collect();
    let panel = Panel::of(Axis::even("distance from the rig's map", "dB"), curves);
    let x = Axis::logarithmic("pitch rate over the largest", "");
    Picture::new("Two laws fitted to the Dahl-like rig's map", x, vec![panel])
}

/// Where a fit began and ended.
struct Fitted {
    before: f64,
    after: f64,
    at: [f64; 2],
}

/// Each of two factors up and down, the step's square root taken when nothing is better.
fn fitted(distance: &dyn Fn([f64; 2]) -> Result<f64, PipelineError>) -> Result<Fitted, PipelineError> {
    const FIRST_STEP: f64 = 4.0;
    const LAST_STEP: f64 = 1.1;
    const LEAST: f64 = 1e-3;
    let mut at = [1.0, 1.0];
    let before = distance(at)?;
    let (mut after, mut step) = (before, FIRST_STEP);
    while step > LAST_STEP {
        let mut moved = false;
        for (k, factor) in [(0, step), (0, 1.0 / step), (1, step), (1, 1.0 / step)] {
            let mut next = at;
            next[k] *= factor;
            let found = if next[k] < LEAST { f64::INFINITY } else { distance(next)? };
            if found < after {
                (at, after, moved) = (next, found, true);
            }
        }
        if !moved {
            step = step.sqrt();
        }
    }
    Ok(Fitted { before, after, at })
}
