//! PLY: ASCII and binary of both byte orders; polygons as fans. Binary data of fixed stride is read
//! column by column, which keeps a million triangles well under a second.

mod header;

use super::RawMesh;
use super::error::{LoadError, read};
use header::{Element, Format, Kind, Property};
use std::path::Path;

/// Reads a PLY file.
pub fn load(path: &Path) -> Result<RawMesh, LoadError> {
    parse(&read(path)?, path)
}

/// Reads a PLY's bytes; `path` is for messages.
pub fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, LoadError> {
    let mut reader = Reader {
        bytes,
        at: 0,
        line: 0,
        path,
    };
    let (format, elements) = header::parse(&mut reader)?;
    let mut mesh = RawMesh::default();
    for element in &elements {
        let left = bytes.len().saturating_sub(reader.at);
        let least = element.least(format == Format::Ascii).max(1);
        if !element.properties.is_empty() && element.count > left / least + 1 {
            return Err(reader.short(element));
        }
        match (element.name.as_str(), format) {
            ("vertex", _) => reader.vertices(element, format, &mut mesh)?,
            ("face", Format::Binary { big }) => match element.properties.as_slice() {
                [only]
                    if only.count == Some(Kind::U8)
                        && matches!(only.kind, Kind::I32 | Kind::U32) =>
                {
                    reader.fast_faces(element, big, &mut mesh)?;
                }
                _ => reader.faces(element, format, &mut mesh)?,
            },
            ("face", Format::Ascii) => reader.faces(element, format, &mut mesh)?,
            ("tristrips", _) => {
                return Err(LoadError::malformed(
                    path,
                    0,
                    "triangle strips are not supported yet, expected faces",
                ));
            }
            _ => reader.records(element, format, |_, _, _| Ok(()))?,
        }
    }
    Ok(mesh)
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u32,
    path: &'a Path,
}

impl<'a> Reader<'a> {
    fn fail(&self, text: impl Into<String>) -> LoadError {
        LoadError::malformed(self.path, self.line, text)
    }

    fn short(&self, element: &Element) -> LoadError {
        let line = 0;
        let text = format!(
            "file ends too early, expected {} records of element {}",
            element.count, element.name
        );
        LoadError::malformed(self.path, line, text)
    }

