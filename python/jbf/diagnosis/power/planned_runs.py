"""Detection limits of effects in planned runs, before they are recorded."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power.detection_limits import Power, power
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.samples import Samples
from jbf.models.model import Model
from jbf.records.arguments import list_of_runs, of_kind
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.run import Run
from jbf.records.toml_file import MOST, number
from jbf.results import Result
from jbf.threads import one_blas_thread


@dataclass(frozen=True, repr=False)
class PlannedPower(Result):
    """Detection limits of effects in planned runs.

    Attributes
    ----------
    model
        Assumed model of the machine.
    noise_rms
        Standard deviation of the given noise on the friction, N.
    power
        Detection limits of each effect that is not in the model.
    not_tried
        Effects that are compatible with the law but not testable in such runs, with the reason.
    runs
        Names of the runs.
    level
        Acceptance threshold for the gain of an effect.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> planned = jbf.planned_power(model, [run], noise_rms=0.2)
    >>> planned.runs, len(planned.power) > 10
    (('run',), True)
    """

    model: Model
    noise_rms: float
    power: tuple[Power, ...]
    not_tried: dict[str, str]
    runs: tuple[str, ...]
    level: Level

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {
            **self.model.units_for_json(),
            "law": self.model.law,
            "effects": list(self.model.effects),
            "noise_rms": self.noise_rms,
            "runs": list(self.runs),
            "level": self.level.to_dict(),
            "power": [p.to_dict() for p in self.power],
            "not_tried": dict(self.not_tried),
        }


def as_recorded(model: Model, runs: Sequence[Run], noise_rms: float, policy: Policy) -> Candidates:
    """Prepare runs simulated by a model, with white noise of RMS `noise_rms` (N), for tests."""
    random = np.random.default_rng(0)
    recorded = [
        replace(run, friction=friction + noise_rms * random.standard_normal(len(run)))
        for run, friction in zip(runs, model.predict_many(runs), strict=True)
    ]
    exact = Campaign.prepare(model.rig, recorded, policy.estimation)
    prepared = tuple(replace(p, motion=_as_read(p.motion)) for p in exact.prepared)
    campaign = replace(exact, prepared=prepared, samples=Samples.of(prepared, policy.estimation))
    return Candidates(campaign, model.law, model.clock, policy)


def _as_read(motion: EstimatedMotion) -> EstimatedMotion:
    """Treat the planned motion as if it were recorded, with unknown signs next to reversals.

    The sign of the motion is unknown at samples next to a reversal. With an exactly known sign,
    these samples would show an arbitrarily small backlash or delay.
    """
    direction = np.sign(motion.velocity)
    reversals = np.flatnonzero(direction[1:] != direction[:-1])
    sign_known = motion.sign_known.copy()
    sign_known[reversals] = sign_known[reversals + 1] = False
    return replace(motion, sign_known=sign_known)


@one_blas_thread
def planned_power(
    model: Model, runs: Iterable[Run], *, noise_rms: float, policy: Policy = DEFAULT
) -> PlannedPower:
    """Compute the detection limit of each effect in planned runs.

    The simulated record is the model's friction under the runs' motion, with white noise.

    Parameters
    ----------
    model
        Assumed model of the machine: from a fit, or a `Model` with values of a data sheet.
    runs
        Planned motions; their friction is ignored.
    noise_rms
        Standard deviation of the noise on the friction, N (for a rotary drive N m).
    policy
        Policy of the later diagnosis, with the thresholds from which an effect is named.

    Returns
    -------
    PlannedPower
        Detection limits of each effect that is not in the model.

    Raises
    ------
    InputError
        The noise is not positive, a run contains no motion, or a column that the model needs is
        missing.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> planned = jbf.planned_power(model, [run], noise_rms=0.2)
    >>> len(planned.power) > 10
    True
    """
    of_kind(model, Model, "model", "give a jbf.Model")
    noise_rms = number(noise_rms, "noise_rms")
    if not 0.0 < noise_rms <= MOST:
        problem = "is not plausible" if noise_rms > 0.0 else "is not above zero"
        problem = f"{noise_rms:g} {problem}"
        raise InputError(key="noise_rms", problem=problem, remedy="give its standard deviation")
    planned = list_of_runs(runs)
    if not planned:
        raise InputError(problem="no run was given", remedy="give at least one motion")
    candidates = as_recorded(model, planned, noise_rms, policy)
    limits = power(candidates, model.effects)
    names = tuple(run.name for run in planned)
    return PlannedPower(model, noise_rms, limits, candidates.not_tried, names, candidates.level)
