use super::{CameraRays, Projection};
use crate::math::{Transform, Vec2, Vec3, warp};

/// How a point of the world is seen from a point of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Connection {
    /// Where the point appears on the whole picture, in pixels from its upper left corner; it may lie outside.
    pub film_position: Vec2,
    /// The point of the lens, or where the parallel ray starts, in the world.
    pub lens: Vec3,
    /// The unit direction from the point to the lens.
    pub direction: Vec3,
    /// The area of the picture that a square metre at the point fills which faces `direction`, in pixels² per m².
    ///
    /// A pixel's value is ∫ h(p) L(p) dp over places p of the film, with the integral of its filter h at 1. What
    /// sends the intensity I (W/sr) towards the lens is L dA⊥ = I, hence counts h(p) · `pixels_per_area` · I. This
    /// is Veach's measurement with W_e = h dp/(dA⊥ dω) (1997, eq. 8.3, and the camera of §8.3 of Pharr, Jakob and
    /// Humphreys 2016, §16.1.1) for a lens whose points are drawn as camera rays draw them, evenly.
    pub pixels_per_area: f32,
}

/// What is the same for all points in [`Connection::pixels_per_area`].
///
/// Let M be the linear part of camera space to world and a the area of a pixel at distance 1. Through a point of the
/// lens goes v = M (q, 1), which fills the solid angle det M / |v|³ for each unit of area of q (as v · (∂v/∂x × ∂v/∂y)
/// is det M). A point at the distance d from the lens and of the depth Z along the view has |v| = d/Z, and so
/// dp/dA⊥ = d / (Z³ a det M). Parallel rays along M e_z fill det M / |M e_z| of area across.
pub(super) fn density(to_world: &Transform, projection: &Projection, size: Vec2, half: Vec2) -> f64 {
    let m = to_world.0.matrix3;
    let pixel = 4.0 * (half / size).as_dvec2().element_product();
    let across = match projection {
        Projection::Perspective { .. } | Projection::ThinLens { .. } => 1.0,
        Projection::Orthographic => m.z_axis.length(),
    };
    across / (pixel * m.determinant().abs())
}

impl CameraRays {
    /// How a point of the world is seen. `u_lens` in [0, 1)² is the place on the lens, if there is one. `None` behind
    /// the camera.
    pub fn connect(&self, point: Vec3, u_lens: Vec2) -> Option<Connection> {
        let local = self.from_world.point(point);
        if local.z <= 0.0 || !local.z.is_finite() {
            return None;
        }
        let across = Vec2::new(local.x, local.y);
        let (q, origin) = match self.projection {
            Projection::Perspective { .. } => (across / local.z, Vec3::ZERO),
            Projection::ThinLens { aperture_radius, focus_distance, .. } => {
                let lens = aperture_radius * warp::square_to_disk(u_lens);
                ((across - lens) / local.z + lens / focus_distance, lens.extend(0.0))
            }
            Projection::Orthographic => (across, across.extend(0.0)),
        };
        let lens = self.to_world.point(origin);
        let way = lens - point;
        let distance = way.length();
        Some(Connection {
            film_position: self.film_position(q),
            lens,
            direction: way / distance,
            pixels_per_area: self.pixels_per_area(local.z, distance),
        })
    }

    /// See [`Connection::pixels_per_area`]: of a point in front of the camera, seen from a point of its lens.
    pub fn pixels_per_area_from(&self, lens: Vec3, point: Vec3) -> f32 {
        self.pixels_per_area(self.from_world.point(point).z, point.distance(lens))
    }

    fn pixels_per_area(&self, depth: f32, distance: f32) -> f32 {
        match self.projection {
            Projection::Perspective { .. } | Projection::ThinLens { .. } => {
                let (distance, depth) = (f64::from(distance), f64::from(depth));
                (self.density * distance / (depth * depth * depth)) as f32
            }
            Projection::Orthographic => self.density as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, FovAxis};
    use crate::film::{FilmSettings, Filter};
    use crate::math::{DVec3, Ray};

    /// Cameras of every kind, upright, and turned, moved, sheared and stretched.
    fn cameras() -> Vec<CameraRays> {
        let (fov_deg, fov_axis) = (70.0, FovAxis::Y);
        let principal_point_offset = Vec2::new(0.1, -0.2);
        let lens = Projection::ThinLens {
            fov_deg,
            fov_axis,
            principal_point_offset,
            aperture_radius: 0.3,
            focus_distance: 2.5,
        };
        let pinhole = Projection::Perspective { fov_deg, fov_axis, principal_point_offset };
        let upright = Transform::look_at(DVec3::new(0.3, 1.0, 4.0), DVec3::ZERO, DVec3::Y).expect("differ");
        let odd = Transform::scale(DVec3::new(0.7, 1.9, 1.2))
            .then(Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 35.0))
            .then(Transform::scale(DVec3::new(-0.5, 1.0, 1.0)))
            .then(upright);
        let film = FilmSettings { width: 400, height: 200, crop: None, filter: Filter::Box };
        let of =
            |projection, to_world| CameraRays::new(&Camera { to_world, projection, medium: None }, &film);
        [upright, odd]
            .into_iter()
            .flat_map(|to_world| [pinhole, lens, Projection::Orthographic].map(|p| of(p, to_world)))
            .collect()
    }

    const LENS: Vec2 = Vec2::new(0.15, 0.7);

    #[test]
    fn points_on_a_ray_are_connected_to_where_it_started() {
        for camera in cameras() {
            for position in [Vec2::new(0.5, 0.5), Vec2::new(321.0, 77.0), Vec2::new(-20.0, 230.0)] {
                let ray = camera.ray(position, LENS);
                let found = camera.connect(ray.at(2.2), LENS).expect("it is ahead");
                let kind = camera.projection;
                assert!((found.film_position - position).length() < 2e-3, "{kind:?}: {found:?}");
                assert!((found.lens - ray.origin).length() < 1e-5, "{kind:?}: {found:?}");
                assert!((found.direction + ray.direction).length() < 1e-5, "{kind:?}: {found:?}");
                assert!(camera.connect(ray.at(-1.0), LENS).is_none());
            }
        }
    }

    /// The rays of a small square of the film, of which the area across is measured at a distance.
    #[test]
    fn pixels_per_area_are_those_of_neighbouring_rays() {
        for camera in cameras() {
            for position in [Vec2::new(200.0, 100.0), Vec2::new(390.0, 5.0)] {
                for t in [0.5, 3.0, 50.0] {
                    let ray = camera.ray(position, LENS);
                    let found = camera.connect(ray.at(t), LENS).expect("it is ahead");
                    // Where a ray meets the plane across `ray` at the point, in double precision as far as it goes.
                    let meet = |offset: Vec2| {
                        let Ray { origin, direction, .. } = camera.ray(position + offset, LENS);
                        let normal = ray.direction;
                        origin + direction * ((ray.at(t) - origin).dot(normal) / direction.dot(normal))
                    };
                    let (dx, dy) = (Vec2::new(2.0, 0.0), Vec2::new(0.0, 2.0));
                    let area = (meet(dx) - meet(-dx)).cross(meet(dy) - meet(-dy)).length() / 16.0;
                    let product = area * found.pixels_per_area;
                    assert!((product - 1.0).abs() < 3e-3, "{:?} at {t}: {product}", camera.projection);
                }
            }
        }
    }
}
