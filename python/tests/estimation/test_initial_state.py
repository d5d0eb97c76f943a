"""Initial-state transients of films, contacts and play: which samples are excluded.

Predictions that begin in different states differ until the initial state has no influence.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.initial_state import REMEMBERED, Memory, memories, remembering
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.run_start import settled_again, settled_campaign, unsettled
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.models.chain import core_motion

NOISE_N = 0.05
SLOW, FAST = (1e-3, 6.0), (1.0, 6.0)
"""Motion before a record: a share of the top speed, and its duration in seconds."""
DRY_N, VISCOUS_N_S_M, HALF_WIDTH_N, PLAY_NOISE_N = 5.0, 40.0, 0.6, 0.1
PLAY = ("sensor_hysteresis",)


def journal_run(name: str, rest_s: float | None) -> Run:
    """A shaft that moves from the first sample on (None), or starts after a rest."""
    t = np.arange(0.0, 15.0 + (rest_s or 0.0), 0.02)
    if rest_s is None:
        v = 0.06 + 0.05 * np.sin(0.7 * t + 0.5)
    else:
        v = np.where(t < rest_s, 0.0, 0.06 * np.sin(0.5 * (t - rest_s)))
    return Run.from_arrays(t, v, np.ones(len(t)), name=name)


def journal_problem(*runs: Run) -> tuple[Problem, Array]:
    """The bearing's law along some motions, and its parameters."""
    prepared = [Prepared.of(Rig.thesis(), run) for run in runs]
    campaign = Campaign(Rig.thesis(), tuple(prepared), Samples.of(prepared))
    problem = Problem(campaign, "journal", "journal", ())
    return problem, problem.starts({})[0]


def after(run: Run, before: tuple[float, float] | None, seed: int = 0) -> Run:
    """The friction of the bearing after another motion (None: after the model's own start)."""
    problem, values = journal_problem(run)
    p = problem.campaign.prepared[0]
    motion = p.core if before is None else core_motion(p.rig, p.run, p.motion, before)
    (force,) = problem.chain.predict(values, [motion])
    noise = NOISE_N * np.random.default_rng(seed).standard_normal(len(run))
    return replace(run, friction_n=force + noise)


def masks(*runs: Run, noise_n: float = NOISE_N) -> list[Array]:
    """Excluded samples of each run, for motions of the bearing."""
    problem, values = journal_problem(*runs)
    return [np.asarray(m) for m in unsettled(problem, values, noise_n)]


@cache
def two_starts() -> Campaign:
    """A run after slow and one after fast motion, without the transient of the law's film."""
    runs = [after(journal_run("a", None), SLOW, 0), after(journal_run("b", 2.0), FAST, 1)]
    return settled_campaign(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")


# ---- memory --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "names", "directions"),
    [
        ("coulomb", (), []),
        ("journal", (), [False]),
        ("journal", ("sensor_offset",), [False]),
        ("lugre", (), [True]),
        ("coulomb", PLAY, [True]),
        ("journal", PLAY, [True]),
    ],
)
def test_models_with_a_film_contact_or_play_have_a_memory_of_the_initial_state(
    law: str, names: tuple[str, ...], directions: list[bool]
) -> None:
    """A contact or a load cell remembers the direction of motion, a film only its speed."""
    found = memories(law, names)
    assert [min(memory.speeds) < 0.0 for memory in found] == directions
    assert all(memory.longer > 1.0 for memory in found)


@pytest.mark.parametrize("longer", [1.0, 1.5])
def test_interval_in_which_initial_states_matter_is_excluded_and_extended_by_a_factor(
    longer: float,
) -> None:
    """From the first sample that differs by a fifth of the noise, times a factor in duration."""
    problem, values = journal_problem(journal_run("a", 2.0))
    (p,) = problem.campaign.prepared
    memory = Memory((1e-3, 0.1, 1.0), longer, 0.5)
    starts = [core_motion(p.rig, p.run, p.motion, (s, 6.0)) for s in memory.speeds]
    forces = [problem.chain.predict(values, [motion])[0] for motion in starts]
    apart = np.flatnonzero(np.ptp(np.array(forces), axis=0) > REMEMBERED * NOISE_N)
    t = p.run.time_s
    until = t[apart[0]] + longer * (t[apart[-1]] - t[apart[0]])
    (found,) = remembering(problem.chain, values, [p], memory, NOISE_N)
    np.testing.assert_array_equal(found, (t >= t[apart[0]]) & (t <= until))


