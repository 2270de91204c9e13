//! What help is asked for: the thing under the pointer or with the keyboard's focus.

use crate::editing::key_reference::find_key;

/// A thing that can be explained.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HelpTopic {
    /// Its name.
    pub title: String,
    /// What it is, and what can be done with it.
    pub text: String,
}

impl HelpTopic {
    /// Returns the topic of a key of the project file.
    pub fn of_key(path: &str) -> Self {
        let text = find_key(path).map_or_else(String::new, |key| {
            let unit = if key.unit.is_empty() { String::new() } else { format!(" {}", key.unit) };
            format!(
                "{}\nAllowed: {}{unit}.\nDrag the number, or click it and type; Ctrl+Z undoes the change. The page Text shows its line.",
                key.meaning, key.allowed
            )
        });
        Self { title: path.to_owned(), text }
    }
}

/// State of the help window.
#[derive(Debug, Clone, Default)]
pub struct HelpState {
    /// What is explained; `None` while the window is closed.
    pub shown: Option<HelpTopic>,
    /// What is under the pointer or has the focus in this frame.
    pub pointed: Option<HelpTopic>,
    /// The term that is looked for.
    pub search: String,
}

impl HelpState {
    /// Notes what is under the pointer or has the focus.
    pub fn note(&mut self, title: impl Into<String>, text: impl Into<String>) {
        self.pointed = Some(HelpTopic { title: title.into(), text: text.into() });
    }

    /// Opens help about what is under the pointer, or about a page if nothing is; closes it if it shows that already.
    pub fn toggle(&mut self, page: HelpTopic) {
        let topic = self.pointed.clone().unwrap_or(page);
        self.shown = if self.shown.as_ref() == Some(&topic) { None } else { Some(topic) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_follows_the_pointer_and_closes_on_the_same_topic() {
        let mut help = HelpState::default();
        let page = HelpTopic { title: "Design".to_owned(), text: String::new() };
        help.toggle(page.clone());
        assert_eq!(help.shown, Some(page.clone()));
        help.note("Loop gain", "the loop");
        help.toggle(page.clone());
        assert_eq!(help.shown.as_ref().map(|topic| topic.title.as_str()), Some("Loop gain"));
        help.toggle(page);
        assert_eq!(help.shown, None);
        assert!(HelpTopic::of_key("plant.gearbox.backlash").text.contains("rad"));
    }
}
