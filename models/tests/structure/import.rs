use super::{assert_all, assert_close, options, uniform_beam};
use counterpoise_linalg::{Mat, Sparse};
use counterpoise_models::Error;
use counterpoise_models::structure::import::{
    Dof, Imported, NodeMap, has_labels, is_binary_op4, matrix_market, read_binary_op4, read_dmig,
    read_labels, read_op4, read_rows, read_triplets,
};
use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, Integration, Support, reduce_to_lumped, undamped_modes,
};
use std::fmt::Write;

const ELEMENTS: usize = 6;

fn model() -> FeModel {
    let mut beam = uniform_beam();
    beam.pivot_m = 0.5;
    FeModel::beam(
        &beam,
        &AttachedMasses::default(),
        &options(ElementMesh::Equal(ELEMENTS), Integration::Quadrature),
    )
    .unwrap()
}

/// Rows in the reverse order of the nodes, rotations nose-down.
fn map_text() -> String {
    let mut text = "# a map\naxes 3 -5\npivot 13\ntip 16\n".to_owned();
    (0..=ELEMENTS).for_each(|i| writeln!(text, "node {} {:?}", 10 + i, i as f64 / ELEMENTS as f64).unwrap());
    (0..=ELEMENTS).rev().for_each(|i| writeln!(text, "row {} 3\nrow {} 5", 10 + i, 10 + i).unwrap());
    text
}

/// The model's matrix with rows as in the map.
fn map_matrix(A: &Mat, map: &NodeMap) -> Mat {
    let index = |d: &Dof| 2 * (d.grid as usize - 10) + usize::from(d.component == 5);
    let sign = |d: &Dof| if d.component == 5 { -1.0 } else { 1.0 };
    let n = A.nrows();
    Mat::from_fn(n, n, |i, j| {
        let (a, b) = (&map.rows[i], &map.rows[j]);
        sign(a) * A[(index(a), index(b))] * sign(b)
    })
}

fn assert_same(imported: &Imported, map: &NodeMap) {
    let (found, expected) = (imported.structure(map).unwrap(), model());
    for support in [Support::Free, Support::Pinned, Support::Clamped] {
        let of = |model: &FeModel| undamped_modes(model, support).unwrap().flexible_rad_s()[..5].to_vec();
        assert_all(&of(&found), &of(&expected), 1e-7);
    }
    assert_close(found.inertia_kg_m2(), expected.inertia_kg_m2(), 1e-8);
    assert_close(found.first_moment_kg_m(), expected.first_moment_kg_m(), 1e-8);
    let (found, expected) =
        (reduce_to_lumped(&found, &[0.01]).unwrap(), reduce_to_lumped(&expected, &[0.01]).unwrap());
    assert_close(found.hub_inertia_kg_m2 / expected.hub_inertia_kg_m2, 1.0, 1e-6);
}

#[test]
fn matrix_market_gives_the_same_structure() {
    let map = NodeMap::parse(&map_text()).unwrap();
    let (M, K) = (map_matrix(&model().M, &map), map_matrix(&model().K, &map));
    let mut array =
        format!("%%MatrixMarket matrix array real general\n% mass\n{} {}\n", M.nrows(), M.ncols());
    M.as_slice().iter().for_each(|v| writeln!(array, "{v:?}").unwrap());
    let lower: Vec<(usize, usize)> =
        (0..K.ncols()).flat_map(|j| (j..K.nrows()).map(move |i| (i, j))).collect();
    let mut coordinate =
        format!("%%MatrixMarket matrix coordinate real symmetric\n{0} {0} {1}\n", K.nrows(), lower.len());
    lower.iter().for_each(|&(i, j)| writeln!(coordinate, "{} {} {:e}", i + 1, j + 1, K[(i, j)]).unwrap());
    let imported = Imported::from_row_order(
        &map,
        matrix_market(&array).unwrap(),
        None,
        matrix_market(&coordinate).unwrap(),
    );
    assert_eq!((imported.M.to_dense(), imported.K.to_dense()), (M, K));
    assert_same(&imported, &map);
}

