//! Messages about a file that say where, what and what to do.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The text of a file, kept so that messages can quote it.
pub struct Source {
    name: String,
    text: String,
    line_starts: Vec<usize>,
}

impl Source {
    /// Keeps a text under the name that messages use.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        let text = text.into();
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1))
            .collect();
        Arc::new(Self { name: name.into(), text, line_starts })
    }

    /// What messages call it, usually its path.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All of it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of a byte, both from 1; columns count characters.
    fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let line = self.line_starts.partition_point(|start| *start <= byte);
        let start = self.line_starts[line - 1];
        let before = self.text.get(start..byte).unwrap_or_default();
        (line, before.chars().count() + 1)
    }

    /// The byte at a line and column, both from 1; columns count characters.
    pub(crate) fn byte_at(&self, line: usize, column: usize) -> usize {
        let Some(start) = self.line_starts.get(line.saturating_sub(1)) else { return self.text.len() };
        let rest = &self.text[*start..];
        let offset = rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(i, _)| i);
        start + offset
    }
}

/// A range of a file.
#[derive(Clone)]
pub struct Location {
    source: Arc<Source>,
    range: Range<usize>,
}

impl Location {
    /// A range of bytes; its ends are moved to the nearest character boundaries inside the text.
    pub fn new(source: &Arc<Source>, range: Range<usize>) -> Self {
        let fit = |i: usize| {
            let mut i = i.min(source.text.len());
            while !source.text.is_char_boundary(i) {
                i -= 1;
            }
            i
        };
        let start = fit(range.start);
        Self { source: Arc::clone(source), range: start..fit(range.end).max(start) }
    }

    /// The file.
    pub fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// The bytes.
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// The text of the range.
    pub fn text(&self) -> &str {
        &self.source.text[self.range.clone()]
    }

    /// The line of its first byte, from 1.
    pub fn line(&self) -> usize {
        self.source.line_and_column(self.range.start).0
    }

    /// The column of its first byte, from 1, in characters.
    pub fn column(&self) -> usize {
        self.source.line_and_column(self.range.start).1
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.source.line_and_column(self.range.start);
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

impl fmt::Debug for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl PartialEq for Location {
    fn eq(&self, other: &Self) -> bool {
        self.range == other.range && self.source.name == other.source.name
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used, but the picture may not be the intended one.
    Warning,
}

/// One message about a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Where; none if no file could be read or it concerns something outside all files.
    pub location: Option<Location>,
    /// What is wrong, without a full stop.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(at: &Location, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, location: Some(at.clone()), message: message.into(), hint: None }
    }

    /// A warning at a place.
    pub fn warning(at: &Location, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(at, message) }
    }

    /// An error outside all files.
    pub fn global_error(message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, location: None, message: message.into(), hint: None }
    }

    /// Adds advice.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds the known name that is closest to `wrong`, if one is close.
    #[must_use]
    pub fn did_you_mean<'k>(self, wrong: &str, known: impl IntoIterator<Item = &'k str>) -> Self {
        match closest(wrong, known) {
            Some(name) => self.hint(format!("did you mean \"{name}\"?")),
            None => self,
        }
    }

    /// The name of the file.
    pub fn file(&self) -> Option<&str> {
        self.location.as_ref().map(|l| l.source.name())
    }

    /// The line, from 1.
    pub fn line(&self) -> Option<usize> {
        self.location.as_ref().map(Location::line)
    }

    /// The column, from 1, in characters.
    pub fn column(&self) -> Option<usize> {
        self.location.as_ref().map(Location::column)
    }

    /// The text that it is about.
    pub fn offending_text(&self) -> Option<&str> {
        self.location.as_ref().map(Location::text)
    }

    /// The message with the lines it is about, for a terminal.
    pub fn render(&self, colour: bool) -> String {
        use ariadne::{CharSet, Color, Config, IndexType, Label, Report, ReportKind};
        let Some(location) = &self.location else { return format!("{self}\n") };
        let text = quotable(location);
        if text.is_empty() {
            return format!("{self}\n");
        }
        let name = location.source.name().to_string();
        let (kind, paint) = match self.severity {
            Severity::Error => (ReportKind::Error, Color::Red),
            Severity::Warning => (ReportKind::Warning, Color::Yellow),
        };
        let config = Config::default()
            .with_color(colour)
            .with_char_set(if colour { CharSet::Unicode } else { CharSet::Ascii })
            .with_index_type(IndexType::Byte);
        let mut label = Label::new((name.clone(), location.range())).with_color(paint);
        if let Some(hint) = &self.hint {
            label = label.with_message(hint);
        }
        let report = Report::build(kind, (name.clone(), location.range()))
            .with_config(config)
            .with_message(&self.message)
            .with_label(label)
            .finish();
        let mut out = Vec::new();
        let quoted = ariadne::sources([(name, text)]);
        match report.write(quoted, &mut out) {
            Ok(()) => String::from_utf8_lossy(&out).into_owned(),
            Err(_) => format!("{self}\n"),
        }
    }
}

