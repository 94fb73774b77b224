//! Scenes in any of the formats that are read.

use std::path::Path;

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::math::Bounds;
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Shape};

use crate::diagnostic::{Diagnostic, Diagnostics, Location, Source};
use crate::fit::{self, Fitted};
use crate::integrator_request::IntegratorRequest;
use crate::mesh::{MeshError, MeshFile, MeshOptions, read_obj, read_ply};
use crate::scene_file::{Options, Origins, SceneFile};
use crate::vfs::Files;
use crate::{gltf, mitsuba, pbrt};

/// What a file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Mitsuba,
    Pbrt,
    Gltf,
    Obj,
    Ply,
}

impl Format {
    /// By the end of its name, else by how it starts. What looks like nothing is told about as Mitsuba's, the format of
    /// most.
    fn of(path: &Path, files: &dyn Files) -> Self {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("xml") => Self::Mitsuba,
            Some("pbrt") => Self::Pbrt,
            Some("gz") if path.with_extension("").extension().is_some_and(|e| e == "pbrt") => Self::Pbrt,
            Some("gltf" | "glb") => Self::Gltf,
            Some("obj") => Self::Obj,
            Some("ply") => Self::Ply,
            _ => files.read(path).map_or(Self::Mitsuba, |bytes| Self::of_bytes(&bytes)),
        }
    }

    fn of_bytes(bytes: &[u8]) -> Self {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        if bytes.starts_with(b"glTF") || text.starts_with(b"{") {
            Self::Gltf
        } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            Self::Ply
        } else {
            Self::Mitsuba
        }
    }
}

/// Reads a scene and all files it refers to: Mitsuba's XML, pbrt-v4, glTF, or a mesh alone (OBJ, PLY), which is grey and gets a
/// camera and a sky.
///
/// # Errors
///
/// All that is wrong with the scene, and the warnings with it.
pub fn read_scene(path: &Path, files: &dyn Files, options: &Options) -> Result<SceneFile, Diagnostics> {
    match Format::of(path, files) {
        Format::Mitsuba => mitsuba::read_scene(path, files, options),
        Format::Pbrt => pbrt::read_scene(path, files, options),
        Format::Gltf => gltf::read_scene(path, files, options),
        Format::Obj => model(path, files, read_obj, true),
        Format::Ply => model(path, files, read_ply, false),
    }
}

/// A mesh alone. `flips` is whether its texture coordinates count from below.
fn model(
    path: &Path,
    files: &dyn Files,
    read: impl Fn(&[u8], MeshOptions) -> Result<MeshFile, MeshError>,
    flips: bool,
) -> Result<SceneFile, Diagnostics> {
    let name = path.display();
    let fails = |message: String| Diagnostics(vec![Diagnostic::global_error(message)]);
    let bytes = files.read(path).map_err(|error| fails(format!("cannot read \"{name}\": {error}")))?;
    let options = MeshOptions { face_normals: false, flip_tex_coords: flips };
    let MeshFile { mesh, degenerate, .. } = read(&bytes, options).map_err(|error| {
        let line = error.line.map(|line| format!(":{line}")).unwrap_or_default();
        fails(format!("{name}{line}: {}", error.message))
    })?;
    // Nothing of the text is quoted: a mesh is no reading matter.
    let at = Location::new(&Source::new(name.to_string(), ""), 0..0);
    let mut warnings = Vec::new();
    if degenerate > 0 {
        let faces = if degenerate == 1 { "triangle" } else { "triangles" };
        warnings.push(Diagnostic::warning(&at, format!("left out {degenerate} {faces} without area")));
    }
    let bounds = Bounds::of(mesh.positions.iter().copied());
    let camera = fit::camera(&bounds).ok_or_else(|| fails(format!("{name}: it is too large to be seen")))?;
    let mut scene = Scene::new(camera, fit::film());
    let mesh = scene.meshes.push(mesh);
    let material = grey(&mut scene);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    scene.shapes.push(Shape::new(stem, Geometry::Mesh(mesh), material));
    let mut origins = Origins::at(at.clone());
    origins.shapes.push(at.clone());
    origins.textures.push(at.clone());
    origins.materials.extend([at.clone(), at]);
    let integrator = IntegratorRequest::default();
    let fitted = Fitted { camera: true, sky: false };
    let mut file = SceneFile { scene, integrator, sample_count: None, warnings, origins, fitted };
    file.fit(Fitted { camera: false, sky: true });
    Ok(file)
}

/// Diffuse grey on both sides, for triangles of meshes often face the wrong way.
fn grey(scene: &mut Scene) -> Handle<Material> {
    let reflectance = scene.textures.constant(Rgb::splat(0.5));
    let side = scene.materials.push(Material::Diffuse { reflectance });
    scene.materials.push(Material::TwoSided { front: side, back: side })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vfs::MemoryFiles;
    use nephroid::world::World;

    #[test]
    fn formats_are_told_by_name_and_contents() {
        let files = MemoryFiles::default()
            .with("a", "<scene/>")
            .with("b", " {}")
            .with("c", "glTF\u{2}")
            .with("d.txt", "ply\nformat ascii 1.0\n");
        let of = |name: &str| Format::of(Path::new(name), &files);
        let named = [("x.XML", Format::Mitsuba), ("x.gltf", Format::Gltf), ("x.GLB", Format::Gltf)];
        for (name, format) in named.into_iter().chain([("x.obj", Format::Obj), ("x.ply", Format::Ply)]) {
            assert_eq!(of(name), format, "{name}");
        }
        assert_eq!(
            ["a", "b", "c", "d.txt"].map(of),
            [Format::Mitsuba, Format::Gltf, Format::Gltf, Format::Ply]
        );
        assert_eq!(of("not there"), Format::Mitsuba);
    }

    #[test]
    fn a_mesh_alone_can_be_rendered() {
        let files = MemoryFiles::default()
            .with("m/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n")
            .with("bad.obj", "v 0 0 0\nf 1 2 3\n");
        let read = |name: &str| read_scene(Path::new(name), &files, &Options::default());
        let file = read("m/a.obj").expect("it can be read");
        assert_eq!(file.fitted, Fitted { camera: true, sky: true });
        assert_eq!(file.warnings.len(), 1, "{:?}", file.warnings);
        World::new(file.scene).expect("it can be rendered");
        let error = read("bad.obj").expect_err("a vertex is missing").to_string();
        assert!(error.contains("bad.obj:2:"), "{error}");
        assert!(read("gone.ply").expect_err("there is no file").to_string().contains("gone.ply"));
    }
}
