"""Records that begin in a state that nobody wrote down: set aside until it is forgotten."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.initial_state import REMEMBERED
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.run_start import settled_again, settled_campaign, unsettled
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.models.chain import core_motion

NOISE_N = 0.05
RESTED, MOVED = (1e-3, 6.0), (1.0, 6.0)
"""What was before a record: a shaft that hardly moved, or one at the run's top speed."""


def motion(name: str, rest_s: float | None) -> Run:
    """A run whose shaft moves from the first sample on (None), or starts after a rest."""
    t = np.arange(0.0, 15.0 + (rest_s or 0.0), 0.02)
    if rest_s is None:
        v = 0.06 + 0.05 * np.sin(0.7 * t + 0.5)
    else:
        v = np.where(t < rest_s, 0.0, 0.06 * np.sin(0.5 * (t - rest_s)))
    return Run.from_arrays(t, v, np.ones(len(t)), name=name)


def posed(runs: list[Run]) -> tuple[Problem, Array]:
    prepared = [Prepared.of(Rig.thesis(), run) for run in runs]
    campaign = Campaign(Rig.thesis(), tuple(prepared), Samples.of(prepared))
    problem = Problem(campaign, "journal", "journal", ())
    return problem, problem.starts({})[0]


def recorded(run: Run, before: tuple[float, float], seed: int = 0) -> Run:
    """The friction of the bare law on a motion that came after another."""
    problem, values = posed([run])
    p = problem.campaign.prepared[0]
    (force,) = problem.chain.predict(values, [core_motion(p.rig, p.run, p.motion, before)])
    noise = NOISE_N * np.random.default_rng(seed).standard_normal(len(run))
    return replace(run, friction_n=force + noise)


def masks(*runs: Run) -> list[Array]:
    problem, values = posed(list(runs))
    return [np.asarray(m) for m in unsettled(problem, values, NOISE_N)]


def test_a_run_that_begins_in_motion_has_its_first_stretch_set_aside() -> None:
    run = motion("moving", None)
    (mask,) = masks(run)
    assert mask[0]
    assert 0.1 < run.time_s[mask][-1] < 3.0
    # One stretch.
    assert np.count_nonzero(np.diff(mask.astype(int))) == 1
    # What a shaft at half its speed had left is forgotten where the samples are kept, and not
    # where they are set aside.
    problem, values = posed([run])
    p = problem.campaign.prepared[0]
    ways = [core_motion(p.rig, p.run, p.motion, before) for before in (RESTED, (0.5, 6.0))]
    a, b = problem.chain.predict(values, ways)
    apart = np.abs(a - b)
    assert apart[mask].max() > 10.0 * NOISE_N
    assert apart[~mask].max() <= REMEMBERED * NOISE_N


def test_a_rest_is_kept_and_a_long_one_settles_the_film() -> None:
    short, longer, longest = (motion(f"after {s} s", s) for s in (2.0, 30.0, 120.0))
    after = masks(short, longer, longest)
    begun = short.time_s[after[0]][0]
    # From where the shaft starts.
    assert begun == pytest.approx(2.0, abs=0.05)
    assert 0 < np.sum(after[1]) < np.sum(after[0])
    assert not after[2].any()


def test_what_is_forgotten_before_a_rest_is_not_remembered_after_it() -> None:
    t = np.arange(0.0, 30.0, 0.1)
    phase = t % 6.0
    v = np.where((phase > 4.0) | (t < 0.4), 0.0, 0.08 * np.sin(np.pi * phase / 4.0))
    run = Run.from_arrays(t, v, np.ones(len(t)), name="stop and go")
    problem, values = posed([run])
    (mask,) = unsettled(problem, values, 0.02)
    assert mask.any()
    assert run.time_s[mask][-1] < 3.0


def test_less_noise_remembers_longer() -> None:
    problem, values = posed([motion("moving", None)])
    counts = [int(unsettled(problem, values, noise_n)[0].sum()) for noise_n in (0.01, 0.1, 1.0)]
    assert counts[0] > counts[1] > counts[2] > 0


def test_what_never_forgets_is_taken_as_it_is() -> None:
    run = motion("moving", None)
    # Half a second of it is remembered, most of so short a run.
    short = run.select(run.time_s < 0.5)
    assert masks(run)[0].any()
    assert not masks(short)[0].any()


