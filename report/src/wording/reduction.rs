//! Remarks about a reduction in words.

use counterpoise_reduce::Warning;

/// Describes what a user should know about a reduction.
pub fn describe_reduction_warning(warning: &Warning) -> String {
    match warning {
        Warning::CutsPair { kept, dropped } => format!(
            "the cut parts two values of like size, {kept:.4e} and {dropped:.4e}: keep one state more or less"
        ),
        Warning::FewerThanAsked { asked, kept } => {
            format!("{asked} states were asked for, only {kept} carry anything above rounding")
        }
        Warning::MeasuredOnGrid { points } => {
            format!("the error was measured at {points} frequencies, not bounded between")
        }
        Warning::LoopUnstable { re, im } => {
            format!("the loop with the reduced controller has the pole {re:.4e} {im:+.4e}i: keep more states")
        }
        Warning::GramiansUnfinished { share } => format!(
            "the last step of the balancing still contributed {share:.1e} of the Gramian's factor: the Hankel values may miss modes"
        ),
        Warning::SmallGap { kept, dropped } => {
            format!("the order rests on a small gap: {kept:.2e} was kept, {dropped:.2e} dropped")
        }
    }
}
