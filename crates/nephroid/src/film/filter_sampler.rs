use super::Filter;
use crate::math::Vec2;

/// Where a sample of a pixel lies and what it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample {
    /// From the pixel's centre, in pixels.
    pub offset: Vec2,
    /// Its share in the pixel: 1 on average; below zero in a negative lobe.
    pub weight: f32,
}

/// Filter importance sampling (Ernst, Stamminger and Greiner, *Filter Importance Sampling*, 2006):
/// samples of a pixel are spread as the filter is, so each belongs to one pixel only and pixels
/// stay independent of each other.
///
/// The density is ∝ |f|, and the weight is the sign of f times ∫|f| / ∫f: exactly 1 for filters
/// without negative lobes. Gaussian and Mitchell are sampled as broken lines of about a thousand
/// pieces, whose cumulative distributions are inverted exactly. An invalid filter
/// ([`Filter::is_valid`]) is sampled as the box.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterSampler {
    axis: Axis,
    /// (∫|f| / ∫f)², for both axes together.
    weight: f32,
}

/// How one coordinate is drawn.
#[derive(Clone, Debug, PartialEq)]
enum Axis {
    Box,
    Tent { radius: f32 },
    Table(Table),
}

impl FilterSampler {
    /// Prepares to sample the filter.
    pub fn new(filter: Filter) -> Self {
        let axis = match filter {
            _ if !filter.is_valid() => Axis::Box,
            Filter::Box => Axis::Box,
            Filter::Tent { radius } => Axis::Tent { radius },
            Filter::Gaussian { .. } | Filter::Mitchell { .. } => Axis::Table(Table::new(filter, CELLS)),
        };
        let weight = match &axis {
            Axis::Box | Axis::Tent { .. } => 1.0,
            Axis::Table(table) => (table.total() / table.signed_total()).powi(2) as f32,
        };
        Self { axis, weight }
    }

    /// ∫f along one axis, of the f that is sampled.
    pub(super) fn integral(&self) -> f64 {
        match &self.axis {
            Axis::Box => 1.0,
            Axis::Tent { radius } => f64::from(*radius),
            Axis::Table(table) => 2.0 * table.signed_total(),
        }
    }

    /// The sample for `u` in [0, 1)². Each offset grows with its coordinate of `u`, so stratified
    /// points stay stratified.
    #[inline]
    pub fn sample(&self, u: Vec2) -> FilterSample {
        let (x, negative_x) = self.axis.sample(u.x);
        let (y, negative_y) = self.axis.sample(u.y);
        let weight = if negative_x == negative_y { self.weight } else { -self.weight };
        FilterSample { offset: Vec2::new(x, y), weight }
    }
}

impl Axis {
    /// The coordinate for `u`, and whether the filter is negative there.
    fn sample(&self, u: f32) -> (f32, bool) {
        // All filters are even: the distance from the centre comes from |2u − 1|.
        let t = 2.0 * u - 1.0;
        let (distance, negative) = match self {
            Self::Box => (0.5 * t.abs(), false),
            // 1 − √(1 − t), in a form that keeps small distances exact.
            Self::Tent { radius } => (radius * t.abs() / (1.0 + (1.0 - t.abs()).max(0.0).sqrt()), false),
            Self::Table(table) => table.sample(f64::from(t.abs())),
        };
        (distance.copysign(t), negative)
    }
}

/// A filter on [0, radius] as a broken line with a node at each change of sign.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    /// Places of the nodes.
    x: Vec<f64>,
    /// |f| at the nodes.
    density: Vec<f64>,
    /// Area under |f| up to each node.
    area: Vec<f64>,
    /// Whether f is negative from each node to the next.
    negative: Vec<bool>,
}

/// Pieces of a table. The areas of broken line and bell differ by 1.3e-6 of the area.
const CELLS: usize = 1024;

