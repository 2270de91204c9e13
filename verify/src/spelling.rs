//! A figure that does not exist is answered with the nearest that does.

use crate::{Error, Figure};

/// The error for a key that no figure has.
pub(crate) fn unknown(key: &str) -> Error {
    let mut near: Vec<(usize, String)> =
        Figure::all().iter().map(|f| (edit_distance(key, &f.key()), f.key())).collect();
    near.sort();
    let close = near.first().filter(|(distance, _)| *distance <= 2 + key.len() / 3);
    let hint = close.map_or(String::new(), |(_, best)| format!(", did you mean '{best}'?"));
    Error::UnknownFigure { key: key.to_owned(), hint }
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
