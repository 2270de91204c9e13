//! The error budget: how much of the line of sight's error each source makes, by switching sources on and off in the simulator, and by the
//! linear loop.
//!
//! The mean square of the error with all sources is divided among them. Sources are switched on one after the other, and each is charged with
//! what the mean square grows by; this is done in one order and in the opposite one, and the two charges are averaged. The shares add
//! up to the simulated mean square whatever is nonlinear (they are Shapley values over these two orders; L. Shapley, 1953). A negative share
//! belongs to a source whose presence reduces the error of the others, as friction may. The same is done in each band of frequency.
//!
//! Beside it stands what each source makes alone, and what the linear loop makes of it ([`propagation`]). If the loop were linear and the sources
//! independent, the squares of either would add up, too: the differences say how far linear theory and superposition hold.
//!
//! Modules in reading order: [`sources`], [`propagation`].

pub mod propagation;
pub mod sources;

use counterpoise_controller::Controller;
use counterpoise_models::{FeedbackSignal, Plant};
use counterpoise_recordings::Signals;
use counterpoise_simulate::{Simulator, TimeHistory};

use crate::line_of_sight::{SightAngles, sight_experiment};
use crate::sight_spectrum::{Bands, SightSpectrum};
use crate::tolerance::LEAST_COMPARED_SIGHT_RAD;
use crate::{Error, LineOfSight, Procedure, nonlinear_runs};
use propagation::Propagation;
use sources::{BudgetMachine, switch_off};

pub use sources::ErrorSource;

/// Contribution of one source to the error: values in the order of [`crate::line_of_sight::SightError::values`].
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The source.
    pub source: ErrorSource,
    /// Share of the mean square, rad^2; negative if it reduces the error of the others.
    pub share_rad2: [f64; 5],
    /// RMS with this source alone, on the flexible structure, rad.
    pub alone_rad: [f64; 5],
    /// The share in each band.
    pub share: SightSpectrum,
    /// Contribution of the source in the linear loop; `None` if it has no place there.
    pub linear: Option<LinearContribution>,
}

/// Contribution of a source in the linear loop.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearContribution {
    /// RMS, rad, in the order of [`crate::line_of_sight::SightError::values`].
    pub rad: [f64; 5],
    /// The mean square in each band.
    pub spectrum: SightSpectrum,
}

/// The error of the line of sight and what it is made of: values in the order of [`crate::line_of_sight::SightError::values`].
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBudget {
    /// RMS with all sources, rad.
    pub total_rad: [f64; 5],
    /// RMS with none: what the start of the run leaves, rad.
    pub none_rad: [f64; 5],
    /// Every source that the machine and its motion have.
    pub contributions: Vec<Contribution>,
    /// Edges of the bands of all spectra, Hz.
    pub edges_hz: Vec<f64>,
    /// Spectrum with all sources.
    pub total: SightSpectrum,
    /// Spectrum with none.
    pub none: SightSpectrum,
    /// The runs from which all of this is computed.
    pub runs: Vec<BudgetRun>,
}

/// The error of the line of sight in a run with some of the sources.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetRun {
    /// The sources that are switched on.
    pub on: Vec<ErrorSource>,
    /// RMS, rad, in the order of [`crate::line_of_sight::SightError::values`].
    pub error_rad: [f64; 5],
}

impl Contribution {
    /// Returns what the linear loop makes of the source less what it makes alone in the simulation, rad, in the order of
    /// [`crate::line_of_sight::SightError::values`]; `None` if it has no place in a linear loop.
    pub fn linear_less_alone_rad(&self) -> Option<[f64; 5]> {
        let linear = self.linear.as_ref()?;
        Some(std::array::from_fn(|j| linear.rad[j] - self.alone_rad[j]))
    }
}

impl ErrorBudget {
    /// Returns the share of a source in the mean square of the run with all of them, percent, at a place in the order of
    /// [`crate::line_of_sight::SightError::values`]; 0 if nothing moves there.
    pub fn share_percent(&self, one: &Contribution, place: usize) -> f64 {
        let total_rad2 = self.total_rad[place].powi(2);
        if total_rad2 > 0.0 { 100.0 * one.share_rad2[place] / total_rad2 } else { 0.0 }
    }

