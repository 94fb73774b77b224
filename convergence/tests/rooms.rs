//! Built-in rooms by every method that can see them, against what long renders found: a plain room, one lit through a
//! keyhole and one by a lamp in a closed bulb.
//!
//! References are the files in `rooms/`: means of blocks of pixels, of those that see no glass and of those that do. They
//! are path tracing's where that finds the light, else light tracing's where no glass is seen and late progressive photon
//! mapping's where it is. This makes them again:
//!
//! ```sh
//! cargo run --release -p nephroid-convergence --example room_references -- convergence/tests/rooms
//! ```
//!
//! Photons blur, and more so where surfaces meet: that is forgiven as stated beside each way, so much of the whole and
//! twice that of a block. Where a wall has no thickness, photons at its foot count on both sides of it, which no share of
//! a dark room's light covers: there only what does not blur is asked. Beyond that the tests of the file share the level
//! [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail somewhere with probability 1 %.
//!
//! `NEPHROID_LONG=1` renders references of other seeds as well and compares them with those of the files.

use std::path::Path;

use nephroid::integrator::{Method, PpmConfig, VcmConfig};
use nephroid_convergence::{
    ROOM_PARTS, ROOMS, Room, RoomReference, forgiving, iterated_renders, kind_of_part, light_tracer,
    part_samples, path, pixel_kinds,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the rooms' parts by their ways.
const TESTS: usize = ROOMS.len() * ROOM_PARTS * 6;

/// Seeds of each way.
const SEEDS: u64 = 8;

/// A method, and what is asked of it.
struct Way {
    name: &'static str,
    method: Method,
    iterations: u64,
    samples_per_pixel: u32,
    /// How far the mean over a whole picture may be off, relative.
    bias: f64,
    /// Whether it sees what lies behind glass.
    behind_glass: bool,
}

/// The ways to render a room. All that there are to add to for another method.
fn ways(room: &Room) -> Vec<Way> {
    let exact = |name, method, samples_per_pixel, behind_glass| Way {
        name,
        method,
        iterations: 1,
        samples_per_pixel,
        bias: 0.0,
        behind_glass,
    };
    let blurred = |name, method, iterations, bias| Way {
        name,
        method,
        iterations,
        samples_per_pixel: 1,
        bias,
        behind_glass: true,
    };
    let mut ways = vec![exact("ptracer", light_tracer(None), 256, false)];
    if room.thin_walls {
        let vcm = Method::Vcm(VcmConfig { merging: false, ..VcmConfig::default() });
        ways.push(Way { iterations: 16, ..exact("vcm that connects", vcm, 1, false) });
    } else {
        ways.push(blurred("ppm", Method::Ppm(PpmConfig::default()), 16, 0.02));
    }
    if room.path {
        ways.push(exact("path", path(), 256, true));
    }
    ways
}

fn reference(name: &str) -> RoomReference {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rooms").join(name).with_extension("txt");
    let text = std::fs::read_to_string(file).expect("a file");
    RoomReference::parse(&text).expect("a reference")
}

/// A part of the picture by one way has the mean that the reference has, but for so much of it.
#[track_caller]
fn agree(name: &str, part: usize, found: &[f64], exact: &[f64], bias: f64) {
    let found_test: MeanTest = found.iter().copied().collect();
    let exact: MeanTest = forgiving(found, exact, bias).into_iter().collect();
    let outcome = found_test.welch(&exact);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, part {part}: {outcome}");
}

fn all_agree(name: &str) {
    let room = ROOMS.iter().find(|room| room.name == name).expect("a room");
    let (world, reference) = (room.world(), reference(name));
    let kinds = pixel_kinds(&world);
    for (number, way) in (1..).zip(ways(room)) {
        let seeds = 100 * number..100 * number + SEEDS;
        let pictures = iterated_renders(&world, &way.method, way.iterations, way.samples_per_pixel, seeds);
        for (part, found) in part_samples(&pictures, &kinds).iter().enumerate() {
            let (is_glass, is_whole) = kind_of_part(part);
            let Some(exact) = reference.samples(part).filter(|_| way.behind_glass || !is_glass) else {
                continue;
            };
            let bias = way.bias + if is_glass { room.behind_glass } else { 0.0 };
            let bias = if is_whole { bias } else { 2.0 * bias };
            agree(&format!("{name} by {}", way.name), part, found, &exact, bias);
        }
    }
    if std::env::var_os("NEPHROID_LONG").is_some() {
        let again = room.reference(1..17);
        for part in 0..ROOM_PARTS {
            if let Some((found, exact)) = again.samples(part).zip(reference.samples(part)) {
                agree(&format!("{name} again"), part, &found, &exact, 0.0);
            }
        }
    }
}

#[test]
fn a_plain_room() {
    all_agree("room");
}

#[test]
fn a_room_lit_through_a_keyhole() {
    all_agree("keyhole");
}

#[test]
fn a_lamp_in_a_closed_bulb() {
    all_agree("bulb");
}
