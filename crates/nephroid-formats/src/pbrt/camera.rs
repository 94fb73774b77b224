//! What stands before the world: camera, film, filter, sampler.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::film::{Crop, Filter};
use nephroid::math::real::{atan2, tan};
use nephroid::math::{DVec3, Transform, Vec2};

use super::parameter::Parameter;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Location};

/// Longest side of a picture in pixels.
const MAX_SIDE: u32 = 65_536;

const CAMERAS: &[&str] = &["perspective", "orthographic"];
const CAMERAS_LATER: &[&str] = &["realistic", "spherical", "environment"];
const FILMS: &[&str] = &["rgb"];
const FILMS_LATER: &[&str] = &["gbuffer", "spectral", "image"];
const FILTERS: &[&str] = &["box", "gaussian", "mitchell", "triangle", "sinc"];

impl Reader<'_> {
    /// One of the things that a scene has once, before its world.
    pub(super) fn option_block(
        &mut self,
        directive: &'static str,
        kind: String,
        at: Location,
        list: Vec<Parameter>,
    ) {
        if self.in_world {
            self.log.error(&at, format!("{directive} belongs before WorldBegin"));
            return;
        }
        if let Some(first) = self.given.insert(directive, at.clone()) {
            let message = Diagnostic::warning(&first, format!("another {directive} follows, and counts"));
            self.log.push(message);
        }
        match directive {
            "Camera" => self.camera(&self.plain("camera", kind, at, list)),
            "Film" => self.film(&self.plain("film", kind, at, list)),
            "PixelFilter" => self.filter(&self.plain("filter", kind, at, list)),
            "Sampler" => self.sampler(&self.plain("sampler", kind, at, list)),
            "Integrator" => self.integrator(&self.plain("integrator", kind, at, list)),
            "SurfaceIntegrator" => {
                self.log.warn(&at, "\"SurfaceIntegrator\" is of older files; write Integrator");
                self.integrator(&self.plain("integrator", kind, at, list));
            }
            // How rays are traced is this renderer's own business.
            "Accelerator" => {}
            _ => self.log.warn(&at, format!("\"{directive}\" is of older files, and means nothing here")),
        }
    }

    fn camera(&mut self, parameters: &Parameters) {
        self.origins.camera = parameters.at.clone();
        let medium = self.state.outside;
        if !CAMERAS.contains(&parameters.kind.as_str()) {
            if CAMERAS_LATER.contains(&parameters.kind.as_str()) {
                let message = format!("camera \"{}\" cannot be rendered yet", parameters.kind);
                self.log.error(&parameters.at, message);
            } else {
                self.unknown_kind(parameters, &[CAMERAS, CAMERAS_LATER]);
            }
            return;
        }
        if !self.state.ctm.is_invertible() {
            self.log.error(&parameters.at, "the place of the camera cannot be told: its transform overflows");
            return;
        }
        let to_world = self.state.ctm.inverse();
        self.coordinate_systems.insert("camera".into(), (to_world, false));
        // What is right of the picture has positive x in pbrt, and negative x here.
        let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
        let window = Window::new(parameters, self);
        let (projection, placed) = if parameters.kind == "perspective" {
            (self.perspective(parameters, &window), mirror)
        } else {
            parameters.ignore(&["focaldistance"]);
            if parameters.not_negative("lensradius", 0.0) > 0.0 {
                let message = "an orthographic camera has no lens yet: all is sharp";
                self.log.warn(&parameters.at, message);
            }
            // Here half the width is one.
            let size = Transform::scale(DVec3::splat(window.half_width));
            let shift = Transform::translate(DVec3::new(window.center[0], window.center[1], 0.0));
            (Projection::Orthographic, size.then(mirror).then(shift))
        };
        let (open, close) = (parameters.float("shutteropen", 0.0), parameters.float("shutterclose", 1.0));
        parameters.finish();
        if close > open {
            self.exposure *= (close - open) as f32;
        } else {
            self.log.error(&parameters.at, "\"shutterclose\" must be later than \"shutteropen\"");
        }
        self.camera = Some(Camera { to_world: placed.then(to_world), projection, medium });
    }

    fn perspective(&self, parameters: &Parameters, window: &Window) -> Projection {
        let fov =
            parameters.float_that("fov", 90.0, "between 0 and 180 degrees", |fov| fov > 0.0 && fov < 180.0);
        let aperture_radius = parameters.not_negative("lensradius", 0.0) as f32;
        let focus_distance = parameters.positive("focaldistance", 1e6) as f32;
        let (fov_deg, fov_axis, principal_point_offset) = if window.is_plain {
            (fov as f32, FovAxis::Smaller, Vec2::ZERO)
        } else {
            let half = tan((0.5 * fov as f32).to_radians()) * window.half_width as f32;
            (2.0 * atan2(half, 1.0).to_degrees(), FovAxis::X, window.offset())
        };
        if aperture_radius > 0.0 {
            let (radius, distance) = (aperture_radius, focus_distance);
            Projection::ThinLens {
                fov_deg,
                fov_axis,
                principal_point_offset,
                aperture_radius: radius,
                focus_distance: distance,
            }
        } else {
            Projection::Perspective { fov_deg, fov_axis, principal_point_offset }
        }
    }

    fn film(&mut self, parameters: &Parameters) {
        match parameters.kind.as_str() {
            kind if FILMS.contains(&kind) => {}
            kind if FILMS_LATER.contains(&kind) => {
                let message = format!("film \"{kind}\" cannot be had yet; \"rgb\" stands for it");
                self.log.warn(&parameters.at, message);
            }
            _ => self.unknown_kind(parameters, &[FILMS, FILMS_LATER]),
        }
        self.film.width = parameters.integer("xresolution", 1280, 1..=MAX_SIDE);
        self.film.height = parameters.integer("yresolution", 720, 1..=MAX_SIDE);
        self.film.crop = self.crop(parameters);
        self.exposure *= (parameters.positive("iso", 100.0) / 100.0) as f32;
        for (name, meaning) in [
            ("sensor", "all pictures are as the standard observer sees them"),
            ("whitebalance", "white is not balanced"),
            ("maxcomponentvalue", "no sample is made darker"),
            ("maxsampleluminance", "no sample is made darker"),
        ] {
            if let Some(found) = parameters.any(name)
                && !matches!(found.value_at.text(), "cie1931")
            {
                self.log.warn(&found.location, format!("\"{name}\" cannot be had yet: {meaning}"));
            }
        }
        // Names and formats of files are the command's business; 35 mm matter to cameras with lenses only.
        parameters.ignore(&["filename", "savefp16", "diagonal", "coordinatesystem", "scale"]);
        parameters.finish();
    }

    fn crop(&self, parameters: &Parameters) -> Option<Crop> {
        let (width, height) = (self.film.width, self.film.height);
        let bounds = parameters.four("pixelbounds");
        let window = parameters.four("cropwindow");
        let ([x0, x1, y0, y1], at) = match (window, bounds) {
            (Some(([x0, x1, y0, y1], at)), _) => {
                let place = |v: f64, size: u32| (v.clamp(0.0, 1.0) * f64::from(size)).ceil();
                let (x, y) = ((x0.min(x1), x0.max(x1)), (y0.min(y1), y0.max(y1)));
                ([place(x.0, width), place(x.1, width), place(y.0, height), place(y.1, height)], at)
            }
            (None, Some(([x0, x1, y0, y1], at))) => {
                let place = |v: f64, size: u32| v.floor().clamp(0.0, f64::from(size));
                ([place(x0, width), place(x1, width), place(y0, height), place(y1, height)], at)
            }
            (None, None) => return None,
        };
        if x1 <= x0 || y1 <= y0 {
            self.log.error(at, "nothing is left of the picture");
            return None;
        }
        let crop = Crop { x: x0 as u32, y: y0 as u32, width: (x1 - x0) as u32, height: (y1 - y0) as u32 };
        (crop != Crop { x: 0, y: 0, width, height }).then_some(crop)
    }

    fn filter(&mut self, parameters: &Parameters) {
        // The former are of older files.
        let name = if parameters.has("xwidth") { "xwidth" } else { "xradius" };
        let radius = |default: f64| parameters.positive(name, default);
        self.filter = match parameters.kind.as_str() {
            "box" => {
                if radius(0.5) != 0.5 {
                    self.log.warn(&parameters.at, "a box is one pixel wide here");
                }
                Filter::Box
            }
            "triangle" => Filter::Tent { radius: radius(2.0) as f32 },
            "gaussian" => {
                // What the third version of pbrt says of the width: α of exp(−α x²).
                let width = (0.5 / parameters.positive("alpha", 2.0)).sqrt();
                Filter::Gaussian { std_dev: parameters.positive("sigma", width) as f32 }
            }
            "mitchell" => Filter::Mitchell {
                b: parameters.float("B", 1.0 / 3.0) as f32,
                c: parameters.float("C", 1.0 / 3.0) as f32,
            },
            "sinc" => {
                self.log
                    .warn(&parameters.at, "filter \"sinc\" cannot be had yet; \"mitchell\" stands for it");
                parameters.finish_approximated();
                self.filter = Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
                return;
            }
            _ => {
                self.unknown_kind(parameters, &[FILTERS]);
                return;
            }
        };
        // Filters are as wide as high, and those with long tails have them.
        parameters.ignore(&["xradius", "yradius", "xwidth", "ywidth"]);
        parameters.finish();
    }
}

