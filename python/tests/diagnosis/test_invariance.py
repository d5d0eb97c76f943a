"""Invariance of a diagnosis to equivalent records of a campaign."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import assert_recovered
from campaigns import SHORT, campaign
from jbf import Diagnosis, ParameterValue, Rig, Run, diagnose, fit
from jbf.records.findings.repeated_run import copies
from linear_campaigns import linear_diagnosis, linear_runs

Change = Callable[[list[Run]], list[Run]]
FORCE_UNIT = 100.0


def moved(run: Run, *, sign: float = 1.0, later_s: float = 0.0, turned_rad: float = 0.0) -> Run:
    """A run with a different sign of motion and force, first time and first angle."""
    return replace(
        run,
        time_s=run.time_s + later_s,
        velocity=sign * run.velocity,
        friction=sign * np.asarray(run.friction),
        angle_rad=None if run.angle_rad is None else sign * run.angle_rad + turned_rad,
    )


def repeated(runs: list[Run]) -> list[Run]:
    return [*runs, *(replace(run, name=f"{run.name} again") for run in runs)]


def reordered(runs: list[Run]) -> list[Run]:
    return [replace(run, name=f"run {i}") for i, run in enumerate(reversed(runs))]


def later(runs: list[Run]) -> list[Run]:
    """Times shifted by 1000 s and angles shifted by seven turns."""
    return [moved(run, later_s=1000.0, turned_rad=14.0 * np.pi) for run in runs]


def mirrored(runs: list[Run]) -> list[Run]:
    return [moved(run, sign=-1.0) for run in runs]


def in_other_units(runs: list[Run]) -> list[Run]:
    return [replace(run, friction=FORCE_UNIT * np.asarray(run.friction)) for run in runs]


def cut(runs: list[Run]) -> list[Run]:
    """The run with the largest number of rests, cut at a rest near its middle, or the first run."""
    longest = max(runs, key=lambda run: int(np.sum(run.velocity == 0.0)))
    middle = len(longest) // 2
    resting = np.flatnonzero(longest.velocity == 0.0)
    if len(resting):
        middle = int(resting[np.argmin(np.abs(resting - middle))])
    halves = [
        replace(longest.select(part), name=f"{longest.name} {i}")
        for i, part in enumerate((slice(0, middle), slice(middle, None)))
    ]
    return [new for run in runs for new in (halves if run is longest else [run])]


CHANGES: dict[str, Change] = {
    change.__name__: change
    for change in (repeated, reordered, later, mirrored, in_other_units, cut)
}
VERDICTS = {
    "nothing": "adequate",
    "mass": "missing",
    "lag": "ambiguous",
    "offset and tone": "unexplained",
}
CASES = [
    pytest.param(hidden, change, marks=() if hidden == "mass" else pytest.mark.extended)
    for hidden in VERDICTS
    for change in CHANGES
]


def assert_same(
    changed: Diagnosis, first: Diagnosis, *, within: float, mirror: bool = False
) -> None:
    """Check for equal verdicts and effects, and for estimates within a share of their errors."""
    for name in ("verdict", "effects", "alternatives", "confounders"):
        assert getattr(changed, name) == getattr(first, name)
    assert {r.axis for r in changed.residual_structure} == {
        r.axis for r in first.residual_structure
    }
    assert list(changed.fit.parameters) == list(first.fit.parameters)
    for name, new in changed.fit.parameters.items():
        old = first.fit.parameters[name]
        assert new.held == old.held, name
        if new.stderr is not None and old.stderr is not None:
            expected = -old.value if mirror and name == "sensor_offset.b" else old.value
            assert abs(new.value - expected) < within * old.stderr, name
            assert new.stderr == pytest.approx(old.stderr, rel=max(within, 1e-3)), name


def in_first_units(diagnosis: Diagnosis) -> Diagnosis:
    """The parameters of a diagnosis of forces in other units, converted back."""

    def convert(name: str, p: ParameterValue) -> ParameterValue:
        unit = 1.0 if name == "time_delay.tau_s" else FORCE_UNIT
        stderr = None if p.stderr is None else p.stderr / unit
        return replace(p, value=p.value / unit, stderr=stderr)

    parameters = {name: convert(name, p) for name, p in diagnosis.fit.parameters.items()}
    return replace(diagnosis, fit=replace(diagnosis.fit, parameters=parameters))


@pytest.mark.parametrize(("hidden", "change"), CASES)
def test_diagnosis_is_invariant_to_equivalent_changes_of_records(hidden: str, change: str) -> None:
    first = linear_diagnosis(hidden)
    assert first.verdict == VERDICTS[hidden]
    changed = diagnose(Rig(), CHANGES[change](linear_runs(hidden)), law="coulomb")
    if change == "in_other_units":
        changed = in_first_units(changed)
    # Only a cut changes the set of counted samples.
    within = 0.05 if change == "cut" else 1e-3
    assert_same(changed, first, within=within, mirror=change == "mirrored")


def test_run_given_twice_is_used_once_and_reported() -> None:
    runs = linear_runs("mass")
    again = later([replace(runs[1], name="b on another day")])[0]
    assert copies([*runs, again]) == {4: 1}
    assert copies([*runs, *repeated(runs)]) == {4 + i: i % 4 for i in range(8)}
    noisier = replace(again, friction=np.asarray(again.friction) + 1e-12)
    warmer = replace(again, temperature_c=np.full(len(again), 30.0))
    faster = replace(again, time_s=1.001 * again.time_s)
    assert copies([*runs, noisier, warmer, faster]) == {}
    once, twice = (fit(Rig(), some, law="coulomb") for some in (runs, [*runs, again]))
    assert twice.parameters == once.parameters
    (found,) = [f for f in twice.findings if f.kind == "repeated_run"]
    assert found.run == "b on another day"


@pytest.mark.extended
def test_diagnosis_of_a_bearing_is_invariant_to_repeated_and_mirrored_runs() -> None:
    rig, runs, _ = campaign(7, ("coulomb_drag",), motions=SHORT.motions[1:])
    first = diagnose(rig, runs)
    assert (first.verdict, first.effects) == ("missing", ("coulomb_drag",))
    changed = diagnose(rig, repeated(later(mirrored(reordered(runs)))))
    assert_same(changed, first, within=0.01)
    assert len([f for f in changed.findings if f.kind == "repeated_run"]) == len(runs)
    # After a cut the film is not settled, so that the boundary friction is less well determined.
    halves = diagnose(rig, cut(runs))
    assert (halves.verdict, halves.effects) == (first.verdict, first.effects)
    for name, new in halves.fit.parameters.items():
        assert_recovered(new, first.fit.parameters[name].value, errors=2.0)
