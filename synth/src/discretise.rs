//! From the continuous design to the sampled controller that runs.

use counterpoise_controller::sensitivity::realise_form;
use counterpoise_controller::{Controller, Parts, Path, PathSignal, Scaling};
use counterpoise_lti::{StateSpace, c2d};

use crate::anti_windup::{anti_windup, anti_windup_of};
use crate::cascade::from_error_and_reading;
use crate::certificate::PartCertificates;
use crate::sampled_data::{self, DraftedPart};
use crate::sampling::{SampledLoop, Sampling, SamplingMethod, check_sampled_loop, sampled_plant};
use crate::{Assembly, Design, DisturbanceChannel, Error, Reference};

/// Returns the design as a sampled controller.
///
/// Each path is discretised or designed anew ([`SamplingMethod`]), brought to the form asked for ([`RealisationForm`](counterpoise_controller::sensitivity::RealisationForm): by default the one whose coefficients may be rounded) and
/// given an anti-windup gain. What comes out is checked: the loop of the *discrete* controller around the plant with its
/// sensor under a zero-order hold must be stable.
///
/// # Errors
/// [`Error`] for a period or limit that is none, or a feedforward with exact knowledge of derivatives that no sensor
/// reads; [`Error::Refused`] for a sampled loop that is not stable, or a sampled problem without solution.
pub fn discretise(design: &Design, sampling: &Sampling) -> Result<SampledLoop, Error> {
    let mut parts = Parts::new(sampling.period_s, sampling.limit_v);
    let certified;
    (parts.paths, certified) = paths(design, sampling)?;
    parts.design_out_of_balance_kg_m = sampling.out_of_balance_kg_m;
    parts.out_of_balance_range_kg_m = sampling.out_of_balance_range_kg_m;
    parts.bias_v_per_kg_m = sampling.bias_v_per_kg_m;
    parts.transfer_time_s = sampling.transfer_time_s;
    Ok(SampledLoop { certified, ..check_sampled_loop(&design.plant, Controller::new(parts)?, sampling)? })
}

type Paths = (Vec<Path>, Vec<PartCertificates>);

/// Returns whether feedback and feedforwards run as one path.
fn is_joint(design: &Design) -> bool {
    let modules = design.heave.is_some() || design.pitch.is_some();
    design.joint.is_some() || design.specification.assembly == Assembly::Grimble && modules
}

fn paths(design: &Design, sampling: &Sampling) -> Result<Paths, Error> {
    let is_apart = design.substitute.is_none() && design.joint.is_none();
    if sampling.method == SamplingMethod::SampledData && is_apart {
        return drafts(design, sampling)?.paths(design, sampling);
    }
    if is_joint(design) {
        let converted = c2d(&design.joint_controller()?, sampling.period_s, sampling.method.conversion())?;
        return Ok((vec![joint_path(design, &converted, sampling)?], Vec::new()));
    }
    let feedback = from_what_it_sees(design, &design.feedback_controller());
    let converted = c2d(&feedback, sampling.period_s, sampling.method.conversion())?;
    let mut paths = vec![feedback_path(design, &converted, sampling)?];
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        let Some(system) = design.feedforward_controller(channel) else { continue };
        needs_one_input(&system)?;
        let converted = c2d(&system, sampling.period_s, sampling.method.conversion())?;
        paths.push(feedforward_path(channel, &converted, sampling)?);
    }
    Ok((paths, Vec::new()))
}

/// The parts as designed in sampled time.
struct Drafts {
    feedback: DraftedPart,
    modules: Vec<(DisturbanceChannel, DraftedPart)>,
}

fn drafts(design: &Design, sampling: &Sampling) -> Result<Drafts, Error> {
    let feedback = sampled_data::feedback(design, sampling)?;
    let mut modules = Vec::new();
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        let Some(continuous) = design.feedforward_controller(channel) else { continue };
        needs_one_input(&continuous)?;
        let drafted = sampled_data::feedforward(design, channel, &feedback.system, sampling)?;
        modules.extend(drafted.map(|drafted| (channel, drafted)));
    }
    Ok(Drafts { feedback, modules })
}

