//! Normals from images.

use super::surface::Surface;
use super::{Bsdf, Material};
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::{Affine2, Frame, Vec2, Vec3, warp};
use crate::texture::{Bitmap, BitmapFilter, Image, Texture, Textures, Wrap};

/// A floor of which `u` goes 2 to the right and `v` 3 to the back.
fn floor(ns: Vec3) -> Surface {
    let dp_duv = [Vec3::X * 2.0, Vec3::Y * 3.0];
    Surface::oriented(Vec3::Z, ns, Vec2::new(0.5, 0.5), dp_duv)
}

/// Heights of 1 + u + 2v, about the middle.
fn slope(textures: &mut Textures) -> Handle<Texture> {
    let pixels = [0.0, 0.5, 1.0, 1.5].map(|h| Rgb::splat(1.0 + h)).to_vec();
    let image = textures.images.push(Image { width: 2, height: 2, pixels }.into());
    let (filter, wrap, to_uv) = (BitmapFilter::Bilinear, Wrap::Clamp, Affine2::IDENTITY);
    textures.push(Texture::Bitmap(Bitmap { image, filter, wrap, to_uv }))
}

fn is_right_handed(frame: &Frame) -> bool {
    frame.s.dot(frame.t).abs() < 1e-5 && (frame.s.cross(frame.t) - frame.n).length() < 1e-5
}

#[test]
fn heights_tilt_as_hills_do() {
    let mut textures = Textures::default();
    let heights = slope(&mut textures);
    // z = 1 + x/2 + 2y/3 has the normal (−1/2, −2/3, 1).
    for (scale, expected) in [(1.0, Vec3::new(-0.5, -2.0 / 3.0, 1.0)), (-3.0, Vec3::new(1.5, 2.0, 1.0))] {
        let raised = floor(Vec3::Z).raised(&textures, heights, scale);
        assert!((raised.frame.n - expected.normalize()).length() < 1e-5, "{raised:?}");
        assert!(is_right_handed(&raised.frame) && raised.frame.s.y.abs() < raised.frame.s.x);
    }
    // Mirrored coordinates change nothing of what is up.
    let mirrored = Surface { dp_duv: [Vec3::X * -2.0, Vec3::Y * 3.0], ..floor(Vec3::Z) };
    let raised = mirrored.raised(&textures, heights, 1.0);
    assert!((raised.frame.n - Vec3::new(0.5, -2.0 / 3.0, 1.0).normalize()).length() < 1e-5);
    // Without coordinates there is nothing to go by.
    let bare = Surface::flat(Vec3::Z, Vec2::new(0.5, 0.5));
    assert_eq!(bare.raised(&textures, heights, 1.0), bare);
}

#[test]
fn colours_are_coordinates_of_the_normal() {
    let mut textures = Textures::default();
    let flat = textures.constant(Rgb::new(0.5, 0.5, 1.0));
    assert_eq!(floor(Vec3::Z).mapped(&textures, flat, 1.0, false).frame, floor(Vec3::Z).frame);
    let tilted = textures.constant(Rgb::new(0.8, 0.3, 0.9));
    let found = floor(Vec3::Z).mapped(&textures, tilted, 0.5, false);
    assert!((found.frame.n - Vec3::new(0.3, -0.2, 0.8).normalize()).length() < 1e-6);
    assert!(is_right_handed(&found.frame));
}

/// Half of many models wears the other half's image: what rises towards its upper edge does so on both.
#[test]
fn maps_against_v_follow_mirrored_coordinates() {
    let mut textures = Textures::default();
    let tilted = textures.constant(Rgb::new(0.8, 0.3, 0.9));
    for (du, dv) in [(2.0, 3.0), (2.0, -3.0), (-2.0, 3.0), (-2.0, -3.0)] {
        let dp_duv = [Vec3::X * du, Vec3::Y * dv];
        let place = Surface::oriented(Vec3::Z, Vec3::Z, Vec2::ZERO, dp_duv);
        // Red says 0.6 along u, green −0.4 against v.
        let against_v = Vec3::new(0.6f32.copysign(du), 0.4f32.copysign(dv), 0.8).normalize();
        let found = place.mapped(&textures, tilted, 1.0, true);
        assert!((found.frame.n - against_v).length() < 1e-6 && is_right_handed(&found.frame), "{found:?}");
        let behind = place.flipped().mapped(&textures, tilted, 1.0, true);
        let expected = Vec3::new(against_v.x, against_v.y, -against_v.z);
        assert!((behind.frame.n - expected).length() < 1e-6, "{behind:?}");
        // Counter-clockwise of the first is all that the other kind asks for.
        let square = Vec3::new(0.6f32.copysign(du), (-0.4f32).copysign(-du), 0.8).normalize();
        let found = place.mapped(&textures, tilted, 1.0, false);
        assert!((found.frame.n - square).length() < 1e-6, "{found:?}");
    }
}

