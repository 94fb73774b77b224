//! The photon mapper in media against the path tracer, which is unbiased: photons seen along a ray, photons
//! near points of it, and beams; each with indirect light of surfaces from the map on the spot and from
//! rays that are sent for it.
//!
//! Photon maps blur, and near walls, where the half of a blurred photon lies behind them, they are too dark.
//! So each test states the bias that it forgives, and one shows that bias shrinks as photons get more.
//! Beyond that the tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds
//! chosen afresh, correct code would fail somewhere with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{
    DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, VolumeEstimate,
};
use nephroid::medium::Phase;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, balls_in_fog, blocks, cloud_over_floor, foggy_niche, forgiving, glossy_ball_in_fog,
    lantern_in_fog, three_media, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a picture's side, and of a block's: four blocks and the whole are compared.
const SIDE: u32 = 16;
const BLOCK: usize = 8;

/// Comparisons: scenes and ways to look light up, of parts of pictures, channel by channel.
const TESTS: usize = (12 * 6 + 3 + 3 + 1) * 5 * 3;

/// How light in media is looked up, and which part of it a picture may lack or have too much, as a whole
/// and in a quarter, with as many photons as are sent here.
#[derive(Clone, Copy)]
struct LookUp {
    name: &'static str,
    kind: VolumeKind,
    estimate: VolumeEstimate,
    photons: u64,
    bias: [f64; 2],
}

const POINTS: LookUp = LookUp {
    name: "points along rays",
    kind: VolumeKind::Points,
    estimate: VolumeEstimate::Beam,
    photons: 10_000,
    bias: [0.025, 0.05],
};

/// Reads 60 photons instead of 8, in balls instead of discs.
const MARCH: LookUp =
    LookUp { name: "points near rays", estimate: VolumeEstimate::March, bias: [0.055, 0.11], ..POINTS };

const BEAMS: LookUp =
    LookUp { name: "beams", kind: VolumeKind::Beams, photons: 5000, bias: [0.02, 0.04], ..POINTS };

impl LookUp {
    fn method(&self, single_scatter: DirectSource, final_gather: FinalGather) -> PhotonMapperConfig {
        PhotonMapperConfig {
            photons: 2500,
            caustic_photons: 2500,
            volume_photons: Some(self.photons),
            volume_kind: self.kind,
            volume_estimate: self.estimate,
            single_scatter,
            final_gather,
            ..PhotonMapperConfig::default()
        }
    }
}

/// With 8 samples a pixel some of them read the maps for others, too.
fn mapped(world: &World, config: PhotonMapperConfig, first_seed: u64) -> Vec<Vec<f64>> {
    blocks(world, &Method::PhotonMapper(config), 8, first_seed..first_seed + 16, BLOCK)
}

fn traced(world: &World, method: &Method) -> Vec<Vec<f64>> {
    blocks(world, method, 128, 0..16, BLOCK)
}

/// Compares blocks and the whole picture, which comes last, channel by channel.
fn assert_agree(found: &[Vec<f64>], reference: &[Vec<f64>], [of_all, of_block]: [f64; 2], what: &str) {
    for (i, (found, exact)) in found.iter().zip(reference).enumerate() {
        let bias = if i + 3 >= reference.len() { of_all } else { of_block };
        let exact: MeanTest = forgiving(found, exact, bias).into_iter().collect();
        let found: MeanTest = found.iter().copied().collect();
        let outcome = found.welch(&exact);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{what}, part {} channel {}: {outcome}", i / 3, i % 3);
    }
}

/// All six ways of the photon mapper agree with the path tracer but for `times` their usual bias.
fn all_agree(scene: Builder, times: f64) {
    let world = scene.build();
    assert_eq!(world.remarks(), []);
    let reference = traced(&world, &volpath(None));
    for look_up in [POINTS, MARCH, BEAMS] {
        for final_gather in [FinalGather::Off, FinalGather::Rays(2)] {
            let config = look_up.method(DirectSource::Rays, final_gather);
            let what = format!("{}, gather {final_gather:?}", look_up.name);
            assert_agree(&mapped(&world, config, 100), &reference, look_up.bias.map(|b| b * times), &what);
        }
    }
}

fn fog(g: f32) -> Builder {
    let phase = if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } };
    foggy_niche(SIDE, Rgb::splat(0.8), Rgb::splat(0.9), phase)
}

#[test]
fn in_fog() {
    all_agree(fog(0.0), 1.0);
}

#[test]
fn in_fog_that_scatters_forward() {
    all_agree(fog(0.8), 1.0);
}

#[test]
fn in_fog_that_scatters_backward() {
    all_agree(fog(-0.8), 1.0);
}

