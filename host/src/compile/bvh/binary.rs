//! Binary trees with one primitive per leaf.

use glam::Vec3A;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::{Bounds, Primitive};

/// A binary tree; node 0 is the root, children come after their parents. Empty if there are no primitives.
pub struct Binary {
    pub nodes: Vec<BinaryNode>,
}

/// A node of a binary tree.
#[derive(Clone, Copy, Debug)]
pub enum BinaryNode {
    /// Its two children.
    Inner(u32, u32),
    /// A primitive.
    Leaf(u32),
}

/// For the builder, which works in single precision.
struct Bounded(Aabb);

impl Boundable for Bounded {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// How many neighbours along the curve a cluster is compared with, on each side.
const SEARCH: PlocSearchDistance = PlocSearchDistance::Medium;
/// Rounds in which only the next neighbours are.
const FAST_ROUNDS: usize = 2;
/// Share of the nodes that reinsertion tries to move, per round of decreasing size.
const REINSERTED: f32 = 0.15;

/// Clusters neighbours along a Morton curve, then moves subtrees to better places.
pub fn clustered(primitives: &[Primitive]) -> Binary {
    let boxes = builder_boxes(primitives);
    let indices = (0..primitives.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(primitives.len()).build(
        SEARCH,
        &boxes,
        indices,
        SortPrecision::U64,
        FAST_ROUNDS,
    );
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    tree.reorder_in_stack_traversal_order();
    let nodes = tree
        .nodes
        .iter()
        .map(|node| {
            if node.is_leaf() {
                BinaryNode::Leaf(tree.primitive_indices[node.first_index as usize])
            } else {
                BinaryNode::Inner(node.first_index, node.first_index + 1)
            }
        })
        .collect();
    Binary { nodes }
}

/// The primitives' boxes in units of the scene's, so that areas neither overflow nor vanish; and each
/// a little larger, by a hash of its index. Among exactly equal candidates PLOC finds few pairs that
/// choose each other: without the noise a row or a stack of equal things would take quadratic time.
fn builder_boxes(primitives: &[Primitive]) -> Vec<Bounded> {
    let all = primitives
        .iter()
        .fold(Bounds::EMPTY, |all, p| all.union(&p.bounds));
    let extent =
        |bounds: &Bounds, axis: usize| f64::from(bounds.high[axis]) - f64::from(bounds.low[axis]);
    let widest = (0..3).map(|axis| extent(&all, axis)).fold(0.0, f64::max);
    let unit = if widest > 0.0 { 1.0 / widest } else { 1.0 };
    let scaled = |(index, primitive): (usize, &Primitive)| {
        let bounds = &primitive.bounds;
        let corner = |x: &[f32; 3], noise: f64| {
            Vec3A::from_array(core::array::from_fn(|axis| {
                let x = (f64::from(x[axis]) - f64::from(all.low[axis])) * unit;
                let room = extent(bounds, axis) * unit * BOX_NOISE + LEAST_NOISE;
                (x + room * noise * hash(3 * index + axis)) as f32
            }))
        };
        Bounded(Aabb::new(
            corner(&bounds.low, 0.0),
            corner(&bounds.high, 1.0),
        ))
    };
    primitives.iter().enumerate().map(scaled).collect()
}

/// How much larger boxes may become, relative to themselves,
const BOX_NOISE: f64 = 1.0 / 512.0;
/// and relative to the scene.
const LEAST_NOISE: f64 = 1.0 / 4_194_304.0;

/// A number in [0, 1) (the finaliser of SplitMix64, Steele et al. 2014).
fn hash(index: usize) -> f64 {
    let mut z = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Halves at the median of centres along the widest axis: depth ⌈log₂ n⌉ in time O(n log n), whatever the input.
pub fn halved(primitives: &[Primitive]) -> Binary {
    let mut order: Vec<u32> = (0..primitives.len() as u32).collect();
    let mut nodes = Vec::with_capacity(2 * primitives.len());
    // Ranges of `order` whose node's place is reserved.
    let mut open = Vec::new();
    if !primitives.is_empty() {
        nodes.push(BinaryNode::Leaf(0));
        open.push((0, 0..primitives.len()));
    }
    while let Some((at, range)) = open.pop() {
        if range.len() == 1 {
            nodes[at] = BinaryNode::Leaf(order[range.start]);
            continue;
        }
        let center = |i: u32, axis: usize| {
            let bounds = &primitives[i as usize].bounds;
            f64::from(bounds.low[axis]) + f64::from(bounds.high[axis])
        };
        let extent = |axis: usize| {
            let (low, high) = order[range.clone()]
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &i| {
                    (low.min(center(i, axis)), high.max(center(i, axis)))
                });
            high - low
        };
        let axis = (0..3)
            .max_by(|&a, &b| extent(a).total_cmp(&extent(b)))
            .unwrap_or(0);
        let middle = range.len() / 2;
        order[range.clone()].select_nth_unstable_by(middle, |&a, &b| {
            // Indices break ties, so that the tree is a function of the input.
            center(a, axis).total_cmp(&center(b, axis)).then(a.cmp(&b))
        });
        let (left, right) = (nodes.len(), nodes.len() + 1);
        nodes[at] = BinaryNode::Inner(left as u32, right as u32);
        nodes.extend([BinaryNode::Leaf(0); 2]);
        open.push((left, range.start..range.start + middle));
        open.push((right, range.start + middle..range.end));
    }
    Binary { nodes }
}
