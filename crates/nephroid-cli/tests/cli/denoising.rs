use std::path::{Path, PathBuf};
use std::process::Command;

use crate::layers::channels;
use crate::support::{Dir, Run};

/// A folder with the scene, and with a library whose results can be foretold: it adds up a half of the colour, a quarter of
/// the albedo and an eighth of the normal.
fn with_fake() -> Dir {
    let dir = Dir::with_scene("", "");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../nephroid-denoise/tests/fake/oidn.rs");
    let mut compile = Command::new("rustc");
    compile.args(["--edition=2024", "--crate-type=cdylib", "-o"]).arg(dir.path("fake")).arg(source);
    let output = compile.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    dir
}

/// Runs the command without a library but those that are named.
fn run(dir: &Dir, args: &[&str], variables: &[(&str, &str)]) -> Run {
    let mut command = dir.command(args);
    command.env_remove("NEPHROID_OIDN_LIBRARY").envs(variables.iter().copied());
    Run::of(command.output().unwrap())
}

const DENOISE: &[&str] = &["--denoise", "--oidn-library", "fake"];

/// Whether the picture in an .exr is what the fake makes of its other layers, the `guides` among them that it was given.
#[track_caller]
fn is_denoised(dir: &Dir, file: &str, guides: bool) {
    let found = channels(dir, file);
    for (channel, axis) in [("R", "X"), ("G", "Y"), ("B", "Z")] {
        for (i, value) in found[channel].iter().enumerate() {
            let mut expected = 0.5 * found[&format!("noisy.{channel}")][i];
            if guides {
                expected += 0.25 * found[&format!("albedo.{channel}")][i];
                expected += 0.125 * found[&format!("normal.{axis}")][i];
            }
            assert_eq!(*value, expected, "{file}, {channel} of pixel {i}");
        }
    }
}

#[test]
fn the_picture_is_denoised_and_what_was_rendered_is_kept_beside() {
    let dir = with_fake();
    let render = |args: &[&str]| run(&dir, &[&["render", "a.xml"], args].concat(), &[]).ends_with(0);
    let report =
        render(&[DENOISE, &["-o", "x.exr", "-o", "x.png", "-o", "x.film", "--json"]].concat()).json();
    assert_eq!(report["denoised"]["version"], "2.99.7");
    assert_eq!(report["layers"], serde_json::json!(["albedo", "normal"]));
    is_denoised(&dir, "x.exr", true);
    render(&["--aov", "normal,albedo", "-o", "y.exr", "-o", "y.png", "-o", "y.film"])
        .does_not_say("denoised");
    let (with, without) = (channels(&dir, "x.exr"), channels(&dir, "y.exr"));
    assert!(["R", "G", "B"].iter().all(|c| with[&format!("noisy.{c}")] == without[*c]));
    assert!(dir.sums("x.film") == dir.sums("y.film"), "films have what was rendered");
    // A .png alone has no layers, and is denoised all the same.
    render(&[DENOISE, &["-o", "z.png"]].concat()).says("denoised: by Open Image Denoise 2.99.7");
    assert!(dir.read("x.png") == dir.read("z.png") && dir.read("x.png") != dir.read("y.png"));
}

#[test]
fn who_goes_on_with_a_render_denoises_as_it_was_told_to() {
    let dir = with_fake();
    let run = |args: &[&str]| run(&dir, args, &[]).ends_with(0);
    let begun = ["render", "a.xml", "--passes", "2", "--checkpoint", "c.film", "-o", "a.exr"];
    run(&[&begun, DENOISE].concat());
    run(&["resume", "c.film", "--passes", "3"]).says("denoised: by");
    is_denoised(&dir, "a.exr", true);
    run(&["resume", "c.film", "--no-denoise"]).does_not_say("denoised");
    let plain = channels(&dir, "a.exr");
    assert!(!plain.contains_key("noisy.R") && plain.contains_key("albedo.R"));
    run(&["render", "a.xml", "--passes", "2", "--checkpoint", "d.film", "-o", "d.exr"]);
    let note = "note: albedo and normals are not in the film";
    run(&[&["resume", "d.film"], DENOISE].concat()).says(note);
    is_denoised(&dir, "d.exr", false);
}

#[test]
fn parts_need_no_library_to_be_denoised_together() {
    let dir = with_fake();
    for (range, film) in [("0..1", "0.film"), ("1..3", "1.film")] {
        let part = ["render", "a.xml", "--passes", "3", "--pass-range", range, "-o", film];
        // There is none, and none is asked for.
        run(&dir, &[&part[..], &["--denoise", "--oidn-library", "none"]].concat(), &[]).ends_with(0);
    }
    let merge =
        ["merge", "0.film", "1.film", "-o", "a.exr", "-o", "a.png", "-o", "all.film", "--denoise", "--json"];
    let library = dir.path("fake");
    let variable = [("NEPHROID_OIDN_LIBRARY", library.to_str().unwrap())];
    assert_eq!(run(&dir, &merge, &variable).ends_with(0).json()["denoised"]["version"], "2.99.7");
    is_denoised(&dir, "a.exr", true);
    let whole = ["render", "a.xml", "--passes", "3", "-o", "b.exr", "-o", "b.film"];
    run(&dir, &[&whole, DENOISE].concat(), &[]).ends_with(0);
    assert!(dir.read("a.exr") == dir.read("b.exr") && dir.sums("all.film") == dir.sums("b.film"));
}

