//! Textures: known texels, wrapping, weights, and coordinates from nowhere.

use super::kernel::Rgb;
use super::kernel::blob::format::{Material, NONE, Texture, material, texture};
use super::kernel::real::Real;
use super::kernel::surface::{Outlined, Surface, TextureView};
use super::zoo::{All, channels};

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn image(kind: u32, flags: u32, width: u32, height: u32) -> Texture {
    Texture {
        kind,
        flags,
        width,
        height,
        texels: 0,
        reserved: 0,
        to_uv: IDENTITY,
        color: [[1.0; 3]; 2],
        reserved2: [0; 6],
    }
}

fn look(texture: Texture, texels: &[u32], u: f64, v: f64) -> [f64; 3] {
    let view = TextureView {
        textures: &[texture],
        texels,
    };
    channels(view.color::<Rgb>(0, [u as Real, v as Real], &()))
}

fn bytes(rgba: [u8; 4]) -> u32 {
    u32::from_le_bytes(rgba)
}

/// Floats in all channels alike.
fn floats(values: &[f32]) -> Vec<u32> {
    values.iter().flat_map(|x| [x.to_bits(); 3]).collect()
}

/// IEC 61966-2-1, rounded once.
#[test]
fn srgb_is_the_standards_to_the_last_bit() {
    let texels: Vec<u32> = (0..=255).map(|n| bytes([n, 255 - n, 0, 0])).collect();
    let t = image(texture::SRGB8, texture::NEAREST, 256, 1);
    for n in 0..256 {
        let linear = |n: u32| {
            let x = f64::from(n) / 255.0;
            let y = if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            };
            f64::from(y as f32)
        };
        let got = look(t, &texels, (f64::from(n) + 0.5) / 256.0, 0.5);
        assert_eq!(got, [linear(n), linear(255 - n), 0.0], "{n}");
    }
}

#[test]
fn texels_are_read_as_their_kind_says() {
    let words = [bytes([51, 102, 204, 153])];
    let linear = |n: u8| f64::from(f32::from(n) / 255.0);
    let eight = image(texture::LINEAR8, texture::NEAREST, 1, 1);
    let expected = [linear(51), linear(102), linear(204)];
    assert_eq!(look(eight, &words, 0.5, 0.5), expected);
    for kind in [texture::LINEAR8, texture::SRGB8] {
        let alpha = image(kind, texture::NEAREST | texture::ALPHA, 1, 1);
        assert_eq!(look(alpha, &words, 0.5, 0.5), [linear(153); 3]);
    }
    let words = [0.25_f32, 7.5, 0.0].map(f32::to_bits);
    let mut float = image(texture::FLOAT, 0, 1, 1);
    assert_eq!(look(float, &words, 0.3, 0.9), [0.25, 7.5, 0.0]);
    float.color[0] = [2.0, 0.5, 1.0];
    assert_eq!(look(float, &words, 0.3, 0.9), [0.5, 3.75, 0.0]);
    // Row 0 is at v = 0, and a texture starts where it says.
    let mut rows = image(texture::FLOAT, texture::NEAREST, 1, 2);
    rows.texels = 3;
    let words = floats(&[9.0, 1.0, 2.0]);
    assert_eq!(look(rows, &words, 0.5, 0.1), [1.0; 3]);
    assert_eq!(look(rows, &words, 0.5, 0.9), [2.0; 3]);
}

#[test]
fn coordinates_repeat_clamp_or_mirror() {
    let words = floats(&[1.0, 2.0, 3.0, 4.0]);
    let repeat = [3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4];
    let clamp = [1, 1, 1, 1, 1, 1, 1, 2, 3, 4, 4, 4, 4, 4];
    let mirror = [3, 4, 4, 3, 2, 1, 1, 2, 3, 4, 4, 3, 2, 1];
    for (flags, expected) in [
        (0, repeat),
        (texture::CLAMP, clamp),
        (texture::MIRROR, mirror),
    ] {
        for (column, texel) in (-6..).zip(expected) {
            let at = (f64::from(column) + 0.5) / 4.0;
            let flags = flags | texture::NEAREST;
            let along_u = look(image(texture::FLOAT, flags, 4, 1), &words, at, 0.5);
            let along_v = look(image(texture::FLOAT, flags, 1, 4), &words, 0.5, at);
            assert_eq!(
                along_u,
                [f64::from(texel); 3],
                "column {column}, flags {flags}"
            );
            assert_eq!(along_v, along_u, "row {column}, flags {flags}");
        }
    }
}

