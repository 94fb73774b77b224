//! How a render is cut into passes, and when it is done.

use crate::args::LimitArgs;

/// Samples of a pixel where neither the scene nor the command line says.
const SAMPLES_PER_PIXEL: u32 = 16;

/// How much to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Camera samples of each pixel in a pass.
    pub samples_per_pass: u32,
    /// Camera samples of each pixel after which to stop.
    pub samples: Option<u64>,
    /// Passes after which to stop.
    pub passes: Option<u64>,
    /// Seconds after which to stop.
    pub seconds: Option<f64>,
}

impl Plan {
    /// By the limits of the command line, and by the scene's `sample_count` where there are none.
    ///
    /// A pass takes the samples that the scene asks for, or those of `--spp`; where `--spp` and
    /// `--passes` are both given, they are shared out among the passes.
    pub fn new(limits: &LimitArgs, sample_count: Option<u32>) -> Self {
        let of_scene = sample_count.unwrap_or(SAMPLES_PER_PIXEL).max(1);
        let samples_per_pass = match (limits.spp, limits.passes) {
            (Some(spp), Some(passes)) => (u64::from(spp) / passes.max(1)).max(1) as u32,
            (Some(spp), None) => spp,
            (None, _) => of_scene,
        };
        let unlimited = limits.passes.is_none() && limits.time.is_none();
        let samples = limits.spp.or(unlimited.then_some(of_scene));
        Self {
            samples_per_pass,
            samples: samples.map(u64::from),
            passes: limits.passes,
            seconds: limits.time,
        }
    }

    /// Camera samples of each pixel when all is done, if that is known beforehand.
    pub fn total_samples(&self) -> Option<u64> {
        let by_passes = self.passes.map(|n| n.saturating_mul(u64::from(self.samples_per_pass)));
        match (self.samples, by_passes) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(spp: Option<u32>, passes: Option<u64>, time: Option<f64>) -> (u32, Option<u64>) {
        let plan = Plan::new(&LimitArgs { spp, passes, time }, Some(16));
        (plan.samples_per_pass, plan.total_samples())
    }

    #[test]
    fn an_explicit_limit_switches_off_the_scenes() {
        assert_eq!(plan(None, None, None), (16, Some(16)));
        assert_eq!(plan(Some(3), None, None), (3, Some(3)));
        assert_eq!(plan(None, Some(5), None), (16, Some(80)));
        assert_eq!(plan(None, None, Some(1.0)), (16, None));
        assert_eq!(plan(Some(40), None, Some(1.0)), (40, Some(40)));
        assert_eq!(Plan::new(&LimitArgs::default(), None).total_samples(), Some(16));
    }

    #[test]
    fn passes_share_the_samples() {
        assert_eq!(plan(Some(16), Some(4), None), (4, Some(16)));
        assert_eq!(plan(Some(17), Some(4), None), (4, Some(16)));
        assert_eq!(plan(Some(2), Some(4), None), (1, Some(2)));
    }
}
