//! The integrator, the camera and the film.

use nephroid::camera::{FovAxis, Projection};
use nephroid::film::Filter;
use nephroid::math::Vec2;

use super::Writer;
use super::lights::axis_name;
use crate::integrator_request::{IntegratorRequest, ParameterValue};

/// Integrators that Mitsuba 3 has, too.
const INTEGRATORS: [&str; 5] = ["path", "volpath", "volpathmis", "direct", "ptracer"];

impl Writer<'_, '_> {
    /// The scene's integrator if Mitsuba has it, else a path tracer.
    pub(super) fn integrator(&mut self, request: &IntegratorRequest) {
        let name = request.name.as_str();
        let kind = match (INTEGRATORS.contains(&name), self.scene.has_media()) {
            (true, _) => name,
            (false, true) => "volpath",
            (false, false) => "path",
        };
        if !name.is_empty() && kind != name {
            self.warn(format!("Mitsuba has no integrator \"{name}\": \"{kind}\" stands for it"));
        }
        let depth = request.parameters.iter().find(|p| p.name == "max_depth").map(|p| &p.value);
        match depth {
            Some(ParameterValue::Int(depth)) if kind != "direct" => {
                let depth = depth.to_string();
                self.xml.open("integrator", &[("type", kind)]);
                self.xml.leaf("integer", &[("name", "max_depth"), ("value", &depth)]);
                self.xml.close();
            }
            _ => self.xml.bare_plugin("integrator", kind),
        }
    }

    pub(super) fn sensor(&mut self, sample_count: Option<u32>) {
        let camera = &self.scene.camera;
        let kind = match camera.projection {
            Projection::Perspective { .. } => "perspective",
            Projection::ThinLens { .. } => "thinlens",
            Projection::Orthographic => "orthographic",
        };
        self.xml.plugin("sensor", kind, "");
        self.xml.transform("to_world", &camera.to_world);
        match camera.projection {
            Projection::Perspective { fov_deg, fov_axis, principal_point_offset } => {
                self.angle(fov_deg, fov_axis, principal_point_offset);
            }
            Projection::ThinLens {
                fov_deg,
                fov_axis,
                principal_point_offset,
                aperture_radius,
                focus_distance,
            } => {
                self.angle(fov_deg, fov_axis, principal_point_offset);
                self.xml.float("aperture_radius", aperture_radius);
                self.xml.float("focus_distance", focus_distance);
            }
            Projection::Orthographic => {}
        }
        if let Some(medium) = camera.medium {
            self.xml.reference("", &self.media[medium.index()]);
        }
        if let Some(count) = sample_count {
            self.xml.plugin("sampler", "independent", "");
            self.xml.integer("sample_count", count);
            self.xml.close();
        }
        self.film();
        self.xml.close();
    }

    fn angle(&mut self, fov_deg: f32, axis: FovAxis, offset: Vec2) {
        self.xml.float("fov", fov_deg);
        self.xml.string("fov_axis", axis_name(axis));
        if offset != Vec2::ZERO {
            self.xml.float("principal_point_offset_x", offset.x);
            self.xml.float("principal_point_offset_y", offset.y);
        }
    }

    fn film(&mut self) {
        let film = self.scene.film;
        self.xml.plugin("film", "hdrfilm", "");
        self.xml.integer("width", film.width);
        self.xml.integer("height", film.height);
        if let Some(crop) = film.crop {
            self.xml.integer("crop_offset_x", crop.x);
            self.xml.integer("crop_offset_y", crop.y);
            self.xml.integer("crop_width", crop.width);
            self.xml.integer("crop_height", crop.height);
        }
        self.xml.string("pixel_format", "rgb");
        let parameters: Vec<(&str, f32)> = match film.filter {
            Filter::Box => Vec::new(),
            Filter::Tent { radius } => vec![("radius", radius)],
            Filter::Gaussian { std_dev } => vec![("stddev", std_dev)],
            Filter::Mitchell { b, c } => vec![("B", b), ("C", c)],
        };
        self.xml.plugin("rfilter", film.filter.name(), "");
        for (name, value) in parameters {
            self.xml.float(name, value);
        }
        self.xml.close();
        self.xml.close();
    }
}
