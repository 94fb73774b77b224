//! Light in media: what the estimators cost along rays, and the errors of whole renders against a reference.
//!
//! Without arguments in `bench/scenes/fog.xml`, a box of fog with a glass ball; with `SCENE REFERENCE.exr` in another
//! scene, and with errors.

use std::path::{Path, PathBuf};

use nephroid::film::ImageError;
use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig, VolumeEstimate};
use nephroid::observer::Silent;
use nephroid::session::{MapStatistics, RenderSettings, Session};
use nephroid::texture::Image;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_formats::image::read_image;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

/// What is compared: what maps hold, and how they are read.
const ESTIMATORS: [(&str, VolumeKind, VolumeEstimate); 3] = [
    ("points, march", VolumeKind::Points, VolumeEstimate::March),
    ("points, beam estimate", VolumeKind::Points, VolumeEstimate::Beam),
    ("beams", VolumeKind::Beams, VolumeEstimate::Beam),
];

/// How much is rendered: samples a pixel, and gather rays.
const EFFORTS: [(&str, u32, FinalGather); 3] = [
    ("quick", 4, FinalGather::Off),
    ("4 samples", 4, FinalGather::Auto),
    ("16 samples", 16, FinalGather::Auto),
];

fn main() {
    let mut args = std::env::args_os().skip(1).map(PathBuf::from);
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog.xml");
    let scene = args.next().unwrap_or(own);
    let reference = args.next().map(|path| read_image(&path).expect("the reference is a picture").image);
    let file = read_scene(&scene, &DiskFiles, &Options::default()).expect("the scene can be read");
    let world = World::new(file.scene).expect("the scene can be rendered");
    println!("{}", scene.display());
    println!("{:24}{:12}{:>8}{:>14}{:>12}{:>10}", "", "", "CPU s", "bytes each", "relMSE", "mean");
    for (name, volume_kind, volume_estimate) in ESTIMATORS {
        for (effort, samples_per_pixel, final_gather) in EFFORTS {
            let config =
                PhotonMapperConfig { volume_kind, volume_estimate, final_gather, ..Default::default() };
            let settings =
                RenderSettings { method: Method::PhotonMapper(config), samples_per_pixel, seed: 0 };
            let mut rendered = None;
            let cpu = cpu_time(|| rendered = Some(render(&world, settings)));
            let (picture, bytes) = rendered.expect("it was rendered");
            let error = reference.as_ref().map(|reference| compare(&picture, reference));
            let [rel_mse, mean] = error.map_or([String::new(), String::new()], |(rel_mse, mean)| {
                [format!("{rel_mse:.5}"), format!("{mean:.4}")]
            });
            println!("{name:24}{effort:12}{:>8.2}{bytes:>14.1}{rel_mse:>12}{mean:>10}", cpu.as_secs_f64());
        }
    }
}

/// The picture, and bytes of each photon or beam in media.
fn render(world: &World, settings: RenderSettings) -> (Image, f64) {
    let mut session = Session::new(world, settings, &Silent);
    while !session.iteration_is_complete() {
        session.step(&Silent);
    }
    let MapStatistics { photons, bytes, .. } = session.statistics().volume;
    (session.film().develop(), bytes as f64 / photons.max(1) as f64)
}

/// relMSE, and the ratio of the means.
fn compare(picture: &Image, reference: &Image) -> (f64, f64) {
    let error = ImageError::between(picture, reference, ImageError::EPSILON).expect("they are of one size");
    (error.rel_mse, error.mean_ratio)
}
