//! Cameras: from a point of the picture to a ray, and from a point of the world to the picture.

mod connection;

use std::f32::consts::FRAC_2_SQRT_PI;

use crate::film::FilmSettings;
use crate::handle::Handle;
use crate::math::real::tan;
use crate::math::{Ray, Transform, Vec2, Vec3, warp};
use crate::medium::Medium;

/// Where the picture is taken from. In camera space `+z` looks ahead, `+x` points to the left of
/// the picture and `+y` up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Camera space to world.
    pub to_world: Transform,
    /// How space is flattened.
    pub projection: Projection,
    /// What it stands in, if that is to be given rather than found.
    pub medium: Option<Handle<Medium>>,
}

/// How a camera flattens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Through a point.
    Perspective {
        /// Opening angle along `fov_axis`.
        fov_deg: f32,
        /// What the angle spans.
        fov_axis: FovAxis,
        /// Shift of the principal point, relative to the picture's width and height.
        principal_point_offset: Vec2,
    },
    /// Through a thin lens: what lies on the plane in focus is sharp, and a point elsewhere becomes a
    /// disk, evenly bright.
    ThinLens {
        /// Opening angle along `fov_axis`, from the middle of the lens.
        fov_deg: f32,
        /// What the angle spans.
        fov_axis: FovAxis,
        /// Shift of the principal point, relative to the picture's width and height.
        principal_point_offset: Vec2,
        /// Radius of the lens in camera space; 0 is a pinhole, as `Perspective`.
        aperture_radius: f32,
        /// Distance of the plane in focus in camera space, measured along the view.
        focus_distance: f32,
    },
    /// Along parallel rays; the picture's width spans [-1, 1] of camera space.
    Orthographic,
}

/// What a field of view is measured along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    #[default]
    X,
    /// The height.
    Y,
    /// The diagonal.
    Diagonal,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
}

impl FovAxis {
    /// Half the width and height of a picture of this shape at distance 1, where the angle spans this of it.
    pub(crate) fn half_size(self, fov_deg: f32, width: f32, height: f32) -> Vec2 {
        let (w, h) = (width, height);
        let tan = tan((0.5 * fov_deg).to_radians());
        let half_width = match self {
            Self::X => tan,
            Self::Y => tan * w / h,
            Self::Diagonal => tan * w / (w * w + h * h).sqrt(),
            Self::Smaller => tan * if w <= h { 1.0 } else { w / h },
            Self::Larger => tan * if w >= h { 1.0 } else { w / h },
        };
        Vec2::new(half_width, half_width * h / w)
    }
}

/// A camera made ready for a film: maps positions on the film to rays.
#[derive(Clone, Debug)]
pub(crate) struct CameraRays {
    to_world: Transform,
    projection: Projection,
    /// Whole picture in pixels.
    size: Vec2,
    /// Half-extent of the picture at distance 1 (perspective) or in camera space (orthographic).
    half: Vec2,
    offset: Vec2,
    from_world: Transform,
    /// See [`connection::density`].
    density: f64,
}

impl CameraRays {
    /// `camera` and `film` must have passed the checks of the world.
    pub fn new(camera: &Camera, film: &FilmSettings) -> Self {
        let (w, h) = (film.width as f32, film.height as f32);
        let (half, offset) = match camera.projection {
            Projection::Orthographic => (Vec2::new(1.0, h / w), Vec2::ZERO),
            Projection::Perspective { fov_deg, fov_axis, principal_point_offset }
            | Projection::ThinLens { fov_deg, fov_axis, principal_point_offset, .. } => {
                (fov_axis.half_size(fov_deg, w, h), principal_point_offset)
            }
        };
        let Camera { to_world, projection, .. } = *camera;
        let size = Vec2::new(w, h);
        let density = connection::density(&to_world, &projection, size, half);
        Self { to_world, projection, size, half, offset, from_world: to_world.inverse(), density }
    }

    /// The ray through a position of the whole picture, in pixels from its upper left corner. `u_lens`
    /// in [0, 1)² is its place on the lens, if there is one.
    pub fn ray(&self, film_position: Vec2, u_lens: Vec2) -> Ray {
        let p = film_position / self.size + self.offset;
        // Left and up are positive in camera space.
        let q = (Vec2::ONE - 2.0 * p) * self.half;
        let (origin, direction) = match self.projection {
            Projection::Perspective { .. } => (Vec3::ZERO, Vec3::new(q.x, q.y, 1.0)),
            Projection::ThinLens { aperture_radius, focus_distance, .. } => {
                let lens = aperture_radius * warp::square_to_disk(u_lens);
                // Towards the point in focus, at `focus_distance` times the pinhole's direction.
                (lens.extend(0.0), (q - lens / focus_distance).extend(1.0))
            }
            Projection::Orthographic => (Vec3::new(q.x, q.y, 0.0), Vec3::Z),
        };
        Ray::new(self.to_world.point(origin), self.to_world.vector(direction).normalize())
    }

