//! `<spectrum type="…">`.

use nephroid::color::Rgb;

use super::document::Element;
use super::names::SPECTRA;
use super::properties::Plugin;
use super::reader::Reader;
use super::value::Value;
use crate::number::floats;
use crate::spectra::{FIRST_NM, LAST_NM, Role, Spectrum, thermal_radiance};

impl<'t> Reader<'t> {
    /// The colour of it; black if the log says why not.
    pub(super) fn spectrum_plugin(&mut self, element: &'t Element, role: Role) -> Rgb {
        let plugin = self.plugin(element);
        let color = match plugin.kind {
            "uniform" | "rawconstant" => self.color_property(&plugin, "value", 1.0, role),
            "srgb" => self.color_property(&plugin, "color", 1.0, role),
            "d65" => {
                let color = self.color_property(&plugin, "color", 1.0, Role::Reflectance);
                color * plugin.float("scale", 1.0)
            }
            "regular" | "irregular" | "blackbody" => {
                let spectrum = match plugin.kind {
                    "regular" => self.regular(&plugin),
                    "irregular" => self.irregular(&plugin),
                    _ => self.hot_body(&plugin),
                };
                spectrum.map_or(Rgb::BLACK, |s| self.spectrum_color(&s, role, plugin.location()))
            }
            _ => {
                self.unknown_kind(&plugin, &[SPECTRA]);
                return Rgb::splat(0.5);
            }
        };
        plugin.finish();
        color
    }

    /// Values that are equally far apart, from the first wavelength to the last.
    fn regular(&self, plugin: &Plugin<'t>) -> Option<Spectrum> {
        let values = self.numbers(plugin, "values");
        let (first, last) = if plugin.has("range") {
            let range = self.numbers(plugin, "range")?;
            let &[first, last] = range.as_slice() else {
                self.log.error(plugin.location(), "\"range\" has two wavelengths");
                return None;
            };
            (first, last)
        } else {
            let [first, last] =
                ["wavelength_min", "wavelength_max"].map(|name| self.wavelength(plugin, name, None));
            (f64::from(first?), f64::from(last?))
        };
        let values = values?;
        let steps = (values.len().max(2) - 1) as f64;
        let place = |i: usize| first + (last - first) * (i as f64 / steps);
        self.samples(plugin, values.iter().enumerate().map(|(i, value)| (place(i), *value)).collect())
    }

    /// Values at wavelengths of their own.
    fn irregular(&self, plugin: &Plugin<'t>) -> Option<Spectrum> {
        let [wavelengths, values] = ["wavelengths", "values"].map(|name| self.numbers(plugin, name));
        let (wavelengths, values) = (wavelengths?, values?);
        if wavelengths.len() != values.len() {
            let message = format!("{} wavelengths have {} values", wavelengths.len(), values.len());
            self.log.error(plugin.location(), message);
            return None;
        }
        self.samples(plugin, wavelengths.into_iter().zip(values).collect())
    }

    /// What a black body radiates within a range of wavelengths.
    fn hot_body(&self, plugin: &Plugin<'t>) -> Option<Spectrum> {
        let first = self.wavelength(plugin, "wavelength_min", Some(FIRST_NM as f32));
        let last = self.wavelength(plugin, "wavelength_max", Some(LAST_NM as f32));
        if plugin.property("temperature").is_none() {
            self.log.error(plugin.location(), "a black body needs a \"temperature\", in kelvin");
            return None;
        }
        let kelvin = f64::from(plugin.positive("temperature", 5000.0));
        let range = [f64::from(first?).max(FIRST_NM), f64::from(last?).min(LAST_NM)];
        if range[0] >= range[1] {
            self.log.warn(plugin.location(), "none of its wavelengths can be seen: it is black");
            return None;
        }
        Some(thermal_radiance(kelvin, range))
    }

    fn wavelength(&self, plugin: &Plugin<'t>, name: &'static str, default: Option<f32>) -> Option<f32> {
        let value = plugin.optional_float(name).or(default);
        if value.is_none() && !plugin.has(name) {
            let message = format!("spectrum \"{}\" needs \"{name}\", in nm", plugin.kind);
            self.log.error(plugin.location(), message);
        }
        value
    }

    /// A list of numbers in a string; `None` if the log says why.
    fn numbers(&self, plugin: &Plugin<'t>, name: &'static str) -> Option<Vec<f64>> {
        let Some(property) = plugin.property(name) else {
            let message = format!("spectrum \"{}\" needs \"{name}\"", plugin.kind);
            self.log.error(plugin.location(), message);
            return None;
        };
        let Value::Text(text) = property.value else {
            plugin.wrong_type(property, "a string of numbers");
            return None;
        };
        floats(text).map_err(|message| self.log.error(&property.location, message)).ok()
    }

    fn samples(&self, plugin: &Plugin<'t>, pairs: Vec<(f64, f64)>) -> Option<Spectrum> {
        Spectrum::samples(pairs).map_err(|message| self.log.error(plugin.location(), message)).ok()
    }
}
