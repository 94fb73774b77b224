//! Looking into renders of scenes with media.

use serde_json::Value;

use crate::layers::channels;
use crate::support::Dir;

const FEW: &[&str] =
    &["--photons", "300", "--caustic-photons", "300", "--volume-photons", "500", "--resolution", "16x16"];

fn rows(dir: &Dir, file: &str) -> Vec<Vec<String>> {
    let text = String::from_utf8(dir.read(file)).expect("text");
    text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}

fn rgb(value: &Value) -> [f64; 3] {
    std::array::from_fn(|i| value[i].as_f64().expect("a number"))
}

#[test]
fn photons_in_media_are_written_as_the_render_stores_them() {
    let dir = Dir::new();
    let render = ["render", "fog", "--spp", "1", "--json", "-o", "x.png"];
    let json = dir.run(&[&render[..], FEW].concat()).ends_with(0).json();
    let args =
        ["photons", "fog", "--maps", "volume,volume-caustic", "-o", "p.csv", "-o", "p.ply", "-o", "p.png"];
    let run = dir.run(&[&args[..], FEW].concat()).ends_with(0);
    run.says("  volume (").says("  volume-caustic (");
    let rows = rows(&dir, "p.csv");
    for (map, key) in [("volume", "volume"), ("volume-caustic", "volume caustic")] {
        let stored = rows.iter().filter(|row| row[9] == map).count();
        assert_eq!(json["photons"][key]["stored"], stored, "{map} of {}", json["photons"]);
        assert!(stored > 100, "{map}: {stored}");
    }
    for row in &rows {
        let kind = &row[13];
        assert!(kind.starts_with('L') && kind.ends_with('V'), "{row:?}");
        let specular = kind.len() > 2 && kind[1..kind.len() - 1].bytes().all(|letter| letter == b'S');
        assert_eq!(specular, row[9] == "volume-caustic", "{row:?}");
    }
    let ply = dir.read("p.ply");
    let header = format!("element vertex {}\n", rows.len());
    assert!(ply.windows(header.len()).any(|window| window == header.as_bytes()));
}

#[test]
fn beams_are_not_written() {
    let dir = Dir::new();
    let args = ["photons", "fog", "--volume-kind", "beams", "-o", "p.csv", "--volume-estimate", "beam"];
    let run = dir.run(&[&args[..], &["--maps", "volume-caustic"]].concat()).ends_with(2);
    run.says("error: beams have no place to be drawn or written at");
    assert!(dir.files().is_empty());
    dir.run(&[&args[..], &["--photons", "50", "--caustic-photons", "50"]].concat()).ends_with(0);
}

/// What media bring adds up to that part of each sample, and the samples make the pixel of the render.
#[test]
fn media_on_the_way_of_a_sample_are_told() {
    let dir = Dir::new();
    for (scene, flags, what) in [
        ("fog", &["--final-gather", "off"][..], "photon"),
        ("fog", &["--single-scatter", "rays", "--volume-kind", "beams"], "beam"),
        ("report-3-6", &[], ""),
    ] {
        let flags = [FEW, &["--spp", "2"], flags].concat();
        dir.run(&[&["render", scene, "-o", "x.exr"], &flags[..]].concat()).ends_with(0);
        let inspect = [&["inspect", scene, "--pixel", "8,7"], &flags[..]].concat();
        let json = dir.run(&[&inspect[..], &["--json"]].concat()).ends_with(0).json();
        let picture = channels(&dir, "x.exr");
        let pixel = ["R", "G", "B"].map(|channel| f64::from(picture[channel][7 * 16 + 8]));
        for (told, pixel) in rgb(&json["radiance"]).iter().zip(pixel) {
            assert!((told - pixel).abs() <= 1e-6 * pixel, "{scene}: {told}, not {pixel}");
        }
        let mut counted = 0;
        for sample in json["samples"].as_array().expect("samples") {
            let media = sample["media"].as_array().expect("media");
            assert!(!media.is_empty() && media.iter().all(|m| m["medium"].is_string()), "{sample}");
            let on_path = media.iter().filter(|m| m["gather_ray"].is_null());
            let mut sum = [0.0; 3];
            for m in on_path {
                counted += m["volume"]["count"].as_u64().expect("a number");
                let maps = [&m["volume"], &m["volume_caustic"]].map(|map| &map["radiance"]);
                for light in [&m["emitted"], &m["single"], &m["ambient"], maps[0], maps[1]] {
                    sum = std::array::from_fn(|i| sum[i] + rgb(light)[i]);
                }
                assert!(rgb(&m["transmittance"]).iter().all(|share| *share > 0.0 && *share <= 1.0));
            }
            let medium = rgb(&sample["light"]["medium"]);
            assert!(medium[1] > 0.0 && (sum[1] - medium[1]).abs() <= 1e-5 * medium[1], "{sum:?}, {medium:?}");
        }
        assert_eq!(counted > 0, !what.is_empty(), "{scene}: {counted}");
        let text = dir.run(&inspect).ends_with(0).stdout;
        assert!(text.contains("  segment 1: medium \"") && text.contains(", transmittance "), "{text}");
        let expected = if what.is_empty() { "ambient: ".to_owned() } else { format!(" {what}s\n") };
        assert!(text.contains(&expected), "{expected:?} is not in {text}");
    }
}

#[test]
fn info_tells_of_media_and_what_stands_in_them() {
    let dir = Dir::new();
    let about = dir.run(&["info", "fog", "--json"]).ends_with(0).json();
    let fog = &about["media"][0];
    assert_eq!(
        (&fog["name"], &fog["kind"], &fog["phase"]),
        (&"fog".into(), &"homogeneous".into(), &"isotropic".into())
    );
    assert_eq!((rgb(&fog["sigma_t in 1/m"]), rgb(&fog["albedo"])), ([0.16; 3], [0.9; 3]));
    assert_eq!(about["camera"]["medium"], "fog");
    assert_eq!(about["lights"][1]["medium"], "fog");
    let boundaries = about["boundaries of media"].as_array().expect("a list");
    let ball = boundaries.iter().find(|b| b["shape"] == "glass ball").expect("the ball");
    assert_eq!((&ball["interior"], &ball["exterior"]), (&Value::Null, &"fog".into()));
    let text = dir.run(&["info", "fog"]).ends_with(0).stdout;
    for line in ["media: 1", "  name: fog", "  phase: isotropic", "  medium: fog", "boundaries of media: 7"] {
        assert!(text.lines().any(|l| l == line), "{line:?} is not in {text}");
    }
    let smoke = dir.run(&["info", "smoke", "--json"]).ends_with(0).json();
    assert_eq!(smoke["media"][0]["kind"], "heterogeneous");
    let grid = smoke["media"][0]["sigma_t in 1/m"].as_str().expect("a grid").to_owned();
    assert!(grid.starts_with("grid of ") && grid.contains(" cells, times "), "{grid}");
    let without = dir.run(&["info", "cornell", "--json"]).ends_with(0).json();
    let none = [&without["media"], &without["camera"]["medium"], &without["lights"][0]["medium"]];
    assert_eq!(none, [&Value::Null; 3]);
}

#[test]
fn a_report_tells_the_share_of_media() {
    let dir = Dir::new();
    let args = ["render", "fog", "--spp", "1", "-o", "x.png"];
    let run = dir.run(&[&args[..], FEW].concat()).ends_with(0);
    run.says("        volume map: ").says("volume caustic map: ").says("light from media: ");
    let run = dir.run(&["render", "report-2-11", "--spp", "1", "--resolution", "8x8", "-o", "y.png"]);
    run.ends_with(0).does_not_say("light from media");
}
