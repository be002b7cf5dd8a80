//! Tables whose keys are names of joints, and lists of tables.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::table::{Table, describe, number};
use toml::de::DeValue;

impl<'d> Table<'d> {
    /// Whether a key is there and holds a table.
    pub fn has_table(&self, name: &str) -> bool {
        matches!(self.values.get(name).map(|value| value.get_ref()), Some(DeValue::Table(_)))
    }

    /// Whether a key is there.
    pub fn has(&self, name: &str) -> bool {
        self.values.get(name).is_some()
    }

    /// Whether a key is there and holds a list.
    pub fn has_list(&self, name: &str) -> bool {
        matches!(self.values.get(name).map(|value| value.get_ref()), Some(DeValue::Array(_)))
    }

    /// Whether a key is there and is no empty list.
    pub fn holds(&self, name: &str) -> bool {
        match self.values.get(name).map(|value| value.get_ref()) {
            Some(DeValue::Array(entries)) => !entries.is_empty(),
            value => value.is_some(),
        }
    }

    /// Whether a key is there and holds a string.
    pub fn has_string(&self, name: &str) -> bool {
        matches!(self.values.get(name).map(|value| value.get_ref()), Some(DeValue::String(_)))
    }

    /// A table called `name`, or the entry of this number of a list of tables.
    pub fn inner(&self, name: &str, number: usize) -> Option<Table<'d>> {
        let (values, start) = match self.values.get(name)?.get_ref() {
            DeValue::Table(values) => (values, self.start_of(name)),
            DeValue::Array(entries) => {
                let entry = entries.get(number)?;
                let DeValue::Table(values) = entry.get_ref() else { return None };
                (values, Some(entry.span().start))
            }
            _ => return None,
        };
        Some(Table { text: self.text, path: Some(self.key(name)), start, values })
    }

    /// A table called `name` whose keys are any names: numbers.
    pub fn numbers_by_name(&self, name: &'static str) -> Result<Vec<(String, f64)>, Fault> {
        let Some(table) = self.table(name)? else { return Ok(Vec::new()) };
        let wrong = |key: &str, found: &DeValue<'_>| {
            let cause = ProblemFileCause::WrongType { expected: "a number", found: describe(found) };
            Err(table.fault(key, cause))
        };
        let entry =
            |(key, value): (&toml::Spanned<std::borrow::Cow<'_, str>>, &toml::Spanned<DeValue<'_>>)| {
                match number(value.get_ref()) {
                    Some(number) => Ok((key.get_ref().to_string(), number)),
                    None => wrong(key.get_ref(), value.get_ref()),
                }
            };
        table.values.iter().map(entry).collect()
    }

    /// A table called `name` whose keys are any names: tables with these keys.
    pub fn tables_by_name(
        &self,
        name: &'static str,
        known: &'static [&'static str],
    ) -> Result<Vec<(String, Table<'d>)>, Fault> {
        let Some(table) = self.table(name)? else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for (key, value) in table.values {
            let DeValue::Table(values) = value.get_ref() else {
                let cause =
                    ProblemFileCause::WrongType { expected: "a table", found: describe(value.get_ref()) };
                return Err(table.fault(key.get_ref(), cause));
            };
            let start = table.start_of(key.get_ref());
            let path = Some(table.key(key.get_ref()));
            let inner = Table { text: self.text, path, start, values };
            inner.only(known)?;
            found.push((key.get_ref().to_string(), inner));
        }
        Ok(found)
    }

    /// The tables `[[name]]`, or the one table `name`, with these keys.
    pub fn tables(
        &self,
        name: &'static str,
        known: &'static [&'static str],
    ) -> Result<Vec<Table<'d>>, Fault> {
        let Some(DeValue::Array(entries)) = self.values.get(name).map(|value| value.get_ref()) else {
            let table = self.table(name)?;
            return table.into_iter().map(|table| table.only(known).map(|()| table)).collect();
        };
        let path = self.key(name);
        let mut found = Vec::new();
        for entry in entries {
            let DeValue::Table(values) = entry.get_ref() else {
                let cause =
                    ProblemFileCause::WrongType { expected: "tables", found: describe(entry.get_ref()) };
                return Err(self.fault(name, cause));
            };
            let start = Some(entry.span().start);
            let table = Table { text: self.text, path: Some(path.clone()), start, values };
            table.only(known)?;
            found.push(table);
        }
        Ok(found)
    }

    /// The kind of a table, which must have no other keys than those of this kind.
    pub fn kind(&self, kinds: &[(&'static str, &'static [&'static str])]) -> Result<&'static str, Fault> {
        let choices: Vec<_> = kinds.iter().map(|&(kind, keys)| (kind, (kind, keys))).collect();
        let (kind, keys) = self.need("kind", self.choice("kind", &choices)?)?;
        self.only(keys)?;
        Ok(kind)
    }
}

/// Three numbers.
pub(super) fn triple(table: &Table<'_>, name: &str) -> Result<Option<[f64; 3]>, Fault> {
    let Some(numbers) = table.numbers(name)? else { return Ok(None) };
    let count = numbers.len();
    let wrong = |_| {
        let found = format!("a list of {count}");
        table.fault(name, ProblemFileCause::WrongType { expected: "a list of 3 numbers", found })
    };
    <[f64; 3]>::try_from(numbers).map(Some).map_err(wrong)
}
