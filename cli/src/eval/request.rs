//! What the key `frames` asks for.

use costate::kinematics::ReferenceFrame;
use costate::robot::{Robot, printable};
use serde_json::{Map, Value};

/// Most frames of a line.
const MOST: usize = 256;

/// The keys of a frame that are read.
const KEYS: [&str; 3] = ["name", "axes", "w"];

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
    /// Reads the value of `frames`: an array of names, or of objects with a `name`.
    pub fn parse_all(value: &Value, robot: &Robot) -> Result<Vec<Self>, String> {
        let values = value.as_array().ok_or("`frames` is not an array of names or objects")?;
        if values.len() > MOST {
            return Err(format!("`frames` has {} entries; ask for at most {MOST} in a line", values.len()));
        }
        let located =
            |(k, value)| Self::parse(value, robot).map_err(|error| format!("`frames[{k}]` {error}"));
        values.iter().enumerate().map(located).collect()
    }

    fn parse(value: &Value, robot: &Robot) -> Result<Self, String> {
        let nothing = Map::new();
        let (name, fields) = match value {
            Value::String(name) => (name.as_str(), &nothing),
            Value::Object(fields) => {
                let name = fields.get("name").ok_or("has no `name`; name the frame")?;
                (name.as_str().ok_or("has a `name` that is not a text")?, fields)
            }
            _ => return Err("is neither a name nor an object with a `name`".into()),
        };
        if let Some(key) = fields.keys().find(|key| !KEYS.iter().chain(&RESULTS).any(|known| known == key)) {
            let known = KEYS.map(|key| format!("`{key}`")).join(", ");
            return Err(format!("has the unknown key `{}` (the keys are {known})", printable(key)));
        }
        let frame = robot.frame_index(name).map_err(|error| format!("is not known: {error}"))?;
        let axes = match fields.get("axes") {
            None => AXES[0],
            Some(value) => {
                let named = AXES.into_iter().find(|(name, _)| value.as_str() == Some(name));
                named.ok_or("has `axes` other than \"aligned\", \"local\" and \"world\"")?
            }
        };
        Ok(Self { frame, name: name.to_owned(), axes, w: weights(fields)? })
    }
}

/// The three weights of `w_x_qq`.
fn weights(fields: &Map<String, Value>) -> Result<Option<[f64; 3]>, String> {
    let Some(value) = fields.get("w").filter(|value| !value.is_null()) else { return Ok(None) };
    let numbers: Option<Vec<f64>> =
        value.as_array().and_then(|values| values.iter().map(Value::as_f64).collect());
    let three = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    three.map(Some).ok_or_else(|| "has a `w` that is not an array of 3 numbers".into())
}
