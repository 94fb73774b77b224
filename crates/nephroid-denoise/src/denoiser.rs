//! A device of the library, and pictures that go through it.

#![expect(unsafe_code, reason = "calls of a library that is loaded at run time")]

use std::ffi::{CStr, c_int};
use std::fmt;
use std::path::{Path, PathBuf};
use std::ptr;

use crate::api::{Api, DEVICE_CPU, FORMAT_FLOAT3, Handle};
use crate::{DenoiseError, LoadError};

/// A picture with noise, and what is known of its pixels. Each layer is three numbers a pixel, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear light of any scale.
    pub color: &'a [f32],
    /// What the surfaces that are seen reflect of white light, in [0, 1].
    pub albedo: Option<&'a [f32]>,
    /// Their normals, in [−1, 1]. Without the albedo they are not used.
    pub normal: Option<&'a [f32]>,
}

/// A loaded library that is ready to denoise.
pub struct Denoiser {
    api: Api,
    device: Handle,
    file: PathBuf,
}

impl Denoiser {
    /// Loads a library; it takes so many threads, or as many as it likes.
    pub(crate) fn load(file: &Path, threads: Option<u16>) -> Result<Self, LoadError> {
        let api = Api::load(file)?;
        // SAFETY: any number may be asked for; what is no kind of device gives null.
        let device = unsafe { (api.new_device)(DEVICE_CPU) };
        let refused = |reason: Option<String>| LoadError::NotUsable {
            file: file.to_owned(),
            reason: reason.unwrap_or_else(|| "it does not say why".to_owned()),
        };
        if device.is_null() {
            // SAFETY: null asks what kept this thread from getting a device.
            return Err(refused(unsafe { api.error(ptr::null_mut()) }));
        }
        let denoiser = Self { api, device, file: file.to_owned() };
        // SAFETY: the device is there until `denoiser` is dropped, and was not committed; names are strings of C.
        let trouble = unsafe {
            if let Some(threads) = threads {
                (denoiser.api.set_device_int)(device, c"numThreads".as_ptr(), c_int::from(threads));
            }
            // Threads that are bound to cores would get in the way of others on the machine.
            (denoiser.api.set_device_bool)(device, c"setAffinity".as_ptr(), false);
            (denoiser.api.commit_device)(device);
            denoiser.api.error(device)
        };
        trouble.map_or(Ok(denoiser), |reason| Err(refused(Some(reason))))
    }

    /// The library's file, or its name if the system found it.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The library's version, such as "2.3.1".
    pub fn version(&self) -> String {
        let part = |name: &CStr| {
            // SAFETY: the device is there until `self` is dropped, and the name is a string of C.
            unsafe { (self.api.get_device_int)(self.device, name.as_ptr()) }
        };
        format!("{}.{}.{}", part(c"versionMajor"), part(c"versionMinor"), part(c"versionPatch"))
    }

    /// The picture without noise.
    ///
    /// Albedo and normals are denoised first, each by itself, and then trusted: what noise a lens, a mirror or a filter
    /// leaves in them would else be taken for detail.
    pub fn denoise(&self, picture: &Picture<'_>) -> Result<Vec<f32>, DenoiseError> {
        let Picture { width, height, color, albedo, normal } = *picture;
        let size = (width, height);
        let mut layers = vec![Layer { name: c"color", numbers: color }];
        let albedo =
            albedo.map(|numbers| self.alone(Layer { name: c"albedo", numbers }, size)).transpose()?;
        if let Some(albedo) = &albedo {
            layers.push(Layer { name: c"albedo", numbers: albedo });
        }
        let normal = normal.filter(|_| albedo.is_some());
        let normal =
            normal.map(|numbers| self.alone(Layer { name: c"normal", numbers }, size)).transpose()?;
        if let Some(normal) = &normal {
            layers.push(Layer { name: c"normal", numbers: normal });
        }
        self.filter(&layers, size, &[(c"hdr", true), (c"cleanAux", albedo.is_some())])
    }

    fn alone(&self, layer: Layer<'_>, size: (u32, u32)) -> Result<Vec<f32>, DenoiseError> {
        self.filter(&[layer], size, &[])
    }

