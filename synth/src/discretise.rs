//! From the continuous design to the sampled controller that runs, and the sampled loop it makes.

use counterpoise_controller::sensitivity::{Form, realise};
use counterpoise_controller::{Controller, Parts, Path, Scaling, Signal};
use counterpoise_lti::linalg::{self, dare};
use counterpoise_lti::response::Response;
use counterpoise_lti::{C64, Discretisation, Mat, StateSpace, c2d, delay_samples, poles, series};

use crate::cause::Cause;
use crate::finding::{Finding, Part};
use crate::sampled_data::{self, Certified, Drafted};
use crate::{Assembly, Channel, Design, DesignPlant, Error, Outcome, Reference};

/// How a controller for sampled time comes about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SamplingMethod {
    /// Each continuous path is converted by itself.
    Emulation(Discretisation),
    /// Every part is designed anew on the sampled problem: hold and delay exact, the cost of the time between the samples
    /// included ([`mod@crate::sampled_data`]). A feedback that stands in place of the three-part one, and the demand's
    /// prefilter, are converted by the bilinear map: they have no sampled problem.
    SampledData,
}

impl SamplingMethod {
    /// The bilinear map, without prewarping.
    pub const TUSTIN: Self = Self::Emulation(Discretisation::Tustin { prewarp_rad_s: None });

    /// How a continuous path that has no sampled problem of its own is converted.
    pub fn conversion(self) -> Discretisation {
        match self {
            Self::Emulation(method) => method,
            Self::SampledData => Discretisation::Tustin { prewarp_rad_s: None },
        }
    }
}

/// What sampling adds to a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Sample period, s.
    pub period_s: f64,
    /// How each path becomes discrete.
    pub method: SamplingMethod,
    /// The form in which each path runs.
    pub form: Form,
    /// The control is limited to +/- this, V.
    pub limit_v: f64,
    /// Whole samples of delay of the real loop beyond the hold, for the check of the sampled loop.
    pub delay_samples: usize,
    /// Out-of-balance that the plant was taken at, kg m; 0 keeps the heave feedforward's gain fixed.
    pub out_of_balance_kg_m: f64,
    /// Lowest and highest out-of-balance that may be set, kg m.
    pub out_of_balance_range_kg_m: (f64, f64),
    /// Volts that hold one kg m against gravity.
    pub bias_v_per_kg_m: f64,
    /// Time in which the step of a changed out-of-balance fades in, s.
    pub transfer_time_s: f64,
}

impl Sampling {
    /// Tustin's method, no further delay, no out-of-balance.
    pub fn new(period_s: f64, limit_v: f64) -> Self {
        Self {
            period_s,
            method: SamplingMethod::TUSTIN,
            form: Form::LeastSensitive,
            limit_v,
            delay_samples: 0,
            out_of_balance_kg_m: 0.0,
            out_of_balance_range_kg_m: (-1e6, 1e6),
            bias_v_per_kg_m: 0.0,
            transfer_time_s: 0.0,
        }
    }
}

/// A sampled controller with the loop it makes.
#[derive(Debug, Clone)]
pub struct Sampled {
    /// The controller, in the realisation in which it runs.
    pub controller: Controller,
    /// The loop cut at the control, from control to the negative of the control that comes back: feed it to `margins`.
    pub loop_gain: StateSpace,
    /// Poles of the closed sampled loop.
    pub closed_loop: Vec<C64>,
    /// The certificates of the parts that were designed in sampled time; empty with [`SamplingMethod::Emulation`].
    pub certified: Vec<Certified>,
}