# ---- films ---------------------------------------------------------------------------------------


def test_start_in_motion_is_excluded_until_the_film_does_not_depend_on_it() -> None:
    run = journal_run("moving", None)
    (mask,) = masks(run)
    assert mask[0]
    assert 0.1 < run.time_s[mask][-1] < 3.0
    assert np.count_nonzero(np.diff(mask.astype(int))) == 1
    # The same holds after a motion at half of the top speed.
    slow, half = (after(run, before).friction_n for before in (SLOW, (0.5, 6.0)))
    apart = np.abs(np.asarray(slow) - np.asarray(half))
    assert apart[mask].max() > 10.0 * NOISE_N
    assert apart[~mask].max() <= REMEMBERED * NOISE_N
    # A run that is too short for the transient to end is not excluded.
    assert not masks(run.select(run.time_s < 0.5))[0].any()
    counts = [int(masks(run, noise_n=noise_n)[0].sum()) for noise_n in (0.01, 0.1, 1.0)]
    assert counts[0] > counts[1] > counts[2] > 0


def test_rest_is_not_excluded_and_a_longer_rest_shortens_the_transient() -> None:
    short, longer, longest = (journal_run(f"after {s} s", s) for s in (2.0, 30.0, 120.0))
    found = masks(short, longer, longest)
    assert short.time_s[found[0]][0] == pytest.approx(2.0, abs=0.05)
    assert 0 < np.sum(found[1]) < np.sum(found[0])
    assert not found[2].any()


def test_fit_is_biased_by_the_initial_transient_unless_it_is_excluded() -> None:
    runs = [after(journal_run("a", None), SLOW, 0), after(journal_run("b", 2.0), FAST, 1)]
    runs.append(after(journal_run("c", 30.0), FAST, 2))
    campaign = Campaign.prepare(Rig.thesis(), runs)
    settled = settled_campaign(campaign, "journal", "journal")
    assert settled.samples.count < campaign.samples.count
    (found,) = (f for f in settled.more_findings if f.run == "a")
    assert (found.kind, found.done, found.unit) == ("unsettled_start", "set aside", "s")
    gone = campaign.samples.counted[0] & ~settled.samples.counted[0]
    assert found.size == pytest.approx(np.ptp(runs[0].time_s[gone]), abs=0.03)
    errors = []
    for each in (settled, campaign):
        problem = Problem(each, "journal", "journal", ())
        solution = minimum(problem, [{}])
        relative = solution.values / problem.starts({})[0] - 1.0
        # K0 is hardly determined.
        errors.append(float(np.abs(np.delete(relative, problem.names.index("K0"))).max()))
        if each is settled:
            assert solution.rms_n == pytest.approx(NOISE_N, rel=0.1)
    assert errors[0] < 0.02
    assert errors[1] > 3.0 * errors[0]


def test_transient_that_agrees_with_the_model_is_excluded_without_a_finding() -> None:
    """The record cannot show this; a finding requires residuals twice as large as usual."""
    runs = [after(journal_run("a", None), None, 0), after(journal_run("b", 2.0), None, 1)]
    settled = settled_campaign(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")
    assert settled.more_findings == ()
    assert settled.samples.count < sum(len(r) for r in runs)


def with_memory(campaign: Campaign, factor: float) -> tuple[Problem, Solution]:
    """A model whose film responds at a multiple of the usual rate, at its starting values."""
    problem = Problem(campaign, "journal", "journal", ("film_memory",))
    values = problem.starts({"film_memory.factor": factor})[0]
    return problem, problem.solution(values, campaign.samples, WHITE)


def test_slower_film_excludes_further_samples_that_follow_those_already_excluded() -> None:
    campaign = two_starts()
    again = settled_again(*with_memory(campaign, 0.3))
    assert again is not None
    for before, now in zip(campaign.samples.counted, again.samples.counted, strict=True):
        gone = np.flatnonzero(before & ~now)
        assert len(gone) > 20
        assert not before[gone[0] - 1]
        assert not now[gone[0] : gone[-1]].any()
        assert not (now & ~before).any()
    assert settled_again(*with_memory(again, 0.3)) is None


def test_no_further_samples_are_excluded_for_a_film_as_fast_as_that_of_the_law() -> None:
    campaign = two_starts()
    assert settled_again(*with_memory(campaign, 1.0)) is None
    for names in ((), ("sensor_offset",)):
        problem = Problem(campaign, "journal", "journal", names)
        solution = problem.solution(problem.starts({})[0], campaign.samples, WHITE)
        assert settled_again(problem, solution) is None


def test_no_samples_are_excluded_for_a_law_without_a_state() -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    assert settled_campaign(campaign, "coulomb", "journal") is campaign
    problem = Problem(campaign, "coulomb", "journal", ())
    assert not any(m.any() for m in unsettled(problem, problem.starts({})[0], 0.1))


# ---- play of a load cell -------------------------------------------------------------------------


def reading_with_play(force_n: Array, start_n: float) -> Array:
    """Reading of a cell with play: it stays within half of the width of the force."""
    reading = np.empty_like(force_n)
    for i, force in enumerate(force_n.tolist()):
        start_n = min(max(start_n, force - HALF_WIDTH_N), force + HALF_WIDTH_N)
        reading[i] = start_n
    return reading


def play_run(name: str, rate: float, way: float, branch: float, seed: int) -> Run:
    """Eight seconds at a constant force, then (with a rate) a force that rises and falls."""
    t = np.arange(0.0, 60.0, 0.02)
    v = way * (0.08 - 0.06 * np.cos(rate * np.maximum(t - 8.0, 0.0)))
    path = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    force = DRY_N * np.sign(v) + VISCOUS_N_S_M * v
    reading = reading_with_play(force, float(force[0]) - branch * HALF_WIDTH_N)
    noise = PLAY_NOISE_N * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, reading + noise, position_m=path, name=name)


