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

/// The photons of one iteration, each list in the order in which [`photon_pass`](super::photon_pass()) has it.
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

/// What a path has met.
#[derive(Default)]
struct Trail {
    /// The letter of where it is; a bounce only if the path goes on.
    last: Option<char>,
    bounces: Bounces,
}

impl Trail {
    fn meet(&mut self, letter: Option<char>) {
        if let Some(last) = std::mem::replace(&mut self.last, letter) {
            self.bounces.push(last);
        }
    }
}

/// Emits the same paths as [`photon_pass`](super::photon_pass()), since all that is random in them is keyed, and keeps what is
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
            trail.meet(Some('D'));
            Some(RecordedPhoton { photon, path, bounces: trail.bounces })
        }
        Event::Collision(_) => {
            trail.meet(Some('V'));
            None
        }
        Event::Specular => {
            trail.meet(None);
            trail.bounces.push('S');
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

    fn of_events(events: &str) -> Bounces {
        let mut trail = Trail::default();
        for letter in events.chars() {
            if letter == 'S' {
                trail.meet(None);
                trail.bounces.push('S');
            } else {
                trail.meet(Some(letter));
            }
        }
        trail.bounces
    }

    #[test]
    fn the_last_event_is_no_bounce_yet() {
        for (events, path) in [
            ("D", "LD"),
            ("SSD", "LSSD"),
            ("DD", "LDD"),
            ("VD", "LVD"),
            ("SVVSD", "LSVVSD"),
            ("DSDSSD", "LDSDSSD"),
        ] {
            let bounces = of_events(events);
            assert_eq!(bounces.to_string(), path);
            assert_eq!(bounces.count() as usize, events.len() - 1);
        }
        let long = of_events(&"D".repeat(99));
        assert_eq!((long.count(), long.to_string().chars().count()), (98, 67));
    }
}