#[test]
fn matrix_market_reads_what_scipy_writes() {
    let array = "%%MatrixMarket matrix array real symmetric\n%\n2 2\n1.2E1\n6\n-1.25E-6\n";
    let expected = Mat::from_rows(&[[12.0, 6.0], [6.0, -1.25e-6]]);
    assert_eq!(matrix_market(array).unwrap().to_dense(), expected);
    let skew = "%%MatrixMarket matrix array real skew-symmetric\n2 2\n3\n";
    assert_eq!(matrix_market(skew).unwrap().to_dense(), Mat::from_rows(&[[0.0, -3.0], [3.0, 0.0]]));
}

#[test]
fn matrix_market_names_the_line_that_is_wrong() {
    let cases = [
        ("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n", 1),
        ("%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 1\n", 3),
        ("%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 one\n", 3),
        ("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n", 2),
        ("%%MatrixMarket matrix array real general\n1 1\n1\n2\n", 4),
        ("%%MatrixMarket matrix array real symmetric\n1 2\n1\n2\n", 2),
        ("", 1),
    ];
    for (text, expected) in cases {
        match matrix_market(text) {
            Err(Error::Import { line, .. }) => assert_eq!(line, expected, "{text}"),
            other => panic!("{text}: {other:?}"),
        }
    }
}

/// The matrix's lower half as DMIG in large fields.
fn large_fields(name: &str, A: &Mat, map: &NodeMap) -> String {
    let mut text = format!("$ DMIG Matrix {name}\nDMIG    {name:<8}{:>8}{:>8}{:>8}{:>8}\n", 0, 6, 2, 0);
    for j in 0..A.ncols() {
        let col = map.rows[j];
        writeln!(text, "DMIG*   {name:<16}{:>16}{:>16}", col.grid, col.component).unwrap();
        for i in j..A.nrows() {
            let row = map.rows[i];
            let value = format!("{:.9E}", A[(i, j)]).replace('E', "D");
            writeln!(text, "*       {:>16}{:>16}{value:>16}", row.grid, row.component).unwrap();
        }
    }
    text
}

#[test]
fn dmig_gives_the_same_structure() {
    let map = NodeMap::parse(&map_text()).unwrap();
    let text = format!(
        "BEGIN BULK\nGRID,1,,0.,0.,0.\n{}{}ENDDATA\n",
        large_fields("KAAX", &map_matrix(&model().K, &map), &map),
        large_fields("MAAX", &map_matrix(&model().M, &map), &map)
    );
    let imported = Imported::from_dmig(&read_dmig(&text).unwrap(), "maax", None, "KAAX").unwrap();
    assert_same(&imported, &map);
}

#[test]
fn dmig_reads_small_large_and_free_fields() {
    let small = "\
DMIG        KAAX       0       6       1       0       0               0
DMIG        KAAX       1       3               1       31500000.
DMIG        KAAX       1       5               1       3 -2.25-4
               2       3      7.
GRID           9
               2       3    999.
";
    let large = "\
DMIG*               KAAX               0               6               1
*                      0               0                               0
DMIG*               KAAX               1               3
*                      1               3        1500000.
DMIG*               KAAX               1               5
*                      1               3        -.000225
*                      2               3              7.
";
    let free = "DMIG,KAAX,0,6,1,0\nDMIG,KAAX,1,3,,1,3,1.5+6\nDMIG,KAAX,1,5,,1,3,-2.25-4\n,2,3,7.0\n";
    let dof = |grid, component| Dof { grid, component };
    let expected =
        vec![(dof(1, 3), dof(1, 3), 1.5e6), (dof(1, 3), dof(1, 5), -2.25e-4), (dof(2, 3), dof(1, 5), 7.0)];
    for text in [small, large, free] {
        let found = read_dmig(text).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].entries, expected, "{text}");
    }
    let matrix = read_dmig(free).unwrap()[0].matrix(&[dof(1, 3), dof(1, 5), dof(2, 3)]).unwrap().to_dense();
    assert_eq!(matrix, Mat::from_rows(&[[1.5e6, -2.25e-4, 0.0], [-2.25e-4, 0.0, 7.0], [0.0, 7.0, 0.0]]));
}

