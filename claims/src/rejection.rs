//! Claims on the rejection of the platform's motion: ratios of spectra on the road, and at a small amplitude.

use counterpoise_controller::Controller;
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_verify::linear_loop::closed_loop::is_feedforward;
use counterpoise_verify::robustness::{VariedParameter, figures_of};
use counterpoise_verify::signals::{Spectra, WelchOptions, rms, welch};
use counterpoise_verify::{
    Arrangement, Experiment, History, Model, PerformanceFigure, Quantity, Source, Value,
};

use super::drawing::{ClaimCurve, factor_axis, frequency_axis, make_figure, make_panel, time_axis};
use super::imbalance::apply_configuration;
use super::nonlinear_plant::change_parameter;
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// Samples of a segment of the spectra, their confidence, and the band over which a ratio is averaged, Hz.
const SEGMENT: usize = 4096;
const CONFIDENCE: f64 = 0.95;
const AVERAGED_HZ: (f64, f64) = (0.5, 3.0);
/// Range of frequency that is drawn, Hz.
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
        1e3 * rms(&self.history.hub_rate_rad_s()[self.history.index_at(from_s)..])
    }

    /// Returns the mean of the ratio over the band, dB.
    fn ratio_db(&self) -> f64 {
        let Some(spectra) = &self.spectra else { return f64::NAN };
        let both = spectra.frequency_hz.iter().zip(&spectra.ratio_db);
        let inside: Vec<f64> =
            both.filter(|(hz, _)| (AVERAGED_HZ.0..=AVERAGED_HZ.1).contains(*hz)).map(|(_, db)| *db).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    }
}

/// Returns row C22: out of balance with feedforward is as good as balanced.
///
/// # Errors
/// Those of the simulator.
pub fn balanced_against_compensated(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let (id, title, source) = ("C22", "as good as balanced", "7.4.2, figs 7-15, 7-16");
    let says = "out of balance with both feedforwards is stabilised as well as balanced; on the balanced plant that heave feedforward makes things worse";
    let Some(balanced) = apply_configuration(tested, "balanced")? else {
        return Ok(Claim::not_measured(
            [id, title, source, says],
            "the project has no configuration \"balanced\"",
        ));
    };
    let runs = runs(tested, &balanced)?;
    let rates: Vec<f64> = runs.iter().map(|run| run.rms_mrad_s(tested.procedure.settle_s)).collect();
    let words: Vec<String> = runs
        .iter()
        .zip(&rates)
        .map(|(run, rate)| {
            format!("{}, {} {rate:.2} mrad/s ({:.1} dB)", run.plant, run.control, run.ratio_db())
        })
        .collect();
    // out of balance: feedback alone, with pitch, with both; balanced: the same
    Ok(Claim {
        id,
        title,
        source,
        says,
        measured: format!(
            "RMS hub rate under the {} and, in brackets, DRR = |Pxy/Pxx| from pitch rate to hub rate, mean from {} to {} Hz: {}",
            if source_of(tested) == Source::Road { "recorded road" } else { "sines" },
            AVERAGED_HZ.0,
            AVERAGED_HZ.1,
            words.join("; ")
        ),
        criteria: vec![
            Criterion::at_most(
                "out of balance with both feedforwards over balanced with pitch, RMS hub rate",
                "as well as balanced",
                rates[2] / rates[4],
                1.3,
                "a third is 2 dB, the width of the thesis' measured curves",
            ),
            Criterion::at_least(
                "balanced with both over balanced with pitch, RMS hub rate",
                "makes things worse",
                rates[5] / rates[4],
                1.1,
                "a tenth can be seen in a figure",
            ),
        ],
        why: String::new(),
        drawings: balanced_against_compensated_figures(&runs),
    })
}

fn source_of(tested: &TestedDesign<'_>) -> Source {
    if tested.procedure.road.is_some() { Source::Road } else { Source::Both }
}