    /// Returns by how much the RMS of the linear loop exceeds that of the simulation at a place, relative to it; `None` if the simulation has
    /// none that could be compared.
    pub fn linear_excess(&self, place: usize) -> Option<f64> {
        let total_rad = self.total_rad[place];
        (total_rad >= LEAST_COMPARED_SIGHT_RAD).then(|| self.linear_rad()[place] / total_rad - 1.0)
    }

    /// Returns the frequency below which a share of the mean square at the hub lies, Hz: an edge of a band. `None` if nothing moves.
    pub fn frequency_below_hz(&self, share: f64) -> Option<f64> {
        let total: f64 = self.total.hub_rad2.iter().sum();
        let mut sum = 0.0;
        let band = self.total.hub_rad2.iter().position(|square| {
            sum += square;
            sum >= share * total
        });
        self.edges_hz.get(band.filter(|_| total > 0.0)? + 1).copied()
    }

    /// Returns the middle of each band, Hz, and the power density in it, rad^2/Hz. The lowest band, which begins at 0 and so has no middle on a
    /// logarithmic axis, stands at half its width; a density that is not positive is NaN.
    pub fn densities(&self, bands_rad2: &[f64]) -> Vec<[f64; 2]> {
        let middle = |low: f64, high: f64| if low > 0.0 { (low * high).sqrt() } else { 0.5 * high };
        let density = |(edges, square): (&[f64], &f64)| {
            let density = square / (edges[1] - edges[0]);
            [middle(edges[0], edges[1]), if density > 0.0 { density } else { f64::NAN }]
        };
        self.edges_hz.windows(2).zip(bands_rad2).map(density).collect()
    }

    /// Returns the upper edge of each band, Hz, and the RMS of all bands up to it, rad.
    pub fn cumulative_rms(&self, bands_rad2: &[f64]) -> Vec<[f64; 2]> {
        self.sums(bands_rad2).into_iter().map(|[hz, sum]| [hz, sum.max(0.0).sqrt()]).collect()
    }

    /// Returns the upper edge of each band, Hz, and what a source has in all bands up to it, as a share of the whole.
    pub fn cumulative_share(&self, bands_rad2: &[f64], whole_rad2: &[f64]) -> Vec<[f64; 2]> {
        let whole: f64 = whole_rad2.iter().sum();
        self.sums(bands_rad2).into_iter().map(|[hz, sum]| [hz, sum / whole]).collect()
    }

    fn sums(&self, bands: &[f64]) -> Vec<[f64; 2]> {
        let mut sum = 0.0;
        let mut next = |(edge, square): (&f64, &f64)| {
            sum += square;
            [*edge, sum]
        };
        self.edges_hz.iter().skip(1).zip(bands).map(&mut next).collect()
    }

    /// Returns the sum of the spectra of the linear loop over all sources.
    pub fn linear_spectrum(&self) -> SightSpectrum {
        let start = SightSpectrum::at_rest(self.edges_hz.len().saturating_sub(1));
        let each = self.contributions.iter().filter_map(|one| one.linear.as_ref());
        each.fold(start, |sum, one| sum.plus(1.0, &one.spectrum))
    }

    /// Returns the root of the sum of all shares, rad: the simulated RMS.
    pub fn sum_rad(&self) -> [f64; 5] {
        std::array::from_fn(|j| {
            let shares: f64 = self.contributions.iter().map(|one| one.share_rad2[j]).sum();
            (shares + self.none_rad[j].powi(2)).max(0.0).sqrt()
        })
    }

    /// Returns the root of the sum of squares of what each source makes alone, rad: the RMS if superposition held.
    pub fn superposed_rad(&self) -> [f64; 5] {
        std::array::from_fn(|j| {
            self.contributions.iter().map(|one| one.alone_rad[j].powi(2)).sum::<f64>().sqrt()
        })
    }