    /// Where a point of the world appears: its position on the whole picture in pixels, which may lie
    /// outside, and the origin of the ray through it. `None` behind the camera.
    pub fn project(&self, point: Vec3) -> Option<(Vec2, Vec3)> {
        let local = self.from_world.point(point);
        let (q, origin) = match self.projection {
            // Through the middle of a lens.
            Projection::Perspective { .. } | Projection::ThinLens { .. } => {
                (Vec2::new(local.x, local.y) / local.z, Vec3::ZERO)
            }
            Projection::Orthographic => (Vec2::new(local.x, local.y), Vec3::new(local.x, local.y, 0.0)),
        };
        (local.z > 0.0).then(|| (self.film_position(q), self.to_world.point(origin)))
    }

    /// The place on the film, in pixels, of a place on the picture at distance 1 or, of parallel rays, in camera space.
    fn film_position(&self, q: Vec2) -> Vec2 {
        ((Vec2::ONE - q / self.half) * 0.5 - self.offset) * self.size
    }

    /// The radius of a disc as large as a pixel is that lies across the view at a distance along a ray. Mirrors and
    /// lenses on the way are taken for flat.
    pub fn pixel_radius(&self, distance: f32) -> f32 {
        let across = self.to_world.vector(Vec3::new(2.0 * self.half.x / self.size.x, 0.0, 0.0)).length();
        let side = match self.projection {
            Projection::Orthographic => across,
            Projection::Perspective { .. } | Projection::ThinLens { .. } => {
                distance * 2.0 * self.half.x / self.size.x
            }
        };
        side * 0.5 * FRAC_2_SQRT_PI
    }