/// The design as a sampled controller.
///
/// Each path is discretised or designed anew ([`SamplingMethod`]), brought to the form asked for ([`Form`]: by default the one whose coefficients may be rounded) and
/// given an anti-windup gain. What comes out is checked: the loop of the *discrete* controller around the plant with its
/// sensor under a zero-order hold must be stable.
///
/// # Errors
/// [`Error`] for a period or limit that is none, or a feedforward with exact knowledge of derivatives that no sensor
/// reads. A sampled loop that is not stable, or a sampled problem without solution, is [`Outcome::Infeasible`].
pub fn discretise(design: &Design, sampling: &Sampling) -> Result<Outcome<Sampled>, Error> {
    let mut parts = Parts::new(sampling.period_s, sampling.limit_v);
    let certified;
    (parts.paths, certified) = match paths(design, sampling)? {
        Outcome::Solved(found) => found,
        Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
    };
    parts.design_out_of_balance_kg_m = sampling.out_of_balance_kg_m;
    parts.out_of_balance_range_kg_m = sampling.out_of_balance_range_kg_m;
    parts.bias_v_per_kg_m = sampling.bias_v_per_kg_m;
    parts.transfer_time_s = sampling.transfer_time_s;
    check(&design.plant, Controller::new(parts)?, sampling)?
        .try_map(|sampled| Ok(Sampled { certified, ..sampled }))
}

/// A controller with the sampled loop it makes around a plant, refused where that is not stable.
///
/// # Errors
/// [`Error`] for a plant that is not one.
pub fn check(
    plant: &DesignPlant,
    controller: Controller,
    sampling: &Sampling,
) -> Result<Outcome<Sampled>, Error> {
    let loop_gain = sampled_loop(plant, &controller, sampling)?;
    let closed = counterpoise_lti::feedback(&loop_gain, &StateSpace::gain(Mat::eye(1), loop_gain.timebase)?)?;
    let closed_loop = poles(&closed)?;
    let largest = closed_loop.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    match largest {
        Some(pole) if pole.norm() >= 1.0 => {
            let cause = Cause::SampledUnstable { pole, period_s: sampling.period_s };
            let rate = (pole.arg() / sampling.period_s).abs();
            Ok(Outcome::Infeasible(vec![Finding::refusal(Part::Feedback, cause).at(rate)]))
        }
        _ => Ok(Outcome::Solved(Sampled { controller, loop_gain, closed_loop, certified: Vec::new() })),
    }
}

/// The sampled loop cut at the control: plant and hub sensor under a zero-order hold, delayed by whole samples, then the
/// controller from the hub rate; the sign is that of negative feedback.
///
/// # Errors
/// [`Error::Lti`], [`Error::Controller`].
pub fn sampled_loop(
    plant: &DesignPlant,
    controller: &Controller,
    sampling: &Sampling,
) -> Result<StateSpace, Error> {
    let seen = sampled_plant(plant, sampling)?;
    let linear = controller.linear(sampling.out_of_balance_kg_m)?;
    let hub = Signal::HubRate.reading().unwrap_or(1);
    Ok(series(&seen, &linear.select(&[0], &[hub]).negate())?)
}

fn sampled_plant(plant: &DesignPlant, sampling: &Sampling) -> Result<StateSpace, Error> {
    let undelayed = DesignPlant { pade_order: 0, ..plant.clone() };
    let seen = undelayed.measured()?.select(&[0], &[plant.control]);
    let held = c2d(&seen, sampling.period_s, Discretisation::ZeroOrderHold)?;
    match sampling.delay_samples {
        0 => Ok(held),
        count => Ok(series(&delay_samples(count, sampling.period_s)?, &held)?),
    }
}

type Paths = (Vec<Path>, Vec<Certified>);

fn paths(design: &Design, sampling: &Sampling) -> Result<Outcome<Paths>, Error> {
    let modules = design.heave.is_some() || design.pitch.is_some();
    let joint = design.specification.assembly == Assembly::Grimble && modules;
    if sampling.method == SamplingMethod::SampledData && design.substitute.is_none() {
        return Ok(match drafts(design, sampling)? {
            Outcome::Solved(drafts) => Outcome::Solved(drafts.paths(design, sampling, joint)?),
            Outcome::Infeasible(findings) => Outcome::Infeasible(findings),
        });
    }
    if joint {
        let converted = c2d(&design.joint_controller()?, sampling.period_s, sampling.method.conversion())?;
        return Ok(Outcome::Solved((vec![joint_path(design, &converted, sampling)?], Vec::new())));
    }
    let feedback = from_what_it_sees(design, &design.feedback_controller());
    let converted = c2d(&feedback, sampling.period_s, sampling.method.conversion())?;
    let mut paths = vec![feedback_path(design, &converted, sampling)?];
    for channel in [Channel::Heave, Channel::Pitch] {
        let Some(system) = design.feedforward_controller(channel) else { continue };
        needs_one_input(&system)?;
        let converted = c2d(&system, sampling.period_s, sampling.method.conversion())?;
        paths.push(feedforward_path(channel, &converted, sampling)?);
    }
    Ok(Outcome::Solved((paths, Vec::new())))
}

