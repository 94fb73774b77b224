//! Integrators by their names.

use nephroid::integrator::{
    AutoConfig, LightTracerConfig, Method, PathConfig, PhotonMapperConfig, PpmConfig, VcmConfig,
};
use nephroid_formats::SceneFile;

/// The integrator of a name, with its defaults.
pub fn method(name: &str, max_depth: Option<u32>) -> Option<Method> {
    Some(match name {
        "photonmapper" => Method::PhotonMapper(PhotonMapperConfig { max_depth, ..Default::default() }),
        "ppm" => {
            let mapper = PhotonMapperConfig { max_depth, ..Default::default() };
            Method::Ppm(PpmConfig { mapper, ..Default::default() })
        }
        "vcm" => {
            let mapper = PhotonMapperConfig { max_depth, ..Default::default() };
            Method::Vcm(VcmConfig { mapper, ..Default::default() })
        }
        "auto" => {
            let mapper = PhotonMapperConfig { max_depth, ..Default::default() };
            Method::Auto(AutoConfig { ppm: PpmConfig { mapper, ..Default::default() }, ..Default::default() })
        }
        "ptracer" => Method::LightTracer(LightTracerConfig { max_depth }),
        "path" => Method::Path(PathConfig { max_depth, ..Default::default() }),
        "volpath" => Method::Path(PathConfig { max_depth, media: true, ..Default::default() }),
        _ => return None,
    })
}

/// The names of a list with commas between them, all of which must be known.
pub fn known_names(list: &str) -> Result<Vec<String>, String> {
    let names: Vec<String> = list.split(',').map(str::to_string).collect();
    match names.iter().find(|name| method(name, None).is_none()) {
        Some(unknown) => Err(format!("no integrator is called {unknown}")),
        None => Ok(names),
    }
}

/// What a scene says of the longest path; less than nothing is no end.
pub fn max_depth(file: &SceneFile) -> Result<Option<u32>, String> {
    let depth = file.integrator.get_int("max_depth").map_err(|e| e.to_string())?;
    Ok(depth.and_then(|depth| u32::try_from(depth).ok()))
}
