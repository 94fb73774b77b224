//! `nephroid info`: what a scene contains.

use std::fmt::Write;

use nephroid::camera::Projection;
use nephroid::color::Rgb;
use nephroid::film::Filter;
use nephroid::material::Material;
use nephroid::math::Vec3;
use nephroid::scene::Scene;
use nephroid::shape::Geometry;
use nephroid::texture::Texture;
use nephroid::world::World;
use nephroid_formats::{IntegratorRequest, ParameterValue};
use serde_json::{Map, Value, json};

use crate::args::{InfoArgs, LimitArgs};
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::info_media;
use crate::load;
use crate::method;
use crate::parameters::PhotonFlags;
use crate::plan::Plan;

/// Reads a scene, prepares it as if to be rendered, and tells about it.
pub fn run(args: &InfoArgs) -> Result<Exit, Failure> {
    let mut messages = Messages::new(false);
    let file = load::load(&args.scene, &args.reading, false)?;
    for warning in &file.warnings {
        messages.diagnostic(warning);
    }
    let method =
        method::choose(None, &file, &PhotonFlags::default(), method::Integrator::Auto, &mut messages)?;
    let plan = Plan::new(&LimitArgs::default(), file.sample_count);
    let world = load::world(file.scene, &file.origins, false)?;
    for remark in &load::remarks(&world, &file.origins) {
        messages.diagnostic(remark);
    }
    let mut about = json!({ "scene": args.scene.display().to_string() });
    about["film"] = film(world.scene());
    about["camera"] = camera(world.scene());
    if world.has_media() {
        about["camera"]["medium"] = info_media::name(world.scene(), world.camera_surroundings().medium());
    }
    about["shapes"] = shapes(world.scene());
    about["primitives"] = json!(world.primitive_count());
    about["bounds"] = bounds(&world);
    about["materials"] = counted(world.scene().materials.iter().map(material));
    about["textures"] = counted(world.scene().textures.list.iter().map(texture));
    info_media::add(&mut about, &world);
    about["lights"] = lights(&world);
    about["integrator of the scene"] = request(&file.integrator);
    about["integrator used"] = method::describe(&method);
    about["samples per pixel"] = json!(plan.samples_per_pass);
    if args.json {
        about["messages"] = json!(messages.list);
        console::result(&format!("{about}\n"))?;
    } else {
        let mut text = String::new();
        write_block(&mut text, &about, 0);
        console::result(&text)?;
    }
    Ok(Exit::Done)
}

fn film(scene: &Scene) -> Value {
    let film = &scene.film;
    let filter = match film.filter {
        Filter::Box | Filter::Mitchell { .. } => film.filter.name().to_owned(),
        Filter::Tent { radius } => format!("tent, radius {radius}"),
        Filter::Gaussian { std_dev } => format!("gaussian, standard deviation {std_dev}"),
    };
    let mut about = json!({ "width": film.width, "height": film.height });
    if let Some(crop) = film.crop {
        about["crop"] = json!({ "x": crop.x, "y": crop.y, "width": crop.width, "height": crop.height });
    }
    about["filter"] = json!(filter);
    about
}

fn camera(scene: &Scene) -> Value {
    let to_world = &scene.camera.to_world;
    let mut about = match scene.camera.projection {
        Projection::Orthographic => json!({ "projection": "orthographic" }),
        Projection::Perspective { fov_deg, fov_axis, .. } => json!({
            "projection": "perspective",
            "fov_deg": short(fov_deg),
            "fov_axis": format!("{fov_axis:?}").to_lowercase(),
        }),
        Projection::ThinLens { fov_deg, fov_axis, aperture_radius, focus_distance, .. } => json!({
            "projection": "thin lens",
            "fov_deg": short(fov_deg),
            "fov_axis": format!("{fov_axis:?}").to_lowercase(),
            "aperture_radius": short(aperture_radius),
            "focus_distance": short(focus_distance),
        }),
    };
    about["origin"] = vector(to_world.point(Vec3::ZERO));
    about["direction"] = vector(to_world.vector(Vec3::Z).normalize_or_zero());
    about
}

fn shapes(scene: &Scene) -> Value {
    let kind = |geometry: &Geometry| match geometry {
        Geometry::Sphere { .. } => "sphere",
        Geometry::Rectangle => "rectangle",
        Geometry::Disk => "disk",
        Geometry::Cylinder { .. } => "cylinder",
        Geometry::Cube => "cube",
        Geometry::Plane => "plane",
        Geometry::Mesh(_) => "mesh",
    };
    let all = || scene.shapes.iter().chain(scene.groups.iter().flat_map(|group| &group.shapes));
    let triangles: usize = all()
        .map(|shape| match shape.geometry {
            Geometry::Mesh(mesh) => scene.meshes[mesh].triangles.len(),
            _ => 0,
        })
        .sum();
    let mut about = counted(all().map(|shape| kind(&shape.geometry)));
    if !scene.groups.is_empty() {
        about["groups"] = json!(scene.groups.len());
        about["instances"] = json!(scene.instances.len());
    }
    about["triangles of meshes"] = json!(triangles);
    about
}

