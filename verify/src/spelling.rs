//! A key that does not exist is answered with the nearest that does.

/// Returns the key nearest to one that does not exist; `None` if all are too far from it.
pub(crate) fn nearest_key(key: &str, all: impl Iterator<Item = String>) -> Option<String> {
    let mut near: Vec<(usize, String)> = all.map(|known| (edit_distance(key, &known), known)).collect();
    near.sort();
    near.into_iter().next().filter(|(distance, _)| *distance <= 2 + key.len() / 3).map(|(_, known)| known)
}

/// Levenshtein's distance in characters.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
