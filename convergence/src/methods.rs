//! Every method, and what it can do: the lists of tests are made of these.

use nephroid::integrator::{
    AutoConfig, LightTracerConfig, Method, PathConfig, PhotonMapperConfig, PpmConfig, VcmConfig,
};

use crate::progressive;

/// A method, and what it can do.
#[derive(Clone, Debug, PartialEq)]
pub struct Contestant {
    /// With its configuration.
    pub method: Method,
    /// Whether it knows of media.
    pub media: bool,
    /// Whether all that is seen in mirrors and through glass is in its pictures.
    pub behind_glass: bool,
    /// Whether it finds the light that small and distant lamps send through glass and over mirrors.
    pub caustics: bool,
    /// Whether it estimates densities, which is biased where light is not the same all around.
    pub blurs: bool,
}

/// Every method without limits but those of `mapper`: its photons, its neighbours and its longest path.
pub fn every_method(mapper: &PhotonMapperConfig) -> Vec<Contestant> {
    let max_depth = mapper.max_depth;
    let path = |media| Method::Path(PathConfig { max_depth, media, ..PathConfig::default() });
    let photons =
        |method| Contestant { method, media: true, behind_glass: true, caustics: true, blurs: true };
    vec![
        Contestant { method: path(false), media: false, behind_glass: true, caustics: false, blurs: false },
        Contestant { method: path(true), media: true, behind_glass: true, caustics: false, blurs: false },
        Contestant {
            method: Method::LightTracer(LightTracerConfig { max_depth }),
            media: true,
            behind_glass: false,
            caustics: true,
            blurs: false,
        },
        photons(Method::PhotonMapper(mapper.clone())),
        photons(progressive(mapper.clone())),
        photons(Method::Vcm(VcmConfig { mapper: mapper.clone(), ..VcmConfig::default() })),
        photons(Method::Auto(AutoConfig {
            ppm: PpmConfig { mapper: mapper.clone(), ..PpmConfig::default() },
            ..AutoConfig::default()
        })),
    ]
}

/// Every method but those of some names, which would take long and say nothing new.
pub fn every_method_but(left_out: &[&str], mapper: &PhotonMapperConfig) -> Vec<Contestant> {
    let mut methods = every_method(mapper);
    methods.retain(|contestant| !left_out.contains(&contestant.method.name()));
    methods
}
