//! The parameters of the photon mapper: one table for the flags of the command and the properties of
//! `<integrator type="photonmapper">`, which have the same names with underscores.

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use nephroid::integrator::{DirectSource, FinalGather, PhotonMapperConfig, Show, VolumeEstimate};
use nephroid::light::SphereSampling;
use nephroid::photon_map::Kernel;
use nephroid::transport::{DirectLights, Fog, LightChoice, VolumeKind};
use serde_json::{Value, json};

use crate::values::{boolean, count, depth, final_gather, kernel, length, name_of, number, one_of};

/// More photons than this fit in no map: it counts them with 32 bits, and a target may be exceeded.
const MAX_PHOTONS: u64 = 1_000_000_000;

/// A configuration while its parameters come in, in any order.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    config: PhotonMapperConfig,
    /// Kept apart, for it may come from the scene and the cone from the command line.
    cone_k: Option<f32>,
    /// Names of those that came in.
    given: Vec<&'static str>,
}

impl Draft {
    /// Has all that came in count as if it were the default.
    pub fn forget_what_came_in(&mut self) {
        self.given.clear();
    }

    /// Whether a parameter came in.
    pub fn has(&self, name: &str) -> bool {
        self.given.contains(&name)
    }

    /// The configuration. The slope of a cone means nothing to other kernels.
    pub fn finish(mut self) -> PhotonMapperConfig {
        if let (Kernel::Cone { k }, Some(slope)) = (&mut self.config.kernel, self.cone_k) {
            *k = slope;
        }
        self.config
    }
}

/// A parameter.
pub struct Parameter {
    /// Name of the flag. In files it has underscores.
    name: &'static str,
    /// What the help calls the value.
    value: &'static str,
    help: &'static str,
    set: fn(&mut Draft, &str) -> Result<(), String>,
    get: fn(&PhotonMapperConfig) -> Value,
}

const DIRECT: &[(&str, DirectSource)] = &[("rays", DirectSource::Rays), ("map", DirectSource::Map)];
const DIRECT_LIGHTS: &[(&str, DirectLights)] = &[("one", DirectLights::One), ("all", DirectLights::All)];
const LIGHT_CHOICE: &[(&str, LightChoice)] = &[("power", LightChoice::Power), ("equal", LightChoice::Equal)];
const SPHERE_SAMPLING: &[(&str, SphereSampling)] =
    &[("solid-angle", SphereSampling::SolidAngle), ("rejection", SphereSampling::Rejection)];
const SHOW: &[(&str, Show)] = &[
    ("all", Show::All),
    ("direct", Show::Direct),
    ("indirect", Show::Indirect),
    ("global", Show::Global),
    ("caustic", Show::Caustic),
    ("medium", Show::Medium),
];
const VOLUME_KIND: &[(&str, VolumeKind)] = &[("points", VolumeKind::Points), ("beams", VolumeKind::Beams)];
const VOLUME_ESTIMATE: &[(&str, VolumeEstimate)] = &[
    ("beam", VolumeEstimate::Beam),
    ("march", VolumeEstimate::March),
    ("march-report", VolumeEstimate::MarchReport),
];
const FOG: &[(&str, Fog)] = &[("volume", Fog::Volume), ("ambient", Fog::Ambient)];

