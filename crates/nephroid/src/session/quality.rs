//! How good a picture is by now.

use super::Session;
use crate::film::{Convergence, Quality};

impl Session<'_> {
    /// The error of the picture so far. `None` while there are too few estimates to tell, and for methods that
    /// [do not tell](crate::integrator::Method::tells_error).
    pub fn quality(&self) -> Option<Quality> {
        let method = &self.method;
        method.tells_error().then(|| Quality::of(&self.film, &self.convergence, method.pixels())).flatten()
    }

    /// The relative error of each pixel, row by row, whose mean square is that of [`Self::quality`].
    pub fn error_image(&self) -> Option<Vec<f32>> {
        let method = &self.method;
        let tells = method.tells_error();
        tells.then(|| Quality::of_pixels(&self.film, &self.convergence, method.pixels())).flatten()
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