#[test]
fn dmig_names_the_line_that_is_wrong() {
    let cases = [
        ("DMIG,K,1,3,,1,3,1.0\n", 1),
        ("DMIG,K,0,6,3,0\n", 1),
        ("DMIG,K,0,6,1,0\nDMIG,K,1,3,,1,3,x\n", 2),
        ("DMIG,K,0,9,1,0\n", 1),
    ];
    for (text, expected) in cases {
        assert!(matches!(read_dmig(text), Err(Error::Import { line, .. }) if line == expected), "{text}");
    }
    assert!(Imported::from_dmig(&[], "M", None, "K").is_err());
}

const OP4_DENSE: &str = "
       4       4       6       2KGG     1P,3E23.16
       1       1       4
 1.2000000000000000E+01 6.0000000000000000E+00 0.0000000000000000E+00
-1.2500000000000001E-06
       2       1       2
 6.0000000000000000E+00 4.0000000000000000E+00
       3       3       1
 3.2500000000000000E+00
       4       1       4
-1.2500000000000001E-06 0.0000000000000000E+00 0.0000000000000000E+00
 1.0000000000000000E+08
       5       1       1
 1.0000000000000000E+00
       2       2       1       2MGG     1P,5E16.9
       2       1       2
 5.000000000E-01-2.000000000E+00
       3       1       1
 1.414213562E+00
";

const OP4_BIGMAT: &str = "
       4      -4       6       2KGG     1P,5E16.9
       1       0      10
       5       1
 1.200000000E+01 6.000000000E+00
       3       4
-1.250000000E-06
       2       0       6
       5       1
 6.000000000E+00 4.000000000E+00
       3       0       4
       3       3
 3.250000000E+00
       4       0       8
       3       1
-1.250000000E-06
       3       4
 1.000000000E+08
       5       1       1
 1.414213562E+00
";

const OP4_SPARSE: &str = "
       4       4       6       2KGG     1P,5E16.9
       1       0       8
     327681
 1.200000000E+01 6.000000000E+00
     196612
-1.250000000E-06
       2       0       5
     327681
 6.000000000E+00 4.000000000E+00
       3       0       3
     196611
 3.250000000E+00
       4       0       6
     196609
-1.250000000E-06
     196612
 1.000000000E+08
       5       1       1
 1.414213562E+00
";

#[test]
fn op4_reads_dense_sparse_and_bigmat() {
    let expected = Mat::from_rows(&[
        [12.0, 6.0, 0.0, -1.25e-6],
        [6.0, 4.0, 0.0, 0.0],
        [0.0, 0.0, 3.25, 0.0],
        [-1.25e-6, 0.0, 0.0, 1e8],
    ]);
    for text in [OP4_DENSE, OP4_BIGMAT, OP4_SPARSE] {
        let found = read_op4(text).unwrap();
        assert_eq!(found[0].name, "KGG");
        assert_close((&found[0].matrix.to_dense() - &expected).norm_max(), 0.0, 1e-21);
    }
    let second = &read_op4(OP4_DENSE).unwrap()[1];
    assert_eq!(
        (second.name.as_str(), second.matrix.to_dense()),
        ("MGG", Mat::from_rows(&[[0.0, 0.5], [0.0, -2.0]]))
    );
}

