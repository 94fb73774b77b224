//! What a photon is, by what its path has met.

use super::roulette::effort;

/// What a photon's path makes of it, decided here and nowhere else. L is the light, S a bounce by a Dirac lobe or
/// one nearly so sharp, D any other, V a collision in a medium; null surfaces count as nothing. The last letter is where the
/// photon lies: D on a surface, V in a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotonKind {
    /// L D and L V: belongs to next event estimation, unless direct light, or light scattered once, comes from
    /// the map.
    Direct,
    /// L S+ D and L S+ V: the caustic maps'.
    Caustic,
    /// L S+ D S* D: a caustic's light after one more bounce. The global map's, and known apart, since
    /// gather rays do not bring it.
    Afterglow,
    /// V S* D and, from a medium that gives it off, L S* D: light from a medium. The global map's, and known
    /// apart for the same reason.
    Haze,
    /// All the rest: the global map's, or that of the volume.
    Global,
}

/// What a path has met so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct History {
    specular: u32,
    other: u32,
    /// Of the others those in media.
    collisions: u32,
    /// Of the specular ones those that light went straight on at, which make no segment.
    straight: u32,
    /// Whether the first surface that was not specular was lit by one that was.
    from_caustic: bool,
    /// Whether the last of the others was a collision, or was none and the light started in a medium.
    from_medium: bool,
}

impl History {
    /// That of light which a medium gives off. Nothing looks for it but the paths that pass through: it is in the maps
    /// as if it had been scattered where it starts.
    pub fn from_medium() -> Self {
        Self { from_medium: true, ..Self::default() }
    }

    /// Bounces that make a segment.
    pub fn bounces(&self) -> u32 {
        self.specular + self.other - self.straight
    }

    /// Bounces as roulette counts them.
    pub fn effort(&self) -> u32 {
        effort(self.specular + self.other, self.collisions)
    }

    /// What a photon is that lands now on a surface that is not specular.
    pub fn kind(&self) -> PhotonKind {
        match (self.specular, self.other) {
            _ if self.from_medium => PhotonKind::Haze,
            (0, 0) => PhotonKind::Direct,
            (_, 0) => PhotonKind::Caustic,
            (_, 1) if self.from_caustic => PhotonKind::Afterglow,
            _ => PhotonKind::Global,
        }
    }

    /// What a photon is that collides now.
    pub fn kind_in_medium(&self) -> PhotonKind {
        match (self.specular, self.other) {
            _ if self.from_medium => PhotonKind::Global,
            (0, 0) => PhotonKind::Direct,
            (_, 0) => PhotonKind::Caustic,
            _ => PhotonKind::Global,
        }
    }

    pub fn bounce(&mut self, specular: bool) {
        if specular {
            self.specular += 1;
        } else {
            self.from_caustic |= self.other == 0 && self.specular > 0 && !self.from_medium;
            self.from_medium = false;
            self.other += 1;
        }
    }

    /// A specular bounce that light goes straight on at.
    pub fn pass(&mut self) {
        self.bounce(true);
        self.straight += 1;
    }

    pub fn collide(&mut self) {
        self.from_medium = true;
        self.other += 1;
        self.collisions += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(path: &str) -> History {
        after(History::default(), path)
    }

    fn after(mut history: History, path: &str) -> History {
        for letter in path.chars() {
            match letter {
                'V' => history.collide(),
                _ => history.bounce(letter == 'S'),
            }
        }
        history
    }

    #[test]
    fn a_path_decides_the_kind_of_its_photons() {
        // What the path has met before the D where the photon lies.
        let kind = |path| history(path).kind();
        assert_eq!(kind(""), PhotonKind::Direct);
        for path in ["S", "SS", "SSS"] {
            assert_eq!(kind(path), PhotonKind::Caustic, "{path}");
        }
        for path in ["SD", "SSD", "SDS", "SDSS"] {
            assert_eq!(kind(path), PhotonKind::Afterglow, "{path}");
        }
        for path in ["D", "DS", "DD", "SDD", "DSD", "SDSD", "VD", "VDS", "SVD", "DVSD"] {
            assert_eq!(kind(path), PhotonKind::Global, "{path}");
        }
        for path in ["V", "VS", "SV", "DV", "SDV", "DVSS", "VV"] {
            assert_eq!(kind(path), PhotonKind::Haze, "{path}");
        }
    }

    #[test]
    fn light_of_a_medium_is_haze_first_and_then_global() {
        let kinds = |path: &str| {
            let history = after(History::from_medium(), path);
            assert_eq!(history.bounces() as usize, path.len());
            (history.kind(), history.kind_in_medium())
        };
        for path in ["", "S", "SS", "V", "DV", "SVS"] {
            assert_eq!(kinds(path), (PhotonKind::Haze, PhotonKind::Global), "{path}");
        }
        for path in ["D", "SD", "SDS", "DD", "VD"] {
            assert_eq!(kinds(path), (PhotonKind::Global, PhotonKind::Global), "{path}");
        }
    }

    #[test]
    fn and_in_media() {
        let kind = |path| history(path).kind_in_medium();
        assert_eq!(kind(""), PhotonKind::Direct);
        for path in ["S", "SS"] {
            assert_eq!(kind(path), PhotonKind::Caustic, "{path}");
        }
        for path in ["D", "V", "VS", "SV", "SD", "DS"] {
            assert_eq!(kind(path), PhotonKind::Global, "{path}");
        }
    }
}
