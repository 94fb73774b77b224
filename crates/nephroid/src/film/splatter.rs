use super::{Crop, FilmSettings, Filter, FilterSampler};
use crate::math::Vec2;

/// Gives light that arrives at a point of the film to the pixels it counts for.
#[derive(Clone, Debug)]
pub(crate) struct Splatter {
    filter: Filter,
    window: Crop,
    /// 1/∫f along one axis.
    scale: f32,
}

impl Splatter {
    /// For the pixels of a film's window. An invalid filter counts as the box.
    pub fn new(film: &FilmSettings) -> Self {
        let filter = if film.filter.is_valid() { film.filter } else { Filter::Box };
        let scale = (1.0 / FilterSampler::new(filter).integral()) as f32;
        Self { filter, window: film.window(), scale }
    }

    /// Whether any pixel of the window has to do with a position, in pixels of the whole picture.
    pub fn covers(&self, position: Vec2) -> bool {
        let Crop { x, y, width, height } = self.window;
        let (first, last) = self.reach(position.x, x, width);
        let (top, bottom) = self.reach(position.y, y, height);
        first < last && top < bottom
    }

    /// Tells of each pixel of the window whose filter covers a position its index, row by row, and the filter's
    /// value there with an integral of 1. In the mean over positions that are spread evenly, with n of them on each
    /// pixel's area, the values of a pixel add up to n.
    pub fn each(&self, position: Vec2, mut visit: impl FnMut(u32, f32)) {
        let Crop { x, y, width, height } = self.window;
        let (first, last) = self.reach(position.x, x, width);
        let (top, bottom) = self.reach(position.y, y, height);
        let value = |p: f32, pixel: u32| self.scale * self.filter.eval_axis(p - (pixel as f32 + 0.5));
        for row in top..bottom {
            let along_y = value(position.y, row);
            for column in first..last {
                visit((row - y) * width + column - x, along_y * value(position.x, column));
            }
        }
    }

    /// The pixels along one axis, of `count` from `start` on, whose centre is nearer than the radius; on the edge
    /// between two boxes the second.
    fn reach(&self, p: f32, start: u32, count: u32) -> (u32, u32) {
        let radius = self.filter.radius();
        let after = |edge: f32| (edge.floor().max(-1.0) + 1.0) as u32;
        (after(p - 0.5 - radius).max(start), after(p - 0.5 + radius).min(start + count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILTERS: [Filter; 5] = [
        Filter::Box,
        Filter::Tent { radius: 1.3 },
        Filter::Gaussian { std_dev: 0.5 },
        Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        Filter::Gaussian { std_dev: -1.0 },
    ];

    fn splatter(filter: Filter) -> Splatter {
        let crop = Some(Crop { x: 3, y: 2, width: 5, height: 4 });
        Splatter::new(&FilmSettings { width: 20, height: 10, crop, filter })
    }

    #[test]
    fn a_box_is_one_pixel() {
        let splatter = splatter(Filter::Box);
        for (position, pixel) in [
            (Vec2::new(3.0, 2.0), Some(0)),
            (Vec2::new(4.0, 2.0), Some(1)),
            (Vec2::new(7.999, 5.999), Some(19)),
            (Vec2::new(2.999, 2.5), None),
            (Vec2::new(8.0, 2.5), None),
            (Vec2::new(-1e9, 2.5), None),
            (Vec2::new(1e30, f32::NAN), None),
        ] {
            let mut found = Vec::new();
            splatter.each(position, |index, value| found.push((index, value)));
            assert_eq!(found, pixel.map(|index| (index, 1.0)).into_iter().collect::<Vec<_>>(), "{position}");
            assert_eq!(splatter.covers(position), pixel.is_some());
        }
    }

    /// A fine lattice over film and surroundings: every pixel of the window gets as much.
    #[test]
    fn evenly_spread_light_is_even_up_to_the_edges_of_the_window() {
        for filter in FILTERS {
            let (splatter, fine) = (splatter(filter), 32);
            let mut sums = [0.0f64; 20];
            for i in -5 * fine..20 * fine {
                for k in -5 * fine..20 * fine {
                    let position = (Vec2::new(i as f32, k as f32) + 0.5) / fine as f32;
                    let mut met = false;
                    splatter.each(position, |index, value| {
                        sums[index as usize] += f64::from(value) / f64::from(fine * fine);
                        met = true;
                    });
                    assert_eq!(met, splatter.covers(position), "{filter:?} at {position}");
                }
            }
            for sum in sums {
                assert!((sum - 1.0).abs() < 2e-3, "{filter:?}: {sum}");
            }
        }
    }
}
