//! Which integrator renders, and with which parameters.

use nephroid::integrator::{AutoConfig, LightTracerConfig, Method, PathConfig, PpmConfig, VcmConfig};
use nephroid_formats::diagnostic::{Diagnostic, Diagnostics, Severity};
use nephroid_formats::{IntegratorRequest, ParameterValue, SceneFile};
use serde_json::{Map, Value, json};

use crate::console::Messages;
use crate::exit::Failure;
use crate::media_flags;
use crate::parameters::{Draft, PARAMETERS, Parameter, PhotonFlags};

/// An integrator that can be asked for by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Photon mapping.
    PhotonMapper,
    /// Progressive photon mapping.
    Ppm,
    /// Whatever trials find best.
    Auto,
    /// Vertex connection and merging.
    Vcm,
    /// Path tracing.
    Path,
    /// Path tracing through media.
    VolPath,
    /// Light tracing to the camera.
    PTracer,
    /// What the scene says.
    Scene,
}

impl Integrator {
    /// The integrator of a name on the command line.
    pub fn parse(name: &str) -> Result<Self, String> {
        match name {
            "photonmapper" => Ok(Self::PhotonMapper),
            "ppm" => Ok(Self::Ppm),
            "auto" => Ok(Self::Auto),
            "vcm" => Ok(Self::Vcm),
            "path" => Ok(Self::Path),
            "volpath" => Ok(Self::VolPath),
            "ptracer" => Ok(Self::PTracer),
            "scene" => Ok(Self::Scene),
            _ => Err("it must be auto, photonmapper, ppm, vcm, path, volpath, ptracer or scene".to_owned()),
        }
    }
}

/// Settles the integrator: what the command line says; else the scene's, if it is one for photons;
/// else the default, or the photon mapper where flags ask for what only that has. Parameters of the scene's integrator count for the others for photons, too.
pub fn choose(
    wanted: Option<Integrator>,
    file: &SceneFile,
    flags: &PhotonFlags,
    default: Integrator,
    messages: &mut Messages,
) -> Result<Method, Failure> {
    let request = &file.integrator;
    let chosen = match wanted {
        Some(Integrator::Scene) => by_scene(request)?,
        Some(other) => other,
        None => {
            of_file(request).unwrap_or(if asks_for_maps(flags) { Integrator::PhotonMapper } else { default })
        }
    };
    let mut draft = Draft::default();
    let complaints = match request.name.as_str() {
        "photonmapper" | "ppm" | "vcm" | "auto" => read_all(request, &mut draft),
        _ => read_depth(request, &mut draft),
    };
    let (errors, warnings): (Vec<_>, Vec<_>) =
        complaints.into_iter().partition(|d| d.severity == Severity::Error);
    if !errors.is_empty() {
        return Err(Failure::Scene(Diagnostics(errors)));
    }
    for warning in &warnings {
        messages.diagnostic(warning);
    }
    if !matches!(request.name.as_str(), "ppm" | "vcm" | "auto") {
        // Numbers that suit one pass are no reason not to plan.
        draft.forget_what_came_in();
    }
    for (parameter, value) in flags.iter() {
        // Checked when the command line was read.
        parameter.set(&mut draft, value).map_err(Failure::Usage)?;
    }
    if wanted.is_none() && of_file(request).is_none() && !request.name.is_empty() {
        messages.note(&format!(
            "the scene asks for the integrator \"{}\"; rendering with {} (see --integrator)",
            request.name,
            if chosen == Integrator::Auto { "auto" } else { "photonmapper" }
        ));
    }
    let plan_photons = !PHOTON_COUNTS.iter().any(|name| draft.has(name));
    let plan_neighbours = !draft.has("neighbours");
    let mut config = draft.finish();
    if chosen == Integrator::PTracer {
        let method = Method::LightTracer(LightTracerConfig { max_depth: config.max_depth });
        warn_of_foreign(flags, &method, messages);
        return Ok(method);
    }
    if matches!(chosen, Integrator::Path | Integrator::VolPath) {
        let media = chosen == Integrator::VolPath;
        let (max_depth, direct_lights) = (config.max_depth, config.direct_lights);
        let method = Method::Path(PathConfig { max_depth, direct_lights, media });
        warn_of_foreign(flags, &method, messages);
        if !media && file.scene.has_media() {
            messages.warning("the integrator path takes no notice of media; volpath is the one that does");
        }
        return Ok(method);
    }
    media_flags::settle(&mut config, file, flags, messages)?;
    if chosen == Integrator::Vcm {
        let method = Method::Vcm(VcmConfig { mapper: config, ..VcmConfig::default() });
        warn_of_foreign(flags, &method, messages);
        return Ok(method);
    }
    let ppm = |mapper| PpmConfig { mapper, plan_photons, plan_neighbours, samples_per_pixel: None };
    Ok(match chosen {
        Integrator::Auto => Method::Auto(AutoConfig { maps_only: false, ppm: ppm(config) }),
        Integrator::Ppm => Method::Ppm(ppm(config)),
        _ => Method::PhotonMapper(config),
    })
}

