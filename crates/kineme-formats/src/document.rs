//! TOML that people write, read so that every refusal names its line.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// A value and where it stands.
pub(crate) type Value<'t> = Spanned<DeValue<'t>>;

/// A TOML document's file and text: turns places into lines.
#[derive(Clone, Copy)]
pub(crate) struct Document<'t> {
    file: &'t str,
    text: &'t str,
}

impl<'t> Document<'t> {
    /// Parses a document: itself and its root table.
    pub fn open(file: &'t str, bytes: &'t [u8]) -> Result<(Self, Spanned<DeTable<'t>>)> {
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let place = Place::Byte(e.valid_up_to());
            FormatError::new(file, place, "bytes that are no text", "TOML in UTF-8")
        })?;
        let document = Self { file, text };
        let root = DeTable::parse(text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            document.error(span, e.message(), "TOML")
        })?;
        Ok((document, root))
    }

    /// An error at a place of the text.
    pub fn error(
        &self,
        span: Range<usize>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> FormatError {
        FormatError::new(self.file, Place::Line(self.line(span)), found, expected)
    }

    /// The line on which something begins, counted from 1.
    pub fn line(&self, span: Range<usize>) -> usize {
        let before = &self.text.as_bytes()[..span.start.min(self.text.len())];
        1 + before.iter().filter(|&&b| b == b'\n').count()
    }

    /// Refuses keys that are not in `known`.
    pub fn only(&self, table: &DeTable<'t>, known: &[&str]) -> Result<()> {
        // The table is sorted by name; the first in the file is the one to report.
        let unknown = table
            .keys()
            .filter(|k| !known.contains(&k.get_ref().as_ref()))
            .min_by_key(|k| k.span().start);
        unknown.map_or(Ok(()), |key| {
            let found = format!("unknown key {}", quoted(key.get_ref()));
            Err(self.error(key.span(), found, known.join(", ")))
        })
    }

    /// A key's value; `span` is the table's, for the error where it has none.
    pub fn required<'a>(
        &self,
        table: &'a DeTable<'t>,
        span: Range<usize>,
        key: &str,
    ) -> Result<&'a Value<'t>> {
        table
            .get(key)
            .ok_or_else(|| self.error(span, format!("no `{key}`"), format!("a key `{key}`")))
    }

    /// A string that is not blank.
    pub fn name<'a>(&self, value: &'a Value<'t>) -> Result<&'a str> {
        match value.get_ref().as_str() {
            Some(text) if !text.trim().is_empty() => Ok(text),
            Some(_) => Err(self.error(value.span(), "an empty string", "a name")),
            None => Err(self.wrong_type(value, "a string")),
        }
    }

    /// A finite number, written as float or integer.
    pub fn number(&self, value: &Value<'t>) -> Result<f64> {
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(int) => i64::from_str_radix(int.as_str(), int.radix())
                .ok()
                .map(|i| i as f64),
            _ => return Err(self.wrong_type(value, "a number")),
        };
        number.filter(|n| n.is_finite()).ok_or_else(|| {
            let written = self.text.get(value.span()).unwrap_or_default();
            self.error(value.span(), quoted(written), "a finite number")
        })
    }

    /// A whole number that the type can hold.
    pub fn whole<T: TryFrom<i64>>(&self, value: &Value<'t>) -> Result<T> {
        let DeValue::Integer(int) = value.get_ref() else {
            return Err(self.wrong_type(value, "a whole number"));
        };
        i64::from_str_radix(int.as_str(), int.radix())
            .ok()
            .and_then(|i| T::try_from(i).ok())
            .ok_or_else(|| {
                let written = self.text.get(value.span()).unwrap_or_default();
                self.error(value.span(), quoted(written), "a whole number in range")
            })
    }

    /// The items of an array.
    pub fn array<'a>(
        &self,
        value: &'a Value<'t>,
    ) -> Result<impl Iterator<Item = &'a Value<'t>> + use<'a, 't>> {
        value
            .get_ref()
            .as_array()
            .map(|array| array.iter())
            .ok_or_else(|| self.wrong_type(value, "an array"))
    }

    /// A table.
    pub fn table<'a>(&self, value: &'a Value<'t>) -> Result<&'a DeTable<'t>> {
        value
            .get_ref()
            .as_table()
            .ok_or_else(|| self.wrong_type(value, "a table"))
    }

    fn wrong_type(&self, value: &Value<'t>, expected: &str) -> FormatError {
        let found = format!("a value of type {}", value.get_ref().type_str());
        self.error(value.span(), found, expected)
    }
}
