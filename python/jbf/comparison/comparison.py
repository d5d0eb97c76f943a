"""Model against measurement: how far, and where it fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.comparison.axes import Binned, all_axes
from jbf.estimation.campaign import Campaign
from jbf.estimation.jumps import active_effects, moves_jumps, samples_beside_jumps
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.samples import Samples
from jbf.models.catalogue import parameters_of, transition_speed
from jbf.models.chain import chain, warn_of_fast_film
from jbf.models.model import Model, the_model
from jbf.records.arguments import list_of_runs
from jbf.records.run import PathLike, Run
from jbf.results import Result

Array = npt.NDArray[np.float64]

LEAST_SHARE = 0.01
"""An axis that explains less of the residual than this is not worth a line."""
SIGNIFICANCE = 6.0
"""How many standard deviations the explained part must stand above chance."""


@dataclass(frozen=True)
class Failure:
    """One axis along which the residual has a pattern.

    Attributes
    ----------
    axis
        `velocity`, `direction`, `regime` (of a law without a film: `speed range`),
        `acceleration`, `angle`, `time`, `run`, `time since a rest` or
        `distance since a reversal`.
    where
        The pattern in words.
    share
        Part of the residual's mean square that the bins' means explain, 0 to 1.
    labels, means_n, counts
        The bins: name, mean of record minus prediction (N), samples.
    """

    axis: str
    where: str
    share: float
    labels: tuple[str, ...]
    means_n: Array
    counts: npt.NDArray[np.intp]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"axis": self.axis, "where": self.where, "share": round(self.share, 4)}


@dataclass(frozen=True)
class RunComparison:
    """One run against the model."""

    name: str
    rms_n: float
    samples: int


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """A model against runs.

    Attributes
    ----------
    samples
        Those that count: where the sign of the motion is known.
    rms_n
        Root mean square of record minus prediction over the samples that count, N.
    noise_n
        Noise floor of the record, from the data alone, N.
    failures
        Axes along which the residual has a pattern, strongest first.
    predictions, residuals
        One array a run, N; residual is record minus prediction.
    """

    model: Model
    campaign: Campaign
    samples: Samples
    rms_n: float
    noise_n: float
    runs: tuple[RunComparison, ...]
    failures: tuple[Failure, ...]
    predictions: list[Array]
    residuals: list[Array]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "rms_n": self.rms_n,
            "noise_n": self.noise_n,
            "runs": [{"run": r.name, "rms_n": r.rms_n, "samples": r.samples} for r in self.runs],
            "failures": [f.to_dict() for f in self.failures],
        }

    def report(self, path: PathLike) -> None:
        """As `save_html`."""
        self.save_html(path)


def find_failures(
    campaign: Campaign,
    samples: Samples,
    residuals: Sequence[Array],
    u_tr: float | None,
    noise_n: float,
) -> tuple[Failure, ...]:
    """Axes along which record minus prediction has a pattern, strongest first."""
    axes = all_axes(campaign, u_tr)
    patterns = (pattern_along(axis, samples, residuals, noise_n) for axis in axes)
    return tuple(sorted((f for f in patterns if f is not None), key=lambda f: -f.share))


def pattern_along(
    axis: Binned,
    samples: Samples,
    residuals: Sequence[Array],
    noise_n: float,
    least_share: float = LEAST_SHARE,
    significance: float = SIGNIFICANCE,
) -> Failure | None:
    """The pattern of residuals (record minus prediction, N) along an axis, where it stands out.

    Parameters
    ----------
    noise_n
        Standard deviation of what is no pattern, N.
    least_share
        Share of the mean square that the means of the bins must explain beyond chance.
    significance
        Standard deviations that this must stand above chance.
    """
    r, bins = samples.flat(residuals), samples.flat(axis.bins)
    total = float(r @ r)
    known = bins >= 0
    size = len(axis.labels)
    counts = np.bincount(bins[known], minlength=size)
    sums = np.bincount(bins[known], weights=r[known], minlength=size)
    means = sums / np.maximum(counts, 1)
    used = int(np.count_nonzero(counts))
    explained = float(np.sum(counts * means**2))
    # By chance each bin's mean takes one noise variance.
    chance = used * noise_n**2
    spread = np.sqrt(2.0 * used) * noise_n**2
    share = (explained - chance) / total if total > 0 else 0.0
    if share < least_share or explained < chance + significance * spread:
        return None
    return Failure(axis.axis, _words(axis, means, counts), share, axis.labels, means, counts)


def _words(axis: Binned, means: Array, counts: npt.NDArray[np.intp]) -> str:
    """The pattern of the means in words."""
    weight = counts * means**2
    strong = weight > 0.02 * weight.sum()
    signs = np.array([1 if "v > 0" in x or "v = +" in x else -1 for x in axis.labels])
    signed = all("v " in x for x in axis.labels)
    if signed and np.all(np.sign(means[strong]) == signs[strong]) and strong.sum() > 1:
        size = np.average(np.abs(means[strong]), weights=counts[strong])
        lead = f"sign of v: record above the model by {size:.2g} N in the direction of motion"
    elif signed and np.all(np.sign(means[strong]) == -signs[strong]) and strong.sum() > 1:
        size = np.average(np.abs(means[strong]), weights=counts[strong])
        lead = f"sign of v: record below the model by {size:.2g} N in the direction of motion"
    elif np.all(means[strong] > 0) or np.all(means[strong] < 0):
        size = np.average(means[strong], weights=counts[strong])
        lead = f"one sign throughout: record minus model {size:+.2g} N"
    else:
        lead = ""
    worst = np.argsort(-weight)[:2]
    spots = "; ".join(f"{means[i]:+.2g} N at {axis.labels[i]}" for i in worst if strong[i])
    share = strong.sum() / max(np.count_nonzero(counts), 1)
    scope = {
        True: f"all of {axis.axis}, ",
        False: "",
    }[bool(lead) and share > 0.8]
    return f"{scope}{lead}; most {spots}" if lead else f"most {spots}"


def compare_prepared(model: Model, campaign: Campaign) -> Comparison:
    """`compare` for runs that are ready."""
    motions = campaign.motions
    core = chain(model.rig, model.law, model.clock, model.effects)
    warn_of_fast_film(core, model.values, motions)
    predictions = core.predict(model.values, motions)
    pages = parameters_of(model.law, tuple(model.effects))
    effects = active_effects(model.effects, pages, model.values)
    samples = campaign.samples
    if moves_jumps(effects):
        samples = samples_beside_jumps(samples, campaign.prepared, predictions)
    residuals = [p.friction_n - f for f, p in zip(predictions, campaign.prepared, strict=True)]
    noise = noise_floor(campaign.prepared, samples)
    runs = tuple(
        RunComparison(
            p.run.name,
            float(np.sqrt(np.mean(r[counted] ** 2))),
            int(counted.sum()),
        )
        for p, r, counted in zip(campaign.prepared, residuals, samples.counted, strict=True)
    )
    square = sum(r.rms_n**2 * r.samples for r in runs) / max(samples.count, 1)
    u_tr = transition_speed(model.law, model.values.tolist())
    return Comparison(
        model=model,
        campaign=campaign,
        samples=samples,
        rms_n=float(np.sqrt(square)),
        noise_n=noise,
        runs=runs,
        failures=find_failures(campaign, samples, residuals, u_tr, noise),
        predictions=predictions,
        residuals=residuals,
    )


def compare(model: Model, runs: Sequence[Run]) -> Comparison:
    """Compare a model with recorded runs.

    Samples at which the sign of the motion cannot be known (within a few of a reversal) count
    neither for the model nor against it.

    Raises
    ------
    InputError
        A run lacks friction or a column that the model needs, or nothing moves in it.
    """
    the_model(model)
    runs = list_of_runs(runs)
    for run in runs:
        model.require_columns(run)
    return compare_prepared(model, Campaign.prepare(model.rig, runs))
