//! Materials and textures of good models, and of some that are bad.

use nephroid::color::Rgb;
use nephroid::material::{Dispersion, Material, MetallicRoughness};
use nephroid::math::Vec2;
use nephroid::medium::Coefficient;
use nephroid::texture::{Bitmap, BitmapFilter, Image, Texture, TexturePoint, Wrap};
use nephroid::world::World;
use nephroid_formats::SceneFile;
use nephroid_formats::vfs::MemoryFiles;
use serde_json::{Value, json};

use crate::model::{Model, mesh};

/// Red, green, blue, alpha: 0.2, 0.4, 0.6 of 255, and 102 or 204 in the two columns.
fn png(has_alpha: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 2, 1);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    let pixel = |alpha: u8| if has_alpha { vec![51, 102, 153, alpha] } else { vec![51, 102, 153] };
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[pixel(102), pixel(204)].concat()).expect("an image");
    drop(writer);
    out
}

fn painted(material: Value, has_alpha: bool) -> Model {
    let mut model = Model::painted(material);
    model.files = MemoryFiles::default().with("m/image.png", png(has_alpha));
    model
}

/// What a material is inside of masks, sides and normal maps, with their names.
fn inside(file: &SceneFile) -> (Vec<&'static str>, MetallicRoughness) {
    let mut material = file.scene.shapes[0].material;
    let mut outside = Vec::new();
    loop {
        match &file.scene.materials[material] {
            Material::Mask { inside, .. } => {
                outside.push("mask");
                material = *inside;
            }
            Material::TwoSided { front, .. } => {
                outside.push("two sides");
                material = *front;
            }
            Material::NormalMap { inside, .. } => {
                outside.push("normals");
                material = *inside;
            }
            Material::MetallicRoughness(found) => return (outside, **found),
            other => panic!("{other:?}"),
        }
    }
}

fn at(u: f32) -> TexturePoint {
    Vec2::new(u, 0.5).into()
}

fn bitmap(file: &SceneFile, texture: &Texture) -> Bitmap {
    match texture {
        Texture::Bitmap(bitmap) => bitmap.clone(),
        Texture::Scale { b, .. } => bitmap(file, &file.scene.textures.list[*b]),
        Texture::Channel { of, .. } => bitmap(file, &file.scene.textures.list[*of]),
        other => panic!("{other:?}"),
    }
}

fn near(a: Rgb, b: Rgb) {
    let difference = (a - b).map(f32::abs).max_channel();
    assert!(difference < 1e-4, "{a:?} instead of {b:?}");
}

fn linear(bytes: [u8; 3]) -> Rgb {
    Rgb::from(bytes.map(|b| nephroid::color::srgb::decode(f32::from(b) / 255.0)))
}

#[test]
fn the_default_material_is_rough_white_metal() {
    let (file, _) = Model::square().good();
    let (outside, found) = inside(&file);
    assert_eq!(outside, ["two sides"]);
    let value = |texture| file.scene.textures.eval(texture, at(0.0));
    assert_eq!(value(found.base_color), Rgb::WHITE);
    assert_eq!((value(found.metallic), value(found.roughness)), (Rgb::WHITE, Rgb::WHITE));
    assert_eq!((value(found.transmission), found.ior), (Rgb::BLACK, 1.5));
}

#[test]
fn factors_multiply_channels() {
    let texture = json!({ "index": 0 });
    let material = json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.5, 0.25, 1.0], "baseColorTexture": texture,
        "metallicFactor": 0.5, "roughnessFactor": 0.75, "metallicRoughnessTexture": texture,
    }});
    let (file, warnings) = painted(material, false).good();
    assert_eq!(warnings, "");
    let (_, found) = inside(&file);
    let value = |texture| file.scene.textures.eval(texture, at(0.3));
    near(value(found.base_color), linear([51, 102, 153]) * Rgb::new(1.0, 0.5, 0.25));
    // Blue is metal, green is rough, and neither is decoded.
    near(value(found.metallic), Rgb::splat(0.5 * 0.6));
    near(value(found.roughness), Rgb::splat(0.75 * 0.4));
    // One image for colours, one for numbers.
    assert_eq!(file.scene.textures.images.len(), 3, "and the sky");
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn samplers_and_transforms_say_how_images_are_read() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let transform = json!({ "offset": [0.0, 1.0], "rotation": quarter, "scale": [0.5, 0.5] });
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let mut model = painted(json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } }), false);
    model.document["textures"][0]["sampler"] = json!(0);
    model.document["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33648, "wrapT": 33648 }]);
    let file = model.good().0;
    let found = bitmap(&file, &file.scene.textures.list[inside(&file).1.base_color]);
    assert_eq!((found.filter, found.wrap), (BitmapFilter::Nearest, Wrap::Mirror));
    // The example of the extension: the lower left quarter of the image, turned.
    for (from, to) in [((0.0, 0.0), (0.0, 1.0)), ((1.0, 0.0), (0.0, 0.5)), ((0.0, 1.0), (0.5, 1.0))] {
        let moved = found.to_uv.transform_point2(Vec2::from(from));
        assert!((moved - Vec2::from(to)).length() < 1e-6, "{from:?} goes to {moved}");
    }
    model.document["samplers"] = json!([{ "wrapS": 33071, "wrapT": 10497 }]);
    let (file, warnings) = model.good();
    let found = bitmap(&file, &file.scene.textures.list[inside(&file).1.base_color]);
    assert_eq!((found.filter, found.wrap), (BitmapFilter::Bilinear, Wrap::Clamp));
    assert!(warnings.contains("wrapT"), "{warnings}");
}

