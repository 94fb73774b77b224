//! Scenes that can be read, and what becomes of them.

use std::path::Path;

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Crop, FilmSettings, Filter};
use nephroid::handle::Handle;
use nephroid::light::LightKind;
use nephroid::material::{Material, Metal};
use nephroid::math::{Vec2, Vec3, real};
use nephroid::medium::Boundary;
use nephroid::scene::Scene;
use nephroid::shape::Geometry;
use nephroid::texture::{BitmapFilter, Texture, Wrap};
use nephroid_formats::diagnostic::{Location, Severity};
use nephroid_formats::mitsuba::{read_scene, read_scene_str};
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::{Options, ParameterValue, SceneFile};

fn read_with(content: &str, files: &MemoryFiles, options: &Options) -> SceneFile {
    let text =
        format!("<scene version=\"3.0.0\"><sensor type=\"perspective\" id=\"eye\"/>\n{content}\n</scene>");
    read_scene_str("s.xml", &text, files, options).unwrap_or_else(|e| panic!("{e}"))
}

fn read(content: &str) -> SceneFile {
    let file = read_with(content, &files(), &Options::default());
    assert_eq!(file.warnings, [], "{content}");
    file
}

/// The colour of a constant texture.
fn constant(scene: &Scene, texture: Handle<Texture>) -> Rgb {
    match scene.textures.list[texture] {
        Texture::Constant(value) => value,
        ref other => panic!("{other:?}"),
    }
}

/// The materials of a scene with one `<bsdf>`, and the warnings about it.
fn material(bsdf: &str) -> (Scene, Material, Vec<String>) {
    let file = read_with(bsdf, &files(), &Options::default());
    let last = file.scene.materials.iter().last().expect("a material").clone();
    (file.scene, last, file.warnings.iter().map(ToString::to_string).collect())
}

/// A picture of two pixels, 128 and 255, grey with an alpha channel.
fn grey_png() -> Vec<u8> {
    let mut out = std::io::Cursor::new(Vec::new());
    let picture = image::GrayAlphaImage::from_raw(2, 1, vec![128, 255, 255, 0]).expect("two pixels");
    picture.write_to(&mut out, image::ImageFormat::Png).expect("memory can be written");
    out.into_inner()
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1 4/1\n";

fn files() -> MemoryFiles {
    MemoryFiles::default()
        .with("quad.obj", QUAD)
        .with("folder/quad.obj", QUAD)
        .with("grey.png", grey_png())
        .with("light.spd", "400 0\n500 8\n600 15.6\n700 18.4\n")
}

#[test]
fn an_empty_scene_has_the_defaults_of_the_format() {
    let file = read("");
    let gaussian = Filter::Gaussian { std_dev: 0.5 };
    assert_eq!(file.scene.film, FilmSettings { width: 768, height: 576, crop: None, filter: gaussian });
    assert_eq!((file.sample_count, file.integrator.name.as_str()), (None, ""));
    let Projection::Perspective { fov_deg, fov_axis, principal_point_offset } = file.scene.camera.projection
    else {
        panic!("not a perspective camera")
    };
    // The diagonal of a small-format picture through a 50 mm lens.
    assert!((fov_deg - 46.793).abs() < 0.001, "{fov_deg}");
    assert_eq!((fov_axis, principal_point_offset), (FovAxis::Diagonal, Vec2::ZERO));
}

#[test]
fn sensor_and_film() {
    let text = r##"<scene version="2.1.0">
        <integrator type="moment"><integrator type="aov"><string name="aovs" value="d:depth"/>
            <integrator type="$how">
                <integer name="max_depth" value="7"/><float name="radius" value="0.5"/>
                <boolean name="hide_emitters" value="true"/><string name="kernel" value="cone"/><boolean name="jitter" value="true"/>
                <integer name="photns" value="5"/>
            </integrator></integrator></integrator>
        <default name="how" value="photonmapper"/>
        <sensor type="perspective">
            <float name="fov" value="40"/> <string name="fov_axis" value="Smaller"/>
            <float name="principal_point_offset_x" value="0.1"/>
            <float name="near_clip" value="1"/> <float name="far_clip" value="9"/>
            <transform name="to_world"><scale x="-1"/><lookat origin="0,0,4" target="0 0 0" up="0, 1, 0"/></transform>
            <sampler type="stratified"><integer name="sample_count" value="$spp"/></sampler>
            <film type="hdrfilm">
                <integer name="width" value="20"/> <integer name="height" value="10"/>
                <integer name="crop_offset_x" value="3"/> <integer name="crop_width" value="4"/>
                <string name="pixel_format" value="rgb"/> <boolean name="sample_border" value="true"/>
                <rfilter type="mitchell"><float name="B" value="0"/><float name="C" value="0.5"/></rfilter>
            </film>
        </sensor>
    </scene>"##;
    let options = Options { defines: vec![("spp".into(), "16".into())], lenient: false };
    let file = read_scene_str("s.xml", text, &files(), &options).unwrap();
    let warnings: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        ["s.xml:5:54: warning: \"hide_emitters\" cannot be had yet: the camera sees lamps and sky"]
    );
    let offset = Vec2::new(0.1, 0.0);
    let projection =
        Projection::Perspective { fov_deg: 40.0, fov_axis: FovAxis::Smaller, principal_point_offset: offset };
    assert_eq!(file.scene.camera.projection, projection);
    let to_world = file.scene.camera.to_world;
    assert_eq!((to_world.point(Vec3::ZERO), to_world.vector(Vec3::Z)), (Vec3::Z * 4.0, -Vec3::Z));
    // Mirrored before the camera is put in its place.
    assert_eq!(to_world.vector(Vec3::X), Vec3::X);
    let crop = Some(Crop { x: 3, y: 0, width: 4, height: 10 });
    let filter = Filter::Mitchell { b: 0.0, c: 0.5 };
    assert_eq!(file.scene.film, FilmSettings { width: 20, height: 10, crop, filter });
    assert_eq!(file.sample_count, Some(16));

    let integrator = file.integrator;
    assert_eq!(integrator.name, "photonmapper");
    assert_eq!(integrator.location.as_ref().unwrap().to_string(), "s.xml:3:31");
    assert_eq!(integrator.parameters[0].value, ParameterValue::Int(7));
    assert_eq!(integrator.get_int("max_depth").unwrap(), Some(7));
    assert_eq!(integrator.get_float("radius").unwrap(), Some(0.5));
    assert_eq!(integrator.get_bool("jitter").unwrap(), Some(true));
    assert_eq!(integrator.get_int("photons").unwrap(), None);
    let wrong = integrator.get_float("kernel").unwrap_err().to_string();
    assert_eq!(wrong, "s.xml:5:90: error: \"kernel\" must be a float");
    let unused: Vec<_> = integrator.unused().iter().map(ToString::to_string).collect();
    assert_eq!(
        unused,
        [
            r#"s.xml:6:47: error: the integrator "photonmapper" has no parameter "photns"; did you mean "photons"?"#
        ]
    );
}

