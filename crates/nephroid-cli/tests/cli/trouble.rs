use crate::support::{Dir, SCENE};

#[test]
fn scenes_that_do_not_exist() {
    let dir = Dir::new();
    dir.run(&["render", "cornel"]).ends_with(4).says("did you mean \"cornell\"?");
    dir.run(&["render", "sub/none.xml"]).ends_with(4).says("sub/none.xml: no such file");
    dir.run(&["info", "none.xml"]).ends_with(4).says("none.xml: no such file");
    std::fs::create_dir(dir.path("folder")).unwrap();
    dir.run(&["render", "folder"]).ends_with(4).says("folder: is not a file");
}

#[test]
fn a_file_comes_before_a_built_in_scene() {
    let dir = Dir::new();
    std::fs::write(dir.path("cornell"), SCENE).unwrap();
    dir.run(&["render", "cornell", "-o", "x.png"]).ends_with(0).says("8 by 6 pixels");
    let dir = Dir::new();
    std::fs::create_dir(dir.path("cornell")).unwrap();
    dir.render("cornell", &[]).ends_with(0).says("8 by 8 pixels");
}

#[test]
fn errors_of_a_scene_name_file_and_line() {
    let dir = Dir::with_scene(r#"type="diffuse""#, r#"type="difuse""#);
    dir.run(&["render", "a.xml"]).ends_with(3).says("a.xml:8").says("did you mean \"diffuse\"?");
    assert!(dir.files().is_empty());
    let dir = Dir::with_scene("</scene>", "");
    dir.run(&["render", "a.xml"]).ends_with(3).says("a.xml:");
}

#[test]
fn errors_of_the_world_name_file_and_line() {
    let emitting = r#"<emitter type="area"><rgb name="radiance" value="-1"/></emitter>"#;
    let dir = Dir::with_scene("<bsdf type=\"diffuse\"/>", emitting);
    dir.run(&["render", "a.xml"]).ends_with(3).says("a.xml:8");
    let squashed = r#"<shape type="sphere"><transform name="to_world"><scale x="2"/></transform>"#;
    let dir = Dir::with_scene(r#"<shape type="sphere">"#, squashed);
    dir.run(&["render", "a.xml"]).ends_with(3).says("a.xml:8").says("use a mesh for an ellipsoid");
    dir.run(&["info", "a.xml"]).ends_with(3).says("a.xml:8");
}

#[test]
fn defines_must_be_known_and_have_a_value() {
    let dir = Dir::new();
    dir.render("cornell", &["-D", "albdo=0.5"]).ends_with(3).says("albdo").says("albedo");
    dir.render("cornell", &["-D", "albedo"]).ends_with(2).says("write NAME=VALUE");
    dir.render("cornell", &["-D", "albedo=0.5", "-D", "ior=1.3"]).ends_with(0);
}

#[test]
fn values_out_of_range_are_usage_errors() {
    let dir = Dir::new();
    for args in [
        &["--neighbours", "1"][..],
        &["--radius", "0"],
        &["--radius", "inf"],
        &["--max-radius", "-1"],
        &["--cone-k", "0.5"],
        &["--kernel", "tent"],
        &["--threads", "0"],
        &["--passes", "0"],
        &["--time", "0"],
        &["--time", "nan"],
        &["--exposure", "inf"],
        &["--tonemap", "filmic"],
        &["--integrator", "bdpt"],
        &["--max-depth", "-2"],
    ] {
        dir.render("cornell", args).ends_with(2).says(args[1]);
    }
    for args in
        [&["--spp", "0"], &["--resolution", "0x5"], &["--resolution", "65537x1"], &["--resolution", "5"]]
    {
        dir.run(&[&["render", "cornell"], &args[..]].concat()).ends_with(2).says(args[1]);
    }
    dir.run(&["render", "cornell", "--resolution", "65536x65536"]).ends_with(2).says("too many");
    dir.run(&["paint"]).ends_with(2);
    assert!(dir.files().is_empty());
}

#[test]
fn a_scene_without_light_is_black_and_says_so() {
    let emitter = SCENE.lines().find(|line| line.contains("emitter")).unwrap();
    let dir = Dir::with_scene(emitter, "");
    let run = dir.run(&["render", "a.xml", "--json"]).ends_with(0);
    assert_eq!(run.json()["image"]["mean_luminance"], 0.0);
    run.says("warning: there is no light in the scene");
}

#[test]
fn a_map_that_emission_cannot_fill_is_told() {
    let dir = Dir::new();
    let args = [
        "render",
        "report-2-2a",
        "--json",
        "--resolution",
        "4x4",
        "--caustic-photons",
        "500",
        "--emit-max",
        "2",
        "--aim=false",
    ];
    let run = dir.run(&args).ends_with(0);
    assert_eq!(run.json()["photons"]["caustic"]["limited"], true);
    run.says("instead of 500").says("--emit-max");
}

#[test]
fn a_map_that_no_light_reaches_is_noted() {
    let room = SCENE.lines().find(|line| line.contains("room")).unwrap();
    let dir = Dir::with_scene(room, "");
    let args = ["render", "a.xml", "--emit-max", "2"];
    dir.run(&args).ends_with(0).says("note: the global map is empty: none of 600 paths");
    dir.run(&[&args[..], &["--quiet"]].concat()).ends_with(0).does_not_say("empty");
}

#[test]
fn no_photons_are_no_error() {
    let dir = Dir::with_scene("", "");
    let run =
        dir.run(&["render", "a.xml", "--json", "--photons", "0", "--caustic-photons", "0"]).ends_with(0);
    assert!(run.json()["image"]["mean_luminance"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_crop_window_does_not_outlive_its_size() {
    let crop = r#"<integer name="crop_width" value="4"/><integer name="crop_height" value="3"/></film>"#;
    let dir = Dir::with_scene("</film>", crop);
    let size = |run: &crate::support::Run| (run.json()["width"].clone(), run.json()["height"].clone());
    let run = dir.run(&["render", "a.xml", "--json"]).ends_with(0);
    assert_eq!(size(&run), (4.into(), 3.into()));
    let run = dir.run(&["render", "a.xml", "--json", "--resolution", "5x5"]).ends_with(0);
    assert_eq!(size(&run), (5.into(), 5.into()));
    run.says("crop window");
}
