//! The checks before solving: every way in which weights and plant do not make a solvable problem, named in their terms.

use counterpoise_lti::linalg::csingular_values;
use counterpoise_lti::response::Response;
use counterpoise_lti::{C64, CMat, Mat, StateSpace, poles, zeros};

use crate::cause::Cause;
use crate::finding::{Finding, Part};
use crate::{
    Channel, DesignPlant, Error, FeedbackWeights, Knowledge, Rational, Reference, Specification, Weight,
};

/// A gain smaller than this, relative to the plant's largest, counts as zero.
pub const ZERO_GAIN: f64 = 1e-9;
/// A mode counts as out of reach where the smallest singular value of \[A - pI, B\] is below this, relative to A.
pub const OUT_OF_REACH: f64 = 1e-12;
/// A pole counts as lying on the axis where its real part is below this, relative to the largest pole.
pub const ON_AXIS: f64 = 1e-12;
/// A response at its zero is at most this share of that beside it.
pub const VANISHES: f64 = 1e-3;
/// Phase that the delay may cost at the crossover of the weights before a warning, rad.
pub const DELAY_PHASE: f64 = 0.5;
/// Frequencies at which gains are compared: decades from 10^LOWEST to 10^HIGHEST rad/s, so many points each.
const LOWEST: i32 = -3;
const HIGHEST: i32 = 5;
const POINTS: i32 = 24;

/// Every finding about a plant and a specification, refusals first; empty where nothing stands in the way.
///
/// # Errors
/// [`Error`] where the plant itself is not one (wrong indices, a sensor with two inputs).
pub fn preflight(plant: &DesignPlant, specification: &Specification) -> Result<Vec<Finding>, Error> {
    let mut findings = check_plant(plant)?;
    findings.extend(check_feedback(plant, &specification.feedback, specification.reference)?);
    for channel in [Channel::Heave, Channel::Pitch] {
        if specification.feedforward(channel).is_some() {
            findings.extend(check_feedforward(plant, specification, channel)?);
        }
    }
    findings.sort_by_key(|finding| !finding.is_refusal());
    Ok(findings)
}

fn check_plant(plant: &DesignPlant) -> Result<Vec<Finding>, Error> {
    let system = plant.measured()?;
    let (A, n) = (&system.A, system.order());
    let mut findings = Vec::new();
    let direct = system.D[(0, plant.control)];
    if direct != 0.0 {
        findings.push(Finding::refusal(Part::Plant, Cause::DirectPath { gain: direct }).at(f64::INFINITY));
    }
    if plant.delay_s > 0.0 && plant.pade_order == 0 {
        findings.push(Finding::warning(Part::Plant, Cause::DelayLeftOut { delay_s: plant.delay_s }));
    }
    let (B, C) = (system.B.block(0, plant.control, n, 1), system.C.block(0, 0, 1, n));
    for pole in not_stable(&poles(&system)?) {
        if !reaches(A, &B, pole)? {
            findings.push(Finding::refusal(Part::Plant, Cause::NotStabilisable { pole }).at(pole.im.abs()));
        }
        if !reaches(&A.t(), &C.t(), pole)? {
            findings.push(Finding::refusal(Part::Plant, Cause::NotDetectable { pole }).at(pole.im.abs()));
        }
    }
    Ok(findings)
}

fn check_feedback(
    plant: &DesignPlant,
    weights: &FeedbackWeights,
    reference: Reference,
) -> Result<Vec<Finding>, Error> {
    let part = Part::Feedback;
    let mut findings = weight_forms(part, &weights.error, &weights.control);
    findings.extend(densities(weights));
    if reference == Reference::WeightOnly && weights.error.rational().poles.is_empty() {
        let finding = Finding::refusal(part, Cause::ReferenceWithoutStates);
        findings.push(finding.on("error weight", &weights.error));
    }
    if findings.iter().any(Finding::is_refusal) {
        return Ok(findings);
    }
    let system = plant.measured()?;
    let loop_gain = Gain::of(&system.select(&[0], &[plant.control]))?;
    findings.extend(against_plant(part, &weights.error, &weights.control, &loop_gain)?);
    let truth = Gain::of(&system.select(&[1 + plant.rate], &[plant.control]))?;
    name_blind_sensor(&mut findings, &truth)?;
    findings.extend(noise_reaches(&system, plant.control, weights)?);
    findings.extend(limits(plant, weights, &loop_gain)?);
    Ok(findings)
}

