//! Media whose extinction is given on a grid: null collisions.

use super::Passage;
use super::cells::Cells;
use super::field::Placed;
use super::majorant::Majorants;
use super::profile::Profile;
use super::uniform::{is_grey, shares, sound};
use crate::color::Rgb;
use crate::math::{Ray, Vec3, real};
use crate::sampling::Sampler;

/// An extinction on a grid, and nothing beside it.
#[derive(Clone, Debug)]
pub(super) struct Cloud {
    placed: Placed,
    majorants: Majorants,
}

/// Below this transmittance one in two shadow rays is given up.
const FAINT: f32 = 0.1;

impl Cloud {
    pub fn new(placed: Placed) -> Self {
        let majorants = Majorants::new(&placed.grid);
        Self { placed, majorants }
    }

    #[inline]
    pub fn at(&self, p: Vec3) -> Rgb {
        let cells = self.placed.to_cells(p);
        if self.placed.contains(cells) { self.placed.grid.eval_in_cells(cells) } else { Rgb::BLACK }
    }

    /// Where a ray leaves the grid; 0 if it never meets it.
    pub fn exit(&self, ray: &Ray) -> f32 {
        self.placed.crossing(ray, f32::INFINITY).map_or(0.0, |crossing| crossing.start + crossing.length)
    }

    /// Delta tracking, where a tentative collision is real with a probability that all channels share: the
    /// mean of σ_t over the majorant, weighted by what the channels carry by then. Their weights are
    /// multiplied by what happened over its probability, so what is carried altogether does not change
    /// (spectral tracking with history-aware probabilities, Kutz et al. 2017, doi 10.1145/3072959.3073665).
    ///
    /// `passed` is told of each stretch of the way and of the weights on it, which are right in the mean at each point
    /// of the ray, the chance to come so far included.
    pub fn travel(
        &self,
        ray: &Ray,
        t_max: f32,
        carried: Rgb,
        sampler: &mut Sampler,
        mut passed: impl FnMut(f32, f32, Rgb),
    ) -> Passage {
        let share = shares(carried);
        let (mut weight, mut from) = (Rgb::WHITE, 0.0);
        let collision = self.tentative(ray, t_max, sampler, |t, sigma_t, majorant, sampler| {
            let u = sampler.next_1d();
            if is_grey(sigma_t) {
                return u * majorant < sigma_t.r;
            }
            let carried = share * weight;
            // The rest of the majorant is null collisions.
            let null = sigma_t.map(|sigma| majorant - sigma);
            let (real, unreal) = ((carried * sigma_t).sum(), (carried * null).sum());
            let is_real = u * (real + unreal) < real;
            passed(from, t, sound(weight));
            from = t;
            weight *=
                if is_real { sigma_t } else { null } * (carried.sum() / if is_real { real } else { unreal });
            is_real
        });
        let end = collision.unwrap_or_else(|| t_max.min(self.exit(ray)));
        if from < end {
            passed(from, end, sound(weight));
        }
        match collision {
            Some(t) => Passage::Collision { t, weight: sound(weight) },
            None => Passage::Through { weight: sound(weight) },
        }
    }

    /// Ratio tracking (Novák et al. 2014, doi 10.1145/2661229.2661292): the product of the chances that
    /// tentative collisions are none. Roulette ends what has become faint.
    pub fn transmittance(&self, ray: &Ray, t_max: f32, sampler: &mut Sampler) -> Rgb {
        let mut through = Rgb::WHITE;
        self.tentative(ray, t_max, sampler, |_, sigma_t, majorant, sampler| {
            through *= sigma_t.map(|sigma| 1.0 - sigma / majorant);
            if through.max_channel() < FAINT {
                through = if sampler.next_1d() < 0.5 { through * 2.0 } else { Rgb::BLACK };
            }
            through.is_black()
        });
        through
    }

    /// Goes from one tentative collision to the next until `ends`, which is given the place, the extinction and
    /// the majorant there, says so.
    fn tentative(
        &self,
        ray: &Ray,
        t_max: f32,
        sampler: &mut Sampler,
        mut ends: impl FnMut(f32, Rgb, f32, &mut Sampler) -> bool,
    ) -> Option<f32> {
        let crossing = self.placed.crossing(ray, t_max)?;
        let depth = |sampler: &mut Sampler| -f64::from(real::ln(1.0 - sampler.next_1d()));
        let mut left = depth(sampler);
        for (from, to, majorant) in self.majorants.along(&crossing) {
            // In double precision, or dense media would stand still.
            let (mut s, to, bound) = (f64::from(from), f64::from(to), f64::from(majorant));
            while left < (to - s) * bound {
                s += left / bound;
                // Rounding may have led out of the block.
                let sigma_t =
                    self.placed.grid.eval_in_cells(crossing.at(s as f32)).map(|sigma| sigma.min(majorant));
                // Beside a surface it must not come to lie behind it.
                let t = (crossing.start + s as f32).min(t_max.next_down());
                if ends(t, sigma_t, majorant, sampler) {
                    return Some(t);
                }
                left = depth(sampler);
            }
            left -= (to - s) * bound;
        }
        None
    }

    /// Marches through the boxes between the middles of cells. Along a line inside of one the extinction is
    /// a cubic polynomial, which four of its values give exactly.
    pub fn profile(&self, ray: &Ray, t_max: f32, profile: &mut Profile) {
        let Some(crossing) = self.placed.crossing(ray, t_max) else { return };
        profile.start(crossing.start);
        let boxes = self.placed.grid.size.map(|n| n as usize + 1);
        let middles = crossing.origin + 0.5;
        let value = |s: f32| self.placed.grid.eval_in_cells(crossing.at(s));
        let mut last = (f32::NAN, Rgb::BLACK);
        for (from, to, _) in self.majorants.along(&crossing) {
            for stretch in Cells::new(middles, crossing.direction, from, to, boxes) {
                let length = stretch.to - stretch.from;
                if length > 0.0 {
                    let first = if last.0 == stretch.from { last.1 } else { value(stretch.from) };
                    let at = |part: f32| value(stretch.from + length * part);
                    let values = [first, at(1.0 / 3.0), at(2.0 / 3.0), value(stretch.to)];
                    profile.push(stretch.from, length, values);
                    last = (stretch.to, values[3]);
                }
            }
        }
    }
}
