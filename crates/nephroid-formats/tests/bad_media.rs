//! Media that must be refused, and the messages a user sees. Where a message changes on purpose, change it
//! here.

use nephroid_formats::Options;
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;

/// One cell with `value` in it and an upper corner of the box at (`end`, 1, 1).
fn vol(value: f32, end: f32) -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 1, 1, 1, 1].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([0.0f32, 0.0, 0.0, end, 1.0, 1.0, value].iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// The messages about a scene with a camera, whose other content starts in the second line.
#[track_caller]
fn check(content: &str, expected: &str) {
    let files = MemoryFiles::default()
        .with("good.vol", vol(1.0, 1.0))
        .with("infinite.vol", vol(f32::INFINITY, 1.0))
        .with("flat.vol", vol(1.0, 0.0))
        .with("short.vol", &vol(1.0, 1.0)[..50])
        .with("text.vol", "density");
    let text = format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\n{content}</scene>");
    let messages = match read_scene_str("s.xml", &text, &files, &Options::default()) {
        Ok(_) => String::new(),
        Err(diagnostics) => diagnostics.to_string(),
    };
    assert_eq!(messages, expected, "\n{text}");
}

#[test]
fn unknown_names() {
    check(
        r#"<medium type="homogenous"/>"#,
        r#"s.xml:2:15: error: unknown medium "homogenous"; did you mean "homogeneous"?"#,
    );
    check(
        r#"<medium type="fog"/>"#,
        r#"s.xml:2:15: error: unknown medium "fog"; known are homogeneous, heterogeneous"#,
    );
    check(
        r#"<medium type="homogeneous"><float name="sigmat" value="1"/></medium>"#,
        r#"s.xml:2:41: error: <medium type="homogeneous"> has no property "sigmat"; did you mean "sigma_t"?"#,
    );
    check(
        r#"<medium type="homogeneous"><phase type="isotopic"/></medium>"#,
        r#"s.xml:2:41: error: unknown phase "isotopic"; did you mean "isotropic"?"#,
    );
    check(
        r#"<medium type="heterogeneous"><volume name="sigma_t" type="gridvolum"/></medium>"#,
        r#"s.xml:2:59: error: unknown volume "gridvolum"; did you mean "gridvolume"?"#,
    );
    check(
        r#"<medium type="homogeneous"><phase type="hg"><float name="G" value="1"/></phase></medium>"#,
        r#"s.xml:2:58: error: <phase type="hg"> has no property "G"; did you mean "g"?"#,
    );
    check(
        r#"<shape type="sphere"><ref name="interior" id="fgo"/></shape><medium type="homogeneous" id="fog"/>"#,
        r#"s.xml:2:47: error: nothing has the id "fgo"; did you mean "fog"?"#,
    );
}

#[test]
fn values_of_the_wrong_kind() {
    check(
        r#"<medium type="homogeneous"><string name="sigma_t" value="thick"/></medium>"#,
        r#"s.xml:2:58: error: "sigma_t" must be a colour or texture, not a string"#,
    );
    check(
        r#"<medium type="homogeneous"><texture name="albedo" type="checkerboard"/></medium>"#,
        r#"s.xml:2:28: error: "albedo" must be one colour, not a texture"#,
    );
    check(
        r#"<medium type="homogeneous"><float name="scale" value="-1"/></medium>"#,
        r#"s.xml:2:55: error: "scale" must not be negative, not -1"#,
    );
    check(
        r#"<medium type="homogeneous"><phase type="hg"><float name="g" value="1"/></phase></medium>"#,
        r#"s.xml:2:68: error: "g" must be between -1 and 1, not 1"#,
    );
    check(
        r#"<medium type="homogeneous"><phase type="hg"/><phase type="hg"/></medium>"#,
        "s.xml:2:46: error: <medium> takes one <phase>",
    );
    check(
        r#"<medium type="homogeneous" id="m"><ref id="m"/></medium>"#,
        r#"s.xml:2:44: error: <medium> has no place in <medium type="homogeneous">"#,
    );
}

#[test]
fn coefficients_that_do_not_go_together() {
    check(
        r#"<medium type="homogeneous"><rgb name="sigma_s" value="1"/></medium>"#,
        r#"s.xml:2:15: error: "sigma_s" needs "sigma_a" beside it"#,
    );
    check(
        r#"<medium type="homogeneous"><rgb name="sigma_s" value="1"/><rgb name="sigma_a" value="1"/>
<rgb name="sigma_t" value="1"/></medium>"#,
        r#"s.xml:3:28: error: give either "sigma_s" and "sigma_a" or "sigma_t" and "albedo""#,
    );
    check(
        r#"<medium type="homogeneous"><string name="material" value="skimmilk"/></medium>"#,
        r#"s.xml:2:59: error: the coefficients of "skimmilk" are not known here; write them: <rgb name="sigma_s" value="…"/> and <rgb name="sigma_a" value="…"/>, scattering and absorption per length"#,
    );
    check(
        r#"<medium type="homogeneous"><volume name="sigma_t" type="gridvolume"><string name="filename" value="good.vol"/></volume></medium>"#,
        r#"s.xml:2:28: error: "sigma_t" of a homogeneous medium is the same everywhere; write type="heterogeneous""#,
    );
}

#[test]
fn what_cannot_be_rendered_yet() {
    check(
        r#"<medium type="heterogeneous"><volume name="sigma_t" type="openvdb"/></medium>"#,
        r#"s.xml:2:59: error: a medium with the volume "openvdb" cannot be rendered yet; --lenient leaves it out"#,
    );
    check(
        r#"<medium type="homogeneous"><phase type="sggx"/></medium>"#,
        r#"s.xml:2:41: error: phase "sggx" cannot be rendered yet; --lenient takes "isotropic" in its place"#,
    );
}

#[test]
fn broken_grids() {
    let grid = |name: &str, more: &str| {
        format!(
            "<medium type=\"heterogeneous\"><volume name=\"sigma_t\" type=\"gridvolume\">\n\
             <string name=\"filename\" value=\"{name}\"/>{more}</volume></medium>"
        )
    };
    check(
        r#"<medium type="heterogeneous"><volume name="sigma_t" type="gridvolume"/></medium>"#,
        r#"s.xml:2:59: error: volume "gridvolume" lacks a filename"#,
    );
    check(&grid("no.vol", ""), r#"s.xml:3:32: error: cannot read "no.vol": no such file in ."#);
    check(
        &grid("text.vol", ""),
        r#"s.xml:3:32: error: text.vol: not a volume: it does not begin with "VOL""#,
    );
    check(
        &grid("short.vol", ""),
        "s.xml:3:32: error: short.vol: the header promises 4 bytes of values, but 2 follow it",
    );
    check(
        &grid("infinite.vol", ""),
        "s.xml:3:32: error: infinite.vol: 1 of the values are not finite, the first of them number 0: inf (counted from 0)",
    );
    check(&grid("flat.vol", ""), "");
    check(
        &grid("flat.vol", r#"<boolean name="use_grid_bbox" value="true"/>"#),
        "s.xml:3:32: error: flat.vol: its box goes from [0, 0, 0] to [0, 1, 1]; each coordinate must grow",
    );
    check(
        &grid("good.vol", r#"<string name="filter_type" value="cubic"/>"#),
        r#"s.xml:3:77: error: unknown filter_type "cubic"; one of trilinear, nearest"#,
    );
}

#[test]
fn media_in_the_wrong_place() {
    let hint = "name=\"interior\" is behind its surface, \"exterior\" in front";
    check(
        r#"<shape type="sphere"><medium type="homogeneous"/></shape>"#,
        &format!("s.xml:2:22: error: the shape's medium has no name; {hint}"),
    );
    check(
        r#"<shape type="sphere"><medium name="inside" type="homogeneous"/></shape>"#,
        &format!("s.xml:2:22: error: a shape has no medium \"inside\"; {hint}"),
    );
    check(
        r#"<emitter type="point"><medium name="exterior" type="homogeneous"/></emitter>"#,
        "s.xml:2:23: error: an emitter has no medium \"exterior\"; the medium around it has no name, or name=\"medium\"",
    );
    check(
        r#"<shape type="disk"><emitter type="area"><medium name="interior" type="homogeneous"/></emitter></shape>"#,
        "s.xml:2:41: error: an emitter has no medium \"interior\"; the medium around it has no name, or name=\"medium\"",
    );
    check(
        r#"<bsdf type="diffuse" id="b"/><shape type="sphere"><ref name="interior" id="b"/></shape>"#,
        r#"s.xml:2:76: error: "interior" must be a medium, not a plugin"#,
    );
    check(
        r#"<shape type="sphere"><integer name="priority" value="-1"/></shape>"#,
        r#"s.xml:2:54: error: "priority" must be at least 0, not -1"#,
    );
    check(
        r#"<bsdf type="diffuse"><medium type="homogeneous"/></bsdf>"#,
        r#"s.xml:2:22: error: <medium> has no place in <bsdf type="diffuse">"#,
    );
}
