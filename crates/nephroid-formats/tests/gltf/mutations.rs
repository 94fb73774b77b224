//! Random damage to good models must never end in a panic.

use nephroid::world::World;
use nephroid_formats::vfs::MemoryFiles;
use proptest::prelude::*;
use serde_json::json;

use crate::model::{Model, read_bytes};

fn model() -> Model {
    let material = json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.5 },
        "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
        "normalTexture": { "index": 0, "scale": 0.5 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1.0 },
            "KHR_materials_volume": { "thicknessFactor": 1.0, "attenuationDistance": 2.0, "attenuationColor": [1, 0, 0.5] },
        },
    });
    let mut model = Model::painted(material);
    model.document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5 } }]);
    model.node(json!({ "camera": 0, "translation": [0, 0, 5] }));
    model.document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot" }] } });
    model.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    let moves = model.floats(&[[0.0f32, 0.0, 2.0], [0.0, 0.0, 3.0]]);
    let extension = json!({ "attributes": { "TRANSLATION": moves } });
    model.node(json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": extension } }));
    let pixels = nephroid::texture::Image::filled(2, 2, nephroid::color::Rgb::splat(0.5));
    let png = nephroid_formats::image::encode_png(&pixels).expect("it can be written");
    model.files = MemoryFiles::default().with("m/image.png", png);
    model
}

#[derive(Clone, Debug)]
enum Damage {
    Overwrite(f64, u8),
    Delete(f64, usize),
    Insert(f64, &'static str),
    Copy(f64, f64, usize),
    Cut(f64),
}

fn damage() -> impl Strategy<Value = Damage> {
    let words = vec![
        "-1",
        "0",
        "99999999",
        "1e300",
        "null",
        "\"",
        "{",
        "]",
        ",",
        "0.5",
        "true",
        "[]",
        "{}",
        "\\u0000",
        "é",
        "\"extensions\":{},",
        "\"sparse\":{\"count\":1},",
    ];
    prop_oneof![
        (0.0..1.0, any::<u8>()).prop_map(|(at, byte)| Damage::Overwrite(at, byte)),
        (0.0..1.0, 1usize..30).prop_map(|(at, n)| Damage::Delete(at, n)),
        (0.0..1.0, prop::sample::select(words)).prop_map(|(at, word)| Damage::Insert(at, word)),
        (0.0..1.0, 0.0..1.0, 1usize..100).prop_map(|(from, to, n)| Damage::Copy(from, to, n)),
        (0.0..1.0).prop_map(Damage::Cut),
    ]
}

fn damaged(mut bytes: Vec<u8>, list: &[Damage]) -> Vec<u8> {
    for one in list {
        let place = |at: f64| (at * bytes.len() as f64) as usize;
        match *one {
            Damage::Overwrite(at, byte) => {
                let at = place(at);
                bytes.splice(at..(at + 1).min(bytes.len()), [byte]);
            }
            Damage::Delete(at, n) => {
                let at = place(at);
                bytes.drain(at..(at + n).min(bytes.len()));
            }
            Damage::Insert(at, word) => {
                let at = place(at);
                bytes.splice(at..at, word.bytes());
            }
            Damage::Copy(from, to, n) => {
                let (from, to) = (place(from), place(to));
                let part = bytes[from..(from + n).min(bytes.len())].to_vec();
                bytes.splice(to..to, part);
            }
            Damage::Cut(at) => bytes.truncate(place(at)),
        }
    }
    bytes
}

fn read(bytes: Vec<u8>, files: &MemoryFiles, lenient: bool) {
    match read_bytes(bytes, files.clone(), lenient) {
        Ok(file) => {
            assert_eq!(file.origins.shapes.len(), file.scene.all_shapes().count());
            assert_eq!(file.origins.materials.len(), file.scene.materials.len());
            assert_eq!(file.origins.images.len(), file.scene.textures.images.len());
            if let Err(errors) = World::new(file.scene) {
                assert!(!errors.0.is_empty());
            }
        }
        Err(errors) => assert!(!errors.is_empty()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn texts(list in prop::collection::vec(damage(), 1..5), lenient in any::<bool>()) {
        let (text, files) = model().text();
        read(damaged(text.into_bytes(), &list), &files, lenient);
    }

    #[test]
    fn files(list in prop::collection::vec(damage(), 1..5), lenient in any::<bool>()) {
        let model = model();
        read(damaged(model.binary(), &list), &model.files, lenient);
    }
}

#[test]
fn what_is_damaged_is_good() {
    let (text, files) = model().text();
    let file = read_bytes(text.into_bytes(), files, false).unwrap_or_else(|errors| panic!("{errors}"));
    World::new(file.scene).expect("it can be rendered");
}
