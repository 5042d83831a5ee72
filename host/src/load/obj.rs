//! Wavefront OBJ: one mesh of all faces, polygons as fans. Materials and groups are the scene's business.

use super::RawMesh;
use super::error::{LoadError, read};
use std::path::Path;

const NONE: u32 = u32::MAX;

/// How vertices of different texture coordinate or normal share a position: chains per position.
#[derive(Default)]
struct Corners {
    head: Vec<u32>,
    next: Vec<u32>,
    key: Vec<[u32; 3]>,
}

impl Corners {
    fn index(&mut self, key: [u32; 3]) -> u32 {
        let v = key[0] as usize;
        if self.head.len() <= v {
            self.head.resize(v + 1, NONE);
        }
        let mut at = self.head[v];
        while at != NONE {
            if self.key[at as usize] == key {
                return at;
            }
            at = self.next[at as usize];
        }
        let new = self.key.len() as u32;
        self.key.push(key);
        self.next.push(self.head[v]);
        self.head[v] = new;
        new
    }
}

/// Reads an OBJ file. `flip_v` puts v = 0 at the top, which is what most files mean.
pub fn load(path: &Path, flip_v: bool, warnings: &mut Vec<String>) -> Result<RawMesh, LoadError> {
    parse(&read(path)?, path, flip_v, warnings)
}

/// Reads OBJ text; `path` is for messages.
pub fn parse(
    bytes: &[u8],
    path: &Path,
    flip_v: bool,
    warnings: &mut Vec<String>,
) -> Result<RawMesh, LoadError> {
    let mut v: Vec<[f32; 3]> = Vec::new();
    let mut vt: Vec<[f32; 2]> = Vec::new();
    let mut vn: Vec<[f32; 3]> = Vec::new();
    let mut corners = Corners::default();
    let mut triangles = Vec::new();
    let mut left_out = 0usize;
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let number = number as u32 + 1;
        let fail = |text: String| LoadError::malformed(path, number, text);
        let line = String::from_utf8_lossy(line);
        let line = line.split('#').next().unwrap_or("").trim();
        let (keyword, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
        match keyword {
            "v" => v.push(numbers(rest, 3).map_err(fail)?),
            "vn" => vn.push(numbers(rest, 3).map_err(fail)?),
            "vt" => {
                let uv: [f32; 2] = numbers(rest, 1).map_err(fail)?;
                vt.push(if flip_v { [uv[0], 1.0 - uv[1]] } else { uv });
            }
            "f" => {
                let counts = [v.len(), vt.len(), vn.len()];
                let mut fan = [0u32; 2];
                let mut n = 0;
                for word in rest.split_ascii_whitespace() {
                    let at = corners.index(corner(word, counts).map_err(fail)?);
                    match n {
                        0 => fan[0] = at,
                        1 => fan[1] = at,
                        _ => {
                            triangles.push([fan[0], fan[1], at]);
                            fan[1] = at;
                        }
                    }
                    n += 1;
                }
                if n < 3 {
                    return Err(fail(format!("face of {n} vertices, expected 3 or more")));
                }
            }
            "" | "g" | "o" | "s" | "mtllib" | "usemtl" | "usemap" | "maplib" | "lod" | "bevel"
            | "c_interp" | "d_interp" => {}
            "l" | "p" => left_out += 1,
            _ => {
                return Err(fail(format!(
                    "unknown keyword {keyword:?}, expected v, vt, vn, f, g, o, s, mtllib, usemtl or #"
                )));
            }
        }
    }
    if left_out > 0 {
        warnings.push(format!(
            "{}: {left_out} lines and points are left out",
            path.display()
        ));
    }
    let with = |k: usize| corners.key.iter().filter(|c| c[k] != NONE).count();
    let (with_uv, with_normal) = (with(1), with(2));
    let all = corners.key.len();
    if with_uv > 0 && with_uv < all {
        warnings.push(format!(
            "{}: {} of {all} vertices have no texture coordinate, (0, 0) is used",
            path.display(),
            all - with_uv
        ));
    }
    if with_normal > 0 && with_normal < all {
        warnings.push(format!(
            "{}: {} of {all} vertices have no normal, all normals are computed",
            path.display(),
            all - with_normal
        ));
    }
    let normal = |c: &[u32; 3]| vn[c[2] as usize];
    let uv = |c: &[u32; 3]| {
        if c[1] == NONE {
            [0.0; 2]
        } else {
            vt[c[1] as usize]
        }
    };
    Ok(RawMesh {
        positions: corners.key.iter().map(|c| v[c[0] as usize]).collect(),
        normals: (all > 0 && with_normal == all).then(|| corners.key.iter().map(normal).collect()),
        uvs: (with_uv > 0).then(|| corners.key.iter().map(uv).collect()),
        triangles,
        face_normals: false,
    })
}

/// Up to `N` finite numbers, at least `needed`; the rest 0, what follows is ignored as the format wants.
fn numbers<const N: usize>(text: &str, needed: usize) -> Result<[f32; N], String> {
    let mut out = [0.0f32; N];
    let mut words = text.split_ascii_whitespace();
    for (i, slot) in out.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            if i < needed {
                return Err(format!("{i} numbers, expected {N}"));
            }
            break;
        };
        *slot = word
            .parse()
            .map_err(|_| format!("{word:?}, expected a number"))?;
        if !slot.is_finite() {
            return Err(format!("{word}, expected a finite number"));
        }
    }
    Ok(out)
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`; from 1, or from −1 backwards.
fn corner(word: &str, counts: [usize; 3]) -> Result<[u32; 3], String> {
    const WHAT: [&str; 3] = ["vertex", "texture coordinate", "normal"];
    let mut key = [NONE; 3];
    for (i, part) in word.split('/').enumerate() {
        if i > 2 || (part.is_empty() && i == 0) {
            return Err(format!(
                "face vertex {word:?}, expected v, v/vt, v//vn or v/vt/vn"
            ));
        }
        if part.is_empty() {
            continue;
        }
        let n: i64 = part
            .parse()
            .map_err(|_| format!("face vertex {word:?}, expected v, v/vt, v//vn or v/vt/vn"))?;
        let count = counts[i] as i64;
        let index = if n < 0 {
            count.saturating_add(n)
        } else {
            n - 1
        };
        if index < 0 || index >= count || index >= i64::from(NONE) {
            return Err(format!(
                "face uses {} {n}, expected 1 to {count} (or -1 to -{count})",
                WHAT[i]
            ));
        }
        key[i] = index as u32;
    }
    Ok(key)
}
