//! The classes of scattering that estimators tell apart.

/// How narrow a lobe is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LobeKind {
    /// A single direction, without a density: smooth mirrors and glass.
    Dirac,
    /// A density about one direction that is too narrow to be estimated from photons: facets with both α below 0.1.
    /// The photon mapper follows it as it follows mirrors.
    Sharp,
    /// Any other density.
    Broad,
}

impl LobeKind {
    /// All of them, the narrowest first.
    pub const ALL: [Self; 3] = [Self::Dirac, Self::Sharp, Self::Broad];
}

/// A set of classes. Broad ones are of two sorts, since photons are good at one of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Classes(u8);

impl Classes {
    pub const NONE: Self = Self(0);
    pub const DIRAC: Self = Self(1);
    pub const SHARP: Self = Self(2);
    /// Broad, and brighter about some direction.
    pub const GLOSSY: Self = Self(4);
    /// Broad, and much the same in all directions.
    pub const DIFFUSE: Self = Self(8);
    /// All that have a density.
    pub const DENSE: Self = Self(2 + 4 + 8);

    /// Those of a kind.
    pub const fn of(kind: LobeKind) -> Self {
        match kind {
            LobeKind::Dirac => Self::DIRAC,
            LobeKind::Sharp => Self::SHARP,
            LobeKind::Broad => Self(4 + 8),
        }
    }

    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    pub const fn is_none(self) -> bool {
        self.0 == 0
    }

    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The kind of a single one.
    pub const fn kind(self) -> LobeKind {
        match self {
            Self::DIRAC => LobeKind::Dirac,
            Self::SHARP => LobeKind::Sharp,
            _ => LobeKind::Broad,
        }
    }
}
