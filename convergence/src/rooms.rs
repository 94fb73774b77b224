//! The built-in rooms that are hard in different ways, what long renders found in them, and pictures taken apart so that
//! each part can be compared with what can see it.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use nephroid::film::Filter;
use nephroid::integrator::{Method, PpmConfig};
use nephroid::material::Material;
use nephroid::world::World;
use nephroid_formats::Options;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::vfs::DiskFiles;
use nephroid_testkit::MeanTest;

use crate::{Builder, iterated_renders, light_tracer, path, renders};

/// Pixels of a picture's side, and of a block's.
const SIDE: usize = 32;
const BLOCK: usize = 8;

/// Pixels of the finer pictures' side that references of what is seen through glass are taken from: nothing is narrower
/// than a pixel by what blurs.
const FINE: usize = 128;

/// The fewest pixels that make a part.
const FEW: u32 = 6;

/// The radiance of lamps beside which what is lit cannot be told, in rooms where that is about one.
const GLARE: f64 = 0.02;

/// Parts of a picture: blocks and the whole, of pixels that see no glass and of those that do.
pub const ROOM_PARTS: usize = 2 * PARTS;
const PARTS: usize = SIDE * SIDE / (BLOCK * BLOCK) + 1;

/// A built-in scene, and what renders its reference: without bias but for glass that a distant lamp is seen through.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Its name.
    pub name: &'static str,
    /// Whether path tracing finds all of its light often enough.
    pub path: bool,
    /// Camera samples of each pixel, or as many light paths, to a seed of the reference.
    samples_per_pixel: u32,
    /// The bias of the reference where glass is seen, relative: photons blur there.
    pub behind_glass: f64,
}

/// The rooms.
pub const ROOMS: [Room; 4] = [
    Room { name: "room", path: true, samples_per_pixel: 512, behind_glass: 0.0 },
    Room { name: "keyhole", path: true, samples_per_pixel: 4096, behind_glass: 0.0 },
    Room { name: "bulb", path: false, samples_per_pixel: 1024, behind_glass: 0.02 },
    Room { name: "window", path: false, samples_per_pixel: 2048, behind_glass: 0.02 },
];

/// A built-in scene in a picture of so many pixels a side, each of which is what its own rays see.
///
/// # Panics
/// If the file cannot be read.
pub fn built_in(name: &str, side: usize) -> World {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).with_extension("xml");
    let define = |name: &str| (name.to_owned(), side.to_string());
    let options = Options { defines: vec![define("width"), define("height")], lenient: false };
    let mut scene = read_scene(&file, &DiskFiles, &options).expect("a built-in scene").scene;
    scene.film.filter = Filter::Box;
    World::new(scene).expect("a sound scene")
}

impl Room {
    /// The scene in a small picture, each pixel of which is what its own rays see.
    ///
    /// # Panics
    /// If the file cannot be read.
    pub fn world(&self) -> World {
        self.world_of(SIDE)
    }

    /// The same with so many pixels a side: see [`coarser`].
    ///
    /// # Panics
    /// If the file cannot be read.
    pub fn world_of(&self, side: usize) -> World {
        built_in(self.name, side)
    }

    /// Renders a reference, from so many seeds of each method. Takes some minutes for sixteen.
    pub fn reference(&self, seeds: Range<u64>) -> RoomReference {
        let world = self.world();
        let kinds = pixel_kinds(&world);
        let exact = if self.path { path() } else { light_tracer(None) };
        let mut parts = part_samples(&renders(&world, &exact, self.samples_per_pixel, seeds.clone()), &kinds);
        if !self.path {
            let fine = self.world_of(FINE);
            let late = iterated_renders(&fine, &Method::Ppm(PpmConfig::default()), 16, 1, seeds.clone());
            let late: Vec<_> = late.iter().map(|picture| coarser(picture, FINE)).collect();
            parts.truncate(PARTS);
            parts.extend_from_slice(&part_samples(&late, &kinds)[PARTS..]);
        }
        let summary = |samples: Vec<f64>| {
            let test: MeanTest = samples.into_iter().collect();
            (test.count() > 0).then(|| [test.mean(), test.standard_error()])
        };
        RoomReference { seeds: seeds.end - seeds.start, parts: parts.into_iter().map(summary).collect() }
    }
}

/// A finer picture, so many pixels a side, in as few as those of [`Room::world`].
pub fn coarser(picture: &[f64], side: usize) -> Vec<f64> {
    let ratio = side / SIDE;
    let mut sums = vec![0.0; SIDE * SIDE];
    for (i, value) in picture.iter().enumerate() {
        sums[i / side / ratio * SIDE + i % side / ratio] += value / (ratio * ratio) as f64;
    }
    sums
}