/// Every parameter.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "photons",
        value: "N",
        help: "Photons wanted in the global map",
        set: |d, v| count(v, 0, MAX_PHOTONS).map(|n| d.config.photons = n),
        get: |c| json!(c.photons),
    },
    Parameter {
        name: "caustic-photons",
        value: "N",
        help: "Photons wanted in the caustic map",
        set: |d, v| count(v, 0, MAX_PHOTONS).map(|n| d.config.caustic_photons = n),
        get: |c| json!(c.caustic_photons),
    },
    Parameter {
        name: "emit",
        value: "N",
        help: "Paths to emit for each map, whatever they store, instead of the photons wanted",
        set: |d, v| count(v, 0, MAX_PHOTONS).map(|n| d.config.emit = Some(n)),
        get: |c| json!(c.emit),
    },
    Parameter {
        name: "emit-max",
        value: "N",
        help: "Emit at most this multiple of the photons wanted",
        set: |d, v| count(v, 1, 1_000_000).map(|n| d.config.emit_max = n),
        get: |c| json!(c.emit_max),
    },
    Parameter {
        name: "neighbours",
        value: "N",
        help: "Photons of an estimate",
        set: |d, v| count(v, 2, 1_000_000).map(|n| d.config.neighbours = n as u32),
        get: |c| json!(c.neighbours),
    },
    Parameter {
        name: "radius",
        value: "LENGTH",
        help: "A fixed radius of estimates, in scene units, instead of neighbours",
        set: |d, v| length(v).map(|r| d.config.radius = Some(r)),
        get: |c| json!(c.radius),
    },
    Parameter {
        name: "max-radius",
        value: "LENGTH",
        help: "Largest radius that neighbours are looked for in, in scene units",
        set: |d, v| length(v).map(|r| d.config.max_radius = Some(r)),
        get: |c| json!(c.max_radius),
    },
    Parameter {
        name: "kernel",
        value: "KERNEL",
        help: "How photons are weighted by distance: box, cone, gaussian, epanechnikov, biweight, \
               jensen-1996 (a Gaussian that loses 47 % of the light, for comparison)",
        set: |d, v| kernel(v).map(|k| d.config.kernel = k),
        get: |c| json!(c.kernel.name()),
    },
    Parameter {
        name: "cone-k",
        value: "K",
        help: "Slope of the cone kernel, at least 1: it reaches zero at K times the radius",
        set: |d, v| {
            let k = number(v, "a number that is at least 1", |k| k >= 1.0)?;
            d.cone_k = Some(k);
            Ok(())
        },
        get: |c| match c.kernel {
            Kernel::Cone { k } => json!(k),
            _ => Value::Null,
        },
    },
    Parameter {
        name: "equal-bandwidth",
        value: "BOOL",
        help: "Multiply the neighbours so that all kernels blur equally wide",
        set: |d, v| boolean(v).map(|b| d.config.equal_bandwidth = b),
        get: |c| json!(c.equal_bandwidth),
    },
    Parameter {
        name: "direct",
        value: "SOURCE",
        help: "Direct light by rays to the lights, or from the map: rays, map",
        set: |d, v| one_of(v, DIRECT).map(|s| d.config.direct = s),
        get: |c| name_of(DIRECT, c.direct),
    },
    Parameter {
        name: "direct-lights",
        value: "LIGHTS",
        help: "Lights that direct light is asked of at each point: one, all",
        set: |d, v| one_of(v, DIRECT_LIGHTS).map(|l| d.config.direct_lights = l),
        get: |c| name_of(DIRECT_LIGHTS, c.direct_lights),
    },
    Parameter {
        name: "final-gather",
        value: "RAYS",
        help: "Gather indirect light by rays: on, off, or a number of rays for each camera sample that reads the maps",
        set: |d, v| final_gather(v).map(|g| d.config.final_gather = g),
        get: |c| match c.final_gather {
            FinalGather::Off => json!("off"),
            FinalGather::Auto => json!("on"),
            FinalGather::Rays(n) => json!(n),
        },
    },
    Parameter {
        name: "max-depth",
        value: "N",
        help: "Longest path from light to lens, in segments; -1 for no end",
        set: |d, v| depth(v).map(|n| d.config.max_depth = n),
        get: |c| c.max_depth.map_or(json!(-1), |n| json!(n)),
    },
    Parameter {
        name: "light-choice",
        value: "CHOICE",
        help: "Photons for each light in proportion to its power, or equally many: power, equal",
        set: |d, v| one_of(v, LIGHT_CHOICE).map(|l| d.config.light_choice = l),
        get: |c| name_of(LIGHT_CHOICE, c.light_choice),
    },
    Parameter {
        name: "sphere-sampling",
        value: "METHOD",
        help: "How directions from a point light are sampled: solid-angle, rejection",
        set: |d, v| one_of(v, SPHERE_SAMPLING).map(|s| d.config.sphere_sampling = s),
        get: |c| name_of(SPHERE_SAMPLING, c.sphere_sampling),
    },
    Parameter {
        name: "aim",
        value: "BOOL",
        help: "Send photons only where they can meet a surface (caustic ones: a specular one): true, false",
        set: |d, v| boolean(v).map(|b| d.config.aim = b),
        get: |c| json!(c.aim),
    },
    Parameter {
        name: "fog",
        value: "KIND",
        help: "What media do: scatter light (volume), or weaken it and look the same everywhere (ambient)",
        set: |d, v| one_of(v, FOG).map(|f| d.config.fog = f),
        get: |c| name_of(FOG, c.fog),
    },
    Parameter {
        name: "single-scatter",
        value: "SOURCE",
        help: "Light that media scatter once by rays to the lights, or from the map: rays, map",
        set: |d, v| one_of(v, DIRECT).map(|s| d.config.single_scatter = s),
        get: |c| name_of(DIRECT, c.single_scatter),
    },
    Parameter {
        name: "volume-photons",
        value: "N",
        help: "Photons (or beams) wanted in each map of light in media [default: by the kind]",
        set: |d, v| count(v, 0, MAX_PHOTONS).map(|n| d.config.volume_photons = Some(n)),
        get: |c| json!(c.volume_photons),
    },
    Parameter {
        name: "volume-kind",
        value: "KIND",
        help: "What these maps hold: points, beams",
        set: |d, v| one_of(v, VOLUME_KIND).map(|k| d.config.volume_kind = k),
        get: |c| name_of(VOLUME_KIND, c.volume_kind),
    },
    Parameter {
        name: "volume-estimate",
        value: "ESTIMATE",
        help: "How points light a ray: beam (each blurred across it), march (steps), march-report (its fixed \
               steps, for comparison)",
        set: |d, v| one_of(v, VOLUME_ESTIMATE).map(|e| d.config.volume_estimate = e),
        get: |c| name_of(VOLUME_ESTIMATE, c.volume_estimate),
    },
    Parameter {
        name: "volume-neighbours",
        value: "N",
        help: "Photons of an estimate in media [default: by the estimate]",
        set: |d, v| count(v, 2, 1_000_000).map(|n| d.config.volume_neighbours = Some(n as u32)),
        get: |c| json!(c.volume_neighbours),
    },
    Parameter {
        name: "beam-crossings",
        value: "N",
        help: "Beams of light that a ray passes within their radius",
        set: |d, v| number(v, "a number above zero", |k| k > 0.0).map(|k| d.config.beam_crossings = k),
        get: |c| json!(c.beam_crossings),
    },
    Parameter {
        name: "march-step",
        value: "LENGTH",
        help: "Steps of march-report, in scene units [default: a 128th of the scene]",
        set: |d, v| length(v).map(|l| d.config.march_step = Some(l)),
        get: |c| json!(c.march_step),
    },
    Parameter {
        name: "show",
        value: "PART",
        help: "What part of the light is drawn: all, direct, indirect, global, caustic, medium",
        set: |d, v| one_of(v, SHOW).map(|s| d.config.show = s),
        get: |c| name_of(SHOW, c.show),
    },
];

