//! A camera and a sky for models that come without.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{FilmSettings, Filter};
use nephroid::light::{EnvironmentMapping, Light, LightKind};
use nephroid::math::real::{cos_deg, sin_cos, sin_deg};
use nephroid::math::{Bounds, DVec3, Transform, Vec2, Vec3};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Shape};
use nephroid::texture::{Image, Pixmap};

use crate::diagnostic::{Diagnostic, Location};
use crate::scene_file::{Origins, SceneFile};

/// Opening angle along the shorter side of the picture.
const FOV_DEG: f64 = 45.0;
/// The camera stands so far to the right of what is in front, +z, and so far above the middle.
const AZIMUTH_DEG: f64 = 30.0;
const ELEVATION_DEG: f64 = 20.0;

/// The part of the shorter side of the picture that a model reaches across.
const FILLED: f64 = 0.9;

/// What a scene was given because its file has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fitted {
    /// The camera and its film.
    pub camera: bool,
    /// The sky.
    pub sky: bool,
}

impl Fitted {
    /// One line about it for users; none if nothing was given.
    pub fn remark(self, scene: &Scene, at: &Location) -> Option<Diagnostic> {
        let eye = scene.camera.to_world.point(Vec3::ZERO);
        let camera = format!("seen from ({:.4}, {:.4}, {:.4})", eye.x, eye.y, eye.z);
        let (message, hint) = match (self.camera, self.sky) {
            (false, false) => return None,
            (true, false) => (format!("the file has no camera: it is {camera}"), "--camera gives another"),
            (false, true) => {
                ("the file has no light: it stands under a plain sky".to_owned(), "--envmap gives another")
            }
            (true, true) => (
                format!("the file has no camera and no light: it is {camera}, under a plain sky"),
                "--camera and --envmap give others",
            ),
        };
        Some(Diagnostic::warning(at, message).hint(hint))
    }
}

/// The box around all that a scene shows, infinite planes apart.
pub fn bounds(scene: &Scene) -> Bounds {
    let of = |shapes: &[Shape], to_world: &Transform| {
        shapes.iter().fold(Bounds::EMPTY, |all, shape| all.union(of_shape(scene, shape, to_world)))
    };
    let top = of(&scene.shapes, &Transform::IDENTITY);
    let groups: Vec<Bounds> =
        scene.groups.iter().map(|group| of(&group.shapes, &Transform::IDENTITY)).collect();
    scene.instances.iter().fold(top, |all, instance| {
        // The box around a turned box, not around what is in it, which may be shown a million times.
        match groups.get(instance.group.index()).filter(|bounds| !bounds.is_empty()) {
            Some(bounds) => all.union(Bounds::of(corners(bounds).map(|p| instance.to_world.point(p)))),
            None => all,
        }
    })
}

fn of_shape(scene: &Scene, shape: &Shape, to_world: &Transform) -> Bounds {
    let to_world = shape.to_world.then(*to_world);
    let cube = |center: Vec3, half: Vec3| {
        Bounds::of(corners(&Bounds { min: center - half, max: center + half }).map(|p| to_world.point(p)))
    };
    match shape.geometry {
        Geometry::Mesh(mesh) => {
            Bounds::of(scene.meshes[mesh].positions.iter().map(|position| to_world.point(*position)))
        }
        Geometry::Sphere { center, radius } => cube(center, Vec3::splat(radius)),
        Geometry::Cylinder { p0, p1, radius } => {
            cube((p0 + p1) * 0.5, (p1 - p0).abs() * 0.5 + Vec3::splat(radius))
        }
        Geometry::Rectangle | Geometry::Disk => cube(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)),
        Geometry::Cube => cube(Vec3::ZERO, Vec3::ONE),
        Geometry::Plane => Bounds::EMPTY,
    }
}

fn corners(bounds: &Bounds) -> [Vec3; 8] {
    let Bounds { min, max } = *bounds;
    std::array::from_fn(|i| {
        let side = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(side(0), side(1), side(2))
    })
}

