//! What a film file says of the render it is part of, so that `nephroid resume` needs nothing else.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use nephroid::film::Aov;
use nephroid::session::RenderPlan;
use serde_json::{Value, json};

use crate::args::{self, RenderArgs};
use crate::denoise::GUIDES;
use crate::exit::Failure;
use crate::layers::LayerPlan;
use crate::load;
use crate::plan::Plan;
use crate::plan_json;

/// A render as it was asked for, and what was decided since.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The folder it was begun in, which names of files are relative to.
    pub folder: PathBuf,
    /// The arguments of the command, from `render` on.
    pub arguments: Vec<String>,
    /// The scene's file, from the root; none for a built-in scene.
    pub scene: Option<PathBuf>,
    /// What is to be written at its end.
    pub outputs: Vec<PathBuf>,
    /// What it decided before its first pass.
    pub plan: RenderPlan,
    /// How much is to be rendered.
    pub limits: Plan,
    /// The layers of the picture.
    pub layers: Vec<LayerPlan>,
    /// Seconds it rendered so far.
    pub spent: f64,
}

/// A job before the render decided anything.
#[derive(Clone, Debug)]
pub struct Order {
    /// See [`Job::folder`].
    pub folder: PathBuf,
    /// See [`Job::arguments`].
    pub arguments: Vec<String>,
    /// See [`Job::scene`].
    pub scene: Option<PathBuf>,
    /// See [`Job::outputs`].
    pub outputs: Vec<PathBuf>,
}

impl Order {
    /// What this process was told, for a film file to keep.
    pub fn of_this_process(scene: &Path, outputs: &[PathBuf]) -> Result<Self, Failure> {
        let mut given: Vec<OsString> = std::env::args_os().skip(1).collect();
        if given.is_empty() {
            given.push("render".into());
        }
        let text =
            |argument: OsString| argument.into_string().map_err(|argument| not_text(argument.as_ref()));
        let arguments = given.into_iter().map(text).collect::<Result<_, _>>()?;
        let folder = std::env::current_dir()
            .map_err(|e| Failure::File(format!("the current folder cannot be found: {e}")))?;
        let scene = load::is_file(scene).then(|| folder.join(scene));
        let names = [&folder].into_iter().chain(&scene).chain(outputs);
        check_names(names.map(PathBuf::as_path))?;
        Ok(Self { folder, arguments, scene, outputs: outputs.to_vec() })
    }

    /// The job that it has become.
    pub fn job(self, plan: RenderPlan, limits: Plan, layers: &[LayerPlan], spent: f64) -> Job {
        let Self { folder, arguments, scene, outputs } = self;
        Job { folder, arguments, scene, outputs, plan, limits, layers: layers.to_vec(), spent }
    }
}

/// Film files keep names as text, which not all are.
pub fn check_names<'a>(names: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    names.into_iter().find(|name| name.to_str().is_none()).map_or(Ok(()), |name| Err(not_text(name)))
}

fn not_text(name: &Path) -> Failure {
    let name = name.display();
    Failure::Usage(format!("{name}: a film file keeps names in UTF-8 only, and this is none"))
}

impl Job {
    /// One object.
    pub fn to_json(&self) -> Value {
        let layer = |layer: &LayerPlan| json!({ "name": layer.name, "value": layer.aov.name() });
        json!({
            "folder": self.folder.to_str(),
            "arguments": self.arguments,
            "scene": self.scene.as_ref().and_then(|path| path.to_str()),
            "outputs": self.outputs.iter().map(|path| path.to_str()).collect::<Vec<_>>(),
            "limits": self.limits.to_json(),
            "layers": self.layers.iter().map(layer).collect::<Vec<_>>(),
            "seconds": self.spent,
            "plan": plan_json::to_json(&self.plan),
        })
    }

    /// The job of an object; none if it is not one.
    pub fn from_json(value: &Value) -> Option<Self> {
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let layer = |value: &Value| {
            let aov = Aov::parse(value["value"].as_str()?)?;
            Some(LayerPlan { name: text(&value["name"])?, aov, channels: aov.channels() })
        };
        Some(Self {
            folder: text(&value["folder"])?.into(),
            arguments: value["arguments"].as_array()?.iter().map(text).collect::<Option<_>>()?,
            scene: match &value["scene"] {
                Value::Null => None,
                path => Some(text(path)?.into()),
            },
            outputs: {
                let path = |value| text(value).map(PathBuf::from);
                value["outputs"].as_array()?.iter().map(path).collect::<Option<_>>()?
            },
            plan: plan_json::from_json(&value["plan"])?,
            limits: Plan::from_json(&value["limits"])?,
            layers: value["layers"].as_array()?.iter().map(layer).collect::<Option<_>>()?,
            spent: value["seconds"].as_f64().filter(|s| s.is_finite() && *s >= 0.0)?,
        })
    }

    /// The job in the folder that its film file lies in, if its own is gone: it has been moved with all that is in it.
    pub fn where_it_is(mut self, film: &Path) -> Result<Self, Failure> {
        let beside = std::path::absolute(film).ok().and_then(|film| film.parent().map(Path::to_owned));
        if let (false, Some(beside)) = (self.folder.is_dir(), beside) {
            check_names([beside.as_path()])?;
            let scene = self.scene.as_ref().and_then(|scene| scene.strip_prefix(&self.folder).ok());
            self.scene = scene.map(|scene| beside.join(scene)).or(self.scene);
            self.folder = beside;
        }
        Ok(self)
    }

