//! Trees whose primitives have moved.

use super::trees::{Random, Triangle, World, assert_same, ray, soup};
use etendue::real::Vec3;
use etendue_host::compile::bvh::{self, Built, Tree};

type Sphere = ([f32; 3], f32);

fn shape_of(built: &Built) -> Tree {
    Tree {
        nodes: built.nodes.clone(),
        slots: built.slots.clone(),
        sphere_order: built.sphere_order.clone(),
        depth: built.depth,
    }
}

fn scene(random: &mut Random) -> (Vec<Triangle>, Vec<Sphere>) {
    let mut triangles = soup(random, 300, 0.2);
    // One that has no area, so that no tree holds it.
    triangles.push([[0.5; 3]; 3]);
    let spheres = (0..40).map(|_| (random.cube().to_array(), 0.05)).collect();
    (triangles, spheres)
}

/// Everything away from where it was, each on its own way: the hardest that a tree can be asked.
fn scattered(
    random: &mut Random,
    (triangles, spheres): &(Vec<Triangle>, Vec<Sphere>),
) -> (Vec<Triangle>, Vec<Sphere>) {
    let mut away = |far: f32| random.cube().to_array().map(|x| x * far);
    let moved = |p: &[f32; 3], by: [f32; 3]| std::array::from_fn(|i| p[i] + by[i]);
    (
        triangles
            .iter()
            .map(|t| {
                let by = away(1.0);
                t.map(|p| moved(&p, by))
            })
            .collect(),
        spheres
            .iter()
            .map(|(c, r)| (moved(c, away(1.0)), *r))
            .collect(),
    )
}

#[test]
fn what_has_not_moved_keeps_its_tree_bit_by_bit() {
    let (triangles, spheres) = scene(&mut Random(41));
    let built = bvh::build(&triangles, &spheres).unwrap();
    let again = bvh::refit(&shape_of(&built), &triangles, &spheres).unwrap();
    for (a, b) in built.nodes.iter().zip(&again.nodes) {
        assert_eq!((a.low, a.high, a.children), (b.low, b.high, b.children));
    }
    for (a, b) in built.packets.iter().zip(&again.packets) {
        assert_eq!(a.v, b.v);
    }
    let (a, b) = (built.quality, again.quality);
    assert!((a.sah_cost - b.sah_cost).abs() < 1e-4 * a.sah_cost);
    assert_eq!(a.packet_fill, b.packet_fill);
    assert_eq!(
        (a.average_children, a.average_leaf),
        (b.average_children, b.average_leaf)
    );
}

#[test]
fn rays_meet_what_has_moved_where_it_is() {
    let mut random = Random(42);
    let before = scene(&mut random);
    let tree = shape_of(&bvh::build(&before.0, &before.1).unwrap());
    let (triangles, spheres) = scattered(&mut random, &before);
    let refitted = bvh::refit(&tree, &triangles, &spheres).unwrap();
    let fresh = bvh::build(&triangles, &spheres).unwrap();
    assert!(refitted.quality.sah_cost > fresh.quality.sah_cost);
    // Its boxes hold what they should: `World` looks.
    let world = World::of(refitted, &triangles, &spheres);
    let singles = world.singles(&triangles, &spheres);
    let mut hits = 0;
    for _ in 0..1000 {
        let origin = random.cube() * 2.0;
        let target = Vec3::from(triangles[random.below(300)][0]) + random.cube() * 0.1;
        let ray = ray(origin, (target - origin).normalize());
        let hit = world.closest(&ray);
        assert_same(hit, world.brute_force(&singles, &ray), &ray);
        hits += u32::from(hit.is_some());
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn a_tree_of_other_primitives_is_refused() {
    let (mut triangles, spheres) = scene(&mut Random(43));
    let tree = shape_of(&bvh::build(&triangles, &spheres).unwrap());
    assert!(bvh::refit(&tree, &triangles[1..], &spheres).is_none());
    assert!(bvh::refit(&tree, &triangles, &spheres[1..]).is_none());
    let mut longer = triangles.clone();
    longer.push(triangles[0]);
    assert!(bvh::refit(&tree, &longer, &spheres).is_none());
    // One that had no area gets some; one that had some has none.
    triangles.swap(0, 300);
    assert!(bvh::refit(&tree, &triangles, &spheres).is_none());
    triangles[0] = triangles[300];
    assert!(bvh::refit(&tree, &triangles, &spheres).is_none());
}
