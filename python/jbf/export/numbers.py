"""Data of a model for export, independent of the programming language."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf import _core
from jbf.errors import InputError
from jbf.models.catalogue import Effect, Law, Parameter, find_effect, find_law
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.user_effects import UserEffect
from jbf.models.user_laws import UserLaw


@dataclass(frozen=True)
class Group:
    """Law or effect of an exported model, with its values.

    Attributes
    ----------
    page
        Catalogue entry.
    values
        Parameter values in the order of the entry.
    held
        Reason why each value was held fixed, or None if it was estimated.
    """

    page: Law | Effect
    values: tuple[float, ...]
    held: tuple[str | None, ...]

    @property
    def name(self) -> str:
        """Name of the law or effect."""
        return self.page.name

    @property
    def room(self) -> str:
        """Name of the core's module that contains it: `law` or `effect`."""
        return "law" if isinstance(self.page, Law) else "effect"


@dataclass(frozen=True)
class Numbers:
    """Data of a model for export.

    Attributes
    ----------
    law, effects
        Law, and effects in the order of the signal chain.
    clock
        Definition of the film's time constant.
    bearing, load_n
        Dimensions of the bearing (None without one), and load on it, N.
    units
        Note on units that differ from the suffixes of names; empty without such units.
    """

    law: Group
    effects: tuple[Group, ...]
    clock: str
    bearing: _core.BearingSizes | None
    load_n: float
    units: str = ""

    @classmethod
    def of(cls, model: Model) -> Numbers:
        """Extract the data of a model; effects with an infinite null value are omitted.

        Raises
        ------
        InputError
            A law or an effect is user-defined in Python, which does not run on a target.
        """
        law = find_law(model.law)
        if isinstance(law, UserLaw):
            raise InputError(
                problem=f"the law {law.name} is written in Python and cannot be exported to "
                "Rust or C",
                remedy="write it in Rust: cargo run --example user_law shows how",
            )
        effects = []
        for name in model.effects:
            page = find_effect(name)
            if isinstance(page, UserEffect):
                raise InputError(
                    problem=f"the effect {name} is written in Python and cannot be exported to "
                    "Rust or C",
                    remedy="write it in Rust: cargo run --example user_effect shows how",
                )
            group = _group(page, model, f"{name}.")
            if not any(map(_vanishes, page.parameters, group.values)):
                effects.append(group)
        return cls(
            law=_group(law, model),
            effects=tuple(effects),
            clock=model.clock,
            bearing=core_bearing(model.rig),
            load_n=core_load_n(model.rig) or 1.0,
            units=_units_note(model),
        )

    @property
    def groups(self) -> tuple[Group, ...]:
        """Law of the model, followed by its effects."""
        return (self.law, *self.effects)

    def title(self) -> str:
        """Law and effects of the model as text."""
        effects = ", ".join(group.name for group in self.effects)
        return f"law {self.law.name}; effects: {effects or 'none'}{self.units}"


def _units_note(model: Model) -> str:
    """Note on the units of a rig whose names with suffixes of N, m and m/s hold other units.

    For example, `load_n` holds N m for a rotary drive. The note is empty if the suffixes are
    correct.
    """
    quantities = model.rig.quantities
    if quantities.force == "N" and quantities.motion != "rotary":
        return ""
    read = f"{quantities.force}, {quantities.length}, {quantities.speed}"
    return f"; read {read} for N, m, m/s"


def _group(page: Law | Effect, model: Model, prefix: str = "") -> Group:
    parameters = [model.parameters[f"{prefix}{p.name}"] for p in page.parameters]
    notes = tuple((p.note or "") if p.held else None for p in parameters)
    return Group(page, tuple(p.value for p in parameters), notes)


def _vanishes(page: Parameter, value: float) -> bool:
    """Whether a parameter has its infinite null value, at which the effect has no influence.

    The core omits such an effect, and so does the exported source.
    """
    return page.null is not None and math.isinf(page.null) and value == page.null
