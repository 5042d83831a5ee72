//! Meshes and images written to bytes and read back; every way of breaking them.

mod robust;
mod volume;

use super::{RawMesh, bitmap, obj, ply, serialized};
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;
use std::path::{Path, PathBuf};

fn at() -> &'static Path {
    Path::new("m")
}

fn square(normals: bool, uvs: bool) -> RawMesh {
    RawMesh {
        positions: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.5],
            [0.0, 1.0, 0.0],
        ],
        normals: normals.then(|| {
            vec![
                [0.0, 0.0, 1.0],
                [0.0, 1.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 0.0, -1.0],
            ]
        }),
        uvs: uvs.then(|| vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        face_normals: false,
    }
}

/// A PLY of the square, as one quad or as triangles.
fn write_ply(format: &str, quad: bool, float: &str) -> Vec<u8> {
    let mesh = square(true, true);
    let mut out = format!("ply\nformat {format} 1.0\ncomment c\nelement vertex 4\n").into_bytes();
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        out.extend(format!("property {float} {name}\n").bytes());
    }
    out.extend(format!("property uchar red\nproperty {float} s\nproperty {float} t\n").bytes());
    let faces: Vec<Vec<i32>> = if quad {
        vec![vec![0, 1, 2, 3]]
    } else {
        vec![vec![0, 1, 2], vec![0, 2, 3]]
    };
    out.extend(
        format!(
            "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            faces.len()
        )
        .bytes(),
    );
    let (normals, uvs) = (mesh.normals.expect("normals"), mesh.uvs.expect("uvs"));
    for i in 0..4 {
        let number = |out: &mut Vec<u8>, x: f32| match (format, float) {
            ("ascii", _) => out.extend(format!("{x} ").bytes()),
            ("binary_little_endian", "float") => out.extend(x.to_le_bytes()),
            ("binary_little_endian", _) => out.extend(f64::from(x).to_le_bytes()),
            (_, "float") => out.extend(x.to_be_bytes()),
            _ => out.extend(f64::from(x).to_be_bytes()),
        };
        mesh.positions[i]
            .iter()
            .chain(&normals[i])
            .for_each(|x| number(&mut out, *x));
        if format == "ascii" {
            out.extend(b"7 ")
        } else {
            out.push(7)
        }
        uvs[i].iter().for_each(|x| number(&mut out, *x));
        if format == "ascii" {
            out.push(b'\n');
        }
    }
    for face in &faces {
        match format {
            "ascii" => {
                let text: Vec<String> = face.iter().map(i32::to_string).collect();
                out.extend(format!("{} {}\n", face.len(), text.join(" ")).bytes());
            }
            _ => {
                out.push(face.len() as u8);
                for i in face {
                    out.extend(if format == "binary_little_endian" {
                        i.to_le_bytes()
                    } else {
                        i.to_be_bytes()
                    });
                }
            }
        }
    }
    out
}

#[test]
fn ply_of_every_format_reads_the_same() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for quad in [false, true] {
            for float in ["float", "double"] {
                let mesh = ply::parse(&write_ply(format, quad, float), at());
                assert_eq!(
                    mesh.expect(format),
                    square(true, true),
                    "{format} {quad} {float}"
                );
            }
        }
    }
    let slow = String::from_utf8(write_ply("ascii", true, "float")).expect("text");
    let slow = slow
        .replace("property list", "property int material\nproperty list")
        .replace("\n4 0", "\n9 4 0");
    assert_eq!(
        ply::parse(slow.as_bytes(), at()).expect("more properties"),
        square(true, true)
    );
}

#[test]
fn ply_cut_anywhere_is_an_error() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let whole = write_ply(format, false, "float");
        for length in 0..whole.len() - 1 {
            let cut = ply::parse(&whole[..length], at()).and_then(|m| m.check(at()));
            // An ASCII file may lose the end of its last number and still be one.
            assert!(
                cut.is_err() || (format == "ascii" && length + 3 > whole.len()),
                "{format} {length}"
            );
        }
    }
}

