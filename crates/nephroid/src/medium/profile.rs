use super::uniform::{attenuation, transmittance};
use crate::color::Rgb;

/// The transmittance along a ray from its origin on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Profile {
    /// Where there are no pieces.
    sigma_t: Rgb,
    /// Where distances in pieces count from.
    start: f32,
    /// Optical depth of all pieces so far; double, for there may be thousands.
    depth: [f64; 3],
    pieces: Vec<Piece>,
}

/// A part of the ray along which the extinction is a cubic polynomial.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f32,
    length: f32,
    /// Optical depth in front of it.
    depth: Rgb,
    /// The optical depth in it is the sum of `curve[i] · x^(i+1)`, for x from 0 to 1.
    curve: [Rgb; 4],
}

impl Profile {
    /// Transmittance from the origin to `t`.
    #[inline]
    pub fn transmittance(&self, t: f32) -> Rgb {
        if self.pieces.is_empty() {
            attenuation(self.sigma_t, t)
        } else {
            transmittance(self.depth_in_pieces(t))
        }
    }

    /// Optical depth from the origin to `t`, exact but for rounding. What lies between pieces is empty.
    pub(super) fn depth_in_pieces(&self, t: f32) -> Rgb {
        let s = t - self.start;
        let Some(last) = self.pieces.partition_point(|piece| piece.from <= s).checked_sub(1) else {
            return Rgb::BLACK;
        };
        let piece = &self.pieces[last];
        let x = ((s - piece.from) / piece.length).min(1.0);
        let [a, b, c, d] = piece.curve;
        // Rounding must not make light of nothing.
        piece.depth + ((((d * x + c) * x + b) * x + a) * x).map(|depth| depth.max(0.0))
    }

    /// The extinction if it is the same all along.
    #[inline]
    pub(super) fn uniform(&self) -> Option<Rgb> {
        self.pieces.is_empty().then_some(self.sigma_t)
    }

    /// The extinction at `t`.
    pub(super) fn extinction(&self, t: f32) -> Rgb {
        let s = t - self.start;
        let Some(last) = self.pieces.partition_point(|piece| piece.from <= s).checked_sub(1) else {
            return self.sigma_t;
        };
        let piece = &self.pieces[last];
        let x = (s - piece.from) / piece.length;
        let [a, b, c, d] = piece.curve;
        // Behind a piece there is nothing up to the next.
        let depth_per_piece = ((d * (4.0 * x) + c * 3.0) * x + b * 2.0) * x + a;
        if x <= 1.0 { (depth_per_piece / piece.length).map(|sigma| sigma.max(0.0)) } else { Rgb::BLACK }
    }

    /// The ends of the piece in which a channel reaches an optical depth.
    pub(super) fn piece_of_depth(&self, channel: usize, depth: f32) -> (f32, f32) {
        let last = self.pieces.partition_point(|piece| piece.depth[channel] <= depth).saturating_sub(1);
        let Piece { from, length, .. } = self.pieces[last];
        (self.start + from, self.start + from + length)
    }

    /// Begins anew, keeping the memory.
    pub(super) fn reset(&mut self, sigma_t: Rgb) {
        self.pieces.clear();
        self.sigma_t = sigma_t;
        self.start = 0.0;
        self.depth = [0.0; 3];
    }

    pub(super) fn start(&mut self, t: f32) {
        self.start = t;
    }

    /// Adds a piece behind the others by the extinction at its ends and at a third and two thirds of it.
    pub(super) fn push(&mut self, from: f32, length: f32, [f, g, h, k]: [Rgb; 4]) {
        // The polynomial through the four values, in monomials, and its integral.
        let b = g * 9.0 - f * 5.5 - h * 4.5 + k;
        let c = f * 9.0 - g * 22.5 + h * 18.0 - k * 4.5;
        let d = (g - h) * 13.5 - f * 4.5 + k * 4.5;
        let curve = [f * length, b * (0.5 * length), c * (length / 3.0), d * (0.25 * length)];
        let depth = Rgb::from(self.depth.map(|depth| depth as f32));
        // Simpson's rule of three eighths, which is the same without the differences.
        let whole = (f + (g + h) * 3.0 + k) * (length * 0.125);
        for (sum, part) in self.depth.iter_mut().zip(whole.to_array()) {
            *sum += f64::from(part);
        }
        self.pieces.push(Piece { from, length, depth, curve });
    }
}
