//! Directions and points on a disk, mapped to rectangles without changing areas.

use super::{ChiSquareTest, Domain};
use crate::Outcome;
use std::f64::consts::PI;

/// A χ² test of a sampler of unit directions against its density per unit solid angle.
///
/// Directions are mapped to (cos θ, φ) about the z axis, where dω = d cos θ dφ.
///
/// ```
/// use nephroid_testkit::{ALPHA, Pcg32, SphereTest};
///
/// let mut rng = Pcg32::new(1);
/// let uniform = || {
///     let (z, phi) = (1.0 - 2.0 * rng.next_f64(), core::f64::consts::TAU * rng.next_f64());
///     let r = (1.0 - z * z).sqrt();
///     Some([r * libm::cos(phi), r * libm::sin(phi), z])
/// };
/// let pdf_solid_angle = |_direction| 0.25 / core::f64::consts::PI;
/// SphereTest { samples: 100_000, ..Default::default() }.run(uniform, pdf_solid_angle).assert_passes(ALPHA);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereTest {
    /// Number of samples tested.
    pub samples: usize,
    /// Number of cells along cos θ and along φ.
    pub resolution: [usize; 2],
    /// Range of cos θ: [−1, 1], or [0, 1] for the upper hemisphere alone, where directions below count as outside.
    pub cos_theta: [f64; 2],
}

impl Default for SphereTest {
    fn default() -> Self {
        let ChiSquareTest { samples, resolution, .. } = ChiSquareTest::default();
        Self { samples, resolution, cos_theta: [-1.0, 1.0] }
    }
}

impl SphereTest {
    /// Tests whether the directions that `sample` returns follow `pdf_solid_angle`.
    ///
    /// `None`, NaN and vectors whose length is not 1 to four digits count as outside: where the density leaves
    /// nothing for outside, one in ten thousand of them is enough for a rejection. See [`ChiSquareTest::run`].
    pub fn run(
        &self,
        mut sample: impl FnMut() -> Option<[f64; 3]>,
        pdf_solid_angle: impl Fn([f64; 3]) -> f64,
    ) -> Outcome {
        let [low, high] = self.cos_theta;
        let domain = Domain { min: [low, -PI], max: [high, PI] };
        let test = ChiSquareTest { domain, samples: self.samples, resolution: self.resolution };
        test.run(|| sample().and_then(to_cylinder), |point| pdf_solid_angle(to_direction(point)))
    }
}

/// (cos θ, φ) of a direction, None unless it has unit length.
///
/// Dividing by the length in double precision keeps 1 − cos θ accurate near the poles even where the direction was
/// rounded to single precision.
fn to_cylinder([x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let length = (x * x + y * y + z * z).sqrt();
    ((length - 1.0).abs() < 1e-4).then(|| [z / length, libm::atan2(y, x)])
}

fn to_direction([cos_theta, phi]: [f64; 2]) -> [f64; 3] {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
    [sin_theta * libm::cos(phi), sin_theta * libm::sin(phi), cos_theta]
}

/// A χ² test of a sampler of points on a disk about the origin against its density per unit area.
///
/// Points are mapped to (r², φ), where dA = ½ d(r²) dφ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskTest {
    /// Number of samples tested.
    pub samples: usize,
    /// Number of cells along r² and along φ.
    pub resolution: [usize; 2],
    /// Radius of the disk; points beyond it count as outside.
    pub radius: f64,
}

impl Default for DiskTest {
    fn default() -> Self {
        let ChiSquareTest { samples, resolution, .. } = ChiSquareTest::default();
        Self { samples, resolution, radius: 1.0 }
    }
}

impl DiskTest {
    /// Tests whether the points that `sample` returns follow `pdf_area`. See [`ChiSquareTest::run`].
    pub fn run(
        &self,
        mut sample: impl FnMut() -> Option<[f64; 2]>,
        pdf_area: impl Fn([f64; 2]) -> f64,
    ) -> Outcome {
        let domain = Domain { min: [0.0, -PI], max: [1.0, PI] };
        let test = ChiSquareTest { domain, samples: self.samples, resolution: self.resolution };
        let to_polar = |[x, y]: [f64; 2]| {
            let (x, y) = (x / self.radius, y / self.radius);
            [x * x + y * y, libm::atan2(y, x)]
        };
        let density = |[r2, phi]: [f64; 2]| {
            let r = self.radius * r2.sqrt();
            0.5 * self.radius * self.radius * pdf_area([r * libm::cos(phi), r * libm::sin(phi)])
        };
        test.run(|| sample().map(to_polar), density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn directions_map_there_and_back() {
        let mut rng = Pcg32::new(1);
        for _ in 0..1000 {
            let point = [2.0 * rng.next_f64() - 1.0, PI * (2.0 * rng.next_f64() - 1.0)];
            let back = to_cylinder(to_direction(point)).unwrap();
            assert!((0..2).all(|i| (back[i] - point[i]).abs() < 1e-12), "{point:?} became {back:?}");
        }
        assert_eq!(to_cylinder([0.0, 0.0, 1.01]), None);
        assert_eq!(to_cylinder([0.0, f64::NAN, 1.0]), None);
    }

    #[test]
    fn the_pole_stays_sharp_in_single_precision() {
        let theta = 1e-4_f64;
        let rounded = [libm::sin(theta), 0.0, libm::cos(theta)].map(|c| f64::from(c as f32));
        let [cos_theta, _] = to_cylinder(rounded).unwrap();
        let exact = 0.5 * theta * theta;
        assert!(((1.0 - cos_theta) / exact - 1.0).abs() < 1e-6);
    }
}
