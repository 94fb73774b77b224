//! JSON that remembers where each of its values stands, so that messages can point at them.

use std::ops::Range;

use crate::log::shortened;

/// Arrays in objects in arrays: glTF needs about eight.
const MAX_DEPTH: usize = 64;

/// Values in one file. Each takes some 60 bytes of memory, and as few as two of the file.
const MAX_VALUES: usize = 8 << 20;

/// A value and the bytes of the text that it stands at.
#[derive(Debug, PartialEq)]
pub(super) struct Value {
    pub(super) kind: Kind,
    pub(super) range: Range<usize>,
}

/// What a value is.
#[derive(Debug, PartialEq)]
pub(super) enum Kind {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Object(Vec<(String, Value)>),
}

impl Kind {
    /// What messages call it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "true or false",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }
}

/// Why a text is not JSON, and the byte at which that shows.
#[derive(Debug, PartialEq)]
pub(super) struct JsonError {
    pub(super) byte: usize,
    pub(super) message: String,
}

/// Reads a text as one value. A name that an object has twice counts where it stands first.
pub(super) fn parse(text: &str) -> Result<Value, JsonError> {
    let mut parser = Parser { text, at: 0, values: 0 };
    parser.space();
    let value = parser.value(0)?;
    parser.space();
    if parser.at < text.len() {
        return Err(parser.error("something stands behind the end of the document"));
    }
    Ok(value)
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    values: usize,
}

impl Parser<'_> {
    fn error(&self, message: impl Into<String>) -> JsonError {
        JsonError { byte: self.at, message: message.into() }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\r' | b'\n')) {
            self.at += 1;
        }
    }

    fn expect(&mut self, byte: u8, what: &str) -> Result<(), JsonError> {
        if self.peek() != Some(byte) {
            return Err(self.unexpected(what));
        }
        self.at += 1;
        Ok(())
    }

    fn unexpected(&self, expected: &str) -> JsonError {
        match self.text[self.at..].chars().next() {
            Some(found) => self.error(format!("{expected} is missing before \"{}\"", found.escape_default())),
            None => self.error(format!("the text ends where {expected} should be")),
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, JsonError> {
        if depth > MAX_DEPTH {
            return Err(self.error(format!("more than {MAX_DEPTH} lists and objects in one another")));
        }
        self.values += 1;
        if self.values > MAX_VALUES {
            return Err(self.error(format!("more than {MAX_VALUES} values")));
        }
        let start = self.at;
        let kind = match self.peek() {
            Some(b'{') => self.object(depth)?,
            Some(b'[') => self.list(depth)?,
            Some(b'"') => Kind::Text(self.string()?),
            Some(b'-' | b'0'..=b'9') => Kind::Number(self.number()?),
            _ => self.word()?,
        };
        Ok(Value { kind, range: start..self.at })
    }

    fn word(&mut self) -> Result<Kind, JsonError> {
        let rest = &self.text[self.at..];
        for (word, kind) in [("null", Kind::Null), ("true", Kind::Bool(true)), ("false", Kind::Bool(false))] {
            if rest.starts_with(word) {
                self.at += word.len();
                return Ok(kind);
            }
        }
        Err(self.unexpected("a value"))
    }

    fn list(&mut self, depth: usize) -> Result<Kind, JsonError> {
        let mut items = Vec::new();
        self.at += 1;
        self.space();
        while self.peek() != Some(b']') {
            if !items.is_empty() {
                self.expect(b',', "a comma or \"]\"")?;
                self.space();
            }
            items.push(self.value(depth + 1)?);
            self.space();
        }
        self.at += 1;
        Ok(Kind::List(items))
    }

    fn object(&mut self, depth: usize) -> Result<Kind, JsonError> {
        let mut fields = Vec::new();
        self.at += 1;
        self.space();
        while self.peek() != Some(b'}') {
            if !fields.is_empty() {
                self.expect(b',', "a comma or \"}\"")?;
                self.space();
            }
            if self.peek() != Some(b'"') {
                return Err(self.unexpected("a name in quotes"));
            }
            let name = self.string()?;
            self.space();
            self.expect(b':', "a colon")?;
            self.space();
            fields.push((name, self.value(depth + 1)?));
            self.space();
        }
        self.at += 1;
        Ok(Kind::Object(fields))
    }

    /// A text with its escapes undone.
    fn string(&mut self) -> Result<String, JsonError> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let mut end = start + 1;
        loop {
            match bytes.get(end) {
                None => return Err(self.error("the text in quotes has no end")),
                Some(b'"') => break,
                Some(b'\\') => end += 2,
                Some(_) => end += 1,
            }
        }
        let quoted = &self.text[start..=end];
        let text = serde_json::from_str(quoted)
            .map_err(|_| self.error(format!("{} is not a text of JSON", shortened(quoted))))?;
        self.at = end + 1;
        Ok(text)
    }

    fn number(&mut self) -> Result<f64, JsonError> {
        let rest = &self.text[self.at..];
        let is_part = |b: u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E');
        let end = rest.bytes().position(|b| !is_part(b)).unwrap_or(rest.len());
        let digits = &rest[..end];
        let number = serde_json::from_str(digits)
            .map_err(|_| self.error(format!("\"{}\" is not a number", shortened(digits))))?;
        self.at += end;
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fails(text: &str) -> (usize, String) {
        let error = parse(text).expect_err(text);
        (error.byte, error.message)
    }

    #[test]
    fn values_know_where_they_stand() {
        let text = " {\"a\": [1, -2.5e1, true, null, \"\\u00e4\\\"\"], \"b\": {}}";
        let value = parse(text).expect("it is JSON");
        let Kind::Object(fields) = &value.kind else { panic!("{value:?}") };
        assert_eq!(value.range, 1..text.len());
        let Kind::List(items) = &fields[0].1.kind else { panic!("{value:?}") };
        let kinds: Vec<&Kind> = items.iter().map(|item| &item.kind).collect();
        let expected =
            [Kind::Number(1.0), Kind::Number(-25.0), Kind::Bool(true), Kind::Null, Kind::Text("ä\"".into())];
        assert_eq!(kinds, expected.iter().collect::<Vec<_>>());
        assert_eq!(&text[items[1].range.clone()], "-2.5e1");
        assert_eq!(fields[1].0, "b");
    }

    #[test]
    fn mistakes_are_told_at_their_place() {
        assert_eq!(fails("[1 2]"), (3, "a comma or \"]\" is missing before \"2\"".into()));
        assert_eq!(fails("{\"a\" 1}"), (5, "a colon is missing before \"1\"".into()));
        assert_eq!(fails("[1,]"), (3, "a value is missing before \"]\"".into()));
        assert_eq!(fails("[1"), (2, "the text ends where a comma or \"]\" should be".into()));
        assert_eq!(fails("{} x").0, 3);
        assert_eq!(fails("[01]"), (1, "\"01\" is not a number".into()));
        assert_eq!(fails("[1e999]"), (1, "\"1e999\" is not a number".into()));
        assert_eq!(fails("\"abc\\").0, 0);
        assert_eq!(fails("").0, 0);
        assert_eq!(fails("{a: 1}"), (1, "a name in quotes is missing before \"a\"".into()));
    }

    #[test]
    fn depth_has_a_bound() {
        assert!(parse(&format!("{}{}", "[".repeat(60), "]".repeat(60))).is_ok());
        assert!(fails(&"[".repeat(100_000)).1.contains("in one another"));
    }
}
