"""Cost of fits in inner steps of the model, its limit, and the result of an interrupted fit."""

from collections.abc import Iterator

import jbf
import numpy as np
import pytest
from by_hand import coulomb, four_runs
from campaigns import campaign
from coulomb_problems import coulomb_problem, values_of
from jbf import Parameter, Rig, fit
from jbf.errors import Stopped, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.problem import Problem
from jbf.estimation.work import ANY_STEPS, STEPS_A_SAMPLE, TimeLimit, Work


def test_work_beyond_the_limit_raises_unfinished() -> None:
    work = Work(10.0)
    work.take(4.0)
    work.take(6.0)
    with pytest.raises(Unfinished):
        work.take(1.0)
    assert work.part(0.5).most == 5.0
    work.renew(3.0)
    work.take(3.0)
    with pytest.raises(Unfinished):
        work.take(0.1)


def test_work_beyond_the_time_limit_raises_unfinished() -> None:
    now = [100.0]
    work = Work.of(10, TimeLimit(8.0, lambda: now[0]))
    half = work.part(0.5)
    now[0] = 103.0
    half.take(1.0)
    now[0] = 105.0
    work.take(1.0)
    with pytest.raises(Unfinished) as ended:
        half.take(1.0)
    assert ended.value.time_limit_s == 8.0
    now[0] = 108.0
    with pytest.raises(Unfinished):
        work.take(1.0)
    with work.untimed():
        work.take(1.0)
    with pytest.raises(Unfinished):
        work.check()
    work.lift()
    work.take(1e30)


def test_work_limit_grows_with_the_samples_and_has_a_minimum() -> None:
    assert Work.of(10).most == ANY_STEPS
    assert Work.of(10**6).most == STEPS_A_SAMPLE * 1e6 > ANY_STEPS


def test_prediction_costs_its_inner_steps_and_derivatives_twice_as_many() -> None:
    rig, runs, _ = campaign(5)
    prepared = Campaign.prepare(rig, runs[:2])
    problem = Problem(prepared, "journal", "journal", ())
    values = problem.starts({})[0]
    steps = problem.chain.inner_steps(values, prepared.motions)
    assert steps >= 2.0 * sum(len(p.run) for p in prepared.prepared)
    for cost, call in ((steps, problem.predict), (2.0 * steps, problem.linearise)):
        prepared.work.renew()
        call(values)
        assert prepared.work.taken == pytest.approx(cost)
    # Predictions of a part of a campaign count towards the limit of the complete campaign.
    prepared.work.renew()
    problem.predict(values, [1])
    one = prepared.work.taken
    Problem(prepared.only([1]), "journal", "journal", ()).predict(values)
    assert one < steps
    assert prepared.work.taken == pytest.approx(2.0 * one)


def test_search_beyond_the_limit_raises_unfinished_and_stores_the_best_values() -> None:
    problem = coulomb_problem(four_runs(coulomb, noise_rms=0.1))
    once = problem.chain.inner_steps(values_of(problem), problem.campaign.motions)
    problem.campaign.work.renew(12.0 * once)
    with pytest.raises(Unfinished) as ended:
        minimum(problem, [{}])
    assert ended.value.steps > 12.0 * once
    assert np.all(np.isfinite(problem.best.values))
    assert "\n" not in str(ended.value)


def test_fit_within_a_time_limit_is_unchanged_and_beyond_it_raises_unfinished() -> None:
    runs = four_runs(coulomb, noise_rms=0.1)
    free, limited = (fit(Rig(), runs, law="coulomb", time_limit_s=t) for t in (None, 1e9))
    assert limited.to_dict() == free.to_dict()
    with pytest.raises(Unfinished) as ended:
        fit(Rig(), runs, law="coulomb", time_limit_s=1e-9)
    assert ended.value.time_limit_s == 1e-9


def test_bootstrap_beyond_its_time_limit_raises_unfinished_with_the_given_fit() -> None:
    runs, now = four_runs(coulomb, noise_rms=0.1), [0.0]
    fitted = fit(Rig(), runs, law="coulomb")

    def at_the_third(message: str, done: int, total: int) -> None:
        now[0] = 2.0 if done == 2 else 0.0

    with pytest.raises(Unfinished) as ended:
        jbf.bootstrap(
            fitted,
            runs,
            repeats=19,
            progress=at_the_third,
            time_limit_s=TimeLimit(1.0, lambda: now[0]),
        )
    assert ended.value.fit is fitted


@pytest.fixture
def interrupting() -> Iterator[str]:
    """A law that simulates Ctrl-C at its 120th evaluation."""
    calls: list[int] = []

    def interrupting_law(velocity, F_c, F_v, v_0):  # type: ignore[no-untyped-def]
        calls.append(1)
        if len(calls) == 120:
            raise KeyboardInterrupt
        return F_c * np.tanh(velocity / v_0) + F_v * velocity

    pages = [
        Parameter("F_c", "N", lower=0.0, upper=1e3, starts=(1.0,)),
        Parameter("F_v", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
        Parameter("v_0", "m/s", lower=1e-5, upper=1.0, starts=(0.3,), log=True),
    ]
    yield jbf.register_law(interrupting_law, parameters=pages).name
    jbf.forget_law("interrupting_law")


def test_interrupted_fit_returns_the_best_values_so_far(interrupting: str) -> None:
    runs = four_runs(coulomb, noise_rms=0.1)
    with pytest.raises(Stopped) as stopped:
        fit(Rig(), runs, law=interrupting)
    best = stopped.value.fit
    assert not best.converged
    assert np.all(np.isfinite(list(best.params.values())))
    assert best.rms < jbf.compare(jbf.Model(Rig(), interrupting), runs).rms
