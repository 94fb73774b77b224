use std::iter;
use std::ops::Range;

use super::Boxes;
use crate::math::{Bounds, Vec3};

/// Boxes, parted from the whole down.
pub(super) struct Parted {
    /// Nodes of the tree over the parts, each before what is left of it and then what is right: the area of an inner one,
    /// `None` for a part.
    pub areas: Vec<Option<f32>>,
    /// The parts in order: places in the list of items.
    pub parts: Vec<Range<usize>>,
}

/// Bins along each axis.
const BINS: usize = 32;

/// So many levels are parted by area. Where centres come closer and closer to one place there could be thousands, and below
/// these the rest is halved as it comes.
const LEVELS: u32 = 64;

/// Orders the items and parts them until no part has more than `most`, each time where the areas of both sides, times what
/// is in them, are least (Wald 2007, *On fast Construction of SAH-based Bounding Volume Hierarchies*,
/// 10.1109/RT.2007.4342588). Coordinates count times `scale`. Both sides are parted at once.
pub(super) fn part(boxes: &(impl Boxes + ?Sized), scale: f32, items: &mut [u32], most: usize) -> Parted {
    part_from(boxes, scale, items, most, 0, LEVELS)
}

/// The same for items that follow so many others, with so many levels left.
fn part_from(
    boxes: &(impl Boxes + ?Sized),
    scale: f32,
    items: &mut [u32],
    most: usize,
    first: usize,
    levels: u32,
) -> Parted {
    if items.len() <= most {
        let whole = first..first + items.len();
        return Parted { areas: vec![None], parts: iter::once(whole).collect() };
    }
    let (mut bounds, mut centers) = (Bounds::EMPTY, Bounds::EMPTY);
    for &item in &*items {
        let one = boxes.get(item);
        bounds = bounds.union(one);
        centers = centers.with(center(&one));
    }
    let middle = if levels > 0 { divide(boxes, scale, items, &centers) } else { items.len() / 2 };
    let levels = levels.saturating_sub(1);
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = rayon::join(
        || part_from(boxes, scale, left, most, first, levels),
        || part_from(boxes, scale, right, most, first + middle, levels),
    );
    let mut areas = vec![Some(scaled_area(&bounds, scale))];
    areas.extend(left.areas.into_iter().chain(right.areas));
    Parted { areas, parts: left.parts.into_iter().chain(right.parts).collect() }
}

