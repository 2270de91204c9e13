//! The design over out-of-balance: when a gain is enough, and when the controller must be designed anew.
//!
//! Theory: with the plant's inertia kept, no gravity gradient and separate costs, the out-of-balance M enters through the
//! heave columns alone, in proportion. Then feedback and pitch feedforward do not change, and the heave feedforward is
//! M times a fixed module. Here these conditions are *checked* on the plants, not believed.

use counterpoise_linalg::Mat;
use counterpoise_lti::StateSpace;
use counterpoise_lti::response::Response;

use crate::residual::stabilisation_error;
use crate::tolerance::{EQUAL, GAIN_LAW};
use crate::{Design, DesignPlant, DisturbanceChannel, Error, Specification, design};

/// A state of the machine: masses fitted, plant linearised with them.
#[derive(Debug, Clone, PartialEq)]
pub struct ScheduleConfiguration {
    /// Name.
    pub name: String,
    /// Out-of-balance, kg m.
    pub out_of_balance_kg_m: f64,
    /// Plant, with states and signals in the order of the nominal one.
    pub plant: DesignPlant,
}

/// The band over which controllers are compared, rad/s: 0.1 to 20 Hz.
pub const BAND_RAD_S: (f64, f64) = (0.628, 126.0);
/// Number of frequencies in the band.
const BAND_POINTS: usize = 60;

/// The conditions of the gain law, each as the largest relative deviation that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Control and measurement path: A, control column, outputs. Zero: feedback and pitch need not change.
    pub path_deviation: f64,
    /// Pitch columns.
    pub pitch_deviation: f64,
    /// Heave columns against the ratio of the out-of-balances.
    pub proportion_deviation: f64,
    /// Columns of the white disturbances that the feedback's filter assumes.
    pub noise_deviation: f64,
}

impl Conditions {
    /// Returns whether theory says that the feedback need not change.
    pub fn feedback_stays(&self) -> bool {
        self.path_deviation.max(self.noise_deviation) <= EQUAL
    }

    /// Returns whether theory says that the gain law is exact.
    pub fn hold(&self) -> bool {
        self.path_deviation.max(self.pitch_deviation).max(self.proportion_deviation) <= EQUAL
    }
}

/// Treatment of the heave feedforward in a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeaveFeedforwardLaw {
    /// The gain times the ratio of the out-of-balances; exact by theory.
    ExactGain {
        /// M over the nominal M.
        factor: f64,
    },
    /// The gain law does not hold exactly, but deviates from the redesign by no more than [`GAIN_LAW`] in the band.
    NearlyGain {
        /// M over the nominal M.
        factor: f64,
        /// Largest deviation in the band, relative to the redesign.
        deviation: f64,
    },
    /// A design of its own.
    Redesign {
        /// Largest deviation of the gain law in the band, relative to the redesign; infinite without nominal imbalance.
        deviation: f64,
    },
}

/// One configuration of the schedule.
#[derive(Debug, Clone, PartialEq)]
pub struct ScheduleEntry {
    /// Name.
    pub name: String,
    /// Out-of-balance, kg m.
    pub out_of_balance_kg_m: f64,
    /// Conditions that hold.
    pub conditions: Conditions,
    /// Consequence for the heave feedforward.
    pub law: HeaveFeedforwardLaw,
    /// The full redesign.
    pub design: Design,
    /// Change of the feedback against nominal, lowest and highest over the band, dB.
    pub feedback_db: (f64, f64),
    /// Change of the heave feedforward; `None` if there is none.
    pub heave_db: Option<(f64, f64)>,
    /// Change of the pitch feedforward.
    pub pitch_db: Option<(f64, f64)>,
    /// RMS hub rate under the heave generator with the nominal controllers, rad/s.
    pub error_before: Option<f64>,
    /// The same with the nominal controllers and the gain law.
    pub error_gain_law: Option<f64>,
    /// The same with the redesign.
    pub error_after: Option<f64>,
}

/// Designs every configuration anew and says what a gain would have done.
///
/// # Errors
/// [`Error`] for plants that do not match the nominal one; [`Error::Refused`] for a configuration without solution.
pub fn design_schedule(
    nominal: &ScheduleConfiguration,
    others: &[ScheduleConfiguration],
    specification: &Specification,
) -> Result<Vec<ScheduleEntry>, Error> {
    let base = design(&nominal.plant, specification)?;
    let mut entries = Vec::new();
    for configuration in std::iter::once(nominal).chain(others) {
        let design = design(&configuration.plant, specification)?;
        entries.push(entry(nominal, configuration, &base, design)?);
    }
    Ok(entries)
}

