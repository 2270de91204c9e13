//! One sampled controller for a whole schedule over out-of-balance.

use counterpoise_controller::{Controller, Path, PathSignal, Scaling};

use crate::certificate::PartCertificates;
use crate::discretise::heave_module;
use crate::finding::Part;
use crate::{Design, Error, SampledLoop, Sampling, ScheduleEntry, check_sampled_loop, discretise};

/// Returns one controller for the whole schedule: the nominal feedback and pitch feedforward, and the redesigned heave
/// feedforwards interpolated over the out-of-balance.
///
/// # Errors
/// [`Error`] for fewer than two entries, or two of one out-of-balance. A nominal sampled loop that is not stable is
/// [`Error::Refused`].
pub fn discretise_schedule(
    nominal: &Design,
    entries: &[ScheduleEntry],
    sampling: &Sampling,
) -> Result<SampledLoop, Error> {
    let base = discretise(nominal, sampling)?;
    let mut sorted: Vec<&ScheduleEntry> = entries.iter().collect();
    sorted.sort_by(|a, b| a.out_of_balance_kg_m.total_cmp(&b.out_of_balance_kg_m));
    if sorted.len() < 2 {
        return Err(Error::System { what: "schedule", problem: "it needs two configurations or more" });
    }
    let at = |index: usize| sorted.get(index).map(|entry| entry.out_of_balance_kg_m);
    let mut paths: Vec<Path> =
        base.controller.parts().paths.iter().filter(|p| p.name != "heave").cloned().collect();
    let mut certified: Vec<PartCertificates> =
        base.certified.iter().filter(|found| found.part != Part::Heave).cloned().collect();
    for (index, entry) in sorted.iter().enumerate() {
        let Some((system, proof)) = heave_module(&entry.design, sampling)? else { continue };
        certified.extend(proof);
        let scaling = Scaling::Scheduled {
            below_kg_m: index.checked_sub(1).and_then(at),
            at_kg_m: entry.out_of_balance_kg_m,
            above_kg_m: at(index + 1),
        };
        let (name, anti_windup) = (format!("heave_{index}"), vec![0.0; system.order()]);
        paths.push(Path {
            name,
            inputs: vec![PathSignal::PlatformAcceleration],
            system,
            anti_windup,
            scaling,
        });
    }
    let controller: Controller = base.controller.with(|parts| parts.paths = paths)?;
    Ok(SampledLoop { certified, ..check_sampled_loop(&nominal.plant, controller, sampling)? })
}
