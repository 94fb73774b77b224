//! Scenes of Mitsuba 0.5 and 0.6, and what becomes of them.

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::material::{Material, Metal};
use nephroid::math::{Vec2, Vec3};
use nephroid::medium::Coefficient;
use nephroid::scene::Scene;
use nephroid::shape::Geometry;
use nephroid::texture::Texture;
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::{Options, SceneFile};

/// One cell with 7 in it, in a box of side 2 around the origin.
fn vol() -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 1, 1, 1, 1].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([-1.0f32, -1.0, -1.0, 1.0, 1.0, 1.0, 7.0].iter().flat_map(|v| v.to_le_bytes()));
    out
}

fn read_text(text: &str) -> Result<SceneFile, String> {
    let part = r#"<scene version="3.0.0"><shape type="sphere" id="new"><ref name="interior" id="fog"/></shape></scene>"#;
    let files = MemoryFiles::default().with("smoke.vol", vol()).with("new.xml", part);
    read_scene_str("s.xml", text, &files, &Options::default()).map_err(|e| e.to_string())
}

/// A scene of version 0.5 whose content starts in the second line.
fn read(content: &str) -> SceneFile {
    let text = format!("<scene version=\"0.5.0\"><sensor type=\"perspective\"/>\n{content}</scene>");
    read_text(&text).unwrap_or_else(|e| panic!("{content}\n{e}"))
}

fn warnings(file: &SceneFile) -> Vec<String> {
    file.warnings.iter().map(ToString::to_string).collect()
}

fn reflectance(scene: &Scene, material: &Material) -> Rgb {
    let Material::Diffuse { reflectance } = material else { panic!("{material:?}") };
    let Texture::Constant(value) = scene.textures.list[*reflectance] else { panic!("no colour") };
    value
}

#[test]
fn old_spellings() {
    let file = read_text(
        r#"<scene version="0.6.0"><default name="camelCase" value="30"/>
        <integrator type="volpath"><integer name="maxDepth" value="9"/><integer name="version" value="6"/></integrator>
        <sensor type="perspective"><float name="fov" value="$camelCase"/><string name="fovAxis" value="smaller"/>
            <float name="nearClip" value="1"/><float name="farClip" value="2"/><float name="focusDistance" value="1"/>
            <transform name="toWorld"><lookAt origin="1, 2, 3" target="1, 2, 4" up="0, 1, 0"/></transform>
            <sampler type="ldsampler"><integer name="sampleCount" value="7"/></sampler></sensor>
        <shape type="sphere"><bsdf type="dielectric"><float name="intIOR" value="1.25"/>
            <string name="extIOR" value="vacuum"/><rgb name="specularReflectance" value="1"/></bsdf></shape></scene>"#,
    )
    .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(file.warnings, []);
    assert_eq!((file.integrator.name.as_str(), file.integrator.parameters.len()), ("volpath", 1));
    assert_eq!(file.integrator.get_int("max_depth").expect("a number"), Some(9));
    assert_eq!(file.sample_count, Some(7));
    let camera = &file.scene.camera;
    assert!(matches!(
        camera.projection,
        Projection::Perspective { fov_deg: 30.0, fov_axis: FovAxis::Smaller, .. }
    ));
    assert_eq!(camera.to_world.point(Vec3::ZERO), Vec3::new(1.0, 2.0, 3.0));
    assert!(matches!(
        file.scene.materials.iter().next(),
        Some(Material::Dielectric { int_ior: 1.25, ext_ior: 1.0, .. })
    ));
}

