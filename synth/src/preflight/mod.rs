//! The checks before solving: every way in which weights and plant do not make a solvable problem, named in their terms.

mod feedforward;
pub(crate) mod gain;

use feedforward::check_feedforward;
use gain::Gain;

use counterpoise_linalg::{C64, CMat, Mat, csingular_values};
use counterpoise_lti::response::Response;
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{StateSpace, Timebase, poles, zeros};

use crate::cause::StatedDensity;
use crate::cause::{Cause, PlantCause, SpecificationCause};
use crate::finding::WeightRole;
use crate::finding::{DesignFinding, Part};
use crate::tolerance::{CONJUGATE, DELAY_PHASE, ON_AXIS, OUT_OF_REACH, VANISHES, ZERO_GAIN};
use crate::{DesignPlant, DisturbanceChannel, Error, FeedbackWeights, Reference, Specification, Weight};

/// Returns every finding about a plant and a specification, refusals first; empty if nothing stands in the way.
///
/// # Errors
/// [`Error`] if the plant itself is not one (wrong indices, a sensor with two inputs).
pub fn preflight(plant: &DesignPlant, specification: &Specification) -> Result<Vec<DesignFinding>, Error> {
    let mut findings = check_plant(plant)?;
    findings.extend(check_feedback(plant, &specification.feedback, specification.reference)?);
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        if specification.feedforward(channel).is_some() {
            findings.extend(check_feedforward(plant, specification, channel)?);
        }
    }
    findings.sort_by_key(|finding| !finding.is_refusal());
    Ok(findings)
}

fn check_plant(plant: &DesignPlant) -> Result<Vec<DesignFinding>, Error> {
    let system = plant.measured_plant()?;
    let (A, n) = (&system.A, system.order());
    let mut findings = Vec::new();
    let direct = system.D[(0, plant.control)];
    if direct != 0.0 {
        findings.push(
            DesignFinding::refusal(Part::Plant, Cause::Plant(PlantCause::DirectPath { gain: direct }))
                .at(f64::INFINITY),
        );
    }
    if plant.delay_s > 0.0 && plant.pade_order == 0 {
        findings.push(DesignFinding::warning(
            Part::Plant,
            Cause::Plant(PlantCause::DelayLeftOut { delay_s: plant.delay_s }),
        ));
    }
    let (B, C) = (system.B.block(0, plant.control, n, 1), system.C.block(0, 0, 1, n));
    for pole in not_stable(&poles(&system)?) {
        if !reaches(A, &B, pole)? {
            findings.push(
                DesignFinding::refusal(Part::Plant, Cause::Plant(PlantCause::NotStabilisable { pole }))
                    .at(pole.im.abs()),
            );
        }
        if !reaches(&A.t(), &C.t(), pole)? {
            findings.push(
                DesignFinding::refusal(Part::Plant, Cause::Plant(PlantCause::NotDetectable { pole }))
                    .at(pole.im.abs()),
            );
        }
    }
    Ok(findings)
}

fn check_feedback(
    plant: &DesignPlant,
    weights: &FeedbackWeights,
    reference: Reference,
) -> Result<Vec<DesignFinding>, Error> {
    let part = Part::Feedback;
    let mut findings = weight_forms(part, &weights.error, &weights.control);
    findings.extend(densities(weights));
    if reference == Reference::WeightOnly && weights.error.rational().poles.is_empty() {
        let finding = DesignFinding::refusal(part, Cause::Plant(PlantCause::ReferenceWithoutStates));
        findings.push(finding.with_weight(WeightRole::Error, &weights.error));
    }
    if findings.iter().any(DesignFinding::is_refusal) {
        return Ok(findings);
    }
    let system = plant.measured_plant()?;
    let loop_gain = Gain::of(&system.select(&[0], &[plant.control]))?;
    findings.extend(against_plant(part, &weights.error, &weights.control, &loop_gain)?);
    let truth = Gain::of(&system.select(&[1 + plant.rate], &[plant.control]))?;
    name_blind_sensor(&mut findings, &truth)?;
    findings.extend(noise_reaches(&system, plant.control, weights)?);
    findings.extend(limits(plant, weights, &loop_gain)?);
    Ok(findings)
}