/// Moves what is left to the front and tells how many that are; neither side is empty.
fn divide(boxes: &(impl Boxes + ?Sized), scale: f32, list: &mut [u32], centers: &Bounds) -> usize {
    let bin = Bin::over(centers);
    let mut bins = [[(0usize, Bounds::EMPTY); BINS]; 3];
    for &item in &*list {
        let one = boxes.get(item);
        for (axis, number) in bin.of(center(&one)).into_iter().enumerate() {
            let (count, bounds) = &mut bins[axis][number];
            *count += 1;
            *bounds = bounds.union(one);
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        let cost = |(count, bounds): &(usize, Bounds)| {
            if *count == 0 { 0.0 } else { *count as f32 * scaled_area(bounds, scale) }
        };
        let join = |sum: &mut (usize, Bounds), bin: &(usize, Bounds)| {
            *sum = (sum.0 + bin.0, sum.1.union(bin.1));
            Some(*sum)
        };
        let nothing = (0, Bounds::EMPTY);
        let right: Vec<_> = bins.iter().rev().scan(nothing, join).collect();
        for (number, left) in bins.iter().scan(nothing, join).enumerate().take(BINS - 1) {
            let right = &right[BINS - 2 - number];
            let both = cost(&left) + cost(right);
            if left.0 > 0 && right.0 > 0 && both < best.0 {
                best = (both, axis, number);
            }
        }
    }
    let (cost, axis, last) = best;
    if cost == f32::INFINITY {
        // All in one place.
        return list.len() / 2;
    }
    let mut left = 0;
    for at in 0..list.len() {
        if bin.of(center(&boxes.get(list[at])))[axis] <= last {
            list.swap(left, at);
            left += 1;
        }
    }
    left
}

fn center(bounds: &Bounds) -> Vec3 {
    bounds.min * 0.5 + bounds.max * 0.5
}

fn scaled_area(bounds: &Bounds, scale: f32) -> f32 {
    Bounds { min: bounds.min * scale, max: bounds.max * scale }.area()
}

/// In which bin a centre is.
struct Bin {
    min: Vec3,
    per_length: Vec3,
}

impl Bin {
    fn over(centers: &Bounds) -> Self {
        let per = |length: f32| if length > 0.0 { BINS as f32 / length } else { 0.0 };
        let per_length = Vec3::from_array(centers.extent().to_array().map(per));
        // Where there is no length to speak of, all are in the first.
        let per_length = Vec3::select(per_length.cmplt(Vec3::INFINITY), per_length, Vec3::ZERO);
        Self { min: centers.min, per_length }
    }

    fn of(&self, center: Vec3) -> [usize; 3] {
        ((center - self.min) * self.per_length).to_array().map(|place| (place as usize).min(BINS - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid_testkit::Pcg32;

    fn boxes(count: usize, spread: f32) -> Vec<Bounds> {
        let mut rng = Pcg32::new(3);
        let mut corner = || {
            let ([x, y], [z, w]) = (rng.vec2_f32(), rng.vec2_f32());
            let min = Vec3::new(x, y, z) * spread;
            Bounds { min, max: min + Vec3::splat(0.01 * w) }
        };
        (0..count).map(|_| corner()).collect()
    }

    #[test]
    fn every_item_is_in_one_part() {
        for spread in [1.0, 1e-30, 0.0] {
            let boxes = boxes(5000, spread);
            let mut items: Vec<u32> = (0..5000).collect();
            let parted = part(&boxes[..], 1.0, &mut items, 100);
            assert!(parted.parts.iter().all(|part| !part.is_empty() && part.len() <= 100));
            assert!(parted.parts.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert_eq!((parted.parts[0].start, parted.parts[parted.parts.len() - 1].end), (0, 5000));
            let inner = parted.areas.iter().flatten().count();
            assert_eq!((inner + 1, parted.areas.len()), (parted.parts.len(), 2 * parted.parts.len() - 1));
            items.sort_unstable();
            assert!(items.into_iter().eq(0..5000));
        }
    }

    #[test]
    fn the_tree_over_parts_is_never_deep() {
        // Without any area all splits cost the same, and the first bin has but one item each time.
        let on_line = |i: i32| Vec3::X * -(31.0f32 / 32.0).powi(i);
        let boxes: Vec<Bounds> = (0..2700).map(|i| Bounds { min: on_line(i), max: on_line(i) }).collect();
        let mut items: Vec<u32> = (0..2700).collect();
        let parted = part(&boxes[..], 1.0, &mut items, 100);
        // Nodes that are still to come, by their depth.
        let mut waiting = vec![0];
        let mut deepest = 0;
        for area in &parted.areas {
            let depth = waiting.pop().unwrap();
            deepest = deepest.max(depth);
            if area.is_some() {
                waiting.extend([depth + 1; 2]);
            }
        }
        // What is left by then is halved five times.
        assert!(waiting.is_empty() && (60..=LEVELS + 5).contains(&deepest), "{deepest}");
    }

    #[test]
    fn parts_are_compact() {
        let boxes = boxes(5000, 1.0);
        let mut items: Vec<u32> = (0..5000).collect();
        let parted = part(&boxes[..], 1.0, &mut items, 100);
        let area = |own: &Range<usize>| {
            let all = items[own.clone()].iter().fold(Bounds::EMPTY, |all, &i| all.union(boxes[i as usize]));
            f64::from(all.area())
        };
        // Random parts would be as large as the whole, with an area of six.
        let mean = parted.parts.iter().map(area).sum::<f64>() / parted.parts.len() as f64;
        assert!(mean < 0.6, "{mean}");
    }
}
