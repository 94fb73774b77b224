use super::{Aov, SizeMismatch};

/// Why films cannot be added up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// They have other numbers of pixels.
    #[error(transparent)]
    Sizes(#[from] SizeMismatch),
    /// Their steps are not the same.
    #[error("radiances count in units of 2^{first} and of 2^{second}")]
    Units {
        /// Exponent of one film's unit.
        first: i32,
        /// Exponent of the other's.
        second: i32,
    },
    /// They keep other values beside the picture.
    #[error("only one of the two has the values {}", difference(first, second))]
    Values {
        /// The values of one.
        first: Vec<Aov>,
        /// The values of the other.
        second: Vec<Aov>,
    },
}

/// Names of the values that one has and the other has not.
fn difference(first: &[Aov], second: &[Aov]) -> String {
    let differs = |aov: &Aov| first.contains(aov) != second.contains(aov);
    let names: Vec<&str> = Aov::ALL.into_iter().filter(differs).map(Aov::name).collect();
    names.join(", ")
}
