//! Random damage to good scenes of pbrt must never end in a panic, nor in a scene whose places are not its own.

use nephroid::world::World;
use nephroid_formats::Options;
use nephroid_formats::pbrt::read_scene;
use nephroid_formats::vfs::MemoryFiles;
use proptest::prelude::*;

/// What the fuzzer begins with.
const SCENES: [&str; 4] = [
    include_str!("../fuzz/seeds/pbrt/camera.pbrt"),
    include_str!("../fuzz/seeds/pbrt/shapes.pbrt"),
    include_str!("../fuzz/seeds/pbrt/materials.pbrt"),
    include_str!("../fuzz/seeds/pbrt/lights.pbrt"),
];

fn files(scene: &str) -> MemoryFiles {
    MemoryFiles::default()
        .with("m.ply", *include_bytes!("../fuzz/seeds/ply/ascii.ply"))
        .with("i.png", *include_bytes!("../fuzz/seeds/image/two_pixels.png"))
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.pbrt", "Material \"diffuse\" Shape \"sphere\"")
        .with("s.pbrt", scene)
}

/// A word of the text is taken away, doubled, or makes place for another one; places are fractions.
#[derive(Clone, Debug)]
enum Damage {
    Delete(f64),
    Copy(f64, f64),
    Replace(f64, &'static str),
    Overwrite(f64, u8),
}

fn damage() -> impl Strategy<Value = Damage> {
    let words = prop::sample::select(vec![
        "-1",
        "0",
        "1e39",
        "nan",
        "2147483647",
        "\"",
        "[",
        "]",
        "[]",
        "\"a\"",
        "\"p\"",
        "\"s.pbrt\"",
        "#",
        "é",
        "\0",
        "Shape",
        "AttributeBegin",
        "AttributeEnd",
        "ObjectBegin",
        "ObjectEnd",
        "ObjectInstance",
        "\"o\"",
        "Scale",
        "WorldBegin",
        "ReverseOrientation",
        "Include",
        "\"texture",
        "reflectance\"",
        "\"float",
        "alpha\"",
        "true",
    ]);
    prop_oneof![
        (0.0..1.0).prop_map(Damage::Delete),
        (0.0..1.0, 0.0..1.0).prop_map(|(from, to)| Damage::Copy(from, to)),
        (0.0..1.0, words).prop_map(|(at, word)| Damage::Replace(at, word)),
        (0.0..1.0, any::<u8>()).prop_map(|(at, byte)| Damage::Overwrite(at, byte)),
    ]
}

fn damaged(scene: &str, damages: &[Damage]) -> String {
    let mut words: Vec<String> = scene.split_inclusive(char::is_whitespace).map(str::to_owned).collect();
    for damage in damages {
        let place = |at: &f64| (at * words.len() as f64) as usize;
        match damage {
            _ if words.is_empty() => {}
            Damage::Delete(at) => drop(words.remove(place(at))),
            Damage::Copy(from, to) => {
                let (to, word) = (place(to), words[place(from)].clone());
                words.insert(to, word);
            }
            Damage::Replace(at, word) => {
                let at = place(at);
                words[at] = format!("{word} ");
            }
            Damage::Overwrite(at, byte) => {
                let at = place(at);
                words[at].insert(0, char::from(*byte));
            }
        }
    }
    words.concat()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 4_000,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn damaged_scenes(which in 0..4usize, damages in prop::collection::vec(damage(), 1..6), lenient: bool) {
        let files = files(&damaged(SCENES[which], &damages));
        let options = Options { lenient, ..Options::default() };
        match read_scene("s.pbrt".as_ref(), &files, &options) {
            Ok(file) => {
                prop_assert!(file.warnings.iter().all(|w| !w.render(false).is_empty()));
                let scene = &file.scene;
                let grouped = scene.groups.iter().map(|group| group.shapes.len()).sum::<usize>();
                prop_assert_eq!(file.origins.shapes.len(), scene.shapes.len() + grouped);
                prop_assert_eq!(file.origins.materials.len(), scene.materials.len());
                prop_assert_eq!(file.origins.textures.len(), scene.textures.list.len());
                prop_assert_eq!(file.origins.media.len(), scene.media.list.len());
                // One in some: building is slower than reading.
                if damages.len() == 1 {
                    drop(World::new(file.scene));
                }
            }
            Err(diagnostics) => {
                prop_assert!(!diagnostics.0.is_empty());
                prop_assert!(!diagnostics.to_string().is_empty());
            }
        }
    }
}

#[test]
fn undamaged_scenes_can_be_read() {
    for scene in SCENES {
        let file = read_scene("s.pbrt".as_ref(), &files(scene), &Options::default());
        let file = file.unwrap_or_else(|e| panic!("{e}"));
        World::new(file.scene).unwrap_or_else(|e| panic!("{e}"));
    }
}
