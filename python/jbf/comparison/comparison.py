"""Comparison of a model with recorded runs: size and location of its errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.comparison.patterns import Failure, find_failures
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.samples import Samples
from jbf.estimation.uncertain_samples import active_effects, samples_near_jumps, time_constant
from jbf.models.catalogue import parameters_of, transition_speed
from jbf.models.chain import chain, warn_of_fast_film
from jbf.models.model import Model
from jbf.records.findings.finding import Finding
from jbf.records.run import PathLike
from jbf.results import Result


@dataclass(frozen=True)
class RunComparison:
    """Error of a model in one run.

    Attributes
    ----------
    name
        Name of the run.
    rms
        Root mean square of record minus prediction over the included samples, N; 0 without samples.
    samples
        Number of included samples.
    """

    name: str
    rms: float
    samples: int


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """Comparison of one model with recorded runs.

    Attributes
    ----------
    model, campaign
        The model, and the prepared runs.
    samples
        The included samples: those in motion with a known sign.
    rms
        Root mean square of record minus prediction over the included samples, N.
    noise_rms
        Noise floor of the record, from the data only, N; zero if unknown.
    runs
        Error of the model in each run.
    failures
        Axes along which the residual has a pattern, strongest first.
    predictions, residuals
        One array per run, N; the residual is record minus prediction.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> compared = jbf.compare(model, [run])
    >>> round(compared.rms, 1), len(compared.failures)
    (0.2, 0)
    """

    model: Model
    campaign: Campaign
    samples: Samples
    rms: float
    noise_rms: float
    runs: tuple[RunComparison, ...]
    failures: tuple[Failure, ...]
    predictions: list[Array]
    residuals: list[Array]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Recording artefacts of the runs, and how they were treated."""
        return self.campaign.findings

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as a JSON-serialisable dict."""
        return {
            **self.model.units_for_json(),
            "rms": self.rms,
            "noise_rms": self.noise_rms or None,
            "runs": [{"run": r.name, "rms": r.rms, "samples": r.samples} for r in self.runs],
            "failures": [f.to_dict() for f in self.failures],
            "findings": [f.to_dict() for f in self.findings],
        }

    def report(self, path: PathLike) -> None:
        """Write the comparison as an HTML report; equivalent to `save_html`."""
        self.save_html(path)


def predicted(model: Model, campaign: Campaign) -> list[Array]:
    """Predictions of a model for prepared runs, N, one array per run."""
    motions = campaign.motions
    core = chain(model.rig, model.law, model.clock, model.effects)
    warn_of_fast_film(core, model.values, motions)
    if model.delay is None:
        return core.predict(model.values, motions)
    return model.predict_late((p.run, *p.motion_as_read) for p in campaign.prepared)


def compare_prepared(model: Model, campaign: Campaign) -> Comparison:
    """Compare a model with prepared runs; see `jbf.compare`."""
    predictions = predicted(model, campaign)
    pages = parameters_of(model.law, tuple(model.effects))
    effects = active_effects(model.effects, pages, model.values)
    spread_s = time_constant(effects, pages, model.values)
    samples = samples_near_jumps(
        campaign.samples, campaign.prepared, predictions, effects, spread_s
    )
    residuals = [p.friction - f for f, p in zip(predictions, campaign.prepared, strict=True)]
    noise = noise_floor(campaign.prepared, samples)
    runs = tuple(
        RunComparison(
            p.run.name,
            float(np.sqrt(np.mean(r[counted] ** 2))) if counted.any() else 0.0,
            int(counted.sum()),
        )
        for p, r, counted in zip(campaign.prepared, residuals, samples.counted, strict=True)
    )
    square = sum(r.rms**2 * r.samples for r in runs) / max(samples.count, 1)
    u_tr = transition_speed(model.law, model.values.tolist())
    return Comparison(
        model=model,
        campaign=campaign,
        samples=samples,
        rms=float(np.sqrt(square)),
        noise_rms=noise,
        runs=runs,
        failures=find_failures(campaign, samples, residuals, u_tr, noise),
        predictions=predictions,
        residuals=residuals,
    )
