//! Which of many boxes meet a box.

use super::binary::{Binary, BinaryNode, halved};
use super::{Bounds, Primitive};

/// A tree over boxes, halved at medians.
pub struct Boxes {
    tree: Binary,
    /// Of each of its nodes.
    bounds: Vec<Bounds>,
}

impl Boxes {
    /// Over `boxes`, which are finite.
    pub fn over(boxes: impl Iterator<Item = Bounds>) -> Self {
        let primitive = |(source, bounds)| Primitive {
            bounds,
            source: source as u32,
            sphere: false,
        };
        let primitives: Vec<_> = boxes.enumerate().map(primitive).collect();
        let tree = halved(&primitives);
        let mut bounds = vec![Bounds::EMPTY; tree.nodes.len()];
        for (at, node) in tree.nodes.iter().enumerate().rev() {
            bounds[at] = match *node {
                BinaryNode::Leaf(i) => primitives[i as usize].bounds,
                BinaryNode::Inner(a, b) => bounds[a as usize].union(&bounds[b as usize]),
            };
        }
        Self { tree, bounds }
    }

    /// Tells `each` the numbers of all that meet `other`.
    pub fn meeting(&self, other: &Bounds, mut each: impl FnMut(usize)) {
        let mut stack = Vec::from_iter((!self.bounds.is_empty()).then_some(0));
        while let Some(at) = stack.pop() {
            if !self.bounds[at].meets(other) {
                continue;
            }
            match self.tree.nodes[at] {
                BinaryNode::Leaf(i) => each(i as usize),
                BinaryNode::Inner(a, b) => stack.extend([a as usize, b as usize]),
            }
        }
    }
}
