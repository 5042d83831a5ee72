//! No ray slips between triangles that share an edge or a vertex, and none is caught beyond an edge.

use etendue::real::Vec3;
use etendue::shape::{Avx2, Tracer};

use crate::trees::{Random, Triangle, World, ray};

/// A closed sphere of quads, `n` of them from pole to pole: corners shared bit by bit.
fn globe(n: usize, corner: impl Fn(Vec3) -> Vec3) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let mut vertices = vec![corner(Vec3::Y), corner(-Vec3::Y)];
    let row = |i: usize, j: usize| 2 + (i - 1) * 2 * n + j % (2 * n);
    let mut faces = Vec::new();
    for i in 1..n {
        for j in 0..2 * n {
            let (theta, phi) = (i as f32 / n as f32, j as f32 / n as f32);
            let (st, ct) = (theta * core::f32::consts::PI).sin_cos();
            let (sp, cp) = (phi * core::f32::consts::PI).sin_cos();
            vertices.push(corner(Vec3::new(st * cp, ct, st * sp)));
            if i == 1 {
                faces.push([0, row(1, j), row(1, j + 1)]);
            } else {
                faces.push([row(i - 1, j), row(i, j), row(i, j + 1)]);
                faces.push([row(i - 1, j), row(i, j + 1), row(i - 1, j + 1)]);
            }
            if i == n - 1 {
                faces.push([row(i, j), 1, row(i, j + 1)]);
            }
        }
    }
    (vertices, faces)
}

/// Aims at shared vertices, at points of shared edges and at their neighbourhoods from inside.
fn assert_tight(
    random: &mut Random,
    vertices: &[Vec3],
    faces: &[[usize; 3]],
    center: Vec3,
    rays: usize,
) {
    let triangles: Vec<Triangle> = faces
        .iter()
        .map(|f| f.map(|i| vertices[i].to_array()))
        .collect();
    let world = World::new(&triangles, &[]);
    let scale = (vertices[0] - center).length();
    let best = Avx2::detect();
    for i in 0..rays {
        let origin = center + random.cube() * (0.4 * scale);
        let face = faces[random.below(faces.len())];
        let (a, b) = (vertices[face[0]], vertices[face[1 + random.below(2)]]);
        let target = match i % 3 {
            0 => a,
            1 => a + (b - a) * random.unit(),
            _ => a + (b - a) * (random.below(9) as f32 / 8.0),
        };
        let ray = ray(origin, (target - origin).normalize());
        // All instruction sets now and then; the fastest always.
        let hit = match best {
            Some(avx2) if i % 16 != 0 => world.bvh(avx2).closest(&ray),
            _ => world.closest(&ray),
        };
        assert!(hit.is_some(), "{ray:?} aimed at {target:?} escaped");
    }
}

#[test]
fn nothing_escapes_a_closed_mesh() {
    let mut random = Random(2);
    let (vertices, faces) = globe(40, |v| {
        v * (1.0 + 0.1 * (7.0 * v.x).sin() * (9.0 * v.z).cos())
    });
    assert_tight(&mut random, &vertices, &faces, Vec3::ZERO, 3_000_000);
}

#[test]
fn nothing_escapes_at_any_scale_or_place() {
    let mut random = Random(3);
    for scale in [1e-18, 1e-4, 1e-2, 1e3, 1e6, 1e17] {
        let (vertices, faces) = globe(24, |v| v * scale);
        assert_tight(&mut random, &vertices, &faces, Vec3::ZERO, 200_000);
    }
    for place in [
        Vec3::new(1e3, -2e3, 5e2),
        Vec3::new(-1e5, 1e5, 3e5),
        Vec3::new(0.0, 0.0, 1e6),
    ] {
        let (vertices, faces) = globe(24, |v| place + v);
        assert_tight(&mut random, &vertices, &faces, place, 200_000);
    }
}

/// Large triangles beside small ones: the shear's rounding grows with the far vertices.
#[test]
fn nothing_escapes_a_box_with_long_walls() {
    let mut random = Random(4);
    let corners: Vec<Vec3> = (0..8)
        .map(|i| {
            Vec3::new(
                (i & 1) as f32 * 1000.0,
                (i >> 1 & 1) as f32,
                (i >> 2) as f32,
            )
        })
        .collect();
    let faces: Vec<[usize; 3]> = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ]
    .iter()
    .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
    .collect();
    let triangles: Vec<Triangle> = faces
        .iter()
        .map(|f| f.map(|i| corners[i].to_array()))
        .collect();
    let world = World::new(&triangles, &[]);
    for _ in 0..500_000 {
        let origin = Vec3::new(
            1000.0 * random.unit(),
            0.01 + 0.98 * random.unit(),
            0.01 + 0.98 * random.unit(),
        );
        let (y, z) = (random.below(2) as f32, random.below(2) as f32);
        let near = origin.x + (random.unit() - 0.5) * 4.0;
        let target = match random.below(3) {
            0 => Vec3::new(near.clamp(0.0, 1000.0), y, z),
            1 => Vec3::new(1000.0 * random.below(2) as f32, y, z),
            _ => Vec3::new(near.clamp(0.0, 1000.0), y, random.unit()),
        };
        let ray = ray(origin, (target - origin).normalize());
        assert!(
            world.closest(&ray).is_some(),
            "{ray:?} aimed at {target:?} escaped"
        );
    }
}

/// A ray along z from the origin shears nothing, so the exact answer is a matter of signs of differences
/// of products that are exact in double precision. Edges pass the ray within the last bits.
#[test]
fn edges_are_decided_exactly() {
    let mut random = Random(10);
    let mut answers = [0; 2];
    for i in 0..200_000 {
        let mut near = || (random.unit() + 0.5) * if random.below(2) == 0 { 1.0 } else { -1.0 };
        let (a, c) = ([near(), near()], [near(), near()]);
        let stretch = 0.5 + near().abs();
        let b = [-a[0] * stretch, -a[1] * stretch];
        let scale = [1.0, 1e-18, 1e17, 1e-6][i % 4];
        let triangle = [a, b, c].map(|[x, y]| [x * scale, y * scale, scale]);
        let side = |p: [f32; 3], q: [f32; 3]| {
            let (px_qy, py_qx) = (
                f64::from(p[0]) * f64::from(q[1]),
                f64::from(p[1]) * f64::from(q[0]),
            );
            px_qy.total_cmp(&py_qx) as i32
        };
        let [a, b, c] = triangle;
        let sides = [side(a, b), side(b, c), side(c, a)];
        let expected = !(sides.contains(&1) && sides.contains(&-1)) && sides != [0; 3];
        let world = World::new(&[triangle], &[]);
        let hit = world.closest(&ray(Vec3::ZERO, Vec3::Z));
        assert_eq!(hit.is_some(), expected, "{triangle:?} {sides:?}");
        if let Some(hit) = hit {
            assert!((hit.t / scale - 1.0).abs() < 1e-6, "{hit:?}");
        }
        answers[usize::from(expected)] += 1;
    }
    assert!(
        answers.iter().all(|n| *n > 20_000),
        "{answers:?}: one-sided"
    );
}
