"""Export to Rust for the crate `jbf-core`."""

from __future__ import annotations

from jbf import _core
from jbf.export.constants import Block, Language, constants
from jbf.export.numbers import Group, Numbers
from jbf.models.catalogue import Law
from jbf.models.model import Model


def _check(group: Group, name: str) -> list[str]:
    what = f"the {group.room} {group.name}"
    return [
        "const _: () = assert!(",
        f'    jbf_core::{group.room}::fits("{group.name}", &{name}),',
        f'    "{what} has other parameters, or a value out of bounds"',
        ");",
    ]


RUST = Language(
    infinity="f64::INFINITY",
    prefix="",
    bearing=Block("pub const BEARING: Bearing = Bearing::new()", "    .with_{field}({value})", ";"),
    scalar="pub const LOAD_N: f64 = {value};",
    # One named value per line; rustfmt would join them.
    array=Block(
        "#[rustfmt::skip]\npub const {name}: [f64; {count}] = [",
        "    {value}, // {parameter}",
        "];",
    ),
    about=lambda text: [f"/// {text}"],
    check=_check,
)


def rust(model: Model, source: str = "a model") -> str:
    """Rust module of a model, with constants checked at compile time and a constructor.

    The constructor is `model::<f32>()` or `model::<f64>()`.

    Parameters
    ----------
    model
        The model.
    source
        Origin of the model, for the comment in the first line.
    """
    n = Numbers.of(model)
    imports = ["Chain", "Clock", "ParameterError", "Real"]
    if n.bearing is not None:
        imports.insert(0, "Bearing")
    effects = "Effects<T>" if n.effects else "()"
    bearing = "Some(&BEARING)" if n.bearing is not None else "None"
    out = [
        f"//! The friction model of {source}: {n.title()}.",
        f"//! Written by `jbf export` {_core.__version__}; needs the crate `jbf-core`.",
        "",
        *(["use jbf_core::effect::Place;"] if n.effects else []),
        "use jbf_core::law::Named;",
        f"use jbf_core::{{{', '.join(imports)}}};",
        "",
        *constants(n, RUST),
        "",
        "/// The type of the law.",
        f"pub type Law<T> = {_path(n.law)};",
    ]
    if n.effects:
        out += [
            "",
            "/// The type of the effects; memory is reserved for these only.",
            f"pub type Effects<T> = {_nested([_path(group) for group in n.effects])};",
        ]
    placed = [f"Place::new(&{RUST.name(group)}.map(T::of))?" for group in n.effects]
    out += [
        "",
        "/// The model, in `f32` or `f64`.",
        "///",
        "/// # Errors",
        "/// `None` for the constants above; after a change it names the invalid one.",
        f"pub fn model<T: Real>() -> Result<Chain<T, Law<T>, {effects}>, ParameterError> {{",
        "    let law = Law::build(",
        f"        {bearing},",
        "        Some(LOAD_N),",
        f"        &{RUST.name(n.law)}.map(T::of),",
        f"        Clock::{n.clock.capitalize()},",
        "    )?;",
        *([f"    let effects = {_nested(placed, '    ')};"] if placed else []),
        f"    Ok(Chain::round(law, {'effects' if placed else '()'}, {bearing}))",
        "}",
    ]
    return "\n".join(out) + "\n"


def _path(group: Group) -> str:
    """Rust type of a law, or of an effect at its stage."""
    if isinstance(group.page, Law):
        return f"jbf_core::law::{group.name}::{group.page.rust_type}<T>"
    effect = f"jbf_core::effect::{group.name}::{group.page.rust_type}<T>"
    return f"jbf_core::effect::{group.page.rust_place}<{effect}>"


def _nested(items: list[str], indent: str = "") -> str:
    """Nested Rust pairs, one item per line, which form a typed set of effects."""
    if not items:
        return "()"
    first, *more = items
    if not more:
        return first
    inner = indent + "    "
    return f"(\n{inner}{first},\n{inner}{_nested(more, inner)},\n{indent})"
