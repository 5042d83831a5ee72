//! Faults and overload: whatever happens to the machine or to a file, there is one clear error and nothing
//! half-written, and the program ends by itself.
#![cfg(target_os = "linux")]

use super::{SCENE, etendue, folder, succeed, text};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn listing(at: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(at).unwrap();
    let mut names: Vec<String> = entries
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Runs the program after a shell's `before`.
fn shell(at: &Path, before: &str, arguments: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_etendue");
    Command::new("sh")
        .args(["-c", &format!("{before}\nexec {program} {arguments}")])
        .current_dir(at)
        .output()
        .unwrap()
}

/// It must have failed by itself with one line that has all of `parts`.
fn one_error(output: &Output, parts: &[&str]) {
    let error = text(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(1),
        "{:?}: {error}",
        output.status
    );
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.starts_with("error: "), "{error}");
    for part in parts {
        assert!(error.contains(part), "no {part:?} in {error}");
    }
}

/// A disk that is full when the image is written: here, files may not grow beyond 512 bytes.
#[test]
fn a_disk_that_is_full() {
    let (_keep, at) = folder();
    std::fs::write(at.join("x.exr"), "old").unwrap();
    let full = "trap '' XFSZ; ulimit -f 1";
    for (arguments, name) in [
        ("render scene.xml --quiet -o x.exr --width 64", "x.exr"),
        (
            "render scene.xml --quiet -o x.png -o x.exr --width 64",
            "x.",
        ),
        ("compile scene.xml -o x.etd", "x.etd"),
    ] {
        one_error(&shell(&at, full, arguments), &[name, "can't be written"]);
        assert_eq!(listing(&at), ["scene.xml", "x.exr"], "{arguments}");
        assert_eq!(std::fs::read(at.join("x.exr")).unwrap(), b"old");
    }
}

/// Killed at any moment, a render leaves the old image or a whole new one under its name.
#[test]
fn killed_in_the_middle() {
    let (_keep, at) = folder();
    let arguments = [
        "render",
        "scene.xml",
        "-o",
        "x.exr",
        "--spp",
        "1",
        "--quiet",
        "--width",
        "600",
    ];
    succeed(&at, &arguments);
    let whole = std::fs::read(at.join("x.exr")).unwrap();
    for delay in 0..24 {
        std::fs::write(at.join("x.exr"), "old").unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_etendue"))
            .args(arguments)
            .current_dir(&at)
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(delay * 12));
        child.kill().unwrap();
        child.wait().unwrap();
        let left = std::fs::read(at.join("x.exr")).unwrap();
        assert!(left == b"old" || left == whole, "{} bytes", left.len());
    }
}

/// A blob that is cut, overwritten or replaced while it is read is a scene or an error, never a crash.
#[test]
fn a_blob_that_changes_while_it_is_read() {
    let (_keep, at) = folder();
    succeed(&at, &["compile", "scene.xml", "-o", "good.etd"]);
    let good = std::fs::read(at.join("good.etd")).unwrap();
    let path = at.join("moving.etd");
    for round in 0..40usize {
        std::fs::write(&path, &good).unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_etendue"))
            .args([
                "render",
                "moving.etd",
                "-o",
                "x.exr",
                "--spp",
                "1",
                "--quiet",
            ])
            .current_dir(&at)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_micros(250 * round as u64));
        match round % 3 {
            0 => std::fs::File::options()
                .write(true)
                .open(&path)
                .unwrap()
                .set_len(good.len() as u64 / 3)
                .unwrap(),
            1 => std::fs::write(&path, vec![0xff; good.len()]).unwrap(),
            _ => std::fs::rename(at.join("scene.xml"), &path)
                .and_then(|()| std::fs::write(at.join("scene.xml"), SCENE))
                .unwrap(),
        }
        let output = child.wait_with_output().unwrap();
        if !output.status.success() {
            one_error(&output, &["moving.etd"]);
        }
    }
    // A pipe that ends early, for certain.
    let made = Command::new("mkfifo").arg(at.join("pipe.etd")).status();
    assert!(made.unwrap().success());
    let (pipe, start) = (at.join("pipe.etd"), good[..good.len() / 2].to_vec());
    let writer = std::thread::spawn(move || std::fs::write(pipe, start));
    let output = etendue(&at, &["inspect", "pipe.etd"]);
    one_error(&output, &["pipe.etd", "shorter"]);
    writer.join().unwrap().unwrap();
}

