//! Dense Matrix Market files.

use std::fmt::Write as _;
use std::path::Path;

use counterpoise_linalg::Mat;

/// Reads a dense file, general or symmetric.
pub fn read(path: &Path) -> Mat {
    let text = std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
    let symmetric = text.lines().next().is_some_and(|line| line.contains("symmetric"));
    let mut words = text.lines().filter(|line| !line.starts_with('%')).flat_map(str::split_whitespace);
    let mut number = || words.next().expect("an entry").parse::<f64>().expect("a number");
    let (rows, cols) = (number() as usize, number() as usize);
    let mut matrix = Mat::zeros(rows, cols);
    for j in 0..cols {
        for i in if symmetric { j } else { 0 }..rows {
            matrix[(i, j)] = number();
            if symmetric {
                matrix[(j, i)] = matrix[(i, j)];
            }
        }
    }
    matrix
}

/// Writes every matrix to a file of its name.
pub fn write(folder: &Path, matrices: &[(&str, Mat)]) {
    std::fs::create_dir_all(folder).expect("output folder");
    for (name, matrix) in matrices {
        let (rows, cols) = matrix.shape();
        let mut text = format!("%%MatrixMarket matrix array real general\n{rows} {cols}\n");
        for entry in matrix.as_slice() {
            writeln!(text, "{entry:e}").expect("writing to a string");
        }
        std::fs::write(folder.join(format!("{name}.mtx")), text).expect("writable output");
    }
}
