//! The keys of an input line: unknown and duplicate keys are errors.

use super::entries::Entries;
use costate::robot::printable;
use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use serde_json::error::Category;

/// The keys that are read.
const KEYS: [&str; 6] = ["q", "v", "p", "u", "y", "frames"];

/// The keys of output lines, ignored so that a result line can serve as an input line.
const RESULTS: [&str; 8] = ["M", "energy", "f", "f_x", "y_f_xx", "qdd", "qdd_z", "yv_qdd_zz"];

/// Most keys of a line: all of them, some twice.
const MOST_FIELDS: usize = 32;

const TOO_MANY: &str = "too many keys";

/// Common names of other programs.
const SYNONYMS: [(&str, &[&str]); 6] = [
    ("q", &["position", "positions", "pos", "angle", "angles", "theta", "joint_positions"]),
    ("v", &["velocity", "velocities", "vel", "qd", "dq", "qdot", "q_dot", "qvel", "rate", "rates"]),
    ("p", &["momentum", "momenta", "mom"]),
    ("u", &["tau", "torque", "torques", "effort", "force", "forces", "control", "ctrl", "input"]),
    ("y", &["costate", "lambda", "lam", "adjoint", "weights"]),
    ("frames", &["frame", "link", "links", "pose", "poses", "tool", "tools"]),
];

/// The fields of a JSON object in their order; keys are unique and known.
pub struct Fields {
    values: Vec<(String, Value)>,
    /// The value of the key `frames`.
    pub frames: Entries,
}

impl Fields {
    /// The value under any other key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.values.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }
}

/// Reads the JSON object of a line.
///
/// # Errors
/// A message with the column of a syntax error, or the first unknown or duplicate key.
pub fn parse(line: &[u8]) -> Result<Fields, String> {
    let fields = serde_json::from_slice::<Fields>(line).map_err(|error| malformed(line, &error))?;
    for (k, (key, _)) in fields.values.iter().enumerate() {
        if !KEYS.contains(&key.as_str()) && !RESULTS.contains(&key.as_str()) {
            let (name, known) = (printable(key), KEYS.map(|key| format!("`{key}`")).join(", "));
            let meant = nearest(key).map_or_else(String::new, |key| format!(", did you mean `{key}`?"));
            return Err(format!("unknown key `{name}`{meant} (the keys are {known})"));
        }
        if fields.values[..k].iter().any(|(earlier, _)| earlier == key) {
            return Err(format!("`{key}` is given twice; remove one of them"));
        }
    }
    Ok(fields)
}

/// What is wrong with the syntax, in terms of the line.
fn malformed(line: &[u8], error: &serde_json::Error) -> String {
    let column = error.column();
    let example = r#"write {"q":[...],"p":[...]}"#;
    if let Err(error) = std::str::from_utf8(line) {
        return format!("column {}: not JSON, which must be UTF-8 text", error.valid_up_to() + 1);
    }
    let whole = error.to_string();
    let reason = whole.split(" at line ").next().unwrap_or(&whole);
    match error.classify() {
        Category::Eof => format!("not JSON: the line ends too early; {example}"),
        Category::Data if reason == TOO_MANY => format!("more than {MOST_FIELDS} keys; remove some"),
        Category::Data => format!("not a JSON object; {example}"),
        _ if column > 0 && line.get(column - 1..).is_some_and(is_not_finite) => {
            format!("column {column}: not JSON, which has no NaN and no infinity; give finite numbers")
        }
        _ if reason.contains("out of range") => {
            format!("column {column}: not JSON: the number is too large; give finite numbers")
        }
        _ => format!("column {column}: not JSON: {reason}; {example}"),
    }
}

/// Whether the text starts with a number of other languages that is not finite.
fn is_not_finite(text: &[u8]) -> bool {
    let starts = |word: &str| text.get(..word.len()).is_some_and(|t| t.eq_ignore_ascii_case(word.as_bytes()));
    ["nan", "inf", "an", "nf", "-inf", "-nan"].into_iter().any(starts)
}

/// The key that was probably meant: by its other names, or by a character or two more.
fn nearest(key: &str) -> Option<&'static str> {
    let lower = key.to_lowercase();
    let is_synonym =
        |names: &[&str]| names.iter().any(|name| lower.contains(name) && name.len() > 2 || lower == *name);
    let synonym = SYNONYMS.iter().find(|(_, names)| is_synonym(names)).map(|(known, _)| *known);
    let is_close = |known: &&str| lower.starts_with(known) && lower.chars().count() <= 3;
    synonym.or_else(|| KEYS.into_iter().find(is_close))
}

impl<'de> Deserialize<'de> for Fields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Object;
        impl<'de> Visitor<'de> for Object {
            type Value = Fields;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Fields, A::Error> {
                let mut fields = Fields { values: Vec::new(), frames: Entries::Null };
                while let Some(key) = map.next_key::<String>()? {
                    if fields.values.len() == MOST_FIELDS {
                        return Err(A::Error::custom(TOO_MANY));
                    }
                    // The others are not kept, large as they may be.
                    let mut value = Value::Null;
                    if key == "frames" {
                        fields.frames = map.next_value()?;
                    } else if KEYS.contains(&key.as_str()) {
                        value = map.next_value()?;
                    } else {
                        map.next_value::<IgnoredAny>()?;
                    }
                    fields.values.push((key, value));
                }
                Ok(fields)
            }
        }
        deserializer.deserialize_map(Object)
    }
}

#[cfg(test)]
mod tests {
    use super::{nearest, parse};

    #[test]
    fn the_nearest_key_is_found_by_synonyms_and_if_it_is_close() {
        for (key, known) in
            [("tau", "u"), ("Q", "q"), ("qdot", "v"), ("joint_velocity", "v"), ("lambda", "y"), ("yy", "y")]
        {
            assert_eq!(nearest(key), Some(known), "{key}");
        }
        assert_eq!(["error", "line", "x", ""].map(nearest), [None; 4]);
    }

    #[test]
    fn messages_name_the_column_and_no_line_of_their_own() {
        for (line, reason) in [
            (&br#"{"q":[1],}"#[..], "column 10: not JSON"),
            (br#"{"q":[NaN]}"#, "column 7: not JSON, which has no NaN"),
            (br#"{"q":[-Infinity]}"#, "no infinity"),
            (br#"{"q":[1e999]}"#, "too large"),
            (br#"{"q":[1"#, "ends too early"),
            (b"[1, 2]", "not a JSON object"),
            (b"{\"q\xff\":1}", "column 4: not JSON, which must be UTF-8"),
            (br#"{"q":[1],"q":[2]}"#, "`q` is given twice"),
            (format!("{{{}\"q\":[1]}}", "\"f\":1,".repeat(50)).as_bytes(), "more than 32 keys"),
            (br#"{"q":[1],"tau":[2]}"#, "unknown key `tau`, did you mean `u`?"),
        ] {
            let message = parse(line).err().unwrap();
            assert!(message.contains(reason) && !message.contains("line 1"), "{message}");
        }
    }
}
