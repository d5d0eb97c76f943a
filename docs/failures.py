"""Write docs/why/failures.md and its pictures: `.venv/bin/python docs/failures.py [--check]`.

Each failure is simulated. Runs of the thesis's bearing contain a hidden effect or disturbance, the
law alone is fitted to them, and the residual is drawn. Causes and advice are those of the reports.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import jbf
import jbf.plot
import numpy as np
import numpy.typing as npt
from jbf.comparison.comparison import Comparison
from jbf.reporting.advice import advice_on

DOCS = Path(__file__).resolve().parent
PAGE, IMAGES = DOCS / "why" / "failures.md", DOCS / "images" / "failures"
LAW = {"f_m": 0.26, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
NOISE_N, STEP_S, RADIUS_M = 0.3, 0.02, 0.0127
Array = npt.NDArray[np.float64]
Spoil = Callable[[int, Array, Array], Array]


@dataclass(frozen=True)
class Shown:
    """A failure: the axis or kind along which it appears, its description, and its values."""

    kind: str
    title: str
    hidden: str
    effects: dict[str, float] | None = None
    spoil: Spoil | None = None


def _hum(_: int, time_s: Array, __: Array) -> Array:
    return 0.6 * np.sin(2.0 * np.pi * 7.3 * time_s)


def _knock(run: int, time_s: Array, _: Array) -> Array:
    return 5.0 * np.exp(-(((time_s - 7.0 - 3.0 * run) / 0.15) ** 2))


def _levels(run: int, _: Array, speed: Array) -> Array:
    return (0.8 - 0.8 * run) * np.sign(speed)


SHOWN = (
    Shown(
        "velocity",
        "Along the speed",
        "dry friction that falls more steeply than the law's",
        {"stribeck_excess.a": 0.1, "stribeck_excess.v_s": 0.006, "stribeck_excess.n": 1.5},
    ),
    Shown(
        "direction",
        "By direction",
        "a zero of the cell that is 0.6 N off",
        {"sensor_offset.b": 0.6},
    ),
    Shown(
        "acceleration",
        "Along the acceleration",
        "3 kg that the cell accelerates with the shaft",
        {"inertia.m_e": 3.0},
    ),
    Shown(
        "angle",
        "Over a turn",
        "friction that goes by 20 % over each turn",
        {"position_ripple.a": 0.2, "position_ripple.theta_0_rad": 1.0},
    ),
    Shown("time", "In time", "a zero that wanders by 0.05 N each second", {"sensor_drift.d": 0.05}),
    Shown("run", "From run to run", "another dry level in each run", None, _levels),
    Shown(
        "time since a rest",
        "After rests",
        "friction that grows while the contact rests",
        {
            "dwell_stiction.a": 0.15,
            "dwell_stiction.t_0_s": 1.0,
            "dwell_stiction.m": 0.7,
            "dwell_stiction.s_0": 3e-3,
        },
    ),
    Shown(
        "distance since a reversal",
        "After reversals",
        "a contact that bends before it slides",
        {"presliding.sigma": 800.0},
    ),
    Shown("frequency", "In the spectrum", "a hum of 0.6 N at 7.3 Hz", None, _hum),
    Shown("bursts", "In bursts", "a knock of 5 N in each run", None, _knock),
)


def motions() -> list[tuple[str, Array, Array]]:
    """Return names, times and speeds: sines, starts and stops."""
    time_s = np.arange(0.0, 30.0, STEP_S)
    levels = np.array([0.0, 0.03, 0.0, -0.06, 0.0, 0.09, 0.0, -0.03, 0.0, 0.06])
    held = levels[np.minimum((time_s / 3.0).astype(int), len(levels) - 1)]
    ramp = np.ones(15) / 15.0
    stops = np.round(np.convolve(np.pad(held, 7, "edge"), ramp, "valid"), 9)
    return [
        ("slow", time_s, 0.1 * np.sin(0.5 * time_s + 0.3)),
        ("fast", time_s, 0.1 * np.sin(2.0 * time_s + 0.3)),
        ("stops", time_s, stops),
    ]


def compared(shown: Shown) -> Comparison:
    """Fit the law alone to runs with a hidden effect, and compare it with them."""
    rig, random = jbf.Rig.thesis(), np.random.default_rng(11)
    own = shown.effects or {}
    names = list(dict.fromkeys(name.partition(".")[0] for name in own))
    truth = jbf.Model(rig, effects=names, parameters=LAW | own)
    runs = []
    for number, (name, time_s, speed) in enumerate(motions()):
        way = np.concatenate(([0.0], np.cumsum(0.5 * STEP_S * (speed[1:] + speed[:-1]))))
        clean = jbf.Run.from_arrays(time_s, speed, angle_rad=way / RADIUS_M)
        force = truth.predict(clean) + random.normal(0.0, NOISE_N, len(time_s))
        if shown.spoil is not None:
            force = force + shown.spoil(number, time_s, speed)
        seen = np.where(speed == 0.0, 0.0, speed + random.normal(0.0, 1e-4, len(speed)))
        runs.append(jbf.Run.from_arrays(time_s, seen, force, angle_rad=way / RADIUS_M, name=name))
    return jbf.compare(jbf.fit(rig, runs).model, runs)


def looks(shown: Shown, found: Comparison) -> str:
    """Describe the result of the comparison; the axis must be among those that it names."""
    if shown.kind == "frequency":
        return "A line stands out of the noise, and the means along every axis are near zero."
    if shown.kind == "bursts":
        return "Some instants stick out; everywhere else the residual is noise."
    failure = next(f for f in found.failures if f.axis == shown.kind)
    share = f"{100 * failure.share:.0f} % of the mean square"
    return f"{failure.where[0].upper()}{failure.where[1:]}: {share}."


def draw(shown: Shown, found: Comparison, name: str) -> None:
    """Draw the picture of a failure."""
    if shown.kind == "frequency":
        ax = jbf.plot.spectrum(found)
    elif shown.kind == "bursts":
        ax = jbf.plot.residual_in_time(found)
    else:
        ax = jbf.plot.residual_along(found, axis=shown.kind)
    jbf.plot.save(ax, IMAGES / name)


def sentence(words: str) -> str:
    """Return the text with a capital letter and a full stop."""
    return f"{words[0].upper()}{words[1:]}."


def page(drawn: bool) -> str:
    """Return the page, and draw the pictures if `drawn`."""
    parts = [HEAD]
    for shown in SHOWN:
        found = compared(shown)
        name = f"{shown.kind.replace(' ', '_')}.png"
        if drawn:
            draw(shown, found, name)
        advice = advice_on(shown.kind)
        parts.append(
            f"## {shown.title}\n"
            f"![Residual of the law alone: {shown.hidden}](../images/failures/{name})\n\n"
            f"**Looks like.** {looks(shown, found)} RMS {found.rms / found.noise_rms:.2g} times "
            f"the noise.\n\n**Here it is** {shown.hidden}.\n\n"
            f"**Usually it comes from** {advice.causes}.\n\n"
            f"**What to do.** {sentence(advice.to_do)}\n"
        )
    return "\n".join([*parts, TAIL])


HEAD = """# A gallery of failures

What a residual looks like, what it usually comes from, and what to do about it. Each picture is
record minus model of the law alone, fitted to three runs in which one thing was hidden; a report
draws the same of yours, and names the effect where the catalogue has it. Means that stay within the
band of the noise are no failure.
"""
TAIL = """\
*(Written by `docs/failures.py` from the words of the reports; noise of 0.3 N, fixed seed. Machine
and commit in [figures](../reference/figures.md).)*
"""


def main() -> int:
    """Write the page and pictures, or check the text."""
    if "--check" in sys.argv[1:]:
        return PAGE.read_text(encoding="utf-8") != page(drawn=False)
    IMAGES.mkdir(exist_ok=True)
    PAGE.write_text(page(drawn=True), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
