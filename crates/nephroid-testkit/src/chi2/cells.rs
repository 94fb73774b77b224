//! The cells of a χ² test and the integrals of a density over them.

use super::Domain;
use crate::{Integral, Tolerance, integrate_2d};

/// A grid of rectangles; cell `i` is in column `i % columns` and row `i / columns`.
pub(super) struct Grid {
    /// Ascending boundaries along both axes, the domain's included.
    edges: [Vec<f64>; 2],
}

impl Grid {
    /// Cuts the domain into at most `resolution` cells: half of the boundaries equidistant, half at quantiles of
    /// `pilot` samples, which must not be used again.
    pub(super) fn new(domain: Domain, resolution: [usize; 2], pilot: &[[f64; 2]]) -> Self {
        let edges = [0, 1].map(|axis| {
            let (min, max) = (domain.min[axis], domain.max[axis]);
            assert!(min < max, "an empty domain: {domain:?}");
            let mut sorted: Vec<f64> = pilot.iter().map(|point| point[axis]).collect();
            sorted.sort_by(f64::total_cmp);
            let uniform = (resolution[axis] / 2).max(1);
            let quantiles = resolution[axis].saturating_sub(uniform);
            let mut edges: Vec<f64> =
                (1..uniform).map(|i| min + (max - min) * i as f64 / uniform as f64).collect();
            edges
                .extend((1..=quantiles).filter_map(|i| quantile(&sorted, i as f64 / (quantiles + 1) as f64)));
            edges.extend([min, max]);
            edges.sort_by(f64::total_cmp);
            edges.dedup();
            edges
        });
        Self { edges }
    }

    fn columns(&self) -> usize {
        self.edges[0].len() - 1
    }

    fn rows(&self) -> usize {
        self.edges[1].len() - 1
    }

    /// Distributes points of the domain to the cells.
    pub(super) fn sort(&self, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let mut cells = vec![Vec::new(); self.columns() * self.rows()];
        for &point in points {
            let [column, row] = [0, 1].map(|axis| {
                let edges = &self.edges[axis];
                edges[1..edges.len() - 1].partition_point(|&edge| edge <= point[axis])
            });
            cells[row * self.columns() + column].push(point);
        }
        cells
    }

    /// Integrates a density over one cell; the points in it show where the density is concentrated.
    pub(super) fn integrate(
        &self,
        cell: usize,
        points: &[[f64; 2]],
        density: impl Fn([f64; 2]) -> f64,
        tolerance: Tolerance,
    ) -> Integral {
        let [x, y] = [0, 1].map(|axis| {
            let [a, b] = self.bounds(cell)[axis];
            let mut sorted: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            sorted.sort_by(f64::total_cmp);
            let mut breakpoints = vec![a];
            split(a, b, &sorted, MAX_DEPTH, &mut breakpoints);
            breakpoints.push(b);
            breakpoints
        });
        integrate_2d(density, &x, &y, tolerance)
    }

    /// Words for a cell, or for the one beyond the last, which is the outside.
    pub(super) fn describe(&self, cell: usize) -> String {
        if cell >= self.columns() * self.rows() {
            return "the outside".to_owned();
        }
        let [[left, right], [low, high]] = self.bounds(cell);
        format!("[{left:.6}, {right:.6}] × [{low:.6}, {high:.6}]")
    }

    fn bounds(&self, cell: usize) -> [[f64; 2]; 2] {
        let index = [cell % self.columns(), cell / self.columns()];
        [0, 1].map(|axis| [self.edges[axis][index[axis]], self.edges[axis][index[axis] + 1]])
    }
}

/// Halvings of a cell at most: down to the last bits of double precision.
const MAX_DEPTH: u32 = 50;

/// The point below which a share of the sorted values lies: between two of them, so that values on a grid
/// (single precision, say) do not coincide with it. None if there are too few.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let above = (share * sorted.len() as f64) as usize;
    let (low, high) = (sorted.get(above.checked_sub(1)?)?, sorted.get(above)?);
    Some(0.5 * (low + high))
}

