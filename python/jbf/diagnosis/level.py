"""Acceptance threshold for the gain of an effect, from the false-alarm rate of a campaign.

The false-alarm rate is the fraction of campaigns without a missing effect in which any candidate is
named. A gain must exceed the larger of two limits: that of white noise plus the artefact margin,
and that of the residual of the campaign, which contains its artefacts.

The Bonferroni correction for the number of candidates gives the significance level of a single
gain. If the residual of the campaign gives large gains more often, this level is reduced until the
rate is attained. For this purpose the signs of the residual are reversed block by block (wild
bootstrap: Wu 1986; of blocks: Shao 2010). The reversal preserves the variance, tails and
autocorrelation of the residual and removes the contribution of any effect.

The margin for recording artefacts is added to the gain in white noise only, since the residual of
the campaign contains its artefacts. A significant effect below the minimum effect size is not
named, since with enough samples any model is rejected.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from scipy import special

from jbf.arrays import Array
from jbf.diagnosis.directions import (
    Directions,
    RichestResidual,
    decoy_gains,
    largest_common_group,
)
from jbf.diagnosis.policy import Policy
from jbf.estimation.least_squares import least_squares, triangular
from jbf.estimation.likelihood import effective_share, promised_gain, score_gain
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

DRAWS = 4000
"""Number of bootstrap draws; forty of them exceed a level of one per cent.