#[test]
fn in_coloured_fog() {
    let (sigma_t, albedo) = (Rgb::new(0.3, 0.8, 2.0), Rgb::new(0.9, 0.7, 0.5));
    all_agree(foggy_niche(SIDE, sigma_t, albedo, Phase::Isotropic), 1.0);
}

/// Eight mean free paths deep, most light comes from less than a blurred photon's width behind the front.
#[test]
fn in_dense_fog() {
    all_agree(foggy_niche(SIDE, Rgb::splat(8.0), Rgb::splat(0.9), Phase::Isotropic), 2.0);
}

#[test]
fn with_glass_and_a_mirror_in_fog() {
    all_agree(balls_in_fog(SIDE), 1.0);
}

#[test]
fn with_a_glossy_ball_in_fog() {
    all_agree(glossy_ball_in_fog(SIDE), 1.0);
}

/// Of 32 samples every fourth reads the maps for the others, of 33 each for itself, from the same maps: what
/// mirrored rays find in media must not count for the others twice.
#[test]
fn samples_that_read_for_others_bring_as_much() {
    let world = glossy_ball_in_fog(SIDE).build();
    let config = POINTS.method(DirectSource::Map, FinalGather::Rays(2));
    let render = |samples| blocks(&world, &Method::PhotonMapper(config.clone()), samples, 600..606, BLOCK);
    let (for_others, each) = (render(32), render(33));
    for (found, exact) in for_others.iter().zip(&each) {
        let ratios: MeanTest = found.iter().zip(exact).map(|(found, exact)| found / exact).collect();
        let outcome = ratios.against(1.0);
        assert!(outcome.passes(sidak(ALPHA, TESTS)) && (ratios.mean() - 1.0).abs() < 0.03, "{outcome}");
    }
}

#[test]
fn with_the_camera_in_fog_and_the_lamp_in_a_clear_ball() {
    all_agree(lantern_in_fog(SIDE), 1.0);
}

#[test]
fn with_media_beside_and_inside_one_another() {
    all_agree(three_media(SIDE), 1.0);
}

#[test]
fn in_a_grey_cloud_under_a_lamp() {
    all_agree(cloud_over_floor(SIDE, false, false), 1.0);
}

#[test]
fn in_a_coloured_cloud_under_a_lamp() {
    all_agree(cloud_over_floor(SIDE, true, false), 1.0);
}

#[test]
fn in_a_coloured_cloud_under_the_sky() {
    all_agree(cloud_over_floor(SIDE, true, true), 1.0);
}

/// Light that was scattered once by photons, too, which blur it, in place of rays.
#[test]
fn with_light_scattered_once_from_the_map() {
    let world = fog(0.0).build();
    let reference = traced(&world, &volpath(None));
    for look_up in [POINTS, MARCH, BEAMS] {
        let config = look_up.method(DirectSource::Map, FinalGather::Off);
        let bias = look_up.bias.map(|b| 1.5 * b);
        assert_agree(&mapped(&world, config, 300), &reference, bias, look_up.name);
    }
}

/// Each order of scattering by itself: paths of at most two, three and four segments.
#[test]
fn however_long_paths_may_be() {
    let world = balls_in_fog(SIDE).build();
    for max_depth in [2, 3, 4].map(Some) {
        let method = Method::Path(PathConfig { media: true, max_depth, ..PathConfig::default() });
        let reference = traced(&world, &method);
        let config = POINTS.method(DirectSource::Rays, FinalGather::Off);
        let config = PhotonMapperConfig { max_depth, ..config };
        assert_agree(&mapped(&world, config, 400), &reference, POINTS.bias, &format!("{max_depth:?}"));
    }
}

/// A blurred photon's width goes as n^(−1/3), and so does what walls take of it: with 16 times the photons .4 of
/// the bias. The march has the largest. Noise is a tenth of the greater bias.
#[test]
fn bias_shrinks_as_photons_get_more() {
    let world = fog(0.0).build();
    let dark = |photons, seeds: u64| {
        let config = MARCH.method(DirectSource::Map, FinalGather::Off);
        let config = PhotonMapperConfig { volume_photons: Some(photons), ..config };
        blocks(&world, &Method::PhotonMapper(config), 16, 500..500 + seeds, BLOCK)
    };
    let upper = |blocks: &[Vec<f64>]| -> MeanTest { blocks[0].iter().copied().collect() };
    let exact = upper(&traced(&world, &volpath(None)));
    let (few, many) = (upper(&dark(4000, 10)), upper(&dark(64_000, 6)));
    let lack = |found: &MeanTest| 1.0 - found.mean() / exact.mean();
    let (few, many) = (lack(&few), lack(&many));
    assert!(few > 0.05 && many < 0.7 * few && many > 0.0, "{few} of the light is lacking, then {many}");
}
