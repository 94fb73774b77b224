//! `Shape`.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform};
use nephroid::medium::Boundary;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::Texture;

use super::light::luminance;
use super::names::{SHAPES, SHAPES_LATER};
use super::parameters::Parameters;
use super::quadric::Quadric;
use super::reader::Reader;
use super::state::Current;
use crate::diagnostic::Diagnostic;
use crate::spectra::Role;

/// A form and the map from its own space to that of the file.
pub(super) struct Form {
    pub(super) geometry: Geometry,
    pub(super) to_object: Transform,
}

impl Form {
    pub(super) fn mesh(mesh: Handle<Mesh>) -> Self {
        Self { geometry: Geometry::Mesh(mesh), to_object: Transform::IDENTITY }
    }
}

impl Reader<'_> {
    /// Reads a shape into the scene, or into the object that is being described.
    pub(super) fn shape(&mut self, parameters: &Parameters) {
        let shape = self.surface(parameters);
        let at = parameters.at.clone();
        match (&mut self.object, shape) {
            (_, Some(_)) if self.state.is_hidden => {}
            (Some(object), Some(shape)) => {
                object.shapes.push(shape);
                object.places.push(at);
            }
            (Some(object), None) => object.failed = true,
            (None, Some(shape)) => {
                self.shapes.push(shape);
                self.origins.shapes.push(at);
            }
            (None, None) => {}
        }
    }

    fn surface(&mut self, parameters: &Parameters) -> Option<Shape> {
        let ctm = self.state.ctm;
        let form = match parameters.kind.as_str() {
            "sphere" | "disk" | "cylinder" => {
                let quadric = Quadric::read(parameters, self.log);
                quadric.and_then(|quadric| self.quadric(parameters, &quadric, &ctm))
            }
            "trianglemesh" => self.triangle_mesh(parameters).map(Form::mesh),
            "plymesh" => self.ply_mesh(parameters).map(Form::mesh),
            "bilinearmesh" => self.bilinear_mesh(parameters).map(Form::mesh),
            "loopsubdiv" => self.loop_subdivision(parameters).map(Form::mesh),
            kind if SHAPES_LATER.contains(&kind) => {
                self.left_out(&parameters.at, &format!("shape \"{kind}\""));
                return None;
            }
            _ => {
                self.unknown_kind(parameters, &[SHAPES, SHAPES_LATER]);
                return None;
            }
        };
        let to_world = form.as_ref().map_or(ctm, |form| form.to_object.then(ctm));
        if form.is_some() && !to_world.is_invertible() {
            self.log.error(&parameters.at, "the place of the shape flattens space or overflows");
        }
        let alpha = self.alpha_of(parameters);
        parameters.finish();
        let material = self.material_of_shape(parameters);
        let geometry = form?.geometry;
        let emission = self.emission(parameters, &geometry, &to_world, material, alpha.is_some());
        let material = match alpha {
            Some(alpha) if emission.is_none() => {
                material.map(|inside| self.with_mask(parameters, inside, alpha))
            }
            _ => material,
        };
        Some(Shape {
            name: parameters.name(),
            geometry,
            to_world,
            material: material?,
            emission,
            flip_normals: self.state.reverse_orientation,
            boundary: self.boundary(),
        })
    }

    /// What surrounds the shape. Where both sides are alike nothing changes.
    fn boundary(&self) -> Boundary {
        let (interior, exterior) = (self.state.inside, self.state.outside);
        if interior == exterior {
            return Boundary { light: exterior, ..Boundary::default() };
        }
        Boundary { interior, exterior, light: None, priority: None }
    }

    fn material_of_shape(&mut self, parameters: &Parameters) -> Option<Handle<Material>> {
        match self.state.material {
            Current::Is(material) => Some(material),
            Current::Failed => None,
            Current::Default => {
                if self.default_material.is_none() {
                    let texture = Texture::Constant(Rgb::splat(0.5));
                    let reflectance = self.store_texture(&parameters.at, texture);
                    let material = Material::Diffuse { reflectance };
                    self.default_material = Some(self.store_sides(&parameters.at, material, true));
                }
                self.default_material
            }
        }
    }

    /// What the shape shines with.
    fn emission(
        &mut self,
        parameters: &Parameters,
        geometry: &Geometry,
        to_world: &Transform,
        material: Option<Handle<Material>>,
        is_masked: bool,
    ) -> Option<Handle<Texture>> {
        let light = self.state.area_light.clone()?;
        let warn = |message: &str| self.log.warn(&parameters.at, message.to_owned());
        if self.object.is_some() {
            warn("a shape of an object does not shine, in pbrt neither");
            return None;
        }
        if material.is_some_and(|m| self.materials[m] == Material::Null) {
            warn("a shape of the material \"interface\" does not shine, in pbrt neither");
            return None;
        }
        if is_masked {
            warn("a lamp has no \"alpha\" yet: it is all there");
        }
        Some(self.radiance(&light, |reader| reader.area(geometry, to_world)))
    }

    /// The opacity that `alpha` says, if some of it is not there.
    fn alpha_of(&mut self, parameters: &Parameters) -> Option<Handle<Texture>> {
        parameters.any("alpha")?;
        let alpha = self.texture_or_color(parameters, "alpha", Rgb::WHITE, Role::Index)?;
        let alpha = match self.constant(alpha) {
            Some(value) if value.min_channel() >= 1.0 => return None,
            Some(value) => {
                let value = Rgb::splat(luminance(value).clamp(0.0, 1.0));
                self.store_texture(&parameters.at, Texture::Constant(value))
            }
            None => alpha,
        };
        Some(alpha)
    }

    /// The material with holes, one for each pair.
    fn with_mask(
        &mut self,
        parameters: &Parameters,
        inside: Handle<Material>,
        opacity: Handle<Texture>,
    ) -> Handle<Material> {
        let key = (inside.index(), opacity.index());
        if let Some(known) = self.masked.get(&key) {
            return *known;
        }
        if self.boundary().is_named() {
            let message = Diagnostic::warning(&parameters.at, "a shape with holes bounds no medium");
            self.log.push(message.hint("put one of the material \"interface\" beside it"));
        }
        let masked = self.store_material(&parameters.at, Material::Mask { opacity, inside });
        self.masked.insert(key, masked);
        masked
    }

    /// The area of a form at its place.
    fn area(&self, geometry: &Geometry, to_world: &Transform) -> f64 {
        let scale_sq = to_world.uniform_scale().map_or(1.0, |s| s * s);
        let pi = std::f64::consts::PI;
        match geometry {
            Geometry::Sphere { radius, .. } => 4.0 * pi * f64::from(radius * radius) * scale_sq,
            Geometry::Cylinder { p0, p1, radius } => {
                2.0 * pi * f64::from(*radius * p0.distance(*p1)) * scale_sq
            }
            Geometry::Disk => {
                let m = to_world.0.matrix3;
                pi * m.x_axis.cross(m.y_axis).length()
            }
            Geometry::Mesh(mesh) => {
                let mesh = &self.meshes[*mesh];
                let place = |i: u32| to_world.0.transform_point3(mesh.positions[i as usize].as_dvec3());
                let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
                mesh.triangles.iter().map(|t| area(t.map(place))).sum()
            }
            Geometry::Rectangle | Geometry::Cube | Geometry::Plane => 1.0,
        }
    }

    fn quadric(&mut self, parameters: &Parameters, quadric: &Quadric, ctm: &Transform) -> Option<Form> {
        if let Some(form) = quadric.whole(ctm) {
            return Some(form);
        }
        self.store_mesh(parameters, quadric.mesh()).map(Form::mesh)
    }
}
