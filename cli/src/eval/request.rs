//! What the key `frames` asks for.

use super::entries::{Entries, Entry, KEYS, MOST};
use costate::kinematics::ReferenceFrame;
use costate::robot::{Robot, printable};
use serde_json::Value;

/// The keys of its answer, ignored so that a result line can serve as an input line.
const RESULTS: [&str; 4] = ["position", "rotation", "jacobian", "w_x_qq"];

/// The conventions by their names.
const AXES: [(&str, ReferenceFrame); 3] = [
    ("aligned", ReferenceFrame::LocalWorldAligned),
    ("local", ReferenceFrame::Local),
    ("world", ReferenceFrame::World),
];

/// What is asked of one frame.
pub struct Request {
    pub frame: usize,
    pub name: String,
    pub axes: (&'static str, ReferenceFrame),
    pub w: Option<[f64; 3]>,
}

impl Request {
    /// Reads the value of `frames`: an array of names, or of objects with a `name`; `None` for null.
    pub fn parse_all(value: &Entries, robot: &Robot) -> Result<Option<Vec<Self>>, String> {
        let entries = match value {
            Entries::Null => return Ok(None),
            Entries::Other => return Err("`frames` is not an array of names or objects".into()),
            Entries::Array(_, count) if *count > MOST => {
                return Err(format!("`frames` has {count} entries; ask for at most {MOST} in a line"));
            }
            Entries::Array(entries, _) => entries,
        };
        let located =
            |(k, entry)| Self::parse(entry, robot).map_err(|error| format!("`frames[{k}]` {error}"));
        entries.iter().enumerate().map(located).collect::<Result<_, _>>().map(Some)
    }

    fn parse(entry: &Entry, robot: &Robot) -> Result<Self, String> {
        let fields = match entry {
            Entry::Text(_) => &[][..],
            Entry::Object(fields) => fields,
            Entry::Other => return Err("is neither a name nor an object with a `name`".into()),
        };
        for (k, (key, _)) in fields.iter().enumerate() {
            if !KEYS.iter().chain(&RESULTS).any(|known| known == key) {
                let known = KEYS.map(|key| format!("`{key}`")).join(", ");
                return Err(format!("has the unknown key `{}` (the keys are {known})", printable(key)));
            }
            if fields[..k].iter().any(|(earlier, _)| earlier == key) {
                return Err(format!("has `{key}` twice; remove one of them"));
            }
        }
        let get = |key: &str| fields.iter().find(|(name, _)| name == key).map(|(_, value)| value);
        let name = match entry {
            Entry::Text(name) => name,
            _ => {
                let name = get("name").ok_or("has no `name`; name the frame")?;
                name.as_str().ok_or("has a `name` that is not a text")?
            }
        };
        let frame = robot.frame_index(name).map_err(|error| format!("is not known: {error}"))?;
        let axes = match get("axes") {
            None => AXES[0],
            Some(value) => {
                let named = AXES.into_iter().find(|(name, _)| value.as_str() == Some(name));
                named.ok_or("has `axes` other than \"aligned\", \"local\" and \"world\"")?
            }
        };
        Ok(Self { frame, name: name.to_owned(), axes, w: weights(get("w"))? })
    }
}

/// The three weights of `w_x_qq`.
fn weights(value: Option<&Value>) -> Result<Option<[f64; 3]>, String> {
    let Some(value) = value.filter(|value| !value.is_null()) else { return Ok(None) };
    let numbers: Option<Vec<f64>> =
        value.as_array().and_then(|values| values.iter().map(Value::as_f64).collect());
    let three = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    three.map(Some).ok_or_else(|| "has a `w` that is not an array of 3 numbers".into())
}
