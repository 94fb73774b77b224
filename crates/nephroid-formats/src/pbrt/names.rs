//! The names that pbrt's scenes use: to tell what is out of place from what is misspelt.

/// Every directive.
#[rustfmt::skip]
pub(super) const DIRECTIVES: &[&str] = &[
    "Accelerator", "ActiveTransform", "AreaLightSource", "Attribute", "AttributeBegin", "AttributeEnd", "Camera",
    "ColorSpace", "ConcatTransform", "CoordSysTransform", "CoordinateSystem", "Film", "Identity", "Import",
    "Include", "Integrator", "LightSource", "LookAt", "MakeNamedMaterial", "MakeNamedMedium", "Material",
    "MediumInterface", "NamedMaterial", "ObjectBegin", "ObjectEnd", "ObjectInstance", "Option", "PixelFilter",
    "Renderer", "ReverseOrientation", "Rotate", "Sampler", "Scale", "Shape", "SurfaceIntegrator", "Texture",
    "Transform", "TransformBegin", "TransformEnd", "TransformTimes", "Translate", "VolumeIntegrator", "WorldBegin",
    "WorldEnd",
];

/// Parameters of pbrt's versions 3 and 4, sorted.
#[rustfmt::skip]
const PARAMETERS: &[&str] = &[
    "B", "C", "I", "Kd", "Kr", "Ks", "Kt", "L", "Le", "Lescale", "N", "P", "S", "albedo", "alpha",
    "amount", "aperture", "aperturediameter", "basis", "beta_m", "beta_n", "bootstrapsamples",
    "bsdffile", "bumpmap", "chains", "color", "conductor.eta", "conductor.k", "conductor.roughness",
    "conductor.uroughness", "conductor.vroughness", "coneangle", "conedelta", "conedeltaangle",
    "cropwindow", "curvatureradius", "degree", "density", "diagonal", "dimension", "dir",
    "displacement", "edgelength", "emissionfilename", "encoding", "eta", "eumelanin", "faceIndices",
    "filename", "filter", "focaldistance", "focusdistance", "fov", "frameaspectratio", "frequency",
    "from", "g", "gamma", "gridname", "height", "hide", "illuminance", "imagefile",
    "imagewritefrequency", "index", "indices", "innerradius", "inside", "interface.eta",
    "interface.roughness", "interface.uroughness", "interface.vroughness", "invert", "iso",
    "iterations", "k", "largestepprobability", "lensfile", "lensradius", "levels", "lightsampler",
    "lightsamplestrategy", "mapname", "mapping", "materials", "maxanisotropy", "maxcomponentvalue",
    "maxdepth", "maxiridepth", "maxsampleluminance", "mfp", "mutationsperpixel", "name",
    "namedmaterial1", "namedmaterial2", "nlevels", "normalmap", "nsamples", "numiterations", "nx",
    "ny", "nz", "octaves", "opacity", "outside", "p0", "p1", "pheomelanin", "phimax",
    "photonsperiteration", "pixelbounds", "pixelsamples", "portal", "power", "preset", "radius",
    "randomization", "reflect", "reflectance", "regularize", "remaproughness", "rotate", "roughness",
    "rrthreshold", "samplebsdf", "samplelights", "samples", "savePathDist", "savefp16", "scale",
    "scheme", "screenwindow", "seed", "sensor", "shutterclose", "shutteropen", "sigma", "sigma_a",
    "sigma_s", "spectrum", "specular", "splitdepth", "splitmethod", "st", "tau", "temperature",
    "temperaturecutoff", "temperaturename", "temperatureoffset", "temperaturescale", "tex", "tex1",
    "tex2", "thickness", "to", "transmit", "transmittance", "trilinear", "twosided", "type", "udelta",
    "uroughness", "uscale", "uv", "v00", "v01", "v1", "v10", "v11", "v2", "value", "variation",
    "vdelta", "visualizestrategies", "visualizeweights", "vroughness", "vscale", "whitebalance",
    "width", "width0", "width1", "wispiness", "wrap", "x0", "x1", "xradius", "xresolution", "xsamples",
    "xwidth", "y0", "y1", "yradius", "yresolution", "ysamples", "ywidth", "zmax", "zmin",
];

/// Whether something of the format has a parameter of this name.
pub(super) fn parameter_is_known(name: &str) -> bool {
    PARAMETERS.binary_search(&name).is_ok()
}

pub(super) const SHAPES: &[&str] =
    &["plymesh", "trianglemesh", "sphere", "disk", "cylinder", "bilinearmesh", "loopsubdiv"];

pub(super) const SHAPES_LATER: &[&str] =
    &["curve", "cone", "paraboloid", "hyperboloid", "heightfield", "heightfield2", "nurbs"];

pub(super) const MATERIALS: &[&str] = &[
    "diffuse",
    "dielectric",
    "thindielectric",
    "conductor",
    "coateddiffuse",
    "coatedconductor",
    "diffusetransmission",
    "mix",
    "interface",
];

/// Those whose nearest kin is another.
pub(super) const MATERIALS_APPROXIMATED: &[&str] = &["subsurface", "hair", "measured"];

/// Those of older files.
#[rustfmt::skip]
pub(super) const MATERIALS_OLD: &[&str] = &[
    "matte", "plastic", "substrate", "uber", "metal", "mirror", "glass", "translucent", "disney", "kdsubsurface",
    "fourier", "none", "",
];

pub(super) const TEXTURES: &[&str] = &["constant", "scale", "mix", "imagemap", "checkerboard"];

/// Those of which their mean is taken.
pub(super) const TEXTURES_LATER: &[&str] =
    &["bilerp", "directionmix", "dots", "fbm", "marble", "ptex", "windy", "wrinkled", "uv"];

pub(super) const LIGHTS: &[&str] = &["infinite", "distant", "point", "spot", "goniometric", "projection"];

pub(super) const MEDIA: &[&str] = &["homogeneous", "uniformgrid"];

pub(super) const MEDIA_LATER: &[&str] = &["rgbgrid", "cloud", "nanovdb"];

#[rustfmt::skip]
pub(super) const INTEGRATORS: &[&str] = &[
    "path", "volpath", "simplepath", "simplevolpath", "bdpt", "mlt", "sppm", "lightpath", "randomwalk",
    "ambientocclusion", "ao", "function", "directlighting", "whitted",
];

#[rustfmt::skip]
pub(super) const SAMPLERS: &[&str] = &[
    "independent", "halton", "sobol", "zsobol", "paddedsobol", "pmj02bn", "stratified", "random", "lowdiscrepancy",
    "02sequence", "maxmindist", "bestcandidate", "adaptive",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_sorted() {
        let wrong = PARAMETERS.windows(2).find(|w| w[0] >= w[1]);
        assert_eq!(wrong, None);
        assert!(parameter_is_known("reflectance") && !parameter_is_known("reflectence"));
    }
}
