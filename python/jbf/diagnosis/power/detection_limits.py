"""Detection limits of effects in the present runs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.power.distinction import (
    Change,
    bounded_square,
    detection_probability,
    distinction_factor,
    distinction_probability,
    distinguishable_size,
)
from jbf.diagnosis.power.strength import PresentRuns, Strength, strength_of
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.solution import Solution
from jbf.models.catalogue import can_be_added

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]

LEVELS = (0.80, 0.95)
"""Detection probabilities for which a strength is computed. It enters no verdict."""
MOST_STRENGTHS = 14
"""Largest number of strengths evaluated for each. It limits the effort only."""
EXPONENTS = (1.0, 8.0)
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
MOST_ITERATIONS = 3
"""Iterations of the distinguishable strength for effects that move jumps.

It limits the effort only.
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
    wanted = set(candidates.names if names is None else names) - set(present)
    runs = PresentRuns(candidates, present)
    models = {
        name: model
        for name in candidates.names
        if name not in present and can_be_added(name, present)
        if (model := strength_of(candidates, present, name)) is not None
    }
    limits = in_parallel(
        lambda model: _Detectable.of(candidates, runs, model),
        list(models.values()),
        fits_at_once(candidates.campaign, candidates.law, candidates.names),
    )
    detectable = dict(zip(models, limits, strict=True))
    return tuple(
        _power(candidates, runs, models, detectable, name) for name in models if name in wanted
    )


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
    def of(cls, candidates: Candidates, runs: PresentRuns, model: Strength) -> _Detectable:
        parameters = _parameters(runs.base, model)
        price = price_of(candidates, parameters)
        discounts = runs.discounts(runs.unexplained(runs.change(model, 1.0))[:, 0])
        least = [non_centrality(price, parameters, p, discounts) for p in LEVELS]
        times = _required_multiples(runs, model, least)
        if np.isfinite(times[1]):
            share = runs.share_after_noise_refit(runs.change(model, BEYOND * times[1]))
            if share < NEARLY_ALL:
                near = _finite_or_one(times[0]) / float(np.sqrt(share))
                times = _required_multiples(runs, model, [wanted / share for wanted in least], near)
        at = _finite_or_one(times[0])
        size = runs.samples.rms(runs.change(model, at)) / max(runs.friction, 1e-300)
        return cls(tuple(times), Change.of(runs, model, at), size)


def _finite_or_one(times: float) -> float:
    return times if np.isfinite(times) else 1.0


def _required_multiples(
    runs: PresentRuns, model: Strength, least: list[float], near: float = 1.0
) -> list[float]:
    """Multiples of the usual strength that give each of the required non-centralities."""
    multiples, times, last = [], near, least[0]
    for wanted in least:
        # The non-centrality is nearly proportional to the square of the strength.
        times = _times(runs, model, wanted, times * float(np.sqrt(wanted / last)))
        multiples.append(times)
        times, last = (times, wanted) if np.isfinite(times) else (near, least[0])
    return multiples


def _parameters(base: Solution, model: Strength) -> int:
    return max(len(model.problem.open) - base.free, 1)