fn check_feedforward(
    plant: &DesignPlant,
    spec: &Specification,
    channel: Channel,
) -> Result<Vec<Finding>, Error> {
    let (part, columns) = (Part::from(channel), plant.columns(channel));
    let Some(weights) = spec.feedforward(channel) else { return Ok(Vec::new()) };
    let mut findings = weight_forms(part, &weights.error, &weights.control);
    if columns.is_empty() {
        findings.push(Finding::refusal(part, Cause::ChannelMissing));
    }
    findings.extend(generator(part, &weights.generator, columns.len(), weights.knowledge));
    if findings.iter().any(Finding::is_refusal) {
        return Ok(findings);
    }
    let system = plant.delayed()?;
    let weighed = weights.output.unwrap_or(plant.rate);
    let (index, count) = (weighed, system.outputs());
    if index >= count {
        return Err(Error::Index { what: "weighted output", index, count });
    }
    let gain = Gain::of(&system.select(&[weighed], &[plant.control]))?;
    findings.extend(against_plant(part, &weights.error, &weights.control, &gain)?);
    let disturbed = Gain::of(&system.select(&[weighed], columns))?;
    if disturbed.largest == 0.0 {
        findings.push(Finding::warning(part, Cause::ChannelWithoutEffect));
    }
    if weights.knowledge != Knowledge::Exact {
        findings.extend(bounded(part, &system, &weights.error)?);
    }
    Ok(findings)
}

/// What can be said of a pair of weights alone.
fn weight_forms(part: Part, error: &Weight, control: &Weight) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (role, weight) in [("error weight", error), ("control weight", control)] {
        findings.extend(well_formed(part, role, weight));
    }
    let excess = -error.rational().relative_degree();
    if excess > 0 {
        let finding = Finding::refusal(part, Cause::ErrorWeightImproper { excess });
        findings.push(finding.on("error weight", error).at(f64::INFINITY));
    }
    let excess = control.rational().relative_degree();
    if excess > 0 {
        let finding = Finding::refusal(part, Cause::ControlWeightVanishes { excess });
        findings.push(finding.on("control weight", control).at(f64::INFINITY));
    }
    for rate in axis_roots(&error.rational().poles) {
        if axis_roots(&control.rational().poles).contains(&rate) {
            findings.push(
                Finding::refusal(part, Cause::WeightsBothInfinite).on("control weight", control).at(rate),
            );
        }
    }
    findings
}

fn well_formed(part: Part, role: &str, weight: &Weight) -> Vec<Finding> {
    let rational = weight.rational();
    if !rational.is_finite() {
        return vec![Finding::refusal(part, Cause::WeightVoid).on(role, weight)];
    }
    let roots = || rational.zeros.iter().chain(&rational.poles);
    let lone = roots().any(|root| {
        root.im != 0.0 && !roots().any(|other| (other - root.conj()).norm() < 1e-9 * root.norm())
    });
    let mut findings = Vec::new();
    if lone {
        findings.push(Finding::refusal(part, Cause::WeightComplex).on(role, weight));
    }
    if let Some(&root) = roots().find(|root| root.re > 0.0) {
        let finding = Finding::warning(part, Cause::WeightMirrored { root });
        findings.push(finding.on(role, weight).at(root.norm()));
    }
    findings
}

fn densities(weights: &FeedbackWeights) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut refuse =
        |what, value: f64| findings.push(Finding::refusal(Part::Feedback, Cause::Density { what, value }));
    let noise = weights.measurement_noise;
    if !(noise > 0.0 && noise.is_finite()) {
        refuse("the measurement noise", noise);
    }
    let positive = |value: f64| value >= 0.0 && value.is_finite();
    if !positive(weights.loop_recovery) {
        refuse("the loop recovery", weights.loop_recovery);
    }
    for &(_, density) in weights.disturbances.iter().filter(|(_, density)| !positive(*density)) {
        refuse("a disturbance", density);
    }
    if weights.loop_recovery == 0.0 && weights.disturbances.iter().all(|(_, density)| *density == 0.0) {
        findings.push(Finding::warning(Part::Feedback, Cause::NothingDisturbs));
    }
    findings
}

/// Poles of the error weight on the axis, and zeros of the control weight there, against the plant's gain.
fn against_plant(part: Part, error: &Weight, control: &Weight, gain: &Gain) -> Result<Vec<Finding>, Error> {
    let mut findings = Vec::new();
    for rate in axis_roots(&error.rational().poles) {
        let relative_gain = gain.relative(rate)?;
        if relative_gain < ZERO_GAIN {
            let finding = Finding::refusal(part, Cause::PlantZeroAtErrorPole { relative_gain });
            findings.push(finding.on("error weight", error).at(rate));
        }
    }
    for rate in axis_roots(&control.rational().zeros) {
        let seen = gain.relative(rate)? >= ZERO_GAIN && error.magnitude(rate) != 0.0;
        if !seen {
            let finding = Finding::refusal(part, Cause::ControlFreeUnseen);
            findings.push(finding.on("control weight", control).at(rate));
        }
    }
    Ok(findings)
}

