//! Media of scenes that can be read, and what becomes of them.

use nephroid::color::Rgb;
use nephroid::material::Material;
use nephroid::math::{Transform, Vec3};
use nephroid::medium::{Coefficient, GridValues, Medium, Phase};
use nephroid::scene::Scene;
use nephroid_formats::diagnostic::Location;
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::{Options, SceneFile};

/// 2 × 1 × 1 cells with 1 and 3 in them, in a box from (−1, 0, 0) to (1, 4, 8).
fn grey_vol() -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 2, 1, 1, 1].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([-1.0f32, 0.0, 0.0, 1.0, 4.0, 8.0, 1.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// One red cell, and a box that is inside out.
fn red_vol() -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 1, 1, 1, 3].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([1.0f32, 1.0, 1.0, 0.0, 0.0, 0.0, 0.9, 0.1, 0.2].iter().flat_map(|v| v.to_le_bytes()));
    out
}

fn read_text(text: &str, lenient: bool) -> SceneFile {
    let files = MemoryFiles::default().with("grey.vol", grey_vol()).with("red.vol", red_vol());
    let options = Options { defines: Vec::new(), lenient };
    read_scene_str("s.xml", text, &files, &options).unwrap_or_else(|e| panic!("{text}\n{e}"))
}

fn read(content: &str) -> SceneFile {
    let text = format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\n{content}</scene>");
    let file = read_text(&text, false);
    assert_eq!(file.warnings, [], "{content}");
    file
}

fn warnings(file: &SceneFile) -> Vec<String> {
    file.warnings.iter().map(ToString::to_string).collect()
}

fn only_medium(scene: &Scene) -> &Medium {
    assert_eq!(scene.media.list.len(), 1);
    scene.media.list.iter().next().expect("a medium")
}

/// A homogeneous medium with these properties.
fn homogeneous(properties: &str) -> Medium {
    let file = read(&format!("<medium type=\"homogeneous\" id=\"fog\">{properties}</medium>"));
    only_medium(&file.scene).clone()
}

fn constant(coefficient: &Coefficient) -> [f32; 3] {
    match coefficient {
        Coefficient::Constant(value) => value.to_array(),
        other => panic!("{other:?}"),
    }
}