/// Returns both plants without feedforward, with that of pitch, and with both.
fn runs(tested: &TestedDesign<'_>, balanced: &Parameters) -> Result<Vec<Run>, PipelineError> {
    let pitch_only = without_heave(&tested.observed)?;
    let arranged = [
        ("feedback alone", &tested.observed, Arrangement::Feedback),
        ("with pitch", &pitch_only, Arrangement::Compensated),
        ("with both", &tested.observed, Arrangement::Compensated),
    ];
    let mut all = Vec::new();
    for (plant, parameters) in [("out of balance", tested.parameters()), ("balanced", balanced)] {
        for (control, controller, arrangement) in arranged {
            let experiment = Experiment::Disturbance(source_of(tested), arrangement);
            let history = tested.history(parameters, controller, experiment)?;
            let options = WelchOptions { segment: SEGMENT, confidence: CONFIDENCE };
            let period = parameters.interface.sample_period_s;
            let spectra = welch(history.pitch_rate_rad_s(), history.hub_rate_rad_s(), period, options).ok();
            all.push(Run { plant, control, history, spectra });
        }
    }
    Ok(all)
}

fn balanced_against_compensated_figures(runs: &[Run]) -> Vec<Drawing> {
    let mut all = Vec::new();
    for plant in ["out of balance", "balanced"] {
        let those: Vec<&Run> = runs.iter().filter(|run| run.plant == plant).collect();
        let panels = vec![
            make_panel(
                Axis::linear("|Pxy / Pxx|", "dB"),
                curves(&those, &|spectra| spectra.ratio_db.clone()),
            ),
            make_panel(Axis::linear("coherence", ""), curves(&those, &|spectra| spectra.coherence.clone())),
        ];
        all.push(
            make_figure(format!("DRR from pitch rate to hub rate, {plant}"), frequency_axis(), panels)
                .with_caption("From time histories on the nonlinear plant, by averaged spectra. Where the coherence is low, heave and friction move the hub."),
        );
        let slow = |history: &History| {
            let points = super::drawing::hub_rates(history);
            points.into_iter().filter(|point| (5.0..10.0).contains(&point.x)).collect()
        };
        let rates = those.iter().map(|run| ClaimCurve::line(run.control, slow(&run.history))).collect();
        all.push(make_figure(
            format!("Hub rate on the road, {plant}"),
            time_axis(),
            vec![super::drawing::hub_panel(rates)],
        ));
    }
    all
}

fn curves(runs: &[&Run], of: &dyn Fn(&Spectra) -> Vec<f64>) -> Vec<ClaimCurve> {
    let one = |run: &&Run| {
        let spectra = run.spectra.as_ref()?;
        let both = spectra.frequency_hz.iter().copied().zip(of(spectra));
        let points =
            both.filter(|point| (DRAWN_HZ.0..=DRAWN_HZ.1).contains(&point.0)).map(Point::from).collect();
        Some(ClaimCurve::line(run.control, points))
    };
    runs.iter().filter_map(one).collect()
}

/// Returns the controller without the path that sees the accelerometer.
fn without_heave(controller: &Controller) -> Result<Controller, PipelineError> {
    let heave = counterpoise_controller::PathSignal::PlatformAcceleration;
    let kept = controller
        .with(|parts| parts.paths.retain(|path| !(is_feedforward(path) && path.inputs.contains(&heave))));
    Ok(kept.map_err(counterpoise_verify::Error::from)?)
}

/// Returns row C23: rejection at small amplitude.
///
/// # Errors
/// Those of the verification.
pub fn small_amplitude_rejection(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let coulomb = tested.parameters().pivot_friction.coulomb_nm();
    let more = |torque_nm: f64| if coulomb > 0.0 { 1.0 + torque_nm / coulomb } else { 1.0 };
    let added = added_inertia(tested);
    let torques = [0.0, 50.0, 100.0, 150.0];
    let (mut rows, mut criteria) = (Vec::new(), Vec::new());
    for hz in BAND_HZ {
        let ratios = |varied, factors: &[f64]| ratios_db(tested, varied, factors, hz);
        let backlash = ratios(VariedParameter::Backlash, &[1.0, 2.0, 5.0])?;
        let inertia = ratios(VariedParameter::HubInertia, &added)?;
        let friction = ratios(VariedParameter::PivotFriction, &torques.map(more))?;
        criteria.extend(band_criteria(hz, [&backlash, &inertia, &friction]));
        rows.push([backlash, inertia, friction]);
    }
    let middle = rows.swap_remove(BAND_HZ.iter().position(|hz| *hz == 1.0).unwrap_or(0));
    let [backlash, inertia, friction] = &middle;
    Ok(Claim {
        id: "C23",
        title: "rejection at small amplitude",
        source: "7.5, fig 7-17",
        says: "DRR at amplitude 0.333 hardly changes with backlash and inertia, worsens with friction (+50, +100, +150 N m)",
        measured: format!(
            "at 1 Hz DRR in pitch {:.1} dB; change with backlash 1 to 5x {:.1} dB, the dumb-bells' inertia {:.1} dB, friction {:+.1} / {:+.1} / {:+.1} dB",
            friction[0],
            spread(backlash),
            spread(inertia),
            friction[1] - friction[0],
            friction[2] - friction[0],
            friction[3] - friction[0]
        ),
        criteria,
        why: String::new(),
        drawings: vec![
            observer_drawing("friction added at the pivot", Axis::linear("added", "N m"), &torques, friction),
            observer_drawing("backlash", factor_axis("backlash"), &[1.0, 2.0, 5.0], backlash),
            observer_drawing(
                "the dumb-bells' inertia",
                Axis::linear("hub inertia", "times the normal"),
                &added,
                inertia,
            ),
        ],
    })
}

