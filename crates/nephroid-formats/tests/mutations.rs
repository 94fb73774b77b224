//! Random damage to good files must never end in a panic.

use nephroid::medium::GridValues;
use nephroid_formats::Options;
use nephroid_formats::mesh::{MeshOptions, read_obj, read_ply};
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::volume::read_vol;
use proptest::prelude::*;

const SCENE: &str = r##"<scene version="3.0.0">
<default name="spp" value="4"/><default name="albedo" value="0.5"/>
<integrator type="moment"><integrator type="path"><integer name="max_depth" value="3"/></integrator></integrator>
<sensor type="perspective"><float name="fov" value="40"/><string name="fov_axis" value="smaller"/>
<transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
<film type="hdrfilm"><integer name="width" value="16"/><integer name="crop_width" value="8"/><rfilter type="box"/></film></sensor>
<bsdf type="twosided" id="red"><bsdf type="diffuse"><rgb name="reflectance" value="$albedo, 0.1 0.1"/></bsdf></bsdf>
<texture type="checkerboard" id="board"><rgb name="color0" value="#102030"/><transform name="to_uv"><scale value="3"/></transform></texture>
<shape type="rectangle" id="floor"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform><ref id="red"/></shape>
<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="1e-3"/>
<bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>
<emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/></emitter></shape>
<shape type="obj"><string name="filename" value="m.obj"/><bsdf type="mask"><bsdf type="diffuse"><ref name="reflectance" id="board"/></bsdf></bsdf></shape>
<include filename="part.xml"/>
<shape type="shapegroup" id="pair"><shape type="cube"/><shape type="disk"><ref id="red"/></shape></shape>
<shape type="instance"><ref id="pair"/><transform name="to_world"><translate x="2"/></transform></shape>
<emitter type="directional"><vector name="direction" value="0 -1 0"/></emitter>
</scene>"##;

const FOG: &str = r##"<scene version="3.0.0"><sensor type="perspective"><ref id="fog"/></sensor>
<volume type="gridvolume" id="grid"><string name="filename" value="v.vol"/><boolean name="use_grid_bbox" value="true"/>
<string name="wrap_mode" value="clamp"/><transform name="to_world"><scale value="2"/></transform></volume>
<medium type="homogeneous" id="fog"><rgb name="sigma_s" value="1, 2, 3"/><float name="sigma_a" value="0.5"/>
<float name="scale" value="2"/><phase type="hg"><float name="g" value="0.5"/></phase></medium>
<medium type="heterogeneous" id="smoke"><ref name="sigma_t" id="grid"/><rgb name="ambient" value="0.1"/>
<volume name="albedo" type="constvolume"><rgb name="value" value="0.9"/></volume><phase type="rayleigh"/></medium>
<shape type="cube"><bsdf type="null"/><ref name="interior" id="smoke"/><ref name="exterior" id="fog"/>
<integer name="priority" value="1"/></shape>
<shape type="disk"><emitter type="area"><ref id="fog"/></emitter></shape>
<emitter type="point"><ref id="fog"/></emitter></scene>"##;

const LEGACY: &str = r##"<scene version="0.5.0"><integrator type="volpath"><integer name="maxDepth" value="-1"/>
<integer name="version" value="6"/></integrator><sensor type="perspective"><string name="fovAxis" value="x"/>
<transform name="toWorld"><lookAt origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<medium type="heterogeneous" id="smoke"><volume name="density" type="gridvolume">
<string name="filename" value="v.vol"/></volume><float name="stepSize" value="0.1"/></medium>
<shape type="sphere"><ref name="interior" id="smoke"/></shape>
<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"><float name="uscale" value="3"/></texture></bsdf>
<emitter type="point"><spectrum name="intensity" value="1, 2, 3"/></emitter></scene>"##;

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvn 0 0 1\nf 1/1/1 2//1 -2/1 4\n";

const PLY: &str = "ply\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nproperty float u\nproperty float v\nelement face 1\n\
    property list uchar int vertex_index\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";

fn binary_ply() -> Vec<u8> {
    let mut out = PLY[..PLY.find("0 0 0").expect("a first vertex")]
        .replace("ascii", "binary_little_endian")
        .into_bytes();
    for v in [0.0f32, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0] {
        out.extend(v.to_le_bytes());
    }
    out.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    out
}

