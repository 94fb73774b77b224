use crate::math::Vec2;

/// A table of outcomes with given weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete {
    /// Probability of all outcomes up to and including each; the last is 1.
    cdf: Vec<f64>,
    total: f64,
}

impl Discrete {
    /// `None` if there is no outcome of positive weight. Negative and non-finite weights count as 0.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut total = 0.0;
        let mut cdf: Vec<f64> = weights
            .into_iter()
            .map(|w| {
                total += if w.is_finite() && w > 0.0 { w } else { 0.0 };
                total
            })
            .collect();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        for c in &mut cdf {
            *c /= total;
        }
        Some(Self { cdf, total })
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// How many outcomes.
    pub fn len(&self) -> usize {
        self.cdf.len()
    }

    /// Whether there are none; never, as built.
    pub fn is_empty(&self) -> bool {
        self.cdf.is_empty()
    }

    /// An outcome, its probability, and where in its interval `u` lay, in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let u = f64::from(u);
        // The first outcome whose cumulative probability exceeds u: never one of probability 0.
        let mut i = self.cdf.partition_point(|&c| c <= u).min(self.cdf.len() - 1);
        while self.probability(i) <= 0.0 && i > 0 {
            i -= 1;
        }
        let p = self.probability(i);
        let inside = ((u - (self.cdf[i] - p)) / p) as f32;
        (i, p as f32, inside.clamp(0.0, 1.0f32.next_down()))
    }

    /// Probability of outcome `i`.
    #[inline]
    pub fn pmf(&self, i: usize) -> f32 {
        self.probability(i) as f32
    }

    #[inline]
    fn probability(&self, i: usize) -> f64 {
        if i == 0 { self.cdf[0] } else { self.cdf[i] - self.cdf[i - 1] }
    }
}

/// A piecewise constant density on the unit square, `width` by `height` cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete2d {
    rows: Discrete,
    columns: Vec<Option<Discrete>>,
    width: usize,
    height: usize,
}

impl Discrete2d {
    /// `weights` holds `height` rows of `width`. `None` if none is positive.
    pub fn new(weights: &[f64], width: usize, height: usize) -> Option<Self> {
        let columns: Vec<_> = weights.chunks_exact(width).map(|r| Discrete::new(r.iter().copied())).collect();
        let rows = Discrete::new(columns.iter().map(|c| c.as_ref().map_or(0.0, Discrete::total)))?;
        Some(Self { rows, columns, width, height })
    }

    /// A point of the square and its density per unit area.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, p_row, y) = self.rows.sample(u.y);
        let Some(columns) = &self.columns[row] else { return (Vec2::ZERO, 0.0) };
        let (column, p_column, x) = columns.sample(u.x);
        let point = Vec2::new((column as f32 + x) / self.width as f32, (row as f32 + y) / self.height as f32);
        (point, p_row * p_column * (self.width * self.height) as f32)
    }

    /// Density at a point, per unit area.
    pub fn pdf(&self, point: Vec2) -> f32 {
        let cell = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
        let row = cell(point.y, self.height);
        let Some(columns) = &self.columns[row] else { return 0.0 };
        let column = cell(point.x, self.width);
        self.rows.pmf(row) * columns.pmf(column) * (self.width * self.height) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_come_in_proportion_and_impossible_ones_never() {
        let table = Discrete::new([0.0, 1.0, 0.0, 3.0, f64::NAN, -1.0]).unwrap();
        assert_eq!(table.total(), 4.0);
        let mut counts = [0; 6];
        for i in 0..4000 {
            let (k, p, inside) = table.sample(i as f32 / 4000.0);
            counts[k] += 1;
            assert_eq!(p, table.pmf(k));
            assert!((0.0..1.0).contains(&inside));
        }
        assert_eq!(counts, [0, 1000, 0, 3000, 0, 0]);
        assert_eq!(table.sample(1.0f32.next_down()).0, 3);
        assert!(Discrete::new([0.0, -2.0]).is_none());
        assert!(Discrete::new([]).is_none());
    }

    #[test]
    fn the_plane_density_integrates_to_one_and_matches_its_samples() {
        let (w, h) = (4, 2);
        let weights = [1.0, 2.0, 0.0, 1.0, 0.0, 0.0, 4.0, 0.0];
        let table = Discrete2d::new(&weights, w, h).unwrap();
        let mut sum = 0.0;
        for y in 0..h {
            for x in 0..w {
                let p = table.pdf(Vec2::new((x as f32 + 0.5) / 4.0, (y as f32 + 0.5) / 2.0));
                assert!((p - weights[y * w + x] as f32).abs() < 1e-6);
                sum += p / 8.0;
            }
        }
        assert!((sum - 1.0).abs() < 1e-6);
        let (point, p) = table.sample(Vec2::new(0.9, 0.9));
        assert_eq!(p, table.pdf(point));
    }
}
