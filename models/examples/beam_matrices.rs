//! Writes mass and stiffness of the reference rig's beam as Matrix Market files, and the node map that goes with them, into a
//! folder: what a finite-element package would hand over. Run with `-- FOLDER`.
#![allow(non_snake_case)]

use counterpoise_models::reference::rig;
use counterpoise_models::structure::{ConfiguredStructure, FeOptions};
use std::fmt::Write as _;

/// Number of the first grid point.
const FIRST_GRID: usize = 100;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder")?;
    let fe = ConfiguredStructure::new(&rig(), None)?.build_fe_model(&FeOptions::default())?;
    let market = |A: &counterpoise_linalg::Mat| {
        let n = A.nrows();
        let lower: Vec<(usize, usize)> =
            (0..n).flat_map(|j| (j..n).map(move |i| (i, j))).filter(|&(i, j)| A[(i, j)] != 0.0).collect();
        let head = format!("%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {}\n", lower.len());
        lower.iter().fold(head, |text, &(i, j)| text + &format!("{} {} {:e}\n", i + 1, j + 1, A[(i, j)]))
    };
    std::fs::write(format!("{folder}/mass.mtx"), market(&fe.M))?;
    std::fs::write(format!("{folder}/stiffness.mtx"), market(&fe.K))?;
    let (hub, tip) = (fe.hub.ok_or("no node at the pivot")?, fe.tip);
    let grid = |row: usize| FIRST_GRID + row / 2;
    let mut map = "# which grid and component each row of the matrices belongs to, and where the grids lie\n"
        .to_owned();
    map += "axes 3 5          # deflection upward is component 3, rotation nose-up component 5\n";
    writeln!(map, "pivot {}\ntip {}", grid(hub.deflection), grid(tip.deflection))?;
    for row in (0..fe.heave.len()).step_by(2) {
        writeln!(map, "node {} {}", grid(row), (fe.pitch[row] * 1e9).round() / 1e9)?;
    }
    for row in 0..fe.heave.len() {
        writeln!(map, "row {} {}", grid(row), if row % 2 == 0 { 3 } else { 5 })?;
    }
    std::fs::write(format!("{folder}/nodes.map"), map)?;
    Ok(())
}