fn entry(
    nominal: &ScheduleConfiguration,
    here: &ScheduleConfiguration,
    base: &Design,
    design: Design,
) -> Result<ScheduleEntry, Error> {
    let factor = here.out_of_balance_kg_m / nominal.out_of_balance_kg_m;
    let noises: Vec<usize> =
        design.specification.feedback.disturbances.iter().map(|entry| entry.index).collect();
    let conditions = check_gain_law(&nominal.plant, &here.plant, factor, &noises)?;
    let law = law(conditions, base, &design, factor)?;
    let error = |with: &Design, gain: f64| match with.heave {
        Some(_) => stabilisation_error(&here.plant, with, DisturbanceChannel::Heave, gain).map(Some),
        None => Ok(None),
    };
    let gain = if factor.is_finite() { factor } else { 1.0 };
    let change =
        |channel| match (base.feedforward_controller(channel), design.feedforward_controller(channel)) {
            (Some(before), Some(after)) => change_db(&before, &after).map(Some),
            _ => Ok(None),
        };
    Ok(ScheduleEntry {
        name: here.name.clone(),
        out_of_balance_kg_m: here.out_of_balance_kg_m,
        conditions,
        law,
        feedback_db: change_db(&base.feedback_controller(), &design.feedback_controller())?,
        heave_db: change(DisturbanceChannel::Heave)?,
        pitch_db: change(DisturbanceChannel::Pitch)?,
        error_before: error(base, 1.0)?,
        error_gain_law: error(base, gain)?,
        error_after: error(&design, 1.0)?,
        design,
    })
}

/// Checks the conditions of the gain law on two plants: the ratio of their out-of-balances, and the inputs of the white
/// disturbances that the feedback assumes.
///
/// # Errors
/// [`Error::System`] if the plants have different sizes.
pub fn check_gain_law(
    nominal: &DesignPlant,
    here: &DesignPlant,
    factor: f64,
    noises: &[usize],
) -> Result<Conditions, Error> {
    let (a, b) = (&nominal.system, &here.system);
    let same = a.order() == b.order() && a.D.shape() == b.D.shape() && nominal.heave == here.heave;
    if !same || nominal.pitch != here.pitch || nominal.control != here.control {
        return Err(Error::System {
            what: "configuration",
            problem: "its plant differs in size from the nominal one",
        });
    }
    let states: Vec<usize> = (0..a.order()).collect();
    let columns = |g: &StateSpace, inputs: &[usize]| g.B.select(&states, inputs);
    let path = deviation(&a.A, &b.A)
        .max(deviation(&columns(a, &[nominal.control]), &columns(b, &[here.control])))
        .max(deviation(&a.C, &b.C));
    let heave = columns(a, &nominal.heave).scale(factor);
    Ok(Conditions {
        path_deviation: path,
        pitch_deviation: deviation(&columns(a, &nominal.pitch), &columns(b, &here.pitch)),
        proportion_deviation: deviation(&heave, &columns(b, &here.heave)),
        noise_deviation: deviation(&columns(a, noises), &columns(b, noises)),
    })
}

/// |b - a| / |a|, infinite if that is no number.
fn deviation(a: &Mat, b: &Mat) -> f64 {
    let difference = (a - b).norm_fro();
    if difference == 0.0 {
        return 0.0;
    }
    let relative = difference / a.norm_fro();
    if relative.is_nan() { f64::INFINITY } else { relative }
}

fn law(
    conditions: Conditions,
    base: &Design,
    here: &Design,
    factor: f64,
) -> Result<HeaveFeedforwardLaw, Error> {
    let modules = (
        base.feedforward_controller(DisturbanceChannel::Heave),
        here.feedforward_controller(DisturbanceChannel::Heave),
    );
    if conditions.hold() {
        return Ok(HeaveFeedforwardLaw::ExactGain { factor });
    }
    let (Some(before), Some(after)) = modules else {
        return Ok(HeaveFeedforwardLaw::NearlyGain { factor, deviation: 0.0 });
    };
    if !factor.is_finite() {
        return Ok(HeaveFeedforwardLaw::Redesign { deviation: f64::INFINITY });
    }
    let deviation = worst_deviation(&before, &after, factor)?;
    Ok(if deviation <= GAIN_LAW {
        HeaveFeedforwardLaw::NearlyGain { factor, deviation }
    } else {
        HeaveFeedforwardLaw::Redesign { deviation }
    })
}

/// Largest |after - factor before| in the band over the largest |after|.
fn worst_deviation(before: &StateSpace, after: &StateSpace, factor: f64) -> Result<f64, Error> {
    let (before, after) = (Response::of(before)?, Response::of(after)?);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for rate in band() {
        let (a, b) = (before.at(rate)?[(0, 0)], after.at(rate)?[(0, 0)]);
        worst = worst.max((b - a * factor).norm());
        largest = largest.max(b.norm());
    }
    Ok(if worst == 0.0 { 0.0 } else { worst / largest })
}

fn band() -> impl Iterator<Item = f64> {
    let (low, high) = BAND_RAD_S;
    (0..BAND_POINTS).map(move |k| low * (high / low).powf(k as f64 / (BAND_POINTS - 1) as f64))
}

/// Lowest and highest change of a controller's gain over the band, dB, on its last input.
fn change_db(before: &StateSpace, after: &StateSpace) -> Result<(f64, f64), Error> {
    let last = before.inputs() - 1;
    let (before, after) = (Response::of(before)?, Response::of(after)?);
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for rate in band() {
        let ratio = after.at(rate)?[(0, last)].norm() / before.at(rate)?[(0, last)].norm();
        let db = 20.0 * ratio.log10();
        (lowest, highest) = (lowest.min(db), highest.max(db));
    }
    Ok((lowest, highest))
}
