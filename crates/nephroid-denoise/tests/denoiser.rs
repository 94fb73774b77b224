//! What becomes of pictures in a library that speaks as Open Image Denoise does, and in the real one where it is
//! installed.

use std::path::{Path, PathBuf};
use std::process::Command;

use nephroid_denoise::{DenoiseError, Denoiser, LoadError, Picture, Search};
use tempfile::TempDir;

/// Compiles a library of functions in the manner of C.
fn library(dir: &TempDir, source: &Path) -> PathBuf {
    let file = dir.path().join("fake.library");
    let mut run = Command::new("rustc");
    run.args(["--edition=2024", "--crate-type=cdylib", "-o"]).arg(&file).arg(source);
    let output = run.output().expect("rustc is there where cargo is");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    file
}

fn fake() -> (TempDir, PathBuf) {
    let dir = tempfile::tempdir().expect("a folder");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fake/oidn.rs");
    let file = library(&dir, &source);
    (dir, file)
}

fn load(file: &Path) -> Result<Denoiser, LoadError> {
    Search { library: Some(file.to_owned()), threads: Some(2), ..Search::default() }.run()
}

#[test]
fn every_layer_reaches_the_library_and_the_picture_comes_back() {
    let (_dir, file) = fake();
    let denoiser = load(&file).expect("it is like the real one");
    assert_eq!((denoiser.version().as_str(), denoiser.file()), ("2.99.7", file.as_path()));
    let layer = |first: f32| -> Vec<f32> { (0..18).map(|i| first + i as f32).collect() };
    let (color, albedo, normal) = (layer(1.0), layer(100.0), layer(-1000.0));
    let all = Picture { width: 3, height: 2, color: &color, albedo: Some(&albedo), normal: Some(&normal) };
    let sum = |shares: [f32; 3]| -> Vec<f32> {
        (0..18).map(|i| shares[0] * color[i] + shares[1] * albedo[i] + shares[2] * normal[i]).collect()
    };
    assert_eq!(denoiser.denoise(&all), Ok(sum([0.5, 0.25, 0.125])));
    assert_eq!(denoiser.denoise(&Picture { normal: None, ..all }), Ok(sum([0.5, 0.25, 0.0])));
    let alone = Picture { albedo: None, ..all };
    assert_eq!(denoiser.denoise(&alone), Ok(sum([0.5, 0.0, 0.0])), "normals need the albedo");
}

#[test]
fn layers_of_another_size_are_refused() {
    let (_dir, file) = fake();
    let denoiser = load(&file).expect("it is like the real one");
    let (color, short) = ([0.0; 12], [0.0; 11]);
    let picture = Picture { width: 2, height: 2, color: &color, albedo: Some(&short), normal: None };
    let refused = DenoiseError::Size { layer: "albedo", numbers: 11, width: 2, height: 2 };
    assert_eq!(denoiser.denoise(&picture), Err(refused.clone()));
    assert_eq!(refused.to_string(), "albedo has 11 numbers for 2 by 2 pixels");
    let huge = Picture { width: u32::MAX, height: u32::MAX, ..picture };
    assert!(matches!(denoiser.denoise(&huge), Err(DenoiseError::Size { .. })));
    let none = Picture { width: 0, height: 0, color: &[], albedo: None, normal: None };
    assert_eq!(denoiser.denoise(&none), Ok(Vec::new()));
}

#[test]
fn what_is_no_such_library_is_told_from_what_is_not_there() {
    let dir = tempfile::tempdir().expect("a folder");
    let missing = dir.path().join("none");
    let message = |file: &Path| load(file).expect_err("it is no denoiser").to_string();
    assert_eq!(message(&missing), format!("{}: there is no such library", missing.display()));
    let text = dir.path().join("text");
    std::fs::write(&text, "not a library").expect("the folder can be written");
    assert!(
        message(&text).starts_with(&format!("{}: cannot be loaded: ", text.display())),
        "{}",
        message(&text)
    );
    let source = dir.path().join("other.rs");
    let other = r#"#[unsafe(no_mangle)] extern "C" fn oidnGetDeviceError() -> i32 { 0 }"#;
    std::fs::write(&source, other).expect("the folder can be written");
    let file = library(&dir, &source);
    let expected = "is not Open Image Denoise 2: it has no function oidnNewDevice";
    assert_eq!(message(&file), format!("{}: {expected}", file.display()));
}

#[test]
fn what_the_real_library_makes_of_noise_is_smooth() {
    let prefixes = ["/usr", "/usr/local"].map(PathBuf::from);
    let library = std::env::var_os("NEPHROID_OIDN_LIBRARY").map(PathBuf::from);
    let named = library.is_some();
    let search = Search { library, python_prefixes: prefixes.to_vec(), threads: None };
    let denoiser = match search.run() {
        Ok(denoiser) => denoiser,
        Err(LoadError::NotFound { .. }) if !named => {
            println!("skipped: Open Image Denoise is not installed; name it in NEPHROID_OIDN_LIBRARY");
            return;
        }
        Err(error) => panic!("{error}"),
    };
    // Grey with noise of a standard deviation of a third, from a generator of Lehmer's.
    let mut state = 1u64;
    let mut uniform = || {
        state = state * 48_271 % 2_147_483_647;
        state as f32 / 2_147_483_647.0
    };
    let (width, height) = (96u32, 64u32);
    let pixels = width as usize * height as usize;
    let color: Vec<f32> = (0..pixels).flat_map(|_| [0.4 + 1.2 * uniform(); 3]).collect();
    let (albedo, normal) = (vec![0.5; 3 * pixels], [0.0, 0.0, 1.0].repeat(pixels));
    let picture = Picture { width, height, color: &color, albedo: Some(&albedo), normal: Some(&normal) };
    let found = denoiser.denoise(&picture).expect("it works");
    let deviation = |values: &[f32]| {
        let square = |v: &f32| f64::from(v - 1.0) * f64::from(v - 1.0);
        (values.iter().map(square).sum::<f64>() / values.len() as f64).sqrt()
    };
    assert!((deviation(&color) - 0.346).abs() < 0.02, "{}", deviation(&color));
    assert!(deviation(&found) < 0.1, "{}", deviation(&found));
}
