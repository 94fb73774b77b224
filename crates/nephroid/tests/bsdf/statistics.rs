//! Random numbers, quadrature and the two tests of hypotheses that the materials need.

use nephroid::math::{Frame, Vec2, Vec3, real};

/// SplitMix64 (Steele, Lea and Flood 2014), enough for tests.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 40) as f32) / (1u64 << 24) as f32
    }

    pub fn square(&mut self) -> Vec2 {
        Vec2::new(self.next(), self.next())
    }
}

/// Rows and columns of the cells that divide the sphere, all of one solid angle.
pub const ROWS: usize = 16;
pub const COLUMNS: usize = 32;

/// The cell of a direction, with row 0 at the foot of the axis.
pub fn cell(axis: &Frame, w: Vec3) -> usize {
    let local = axis.to_local(w);
    let turn = (real::atan2(local.y, local.x) / std::f32::consts::TAU).rem_euclid(1.0);
    let row = ((0.5 + 0.5 * local.z) * ROWS as f32) as usize;
    let column = (turn * COLUMNS as f32) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// The integral of `f` over each cell: by Gauss's rule of two points in the angle to the axis and the
/// midpoint rule round it, on 24 × 24 parts of each cell. Lobes of width 0.03 come out to 1e-4.
pub fn integrate(axis: &Frame, f: impl Fn(Vec3) -> f64) -> Vec<f64> {
    integrate_on(24, axis, f)
}

/// The same on `fine` × `fine` parts of each cell.
pub fn integrate_on(fine: usize, axis: &Frame, f: impl Fn(Vec3) -> f64) -> Vec<f64> {
    let turn = std::f64::consts::TAU / (COLUMNS * fine) as f64;
    let around: Vec<_> = (0..COLUMNS * fine).map(|i| real::sin_cos(turn as f32 * (i as f32 + 0.5))).collect();
    let mut integrals = vec![0.0; ROWS * COLUMNS];
    for row in 0..ROWS {
        let edge = |row: usize| libm::acos(2.0 * row as f64 / ROWS as f64 - 1.0);
        let (high, low) = (edge(row), edge(row + 1));
        let step = (high - low) / fine as f64;
        for point in 0..2 * fine {
            let gauss = if point % 2 == 0 { -1.0 } else { 1.0 } / (2.0 * 3.0f64.sqrt());
            let theta = low + step * ((point / 2) as f64 + 0.5 + gauss);
            let (sin, cos) = (libm::sin(theta), libm::cos(theta));
            let weight = 0.5 * step * turn * sin;
            for (i, (sin_phi, cos_phi)) in around.iter().enumerate() {
                let local = Vec3::new(sin as f32 * cos_phi, sin as f32 * sin_phi, cos as f32);
                integrals[row * COLUMNS + i / fine] += weight * f(axis.to_world(local));
            }
        }
    }
    integrals
}

/// The chance, for each of `tests` independent tests, at which one rejection among all of them has a
/// chance of 1 % (Šidák 1967).
pub fn significance(tests: usize) -> f64 {
    -libm::expm1(libm::log1p(-0.01) / tests as f64)
}

/// Mean and its variance, by Welford's recurrence.
#[derive(Default)]
pub struct Mean {
    count: f64,
    pub value: f64,
    squares: f64,
}

impl Mean {
    pub fn add(&mut self, x: f64) {
        self.count += 1.0;
        let delta = x - self.value;
        self.value += delta / self.count;
        self.squares += delta * (x - self.value);
    }

    pub fn variance(&self) -> f64 {
        self.squares / (self.count * (self.count - 1.0))
    }
}

/// The chance that two correct estimates of one number differ by more. `rounding` is what arithmetic
/// may add, relative to the number.
pub fn z_test(a: f64, b: f64, variance: f64, rounding: f64) -> f64 {
    let difference = ((a - b).abs() - rounding * a.abs().max(b.abs())).max(0.0);
    if difference == 0.0 { 1.0 } else { libm::erfc(difference / (2.0 * variance).sqrt()) }
}

/// Pearson's chi² test: the chance of a larger statistic. Cells with fewer than five expected are
/// counted together. The tail is by Wilson and Hilferty (1931).
pub fn chi_square(observed: &[f64], expected: &[f64]) -> f64 {
    let mut cells: Vec<(f64, f64)> = expected.iter().copied().zip(observed.iter().copied()).collect();
    cells.sort_by(|a, b| b.0.total_cmp(&a.0));
    let large = cells.partition_point(|cell| cell.0 >= 5.0);
    let rest = cells.split_off(large).iter().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
    match cells.last_mut() {
        Some(last) if rest.0 < 5.0 => *last = (last.0 + rest.0, last.1 + rest.1),
        _ => cells.push(rest),
    }
    let statistic: f64 = cells.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    let freedom = cells.len() as f64 - 1.0;
    assert!(freedom >= 1.0, "a test of one cell says nothing");
    let spread = 2.0 / (9.0 * freedom);
    let z = (libm::cbrt(statistic / freedom) - (1.0 - spread)) / spread.sqrt();
    0.5 * libm::erfc(z / std::f64::consts::SQRT_2)
}

#[test]
fn chi_square_has_the_values_of_the_tables() {
    // 5 % points: 18.307 with 10 degrees of freedom, 124.342 with 100.
    for (freedom, point) in [(10usize, 18.307f64), (100, 124.342)] {
        let expected = vec![100.0; freedom + 1];
        let mut observed = expected.clone();
        observed[0] += 10.0 * (point / 2.0).sqrt();
        observed[1] -= 10.0 * (point / 2.0).sqrt();
        assert!((chi_square(&observed, &expected) - 0.05).abs() < 1e-3);
    }
}

#[test]
fn quadrature_has_known_integrals() {
    let axis = Frame::from_normal(Vec3::new(0.6, 0.0, 0.8));
    let integral = |f: &dyn Fn(Vec3) -> f64| integrate(&axis, f).iter().sum::<f64>();
    assert!((integral(&|_| 1.0) - 4.0 * std::f64::consts::PI).abs() < 1e-6);
    let lobe = |about: Vec3| move |w: Vec3| libm::pow(f64::from(w.dot(about).max(0.0)), 1000.0);
    for about in [axis.n, axis.s, (axis.n + axis.t).normalize()] {
        let expected = std::f64::consts::TAU / 1001.0;
        assert!((integral(&lobe(about)) / expected - 1.0).abs() < 3e-4);
    }
    let cells = integrate(&axis, |w| f64::from(cell(&axis, w) == 77));
    assert!((cells[77] - 4.0 * std::f64::consts::PI / 512.0).abs() < 1e-4);
}