/// Two cells of three values each.
fn vol() -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 2, 1, 1, 3].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([0.0f32, 0.0, 0.0, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([0.5f32; 6].iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// What is done to a file, places being fractions of its length.
#[derive(Clone, Debug)]
enum Damage {
    Overwrite(f64, u8),
    Delete(f64, usize),
    Copy(f64, f64, usize),
    Insert(f64, &'static str),
    Cut(f64),
}

fn damage() -> impl Strategy<Value = Damage> {
    let words = prop::sample::select(vec![
        "-1",
        "0",
        "1e39",
        "nan",
        "$",
        "\"",
        "<",
        ">",
        "/>",
        "999999999999",
        "red",
        "board",
        "type=\"mask\"",
        "é",
        "\0",
        "<ref id=\"red\"/>",
        "<ref id=\"floor\"/>",
        "<include filename=\"s.xml\"/>",
        "<ref name=\"interior\" id=\"fog\"/>",
        "<ref id=\"grid\"/>",
        "#",
        ":",
        "4294967295 ",
    ]);
    prop_oneof![
        (0.0..1.0, any::<u8>()).prop_map(|(at, byte)| Damage::Overwrite(at, byte)),
        (0.0..1.0, 1usize..30).prop_map(|(at, n)| Damage::Delete(at, n)),
        (0.0..1.0, 0.0..1.0, 1usize..200).prop_map(|(from, to, n)| Damage::Copy(from, to, n)),
        (0.0..1.0, words).prop_map(|(at, word)| Damage::Insert(at, word)),
        (0.0..1.0).prop_map(Damage::Cut),
    ]
}

fn damaged(bytes: &[u8], damages: &[Damage]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for damage in damages {
        let length = out.len();
        let place = |at: &f64| (at * length as f64) as usize;
        match damage {
            Damage::Overwrite(at, byte) if length > 0 => out[place(at)] = *byte,
            Damage::Overwrite(..) => {}
            Damage::Delete(at, n) => drop(out.drain(place(at)..(place(at) + n).min(length))),
            Damage::Copy(from, to, n) => {
                let piece = out[place(from)..(place(from) + n).min(length)].to_vec();
                out.splice(place(to)..place(to), piece);
            }
            Damage::Insert(at, word) => drop(out.splice(place(at)..place(at), word.bytes())),
            Damage::Cut(at) if *at > 0.7 => out.truncate(place(at)),
            Damage::Cut(_) => {}
        }
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 20_000,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn damaged_scenes(damages in prop::collection::vec(damage(), 1..6), lenient: bool) {
        let text = String::from_utf8_lossy(&damaged(SCENE.as_bytes(), &damages)).into_owned();
        let files = MemoryFiles::default()
            .with("m.obj", OBJ)
            .with("part.xml", "<scene version=\"2.0.0\"><emitter type=\"constant\"/></scene>")
            .with("s.xml", text.as_str());
        match read_scene_str("s.xml", &text, &files, &Options { defines: Vec::new(), lenient }) {
            Ok(file) => prop_assert!(file.warnings.iter().all(|w| !w.render(false).is_empty())),
            Err(diagnostics) => {
                prop_assert!(!diagnostics.0.is_empty());
                prop_assert!(!diagnostics.render(true).is_empty());
            }
        }
    }

    #[test]
    fn damaged_media(
        damages in prop::collection::vec(damage(), 1..6),
        file_damages in prop::collection::vec(damage(), 0..2),
        legacy: bool,
        lenient: bool,
    ) {
        let scene = if legacy { LEGACY } else { FOG };
        let text = String::from_utf8_lossy(&damaged(scene.as_bytes(), &damages)).into_owned();
        let files = MemoryFiles::default().with("v.vol", damaged(&vol(), &file_damages));
        match read_scene_str("s.xml", &text, &files, &Options { defines: Vec::new(), lenient }) {
            Ok(file) => {
                let media = &file.scene.media;
                prop_assert_eq!(media.list.len(), file.origins.media.len());
                prop_assert_eq!(media.grids.len(), file.origins.grids.len());
            }
            Err(diagnostics) => prop_assert!(!diagnostics.render(true).is_empty()),
        }
    }

    #[test]
    fn damaged_volumes(damages in prop::collection::vec(damage(), 1..5)) {
        if let Ok(file) = read_vol(&damaged(&vol(), &damages)) {
            let cells = file.size.iter().product::<u32>() as usize;
            match file.values {
                GridValues::Grey(values) => prop_assert_eq!(values.len(), cells),
                GridValues::Rgb(values) => prop_assert_eq!(values.len(), cells),
            }
        }
    }

    #[test]
    fn damaged_meshes(damages in prop::collection::vec(damage(), 1..5), face_normals: bool) {
        let options = MeshOptions { face_normals, flip_tex_coords: true };
        for mesh in [
            read_obj(&damaged(OBJ.as_bytes(), &damages), options),
            read_ply(&damaged(PLY.as_bytes(), &damages), options),
            read_ply(&damaged(&binary_ply(), &damages), options),
        ].into_iter().flatten().map(|file| file.mesh) {
            let count = mesh.positions.len();
            prop_assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < count));
            prop_assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
            prop_assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
            prop_assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
        }
    }
}

#[test]
fn undamaged_files_can_be_read() {
    let files = MemoryFiles::default()
        .with("m.obj", OBJ)
        .with("part.xml", "<scene version=\"2.0.0\"><emitter type=\"constant\"/></scene>");
    read_scene_str("s.xml", SCENE, &files, &Options::default()).unwrap();
    for scene in [FOG, LEGACY] {
        let files = MemoryFiles::default().with("v.vol", vol());
        read_scene_str("s.xml", scene, &files, &Options::default()).unwrap();
    }
    read_vol(&vol()).unwrap();
    read_ply(PLY.as_bytes(), MeshOptions::default()).unwrap();
    read_ply(&binary_ply(), MeshOptions::default()).unwrap();
}
