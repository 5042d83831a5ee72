//! Blobs, renders and files: wrong pointers, and what the world has to say.

use super::{Builder, made, no_memory, off, pointers, sized, triangle};
use etendue::capi::scene::{ETD_SCENE_SIZE, EtdScene, etd_scene_open};
use etendue::capi::settings::{ETD_METROPOLIS, EtdSettings, etd_settings_default};
use etendue::capi::status::*;
use etendue_host_capi::blob::{EtdBlob, etd_blob_free};
use etendue_host_capi::builder::*;
use etendue_host_capi::hooks::EtdHost;
use etendue_host_capi::load::*;
use etendue_host_capi::object::*;
use etendue_host_capi::render::*;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};

unsafe extern "C" fn keep(_: *mut c_void, _: *mut c_void, _: usize, _: usize) {}

#[test]
fn blobs() {
    let b = Builder::small(null());
    // SAFETY: good pointers or such as are found out.
    unsafe {
        let free = |blob: *mut EtdBlob| {
            if !blob.is_null() && blob.is_aligned() && (*blob).size > 0 {
                assert_eq!(etd_blob_free(blob), ETD_OK);
            }
        };
        for call in [etd_builder_build, etd_builder_refit] {
            pointers(sized::<EtdBlob>(), |blob| {
                let status = call(b.0, blob, null_mut());
                free(blob);
                status
            });
            let mut blob: EtdBlob = sized();
            let blob = &raw mut blob;
            let mut built: EtdBuilt = sized();
            assert_eq!(call(b.0, blob, off(&raw mut built)), ETD_E_MISALIGNED);
            built.struct_size = 0;
            assert_eq!(call(b.0, blob, &raw mut built), ETD_E_SIZE);
            assert!((*blob).data.is_null());
        }
        pointers(sized::<EtdBlob>(), |blob| etd_blob_free(blob));
        let mut blob = b.build();
        assert_eq!(etd_blob_free(&raw mut blob), ETD_OK);
        assert_eq!(etd_blob_free(&raw mut blob), ETD_OK);
        // No memory: a status, and nothing to free.
        let mut host: EtdHost = sized();
        host.allocate = Some(no_memory);
        host.release = Some(keep);
        let poor = Builder::small(&host);
        let status = etd_builder_build(poor.0, &raw mut blob, null_mut());
        assert_eq!((status, blob.size), (ETD_E_MEMORY, 0));
        assert!(poor.message().contains("memory"), "{}", poor.message());
        // A light without area is found when it is built.
        let mut id = 0;
        let mut line = triangle();
        line.indices = [0, 0, 0].as_ptr();
        assert_eq!(etd_builder_add_mesh(b.0, &line, &raw mut id), ETD_OK);
        let status = etd_builder_build(b.0, &raw mut blob, null_mut());
        assert_eq!(status, ETD_E_SCENE);
        assert_eq!(
            b.message(),
            "object 1: a light needs an area of at least 1e-37, found 0e0"
        );
    }
}

unsafe extern "C" fn stop(_: *mut c_void, _: u64, _: f64) -> i32 {
    1
}

unsafe extern "C" fn lazy(
    _: *mut c_void,
    _: u32,
    _: Option<unsafe extern "C" fn(context: *mut c_void, index: u32)>,
    _: *mut c_void,
) {
}

