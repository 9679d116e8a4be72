//! The JSON schema of the vehicle file, with which editors complete and check it.
//!
//! It contains names, types and possible ranges. What relates several numbers to each other is
//! found by [`Vehicle::check`](crate::Vehicle::check) only.

use serde_json::{Map, Value, json};

use super::tree;
use crate::check::{Key, Kind, Range};

/// The JSON schema (draft 2020-12), with one line feed at its end.
pub fn schema() -> String {
    let mut root = table("");
    root.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    root.insert("title".to_owned(), json!("Vehicle file of cg-height"));
    format!("{:#}\n", Value::Object(root))
}

/// The schema of the table at a path.
fn table(path: &str) -> Map<String, Value> {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for key in tree::keys(path) {
        properties.insert(key.name.to_owned(), value(key));
        if key.required {
            required.push(key.name);
        }
    }
    for step in tree::inner(path) {
        let inner = tree::within(path, step);
        let name = step.trim_end_matches("[i]");
        let entry = table(&inner);
        let of_list = step != name;
        let schema = if of_list { json!({"type": "array", "items": entry}) } else { json!(entry) };
        properties.insert(name.to_owned(), schema);
        if tree::is_required(&inner) {
            required.push(name);
        }
    }
    let mut schema = Map::new();
    if !tree::meaning(path).is_empty() {
        schema.insert("description".to_owned(), json!(tree::meaning(path)));
    }
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("properties".to_owned(), Value::Object(properties));
    schema.insert("required".to_owned(), json!(required));
    schema.insert("additionalProperties".to_owned(), json!(false));
    schema
}

fn value(key: &Key) -> Value {
    let number = |range: Range| {
        let [least, greatest] = range.possible;
        json!({"type": "number", "minimum": least, "maximum": greatest})
    };
    let list = |items: Value| json!({"type": "array", "items": items});
    let mut schema = match key.kind {
        Kind::Text => json!({"type": "string", "minLength": 1}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Whole => json!({"type": "integer", "minimum": 0}),
        Kind::Number(range) => number(range),
        Kind::Numbers(range) => list(number(range)),
        Kind::Rows(range) => list(list(number(range))),
    };
    let usual = key.range().map(|range| format!(" (usual: {})", range.usual_in(key.unit)));
    schema["description"] = json!(format!("{}{}", key.meaning, usual.unwrap_or_default()));
    schema
}
