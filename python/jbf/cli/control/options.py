"""Options shared by several actions of `jbf control`: bench, task, friction."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from jbf.errors import InputError, did_you_mean

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.control import Bench, Task
    from jbf.models.model import Model


def add_bench(parser: Parser) -> None:
    """Add the options of the bench: motor, shaft, encoder and noise."""
    group = parser.add_argument_group("bench", "changes of the thesis's bench")
    numbers = {
        "volts-per-n": "motor voltage per newton of friction of one bearing, V/N",
        "damping-1-s": "damping a of the plant, 1/s",
        "input-rad-s2-v": "input gain b of the plant, rad/(s^2 V)",
        "counts-per-rad": "encoder counts per radian",
        "limit-v": "largest output voltage, V",
        "noise-times": "noise as a multiple of the standard noise",
    }
    for name, description in numbers.items():
        group.add_argument(f"--{name}", metavar="X", type=float, help=description)
    group.add_argument("--seed", metavar="N", type=int, help="random seed of the noise")


@dataclass(frozen=True)
class BenchOptions:
    """Values that replace those of the bench of Cohn (1998); None keeps the value."""

    volts_per_n: float | None
    damping_1_s: float | None
    input_rad_s2_v: float | None
    counts_per_rad: float | None
    limit_v: float | None
    noise_times: float | None
    seed: int | None

    def bench(self) -> Bench:
        """Bench of Cohn (1998), in which the given options replace its values."""
        from jbf.control.bench import THESIS_BENCH, with_noise

        given = _given(self)
        times = given.pop("noise_times", None)
        bench = replace(THESIS_BENCH, **given)
        if times is None:
            return bench
        if not 0.0 <= times < 1e6:
            raise InputError(
                problem=f"--noise-times {times:g} is not a factor",
                remedy="choose zero or a positive number",
            )
        return with_noise(bench, times)


def add_task(parser: Parser) -> None:
    """Add the options of the task, which defines the reference of the loop."""
    group = parser.add_argument_group(
        "task", "a row of the thesis's tables (--task), modified by the other options"
    )
    group.add_argument(
        "--task", metavar="NAME", default="velocity sine", help="name (default: velocity sine)"
    )
    group.add_argument(
        "--motion", metavar="RUN", help="follow the speed or angle of a recorded run (CSV)"
    )
    group.add_argument("--control", choices=("position", "velocity"), help="controlled quantity")
    group.add_argument("--wave", choices=("sine", "triangle", "square"), help="reference signal")
    for name, description in (
        ("low", "smallest reference, rad or rad/s"),
        ("high", "largest reference, rad or rad/s"),
        ("frequency-rad-s", "angular frequency of the reference, rad/s"),
        ("seconds", "duration of the run, s"),
        ("skip-s", "time at the start that is excluded from the errors, s"),
    ):
        group.add_argument(f"--{name}", metavar="X", type=float, help=description)


@dataclass(frozen=True)
class TaskOptions:
    """Task of a control loop: a recorded motion, or a task of Cohn (1998).

    The options that are not None replace the values of the task of Cohn (1998).
    """

    task: str
    motion: str | None
    control: Literal["position", "velocity"] | None
    wave: str | None
    low: float | None
    high: float | None
    frequency_rad_s: float | None
    seconds: float | None
    skip_s: float | None

    def reference(self) -> Task:
        """Selected task of Cohn (1998), in which the given options replace its values."""
        from jbf.control.task import TASKS

        if self.task not in TASKS:
            remedy = f"{did_you_mean(self.task, TASKS)} (in quotes)"
            raise InputError(problem=f'there is no task "{self.task}"', remedy=remedy)
        given = _given(self)
        return replace(TASKS[given.pop("task")], **given)


def _given(options: BenchOptions | TaskOptions) -> dict[str, Any]:
    """Values of the options that are not None, by name."""
    return {name: value for name, value in asdict(options).items() if value is not None}


def model_of(path: str | None) -> Model:
    """Load a friction model from a file; without a path, that of the bench of Cohn (1998)."""
    from jbf.cli import inputs
    from jbf.control import thesis_model

    return thesis_model() if path is None else inputs.model(path)
