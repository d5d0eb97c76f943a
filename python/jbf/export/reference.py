"""Force of a model along its runs, to which the force of an exported form is compared."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.export.ledger import RunLoss
from jbf.models.catalogue import CARRIER, find_effect
from jbf.models.chain import chain, core_refusals, estimated_motion
from jbf.models.driven import Driven
from jbf.models.driven_motion import driven_motion
from jbf.models.model import Model
from jbf.records.arguments import list_of_runs
from jbf.records.run import Run

BODY = ("inertia", "gravity", "spring")
"""Effects of the moved body: a simulator or a feedforward has them as mass, weight and spring."""
COGGING = ("cogging", "cogging_2")
"""Effects that add a force that is periodic in the position."""


def instrument(model: Model) -> tuple[str, ...]:
    """Effects of a model that belong to the recording, not to the machine."""
    return tuple(name for name in model.effects if find_effect(name).stage == "instrument")


def part(model: Model, kept: Collection[str]) -> Model:
    """Return the law of a model with some of its effects."""
    names = [name for name in model.effects if name in kept]
    values = {
        name: value
        for name, value in model.parameters.items()
        if "." not in name or name.partition(".")[0] in names
    }
    return Model(model.rig, model.law, names, values, model.clock)


def predict(model: Model, motions: Sequence[Driven]) -> list[Array]:
    """Force of a model along motions that were estimated before, each shape (n,)."""
    with core_refusals():
        return chain(model.rig, model.law, model.clock, model.effects).predict(
            model.values, motions
        )


def force_of_effects(
    model: Model, names: Collection[str], motions: Sequence[Driven]
) -> list[Array]:
    """Force of additive effects of a model (stage `other friction`), each shape (n,)."""
    least = {"F_c": 1e-6, "F_s": 1e-6, "F_v": 0.0}
    values = {
        name: value for name, value in model.parameters.items() if name.partition(".")[0] in names
    }
    chosen = [name for name in model.effects if name in names]
    both = predict(Model(model.rig, CARRIER, chosen, {**least, **values}), motions)
    law = predict(Model(model.rig, CARRIER, (), least), motions)
    return [a - b for a, b in zip(both, law, strict=True)]


@dataclass(frozen=True, eq=False)
class Reference:
    """Force of a model along runs, without the effects of the recording and of the moved body.

    Attributes
    ----------
    model
        The model, complete.
    machine
        The model without the effects of the instrument.
    runs, motions
        The runs, and their estimated motions as inputs of the core.
    force
        Reference force of each run, in the unit of the rig, shape (n,).
    velocity, position
        Motion of each run, shape (n,); the position is the angle of a rotary drive, zero without a
        recorded position.
    sliding
        Mask of the samples with a known direction of sliding, shape (n,).
    """

    model: Model
    machine: Model
    runs: list[Run]
    motions: list[Driven]
    force: list[Array]
    velocity: list[Array]
    position: list[Array]
    sliding: list[Mask]

    @classmethod
    def of(cls, model: Model, runs: Iterable[Run]) -> Reference:
        """Compute the reference force of a model along runs.

        Raises
        ------
        InputError
            The runs lack a column that the model needs, or none of them slides.
        """
        runs = list_of_runs(runs)
        for run in runs:
            model.require_columns(run)
        rig = model.rig
        machine = part(model, set(model.effects) - set(instrument(model)))
        estimated = [estimated_motion(rig, run) for run in runs]
        motions = [driven_motion(rig, run, e) for run, e in zip(runs, estimated, strict=True)]
        body = force_of_effects(model, BODY, motions)
        force = [f - b for f, b in zip(predict(machine, motions), body, strict=True)]
        sliding = [motion.slides for motion in estimated]
        if not any(np.any(mask) for mask in sliding):
            raise InputError(
                problem="the runs contain no sliding, so that the loss of the export is unknown",
                remedy="name the runs from which the model was fitted",
            )
        velocity = [_at_samples(motion, "velocity") for motion in motions]
        arm = rig.radius_m or 1.0
        position = [arm * _at_samples(motion, "angle_rad") for motion in motions]
        return cls(model, machine, runs, motions, force, velocity, position, sliding)

    def predict(self, model: Model) -> list[Array]:
        """Force of another model along the same motions, each shape (n,)."""
        return predict(model, self.motions)

    def without(self, force: Iterable[Array]) -> Reference:
        """Reference whose force lacks a part, given along each run, shape (n,)."""
        rest = [a - b for a, b in zip(self.force, force, strict=True)]
        return replace(self, force=rest)

    def rms_error(self, forces: Iterable[Array]) -> float:
        """RMS error of an exported form over all sliding samples."""
        errors = self.pooled(a - b for a, b in zip(forces, self.force, strict=True))
        return float(np.sqrt(np.mean(errors**2)))

    @property
    def friction_rms(self) -> float:
        """RMS force over all sliding samples."""
        return float(np.sqrt(np.mean(self.pooled(self.force) ** 2)))

    @property
    def travel(self) -> float:
        """Largest range of the positions of a run; from the speed where none was recorded."""
        ranges = []
        for run, velocity, position in zip(self.runs, self.velocity, self.position, strict=True):
            path = position
            if not np.any(position):
                path = np.concatenate([[0.0], np.cumsum(velocity[1:] * np.diff(run.time_s))])
            ranges.append(float(np.ptp(path)))
        return max(ranges)

    def losses(self, forces: Iterable[Array]) -> tuple[RunLoss, ...]:
        """Errors of an exported form, given its force along each run, shape (n,)."""
        losses = []
        each = zip(self.runs, self.force, forces, self.sliding, strict=True)
        for run, reference, force, mask in each:
            if not np.any(mask):
                continue
            error, friction = (force - reference)[mask], reference[mask]
            losses.append(
                RunLoss(
                    run.name,
                    int(np.sum(mask)),
                    float(np.sqrt(np.mean(error**2))),
                    float(np.max(np.abs(error))),
                    float(np.sqrt(np.mean(friction**2))),
                )
            )
        return tuple(losses)

    def pooled(self, columns: Iterable[Array]) -> Array:
        """Concatenate the sliding samples of one array per run."""
        masked = [c[mask] for c, mask in zip(columns, self.sliding, strict=True)]
        return np.concatenate(masked)

    @property
    def top_speed(self) -> float:
        """Largest absolute speed of the sliding samples."""
        return float(np.max(np.abs(self.pooled(self.velocity))))


def _at_samples(motion: Driven, column: str) -> Array:
    """Column of a motion at the samples of its run."""
    values = motion.motion.columns[column]
    return values if motion.kept is None else values[motion.kept]
