//! The camera.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::film::{FilmSettings, Filter};
use nephroid::math::{DVec3, Transform, Vec2};

use super::item::Item;
use super::node::{Placed, looking};
use super::reader::Reader;

/// The longer side of a picture, in pixels, where nothing says how large it is to be.
const LONGER_SIDE: f64 = 768.0;

impl<'d> Reader<'d> {
    /// The first camera that a node holds, and a film of its shape.
    pub(super) fn camera(&mut self, nodes: &[Placed<'d>]) -> Option<(Camera, FilmSettings)> {
        let mut holders = nodes.iter().filter(|placed| placed.node.has("camera"));
        let first = holders.next()?;
        let more = holders.count();
        if more > 0 {
            let used = first.node.called("node", first.index);
            self.once(
                first.node,
                &format!("the first of {} cameras takes the picture, \"{used}\"", more + 1),
            );
        }
        let (_, camera) = first.node.refers("camera", "cameras")?;
        self.origins.camera = camera.at();
        let Some(to_world) = looking(&first.to_world) else {
            first.node.error("the camera looks nowhere: a node has a scale of zero");
            return None;
        };
        match camera.text("type") {
            Some("perspective") => perspective(camera.object("perspective")?, to_world),
            Some("orthographic") => orthographic(camera.object("orthographic")?, to_world),
            _ => {
                camera.error("the \"type\" of a camera is \"perspective\" or \"orthographic\"");
                None
            }
        }
    }
}

fn perspective(camera: Item, to_world: Transform) -> Option<(Camera, FilmSettings)> {
    let Some(yfov) = camera.number("yfov").filter(|fov| *fov > 0.0 && *fov < std::f64::consts::PI) else {
        camera.error("a perspective camera needs a \"yfov\" between 0 and π");
        return None;
    };
    let aspect = camera.number("aspectRatio").unwrap_or(4.0 / 3.0);
    let projection = Projection::Perspective {
        fov_deg: yfov.to_degrees() as f32,
        fov_axis: FovAxis::Y,
        principal_point_offset: Vec2::ZERO,
    };
    Some((Camera { to_world, projection, medium: None }, film(aspect)))
}

/// `xmag` and `ymag` are half of the width and half of the height that are seen.
fn orthographic(camera: Item, to_world: Transform) -> Option<(Camera, FilmSettings)> {
    let sizes = camera.number("xmag").zip(camera.number("ymag"));
    let Some((x, y)) = sizes.filter(|(x, y)| *x != 0.0 && *y != 0.0) else {
        camera.error("an orthographic camera needs an \"xmag\" and a \"ymag\" that are not zero");
        return None;
    };
    let (x, y) = (x.abs(), y.abs());
    let to_world = Transform::scale(DVec3::new(x, x, x)).then(to_world);
    Some((Camera { to_world, projection: Projection::Orthographic, medium: None }, film(x / y)))
}

/// A film of a shape: width over height.
fn film(aspect: f64) -> FilmSettings {
    let aspect = if aspect > 0.0 { aspect.clamp(1.0 / 64.0, 64.0) } else { 1.0 };
    let side = |part: f64| (LONGER_SIDE * part).round().max(1.0) as u32;
    FilmSettings {
        width: side(aspect.min(1.0)),
        height: side((1.0 / aspect).min(1.0)),
        crop: None,
        filter: Filter::Gaussian { std_dev: 0.5 },
    }
}
