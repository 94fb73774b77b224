//! Colours, and spectra as colours.

use nephroid::color::Rgb;

use super::named::{NamedSpectrum, named_spectrum, spectrum_names};
use super::parameter::{Kind, Parameter, Values};
use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;
use crate::spectra::{Role, Spectrum, blackbody};

impl Reader<'_> {
    /// A parameter that is one colour; `None` if it is not given, or the log says what is wrong.
    ///
    /// Light that is not given as `rgb` has luminance one: pbrt divides it by its own.
    pub(super) fn optional_color(
        &self,
        parameters: &Parameters,
        name: &'static str,
        role: Role,
    ) -> Option<Rgb> {
        self.color_of(parameters, parameters.any(name)?, role)
    }

    /// A parameter that is one colour, or a default.
    pub(super) fn color(&self, parameters: &Parameters, name: &'static str, default: Rgb, role: Role) -> Rgb {
        self.optional_color(parameters, name, role).unwrap_or(default)
    }

    /// The colour that a parameter says.
    pub(super) fn color_of(&self, parameters: &Parameters, found: &Parameter, role: Role) -> Option<Rgb> {
        let at = &found.value_at;
        let color = match (found.kind, &found.values) {
            (Kind::Rgb, Values::Numbers(list)) => match list.as_slice() {
                &[r, g, b] => self.rgb([r, g, b], found, role)?,
                _ => return self.too_many(found, "one colour"),
            },
            (Kind::Blackbody, Values::Numbers(list)) => match list.as_slice() {
                [kelvin, scale @ ..] if scale.len() <= 1 => {
                    if *kelvin <= 0.0 {
                        self.log
                            .error(at, format!("a black body has a temperature above zero, not {kelvin}"));
                        return None;
                    }
                    if !scale.is_empty() {
                        self.log.warn(at, "the second number is of older files: it is taken as a factor");
                    }
                    let scale = scale.first().copied().unwrap_or(1.0) as f32;
                    self.spectrum_color(&blackbody(*kelvin), role, at)? * scale.max(0.0)
                }
                _ => return self.too_many(found, "one temperature"),
            },
            (Kind::Spectrum, Values::Numbers(list)) => {
                self.spectrum_color(&self.sampled(list, at)?, role, at)?
            }
            (Kind::Spectrum, Values::Texts(texts)) => match texts.as_slice() {
                [name] => self.spectrum_by_name(name, role, at)?,
                _ => return self.too_many(found, "one spectrum"),
            },
            (Kind::Float | Kind::Integer, Values::Numbers(list)) => match list.as_slice() {
                [value] if *value >= 0.0 || role == Role::Number => Rgb::splat(*value as f32),
                [value] => {
                    self.log.error(at, format!("\"{}\" must be zero or more, not {value}", found.name));
                    return None;
                }
                _ => return self.too_many(found, "one number"),
            },
            _ => {
                parameters.wrong_kind(found, "a colour (rgb, spectrum, blackbody)");
                return None;
            }
        };
        Some(color)
    }

    fn too_many(&self, found: &Parameter, expected: &str) -> Option<Rgb> {
        self.log.error(&found.value_at, format!("\"{}\" takes {expected}", found.name));
        None
    }

    fn rgb(&self, rgb: [f64; 3], found: &Parameter, role: Role) -> Option<Rgb> {
        let at = &found.value_at;
        if let Some(value) = rgb.iter().find(|v| **v < 0.0) {
            self.log.error(at, format!("no channel of a colour can be negative, as {value} is"));
            return None;
        }
        if role == Role::Reflectance && rgb.iter().any(|v| *v > 1.0) {
            self.log.warn(at, format!("\"{}\" is more than 1 and made that", found.name));
        }
        let color = found.color_space.to_srgb(rgb);
        if !color.is_finite() {
            self.log.error(at, "the colour is not finite");
            return None;
        }
        Some(if role == Role::Reflectance { color.map(|v| v.min(1.0)) } else { color })
    }

    fn sampled(&self, list: &[f64], at: &Location) -> Option<Spectrum> {
        if !list.len().is_multiple_of(2) {
            let message = format!("{} numbers are no pairs of a wavelength and a value", list.len());
            self.log.error(at, message);
            return None;
        }
        let pairs = list.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        Spectrum::samples(pairs).map_err(|message| self.log.error(at, message)).ok()
    }

    fn spectrum_by_name(&self, name: &str, role: Role, at: &Location) -> Option<Rgb> {
        match named_spectrum(name) {
            Some(NamedSpectrum::Index(value)) => return Some(value),
            Some(NamedSpectrum::Light(value)) => return Some(value),
            None => {}
        }
        if !name.contains('.') {
            let message = format!("no spectrum is called \"{}\"", shortened(name));
            let names = spectrum_names();
            let mut message =
                Diagnostic::error(at, message).did_you_mean(name, names.iter().map(String::as_str));
            if message.hint.is_none() {
                message = message.hint("a file's name ends as in \"name.spd\"");
            }
            self.log.push(message);
            return None;
        }
        let (path, bytes) = self.read_file(name, at)?;
        match Spectrum::parse_file(&String::from_utf8_lossy(&bytes)) {
            Ok(spectrum) => self.spectrum_color(&spectrum, role, at),
            Err(message) => {
                self.log.error(at, format!("\"{}\": {message}", path.display()));
                None
            }
        }
    }

    fn spectrum_color(&self, spectrum: &Spectrum, role: Role, at: &Location) -> Option<Rgb> {
        if role != Role::Emission {
            let rgb = spectrum.to_rgb(role);
            if rgb.is_finite() {
                return Some(rgb);
            }
            self.log.error(at, "the colour of the spectrum is not finite");
            return None;
        }
        let rgb = spectrum.colour_of_light();
        if rgb.is_none() {
            self.log.error(at, "the light of the spectrum cannot be seen: it has no luminance");
        }
        rgb
    }
}