/// Returns what can be said of a pair of weights alone.
fn weight_forms(part: Part, error: &Weight, control: &Weight) -> Vec<DesignFinding> {
    let mut findings = Vec::new();
    for (role, weight) in [(WeightRole::Error, error), (WeightRole::Control, control)] {
        findings.extend(well_formed(part, role, weight));
    }
    let excess = -error.rational().relative_degree();
    if excess > 0 {
        let finding = DesignFinding::refusal(
            part,
            Cause::Specification(SpecificationCause::ErrorWeightImproper { excess }),
        );
        findings.push(finding.with_weight(WeightRole::Error, error).at(f64::INFINITY));
    }
    let excess = control.rational().relative_degree();
    if excess > 0 {
        let finding = DesignFinding::refusal(
            part,
            Cause::Specification(SpecificationCause::ControlWeightVanishes { excess }),
        );
        findings.push(finding.with_weight(WeightRole::Control, control).at(f64::INFINITY));
    }
    for rate in axis_roots(&error.rational().poles) {
        if axis_roots(&control.rational().poles).contains(&rate) {
            findings.push(
                DesignFinding::refusal(part, Cause::Specification(SpecificationCause::WeightsBothInfinite))
                    .with_weight(WeightRole::Control, control)
                    .at(rate),
            );
        }
    }
    findings
}

fn well_formed(part: Part, role: WeightRole, weight: &Weight) -> Vec<DesignFinding> {
    let rational = weight.rational();
    if !rational.is_finite() {
        return vec![
            DesignFinding::refusal(part, Cause::Specification(SpecificationCause::WeightVoid))
                .with_weight(role, weight),
        ];
    }
    let roots = || rational.zeros.iter().chain(&rational.poles);
    let lone = roots().any(|root| {
        root.im != 0.0 && !roots().any(|other| (other - root.conj()).norm() < CONJUGATE * root.norm())
    });
    let mut findings = Vec::new();
    if lone {
        findings.push(
            DesignFinding::refusal(part, Cause::Specification(SpecificationCause::WeightComplex))
                .with_weight(role, weight),
        );
    }
    if let Some(&root) = roots().find(|root| root.re > 0.0) {
        let finding =
            DesignFinding::warning(part, Cause::Specification(SpecificationCause::WeightMirrored { root }));
        findings.push(finding.with_weight(role, weight).at(root.norm()));
    }
    findings
}

fn densities(weights: &FeedbackWeights) -> Vec<DesignFinding> {
    let mut findings = Vec::new();
    let mut refuse = |of, value: f64| {
        findings.push(DesignFinding::refusal(
            Part::Feedback,
            Cause::Specification(SpecificationCause::Density { of, value }),
        ))
    };
    let noise = weights.measurement_noise;
    if !(noise > 0.0 && noise.is_finite()) {
        refuse(StatedDensity::MeasurementNoise, noise);
    }
    let positive = |value: f64| value >= 0.0 && value.is_finite();
    if !positive(weights.loop_recovery) {
        refuse(StatedDensity::LoopRecovery, weights.loop_recovery);
    }
    for disturbance in weights.disturbances.iter().filter(|one| !positive(one.value)) {
        refuse(StatedDensity::Disturbance, disturbance.value);
    }
    if weights.loop_recovery == 0.0 && weights.disturbances.iter().all(|one| one.value == 0.0) {
        findings.push(DesignFinding::warning(
            Part::Feedback,
            Cause::Specification(SpecificationCause::NothingDisturbs),
        ));
    }
    findings
}

/// Poles of the error weight on the axis, and zeros of the control weight there, against the plant's gain.
fn against_plant(
    part: Part,
    error: &Weight,
    control: &Weight,
    gain: &Gain,
) -> Result<Vec<DesignFinding>, Error> {
    let mut findings = Vec::new();
    for rate in axis_roots(&error.rational().poles) {
        let relative_gain = gain.relative_modulus(rate)?;
        if relative_gain < ZERO_GAIN {
            let finding = DesignFinding::refusal(
                part,
                Cause::Specification(SpecificationCause::PlantZeroAtErrorPole { relative_gain }),
            );
            findings.push(finding.with_weight(WeightRole::Error, error).at(rate));
        }
    }
    for rate in axis_roots(&control.rational().zeros) {
        let seen = gain.relative_modulus(rate)? >= ZERO_GAIN && error.magnitude(rate) != 0.0;
        if !seen {
            let finding =
                DesignFinding::refusal(part, Cause::Specification(SpecificationCause::ControlFreeUnseen));
            findings.push(finding.with_weight(WeightRole::Control, control).at(rate));
        }
    }
    Ok(findings)
}