#[test]
fn spectra_are_rgb() {
    let file = read(
        r##"<bsdf type="diffuse"><spectrum name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>
        <bsdf type="diffuse"><srgb name="reflectance" value="0.5, 1, 0"/></bsdf>
        <bsdf type="diffuse"><srgb name="reflectance" value="#ff0000"/></bsdf>
        <emitter type="point"><spectrum name="intensity" value="16"/></emitter>
        <emitter type="point"><spectrum name="intensity" value="400:0, 500:2, 600:3.9, 700:4.6"/></emitter>"##,
    );
    let scene = &file.scene;
    let colours: Vec<_> = scene.materials.iter().map(|m| reflectance(scene, m)).collect();
    assert_eq!((colours[0], colours[2]), (Rgb::new(0.1, 0.2, 0.3), Rgb::new(1.0, 0.0, 0.0)));
    assert!((colours[1].r - 0.214_041).abs() < 1e-5 && colours[1].g == 1.0 && colours[1].b == 0.0);
    let intensity = |i: usize| match scene.lights[i].kind {
        LightKind::Point { intensity, .. } => intensity,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(intensity(0), Rgb::splat(16.0));
    assert!((intensity(1).r - 5.178).abs() < 1e-3);
}

#[test]
fn textures_are_scaled_and_moved() {
    let file = read(
        r#"<texture type="checkerboard"><float name="uscale" value="10"/><float name="voffset" value="0.5"/></texture>
        <texture type="checkerboard"/>"#,
    );
    assert_eq!(file.warnings, []);
    let to_uv = |i: usize| {
        let boards = file.scene.textures.list.iter().filter_map(|texture| match texture {
            Texture::Checkerboard(board) => Some(board.to_uv),
            _ => None,
        });
        boards.collect::<Vec<_>>()[i].transform_point2(Vec2::new(0.5, 0.25))
    };
    assert_eq!([to_uv(0), to_uv(1)], [Vec2::new(5.0, 0.75), Vec2::new(0.5, 0.25)]);
}

#[test]
fn smoke_in_a_box_without_a_material() {
    let file = read(
        r#"<medium type="heterogeneous" id="smoke"><string name="method" value="woodcock"/>
<volume name="density" type="gridvolume"><string name="filename" value="smoke.vol"/></volume>
<volume name="albedo" type="constvolume"><rgb name="value" value="0.9"/></volume>
<float name="scale" value="100"/><float name="stepSize" value="0.1"/></medium>
<shape type="cube"><ref name="interior" id="smoke"/></shape><shape type="sphere"/>"#,
    );
    assert_eq!(
        warnings(&file),
        [
            "s.xml:2:70: warning: \"method\" means nothing in <medium type=\"heterogeneous\">",
            "s.xml:5:64: warning: \"step_size\" means nothing in <medium type=\"heterogeneous\">",
        ]
    );
    let scene = &file.scene;
    let medium = scene.media.list.iter().next().expect("a medium");
    let Coefficient::Grid { to_world, scale, .. } = medium.sigma_t else { panic!("{medium:?}") };
    // The box of the file is used without being asked for.
    assert_eq!((scale, to_world.point(Vec3::ZERO)), (100.0, Vec3::NEG_ONE));
    assert_eq!(medium.albedo, Coefficient::Constant(Rgb::splat(0.9)));
    assert_eq!(scene.materials[scene.shapes[0].material], Material::Null);
    assert!(scene.shapes[0].boundary.interior.is_some());
    assert_eq!(reflectance(scene, &scene.materials[scene.shapes[1].material]), Rgb::splat(0.5));
}

#[test]
fn what_a_boundary_with_a_material_or_a_lamp_keeps() {
    let file = read(
        r#"<medium type="homogeneous" id="fog"><rgb name="sigmaS" value="1"/><rgb name="sigmaA" value="1"/></medium>
        <bsdf type="dielectric" id="glass"/>
        <shape type="sphere"><ref id="glass"/><ref name="interior" id="fog"/></shape>
        <shape type="sphere"><ref name="interior" id="fog"/><emitter type="area"/></shape>"#,
    );
    let scene = &file.scene;
    let material = |i: usize| &scene.materials[scene.shapes[i].material];
    assert!(matches!(material(0), Material::Dielectric { .. }), "{:?}", material(0));
    assert_eq!(reflectance(scene, material(1)), Rgb::BLACK);
    assert_eq!(
        scene.media.list.iter().next().expect("a medium").albedo,
        Coefficient::Constant(Rgb::splat(0.5))
    );
}

#[test]
fn what_used_to_go_without_saying() {
    let file = read(r#"<bsdf type="conductor"/>"#);
    let Some(Material::Conductor { metal: Metal::Index { eta, .. }, .. }) =
        file.scene.materials.iter().next()
    else {
        panic!("no copper")
    };
    assert!(eta.r < eta.g && eta.g < eta.b * 1.2, "{eta:?}");
    let text = r#"<scene version="0.5.0"><sensor type="perspective"/><medium type="homogeneous"/></scene>"#;
    assert_eq!(
        read_text(text).expect_err("no coefficients"),
        "s.xml:1:52: error: the coefficients of \"skin1\" are not known here; write them: <rgb name=\"sigma_s\" \
         value=\"…\"/> and <rgb name=\"sigma_a\" value=\"…\"/>, scattering and absorption per length"
    );
}

#[test]
fn each_file_has_a_version_of_its_own() {
    let file = read(
        r#"<medium type="homogeneous" id="fog"><rgb name="sigmaS" value="1"/><rgb name="sigmaA" value="1"/></medium>
<include filename="new.xml"/><shape type="cube" id="old"><ref name="interior" id="fog"/></shape>"#,
    );
    let scene = &file.scene;
    let [new, old] = &scene.shapes[..] else { panic!("two shapes") };
    assert!(matches!(new.geometry, Geometry::Sphere { .. }));
    assert!(matches!(scene.materials[new.material], Material::Diffuse { .. }));
    assert_eq!(scene.materials[old.material], Material::Null);
    assert_eq!(file.warnings.len(), 1);
}

#[test]
fn old_names_are_not_those_of_newer_versions() {
    let text = r#"<scene version="2.0.0"><sensor type="perspective"/>
<shape type="sphere"><transform name="toWorld"/></shape></scene>"#;
    assert_eq!(
        read_text(text).expect_err("an unknown name"),
        "s.xml:2:39: error: <shape type=\"sphere\"> has no property \"toWorld\"; did you mean \"to_world\"?"
    );
    let text = r#"<scene version="0.6.0"><sensor type="perspective"/>
<shape type="sphere"><float name="raduis" value="1"/></shape></scene>"#;
    let file = read_text(text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        file.warnings[0].to_string(),
        "s.xml:2:35: warning: <shape type=\"sphere\"> has no property \"raduis\"; did you mean \"radius\"?"
    );
}

/// Mitsuba 2 and 3 take what says 1 for an older file.
#[test]
fn version_1_is_an_old_one() {
    let text = r#"<scene version="1.0.0"><sensor type="perspective"/>
<shape type="sphere"><bsdf type="dielectric"><float name="intIOR" value="1.25"/></bsdf></shape></scene>"#;
    let file = read_text(text).unwrap_or_else(|e| panic!("{e}"));
    assert!(matches!(&file.scene.materials.iter().next(), Some(Material::Dielectric { int_ior: 1.25, .. })));
}

#[test]
fn what_is_given_twice_counts_as_given_last() {
    let file = read(
        r#"<shape type="sphere"><float name="radius" value="1"/><float name="radius" value="2"/></shape>"#,
    );
    assert!(matches!(file.scene.shapes[0].geometry, Geometry::Sphere { radius: 2.0, .. }));
    assert_eq!(warnings(&file), ["s.xml:2:54: warning: \"radius\" is given twice; the last counts"]);
}

#[test]
fn settings_of_old_films_mean_nothing() {
    let text = r#"<scene version="0.6.0"><sensor type="perspective"><film type="ldrfilm">
<boolean name="attachLog" value="false"/><string name="tonemapMethod" value="reinhard"/></film></sensor></scene>"#;
    let file = read_text(text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        warnings(&file),
        [
            "s.xml:2:34: warning: \"attach_log\" means nothing in <film type=\"ldrfilm\">",
            "s.xml:2:78: warning: \"tonemap_method\" means nothing in <film type=\"ldrfilm\">"
        ]
    );
}
