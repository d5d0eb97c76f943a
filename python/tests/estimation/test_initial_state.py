"""Samples excluded because the state of a film, a contact or play is not known.

Predictions that begin in different states differ until the initial state has no influence. After
missing rows samples are excluded until the film does not depend on the motion in the gap.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE
from jbf.estimation.posterior_motions import corrected_for_delay
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.solution import Solution
from jbf.estimation.transients import (
    samples_affected_by_gaps,
    without_further_transients,
    without_transients,
)
from jbf.estimation.uncertain_samples import Memory, initial_memories, transient_masks
from jbf.models.chain import MotionBefore, core_motion

NOISE_N = 0.05
SLOW, FAST = (1e-3, 6.0), (1.0, 6.0)
"""Motion before the record: a share of the top speed, and its duration in seconds."""
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
    prepared = [Prepared.of(Rig.thesis(), run) for run in runs]
    campaign = Campaign(Rig.thesis(), tuple(prepared), Samples.of(prepared))
    problem = Problem(campaign, "journal", "journal", ())
    return problem, problem.starts({})[0]


def after(run: Run, before: tuple[float, float] | None, seed: int = 0) -> Run:
    """The friction of the bearing after another motion (None: after the model's own start)."""
    problem, values = journal_problem(run)
    p = problem.campaign.prepared[0]
    motion = (
        p.core
        if before is None
        else core_motion(p.rig, p.run, p.motion, before and MotionBefore(*before))
    )
    (force,) = problem.chain.predict(values, [motion])
    noise = NOISE_N * np.random.default_rng(seed).standard_normal(len(run))
    return replace(run, friction=force + noise)


def masks(*runs: Run, noise_rms: float = NOISE_N) -> list[Array]:
    problem, values = journal_problem(*runs)
    return [np.asarray(m) for m in problem.transient_samples(values, noise_rms)]


@cache
def two_starts() -> Campaign:
    """A run after slow motion and one after fast motion, without the film transient of the law."""
    runs = [after(journal_run("a", None), SLOW, 0), after(journal_run("b", 2.0), FAST, 1)]
    return without_transients(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")


@pytest.mark.parametrize(
    ("law", "names", "directions"),
    [
        ("coulomb", (), None),
        ("journal", (), False),
        ("journal", ("sensor_offset",), False),
        ("lugre", (), True),
        ("coulomb", ("presliding",), True),
        ("journal", ("dwell_stiction",), True),
        ("coulomb", PLAY, True),
        ("journal", PLAY, True),
    ],
)
def test_models_with_a_film_contact_or_backlash_have_an_initial_state_memory(
    law: str, names: tuple[str, ...], directions: bool | None
) -> None:
    """A contact or a load cell depends on past directions of motion, a film only on past speeds."""
    memories = initial_memories(law, names)
    assert bool(memories) == (directions is not None)
    backwards = [motion.speed_share < 0.0 for memory in memories for motion in memory.motions]
    assert any(backwards) == bool(directions)
    assert all(memory.margin > 1.0 for memory in memories)


@pytest.mark.parametrize("margin", [1.0, 1.5])
def test_interval_in_which_initial_states_matter_is_excluded_and_extended(margin: float) -> None:
    problem, values = journal_problem(journal_run("a", 2.0))
    (p,) = problem.campaign.prepared
    memory = Memory(tuple(MotionBefore(share, 6.0) for share in (1e-3, 0.1, 1.0)), margin, 0.5)
    starts = [core_motion(p.rig, p.run, p.motion, before) for before in memory.motions]
    forces = [problem.chain.predict(values, [motion])[0] for motion in starts]
    apart = np.flatnonzero(
        np.ptp(np.array(forces), axis=0) > SETTINGS.transient.max_difference * NOISE_N
    )
    t = p.run.time_s
    until = t[apart[0]] + margin * (t[apart[-1]] - t[apart[0]])
    (found,) = transient_masks(problem.chain, values, [p], memory, NOISE_N)
    np.testing.assert_array_equal(found, (t >= t[apart[0]]) & (t <= until))


def test_run_start_in_motion_is_excluded_until_the_film_does_not_depend_on_it() -> None:
    run = journal_run("moving", None)
    (mask,) = masks(run)
    assert mask[0]
    assert 0.1 < run.time_s[mask][-1] < 3.0
    assert np.count_nonzero(np.diff(mask.astype(int))) == 1
    # A previous motion at half of the top speed leads to an equal exclusion.
    slow, half = (after(run, before).friction for before in (SLOW, (0.5, 6.0)))
    apart = np.abs(np.asarray(slow) - np.asarray(half))
    assert apart[mask].max() > 10.0 * NOISE_N
    assert apart[~mask].max() <= SETTINGS.transient.max_difference * NOISE_N
    # A run that is too short for the transient to end is not excluded.
    assert not masks(run.select(run.time_s < 0.5))[0].any()
    counts = [int(masks(run, noise_rms=noise_rms)[0].sum()) for noise_rms in (0.01, 0.1, 1.0)]
    assert counts[0] > counts[1] > counts[2] > 0


def test_rest_before_motion_is_not_excluded_and_shortens_the_film_transient() -> None:
    short, longer, longest = (journal_run(f"after {s} s", s) for s in (2.0, 30.0, 120.0))
    found = masks(short, longer, longest)
    assert short.time_s[found[0]][0] == pytest.approx(2.0, abs=0.05)
    assert 0 < np.sum(found[1]) < np.sum(found[0])
    assert not found[2].any()


@pytest.mark.parametrize("growth_s", [0.1, 5.0])
def test_first_start_is_excluded_as_the_rest_before_it_may_have_been_longer(
    growth_s: float,
) -> None:
    """Even if the static friction of the recorded rest of one second is constant or negligible."""
    t = 0.01 * np.arange(2000)
    velocity = np.where(((t > 1.0) & (t < 3.0)) | ((t > 6.0) & (t < 8.0)), 0.01, 0.0)
    run = Run.from_arrays(t, velocity, 5.0 * np.sign(velocity))
    problem = Problem(Campaign.prepare(Rig(), [run]), "coulomb", "journal", ("dwell_stiction",))
    growth = {"a": 2.0, "t_0_s": growth_s, "m": 0.7, "s_0": 1e-3}
    known = {"F_c": 5.0} | {f"dwell_stiction.{name}": value for name, value in growth.items()}
    (mask,) = problem.transient_samples(problem.starts(known)[0], 0.1)
    assert mask[(t > 1.05) & (t < 1.3)].all()
    assert not mask[t > 6.0].any()


def test_excluded_start_keeps_its_time_in_the_motion_if_the_force_is_shifted() -> None:
    campaign = two_starts()
    shifted = corrected_for_delay(campaign, 0.1)
    ends = [
        [
            p.run.time_s[np.argmax(counted)]
            for p, counted in zip(c.prepared, c.samples.counted, strict=True)
        ]
        for c in (campaign, shifted)
    ]
    np.testing.assert_allclose(ends[1], ends[0], atol=campaign.prepared[0].step_s)
    assert min(ends[0]) > 0.2


def test_film_after_dropped_readings_depends_on_the_motion_before_them() -> None:
    """The film of a shaft that starts from rest depends on the whole motion since the start."""
    problem, values = journal_problem(journal_run("from rest", 0.0))
    (before,) = problem.campaign.prepared
    after_drop = before.shifted(0.0, 0.0, margin_s=0.5)
    dropped = len(before.readings_n) - len(after_drop.readings_n)
    assert dropped == pytest.approx(2 * 0.5 / before.step_s, abs=2)
    (expected,) = problem.chain.predict(values, [before.core])
    (found,) = problem.chain.predict(values, [after_drop.core])
    start = np.searchsorted(before.run.time_s, after_drop.run.time_s[0])
    np.testing.assert_allclose(found, expected[start : start + len(found)], rtol=1e-9)
    memoryless = problem.chain.predict(
        values, [core_motion(before.rig, after_drop.run, after_drop.motion)]
    )[0]
    assert np.max(np.abs(memoryless - found)) > 0.1 * np.max(np.abs(found))


def test_fit_is_biased_by_the_initial_transient_unless_it_is_excluded() -> None:
    runs = [after(journal_run("a", None), SLOW, 0), after(journal_run("b", 2.0), FAST, 1)]
    runs.append(after(journal_run("c", 30.0), FAST, 2))
    campaign = Campaign.prepare(Rig.thesis(), runs)
    settled = without_transients(campaign, "journal", "journal")
    assert settled.samples.count < campaign.samples.count
    (found,) = (f for f in settled.more_findings if f.run == "a")
    assert (found.kind, found.done, found.unit) == ("unsettled_start", "excluded", "s")
    gone = campaign.samples.counted[0] & ~settled.samples.counted[0]
    assert found.size == pytest.approx(np.ptp(runs[0].time_s[gone]), abs=0.03)
    problems = [Problem(each, "journal", "journal", ()) for each in (settled, campaign)]
    fits = [minimum(problem, [{}]) for problem in problems]
    # K0 is poorly determined.
    known, truth = np.array(problems[0].names) != "K0", problems[0].starts({})[0]
    errors = [float(np.abs(solution.values / truth - 1.0)[known].max()) for solution in fits]
    assert fits[0].rms == pytest.approx(NOISE_N, rel=0.1)
    assert errors[0] < 0.02
    assert errors[1] > 3.0 * errors[0]


def test_initial_transient_is_excluded_without_a_finding_if_it_agrees_with_the_model() -> None:
    """The transient causes no finding; this requires residuals twice as large as usual."""
    runs = [after(journal_run("a", None), None, 0), after(journal_run("b", 2.0), None, 1)]
    settled = without_transients(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")
    assert settled.more_findings == ()
    assert settled.samples.count < sum(len(r) for r in runs)


def with_memory(campaign: Campaign, factor: float) -> tuple[Problem, Solution]:
    """A model whose film responds at a multiple of the usual rate, at its starting values."""
    problem = Problem(campaign, "journal", "journal", ("film_memory",))
    values = problem.starts({"film_memory.factor": factor})[0]
    return problem, problem.solution(values, campaign.samples, WHITE)


def test_slower_film_excludes_further_samples_that_follow_those_already_excluded() -> None:
    campaign = two_starts()
    again = without_further_transients(*with_memory(campaign, 0.3))
    for before, now in zip(campaign.samples.counted, again.samples.counted, strict=True):
        gone = np.flatnonzero(before & ~now)
        assert len(gone) > 20
        assert not before[gone[0] - 1]
        assert not now[gone[0] : gone[-1]].any()
        assert not (now & ~before).any()
    assert without_further_transients(*with_memory(again, 0.3)) is None


def test_no_further_samples_are_excluded_for_a_film_as_fast_as_that_of_the_law() -> None:
    campaign = two_starts()
    assert without_further_transients(*with_memory(campaign, 1.0)) is None
    for names in ((), ("sensor_offset",)):
        problem = Problem(campaign, "journal", "journal", names)
        solution = problem.solution(problem.starts({})[0], campaign.samples, WHITE)
        assert without_further_transients(problem, solution) is None


def test_no_samples_are_excluded_at_starts_or_gaps_for_a_law_without_a_state() -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_rms=0.1))
    assert without_transients(campaign, "coulomb", "journal") is campaign
    problem = Problem(campaign, "coulomb", "journal", ())
    assert not any(m.any() for m in problem.transient_samples(problem.starts({})[0], 0.1))
    problem = Problem(Campaign.prepare(Rig(), [with_gap(7.0, 8.11)]), "coulomb", "journal", ())
    assert not samples_affected_by_gaps(problem, problem.starts({})[0], LEAST_N)[0].any()


def reading_with_play(force_n: Array, start_n: float) -> Array:
    """Reading of a load cell with play, which stays within half of the play of the force."""
    reading = np.empty_like(force_n)
    for i, force in enumerate(force_n.tolist()):
        start_n = min(max(start_n, force - HALF_WIDTH_N), force + HALF_WIDTH_N)
        reading[i] = start_n
    return reading


def play_run(name: str, rate: float, direction: float, branch: float, seed: int) -> Run:
    """A force that is constant for eight seconds and then, with a rate, rises and falls."""
    t = np.arange(0.0, 60.0, 0.02)
    v = direction * (0.08 - 0.06 * np.cos(rate * np.maximum(t - 8.0, 0.0)))
    path = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    force = DRY_N * np.sign(v) + VISCOUS_N_S_M * v
    reading = reading_with_play(force, float(force[0]) - branch * HALF_WIDTH_N)
    noise = PLAY_NOISE_N * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, reading + noise, position_m=path, name=name)