impl Parameter {
    /// The name in scene files.
    pub fn name_in_files(&self) -> String {
        self.name.replace('-', "_")
    }

    /// Puts a value into a draft; the error says what a value should be.
    pub fn set(&self, draft: &mut Draft, value: &str) -> Result<(), String> {
        draft.given.push(self.name);
        (self.set)(draft, value)
    }

    /// The value in a configuration.
    pub fn get(&self, config: &PhotonMapperConfig) -> Value {
        (self.get)(config)
    }

    fn flag(&'static self) -> Arg {
        let check = |value: &str| self.set(&mut Draft::default(), value).map(|()| value.to_owned());
        let arg = Arg::new(self.name)
            .long(self.name)
            .value_name(self.value)
            .help(self.help)
            .help_heading("Photon mapping")
            .allow_negative_numbers(true)
            .value_parser(check);
        if self.value == "BOOL" {
            return arg.num_args(0..=1).require_equals(true).default_missing_value("true");
        }
        arg
    }
}

/// Parameters given on the command line.
#[derive(Clone, Debug, Default)]
pub struct PhotonFlags(Vec<(usize, String)>);

impl PhotonFlags {
    /// The parameters with their values, which have been checked.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Parameter, &str)> {
        self.0.iter().map(|(i, value)| (&PARAMETERS[*i], value.as_str()))
    }

    /// Whether a parameter is among them, by the name of its flag.
    pub fn has(&self, name: &str) -> bool {
        self.iter().any(|(parameter, _)| parameter.name == name)
    }

    /// The flags as they are written, for messages.
    pub fn names(&self) -> Vec<String> {
        self.iter().map(|(parameter, _)| format!("--{}", parameter.name)).collect()
    }
}

