//! Beams cut into pieces, so that the boxes around them are compact.

use super::Beam;
use crate::bvh::Boxes;
use crate::math::{Bounds, Vec3, gamma};

/// How many cuts are made through a beam on the average, at most; so there are no more than one piece more.
///
/// Each piece takes some 60 bytes. With 20 000 beams across a box, a ray with 41 beams that count comes to 677, 311
/// and 195 leaves where a beam is in 1.2, 2.8 and 5.5 pieces: the boxes around eight pieces shrink more
/// slowly than those around each. Beyond three pieces rays gain nothing, and building takes twice as long.
const MEAN_CUTS: f64 = 2.0;

/// A part of a beam: the distances s from its origin with `start` ≤ s < `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub beam: u32,
    pub start: f32,
    pub end: f32,
}

/// All pieces of all beams, and the boxes in which a ray that meets them must come within the radius.
pub(super) struct Pieces<'a> {
    pub beams: &'a [Beam],
    pub pieces: Vec<Piece>,
    pub margin: f32,
}

impl<'a> Pieces<'a> {
    /// Cuts all beams at about the same length, that is in proportion to their own: long ones into many, short
    /// ones not at all, and neither those along an axis, whose boxes are thin as they are.
    pub fn new(beams: &'a [Beam], radius: f32) -> Self {
        let total: f64 = beams.iter().map(slanted_length).sum();
        let mean = total / beams.len().max(1) as f64;
        // Below the width of a beam nothing is gained.
        let target = (mean / MEAN_CUTS).max(2.0 * f64::from(radius));
        let mut pieces = Vec::with_capacity(beams.len() * 3);
        for (number, beam) in (0u32..).zip(beams) {
            if beam.is_proper() {
                cut(beam, number, 1.0 + (slanted_length(beam) / target).floor(), &mut pieces);
            }
        }
        let proper = beams.iter().filter(|beam| beam.is_proper());
        let all = Bounds::of(proper.flat_map(|beam| [beam.origin, beam.at(beam.length)]));
        let reach = all.min.abs().max(all.max.abs()).max_element().max(0.0);
        // Nearest points are computed from the beams' origins, with roundings.
        Self { beams, pieces, margin: radius + gamma(16) * reach }
    }
}

/// The side of a cube with the surface of the box around a beam; 0 if it is not proper.
fn slanted_length(beam: &Beam) -> f64 {
    if !beam.is_proper() {
        return 0.0;
    }
    let [x, y, z] = (beam.direction.abs().as_dvec3() * f64::from(beam.length)).to_array();
    (x * y + y * z + z * x).sqrt()
}

/// Cuts a beam into so many equal pieces, without a gap and without an overlap.
fn cut(beam: &Beam, number: u32, count: f64, pieces: &mut Vec<Piece>) {
    let count = count as u32;
    // The origin itself does not count.
    let mut start = f32::MIN_POSITIVE;
    for i in 1..=count {
        let part = f64::from(i) / f64::from(count);
        let end = if i == count { beam.length } else { (f64::from(beam.length) * part) as f32 };
        pieces.push(Piece { beam: number, start, end });
        start = end;
    }
}

impl Boxes for Pieces<'_> {
    fn count(&self) -> u32 {
        self.pieces.len() as u32
    }

    fn get(&self, number: u32) -> Bounds {
        let piece = &self.pieces[number as usize];
        let beam = &self.beams[piece.beam as usize];
        let bounds = Bounds::of([beam.at(piece.start), beam.at(piece.end)]);
        let margin = Vec3::splat(self.margin);
        Bounds { min: bounds.min - margin, max: bounds.max + margin }
    }
}
