//! `MakeNamedMedium` and `MediumInterface`.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{DVec3, Transform};
use nephroid::medium::{Coefficient, Grid, GridValues, Medium, Phase};

use super::medium_presets::{OTHERS, preset, preset_names};
use super::names::{MEDIA, MEDIA_LATER};
use super::parameter::Kind;
use super::parameters::Parameters;
use super::reader::Reader;
use super::token::{TokenKind, Tokens, unescaped};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;
use crate::spectra::Role;

impl Reader<'_> {
    pub(super) fn make_named_medium(&mut self, name: String, mut parameters: Parameters) {
        let name_at = parameters.at.clone();
        let kind = parameters.text("type").map(|(kind, at)| (kind.to_owned(), at.clone()));
        let handle = match kind {
            Some((kind, at)) => {
                (parameters.kind, parameters.at) = (kind, at);
                self.new_medium(&name, &parameters)
            }
            None => {
                let message = Diagnostic::error(&name_at, "the medium has no type");
                self.log.push(message.hint("write \"string type\" and its name, as in \"homogeneous\""));
                None
            }
        };
        if self.named_media.insert(name.clone(), handle).is_some() {
            self.log.error(&name_at, format!("the medium \"{}\" is there already", shortened(&name)));
        }
    }

    /// One or two names: what is behind surfaces, and what is in front.
    pub(super) fn medium_interface(&mut self, directive: &str, at: &Location, tokens: &mut Tokens) {
        let Some((inside, inside_at)) = self.string(directive, at, tokens) else { return };
        let second = tokens.peek(self.log).filter(|token| token.kind == TokenKind::Quoted);
        let inside = self.medium_of_name(&inside, &inside_at);
        let outside = match second {
            Some(token) => {
                tokens.next(self.log);
                let (text, at) = (unescaped(tokens.text(&token)), tokens.location(&token));
                self.medium_of_name(&text, &at)
            }
            None => inside,
        };
        (self.state.inside, self.state.outside) = (inside, outside);
    }

    fn medium_of_name(&self, name: &str, at: &Location) -> Option<Handle<Medium>> {
        if name.is_empty() {
            return None;
        }
        if let Some(known) = self.named_media.get(name) {
            return *known;
        }
        let message = format!("no medium is called \"{}\"", shortened(name));
        let known = self.named_media.keys().map(String::as_str);
        let mut message = Diagnostic::error(at, message).did_you_mean(name, known);
        if message.hint.is_none() {
            message = message.hint("MakeNamedMedium must stand before its use");
        }
        self.log.push(message);
        None
    }

    fn new_medium(&mut self, name: &str, parameters: &Parameters) -> Option<Handle<Medium>> {
        let kind = match parameters.kind.as_str() {
            "heterogeneous" => {
                let message = "medium \"heterogeneous\" is of older files; \"uniformgrid\" stands for it";
                self.log.warn(&parameters.at, message);
                "uniformgrid"
            }
            kind => kind,
        };
        if !MEDIA.contains(&kind) {
            if MEDIA_LATER.contains(&kind) {
                self.left_out(&parameters.at, &format!("medium \"{kind}\""));
            } else {
                self.unknown_kind(parameters, &[MEDIA, MEDIA_LATER]);
            }
            return None;
        }
        let g = parameters.float_that("g", 0.0, "between -1 and 1", |g| g.abs() < 1.0) as f32;
        let phase = if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } };
        let scale = parameters.not_negative("scale", 1.0) as f32;
        let coefficients = self.scattering(parameters);
        let emission = self.glow(parameters);
        let density =
            if kind == "uniformgrid" { self.density(name, parameters).map(Some) } else { Some(None) };
        parameters.finish();
        let [sigma_s, sigma_a] = coefficients?;
        let sigma_t = (sigma_s + sigma_a) * scale;
        let part = |s: f32, t: f32| if t == 0.0 { 0.0 } else { s / t };
        let albedo = (sigma_s * scale).zip(sigma_t, part);
        let emission = emission * self.exposure;
        let (sigma_t, emission) = match density? {
            None => (Coefficient::Constant(sigma_t), Coefficient::Constant(emission)),
            Some((grid, to_world)) if emission.is_black() => {
                (self.scaled_grid(grid, to_world, sigma_t, &parameters.at), Coefficient::ZERO)
            }
            Some((grid, to_world)) => {
                let emission = self.scaled_grid(grid.clone(), to_world, emission, &parameters.at);
                (self.scaled_grid(grid, to_world, sigma_t, &parameters.at), emission)
            }
        };
        let medium = Medium {
            name: name.to_owned(),
            sigma_t,
            albedo: Coefficient::Constant(albedo),
            emission,
            phase,
            ambient: Rgb::BLACK,
        };
        self.origins.media.push(parameters.at.clone());
        Some(self.media.list.push(medium))
    }

    /// Scattering and absorption per length.
    fn scattering(&self, parameters: &Parameters) -> Option<[Rgb; 2]> {
        if let Some((name, at)) = parameters.text("preset") {
            if let Some(pair) = preset(name) {
                return Some(pair.map(Rgb::from));
            }
            let (name, message) = if OTHERS.contains(&name) {
                (name, format!("the coefficients of \"{name}\" are not known here"))
            } else {
                (name, format!("no medium is known as \"{}\"", shortened(name)))
            };
            let message = Diagnostic::error(at, message);
            self.log.push(if OTHERS.contains(&name) {
                message.hint("write \"sigma_a\" and \"sigma_s\", absorption and scattering per length")
            } else {
                message.did_you_mean(name, preset_names())
            });
            return None;
        }
        Some(["sigma_s", "sigma_a"].map(|name| self.color(parameters, name, Rgb::WHITE, Role::Index)))
    }

    /// Radiance that is added per length: `Le` for each absorption, as pbrt has it.
    fn glow(&self, parameters: &Parameters) -> Rgb {
        for name in ["temperature", "temperatureoffset", "temperaturecutoff", "temperaturescale"] {
            if let Some(found) = parameters.any(name) {
                self.log.warn(&found.location, format!("\"{name}\": media do not glow by their heat yet"));
            }
        }
        let factor = match parameters.numbers("Lescale", &[Kind::Float, Kind::Integer]) {
            Some((&[factor], _)) => factor as f32,
            Some((_, at)) => {
                self.log.warn(at, "a grid of \"Lescale\" cannot be had yet: it is 1 everywhere");
                1.0
            }
            None => 1.0,
        };
        let Some(found) = parameters.any("Le") else { return Rgb::BLACK };
        if matches!(&found.values, super::parameter::Values::Numbers(list) if list.iter().all(|v| *v == 0.0))
        {
            return Rgb::BLACK;
        }
        let light = self.color_of(parameters, found, Role::Emission).unwrap_or(Rgb::BLACK) * factor;
        let absorption = self.color(parameters, "sigma_a", Rgb::WHITE, Role::Index);
        light * absorption * parameters.not_negative("scale", 1.0) as f32
    }

    /// Densities, and the map from [0, 1]³ to the world.
    fn density(&self, name: &str, parameters: &Parameters) -> Option<(Grid, Transform)> {
        let size = ["nx", "ny", "nz"].map(|name| parameters.integer(name, 1, 1..=65_536));
        let corner = |name, default| parameters.triple(name).unwrap_or(default);
        let (p0, p1) = (corner("p0", DVec3::ZERO), corner("p1", DVec3::ONE));
        let Some((list, at)) = parameters.numbers("density", &[Kind::Float, Kind::Integer]) else {
            if !parameters.has("density") {
                self.log.error(&parameters.at, "\"uniformgrid\" lacks \"float density\"");
            }
            return None;
        };
        let cells = size.iter().map(|n| u64::from(*n)).product::<u64>();
        if list.len() as u64 != cells {
            let [x, y, z] = size;
            let message = format!("{} of \"density\" for {x}×{y}×{z} = {cells} cells", list.len());
            self.log.error(at, message);
            return None;
        }
        if let Some(wrong) = list.iter().find(|v| **v < 0.0) {
            self.log.error(at, format!("no density is negative, as {wrong} is"));
            return None;
        }
        let to_box = Transform::scale(p1 - p0).then(Transform::translate(p0));
        if !to_box.is_invertible() {
            self.log.error(&parameters.at, "the box from \"p0\" to \"p1\" is flat");
            return None;
        }
        let values = GridValues::Grey(list.iter().map(|v| *v as f32).collect());
        Some((Grid { name: name.to_owned(), size, values }, to_box.then(self.state.ctm)))
    }

    /// A grid times a colour.
    fn scaled_grid(&mut self, grid: Grid, to_world: Transform, by: Rgb, at: &Location) -> Coefficient {
        let is_grey = by.r == by.g && by.g == by.b;
        let values = match grid.values {
            GridValues::Grey(list) if !is_grey => {
                GridValues::Rgb(list.into_iter().map(|density| by * density).collect())
            }
            values => values,
        };
        let grid = self.media.grids.push(Grid { values, ..grid });
        self.origins.grids.push(at.clone());
        Coefficient::Grid { grid, to_world, scale: if is_grey { by.g } else { 1.0 } }
    }
}
