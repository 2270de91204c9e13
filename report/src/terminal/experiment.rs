//! What `counterpoise experiment` prints of a plan.

use counterpoise_models::ControlledQuantity;

use super::add_line;
use crate::wording::experiment::ExperimentPlanText;

/// Returns the lines on a plan for a machine that controls a quantity.
pub fn experiment_lines(text: &ExperimentPlanText, controlled: ControlledQuantity) -> Vec<String> {
    let (travel, rate) = (controlled.travel_unit(), controlled.rate().unit());
    let mut lines = vec!["machines that are left:".to_owned()];
    text.machines.iter().enumerate().for_each(|(k, name)| add_line!(lines, "  {}: {name}", k + 1));
    add_line!(lines, "best experiment: {}", text.what);
    add_line!(
        lines,
        "  reaches {:.4} {travel}, {:.4} {rate} and {:.3} A",
        text.reached_angle_rad,
        text.reached_rate_rad_s,
        text.reached_current_a
    );
    add_line!(
        lines,
        "  {:<12} {:>29} {:>24}",
        "machines",
        "expected log-likelihood ratio",
        "probability of deciding"
    );
    for pair in &text.separations {
        let machines = format!("{} and {}", pair.first + 1, pair.second + 1);
        add_line!(
            lines,
            "  {machines:<12} {:>29.1} {:>22.1} %",
            pair.log_likelihood_ratio,
            100.0 * pair.probability
        );
    }
    if text.separations.iter().all(|pair| pair.probability == 0.0) && !text.separations.is_empty() {
        add_line!(
            lines,
            "  within these limits no experiment tells the machines apart; wider limits, or a further sensor, may"
        );
    }
    text.others.iter().for_each(|other| {
        add_line!(
            lines,
            "  instead: {} (ratio {:.1} for the two machines hardest to separate)",
            other.what,
            other.log_likelihood_ratio
        )
    });
    lines
}
