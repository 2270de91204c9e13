//! Single stages of the road, from the same file.

use crate::output::say;
use counterpoise_project::pipeline::{self, Modelled, Reduced, Synthesised};
use counterpoise_project::results::{ModelResult, ReduceResult, SynthResult, VerifyResult};
use counterpoise_project::{Purpose, diagnose::bench::rms};

use super::design::print_verdicts;
use super::{Done, verdict_code};
use crate::arguments::StageOptions;
use crate::files::{self, Loaded, Surroundings};
use crate::output;

/// `counterpoise model`.
pub fn model(options: &StageOptions) -> Done {
    let loaded = loaded(options, Purpose::Model)?;
    let result = ModelResult::from(&pipeline::model(&loaded.project)?);
    if !output::json(&options.results, &result)? {
        say!("{}: linear plant of order {}", result.name, result.order);
        say!("out-of-balance {:.4} kg m, held by {:.4} V", result.out_of_balance_kg_m, result.holding_v);
        say!("states: {}", result.states.join(", "));
        say!("{:>14} {:>14} {:>10}", "frequency Hz", "damping", "");
        for [re, im] in result.poles_rad_s.iter().filter(|p| p[1] >= 0.0) {
            let size = re.hypot(*im);
            say!("{:14.4} {:14.4}", size / std::f64::consts::TAU, -re / size.max(f64::MIN_POSITIVE));
        }
    }
    verdict_ok()
}

/// `counterpoise reduce`.
pub fn reduce(options: &StageOptions) -> Done {
    let loaded = loaded(options, Purpose::Reduce)?;
    let (_, reduced) = to_reduced(&loaded)?;
    let result = ReduceResult::from(&reduced);
    if !output::json(&options.results, &result)? {
        say!("order {} -> {}", result.order[0], result.order[1]);
        if let Some([error, rate]) = result.error {
            say!("largest error {error:.4e} at {rate:.4} rad/s");
        }
        if let Some(bound) = result.bound {
            say!("bound {bound:.4e}");
        }
        result.ranked.iter().enumerate().for_each(|(k, value)| say!("{:4} {value:.4e}", k + 1));
        result.warnings.iter().for_each(|w| say!("warning: {w}"));
    }
    verdict_ok()
}

/// `counterpoise synth`.
pub fn synth(options: &StageOptions) -> Done {
    let loaded = loaded(options, Purpose::Synth)?;
    let (_, made) = to_synthesised(&loaded)?;
    let result = SynthResult::from(&made);
    if !output::json(&options.results, &result)? {
        print_weights(&loaded);
        say!("design plant of order {}", result.plant_order);
        result.path_orders.iter().for_each(|(name, order)| say!("{name}: order {order}"));
        let radius: Vec<f64> = result.closed_loop_poles.iter().map(|[re, im]| re.hypot(*im)).collect();
        let largest = radius.iter().copied().fold(0.0, f64::max);
        say!(
            "closed sampled loop: {} poles, largest modulus {largest:.6}, RMS {:.4}",
            radius.len(),
            rms(&radius)
        );
        if let Some(difference) = result.cost_difference {
            say!("predicted cost and cost of the assembled loop differ by {difference:.1e}");
        }
        result.warnings.iter().for_each(|w| say!("warning: {w}"));
    }
    verdict_ok()
}

/// `counterpoise verify`.
pub fn verify(options: &StageOptions) -> Done {
    let loaded = loaded(options, Purpose::Verify)?;
    let world = Surroundings::of(&loaded, options.results.quiet);
    let (modelled, made) = to_synthesised(&loaded)?;
    let verified = pipeline::verify(&loaded.project, &modelled, &made, &world)?;
    let found = verified.verification();
    if !output::json(&options.results, &VerifyResult::from(found))? {
        print_verdicts(found);
    }
    Ok(verdict_code(found.passes()))
}

fn verdict_ok() -> Done {
    Ok(verdict_code(true))
}

fn loaded(options: &StageOptions, purpose: Purpose) -> anyhow::Result<Loaded> {
    let loaded = files::load(&options.project, purpose)?;
    output::warnings(&loaded, options.results.quiet);
    Ok(loaded)
}

fn to_reduced(loaded: &Loaded) -> anyhow::Result<(Modelled, Reduced)> {
    let modelled = pipeline::model(&loaded.project)?;
    let reduced = pipeline::reduce(&loaded.project, &modelled)?;
    Ok((modelled, reduced))
}

fn to_synthesised(loaded: &Loaded) -> anyhow::Result<(Modelled, Synthesised)> {
    let (modelled, reduced) = to_reduced(loaded)?;
    let made = pipeline::synthesise(&loaded.project, &modelled, &reduced)?;
    Ok((modelled, made))
}

fn print_weights(loaded: &Loaded) {
    if let Some(synth) = &loaded.project.synth {
        pipeline::export::weights(synth).iter().for_each(|line| say!("{line}"));
    }
}
