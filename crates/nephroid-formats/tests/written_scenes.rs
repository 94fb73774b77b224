//! Scenes that are written as files of Mitsuba 3 and read again.

use std::cell::RefCell;
use std::path::Path;

use nephroid::math::Vec3;
use nephroid::scene::Scene;
use nephroid::shape::{Mesh, Shape};
use nephroid_formats::mitsuba::{read_scene, read_scene_str};
use nephroid_formats::mitsuba_writer::{WrittenScene, encode_mitsuba, folder_of_files, write_mitsuba};
use nephroid_formats::vfs::{DiskFiles, MemoryFiles};
use nephroid_formats::{Options, SceneFile};

/// What a scene says in words, with all that is referred to in its place, so that neither names nor the order of
/// what is stored count.
fn described(scene: &Scene) -> Vec<String> {
    let shape = |shape: &Shape| Shape { name: String::new(), ..shape.clone() };
    let mut out = vec![format!("{:?}", scene.camera), format!("{:?}", scene.film)];
    out.extend(scene.shapes.iter().map(|s| format!("{:?}", shape(s))));
    out.extend(scene.instances.iter().map(|instance| {
        let shapes: Vec<_> = scene.groups[instance.group].shapes.iter().map(shape).collect();
        format!("{:?} {shapes:?}", instance.to_world)
    }));
    out.extend(scene.lights.iter().map(|light| format!("{:?} medium: {:?}", light.kind, light.medium)));
    out.iter().map(|text| resolved(text, scene)).collect()
}

/// A text with every handle replaced by what it is of, told by the name of its field.
fn resolved(text: &str, scene: &Scene) -> String {
    let Some(at) = text.find('#') else { return text.to_owned() };
    let (before, after) = (&text[..at], &text[at + 1..]);
    let end = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
    let index: usize = after[..end].parse().expect("the number of a handle");
    let field = before.strip_suffix("Some(").unwrap_or(before).trim_end_matches([':', ' ', '(']);
    let field = field.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    let target = match field {
        "Mesh" => meshed(scene.meshes.iter().nth(index)),
        "material" | "front" | "back" | "inside" | "first" | "second" => {
            format!("{:?}", scene.materials.iter().nth(index))
        }
        "image" | "table" => format!("{:?}", scene.textures.images.iter().nth(index)),
        "grid" => {
            let grid = scene.media.grids.iter().nth(index).expect("a grid");
            format!("{:?} {:?}", grid.size, grid.values)
        }
        "interior" | "exterior" | "light" | "medium" => {
            let mut medium = scene.media.list.iter().nth(index).expect("a medium").clone();
            medium.name = String::new();
            format!("{medium:?}")
        }
        _ => format!("{:?}", scene.textures.list.iter().nth(index)),
    };
    format!("{before}{}{}", resolved(&target, scene), resolved(&after[end..], scene))
}

/// Without normals, which are compared by [`same_normals`].
fn meshed(mesh: Option<&Mesh>) -> String {
    let mut mesh = mesh.expect("a mesh").clone();
    mesh.normals = Vec::new();
    format!("{mesh:?}")
}

/// Normals are brought to unit length when they are read, which may change their last bits.
fn same_normals(before: &Scene, after: &Scene) -> bool {
    let close = |(a, b): (&Vec3, &Vec3)| a.distance(*b) < 1e-6;
    let same = |(a, b): (&Mesh, &Mesh)| {
        a.normals.len() == b.normals.len() && a.normals.iter().zip(&b.normals).all(close)
    };
    before.meshes.iter().zip(after.meshes.iter()).all(same)
}

/// The text of a scene and the files beside it.
fn written(file: &SceneFile) -> (String, MemoryFiles, WrittenScene) {
    let files = RefCell::new(MemoryFiles::default());
    let mut sink = |name: &str, bytes: Vec<u8>| {
        let more = files.take().with(name, bytes);
        files.replace(more);
        Ok(())
    };
    let (text, written) = encode_mitsuba(file, "out_files", &mut sink).expect("memory takes all");
    (text, files.into_inner(), written)
}

