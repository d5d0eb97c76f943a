"""How many times its usual strength an effect must have, of made-up effects that grow as told."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.alone import Change, chance_apart, left_apart
from jbf.diagnosis.power import (
    AGREES,
    LOOKS_ALONE,
    Power,
    _found,
    _further,
    _parameters,
    _power,
    _Seen,
    _times,
    _weakest,
    non_centrality,
)
from jbf.estimation.likelihood import spanned
from scipy import stats

Array = npt.NDArray[np.float64]
SAMPLES = 400
module = sys.modules["jbf.diagnosis.power"]


def growing(
    told: Callable[[float], float], most: float = np.inf, least: float = 0.0
) -> tuple[Any, Any]:
    """Runs, and an effect that is worth so much at so many times its strength; beyond bounds it is
    what it is there."""

    def inside(times: float) -> float:
        return float(np.clip(times, least, most))

    runs: Any = SimpleNamespace(
        change=lambda model, times: np.full(SAMPLES, np.sqrt(told(inside(times)) / SAMPLES)),
        shown=lambda change: change,
    )
    model: Any = SimpleNamespace(values=lambda times: np.array([1.0, inside(times)]), which=1)
    return runs, model


@pytest.mark.parametrize("begin", [1e-2, 1.0, 50.0])
@pytest.mark.parametrize("power", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("wanted", [3.0, 60.0])
def test_the_strength_is_where_it_is_worth_so_much(
    begin: float, power: float, wanted: float
) -> None:
    """By whichever power of its strength it grows, to a twentieth."""
    assert AGREES == 0.05
    runs, model = growing(lambda times: 40.0 * times**power)
    assert _times(runs, model, wanted, begin) == pytest.approx(
        (wanted / 40.0) ** (1.0 / power), rel=AGREES
    )


def test_what_grows_all_at_once_is_found_between_too_little_and_enough() -> None:
    """Nothing up to 0.3 of its strength, and all from there on."""
    runs, model = growing(lambda times: 1e-9 if times < 0.3 else 900.0)
    for begin in (0.01, 1.0, 20.0):
        found = _times(runs, model, 60.0, begin)
        assert 0.3 <= found < 0.3 * (1.0 + 2.0 * AGREES)


def test_the_search_ends_where_too_little_and_enough_are_as_good_as_one() -> None:
    """From 1, a thousandth as strong is too little; in between the middle is taken until a
    twentieth is left: of log(1000) seven halvings."""
    runs, model = growing(lambda times: 1e-9 if times < 0.3 else 900.0)
    asked: list[float] = []
    plain = runs.change

    def counting(of: Any, times: float) -> Array:
        asked.append(times)
        found: Array = plain(of, times)
        return found

    runs.change = counting
    found = _times(runs, model, 60.0, 1.0)
    little = max(times for times in asked if times < 0.3)
    enough = min(times for times in asked if times >= 0.3)
    assert found == enough
    assert enough < little * (1.0 + AGREES)
    # Not looked at once more than that takes.
    before = [t for t in asked[:-1] if t < 0.3], [t for t in asked[:-1] if t >= 0.3]
    assert min(before[1]) >= max(before[0]) * (1.0 + AGREES)


def test_at_a_bound_there_is_no_more_to_be_had() -> None:
    """At twice its strength it is worth 40: 30 is found, 60 never; at its weakest it is worth 10
    already, and less than that it cannot be."""
    runs, model = growing(lambda times: 10.0 * times**2, most=2.0, least=1.0)
    assert _times(runs, model, 30.0, 1.0) == pytest.approx(np.sqrt(3.0), rel=AGREES)
    assert np.isnan(_times(runs, model, 60.0, 1.0))
    assert _times(runs, model, 5.0, 1.0) == 1.0
    assert np.isnan(_times(*growing(lambda times: 0.0), 60.0, 1.0))


def test_one_strength_leads_to_the_next() -> None:
    runs, model = growing(lambda times: 10.0 * times**2)
    asked: list[float] = []
    plain = runs.change

    def counting(of: Any, times: float) -> Array:
        asked.append(times)
        found: Array = plain(of, times)
        return found

    runs.change = counting
    found = _found(runs, model, [40.0, 90.0], 2.0)
    assert found == pytest.approx([2.0, 3.0], rel=1e-6)
    # Each at the first look: from the one the other is known.
    assert asked == pytest.approx([2.0, 3.0])
    # From where the first was found, not from where it was looked for.
    asked.clear()
    assert _found(runs, model, [22.5, 40.0], 2.0) == pytest.approx([1.5, 2.0])
    assert asked == pytest.approx([2.0, 1.5, 2.0])
    bounded, short = growing(lambda times: 10.0 * times**2, most=2.5)
    both = _found(bounded, short, [40.0, 90.0])
    assert both[0] == pytest.approx(2.0, rel=AGREES)
    assert np.isnan(both[1])
    # Where the first never is, the next is looked for from where that one was.
    lower, low = growing(lambda times: 10.0 * times**2, most=1.0)
    plain, lower.change = lower.change, counting
    asked.clear()
    assert np.isnan(_found(lower, low, [40.0, 90.0], 0.8)).all()
    assert asked == pytest.approx([0.8, 2.0, 1.2])


def test_a_tenth_of_it_is_as_much_where_it_is_as_weak_as_can_be() -> None:
    _, model = growing(lambda times: times, least=1.0)
    assert _weakest(model, 1.0)
    assert not _weakest(model, 20.0)
    assert not _weakest(model, np.nan)
    _, free = growing(lambda times: times)
    assert not _weakest(free, 1.0)


def test_an_effect_has_one_parameter_at_least() -> None:
    def of(count: int, free: int) -> int:
        model: Any = SimpleNamespace(problem=SimpleNamespace(open=range(count)))
        base: Any = SimpleNamespace(free=free)
        return _parameters(base, model)

    assert of(6, 3) == 3
    assert of(4, 3) == 1
    assert of(3, 3) == 1


@pytest.mark.parametrize("chance", [0.8, 0.95])
@pytest.mark.parametrize("parameters", [1, 3])
def test_non_centralities_are_those_of_chi_squares(parameters: int, chance: float) -> None:
    for price in (10.0, 30.0, 400.0):
        found = non_centrality(price, parameters, chance)
        assert stats.ncx2.sf(price, parameters, found) == pytest.approx(chance, abs=1e-4)
    # Of what chance nearly always gives, next to nothing is asked.
    least = stats.chi2.isf(chance - 0.01, parameters)
    found = non_centrality(least, parameters, chance)
    assert found < 1.0
    assert stats.ncx2.sf(least, parameters, found) == pytest.approx(chance, abs=1e-4)
    # Of gains that count in full or by a quarter, each as likely.
    found = non_centrality(30.0, parameters, chance, (1.0, 0.25))
    whole, less = (stats.ncx2.sf(p, parameters, found) for p in (30.0, 120.0))
    assert 0.5 * (whole + less) == pytest.approx(chance, abs=1e-4)


# ---- what stands in its place ------------------------------------------------------------------


def change(way: Array) -> Change:
    shown = way[:, None]
    found = Change([shown], None, shown)
    assert found.span == pytest.approx(spanned(shown))
    return found


PRICE = 30.0


@pytest.fixture(autouse=True)
def _straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """No effect here moves jumps: what one changes grows in proportion."""
    monkeypatch.setattr(module, "_change", lambda runs, model, times: None)


def of(
    along: float,
    times: float = 0.5,
    price: float = PRICE,
    dearer: float = 0.0,
    growth: float = 1.5,
) -> tuple[Power, float]:
    """The power of an effect that is seen at so many times its strength, beside a rival that has
    so much of its direction; and what the rival leaves."""
    size = np.sqrt(non_centrality(price, 1, 0.8))
    first = np.repeat([1.0, 0.0], 200)
    second = np.repeat([0.0, 1.0], 200)
    unit = np.sqrt(200.0)
    own = change(size * first / unit)
    rival = change(size * (along * first + np.sqrt(1.0 - along**2) * second) / unit)
    base: Any = SimpleNamespace(free=3)
    runs: Any = SimpleNamespace(base=base)

    def level_price(parameters: int, samples: int) -> float:
        return price + dearer * (parameters - 1)

    candidates: Any = SimpleNamespace(
        policy=SimpleNamespace(tie=8.0),
        level=SimpleNamespace(price=level_price),
        campaign=SimpleNamespace(samples=SimpleNamespace(count=1000)),
    )
    page = SimpleNamespace(name="F_d_n", unit="N")
    models: Any = {
        name: SimpleNamespace(
            problem=SimpleNamespace(open=range(count)),
            values=lambda factor: np.array([9.0, 4.0 * factor]),
            which=1,
            page=page,
            name=name,
        )
        for name, count in (("own", 4), ("rival", 4 if dearer == 0.0 else 5))
    }
    seen = {
        "own": _Seen((times, growth * times), own, 0.07),
        "rival": _Seen((1.0, 1.5), rival, 0.2),
    }
    return _power(candidates, runs, models, seen, "own"), left_apart(own, rival, runs)


def test_an_effect_that_no_rival_comes_near_is_named_where_it_is_found() -> None:
    found, left = of(0.0)
    assert left == pytest.approx(np.sqrt(non_centrality(PRICE, 1, 0.8)))
    assert (found.effect, found.parameter, found.unit) == ("own", "F_d_n", "N")
    # Half and three quarters of 4 N.
    assert (found.found_80, found.found_95) == (2.0, 3.0)
    assert found.share_80 == 0.07
    assert found.like == ()
    assert found.alone_80 is not None
    assert found.alone_80 == pytest.approx(2.0, rel=0.1)
    assert not found.hidden
    assert not found.always
    told = found.to_dict()
    assert told["like"] == []
    assert told["found_80"] == 2.0


def test_a_rival_that_is_like_it_asks_for_more() -> None:
    found, left = of(0.95)
    assert chance_apart(left, 8.0) < 0.8
    assert found.like == ("rival",)
    assert found.alone_80 is not None
    assert found.alone_80 > 1.2 * 2.0
    one, _ = of(1.0)
    assert one.alone_80 is None
    assert one.like == ("rival",)


def test_a_rival_that_costs_more_need_be_beaten_by_less() -> None:
    """With a price of 6 more than its tie of 8 only 2 are left, a quarter at least."""
    plain, dear = of(0.9)[0], of(0.9, dearer=4.0)[0]
    assert plain.alone_80 is not None
    assert dear.alone_80 is not None
    assert dear.alone_80 < plain.alone_80
    assert of(0.9, dearer=6.0)[0].alone_80 == of(0.9, dearer=60.0)[0].alone_80


def test_what_is_never_found_is_hidden_and_has_no_strength() -> None:
    found, _ = of(0.5, times=np.nan)
    assert (found.found_80, found.found_95, found.alone_80, found.share_80) == (None,) * 4
    assert found.hidden
    assert found.like == ()
    # One that is never found in 95 of 100 is found in 80.
    some, _ = of(0.0, growth=np.nan)
    assert (some.found_80, some.found_95, some.share_80) == (2.0, None, 0.07)
    assert some.alone_80 is not None
    # At the usual strength it is found, above it is hidden.
    assert not of(0.0, times=1.0)[0].hidden
    assert of(0.0, times=1.01)[0].hidden


def test_a_rival_that_moves_jumps_is_looked_at_where_the_effect_is_stronger(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Both at twice the strength at which each is found, of which half is what it leaves of the
    effect as it was; one that is never found at twice its usual one."""
    asked: list[Any] = []

    def left(own: Any, rival: Any, runs: Any) -> float:
        asked.append((own, rival))
        return 12.0

    monkeypatch.setattr(module, "_change", lambda runs, model, times: (model, times))
    monkeypatch.setattr(module, "left_apart", left)
    jumps, none = SimpleNamespace(shares=[np.ones(3)]), SimpleNamespace(shares=None)
    seen: Any = {
        "own": SimpleNamespace(times=(0.5, 1.0), change=none),
        "straight": SimpleNamespace(times=(7.0, 9.0), change=none),
        "late": SimpleNamespace(times=(3.0, 4.0), change=jumps),
        "never": SimpleNamespace(times=(np.nan, np.nan), change=jumps),
    }
    models: Any = {name: name for name in seen}
    asks = {"straight": 8.0, "late": 2.0, "never": 5.0}
    nobody: Any = None
    found = _further(nobody, models, seen, "own", 2.0, asks)
    assert found == {"late": (6.0, 2.0), "never": (6.0, 5.0)}
    assert asked == [(("own", 1.0), ("late", 6.0)), (("own", 1.0), ("never", 2.0))]
    # Of one that moves jumps itself all are.
    seen["own"].change = jumps
    assert set(_further(nobody, models, seen, "own", 2.0, asks)) == set(asks)


@pytest.mark.parametrize(("share", "looks"), [(1.0, 1), (0.99, 1), (0.7, LOOKS_ALONE)])
def test_it_is_looked_further_until_the_strength_settles(
    share: float, looks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each look leaves so much of what the last one did; three at most."""
    assert LOOKS_ALONE == 3
    asked: list[float] = []

    def further(
        runs: Any, models: Any, seen: Any, name: str, times: float, asks: dict[str, float]
    ) -> dict[str, tuple[float, float]]:
        asked.append(times)
        left = left_apart(seen["own"].change, seen["rival"].change, runs)
        return {"rival": (left * share ** len(asked), asks["rival"])}

    monkeypatch.setattr(module, "_further", further)
    found, _ = of(0.9)
    assert len(asked) == looks
    # Stronger each time, as less is left.
    assert asked == sorted(asked)
    assert found.alone_80 is not None
    assert (found.alone_80 > 2.0 * asked[0] * (1.0 + AGREES)) == (looks > 1)
    # Of one that no rival comes near nothing more is asked.
    asked.clear()
    of(0.0)
    assert asked == []