/// The same method where what photon maps tell is asked for.
pub fn maps_only(method: Method) -> Method {
    match method {
        Method::Auto(config) => Method::Auto(AutoConfig { maps_only: true, ..config }),
        other => other,
    }
}

/// The flags of photon mapping that vertex connection and merging knows: what media scatter to the camera it estimates alike.
const OF_VCM: [&str; 9] = [
    "--max-depth",
    "--emit-max",
    "--single-scatter",
    "--volume-photons",
    "--volume-kind",
    "--volume-estimate",
    "--volume-neighbours",
    "--beam-crossings",
    "--march-step",
];

/// The integrator of a file, if it is one of ours for photons.
fn of_file(request: &IntegratorRequest) -> Option<Integrator> {
    match request.name.as_str() {
        "photonmapper" => Some(Integrator::PhotonMapper),
        "ppm" => Some(Integrator::Ppm),
        "vcm" => Some(Integrator::Vcm),
        "auto" => Some(Integrator::Auto),
        _ => None,
    }
}

/// Whether flags are given that say how photons are stored and looked up on surfaces.
fn asks_for_maps(flags: &PhotonFlags) -> bool {
    const SHARED: [&str; 2] = ["--max-depth", "--direct-lights"];
    flags.names().iter().any(|flag| !SHARED.contains(&flag.as_str()))
}

/// Parameters that say how many photons to emit; a progressive render plans that where none is given.
const PHOTON_COUNTS: [&str; 4] = ["photons", "caustic-photons", "emit", "volume-photons"];

/// Of these flags of photon mapping those that an integrator does not know.
pub fn foreign(flags: &[String], method: &Method) -> Vec<String> {
    let known: &[&str] = match method {
        Method::PhotonMapper(_) | Method::Ppm(_) | Method::Auto(_) => return Vec::new(),
        Method::Vcm(_) => &OF_VCM,
        Method::Path(_) => &["--max-depth", "--direct-lights"],
        Method::LightTracer(_) => &["--max-depth"],
    };
    flags.iter().filter(|flag| !known.contains(&flag.as_str())).cloned().collect()
}

/// Warns of flags that an integrator does not know.
fn warn_of_foreign(flags: &PhotonFlags, method: &Method, messages: &mut Messages) {
    let foreign = foreign(&flags.names(), method);
    if !foreign.is_empty() {
        let name = method.name();
        messages.warning(&format!("{} mean nothing to the integrator {name}", foreign.join(", ")));
    }
}

/// The scene's word.
fn by_scene(request: &IntegratorRequest) -> Result<Integrator, Failure> {
    match request.name.as_str() {
        "" | "photonmapper" => Ok(Integrator::PhotonMapper),
        "ppm" => Ok(Integrator::Ppm),
        "vcm" => Ok(Integrator::Vcm),
        "auto" => Ok(Integrator::Auto),
        "path" => Ok(Integrator::Path),
        "volpath" | "volpathmis" => Ok(Integrator::VolPath),
        "ptracer" => Ok(Integrator::PTracer),
        other => {
            let message = format!("the integrator \"{other}\" cannot be rendered with");
            let diagnostic = match &request.location {
                Some(location) => Diagnostic::error(location, message),
                None => Diagnostic::global_error(message),
            };
            let hint = "without --integrator scene, auto takes its place";
            Err(Failure::Scene(Diagnostics(vec![diagnostic.hint(hint)])))
        }
    }
}