#[test]
fn opacity_is_blended_or_cut_off() {
    let with = |mode: &str, factor: f64, has_alpha: bool| {
        let pbr = json!({ "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 1, 1, factor] });
        let material = json!({ "alphaMode": mode, "alphaCutoff": 0.3, "pbrMetallicRoughness": pbr });
        let file = painted(material, has_alpha).good().0;
        World::new(file.scene.clone()).expect("it can be rendered");
        match file.scene.materials[file.scene.shapes[0].material] {
            Material::Mask { opacity, .. } => {
                Some([0.25, 0.75].map(|u| file.scene.textures.eval(opacity, at(u)).g))
            }
            _ => None,
        }
    };
    let close = |found: Option<[f32; 2]>, expected: [f32; 2]| {
        let found = found.expect("a mask");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}, not {expected:?}");
    };
    close(with("BLEND", 0.5, true), [0.2, 0.4]);
    close(with("BLEND", 0.5, false), [0.5, 0.5]);
    // 0.4 · 0.5 is below the cutoff and 0.8 · 0.5 is not.
    close(with("MASK", 0.5, true), [0.0, 1.0]);
    close(with("MASK", 0.2, false), [0.0, 0.0]);
    assert_eq!(with("MASK", 0.5, false), None);
    assert_eq!(with("BLEND", 1.0, false), None);
    assert_eq!(with("OPAQUE", 0.5, true), None);
}

#[test]
fn emission_is_a_radiance() {
    let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } });
    let material =
        json!({ "emissiveFactor": [1, 0.5, 0], "emissiveTexture": { "index": 0 }, "extensions": strength });
    let mut model = painted(material, true);
    let (file, _) = model.good();
    let emission = file.scene.shapes[0].emission.expect("it shines");
    near(file.scene.textures.eval(emission, at(0.3)), linear([51, 102, 153]) * Rgb::new(4.0, 2.0, 0.0));
    // What is partly transparent does not.
    model.document["materials"][0]["alphaMode"] = json!("BLEND");
    model.document["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorFactor": [1, 1, 1, 0.5] });
    let (file, warnings) = model.good();
    assert!(
        file.scene.shapes[0].emission.is_none() && warnings.contains("gives no light here"),
        "{warnings}"
    );
    World::new(file.scene).expect("it can be rendered");
    // And a black image makes no lamp.
    model.document["materials"][0]["alphaMode"] = json!("OPAQUE");
    let black =
        nephroid_formats::image::encode_png(&Image::filled(1, 1, Rgb::BLACK)).expect("it can be written");
    model.files = MemoryFiles::default().with("m/image.png", black);
    assert!(model.good().0.scene.shapes[0].emission.is_none());
}

