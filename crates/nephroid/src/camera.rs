//! Cameras: from a point of the picture to a ray.

use crate::math::{Transform, Vec2};

/// Where the picture is taken from. In camera space `+z` looks ahead, `+x` points to the left of
/// the picture and `+y` up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Camera space to world.
    pub to_world: Transform,
    /// How space is flattened.
    pub projection: Projection,
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
