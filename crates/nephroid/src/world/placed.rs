use crate::math::{Bounds, DAffine3, DMat3, Ray, Transform, Vec3, gamma};
use crate::shape::SurfacePoint;

/// A group at a place.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// Which group.
    pub group: u32,
    to_world: DAffine3,
    to_local: DAffine3,
    /// Absolute values of the linear part: how errors grow.
    growth: DMat3,
}

impl Placed {
    pub fn new(group: u32, to_world: &Transform) -> Self {
        let m = to_world.0.matrix3;
        let growth = DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        Self { group, to_world: to_world.0, to_local: to_world.inverse().0, growth }
    }

    /// The ray in the group's space. Its direction is not normalised, so that distances along it are
    /// those in the world. In double precision, then rounded once.
    #[inline(always)]
    pub fn local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_local.transform_point3(ray.origin.as_dvec3()).as_vec3(),
            direction: self.to_local.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
            t_max: ray.t_max,
        }
    }

    /// A point of the group in the world.
    ///
    /// Its error is that of the point, that of the origin of a ray which leaves it and comes back into
    /// the group's space, and that of its rounding here.
    pub fn point(&self, local: &SurfacePoint) -> SurfacePoint {
        let position = self.to_world.transform_point3(local.position.as_dvec3()).as_vec3();
        let own = local.error + local.position.abs() * gamma(4);
        let error = (self.growth * own.as_dvec3()).as_vec3() + position.abs() * gamma(4);
        let mut ng = self.normal(local.ng);
        let ns = self.normal(local.ns);
        // A stretch may part the two by more than a right angle: the shading normal says what is out.
        ng *= 1.0f32.copysign(ng.dot(ns));
        SurfacePoint { position, error, ng, ns, uv: local.uv }
    }

    /// A direction of the group in the world, without normalising.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.to_world.transform_vector3(v.as_dvec3()).as_vec3()
    }

    /// By the inverse transpose.
    fn normal(&self, n: Vec3) -> Vec3 {
        (self.to_local.matrix3.transpose() * n.as_dvec3()).normalize_or_zero().as_vec3()
    }

    /// Around all that is in the bounds, and the rounding of rays.
    pub fn bounds(&self, local: Bounds) -> Bounds {
        let m = &self.to_world.matrix3;
        let (low, high) = (local.min.as_dvec3(), local.max.as_dvec3());
        let (mut min, mut max) = (self.to_world.translation, self.to_world.translation);
        for (column, low, high) in
            [(m.x_axis, low.x, high.x), (m.y_axis, low.y, high.y), (m.z_axis, low.z, high.z)]
        {
            min += (column * low).min(column * high);
            max += (column * low).max(column * high);
        }
        let reach = local.min.abs().max(local.max.abs());
        let slack = (self.growth * reach.as_dvec3()).as_vec3() * gamma(4);
        let (min, max) = (min.as_vec3(), max.as_vec3());
        let slack = slack + min.abs().max(max.abs()) * gamma(4);
        Bounds { min: min - slack, max: max + slack }
    }
}
