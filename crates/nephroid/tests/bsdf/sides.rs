//! Sides: where materials are black, and that light does not leak.

use nephroid::material::Transport;
use nephroid::math::Vec2;

use crate::statistics::Rng;
use crate::zoo::{Zoo, anywhere, directions, for_each, places};

#[test]
fn reflection_and_transmission_are_by_the_geometric_normal() {
    let mut rng = Rng(4);
    for_each(|_, case, place, wo, bsdf| {
        let ng = place.surface.ng;
        for _ in 0..300 {
            let wi = anywhere(&mut rng);
            if wo.dot(ng) * wi.dot(ng) < 0.0 {
                let nothing = bsdf.eval(wo, wi).is_black() && bsdf.pdf(wo, wi) == 0.0;
                assert!(nothing || bsdf.transmits(), "{} leaks", case.name);
            }
            let (found, there) = (bsdf.pdf(wo, wi) > 0.0, !bsdf.eval(wo, wi).is_black());
            assert!(found == there || (case.rich && !there), "{} from {wo} to {wi}", case.name);
            for transport in [Transport::Radiance, Transport::Flux] {
                let Some(sample) = bsdf.sample(wo, rng.square(), rng.next(), transport) else { continue };
                let crossed = wo.dot(ng) * sample.wi.dot(ng) < 0.0;
                assert_eq!(crossed, sample.transmitted, "{} from {wo} to {}", case.name, sample.wi);
                assert!((sample.wi.length() - 1.0).abs() < 1e-6);
            }
        }
    });
}

/// The cases named one-sided or known to be so, by name, so that a slip in the table shows.
#[test]
fn one_sided_materials_are_black_from_behind() {
    let zoo = Zoo::new();
    let one_sided = |name: &str| {
        ["diffuse", "phong", "mirror", "gold", "plastic", "opaque"].iter().any(|start| name.contains(start))
            && !name.contains("before")
            && !name.contains("leaf")
    };
    for case in &zoo.cases {
        for place in places() {
            for wo in directions(&place.surface) {
                let bsdf = zoo.bsdf(case, &place.surface, wo);
                let behind = wo.dot(place.surface.ng) < 0.0;
                assert_eq!(bsdf.is_black(), behind && one_sided(case.name), "{} from {wo}", case.name);
                if !behind && !bsdf.is_black() && one_sided(case.name) {
                    // Even where a caller mixes up the sides.
                    assert_eq!(bsdf.dirac_lobes(-wo, Transport::Flux), [None, None], "{}", case.name);
                    assert!(bsdf.sample(-wo, Vec2::splat(0.5), 0.5, Transport::Flux).is_none());
                }
                if bsdf.is_black() {
                    assert!(bsdf.sample(wo, Vec2::splat(0.5), 0.5, Transport::Flux).is_none());
                    assert!(!bsdf.is_dirac() && !bsdf.has_glossy_lobe() && !bsdf.is_null());
                }
            }
        }
    }
}

#[test]
fn two_sided_materials_show_the_side_that_is_seen() {
    let zoo = Zoo::new();
    let named = |name: &str| zoo.cases.iter().find(|case| case.name == name).expect("a case of this name");
    for place in places() {
        let ng = place.surface.ng;
        let phong_mirror = named("phong before mirror");
        assert!(zoo.bsdf(phong_mirror, &place.surface, ng).has_glossy_lobe());
        assert!(zoo.bsdf(phong_mirror, &place.surface, -ng).is_dirac());
        let mirror_paper = named("mirror before diffuse, nested");
        assert!(zoo.bsdf(mirror_paper, &place.surface, ng).is_dirac());
        let paper = zoo.bsdf(mirror_paper, &place.surface, -ng);
        assert!(!paper.is_dirac() && !paper.eval(-ng, -ng).is_black());
    }
}

#[test]
fn the_parts_of_a_bsdf_add_up_to_it() {
    let mut rng = Rng(5);
    for_each(|_, case, _, wo, bsdf| {
        let (diffuse, glossy) = (bsdf.diffuse_part(), bsdf.glossy_part());
        assert_eq!(diffuse.diffuse_albedo(), bsdf.diffuse_albedo());
        assert_eq!(glossy.glossy_albedo(), bsdf.glossy_albedo());
        assert_eq!(glossy.is_black(), !bsdf.has_glossy_lobe(), "{}", case.name);
        assert!(!diffuse.has_glossy_lobe() && glossy.diffuse_albedo().is_black());
        for _ in 0..20 {
            let wi = anywhere(&mut rng);
            let sum = diffuse.eval(wo, wi) + glossy.eval(wo, wi);
            assert!((sum - bsdf.eval(wo, wi)).map(f32::abs).max_channel() <= 1e-6 * sum.max_channel());
        }
    });
}