def play_runs(branch: float) -> list[Run]:
    plan = enumerate(((0.4, 1.0), (0.5, -1.0), (0.45, 1.0), (0.55, -1.0)))
    return [
        play_run(f"run {k}", rate, direction, branch * direction, k)
        for k, (rate, direction) in plan
    ]


def play_problem(runs: list[Run]) -> tuple[Problem, Array]:
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", PLAY)
    truth = {"F_c": DRY_N, "F_s": DRY_N, "F_v": VISCOUS_N_S_M}
    truth["sensor_hysteresis.w"] = HALF_WIDTH_N
    return problem, np.array([truth[name] for name in problem.names])


def settled_play(runs: list[Run]) -> tuple[Problem, Array, Campaign | None]:
    problem, truth = play_problem(runs)
    solution = problem.solution(truth, problem.campaign.samples, WHITE)
    return problem, truth, without_further_transients(problem, solution)


@pytest.mark.parametrize("branch", [-1.0, 1.0], ids=["fallen", "risen"])
def test_run_start_within_the_backlash_is_excluded_until_the_force_reverses(branch: float) -> None:
    problem, truth, settled = settled_play(play_runs(branch))
    residuals, every = problem.residuals(truth), problem.campaign.samples.counted
    for kept, whole, residual in zip(settled.samples.counted, every, residuals, strict=True):
        gone = whole & ~kept
        assert abs(float(residual[gone].mean())) > 2.0 * PLAY_NOISE_N
        assert abs(float(residual[kept].mean())) < SETTINGS.transient.max_difference * PLAY_NOISE_N
        assert 8.0 < settled.prepared[0].run.time_s[gone][-1] < 30.0
    found = [f.run for f in settled.more_findings if f.kind == "unsettled_start"]
    assert found == [f"run {k}" for k in range(4)]


