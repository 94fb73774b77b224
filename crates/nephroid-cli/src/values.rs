//! Values of parameters, from text and back.

use nephroid::integrator::FinalGather;
use nephroid::photon_map::Kernel;
use serde_json::{Value, json};

/// A whole number between two others, also one written as 1e6.
pub fn count(text: &str, least: u64, most: u64) -> Result<u64, String> {
    let whole = |v: f64| (v.fract() == 0.0 && (0.0..1e15).contains(&v)).then_some(v as u64);
    let number = text.parse().ok().or_else(|| text.parse().ok().and_then(whole));
    number
        .filter(|n| (least..=most).contains(n))
        .ok_or_else(|| format!("it must be a whole number between {least} and {most}"))
}

/// A longest path; -1 for none.
pub fn depth(text: &str) -> Result<Option<u32>, String> {
    if text == "-1" {
        return Ok(None);
    }
    let most = u64::from(u32::MAX);
    count(text, 0, most).map(|n| Some(n as u32)).map_err(|_| "it must be a whole number, or -1".to_owned())
}

/// A length in scene units.
pub fn length(text: &str) -> Result<f32, String> {
    number(text, "a length above zero", |r| r > 0.0)
}

/// A finite number that is accepted.
pub fn number(text: &str, expected: &str, accept: impl Fn(f32) -> bool) -> Result<f32, String> {
    let number = text.parse().ok().filter(|&v: &f32| v.is_finite() && accept(v));
    number.ok_or_else(|| format!("it must be {expected}"))
}

/// A kernel by its name.
pub fn kernel(text: &str) -> Result<Kernel, String> {
    Kernel::parse(text).ok_or_else(|| format!("it must be one of {}", Kernel::NAMES.join(", ")))
}

/// True or false.
pub fn boolean(text: &str) -> Result<bool, String> {
    text.parse().map_err(|_| "it must be true or false".to_owned())
}

/// Whether and with how many rays to gather.
pub fn final_gather(text: &str) -> Result<FinalGather, String> {
    match text {
        "on" | "true" => Ok(FinalGather::Auto),
        "off" | "false" | "0" => Ok(FinalGather::Off),
        _ => count(text, 1, 1 << 16)
            .map(|n| FinalGather::Rays(n as u32))
            .map_err(|_| "it must be on, off or a number of rays".to_owned()),
    }
}

/// One of a few names.
pub fn one_of<T: Copy>(text: &str, choices: &[(&str, T)]) -> Result<T, String> {
    let found = choices.iter().find(|(name, _)| *name == text);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        format!("it must be one of {}", names.join(", "))
    })
}

/// The name of a value.
pub fn name_of<T: PartialEq>(choices: &[(&'static str, T)], value: T) -> Value {
    choices.iter().find(|(_, v)| *v == value).map_or(Value::Null, |(name, _)| json!(name))
}
