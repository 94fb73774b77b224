//! `<sensor>`, with the film and the sampler in it.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::film::{Crop, FilmSettings, Filter};
use nephroid::math::{Transform, Vec2};

use super::document::Element;
use super::names::{FILMS_LATER, FILTERS_LATER, SAMPLERS, SENSORS_LATER};
use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Location};
use crate::fit;

/// Longest side of a picture in pixels.
const MAX_SIDE: u32 = 65_536;

/// What a sensor says.
pub(super) struct Sensor {
    pub(super) camera: Camera,
    pub(super) film: FilmSettings,
    pub(super) sample_count: Option<u32>,
    /// Whether the file has none, and shapes that one can be fitted to.
    pub(super) is_missing: bool,
}

impl Sensor {
    fn fitted() -> Self {
        let projection = fit::perspective(45.0);
        let camera = Camera { to_world: Transform::IDENTITY, projection, medium: None };
        Self { camera, film: fit::film(), sample_count: None, is_missing: true }
    }
}

/// What is wrong with a scene without a sensor, if none can be fitted to it.
pub(super) fn no_sensor(scene: &Location) -> Diagnostic {
    Diagnostic::error(scene, "the scene has no <sensor>")
        .hint("add <sensor type=\"perspective\"> with a <film>")
}

impl<'t> Reader<'t> {
    /// The sensor that takes the picture. `None` if the log says why.
    pub(super) fn sensor(&mut self, elements: &'t [Element]) -> Option<Sensor> {
        let mut sensors = elements.iter().filter(|e| e.tag == "sensor");
        let Some(first) = sensors.next() else {
            if elements.iter().any(|element| element.tag == "shape") {
                return Some(Sensor::fitted());
            }
            self.log.push(no_sensor(&self.origins.scene));
            return None;
        };
        if let Some(second) = sensors.next() {
            self.log.warn(&second.location, "only the first <sensor> takes a picture");
        }
        self.read_sensor(first)
    }

    fn read_sensor(&mut self, element: &'t Element) -> Option<Sensor> {
        let plugin = self.plugin(element);
        self.origins.camera = plugin.location().clone();
        let projection = match plugin.kind {
            "perspective" => self.perspective(&plugin),
            "orthographic" => Projection::Orthographic,
            "thinlens" => self.thin_lens(&plugin),
            kind if SENSORS_LATER.contains(&kind) => {
                self.log.error(plugin.location(), format!("sensor \"{kind}\" cannot be rendered yet"));
                return None;
            }
            _ => {
                self.unknown_kind(&plugin, &[&["perspective", "thinlens", "orthographic"], SENSORS_LATER]);
                return None;
            }
        };
        let to_world = plugin.transform("to_world");
        plugin.ignore(&["near_clip", "far_clip", "focus_distance", "shutter_open", "shutter_close", "srf"]);
        let film = self.film(plugin.only_object("film"));
        let sample_count = plugin.only_object("sampler").and_then(|sampler| self.sample_count(sampler));
        let medium = self.surroundings(&plugin);
        plugin.finish();
        let camera = Camera { to_world, projection, medium };
        Some(Sensor { camera, film, sample_count, is_missing: false })
    }

    /// A perspective camera with a lens. As in Mitsuba, the lens must have a radius, and what is in focus
    /// by default is the far clipping plane.
    fn thin_lens(&self, plugin: &Plugin<'t>) -> Projection {
        let far_clip = plugin.float("far_clip", 1e4);
        let focus_distance = plugin.positive("focus_distance", far_clip);
        let aperture_radius = plugin.optional_float("aperture_radius");
        match (aperture_radius, plugin.property("aperture_radius")) {
            (None, None) => {
                let message =
                    Diagnostic::error(plugin.location(), "a \"thinlens\" needs an \"aperture_radius\"");
                self.log.push(message.hint(
                    "write <float name=\"aperture_radius\" value=\"…\"/>, the radius of the lens in units of \
                     the scene; 0 makes all sharp",
                ));
            }
            (Some(radius), Some(property)) if radius < 0.0 => {
                let message = format!("\"aperture_radius\" must be zero or more, not {radius}");
                self.log.error(&property.location, message);
            }
            _ => {}
        }
        let aperture_radius = aperture_radius.unwrap_or(0.0).max(0.0);
        match self.perspective(plugin) {
            Projection::Perspective { fov_deg, fov_axis, principal_point_offset } => Projection::ThinLens {
                fov_deg,
                fov_axis,
                principal_point_offset,
                aperture_radius,
                focus_distance,
            },
            other => other,
        }
    }

    fn perspective(&self, plugin: &Plugin<'t>) -> Projection {
        let (fov_deg, fov_axis, principal_point_offset) = self.opening(plugin);
        Projection::Perspective { fov_deg, fov_axis, principal_point_offset }
    }