#[test]
fn op4_names_the_line_that_is_wrong() {
    let cases = [
        (OP4_DENSE.replace("       2KGG", "       4KGG"), 2),
        (OP4_DENSE.replace(" 3.2500000000000000E+00", " 3.25000000x0000000E+00"), 9),
        (OP4_DENSE.replace("       3       3       1", "       3       5       1"), 9),
        (OP4_BIGMAT.lines().take(12).collect::<Vec<_>>().join("\n"), 0),
    ];
    for (text, expected) in cases {
        assert!(
            matches!(read_op4(&text), Err(Error::Import { line, .. }) if line == expected),
            "{expected}: {:?}",
            read_op4(&text)
        );
    }
}

/// Which entries of a symmetric matrix are written.
#[derive(Clone, Copy)]
enum Part {
    Whole,
    Lower,
    Upper,
}

/// The matrix's nonzero entries as lines, with the words of a row and of a column.
fn entry_lines(A: &Mat, part: Part, comma: &str, words: impl Fn(usize) -> String) -> String {
    let n = A.nrows();
    let is_there = |i: usize, j: usize| match part {
        Part::Whole => true,
        Part::Lower => i >= j,
        Part::Upper => i <= j,
    };
    let places = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let line = |(i, j): (usize, usize)| format!("{}{comma}{}{comma}{:.15e}\n", words(i), words(j), A[(i, j)]);
    places.filter(|&(i, j)| is_there(i, j) && A[(i, j)] != 0.0).map(line).collect()
}

#[test]
fn abaqus_and_calculix_give_the_same_structure() {
    let map = NodeMap::parse(&map_text()).unwrap();
    let (M, K) = (map_matrix(&model().M, &map), map_matrix(&model().K, &map));
    for part in [Part::Whole, Part::Lower, Part::Upper] {
        let label = |i: usize| format!("{},{}", map.rows[i].grid, map.rows[i].component);
        let text = |A: &Mat| {
            format!("** made by a test\n*MATRIX INPUT, NAME=A\n{}", entry_lines(A, part, ",", label))
        };
        assert!(has_labels(&text(&M)));
        let mut named = [("M", &M), ("K", &K)].map(|(name, A)| (name, read_labels(&text(A)).unwrap()));
        named.iter_mut().for_each(|(name, matrix)| matrix.name = (*name).to_owned());
        let all = named.map(|(_, matrix)| matrix);
        assert_same(&Imported::from_dmig(&all, "M", None, "K").unwrap(), &map);

        let numbered = |A: &Mat| entry_lines(A, part, "  ", |i| (i + 1).to_string());
        assert!(!has_labels(&numbered(&M)));
        let of = |A: &Mat| read_triplets(&numbered(A), map.rows.len()).unwrap();
        let rows: String = map.rows.iter().map(|row| format!("{}.{}\n", row.grid, row.component)).collect();
        assert_eq!(read_rows(&rows).unwrap(), map.rows);
        assert_same(&Imported::from_row_order(&map, of(&M), None, of(&K)), &map);
    }
}

