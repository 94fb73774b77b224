//! Another camera and another sky than those of a scene: `--camera` and `--envmap`.

use std::path::{Path, PathBuf};

use clap::Args;
use nephroid::camera::{Camera, Projection};
use nephroid::math::{DVec3, Transform};
use nephroid_formats::SceneFile;
use nephroid_formats::fit;
use nephroid_formats::image::read_texture;
use nephroid_formats::vfs::Files;

use crate::exit::Failure;

/// The opening angle where neither the flag nor the scene says it.
const FOV_DEG: f32 = 45.0;

/// What of a scene is replaced.
#[derive(Args, Clone, Debug, Default)]
pub struct ViewArgs {
    /// Look from EYE to TARGET, with UP above [default: 0,1,0] and so many degrees along the shorter side [default: as the
    /// scene's camera has it, else 45]; each three numbers, as in "0,1,5;0,0,0"
    #[arg(long, value_name = "EYE;TARGET[;UP[;FOV]]", value_parser = Viewpoint::parse, allow_hyphen_values = true)]
    pub camera: Option<Viewpoint>,
    /// Light the scene by this image all around it (OpenEXR, Radiance HDR, PNG or JPEG by longitude and latitude) in place
    /// of its sky, or by none
    #[arg(long, value_name = "FILE|none")]
    pub envmap: Option<PathBuf>,
}

/// Where a picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    to_world: Transform,
    fov_deg: Option<f32>,
}

impl Viewpoint {
    /// Reads the value of the flag.
    fn parse(text: &str) -> Result<Self, String> {
        const USAGE: &str = "write EYE;TARGET, EYE;TARGET;UP or EYE;TARGET;UP;FOV, as in \"0,1,5;0,0,0\"";
        let parts: Vec<&str> = text.split(';').map(str::trim).collect();
        let (&eye, &target) = parts.first().zip(parts.get(1)).ok_or(USAGE)?;
        if parts.len() > 4 {
            return Err(USAGE.to_owned());
        }
        let up = parts.get(2).filter(|up| !up.is_empty()).map_or(Ok(DVec3::Y), |up| vector(up))?;
        let fov_deg = match parts.get(3) {
            None => None,
            Some(fov) => {
                let fov = fov.parse().ok().filter(|fov| *fov > 0.0 && *fov < 180.0);
                Some(fov.ok_or("the field of view must be between 0 and 180 degrees")?)
            }
        };
        let to_world = Transform::look_at(vector(eye)?, vector(target)?, up)
            .filter(Transform::is_invertible)
            .ok_or("EYE and TARGET must differ, and UP must not point from one to the other")?;
        Ok(Self { to_world, fov_deg })
    }

    fn camera(self, instead_of: &Camera) -> Camera {
        let projection = match (self.fov_deg, instead_of.projection) {
            (Some(fov_deg), _) => fit::perspective(fov_deg),
            (None, Projection::Orthographic) => fit::perspective(FOV_DEG),
            (None, known) => known,
        };
        Camera { to_world: self.to_world, projection, medium: None }
    }
}

fn vector(text: &str) -> Result<DVec3, String> {
    let mut numbers =
        text.split(',').map(|number| number.trim().parse().ok().filter(|v: &f64| v.is_finite()));
    match (numbers.next(), numbers.next(), numbers.next(), numbers.next()) {
        (Some(Some(x)), Some(Some(y)), Some(Some(z)), None) => Ok(DVec3::new(x, y, z)),
        _ => Err(format!("\"{text}\" is not three numbers, as in 0,1.5,-2")),
    }
}

impl ViewArgs {
    /// Puts them into a scene.
    pub fn apply(&self, file: &mut SceneFile, files: &dyn Files) -> Result<(), Failure> {
        if let Some(viewpoint) = self.camera {
            file.scene.camera = viewpoint.camera(&file.scene.camera);
            file.fitted.camera = false;
        }
        if let Some(path) = &self.envmap {
            let image = match path.to_str() {
                Some("none") => None,
                _ => Some(environment(path, files)?),
            };
            fit::replace_sky(&mut file.scene, &mut file.origins, image);
            file.fitted.sky = false;
        }
        Ok(())
    }

    /// What changes pixels, by name, but for the contents of files.
    pub fn identity(&self) -> impl Iterator<Item = (&'static str, String)> {
        let camera = self.camera.map(|viewpoint| {
            let numbers = viewpoint.to_world.0.to_cols_array();
            let fov = viewpoint.fov_deg.map(|fov| format!(", {fov} degrees")).unwrap_or_default();
            ("--camera", format!("{numbers:?}{fov}"))
        });
        let sky = self.envmap.as_ref().map(|path| {
            let is_none = path.to_str() == Some("none");
            ("--envmap", if is_none { "none" } else { "given" }.to_owned())
        });
        camera.into_iter().chain(sky)
    }
}

fn environment(path: &Path, files: &dyn Files) -> Result<nephroid::texture::Pixmap, Failure> {
    let name = path.display();
    let bytes =
        files.read(path).map_err(|error| Failure::File(format!("{name}: cannot be read: {error}")))?;
    let file = read_texture(&bytes, false).map_err(|problem| Failure::File(format!("{name}: {problem}")))?;
    Ok(file.image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::math::Vec3;

    #[test]
    fn viewpoints_are_read() {
        let view = Viewpoint::parse("0,1,5; 0,1,0").expect("it is one");
        assert_eq!(view.to_world.point(Vec3::ZERO), Vec3::new(0.0, 1.0, 5.0));
        assert_eq!(view.to_world.vector(Vec3::Z), -Vec3::Z);
        assert_eq!(view.fov_deg, None);
        let view = Viewpoint::parse("1,0,0;0,0,0;0,0,1;30").expect("it is one");
        assert_eq!((view.to_world.vector(Vec3::Y), view.fov_deg), (Vec3::Z, Some(30.0)));
        let view = Viewpoint::parse("1,0,0;0,0,0;;30").expect("it is one");
        assert_eq!(view.to_world.vector(Vec3::Y), Vec3::Y);
    }

    #[test]
    fn bad_viewpoints_are_told() {
        let bad = [
            "",
            "0,0,1",
            "0,0,1;0,0,1",
            "0,0;0,0,1",
            "0,1,0;0,0,0",
            "a,0,1;0,0,0",
            "0,0,1;0,0,0;0,1,0;180",
            "1;2;3;4;5",
        ];
        for text in bad {
            assert!(Viewpoint::parse(text).is_err(), "{text}");
        }
    }
}
