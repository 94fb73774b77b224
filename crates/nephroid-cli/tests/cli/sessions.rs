//! Checkpoints: when they are written, gone on with, and refused.

use crate::support::{Dir, Run, SCENE};

/// Renders two passes and keeps them.
fn kept(dir: &Dir) {
    let args = ["render", "a.xml", "--passes", "2", "--checkpoint", "c.film", "-o", "x.exr", "-o", "x.png"];
    dir.run(&args).ends_with(0).says("kept: c.film");
}

#[test]
fn a_finished_render_writes_its_pictures_again_and_adds_passes() {
    let dir = Dir::with_scene("", "");
    kept(&dir);
    let (exr, film) = (dir.read("x.exr"), dir.read("c.film"));
    for file in ["x.exr", "x.png"] {
        std::fs::remove_file(dir.path(file)).unwrap();
    }
    let run = dir.run(&["resume", "c.film", "--json"]).ends_with(0).says("everything was rendered before");
    assert_eq!((&run.json()["camera_samples"], &run.json()["samples_per_pixel"]), (&0.into(), &4.into()));
    assert!(dir.read("x.exr") == exr && dir.read("c.film") == film);
    dir.run(&["resume", "c.film", "--passes", "3", "-o", "kept.exr"]).ends_with(0);
    assert!(dir.read("x.exr") == exr, "with -o, what the render was to write is left alone");
    dir.run(&["render", "a.xml", "--passes", "3", "-o", "whole.film", "-o", "whole.exr"]).ends_with(0);
    std::fs::rename(dir.path("c.film"), dir.path("kept.film")).unwrap();
    dir.are_the_same("whole", "kept");
}

#[test]
fn a_render_goes_on_from_any_folder() {
    let dir = Dir::with_scene("", "");
    kept(&dir);
    std::fs::create_dir(dir.path("sub")).unwrap();
    std::fs::remove_file(dir.path("x.png")).unwrap();
    let args = ["resume", "../c.film", "--passes", "3"];
    Run::of(dir.command(&args).current_dir(dir.path("sub")).output().unwrap()).ends_with(0);
    assert_eq!(dir.files(), ["c.film", "sub", "x.exr", "x.png"]);
    // Built-in scenes have no folder, not even where a file has their name.
    dir.render("cornell", &["--checkpoint", "b.film", "-o", "b.exr"]).ends_with(0);
    std::fs::write(dir.path("cornell"), SCENE).unwrap();
    dir.run(&["resume", "b.film", "--passes", "2"]).ends_with(4).says("scene: ");
    std::fs::remove_file(dir.path("cornell")).unwrap();
    dir.run(&["resume", "b.film", "--passes", "2"]).ends_with(0);
}

#[test]
fn time_is_what_is_left_of_it_or_new() {
    let dir = Dir::with_scene("", "");
    let args =
        ["render", "a.xml", "--time", "0.4", "--threads", "1", "--checkpoint", "c.film", "-o", "x.exr"];
    dir.run(&args).ends_with(0);
    let first = dir.sums("c.film").2.total();
    let run = dir.run(&["resume", "c.film", "--json"]).ends_with(0);
    assert_eq!(run.json()["ended"], "time");
    run.does_not_say("everything was rendered before");
    dir.run(&["resume", "c.film", "--time", "0.3"]).ends_with(0);
    assert!(dir.sums("c.film").2.total() > first);
}