/// Where the plant itself acts at the frequency, it is the sensor that is blind.
fn name_blind_sensor(findings: &mut [Finding], truth: &Gain) -> Result<(), Error> {
    for finding in findings.iter_mut() {
        let blind = matches!(finding.cause, Cause::PlantZeroAtErrorPole { .. });
        if blind && truth.relative(finding.rate_rad_s.unwrap_or(0.0))? >= ZERO_GAIN {
            finding.cause = Cause::SensorBlindAtErrorPole;
        }
    }
    Ok(())
}

/// Undamped modes need a noise that excites them.
fn noise_reaches(
    system: &StateSpace,
    control: usize,
    weights: &FeedbackWeights,
) -> Result<Vec<Finding>, Error> {
    let all = poles(system)?;
    let size = all.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let mut inputs: Vec<usize> = weights.disturbances.iter().filter(|d| d.1 > 0.0).map(|d| d.0).collect();
    if weights.loop_recovery > 0.0 {
        inputs.push(control);
    }
    let states: Vec<usize> = (0..system.order()).collect();
    let count = system.inputs();
    if let Some(&index) = inputs.iter().find(|&&i| i >= count) {
        return Err(Error::Index { what: "disturbance input", index, count });
    }
    let G = system.B.select(&states, &inputs);
    let mut findings = Vec::new();
    for &pole in all.iter().filter(|pole| pole.re.abs() <= ON_AXIS * size && pole.im >= 0.0) {
        if !reaches(&system.A, &G, pole)? {
            findings.push(Finding::refusal(Part::Feedback, Cause::NoiseMissesMode { pole }).at(pole.im));
        }
    }
    Ok(findings)
}

/// What delay and right half plane zeros say of the crossover that the weights ask for.
fn limits(plant: &DesignPlant, weights: &FeedbackWeights, gain: &Gain) -> Result<Vec<Finding>, Error> {
    let Some(crossover_rad_s) = gain.crossover(&weights.error, &weights.control) else {
        return Ok(Vec::new());
    };
    let mut findings = Vec::new();
    let mut warn = |cause| {
        let finding = Finding::warning(Part::Feedback, cause).at(crossover_rad_s);
        findings.push(finding.on("error weight", &weights.error));
    };
    if plant.delay_s * crossover_rad_s > DELAY_PHASE {
        warn(Cause::DelayLimits { delay_s: plant.delay_s, crossover_rad_s });
    }
    let bare = plant.system.select(&[plant.rate], &[plant.control]);
    let response = Response::of(&bare)?;
    let right = zeros(&bare)?.into_iter().filter(|zero| zero.re > 0.0 && zero.im >= 0.0);
    let right = right.filter(|zero| vanishes(&response, *zero));
    if let Some(zero) = right.min_by(|a, b| a.norm().total_cmp(&b.norm()))
        && crossover_rad_s > zero.norm()
    {
        warn(Cause::ZeroLimits { zero, crossover_rad_s });
    }
    Ok(findings)
}

/// Whether the response vanishes at what was computed as a zero: the eigenvalues of a plant with fast modes round to others
/// near the origin, where the response is as large as beside them.
fn vanishes(response: &Response, zero: C64) -> bool {
    match response.at_points(&[zero, zero * 1.5]) {
        Ok(values) => values[0].norm_max() < VANISHES * values[1].norm_max(),
        Err(_) => true,
    }
}

fn generator(part: Part, weight: &Weight, inputs: usize, knowledge: Knowledge) -> Vec<Finding> {
    let rational = weight.rational();
    let mut findings = well_formed(part, "generator", weight);
    let relative_degree = rational.relative_degree();
    let mut refuse =
        |cause, rate: f64| findings.push(Finding::refusal(part, cause).on("generator", weight).at(rate));
    if relative_degree <= 0 {
        refuse(Cause::GeneratorNotProper, f64::INFINITY);
    } else if (relative_degree as usize) < inputs {
        refuse(Cause::GeneratorTooRough { relative_degree, needed: inputs }, f64::INFINITY);
    }
    if let Some(&pole) = rational.poles.iter().find(|pole| pole.re >= 0.0) {
        refuse(Cause::GeneratorUnstable { pole }, pole.im.abs());
    }
    let order = rational.poles.len();
    if knowledge == Knowledge::Exact && order != inputs {
        findings.push(
            Finding::refusal(part, Cause::KnowledgeIncomplete { order, known: inputs })
                .on("generator", weight),
        );
    }
    if let Knowledge::Measured { noise } = knowledge
        && !(noise > 0.0 && noise.is_finite())
    {
        findings.push(Finding::refusal(
            part,
            Cause::Density { what: "the disturbance sensor's noise", value: noise },
        ));
    }
    findings
}

