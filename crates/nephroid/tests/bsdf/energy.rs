//! What comes out is at most what goes in, and all of it where a material says so.

use nephroid::material::{Bsdf, Transport};
use nephroid::math::{Frame, Vec3};

use crate::statistics::integrate;
use crate::zoo::for_each;

/// ∫ f |cos| over all directions for each channel, without Dirac lobes.
fn smooth_albedo(bsdf: &Bsdf, axis: &Frame, wo: Vec3) -> [f64; 3] {
    if bsdf.is_black() || bsdf.is_dirac() {
        return [0.0; 3];
    }
    [0, 1, 2].map(|channel| {
        integrate(axis, |wi| f64::from(bsdf.eval(wo, wi)[channel] * bsdf.cosine(wi))).iter().sum()
    })
}

#[test]
fn white_furnace() {
    for_each(|_, case, place, wo, bsdf| {
        // Shading normals do not conserve energy, and nobody asks them to.
        if !place.flat || case.rich {
            return;
        }
        let mut total = smooth_albedo(&bsdf, &place.surface.frame, wo);
        for lobe in bsdf.dirac_lobes(wo, Transport::Flux).into_iter().flatten() {
            for (total, weight) in total.iter_mut().zip(lobe.weight.to_array()) {
                *total += f64::from(weight);
            }
        }
        for total in total {
            assert!(total < 1.0 + 1e-4, "{} from {wo} gives {total}", case.name);
            assert!(!case.lossless || total > 1.0 - 1e-4, "{} from {wo} gives {total}", case.name);
        }
    });
}

/// In equilibrium with surroundings of radiance 1 in vacuum a medium of index n is filled with
/// radiance n², seen from either side of a boundary and in every direction.
#[test]
fn radiance_in_equilibrium_is_the_squared_index() {
    for_each(|zoo, case, place, wo, bsdf| {
        if !(place.flat && case.lossless && bsdf.is_dirac()) {
            return;
        }
        let radiance = |w| zoo.index(case, &place.surface, w).powi(2);
        let lobes = bsdf.dirac_lobes(wo, Transport::Radiance);
        let seen: f32 = lobes.into_iter().flatten().map(|lobe| lobe.weight.g * radiance(lobe.wi)).sum();
        assert!((seen - radiance(wo)).abs() < 1e-5, "{} from {wo} shows {seen}", case.name);
    });
}

#[test]
fn entering_and_leaving_multiplies_to_one() {
    for_each(|zoo, case, place, wo, bsdf| {
        if !(place.flat && case.lossless) {
            return;
        }
        for transport in [Transport::Radiance, Transport::Flux] {
            let [_, Some(entered)] = bsdf.dirac_lobes(wo, transport) else { continue };
            // The other face of a slab: the same normal turned round, met from inside.
            let surface = place.surface.flipped();
            let inside = -entered.wi;
            let face = zoo.bsdf(case, &surface, inside);
            let [_, Some(left)] = face.dirac_lobes(inside, transport) else {
                panic!("{}: light does not leave", case.name)
            };
            let [_, Some(power)] = bsdf.dirac_lobes(wo, Transport::Flux) else { unreachable!() };
            let expected = power.weight.g * power.weight.g;
            assert!((left.wi + wo).length() < 1e-4, "{}: leaves along {}", case.name, left.wi);
            assert!((entered.weight.g * left.weight.g - expected).abs() < 1e-5, "{} from {wo}", case.name);
        }
    });
}
