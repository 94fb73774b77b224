use std::ops::Range;

/// Which samples a film holds: ranges of sample numbers in order, half open, with gaps between them.
///
/// The number of a sample is its pass times the samples of a pass, plus its number within the pass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Covered {
    ranges: Vec<Range<u64>>,
}

/// Samples that two films both hold: the first range of them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("samples {} to {} are in both", .0.start, .0.end - 1)]
pub struct Overlap(pub Range<u64>);

impl Covered {
    /// No samples.
    pub fn new() -> Self {
        Self::default()
    }

    /// The samples of one range, of none if it is empty.
    pub fn from_range(range: Range<u64>) -> Self {
        Self { ranges: if range.is_empty() { Vec::new() } else { vec![range] } }
    }

    /// Ranges as [`Covered::ranges`] gives them; `None` if they are empty, touch or are out of order.
    pub fn from_ranges(ranges: Vec<Range<u64>>) -> Option<Self> {
        let in_order = ranges.windows(2).all(|pair| pair[0].end < pair[1].start);
        (in_order && ranges.iter().all(|r| !r.is_empty())).then_some(Self { ranges })
    }

    /// The samples of both, if no sample is in both.
    pub fn join(&self, other: &Self) -> Result<Self, Overlap> {
        let mut all: Vec<Range<u64>> = self.ranges.iter().chain(&other.ranges).cloned().collect();
        all.sort_unstable_by_key(|range| range.start);
        let mut ranges: Vec<Range<u64>> = Vec::with_capacity(all.len());
        for range in all {
            match ranges.last_mut() {
                Some(last) if range.start < last.end => {
                    return Err(Overlap(range.start..range.end.min(last.end)));
                }
                Some(last) if range.start == last.end => last.end = range.end,
                _ => ranges.push(range),
            }
        }
        Ok(Self { ranges })
    }

    /// What is missing between 0 and the end.
    pub fn gaps(&self) -> Vec<Range<u64>> {
        let starts = std::iter::once(0).chain(self.ranges.iter().map(|range| range.end));
        let gaps = starts.zip(&self.ranges).map(|(start, next)| start..next.start);
        gaps.filter(|gap| !gap.is_empty()).collect()
    }

    /// How many samples.
    pub fn total(&self) -> u64 {
        self.ranges.iter().map(|range| range.end - range.start).sum()
    }

    /// One more than the last sample's number; 0 if there is none.
    pub fn end(&self) -> u64 {
        self.ranges.last().map_or(0, |range| range.end)
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// The ranges in order; no two of them touch.
    pub fn ranges(&self) -> &[Range<u64>] {
        &self.ranges
    }
}

impl<'c> IntoIterator for &'c Covered {
    type Item = &'c Range<u64>;
    type IntoIter = std::slice::Iter<'c, Range<u64>>;

    fn into_iter(self) -> Self::IntoIter {
        self.ranges.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(pairs: &[[u64; 2]]) -> Option<Covered> {
        Covered::from_ranges(pairs.iter().map(|&[start, end]| start..end).collect())
    }

    fn covered(pairs: &[[u64; 2]]) -> Covered {
        ranges(pairs).expect("ranges in order")
    }

    #[test]
    fn neighbours_become_one_range() {
        let joined = covered(&[[0, 4], [12, 16]]).join(&covered(&[[4, 8], [20, 24]])).expect("no overlap");
        assert_eq!(joined, covered(&[[0, 8], [12, 16], [20, 24]]));
        assert_eq!((joined.total(), joined.end()), (16, 24));
        let whole = joined.join(&covered(&[[8, 12], [16, 20]])).expect("no overlap");
        assert_eq!(whole, Covered::from_range(0..24));
        assert_eq!(whole.into_iter().count(), 1);
    }

    #[test]
    fn the_order_of_joining_does_not_matter() {
        let pieces = [0..4, 4..6, 9..10, 6..9, 30..40].map(Covered::from_range);
        let join = |order: [usize; 5]| {
            order.iter().try_fold(Covered::new(), |sum, &i| sum.join(&pieces[i])).expect("no overlap")
        };
        assert_eq!(join([0, 1, 2, 3, 4]), join([4, 2, 0, 3, 1]));
        assert_eq!(join([3, 4, 1, 2, 0]), covered(&[[0, 10], [30, 40]]));
    }

    #[test]
    fn gaps_begin_at_the_first_sample() {
        assert_eq!(covered(&[[4, 8], [12, 16]]).gaps(), [0..4, 8..12]);
        assert!(Covered::from_range(0..7).gaps().is_empty());
        assert!(Covered::new().gaps().is_empty());
        assert_eq!(Covered::new().end(), 0);
    }

    #[test]
    fn overlaps_are_found_wherever_they_are() {
        let overlap = |a: &[[u64; 2]], b: &[[u64; 2]]| {
            let found = covered(a).join(&covered(b)).expect_err("an overlap");
            assert_eq!(covered(b).join(&covered(a)), Err(found.clone()));
            found.0
        };
        assert_eq!(overlap(&[[0, 8]], &[[7, 9]]), 7..8);
        assert_eq!(overlap(&[[0, 80]], &[[10, 12], [20, 30]]), 10..12);
        assert_eq!(overlap(&[[0, 1], [5, 9]], &[[5, 9]]), 5..9);
        assert_eq!(Overlap(16..32).to_string(), "samples 16 to 31 are in both");
    }

    #[test]
    fn only_ranges_in_order_are_taken() {
        for bad in [&[[3, 3]][..], &[[0, 4], [4, 8]], &[[8, 9], [0, 1]], &[[5, 2]]] {
            assert_eq!(ranges(bad), None);
        }
        assert_eq!(Covered::from_range(5..5), Covered::new());
    }
}
