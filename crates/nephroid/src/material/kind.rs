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