/// The part of the plane at distance one, in tangents of half the field of view, that is the picture.
struct Window {
    half_width: f64,
    half_height: f64,
    center: [f64; 2],
    /// Whether the shorter side is two long and all is in the middle, as it is where nothing is said.
    is_plain: bool,
}

impl Window {
    fn new(parameters: &Parameters, reader: &Reader) -> Self {
        let own = f64::from(reader.film.width) / f64::from(reader.film.height);
        let aspect = parameters.positive("frameaspectratio", own);
        let (mut half_width, mut half_height) =
            if aspect > 1.0 { (aspect, 1.0) } else { (1.0, 1.0 / aspect) };
        let mut center = [0.0; 2];
        if let Some(([x0, x1, y0, y1], at)) = parameters.four("screenwindow") {
            if x1 > x0 && y1 > y0 {
                (half_width, half_height) = (0.5 * (x1 - x0), 0.5 * (y1 - y0));
                center = [0.5 * (x0 + x1), 0.5 * (y0 + y1)];
            } else {
                reader.log.error(at, "the window is empty: it is left, right, lower and upper");
            }
        }
        let is_plain = !parameters.has("screenwindow") && !parameters.has("frameaspectratio");
        let window = Self { half_width, half_height, center, is_plain };
        if !is_plain && (half_width / half_height / own - 1.0).abs() > 1e-3 {
            let message = "the window is not as wide and high as the picture: pixels are square all the same";
            reader.log.warn(&parameters.at, message);
        }
        window
    }

    /// How far its middle is from the middle of the view, in widths and heights, right and down.
    fn offset(&self) -> Vec2 {
        let [x, y] = self.center;
        Vec2::new((0.5 * x / self.half_width) as f32, (-0.5 * y / self.half_height) as f32)
    }
}
