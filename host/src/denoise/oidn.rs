//! Open Image Denoise of Intel, by its C interface (versions 1 and 2), where its library is found when it is asked for. Its pictures have
//! other bits on other processors and by other versions.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;

use libloading::Library;

use super::Guides;
use crate::error::{Error, Result};
use crate::picture::Picture;

/// What the library is called, newest first.
#[cfg(windows)]
const NAMES: &[&str] = &["OpenImageDenoise.dll"];
#[cfg(target_os = "macos")]
const NAMES: &[&str] = &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"];
#[cfg(not(any(windows, target_os = "macos")))]
const NAMES: &[&str] =
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1", "libOpenImageDenoise.so.0", "libOpenImageDenoise.so"];

/// `OIDN_DEVICE_TYPE_CPU`, whose images may lie in any memory.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;

/// A device or a filter of the library.
type Handle = *mut c_void;

/// The library, with a device of it.
pub struct Oidn {
    functions: Functions,
    device: Handle,
    version: String,
    // After what is of it.
    _library: Library,
}

struct Functions {
    release_device: unsafe extern "C" fn(Handle),
    device_error: unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int,
    new_filter: unsafe extern "C" fn(Handle, *const c_char) -> Handle,
    set_image: unsafe extern "C" fn(Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize),
    set_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    commit_filter: unsafe extern "C" fn(Handle),
    execute_filter: unsafe extern "C" fn(Handle),
    release_filter: unsafe extern "C" fn(Handle),
}

/// A function of the library by the first of these names that it has.
///
/// # Safety
/// The function is of type `F`.
unsafe fn function<F: Copy>(library: &Library, names: &[&str]) -> Result<F> {
    // SAFETY: as this function's.
    let found = names.iter().find_map(|name| unsafe { library.get::<F>(name.as_bytes()) }.ok());
    found.map(|symbol| *symbol).ok_or_else(|| Error::new(format!("Open Image Denoise has no function {}", names[0])))
}

impl Oidn {
    /// Loads the library and opens a device of it, the processor.
    ///
    /// # Errors
    /// It is not found, or refuses to work.
    pub fn find() -> Result<Oidn> {
        // SAFETY: whoever puts a library of this name where programs look for libraries has it run.
        let library = NAMES.iter().find_map(|name| unsafe { Library::new(name) }.ok());
        let library = library.ok_or_else(|| {
            let remedy = "install it (openimagedenoise.org) where programs find libraries, or leave out oidn";
            Error::new(format!("{} is not found: {remedy}", NAMES[0]))
        })?;
        // SAFETY: these are the types of the functions in the library's header, of both versions.
        unsafe {
            let new_device: unsafe extern "C" fn(c_int) -> Handle = function(&library, &["oidnNewDevice"])?;
            let commit_device: unsafe extern "C" fn(Handle) = function(&library, &["oidnCommitDevice"])?;
            let device_number: unsafe extern "C" fn(Handle, *const c_char) -> c_int =
                function(&library, &["oidnGetDeviceInt", "oidnGetDevice1i"])?;
            let functions = Functions {
                release_device: function(&library, &["oidnReleaseDevice"])?,
                device_error: function(&library, &["oidnGetDeviceError"])?,
                new_filter: function(&library, &["oidnNewFilter"])?,
                set_image: function(&library, &["oidnSetSharedFilterImage"])?,
                set_bool: function(&library, &["oidnSetFilterBool", "oidnSetFilter1b"])?,
                commit_filter: function(&library, &["oidnCommitFilter"])?,
                execute_filter: function(&library, &["oidnExecuteFilter"])?,
                release_filter: function(&library, &["oidnReleaseFilter"])?,
            };
            let device = new_device(CPU);
            if device.is_null() {
                return Err(Error::new("Open Image Denoise has no device for this processor"));
            }
            commit_device(device);
            let number = device_number(device, c"version".as_ptr());
            let version = format!("{}.{}.{}", number / 10_000, number / 100 % 100, number % 100);
            let oidn = Oidn { functions, device, version, _library: library };
            oidn.check()?;
            Ok(oidn)
        }
    }

    /// Its version, as `2.5.1`.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The picture with less noise, by albedo and normals.
    ///
    /// # Errors
    /// Guides of another size, or what the library reports.
    pub fn denoise(&self, picture: &Picture, guides: &Guides<'_>) -> Result<Picture> {
        guides.check(picture)?;
        let mut denoised = picture.clone();
        let size = (picture.width as usize, picture.height as usize);
        let images: [(&CStr, *mut [f32; 3]); 4] = [
            // The library only reads these.
            (c"color", picture.pixels.as_ptr().cast_mut()),
            (c"albedo", guides.albedo.pixels.as_ptr().cast_mut()),
            (c"normal", guides.normal.pixels.as_ptr().cast_mut()),
            (c"output", denoised.pixels.as_mut_ptr()),
        ];
        // SAFETY: the device is open; each image has as many pixels of three floats as it is said to have, which was checked, and
        // outlives the filter; the output is nobody else's.
        unsafe {
            let filter = (self.functions.new_filter)(self.device, c"RT".as_ptr());
            for (name, pixels) in images {
                (self.functions.set_image)(filter, name.as_ptr(), pixels.cast(), FLOAT3, size.0, size.1, 0, 0, 0);
            }
            (self.functions.set_bool)(filter, c"hdr".as_ptr(), true);
            (self.functions.commit_filter)(filter);
            (self.functions.execute_filter)(filter);
            (self.functions.release_filter)(filter);
        }
        self.check()?;
        Ok(denoised)
    }

    /// What the library reports since this was asked last.
    fn check(&self) -> Result<()> {
        let mut message = ptr::null();
        // SAFETY: the device is open, and the message is written to a place for it.
        let code = unsafe { (self.functions.device_error)(self.device, &mut message) };
        if code == 0 {
            return Ok(());
        }
        let message = match message.is_null() {
            true => format!("error {code}"),
            // SAFETY: it is text that ends with a zero, and stays until the library is called again.
            false => unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned(),
        };
        Err(Error::new(format!("Open Image Denoise {}: {message}", self.version)))
    }
}

impl Drop for Oidn {
    fn drop(&mut self) {
        // SAFETY: the device is open, and nothing uses it after this.
        unsafe { (self.functions.release_device)(self.device) }
    }
}
