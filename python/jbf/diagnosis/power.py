"""Power: strength from which an effect is detectable in runs like these.

An effect of given strength changes the friction. The law's own parameters can reproduce a part of
this change. The sum of squares of the other part, in units of the noise variance, is the
non-centrality of the likelihood ratio (Wald 1943). The power of the test is the probability that
the likelihood ratio exceeds the threshold. The part that another effect can also reproduce does not
help to distinguish the two.

The change is evaluated at each strength and not extrapolated from the null; the rest of the model
is linearised.
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
    bounded_square,
    detection_probability,
    distinction_factor,
    distinction_probability,
    distinguishable_size,
)
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.side_by_side import parallel_fits, side_by_side
from jbf.diagnosis.strength import RunsAtHand, Strength, strength_of
from jbf.estimation.solution import Solution
from jbf.models.catalogue import can_be_added

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]

LEVELS = (0.80, 0.95)
"""Detection probabilities for which a strength is computed. It enters no verdict."""
LOOKS = 14
"""Largest number of strengths evaluated for each. It limits the effort only."""
POWERS = (1.0, 8.0)
"""Range of the exponents with which the non-centrality may grow with strength.

It bounds a search only.
"""
AGREES = 0.05
"""Relative difference in strength at which the search ends; the power law gives the rest.

It is a numerical tolerance.
"""
NEARLY_ALL = 0.97
"""Share of the gain above which a refitted noise model is considered to absorb no part of it.

It enters no verdict.
"""
BEYOND = 1.2
"""Factor on the strength at which that share is evaluated.

It avoids a strength at which the colour of the noise just reaches its threshold. It enters no
verdict.
"""
LOOKS_ALONE = 3
"""Iterations of the distinguishable strength for effects that move jumps.

It limits the effort only.
"""
FURTHER = 2.0
"""Factor on the detectable strength at which a rival is also evaluated.

