//! As much of Embree 4 as the benches need, loaded at run time.

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};

use libloading::Library;

type Pointer = *mut c_void;

/// A ray and its hit, laid out as Embree has them.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct RayHit {
    pub origin: [f32; 3],
    pub near: f32,
    pub direction: [f32; 3],
    pub time: f32,
    pub far: f32,
    pub mask: u32,
    pub id: u32,
    pub flags: u32,
    pub normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub primitive: u32,
    pub geometry: u32,
    pub instance: [u32; 2],
}

/// Embree's mark for nothing.
pub const NONE: u32 = u32::MAX;

impl RayHit {
    pub fn new(origin: [f32; 3], direction: [f32; 3], far: f32) -> Self {
        Self {
            origin,
            near: 0.0,
            direction,
            time: 0.0,
            far,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: NONE,
            geometry: NONE,
            instance: [NONE; 2],
        }
    }
}

/// The library, with a device of one thread.
pub struct Embree {
    library: Library,
    device: Pointer,
    intersect: unsafe extern "C" fn(Pointer, *mut RayHit, Pointer),
    occluded: unsafe extern "C" fn(Pointer, *mut RayHit, Pointer),
}

/// A scene of one mesh.
pub struct EmbreeScene<'a> {
    embree: &'a Embree,
    scene: Pointer,
}

/// How good a tree Embree builds, and how careful its tests are.
#[derive(Clone, Copy, Debug)]
pub enum Mode {
    Medium,
    Robust,
}

impl Embree {
    /// Loads the library that the environment variable `EMBREE_LIB` names.
    ///
    /// # Errors
    /// What is missing, and how to get it.
    pub fn load() -> Result<Self, String> {
        let path = std::env::var("EMBREE_LIB").map_err(|_| {
            "EMBREE_LIB names no library. `pip download --no-deps embreex`, unzip the wheel, and set it to the \
             path of embreex.libs/libembree4-*.so.4 (with LD_LIBRARY_PATH at its folder, where TBB is)"
                .to_string()
        })?;
        // SAFETY: Embree 4, as the user says; the functions are those of its C interface.
        unsafe {
            let library = Library::new(&path).map_err(|e| format!("{path}: {e}"))?;
            let new_device: unsafe extern "C" fn(*const c_char) -> Pointer =
                *library.get(b"rtcNewDevice\0").map_err(|e| e.to_string())?;
            let intersect = *library.get(b"rtcIntersect1\0").map_err(|e| e.to_string())?;
            let occluded = *library.get(b"rtcOccluded1\0").map_err(|e| e.to_string())?;
            let config: &CStr = c"threads=1";
            let device = new_device(config.as_ptr());
            if device.is_null() {
                return Err("Embree makes no device".into());
            }
            Ok(Self { library, device, intersect, occluded })
        }
    }

    /// Builds a scene of triangles.
    pub fn build(&self, positions: &[[f32; 3]], triangles: &[[u32; 3]], mode: Mode) -> EmbreeScene<'_> {
        const TRIANGLES: c_int = 0;
        const BUFFER_INDEX: c_int = 0;
        const BUFFER_VERTEX: c_int = 1;
        const UINT3: c_int = 0x5003;
        const FLOAT3: c_int = 0x9003;
        const ROBUST: c_int = 1 << 2;
        const MEDIUM_QUALITY: c_int = 1;
        type Get = unsafe extern "C" fn(Pointer, c_int) -> Pointer;
        type Make = unsafe extern "C" fn(Pointer) -> Pointer;
        type Do = unsafe extern "C" fn(Pointer);
        type Set = unsafe extern "C" fn(Pointer, c_int);
        type Buffer = unsafe extern "C" fn(Pointer, c_int, c_uint, c_int, usize, usize) -> Pointer;
        type Attach = unsafe extern "C" fn(Pointer, Pointer) -> c_uint;
        // SAFETY: the types are those of Embree 4's header; buffers are written within their lengths.
        unsafe {
            let get = |name: &[u8]| *self.library.get::<Pointer>(name).expect("a function of Embree 4");
            let new_geometry: Get = std::mem::transmute(get(b"rtcNewGeometry\0"));
            let new_scene: Make = std::mem::transmute(get(b"rtcNewScene\0"));
            let set_flags: Set = std::mem::transmute(get(b"rtcSetSceneFlags\0"));
            let set_quality: Set = std::mem::transmute(get(b"rtcSetSceneBuildQuality\0"));
            let buffer: Buffer = std::mem::transmute(get(b"rtcSetNewGeometryBuffer\0"));
            let commit_geometry: Do = std::mem::transmute(get(b"rtcCommitGeometry\0"));
            let attach: Attach = std::mem::transmute(get(b"rtcAttachGeometry\0"));
            let release: Do = std::mem::transmute(get(b"rtcReleaseGeometry\0"));
            let commit: Do = std::mem::transmute(get(b"rtcCommitScene\0"));
            let geometry = new_geometry(self.device, TRIANGLES);
            let v = buffer(geometry, BUFFER_VERTEX, 0, FLOAT3, 12, positions.len());
            std::ptr::copy_nonoverlapping(positions.as_ptr(), v.cast(), positions.len());
            let i = buffer(geometry, BUFFER_INDEX, 0, UINT3, 12, triangles.len());
            std::ptr::copy_nonoverlapping(triangles.as_ptr(), i.cast(), triangles.len());
            commit_geometry(geometry);
            let scene = new_scene(self.device);
            set_quality(scene, MEDIUM_QUALITY);
            if matches!(mode, Mode::Robust) {
                set_flags(scene, ROBUST);
            }
            attach(scene, geometry);
            release(geometry);
            commit(scene);
            EmbreeScene { embree: self, scene }
        }
    }
}

impl EmbreeScene<'_> {
    /// Finds the nearest hit; `geometry` is [`NONE`] if there is none.
    #[inline]
    pub fn intersect(&self, ray: &mut RayHit) {
        // SAFETY: the scene is built, the ray is laid out and aligned as Embree asks.
        unsafe { (self.embree.intersect)(self.scene, ray, std::ptr::null_mut()) }
    }

    /// Whether there is any hit.
    #[inline]
    pub fn occluded(&self, ray: &mut RayHit) -> bool {
        // SAFETY: the scene is built, and what Embree writes is the ray's end.
        unsafe { (self.embree.occluded)(self.scene, ray, std::ptr::null_mut()) }
        ray.far < 0.0
    }
}

impl Drop for EmbreeScene<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene is not used any more.
        unsafe {
            if let Ok(release) =
                self.embree.library.get::<unsafe extern "C" fn(Pointer)>(b"rtcReleaseScene\0")
            {
                release(self.scene);
            }
        }
    }
}
