use super::Vec3;

/// A half-line from `origin`, valid on (0, `t_max`) along `direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: Vec3,
    /// Direction; unit length unless said otherwise.
    pub direction: Vec3,
    /// Intersections at or beyond this multiple of `direction` do not count.
    pub t_max: f32,
}

impl Ray {
    /// A ray without an end.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Bound of the relative error after `n` roundings: nε / (1 − nε) (Higham 2002, lemma 3.1).
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let e = n as f32 * (f32::EPSILON * 0.5);
    e / (1.0 - e)
}

/// Moves `p` off its surface, to the side of `direction`, by just more than its error.
///
/// `p_error` bounds the error of each coordinate of `p`, and `n` is the geometric normal. No
/// absolute distance enters: scaling a scene by a power of two scales the result exactly
/// (the scheme of Pharr, Jakob and Humphreys 2023, §6.8.6).
#[inline]
pub fn offset_origin(p: Vec3, p_error: Vec3, n: Vec3, direction: Vec3) -> Vec3 {
    let distance = n.abs().dot(p_error);
    let offset = if direction.dot(n) < 0.0 { -n * distance } else { n * distance };
    let q = p + offset;
    Vec3::new(away(q.x, offset.x), away(q.y, offset.y), away(q.z, offset.z))
}

/// The next float after `x` in the direction of the sign of `towards`.
#[inline]
fn away(x: f32, towards: f32) -> f32 {
    if towards > 0.0 {
        x.next_up()
    } else if towards < 0.0 {
        x.next_down()
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_follows_the_direction_and_scales_with_the_scene() {
        let p = Vec3::new(10.0, 3.0, -7.0);
        let error = p.abs() * gamma(5);
        let n = Vec3::new(0.0, 1.0, 0.0);
        let up = offset_origin(p, error, n, Vec3::new(0.2, 0.7, 0.0));
        let down = offset_origin(p, error, n, Vec3::new(0.2, -0.7, 0.0));
        assert!(up.y > p.y + error.y * 0.9 && down.y < p.y - error.y * 0.9);
        let s = 1024.0;
        let big = offset_origin(p * s, error * s, n, Vec3::new(0.2, 0.7, 0.0));
        assert_eq!(big, up * s);
    }
}