/// Returns where the plant itself acts at the frequency, it is the sensor that is blind.
fn name_blind_sensor(findings: &mut [DesignFinding], truth: &Gain) -> Result<(), Error> {
    for finding in findings.iter_mut() {
        let blind =
            matches!(finding.cause, Cause::Specification(SpecificationCause::PlantZeroAtErrorPole { .. }));
        if blind && truth.relative_modulus(finding.rate_rad_s.unwrap_or(0.0))? >= ZERO_GAIN {
            finding.cause = Cause::Specification(SpecificationCause::SensorBlindAtErrorPole);
        }
    }
    Ok(())
}

/// Undamped modes need a noise that excites them.
fn noise_reaches(
    system: &StateSpace,
    control: usize,
    weights: &FeedbackWeights,
) -> Result<Vec<DesignFinding>, Error> {
    let all = poles(system)?;
    let size = all.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let mut inputs: Vec<usize> =
        weights.disturbances.iter().filter(|one| one.value > 0.0).map(|one| one.index).collect();
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
            findings.push(
                DesignFinding::refusal(Part::Feedback, Cause::Plant(PlantCause::NoiseMissesMode { pole }))
                    .at(pole.im),
            );
        }
    }
    Ok(findings)
}

/// Returns what delay and right half plane zeros say of the crossover that the weights ask for.
fn limits(plant: &DesignPlant, weights: &FeedbackWeights, gain: &Gain) -> Result<Vec<DesignFinding>, Error> {
    let Some(crossover_rad_s) = gain.crossover(&weights.error, &weights.control) else {
        return Ok(Vec::new());
    };
    let mut findings = Vec::new();
    let mut warn = |cause| {
        let finding = DesignFinding::warning(Part::Feedback, cause).at(crossover_rad_s);
        findings.push(finding.with_weight(WeightRole::Error, &weights.error));
    };
    if plant.delay_s * crossover_rad_s > DELAY_PHASE {
        warn(Cause::Plant(PlantCause::DelayLimits { delay_s: plant.delay_s, crossover_rad_s }));
    }
    let bare = plant.system.select(&[plant.rate], &[plant.control]);
    let response = Response::of(&bare)?;
    let right = zeros(&bare)?.into_iter().filter(|zero| zero.re > 0.0 && zero.im >= 0.0);
    let right = right.filter(|zero| vanishes(&response, *zero));
    if let Some(zero) = right.min_by(|a, b| a.norm().total_cmp(&b.norm()))
        && crossover_rad_s > zero.norm()
    {
        warn(Cause::Plant(PlantCause::ZeroLimits { zero, crossover_rad_s }));
    }
    Ok(findings)
}

/// Returns whether the response vanishes at what was computed as a zero: the eigenvalues of a plant with fast modes round to others
/// near the origin, where the response is as large as beside them.
fn vanishes(response: &Response, zero: C64) -> bool {
    match response.at_points(&[zero, zero * 1.5]) {
        Ok(values) => values[0].norm_max() < VANISHES * values[1].norm_max(),
        Err(_) => true,
    }
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

/// Returns whether \[A - pI, B\] has full rank: B reaches the mode p. What the units of the states hide (a stiff ball screw in metres and
/// newtons) shows once these are scaled.
fn reaches(A: &Mat, B: &Mat, pole: C64) -> Result<bool, Error> {
    if has_full_rank(A, B, pole)? {
        return Ok(true);
    }
    let (n, m) = B.shape();
    let system =
        StateSpace::new(A.clone(), B.clone(), Mat::zeros(1, n), Mat::zeros(1, m), Timebase::Continuous)?;
    let (scaled, _) = balance(&system);
    has_full_rank(&scaled.A, &scaled.B, pole)
}

fn has_full_rank(A: &Mat, B: &Mat, pole: C64) -> Result<bool, Error> {
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
