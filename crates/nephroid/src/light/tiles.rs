use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::Vec2;
use crate::sampling::Discrete2d;
use crate::texture::{Texture, Textures};

/// Tiles along each side for textures that are no image, and at most for those that are.
const TILES: u32 = 64;
const MOST_TILES: u32 = 1024;

/// The share of points that lie evenly, in case a tile's trial points missed some of the light.
const EVENLY: f64 = 0.1;

/// How uneven light must be, ⟨L²⟩/⟨L⟩², for points to be sampled by it.
const WORTH: f64 = 1.1;

/// A texture over the parameter square, in tiles.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    /// Over the square.
    pub mean: Rgb,
    /// Tiles by brightness; `None` where they are about the same.
    table: Option<Discrete2d>,
}

impl Tiles {
    /// `None` for a constant.
    pub fn new(textures: &Textures, texture: Handle<Texture>) -> Option<Self> {
        let [w, h] = size(textures, texture)?;
        let mut weights = Vec::with_capacity(w as usize * h as usize);
        let (mut sum, mut squares) = ([0.0f64; 3], 0.0);
        for y in 0..h {
            for x in 0..w {
                let mut tile = [0.0f64; 3];
                // A quarter from the edges: between pixels an image is linear, and of each half the middle is the mean.
                for [dx, dy] in [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]] {
                    let uv = Vec2::new((x as f32 + dx) / w as f32, (y as f32 + dy) / h as f32);
                    let value = textures.eval(texture, uv).to_array();
                    tile.iter_mut().zip(value).for_each(|(t, v)| *t += 0.25 * f64::from(v));
                }
                let brightness = tile.iter().sum::<f64>() / 3.0;
                weights.push(brightness);
                squares += brightness * brightness;
                sum.iter_mut().zip(tile).for_each(|(s, t)| *s += t);
            }
        }
        let count = weights.len() as f64;
        let total: f64 = weights.iter().sum();
        let uneven = total > 0.0 && count * squares > WORTH * total * total;
        let even = EVENLY * total / count;
        let mixed: Vec<f64> = weights.iter().map(|weight| (1.0 - EVENLY) * weight + even).collect();
        let table = if uneven { Discrete2d::new(&mixed, w as usize, h as usize) } else { None };
        Some(Self { mean: Rgb::from(sum.map(|s| (s / count) as f32)), table })
    }

    /// A point of the square and its density, 1 in the mean.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        self.table.as_ref().map_or((u, 1.0), |table| table.sample(u))
    }

    /// The density of [`Self::sample`] at a point.
    pub fn density(&self, uv: Vec2) -> f32 {
        self.table.as_ref().map_or(1.0, |table| table.pdf(uv.clamp(Vec2::ZERO, Vec2::ONE)))
    }
}

/// Tiles along each side: those of the finest image that the texture is made of; `None` if it is constant.
fn size(textures: &Textures, texture: Handle<Texture>) -> Option<[u32; 2]> {
    match &textures.list[texture] {
        Texture::Constant(_) | Texture::VertexColor => None,
        Texture::Bitmap(bitmap) => {
            let image = &textures.images[bitmap.image];
            Some([image.width, image.height].map(|n| n.clamp(1, MOST_TILES)))
        }
        Texture::Checkerboard(_) => Some([TILES; 2]),
        other => {
            let finer = |[a, b]: [u32; 2], [c, d]: [u32; 2]| [a.max(c), b.max(d)];
            other.children().filter_map(|child| size(textures, child)).reduce(finer)
        }
    }
}