def test_run_whose_force_never_reverses_is_excluded_if_other_runs_remain() -> None:
    steady = play_run("steady", 0.0, 1.0, -1.0, 9)
    settled = settled_play([*play_runs(-1.0), steady])[2]
    *others, last = (int(kept.sum()) for kept in settled.samples.counted)
    assert last == 0
    assert min(others) > 1000


def test_all_runs_are_kept_if_the_force_reverses_in_none_of_them() -> None:
    runs = [play_run(f"steady {k}", 0.0, 1.0, -1.0, k) for k in range(3)]
    assert settled_play(runs)[2] is None


def test_run_starts_are_excluded_only_if_the_backlash_of_the_model_is_positive() -> None:
    problem, values = play_problem(play_runs(1.0))
    every = problem.campaign.samples
    gone = [w & ~c for w, c in zip(every.counted, problem.samples_at(values).counted, strict=True)]
    assert all(8.0 < 0.02 * int(g.sum()) < 30.0 for g in gone)
    values[problem.names.index("sensor_hysteresis.w")] = 0.0
    assert problem.samples_at(values) is every


LEAST_N = 0.02
TIME = np.arange(0.0, 16.0, 0.02)


def step_of_speed(at_s: float, up: bool) -> Array:
    """A speed that increases or decreases tenfold at an instant."""
    rise = np.clip((TIME - at_s) / 0.04, 0.0, 1.0)
    return 0.01 + 0.1 * (rise if up else 1.0 - rise)


