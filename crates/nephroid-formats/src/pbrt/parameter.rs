//! One parameter: `"type name" [values]`.

use std::cell::Cell;

use super::color_space::ColorSpace;
use super::token::{Token, TokenKind, Tokens, unescaped};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};
use crate::number::float;

/// What a parameter says that it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Integer,
    Bool,
    String,
    Texture,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Rgb,
    Spectrum,
    Blackbody,
}

/// Every kind by its name; the last ones are those of older files.
const KINDS: [(&str, Kind); 19] = [
    ("float", Kind::Float),
    ("integer", Kind::Integer),
    ("bool", Kind::Bool),
    ("string", Kind::String),
    ("texture", Kind::Texture),
    ("point2", Kind::Point2),
    ("vector2", Kind::Vector2),
    ("point3", Kind::Point3),
    ("vector3", Kind::Vector3),
    ("normal", Kind::Normal),
    ("rgb", Kind::Rgb),
    ("spectrum", Kind::Spectrum),
    ("blackbody", Kind::Blackbody),
    ("normal3", Kind::Normal),
    ("point", Kind::Point3),
    ("vector", Kind::Vector3),
    ("color", Kind::Rgb),
    ("color3", Kind::Rgb),
    ("int", Kind::Integer),
];

impl Kind {
    pub(super) fn name(self) -> &'static str {
        KINDS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    /// How many numbers make one value.
    fn arity(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }

    fn is_text(self) -> bool {
        matches!(self, Self::String | Self::Texture)
    }
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Bools(Vec<bool>),
}

/// A parameter of something, at least one value long.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    pub(super) kind: Kind,
    pub(super) name: String,
    pub(super) values: Values,
    /// Where its type and name stand.
    pub(super) location: Location,
    /// Where its values stand.
    pub(super) value_at: Location,
    /// Of the numbers, if they are a colour.
    pub(super) color_space: ColorSpace,
    /// Given by `Attribute` to all that follows, and so never out of place.
    pub(super) is_default: bool,
    pub(super) used: Cell<bool>,
}

/// Reads the parameters that follow, up to the next directive. What is wrong goes to the log.
pub(super) fn read_parameters(tokens: &mut Tokens, color_space: ColorSpace, log: &Log) -> Vec<Parameter> {
    let mut list: Vec<Parameter> = Vec::new();
    while let Some(token) = tokens.peek(log).filter(|token| token.kind != TokenKind::Word) {
        tokens.next(log);
        if token.kind != TokenKind::Quoted {
            log.error(&tokens.location(&token), "expected a parameter, \"type name\", found a bracket");
            skip_values(tokens, log);
            continue;
        }
        let location = tokens.location(&token);
        let declaration = declaration(tokens.text(&token), &location, log);
        let Some((values, value_at)) = raw_values(tokens, &location, log) else { continue };
        let Some((kind, name)) = declaration else { continue };
        let Some(values) = typed(kind, &name, &values, tokens, &value_at, log) else { continue };
        if list.iter().any(|p| p.name == name) {
            log.error(&location, format!("\"{}\" is given twice", shortened(&name)));
            continue;
        }
        let used = Cell::new(false);
        list.push(Parameter { kind, name, values, location, value_at, color_space, is_default: false, used });
    }
    list
}

/// Passes what could be values of a parameter that is none.
fn skip_values(tokens: &mut Tokens, log: &Log) {
    while let Some(token) = tokens.peek(log) {
        let is_value = match token.kind {
            TokenKind::Word => {
                tokens.text(&token).starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
            }
            TokenKind::Close => true,
            TokenKind::Open | TokenKind::Quoted => false,
        };
        if !is_value {
            return;
        }
        tokens.next(log);
    }
}

fn declaration(text: &str, at: &Location, log: &Log) -> Option<(Kind, String)> {
    let mut words = text.split_whitespace();
    let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let message = format!("\"{}\" is no parameter", shortened(text));
        log.push(Diagnostic::error(at, message).hint("write \"type name\", as in \"float radius\""));
        return None;
    };
    let Some((_, known)) = KINDS.iter().find(|(known, _)| *known == kind) else {
        let message = format!("unknown type of parameter \"{}\"", shortened(kind));
        log.push(Diagnostic::error(at, message).did_you_mean(kind, KINDS.iter().map(|(name, _)| *name)));
        return None;
    };
    Some((*known, name.to_owned()))
}

