//! Traversal against brute force and closed forms: which primitive, where, and never through a crack.

mod refit;
mod trees;
mod watertight;

use etendue::blob::format::{Node, Sphere};
use etendue::real::Vec3;
use etendue::shape::{self, Avx2, IsaKind, Ray};
use etendue_host::compile::bvh;

use trees::{Random, Triangle, World, assert_same, ray, soup};

#[test]
fn agrees_with_brute_force() {
    let mut random = Random(1);
    for (count, size, rays) in [
        (1, 1.0, 300),
        (5, 0.8, 300),
        (40, 0.5, 500),
        (700, 0.2, 2000),
    ] {
        let triangles = soup(&mut random, count, size);
        let spheres: Vec<_> = (0..count / 7)
            .map(|_| (random.cube().to_array(), 0.01 + 0.2 * random.unit()))
            .collect();
        let world = World::new(&triangles, &spheres);
        let singles = world.singles(&triangles, &spheres);
        let mut hits = 0;
        for _ in 0..rays {
            let origin = random.cube() * 2.0;
            let [a, b, c] = triangles[random.below(count)].map(Vec3::from);
            let target = (a + b + c) / 3.0 + random.cube() * (0.3 * size);
            let mut ray = ray(origin, (target - origin).normalize());
            if random.below(2) == 0 {
                ray.t_min = random.unit();
                ray.t_max = ray.t_min + 2.0 * random.unit();
            }
            let hit = world.closest(&ray);
            assert_same(hit, world.brute_force(&singles, &ray), &ray);
            hits += u32::from(hit.is_some());
        }
        assert!(hits > 20, "{hits} of {rays} hit: this would test nothing");
    }
}

#[test]
fn the_lowest_of_equals_wins() {
    let mut random = Random(5);
    let one = soup(&mut random, 30, 0.5);
    let triangles: Vec<Triangle> = one.iter().cycle().take(30 * 40).copied().collect();
    let world = World::new(&triangles, &[]);
    let singles = world.singles(&triangles, &[]);
    for _ in 0..500 {
        let ray = ray(random.cube() * 2.0, random.direction());
        assert_same(world.closest(&ray), world.brute_force(&singles, &ray), &ray);
    }
}