def with_gap(first_s: float, last_s: float, at_s: float = 8.0, up: bool = True) -> Run:
    """Friction of the bearing without the rows between two instants."""
    complete = Run.from_arrays(TIME, step_of_speed(at_s, up), np.ones(len(TIME)), name="gap")
    problem, values = journal_problem(complete)
    complete = replace(complete, friction=problem.predict(values)[0])
    return complete.select((first_s > TIME) | (last_s < TIME))


@pytest.mark.parametrize(
    ("at_s", "up", "last_s", "least_n"),
    [(8.0, True, 8.11, LEAST_N), (8.0, False, 8.11, LEAST_N), (7.05, False, 7.6, 4.0)],
    ids=["faster at its end", "slower at its end", "slower at its start"],
)
def test_samples_whose_film_depends_on_the_motion_in_a_gap_are_excluded(
    at_s: float, up: bool, last_s: float, least_n: float
) -> None:
    """The model interpolates the speed across a gap from 7 s on; the speed changes at one end."""
    run = with_gap(7.0, last_s, at_s, up)
    problem, values = journal_problem(run)
    wrong = np.abs(problem.residuals(values)[0]) > 1.2 * least_n
    (mask,) = samples_affected_by_gaps(problem, values, least_n)
    assert wrong.any()
    assert mask[wrong].all()
    set_aside = run.time_s[mask]
    assert last_s < set_aside.min() < last_s + 0.1
    assert set_aside.max() - set_aside.min() < 3.0
    assert samples_affected_by_gaps(problem, values, 1e3)[0].sum() == 0


