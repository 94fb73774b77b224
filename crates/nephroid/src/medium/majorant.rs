use super::Grid;
use super::cells::Cells;
use super::field::Crossing;
use crate::math::{Vec3, gamma};

/// Cells that share a bound along an axis, at least: smaller blocks are tighter, but more of them are crossed.
const MIN_SIDE: u32 = 4;

/// Blocks along an axis, at most.
const MAX_BLOCKS: u32 = 32;

/// Bounds of what a grid's largest channel is in blocks of its cells.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    /// Cells of a block along each axis.
    side: Vec3,
    count: [usize; 3],
    bounds: Vec<f32>,
}

impl Majorants {
    pub fn new(grid: &Grid) -> Self {
        let side = grid.size.map(|n| n.div_ceil(MAX_BLOCKS).max(MIN_SIDE) as usize);
        let size = grid.size.map(|n| n as usize);
        let count: [usize; 3] = std::array::from_fn(|axis| size[axis].div_ceil(side[axis]));
        let mut bounds = Vec::with_capacity(count.iter().product());
        // Up to half a cell inside of its sides, a block has values that are mixed with its neighbours'.
        let reach = |axis: usize, block: usize| {
            let first = block * side[axis];
            first.saturating_sub(1)..(first + side[axis] + 1).min(size[axis])
        };
        for bz in 0..count[2] {
            for by in 0..count[1] {
                for bx in 0..count[0] {
                    let xs = reach(0, bx);
                    let mut bound = 0.0f32;
                    for z in reach(2, bz) {
                        for y in reach(1, by) {
                            let row = (z * size[1] + y) * size[0];
                            bound = bound.max(grid.values.max_channel(row + xs.start..row + xs.end));
                        }
                    }
                    // Interpolation rounds seven times at most.
                    bounds.push(bound * (1.0 + gamma(8)));
                }
            }
        }
        Self { side: Vec3::from_array(side.map(|n| n as f32)), count, bounds }
    }

    /// The stretches of a ray through blocks that are not empty: from where, to where, and the bound there.
    #[inline]
    pub fn along(&self, crossing: &Crossing) -> impl Iterator<Item = (f32, f32, f32)> {
        let (origin, direction) = (crossing.origin / self.side, crossing.direction / self.side);
        Cells::new(origin, direction, 0.0, crossing.length, self.count)
            .map(|stretch| {
                let [x, y, z] = stretch.cell;
                let bound = self.bounds[(z * self.count[1] + y) * self.count[0] + x];
                (stretch.from, stretch.to, bound)
            })
            .filter(|&(from, to, bound)| bound > 0.0 && from < to)
    }
}

#[cfg(test)]
mod tests {
    use nephroid_testkit::Pcg32;

    use super::*;
    use crate::color::Rgb;
    use crate::medium::GridValues;

    #[test]
    fn nothing_in_a_block_is_above_its_bound() {
        let mut rng = Pcg32::new(5);
        for size in [[13, 9, 1], [1, 1, 1], [128, 1, 1], [5, 70, 3]] {
            let cells = size.iter().product::<u32>() as usize;
            let mut value = || if rng.next_f32() < 0.8 { 0.0 } else { rng.next_f32() };
            let values = (0..cells).map(|_| Rgb::new(value(), value(), value())).collect();
            let grid = Grid { name: String::new(), size, values: GridValues::Rgb(values) };
            let majorants = Majorants::new(&grid);
            let extent = Vec3::from_array(size.map(|n| n as f32));
            for _ in 0..500 {
                let mut point = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * extent;
                let (origin, end) = (point(), point());
                let crossing = Crossing { start: 0.0, length: 1.0, origin, direction: end - origin };
                let mut covered = 0.0;
                for (from, to, bound) in majorants.along(&crossing) {
                    assert!((covered..=1.0).contains(&from));
                    for i in 0..=10 {
                        let s = from + (to - from) * (i as f32 / 10.0);
                        let value = grid.eval_in_cells(crossing.at(s)).max_channel();
                        // At the ends of a stretch the point may lie in the next block by rounding.
                        assert!(value <= bound + 1e-5, "{value} > {bound}");
                    }
                    if from > covered {
                        let s = 0.5 * (from + covered);
                        assert!(grid.eval_in_cells(crossing.at(s)).max_channel() < 1e-5, "left out");
                    }
                    covered = to;
                }
            }
        }
    }
}
