//! Scenes of three sizes, made in code: boxes lit by nothing, for rays only.

use core::f32::consts::PI;

use etendue::real::Vec3;

pub type Triangle = [[f32; 3]; 3];

/// A closed room around [−1, 1]³ with two blocks in it: 36 triangles.
pub fn cornell() -> Vec<Triangle> {
    let mut triangles = Vec::new();
    block(&mut triangles, Vec3::ZERO, Vec3::ONE, 0.0);
    block(
        &mut triangles,
        Vec3::new(-0.35, -0.4, -0.3),
        Vec3::new(0.3, 0.6, 0.3),
        0.3,
    );
    block(
        &mut triangles,
        Vec3::new(0.35, -0.7, 0.3),
        Vec3::new(0.3, 0.3, 0.3),
        -0.3,
    );
    triangles
}

/// A bumpy sphere of about `count` triangles in a room with two blocks.
pub fn bumpy(count: usize) -> Vec<Triangle> {
    let mut triangles = cornell();
    let rows = ((count as f32 / 4.0).sqrt() as usize).max(3);
    let point = |i: usize, j: usize| {
        let (theta, phi) = (
            i as f32 / rows as f32 * PI,
            (j % (2 * rows)) as f32 / rows as f32 * PI,
        );
        let n = Vec3::new(
            theta.sin() * phi.cos(),
            theta.cos(),
            theta.sin() * phi.sin(),
        );
        let waves = (n * 9.0).map(f32::sin).element_sum()
            + 0.4 * (n * 31.0).map(f32::sin).element_product();
        (n * (0.65 + 0.06 * waves)).to_array()
    };
    for i in 0..rows {
        for j in 0..2 * rows {
            let [a, b, c, d] = [
                point(i, j),
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
            ];
            triangles.push([a, b, c]);
            triangles.push([a, c, d]);
        }
    }
    triangles
}

/// A box turned about y.
fn block(triangles: &mut Vec<Triangle>, center: Vec3, half: Vec3, turn: f32) {
    let (s, c) = turn.sin_cos();
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let p = Vec3::new(sign(0), sign(1), sign(2)) * half;
        (center + Vec3::new(c * p.x + s * p.z, p.y, c * p.z - s * p.x)).to_array()
    };
    for [a, b, c, d] in [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ] {
        triangles.push([corner(a), corner(b), corner(c)]);
        triangles.push([corner(a), corner(c), corner(d)]);
    }
}
