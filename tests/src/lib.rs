//! Shared by the truth, agreement and golden tests.

pub mod bits;
pub mod fresnel;
pub mod fuzz;
pub mod matrix;
pub mod media;
pub mod oracles;
pub mod place;
pub mod render;
pub mod scenes;
pub mod statistics;

/// How much tests take: `ETENDUE_DEEP`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Depth {
    /// Not set, or 0: what every change can wait for.
    Fast,
    /// K/N: case K of every N, counted from 0. With another K for each commit, N of them take all.
    Part(usize, usize),
    /// 1: all cases.
    All,
}

impl Depth {
    fn of(value: &str) -> Option<Self> {
        match value {
            "" | "0" => Some(Self::Fast),
            "1" => Some(Self::All),
            _ => {
                let (k, n) = value.split_once('/')?;
                let (k, n) = (k.parse().ok()?, n.parse().ok()?);
                (k < n).then_some(Self::Part(k, n))
            }
        }
    }

    fn asked() -> Self {
        let value = std::env::var("ETENDUE_DEEP").unwrap_or_default();
        Self::of(&value)
            .unwrap_or_else(|| panic!("ETENDUE_DEEP={value}: expected 0, 1 or K/N with K below N"))
    }
}

/// Whether tests take more cases and samples than what every change can wait for.
pub fn deep() -> bool {
    Depth::asked() != Depth::Fast
}

/// Whether case `i` of many is taken, of which one in `some` is what every change can wait for.
pub fn takes(i: usize, some: usize) -> bool {
    match Depth::asked() {
        Depth::Fast => i.is_multiple_of(some),
        Depth::Part(k, n) => i % n == k,
        Depth::All => true,
    }
}

/// The cases that are taken of these.
pub fn some<T>(cases: Vec<T>, one_in: usize) -> Vec<T> {
    let numbered = cases.into_iter().enumerate();
    let taken = numbered.filter(|(i, _)| takes(*i, one_in));
    taken.map(|(_, case)| case).collect()
}

/// Samples of a comparison that takes so many if tests are deep: half of them if they aren't.
pub fn samples(all: u64) -> u64 {
    if deep() { all } else { all.div_ceil(2) }
}

/// The noise up to which such a comparison is of use: √2 times as much with half of the samples.
pub fn noise(all: f64) -> f64 {
    if deep() {
        all
    } else {
        all * std::f64::consts::SQRT_2
    }
}

#[cfg(test)]
mod tests {
    use super::Depth;

    #[test]
    fn depths_are_read() {
        let cases = [
            ("", Some(Depth::Fast)),
            ("0", Some(Depth::Fast)),
            ("1", Some(Depth::All)),
            ("3/24", Some(Depth::Part(3, 24))),
            ("24/24", None),
            ("all", None),
            ("0/0", None),
        ];
        for (value, depth) in cases {
            assert_eq!(Depth::of(value), depth, "{value}");
        }
    }
}
