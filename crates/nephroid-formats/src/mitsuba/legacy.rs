//! Scenes of Mitsuba 0.4 to 0.6, made to say the same in the words of Mitsuba 3. The rest of the reader knows
//! those alone.

use nephroid::color::srgb;

use super::document::{Attribute, Element};
use crate::number::floats;

/// Properties with another name, after their spelling: of which element and type, the old name, the new.
const RENAMED: [(&str, &str, &str, &str); 1] = [("medium", "heterogeneous", "density", "sigma_t")];

/// What used to go without saying.
struct Unsaid {
    tag: &'static str,
    kind: &'static str,
    /// Any of these says otherwise.
    unless: &'static [&'static str],
    /// The property that says it now: its element, name and value.
    property: [&'static str; 3],
}

const UNSAID: [Unsaid; 4] = [
    Unsaid {
        tag: "volume",
        kind: "gridvolume",
        unless: &["use_grid_bbox"],
        property: ["boolean", "use_grid_bbox", "true"],
    },
    Unsaid {
        tag: "medium",
        kind: "homogeneous",
        unless: &["material", "sigma_s", "sigma_a", "sigma_t", "albedo"],
        property: ["string", "material", "skin1"],
    },
    Unsaid {
        tag: "bsdf",
        kind: "conductor",
        unless: &["material", "eta", "k"],
        property: ["string", "material", "Cu"],
    },
    Unsaid {
        tag: "bsdf",
        kind: "roughconductor",
        unless: &["material", "eta", "k"],
        property: ["string", "material", "Cu"],
    },
];

/// Rewrites an element and all in it. `count` numbers elements that are added.
pub(super) fn upgrade(element: &mut Element, count: &mut usize) {
    for child in &mut element.children {
        upgrade(child, count);
    }
    if !element.is_legacy {
        return;
    }
    if element.tag == "lookAt" {
        element.tag = "lookat".to_owned();
    }
    if let Some(name) = element.attributes.iter_mut().find(|a| a.name == "name") {
        name.value = snake_case(&name.value);
    }
    colour(element);
    let kind = element.value_of("type").unwrap_or_default().to_owned();
    for (tag, of_kind, old, new) in RENAMED {
        if element.tag == tag && kind == of_kind {
            let names = element.children.iter_mut().flat_map(|child| &mut child.attributes);
            for name in names.filter(|a| a.name == "name" && a.value == old) {
                name.value = new.to_owned();
            }
        }
    }
    // It told which version of an integrator wrote the file.
    if element.tag == "integrator" {
        element.children.retain(|child| child.value_of("name") != Some("version"));
    }
    for Unsaid { tag, kind: of_kind, unless, property: [property, name, value] } in &UNSAID {
        if element.tag == *tag && kind == *of_kind && !unless.iter().any(|name| names(element, name)) {
            add(element, property, &[("name", name), ("value", value)], count);
        }
    }
    if element.tag == "texture" {
        texture_transform(element, count);
    }
    if element.tag == "shape" && is_mere_boundary(element) {
        add(element, "bsdf", &[("type", "null")], count);
    }
}

/// `intIOR` becomes `int_ior`.
fn snake_case(name: &str) -> String {
    let mut out = String::new();
    let mut after_small = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && after_small {
            out.push('_');
        }
        // The first of a run of capitals decides; `B` alone is a name.
        let lower = c.is_ascii_uppercase() && !out.is_empty();
        out.push(if lower { c.to_ascii_lowercase() } else { c });
        after_small = c.is_ascii_lowercase() || c.is_ascii_digit();
    }
    out
}

/// Numbers without wavelengths are RGB, one for all channels or three.
fn colour(element: &mut Element) {
    let Some(value) = element.attributes.iter_mut().find(|a| a.name == "value") else { return };
    match element.tag.as_str() {
        "spectrum" if !value.value.contains(':') => element.tag = "rgb".to_owned(),
        "srgb" => {
            element.tag = "rgb".to_owned();
            // `#rrggbb` is decoded where all of its kind are.
            if let Ok(encoded) = floats(&value.value) {
                let linear = encoded.iter().map(|v| srgb::decode(*v as f32).to_string());
                value.value = linear.collect::<Vec<_>>().join(" ");
            }
        }
        _ => {}
    }
}

fn names(element: &Element, name: &str) -> bool {
    element.children.iter().any(|child| child.value_of("name") == Some(name))
}

/// Whether a shape separates media and has no material, nor gives light.
fn is_mere_boundary(shape: &Element) -> bool {
    let is_side = |child: &Element| matches!(child.value_of("name"), Some("interior" | "exterior"));
    let is_more = |child: &Element| {
        matches!(child.tag.as_str(), "bsdf" | "emitter" | "subsurface")
            || child.tag == "ref" && !is_side(child)
    };
    shape.children.iter().any(is_side) && !shape.children.iter().any(is_more)
}

/// A texture's four numbers become the transform that they are.
fn texture_transform(texture: &mut Element, count: &mut usize) {
    let value = |name: &str| {
        let of = texture.children.iter().find(|child| child.value_of("name") == Some(name))?;
        of.value_of("value").map(str::to_owned)
    };
    let numbers = ["uscale", "vscale", "uoffset", "voffset"].map(value);
    if numbers.iter().all(Option::is_none) || names(texture, "to_uv") {
        return;
    }
    let is_number = |name: Option<&str>| matches!(name, Some("uscale" | "vscale" | "uoffset" | "voffset"));
    texture.children.retain(|child| !is_number(child.value_of("name")));
    let [uscale, vscale, uoffset, voffset] = &numbers;
    let step = |x: &Option<String>, y: &Option<String>| -> Vec<(&str, String)> {
        [("x", x), ("y", y)].into_iter().filter_map(|(axis, v)| Some((axis, v.clone()?))).collect()
    };
    let [scale, translate] = [step(uscale, vscale), step(uoffset, voffset)];
    let transform = add(texture, "transform", &[("name", "to_uv")], count);
    for (tag, attributes) in [("scale", scale), ("translate", translate)] {
        let attributes: Vec<_> = attributes.iter().map(|(axis, value)| (*axis, value.as_str())).collect();
        add(transform, tag, &attributes, count);
    }
}

/// Puts an element into another, where messages will say it is, and returns it.
fn add<'e>(
    to: &'e mut Element,
    tag: &str,
    attributes: &[(&str, &str)],
    count: &mut usize,
) -> &'e mut Element {
    *count += 1;
    let location = &to.location;
    let attribute = |(name, value): &(&str, &str)| Attribute {
        name: (*name).to_owned(),
        value: (*value).to_owned(),
        location: location.clone(),
    };
    let added = Element {
        number: *count,
        tag: tag.to_owned(),
        location: location.clone(),
        attributes: attributes.iter().map(attribute).collect(),
        children: Vec::new(),
        is_legacy: true,
    };
    to.children.push(added);
    let last = to.children.len() - 1;
    &mut to.children[last]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("sigmaA", "sigma_a"),
            ("flipTexCoords", "flip_tex_coords"),
            ("color0", "color0"),
            ("B", "B"),
            ("fov_axis", "fov_axis"),
            ("", ""),
        ] {
            assert_eq!(snake_case(old), new);
        }
    }
}
