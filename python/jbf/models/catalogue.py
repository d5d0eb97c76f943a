"""Catalogue of built-in and user-defined laws and effects, with their parameters."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from textwrap import shorten
from typing import Literal, Protocol, TypeVar

import numpy as np

from jbf import _core
from jbf.errors import InputError, did_you_mean
from jbf.models.vocabulary import CLOCKS, Clock, Vocabulary
from jbf.records.arguments import names as checked_names
from jbf.records.arguments import one_of
from jbf.renamed import current_effect, current_parameter

Stage = Literal["drive", "lubricant", "film", "contact", "other friction", "instrument"]
"""Position of an effect in the signal chain from drive to instrument."""


class _Summed(Protocol):
    @property
    def summary(self) -> str: ...


COMBINABLE_STAGES = ("other friction", "instrument")
"""Stages whose effects can be combined with a user-defined law.

The effects add to the force of the law, or act on the sum. Effects of the other stages modify
internal terms of a law, which are unknown for a user-defined law.
"""
CARRIER = "coulomb"
"""Built-in law with negligible force that carries the effects of a user-defined law."""

Page = TypeVar("Page", bound=_Summed)


@dataclass(frozen=True)
class Parameter:
    """Description of a parameter of a law or an effect.

    Attributes
    ----------
    name, unit, meaning
        Name, unit and description.
    lower, upper
        Bounds, in the unit.
    null
        Value at which the effect vanishes; None if there is no such value.
    starts
        Starting values of a fit, the most likely first.
    log
        True if a fit should use the logarithm of the parameter.
    period
        The period of an angle, for parameters that wrap.
    start
        Quantity of the data from which the starting value is derived, for a law in newtons.
        "catalogue" if `starts` always apply.
    bound
        Quantity of the data that is an upper bound: "transition_speed" is the highest recorded
        speed, "catalogue" means no such bound.
    stated
        True if the parameter is not estimated by a fit: it is held at its starting value, or
        determined by other means.

    Examples
    --------
    >>> level = jbf.Parameter("c", "N", "level", lower=0.0, upper=100.0, null=0.0, starts=(1.0,))
    >>> level.upper
    100.0
    """

    name: str
    unit: str = "-"
    meaning: str = ""
    lower: float = -np.inf
    upper: float = np.inf
    null: float | None = None
    starts: tuple[float, ...] = ()
    log: bool = False
    period: float | None = None
    start: str = "catalogue"
    bound: str = "catalogue"
    stated: bool = False


class Pages(dict[str, Page]):
    """Mapping of names to catalogue entries, displayed as a short table."""

    def __repr__(self) -> str:
        widest = max(map(len, self), default=0)
        return "\n".join(
            f"{name:<{widest}}  {shorten(page.summary, 56, placeholder=' ...')}"
            for name, page in self.items()
        )


@dataclass(frozen=True, repr=False)
class Effect:
    """Catalogue entry of an effect: its texts, its properties and its parameters.

    Attributes
    ----------
    needs
        Requirements on the law and the record.
    refused
        Laws with which the effect cannot be combined, each with the reason ("the law ...").
    moves_jumps
        True if a parameter shifts the instants at which friction jumps.
    spreads_jumps
        True if the effect distributes the reading of a jump over time.
    peaks
        Parameter in which the likelihood is multimodal; None for most effects.
    longest_step_s
        Longest integration step, s.
    further_of
        Effect of which this one is an additional instance; None for most effects.
    unknown_start
        Whether the initial state is unknown, and only a reversal of the input erases its influence.
    erased_by_sliding
        Whether the initial state is unknown, and sliding erases its influence.
    rust_type
        Rust type of the effect in the core; empty for a user-defined effect.
    columns
        Columns that a user-defined effect requires.
    """

    name: str
    stage: Stage
    summary: str
    equation: str
    source: str
    limits: str
    needs: tuple[str, ...]
    refused: Mapping[str, str]
    moves_jumps: bool
    spreads_jumps: bool
    peaks: str | None
    longest_step_s: float
    parameters: tuple[Parameter, ...]
    columns: tuple[str, ...] = ()
    further_of: str | None = None
    unknown_start: bool = False
    erased_by_sliding: bool = False
    rust_type: str = ""

    def __repr__(self) -> str:
        return f"Effect({self.name}, {self.stage}: {self.summary})"


@dataclass(frozen=True, repr=False)
class Law:
    """Catalogue entry of a base law: its texts, its state and its parameters.

    A law that does not need a bearing returns a force, N, and does not need a load. `has_memory` is
    true for a law with any state, that of a film or of a bristle included. `rust_type` is the Rust
    type of the law in the core.
    """

    name: str
    summary: str
    equation: str
    source: str
    limits: str
    needs_bearing: bool
    has_film: bool
    has_bristle: bool
    has_memory: bool
    rust_type: str
    parameters: tuple[Parameter, ...]

    def __repr__(self) -> str:
        return f"Law({self.name}: {self.summary})"


def _parameter(page: _core.ParameterPage) -> Parameter:
    fields = dict(page)
    fields["starts"] = tuple(page["starts"])
    return Parameter(**fields)  # type: ignore[arg-type]


@cache
def built_in() -> dict[str, Effect]:
    """Built-in effects by name, in the order of the signal chain."""
    pages = {}
    for page in _core.effects():
        fields = dict(page)
        fields["parameters"] = tuple(_parameter(p) for p in page["parameters"])
        fields["needs"] = tuple(page["needs"])
        pages[page["name"]] = Effect(**fields)  # type: ignore[arg-type]
    return pages


_user_effects: dict[str, Effect] = {}


def user_effects() -> dict[str, Effect]:
    """Currently registered user-defined effects, by name."""
    return _user_effects


def put(page: Effect) -> None:
    """Register a user-defined effect."""
    _user_effects[page.name] = page
    vocabulary.cache_clear()


def drop(name: str) -> bool:
    """Unregister a user-defined effect; return False if there is no effect of that name."""
    vocabulary.cache_clear()
    return _user_effects.pop(name, None) is not None


def effects() -> Pages[Effect]:
    """Return all effects by name, in the order of the signal chain; user-defined effects are last.

    Returns
    -------
    dict of str to Effect
        Equation, source, limits and parameters of each effect.

    Examples
    --------
    >>> jbf.effects()["sensor_offset"].parameters[0].unit
    'N'
    """
    return Pages({**built_in(), **_user_effects})


@cache
def built_in_laws() -> Pages[Law]:
    """Built-in laws by name."""
    pages = Pages[Law]()
    for page in _core.laws():
        fields = dict(page)
        fields["parameters"] = tuple(_parameter(p) for p in page["parameters"])
        pages[page["name"]] = Law(**fields)  # type: ignore[arg-type]
    return pages


_user_laws: dict[str, Law] = {}


def user_laws() -> dict[str, Law]:
    """Currently registered user-defined laws, by name."""
    return _user_laws


def put_law(page: Law) -> None:
    """Register a user-defined law."""
    _user_laws[page.name] = page
    vocabulary.cache_clear()


def drop_law(name: str) -> bool:
    """Unregister a user-defined law; return False if there is no law of that name."""
    vocabulary.cache_clear()
    return _user_laws.pop(name, None) is not None


def laws() -> Pages[Law]:
    """Return all base laws by name; user-defined laws are last.

    Returns
    -------
    dict of str to Law
        Equation, source and parameters of each law.

    Examples
    --------
    >>> [p.unit for p in jbf.laws()["coulomb"].parameters]
    ['N', 'N', 'N s/m']
    """
    return Pages({**built_in_laws(), **_user_laws})


def find_effect(name: str) -> Effect:
    """Return the catalogue entry of an effect.

    Raises
    ------
    InputError
        The effect is unknown; the message suggests the most similar name.
    """
    catalogue = effects()
    if isinstance(name, str):
        name = current_effect(name, catalogue)
    if not isinstance(name, str) or name not in catalogue:
        raise InputError(
            problem=f'effect "{name}" is not known',
            remedy=f"{did_you_mean(name, catalogue)} (`jbf effects` lists them)",
        )
    return catalogue[name]


def find_law(name: str) -> Law:
    """Return the catalogue entry of a law; raise an InputError if the name is unknown."""
    catalogue = laws()
    return catalogue[one_of(name, catalogue, "law")]


def find_clock(name: str) -> Clock:
    """Check the name of a film's time scale and return it; raise an InputError if unknown."""
    return one_of(name, CLOCKS, "clock")


