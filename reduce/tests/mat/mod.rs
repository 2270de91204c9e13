//! A reader for the numeric matrices of MATLAB 5 files (full and sparse, compressed): enough for the benchmarks.
use std::collections::HashMap;
use std::path::Path;

use counterpoise_linalg::Mat;

/// Returns all numeric matrices of a file by name.
pub fn read(path: &Path) -> HashMap<String, Mat> {
    let bytes = std::fs::read(path).expect("readable file");
    let mut found = HashMap::new();
    let mut rest = &bytes[128..];
    while rest.len() >= 8 {
        let (kind, body, after) = element(rest);
        let inflated =
            (kind == 15).then(|| miniz_oxide::inflate::decompress_to_vec_zlib(body).expect("zlib data"));
        let matrix = inflated.as_deref().map_or(body, |data| element(data).1);
        let (name, value) = parse(matrix);
        found.insert(name, value);
        rest = after;
    }
    found
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
}

/// (type, data, what follows): elements are padded to eight bytes, small ones are packed into the tag.
fn element(bytes: &[u8]) -> (usize, &[u8], &[u8]) {
    let tag = word(bytes, 0);
    if tag >> 16 != 0 {
        return (tag & 0xffff, &bytes[4..4 + (tag >> 16)], &bytes[8..]);
    }
    let size = word(bytes, 4);
    let padded = if tag == 15 { size } else { size.div_ceil(8) * 8 };
    (tag, &bytes[8..8 + size], &bytes[(8 + padded).min(bytes.len())..])
}

fn parse(bytes: &[u8]) -> (String, Mat) {
    const SPARSE: u8 = 5;
    let (_, flags, rest) = element(bytes);
    let (_, dims, rest) = element(rest);
    let (_, name, mut rest) = element(rest);
    let (rows, cols) = (word(dims, 0), word(dims, 4));
    let mut next = || {
        let (kind, data, after) = element(rest);
        rest = after;
        numbers(kind, data)
    };
    let name = String::from_utf8_lossy(name).into_owned();
    if flags[0] != SPARSE {
        return (name, Mat::from_column_major(rows, cols, next()));
    }
    let (row, start, value) = (next(), next(), next());
    let mut matrix = Mat::zeros(rows, cols);
    for j in 0..cols {
        for k in start[j] as usize..start[j + 1] as usize {
            matrix[(row[k] as usize, j)] = value[k];
        }
    }
    (name, matrix)
}

fn numbers(kind: usize, data: &[u8]) -> Vec<f64> {
    let whole = |size: usize, read: fn(&[u8]) -> f64| data.chunks_exact(size).map(read).collect();
    match kind {
        1 => whole(1, |b| f64::from(b[0] as i8)),
        2 => whole(1, |b| f64::from(b[0])),
        3 => whole(2, |b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
        4 => whole(2, |b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
        5 => whole(4, |b| f64::from(word(b, 0) as u32 as i32)),
        6 => whole(4, |b| word(b, 0) as f64),
        9 => whole(8, |b| f64::from_le_bytes(b.try_into().expect("eight bytes"))),
        other => panic!("element type {other}"),
    }
}
