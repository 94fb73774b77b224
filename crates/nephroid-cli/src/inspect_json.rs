//! What the estimate of a pixel saw, as JSON.

use nephroid::color::Rgb;
use nephroid::integrator::{Components, FromVolume, LightPart};
use nephroid::laboratory::{Contribution, InspectedSample, LookUpReport, MediumPassed, RayLight, SurfaceMet};
use serde_json::{Value, json};

use crate::info::{short, vector};
use crate::inspect::Inspected;
use crate::method;

/// One object; its keys are documented in docs/laboratory.md.
pub fn object(inspected: &Inspected<'_>, messages: &[String]) -> Value {
    let window = inspected.world.scene().film.window();
    let (x, y) = inspected.pixel;
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": inspected.scene,
        "integrator": method::describe(&inspected.settings.method),
        "seed": inspected.settings.seed,
        "width": window.width,
        "height": window.height,
        "pixel": [x, y],
        "passes": inspected.passes,
        "samples_per_pixel": inspected.report.samples.len(),
        "radiance": rgb(inspected.report.radiance),
        "light": light(&inspected.report.light),
        "samples": inspected.samples().map(|(n, s)| sample(inspected, n, s)).collect::<Vec<_>>(),
        "messages": messages,
    })
}

fn sample(inspected: &Inspected<'_>, number: usize, s: &InspectedSample) -> Value {
    json!({
        "sample": number,
        "pass": s.iteration,
        "index": s.index,
        "weight": short(s.weight),
        "origin": vector(s.origin),
        "direction": vector(s.direction),
        "radiance": rgb(s.light.total()),
        "light": light(&s.light),
        "surfaces": s.surfaces.iter().map(|met| surface(inspected, met)).collect::<Vec<_>>(),
        "rays": s.rays.iter().map(ray).collect::<Vec<_>>(),
        "look_ups": s.look_ups.iter().map(|l| look_up(inspected, l)).collect::<Vec<_>>(),
        "media": s.media.iter().map(|passed| medium(inspected, passed)).collect::<Vec<_>>(),
    })
}

fn surface(inspected: &Inspected<'_>, met: &SurfaceMet) -> Value {
    let (shape, material) = inspected.shape(met.shape);
    json!({
        "gather_ray": met.gather_ray,
        "depth": met.depth,
        "shape": shape,
        "material": material,
        "specular": met.specular,
        "position": vector(met.position),
        "normal": vector(met.normal),
        "uv": [short(met.uv.x), short(met.uv.y)],
        "throughput": rgb(met.throughput),
    })
}

fn ray(ray: &RayLight) -> Value {
    json!({ "surface": ray.surface, "part": part(ray.part), "radiance": rgb(ray.radiance) })
}

fn look_up(inspected: &Inspected<'_>, l: &LookUpReport) -> Value {
    let contribution = |c: &Contribution| {
        json!({
            "part": part(c.part),
            "light": inspected.light(c.light),
            "path": c.bounces.to_string(),
            "photons": c.photons,
            "radiance": rgb(c.radiance),
        })
    };
    json!({
        "surface": l.surface,
        "map": l.map.name(),
        "radius": short(l.radius),
        "count": l.count,
        "contributions": l.contributions.iter().map(contribution).collect::<Vec<_>>(),
    })
}

fn medium(inspected: &Inspected<'_>, passed: &MediumPassed) -> Value {
    let found = |found: &FromVolume| json!({ "count": found.count, "radiance": rgb(found.radiance) });
    let light = &passed.light;
    json!({
        "gather_ray": passed.gather_ray,
        "depth": passed.depth,
        "medium": inspected.medium(passed.medium),
        // Infinite ones have no number in JSON.
        "length": passed.length.is_finite().then(|| short(passed.length)),
        "emitted": rgb(light.emitted),
        "single": rgb(light.single),
        "ambient": rgb(light.ambient),
        "volume": found(&light.volume),
        "volume_caustic": found(&light.volume_caustic),
        "transmittance": rgb(passed.transmittance),
    })
}

fn light(light: &Components) -> Value {
    json!({
        "emitted": rgb(light.emitted),
        "direct": rgb(light.direct),
        "global": rgb(light.global),
        "caustic": rgb(light.caustic),
        "medium": rgb(light.medium),
    })
}

fn rgb(v: Rgb) -> Value {
    json!(v.to_array().map(short))
}

/// What a part of the light is called.
pub fn part(part: LightPart) -> &'static str {
    match part {
        LightPart::Emitted => "emitted",
        LightPart::Direct => "direct",
        LightPart::Global => "global",
        LightPart::Caustic => "caustic",
        LightPart::Medium => "medium",
    }
}
