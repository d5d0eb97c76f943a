"""What any language needs of a model: names, numbers, and the core's types."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf import _core
from jbf.errors import InputError
from jbf.models.catalogue import Effect, Law, Parameter, find_effect, find_law
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.own_effects import OwnEffect
from jbf.models.own_laws import OwnLaw


@dataclass(frozen=True)
class Group:
    """The law, or one effect: its page, and its values in the page's order.

    `held` has for each value why it is held, None where it was determined.
    """

    page: Law | Effect
    values: tuple[float, ...]
    held: tuple[str | None, ...]

    @property
    def name(self) -> str:
        """The fixed name."""
        return self.page.name

    @property
    def room(self) -> str:
        """Where the core has it: `law` or `effect`."""
        return "law" if isinstance(self.page, Law) else "effect"


@dataclass(frozen=True)
class Numbers:
    """A model's numbers; the effects in the order of the signal chain."""

    law: Group
    effects: tuple[Group, ...]
    clock: str
    bearing: _core.BearingSizes | None
    load_n: float
    units: str = ""

    @classmethod
    def of(cls, model: Model) -> Numbers:
        """Those of a model; an effect at an infinite null is not in it.

        Raises
        ------
        InputError
            An effect of one's own is written in Python, which no target runs.
        """
        law = find_law(model.law)
        if isinstance(law, OwnLaw):
            raise InputError(
                problem=f"the law {law.name} is written in Python, which no target runs",
                mend="write it in Rust: cargo run --example own_law shows how",
            )
        effects = []
        for name in model.effects:
            page = find_effect(name)
            if isinstance(page, OwnEffect):
                raise InputError(
                    problem=f"the effect {name} is written in Python, which no target runs",
                    mend="write it in Rust: cargo run --example own_effect shows how",
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
        """The law first, then the effects."""
        return (self.law, *self.effects)

    def title(self) -> str:
        """Law and effects, for people."""
        effects = ", ".join(group.name for group in self.effects)
        return f"law {self.law.name}; effects: {effects or 'none'}{self.units}"


def _units_note(model: Model) -> str:
    """What the units in the names mean; empty where they are true."""
    quantities = model.rig.quantities
    if quantities.force == "N" and quantities.motion != "rotary":
        return ""
    read = f"{quantities.force}, {quantities.length}, {quantities.speed}"
    return f"; read {read} for N, m, m/s"


def _group(page: Law | Effect, model: Model, prefix: str = "") -> Group:
    own = [model.parameters[f"{prefix}{p.name}"] for p in page.parameters]
    held = tuple((p.note or "") if p.held else None for p in own)
    return Group(page, tuple(p.value for p in own), held)


def _vanishes(page: Parameter, value: float) -> bool:
    """True at an infinite null: the core leaves such an effect out, and so does what is written."""
    return page.null is not None and math.isinf(page.null) and value == page.null
