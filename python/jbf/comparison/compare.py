"""Comparison of one or several models with recorded runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import overload

from jbf.comparison.comparison import Comparison, compare_prepared
from jbf.comparison.model_comparison import ModelComparison, compare_models
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.posterior_motions import corrected_for_delay
from jbf.models.model import Model, the_model
from jbf.records.arguments import by_name, list_of_runs
from jbf.records.run import Run


@overload
def compare(model: Model, runs: Sequence[Run]) -> Comparison: ...


@overload
def compare(
    model: Sequence[Model] | Mapping[str, Model], runs: Sequence[Run]
) -> ModelComparison: ...


def compare(
    model: Model | Sequence[Model] | Mapping[str, Model], runs: Sequence[Run]
) -> Comparison | ModelComparison:
    """Compare a model with recorded runs, or several models with each other.

    Samples at rest, and samples at which the sign of the motion is unknown (within a few samples of
    a reversal), are excluded.

    Parameters
    ----------
    model
        A model; or several models, in a list or by name. In a list, a model is named by its law and
        effects.
    runs
        Runs with friction.

    Returns
    -------
    Comparison or ModelComparison
        Size and location of the errors of one model; or one row for each of several models, the
        best first, with the standard error of the difference.

    Raises
    ------
    InputError
        A run lacks friction or a column that a model needs, nothing moves in it, or several models
        are of machines with different units.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> v = 0.1 * np.sin(2.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 6.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> compared = jbf.compare(model, [run])
    >>> "direction" in [failure.axis for failure in compared.failures]
    True
    """
    if isinstance(model, Mapping):
        named = by_name(model, "model")
    elif isinstance(model, Iterable) and not isinstance(model, str):
        named = _named(list(model))
    else:
        return _compared(the_model(model), list_of_runs(runs))
    if not named:
        raise InputError(problem="no model was given", remedy="give at least one jbf.Model")
    runs = list_of_runs(runs)
    units = {the_model(compared_model).rig.quantities.force for compared_model in named.values()}
    if len(units) > 1:
        raise InputError(
            problem=f"the models predict friction in {' and '.join(sorted(units))}",
            remedy="compare models of one machine",
        )
    # Drop readings near both ends that the delay of a model shifts outside the recorded motion, so
    # that all models are compared at the same samples.
    margin_s = max(abs(model.force_delay_s) for model in named.values())
    return compare_models({name: _compared(each, runs, margin_s) for name, each in named.items()})


def _compared(model: Model, runs: Sequence[Run], margin_s: float = 0.0) -> Comparison:
    """Compare a model with recorded runs that have the columns it requires."""
    for run in runs:
        model.require_columns(run)
    campaign = Campaign.prepare(model.rig, runs)
    return compare_prepared(model, corrected_for_delay(campaign, model.force_delay_s, margin_s))


def _named(models: Sequence[Model]) -> dict[str, Model]:
    """Name models by law and effects; equal names are numbered."""
    names = [" + ".join([the_model(m).law, *m.effects]) for m in models]
    numbered = [
        f"{name} ({names[: i + 1].count(name)})" if names.count(name) > 1 else name
        for i, name in enumerate(names)
    ]
    return dict(zip(numbered, models, strict=True))
