use crate::integrator::{Method, PathConfig, PpmConfig, VcmConfig};
use crate::world::World;

/// Settings of a render that chooses its integrator itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AutoConfig {
    /// Whether something is asked for that photon maps alone tell: layers of light by its kind, or of look-ups.
    pub maps_only: bool,
    /// Those of progressive photon mapping, of which the other integrators take what they know.
    pub ppm: PpmConfig,
}

/// What was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// Path tracing, in media where there are any.
    Path,
    /// Progressive photon mapping.
    Ppm,
    /// Vertex connection and merging.
    Vcm {
        /// Whether light paths are connected to others than lamps and the lens.
        connections: bool,
    },
}

/// What was chosen, and why: the rays that each takes for a pixel until its relative variance is one, as trials tell;
/// infinitely many where there is light that it cannot find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// What renders.
    pub pick: Pick,
    /// Work of a path tracer.
    pub path: f64,
    /// Work of progressive photon mapping.
    pub ppm: f64,
    /// Work of vertex connection and merging, without connections of light paths and with them.
    pub vcm: [f64; 2],
    /// Whether settings ask for something that nothing else has.
    pub asked_for: bool,
    /// Whether it can be told what paths find: not where specular surfaces and media come together.
    pub paths_are_known: bool,
}

impl Choice {
    pub(super) fn nothing_tried() -> Self {
        let (path, ppm, vcm) = (f64::INFINITY, f64::INFINITY, [f64::INFINITY; 2]);
        Self { pick: Pick::Ppm, path, ppm, vcm, asked_for: false, paths_are_known: true }
    }

    /// With the pick that follows from the numbers.
    pub(super) fn picked(self) -> Self {
        let [without, with] = self.vcm;
        let ways = [
            (Pick::Ppm, self.ppm),
            (Pick::Vcm { connections: false }, without),
            (Pick::Vcm { connections: true }, with),
            (Pick::Path, self.path),
        ];
        let mut best = ways[0];
        for way in ways {
            if way.1 < best.1 {
                best = way;
            }
        }
        Self { pick: best.0, ..self }
    }

    /// The integrator that renders.
    pub(crate) fn method(&self, world: &World, config: &AutoConfig) -> Method {
        let mapper = &config.ppm.mapper;
        match self.pick {
            Pick::Ppm => Method::Ppm(config.ppm.clone()),
            Pick::Vcm { connections } => {
                Method::Vcm(VcmConfig { mapper: mapper.clone(), connections, ..VcmConfig::default() })
            }
            Pick::Path => Method::Path(PathConfig {
                max_depth: mapper.max_depth,
                direct_lights: mapper.direct_lights,
                media: world.has_media(),
            }),
        }
    }

    /// One line that says what was chosen and why.
    pub fn reason(&self) -> String {
        let [without, with] = self.vcm;
        let vcm = without.min(with);
        let times = |other: f64, own: f64| format!("{:.1} times", other / own);
        let of_paths = |own: f64| {
            if !self.paths_are_known {
                "whether paths from the camera find all light cannot be told".to_owned()
            } else if self.path.is_infinite() {
                "there is light that paths from the camera cannot find".to_owned()
            } else {
                format!("paths from the camera alone would take {} the work", times(self.path, own))
            }
        };
        match self.pick {
            Pick::Ppm if self.asked_for => "photon maps (ppm), as the settings ask for them".to_owned(),
            Pick::Ppm if self.ppm.is_infinite() => "photon maps (ppm), as trials found no light".to_owned(),
            Pick::Ppm if vcm < self.path => {
                let beside = times(vcm, self.ppm);
                format!("photon maps (ppm): {}, and paths from both ends {beside}", of_paths(self.ppm))
            }
            Pick::Ppm => format!("photon maps (ppm): {}", of_paths(self.ppm)),
            Pick::Vcm { connections } => {
                let own = if connections { with } else { without };
                let beside = times(self.ppm, own);
                let kind = if connections {
                    "paths from both ends, connected and merged"
                } else {
                    "paths merged with photons"
                };
                format!("{kind} (vcm): {}, and photon maps {beside}", of_paths(own))
            }
            Pick::Path => {
                let beside = times(vcm.min(self.ppm), self.path);
                format!(
                    "paths from the camera (path): they find all light, and photons would take {beside} the work"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(path: f64, ppm: f64, vcm: [f64; 2]) -> Choice {
        Choice { path, ppm, vcm, ..Choice::nothing_tried() }.picked()
    }

    #[test]
    fn the_least_work_is_picked() {
        assert_eq!(choice(1.0, 3.0, [2.0, 5.0]).pick, Pick::Path);
        assert_eq!(choice(9.0, 3.0, [4.0, 5.0]).pick, Pick::Ppm);
        assert_eq!(choice(9.0, 3.0, [2.0, 1.0]).pick, Pick::Vcm { connections: true });
        assert_eq!(choice(f64::INFINITY, 3.0, [2.0, 7.0]).pick, Pick::Vcm { connections: false });
    }

    #[test]
    fn where_nothing_was_found_photons_are_sent() {
        assert_eq!(choice(f64::INFINITY, f64::INFINITY, [f64::INFINITY; 2]).pick, Pick::Ppm);
        assert_eq!(choice(f64::NAN, f64::INFINITY, [f64::NAN; 2]).pick, Pick::Ppm);
    }

    #[test]
    fn the_reason_names_the_alternatives() {
        let reason = |path, ppm, vcm| choice(path, ppm, vcm).reason();
        assert_eq!(
            reason(f64::INFINITY, 2.0, [3.0, 9.0]),
            "photon maps (ppm): there is light that paths from the camera cannot find, and paths from both ends 1.5 times"
        );
        assert_eq!(
            reason(1.0, 2.0, [4.0, 9.0]),
            "paths from the camera (path): they find all light, and photons would take 2.0 times the work"
        );
    }
}
