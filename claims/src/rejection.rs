//! Claims on the rejection of the platform's motion: ratios of spectra on the road, and at a small amplitude.

use counterpoise_controller::Controller;
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_verify::linear::closed::is_feedforward;
use counterpoise_verify::robust::{Varied, figures_of};
use counterpoise_verify::signals::{Spectra, WelchOptions, rms, welch};
use counterpoise_verify::{Arrangement, Experiment, Figure, History, Model, Quantity, Source, Value};

use super::imbalance::configured;
use super::nonlinear::changed;
use super::picture::{Axis, Curve, Panel, Picture};
use super::{Bench, Claim, Finding};
use counterpoise_pipeline::PipelineError;

/// Samples of a segment of the spectra, their confidence, and the band over which a ratio is averaged, Hz.
const SEGMENT: usize = 4096;
const CONFIDENCE: f64 = 0.95;
const AVERAGED_HZ: (f64, f64) = (0.5, 3.0);
/// What is drawn, Hz.
const DRAWN_HZ: (f64, f64) = (0.24, 10.0);

/// A plant on the road with one arrangement of the controller.
struct Run {
    plant: &'static str,
    control: &'static str,
    history: History,
    spectra: Option<Spectra>,
}

impl Run {
    fn rms_mrad_s(&self, from_s: f64) -> f64 {
        1e3 * rms(&self.history.hub_rate_rad_s[self.history.index_at(from_s)..])
    }

    /// Mean of the ratio over the band, dB.
    fn ratio_db(&self) -> f64 {
        let Some(spectra) = &self.spectra else { return f64::NAN };
        let both = spectra.frequency_hz.iter().zip(spectra.ratio_db());
        let inside: Vec<f64> =
            both.filter(|(hz, _)| (AVERAGED_HZ.0..=AVERAGED_HZ.1).contains(*hz)).map(|(_, db)| db).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    }
}

/// C22: out of balance with feedforward is as good as balanced.
///
/// # Errors
/// Those of the simulator.
pub fn c22(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let (id, title, source) = ("C22", "as good as balanced", "7.4.2, figs 7-15, 7-16");
    let says = "out of balance with both feedforwards is stabilised as well as balanced; on the balanced plant that heave feedforward makes things worse";
    let Some(balanced) = configured(bench, "balanced")? else {
        let finding = Finding::NotMeasured { why: "the project has no configuration \"balanced\"" };
        return Ok(Claim { id, title, source, says, measured: String::new(), finding, pictures: Vec::new() });
    };
    let runs = runs(bench, &balanced)?;
    let rates: Vec<f64> = runs.iter().map(|run| run.rms_mrad_s(bench.procedure.settle_s)).collect();
    let words: Vec<String> = runs
        .iter()
        .zip(&rates)
        .map(|(run, rate)| {
            format!("{}, {} {rate:.2} mrad/s ({:.1} dB)", run.plant, run.control, run.ratio_db())
        })
        .collect();
    // out of balance: none, pitch, both; balanced: none, pitch, both
    let (as_well, worse) = (rates[2] < 1.3 * rates[4], rates[5] > 1.1 * rates[4]);
    Ok(Claim {
        id,
        title,
        source,
        says,
        measured: format!(
            "RMS hub rate under the {} and, in brackets, DRR = |Pxy/Pxx| from pitch rate to hub rate, mean from {} to {} Hz: {}",
            if source_of(bench) == Source::Road { "recorded road" } else { "sines" },
            AVERAGED_HZ.0,
            AVERAGED_HZ.1,
            words.join("; ")
        ),
        finding: match (as_well, worse) {
            (true, true) => Finding::Holds,
            (false, true) => {
                Finding::Differs { why: "the balanced plant is quieter; the rest is as claimed".to_owned() }
            }
            _ => Finding::Fails,
        },
        pictures: c22_pictures(&runs),
    })
}

fn source_of(bench: &Bench<'_>) -> Source {
    if bench.procedure.road.is_some() { Source::Road } else { Source::Both }
}

/// Both plants without feedforward, with that of pitch, and with both.
fn runs(bench: &Bench<'_>, balanced: &Parameters) -> Result<Vec<Run>, PipelineError> {
    let pitch_only = without_heave(&bench.observed)?;
    let arranged = [
        ("feedback alone", &bench.observed, Arrangement::Feedback),
        ("with pitch", &pitch_only, Arrangement::Compensated),
        ("with both", &bench.observed, Arrangement::Compensated),
    ];
    let mut all = Vec::new();
    for (plant, parameters) in [("out of balance", bench.parameters()), ("balanced", balanced)] {
        for (control, controller, arrangement) in arranged {
            let experiment = Experiment::Disturbance(source_of(bench), arrangement);
            let history = bench.history(parameters, controller, experiment)?;
            let options = WelchOptions { segment: SEGMENT, confidence: CONFIDENCE };
            let period = parameters.interface.sample_period_s;
            let spectra = welch(&history.pitch_rate_rad_s, &history.hub_rate_rad_s, period, options).ok();
            all.push(Run { plant, control, history, spectra });
        }
    }
    Ok(all)
}

fn c22_pictures(runs: &[Run]) -> Vec<Picture> {
    let mut all = Vec::new();
    for plant in ["out of balance", "balanced"] {
        let those: Vec<&Run> = runs.iter().filter(|run| run.plant == plant).collect();
        let panels = vec![
            Panel::of(Axis::even("|Pxy / Pxx|", "dB"), curves(&those, &Spectra::ratio_db)),
            Panel::of(Axis::even("coherence", ""), curves(&those, &|spectra| spectra.coherence.clone())),
        ];
        all.push(
            Picture::new(format!("DRR from pitch rate to hub rate, {plant}"), Axis::frequency(), panels)
                .captioned("From time histories on the nonlinear plant, by averaged spectra. Where the coherence is low, heave and friction move the hub."),
        );
        let slow = |history: &History| {
            let points = super::picture::hub(history);
            points.into_iter().filter(|point| (5.0..10.0).contains(&point.0)).collect()
        };
        let rates = those.iter().map(|run| Curve::line(run.control, slow(&run.history))).collect();
        all.push(Picture::new(
            format!("Hub rate on the road, {plant}"),
            Axis::time(),
            vec![super::picture::hub_panel(rates)],
        ));
    }
    all
}

