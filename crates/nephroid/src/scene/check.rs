//! What a scene must satisfy to be rendered.

use super::check_lights::check_lights;
use super::check_shapes::{check_groups, check_mesh, check_shapes};
use super::{Scene, SceneError, Subject};
use crate::camera::Projection;
use crate::color::Rgb;
use crate::film::Filter;
use crate::handle::Handle;
use crate::material;
use crate::math::Transform;
use crate::medium;
use crate::texture::{Pixmap, Texture};

/// Photons tell media apart by numbers of 16 bits, of which the last is none.
const MAX_MEDIA: usize = 65_535;

/// Longest side of a picture.
const MAX_SIDE: u32 = 65_536;

/// Every problem that can be told without building the world.
pub(crate) fn check(scene: &Scene) -> Vec<SceneError> {
    let mut problems = Problems(Vec::new());
    check_camera(scene, &mut problems);
    check_film(scene, &mut problems);
    check_textures(scene, &mut problems);
    check_materials(scene, &mut problems);
    for (i, mesh) in scene.meshes.iter().enumerate() {
        check_mesh(mesh, |message| problems.add(Subject::Mesh(i), message));
    }
    check_shapes(scene, &mut problems);
    check_groups(scene, &mut problems);
    check_lights(scene, &mut problems);
    check_media(scene, &mut problems);
    problems.0
}

pub(super) struct Problems(Vec<SceneError>);

impl Problems {
    pub fn add(&mut self, subject: Subject, message: impl Into<String>) {
        self.0.push(SceneError { subject, message: message.into() });
    }
}

fn check_camera(scene: &Scene, problems: &mut Problems) {
    if !scene.camera.to_world.is_invertible() {
        problems.add(Subject::Camera, "`to_world` cannot be undone: no axis may be scaled to zero");
    }
    if let Projection::Perspective { fov_deg, principal_point_offset, .. }
    | Projection::ThinLens { fov_deg, principal_point_offset, .. } = scene.camera.projection
    {
        if !(fov_deg > 0.0 && fov_deg < 180.0) {
            problems.add(
                Subject::Camera,
                format!("a field of view of {fov_deg} degrees: write one between 0 and 180"),
            );
        }
        if !principal_point_offset.is_finite() {
            problems.add(Subject::Camera, "the principal point's offset must be finite");
        }
    }
    if let Projection::ThinLens { aperture_radius, focus_distance, .. } = scene.camera.projection {
        if !(aperture_radius >= 0.0 && aperture_radius.is_finite()) {
            problems.add(
                Subject::Camera,
                format!("a lens of radius {aperture_radius}: write a number from 0 (all is sharp) upwards"),
            );
        }
        positive(focus_distance, "distance in focus", Subject::Camera, problems);
    }
}

fn check_film(scene: &Scene, problems: &mut Problems) {
    let film = scene.film;
    let sides = [film.width, film.height];
    if sides.iter().any(|s| !(1..=MAX_SIDE).contains(s)) {
        let message =
            format!("{} by {} pixels: each side must be between 1 and {MAX_SIDE}", film.width, film.height);
        problems.add(Subject::Film, message);
    }
    if let Some(crop) = film.crop {
        let fits = |start: u32, length: u32, whole: u32| {
            length > 0 && start.checked_add(length).is_some_and(|end| end <= whole)
        };
        if !fits(crop.x, crop.width, film.width) || !fits(crop.y, crop.height, film.height) {
            problems.add(Subject::Film, "the crop window is empty or reaches beyond the picture");
        }
    }
    let sound = match film.filter {
        Filter::Box => true,
        Filter::Tent { radius } => radius > 0.0 && radius.is_finite(),
        Filter::Gaussian { std_dev } => std_dev > 0.0 && std_dev.is_finite(),
        Filter::Mitchell { b, c } => b.is_finite() && c.is_finite(),
    };
    if !sound {
        problems.add(Subject::Film, "the reconstruction filter's size must be positive and finite");
    }
}

/// No texture asks more others for the colour of a point, however they refer to one another.
const MOST_LOOKUPS: u64 = 1000;

fn check_textures(scene: &Scene, problems: &mut Problems) {
    for (i, image) in scene.textures.images.iter().enumerate() {
        let subject = Subject::Image(i);
        let size = u64::from(image.width) * u64::from(image.height);
        let of_alpha = image.alpha.as_ref().map_or(size, |plane| plane.len() as u64);
        if image.pixels.is_empty() || image.pixels.len() as u64 != size || of_alpha != size {
            problems.add(subject, "the image is empty or its size does not fit its pixels");
        }
        let bad = image.pixels.iter().filter(|p| !p.is_finite()).count();
        if bad > 0 {
            problems.add(subject, format!("{bad} pixels are infinite or not a number"));
        }
    }
    let mut lookups: Vec<u64> = Vec::new();
    for (i, texture) in scene.textures.list.iter().enumerate() {
        let sound = match texture {
            Texture::Constant(value) => value.is_finite(),
            Texture::Bitmap(b) => scene.textures.images.contains(b.image) && b.to_uv.is_finite(),
            Texture::Checkerboard(c) => c.to_uv.is_finite(),
            Texture::Channel { channel, .. } => *channel <= 3,
            Texture::VertexColor | Texture::Scale { .. } | Texture::Mix { .. } => true,
        };
        if !sound || texture.children().any(|child| child.index() >= i) {
            problems.add(
                Subject::Texture(i),
                "its values must be finite, and what it refers to must come before it",
            );
        }
        let own = texture
            .children()
            .map(|child| lookups.get(child.index()).copied().unwrap_or(0))
            .fold(1, u64::saturating_add);
        // What refers to it has as many, and is not told again.
        if own > MOST_LOOKUPS {
            problems.add(
                Subject::Texture(i),
                format!("it asks {own} textures for one colour; at most {MOST_LOOKUPS} are possible"),
            );
        }
        lookups.push(if own > MOST_LOOKUPS { 0 } else { own });
    }
}

