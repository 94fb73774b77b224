//! Scenes that are written anew, and scenes in a sandbox.

use crate::support::Dir;

#[test]
fn a_converted_scene_makes_the_same_picture() {
    let dir = Dir::new();
    dir.run(&["convert", "pool", "mine.xml"])
        .ends_with(0)
        .says("wrote mine.xml and a file in mine_files")
        .says("warning: Mitsuba has no integrator");
    assert_eq!(dir.files(), ["mine.xml", "mine_files"]);
    let render = |scene: &str, out: &str| {
        dir.render(scene, &["--integrator", "path", "-o", out]).ends_with(0);
    };
    render("pool", "a.exr");
    render("mine.xml", "b.exr");
    assert!(dir.read("a.exr") == dir.read("b.exr"));
}

#[test]
fn nothing_is_written_over_unasked() {
    let dir = Dir::with_scene("", "");
    dir.run(&["convert", "a.xml", "b.xml"]).ends_with(0).says("wrote b.xml");
    let first = dir.read("b.xml");
    dir.run(&["convert", "cornell", "b.xml"]).ends_with(4).says("b.xml: exists; --overwrite writes over it");
    assert!(dir.read("b.xml") == first);
    dir.run(&["convert", "cornell", "b.xml", "--overwrite"]).ends_with(0).says("in place of what was there");
    assert!(dir.read("b.xml") != first);
    std::fs::create_dir(dir.path("c_files")).unwrap();
    dir.run(&["convert", "a.xml", "c.xml"]).ends_with(4).says("c_files: exists");
    dir.run(&["convert", "a.xml", "none/c.xml"]).ends_with(4).says("there is no folder none");
    dir.run(&["convert", "a.xml", "c.obj"]).ends_with(2).says("as .xml files of Mitsuba 3 only");
    dir.run(&["convert", "none.xml", "d.xml"]).ends_with(4).says("no such file");
}

#[cfg(unix)]
#[test]
fn a_scene_in_a_sandbox_reads_nothing_else() {
    let dir = Dir::new();
    std::fs::create_dir(dir.path("in")).unwrap();
    std::fs::write(dir.path("secret.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::os::unix::fs::symlink("../secret.obj", dir.path("in/link.obj")).unwrap();
    let scene = |name: &str| {
        let shape = format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/></shape>");
        let text = format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{shape}</scene>");
        std::fs::write(dir.path("in/s.xml"), text).unwrap();
    };
    let absolute = dir.path("secret.obj").display().to_string();
    for name in ["../secret.obj", "link.obj", absolute.as_str()] {
        scene(name);
        for command in [&["info", "in/s.xml"][..], &["convert", "in/s.xml", "out.xml"]] {
            let with = |flag: &'static str| dir.run(&[command, &[flag]].concat());
            with("--sandbox").ends_with(3).says("it is outside of the sandbox, the folder");
            with("--sandbox=in").ends_with(3).says("it is outside of the sandbox, the folder");
        }
        dir.run(&["info", "in/s.xml", "--sandbox=."]).ends_with(0);
        dir.run(&["info", "in/s.xml"]).ends_with(0);
    }
    dir.run(&["info", "in/s.xml", "--sandbox=none"]).ends_with(2).says("the folder \"none\" cannot be had");
    dir.run(&["info", "cornell", "--sandbox"]).ends_with(0);
}
