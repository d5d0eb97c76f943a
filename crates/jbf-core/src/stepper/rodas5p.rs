//! Rodas5P, a Rosenbrock method of order five (Steinebach, BIT Numerical Mathematics 63:27, 2023).
//!
//! The method is L-stable and stiffly accurate, with an embedded method of order four, for stiff
//! and differential-algebraic systems.
//!
//! The unknowns are those that need no product with the Jacobian (Hairer & Wanner, Solving Ordinary
//! Differential Equations II, IV.7):
//!
//! ```text
//! (1/(gamma h) - J) u_i = f(t + c_i h, y + sum_j a_ij u_j) + sum_j (C_ij / h) u_j + d_i h f_t
//! ```

use super::rodas5p_tableau::{A, C, D, GAMMA, H, NODES};
use super::stiff::{Linear, ShiftedSolver, StiffStepper, StiffSystem};
use crate::real::Real;
use nalgebra::{ArrayStorage, SVector};

/// Input of a system along a step, as required by the stages of the method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input<T> {
    /// Value of the input at the fractions [`NODES`] of the step.
    pub at_nodes: [T; 4],
    /// Value of the input at the end of the step.
    pub at_end: T,
    /// Time derivative of the input at the start of the step, multiplied by the length of the step.
    pub change: T,
}

/// Result of one step: the unknowns of all stages and the state at the end.
#[derive(Clone, Copy, Debug)]
pub struct Stages<T, const N: usize> {
    pub(crate) unknowns: [SVector<T, N>; 8],
    /// State at the end of the step.
    pub end: SVector<T, N>,
}

impl<const N: usize> Stages<f64, N> {
    /// Placeholder with zeros.
    pub(crate) const NONE: Self = Self {
        unknowns: [SVector::from_array_storage(ArrayStorage([[0.0; N]])); 8],
        end: SVector::from_array_storage(ArrayStorage([[0.0; N]])),
    };
}

impl<T: Real, const N: usize> Stages<T, N> {
    /// Returns the estimated error of the state at the end of the step.
    #[inline]
    pub(crate) fn error(&self) -> &SVector<T, N> {
        &self.unknowns[7]
    }

    /// Returns the polynomial of order four for state `n` along the step.
    ///
    /// The coefficients are those of 1, s, .., s^4, where s goes from zero to one. (The Hermite
    /// polynomial from first and second derivatives is more accurate if the film is not stiff. It
    /// is much less accurate for a stiff film, because the derivatives amplify the error of the
    /// state.)
    #[inline]
    pub(crate) fn quartic(&self, start: &SVector<T, N>, n: usize) -> [T; 5] {
        let row = |r: usize| {
            let mut sum = T::ZERO;
            for (unknown, &h) in self.unknowns.iter().zip(&H[r]) {
                sum += unknown[n] * T::of(h);
            }
            sum
        };
        let (p, q, r) = (row(0), row(1), row(2));
        [start[n], self.end[n] - start[n] + p, q - p, r - q, -r]
    }
}

/// Computes `sum_j row_j u_j` over the first `K` unknowns; `K` is a constant so that the sum has no
/// loop.
#[inline(always)]
fn combined<T: Real, const N: usize, const K: usize>(
    row: &[f64],
    unknowns: &[SVector<T, N>; 8],
) -> SVector<T, N> {
    let mut sum = unknowns[0] * T::of(row[0]);
    for j in 1..K {
        sum += unknowns[j] * T::of(row[j]);
    }
    sum
}

/// Computes one step of a system that is already linearised at `state`.
#[inline(always)]
pub(crate) fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
    system: &S,
    linear: &Linear<T, N>,
    state: &SVector<T, N>,
    input: &Input<T>,
    dt: T,
) -> Stages<T, N> {
    let inverse_dt = T::ONE / dt;
    let solver = S::Solver::new(&linear.jacobian, inverse_dt * T::of(1.0 / GAMMA));
    // f_t h, of which each stage takes a share.
    let drift = linear.by_input * input.change;
    let mut u = [SVector::zeros(); 8];
    u[0] = solver.solve(&(linear.slope + drift * T::of(D[0])));
    let mut at: SVector<T, N>;
    // Written out stage by stage: a loop takes a third longer.
    macro_rules! stage {
        ($k:literal, $input:expr, $at:expr, $share:expr) => {
            at = $at;
            let slope = system.slope(&at, $input);
            let share = $share.map_or(SVector::zeros(), |d: f64| drift * T::of(d));
            let sum = combined::<T, N, $k>(&C[$k - 1], &u);
            u[$k] = solver.solve(&(slope + sum * inverse_dt + share));
        };
    }
    macro_rules! early {
        ($k:literal) => {
            stage!(
                $k,
                input.at_nodes[$k - 1],
                *state + combined::<T, N, $k>(&A[$k - 1], &u),
                Some(D[$k])
            )
        };
    }
    macro_rules! late {
        ($k:literal) => {
            stage!($k, input.at_end, at + u[$k - 1], None::<f64>)
        };
    }
    early!(1);
    early!(2);
    early!(3);
    early!(4);
    stage!(
        5,
        input.at_end,
        *state + combined::<T, N, 5>(&A[4], &u),
        None::<f64>
    );
    late!(6);
    late!(7);
    Stages {
        unknowns: u,
        end: at + u[7],
    }
}

/// L-stable Rosenbrock method Rodas5P of order five.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rodas5P;

impl StiffStepper for Rodas5P {
    #[inline]
    fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut SVector<T, N>,
        [start, middle, end]: [T; 3],
        dt: T,
    ) {
        // Three values define a parabola.
        let change = T::of(4.0) * middle - T::of(3.0) * start - end;
        let bend = (start + end - T::of(2.0) * middle) * T::of(2.0);
        let input = Input {
            at_nodes: NODES.map(|c| start + T::of(c) * (change + T::of(c) * bend)),
            at_end: end,
            change,
        };
        let linear = system.linearise(state, start);
        *state = self::step(system, &linear, state, &input, dt).end;
    }
}
