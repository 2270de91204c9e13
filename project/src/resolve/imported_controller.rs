//! The `[synth.controller]` section: a feedback that was made elsewhere, read from JSON, MATLAB, HDF5 or NumPy files.
//!
//! A file holds the controller in one of three forms: state space (`A`, `B`, `C`, `D`), a transfer function (`num`, `den`, highest power
//! first), or zeros, poles and gain (`z`, `p`, `k`); and its sample time `Ts`, which is 0 in continuous time.

use std::collections::BTreeMap;
use std::sync::Arc;

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, TransferFunction, Zpk};
use counterpoise_recordings::{Remark, read_arrays};
use ndarray::Array2;
use serde_json::Value;

use crate::file::field::Field;
use crate::file::visit::Visit;

/// A feedback that was made elsewhere: from the error (demand less reading) to the control.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportedController {
    /// Name of the file.
    pub file: String,
    /// The name of the variable that holds the controller in the file; empty if nothing else in the file could be one.
    pub name: String,
    /// The controller; `None` if the file is not at hand.
    pub system: Option<Arc<StateSpace>>,
}

/// Largest order of a controller that is read: more states than any sampled controller runs with.
const MOST_STATES: usize = 200;

/// Reads or lists a controller that was made elsewhere.
pub(crate) fn imported_controller(v: &mut dyn Visit, controller: &mut ImportedController) {
    let meaning = "file of the controller, from the error to the control: JSON, .mat, .h5 or .npz, with A, B, C, D, or num and den, or z, p and k, and Ts (s; 0 if it is continuous)";
    v.text(&Field::new("file", meaning), &mut controller.file);
    let meaning =
        "what holds the controller in the file, as in `synth.controllers.feedback`; needed if several could";
    v.text(&Field::new("name", meaning).or_text(""), &mut controller.name);
    let Some(bytes) = v.attached_bytes(&controller.file) else { return };
    let read = bytes.and_then(|bytes| {
        parse_controller(&bytes, &controller.file, &controller.name)
            .map_err(|why| format!("\"{}\": {why}", controller.file))
    });
    match read {
        Ok(system) => controller.system = Some(Arc::new(system)),
        Err(why) => v.complain("file", &why, None),
    }
}

/// Returns the controller in a file, which has one input and one output.
///
/// # Errors
/// The problem with the file, in words.
pub fn parse_controller(bytes: &[u8], file: &str, name: &str) -> Result<StateSpace, String> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let is_json = bytes.iter().find(|byte| !byte.is_ascii_whitespace()).is_some_and(|byte| *byte == b'{');
    let content = if is_json { json_content(bytes)? } else { array_content(bytes, file)? };
    find_candidate(&content, name)?.system()
}

/// The contents of a file, by whole names.
#[derive(Default)]
struct Content {
    arrays: BTreeMap<String, Array2<f64>>,
    /// Why something that has a name is not read.
    unread: BTreeMap<String, String>,
}

fn array_content(bytes: &[u8], file: &str) -> Result<Content, String> {
    let (arrays, remarks) = read_arrays(bytes, file).map_err(|why| {
        format!("{why}; a controller is read from JSON, MATLAB (.mat), HDF5 and NumPy (.npz) files")
    })?;
    // a row is a vector, as MATLAB writes one: [-1 -2] is two real roots
    let as_column = |values: Array2<f64>| if values.nrows() == 1 { values.reversed_axes() } else { values };
    let unread = remarks.into_iter().filter_map(|remark| match remark {
        Remark::Unread { column, why } => Some((column, why.to_string())),
        _ => None,
    });
    Ok(Content {
        arrays: arrays.into_iter().map(|array| (array.name, as_column(array.values))).collect(),
        unread: unread.collect(),
    })
}

fn json_content(bytes: &[u8]) -> Result<Content, String> {
    let root: Value = serde_json::from_slice(bytes).map_err(|why| format!("it is not valid JSON: {why}"))?;
    let mut content = Content::default();
    collect_content(&root, "", &mut content);
    Ok(content)
}

/// Collects the numbers, vectors and matrices of a JSON value. The items of a list of objects are named by their `name`, else by their
/// places, counted from 1.
fn collect_content(value: &Value, path: &str, content: &mut Content) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    if let Some(array) = array_of(value) {
        content.arrays.insert(path.to_owned(), array);
        return;
    }
    match value {
        Value::Object(inside) => {
            inside.iter().for_each(|(key, value)| collect_content(value, &below(key), content));
        }
        Value::Array(items) if items.iter().all(Value::is_object) => {
            for (place, item) in items.iter().enumerate() {
                let own = item.get("name").and_then(Value::as_str).map(str::to_owned);
                collect_content(item, &below(&own.unwrap_or_else(|| (place + 1).to_string())), content);
            }
        }
        _ => {
            let why = "it is not a number, a list of numbers, or a list of equally long lists of numbers";
            content.unread.insert(path.to_owned(), why.to_owned());
        }
    }
}