@pytest.mark.parametrize(("first_s", "last_s"), [(3.0, 4.0), (12.0, 13.0), (8.01, 8.05)])
def test_no_samples_are_excluded_after_a_gap_at_constant_speed_or_of_two_rows(
    first_s: float, last_s: float
) -> None:
    problem, values = journal_problem(with_gap(first_s, last_s))
    assert not samples_affected_by_gaps(problem, values, LEAST_N)[0].any()


@pytest.mark.parametrize(("missing", "gap"), [(3, False), (4, True)])
def test_four_missing_rows_count_as_a_gap_and_three_do_not(missing: int, gap: bool) -> None:
    """A gap is a step above 4.5 times the usual one; here it contains the change of speed."""
    kept = np.ones(len(TIME), dtype=bool)
    kept[401 : 401 + missing] = False
    run = Run.from_arrays(TIME, step_of_speed(8.0, True), np.ones(len(TIME)), name="a").select(kept)
    problem, values = journal_problem(run)
    assert bool(samples_affected_by_gaps(problem, values, 1e-4)[0].any()) == gap


def test_samples_after_a_gap_are_excluded_if_errors_exceed_a_fifth_of_the_noise() -> None:
    run, noise_rms = with_gap(7.0, 8.11, up=False), 0.02
    noise = noise_rms * np.random.default_rng(4).standard_normal(len(run))
    campaign = Campaign.prepare(Rig.thesis(), [replace(run, friction=run.friction + noise)])
    settled = without_transients(campaign, "journal", "journal")
    gone = run.time_s[campaign.samples.counted[0] & ~settled.samples.counted[0]]
    (behind,) = samples_affected_by_gaps(
        *journal_problem(run), SETTINGS.transient.max_difference * noise_rms
    )
    found, expected = gone[gone > 8.0], run.time_s[behind]
    assert (found[0], found[-1]) == pytest.approx((expected[0], expected[-1]), abs=0.15)


def test_samples_excluded_after_a_gap_do_not_depend_on_the_zero_of_time() -> None:
    run = with_gap(7.0, 8.11)
    later = Run.from_arrays(run.time_s + 1000.0, run.velocity, run.friction, name="later")
    masks = [samples_affected_by_gaps(*journal_problem(r), LEAST_N)[0] for r in (run, later)]
    assert masks[0].any()
    np.testing.assert_array_equal(*masks)
