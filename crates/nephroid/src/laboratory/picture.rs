//! Photons on the image plane of the scene's camera.

use rayon::prelude::*;

use super::photons::MapPhoton;
use crate::color::Rgb;
use crate::film::Crop;
use crate::integrator::MapName;
use crate::math::real::ln;
use crate::math::{Ray, Vec2, Vec3};
use crate::texture::Image;
use crate::world::{Hit, World, leave};

/// A photon on a surface counts as seen if nothing lies before it up to this share of the way: its own surface is
/// there.
const SEEN_UP_TO: f32 = 1.0 - 1e-4;

/// Brightness of a surface that faces the camera, behind the photons.
const BACKGROUND: f32 = 0.16;

/// Bounces from which on photons share a colour.
const MOST_BOUNCES: u32 = 6;

/// What the colour of a photon tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotonColor {
    /// The map that holds it.
    #[default]
    Map,
    /// How often it bounced.
    Bounce,
    /// The light it came from.
    Light,
    /// Its power, on a logarithmic scale.
    Power,
}

/// How photons are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonPicture {
    /// What colours tell.
    pub color: PhotonColor,
    /// Diameter of a photon in pixels, at least 1.
    pub size: u32,
    /// Also those that the camera cannot see for what lies before them.
    pub through_walls: bool,
}

/// A colour of a picture of photons, and what it stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// What it stands for.
    pub label: String,
    /// The colour as display values in [0, 1].
    pub color: Rgb,
    /// How many photons of the picture have it; of a scale, how many are drawn in all.
    pub photons: usize,
}

/// A photon where it is drawn.
struct Dot {
    /// Squared distance from the camera.
    distance_sq: f32,
    position: Vec2,
    class: u32,
    color: Rgb,
}

/// Draws photons, near ones over far ones, in the window that a render would fill: display values in
/// [0, 1], and what the colours mean. Without [`PhotonPicture::through_walls`] only photons are drawn that
/// nothing opaque hides and that lie on the side the camera sees of their surface, before surfaces in dark
/// grey. Those in media are seen from all sides. All lie on straight lines from the camera: mirrors show none, and glass
/// bends nothing.
pub fn photon_picture(
    world: &World,
    photons: &[MapPhoton],
    options: &PhotonPicture,
) -> (Image, Vec<LegendEntry>) {
    let window = world.scene().film.window();
    let scale = Scale::new(options.color, photons);
    let mut dots: Vec<Dot> =
        photons.par_iter().filter_map(|photon| dot(world, photon, &scale, options, &window)).collect();
    // A stable sort: photons as far as one another stay in the order of their paths.
    dots.par_sort_by(|a, b| b.distance_sq.total_cmp(&a.distance_sq));
    let mut image = if options.through_walls {
        Image::filled(window.width, window.height, Rgb::BLACK)
    } else {
        background(world, &window)
    };
    for dot in &dots {
        draw(&mut image, dot, options.size.max(1));
    }
    let legend = scale.legend(world, &dots);
    (image, legend)
}

fn dot(
    world: &World,
    photon: &MapPhoton,
    scale: &Scale,
    options: &PhotonPicture,
    window: &Crop,
) -> Option<Dot> {
    let place = photon.photon.position;
    let (position, from) = world.camera().project(place)?;
    let position = position - Vec2::new(window.x as f32, window.y as f32);
    let margin = options.size as f32;
    let inside = |v: f32, size: u32| v >= -margin && v < size as f32 + margin;
    if !inside(position.x, window.width) || !inside(position.y, window.height) {
        return None;
    }
    let towards = place - from;
    let in_medium = photon.bounces.ends_in_medium();
    let turned_away = !in_medium && photon.photon.normal.dot(towards) >= 0.0;
    let seen_up_to = if in_medium { 1.0 } else { SEEN_UP_TO };
    if !options.through_walls && (turned_away || is_hidden(world, from, place, seen_up_to)) {
        return None;
    }
    let (class, color) = scale.class_and_color(photon);
    Some(Dot { distance_sq: towards.length_squared(), position, class, color })
}

