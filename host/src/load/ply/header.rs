//! What a PLY says about itself before its data.

use super::Reader;
use crate::load::error::LoadError;

/// A number's type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    pub fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number at the start of `b`, which is long enough.
    pub fn number(self, b: &[u8], big: bool) -> f64 {
        let mut raw = [0u8; 8];
        let n = self.size();
        raw[..n].copy_from_slice(&b[..n]);
        if big {
            raw[..n].reverse();
        }
        let bits = u64::from_le_bytes(raw);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }
}

/// A named number, or a list of numbers.
#[derive(Debug)]
pub struct Property {
    pub name: String,
    /// Type of a list's count.
    pub count: Option<Kind>,
    pub kind: Kind,
}

/// A table: its columns and how many rows.
#[derive(Debug)]
pub struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

impl Element {
    /// Bytes per record, if all are the same.
    pub fn stride(&self) -> Option<usize> {
        self.properties
            .iter()
            .map(|p| p.count.is_none().then(|| p.kind.size()))
            .sum()
    }

    /// The fewest bytes that a record can take.
    pub fn least(&self, ascii: bool) -> usize {
        let size = |p: &Property| {
            if ascii {
                2
            } else {
                p.count.unwrap_or(p.kind).size()
            }
        };
        self.properties.iter().map(size).sum()
    }

    pub fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| p.count.is_none() && names.contains(&p.name.as_str()))
    }

    pub fn columns<const N: usize>(&self, names: [&[&str]; N]) -> Option<[usize; N]> {
        let found = names.map(|n| self.find(n));
        found
            .iter()
            .all(Option::is_some)
            .then(|| found.map(|c| c.unwrap_or(0)))
    }
}

/// How numbers are written.
#[derive(Clone, Copy, PartialEq)]
pub enum Format {
    Ascii,
    Binary { big: bool },
}

/// Reads up to and with end_header.
pub fn parse(reader: &mut Reader) -> Result<(Format, Vec<Element>), LoadError> {
    if reader.next_line() != Some("ply") {
        return Err(reader.fail("first line isn't \"ply\", expected a PLY file"));
    }
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let line = reader
            .next_line()
            .ok_or_else(|| reader.fail("header ends too early, expected end_header"))?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let kind = |w: &str| {
            Kind::parse(w).ok_or_else(|| reader.fail(format!("type {w:?}, expected a PLY type")))
        };
        match words.as_slice() {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, "1.0"] => {
                format = Some(match *name {
                    "ascii" => Format::Ascii,
                    "binary_little_endian" => Format::Binary { big: false },
                    "binary_big_endian" => Format::Binary { big: true },
                    _ => {
                        return Err(
                            reader.fail(format!("format {name:?}, expected ascii or binary"))
                        );
                    }
                });
            }
            ["element", name, count] => {
                let count = count
                    .parse()
                    .map_err(|_| reader.fail(format!("{count:?}, expected a count")))?;
                elements.push(Element {
                    name: (*name).into(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", rest @ ..] => {
                let property = match rest {
                    ["list", count, k, name] => {
                        let count = kind(count)?;
                        if matches!(count, Kind::F32 | Kind::F64) {
                            return Err(
                                reader.fail("list counted by a float, expected an integer type")
                            );
                        }
                        Property {
                            name: (*name).into(),
                            count: Some(count),
                            kind: kind(k)?,
                        }
                    }
                    [k, name] => Property {
                        name: (*name).into(),
                        count: None,
                        kind: kind(k)?,
                    },
                    _ => {
                        return Err(reader.fail(format!("{line:?}, expected property TYPE NAME")));
                    }
                };
                let last = elements.last_mut();
                last.ok_or_else(|| {
                    LoadError::malformed(reader.path, reader.line, "property before any element")
                })?
                .properties
                .push(property);
            }
            ["end_header"] => break,
            _ => return Err(reader.fail(format!("{line:?}, expected a line of a PLY header"))),
        }
    }
    let format = format.ok_or_else(|| reader.fail("header without format, expected one"))?;
    for name in ["vertex", "face"] {
        if elements.iter().filter(|e| e.name == name).count() != 1 {
            return Err(reader.fail(format!(
                "header without exactly one element {name}, expected it"
            )));
        }
    }
    Ok((format, elements))
}
