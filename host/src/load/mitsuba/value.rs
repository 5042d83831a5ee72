//! Numbers, vectors and colours from text.

use super::node::Node;
use crate::description::{Color, Spectrum, is_spectrum};
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

/// The rows of a `<spectrum value="400:0.1, 500:0.3"/>`; `None` if the element is something else.
pub fn rows(node: &Node, subject: &str, name: &str) -> Result<Option<Spectrum>, LoadError> {
    if node.tag != "spectrum" || !node.get("value").is_some_and(|v| v.contains(':')) {
        return Ok(None);
    }
    node.only(&["name", "value"])?;
    let text = node.need("value")?;
    table(text).map(Some).ok_or_else(|| {
        let problem = Problem::Invalid {
            what: name.into(),
            expected: "pairs nm:value by rising wavelength, values from 0".into(),
            found: format!("\"{text}\""),
        };
        node.error(subject, problem)
    })
}

/// `400:0.1, 500:0.3`: pairs by rising wavelength, values ≥ 0.
pub fn table(text: &str) -> Option<Spectrum> {
    let pair = |pair: &str| {
        let (nm, value) = pair.split_once(':')?;
        Some([nm.parse().ok()?, value.parse().ok()?])
    };
    let pairs = text
        .split([',', ' ', '\t', '\n', '\r'])
        .filter(|p| !p.is_empty());
    let rows: Spectrum = pairs.map(pair).collect::<Option<_>>()?;
    is_spectrum(&rows, 1e30).then_some(rows)
}

/// The colour that an element says, each channel ≥ 0.
pub fn color(node: &Node, subject: &str, name: &str) -> Result<Color, LoadError> {
    if !["rgb", "spectrum", "float", "integer"].contains(&node.tag.as_str()) {
        let problem = Problem::Invalid {
            what: name.into(),
            expected: "an <rgb>, <spectrum> or <float>".into(),
            found: format!("<{}>", node.tag),
        };
        return Err(node.error(subject, problem));
    }
    if node.tag == "spectrum"
        && (node.get("filename").is_some() || node.get("value").is_some_and(|v| v.contains(':')))
    {
        let instead = "give one value, or an <rgb>".into();
        let problem = Problem::Unsupported {
            what: format!("a list of wavelengths as {name}"),
            instead,
        };
        return Err(node.error(subject, problem));
    }
    node.only(&["name", "value"])?;
    let text = node.need("value")?;
    let wrong = |expected: &str| {
        let (what, found) = (name.to_owned(), format!("\"{text}\""));
        node.error(
            subject,
            Problem::Invalid {
                what,
                expected: expected.into(),
                found,
            },
        )
    };
    let color = match (node.tag.as_str(), text.trim().strip_prefix('#')) {
        ("rgb", Some(hex)) => hexadecimal(hex).ok_or_else(|| wrong("#RRGGBB"))?,
        (tag, _) => match (tag, numbers(text).as_deref()) {
            (_, Some(&[v])) => [v as f32; 3],
            ("rgb", Some(&[r, g, b])) => [r as f32, g as f32, b as f32],
            ("rgb", _) => return Err(wrong("1 or 3 finite numbers, or #RRGGBB")),
            _ => return Err(wrong("a finite number")),
        },
    };
    if color.iter().all(|c| *c >= 0.0 && c.is_finite()) {
        Ok(color)
    } else {
        Err(wrong(">= 0 and finite"))
    }
}

/// `RRGGBB`, sRGB-coded.
fn hexadecimal(hex: &str) -> Option<Color> {
    let bits = (hex.len() == 6 && hex.is_ascii()).then(|| u32::from_str_radix(hex, 16).ok())??;
    Some([16, 8, 0].map(|s| srgb_to_linear((bits >> s & 0xff) as f32 / 255.0)))
}