#[test]
fn a_camera_with_a_lens() {
    let lens = |content: &str| {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="thinlens"><float name="fov" value="40"/>
            <float name="aperture_radius" value="0.1"/>{content}</sensor></scene>"#
        );
        let file = read_scene_str("s.xml", &text, &files(), &Options::default()).unwrap();
        assert_eq!(file.warnings, []);
        let Projection::ThinLens { fov_deg, aperture_radius, focus_distance, .. } =
            file.scene.camera.projection
        else {
            panic!("{:?}", file.scene.camera.projection)
        };
        assert_eq!((fov_deg, aperture_radius), (40.0, 0.1));
        focus_distance
    };
    assert_eq!(lens(r#"<float name="focus_distance" value="3"/><float name="far_clip" value="20"/>"#), 3.0);
    // As Mitsuba: the far clipping plane, and that is at 10⁴.
    assert_eq!(lens(r#"<float name="far_clip" value="20"/>"#), 20.0);
    assert_eq!(lens(""), 1e4);
}

#[test]
fn other_sensors_and_filters() {
    let text = r#"<scene version="3.0.0"><sensor type="orthographic"><film type="specfilm">
        <rfilter type="tent"/></film></sensor><sensor type="perspective"/></scene>"#;
    let file = read_scene_str("s.xml", text, &files(), &Options::default()).unwrap();
    assert_eq!(file.scene.camera.projection, Projection::Orthographic);
    assert_eq!(file.scene.film.filter, Filter::Tent { radius: 1.0 });
    assert!(file.warnings.iter().all(|w| w.severity == Severity::Warning));
    let warnings: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        [
            "s.xml:2:47: warning: only the first <sensor> takes a picture",
            "s.xml:1:64: warning: film \"specfilm\" cannot be had yet; \"hdrfilm\" stands for it",
        ]
    );
}

#[test]
fn shapes() {
    let file = read(
        r#"<shape type="sphere" id="ball"><point name="center" x="1" y="2" z="3"/><float name="radius" value="4"/></shape>
        <shape type="rectangle"><boolean name="flip_normals" value="TRUE"/>
            <transform name="to_world"><scale value="2"/><rotate x="1" angle="-90"/><translate y="-1"/></transform></shape>
        <shape type="cylinder"><integer name="radius" value="2"/></shape>
        <shape type="disk"/><shape type="cube"/><shape type="plane"/>
        <shape type="obj"><string name="filename" value="quad.obj"/></shape>
        <shape type="obj"><string name="filename" value="quad.obj"/><boolean name="face_normals" value="true"/></shape>
        <shape type="obj"><string name="filename" value="quad.obj"/></shape>"#,
    );
    let shapes = &file.scene.shapes;
    let geometry: Vec<_> = shapes.iter().map(|s| s.geometry.clone()).collect();
    let meshes: Vec<_> = file.scene.meshes.iter_handles().collect();
    assert_eq!(
        geometry,
        [
            Geometry::Sphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 4.0 },
            Geometry::Rectangle,
            Geometry::Cylinder { p0: Vec3::ZERO, p1: Vec3::Z, radius: 2.0 },
            Geometry::Disk,
            Geometry::Cube,
            Geometry::Plane,
            Geometry::Mesh(meshes[0].0),
            Geometry::Mesh(meshes[1].0),
            Geometry::Mesh(meshes[0].0),
        ]
    );
    assert_eq!((shapes[0].name.as_str(), shapes[1].name.as_str()), ("ball", "rectangle at line 3"));
    assert_eq!(shapes.iter().map(|s| s.flip_normals).collect::<Vec<_>>()[..3], [false, true, false]);
    // Scaled, then turned, then moved: the normal +z ends at +y.
    assert_eq!(shapes[1].to_world.point(Vec3::Z), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(meshes[0].1.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(meshes[0].1.uvs, [Vec2::new(0.0, 0.75); 4]);
    assert_eq!((meshes[0].1.normals.len(), meshes[1].1.normals.len()), (4, 0));
    assert_eq!(file.origins.shapes[1].to_string(), "s.xml:3:22");
    assert_eq!(file.origins.shapes.len(), shapes.len());
}

#[test]
fn groups_are_stored_once_and_shown_by_instances() {
    let file = read(
        r#"<shape type="instance" id="early"><ref id="pair"/><transform name="to_world"><translate y="3"/></transform></shape>
        <shape type="disk"/>
        <shape type="shapegroup" id="pair">
            <shape type="obj"><string name="filename" value="quad.obj"/></shape>
            <shape type="sphere"><bsdf type="null"/></shape>
        </shape>
        <shape type="instance"><ref id="pair"/></shape>
        <shape type="instance"><shape type="shapegroup"><shape type="cube"/></shape></shape>"#,
    );
    let scene = &file.scene;
    let (groups, instances) = (&scene.groups, &scene.instances);
    assert_eq!((scene.shapes.len(), groups.len(), instances.len(), scene.meshes.len()), (1, 2, 3, 1));
    let pair = &groups[instances[0].group];
    assert_eq!((pair.name.as_str(), pair.shapes.len()), ("pair", 2));
    assert_eq!(scene.materials[pair.shapes[1].material], Material::Null);
    assert_eq!((instances[1].group, instances[0].name.as_str()), (instances[0].group, "early"));
    assert_eq!(groups[instances[2].group].shapes[0].geometry, Geometry::Cube);
    assert_eq!(instances[0].to_world.point(Vec3::ZERO), Vec3::new(0.0, 3.0, 0.0));
    // First the scene's own shapes, then those of the groups in their order.
    let lines: Vec<usize> = file.origins.shapes.iter().map(Location::line).collect();
    assert_eq!(lines, [3, 5, 6, 9]);
    assert_eq!((file.origins.groups.len(), file.origins.instances.len()), (2, 3));
}

#[test]
fn instances_in_groups_are_copied() {
    let file = read(
        r#"<shape type="shapegroup" id="outer"><shape type="instance"><ref id="inner"/>
        <transform name="to_world"><scale value="2"/></transform></shape><shape type="disk"/></shape>
        <shape type="shapegroup" id="inner"><shape type="cube"><transform name="to_world"><translate x="1"/></transform></shape>
        <shape type="disk"/></shape>
        <shape type="instance"><ref id="outer"/></shape>"#,
    );
    assert_eq!(file.warnings, []);
    let scene = &file.scene;
    let outer = &scene.groups[scene.instances[0].group];
    assert_eq!((outer.name.as_str(), outer.shapes.len()), ("outer", 3));
    assert_eq!(outer.shapes[0].to_world.point(Vec3::ZERO), Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(outer.shapes[2].to_world.point(Vec3::X), Vec3::X);
    let all: usize = scene.groups.iter().map(|group| group.shapes.len()).sum();
    assert_eq!(file.origins.shapes.len(), all);
    let lines: Vec<usize> = file.origins.shapes.iter().map(Location::line).collect();
    assert_eq!(lines, [4, 5, 2, 2, 3]);
}

#[test]
fn a_group_without_an_instance_is_warned_about() {
    let content = r#"<shape type="shapegroup" id="lost"><shape type="disk"/></shape>"#;
    let file = read_with(content, &files(), &Options::default());
    let warnings: Vec<String> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, [r#"s.xml:2:14: warning: no instance shows the shapegroup "lost""#]);
}

#[test]
fn a_shape_without_a_material_is_grey_or_a_black_lamp() {
    let file = read(
        r#"<shape type="sphere"/>
        <shape type="sphere"><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>
        <shape type="sphere"/>"#,
    );
    let albedo = |i: usize| match file.scene.materials[file.scene.shapes[i].material] {
        Material::Diffuse { reflectance } => constant(&file.scene, reflectance),
        ref other => panic!("{other:?}"),
    };
    assert_eq!([albedo(0), albedo(1), albedo(2)], [Rgb::splat(0.5), Rgb::BLACK, Rgb::splat(0.5)]);
    let emission = file.scene.shapes[1].emission.unwrap();
    assert_eq!(constant(&file.scene, emission), Rgb::splat(3.0));
    assert_eq!(file.scene.shapes[0].emission, None);
    assert_eq!(file.origins.materials.len(), file.scene.materials.len());
}

#[test]
fn spellings_of_colours() {
    let reflectance = |property: &str| {
        let (scene, material, _) = material(&format!("<bsdf type=\"diffuse\">{property}</bsdf>"));
        match material {
            Material::Diffuse { reflectance } => constant(&scene, reflectance),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(reflectance(""), Rgb::splat(0.5));
    assert_eq!(reflectance(r#"<rgb name="reflectance" value="0.25"/>"#), Rgb::splat(0.25));
    assert_eq!(reflectance(r#"<rgb name="reflectance" value=".2 , .5	.3"/>"#), Rgb::new(0.2, 0.5, 0.3));
    assert_eq!(reflectance(r#"<float name="reflectance" value="0.25"/>"#), Rgb::splat(0.25));
    assert_eq!(reflectance(r#"<spectrum name="reflectance" value="0.25"/>"#), Rgb::splat(0.25));
    let hex = reflectance(r##"<rgb name="reflectance" value="#ff8000"/>"##);
    assert!((hex.g - 0.215_86).abs() < 1e-4 && hex.r == 1.0 && hex.b == 0.0, "{hex:?}");
    let file = read(
        r#"<emitter type="point"><spectrum name="intensity" filename="light.spd"/></emitter>
        <emitter type="point"><spectrum name="intensity" value="400:0, 500:8, 600:15.6, 700:18.4"/></emitter>
        <emitter type="constant"><spectrum name="radiance" type="d65"><float name="scale" value="2"/></spectrum></emitter>"#,
    );
    let [LightKind::Point { intensity, .. }, LightKind::Point { intensity: other, .. }, sky] =
        [0, 1, 2].map(|i| file.scene.lights[i].kind.clone())
    else {
        panic!("{:?}", file.scene.lights)
    };
    assert_eq!(intensity, other);
    assert!((intensity.r - 20.71).abs() < 0.01, "{intensity:?}");
    assert_eq!(sky, LightKind::Constant { radiance: Rgb::splat(2.0) });
}

/// The numbers are the means of what `scalar_spectral` of Mitsuba 3.9.1 shows of these lamps, to the 0.2 % that its observer
/// is brighter; what no screen shows has a channel of 0 here.
#[test]
fn spectra_by_type() {
    let black_body = |kelvin: &str, range: &str| {
        format!(r#"type="blackbody"><float name="temperature" value="{kelvin}"/>{range}"#)
    };
    let range = |min: &str, max: &str| {
        format!(r#"<float name="wavelength_min" value="{min}"/><float name="wavelength_max" value="{max}"/>"#)
    };
    let values = r#"<string name="values" value="0.1, 0.5, 0.2"/>"#;
    let regular = [0.434_09, 0.443_94, 0.192_20];
    for (spectrum, expected) in [
        (black_body("3000", ""), [733.71, 349.94, 112.81]),
        (black_body("6500", ""), [43_954.0, 41_449.0, 43_631.0]),
        (black_body("6500", &range("0", "10000")), [43_954.0, 41_449.0, 43_631.0]),
        (black_body("6500", &range("500", "600")), [9489.0, 42_856.0, 0.0]),
        (format!(r#"type="regular">{}{values}"#, range("400", "700")), regular),
        (format!(r#"type="regular"><string name="range" value="400 700"/>{values}"#), regular),
        (
            format!(r#"type="irregular"><string name="wavelengths" value="400, 450, 700"/>{values}"#),
            [0.323_61, 0.377_65, 0.395_10],
        ),
    ] {
        let file = read(&format!(
            r#"<emitter type="constant"><spectrum name="radiance" {spectrum}</spectrum></emitter>"#
        ));
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        let LightKind::Constant { radiance } = file.scene.lights[0].kind else {
            panic!("{:?}", file.scene.lights)
        };
        let off = radiance.zip(Rgb::from(expected), |a, b| (a - b).abs()).max_channel();
        // Ranges end sharply within a step of the integral: the narrow one differs by so much.
        let tolerance = if expected[2] == 0.0 { 0.01 } else { 0.003 };
        assert!(off < tolerance * expected[1], "{spectrum}: {radiance:?}, not {expected:?}");
    }
}

#[test]
fn materials() {
    let (scene, phong, _) = material(r#"<bsdf type="phong"/>"#);
    let Material::Phong { diffuse_reflectance, specular_reflectance, exponent } = phong else {
        panic!("{phong:?}")
    };
    assert_eq!(constant(&scene, diffuse_reflectance), Rgb::splat(0.5));
    assert_eq!((constant(&scene, specular_reflectance), exponent), (Rgb::splat(0.2), 30.0));

    let conductor =
        |properties: &str| match material(&format!("<bsdf type=\"conductor\">{properties}</bsdf>")) {
            (_, Material::Conductor { metal, .. }, _) => metal,
            other => panic!("{other:?}"),
        };
    assert_eq!(conductor(""), Metal::PerfectMirror);
    assert_eq!(conductor(r#"<string name="material" value="none"/>"#), Metal::PerfectMirror);
    assert_eq!(
        conductor(r#"<spectrum name="eta" value="0.789"/><rgb name="k" value="6 5 4"/>"#),
        Metal::Index { eta: Rgb::splat(0.789), k: Rgb::new(6.0, 5.0, 4.0) }
    );
    assert!(matches!(
        conductor(r#"<string name="material" value="Au"/>"#),
        Metal::Index { eta, .. } if eta.r < eta.b
    ));

    let iors = |kind: &str, properties: &str| match material(&format!(
        "<bsdf type=\"{kind}\">{properties}</bsdf>"
    ))
    .1
    {
        Material::Dielectric { int_ior, ext_ior, .. } => (int_ior, ext_ior),
        Material::ThinDielectric { int_ior, ext_ior, .. } => (int_ior, ext_ior),
        other => panic!("{other:?}"),
    };
    assert_eq!(iors("dielectric", ""), (1.5046, 1.000_277));
    let water = r#"<string name="int_ior" value="Water"/><integer name="ext_ior" value="1"/>"#;
    assert_eq!(iors("dielectric", water), (1.333, 1.0));
    assert_eq!(iors("thindielectric", water), (1.333, 1.0));
    assert_eq!(material(r#"<bsdf type="null"/>"#).1, Material::Null);
}

#[test]
fn masks_of_numbers_and_textures() {
    let mask = |opacity: &str| {
        let paper = r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#;
        let (scene, mask, warnings) = material(&format!(r#"<bsdf type="mask">{opacity}{paper}</bsdf>"#));
        assert_eq!(warnings, [""; 0]);
        let Material::Mask { opacity, inside } = mask else { panic!("{mask:?}") };
        assert!(matches!(scene.materials[inside], Material::TwoSided { .. }));
        scene.textures.list[opacity].clone()
    };
    assert_eq!(mask(""), Texture::Constant(Rgb::splat(0.5)));
    assert_eq!(mask(r#"<float name="opacity" value="0.2"/>"#), Texture::Constant(Rgb::splat(0.2)));
    let board = r#"<texture name="opacity" type="checkerboard"/>"#;
    assert!(matches!(mask(board), Texture::Checkerboard(_)));
}

#[test]
fn metals_without_a_measurement_are_mirrors() {
    let (_, metal, warnings) =
        material(r#"<bsdf type="conductor"><string name="material" value="SnTe_palik"/></bsdf>"#);
    assert!(matches!(metal, Material::Conductor { metal: Metal::PerfectMirror, .. }));
    assert_eq!(
        warnings,
        [
            r#"s.xml:2:55: warning: metal "SnTe_palik" cannot be rendered yet; it becomes a perfect mirror; give "eta" and "k" to have its colour"#
        ]
    );
    let (_, metal, warnings) =
        material(r#"<bsdf type="conductor"><string name="material" value="Na_palik"/></bsdf>"#);
    assert!(matches!(metal, Material::Conductor { metal: Metal::Index { .. }, .. }));
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn textures_and_images_know_where_they_stand() {
    let file = read(
        r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.3"/></bsdf>
        <bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="grey.png"/></texture></bsdf>
        <shape type="sphere"/>"#,
    );
    let textures = &file.scene.textures;
    assert_eq!((textures.list.len(), textures.images.len()), (3, 1));
    let places: Vec<_> = file.origins.textures.iter().map(ToString::to_string).collect();
    assert_eq!(places, ["s.xml:2:53", "s.xml:3:30", "s.xml:4:22"]);
    assert_eq!(file.origins.images[0].to_string(), "s.xml:3:103");
}

#[test]
fn two_sided_materials_take_one_or_two() {
    let (scene, both, _) = material(r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#);
    let first = scene.materials.iter_handles().next().unwrap().0;
    assert_eq!(both, Material::TwoSided { front: first, back: first });
    let (scene, both, _) = material(
        r#"<bsdf type="twosided"><ref id="a"/><bsdf type="conductor"/></bsdf>
        <bsdf type="diffuse" id="a"/><alias id="a" as="b"/>"#,
    );
    let Material::TwoSided { front, back } = both else { panic!("{both:?}") };
    assert!(matches!(scene.materials[front], Material::Diffuse { .. }));
    assert!(matches!(scene.materials[back], Material::Conductor { .. }));
    assert_eq!(scene.materials.len(), 3);
}

#[test]
fn materials_not_built_yet_give_way_to_their_nearest_kin() {
    let (scene, diffuse, warnings) = material(
        r#"<bsdf type="roughdiffuse"><float name="alpha" value="0.1"/><rgb name="reflectance" value="0.1"/></bsdf>"#,
    );
    assert_eq!(
        warnings,
        ["s.xml:2:13: warning: bsdf \"roughdiffuse\" cannot be rendered yet; diffuse stands for it"]
    );
    assert!(
        matches!(diffuse, Material::Diffuse { reflectance } if constant(&scene, reflectance) == Rgb::splat(0.1))
    );
    let (_, null, warnings) = material(r#"<bsdf type="polarizer"/>"#);
    assert_eq!((null, warnings.len()), (Material::Null, 1));
}

#[test]
fn known_but_meaningless_properties_are_only_warned_about() {
    let (_, _, warnings) = material(r#"<bsdf type="dielectric"><float name="alpha" value="0.1"/></bsdf>"#);
    assert_eq!(warnings, ["s.xml:2:52: warning: \"alpha\" means nothing in <bsdf type=\"dielectric\">"]);
}

#[test]
fn lights() {
    let file = read(
        r#"<emitter type="point" id="bulb"><point name="position" value="1, 2, 3"/><rgb name="intensity" value="4"/></emitter>
        <emitter type="point"><transform name="to_world"><translate x="5"/></transform></emitter>
        <emitter type="spot"><transform name="to_world"><lookat origin="0 0 0" target="1 0 0" up="0 1 0"/></transform></emitter>
        <emitter type="directional"><vector name="direction" x="0" y="-2" z="0"/><float name="irradiance" value="3"/></emitter>
        <emitter type="constant"/>
        <emitter type="envmap"><string name="filename" value="grey.png"/><float name="scale" value="2"/></emitter>"#,
    );
    let lights = &file.scene.lights;
    let position = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(lights[0].kind, LightKind::Point { position, intensity: Rgb::splat(4.0) });
    assert_eq!((lights[0].name.as_str(), lights[1].name.as_str()), ("bulb", "point at line 3"));
    assert_eq!(
        lights[1].kind,
        LightKind::Point { position: Vec3::new(5.0, 0.0, 0.0), intensity: Rgb::WHITE }
    );
    let LightKind::Spot { to_world, cutoff_deg, beam_width_deg, texture, .. } = &lights[2].kind else {
        panic!("{:?}", lights[2])
    };
    assert_eq!((*cutoff_deg, *beam_width_deg, *texture), (20.0, 15.0, None));
    assert_eq!(to_world.vector(Vec3::Z), Vec3::X);
    assert_eq!(lights[3].kind, LightKind::Directional { direction: -Vec3::Y, irradiance: Rgb::splat(3.0) });
    assert_eq!(lights[4].kind, LightKind::Constant { radiance: Rgb::WHITE });
    assert!(matches!(lights[5].kind, LightKind::Environment { scale: 2.0, .. }));
    assert_eq!(file.origins.lights[5].line(), 7);
}

#[test]
fn textures() {
    let file = read(
        r#"<bsdf type="diffuse"><ref name="reflectance" id="wood"/></bsdf>
        <texture type="bitmap" id="wood"><string name="filename" value="grey.png"/>
            <string name="filter_type" value="nearest"/><string name="wrap_mode" value="mirror"/>
            <transform name="to_uv"><matrix value="2 0 0 0.5  0 3 0 0  0 0 16 0  0 0 0 1"/></transform></texture>
        <texture type="bitmap"><string name="filename" value="grey.png"/><boolean name="raw" value="true"/></texture>
        <texture type="checkerboard"><rgb name="color1" value="0.9"/>
            <transform name="to_uv"><scale x="5" y="6"/></transform></texture>"#,
    );
    let textures = &file.scene.textures;
    let bitmaps: Vec<_> = textures
        .list
        .iter()
        .filter_map(|t| if let Texture::Bitmap(bitmap) = t { Some(bitmap) } else { None })
        .collect();
    assert_eq!(bitmaps.len(), 2);
    assert_eq!((bitmaps[0].filter, bitmaps[0].wrap), (BitmapFilter::Nearest, Wrap::Mirror));
    assert_eq!(bitmaps[0].to_uv.transform_point2(Vec2::ONE), Vec2::new(2.5, 3.0));
    // The grey channel, decoded or raw; alpha does not matter.
    let first = |i: usize| textures.images[bitmaps[i].image].pixel(0, 0).g;
    assert!((first(0) - 0.215_86).abs() < 1e-4 && (first(1) - 128.0 / 255.0).abs() < 1e-6);
    assert_eq!(textures.images[bitmaps[0].image].pixel(1, 0), Rgb::WHITE);
    let Some(Texture::Checkerboard(board)) = textures.list.iter().last() else { panic!("no checkerboard") };
    assert_eq!(textures.mean(board.color0), Rgb::splat(0.4));
    assert_eq!(textures.mean(board.color1), Rgb::splat(0.9));
    assert_eq!(board.to_uv.transform_point2(Vec2::ONE), Vec2::new(5.0, 6.0));
}

#[test]
fn what_cannot_be_rendered_yet_is_left_out_on_request() {
    let content = r#"<shape type="hair"/><emitter type="timed_sunsky"/><medium type="heterogeneous" id="fog">
        <volume name="sigma_t" type="openvdb"/></medium>
        <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/></shape>"#;
    let file = read_with(content, &files(), &Options { defines: Vec::new(), lenient: true });
    assert_eq!((file.scene.shapes.len(), file.scene.lights.len(), file.warnings.len()), (1, 0, 3));
    assert!(file.scene.media.list.is_empty() && file.scene.shapes[0].boundary == Boundary::default());
    assert_eq!(
        file.warnings[0].to_string(),
        "s.xml:2:14: warning: shape \"hair\" cannot be rendered yet and is left out"
    );
}

#[test]
fn includes_and_paths_are_relative_to_the_top_scene() {
    let files = MemoryFiles::default()
        .with(
            "a/b/top.xml",
            r#"<scene version="3.0.0"><path value="../$shared"/><include filename="parts\base.xml"/>
            <shape type="obj"><string name="filename" value="meshes/quad.obj"/></shape>
            <default name="shared" value="common"/></scene>"#,
        )
        .with(
            "a/b/parts/base.xml",
            r#"<scene version="2.0.0"><include filename="parts/film.xml"/>
            <sensor type="perspective"><ref id="film"/></sensor></scene>"#,
        )
        .with(
            "a/b/parts/film.xml",
            "\u{feff}<?xml version=\"1.0\"?>\r\n<!-- a film -->\r\n<scene version=\"2.0.0\">\
             <film type=\"hdrfilm\" id=\"film\"><integer name=\"width\" value=\"$w\"/></film>\
             <default name=\"w\" value=\"12\"/></scene>",
        )
        .with("a/common/meshes/quad.obj", QUAD);
    let file = read_scene(Path::new("a/b/top.xml"), &files, &Options::default()).unwrap();
    assert_eq!((file.scene.film.width, file.scene.meshes.len()), (12, 1));
}

#[test]
fn the_first_default_counts_wherever_it_stands() {
    let file = read(
        r#"<shape type="$kind"><float name="radius" value="$size"/></shape>
        <default name="kind" value="sphere"/><default name="size" value="3"/><default name="size" value="4"/>"#,
    );
    assert_eq!(file.scene.shapes[0].geometry, Geometry::Sphere { center: Vec3::ZERO, radius: 3.0 });
}

#[test]
fn flat_triangles_are_left_out_with_a_warning() {
    let files = MemoryFiles::default().with("m.obj", format!("{QUAD}f 1 1 2\n"));
    let content = r#"<shape type="obj"><string name="filename" value="m.obj"/></shape>"#;
    let file = read_with(content, &files, &Options::default());
    let warnings: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["s.xml:2:50: warning: m.obj: left out 1 triangle without area"]);
}

#[test]
fn skies_suns_and_projectors() {
    let file = read_with(
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0" y="0.6" z="0.8"/><float name="sky_scale" value="2"/>
        <float name="sun_aperture" value="1"/></emitter>
        <emitter type="sun"/>
        <emitter type="projector"><texture name="irradiance" type="bitmap"><string name="filename" value="grey.png"/></texture>
        <float name="fov" value="40"/><float name="scale" value="2"/></emitter>
        <emitter type="collimated"/>
        <shape type="rectangle"><emitter type="directionalarea"><rgb name="radiance" value="2"/></emitter></shape>"#,
        &files(),
        &Options::default(),
    );
    let kinds: Vec<_> = file.scene.lights.iter().map(|light| &light.kind).collect();
    let LightKind::Sun { direction, angular_radius_deg, irradiance } = kinds[0] else {
        panic!("{:?}", kinds[0])
    };
    assert!((*direction - Vec3::new(0.0, 0.6, 0.8)).length() < 1e-6 && *angular_radius_deg == 0.5);
    assert!(irradiance.min_channel() > 0.0);
    let LightKind::Environment { image, scale, to_world, .. } = kinds[1] else { panic!("{:?}", kinds[1]) };
    assert_eq!(*scale, 2.0);
    // The zenith of later versions is +z.
    assert!((to_world.vector(Vec3::Y) - Vec3::Z).length() < 1e-6);
    assert!(file.scene.textures.images[*image].pixel(0, 0).b > 0.0);
    // Tokyo, on the tenth of July at three in the afternoon: the sun is 47° high, and in the west, a little south of it. That
    // is where Mitsuba 3.9.1 has it.
    let LightKind::Sun { direction, .. } = kinds[2] else { panic!("{:?}", kinds[2]) };
    assert!((*direction - Vec3::new(0.0516, 0.6920, 0.7201)).length() < 1e-3, "{direction}");
    let LightKind::Projector { scale, fov_deg: 40.0, .. } = kinds[3] else { panic!("{:?}", kinds[3]) };
    assert_eq!(*scale, Rgb::splat(2.0 * std::f32::consts::PI));
    let LightKind::Spot { intensity, cutoff_deg, .. } = kinds[4] else { panic!("{:?}", kinds[4]) };
    // All of its power is in the cone.
    let solid_angle = std::f32::consts::PI * cutoff_deg.to_radians() * cutoff_deg.to_radians();
    assert!((intensity.g * solid_angle - 1.0).abs() < 1e-4, "{intensity:?}");
    let emission = file.scene.shapes[0].emission.expect("a lamp");
    let radiance = file.scene.textures.eval(emission, Vec2::ZERO);
    assert!((radiance.r - 2.0 * std::f32::consts::FRAC_1_PI).abs() < 1e-6);
    assert_eq!(file.warnings.len(), 3);
}

/// Against what Mitsuba 3.9.1 has (`scalar_rgb`), the ratios that docs/mitsuba.md lists: the mean of the sky above the horizon,
/// and what the sun brings to a surface that faces it. The models are two; a unit or a scale amiss would be tens or
/// hundreds of times as much.
#[test]
fn suns_and_skies_are_as_bright_as_listed() {
    let luminance = |c: Rgb| 0.212_671 * c.r + 0.715_160 * c.g + 0.072_169 * c.b;
    let of_mitsuba = [
        (2.0, 35.0_f32, [0.058_91, 0.094_86, 0.144_93], 1.62, [1.4532, 1.1684, 0.8120], 0.98),
        (4.0, 70.0, [0.082_24, 0.120_19, 0.186_29], 1.42, [1.4633, 1.2298, 0.9637], 0.88),
        (8.0, 10.0, [0.102_06, 0.088_27, 0.070_05], 0.77, [0.394_86, 0.221_33, 0.084_29], 0.08),
    ];
    for (turbidity, height, mean, of_sky, irradiance_there, of_sun) in of_mitsuba {
        let (z, x) = real::sin_cos(height.to_radians());
        let content = format!(
            r#"<emitter type="sunsky"><float name="turbidity" value="{turbidity}"/>
            <vector name="sun_direction" x="{x}" y="0" z="{z}"/></emitter>"#
        );
        let file = read_with(&content, &files(), &Options::default());
        let [LightKind::Sun { irradiance, .. }, LightKind::Environment { image, scale: 1.0, .. }] =
            [0, 1].map(|i| file.scene.lights[i].kind.clone())
        else {
            panic!("{:?}", file.scene.lights)
        };
        let ratio = luminance(irradiance) / luminance(Rgb::from(irradiance_there));
        assert!((ratio - of_sun).abs() < 0.01, "sun {turbidity} {height}: {ratio}, not {of_sun}");
        let image = &file.scene.textures.images[image];
        let mut sum = (0.0, 0.0);
        for y in 0..image.height / 2 {
            let weight = real::sin(std::f32::consts::PI * y as f32 / (image.height - 1) as f32);
            for x in 0..image.width {
                sum = (sum.0 + weight * luminance(image.pixel(x, y)), sum.1 + weight);
            }
        }
        let ratio = sum.0 / sum.1 / luminance(Rgb::from(mean));
        assert!((ratio - of_sky).abs() < 0.03, "sky {turbidity} {height}: {ratio}, not {of_sky}");
    }
}

#[test]
fn the_sun_of_version_0_6_stands_over_y() {
    let text = r#"<scene version="0.6.0"><sensor type="perspective"/><emitter type="sun">
        <vector name="sunDirection" x="0" y="1" z="0"/><float name="sunScale" value="3"/></emitter>
        <emitter type="sun"/></scene>"#;
    let file = read_scene_str("s.xml", text, &files(), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let direction = |i: usize| match file.scene.lights[i].kind {
        LightKind::Sun { direction, .. } => direction,
        _ => panic!("{:?}", file.scene.lights),
    };
    assert!((direction(0) - Vec3::Y).length() < 1e-6);
    // By the clock, the west is at −x and the south at +z.
    assert!((direction(1) - Vec3::new(-0.6920, 0.7201, 0.0516)).length() < 1e-3, "{}", direction(1));
}

#[test]
fn lamps_of_ies_files() {
    let ies = "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n500 250 0\n";
    let files = files().with("lamp.ies", ies);
    let content = r#"<emitter type="ies"><string name="filename" value="lamp.ies"/><float name="intensity" value="0.5"/></emitter>"#;
    let file = read_with(content, &files, &Options::default());
    let LightKind::Goniometric { intensity, table, .. } = file.scene.lights[0].kind else {
        panic!("{:?}", file.scene.lights)
    };
    assert_eq!(intensity, Rgb::splat(250.0));
    let image = &file.scene.textures.images[table];
    assert_eq!((image.brightest(), image.pixel(0, image.height - 1)), (1.0, Rgb::WHITE));
    assert_eq!(image.pixel(0, 0), Rgb::BLACK);
}

/// As in the box of Cornell that comes with Mitsuba: the lamp has an id, and the shape refers to it.
#[test]
fn lamps_that_shapes_refer_to() {
    let content = r#"<emitter type="area" id="lamp"><rgb name="radiance" value="3"/></emitter>
        <shape type="Rectangle"><ref id="lamp"/></shape>"#;
    let file = read_with(content, &files(), &Options::default());
    assert_eq!((file.scene.lights.len(), file.warnings.len()), (0, 0));
    assert!(file.scene.shapes[0].emission.is_some() && file.scene.shapes[0].geometry == Geometry::Rectangle);
}

#[test]
fn scenes_without_a_sensor_are_seen_whole() {
    let text =
        r#"<scene version="3.0.0"><shape type="disk"><sensor type="irradiancemeter"/></shape></scene>"#;
    let file = read_scene_str("s.xml", text, &files(), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(file.fitted.camera && !file.fitted.sky);
    let messages: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    let expected = "s.xml:1:43: warning: a sensor on a shape measures and takes no picture: it is left out";
    assert_eq!(messages, [expected]);
}

#[test]
fn no_metal_has_a_negative_index() {
    let content =
        r#"<bsdf type="conductor"><rgb name="eta" value="-0.05, 4, 5"/><rgb name="k" value="1"/></bsdf>"#;
    let file = read_with(content, &files(), &Options::default());
    let Some(Material::Conductor { metal: Metal::Index { eta, .. }, .. }) =
        file.scene.materials.iter().next()
    else {
        panic!("a conductor")
    };
    assert_eq!((*eta, file.warnings.len()), (Rgb::new(0.0, 4.0, 5.0), 1));
}

#[test]
fn properties_that_nobody_knows_are_left_alone_by_the_lenient() {
    let content = r#"<shape type="sphere"><boolean name="use_path_guiding" value="true"/></shape>"#;
    let file = read_with(content, &files(), &Options { defines: Vec::new(), lenient: true });
    let warning = file.warnings[0].to_string();
    assert!(
        warning.contains("warning: <shape type=\"sphere\"> has no property \"use_path_guiding\""),
        "{warning}"
    );
}

#[test]
fn a_group_keeps_what_has_an_area() {
    let files = files().with("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    let group = |more: &str| {
        format!(
            r#"<shape type="shapegroup" id="g"><shape type="obj"><string name="filename" value="flat.obj"/></shape>{more}</shape>
<shape type="instance"><ref id="g"/></shape>"#
        )
    };
    let file = read_with(&group(r#"<shape type="disk"/>"#), &files, &Options::default());
    assert_eq!((file.scene.instances.len(), file.scene.all_shapes().count()), (1, 1));
    let file = read_with(&group(""), &files, &Options::default());
    let last = file.warnings.last().expect("it is said").message.clone();
    assert!(file.scene.instances.is_empty() && last.contains("its instances show nothing"), "{last}");
}

#[test]
fn lamps_that_no_shape_has_are_told() {
    let content = r#"<emitter type="area" id="a"/><emitter type="area" id="b"/><shape type="disk"><ref id="a"/></shape>"#;
    let file = read_with(content, &files(), &Options::default());
    let messages: Vec<&str> = file.warnings.iter().map(|w| w.message.as_str()).collect();
    assert_eq!(messages, ["no shape refers to the emitter \"b\""]);
}
