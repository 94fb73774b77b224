//! Rough, layered and mixed materials of Mitsuba's files, and their textures.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Distribution, Material, Metal};
use nephroid::scene::Scene;
use nephroid::texture::{Image, Texture, Wrap};
use nephroid_formats::Options;
use nephroid_formats::image::encode_png;
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;

fn read(version: &str, content: &str) -> Result<(Scene, Vec<String>), String> {
    let png = encode_png(&Image::filled(2, 2, Rgb::splat(0.5))).expect("a picture");
    let files = MemoryFiles::default().with("a.png", png);
    let text = format!("<scene version=\"{version}\"><sensor type=\"perspective\"/>\n{content}</scene>");
    let file = read_scene_str("s.xml", &text, &files, &Options::default()).map_err(|e| e.to_string())?;
    Ok((file.scene, file.warnings.iter().map(ToString::to_string).collect()))
}

/// The last material that is stored, which is that of the outermost element, and the warnings.
#[track_caller]
fn material(version: &str, content: &str) -> (Scene, Material, Vec<String>) {
    let (scene, warnings) = read(version, content).unwrap_or_else(|e| panic!("{content}\n{e}"));
    let last = scene.materials.iter().last().expect("a material").clone();
    (scene, last, warnings)
}

#[track_caller]
fn silent(content: &str) -> (Scene, Material) {
    let (scene, material, warnings) = material("3.0.0", content);
    assert_eq!(warnings, [""; 0], "{content}");
    (scene, material)
}

#[track_caller]
fn refused(content: &str, message: &str) {
    assert_eq!(read("3.0.0", content).expect_err("it is wrong"), message, "{content}");
}

