"""Loss ledger of an export: how each term of a model is carried, and the error that this costs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

Status = Literal["exact", "approximate", "none", "external"]
"""How a target carries a term of a model.

`exact`: with the same equation and values. `approximate`: with another equation, whose values are
fitted. `none`: not at all; the error contains the term. `external`: the term belongs to another
part of the target (the weight of a link) or to the recording (the offset of a sensor), and the
error does not contain it.
"""


@dataclass(frozen=True)
class Term:
    """One term of a model in a ledger.

    Attributes
    ----------
    name
        Name of the law or of the effect.
    status
        How the target carries the term.
    how
        Elements of the target that carry the term, or the reason why none does.
    values
        Values of these elements as written, by name, in the unit of the element in the target:
        levels in N or N m, damping in N s/m or N m s/rad. Empty if the term is not carried.
    """

    name: str
    status: Status
    how: str
    values: Mapping[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the term as JSON-serialisable data."""
        return {
            "name": self.name,
            "status": self.status,
            "how": self.how,
            "values": dict(self.values),
        }


@dataclass(frozen=True)
class RunLoss:
    """Error of an exported form along one run, in the unit of the rig.

    Attributes
    ----------
    run
        Name of the run.
    samples
        Number of samples with a known direction of sliding; only these are compared.
    rms, largest
        RMS and largest absolute difference from the prediction of the model.
    friction_rms
        RMS of the friction of the model.
    """

    run: str
    samples: int
    rms: float
    largest: float
    friction_rms: float

    @property
    def share(self) -> float:
        """RMS error as a share of the RMS friction."""
        return _share(self.rms, self.friction_rms)

    def to_dict(self) -> dict[str, Any]:
        """Return the error as JSON-serialisable data."""
        return {
            "run": self.run,
            "samples": self.samples,
            "rms": self.rms,
            "largest": self.largest,
            "friction_rms": self.friction_rms,
            "share": self.share,
        }


@dataclass(frozen=True)
class Ledger:
    """Loss ledger of an export.

    Attributes
    ----------
    terms
        Law and effects of the model, in the order of the signal chain.
    runs
        Errors along the runs.
    unit
        Unit of the errors.
    evaluated_by
        The program that computed the force of the exported form.
    notes
        Further properties of the export, and limits of the target.
    """

    terms: tuple[Term, ...]
    runs: tuple[RunLoss, ...]
    unit: str
    evaluated_by: str
    notes: tuple[str, ...] = ()

    @property
    def rms(self) -> float:
        """RMS error over the samples of all runs, in `unit`."""
        return self._over_runs([loss.rms for loss in self.runs])

    @property
    def friction_rms(self) -> float:
        """RMS friction of the model over the samples of all runs, in `unit`."""
        return self._over_runs([loss.friction_rms for loss in self.runs])

    @property
    def share(self) -> float:
        """RMS error as a share of the RMS friction."""
        return _share(self.rms, self.friction_rms)

    def term(self, name: str) -> Term:
        """Return the term of a law or an effect by name."""
        return next(term for term in self.terms if term.name == name)

    def _over_runs(self, values: list[float]) -> float:
        counts = np.array([loss.samples for loss in self.runs], float)
        return math.sqrt(float(np.sum(counts * np.square(values)) / np.sum(counts)))

    def to_dict(self) -> dict[str, Any]:
        """Return the ledger as JSON-serialisable data."""
        return {
            "unit": self.unit,
            "rms": self.rms,
            "friction_rms": self.friction_rms,
            "share": self.share,
            "evaluated_by": self.evaluated_by,
            "terms": [term.to_dict() for term in self.terms],
            "runs": [loss.to_dict() for loss in self.runs],
            "notes": list(self.notes),
        }


def _share(error: float, friction: float) -> float:
    return error / friction if friction > 0.0 else (math.inf if error > 0.0 else 0.0)
