//! What the estimate of a pixel saw, in words.

use std::collections::BTreeMap;
use std::fmt::Write;

use nephroid::color::Rgb;
use nephroid::integrator::{Components, LightPart, MapName};
use nephroid::laboratory::{InspectedSample, LookUpReport, MediumPassed, SurfaceMet};
use nephroid::math::Vec3;
use nephroid::transport::Bounces;

use crate::inspect::Inspected;
use crate::inspect_json::part;
use crate::numbers::plural;

/// The pixel, and each sample. Gather rays are summed up, but for a sample that was asked for alone.
pub fn text(inspected: &Inspected<'_>) -> String {
    let mut out = String::new();
    let report = &inspected.report;
    let (x, y) = inspected.pixel;
    // Writing into a string cannot fail.
    let _ = writeln!(
        out,
        "{}, pixel {x},{y}: {} in {}, {}",
        inspected.scene,
        plural(report.samples.len() as u64, "sample"),
        plural(inspected.passes, "pass"),
        inspected.settings.method.name()
    );
    let _ = writeln!(out, "radiance  {}  W/(m2 sr)", rgb(report.radiance));
    parts(&mut out, "  ", &report.light);
    for (number, sample) in inspected.samples() {
        let (pass, weight) = (sample.iteration, sample.weight);
        let _ = writeln!(out, "\nsample {number}, of pass {pass}, with weight {weight}");
        let _ = writeln!(out, "  radiance  {}", rgb(sample.light.total()));
        parts(&mut out, "    ", &sample.light);
        let _ = writeln!(out, "  from {} towards {}", vector(sample.origin), vector(sample.direction));
        lights(&mut out, sample, None, "  ");
        let whole = inspected.only.is_some();
        for passed in sample.media.iter().filter(|passed| whole || passed.gather_ray.is_none()) {
            medium(&mut out, inspected, passed);
        }
        for (i, met) in sample.surfaces.iter().enumerate() {
            if whole || met.gather_ray.is_none() {
                surface(&mut out, inspected, sample, i, met);
            }
        }
        if !whole {
            gathered(&mut out, inspected, sample);
        }
    }
    out
}

fn parts(out: &mut String, indent: &str, light: &Components) {
    for name in LightPart::ALL {
        let _ = writeln!(out, "{indent}{:<8}{}", part(name), rgb(light.part(name)));
    }
}

/// A surface with what was found there.
fn surface(
    out: &mut String,
    inspected: &Inspected<'_>,
    sample: &InspectedSample,
    number: usize,
    met: &SurfaceMet,
) {
    let indent = if met.gather_ray.is_some() { "      " } else { "  " };
    let by = met.gather_ray.map_or(String::new(), |ray| format!("gather ray {ray}, "));
    let (shape, material) = inspected.shape(met.shape);
    let _ = writeln!(
        out,
        "{indent}{by}segment {}: \"{shape}\" ({material}) at {}, normal {}, throughput {}",
        met.depth,
        vector(met.position),
        vector(met.normal),
        rgb(met.throughput)
    );
    let indent = format!("{indent}  ");
    lights(out, sample, Some(number), &indent);
    for l in sample.look_ups.iter().filter(|l| l.surface == number) {
        let _ = writeln!(
            out,
            "{indent}{} map: {} within {}",
            l.map.name(),
            plural(u64::from(l.count), "photon"),
            l.radius
        );
        for c in &l.contributions {
            contribution(out, inspected, &indent, (c.light, c.bounces), (c.photons, c.radiance, c.part));
        }
    }
}

/// A medium that was passed, with what it brings: of light of which it brings none, nothing is told.
fn medium(out: &mut String, inspected: &Inspected<'_>, passed: &MediumPassed) {
    let indent = if passed.gather_ray.is_some() { "      " } else { "  " };
    let by = passed.gather_ray.map_or(String::new(), |ray| format!("gather ray {ray}, "));
    let _ = writeln!(
        out,
        "{indent}{by}segment {}: medium \"{}\" for {}, transmittance {}",
        passed.depth,
        inspected.medium(passed.medium),
        passed.length,
        rgb(passed.transmittance)
    );
    let light = &passed.light;
    for (what, radiance) in
        [("given off", light.emitted), ("scattered once, by rays", light.single), ("ambient", light.ambient)]
    {
        if !radiance.is_black() {
            let _ = writeln!(out, "{indent}  {what}: {}", rgb(radiance));
        }
    }
    for (map, found) in [(MapName::Volume, light.volume), (MapName::VolumeCaustic, light.volume_caustic)] {
        if found.count > 0 {
            let counted = plural(u64::from(found.count), inspected.stored_in_media());
            let _ = writeln!(out, "{indent}  {} map: {} by {counted}", map.name(), rgb(found.radiance));
        }
    }
}

/// Light that was found without photons at a surface, or that shines by itself.
fn lights(out: &mut String, sample: &InspectedSample, surface: Option<usize>, indent: &str) {
    for ray in sample.rays.iter().filter(|ray| ray.surface == surface) {
        let what = if ray.part == LightPart::Emitted { "shines by itself" } else { "by rays" };
        let _ = writeln!(out, "{indent}{} {what}: {}", part(ray.part), rgb(ray.radiance));
    }
}

fn contribution(
    out: &mut String,
    inspected: &Inspected<'_>,
    indent: &str,
    (light, bounces): (u32, Bounces),
    (photons, radiance, name): (u32, Rgb, LightPart),
) {
    let light = inspected.light(light);
    let _ = writeln!(
        out,
        "{indent}  {:<8} from \"{light}\": {} {} by {}",
        bounces.to_string(),
        part(name),
        rgb(radiance),
        plural(u64::from(photons), "photon")
    );
}

/// Everything that gather rays brought, in a few lines.
fn gathered(out: &mut String, inspected: &Inspected<'_>, sample: &InspectedSample) {
    let of_ray = |surface: usize| sample.surfaces[surface].gather_ray;
    let rays: std::collections::BTreeSet<u64> = sample.surfaces.iter().filter_map(|s| s.gather_ray).collect();
    if rays.is_empty() {
        return;
    }
    let look_ups: Vec<&LookUpReport> =
        sample.look_ups.iter().filter(|l| of_ray(l.surface).is_some()).collect();
    let direct: Rgb = sample
        .rays
        .iter()
        .filter(|r| r.surface.is_some_and(|s| of_ray(s).is_some()))
        .map(|r| r.radiance)
        .sum();
    let _ = writeln!(
        out,
        "  {} met surfaces and made {} (--sample tells of each)",
        plural(rays.len() as u64, "gather ray"),
        plural(look_ups.len() as u64, "look-up")
    );
    let _ = writeln!(out, "    global by rays: {}", rgb(direct));
    let mut sums: BTreeMap<(u32, Bounces), (u32, Rgb)> = BTreeMap::new();
    for c in look_ups.iter().flat_map(|l| &l.contributions) {
        let sum = sums.entry((c.light, c.bounces)).or_insert((0, Rgb::BLACK));
        *sum = (sum.0 + c.photons, sum.1 + c.radiance);
    }
    for (source, (photons, radiance)) in sums {
        contribution(out, inspected, "  ", source, (photons, radiance, LightPart::Global));
    }
}

fn rgb(v: Rgb) -> String {
    let [r, g, b] = v.to_array();
    format!("{r:.6} {g:.6} {b:.6}")
}

fn vector(v: Vec3) -> String {
    // Without a sign of zero.
    let v = v + Vec3::ZERO;
    format!("({}, {}, {})", v.x, v.y, v.z)
}
