//! What a picture states of its own error: when it is asked for, and how it is told.

use nephroid::film::{Pixels, Quality};
use nephroid::integrator::{Choice, Method, Pick};
use nephroid::session::RenderPlan;
use serde_json::{Value, json};

use crate::exit::Failure;

/// So many steps are each looked at …
const EACH: u64 = 16;

/// … and then as many more as one in so many of those before.
const SHARE: u64 = 10;

/// The integrators that can tell their error, for messages.
pub const WHO_TELLS: &str = "auto, ppm, vcm, path, volpath or ptracer";

/// Refuses a method that cannot tell.
pub fn check(method: &Method, flag: &str) -> Result<(), Failure> {
    if method.tells_error() {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{flag}: {} cannot tell its error, which is mostly blur; render with {WHO_TELLS}: see --integrator",
        method.name()
    )))
}

/// How the pixels of a film err, by its identity, which names its integrator, and by what that decided; none if it cannot
/// tell its error.
pub fn pixels_of(identity: &[(String, String)], plan: &RenderPlan) -> Option<Pixels> {
    if let Some(Choice { pick, .. }) = plan.choice {
        return Some(if pick == Pick::Path { Pixels::Apart } else { Pixels::Together });
    }
    let integrator = identity.iter().find(|(name, _)| name == "integrator")?;
    match integrator.1.as_str() {
        "photonmapper" => None,
        "path" | "volpath" => Some(Pixels::Apart),
        _ => Some(Pixels::Together),
    }
}

/// Whether a render that may end by its error is to be judged after so many steps. Nothing else than their number decides,
/// so a render that was interrupted ends where it would have ended.
pub fn is_due(steps: u64) -> bool {
    let mut at = EACH;
    while at < steps {
        at += at.div_ceil(SHARE);
    }
    steps > 0 && (steps <= EACH || at == steps)
}

/// How many times as many steps will bring the error within the target, roughly: it falls as n^(−1/2) by noise, and as
/// n^(−1/3) where there is bias, too, as there is with progressive methods.
pub fn times_the_steps(quality: &Quality, target: f64, method: &Method) -> f64 {
    let inverse_power = if method.is_progressive() { 3.0 } else { 2.0 };
    let ratio = (quality.interval[1] / target).max(1.0);
    let mut times = ratio * ratio;
    if inverse_power > 2.0 {
        times *= ratio;
    }
    times
}

/// For the line of progress.
pub fn short(quality: &Quality) -> String {
    let [low, high] = quality.interval.map(percent);
    format!("error {} % ({low}–{high})", percent(quality.error))
}

/// For the note at the end.
pub fn text(quality: &Quality) -> String {
    let [low, high] = quality.interval.map(percent);
    let (error, noise) = (percent(quality.error), percent(quality.noise));
    let parts = match quality.bias {
        bias if bias > 0.0 => format!(", of it noise {noise} %, bias {} %", percent(bias)),
        _ => ", all of it noise".to_owned(),
    };
    format!("stated error {error} % (90 %: {low}–{high} %){parts}")
}

/// One object, of parts of one.
pub fn json(quality: &Quality) -> Value {
    json!({
        "error": quality.error,
        "interval": quality.interval,
        "noise": quality.noise,
        "bias": quality.bias,
        "estimates": quality.estimates,
    })
}

/// Two or three digits, without the sign.
pub fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let digits = match percent {
        p if p >= 9.95 => 0,
        p if p >= 0.995 => 1,
        p if p >= 0.0995 => 2,
        _ => 3,
    };
    format!("{percent:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::integrator::{LightTracerConfig, PathConfig, PhotonMapperConfig, PpmConfig, VcmConfig};

    fn quality(bias: f64) -> Quality {
        Quality { error: 0.047, interval: [0.042, 0.0501], noise: 0.044, bias, estimates: 9 }
    }

    #[test]
    fn a_render_is_judged_ever_more_rarely() {
        let due: Vec<u64> = (0..64).filter(|steps| is_due(*steps)).collect();
        let first: Vec<u64> = (1..=16).collect();
        assert_eq!(due, [&first[..], &[18, 20, 22, 25, 28, 31, 35, 39, 43, 48, 53, 59]].concat());
    }

    #[test]
    fn it_is_easy_to_read() {
        assert_eq!(
            text(&quality(0.016)),
            "stated error 4.7 % (90 %: 4.2–5.0 %), of it noise 4.4 %, bias 1.6 %"
        );
        assert_eq!(text(&quality(0.0)), "stated error 4.7 % (90 %: 4.2–5.0 %), all of it noise");
        assert_eq!(short(&quality(0.0)), "error 4.7 % (4.2–5.0)");
        assert_eq!([2.5, 0.0996, 0.0099, 0.00096].map(percent), ["250", "10", "0.99", "0.096"]);
    }

    #[test]
    fn half_the_error_takes_four_times_as_long_and_eight_with_bias() {
        let (path, ppm) = (Method::Path(PathConfig::default()), Method::Ppm(PpmConfig::default()));
        let times = |target, method: &Method| times_the_steps(&quality(0.0), target, method);
        assert!((times(0.02505, &path) - 4.0).abs() < 1e-9);
        assert!((times(0.02505, &ppm) - 8.0).abs() < 1e-9);
        assert_eq!(times(1.0, &ppm), 1.0);
    }

    #[test]
    fn films_are_judged_as_renders_are() {
        let plan = RenderPlan::default();
        let methods = [
            Method::Vcm(VcmConfig::default()),
            Method::PhotonMapper(PhotonMapperConfig::default()),
            Method::Ppm(PpmConfig::default()),
            Method::Path(PathConfig::default()),
            Method::Path(PathConfig { media: true, ..PathConfig::default() }),
            Method::LightTracer(LightTracerConfig::default()),
        ];
        for method in methods {
            let identity = [("integrator".to_owned(), method.name().to_owned())];
            assert_eq!(
                pixels_of(&identity, &plan),
                method.tells_error().then(|| method.pixels()),
                "{}",
                method.name()
            );
        }
        assert_eq!(pixels_of(&[], &plan), None);
        let auto = [("integrator".to_owned(), "auto".to_owned())];
        for (pick, pixels) in [(Pick::Path, Pixels::Apart), (Pick::Ppm, Pixels::Together)] {
            let choice = Some(Choice {
                pick,
                path: 1.0,
                ppm: 1.0,
                vcm: [1.0; 2],
                asked_for: false,
                paths_are_known: true,
            });
            assert_eq!(pixels_of(&auto, &RenderPlan { choice, ..plan }), Some(pixels));
        }
    }

    #[test]
    fn who_cannot_tell_is_told_who_can() {
        let mapper = Method::PhotonMapper(PhotonMapperConfig::default());
        let Err(Failure::Usage(message)) = check(&mapper, "--target-error") else { panic!("it cannot tell") };
        assert!(message.starts_with("--target-error: photonmapper cannot tell its error"), "{message}");
        assert!(check(&Method::Path(PathConfig::default()), "--aov error").is_ok());
    }
}
