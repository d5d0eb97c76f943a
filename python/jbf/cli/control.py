"""`jbf control run|tables|tune|robustness`: loops on the simulated bench."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command
from jbf.cli.control_options import add_bench, add_task, bench_of, task_of
from jbf.cli.progress import shown
from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.control import Bench, Motion
    from jbf.control.thesis_tables import Tables
    from jbf.models.model import Model

_DEFAULT = "none,learning,coulomb,observed"


def add(commands: Commands) -> None:
    """Put the commands on the command line."""
    does = "friction compensation in the loop: runs, the thesis's tables, settings, robustness"
    parser = command(commands, "control", does, _tables)
    actions = parser.add_subparsers(dest="action", metavar="ACTION", parser_class=type(parser))
    _add_run(actions)
    tables = command(actions, "tables", "Tables 6.1 and 6.2: fitted, predicted, printed", _tables)
    for each in (parser, tables):
        add_json(each)
        _add_plot(each)
    tune = command(actions, "tune", "settings of the compensator from a fitted model", _tune)
    tune.add_argument("model", metavar="MODEL", help="model file (TOML)")
    tune.add_argument("--out", metavar="TOML", help="write them to a file")
    add_bench(tune)
    does = "does it still help when its model is wrong: every effect hidden, wrong load, more noise"
    robustness = command(actions, "robustness", does, _robustness)
    robustness.add_argument("model", metavar="MODEL", nargs="?", help="model file; the thesis's")
    add_bench(robustness)
    add_json(robustness)
    _add_plot(robustness)


def _add_run(actions: Commands) -> None:
    does = "run loops on the bench and compare schemes"
    parser = command(actions, "run", does, _run)
    parser.add_argument(
        "model", metavar="MODEL", nargs="?", help="friction of the bench; the thesis's by default"
    )
    parser.add_argument(
        "--scheme",
        metavar="A,B",
        help="of none, learning, coulomb, table, repetitive, observed; all but table and "
        "repetitive by default, and learning only for the journal law",
    )
    parser.add_argument(
        "--carried", metavar="MODEL", help="what the compensator believes; the true model"
    )
    parser.add_argument("--settings", metavar="TOML", help="what `jbf control tune` wrote")
    parser.add_argument("--precision", choices=("f64", "f32"), default="f64", help="of the loop")
    parser.add_argument("--out", metavar="CSV", help="write the run (of one scheme)")
    add_task(parser)
    add_bench(parser)
    _add_plot(parser)


def _add_plot(parser: Parser) -> None:
    parser.add_argument("--plot", metavar="PNG", help="write a picture (png, svg or pdf)")


def _model(path: str | None) -> Model:
    from jbf.cli import inputs
    from jbf.control import thesis_model

    return thesis_model() if path is None else inputs.model(path)


def _check_picture(path: str | None) -> None:
    """Before the work: can such a picture be written?"""
    if path is None:
        return
    from matplotlib.backend_bases import FigureCanvasBase

    kind = path.rpartition(".")[2].lower()
    if kind not in FigureCanvasBase.get_supported_filetypes():
        raise InputError(
            file=f"--plot {path}", problem="is no picture", mend="name a png, svg or pdf file"
        )


def _save(figure: Any, path: str | None) -> None:
    if path is None:
        return
    try:
        figure.savefig(path, dpi=110)
    except (ValueError, OSError) as error:
        raise InputError(
            file=f"--plot {path}", problem=str(error), mend="name a png, svg or pdf file"
        ) from None


def _run(arguments: argparse.Namespace) -> int:
    from jbf.control.run import run
    from jbf.control.settings import Settings
    from jbf.control.text import runs_text

    wanted = {"--plot": arguments.plot, "--out": arguments.out}
    inputs = (arguments.model, arguments.carried, arguments.settings, arguments.motion)
    outputs.check(wanted, [p for p in inputs if p])
    _check_picture(arguments.plot)
    asked = arguments.scheme
    if asked is None:
        asked = _DEFAULT
        if arguments.model and _model(arguments.carried or arguments.model).law != "journal":
            asked = asked.replace("learning,", "")
    names = [name.strip() for name in asked.split(",") if name.strip()]
    if not names:
        raise InputError(problem="--scheme names none", mend="name one: --scheme observed")
    if arguments.out and len(names) != 1:
        raise InputError(
            problem=f"--out takes one scheme, not {len(names)}", mend="name one: --scheme observed"
        )
    truth = None if arguments.model is None else _model(arguments.model)
    carried = truth if arguments.carried is None else _model(arguments.carried)
    settings = None if arguments.settings is None else Settings.load(arguments.settings)
    bench = bench_of(arguments)
    task, reference, load_n = _asked(arguments, truth, bench)
    results = [
        run(
            truth,
            name,
            task,
            bench=bench,
            reference=reference,
            load_n=load_n,
            carried=carried,
            settings=settings,
            precision=arguments.precision,
        )
        for name in names
    ]
    if arguments.plot:
        from jbf.control.plots import plot_runs

        _save(plot_runs(results), arguments.plot)
    if arguments.out:
        outputs.write({arguments.out: _csv(results[0])})
    outputs.say(runs_text(results), wanted)
    return 0


def _asked(arguments: argparse.Namespace, truth: Model | None, bench: Bench) -> Motion:
    """The task, and what else a recorded motion brings."""
    from jbf.control import Motion, follow, thesis_model
    from jbf.records.csv_file import read_run

    if arguments.motion is None:
        return Motion(task_of(arguments), None, None)
    wave = ("wave", "low", "high", "frequency_rad_s", "seconds")
    given = [n for n in wave if getattr(arguments, n) is not None]
    if given:
        option = f"--{given[0].replace('_', '-')}"
        raise InputError(problem=f"{option} means nothing beside --motion", mend="drop one")
    recorded = read_run(arguments.motion, need_friction=False)
    rig = (thesis_model() if truth is None else truth).rig
    motion = follow(recorded, rig, arguments.control or "velocity", bench)
    skip_s = arguments.skip_s or 0.0
    return motion._replace(task=replace(motion.task, skip_s=skip_s))


def _csv(result: Any) -> str:
    names = ["time_s", "reference", "angle_rad", "velocity_rad_s", "friction_v"]
    names += ["measured_angle_rad", "estimated_velocity_rad_s", "error", "base_v"]
    names += ["compensation_v", "estimated_friction_v", "correction_v", "forward_v", "output_v"]
    names += ["learned_0", "learned_1", "status"]
    rows = zip(*(getattr(result, name).tolist() for name in names), strict=True)
    return "\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows)]) + "\n"


def _tables(arguments: argparse.Namespace) -> int:
    from jbf.control.assumptions import assumptions
    from jbf.control.text import (
        assumptions_text,
        better_text,
        friction_lines,
        score_text,
        tables_text,
    )
    from jbf.control.thesis_tables import fit_friction, tables

    wanted = {"--json": arguments.json, "--plot": arguments.plot}
    outputs.check(wanted)
    _check_picture(arguments.plot)
    with shown("the bench's friction") as report:
        model, bench = fit_friction(report=report)
        both = tables(model, bench, report=report)
        others = list(assumptions(both, report=report))
    text = [
        "Friction of the bench, fitted to the seven cells without compensation:",
        "",
        *friction_lines(model, bench.volts_per_n, 104.0),
        "",
        tables_text(both),
        "",
        score_text(both),
        "",
        assumptions_text(others),
        "",
        better_text(both),
        "",
        "docs/control.md says how scale, clock, start and missing effect were settled, and why the",
        "cells that are off are off.",
    ]
    if arguments.json:
        outputs.write({arguments.json: outputs.json_text(_json(both, others))})
    if arguments.plot:
        from jbf.control.plots import plot_tables

        _save(plot_tables(both), arguments.plot)
    outputs.say("\n".join(text), wanted)
    return 0


def _json(tables: Tables, others: Sequence[tuple[str, Tables]]) -> dict[str, Any]:
    values = {n: p.value for n, p in tables.model.parameters.items()}  # type: ignore[union-attr]
    return {
        "friction": {"volts_per_n": tables.bench.volts_per_n, **values},
        "cells": [{**asdict(cell), "ratio": cell.ratio} for cell in tables.cells.values()],
        "within_2": tables.within(2.0),
        "within_1.5": tables.within(1.5),
        "times_better": tables.gains(),
        "assumptions": [
            {
                "name": name,
                "ratios": {f"{c.row}, {c.column}": c.ratio for c in other.predicted},
                "within_2": other.within(2.0),
                "within_1.5": other.within(1.5),
            }
            for name, other in others
        ],
    }


def _tune(arguments: argparse.Namespace) -> int:
    from jbf.control import tune

    wanted = {"--out": arguments.out}
    outputs.check(wanted, [arguments.model])
    text = tune(_model(arguments.model), bench_of(arguments)).to_toml()
    if arguments.out:
        outputs.write({arguments.out: text})
        outputs.say(f"settings written to {arguments.out}", wanted)
    else:
        outputs.say(text.rstrip(), wanted)
    return 0


def _robustness(arguments: argparse.Namespace) -> int:
    from jbf.control.bench import thesis_model
    from jbf.control.robustness import robustness
    from jbf.control.text import robustness_text

    wanted = {"--json": arguments.json, "--plot": arguments.plot}
    outputs.check(wanted, [arguments.model] if arguments.model else [])
    _check_picture(arguments.plot)
    base = thesis_model(elastic="nothing") if arguments.model is None else _model(arguments.model)
    with shown("robustness") as report:
        found = robustness(base, bench_of(arguments), report=report)
    if arguments.json:
        answer = [{**asdict(o), "worst": o.worst, "verdict": o.verdict} for o in found]
        outputs.write({arguments.json: outputs.json_text({"cases": answer})})
    if arguments.plot:
        from jbf.control.plots import plot_robustness

        _save(plot_robustness(found), arguments.plot)
    outputs.say(robustness_text(found), wanted)
    return 0
