"""`jbf fit RIG RUN... --out MODEL`: fit the base law with the named effects."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

from jbf.cli import hold_out, inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_law, add_runs, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import Report, shown
from jbf.errors import InputError, Stopped, Unfinished, quoted
from jbf.models.catalogue import check_applies, find_parameter, in_chain_order, parameters_of

if TYPE_CHECKING:
    from jbf.estimation.fit import Fit
    from jbf.records.run import Run


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "fit", COMMANDS["fit"], run)
    parser.add_argument(
        "rig", metavar="RIG", help="rig file (TOML), a folder of jbf import, or its map"
    )
    add_runs(parser, needed=False)
    parser.add_argument(
        "--effects",
        metavar="A,B",
        default="",
        help="effects to fit beside the law (jbf effects lists them)",
    )
    add_law(parser)
    parser.add_argument(
        "--fix",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="hold a parameter at a value, SI units; may be repeated",
    )
    parser.add_argument(
        "--start",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="start the search of a parameter at a value, SI units; may be repeated",
    )
    parser.add_argument(
        "--bootstrap",
        metavar="N",
        type=int,
        help="take the errors from N fits of simulated records of the same runs (19 or more; "
        "takes N times as long)",
    )
    hold_out.add(parser)
    parser.add_argument("--out", metavar="MODEL", required=True, help="model file to write")
    add_effects_from(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    wanted = {"--out": arguments.out}
    if not arguments.runs and not os.path.isdir(arguments.rig):
        raise InputError(
            file="jbf fit", problem="RUN is missing", mend="name the runs after the rig"
        )
    outputs.check(wanted, outputs.read_by(arguments))
    effects = in_chain_order(name.strip() for name in arguments.effects.split(",") if name.strip())
    check_applies(arguments.law, effects)
    fixed = _values("--fix", arguments.fix, arguments.law, effects)
    start = _values("--start", arguments.start, arguments.law, effects)
    rig, runs = inputs.campaign(arguments.rig, arguments.runs, arguments.law)
    outputs.check(wanted, [run.path for run in runs if run.path])
    runs, held = hold_out.split(runs, arguments)

    from jbf.estimation.fit import fit

    repeats = arguments.bootstrap
    if repeats is not None:
        from jbf.estimation.bootstrap import check_repeats

        check_repeats(repeats, "--bootstrap")
    try:
        with shown("fitting") as report:
            fitted = fit(
                rig,
                runs,
                effects,
                law=arguments.law,
                clock=arguments.clock,
                start=start,
                fixed=fixed,
            )
            if repeats is not None:
                fitted = _repeated(fitted, runs, repeats, report)
    except Stopped as stop:
        raise outputs.keep(stop, arguments.out) from None
    except Unfinished as end:
        raise outputs.keep_unfinished(end, arguments.out) from None
    told = hold_out.error_for_json(fitted.model, held)
    outputs.write({arguments.out: fitted.model.to_toml()})
    outputs.say(fitted.report() + hold_out.words(fitted.model, told), wanted)
    return 0


def _repeated(fitted: Fit, runs: list[Run], repeats: int, report: Report | None) -> Fit:
    """Return the fit with bootstrap standard errors.

    Raise `Stopped` with the fit if interrupted.
    """
    from jbf.estimation.bootstrap import bootstrap

    try:
        return bootstrap(fitted, runs, repeats=repeats, progress=report).fit
    except KeyboardInterrupt:
        raise Stopped(fitted) from None


def _values(option: str, items: list[str], law: str, effects: tuple[str, ...]) -> dict[str, float]:
    """Parse the `NAME=VALUE` items of an option into full names and values."""
    known = parameters_of(law, effects)
    found: dict[str, float] = {}
    for item in items:
        name, equals, text = item.partition("=")
        place = f"{option} {item}"
        if not equals:
            raise InputError(file=place, problem="has no value", mend="write NAME=VALUE")
        try:
            full = find_parameter(name.strip(), known)
        except InputError as error:
            raise error.within(file=place) from None
        try:
            value = float(text)
        except ValueError:
            raise InputError(
                file=place, problem=f"{quoted(text)} is not a number", mend="write NAME=VALUE"
            ) from None
        if full in found:
            raise InputError(file=place, problem=f"{full} is given twice", mend="give it once")
        page = known[full]
        if not (page.lower <= value <= page.upper or value == page.null):
            raise InputError(
                file=place,
                problem="is out of range",
                mend=f"choose from {page.lower:g} to {page.upper:g}",
            )
        found[full] = value
    return found