def test_the_fit_is_right_without_the_beginning_and_wrong_with_it() -> None:
    runs = [recorded(motion("a", None), RESTED, 0), recorded(motion("b", 2.0), MOVED, 1)]
    runs.append(recorded(motion("c", 30.0), MOVED, 2))
    campaign = Campaign.prepare(Rig.thesis(), runs)
    settled = settled_campaign(campaign, "journal", "journal")
    assert settled.samples.count < campaign.samples.count
    found = [f for f in settled.more_findings if f.run == "a"]
    assert [(f.kind, f.done, f.unit) for f in found] == [("unsettled_start", "set aside", "s")]
    errors = []
    for each in (settled, campaign):
        problem = Problem(each, "journal", "journal", ())
        truth = problem.starts({})[0]
        solution = minimum(problem, [{}])
        # K0 tells next to nothing.
        shares = solution.values / truth - 1.0
        errors.append(float(np.abs(np.delete(shares, problem.names.index("K0"))).max()))
        if each is settled:
            assert solution.rms_n == pytest.approx(NOISE_N, rel=0.1)
    assert errors[0] < 0.02
    assert errors[1] > 3.0 * errors[0]


def test_runs_that_began_as_the_model_does_are_told_nothing_of() -> None:
    problem, _ = posed([motion("a", None), motion("b", 2.0)])
    assert all(p.run.friction_n is not None for p in problem.campaign.prepared)
    runs = []
    for i, p in enumerate(problem.campaign.prepared):
        (force,) = problem.chain.predict(problem.starts({})[0], [p.core])
        noise = NOISE_N * np.random.default_rng(i).standard_normal(len(p.run))
        runs.append(replace(p.run, friction_n=force + noise))
    settled = settled_campaign(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")
    # Set aside all the same: no record tells that it was so.
    assert settled.more_findings == ()
    assert settled.samples.count < sum(len(r) for r in runs)


def with_memory(campaign: Campaign, factor: float, *more: str) -> tuple[Problem, Solution]:
    """A model whose film follows at so many times the rate, and more effects at their start."""
    problem = Problem(campaign, "journal", "journal", ("film_memory", *more))
    values = problem.starts({"film_memory.factor": factor})[0]
    return problem, problem.solution(values, campaign.samples, WHITE)


def test_what_a_slower_film_remembers_is_set_aside_once_that_is_known() -> None:
    runs = [recorded(motion("a", None), RESTED, 0), recorded(motion("b", 2.0), MOVED, 1)]
    campaign = settled_campaign(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")
    again = settled_again(*with_memory(campaign, 0.3))
    assert again is not None
    for before, after in zip(campaign.samples.counted, again.samples.counted, strict=True):
        gone = np.flatnonzero(before & ~after)
        # A stretch that comes next behind what was gone already.
        assert len(gone) > 20
        assert not before[gone[0] - 1]
        assert not after[gone[0] : gone[-1]].any()
        assert not (after & ~before).any()
    # It is enough.
    assert settled_again(*with_memory(again, 0.3)) is None
    # Effects behind the film have no part in it: wear from before the run is theirs to tell.
    worn = settled_again(*with_memory(campaign, 0.3, "wear_in"))
    assert worn is not None
    assert worn.samples.count == again.samples.count


def test_a_film_that_is_as_fast_as_the_bare_laws_sets_no_more_aside() -> None:
    runs = [recorded(motion("a", None), RESTED, 0), recorded(motion("b", 2.0), MOVED, 1)]
    campaign = settled_campaign(Campaign.prepare(Rig.thesis(), runs), "journal", "journal")
    assert settled_again(*with_memory(campaign, 1.0)) is None
    bare = Problem(campaign, "journal", "journal", ())
    assert settled_again(bare, minimum(bare, [{}])) is None


def test_without_an_effect_on_the_film_nothing_more_is_set_aside() -> None:
    """What the bare law remembers is set aside before, for every model, or not at all."""
    campaign = Campaign.prepare(Rig.thesis(), [recorded(motion("a", None), RESTED, 0)])
    assert settled_campaign(campaign, "journal", "journal") is not campaign
    for effects in ((), ("sensor_offset",)):
        problem = Problem(campaign, "journal", "journal", effects)
        values = problem.starts({})[0]
        assert settled_again(problem, problem.solution(values, campaign.samples, WHITE)) is None


def test_a_law_in_newtons_remembers_nothing() -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    assert settled_campaign(campaign, "coulomb", "journal") is campaign
    problem = Problem(campaign, "coulomb", "journal", ())
    assert not any(m.any() for m in unsettled(problem, problem.starts({})[0], 0.1))