def reason_not_applicable(effect: Effect, law: str) -> str | None:
    """Reason why an effect cannot be combined with a law ("the law ..."), or None if it can."""
    if law not in _user_laws:
        return effect.refused.get(law)
    if effect.stage not in COMBINABLE_STAGES:
        return (
            "is user-defined, and the effect changes parts of a law that a user-defined law does "
            "not expose"
        )
    return effect.refused.get(CARRIER)


def check_applies(law: str, names: Iterable[str]) -> None:
    """Raise an InputError if one of the effects cannot be combined with a law."""
    page = find_law(law)
    for name in names:
        reason = reason_not_applicable(find_effect(name), page.name)
        if reason is not None:
            raise InputError(
                problem=f"the effect {name} does not apply: the law {page.name} {reason}",
                remedy=f"omit it (`jbf effects --law {page.name}` lists what applies)",
            )


def transition_speed(law: str, values: Sequence[float]) -> float | None:
    """Speed, m/s, above which the film carries the full load; None for a law without a film."""
    pages = zip(find_law(law).parameters, values, strict=False)
    return next((float(v) for p, v in pages if p.bound == "transition_speed"), None)


def can_be_added(name: str, present: Collection[str]) -> bool:
    """Whether an effect can be added to the effects in `present`.

    An additional instance of an effect requires the first instance.
    """
    page = effects().get(name)
    return page is None or page.further_of is None or page.further_of in present


