//! What the laboratory tells of media against what a render does: the same photons and the same bits.

use nephroid::color::Rgb;
use nephroid::integrator::{
    DirectSource, LightPart, MapName, Method, PhotonMapperConfig, Show, VolumeEstimate,
};
use nephroid::laboratory::{InspectedSample, Inspector, PhotonColor, PhotonPicture, photon_picture};
use nephroid::observer::Silent;
use nephroid::photon_map::VolumePhoton;
use nephroid::session::RenderSettings;
use nephroid::transport::{Fog, InMedia, PhotonTargets, VolumeKind, WalkSettings, volume_pass};
use nephroid_convergence::{balls_in_fog, glossy_ball_in_fog, photons_of, render, session, three_media};

const SIDE: u32 = 8;
const SEED: u64 = 5;
const SAMPLES: u32 = 10;

fn few() -> PhotonMapperConfig {
    PhotonMapperConfig {
        photons: 1000,
        caustic_photons: 500,
        volume_photons: Some(2000),
        ..PhotonMapperConfig::default()
    }
}

/// Every way in which light of media is found.
fn configs() -> Vec<PhotonMapperConfig> {
    let (volume_kind, single_scatter) = (VolumeKind::Beams, DirectSource::Map);
    let march = |volume_estimate| PhotonMapperConfig { volume_estimate, ..few() };
    vec![
        few(),
        PhotonMapperConfig { single_scatter, ..few() },
        march(VolumeEstimate::March),
        march(VolumeEstimate::MarchReport),
        PhotonMapperConfig { volume_kind, volume_photons: Some(200), ..few() },
        PhotonMapperConfig { fog: Fog::Ambient, ..few() },
        PhotonMapperConfig { show: Show::Indirect, ..few() },
        PhotonMapperConfig { show: Show::Medium, ..few() },
    ]
}

fn close(a: Rgb, b: Rgb, scale: f32) -> bool {
    (a - b).to_array().into_iter().all(|d| d.abs() <= 2e-5 * scale.max(1e-3))
}

/// What was told of media on the camera's path.
fn of_media(sample: &InspectedSample) -> Rgb {
    let seen = sample.media.iter().filter(|passed| passed.gather_ray.is_none());
    seen.map(|passed| passed.light.total()).sum()
}

#[test]
fn what_media_bring_adds_up_to_the_pixel_of_the_render() {
    let mut counted = 0;
    for scene in [balls_in_fog(SIDE), glossy_ball_in_fog(SIDE), three_media(SIDE)] {
        let world = scene.with_media(|medium| medium.ambient = Rgb::splat(0.1)).build();
        for config in configs() {
            let method = Method::PhotonMapper(config);
            let image = render(&world, method.clone(), SAMPLES, SEED);
            for (x, y) in [(2, 5), (5, 4)] {
                let settings =
                    RenderSettings { method: method.clone(), samples_per_pixel: SAMPLES, seed: SEED };
                let mut inspector = Inspector::new(&world, settings, (x, y), &Silent);
                while inspector.iterations() < 1 {
                    assert!(inspector.step(&Silent), "nothing cancels");
                }
                let report = inspector.finish();
                assert_eq!(report.radiance, image.pixels[(y * SIDE + x) as usize], "{method:?} at {x}, {y}");
                for sample in &report.samples {
                    let (told, medium) = (of_media(sample), sample.light.medium);
                    let scale = sample.light.total().max_channel();
                    assert!(close(told, medium, scale), "{method:?} at {x}, {y}: {told:?}, not {medium:?}");
                    assert!(sample.rays.iter().all(|ray| ray.part != LightPart::Medium));
                    counted += sample.media.iter().map(|passed| passed.light.volume.count).sum::<u32>();
                }
            }
        }
    }
    assert!(counted > 1000, "{counted}");
}

#[test]
fn recorded_photons_in_media_are_those_of_the_maps() {
    let world = balls_in_fog(SIDE).build();
    let config = PhotonMapperConfig { single_scatter: DirectSource::Map, ..few() };
    let recorded = photons_of(&world, &config, SAMPLES, SEED, 2).expect("nothing cancels");
    let targets = PhotonTargets {
        global: config.photons,
        caustic: config.caustic_photons,
        volume: 2000,
        volume_kind: VolumeKind::Points,
        emit: None,
        emit_max: config.emit_max,
        store_direct: false,
        store_single_scatter: true,
    };
    let settings = WalkSettings::default();
    let pass = volume_pass(&world, &settings, &recorded.plan, &targets, SEED, 2, &Silent);
    let [InMedia::Points(all), InMedia::Points(caustics)] = pass.expect("nothing cancels") else {
        panic!("points were asked for");
    };
    for (map, stored) in [(MapName::Volume, all), (MapName::VolumeCaustic, caustics)] {
        let told: Vec<_> = recorded.photons.iter().filter(|photon| photon.map == map).collect();
        assert_eq!(told.len(), stored.stored(), "{map:?}");
        assert!(told.len() > 500, "{map:?}: {}", told.len());
        let share = (1.0 / stored.emitted() as f64) as f32;
        for (told, VolumePhoton { position, power, wi, depth, light, .. }) in
            told.iter().zip(stored.as_slice())
        {
            let photon = told.photon;
            assert_eq!((photon.position, photon.wi, photon.power), (*position, *wi, *power * share));
            assert_eq!((photon.depth, photon.light), (*depth, *light));
            let path = told.bounces.to_string();
            assert!(told.bounces.ends_in_medium() && path.ends_with('V'), "{path}");
            let before = &path[1..path.len() - 1];
            let caustic = !before.is_empty() && before.bytes().all(|letter| letter == b'S');
            assert_eq!(caustic, map == MapName::VolumeCaustic, "{path}");
        }
    }
    let statistics = session(&world, Method::PhotonMapper(config.clone()), 1, SEED).statistics().clone();
    assert_eq!(recorded.plan, statistics.plan.photons);
    let beams = PhotonMapperConfig { volume_kind: VolumeKind::Beams, ..config };
    let photons = photons_of(&world, &beams, SAMPLES, SEED, 0).expect("nothing cancels").photons;
    assert!(!photons.is_empty() && photons.iter().all(|photon| !photon.bounces.ends_in_medium()));
}

/// The niche is closed by a null surface, and has opaque walls: from outside all of it is seen through the one and
/// none through the others.
#[test]
fn photons_in_media_show_through_null_surfaces_and_not_through_walls() {
    let draw = |from_behind: bool| {
        let mut scene = glossy_ball_in_fog(SIDE);
        if from_behind {
            let turn = nephroid::math::Transform::rotate(nephroid::math::DVec3::Y, 180.0);
            scene.scene.camera.to_world = scene.scene.camera.to_world.then(turn);
        }
        let world = scene.build();
        let photons = photons_of(&world, &few(), SAMPLES, SEED, 0).expect("nothing cancels").photons;
        let of_volume: Vec<_> = photons.into_iter().filter(|photon| photon.map == MapName::Volume).collect();
        let options = PhotonPicture { color: PhotonColor::Map, size: 1, through_walls: false };
        let legend = photon_picture(&world, &of_volume, &options).1;
        (legend.first().map_or(0, |entry| entry.photons), of_volume.len())
    };
    let (seen, all) = draw(false);
    assert!(4 * seen > 3 * all, "{seen} of {all}");
    let (seen, all) = draw(true);
    assert!(all > 500 && seen == 0, "{seen} of {all}");
}
