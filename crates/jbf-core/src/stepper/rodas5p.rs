//! Rodas5P (Steinebach, BIT Numerical Mathematics 63:27, 2023): a Rosenbrock method of order
//! five, L-stable and stiffly accurate, with an embedded method of order four, made for stiff
//! and differential-algebraic systems.
//!
//! Written in the unknowns that need no product with the Jacobian (Hairer & Wanner, Solving
//! Ordinary Differential Equations II, IV.7):
//!
//! ```text
//! (1/(gamma h) - J) u_i = f(t + c_i h, y + sum_j a_ij u_j) + sum_j (C_ij / h) u_j + d_i h f_t
//! ```

use super::stiff::{Linear, ShiftedSolver, StiffStepper, StiffSystem};
use crate::real::Real;

const GAMMA: f64 = 0.21193756319429014;

/// `a_ij` of stages two to six; stages seven and eight and the end each add the unknown before.
const A: [[f64; 5]; 5] = [
    [3.0, 0.0, 0.0, 0.0, 0.0],
    [2.849394379747939, 0.45842242204463923, 0.0, 0.0, 0.0],
    [
        -6.954028509809101,
        2.489845061869568,
        -10.358996098473584,
        0.0,
        0.0,
    ],
    [
        2.8029986275628964,
        0.5072464736228206,
        -0.3988312541770524,
        -0.04721187230404641,
        0.0,
    ],
    [
        -7.502846399306121,
        2.561846144803919,
        -11.627539656261098,
        -0.18268767659942256,
        0.030198172008377946,
    ],
];

/// `C_ij` of stages two to eight.
const C: [[f64; 7]; 7] = [
    [-14.155112264123755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [
        -17.97296035885952,
        -2.859693295451294,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        147.12150275711716,
        -1.41221402718213,
        71.68940251302358,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        165.43517024871676,
        -0.4592823456491126,
        42.90938336958603,
        -5.961986721573306,
        0.0,
        0.0,
        0.0,
    ],
    [
        24.854864614690072,
        -3.0009227002832186,
        47.4931110020768,
        5.5814197821558125,
        -0.6610691825249471,
        0.0,
        0.0,
    ],
    [
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
        0.0,
    ],
    [
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ],
];

/// Where stages two to five look at the input; the others look at the end of the step.
pub(crate) const NODES: [f64; 4] = [
    0.6358126895828704,
    0.4095798393397535,
    0.9769306725060716,
    0.4288403609558664,
];

/// `d_i` of stages one to five.
const D: [f64; 5] = [
    GAMMA,
    -0.42387512638858027,
    -0.3384627126235924,
    1.8046452872882734,
    2.325825639765069,
];

/// Continuous output of order four.
const H: [[f64; 8]; 3] = [
    [
        25.948786856663858,
        -2.5579724845846235,
        10.433815404888879,
        -2.3679251022685204,
        0.524948541321073,
        1.1241088310450404,
        0.4272876194431874,
        -0.17202221070155493,
    ],
    [
        -9.91568850695171,
        -0.9689944594115154,
        3.0438037242978453,
        -24.495224566215796,
        20.176138334709044,
        15.98066361424651,
        -6.789040303419874,
        -6.710236069923372,
    ],
    [
        11.419903575922262,
        2.8879645146136994,
        72.92137995996029,
        80.12511834622643,
        -52.072871366152654,
        -59.78993625266729,
        -0.15582684282751913,
        4.883087185713722,
    ],
];

/// The input along a step, as the stages need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input<T> {
    /// Its value at [`NODES`].
    pub at_nodes: [T; 4],
    /// Its value at the end of the step.
    pub at_end: T,
    /// Its rate at the start of the step, times the length of the step.
    pub change: T,
}

/// What one step computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stages<T, const N: usize> {
    unknowns: [[T; N]; 8],
    /// The state at the end.
    pub end: [T; N],
}

impl<T: Real, const N: usize> Stages<T, N> {
    /// Estimate of the error of the end.
    #[inline]
    pub fn error(&self) -> &[T; N] {
        &self.unknowns[7]
    }

    /// Component `n` along the step, of order four: coefficients of 1, s, .., s^4, where s goes
    /// from zero to one. (Hermite's polynomial through slopes and curvatures is finer where the film is not stiff,
    /// and much coarser where it is: there they magnify the error of the state.)
    #[inline]
    pub fn quartic(&self, start: &[T; N], n: usize) -> [T; 5] {
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

/// One step from a system already linearised at `state`.
#[inline]
pub(crate) fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
    system: &S,
    linear: &Linear<T, N>,
    state: &[T; N],
    input: &Input<T>,
    dt: T,
) -> Stages<T, N> {
    let inverse_dt = T::ONE / dt;
    let solver = S::Solver::new(&linear.jacobian, inverse_dt * T::of(1.0 / GAMMA));
    let mut u = [[T::ZERO; N]; 8];
    u[0] = solver.solve(&core::array::from_fn(|i| {
        linear.slope[i] + T::of(D[0]) * input.change * linear.by_input[i]
    }));
    let mut at = *state;
    for stage in 1..8 {
        if stage < 6 {
            at = *state;
            for j in 0..stage {
                for i in 0..N {
                    at[i] += T::of(A[stage - 1][j]) * u[j][i];
                }
            }
        } else {
            for i in 0..N {
                at[i] += u[stage - 1][i];
            }
        }
        let seen = if stage < 5 {
            input.at_nodes[stage - 1]
        } else {
            input.at_end
        };
        let mut right = system.slope(&at, seen);
        for i in 0..N {
            let mut sum = T::ZERO;
            for j in 0..stage {
                sum += T::of(C[stage - 1][j]) * u[j][i];
            }
            right[i] += sum * inverse_dt;
            if stage < 5 {
                right[i] += T::of(D[stage]) * input.change * linear.by_input[i];
            }
        }
        u[stage] = solver.solve(&right);
    }
    Stages {
        unknowns: u,
        end: core::array::from_fn(|i| at[i] + u[7][i]),
    }
}

/// L-stable Rosenbrock method of order five.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rodas5P;

impl StiffStepper for Rodas5P {
    #[inline]
    fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut [T; N],
        [start, middle, end]: [T; 3],
        dt: T,
    ) {
        // Three values make a parabola.
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