impl Table {
    fn new(filter: Filter, cells: usize) -> Self {
        let radius = f64::from(filter.radius());
        let node = |i: usize| {
            let x = radius * i as f64 / cells as f64;
            (x, f64::from(filter.eval_axis(x as f32)))
        };
        let (x, f) = node(0);
        let mut table = Self { x: vec![x], density: vec![f.abs()], area: vec![0.0], negative: Vec::new() };
        let mut last = (x, f);
        for i in 1..=cells {
            let (x, f) = node(i);
            if last.1 * f < 0.0 {
                table.push(last.0 + (x - last.0) * last.1 / (last.1 - f), 0.0, last.1 < 0.0);
            }
            table.push(x, f.abs(), if f == 0.0 { last.1 < 0.0 } else { f < 0.0 });
            last = (x, f);
        }
        table
    }

    fn push(&mut self, x: f64, density: f64, negative: bool) {
        let last = self.x.len() - 1;
        let area = 0.5 * (self.density[last] + density) * (x - self.x[last]);
        self.area.push(self.area[last] + area);
        self.x.push(x);
        self.density.push(density);
        self.negative.push(negative);
    }

    /// ∫|f| over [0, radius].
    fn total(&self) -> f64 {
        self.area[self.area.len() - 1]
    }

    /// ∫f over [0, radius].
    fn signed_total(&self) -> f64 {
        let areas = self.area.windows(2).map(|a| a[1] - a[0]);
        areas.zip(&self.negative).map(|(a, &negative)| if negative { -a } else { a }).sum()
    }

