//! Shapes: what a scene's surfaces are made of.

mod cylinder;
mod flat;
mod flats;
mod mesh;
mod primitive;
mod sphere;
mod triangle;
mod triangles;

pub(crate) use flats::FlatBlock;
pub use mesh::Mesh;
pub(crate) use primitive::Primitive;
pub(crate) use sphere::Sphere;
pub(crate) use triangle::{ShearedRay, Triangle};
pub(crate) use triangles::{Hits, ShearedLanes, TriangleLeaf, Triangles};

use crate::handle::Handle;
use crate::material::Material;
use crate::math::{Transform, Vec2, Vec3};
use crate::medium::Boundary;
use crate::texture::Texture;

/// A surface of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What messages and the ledger call it.
    pub name: String,
    /// Its form, in its own space.
    pub geometry: Geometry,
    /// Its place.
    pub to_world: Transform,
    /// How it scatters.
    pub material: Handle<Material>,
    /// The radiance it emits on the side its normal points to, in W/(m²·sr); uniform in direction.
    pub emission: Option<Handle<Texture>>,
    /// Turns the normal around.
    pub flip_normals: bool,
    /// What it lies between.
    pub boundary: Boundary,
}

impl Shape {
    /// A surface in its own space that gives off no light and bounds no medium.
    pub fn new(name: impl Into<String>, geometry: Geometry, material: Handle<Material>) -> Self {
        Self {
            name: name.into(),
            geometry,
            to_world: Transform::IDENTITY,
            material,
            emission: None,
            flip_normals: false,
            boundary: Boundary::default(),
        }
    }
}

/// Shapes that are stored once and shown by any number of [`Instance`]s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// What messages call it.
    pub name: String,
    /// What it consists of, in the group's own space. None may emit or be infinite.
    pub shapes: Vec<Shape>,
}

/// A group of shapes at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// What messages call it.
    pub name: String,
    /// What is shown.
    pub group: Handle<Group>,
    /// Where, from the group's space. Any map that can be undone; it may stretch spheres.
    pub to_world: Transform,
}

/// The form of a shape in its own space.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Normal outward. Its transform must scale uniformly.
    Sphere {
        /// Centre.
        center: Vec3,
        /// Radius.
        radius: f32,
    },
    /// [-1, 1]² in the plane z = 0, normal +z, `uv` from (0, 0) at (-1, -1).
    Rectangle,
    /// The unit disk in the plane z = 0, normal +z, `uv` = (radius, angle / 2π).
    Disk,
    /// The curved side of a cylinder, without caps, normal outward. Its transform must scale uniformly.
    Cylinder {
        /// One end of the axis.
        p0: Vec3,
        /// The other.
        p1: Vec3,
        /// Radius.
        radius: f32,
    },
    /// The surface of [-1, 1]³, normals outward.
    Cube,
    /// All of the plane z = 0, normal +z. Counts in no bounds and cannot emit.
    Plane,
    /// Triangles.
    Mesh(Handle<Mesh>),
}

/// Where a ray meets a primitive: the ray parameter and two coordinates the primitive understands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Intersection {
    pub t: f32,
    pub u: f32,
    pub v: f32,
}

/// The geometry of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where.
    pub position: Vec3,
    /// Bounds the error of each coordinate of the position.
    pub error: Vec3,
    /// Unit normal of the surface, on the side the shape's normals point to.
    pub ng: Vec3,
    /// Unit normal for shading, interpolated over a mesh; within a right angle of `ng`.
    pub ns: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
}

impl SurfacePoint {
    /// The same point with its normals turned around.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { ng: -self.ng, ns: -self.ns, ..self }
    }
}
