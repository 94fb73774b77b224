//! Materials of several lobes: densities, weights class by class and what they reflect altogether.
//!
//! Seeds are fixed; with others each of the two statistical tests would reject correct code once in a hundred times.

use nephroid::material::{Bsdf, LobeKind, Transport};
use nephroid::math::{Frame, Vec3, real};

use crate::statistics::{COLUMNS, Mean, ROWS, Rng, cell, chi_square, integrate_on, significance, z_test};
use crate::zoo::{Case, Place, Zoo, anywhere, places};

const SAMPLES: usize = 30_000;

/// Calls `f` for every rich material from directions on both sides: along the normal, between and grazing.
fn for_each_rich(places: &[Place], angles_deg: &[f32], mut f: impl FnMut(&Zoo, &Case, &Place, Vec3, Bsdf)) {
    let zoo = Zoo::new();
    for case in zoo.cases.iter().filter(|case| case.rich) {
        for place in places {
            let frame = Frame::from_normal(place.surface.ng);
            for (i, theta_deg) in angles_deg.iter().enumerate() {
                let (sin, cos) = real::sin_cos(theta_deg.to_radians());
                let (sin_phi, cos_phi) = real::sin_cos(2.4 * i as f32);
                let wo = frame.to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos)).normalize();
                let bsdf = zoo.bsdf(case, &place.surface, wo);
                if !bsdf.is_black() && wo.dot(place.surface.ng) * wo.dot(place.surface.frame.n) > 0.0 {
                    f(&zoo, case, place, wo, bsdf);
                }
            }
        }
    }
}

/// The chance that a sample is a Dirac lobe's, and its weights' mean.
fn dirac(bsdf: &Bsdf, wo: Vec3) -> (f64, f64) {
    let lobes = bsdf.dirac_lobes(wo, Transport::Flux).into_iter().flatten();
    let weight: f32 = lobes.map(|lobe| lobe.weight.g).sum();
    const DRAWS: usize = 2000;
    let mut rng = Rng(17);
    let drawn = (0..DRAWS).filter(|i| {
        let u_lobe = (*i as f32 + 0.5) / DRAWS as f32;
        bsdf.sample(wo, rng.square(), u_lobe, Transport::Flux).is_some_and(|sample| sample.is_dirac())
    });
    (drawn.count() as f64 / DRAWS as f64, f64::from(weight))
}

