use crate::support::Dir;

fn samples_and_passes(dir: &Dir, args: &[&str]) -> (u64, u64) {
    let run = dir.run(&[&["render", "a.xml", "--json"], args].concat()).ends_with(0);
    let object = run.json();
    (object["samples_per_pixel"].as_u64().unwrap(), object["passes"].as_u64().unwrap())
}

#[test]
fn the_scene_says_how_many_samples_unless_the_command_line_does() {
    let dir = Dir::with_scene("", "");
    assert_eq!(samples_and_passes(&dir, &[]), (2, 1));
    assert_eq!(samples_and_passes(&dir, &["--spp", "5"]), (5, 1));
    assert_eq!(samples_and_passes(&dir, &["--passes", "3"]), (6, 3));
    assert_eq!(samples_and_passes(&dir, &["--passes", "3", "--spp", "12"]), (12, 3));
    assert_eq!(samples_and_passes(&dir, &["--passes", "1000000", "--spp", "5"]), (5, 5));
}

#[test]
fn every_pass_has_photons_of_its_own() {
    let dir = Dir::with_scene("", "");
    let photons = |passes: &str| {
        let run = dir.run(&["render", "a.xml", "--json", "--passes", passes, "--direct", "map"]).ends_with(0);
        run.json()["photons"]["global"]["emitted"].as_u64().unwrap()
    };
    assert_eq!(photons("4"), 4 * photons("1"));
}

#[test]
fn time_is_met_within_five_per_cent() {
    let dir = Dir::with_scene("", "");
    let run = dir.run(&["render", "a.xml", "--json", "--time", "2", "--threads", "1"]).ends_with(0);
    let object = run.json();
    let took = object["seconds"]["render"].as_f64().unwrap();
    assert!((took / 2.0 - 1.0).abs() < 0.05, "{took}");
    assert_eq!(object["ended"], "time");
    assert!(object["passes"].as_u64().unwrap() > 1);
}

#[test]
fn of_several_limits_the_first_counts() {
    let dir = Dir::with_scene("", "");
    let run = dir.run(&["render", "a.xml", "--json", "--time", "1000", "--passes", "2"]).ends_with(0);
    assert_eq!(run.json()["ended"], "finished");
}

#[test]
fn time_leaves_at_least_one_step_of_picture() {
    let dir = Dir::with_scene("", "");
    let run = dir.run(&["render", "a.xml", "--json", "--time", "1e-9", "-o", "x.exr"]).ends_with(0);
    run.json();
    assert_eq!(dir.files(), ["x.exr"]);
    run.says("longer than --time");
}

/// Starts a render that would take for ever, and interrupts it.
#[cfg(unix)]
#[test]
fn an_interrupt_writes_what_there_is() {
    use std::process::{Command, Stdio};
    let dir = Dir::with_scene("", "");
    let args = ["render", "a.xml", "--json", "--passes", "1000000000", "-o", "x.exr", "-o", "x.png"];
    let child = dir.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let run = crate::support::Run::of(child.wait_with_output().unwrap()).ends_with(130);
    assert_eq!(run.json()["ended"], "interrupted");
    assert_eq!(dir.files(), ["x.exr", "x.png"]);
}
