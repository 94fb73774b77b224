//! What lights must satisfy to be rendered.

use super::check::{Problems, check_emission, check_light_value, check_transform, finite, is_negative};
use super::{Scene, Subject};
use crate::handle::Handle;
use crate::light::{EnvironmentMapping, LightKind};
use crate::math::Transform;
use crate::texture::Pixmap;

pub(super) fn check_lights(scene: &Scene, problems: &mut Problems) {
    for (i, light) in scene.lights.iter().enumerate() {
        let subject = Subject::Light(i);
        match &light.kind {
            LightKind::Point { position, intensity } => {
                finite(position.is_finite(), "position", subject, problems);
                check_light_value(*intensity, "intensity", subject, problems);
            }
            LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture } => {
                check_place(to_world, subject, problems);
                check_light_value(*intensity, "intensity", subject, problems);
                if !(*cutoff_deg > 0.0 && *cutoff_deg < 90.0) {
                    problems.add(
                        subject,
                        format!("a cutoff angle of {cutoff_deg}: write one between 0 and 90 degrees"),
                    );
                }
                if !(*beam_width_deg >= 0.0 && beam_width_deg <= cutoff_deg) {
                    problems.add(subject, "the beam width must lie between 0 and the cutoff angle");
                }
                if let Some(texture) = texture {
                    check_emission(scene, *texture, subject, problems);
                }
            }
            LightKind::Directional { direction, irradiance } => {
                if direction.try_normalize().is_none() {
                    problems.add(subject, "its direction must have a length");
                }
                check_light_value(*irradiance, "irradiance", subject, problems);
            }
            LightKind::Constant { radiance } => check_light_value(*radiance, "radiance", subject, problems),
            LightKind::Environment { image, mapping, scale, to_world } => {
                check_place(to_world, subject, problems);
                check_image(scene, *image, Some(*mapping), subject, problems);
                if !(*scale >= 0.0 && scale.is_finite()) {
                    problems.add(subject, format!("a scale of {scale}: write a number that is not negative"));
                }
            }
            LightKind::Sun { direction, irradiance, angular_radius_deg } => {
                if direction.try_normalize().is_none() {
                    problems.add(subject, "its direction must have a length");
                }
                check_light_value(*irradiance, "irradiance", subject, problems);
                if !(*angular_radius_deg >= 0.0 && *angular_radius_deg < 90.0) {
                    problems.add(
                        subject,
                        format!(
                            "an angular radius of {angular_radius_deg}: write one from 0 to below 90 degrees"
                        ),
                    );
                }
            }
            LightKind::Goniometric { to_world, intensity, table, mapping } => {
                check_place(to_world, subject, problems);
                check_light_value(*intensity, "intensity", subject, problems);
                check_image(scene, *table, Some(*mapping), subject, problems);
            }
            LightKind::Projector { to_world, image, scale, unit: _, fov_deg, fov_axis: _ } => {
                check_place(to_world, subject, problems);
                check_light_value(*scale, "scale", subject, problems);
                check_image(scene, *image, None, subject, problems);
                if !(*fov_deg > 0.0 && *fov_deg < 180.0) {
                    problems.add(
                        subject,
                        format!("a field of view of {fov_deg} degrees: write one between 0 and 180"),
                    );
                }
            }
        }
    }
}

/// Of a light that has a place or a turn: its frame is to stay one.
fn check_place(to_world: &Transform, subject: Subject, problems: &mut Problems) {
    check_transform(to_world, subject, problems);
    if to_world.is_invertible() && to_world.uniform_scale().is_none() {
        problems.add(
            subject,
            "its `to_world` may turn, mirror and scale alike on each axis, but not stretch or shear",
        );
    }
}

fn check_image(
    scene: &Scene,
    image: Handle<Pixmap>,
    mapping: Option<EnvironmentMapping>,
    subject: Subject,
    problems: &mut Problems,
) {
    if !scene.textures.images.contains(image) {
        problems.add(subject, "its image does not exist");
        return;
    }
    let image = &scene.textures.images[image];
    if is_negative(image) {
        problems.add(subject, "a pixel of its image is negative: light cannot be");
    }
    if mapping == Some(EnvironmentMapping::EqualArea) && image.width != image.height {
        let message = format!(
            "its image of {} by {} pixels is no square, as the equal-area mapping has it",
            image.width, image.height
        );
        problems.add(subject, message);
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::check;
    use super::*;
    use crate::camera::{Camera, FovAxis, Projection};
    use crate::color::Rgb;
    use crate::film::{FilmSettings, Filter};
    use crate::light::{Light, ProjectorUnit};
    use crate::math::Vec3;
    use crate::texture::Image;

    #[test]
    fn lights_that_make_no_sense_are_refused() {
        let camera =
            Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None };
        let film = FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box };
        let mut scene = Scene::new(camera, film);
        let image = scene.textures.images.push(Image::filled(2, 1, Rgb::WHITE).into());
        let to_world = Transform::IDENTITY;
        let kinds = [
            LightKind::Environment { image, mapping: EnvironmentMapping::EqualArea, scale: 1.0, to_world },
            LightKind::Sun { direction: Vec3::ZERO, irradiance: Rgb::WHITE, angular_radius_deg: 90.0 },
            LightKind::Goniometric {
                to_world,
                intensity: Rgb::splat(-1.0),
                table: image,
                mapping: EnvironmentMapping::Equirectangular,
            },
            LightKind::Projector {
                to_world,
                image,
                scale: Rgb::WHITE,
                unit: ProjectorUnit::Irradiance,
                fov_deg: 180.0,
                fov_axis: FovAxis::X,
            },
        ];
        scene.lights.extend(kinds.map(|kind| Light { name: String::new(), kind, medium: None }));
        let found: Vec<String> = check(&scene).iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "light 0: its image of 2 by 1 pixels is no square, as the equal-area mapping has it",
                "light 1: its direction must have a length",
                "light 1: an angular radius of 90: write one from 0 to below 90 degrees",
                "light 2: a intensity of (-1, -1, -1): every channel must be finite and not negative",
                "light 3: a field of view of 180 degrees: write one between 0 and 180",
            ]
        );
    }
}