#[test]
fn without_a_library_nothing_is_rendered() {
    let dir = Dir::with_scene("", "");
    std::fs::write(dir.path("text"), "no library").unwrap();
    let refused = |args: &[&str], variables: &[(&str, &str)], message: &str| {
        let args = [&["render", "a.xml", "-o", "a.exr", "--denoise"], args].concat();
        run(&dir, &args, variables).ends_with(4).says(message).does_not_say("samples each");
        assert_eq!(dir.files(), ["text"]);
    };
    refused(&["--oidn-library", "none"], &[], "none: there is no such library\n");
    refused(&["--oidn-library", "text"], &[], "text: cannot be loaded: ");
    refused(&["--oidn-library", "."], &[], "there is no such library\n");
    refused(&[], &[("NEPHROID_OIDN_LIBRARY", "text")], "text: cannot be loaded: ");
    // An empty one names none: the usual places may have it or not.
    let empty = [("NEPHROID_OIDN_LIBRARY", "")];
    let found = run(&dir, &["render", "a.xml", "-o", "a.exr", "--denoise"], &empty);
    if found.code != Some(0) {
        found
            .ends_with(4)
            .says("error: --denoise: Open Image Denoise 2 is not found")
            .says("`pip install pyoidn`");
        assert_eq!(dir.files(), ["text"]);
    }
}

#[test]
fn a_library_that_gives_up_leaves_the_picture_as_it_is() {
    let dir = with_fake();
    let render = |file: &str, args: &[&str], told: &str| {
        let args = [&["render", "a.xml", "-o", file], args].concat();
        run(&dir, &args, &[("FAKE_OIDN", told)])
    };
    let broken = render("a.exr", DENOISE, "execute").ends_with(4);
    broken.says("cannot be denoised: Open Image Denoise: this fake does not like the picture\n");
    render("b.exr", &["--aov", "albedo,normal"], "").ends_with(0);
    assert!(dir.read("a.exr") == dir.read("b.exr"));
    let broken = render("c.exr", DENOISE, "commit").ends_with(4);
    broken.says("does not work here: this fake does not like the machine\n");
    assert!(!dir.path("c.exr").exists());
}

#[test]
fn layers_of_the_scene_keep_their_names() {
    let own = r#"<integrator type="photonmapper"><integer name="photons" value="300"/></integrator>"#;
    let with = |layers: &str| {
        let aov =
            format!(r#"<integrator type="aov"><string name="aovs" value="{layers}"/>{own}</integrator>"#);
        let dir = with_fake();
        std::fs::write(dir.path("a.xml"), crate::support::SCENE.replace(own, &aov)).unwrap();
        dir
    };
    let render = [&["render", "a.xml", "-o", "a.exr"], DENOISE].concat();
    for (layer, name) in [("noisy:depth", "noisy"), ("albedo:depth", "albedo")] {
        let run = run(&with(layer), &render, &[]).ends_with(2);
        run.says(&format!("error: --denoise: has a layer \"{name}\" of its own"));
    }
    let dir = with("a:albedo,n:sh_normal");
    run(&dir, &render, &[]).ends_with(0);
    let names: Vec<String> = channels(&dir, "a.exr").into_keys().collect();
    assert_eq!(names.len(), 12, "{names:?}");
}

#[test]
fn the_real_library_takes_the_noise_away() {
    let dir = Dir::new();
    let named = std::env::var_os("NEPHROID_OIDN_LIBRARY").map(PathBuf::from);
    let render =
        ["render", "balls-area", "--resolution", "64x64", "--integrator", "path", "--spp", "4", "--denoise"];
    let run = dir.run(&[&render[..], &["-o", "a.exr"]].concat());
    if named.is_none() && run.stderr.contains("Open Image Denoise 2 is not found") {
        println!("skipped: Open Image Denoise is not installed; name it in NEPHROID_OIDN_LIBRARY");
        return;
    }
    run.ends_with(0);
    dir.run(&[
        "render",
        "balls-area",
        "--resolution",
        "64x64",
        "--integrator",
        "path",
        "--spp",
        "256",
        "-o",
        "b.exr",
    ]);
    let (noisy, reference) = (channels(&dir, "a.exr"), channels(&dir, "b.exr"));
    // Of the lesser half of the pixels' errors, which leaves out the bright specks of caustics.
    let error = |channel: &str| {
        let pairs = noisy[channel].iter().zip(&reference["G"]);
        let mut errors: Vec<f32> = pairs.map(|(a, b)| (a - b).abs() / b.max(0.01)).collect();
        errors.sort_by(f32::total_cmp);
        errors[errors.len() / 2]
    };
    assert!(error("G") < 0.5 * error("noisy.G"), "{} {}", error("G"), error("noisy.G"));
}
