//! Alias tables (Walker 1977) by Vose's construction (1991).

/// For each entry the probability of staying and where to go otherwise. `weights` are ≥ 0, not all 0.
pub(super) fn table(weights: &[f64]) -> Vec<(f32, u32)> {
    let total: f64 = weights.iter().sum();
    let mean = total / weights.len() as f64;
    let mut share: Vec<f64> = weights.iter().map(|w| w / mean).collect();
    let mut entries: Vec<(f32, u32)> = (0..weights.len() as u32).map(|i| (1.0, i)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) =
        (0..share.len()).partition(|&i| share[i] < 1.0);
    while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
        small.pop();
        entries[s] = (share[s] as f32, l as u32);
        share[l] -= 1.0 - share[s];
        if share[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    // What rounding left over stays with probability 1, unless it must never be chosen.
    for i in small {
        if weights[i] == 0.0 {
            let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
            entries[i] = (0.0, heaviest.unwrap_or(i) as u32);
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::table;

    #[test]
    fn entries_have_the_probabilities_of_their_weights() {
        let weights = [3.0, 0.0, 1.0, 0.25, 7.0, 0.0, 1e-3];
        let n = weights.len() as f64;
        let total: f64 = weights.iter().sum();
        let mut probability = vec![0.0; weights.len()];
        for (i, (keep, alias)) in table(&weights).into_iter().enumerate() {
            probability[i] += f64::from(keep) / n;
            probability[alias as usize] += (1.0 - f64::from(keep)) / n;
        }
        for (p, w) in probability.iter().zip(weights) {
            assert!((p - w / total).abs() < 1e-7, "{p} for {w}");
        }
        assert_eq!(probability[1], 0.0);
    }
}