#[test]
fn ply_that_lies() {
    let text = String::from_utf8(write_ply("ascii", true, "float")).expect("text");
    for (from, to, part) in [
        ("ply\n", "plx\n", "expected a PLY file"),
        ("ascii", "base64", "expected ascii or binary"),
        ("float x", "quad x", "expected a PLY type"),
        ("float x", "float q", "vertices without x, y and z"),
        (
            "element face 1",
            "element face 99999999999",
            "file ends too early",
        ),
        (
            "element vertex 4",
            "element vertex 4000000000",
            "file ends too early",
        ),
        (
            "element vertex 4",
            "element vertex many",
            "expected a count",
        ),
        (
            "list uchar int vertex_indices",
            "list uchar int corners",
            "faces without a list",
        ),
        ("list uchar", "list float", "expected an integer type"),
        (
            "\n4 0 1 2 3",
            "\n2 0 1",
            "has 2 vertices, expected 3 or more",
        ),
        (
            "\n4 0 1 2 3",
            "\n3 0 1 -2",
            "has vertex -2, expected an index",
        ),
        ("\n4 0 1 2 3", "\n3 0 1 9", "expected indices below 4"),
        (
            "\n0 0 0 ",
            "\nnan 0 0 ",
            "vertex 0 is [NaN, 0.0, 0.0], expected finite numbers",
        ),
        ("\n0 0 0 ", "\nx 0 0 ", "m:17: \"x\", expected a number"),
        ("element face", "element fan", "exactly one element face"),
        (
            "end_header",
            "end_of_header",
            "expected a line of a PLY header",
        ),
    ] {
        let broken = text.replace(from, to);
        assert_ne!(broken, text, "{from}");
        let error = ply::parse(broken.as_bytes(), at()).and_then(|m| m.check(at()));
        let error = error.expect_err(to).to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn obj_faces_of_every_form() {
    let mut warnings = Vec::new();
    let mut read = |text: &str| obj::parse(text.as_bytes(), at(), false, &mut warnings);
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n";
    let quad = read(&format!("# c\n{corners}g a\nusemtl x\nf 1 2 3 4\n")).expect("a quad");
    assert_eq!(quad, square(false, false));
    let back = read(&format!("{corners}f -4 -3 -2\r\nf -4 -2 -1\r\n")).expect("from the end");
    assert_eq!(back, square(false, false));
    let uvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let with_uv = read(&format!("{corners}{uvs}f 1/1 2/2 3/3 4/4")).expect("uv");
    assert_eq!(with_uv, square(false, true));
    let normals = "vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nvn 0 0 -1\n";
    let full = read(&format!("{corners}{uvs}{normals}f 1/1/1 2/2/2 3/3/3 4/4/4")).expect("all");
    assert_eq!(full, square(true, true));
    let split = read(&format!(
        "{corners}{normals}f 1//1 2//1 3//1\nf 1//2 3//2 4//2"
    ))
    .expect("creases");
    assert_eq!((split.positions.len(), split.triangles.len()), (6, 2));
    for (text, part) in [
        ("v 1 2\n", "m:1: 2 numbers, expected 3"),
        ("v 1 2 x\n", "m:1: \"x\", expected a number"),
        ("\nv 1 2 nan\n", "m:2: nan, expected a finite number"),
        (
            "v 0 0 0\nf 1 1 2\n",
            "m:2: face uses vertex 2, expected 1 to 1",
        ),
        ("v 0 0 0\nf 0 1 1\n", "face uses vertex 0"),
        (
            "v 0 0 0\nf 1/1 1/1 1/1\n",
            "face uses texture coordinate 1, expected 1 to 0",
        ),
        (
            "v 0 0 0\nf 1 1\n",
            "m:2: face of 2 vertices, expected 3 or more",
        ),
        ("v 0 0 0\nf a b c\n", "expected v, v/vt, v//vn or v/vt/vn"),
        ("curv 0 1\n", "unknown keyword \"curv\""),
    ] {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(part), "{error}");
    }
    let mixed = read(&format!(
        "{corners}{normals}l 1 2\nf 1//1 2//2 3//3\nf 1 3 4"
    ))
    .expect("mixed");
    assert_eq!(mixed.normals, None);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

/// A serialized file of these meshes.
fn write_serialized(meshes: &[(RawMesh, u32)], version: u16) -> Vec<u8> {
    let mut out = Vec::new();
    let mut offsets = Vec::new();
    for (mesh, flags) in meshes {
        offsets.push(out.len() as u64);
        out.extend([0x041Cu16.to_le_bytes(), version.to_le_bytes()].concat());
        let mut data = Vec::new();
        let kinds = u32::from(mesh.normals.is_some()) | u32::from(mesh.uvs.is_some()) << 1;
        data.extend((flags | kinds).to_le_bytes());
        if version == 4 {
            data.extend(b"name\0");
        }
        data.extend((mesh.positions.len() as u64).to_le_bytes());
        data.extend((mesh.triangles.len() as u64).to_le_bytes());
        let normals = mesh.normals.iter().flatten().flatten();
        let uvs = mesh.uvs.iter().flatten().flatten();
        for x in mesh.positions.iter().flatten().chain(normals).chain(uvs) {
            match flags & 0x2000 {
                0 => data.extend(x.to_le_bytes()),
                _ => data.extend(f64::from(*x).to_le_bytes()),
            }
        }
        mesh.triangles
            .iter()
            .flatten()
            .for_each(|i| data.extend(i.to_le_bytes()));
        let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
        zlib.write_all(&data).expect("packed");
        out.extend(zlib.finish().expect("packed"));
    }
    for o in offsets {
        if version == 4 {
            out.extend(o.to_le_bytes())
        } else {
            out.extend((o as u32).to_le_bytes())
        }
    }
    out.extend((meshes.len() as u32).to_le_bytes());
    out
}

fn read_serialized(bytes: &[u8], index: usize) -> Result<RawMesh, String> {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("m.serialized");
    std::fs::write(&path, bytes).expect("a file");
    serialized::load(&path, index).map_err(|e| e.to_string())
}

#[test]
fn serialized_of_both_versions() {
    for version in [3, 4] {
        let meshes = [
            (square(true, false), 0x1000),
            (square(false, true), 0x2000),
            (square(true, true), 0x1010),
        ];
        let bytes = write_serialized(&meshes, version);
        assert_eq!(read_serialized(&bytes, 0).expect("first"), meshes[0].0);
        assert_eq!(read_serialized(&bytes, 1).expect("second"), meshes[1].0);
        let third = read_serialized(&bytes, 2).expect("third");
        assert_eq!(
            third,
            RawMesh {
                face_normals: true,
                ..square(true, true)
            }
        );
        let error = read_serialized(&bytes, 3).expect_err("fourth");
        assert!(
            error.contains("shape_index 3, expected less than 3"),
            "{error}"
        );
        for length in 0..50 {
            assert!(read_serialized(&bytes[..length], 0).is_err(), "{length}");
        }
    }
    let mut bytes = write_serialized(&[(square(false, false), 0x1000)], 4);
    bytes[2] = 9;
    assert!(
        read_serialized(&bytes, 0)
            .expect_err("version")
            .contains("version 9, expected 3 or 4")
    );
    bytes[0] = 0;
    assert!(
        read_serialized(&bytes, 0)
            .expect_err("magic")
            .contains("expected 0x041c")
    );
    let mut header = vec![0x1c, 4, 4, 0];
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    let counts = [1u64 << 31, 1 << 31].map(u64::to_le_bytes).concat();
    zlib.write_all(&[&0x1000u32.to_le_bytes()[..], b"\0", &counts].concat())
        .expect("packed");
    header.extend(zlib.finish().expect("packed"));
    assert!(
        read_serialized(&header, 0)
            .expect_err("counts")
            .contains("ends within its positions")
    );
}

#[test]
fn images_that_lie_about_their_size() {
    let dir = tempfile::tempdir().expect("a folder");
    let path: PathBuf = dir.path().join("big.png");
    image::save_buffer(&path, &[0u8; 12], 2, 2, image::ColorType::Rgb8).expect("a PNG");
    let mut bytes = std::fs::read(&path).expect("bytes");
    // Width and height of the header, and its checksum.
    bytes[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    std::fs::write(&path, &bytes).expect("a file");
    let error = bitmap::load(&path, false).expect_err("a lie").to_string();
    assert!(
        error.contains("65535 x 65535 pixels in a file of"),
        "{error}"
    );
    bytes.truncate(40);
    std::fs::write(&path, &bytes).expect("a file");
    assert!(bitmap::load(&path, false).is_err());
}

#[test]
fn floats_come_from_exr_and_hdr() {
    let dir = tempfile::tempdir().expect("a folder");
    let colors = [[0.5f32, 2.0, 100.0], [0.0, 1.0, 0.25]];
    let path = dir.path().join("a.exr");
    exr::prelude::write_rgb_file(&path, 2, 1, |x, _| {
        (colors[x][0], colors[x][1], colors[x][2])
    })
    .expect("an EXR");
    let (width, height, texels) = bitmap::load_linear(&path).expect("an image");
    assert_eq!((width, height, texels.as_slice()), (2, 1, &colors[..]));
    let bytes = std::fs::read(&path).expect("bytes");
    for length in (0..bytes.len()).step_by(7) {
        std::fs::write(&path, &bytes[..length]).expect("a file");
        assert!(
            bitmap::load_linear(&path).is_err(),
            "{length} of {}",
            bytes.len()
        );
    }
    exr::prelude::write_rgb_file(&path, 1, 1, |_, _| (f32::NAN, 0.0, 0.0)).expect("an EXR");
    let error = bitmap::load_linear(&path).expect_err("NaN").to_string();
    assert!(
        error.contains("pixel (0, 0) must be finite, found [NaN"),
        "{error}"
    );
    let path = dir.path().join("a.hdr");
    let file = std::fs::File::create(&path).expect("a file");
    let pixels: Vec<_> = colors.iter().map(|c| image::Rgb(*c)).collect();
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&pixels, 2, 1)
        .expect("an HDR");
    let (_, _, texels) = bitmap::load_linear(&path).expect("an image");
    assert!(
        (texels[0][2] - 100.0).abs() < 0.5 && (texels[1][1] - 1.0).abs() < 0.01,
        "{texels:?}"
    );
}