    /// Where the camera stands.
    pub fn position(&self) -> Vec3 {
        self.to_world.point(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Filter;
    use crate::math::DVec3;
    use crate::sampling::{Key, Sampler, Sequence, Stream};

    /// A place on a lens that is not the middle: cameras without one must not care.
    const LENS: Vec2 = Vec2::new(0.1, 0.8);

    fn rays(projection: Projection, width: u32, height: u32) -> CameraRays {
        let to_world = Transform::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap();
        let film = FilmSettings { width, height, crop: None, filter: Filter::Box };
        CameraRays::new(&Camera { to_world, projection, medium: None }, &film)
    }

    fn perspective(fov_axis: FovAxis, offset: Vec2) -> Projection {
        Projection::Perspective { fov_deg: 90.0, fov_axis, principal_point_offset: offset }
    }

    #[test]
    fn the_axis_of_the_field_of_view_reaches_the_edge_at_its_angle() {
        for (axis, x, y) in [
            (FovAxis::X, 1.0, 0.5),
            (FovAxis::Larger, 1.0, 0.5),
            (FovAxis::Y, 2.0, 1.0),
            (FovAxis::Smaller, 2.0, 1.0),
            (FovAxis::Diagonal, 2.0 / 5.0f32.sqrt(), 1.0 / 5.0f32.sqrt()),
        ] {
            // The upper right corner: right is +x of the world, as the camera looks along −z.
            let d = rays(perspective(axis, Vec2::ZERO), 400, 200).ray(Vec2::new(400.0, 0.0), LENS).direction;
            let d = d / -d.z;
            assert!((d.x - x).abs() < 1e-5 && (d.y - y).abs() < 1e-5, "{axis:?}: {d}");
        }
    }

    #[test]
    fn the_middle_looks_ahead_and_the_principal_point_moves_it() {
        let centre = Vec2::new(200.0, 100.0);
        let ray = rays(perspective(FovAxis::X, Vec2::ZERO), 400, 200).ray(centre, LENS);
        assert_eq!((ray.origin, ray.direction), (Vec3::new(0.0, 0.0, 4.0), -Vec3::Z));
        let shifted = rays(perspective(FovAxis::X, Vec2::new(0.1, 0.0)), 400, 200);
        let direction = shifted.ray(centre - Vec2::new(40.0, 0.0), LENS).direction;
        assert!((direction + Vec3::Z).length() < 1e-6);
    }

    #[test]
    fn points_on_a_ray_are_projected_to_where_it_started() {
        let shifted = perspective(FovAxis::Y, Vec2::new(0.1, -0.2));
        for projection in [shifted, Projection::Orthographic] {
            let camera = rays(projection, 400, 200);
            for position in [Vec2::new(0.5, 0.5), Vec2::new(321.0, 77.0), Vec2::new(-20.0, 230.0)] {
                let ray = camera.ray(position, LENS);
                let (found, origin) = camera.project(ray.origin + ray.direction * 2.5).unwrap();
                assert!((found - position).length() < 1e-3, "{projection:?}: {found}, not {position}");
                assert!((origin - ray.origin).length() < 1e-5, "{projection:?}: {origin}");
                assert!(camera.project(ray.origin - ray.direction).is_none());
            }
        }
    }

    #[test]
    fn orthographic_rays_are_parallel_and_the_width_spans_two() {
        let camera = rays(Projection::Orthographic, 400, 200);
        let (a, b) = (camera.ray(Vec2::new(0.0, 0.0), LENS), camera.ray(Vec2::new(400.0, 200.0), LENS));
        assert_eq!((a.direction, b.direction), (-Vec3::Z, -Vec3::Z));
        assert_eq!((a.origin, b.origin), (Vec3::new(-1.0, 0.5, 4.0), Vec3::new(1.0, -0.5, 4.0)));
    }

    fn thin_lens(aperture_radius: f32, focus_distance: f32) -> Projection {
        Projection::ThinLens {
            fov_deg: 90.0,
            fov_axis: FovAxis::X,
            principal_point_offset: Vec2::ZERO,
            aperture_radius,
            focus_distance,
        }
    }

    fn numbers(i: u64) -> Sampler {
        Sampler::new(Sequence::Independent, Key::new(3, 0, Stream::Camera), i)
    }

    #[test]
    fn a_lens_of_no_size_is_a_pinhole_to_the_bit() {
        let (pinhole, lens) =
            (rays(perspective(FovAxis::X, Vec2::ZERO), 400, 200), rays(thin_lens(0.0, 3.0), 400, 200));
        for i in 0..1000 {
            let mut s = numbers(i);
            let position = s.next_2d() * Vec2::new(400.0, 200.0);
            assert_eq!(pinhole.ray(position, LENS), lens.ray(position, s.next_2d()));
        }
    }

    #[test]
    fn what_lies_in_focus_is_sharp_and_rays_start_on_the_lens() {
        let (pinhole, lens) =
            (rays(perspective(FovAxis::X, Vec2::ZERO), 400, 200), rays(thin_lens(0.25, 3.0), 400, 200));
        for i in 0..1000 {
            let mut s = numbers(i);
            let position = s.next_2d() * Vec2::new(400.0, 200.0);
            // The camera looks along −z from z = 4: the plane in focus is z = 1.
            let on_plane = |ray: Ray| ray.at((1.0 - ray.origin.z) / ray.direction.z);
            let ray = lens.ray(position, s.next_2d());
            let distance = (on_plane(ray) - on_plane(pinhole.ray(position, LENS))).length();
            assert!(distance < 1e-5, "{distance}");
            assert!(ray.origin.z == 4.0 && ray.origin.truncate().length() <= 0.25);
        }
    }

    /// At distance z the rays of one point of the film fill a disk of radius R |z − f| / f about the
    /// pinhole's, evenly: of a uniform disk r²/R² and the angle over 2π are uniform on [0, 1].
    #[test]
    fn out_of_focus_a_point_becomes_an_even_disk_of_the_circle_of_confusion() {
        let (radius, focus) = (0.25, 3.0);
        let (pinhole, lens) =
            (rays(perspective(FovAxis::X, Vec2::ZERO), 400, 200), rays(thin_lens(radius, focus), 400, 200));
        let position = Vec2::new(310.0, 40.0);
        for z in [0.5, 2.0, 5.0, 40.0] {
            let at = |ray: Ray| ray.at((4.0 - z - ray.origin.z) / ray.direction.z).truncate();
            let (centre, confusion) = (at(pinhole.ray(position, LENS)), radius * (z - focus).abs() / focus);
            const RINGS: usize = 8;
            let mut counts = [[0u32; RINGS]; RINGS];
            let n = 40_000;
            for i in 0..n {
                let p = (at(lens.ray(position, numbers(i).next_2d())) - centre) / confusion;
                let share = p.length_squared();
                assert!(share < 1.0 + 1e-3, "beyond the disk: {share} at distance {z}");
                let turn = crate::math::real::atan2(p.y, p.x) / std::f32::consts::TAU + 0.5;
                let cell = |x: f32| ((x * RINGS as f32) as usize).min(RINGS - 1);
                counts[cell(share)][cell(turn)] += 1;
            }
            let expected = n as f64 / (RINGS * RINGS) as f64;
            let chi_sq: f64 =
                counts.iter().flatten().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
            // 63 degrees of freedom: above 109 with probability 3e-4, 1e-3 for the four distances.
            assert!(chi_sq < 109.0, "χ² of {chi_sq:.1} at distance {z}");
        }
    }
}
