"""A fitted model as source for firmware: Rust for the crate `jbf-core`, C for its C interface.

What is written holds the constants of exactly the law and the effects of the model, and the calls
that build it; the physics stays in the core, so that a step on the target has the bits of
`jbf predict`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf import _core
from jbf.errors import InputError
from jbf.models.catalogue import find_effect, find_law
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.own_effects import OwnEffect

BEARING_FIELDS = ("radius_m", "length_m", "clearance_m", "mass_kg", "viscosity_pa_s")


@dataclass(frozen=True)
class Numbers:
    """What both languages need of a model.

    `groups` has the law first, then the effects in the order of the signal chain: name, names of
    the parameters with their units, values.
    """

    law: str
    rust_type: str
    clock: str
    bearing: _core.BearingSizes | None
    load_n: float
    groups: tuple[tuple[str, tuple[str, ...], tuple[float, ...]], ...]

    @classmethod
    def of(cls, model: Model) -> Numbers:
        """Those of a model.

        Raises
        ------
        InputError
            An effect of one's own is written in Python, which no target runs.
        """
        page = find_law(model.law)
        values = {name: p.value for name, p in model.parameters.items()}  # type: ignore[union-attr]
        groups = [(model.law, [p.name for p in page.parameters], "")]
        for name in model.effects:
            effect = find_effect(name)
            if isinstance(effect, OwnEffect):
                raise InputError(
                    problem=f"the effect {name} is written in Python, which no target runs",
                    mend="write it in Rust: cargo run --example own_effect shows how",
                )
            groups.append((name, [p.name for p in effect.parameters], f"{name}."))
        return cls(
            law=model.law,
            rust_type=page.rust_type,
            clock=model.clock,
            bearing=core_bearing(model.rig),
            load_n=core_load_n(model.rig) or 1.0,
            groups=tuple(
                (name, tuple(short), tuple(values[prefix + p] for p in short))
                for name, short, prefix in groups
            ),
        )

    def title(self) -> str:
        """Law and effects, for people."""
        effects = [name for name, _, _ in self.groups[1:]]
        return f"law {self.law}; effects: {', '.join(effects) if effects else 'none'}"


def _constant(name: str) -> str:
    return name.upper()


def _rust(value: float) -> str:
    if math.isinf(value):
        return "f64::INFINITY" if value > 0 else "f64::NEG_INFINITY"
    # The shortest text that reads back to the same bits.
    return repr(float(value))


def _c(value: float) -> str:
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def rust(model: Model, source: str = "a model") -> str:
    """A Rust module: constants, checked while it is compiled, and `model::<f32 or f64>()`.

    Parameters
    ----------
    model
        The model.
    source
        Where it comes from, for the first line.
    """
    n = Numbers.of(model)
    out = [
        f"//! The friction model of {source}: {n.title()}.",
        f"//! Written by `jbf export` {_core.__version__}; needs the crate `jbf-core`.",
        "",
        "use jbf_core::effect::{Effects, Rig};",
        "use jbf_core::law::Named;",
        "use jbf_core::{Bearing, Chain, Clock, ParameterError, Real};",
        "",
    ]
    if n.bearing is not None:
        fields = [f"    .with_{name}({_rust(n.bearing[name])})" for name in BEARING_FIELDS]  # type: ignore[literal-required]
        out += [
            "/// Bearing and lubricant.",
            "pub const BEARING: Bearing = Bearing::new()",
            *fields,
            f"    .with_count({n.bearing['count']});",
        ]
    out += ["/// Load on one bearing, N.", f"pub const LOAD_N: f64 = {_rust(n.load_n)};"]
    for i, (name, short, values) in enumerate(n.groups):
        what = f"the {'effect' if i else 'law'} {name}"
        room = "effect" if i else "law"
        constant = _constant(name)
        numbers = "".join(f"    {_rust(v)}, // {p}\n" for p, v in zip(short, values, strict=True))
        out += [
            f"/// Parameters of {what}.",
            "#[rustfmt::skip]",
            f"pub const {constant}: [f64; {len(values)}] = [\n{numbers}];",
            "const _: () = assert!(",
            f'    jbf_core::{room}::fits("{name}", &{constant}),',
            f'    "{what} has other parameters, or a value is out of its bounds"',
            ");",
        ]
    sets = [
        f'    effects.set("{name}", &{_constant(name)}.map(T::of))?;' for name, _, _ in n.groups[1:]
    ]
    bearing = "Some(&BEARING)" if n.bearing else "None"
    radius, count = (
        ("BEARING.radius_m", "f64::from(BEARING.count)") if n.bearing else ("1.0", "1.0")
    )
    out += [
        "",
        "/// The type of the law.",
        f"pub type Law<T> = jbf_core::law::{n.law}::{n.rust_type}<T>;",
        "",
        "/// The model, in `f32` or `f64`.",
        "///",
        "/// # Errors",
        "/// None for the constants above; after a change of them it names the one that is wrong.",
        "pub fn model<T: Real>() -> Result<Chain<T, Law<T>>, ParameterError> {",
        "    let law = Law::build(",
        f"        {bearing},",
        "        Some(LOAD_N),",
        f"        &{_constant(n.law)}.map(T::of),",
        f"        Clock::{n.clock.capitalize()},",
        "    )?;",
        f"    let {'mut ' if sets else ''}effects = Effects::NONE;",
        *sets,
        "    let rig = Rig {",
        f"        radius_m: T::of({radius}),",
        f"        count: T::of({count}),",
        "    };",
        "    Ok(Chain { law, effects, rig })",
        "}",
    ]
    return "\n".join(out) + "\n"


def c(model: Model, source: str = "a model") -> str:
    """A C header for `jbf.h`: constants, and `model_f32_init`, `model_f64_init` and their steps.

    Parameters
    ----------
    model
        The model.
    source
        Where it comes from, for the first line.
    """
    n = Numbers.of(model)
    out = [
        f"/* The friction model of {source.replace('*/', '')}: {n.title()}.",
        f" * Written by `jbf export` {_core.__version__}; needs jbf.h and libjbf_c.a. */",
        "#ifndef JBF_MODEL_H",
        "#define JBF_MODEL_H",
        "",
        "#include <math.h>",
        "",
        '#include "jbf.h"',
        "",
    ]
    if n.bearing is not None:
        fields = [f"    .{name} = {_c(n.bearing[name])}," for name in BEARING_FIELDS]  # type: ignore[literal-required]
        out += [
            "static const jbf_bearing MODEL_BEARING = {",
            *fields,
            f"    .count = {n.bearing['count']},",
            "};",
        ]
    out += [f"static const double MODEL_LOAD_N = {_c(n.load_n)};"]
    for name, short, values in n.groups:
        numbers = "".join(f"    {_c(v)}, /* {p} */\n" for p, v in zip(short, values, strict=True))
        out += [f"static const double MODEL_{_constant(name)}[{len(values)}] = {{\n{numbers}}};"]
    bearing = "&MODEL_BEARING" if n.bearing else "NULL"
    law, law_count = f"MODEL_{_constant(n.law)}", len(n.groups[0][2])
    for kind in ("f32", "f64"):
        prefix = f"jbf_{n.law}_{kind}"
        effects = [
            f'  if (code == JBF_OK) code = {prefix}_effect(model, "{name}", '
            f"MODEL_{_constant(name)}, {len(values)}, error);"
            for name, _, values in n.groups[1:]
        ]
        out += [
            "",
            f"typedef {prefix} model_{kind};",
            f"typedef {prefix}_state model_{kind}_state;",
            f"#define model_{kind}_start {prefix}_start",
            f"#define model_{kind}_step {prefix}_step",
            f"#define model_{kind}_predict {prefix}_predict",
            "",
            "/* Build the model: JBF_OK, or what jbf.h says, with why in error (may be NULL). */",
            f"static inline int32_t model_{kind}_init(model_{kind} *model, jbf_error *error) {{",
            f"  int32_t code = {prefix}_init(model, {bearing}, MODEL_LOAD_N, {law}, "
            f"{law_count}, JBF_CLOCK_{n.clock.upper()}, error);",
            *effects,
            "  return code;",
            "}",
        ]
    return "\n".join([*out, "", "#endif"]) + "\n"
