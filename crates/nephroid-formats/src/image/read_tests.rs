//! What the readers make of sound files of every kind.

use std::io::Cursor;

use ::image::{DynamicImage, ImageBuffer, ImageFormat as Kind};
use exr::prelude::{FlatSamples, WritableImage, f16};
use nephroid::color::{Rgb, srgb};
use nephroid::texture::Image;

use super::*;

fn encoded(image: &DynamicImage, kind: Kind) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, kind).unwrap();
    bytes.into_inner()
}

fn raw(bytes: &[u8]) -> Vec<Rgb> {
    let file = read_texture(bytes, true).unwrap();
    assert_eq!((file.image.width, file.image.height), (2, 1));
    file.image.pixels.iter().collect()
}

/// An image of two pixels from their samples.
macro_rules! two {
    ($variant:ident, $samples:expr) => {
        DynamicImage::$variant(ImageBuffer::from_raw(2, 1, $samples.to_vec()).unwrap())
    };
}

#[test]
fn png_of_every_kind_of_pixel() {
    let eight = |r: u8, g: u8, b: u8| Rgb::new(f32::from(r), f32::from(g), f32::from(b)) * (1.0 / 255.0);
    let close = |found: Vec<Rgb>, expected: [Rgb; 2]| {
        for (f, e) in found.iter().zip(expected) {
            let d = *f - e;
            assert!(d.max_channel() < 1e-6 && d.min_channel() > -1e-6, "{found:?} is not {expected:?}");
        }
    };
    let greys = [eight(0, 0, 0), eight(51, 51, 51)];
    let colours = [eight(255, 102, 0), eight(51, 0, 204)];
    close(raw(&encoded(&two!(ImageLuma8, [0u8, 51]), Kind::Png)), greys);
    close(raw(&encoded(&two!(ImageLumaA8, [0u8, 9, 51, 0]), Kind::Png)), greys);
    close(raw(&encoded(&two!(ImageRgb8, [255u8, 102, 0, 51, 0, 204]), Kind::Png)), colours);
    close(raw(&encoded(&two!(ImageRgba8, [255u8, 102, 0, 7, 51, 0, 204, 0]), Kind::Png)), colours);
    let s = |v: u16| v * 257;
    close(raw(&encoded(&two!(ImageLuma16, [0, s(51)]), Kind::Png)), greys);
    close(raw(&encoded(&two!(ImageLumaA16, [0, 5, s(51), 0]), Kind::Png)), greys);
    let wide = [s(255), s(102), 0, s(51), 0, s(204)];
    close(raw(&encoded(&two!(ImageRgb16, wide), Kind::Png)), colours);
    let wide = [s(255), s(102), 0, 1, s(51), 0, s(204), 0];
    close(raw(&encoded(&two!(ImageRgba16, wide), Kind::Png)), colours);
    close(raw(&palette_png()), colours);
    // Sixteen bits are more than eight.
    let fine = raw(&encoded(&two!(ImageLuma16, [1u16, 2]), Kind::Png));
    assert_eq!(fine, [Rgb::splat(1.0 / 65_535.0), Rgb::splat(2.0 / 65_535.0)]);
}

/// Two pixels of one bit each, with a palette.
fn palette_png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_palette(vec![51, 0, 204, 255, 102, 0]);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0b1000_0000]).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn eight_and_sixteen_bits_are_decoded_from_srgb_unless_raw() {
    let eight = encoded(&two!(ImageLuma8, [128u8, 255]), Kind::Png);
    let sixteen = encoded(&two!(ImageLuma16, [128u16 * 257, 65_535]), Kind::Png);
    for bytes in [eight, sixteen] {
        let file = read_texture(&bytes, false).unwrap();
        assert!((file.image.pixel(0, 0).g - 0.215_860_5).abs() < 1e-6, "{file:?}");
        assert!((file.image.pixel(1, 0).g - 1.0).abs() < 1e-6);
        assert!(read_image_bytes(&bytes).unwrap().image.pixels.into_iter().eq(file.image.pixels.iter()));
        assert!((raw(&bytes)[0].g - 128.0 / 255.0).abs() < 1e-6);
    }
}

#[test]
fn jpeg_of_grey_and_colour() {
    let colour = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(20, 13, ::image::Rgb([200u8, 100, 50])));
    let grey = DynamicImage::ImageLuma8(ImageBuffer::from_pixel(20, 13, ::image::Luma([100u8])));
    for (image, expected) in [(colour, [200.0, 100.0, 50.0]), (grey, [100.0; 3])] {
        let file = read_image_bytes(&encoded(&image, Kind::Jpeg)).unwrap();
        assert_eq!((file.format, file.image.width, file.image.height), (ImageFormat::Jpeg, 20, 13));
        let encoded = file.image.pixel(19, 12).map(srgb::encode) * 255.0;
        for (found, expected) in encoded.to_array().into_iter().zip(expected) {
            assert!((found - expected).abs() < 4.0, "{encoded:?}");
        }
    }
}

