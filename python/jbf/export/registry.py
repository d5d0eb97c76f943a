"""Registry of the export targets, and the export of a model to one of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields

from jbf.errors import InputError
from jbf.export.description import ISAAC, SDF, URDF
from jbf.export.fmu import FMU2, FMU3
from jbf.export.ledger import Ledger
from jbf.export.mjcf import MJCF
from jbf.export.modelica import MODELICA
from jbf.export.plain_c import PLAIN_C
from jbf.export.reference import Reference
from jbf.export.structured_text import STRUCTURED_TEXT
from jbf.export.table import TABLE
from jbf.export.target import Exported, Settings, Target
from jbf.models.model import Model, the_model
from jbf.records.arguments import one_of
from jbf.records.run import Run

TARGETS: dict[str, Target] = {
    target.name: target
    for target in (TABLE, PLAIN_C, STRUCTURED_TEXT, FMU2, FMU3, MODELICA, MJCF, URDF, SDF, ISAAC)
}
"""Targets by name."""
DEFAULT = Settings()


def to(
    model: Model,
    target: str,
    runs: Iterable[Run],
    *,
    settings: Settings = DEFAULT,
    max_loss: float | None = None,
) -> Exported:
    """Convert a model to the form of a target, with a ledger of the losses.

    The error of the exported form is computed along the runs, at the samples with a known direction
    of sliding. Weight, inertia and the effects of the instrument are not part of the error.

    Parameters
    ----------
    model
        The model.
    target
        Name of the target, a key of `jbf.export.TARGETS`.
    runs
        The runs from which the model was fitted, or others that it will be used for.
    settings
        Options of the targets.
    max_loss
        Largest permitted RMS error, as a share of the RMS friction.

    Returns
    -------
    Exported
        Files and ledger; `save(path)` writes the files.

    Raises
    ------
    InputError
        The target cannot represent the rig of the model or does not use a setting that
        differs from its default, the runs lack a column, or the error exceeds `max_loss`.

    Examples
    --------
    >>> import jbf.export
    >>> import numpy as np
    >>> t = np.arange(0.0, 6.0, 0.01)
    >>> run = jbf.Run.from_arrays(t, 0.1 * np.sin(t))
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> exported = jbf.export.to(model, "table", [run])
    >>> exported.ledger.share < 0.02
    True
    """
    model = the_model(model)
    chosen = TARGETS[one_of(target, TARGETS, "target")]
    check_settings(chosen.name, settings)
    reference = Reference.of(model, runs)
    written = chosen.write(reference, settings)
    ledger = Ledger(
        written.terms,
        reference.losses(written.force),
        model.rig.quantities.force,
        written.evaluated_by,
        written.notes,
    )
    if max_loss is not None and not ledger.share <= max_loss:
        raise InputError(
            problem=f"the loss of the export to {chosen.name} is {ledger.share:.3g} of the "
            f"friction ({ledger.rms:.3g} {ledger.unit}), above the permitted {max_loss:g}",
            remedy="choose another target or option, or permit more with --max-loss "
            "(max_loss in Python)",
        )
    return Exported(chosen.name, dict(written.files), ledger)


def check_settings(target: str | None, settings: Settings) -> None:
    """Raise an InputError if a setting that the target does not use differs from its default.

    The target is None for the exports that use the core, which have no settings.
    """
    used = () if target is None else TARGETS[target].settings
    for name in (field.name for field in fields(settings)):
        if getattr(settings, name) != getattr(DEFAULT, name) and name not in used:
            users = ", ".join(other.name for other in TARGETS.values() if name in other.settings)
            what = "an export without --to" if target is None else f"the target {target}"
            raise InputError(
                problem=f"{what} does not use the setting {name}",
                remedy=f"omit --{name} ({name} in Python); it is used by {users}",
            )
