//! JSON Schema of results: made of example results, and the check of a result against it.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

/// Name and version of the schema.
pub const SCHEMA: &str = "counterpoise.results/2";

/// Keys of results that not every project has; every other key at the top of an example is always there.
const OPTIONAL: &[(&str, &[&str])] =
    &[("model", &["frictions", "structure"]), ("verify", &["robust_to_times_the_ranges"])];

/// Returns the published schema: the definitions of all results, made of one example each. `is_name` tells keys that are names.
pub fn published_schema(examples: &[(&str, Value)], is_name: &dyn Fn(&str) -> bool) -> Value {
    let definition = |(name, value): &(&str, Value)| {
        let optional = OPTIONAL.iter().find(|(of, _)| of == name).map_or(&[][..], |(_, keys)| keys);
        let mut made = of_values(&[value], is_name);
        let keys =
            value.as_object().map(|all| all.keys().cloned().collect::<BTreeSet<_>>()).unwrap_or_default();
        let required: Vec<String> =
            keys.into_iter().filter(|key| !optional.contains(&key.as_str())).collect();
        made["type"] = json!("object");
        made["required"] = json!(required);
        made["properties"]["schema"] = json!({"const": SCHEMA});
        ((*name).to_owned(), made)
    };
    let definitions: Map<String, Value> = examples.iter().map(definition).collect();
    let any: Vec<Value> = definitions.keys().map(|name| json!({"$ref": format!("#/$defs/{name}")})).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": SCHEMA,
        "title": "Results of counterpoise --json",
        "$comment": "A key may be null where its value does not exist; keys that are not listed may be added without a new version.",
        "anyOf": any,
        "$defs": definitions,
    })
}

/// Returns the schema that all values satisfy.
fn of_values(values: &[&Value], is_name: &dyn Fn(&str) -> bool) -> Value {
    let kinds: BTreeSet<&str> =
        values.iter().map(|value| kind(value)).filter(|kind| *kind != "null").collect();
    if kinds.is_empty() {
        return json!({});
    }
    let mut all: Vec<&str> = kinds.iter().copied().collect();
    all.push("null");
    let mut made = json!({"type": all});
    if kinds.contains("array") {
        let items: Vec<&Value> = values.iter().filter_map(|value| value.as_array()).flatten().collect();
        made["items"] = of_values(&items, is_name);
    }
    if kinds.contains("object") {
        let objects: Vec<&Map<String, Value>> = values.iter().filter_map(|value| value.as_object()).collect();
        of_objects(&objects, is_name, &mut made);
    }
    made
}

/// Adds the keys of objects to a schema: names share one schema, every other key has its own.
fn of_objects(objects: &[&Map<String, Value>], is_name: &dyn Fn(&str) -> bool, made: &mut Value) {
    let mut keys: BTreeMap<&str, Vec<&Value>> = BTreeMap::new();
    for (key, value) in objects.iter().flat_map(|object| object.iter()) {
        keys.entry(key).or_default().push(value);
    }
    let named: Vec<&Value> =
        keys.iter().filter(|(key, _)| is_name(key)).flat_map(|(_, values)| values.clone()).collect();
    if !named.is_empty() {
        made["additionalProperties"] = of_values(&named, is_name);
    }
    let properties: Map<String, Value> = keys
        .iter()
        .filter(|(key, _)| !is_name(key))
        .map(|(key, values)| ((*key).to_owned(), of_values(values, is_name)))
        .collect();
    if !properties.is_empty() {
        made["properties"] = Value::Object(properties);
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

/// Returns everything in a value that its schema does not allow, with its place.
pub fn violations(schema: &Value, value: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let kinds = schema["type"].as_array().cloned().unwrap_or_else(|| vec![schema["type"].clone()]);
    if !schema["type"].is_null() && !kinds.contains(&json!(kind(value))) {
        found.push(format!("{place} is {}, not {kinds:?}", kind(value)));
    }
    if schema.get("const").is_some_and(|wanted| wanted != value) {
        found.push(format!("{place} is {value}, not {}", schema["const"]));
    }
    if let Some(all) = value.as_array() {
        let items = all.iter().enumerate();
        found
            .extend(items.flat_map(|(k, item)| violations(&schema["items"], item, &format!("{place}[{k}]"))));
    }
    if let Some(all) = value.as_object() {
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        let missing = required.filter(|key| !all.contains_key(*key));
        found.extend(missing.map(|key| format!("{place}.{key} is missing")));
        for (key, inner) in all {
            let own = schema["properties"].get(key).unwrap_or(&schema["additionalProperties"]);
            found.extend(violations(own, inner, &format!("{place}.{key}")));
        }
    }
    found
}