/// The parts as designed in sampled time.
struct Drafts {
    feedback: Drafted,
    modules: Vec<(Channel, Drafted)>,
}

fn drafts(design: &Design, sampling: &Sampling) -> Result<Outcome<Drafts>, Error> {
    let feedback = match sampled_data::feedback(design, sampling)? {
        Outcome::Solved(drafted) => drafted,
        Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
    };
    let mut modules = Vec::new();
    for channel in [Channel::Heave, Channel::Pitch] {
        let Some(continuous) = design.feedforward_controller(channel) else { continue };
        needs_one_input(&continuous)?;
        match sampled_data::feedforward(design, channel, &feedback.system, sampling)? {
            Some(Outcome::Solved(drafted)) => modules.push((channel, drafted)),
            Some(Outcome::Infeasible(findings)) => return Ok(Outcome::Infeasible(findings)),
            None => {}
        }
    }
    Ok(Outcome::Solved(Drafts { feedback, modules }))
}

impl Sampled {
    /// The largest relative difference between predicted and achieved cost over the parts designed in sampled time; `None`
    /// where there are none, or none of them has both.
    pub fn worst_cost_difference(&self) -> Option<f64> {
        self.certified.iter().filter_map(|part| part.cost.relative_difference()).max_by(f64::total_cmp)
    }
}

impl Drafts {
    fn paths(self, design: &Design, sampling: &Sampling, joint: bool) -> Result<Paths, Error> {
        let feedback = &self.feedback.system;
        let paths = if joint {
            let modules: Vec<StateSpace> =
                self.modules.iter().map(|(_, module)| module.system.clone()).collect();
            vec![joint_path(design, &design.assembled(feedback, &modules)?, sampling)?]
        } else {
            let mut paths = vec![feedback_path(design, &from_what_it_sees(design, feedback), sampling)?];
            for (channel, module) in &self.modules {
                paths.push(feedforward_path(*channel, &module.system.select(&[0], &[0]), sampling)?);
            }
            paths
        };
        let all = std::iter::once(self.feedback).chain(self.modules.into_iter().map(|(_, module)| module));
        Ok((paths, all.map(|drafted| drafted.certified).collect()))
    }
}

/// A module with its certificates, if it was designed in sampled time; `None` if the design has no such module.
type HeaveModule = Option<(StateSpace, Option<Certified>)>;

/// The heave feedforward of a design for sampled time, in the form in which it runs; `None` if it has none.
///
/// # Errors
/// Those of the discretisation and of the realisation.
pub(crate) fn heave_module(design: &Design, sampling: &Sampling) -> Result<Outcome<HeaveModule>, Error> {
    let Some(continuous) = design.feedforward_controller(Channel::Heave) else {
        return Ok(Outcome::Solved(None));
    };
    if sampling.method != SamplingMethod::SampledData {
        let converted = c2d(&continuous, sampling.period_s, sampling.method.conversion())?;
        return Ok(Outcome::Solved(Some((realise(&converted, sampling.form)?, None))));
    }
    drafts(design, sampling)?.try_map(|drafts| {
        let found = drafts.modules.into_iter().find(|(channel, _)| *channel == Channel::Heave);
        found
            .map(|(_, module)| {
                Ok((realise(&module.system.select(&[0], &[0]), sampling.form)?, Some(module.certified)))
            })
            .transpose()
    })
}

fn place(channel: Channel, sampling: &Sampling) -> (&'static str, Signal, Scaling) {
    match channel {
        Channel::Heave if sampling.out_of_balance_kg_m != 0.0 => {
            ("heave", Signal::PlatformAcceleration, Scaling::WithOutOfBalance)
        }
        Channel::Heave => ("heave", Signal::PlatformAcceleration, Scaling::Fixed),
        Channel::Pitch => ("pitch", Signal::PlatformRate, Scaling::Fixed),
    }
}