fn check_materials(scene: &Scene, problems: &mut Problems) {
    for (handle, _) in scene.materials.iter_handles() {
        for message in material::check(&scene.materials, handle, &scene.textures) {
            problems.add(Subject::Material(handle.index()), message);
        }
    }
}

/// Grids, media, and what refers to media.
fn check_media(scene: &Scene, problems: &mut Problems) {
    let media = &scene.media;
    if media.list.len() > MAX_MEDIA {
        let message = format!("{} media: at most {MAX_MEDIA} can be told apart", media.list.len());
        problems.add(Subject::Medium(MAX_MEDIA), message);
    }
    let grids = media.grids.iter().map(medium::check_grid);
    let list = media.list.iter().map(|each| medium::check_medium(media, each));
    let shapes = scene.all_shapes().map(|shape| medium::check_boundary(media, &shape.boundary));
    let lights = scene.lights.iter().map(|light| medium::check_start(media, light.medium));
    let camera = medium::check_start(media, scene.camera.medium);
    let found = (grids.enumerate().map(|(i, list)| (Subject::Grid(i), list)))
        .chain(list.enumerate().map(|(i, list)| (Subject::Medium(i), list)))
        .chain(shapes.enumerate().map(|(i, list)| (Subject::Shape(i), list)))
        .chain(lights.enumerate().map(|(i, list)| (Subject::Light(i), list)))
        .chain([(Subject::Camera, camera)]);
    for (subject, list) in found {
        for message in list {
            problems.add(subject, message);
        }
    }
}

pub(super) fn check_emission(
    scene: &Scene,
    emission: Handle<Texture>,
    subject: Subject,
    problems: &mut Problems,
) {
    if !scene.textures.list.contains(emission) {
        problems.add(subject, "the texture of its light does not exist");
        return;
    }
    for texture in reached(scene, emission) {
        check_emitted(scene, texture, subject, problems);
    }
}

/// A texture and all that it refers to, each once. Only what comes before: a cycle is a problem of the texture's own.
fn reached(scene: &Scene, texture: Handle<Texture>) -> Vec<Handle<Texture>> {
    let mut found = vec![texture];
    let mut next = 0;
    while let Some(&one) = found.get(next) {
        next += 1;
        for child in scene.textures.list[one].children() {
            if child.index() < one.index() && !found.contains(&child) {
                found.push(child);
            }
        }
    }
    found
}

fn check_emitted(scene: &Scene, emission: Handle<Texture>, subject: Subject, problems: &mut Problems) {
    match &scene.textures.list[emission] {
        Texture::Constant(value) => check_light_value(*value, "radiance", subject, problems),
        Texture::Bitmap(bitmap) => {
            let images = &scene.textures.images;
            if images.contains(bitmap.image) && is_negative(&images[bitmap.image]) {
                problems.add(subject, "a pixel of its light's texture is negative: light cannot be");
            }
        }
        Texture::VertexColor => {
            problems.add(subject, "the colours of vertices cannot be light: give the light a bitmap");
        }
        Texture::Checkerboard(_) | Texture::Scale { .. } | Texture::Mix { .. } | Texture::Channel { .. } => {}
    }
}

/// Whether any pixel has a negative channel.
pub(super) fn is_negative(image: &Pixmap) -> bool {
    image.pixels.iter().any(|p| p.min_channel() < 0.0)
}

pub(super) fn check_transform(transform: &Transform, subject: Subject, problems: &mut Problems) {
    if !transform.is_invertible() {
        problems.add(
            subject,
            "`to_world` is singular or not finite: no axis may be scaled to zero, and every number must be finite",
        );
    }
}

pub(super) fn check_light_value(value: Rgb, name: &str, subject: Subject, problems: &mut Problems) {
    if !(value.is_finite() && value.min_channel() >= 0.0) {
        let [r, g, b] = value.to_array();
        problems.add(
            subject,
            format!("a {name} of ({r}, {g}, {b}): every channel must be finite and not negative"),
        );
    }
}

pub(super) fn positive(value: f32, name: &str, subject: Subject, problems: &mut Problems) {
    if !(value > 0.0 && value.is_finite()) {
        problems.add(subject, format!("a {name} of {value}: write a positive number"));
    }
}

pub(super) fn finite(is_finite: bool, name: &str, subject: Subject, problems: &mut Problems) {
    if !is_finite {
        problems.add(subject, format!("its {name} must be finite"));
    }
}