/// Text that grows: a deep nest, entities of entities, a file that includes itself. All under a gigabyte of memory.
#[test]
fn xml_that_grows() {
    let (_keep, at) = folder();
    let limit = "ulimit -v 1000000";
    let scene = |name: &str, content: &str| std::fs::write(at.join(name), content).unwrap();
    let deep = 10_000;
    scene(
        "deep.xml",
        &SCENE.replace(
            "<bsdf type=\"diffuse\">",
            &"<bsdf type=\"twosided\">".repeat(deep),
        ),
    );
    let nest = "<bsdf type=\"twosided\">".repeat(deep)
        + "<bsdf type=\"diffuse\"/>"
        + &"</bsdf>".repeat(deep);
    scene(
        "closed.xml",
        &SCENE.replace("</scene>", &(nest + "</scene>")),
    );
    let mut bomb = String::from("<!DOCTYPE scene [<!ENTITY a0 \"ha\">");
    for i in 1..30 {
        let twice = format!("&a{};", i - 1).repeat(10);
        bomb += &format!("<!ENTITY a{i} \"{twice}\">");
    }
    bomb += &format!("]>{}", SCENE.replace("value=\"$grey\"", "value=\"&a29;\""));
    scene("bomb.xml", &bomb);
    scene(
        "self.xml",
        &SCENE.replace("</scene>", "<include filename=\"self.xml\"/></scene>"),
    );
    scene(
        "value.xml",
        &SCENE.replace("value=\"0.5\"", "value=\"$grey\""),
    );
    for name in [
        "deep.xml",
        "closed.xml",
        "bomb.xml",
        "self.xml",
        "value.xml",
    ] {
        let output = shell(&at, limit, &format!("inspect {name}"));
        one_error(&output, &[name]);
    }
}

/// Images whose headers promise more than there is.
#[test]
fn images_that_lie_about_their_size() {
    let (_keep, at) = folder();
    let pixels = vec![7; 3 * 64 * 64];
    let png = |w: u32, h: u32| {
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, &pixels, 64, 64, image::ExtendedColorType::Rgb8)
            .unwrap();
        // The header's size, and its checksum, which is part of the lie.
        bytes[16..20].copy_from_slice(&w.to_be_bytes());
        bytes[20..24].copy_from_slice(&h.to_be_bytes());
        let sum = crc(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.to_be_bytes());
        bytes
    };
    let hdr = |w: u32, h: u32| {
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {h} +X {w}\n").into_bytes()
    };
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg)
        .encode(&pixels, 64, 64, image::ExtendedColorType::Rgb8)
        .unwrap();
    let at_size = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap() + 5;
    jpeg[at_size..at_size + 4].fill(0xff);
    let texture = "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"NAME\"/></texture></bsdf>";
    for (name, bytes) in [
        ("wide.png", png(2_000_000_000, 1)),
        ("large.png", png(60_000, 60_000)),
        ("most.png", png(16_384, 16_384)),
        ("large.jpg", jpeg),
        ("large.hdr", hdr(4_000_000_000, 4_000_000_000)),
        ("some.hdr", hdr(30_000, 30_000)),
    ] {
        std::fs::write(at.join(name), bytes).unwrap();
        let textured = SCENE.replace(
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"$grey\"/></bsdf>",
            &texture.replace("NAME", name),
        );
        std::fs::write(at.join("image.xml"), textured).unwrap();
        let output = shell(&at, "ulimit -v 1000000", "inspect image.xml");
        one_error(&output, &[name]);
    }
}

/// PNG's checksum (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc: u32, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// Less memory than an image, a mesh or a blob takes.
#[test]
fn memory_that_is_not_there() {
    let (_keep, at) = folder();
    let limit = "ulimit -v 400000";
    let large = "render scene.xml -o x.exr --quiet --threads 1 --width 30000 --height 30000";
    one_error(
        &shell(&at, limit, large),
        &["not enough memory", "30000 × 30000"],
    );
    // A real mesh of 200 MB, of which nothing lies.
    let mut mesh = std::io::BufWriter::new(std::fs::File::create(at.join("m.obj")).unwrap());
    writeln!(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0").unwrap();
    for _ in 0..12_000_000 {
        mesh.write_all(b"f 1 2 3\n").unwrap();
    }
    mesh.into_inner().unwrap();
    let shape = "<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/></shape></scene>";
    std::fs::write(at.join("mesh.xml"), SCENE.replace("</scene>", shape)).unwrap();
    one_error(
        &shell(&at, limit, "compile mesh.xml -o x.etd"),
        &["mesh.xml", "not enough memory"],
    );
    let blob = std::fs::File::create(at.join("vast.etd")).unwrap();
    blob.set_len(1 << 40).unwrap();
    one_error(
        &shell(&at, limit, "inspect vast.etd"),
        &["vast.etd", "memory"],
    );
    // Headers that promise what isn't there ask for nothing.
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
               property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n";
    std::fs::write(at.join("m.ply"), ply).unwrap();
    let shape = shape.replace("obj", "ply");
    std::fs::write(at.join("lie.xml"), SCENE.replace("</scene>", &shape)).unwrap();
    one_error(&shell(&at, limit, "compile lie.xml -o x.etd"), &["m.ply"]);
    let names = [
        "lie.xml",
        "m.obj",
        "m.ply",
        "mesh.xml",
        "scene.xml",
        "vast.etd",
    ];
    assert_eq!(listing(&at), names);
}

/// More threads than there is memory for.
#[test]
fn threads_that_are_not_there() {
    let (_keep, at) = folder();
    let many = |threads: u32| {
        let arguments = format!("render scene.xml -o x.exr --quiet --spp 1 --threads {threads}");
        let output = shell(&at, "ulimit -v 400000", &arguments);
        one_error(&output, &[&format!("{threads} threads")]);
    };
    // Far too many, and about as many as there is room for.
    for threads in [4096, 1024, 256, 180] {
        many(threads);
    }
    assert_eq!(listing(&at), ["scene.xml"]);
}
