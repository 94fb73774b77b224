//! From text to words, strings and brackets.

use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Location, Source};
use crate::log::Log;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// A directive, a number, `true` or `false`.
    Word,
    /// A string; the range is what stands between the quotes.
    Quoted,
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A piece of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) range: Range<usize>,
}

/// The tokens of a file, one after the other. `#` begins a comment up to the end of its line.
pub(super) struct Tokens {
    source: Arc<Source>,
    at: usize,
}

impl Tokens {
    pub(super) fn new(source: Arc<Source>) -> Self {
        Self { source, at: 0 }
    }

    pub(super) fn text(&self, token: &Token) -> &str {
        &self.source.text()[token.range.clone()]
    }

    pub(super) fn location(&self, token: &Token) -> Location {
        Location::new(&self.source, token.range.clone())
    }

    /// From the start of a token to the end of what was read last.
    pub(super) fn location_since(&self, start: usize) -> Location {
        Location::new(&self.source, start..self.at.max(start))
    }

    /// The next token, which stays the next.
    pub(super) fn peek(&mut self, log: &Log) -> Option<Token> {
        let before = self.at;
        let token = self.next(log);
        // A string without an end has been told and is gone.
        if token.is_some() {
            self.at = before;
        }
        token
    }

    /// The next token; `None` at the end. A string without an end is told and left out.
    pub(super) fn next(&mut self, log: &Log) -> Option<Token> {
        let bytes = self.source.text().as_bytes();
        loop {
            match bytes.get(self.at)? {
                b'#' => self.at += bytes[self.at..].iter().take_while(|b| !is_end_of_line(**b)).count(),
                b if b.is_ascii_whitespace() => self.at += 1,
                b'[' | b']' => {
                    let kind = if bytes[self.at] == b'[' { TokenKind::Open } else { TokenKind::Close };
                    self.at += 1;
                    return Some(Token { kind, range: self.at - 1..self.at });
                }
                b'"' => {
                    let start = self.at + 1;
                    let mut end = start;
                    while let Some(byte) = bytes.get(end).filter(|b| **b != b'"' && !is_end_of_line(**b)) {
                        // What follows a backslash does not end the string.
                        end += if *byte == b'\\' && bytes.get(end + 1).is_some_and(|b| !is_end_of_line(*b)) {
                            2
                        } else {
                            1
                        };
                    }
                    let range = start..end.min(bytes.len());
                    self.at = range.end;
                    if bytes.get(end) == Some(&b'"') {
                        self.at += 1;
                        return Some(Token { kind: TokenKind::Quoted, range });
                    }
                    let at = Location::new(&self.source, start - 1..range.end);
                    log.push(Diagnostic::error(&at, "the string has no end").hint("close it with \""));
                }
                _ => {
                    let is_word =
                        |b: &u8| !b.is_ascii_whitespace() && !matches!(b, b'"' | b'[' | b']' | b'#');
                    let start = self.at;
                    self.at += bytes[start..].iter().take_while(|b| is_word(b)).count();
                    return Some(Token { kind: TokenKind::Word, range: start..self.at });
                }
            }
        }
    }
}

fn is_end_of_line(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// What a string says: `\\`, `\"`, `\n` and `\t` stand for one character.
pub(super) fn unescaped(text: &str) -> String {
    if !text.contains('\\') {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        match c {
            '\\' => match characters.next() {
                Some('n') => out.push('\n'),
                Some('t') => out.push('\t'),
                Some(c @ ('\\' | '"' | '\'')) => out.push(c),
                // Paths of Windows.
                Some(other) => out.extend(['\\', other]),
                None => out.push('\\'),
            },
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> (Vec<(TokenKind, String)>, usize) {
        let log = Log::default();
        let mut tokens = Tokens::new(Source::new("t", text));
        let mut list = Vec::new();
        while let Some(token) = tokens.next(&log) {
            list.push((token.kind, tokens.text(&token).to_owned()));
        }
        (list, log.into_list().len())
    }

    #[test]
    fn words_strings_and_brackets() {
        use TokenKind::{Close, Open, Quoted, Word};
        let (list, errors) = all("Shape\"disk\" # [ \"no\n\"float r\"[1 -2.5e-3]\t\"a \\\" b\"");
        let expected = [
            (Word, "Shape"),
            (Quoted, "disk"),
            (Quoted, "float r"),
            (Open, "["),
            (Word, "1"),
            (Word, "-2.5e-3"),
            (Close, "]"),
            (Quoted, "a \\\" b"),
        ];
        assert_eq!(list, expected.map(|(kind, text)| (kind, text.to_owned())));
        assert_eq!(errors, 0);
    }

    #[test]
    fn strings_end_where_their_line_does() {
        let (list, errors) = all("Include \"a.pbrt\nWorldBegin \"\\");
        assert_eq!(list.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>(), ["Include", "WorldBegin"]);
        assert_eq!(errors, 2);
    }

    #[test]
    fn escapes() {
        assert_eq!(unescaped(r#"a\"b\\c\nd"#), "a\"b\\c\nd");
        assert_eq!(unescaped(r"textures\wood.png\"), r"textures\wood.png\");
    }
}