#[test]
fn bilinear_weights_are_areas() {
    // 4×2 texels, so that fractions of texels are exact in u and v.
    let values = [1.0, 8.0, 3.0, 0.0, 5.0, 2.0, 16.0, 4.0];
    let words = floats(&values);
    let texel = |x: i32, y: i32, flags: u32| {
        let (x, y) = match flags {
            texture::CLAMP => (x.clamp(0, 3), y.clamp(0, 1)),
            texture::MIRROR => (
                x.rem_euclid(8).min(7 - x.rem_euclid(8)),
                y.rem_euclid(4).min(3 - y.rem_euclid(4)),
            ),
            _ => (x.rem_euclid(4), y.rem_euclid(2)),
        };
        f64::from(values[(y * 4 + x) as usize])
    };
    for flags in [0, texture::CLAMP, texture::MIRROR] {
        let t = image(texture::FLOAT, flags, 4, 2);
        for (x, y) in (-3..8).flat_map(|x| (-2..5).map(move |y| (x, y))) {
            for (fx, fy) in [(0.0, 0.0), (0.25, 0.5), (0.5, 0.125), (0.75, 0.75)] {
                // Texel centres are at (i + ½)/width.
                let u = (f64::from(x) + 0.5 + fx) / 4.0;
                let v = (f64::from(y) + 0.5 + fy) / 2.0;
                let expected = texel(x, y, flags) * (1.0 - fx) * (1.0 - fy)
                    + texel(x + 1, y, flags) * fx * (1.0 - fy)
                    + texel(x, y + 1, flags) * (1.0 - fx) * fy
                    + texel(x + 1, y + 1, flags) * fx * fy;
                assert_eq!(
                    look(t, &words, u, v),
                    [expected; 3],
                    "({u}, {v}), flags {flags}"
                );
            }
        }
    }
}

#[test]
fn checkerboards_alternate() {
    let mut t = image(texture::CHECKERBOARD, 0, 0, 0);
    t.color = [[1.0; 3], [0.25; 3]];
    for (i, j) in (-5..5).flat_map(|i| (-5..5).map(move |j| (i, j))) {
        let expected = if (i + j) % 2 == 0 { 1.0 } else { 0.25 };
        for (fu, fv) in [(0.01, 0.99), (0.5, 0.5)] {
            let got = look(t, &[], f64::from(i) + fu, f64::from(j) + fv);
            assert_eq!(got, [expected; 3], "field ({i}, {j})");
        }
    }
}

/// (u, v, 1) by rows.
#[test]
fn coordinates_are_transformed_first() {
    let words = floats(&[1.0, 2.0, 3.0, 4.0]);
    let mut t = image(texture::FLOAT, texture::NEAREST, 2, 2);
    t.to_uv = [[0.0, 1.0, 0.25], [-1.0, 0.0, 0.5]];
    // (0.125, 0.625) ↦ (0.875, 0.375): second column, first row.
    assert_eq!(look(t, &words, 0.125, 0.625), [2.0; 3]);
    // (0.125, 0.125) ↦ (0.375, 0.375); (−0.25, 0.625) ↦ (0.875, 0.75).
    assert_eq!(look(t, &words, 0.125, 0.125), [1.0; 3]);
    assert_eq!(look(t, &words, -0.25, 0.625), [4.0; 3]);
}