impl Args for PhotonFlags {
    fn augment_args(command: Command) -> Command {
        PARAMETERS.iter().fold(command, |command, parameter| command.arg(parameter.flag()))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for PhotonFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = |(i, parameter): (usize, &Parameter)| {
            matches.get_one::<String>(parameter.name).map(|value| (i, value.clone()))
        };
        Ok(Self(PARAMETERS.iter().enumerate().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn configured(values: &[(&str, &str)]) -> Result<PhotonMapperConfig, String> {
        let mut draft = Draft::default();
        for (name, value) in values {
            let parameter = PARAMETERS.iter().find(|p| p.name == *name).expect(name);
            parameter.set(&mut draft, value)?;
        }
        Ok(draft.finish())
    }

    /// The values of every parameter, none of them the default.
    const VALUES: &[(&str, &str)] = &[
        ("photons", "17"),
        ("caustic-photons", "0"),
        ("emit", "1000"),
        ("emit-max", "7"),
        ("neighbours", "2"),
        ("radius", "0.25"),
        ("max-radius", "0.5"),
        ("kernel", "cone"),
        ("cone-k", "1.5"),
        ("equal-bandwidth", "true"),
        ("direct", "map"),
        ("direct-lights", "all"),
        ("final-gather", "12"),
        ("max-depth", "9"),
        ("light-choice", "equal"),
        ("sphere-sampling", "rejection"),
        ("aim", "false"),
        ("fog", "ambient"),
        ("single-scatter", "map"),
        ("volume-photons", "12"),
        ("volume-kind", "beams"),
        ("volume-estimate", "march"),
        ("volume-neighbours", "33"),
        ("beam-crossings", "7.0"),
        ("march-step", "0.125"),
        ("show", "indirect"),
    ];

    #[test]
    fn every_value_arrives_and_comes_back() {
        let names: Vec<&str> = PARAMETERS.iter().map(|p| p.name).collect();
        assert_eq!(names, VALUES.iter().map(|v| v.0).collect::<Vec<_>>());
        let (default, config) = (PhotonMapperConfig::default(), configured(VALUES).unwrap());
        for (parameter, (name, value)) in PARAMETERS.iter().zip(VALUES) {
            assert_eq!(parameter.get(&config).to_string().trim_matches('"'), *value, "{name}");
            assert_ne!(parameter.get(&default), parameter.get(&config), "{name}");
        }
    }

    #[test]
    fn the_slope_finds_its_cone_in_any_order() {
        let cone = Kernel::Cone { k: 2.0 };
        assert_eq!(configured(&[("cone-k", "2"), ("kernel", "cone")]).unwrap().kernel, cone);
        assert_eq!(configured(&[("kernel", "cone:2")]).unwrap().kernel, cone);
        assert_eq!(configured(&[("cone-k", "2"), ("kernel", "box")]).unwrap().kernel, Kernel::Box);
    }

    #[test]
    fn bad_values_are_refused() {
        for (name, value) in [
            ("photons", "-1"),
            ("photons", "1.5"),
            ("photons", "1e30"),
            ("emit-max", "0"),
            ("neighbours", "1"),
            ("radius", "0"),
            ("radius", "inf"),
            ("radius", "nan"),
            ("max-radius", "-2"),
            ("kernel", "tent"),
            ("cone-k", "0.9"),
            ("equal-bandwidth", "yes"),
            ("final-gather", "-3"),
            ("max-depth", "-2"),
            ("show", "nothing"),
            ("fog", "thick"),
            ("volume-neighbours", "1"),
            ("beam-crossings", "0"),
            ("march-step", "-1"),
        ] {
            let message = configured(&[(name, value)]).unwrap_err();
            assert!(message.starts_with("it must be "), "{name}={value}: {message}");
        }
        assert_eq!(configured(&[("photons", "1e6")]).unwrap().photons, 1_000_000);
        assert_eq!(configured(&[("max-depth", "-1")]).unwrap().max_depth, None);
        assert_eq!(configured(&[("final-gather", "on")]).unwrap().final_gather, FinalGather::Auto);
    }
}
