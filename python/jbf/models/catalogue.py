"""Laws and effects as the core lists them: names, forms, bounds, starting values."""

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

Stage = Literal["drive", "lubricant", "film", "contact", "other friction", "instrument"]
"""Where in the signal chain an effect acts."""


class _Summed(Protocol):
    @property
    def summary(self) -> str: ...


BESIDE = ("other friction", "instrument")
"""Stages whose effects go with a law of one's own: they add to its force, or act on the sum. The
others change a law's own parts, which nobody knows of such a one."""
CARRIER = "coulomb"
"""The core's law that carries the effects of a law of one's own, with next to no force itself."""

Page = TypeVar("Page", bound=_Summed)


@dataclass(frozen=True)
class Parameter:
    """One parameter of a law or an effect; `name` carries the unit.

    Attributes
    ----------
    lower, upper
        Bounds, in the unit.
    null
        The value at which the effect vanishes, where this parameter has one.
    starts
        Where a fit may start, likeliest first.
    log
        True where a fit should walk in the logarithm.
    period
        The period of an angle, for parameters that wrap.
    start
        Of what in the data it is about the size, where the law is one in newtons: a fit then
        starts there. "catalogue" where `starts` always hold.
    bound
        What in the data bounds it from above: "transition_speed" the fastest speed on record,
        "catalogue" nothing.
    stated
        True of a number that no fit finds: it is held where it starts, or is fixed elsewhere.
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
    """Pages by name, shown as a short table."""

    def __repr__(self) -> str:
        widest = max(map(len, self), default=0)
        return "\n".join(
            f"{name:<{widest}}  {shorten(page.summary, 56, placeholder=' ...')}"
            for name, page in self.items()
        )


@dataclass(frozen=True, repr=False)
class Effect:
    """The page of one effect.

    `needs` names what it needs of the law and of the record; `refused` tells for each law that
    it does not go with why: "the law ...". `moves_jumps` is true where a parameter moves the
    instants at which friction jumps, `spreads_jumps` where what is read of a jump lasts; `peaks` is
    the parameter along which a likelihood has many peaks, None for most; `further_of` the effect of
    which this is a further one, None for most; `unknown_start` is true where a run's first sample
    does not tell the state in which it begins, and time does not let that be forgotten.
    `rust_place` and `rust_type` are the names of its types in the core, empty
    of an effect of one's own; `columns` are those that such an effect asks for.
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
    rust_place: str = ""
    rust_type: str = ""

    def __repr__(self) -> str:
        return f"Effect({self.name}, {self.stage}: {self.summary})"


@dataclass(frozen=True, repr=False)
class Law:
    """The page of one base law.

    A law that does not need a bearing gives newtons and needs no load either. `rust_type` is the
    name of its type in the core.
    """

    name: str
    summary: str
    equation: str
    source: str
    limits: str
    needs_bearing: bool
    has_film: bool
    has_bristle: bool
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
    """The core's effects by name, in the order of the signal chain."""
    pages = {}
    for page in _core.effects():
        fields = dict(page)
        fields["parameters"] = tuple(_parameter(p) for p in page["parameters"])
        fields["needs"] = tuple(page["needs"])
        pages[page["name"]] = Effect(**fields)  # type: ignore[arg-type]
    return pages


_own: dict[str, Effect] = {}


def own() -> dict[str, Effect]:
    """Effects of one's own that are registered now."""
    return _own


def put(page: Effect) -> None:
    """Take an effect of one's own in."""
    _own[page.name] = page
    vocabulary.cache_clear()


def drop(name: str) -> bool:
    """Take an effect of one's own out; False where there is none of that name."""
    vocabulary.cache_clear()
    return _own.pop(name, None) is not None


def effects() -> Pages[Effect]:
    """Every effect by name, in the order of the signal chain; one's own come last."""
    return Pages({**built_in(), **_own})


@cache
def built_in_laws() -> Pages[Law]:
    """The core's laws by name."""
    pages = Pages[Law]()
    for page in _core.laws():
        fields = dict(page)
        fields["parameters"] = tuple(_parameter(p) for p in page["parameters"])
        pages[page["name"]] = Law(**fields)  # type: ignore[arg-type]
    return pages


_own_laws: dict[str, Law] = {}


def own_laws() -> dict[str, Law]:
    """Laws of one's own that are registered now."""
    return _own_laws


