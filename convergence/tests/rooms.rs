//! Built-in rooms by every method that can see them, against what long renders found: a plain room, one lit through a
//! keyhole, one by a lamp in a closed bulb, and one by the sun through a window, with a table of glass.
//!
//! References are the files in `rooms/`: means of blocks of pixels, of those that see no glass and of those that do. They
//! are path tracing's where that finds the light, else light tracing's where no glass is seen and late progressive photon
//! mapping's where it is. This makes them again:
//!
//! ```sh
//! cargo run --release -p nephroid-convergence --example room_references -- convergence/tests/rooms
//! ```
//!
//! Photons blur, and more so at edges and where surfaces meet: that is forgiven as stated beside each way, so much of the
//! whole and so much of a block. Beyond that the tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds
//! chosen afresh, correct code would fail somewhere with probability 1 %.
//!
//! `NEPHROID_LONG=1` renders references of other seeds as well and compares them with those of the files.

use std::path::Path;

use nephroid::integrator::{AutoConfig, Method, PpmConfig, VcmConfig};
use nephroid_convergence::{
    ROOM_PARTS, ROOMS, Room, RoomReference, coarser, forgiving, iterated_renders, kind_of_part, light_tracer,
    part_samples, path, pixel_kinds,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the rooms' parts by their ways.
const TESTS: usize = ROOMS.len() * ROOM_PARTS * 7;

/// A method, and what is asked of it.
struct Way {
    name: &'static str,
    method: Method,
    iterations: u64,
    samples_per_pixel: u32,
    seeds: u64,
    /// How far the mean over a whole picture may be off, and that over a block, relative.
    blur: [f64; 2],
    /// Whether it sees what lies behind glass.
    behind_glass: bool,
}

fn blurred(name: &'static str, method: Method, iterations: u64, seeds: u64, blur: [f64; 2]) -> Way {
    Way { name, method, iterations, samples_per_pixel: 1, seeds, blur, behind_glass: true }
}

fn ppm(iterations: u64, seeds: u64, blur: [f64; 2]) -> Way {
    blurred("ppm", Method::Ppm(PpmConfig::default()), iterations, seeds, blur)
}

fn vcm(iterations: u64, seeds: u64, blur: [f64; 2]) -> Way {
    blurred("vcm", Method::Vcm(VcmConfig::default()), iterations, seeds, blur)
}

fn auto(iterations: u64, seeds: u64, blur: [f64; 2]) -> Way {
    blurred("auto", Method::Auto(AutoConfig::default()), iterations, seeds, blur)
}

fn room(name: &str) -> &'static Room {
    ROOMS.iter().find(|room| room.name == name).expect("a room")
}

fn reference(name: &str) -> RoomReference {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rooms").join(name).with_extension("txt");
    let text = std::fs::read_to_string(file).expect("a file");
    RoomReference::parse(&text).expect("a reference")
}

/// A part of the picture by one way has the mean that the reference has, but for so much of it.
#[track_caller]
fn agree(name: &str, part: usize, found: &[f64], exact: &[f64], blur: f64) {
    let found_test: MeanTest = found.iter().copied().collect();
    let exact: MeanTest = forgiving(found, exact, blur).into_iter().collect();
    let outcome = found_test.welch(&exact);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, part {part}: {outcome}");
}

#[track_caller]
fn agrees(name: &str, way: &Way) {
    let (room, reference) = (room(name), reference(name));
    let world = room.world();
    let kinds = pixel_kinds(&world);
    let pictures =
        iterated_renders(&world, &way.method, way.iterations, way.samples_per_pixel, 100..100 + way.seeds);
    for (part, found) in part_samples(&pictures, &kinds).iter().enumerate() {
        let (is_glass, is_whole) = kind_of_part(part);
        let Some(exact) = reference.samples(part).filter(|_| way.behind_glass || !is_glass) else {
            continue;
        };
        let [whole, block] = way.blur;
        let of_reference = if is_glass { room.behind_glass } else { 0.0 };
        let blur = if is_whole { whole + of_reference } else { block + 2.0 * of_reference };
        agree(&format!("{name} by {}", way.name), part, found, &exact, blur);
    }
}

