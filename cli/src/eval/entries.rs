//! The value of `frames` as it was written: objects keep keys that are given twice.

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

/// The value of the key `frames`.
pub enum Entries {
    /// It is null, which is as if it was absent.
    Null,
    /// The entries that are kept, and the number of all.
    Array(Vec<Entry>, usize),
    /// It is anything else.
    Other,
}

/// An entry of the array.
pub enum Entry {
    /// A text.
    Text(String),
    /// The keys of an object in their order, with the values of those that are read.
    Object(Vec<(String, Value)>),
    /// Anything else.
    Other,
}

/// Most frames of a line.
pub const MOST: usize = 256;

/// The keys of a frame that are read.
pub const KEYS: [&str; 3] = ["name", "axes", "w"];

/// Most keys of an object that are kept: all that are known, some twice.
const MOST_FIELDS: usize = 16;

/// Both values are read by the same visitor; what is no array or object means nothing to either.
trait Read<'de>: Sized {
    const OTHER: Self;

    fn null() -> Self {
        Self::OTHER
    }

    fn text(_: &str) -> Self {
        Self::OTHER
    }

    fn array<A: SeqAccess<'de>>(mut array: A) -> Result<Self, A::Error> {
        while array.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Self::OTHER)
    }

    fn object<A: MapAccess<'de>>(mut object: A) -> Result<Self, A::Error> {
        while object.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Self::OTHER)
    }
}

impl<'de> Read<'de> for Entries {
    const OTHER: Self = Self::Other;

    fn null() -> Self {
        Self::Null
    }

    fn array<A: SeqAccess<'de>>(mut array: A) -> Result<Self, A::Error> {
        let (mut entries, mut count) = (Vec::new(), 0);
        while count < MOST
            && let Some(entry) = array.next_element()?
        {
            entries.push(entry);
            count += 1;
        }
        while array.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        Ok(Self::Array(entries, count))
    }
}

impl<'de> Read<'de> for Entry {
    const OTHER: Self = Self::Other;

    fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    fn object<A: MapAccess<'de>>(mut object: A) -> Result<Self, A::Error> {
        let mut fields = Vec::new();
        while let Some(key) = object.next_key::<String>()? {
            // The others are not kept, large as they may be.
            let value = if fields.len() < MOST_FIELDS && KEYS.contains(&key.as_str()) {
                object.next_value()?
            } else {
                object.next_value::<IgnoredAny>()?;
                Value::Null
            };
            if fields.len() < MOST_FIELDS {
                fields.push((key, value));
            }
        }
        Ok(Self::Object(fields))
    }
}

struct Any<T>(std::marker::PhantomData<T>);

impl<'de, T: Read<'de>> Visitor<'de> for Any<T> {
    type Value = T;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<T, E> {
        Ok(T::null())
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<T, E> {
        Ok(T::OTHER)
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<T, E> {
        Ok(T::OTHER)
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<T, E> {
        Ok(T::OTHER)
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<T, E> {
        Ok(T::OTHER)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        Ok(T::text(text))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, array: A) -> Result<T, A::Error> {
        T::array(array)
    }

    fn visit_map<A: MapAccess<'de>>(self, object: A) -> Result<T, A::Error> {
        T::object(object)
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Any(std::marker::PhantomData))
    }
}

impl<'de> Deserialize<'de> for Entry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Any(std::marker::PhantomData))
    }
}
