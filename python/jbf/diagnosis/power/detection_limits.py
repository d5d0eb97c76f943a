"""Detection limits of effects in recorded runs: the strength from which a test has 80 % power."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy import optimize

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power.distinction import (
    Change,
    bounded_square,
    detection_probability,
    distinction_factor,
    distinction_probability,
    distinguishable_size,
)
from jbf.diagnosis.power.strength import PresentRuns, Strength, strength_of
from jbf.estimation.campaign import FILTERS_FORCE
from jbf.estimation.parallel_fits import fits_at_once, in_parallel

LEVELS = (0.80, 0.95)
"""Detection probabilities for which a strength is computed. It enters no verdict."""
MOST_STRENGTHS = 14
"""Largest number of strengths evaluated for each detection limit. It limits the effort only."""
EXPONENTS = (1.0, 8.0)
"""Range of the exponents with which the non-centrality may grow with strength."""
AGREES = 0.05
"""Relative difference in strength at which the search ends; the power law gives the rest."""
NEARLY_ALL = 0.97
"""Share of a gain that must remain after a refit of the noise model to be treated as unchanged."""
BEYOND = 1.2
"""Factor on the detectable strength at which the share compared with `NEARLY_ALL` is evaluated.

It avoids a strength at which the colour of the noise just reaches its threshold. It enters no
verdict.
"""
MOST_ITERATIONS = 3
"""Iterations of the distinguishable strength for effects that shift friction jumps."""


@dataclass(frozen=True)
class Power:
    """Detection limits of one effect in runs of a given design.

    Attributes
    ----------
    effect, parameter, unit
        The effect, the parameter whose distance from its null is its strength, and its unit.
    detectable_80, detectable_95
        Parameter value from which the effect is detected with 80 % and 95 % power; None if no value
        within the bounds is detectable (ISO 11843).
    always
        True for an effect that is detectable at any strength (presliding in runs with rests); the
        values are then the weakest of the catalogue.
    share_80
        RMS change of the friction at `detectable_80`, as a share of the friction's RMS; None where
        `detectable_80` is None.
    distinguishable_80
        Parameter value from which, with 80 % power, the effect is detected and no other effect fits
        as well; None if the effect is confounded at any strength.
    confounded_with
        Effects that are confounded with this one at `detectable_80`, the least distinguishable
        first.
    hidden
        True if the power is below 80 % at the typical strength of the catalogue.
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


def power(candidates: Candidates, present: Names) -> tuple[Power, ...]:
    """Compute the detection limits of each effect that can be added to those of the model."""
    runs = PresentRuns(candidates, present)
    models = {
        name: model
        for name in candidates.addable(present)
        if (model := strength_of(candidates, present, name)) is not None
    }
    limits = in_parallel(
        lambda model: _Detectable.of(candidates, runs, model),
        list(models.values()),
        fits_at_once(candidates.campaign, candidates.law, candidates.names),
    )
    effects, tie = dict(zip(models, limits, strict=True)), candidates.policy.selection.tie
    return tuple(_power(runs, effects, name, tie) for name in effects)


@dataclass(frozen=True)
class _Detectable:
    """Detectable strength of an effect, and the change of the friction at this strength.

    Attributes
    ----------
    model, parameters, price
        The effect, its number of parameters, and the threshold for its gain.
    times
        Detectable strength for each of `LEVELS`, in multiples of the typical strength; nan if no
        strength is sufficient.
    change
        Change of the predicted friction at the first strength.
    share
        RMS change of the friction, as a share of the friction's RMS.
    """

    model: Strength
    parameters: int
    price: float
    times: tuple[float, ...]
    change: Change
    share: float

    @classmethod
    def of(cls, candidates: Candidates, runs: PresentRuns, model: Strength) -> _Detectable:
        """Compute the detectable strengths of an effect in the present runs."""
        parameters = max(len(model.problem.open) - runs.base.free, 1)
        price = _threshold(candidates, runs, model.name, parameters)
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
        return cls(model, parameters, price, tuple(times), Change.of(runs, model, at), size)

    def change_at(self, runs: PresentRuns, factor: float) -> Change:
        """Friction change at `factor` times the smallest detectable strength.

        The typical strength is used if no strength within the bounds is detectable.
        """
        return Change.of(runs, self.model, factor * _finite_or_one(self.times[0]))

    def parameter_value(self, times: float) -> float | None:
        """Strength parameter at a multiple of the typical strength; None if not finite."""
        return float(self.model.values(times)[self.model.which]) if np.isfinite(times) else None


def _threshold(candidates: Candidates, runs: PresentRuns, name: str, parameters: int) -> float:
    """Gain that an effect must exceed, in twice the log likelihood.

    An effect that filters the force in time must also explain a minimum share of the mean square.
    """
    price = candidates.price(parameters)
    if name in FILTERS_FORCE and candidates.campaign.rig.bearing is None:
        independent = candidates.independent_share(runs.base) * runs.base.samples.count
        price = max(price, candidates.policy.motion.min_filter_share * independent)
    return price


