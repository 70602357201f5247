//! Rings in a graph.

use std::collections::{BTreeMap, BTreeSet};

/// The sets of nodes each of which leads to every other of its set, as far as these have more than one node.
pub(crate) fn rings<N: Copy + Ord>(edges: &BTreeMap<N, BTreeSet<N>>) -> Vec<Vec<N>> {
    let reached: BTreeMap<N, BTreeSet<N>> = edges.keys().map(|node| (*node, reachable(*node, edges))).collect();
    let leads = |from: &N, to: &N| reached.get(from).is_some_and(|nodes| nodes.contains(to));
    let mut rings: Vec<Vec<N>> = Vec::new();
    for node in edges.keys() {
        if rings.iter().any(|ring| ring.contains(node)) {
            continue;
        }
        let ring: Vec<N> =
            edges.keys().copied().filter(|other| other == node || (leads(node, other) && leads(other, node))).collect();
        if ring.len() > 1 {
            rings.push(ring);
        }
    }
    rings
}

/// The nodes that a node leads to.
fn reachable<N: Copy + Ord>(from: N, edges: &BTreeMap<N, BTreeSet<N>>) -> BTreeSet<N> {
    let (mut found, mut left) = (BTreeSet::new(), vec![from]);
    while let Some(node) = left.pop() {
        for next in edges.get(&node).into_iter().flatten() {
            if found.insert(*next) {
                left.push(*next);
            }
        }
    }
    found
}

#[test]
fn each_ring_is_found_once() {
    let edges = [(1, vec![2]), (2, vec![3]), (3, vec![1, 4]), (4, vec![5]), (5, vec![4, 6]), (6, vec![])];
    let edges = edges.into_iter().map(|(node, to)| (node, to.into_iter().collect())).collect();
    assert_eq!(rings(&edges), [vec![1, 2, 3], vec![4, 5]]);
}
