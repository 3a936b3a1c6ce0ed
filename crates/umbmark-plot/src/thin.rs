//! Fewer places for the same picture.

/// Indices of about `most` of the places, in order, such that no extreme is lost: of each stretch of neighbours, those where
/// one of the coordinates is least or greatest. The first and the last stay.
pub fn thin(coordinates: &[&[f64]], most: usize) -> Vec<usize> {
    let count = coordinates.first().map_or(0, |c| c.len());
    if count <= most {
        return (0..count).collect();
    }
    let stretches = (most.saturating_sub(2) / (2 * coordinates.len())).max(1);
    let mut kept = vec![0, count - 1];
    for stretch in 0..stretches {
        let (from, to) = (stretch * count / stretches, (stretch + 1) * count / stretches);
        for values in coordinates {
            let finite = || (from..to).filter(|i| values[*i].is_finite());
            kept.extend(finite().min_by(|a, b| values[*a].total_cmp(&values[*b])));
            kept.extend(finite().max_by(|a, b| values[*a].total_cmp(&values[*b])));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_among_a_million_places_is_kept() {
        let mut y: Vec<f64> = (0..1_000_000).map(|i| f64::from(i % 7)).collect();
        let x: Vec<f64> = (0..1_000_000).map(f64::from).collect();
        y[123_456] = 1e3;
        y[654_321] = -1e3;
        let kept = thin(&[&x, &y], 400);
        assert!(kept.len() <= 400 && kept.contains(&123_456) && kept.contains(&654_321));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 999_999));
    }

    #[test]
    fn few_places_all_stay() {
        assert_eq!(thin(&[&[1.0, f64::NAN, 3.0]], 3), [0, 1, 2]);
        assert!(thin(&[&[]], 3).is_empty());
    }
}
