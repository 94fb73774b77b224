//! The functions of the library that are used, as its header `oidn.h` declares them.

#![expect(unsafe_code, reason = "functions of a library that is loaded at run time")]

use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr;

use libloading::Library;

use crate::LoadError;

/// `OIDNDevice` and `OIDNFilter`.
pub type Handle = *mut c_void;

/// `OIDN_DEVICE_TYPE_CPU`: it is on every machine, and its results do not depend on the graphics card.
pub const DEVICE_CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
pub const FORMAT_FLOAT3: c_int = 3;

macro_rules! functions {
    ($($field:ident: $symbol:literal, fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of a loaded library. Each has the safety contract of its namesake in C.
        pub struct Api {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            /// Stays loaded until the process ends: threads of its own may still run in it.
            _library: ManuallyDrop<Library>,
        }

        impl Api {
            /// Loads a library. A name without a folder is looked for where the system's linker looks.
            pub fn load(file: &Path) -> Result<Self, LoadError> {
                // SAFETY: loading runs the library's initialisers, about which nothing can be known here. Whoever
                // installs a library in a place for them, or names one, lets its code run.
                let library = unsafe { Library::new(file) }.map_err(|error| LoadError::NotLoaded {
                    file: file.to_owned(),
                    reason: error.to_string(),
                })?;
                Ok(Self {
                    $($field: {
                        // SAFETY: the signature is that of the function in `oidn.h`, which is the same in all of
                        // version 2; version 1 lacks some of these functions, and is refused.
                        let found = unsafe {
                            library.get::<unsafe extern "C" fn($($argument),*) $(-> $result)?>($symbol.as_bytes())
                        };
                        // The library is never unloaded, so the pointer may outlive the borrow.
                        *found.map_err(|_| LoadError::OtherLibrary {
                            file: file.to_owned(),
                            function: $symbol,
                        })?
                    },)*
                    _library: ManuallyDrop::new(library),
                })
            }
        }
    };
}

functions! {
    get_device_error: "oidnGetDeviceError", fn(Handle, *mut *const c_char) -> c_int;
    new_device: "oidnNewDevice", fn(c_int) -> Handle;
    set_device_int: "oidnSetDeviceInt", fn(Handle, *const c_char, c_int);
    set_device_bool: "oidnSetDeviceBool", fn(Handle, *const c_char, bool);
    get_device_int: "oidnGetDeviceInt", fn(Handle, *const c_char) -> c_int;
    commit_device: "oidnCommitDevice", fn(Handle);
    release_device: "oidnReleaseDevice", fn(Handle);
    new_filter: "oidnNewFilter", fn(Handle, *const c_char) -> Handle;
    set_shared_filter_image: "oidnSetSharedFilterImage",
        fn(Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);
    set_filter_bool: "oidnSetFilterBool", fn(Handle, *const c_char, bool);
    commit_filter: "oidnCommitFilter", fn(Handle);
    execute_filter: "oidnExecuteFilter", fn(Handle);
    release_filter: "oidnReleaseFilter", fn(Handle);
}

impl Api {
    /// What went wrong with a device since this was last asked; with none, what kept this thread from getting one.
    ///
    /// # Safety
    /// `device` is null or one of this library that was not released.
    pub unsafe fn error(&self, device: Handle) -> Option<String> {
        let mut message: *const c_char = ptr::null();
        // SAFETY: the device is as promised, and `message` is a place to write a pointer to.
        let code = unsafe { (self.get_device_error)(device, &raw mut message) };
        if code == 0 {
            return None;
        }
        if message.is_null() {
            return Some(format!("error {code}"));
        }
        // SAFETY: with an error comes a text that ends with a zero and lives until the next call of this function for
        // the device; it is copied before.
        Some(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
    }
}
