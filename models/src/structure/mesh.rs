//! The places of the nodes of a beam.

use super::profile::Profile;
use crate::Error;
use crate::tolerance::{AT_PIVOT, MOST_ELEMENTS};

/// Division of a beam into elements.
#[derive(Debug, Clone, PartialEq)]
pub enum ElementMesh {
    /// This many elements of equal length, wherever sections and pivot lie.
    Equal(usize),
    /// A node at every end of a section; this many elements, or of equal length if there are fewer than sections.
    Sections(usize),
    /// A node at every end of a section and at the pivot; at least this many elements.
    Pivoted(usize),
    /// Nodes at these places, m, rising, from one end of the beam to the other.
    Nodes(Vec<f64>),
}

impl ElementMesh {
    /// Returns the nodes, m, rising.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no element, or given nodes that do not rise from end to end of the beam.
    pub fn nodes_m(&self, profile: &Profile, pivot_m: f64) -> Result<Vec<f64>, Error> {
        let ends = [profile.start_m(), profile.end_m()];
        match self {
            Self::Equal(n) => Ok(split(&ends, require_elements(*n)?)),
            Self::Sections(n) => {
                let stations = profile.stations_m();
                Ok(split(if *n + 1 < stations.len() { &ends } else { &stations }, require_elements(*n)?))
            }
            Self::Pivoted(n) => Ok(split(&with_pivot(profile.stations_m(), pivot_m), require_elements(*n)?)),
            Self::Nodes(nodes) => check_nodes(nodes, ends),
        }
    }
}

fn with_pivot(mut stations: Vec<f64>, pivot_m: f64) -> Vec<f64> {
    let length = stations[stations.len() - 1] - stations[0];
    let at = stations.partition_point(|&s| s < pivot_m - AT_PIVOT * length);
    match stations.get(at) {
        Some(s) if (s - pivot_m).abs() <= AT_PIVOT * length => stations[at] = pivot_m,
        _ => stations.insert(at, pivot_m),
    }
    stations
}

/// Stations with nodes between them: each further element goes where elements are longest.
fn split(stations: &[f64], elements: usize) -> Vec<f64> {
    let mut parts = vec![1_usize; stations.len() - 1];
    let length = |i: usize, parts: &[usize]| (stations[i + 1] - stations[i]) / parts[i] as f64;
    for _ in parts.len()..elements {
        let longest = (0..parts.len())
            .fold(0, |best, i| if length(i, &parts) > length(best, &parts) { i } else { best });
        parts[longest] += 1;
    }
    let inside = |i: usize| {
        let (from, step, many) = (stations[i], length(i, &parts), parts[i]);
        (0..many).map(move |k| from + step * k as f64)
    };
    (0..parts.len()).flat_map(inside).chain([stations[stations.len() - 1]]).collect()
}

fn check_nodes(nodes: &[f64], [start, end]: [f64; 2]) -> Result<Vec<f64>, Error> {
    let rising = nodes.len() > 1 && nodes.windows(2).all(|w| w[0] < w[1]);
    let spans = rising && nodes[0] == start && nodes[nodes.len() - 1] == end;
    let refused = Error::Parameter {
        parameter: "mesh.nodes".to_owned(),
        value: nodes.len() as f64,
        allowed: "must rise from one end of the beam to the other".into(),
    };
    if spans { Ok(nodes.to_vec()) } else { Err(refused) }
}

fn require_elements(elements: usize) -> Result<usize, Error> {
    if (1..=MOST_ELEMENTS).contains(&elements) {
        return Ok(elements);
    }
    let (parameter, value) = ("mesh.elements".to_owned(), elements as f64);
    Err(Error::Parameter { parameter, value, allowed: "must be from 1 to 2000".into() })
}
