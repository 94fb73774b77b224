//! Parts of pictures of the report's box, and errors in them.

use nephroid::film::ImageError;
use nephroid::math::{Ray, Vec3};
use nephroid::shape::SurfacePoint;
use nephroid::texture::Image;
use nephroid::world::World;

/// Its walls come first among the shapes of each of the report's scenes.
pub const WALLS: u32 = 5;

/// Half-widths of the box, 3 by 2.8 by 3.2 in size, and its centre.
const HALF: [f32; 3] = [1.5, 1.4, 1.6];
const CENTRE: Vec3 = Vec3::new(0.0, 1.4, 0.0);

/// The camera of all of the report's scenes, which looks along −z, and half of its opening angle.
const EYE: Vec3 = Vec3::new(0.0, 1.4, 6.0);
const HALF_ANGLE_DEG: f64 = 17.6;

/// Mean over pixels and channels of squared differences by the squared reference, as [`ImageError::rel_mse`], of those pixels
/// that count.
pub fn rel_mse_where(image: &Image, reference: &Image, counts: &[bool]) -> f64 {
    let pixels = image.pixels.iter().zip(&reference.pixels).zip(counts).filter(|(_, counts)| **counts);
    let channels = pixels.flat_map(|((a, r), _)| a.to_array().into_iter().zip(r.to_array()));
    let squares = channels.map(|(a, r)| {
        let (a, r) = (f64::from(a), f64::from(r));
        (a - r) * (a - r) / (r * r + ImageError::EPSILON)
    });
    let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), square| (sum + square, n + 1.0));
    sum / f64::max(n, 1.0)
}

/// [`rel_mse_where`] of the whole picture.
pub fn rel_mse(image: &Image, reference: &Image) -> f64 {
    rel_mse_where(image, reference, &vec![true; image.pixels.len()])
}

/// Mean luminance of the pixels that count, in the picture's unit.
pub fn mean_where(image: &Image, counts: &[bool]) -> f64 {
    let own = image.pixels.iter().zip(counts).filter(|(_, counts)| **counts);
    let (sum, n) = own.fold((0.0, 0.0), |(sum, n), (p, _)| (sum + f64::from(p.luminance()), n + 1.0));
    sum / f64::max(n, 1.0)
}

/// The ray through the centre of each pixel of a square picture, row by row.
pub fn rays(side: u32) -> impl Iterator<Item = Ray> {
    let half = libm::tan(HALF_ANGLE_DEG.to_radians()) as f32;
    (0..side * side).map(move |i| {
        let at = |v: u32| (2 * v + 1) as f32 / side as f32 - 1.0;
        let (x, y) = (at(i % side), -at(i / side));
        Ray::new(EYE, Vec3::new(half * x, half * y, -1.0).normalize())
    })
}

/// What each pixel's centre sees first, with the number of its shape.
pub fn seen(world: &World, side: u32) -> Vec<Option<(u32, SurfacePoint)>> {
    rays(side).map(|ray| world.intersect(&ray).map(|hit| (hit.shape, hit.point))).collect()
}

/// How far a point of a wall is from the nearest other wall, in m.
pub fn to_edge(position: Vec3) -> f32 {
    let offset = (position - CENTRE).to_array();
    let mut distances: Vec<f32> = (0..3).map(|i| HALF[i] - offset[i].abs()).collect();
    // There is no wall at the front.
    if offset[2] > 0.0 {
        distances[2] = f32::INFINITY;
    }
    distances.sort_by(f32::total_cmp);
    distances[1]
}

/// Pixels beside which the reference has a neighbour that differs by more than this part of it: outlines and hard shadows.
pub fn outlines(reference: &Image, part: f32) -> Vec<bool> {
    let (width, height) = (reference.width as usize, reference.height as usize);
    let luminance = |x: usize, y: usize| reference.pixels[y * width + x].luminance();
    let is_outline = |i: usize| {
        let (x, y) = (i % width, i / width);
        let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
        let around =
            columns.flat_map(|x| (y.saturating_sub(1)..=(y + 1).min(height - 1)).map(move |y| (x, y)));
        let own = luminance(x, y);
        around.into_iter().any(|(x, y)| (luminance(x, y) - own).abs() > part * luminance(x, y).max(own))
    };
    (0..width * height).map(is_outline).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::color::Rgb;

    #[test]
    fn edges_are_where_walls_meet() {
        assert_eq!(to_edge(Vec3::new(0.0, 0.0, 0.0)), 1.5);
        assert!((to_edge(Vec3::new(-1.5, 0.1, 0.5)) - 0.1).abs() < 1e-6);
        assert!((to_edge(Vec3::new(1.3, 1.0, -1.6)) - 0.2).abs() < 1e-6);
        // The open front is no wall.
        assert!((to_edge(Vec3::new(0.0, 0.0, 1.6)) - 1.5).abs() < 1e-6);
    }

    #[test]
    fn parts_of_pictures_are_compared() {
        let pixels = [1.0, 1.0, 1.0, 2.0].map(Rgb::splat).to_vec();
        let reference = Image { width: 4, height: 1, pixels };
        assert_eq!(outlines(&reference, 0.3), [false, false, true, true]);
        let image = Image::filled(4, 1, Rgb::splat(1.0));
        assert_eq!(rel_mse_where(&image, &reference, &[true, true, true, false]), 0.0);
        let whole = ImageError::between(&image, &reference, ImageError::EPSILON).unwrap().rel_mse;
        assert!((rel_mse(&image, &reference) - whole).abs() < 1e-12 && whole > 0.05);
        assert_eq!(mean_where(&reference, &[false, false, true, true]), 1.5);
    }

    #[test]
    fn rays_start_at_the_upper_left() {
        let first = rays(48).next().unwrap().direction;
        assert!(first.x < -0.2 && first.y > 0.2 && first.z < -0.9);
    }
}
