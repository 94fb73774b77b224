//! Parameters of media that contradict one another, or the scene: one message each, and only one.

use crate::support::{Dir, Run, SCENE};

/// [`SCENE`] with the camera in fog.
fn foggy(parameters: &str) -> Dir {
    let dir = Dir::new();
    let fog =
        r#"<medium type="homogeneous" name="exterior"><float name="sigma_t" value="0.1"/></medium></shape>"#;
    let room = r#"<boolean name="flip_normals" value="true"/></shape>"#;
    let ours = r#"<integer name="photons" value="300"/>"#;
    assert!(SCENE.contains(room) && SCENE.contains(ours));
    let room_with_fog = room.replace("</shape>", &format!(r#"<bsdf type="diffuse"/>{fog}"#));
    let few = r#"<integer name="volume_photons" value="200"/><integer name="caustic_photons" value="9"/>"#;
    let scene = SCENE.replace(room, &room_with_fog).replace(ours, &format!("{ours}{few}{parameters}"));
    std::fs::write(dir.path("a.xml"), scene).unwrap();
    dir
}

/// Renders, and gives the one message.
#[track_caller]
fn only_message(dir: &Dir, args: &[&str], code: i32) -> String {
    let run = render(dir, args).ends_with(code);
    assert!(
        run.stderr.lines().filter(|line| !line.starts_with(' ')).count() <= 1,
        "{args:?}: {}",
        run.stderr
    );
    run.stderr
}

fn render(dir: &Dir, args: &[&str]) -> Run {
    dir.run(&[&["render", "a.xml", "--json", "--spp", "1"], args].concat())
}

fn text(name: &str, value: &str) -> String {
    format!(r#"<string name="{name}" value="{value}"/>"#)
}

#[test]
fn beams_are_never_marched() {
    let dir = foggy("");
    for estimate in ["march", "march-report"] {
        let message = only_message(&dir, &["--volume-kind", "beams", "--volume-estimate", estimate], 2);
        assert!(message.starts_with("error: --volume-kind beams cannot be had"), "{message}");
    }
    assert_eq!(only_message(&dir, &["--volume-kind", "beams", "--volume-estimate", "beam"], 0), "");
    let both = foggy(&(text("volume_kind", "beams") + &text("volume_estimate", "march")));
    let run = render(&both, &[]).ends_with(3).says("a.xml:2").says("only points are marched");
    assert_eq!(run.stderr.matches("only points are marched").count(), 1, "{}", run.stderr);
}

#[test]
fn of_beams_and_marching_the_command_line_wins() {
    let dir = foggy(&text("volume_kind", "beams"));
    let message = only_message(&dir, &["--volume-estimate", "march"], 0);
    assert!(message.starts_with("note: only points are marched"), "{message}");
    let used = render(&dir, &["--volume-estimate", "march"]).json()["integrator"].clone();
    assert_eq!((&used["volume_kind"], &used["volume_estimate"]), (&"points".into(), &"march".into()));
    let dir = foggy(&text("volume_estimate", "march"));
    let message = only_message(&dir, &["--volume-kind", "beams"], 0);
    assert!(message.starts_with("note: the scene's \"volume_estimate\" is for points"), "{message}");
    let used = render(&dir, &["--volume-kind", "beams"]).json()["integrator"].clone();
    assert_eq!((&used["volume_kind"], &used["volume_estimate"]), (&"beams".into(), &"beam".into()));
}

#[test]
fn flags_without_effect_are_told_once() {
    let dir = foggy("");
    for (args, message) in [
        (
            &["--march-step", "1"][..],
            "warning: --march-step means nothing without --volume-estimate march-report\n",
        ),
        (&["--beam-crossings", "9"], "warning: --beam-crossings means nothing without --volume-kind beams\n"),
        (
            &["--volume-kind", "beams", "--volume-neighbours", "9"],
            "warning: --volume-neighbours means nothing to --volume-kind beams\n",
        ),
        (&["--march-step", "9", "--volume-estimate", "march-report"], ""),
        (&["--beam-crossings", "9", "--volume-kind", "beams"], ""),
        (&["--volume-neighbours", "9"], ""),
    ] {
        assert_eq!(only_message(&dir, args, 0), message, "{args:?}");
    }
}

#[test]
fn a_scene_without_media_has_no_use_for_their_flags() {
    let dir = Dir::with_scene("", "");
    let message = only_message(&dir, &["--march-step", "1", "--fog", "ambient"], 0);
    let expected = "warning: --fog, --march-step mean nothing to a scene without media\n";
    assert_eq!(message, expected);
    // A medium that nothing names is nowhere.
    let dir = Dir::with_scene("<emitter", r#"<medium type="homogeneous" id="fog"/><emitter"#);
    let run = render(&dir, &["--fog", "volume"]).ends_with(0);
    run.says("warning: --fog means nothing to a scene without media\n");
}

#[test]
fn the_path_tracer_takes_no_notice_of_media() {
    let dir = foggy("");
    // Without the flags of photons, which would be told of as well.
    let path = |integrator| dir.run(&["render", "a.xml", "--spp", "1", "--json", "--integrator", integrator]);
    let expected = "warning: the integrator path takes no notice of media; volpath is the one that does\n";
    assert_eq!(path("path").ends_with(0).stderr, expected);
    assert_eq!(path("volpath").ends_with(0).stderr, "");
}

#[test]
fn ambient_fog_without_ambient_light_only_weakens() {
    let dir = foggy("");
    let message = only_message(&dir, &["--fog", "ambient"], 0);
    let expected =
        "note: no medium of the scene has \"ambient\" light: with --fog ambient they only weaken light\n";
    assert_eq!(message, expected);
    let ambient = r#"<rgb name="ambient" value="1"/></medium>"#;
    let lit = foggy(&text("fog", "ambient"));
    let scene = String::from_utf8(lit.read("a.xml")).expect("text").replace("</medium>", ambient);
    std::fs::write(lit.path("a.xml"), scene).expect("a file");
    assert_eq!(only_message(&lit, &[], 0), "");
    let message = only_message(&lit, &["--volume-kind", "beams"], 0);
    assert_eq!(message, "warning: --volume-kind means nothing to --fog ambient\n");
}