It determines the numerical resolution of the level.
"""


@dataclass(frozen=True)
class Level:
    """Acceptance threshold for the gain of an effect, in twice the log likelihood.

    Attributes
    ----------
    false_alarm_rate
        Fraction of campaigns without a missing effect in which noise may name one.
    candidates
        Number of candidate effects.
    chance
        Significance level of the gain of a single candidate.
    blocks
        Number of blocks of the residual whose signs were reversed; zero before calibration.
    artefact_margin
        Gain that recording artefacts may add to the gain in white noise.
    min_gain
        Gain of an effect of the minimum effect size, from the independent samples.
    decoys, decoys_named
        Number of decoy campaigns, and number of those in which a decoy would have been named.
    min_share
        Share of the mean square that an effect of the minimum effect size explains.
    """

    false_alarm_rate: float
    candidates: int
    chance: float
    blocks: int = 0
    artefact_margin: float = 0.0
    min_gain: float = 0.0
    decoys: int = 0
    decoys_named: int = 0
    min_share: float = 0.0

    @classmethod
    def in_white_noise(
        cls,
        policy: Policy,
        candidates: int,
        samples: float,
        noise_rms: float,
        least_share: float = 0.0,
    ) -> Level:
        """Return the threshold in white noise; the candidates share the false-alarm rate.

        The significance level of one candidate follows by the Bonferroni correction. `samples` is
        the number of independent samples, `noise_rms` the RMS of the residual, N, and `least_share`
        the minimum share of the mean square that an effect must explain.
        """
        least = max(policy.min_effect_share, policy.min_effect / max(noise_rms, 1e-300))
        chance = policy.false_alarm_rate / max(candidates, 1)
        share = max(least**2, least_share)
        return cls(
            policy.false_alarm_rate,
            candidates,
            chance,
            artefact_margin=policy.artefact_margin,
            min_gain=share * samples,
            min_share=share,
        )

    @property
    def critical(self) -> float:
        """Gain that a parameter without effect exceeds with probability `chance`."""
        return float(special.chdtri(1, self.chance))

    @property
    def white_noise_threshold(self) -> float:
        """Gain that one parameter exceeds in white noise at the Bonferroni-corrected level."""
        return float(special.chdtri(1, self.false_alarm_rate / max(self.candidates, 1)))

    @property
    def significant(self) -> float:
        """Gain of one parameter from which an effect is significant, with the artefact margin.

        It is ``max(critical, white_noise_threshold + artefact_margin)``.
        """
        return max(self.critical, self.white_noise_threshold + self.artefact_margin)

    def price(self, parameters: int, samples: int) -> float:
        """Acceptance threshold for the gain of an effect with a given number of parameters.

        It is ``max(significant, min_gain)``, plus the penalty ``log(samples)`` of Schwarz (1978)
        for each parameter beyond the first.
        """
        more = max(parameters, 1) - 1
        return max(self.significant, self.min_gain) + more * float(np.log(max(samples, 1)))

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {
            **vars(self),
            "critical": self.critical,
            "white_noise_threshold": self.white_noise_threshold,
        }


_stacked_rows: WeakKeyDictionary[Solution, tuple[Array, Array]] = WeakKeyDictionary()


def _rows(near: Solution) -> tuple[Array, Array]:
    """Whitened residuals of a solution and their Jacobian, cached for all score tests."""
    if near not in _stacked_rows:
        _stacked_rows[near] = near.stacked()
    return _stacked_rows[near]


def score_test(
    problem: Problem, starts: Sequence[Array], near: Solution, added: Collection[str]
) -> tuple[float, Directions, Array]:
    """Score test of added effects at several starting values equivalent to a smaller model.

    At each of the values `starts`, the effects `added` have no influence on the model `problem`;
    `near` is the solution of the smaller model. The starting values with the largest predicted gain
    are used. If the Jacobian of the smaller model exceeds the memory limit, the directions and the
    step are computed from selected runs (`Problem.searched`); the gain is that of all runs.

    Returns the predicted gain (`score_gain`), the score directions of the added effects, and the
    parameter values after one step from the selected starting values.
    """
    in_memory = near.lines is not None
    tested = problem if in_memory else problem.thinned
    # Samples next to jumps, which the smaller model excludes, would favour any effect.
    samples = near.samples if in_memory else near.samples.only(problem.searched)
    is_added = np.array([tested.names[i].split(".")[0] in added for i in tested.open], dtype=bool)
    # At the null, the derivatives with respect to the other parameters are unchanged.
    reuse_rows = in_memory and near.free == np.count_nonzero(~is_added)
    best: tuple[float, Array, Array, Array] | None = None
    for start in starts:
        if reuse_rows:
            columns = [i for i, added_here in zip(tested.open, is_added, strict=True) if added_here]
            r, rest = _rows(near)
            _, added_columns = samples.stacked(*tested.linearise(start, by=columns), near.noise)
            j = np.empty((len(r), len(is_added)))
            j[:, is_added], j[:, ~is_added] = added_columns, rest
        else:
            r, j = samples.stacked(*tested.linearise(start), near.noise)
        if in_memory:
            gain = promised_gain(*triangular(r, j), len(r))
        else:
            gain = score_gain(problem, start, near)
        if best is None or gain > best[0]:
            best = gain, r, j, start
    assert best is not None
    gain, r, j, start = best
    stepped = tested.decode(tested.encode(start) + least_squares(j, r), start)
    directions = Directions.of(r, j[:, is_added], j[:, ~is_added], samples, effective_share(near))
    return gain, directions, stepped


def calibrated(
    level: Level, directions: Sequence[Directions], residual: RichestResidual | None
) -> Level:
    """Reduce the significance level until sign-reversed residuals attain the false-alarm rate.

    The `residual` excludes the part that candidates could explain, which is under test. Some
    candidates have no score direction, for example an effect that shifts friction jumps in time,
    whose derivative at the null is zero. For these, and for candidates with other samples, the
    Bonferroni correction is used.
    """
    tested = largest_common_group([d for d in directions if d.basis.size])
    if not tested or residual is None:
        return level
    # The models may have residuals of different autocorrelation: use the fewest blocks.
    blocks = min((d.blocks for d in tested), key=len)
    random = np.random.default_rng(len(blocks))
    signs = random.integers(0, 2, (DRAWS, len(blocks)), dtype=np.int8).astype(np.float32)
    signs = 2.0 * signs - np.float32(1.0)
    # Use one matrix product for all candidates, which reads the signs from memory once.
    columns = np.column_stack([one.by_block(residual.innovations, blocks) for one in tested])
    scores = (signs @ columns.astype(np.float32)).astype(np.float64)
    ends = np.cumsum([one.basis.shape[1] for one in tested])
    least: Array = np.ones(DRAWS)
    for squares in np.split(scores**2, ends[:-1], axis=1):
        least = np.minimum(least, special.chdtrc(squares.shape[1], np.sum(squares, axis=1)))
    least.sort()
    untested = max(level.candidates - len(tested), 0)
    # Add the Bonferroni bound of the untested candidates to the rate of the tested ones.
    false = np.arange(1, DRAWS + 1) / DRAWS + untested * least
    allowed = np.flatnonzero(false <= level.false_alarm_rate)
    calibrated_chance = float(least[allowed[-1]]) if len(allowed) else float(0.5 * least[0])
    return replace(level, chance=min(level.chance, calibrated_chance), blocks=len(blocks))


def with_decoys(level: Level, directions: Sequence[Directions], samples: int) -> Level:
    """Return the threshold with the number of decoy campaigns in which a decoy exceeds it."""
    tested = [d for d in directions if d.basis.size]
    if not tested:
        return level
    gains = decoy_gains(tested)
    prices = [level.price(d.basis.shape[1], samples) for d in tested]
    named = np.any([g > price for g, price in zip(gains, prices, strict=True)], axis=0)
    return replace(level, decoys=len(named), decoys_named=int(np.sum(named)))
