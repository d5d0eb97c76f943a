"""Export to Rust for the crate `jbf-core`."""

from __future__ import annotations

from jbf import _core
from jbf.export.constants import Block, Language, constants
from jbf.export.numbers import Group, Numbers
from jbf.models.catalogue import Law
from jbf.models.model import Model


def _check(group: Group, name: str) -> list[str]:
    what = f"the {group.room} {group.name}"
    return [f'const _: () = assert!({name}.is_valid(), "a value of {what} is out of bounds");']


RUST = Language(
    infinity="f64::INFINITY",
    prefix="",
    bearing=Block("pub const BEARING: Bearing = Bearing::new()", "    .with_{field}({value})", ";"),
    scalar="pub const LOAD_N: f64 = {value};",
    array=Block(
        "#[rustfmt::skip]\npub const {name}: {module}::Parameters<f64> = {module}::Parameters {{",
        "    {field}: {value}, // {parameter}",
        "};",
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
    imports = ["Chain", "Error", "Real"]
    law = f"Law::new({RUST.name(n.law)}.cast())?"
    if n.bearing is not None:
        imports.insert(0, "Bearing")
    if isinstance(n.law.page, Law) and n.law.page.needs_bearing:
        imports.insert(2, "Clock")
        clock = f"Clock::{n.clock.capitalize()}"
        law = f"Law::new(&BEARING, LOAD_N, &{RUST.name(n.law)}.cast(), {clock})?"
    effects = "Effects<T>" if n.effects else "()"
    out = [
        f"//! The friction model of {source}: {n.title()}.",
        f"//! Written by `jbf export` {_core.__version__}; needs the crate `jbf-core`.",
        "",
        *_modules(n),
        f"use jbf_core::{{{', '.join(imports)}}};",
        "",
        *constants(n, RUST),
        "",
        "/// The type of the law.",
        f"pub type Law<T> = {_path(n.law)}<T>;",
    ]
    if n.effects:
        pairs = "()"
        for group in n.effects:
            pairs = f"({pairs}, {_path(group)}<T>)"
        out += [
            "",
            "/// The type of the effects; memory is reserved for these only.",
            "#[rustfmt::skip]",
            f"pub type Effects<T> = {pairs};",
        ]
    calls = [f".with({_path(group)}::new({RUST.name(group)}.cast())?)" for group in n.effects]
    if n.bearing is not None:
        calls.append(".on(&BEARING)")
    out += [
        "",
        "/// The model, in `f32` or `f64`.",
        "///",
        "/// # Errors",
        "/// `None` for the constants above; after a change it names the invalid one.",
        "#[rustfmt::skip]",
        f"pub fn model<T: Real>() -> Result<Chain<T, Law<T>, {effects}>, Error> {{",
        f"    let law = {law};",
        "    Ok(Chain::new(law)",
        *(f"        {call}" for call in calls),
        "    )",
        "}",
    ]
    return "\n".join(out) + "\n"


def _modules(n: Numbers) -> list[str]:
    """Imports of the modules of the law and the effects."""
    effects = [group.name for group in n.effects]
    return [
        *([f"use jbf_core::effect::{{{', '.join(effects)}}};"] if effects else []),
        f"use jbf_core::law::{n.law.name};",
    ]


def _path(group: Group) -> str:
    """Rust type of a law or an effect, without its number type."""
    return f"{group.name}::{group.page.rust_type}"