    /// Returns the root of the sum of squares of what the linear loop makes of each source, rad.
    pub fn linear_rad(&self) -> [f64; 5] {
        std::array::from_fn(|j| {
            let linear = self.contributions.iter().filter_map(|one| one.linear.as_ref());
            linear.map(|one| one.rad[j].powi(2)).sum::<f64>().sqrt()
        })
    }
}

/// Divides the error of the line of sight of a controller on a plant among its sources; `None` if a motion with some of them diverges, if the
/// procedure does not ask for the line of sight, or if the loop does not hold a rate.
///
/// # Errors
/// Those of the plant, the controller and the simulator.
pub fn error_budget(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<Option<ErrorBudget>, Error> {
    let holds_rate = matches!(
        plant.parameters().sensors.measured,
        FeedbackSignal::HubRate | FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate
    );
    let Some(sight) = procedure.line_of_sight.filter(|_| holds_rate) else {
        return Ok(None);
    };
    let found = Runs { plant, controller, procedure, sight, done: Vec::new() }.budget();
    match found {
        Ok(budget) => Ok(Some(budget)),
        Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Returns the error of the line of sight in samples in a run with some of the sources alone; `None` if the run is shorter than two samples.
///
/// # Errors
/// Those of the plant, the controller and the simulator.
pub fn budget_angles(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    on: &[ErrorSource],
) -> Result<Option<SightAngles>, Error> {
    let sight = procedure.line_of_sight.unwrap_or_default();
    Runs { plant, controller, procedure, sight, done: Vec::new() }.angles(on)
}

/// Runs with some of the sources.
struct Runs<'a> {
    plant: &'a Plant,
    controller: &'a Controller,
    procedure: &'a Procedure,
    sight: LineOfSight,
    /// The runs so far, with their sources in the order of [`ErrorSource::ALL`].
    done: Vec<(Vec<ErrorSource>, RunError)>,
}

/// The error of one run.
#[derive(Debug, Clone, Default)]
struct RunError {
    rad: [f64; 5],
    spectrum: SightSpectrum,
}

impl Runs<'_> {
    fn budget(&mut self) -> Result<ErrorBudget, Error> {
        let all: Vec<ErrorSource> = ErrorSource::ALL.to_vec();
        let whole = self.run(&all)?;
        let samples = whole.len().saturating_sub(self.first_sample(&whole));
        let bands = Bands::of(samples, whole.sample_period_s);
        let present: Vec<ErrorSource> = all.into_iter().filter(|source| self.has(*source)).collect();
        let n = present.len();
        let forwards = self.switched_on(&present, &bands)?;
        let reversed: Vec<ErrorSource> = present.iter().rev().copied().collect();
        let backwards = self.switched_on(&reversed, &bands)?;
        let linear = Propagation::new(self.plant, self.controller, self.procedure, &bands)?;
        let mut contributions = Vec::with_capacity(n);
        for (k, source) in present.iter().enumerate() {
            let on = [&forwards[k], &forwards[k + 1]];
            let back = [&backwards[n - 1 - k], &backwards[n - k]];
            contributions.push(Contribution {
                source: *source,
                share_rad2: std::array::from_fn(|j| {
                    0.5 * (mean_square_growth(j, on) + mean_square_growth(j, back))
                }),
                alone_rad: self.error_of_source(*source, &bands)?.rad,
                share: mean_growth(on, back),
                linear: linear.as_ref().map(|loops| loops.of(*source, &whole)).transpose()?.flatten(),
            });
        }
        let (total, none) = (&forwards[n], &forwards[0]);
        Ok(ErrorBudget {
            total_rad: total.rad,
            none_rad: none.rad,
            contributions,
            edges_hz: bands.edges_hz,
            total: total.spectrum.clone(),
            none: none.spectrum.clone(),
            runs: self
                .done
                .iter()
                .map(|(on, error)| BudgetRun { on: on.clone(), error_rad: error.rad })
                .collect(),
        })
    }

    fn first_sample(&self, run: &TimeHistory) -> usize {
        let settle_s = self.procedure.sight_settle_s();
        run.time_s().partition_point(|time_s| *time_s < settle_s)
    }

    /// Returns the errors with none of the sources, with the first, with the first two, and so on.
    fn switched_on(&mut self, order: &[ErrorSource], bands: &Bands) -> Result<Vec<RunError>, Error> {
        (0..=order.len()).map(|count| self.error(&order[..count], bands)).collect()
    }

    /// Returns the error with a source alone. Bending moves nothing by itself, so the structure stays flexible: the other sources then show what
    /// they make of the tip.
    fn error_of_source(&mut self, source: ErrorSource, bands: &Bands) -> Result<RunError, Error> {
        match source {
            ErrorSource::Bending => self.error(&[source], bands),
            other => self.error(&[ErrorSource::Bending, other], bands),
        }
    }

    /// Returns the error with some of the sources; a run that was done before is not repeated.
    fn error(&mut self, on: &[ErrorSource], bands: &Bands) -> Result<RunError, Error> {
        let on: Vec<ErrorSource> = ErrorSource::ALL.into_iter().filter(|one| on.contains(one)).collect();
        if let Some((_, error)) = self.done.iter().find(|(known, _)| *known == on) {
            return Ok(error.clone());
        }
        let error = match self.angles(&on)? {
            Some(angles) => RunError {
                rad: angles.error(self.sight.exposure_s).values(),
                spectrum: bands.spectrum(&angles),
            },
            None => RunError { spectrum: SightSpectrum::at_rest(bands.len()), ..RunError::default() },
        };
        self.done.push((on, error.clone()));
        Ok(error)
    }

    fn angles(&self, on: &[ErrorSource]) -> Result<Option<SightAngles>, Error> {
        let run = self.run(on)?;
        let history =
            nonlinear_runs::columns_of(run, self.plant, self.procedure, sight_experiment(self.procedure));
        Ok(SightAngles::of(&history, self.procedure.sight_settle_s()))
    }

    /// Runs with some of the sources.
    fn run(&self, on: &[ErrorSource]) -> Result<TimeHistory, Error> {
        let mut from = self.every_source();
        ErrorSource::ALL
            .into_iter()
            .filter(|source| !on.contains(source))
            .for_each(|source| switch_off(source, &mut from));
        let plant = Plant::with_whole_body(&from.parameters, from.body)?;
        let mut simulator = Simulator::new(&plant)?;
        nonlinear_runs::run(
            &mut simulator,
            self.controller,
            &from.procedure,
            sight_experiment(&from.procedure),
        )
    }

    fn every_source(&self) -> BudgetMachine {
        BudgetMachine {
            parameters: self.plant.parameters().clone(),
            body: self.plant.body().clone(),
            procedure: self.procedure.clone(),
        }
    }

    /// Returns whether switching a source off changes anything.
    fn has(&self, source: ErrorSource) -> bool {
        let mut from = self.every_source();
        switch_off(source, &mut from);
        let moved = |procedure: &Procedure| match &procedure.road {
            Some(road) => road.signals.clone(),
            None => Signals::stack([&[procedure.heave.amplitude][..], &[procedure.pitch.amplitude]]),
        };
        from.parameters != *self.plant.parameters()
            || from.body != *self.plant.body()
            || moved(&from.procedure) != moved(self.procedure)
    }
}

/// Returns what a mean square grows by between two runs.
fn mean_square_growth(j: usize, [before, after]: [&RunError; 2]) -> f64 {
    after.rad[j].powi(2) - before.rad[j].powi(2)
}

/// The mean of what the spectrum grows by in two pairs of runs.
fn mean_growth(on: [&RunError; 2], back: [&RunError; 2]) -> SightSpectrum {
    let still = SightSpectrum::at_rest(on[0].spectrum.hub_rad2.len());
    let signed = [(0.5, on[1]), (-0.5, on[0]), (0.5, back[1]), (-0.5, back[0])];
    signed.into_iter().fold(still, |sum, (factor, run)| sum.plus(factor, &run.spectrum))
}
