"""`jbf control run [MODEL]`: control loops on the bench, with several schemes compared."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.control.options import add_bench, add_task, bench_of, model_of, task_of
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.control import Bench, Motion
    from jbf.models.model import Model

_DEFAULT = "none,learning,coulomb,observed"


def add(actions: Commands) -> None:
    """Add the action to the parser."""
    does = "run loops on the bench and compare schemes"
    parser = command(actions, "run", does, run)
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
    add_plot(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the action."""
    from jbf.control.run import run as run_loop
    from jbf.control.settings import Settings
    from jbf.reporting.control_run_text import runs_text

    wanted = {"--plot": arguments.plot, "--out": arguments.out}
    outputs.check(wanted, outputs.read_by(arguments))
    check_picture(arguments.plot)
    asked = arguments.scheme
    if asked is None:
        asked = _DEFAULT
        if arguments.model and model_of(arguments.carried or arguments.model).law != "journal":
            asked = asked.replace("learning,", "")
    names = [name.strip() for name in asked.split(",") if name.strip()]
    if not names:
        raise InputError(problem="--scheme names none", mend="name one: --scheme observed")
    if arguments.out and len(names) != 1:
        raise InputError(
            problem=f"--out takes one scheme, not {len(names)}", mend="name one: --scheme observed"
        )
    truth = None if arguments.model is None else model_of(arguments.model)
    carried = truth if arguments.carried is None else model_of(arguments.carried)
    settings = None if arguments.settings is None else Settings.load(arguments.settings)
    bench = bench_of(arguments)
    task, reference, load_n = _requested_motion(arguments, truth, bench)
    with shown("the loop"):
        results = [
            run_loop(
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
        from jbf.reporting.control_run_plot import plot_runs

        save_picture(plot_runs(results), arguments.plot)
    if arguments.out:
        outputs.write({arguments.out: results[0].to_csv()})
    outputs.say(runs_text(results), wanted)
    return 0


def _requested_motion(arguments: argparse.Namespace, truth: Model | None, bench: Bench) -> Motion:
    """Return the task, and the reference and load if a recorded motion is followed."""
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
