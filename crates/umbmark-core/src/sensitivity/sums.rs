//! Sums over a Sobol design, and the indices that follow from them.

use super::Estimate;

/// Sums over rows of a design for one output: of two independent rows a and b, and of rows between them.
///
/// Outputs are taken less a fixed number near their mean, so that nothing cancels.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    rows: f64,
    a: f64,
    b: f64,
    squares: f64,
    product: f64,
    /// Σ b (s - a) and Σ (s - a), where s shares one input with b.
    first: Vec<[f64; 2]>,
    /// Σ (a - t)², where t shares all inputs but one with a.
    total: Vec<f64>,
    second: Option<Pairs>,
}

/// Sums of products of rows that share two inputs.
#[derive(Clone, Debug)]
struct Pairs {
    /// Σ over both kinds of rows, for each input.
    ab: Vec<f64>,
    ba: Vec<f64>,
    /// Σ (ab_i ba_j + ab_j ba_i) / 2, row i, column j > i.
    products: Vec<f64>,
}

/// What one output of the rows of a design is.
pub(super) struct Outputs<'a> {
    /// At a, b.
    pub base: [f64; 2],
    /// At a with one input shared with b, and at a with one input anew: for each input.
    pub shared: &'a [f64],
    /// See `shared`.
    pub anew: &'a [f64],
    /// At b with one input of a, for each input; empty where pairs are not asked for.
    pub swapped: &'a [f64],
}

impl Sums {
    pub fn new(inputs: usize, pairs: bool) -> Sums {
        let zeros = |n: usize| vec![0.0; n];
        let second = pairs.then(|| Pairs { ab: zeros(inputs), ba: zeros(inputs), products: zeros(inputs * inputs) });
        let (first, total) = (vec![[0.0; 2]; inputs], zeros(inputs));
        Sums { rows: 0.0, a: 0.0, b: 0.0, squares: 0.0, product: 0.0, first, total, second }
    }

    /// All that it holds, in the order of [`Sums::places`].
    pub fn numbers(&self) -> Vec<f64> {
        let mut copy = self.clone();
        copy.places().map(|place| *place).collect()
    }

    /// The same sums with the numbers of others.
    pub fn with(mut self, numbers: &[f64]) -> Sums {
        self.places().zip(numbers).for_each(|(place, number)| *place = *number);
        self
    }

    fn places(&mut self) -> impl Iterator<Item = &mut f64> {
        let scalars = [&mut self.rows, &mut self.a, &mut self.b, &mut self.squares, &mut self.product];
        let pairs = self.second.iter_mut().flat_map(|p| p.ab.iter_mut().chain(&mut p.ba).chain(&mut p.products));
        scalars.into_iter().chain(self.first.as_flattened_mut()).chain(&mut self.total).chain(pairs)
    }

    /// Takes one row.
    pub fn take(&mut self, outputs: &Outputs) {
        let [a, b] = outputs.base;
        self.rows += 1.0;
        self.a += a;
        self.b += b;
        self.squares += a * a + b * b;
        self.product += a * b;
        for (i, (shared, anew)) in outputs.shared.iter().zip(outputs.anew).enumerate() {
            self.first[i][0] += b * (shared - a);
            self.first[i][1] += shared - a;
            self.total[i] += (a - anew) * (a - anew);
        }
        let Some(pairs) = &mut self.second else { return };
        let n = outputs.swapped.len();
        for i in 0..n {
            pairs.ab[i] += outputs.anew[i];
            pairs.ba[i] += outputs.swapped[i];
            for j in i + 1..n {
                let both = outputs.anew[i] * outputs.swapped[j] + outputs.anew[j] * outputs.swapped[i];
                pairs.products[i * n + j] += 0.5 * both;
            }
        }
    }

    /// Takes all rows that `other` took.
    pub fn merge(&mut self, other: &Sums) {
        let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        let scalars = [other.rows, other.a, other.b, other.squares, other.product];
        for (to, from) in
            [&mut self.rows, &mut self.a, &mut self.b, &mut self.squares, &mut self.product].into_iter().zip(scalars)
        {
            *to += from;
        }
        add(self.first.as_flattened_mut(), other.first.as_flattened());
        add(&mut self.total, &other.total);
        if let (Some(to), Some(from)) = (&mut self.second, &other.second) {
            add(&mut to.ab, &from.ab);
            add(&mut to.ba, &from.ba);
            add(&mut to.products, &from.products);
        }
    }