The shape of its change is different there where it is not proportional to the strength. It enters
no verdict.
"""


@dataclass(frozen=True)
class Power:
    """Power of runs like these for one effect.

    Attributes
    ----------
    effect, parameter, unit
        The effect, the parameter whose distance from its null is its strength, and its unit.
    detectable_80, detectable_95
        Parameter value from which the effect is detected with 80 % and 95 % power; None where no
        value within its bounds is detected.
    always
        True for an effect that is detectable at any strength (a contact that holds at rest): the
        values are the weakest of the catalogue.
    share_80
        RMS change of the friction at `detectable_80`, as a share of the friction's RMS.
    distinguishable_80
        Parameter value from which, with 80 % power, the effect is detected and no other effect fits
        as well; None where it is always confounded.
    confounded_with
        Effects with which it is confounded at `detectable_80`, the least distinguishable first.
    hidden
        True where an effect of the catalogue's usual strength would be detected with less than 80 %
        power.
    """

    effect: str
    parameter: str
    unit: str
    detectable_80: float | None
    detectable_95: float | None
    always: bool
    share_80: float | None
    distinguishable_80: float | None
    confounded_with: Names
    hidden: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {**vars(self), "confounded_with": list(self.confounded_with)}


def power(
    candidates: Candidates, present: Names, names: Iterable[str] | None = None
) -> tuple[Power, ...]:
    """Power of these runs for each effect that is not in the model.

    Parameters
    ----------
    candidates
        The runs, and the fit of the effects that are in the model.
    present
        Effects of the model.
    names
        Effects to evaluate; by default all that were tried.
    """
    asked = set(candidates.names if names is None else names) - set(present)
    runs = RunsAtHand(candidates, present)
    models = {
        name: model
        for name in candidates.names
        if name not in present and can_be_added(name, present)
        if (model := strength_of(candidates, present, name)) is not None
    }
    found = side_by_side(
        lambda model: _Detectable.of(candidates, runs, model),
        list(models.values()),
        parallel_fits(candidates.campaign, candidates.law, candidates.names),
    )
    seen = dict(zip(models, found, strict=True))
    return tuple(_power(candidates, runs, models, seen, name) for name in models if name in asked)


@dataclass(frozen=True)
class _Detectable:
    """Detectable strength of an effect, in multiples of its usual strength, and its change there.

    Attributes
    ----------
    times
        One for each of `LEVELS`; nan where no strength is sufficient.
    change
        Change of the record at the first strength, and at `FURTHER` times that strength.
    share
        RMS change of the friction, as a share of the friction's RMS.
    """

    times: tuple[float, ...]
    change: Change
    share: float

    @classmethod
    def of(cls, candidates: Candidates, runs: RunsAtHand, model: Strength) -> _Detectable:
        price = price_of(candidates, _parameters(runs.base, model))
        counts = runs.counts(runs.shown(runs.change(model, 1.0))[:, 0])
        parameters = _parameters(runs.base, model)
        least = [non_centrality(price, parameters, p, counts) for p in LEVELS]
        found = _required_multiples(runs, model, least)
        if np.isfinite(found[1]):
            left = runs.share_after_noise_refit(runs.change(model, BEYOND * found[1]))
            if left < NEARLY_ALL:
                near = (found[0] if np.isfinite(found[0]) else 1.0) / float(np.sqrt(left))
                found = _required_multiples(runs, model, [wanted / left for wanted in least], near)
        at = found[0] if np.isfinite(found[0]) else 1.0
        share = runs.samples.rms(runs.change(model, at)) / max(runs.friction, 1e-300)
        return cls(tuple(found), _change(runs, model, at), share)


def _required_multiples(
    runs: RunsAtHand, model: Strength, least: list[float], near: float = 1.0
) -> list[float]:
    """Multiples of the usual strength that give each of the required non-centralities."""
    found, times, last = [], near, least[0]
    for wanted in least:
        # The non-centrality is nearly proportional to the square of the strength.
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
    """Non-centrality at which a chi-square variable exceeds a threshold with given probability.

    Parameters
    ----------
    price
        The threshold.
    parameters
        Degrees of freedom.
    chance
        The probability.
    counts
        Factors on the gain, 0 to 1, each equally likely.
    """
    prices = price / np.array(counts)

    def surplus(root: float) -> float:
        return float(np.mean(detection_probability(prices, parameters, root**2))) - chance

    top = float(np.sqrt(np.max(prices))) + 10.0
    return float(optimize.brentq(surplus, 1e-3, top)) ** 2


def _times(runs: RunsAtHand, model: Strength, wanted: float, times: float) -> float:
    """Multiple of the usual strength that gives a required non-centrality; nan where none does.

    The search assumes a power law, at first of exponent two and then as observed between successive
    strengths. Where the non-centrality rises abruptly (a lag within a sample has no effect) the
    search bisects between too small and sufficient strengths.
    """
    little, enough = 0.0, np.inf
    power, before = 2.0, None
    for _ in range(LOOKS):
        told = max(bounded_square(runs.shown(runs.change(model, times))), 1e-300)
        if before is not None and told != before[1] and times != before[0]:
            # Exponent observed between the last two strengths.
            grown = np.log(told / before[1]) / np.log(times / before[0])
            power = float(np.clip(grown, *POWERS))
        before = (times, told)
        further = float(np.clip((wanted / told) ** (1.0 / power), 1e-3, 30.0))
        if abs(np.log(further)) < AGREES:
            return times * further
        # At a bound the strength cannot increase.
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
    """Change by an effect at one strength and at `FURTHER` times it, and its derivatives."""
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
    seen: dict[str, _Detectable],
    name: str,
) -> Power:
    """Power for one effect, relative to the changes of all other effects."""
    model, own = models[name], seen[name]

    def strength(times: float) -> float | None:
        return float(model.values(times)[model.which]) if np.isfinite(times) else None

    most, confounded = np.inf, []
    if np.isfinite(own.times[0]):
        parameters, tie = _parameters(runs.base, model), candidates.policy.selection.tie
        price = price_of(candidates, parameters)
        rivals: dict[str, tuple[float, float]] = {}
        for other, rival in seen.items():
            if other != name:
                dearer = price - price_of(candidates, _parameters(runs.base, models[other]))
                least = max(tie + dearer, 0.25 * tie)
                rivals[other] = (distinguishable_size(own.change, rival.change, runs), least)
        told = {other: distinction_probability(*rival) for other, rival in rivals.items()}
        confounded = sorted(
            (o for o, chance in told.items() if chance < LEVELS[0]), key=told.__getitem__
        )
        found = (price, parameters, non_centrality(price, parameters, LEVELS[0]))
        most = distinction_factor(*found, rivals, LEVELS[0])
        for _ in range(LOOKS_ALONE):
            if not 1.0 + AGREES < most < np.inf:
                break
            before = most
            costs = {rival: rivals[rival][1] for rival in confounded}
            rivals |= _further(runs, models, seen, name, most, costs)
            most = distinction_factor(*found, rivals, LEVELS[0])
            if abs(np.log(most / before)) < AGREES:
                break
    return Power(
        effect=name,
        parameter=model.page.name,
        unit=model.page.unit,
        detectable_80=strength(own.times[0]),
        detectable_95=strength(own.times[1]),
        always=_weakest(model, own.times[0]),
        share_80=own.share if np.isfinite(own.times[0]) else None,
        distinguishable_80=strength(own.times[0] * most) if np.isfinite(most) else None,
        confounded_with=tuple(confounded),
        hidden=not own.times[0] <= 1.0,
    )


def _further(
    runs: RunsAtHand,
    models: dict[str, Strength],
    seen: dict[str, _Detectable],
    name: str,
    times: float,
    rivals: dict[str, float],
) -> dict[str, tuple[float, float]]:
    """Re-evaluate rivals at a larger strength of an effect.

    Only pairs are considered in which one effect moves jumps, so that changes are not proportional
    to the strength.

    Returns
    -------
    dict
        For each rival, the unexplained part per unit of strength and the required difference of the
        gains.
    """
    own, again = seen[name], {}
    there = _change(runs, models[name], times * own.times[0])
    for other, least in rivals.items():
        rival = seen[other]
        if own.change.shares is None and rival.change.shares is None:
            continue
        at = rival.times[0] if np.isfinite(rival.times[0]) else 1.0
        left = distinguishable_size(there, _change(runs, models[other], times * at), runs)
        again[other] = (left / times, least)
    return again


def _weakest(model: Strength, times: float) -> bool:
    return bool(
        np.isfinite(times) and np.array_equal(model.values(0.1 * times), model.values(times))
    )
