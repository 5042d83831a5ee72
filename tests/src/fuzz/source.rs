//! Numbers from a fuzzer's bytes.

use arbitrary::{Arbitrary, Result, Unstructured};

/// Values at which arithmetic turns.
const SPECIAL: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-30,
    1e-12,
    1e-6,
    1e6,
    1e12,
    -1e12,
    1e30,
    f32::MAX,
    f32::MIN,
];

/// The fuzzer's bytes, and whether numbers keep to their documented ranges.
pub(super) struct Source<'a> {
    pub bytes: Unstructured<'a>,
    pub tame: bool,
}

impl Source<'_> {
    /// A number, in [low, high] if the source is tame: often round, often at an end, now and then of any bits.
    pub fn number(&mut self, low: f32, high: f32) -> Result<f32> {
        let x = match u8::arbitrary(&mut self.bytes)? {
            // Within a range of everyday size.
            0..=159 => {
                let (a, b) = (low.max(-4.0), high.min(4.0));
                let share = f32::from(u8::arbitrary(&mut self.bytes)?) / 255.0;
                a + (b - a) * share
            }
            160..=175 => low,
            176..=191 => high,
            192..=223 => *self.bytes.choose(&SPECIAL)?,
            _ => f32::from_bits(u32::arbitrary(&mut self.bytes)?),
        };
        if !self.tame {
            return Ok(x);
        }
        Ok(if x.is_nan() { low } else { x.clamp(low, high) })
    }

    pub fn numbers<const N: usize>(&mut self, low: f32, high: f32) -> Result<[f32; N]> {
        let mut out = [0.0; N];
        for x in &mut out {
            *x = self.number(low, high)?;
        }
        Ok(out)
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: usize) -> Result<usize> {
        self.bytes.int_in_range(0..=n.max(1) - 1)
    }

    pub fn coin(&mut self) -> Result<bool> {
        bool::arbitrary(&mut self.bytes)
    }

    /// A unit vector, or any if the source isn't tame.
    pub fn direction(&mut self) -> Result<[f32; 3]> {
        let v: [f32; 3] = self.numbers(-1.0, 1.0)?;
        // In single precision, the length of a short vector is one of denormal numbers.
        let unit = glam::DVec3::from(v.map(f64::from)).normalize_or(glam::DVec3::Z);
        Ok(if self.tame {
            unit.to_array().map(|x| x as f32)
        } else {
            v
        })
    }
}
