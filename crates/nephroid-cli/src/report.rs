//! What there is to say about a render when it is done.

use std::fmt::Write;
use std::time::Duration;

use nephroid::integrator::Method;
use nephroid::session::{MapStatistics, RenderSettings};
use nephroid::transport::{Balance, MapPlan, VolumeKind};
use serde_json::{Value, json};

use crate::checkpoint::Checkpoint;
use crate::console::Messages;
use crate::denoise::Denoised;
use crate::films;
use crate::layers::{ERROR, LayerPlan};
use crate::method;
use crate::noise;
use crate::numbers::{grouped, plural, power, three_digits};
use crate::output::{Kind, Output};
use crate::plan::Plan;
use crate::plan_json;
use crate::quality;
use crate::rendering::{Ended, Rendered};

/// A render and its circumstances.
pub struct Report<'a> {
    /// The scene, as it was named.
    pub scene: &'a str,
    /// How it was rendered.
    pub settings: &'a RenderSettings,
    /// How much was to be rendered.
    pub plan: &'a Plan,
    /// What became of it.
    pub rendered: &'a Rendered,
    /// The files that were written.
    pub outputs: &'a [Output],
    /// By what they were denoised.
    pub denoised: Option<&'a Denoised>,
    /// Whether the error of each pixel is to be a layer.
    pub wants_error: bool,
    /// Where it is kept.
    pub checkpoint: Option<&'a Checkpoint>,
    /// How long it took to read the scene.
    pub reading: Duration,
    /// How long it took to write the pictures.
    pub writing: Duration,
}

/// One map's numbers, with what was planned for it.
struct Map {
    name: &'static str,
    /// What it holds.
    what: &'static str,
    wanted: u64,
    plan: MapPlan,
    numbers: MapStatistics,
}

impl Map {
    /// Photons in one map, on average over the passes.
    fn photons_per_map(&self) -> f64 {
        let maps = self.numbers.paths as f64 / self.plan.paths.max(1) as f64;
        if maps > 0.0 { self.numbers.photons as f64 / maps } else { 0.0 }
    }

    fn bytes_per_photon(&self) -> Option<f64> {
        let photons = self.photons_per_map();
        (photons > 0.0).then(|| self.numbers.bytes as f64 / photons)
    }

    fn json(&self) -> Value {
        json!({
            "wanted": self.wanted,
            "emitted": self.numbers.paths,
            "stored": self.numbers.photons,
            "bytes": self.numbers.bytes,
            "bytes_per_photon": self.bytes_per_photon(),
            "limited": self.plan.limited,
        })
    }
}

/// The light paths of all passes that camera paths are connected to and merged with.
struct LightPaths {
    numbers: MapStatistics,
    /// Of the first pass, in m; 0 where nothing is merged.
    merging_radius: f32,
}

impl LightPaths {
    fn text(&self) -> String {
        let (paths, merged) = (grouped(self.numbers.paths), grouped(self.numbers.photons));
        let radius = match self.merging_radius {
            radius if radius > 0.0 => format!(", radius {} m in the first pass", three_digits(radius.into())),
            _ => String::new(),
        };
        format!("{:>18}: {paths} with {merged} vertices to merge with{radius}", "light paths")
    }

    fn json(&self) -> Value {
        json!({
            "emitted": self.numbers.paths,
            "vertices": self.numbers.photons,
            "bytes": self.numbers.bytes,
            "merging_radius": self.merging_radius,
        })
    }
}