/// What a kind of material is called.
pub fn material(material: &Material) -> &'static str {
    match material {
        Material::Diffuse { .. } => "diffuse",
        Material::Phong { .. } => "phong",
        Material::Conductor { .. } => "conductor",
        Material::Dielectric { .. } => "dielectric",
        Material::ThinDielectric { .. } => "thindielectric",
        Material::TwoSided { .. } => "twosided",
        Material::Mask { .. } => "mask",
        Material::Dispersive { .. } => "dispersive dielectric",
        Material::RoughConductor { .. } => "roughconductor",
        Material::RoughDielectric { .. } => "roughdielectric",
        Material::Plastic { roughness: None, .. } => "plastic",
        Material::Plastic { .. } => "roughplastic",
        Material::CoatedConductor { .. } => "coatedconductor",
        Material::DiffuseTransmission { .. } => "diffusetransmission",
        Material::Principled(_) => "principled",
        Material::MetallicRoughness(_) => "metallicroughness",
        Material::Blend { .. } => "blend",
        Material::NormalMap { .. } => "normalmap",
        Material::BumpMap { .. } => "bumpmap",
        Material::Null => "null",
    }
}

fn texture(texture: &Texture) -> &'static str {
    match texture {
        Texture::Constant(_) => "constant",
        Texture::Bitmap(_) => "bitmap",
        Texture::Checkerboard(_) => "checkerboard",
        Texture::VertexColor => "mesh_attribute",
        Texture::Scale { .. } => "scale",
        Texture::Mix { .. } => "mix",
        Texture::Channel { .. } => "channel",
    }
}

fn lights(world: &World) -> Value {
    let power =
        |power: Rgb| json!({ "power in W": power.to_array().map(short), "mean": short(power.mean()) });
    let light = |(number, (name, p)): (usize, (&str, Rgb))| {
        let mut about = json!({ "name": name, "power": power(p) });
        if world.has_media() {
            about["medium"] = info_media::name(world.scene(), world.light_surroundings(number).medium());
        }
        about
    };
    world.lights().enumerate().map(light).collect()
}

fn bounds(world: &World) -> Value {
    let bounds = world.bounds();
    if bounds.is_empty() {
        return Value::Null;
    }
    json!({ "min": vector(bounds.min), "max": vector(bounds.max) })
}

fn request(request: &IntegratorRequest) -> Value {
    let value = |value: &ParameterValue| match value {
        ParameterValue::Int(v) => json!(v),
        ParameterValue::Float(v) => json!(v),
        ParameterValue::Bool(v) => json!(v),
        ParameterValue::Text(v) => json!(v),
    };
    let mut about = Map::new();
    about.insert("name".to_owned(), json!(request.name));
    about.extend(request.parameters.iter().map(|p| (p.name.clone(), value(&p.value))));
    Value::Object(about)
}

/// Three numbers.
pub fn vector(v: Vec3) -> Value {
    json!([v.x, v.y, v.z].map(short))
}

/// The number of fewest digits that is the same in single precision.
pub fn short(v: f32) -> Value {
    v.to_string().parse::<f64>().map_or(Value::Null, |v| json!(v))
}

/// How many there are of each kind, in the order in which the kinds are first met.
fn counted(kinds: impl Iterator<Item = &'static str>) -> Value {
    let mut counts = Map::new();
    for kind in kinds {
        let count = counts.get(kind).and_then(Value::as_u64).unwrap_or(0);
        counts.insert(kind.to_owned(), json!(count + 1));
    }
    Value::Object(counts)
}

/// Writes an object as lines: a name, a colon and the value; nested objects are indented.
fn write_block(out: &mut String, object: &Value, indent: usize) {
    let Value::Object(fields) = object else { return };
    for (name, value) in fields {
        // Writing into a string cannot fail.
        let _ = match value {
            Value::Object(_) => writeln!(out, "{:indent$}{name}", ""),
            Value::Array(list) if list.iter().any(Value::is_object) => {
                writeln!(out, "{:indent$}{name}: {}", "", list.len())
            }
            other => writeln!(out, "{:indent$}{name}: {}", "", plain(other)),
        };
        write_block(out, value, indent + 2);
        for item in value.as_array().into_iter().flatten() {
            write_block(out, item, indent + 2);
        }
    }
}

/// A value without the marks of JSON.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::String(text) => text.clone(),
        Value::Array(list) => list.iter().map(plain).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}
