//! The memory that a run takes, estimated before anything is allocated.

use crate::PipelineError;
use crate::tolerance::MOST_BYTES;

/// Bytes that a run keeps of every sample: readings, true motion and control, once for the linear and once for the nonlinear model,
/// with room for what a verification computes from them.
const BYTES_A_SAMPLE: f64 = 400.0;
/// Samples that the simulator runs in a second on a usual processor, about: for the estimate that an error names.
const SAMPLES_A_SECOND: f64 = 1e5;

/// A run of which the cost is estimated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run<'a> {
    /// The key that gives the duration.
    pub key: &'a str,
    /// Duration, s.
    pub duration_s: f64,
    /// Sample period, s.
    pub period_s: f64,
}

/// Refuses a run that would take more memory than any usual machine has to spare.
///
/// # Errors
/// [`PipelineError::TooLong`], with the estimate.
pub(crate) fn require_memory(run: Run<'_>) -> Result<(), PipelineError> {
    let samples = run.duration_s / run.period_s;
    let bytes = BYTES_A_SAMPLE * samples;
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(PipelineError::TooLong {
        key: run.key.to_owned(),
        duration_s: run.duration_s,
        period_s: run.period_s,
        samples,
        gigabytes: bytes / 1e9,
        minutes: samples / SAMPLES_A_SECOND / 60.0,
        most_s: rounded_down(MOST_BYTES / BYTES_A_SAMPLE * run.period_s),
    })
}

/// Returns a positive number rounded down to three digits.
fn rounded_down(value: f64) -> f64 {
    let digits = 2 - value.log10().floor() as i32;
    // a hair more, so that the rounding of a quotient does not cost a digit; division by a power of ten prints as it is written
    let scaled = (value * 10f64.powi(digits) * (1.0 + 4.0 * f64::EPSILON)).floor();
    if digits >= 0 { scaled / 10f64.powi(digits) } else { scaled * 10f64.powi(-digits) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_long_run_is_refused_with_its_estimate() {
        let run = |duration_s, period_s| require_memory(Run { key: "verify.duration", duration_s, period_s });
        assert!(run(60.0, 1e-3).is_ok() && run(3600.0, 1e-3).is_ok());
        let said = run(1e5, 1e-3).unwrap_err().to_string();
        assert!(
            said.contains("verify.duration") && said.contains("40 GB") && said.contains("5000 s"),
            "{said}"
        );
        let said = run(10.0, 1e-7).unwrap_err().to_string();
        assert!(said.contains("at most 0.5 s are run"), "{said}");
        let said = run(1e5, 3.3e-4).unwrap_err().to_string();
        assert!(said.contains("at most 1650 s are run"), "{said}");
        assert!(
            run(20.0, 1e-7).is_err() && run(f64::INFINITY, 1e-3).is_err() && run(f64::NAN, 1e-3).is_err()
        );
    }
}