/// Reads every parameter of the photon mapper.
fn read_all(request: &IntegratorRequest, draft: &mut Draft) -> Vec<Diagnostic> {
    let mut complaints = Vec::new();
    for parameter in PARAMETERS {
        read(request, draft, parameter, &mut complaints);
    }
    complaints.extend(request.unused());
    complaints
}

/// Reads how long paths may be for another renderer's integrator. What else it says is its own
/// business; but what no integrator knows may be a mistake.
fn read_depth(request: &IntegratorRequest, draft: &mut Draft) -> Vec<Diagnostic> {
    let mut complaints = Vec::new();
    for depth in PARAMETERS.iter().filter(|p| p.name_in_files() == "max_depth") {
        read(request, draft, depth, &mut complaints);
    }
    let unknown = request.unused().into_iter().filter(|d| d.severity == Severity::Error);
    complaints.extend(unknown.map(|d| Diagnostic { severity: Severity::Warning, ..d }));
    complaints
}

/// Reads a parameter, if the scene gives it.
fn read(
    request: &IntegratorRequest,
    draft: &mut Draft,
    parameter: &Parameter,
    complaints: &mut Vec<Diagnostic>,
) {
    let name = parameter.name_in_files();
    // Whatever its type, asking marks it as used, and as one that could have been given.
    let _ = request.get_string(&name);
    let Some(given) = request.parameters.iter().find(|p| p.name == name) else { return };
    let value = match &given.value {
        ParameterValue::Int(v) => v.to_string(),
        ParameterValue::Float(v) => v.to_string(),
        ParameterValue::Bool(v) => v.to_string(),
        ParameterValue::Text(v) => v.clone(),
    };
    if let Err(reason) = parameter.set(draft, &value) {
        let message = format!("a bad value for \"{name}\": {reason}");
        complaints.push(Diagnostic::error(&given.location, message));
    }
}

/// The method with its parameters.
pub fn describe(method: &Method) -> Value {
    let mut object = Map::new();
    object.insert("name".to_owned(), json!(method.name()));
    match method {
        Method::PhotonMapper(config) => {
            object.extend(PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(config))));
        }
        Method::Ppm(PpmConfig { mapper, plan_photons, plan_neighbours, .. }) => {
            object.extend(PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(mapper))));
            object.insert("plan_photons".to_owned(), json!(plan_photons));
            object.insert("plan_neighbours".to_owned(), json!(plan_neighbours));
        }
        Method::Auto(AutoConfig { maps_only, ppm }) => {
            object.insert("maps_only".to_owned(), json!(maps_only));
            let PpmConfig { mapper, plan_photons, plan_neighbours, .. } = ppm;
            object.extend(PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(mapper))));
            object.insert("plan_photons".to_owned(), json!(plan_photons));
            object.insert("plan_neighbours".to_owned(), json!(plan_neighbours));
        }
        Method::Vcm(VcmConfig { mapper, light_paths, connections, merging, correlation }) => {
            object.extend(PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(mapper))));
            object.insert("light_paths".to_owned(), json!(light_paths));
            object.insert("connections".to_owned(), json!(connections));
            object.insert("merging".to_owned(), json!(merging));
            object.insert("correlation".to_owned(), json!(correlation));
        }
        Method::Path(PathConfig { max_depth, direct_lights, .. }) => {
            let config = nephroid::integrator::PhotonMapperConfig {
                max_depth: *max_depth,
                direct_lights: *direct_lights,
                ..Default::default()
            };
            let shared = PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(&config)));
            object.extend(shared.filter(|(name, _)| matches!(name.as_str(), "max_depth" | "direct_lights")));
        }
        Method::LightTracer(LightTracerConfig { max_depth }) => {
            let config =
                nephroid::integrator::PhotonMapperConfig { max_depth: *max_depth, ..Default::default() };
            let shared = PARAMETERS.iter().map(|p| (p.name_in_files(), p.get(&config)));
            object.extend(shared.filter(|(name, _)| name == "max_depth"));
        }
    }
    Value::Object(object)
}
