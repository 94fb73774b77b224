//! Further values of a picture, as layers of an OpenEXR file.

use nephroid::film::{Aov, AovFilm, AovImage};
use nephroid::integrator::Method;
use nephroid_formats::AovLayer;
use nephroid_formats::image::{Layer, LayerData};

use crate::console::Messages;
use crate::denoise::{GUIDES, NOISY};
use crate::exit::Failure;
use crate::lab_args::unknown;
use crate::quality;

/// A layer to write.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPlan {
    /// What it is called.
    pub name: String,
    /// What is in it.
    pub aov: Aov,
    /// What its channels are called.
    pub channels: &'static [&'static str],
}

/// A value of `--aov`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerFlag {
    /// One that a render keeps.
    Kept(Aov),
    /// The error that each pixel is expected to have, which its sums tell.
    Error,
}

/// The layer of [`LayerFlag::Error`].
pub const ERROR: &str = "error";

/// A layer with its values.
#[derive(Clone, Debug)]
pub struct DevelopedLayer {
    plan: LayerPlan,
    image: AovImage,
}

impl LayerPlan {
    /// One with the value's own name.
    fn of(aov: Aov) -> Self {
        Self { name: aov.name().to_owned(), aov, channels: aov.channels() }
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// The value of a name on the command line.
pub fn parse(name: &str) -> Result<LayerFlag, String> {
    if name == ERROR {
        return Ok(LayerFlag::Error);
    }
    let names: Vec<&str> = Aov::ALL.into_iter().map(Aov::name).chain([ERROR]).collect();
    let kept = Aov::parse(name).map(LayerFlag::Kept);
    kept.ok_or_else(|| unknown(name, "there is no such value: it must be", &names))
}

/// Settles the layers: those of `--aov`, and those of the scene's `aov` integrator that have other names, which no file
/// has unless it `keeps_layers`; and those that a picture is denoised with.
pub fn choose(
    flags: &[LayerFlag],
    of_scene: &[AovLayer],
    method: &Method,
    (keeps_layers, denoises): (bool, bool),
    messages: &mut Messages,
) -> Result<Vec<LayerPlan>, Failure> {
    let mut layers: Vec<LayerPlan> = Vec::new();
    for flag in flags {
        let LayerFlag::Kept(aov) = flag else {
            quality::check(method, "--aov error")?;
            continue;
        };
        if let Some(reason) = lacks(method, *aov) {
            let (name, integrator) = (aov.name(), method.name());
            return Err(Failure::Usage(format!(
                "--aov {name}: the integrator {integrator} {reason}, so it has no {name}"
            )));
        }
        let plan = LayerPlan::of(*aov);
        if !layers.contains(&plan) {
            layers.push(plan);
        }
    }
    if !flags.is_empty() && !keeps_layers {
        let message = "--aov: layers are written to OpenEXR and film files only; name one with -o FILE.exr";
        return Err(Failure::Usage(message.to_owned()));
    }
    for layer in of_scene {
        if let Some(reason) = lacks(method, layer.aov) {
            messages.warning(&format!(
                "the layer \"{}\" of the scene is left out: the integrator {} {reason}",
                layer.name,
                method.name()
            ));
        } else if !layers.iter().any(|other| other.name == layer.name) {
            layers.push(LayerPlan { name: layer.name.clone(), aov: layer.aov, channels: layer.channels() });
        }
    }
    if !layers.is_empty() && !keeps_layers {
        messages.warning("the layers that the scene asks for are left out: no OpenEXR file is written");
        layers.clear();
    }
    if flags.contains(&LayerFlag::Error) && layers.iter().any(|layer| layer.name == ERROR) {
        return Err(Failure::Usage(
            "--aov error: the scene has a layer of that name, which is something else".to_owned(),
        ));
    }
    if denoises {
        add_guides(&mut layers)?;
    }
    Ok(layers)
}

/// Adds what a denoiser asks for and is not there.
fn add_guides(layers: &mut Vec<LayerPlan>) -> Result<(), Failure> {
    let missing: Vec<Aov> =
        GUIDES.into_iter().filter(|aov| layers.iter().all(|layer| layer.aov != *aov)).collect();
    let names = missing.iter().map(|aov| aov.name()).chain([NOISY]);
    if let Some(taken) = names.into_iter().find(|name| layers.iter().any(|layer| layer.name == *name)) {
        return Err(Failure::Usage(format!(
            "--denoise: has a layer \"{taken}\" of its own, and the scene's of that name is something else"
        )));
    }
    layers.extend(missing.into_iter().map(LayerPlan::of));
    Ok(())
}

/// A value for each pixel, its channels one behind the other; none if no layer has it.
pub fn values(layers: &[DevelopedLayer], aov: Aov) -> Option<Vec<f32>> {
    let channels = &layers.iter().find(|layer| layer.plan.aov == aov)?.image.channels;
    let pixels = channels.first().map_or(0, Vec::len);
    Some((0..pixels).flat_map(|i| channels.iter().map(move |channel| channel[i])).collect())
}

/// Whether any layer tells what only photon maps keep apart.
pub fn need_maps(layers: &[LayerPlan]) -> bool {
    layers.iter().any(|layer| {
        layer.aov.is_of_photons() || matches!(layer.aov, Aov::Direct | Aov::Global | Aov::Caustic)
    })
}

/// Why an integrator has no such value.
fn lacks(method: &Method, aov: Aov) -> Option<&'static str> {
    match (method, aov) {
        (Method::Vcm(_), aov) if aov.is_of_photons() => Some("makes no estimates of so many photons"),
        (Method::Path(_) | Method::LightTracer(_), aov) if aov.is_of_photons() => {
            Some("makes no estimates from photons")
        }
        (Method::Vcm(_), Aov::Direct | Aov::Global | Aov::Caustic)
        | (Method::LightTracer(_), Aov::Direct | Aov::Global | Aov::Caustic | Aov::Medium) => {
            Some("does not keep apart what its light paths bring")
        }
        _ => None,
    }
}

/// The values of each layer.
pub fn develop(layers: &[LayerPlan], film: Option<&AovFilm>) -> Vec<DevelopedLayer> {
    let develop = |plan: &LayerPlan| {
        let image = film?.develop(plan.aov)?;
        Some(DevelopedLayer { plan: plan.clone(), image })
    };
    layers.iter().filter_map(develop).collect()
}

/// Calls `write` with the layers as they are written, behind the `first` ones.
pub fn with_layers<T>(
    first: Vec<Layer<'_>>,
    layers: &[DevelopedLayer],
    write: impl FnOnce(&[Layer<'_>]) -> T,
) -> T {
    let channels: Vec<Vec<(&str, &[f32])>> = layers
        .iter()
        .map(|l| l.plan.channels.iter().copied().zip(l.image.channels.iter().map(Vec::as_slice)).collect())
        .collect();
    let mut all = first;
    all.extend(layers.iter().zip(&channels).map(|(layer, channels)| {
        let (width, height) = (layer.image.width, layer.image.height);
        Layer { name: &layer.plan.name, data: LayerData::Channels { width, height, channels } }
    }));
    write(&all)
}
