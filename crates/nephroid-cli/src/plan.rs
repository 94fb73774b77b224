//! How a render is cut into passes, and when it is done.

use serde_json::{Value, json};

use crate::args::LimitArgs;
use crate::exit::Failure;
use crate::session_args::PassRange;

/// Samples of a pixel where neither the scene nor the command line says.
const SAMPLES_PER_PIXEL: u32 = 16;

/// How much to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Camera samples of each pixel in a pass, where the integrator does not decide that itself.
    pub samples_per_pass: u32,
    /// Camera samples of each pixel after which to stop.
    pub samples: Option<u64>,
    /// Passes after which to stop.
    pub passes: Option<u64>,
    /// Seconds after which to stop.
    pub seconds: Option<f64>,
    /// The error that is small enough, as a part of one.
    pub target_error: Option<f64>,
    /// The passes to render, if not all of them.
    pub range: Option<PassRange>,
}

/// How far a render is that is gone on with.
#[derive(Clone, Copy, Debug, Default)]
pub struct Done {
    /// Samples of each pixel in a pass.
    pub samples_per_pass: u32,
    /// The number of its next sample of each pixel.
    pub samples: u64,
    /// What its error is less than, if it can tell.
    pub error: Option<f64>,
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
        let unlimited = limits.passes.is_none() && limits.time.is_none() && limits.target_error.is_none();
        let samples = limits.spp.or(unlimited.then_some(of_scene));
        Self {
            samples_per_pass,
            samples: samples.map(u64::from),
            passes: limits.passes,
            seconds: limits.time,
            target_error: limits.target_error,
            range: None,
        }
    }

    /// A part of it, which `--passes` and `--spp` then describe the whole of. Where the samples of the whole would cut passes
    /// off, parts by passes would not add up to it: a `progressive` render decides itself how many samples a pass has.
    pub fn part(
        self,
        limits: &LimitArgs,
        range: Option<PassRange>,
        progressive: bool,
    ) -> Result<Self, Failure> {
        let Some(range) = range else { return Ok(self) };
        let refuse = |message: String| Err(Failure::Usage(format!("--pass-range: {message}")));
        if limits.target_error.is_some() {
            return refuse(
                "a part of a render does not know the error of the whole: leave out --target-error"
                    .to_owned(),
            );
        }
        match (limits.spp, limits.passes) {
            (Some(_), _) if progressive => refuse(
                "the integrator plans how many samples a pass has: give --passes, without --spp".to_owned(),
            ),
            (Some(_), None) => {
                refuse("with --spp, say with --passes how many passes share the samples".to_owned())
            }
            (Some(spp), Some(passes)) if u64::from(spp) < passes => refuse(format!(
                "--spp {spp} is too little for --passes {passes}, of which each has a sample or more: give fewer --passes"
            )),
            (_, Some(passes)) if range.end > passes => {
                refuse(format!("the whole render has --passes {passes}, numbered from 0"))
            }
            // The scene's sample_count is how many samples a pass has, and no limit.
            _ => Ok(Self { samples: limits.spp.map(u64::from), range: Some(range), ..self }),
        }
    }

    /// Goes on with what was interrupted after `spent` seconds: with other limits where they are given. Those of counts
    /// replace all others; time counts anew, and with another error that of before counts no more. Where what was
    /// [`Done`] is all there was to do, time or an error alone mean more than that.
    pub fn resumed(self, limits: &LimitArgs, spent: f64, done: &Done) -> Result<Self, Failure> {
        let counts = limits.spp.is_some() || limits.passes.is_some();
        if let (true, Some(range)) = (counts || limits.target_error.is_some(), self.range) {
            return Err(Failure::Usage(format!(
                "this is a part of a render, passes {} to {}: --passes, --spp and --target-error cannot change that",
                range.begin,
                range.end - 1
            )));
        }
        let mut plan = self;
        if counts {
            (plan.samples, plan.passes) = (limits.spp.map(u64::from), limits.passes);
            (plan.seconds, plan.target_error) = (None, None);
        }
        let further = limits.time.is_some() || limits.target_error.is_some();
        if further && !counts {
            plan.seconds = None;
            if plan.range.is_none() && plan.end(done.samples_per_pass).is_some_and(|end| done.samples >= end)
            {
                (plan.samples, plan.passes) = (None, None);
            }
            if let (Some(target), Some(error)) = (plan.target_error, done.error)
                && error <= target
            {
                plan.target_error = None;
            }
        }
        plan.seconds = limits.time.map(|seconds| spent + seconds).or(plan.seconds);
        plan.target_error = limits.target_error.or(plan.target_error);
        Ok(plan)
    }

    /// The whole that it is a part of, or what is there of it if nobody said how much that is.
    pub fn whole(self, passes: u64) -> Self {
        let passes = self.passes.or(self.samples.is_none().then_some(passes));
        Self { passes, seconds: None, range: None, ..self }
    }

    /// The number of the first sample of each pixel, where a pass has so many.
    pub fn first_sample(&self, per_pass: u32) -> u64 {
        self.range.map_or(0, |range| range.begin.saturating_mul(u64::from(per_pass)))
    }

    /// The number of the sample before which it is done, if that is known beforehand.
    pub fn end(&self, per_pass: u32) -> Option<u64> {
        let passes = self.range.map(|range| range.end).or(self.passes);
        let by_passes = passes.map(|n| n.saturating_mul(u64::from(per_pass)));
        match (self.samples.filter(|_| self.range.is_none()), by_passes) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        }
    }

    /// One object.
    pub fn to_json(self) -> Value {
        json!({
            "samples_per_pass": self.samples_per_pass,
            "samples_per_pixel": self.samples,
            "passes": self.passes,
            "seconds": self.seconds,
            "target_error": self.target_error,
            "pass_range": self.range.map(|range| [range.begin, range.end]),
        })
    }

    /// The plan of an object; none if it is not one.
    pub fn from_json(value: &Value) -> Option<Self> {
        let count = |name: &str| match &value[name] {
            Value::Null => Some(None),
            number => number.as_u64().map(Some),
        };
        let positive = |name: &str| match &value[name] {
            Value::Null => Some(None),
            number => Some(Some(number.as_f64().filter(|s| (0.0..1e12).contains(s))?)),
        };
        Some(Self {
            samples_per_pass: u32::try_from(value["samples_per_pass"].as_u64()?).ok()?,
            samples: count("samples_per_pixel")?,
            passes: count("passes")?,
            seconds: positive("seconds")?,
            target_error: positive("target_error")?,
            range: match &value["pass_range"] {
                Value::Null => None,
                range => {
                    let (begin, end) = (range[0].as_u64()?, range[1].as_u64()?);
                    (begin < end).then_some(Some(PassRange { begin, end }))?
                }
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(spp: Option<u32>, passes: Option<u64>, time: Option<f64>) -> (u32, Option<u64>) {
        let plan = Plan::new(&LimitArgs { spp, passes, time, ..LimitArgs::default() }, Some(16));
        (plan.samples_per_pass, plan.end(plan.samples_per_pass))
    }

    #[test]
    fn an_explicit_limit_switches_off_the_scenes() {
        assert_eq!(plan(None, None, None), (16, Some(16)));
        assert_eq!(plan(Some(3), None, None), (3, Some(3)));
        assert_eq!(plan(None, Some(5), None), (16, Some(80)));
        assert_eq!(plan(None, None, Some(1.0)), (16, None));
        assert_eq!(plan(Some(40), None, Some(1.0)), (40, Some(40)));
        assert_eq!(Plan::new(&LimitArgs::default(), None).end(16), Some(16));
    }

    #[test]
    fn passes_share_the_samples() {
        assert_eq!(plan(Some(16), Some(4), None), (4, Some(16)));
        assert_eq!(plan(Some(17), Some(4), None), (4, Some(16)));
        assert_eq!(plan(Some(2), Some(4), None), (1, Some(2)));
    }

    #[test]
    fn a_part_is_one_of_the_whole() {
        let part_of = |progressive: bool, spp, passes, range: (u64, u64)| {
            let limits = LimitArgs { spp, passes, ..LimitArgs::default() };
            let range = Some(PassRange { begin: range.0, end: range.1 });
            Plan::new(&limits, Some(16)).part(&limits, range, progressive).ok().map(|plan| {
                let n = plan.samples_per_pass;
                (n, plan.first_sample(n), plan.end(n))
            })
        };
        let part = |spp, passes, range| part_of(false, spp, passes, range);
        assert_eq!(part(None, None, (3, 5)), Some((16, 48, Some(80))));
        assert_eq!(part(Some(64), Some(8), (7, 8)), Some((8, 56, Some(64))));
        assert_eq!(part(None, Some(8), (7, 9)), None);
        assert_eq!(part(Some(64), None, (0, 1)), None);
        // Of two samples, four passes would have two; and each part one.
        assert_eq!(part(Some(2), Some(4), (0, 1)), None);
        assert_eq!(part(Some(17), Some(4), (3, 4)), Some((4, 12, Some(16))));
        assert_eq!(part_of(true, Some(8), Some(8), (0, 1)), None);
        assert_eq!(part_of(true, None, Some(8), (0, 1)), Some((16, 0, Some(16))));
        let plan = Plan::new(&LimitArgs::default(), Some(16));
        let range = Some(PassRange { begin: 3, end: 5 });
        let whole = plan.part(&LimitArgs::default(), range, false).unwrap().whole(7);
        assert_eq!((whole.first_sample(16), whole.end(16)), (0, Some(112)));
        let limits = LimitArgs { passes: Some(9), ..LimitArgs::default() };
        let whole = Plan::new(&limits, Some(16)).part(&limits, range, false).unwrap().whole(7);
        assert_eq!(whole.end(16), Some(144));
    }

    #[test]
    fn new_limits_replace_old_ones() {
        let limits = |spp, passes, time| LimitArgs { spp, passes, time, target_error: None };
        let old = Plan::new(&limits(None, Some(4), Some(10.0)), Some(16));
        let done = |samples| Done { samples_per_pass: 16, samples, error: None };
        let resumed = |spp, passes, time| {
            let plan = old.resumed(&limits(spp, passes, time), 7.0, &done(40)).unwrap();
            (plan.samples, plan.passes, plan.seconds)
        };
        assert_eq!(resumed(None, None, None), (None, Some(4), Some(10.0)));
        assert_eq!(resumed(None, None, Some(5.0)), (None, Some(4), Some(12.0)));
        assert_eq!(resumed(None, Some(9), None), (None, Some(9), None));
        assert_eq!(resumed(Some(100), None, Some(1.0)), (Some(100), None, Some(8.0)));
        let part = Plan { range: Some(PassRange { begin: 0, end: 2 }), ..old };
        let nine = LimitArgs { passes: Some(9), ..LimitArgs::default() };
        assert!(part.resumed(&nine, 0.0, &done(0)).is_err());
    }

    #[test]
    fn time_alone_goes_beyond_the_end_of_what_is_done() {
        let limits = |passes, time| LimitArgs { passes, time, ..LimitArgs::default() };
        let old = Plan::new(&limits(Some(4), None), Some(16));
        let end = |plan: Plan, done| {
            let plan = plan
                .resumed(
                    &limits(None, Some(5.0)),
                    7.0,
                    &Done { samples_per_pass: 16, samples: done, error: None },
                )
                .unwrap();
            assert_eq!(plan.seconds, Some(12.0));
            plan.end(16)
        };
        assert_eq!((end(old, 63), end(old, 64)), (Some(64), None));
        let part = Plan { range: Some(PassRange { begin: 0, end: 2 }), ..old };
        assert_eq!(end(part, 32), Some(32));
    }

    #[test]
    fn a_smaller_error_takes_as_long_as_it_takes() {
        let limits = |passes, time, target_error| LimitArgs { spp: None, passes, time, target_error };
        let plan = Plan::new(&limits(None, None, Some(0.05)), Some(16));
        assert_eq!((plan.end(16), plan.target_error), (None, Some(0.05)), "the scene's count is no limit");
        let old = Plan::new(&limits(Some(4), Some(10.0), Some(0.05)), Some(16));
        let resumed = |limits: LimitArgs, samples, error| {
            let done = Done { samples_per_pass: 16, samples, error };
            let plan = old.resumed(&limits, 7.0, &done).unwrap();
            (plan.end(16), plan.seconds, plan.target_error)
        };
        assert_eq!(resumed(limits(None, None, None), 40, None), (Some(64), Some(10.0), Some(0.05)));
        assert_eq!(resumed(limits(None, None, Some(0.01)), 40, None), (Some(64), None, Some(0.01)));
        assert_eq!(resumed(limits(None, None, Some(0.01)), 64, None), (None, None, Some(0.01)));
        assert_eq!(resumed(limits(Some(9), None, None), 64, None), (Some(144), None, None));
        // Where the error is small enough already, time means more than that.
        assert_eq!(
            resumed(limits(None, Some(5.0), None), 40, Some(0.06)),
            (Some(64), Some(12.0), Some(0.05))
        );
        assert_eq!(resumed(limits(None, Some(5.0), None), 40, Some(0.04)), (Some(64), Some(12.0), None));
        let all = limits(None, None, Some(0.1));
        let range = Some(PassRange { begin: 0, end: 2 });
        assert!(Plan::new(&all, None).part(&all, range, false).is_err());
    }
}