    fn next_line(&mut self) -> Option<&'a str> {
        let rest = self.bytes.get(self.at..).filter(|r| !r.is_empty())?;
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        self.line += 1;
        Some(
            std::str::from_utf8(&rest[..end])
                .unwrap_or("\u{fffd}")
                .trim(),
        )
    }

    /// Calls `each` with record, property and values, for every property of every record.
    fn records(
        &mut self,
        element: &Element,
        format: Format,
        mut each: impl FnMut(usize, usize, &[f64]) -> Result<(), String>,
    ) -> Result<(), LoadError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut values: Vec<f64> = Vec::new();
        for record in 0..element.count {
            let mut words = "".split_ascii_whitespace();
            if format == Format::Ascii {
                let mut line = "";
                while line.is_empty() {
                    line = self.next_line().ok_or_else(|| self.short(element))?;
                }
                words = line.split_ascii_whitespace();
            }
            for (p, property) in element.properties.iter().enumerate() {
                let mut next = |kind: Kind| match format {
                    Format::Ascii => {
                        let word = words.next().ok_or_else(|| {
                            self.fail(format!("line ends too early, expected {}", property.name))
                        })?;
                        word.parse()
                            .map_err(|_| self.fail(format!("{word:?}, expected a number")))
                    }
                    Format::Binary { big } => {
                        let b = self
                            .bytes
                            .get(self.at..self.at + kind.size())
                            .ok_or_else(|| self.short(element))?;
                        self.at += kind.size();
                        Ok(kind.number(b, big))
                    }
                };
                values.clear();
                let count = match property.count {
                    Some(kind) => next(kind)?,
                    None => 1.0,
                };
                if !(0.0..=1e6).contains(&count) {
                    return Err(self.fail(format!(
                        "list of {count} values, expected at most a million"
                    )));
                }
                for _ in 0..count as usize {
                    values.push(next(property.kind)?);
                }
                each(record, p, &values).map_err(|text| self.fail(text))?;
            }
            if words.next().is_some() {
                let text = format!(
                    "more values in the line, expected those of element {}",
                    element.name
                );
                return Err(self.fail(text));
            }
        }
        Ok(())
    }

    fn vertices(
        &mut self,
        element: &Element,
        format: Format,
        mesh: &mut RawMesh,
    ) -> Result<(), LoadError> {
        let position = element.columns([&["x"], &["y"], &["z"]]);
        let position =
            position.ok_or_else(|| self.fail("vertices without x, y and z, expected them"))?;
        let normal = element.columns([&["nx"], &["ny"], &["nz"]]);
        let uv = element.columns([
            &["u", "s", "texture_u", "texture_s"],
            &["v", "t", "texture_v", "texture_t"],
        ]);
        let count = element.count;
        mesh.positions = vec![[0.0; 3]; count];
        mesh.normals = normal.map(|_| vec![[0.0; 3]; count]);
        mesh.uvs = uv.map(|_| vec![[0.0; 2]; count]);
        let (stride, big) = match (format, element.stride()) {
            (Format::Binary { big }, Some(stride)) => (stride, big),
            _ => {
                let find = |wanted: &[usize], p: usize| wanted.iter().position(|&c| c == p);
                return self.records(element, format, |record, p, values| {
                    let Some(&value) = values.first() else {
                        return Ok(());
                    };
                    if let Some(axis) = find(&position, p) {
                        mesh.positions[record][axis] = value as f32;
                    } else if let Some(axis) = normal.and_then(|n| find(&n, p)) {
                        mesh.normals
                            .iter_mut()
                            .for_each(|n| n[record][axis] = value as f32);
                    } else if let Some(axis) = uv.and_then(|u| find(&u, p)) {
                        mesh.uvs
                            .iter_mut()
                            .for_each(|u| u[record][axis] = value as f32);
                    }
                    Ok(())
                });
            }
        };
        let size = stride
            .checked_mul(count)
            .and_then(|n| self.at.checked_add(n));
        let data = size
            .and_then(|end| self.bytes.get(self.at..end))
            .ok_or_else(|| self.short(element))?;
        let column = Column { data, stride, big };
        let offset = |p: usize| {
            element.properties[..p]
                .iter()
                .map(|q| q.kind.size())
                .sum::<usize>()
        };
        let place = |p: usize| (offset(p), element.properties[p].kind);
        for axis in 0..3 {
            column.copy(place(position[axis]), &mut mesh.positions, axis);
            if let (Some(n), Some(out)) = (normal, &mut mesh.normals) {
                column.copy(place(n[axis]), out, axis);
            }
        }
        for axis in 0..2 {
            if let (Some(u), Some(out)) = (uv, &mut mesh.uvs) {
                column.copy(place(u[axis]), out, axis);
            }
        }
        self.at += data.len();
        Ok(())
    }

    fn faces(
        &mut self,
        element: &Element,
        format: Format,
        mesh: &mut RawMesh,
    ) -> Result<(), LoadError> {
        let is_list = |p: &Property| {
            p.count.is_some() && ["vertex_indices", "vertex_index"].contains(&p.name.as_str())
        };
        let list = element.properties.iter().position(is_list);
        let list =
            list.ok_or_else(|| self.fail("faces without a list vertex_indices, expected it"))?;
        let triangles = &mut mesh.triangles;
        self.records(element, format, |record, p, values| {
            if p != list {
                return Ok(());
            }
            let index = |v: f64| {
                let whole = (0.0..4_294_967_295.0).contains(&v) && v.fract() == 0.0;
                if whole {
                    Ok(v as u32)
                } else {
                    Err(format!("face {record} has vertex {v}, expected an index"))
                }
            };
            let [first, rest @ ..] = values else {
                return Err(few(record, 0));
            };
            if rest.len() < 2 {
                return Err(few(record, values.len()));
            }
            for pair in rest.windows(2) {
                triangles.push([index(*first)?, index(pair[0])?, index(pair[1])?]);
            }
            Ok(())
        })
    }

    /// Lists counted by a byte, of 32-bit integers, nothing else.
    fn fast_faces(
        &mut self,
        element: &Element,
        big: bool,
        mesh: &mut RawMesh,
    ) -> Result<(), LoadError> {
        if !["vertex_indices", "vertex_index"].contains(&element.properties[0].name.as_str()) {
            return Err(self.fail("faces without a list vertex_indices, expected it"));
        }
        let index = |b: &[u8]| {
            let raw: [u8; 4] = b.try_into().unwrap_or([0xff; 4]);
            if big {
                u32::from_be_bytes(raw)
            } else {
                u32::from_le_bytes(raw)
            }
        };
        mesh.triangles
            .reserve(element.count.min(self.bytes.len() / 13 + 1));
        for record in 0..element.count {
            let rest = self.bytes.get(self.at..).unwrap_or_default();
            let Some((&n, rest)) = rest.split_first() else {
                return Err(self.short(element));
            };
            let n = usize::from(n);
            let list = rest.get(..4 * n).ok_or_else(|| self.short(element))?;
            if n < 3 {
                return Err(self.fail(few(record, n)));
            }
            let first = index(&list[..4]);
            for k in 1..n - 1 {
                mesh.triangles.push([
                    first,
                    index(&list[4 * k..4 * k + 4]),
                    index(&list[4 * k + 4..4 * k + 8]),
                ]);
            }
            self.at += 1 + 4 * n;
        }
        Ok(())
    }
}

fn few(record: usize, n: usize) -> String {
    format!("face {record} has {n} vertices, expected 3 or more")
}

struct Column<'a> {
    data: &'a [u8],
    stride: usize,
    big: bool,
}

impl Column<'_> {
    fn copy<const N: usize>(
        &self,
        (offset, kind): (usize, Kind),
        out: &mut [[f32; N]],
        axis: usize,
    ) {
        let records = self.data.chunks_exact(self.stride).zip(out);
        match (kind, self.big) {
            (Kind::F32, false) => {
                for (r, o) in records {
                    o[axis] = r[offset..offset + 4]
                        .try_into()
                        .map_or(f32::NAN, f32::from_le_bytes);
                }
            }
            _ => {
                for (r, o) in records {
                    o[axis] = kind.number(&r[offset..], self.big) as f32;
                }
            }
        }
    }
}
