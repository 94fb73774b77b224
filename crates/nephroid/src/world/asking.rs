//! Which light next event estimation asks: of a few lights by a table, the same everywhere; of many by a tree that knows
//! where they are and where they shine.

use super::World;
use crate::light::{Asker, Emitter, LightTree, Lookup};
use crate::sampling::Discrete;

/// As many lights that are not infinitely far away are worth a tree.
const WORTH_A_TREE: usize = 24;

/// How lights are asked.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked {
    /// Lights by a share that is the same everywhere; `None` if there are none.
    table: Option<Discrete>,
    /// How points ask if lights are many.
    tree: Option<Apart>,
}

/// Lights infinitely far away on their own, and all others as one outcome of a table, which a tree takes apart.
#[derive(Clone, Debug)]
struct Apart {
    /// The lights infinitely far away, and then the tree.
    table: Discrete,
    distant: Vec<u32>,
    tree: LightTree,
}

impl Asked {
    pub fn new(emitters: &[Emitter], lookup: Lookup<'_>) -> Self {
        let powers: Vec<f64> = emitters.iter().map(|e| f64::from(e.power.mean())).collect();
        Self { table: shares(&powers), tree: Apart::new(emitters, lookup) }
    }
}

impl Apart {
    /// `None` if a table will do.
    fn new(emitters: &[Emitter], lookup: Lookup<'_>) -> Option<Self> {
        let lit = || (0..).zip(emitters).filter(|(_, emitter)| emitter.power.mean() > 0.0);
        let lamps: Vec<_> = lit().filter_map(|(i, emitter)| Some((i, emitter.extent(lookup)?))).collect();
        if lamps.len() < WORTH_A_TREE {
            return None;
        }
        let distant: Vec<u32> = lit().filter(|(_, e)| e.is_infinite()).map(|(i, _)| i).collect();
        let power = |i: &u32| f64::from(emitters[*i as usize].power.mean());
        let together: f64 = lamps.iter().map(|(i, _)| power(i)).sum();
        let powers: Vec<f64> = distant.iter().map(power).chain([together]).collect();
        Some(Self { table: shares(&powers)?, distant, tree: LightTree::new(lamps)? })
    }

    fn sample(&self, from: &Asker, u: f32) -> (usize, f32) {
        let (outcome, probability, rest) = self.table.sample(u);
        match self.distant.get(outcome) {
            Some(light) => (*light as usize, probability),
            None => {
                let (light, share) = self.tree.sample(from, rest);
                (light, probability * share)
            }
        }
    }

    fn pmf(&self, light: usize, from: &Asker) -> f32 {
        match self.distant.iter().position(|distant| *distant as usize == light) {
            Some(outcome) => self.table.pmf(outcome),
            None => self.table.pmf(self.distant.len()) * self.tree.pmf(light, from),
        }
    }
}

/// Half by power, half evenly among the lights that have any. A sky's power is what reaches the bounds
/// of the scene, of which one place may see little, and power alone would all but never ask the lamp
/// beside it.
fn shares(powers: &[f64]) -> Option<Discrete> {
    let (total, lit) = (powers.iter().sum::<f64>(), powers.iter().filter(|p| **p > 0.0).count() as f64);
    Discrete::new(powers.iter().map(|&p| if p > 0.0 { 0.5 * p / total + 0.5 / lit } else { 0.0 }))
}

impl World {
    /// Whether there is any light that can be asked.
    pub(crate) fn has_lights_to_ask(&self) -> bool {
        self.asked.table.is_some()
    }

    /// The light that a point asks, and with which probability; `None` if there are none.
    pub(crate) fn ask(&self, from: &Asker, u: f32) -> Option<(usize, f32)> {
        if let Some(apart) = &self.asked.tree {
            return Some(apart.sample(from, u));
        }
        let (light, probability, _) = self.asked.table.as_ref()?.sample(u);
        Some((light, probability))
    }

    /// The probability with which a point asks a light.
    pub(crate) fn chance_of_asking(&self, light: usize, from: &Asker) -> f32 {
        match (&self.asked.tree, &self.asked.table) {
            (Some(apart), _) => apart.pmf(light, from),
            (None, Some(table)) => table.pmf(light),
            (None, None) => 0.0,
        }
    }

    /// A light that a way through a medium asks of which this is a point, and with which probability. Half of the time it is
    /// one of the table's, for what does not light the point may light others of the way.
    pub(crate) fn ask_along(&self, point: impl FnOnce() -> Asker, u: f32) -> Option<(usize, f32)> {
        let table = self.asked.table.as_ref()?;
        let Some(apart) = &self.asked.tree else {
            let (light, probability, _) = table.sample(u);
            return Some((light, probability));
        };
        let from = point();
        let light = if u < 0.5 { table.sample(2.0 * u).0 } else { apart.sample(&from, 2.0 * u - 1.0).0 };
        Some((light, 0.5 * (table.pmf(light) + apart.pmf(light, &from))))
    }
}
