use crate::math::Vec3;

/// The cells of unit size that a line passes through, in order (Amanatides and Woo 1987, *A Fast Voxel
/// Traversal Algorithm for Ray Tracing*). Each side is computed from its number, so that no error adds up,
/// and the stretches that are given lie end to end.
pub(super) struct Cells {
    origin: Vec3,
    inverse: Vec3,
    cell: [i64; 3],
    count: [i64; 3],
    /// Where it leaves the cell along each axis.
    next: Vec3,
    from: f32,
    to: f32,
    done: bool,
}

/// A cell and the stretch of the line in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub cell: [usize; 3],
    pub from: f32,
    pub to: f32,
}

impl Cells {
    /// Of `count` cells along each axis, from [0, 1]³ on. The line `origin + s · direction` must be inside for
    /// s in [`from`, `to`], to rounding.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3, from: f32, to: f32, count: [usize; 3]) -> Self {
        let start = origin + direction * from;
        let count = count.map(|n| n as i64);
        let cell = std::array::from_fn(|axis| (start[axis].floor() as i64).clamp(0, count[axis] - 1));
        let mut cells = Self {
            origin,
            inverse: direction.recip(),
            cell,
            count,
            next: Vec3::INFINITY,
            from,
            to,
            done: false,
        };
        for axis in 0..3 {
            cells.next[axis] = cells.side(axis);
        }
        cells
    }

    /// Where the line leaves its cell along an axis; never if that would be out of the grid, which is only by
    /// rounding.
    #[inline]
    fn side(&self, axis: usize) -> f32 {
        let forward = i64::from(self.inverse[axis] > 0.0);
        let side = self.cell[axis] + forward;
        if side == 0 || side == self.count[axis] || !self.inverse[axis].is_finite() {
            return f32::INFINITY;
        }
        (side as f32 - self.origin[axis]) * self.inverse[axis]
    }
}

impl Iterator for Cells {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        if self.done {
            return None;
        }
        let axis = self.next.min_position();
        let to = self.next[axis].clamp(self.from, self.to);
        let stretch = Stretch { cell: self.cell.map(|c| c as usize), from: self.from, to };
        self.from = to;
        self.done = self.next[axis] >= self.to;
        if !self.done {
            self.cell[axis] += if self.inverse[axis] > 0.0 { 1 } else { -1 };
            self.next[axis] = self.side(axis);
        }
        Some(stretch)
    }
}

#[cfg(test)]
mod tests {
    use nephroid_testkit::Pcg32;

    use super::*;

    #[test]
    fn stretches_lie_end_to_end_and_in_their_cells() {
        let mut rng = Pcg32::new(3);
        let mut number = || rng.next_f32();
        for _ in 0..2000 {
            let count = [1 + (number() * 6.0) as usize, 1 + (number() * 6.0) as usize, 1];
            let size = Vec3::from_array(count.map(|n| n as f32));
            let (mut a, b) = (
                Vec3::new(number(), number(), number()) * size,
                Vec3::new(number(), number(), number()) * size,
            );
            if number() < 0.3 {
                // From a corner of cells, and along a side of them.
                a = a.floor();
            }
            let mut direction = b - a;
            if number() < 0.3 {
                direction.x = 0.0;
            }
            let stretches: Vec<Stretch> = Cells::new(a, direction, 0.0, 1.0, count).collect();
            assert_eq!((stretches[0].from, stretches[stretches.len() - 1].to), (0.0, 1.0));
            for pair in stretches.windows(2) {
                assert_eq!(pair[0].to, pair[1].from);
                let moved: usize = (0..3).map(|i| pair[0].cell[i].abs_diff(pair[1].cell[i])).sum();
                assert_eq!(moved, 1, "a step to a neighbour");
            }
            for s in &stretches {
                let middle = a + direction * (0.5 * (s.from + s.to));
                let low = Vec3::from_array(s.cell.map(|c| c as f32));
                let off = (low - middle).max(middle - low - 1.0).max_element();
                assert!(s.from <= s.to && off < 2e-6, "{s:?} of {a} {direction}");
            }
        }
    }

    #[test]
    fn a_line_that_stands_still_stays_in_its_cell() {
        let all: Vec<Stretch> = Cells::new(Vec3::splat(1.5), Vec3::ZERO, 0.0, 2.0, [3; 3]).collect();
        assert_eq!(all, [Stretch { cell: [1; 3], from: 0.0, to: 2.0 }]);
    }
}