#[test]
fn lines_of_entries_that_are_wrong_are_named() {
    let refused = |found: Result<(), Error>| match found {
        Err(Error::Import { line, what }) => (line, what),
        other => panic!("{other:?}"),
    };
    for (text, line, word) in [
        ("1 1 2.0\n3 1 1.0\n", 2, "outside 2 x 2"),
        ("1 1 2.0\n0 1 1.0\n", 2, "outside"),
        ("1 1 2.0\n\n1 1 3.0\n", 3, "earlier line"),
        ("1 1\n", 1, "row, column and value"),
        ("1 1 nan\n", 1, "not a number"),
        ("1 1 1e999\n", 1, "not a number"),
        ("1 99999999999999999999 1\n", 1, "not a whole number"),
        ("*MATRIX INPUT, NAME=K, SCALE FACTOR=2\n1 1 1\n", 1, "scale factor"),
    ] {
        let (at, what) = refused(read_triplets(text, 2).map(drop));
        assert_eq!(at, line, "{text}");
        assert!(what.contains(word), "{text}: {what}");
    }
    let too_many = refused(read_triplets("1 1 1\n", usize::MAX).map(drop)).1;
    assert!(too_many.contains("unknowns"), "{too_many}");
    for (text, line, word) in [
        ("1,1,1,1,2.0\n-3,1,1,1,1.0\n", 2, "internal to Abaqus"),
        ("1,1,1,1,2.0\n1,1,1,1,2.0\n", 2, "earlier line"),
        ("1,1,1,1,2.0\n1,999,1,1,2.0\n", 2, "whole number"),
        ("1,1,1,1,2.0\n1,1,2.0\n", 2, "row node"),
    ] {
        let (at, what) = refused(read_labels(text).map(drop));
        assert_eq!(at, line, "{text}");
        assert!(what.contains(word), "{text}: {what}");
    }
    for (text, line) in [("1.1\n1.1\n", 2), ("1\n", 1), ("1.x\n", 1), ("1.1 2\n", 1)] {
        assert_eq!(refused(read_rows(text).map(drop)).0, line, "{text}");
    }
    assert!(read_labels("").is_ok_and(|none| none.entries.is_empty()) && !has_labels(""));
}

/// How a binary OUTPUT4 file is written.
#[derive(Clone, Copy)]
struct BinaryForm {
    big_endian: bool,
    single: bool,
    columns: Columns,
}

#[derive(Clone, Copy, PartialEq)]
enum Columns {
    Dense,
    Sparse,
    Bigmat,
}

fn binary_op4(name: &str, A: &Mat, form: BinaryForm) -> Vec<u8> {
    let word = |value: i64| {
        let value = i32::try_from(value).unwrap();
        if form.big_endian { value.to_be_bytes() } else { value.to_le_bytes() }
    };
    let value = |value: f64| match (form.single, form.big_endian) {
        (true, true) => (value as f32).to_be_bytes().to_vec(),
        (true, false) => (value as f32).to_le_bytes().to_vec(),
        (false, true) => value.to_be_bytes().to_vec(),
        (false, false) => value.to_le_bytes().to_vec(),
    };
    let record = |data: &[u8]| [&word(data.len() as i64)[..], data, &word(data.len() as i64)[..]].concat();
    let (n, size) = (A.nrows() as i64, if form.single { 1 } else { 2 });
    let rows = if form.columns == Columns::Bigmat { -n } else { n };
    let header: Vec<u8> = [n, rows, 6, if form.single { 1 } else { 2 }].into_iter().flat_map(word).collect();
    let mut out = record(&[&header[..], format!("{name:<8}").as_bytes()].concat());
    let mut column = |col: i64, first: i64, data: &[u8]| {
        let head: Vec<u8> = [col, first, data.len() as i64 / 4].into_iter().flat_map(word).collect();
        out.extend(record(&[&head[..], data].concat()));
    };
    for j in 0..A.ncols() {
        let values = A.column(j);
        if form.columns == Columns::Dense {
            column(j as i64 + 1, 1, &values.iter().flat_map(|v| value(*v)).collect::<Vec<u8>>());
            continue;
        }
        let mut data = Vec::new();
        for (i, v) in values.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            let row = i as i64 + 1;
            match form.columns {
                Columns::Bigmat => data.extend([word(size + 1), word(row)].concat()),
                _ => data.extend(word(row + 65_536 * (size + 1))),
            }
            data.extend(value(*v));
        }
        column(j as i64 + 1, 0, &data);
    }
    column(n + 1, 1, &value(1.0));
    out
}

/// Every way in which a binary file can be written.
fn binary_forms() -> Vec<BinaryForm> {
    let columns = [Columns::Dense, Columns::Sparse, Columns::Bigmat];
    let ways = columns.into_iter().flat_map(|columns| [(columns, false), (columns, true)]);
    let form = |(columns, single)| [false, true].map(|big_endian| BinaryForm { big_endian, single, columns });
    ways.flat_map(form).collect()
}

