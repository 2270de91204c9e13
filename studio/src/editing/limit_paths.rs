//! Where the limits of the requirements stand in the project file.

use counterpoise_project::Document;

/// The keys of a limit, in the order in which an item with both gives two requirements.
const LIMIT_KEYS: [&str; 2] = ["at_least", "at_most"];

/// Returns the path of the limit of each requirement, in their order.
pub fn limit_paths(document: &Document) -> Vec<String> {
    let item = |index: usize| format!("verify.requirement[{index}]");
    let is_there = |index: &usize| document.source_text_at(&format!("{}.figure", item(*index))).is_some();
    let paths =
        (0..).take_while(is_there).flat_map(|index| LIMIT_KEYS.map(|key| format!("{}.{key}", item(index))));
    paths.filter(|path| document.source_text_at(path).is_some()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_with_both_limits_is_two_requirements() {
        let text = "[[verify.requirement]]\nfigure = \"crossover_hz\"\nat_most = 9.0\nat_least = 3.0\n\n[[verify.requirement]]\nfigure = \"max_sensitivity\"\nat_most = 1.5\n";
        let paths = limit_paths(&Document::parse(text, "project.toml"));
        let expected = [
            "verify.requirement[0].at_least",
            "verify.requirement[0].at_most",
            "verify.requirement[1].at_most",
        ];
        assert_eq!(paths, expected);
        assert!(limit_paths(&Document::parse("[plant]\n", "project.toml")).is_empty());
    }
}
