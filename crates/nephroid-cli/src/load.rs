//! From the name of a scene to a world that can be rendered.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;

use nephroid::scene::{Remark, Scene, SceneError, Subject};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_formats::diagnostic::{Diagnostic, Diagnostics, Location};
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::scene::read_scene;
use nephroid_formats::vfs::{DiskFiles, Files};
use nephroid_formats::{Options, Origins, SandboxFiles, SceneFile};

use crate::args::SceneArgs;
use crate::builtin::{self, BuiltinFiles, BuiltinScene};
use crate::exit::Failure;
use crate::identity::{Identity, RecordingFiles, fingerprint};
use crate::loading::{Loading, ToldFiles};
use crate::scenes;

/// What the pictures of a scene are called: the name of its file without the suffix.
pub fn name(scene: &Path) -> OsString {
    match builtin_of(scene) {
        Some(builtin) => builtin.name.into(),
        None => scene.file_stem().unwrap_or(scene.as_os_str()).to_owned(),
    }
}

/// The built-in scene of that name, unless there is such a file.
fn builtin_of(scene: &Path) -> Option<&'static BuiltinScene> {
    scene.to_str().and_then(builtin::find).filter(|_| !scene.is_file())
}

/// Whether a scene of that name is a file, and not a built-in one.
pub fn is_file(scene: &Path) -> bool {
    builtin_of(scene).is_none() && scene.is_file()
}

/// Reads the file of that name, or the built-in scene where there is no such file. What is being read is shown if it is
/// `visible`.
pub fn load(scene: &Path, args: &SceneArgs, visible: bool) -> Result<SceneFile, Failure> {
    load_recorded(scene, args, visible).map(|(file, _)| file)
}

/// Reads it, and tells the fingerprints of its text and of every file it reads.
pub fn load_recorded(
    scene: &Path,
    args: &SceneArgs,
    visible: bool,
) -> Result<(SceneFile, Identity), Failure> {
    let options = Options { defines: args.defines.clone(), lenient: args.lenient };
    let builtin = builtin_of(scene);
    let sandbox = match &args.sandbox {
        // A built-in scene stands where it is rendered.
        Some(folder) => Some(sandbox(match folder {
            Some(folder) => folder,
            None if builtin.is_some() => Path::new("."),
            None => scene.parent().unwrap_or(Path::new(".")),
        })?),
        None => None,
    };
    let disk: &dyn Files = match &sandbox {
        Some(sandbox) => sandbox,
        None => &DiskFiles,
    };
    let loading = Loading::new(visible);
    let told = ToldFiles::new(disk, &loading);
    let disk: &dyn Files = &told;
    if let Some(builtin) = builtin {
        let files = BuiltinFiles { scene: builtin, disk };
        let files = RecordingFiles::new(&files);
        let name = format!("{}.xml", builtin.name);
        let mut file = read_scene_str(&name, builtin.text, &files, &options).map_err(Failure::Scene)?;
        view(&mut file, args, &files)?;
        let mut identity = vec![("scene".to_owned(), fingerprint(builtin.text.as_bytes()))];
        identity.extend(files.fingerprints(Path::new(&name)));
        return Ok((file, identity));
    }
    check_readable(scene)?;
    let files = RecordingFiles::new(disk);
    let mut file = read_scene(scene, &files, &options).map_err(Failure::Scene)?;
    view(&mut file, args, &files)?;
    Ok((file, files.fingerprints(scene)))
}

/// Puts in the camera and the sky that flags ask for, and tells of those that a model was given.
fn view(file: &mut SceneFile, args: &SceneArgs, files: &dyn Files) -> Result<(), Failure> {
    args.view.apply(file, files)?;
    let remark = file.fitted.remark(&file.scene, &file.origins.scene);
    file.warnings.extend(remark);
    Ok(())
}

fn sandbox(folder: &Path) -> Result<SandboxFiles, Failure> {
    SandboxFiles::new(folder).map_err(|error| {
        Failure::Usage(format!("--sandbox: the folder \"{}\" cannot be had: {error}", folder.display()))
    })
}

/// Tells a file that cannot be read, which is no fault of the scene.
fn check_readable(path: &Path) -> Result<(), Failure> {
    let name = path.display();
    // A pipe would have to be opened to be read, and opening one may take for ever.
    let opened = match std::fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => {
            return Err(Failure::File(format!("{name}: is not a file")));
        }
        Ok(_) => std::fs::File::open(path).map(drop),
        Err(error) => Err(error),
    };
    opened.map_err(|error| {
        let bare = path.components().count() == 1 && path.extension().is_none();
        Failure::File(match error.kind() {
            ErrorKind::NotFound if bare => {
                format!("{name}: no such file, and {}", scenes::unknown(&name.to_string()))
            }
            ErrorKind::NotFound => format!("{name}: no such file"),
            _ => format!("{name}: cannot be read: {error}"),
        })
    })
}

/// Prepares a scene for rendering, and shows how far it is if that is `visible`; its problems are told at their places in
/// the file.
pub fn world(scene: Scene, origins: &Origins, visible: bool) -> Result<World, Failure> {
    // Meshes have no places of their own, but those of their shapes.
    let mesh_of_shape: Vec<Option<usize>> = scene
        .shapes
        .iter()
        .chain(scene.groups.iter().flat_map(|group| &group.shapes))
        .map(|shape| match shape.geometry {
            Geometry::Mesh(mesh) => Some(mesh.index()),
            _ => None,
        })
        .collect();
    World::observed(scene, &Loading::new(visible)).map_err(|errors| {
        let diagnostic = |error: &SceneError| match origin(error.subject, origins, &mesh_of_shape) {
            Some(at) => Diagnostic::error(at, error.message.clone()),
            None => Diagnostic::error(&origins.scene, error.to_string()),
        };
        Failure::Scene(Diagnostics(errors.0.iter().map(diagnostic).collect()))
    })
}

/// What of a scene may not be meant so, at its place in the file.
pub fn remarks(world: &World, origins: &Origins) -> Vec<Diagnostic> {
    let told = |remark: &Remark| {
        let at = origin(remark.subject, origins, &[]).unwrap_or(&origins.scene);
        Diagnostic::warning(at, remark.message.clone())
    };
    world.remarks().iter().map(told).collect()
}

/// Where a part of a scene stands.
fn origin<'o>(subject: Subject, origins: &'o Origins, meshes: &[Option<usize>]) -> Option<&'o Location> {
    match subject {
        Subject::Camera | Subject::Film => Some(&origins.camera),
        Subject::Material(i) => origins.materials.get(i),
        Subject::Shape(i) => origins.shapes.get(i),
        Subject::Group(i) => origins.groups.get(i),
        Subject::Instance(i) => origins.instances.get(i),
        Subject::Light(i) => origins.lights.get(i),
        Subject::Mesh(i) => {
            meshes.iter().position(|mesh| *mesh == Some(i)).and_then(|shape| origins.shapes.get(shape))
        }
        Subject::Texture(i) => origins.textures.get(i),
        Subject::Image(i) => origins.images.get(i),
        Subject::Medium(i) => origins.media.get(i),
        Subject::Grid(i) => origins.grids.get(i),
    }
}
