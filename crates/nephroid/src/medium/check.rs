//! What media must satisfy to be rendered: every problem, one sentence each. The sentences name the
//! coefficient, not the medium, which only its owner can.

use super::{Boundary, Coefficient, Grid, Media, Medium, Phase};
use crate::color::Rgb;
use crate::handle::Handle;

/// The problems of a medium, beside those of its grids' values.
pub(crate) fn check_medium(media: &Media, medium: &Medium) -> Vec<String> {
    let mut problems = Vec::new();
    for (name, coefficient) in
        [("sigma_t", &medium.sigma_t), ("albedo", &medium.albedo), ("emission", &medium.emission)]
    {
        match coefficient {
            Coefficient::Constant(value) => problems.extend(not_an_amount(name, *value)),
            Coefficient::Grid { grid, to_world, scale } => {
                if !to_world.is_invertible() {
                    problems.push(format!(
                        "the `to_world` of {name}'s grid is singular or not finite: no axis may be scaled to \
                         zero, and every number must be finite"
                    ));
                }
                let sound_scale = *scale >= 0.0 && scale.is_finite();
                if !sound_scale {
                    problems.push(format!(
                        "a scale of {scale} for {name}'s grid: write a finite number that is not negative"
                    ));
                }
                if !media.grids.contains(*grid) {
                    problems.push(format!("{name} refers to a grid that does not exist"));
                } else if sound_scale && !(largest(&media.grids[*grid]) * scale).is_finite() {
                    problems.push(format!(
                        "the values of {name}'s grid are infinite when multiplied by its scale of {scale}: \
                         write a smaller one"
                    ));
                }
            }
        }
    }
    problems.extend(not_an_amount("ambient", medium.ambient));
    problems.extend(too_bright(media, &medium.albedo));
    if let Phase::HenyeyGreenstein { g } = medium.phase
        && !(g > -1.0 && g < 1.0)
    {
        problems.push(format!(
            "a mean cosine g of {g}: write a number between -1 and 1, both left out (0 is isotropic, 0.9 as \
             strongly forward as in clouds)"
        ));
    }
    problems
}

/// The problems of a grid by itself.
pub(crate) fn check_grid(grid: &Grid) -> Vec<String> {
    let mut problems = Vec::new();
    let [x, y, z] = grid.size;
    let cells: u128 = grid.size.map(u128::from).iter().product();
    let found = grid.values.len();
    if cells == 0 {
        problems.push(format!("a grid of {x} x {y} x {z} cells: write at least 1 along each axis"));
    } else if cells != found as u128 {
        problems.push(format!(
            "{found} values for {x} x {y} x {z} cells, which are {cells}: give one for each cell"
        ));
    }
    let bad = grid.values.iter().filter(|v| !is_amount(*v)).count();
    if bad > 0 {
        problems.push(format!(
            "{bad} of its {found} values are negative, infinite or not a number: each must be finite and not \
             negative"
        ));
    }
    problems
}

/// The media of a boundary that do not exist.
pub(crate) fn check_boundary(media: &Media, boundary: &Boundary) -> Vec<String> {
    [("interior", boundary.interior), ("exterior", boundary.exterior), ("light's", boundary.light)]
        .into_iter()
        .filter(|(_, medium)| is_missing(media, *medium))
        .map(|(side, _)| format!("its {side} medium does not exist"))
        .collect()
}

/// The problems of the medium that a light or the camera is in.
pub(crate) fn check_start(media: &Media, medium: Option<Handle<Medium>>) -> Vec<String> {
    let missing = is_missing(media, medium);
    missing.then(|| "the medium that it is in does not exist".to_owned()).into_iter().collect()
}

/// Whether a medium is named and does not exist.
fn is_missing(media: &Media, medium: Option<Handle<Medium>>) -> bool {
    medium.is_some_and(|medium| !media.list.contains(medium))
}

fn not_an_amount(name: &str, value: Rgb) -> Option<String> {
    (!is_amount(value))
        .then(|| format!("{name} is {}, but must be finite and not negative in every channel", show(value)))
}

/// What is wrong with an albedo of sound numbers.
fn too_bright(media: &Media, albedo: &Coefficient) -> Option<String> {
    const WHY: &str =
        "more light would be scattered than is taken away (σ_s > σ_t), and photons would never end";
    match albedo {
        Coefficient::Constant(value) => (is_amount(*value) && value.max_channel() > 1.0)
            .then(|| format!("albedo is {}: {WHY}; write at most 1 in every channel", show(*value))),
        Coefficient::Grid { grid, scale, .. } => {
            let largest = if media.grids.contains(*grid) { largest(&media.grids[*grid]) } else { 0.0 };
            let albedo = largest * scale;
            // Rounded down, so that following the advice is enough.
            let advice = (1e4 / largest).floor() / 1e4;
            (albedo.is_finite() && albedo > 1.0).then(|| {
                format!("albedo is up to {albedo} on its grid: {WHY}; write a scale of {advice} or less")
            })
        }
    }
}

fn is_amount(value: Rgb) -> bool {
    value.is_finite() && value.min_channel() >= 0.0
}

fn largest(grid: &Grid) -> f32 {
    grid.values.max_channel(0..grid.values.len())
}