/// Writes a scene and reads it again; the warnings of writing it.
#[track_caller]
fn comes_back(file: &SceneFile) -> Vec<String> {
    let (text, files, written) = written(file);
    let again = read_scene_str("out.xml", &text, &files, &Options::default())
        .unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(again.warnings, [], "{text}");
    if written.warnings.is_empty() {
        let (before, after) = (described(&file.scene), described(&again.scene));
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(before, after, "\n{text}");
        }
        assert_eq!(before.len(), after.len());
        assert!(same_normals(&file.scene, &again.scene));
        assert_eq!(file.sample_count, again.sample_count);
    }
    written.warnings
}

#[track_caller]
fn read(content: &str, files: &MemoryFiles) -> SceneFile {
    let text = format!("<scene version=\"3.0.0\">\n{content}</scene>");
    read_scene_str("s.xml", &text, files, &Options::default()).unwrap_or_else(|e| panic!("{content}\n{e}"))
}

const CAMERA: &str = r#"<integrator type="path"/><sensor type="perspective"/>"#;

#[test]
fn built_in_scenes_come_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut with_warnings = Vec::new();
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|e| e == "xml")) {
        let mut file = read_scene(path, &DiskFiles, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        file.integrator.name = "path".to_owned();
        if !comes_back(&file).is_empty() {
            with_warnings.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
        }
    }
    assert_eq!(with_warnings, ["prism", "report-3-6"], "scenes with what Mitsuba lacks");
}

