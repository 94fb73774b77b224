/// What one way of rendering needs: the relative variance of a pixel, mean over the picture, and what it costs in rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    pub variance: f64,
    pub rays: f64,
}

impl Effort {
    /// The rays for each pixel to a relative variance of one.
    pub fn work(self) -> f64 {
        self.variance * self.rays
    }
}