@lru_cache(maxsize=64)
def non_centrality(
    price: float, parameters: int, chance: float, discounts: tuple[float, ...] = (1.0,)
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
    discounts
        Factors on the gain, 0 to 1, each equally likely.
    """
    prices = price / np.array(discounts)

    def surplus(root: float) -> float:
        return float(np.mean(detection_probability(prices, parameters, root**2))) - chance

    top = float(np.sqrt(np.max(prices))) + 10.0
    return float(optimize.brentq(surplus, 1e-3, top)) ** 2


def _times(runs: PresentRuns, model: Strength, wanted: float, times: float) -> float:
    """Multiple of the usual strength that gives a required non-centrality; nan where none does.

    The search assumes a power law, at first of exponent two and then as observed between successive
    strengths. Where the non-centrality rises abruptly (a lag within a sample has no effect) the
    search bisects between too small and sufficient strengths.
    """
    too_small, sufficient = 0.0, np.inf
    exponent, before = 2.0, None
    for _ in range(MOST_STRENGTHS):
        reached = max(bounded_square(runs.unexplained(runs.change(model, times))), 1e-300)
        if before is not None and reached != before[1] and times != before[0]:
            # Exponent observed between the last two strengths.
            growth = np.log(reached / before[1]) / np.log(times / before[0])
            exponent = float(np.clip(growth, *EXPONENTS))
        before = (times, reached)
        further = float(np.clip((wanted / reached) ** (1.0 / exponent), 1e-3, 30.0))
        if abs(np.log(further)) < AGREES:
            return times * further
        # At a bound the strength cannot increase.
        if np.array_equal(model.values(times * further), model.values(times)):
            return times if further < 1.0 else np.nan
        if further > 1.0:
            too_small = max(too_small, times)
        else:
            sufficient = min(sufficient, times)
        if sufficient < too_small * (1.0 + AGREES):
            return sufficient
        times *= further
        if not too_small < times < sufficient:
            times = float(np.sqrt(too_small * sufficient))
    if np.isfinite(sufficient):
        return sufficient
    return times if reached > 0.5 * wanted else np.nan


def _power(
    candidates: Candidates,
    runs: PresentRuns,
    models: dict[str, Strength],
    detectable: dict[str, _Detectable],
    name: str,
) -> Power:
    """Power for one effect, relative to the changes of all other effects."""
    model, effect = models[name], detectable[name]

    def strength(times: float) -> float | None:
        return float(model.values(times)[model.which]) if np.isfinite(times) else None

    factor, confounded = np.inf, []
    if np.isfinite(effect.times[0]):
        parameters, tie = _parameters(runs.base, model), candidates.policy.selection.tie
        price = price_of(candidates, parameters)
        rivals: dict[str, tuple[float, float]] = {}
        for other, rival in detectable.items():
            if other != name:
                dearer = price - price_of(candidates, _parameters(runs.base, models[other]))
                least = max(tie + dearer, 0.25 * tie)
                rivals[other] = (distinguishable_size(effect.change, rival.change, runs), least)
        chances = {other: distinction_probability(*rival) for other, rival in rivals.items()}
        confounded = sorted(
            (o for o, chance in chances.items() if chance < LEVELS[0]), key=chances.__getitem__
        )
        threshold = (price, parameters, non_centrality(price, parameters, LEVELS[0]))
        factor = distinction_factor(*threshold, rivals, LEVELS[0])
        for _ in range(MOST_ITERATIONS):
            if not 1.0 + AGREES < factor < np.inf:
                break
            before = factor
            least_gains = {rival: rivals[rival][1] for rival in confounded}
            rivals |= _rivals_at(runs, models, detectable, name, factor, least_gains)
            factor = distinction_factor(*threshold, rivals, LEVELS[0])
            if abs(np.log(factor / before)) < AGREES:
                break
    return Power(
        effect=name,
        parameter=model.page.name,
        unit=model.page.unit,
        detectable_80=strength(effect.times[0]),
        detectable_95=strength(effect.times[1]),
        always=_weakest(model, effect.times[0]),
        share_80=effect.share if np.isfinite(effect.times[0]) else None,
        distinguishable_80=strength(effect.times[0] * factor) if np.isfinite(factor) else None,
        confounded_with=tuple(confounded),
        hidden=not effect.times[0] <= 1.0,
    )


def _rivals_at(
    runs: PresentRuns,
    models: dict[str, Strength],
    detectable: dict[str, _Detectable],
    name: str,
    factor: float,
    rivals: dict[str, float],
) -> dict[str, tuple[float, float]]:
    """Compare rivals again at a multiple of the detectable strength of an effect.

    Only pairs are considered in which one effect moves jumps, so that changes are not proportional
    to the strength.

    Parameters
    ----------
    rivals
        Required difference of the gains, by rival.

    Returns
    -------
    dict
        For each rival, the unexplained part per unit of strength and the required difference of the
        gains.
    """
    effect, compared = detectable[name], {}
    change = Change.of(runs, models[name], factor * effect.times[0])
    for other, least in rivals.items():
        rival = detectable[other]
        if effect.change.shares is None and rival.change.shares is None:
            continue
        rival_change = Change.of(runs, models[other], factor * _finite_or_one(rival.times[0]))
        compared[other] = (distinguishable_size(change, rival_change, runs) / factor, least)
    return compared


def _weakest(model: Strength, times: float) -> bool:
    return bool(
        np.isfinite(times) and np.array_equal(model.values(0.1 * times), model.values(times))
    )
