"""Export to C for `jbf.h`, the C interface of `jbf-core`."""

from __future__ import annotations

from jbf import _core
from jbf.export.constants import Block, Language, constants
from jbf.export.numbers import Numbers
from jbf.models.model import Model

C = Language(
    infinity="INFINITY",
    prefix="MODEL_",
    bearing=Block("static const jbf_bearing MODEL_BEARING = {{", "    .{field} = {value},", "};"),
    scalar="static const double MODEL_LOAD_N = {value};",
    array=Block("static const double {name}[{count}] = {{", "    {value}, /* {parameter} */", "};"),
    about=lambda _text: [],
    # The functions of jbf.h check the values when they are called.
    check=lambda _group, _name: [],
)


def c(model: Model, source: str = "a model") -> str:
    """C header of a model for `jbf.h`, the C interface of `jbf-core`.

    The header contains constants, `model_f32_init`, `model_f64_init` and their steps.

    Parameters
    ----------
    model
        The model.
    source
        Origin of the model, for the comment in the first line.
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
        *constants(n, C),
    ]
    for kind in ("f32", "f64"):
        out += _calls(n, kind)
    return "\n".join([*out, "", "#endif"]) + "\n"


def _calls(n: Numbers, kind: str) -> list[str]:
    """C declarations of a model in one floating-point type: type names, and `model_KIND_init`.

    `kind` is `f32` or `f64`.
    """
    prefix = f"jbf_{n.law.name}_{kind}"
    bearing = "&MODEL_BEARING" if n.bearing else "NULL"
    effects = [
        f'  if (code == JBF_OK) code = {prefix}_effect(model, "{group.name}", '
        f"{C.name(group)}, {len(group.values)}, error);"
        for group in n.effects
    ]
    return [
        "",
        f"typedef {prefix} model_{kind};",
        f"typedef {prefix}_state model_{kind}_state;",
        f"#define model_{kind}_start {prefix}_start",
        f"#define model_{kind}_step {prefix}_step",
        f"#define model_{kind}_predict {prefix}_predict",
        "",
        "/* Build the model: JBF_OK, or an error code of jbf.h; error may be NULL. */",
        f"static inline int32_t model_{kind}_init(model_{kind} *model, jbf_error *error) {{",
        f"  int32_t code = {prefix}_init(model, {bearing}, MODEL_LOAD_N, {C.name(n.law)}, "
        f"{len(n.law.values)}, JBF_CLOCK_{n.clock.upper()}, error);",
        *effects,
        "  return code;",
        "}",
    ]