fn needs_one_input(system: &StateSpace) -> Result<(), Error> {
    if system.inputs() == 1 {
        return Ok(());
    }
    Err(Error::System {
        what: "feedforward with exact knowledge",
        problem: "no sensor reads the derivatives it needs",
    })
}

/// The feedback from the signals that it sees: the error, or demand and rate.
fn from_what_it_sees(design: &Design, feedback: &StateSpace) -> StateSpace {
    match design.specification.reference {
        Reference::Error => feedback.select(&[0], &[0]),
        Reference::WeightOnly => feedback.clone(),
    }
}

fn feedback_path(design: &Design, feedback: &StateSpace, sampling: &Sampling) -> Result<Path, Error> {
    let inputs = match design.specification.reference {
        Reference::Error => vec![Signal::RateError],
        Reference::WeightOnly => vec![Signal::Demand, Signal::HubRate],
    };
    let system = realise(feedback, sampling.form)?;
    let anti_windup = anti_windup(&system, &sampled_plant(&design.plant, sampling)?)?;
    Ok(Path { name: "feedback".into(), inputs, system, anti_windup, scaling: Scaling::Fixed })
}

fn feedforward_path(channel: Channel, module: &StateSpace, sampling: &Sampling) -> Result<Path, Error> {
    let system = realise(module, sampling.form)?;
    let (name, input, scaling) = place(channel, sampling);
    let anti_windup = vec![0.0; system.order()];
    Ok(Path { name: name.into(), inputs: vec![input], system, anti_windup, scaling })
}

fn joint_path(design: &Design, joint: &StateSpace, sampling: &Sampling) -> Result<Path, Error> {
    let mut inputs = vec![Signal::Demand, Signal::HubRate];
    for channel in [Channel::Heave, Channel::Pitch] {
        let Some(module) = design.feedforward_controller(channel) else { continue };
        needs_one_input(&module)?;
        inputs.push(place(channel, sampling).1);
    }
    let system = realise(joint, sampling.form)?;
    let anti_windup = anti_windup(&system, &sampled_plant(&design.plant, sampling)?)?;
    Ok(Path { name: "joint".into(), inputs, system, anti_windup, scaling: Scaling::Fixed })
}

/// The gain g of x\[k+1\] = A x + B y + g (limited - unlimited control), as a filter's gain: A - g C is stable whatever A
/// is, and as quick as the loop itself.
///
/// While the limiter holds, the controller runs as x\[k+1\] = (A - g C) x + ...: g solves the filter equation of the
/// controller's states driven by its inputs, with the controller's gain at the loop's crossover as the noise.
fn anti_windup(path: &StateSpace, plant: &StateSpace) -> Result<Vec<f64>, Error> {
    if path.order() == 0 {
        return Ok(Vec::new());
    }
    let gain = gain_at_crossover(path, plant)?;
    let R = Mat::eye(1).scale(gain * gain);
    let Q = &path.B * &path.B.t();
    match dare(&path.A.t(), &path.C.t(), &Q, &R, None)? {
        linalg::Outcome::Solved(solution) => Ok(solution.F.as_slice().to_vec()),
        linalg::Outcome::Infeasible(_) => Err(Error::System {
            what: "controller",
            problem: "a state that is not stable does not show in the control",
        }),
    }
}

/// Modulus of the path's largest input gain where the loop's gain last falls through 1 (or where the loop's gain is
/// largest, if it never exceeds 1).
fn gain_at_crossover(path: &StateSpace, plant: &StateSpace) -> Result<f64, Error> {
    let (path, plant) = (Response::of(path)?, Response::of(plant)?);
    let mut at_peak = (0.0, 1.0);
    for k in (0..=120).rev() {
        let rate = 10f64.powf(-1.0 + 4.5 * f64::from(k) / 120.0);
        let (Ok(controller), Ok(response)) = (path.at(rate), plant.at(rate)) else { continue };
        let gain = controller.norm_max();
        let product = gain * response.norm_max();
        if product >= 1.0 {
            return Ok(gain);
        }
        if product > at_peak.0 {
            at_peak = (product, gain);
        }
    }
    Ok(at_peak.1)
}
