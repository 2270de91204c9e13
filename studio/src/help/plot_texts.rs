//! What each plot shows and how it is read.

/// A plot by the beginning of its title, and its explanation.
struct PlotText {
    title: &'static str,
    text: &'static str,
}

const fn text(title: &'static str, text: &'static str) -> PlotText {
    PlotText { title, text }
}

/// The plots; the first whose title begins alike is taken.
const PLOTS: [PlotText; 22] = [
    text(
        "Weights",
        "The weights of the cost over frequency. The controller makes the weighted signals small: a higher error weight at a frequency asks for more rejection there, a higher control weight for less control. The handles are dragged or moved by arrow keys.",
    ),
    text(
        "Loop gain",
        "The loop broken at the plant's input. Where it is large, disturbances are rejected; it must be well below 1 where the plant is not known. The marks are the crossings at which the margins are read.",
    ),
    text(
        "Loop phase",
        "The phase of the loop gain. At the frequency where the gain crosses 1, its distance from -180 deg is the phase margin.",
    ),
    text(
        "Sensitivity",
        "S says how much of a disturbance is left, T how much of the sensors' noise reaches the hub. Disturbances are amplified where S is above 1; its peak is the reciprocal of the smallest distance of the loop from -1.",
    ),
    text(
        "Step of the demand",
        "The hub after a step of its demand, on the linear plant. Shaded regions are where the response would break a limit.",
    ),
    text(
        "Control effort",
        "The control for a step and for motion of the platform, about the value that holds the weight of the mechanism.",
    ),
    text("Heave", "The hub while the platform heaves, with the feedback alone and with the feedforward."),
    text("Pitch", "The hub while the platform pitches, with the feedback alone and with the feedforward."),
    text(
        "Error against effort",
        "What is left of the disturbance against the control that noise causes, as the error weight grows. The point is the design.",
    ),
    text(
        "Nichols",
        "The loop gain in dB against its phase. It must pass the point 0 dB, -180 deg with the distance that the dashed outline of the largest sensitivity shows.",
    ),
    text(
        "Nyquist",
        "The loop gain in the complex plane. Its smallest distance from -1 is the reciprocal of the largest sensitivity.",
    ),
    text(
        "Root locus",
        "The poles of the closed loop as the loop gain grows. Crosses are the poles, rings the zeros; poles right of the vertical line are unstable.",
    ),
    text(
        "Mechanism",
        "The mechanism from the side at the time of the cursor or of the slider: the platform and the beam (or slide) on it, with the motion magnified as stated. The pointer on a plot over time moves it.",
    ),
    text("Hub for", "The response of the hub in the closed loop over frequency."),
    text(
        "Control for",
        "The control in the closed loop over frequency, for the demand and for the noise of each sensor.",
    ),
    text(
        "Rejection of",
        "Hub rate over the motion of the platform, over frequency: without control, with the feedback, and with the feedforward.",
    ),
    text(
        "On the road",
        "The hub on the recorded or synthesised road, on the full plant and on the linear one.",
    ),
    text("Control", "The control of the run behind the selected requirement, on the full plant."),
    text("Motor current", "The motor current of the run behind the selected requirement, on the full plant."),
    text("Hankel", "How much each state contributes to the response: small ones can be left out."),
    text(
        "At rest",
        "The hub without a demand, while the platform is still: a limit cycle or creep shows here.",
    ),
    text("Triangle of the demand", "The hub for a triangle of its demand: friction shows at the reversals."),
];

/// What every plot has.
const GESTURES: &str =
    "The wheel zooms, a drag pans, a double click fits. The right button copies or saves the plot.";

/// Returns the explanation of a plot, with what can be done with it.
pub fn plot_help(title: &str) -> String {
    let found = PLOTS.iter().find(|plot| title.starts_with(plot.title)).map(|plot| plot.text);
    let found = found.or_else(|| {
        let pair = "One channel of a recording against another, as measured and as simulated, in the window that is chosen above. Friction is a loop of torque over rate, backlash a gap.";
        let residual = "A recorded channel beside what the model makes of it. A residual of one noise floor is all that a perfect model could reach.";
        if title.contains(" against ") { Some(pair) } else { title.contains("residual").then_some(residual) }
    });
    found.map_or_else(|| GESTURES.to_owned(), |text| format!("{text}\n{GESTURES}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plots_are_explained_and_each_explanation_can_be_reached() {
        for (k, plot) in PLOTS.iter().enumerate() {
            assert!(plot_help(plot.title).starts_with(plot.text), "{}", plot.title);
            assert!(PLOTS[..k].iter().all(|before| !plot.title.starts_with(before.title)), "{}", plot.title);
        }
        assert!(plot_help("control against hub rate").contains("Friction"));
        assert_eq!(plot_help("something else"), GESTURES);
    }
}
