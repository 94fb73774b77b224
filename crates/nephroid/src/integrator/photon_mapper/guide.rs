//! Directions for gather rays from the photons that arrived near by.

use crate::color::Rgb;
use crate::math::{Frame, Vec2, Vec3, warp};

/// Cells along each side of the square that the hemisphere is mapped to.
const SIDE: usize = 16;
const CELLS: usize = SIDE * SIDE;

/// The share of rays that follow the cosine alone, so that no direction is forgotten that no photon
/// came from.
const COSINE_SHARE: f32 = 0.25;

/// A density over the hemisphere above a surface: cosine-weighted, times a constant in each of 256
/// cells of equal cosine-weighted measure, which follows the power of the photons that came through
/// it (Jensen 1995, *Importance Driven Path Tracing using the Photon Map*, on the square of Shirley
/// and Chiu). A small bright place is found as often as it is bright.
#[derive(Clone, Debug)]
pub(super) struct Guide {
    frame: Frame,
    /// Irradiance by the light that it leads to, W/m².
    irradiance: Rgb,
    /// Power that came through each cell; once finished, probabilities up to and including it.
    cells: [f32; CELLS],
}

impl Guide {
    /// For the side of a surface that `normal` points to.
    pub fn new(normal: Vec3) -> Self {
        Self { frame: Frame::from_normal(normal), irradiance: Rgb::BLACK, cells: [0.0; CELLS] }
    }

    /// Adds a photon that came from direction `wi`, of a power in W and an irradiance in W/m², shared out among the four nearest cells: few photons
    /// stand for all of the light from around there.
    pub fn add(&mut self, wi: Vec3, power: Rgb, irradiance: Rgb) {
        self.irradiance += irradiance;
        let local = self.frame.to_local(wi);
        if local.z <= 0.0 {
            return;
        }
        let p = warp::disk_to_square(Vec2::new(local.x, local.y)) * SIDE as f32 - Vec2::splat(0.5);
        let (low, share) = (p.floor(), p - p.floor());
        let index = |x: f32| (x.max(0.0) as usize).min(SIDE - 1);
        for (y, row_share) in [(low.y, 1.0 - share.y), (low.y + 1.0, share.y)] {
            for (x, column_share) in [(low.x, 1.0 - share.x), (low.x + 1.0, share.x)] {
                self.cells[index(y) * SIDE + index(x)] += power.mean() * row_share * column_share;
            }
        }
    }

    /// Makes it ready to be sampled.
    pub fn finish(&mut self) {
        let total: f32 = self.cells.iter().sum();
        let mut sum = 0.0;
        for cell in &mut self.cells {
            let share = if total > 0.0 { *cell / total } else { 1.0 / CELLS as f32 };
            sum += COSINE_SHARE / CELLS as f32 + (1.0 - COSINE_SHARE) * share;
            *cell = sum;
        }
        // Whatever rounding left over.
        self.cells[CELLS - 1] = 1.0;
    }

    /// The density above a surface of a normal not far from its own, turned with it: no direction that
    /// the surface reflects from is left out.
    pub fn facing(&self, normal: Vec3) -> Facing<'_> {
        let frame = self.frame.turned_to(normal);
        Facing { irradiance: self.irradiance, cells: &self.cells, frame }
    }
}

/// A guide above a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing<'a> {
    /// Irradiance by the light that it leads to, W/m².
    pub irradiance: Rgb,
    cells: &'a [f32; CELLS],
    frame: Frame,
}

impl Facing<'_> {
    /// A direction and its density per unit solid angle.
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let cell = self.cells.partition_point(|&c| c <= u.x).min(CELLS - 1);
        let probability = self.cells[cell] - self.start(cell);
        let inside = (u.x - self.start(cell)) / probability;
        let (column, row) = ((cell % SIDE) as f32, (cell / SIDE) as f32);
        let square = Vec2::new(column + inside.clamp(0.0, 1.0f32.next_down()), row + u.y) / SIDE as f32;
        let local = warp::square_to_cosine_hemisphere(square);
        let pdf = probability * CELLS as f32 * warp::square_to_cosine_hemisphere_pdf(local);
        (self.frame.to_world(local).normalize(), pdf)
    }

    /// Its density per unit solid angle.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        let local = self.frame.to_local(wi);
        self.cell(wi).map_or(0.0, |cell| {
            let probability = self.cells[cell] - self.start(cell);
            probability * CELLS as f32 * warp::square_to_cosine_hemisphere_pdf(local)
        })
    }

    fn start(&self, cell: usize) -> f32 {
        if cell == 0 { 0.0 } else { self.cells[cell - 1] }
    }

    fn cell(&self, wi: Vec3) -> Option<usize> {
        let local = self.frame.to_local(wi);
        let square = warp::disk_to_square(Vec2::new(local.x, local.y));
        let index = |x: f32| ((x * SIDE as f32) as usize).min(SIDE - 1);
        (local.z > 0.0).then(|| index(square.y) * SIDE + index(square.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid_testkit::{ALPHA, Pcg32, SphereTest, sidak};

    /// False-positive rate: `ALPHA`.
    #[test]
    fn directions_follow_the_density() {
        let mut guide = Guide::new(Vec3::new(0.6, 0.0, 0.8));
        for i in 0..50 {
            let wi = Vec3::new(0.5 + i as f32 * 0.005, 0.3, 0.8).normalize();
            guide.add(wi, Rgb::splat(1.0 + (i % 7) as f32), Rgb::WHITE);
        }
        guide.finish();
        let mut rng = Pcg32::new(3);
        let alpha = sidak(ALPHA, 2);
        for normal in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.6, 0.28, 0.75).normalize()] {
            let guide = guide.facing(normal);
            let mut differing = 0;
            let outcome = SphereTest::default().run(
                || {
                    let (wi, pdf) = guide.sample(Vec2::from_array(rng.vec2_f32()));
                    // Next to the edge of a cell rounding decides for one or the other.
                    let same = (guide.pdf(wi) / pdf - 1.0).abs() < 1e-3;
                    differing += u32::from(!same);
                    Some(wi.as_dvec3().to_array())
                },
                |w| f64::from(guide.pdf(Vec3::from_array(w.map(|x| x as f32)))),
            );
            outcome.assert_passes(alpha);
            assert!(differing < 100, "{differing}");
            // Just above the horizon of the surface, on all sides: nothing is left out.
            let frame = Frame::from_normal(normal);
            for i in 0..64 {
                let (sin, cos) = crate::math::real::sin_cos(i as f32 * 0.1);
                let grazing = frame.to_world(Vec3::new(sin, cos, 0.01)).normalize();
                assert!(guide.pdf(grazing) > 0.2 * 0.01 / std::f32::consts::PI);
            }
        }
    }
}
