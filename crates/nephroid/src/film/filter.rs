/// Reconstruction filter, as a function of the distance from the pixel's centre in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over the pixel.
    Box,
    /// Linear down to zero at `radius`.
    Tent {
        /// Where it ends.
        radius: f32,
    },
    /// A bell, cut off (and lowered to zero) at four standard deviations.
    Gaussian {
        /// Standard deviation.
        std_dev: f32,
    },
    /// The cubic of Mitchell and Netravali (1988), with negative lobes; ends at 2 pixels.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
}
