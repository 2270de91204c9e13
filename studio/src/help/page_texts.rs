//! What each page shows, and what can be done on it by pointer and by keyboard.

use super::topics::HelpTopic;
use crate::command::Page;

/// What a page is for, and the gestures on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageHelp {
    /// What the page shows.
    pub summary: &'static str,
    /// What can be dragged, clicked and typed.
    pub gestures: &'static [&'static str],
}

/// Returns the help of a page.
pub fn page_help(page: Page) -> PageHelp {
    match page {
        Page::Plant => PageHelp {
            summary: "The mechanism to scale, with its parameters, modes and friction. Values that the file leaves open are ranked by what they decide.",
            gestures: &["Numbers are dragged or typed.", "A mode is clicked to be animated on the beam."],
        },
        Page::Reduce => PageHelp {
            summary: "How many states the design needs: singular values, and the responses of the full and the reduced plant.",
            gestures: &["A bar is clicked to choose the order."],
        },
        Page::Design => PageHelp {
            summary: "The weights and all their consequences. The strip above has every requirement with its value, its limit and the room between them.",
            gestures: &[
                "Round handles in the plot of the weights are dragged; with the focus (Tab) arrow keys move them.",
                "The grip of a limit in a plot is dragged, or moved by arrow keys: the project's limit changes.",
                "A chip is clicked to stress its limit in the plots.",
                "A, B and C keep a design for comparison in this window.",
                "Ctrl+D keeps it with a name in the project's history, the tab History.",
                "A plot is dragged by its title; a double click on the title, or Ctrl+M, maximises it.",
            ],
        },
        Page::Verify => PageHelp {
            summary: "The verdicts of the full plant, each with the run behind it; then code and report.",
            gestures: &[
                "A verdict is clicked to see the run from which its figure is read.",
                "The grip of a limit in a plot is dragged: the project's limit changes.",
            ],
        },
        Page::Diagnose => PageHelp {
            summary: "Recordings beside the model, and what the model lacks: friction, backlash, out-of-balance, sensor errors, delay.",
            gestures: &[
                "Files are dropped onto the window.",
                "On the tab X-Y the two ends of the window are dragged, or moved by arrow keys.",
            ],
        },
        Page::Commission => PageHelp {
            summary: "Rounds of design, experiment and redesign on a machine behind a machine program.",
            gestures: &["F9 runs the next round."],
        },
        Page::Studies => PageHelp {
            summary: "Searches and comparisons of designs, the adaptation's test, another project beside this one, identification from recordings, and the next experiment.",
            gestures: &[
                "F10 runs the study that is shown, Esc stops it.",
                "A design of a search is clicked in its plot, or taken by its button: one step that can be undone.",
            ],
        },
        Page::Text => PageHelp {
            summary: "The project file as text. What is typed is designed and verified at once; errors stand in place.",
            gestures: &[
                "An error is clicked, or Shift+F8 pressed, to go to its place.",
                "Ctrl+F looks for a word.",
                "Tab leaves the text.",
            ],
        },
    }
}

/// Returns a page as a topic.
pub fn page_topic(page: Page) -> HelpTopic {
    HelpTopic { title: format!("The page {}", page.name()), text: page_help(page).summary.to_owned() }
}