    fn mean(&self) -> f64 {
        (self.a + self.b) / (2.0 * self.rows)
    }

    fn variance(&self) -> f64 {
        (self.squares / (2.0 * self.rows) - self.mean() * self.mean()).max(0.0)
    }

    /// Saltelli et al. (2010): S_i = E\[f(b) (f(s_i) - f(a))\] / V, with f less its mean.
    fn first(&self, i: usize) -> f64 {
        let [product, difference] = self.first[i];
        (product - self.mean() * difference) / self.rows / self.variance()
    }

    /// Jansen (1999): T_i = E\[(f(a) - f(t_i))²\] / (2 V).
    fn total(&self, i: usize) -> f64 {
        self.total[i] / (2.0 * self.rows) / self.variance()
    }

    /// Saltelli (2002): S_ij = (cov(f(ab_i), f(ba_j)) - cov(f(a), f(b))) / V - S_i - S_j.
    fn second(&self, i: usize, j: usize) -> f64 {
        let Some(pairs) = &self.second else { return f64::NAN };
        let (n, m) = (self.rows, self.mean());
        let centred = |product: f64, one: f64, two: f64| product / n - m * (one + two) / n + m * m;
        let (ab, ba) = (0.5 * (pairs.ab[i] + pairs.ab[j]), 0.5 * (pairs.ba[i] + pairs.ba[j]));
        let closed = centred(pairs.products[i * self.total.len() + j], ab, ba);
        (closed - centred(self.product, self.a, self.b)) / self.variance() - self.first(i) - self.first(j)
    }
}

/// The indices of one output.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputIndices {
    /// Its mean.
    pub mean: Estimate,
    /// Its standard deviation.
    pub std_dev: Estimate,
    /// S_i = Var(E\[Y | X_i\]) / Var(Y), for each input: what would go if X_i were known.
    pub first: Vec<Estimate>,
    /// T_i = E\[Var(Y | all but X_i)\] / Var(Y), for each input: what would stay if all but X_i were known.
    pub total: Vec<Estimate>,
    /// S_ij for i < j, where asked for: what two inputs explain together beyond what each explains.
    pub second: Vec<([usize; 2], Estimate)>,
}

impl OutputIndices {
    /// From the sums of independent replicates; NaN for the indices of an output that does not vary. `shift` was taken from
    /// every output.
    pub(super) fn of(replicates: &[Sums], shift: f64) -> OutputIndices {
        let (inputs, pairs) = (replicates[0].total.len(), replicates[0].second.is_some());
        let merged = |without: Option<usize>| {
            let mut sums = Sums::new(inputs, pairs);
            let kept = replicates.iter().enumerate().filter(|(i, _)| Some(*i) != without);
            kept.for_each(|(_, other)| sums.merge(other));
            sums
        };
        let (all, without): (Sums, Vec<Sums>) =
            (merged(None), (0..replicates.len()).map(|i| merged(Some(i))).collect());
        // Rounding leaves a few ulp² of variance where nothing varies.
        let constant = all.variance() <= 1e-24 * (all.squares / all.rows + shift * shift);
        let estimate =
            |of: &dyn Fn(&Sums) -> f64| Estimate::jackknife(replicates.len(), |i| of(i.map_or(&all, |i| &without[i])));
        let index = |of: &dyn Fn(&Sums) -> f64| estimate(&|sums| if constant { f64::NAN } else { of(sums) });
        let places = (0..inputs).flat_map(|i| (i + 1..inputs).map(move |j| [i, j])).filter(|_| pairs);
        OutputIndices {
            mean: estimate(&|sums| sums.mean() + shift),
            std_dev: estimate(&|sums| if constant { 0.0 } else { sums.variance().sqrt() }),
            first: (0..inputs).map(|i| index(&|sums| sums.first(i))).collect(),
            total: (0..inputs).map(|i| index(&|sums| sums.total(i))).collect(),
            second: places.map(|[i, j]| ([i, j], index(&|sums| sums.second(i, j)))).collect(),
        }
    }

    /// What no input explains by itself: 1 - Σ S_i.
    pub fn interactions(&self) -> f64 {
        1.0 - self.first.iter().map(|s| s.value).sum::<f64>()
    }
}
