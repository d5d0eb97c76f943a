"""Options shared by several actions of `jbf control`: bench, task, friction."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from jbf.errors import InputError, did_you_mean

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.control import Bench, Task
    from jbf.models.model import Model


def add_bench(parser: Parser) -> None:
    """Add the options of motor, shaft, encoder and noise."""
    group = parser.add_argument_group("bench")
    numbers = {
        "volts-per-n": "volts for one newton of friction on one bearing",
        "damping-1-s": "the plant's a",
        "input-rad-s2-v": "the plant's b",
        "counts-per-rad": "counts of the encoder",
        "limit-v": "largest output",
        "noise-times": "noise, so many times the standard one",
    }
    for name, does in numbers.items():
        group.add_argument(f"--{name}", metavar="X", type=float, help=does)
    group.add_argument("--seed", metavar="N", type=int, help="of the noise")


def bench_of(arguments: argparse.Namespace) -> Bench:
    """Return the bench defined by the options; by default the thesis's bench."""
    from jbf.control.bench import THESIS_BENCH, with_noise

    names = ("volts_per_n", "damping_1_s", "input_rad_s2_v", "counts_per_rad", "limit_v", "seed")
    given = {n: getattr(arguments, n) for n in names if getattr(arguments, n) is not None}
    bench = replace(THESIS_BENCH, **given)
    times = arguments.noise_times
    if times is None:
        return bench
    if not 0.0 <= times < 1e6:
        raise InputError(problem=f"--noise-times {times:g} is no factor", mend="give zero or more")
    return with_noise(bench, times)


def add_task(parser: Parser) -> None:
    """Add the options of the reference that the loop follows."""
    group = parser.add_argument_group(
        "task", "a row of the thesis's tables (--task), changed by whatever else is given"
    )
    group.add_argument("--task", metavar="NAME", default="velocity sine", help="velocity sine")
    group.add_argument(
        "--motion", metavar="RUN", help="follow the speed (or angle) of a recorded run, CSV"
    )
    group.add_argument("--control", choices=("position", "velocity"), help="what is controlled")
    group.add_argument("--wave", choices=("sine", "triangle", "square"), help="its reference")
    for name, does in (
        ("low", "rad or rad/s"),
        ("high", "rad or rad/s"),
        ("frequency-rad-s", "of the reference"),
        ("seconds", "length of the run"),
        ("skip-s", "seconds at the start that do not count"),
    ):
        group.add_argument(f"--{name}", metavar="X", type=float, help=does)


def task_of(arguments: argparse.Namespace) -> Task:
    """Return the task defined by the options."""
    from jbf.control.task import TASKS

    if arguments.task not in TASKS:
        mend = f"{did_you_mean(arguments.task, TASKS)} (in quotes)"
        raise InputError(problem=f'there is no task "{arguments.task}"', mend=mend)
    names = ("control", "wave", "low", "high", "frequency_rad_s", "seconds", "skip_s")
    given = {n: getattr(arguments, n) for n in names if getattr(arguments, n) is not None}
    return replace(TASKS[arguments.task], **given)


def model_of(path: str | None) -> Model:
    """Load the friction model of a file; without a path, that of the thesis's bench."""
    from jbf.cli import inputs
    from jbf.control import thesis_model

    return thesis_model() if path is None else inputs.model(path)
