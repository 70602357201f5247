//! Plain matrices of any size, independent of the core's.

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Matrix(pub(crate) Vec<Vec<f64>>);

impl Matrix {
    pub(crate) fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        Self((0..rows).map(|i| (0..columns).map(|j| entry(i, j)).collect()).collect())
    }

    pub(crate) fn identity(n: usize) -> Self {
        Self::from_fn(n, n, |i, j| f64::from(u8::from(i == j)))
    }

    pub(crate) fn diagonal(entries: &[f64]) -> Self {
        Self::from_fn(entries.len(), entries.len(), |i, j| if i == j { entries[i] } else { 0.0 })
    }

    pub(crate) fn outer(a: &[f64], b: &[f64]) -> Self {
        Self::from_fn(a.len(), b.len(), |i, j| a[i] * b[j])
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        self.0[i][j]
    }

    pub(crate) fn rows(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn columns(&self) -> usize {
        self.0.first().map_or(0, Vec::len)
    }

    pub(crate) fn column(&self, j: usize) -> Vec<f64> {
        self.0.iter().map(|row| row[j]).collect()
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows(), self.columns(), |i, j| self.at(i, j) + other.at(i, j))
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    pub(crate) fn scaled(&self, by: f64) -> Self {
        Self::from_fn(self.rows(), self.columns(), |i, j| self.at(i, j) * by)
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.rows(), other.columns(), |i, j| {
            (0..self.columns()).map(|k| self.at(i, k) * other.at(k, j)).sum()
        })
    }

    pub(crate) fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.0.iter().map(|row| dot(row, x)).collect()
    }

    pub(crate) fn transposed(&self) -> Self {
        Self::from_fn(self.columns(), self.rows(), |i, j| self.at(j, i))
    }

    pub(crate) fn inverse(&self) -> (Self, f64) {
        let n = self.rows();
        let mut left = self.clone();
        let mut right = Self::identity(n);
        let mut determinant = 1.0;
        for j in 0..n {
            let pivot = (j..n).max_by(|&a, &b| left.at(a, j).abs().total_cmp(&left.at(b, j).abs())).unwrap();
            if pivot != j {
                left.0.swap(pivot, j);
                right.0.swap(pivot, j);
                determinant = -determinant;
            }
            let by = left.at(j, j);
            determinant *= by;
            for matrix in [&mut left, &mut right] {
                matrix.0[j].iter_mut().for_each(|x| *x /= by);
            }
            for i in (0..n).filter(|&i| i != j) {
                let share = left.at(i, j);
                for matrix in [&mut left, &mut right] {
                    let row = matrix.0[j].clone();
                    matrix.0[i].iter_mut().zip(row).for_each(|(x, y)| *x -= share * y);
                }
            }
        }
        (right, determinant)
    }

    /// The lower triangular Cholesky factor, by the textbook's formula; the column of a zero variance is zero.
    pub(crate) fn cholesky(&self) -> Self {
        let n = self.rows();
        let mut factor = Self::from_fn(n, n, |_, _| 0.0);
        for j in 0..n {
            let square = self.at(j, j) - (0..j).map(|k| factor.at(j, k) * factor.at(j, k)).sum::<f64>();
            if square <= 1e-15 * self.at(j, j) {
                continue;
            }
            for i in j..n {
                let rest = self.at(i, j) - (0..j).map(|k| factor.at(i, k) * factor.at(j, k)).sum::<f64>();
                factor.0[i][j] = rest / square.sqrt();
            }
        }
        factor
    }

    /// `exp(M)` by a Taylor series of M/8, squared three times.
    pub(crate) fn exponential(&self) -> Self {
        let small = self.scaled(1.0 / 8.0);
        let mut term = Self::identity(self.rows());
        let mut sum = term.clone();
        for n in 1..24 {
            term = term.times(&small).scaled(1.0 / f64::from(n));
            sum = sum.plus(&term);
        }
        (0..3).fold(sum, |power, _| power.times(&power))
    }

    /// `exp(A dt)` and `dt φ₁(A dt) g`: exp([A dt, g dt; 0, 0]) = [exp(A dt), dt φ₁(A dt) g; 0, 1].
    pub(crate) fn held(&self, g: &[f64], dt: f64) -> (Self, Vec<f64>) {
        let n = g.len();
        let entry = |i: usize, j: usize| if j < n { self.at(i, j) * dt } else { g[i] * dt };
        let whole = Self::from_fn(n + 1, n + 1, |i, j| if i < n { entry(i, j) } else { 0.0 }).exponential();
        (Self::from_fn(n, n, |i, j| whole.at(i, j)), whole.column(n))
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a + b s`
pub(crate) fn along(a: &[f64], b: &[f64], s: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b * s).collect()
}

#[test]
fn an_inverse_is_one_and_a_factor_squares() {
    let m = Matrix::from_fn(4, 4, |i, j| ((i * i + 1) as f64 * (j as f64 + 2.0)).sin());
    let (inverse, determinant) = m.inverse();
    let square = m.times(&m.transposed());
    let factor = square.cholesky();
    let small = |m: &Matrix| m.0.iter().flatten().all(|x| x.abs() < 1e-12);
    assert!(small(&m.times(&inverse).minus(&Matrix::identity(4))));
    assert!(small(&factor.times(&factor.transposed()).minus(&square)));
    assert!((square.inverse().1 - determinant * determinant).abs() < 1e-12);
    let (sin, cos) = 0.7_f64.sin_cos();
    let turn = Matrix(vec![vec![0.0, 0.7], vec![-0.7, 0.0]]).exponential();
    assert!(small(&turn.minus(&Matrix(vec![vec![cos, sin], vec![-sin, cos]]))));
}