#[test]
fn binary_op4_reads_every_form() {
    let A = Mat::from_rows(&[
        [12.0, 6.0, 0.0, -1.25],
        [6.0, 4.0, 0.0, 0.0],
        [0.0, 0.0, 3.25, 0.0],
        [-1.25, 0.0, 0.0, 1e8],
    ]);
    for form in binary_forms() {
        let bytes = [binary_op4("KGG", &A, form), binary_op4("MGG", &A, form)].concat();
        assert!(is_binary_op4(&bytes));
        let found = read_binary_op4(&bytes).unwrap();
        let names: Vec<&str> = found.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["KGG", "MGG"]);
        assert!(found.iter().all(|one| one.matrix.to_dense() == A));
    }
    assert!(!is_binary_op4(OP4_DENSE.as_bytes()) && !is_binary_op4(b"") && !is_binary_op4(&[24, 0]));
}

#[test]
fn spoilt_binary_op4_is_refused_and_nothing_else() {
    let A = Mat::from_fn(5, 5, |i, j| (i + j) as f64);
    let mut state = 7_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for form in binary_forms() {
        let sound = binary_op4("KGG", &A, form);
        for cut in 0..sound.len() {
            assert!(read_binary_op4(&sound[..cut]).is_err(), "cut at {cut}");
        }
        for _ in 0..2000 {
            let mut bytes = sound.clone();
            for _ in 0..=next(3) {
                let at = next(bytes.len());
                bytes[at] = [0, 1, 0x7f, 0x80, 0xff, 24][next(6)];
            }
            let _ = read_binary_op4(&bytes).is_ok();
        }
    }
    let wide = [&48_i32.to_le_bytes()[..], &[0; 48], &48_i32.to_le_bytes()].concat();
    let told = |bytes: &[u8]| read_binary_op4(bytes).unwrap_err().to_string();
    assert!(told(&wide).contains("32-bit words"), "{}", told(&wide));
    let form = BinaryForm { big_endian: false, single: false, columns: Columns::Dense };
    let mut complex = binary_op4("KGG", &A, form);
    complex[16] = 4;
    assert!(told(&complex).contains("type 4"), "{}", told(&complex));
    let mut huge = binary_op4("KGG", &A, form);
    huge[8..12].copy_from_slice(&i32::MAX.to_le_bytes());
    assert!(told(&huge).contains("unknowns"), "{}", told(&huge));
    let nan = binary_op4("KGG", &Mat::from_rows(&[[f64::NAN]]), form);
    assert!(told(&nan).contains("finite"), "{}", told(&nan));
}

#[test]
fn a_map_names_what_is_missing_or_wrong() {
    let refused = |text: &str| match NodeMap::parse(text) {
        Err(Error::Import { line, what }) => (line, what),
        other => panic!("{other:?}"),
    };
    assert_eq!(refused("axes 3 5\nknot 1\n").0, 2);
    assert!(refused("axes 3 5\npivot 1\n").1.contains("tip"));
    assert!(refused("pivot 1\ntip 2\n").1.contains("axes"));
    assert!(refused("axes 3 5\npivot 1\ntip 2\nnode 1 0 0.2\n").1.contains("axial"));
    assert!(refused("axes 3 5\naxial 3\npivot 1\ntip 2\n").1.contains("axial"));
    let map = NodeMap::parse(&map_text().replace("node 12", "node 99")).unwrap();
    let (M, K) = (map_matrix(&model().M, &map), map_matrix(&model().K, &map));
    let sparse = Sparse::from_dense;
    assert!(Imported::from_row_order(&map, sparse(&M), None, sparse(&K)).structure(&map).is_err());
    let good = NodeMap::parse(&map_text()).unwrap();
    let skewed =
        &K + &Mat::from_fn(K.nrows(), K.ncols(), |i, j| if i == 0 && j == 3 { K.norm_max() } else { 0.0 });
    assert!(Imported::from_row_order(&good, sparse(&M), None, sparse(&skewed)).structure(&good).is_err());
}