/// The text to quote from. A file without line breaks may be one line of megabytes, which nobody
/// wants in a terminal: then it is empty.
fn quotable(location: &Location) -> &str {
    let source = &location.source;
    let starts = &source.line_starts;
    let line = location.line();
    let end = starts.get(line).copied().unwrap_or(source.text.len());
    if end - starts[line - 1] > 2000 { "" } else { source.text() }
}

/// `file:line:column: error: message; hint`
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(location) = &self.location {
            write!(f, "{location}: ")?;
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}: {}", self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, "; {hint}")?;
        }
        Ok(())
    }
}

/// All that is wrong with a file; at least one of them is an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// All messages with the lines they are about, for a terminal.
    pub fn render(&self, colour: bool) -> String {
        self.0.iter().map(|d| d.render(colour)).collect()
    }
}

/// One line each.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, diagnostic) in self.0.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{diagnostic}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// The known name closest to `wrong`, if it is close enough to be what was meant: about one wrong
/// letter in three, not counting case.
pub fn closest<'k>(wrong: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    if wrong.len() > 64 {
        return None;
    }
    let wrong = wrong.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::osa_distance(&wrong, &name.to_lowercase()), name))
        .filter(|(distance, name)| {
            let shorter = name.len().min(wrong.len());
            *distance < shorter && *distance <= 1.max(shorter / 3)
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let source = Source::new("a.xml", "é\r\nöx\n");
        let at = Location::new(&source, 6..7);
        assert_eq!((at.line(), at.column(), at.text()), (2, 2, "x"));
        assert_eq!(source.byte_at(2, 2), 6);
        assert_eq!(source.byte_at(9, 9), source.text().len());
    }

    #[test]
    fn a_message_is_one_line_or_a_quotation() {
        let source = Source::new("a.xml", "<scene>\n  <bsdf type=\"difuse\"/>\n</scene>");
        let message = Diagnostic::error(&Location::new(&source, 22..28), "unknown bsdf \"difuse\"")
            .did_you_mean("difuse", ["diffuse", "phong"]);
        assert_eq!(
            message.to_string(),
            "a.xml:2:15: error: unknown bsdf \"difuse\"; did you mean \"diffuse\"?"
        );
        let quoted = message.render(false);
        assert!(quoted.contains("a.xml:2:15"), "{quoted}");
        assert!(quoted.contains("<bsdf type=\"difuse\"/>"), "{quoted}");
        assert!(message.render(true).contains('\u{1b}'));
    }

    /// As what is wrong with a whole `.glb`, of which the text is one line.
    #[test]
    fn megabytes_are_not_quoted_from_the_first_byte_on() {
        let source = Source::new("a.glb", "x".repeat(5000));
        for range in [0..0, 0..1, 0..5000, 4000..4001] {
            let column = range.start + 1;
            let warning = Diagnostic::warning(&Location::new(&source, range), "no camera").hint("add one");
            assert_eq!(warning.render(false), format!("a.glb:1:{column}: warning: no camera; add one\n"));
        }
    }

    #[test]
    fn only_close_names_are_proposed() {
        assert_eq!(closest("sampleCount", ["sample_count", "samples"]), Some("sample_count"));
        assert_eq!(closest("x", ["sphere"]), None);
        assert_eq!(closest("Sphere", ["sphere", "phere"]), Some("sphere"));
    }
}