def put_law(page: Law) -> None:
    """Take a law of one's own in."""
    _own_laws[page.name] = page
    vocabulary.cache_clear()


def drop_law(name: str) -> bool:
    """Take a law of one's own out; False where there is none of that name."""
    vocabulary.cache_clear()
    return _own_laws.pop(name, None) is not None


def laws() -> Pages[Law]:
    """Every base law by name; one's own come last."""
    return Pages({**built_in_laws(), **_own_laws})


def find_effect(name: str) -> Effect:
    """The effect of that name.

    Raises
    ------
    InputError
        Names the unknown effect and the nearest known one.
    """
    known = effects()
    if not isinstance(name, str) or name not in known:
        raise InputError(
            problem=f'there is no effect "{name}"',
            mend=f"{did_you_mean(name, known)} (`jbf effects` lists them)",
        )
    return known[name]


def find_law(name: str) -> Law:
    """The law of that name; an InputError names an unknown one."""
    known = laws()
    return known[one_of(name, known, "law")]


def find_clock(name: str) -> Clock:
    """The clock of that name; an InputError names an unknown one."""
    return one_of(name, CLOCKS, "clock")


def why_not(effect: Effect, law: str) -> str | None:
    """Why an effect does not go with a law: "the law ..."; None where it does."""
    if law not in _own_laws:
        return effect.refused.get(law)
    if effect.stage not in BESIDE:
        return "is one of your own, and the effect changes parts of a law that nobody knows of it"
    return effect.refused.get(CARRIER)


def check_applies(law: str, names: Iterable[str]) -> None:
    """An InputError where one of the effects does not go with a law."""
    page = find_law(law)
    for name in names:
        reason = why_not(find_effect(name), page.name)
        if reason is not None:
            raise InputError(
                problem=f"the effect {name} does not apply: the law {page.name} {reason}",
                mend=f"leave it out (`jbf effects --law {page.name}` lists what applies)",
            )


def transition_speed(law: str, values: Sequence[float]) -> float | None:
    """Speed (m/s) at which a law's film carries the load alone; None of a law without one."""
    pages = zip(find_law(law).parameters, values, strict=False)
    return next((float(v) for p, v in pages if p.bound == "transition_speed"), None)


def may_come(name: str, present: Collection[str]) -> bool:
    """True where an effect says something of its own beside those present: a further one of another
    does beside that one only."""
    page = effects().get(name)
    return page is None or page.further_of is None or page.further_of in present


def may_go(name: str, present: Collection[str]) -> bool:
    """True where none of those present is a further one of an effect."""
    pages = effects()
    return not any(e in pages and pages[e].further_of == name for e in present)


def in_chain_order(names: Iterable[str]) -> tuple[str, ...]:
    """The effects in the order of the signal chain, each once."""
    chosen = {find_effect(name).name for name in checked_names(names, "effects")}
    return tuple(name for name in effects() if name in chosen)


def parameters_of(law: str, chosen: tuple[str, ...]) -> dict[str, Parameter]:
    """Dotted name to parameter: the law's first, then each effect's."""
    found = {p.name: p for p in find_law(law).parameters}
    for name in chosen:
        found |= {f"{name}.{p.name}": p for p in find_effect(name).parameters}
    return found


def find_parameter(name: str, known: Collection[str]) -> str:
    """The full dotted name of a parameter given with or without its unit.

    `presliding.sigma` finds `presliding.sigma_1_m`; an InputError names an unknown one.
    """
    if name in known:
        return name
    longer = [full for full in known if full.startswith(f"{name}_")]
    if len(longer) == 1:
        return longer[0]
    raise InputError(problem=f'there is no parameter "{name}"', mend=did_you_mean(name, known))


@cache
def vocabulary() -> Vocabulary:
    """What a model file may say."""

    def bounds(parameters: tuple[Parameter, ...]) -> dict[str, tuple[float, float]]:
        return {p.name: (min(p.lower, _null(p)), max(p.upper, _null(p))) for p in parameters}

    return Vocabulary(
        laws=tuple(laws()),
        effects={e.name: bounds(e.parameters) for e in effects().values()},
        law_parameters={x.name: bounds(x.parameters) for x in laws().values()},
    )


def _null(parameter: Parameter) -> float:
    return parameter.lower if parameter.null is None else parameter.null
