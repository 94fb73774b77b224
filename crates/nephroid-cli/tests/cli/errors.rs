//! Renders that end by the error that they state, and how they state it.

use nephroid_formats::film_file::read_header;
use serde_json::Value;

use crate::layers::channels;
use crate::support::{Dir, Run};

/// Passes have two samples, and are one step each.
fn path(dir: &Dir, args: &[&str]) -> Run {
    dir.run(&[&["render", "a.xml", "--integrator", "path", "--json"], args].concat())
}

fn passes(report: &Value) -> u64 {
    report["samples_per_pixel"].as_u64().unwrap() / 2
}

/// What the error is stated to be less than.
fn bound(report: &Value) -> f64 {
    report["quality"]["interval"][1].as_f64().unwrap()
}

#[test]
fn it_ends_at_the_first_pass_that_is_good_enough() {
    let dir = Dir::with_scene("", "");
    let report = path(&dir, &["--target-error", "25%"]).ends_with(0).json();
    assert_eq!((&report["ended"], &report["limits"]["target_error"]), (&"error".into(), &0.25.into()));
    assert!(bound(&report) <= 0.25, "{}", report["quality"]);
    let n = passes(&report);
    assert!((3..=16).contains(&n), "each of the first sixteen is judged, and this was number {n}");
    let one_less = path(&dir, &["--passes", &(n - 1).to_string()]).ends_with(0).json();
    assert!(one_less["quality"].is_null() || bound(&one_less) > 0.25, "{}", one_less["quality"]);
    // Whatever comes first.
    let run = path(&dir, &["--target-error", "1e-6", "--passes", "5"]).ends_with(0);
    assert_eq!((&run.json()["ended"], passes(&run.json())), (&"finished".into(), 5));
    run.says("note: the error is not known to be within 0.000 %: stated error");
    let run = path(&dir, &["--target-error", "25", "--time", "1000"]).ends_with(0);
    assert_eq!(passes(&run.json()), n, "the sign may be left out");
}

#[test]
fn it_ends_where_it_would_have_ended_whatever_came_between() {
    let dir = Dir::with_scene("", "");
    let render = |name: &str, args: &[&str]| {
        let (exr, film) = (format!("{name}.exr"), format!("{name}.film"));
        path(&dir, &[&["--target-error", "15", "-o", &exr, "-o", &film], args].concat()).ends_with(0).json()
    };
    let report = render("one", &["--threads", "1"]);
    render("five", &["--threads", "5"]);
    dir.are_the_same("one", "five");
    let begun = ["--target-error", "15", "--passes", "3", "--checkpoint", "c.film", "-o", "c.exr"];
    path(&dir, &begun).ends_with(0);
    let resumed = dir.run(&["resume", "c.film", "--target-error", "15", "--json"]).ends_with(0).json();
    dir.are_the_same("one", "c");
    assert_eq!((&resumed["ended"], &resumed["quality"]), (&"error".into(), &report["quality"]));
    // Asked again there is nothing to do; a smaller error or time mean more.
    let again = dir.run(&["resume", "c.film", "--json"]).ends_with(0).says("everything was rendered before");
    assert_eq!((&again.json()["ended"], &again.json()["quality"]), (&"error".into(), &report["quality"]));
    let further = dir.run(&["resume", "c.film", "--target-error", "12%", "--json"]).ends_with(0).json();
    assert!(bound(&further) <= 0.12 && passes(&further) > passes(&report));
    let timed = dir.run(&["resume", "c.film", "--time", "0.2", "--json"]).ends_with(0).json();
    assert!(timed["ended"] == "time" && passes(&timed) > passes(&further));
}

