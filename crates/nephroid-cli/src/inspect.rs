//! `nephroid inspect`: what the estimate of a pixel saw.

use std::io::IsTerminal;

use nephroid::handle::Handle;
use nephroid::integrator::Method;
use nephroid::laboratory::{Inspector, PixelReport};
use nephroid::medium::Medium;
use nephroid::session::RenderSettings;
use nephroid::transport::VolumeKind;
use nephroid::world::World;

use crate::args::LimitArgs;
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::inspect_json;
use crate::inspect_text;
use crate::lab_args::InspectArgs;
use crate::load;
use crate::method;
use crate::plan::Plan;
use crate::progress::{self, Watch};
use crate::render;

/// A pixel that was inspected, and its circumstances.
pub struct Inspected<'a> {
    /// The scene, as it was named.
    pub scene: &'a str,
    /// The world.
    pub world: &'a World,
    /// How it was rendered.
    pub settings: &'a RenderSettings,
    /// The pixel in the picture.
    pub pixel: (u32, u32),
    /// Iterations begun.
    pub passes: u64,
    /// What was found.
    pub report: PixelReport,
    /// The one sample to tell of, or all.
    pub only: Option<usize>,
}

/// Estimates the pixel again, and tells what happened.
pub fn run(args: &InspectArgs) -> Result<Exit, Failure> {
    let mut messages = Messages::new(args.run.quiet);
    let visible = !args.run.quiet && !args.json && std::io::stderr().is_terminal();
    let mut file = load::load(&args.scene, &args.run.reading, visible)?;
    for warning in &file.warnings {
        messages.diagnostic(warning);
    }
    let method = method::choose(
        args.integrator,
        &file,
        &args.run.photons,
        method::Integrator::PhotonMapper,
        &mut messages,
    )?;
    let method = method::maps_only(method);
    if matches!(method, Method::LightTracer(_) | Method::Vcm(_)) {
        return Err(Failure::Usage(format!(
            "inspect: of {} there is too little to tell: its light paths start anywhere, and not at a pixel; inspect \
             path, volpath or ppm",
            method.name()
        )));
    }
    render::resize(&mut file, args.run.resolution, &mut messages)?;
    let limits = LimitArgs { spp: args.spp, passes: args.passes, ..LimitArgs::default() };
    let plan = Plan::new(&limits, file.sample_count);
    let settings = RenderSettings { method, samples_per_pixel: plan.samples_per_pass, seed: args.run.seed };
    let window = file.scene.film.window();
    let (x, y) = args.pixel;
    if x >= window.width || y >= window.height {
        let (width, height) = (window.width, window.height);
        let (right, below) = (width - 1, height - 1);
        return Err(Failure::Usage(format!(
            "pixel {x},{y} is outside the picture of {width} by {height} pixels: X goes from 0 to {right}, Y from 0 to {below}"
        )));
    }
    // Passes of a progressive render have samples of their own number.
    let end = match &settings.method {
        method if method.is_progressive() => plan.samples,
        _ => plan.end(plan.samples_per_pass),
    };
    let samples = end.unwrap_or(u64::MAX);
    if let Some(n) = args.sample.filter(|n| *n as u64 >= samples) {
        return Err(Failure::Usage(format!(
            "there is no sample {n}: the pixel has {samples}, counted from 0"
        )));
    }
    let watch = Watch::new(visible, None, progress::listen()?);
    render::pool(args.run.threads)?.install(|| {
        let world = load::world(file.scene, &file.origins, visible)?;
        let mut inspector = Inspector::new(&world, settings.clone(), (window.x + x, window.y + y), &watch);
        while inspector.samples() < samples && plan.passes.is_none_or(|n| inspector.iterations() < n) {
            if !inspector.step(&watch) {
                watch.finish();
                return Ok(Exit::Stopped);
            }
        }
        watch.finish();
        let report = inspector.finish();
        let passes = report.samples.last().map_or(0, |sample| sample.iteration + 1);
        let inspected = Inspected {
            scene: &args.scene.display().to_string(),
            world: &world,
            settings: &settings,
            pixel: args.pixel,
            passes,
            report,
            only: args.sample,
        };
        let text = match args.json {
            true => format!("{}\n", inspect_json::object(&inspected, &messages.list)),
            false => inspect_text::text(&inspected),
        };
        console::result(&text)?;
        Ok(Exit::Done)
    })
}

impl Inspected<'_> {
    /// The samples to tell of, each with its number through all passes.
    pub fn samples(&self) -> impl Iterator<Item = (usize, &nephroid::laboratory::InspectedSample)> {
        let only = self.only;
        self.report.samples.iter().enumerate().filter(move |(n, _)| only.is_none_or(|wanted| wanted == *n))
    }

    /// The name and the material of a shape.
    pub fn shape(&self, shape: u32) -> (&str, &'static str) {
        let scene = self.world.scene();
        scene.all_shapes().nth(shape as usize).map_or(("", ""), |shape| {
            (shape.name.as_str(), crate::info::material(&scene.materials[shape.material]))
        })
    }

    /// The name of a medium.
    pub fn medium(&self, medium: Option<Handle<Medium>>) -> &str {
        medium.map_or("", |medium| self.world.scene().media.list[medium].name.as_str())
    }

    /// What its maps of light in media hold.
    pub fn stored_in_media(&self) -> &'static str {
        match &self.settings.method {
            method if method.mapper().is_some_and(|c| c.volume_kind == VolumeKind::Beams) => "beam",
            _ => "photon",
        }
    }

    /// The name of a light.
    pub fn light(&self, light: u32) -> &str {
        self.world.lights().nth(light as usize).map_or("", |(name, _)| name)
    }
}
