"""Power: how strong an effect must be for runs like these to show it.

An effect of some strength changes the friction by what the law's own parameters cannot make up for;
that, in squares of the noise, is the non-centrality of the likelihood ratio (Wald 1943), and the
chance that it exceeds the price of a name is the test's power. What another effect makes up for as
well is lost for telling the two apart.

Strengths are followed to where they are asked for, not extrapolated from the null; the rest of the
model moves in its tangent.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.diagnosis.alone import (
    Change,
    chance_apart,
    chance_found,
    left_apart,
    times_alone,
    worth,
)
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.side_by_side import fits_at_once, side_by_side
from jbf.diagnosis.strength import RunsAtHand, Strength, strength_of
from jbf.estimation.solution import Solution
from jbf.models.catalogue import may_come

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]

LEVELS = (0.80, 0.95)
"""Chances of being found."""
LOOKS = 14
"""Strengths tried for each."""
POWERS = (1.0, 8.0)
"""Powers of its strength with which what an effect is worth may grow."""
AGREES = 0.05
"""Relative difference in strength up to which one looks no more: how it grows says the rest."""
NEARLY_ALL = 0.97
"""Share of a gain from which on a noise that is described anew forgives nothing of it."""
BEYOND = 1.2
"""Times the strength at which that is asked: where colour just earns its price, chance decides."""
LOOKS_ALONE = 3
"""Times that strengths are tried at which an effect that moves jumps would be told from another."""
FURTHER = 2.0
"""Times the strength at which it is found at which a rival is looked at, too: its change has
another shape there where it does not grow in proportion."""


@dataclass(frozen=True)
class Power:
    """What runs like these show of one effect.

    Attributes
    ----------
    effect, parameter, unit
        The effect, the parameter whose distance from its null is its strength, and that one's unit.
    found_80, found_95
        The parameter's value from which the effect is found in 80 and in 95 of 100 such campaigns;
        None where no value within its bounds would be.
    always
        True of an effect that shows however weak it is (a contact that holds at rest): the values
        are the weakest of the catalogue.
    share_80
        By how much of the friction, RMS, it changes it there.
    alone_80
        The value from which, in 80 of 100 such campaigns, it is found and no other effect could
        stand in its place; None where one always could.
    like
        Effects that could stand in its place at `found_80`, those that need the most to part first.
    hidden
        True where it could be there at the catalogue's usual strength and not be found in 80 of 100
        such campaigns.
    """

    effect: str
    parameter: str
    unit: str
    found_80: float | None
    found_95: float | None
    always: bool
    share_80: float | None
    alone_80: float | None
    like: Names
    hidden: bool = False

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {**vars(self), "like": list(self.like)}


def power(
    candidates: Candidates, present: Names, names: Iterable[str] | None = None
) -> tuple[Power, ...]:
    """What these runs would have shown of each effect that is not in the model.

    Parameters
    ----------
    candidates
        The runs, and the fit of the effects that are in the model.
    present
        Those effects.
    names
        Effects asked for; all that were tried by default.
    """
    asked = set(candidates.names if names is None else names) - set(present)
    runs = RunsAtHand(candidates, present)
    models = {
        name: model
        for name in candidates.names
        if name not in present and may_come(name, present)
        if (model := strength_of(candidates, present, name)) is not None
    }
    found = side_by_side(
        lambda model: _Seen.of(candidates, runs, model),
        list(models.values()),
        fits_at_once(candidates.campaign, candidates.law, candidates.names),
    )
    seen = dict(zip(models, found, strict=True))
    return tuple(_power(candidates, runs, models, seen, name) for name in models if name in asked)


@dataclass(frozen=True)
class _Seen:
    """How many times its usual strength an effect is found at, and what is seen of it there.

    Attributes
    ----------
    times
        Of each of `LEVELS`; nan where no strength is enough.
    change
        Of the first; and when it is `FURTHER` stronger.
    share
        How much of the friction it changes, RMS.
    """

    times: tuple[float, ...]
    change: Change
    share: float

    @classmethod
    def of(cls, candidates: Candidates, runs: RunsAtHand, model: Strength) -> _Seen:
        price = price_of(candidates, _parameters(runs.base, model))
        counts = runs.counts(runs.shown(runs.change(model, 1.0))[:, 0])
        parameters = _parameters(runs.base, model)
        least = [non_centrality(price, parameters, p, counts) for p in LEVELS]
        found = _found(runs, model, least)
        if np.isfinite(found[1]):
            left = runs.not_forgiven(runs.change(model, BEYOND * found[1]))
            if left < NEARLY_ALL:
                near = (found[0] if np.isfinite(found[0]) else 1.0) / float(np.sqrt(left))
                found = _found(runs, model, [wanted / left for wanted in least], near)
        at = found[0] if np.isfinite(found[0]) else 1.0
        share = runs.samples.rms(runs.change(model, at)) / max(runs.friction_n, 1e-300)
        return cls(tuple(found), _change(runs, model, at), share)


def _found(runs: RunsAtHand, model: Strength, least: list[float], near: float = 1.0) -> list[float]:
    """How many times its usual strength an effect has that is worth so much, of each."""
    found, times, last = [], near, least[0]
    for wanted in least:
        # What an effect is worth grows as its square, nearly.
        times = _times(runs, model, wanted, times * float(np.sqrt(wanted / last)))
        found.append(times)
        times, last = (times, wanted) if np.isfinite(times) else (near, least[0])
    return found


def _parameters(base: Solution, model: Strength) -> int:
    return max(len(model.problem.open) - base.free, 1)


@lru_cache(maxsize=64)
def non_centrality(
    price: float, parameters: int, chance: float, counts: tuple[float, ...] = (1.0,)
) -> float:
    """The non-centrality with which a chi-square of so many parameters exceeds a price so often.

    Parameters
    ----------
    counts
        By how much it may count, 0 to 1, each as likely.
    """
    prices = price / np.array(counts)

    def lacking(root: float) -> float:
        return float(np.mean(chance_found(prices, parameters, root**2))) - chance

    top = float(np.sqrt(np.max(prices))) + 10.0
    return float(optimize.brentq(lacking, 1e-3, top)) ** 2


def _times(runs: RunsAtHand, model: Strength, wanted: float, times: float) -> float:
    """How many times its usual strength an effect has that is worth so much; nan where none is.

    What an effect is worth grows as its square, nearly, or as it did from one look to the next;
    where it grows all at once (a lag within a sample shows nothing) the search halves what is left
    between too little and enough.
    """
    little, enough = 0.0, np.inf
    power, before = 2.0, None
    for _ in range(LOOKS):
        told = max(worth(runs.shown(runs.change(model, times))), 1e-300)
        if before is not None and told != before[1] and times != before[0]:
            # As it grew from the last strength to this one.
            grown = np.log(told / before[1]) / np.log(times / before[0])
            power = float(np.clip(grown, *POWERS))
        before = (times, told)
        further = float(np.clip((wanted / told) ** (1.0 / power), 1e-3, 30.0))
        if abs(np.log(further)) < AGREES:
            return times * further
        # At a bound there is no more to be had.
        if np.array_equal(model.values(times * further), model.values(times)):
            return times if further < 1.0 else np.nan
        if further > 1.0:
            little = max(little, times)
        else:
            enough = min(enough, times)
        if enough < little * (1.0 + AGREES):
            return enough
        times *= further
        if not little < times < enough:
            times = float(np.sqrt(little * enough))
    if np.isfinite(enough):
        return enough
    return times if told > 0.5 * wanted else np.nan


def _change(runs: RunsAtHand, model: Strength, times: float) -> Change:
    """What an effect changes, there and further on, and what its parameters change."""
    problem, values = model.problem.thinned, model.values(times)
    shares, now = runs.shares(model, times), runs.change(model, times)
    own = [i for i in problem.open if problem.names[i].startswith(f"{model.name}.")]
    _, slopes = problem.linearise(values, by=own)
    if shares is not None:
        slopes = [j * s[:, None] for j, s in zip(slopes, shares, strict=True)]
    further = runs.change(model, FURTHER * times)
    ways = [np.column_stack(parts) for parts in zip(now, further, slopes, strict=True)]
    return Change(ways, shares, runs.shown(ways))


def _power(
    candidates: Candidates,
    runs: RunsAtHand,
    models: dict[str, Strength],
    seen: dict[str, _Seen],
    name: str,
) -> Power:
    """The power of one effect, beside what each other one changes."""
    model, own = models[name], seen[name]

    def strength(times: float) -> float | None:
        return float(model.values(times)[model.which]) if np.isfinite(times) else None

    most, like = np.inf, []
    if np.isfinite(own.times[0]):
        parameters, tie = _parameters(runs.base, model), candidates.policy.tie
        price = price_of(candidates, parameters)
        rivals: dict[str, tuple[float, float]] = {}
        for other, rival in seen.items():
            if other != name:
                dearer = price - price_of(candidates, _parameters(runs.base, models[other]))
                least = max(tie + dearer, 0.25 * tie)
                rivals[other] = (left_apart(own.change, rival.change, runs), least)
        told = {other: chance_apart(*rival) for other, rival in rivals.items()}
        like = sorted((o for o, chance in told.items() if chance < LEVELS[0]), key=told.__getitem__)
        found = (price, parameters, non_centrality(price, parameters, LEVELS[0]))
        most = times_alone(*found, rivals, LEVELS[0])
        for _ in range(LOOKS_ALONE):
            if not 1.0 + AGREES < most < np.inf:
                break
            before = most
            rivals |= _further(runs, models, seen, name, most, {o: rivals[o][1] for o in like})
            most = times_alone(*found, rivals, LEVELS[0])
            if abs(np.log(most / before)) < AGREES:
                break
    return Power(
        effect=name,
        parameter=model.page.name,
        unit=model.page.unit,
        found_80=strength(own.times[0]),
        found_95=strength(own.times[1]),
        always=_weakest(model, own.times[0]),
        share_80=own.share if np.isfinite(own.times[0]) else None,
        alone_80=strength(own.times[0] * most) if np.isfinite(most) else None,
        like=tuple(like),
        hidden=not own.times[0] <= 1.0,
    )


def _further(
    runs: RunsAtHand,
    models: dict[str, Strength],
    seen: dict[str, _Seen],
    name: str,
    times: float,
    rivals: dict[str, float],
) -> dict[str, tuple[float, float]]:
    """What rivals leave of an effect that is so many times as strong, of what it is once, and by
    how much it must gain more: of those that do not grow in proportion, since jumps move."""
    own, again = seen[name], {}
    there = _change(runs, models[name], times * own.times[0])
    for other, least in rivals.items():
        rival = seen[other]
        if own.change.shares is None and rival.change.shares is None:
            continue
        at = rival.times[0] if np.isfinite(rival.times[0]) else 1.0
        left = left_apart(there, _change(runs, models[other], times * at), runs)
        again[other] = (left / times, least)
    return again


def _weakest(model: Strength, times: float) -> bool:
    return bool(
        np.isfinite(times) and np.array_equal(model.values(0.1 * times), model.values(times))
    )
