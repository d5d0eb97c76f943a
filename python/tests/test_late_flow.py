"""How runs are shifted until they are on time, and when that is believed: by lateness as told."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.diagnosis.late_channels import (
    DELAY,
    Shifted,
    _by_any_weights,
    _says_no_more,
    _shifted,
    on_time,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.lateness import Lateness
from made_of import record, samples_of

module = sys.modules["jbf.diagnosis.late_channels"]
LASTS_S = (10.0, 20.0)
STEP_S = 0.02


def late(*late_s: float, drift: float = 0.0, spread: float = 0.0) -> Lateness:
    return Lateness(late_s, drift, spread)


def problem(effects: tuple[str, ...] = (), tau_s: float = 0.0) -> Any:
    """Two runs of 10 s and 20 s, under a law with these effects."""
    prepared = [
        record(np.linspace(0.0, lasts, round(lasts / STEP_S) + 1), name=name)
        for lasts, name in zip(LASTS_S, "ab", strict=True)
    ]
    campaign = SimpleNamespace(
        prepared=prepared, more_findings=(), samples=SimpleNamespace(between=None)
    )
    names = ["F_c_n", *([f"{DELAY}.tau_s"] if DELAY in effects else [])]
    return SimpleNamespace(
        campaign=campaign, effects=effects, names=names, values=np.array([5.0, tau_s][: len(names)])
    )


class Told:
    """Lateness look by look, and what was asked for."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, answers: Sequence[Lateness | None]) -> None:
        self.answers, self.asked, self.moved, self.fitted = answers, [], [], []  # type: ignore[var-annotated]
        monkeypatch.setattr(module, "lateness", self.lateness)
        self.weighed: list[Any] = []
        monkeypatch.setattr(module, "_by_any_weights", self.weigh)
        monkeypatch.setattr(module, "moved", self.move)
        monkeypatch.setattr(module, "jointly", lambda first, found: found)
        monkeypatch.setattr(module, "_all_alike", lambda first, found: found)
        monkeypatch.setattr(module, "_differ", lambda found, policy: True)
        monkeypatch.setattr(module, "refitted", self.refit)

    def lateness(self, p: Any, s: Any, look: int, chance: float, at_jumps: bool) -> Any:
        assert chance == DEFAULT.deviation_chance
        self.asked.append((look, at_jumps))
        return self.answers[look] if look < len(self.answers) else None

    def weigh(self, p: Any, s: Any, policy: Any, found: Any, at_jumps: bool) -> Any:
        self.weighed.append((found, at_jumps))
        return found

    def move(self, p: Any, late_s: Any, drift: float) -> Any:
        self.moved.append((late_s.tolist(), drift))
        return ("moved", len(self.moved))

    def refit(self, p: Any, campaign: Any, effects: Any, known: Any, near: Any) -> Any:
        self.fitted.append(effects)
        again = problem(tuple(effects))
        again.campaign = campaign
        return again, SimpleNamespace(values=again.values)


def shifted(given: Any, **more: Any) -> Shifted | None:
    solution: Any = SimpleNamespace(values=given.values)
    return _shifted(given, solution, DEFAULT, **more)


# ---- until they are on time --------------------------------------------------------------------


def test_runs_that_are_on_time_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, [None])
    assert shifted(problem()) is None
    assert told.asked == [(0, False)]
    assert told.moved == told.weighed == []
    assert shifted(problem(), at_jumps=True) is None
    assert told.asked[1] == (0, True)


def test_runs_that_end_alike_stay_where_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    Told(monkeypatch, [late(4e-3, -2e-3), None])
    assert shifted(problem()) is not None
    monkeypatch.setattr(module, "_differ", lambda found, policy: False)
    assert shifted(problem()) is None


def test_what_is_left_is_looked_for_again_and_added(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, [late(4e-3, -2e-3), late(5e-4, 1e-4), None])
    found = shifted(problem())
    assert found is not None
    assert found.late_s == pytest.approx([4.5e-3, -1.9e-3])
    assert found.drift == 0.0
    moved: Any = found.campaign
    assert moved == ("moved", 2)
    assert [look for look, *_ in told.asked] == [0, 1, 2]
    # Larger noise in places is asked about once, at first.
    assert told.weighed == [(late(4e-3, -2e-3), False)]
    assert told.moved[0][0] == pytest.approx([4e-3, -2e-3])
    # No more than so many times.
    many = Told(monkeypatch, [late(1e-3, 0.0)] * 20)
    again = shifted(problem())
    assert again is not None
    assert len(many.asked) == DEFAULT.most_shifts
    assert again.late_s == pytest.approx([DEFAULT.most_shifts * 1e-3, 0.0])