/// Value in the first cell, scale and map of a grid.
fn grid(scene: &Scene, coefficient: &Coefficient) -> (Rgb, f32, Transform) {
    match coefficient {
        Coefficient::Grid { grid, to_world, scale } => {
            let value = match &scene.media.grids[*grid].values {
                GridValues::Grey(values) => Rgb::splat(values[0]),
                GridValues::Rgb(values) => values[0],
            };
            (value, *scale, *to_world)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_medium_without_properties_has_mitsubas() {
    let fog = homogeneous("");
    let expected = Medium::homogeneous("fog", Rgb::WHITE, Rgb::splat(0.75), Phase::Isotropic);
    assert_eq!(fog, expected);
    let file = read("<medium type=\"heterogeneous\"/>");
    assert_eq!(only_medium(&file.scene).name, "heterogeneous at line 2");
}

#[test]
fn values_of_every_kind() {
    let fog = homogeneous(
        r#"<float name="sigma_t" value="2"/><rgb name="albedo" value="0.9, 0.5, 0.1"/><float name="scale" value="3"/>
        <rgb name="emission" value="4"/><rgb name="ambient" value="1 2 3"/>
        <boolean name="sample_emitters" value="false"/><boolean name="has_spectral_extinction" value="false"/>
        <float name="majorant_factor" value="2"/>"#,
    );
    assert_eq!((constant(&fog.sigma_t), constant(&fog.albedo)), ([6.0; 3], [0.9, 0.5, 0.1]));
    // The scale is one of the extinction alone.
    assert_eq!((constant(&fog.emission), fog.ambient), ([4.0; 3], Rgb::new(1.0, 2.0, 3.0)));
    let fog = homogeneous(
        r#"<volume name="sigma_t" type="constvolume"><rgb name="value" value="5, 6, 7"/></volume>
        <spectrum name="albedo" value="0.25"/>"#,
    );
    assert_eq!((constant(&fog.sigma_t), constant(&fog.albedo)), ([5.0, 6.0, 7.0], [0.25; 3]));
    // Other than reflectances, extinctions are not clamped to 1.
    let fog = homogeneous(r#"<spectrum name="sigma_t" value="300:9, 900:9"/>"#);
    assert!(constant(&fog.sigma_t).iter().all(|v| (v - 9.0).abs() < 0.01));
}

#[test]
fn scattering_and_absorption_become_extinction_and_albedo() {
    let fog = homogeneous(
        r#"<rgb name="sigma_s" value="1, 3, 0"/><rgb name="sigma_a" value="3, 1, 0"/><float name="scale" value="0.5"/>"#,
    );
    assert_eq!((constant(&fog.sigma_t), constant(&fog.albedo)), ([2.0, 2.0, 0.0], [0.25, 0.75, 0.0]));
}

#[test]
fn phase_functions() {
    let phase = |text: &str| homogeneous(text).phase;
    assert_eq!(phase(r#"<phase type="isotropic"/>"#), Phase::Isotropic);
    assert_eq!(phase(r#"<phase type="rayleigh"/>"#), Phase::Rayleigh);
    assert_eq!(phase(r#"<phase type="hg"/>"#), Phase::HenyeyGreenstein { g: 0.8 });
    let back = r#"<phase type="hg" name="phase"><float name="g" value="-0.5"/></phase>"#;
    assert_eq!(phase(back), Phase::HenyeyGreenstein { g: -0.5 });
    let file = read(
        r#"<phase type="rayleigh" id="p"/><medium type="homogeneous"><ref id="p"/></medium>
        <medium type="homogeneous"><ref name="phase" id="p"/></medium>"#,
    );
    assert!(file.scene.media.list.iter().all(|medium| medium.phase == Phase::Rayleigh));
}

#[test]
fn grids_fill_their_own_box_or_the_unit_cube() {
    let file = read(
        r#"<medium type="heterogeneous"><float name="scale" value="5"/>
        <volume name="sigma_t" type="gridvolume"><string name="filename" value="grey.vol"/>
            <boolean name="use_grid_bbox" value="true"/><boolean name="raw" value="true"/>
            <transform name="to_world"><translate x="10"/></transform></volume>
        <volume name="albedo" type="gridvolume"><string name="filename" value="red.vol"/>
            <string name="filter_type" value="trilinear"/><string name="wrap_mode" value="clamp"/>
            <transform name="to_world"><scale value="2"/></transform></volume></medium>"#,
    );
    let medium = only_medium(&file.scene);
    let (value, scale, to_world) = grid(&file.scene, &medium.sigma_t);
    assert_eq!((value, scale), (Rgb::WHITE, 5.0));
    // First into the box, then as the volume says.
    assert_eq!(to_world.point(Vec3::ZERO), Vec3::new(9.0, 0.0, 0.0));
    assert_eq!(to_world.point(Vec3::ONE), Vec3::new(11.0, 4.0, 8.0));
    let (value, scale, to_world) = grid(&file.scene, &medium.albedo);
    assert_eq!((value, scale), (Rgb::new(0.9, 0.1, 0.2), 1.0));
    assert_eq!(to_world.point(Vec3::ONE), Vec3::splat(2.0));
}

#[test]
fn a_grid_is_stored_once() {
    let file = read(
        r#"<volume type="gridvolume" id="v"><string name="filename" value="grey.vol"/></volume>
        <medium type="heterogeneous" id="a"><ref name="sigma_t" id="v"/><ref name="albedo" id="v"/></medium>
        <medium type="heterogeneous" id="b"><volume name="sigma_t" type="gridvolume">
            <string name="filename" value="grey.vol"/></volume></medium>"#,
    );
    let scene = &file.scene;
    assert_eq!((scene.media.list.len(), scene.media.grids.len()), (2, 1));
    assert_eq!(scene.media.grids.iter().next().expect("a grid").name, "grey.vol");
    assert_eq!(file.origins.media.iter().map(Location::line).collect::<Vec<_>>(), [3, 4]);
    assert_eq!(file.origins.grids.iter().map(Location::text).collect::<Vec<_>>(), ["grey.vol"]);
}

#[test]
fn shapes_lights_and_sensors_name_media() {
    let text = r#"<scene version="3.0.0"><sensor type="perspective"><ref id="fog"/></sensor>
        <emitter type="point"><ref id="fog"/></emitter>
        <emitter type="spot"><medium type="homogeneous" id="mist"/></emitter>
        <shape type="sphere" id="outer"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
        <shape type="sphere" id="inner"><bsdf type="dielectric"/><ref name="exterior" id="fog"/>
            <medium name="interior" type="homogeneous" id="milk"/><integer name="priority" value="2"/></shape>
        <shape type="disk" id="lamp"><emitter type="area"><ref name="medium" id="fog"/></emitter></shape>
        <shape type="shapegroup" id="g"><shape type="cube"><bsdf type="null"/><ref name="interior" id="milk"/></shape></shape>
        <shape type="instance"><ref id="g"/></shape>
        <medium type="homogeneous" id="fog"/></scene>"#;
    let file = read_text(text, false);
    assert_eq!(file.warnings, []);
    let scene = &file.scene;
    let name = |handle: Option<_>| handle.map(|medium| scene.media.list[medium].name.as_str());
    assert_eq!(name(scene.camera.medium), Some("fog"));
    assert_eq!([0, 1].map(|i| name(scene.lights[i].medium)), [Some("fog"), Some("mist")]);
    let sides = |i: usize| {
        let b = scene.shapes[i].boundary;
        (name(b.interior), name(b.exterior), name(b.light), b.priority)
    };
    assert_eq!(sides(0), (Some("fog"), None, None, None));
    assert_eq!(sides(1), (Some("milk"), Some("fog"), None, Some(2)));
    assert_eq!(sides(2), (None, None, Some("fog"), None));
    let group = scene.groups.iter().next().expect("a group");
    assert_eq!(name(group.shapes[0].boundary.interior), Some("milk"));
    assert_eq!(scene.media.list.len(), 3);
}

#[test]
fn a_boundary_without_a_material_is_opaque_and_said_to_be() {
    let text = r#"<scene version="2.0.0"><sensor type="perspective"/><shape type="sphere">
        <medium name="interior" type="homogeneous"/></shape></scene>"#;
    let file = read_text(text, false);
    assert_eq!(
        warnings(&file),
        [
            "s.xml:1:65: warning: the shape bounds a medium but names no material, and so lets no light through; \
          <bsdf type=\"null\"/> does"
        ]
    );
    let scene = &file.scene;
    assert!(matches!(scene.materials[scene.shapes[0].material], Material::Diffuse { .. }));
}

#[test]
fn nearest_kin() {
    let text = r#"<scene version="3.0.0"><sensor type="perspective"/>
<medium type="heterogeneous"><phase type="sggx"><float name="S" value="1"/></phase>
<volume name="sigma_t" type="gridvolume"><string name="filename" value="grey.vol"/>
<string name="filter_type" value="nearest"/><string name="wrap_mode" value="mirror"/></volume>
<float name="step_size" value="1"/></medium></scene>"#;
    let file = read_text(text, true);
    assert_eq!(
        warnings(&file),
        [
            "s.xml:4:35: warning: filter_type \"nearest\" cannot be had yet; \"trilinear\" stands for it",
            "s.xml:4:77: warning: wrap_mode \"mirror\" cannot be had yet; \"clamp\" stands for it",
            "s.xml:2:43: warning: phase \"sggx\" cannot be rendered yet; \"isotropic\" stands for it",
            "s.xml:5:32: warning: \"step_size\" means nothing in <medium type=\"heterogeneous\">",
        ]
    );
    assert_eq!(only_medium(&file.scene).phase, Phase::Isotropic);
}

#[test]
fn values_below_zero_become_zero() {
    let mut bytes = grey_vol();
    let last = bytes.len() - 4;
    bytes[last..].copy_from_slice(&(-1e-20f32).to_le_bytes());
    let text = r#"<scene version="3.0.0"><sensor type="perspective"/><medium type="heterogeneous" id="m">
<volume name="sigma_t" type="gridvolume"><string name="filename" value="low.vol"/></volume></medium></scene>"#;
    let files = MemoryFiles::default().with("low.vol", bytes);
    let file = read_scene_str("s.xml", text, &files, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(warnings(&file)[0], "s.xml:2:73: warning: low.vol: 1 values below zero become zero");
    assert_eq!(
        file.scene.media.grids.iter().next().expect("a grid").values,
        GridValues::Grey(vec![1.0, 0.0])
    );
}
