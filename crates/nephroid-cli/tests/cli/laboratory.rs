use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Encoding, Property};
use serde_json::Value;

use crate::layers::channels;
use crate::support::Dir;

const PHOTONS: &[&str] = &["--photons", "900", "--caustic-photons", "700", "--resolution", "40x30"];

fn photons(dir: &Dir, args: &[&str]) -> crate::support::Run {
    dir.run(&[&["photons", "cornell"], PHOTONS, args].concat())
}

/// What a render with the same flags stores.
fn stored(dir: &Dir) -> (usize, usize) {
    let args = [&["render", "cornell", "--spp", "1", "--json", "-o", "x.png"], PHOTONS].concat();
    let json = dir.run(&args).ends_with(0).json();
    let of = |map: &str| json["photons"][map]["stored"].as_u64().unwrap() as usize;
    (of("global"), of("caustic"))
}

fn table(dir: &Dir, file: &str) -> (String, Vec<Vec<String>>) {
    let text = String::from_utf8(dir.read(file)).unwrap();
    let mut rows = text.lines();
    let header = rows.next().unwrap().to_owned();
    (header, rows.map(|row| row.split(',').map(str::to_owned).collect()).collect())
}

#[test]
fn tables_have_a_row_for_each_photon_of_the_render() {
    let dir = Dir::new();
    let (global, caustic) = stored(&dir);
    photons(&dir, &["-o", "p.csv"]).ends_with(0);
    let (header, rows) = table(&dir, "p.csv");
    assert_eq!(header, "x,y,z,dx,dy,dz,power_r,power_g,power_b,map,bounce,light,path,kind");
    let of = |map: &str| rows.iter().filter(|row| row[9] == map).count();
    assert_eq!((of("global"), of("caustic"), rows.len()), (global, caustic, global + caustic));
    for row in &rows {
        let n = |i: usize| row[i].parse::<f32>().unwrap();
        assert!((n(3).powi(2) + n(4).powi(2) + n(5).powi(2) - 1.0).abs() < 1e-5, "{row:?}");
        assert!(n(6) > 0.0 && row[13].len() == row[10].parse::<usize>().unwrap() + 2, "{row:?}");
        let specular = row[13][1..row[13].len() - 1].chars().all(|bounce| bounce == 'S');
        assert_eq!(specular, row[9] == "caustic", "{row:?}");
    }
    photons(&dir, &["-o", "c.csv", "--maps", "caustic"]).ends_with(0);
    assert_eq!(table(&dir, "c.csv").1.len(), caustic);
    photons(&dir, &["-o", "next.csv", "--iteration", "1"]).ends_with(0);
    assert_ne!(table(&dir, "next.csv").1[0], rows[0]);
}

#[test]
fn clouds_are_read_back_as_the_tables_are() {
    let dir = Dir::new();
    photons(&dir, &["-o", "p.ply", "-o", "p.csv", "--maps", "global,caustic,afterglow"]).ends_with(0);
    let rows = table(&dir, "p.csv").1;
    let bytes = dir.read("p.ply");
    let ply = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).unwrap();
    assert_eq!(ply.header.encoding, Encoding::BinaryLittleEndian);
    assert_eq!(ply.header.elements.len(), 1);
    let names: Vec<&str> = ply.header.elements["vertex"].properties.keys().map(String::as_str).collect();
    let header = "x,y,z,dx,dy,dz,power_r,power_g,power_b,map,bounce,light,path";
    assert_eq!(names, header.split(',').collect::<Vec<_>>());
    let vertices = &ply.payload["vertex"];
    assert_eq!(vertices.len(), rows.len());
    for (vertex, row) in vertices.iter().zip(&rows) {
        for (name, text) in names.iter().zip(row) {
            let expected = ["global", "caustic", "afterglow"].iter().position(|map| map == text);
            let expected = expected.map_or_else(|| text.parse::<f64>().unwrap(), |map| map as f64);
            let value = match vertex[*name] {
                Property::Float(v) => {
                    assert_eq!(v, text.parse::<f32>().unwrap(), "{name}");
                    continue;
                }
                Property::UChar(v) => f64::from(v),
                Property::UInt(v) => f64::from(v),
                Property::Double(v) => v,
                ref other => panic!("{name}: {other:?}"),
            };
            assert_eq!(value, expected, "{name}");
        }
    }
}