    /// The angle of a frustum, what it spans, and the offset of the principal point.
    pub(super) fn opening(&self, plugin: &Plugin<'t>) -> (f32, FovAxis, Vec2) {
        let axes = [
            ("x", FovAxis::X),
            ("y", FovAxis::Y),
            ("diagonal", FovAxis::Diagonal),
            ("smaller", FovAxis::Smaller),
            ("larger", FovAxis::Larger),
        ];
        let mut fov_axis = plugin.choice("fov_axis", FovAxis::X, &axes);
        let focal_length = plugin.text("focal_length");
        let fov_deg = match plugin.optional_float("fov") {
            Some(fov) if fov > 0.0 && fov < 180.0 => {
                if let Some((_, at)) = focal_length {
                    self.log.error(at, "give either \"fov\" or \"focal_length\"");
                }
                fov
            }
            Some(fov) => {
                if let Some(property) = plugin.property("fov") {
                    let message = format!("\"fov\" must be between 0 and 180 degrees, not {fov}");
                    self.log.error(&property.location, message);
                }
                90.0
            }
            None => {
                fov_axis = FovAxis::Diagonal;
                diagonal_fov_deg(self.focal_length_mm(plugin))
            }
        };
        let offset = Vec2::new(
            plugin.float("principal_point_offset_x", 0.0),
            plugin.float("principal_point_offset_y", 0.0),
        );
        (fov_deg, fov_axis, offset)
    }

    fn focal_length_mm(&self, plugin: &Plugin<'t>) -> f64 {
        let Some((text, at)) = plugin.text("focal_length") else { return 50.0 };
        match crate::number::float(text.trim().trim_end_matches("mm")) {
            Ok(length) if length > 0.0 => length,
            _ => {
                let message = Diagnostic::error(at, format!("\"{text}\" is not a focal length"));
                self.log.push(message.hint("write millimetres, as in \"50mm\""));
                50.0
            }
        }
    }

    fn film(&self, element: Option<&'t Element>) -> FilmSettings {
        let standard =
            FilmSettings { width: 768, height: 576, crop: None, filter: Filter::Gaussian { std_dev: 0.5 } };
        let Some(element) = element else { return standard };
        let plugin = self.plugin(element);
        match plugin.kind {
            "hdrfilm" | "ldrfilm" => {}
            kind if FILMS_LATER.contains(&kind) => {
                let message = format!("film \"{kind}\" cannot be had yet; \"hdrfilm\" stands for it");
                self.log.warn(plugin.location(), message);
            }
            _ => self.unknown_kind(&plugin, &[&["hdrfilm", "ldrfilm"], FILMS_LATER]),
        }
        let width = plugin.integer_within("width", standard.width, 1..=MAX_SIDE);
        let height = plugin.integer_within("height", standard.height, 1..=MAX_SIDE);
        let crop = self.crop(&plugin, width, height);
        let filter = plugin.only_object("rfilter").map_or(standard.filter, |rfilter| self.filter(rfilter));
        plugin.ignore(&["file_format", "pixel_format", "component_format", "sample_border", "compensate"]);
        plugin.ignore(&["banner", "high_quality_edges", "gamma"]);
        plugin.finish();
        FilmSettings { width, height, crop, filter }
    }

    fn crop(&self, plugin: &Plugin<'t>, width: u32, height: u32) -> Option<Crop> {
        let crop = Crop {
            x: plugin.integer_within("crop_offset_x", 0, 0..=MAX_SIDE),
            y: plugin.integer_within("crop_offset_y", 0, 0..=MAX_SIDE),
            width: plugin.integer_within("crop_width", width, 1..=MAX_SIDE),
            height: plugin.integer_within("crop_height", height, 1..=MAX_SIDE),
        };
        if crop == (Crop { x: 0, y: 0, width, height }) {
            return None;
        }
        if crop.x + crop.width > width || crop.y + crop.height > height {
            let message = format!(
                "the crop window ({}, {}) + {}×{} leaves the {width}×{height} picture",
                crop.x, crop.y, crop.width, crop.height
            );
            self.log.error(plugin.location(), message);
            return None;
        }
        Some(crop)
    }

    fn filter(&self, element: &'t Element) -> Filter {
        let plugin = self.plugin(element);
        let filter = match plugin.kind {
            "box" => Filter::Box,
            "tent" => Filter::Tent { radius: plugin.positive("radius", 1.0) },
            "gaussian" => Filter::Gaussian { std_dev: plugin.positive("stddev", 0.5) },
            "mitchell" => {
                Filter::Mitchell { b: plugin.float("B", 1.0 / 3.0), c: plugin.float("C", 1.0 / 3.0) }
            }
            kind => {
                if FILTERS_LATER.contains(&kind) {
                    let message = format!("rfilter \"{kind}\" cannot be had yet; \"gaussian\" stands for it");
                    self.log.warn(plugin.location(), message);
                } else {
                    self.unknown_kind(&plugin, &[&["box", "tent", "gaussian", "mitchell"], FILTERS_LATER]);
                }
                plugin.finish_approximated();
                return Filter::Gaussian { std_dev: 0.5 };
            }
        };
        plugin.ignore(&["radius"]);
        plugin.finish();
        filter
    }

    fn sample_count(&self, element: &'t Element) -> Option<u32> {
        let plugin = self.plugin(element);
        if !SAMPLERS.contains(&plugin.kind) {
            self.unknown_kind(&plugin, &[SAMPLERS]);
        }
        let count = plugin.integer_within("sample_count", 4, 1..=u32::MAX);
        plugin.ignore(&["seed"]);
        plugin.finish_approximated();
        plugin.has("sample_count").then_some(count)
    }
}

/// The angle that the diagonal of a 35 mm film (36 mm × 24 mm) sees.
fn diagonal_fov_deg(focal_length_mm: f64) -> f32 {
    let half = (36.0f64 * 36.0 + 24.0 * 24.0).sqrt() / (2.0 * focal_length_mm);
    2.0 * nephroid::math::real::atan2(half as f32, 1.0).to_degrees()
}