fn grey(scene: &Scene, texture: Handle<Texture>) -> f32 {
    match scene.textures.list[texture] {
        Texture::Constant(Rgb { r, g, b }) if r == g && g == b => r,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn rough_metals_and_glass() {
    let (scene, metal) = silent(
        r#"<bsdf type="roughconductor"><string name="material" value="Al"/><string name="distribution" value="GGX"/>
        <float name="alpha_u" value="0.2"/><float name="alpha_v" value="0.3"/><boolean name="sample_visible" value="false"/></bsdf>"#,
    );
    let Material::RoughConductor { metal: Metal::Index { .. }, roughness, .. } = metal else {
        panic!("{metal:?}")
    };
    assert_eq!(roughness.distribution, Distribution::Ggx);
    assert_eq!([grey(&scene, roughness.alpha_u), grey(&scene, roughness.alpha_v)], [0.2, 0.3]);
    let (scene, glass) =
        silent(r#"<bsdf type="roughdielectric"><string name="int_ior" value="water"/></bsdf>"#);
    let Material::RoughDielectric { int_ior, roughness, .. } = glass else { panic!("{glass:?}") };
    assert_eq!((int_ior, roughness.distribution), (1.333, Distribution::Beckmann));
    assert_eq!((grey(&scene, roughness.alpha_u), roughness.alpha_v), (0.1, roughness.alpha_u));
    let textured = r#"<texture name="alpha" type="bitmap"><string name="filename" value="a.png"/></texture>"#;
    let (scene, metal) = silent(&format!(r#"<bsdf type="roughconductor">{textured}</bsdf>"#));
    let Material::RoughConductor { roughness, .. } = metal else { panic!("{metal:?}") };
    assert!(matches!(scene.textures.list[roughness.alpha_u], Texture::Bitmap(_)));
    let (_, _, warnings) = material(
        "0.6.0",
        r#"<bsdf type="roughconductor"><string name="distribution" value="phong"/><float name="alpha" value="0.2"/></bsdf>"#,
    );
    assert_eq!(
        warnings,
        [
            r#"s.xml:2:64: warning: the distribution "phong" is not known here; "beckmann" stands for it; its highlights have shorter tails"#
        ]
    );
    refused(
        r#"<bsdf type="roughconductor"><float name="alpha" value="0.1"/><float name="alpha_u" value="0.1"/></bsdf>"#,
        r#"s.xml:2:56: error: give either "alpha" or "alpha_u" and "alpha_v""#,
    );
}

#[test]
fn plastics() {
    let (scene, plastic) = silent(r#"<bsdf type="plastic"/>"#);
    let Material::Plastic { int_ior, ext_ior, diffuse_reflectance, nonlinear, roughness, .. } = plastic
    else {
        panic!("{plastic:?}")
    };
    assert_eq!((int_ior, ext_ior, nonlinear, roughness), (1.49, 1.000_277, false, None));
    assert_eq!(grey(&scene, diffuse_reflectance), 0.5);
    let (_, plastic) = silent(r#"<bsdf type="roughplastic"><boolean name="nonlinear" value="true"/></bsdf>"#);
    assert!(matches!(plastic, Material::Plastic { nonlinear: true, roughness: Some(_), .. }));
}

#[test]
fn principled_materials() {
    let (scene, principled) = silent(
        r#"<bsdf type="principled"><rgb name="base_color" value="0.1, 0.2, 0.3"/><float name="metallic" value="0.7"/>
        <float name="specular" value="0.5"/></bsdf>"#,
    );
    let Material::Principled(principled) = principled else { panic!("{principled:?}") };
    assert_eq!([grey(&scene, principled.metallic), grey(&scene, principled.roughness)], [0.7, 0.5]);
    assert!((principled.eta - 1.5).abs() < 1e-6, "{}", principled.eta);
    refused(
        r#"<bsdf type="principled"><float name="eta" value="1.5"/><float name="specular" value="0.5"/></bsdf>"#,
        r#"s.xml:2:13: error: give either "eta" or "specular""#,
    );
    refused(
        r#"<bsdf type="principled"><float name="eta" value="0.5"/></bsdf>"#,
        r#"s.xml:2:50: error: "eta" must be at least 1, not 0.5"#,
    );
    let (_, thin, warnings) =
        material("3.0.0", r#"<bsdf type="principledthin"><float name="diff_trans" value="1"/></bsdf>"#);
    assert!(matches!(thin, Material::Blend { .. }), "{thin:?}");
    assert_eq!(warnings.len(), 1);
}

#[test]
fn blends_of_two_and_of_many() {
    let (scene, blend) = silent(
        r#"<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="conductor"/></bsdf>"#,
    );
    let Material::Blend { weight, first, second } = blend else { panic!("{blend:?}") };
    assert_eq!(grey(&scene, weight), 0.3);
    assert!(matches!(scene.materials[first], Material::Diffuse { .. }));
    assert!(matches!(scene.materials[second], Material::Conductor { .. }));
    // 0.5, 0.25 and 0.25, of which the last is what is missing, and black.
    let (scene, mixture, warnings) = material(
        "0.6.0",
        r#"<bsdf type="mixturebsdf"><string name="weights" value="0.5, 0.25"/><bsdf type="conductor"/><bsdf type="diffuse"/></bsdf>"#,
    );
    assert_eq!(warnings, [""; 0]);
    let Material::Blend { weight, first, second: black } = mixture else { panic!("{mixture:?}") };
    assert_eq!(grey(&scene, weight), 0.25);
    let Material::Diffuse { reflectance } = scene.materials[black] else { panic!("not black") };
    assert_eq!(grey(&scene, reflectance), 0.0);
    let Material::Blend { weight, .. } = scene.materials[first] else { panic!("no blend") };
    assert!((grey(&scene, weight) - 1.0 / 3.0).abs() < 1e-6);
    refused(
        r#"<bsdf type="mixturebsdf"><string name="weights" value="0.5"/><bsdf type="conductor"/><bsdf type="diffuse"/></bsdf>"#,
        r#"s.xml:2:13: error: "mixturebsdf" takes a weight that is not negative for each material, not 1 for 2"#,
    );
    refused(
        r#"<bsdf type="blendbsdf"><bsdf type="conductor"/></bsdf>"#,
        r#"s.xml:2:13: error: "blendbsdf" takes two materials, not 1"#,
    );
}

#[test]
fn coats() {
    let coat = |inside: &str| {
        material(
            "0.6.0",
            &format!(
                r#"<bsdf type="coating"><float name="intIOR" value="1.5"/><float name="extIOR" value="1"/>{inside}</bsdf>"#
            ),
        )
    };
    let (_, coated, warnings) = coat(r#"<bsdf type="conductor"/>"#);
    assert_eq!(warnings, [""; 0]);
    assert!(matches!(
        coated,
        Material::CoatedConductor { coat_ior: 1.5, roughness: None, coat_roughness: None, .. }
    ));
    let (_, coated, _) = coat(r#"<bsdf type="roughconductor"/>"#);
    assert!(matches!(coated, Material::CoatedConductor { roughness: Some(_), .. }));
    let (_, coated, _) = coat(r#"<bsdf type="diffuse"/>"#);
    assert!(matches!(coated, Material::Plastic { int_ior: 1.5, nonlinear: true, roughness: None, .. }));
    let (scene, coated, _) = coat(r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#);
    let Material::TwoSided { front, .. } = coated else { panic!("{coated:?}") };
    assert!(matches!(scene.materials[front], Material::Plastic { .. }));
    let (_, _, warnings) = coat(r#"<bsdf type="phong"/>"#);
    assert_eq!(
        warnings,
        [r#"s.xml:2:13: warning: bsdf "coating" cannot be rendered yet; the material in it stands for it"#]
    );
}

#[test]
fn wards_model_is_a_blend() {
    let (scene, ward, warnings) =
        material("0.6.0", r#"<bsdf type="ward"><float name="alphaU" value="0.1"/></bsdf>"#);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let Material::Blend { weight, first, .. } = ward else { panic!("{ward:?}") };
    // 0.5 and 0.2, each in full.
    assert!((grey(&scene, weight) - 2.0 / 7.0).abs() < 1e-6);
    let Material::Diffuse { reflectance } = scene.materials[first] else { panic!("not diffuse") };
    assert!((grey(&scene, reflectance) * 5.0 / 7.0 - 0.5).abs() < 1e-6);
}

#[test]
fn tilted_normals() {
    let map = r#"<texture type="bitmap" name="normalmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture>"#;
    let (scene, material) = silent(&format!(r#"<bsdf type="normalmap">{map}<bsdf type="diffuse"/></bsdf>"#));
    let Material::NormalMap { normals, scale: 1.0, against_v: false, inside } = material else {
        panic!("{material:?}")
    };
    assert_eq!(scene.textures.eval(normals, nephroid::math::Vec2::ZERO).r, 128.0 / 255.0);
    assert!(matches!(scene.materials[inside], Material::Diffuse { .. }));
    let bumps = r#"<bsdf type="bumpmap"><texture type="checkerboard"/><float name="scale" value="0.1"/><bsdf type="diffuse"/></bsdf>"#;
    let (_, material) = silent(bumps);
    assert!(matches!(material, Material::BumpMap { scale: 0.1, .. }));
    let (_, warnings) = read(
        "3.0.0",
        &format!(
            r#"<bsdf type="normalmap">{}<bsdf type="diffuse"/></bsdf>"#,
            map.replace(r#"<boolean name="raw" value="true"/>"#, "")
        ),
    )
    .expect("a scene");
    assert!(warnings[0].contains("the normals are decoded from sRGB"), "{warnings:?}");
    refused(
        r#"<bsdf type="normalmap"><bsdf type="diffuse"/></bsdf>"#,
        r#"s.xml:2:13: error: "normalmap" lacks its texture"#,
    );
}

#[test]
fn leaves_of_version_0_6() {
    let (scene, leaf, warnings) =
        material("0.6.0", r#"<bsdf type="difftrans"><spectrum name="transmittance" value="0.3"/></bsdf>"#);
    assert_eq!(warnings, [""; 0]);
    let Material::DiffuseTransmission { reflectance, transmittance } = leaf else { panic!("{leaf:?}") };
    assert_eq!([grey(&scene, reflectance), grey(&scene, transmittance)], [0.0, 0.3]);
}

/// The texture of a diffuse material.
#[track_caller]
fn texture(version: &str, texture: &str) -> (Scene, Texture, Vec<String>) {
    let (scene, material, warnings) = material(version, &format!(r#"<bsdf type="diffuse">{texture}</bsdf>"#));
    let Material::Diffuse { reflectance } = material else { panic!("{material:?}") };
    let texture = scene.textures.list[reflectance].clone();
    (scene, texture, warnings)
}

#[test]
fn textures_of_textures_and_of_vertices() {
    let (_, color, _) = texture(
        "3.0.0",
        r#"<texture name="reflectance" type="mesh_attribute"><string name="name" value="vertex_color"/></texture>"#,
    );
    assert_eq!(color, Texture::VertexColor);
    let (_, _, warnings) = texture(
        "3.0.0",
        r#"<texture name="reflectance" type="mesh_attribute"><string name="name" value="face_color"/></texture>"#,
    );
    assert_eq!(warnings.len(), 1);
    let (scene, product, warnings) = texture(
        "0.6.0",
        r#"<texture name="reflectance" type="scale"><float name="scale" value="0.5"/><texture type="checkerboard"/></texture>"#,
    );
    assert_eq!(warnings, [""; 0]);
    let Texture::Scale { a, b } = product else { panic!("{product:?}") };
    assert!(matches!(scene.textures.list[a], Texture::Checkerboard(_)));
    assert_eq!(grey(&scene, b), 0.5);
    let (_, raw, _) = texture(
        "3.0.0",
        r#"<texture name="reflectance" type="rawconstant"><float name="value" value="0.25"/></texture>"#,
    );
    assert_eq!(raw, Texture::Constant(Rgb::splat(0.25)));
}

#[test]
fn bitmaps_of_older_versions() {
    let bitmap = |properties: &str| {
        texture(
            "0.5.0",
            &format!(
                r#"<texture name="reflectance" type="ldrtexture"><string name="filename" value="a.png"/>{properties}</texture>"#
            ),
        )
    };
    let (scene, raw, warnings) = bitmap(
        r#"<float name="gamma" value="1"/><string name="filterType" value="ewa"/><string name="wrapMode" value="zero"/>"#,
    );
    assert_eq!(warnings, [""; 0]);
    let Texture::Bitmap(raw) = raw else { panic!("{raw:?}") };
    assert_eq!((scene.textures.images[raw.image].pixel(0, 0).r, raw.wrap), (128.0 / 255.0, Wrap::Black));
    let (_, _, warnings) = bitmap(r#"<float name="gamma" value="1.8"/>"#);
    assert!(warnings[0].ends_with("the curve of sRGB stands for a gamma of 1.8"), "{warnings:?}");
    let (_, channel, _) = bitmap(r#"<string name="channel" value="g"/>"#);
    assert!(matches!(channel, Texture::Channel { channel: 1, .. }));
}

#[test]
fn reflectances_of_phong_that_add_up_to_more_than_one_are_scaled_down() {
    let content = r#"<bsdf type="phong"><float name="diffuse_reflectance" value="0.75"/>
<float name="specular_reflectance" value="0.5"/></bsdf>"#;
    let (scene, phong, warnings) = material("3.0.0", content);
    assert_eq!(
        warnings,
        ["s.xml:2:13: warning: the two reflectances add up to more than 1: both are scaled down"]
    );
    let Material::Phong { diffuse_reflectance, specular_reflectance, .. } = phong else {
        panic!("{phong:?}")
    };
    let [diffuse, specular] = [diffuse_reflectance, specular_reflectance].map(|handle| grey(&scene, handle));
    assert!((diffuse - 0.6).abs() < 1e-6 && (specular - 0.4).abs() < 1e-6, "{diffuse} {specular}");
}

#[test]
fn numbers_that_are_no_colour_may_come_as_a_vector() {
    let content = r#"<bsdf type="normalmap"><texture type="rawconstant"><vector name="value" value="0.25, 0.5, 1"/></texture>
<bsdf type="diffuse"/></bsdf>"#;
    let (scene, map) = silent(content);
    let Material::NormalMap { normals, .. } = map else { panic!("{map:?}") };
    assert_eq!(scene.textures.list[normals], Texture::Constant(Rgb::new(0.25, 0.5, 1.0)));
}