#[test]
fn parts_state_together_what_the_whole_does() {
    let dir = Dir::with_scene("", "");
    for (integrator, steps) in [("path", (0, 0)), ("ppm", (11, 10))] {
        let render = |more: &[&str]| {
            let args = [
                "render",
                "a.xml",
                "--integrator",
                integrator,
                "--passes",
                "12",
                "--aov",
                "error,depth",
                "--json",
            ];
            dir.run(&[&args[..], more].concat()).ends_with(0).json()
        };
        render(&["--pass-range", "0..5", "-o", "0.film"]);
        render(&["--pass-range", "5..12", "-o", "1.film"]);
        let merge = ["merge", "1.film", "0.film", "-o", "m.exr", "-o", "m.film", "--json"];
        let merged = dir.run(&merge).ends_with(0).json()["quality"].clone();
        let whole = render(&["-o", "w.exr", "-o", "w.film"])["quality"].clone();
        assert!(dir.sums("w.film") == dir.sums("m.film"));
        let without_errors = |file: &str| {
            let mut found = channels(&dir, file);
            assert!(found.remove("error.Y").is_some());
            found
        };
        assert!(without_errors("w.exr") == without_errors("m.exr"));
        assert_eq!(merged["estimates"], whole["estimates"]);
        let ratio = merged["error"].as_f64().unwrap() / whole["error"].as_f64().unwrap();
        assert!((0.7..1.4).contains(&ratio), "{integrator}: {ratio}");
        // A part's first step follows upon none. Of pixels that err by themselves steps need not be compared.
        let of = |film: &str| read_header(&dir.path(film)).unwrap().convergence.steps();
        assert_eq!((of("w.film"), of("m.film")), steps, "{integrator}");
    }
}

#[test]
fn the_layer_of_errors_has_the_error_of_the_picture() {
    let dir = Dir::with_scene("", "");
    for integrator in ["path", "ppm", "ptracer"] {
        let args = ["render", "a.xml", "--integrator", integrator, "--passes", "9", "--json"];
        let run = dir.run(&[&args[..], &["--aov", "error", "-o", "x.exr"]].concat()).ends_with(0);
        assert_eq!(run.json()["layers"], serde_json::json!(["error"]));
        let errors = &channels(&dir, "x.exr")["error.Y"];
        let mean_sq = errors.iter().map(|e| f64::from(e * e)).sum::<f64>() / errors.len() as f64;
        let stated = run.json()["quality"]["error"].as_f64().unwrap();
        // Blur may count below nothing in the mean, and does not in a pixel.
        let above = if integrator == "ppm" { 0.3 } else { 1e-5 };
        let ratio = mean_sq.sqrt() / stated;
        assert!((1.0 - 1e-5..1.0 + above).contains(&ratio), "{integrator}: {ratio}");
        let text = dir.run(&["render", "a.xml", "--integrator", integrator, "--passes", "9"]).ends_with(0);
        text.says(", stated error ").says(" % (90 %: ");
    }
    let few = path(&dir, &["--passes", "1", "--aov", "error", "-o", "y.exr"]).ends_with(0);
    few.says("warning: the layer error is left out: it cannot be told from so few passes\n");
    assert_eq!(channels(&dir, "y.exr").len(), 3);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let dir = Dir::with_scene("", "");
    let refused = |args: &[&str], message: &str| {
        dir.run(&[&["render", "a.xml"], args].concat()).ends_with(2).says(message);
        assert!(dir.files().is_empty());
    };
    let who = "photonmapper cannot tell its error, which is mostly blur; render with auto, ppm, vcm, path, volpath or ptracer";
    refused(&["--target-error", "5"], &format!("error: --target-error: {who}: see --integrator\n"));
    refused(&["--aov", "error", "-o", "x.exr"], &format!("error: --aov error: {who}: see --integrator\n"));
    for bad in ["0", "-1%", "five"] {
        let message = "--target-error <PERCENT>': write a percentage above zero, as in 5%";
        refused(&[&format!("--target-error={bad}")], message);
    }
    let path = ["--integrator", "path", "--target-error", "5"];
    let part = ["--pass-range", "0..1", "-o", "x.film"];
    refused(
        &[path, part].concat(),
        "error: --pass-range: a part of a render does not know the error of the whole",
    );
    refused(
        &["--integrator", "path", "--aov", "error", "-o", "x.png"],
        "error: --aov: layers are written to",
    );
}