    /// The distance below which lies the fraction `u` of the area, and whether f is negative there.
    fn sample(&self, u: f64) -> (f32, bool) {
        let area = u * self.total();
        let cells = self.negative.len();
        let i = self.area[1..cells].partition_point(|&a| a <= area);
        let (x0, x1) = (self.x[i], self.x[i + 1]);
        let cell = self.area[i + 1] - self.area[i];
        let v = if cell > 0.0 { ((area - self.area[i]) / cell).clamp(0.0, 1.0) } else { 0.0 };
        let (a, b) = (self.density[i], self.density[i + 1]);
        // Inverts v = (2at + (b − a)t²) / (a + b).
        let root = (a * a + v * (b * b - a * a)).max(0.0).sqrt();
        let t = if a + root > 0.0 { v * (a + b) / (a + root) } else { 0.0 };
        ((x0 + t.min(1.0) * (x1 - x0)) as f32, self.negative[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filters() -> [Filter; 8] {
        [
            Filter::Box,
            Filter::Tent { radius: 1.0 },
            Filter::Tent { radius: 0.3 },
            Filter::Gaussian { std_dev: 0.5 },
            Filter::Gaussian { std_dev: 1.7 },
            Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
            Filter::Mitchell { b: 0.0, c: 0.5 },
            Filter::Mitchell { b: 1.0, c: 0.0 },
        ]
    }

    /// ∫ g(x, f(x)) dx over the filter's support up to `end`, by the midpoint rule.
    fn integrate(filter: Filter, end: f32, g: impl Fn(f64, f64) -> f64) -> f64 {
        let n = 20_000;
        let start = f64::from(-filter.radius());
        let h = (f64::from(end) - start) / f64::from(n);
        let at = |i: i32| start + (f64::from(i) + 0.5) * h;
        (0..n).map(|i| g(at(i), f64::from(filter.eval_axis(at(i) as f32)))).sum::<f64>() * h
    }

    #[test]
    fn one_axis_is_distributed_as_the_absolute_filter() {
        for filter in filters() {
            let sampler = FilterSampler::new(filter);
            let total = integrate(filter, filter.radius(), |_, f| f.abs());
            let mut last = -filter.radius();
            for i in 0..=400u16 {
                let u = (f32::from(i) / 400.0).min(1.0 - f32::EPSILON);
                let x = sampler.sample(Vec2::new(u, 0.5)).offset.x;
                assert!(x >= last && x <= filter.radius(), "{filter:?}: {x} after {last}");
                let below = integrate(filter, x, |_, f| f.abs()) / total;
                assert!((below - f64::from(u)).abs() < 2e-5, "{filter:?}: {below} for {u}");
                last = x;
            }
        }
    }

    #[test]
    fn a_coarse_table_is_inverted_exactly() {
        for filter in [Filter::Gaussian { std_dev: 1.0 }, Filter::Mitchell { b: 0.0, c: 0.8 }] {
            let table = Table::new(filter, 5);
            for i in 0..200u16 {
                let u = (f64::from(i) + 0.5) / 200.0;
                let x = f64::from(table.sample(u).0);
                let cell = table.x.partition_point(|&node| node <= x) - 1;
                let (x0, x1) = (table.x[cell], table.x[cell + 1]);
                let (a, b) = (table.density[cell], table.density[cell + 1]);
                let at_x = a + (b - a) * (x - x0) / (x1 - x0);
                let area = table.area[cell] + 0.5 * (a + at_x) * (x - x0);
                assert!((area / table.total() - u).abs() < 1e-6, "{filter:?}: {area} at {x}");
            }
        }
    }

    #[test]
    fn weighted_samples_integrate_against_the_filter() {
        for filter in filters() {
            let sampler = FilterSampler::new(filter);
            let total = integrate(filter, filter.radius(), |_, f| f);
            let second = integrate(filter, filter.radius(), |x, f| x * x * f) / total;
            // A lattice of low discrepancy (Kronecker), so that no statistics is involved.
            let n = 200_000u32;
            let u = |i: u32, step: f64| ((f64::from(i) * step).fract() as f32).min(1.0 - f32::EPSILON);
            let (mut one, mut xx, mut xxyy) = (0.0, 0.0, 0.0);
            for i in 0..n {
                let s = sampler.sample(Vec2::new(u(i, 0.754_877_666_246_7), u(i, 0.569_840_290_998_1)));
                let (x, y, w) = (f64::from(s.offset.x), f64::from(s.offset.y), f64::from(s.weight));
                one += w;
                xx += w * x * x;
                xxyy += w * x * x * y * y;
            }
            let count = f64::from(n);
            let scale = f64::from(filter.radius()).powi(2);
            assert!((one / count - 1.0).abs() < 5e-4, "{filter:?}: mean weight {}", one / count);
            assert!((xx / count - second).abs() < 5e-4 * scale, "{filter:?}: {} {second}", xx / count);
            let product = second * second;
            assert!((xxyy / count - product).abs() < 5e-4 * scale * scale, "{filter:?}: {product}");
        }
    }

    #[test]
    fn weights_are_the_signs_of_the_filter() {
        for filter in filters() {
            let sampler = FilterSampler::new(filter);
            let absolute = integrate(filter, filter.radius(), |_, f| f.abs());
            let ratio = absolute / integrate(filter, filter.radius(), |_, f| f);
            for i in 0..100u16 {
                let u = Vec2::new((f32::from(i) + 0.3) / 100.0, (f32::from(i * 37 % 100) + 0.7) / 100.0);
                let s = sampler.sample(u);
                let f = filter.eval_axis(s.offset.x) * filter.eval_axis(s.offset.y);
                let expected = ratio * ratio * f64::from(f.signum());
                assert!((f64::from(s.weight) - expected).abs() < 1e-4, "{filter:?}: {s:?}, not {expected}");
            }
        }
    }

    #[test]
    fn positive_filters_weigh_exactly_one() {
        for filter in filters().into_iter().take(5) {
            assert_eq!(FilterSampler::new(filter).sample(Vec2::new(0.9, 0.2)).weight, 1.0, "{filter:?}");
        }
    }

    #[test]
    fn invalid_filters_are_sampled_as_the_box() {
        let sampler = FilterSampler::new(Filter::Gaussian { std_dev: f32::NAN });
        let sample = sampler.sample(Vec2::new(0.75, 0.0));
        assert_eq!(sample, FilterSample { offset: Vec2::new(0.25, -0.5), weight: 1.0 });
    }
}