#[test]
fn pictures_are_the_same_each_time_and_come_with_a_legend() {
    let dir = Dir::new();
    let run = photons(&dir, &["-o", "a.png", "--threads", "1"]).ends_with(0);
    run.says("#73a6ff  global (").says("#ffa61a  caustic (").says("photons; written: a.png");
    photons(&dir, &["-o", "b.png", "--threads", "3"]).ends_with(0);
    assert!(dir.read("a.png") == dir.read("b.png"));
    for (i, flags) in [
        &["--color", "bounce"][..],
        &["--color", "light"],
        &["--color", "power"],
        &["--size", "3"],
        &["--through-walls"],
    ]
    .iter()
    .enumerate()
    {
        let file = format!("{i}.png");
        photons(&dir, &[&["-o", &file], *flags].concat()).ends_with(0);
        assert!(dir.read("a.png") != dir.read(&file), "{flags:?}");
    }
    photons(&dir, &["--quiet", "--color", "light"]).ends_with(0).does_not_say("light");
    assert!(dir.files().contains(&"cornell-photons.png".to_owned()));
    photons(&dir, &["-o", "l.png", "--color", "light"]).ends_with(0).says("light 0: lamp (");
    photons(&dir, &["-o", "w.png", "--color", "power"]).ends_with(0).says(" W (");
    photons(&dir, &["-o", "o.png", "--color", "bounce"])
        .ends_with(0)
        .says("1 bounce (")
        .says("6 or more bounces (");
}

#[test]
fn photons_refuse_what_they_cannot_do() {
    let dir = Dir::new();
    for (args, message) in [
        (&["-o", "x"][..], "error: x: the name of a file of photons ends in .png, .ply or .csv\n"),
        (&["-o", "x.exr"], "error: x.exr: the name of a file of photons ends in .png, .ply or .csv\n"),
        (&["-o", "x.csv", "-o", "x.csv"], "error: x.csv: is to be written twice\n"),
        (
            &["--maps", "caustc"],
            "error: invalid value 'caustc' for '--maps <MAP,…>': there is no such map: it must be one of global, \
             caustic, afterglow, haze, volume, volume-caustic; did you mean \"caustic\"?",
        ),
        (
            &["--color", "colour"],
            "error: invalid value 'colour' for '--color <WHAT>': it must be one of map, bounce, light, power\n",
        ),
        (&["--size", "0"], "0 is not in 1..=64"),
    ] {
        photons(&dir, args).ends_with(2).says(message);
    }
    photons(&dir, &["-o", "no/where.ply"])
        .ends_with(4)
        .says("no/where.ply: cannot be written: there is no folder no");
    assert!(dir.files().is_empty());
    let run = dir
        .run(&["photons", "report-2-12", "--photons", "0", "-o", "x.csv", "--maps", "caustic"])
        .ends_with(0);
    run.says("warning: there are no photons: the map caustic is empty");
    assert_eq!(table(&dir, "x.csv").1.len(), 0);
}

fn rgb(value: &Value) -> [f32; 3] {
    std::array::from_fn(|i| value[i].as_f64().unwrap() as f32)
}

#[test]
fn an_inspected_pixel_is_the_pixel_of_the_render() {
    let dir = Dir::new();
    for flags in [
        &["--spp", "6"][..],
        &["--spp", "32"],
        &["--passes", "3", "--spp", "10", "--final-gather", "off"],
        &["--spp", "5", "--direct", "map", "--final-gather", "off", "--seed", "4"],
        &["--spp", "5", "--integrator", "path"],
    ] {
        let flags = [PHOTONS, flags].concat();
        dir.run(&[&["render", "cornell", "-o", "x.exr"], &flags[..]].concat()).ends_with(0);
        let picture = channels(&dir, "x.exr");
        for (pixel, i) in [("0,0", 0), ("12,17", 17 * 40 + 12), ("24,25", 25 * 40 + 24), ("39,29", 1199)] {
            let args = ["inspect", "cornell", "--json", "--pixel", pixel];
            let run = dir.run(&[&args[..], &flags].concat()).ends_with(0);
            let json = run.json();
            let expected = ["R", "G", "B"].map(|c| picture[c][i]);
            assert_eq!(rgb(&json["radiance"]), expected, "{flags:?} at {pixel}");
            let samples = json["samples"].as_array().unwrap();
            assert_eq!(samples.len() as u64, json["samples_per_pixel"].as_u64().unwrap());
            let mean = samples.iter().map(|s| rgb(&s["radiance"])[1]).sum::<f32>() / samples.len() as f32;
            assert!((mean - expected[1]).abs() <= 1e-5 * expected[1], "{mean}, not {}", expected[1]);
        }
    }
}