#[test]
fn normal_maps_are_inside_of_both_sides() {
    let (file, _) = painted(json!({ "normalTexture": { "index": 0, "scale": 0.5 } }), false).good();
    assert_eq!(inside(&file).0, ["two sides", "normals"]);
    let found = file.scene.materials.iter().find_map(|material| match material {
        Material::NormalMap { normals, scale, .. } => Some((*normals, *scale)),
        _ => None,
    });
    let (normals, scale) = found.expect("there is one");
    assert_eq!(scale, 0.5);
    near(file.scene.textures.eval(normals, at(0.3)), Rgb::new(0.2, 0.4, 0.6));
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn glass_with_a_thickness_encloses_what_absorbs() {
    let volume =
        json!({ "thicknessFactor": 0.1, "attenuationDistance": 2.0, "attenuationColor": [1.0, 0.5, 0.25] });
    let material = json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 }, "extensions": {
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        "KHR_materials_ior": { "ior": 1.33 },
        "KHR_materials_volume": volume,
    }});
    let mut model = painted(material, false);
    let (file, warnings) = model.good();
    assert_eq!(warnings, "");
    let (outside, found) = inside(&file);
    assert!(outside.is_empty() && !found.thin && found.ior == 1.33, "{outside:?} {found:?}");
    let medium = &file.scene.media.list[file.scene.shapes[0].boundary.interior.expect("a medium")];
    // Beer and Lambert: exp(−2 σ) is the colour.
    let Coefficient::Constant(sigma) = medium.sigma_t else { panic!("{medium:?}") };
    near((sigma * -2.0).map(nephroid::math::real::exp), Rgb::new(1.0, 0.5, 0.25));
    assert_eq!(medium.albedo, Coefficient::ZERO);
    World::new(file.scene).expect("it can be rendered");
    // Without thickness it is a sheet.
    model.document["materials"][0]["extensions"]["KHR_materials_volume"]["thicknessFactor"] = json!(0.0);
    let (file, _) = model.good();
    assert!(inside(&file).1.thin && file.scene.shapes[0].boundary.interior.is_none());
    model.document["materials"][0]["extensions"]["KHR_materials_ior"]["ior"] = json!(0.5);
    model.fails_with("\"ior\" must be at least 1");
}

#[test]
fn glass_takes_light_apart_if_it_is_thick() {
    let material = |thickness: f32, dispersion: f32| {
        painted(
            json!({ "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 1.0 },
                "KHR_materials_ior": { "ior": 1.7 },
                "KHR_materials_volume": { "thicknessFactor": thickness },
                "KHR_materials_dispersion": { "dispersion": dispersion },
            }}),
            false,
        )
    };
    let dispersion_of = |file: &SceneFile| {
        let scene = &file.scene;
        Material::dispersion(&scene.materials, scene.shapes[0].material)
    };
    let (file, warnings) = material(1.0, 0.8).good();
    assert_eq!(warnings, "");
    assert_eq!(dispersion_of(&file), Some(Dispersion::from_abbe(1.7, 25.0)));
    World::new(file.scene).expect("it can be rendered");
    for (thickness, dispersion) in [(0.0, 0.8), (1.0, 0.0)] {
        let (file, _) = material(thickness, dispersion).good();
        assert_eq!(dispersion_of(&file), None);
    }
    let (file, warnings) = material(1.0, 500.0).good();
    assert!(warnings.contains("cannot have a \"dispersion\" above"), "{warnings}");
    World::new(file.scene).expect("light of all colours is refracted");
    material(1.0, -0.1).fails_with("\"dispersion\" must not be negative");
}