#[test]
fn pathological_input_builds_in_time() {
    let mut random = Random(6);
    let start = std::time::Instant::now();
    let triangle = soup(&mut random, 1, 1.0)[0];
    for n in [5_000, 100_000] {
        World::new(&vec![triangle; n], &[]);
    }
    // A row of equal things at equal distances, exactly.
    let row: Vec<Triangle> = (0..60_000)
        .map(|i| {
            [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]]
                .map(|[x, y, z]: [f32; 3]| [x + i as f32, y, z])
        })
        .collect();
    World::new(&row, &[]);
    // Shells around one centre.
    let nested: Vec<Triangle> = (1..60_000)
        .map(|i| {
            [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]
                .map(|v: [f32; 3]| v.map(|x| x * i as f32))
        })
        .collect();
    World::new(&nested, &[]);
    // Sizes over all magnitudes.
    let sizes: Vec<Triangle> = (0..70)
        .flat_map(|e| {
            soup(&mut Random(e), 20, 0.5)
                .into_iter()
                .map(move |t| t.map(|v| v.map(|x| x * 10_f32.powi(e as i32 - 35))))
        })
        .collect();
    World::new(&sizes, &[]);
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn empty_and_bad_input() {
    let empty = World::new(&[], &[]);
    assert_eq!(empty.built.nodes.len(), 1);
    assert!(empty.closest(&ray(Vec3::ZERO, Vec3::X)).is_none());
    let good = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bad = [[0.0, f32::NAN, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(
        bvh::build(&[good, bad], &[]).err(),
        Some(bvh::BuildError::Triangle(1))
    );
    assert_eq!(
        bvh::build(&[], &[([0.0; 3], 0.0)]).err(),
        Some(bvh::BuildError::Sphere(0))
    );
    assert_eq!(
        bvh::build(&[], &[([3e38; 3], 3e38)]).err(),
        Some(bvh::BuildError::Sphere(0))
    );
    // No area: can't be hit, not even edge-on or at its corner.
    let line = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
    let flat = World::new(&[line, [[0.5; 3]; 3]], &[]);
    assert!(
        flat.closest(&ray(Vec3::new(-1.0, -1.0, -1.0), Vec3::ONE.normalize()))
            .is_none()
    );
    assert!(
        flat.closest(&ray(Vec3::new(0.5, 0.5, -1.0), Vec3::Z))
            .is_none()
    );
}

/// Rays without sense must do no harm, and meet nothing.
#[test]
fn senseless_rays() {
    let mut random = Random(7);
    let triangles = soup(&mut random, 200, 0.5);
    let world = World::new(&triangles, &[([0.0; 3], 0.5)]);
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        3e38,
        0.0,
        -0.0,
        1e-40,
    ];
    for _ in 0..20_000 {
        let mut any = |scale: f32| {
            Vec3::from_array(core::array::from_fn(|_| match random.below(3) {
                0 => odd[random.below(odd.len())],
                _ => (random.unit() - 0.5) * scale,
            }))
        };
        let (origin, direction) = (any(2.0), any(1.0));
        let t_min = any(1.0).x;
        let ray = Ray {
            origin,
            direction,
            t_min,
            t_max: any(10.0).y,
        };
        let hit = world.closest(&ray);
        if !origin.is_finite() || direction.is_nan() {
            assert!(hit.is_none(), "{hit:?} {ray:?}");
        }
        if let Some(hit) = hit {
            assert!(hit.t > ray.t_min && hit.t < ray.t_max, "{hit:?} {ray:?}");
        }
    }
}

/// Axis-parallel rays through a lattice of axis-parallel quads, many of them in the plane of box faces.
#[test]
fn axis_parallel_rays() {
    let n = 6;
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for i in 0..n {
            for j in 0..n {
                let at = |di: usize, dj: usize| {
                    let mut v = [0.0; 3];
                    v[axis] = 3.0;
                    v[(axis + 1) % 3] = (i + di) as f32;
                    v[(axis + 2) % 3] = (j + dj) as f32;
                    v
                };
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    let world = World::new(&triangles, &[]);
    for axis in 0..3 {
        for (i, j) in (0..=4 * n).flat_map(|i| (0..=4 * n).map(move |j| (i, j))) {
            for sign in [1.0, -1.0] {
                let mut origin = [0.0; 3];
                origin[axis] = 3.0 - 5.0 * sign;
                origin[(axis + 1) % 3] = i as f32 / 4.0;
                origin[(axis + 2) % 3] = j as f32 / 4.0;
                for zero in [0.0, -0.0] {
                    let mut direction = [zero; 3];
                    direction[axis] = sign;
                    let hit = world.closest(&ray(origin.into(), direction.into()));
                    let hit = hit.unwrap_or_else(|| panic!("{axis} {i} {j} {sign}"));
                    // Quads seen edge-on may be met first, those of the lattice's plane never missed.
                    assert!(hit.t <= 5.0, "{hit:?}");
                    if i != 12 && j != 12 {
                        assert_eq!(hit.t, 5.0);
                    }
                }
            }
        }
    }
}

#[test]
fn the_interval_is_open() {
    let triangle = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    let both = [
        World::new(&[triangle], &[]),
        World::new(&[], &[([0.0, 0.0, 3.0], 1.0)]),
    ];
    for world in both {
        let shot = |t_min, t_max| {
            world
                .closest(&Ray {
                    origin: Vec3::ZERO,
                    direction: Vec3::Z,
                    t_min,
                    t_max,
                })
                .map(|h| h.t)
        };
        assert_eq!(shot(0.0, f32::INFINITY), Some(2.0));
        assert_eq!(shot(0.0, 2.0), None);
        assert_eq!(shot(0.0, 2.0_f32.next_up()), Some(2.0));
        assert_eq!(shot(2.0_f32.next_down(), 3.0), Some(2.0));
        assert_eq!(shot(2.0, 3.0), None);
    }
}

/// The hit's distance and weights describe the same point, near the ray.
#[test]
fn hits_lie_on_ray_and_triangle() {
    let mut random = Random(8);
    let triangles = soup(&mut random, 300, 0.4);
    let world = World::new(&triangles, &[]);
    for _ in 0..5_000 {
        let ray = ray(random.cube() * 2.0, random.direction());
        let Some(hit) = world.closest(&ray) else {
            continue;
        };
        let [a, b, c] = shape::vertices(&world.built.packets, hit.primitive);
        let on_triangle = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
        let on_ray = ray.origin + ray.direction * hit.t;
        assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v < 1.000_001);
        // Slivers seen edge-on have weights of no more than single precision times their aspect.
        let normal = (b - a).cross(c - a).normalize();
        let slope = normal.dot(ray.direction).abs();
        assert!(
            (on_triangle - on_ray).length() * slope < 2e-5,
            "{hit:?} {ray:?}"
        );
    }
}

#[test]
fn spheres_meet_the_closed_form() {
    let mut random = Random(9);
    for _ in 0..100_000 {
        let radius = 10_f32.powf(random.unit() * 6.0 - 4.0);
        let center = random.cube() * 10.0;
        let far = radius * 10_f32.powf(random.unit() * 4.0);
        let outside = random.below(2) == 0;
        let origin = if outside {
            center + random.direction() * (radius + far)
        } else {
            center + random.cube() * (radius * 0.5)
        };
        let target = center + random.direction() * (radius * random.unit());
        let direction = (target - origin).normalize();
        let world = World::new(&[], &[(center.to_array(), radius)]);
        let hit = world.closest(&ray(origin, direction));

        let (o, d, c) = (origin.as_dvec3(), direction.as_dvec3(), center.as_dvec3());
        let f = o - c;
        let (a, b) = (d.dot(d), -f.dot(d));
        let l = f + d * (b / a);
        let r = f64::from(radius);
        let discriminant = r * r - l.dot(l);
        let size = f.length() + c.length();
        // How far from grazing the answer is beyond doubt.
        let margin = 1e-6 * size * r;
        if discriminant < -margin {
            assert!(hit.is_none());
        } else if discriminant > margin {
            let root = (a * discriminant).sqrt();
            let t = if b > root {
                (b - root) / a
            } else {
                (b + root) / a
            };
            let hit = hit.expect("meets the sphere");
            // The centre's and origin's own rounding moves the sphere by about size·2⁻²⁴.
            let tolerance = 1e-6 * size * (1.0 + r * r / discriminant).sqrt() + 1e-6 * t;
            assert!((f64::from(hit.t) - t).abs() < tolerance, "{hit:?} {t}");
        }
    }
}

#[test]
fn detection_agrees_with_std() {
    assert_eq!(
        Avx2::detect().is_some(),
        std::is_x86_feature_detected!("avx2")
    );
    assert!(IsaKind::best().available());
}

/// The same source in double precision meets the same primitives, but for rounding.
#[test]
fn double_precision_agrees() {
    use etendue_f64::blob::format as wide;
    use etendue_f64::shape::Tracer as _;

    let mut random = Random(11);
    let triangles = soup(&mut random, 500, 0.3);
    let spheres: Vec<_> = (0..50)
        .map(|_| (random.cube().to_array(), 0.01 + 0.1 * random.unit()))
        .collect();
    let world = World::new(&triangles, &spheres);
    let copy = |n: &Node| wide::Node {
        low: n.low,
        high: n.high,
        children: n.children,
        parent: n.parent,
        level: n.level,
        reserved: n.reserved,
    };
    let nodes: Vec<_> = world.built.nodes.iter().map(copy).collect();
    let packets: Vec<_> = world
        .built
        .packets
        .iter()
        .map(|p| wide::Packet { v: p.v })
        .collect();
    let copy = |s: &Sphere| wide::Sphere {
        center: s.center,
        radius: s.radius,
        shape: s.shape,
        flipped: s.flipped,
        reserved: s.reserved,
    };
    let spheres: Vec<_> = world.spheres.iter().map(copy).collect();
    // SAFETY: copies of what `check::tree` has verified.
    let reference = unsafe {
        etendue_f64::shape::Bvh::new(&nodes, &packets, &spheres, etendue_f64::shape::Scalar)
    };
    let (mut same, rays) = (0, 20_000);
    for _ in 0..rays {
        let ray = ray(random.cube() * 2.0, random.direction());
        let hit = world.closest(&ray);
        let exact = reference.closest(&etendue_f64::shape::Ray {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            t_min: 0.0,
            t_max: f64::INFINITY,
        });
        if hit.map(|h| h.primitive) == exact.map(|h| h.primitive) {
            same += 1;
            if let (Some(hit), Some(exact)) = (hit, exact) {
                assert!(
                    (f64::from(hit.t) - exact.t).abs() < 1e-4,
                    "{hit:?} {exact:?}"
                );
            }
        }
    }
    // Only rays that graze an edge may differ.
    assert!(same > rays - 10, "{same} of {rays}");
}
