//! A stand-in for Open Image Denoise that tests compile into a library of its own: it speaks the same functions, and what it
//! makes of a picture can be foretold.
//!
//! It adds up a half of the colour, a quarter of the albedo and an eighth of the normal, of what it is given; one layer
//! alone comes back as it is. With `FAKE_OIDN=commit` no device works, with `FAKE_OIDN=execute` no filter does.

use std::ffi::{CStr, c_char, c_int, c_void};

struct Device {
    error: Option<&'static CStr>,
    committed: bool,
    filters: u32,
}

#[derive(Default)]
struct Images {
    /// Colour, albedo, normal, output.
    of: [Option<(*mut f32, usize)>; 4],
    hdr: bool,
    clean_aux: bool,
    committed: bool,
}

struct Filter {
    device: *mut Device,
    images: Images,
}

fn told(what: &str) -> bool {
    std::env::var("FAKE_OIDN").is_ok_and(|told| told == what)
}

fn text<'a>(name: *const c_char) -> &'a str {
    unsafe { CStr::from_ptr(name) }.to_str().unwrap()
}

#[unsafe(no_mangle)]
extern "C" fn oidnNewDevice(kind: c_int) -> *mut Device {
    assert_eq!(kind, 1, "the device of the CPU");
    Box::into_raw(Box::new(Device { error: None, committed: false, filters: 0 }))
}

#[unsafe(no_mangle)]
extern "C" fn oidnGetDeviceError(device: *mut Device, message: *mut *const c_char) -> c_int {
    match unsafe { device.as_mut() }.and_then(|device| device.error.take()) {
        Some(error) => {
            unsafe { *message = error.as_ptr() };
            1
        }
        None => 0,
    }
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetDeviceInt(_: *mut Device, name: *const c_char, value: c_int) {
    assert!(text(name) == "numThreads" && value > 0);
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetDeviceBool(_: *mut Device, name: *const c_char, value: bool) {
    assert!(text(name) == "setAffinity" && !value);
}

#[unsafe(no_mangle)]
extern "C" fn oidnGetDeviceInt(_: *mut Device, name: *const c_char) -> c_int {
    match text(name) {
        "versionMajor" => 2,
        "versionMinor" => 99,
        "versionPatch" => 7,
        other => panic!("{other}"),
    }
}

#[unsafe(no_mangle)]
extern "C" fn oidnCommitDevice(device: *mut Device) {
    let device = unsafe { &mut *device };
    device.committed = true;
    if told("commit") {
        device.error = Some(c"this fake does not like the machine");
    }
}

#[unsafe(no_mangle)]
extern "C" fn oidnReleaseDevice(device: *mut Device) {
    let device = unsafe { Box::from_raw(device) };
    assert_eq!(device.filters, 0, "filters are released before their device");
}

#[unsafe(no_mangle)]
extern "C" fn oidnNewFilter(device: *mut Device, kind: *const c_char) -> *mut Filter {
    assert_eq!(text(kind), "RT");
    assert!(unsafe { &*device }.committed);
    unsafe { &mut *device }.filters += 1;
    Box::into_raw(Box::new(Filter { device, images: Images::default() }))
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetSharedFilterImage(
    filter: *mut Filter,
    name: *const c_char,
    memory: *mut f32,
    format: c_int,
    width: usize,
    height: usize,
    offset: usize,
    pixel_stride: usize,
    row_stride: usize,
) {
    assert_eq!((format, offset, pixel_stride, row_stride), (3, 0, 0, 0));
    let place = ["color", "albedo", "normal", "output"].iter().position(|known| *known == text(name));
    unsafe { &mut *filter }.images.of[place.unwrap()] = Some((memory, 3 * width * height));
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetFilterBool(filter: *mut Filter, name: *const c_char, value: bool) {
    let images = &mut unsafe { &mut *filter }.images;
    match text(name) {
        "hdr" => images.hdr = value,
        "cleanAux" => images.clean_aux = value,
        other => panic!("{other}"),
    }
}

#[unsafe(no_mangle)]
extern "C" fn oidnCommitFilter(filter: *mut Filter) {
    unsafe { &mut *filter }.images.committed = true;
}

#[unsafe(no_mangle)]
extern "C" fn oidnExecuteFilter(filter: *mut Filter) {
    let Filter { device, images } = unsafe { &mut *filter };
    assert!(images.committed);
    if told("execute") {
        unsafe { &mut **device }.error = Some(c"this fake does not like the picture");
        return;
    }
    let [color, albedo, normal, output] = images.of.map(|image: Option<(*mut f32, usize)>| {
        image.map(|(memory, length): (*mut f32, usize)| unsafe { std::slice::from_raw_parts_mut(memory, length) })
    });
    let output = output.unwrap();
    assert_eq!((images.hdr, images.clean_aux), (color.is_some(), color.is_some() && albedo.is_some()));
    let shares = if color.is_some() { [0.5, 0.25, 0.125] } else { [1.0; 3] };
    for (i, sum) in output.iter_mut().enumerate() {
        let layers = [&color, &albedo, &normal];
        *sum = layers.iter().zip(shares).filter_map(|(layer, share)| Some(share * layer.as_ref()?[i])).sum();
    }
}

#[unsafe(no_mangle)]
extern "C" fn oidnReleaseFilter(filter: *mut Filter) {
    let filter = unsafe { Box::from_raw(filter) };
    unsafe { &mut *filter.device }.filters -= 1;
}
