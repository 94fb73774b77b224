use super::Scene;
use super::check::check;
use crate::camera::{Camera, FovAxis, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::handle::{Arena, Handle};
use crate::light::{Light, LightKind};
use crate::material::Material;
use crate::math::{Affine2, DVec3, Transform, Vec2, Vec3};
use crate::medium::{self, Boundary, Grid, GridValues, Medium, Phase};
use crate::shape::{Geometry, Group, Shape};
use crate::texture::{Bitmap, BitmapFilter, Pixmap, Plane, Texture, Textures, Wrap};

fn empty() -> Scene {
    let projection =
        Projection::Perspective { fov_deg: 40.0, fov_axis: FovAxis::X, principal_point_offset: Vec2::ZERO };
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
    assert!(found.iter().any(|m| m == "the colours of vertices cannot be light: give the light a bitmap"));
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
    scene.media.grids.push(Grid { name: "smoke".into(), size: [1; 3], values: GridValues::Grey(vec![-1.0]) });
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
