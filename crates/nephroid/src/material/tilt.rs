//! Shading normals from images.

use super::surface::Surface;
use crate::handle::Handle;
use crate::math::{Frame, Vec3};
use crate::texture::{Texture, Textures};

/// The least cosine between a normal from an image and that of the geometry. Nearer to a right angle or beyond it, light
/// would come from below.
const LEAST_COS: f32 = 0.02;

impl Surface {
    /// With the normal that a colour tells: its channels, from 0 to 1, are the coordinates, from −1 to 1, along the
    /// shading frame, the first two of them scaled (Cohen, Olano and Manocha 1998, *Appearance-Preserving
    /// Simplification*). The second of them goes `against_v`, or else counter-clockwise of the first: where texture
    /// coordinates are mirrored these are opposite.
    pub(super) fn mapped(
        &self,
        textures: &Textures,
        normals: Handle<Texture>,
        scale: f32,
        against_v: bool,
    ) -> Self {
        let [x, y, z] = textures.eval(normals, self.at).map(|v| 2.0 * v - 1.0).to_array();
        let [_, t] = self.axes();
        let y = if against_v && t.dot(self.dp_duv[1]) > 0.0 { -y } else { y };
        self.tilted(Vec3::new(x * scale, y * scale, z))
    }

    /// With the normal of the surface raised along its shading normal by heights, which are small beside its curvature
    /// (Blinn 1978, *Simulation of Wrinkled Surfaces*, 10.1145/965139.507101). Heights are the mean of the channels.
    pub(super) fn raised(&self, textures: &Textures, heights: Handle<Texture>, scale: f32) -> Self {
        let [s, t] = self.axes();
        let slopes = textures.gradient(heights, self.at).map(|slope| slope.mean() * scale);
        let [along_u, along_v] = [0, 1].map(|i| {
            let dp = self.dp_duv[i];
            Vec3::new(dp.dot(s), dp.dot(t), slopes[i])
        });
        let normal = along_u.cross(along_v);
        self.tilted(normal * 1.0f32.copysign(normal.z))
    }

    /// The directions of the surface that a map's two coordinates follow. They are the same on both sides, so that what
    /// is raised on the one is raised on the other.
    fn axes(&self) -> [Vec3; 2] {
        let Frame { s, t, .. } = self.frame;
        [s, if self.turned { -t } else { t }]
    }

    /// With a shading normal of these coordinates, of any length, as far as it stays above the geometry. The first
    /// tangent keeps its direction as far as it can.
    fn tilted(&self, coordinates: Vec3) -> Self {
        let [s, t] = self.axes();
        let normal = s * coordinates.x + t * coordinates.y + self.frame.n * coordinates.z;
        let Some(normal) = normal.try_normalize() else { return *self };
        let short = LEAST_COS - normal.dot(self.ng);
        let normal = if short > 0.0 { (normal + self.ng * short).try_normalize() } else { Some(normal) };
        match normal.and_then(|n| Frame::along(n, s)) {
            Some(frame) => Self { frame, ..*self },
            None => *self,
        }
    }
}
