//! Renders that are shared out by passes and merged.

use crate::support::Dir;

/// What differs between ways to render, for a picture of a few hundred pixels.
const WAYS: [&[&str]; 4] = [
    &["cornell", "--spp", "20", "--passes", "4", "--photons", "900", "--caustic-photons", "300"],
    &["cornell", "--integrator", "ppm", "--passes", "4", "--photons", "900", "--caustic-photons", "300"],
    &["cornell", "--integrator", "ptracer", "--spp", "12", "--passes", "4"],
    &["fog", "--integrator", "volpath", "--spp", "12", "--passes", "4", "--aov", "albedo,depth,medium"],
];

const SMALL: &[&str] = &["--resolution", "16x12", "--quiet", "--seed", "5"];

fn render(dir: &Dir, way: &[&str], more: &[&str]) {
    dir.run(&[&["render"], way, SMALL, more].concat()).ends_with(0);
}

#[test]
fn parts_in_any_order_are_the_whole_to_the_bit() {
    for way in WAYS {
        let dir = Dir::new();
        render(&dir, way, &["-o", "whole.exr", "-o", "whole.film", "--threads", "3"]);
        for (i, range) in ["0..1", "1..3", "3..4"].into_iter().enumerate() {
            let (file, threads) = (format!("{i}.film"), (i + 1).to_string());
            render(&dir, way, &["--pass-range", range, "-o", &file, "--threads", &threads]);
        }
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let [a, b, c] = order.map(|i| format!("{i}.film"));
            let run =
                dir.run(&["merge", &a, &b, &c, "-o", "sum.exr", "-o", "sum.film", "--json"]).ends_with(0);
            assert_eq!(run.stderr, "");
            assert_eq!(run.json()["missing"], serde_json::json!([]));
            dir.are_the_same("whole", "sum");
        }
        // Of the sum more can be rendered, as of the whole.
        for name in ["whole", "sum"] {
            let (film, exr) = (format!("{name}.film"), format!("{name}.exr"));
            dir.run(&["resume", &film, "--passes", "5", "-o", &exr]).ends_with(0);
        }
        dir.are_the_same("whole", "sum");
    }
}

#[test]
fn a_part_says_that_it_is_one() {
    let dir = Dir::with_scene("", "");
    let args = ["render", "a.xml", "--pass-range", "2..5", "-o", "x.png", "-o", "x.film", "--json"];
    let run =
        dir.run(&args).ends_with(0).says("note: the pictures show a part of the render only: passes 2 to 4");
    let object = run.json();
    assert_eq!(object["covered"], serde_json::json!([[4, 10]]));
    assert_eq!((&object["passes_done"], &object["samples_per_pixel"]), (&3.into(), &6.into()));
    assert_eq!(object["limits"]["pass_range"], serde_json::json!([2, 5]));
    let more = dir.run(&["resume", "x.film", "--passes", "9"]).ends_with(2);
    more.says("this is a part of a render, passes 2 to 4");
}

#[test]
fn parts_of_other_renders_are_refused_by_name() {
    let dir = Dir::with_scene("", "");
    let part = |file: &str, more: &[&str]| {
        dir.run(&[&["render", "a.xml", "--quiet", "-o", file], more].concat()).ends_with(0);
    };
    part("a.film", &["--pass-range", "0..1"]);
    part("seed.film", &["--pass-range", "1..2", "--seed", "7"]);
    part("kernel.film", &["--pass-range", "1..2", "--kernel", "box"]);
    part("size.film", &["--pass-range", "1..2", "--resolution", "9x9"]);
    for (name, reason) in [("seed", "seed: 0 and 7"), ("kernel", "kernel: "), ("size", "pixels: 8×6 and 9×9")]
    {
        let run = dir.run(&["merge", "a.film", &format!("{name}.film"), "-o", "x.exr"]).ends_with(4);
        run.says(reason).says("a.film").says(&format!("{name}.film"));
    }
    assert!(!dir.files().contains(&"x.exr".to_owned()));
}

#[test]
fn overlaps_are_refused_and_gaps_are_listed() {
    let dir = Dir::with_scene("", "");
    for range in ["0..2", "1..3", "4..6"] {
        let file = format!("{range}.film");
        dir.run(&["render", "a.xml", "--passes", "8", "--pass-range", range, "-o", &file]).ends_with(0);
    }
    let run = dir.run(&["merge", "0..2.film", "1..3.film", "-o", "x.exr"]).ends_with(4);
    run.says("1..3.film: has pass 1 in common with 0..2.film");
    let args = ["merge", "4..6.film", "0..2.film", "-o", "x.exr", "-o", "x.film"];
    let run = dir.run(&args).ends_with(0).says("missing is passes 2 to 3, passes 6 to 7");
    run.says("before it can be gone on with");
    assert!(dir.files().contains(&"x.exr".to_owned()));
    let run = dir.run(&["merge", "4..6.film", "0..2.film", "-o", "y.exr", "--json"]).ends_with(0);
    assert_eq!(run.json()["missing"], serde_json::json!([[4, 8], [12, 16]]));
    let run = dir.run(&["merge", "4..6.film", "0..2.film", "-o", "z.exr", "--complete"]).ends_with(4);
    run.says("missing is passes 2 to 3, passes 6 to 7");
    assert!(!dir.files().contains(&"z.exr".to_owned()));
    dir.run(&["resume", "x.film"]).ends_with(4).says("passes 0 to 1, passes 4 to 5");
}

#[test]
fn ranges_must_be_of_the_whole() {
    let dir = Dir::with_scene("", "");
    let usage = |more: &[&str], reason: &str| {
        dir.run(&[&["render", "a.xml", "-o", "x.film"], more].concat()).ends_with(2).says(reason);
    };
    usage(&["--pass-range", "3..3"], "there are no passes");
    usage(&["--pass-range", "3"], "write A..B");
    usage(&["--pass-range", "3..9", "--passes", "8"], "the whole render has --passes 8");
    usage(&["--pass-range", "0..1", "--spp", "8"], "say with --passes");
    usage(&["--pass-range", "0..1", "--spp", "2", "--passes", "4"], "--spp 2 is too little for --passes 4");
    usage(&["--pass-range", "0..1", "--spp", "8", "--passes", "8", "--integrator", "ppm"], "without --spp");
    usage(&["--pass-range", "+1..2"], "write A..B");
    assert!(dir.files().is_empty());
}