#[test]
fn radiance_hdr_is_linear() {
    let image = two!(ImageRgb32F, [0.5f32, 1.0, 64.0, 0.0, 0.0, 0.0]);
    let bytes = encoded(&image, Kind::Hdr);
    let file = read_texture(&bytes, false).unwrap();
    assert_eq!(file.format, ImageFormat::Hdr);
    assert!(file.image.pixels.iter().eq([Rgb::new(0.5, 1.0, 64.0), Rgb::BLACK]));
    // The other signature that is in use, and a line that the decoder has no use for.
    let text = String::from_utf8_lossy(&bytes).find('\n').unwrap();
    let other = [b"#?RGBE\nGAMMA=1", &bytes[text..]].concat();
    assert_eq!(read_texture(&other, false).unwrap().image, file.image);
}

/// Channels by their names, with the values of two pixels.
type Channels<'a> = &'a [(&'a str, [f32; 2])];

/// An OpenEXR file of two pixels as halves.
fn half_exr(parts: &[Channels]) -> Vec<u8> {
    use exr::image::{AnyChannel, AnyChannels, Encoding, Image as File, Layer as Part, Layers};
    use exr::meta::header::{ImageAttributes, LayerAttributes};
    let part = |(i, channels): (usize, &Channels)| {
        let channels = channels.iter().map(|(name, values)| {
            AnyChannel::new(*name, FlatSamples::F16(values.map(f16::from_f32).to_vec()))
        });
        let attributes = LayerAttributes::named(format!("part{i}").as_str());
        Part::new((2, 1), attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(channels.collect()))
    };
    let layers: Layers<_> = parts.iter().enumerate().map(part).collect();
    let window = exr::meta::attribute::IntegerBounds::from_dimensions((2, 1));
    let mut bytes = Cursor::new(Vec::new());
    let file = File::from_layers(ImageAttributes::new(window), layers);
    file.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn exr_channels_are_found() {
    let colours = vec![Rgb::new(1.0, 2.0, 3.0), Rgb::new(0.5, 0.25, 8.0)];
    let (r, g, b) = ([1.0, 0.5], [2.0, 0.25], [3.0, 8.0]);
    let bad = [7.0, 7.0];
    let cases: [&[Channels]; 5] = [
        &[&[("R", r), ("G", g), ("B", b)]],
        &[&[("A", bad), ("B", b), ("G", g), ("R", r), ("Y", bad), ("a.R", bad), ("a.G", bad), ("a.B", bad)]],
        &[&[("View.Combined.R", r), ("View.Combined.G", g), ("View.Combined.B", b), ("View.Z.Z", bad)]],
        &[&[("Z", bad)], &[("R", r), ("G", g), ("B", b)], &[("R", bad), ("G", bad), ("B", bad)]],
        &[&[("R", bad), ("G", bad), ("n.Y", bad), ("c.R", r), ("c.G", g), ("c.B", b)]],
    ];
    for case in cases {
        assert_eq!(read_image_bytes(&half_exr(case)).unwrap().image.pixels, colours, "{case:?}");
    }
    for name in ["Y", "depth.Y"] {
        let grey = read_image_bytes(&half_exr(&[&[(name, g), ("Z", bad)]])).unwrap();
        assert_eq!(grey.image.pixels, [Rgb::splat(2.0), Rgb::splat(0.25)]);
    }
}

#[test]
fn alpha_is_kept_where_it_says_something() {
    let opacities = |bytes: &[u8]| {
        let image = read_texture(bytes, false).expect("a sound file").image;
        image.alpha.is_some().then(|| [image.opacity(0, 0), image.opacity(1, 0)])
    };
    let png = |image: DynamicImage| opacities(&encoded(&image, Kind::Png));
    assert_eq!(png(two!(ImageLumaA8, [9u8, 255, 9, 51])), Some([1.0, 0.2]));
    assert_eq!(png(two!(ImageRgba8, [1u8, 2, 3, 0, 1, 2, 3, 102])), Some([0.0, 0.4]));
    assert_eq!(png(two!(ImageRgba16, [1u16, 2, 3, 13_107, 1, 2, 3, 65_535])), Some([0.2, 1.0]));
    assert_eq!(png(two!(ImageRgba8, [1u8, 2, 3, 255, 1, 2, 3, 255])), None);
    assert_eq!(png(two!(ImageRgb8, [1u8, 2, 3, 1, 2, 3])), None);
    let rgba = two!(ImageRgba8, [1u8, 2, 3, 0, 1, 2, 3, 102]);
    assert_eq!(opacities(&encoded(&rgba, Kind::Tga)), Some([0.0, 0.4]));
    let one = [1.0, 1.0];
    for names in [["A", "R", "G", "B"], ["c.A", "c.R", "c.G", "c.B"]] {
        let [a, r, g, b] = names;
        let channels = |alpha| half_exr(&[&[(a, alpha), (b, one), (g, one), (r, one)]]);
        assert_eq!(opacities(&channels([0.5, 0.25])), Some([0.5, 0.25]));
        assert_eq!(opacities(&channels(one)), None);
    }
    assert_eq!(opacities(&half_exr(&[&[("A", [0.5, 0.0]), ("Y", one)]])), Some([0.5, 0.0]));
}

#[test]
fn bytes_stay_bytes() {
    let bytes_of = |image: DynamicImage, kind| {
        let image = read_texture(&encoded(&image, kind), false).expect("a sound file").image;
        image.bytes()
    };
    for kind in [Kind::Png, Kind::Jpeg, Kind::Bmp, Kind::Tga] {
        assert_eq!(bytes_of(DynamicImage::ImageRgb8(ImageBuffer::new(40, 20)), kind), 2400, "{kind:?}");
    }
    assert_eq!(bytes_of(DynamicImage::ImageLuma8(ImageBuffer::new(40, 20)), Kind::Png), 800);
}

#[test]
fn bmp_and_tga_are_read_from_the_top() {
    let pixels = [[255u8, 102, 0], [51, 0, 204], [1, 2, 3], [4, 5, 6]];
    let image = ImageBuffer::from_raw(2, 2, pixels.concat()).expect("four pixels");
    for (kind, format) in [(Kind::Bmp, ImageFormat::Bmp), (Kind::Tga, ImageFormat::Tga)] {
        let file = read_texture(&encoded(&DynamicImage::ImageRgb8(image.clone()), kind), true);
        let file = file.expect("a sound file");
        assert_eq!(file.format, format);
        let found: Vec<Rgb> = file.image.pixels.iter().map(|p| p * 255.0).collect();
        for (found, expected) in found.iter().zip(pixels) {
            assert_eq!(found.to_array().map(f32::round), expected.map(f32::from), "{kind:?}");
        }
    }
    // Lower rows first, as most programs write them, in runs and with a palette.
    let mut tga = vec![0, 1, 9, 0, 0, 2, 0, 24, 0, 0, 0, 0, 2, 0, 2, 0, 8, 0];
    tga.extend([0, 0, 255, 255, 0, 0]);
    tga.extend([0x81, 0, 0x81, 1]);
    let file = read_texture(&tga, true).expect("a sound file");
    assert_eq!(
        (file.image.pixel(0, 1), file.image.pixel(1, 0)),
        (Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 1.0))
    );
}

#[test]
fn exr_without_colour_says_what_it_has() {
    let without = half_exr(&[&[("Z", [0.0; 2]), ("motion.X", [0.0; 2])]]);
    let message = read_image_bytes(&without).unwrap_err().to_string();
    assert_eq!(message, "has neither channels R, G, B nor a channel Y, only Z, motion.X");
    let chroma = half_exr(&[&[("Y", [0.0; 2]), ("RY", [0.0; 2]), ("BY", [0.0; 2])]]);
    assert!(matches!(read_image_bytes(&chroma), Err(ImageProblem::NoColour { .. })));
}

#[test]
fn broken_pixels_are_counted_and_black_in_textures() {
    let image = Image {
        width: 3,
        height: 1,
        pixels: vec![Rgb::new(f32::NAN, 1.0, 1.0), Rgb::splat(2.0), Rgb::splat(f32::INFINITY)],
    };
    let bytes = encode_exr(&[Layer { name: "", data: LayerData::Rgb(&image) }]).unwrap();
    let file = read_image_bytes(&bytes).unwrap();
    assert_eq!(file.non_finite, 2);
    assert!(file.image.pixels[0].r.is_nan() && file.image.pixels[2].r.is_infinite());
    let texture = read_texture(&bytes, false).unwrap();
    assert_eq!(texture.non_finite, 2);
    assert!(texture.image.pixels.iter().eq([Rgb::BLACK, Rgb::splat(2.0), Rgb::BLACK]));
}

#[test]
fn files_are_read_and_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dot.png");
    write_png(&path, &Image::filled(1, 1, Rgb::WHITE)).unwrap();
    assert_eq!(read_image(&path).unwrap().image.width, 1);
    let missing = read_image(&folder.path().join("missing.png")).unwrap_err();
    assert!(missing.to_string().contains("missing.png: cannot be read: "), "{missing}");
    assert!(matches!(read_image(folder.path()).unwrap_err().problem, ImageProblem::NotAFile));
    fs::write(&path, "<scene/>").unwrap();
    let message = read_image(&path).unwrap_err().to_string();
    assert!(message.contains("dot.png: is of no format") && message.contains("OpenEXR, PNG"), "{message}");
}
