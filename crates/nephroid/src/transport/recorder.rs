//! Photons with the history of their paths, which the maps of a render do without.

use std::fmt;

use super::photon_pass::{Extras, PhotonPlan, photon_pass_with};
use super::walk::WalkSettings;
use crate::observer::Observer;
use crate::photon_map::Photon;
use crate::world::World;

/// The bounces of a photon's path before it landed.
///
/// Displayed in the notation of Heckbert (1990, *Adaptive Radiosity Textures…*): `L` for the light, `S` for a
/// Dirac bounce, `D` for any other, the landing included: `LSSD` is light that went through a glass ball.
/// Of very long paths the middle is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bounces {
    count: u32,
    /// Bit i: whether bounce i, from 0, was a Dirac one.
    dirac: u64,
}

impl Bounces {
    /// How many there were: 0 for light that comes straight.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Adds a landing that comes after so many segments; what lies between it and the last is Dirac.
    fn land(&mut self, last: u32, depth: u32) {
        if last > 0 {
            self.push(false);
        }
        for _ in last + 1..depth {
            self.push(true);
        }
    }

    fn push(&mut self, dirac: bool) {
        if self.count < u64::BITS {
            self.dirac |= u64::from(dirac) << self.count;
        }
        self.count += 1;
    }
}

impl fmt::Display for Bounces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters =
            (0..self.count.min(u64::BITS)).map(|i| if self.dirac >> i & 1 == 1 { 'S' } else { 'D' });
        let path: String = letters.collect();
        let rest = if self.count > u64::BITS { "…" } else { "" };
        write!(f, "L{path}{rest}D")
    }
}

/// A photon that a map would hold, and how it came there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedPhoton {
    /// As it was stored: with the power of its path alone, not yet divided by the paths emitted.
    pub photon: Photon,
    /// The number of its path among those emitted for its map.
    pub path: u64,
    /// What its path met before.
    pub bounces: Bounces,
}

/// The photons of one iteration, each list in the order in which [`photon_pass`](super::photon_pass) has it.
#[derive(Clone, Debug)]
pub struct RecordedPass {
    /// Those of the global map.
    pub global: Vec<RecordedPhoton>,
    /// Those of the caustic map.
    pub caustic: Vec<RecordedPhoton>,
    /// Those of the afterglow map; none unless asked for.
    pub afterglow: Vec<RecordedPhoton>,
    /// Paths emitted for the global map.
    pub global_paths: u64,
    /// Paths emitted for the caustic and the afterglow map.
    pub caustic_paths: u64,
}

/// What a path has met up to its last landing.
#[derive(Default)]
struct Trail {
    depth: u32,
    bounces: Bounces,
}

/// Emits the same paths as [`photon_pass`](super::photon_pass), since all that is random in them is keyed, and keeps what is
/// known of each photon. `None` if the observer cancelled.
pub fn record_photon_pass(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    extras: Extras,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<RecordedPass> {
    let record = |trail: &mut Trail, path, photon: Photon| {
        // The walk shows every landing, stored or not.
        let depth = u32::from(photon.depth);
        trail.bounces.land(trail.depth, depth);
        trail.depth = depth;
        RecordedPhoton { photon, path, bounces: trail.bounces }
    };
    let pass = photon_pass_with(world, settings, plan, extras, seed, iteration, observer, record)?;
    Some(RecordedPass {
        global: pass.global,
        caustic: pass.caustic,
        afterglow: pass.afterglow,
        global_paths: plan.global.paths,
        caustic_paths: plan.caustic.paths,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_landings(depths: &[u32]) -> Bounces {
        let mut bounces = Bounces::default();
        let mut last = 0;
        for &depth in depths {
            bounces.land(last, depth);
            last = depth;
        }
        bounces
    }

    #[test]
    fn bounces_follow_from_the_depths_of_landings() {
        for (depths, path) in
            [(&[1][..], "LD"), (&[3], "LSSD"), (&[1, 2], "LDD"), (&[3, 4], "LSSDD"), (&[1, 3, 6], "LDSDSSD")]
        {
            let bounces = of_landings(depths);
            assert_eq!(bounces.to_string(), path);
            assert_eq!(bounces.count() as usize, path.len() - 2, "{path}");
        }
        let long = of_landings(&(1..100).collect::<Vec<_>>());
        assert_eq!((long.count(), long.to_string().chars().count()), (98, 67));
    }
}
