//! Photons with the history of their paths, which the maps of a render do without.

use std::fmt;

use super::photon_pass::{Extras, photon_pass_with};
use super::plan::PhotonPlan;
use super::walk::{Event, WalkSettings};
use crate::observer::Observer;
use crate::photon_map::Photon;
use crate::world::World;

/// The bounces of a photon's path before it landed.
///
/// Displayed in the notation of Heckbert (1990, *Adaptive Radiosity Textures…*): `L` for the light, `S` for a
/// Dirac bounce, `V` for a collision in a medium, `D` for any other, the landing included: `LSSD` is light that went
/// through a glass ball.
/// Of very long paths the middle is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bounces {
    count: u32,
    /// Bit i: whether bounce i, from 0, was a Dirac one.
    dirac: u64,
    /// Bit i: whether bounce i was a collision.
    medium: u64,
}

impl Bounces {
    /// How many there were: 0 for light that comes straight.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Adds the bounce at the last event, of letter `last` and after so many segments, and those between it
    /// and the next, which are Dirac.
    fn reach(&mut self, last: char, after: u32, depth: u32) {
        if after > 0 {
            self.push(last);
        }
        for _ in after + 1..depth {
            self.push('S');
        }
    }

    fn push(&mut self, letter: char) {
        if self.count < u64::BITS {
            self.dirac |= u64::from(letter == 'S') << self.count;
            self.medium |= u64::from(letter == 'V') << self.count;
        }
        self.count += 1;
    }
}

impl fmt::Display for Bounces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters =
            (0..self.count.min(u64::BITS)).map(|i| match (self.dirac >> i & 1, self.medium >> i & 1) {
                (1, _) => 'S',
                (_, 1) => 'V',
                _ => 'D',
            });
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
    /// Those of the haze map; none unless asked for.
    pub haze: Vec<RecordedPhoton>,
    /// Paths emitted for the global map.
    pub global_paths: u64,
    /// Paths emitted for the caustic and the afterglow map.
    pub caustic_paths: u64,
}

/// What a path has met up to its last event.
#[derive(Default)]
struct Trail {
    depth: u32,
    letter: char,
    bounces: Bounces,
}

impl Trail {
    fn advance(&mut self, letter: char, depth: u32) {
        self.bounces.reach(self.letter, self.depth, depth);
        (self.letter, self.depth) = (letter, depth);
    }
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
    // The walk shows every event, stored or not.
    let record = |trail: &mut Trail, path, event| match event {
        Event::Surface(photon) => {
            trail.advance('D', u32::from(photon.depth));
            Some(RecordedPhoton { photon, path, bounces: trail.bounces })
        }
        Event::Collision(photon) => {
            trail.advance('V', u32::from(photon.depth));
            None
        }
        Event::Way(_) => None,
    };
    let pass = photon_pass_with(world, settings, plan, extras, seed, iteration, observer, record)?;
    Some(RecordedPass {
        global: pass.global,
        caustic: pass.caustic,
        afterglow: pass.afterglow,
        haze: pass.haze,
        global_paths: plan.global.paths,
        caustic_paths: plan.caustic.paths,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_events(events: &[(char, u32)]) -> Bounces {
        let mut trail = Trail::default();
        for &(letter, depth) in events {
            trail.advance(letter, depth);
        }
        trail.bounces
    }

    #[test]
    fn bounces_follow_from_the_depths_of_events() {
        for (events, path) in [
            (&[('D', 1)][..], "LD"),
            (&[('D', 3)], "LSSD"),
            (&[('D', 1), ('D', 2)], "LDD"),
            (&[('D', 3), ('D', 4)], "LSSDD"),
            (&[('D', 1), ('D', 3), ('D', 6)], "LDSDSSD"),
            (&[('V', 1), ('D', 2)], "LVD"),
            (&[('V', 2), ('V', 3), ('D', 5)], "LSVVSD"),
        ] {
            let bounces = of_events(events);
            assert_eq!(bounces.to_string(), path);
            assert_eq!(bounces.count() as usize, path.len() - 2, "{path}");
        }
        let long = of_events(&(1..100).map(|depth| ('D', depth)).collect::<Vec<_>>());
        assert_eq!((long.count(), long.to_string().chars().count()), (98, 67));
    }
}
