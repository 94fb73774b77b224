use crate::support::Dir;

#[test]
fn the_bare_command_renders_the_default_scene() {
    // At full size it takes long: only its outputs are tried here, and found to be impossible.
    let dir = Dir::new();
    std::fs::create_dir(dir.path("nephroid.exr")).unwrap();
    dir.run(&[]).ends_with(4).says("nephroid.exr: is not a file");
    let dir = Dir::new();
    let run = dir.run(&[&["render"], crate::support::CHEAP].concat()).ends_with(0);
    assert_eq!(dir.files(), ["nephroid.exr", "nephroid.png"]);
    run.says("cornell: 8 by 8 pixels").says("written: nephroid.exr, nephroid.png");
}

#[test]
fn without_o_the_scene_gives_the_names() {
    let dir = Dir::with_scene("", "");
    dir.run(&["render", "a.xml"]).ends_with(0);
    assert_eq!(dir.files(), ["a.exr", "a.png"]);
    dir.render("report-2-11", &[]).ends_with(0);
    assert_eq!(dir.files(), ["a.exr", "a.png", "report-2-11.exr", "report-2-11.png"]);
}

#[test]
fn outputs_lie_in_the_current_folder_whatever_the_scenes_is() {
    let dir = Dir::new();
    std::fs::create_dir(dir.path("sub")).unwrap();
    std::fs::write(dir.path("sub/b.c.xml"), crate::support::SCENE).unwrap();
    dir.run(&["render", "sub/b.c.xml"]).ends_with(0);
    assert_eq!(dir.files(), ["b.c.exr", "b.c.png", "sub"]);
}

#[test]
fn the_suffix_is_the_kind() {
    let dir = Dir::with_scene("", "");
    dir.run(&["render", "a.xml", "-o", "x.exr", "--output", "y.PNG", "-o", "z.png"]).ends_with(0);
    assert_eq!(dir.files(), ["x.exr", "y.PNG", "z.png"]);
    assert_eq!(dir.read("x.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(&dir.read("y.PNG")[1..4], b"PNG");
}

#[test]
fn suffixes_that_mean_nothing_are_usage_errors() {
    let dir = Dir::with_scene("", "");
    dir.run(&["render", "a.xml", "-o", "x.jpg"]).ends_with(2).says("x.jpg: the name of a picture ends in");
    dir.run(&["render", "a.xml", "-o", "x"]).ends_with(2).says("ends in .exr or .png");
    dir.run(&["render", "a.xml", "-o", "x.png", "-o", "x.png"]).ends_with(2).says("written twice");
    assert!(dir.files().is_empty());
}

#[test]
fn outputs_are_tried_before_rendering() {
    let dir = Dir::with_scene("", "");
    let hopeless = ["render", "a.xml", "--passes", "1000000000", "-o", "x.png", "-o", "no/where.exr"];
    dir.run(&hopeless).ends_with(4).says("no/where.exr: cannot be written: there is no folder no");
    assert!(dir.files().is_empty());
}

#[test]
fn json_is_one_object_and_nothing_else() {
    let dir = Dir::with_scene("", "");
    let run = dir.run(&["render", "a.xml", "--json", "-o", "x.png", "--seed", "7"]).ends_with(0);
    let object = run.json();
    assert_eq!(run.stderr, "");
    assert_eq!(object["outputs"], serde_json::json!(["x.png"]));
    assert_eq!(object["seed"], 7);
    assert_eq!(object["integrator"]["photons"], 300);
    assert_eq!((&object["width"], &object["height"]), (&8.into(), &6.into()));
    assert_eq!(object["camera_samples"], 8 * 6 * 2);
    assert_eq!(object["ended"], "finished");
    let ledger = &object["ledger"][0];
    let emitted = ledger["emitted"][0].as_f64().unwrap();
    assert!((emitted - 20.0 * std::f64::consts::PI).abs() < 1e-4, "{emitted}");
    assert!(ledger["imbalance"].as_f64().unwrap().abs() < 1e-6);
    assert!(object["image"]["mean_luminance"].as_f64().unwrap() > 0.0);
}

#[test]
fn statistics_and_warnings_are_on_the_standard_error() {
    let dir = Dir::with_scene("", "");
    let run = dir.run(&["render", "a.xml"]).ends_with(0);
    assert_eq!(run.stdout, "");
    run.says("global map: ").says("roulette").says("mean luminance: ").says("seconds: read ");
    let quiet = dir.run(&["render", "a.xml", "--quiet"]).ends_with(0);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let dir = Dir::new();
    let args =
        ["render", "cornell", "--resolution", "40x24", "--spp", "5", "--photons", "9000", "--seed", "3"];
    let args = [&args[..], &["--caustic-photons", "2000"]].concat();
    let render = |threads: &str, file: &str| {
        dir.run(&[&args[..], &["--threads", threads, "-o", file]].concat()).ends_with(0);
        dir.read(file)
    };
    let one = render("1", "1.exr");
    assert!(one == render("2", "2.exr"));
    assert!(one == render("7", "7.exr"));
}