@pytest.mark.parametrize(("spread", "shared"), [(3e-3, 0.01), (0.0, 0.0)])
def test_where_runs_differ_what_they_share_is_the_recordings(
    spread: float, shared: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = Told(monkeypatch, [late(4e-3, -2e-3, spread=spread)])
    found = shifted(problem((DELAY, "backlash"), tau_s=0.01))
    assert found is not None
    assert found.late_s == pytest.approx([4e-3 + shared, -2e-3 + shared])
    # On shifted runs a law has no delay of its own.
    assert told.fitted == [("backlash",)]


def test_a_drift_that_is_seen_later_moves_no_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = [
        late(4e-3, -2e-3),
        late(9.0, 9.0, drift=1e-3),
        late(1e-3, 1e-3, drift=1e-4, spread=1e-3),
    ]
    Told(monkeypatch, looks[:2])
    found = shifted(problem())
    assert found is not None
    assert found.late_s == pytest.approx([4e-3, -2e-3])
    assert found.drift == 1e-3
    # Where runs differ by then that counts.
    Told(monkeypatch, looks)
    again = shifted(problem())
    assert again is not None
    assert again.late_s == pytest.approx([5e-3, -1e-3])
    assert again.drift == pytest.approx(1.1e-3)


def test_what_would_leave_the_motion_is_no_lateness(monkeypatch: pytest.MonkeyPatch) -> None:
    Told(monkeypatch, [late(5.1, 0.0)])
    assert shifted(problem()) is None
    Told(monkeypatch, [late(3.0, 0.0), late(2.1, 0.0)])
    found = shifted(problem())
    assert found is not None
    assert found.late_s == pytest.approx([3.0, 0.0])


@pytest.mark.parametrize(("uneven", "asked"), [(True, 1), (False, 0)])
def test_noise_that_is_larger_in_places_counts_less(
    uneven: bool, asked: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = [np.full(5, 0.5)]
    looks: list[Any] = []

    def lateness(p: Any, solution: Any, look: int, *more: Any) -> str:
        looks.append(solution.samples.weight[0].tolist())
        return "weighed"

    monkeypatch.setattr(module, "noise_sizes", lambda *told: (sizes, ["uneven"] if uneven else []))
    monkeypatch.setattr(module, "lateness", lateness)
    monkeypatch.setattr(module, "replace", lambda s, samples: SimpleNamespace(samples=samples))
    solution: Any = SimpleNamespace(samples=samples_of([record(0.02 * np.arange(5))]))
    found: Any = _by_any_weights(problem(), solution, DEFAULT, late(1.0), False)
    assert found == ("weighed" if uneven else late(1.0))
    assert looks == [[0.5] * 5] * asked


# ---- whether it is believed --------------------------------------------------------------------


def made(late_s: Sequence[float], drift: float = 0.0, rms_n: float = 1.0) -> Shifted:
    campaign: Any = SimpleNamespace(
        prepared=problem().campaign.prepared, with_findings=lambda found: ("told", found)
    )
    solution: Any = SimpleNamespace(rms_n=rms_n)
    there: Any = SimpleNamespace(campaign=campaign)
    return Shifted(there, solution, np.array(late_s), drift)


def asked(
    monkeypatch: pytest.MonkeyPatch,
    *,
    plain: Shifted | None = None,
    at_jumps: Shifted | None = None,
    clock: Shifted | None = None,
    gains: Sequence[bool] = (True,),
    errors: tuple[float, float] = (1.0, 1.0),
    richer: Any = None,
    more: float = 1.0,
    between: Any = None,
    known: str = "",
) -> tuple[Any, list[str]]:
    """What becomes of runs that were shifted so, and what was asked on the way."""
    said: list[str] = []

    def shift(p: Any, s: Any, policy: Any, at_jumps: bool = False, *, last: Any = at_jumps) -> Any:
        said.append("at jumps" if at_jumps else "by run")
        return last if at_jumps else plain

    def by_clock(*told: Any) -> Any:
        said.append("clock")
        return clock

    def gain(before: float, left: float, found: Any) -> bool:
        said.append("gains")
        return gains[min(said.count("gains"), len(gains)) - 1]

    monkeypatch.setattr(module, "_shifted", shift)
    monkeypatch.setattr(module, "_drifting", by_clock)
    monkeypatch.setattr(module, "_gains", gain)
    monkeypatch.setattr(module, "_errors_n", lambda *told: errors)
    monkeypatch.setattr(module, "_differing", lambda p, s, policy: None)
    monkeypatch.setattr(module, "_sharper", lambda p, s, policy: None)
    monkeypatch.setattr(module, "_differ", lambda found, policy: False)
    monkeypatch.setattr(module, "_says_no_more", lambda found, solution: False)
    given = problem()
    given.campaign.samples.between = between
    given.campaign.more_findings = (
        (SimpleNamespace(kind=known, run="a", size=0.0),) if known else ()
    )
    return on_time(given, cast_any(), DEFAULT, richer, more), said


def cast_any() -> Any:
    """A solution that nobody looks into."""
    return SimpleNamespace()


def test_runs_are_shifted_where_that_gains(monkeypatch: pytest.MonkeyPatch) -> None:
    found, said = asked(monkeypatch, plain=made([4e-3, -2e-3]))
    assert found[0] == "told"
    assert [(f.run, f.size) for f in found[1]] == [("a", 4e-3), ("b", -2e-3)]
    assert said == ["by run", "clock", "gains"]
    assert asked(monkeypatch, plain=made([4e-3, -2e-3]), gains=(False,))[0] is None
    assert asked(monkeypatch) == (None, ["by run", "clock", "at jumps"])
    later, said = asked(monkeypatch, at_jumps=made([4e-3, -2e-3]))
    assert later is not None
    assert said[:3] == ["by run", "clock", "at jumps"]


@pytest.mark.parametrize("kind", ["late_channel", "drifting_clock"])
def test_what_was_shifted_once_is_not_again(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert asked(monkeypatch, plain=made([4e-3, -2e-3]), known=kind) == (None, [])
    assert asked(monkeypatch, plain=made([4e-3, -2e-3]), known="steps")[0] is not None


def test_one_clock_comes_before_what_jumps_tell(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, other = made([1e-3, 2e-3], drift=2e-4), made([4e-3, -2e-3])
    found, said = asked(monkeypatch, at_jumps=other, clock=clock)
    assert {(f.kind, f.size) for f in found[1]} == {("drifting_clock", 2e-4)}
    assert "at jumps" not in said


def test_one_clock_is_taken_where_each_run_gains_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = made([1e-3, 2e-3], drift=2e-4)
    each = made([4e-3, -2e-3])
    found, _ = asked(monkeypatch, plain=each, clock=clock, gains=(False, True))
    assert {f.kind for f in found[1]} == {"drifting_clock"}
    found, _ = asked(monkeypatch, plain=each, clock=clock, gains=(True, True))
    assert {f.kind for f in found[1]} == {"late_channel"}


@pytest.mark.parametrize(
    ("left", "more", "there"), [(1.0, 1.0, True), (1.01, 1.0, False), (1.02, 1.03, True)]
)
def test_a_richer_model_gives_way_where_shifts_leave_as_little(
    left: float, more: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, said = asked(
        monkeypatch, plain=made([4e-3, -4e-3]), richer="richer", more=more, errors=(1.0, left)
    )
    assert (found is not None) == there
    assert "gains" not in said


@pytest.mark.parametrize(("left", "there"), [(1.0, True), (1.01, False)])
def test_one_clock_must_leave_less_than_a_richer_model(
    left: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is one number, as an effect is at the least; that its runs are late alike is no matter."""
    clock = made([1e-4, 1e-4], drift=1e-5)
    found, _ = asked(monkeypatch, clock=clock, richer="richer", more=1.03, errors=(1.0, left))
    assert (found is not None) == there


@pytest.mark.parametrize(("part", "there"), [(0.95, False), (1.05, True)])
@pytest.mark.parametrize("given", [{"richer": "richer"}, {"between": "known"}])
def test_runs_that_end_alike_did_not_differ(
    part: float, there: bool, given: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a share of a step, where something else may say what they seemed to."""
    half = part * DEFAULT.late_apart * STEP_S
    found, _ = asked(monkeypatch, plain=made([half, -half]), **given)
    assert (found is not None) == there
    assert asked(monkeypatch, plain=made([half, -half]))[0] is not None


@pytest.mark.parametrize(("left_n", "no_more"), [(0.99, False), (1.0, True), (1.2, True)])
def test_beside_known_deviations_shifts_must_leave_less_than_those(
    left_n: float, no_more: bool
) -> None:
    """Residuals of 3 N, of which what the runs deviate by leaves 1 N."""

    def leaves(between: object) -> Any:
        samples = SimpleNamespace(
            between=between,
            without_deviations=lambda residuals, noise: [r / 3.0 for r in residuals],
            rms=lambda left: float(np.sqrt(np.mean(np.concatenate(left) ** 2))),
        )
        return SimpleNamespace(samples=samples, residuals=[np.full(5, 3.0)], noise=None)

    found = made([4e-3, -2e-3], rms_n=left_n)
    assert _says_no_more(found, leaves("known")) == no_more
    assert not _says_no_more(found, leaves(None))


def test_shifts_that_say_no_more_than_deviations_are_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert asked(monkeypatch, plain=made([4e-3, -2e-3]))[0] is not None
    monkeypatch.setattr(module, "_says_no_more", lambda found, solution: True)
    assert on_time(problem(), cast_any(), DEFAULT) is None