#[test]
fn cameras_and_films_come_back() {
    for (sensor, film) in [
        (
            r#"type="perspective"><float name="fov" value="30.1"/><string name="fov_axis" value="smaller"/>
            <float name="principal_point_offset_x" value="0.25"/>"#,
            r#"<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>"#,
        ),
        (
            r#"type="thinlens"><float name="fov" value="50"/><float name="aperture_radius" value="0.1"/>
            <float name="focus_distance" value="3"/>"#,
            r#"<integer name="crop_width" value="10"/><integer name="crop_offset_y" value="5"/>
            <integer name="crop_height" value="7"/><rfilter type="mitchell"/>"#,
        ),
        (r#"type="orthographic">"#, r#"<rfilter type="box"/>"#),
    ] {
        let file = read(
            &format!(
                r#"<integrator type="path"/><sensor {sensor}<transform name="to_world">
                <rotate y="1" x="0.3" angle="33.3"/><translate z="-4"/></transform>
                <sampler type="independent"><integer name="sample_count" value="7"/></sampler>
                <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/>{film}</film>
                </sensor>"#
            ),
            &MemoryFiles::default(),
        );
        assert_eq!(comes_back(&file), Vec::<String>::new());
    }
}

#[test]
fn materials_and_textures_come_back() {
    let png = nephroid_formats::image::encode_png(&nephroid::texture::Image {
        width: 2,
        height: 1,
        pixels: vec![nephroid::color::Rgb::new(0.0, 0.2, 1.0), nephroid::color::Rgb::splat(0.6)],
    });
    let files = MemoryFiles::default().with("a.png", png.expect("a picture"));
    let file = read(
        &format!(
            r#"{CAMERA}<texture type="bitmap" id="t"><string name="filename" value="a.png"/>
        <string name="filter_type" value="nearest"/><string name="wrap_mode" value="mirror"/>
        <transform name="to_uv"><scale x="2" y="3"/><translate x="0.1" y="0.7"/></transform></texture>
        <texture type="checkerboard" id="c"><ref name="color0" id="t"/><rgb name="color1" value="0.1, 0.2, 0.3"/>
        <transform name="to_uv"><rotate z="1" angle="30"/></transform></texture>
        <bsdf type="twosided" id="a"><bsdf type="diffuse"><ref name="reflectance" id="c"/></bsdf>
        <bsdf type="conductor"><string name="material" value="Au"/></bsdf></bsdf>
        <bsdf type="mask" id="b"><ref name="opacity" id="t"/><bsdf type="dielectric">
        <float name="int_ior" value="1.33"/><rgb name="specular_transmittance" value="0.9, 1, 0.5"/></bsdf></bsdf>
        <bsdf type="thindielectric" id="d"/><bsdf type="conductor" id="e"/><bsdf type="null" id="f"/>
        <shape type="sphere"><ref id="a"/><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.3"/></shape>
        <shape type="rectangle"><ref id="b"/><boolean name="flip_normals" value="true"/></shape>
        <shape type="disk"><ref id="d"/></shape><shape type="cube"><ref id="e"/></shape>
        <shape type="cylinder"><ref id="f"/><point name="p1" x="1" y="1" z="1"/></shape>
        <shape type="sphere"><emitter type="area"><ref name="radiance" id="c"/></emitter></shape>
        <shape type="sphere"><emitter type="area"><rgb name="radiance" value="7, 8, 9"/></emitter></shape>"#
        ),
        &files,
    );
    assert_eq!(comes_back(&file), Vec::<String>::new());
}

#[test]
fn rough_and_layered_materials_come_back() {
    let grey = nephroid_formats::image::encode_png(&nephroid::texture::Image::filled(
        2,
        2,
        nephroid::color::Rgb::splat(0.6),
    ));
    let files = MemoryFiles::default().with("a.png", grey.expect("a picture"));
    let map = r#"<texture type="bitmap" name="normalmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture>"#;
    let materials = [
        r#"<bsdf type="roughconductor"><string name="material" value="Cu"/><string name="distribution" value="ggx"/>
        <float name="alpha_u" value="0.2"/><float name="alpha_v" value="0.05"/></bsdf>"#.to_owned(),
        format!(r#"<bsdf type="roughconductor">{}</bsdf>"#, map.replace("normalmap", "alpha")),
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0.3"/><float name="int_ior" value="1.7"/></bsdf>"#.to_owned(),
        r#"<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1, 0.2, 0.3"/><boolean name="nonlinear" value="true"/></bsdf>"#.to_owned(),
        r#"<bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.2"/></bsdf>"#.to_owned(),
        r#"<bsdf type="principled"><rgb name="base_color" value="0.9, 0.2, 0.3"/><float name="roughness" value="0.3"/>
        <float name="metallic" value="0.4"/><float name="clearcoat" value="0.7"/><float name="eta" value="1.6"/></bsdf>"#.to_owned(),
        r#"<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="conductor"/></bsdf>"#.to_owned(),
        format!(r#"<bsdf type="normalmap">{map}<bsdf type="diffuse"/></bsdf>"#),
        format!(r#"<bsdf type="bumpmap">{map}<float name="scale" value="0.2"/><bsdf type="diffuse"/></bsdf>"#),
    ];
    let shapes: String = materials.iter().map(|m| format!("<shape type=\"sphere\">{m}</shape>\n")).collect();
    let file = read(&format!("{CAMERA}{shapes}"), &files);
    assert_eq!(comes_back(&file), Vec::<String>::new());
}

#[test]
fn products_of_textures_are_baked() {
    let grey = nephroid_formats::image::encode_png(&nephroid::texture::Image::filled(
        2,
        2,
        nephroid::color::Rgb::splat(0.6),
    ));
    let files = MemoryFiles::default().with("a.png", grey.expect("a picture"));
    let file = read(
        &format!(
            r#"{CAMERA}<shape type="sphere"><bsdf type="diffuse"><texture type="scale" name="reflectance">
            <rgb name="scale" value="0.5, 1, 0.25"/><texture type="bitmap"><string name="filename" value="a.png"/>
            <transform name="to_uv"><scale x="3" y="2"/></transform></texture></texture></bsdf></shape>"#
        ),
        &files,
    );
    let (text, files, written) = written(&file);
    assert_eq!(written.warnings, Vec::<String>::new());
    let again =
        read_scene_str("out.xml", &text, &files, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let value = |file: &SceneFile| {
        let material = &file.scene.materials[file.scene.shapes[0].material];
        let nephroid::material::Material::Diffuse { reflectance } = *material else { panic!("{material:?}") };
        file.scene.textures.eval(reflectance, nephroid::math::Vec2::new(0.3, 0.7))
    };
    assert_eq!(value(&file), value(&again), "{text}");
}

#[test]
fn meshes_instances_lights_and_media_come_back() {
    let obj =
        "v 0 0 0\nv 1 0 0\nv 0 1 0.3\nv 1 1 0\nvt 0 0.25\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nf 2/2 4/1 3/3\n";
    let mut vol = b"VOL\x03".to_vec();
    vol.extend([1i32, 1, 1, 2, 1].iter().flat_map(|v| v.to_le_bytes()));
    vol.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0, 7.0, 0.1].iter().flat_map(|v| v.to_le_bytes()));
    let files = MemoryFiles::default().with("a.obj", obj).with("a.vol", vol);
    let file = read(
        &format!(
            r#"{CAMERA}<medium type="heterogeneous" id="smoke"><float name="scale" value="3"/>
        <volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/>
        <transform name="to_world"><translate x="2"/></transform></volume><rgb name="albedo" value="0.5, 0.6, 0.7"/>
        <phase type="hg"><float name="g" value="-0.4"/></phase></medium>
        <medium type="homogeneous" id="mist"><rgb name="sigma_t" value="1, 2, 3"/><phase type="rayleigh"/></medium>
        <shape type="shapegroup" id="g"><shape type="obj"><string name="filename" value="a.obj"/>
        <transform name="to_world"><scale value="0.7"/></transform><ref name="interior" id="mist"/><bsdf type="null"/></shape>
        <shape type="obj"><string name="filename" value="a.obj"/><boolean name="face_normals" value="true"/></shape></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world"><scale x="2"/><translate y="0.1"/></transform></shape>
        <shape type="instance"><ref id="g"/></shape>
        <shape type="cube"><ref name="interior" id="smoke"/><ref name="exterior" id="mist"/><bsdf type="null"/></shape>
        <emitter type="point"><point name="position" x="1" y="2" z="3"/><ref id="mist"/></emitter>
        <emitter type="spot"><float name="cutoff_angle" value="33"/><texture name="texture" type="checkerboard"/>
        <transform name="to_world"><lookat origin="1, 2, 3" target="0, 0, 0" up="0, 1, 0"/></transform></emitter>
        <emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/></emitter>
        <emitter type="constant"><rgb name="radiance" value="0.1, 0.2, 0.4"/></emitter>"#
        ),
        &files,
    );
    assert_eq!(comes_back(&file), Vec::<String>::new());
}

#[test]
fn what_mitsuba_lacks_is_told() {
    let sensor = r#"<integrator type="photonmapper"/><sensor type="perspective"/>"#;
    let file = read(
        &format!(
            r#"{sensor}<medium type="homogeneous" id="mist"><float name="ambient" value="0.1"/></medium>
        <shape type="plane" id="floor"><bsdf type="phong"/></shape>
        <shape type="sphere" id="glass.1"><bsdf type="dielectric"/><integer name="priority" value="1"/>
        <ref name="interior" id="mist"/></shape>"#
        ),
        &MemoryFiles::default(),
    );
    assert_eq!(
        comes_back(&file),
        [
            "Mitsuba has no integrator \"photonmapper\": \"volpath\" stands for it",
            "mist: Mitsuba knows no ambient light of media",
            "Mitsuba 3 has no Phong lobe: a blend with a rough metal stands for it",
            "floor: a plane without end becomes a large rectangle",
            "glass.1: Mitsuba has no priorities of overlapping shapes",
        ]
    );
}

#[test]
fn a_scene_and_its_files_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = MemoryFiles::default().with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let file = read(
        &format!(r#"{CAMERA}<shape type="obj"><string name="filename" value="a.obj"/></shape>"#),
        &files,
    );
    let path = folder.path().join("my $cene.1.xml");
    assert_eq!(folder_of_files(&path), "my__cene_1_files");
    let written = write_mitsuba(&path, &file).expect("it can be written");
    assert_eq!(written.files, ["my__cene_1_files/mesh-0.ply"]);
    let again = read_scene(&path, &DiskFiles, &Options::default()).expect("it can be read");
    assert_eq!(described(&file.scene), described(&again.scene));
    let nowhere = folder.path().join("none/a.xml");
    let error = write_mitsuba(&nowhere, &file).expect_err("there is no folder").to_string();
    assert!(error.contains("cannot be written: there is no folder"), "{error}");
    std::fs::write(folder.path().join("b_files"), "a file").expect("it can be written");
    let error = write_mitsuba(&folder.path().join("b.xml"), &file).expect_err("no folder can be made");
    assert!(error.to_string().contains("b_files: cannot be written"), "{error}");
    assert!(!folder.path().join("b.xml").exists());
}
