//! Camera paths and photons measure the same light.

use nephroid::material::{Bsdf, Transport};
use nephroid::math::{Frame, Vec3, warp};

use crate::statistics::{Mean, Rng, significance, z_test};
use crate::zoo::{Case, Place, Zoo, anywhere, for_each, places};

#[test]
fn smooth_lobes_are_reciprocal() {
    let mut rng = Rng(2);
    for_each(|zoo, case, place, wo, bsdf| {
        if case.rich && bsdf.transmits() && !case.name.starts_with("rough") {
            // Not all say what index is inside; that power is adjoint is looked at elsewhere.
            return;
        }
        for _ in 0..100 {
            let wi = anywhere(&mut rng);
            let index_sq = |w| zoo.index(case, &place.surface, w).powi(2);
            let there = bsdf.eval(wo, wi).g * index_sq(wi);
            let back = zoo.bsdf(case, &place.surface, wi).eval(wi, wo).g * index_sq(wo);
            assert!((there - back).abs() <= 1e-3 * there.max(1e-6), "{}: {there} and {back}", case.name);
        }
    });
}

/// A Dirac lobe leads back to where it came from, and a photon that goes back carries what radiance
/// carried forth but for the indices: sin θ_i / sin θ_o is their ratio, by Snell.
#[test]
fn dirac_lobes_lead_back() {
    for_each(|zoo, case, place, wo, bsdf| {
        for (i, lobe) in bsdf.dirac_lobes(wo, Transport::Radiance).into_iter().enumerate() {
            let Some(lobe) = lobe else { continue };
            let back = zoo.bsdf(case, &place.surface, lobe.wi).dirac_lobes(lobe.wi, Transport::Flux)[i];
            let Some(back) = back else { panic!("{}: no way back from {}", case.name, lobe.wi) };
            // The cosine beyond a boundary loses digits towards grazing incidence.
            assert!((back.wi - wo).length() < 1e-4, "{}: {wo} becomes {}", case.name, back.wi);
            let index = |w| zoo.index(case, &place.surface, w);
            let ratio_sq = (index(lobe.wi) / index(wo)).powi(2);
            let expected = lobe.weight.g * ratio_sq * bsdf.adjoint_factor(lobe.wi, wo);
            assert!((back.weight.g - expected).abs() < 1e-3 * expected, "{}", case.name);
        }
    });
}

fn lit(w: Vec3) -> f64 {
    1.0 + 0.8 * f64::from(w.dot(Vec3::new(0.5, 0.7, -0.5)))
}

fn seen(w: Vec3) -> f64 {
    1.0 + 0.8 * f64::from(w.dot(Vec3::new(-0.4, 0.5, 0.75)))
}

/// How strongly light comes from, or is measured in, a direction.
type Response = fn(Vec3) -> f64;

/// The mean over one scattering: `ends[0]` where the walk comes from, spread by the cosine to the
/// geometry over both sides, times the walk's weight, times `ends[1]` where it goes.
fn scattered(
    zoo: &Zoo,
    case: &Case,
    place: &Place,
    transport: Transport,
    rng: &mut Rng,
    ends: [Response; 2],
) -> Mean {
    let frame = Frame::from_normal(place.surface.ng);
    let mut mean = Mean::default();
    for _ in 0..60_000 {
        let mut local = warp::square_to_cosine_hemisphere(rng.square());
        if rng.next() < 0.5 {
            local.z = -local.z;
        }
        let wo = frame.to_world(local).normalize();
        let bsdf: Bsdf = zoo.bsdf(case, &place.surface, wo);
        let sample = bsdf.sample(wo, rng.square(), rng.next(), transport);
        mean.add(sample.map_or(0.0, |s| ends[0](wo) * f64::from(s.weight.g) * ends[1](s.wi)));
    }
    mean
}

/// The scattering of power is the adjoint of the scattering of radiance (Veach 1997, §3.7.5 and
/// §5.3), for every material, refraction and shading normals included.
#[test]
fn photons_and_camera_paths_are_adjoint() {
    let zoo = Zoo::new();
    let mut results = Vec::new();
    for case in &zoo.cases {
        for place in places() {
            let mut rng = Rng(1000 + results.len() as u64);
            let camera = scattered(&zoo, case, &place, Transport::Radiance, &mut rng, [seen, lit]);
            let light = scattered(&zoo, case, &place, Transport::Flux, &mut rng, [lit, seen]);
            let p_value = z_test(camera.value, light.value, camera.variance() + light.variance(), 1e-5);
            results.push((case.name, place.flat, p_value, camera.value, light.value));
        }
    }
    let alpha = significance(results.len());
    for result in results {
        assert!(result.2 > alpha, "{result:?}");
    }
}

#[test]
fn the_adjoint_factor_is_one_without_shading_normals_and_straight_on() {
    let mut rng = Rng(3);
    for_each(|_, case, place, wo, bsdf| {
        assert_eq!(bsdf.adjoint_factor(wo, -wo), 1.0, "{}", case.name);
        let wi = anywhere(&mut rng);
        let (there, back) = (bsdf.adjoint_factor(wo, wi), bsdf.adjoint_factor(wi, wo));
        assert!((there * back - 1.0).abs() < 1e-5);
        if place.flat {
            assert!((there - 1.0).abs() < 1e-5);
            assert!((bsdf.density_factor(wi) - 1.0).abs() < 1e-5);
        } else {
            let n = place.surface.frame.n;
            let ng = place.surface.ng;
            // ng comes from the light and n is the photon's way: |ng·n| |n·ng| / (1 · 1).
            let expected = ng.dot(n) * ng.dot(n);
            let oriented = if wo.dot(ng) > 0.0 { 1.0 } else { -1.0 };
            assert!((bsdf.adjoint_factor(oriented * ng, oriented * n) - expected).abs() < 1e-5);
        }
    });
}

/// Photons count irradiance with the cosine of the geometry, |wi·ng|; what is gathered is radiance
/// with the cosine that `eval` leaves out.
#[test]
fn density_estimates_gather_what_directions_do() {
    let mut rng = Rng(6);
    for_each(|_, _, place, _, bsdf| {
        let wi = anywhere(&mut rng);
        let gathered = bsdf.density_factor(wi) * wi.dot(place.surface.ng).abs();
        assert!((gathered - bsdf.cosine(wi)).abs() < 1e-6);
    });
}