/// Appends, in ascending order, points that halve the interval from `a` to `b`, and the halves again, until the
/// sorted `values` look uniformly distributed over each part.
///
/// Quadrature would overlook a lobe between its nodes, be it one of several or on a wide pedestal, but the samples
/// show it. Uniform is what Pearson's statistic of the counts in the four quarters does not refute.
fn split(a: f64, b: f64, values: &[f64], depth: u32, breakpoints: &mut Vec<f64>) {
    /// Of a χ² distribution with three degrees of freedom one part in a thousand lies above.
    const REFUTED: f64 = 16.3;
    let middle = 0.5 * (a + b);
    let quarters = [0.5 * (a + middle), middle, 0.5 * (middle + b)];
    let [first, second, third] = quarters.map(|q| values.partition_point(|&v| v < q));
    let counts = [first, second - first, third - second, values.len() - third];
    let mean = 0.25 * values.len() as f64;
    let squares: f64 = counts.iter().map(|&count| (count as f64 - mean) * (count as f64 - mean)).sum();
    if squares <= REFUTED * mean || depth == 0 || middle <= a || middle >= b {
        return;
    }
    split(a, middle, &values[..second], depth - 1, breakpoints);
    breakpoints.push(middle);
    split(middle, b, &values[second..], depth - 1, breakpoints);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn every_point_is_sorted_into_the_cell_that_contains_it() {
        let mut rng = Pcg32::new(1);
        let pilot: Vec<_> = (0..100).map(|_| rng.vec2()).collect();
        let grid = Grid::new(Domain::UNIT_SQUARE, [5, 8], &pilot);
        assert_eq!((grid.columns(), grid.rows()), (5, 8));
        let mut points: Vec<_> = (0..1000).map(|_| rng.vec2()).collect();
        points.extend([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let cells = grid.sort(&points);
        assert_eq!(cells.iter().map(Vec::len).sum::<usize>(), points.len());
        for (i, cell) in cells.iter().enumerate() {
            let [[left, right], [low, high]] = grid.bounds(i);
            assert!(cell.iter().all(|p| (left..=right).contains(&p[0]) && (low..=high).contains(&p[1])));
        }
    }

    #[test]
    fn without_a_pilot_the_cells_are_equidistant() {
        let grid = Grid::new(Domain { min: [-1.0, 0.0], max: [1.0, 8.0] }, [4, 8], &[]);
        assert_eq!(grid.edges, [vec![-1.0, 0.0, 1.0], vec![0.0, 2.0, 4.0, 6.0, 8.0]]);
        assert_eq!(grid.describe(1), "[0.000000, 1.000000] × [0.000000, 2.000000]");
        assert_eq!(grid.describe(8), "the outside");
    }

    #[test]
    fn spread_values_split_nothing_and_concentrated_ones_are_closed_in_on() {
        let breakpoints = |values: &[f64]| {
            let mut breakpoints = Vec::new();
            split(0.0, 1.0, values, MAX_DEPTH, &mut breakpoints);
            assert!(breakpoints.is_sorted());
            breakpoints
        };
        let spread: Vec<f64> = (0..100).map(|i| f64::from(i) / 100.0).collect();
        assert!(breakpoints(&spread).is_empty());
        assert!(breakpoints(&[]).is_empty());
        // Two needles, on a pedestal that holds most of the values.
        let needles = |x: &f64| [*x, *x, *x, *x, 0.1 + 1e-7 * x, 0.9 + 1e-7 * x];
        let mut values: Vec<f64> = spread.iter().flat_map(needles).collect();
        values.sort_by(f64::total_cmp);
        for needle in [0.1, 0.9] {
            let near = |b: &&f64| (needle..needle + 1e-7).contains(*b);
            assert!(breakpoints(&values).iter().filter(near).count() > 0);
        }
        assert!(breakpoints(&[0.3; 100]).len() <= 50);
    }

    #[test]
    fn the_points_let_the_quadrature_find_a_needle() {
        let mut rng = Pcg32::new(2);
        let width = 1e-8;
        let density = |[x, y]: [f64; 2]| {
            let hat = |t: f64| (1.0 - t.abs()).max(0.0) / width;
            hat((x - 0.3) / width) * hat((y - 0.7) / width)
        };
        let mut tent = |centre: f64| centre + width * (rng.next_f64() - rng.next_f64());
        let points: Vec<_> = (0..1000).map(|_| [tent(0.3), tent(0.7)]).collect();
        let grid = Grid::new(Domain::UNIT_SQUARE, [1, 1], &[]);
        let tolerance = Tolerance { absolute: 1e-5, relative: 1e-4 };
        assert_eq!(grid.integrate(0, &[], density, tolerance).value, 0.0);
        let found = grid.integrate(0, &points, density, tolerance).value;
        assert!((found - 1.0).abs() < 1e-4, "{found}");
    }
}
