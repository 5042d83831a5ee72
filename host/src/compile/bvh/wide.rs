//! From a binary tree to the best eight-wide one that can be cut out of it.
//!
//! The cost of a tree is what a random ray that meets the root's box is expected to pay: visits of
//! nodes and packets, weighted by the areas of their boxes. Bottom up, for every binary node and every
//! k ≤ 8, find the cheapest way to represent its subtree as at most k children of some wide node
//! (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs through compressed wide
//! BVHs", §3.1); top down, read off the choices.

use etendue::blob::format::{LANES, NONE, Node, WIDTH, child};

use super::binary::{Binary, BinaryNode};
use super::{Bounds, Primitive};

/// Cost of visiting a node. The others are relative to it, measured so that neither AVX2, which tests
/// two packets at once, nor SSE2 lose much; larger leaves also waste fewer lanes.
pub(super) const NODE: f32 = 1.0;
/// Cost of the first packet of a leaf.
const FIRST_PACKET: f32 = 0.7;
/// Cost of each further one.
const FURTHER_PACKET: f32 = 0.3;
/// Cost of testing a sphere.
const SPHERE: f32 = 0.7;
/// The most packets in a leaf.
const LEAF_PACKETS: usize = 4;
/// The most spheres in a leaf.
const LEAF_SPHERES: usize = 4;

/// How good a tree is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quality {
    /// Expected cost of a ray that meets the root's box, in visits of nodes.
    pub sah_cost: f64,
    /// Nodes.
    pub node_count: usize,
    /// Share of the packets' lanes that hold a triangle.
    pub packet_fill: f64,
    /// Mean number of children of a node.
    pub average_children: f64,
    /// Mean number of primitives in a leaf.
    pub average_leaf: f64,
}

/// A wide tree.
pub struct Wide {
    pub nodes: Vec<Node>,
    pub slots: Vec<u32>,
    pub sphere_order: Vec<u32>,
    pub depth: u32,
    pub quality: Quality,
}

/// What is known about the subtree below a binary node.
#[derive(Clone, Copy)]
struct Summary {
    bounds: Bounds,
    /// Of the bounds, relative to the whole scene's.
    area: f32,
    triangles: u32,
    spheres: u32,
    /// `cost[k − 1]`: cheapest as at most k children.
    cost: [f32; WIDTH],
    /// How: `left[k − 1]` of the k children go to the left; 0: not better than k − 1 children. For
    /// k = 1: [`NODE_CHOICE`] or [`LEAF_CHOICE`].
    left: [u8; WIDTH],
    /// As a node, how many of its eight children go to the left.
    node_left: u8,
}

const NODE_CHOICE: u8 = 0;
const LEAF_CHOICE: u8 = 1;

/// The best wide tree.
pub fn collapse(binary: &Binary, primitives: &[Primitive]) -> Wide {
    let all = primitives
        .iter()
        .fold(Bounds::EMPTY, |all, p| all.union(&p.bounds));
    let area = all.half_area();
    // Areas relative to the root's: at most 1, whatever the scene's scale.
    let scale = if area > 0.0 { 1.0 / area } else { 1.0 };
    let summaries = summarise(binary, primitives, scale);
    let mut writer = Writer {
        binary,
        primitives,
        summaries: &summaries,
        wide: Wide::empty(),
    };
    writer.write();
    writer.wide
}

/// Bottom up: children come after their parents.
fn summarise(binary: &Binary, primitives: &[Primitive], scale: f64) -> Vec<Summary> {
    let blank = Summary {
        bounds: Bounds::EMPTY,
        area: 0.0,
        triangles: 0,
        spheres: 0,
        cost: [0.0; WIDTH],
        left: [0; WIDTH],
        node_left: 1,
    };
    let mut summaries = vec![blank; binary.nodes.len()];
    for at in (0..binary.nodes.len()).rev() {
        summaries[at] = match binary.nodes[at] {
            BinaryNode::Leaf(primitive) => {
                let primitive = &primitives[primitive as usize];
                let mut s = blank;
                s.bounds = primitive.bounds;
                s.area = (s.bounds.half_area() * scale) as f32;
                s.triangles = u32::from(!primitive.sphere);
                s.spheres = u32::from(primitive.sphere);
                s.cost = [leaf_cost(&s); WIDTH];
                s.left[0] = LEAF_CHOICE;
                s
            }
            BinaryNode::Inner(left, right) => {
                join(&summaries[left as usize], &summaries[right as usize], scale)
            }
        };
    }
    summaries
}

fn join(l: &Summary, r: &Summary, scale: f64) -> Summary {
    // Cheapest distribution of k children.
    let best = |k: usize| {
        (1..k)
            .map(|j| (l.cost[j - 1] + r.cost[k - j - 1], j as u8))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or((f32::INFINITY, 0))
    };
    let bounds = l.bounds.union(&r.bounds);
    let mut s = Summary {
        bounds,
        area: (bounds.half_area() * scale) as f32,
        triangles: l.triangles + r.triangles,
        spheres: l.spheres + r.spheres,
        cost: [0.0; WIDTH],
        left: [0; WIDTH],
        node_left: 0,
    };
    let (below, node_left) = best(WIDTH);
    s.node_left = node_left;
    let as_node = s.area * NODE + below;
    let as_leaf = leaf_cost(&s);
    (s.cost[0], s.left[0]) = if as_leaf <= as_node {
        (as_leaf, LEAF_CHOICE)
    } else {
        (as_node, NODE_CHOICE)
    };
    for k in 2..=WIDTH {
        let (cost, left) = best(k);
        (s.cost[k - 1], s.left[k - 1]) = if cost < s.cost[k - 2] {
            (cost, left)
        } else {
            (s.cost[k - 2], 0)
        };
    }
    s
}

