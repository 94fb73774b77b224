//! Scenes of pbrt that can be read, and what becomes of them.

use std::path::Path;

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Crop, FilmSettings, Filter};
use nephroid::handle::Handle;
use nephroid::light::{EnvironmentMapping, Light, LightKind};
use nephroid::material::{Distribution, Material, Metal};
use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::medium::{Coefficient, Phase};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::{Texture, TexturePoint, Wrap};
use nephroid::world::World;
use nephroid_formats::pbrt::{read_scene, read_scene_str};
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::{Options, ParameterValue, SceneFile};

/// A picture of two by two pixels: 0, 51 above 102, 255.
fn grey_png() -> Vec<u8> {
    let mut out = std::io::Cursor::new(Vec::new());
    let picture = image::GrayImage::from_raw(2, 2, vec![0, 51, 102, 255]).expect("four pixels");
    picture.write_to(&mut out, image::ImageFormat::Png).expect("memory can be written");
    out.into_inner()
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

fn files() -> MemoryFiles {
    MemoryFiles::default()
        .with("grey.png", grey_png())
        .with("quad.ply", PLY)
        .with("flat.spd", "300 0.5\n900 0.5\n")
        .with("parts/a.pbrt", "Include \"parts/b.pbrt\" Include \"c.pbrt\"")
        .with("parts/b.pbrt", "Shape \"sphere\"")
        .with("parts/c.pbrt", "Translate 1 0 0 Shape \"disk\"")
}

fn read_whole(text: &str, options: &Options) -> SceneFile {
    read_scene_str("s.pbrt", text, &files(), options).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A scene that nothing is to be said about.
fn read(world: &str) -> SceneFile {
    let file = read_whole(&format!("Camera \"perspective\" WorldBegin\n{world}"), &Options::default());
    assert_eq!(file.warnings, [], "{world}");
    file
}

/// A scene with the warnings about it.
fn warned(world: &str) -> (SceneFile, Vec<String>) {
    let file = read_whole(&format!("Camera \"perspective\" WorldBegin\n{world}"), &Options::default());
    let warnings = file.warnings.iter().map(ToString::to_string).collect();
    (file, warnings)
}

fn constant(scene: &Scene, texture: Handle<Texture>) -> Rgb {
    match scene.textures.list[texture] {
        Texture::Constant(value) => value,
        ref other => panic!("{other:?}"),
    }
}

fn near(found: Rgb, expected: [f32; 3], tolerance: f32) {
    let off = (found - Rgb::from(expected)).map(f32::abs).max_channel();
    assert!(off <= tolerance, "{found:?} is not {expected:?}");
}

/// The material of a sphere, and the material inside if it has two sides.
fn material(directives: &str) -> (Scene, Material) {
    let file = read(&format!("{directives} Shape \"sphere\""));
    let scene = file.scene;
    let material = match scene.materials[scene.shapes[0].material] {
        Material::TwoSided { front, back } => {
            assert_eq!(front, back);
            scene.materials[front].clone()
        }
        ref other => other.clone(),
    };
    World::new(scene.clone()).expect("it can be rendered");
    (scene, material)
}

fn light(directives: &str) -> Light {
    let file = read(directives);
    World::new(file.scene.clone()).expect("it can be rendered");
    file.scene.lights[0].clone()
}

#[test]
fn an_empty_world_has_the_defaults_of_the_format() {
    let file = read("");
    let gaussian = Filter::Gaussian { std_dev: 0.5 };
    assert_eq!(file.scene.film, FilmSettings { width: 1280, height: 720, crop: None, filter: gaussian });
    let projection = Projection::Perspective {
        fov_deg: 90.0,
        fov_axis: FovAxis::Smaller,
        principal_point_offset: Vec2::ZERO,
    };
    // It looks along +z, and what is right of the picture has positive x.
    let to_world = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
    assert_eq!(file.scene.camera, Camera { to_world, projection, medium: None });
    assert_eq!((file.sample_count, file.integrator.name.as_str()), (None, ""));
}

#[test]
fn a_scene_is_what_it_would_be_by_hand() {
    let text = "# a comment\nLookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [40]\n\
        Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" [16] \"string filename\" \"a.exr\"\n\
        PixelFilter \"triangle\" \"float xradius\" 1 \"float yradius\" 1\nWorldBegin\n\
        Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n\
        AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2\nReverseOrientation\n\
        Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] AttributeEnd\n\
        LightSource \"point\" \"rgb I\" [3 2 1] \"point3 from\" [0 1 0]";
    let file = read_whole(text, &Options::default());
    assert_eq!(file.warnings, []);

    let film = FilmSettings { width: 32, height: 16, crop: None, filter: Filter::Tent { radius: 1.0 } };
    let projection = Projection::Perspective {
        fov_deg: 40.0,
        fov_axis: FovAxis::Smaller,
        principal_point_offset: Vec2::ZERO,
    };
    let to_world =
        Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).then(Transform::translate(DVec3::new(0.0, 0.0, -4.0)));
    let mut expected = Scene::new(Camera { to_world, projection, medium: None }, film);
    let reflectance = expected.textures.constant(Rgb::new(0.1, 0.2, 0.3));
    let side = expected.materials.push(Material::Diffuse { reflectance });
    let material = expected.materials.push(Material::TwoSided { front: side, back: side });
    let mesh = expected.meshes.push(Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    let emission = Some(expected.textures.constant(Rgb::new(2.0, 4.0, 6.0)));
    let geometry = Geometry::Mesh(mesh);
    let shape = Shape::new("trianglemesh at line 10", geometry, material);
    expected.shapes.push(Shape { emission, flip_normals: true, ..shape });
    let kind = LightKind::Point { position: Vec3::Y, intensity: Rgb::new(3.0, 2.0, 1.0) };
    expected.lights.push(Light { name: "point at line 11".into(), kind, medium: None });
    assert_eq!(file.scene, expected);
}

#[test]
fn the_camera_does_not_mirror_and_its_scale_does() {
    let camera = |head: &str| {
        let text = format!("{head} Camera \"perspective\" WorldBegin");
        read_whole(&text, &Options::default()).scene.camera.to_world
    };
    let plain = camera("LookAt 0 0 -4  0 0 0  0 1 0");
    // In camera space +x is left, and the left of what looks along +z with +y up has negative x in pbrt.
    assert_eq!(plain.vector(Vec3::X), -Vec3::X);
    assert_eq!(plain.point(Vec3::ZERO), Vec3::new(0.0, 0.0, -4.0));
    assert_eq!(camera("Scale -1 1 1 LookAt 0 0 -4  0 0 0  0 1 0").vector(Vec3::X), Vec3::X);
    let matrix = camera("Transform [1 0 0 0  0 1 0 0  0 0 1 0  2 3 4 1]");
    assert_eq!(matrix.point(Vec3::ZERO), Vec3::new(-2.0, -3.0, -4.0));
}

#[test]
fn windows_lenses_and_crops() {
    let read = |head: &str| {
        let file = read_whole(&format!("{head} WorldBegin"), &Options::default());
        assert_eq!(file.warnings, [], "{head}");
        file.scene
    };
    let scene = read(
        "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100 \"float cropwindow\" [.25 .5 0 1]\n\
         Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [0 2 -1 1] \"float lensradius\" .5 \
         \"float focaldistance\" 7",
    );
    assert_eq!(scene.film.crop, Some(Crop { x: 25, y: 0, width: 25, height: 100 }));
    let Projection::ThinLens { fov_deg, fov_axis, principal_point_offset, aperture_radius, focus_distance } =
        scene.camera.projection
    else {
        panic!("{:?}", scene.camera)
    };
    assert!((fov_deg - 90.0).abs() < 1e-4 && fov_axis == FovAxis::X);
    assert_eq!((principal_point_offset, aperture_radius, focus_distance), (Vec2::new(0.5, 0.0), 0.5, 7.0));
    let scene = read(
        "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 10 Camera \"orthographic\" \
         \"float screenwindow\" [-1 3 -1 1]",
    );
    // The picture's width spans [−1, 1] in camera space; +x is left.
    assert_eq!(scene.camera.to_world.point(Vec3::X), Vec3::new(-1.0, 0.0, 0.0));
    assert_eq!(scene.camera.to_world.point(-Vec3::X), Vec3::new(3.0, 0.0, 0.0));
}

#[test]
fn what_is_said_last_is_done_first() {
    let shape = |directives: &str| read(&format!("{directives} Shape \"disk\"")).scene.shapes[0].clone();
    let to_world = |directives: &str| shape(directives).to_world;
    assert_eq!(to_world("Translate 1 2 3 Scale 2 2 2").point(Vec3::ONE), Vec3::new(3.0, 4.0, 5.0));
    assert_eq!(to_world("Rotate 90 0 0 1").point(Vec3::X), Vec3::Y);
    assert_eq!(to_world("Translate 1 0 0 Identity").point(Vec3::X), Vec3::X);
    let kept = "Translate 1 0 0 CoordinateSystem \"here\" Identity CoordSysTransform \"here\"";
    assert_eq!(to_world(kept).point(Vec3::ZERO), Vec3::X);
    let scoped = "AttributeBegin Translate 1 0 0 ReverseOrientation AttributeEnd";
    assert_eq!((to_world(scoped).point(Vec3::ZERO), shape(scoped).flip_normals), (Vec3::ZERO, false));
    assert!(shape("ReverseOrientation").flip_normals);
    let camera = "LookAt 0 0 5  0 0 0  0 1 0 Camera \"perspective\" WorldBegin\n\
        CoordSysTransform \"camera\" Shape \"disk\"";
    let shapes = read_whole(camera, &Options::default()).scene.shapes;
    assert_eq!(shapes[0].to_world.point(Vec3::ZERO), Vec3::new(0.0, 0.0, 5.0));
}

#[test]
fn shapes() {
    let geometry = |shape: &str| {
        let scene = read(shape).scene;
        World::new(scene.clone()).expect("it can be rendered");
        let shape = scene.shapes[0].clone();
        let mesh = match shape.geometry {
            Geometry::Mesh(mesh) => scene.meshes[mesh].clone(),
            _ => Mesh::default(),
        };
        (shape, mesh)
    };
    let (sphere, _) = geometry("Shape \"sphere\" \"float radius\" 2");
    assert_eq!(sphere.geometry, Geometry::Sphere { center: Vec3::ZERO, radius: 2.0 });
    let (_, zone) = geometry("Shape \"sphere\" \"float zmax\" 0");
    assert!(zone.positions.iter().all(|p| p.z <= 1e-6 && (p.length() - 1.0).abs() < 1e-6));
    let (_, stretched) = geometry("Scale 1 2 1 Shape \"sphere\"");
    assert!(stretched.triangles.len() > 1000);
    let (disk, _) = geometry("Shape \"disk\" \"float radius\" 2 \"float height\" 3");
    assert_eq!(disk.to_world.point(Vec3::X), Vec3::new(2.0, 0.0, 3.0));
    let (cylinder, _) = geometry("Shape \"cylinder\" \"float zmin\" 0");
    assert_eq!(cylinder.geometry, Geometry::Cylinder { p0: Vec3::ZERO, p1: Vec3::Z, radius: 1.0 });
    let (_, ply) = geometry("Shape \"plymesh\" \"string filename\" \"quad.ply\"");
    assert_eq!((ply.triangles.len(), ply.normals.len()), (2, 0));
    let (_, patch) = geometry("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]");
    assert_eq!((patch.triangles.len(), patch.normals[0]), (2, Vec3::Z));
    let cage = "\"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]";
    let (_, subdivided) = geometry(&format!("Shape \"loopsubdiv\" \"integer levels\" 2 {cage}"));
    assert_eq!(subdivided.triangles.len(), 64);
}

#[test]
fn faces_are_on_the_side_of_their_normals() {
    let text = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -2]";
    let scene = read(text).scene;
    let mesh = scene.meshes.iter().next().expect("a mesh");
    assert_eq!((mesh.triangles.as_slice(), mesh.normals[2]), ([[0, 2, 1]].as_slice(), -Vec3::Z));
}

#[test]
fn diffuse_and_glass() {
    let (scene, diffuse) = material("Material \"diffuse\" \"spectrum reflectance\" \"flat.spd\"");
    let Material::Diffuse { reflectance } = diffuse else { panic!("{diffuse:?}") };
    near(constant(&scene, reflectance), [0.5; 3], 2e-3);
    let (scene, default) = material("");
    let Material::Diffuse { reflectance } = default else { panic!("{default:?}") };
    assert_eq!(constant(&scene, reflectance), Rgb::splat(0.5));
    let (_, glass) = material("Material \"dielectric\" \"float eta\" 1.3");
    assert!(matches!(glass, Material::Dielectric { int_ior: 1.3, ext_ior: 1.0, .. }), "{glass:?}");
    let (scene, frosted) = material("Material \"dielectric\" \"float roughness\" .25");
    let Material::RoughDielectric { roughness, .. } = frosted else { panic!("{frosted:?}") };
    // The width of the distribution is the root of the roughness, unless the file says not to.
    assert_eq!(constant(&scene, roughness.alpha_u), Rgb::splat(0.5));
    let (_, prism) = material("Material \"dielectric\" \"spectrum eta\" \"glass-F11\"");
    let Material::Dispersive { dispersion, .. } = prism else { panic!("{prism:?}") };
    assert!((dispersion.nominal_ior() - 1.7847).abs() < 1e-4);
    let (_, thin) = material("Material \"thindielectric\"");
    assert!(matches!(thin, Material::ThinDielectric { int_ior: 1.5, .. }), "{thin:?}");
    let (_, interface) = material("Material \"interface\"");
    assert_eq!(interface, Material::Null);
}

#[test]
fn metals_and_coats() {
    let (scene, gold) = material(
        "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" \
         \"float uroughness\" .1 \"float vroughness\" .2 \"bool remaproughness\" false",
    );
    let Material::RoughConductor { metal: Metal::Index { eta, k }, roughness, .. } = gold else {
        panic!("{gold:?}")
    };
    assert!(eta.r < 0.2 && k.r > 3.0);
    assert_eq!(roughness.distribution, Distribution::Ggx);
    let alphas = [roughness.alpha_u, roughness.alpha_v].map(|alpha| constant(&scene, alpha).g);
    assert_eq!(alphas, [0.1, 0.2]);
    let (_, grey) = material("Material \"conductor\" \"rgb reflectance\" [.25 .25 .25]");
    let Material::Conductor { metal: Metal::Index { eta, k }, .. } = grey else { panic!("{grey:?}") };
    // ((η − 1)² + k²) / ((η + 1)² + k²) is a quarter.
    near(k * k * (eta * eta + Rgb::splat(3.0) + k * k).map(|v| 1.0 / v), [0.25; 3], 1e-6);
    let (_, plastic) =
        material("Material \"coateddiffuse\" \"float eta\" 1.4 \"rgb reflectance\" [.1 .2 .3]");
    assert!(
        matches!(plastic, Material::Plastic { int_ior: 1.4, nonlinear: true, roughness: None, .. }),
        "{plastic:?}"
    );
    let (_, coated) = material(
        "Material \"coatedconductor\" \"float interface.roughness\" .1 \"spectrum conductor.eta\" \
         \"metal-Al-eta\" \"spectrum conductor.k\" \"metal-Al-k\"",
    );
    assert!(
        matches!(
            coated,
            Material::CoatedConductor { roughness: None, coat_roughness: Some(_), coat_ior: 1.5, .. }
        ),
        "{coated:?}"
    );
}

#[test]
fn mixtures_and_bumps() {
    let both = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
        MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n";
    let (scene, mix) =
        material(&format!("{both} Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .3"));
    let Material::Blend { weight, first, second } = mix else { panic!("{mix:?}") };
    assert_eq!(constant(&scene, weight), Rgb::splat(0.3));
    assert!(first.index() < second.index());
    let heights =
        "Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"grey.png\" \"float scale\" .5\n";
    let (scene, bump) = material(&format!("{heights} Material \"diffuse\" \"texture displacement\" \"h\""));
    let Material::BumpMap { heights, scale: 1.0, .. } = bump else { panic!("{bump:?}") };
    // The last row of the file is at v = 0: 102, 255, decoded from sRGB and halved.
    let at = |u, v| scene.textures.eval(heights, TexturePoint::from(Vec2::new(u, v))).g;
    assert!((at(0.75, 0.25) - 0.5).abs() < 1e-6 && at(0.25, 0.75).abs() < 1e-6);
    let (_, map) = material("Material \"diffuse\" \"string normalmap\" \"grey.png\"");
    assert!(matches!(map, Material::NormalMap { .. }), "{map:?}");
    let (_, leaf) = material("Material \"diffusetransmission\" \"float scale\" 2");
    assert!(matches!(leaf, Material::DiffuseTransmission { .. }), "{leaf:?}");
}

#[test]
fn textures() {
    let value = |texture: &str, u: f32, v: f32| {
        let text = format!("{texture} Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
        let scene = read(&text).scene;
        let Material::Diffuse { reflectance } = *scene.materials.iter().next().expect("one") else {
            panic!("{:?}", scene.materials)
        };
        scene.textures.eval(reflectance, TexturePoint::from(Vec2::new(u, v))).g
    };
    let image = |more: &str| {
        format!("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"grey.png\" {more}")
    };
    let raw = "\"string encoding\" \"linear\"";
    assert!((value(&image(raw), 0.75, 0.75) - 0.2).abs() < 1e-6);
    assert!((value(&image(&format!("{raw} \"bool invert\" true")), 0.75, 0.75) - 0.8).abs() < 1e-6);
    assert!((value(&image(&format!("{raw} \"float uscale\" 2")), 0.375, 0.75) - 0.2).abs() < 1e-6);
    assert_eq!(value(&image("\"string wrap\" \"black\""), 1.25, 0.25), 0.0);
    let board = "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.1 .1 .1] \"rgb tex2\" [.9 .9 .9] \
        \"float uscale\" 2 \"float vscale\" 2";
    assert_eq!([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75)].map(|(u, v)| value(board, u, v)), [0.1, 0.9, 0.1]);
    let scaled = format!(
        "{} Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"float scale\" .5",
        image(raw).replace("\"t\"", "\"i\"")
    );
    assert!((value(&scaled, 0.75, 0.75) - 0.1).abs() < 1e-6);
    let mixed =
        "Texture \"t\" \"spectrum\" \"mix\" \"rgb tex1\" [0 0 0] \"rgb tex2\" [1 1 1] \"float amount\" .25";
    assert!((value(mixed, 0.0, 0.0) - 0.25).abs() < 1e-6);
    let scene = read(&format!("{} Shape \"sphere\"", image("\"string wrap\" \"clamp\""))).scene;
    let Some(Texture::Bitmap(bitmap)) = scene.textures.list.iter().next() else { panic!("no bitmap") };
    assert_eq!(bitmap.wrap, Wrap::Clamp);
}

#[test]
fn lights_are_as_bright_as_their_numbers() {
    let luminance = |rgb: Rgb| 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
    let point = |parameters: &str| match light(&format!("LightSource \"point\" {parameters}")).kind {
        LightKind::Point { intensity, .. } => intensity,
        other => panic!("{other:?}"),
    };
    assert_eq!(point("\"rgb I\" [1 2 3] \"float scale\" 2"), Rgb::new(2.0, 4.0, 6.0));
    assert_eq!(point(""), Rgb::WHITE);
    // All but `rgb` has luminance one, whatever its own.
    for spectrum in ["\"blackbody I\" 4000", "\"spectrum I\" [300 7 900 7]", "\"spectrum I\" \"stdillum-A\""]
    {
        let rgb = point(spectrum);
        assert!((luminance(rgb) - 1.0).abs() < 2e-3 && rgb.r > 1.1 && rgb.b < 0.95, "{spectrum}: {rgb:?}");
    }
    near(point("\"float power\" 12.566371"), [1.0; 3], 1e-6);
    let sky =
        |parameters: &str| light(&format!("LightSource \"infinite\" {parameters} Shape \"sphere\"")).kind;
    assert_eq!(sky("\"rgb L\" [1 2 3]"), LightKind::Constant { radiance: Rgb::new(1.0, 2.0, 3.0) });
    let LightKind::Constant { radiance } = sky("\"float illuminance\" 6.2831855") else { panic!("no sky") };
    near(radiance, [2.0; 3], 1e-6);
    let image = sky("\"string filename\" \"grey.png\" \"float scale\" 3");
    assert!(
        matches!(image, LightKind::Environment { mapping: EnvironmentMapping::EqualArea, scale: 3.0, .. }),
        "{image:?}"
    );
    let sun =
        light("Rotate 90 1 0 0 LightSource \"distant\" \"point3 from\" [0 0 0] \"point3 to\" [0 2 0]").kind;
    assert_eq!(sun, LightKind::Directional { direction: Vec3::Z, irradiance: Rgb::WHITE });
}

#[test]
fn spots_projectors_and_goniometric_lights() {
    let spot = light("LightSource \"spot\" \"point3 from\" [0 1 0] \"point3 to\" [3 1 0]").kind;
    let LightKind::Spot { to_world, cutoff_deg, beam_width_deg, .. } = spot else { panic!("{spot:?}") };
    assert_eq!((cutoff_deg, beam_width_deg), (30.0, 25.0));
    assert_eq!((to_world.point(Vec3::ZERO), to_world.vector(Vec3::Z)), (Vec3::Y, Vec3::X));
    // All of a cone of 60° fades, and half of its 2π (1 − cos 60°) sr count.
    let of_power =
        "LightSource \"spot\" \"float coneangle\" 60 \"float conedeltaangle\" 60 \"float power\" 1.5707964";
    let LightKind::Spot { intensity, .. } = light(of_power).kind else { panic!("no spot") };
    near(intensity, [1.0; 3], 1e-6);
    let projector =
        light("LightSource \"projection\" \"string filename\" \"grey.png\" \"float fov\" 45").kind;
    assert!(matches!(projector, LightKind::Projector { fov_deg: 45.0, .. }), "{projector:?}");
    let table = light("LightSource \"goniometric\" \"string filename\" \"grey.png\"").kind;
    let LightKind::Goniometric { to_world, mapping, .. } = table else { panic!("{table:?}") };
    assert_eq!((to_world.vector(Vec3::Z), mapping), (Vec3::Y, EnvironmentMapping::EqualArea));
}

#[test]
fn the_sensor_makes_light_brighter() {
    let text = "Film \"rgb\" \"float iso\" 200 Camera \"perspective\" \"float shutterclose\" .25 WorldBegin\n\
        LightSource \"infinite\" AreaLightSource \"diffuse\" Shape \"disk\"";
    let scene = read_whole(text, &Options::default()).scene;
    assert_eq!(scene.lights[0].kind, LightKind::Constant { radiance: Rgb::splat(0.5) });
    let emission = scene.shapes[0].emission.expect("it shines");
    assert_eq!(constant(&scene, emission), Rgb::splat(0.5));
}

#[test]
fn area_lights() {
    let emission = |text: &str| {
        let scene = read(text).scene;
        World::new(scene.clone()).expect("it can be rendered");
        constant(&scene, scene.shapes[0].emission.expect("it shines"))
    };
    let disk = "AreaLightSource \"diffuse\" \"float power\" 39.478416 Shape \"disk\" \"float radius\" 2";
    // Radiance L of area 4π gives 4π²L.
    near(emission(disk), [1.0; 3], 1e-5);
    assert_eq!(emission("AreaLightSource \"diffuse\" \"rgb L\" [4 4 4] Shape \"sphere\""), Rgb::splat(4.0));
    let (file, warnings) =
        warned("AreaLightSource \"diffuse\" \"bool twosided\" true\nMaterial \"interface\"\nShape \"disk\"");
    assert_eq!(file.scene.shapes[0].emission, None);
    assert_eq!(
        warnings,
        [
            "s.pbrt:2:18: warning: \"twosided\" cannot be had yet: it shines on the side of the normal",
            "s.pbrt:4:8: warning: a shape of the material \"interface\" does not shine, in pbrt neither",
        ]
    );
}

#[test]
fn integrators_and_samplers() {
    let request = |text: &str| {
        let text = format!("{text} Camera \"perspective\" WorldBegin");
        let file = read_whole(&text, &Options::default());
        let depth = file.integrator.parameters.iter().find(|p| p.name == "max_depth").expect("given");
        assert!(
            file.integrator
                .unused()
                .iter()
                .all(|d| d.severity != nephroid_formats::diagnostic::Severity::Error)
        );
        (file.integrator.name.clone(), depth.value.clone(), file.sample_count)
    };
    // What is seen at once has depth 0 there, 1 here.
    let path =
        request("Integrator \"path\" \"integer maxdepth\" 7 Sampler \"zsobol\" \"integer pixelsamples\" 32");
    assert_eq!(path, ("path".into(), ParameterValue::Int(8), Some(32)));
    assert_eq!(request("Integrator \"sppm\""), ("ppm".into(), ParameterValue::Int(6), None));
    let stratified = request("Integrator \"volpath\" Sampler \"stratified\" \"integer xsamples\" 2");
    assert_eq!(stratified, ("volpath".into(), ParameterValue::Int(6), Some(8)));
    assert_eq!(request("Integrator \"bdpt\"").0, "bdpt");
}

#[test]
fn media_and_what_they_are_between() {
    let text = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [3 3 3] \"rgb sigma_a\" \
        [1 1 1] \"float scale\" 2 \"float g\" .5\nMakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"string preset\" \
        \"Wholemilk\"\nMediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin\n\
        AttributeBegin MediumInterface \"milk\" \"fog\" Material \"interface\" Shape \"sphere\" AttributeEnd\n\
        LightSource \"point\" MediumInterface \"fog\" Shape \"sphere\"";
    let file = read_whole(text, &Options::default());
    assert_eq!(file.warnings, []);
    let (scene, media) = (&file.scene, &file.scene.media);
    let handles: Vec<_> = media.list.iter_handles().map(|(handle, _)| handle).collect();
    let fog = &media.list[handles[0]];
    assert_eq!(fog.sigma_t, Coefficient::Constant(Rgb::splat(8.0)));
    assert_eq!(fog.albedo, Coefficient::Constant(Rgb::splat(0.75)));
    assert_eq!(fog.phase, Phase::HenyeyGreenstein { g: 0.5 });
    assert_eq!(scene.camera.medium, Some(handles[0]));
    assert_eq!(scene.lights[0].medium, Some(handles[0]));
    let boundary = scene.shapes[0].boundary;
    assert_eq!((boundary.interior, boundary.exterior), (Some(handles[1]), Some(handles[0])));
    assert!(!scene.shapes[1].boundary.is_named());
    let grid = "MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [0 1] \
        \"point3 p1\" [2 2 2] \"rgb sigma_s\" [1 2 3] \"rgb sigma_a\" [0 0 0]\nMediumInterface \"smoke\" \"\" \
        Material \"interface\" Shape \"sphere\"";
    let scene = read(grid).scene;
    let smoke = scene.media.list.iter().next().expect("a medium");
    let Coefficient::Grid { to_world, scale, .. } = smoke.sigma_t else { panic!("{smoke:?}") };
    assert_eq!((to_world.point(Vec3::ONE), scale), (Vec3::splat(2.0), 1.0));
    World::new(scene).expect("it can be rendered");
}

#[test]
fn objects_and_instances() {
    let text = "ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" ObjectEnd\n\
        AttributeBegin Scale 2 2 2 ObjectInstance \"o\" AttributeEnd ObjectInstance \"o\"";
    let scene = read(text).scene;
    assert_eq!((scene.shapes.len(), scene.groups.len(), scene.instances.len()), (0, 1, 2));
    let group = &scene.groups[scene.instances[0].group];
    assert_eq!(group.shapes[0].to_world.point(Vec3::ZERO), Vec3::Y);
    assert_eq!(scene.instances[0].to_world.point(Vec3::Y), Vec3::Y * 2.0);
    assert_eq!(scene.instances[1].to_world, Transform::IDENTITY);
    let (_, warnings) = warned("ObjectBegin \"o\" Shape \"sphere\" ObjectEnd");
    assert_eq!(warnings, ["s.pbrt:2:14: warning: nothing shows the object \"o\""]);
}

#[test]
fn attributes_holes_and_includes() {
    let text = "Attribute \"shape\" \"float radius\" 3 \"float alpha\" .5\nShape \"sphere\"\n\
        Shape \"sphere\" \"float radius\" 2";
    let scene = read(text).scene;
    let radius = |i: usize| match scene.shapes[i].geometry {
        Geometry::Sphere { radius, .. } => radius,
        ref other => panic!("{other:?}"),
    };
    assert_eq!((radius(0), radius(1)), (3.0, 2.0));
    let material = &scene.materials[scene.shapes[0].material];
    assert!(matches!(material, Material::Mask { .. }), "{material:?}");
    // Named from the folder of the scene, or from that of the file that includes.
    let scene = read("Include \"parts/a.pbrt\" Shape \"disk\"").scene;
    assert_eq!(scene.shapes.len(), 3);
    assert_eq!(scene.shapes[2].to_world.point(Vec3::ZERO), Vec3::X);
    let scene = read("Import \"parts/a.pbrt\" Shape \"disk\"").scene;
    assert_eq!(scene.shapes[2].to_world.point(Vec3::ZERO), Vec3::ZERO);
    let files = files().with("d/s.pbrt", "Camera \"perspective\" WorldBegin Include \"../parts/b.pbrt\"");
    let file = read_scene(Path::new("d/s.pbrt"), &files, &Options::default()).expect("a scene");
    assert_eq!(file.origins.shapes[0].to_string(), "parts/b.pbrt:1:8");
}

#[test]
fn older_files_are_told_and_read() {
    let (file, warnings) = warned(
        "Material \"matte\" \"color Kd\" [.1 .2 .3]\nShape \"sphere\"\nMaterial \"uber\"\nMaterial \"mirror\"\n\
         Material \"glass\" \"float index\" 1.2\nMaterial \"metal\"\nWorldEnd",
    );
    let kinds = [
        ("matte", "diffuse"),
        ("uber", "coateddiffuse"),
        ("mirror", "conductor"),
        ("glass", "dielectric"),
        ("metal", "conductor"),
    ];
    for (warning, (old, new)) in warnings.iter().zip(kinds) {
        let expected = format!("material \"{old}\" is of older files; \"{new}\" stands for it");
        assert!(warning.ends_with(&expected), "{warning}");
    }
    assert_eq!(
        warnings.last().map(String::as_str),
        Some("s.pbrt:8:1: warning: \"WorldEnd\" is of older files, and not needed")
    );
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn what_is_known_elsewhere_is_a_warning() {
    let (_, warnings) = warned("Shape \"sphere\" \"float zmin\" -1 \"float height\" 2");
    assert_eq!(warnings, ["s.pbrt:2:33: warning: \"height\" means nothing to the shape \"sphere\""]);
    let (file, warnings) = warned(
        "Texture \"t\" \"float\" \"marble\"\nMaterial \"hair\" \"float eumelanin\" 1\nShape \"sphere\"",
    );
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    World::new(file.scene).expect("it can be rendered");
    let lenient = Options { lenient: true, ..Options::default() };
    let file = read_whole("Camera \"perspective\" WorldBegin Shape \"curve\"", &lenient);
    assert_eq!(
        file.warnings[0].to_string(),
        "s.pbrt:1:40: warning: shape \"curve\" cannot be rendered yet and is left out"
    );
}

#[test]
fn colours_of_wide_spaces_become_srgb() {
    let (scene, diffuse) =
        material("ColorSpace \"rec2020\" Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]");
    let Material::Diffuse { reflectance } = diffuse else { panic!("{diffuse:?}") };
    near(constant(&scene, reflectance), [0.5; 3], 1e-3);
}

/// Animations hide things so.
#[test]
fn what_has_no_size_is_left_out() {
    let (file, warnings) = warned(
        "AttributeBegin Scale 0 0 0 Shape \"sphere\" Translate 1 2 3 Shape \"disk\" LightSource \"point\" AttributeEnd
        AttributeBegin Scale 1 0 1 Identity Shape \"disk\" AttributeEnd
        Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 ] \"integer indices\" [ 0 1 2 ] Shape \"sphere\"",
    );
    assert_eq!((file.scene.shapes.len(), file.scene.lights.len()), (2, 0));
    assert_eq!(
        warnings,
        [
            "s.pbrt:2:16: warning: Scale flattens space: what it would hold is left out; this is told once",
            "s.pbrt:3:24: warning: Scale flattens space: what it would hold is left out",
            "s.pbrt:4:16: warning: no face of the \"trianglemesh\" has an area, and it is left out"
        ]
    );
}

#[test]
fn heights_may_go_down() {
    let file = read(
        "Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"grey.png\" \"float scale\" -3.5
        Texture \"b\" \"float\" \"checkerboard\" \"float tex1\" -1 \"float tex2\" 2
        Material \"diffuse\" \"texture displacement\" \"b\" Shape \"sphere\"",
    );
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn spellings_of_version_3() {
    let text =
        "PixelFilter \"triangle\" \"float xwidth\" 1.5 \"float ywidth\" 1.5 Camera \"perspective\" WorldBegin
        LightSource \"infinite\" \"string mapname\" \"grey.png\" \"rgb L\" [ 2 2 2 ]
        MakeNamedMedium \"smoke\" \"string type\" \"heterogeneous\" \"integer nx\" 1 \"integer ny\" 1
        \"integer nz\" 1 \"float density\" [ 1 ]";
    let file = read_whole(text, &Options::default());
    assert_eq!(file.scene.film.filter, Filter::Tent { radius: 1.5 });
    let LightKind::Environment { scale, .. } = file.scene.lights[0].kind else { panic!("a sky") };
    assert_eq!((scale, file.warnings.len()), (2.0, 2));
}

#[test]
fn older_files_say_alpha_of_a_gaussian() {
    let file = read_whole(
        "PixelFilter \"gaussian\" \"float alpha\" 8 Camera \"perspective\" WorldBegin",
        &Options::default(),
    );
    assert_eq!(file.scene.film.filter, Filter::Gaussian { std_dev: 0.25 });
}
