//! New boxes for a tree whose primitives have moved. Its shape stays: what was close together when it was built and
//! isn't any more makes boxes that overlap, and rays slower, never wrong.

use super::wide::{NODE, Quality, Wide, tests};
use super::{Bounds, Built, has_area, pack};
use etendue::blob::format::{LANES, NONE, Node, WIDTH, child};

/// The shape of a tree: what outlives its boxes and vertices.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Nodes; children come after their parents.
    pub nodes: Vec<Node>,
    /// Which source triangle stands in a slot, [`NONE`] if none does.
    pub slots: Vec<u32>,
    /// Which source sphere is the i-th.
    pub sphere_order: Vec<u32>,
    /// Depth of the deepest leaf's parent, the root being at depth 0.
    pub depth: u32,
}

/// `tree` around these primitives, or `None` if it isn't a tree of theirs: their number is another, or a triangle that it
/// left out has an area now, or one that it holds has none.
pub fn refit(
    tree: &Tree,
    triangles: &[[[f32; 3]; 3]],
    spheres: &[([f32; 3], f32)],
) -> Option<Built> {
    let mut held = vec![false; triangles.len()];
    for &source in tree.slots.iter().filter(|&&s| s != NONE) {
        *held.get_mut(source as usize)? = true;
    }
    let fits = held.iter().zip(triangles).all(|(&h, t)| h == has_area(t));
    if !fits || tree.sphere_order.len() != spheres.len() {
        return None;
    }
    let ball = |&i: &u32| {
        let &(center, radius) = spheres.get(i as usize)?;
        Some(Bounds::of_sphere(center, radius)).filter(Bounds::is_finite)
    };
    let balls = tree
        .sphere_order
        .iter()
        .map(ball)
        .collect::<Option<Vec<_>>>()?;
    let mut nodes = tree.nodes.clone();
    let mut bounds = vec![Bounds::EMPTY; nodes.len()];
    // Areas wait for the root's, which they are relative to.
    let (mut cost, mut children, mut leaves) = (0.0, 0, 0);
    for at in (0..nodes.len()).rev() {
        let node = &mut nodes[at];
        for i in 0..WIDTH {
            let reference = node.children[i];
            if reference == child::EMPTY {
                continue;
            }
            children += 1;
            let below = if reference & child::LEAF == 0 {
                bounds[reference as usize]
            } else {
                leaves += 1;
                let start = (reference & child::START_MASK) as usize;
                let count = (reference >> child::COUNT_SHIFT & 15) as usize + 1;
                let round = reference & child::SPHERES != 0;
                let all = if round {
                    balls[start..start + count]
                        .iter()
                        .copied()
                        .fold(Bounds::EMPTY, union)
                } else {
                    tree.slots[start * LANES..(start + count) * LANES]
                        .iter()
                        .filter(|&&s| s != NONE)
                        .map(|&s| Bounds::of_triangle(&triangles[s as usize]))
                        .fold(Bounds::EMPTY, union)
                };
                let (packets, spheres) = if round { (0, count) } else { (count, 0) };
                cost += all.half_area() * f64::from(tests(packets, spheres));
                all
            };
            bounds[at] = bounds[at].union(&below);
            for axis in 0..3 {
                node.low[axis][i] = below.low[axis];
                node.high[axis][i] = below.high[axis];
            }
        }
        cost += bounds[at].half_area() * f64::from(NODE);
    }
    let area = bounds.first().map_or(0.0, Bounds::half_area);
    let filled = tree.slots.iter().filter(|&&slot| slot != NONE).count();
    let quality = Quality {
        sah_cost: if area > 0.0 { cost / area } else { cost },
        node_count: nodes.len(),
        packet_fill: filled as f64 / tree.slots.len().max(1) as f64,
        average_children: f64::from(children) / nodes.len().max(1) as f64,
        average_leaf: (filled + balls.len()) as f64 / f64::from(leaves.max(1)),
    };
    let wide = Wide {
        nodes,
        slots: tree.slots.clone(),
        sphere_order: tree.sphere_order.clone(),
        depth: tree.depth,
        quality,
    };
    Some(pack(wide, triangles))
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    a.union(&b)
}
