//! Numbers, vectors and colours from text.

use super::node::Node;
use crate::description::Color;
use crate::load::bitmap::srgb_to_linear;
use crate::load::error::{LoadError, Problem};

/// A finite number.
pub fn number(text: &str) -> Option<f32> {
    text.trim().parse().ok().filter(|v: &f32| v.is_finite())
}

/// Finite numbers between commas or blanks.
pub fn numbers(text: &str) -> Option<Vec<f64>> {
    let words = text
        .split(|c: char| c == ',' || c.is_whitespace())
        .filter(|w| !w.is_empty());
    words
        .map(|w| w.parse().ok().filter(|v: &f64| v.is_finite()))
        .collect()
}

/// x, y and z from their attributes or from `value` (one or three numbers).
pub fn vector(node: &Node, subject: &str, default: f64) -> Result<[f64; 3], LoadError> {
    let wrong = |what: &str, expected: &str, found: &str| {
        let (what, expected, found) =
            (what.to_owned(), expected.to_owned(), format!("\"{found}\""));
        node.error(
            subject,
            Problem::Invalid {
                what,
                expected,
                found,
            },
        )
    };
    let what = node.get("name").unwrap_or(&node.tag).to_owned();
    let mut out = [default; 3];
    let mut any = false;
    for (slot, axis) in out.iter_mut().zip(["x", "y", "z"]) {
        if let Some(text) = node.get(axis) {
            let value = numbers(text).filter(|v| v.len() == 1);
            *slot =
                value.ok_or_else(|| wrong(&format!("{what} {axis}"), "a finite number", text))?[0];
            any = true;
        }
    }
    match node.get("value") {
        Some(text) if any => Err(wrong(&what, "given as x, y, z or as value, not both", text)),
        Some(text) => match numbers(text).as_deref() {
            Some(&[v]) if node.tag == "scale" => Ok([v; 3]),
            Some(&[x, y, z]) => Ok([x, y, z]),
            _ => Err(wrong(&what, "three finite numbers", text)),
        },
        None if any => Ok(out),
        None => Err(node.error(
            subject,
            Problem::Missing {
                what,
                expected: "x, y, z or value".into(),
            },
        )),
    }
}

/// `RRGGBB`, sRGB-coded.
pub fn hexadecimal(hex: &str) -> Option<Color> {
    let bits = (hex.len() == 6 && hex.is_ascii()).then(|| u32::from_str_radix(hex, 16).ok())??;
    Some([16, 8, 0].map(|s| srgb_to_linear((bits >> s & 0xff) as f32 / 255.0)))
}
