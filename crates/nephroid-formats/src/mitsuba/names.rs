//! The names that Mitsuba scenes use: to tell what is not built yet from what is misspelt.

/// Elements that are plugins.
pub(super) const OBJECT_TAGS: [&str; 12] = [
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "integrator",
    "shape",
    "bsdf",
    "emitter",
    "texture",
    "medium",
    "phase",
    "volume",
];

/// Elements that are values of properties.
pub(super) const PROPERTY_TAGS: [&str; 10] =
    ["boolean", "integer", "float", "string", "point", "vector", "rgb", "spectrum", "transform", "ref"];

/// Properties of the plugins of Mitsuba, in the spelling of its versions 2 and 3, sorted.
#[rustfmt::skip]
pub(super) const PROPERTY_NAMES: &[&str] = &[
    "B", "C", "S", "accel", "albedo", "allow_thread_reordering", "allow_transmission", "alpha",
    "alpha_sample", "alpha_u", "alpha_v", "ambient", "anisotropic", "aovs", "aperture_radius",
    "attach_log", "azimuthal_roughness", "banner", "base_color", "beam_width", "bitmap", "block_size",
    "bsdf", "bsdf_samples", "burn", "cache", "center", "centers", "channel", "channel_names",
    "clearcoat", "clearcoat_gloss", "clearcoat_sampling_rate", "collapse", "color", "color0", "color1",
    "compensate", "complex_sun", "component_format", "crop_height", "crop_offset_x", "crop_offset_y",
    "crop_width", "cutoff_angle", "data", "day", "delta", "diff_trans", "diffuse_reflectance",
    "diffuse_reflectance_sampling_rate", "diffuse_transmittance_sampling_rate", "digits", "dimension",
    "direction", "distribution", "emission", "emitter", "emitter_samples", "end_day", "end_month",
    "end_year", "eta", "eumelanin", "exponent", "exposure", "ext_eta", "ext_ior", "extend", "extent",
    "exterior", "face_normals", "far_clip", "file_format", "filename", "filter_type", "flatness",
    "flip_invalid_normals", "flip_normals", "flip_tex_coords", "focal_length", "focus_distance",
    "format", "fov", "fov_axis", "g", "gamma", "grid", "guiding", "guiding_proj", "guiding_rounds",
    "has_spectral_extinction", "height", "hide_emitters", "high_quality_edges", "hour", "int_ior",
    "intensity", "interior", "irradiance", "jitter", "k", "key", "latitude", "left_handed",
    "line_width", "lobes", "longitude", "longitudinal_roughness", "main_specular_sampling_rate",
    "majorant_factor", "majorant_grid", "majorant_resolution_factor", "material", "max_anisotropy",
    "max_depth", "max_smooth_angle", "max_value", "medium", "metallic", "method", "minute",
    "mis_compensation", "month", "near_clip", "nested_bsdf", "nonlinear", "normalmap", "normals",
    "opacity", "origin", "p0", "p1", "pheomelanin", "pixel_format", "polarizing", "position", "power",
    "preserve_colors", "principal_point_offset_x", "principal_point_offset_y", "priority",
    "project_seed", "quaternions", "radiance", "radius", "range", "raw", "reflectance", "resolution",
    "roughness", "rr_depth", "sample_border", "sample_count", "sample_emitters", "sample_visible",
    "samples_per_pass", "samples_per_pixel", "sampling_weight", "scale", "scale_factor", "scale_tilt",
    "scales", "scramble", "second", "seed", "shading_samples", "shape_index", "sheen", "sheen_tint",
    "shutter_close", "shutter_open", "sigma_a", "sigma_s", "sigma_t", "silhouette_sampling_weight",
    "size", "sky_scale", "spec_tint", "spec_trans", "specular", "specular_reflectance",
    "specular_reflectance_sampling_rate", "specular_sampling_weight", "specular_transmittance",
    "specular_transmittance_sampling_rate", "sppc", "sppi", "sppp", "srf", "srgb_primitives",
    "start_day", "start_month", "start_year", "stddev", "step_size", "strength", "stretch",
    "strict_normals", "sun_aperture", "sun_direction", "sun_radius_scale", "sun_scale", "target",
    "temperature", "texture", "theta", "thickness", "timeout", "timezone", "to_uv", "to_world",
    "tonemap_method", "transmittance", "turbidity", "unbounded", "uoffset", "uscale", "use_grid_bbox",
    "use_shadowing_function", "use_spectral_mis", "value", "values", "variable", "variant", "voffset",
    "volume", "vscale", "wavelength", "wavelength_max", "wavelength_min", "wavelengths", "weight",
    "weights", "width", "window_end_time", "window_start_time", "wrap_mode", "wrap_mode_u",
    "wrap_mode_v", "year",
];

