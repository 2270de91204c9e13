//! Single stages of the pipeline, from the same file.

use std::path::PathBuf;

use crate::output::say;
use clap::Args;
use counterpoise_pipeline::results::ReduceResult;
use counterpoise_pipeline::{self as pipeline, Modelled, Reduced};
use counterpoise_project::Purpose;

use crate::exit::{Done, Exit};
use crate::options::Results;
use crate::output;
use counterpoise_host::projects::{self, Loaded};

/// Arguments of a single stage.
#[derive(Args)]
pub struct StageOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Runs `counterpoise reduce`.
pub fn reduce(options: &StageOptions) -> Done {
    let loaded = loaded(options, Purpose::Reduce)?;
    let (_, reduced) = to_reduced(&loaded)?;
    let result = ReduceResult::from(&reduced);
    if !output::write_json(&options.results, &result)? {
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

fn verdict_ok() -> Done {
    Ok(Exit::SUCCESS)
}

fn loaded(options: &StageOptions, purpose: Purpose) -> anyhow::Result<Loaded> {
    let loaded = projects::load_project(&options.project, purpose)?;
    output::print_warnings(&loaded, options.results.progress());
    Ok(loaded)
}

fn to_reduced(loaded: &Loaded) -> anyhow::Result<(Modelled, Reduced)> {
    let modelled = pipeline::model(&loaded.project)?;
    let reduced = pipeline::reduce(&loaded.project, &modelled)?;
    Ok((modelled, reduced))
}