/// Returns a number as 1 x 1, a list of numbers as a column, and a list of equally long lists as a matrix; `None` for anything else.
fn array_of(value: &Value) -> Option<Array2<f64>> {
    let Value::Array(items) = value else { return Some(Array2::from_elem((1, 1), value.as_f64()?)) };
    let rows: Vec<Vec<f64>> = items
        .iter()
        .map(|item| match item {
            Value::Array(row) => row.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>(),
            number => number.as_f64().map(|number| vec![number]),
        })
        .collect::<Option<_>>()?;
    let columns = rows.first().map_or(0, Vec::len);
    let values: Vec<f64> = rows.iter().filter(|row| row.len() == columns).flatten().copied().collect();
    Array2::from_shape_vec((rows.len(), columns), values).ok()
}

/// Something in a file that may be the controller: its arrays, and what is not read, by their own names.
#[derive(Default)]
struct CandidateArrays<'a> {
    arrays: BTreeMap<&'a str, &'a Array2<f64>>,
    unread: BTreeMap<&'a str, &'a str>,
}

/// The names of the parts of a controller, the usual name first.
const NAMES: [&[&str]; 10] = [
    &["A"],
    &["B"],
    &["C"],
    &["D"],
    &["num", "numerator"],
    &["den", "denominator"],
    &["z", "zeros"],
    &["p", "poles"],
    &["k", "gain"],
    &["Ts", "dt", "sample_time", "sample_time_s"],
];
const A: usize = 0;
const INPUT: usize = 1;
const OUTPUT: usize = 2;
const D: usize = 3;
const NUMERATOR: usize = 4;
const DENOMINATOR: usize = 5;
const ZEROS: usize = 6;
const POLES: usize = 7;
const GAIN: usize = 8;
const SAMPLE_TIME: usize = 9;

/// Name by which `name` calls the outermost keys of a file.
const OUTERMOST: &str = ".";

/// Returns what holds the controller: what is named, else the only thing in the file that can be one.
fn find_candidate<'a>(content: &'a Content, name: &str) -> Result<CandidateArrays<'a>, String> {
    let parted = |path: &'a str| path.rsplit_once('.').unwrap_or((OUTERMOST, path));
    let mut candidates: BTreeMap<&str, CandidateArrays<'a>> = BTreeMap::new();
    for (path, values) in &content.arrays {
        let (above, own) = parted(path);
        candidates.entry(above).or_default().arrays.insert(own, values);
    }
    for (path, why) in &content.unread {
        let (above, own) = parted(path);
        candidates.entry(above).or_default().unread.insert(own, why);
    }
    candidates.retain(|_, candidate| candidate.can_be_a_controller());
    let found: Vec<String> = candidates.keys().map(|name| format!("\"{name}\"")).collect();
    if let Some(named) = candidates.remove(name) {
        return Ok(named);
    }
    if !name.is_empty() {
        let known = if found.is_empty() { "nothing".to_owned() } else { found.join(", ") };
        return Err(format!("it holds no controller \"{name}\"; what could be one: {known}"));
    }
    match found.len() {
        0 => Err(
            "it holds no controller: it needs A, B, C, D, or num and den, or z, p and k (real numbers, or pairs of real and imaginary parts), and Ts".to_owned(),
        ),
        1 => candidates.into_values().next().ok_or_else(String::new),
        _ => Err(format!("it holds several controllers: say which by `name`, one of {}", found.join(", "))),
    }
}