/// Returns the largest change from the first value.
fn spread(found: &[f64]) -> f64 {
    found.iter().map(|db| (db - found[0]).abs()).fold(0.0, f64::max)
}

/// Frequencies of the pitch at which the families are measured, Hz.
const BAND_HZ: [f64; 4] = [0.5, 1.0, 2.0, 3.0];

fn band_criteria(hz: f64, [backlash, inertia, friction]: [&[f64]; 3]) -> [Criterion; 3] {
    let least_step = friction.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    [
        Criterion::at_most(
            &format!("{hz} Hz: largest change with backlash, dB"),
            "hardly changes",
            spread(backlash),
            1.0,
            "1 dB is the width of a line in the figure",
        ),
        Criterion::at_most(
            &format!("{hz} Hz: largest change with inertia, dB"),
            "hardly changes",
            spread(inertia),
            3.0,
            "the curves of the figure lie within 3 dB",
        ),
        Criterion::at_least(
            &format!("{hz} Hz: least change with 50 N m more friction, dB"),
            "worsens",
            least_step,
            0.5,
            "half a decibel is above the scatter",
        ),
    ]
}

fn observer_drawing(what: &str, x: Axis, factors: &[f64], db: &[f64]) -> Drawing {
    let points = factors.iter().copied().zip(db.iter().copied()).map(Point::from).collect();
    let panel = make_panel(
        Axis::linear("DRR in pitch", "dB"),
        vec![ClaimCurve::points("with observer, a third of the pitch", points)],
    );
    make_figure(format!("Rejection at small amplitude over {what}"), x, vec![panel])
}

/// Factors of the hub's inertia: as it is, and with each of the configurations' added inertias (the thesis' dumb-bells).
fn added_inertia(tested: &TestedDesign<'_>) -> Vec<f64> {
    let hub = tested.parameters().lumped.as_ref().map_or(f64::NAN, |lumped| lumped.hub_inertia_kg_m2);
    let added =
        tested.parameters().configurations.iter().map(|c| c.added_hub_inertia_kg_m2).filter(|j| *j > 0.0);
    std::iter::once(1.0).chain(added.map(|inertia| 1.0 + inertia / hub)).collect()
}

/// Returns the RMS hub rate over RMS pitch rate, dB, with the observed controller and a third of the
/// procedure's pitch.
fn ratios_db(
    tested: &TestedDesign<'_>,
    varied: VariedParameter,
    factors: &[f64],
    hz: f64,
) -> Result<Vec<f64>, PipelineError> {
    let mut small = tested.procedure.clone();
    small.pitch.amplitude /= 3.0;
    small.pitch.frequency_hz = hz;
    let figure = PerformanceFigure::Disturbance(
        Model::Nonlinear,
        Source::Pitch,
        Arrangement::Compensated,
        Quantity::HubRms,
    );
    let pitch_rms = small.pitch.amplitude.abs() / std::f64::consts::SQRT_2;
    let mut ratios = Vec::new();
    for &factor in factors {
        let plant = Plant::from_lumped(&change_parameter(tested, varied, factor)?)?;
        let values = figures_of(&plant, &tested.observed, &small, &[figure])?;
        let rms = if let Value::Is(rms) = values[0] { rms } else { f64::NAN };
        ratios.push(20.0 * (rms / pitch_rms).log10());
    }
    Ok(ratios)
}
