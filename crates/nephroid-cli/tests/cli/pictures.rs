use crate::support::Dir;

/// A folder with a small picture, `x.exr`.
fn dir_with_picture() -> Dir {
    let dir = Dir::with_scene("", "");
    dir.run(&["render", "a.xml", "-o", "x.exr", "-o", "x.png"]).ends_with(0);
    dir
}

#[test]
fn tonemap_makes_what_render_makes() {
    let dir = dir_with_picture();
    let run = dir.run(&["tonemap", "x.exr", "-o", "y.png"]).ends_with(0);
    assert_eq!((run.stdout, run.stderr), (String::new(), String::new()));
    assert!(dir.read("y.png") == dir.read("x.png"));
    let operator = ["--operator", "reinhard:0.3,2", "--exposure", "-1"];
    dir.run(&[&["tonemap", "x.exr", "-o", "z.png"], &operator[..]].concat()).ends_with(0);
    assert!(dir.read("z.png") != dir.read("x.png"));
    let flags = ["--tonemap", "reinhard:0.3,2", "--exposure", "-1", "-o", "w.png"];
    dir.run(&[&["render", "a.xml"], &flags[..]].concat()).ends_with(0);
    assert!(dir.read("w.png") == dir.read("z.png"));
}

#[test]
fn tonemap_refuses_what_it_cannot_do() {
    let dir = dir_with_picture();
    dir.run(&["tonemap", "x.exr", "-o", "y.exr"]).ends_with(2).says("y.exr: this picture is a .png");
    dir.run(&["tonemap", "none.exr", "-o", "y.png"]).ends_with(4).says("none.exr: cannot be read");
    dir.run(&["tonemap", "a.xml", "-o", "y.png"]).ends_with(4).says("a.xml: is of no format");
    dir.run(&["tonemap", "x.exr", "-o", "y.png", "--operator", "aces"])
        .ends_with(2)
        .says("there is no tone map");
}

#[test]
fn a_picture_is_like_itself_and_unlike_another() {
    let dir = dir_with_picture();
    let same = dir.run(&["compare", "x.exr", "x.exr", "--json"]).ends_with(0).json();
    assert_eq!(
        (&same["rmse"], &same["rel_mse"], &same["mean_ratio"]),
        (&0.0.into(), &0.0.into(), &1.0.into())
    );
    dir.run(&["render", "a.xml", "--seed", "1", "-o", "y.exr"]).ends_with(0);
    let other = dir.run(&["compare", "y.exr", "x.exr", "-o", "d.png", "--json"]).ends_with(0).json();
    assert!(other["rmse"].as_f64().unwrap() > 0.0);
    assert_eq!(&dir.read("d.png")[1..4], b"PNG");
    let text = dir.run(&["compare", "y.exr", "x.exr"]).ends_with(0).stdout;
    assert!(text.contains("RMSE") && text.contains("relMSE") && text.contains("mean ratio"), "{text}");
}

#[test]
fn pictures_of_different_sizes_cannot_be_compared() {
    let dir = dir_with_picture();
    dir.run(&["render", "a.xml", "--resolution", "4x4", "-o", "y.exr"]).ends_with(0);
    dir.run(&["compare", "x.exr", "y.exr"]).ends_with(4).says("8×6");
    dir.run(&["compare", "x.exr", "x.exr", "-o", "no/d.png"]).ends_with(4).says("there is no folder");
}
