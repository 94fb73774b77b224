//! A folder to run the command in, and what became of it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use nephroid::film::{AovFilm, Film};
use nephroid_formats::film_file::{Covered, read_film};
use serde_json::Value;
use tempfile::TempDir;

/// A scene with a light, which a file can be made of.
pub const SCENE: &str = r#"<scene version="3.0.0">
    <integrator type="photonmapper"><integer name="photons" value="300"/></integrator>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/></film>
    </sensor>
    <shape type="sphere"><bsdf type="diffuse"/></shape>
    <shape type="sphere" id="room"><float name="radius" value="9"/><boolean name="flip_normals" value="true"/></shape>
    <emitter type="point"><point name="position" value="2, 2, 4"/><rgb name="intensity" value="5"/></emitter>
</scene>
"#;

/// Flags that make any scene cheap.
pub const CHEAP: &[&str] = &[
    "--resolution",
    "8x8",
    "--spp",
    "1",
    "--photons",
    "200",
    "--caustic-photons",
    "200",
    "--volume-photons",
    "200",
    "--emit-max",
    "20",
];

/// A film file without what may differ between renders that are the same: its job.
pub type Sums = (Film, Option<AovFilm>, Covered, Vec<(String, String)>);

/// A temporary folder.
pub struct Dir(TempDir);

/// A finished command.
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Dir {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with [`SCENE`] as `a.xml`, changed by replacing one text with another.
    pub fn with_scene(from: &str, to: &str) -> Self {
        assert!(SCENE.contains(from), "{from}");
        let dir = Self::new();
        std::fs::write(dir.path("a.xml"), SCENE.replace(from, to)).unwrap();
        dir
    }

    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The sums in a film file.
    #[track_caller]
    pub fn sums(&self, name: &str) -> Sums {
        let file = read_film(&self.path(name)).unwrap();
        (file.film, file.aovs, file.header.covered, file.header.identity)
    }

    /// Whether two renders gave the same picture and the same sums: NAME.exr and NAME.film.
    #[track_caller]
    pub fn are_the_same(&self, one: &str, other: &str) {
        assert!(
            self.read(&format!("{one}.exr")) == self.read(&format!("{other}.exr")),
            "{one} and {other}.exr"
        );
        let sums = |name: &str| self.sums(&format!("{name}.film"));
        assert!(sums(one) == sums(other), "{one} and {other}.film");
    }

    /// The names in the folder, sorted, less the scene's.
    pub fn files(&self) -> Vec<String> {
        let names = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| name != "a.xml");
        names.sort();
        names
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nephroid"));
        command.args(args).current_dir(self.0.path()).env_remove("RAYON_NUM_THREADS");
        command
    }

    /// Waits until a file is there, for a minute at most.
    #[track_caller]
    pub fn wait_for(&self, name: &str) {
        let begun = std::time::Instant::now();
        while !self.path(name).exists() {
            assert!(begun.elapsed().as_secs() < 60, "{name} does not come");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }

    pub fn run(&self, args: &[&str]) -> Run {
        Run::of(self.command(args).output().unwrap())
    }

    /// Runs `render SCENE`, cheaply.
    pub fn render(&self, scene: &str, args: &[&str]) -> Run {
        self.run(&[&["render", scene], CHEAP, args].concat())
    }
}

impl Run {
    pub fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    #[track_caller]
    pub fn ends_with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.stdout, self.stderr);
        self
    }

    #[track_caller]
    pub fn says(self, text: &str) -> Self {
        assert!(self.stderr.contains(text), "{text:?} is not in {}", self.stderr);
        self
    }

    #[track_caller]
    pub fn does_not_say(self, text: &str) -> Self {
        assert!(!self.stderr.contains(text), "{text:?} is in {}", self.stderr);
        self
    }

    /// The one object that the standard output is.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {}{}", self.stdout, self.stderr))
    }
}