/// One number for grey, three for colours.
fn show(value: Rgb) -> String {
    let Rgb { r, g, b } = value;
    if r == g && g == b { r.to_string() } else { format!("({r}, {g}, {b})") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handle::Arena;
    use crate::math::{DVec3, Transform};
    use crate::medium::GridValues;

    fn clear() -> Medium {
        Medium::homogeneous("fog", Rgb::BLACK, Rgb::BLACK, Phase::Isotropic)
    }

    fn grid(size: [u32; 3], values: Vec<f32>) -> Grid {
        Grid { name: String::new(), size, values: GridValues::Grey(values) }
    }

    fn placed(grid: Handle<Grid>, to_world: Transform, scale: f32) -> Coefficient {
        Coefficient::Grid { grid, to_world, scale }
    }

    #[test]
    fn numbers_that_no_medium_has_are_refused() {
        let media = Media::default();
        assert!(check_medium(&media, &clear()).is_empty());
        let medium = Medium {
            sigma_t: Coefficient::Constant(Rgb::new(1.0, -0.5, 1.0)),
            albedo: Coefficient::Constant(Rgb::splat(1.25)),
            emission: Coefficient::Constant(Rgb::splat(f32::NAN)),
            phase: Phase::HenyeyGreenstein { g: 1.0 },
            ambient: Rgb::splat(f32::INFINITY),
            ..clear()
        };
        assert_eq!(
            check_medium(&media, &medium),
            [
                "sigma_t is (1, -0.5, 1), but must be finite and not negative in every channel",
                "emission is (NaN, NaN, NaN), but must be finite and not negative in every channel",
                "ambient is inf, but must be finite and not negative in every channel",
                "albedo is 1.25: more light would be scattered than is taken away (σ_s > σ_t), and photons \
                 would never end; write at most 1 in every channel",
                "a mean cosine g of 1: write a number between -1 and 1, both left out (0 is isotropic, 0.9 as \
                 strongly forward as in clouds)",
            ]
        );
        for g in [-1.0, 1.5, f32::NAN] {
            let medium = Medium { phase: Phase::HenyeyGreenstein { g }, ..clear() };
            assert_eq!(check_medium(&media, &medium).len(), 1, "{g}");
        }
        for albedo in [-0.1, f32::NAN, f32::INFINITY] {
            let medium = Medium { albedo: Coefficient::Constant(Rgb::splat(albedo)), ..clear() };
            assert_eq!(check_medium(&media, &medium).len(), 1, "{albedo}");
        }
    }

    #[test]
    fn grids_have_a_value_for_each_cell() {
        let of = |size, values| check_grid(&grid(size, values));
        assert!(of([2, 1, 1], vec![0.0, 1.0]).is_empty());
        assert_eq!(of([2, 0, 1], vec![]), ["a grid of 2 x 0 x 1 cells: write at least 1 along each axis"]);
        assert_eq!(
            of([2, 2, 1], vec![0.0; 3]),
            ["3 values for 2 x 2 x 1 cells, which are 4: give one for each cell"]
        );
        assert_eq!(of([u32::MAX; 3], vec![0.0; 3]).len(), 1);
        assert_eq!(
            of([2, 2, 1], vec![0.0, -1.0, f32::NAN, f32::INFINITY]),
            [
                "3 of its 4 values are negative, infinite or not a number: each must be finite and not negative"
            ]
        );
    }

    #[test]
    fn a_grid_that_a_coefficient_refers_to_exists_and_can_be_placed() {
        let mut media = Media::default();
        let bright = media.grids.push(grid([1; 3], vec![3.0]));
        let mut others = media.grids.clone();
        let missing = others.push(grid([1; 3], vec![3.0]));
        let medium = Medium {
            sigma_t: placed(missing, Transform::scale(DVec3::new(1.0, 0.0, 1.0)), -1.0),
            albedo: placed(bright, Transform::IDENTITY, 0.5),
            emission: placed(bright, Transform::IDENTITY, 2e38),
            ..clear()
        };
        assert_eq!(
            check_medium(&media, &medium),
            [
                "the `to_world` of sigma_t's grid is singular or not finite: no axis may be scaled to zero, \
                 and every number must be finite",
                "a scale of -1 for sigma_t's grid: write a finite number that is not negative",
                "sigma_t refers to a grid that does not exist",
                "the values of emission's grid are infinite when multiplied by its scale of \
                 200000000000000000000000000000000000000: write a smaller one",
                "albedo is up to 1.5 on its grid: more light would be scattered than is taken away \
                 (σ_s > σ_t), and photons would never end; write a scale of 0.3333 or less",
            ]
        );
        let medium = Medium { albedo: placed(bright, Transform::IDENTITY, 0.3333), ..clear() };
        assert!(check_medium(&media, &medium).is_empty(), "the advice is enough");
    }

    #[test]
    fn boundaries_name_media_that_exist() {
        let mut list = Arena::default();
        let (first, second) = (list.push(clear()), list.push(clear()));
        let mut media = Media::default();
        media.list.push(clear());
        let boundary =
            Boundary { interior: Some(first), exterior: Some(second), light: Some(second), priority: None };
        assert_eq!(
            check_boundary(&media, &boundary),
            ["its exterior medium does not exist", "its light's medium does not exist"]
        );
        assert!(check_boundary(&media, &Boundary::default()).is_empty());
    }
}
