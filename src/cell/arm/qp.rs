//! Quadratic programs: least squares with linear bounds, solved by the interior-point solver Clarabel.
//!
//! Main type: [`QuadraticProgram`]. The solver is pure Rust and deterministic; no time limit is set, so that the number
//! of iterations alone ends it and the clock that it reads for its statistics decides nothing. Refuses: answers that
//! did not converge.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Most iterations of the interior-point method.
const ITERATIONS: u32 = 60;

/// A program: minimise ½ xᵀPx + qᵀx so that each bound holds.
#[derive(Clone, Debug)]
pub(super) struct QuadraticProgram {
    variables: usize,
    /// P, dense and symmetric, row by row; only the upper triangle is used.
    square: Vec<f64>,
    linear: Vec<f64>,
    /// Rows, columns and coefficients of A in Ax ≤ b.
    entries: (Vec<usize>, Vec<usize>, Vec<f64>),
    limits: Vec<f64>,
}

impl QuadraticProgram {
    /// A program without costs and bounds.
    pub fn new(variables: usize) -> QuadraticProgram {
        QuadraticProgram {
            variables,
            square: vec![0.0; variables * variables],
            linear: vec![0.0; variables],
            entries: (Vec::new(), Vec::new(), Vec::new()),
            limits: Vec::new(),
        }
    }

    /// Adds `weight` · (Σ coefficient · x − wanted)².
    pub fn cost(&mut self, weight: f64, terms: &[(usize, f64)], wanted: f64) {
        for (i, a) in terms {
            self.linear[*i] -= 2.0 * weight * a * wanted;
            for (j, b) in terms {
                self.square[i * self.variables + j] += 2.0 * weight * a * b;
            }
        }
    }

    /// Adds the bound Σ coefficient · x ≤ limit.
    pub fn at_most(&mut self, terms: &[(usize, f64)], limit: f64) {
        let row = self.limits.len();
        for (column, coefficient) in terms {
            self.entries.0.push(row);
            self.entries.1.push(*column);
            self.entries.2.push(*coefficient);
        }
        self.limits.push(limit);
    }

    /// Adds the bounds low ≤ Σ coefficient · x ≤ high.
    pub fn within(&mut self, terms: &[(usize, f64)], low: f64, high: f64) {
        self.at_most(terms, high);
        let turned: Vec<(usize, f64)> = terms.iter().map(|(i, a)| (*i, -a)).collect();
        self.at_most(&turned, -low);
    }

    /// The minimum; nothing where the solver finds none within its iterations.
    pub fn solve(self) -> Option<Vec<f64>> {
        let n = self.variables;
        let upper = (0..n).flat_map(|j| (0..=j).map(move |i| (i, j)));
        let upper: Vec<(usize, usize)> = upper.filter(|(i, j)| self.square[i * n + j] != 0.0).collect();
        let values: Vec<f64> = upper.iter().map(|(i, j)| self.square[i * n + j]).collect();
        let (rows, columns): (Vec<usize>, Vec<usize>) = upper.into_iter().unzip();
        let square = CscMatrix::new_from_triplets(n, n, rows, columns, values);
        let bounds = self.limits.len();
        let (rows, columns, values) = self.entries;
        let matrix = CscMatrix::new_from_triplets(bounds, n, rows, columns, values);
        let settings = DefaultSettings {
            verbose: false,
            max_iter: ITERATIONS,
            tol_gap_abs: 1e-6,
            tol_gap_rel: 1e-6,
            tol_feas: 1e-6,
            presolve_enable: false,
            ..DefaultSettings::default()
        };
        let cones = [SupportedConeT::NonnegativeConeT(bounds)];
        let mut solver =
            DefaultSolver::new(&square, &self.linear, &matrix, &self.limits, &cones, settings).ok()?;
        solver.solve();
        let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        (solved && solver.solution.x.iter().all(|x| x.is_finite())).then(|| solver.solution.x.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_lies_on_the_bound_that_keeps_from_the_wish() {
        let mut program = QuadraticProgram::new(2);
        program.cost(1.0, &[(0, 1.0)], 3.0);
        program.cost(1.0, &[(1, 1.0)], 1.0);
        program.at_most(&[(0, 1.0), (1, 1.0)], 2.0);
        program.within(&[(1, 1.0)], 0.5, 5.0);
        let x = program.solve().expect("it has a minimum");
        assert!((x[0] - 1.5).abs() < 1e-4 && (x[1] - 0.5).abs() < 1e-4, "{x:?}");
    }

    #[test]
    fn what_contradicts_itself_has_no_minimum() {
        let mut program = QuadraticProgram::new(1);
        program.cost(1.0, &[(0, 1.0)], 0.0);
        program.within(&[(0, 1.0)], 2.0, 1.0);
        assert_eq!(program.solve(), None);
    }
}
