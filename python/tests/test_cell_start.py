"""A cell with play begins a run anywhere in it: what remembers that is no physics.

The cell is a loop of its own: it holds what it shows between the force less and more half its play.
"""

from __future__ import annotations

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign as simulated
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.initial_state import REMEMBERED
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.run_start import settled_again
from jbf.models.catalogue import effects, find_effect

Array = npt.NDArray[np.float64]

DRY_N, VISCOUS_N_S_M, HALF_WIDTH_N, NOISE_N = 5.0, 40.0, 0.6, 0.1
UNKNOWN = pytest.mark.parametrize("branch", [-1.0, 1.0], ids=["had fallen", "had risen"])


def shown(force_n: Array, begun_n: float) -> Array:
    """What the cell shows, from what it showed before."""
    out = np.empty_like(force_n)
    for i, force in enumerate(force_n.tolist()):
        begun_n = min(max(begun_n, force - HALF_WIDTH_N), force + HALF_WIDTH_N)
        out[i] = begun_n
    return out


def run(name: str, rate: float, way: float, branch: float, seed: int) -> Run:
    """Eight seconds of the first force, eight that it takes to rise, turns thereafter; `branch` is
    +1 where the force had risen before the record, -1 where it had fallen, 0 with the cell in the
    middle of its play."""
    t = np.arange(0.0, 60.0, 0.02)
    since = np.maximum(t - 8.0, 0.0)
    v = way * (0.08 - 0.06 * np.cos(rate * since))
    position = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    force = DRY_N * np.sign(v) + VISCOUS_N_S_M * v
    read = shown(force, float(force[0]) - branch * HALF_WIDTH_N)
    noise = NOISE_N * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, read + noise, position_m=position, name=name)


def runs(branch: float) -> list[Run]:
    plan = enumerate(((0.4, 1.0), (0.5, -1.0), (0.45, 1.0), (0.55, -1.0)))
    return [run(f"run {k}", rate, way, branch * way, k) for k, (rate, way) in plan]


def posed(branch: float) -> tuple[Problem, Array]:
    campaign = Campaign.prepare(Rig(), runs(branch))
    problem = Problem(campaign, "coulomb", "journal", ("sensor_hysteresis",))
    truth = {
        "F_c_n": DRY_N,
        "F_s_n": DRY_N,
        "F_v_n_s_m": VISCOUS_N_S_M,
        "sensor_hysteresis.w_n": HALF_WIDTH_N,
    }
    return problem, np.array([truth[name] for name in problem.names])


def test_it_is_the_one_effect_whose_start_no_sample_tells() -> None:
    pages = [find_effect(name) for name in effects()]
    assert [page.name for page in pages if page.unknown_start] == ["sensor_hysteresis"]


@UNKNOWN
def test_what_remembers_the_beginning_is_set_aside(branch: float) -> None:
    problem, truth = posed(branch)
    campaign = problem.campaign
    settled = settled_again(problem, problem.solution(truth, campaign.samples, WHITE))
    assert settled is not None
    wrong = problem.chain.predict(truth, campaign.motions)
    right = problem.chain.predict(truth, settled.motions)
    for p, kept, whole, model, same in zip(
        campaign.prepared,
        settled.samples.counted,
        campaign.samples.counted,
        wrong,
        right,
        strict=True,
    ):
        np.testing.assert_array_equal(model, same)
        noise_free = p.friction_n - model
        gone = whole & ~kept
        assert abs(float(noise_free[gone].mean())) > 2.0 * NOISE_N
        assert abs(float(noise_free[kept].mean())) < REMEMBERED * NOISE_N
        # Until the force has turned once, no longer.
        assert 8.0 < p.run.time_s[gone][-1] < 30.0
    told = [f for f in settled.more_findings if f.kind == "unsettled_start"]
    assert {f.run for f in told} == {f"run {k}" for k in range(4)}
    assert all(f.words.startswith("the cell was elsewhere in its play when") for f in told)


@UNKNOWN
def test_a_diagnosis_names_the_play_and_nothing_besides(branch: float) -> None:
    found = jbf.diagnose(Rig(), runs(branch), law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("sensor_hysteresis",))
    width = found.fit.parameters["sensor_hysteresis.w_n"]
    assert width.stderr is not None
    assert width.value == pytest.approx(HALF_WIDTH_N, abs=4.0 * width.stderr)
    assert found.steps[-1].rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_a_run_whose_force_never_turns_goes_whole_where_others_remain() -> None:
    steady = run("steady", 0.0, 1.0, -1.0, 9)
    campaign = Campaign.prepare(Rig(), [*runs(-1.0), steady])
    problem = Problem(campaign, "coulomb", "journal", ("sensor_hysteresis",))
    truth = posed(-1.0)[1]
    settled = settled_again(problem, problem.solution(truth, campaign.samples, WHITE))
    assert settled is not None
    *others, last = (int(kept.sum()) for kept in settled.samples.counted)
    assert last == 0
    assert min(others) > 1000
    found = jbf.diagnose(Rig(), [*runs(-1.0), steady], law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("sensor_hysteresis",))
    assert found.fit.parameters["sensor_hysteresis.w_n"].value == pytest.approx(0.6, rel=0.02)


def test_where_hardly_a_force_turns_the_runs_stay() -> None:
    campaign = Campaign.prepare(Rig(), [run(f"steady {k}", 0.0, 1.0, -1.0, k) for k in range(3)])
    problem = Problem(campaign, "coulomb", "journal", ("sensor_hysteresis",))
    truth = posed(-1.0)[1]
    assert settled_again(problem, problem.solution(truth, campaign.samples, WHITE)) is None


def test_a_model_with_play_leaves_what_remembers_its_start_and_no_model_without() -> None:
    problem, values = posed(1.0)
    every = problem.campaign.samples
    gone = [w & ~c for w, c in zip(every.counted, problem.samples_at(values).counted, strict=True)]
    assert all(8.0 < 0.02 * int(g.sum()) < 30.0 for g in gone)
    values[problem.names.index("sensor_hysteresis.w_n")] = 0.0
    assert problem.samples_at(values) is every


def test_a_wide_play_is_found_whatever_its_score_at_no_play() -> None:
    """There the law makes up for it, and a step from none promises less than chance would."""
    rig, these, truth = simulated(7952012, ("sensor_hysteresis",), strength=1.5)
    found = jbf.diagnose(rig, these)
    assert (found.verdict, found.effects) == ("missing", ("sensor_hysteresis",))
    assert found.steps[-1].rms_n < 1.03 * truth["noise_n"]


def test_without_play_nothing_is_set_aside_of_a_law_that_forgets() -> None:
    campaign = Campaign.prepare(Rig(), runs(1.0))
    problem = Problem(campaign, "coulomb", "journal", ("sensor_offset",))
    values = problem.starts({})[0]
    assert settled_again(problem, problem.solution(values, campaign.samples, WHITE)) is None
