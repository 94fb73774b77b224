use std::path::Path;

use crate::support::Dir;

/// Names of the built-in scenes, as the folder has them.
fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|e| e == "xml"));
    scenes.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
fn the_list_is_complete() {
    let list = Dir::new().run(&["scenes"]).ends_with(0).stdout;
    assert_eq!(list.lines().count(), names().len());
    for name in names() {
        let line = list.lines().find(|line| line.split_whitespace().next() == Some(&name));
        assert!(line.is_some_and(|line| line.split_whitespace().count() > 3), "{name}: {line:?}");
    }
}

#[test]
fn a_scene_prints_its_file_which_renders() {
    let dir = Dir::new();
    let text = dir.run(&["scenes", "nephroid"]).ends_with(0).stdout;
    std::fs::write(dir.path("mine.xml"), text).unwrap();
    dir.render("mine.xml", &["-o", "a.exr"]).ends_with(0);
    dir.render("nephroid", &["-o", "b.exr"]).ends_with(0);
    assert!(dir.read("a.exr") == dir.read("b.exr"));
    dir.run(&["scenes", "nefroid"]).ends_with(2).says("did you mean \"nephroid\"?");
}

#[test]
fn a_scene_with_a_grid_can_be_copied_with_it() {
    let dir = Dir::new();
    let text = dir.run(&["scenes", "smoke", "--files", "."]).ends_with(0).stdout;
    std::fs::write(dir.path("mine.xml"), text).unwrap();
    assert_eq!(dir.files(), ["mine.xml", "smoke.vol"]);
    dir.render("mine.xml", &["-o", "a.exr"]).ends_with(0);
    std::fs::remove_file(dir.path("smoke.vol")).unwrap();
    dir.render("smoke", &["-o", "b.exr"]).ends_with(0);
    assert!(dir.read("a.exr") == dir.read("b.exr"));
    dir.run(&["scenes", "smoke", "--files", "none"]).ends_with(4).says("smoke.vol: cannot be written");
}

#[test]
fn every_built_in_scene_renders_without_a_word_of_complaint() {
    let dir = Dir::new();
    for name in names() {
        let run = dir.render(&name, &["--json", "-o", "x.png"]).ends_with(0);
        assert!(run.json()["image"]["mean_luminance"].as_f64().unwrap() > 0.0, "{name}");
        // So few paths as these may not fill the maps, and not every scene has all of them.
        let expected = |line: &&str| {
            ["--emit-max", "map is empty", "--volume-photons means nothing", "note: auto: "]
                .iter()
                .any(|e| line.contains(e))
        };
        let others: Vec<&str> = run.stderr.lines().filter(|line| !expected(line)).collect();
        assert!(others.is_empty(), "{name}: {others:?}");
        dir.run(&["info", &name, "--json"]).ends_with(0).json();
    }
}

#[test]
fn info_tells_what_is_in_a_scene() {
    let dir = Dir::new();
    let run = dir.run(&["info", "cornell", "--json", "-D", "width=100"]).ends_with(0);
    let about = run.json();
    assert_eq!(about["shapes"]["sphere"], 2);
    assert_eq!(about["film"]["width"], 100);
    assert_eq!(about["lights"][0]["name"], "lamp");
    // A square of 0.25 on a side emits π · radiance · area.
    let power = about["lights"][0]["power"]["power in W"][0].as_f64().unwrap();
    assert!((power - 170.0 * std::f64::consts::PI * 0.0625).abs() < 1e-3, "{power}");
    let text = dir.run(&["info", "cornell"]).ends_with(0).stdout;
    for line in ["  sphere: 2", "lights: 1", "  projection: perspective", "integrator used"] {
        assert!(text.lines().any(|l| l == line), "{line:?} is not in {text}");
    }
}