#[test]
fn contributions_name_their_light_and_path() {
    let dir = Dir::new();
    let flags = ["--spp", "4", "--final-gather", "off", "--pixel", "24,25"];
    let json = dir.run(&[&["inspect", "cornell", "--json"], PHOTONS, &flags].concat()).ends_with(0).json();
    let sample = &json["samples"][0];
    let look_ups = sample["look_ups"].as_array().unwrap();
    let maps: Vec<&str> = look_ups.iter().map(|l| l["map"].as_str().unwrap()).collect();
    assert_eq!(maps, ["caustic", "global"]);
    let mut total = 0.0;
    for look_up in look_ups {
        assert!(look_up["radius"].as_f64().unwrap() > 0.0);
        let contributions = look_up["contributions"].as_array().unwrap();
        let counted: u64 = contributions.iter().map(|c| c["photons"].as_u64().unwrap()).sum();
        assert_eq!(counted, look_up["count"].as_u64().unwrap());
        for c in contributions {
            assert_eq!((&c["light"], &c["part"]), (&"lamp".into(), &look_up["map"]));
            let path = c["path"].as_str().unwrap();
            assert!(path.starts_with('L') && path.ends_with('D') && path.len() > 2, "{path}");
            total += rgb(&c["radiance"])[1];
        }
    }
    let light = |part: &str| rgb(&sample["light"][part])[1];
    assert!((total - light("caustic") - light("global")).abs() < 1e-5 * total, "{total}");
    let text = dir.run(&[&["inspect", "cornell"], PHOTONS, &flags].concat()).ends_with(0).stdout;
    for part in
        ["pixel 24,25: 4 samples in 1 pass", "caustic map: 59 photons within", "from \"lamp\": caustic"]
    {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn one_sample_is_told_with_its_gather_rays() {
    let dir = Dir::new();
    let flags = ["--spp", "4", "--pixel", "12,25", "--sample", "2"];
    let run = dir.run(&[&["inspect", "cornell"], PHOTONS, &flags].concat()).ends_with(0);
    // Four rays for each sample, those of the third being 8 to 11.
    assert!(run.stdout.contains("gather ray 8, segment 2: "), "{}", run.stdout);
    assert!(
        run.stdout.contains("sample 2, of pass 0") && !run.stdout.contains("sample 1,"),
        "{}",
        run.stdout
    );
}

#[test]
fn inspect_refuses_what_is_not_there() {
    let dir = Dir::new();
    let refused = |args: &[&str], message: &str| {
        dir.run(&[&["inspect", "cornell"], PHOTONS, args].concat()).ends_with(2).says(message);
    };
    refused(
        &["--pixel", "40,2"],
        "error: pixel 40,2 is outside the picture of 40 by 30 pixels: X goes from 0 to 39, Y from 0 to 29\n",
    );
    refused(&["--pixel", "3,30"], "pixel 3,30 is outside");
    refused(
        &["--pixel", "3"],
        "error: invalid value '3' for '--pixel <X,Y>': write X,Y, the column and row of a pixel, as in 120,64\n",
    );
    refused(
        &["--pixel", "3,3", "--spp", "4", "--sample", "4"],
        "error: there is no sample 4: the pixel has 4, counted from 0\n",
    );
    refused(&[], "--pixel <X,Y>");
}

/// Shapes of groups are counted behind those of the scene, and have no place among them.
#[test]
fn scenes_of_instances_masks_and_null_surfaces_can_be_looked_into() {
    let dir = Dir::new();
    let scene = r#"<scene version="3.0.0">
            <sensor type="perspective">
                <transform name="to_world"><lookat origin="0, 0, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
                <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/></film>
            </sensor>
            <emitter type="point"><point name="position" x="1" y="2" z="3"/></emitter>
            <shape type="shapegroup" id="pair">
                <shape type="sphere" id="veil"><bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="dielectric"/></bsdf></shape>
                <shape type="cube" id="ghost"><bsdf type="null"/></shape>
            </shape>
            <shape type="instance"><ref id="pair"/></shape>
            <shape type="rectangle" id="wall">
                <transform name="to_world"><scale value="3"/><translate z="-2"/></transform>
                <bsdf type="diffuse"/>
            </shape>
        </scene>"#;
    std::fs::write(dir.path("s.xml"), scene).unwrap();
    let few = ["--photons", "300", "--caustic-photons", "300"];
    dir.run(&[&["photons", "s.xml", "-o", "p.png", "-o", "p.csv"][..], &few].concat()).ends_with(0);
    let report = dir
        .run(&[&["inspect", "s.xml", "--pixel", "12,12", "--json"][..], &few].concat())
        .ends_with(0)
        .json();
    assert!(report.to_string().contains("veil"), "{report}");
    dir.run(
        &[&["render", "s.xml", "--aov", "albedo,global,count", "--spp", "2", "-o", "a.exr"][..], &few]
            .concat(),
    )
    .ends_with(0);
    assert!(channels(&dir, "a.exr").iter().any(|(name, _)| name.contains("albedo")));
}