/// Whether some plugin has a property of this name.
pub(super) fn property_is_known(name: &str) -> bool {
    PROPERTY_NAMES.binary_search(&name).is_ok()
}

pub(super) const SENSORS_LATER: &[&str] =
    &["irradiancemeter", "radiancemeter", "distant", "batch", "spherical", "fluencemeter"];

pub(super) const FILMS_LATER: &[&str] = &["specfilm", "mfilm", "tiledhdrfilm"];

pub(super) const SAMPLERS: &[&str] =
    &["independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "hammersley", "sobol"];

pub(super) const FILTERS_LATER: &[&str] = &["catmullrom", "lanczos"];

pub(super) const SHAPES: &[&str] = &[
    "sphere",
    "rectangle",
    "disk",
    "cylinder",
    "cube",
    "obj",
    "ply",
    "plane",
    "serialized",
    "shapegroup",
    "instance",
];

pub(super) const SHAPES_LATER: &[&str] = &[
    "sdfgrid",
    "bsplinecurve",
    "linearcurve",
    "ellipsoids",
    "ellipsoidsmesh",
    "merge",
    "hair",
    "heightfield",
    "blender",
];

pub(super) const BSDFS: &[&str] = &[
    "diffuse",
    "phong",
    "conductor",
    "roughconductor",
    "dielectric",
    "thindielectric",
    "roughdielectric",
    "plastic",
    "roughplastic",
    "pplastic",
    "principled",
    "principledthin",
    "twosided",
    "mask",
    "blendbsdf",
    "mixturebsdf",
    "bumpmap",
    "normalmap",
    "coating",
    "roughcoating",
    "difftrans",
    "ward",
    "null",
];

/// Those whose nearest simple material is diffuse.
pub(super) const BSDFS_LIKE_DIFFUSE: &[&str] =
    &["roughdiffuse", "hk", "irawan", "measured", "measured_polarized", "hair"];

/// Those that filter polarised light.
pub(super) const BSDFS_LIKE_NULL: &[&str] = &["polarizer", "retarder", "circular"];

pub(super) const EMITTERS: &[&str] = &[
    "point",
    "area",
    "spot",
    "directional",
    "constant",
    "envmap",
    "projector",
    "sky",
    "sun",
    "sunsky",
    "ies",
    "collimated",
];

pub(super) const EMITTERS_LATER: &[&str] = &["timed_sunsky"];

pub(super) const TEXTURES: &[&str] = &[
    "bitmap",
    "ldrtexture",
    "checkerboard",
    "mesh_attribute",
    "vertexcolors",
    "scale",
    "rawconstant",
    "uniform",
    "srgb",
];

pub(super) const TEXTURES_LATER: &[&str] = &["volume", "gridtexture", "wireframe", "curvature", "d65"];

pub(super) const MEDIA: &[&str] = &["homogeneous", "heterogeneous"];

pub(super) const VOLUMES: &[&str] = &["constvolume", "gridvolume"];

pub(super) const VOLUMES_LATER: &[&str] = &["openvdb", "hgridvolume", "volcache"];

pub(super) const PHASES: &[&str] = &["isotropic", "hg", "rayleigh"];

pub(super) const PHASES_LATER: &[&str] =
    &["microflake", "sggx", "blendphase", "mixturephase", "tabphase", "tabphase_irregular", "kkay"];

pub(super) const SPECTRA: &[&str] =
    &["uniform", "d65", "rawconstant", "srgb", "blackbody", "regular", "irregular"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_are_sorted() {
        assert!(PROPERTY_NAMES.windows(2).all(|w| w[0] < w[1]));
        assert!(property_is_known("alpha") && !property_is_known("alhpa"));
    }
}
