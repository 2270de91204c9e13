//! The lines in which two texts differ.

/// A line of a difference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DifferenceLine {
    /// A line of the first text only.
    Removed(String),
    /// A line of the second text only.
    Added(String),
    /// A number of equal lines.
    Gap(usize),
}

/// Returns the lines in which two texts differ, by their longest common subsequence; empty if they are equal.
pub fn line_differences(first: &str, second: &str) -> Vec<DifferenceLine> {
    let (a, b): (Vec<&str>, Vec<&str>) = (first.lines().collect(), second.lines().collect());
    if a == b {
        return Vec::new();
    }
    let start = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let tail = a[start..].iter().rev().zip(b[start..].iter().rev()).take_while(|(x, y)| x == y).count();
    let (a_end, b_end) = (a.len() - tail, b.len() - tail);
    let mut out = Vec::new();
    push_gap(&mut out, start);
    compare_middle(&a[start..a_end], &b[start..b_end], &mut out);
    push_gap(&mut out, tail);
    out
}

/// Compares the lines between equal ends: project files are short, so a table of all pairs is small.
fn compare_middle(a: &[&str], b: &[&str], out: &mut Vec<DifferenceLine>) {
    let width = b.len() + 1;
    let mut common = vec![0_u32; (a.len() + 1) * width];
    for i in (0..a.len()).rev() {
        for j in (0..b.len()).rev() {
            common[i * width + j] = if a[i] == b[j] {
                common[(i + 1) * width + j + 1] + 1
            } else {
                common[(i + 1) * width + j].max(common[i * width + j + 1])
            };
        }
    }
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        if i < a.len() && j < b.len() && a[i] == b[j] {
            push_gap(out, 1);
            (i, j) = (i + 1, j + 1);
        } else if j == b.len() || (i < a.len() && common[(i + 1) * width + j] >= common[i * width + j + 1]) {
            out.push(DifferenceLine::Removed(a[i].to_owned()));
            i += 1;
        } else {
            out.push(DifferenceLine::Added(b[j].to_owned()));
            j += 1;
        }
    }
}

fn push_gap(out: &mut Vec<DifferenceLine>, count: usize) {
    match out.last_mut() {
        _ if count == 0 => {}
        Some(DifferenceLine::Gap(sum)) => *sum += count,
        _ => out.push(DifferenceLine::Gap(count)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_added_and_removed_lines_are_found() {
        let removed = |text: &str| DifferenceLine::Removed(text.to_owned());
        let added = |text: &str| DifferenceLine::Added(text.to_owned());
        let found = line_differences("a\nb\nc\nd\ne\n", "a\nB\nc\ne\nf\n");
        let gap = DifferenceLine::Gap(1);
        let expected = [gap.clone(), removed("b"), added("B"), gap.clone(), removed("d"), gap, added("f")];
        assert_eq!(found, expected);
        assert!(line_differences("same\n", "same\n").is_empty());
        assert_eq!(line_differences("", "x\n"), [added("x")]);
    }
}