    /// Runs the filter for ray tracing.
    fn filter(
        &self,
        layers: &[Layer<'_>],
        (width, height): (u32, u32),
        options: &[(&CStr, bool)],
    ) -> Result<Vec<f32>, DenoiseError> {
        let (columns, rows) = (width as usize, height as usize);
        let numbers = columns.checked_mul(rows).and_then(|pixels| pixels.checked_mul(3));
        if let Some(layer) = layers.iter().find(|layer| Some(layer.numbers.len()) != numbers) {
            return Err(DenoiseError::Size {
                layer: layer.name.to_str().unwrap_or_default(),
                numbers: layer.numbers.len(),
                width,
                height,
            });
        }
        let mut output = vec![0.0f32; layers.first().map_or(0, |layer| layer.numbers.len())];
        if output.is_empty() {
            return Ok(output);
        }
        let filter = Filter::new(self)?;
        for layer in layers {
            // SAFETY: the length was checked above; the numbers outlive `filter`, and the library only reads what is
            // no output.
            unsafe { filter.image(layer.name, layer.numbers.as_ptr().cast_mut(), columns, rows) };
        }
        // SAFETY: `output` is as long as a layer, outlives `filter`, and is not touched until the filter has run.
        unsafe { filter.image(c"output", output.as_mut_ptr(), columns, rows) };
        for (name, value) in options {
            // SAFETY: the filter is there, and the name is a string of C.
            unsafe { (self.api.set_filter_bool)(filter.handle, name.as_ptr(), *value) };
        }
        // SAFETY: the filter and all memory it was given are there. `oidnExecuteFilter` returns when all is done.
        unsafe {
            (self.api.commit_filter)(filter.handle);
            (self.api.execute_filter)(filter.handle);
        }
        drop(filter);
        self.check().map(|()| output)
    }

    fn check(&self) -> Result<(), DenoiseError> {
        // SAFETY: the device is there until `self` is dropped.
        let trouble = unsafe { self.api.error(self.device) };
        trouble.map_or(Ok(()), |message| Err(DenoiseError::Library(message)))
    }
}

impl Drop for Denoiser {
    fn drop(&mut self) {
        // SAFETY: it was got in `load`, and is released here alone; its filters borrow `self`, so none is left.
        unsafe { (self.api.release_device)(self.device) };
    }
}

impl fmt::Debug for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Denoiser").field("file", &self.file).finish_non_exhaustive()
    }
}

/// Three numbers a pixel, and what the library calls them.
#[derive(Clone, Copy)]
struct Layer<'a> {
    name: &'static CStr,
    numbers: &'a [f32],
}

struct Filter<'d> {
    denoiser: &'d Denoiser,
    handle: Handle,
}

impl<'d> Filter<'d> {
    fn new(denoiser: &'d Denoiser) -> Result<Self, DenoiseError> {
        // SAFETY: the device is there as long as `denoiser`, and the name is a string of C.
        let handle = unsafe { (denoiser.api.new_filter)(denoiser.device, c"RT".as_ptr()) };
        if handle.is_null() {
            denoiser.check()?;
            return Err(DenoiseError::Library("there is no filter for ray tracing".to_owned()));
        }
        Ok(Self { denoiser, handle })
    }

    /// Gives it a picture's memory.
    ///
    /// # Safety
    /// There are 3·columns·rows numbers, which stay there until the filter is dropped; of "output" nobody else reads or
    /// writes them until then.
    unsafe fn image(&self, name: &CStr, numbers: *mut f32, columns: usize, rows: usize) {
        let set = self.denoiser.api.set_shared_filter_image;
        // SAFETY: the filter is there, the name is a string of C, and the memory is as promised. Strides of zero stand
        // for pixels and rows without gaps. Devices on the CPU use memory of the process.
        unsafe { set(self.handle, name.as_ptr(), numbers.cast(), FORMAT_FLOAT3, columns, rows, 0, 0, 0) };
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: it was got in `new`, and is released here alone.
        unsafe { (self.denoiser.api.release_filter)(self.handle) };
    }
}