/// What a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelKind {
    /// No glass.
    Bare,
    /// Glass, by some of its rays at least.
    Glass,
    /// A lamp through glass, which outshines all else there is to see.
    Glare,
}

/// What each pixel sees: by the same scene in which glass shines and nothing else, and in one where lamps do and surfaces
/// reflect nothing.
pub fn pixel_kinds(world: &World) -> Vec<PixelKind> {
    let is_glass = |material: &Material| matches!(material, Material::Dielectric { .. });
    let seen = |change: &dyn Fn(&mut Builder)| {
        let mut b = Builder { scene: world.scene().clone() };
        change(&mut b);
        renders(&b.build(), &path(), 256, 0..1).remove(0)
    };
    let glass = seen(&|b| {
        let (black, glow) = (b.diffuse(0.0), b.constant(1.0));
        b.scene.lights.clear();
        for shape in &mut b.scene.shapes {
            let shines = is_glass(&b.scene.materials[shape.material]);
            (shape.material, shape.emission) = (black, shines.then_some(glow));
        }
    });
    let lamps = seen(&|b| {
        let black = b.diffuse(0.0);
        b.scene.lights.clear();
        for shape in &mut b.scene.shapes {
            if !is_glass(&b.scene.materials[shape.material]) {
                shape.material = black;
            }
        }
    });
    let kind = |(glass, lamp): (&f64, &f64)| match () {
        () if *glass == 0.0 => PixelKind::Bare,
        () if *lamp > GLARE => PixelKind::Glare,
        () => PixelKind::Glass,
    };
    glass.iter().zip(&lamps).map(kind).collect()
}

/// The means of the parts of pictures: for each part one number from each picture, or none if it has too few pixels.
pub fn part_samples(pictures: &[Vec<f64>], kinds: &[PixelKind]) -> Vec<Vec<f64>> {
    let block = |i: usize| i / SIDE / BLOCK * (SIDE / BLOCK) + i % SIDE / BLOCK;
    let mut parts = vec![Vec::new(); ROOM_PARTS];
    for picture in pictures {
        let mut sums = [(0.0, 0u32); ROOM_PARTS];
        for (i, (value, kind)) in picture.iter().zip(kinds).enumerate() {
            let first = match kind {
                PixelKind::Bare => 0,
                PixelKind::Glass => PARTS,
                PixelKind::Glare => continue,
            };
            for part in [first + block(i), first + PARTS - 1] {
                sums[part].0 += value;
                sums[part].1 += 1;
            }
        }
        for (part, (sum, pixels)) in parts.iter_mut().zip(sums) {
            part.extend((pixels >= FEW).then(|| sum / f64::from(pixels)));
        }
    }
    parts
}

/// Whether a part is of pixels that see glass, and whether it is the whole of its kind.
pub fn kind_of_part(part: usize) -> (bool, bool) {
    (part >= PARTS, part % PARTS == PARTS - 1)
}

/// What a long render found.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomReference {
    /// How many pictures the means are of.
    pub seeds: u64,
    /// The mean of each part and its standard error.
    pub parts: Vec<Option<[f64; 2]>>,
}

impl RoomReference {
    /// As many samples of a part as there were seeds, with their mean and its standard error: for those, of normal
    /// samples, are all that a t-test asks.
    pub fn samples(&self, part: usize) -> Option<Vec<f64>> {
        let [mean, standard_error] = self.parts[part]?;
        let spread = standard_error * libm::sqrt((self.seeds - 1) as f64);
        Some((0..self.seeds).map(|i| if i % 2 == 0 { mean + spread } else { mean - spread }).collect())
    }

    /// A line for each part: its mean and the standard error of that, or a dash; before them the number of seeds.
    pub fn to_text(&self) -> String {
        let mut text = format!("{}\n", self.seeds);
        for part in &self.parts {
            match part {
                Some([mean, error]) => writeln!(text, "{mean:.6e} {error:.2e}"),
                None => writeln!(text, "-"),
            }
            .expect("memory takes all");
        }
        text
    }

    /// Reads [`Self::to_text`]; `None` if it is none.
    pub fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let seeds = lines.next()?.parse().ok()?;
        let part = |line: &str| match line.split_once(' ') {
            Some((mean, error)) => Some(Some([mean.parse().ok()?, error.parse().ok()?])),
            None => (line == "-").then_some(None),
        };
        let parts: Vec<_> = lines.map(part).collect::<Option<_>>()?;
        (parts.len() == ROOM_PARTS && seeds > 0 && seeds % 2 == 0).then_some(Self { seeds, parts })
    }
}
