//! Bytes as a Mitsuba scene.

use super::estimates;
use etendue::Scene;
use etendue_host::compile::compile;
use etendue_host::description::Description;
use etendue_host::load::load;
use std::path::Path;

/// Files that a scene may name, beside it.
const BESIDE: [(&str, &[u8]); 3] = [
    ("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    (
        "m.ply",
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
          element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    ),
    // Two texels, 0.5 and 1.
    (
        "v.vol",
        b"VOL\x03\x01\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80?\0\0\x80?\0\0\x80?\0\0\0?\0\0\x80?",
    ),
];

thread_local! {
    static FOLDER: tempfile::TempDir = furnished();
}

/// A folder for the scene, in memory where there is such a place.
fn furnished() -> tempfile::TempDir {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir());
    let folder = folder.expect("a folder");
    for (name, bytes) in BESIDE {
        std::fs::write(folder.path().join(name), bytes).expect("a file");
    }
    let pixels: Vec<u8> = (0..48).map(|i| i * 5).collect();
    let color = image::ColorType::Rgb8;
    image::save_buffer(folder.path().join("t.png"), &pixels, 4, 4, color).expect("an image");
    folder
}

/// **Property:** any text is refused with one error that names the file, or is a scene; a scene is refused by the
/// compiler with a reason, or compiles to a blob that opens and whose estimates are finite and ≥ 0.
pub fn xml(bytes: &[u8]) {
    FOLDER.with(|folder| {
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, bytes).expect("a file");
        match load(&path, &[]) {
            Ok(loaded) => opens(&loaded.description),
            // The error may be about a file that the scene names; it is never about nothing.
            Err(e) => named(&e.to_string(), &e.place.file),
        }
    });
}

/// An error begins with the file that it is about.
pub(super) fn named(error: &str, file: &Path) {
    assert!(
        !file.as_os_str().is_empty() && error.starts_with(&*file.to_string_lossy()),
        "{error}"
    );
}

/// What loads compiles to a blob that opens, or the compiler says why not.
pub(super) fn opens(description: &Description) {
    match compile(description) {
        Ok(compiled) => {
            let scene = Scene::open(compiled.blob.bytes()).expect("a blob that opens");
            estimates(&scene, 1);
        }
        Err(e) => assert!(!e.name.is_empty() && !e.reason.is_empty(), "{e}"),
    }
}
