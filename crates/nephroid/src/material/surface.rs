use crate::math::{Frame, Vec3};
use crate::texture::TexturePoint;

/// What a material needs to know of the place where a ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The unit normal of the geometry, pointing to the outer side.
    pub ng: Vec3,
    /// The shading frame: its normal lies in the hemisphere of `ng`.
    pub frame: Frame,
    /// Where textures are read.
    pub at: TexturePoint,
    /// How the position changes with the texture coordinates `u` and `v`; zero where nobody asked.
    pub dp_duv: [Vec3; 2],
    /// Whether its outer side is inside.
    pub(super) turned: bool,
}

impl Surface {
    /// A surface shaded with its own normal.
    #[inline]
    pub fn flat(ng: Vec3, at: impl Into<TexturePoint>) -> Self {
        Self::new(ng, ng, at)
    }

    /// A surface with a shading normal, for materials that are the same in all directions around it.
    #[inline]
    pub fn new(ng: Vec3, ns: Vec3, at: impl Into<TexturePoint>) -> Self {
        let frame = Frame::from_normal(ns);
        Self { ng, frame, at: at.into(), dp_duv: [Vec3::ZERO; 2], turned: false }
    }

    /// A surface whose shading frame follows the texture coordinates: its first tangent is along `dp_du`, or square to
    /// `dp_dv` where there is none.
    #[inline]
    pub fn oriented(ng: Vec3, ns: Vec3, at: impl Into<TexturePoint>, dp_duv: [Vec3; 2]) -> Self {
        let [dp_du, dp_dv] = dp_duv;
        let frame = Frame::along(ns, dp_du).or_else(|| Frame::along(ns, dp_dv.cross(ns)));
        let frame = frame.unwrap_or_else(|| Frame::from_normal(ns));
        Self { ng, frame, at: at.into(), dp_duv, turned: false }
    }

    /// The same place with its outer side inside. The frame stays right-handed.
    #[inline]
    pub fn flipped(&self) -> Self {
        let Frame { s, t, n } = self.frame;
        Self { ng: -self.ng, frame: Frame { s, t: -t, n: -n }, turned: !self.turned, ..*self }
    }
}
