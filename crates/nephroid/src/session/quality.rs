//! How good a picture is by now.

use super::Session;
use crate::film::{Convergence, Quality};
use crate::integrator::Method;

impl Method {
    /// Whether the variance of its films is that of all their noise, so that a picture's [`Quality`] can be told. The photon
    /// mapper's samples of an iteration share photons that it does not show.
    pub fn tells_quality(&self) -> bool {
        !matches!(self, Self::PhotonMapper(_))
    }
}

impl Session<'_> {
    /// The error of the picture so far. `None` while there are too few estimates to tell, and for methods that
    /// [do not tell](Method::tells_quality).
    pub fn quality(&self) -> Option<Quality> {
        self.settings.method.tells_quality().then(|| Quality::of(&self.film, &self.convergence)).flatten()
    }

    /// The relative error of each pixel, row by row, whose mean square is that of [`Self::quality`].
    pub fn error_image(&self) -> Option<Vec<f32>> {
        self.quality().map(|_| self.film.relative_errors())
    }

    /// What has to go with the film for a render that is gone on with.
    pub fn convergence(&self) -> &Convergence {
        &self.convergence
    }

    /// Goes on with what [`Self::convergence`] was, beside the films given to [`Self::with_films`]. Without it a render
    /// that is gone on with gives the same picture, and tells its error less well.
    #[must_use]
    pub fn with_convergence(mut self, convergence: Convergence) -> Self {
        self.convergence = convergence;
        self
    }
}
