use super::cloud::Cloud;
use super::payload::VolumePayload;
use super::photon::{VolumePhoton, VolumePhotons};
use crate::math::{Bounds, Vec3};
use crate::photon_map::{Blur, PhotonIndex};

/// Photons in media. Never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeMap {
    /// By increasing medium, none of them empty.
    clouds: Vec<Cloud>,
    /// For each cloud the place of its first photon.
    firsts: Vec<u32>,
    len: usize,
    emitted: u64,
}

impl VolumeMap {
    /// Arranges photons and divides their power by the number of paths emitted.
    ///
    /// For rays a photon's power is spread over a ball that holds about `k` photons of its medium, though no
    /// larger than [`Self::default_max_radius`] has it for that medium. Photons near each other share a
    /// radius.
    ///
    /// Positions must be finite. Panics with 2³² photons or more.
    pub fn build(photons: VolumePhotons, k: u32) -> Self {
        Self::build_narrow(photons, k, Blur::WHOLE)
    }

    /// As [`Self::build`], with the balls that rays see narrower: a ray blurs two dimensions.
    pub fn build_narrow(photons: VolumePhotons, k: u32, blur: Blur) -> Self {
        let (all, emitted) = (photons.as_slice(), photons.emitted());
        assert!(u32::try_from(all.len()).is_ok(), "a map holds fewer than 2^32 photons, not {}", all.len());
        let share = (1.0 / emitted.max(1) as f64) as f32;
        let point = |number: u32| -> (Vec3, VolumePayload) {
            let photon = &all[number as usize];
            (photon.position, VolumePayload::new(photon, share, number))
        };
        let (mut clouds, mut firsts, mut first) = (Vec::new(), Vec::new(), 0);
        for (medium, numbers) in by_medium(all) {
            clouds.push(Cloud::build(medium, numbers.len(), |i| point(numbers[i]), k, blur.factor(2)));
            firsts.push(first);
            first += numbers.len() as u32;
        }
        Self { clouds, firsts, len: all.len(), emitted }
    }

    /// How many photons it holds. Nothing is ever divided by this.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Paths emitted to make it, including those that stored nothing.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// The photon at a place below [`Self::len`], with its share of the light's power. Its position is
    /// exact; the rest is kept as [`PhotonMap::photon`](crate::photon_map::PhotonMap::photon) says.
    pub fn photon(&self, place: u32) -> VolumePhoton {
        let number = self.firsts.partition_point(|first| *first <= place) - 1;
        self.clouds[number].photon(place - self.firsts[number])
    }

    /// The smallest box around the positions.
    pub fn bounds(&self) -> Bounds {
        self.clouds.iter().fold(Bounds::EMPTY, |all, cloud| all.union(cloud.index.bounds()))
    }

    /// Bytes of heap memory.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.clouds.as_slice())
            + size_of_val(self.firsts.as_slice())
            + self.clouds.iter().map(Cloud::memory_bytes).sum::<usize>()
    }

    /// A largest radius for searches of the `k` nearest photons that fits maps of any scale: twice the radius
    /// of a ball that holds `k` photons at a medium's mean density, but not more than the ball around all
    /// its photons; the largest of all media. The mean is over the photons, of the volume that each has
    /// for itself, so space without photons does not enter.
    pub fn default_max_radius(&self, k: u32) -> f32 {
        self.clouds.iter().map(|cloud| cloud.radii.default_max_radius(k)).fold(0.0, f32::max)
    }

    /// [`Self::default_max_radius`] of one medium; 0 if it has no photons.
    pub fn default_max_radius_in(&self, medium: u16, k: u32) -> f32 {
        self.cloud(medium).map_or(0.0, |cloud| cloud.radii.default_max_radius(k))
    }

    /// The photons of a medium, if it has any.
    #[inline]
    pub(super) fn cloud(&self, medium: u16) -> Option<&Cloud> {
        let number = self.clouds.binary_search_by_key(&medium, |cloud| cloud.medium).ok()?;
        Some(&self.clouds[number])
    }
}

/// The media that have photons, by their number, and the numbers of the photons in each.
fn by_medium(photons: &[VolumePhoton]) -> Vec<(u16, Vec<u32>)> {
    let mut media: Vec<(u16, Vec<u32>)> = Vec::new();
    for (number, photon) in (0u32..).zip(photons) {
        match media.binary_search_by_key(&photon.medium, |(medium, _)| *medium) {
            Ok(at) => media[at].1.push(number),
            Err(at) => media.insert(at, (photon.medium, vec![number])),
        }
    }
    media
}
