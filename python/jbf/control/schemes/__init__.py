"""Compensation schemes that users can choose, with the parameters of their core implementation."""

from __future__ import annotations

from jbf.control.bench import thesis_model
from jbf.control.loop import gains
from jbf.control.schemes.carried import Observed, Table
from jbf.control.schemes.learning import LISTED_VOLTS, Learning
from jbf.control.schemes.plain import Coulomb, NoCompensation, Repetitive
from jbf.control.schemes.scheme import Scheme
from jbf.control.settings import Settings
from jbf.control.tuning import friction_level_v
from jbf.errors import InputError, did_you_mean
from jbf.models.model import Model

SCHEMES = ("none", "learning", "coulomb", "table", "repetitive", "observed")
"""Names accepted by `scheme`."""


def scheme(name: str, model: Model | None = None, settings: Settings | None = None) -> Scheme:
    """Create the compensation scheme with this name; `model` is its friction model, if it uses one.

    Without a model, the learning scheme has the parameters of Cohn (1998). A table and the observed
    compensator then have the friction that fits the bench of that thesis.

    Raises
    ------
    InputError
        The name is unknown, or the scheme does not support the model's law.
    """
    if name == "table":
        return Table(thesis_model() if model is None else model)
    if name == "observed":
        return Observed(thesis_model() if model is None else model, settings)
    if name == "learning":
        return Learning() if model is None else Learning.of(model)
    without_settings: dict[str, type[NoCompensation | Coulomb | Repetitive]] = {
        "none": NoCompensation,
        "coulomb": Coulomb,
        "repetitive": Repetitive,
    }
    if name not in without_settings:
        raise InputError(
            problem=f'scheme "{name}" is not known', remedy=did_you_mean(name, SCHEMES)
        )
    return without_settings[name]()


__all__ = [
    "LISTED_VOLTS",
    "SCHEMES",
    "Coulomb",
    "Learning",
    "NoCompensation",
    "Observed",
    "Repetitive",
    "Scheme",
    "Table",
    "friction_level_v",
    "gains",
    "scheme",
]