def play_runs(branch: float) -> list[Run]:
    """Two runs in each direction."""
    plan = enumerate(((0.4, 1.0), (0.5, -1.0), (0.45, 1.0), (0.55, -1.0)))
    return [play_run(f"run {k}", rate, way, branch * way, k) for k, (rate, way) in plan]


def play_problem(runs: list[Run]) -> tuple[Problem, Array]:
    """A model with play, and the true parameters."""
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", PLAY)
    truth = {
        "F_c_n": DRY_N,
        "F_s_n": DRY_N,
        "F_v_n_s_m": VISCOUS_N_S_M,
        "sensor_hysteresis.w_n": HALF_WIDTH_N,
    }
    return problem, np.array([truth[name] for name in problem.names])


def settled_play(runs: list[Run]) -> tuple[Problem, Array, Campaign | None]:
    """The campaign without the initial transient of a model with play."""
    problem, truth = play_problem(runs)
    solution = problem.solution(truth, problem.campaign.samples, WHITE)
    return problem, truth, settled_again(problem, solution)


@pytest.mark.parametrize("branch", [-1.0, 1.0], ids=["fallen", "risen"])
def test_start_within_the_play_is_excluded_until_the_force_has_reversed(branch: float) -> None:
    problem, truth, settled = settled_play(play_runs(branch))
    assert settled is not None
    residuals, every = problem.residuals(truth), problem.campaign.samples.counted
    for p, kept, whole, residual in zip(
        settled.prepared, settled.samples.counted, every, residuals, strict=True
    ):
        gone = whole & ~kept
        assert abs(float(residual[gone].mean())) > 2.0 * PLAY_NOISE_N
        assert abs(float(residual[kept].mean())) < REMEMBERED * PLAY_NOISE_N
        assert 8.0 < p.run.time_s[gone][-1] < 30.0
    found = [f.run for f in settled.more_findings if f.kind == "unsettled_start"]
    assert found == [f"run {k}" for k in range(4)]


def test_run_whose_force_never_reverses_is_excluded_if_other_runs_remain() -> None:
    steady = play_run("steady", 0.0, 1.0, -1.0, 9)
    settled = settled_play([*play_runs(-1.0), steady])[2]
    assert settled is not None
    *others, last = (int(kept.sum()) for kept in settled.samples.counted)
    assert last == 0
    assert min(others) > 1000


def test_no_run_is_excluded_if_the_force_reverses_in_no_run() -> None:
    runs = [play_run(f"steady {k}", 0.0, 1.0, -1.0, k) for k in range(3)]
    assert settled_play(runs)[2] is None


def test_start_is_excluded_only_if_the_play_of_the_model_has_a_width() -> None:
    problem, values = play_problem(play_runs(1.0))
    every = problem.campaign.samples
    gone = [w & ~c for w, c in zip(every.counted, problem.samples_at(values).counted, strict=True)]
    assert all(8.0 < 0.02 * int(g.sum()) < 30.0 for g in gone)
    values[problem.names.index("sensor_hysteresis.w_n")] = 0.0
    assert problem.samples_at(values) is every
