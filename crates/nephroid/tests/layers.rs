//! The modules of the library in layers: a module may use those above it in [`LAYERS`], and none below.
//!
//! Without a check the order would be gone in a year: nothing else notices when a shape asks the world.
//! Unit tests may use anything: a light is best tested in a world.

use std::fs;
use std::path::{Path, PathBuf};

/// Every module at the root of the crate, from those that know nothing to those that know all.
const LAYERS: &[&str] = &[
    "math",
    "color",
    "handle",
    "observer",
    "sampling",
    "bvh",
    "photon_map",
    "texture",
    "film",
    "material",
    "medium",
    "camera",
    "shape",
    "light",
    "scene",
    "world",
    "transport",
    "integrator",
    "session",
    "laboratory",
];

#[test]
fn no_module_uses_one_below_it() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    assert!(files.len() > LAYERS.len(), "the source is elsewhere: {}", source.display());
    let violations: Vec<String> = files
        .iter()
        .map(|path| (path.strip_prefix(&source).unwrap(), fs::read_to_string(path).unwrap()))
        .filter(|(path, _)| *path != Path::new("lib.rs") && !is_a_test(path))
        .flat_map(|(path, text)| violations(path, &text))
        .collect();
    assert!(violations.is_empty(), "see the order in tests/layers.rs:\n{}", violations.join("\n"));
}

#[test]
fn the_list_is_that_of_the_crate() {
    let root = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let mut declared: Vec<&str> = root
        .lines()
        .filter_map(|line| line.strip_prefix("pub ").unwrap_or(line).strip_prefix("mod ")?.strip_suffix(';'))
        .collect();
    let mut listed = LAYERS.to_vec();
    declared.sort_unstable();
    listed.sort_unstable();
    assert_eq!(declared, listed);
}

#[test]
fn a_planted_violation_is_found() {
    let found = |path: &str, text: &str| violations(Path::new(path), text).len();
    assert_eq!(found("shape/sphere.rs", "use crate::world::World;"), 1);
    assert_eq!(found("shape/sphere.rs", "use crate::math::Vec3;"), 0);
    assert_eq!(found("shape/sphere.rs", "use crate::shape::Shape;"), 0);
    assert_eq!(found("camera.rs", "fn f(world: &crate::world::World) {}"), 1);
    assert_eq!(found("camera.rs", "use super::world::World;"), 1);
    assert_eq!(found("film/mod.rs", "pub(in super::scene) struct S;"), 1);
    assert_eq!(found("film/mod.rs", "use super::fixed;"), 0);
    assert_eq!(found("film/sums.rs", "use super::super::scene::Scene;"), 1);
    assert_eq!(
        found(
            "math/ray.rs",
            "use crate::{\n    math::{Vec2, Vec3},\n    film::{Film, Filter},\n    world,\n};"
        ),
        2
    );
    assert_eq!(found("math/ray.rs", "use crate::Scene;"), 1);
    assert_eq!(found("math/ray.rs", "/// See [`crate::world`].\nlet x = 1; // crate::world"), 0);
    assert_eq!(found("math/ray.rs", "use othercrate::world;"), 0);
    assert_eq!(found("unlisted/mod.rs", ""), 1);
}

#[test]
fn unit_tests_may_use_anything() {
    let code = "use crate::math::Vec3;\n#[cfg(test)]\nmod tests {\n    use crate::world::World;\n}\n";
    assert!(violations(Path::new("light/spot.rs"), code).is_empty());
    assert!(is_a_test(Path::new("light/sampling_tests.rs")) && !is_a_test(Path::new("light/spot.rs")));
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("a folder that can be listed");
    let mut entries: Vec<PathBuf> = entries.map(|e| e.expect("an entry of it").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Whether a file holds unit tests that stand apart from what they test.
fn is_a_test(path: &Path) -> bool {
    path.file_stem().and_then(|stem| stem.to_str()).is_some_and(|stem| stem.ends_with("tests"))
}

/// What a file, whose path is relative to `src`, uses that it may not; one line each.
fn violations(path: &Path, text: &str) -> Vec<String> {
    let own = path.iter().next().and_then(|first| first.to_str()).unwrap_or_default().trim_end_matches(".rs");
    let Some(layer) = LAYERS.iter().position(|name| *name == own) else {
        return vec![format!("{}: the module `{own}` is not in the list", path.display())];
    };
    let code = without_comments(text);
    // Tests stand at the foot of a file.
    let code = code.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut out = Vec::new();
    let mut complain = |what: String| out.push(format!("{}: {what}", path.display()));
    for name in used(code, "crate::") {
        match LAYERS.iter().position(|known| *known == name) {
            Some(other) if other > layer => complain(format!("`{own}` uses `{name}`, a layer below it")),
            Some(_) => {}
            None => complain(format!("`crate::{name}` is no module of the list")),
        }
    }
    // From the top file of a module, `super` is the root of the crate.
    if path.iter().count() == 1 || path.ends_with("mod.rs") && path.iter().count() == 2 {
        for name in used(code, "super::") {
            if LAYERS.iter().position(|known| *known == name).is_some_and(|other| other > layer) {
                complain(format!("`{own}` uses `{name}`, a layer below it"));
            }
        }
    }
    if code.contains("super::super::") {
        complain("write `crate::` for what is further up than the parent".to_owned());
    }
    out
}

/// The text without line comments. A `//` inside a string ends its line, too, which hides nothing here.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The names that directly follow a prefix, those in braces one by one.
fn used<'t>(code: &'t str, prefix: &str) -> Vec<&'t str> {
    let mut out = Vec::new();
    for (start, _) in code.match_indices(prefix) {
        if code[..start].ends_with(is_of_a_name) {
            continue;
        }
        let rest = &code[start + prefix.len()..];
        match rest.strip_prefix('{') {
            Some(group) => out.extend(members(group)),
            None => out.push(first_name(rest)),
        }
    }
    out
}

/// The first names of the paths in a group, up to the brace that closes it.
fn members(group: &str) -> Vec<&str> {
    let (mut out, mut depth, mut start) = (Vec::new(), 0, 0);
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' if depth == 0 => {
                out.push(first_name(&group[start..i]));
                start = i + 1;
            }
            '}' => {
                out.push(first_name(&group[start..i]));
                break;
            }
            _ => {}
        }
    }
    out.retain(|name| !name.is_empty());
    out
}

fn first_name(path: &str) -> &str {
    let path = path.trim_start();
    &path[..path.find(|c| !is_of_a_name(c)).unwrap_or(path.len())]
}

fn is_of_a_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
