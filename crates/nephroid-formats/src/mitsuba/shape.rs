//! `<shape>` elements.

use std::f32::consts::FRAC_1_PI;

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::Vec3;
use nephroid::medium::Boundary;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::Texture;

use super::document::Element;
use super::names::{SHAPES, SHAPES_LATER};
use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::log::shortened;
use crate::mesh::{MeshOptions, read_obj, read_ply, read_serialized};
use crate::spectra::Role;

impl<'t> Reader<'t> {
    /// Reads a `<shape>` into the scene; what is wrong goes to the log.
    pub(super) fn shape(&mut self, element: &'t Element) {
        match element.value_of("type") {
            Some("shapegroup") => {
                self.group(element);
            }
            Some("instance") => self.instance(element),
            _ => {
                let plugin = self.plugin(element);
                if let Some(shape) = self.surface(&plugin) {
                    self.origins.shapes.push(plugin.location().clone());
                    self.shapes.push(shape);
                }
            }
        }
    }

    /// A surface at its place. `None` if the log says why.
    pub(super) fn surface(&mut self, plugin: &Plugin<'t>) -> Option<Shape> {
        let geometry = match plugin.kind {
            "sphere" => self.sphere(plugin),
            "cylinder" => self.cylinder(plugin),
            "rectangle" => Some(Geometry::Rectangle),
            "disk" => Some(Geometry::Disk),
            "plane" => Some(Geometry::Plane),
            "cube" => {
                plugin.ignore(&["face_normals"]);
                Some(Geometry::Cube)
            }
            "obj" | "ply" | "serialized" => self.mesh(plugin).map(Geometry::Mesh),
            kind if SHAPES_LATER.contains(&kind) => {
                self.left_out(plugin.location(), &format!("shape \"{kind}\""));
                return None;
            }
            _ => {
                self.unknown_kind(plugin, &[SHAPES, SHAPES_LATER]);
                return None;
            }
        };
        let to_world = plugin.transform("to_world");
        let flip_normals = plugin.boolean("flip_normals", false);
        plugin.ignore(&["silhouette_sampling_weight"]);
        for (_, sensor) in plugin.objects("sensor") {
            let message = "a sensor on a shape measures and takes no picture: it is left out";
            self.log.warn(&sensor.location, message);
        }
        let mut boundary = self.boundary(plugin);
        let emission = self.emission(plugin, &mut boundary);
        let material = match plugin.only_object("bsdf") {
            Some(bsdf) => self.material(bsdf),
            None => {
                if boundary.is_named() {
                    let message =
                        "the shape bounds a medium but names no material, and so lets no light through";
                    let message = Diagnostic::warning(plugin.location(), message);
                    self.log.push(message.hint("<bsdf type=\"null\"/> does"));
                }
                Some(self.default_material(plugin, emission.is_some()))
            }
        };
        plugin.finish();
        let name = plugin.name();
        Some(Shape {
            name,
            geometry: geometry?,
            to_world,
            material: material?,
            emission,
            flip_normals,
            boundary,
        })
    }

    fn sphere(&self, plugin: &Plugin<'t>) -> Option<Geometry> {
        let center = plugin.vector("center").unwrap_or(Vec3::ZERO);
        Some(Geometry::Sphere { center, radius: plugin.positive("radius", 1.0) })
    }

    fn cylinder(&self, plugin: &Plugin<'t>) -> Option<Geometry> {
        let p0 = plugin.vector("p0").unwrap_or(Vec3::ZERO);
        let p1 = plugin.vector("p1").unwrap_or(Vec3::Z);
        if p0 == p1 {
            self.log
                .error(plugin.location(), "the ends \"p0\" and \"p1\" of the cylinder are the same point");
            return None;
        }
        Some(Geometry::Cylinder { p0, p1, radius: plugin.positive("radius", 1.0) })
    }

    /// The radiance of an area emitter inside a shape, and the medium that its light starts in.
    fn emission(&mut self, shape: &Plugin<'t>, boundary: &mut Boundary) -> Option<Handle<Texture>> {
        let plugin = self.plugin(shape.only_object("emitter")?);
        self.lamps_shown.extend(plugin.id());
        if plugin.kind == "directionalarea" {
            let message = "emitter \"directionalarea\" cannot be rendered yet; \"area\" of the same power stands for it";
            self.log.warn(plugin.location(), message);
        } else if plugin.kind != "area" {
            let message = format!("a shape's emitter must be \"area\", not \"{}\"", shortened(plugin.kind));
            self.log.error(plugin.location(), message);
            return None;
        }
        let mut radiance = self.texture_property(&plugin, "radiance", 1.0, Role::Emission);
        if plugin.kind == "directionalarea" {
            let a = radiance;
            let b = self.store_texture(plugin.location(), Texture::Constant(Rgb::splat(FRAC_1_PI)));
            radiance = self.store_texture(plugin.location(), Texture::Scale { a, b });
        }
        boundary.light = self.surroundings(&plugin);
        plugin.ignore(&["sampling_weight"]);
        plugin.finish();
        Some(radiance)
    }

    /// The mesh that `filename` names, read once for each way of reading it.
    fn mesh(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Mesh>> {
        let is_obj = plugin.kind == "obj";
        let options = MeshOptions {
            face_normals: plugin.boolean("face_normals", false),
            flip_tex_coords: plugin.boolean("flip_tex_coords", is_obj),
        };
        let number = match plugin.kind {
            "serialized" => plugin.integer_within("shape_index", 0, 0..=u32::MAX),
            _ => 0,
        };
        // Angles at which older versions made edges sharp, and shapes of a file that they took for one.
        plugin.ignore(&["max_smooth_angle", "collapse"]);
        let Some((name, at)) = plugin.text("filename") else {
            if !plugin.has("filename") {
                self.log.error(plugin.location(), format!("shape \"{}\" lacks a filename", plugin.kind));
            }
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        let key = (path.clone(), options.face_normals, options.flip_tex_coords, number);
        if let Some(handle) = self.mesh_of.get(&key) {
            return Some(*handle);
        }
        let read = match plugin.kind {
            "obj" => read_obj(&bytes, options),
            "ply" => read_ply(&bytes, options),
            _ => read_serialized(&bytes, number, options),
        };
        let file = self.log.mesh(at, &path, read)?;
        let handle = self.meshes.push(file.mesh);
        self.mesh_of.insert(key, handle);
        Some(handle)
    }
}
