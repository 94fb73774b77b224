//! What is known of extensions by name.

use super::item::Item;

/// Those that are read, or change no picture.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_instance_features",
    "AGI_articulations",
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "MSFT_lod",
];

/// Those without which a picture is still much as it was meant.
const LOOKS: &[&str] = &[
    "KHR_materials_diffuse_transmission",
    "KHR_materials_iridescence",
    "KHR_materials_volume_scatter",
    "KHR_materials_subsurface",
    "KHR_materials_diffuse_roughness",
    "KHR_materials_coat",
    "KHR_materials_fuzz",
    "EXT_lights_image_based",
    "EXT_lights_ies",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// Those that hide the data of a model, and what a user can do.
const PACKED: &[(&str, &str)] = &[
    ("KHR_draco_mesh_compression", "export the model again without mesh compression (Draco)"),
    (
        "EXT_meshopt_compression",
        "export the model again without mesh compression (meshopt), as with gltfpack without -c and -cc",
    ),
    ("KHR_meshopt_compression", "export the model again without mesh compression (meshopt)"),
    ("KHR_texture_basisu", "export the model again with PNG or JPEG textures, not KTX2"),
    ("EXT_texture_webp", "export the model again with PNG or JPEG textures, not WebP"),
    ("EXT_texture_avif", "export the model again with PNG or JPEG textures, not AVIF"),
    ("MSFT_texture_dds", "export the model again with PNG or JPEG textures, not DDS"),
];

/// Says which extensions are not read: an error where the model cannot do without.
pub(super) fn check(root: Item, lenient: bool) {
    let required = root.list("extensionsRequired");
    for item in &required {
        let Some(name) = item.as_text().filter(|name| !READ.contains(name)) else { continue };
        let message = format!("the model requires the extension {name}, which is not read");
        if let Some((_, hint)) = PACKED.iter().find(|(packed, _)| *packed == name) {
            item.error_with_hint(message, *hint);
        } else if lenient || LOOKS.contains(&name) {
            item.warn(format!("{message}; the picture is not quite what is meant"));
        } else {
            item.error_with_hint(message, "export the model again without it, or try --lenient");
        }
    }
    for item in root.list("extensionsUsed") {
        let Some(name) = item.as_text().filter(|name| !READ.contains(name)) else { continue };
        let is_required = required.iter().any(|other| other.as_text() == Some(name));
        // What stands for a packed part is looked for where it is needed.
        let has_own_message =
            PACKED.iter().any(|(packed, _)| *packed == name) || name == "KHR_materials_iridescence";
        if !is_required && !has_own_message {
            item.warn(format!("the extension {name} is not read"));
        }
    }
}