def can_be_removed(name: str, present: Collection[str]) -> bool:
    """Whether an effect can be removed: `present` contains no further instance of it."""
    pages = effects()
    return not any(e in pages and pages[e].further_of == name for e in present)


def in_chain_order(names: Iterable[str]) -> tuple[str, ...]:
    """Names of the effects in the order of the signal chain, without duplicates."""
    chosen = {find_effect(name).name for name in checked_names(names, "effects")}
    return tuple(name for name in effects() if name in chosen)


def parameters_of(law: str, chosen: tuple[str, ...]) -> dict[str, Parameter]:
    """Map dotted names to parameters: those of the law first, then those of each effect."""
    parameters = {p.name: p for p in find_law(law).parameters}
    for name in chosen:
        parameters |= {f"{name}.{p.name}": p for p in find_effect(name).parameters}
    return parameters


def find_parameter(name: str, names: Collection[str]) -> str:
    """Full dotted name of a parameter that is given with or without its unit.

    For example, `warm_up.tau` yields `warm_up.tau_s`. An old name yields the current one. An
    InputError is raised for an unknown name.
    """
    name = current_parameter(name, names)
    if name in names:
        return name
    longer = [full for full in names if full.startswith(f"{name}_")]
    if len(longer) == 1:
        return longer[0]
    raise InputError(problem=f'parameter "{name}" is not known', remedy=did_you_mean(name, names))


@cache
def vocabulary() -> Vocabulary:
    """Names and bounds that are valid in a model file."""

    def bounds(parameters: tuple[Parameter, ...]) -> dict[str, tuple[float, float]]:
        return {p.name: (min(p.lower, _null(p)), max(p.upper, _null(p))) for p in parameters}

    return Vocabulary(
        laws=tuple(laws()),
        effects={e.name: bounds(e.parameters) for e in effects().values()},
        law_parameters={x.name: bounds(x.parameters) for x in laws().values()},
    )


def _null(parameter: Parameter) -> float:
    """Null of a parameter; its lower bound if it has no null."""
    return parameter.lower if parameter.null is None else parameter.null