#[test]
fn further_lobes_are_read() {
    let texture = json!({ "index": 0 });
    let material = json!({ "extensions": {
        "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatTexture": texture, "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": texture },
        "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.25, 0], "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": texture },
        "KHR_materials_specular": { "specularFactor": 0.5, "specularTexture": texture, "specularColorFactor": [2, 1, 1] },
        "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1.0, "anisotropyTexture": texture },
        "KHR_materials_iridescence": { "iridescenceFactor": 1.0 },
    }});
    let (file, warnings) = painted(material, true).good();
    assert!(warnings.contains("iridescence is not read"), "{warnings}");
    let (_, found) = inside(&file);
    let value = |texture| file.scene.textures.eval(texture, at(0.25));
    near(value(found.clearcoat), Rgb::splat(0.5 * 0.2));
    near(value(found.clearcoat_roughness), Rgb::splat(0.25 * 0.4));
    near(value(found.sheen_color), Rgb::new(0.5, 0.25, 0.0));
    near(value(found.sheen_roughness), Rgb::splat(0.5 * 0.4));
    near(value(found.specular), Rgb::splat(0.5 * 0.4));
    near(value(found.specular_color), Rgb::new(2.0, 1.0, 1.0));
    near(value(found.anisotropy), Rgb::splat(0.5 * 0.6));
    near(value(found.anisotropy_direction.expect("a direction")), Rgb::new(0.2, 0.4, 0.6));
    assert_eq!(found.anisotropy_rotation, 1.0);
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn specular_and_gloss_become_colour_and_roughness() {
    let extension = json!({
        "diffuseFactor": [0.5, 0.25, 0.125, 1.0], "specularFactor": [0.4, 0.2, 0.1], "glossinessFactor": 0.75,
        "specularGlossinessTexture": { "index": 0 },
    });
    let material = json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": extension } });
    let (file, _) = painted(material, true).good();
    let (_, found) = inside(&file);
    let value = |texture| file.scene.textures.eval(texture, at(0.25));
    near(value(found.base_color), Rgb::new(0.5, 0.25, 0.125));
    near(value(found.specular_color) * 0.04, linear([51, 102, 153]) * Rgb::new(0.4, 0.2, 0.1));
    near(value(found.roughness), Rgb::splat(1.0 - 0.75 * 0.4));
    assert_eq!(value(found.metallic), Rgb::BLACK);
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn unlit_colours_are_given_off() {
    let pbr = json!({ "baseColorFactor": [0.5, 0.25, 1.0, 1.0] });
    let material = json!({ "pbrMetallicRoughness": pbr, "extensions": { "KHR_materials_unlit": {} } });
    let mut model = painted(material, false);
    let (file, _) = model.good();
    let emission = file.scene.shapes[0].emission.expect("it shines");
    near(file.scene.textures.eval(emission, at(0.3)), Rgb::new(0.5, 0.25, 1.0));
    World::new(file.scene).expect("it can be rendered");
    // The colours of vertices may be light here, too; where they cannot, they are diffuse.
    let colors = model.floats(&[[1.0f32, 0.0, 0.0]; 4]);
    model.primitive()["attributes"]["COLOR_0"] = json!(colors);
    let (file, warnings) = model.good();
    assert!(file.scene.shapes[0].emission.is_none() && warnings.contains("unlit"), "{warnings}");
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn colours_of_vertices_multiply_the_base() {
    let pbr = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 1.0] });
    let mut model = painted(json!({ "pbrMetallicRoughness": pbr }), false);
    let view = model.view(&[255u8, 0, 51, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 255]);
    let colors = model.accessor(view, 5121, 4, "VEC4");
    model.document["accessors"][colors]["normalized"] = json!(true);
    model.primitive()["attributes"]["COLOR_0"] = json!(colors);
    let (file, warnings) = model.good();
    assert_eq!(warnings, "");
    assert_eq!(mesh(&file, &file.scene.shapes[0]).colors[0], Rgb::new(1.0, 0.0, 0.2));
    let point = TexturePoint { color: Rgb::new(1.0, 0.0, 0.2), ..at(0.3) };
    near(file.scene.textures.eval(inside(&file).1.base_color, point), Rgb::new(0.5, 0.0, 0.1));
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn the_set_of_coordinates_is_that_of_the_base_colour() {
    let pbr = json!({ "baseColorTexture": { "index": 0, "texCoord": 1 } });
    let mut model = painted(json!({ "pbrMetallicRoughness": pbr, "normalTexture": { "index": 0 } }), false);
    let second = model.floats(&[[0.5f32, 0.5]; 4]);
    model.primitive()["attributes"]["TEXCOORD_1"] = json!(second);
    let (file, warnings) = model.good();
    assert_eq!(mesh(&file, &file.scene.shapes[0]).uvs, [Vec2::splat(0.5); 4]);
    assert!(warnings.contains("this one uses TEXCOORD_1, not TEXCOORD_0"), "{warnings}");
}

#[test]
fn variants_show_the_first_and_say_so() {
    let mut model = painted(json!({ "name": "plain" }), false);
    model.document["extensions"] =
        json!({ "KHR_materials_variants": { "variants": [{ "name": "beach" }, { "name": "street" }] } });
    model.primitive()["extensions"] = json!({ "KHR_materials_variants": { "mappings": [] } });
    let warnings = model.good().1;
    assert!(warnings.contains("beach, street"), "{warnings}");
}

#[test]
fn images_are_in_files_data_or_buffers() {
    let pbr = json!({ "baseColorTexture": { "index": 0 } });
    let mut model = painted(json!({ "pbrMetallicRoughness": pbr }), false);
    let scene = model.good().0.scene;
    let view = model.view(&png(false));
    model.document["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    assert_eq!(model.good().0.scene, scene);
    model.document["images"] = json!([{ "uri": "gone.png" }]);
    model.fails_with("cannot read \"gone.png\"");
    model.document["images"] = json!([{}]);
    model.fails_with("neither a \"uri\" nor a \"bufferView\"");
    // An image of another kind is an error, and white to the lenient.
    model.files = MemoryFiles::default().with("m/a.webp", "RIFF....WEBP");
    model.document["images"] = json!([{ "uri": "a.webp" }]);
    model.fails_with("perhaps a WebP image");
    assert!(model.read_with(true).is_ok());
    model.files = MemoryFiles::default().with("m/a.png", &png(false)[..30]);
    model.document["images"] = json!([{ "uri": "a.png" }]);
    model.fails_with("the image is cut off or damaged");
    model.document["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    model.fails_with("by KHR_texture_basisu only");
    model.document["textures"] = json!([]);
    model.fails_with("there are 0 textures");
}
