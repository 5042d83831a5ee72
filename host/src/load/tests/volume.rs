//! Volumes in bytes.

use super::at;
use crate::description::GridValues;
use crate::load::volume::parse;

fn file(size: [u32; 3], channels: u32, data: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let [x, y, z] = size;
    for word in [1, x, y, z, channels] {
        bytes.extend(word.to_le_bytes());
    }
    for number in [-1.0f32, -2.0, -3.0, 1.0, 2.0, 3.0].iter().chain(data) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

#[test]
fn volumes_are_read_as_they_were_written() {
    let data: Vec<f32> = (0u8..12).map(f32::from).collect();
    let v = parse(&file([2, 3, 2], 1, &data), at()).expect("a volume");
    assert_eq!(
        (v.grid.size, v.bounds),
        ([2, 3, 2], [[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]])
    );
    assert!(matches!(&v.grid.values, GridValues::Gray(g) if *g == data));
    let v = parse(&file([2, 2, 1], 3, &data), at()).expect("a volume");
    assert!(matches!(&v.grid.values, GridValues::Rgb(g) if g[3] == [9.0, 10.0, 11.0]));
}

#[test]
fn broken_volumes_are_refused() {
    let good = file([2, 1, 1], 1, &[1.0, 2.0]);
    let with = |at: usize, word: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    for (bytes, part) in [
        (good[..40].to_vec(), "m: file of 40 bytes ends too early"),
        (b"VOX\x03".repeat(20), "doesn't start with \"VOL\""),
        (b"VOL\x02".repeat(20), "version 2, expected 3"),
        (with(4, 3), "encoding 3, expected 1"),
        (with(8, 0), "0 x 1 x 1 texels, expected 1 to 4096 by axis"),
        (with(12, u32::MAX), "expected 1 to 4096 by axis"),
        (with(20, 6), "6 channels, expected 1 or 3"),
        (
            with(8, 3),
            "8 bytes of data, expected 12: 3 x 1 x 1 texels of 1 x 4 bytes",
        ),
        (good[..55].to_vec(), "7 bytes of data, expected 8"),
        ([&good[..], &[0]].concat(), "9 bytes of data, expected 8"),
        (
            with(52, (-1.0f32).to_bits()),
            "texel (1, 0, 0) is -1, expected a finite number >= 0",
        ),
        (with(48, f32::NAN.to_bits()), "texel (0, 0, 0) is NaN"),
        (
            file([4096; 3], 3, &[]),
            "0 bytes of data, expected 824633720832",
        ),
    ] {
        let error = parse(&bytes, at()).expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
}
