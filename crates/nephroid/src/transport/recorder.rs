//! Photons with the history of their paths, which the maps of a render do without.

use std::fmt;

use super::photon_pass::{Extras, photon_pass_with, volume_pass_with};
use super::plan::{PhotonPlan, PhotonTargets, VolumeKind};
use super::walk::{Event, WalkSettings};
use crate::observer::Observer;
use crate::photon_map::{Photon, VolumePhoton};
use crate::world::World;

/// The bounces of a photon's path before it landed.
///
/// Displayed in the notation of Heckbert (1990, *Adaptive Radiosity Textures…*): `L` for the light, `S` for a
/// bounce by a Dirac lobe or one nearly as narrow, `V` for a collision in a medium, `D` for any other, the landing included: `LSSD` is light that went
/// through a glass ball, and `LSSV` the same where a medium scatters it.
/// Of very long paths the middle is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bounces {
    count: u32,
    /// Bit i: whether bounce i, from 0, was a Dirac one.
    dirac: u64,
    /// Bit i: whether bounce i was a collision.
    medium: u64,
    /// Whether it landed in a medium, and not on a surface.
    ends_in_medium: bool,
}

impl Bounces {
    /// How many there were: 0 for light that comes straight.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether the photon lies in a medium, and not on a surface.
    pub fn ends_in_medium(&self) -> bool {
        self.ends_in_medium
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
        let landing = if self.ends_in_medium { 'V' } else { 'D' };
        write!(f, "L{path}{rest}{landing}")
    }
}

/// A photon that a map would hold, and how it came there. On surfaces it is a [`Photon`], in media a
/// [`VolumePhoton`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedPhoton<P = Photon> {
    /// As it was stored: with the power of its path alone, not yet divided by the paths emitted.
    pub photon: P,
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

/// The photons of one iteration in media, each list in the order in which [`volume_pass`](super::volume_pass) has it.
#[derive(Clone, Debug)]
pub struct RecordedVolumePass {
    /// Those of all light but caustics.
    pub volume: Vec<RecordedPhoton<VolumePhoton>>,
    /// Those of caustics.
    pub volume_caustic: Vec<RecordedPhoton<VolumePhoton>>,
    /// Paths emitted for the former.
    pub volume_paths: u64,
    /// Paths emitted for the latter.
    pub volume_caustic_paths: u64,
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

    /// Follows an event; a photon on a surface or in a medium lands there.
    fn follow(&mut self, event: &Event<'_>) {
        match event {
            Event::Surface(..) => self.meet(Some('D')),
            Event::Collision(..) => self.meet(Some('V')),
            Event::Bounce(lit, bounce) if bounce.specular => {
                // Where it landed just now it has gone on by a specular lobe.
                if lit.has_density() {
                    self.last = None;
                } else {
                    self.meet(None);
                }
                self.bounces.push('S');
            }
            Event::Start(_) | Event::Way(_) | Event::Bounce(..) => {}
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
    let record = |trail: &mut Trail, path, event: Event<'_>| {
        trail.follow(&event);
        let Event::Surface(photon, _) = event else { return None };
        Some(RecordedPhoton { photon, path, bounces: trail.bounces })
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

/// Emits the same paths as [`volume_pass`](super::volume_pass) does for points, and keeps what is known of each
/// photon. Of beams nothing is recorded. `None` if the observer cancelled.
pub fn record_volume_pass(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    targets: &PhotonTargets,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<RecordedVolumePass> {
    if targets.volume_kind == VolumeKind::Beams {
        let (volume, volume_caustic) = (Vec::new(), Vec::new());
        let nothing = RecordedVolumePass { volume, volume_caustic, volume_paths: 0, volume_caustic_paths: 0 };
        return Some(nothing);
    }
    let record = |trail: &mut Trail, path, event: Event<'_>| {
        trail.follow(&event);
        let Event::Collision(photon, _) = event else { return None };
        let bounces = Bounces { ends_in_medium: true, ..trail.bounces };
        Some(RecordedPhoton { photon, path, bounces })
    };
    let lists = volume_pass_with(world, settings, plan, targets, seed, iteration, observer, record)?;
    let [volume, volume_caustic] = lists;
    let (volume_paths, volume_caustic_paths) = (plan.volume.paths, plan.volume_caustic.paths);
    Some(RecordedVolumePass { volume, volume_caustic, volume_paths, volume_caustic_paths })
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
        let collided = Bounces { ends_in_medium: true, ..of_events("SSV") };
        assert_eq!(collided.to_string(), "LSSV");
        let long = of_events(&"D".repeat(99));
        assert_eq!((long.count(), long.to_string().chars().count()), (98, 67));
    }
}
