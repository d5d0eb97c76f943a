"""`jbf control run [MODEL]`: simulation of control loops with several compensation schemes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_earlier_name, command
from jbf.cli.control.options import BenchOptions, TaskOptions, add_bench, add_task, model_of
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.control import Bench, Motion
    from jbf.models.model import Model

_DEFAULT = "none,learning,coulomb,observed"


@dataclass(frozen=True)
class RunOptions:
    """Arguments of `jbf control run`."""

    model: str | None
    scheme: str | None
    carried: str | None
    settings: str | None
    precision: str
    csv: str | None
    task: TaskOptions
    bench: BenchOptions
    plot: str | None


def add(actions: Commands) -> None:
    """Add `jbf control run` to the parser."""
    description = "simulate control loops on the bench, and compare compensation schemes"
    parser = command(actions, "run", description, RunOptions, run)
    parser.add_argument(
        "model", metavar="MODEL", nargs="?", help="friction model of the bench (default: thesis)"
    )
    parser.add_argument(
        "--scheme",
        metavar="A,B",
        help="compensation schemes: none, learning, coulomb, table, repetitive, observed (default: "
        "all but table and repetitive; learning only for the journal law)",
    )
    parser.add_argument(
        "--carried",
        metavar="MODEL",
        help="model used by the compensator (default: the model of the bench)",
    )
    parser.add_argument("--settings", metavar="TOML", help="settings written by jbf control tune")
    parser.add_argument(
        "--precision", choices=("f64", "f32"), default="f64", help="arithmetic of the loop"
    )
    parser.add_argument("--csv", metavar="CSV", help="write the run (of a single scheme)")
    add_earlier_name(parser, "--out", "--csv")
    add_task(parser)
    add_bench(parser)
    add_plot(parser)


def run(options: RunOptions) -> int:
    """Run `jbf control run` and return its exit code."""
    from jbf.control.run import run as run_loop
    from jbf.control.settings import Settings
    from jbf.reporting.control_run_text import runs_text

    targets = {"--plot": options.plot, "--csv": options.csv}
    read = outputs.inputs_in(options.model, options.carried, options.settings, options.task.motion)
    outputs.check(targets, read)
    check_picture(options.plot)
    scheme_names = options.scheme
    if scheme_names is None:
        scheme_names = _DEFAULT
        if options.model and model_of(options.carried or options.model).law != "journal":
            scheme_names = scheme_names.replace("learning,", "")
    names = [name.strip() for name in scheme_names.split(",") if name.strip()]
    if not names:
        raise InputError(problem="--scheme is empty", remedy="name a scheme: --scheme observed")
    if options.csv and len(names) != 1:
        raise InputError(
            problem=f"--csv requires one scheme, not {len(names)}",
            remedy="name one: --scheme observed",
        )
    truth = None if options.model is None else model_of(options.model)
    carried = truth if options.carried is None else model_of(options.carried)
    settings = None if options.settings is None else Settings.load(options.settings)
    bench = options.bench.bench()
    task, reference, load_n = _requested_motion(options.task, truth, bench)
    with shown("simulating the loop"):
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
                precision=options.precision,
            )
            for name in names
        ]
    if options.plot:
        from jbf.reporting.control_run_plot import plot_runs

        save_picture(plot_runs(results), options.plot)
    if options.csv:
        outputs.write({options.csv: results[0].to_csv()})
    outputs.say(runs_text(results), targets)
    return 0


def _requested_motion(options: TaskOptions, truth: Model | None, bench: Bench) -> Motion:
    """Task of the loop; for a recorded motion also its reference and load."""
    from jbf.control import Motion, follow, thesis_model
    from jbf.records.csv_file import read_run

    if options.motion is None:
        return Motion(options.reference(), None, None)
    wave = ("wave", "low", "high", "frequency_rad_s", "seconds")
    given = [n for n in wave if getattr(options, n) is not None]
    if given:
        option = f"--{given[0].replace('_', '-')}"
        raise InputError(
            problem=f"{option} cannot be combined with --motion", remedy="leave out one"
        )
    recorded = read_run(options.motion, need_friction=False)
    rig = (thesis_model() if truth is None else truth).rig
    motion = follow(recorded, rig, options.control or "velocity", bench)
    skip_s = options.skip_s or 0.0
    return motion._replace(task=replace(motion.task, skip_s=skip_s))
