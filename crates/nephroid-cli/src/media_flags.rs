//! Parameters of media that contradict one another, or the scene.

use nephroid::integrator::{PhotonMapperConfig, VolumeEstimate};
use nephroid::transport::{Fog, VolumeKind};
use nephroid_formats::SceneFile;
use nephroid_formats::diagnostic::{Diagnostic, Diagnostics};

use crate::console::Messages;
use crate::exit::Failure;
use crate::parameters::PhotonFlags;

/// Flags that only scattering media have a use for.
const OF_SCATTERING: [&str; 7] = [
    "single-scatter",
    "volume-photons",
    "volume-kind",
    "volume-estimate",
    "volume-neighbours",
    "beam-crossings",
    "march-step",
];

/// Beams are never marched: where one of the two comes from the command line, it wins over the scene's. Flags that
/// have no effect are told in one message.
pub fn settle(
    config: &mut PhotonMapperConfig,
    file: &SceneFile,
    flags: &PhotonFlags,
    messages: &mut Messages,
) -> Result<(), Failure> {
    agree(config, file, flags, messages)?;
    if !file.scene.has_media() {
        let idle = given(flags, |name| name == "fog" || OF_SCATTERING.contains(&name));
        mean_nothing(&idle, "to a scene without media", messages);
    } else if config.fog == Fog::Ambient {
        mean_nothing(&given(flags, |name| OF_SCATTERING.contains(&name)), "to --fog ambient", messages);
        if file.scene.media.list.iter().all(|medium| medium.ambient.is_black()) {
            messages.note(
                "no medium of the scene has \"ambient\" light: with --fog ambient they only weaken light",
            );
        }
    } else {
        let beams = config.volume_kind == VolumeKind::Beams;
        let marches = !beams && config.volume_estimate == VolumeEstimate::MarchReport;
        let of_points = given(flags, |name| beams && name == "volume-neighbours");
        mean_nothing(&of_points, "to --volume-kind beams", messages);
        let of_beams = given(flags, |name| !beams && name == "beam-crossings");
        mean_nothing(&of_beams, "without --volume-kind beams", messages);
        let of_march = given(flags, |name| !marches && name == "march-step");
        mean_nothing(&of_march, "without --volume-estimate march-report", messages);
    }
    Ok(())
}

/// Brings what maps hold and how they are read together.
fn agree(
    config: &mut PhotonMapperConfig,
    file: &SceneFile,
    flags: &PhotonFlags,
    messages: &mut Messages,
) -> Result<(), Failure> {
    if config.volume_kind != VolumeKind::Beams || config.volume_estimate == VolumeEstimate::Beam {
        return Ok(());
    }
    match (flags.has("volume-kind"), flags.has("volume-estimate")) {
        (true, true) => Err(Failure::Usage(
            "--volume-kind beams cannot be had with --volume-estimate march or march-report: only points are marched"
                .to_owned(),
        )),
        (true, false) => {
            config.volume_estimate = VolumeEstimate::Beam;
            messages.note("the scene's \"volume_estimate\" is for points: with --volume-kind beams it counts for nothing");
            Ok(())
        }
        (false, true) => {
            config.volume_kind = VolumeKind::Points;
            messages.note("only points are marched: with --volume-estimate the scene's \"volume_kind\" counts for nothing");
            Ok(())
        }
        (false, false) => {
            let request = &file.integrator;
            let place = request.parameters.iter().find(|p| p.name == "volume_estimate").map(|p| &p.location);
            let message = "only points are marched, and \"volume_kind\" is \"beams\"";
            Err(Failure::Scene(Diagnostics(vec![match place.or(request.location.as_ref()) {
                Some(location) => Diagnostic::error(location, message),
                None => Diagnostic::global_error(message),
            }])))
        }
    }
}

/// The flags of some names that were given, as they are written.
fn given(flags: &PhotonFlags, wanted: impl Fn(&str) -> bool) -> Vec<String> {
    let name = |flag: &String| wanted(flag.trim_start_matches('-'));
    flags.names().into_iter().filter(name).collect()
}

/// Warns of flags without effect.
fn mean_nothing(flags: &[String], to_what: &str, messages: &mut Messages) {
    match flags {
        [] => {}
        [one] => messages.warning(&format!("{one} means nothing {to_what}")),
        many => messages.warning(&format!("{} mean nothing {to_what}", many.join(", "))),
    }
}