#[test]
fn rich_samples_follow_their_density() {
    let mut results = Vec::new();
    let [flat, tilted, _] = places();
    for (place, angles_deg) in [(flat, &[15.0, 60.0, 88.0, 130.0][..]), (tilted, &[50.0])] {
        for_each_rich(&[place], angles_deg, |_, case, place, wo, bsdf| {
            let name = format!("{} from {wo}, flat: {}", case.name, place.flat);
            if bsdf.is_dirac() {
                return;
            }
            let axis = Frame::from_normal(place.surface.ng);
            let mut rng = Rng(results.len() as u64);
            let mut observed = vec![0.0; ROWS * COLUMNS + 1];
            for _ in 0..SAMPLES {
                let sample = bsdf.sample(wo, rng.square(), rng.next(), Transport::Radiance);
                let dense = sample.filter(|sample| !sample.is_dirac());
                observed[dense.map_or(ROWS * COLUMNS, |sample| cell(&axis, sample.wi))] += 1.0;
            }
            let mut expected = integrate_on(case.parts, &axis, |wi| f64::from(bsdf.pdf(wo, wi)));
            let total: f64 = expected.iter().sum();
            assert!(total < 1.004, "{name}: the density integrates to {total}");
            expected.push((1.0 - total).max(0.0));
            expected.iter_mut().for_each(|share| *share *= SAMPLES as f64);
            results.push((name, chi_square(&observed, &expected)));
        });
    }
    assert!(results.len() > 100);
    let alpha = significance(results.len());
    let failed: Vec<_> = results.into_iter().filter(|(_, p_value)| *p_value < alpha).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// The mean of weights is what quadrature gives, class by class, and no more than arrives. The weights of a power walk
/// are those of what is absorbed.
#[test]
fn rich_weights_are_albedos_and_at_most_one() {
    let mut results = Vec::new();
    let [flat, ..] = places();
    for_each_rich(&[flat], &[0.0, 40.0, 75.0, 87.0, 100.0, 140.0], |_, case, place, wo, bsdf| {
        let axis = Frame::from_normal(place.surface.ng);
        let mut means: [Mean; 3] = Default::default();
        let mut rng = Rng(100 + results.len() as u64);
        for _ in 0..10_000 {
            let sample = bsdf.sample(wo, rng.square(), rng.next(), Transport::Flux);
            for (kind, mean) in LobeKind::ALL.into_iter().zip(&mut means) {
                mean.add(sample.filter(|s| s.lobe == kind).map_or(0.0, |s| f64::from(s.weight.g)));
            }
        }
        let mut total = dirac(&bsdf, wo).1;
        for (kind, mean) in LobeKind::ALL.into_iter().zip(&means) {
            let albedo = if kind == LobeKind::Dirac {
                total
            } else if bsdf.has(kind) {
                let part = bsdf.part(kind);
                let cells = integrate_on(case.parts, &axis, |wi| {
                    f64::from(part.eval_flux(wo, wi).g * part.cosine(wi))
                });
                cells.iter().sum()
            } else {
                0.0
            };
            if kind != LobeKind::Dirac {
                total += albedo;
            }
            let p_value = z_test(mean.value, albedo, mean.variance().max(1e-12), 4e-3);
            results.push((format!("{} {kind:?} from {wo}: {} for {albedo}", case.name, mean.value), p_value));
        }
        // The excess is the tables' and the quadrature's.
        assert!(total < 1.002, "{} from {wo} scatters {total}", case.name);
        if case.name == "white plastic" && wo.dot(place.surface.ng) > 0.0 {
            assert!(total > 0.998, "{} from {wo} scatters {total}", case.name);
        }
        if case.name == "rough mirror" {
            // Light that meets a second facet is lost: a third of it at α = 0.5.
            assert!(total > 0.65, "{} from {wo} scatters {total}", case.name);
        }
    });
    let alpha = significance(results.len());
    let failed: Vec<_> = results.into_iter().filter(|(_, p_value)| *p_value < alpha).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// A sample's weight is its class's f·cos over that class's chance and density; the density that it tells is all's.
#[test]
fn weights_are_made_class_by_class() {
    let mut rng = Rng(5);
    for_each_rich(&places(), &[20.0, 65.0, 110.0], |_, case, _, wo, bsdf| {
        let mut chances = [None; 3];
        for _ in 0..60 {
            let Some(sample) = bsdf.sample(wo, rng.square(), rng.next(), Transport::Radiance) else {
                continue;
            };
            if sample.is_dirac() {
                assert_eq!(sample.pdf_solid_angle, 0.0);
                continue;
            }
            assert_eq!(sample.pdf_solid_angle, bsdf.pdf(wo, sample.wi), "{}", case.name);
            let part = bsdf.part(sample.lobe);
            let whole = part.eval(wo, sample.wi).g * bsdf.cosine(sample.wi) / part.pdf(wo, sample.wi);
            // What is left is the chance of the class, the same for all directions.
            let chance = whole / sample.weight.g;
            let known = chances[LobeKind::ALL.iter().position(|kind| *kind == sample.lobe).unwrap_or(0)]
                .get_or_insert(chance);
            assert!((chance / *known - 1.0).abs() < 1e-3, "{}: {chance} and {known}", case.name);
        }
        let wi = anywhere(&mut rng);
        let sum: f32 = [1, 2]
            .map(|i| chances[i].map_or(0.0, |chance| chance * bsdf.part(LobeKind::ALL[i]).pdf(wo, wi)))
            .iter()
            .sum();
        let seen = LobeKind::ALL
            .iter()
            .zip(chances)
            .skip(1)
            .all(|(kind, known)| known.is_some() || !bsdf.has(*kind));
        let pdf = bsdf.pdf(wo, wi);
        assert!(!seen || (sum - pdf).abs() <= 1e-3 * pdf, "{}: {sum} and {pdf}", case.name);
    });
}

#[test]
fn power_is_scattered_as_radiance_with_the_directions_exchanged() {
    let mut rng = Rng(8);
    for_each_rich(&places(), &[20.0, 65.0, 110.0, 150.0], |zoo, case, place, wo, bsdf| {
        for _ in 0..100 {
            let wi = anywhere(&mut rng);
            let back = zoo.bsdf(case, &place.surface, wi).eval(wi, wo).g;
            let flux = bsdf.eval_flux(wo, wi).g;
            assert!((flux - back).abs() <= 2e-3 * back.max(1e-6), "{}: {flux} and {back}", case.name);
            assert!(
                bsdf.transmits() || wo.dot(place.surface.ng) * wi.dot(place.surface.ng) > 0.0 || flux == 0.0
            );
        }
    });
}

#[test]
fn the_classes_add_up() {
    let mut rng = Rng(9);
    for_each_rich(&places(), &[30.0, 70.0, 120.0], |_, case, _, wo, bsdf| {
        let parts = LobeKind::ALL.map(|kind| bsdf.part(kind));
        for (kind, part) in LobeKind::ALL.into_iter().zip(&parts) {
            assert_eq!(part.is_black(), !bsdf.has(kind), "{} {kind:?}", case.name);
            assert!(LobeKind::ALL.into_iter().all(|other| other == kind || !part.has(other)));
        }
        assert_eq!(parts[0].dirac_lobes(wo, Transport::Flux), bsdf.dirac_lobes(wo, Transport::Flux));
        for _ in 0..20 {
            let wi = anywhere(&mut rng);
            let sum = parts.map(|part| part.eval(wo, wi).g).iter().sum::<f32>();
            let whole = bsdf.eval(wo, wi).g;
            assert!((sum - whole).abs() <= 1e-5 * whole, "{}: {sum} and {whole}", case.name);
        }
    });
}

/// Little roughness reflects, and lets through, what none does.
#[test]
fn smooth_is_the_limit_of_rough() {
    use nephroid::color::Rgb;
    use nephroid::handle::Arena;
    use nephroid::material::{Distribution, Material, Roughness, Surface};
    use nephroid::math::Vec2;
    use nephroid::texture::Textures;

    let (mut textures, mut materials) = (Textures::default(), Arena::default());
    let (white, alpha) = (textures.constant(Rgb::WHITE), textures.constant(Rgb::splat(1e-3)));
    let roughness = Roughness::isotropic(Distribution::Beckmann, alpha);
    let (int_ior, ext_ior) = (1.5, 1.0);
    let (specular_reflectance, specular_transmittance) = (white, white);
    let smooth = materials.push(Material::Dielectric {
        int_ior,
        ext_ior,
        specular_reflectance,
        specular_transmittance,
    });
    let rough = materials.push(Material::RoughDielectric {
        int_ior,
        ext_ior,
        specular_reflectance,
        specular_transmittance,
        roughness,
    });
    let surface = Surface::flat(Vec3::Z, Vec2::ZERO);
    let mut rng = Rng(12);
    for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.3, -0.954), Vec3::new(0.0, 0.8, -0.6)] {
        let wo = wo.normalize();
        let bsdf = |material| Material::at(&materials, material, &textures, &surface, wo);
        let (smooth, rough) = (bsdf(smooth), bsdf(rough));
        assert!(rough.has(LobeKind::Sharp) && !rough.is_dirac());
        for transport in [Transport::Radiance, Transport::Flux] {
            let mut means = [0.0f32; 2];
            const DRAWS: usize = 4000;
            for i in 0..DRAWS {
                let u_lobe = (i as f32 + 0.5) / DRAWS as f32;
                if let Some(sample) = rough.sample(wo, rng.square(), u_lobe, transport) {
                    means[usize::from(sample.transmitted)] += sample.weight.g / DRAWS as f32;
                }
            }
            for (mean, lobe) in means.into_iter().zip(smooth.dirac_lobes(wo, transport)) {
                let expected = lobe.map_or(0.0, |lobe| lobe.weight.g);
                // Stratified: the share is off by a draw or two of weight up to 2.25, and Fresnel's share by a slope.
                assert!((mean - expected).abs() < 3e-3, "{wo} {transport:?}: {mean} for {expected}");
            }
        }
    }
}
