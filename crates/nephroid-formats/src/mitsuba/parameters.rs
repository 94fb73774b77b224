//! `$name` in attribute values: `<default>`s, and what the caller puts in their place.

use std::cell::Cell;
use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};

/// A default may refer to other parameters this many times in a row.
const MAX_NESTING: usize = 16;
/// Longest attribute value after substitution, in bytes.
const MAX_LENGTH: usize = 1 << 20;

struct Parameter {
    value: String,
    /// The caller set it, so that defaults do not.
    overridden: bool,
    known_to_file: Cell<bool>,
}

/// The parameters of a scene, whichever of its files they stand in.
pub(super) struct Parameters {
    list: BTreeMap<String, Parameter>,
}

impl Parameters {
    pub(super) fn new(defines: &[(String, String)]) -> Self {
        let list = defines
            .iter()
            .map(|(name, value)| {
                let parameter =
                    Parameter { value: value.clone(), overridden: true, known_to_file: Cell::new(false) };
                (name.clone(), parameter)
            })
            .collect();
        Self { list }
    }

    /// A `<default>`. The first of a name counts.
    pub(super) fn set_default(&mut self, name: &str, value: &str) {
        match self.list.get(name) {
            Some(parameter) => parameter.known_to_file.set(true),
            None => {
                let parameter =
                    Parameter { value: value.to_string(), overridden: false, known_to_file: Cell::new(true) };
                self.list.insert(name.to_string(), parameter);
            }
        }
    }

    /// The text with each `$name` replaced and each `\$` as a plain dollar sign. What is wrong goes
    /// to the log, and the text stays as it is.
    pub(super) fn substitute(&self, text: &str, at: &Location, log: &Log) -> String {
        match self.expand(text, 0) {
            Ok(out) => out,
            Err(Trouble::Undefined(name)) => {
                log.push(
                    Diagnostic::error(at, format!("undefined parameter \"${name}\""))
                        .did_you_mean(&name, self.list.keys().map(String::as_str)),
                );
                text.to_string()
            }
            Err(Trouble::Endless) => {
                log.error(
                    at,
                    format!("parameters in \"{}\" refer to each other without end", shortened(text)),
                );
                text.to_string()
            }
        }
    }

    fn expand(&self, text: &str, nesting: usize) -> Result<String, Trouble> {
        if !text.contains('$') {
            return Ok(text.to_string());
        }
        if nesting > MAX_NESTING {
            return Err(Trouble::Endless);
        }
        let mut out = String::new();
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(kept) = before.strip_suffix('\\') {
                out.push_str(kept);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            let end = after.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(after.len());
            let name = &after[..end];
            let parameter = self.list.get(name).ok_or_else(|| Trouble::Undefined(name.to_string()))?;
            parameter.known_to_file.set(true);
            out.push_str(&self.expand(&parameter.value, nesting + 1)?);
            if out.len() > MAX_LENGTH {
                return Err(Trouble::Endless);
            }
            rest = &after[end..];
        }
        out.push_str(rest);
        Ok(out)
    }

    /// Complains about the caller's parameters that no file declares or uses.
    pub(super) fn report_unused(&self, scene: &Location, log: &Log) {
        let known = || self.list.iter().filter(|(_, p)| p.known_to_file.get()).map(|(name, _)| name.as_str());
        for (name, parameter) in &self.list {
            if !parameter.overridden || parameter.known_to_file.get() {
                continue;
            }
            let mut message = Diagnostic::error(scene, format!("the scene has no parameter \"{name}\""))
                .did_you_mean(name, known());
            if message.hint.is_none() && known().next().is_some() {
                message = message.hint(format!("it has {}", known().collect::<Vec<_>>().join(", ")));
            }
            log.push(message);
        }
    }
}

enum Trouble {
    Undefined(String),
    Endless,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Source;

    fn expand(parameters: &Parameters, text: &str) -> Result<String, String> {
        let log = Log::default();
        let at = Location::new(&Source::new("s", "text"), 0..4);
        let out = parameters.substitute(text, &at, &log);
        match log.into_list().pop() {
            Some(message) => Err(message.to_string()),
            None => Ok(out),
        }
    }

    #[test]
    fn values_come_from_the_caller_then_the_first_default() {
        let mut p = Parameters::new(&[("a".into(), "1".into())]);
        p.set_default("a", "2");
        p.set_default("b", "$a$a");
        p.set_default("b", "9");
        assert_eq!(expand(&p, "$a, $b, \\$b"), Ok("1, 11, $b".into()));
        assert_eq!(expand(&p, "$c"), Err("s:1:1: error: undefined parameter \"$c\"".into()));
    }

    #[test]
    fn endless_and_exploding_values_are_refused() {
        let mut p = Parameters::new(&[]);
        p.set_default("a", "$a");
        assert!(expand(&p, "$a").is_err());
        p.set_default("x0", &"x".repeat(1000));
        for i in 1..15 {
            p.set_default(&format!("x{i}"), &format!("$x{}", i - 1).repeat(10));
        }
        assert!(expand(&p, "$x14").is_err());
    }
}