#[test]
fn coordinates_from_nowhere_are_survived() {
    let wild = [
        0.0,
        -0.0,
        1.0,
        1e-40,
        -1e-40,
        1e9,
        -1e9,
        3e38,
        -3e38,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    let words = floats(&[0.5; 6]);
    for kind in [
        texture::CHECKERBOARD,
        texture::SRGB8,
        texture::LINEAR8,
        texture::FLOAT,
    ] {
        for flags in 0..16 {
            for size in [(3, 2), (1, 1), (u32::MAX, u32::MAX), (0, 0)] {
                let mut t = image(kind, flags, size.0, size.1);
                t.to_uv = [[1.0, 1e30, -1.0], [-2.0, 1.0, 3e38]];
                for (u, v) in wild.into_iter().flat_map(|u| wild.map(|v| (u, v))) {
                    let got = look(t, &words, u, v);
                    let sane = got.iter().all(|x| x.is_finite() && *x >= 0.0);
                    assert!(sane, "({u}, {v}) of {t:?}: {got:?}");
                }
            }
        }
    }
}

/// A material's colour in a role is that role's constant times its texture; no texture, or none of that id, is
/// white.
#[test]
fn materials_multiply_their_textures() {
    let words = floats(&[0.5, 0.25]);
    let half = image(texture::FLOAT, 0, 1, 1);
    let view = TextureView {
        textures: &[half, Texture { texels: 3, ..half }],
        texels: &words,
    };
    let mut m = Material {
        kind: material::SHEET,
        flags: 0,
        ior: 1.25,
        reserved: 0,
        color: [
            [0.5, 0.25, 1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ],
        texture: [0, NONE, 7, 1],
        eta: [0.5, 1.0, 2.0],
        k: [4.0, 3.0, 0.0],
        gloss: [0.25, 0.5],
        internal: 0.5,
        link: [0; 2],
        level: 0,
    };
    let expected = [
        [0.25, 0.125, 0.5],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 0.25],
    ];
    let kinds = [
        material::DIFFUSE,
        material::MIRROR,
        material::CONDUCTOR,
        material::DIELECTRIC,
        material::NULL,
        material::SHEET,
        material::PHONG,
        material::ROUGH_CONDUCTOR,
        material::ROUGH_DIELECTRIC,
        material::PLASTIC,
        material::ROUGH_PLASTIC,
    ];
    for kind in kinds {
        for flags in [0, material::SCHLICK] {
            (m.kind, m.flags) = (kind, flags);
            let (found, colors) = match Surface::<Rgb>::resolve::<All>(&m, view, &(), 0, [0.5; 2]) {
                Surface::Diffuse(d) => (material::DIFFUSE, vec![d.reflectance, d.transmittance]),
                Surface::Outlined(Outlined::Dispersive(_)) => {
                    unreachable!("in the tests of spectra")
                }
                Surface::Mirror(s) => (material::MIRROR, vec![s.reflectance]),
                Surface::Conductor(c) => {
                    assert_eq!(channels(c.eta), [0.5, 1.0, 2.0]);
                    assert_eq!(channels(c.k), [1.0, 0.75, 0.0]);
                    (material::CONDUCTOR, vec![c.reflectance])
                }
                Surface::Dielectric(d) => {
                    assert!(d.ior == 1.25 && d.schlick == (flags == material::SCHLICK));
                    (material::DIELECTRIC, vec![d.reflectance, d.transmittance])
                }
                Surface::Null(_) => (material::NULL, vec![]),
                Surface::Sheet(s) => (
                    material::SHEET,
                    vec![
                        s.specular_reflectance,
                        s.specular_transmittance,
                        s.diffuse.reflectance,
                        s.diffuse.transmittance,
                    ],
                ),
                Surface::Outlined(Outlined::Phong(p)) => {
                    assert!(p.exponent == 0.25 && p.normalization == 0.5 && p.ior == 1.25);
                    assert_eq!(p.fresnel, flags == material::FRESNEL);
                    let (r, t) = (p.diffuse.reflectance, p.diffuse.transmittance);
                    (material::PHONG, vec![r, p.reflectance, p.transmittance, t])
                }
                Surface::Outlined(Outlined::RoughConductor(c)) => {
                    assert_eq!(c.facets.alpha, [0.25, 0.5]);
                    assert_eq!(c.facets.beckmann, flags == material::BECKMANN);
                    (material::ROUGH_CONDUCTOR, vec![c.reflectance, c.mean])
                }
                Surface::Outlined(Outlined::RoughDielectric(d)) => {
                    assert!(d.ior == 1.25 && d.facets.alpha == [0.25, 0.5]);
                    let colors = vec![d.reflectance, d.transmittance];
                    (material::ROUGH_DIELECTRIC, colors)
                }
                Surface::Outlined(Outlined::Plastic(p)) => {
                    // k/(η²(1 − ρ_i)).
                    let base = channels(p.base).map(|b| b * 1.25 * 1.25 * 0.5);
                    let close = |i: usize| (base[i] - expected[0][i]).abs() < 1e-6;
                    assert!((0..3).all(close), "{base:?}");
                    (material::PLASTIC, vec![])
                }
                Surface::Outlined(Outlined::RoughPlastic(p)) => {
                    assert_eq!(channels(p.reflectance), expected[1]);
                    (material::ROUGH_PLASTIC, vec![])
                }
            };
            assert_eq!(found, kind);
            for (role, color) in colors.into_iter().enumerate() {
                assert_eq!(channels(color), expected[role], "kind {kind}, role {role}");
            }
        }
    }
    assert_eq!(view.opacity(0, [0.0; 2]), 0.5);
    assert_eq!(view.opacity(NONE, [0.0; 2]), 1.0);
}