/// By the methods that do not blur. Connected paths see through glass but not what glass makes of light there.
fn agrees_without_blur(name: &str) {
    let exact = |name, method, iterations, samples_per_pixel, behind_glass| Way {
        name,
        method,
        iterations,
        samples_per_pixel,
        seeds: 8,
        blur: [0.0; 2],
        behind_glass,
    };
    agrees(name, &exact("ptracer", light_tracer(None), 1, 256, false));
    let connects = Method::Vcm(VcmConfig { merging: false, ..VcmConfig::default() });
    agrees(name, &exact("vcm that connects", connects, 4, 1, false));
    let room = room(name);
    if room.path {
        agrees(name, &exact("path", path(), 1, 256, true));
    }
    if std::env::var_os("NEPHROID_LONG").is_some() {
        let (again, reference) = (room.reference(1..17), reference(name));
        for part in 0..ROOM_PARTS {
            if let Some((found, exact)) = again.samples(part).zip(reference.samples(part)) {
                agree(&format!("{name} again"), part, &found, &exact, 0.0);
            }
        }
    }
}

#[test]
fn a_plain_room() {
    agrees_without_blur("room");
}

#[test]
fn a_plain_room_by_photons() {
    agrees("room", &ppm(8, 8, [0.005, 0.015]));
    agrees("room", &vcm(4, 8, [0.01, 0.02]));
}

#[test]
fn a_plain_room_by_auto() {
    agrees("room", &auto(4, 8, [0.01, 0.02]));
}

#[test]
fn a_room_lit_through_a_keyhole() {
    agrees_without_blur("keyhole");
}

#[test]
fn a_room_lit_through_a_keyhole_by_ppm() {
    agrees("keyhole", &ppm(8, 24, [0.02, 0.04]));
}

#[test]
fn a_room_lit_through_a_keyhole_by_vcm() {
    agrees("keyhole", &vcm(4, 24, [0.02, 0.04]));
}

#[test]
fn a_room_lit_through_a_keyhole_by_auto() {
    agrees("keyhole", &auto(8, 20, [0.02, 0.04]));
}

#[test]
fn a_lamp_in_a_closed_bulb() {
    agrees_without_blur("bulb");
}

#[test]
fn a_lamp_in_a_closed_bulb_by_ppm() {
    agrees("bulb", &ppm(8, 8, [0.03, 0.08]));
}

#[test]
fn a_lamp_in_a_closed_bulb_by_vcm() {
    agrees("bulb", &vcm(4, 8, [0.02, 0.04]));
}

#[test]
fn a_lamp_in_a_closed_bulb_by_auto() {
    agrees("bulb", &auto(8, 8, [0.03, 0.08]));
}

#[test]
fn sunlight_through_a_window() {
    agrees_without_blur("window");
}

#[test]
fn sunlight_through_a_window_by_ppm() {
    agrees("window", &ppm(4, 8, [0.02, 0.1]));
}

#[test]
fn sunlight_through_a_window_by_auto() {
    agrees("window", &auto(4, 8, [0.02, 0.1]));
}

/// Few photons come through a window, and are merged from 0.3 m around when 20 000 light paths are traced: walls of a metre
/// are a fifth darker for want of photons beyond their edges, and shadows are brighter. With sixteen times the paths the
/// radius is a fourth, and so is blur ∝ r; half of it is forgiven, or a hundredth of the light. An error in the weights
/// would not go away.
///
/// Pixels are halved, as nothing is merged from less than a pixel around.
#[test]
fn sunlight_through_a_window_by_vcm_narrows() {
    let fine = 64;
    let (room, reference) = (room("window"), reference("window"));
    let (world, kinds) = (room.world_of(fine), pixel_kinds(&room.world()));
    let [wide, narrow] = [(20_000, 100..132), (320_000, 200..216)].map(|(light_paths, seeds)| {
        let method = Method::Vcm(VcmConfig { light_paths: Some(light_paths), ..VcmConfig::default() });
        let pictures: Vec<_> = iterated_renders(&world, &method, 1, 1, seeds)
            .iter()
            .map(|picture| coarser(picture, fine))
            .collect();
        part_samples(&pictures, &kinds)
    });
    for (part, (wide, narrow)) in wide.iter().zip(&narrow).enumerate() {
        let Some(exact) = reference.samples(part) else { continue };
        let [wide, exact_mean] =
            [wide, &exact].map(|samples| samples.iter().copied().collect::<MeanTest>().mean());
        let left = (0.5 * (wide / exact_mean - 1.0).abs()).max(0.01);
        agree("window by vcm", part, narrow, &exact, left);
    }
}
