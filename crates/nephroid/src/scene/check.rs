//! What a scene must satisfy to be rendered.

use super::check_lights::check_lights;
use super::{Scene, SceneError, Subject};
use crate::camera::Projection;
use crate::color::Rgb;
use crate::film::Filter;
use crate::handle::Handle;
use crate::material::{self, Material};
use crate::math::Transform;
use crate::medium;
use crate::shape::{Geometry, Mesh, Shape};
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

fn is_masked(scene: &Scene, shape: &Shape) -> bool {
    scene.materials.contains(shape.material)
        && matches!(scene.materials[shape.material], Material::Mask { .. })
}

fn check_mesh(mesh: &Mesh, mut problem: impl FnMut(&'static str)) {
    let n = mesh.positions.len();
    if mesh.triangles.is_empty() {
        problem("the mesh has no triangle");
    }
    if !mesh.positions.iter().all(|p| p.is_finite()) {
        problem("a vertex position is infinite or not a number");
    }
    if mesh.triangles.iter().flatten().any(|&i| i as usize >= n) {
        problem("a triangle refers to a vertex that does not exist");
    }
    for (length, name) in [
        (mesh.normals.len(), "the mesh must have a normal for each vertex or none"),
        (mesh.uvs.len(), "the mesh must have a texture coordinate for each vertex or none"),
        (mesh.colors.len(), "the mesh must have a colour for each vertex or none"),
    ] {
        if length != 0 && length != n {
            problem(name);
        }
    }
    if !mesh.normals.iter().all(|v| v.is_finite()) || !mesh.uvs.iter().all(|v| v.is_finite()) {
        problem("a vertex normal or texture coordinate is infinite or not a number");
    }
    if !mesh.colors.iter().all(|c| c.is_finite()) {
        problem("a vertex colour is infinite or not a number");
    }
}

fn check_shapes(scene: &Scene, problems: &mut Problems) {
    let grouped = scene.groups.iter().flat_map(|group| &group.shapes);
    for (i, shape) in scene.shapes.iter().chain(grouped).enumerate() {
        let subject = Subject::Shape(i);
        check_transform(&shape.to_world, subject, problems);
        if !scene.materials.contains(shape.material) {
            problems.add(subject, "its material does not exist");
        }
        if shape.boundary.is_named() && is_masked(scene, shape) {
            problems.add(
                subject,
                "a masked surface bounds no medium, for nothing is crossed in its holes: put a shape of `null` material that \
                 names the media beside it",
            );
        }
        if shape.boundary.priority.is_some() {
            check_priority(scene, shape, subject, problems);
        }
        let needs_uniform_scale = match shape.geometry {
            Geometry::Sphere { center, radius } => {
                positive(radius, "radius", subject, problems);
                finite(center.is_finite(), "centre", subject, problems);
                true
            }
            Geometry::Cylinder { p0, p1, radius } => {
                positive(radius, "radius", subject, problems);
                finite(p0.is_finite() && p1.is_finite(), "axis", subject, problems);
                if p0 == p1 {
                    problems.add(subject, "the ends of the cylinder's axis coincide: it has no length");
                }
                true
            }
            Geometry::Mesh(mesh) => {
                if !scene.meshes.contains(mesh) {
                    problems.add(subject, "its mesh does not exist");
                }
                false
            }
            Geometry::Rectangle | Geometry::Disk | Geometry::Cube | Geometry::Plane => false,
        };
        if needs_uniform_scale && shape.to_world.uniform_scale().is_none() {
            problems.add(
                subject,
                "spheres and cylinders can only be scaled by the same factor on each axis: use a mesh for an ellipsoid",
            );
        }
        if let Some(emission) = shape.emission {
            if shape.geometry == Geometry::Plane {
                problems.add(subject, "an infinite plane cannot emit: its power has no end; use a rectangle");
            }
            if scene.materials.contains(shape.material)
                && matches!(scene.materials[shape.material], Material::Mask { .. })
            {
                problems.add(
                    subject,
                    "a masked shape cannot emit: give the light to a shape without a mask, and shape it by a texture of its radiance",
                );
            }
            check_emission(scene, emission, subject, problems);
        }
    }
}

/// A priority says what is inside where shapes overlap: so there must be an inside, and light must come there.
fn check_priority(scene: &Scene, shape: &Shape, subject: Subject, problems: &mut Problems) {
    if matches!(shape.geometry, Geometry::Rectangle | Geometry::Disk | Geometry::Cylinder { .. }) {
        let message = "a rectangle, a disk or a cylinder, which has no caps, encloses nothing and has no \
                       priority: use a closed shape";
        problems.add(subject, message);
    }
    let is_clear = |material: &Material| match *material {
        Material::Dielectric { .. } | Material::Null => true,
        Material::Dispersive { inside, .. } => {
            scene.materials.contains(inside) && matches!(scene.materials[inside], Material::Dielectric { .. })
        }
        _ => false,
    };
    if scene.materials.contains(shape.material) && !is_clear(&scene.materials[shape.material]) {
        let message = "only what light goes into has a priority: make it a smooth dielectric or `null`, or take \
                       the priority away";
        problems.add(subject, message);
    }
    if shape.emission.is_some() {
        problems.add(subject, "a lamp has no priority: put a lamp without one in its place");
    }
}

fn check_groups(scene: &Scene, problems: &mut Problems) {
    let mut first = scene.shapes.len();
    for (i, group) in scene.groups.iter().enumerate() {
        if group.shapes.is_empty() {
            problems.add(Subject::Group(i), "the group has no shape: instances of it would show nothing");
        }
        for (j, shape) in (first..).zip(&group.shapes) {
            if shape.emission.is_some() {
                let message = "a shape of a group cannot emit light: put the lamp beside the instances";
                problems.add(Subject::Shape(j), message);
            }
            if shape.geometry == Geometry::Plane {
                let message = "an infinite plane cannot be part of a group: use a rectangle";
                problems.add(Subject::Shape(j), message);
            }
        }
        first += group.shapes.len();
    }
    for (i, instance) in scene.instances.iter().enumerate() {
        check_transform(&instance.to_world, Subject::Instance(i), problems);
        if !scene.groups.contains(instance.group) {
            problems.add(Subject::Instance(i), "its group does not exist");
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

fn positive(value: f32, name: &str, subject: Subject, problems: &mut Problems) {
    if !(value > 0.0 && value.is_finite()) {
        problems.add(subject, format!("a {name} of {value}: write a positive number"));
    }
}

pub(super) fn finite(is_finite: bool, name: &str, subject: Subject, problems: &mut Problems) {
    if !is_finite {
        problems.add(subject, format!("its {name} must be finite"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, FovAxis};
    use crate::film::FilmSettings;
    use crate::handle::Arena;
    use crate::light::{Light, LightKind};
    use crate::math::{Affine2, DVec3, Vec2, Vec3};
    use crate::medium::{Boundary, Grid, GridValues, Medium, Phase};
    use crate::shape::Group;
    use crate::texture::{Bitmap, BitmapFilter, Plane, Textures, Wrap};

    fn empty() -> Scene {
        let projection = Projection::Perspective {
            fov_deg: 40.0,
            fov_axis: FovAxis::X,
            principal_point_offset: Vec2::ZERO,
        };
        Scene {
            camera: Camera { to_world: Transform::IDENTITY, projection, medium: None },
            film: FilmSettings { width: 4, height: 4, crop: None, filter: Filter::Box },
            textures: Textures::default(),
            materials: Arena::default(),
            meshes: Arena::default(),
            shapes: Vec::new(),
            groups: Arena::default(),
            instances: Vec::new(),
            lights: Vec::new(),
            media: medium::Media::default(),
        }
    }

    fn messages(scene: &Scene) -> Vec<String> {
        check(scene).into_iter().map(|problem| problem.message).collect()
    }

    #[test]
    fn a_masked_shape_that_emits_is_refused() {
        let mut scene = empty();
        let white = scene.textures.constant(Rgb::WHITE);
        let inside = scene.materials.push(Material::Diffuse { reflectance: white });
        let material = scene.materials.push(Material::Mask { opacity: white, inside });
        let shape = Shape {
            name: String::new(),
            geometry: Geometry::Rectangle,
            to_world: Transform::IDENTITY,
            material,
            emission: Some(white),
            flip_normals: false,
            boundary: Boundary::default(),
        };
        scene.shapes.push(shape);
        assert_eq!(
            messages(&scene),
            [
                "a masked shape cannot emit: give the light to a shape without a mask, and shape it by a texture of its radiance"
            ]
        );
    }

    #[test]
    fn a_light_with_a_negative_pixel_or_a_sheared_frame_is_refused() {
        let mut scene = empty();
        let image = scene.textures.images.push(Pixmap::filled(1, 1, Rgb::splat(-1.0)));
        let bitmap =
            Bitmap { image, filter: BitmapFilter::Nearest, wrap: Wrap::Repeat, to_uv: Affine2::IDENTITY };
        let texture = scene.textures.push(Texture::Bitmap(bitmap));
        let kind = LightKind::Spot {
            to_world: Transform::scale(DVec3::new(1.0, 2.0, 1.0)),
            intensity: Rgb::WHITE,
            cutoff_deg: 20.0,
            beam_width_deg: 15.0,
            texture: Some(texture),
        };
        scene.lights.push(Light { name: "spot".into(), kind, medium: None });
        assert_eq!(
            messages(&scene),
            [
                "its `to_world` may turn, mirror and scale alike on each axis, but not stretch or shear",
                "a pixel of its light's texture is negative: light cannot be",
            ]
        );
    }

    /// A spot that shows a texture.
    fn projector(texture: Handle<Texture>) -> Light {
        let to_world = Transform::IDENTITY;
        let (cutoff_deg, beam_width_deg, intensity) = (20.0, 15.0, Rgb::WHITE);
        let texture = Some(texture);
        let kind = LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture };
        Light { name: "spot".into(), kind, medium: None }
    }

    #[test]
    fn textures_of_lights_are_looked_through() {
        let mut scene = empty();
        let t = &mut scene.textures;
        let (white, dark, own) =
            (t.constant(Rgb::WHITE), t.constant(Rgb::splat(-1.0)), t.push(Texture::VertexColor));
        let mix = t.push(Texture::Mix { weight: white, a: dark, b: own });
        let of = t.push(Texture::Scale { a: white, b: mix });
        let channel = t.push(Texture::Channel { of, channel: 2 });
        scene.lights.push(projector(channel));
        let found = messages(&scene);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            found.iter().any(|m| m == "the colours of vertices cannot be light: give the light a bitmap")
        );
    }

    #[test]
    fn textures_that_make_no_sense_or_too_much_work_are_refused() {
        let mut scene = empty();
        let white = scene.textures.constant(Rgb::WHITE);
        scene.textures.push(Texture::Channel { of: white, channel: 4 });
        let later = scene.textures.clone().push(Texture::VertexColor);
        scene.textures.push(Texture::Scale { a: white, b: later });
        let image = Pixmap { alpha: Some(Plane::Bytes(vec![0; 3])), ..Pixmap::filled(1, 2, Rgb::WHITE) };
        scene.textures.images.push(image);
        assert_eq!(
            messages(&scene),
            [
                "the image is empty or its size does not fit its pixels",
                "its values must be finite, and what it refers to must come before it",
                "its values must be finite, and what it refers to must come before it",
            ]
        );
        // Twice as much work each time.
        let mut scene = empty();
        let mut last = scene.textures.constant(Rgb::WHITE);
        for _ in 0..40 {
            last = scene.textures.push(Texture::Scale { a: last, b: last });
        }
        scene.lights.push(projector(last));
        assert!(messages(&scene)[0].starts_with("it asks 1023 textures for one colour"));
    }

    #[test]
    fn media_that_are_referred_to_exist() {
        let mut scene = empty();
        scene.media.grids.push(Grid {
            name: "smoke".into(),
            size: [1; 3],
            values: GridValues::Grey(vec![-1.0]),
        });
        let fog = Medium::homogeneous("fog", Rgb::splat(-1.0), Rgb::BLACK, Phase::Isotropic);
        let (mut other, known) = (Arena::default(), scene.media.list.push(fog.clone()));
        let missing = [other.push(fog.clone()), other.push(fog)][1];
        scene.camera.medium = Some(missing);
        let kind = LightKind::Point { position: Vec3::ZERO, intensity: Rgb::WHITE };
        scene.lights.push(Light { name: "lamp".into(), kind, medium: Some(missing) });
        let reflectance = scene.textures.constant(Rgb::WHITE);
        let material = scene.materials.push(Material::Diffuse { reflectance });
        let shape = Shape {
            boundary: Boundary { interior: Some(missing), exterior: Some(known), ..Boundary::default() },
            ..Shape::new("ball", Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 }, material)
        };
        scene.shapes.push(shape.clone());
        scene.groups.push(Group { name: String::new(), shapes: vec![shape] });
        let found: Vec<String> = check(&scene).iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "grid 0: 1 of its 1 values are negative, infinite or not a number: each must be finite and \
                 not negative",
                "medium 0: sigma_t is -1, but must be finite and not negative in every channel",
                "shape 0: its interior medium does not exist",
                "shape 1: its interior medium does not exist",
                "light 0: the medium that it is in does not exist",
                "camera: the medium that it is in does not exist",
            ]
        );
    }

    #[test]
    fn only_closed_shapes_that_light_goes_into_have_a_priority() {
        let mut scene = empty();
        let white = scene.textures.constant(Rgb::WHITE);
        let glass = scene.materials.push(Material::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
        });
        let paper = scene.materials.push(Material::Diffuse { reflectance: white });
        let null = scene.materials.push(Material::Null);
        let ball = Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 };
        let boundary = Boundary { priority: Some(0), ..Boundary::default() };
        let shape =
            |geometry: &Geometry, material| Shape { boundary, ..Shape::new("s", geometry.clone(), material) };
        scene.shapes.extend([glass, null].map(|material| shape(&ball, material)));
        assert!(messages(&scene).is_empty());
        scene.shapes = vec![
            shape(&Geometry::Rectangle, glass),
            shape(&ball, paper),
            Shape { emission: Some(white), ..shape(&Geometry::Cube, null) },
        ];
        assert_eq!(
            messages(&scene),
            [
                "a rectangle, a disk or a cylinder, which has no caps, encloses nothing and has no priority: use \
                 a closed shape",
                "only what light goes into has a priority: make it a smooth dielectric or `null`, or take the \
                 priority away",
                "a lamp has no priority: put a lamp without one in its place",
            ]
        );
    }

    #[test]
    fn a_lens_has_a_radius_and_a_distance_in_focus() {
        let mut scene = empty();
        let thin_lens = |aperture_radius, focus_distance| Projection::ThinLens {
            fov_deg: 200.0,
            fov_axis: FovAxis::X,
            principal_point_offset: Vec2::ZERO,
            aperture_radius,
            focus_distance,
        };
        scene.camera.projection = thin_lens(-1.0, 0.0);
        assert_eq!(
            messages(&scene),
            [
                "a field of view of 200 degrees: write one between 0 and 180",
                "a lens of radius -1: write a number from 0 (all is sharp) upwards",
                "a distance in focus of 0: write a positive number",
            ]
        );
        scene.camera.projection = thin_lens(f32::NAN, f32::INFINITY);
        assert_eq!(messages(&scene).len(), 3);
    }

    #[test]
    fn fields_of_view_and_crops_outside_the_picture_are_refused() {
        let mut scene = empty();
        assert!(messages(&scene).is_empty());
        scene.film.crop = Some(crate::film::Crop { x: 3, y: 0, width: 2, height: 1 });
        if let Projection::Perspective { fov_deg, .. } = &mut scene.camera.projection {
            *fov_deg = 180.0;
        }
        assert_eq!(
            messages(&scene),
            [
                "a field of view of 180 degrees: write one between 0 and 180",
                "the crop window is empty or reaches beyond the picture",
            ]
        );
    }
}
