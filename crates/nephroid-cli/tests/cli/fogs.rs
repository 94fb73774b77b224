//! What the pictures of built-in fogs must look like. Seeds are fixed.

use crate::layers::channels;
use crate::support::Dir;

const SIDE: usize = 64;

/// Green, row by row, of a small picture.
fn green(scene: &str, args: &[&str]) -> Vec<f32> {
    let dir = Dir::new();
    let side = format!("{SIDE}x{SIDE}");
    let common = ["render", scene, "--resolution", &side, "--spp", "8", "-o", "x.exr"];
    dir.run(&[&common[..], args].concat()).ends_with(0);
    channels(&dir, "x.exr").remove("G").expect("green")
}

/// The mean over columns and rows, ends excluded.
fn mean(image: &[f32], columns: [usize; 2], rows: [usize; 2]) -> f32 {
    let rows = &image[rows[0] * SIDE..rows[1] * SIDE];
    let values = rows.chunks(SIDE).flat_map(|row| &row[columns[0]..columns[1]]);
    values.sum::<f32>() / ((columns[1] - columns[0]) * rows.len() / SIDE) as f32
}

/// The light of Figure 3.8 falls off from pixel to pixel. Between the rings of a march it would rise again;
/// 4 % are allowed for noise.
#[test]
fn no_rings_lie_round_a_lamp_in_fog() {
    for source in ["rays", "map"] {
        let image = green("report-3-8", &["-D", &format!("single_scatter={source}")]);
        // The lamp is 0.5 above the axis of the camera, which sees 1.84 up and down at its distance.
        let (x, y) = (31.5, 0.5 * SIDE as f32 * (1.0 - 0.5 / 1.84) - 0.5);
        // Downwards, for the ceiling is lit as well.
        let ring = |radius: usize| {
            let distance = |dx: f32, dy: f32| (dx * dx + dy * dy).sqrt() as usize;
            let at = |i: usize| distance((i % SIDE) as f32 - x, (i / SIDE) as f32 - y);
            let here = (0..SIDE * SIDE).filter(|&i| (i / SIDE) as f32 >= y && at(i) == radius);
            let (sum, count) = here.fold((0.0, 0), |(sum, count), i| (sum + image[i], count + 1));
            sum / count as f32
        };
        let profile: Vec<f32> = (1..15).map(ring).collect();
        let falls = profile.windows(2).all(|pair| pair[1] < 1.04 * pair[0]);
        assert!(falls && profile[0] > 5.0 * profile[13], "{source}: {profile:?}");
    }
}

/// Figure 3.9 without its mistakes. The cone is 1.9 times as bright as what is beside it, and 1.45
/// times with fog in the glass, too.
#[test]
fn a_glass_sphere_in_fog_throws_a_cone_and_is_not_bright() {
    let image = green("report-3-9", &[]);
    let cone = mean(&image, [30, 34], [43, 48]);
    let beside = 0.5 * (mean(&image, [23, 26], [43, 48]) + mean(&image, [38, 41], [43, 48]));
    assert!(cone > 1.65 * beside, "{cone} in the cone, {beside} beside it");
    let glass = mean(&image, [29, 35], [30, 37]);
    let around = 0.5 * (mean(&image, [18, 22], [30, 37]) + mean(&image, [42, 46], [30, 37]));
    assert!(glass < 1.25 * around, "{glass} in the glass, {around} beside it");
}

/// Light that goes on forward reaches the eye from the lamp that shines towards it.
#[test]
fn the_phase_function_chooses_the_bright_shaft() {
    let ratio = |scene| {
        let image = green(scene, &["--volume-photons", "20000"]);
        mean(&image, [12, 22], [24, 44]) / mean(&image, [42, 52], [24, 44])
    };
    let (forward, backward) = (ratio("fog-forward"), ratio("fog-backward"));
    assert!(forward > 4.0 && backward < 0.8, "{forward} and {backward}");
}