impl CandidateArrays<'_> {
    fn part(&self, part: usize) -> Option<&Array2<f64>> {
        NAMES[part].iter().find_map(|name| self.arrays.get(name).copied())
    }

    /// Returns whether a part is there, be it readable or not.
    fn has(&self, part: usize) -> bool {
        NAMES[part].iter().any(|name| self.arrays.contains_key(name) || self.unread.contains_key(name))
    }

    fn can_be_a_controller(&self) -> bool {
        let has = |part| self.has(part);
        has(A) && has(INPUT) && has(OUTPUT)
            || has(D) && has(SAMPLE_TIME)
            || has(NUMERATOR) && has(DENOMINATOR)
            || has(GAIN) && (has(POLES) || has(SAMPLE_TIME))
    }

    fn system(&self) -> Result<StateSpace, String> {
        if let Some((name, why)) =
            self.unread.iter().find(|(name, _)| NAMES.iter().any(|all| all.contains(name)))
        {
            return Err(format!(
                "{name}: {why}; complex roots are written as rows of real and imaginary part"
            ));
        }
        let timebase = self.timebase()?;
        let [space, polynomials, roots] = [[A, D], [NUMERATOR, DENOMINATOR], [POLES, GAIN]]
            .map(|parts| parts.iter().any(|part| self.has(*part)));
        let system = match [space, polynomials, roots] {
            [true, false, false] => self.state_space(timebase)?,
            [false, true, false] => {
                let (numerator, denominator) = (self.numbers(NUMERATOR)?, self.numbers(DENOMINATOR)?);
                check_order(denominator.len().saturating_sub(1))?;
                let function = TransferFunction::new(&numerator, &denominator, timebase);
                function.and_then(|function| function.to_state_space()).map_err(|why| why.to_string())?
            }
            [false, false, true] => {
                let (zeros, poles, gain) = (self.roots(ZEROS)?, self.roots(POLES)?, self.number(GAIN)?);
                check_order(poles.len())?;
                Zpk { zeros, poles, gain, timebase }.to_state_space().map_err(|why| why.to_string())?
            }
            _ => {
                return Err("it states several of A, B, C, D; num and den; z, p and k: keep one of the three, or put each \
                     into a structure and say which by `name`"
                    .to_owned());
            }
        };
        if system.D[(0, 0)] == 0.0 && system.order() == 0 {
            return Err("the controller is zero".to_owned());
        }
        Ok(system)
    }

    fn timebase(&self) -> Result<Timebase, String> {
        let missing = "the sample time is missing: add Ts, in seconds; 0 for a controller in continuous time";
        self.part(SAMPLE_TIME).ok_or(missing)?;
        match self.number(SAMPLE_TIME)? {
            0.0 => Ok(Timebase::Continuous),
            period_s if period_s > 0.0 && period_s.is_finite() => Ok(Timebase::Discrete { period_s }),
            other => Err(format!("Ts = {other} must be 0 or a positive number of seconds")),
        }
    }

    fn state_space(&self, timebase: Timebase) -> Result<StateSpace, String> {
        let empty = Array2::zeros((0, 0));
        let states = self.part(A).unwrap_or(&empty);
        let (rows, columns) = states.dim();
        let order = if states.is_empty() { 0 } else { rows };
        if order > 0 && rows != columns {
            return Err(format!("A must be square; it has {rows} rows and {columns} columns"));
        }
        check_order(order)?;
        let matrix = Mat::from_fn(order, order, |i, j| states[(i, j)]);
        let [input, output, direct] = [(INPUT, order), (OUTPUT, order), (D, 1)].map(|(part, count)| {
            let (name, found) = (NAMES[part][0], self.part(part).map(row_major).unwrap_or_default());
            let given = if part == D && found.is_empty() { vec![0.0] } else { found };
            if given.len() == count {
                Ok(given)
            } else {
                Err(format!(
                    "{name} has {} numbers, but a controller of order {order} with one input, the error, and one output, the control, has {count}; \
                     a filter of the demand alone goes to [synth.prefilter]",
                    given.len()
                ))
            }
        });
        let system =
            StateSpace::new(matrix, Mat::col(&input?), Mat::row(&output?), Mat::row(&direct?), timebase);
        system.map_err(|why| why.to_string())
    }

    fn numbers(&self, part: usize) -> Result<Vec<f64>, String> {
        let array = self.part(part).ok_or_else(|| format!("{} is missing", NAMES[part][0]))?;
        match array.dim() {
            (rows, columns) if rows.min(columns) <= 1 => Ok(row_major(array)),
            (rows, columns) => Err(format!("{} must be a vector; it is {rows} x {columns}", NAMES[part][0])),
        }
    }

    fn number(&self, part: usize) -> Result<f64, String> {
        match self.numbers(part)?[..] {
            [number] => Ok(number),
            ref several => Err(format!("{} must be one number, not {}", NAMES[part][0], several.len())),
        }
    }

    /// Returns roots that are written as real numbers, or as rows of real and imaginary part.
    fn roots(&self, part: usize) -> Result<Vec<C64>, String> {
        match self.part(part) {
            None => Ok(Vec::new()),
            Some(pairs) if pairs.ncols() == 2 && pairs.nrows() > 0 => {
                Ok(pairs.rows().into_iter().map(|pair| C64::new(pair[0], pair[1])).collect())
            }
            Some(_) => Ok(self.numbers(part)?.into_iter().map(|root| C64::new(root, 0.0)).collect()),
        }
    }
}

/// Returns the numbers of an array row by row.
fn row_major(array: &Array2<f64>) -> Vec<f64> {
    array.iter().copied().collect()
}

fn check_order(order: usize) -> Result<(), String> {
    if order <= MOST_STATES {
        return Ok(());
    }
    Err(format!("the controller is of order {order}; at most {MOST_STATES} states are read"))
}
