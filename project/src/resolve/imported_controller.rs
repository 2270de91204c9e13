//! The `[synth.controller]` section: a feedback that was made elsewhere, read from JSON, MATLAB, HDF5 or NumPy files.
//!
//! A file holds the controller in one of three forms: state space (`A`, `B`, `C`, `D`), a transfer function (`num`, `den`, highest power
//! first), or zeros, poles and gain (`z`, `p`, `k`); and its sample time `Ts`, which is 0 in continuous time.

use std::collections::BTreeMap;
use std::sync::Arc;

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, TransferFunction, Zpk};
use counterpoise_recordings::read_arrays;
use ndarray::Array2;
use serde_json::Value;

use crate::file::field::Field;
use crate::file::visit::Visit;

/// A feedback that was made elsewhere: from the error (demand less reading) to the control.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportedController {
    /// Name of the file.
    pub file: String,
    /// What holds the controller in the file; empty if nothing else in the file could be one.
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
/// What is wrong with the file, in words.
pub fn parse_controller(bytes: &[u8], file: &str, name: &str) -> Result<StateSpace, String> {
    let is_json = bytes.iter().find(|byte| !byte.is_ascii_whitespace()).is_some_and(|byte| *byte == b'{');
    let arrays = if is_json { json_arrays(bytes)? } else { file_arrays(bytes, file)? };
    holder(&arrays, name)?.system()
}

/// Arrays by their whole names.
type Arrays = BTreeMap<String, Array2<f64>>;

fn file_arrays(bytes: &[u8], file: &str) -> Result<Arrays, String> {
    let arrays = read_arrays(bytes, file).map_err(|why| {
        format!("{why}; a controller is read from JSON, MATLAB (.mat), HDF5 and NumPy (.npz) files")
    })?;
    // a row is a vector, as MATLAB writes one: [-1 -2] is two real roots
    let upright = |values: Array2<f64>| if values.nrows() == 1 { values.reversed_axes() } else { values };
    Ok(arrays.into_iter().map(|array| (array.name, upright(array.values))).collect())
}

fn json_arrays(bytes: &[u8]) -> Result<Arrays, String> {
    let root: Value = serde_json::from_slice(bytes).map_err(|why| format!("it is no JSON: {why}"))?;
    let mut arrays = Arrays::new();
    collect_arrays(&root, "", &mut arrays);
    Ok(arrays)
}

/// Collects the numbers, vectors and matrices of a JSON value. The items of a list of objects are named by their `name`, else by their
/// places, counted from 1.
fn collect_arrays(value: &Value, path: &str, arrays: &mut Arrays) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    if let Some(array) = array_of(value) {
        arrays.insert(path.to_owned(), array);
        return;
    }
    match value {
        Value::Object(inside) => {
            inside.iter().for_each(|(key, value)| collect_arrays(value, &below(key), arrays));
        }
        Value::Array(items) => {
            for (place, item) in items.iter().enumerate().filter(|(_, item)| item.is_object()) {
                let own = item.get("name").and_then(Value::as_str).map(str::to_owned);
                collect_arrays(item, &below(&own.unwrap_or_else(|| (place + 1).to_string())), arrays);
            }
        }
        _ => {}
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

/// One of the things in a file that may be the controller: its arrays by their own names.
struct Holder<'a> {
    arrays: BTreeMap<String, &'a Array2<f64>>,
}

/// What the parts of a controller may be called, the usual name first.
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

/// Returns what holds the controller: what is named, else the only thing in the file that can be one.
fn holder<'a>(arrays: &'a Arrays, name: &str) -> Result<Holder<'a>, String> {
    let mut holders: BTreeMap<&str, Holder<'a>> = BTreeMap::new();
    for (path, values) in arrays {
        let (above, own) = path.rsplit_once('.').unwrap_or(("", path));
        let holder = holders.entry(above).or_insert_with(|| Holder { arrays: BTreeMap::new() });
        holder.arrays.insert(own.to_owned(), values);
    }
    holders.retain(|_, holder| holder.can_be_a_controller());
    let found: Vec<String> = holders.keys().map(|name| format!("\"{name}\"")).collect();
    if let Some(named) = holders.remove(name) {
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
        1 => holders.into_values().next().ok_or_else(String::new),
        _ => Err(format!("it holds several controllers: say which by `name`, one of {}", found.join(", "))),
    }
}

impl Holder<'_> {
    fn part(&self, part: usize) -> Option<&Array2<f64>> {
        NAMES[part].iter().find_map(|name| self.arrays.get(*name).copied())
    }

    fn can_be_a_controller(&self) -> bool {
        let has = |part| self.part(part).is_some();
        has(A) && has(INPUT) && has(OUTPUT)
            || has(D) && has(SAMPLE_TIME)
            || has(NUMERATOR) && has(DENOMINATOR)
            || has(GAIN) && (has(POLES) || has(SAMPLE_TIME))
    }

    fn system(&self) -> Result<StateSpace, String> {
        let timebase = self.timebase()?;
        let system = if self.part(A).is_some() || self.part(D).is_some() {
            self.state_space(timebase)
        } else if self.part(GAIN).is_some() {
            let (zeros, poles, gain) = (self.roots(ZEROS)?, self.roots(POLES)?, self.number(GAIN)?);
            check_order(poles.len())?;
            Zpk { zeros, poles, gain, timebase }.to_state_space().map_err(|why| why.to_string())
        } else {
            let (numerator, denominator) = (self.numbers(NUMERATOR)?, self.numbers(DENOMINATOR)?);
            check_order(denominator.len().saturating_sub(1))?;
            let function = TransferFunction::new(&numerator, &denominator, timebase);
            function.and_then(|function| function.to_state_space()).map_err(|why| why.to_string())
        }?;
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
            let (name, found) = (NAMES[part][0], self.part(part).map(flat).unwrap_or_default());
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
            (rows, columns) if rows.min(columns) <= 1 => Ok(flat(array)),
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
fn flat(array: &Array2<f64>) -> Vec<f64> {
    array.iter().copied().collect()
}

fn check_order(order: usize) -> Result<(), String> {
    if order <= MOST_STATES {
        return Ok(());
    }
    Err(format!("the controller is of order {order}; at most {MOST_STATES} states are read"))
}