/// Whether anything opaque lies between the camera and a photon, in a straight line, up to a share of the way.
fn is_hidden(world: &World, camera: Vec3, photon: Vec3, seen_up_to: f32) -> bool {
    let mut origin = camera;
    loop {
        let ray = Ray { origin, direction: photon - origin, t_max: seen_up_to };
        let Some(hit) = world.intersect(&ray) else { return false };
        if !is_clear(world, &hit) {
            return true;
        }
        origin = leave(&hit.point, ray.direction).origin;
    }
}

/// Whether photons show through a surface.
fn is_clear(world: &World, hit: &Hit) -> bool {
    let scene = world.scene();
    world.material_of(hit.shape).is_clear(&scene.materials, &scene.textures)
}

/// Fills the pixels whose centres a dot covers, and at least the one that it lies in.
fn draw(image: &mut Image, dot: &Dot, size: u32) {
    let Vec2 { x, y } = dot.position;
    let radius = 0.5 * size as f32;
    let rows = (y - radius).floor() as i64..=(y + radius).floor() as i64;
    for row in rows {
        for column in (x - radius).floor() as i64..=(x + radius).floor() as i64 {
            let (dx, dy) = (column as f32 + 0.5 - x, row as f32 + 0.5 - y);
            let own = column == x.floor() as i64 && row == y.floor() as i64;
            let covered = own || (size > 1 && dx * dx + dy * dy <= radius * radius);
            let inside =
                (0..i64::from(image.width)).contains(&column) && (0..i64::from(image.height)).contains(&row);
            if covered && inside {
                image.pixels[row as usize * image.width as usize + column as usize] = dot.color;
            }
        }
    }
}

/// Where photons are seen from: all that is out of focus is drawn sharp.
const MIDDLE_OF_LENS: Vec2 = Vec2::splat(0.5);

/// Surfaces in dark grey, darker where they are seen at an angle.
fn background(world: &World, window: &Crop) -> Image {
    let pixels = (0..window.width as usize * window.height as usize).into_par_iter().map(|i| {
        let (x, y) = (i % window.width as usize, i / window.width as usize);
        let position = Vec2::new((window.x as usize + x) as f32 + 0.5, (window.y as usize + y) as f32 + 0.5);
        let mut ray = world.camera().ray(position, MIDDLE_OF_LENS);
        let mut inside = world.camera_surroundings();
        while let Some(hit) = world.intersect(&ray) {
            if !world.bsdf_within(&hit, -ray.direction, &inside).is_null() {
                return Rgb::splat(BACKGROUND * (0.25 + 0.75 * hit.point.ns.dot(ray.direction).abs()));
            }
            inside = world.cross(inside, &hit, ray.direction, ray.direction);
            ray = leave(&hit.point, ray.direction);
        }
        Rgb::BLACK
    });
    Image { width: window.width, height: window.height, pixels: pixels.collect() }
}

/// From photons to colours.
struct Scale {
    color: PhotonColor,
    /// The least and the largest power.
    power: (f32, f32),
}

impl Scale {
    fn new(color: PhotonColor, photons: &[MapPhoton]) -> Self {
        let powers = photons.iter().map(|p| p.photon.power.mean()).filter(|p| *p > 0.0);
        let power = powers.fold((f32::INFINITY, 0.0f32), |(least, most), p| (least.min(p), most.max(p)));
        Self { color, power }
    }

    fn class_and_color(&self, photon: &MapPhoton) -> (u32, Rgb) {
        match self.color {
            PhotonColor::Map => (photon.map as u32, of_map(photon.map)),
            PhotonColor::Bounce => {
                let bounces = photon.bounces.count().min(MOST_BOUNCES);
                (bounces, of_bounces(bounces))
            }
            PhotonColor::Light => (photon.photon.light, of_number(photon.photon.light)),
            PhotonColor::Power => {
                let (least, most) = self.power;
                let power = photon.photon.power.mean().max(least);
                let t = if most > least { ln(power / least) / ln(most / least) } else { 1.0 };
                (0, ramp(t))
            }
        }
    }