impl Drafts {
    fn paths(self, design: &Design, sampling: &Sampling) -> Result<Paths, Error> {
        let feedback = &self.feedback.system;
        let paths = if is_joint(design) {
            let modules: Vec<StateSpace> =
                self.modules.iter().map(|(_, module)| module.system.clone()).collect();
            vec![joint_path(design, &design.assemble(feedback, &modules)?, sampling)?]
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
type HeaveModule = Option<(StateSpace, Option<PartCertificates>)>;

/// The heave feedforward of a design for sampled time, in the form in which it runs; `None` if it has none.
///
/// # Errors
/// Those of the discretisation and of the realisation.
pub(crate) fn heave_module(design: &Design, sampling: &Sampling) -> Result<HeaveModule, Error> {
    let Some(continuous) = design.feedforward_controller(DisturbanceChannel::Heave) else {
        return Ok(None);
    };
    if sampling.method != SamplingMethod::SampledData {
        let converted = c2d(&continuous, sampling.period_s, sampling.method.conversion())?;
        return Ok(Some((realise_form(&converted, sampling.form)?, None)));
    }
    let mut modules = drafts(design, sampling)?.modules.into_iter();
    let Some((_, module)) = modules.find(|(channel, _)| *channel == DisturbanceChannel::Heave) else {
        return Ok(None);
    };
    Ok(Some((realise_form(&module.system.select(&[0], &[0]), sampling.form)?, Some(module.certified))))
}

fn place(channel: DisturbanceChannel, sampling: &Sampling) -> (&'static str, PathSignal, Scaling) {
    match channel {
        DisturbanceChannel::Heave if sampling.out_of_balance_kg_m != 0.0 => {
            ("heave", PathSignal::PlatformAcceleration, Scaling::WithOutOfBalance)
        }
        DisturbanceChannel::Heave => ("heave", PathSignal::PlatformAcceleration, Scaling::Fixed),
        DisturbanceChannel::Pitch => ("pitch", PathSignal::PlatformRate, Scaling::Fixed),
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

/// The feedback from the signals that it sees: the error, demand and rate, or error and position in a cascade.
fn from_what_it_sees(design: &Design, feedback: &StateSpace) -> StateSpace {
    match design.specification.reference {
        _ if design.plant.rate_loop.is_some() => from_error_and_reading(feedback),
        Reference::Error => feedback.select(&[0], &[0]),
        Reference::WeightOnly => feedback.clone(),
    }
}

fn feedback_path(design: &Design, feedback: &StateSpace, sampling: &Sampling) -> Result<Path, Error> {
    let inputs = match design.specification.reference {
        _ if design.plant.rate_loop.is_some() => vec![PathSignal::RateError, PathSignal::HubRate],
        Reference::Error => vec![PathSignal::RateError],
        Reference::WeightOnly => vec![PathSignal::Demand, PathSignal::HubRate],
    };
    let system = realise_form(feedback, sampling.form)?;
    let plant = sampled_plant(&design.plant, sampling)?;
    let anti_windup = match design.plant.rate_loop {
        Some(_) => anti_windup_of(&system, &plant, &[0])?,
        None => anti_windup(&system, &plant)?,
    };
    Ok(Path { name: "feedback".into(), inputs, system, anti_windup, scaling: Scaling::Fixed })
}

fn feedforward_path(
    channel: DisturbanceChannel,
    module: &StateSpace,
    sampling: &Sampling,
) -> Result<Path, Error> {
    let system = realise_form(module, sampling.form)?;
    let (name, input, scaling) = place(channel, sampling);
    let anti_windup = vec![0.0; system.order()];
    Ok(Path { name: name.into(), inputs: vec![input], system, anti_windup, scaling })
}

fn joint_path(design: &Design, joint: &StateSpace, sampling: &Sampling) -> Result<Path, Error> {
    let mut inputs = vec![PathSignal::Demand, PathSignal::HubRate];
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        if let Some(module) = design.feedforward_controller(channel) {
            needs_one_input(&module)?;
            inputs.push(place(channel, sampling).1);
        }
    }
    let measured = design.joint.iter().flat_map(|joint| &joint.channels);
    inputs.extend(measured.map(|channel| place(*channel, sampling).1));
    let system = realise_form(joint, sampling.form)?;
    let anti_windup = anti_windup(&system, &sampled_plant(&design.plant, sampling)?)?;
    Ok(Path { name: "joint".into(), inputs, system, anti_windup, scaling: Scaling::Fixed })
}
