use super::block::Block;
use super::pieces::Pieces;
use super::{Beam, BeamWidth, Beams};
use crate::bvh::{Kind, Tree};
use crate::observer::Work;
use crate::photon_map::Blur;

/// The largest sine at which a beam may count as nearly parallel to a ray.
const MOST_PARALLEL: f32 = 0.125;

/// Beams and an index over them. Never changes.
///
/// Beams are cut into pieces by length, and an 8-wide tree holds the boxes around these, grown by the
/// radius, with up to eight pieces to a leaf that are tested at once.
#[derive(Clone, Debug)]
pub struct BeamMap {
    pub(super) beams: Vec<Beam>,
    pub(super) tree: Tree,
    pub(super) blocks: Vec<Block>,
    pub(super) radius: f32,
    /// Sines below this are nearly parallel.
    pub(super) parallel_sin: f32,
    emitted: u64,
}

impl BeamMap {
    /// Arranges beams and divides their power by the number of paths emitted.
    ///
    /// Beams that are not finite or have no length are kept but never found. Panics with 2³² beams or more.
    pub fn build(beams: Beams, width: BeamWidth) -> Self {
        Self::build_narrow(beams, width, Blur::WHOLE)
    }

    /// As [`Self::build`], with beams narrower: each is blurred in one dimension. That comes after the largest radius
    /// has its say, else few beams would never narrow.
    pub fn build_narrow(beams: Beams, width: BeamWidth, blur: Blur) -> Self {
        assert!(u32::try_from(beams.stored()).is_ok(), "a map holds fewer than 2^32 beams");
        let emitted = beams.emitted();
        let beams = beams.into_shares();
        let radius = width.radius(&beams) * blur.factor(1);
        let pieces = Pieces::new(&beams, radius);
        let mut blocks = Vec::with_capacity(pieces.pieces.len() / 4);
        let leaf = |_, numbers: &[u32]| {
            blocks.push(Block::new(&beams, numbers.iter().map(|&i| pieces.pieces[i as usize])));
            blocks.len() as u32 - 1
        };
        // Like flat shapes, up to eight pieces are tested in about the time of eight boxes.
        let tree = Tree::build(&Work::silent(), &pieces, |_| Kind::Flats, leaf);
        blocks.shrink_to_fit();
        let parallel_sin = parallel_sin(&beams, radius);
        Self { beams, tree, blocks, radius, parallel_sin, emitted }
    }

    /// How many beams it holds. Nothing is ever divided by this.
    pub fn len(&self) -> usize {
        self.beams.len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// Paths emitted to make it, including those that stored nothing.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// A beam by its number in the pass, with its share of the light's power.
    pub fn beam(&self, number: usize) -> Beam {
        self.beams[number]
    }

    /// How far beams are blurred to either side.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The sine of the angle to a ray below which a beam is blurred in two dimensions.
    pub fn parallel_sin(&self) -> f32 {
        self.parallel_sin
    }

    /// Bytes of heap memory.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.beams.as_slice()) + size_of_val(self.blocks.as_slice()) + self.tree.bytes()
    }
}

/// See the module's introduction.
fn parallel_sin(beams: &[Beam], radius: f32) -> f32 {
    let lengths = beams.iter().filter(|beam| beam.is_proper()).map(|beam| f64::from(beam.length));
    let (count, length) = lengths.fold((0.0, 0.0), |(n, sum), length| (n + 1.0, sum + length));
    let sin = (f64::from(radius) * count / length) as f32;
    // Not a number where there is no beam: then the larger.
    sin.max(f32::EPSILON.sqrt()).min(MOST_PARALLEL)
}