    /// What the colours in use stand for.
    fn legend(&self, world: &World, dots: &[Dot]) -> Vec<LegendEntry> {
        if self.color == PhotonColor::Power {
            let (least, most) = self.power;
            let steps = [(0.0, least), (0.5, (least * most).sqrt()), (1.0, most)];
            let entry = |(t, power): (f32, f32)| LegendEntry {
                label: format!("{power:.3e} W"),
                color: ramp(t),
                photons: dots.len(),
            };
            return if dots.is_empty() { Vec::new() } else { steps.map(entry).to_vec() };
        }
        let mut counts = std::collections::BTreeMap::new();
        for dot in dots {
            counts.entry(dot.class).or_insert((dot.color, 0)).1 += 1;
        }
        let names: Vec<&str> = world.lights().map(|(name, _)| name).collect();
        let label = |class: u32| match self.color {
            PhotonColor::Map => MapName::ALL.get(class as usize).map_or("", |map| map.name()).to_owned(),
            PhotonColor::Bounce if class == MOST_BOUNCES => format!("{class} or more bounces"),
            PhotonColor::Bounce if class == 1 => "1 bounce".to_owned(),
            PhotonColor::Bounce => format!("{class} bounces"),
            _ => format!("light {class}: {}", names.get(class as usize).unwrap_or(&"")),
        };
        let entry = |(class, (color, photons))| LegendEntry { label: label(class), color, photons };
        counts.into_iter().map(entry).collect()
    }
}

fn of_map(map: MapName) -> Rgb {
    match map {
        MapName::Global => Rgb::new(0.45, 0.65, 1.0),
        MapName::Caustic => Rgb::new(1.0, 0.65, 0.1),
        MapName::Afterglow => Rgb::new(0.4, 0.9, 0.45),
        MapName::Haze => Rgb::new(0.8, 0.5, 0.9),
        MapName::Volume => Rgb::new(0.85, 0.9, 0.8),
        MapName::VolumeCaustic => Rgb::new(1.0, 0.4, 0.35),
    }
}

/// White for light that comes straight, then from blue to red.
fn of_bounces(bounces: u32) -> Rgb {
    match bounces {
        0 => Rgb::WHITE,
        1 => Rgb::new(0.3, 0.55, 1.0),
        2 => Rgb::new(0.2, 0.85, 0.9),
        3 => Rgb::new(0.3, 0.85, 0.3),
        4 => Rgb::new(0.95, 0.9, 0.25),
        5 => Rgb::new(1.0, 0.6, 0.15),
        _ => Rgb::new(1.0, 0.3, 0.25),
    }
}

/// A hue for each number, those of neighbours far apart: multiples of the golden section of the circle.
fn of_number(number: u32) -> Rgb {
    let turn = (0.12 + f64::from(number) * 0.618_033_988_749_895).fract() as f32;
    let channel = |shift: f32| {
        let distance = (6.0 * (turn + shift).fract() - 3.0).abs() - 1.0;
        0.3 + 0.7 * distance.clamp(0.0, 1.0)
    };
    Rgb::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

/// From dark blue by red to light yellow.
fn ramp(t: f32) -> Rgb {
    let stops = [Vec3::new(0.15, 0.15, 0.6), Vec3::new(0.85, 0.2, 0.35), Vec3::new(1.0, 0.95, 0.6)];
    let t = 2.0 * t.clamp(0.0, 1.0);
    let (from, to) = if t < 1.0 { (stops[0], stops[1]) } else { (stops[1], stops[2]) };
    let c = from.lerp(to, if t < 1.0 { t } else { t - 1.0 });
    Rgb::new(c.x, c.y, c.z)
}
