//! The least value of a function without derivatives.

/// Minimises `cost` from `start` by the simplex of Nelder & Mead (1965), first edge `edge`, with at most `evaluations`.
///
/// Gives the best point seen. Stops early where the simplex no longer tells its corners apart by 0.02.
pub(super) fn minimise<const N: usize>(
    start: [f64; N],
    edge: f64,
    evaluations: usize,
    cost: impl Fn(&[f64; N]) -> f64,
) -> [f64; N] {
    let value = |x: [f64; N]| {
        let c = cost(&x);
        (if c.is_nan() { f64::INFINITY } else { c }, x)
    };
    let mut corners = vec![value(start)];
    for i in 0..N {
        let mut x = start;
        x[i] += edge;
        corners.push(value(x));
    }
    let mut used = N + 1;
    while used < evaluations {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        if corners[N].0 - corners[0].0 < 0.02 {
            break;
        }
        let centre: [f64; N] = std::array::from_fn(|i| corners[..N].iter().map(|c| c.1[i]).sum::<f64>() / N as f64);
        let worst = corners[N];
        let along = |t: f64| value(std::array::from_fn(|i| centre[i] + t * (centre[i] - worst.1[i])));
        let reflected = along(1.0);
        used += 1;
        let next = if reflected.0 < corners[0].0 {
            used += 1;
            let expanded = along(2.0);
            if expanded.0 < reflected.0 { expanded } else { reflected }
        } else if reflected.0 < corners[N - 1].0 {
            reflected
        } else {
            used += 1;
            along(if reflected.0 < worst.0 { 0.5 } else { -0.5 })
        };
        if next.0 < worst.0 {
            corners[N] = next;
        } else {
            let best = corners[0].1;
            for corner in &mut corners[1..] {
                *corner = value(std::array::from_fn(|i| 0.5 * (best[i] + corner.1[i])));
                used += 1;
            }
        }
    }
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    corners[0].1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_walked_to_its_end_and_nan_is_a_wall() {
        let valley = |x: &[f64; 2]| {
            if x[0] > 3.0 { f64::NAN } else { 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2) }
        };
        let best = minimise([-1.2, 1.0], 0.7, 400, |x| 1e3 * valley(x));
        assert!(valley(&best) < 1e-2, "{best:?}");
    }
}