/// A camera that sees all of a box, from the front, a bit from the right and a bit from above. `None` of an empty box.
pub fn camera(bounds: &Bounds) -> Option<Camera> {
    if bounds.is_empty() {
        return None;
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let center = (min + max) * 0.5;
    let level = cos_deg(ELEVATION_DEG);
    let towards =
        DVec3::new(level * sin_deg(AZIMUTH_DEG), sin_deg(ELEVATION_DEG), level * cos_deg(AZIMUTH_DEG));
    let turn = Transform::look_at(towards, DVec3::ZERO, DVec3::Y)?;
    // Each corner must lie between the sides of the pyramid that is seen, wherever the picture is wider.
    let slope = FILLED * sin_deg(0.5 * FOV_DEG) / cos_deg(0.5 * FOV_DEG);
    let across = |p: DVec3, axis: DVec3| (p - center).dot(axis);
    let (left, up) = (turn.0.matrix3.x_axis, turn.0.matrix3.y_axis);
    let distance = corners(bounds)
        .map(Vec3::as_dvec3)
        .into_iter()
        .map(|p| across(p, left).abs().max(across(p, up).abs()) / slope + across(p, towards))
        .fold(0.0, f64::max);
    // A single point is seen from somewhere, too.
    let distance = if distance > 0.0 { distance } else { 1.0 };
    let to_world = Transform::look_at(center + towards * distance, center, DVec3::Y)?;
    Some(Camera { to_world, projection: perspective(FOV_DEG as f32), medium: None })
}

/// A pinhole with this opening angle along the shorter side of the picture.
pub fn perspective(fov_deg: f32) -> Projection {
    Projection::Perspective { fov_deg, fov_axis: FovAxis::Smaller, principal_point_offset: Vec2::ZERO }
}

/// The film of a model that says nothing of one.
pub fn film() -> FilmSettings {
    FilmSettings { width: 768, height: 576, crop: None, filter: Filter::Gaussian { std_dev: 0.5 } }
}

/// The radiance of the plain sky: bluish above, white at the horizon, grey below, and a soft warm light from the upper
/// left of the front, so that shapes can be told. A white floor under it is about as bright as white on a display.
pub fn plain_sky() -> Image {
    const SIZE: (u32, u32) = (64, 33);
    let (zenith, horizon, ground) = (Rgb::new(0.38, 0.48, 0.65), Rgb::splat(0.6), Rgb::new(0.21, 0.2, 0.19));
    let (lamp, warm) = (Vec3::new(-0.5, 0.75, 0.6).normalize(), Rgb::new(8.0, 7.6, 6.8));
    let mut image = Image::filled(SIZE.0, SIZE.1, Rgb::BLACK);
    for y in 0..SIZE.1 {
        let (sin_theta, height) = sin_cos(std::f32::consts::PI * y as f32 / (SIZE.1 - 1) as f32);
        for x in 0..SIZE.0 {
            let (sin_phi, cos_phi) = sin_cos(2.0 * std::f32::consts::PI * (x as f32 + 0.5) / SIZE.0 as f32);
            let direction = Vec3::new(sin_theta * sin_phi, height, -sin_theta * cos_phi);
            let mut near = direction.dot(lamp).max(0.0);
            for _ in 0..5 {
                near *= near;
            }
            let back = if height >= 0.0 { horizon + (zenith - horizon) * height } else { ground };
            image.pixels[(y * SIZE.0 + x) as usize] = back + warm * near;
        }
    }
    image
}

/// Whether nothing of a scene gives light: no light, and no shape that shines.
pub fn is_dark(scene: &Scene) -> bool {
    scene.lights.is_empty() && scene.all_shapes().all(|shape| shape.emission.is_none())
}

/// Puts an image all around a scene in place of the sky that it has, or takes that away.
pub fn replace_sky(scene: &mut Scene, origins: &mut Origins, image: Option<Pixmap>) {
    let is_sky = |light: &Light| {
        matches!(
            light.kind,
            LightKind::Constant { .. } | LightKind::Environment { .. } | LightKind::Sun { .. }
        )
    };
    let mut kept = scene.lights.iter().map(|light| !is_sky(light)).collect::<Vec<_>>().into_iter();
    origins.lights.retain(|_| kept.next().unwrap_or(true));
    scene.lights.retain(|light| !is_sky(light));
    if let Some(image) = image {
        origins.images.push(origins.scene.clone());
        let image = scene.textures.images.push(image);
        let mapping = EnvironmentMapping::Equirectangular;
        let kind = LightKind::Environment { image, mapping, scale: 1.0, to_world: Transform::IDENTITY };
        origins.lights.push(origins.scene.clone());
        scene.lights.push(Light { name: "sky".to_owned(), kind, medium: None });
    }
}

impl SceneFile {
    /// Gives a model a camera that sees all of it, and the plain sky, where they are asked for.
    pub fn fit(&mut self, wanted: Fitted) {
        if wanted.camera
            && let Some(camera) = camera(&bounds(&self.scene))
        {
            self.scene.camera = camera;
            self.scene.film = film();
            self.fitted.camera = true;
        }
        if wanted.sky {
            replace_sky(&mut self.scene, &mut self.origins, Some(plain_sky().into()));
            self.fitted.sky = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::world::World;

    fn empty() -> Scene {
        let camera = Camera { to_world: Transform::IDENTITY, projection: perspective(45.0), medium: None };
        Scene::new(camera, film())
    }

    #[test]
    fn a_box_fills_the_picture() {
        for scale in [1e-6f32, 1.0, 1e9] {
            let half = Vec3::new(1.0, 2.0, 3.0) * scale;
            let bounds = Bounds { min: half, max: half * 3.0 };
            let camera = camera(&bounds).expect("the box is not empty");
            let from_world = camera.to_world.inverse();
            let seen = corners(&bounds).map(|p| from_world.point(p));
            let most = seen.iter().map(|p| p.x.abs().max(p.y.abs()) / p.z).fold(0.0, f32::max);
            assert!(seen.iter().all(|p| p.z > 0.0), "{seen:?}");
            // The side of the picture is at the tangent of half the field of view.
            assert!((most / 0.414_213_57 - 0.9).abs() < 1e-4, "{most}");
            let eye = camera.to_world.point(Vec3::ZERO) - bounds.center();
            assert!(eye.x > 0.0 && eye.y > 0.0 && eye.z > 0.0, "{eye}");
        }
        assert_eq!(camera(&Bounds::EMPTY), None);
    }

    #[test]
    fn boxes_are_those_of_the_world() {
        let mut scene = empty();
        let white = scene.textures.constant(Rgb::WHITE);
        let material = scene.materials.push(nephroid::material::Material::Diffuse { reflectance: white });
        let group = nephroid::shape::Group {
            name: "g".into(),
            shapes: vec![
                Shape::new("c", Geometry::Cube, material),
                Shape::new("d", Geometry::Disk, material),
            ],
        };
        let sphere = Geometry::Sphere { center: Vec3::X, radius: 2.0 };
        scene.shapes.push(Shape::new("s", sphere, material));
        let group = scene.groups.push(group);
        let to_world =
            Transform::scale(DVec3::new(1.0, -2.0, 3.0)).then(Transform::translate(DVec3::X * 9.0));
        scene.instances.push(nephroid::shape::Instance { name: "i".into(), group, to_world });
        let ours = bounds(&scene);
        let world = World::new(scene).expect("the scene is sound").bounds();
        assert!((ours.min - world.min).length() < 1e-4 && (ours.max - world.max).length() < 1e-4);
    }

    #[test]
    fn the_sky_is_replaced_and_taken_away() {
        let mut scene = empty();
        let source = crate::diagnostic::Source::new("a", "");
        let mut origins = Origins::at(Location::new(&source, 0..0));
        replace_sky(&mut scene, &mut origins, Some(plain_sky().into()));
        replace_sky(&mut scene, &mut origins, Some(plain_sky().into()));
        assert_eq!((scene.lights.len(), origins.lights.len()), (1, 1));
        assert!(!is_dark(&scene));
        replace_sky(&mut scene, &mut origins, None);
        assert!(is_dark(&scene) && origins.lights.is_empty());
    }

    #[test]
    fn a_white_floor_is_about_white() {
        // The irradiance of a level surface from above, by the midpoint rule over rows of the sky.
        let sky = plain_sky();
        let mut sum = 0.0f64;
        for y in 0..sky.height {
            let theta = std::f32::consts::PI * y as f32 / (sky.height - 1) as f32;
            let (sine, cosine) = sin_cos(theta);
            let row: f64 = (0..sky.width).map(|x| f64::from(sky.pixel(x, y).g)).sum();
            let cell =
                2.0 * std::f64::consts::PI * std::f64::consts::PI / f64::from(sky.width * (sky.height - 1));
            sum += row * f64::from(sine * cosine.max(0.0)) * cell;
        }
        let radiance = sum / std::f64::consts::PI;
        assert!((0.8..1.1).contains(&radiance), "{radiance}");
    }
}
