//! `nephroid photons`: the photons of a render, drawn or one by one.

use std::ffi::OsStr;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use nephroid::integrator::MapName;
use nephroid::laboratory::{LegendEntry, MapPhoton, PhotonPicture, photon_picture, record_photons};
use nephroid::session::RenderSettings;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_formats::image::{check_writable, write_png};
use nephroid_formats::photons::{write_csv, write_ply};

use crate::args::LimitArgs;
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::lab_args::PhotonsArgs;
use crate::load;
use crate::method::{self, Integrator};
use crate::numbers::grouped;
use crate::plan::Plan;
use crate::progress::{self, Watch};
use crate::render;

/// What photons can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Ply,
    Csv,
}

/// Traces the photons and writes them.
pub fn run(args: &PhotonsArgs) -> Result<Exit, Failure> {
    let mut messages = Messages::new(args.run.quiet);
    let outputs = outputs(args)?;
    let visible = !args.run.quiet && std::io::stderr().is_terminal();
    let mut file = load::load(&args.scene, &args.run.reading, visible)?;
    for warning in &file.warnings {
        messages.diagnostic(warning);
    }
    let wanted = Some(Integrator::PhotonMapper);
    let method = method::choose(wanted, &file, &args.run.photons, Integrator::PhotonMapper, &mut messages)?;
    let beams = method.mapper().is_some_and(|config| config.volume_kind == VolumeKind::Beams);
    let in_media = |map: &MapName| matches!(map, MapName::Volume | MapName::VolumeCaustic);
    if beams && args.maps.iter().any(in_media) {
        return Err(Failure::Usage(
            "beams have no place to be drawn or written at: --maps volume and volume-caustic need --volume-kind points"
                .to_owned(),
        ));
    }
    render::resize(&mut file, args.run.resolution, &mut messages)?;
    let plan = Plan::new(&LimitArgs::default(), file.sample_count);
    let watch = Watch::new(visible, None, progress::listen()?);
    let (written, legend) = render::pool(args.run.threads)?.install(|| {
        let world = load::world(file.scene, &file.origins, visible)?;
        let samples_per_pixel = plan.samples_per_pass;
        let settings = RenderSettings { method, samples_per_pixel, seed: args.run.seed };
        let recorded = record_photons(&world, &settings, args.iteration, &watch);
        watch.finish();
        let Some(mut recorded) = recorded else { return Ok((None, Vec::new())) };
        recorded.photons.retain(|photon| args.maps.contains(&photon.map));
        let legend = write(&world, &recorded.photons, &outputs, args)?;
        Ok((Some(recorded.photons.len()), legend))
    })?;
    let Some(photons) = written else { return Ok(Exit::Stopped) };
    if photons == 0 {
        let maps: Vec<&str> = args.maps.iter().map(|map| map.name()).collect();
        messages.warning(&format!("there are no photons: the map {} is empty", maps.join(", ")));
    }
    if !args.run.quiet {
        tell(&legend, photons, &outputs);
    }
    Ok(Exit::Done)
}

/// The files that `-o` names, or a picture in the current folder; each could be written now.
fn outputs(args: &PhotonsArgs) -> Result<Vec<(PathBuf, Kind)>, Failure> {
    let mut default = load::name(&args.scene);
    default.push("-photons.png");
    let default = [PathBuf::from(default)];
    let named = if args.outputs.is_empty() { &default[..] } else { &args.outputs };
    let mut outputs: Vec<(PathBuf, Kind)> = Vec::new();
    for path in named {
        let kind = kind(path)?;
        if outputs.iter().any(|(other, _)| other == path) {
            return Err(Failure::Usage(format!("{}: is to be written twice", path.display())));
        }
        check_writable(path).map_err(|e| Failure::File(e.to_string()))?;
        outputs.push((path.clone(), kind));
    }
    Ok(outputs)
}

fn kind(path: &Path) -> Result<Kind, Failure> {
    let suffix = path.extension().and_then(OsStr::to_str).map(str::to_lowercase);
    match suffix.as_deref() {
        Some("png") => Ok(Kind::Png),
        Some("ply") => Ok(Kind::Ply),
        Some("csv") => Ok(Kind::Csv),
        _ => {
            let message = "the name of a file of photons ends in .png, .ply or .csv";
            Err(Failure::Usage(format!("{}: {message}", path.display())))
        }
    }
}

fn write(
    world: &World,
    photons: &[MapPhoton],
    outputs: &[(PathBuf, Kind)],
    args: &PhotonsArgs,
) -> Result<Vec<LegendEntry>, Failure> {
    let options = PhotonPicture { color: args.color, size: args.size, through_walls: args.through_walls };
    let mut drawn = None;
    let mut errors = Vec::new();
    for (path, kind) in outputs {
        let written = match kind {
            Kind::Png => {
                write_png(path, &drawn.get_or_insert_with(|| photon_picture(world, photons, &options)).0)
            }
            Kind::Ply => write_ply(path, photons),
            Kind::Csv => write_csv(path, photons),
        };
        errors.extend(written.err().map(|e| e.to_string()));
    }
    match errors.is_empty() {
        true => Ok(drawn.map_or(Vec::new(), |(_, legend)| legend)),
        false => Err(Failure::File(errors.join("\nerror: "))),
    }
}

/// The colours of the picture, and what was written.
fn tell(legend: &[LegendEntry], photons: usize, outputs: &[(PathBuf, Kind)]) {
    let colour = console::has_colour();
    for LegendEntry { label, color, photons } in legend {
        let [r, g, b] = color.to_array().map(|v| (v * 255.0 + 0.5) as u8);
        let swatch = if colour { format!("\x1b[48;2;{r};{g};{b}m  \x1b[0m ") } else { String::new() };
        console::say(&format!(
            "{swatch}#{r:02x}{g:02x}{b:02x}  {label} ({} drawn)",
            grouped(*photons as u64)
        ));
    }
    let names: Vec<String> = outputs.iter().map(|(path, _)| path.display().to_string()).collect();
    console::say(&format!("{} photons; written: {}", grouped(photons as u64), names.join(", ")));
}