/// With a noisy sensor the uncontrolled error must be bounded: the plant and the error weight are stable.
fn bounded(part: Part, system: &StateSpace, error: &Weight) -> Result<Vec<Finding>, Error> {
    let refuse = |pole: C64| Finding::refusal(part, Cause::FeedforwardUnbounded { pole }).at(pole.im.abs());
    if let Some(&pole) = not_stable(&poles(system)?).first() {
        return Ok(vec![refuse(pole)]);
    }
    let pole = axis_roots(&error.rational().poles).first().map(|&rate| C64::new(0.0, rate));
    Ok(pole.map(|pole| refuse(pole).on("error weight", error)).into_iter().collect())
}

/// The poles of the closed right half plane, one of each conjugate pair.
fn not_stable(all: &[C64]) -> Vec<C64> {
    let size = all.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    all.iter().copied().filter(|pole| pole.re >= -ON_AXIS * size && pole.im >= 0.0).collect()
}

/// The frequencies of roots on the imaginary axis, one of each pair.
fn axis_roots(roots: &[C64]) -> Vec<f64> {
    roots.iter().filter(|root| root.re == 0.0 && root.im >= 0.0).map(|root| root.im).collect()
}

/// Whether \[A - pI, B\] has full rank: B reaches the mode p.
fn reaches(A: &Mat, B: &Mat, pole: C64) -> Result<bool, Error> {
    let n = A.nrows();
    let (size, input) = (A.norm_fro(), B.norm_fro());
    if input == 0.0 {
        return Ok(false);
    }
    let pencil = CMat::from_fn(n, n + B.ncols(), |i, j| match j {
        j if j >= n => C64::new(B[(i, j - n)] / input * size.max(f64::MIN_POSITIVE), 0.0),
        j if i == j => C64::new(A[(i, j)], 0.0) - pole,
        j => C64::new(A[(i, j)], 0.0),
    });
    let values = csingular_values(&pencil)?;
    Ok(values.last().is_some_and(|smallest| *smallest > OUT_OF_REACH * size))
}

/// The modulus of a system over frequency, relative to its largest on the grid.
struct Gain {
    response: Response,
    moduli: Vec<(f64, f64)>,
    largest: f64,
}

impl Gain {
    fn of(system: &StateSpace) -> Result<Self, Error> {
        let response = Response::of(system)?;
        let points = (LOWEST * POINTS)..=(HIGHEST * POINTS);
        let rates = points.map(|k| 10f64.powf(f64::from(k) / f64::from(POINTS)));
        let moduli = rates.map(|rate| (rate, modulus(&response, rate))).collect::<Vec<_>>();
        let finite = moduli.iter().map(|(_, modulus)| *modulus).filter(|modulus| modulus.is_finite());
        let largest = finite.fold(0.0, f64::max);
        Ok(Self { response, moduli, largest })
    }

    /// The modulus at a frequency over the largest; 1 where it is infinite, 0 where the system is zero.
    fn relative(&self, rate: f64) -> Result<f64, Error> {
        if self.largest == 0.0 {
            return Ok(0.0);
        }
        Ok((modulus(&self.response, rate) / self.largest).min(1.0))
    }

    /// The highest frequency of the grid at which error weight times gain exceeds the control weight.
    fn crossover(&self, error: &Weight, control: &Weight) -> Option<f64> {
        let (error, control): (Rational, Rational) = (error.rational(), control.rational());
        let exceeds = |rate: f64, gain: f64| {
            let s = C64::new(0.0, rate);
            error.at(s).norm() * gain > control.at(s).norm()
        };
        self.moduli.iter().rev().find(|(rate, gain)| exceeds(*rate, *gain)).map(|(rate, _)| *rate)
    }
}

/// The largest modulus of an entry; infinite at a pole.
fn modulus(response: &Response, rate: f64) -> f64 {
    response.at(rate).map_or(f64::INFINITY, |value| value.norm_max())
}