def _finite_or_one(times: float) -> float:
    """A multiple of the typical strength, or one if it is not finite."""
    return times if np.isfinite(times) else 1.0


def _required_multiples(
    runs: PresentRuns, model: Strength, least: list[float], near: float = 1.0
) -> list[float]:
    """Multiples of the typical strength that attain the required non-centralities `least`."""
    multiples, times, last = [], near, least[0]
    for wanted in least:
        # The non-centrality is nearly proportional to the square of the strength.
        times = _sufficient_multiple(runs, model, wanted, times * float(np.sqrt(wanted / last)))
        multiples.append(times)
        times, last = (times, wanted) if np.isfinite(times) else (near, least[0])
    return multiples


@lru_cache(maxsize=64)
def non_centrality(
    price: float, parameters: int, chance: float, discounts: tuple[float, ...] = (1.0,)
) -> float:
    """Non-centrality at which a gain exceeds the threshold `price` with probability `chance`.

    The gain is a noncentral chi-square variable; `parameters` is its number of degrees of freedom.
    `discounts` are factors on the gain, 0 to 1, each equally likely.
    """
    prices = price / np.array(discounts)

    def surplus(root: float) -> float:
        """Excess of the detection probability at the squared `root` over the required one."""
        return float(np.mean(detection_probability(prices, parameters, root**2))) - chance

    top = float(np.sqrt(np.max(prices))) + 10.0
    return float(optimize.brentq(surplus, 1e-3, top)) ** 2


def _sufficient_multiple(runs: PresentRuns, model: Strength, wanted: float, times: float) -> float:
    """Multiple of the typical strength that attains the non-centrality `wanted`, or nan.

    The search assumes a power law, at first with exponent two and then with the exponent observed
    between successive strengths. If the non-centrality increases abruptly (a lag below one sampling
    interval has no effect), the search bisects between insufficient and sufficient strengths.
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


def _power(runs: PresentRuns, effects: Mapping[str, _Detectable], name: str, tie: float) -> Power:
    """Detection limits of one effect, in comparison with the changes by all other effects."""
    effect = effects[name]
    factor, confounded = np.inf, []
    if np.isfinite(effect.times[0]):
        rivals: dict[str, tuple[float, float]] = {}
        for other, rival in effects.items():
            if other != name:
                least = max(tie + (effect.price - rival.price), 0.25 * tie)
                rivals[other] = (distinguishable_size(effect.change, rival.change, runs), least)
        chances = {other: distinction_probability(*rival) for other, rival in rivals.items()}
        confounded = sorted(
            (o for o, chance in chances.items() if chance < LEVELS[0]), key=chances.__getitem__
        )
        required = non_centrality(effect.price, effect.parameters, LEVELS[0])
        threshold = (effect.price, effect.parameters, required)
        factor = distinction_factor(*threshold, rivals, LEVELS[0])
        for _ in range(MOST_ITERATIONS):
            if not 1.0 + AGREES < factor < np.inf:
                break
            before = factor
            closest = {other: effects[other] for other in confounded}
            sizes = _sizes_at(runs, effect, closest, factor)
            rivals |= {other: (size, rivals[other][1]) for other, size in sizes.items()}
            factor = distinction_factor(*threshold, rivals, LEVELS[0])
            if abs(np.log(factor / before)) < AGREES:
                break
    return Power(
        effect=name,
        parameter=effect.model.page.name,
        unit=effect.model.page.unit,
        detectable_80=effect.parameter_value(effect.times[0]),
        detectable_95=effect.parameter_value(effect.times[1]),
        always=_weakest(effect.model, effect.times[0]),
        share_80=effect.share if np.isfinite(effect.times[0]) else None,
        distinguishable_80=effect.parameter_value(effect.times[0] * factor),
        confounded_with=tuple(confounded),
        hidden=not effect.times[0] <= 1.0,
    )


def _sizes_at(
    runs: PresentRuns, effect: _Detectable, rivals: Mapping[str, _Detectable], factor: float
) -> dict[str, float]:
    """Size of the part of an effect that each rival cannot reproduce, per unit of strength.

    The sizes are evaluated at `factor` times the detectable strength. A rival is evaluated only if
    it or the effect shifts friction jumps, because the changes are then not proportional to the
    strength.
    """
    change = effect.change_at(runs, factor)
    return {
        name: distinguishable_size(change, rival.change_at(runs, factor), runs) / factor
        for name, rival in rivals.items()
        if effect.change.shares is not None or rival.change.shares is not None
    }


def _weakest(model: Strength, times: float) -> bool:
    """Whether a multiple of the typical strength is the weakest that the bounds allow."""
    return bool(
        np.isfinite(times) and np.array_equal(model.values(0.1 * times), model.values(times))
    )
