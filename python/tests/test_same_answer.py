"""The same campaign told in another way: the answer is the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import Array, Friction, coulomb, four_runs, wandering
from campaigns import SHORT, campaign
from jbf import Diagnosis, ParameterValue, Rig, Run, diagnose, fit
from jbf.records.findings.repeated_run import copies

Tell = Callable[[list[Run]], list[Run]]
FORCE = 100.0


def mass(t: Array, v: Array, a: Array) -> Array:
    return coulomb(t, v, a) + 0.2 * a


def lag(t: Array, v: Array, a: Array) -> Array:
    # To first order in the time, a lag and a delay are the same.
    return coulomb(t, v, a) - 0.005 * 20.0 * a


def tone(t: Array, v: Array, a: Array) -> Array:
    return coulomb(t, v, a) + 0.5 + 0.46 * np.sin(2.0 * np.pi * 3.0 * t)


def large_mass(t: Array, v: Array, a: Array) -> Array:
    return coulomb(t, v, a) + 3.2 * a


HIDDEN: dict[str, tuple[Friction, float]] = {
    "adequate": (coulomb, 0.1),
    "missing": (mass, 0.1),
    "ambiguous": (lag, 0.05),
    "unexplained": (tone, 0.3),
}


def recorded(verdict: str) -> list[Run]:
    if verdict == "one run":
        first = wandering("a", large_mass, way=1.0, rate=12.0, noise_n=0.1, seed=0)
        return [first, *four_runs(coulomb, noise_n=0.1)[1:]]
    friction, noise_n = HIDDEN[verdict]
    return four_runs(friction, noise_n=noise_n)


def twice(runs: list[Run]) -> list[Run]:
    return [*runs, *(replace(run, name=f"{run.name} again") for run in runs)]


def in_another_order(runs: list[Run]) -> list[Run]:
    return [replace(run, name=f"run {i}") for i, run in enumerate(reversed(runs))]


def later(runs: list[Run]) -> list[Run]:
    return [
        replace(
            run,
            time_s=run.time_s + 1000.0,
            angle_rad=None if run.angle_rad is None else run.angle_rad + 14.0 * np.pi,
        )
        for run in runs
    ]


def mirrored(runs: list[Run]) -> list[Run]:
    return [
        replace(
            run,
            velocity_m_s=-run.velocity_m_s,
            friction_n=-np.asarray(run.friction_n),
            angle_rad=None if run.angle_rad is None else -run.angle_rad,
        )
        for run in runs
    ]


def of_other_units(runs: list[Run]) -> list[Run]:
    return [replace(run, friction_n=FORCE * np.asarray(run.friction_n)) for run in runs]


def cut(runs: list[Run]) -> list[Run]:
    """The run that rests most cut in two at a rest near its middle; where none rests, the first in
    its middle."""
    whole = max(runs, key=lambda run: int(np.sum(run.velocity_m_s == 0.0)))
    at = len(whole) // 2
    resting = np.flatnonzero(whole.velocity_m_s == 0.0)
    if len(resting):
        at = int(resting[np.argmin(np.abs(resting - at))])
    parts = [
        replace(whole.select(part), name=f"{whole.name} {i}")
        for i, part in enumerate((slice(0, at), slice(at, None)))
    ]
    return [new for run in runs for new in (parts if run is whole else [run])]


TOLD: dict[str, Tell] = {
    f.__name__: f for f in (twice, in_another_order, later, mirrored, of_other_units, cut)
}


@cache
def answered(verdict: str) -> Diagnosis:
    return diagnose(Rig(), recorded(verdict), law="coulomb")


def same(told: Diagnosis, first: Diagnosis, *, within: float, mirror: bool = False) -> None:
    """The same verdict and names; parameters within a small part of their errors, which are the
    same, too."""
    assert told.verdict == first.verdict
    assert told.effects == first.effects
    assert told.alternatives == first.alternatives
    assert {r.axis for r in told.unexplained} == {r.axis for r in first.unexplained}
    assert told.confounders == first.confounders
    assert list(told.fit.parameters) == list(first.fit.parameters)
    for name, p in told.fit.parameters.items():
        q = first.fit.parameters[name]
        assert p.held == q.held, name
        if p.stderr is None or q.stderr is None:
            continue
        value = -q.value if mirror and name == "sensor_offset.b_n" else q.value
        assert abs(p.value - value) < within * q.stderr, name
        assert p.stderr == pytest.approx(q.stderr, rel=max(within, 1e-3)), name


def in_newtons_before(d: Diagnosis) -> Diagnosis:
    """The parameters of a law in newtons as they were before the force had other units."""

    def less(name: str, p: ParameterValue) -> ParameterValue:
        size = 1.0 if name == "time_delay.tau_s" else FORCE
        stderr = None if p.stderr is None else p.stderr / size
        return replace(p, value=p.value / size, stderr=stderr)

    parameters = {name: less(name, p) for name, p in d.fit.parameters.items()}
    return replace(d, fit=replace(d.fit, parameters=parameters))


@pytest.mark.parametrize("tell", list(TOLD))
@pytest.mark.parametrize("verdict", list(HIDDEN))
def test_a_campaign_told_in_another_way_has_the_same_answer(verdict: str, tell: str) -> None:
    first = answered(verdict)
    assert first.verdict == verdict
    told = diagnose(Rig(), TOLD[tell](recorded(verdict)), law="coulomb")
    if tell == "of_other_units":
        told = in_newtons_before(told)
    # Only where a record is cut are there samples that count for less.
    same(told, first, within=0.05 if tell == "cut" else 1e-3, mirror=tell == "mirrored")


def test_what_helps_in_one_run_only_does_not_help_in_its_copy() -> None:
    """A copy in the fit would foretell the run that is left out."""
    first = answered("one run")
    told = diagnose(Rig(), twice(recorded("one run")), law="coulomb")
    assert first.effects == ()
    same(told, first, within=1e-6)
    assert [r.where for r in told.unexplained] == [r.where for r in first.unexplained]


def test_a_run_given_twice_is_one_run() -> None:
    runs = recorded("missing")
    again = later([replace(runs[1], name="b on another day")])[0]
    assert copies([*runs, again]) == {4: 1}
    assert copies([*runs, *twice(runs)]) == {4 + i: i % 4 for i in range(8)}
    noisier = replace(again, friction_n=np.asarray(again.friction_n) + 1e-12)
    warmer = replace(again, temperature_c=np.full(len(again), 30.0))
    faster = replace(again, time_s=1.001 * again.time_s)
    assert copies([*runs, noisier, warmer, faster]) == {}
    once, told = (fit(Rig(), r, law="coulomb") for r in (runs, [*runs, again]))
    assert told.parameters == once.parameters
    (found,) = [f for f in told.findings if f.kind == "repeated_run"]
    assert (found.run, found.done) == ("b on another day", "left out")
    assert "run b again" in found.words
    assert "b on another day" in told.report()


def test_a_bearing_told_in_another_way_has_the_same_answer() -> None:
    rig, runs, _ = campaign(7, ("coulomb_drag",), motions=SHORT.motions[1:])
    first = diagnose(rig, runs)
    assert (first.verdict, first.effects) == ("missing", ("coulomb_drag",))
    told = diagnose(rig, twice(later(mirrored(in_another_order(runs)))))
    same(told, first, within=0.01)
    assert len([f for f in told.findings if f.kind == "repeated_run"]) == len(runs)
    # A film that rests is not settled: what follows a cut says less of the boundary.
    parts = diagnose(rig, cut(runs))
    assert (parts.verdict, parts.effects) == (first.verdict, first.effects)
    for name, p in parts.fit.parameters.items():
        q = first.fit.parameters[name]
        assert p.stderr is not None
        assert q.stderr is not None
        assert abs(p.value - q.value) < 2.0 * p.stderr, name
