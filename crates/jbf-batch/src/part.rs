//! Work of one thread of a batch: some blocks of laws, advanced by one tile of steps at a time.
//!
//! The rows of the output that a tile writes fit into the nearest cache.

use crate::batch::Method;
use crate::lane::{Float, Lane};
use crate::speeds::{Alike, Course, Own, Speeds};
use jbf_core::internals::SideBySide;
use jbf_core::law::journal::{Journal, State};
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Stepper};
use jbf_core::Real;
use std::ops::Range;

/// Number of laws in one block: four full vector registers of AVX-512 in double precision.
///
/// Computations in one register hide the latency of those in the others.
pub(crate) const LANES: usize = 32;

/// Number of steps between two checks for a film that left its bearing.
const TILE: usize = 64;

/// Adjacent laws of a batch, their films, and their sums of squares.
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

    /// Recomputes the samples of a tile with scalar steps, one law after the other.
    ///
    /// This is necessary after a film left its bearing, because only scalar steps limit the
    /// eccentricity.
    #[cold]
    #[inline(never)]
    fn alone<S: Stepper>(
        &mut self,
        samples: Range<usize>,
        course: &impl Course<F>,
        last: usize,
        dt_s: F,
        stepper: &S,
        friction: &mut [[F; LANES]; TILE],
    ) {
        for (lane, law) in self.laws.iter().enumerate() {
            let mut film = self.lanes.film_alone::<F>(lane);
            for (i, f) in samples.clone().zip(friction.iter_mut()) {
                let from = course.at(i)(lane);
                f[lane] = law.friction(&film, from).along(from.sign());
                if i < last {
                    let u = ends(from, course.at(i + 1)(lane));
                    law.advance_with(stepper, &mut film, u, F::ONE, dt_s);
                }
            }
            self.lanes.put(lane, &film);
        }
    }
}

/// Output of the friction coefficients.
pub(crate) enum Out<'a, F> {
    /// Store them: one slice per sample, with one element per law.
    Rows(Vec<&'a mut [F]>),
    /// Sum the squared deviations from these values, one per sample.
    Squares(&'a [F]),
}

impl<F: Float> Out<'_, F> {
    /// Stores or sums the friction coefficients of one tile of a block; `place` is the index of the
    /// first law of the block.
    #[inline(always)]
    fn take(
        &mut self,
        samples: Range<usize>,
        place: usize,
        friction: &[[F; LANES]; TILE],
        sum: &mut [F; LANES],
    ) {
        match self {
            Self::Rows(rows) => {
                for (row, f) in rows[samples].iter_mut().zip(friction) {
                    let own = &mut row[place..];
                    match own.first_chunk_mut::<LANES>() {
                        Some(all) => *all = *f,
                        None => own.copy_from_slice(&f[..own.len()]),
                    }
                }
            }
            Self::Squares(data) => {
                let mut total = *sum;
                for (d, f) in data[samples].iter().zip(friction) {
                    for i in 0..LANES {
                        let r = f[i] - *d;
                        total[i] += r * r;
                    }
                }
                *sum = total;
            }
        }
    }
}

/// Advances all blocks of a part along the whole motion and outputs the friction coefficients.
#[inline(always)]
pub(crate) fn run<F: Float>(
    blocks: &mut [Block<F>],
    speeds: &Speeds<'_, F>,
    first_set: usize,
    dt_s: F,
    method: Method,
    out: &mut Out<'_, F>,
) {
    let n = speeds.len();
    match (*speeds, method) {
        (Speeds::Common(all), Method::Euler) => {
            tiles(blocks, n, |_| Alike(all), dt_s, &Euler, out);
        }
        (Speeds::Common(all), Method::Rk4) => {
            tiles(blocks, n, |_| Alike(all), dt_s, &Rk4, out);
        }
        (Speeds::Each { rows, sets }, _) => {
            let course = |place| Own {
                rows,
                sets,
                first: first_set + place,
            };
            match method {
                Method::Euler => tiles(blocks, n, course, dt_s, &Euler, out),
                Method::Rk4 => tiles(blocks, n, course, dt_s, &Rk4, out),
            }
        }
    }
}

#[inline(always)]
fn tiles<F: Float, C: Course<F>, S: Stepper>(
    blocks: &mut [Block<F>],
    samples: usize,
    course: impl Fn(usize) -> C,
    dt_s: F,
    stepper: &S,
    out: &mut Out<'_, F>,
) {
    let Some(last) = samples.checked_sub(1) else {
        return;
    };
    let mut friction = [[F::ZERO; LANES]; TILE];
    for begin in (0..samples).step_by(TILE) {
        let end = (begin + TILE).min(samples);
        for (b, block) in blocks.iter_mut().enumerate() {
            let course = course(b * LANES);
            let before = block.lanes;
            let mut lanes = before;
            for (i, f) in (begin..end.min(last)).zip(friction.iter_mut()) {
                step(&mut lanes, course.at(i), course.at(i + 1), dt_s, stepper, f);
            }
            if end > last {
                friction_of(&lanes, course.at(last), &mut friction[last - begin]);
            }
            block.lanes = lanes;
            if lanes.clamped() != before.clamped() {
                block.lanes = before;
                block.alone(begin..end, &course, last, dt_s, stepper, &mut friction);
            }
            out.take(begin..end, b * LANES, &friction, &mut block.sum);
        }
    }
}

/// Absolute surface speeds |U| at the start, middle and end of a step, interpolated linearly
/// between two samples.
#[inline(always)]
fn ends<T: Real>(from: T, to: T) -> [T; 3] {
    [from.abs(), ((from + to) * T::of(0.5)).abs(), to.abs()]
}

/// Computes the friction coefficient of every lane.
#[inline(always)]
fn friction_of<F: Float>(
    lanes: &SideBySide<Lane<F>, LANES>,
    speed: impl Fn(usize) -> F,
    friction: &mut [F; LANES],
) {
    for (i, f) in friction.iter_mut().enumerate() {
        let u = Lane(speed(i));
        let sliding = lanes.law(i).friction(&lanes.film(i), u);
        *f = sliding.along(u.sign()).0;
    }
}

/// Computes the friction coefficient of every lane, and then advances every film by one step.
///
/// One function does both because they share square roots.
#[inline(always)]
fn step<F: Float, S: Stepper>(
    lanes: &mut SideBySide<Lane<F>, LANES>,
    from: impl Fn(usize) -> F,
    to: impl Fn(usize) -> F,
    dt_s: F,
    stepper: &S,
    friction: &mut [F; LANES],
) {
    for (i, f) in friction.iter_mut().enumerate() {
        let (law, mut film) = (lanes.law(i), lanes.film(i));
        let (u0, u1) = (Lane(from(i)), Lane(to(i)));
        *f = law.friction(&film, u0).along(u0.sign()).0;
        law.advance_inline(stepper, &mut film, ends(u0, u1), Lane::ONE, Lane(dt_s));
        lanes.put(i, &film);
    }
}