/// Infinite if it can't be one leaf.
fn leaf_cost(s: &Summary) -> f32 {
    let packets = (s.triangles as usize).div_ceil(LANES);
    let spheres = s.spheres as usize;
    if (packets > 0 && spheres > 0) || packets > LEAF_PACKETS || spheres > LEAF_SPHERES {
        return f32::INFINITY;
    }
    s.area * tests(packets, spheres)
}

/// Cost of the tests in a leaf.
pub(super) fn tests(packets: usize, spheres: usize) -> f32 {
    match packets {
        0 => spheres as f32 * SPHERE,
        _ => FIRST_PACKET + (packets - 1) as f32 * FURTHER_PACKET,
    }
}

impl Wide {
    fn empty() -> Self {
        Self {
            nodes: Vec::new(),
            slots: Vec::new(),
            sphere_order: Vec::new(),
            depth: 0,
            quality: Quality::default(),
        }
    }
}

struct Writer<'a> {
    binary: &'a Binary,
    primitives: &'a [Primitive],
    summaries: &'a [Summary],
    wide: Wide,
}

impl Writer<'_> {
    /// Top down, depth first.
    fn write(&mut self) {
        let mut cost = 0.0;
        let (mut children, mut leaves) = (0, 0);
        self.wide.nodes.push(EMPTY_NODE);
        // Binary node, the place of its wide node, depth.
        let mut open = vec![(0_u32, 0_usize, 0_u32)];
        while let Some((root, at, depth)) = open.pop() {
            self.wide.depth = self.wide.depth.max(depth);
            let members = self.members(root);
            if let Some(summary) = self.summaries.get(root as usize) {
                cost += f64::from(summary.area * NODE);
            }
            children += members.len();
            for (i, &member) in members.iter().enumerate() {
                let summary = &self.summaries[member as usize];
                let reference = if summary.left[0] == LEAF_CHOICE {
                    leaves += 1;
                    cost += f64::from(leaf_cost(summary));
                    self.leaf(member)
                } else {
                    self.wide.nodes.push(EMPTY_NODE);
                    let below = self.wide.nodes.len() - 1;
                    open.push((member, below, depth + 1));
                    below as u32
                };
                let node = &mut self.wide.nodes[at];
                node.children[i] = reference;
                for axis in 0..3 {
                    node.low[axis][i] = summary.bounds.low[axis];
                    node.high[axis][i] = summary.bounds.high[axis];
                }
            }
        }
        let triangles = self.wide.slots.iter().filter(|&&slot| slot != NONE).count();
        let total = triangles + self.wide.sphere_order.len();
        self.wide.quality = Quality {
            sah_cost: cost,
            node_count: self.wide.nodes.len(),
            packet_fill: triangles as f64 / self.wide.slots.len().max(1) as f64,
            average_children: children as f64 / self.wide.nodes.len() as f64,
            average_leaf: total as f64 / leaves.max(1) as f64,
        };
    }

    /// The binary nodes that become children of the wide node at `root`.
    fn members(&self, root: u32) -> Vec<u32> {
        let mut members = Vec::with_capacity(WIDTH);
        let Some(&node) = self.binary.nodes.get(root as usize) else {
            return members;
        };
        let BinaryNode::Inner(left, right) = node else {
            members.push(root); // a single primitive
            return members;
        };
        let summary = &self.summaries[root as usize];
        if root == 0 && summary.left[0] == LEAF_CHOICE {
            members.push(root); // a single leaf
            return members;
        }
        let to_left = summary.node_left;
        let mut open = vec![(right, WIDTH as u8 - to_left), (left, to_left)];
        while let Some((at, mut k)) = open.pop() {
            let summary = &self.summaries[at as usize];
            while k > 1 && summary.left[k as usize - 1] == 0 {
                k -= 1;
            }
            match self.binary.nodes[at as usize] {
                BinaryNode::Inner(left, right) if k > 1 => {
                    let to_left = summary.left[k as usize - 1];
                    open.extend([(right, k - to_left), (left, to_left)]);
                }
                _ => members.push(at),
            }
        }
        members
    }

    /// Writes the primitives below a binary node as a leaf.
    fn leaf(&mut self, root: u32) -> u32 {
        let first_slot = self.wide.slots.len();
        let first_sphere = self.wide.sphere_order.len();
        let mut open = vec![root];
        while let Some(at) = open.pop() {
            match self.binary.nodes[at as usize] {
                BinaryNode::Inner(left, right) => open.extend([right, left]),
                BinaryNode::Leaf(primitive) => {
                    let primitive = &self.primitives[primitive as usize];
                    if primitive.sphere {
                        self.wide.sphere_order.push(primitive.source);
                    } else {
                        self.wide.slots.push(primitive.source);
                    }
                }
            }
        }
        self.wide
            .slots
            .resize(self.wide.slots.len().next_multiple_of(LANES), NONE);
        let packets = (self.wide.slots.len() - first_slot) / LANES;
        let spheres = self.wide.sphere_order.len() - first_sphere;
        let (flags, start, count) = if packets > 0 {
            (child::LEAF, first_slot / LANES, packets)
        } else {
            (child::LEAF | child::SPHERES, first_sphere, spheres)
        };
        flags | (count as u32 - 1) << child::COUNT_SHIFT | start as u32
    }
}

const EMPTY_NODE: Node = Node {
    low: [[f32::INFINITY; WIDTH]; 3],
    high: [[f32::NEG_INFINITY; WIDTH]; 3],
    children: [child::EMPTY; WIDTH],
    parent: NONE,
    level: 0,
    reserved: [0; 6],
};