fn curves(runs: &[&Run], of: &dyn Fn(&Spectra) -> Vec<f64>) -> Vec<Curve> {
    let one = |run: &&Run| {
        let spectra = run.spectra.as_ref()?;
        let both = spectra.frequency_hz.iter().copied().zip(of(spectra));
        let points = both.filter(|point| (DRAWN_HZ.0..=DRAWN_HZ.1).contains(&point.0)).collect();
        Some(Curve::line(run.control, points))
    };
    runs.iter().filter_map(one).collect()
}

/// The controller without the path that sees the accelerometer.
fn without_heave(controller: &Controller) -> Result<Controller, PipelineError> {
    let heave = counterpoise_controller::Signal::PlatformAcceleration;
    let kept = controller
        .with(|parts| parts.paths.retain(|path| !(is_feedforward(path) && path.inputs.contains(&heave))));
    Ok(kept.map_err(counterpoise_verify::Error::from)?)
}

/// C23: rejection at small amplitude.
///
/// # Errors
/// Those of the verification.
pub fn c23(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let coulomb = bench.parameters().pivot_friction.coulomb_nm();
    let more = |torque_nm: f64| if coulomb > 0.0 { 1.0 + torque_nm / coulomb } else { 1.0 };
    let added = added_inertia(bench);
    let torques = [0.0, 50.0, 100.0, 150.0];
    let backlash = ratios_db(bench, Varied::Backlash, &[1.0, 2.0, 5.0])?;
    let inertia = ratios_db(bench, Varied::HubInertia, &added)?;
    let friction = ratios_db(bench, Varied::PivotFriction, &torques.map(more))?;
    let spread = |found: &[f64]| found.iter().map(|db| (db - found[0]).abs()).fold(0.0, f64::max);
    let worse = friction.windows(2).all(|pair| pair[1] > pair[0]);
    let still = spread(&backlash) < 1.0 && spread(&inertia) < 3.0;
    Ok(Claim {
        id: "C23",
        title: "rejection at small amplitude",
        source: "7.5, fig 7-17",
        says: "DRR at amplitude 0.333 hardly changes with backlash and inertia, worsens with friction (+50, +100, +150 N m)",
        measured: format!(
            "DRR in pitch {:.1} dB; change with backlash 1 to 5x {:.1} dB, the dumb-bells' inertia {:.1} dB, friction {:+.1} / {:+.1} / {:+.1} dB",
            friction[0],
            spread(&backlash),
            spread(&inertia),
            friction[1] - friction[0],
            friction[2] - friction[0],
            friction[3] - friction[0]
        ),
        finding: match (worse, still) {
            (true, true) => Finding::Holds,
            (true, false) => Finding::Differs {
                why: "friction worsens it as claimed; inertia matters too on this rig".to_owned(),
            },
            _ => Finding::Fails,
        },
        pictures: vec![
            drawn("friction added at the pivot", Axis::even("added", "N m"), (&torques, &friction)),
            drawn("backlash", Axis::factor("backlash"), (&[1.0, 2.0, 5.0], &backlash)),
            drawn(
                "the dumb-bells' inertia",
                Axis::even("hub inertia", "times the normal"),
                (&added, &inertia),
            ),
        ],
    })
}

fn drawn(what: &str, x: Axis, (factors, db): (&[f64], &[f64])) -> Picture {
    let points = factors.iter().copied().zip(db.iter().copied()).collect();
    let panel = Panel::of(
        Axis::even("DRR in pitch", "dB"),
        vec![Curve::points("with observer, a third of the pitch", points)],
    );
    Picture::new(format!("Rejection at small amplitude over {what}"), x, vec![panel])
}

/// Factors of the hub's inertia: as it is, and with each of the configurations' added inertias (the thesis' dumb-bells).
fn added_inertia(bench: &Bench<'_>) -> Vec<f64> {
    let hub = bench.parameters().lumped.as_ref().map_or(f64::NAN, |lumped| lumped.hub_inertia_kg_m2);
    let added =
        bench.parameters().configurations.iter().map(|c| c.added_hub_inertia_kg_m2).filter(|j| *j > 0.0);
    std::iter::once(1.0).chain(added.map(|inertia| 1.0 + inertia / hub)).collect()
}

/// RMS hub rate over RMS pitch rate, dB, with the observed controller and a third of the procedure's pitch.
fn ratios_db(bench: &Bench<'_>, varied: Varied, factors: &[f64]) -> Result<Vec<f64>, PipelineError> {
    let mut small = bench.procedure.clone();
    small.pitch.amplitude /= 3.0;
    let figure =
        Figure::Disturbance(Model::Nonlinear, Source::Pitch, Arrangement::Compensated, Quantity::HubRms);
    let pitch_rms = small.pitch.amplitude.abs() / std::f64::consts::SQRT_2;
    let mut ratios = Vec::new();
    for &factor in factors {
        let plant = Plant::lumped(&changed(bench, varied, factor)?)?;
        let values = figures_of(&plant, &bench.observed, &small, &[figure])?;
        let rms = if let Value::Is(rms) = values[0] { rms } else { f64::NAN };
        ratios.push(20.0 * (rms / pitch_rms).log10());
    }
    Ok(ratios)
}