#[test]
fn normals_stay_above_the_geometry() {
    let mut textures = Textures::default();
    for i in 0..2000 {
        let u = |k: f32| Vec2::new((i as f32 * k).fract(), i as f32 / 2000.0);
        let color = warp::square_to_sphere(u(0.618_034)) * 0.5 + Vec3::splat(0.5);
        let normals = textures.constant(Rgb::from(color.to_array()));
        let place = floor(warp::square_to_cosine_hemisphere(u(0.37)).normalize());
        for place in [place, place.flipped()] {
            let found = place.mapped(&textures, normals, 1.0, false);
            assert!(found.frame.n.dot(place.ng) > 0.01, "{found:?}");
            assert!(is_right_handed(&found.frame), "{found:?}");
        }
    }
}

/// What is in front of a two-sided material is in front of what it is made of, whichever side it is.
#[test]
fn both_sides_are_raised() {
    let (mut textures, mut materials) = (Textures::default(), Arena::default());
    let (heights, reflectance) = (slope(&mut textures), textures.constant(Rgb::WHITE));
    let inside = materials.push(Material::Diffuse { reflectance });
    let bumpy = materials.push(Material::BumpMap { heights, scale: 1.0, inside });
    let outside = materials.push(Material::TwoSided { front: bumpy, back: bumpy });
    let paper = materials.push(Material::TwoSided { front: inside, back: inside });
    let sheet = materials.push(Material::BumpMap { heights, scale: 1.0, inside: paper });
    let at = |material, wo| Material::at(&materials, material, &textures, &floor(Vec3::Z), wo);
    let leaning = Vec3::new(-0.5, -2.0 / 3.0, 1.0).normalize();
    let cosine = |bsdf: &Bsdf, w: Vec3| bsdf.cosine(w);
    for material in [outside, sheet] {
        assert!((cosine(&at(material, Vec3::Z), leaning) - 1.0).abs() < 1e-5);
    }
    // Hills on both sides of a plate, but valleys on the back of a sheet.
    let (plate, sheet) = (at(outside, Vec3::NEG_Z), at(sheet, Vec3::NEG_Z));
    assert!((cosine(&plate, Vec3::new(leaning.x, leaning.y, -leaning.z)) - 1.0).abs() < 1e-5);
    assert!((cosine(&sheet, -leaning) - 1.0).abs() < 1e-5);
}

/// The share of a white surface's light that comes back is one, but for what its tilted normal sends below.
#[test]
fn a_bent_white_surface_reflects_no_more_than_arrives() {
    let (mut textures, mut materials) = (Textures::default(), Arena::default());
    let (heights, reflectance) = (slope(&mut textures), textures.constant(Rgb::WHITE));
    let inside = materials.push(Material::Diffuse { reflectance });
    for scale in [0.1, 1.0, 10.0] {
        let material = materials.push(Material::BumpMap { heights, scale, inside });
        for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.8, -0.5, 0.2).normalize()] {
            let bsdf = Material::at(&materials, material, &textures, &floor(Vec3::Z), wo);
            let n = 128;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let wi = warp::square_to_cone(u, 1.0);
                sum += f64::from(bsdf.eval(wo, wi).r * bsdf.cosine(wi));
            }
            let share = sum * std::f64::consts::TAU / f64::from(n * n);
            assert!(share < 1.001, "{share} at a scale of {scale}");
        }
    }
}