    /// The flags of the render, with its scene as it is named from here.
    pub fn args(&self) -> Result<RenderArgs, String> {
        let mut args = args::of_render(&self.arguments)?;
        let from_here = |path: &Path| self.named_from_here(path);
        args.scene = match (&self.scene, args.scene) {
            // Where the folder has been moved or is known by another name, it is beside us as it was then.
            (Some(absolute), Some(given)) => Some(if load::is_file(&from_here(&given)) {
                from_here(&given)
            } else if absolute.is_file() {
                absolute.clone()
            } else {
                given
            }),
            (_, given) => given,
        };
        if args.reading.view.envmap.as_deref() != Some(Path::new("none")) {
            args.reading.view.envmap = args.reading.view.envmap.map(|image| from_here(&image));
        }
        args.reading.sandbox = args.reading.sandbox.map(|folder| folder.map(|folder| from_here(&folder)));
        args.denoise.oidn_library = args.denoise.oidn_library.map(|library| from_here(&library));
        args.watch = Default::default();
        Ok(args)
    }

    /// What a name in its folder is from here.
    pub fn named_from_here(&self, path: &Path) -> PathBuf {
        let here = std::env::current_dir().is_ok_and(|here| here == self.folder);
        if here { path.to_owned() } else { self.folder.join(path) }
    }

    /// Whether its films keep what pictures are denoised with.
    pub fn keeps_guides(&self) -> bool {
        GUIDES.iter().all(|aov| self.layers.iter().any(|layer| layer.aov == *aov))
    }

    /// What this process would be told for the same render.
    pub fn order(&self) -> Order {
        let Self { folder, arguments, scene, outputs, .. } = self.clone();
        Order { folder, arguments, scene, outputs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session_args::PassRange;

    fn job() -> Job {
        let layer = |name: &str, aov: Aov| LayerPlan { name: name.into(), aov, channels: aov.channels() };
        Job {
            folder: "/home/a".into(),
            arguments: ["render", "a.xml", "-D", "x=1 2", "-o", "b.exr"].map(str::to_owned).to_vec(),
            scene: Some("/home/a/a.xml".into()),
            outputs: vec!["b.exr".into()],
            plan: RenderPlan::default(),
            limits: Plan {
                samples_per_pass: 4,
                samples: None,
                passes: Some(9),
                seconds: Some(1.5),
                target_error: Some(0.05),
                range: Some(PassRange { begin: 2, end: 5 }),
            },
            layers: vec![layer("depth", Aov::Depth), layer("my albedo", Aov::Albedo)],
            spent: 0.25,
        }
    }

    #[test]
    fn a_job_survives_the_way_through_text() {
        let mut job = job();
        for _ in 0..2 {
            let text = job.to_json().to_string();
            assert_eq!(Job::from_json(&serde_json::from_str(&text).unwrap()), Some(job.clone()));
            (job.scene, job.limits.range, job.limits.seconds) = (None, None, None);
            job.limits.target_error = None;
        }
    }

    #[test]
    fn what_is_missing_is_no_job() {
        let whole = job().to_json();
        assert_eq!(Job::from_json(&Value::Null), None);
        for name in whole.as_object().unwrap().keys().filter(|name| *name != "scene") {
            let mut value = whole.clone();
            value[name] = Value::Null;
            assert_eq!(Job::from_json(&value), None, "{name}");
        }
    }

    #[test]
    fn a_folder_that_is_gone_is_where_the_film_is() {
        let moved = job().where_it_is(Path::new("/home/b/c.film")).unwrap();
        assert_eq!(
            (moved.folder.as_path(), moved.scene),
            (Path::new("/home/b"), Some("/home/b/a.xml".into()))
        );
        let here = Job { folder: std::env::current_dir().unwrap(), ..job() };
        assert_eq!(here.clone().where_it_is(Path::new("/home/b/c.film")).unwrap(), here);
    }

    #[cfg(unix)]
    #[test]
    fn names_that_are_no_text_are_refused() {
        use std::os::unix::ffi::OsStrExt;
        let odd = Path::new(std::ffi::OsStr::from_bytes(b"a\xff.xml"));
        assert!(check_names([Path::new("ä.xml")]).is_ok());
        assert!(check_names([Path::new("a.xml"), odd]).is_err());
    }

    #[test]
    fn its_flags_are_read_again() {
        let args = job().args().unwrap();
        assert_eq!(job().named_from_here(Path::new("b.exr")), Path::new("/home/a/b.exr"));
        assert_eq!(args.reading.defines, [("x".to_owned(), "1 2".to_owned())]);
        let mut within = job();
        within.arguments.push("--sandbox=c".to_owned());
        assert_eq!(within.args().unwrap().reading.sandbox, Some(Some("/home/a/c".into())));
        let mut wrong = job();
        wrong.arguments.push("--no-such-flag".to_owned());
        assert!(wrong.args().unwrap_err().contains("--no-such-flag"));
        wrong.arguments = vec!["scenes".to_owned()];
        assert!(wrong.args().is_err());
    }
}
