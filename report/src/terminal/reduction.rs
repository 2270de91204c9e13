//! What `counterpoise reduce` prints.

use counterpoise_pipeline::results::ReduceResult;

use super::add_line;

/// Returns the lines on a reduction: orders, error and bound, and the ranked states.
pub fn reduction_lines(result: &ReduceResult<String>) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    add_line!(lines, "order {} -> {}", result.order[0], result.order[1]);
    if let Some([error, rate]) = result.error {
        add_line!(lines, "largest error {error:.4e} at {rate:.4} rad/s");
    }
    if let Some(bound) = result.bound {
        add_line!(lines, "bound {bound:.4e}");
    }
    result.ranked.iter().enumerate().for_each(|(k, value)| add_line!(lines, "{:4} {value:.4e}", k + 1));
    result.warnings.iter().for_each(|warning| add_line!(lines, "warning: {warning}"));
    all
}
