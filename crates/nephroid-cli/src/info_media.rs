//! What `nephroid info` tells of media.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::medium::{Boundary, Coefficient, Medium, Phase};
use nephroid::scene::Scene;
use nephroid::shape::Shape;
use nephroid::world::World;
use serde_json::{Value, json};

use crate::info::short;

/// Adds the media, how many cells their grids have, and the shapes that bound them; nothing without media.
pub fn add(about: &mut Value, world: &World) {
    let scene = world.scene();
    if scene.media.list.is_empty() {
        return;
    }
    about["media"] = scene.media.list.iter().map(|m| medium(scene, m)).collect();
    about["cells of grids"] = json!(cells(scene));
    about["boundaries of media"] = scene.all_shapes().filter_map(|shape| boundary(scene, shape)).collect();
}

/// The name of what something stands in; none outside of all media.
pub fn name(scene: &Scene, medium: Option<Handle<Medium>>) -> Value {
    medium.map_or(Value::Null, |medium| json!(scene.media.list[medium].name))
}

fn medium(scene: &Scene, medium: &Medium) -> Value {
    let grids = [&medium.sigma_t, &medium.albedo, &medium.emission];
    let is_grid = |coefficient: &&Coefficient| matches!(coefficient, Coefficient::Grid { .. });
    let mut about = json!({
        "name": medium.name,
        "kind": if grids.iter().any(is_grid) { "heterogeneous" } else { "homogeneous" },
        "sigma_t in 1/m": coefficient(scene, &medium.sigma_t),
        "albedo": coefficient(scene, &medium.albedo),
    });
    if medium.emission != Coefficient::ZERO {
        about["emission in W/(m3 sr)"] = coefficient(scene, &medium.emission);
    }
    about["phase"] = match medium.phase {
        Phase::Isotropic => json!("isotropic"),
        Phase::HenyeyGreenstein { g } => json!(format!("hg, g {g}")),
        Phase::Rayleigh => json!("rayleigh"),
    };
    if !medium.ambient.is_black() {
        about["ambient in W/(m2 sr)"] = rgb(medium.ambient);
    }
    about
}

/// Three numbers, or what grid there is.
fn coefficient(scene: &Scene, coefficient: &Coefficient) -> Value {
    match coefficient {
        Coefficient::Constant(value) => rgb(*value),
        Coefficient::Grid { grid, scale, .. } => {
            let [x, y, z] = scene.media.grids[*grid].size;
            json!(format!("grid of {x} by {y} by {z} cells, times {scale}"))
        }
    }
}

/// How many cells the grids of all media have.
fn cells(scene: &Scene) -> u64 {
    scene.media.grids.iter().map(|grid| grid.size.iter().map(|side| u64::from(*side)).product::<u64>()).sum()
}

/// What lies on both sides of a shape, if it says.
fn boundary(scene: &Scene, shape: &Shape) -> Option<Value> {
    let Boundary { interior, exterior, priority, .. } = shape.boundary;
    if !shape.boundary.is_named() && priority.is_none() {
        return None;
    }
    let mut about = json!({
        "shape": shape.name,
        "interior": name(scene, interior),
        "exterior": name(scene, exterior),
    });
    if let Some(priority) = priority {
        about["priority"] = json!(priority);
    }
    Some(about)
}

fn rgb(v: Rgb) -> Value {
    json!(v.to_array().map(short))
}
