use std::collections::BTreeMap;

use crate::support::{Dir, SCENE};

/// The channels of an OpenEXR file, by name.
pub fn channels(dir: &Dir, file: &str) -> BTreeMap<String, Vec<f32>> {
    let image = exr::prelude::read_first_flat_layer_from_file(dir.path(file)).unwrap();
    let list = image.layer_data.channel_data.list;
    list.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

const FEW: &[&str] = &["--photons", "4000", "--caustic-photons", "500"];

/// Glass in front of the ball, so that there are caustics, and a shining one.
fn scene() -> Dir {
    let glass = r#"<shape type="sphere"><float name="radius" value="0.5"/><point name="center" x="1.4" y="0" z="1"/>
        <bsdf type="dielectric"/></shape>
        <shape type="sphere"><float name="radius" value="0.2"/><point name="center" x="-1.2" y="0.8" z="1"/>
        <emitter type="area"><rgb name="radiance" value="3"/></emitter></shape></scene>"#;
    Dir::with_scene("</scene>", glass)
}

#[test]
fn layers_have_conventional_names_and_add_up_to_the_picture() {
    for integrator in ["photonmapper", "path"] {
        let dir = scene();
        let parts = "direct,global,caustic,emitted,albedo,normal,depth";
        let args = ["render", "a.xml", "--integrator", integrator, "-o", "x.exr", "--spp", "9", "--json"];
        let run = dir.run(&[&args[..], FEW, &["--aov", parts]].concat()).ends_with(0);
        assert_eq!(run.json()["layers"], serde_json::json!(parts.split(',').collect::<Vec<_>>()));
        let found = channels(&dir, "x.exr");
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        let rgb = |layer: &str| ["B", "G", "R"].map(|c| format!("{layer}.{c}"));
        let mut expected = vec!["B".to_owned(), "G".to_owned(), "R".to_owned()];
        expected.extend(["albedo", "caustic"].iter().flat_map(|layer| rgb(layer)));
        expected.push("depth.Z".to_owned());
        expected.extend(["direct", "emitted", "global"].iter().flat_map(|layer| rgb(layer)));
        expected.extend(["normal.X", "normal.Y", "normal.Z"].map(str::to_owned));
        assert_eq!(names, expected);
        let light = |i: usize| {
            let parts = ["direct", "global", "caustic", "emitted"];
            parts.map(|layer| found[&format!("{layer}.G")][i]).iter().sum::<f32>()
        };
        for (i, beauty) in found["G"].iter().enumerate() {
            assert!(
                (light(i) - beauty).abs() <= 1e-5 * beauty.max(1e-3),
                "{integrator} {i}: {} {beauty}",
                light(i)
            );
        }
        assert!(found["emitted.R"].iter().any(|v| *v > 0.0), "{integrator} sees the lamp");
        // The path tracer finds caustics of so small a lamp only by accident.
        assert!(integrator == "path" || found["caustic.R"].iter().any(|v| *v > 0.0));
        assert!(found["albedo.R"].iter().all(|v| (0.0..=1.0).contains(v)));
        assert!(found["depth.Z"].iter().all(|v| (2.0..14.0).contains(v)), "{:?}", found["depth.Z"]);
    }
}

#[test]
fn further_layers_change_no_bit_of_the_picture_and_are_the_same_on_any_number_of_threads() {
    let dir = scene();
    let render = |file: &str, args: &[&str]| {
        dir.run(&[&["render", "a.xml", "--passes", "2", "-o", file], FEW, args].concat()).ends_with(0);
    };
    let all = "direct,global,caustic,emitted,albedo,normal,depth,position,geo_normal,uv,radius,count";
    render("plain.exr", &[]);
    render("one.exr", &["--threads", "1", "--aov", all]);
    render("five.exr", &["--threads", "5", "--aov", all]);
    assert!(dir.read("one.exr") == dir.read("five.exr"));
    let (plain, with) = (channels(&dir, "plain.exr"), channels(&dir, "one.exr"));
    assert_eq!((plain.len(), with.len()), (3, 32));
    assert!(plain.iter().all(|(name, values)| with[name] == *values));
}

#[test]
fn radius_and_count_are_those_of_the_estimates() {
    let dir = scene();
    let fixed = ["--radius", "0.5", "--final-gather", "off", "--show", "global"];
    let args = ["render", "a.xml", "-o", "x.exr", "--aov", "radius,count"];
    dir.run(&[&args[..], FEW, &fixed].concat()).ends_with(0);
    let found = channels(&dir, "x.exr");
    assert!(found["radius.Y"].iter().all(|r| *r == 0.5 || *r == 0.0), "{:?}", found["radius.Y"]);
    assert!(found["count.Y"].iter().any(|n| *n > 3.0), "{:?}", found["count.Y"]);
}

#[test]
fn layers_that_cannot_be_are_refused() {
    let dir = scene();
    let refused = |args: &[&str], message: &str| {
        let args = [&["render", "a.xml"], args].concat();
        dir.run(&args).ends_with(2).says(message);
        assert!(dir.files().is_empty());
    };
    refused(
        &["-o", "x.exr", "--aov", "albdeo"],
        "error: invalid value 'albdeo' for '--aov <NAME,…>': there is no such value: it must be one of direct, \
         global, caustic, emitted, medium, albedo, normal, depth, position, geo_normal, uv, radius, count, error; did you mean \
         \"albedo\"?",
    );
    refused(
        &["-o", "x.png", "--aov", "albedo"],
        "error: --aov: layers are written to OpenEXR and film files only; name one with -o FILE.exr\n",
    );
    for integrator in ["path", "volpath"] {
        refused(
            &["-o", "x.exr", "--integrator", integrator, "--aov", "depth,radius"],
            &format!(
                "error: --aov radius: the integrator {integrator} makes no estimates from photons, so it has no radius\n"
            ),
        );
    }
    refused(
        &["-o", "x.exr", "--integrator", "ptracer", "--aov", "depth,caustic"],
        "error: --aov caustic: the integrator ptracer does not keep apart what its light paths bring, so it has no \
         caustic\n",
    );
}

fn with_aovs(list: &str) -> Dir {
    let own = SCENE.lines().find(|line| line.contains("integrator")).unwrap();
    let aov = format!(r#"<integrator type="aov"><string name="aovs" value="{list}"/>{own}</integrator>"#);
    Dir::with_scene(own, &aov)
}

#[test]
fn the_aov_integrator_names_layers_as_mitsuba_does() {
    let dir = with_aovs("dd.y:depth, nn:sh_normal,alb:albedo,c:caustic");
    let run = dir.run(&["render", "a.xml", "-o", "x.exr", "--json", "--aov", "depth"]).ends_with(0);
    assert_eq!(run.json()["integrator"]["photons"], 300);
    assert_eq!(run.stderr, "");
    let found = channels(&dir, "x.exr");
    let names: Vec<&str> = found.keys().map(String::as_str).collect();
    let expected = [
        "B", "G", "R", "alb.B", "alb.G", "alb.R", "c.B", "c.G", "c.R", "dd.y.T", "depth.Z", "nn.X", "nn.Y",
        "nn.Z",
    ];
    assert_eq!(names, expected);
    assert_eq!(found["dd.y.T"], found["depth.Z"]);
    let run = dir.run(&["render", "a.xml", "-o", "x.png"]).ends_with(0);
    run.says("warning: the layers that the scene asks for are left out: no OpenEXR file is written");
}

#[test]
fn layers_of_a_scene_are_checked_where_they_stand() {
    let refused = |list: &str, message: &str| {
        with_aovs(list).run(&["render", "a.xml", "-o", "x.exr"]).ends_with(3).says("a.xml:2").says(message);
    };
    refused("dd:dpeth", "there is no value \"dpeth\" to keep");
    refused("dd:dpeth", "did you mean \"depth\"?");
    refused("depth", "\"depth\" is no layer");
    refused("a:depth,a:uv", "two layers have the name \"a\"");
    let left_out = with_aovs("i:shape_index,d:depth");
    let run = left_out.run(&["render", "a.xml", "-o", "x.exr"]).ends_with(0);
    run.says("a.xml:2").says("\"shape_index\" is not kept here: the layer is left out");
    assert!(channels(&left_out, "x.exr").contains_key("d.T"));
    let radius = with_aovs("r:radius,d:depth");
    for name in ["path", "volpath"] {
        let run = radius.run(&["render", "a.xml", "-o", "x.exr", "--integrator", name]).ends_with(0);
        run.says(&format!(
            "warning: the layer \"r\" of the scene is left out: the integrator {name} makes no estimates from photons"
        ));
    }
}
