//! `<transform>`: steps in the order listed, the first acts first.

use super::document::Document;
use super::node::Node;
use super::value::{numbers, vector};
use crate::load::error::{LoadError, Problem};
use glam::{DMat3, DMat4, DVec3};

/// The matrix of a `<transform>`; it can be inverted.
pub fn parse(document: &Document, node: &Node) -> Result<DMat4, LoadError> {
    let mut matrix = DMat4::IDENTITY;
    for &child in &node.children {
        let step = &document.nodes[child];
        matrix = one(step)? * matrix;
        let linear = DMat3::from_mat4(matrix);
        let columns = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
        let determinant = linear.determinant().abs();
        if !matrix.is_finite()
            || !determinant.is_finite()
            || determinant <= 1e-12 * columns
            || determinant < 1e-150
        {
            let found = format!("determinant {determinant}");
            let expected = "a transform that can be undone".to_owned();
            return Err(step.error(
                "<transform>",
                Problem::Invalid {
                    what: step.tag.clone(),
                    expected,
                    found,
                },
            ));
        }
    }
    Ok(matrix)
}

fn one(step: &Node) -> Result<DMat4, LoadError> {
    let subject = "<transform>";
    let invalid = |what: &str, expected: &str, found: String| {
        step.error(
            subject,
            Problem::Invalid {
                what: what.into(),
                expected: expected.into(),
                found,
            },
        )
    };
    if !step.children.is_empty() {
        return Err(invalid(
            &step.tag,
            "an empty element",
            "elements in it".into(),
        ));
    }
    let three = |name: &str| {
        let text = step.need(name)?;
        match numbers(text).as_deref() {
            Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
            _ => Err(invalid(name, "three finite numbers", format!("\"{text}\""))),
        }
    };
    match step.tag.as_str() {
        "translate" => {
            step.only(&["x", "y", "z", "value"])?;
            Ok(DMat4::from_translation(DVec3::from(vector(
                step, subject, 0.0,
            )?)))
        }
        "scale" => {
            step.only(&["x", "y", "z", "value"])?;
            Ok(DMat4::from_scale(DVec3::from(vector(step, subject, 1.0)?)))
        }
        "rotate" => {
            step.only(&["x", "y", "z", "value", "angle"])?;
            let axis = DVec3::from(vector(step, subject, 0.0)?);
            let text = step.need("angle")?;
            let angle = numbers(text).filter(|v| v.len() == 1);
            let angle =
                angle.ok_or_else(|| invalid("angle", "a finite number", format!("\"{text}\"")))?[0];
            let axis = axis
                .try_normalize()
                .ok_or_else(|| invalid("axis", "not zero", format!("{axis}")))?;
            Ok(DMat4::from_axis_angle(axis, angle.to_radians()))
        }
        "lookat" | "lookAt" | "look_at" => {
            step.only(&["origin", "target", "up"])?;
            let (origin, target, up) = (three("origin")?, three("target")?, three("up")?);
            let forward = (target - origin).try_normalize();
            let forward = forward
                .ok_or_else(|| invalid("target", "apart from origin", format!("{target}")))?;
            let left = up.cross(forward);
            if left.length() <= 1e-9 * up.length() {
                return Err(invalid("up", "not along the view", format!("{up}")));
            }
            let left = left.normalize();
            let up = forward.cross(left);
            Ok(DMat4::from_cols(
                left.extend(0.0),
                up.extend(0.0),
                forward.extend(0.0),
                origin.extend(1.0),
            ))
        }
        "matrix" => {
            step.only(&["value"])?;
            let text = step.need("value")?;
            let values = numbers(text).unwrap_or_default();
            match values.len() {
                16 if values[12..] == [0.0, 0.0, 0.0, 1.0] => {
                    Ok(DMat4::from_cols_slice(&values).transpose())
                }
                16 => Err(invalid(
                    "last row",
                    "0 0 0 1",
                    format!("{:?}", &values[12..]),
                )),
                9 => Ok(DMat4::from_mat3(
                    DMat3::from_cols_slice(&values).transpose(),
                )),
                n => Err(invalid(
                    "value",
                    "16 or 9 finite numbers",
                    format!("{n} numbers"),
                )),
            }
        }
        other => Err(step.error(
            subject,
            Problem::Unknown {
                what: "step",
                found: format!("<{other}>"),
                expected: "translate, scale, rotate, lookat or matrix".into(),
            },
        )),
    }
}

/// Unit rows of the inverse of a rotation (perhaps mirrored and scaled alike in all directions), or none.
pub fn rows_of_inverse(matrix: &DMat4) -> Option<[[f32; 3]; 3]> {
    let m = DMat3::from_mat4(*matrix);
    similarity(&m)?;
    // The rows of the inverse of an orthonormal matrix are its columns.
    let x = m.x_axis.normalize();
    let y = (m.y_axis - x * m.y_axis.dot(x)).normalize();
    let z = m.z_axis - x * m.z_axis.dot(x);
    let z = (z - y * z.dot(y)).normalize();
    Some([x, y, z].map(|r| r.as_vec3().to_array()))
}

/// The scale of a matrix that keeps shapes, or none.
pub fn similarity(m: &DMat3) -> Option<f64> {
    let lengths = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
    let scale = (lengths[0] + lengths[1] + lengths[2]) / 3.0;
    let alike = lengths.iter().all(|l| (l - scale).abs() <= 1e-4 * scale);
    (alike && orthogonal(m)).then_some(scale)
}

/// Whether the axes stay perpendicular.
pub fn orthogonal(m: &DMat3) -> bool {
    let cosine = |a: DVec3, b: DVec3| (a.dot(b) / (a.length() * b.length())).abs();
    cosine(m.x_axis, m.y_axis) < 1e-4
        && cosine(m.y_axis, m.z_axis) < 1e-4
        && cosine(m.z_axis, m.x_axis) < 1e-4
}
