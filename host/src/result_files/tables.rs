//! The tables of a result: its curves column by column, and its lists of objects row by row.
//!
//! Keys end in their units, and so do the columns. A table has the name of its place in the result.

use anyhow::Result;
use counterpoise_pipeline::exchange::SignalResult;
use serde_json::{Map, Value};

/// A single list of numbers of an object is a curve if it has more than so many; a shorter one (gains, delays) is in the MATLAB file alone.
const SHORTEST_LONE_CURVE: usize = 16;

/// Key of the gains of a path's limiter, one a state: a list of any length that is no curve.
const LIMITER_GAINS: &str = "anti_windup";

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultTable {
    /// Place in the result, for example `verify.histories.rest`.
    pub name: String,
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`; a cell is empty if its value does not exist.
    pub rows: Vec<Vec<String>>,
}

/// Passes every table of a result to `sink`, in the order of the keys.
///
/// # Errors
/// Those of `sink`, which end the walk.
pub(super) fn visit_tables(result: &Value, sink: &mut dyn FnMut(ResultTable) -> Result<()>) -> Result<()> {
    Walk { sink, units: LoopUnits::default() }.visit_value(result, "")
}

/// The walk through a result.
struct Walk<'a> {
    sink: &'a mut dyn FnMut(ResultTable) -> Result<()>,
    /// Units of the signals of the loop that the responses nearby belong to.
    units: LoopUnits,
}

/// Units of a loop; empty if they are not known.
#[derive(Debug, Clone, Default)]
struct LoopUnits {
    controlled: String,
    control: String,
    heave: String,
    pitch: String,
}

/// Keys of the matrices of a system, which are no curves.
const MATRICES: [&str; 4] = ["A", "B", "C", "D"];

impl Walk<'_> {
    fn visit_value(&mut self, value: &Value, place: &str) -> Result<()> {
        match value {
            Value::Object(object) => self.visit_object(object, place),
            Value::Array(list) => self.visit_list(list, place),
            _ => Ok(()),
        }
    }

    fn visit_object(&mut self, object: &Map<String, Value>, place: &str) -> Result<()> {
        if let Some(units) = LoopUnits::of(object) {
            self.units = units;
        }
        for table in curves_of(object, place) {
            (self.sink)(table)?;
        }
        if is_system(object) {
            return Ok(());
        }
        for (key, value) in object {
            self.visit_value(value, &join(place, key))?;
        }
        Ok(())
    }

    fn visit_list(&mut self, list: &[Value], place: &str) -> Result<()> {
        if let Some(table) = self.responses(list, place) {
            return (self.sink)(table);
        }
        for table in [rows_of(list, place), matrix_rows(list, place)].into_iter().flatten() {
            (self.sink)(table)?;
        }
        let inner = list.iter().enumerate().filter(|(_, value)| value.is_object() || value.is_array());
        for (k, value) in inner {
            self.visit_value(value, &join(place, &element_name(list, k)))?;
        }
        Ok(())
    }

    /// Returns frequency responses at the same frequencies as one table; `None` if the list holds anything else.
    fn responses(&self, list: &[Value], place: &str) -> Option<ResultTable> {
        let frequencies = list.first()?.get("frequency_hz")?.as_array()?;
        let mut columns = vec!["frequency_hz".to_owned()];
        let mut cells = vec![frequencies];
        for one in list {
            if one.get("frequency_hz")?.as_array()? != frequencies {
                return None;
            }
            let name = one.get("name")?.as_str()?;
            for part in ["real", "imaginary"] {
                let values = one.get(part)?.as_array()?;
                if values.len() != frequencies.len() {
                    return None;
                }
                columns.push(format!("{name}, {part}{}", self.response_unit(name)));
                cells.push(values);
            }
        }
        Some(ResultTable { name: place.to_owned(), rows: rows_of_columns(&cells), columns })
    }

    /// Returns the unit of a response in brackets: by the endings of both signals in `OUTPUT over INPUT`, where an output without one is the
    /// control, and by the loop nearby for a response that has a name of its own.
    fn response_unit(&self, name: &str) -> String {
        let units = &self.units;
        let (controlled, control) = (units.controlled.as_str(), units.control.as_str());
        let (heave, pitch) = (units.heave.as_str(), units.pitch.as_str());
        let ends = match name {
            "plant from control" => [controlled, control],
            "plant from heave" => [controlled, heave],
            "plant from pitch" => [controlled, pitch],
            "controller, feedback" => [control, controlled],
            "controller, heave feedforward" => [control, heave],
            "controller, pitch feedforward" => [control, pitch],
            _ if name.contains(" over platform, heave") => [controlled, heave],
            _ if name.contains(" over platform, pitch") => [controlled, pitch],
            _ => match name.split_once(" over ").map(|(output, input)| [output, input].map(unit_of)) {
                Some(["", input]) => ["V", input],
                Some(ends) => ends,
                None => ["", ""],
            },
        };
        match ends {
            [output, input] if output == input => " [1]".to_owned(),
            [output, input] => format!(" [({output})/({input})]"),
        }
    }
}

/// Returns whether an object is a linear system.
fn is_system(object: &Map<String, Value>) -> bool {
    MATRICES.iter().all(|key| object.contains_key(*key))
}

/// Returns the unit that the name of a signal ends in.
fn unit_of(signal: &str) -> &'static str {
    SignalResult::of(signal).unit
}

impl LoopUnits {
    /// Returns the units of the plant among the systems of an object; `None` if there is none.
    fn of(object: &Map<String, Value>) -> Option<Self> {
        let systems = object.get("systems")?.as_array()?;
        let plant = systems
            .iter()
            .find(|system| system.get("name").is_some_and(|name| name == "plant_with_sensors"))?;
        let unit =
            |signals: &str, k: usize| Some(plant.get(signals)?.get(k)?.get("unit")?.as_str()?.to_owned());
        Some(Self {
            controlled: unit("outputs", 0)?,
            control: unit("inputs", 0)?,
            heave: unit("inputs", 1)?,
            pitch: unit("inputs", 2)?,
        })
    }
}

/// Returns the place of a key within another place.
fn join(place: &str, key: &str) -> String {
    if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") }
}

/// Returns what an element of a list is called: its own name if it has one that no other element has, else its number, counted from 0.
fn element_name(list: &[Value], k: usize) -> String {
    let name = |value: &Value| value.get("name").and_then(Value::as_str).map(str::to_owned);
    let own = list.get(k).and_then(name).filter(|own| !own.is_empty());
    let is_alone = |own: &String| list.iter().filter_map(name).filter(|other| other == own).count() == 1;
    own.filter(is_alone).unwrap_or_else(|| k.to_string())
}

/// Returns the curves of an object: its lists of numbers, those of equal length in one table, over time or frequency if it has one.
fn curves_of(object: &Map<String, Value>, place: &str) -> Vec<ResultTable> {
    let is_curve = |list: &&Vec<Value>| list.len() > 1 && list.iter().all(|v| v.is_number() || v.is_null());
    let listed = object.iter().filter(|(key, _)| *key != LIMITER_GAINS);
    let curves: Vec<(&String, &Vec<Value>)> =
        listed.filter_map(|(key, value)| Some((key, value.as_array().filter(is_curve)?))).collect();
    let mut lengths: Vec<usize> = curves.iter().map(|(_, values)| values.len()).collect();
    lengths.sort_unstable();
    lengths.dedup();
    let number = |key: &str| object.get(key).and_then(Value::as_f64);
    let step_s = number("sample_time_s").filter(|step_s| *step_s > 0.0);
    let longest = lengths.last().copied();
    let table = |length: usize| {
        let mut own: Vec<(&String, &Vec<Value>)> =
            curves.iter().copied().filter(|(_, values)| values.len() == length).collect();
        if own.len() == 1 && step_s.is_none() && length <= SHORTEST_LONE_CURVE {
            return None;
        }
        own.sort_by_key(|(key, _)| !matches!(key.as_str(), "frequency_hz" | "time_s"));
        let values: Vec<&Vec<Value>> = own.iter().map(|(_, values)| *values).collect();
        let mut columns: Vec<String> = own.iter().map(|(key, _)| (*key).clone()).collect();
        let mut rows = rows_of_columns(&values);
        if let Some(step_s) = step_s {
            let start_s = number("start_s").unwrap_or(0.0);
            columns.insert(0, "time_s".to_owned());
            let time = |k: usize| number_cell(start_s + k as f64 * step_s);
            rows.iter_mut().enumerate().for_each(|(k, row)| row.insert(0, time(k)));
        } else if own.len() == 1 {
            columns.insert(0, "sample".to_owned());
            rows.iter_mut().enumerate().for_each(|(k, row)| row.insert(0, k.to_string()));
        }
        let of_length = if Some(length) == longest { String::new() } else { format!(".{length}") };
        Some(ResultTable { name: format!("{place}{of_length}"), columns, rows })
    };
    lengths.iter().rev().filter_map(|length| table(*length)).collect()
}

/// Returns a list of objects as a table of their numbers and texts, one row an object; `None` if it is none, or one of systems.
fn rows_of(list: &[Value], place: &str) -> Option<ResultTable> {
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<Vec<NamedCell>> = Vec::new();
    for value in list {
        let object = value.as_object().filter(|object| !is_system(object))?;
        let mut cells = Vec::new();
        flatten(object, "", &mut cells);
        let new = cells.iter().map(|cell| &cell.key).filter(|key| !columns.contains(key));
        let new: Vec<String> = new.cloned().collect();
        columns.extend(new);
        rows.push(cells);
    }
    let text = |row: &[NamedCell], column: &String| {
        row.iter().find(|cell| cell.key == *column).map_or_else(String::new, |cell| cell.text.clone())
    };
    let rows = rows.iter().map(|row| columns.iter().map(|column| text(row, column)).collect()).collect();
    (!columns.is_empty()).then(|| ResultTable { name: place.to_owned(), columns, rows })
}

/// A cell and the column that it belongs to.
struct NamedCell {
    key: String,
    text: String,
}

/// Adds the numbers, texts and truth values of an object and of the objects in it, with their keys.
fn flatten(object: &Map<String, Value>, within: &str, cells: &mut Vec<NamedCell>) {
    for (key, value) in object {
        let key = join(within, key);
        match value {
            Value::Object(inner) => flatten(inner, &key, cells),
            Value::Array(_) => {}
            scalar => cells.push(NamedCell { key, text: text_of(scalar) }),
        }
    }
}

/// Returns a number with all its digits; empty if it is not finite.
pub fn number_cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

/// Returns a list of rows of numbers, such as the points of a curve or complex numbers (real and imaginary part), as a table with the columns
/// `KEY.1`, `KEY.2` and so on; `None` if it is none.
fn matrix_rows(list: &[Value], place: &str) -> Option<ResultTable> {
    let rows: Vec<&Vec<Value>> = list.iter().map(Value::as_array).collect::<Option<_>>()?;
    let length = rows.first().map(|row| row.len()).filter(|length| *length > 0)?;
    let is_row = |row: &&Vec<Value>| row.len() == length && row.iter().all(|v| v.is_number() || v.is_null());
    let key = place.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(place);
    rows.iter().all(is_row).then(|| ResultTable {
        name: place.to_owned(),
        columns: (1..=length).map(|k| format!("{key}.{k}")).collect(),
        rows: rows.iter().map(|row| row.iter().map(text_of).collect()).collect(),
    })
}

fn rows_of_columns(columns: &[&Vec<Value>]) -> Vec<Vec<String>> {
    let length = columns.first().map_or(0, |column| column.len());
    (0..length).map(|k| columns.iter().map(|column| text_of(&column[k])).collect()).collect()
}

/// Returns a number with all its digits, a text, or a truth value; empty for a value that does not exist.
fn text_of(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::json;

    fn tables(result: &Value) -> Vec<ResultTable> {
        let mut all = Vec::new();
        visit_tables(result, &mut |table| {
            all.push(table);
            Ok(())
        })
        .unwrap();
        all
    }

    fn row(cells: &[&str]) -> Vec<String> {
        cells.iter().map(|cell| (*cell).to_owned()).collect()
    }

    #[test]
    fn a_history_has_its_time_and_leaves_empty_what_does_not_exist() {
        let found = tables(&json!({"histories": [
            {"name": "rest", "start_s": 1.0, "sample_time_s": 0.5, "hub_rad_s": [1.5, null, -2e-9], "contact": [0, 1, 0], "none": []}
        ]}));
        assert_eq!(found[0].name, "histories");
        assert_eq!(found[1].name, "histories.rest");
        assert_eq!(found[1].columns, ["time_s", "contact", "hub_rad_s"]);
        assert_eq!(
            found[1].rows,
            [row(&["1.0", "0", "1.5"]), row(&["1.5", "1", ""]), row(&["2.0", "0", "-2e-9"])]
        );
    }

    #[test]
    fn responses_at_the_same_frequencies_are_one_table_with_units() {
        let response = |name: &str| json!({"name": name, "frequency_hz": [1.0, 2.0], "real": [3.0, 4.0], "imaginary": [5.0, 6.0]});
        let plant = json!({"name": "plant_with_sensors", "inputs": [{"unit": "A"}, {"unit": "m/s^2"}, {"unit": "m/s"}], "outputs": [{"unit": "m"}]});
        let names =
            ["hub_rate_rad_s over control_v", "feedback over demand_rad_s", "loop", "plant from pitch"];
        let list: Vec<Value> = names.iter().map(|name| response(name)).collect();
        let found = tables(&json!({"verify": {"responses": list, "systems": [plant]}}));
        let units = ["(rad/s)/(V)", "(V)/(rad/s)", "1", "(m)/(m/s)"];
        let table = found.iter().find(|table| table.name == "verify.responses").unwrap();
        let expected = names.iter().zip(units).map(|(name, unit)| format!("{name}, real [{unit}]"));
        assert!(table.columns.iter().skip(1).step_by(2).cloned().eq(expected), "{:?}", table.columns);
        assert_eq!(table.rows[1][..3], row(&["2.0", "4.0", "6.0"]));
    }

    #[test]
    fn lists_of_objects_are_rows_and_other_frequencies_other_tables() {
        let found = tables(&json!({
            "front": [{"gain": 1.0, "figures": {"peak_db": 2}, "name": "a, \"b\""}, {"gain": null, "holds": true}],
            "responses": [{"name": "p", "frequency_hz": [1.0, 2.0], "real": [1.0, 2.0], "imaginary": [0.0, 0.0]},
                          {"name": "q", "frequency_hz": [1.0, 3.0], "real": [1.0, 2.0], "imaginary": [0.0, 0.0]}],
            "poles_rad_s": [[-1.0, 2.0], [-1.0, -2.0]], "gains": [1.0, 2.0]
        }));
        let names: Vec<&str> = found.iter().map(|table| table.name.as_str()).collect();
        assert_eq!(names, ["front", "poles_rad_s", "responses", "responses.p", "responses.q"]);
        assert_eq!(found[0].columns, ["figures.peak_db", "gain", "name", "holds"]);
        assert_eq!(found[0].rows, [row(&["2", "1.0", "a, \"b\"", ""]), row(&["", "", "", "true"])]);
        assert_eq!(found[1].columns, ["poles_rad_s.1", "poles_rad_s.2"]);
        assert_eq!(found[3].columns, ["frequency_hz", "imaginary", "real"]);
    }

    #[test]
    fn a_result_without_curves_has_no_table() {
        let limiter = json!({"sample_time_s": 0.001, "anti_windup": vec![1.0; 40]});
        for empty in
            [json!({}), json!({"a": 1, "b": [], "c": [[]], "d": [{}], "e": null}), json!([]), limiter]
        {
            assert_eq!(tables(&empty), []);
        }
    }
}
