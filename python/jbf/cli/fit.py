"""`jbf fit RIG RUN... [--out MODEL]`: fit the base law with the named effects."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.cli import hold_out, inputs, outputs, time_limit
from jbf.cli.arguments import (
    Commands,
    LawOptions,
    add_effects_from,
    add_law,
    add_rig,
    add_runs,
    command,
)
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import Report, shown
from jbf.errors import InputError, Stopped, Unfinished, quoted
from jbf.models.catalogue import (
    Parameter,
    check_applies,
    find_parameter,
    in_chain_order,
    parameters_of,
)

if TYPE_CHECKING:
    from jbf.estimation.fit import Fit
    from jbf.estimation.work import TimeLimit
    from jbf.records.run import Run


@dataclass(frozen=True)
class FitOptions:
    """Arguments of `jbf fit`."""

    rig: str
    runs: tuple[str, ...]
    effects: str
    law: LawOptions
    fix: tuple[str, ...]
    start: tuple[str, ...]
    bounds: tuple[str, ...]
    bootstrap: int | None
    hold_out: tuple[str, ...]
    out: str | None
    effects_from: tuple[str, ...]
    time_limit: str | None


def add(commands: Commands) -> None:
    """Add `jbf fit` to the parser."""
    parser = command(commands, "fit", COMMANDS["fit"], FitOptions, run)
    add_rig(parser)
    add_runs(parser, needed=False)
    parser.add_argument(
        "--effects",
        metavar="A,B",
        default="",
        help="effects to fit in addition to the law (jbf effects lists them)",
    )
    add_law(parser, also="; default: journal for a bearing, otherwise coulomb")
    parser.add_argument(
        "--fix",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="fix a parameter at a value, SI units; may be repeated",
    )
    parser.add_argument(
        "--start",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="start value of a parameter, SI units; may be repeated",
    )
    parser.add_argument(
        "--bounds",
        metavar="NAME=LOW:HIGH",
        action="append",
        default=[],
        help="bounds of a parameter, SI units; either may be omitted; may be repeated",
    )
    parser.add_argument(
        "--bootstrap",
        metavar="N",
        type=int,
        help="standard errors from N fits to simulated records of the same runs (at least 19; "
        "takes N times as long)",
    )
    time_limit.add(parser, "then the fit is aborted, and --out receives the best model so far")
    hold_out.add(parser)
    parser.add_argument("--out", metavar="MODEL", help="write the fitted model (TOML)")
    add_effects_from(parser)


def run(options: FitOptions) -> int:
    """Run `jbf fit` and return its exit code."""
    limit = time_limit.time_limit(options.time_limit)
    targets = {"--out": options.out}
    if not options.runs and not os.path.isdir(options.rig):
        raise InputError(
            file="jbf fit", problem="RUN is missing", remedy="name the runs after the rig"
        )
    outputs.check(targets, outputs.inputs_in(options.rig, options.runs, options.effects_from))
    effects = in_chain_order(name.strip() for name in options.effects.split(",") if name.strip())
    rig, runs = inputs.campaign(options.rig, options.runs, options.law.law)
    law = inputs.law_of_fit(rig, options.law.law)
    check_applies(law, effects)
    fixed = _values("--fix", options.fix, law, effects)
    start = _values("--start", options.start, law, effects)
    bounds = _bounds(options.bounds, law, effects)
    outputs.check(targets, [run.path for run in runs if run.path])
    runs, held_out = hold_out.split(runs, options.hold_out)

    from jbf.estimation.fit import fit

    repeats = options.bootstrap
    if repeats is not None:
        from jbf.estimation.bootstrap import check_repeats

        check_repeats(repeats, "--bootstrap")
    try:
        with shown("fitting", time_limit=limit) as report:
            fitted = fit(
                rig,
                runs,
                effects,
                law=law,
                clock=options.law.clock,
                start=start,
                fixed=fixed,
                bounds=bounds,
                time_limit_s=limit,
            )
            if repeats is not None:
                fitted = _bootstrapped(fitted, runs, repeats, report, limit)
    except Stopped as stop:
        raise outputs.keep(stop, options.out) from None
    except Unfinished as end:
        raise outputs.keep_unfinished(end, options.out) from None
    held_out_error = hold_out.error_for_json(fitted.model, held_out)
    if options.out:
        outputs.write({options.out: fitted.model.to_toml()})
    outputs.say(
        "\n".join([fitted.report(), *hold_out.words(fitted.model, held_out_error)]), targets
    )
    return 0


def _bootstrapped(
    fitted: Fit, runs: list[Run], repeats: int, report: Report, limit: TimeLimit | None
) -> Fit:
    """Return the fit with bootstrap standard errors.

    An interrupt raises `Stopped` with the fit.
    """
    from jbf.estimation.bootstrap import bootstrap

    try:
        return bootstrap(fitted, runs, repeats=repeats, progress=report, time_limit_s=limit).fit
    except KeyboardInterrupt:
        raise Stopped(fitted) from None


def _values(
    option: str, items: tuple[str, ...], law: str, effects: tuple[str, ...]
) -> dict[str, float]:
    """Parse the items `NAME=VALUE` of an option into values by full parameter name."""
    values: dict[str, float] = {}
    for place, name, page, text in _parsed(option, items, "VALUE", law, effects):
        value = _number(text, place, "NAME=VALUE")
        if not (page.lower <= value <= page.upper or value == page.null):
            raise InputError(
                file=place,
                problem="is out of range",
                remedy=f"choose a value from {page.lower:g} to {page.upper:g}",
            )
        values[name] = value
    return values


def _bounds(
    items: tuple[str, ...], law: str, effects: tuple[str, ...]
) -> dict[str, tuple[float, float]]:
    """Parse the items `NAME=LOW:HIGH` of `--bounds` into pairs by full parameter name.

    An omitted end is the bound of the catalogue.
    """
    pairs: dict[str, tuple[float, float]] = {}
    for place, name, page, text in _parsed("--bounds", items, "LOW:HIGH", law, effects):
        ends = text.split(":")
        if len(ends) != 2:
            raise InputError(file=place, problem="is not an interval", remedy="write NAME=LOW:HIGH")
        low, high = (
            _number(end, place, "NAME=LOW:HIGH") if end.strip() else limit
            for end, limit in zip(ends, (page.lower, page.upper), strict=True)
        )
        if not max(low, page.lower) < min(high, page.upper):
            raise InputError(
                file=place,
                problem="contains no interval of permitted values",
                remedy=f"give LOW < HIGH within {page.lower:g} to {page.upper:g}, or use --fix",
            )
        pairs[name] = low, high
    return pairs


def _parsed(
    option: str, items: tuple[str, ...], form: str, law: str, effects: tuple[str, ...]
) -> Iterator[tuple[str, str, Parameter, str]]:
    """Yield option with item, full name, catalogue entry and text of each item `NAME=text`."""
    parameters = parameters_of(law, effects)
    names: set[str] = set()
    for item in items:
        name, equals, text = item.partition("=")
        place = f"{option} {item}"
        if not equals:
            raise InputError(file=place, problem="has no value", remedy=f"write NAME={form}")
        try:
            full = find_parameter(name.strip(), parameters)
        except InputError as error:
            raise error.within(file=place) from None
        if full in names:
            raise InputError(file=place, problem=f"{full} is given twice", remedy="give it once")
        names.add(full)
        yield place, full, parameters[full], text


def _number(text: str, place: str, form: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(
            file=place, problem=f"{quoted(text)} is not a number", remedy=f"write {form}"
        ) from None
