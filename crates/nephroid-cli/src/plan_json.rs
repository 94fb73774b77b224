//! What a render decided before its first pass, as JSON and back, and as entries to compare.

use nephroid::integrator::{CameraPlan, Choice, Pick};
use nephroid::session::RenderPlan;
use nephroid::transport::{MapPlan, PhotonPlan};
use serde_json::{Value, json};

/// What names of [entries] begin with. No parameter does.
pub const ENTRIES: &str = "decided:";

/// One object. Every field is named here, so that a new one is not forgotten.
pub fn to_json(plan: &RenderPlan) -> Value {
    let RenderPlan { photons, camera, choice } = *plan;
    let PhotonPlan { global, caustic, volume, volume_caustic } = photons;
    let CameraPlan { samples_per_pixel, stride, gather_rays, neighbours, merging_radius } = camera;
    json!({
        "photons": {
            "global": map(global),
            "caustic": map(caustic),
            "volume": map(volume),
            "volume_caustic": map(volume_caustic),
        },
        "camera": {
            "samples_per_pixel": samples_per_pixel,
            "stride": stride,
            "gather_rays": gather_rays,
            "neighbours": neighbours,
            "merging_radius": f64::from(merging_radius),
        },
        "choice": choice.map(chosen),
    })
}

/// The plan that [`to_json`] made it of; none where something is missing or out of range.
pub fn from_json(value: &Value) -> Option<RenderPlan> {
    let (photons, camera) = (&value["photons"], &value["camera"]);
    let small = |name: &str| u32::try_from(camera[name].as_u64()?).ok();
    let neighbours = |map: usize| u32::try_from(camera["neighbours"][map].as_u64()?).ok();
    let gather_rays = match &camera["gather_rays"] {
        Value::Null => None,
        _ => Some(small("gather_rays")?),
    };
    Some(RenderPlan {
        photons: PhotonPlan {
            global: unmap(&photons["global"])?,
            caustic: unmap(&photons["caustic"])?,
            volume: unmap(&photons["volume"])?,
            volume_caustic: unmap(&photons["volume_caustic"])?,
        },
        camera: CameraPlan {
            samples_per_pixel: small("samples_per_pixel").filter(|n| *n > 0)?,
            stride: small("stride").filter(|n| *n > 0)?,
            gather_rays,
            neighbours: [neighbours(0)?, neighbours(1)?],
            merging_radius: camera["merging_radius"].as_f64()? as f32,
        },
        choice: match &value["choice"] {
            Value::Null => None,
            choice => Some(unchosen(choice)?),
        },
    })
}

/// What was chosen, and the work that each integrator would take.
pub fn chosen(choice: Choice) -> Value {
    let Choice { pick, path, ppm, vcm, asked_for, paths_are_known } = choice;
    let pick = match pick {
        Pick::Path => "path",
        Pick::Ppm => "ppm",
        Pick::Vcm { connections: false } => "vcm",
        Pick::Vcm { connections: true } => "vcm with connections",
    };
    // There is no infinity in JSON.
    let work = |work: f64| work.is_finite().then_some(work);
    json!({
        "pick": pick,
        "work": { "path": work(path), "ppm": work(ppm), "vcm": work(vcm[0]), "vcm_with_connections": work(vcm[1]) },
        "asked_for": asked_for,
        "paths_are_known": paths_are_known,
    })
}

fn unchosen(value: &Value) -> Option<Choice> {
    let pick = match value["pick"].as_str()? {
        "path" => Pick::Path,
        "ppm" => Pick::Ppm,
        "vcm" => Pick::Vcm { connections: false },
        "vcm with connections" => Pick::Vcm { connections: true },
        _ => return None,
    };
    let work = |name: &str| match &value["work"][name] {
        Value::Null => Some(f64::INFINITY),
        work => work.as_f64(),
    };
    Some(Choice {
        pick,
        path: work("path")?,
        ppm: work("ppm")?,
        vcm: [work("vcm")?, work("vcm_with_connections")?],
        asked_for: value["asked_for"].as_bool()?,
        paths_are_known: value["paths_are_known"].as_bool()?,
    })
}

/// Every number with a name, for the identity of a film.
pub fn entries(plan: &RenderPlan) -> Vec<(String, String)> {
    let mut out = Vec::new();
    flatten(ENTRIES, &to_json(plan), &mut out);
    out
}

fn flatten(name: &str, value: &Value, out: &mut Vec<(String, String)>) {
    match value {
        Value::Object(fields) => {
            for (field, value) in fields {
                flatten(&format!("{name} {}", field.replace('_', " ")), value, out);
            }
        }
        _ => out.push((name.to_owned(), value.to_string())),
    }
}

fn map(plan: MapPlan) -> Value {
    let MapPlan { paths, expected_photons, limited } = plan;
    json!({ "paths": paths, "expected_photons": expected_photons, "limited": limited })
}

fn unmap(value: &Value) -> Option<MapPlan> {
    Some(MapPlan {
        paths: value["paths"].as_u64()?,
        expected_photons: value["expected_photons"].as_u64()?,
        limited: value["limited"].as_bool()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> RenderPlan {
        let map = |paths| MapPlan { paths, expected_photons: paths / 3, limited: paths % 2 == 0 };
        RenderPlan {
            photons: PhotonPlan {
                global: map(7),
                caustic: map(u64::MAX),
                volume: map(11),
                volume_caustic: map(1 << 60),
            },
            camera: CameraPlan {
                samples_per_pixel: 9,
                stride: 4,
                gather_rays: Some(13),
                neighbours: [50, 60],
                merging_radius: 0.1,
            },
            choice: None,
        }
    }

    #[test]
    fn a_plan_survives_the_way_through_text() {
        let path = f64::INFINITY;
        let chosen =
            |pick| Choice { pick, path, ppm: 0.1, vcm: [1e-9, 3.0], asked_for: false, paths_are_known: true };
        let choices = [None, Some(chosen(Pick::Path)), Some(chosen(Pick::Vcm { connections: true }))];
        for (gather_rays, choice) in [None, Some(u32::MAX), Some(1)].into_iter().zip(choices) {
            let mut plan = RenderPlan { choice, ..plan() };
            plan.camera.gather_rays = gather_rays;
            let text = to_json(&plan).to_string();
            assert_eq!(from_json(&serde_json::from_str(&text).unwrap()), Some(plan));
        }
    }

    #[test]
    fn what_is_missing_or_damaged_is_no_plan() {
        let whole = to_json(&plan());
        assert_eq!(from_json(&Value::Null), None);
        for pointer in
            ["/photons/global/paths", "/photons/volume/limited", "/camera/stride", "/camera/neighbours/1"]
        {
            let mut value = whole.clone();
            *value.pointer_mut(pointer).unwrap() = json!(-1);
            assert_eq!(from_json(&value), None, "{pointer}");
        }
        let mut value = whole;
        value["camera"]["samples_per_pixel"] = json!(0);
        assert_eq!(from_json(&value), None);
    }

    #[test]
    fn entries_name_every_number() {
        let entries = entries(&plan());
        assert_eq!(entries.len(), 18);
        assert!(entries.contains(&("decided: photons caustic paths".to_owned(), u64::MAX.to_string())));
        assert!(entries.contains(&("decided: camera gather rays".to_owned(), "13".to_owned())));
    }
}
