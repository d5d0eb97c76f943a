"""Whether runs left out confirm an effect, in linear models whose runs are left out exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.left_out import LeftOut
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

COUNT = 400
RUNS = 5
EVERY = np.ones(COUNT, dtype=bool)
SAMPLES = Samples(tuple("abcde"), (0.02,) * RUNS, (EVERY,) * RUNS, (np.ones(COUNT),) * RUNS)
WEAK = 30.0
"""Evidence, of which left-out runs must confirm some."""


def fitted(design: Sequence[Array], force: Sequence[Array]) -> tuple[Solution, list[LeftOut]]:
    """Least squares, and the same without each run."""

    def values(runs: Sequence[int]) -> Array:
        x = np.concatenate([design[i] for i in runs])
        y = np.concatenate([force[i] for i in runs])
        return np.asarray(np.linalg.lstsq(x, y, rcond=None)[0])

    whole = values(range(RUNS))
    residuals = [y - x @ whole for x, y in zip(design, force, strict=True)]
    found = Solution((), whole, residuals, list(design), WHITE, 0.0, True, "", SAMPLES)
    told = np.ones(len(whole), dtype=bool)
    left = []
    for i in range(RUNS):
        there = values([k for k in range(RUNS) if k != i])
        left.append(LeftOut((i,), (EVERY,), told, (force[i] - design[i] @ there,)))
    return found, left


def confirmation(
    law: Sequence[Array], own: Sequence[Array], force: Sequence[Array]
) -> Confirmation:
    """Of an effect whose derivatives are `own`, beside a law's."""
    before, left = fitted(law, force)
    after, richer_left = fitted(
        [np.column_stack(both) for both in zip(law, own, strict=True)], force
    )
    return Confirmation.of(before, after, left, richer_left)


def confirmed(found: Confirmation) -> bool:
    return found.confirms(WEAK, np.inf, DEFAULT)


def campaigns(seed: int, times: int) -> list[tuple[list[Array], list[Array], list[Array]]]:
    """Two parameters of a law, the second of which the first run alone tells well, and an effect
    that pulls alike in all of them; the law could stand in for a little of it in the others."""
    random = np.random.default_rng(seed)
    made = []
    for _ in range(times):
        own = [random.standard_normal(COUNT) for _ in range(RUNS)]
        law = [random.standard_normal((COUNT, 2)) for _ in range(RUNS)]
        for i in range(RUNS):
            law[i][:, 1] *= 1.0 if i == 0 else 0.02
            law[i][:, 1] += 0.004 * own[i] if i else 0.0
        made.append((law, own, [random.standard_normal(COUNT) for _ in range(RUNS)]))
    return made


def test_a_run_without_which_the_law_is_poorly_known_has_no_veto() -> None:
    by_density, by_square = 0, 0
    for law, own, noise in campaigns(11, 60):
        found = confirmation(law, own, [e + 0.13 * o for e, o in zip(noise, own, strict=True)])
        by_density += confirmed(found)
        by_square += found.after_n < found.before_n
    assert by_density >= 54
    # The errors alone say nothing of the kind.
    assert by_square < 50


def test_what_one_run_shows_and_the_others_deny_is_not_confirmed() -> None:
    refused = 0
    for law, own, noise in campaigns(12, 60):
        force = [e + 0.5 * (i == 0) * o for i, (e, o) in enumerate(zip(noise, own, strict=True))]
        refused += not confirmed(confirmation(law, own, force))
    assert refused >= 57


def test_an_effect_that_all_runs_tell_alike_keeps_what_the_linear_model_says() -> None:
    shares, wanted = [], []
    for law, own, noise in campaigns(13, 60):
        even = [x[:, :1] for x in law]
        force = [e + 0.13 * o for e, o in zip(noise, own, strict=True)]
        shares.append(confirmation(even, own, force).density)
        z = 0.13**2 * COUNT * RUNS
        wanted.append((z - 1.0) / (z + 1.0))
    assert abs(np.mean(shares) - np.mean(wanted)) < 0.02


def test_runs_that_are_predicted_worse_and_better_are_counted() -> None:
    law, own, noise = campaigns(14, 1)[0]
    found = confirmation(law, own, noise)
    _, left = fitted(law, noise)
    errors = [float(np.sqrt(np.mean(part.residuals[0] ** 2))) for part in left]
    assert found.before_n == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=1e-12)
    assert found.better in [k / RUNS for k in range(RUNS + 1)]
    assert not found.halved


def test_models_are_compared_at_the_samples_that_both_leave() -> None:
    # What the richer one sets aside beside its jumps the simpler one predicts badly.
    law, own, noise = campaigns(15, 1)[0]
    wild = [np.where(np.arange(COUNT) < 20, 30.0, 0.0) + e for e in noise]
    fewer = replace(SAMPLES, counted=(np.arange(COUNT) >= 20,) * RUNS)
    before, left = fitted(law, wild)
    after, richer_left = fitted(
        [np.column_stack(both) for both in zip(law, own, strict=True)], wild
    )
    found = Confirmation.of(before, replace(after, samples=fewer), left, richer_left)
    alike = Confirmation.of(before, after, left, richer_left)
    assert found.before_n < 0.7 * alike.before_n
    assert found.after_n == pytest.approx(found.before_n, rel=0.15)


@pytest.mark.parametrize(("size_n", "worse"), [(0.01, 1.0), (0.01, 1.5), (100.0, 1.5)])
def test_runs_left_out_that_are_predicted_worse_confirm_nothing(
    size_n: float, worse: float
) -> None:
    """However small the force: as a share of the error without the effect."""
    found = Confirmation(size_n, worse * size_n, 1.0, 1.0, ())
    assert found.confirms(1e6, 1e-9, DEFAULT) == (worse < DEFAULT.left_out_worse)