#[test]
fn renders() {
    let mut blob = Builder::small(null()).build();
    let mut memory = [0_u128; ETD_SCENE_SIZE / 16];
    let mut scene: *const EtdScene = null();
    let settings: EtdSettings = made(etd_settings_default);
    let mut how: EtdRender = sized();
    how.samples = 1000;
    let mut rgb = [-1.0_f32; 192];
    let out = rgb.as_mut_ptr();
    // SAFETY: good pointers or such as are found out.
    unsafe {
        let place = memory.as_mut_ptr().cast();
        let opened = etd_scene_open(
            ETD_ABI_VERSION,
            blob.data,
            blob.size,
            place,
            ETD_SCENE_SIZE,
            &raw mut scene,
            null_mut(),
        );
        assert_eq!(opened, ETD_OK);
        let call = etd_host_render;
        pointers(settings, |s| call(scene, s, &how, out, 192, null_mut()));
        pointers(how, |h| call(scene, &settings, h, out, 192, null_mut()));
        let mut rendered: EtdRendered = sized();
        let report = &raw mut rendered;
        rgb = [-1.0; 192];
        assert_eq!(call(null(), &settings, &how, out, 192, report), ETD_E_NULL);
        let foreign = place.cast::<u8>().add(16).cast();
        assert_eq!(
            call(foreign, &settings, &how, out, 192, report),
            ETD_E_HANDLE
        );
        assert_eq!(
            call(off(scene.cast_mut()), &settings, &how, out, 192, report),
            ETD_E_MISALIGNED
        );
        assert_eq!(
            call(scene, &settings, &how, null_mut(), 192, report),
            ETD_E_NULL
        );
        assert_eq!(
            call(scene, &settings, &how, off(out), 192, report),
            ETD_E_MISALIGNED
        );
        assert_eq!(call(scene, &settings, &how, out, 191, report), ETD_E_SIZE);
        assert_eq!(
            call(scene, &settings, &how, out, 192, off(report)),
            ETD_E_MISALIGNED
        );
        for (samples, seconds) in [(0, 0.0), (0, -1.0), (0, f64::NAN), (0, f64::INFINITY)] {
            (how.samples, how.seconds) = (samples, seconds);
            assert_eq!(
                call(scene, &settings, &how, out, 192, report),
                ETD_E_ARGUMENT
            );
        }
        how.samples = 4;
        how.run = Some(lazy);
        assert_eq!(call(scene, &settings, &how, out, 192, report), ETD_E_JOBS);
        assert!(rgb.iter().all(|x| *x == -1.0) && rendered.samples == 0);
        // Cancelled: what is done is there.
        (how.samples, how.run) = (1 << 40, None);
        how.progress = Some(stop);
        assert_eq!(
            call(scene, &settings, &how, out, 192, report),
            ETD_E_CANCELLED
        );
        assert!(rgb.iter().all(|x| *x >= 0.0) && rgb.contains(&1.0));
        assert!((1..1000).contains(&rendered.samples));
        assert_eq!((rendered.width, rendered.height), (8, 8));
        // A time.
        (how.samples, how.seconds, how.progress) = (0, 0.01, None);
        assert_eq!(call(scene, &settings, &how, out, 192, report), ETD_OK);
        assert!(rendered.samples > 0);
        // An error: reached, out of reach in the samples there are, impossible.
        (how.samples, how.seconds, how.error) = (0, 0.0, 0.3);
        assert_eq!(call(scene, &settings, &how, out, 192, report), ETD_OK);
        assert!(rendered.met == 1 && rendered.error <= 0.3 && rendered.samples > 0);
        (how.samples, how.error) = (16, 1e-6);
        assert_eq!(call(scene, &settings, &how, out, 192, report), ETD_OK);
        assert!(rendered.met == 0 && rendered.error > 1e-6);
        assert!((12..=20).contains(&rendered.samples));
        for (seconds, error) in [
            (0.0, -1.0),
            (0.0, f64::NAN),
            (0.0, f64::INFINITY),
            (-1.0, 0.1),
        ] {
            (how.seconds, how.error) = (seconds, error);
            assert_eq!(
                call(scene, &settings, &how, out, 192, report),
                ETD_E_ARGUMENT
            );
        }
        (how.seconds, how.error) = (0.0, 0.1);
        let chains = EtdSettings {
            estimator: ETD_METROPOLIS,
            ..settings
        };
        assert_eq!(
            call(scene, &chains, &how, out, 192, report),
            ETD_E_UNSUPPORTED
        );
        assert_eq!(etd_blob_free(&raw mut blob), ETD_OK);
    }
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let text = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        CString::new(path.to_str().unwrap()).unwrap()
    };
    let mut message = [0 as c_char; 512];
    let mut blob: EtdBlob = sized();
    let mut advice: EtdAdvice = sized();
    let blob = &raw mut blob;
    // SAFETY: good pointers or such as are found out.
    unsafe {
        let load = |path: *const c_char, defines: &[*const c_char], message: *mut c_char| {
            let (first, count) = (defines.as_ptr(), defines.len());
            etd_load_file(
                1,
                path,
                first,
                count,
                null(),
                blob,
                null_mut(),
                message,
                512,
            )
        };
        let says = |path: &CStr, status: EtdStatus, what: &str| {
            assert_eq!(
                load(path.as_ptr(), &[], message.as_ptr().cast_mut()),
                status
            );
            let said = CStr::from_ptr(message.as_ptr()).to_str().unwrap();
            assert!(said.contains(what), "{said}");
        };
        says(
            c"/no/such/file.xml",
            ETD_E_IO,
            "/no/such/file.xml: cannot be read",
        );
        says(c"/no/such/file.etd", ETD_E_IO, "/no/such/file.etd");
        says(&text("a.txt", ""), ETD_E_PARSE, "scene format");
        says(&text("a.etd", "no blob"), ETD_E_PARSE, "a.etd");
        let wrong = text(
            "b.xml",
            "<scene version='3.0.0'>\n<shape type='tea'/></scene>",
        );
        says(&wrong, ETD_E_PARSE, "b.xml:2");
        let later = "<scene version='3.0.0'>\n<integrator type='path'/><shape type='sphere'>\n</shape><emitter type='sunsky'/></scene>";
        says(&text("c.xml", later), ETD_E_UNSUPPORTED, "c.xml:3");
        let good = text(
            "d.xml",
            "<scene version='3.0.0'><default name='size' value='4'/>
             <integrator type='path'><integer name='max_depth' value='5'/></integrator>
             <sensor type='perspective'><film type='hdrfilm'><integer name='width' value='$size'/>
             <integer name='height' value='4'/></film></sensor><shape type='sphere'/></scene>",
        );
        assert_eq!(load(null(), &[], null_mut()), ETD_E_NULL);
        assert_eq!(load(good.as_ptr(), &[], null_mut()), ETD_E_NULL);
        let buffer = message.as_mut_ptr();
        assert_eq!(load(good.as_ptr(), &[null()], buffer), ETD_E_NULL);
        assert_eq!(
            load(good.as_ptr(), &[c"size".as_ptr()], buffer),
            ETD_E_ARGUMENT
        );
        assert_eq!(load(c"\xff.xml".as_ptr(), &[], buffer), ETD_E_ARGUMENT);
        assert!((*blob).data.is_null());
        let defines = [c"size=6".as_ptr()];
        let ask = |version, defines, host, blob, advice| {
            etd_load_file(
                version,
                good.as_ptr(),
                defines,
                1,
                host,
                blob,
                advice,
                null_mut(),
                0,
            )
        };
        let first = defines.as_ptr();
        assert_eq!(ask(0, first, null(), blob, null_mut()), ETD_E_ABI);
        assert_eq!(ask(1, null(), null(), blob, null_mut()), ETD_E_NULL);
        assert_eq!(
            ask(1, off(first.cast_mut()), null(), blob, null_mut()),
            ETD_E_MISALIGNED
        );
        let mut host: EtdHost = sized();
        host.struct_size = 0;
        assert_eq!(ask(1, first, &raw const host, blob, null_mut()), ETD_E_SIZE);
        let free = |blob: *mut EtdBlob, status| {
            if status == ETD_OK {
                assert_eq!(etd_blob_free(blob), ETD_OK);
            }
            status
        };
        pointers(sized::<EtdBlob>(), |b| {
            free(b, ask(1, first, null(), b, null_mut()))
        });
        let far = off(&raw mut advice);
        assert_eq!(ask(1, first, null(), blob, far), ETD_E_MISALIGNED);
        assert_eq!(ask(1, first, null(), blob, &raw mut advice), ETD_OK);
        assert_eq!((advice.max_edges, advice.samples), (5, 0));
        // The same file as a blob.
        let stored = folder.path().join("e.etd");
        let bytes = std::slice::from_raw_parts((*blob).data, (*blob).size);
        std::fs::write(&stored, bytes).unwrap();
        let mut again: EtdBlob = sized();
        let path = CString::new(stored.to_str().unwrap()).unwrap();
        let none = (null(), 0, null(), null_mut(), null_mut(), 0);
        let status = etd_load_file(
            1,
            path.as_ptr(),
            none.0,
            none.1,
            none.2,
            &raw mut again,
            none.3,
            none.4,
            none.5,
        );
        assert_eq!(status, ETD_OK);
        assert_eq!(std::slice::from_raw_parts(again.data, again.size), bytes);
        assert_eq!(etd_blob_free(&raw mut again), ETD_OK);
        assert_eq!(etd_blob_free(blob), ETD_OK);
    }
}