#[test]
fn rotations_without_mass_follow_statically() {
    let mut sparse = model();
    let n = sparse.M.nrows();
    let nodes = n / 2;
    let share = |i: usize| if i == 0 || i == nodes - 1 { 0.5 } else { 1.0 } / (nodes - 1) as f64;
    sparse.M = Mat::from_fn(n, n, |i, j| if i == j && i % 2 == 0 { share(i / 2) } else { 0.0 });
    let found = undamped_modes(&sparse, Support::Clamped).unwrap();
    assert_eq!(found.frequencies_rad_s.len(), nodes - 1);
    let translations: Vec<usize> = (0..n).filter(|i| i % 2 == 0 && *i != 6).collect();
    let rotations: Vec<usize> = (0..n).filter(|i| i % 2 == 1 && *i != 7).collect();
    let part = |a: &[usize], b: &[usize]| sparse.K.select(a, b);
    let follow =
        counterpoise_linalg::solve(&part(&rotations, &rotations), &part(&rotations, &translations)).unwrap();
    let condensed = &part(&translations, &translations) - &(&part(&translations, &rotations) * &follow);
    let mass = sparse.M.select(&translations, &translations);
    let (values, _) = counterpoise_linalg::sym_gen_eigen(&condensed.symmetric_part(), &mass).unwrap();
    let expected: Vec<f64> = values.iter().map(|v| v.sqrt()).collect();
    assert_all(&found.frequencies_rad_s, &expected, 1e-9);
    assert_eq!(undamped_modes(&sparse, Support::Pinned).unwrap().rigid, 1);
}

#[test]
fn spoilt_texts_are_refused_and_nothing_else() {
    let map = map_text();
    let market =
        "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1.0\n2 1 -.5D0\n2 2 4\n".to_owned();
    let bulk =
        "DMIG,K,0,6,1,0\nDMIG,K,1,3,,1,3,1.5+6\nDMIG*   K              1\n*   2   3   1.0\n".to_owned();
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for round in 0..4000 {
        let source = [map.as_str(), &market, &bulk, OP4_DENSE, OP4_SPARSE][round % 5];
        let mut bytes = source.as_bytes().to_vec();
        for _ in 0..=next(4) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = b" 0123456789.-+*,$\nEe"[next(20)],
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"9- .\n"[next(5)]),
            }
        }
        let text = String::from_utf8(bytes).unwrap();
        let _ = (NodeMap::parse(&text).is_ok(), matrix_market(&text).is_ok(), read_op4(&text).is_ok());
        let _ = read_dmig(&text).is_ok_and(|all| Imported::from_dmig(&all, "K", None, "K").is_ok());
    }
}

#[test]
fn what_is_fitted_to_imported_matrices_is_what_is_fitted_to_the_beam() {
    let bare = model();
    let map = NodeMap::parse(&map_text()).unwrap();
    let sparse = |A: &Mat| Sparse::from_dense(&map_matrix(A, &map));
    let imported = Imported::from_row_order(&map, sparse(&bare.M), None, sparse(&bare.K));
    let mass = super::mass(-0.2, 3.0, 0.1);
    let fitted = AttachedMasses { masses: vec![mass], hub_inertia_kg_m2: 0.7 };
    let made = imported.with_fitted_masses(&map, &fitted).unwrap().structure(&map).unwrap();
    let (arm, pivot) = (-0.2 - map.position(map.pivot).unwrap(), bare.inertia_kg_m2());
    assert_close(made.mass_kg(), bare.mass_kg() + 3.0, 1e-12);
    assert_close(made.first_moment_kg_m(), bare.first_moment_kg_m() + 3.0 * arm, 1e-12);
    assert_close(made.inertia_kg_m2(), pivot + 3.0 * arm * arm + 0.1 + 0.7, 1e-12);
}
