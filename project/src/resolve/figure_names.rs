//! The names of the figures that a requirement may limit.

use counterpoise_models::ControlledQuantity;
use counterpoise_verify::PerformanceFigure;

use crate::diagnostic::did_you_mean;

/// Figures whose names contain what was written that a hint lists, at most.
const MOST_LISTED: usize = 4;

/// Returns a hint that leads to the figure that was meant.
pub(super) fn figure_hint(written: &str, controlled: ControlledQuantity) -> String {
    let keys: Vec<String> = PerformanceFigure::all().iter().map(|figure| figure.key_in(controlled)).collect();
    if let Some(hint) = did_you_mean(written, keys.iter().map(String::as_str)) {
        return hint;
    }
    let containing = keys.iter().filter(|key| key.contains(&written.to_lowercase()));
    let quoted: Vec<String> = containing.take(MOST_LISTED).map(|key| format!("\"{key}\"")).collect();
    if quoted.is_empty() {
        "figures are, for example, \"gain_margin_db\", \"max_sensitivity\" and \"nonlinear_step_overshoot_percent\"; `counterpoise check --keys=figures` \
         lists all of them"
            .to_owned()
    } else {
        format!("did you mean {}?", quoted.join(" or "))
    }
}

/// Returns the table of all figures, as Markdown. Figures of the linear and of the nonlinear model have one row.
pub(super) fn figure_table() -> String {
    let mut text = "\n## figures of requirements\n\nThe names that `figure` of `[[verify.requirement]]` takes, in a loop of rate. In other loops the unit at \
                    the end of a name is that of what the loop controls. A DRR may be asked for at any frequency. MODEL is `linear` or `nonlinear`.\n\n\
                    | figure | unit |\n|---|---|\n"
        .to_owned();
    for figure in PerformanceFigure::all() {
        let key = figure.key();
        if key.starts_with("nonlinear_") {
            continue;
        }
        let key = key.strip_prefix("linear_").map_or(key.clone(), |rest| format!("MODEL_{rest}"));
        let unit = figure.unit(ControlledQuantity::default());
        text.push_str(&format!("| `{key}` | {unit} |\n"));
    }
    text
}
