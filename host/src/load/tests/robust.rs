//! Broken bytes and large ones.

use super::*;

/// Bytes changed at random are read or refused, never more.
#[test]
fn broken_bytes_do_no_harm() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("m");
    let (png, exr, hdr) = (
        dir.path().join("a.png"),
        dir.path().join("a.exr"),
        dir.path().join("a.hdr"),
    );
    image::save_buffer(&png, &[99u8; 48], 4, 4, image::ColorType::Rgb8).expect("a PNG");
    exr::prelude::write_rgb_file(&exr, 4, 4, |x, y| (x as f32, y as f32, 1.0)).expect("an EXR");
    let file = std::fs::File::create(&hdr).expect("a file");
    let pixels = [image::Rgb([0.5f32, 1.0, 2.0]); 16];
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&pixels, 4, 4)
        .expect("an HDR");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 -1/-1/-1\n";
    let xml = "<scene version='3.0.0'><default name='r' value='1'/><sensor type='perspective'><float name='fov' value='40'/>
        <transform name='to_world'><lookat origin='0 0 1' target='0 0 0' up='0 1 0'/></transform></sensor>
        <bsdf type='twosided' id='b'><bsdf type='diffuse'><rgb name='reflectance' value='.5, .5, .5'/></bsdf></bsdf>
        <shape type='sphere'><float name='radius' value='$r'/><ref id='b'/></shape></scene>";
    let read = |path: &Path| std::fs::read(path).expect("bytes");
    let seeds: [(&str, Vec<u8>); 10] = [
        ("ply", write_ply("ascii", false, "float")),
        ("ply", write_ply("binary_little_endian", false, "float")),
        ("ply", write_ply("binary_big_endian", true, "double")),
        ("obj", obj.into()),
        (
            "serialized",
            write_serialized(
                &[(square(true, true), 0x1000), (square(false, false), 0x2000)],
                4,
            ),
        ),
        (
            "serialized",
            write_serialized(
                &[(square(true, true), 0x1000), (square(false, false), 0x2000)],
                3,
            ),
        ),
        ("image", read(&png)),
        ("image", read(&exr)),
        ("image", read(&hdr)),
        ("xml", xml.into()),
    ];
    let mut state = 1u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut read_well = 0;
    for round in 0..4000 {
        let (kind, seed) = &seeds[round % seeds.len()];
        let mut bytes = seed.clone();
        for _ in 0..=random(3) {
            let at = random(bytes.len());
            match random(4) {
                0 => bytes[at] = random(256) as u8,
                1 => bytes[at] ^= 1 << random(8),
                2 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"0129-. <>'/\n\xff\0"[random(14)]),
            }
        }
        let mesh = |raw: RawMesh| {
            raw.finish(
                &glam::DMat4::IDENTITY,
                Default::default(),
                at(),
                &mut Vec::new(),
            )
        };
        let fine = match *kind {
            "ply" => ply::parse(&bytes, at()).and_then(mesh).is_ok(),
            "obj" => obj::parse(&bytes, at(), true, &mut Vec::new())
                .and_then(mesh)
                .is_ok(),
            other => {
                let path = if other == "xml" {
                    path.with_extension("xml")
                } else {
                    path.clone()
                };
                std::fs::write(&path, &bytes).expect("a file");
                match other {
                    "serialized" => serialized::load(&path, random(3)).and_then(mesh).is_ok(),
                    "image" => bitmap::load(&path, false).is_ok(),
                    _ => crate::load::load(&path, &[]).is_ok(),
                }
            }
        };
        read_well += usize::from(fine);
    }
    assert!(read_well > 100, "{read_well} of 4000 read");
}

/// How long a million triangles take: `cargo test --release -- --ignored --nocapture million`.
#[test]
#[ignore = "a measurement"]
fn million_triangles() {
    use std::time::Instant;
    let n = 708u32;
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let height = |i: u32, j: u32| ((i * 7 + j * 13) % 101) as f32 / 101.0;
    let (mut ply, mut text) = (Vec::new(), String::new());
    let (vertices, faces) = ((n + 1) * (n + 1), 2 * n * n);
    ply.extend(
        format!("ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n").bytes(),
    );
    ply.extend(b"property float x\nproperty float y\nproperty float z\n");
    ply.extend(
        format!("element face {faces}\nproperty list uchar int vertex_indices\nend_header\n")
            .bytes(),
    );
    for i in 0..=n {
        for j in 0..=n {
            let p = [i as f32 / n as f32, j as f32 / n as f32, height(i, j)];
            p.iter().for_each(|x| ply.extend(x.to_le_bytes()));
            text += &format!("v {} {} {}\n", p[0], p[1], p[2]);
        }
    }
    for i in 0..n {
        for j in 0..n {
            for f in [
                [at(i, j), at(i + 1, j), at(i, j + 1)],
                [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)],
            ] {
                ply.push(3);
                f.iter().for_each(|k| ply.extend(k.to_le_bytes()));
                text += &format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
            }
        }
    }
    let dir = tempfile::tempdir().expect("a folder");
    for (kind, bytes) in [("ply", ply.as_slice()), ("obj", text.as_bytes())] {
        std::fs::write(dir.path().join("m"), bytes).expect("a file");
        let scene = format!(
            "<scene version='3.0.0'><sensor type='perspective'/><shape type='{kind}'>
             <string name='filename' value='m'/></shape></scene>"
        );
        std::fs::write(dir.path().join("s.xml"), scene).expect("a file");
        let start = Instant::now();
        crate::load::load(&dir.path().join("s.xml"), &[]).expect("a scene");
        println!(
            "{kind}: {faces} triangles of {} bytes in {:?}",
            bytes.len(),
            start.elapsed()
        );
    }
}
