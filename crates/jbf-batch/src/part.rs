//! What one thread steps: some blocks of lanes, a tile of steps at a time, so that the rows that
//! are written stay in the nearest cache.

use crate::batch::{Method, Speeds};
use crate::lane::{Float, Lane};
use jbf_core::law::journal::{Journal, SideBySide, State};
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Stepper};
use jbf_core::Real;

/// Sets in one block: enough for two full registers of AVX-512 in double precision, so that one
/// hides the other's latency.
pub(crate) const LANES: usize = 16;

/// Steps between two looks at the clamps.
const TILE: usize = 64;

/// Neighbouring sets and their films.
pub(crate) struct Block<F> {
    laws: [Journal<F>; LANES],
    lanes: SideBySide<Lane<F>, LANES>,
    sum: [F; LANES],
}

impl<F: Float> Block<F> {
    pub(crate) fn new(laws: [Journal<F>; LANES], films: &[State<F>; LANES]) -> Self {
        Self {
            lanes: SideBySide::new(&laws, films),
            laws,
            sum: [F::ZERO; LANES],
        }
    }

    pub(crate) fn sums(&self) -> [F; LANES] {
        self.sum
    }

    pub(crate) fn film(&self, lane: usize) -> State<F> {
        self.lanes.film_alone(lane)
    }
}

/// Where the friction goes.
pub(crate) enum Out<'a, F> {
    /// One slice a sample, one place a set.
    Rows(Vec<&'a mut [F]>),
    /// Sum of squared distances from these, one a sample.
    Squares(&'a [F]),
}

/// All blocks of a part along the whole motion.
#[inline(always)]
pub(crate) fn run<F: Float>(
    blocks: &mut [Block<F>],
    speeds: &Speeds<'_, F>,
    first_set: usize,
    dt_s: F,
    method: Method,
    out: &mut Out<'_, F>,
) {
    match method {
        Method::Euler => tiles(blocks, speeds, first_set, dt_s, &Euler, out),
        Method::Rk4 => tiles(blocks, speeds, first_set, dt_s, &Rk4, out),
    }
}

#[inline(always)]
fn tiles<F: Float, S: Stepper>(
    blocks: &mut [Block<F>],
    speeds: &Speeds<'_, F>,
    first_set: usize,
    dt_s: F,
    stepper: &S,
    out: &mut Out<'_, F>,
) {
    let n = speeds.len();
    let mut friction = [[F::ZERO; LANES]; TILE];
    let mut begin = 0;
    while begin < n {
        let end = (begin + TILE).min(n);
        for (b, block) in blocks.iter_mut().enumerate() {
            let set = first_set + b * LANES;
            let speed = |i: usize| speeds.at(i.min(n - 1), set);
            let before = block.lanes;
            let mut lanes = before;
            let mut from = speed(begin);
            for (i, f) in (begin..end).zip(friction.iter_mut()) {
                let to = speed(i + 1);
                side_by_side(&mut lanes, &from, &to, dt_s, stepper, i + 1 < n, f);
                from = to;
            }
            block.lanes = lanes;
            if lanes.clamped() != before.clamped() {
                block.lanes = before;
                for lane in 0..LANES {
                    let mut film = before.film_alone::<F>(lane);
                    for (i, f) in (begin..end).zip(friction.iter_mut()) {
                        let (from, to) = (speed(i)[lane], speed(i + 1)[lane]);
                        let law = &block.laws[lane];
                        f[lane] = law.friction(&film, from).coefficient(from.sign());
                        if i + 1 < n {
                            let u = ends(from, to);
                            law.advance_with(stepper, &mut film, u, F::ONE, dt_s);
                        }
                    }
                    block.lanes.put(lane, &film);
                }
            }
            let place = b * LANES;
            match out {
                Out::Rows(rows) => {
                    for (row, f) in rows[begin..end].iter_mut().zip(&friction) {
                        let width = LANES.min(row.len() - place);
                        row[place..place + width].copy_from_slice(&f[..width]);
                    }
                }
                Out::Squares(data) => {
                    let mut sum = block.sum;
                    for (d, f) in data[begin..end].iter().zip(&friction) {
                        for (s, f) in sum.iter_mut().zip(f) {
                            let r = *f - *d;
                            *s += r * r;
                        }
                    }
                    block.sum = sum;
                }
            }
        }
        begin = end;
    }
}

/// |U| at the start, middle and end of a step: straight lines between samples.
#[inline(always)]
fn ends<T: Real>(from: T, to: T) -> [T; 3] {
    [from.abs(), ((from + to) * T::of(0.5)).abs(), to.abs()]
}

/// Friction of every lane now, then one step.
#[inline(always)]
fn side_by_side<F: Float, S: Stepper>(
    lanes: &mut SideBySide<Lane<F>, LANES>,
    from: &[F; LANES],
    to: &[F; LANES],
    dt_s: F,
    stepper: &S,
    step: bool,
    friction: &mut [F; LANES],
) {
    for i in 0..LANES {
        let (law, mut film) = (lanes.law(i), lanes.film(i));
        let (u0, u1) = (Lane(from[i]), Lane(to[i]));
        friction[i] = law.friction(&film, u0).coefficient(u0.sign()).0;
        if step {
            law.advance_with(stepper, &mut film, ends(u0, u1), Lane::ONE, Lane(dt_s));
        }
        lanes.put(i, &film);
    }
}