/// The tokens of a value or a list of them, and where they stand.
fn raw_values(tokens: &mut Tokens, parameter: &Location, log: &Log) -> Option<(Vec<Token>, Location)> {
    let lacks = || {
        log.error(parameter, format!("\"{}\" has no value", shortened(parameter.text())));
        None
    };
    let Some(first) = tokens.peek(log) else { return lacks() };
    match first.kind {
        TokenKind::Word if is_directive(tokens.text(&first)) => return lacks(),
        TokenKind::Word | TokenKind::Quoted => {
            tokens.next(log);
            let at = tokens.location(&first);
            return Some((vec![first], at));
        }
        TokenKind::Close => {
            tokens.next(log);
            return lacks();
        }
        TokenKind::Open => {
            tokens.next(log);
        }
    }
    let mut list = Vec::new();
    let mut depth = 1;
    loop {
        let Some(token) = tokens.peek(log) else {
            log.error(&tokens.location(&first), "the list has no end; close it with ]");
            return None;
        };
        match token.kind {
            TokenKind::Close => {
                tokens.next(log);
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            TokenKind::Open => {
                tokens.next(log);
                log.error(&tokens.location(&token), "a list in a list");
                depth += 1;
            }
            TokenKind::Word if is_directive(tokens.text(&token)) => {
                log.error(&tokens.location(&first), "the list has no end; close it with ]");
                return None;
            }
            TokenKind::Word | TokenKind::Quoted => {
                tokens.next(log);
                list.push(token);
            }
        }
    }
    if list.is_empty() {
        return lacks();
    }
    Some((list, tokens.location_since(first.range.start)))
}

/// Whether a word without quotes can only be a directive.
fn is_directive(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_uppercase())
        && !matches!(word, "NaN" | "Inf" | "Infinity" | "INF" | "NAN")
}

/// The values of a list that must be of a kind.
fn typed(
    kind: Kind,
    name: &str,
    list: &[Token],
    tokens: &Tokens,
    at: &Location,
    log: &Log,
) -> Option<Values> {
    let name = shortened(name);
    let is_text = kind.is_text() || (kind == Kind::Spectrum && list[0].kind == TokenKind::Quoted);
    if is_text {
        let text = |token: &Token| {
            if token.kind == TokenKind::Quoted {
                return Some(unescaped(tokens.text(token)));
            }
            let message = format!("\"{name}\" is a {}, which stands between quotes", kind.name());
            log.error(&tokens.location(token), message);
            None
        };
        return list.iter().map(text).collect::<Option<_>>().map(Values::Texts);
    }
    if kind == Kind::Bool {
        let bool = |token: &Token| match tokens.text(token) {
            "true" => Some(true),
            "false" => Some(false),
            other => {
                let message = format!("\"{}\" is neither true nor false", shortened(other));
                log.error(&tokens.location(token), message);
                None
            }
        };
        return list.iter().map(bool).collect::<Option<_>>().map(Values::Bools);
    }
    let number = |token: &Token| {
        let found = if token.kind == TokenKind::Quoted {
            Err(format!(
                "\"{name}\" is a {}, and \"{}\" a string",
                kind.name(),
                shortened(tokens.text(token))
            ))
        } else {
            float(tokens.text(token))
        };
        match found {
            Ok(value) if kind == Kind::Integer && !is_integer(value) => {
                let message =
                    format!("\"{}\" is not a whole number of 32 bits", shortened(tokens.text(token)));
                log.error(&tokens.location(token), message);
                None
            }
            Ok(value) => Some(value),
            Err(message) => {
                log.error(&tokens.location(token), message);
                None
            }
        }
    };
    let numbers: Vec<f64> = list.iter().map(number).collect::<Option<_>>()?;
    let arity = kind.arity();
    if !numbers.len().is_multiple_of(arity) {
        let message =
            format!("\"{name}\": {} numbers are no {}s of {arity} each", numbers.len(), kind.name());
        log.error(at, message);
        return None;
    }
    Some(Values::Numbers(numbers))
}

fn is_integer(value: f64) -> bool {
    value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value)
}