#[test]
fn what_has_changed_is_refused() {
    let triangle = |z: f32| format!("v 0 0 {z}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mesh = r#"<shape type="obj"><string name="filename" value="t.obj"/></shape></scene>"#;
    let dir = Dir::with_scene("</scene>", mesh);
    std::fs::write(dir.path("t.obj"), triangle(0.0)).unwrap();
    kept(&dir);
    std::fs::write(dir.path("t.obj"), triangle(0.5)).unwrap();
    let film = dir.read("c.film");
    dir.run(&["resume", "c.film", "--passes", "3"]).ends_with(4).says("file t.obj: ").does_not_say("scene: ");
    std::fs::write(dir.path("t.obj"), triangle(0.0)).unwrap();
    let scene = std::fs::read_to_string(dir.path("a.xml")).unwrap();
    std::fs::write(dir.path("a.xml"), scene.replace("2, 2, 4", "2, 2, 5")).unwrap();
    dir.run(&["resume", "c.film", "--passes", "3"]).ends_with(4).says("scene: ").does_not_say("t.obj");
    std::fs::remove_file(dir.path("a.xml")).unwrap();
    dir.run(&["resume", "c.film", "--passes", "3"]).ends_with(4).says("a.xml: no such file");
    assert!(dir.read("c.film") == film);
}

#[test]
fn a_new_render_replaces_no_checkpoint() {
    let dir = Dir::with_scene("", "");
    kept(&dir);
    let film = dir.read("c.film");
    let again = |more: &[&str]| {
        dir.run(&[&["render", "a.xml", "--checkpoint", "c.film", "-o", "x.exr"], more].concat()).ends_with(4)
    };
    again(&[]).says("keeps this render already, with passes 0 to 1").says("nephroid resume c.film");
    again(&["--seed", "9"]).says("keeps another render").says("seed: 0 and 9");
    assert!(dir.read("c.film") == film);
    std::fs::write(dir.path("c.film"), "a letter").unwrap();
    again(&[]).says("c.film exists and is not overwritten").says("not a film file");
    assert_eq!(dir.read("c.film"), b"a letter");
}

#[test]
fn files_that_are_no_films_or_cut_off() {
    let dir = Dir::with_scene("", "");
    kept(&dir);
    let film = dir.read("c.film");
    std::fs::write(dir.path("half.film"), &film[..film.len() / 2]).unwrap();
    for command in [&["resume", "half.film"][..], &["merge", "c.film", "half.film", "-o", "m.exr"]] {
        dir.run(command).ends_with(4).says("half.film: is cut off");
    }
    dir.run(&["resume", "x.exr"]).ends_with(4).says("x.exr: is an OpenEXR image, not a film file");
    dir.run(&["resume", "none.film"]).ends_with(4).says("none.film: cannot be read");
    assert!(!dir.files().contains(&"m.exr".to_owned()));
}

#[test]
fn a_checkpoint_is_tried_before_rendering() {
    let dir = Dir::with_scene("", "");
    let hopeless = |file: &str| {
        let args = ["render", "a.xml", "--passes", "1000000000", "--checkpoint", file, "-o", "x.png"];
        dir.run(&args)
    };
    hopeless("no/where.film").ends_with(4).says("no/where.film: cannot be written: there is no folder no");
    std::fs::create_dir(dir.path("folder")).unwrap();
    std::fs::create_dir(dir.path("folder/c.film")).unwrap();
    hopeless("folder/c.film").ends_with(4).says("folder/c.film: is not a file");
    hopeless("x.png").ends_with(2).says("written twice, with -o and --checkpoint");
    hopeless("c.exr").ends_with(2).says("this file is a .film");
    let twice = |args: &[&str]| {
        dir.run(&[&["render", "a.xml", "--passes", "1000000000"], args].concat())
            .ends_with(2)
            .says("written twice")
    };
    twice(&["-o", "x.png", "-o", "./x.png"]);
    twice(&["-o", "x.film", "--checkpoint", "folder/../x.film"]);
    twice(&["-o", "x.png", "--preview", "./x.png"]).says("with -o and --preview");
    if cfg!(target_os = "linux") {
        hopeless("/proc/self/x.film").ends_with(4).says("/proc/self/x.film: cannot be written");
    }
    assert_eq!(dir.files(), ["folder"]);
}

#[test]
fn time_alone_goes_beyond_the_end() {
    let dir = Dir::with_scene("", "");
    kept(&dir);
    dir.run(&["resume", "c.film", "--time", "0.3"]).ends_with(0).does_not_say("rendered before");
    assert!(dir.sums("c.film").2.total() > 4);
}

#[test]
fn a_folder_may_be_moved() {
    let dir = Dir::new();
    std::fs::create_dir(dir.path("old")).unwrap();
    std::fs::write(dir.path("old/a.xml"), SCENE).unwrap();
    let args = ["render", "a.xml", "--passes", "2", "--checkpoint", "c.film", "-o", "x.exr"];
    Run::of(dir.command(&args).current_dir(dir.path("old")).output().unwrap()).ends_with(0);
    std::fs::rename(dir.path("old"), dir.path("new")).unwrap();
    std::fs::remove_file(dir.path("new/x.exr")).unwrap();
    dir.run(&["resume", "new/c.film", "--passes", "3"]).ends_with(0);
    assert!(dir.path("new/x.exr").exists());
    assert_eq!(dir.files(), ["new"]);
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text_stop_only_films() {
    use std::os::unix::ffi::OsStrExt;
    let dir = Dir::new();
    let odd = std::ffi::OsStr::from_bytes(b"a\xff.xml");
    std::fs::write(dir.path(odd), SCENE).unwrap();
    let run = |more: &[&str]| Run::of(dir.command(&["render"]).arg(odd).args(more).output().unwrap());
    run(&["-o", "x.png"]).ends_with(0);
    run(&["-o", "x.film"]).ends_with(2).says("keeps names in UTF-8 only");
    run(&["-o", "x.png", "--checkpoint", "c.film"]).ends_with(2).says("keeps names in UTF-8 only");
}

/// Starts a render that would take for ever, and stops it as a terminal or a scheduler does.
#[cfg(unix)]
#[test]
fn an_interrupt_keeps_what_is_whole() {
    ["-INT", "-TERM"].into_iter().for_each(is_kept_after);
}

#[cfg(unix)]
fn is_kept_after(signal: &str) {
    use std::process::{Command, Stdio};
    let dir = Dir::with_scene("", "");
    let args = [
        "render",
        "a.xml",
        "--passes",
        "1000000000",
        "--checkpoint",
        "c.film",
        "--checkpoint-every",
        "0.01",
        "-o",
        "x.exr",
        "-o",
        "y.film",
    ];
    let child = dir.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    dir.wait_for("c.film");
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    Run::of(child.wait_with_output().unwrap()).ends_with(130);
    assert_eq!(dir.files(), ["c.film", "x.exr", "y.film"]);
    assert!(dir.sums("c.film") == dir.sums("y.film"));
    let passes = dir.sums("c.film").2.total() / 2;
    let goal = (passes + 2).to_string();
    dir.run(&["resume", "c.film", "--passes", &goal, "-o", "kept.exr", "-o", "kept.film"]).ends_with(0);
    let whole = ["render", "a.xml", "--passes", &goal, "-o", "whole.exr", "-o", "whole.film"];
    dir.run(&whole).ends_with(0);
    dir.are_the_same("whole", "kept");
}

/// A file system that is there until this is dropped, before the folder it is in.
#[cfg(target_os = "linux")]
struct Disk(std::path::PathBuf);

#[cfg(target_os = "linux")]
impl Drop for Disk {
    fn drop(&mut self) {
        // Nobody is left to tell where a test has failed already.
        let _ = std::process::Command::new("umount").arg(&self.0).status();
    }
}

/// A disk with room for one film and a half, where this process may make one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_last_checkpoint_and_the_pictures() {
    use std::process::Command;
    let dir = Dir::with_scene("", "");
    let disk = dir.path("disk");
    std::fs::create_dir(&disk).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=192k", "none"]).arg(&disk).output();
    if !mount.is_ok_and(|mount| mount.status.success()) {
        println!("left out: no file system can be mounted here");
        return;
    }
    let args = ["render", "a.xml", "--resolution", "64x48", "--passes", "9", "--checkpoint", "disk/c.film"];
    let _disk = Disk(disk);
    let run = dir.run(&[&args[..], &["--checkpoint-every", "0.001", "-o", "x.exr"]].concat());
    let run = run.ends_with(4).says("warning: the render goes on, but cannot be kept for now: disk/c.film");
    assert_eq!(run.stderr.matches("for now").count(), 1);
    // It is told with the report, not instead of it.
    let run = run.says("written: x.exr");
    assert!(run.stderr.contains("error: disk/c.film"), "{}", run.stderr);
    let kept = dir.sums("disk/c.film");
    assert!((1..9).contains(&(kept.2.total() / 2)), "{:?}", kept.2);
    assert!(dir.files().contains(&"x.exr".to_owned()));
}