impl Report<'_> {
    /// What there is instead of maps of photons on surfaces, if that is so.
    fn light_paths(&self) -> Option<LightPaths> {
        let s = &self.rendered.statistics;
        matches!(self.rendered.method, Method::Vcm(_))
            .then(|| LightPaths { numbers: s.global, merging_radius: s.plan.camera.merging_radius })
    }

    fn maps(&self) -> Vec<Map> {
        let Some(config) = self.rendered.method.mapper() else { return Vec::new() };
        let s = &self.rendered.statistics;
        let plan = s.plan.photons;
        // What a progressive render wants is what it planned.
        let planned = self.rendered.method.is_progressive();
        let wanted = |asked: u64, plan: MapPlan| if planned { plan.expected_photons } else { asked };
        let what = "photons";
        let mut maps = Vec::new();
        if self.light_paths().is_none() {
            maps.extend([
                Map {
                    name: "global",
                    what,
                    wanted: wanted(config.photons, plan.global),
                    plan: plan.global,
                    numbers: s.global,
                },
                Map {
                    name: "caustic",
                    what,
                    wanted: wanted(config.caustic_photons, plan.caustic),
                    plan: plan.caustic,
                    numbers: s.caustic,
                },
            ]);
        }
        if plan.volume.paths + plan.volume_caustic.paths > 0 {
            let asked = config.volume_photons();
            let what = if config.volume_kind == VolumeKind::Beams { "beams" } else { what };
            let mut add = |name, plan, numbers| {
                maps.push(Map { name, what, wanted: wanted(asked, plan), plan, numbers });
            };
            add("volume", plan.volume, s.volume);
            if plan.volume_caustic.paths > 0 {
                add("volume caustic", plan.volume_caustic, s.volume_caustic);
            }
        }
        maps
    }

    fn balances(&self) -> impl Iterator<Item = (&str, &Balance)> {
        self.rendered.lights.iter().map(String::as_str).zip(&self.rendered.statistics.ledger.lights)
    }

    /// Warns of what may make the picture wrong or poor.
    pub fn check(&self, messages: &mut Messages) {
        let rendered = self.rendered;
        if !rendered.has_light {
            messages.warning("there is no light in the scene: the picture is black");
        }
        if rendered.blind_to_specular {
            messages.warning("what is seen in mirrors and through glass is left out by ptracer");
        }
        let (film, _) = &rendered.picture;
        if rendered.has_picture() && !rendered.has_film() {
            messages.warning("stopped before every pixel had a sample: the rest of the picture is black");
        }
        for map in self.maps().iter().filter(|map| map.plan.limited && map.numbers.paths > 0) {
            let (name, paths) = (map.name, grouped(map.numbers.paths));
            if map.numbers.photons == 0 {
                messages.note(&format!("the {name} map is empty: none of {paths} paths leads there"));
                continue;
            }
            let why = match map.plan.expected_photons {
                0 => "and trial paths found none",
                _ => "and --emit-max ended the emission",
            };
            messages.warning(&format!(
                "the {name} map has {} photons instead of {}: few paths lead there, {why}",
                grouped(map.photons_per_map() as u64),
                grouped(map.wanted)
            ));
        }
        for (light, balance) in self.balances() {
            if balance.imbalance().abs() > 1e-6 || balance.roulette_z().abs() > 4.0 {
                messages.warning(&format!(
                    "the energy of \"{light}\" does not add up: imbalance {:.1e}, roulette {:.1} sigma; please report this",
                    balance.imbalance(),
                    balance.roulette_z()
                ));
            }
        }
        let counts = film.counts();
        if counts.non_finite > 0 {
            messages.warning(&format!(
                "{} estimates of pixels were not finite and are left out; please report this",
                counts.non_finite
            ));
        }
        if counts.saturated > 0 {
            messages.warning(&format!("{} values were too large and are cut down", counts.saturated));
        }
        if let Some(limit) = rendered.limit.filter(|limit| *limit > 0.0) {
            let took = rendered.rendering.as_secs_f64();
            if took > 1.05 * limit {
                messages.warning(&format!(
                    "the first samples of each pixel took {took:.1} s, longer than --time"
                ));
            }
        }
        self.check_error(messages);
        if self.wants_error && rendered.quality.is_none() {
            messages.warning("the layer error is left out: it cannot be told from so few passes");
        }
        if !rendered.has_picture() {
            messages.warning("stopped before the first samples were complete: no picture is written");
        } else if self.plan.range.is_some() && self.outputs.iter().any(|o| o.kind != Kind::Film) {
            let part = films::passes(std::slice::from_ref(&rendered.covered), rendered.samples_per_pass());
            messages.note(&format!("the pictures show a part of the render only: {part}"));
        }
        if self.checkpoint.is_some() && !rendered.has_film() {
            messages.warning("stopped before every pixel had a sample: there is no checkpoint");
        }
        let nothing_new = rendered.statistics.samples_per_pixel == 0 && rendered.has_film();
        if nothing_new && matches!(rendered.ended, Ended::Finished | Ended::GoodEnough) {
            let more = match self.plan.range {
                Some(_) => "",
                None => ": for more, say --passes, --spp, --time or --target-error",
            };
            messages.note(&format!("everything was rendered before{more}"));
        }
    }

    /// Tells where the error is not as small as it was to be.
    fn check_error(&self, messages: &mut Messages) {
        let (Some(target), false) = (self.plan.target_error, self.rendered.ended == Ended::GoodEnough) else {
            return;
        };
        if self.rendered.quality.is_some_and(|quality| quality.interval[1] <= target) {
            return;
        }
        let target = quality::percent(target);
        messages.note(&match &self.rendered.quality {
            Some(quality) => {
                format!("the error is not known to be within {target} %: {}", quality::text(quality))
            }
            None => format!("whether the error is within {target} % cannot be told from so few passes"),
        });
    }

    /// What rendered, in a few words.
    fn method(&self) -> String {
        let (asked, chosen) = (self.settings.method.name(), self.rendered.method.name());
        if asked == chosen { asked.to_owned() } else { format!("{asked} ({chosen})") }
    }

    /// A block of lines.
    pub fn text(&self) -> String {
        let r = self.rendered;
        let s = &r.statistics;
        let mut out = String::new();
        let method = self.method();
        let ended = match r.ended {
            Ended::Finished => "",
            Ended::GoodEnough => ", until its error was small enough",
            Ended::TimeIsUp => ", until the time was up",
            Ended::Interrupted => ", until it was stopped",
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            out,
            "{}: {} by {} pixels, {} samples each, {method} with {}, {}{ended}",
            self.scene,
            r.picture.0.width(),
            r.picture.0.height(),
            r.samples(),
            plural(r.threads as u64, "thread"),
            plural(s.iterations, "pass"),
        );
        if r.samples() != s.samples_per_pixel || self.plan.range.is_some() {
            let part = films::passes(std::slice::from_ref(&r.covered), r.samples_per_pass());
            let _ = writeln!(out, "the picture has {part}; of this run: {} samples", s.samples_per_pixel);
        }
        if let Some(light_paths) = self.light_paths() {
            let _ = writeln!(out, "{}", light_paths.text());
        }
        for map in self.maps() {
            let bytes = map.bytes_per_photon().map_or(String::new(), |b| format!(", {b:.0} bytes each"));
            let _ = writeln!(
                out,
                "{:>14} map: {} {} stored of {} paths{bytes}",
                map.name,
                grouped(map.numbers.photons),
                map.what,
                grouped(map.numbers.paths)
            );
        }
        let seconds = self.seconds();
        let times: Vec<String> = seconds.iter().map(|(name, s)| format!("{name} {s:.2}")).collect();
        let _ = writeln!(out, "           seconds: {}", times.join(", "));
        self.ledger(&mut out);
        let cut = s.picture.clamped_share();
        if cut > 0.0 {
            let _ = writeln!(out, "clamped: camera samples lost {:.3} % of the light", 100.0 * cut);
        }
        if let Some(ratio) = s.picture.direct_to_indirect() {
            let _ = writeln!(out, "direct to indirect light: {ratio:.4}");
        }
        if let Some(share) = self.share_of_media() {
            let _ = writeln!(out, "light from media: {:.2} % of all", 100.0 * share);
        }
        let good = match (&r.quality, r.noise) {
            (Some(quality), _) => format!(", {}", quality::text(quality)),
            (None, Some(noise)) => format!(", noise {}", noise::percent(noise)),
            (None, None) => String::new(),
        };
        let _ = writeln!(out, "mean luminance: {:.6} W/(m2 sr){good}", r.picture.0.mean_luminance());
        if let Some(checkpoint) = self.checkpoint {
            let (path, times) = (checkpoint.path().display(), plural(checkpoint.written, "time"));
            let _ = writeln!(out, "kept: {path}, written {times} in {:.2} s", checkpoint.spent.as_secs_f64());
        }
        if let Some(denoised) = self.denoised {
            let _ = writeln!(out, "denoised: {}", denoised.text());
        }
        if !self.outputs.is_empty() {
            let names: Vec<String> = self.outputs.iter().map(|o| o.path.display().to_string()).collect();
            let _ = writeln!(out, "written: {}", names.join(", "));
        }
        out
    }

    /// Of the picture's light what media scatter or give off towards the camera; none where they do not.
    fn share_of_media(&self) -> Option<f64> {
        let p = &self.rendered.statistics.picture;
        let total = |v: [f64; 3]| v.iter().sum::<f64>();
        let medium = total(p.medium);
        let all = medium + [p.emitted, p.direct, p.global, p.caustic].map(total).iter().sum::<f64>();
        (medium > 0.0).then(|| medium / all)
    }

    /// Where the power of each light went.
    fn ledger(&self, out: &mut String) {
        let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
        let width = self.balances().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(5);
        for (i, (name, b)) in self.balances().enumerate() {
            if i == 0 {
                let _ = writeln!(
                    out,
                    "{:width$} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11}   imbalance  roulette/sigma  (W, mean of the channels)",
                    "light", "emitted", "absorbed", "in media", "escaped", "ended", "roulette"
                );
            }
            let _ = write!(out, "{name:width$}");
            for value in [b.emitted, b.absorbed, b.absorbed_by_media, b.escaped, b.ended, b.roulette] {
                let _ = write!(out, " {:>11}", power(mean(value)));
            }
            let _ = writeln!(out, " {:>11.1e} {:>15.2}", b.imbalance(), b.roulette_z());
        }
    }

    fn seconds(&self) -> [(&'static str, f64); 8] {
        let (r, p) = (self.rendered, self.rendered.phases);
        [
            ("read", self.reading),
            ("prepare", r.preparing),
            ("pilot", p.pilot),
            ("photons", p.photons),
            ("maps", p.maps),
            ("picture", p.camera),
            ("render", r.rendering),
            ("write", self.writing),
        ]
        .map(|(name, time)| (name, time.as_secs_f64()))
    }

    /// One object.
    pub fn json(&self, warnings: &[String]) -> Value {
        let r = self.rendered;
        let s = &r.statistics;
        let picture = |sums: [f64; 3]| sums.map(|v| v / s.picture.samples.max(1) as f64);
        let maps: serde_json::Map<_, _> =
            self.maps().iter().map(|map| (map.name.to_owned(), map.json())).collect();
        let seconds: serde_json::Map<_, _> =
            self.seconds().into_iter().map(|(name, s)| (name.to_owned(), json!(s))).collect();
        let error = (self.wants_error && r.quality.is_some()).then_some(ERROR);
        let (film, _) = &r.picture;
        let image = film.develop();
        let outputs: Vec<String> = self.outputs.iter().map(|o| o.path.display().to_string()).collect();
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.scene,
            "integrator": method::describe(&self.settings.method),
            "chosen": r.choice.map(plan_json::chosen),
            "width": film.width(),
            "height": film.height(),
            "seed": self.settings.seed,
            "threads": r.threads,
            "limits": {
                "samples_per_pixel": self.plan.samples,
                "passes": self.plan.passes,
                "seconds": self.plan.seconds,
                "target_error": self.plan.target_error,
                "pass_range": self.plan.range.map(|range| [range.begin, range.end]),
            },
            "ended": match r.ended {
                Ended::Finished => "finished",
                Ended::GoodEnough => "error",
                Ended::TimeIsUp => "time",
                Ended::Interrupted => "interrupted",
            },
            "passes": s.iterations,
            "samples_per_pass": s.plan.camera.samples_per_pixel,
            "samples_per_pixel": r.samples(),
            "passes_done": r.passes_done(),
            "covered": if r.has_film() { vec![[r.covered.start, r.covered.end]] } else { Vec::new() },
            "noise": r.noise,
            "quality": r.quality.as_ref().map(quality::json),
            "checkpoint": self.checkpoint.map(|checkpoint| json!({
                "file": checkpoint.path().display().to_string(),
                "written": checkpoint.written,
                "seconds": checkpoint.spent.as_secs_f64(),
            })),
            "camera_samples": s.picture.samples,
            "seconds": seconds,
            "photons": maps,
            "light_paths": self.light_paths().map(|paths| paths.json()),
            "ledger": self.balances().map(balance_json).collect::<Vec<_>>(),
            "image": {
                "mean": image.mean().to_array(),
                "mean_luminance": film.mean_luminance(),
                "non_finite": film.counts().non_finite,
                "saturated": film.counts().saturated,
            },
            "light": {
                "emitted": picture(s.picture.emitted),
                "direct": picture(s.picture.direct),
                "global": picture(s.picture.global),
                "caustic": picture(s.picture.caustic),
                "medium": picture(s.picture.medium),
                "clamped_share": s.picture.clamped_share(),
                "direct_to_indirect": s.picture.direct_to_indirect(),
            },
            "denoised": self.denoised.map(Denoised::json),
            "outputs": outputs,
            "layers": r.layers.iter().map(LayerPlan::name).chain(error).collect::<Vec<_>>(),
            "messages": warnings,
        })
    }
}

fn balance_json((light, balance): (&str, &Balance)) -> Value {
    json!({
        "light": light,
        "emitted": balance.emitted,
        "absorbed": balance.absorbed,
        "absorbed_by_media": balance.absorbed_by_media,
        "escaped": balance.escaped,
        "ended": balance.ended,
        "roulette": balance.roulette,
        "imbalance": balance.imbalance(),
        "roulette_sigmas": balance.roulette_z(),
    })
}
