//! Parallel integration of a film without inertia along several excitations.
//!
//! Steps with error control differ in length and number, but consist of the same operations. The
//! next steps of several trajectories are computed in the lanes of vector registers, and each
//! trajectory then continues separately.
//!
//! The square roots and divisions of several films overlap in time, while those of one film depend
//! on each other. The result is identical bit for bit to that of [`super::follow`].

use super::follow::Way;
use super::stretch::Stretch;
use super::trial::Asked;
use super::{Cost, Excitation, Sample, Start};
use crate::error::Error;
use crate::law::journal::film_linear::SmoothFilm;
use crate::law::journal::Journal;
use crate::real::Real;
use crate::stepper::rodas5p::{self, Input, Stages};
use crate::stepper::Linear;
use nalgebra::{Matrix2, Vector2};

type Step = Asked<f64, SmoothFilm<f64>, 2>;

/// Input and output of one trajectory: excitation, sample times, and receiver of the samples.
pub struct Along<'a, E, S> {
    /// Imposed surface speed.
    pub excitation: &'a E,
    /// Sample times, s, ascending.
    pub times_s: &'a [f64],
    /// Receiver, called with each sample and its index.
    pub sink: S,
}

/// Integrates `film` along at most `K` excitations from one start, each as [`super::follow`] does.
///
/// `lanes` computes the next step of each trajectory, as [`step`] does.
///
/// # Errors
/// As [`super::trajectory`], for the first excitation that violates a rule.
pub fn follow_side_by_side<E: Excitation, S: FnMut(usize, &Sample<f64>), const K: usize>(
    film: &Journal<f64>,
    along: [Option<Along<'_, E, S>>; K],
    start: &Start<f64>,
    tolerance: f64,
    mut lanes: impl FnMut(&[Step; K], &mut [Stages<f64, 2>; K]),
) -> Result<[Cost; K], Error> {
    let mut refused = None;
    let mut ways = along.map(|a| {
        let a = a?;
        Way::from_start(film, a.excitation, start, a.times_s, tolerance, a.sink)
            .map_err(|error| {
                refused.get_or_insert(error);
            })
            .ok()
    });
    if let Some(error) = refused {
        return Err(error);
    }
    let mut stretches: [Option<Stretch<f64, SmoothFilm<f64>, 2>>; K] = [const { None }; K];
    let mut steps = [Step::NONE; K];
    let mut stages = [Stages::NONE; K];
    loop {
        let mut on = [false; K];
        for i in 0..K {
            if let Some(way) = &mut ways[i] {
                on[i] = next(way, &mut stretches[i], &mut steps[i]);
            }
        }
        if on == [false; K] {
            break;
        }
        // A finished trajectory repeats its last step.
        lanes(&steps, &mut stages);
        for i in 0..K {
            if let (true, Some(way), Some(stretch)) = (on[i], &mut ways[i], &mut stretches[i]) {
                way.answer(stretch, &steps[i], &stages[i]);
            }
        }
    }
    Ok(ways.map(|way| way.map_or(Cost::default(), |way| way.cost)))
}

/// Prepares the next step of a trajectory, and begins the next segment if one has ended.
///
/// Returns false at the last sample.
#[inline]
fn next<E: Excitation, S: FnMut(usize, &Sample<f64>)>(
    way: &mut Way<'_, f64, Journal<f64>, E, S, 2>,
    stretch: &mut Option<Stretch<f64, SmoothFilm<f64>, 2>>,
    step: &mut Step,
) -> bool {
    loop {
        if let Some(on) = stretch {
            if way.time_s < on.end_s {
                *step = way.ask(on);
                return true;
            }
            way.time_s = on.end_s;
            *stretch = None;
        }
        if way.done() {
            return false;
        }
        *stretch = Some(way.begin());
    }
}

impl Step {
    /// Placeholder for a lane without a trajectory; its values stay finite.
    const NONE: Self = Self {
        system: SmoothFilm::NONE,
        linear: Linear {
            slope: Vector2::new(0.0, 0.0),
            jacobian: Matrix2::new(0.0, 0.0, 0.0, 0.0),
            by_input: Vector2::new(0.0, 0.0),
        },
        state: Vector2::new(0.5, 0.0),
        input: Input {
            at_nodes: [0.0; 4],
            at_end: 0.0,
            change: 0.0,
        },
        dt: 1.0,
        step_s: 1.0,
        to_s: 1.0,
        speed_m_s: 0.0,
    };
}

/// Computes one step of `K` trajectories, stored as one array per variable.
///
/// The compiler can then place adjacent trajectories in the lanes of one register. `T` is meant to
/// be a lane ([`Real::SIDE_BY_SIDE`]).
#[inline(always)]
pub fn step<T: Real, const K: usize>(steps: &[Step; K], out: &mut [Stages<f64, 2>; K]) {
    let of = |pick: fn(&Step) -> f64| -> [f64; K] { core::array::from_fn(|i| pick(&steps[i])) };
    let system = [
        of(|s| s.system.parts()[0]),
        of(|s| s.system.parts()[1]),
        of(|s| s.system.parts()[2]),
    ];
    let slope = [of(|s| s.linear.slope[0]), of(|s| s.linear.slope[1])];
    let jacobian = [
        of(|s| s.linear.jacobian.m11),
        of(|s| s.linear.jacobian.m12),
        of(|s| s.linear.jacobian.m21),
        of(|s| s.linear.jacobian.m22),
    ];
    let by_input = [of(|s| s.linear.by_input[0]), of(|s| s.linear.by_input[1])];
    let state = [of(|s| s.state[0]), of(|s| s.state[1])];
    let at_nodes = [
        of(|s| s.input.at_nodes[0]),
        of(|s| s.input.at_nodes[1]),
        of(|s| s.input.at_nodes[2]),
        of(|s| s.input.at_nodes[3]),
    ];
    let (at_end, change, dt) = (of(|s| s.input.at_end), of(|s| s.input.change), of(|s| s.dt));
    let mut unknowns = [[[0.0; K]; 2]; 8];
    let mut end = [[0.0; K]; 2];
    for i in 0..K {
        let t = |column: &[f64; K]| T::of(column[i]);
        let done = rodas5p::step(
            &SmoothFilm::of_parts([t(&system[0]), t(&system[1]), t(&system[2])]),
            &Linear {
                slope: Vector2::new(t(&slope[0]), t(&slope[1])),
                jacobian: Matrix2::new(
                    t(&jacobian[0]),
                    t(&jacobian[1]),
                    t(&jacobian[2]),
                    t(&jacobian[3]),
                ),
                by_input: Vector2::new(t(&by_input[0]), t(&by_input[1])),
            },
            &Vector2::new(t(&state[0]), t(&state[1])),
            &Input {
                at_nodes: [
                    t(&at_nodes[0]),
                    t(&at_nodes[1]),
                    t(&at_nodes[2]),
                    t(&at_nodes[3]),
                ],
                at_end: t(&at_end),
                change: t(&change),
            },
            t(&dt),
        );
        for (column, unknown) in unknowns.iter_mut().zip(&done.unknowns) {
            column[0][i] = unknown[0].value();
            column[1][i] = unknown[1].value();
        }
        end[0][i] = done.end[0].value();
        end[1][i] = done.end[1].value();
    }
    for (i, stages) in out.iter_mut().enumerate() {
        for (to, from) in stages.unknowns.iter_mut().zip(&unknowns) {
            *to = Vector2::new(from[0][i], from[1][i]);
        }
        stages.end = Vector2::new(end[0][i], end[1][i]);
    }
}
