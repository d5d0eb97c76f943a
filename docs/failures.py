"""Write docs/why/failures.md and its pictures: `.venv/bin/python docs/failures.py [--check]`.

Each failure is simulated. Runs of the bearing in Cohn (1998) contain a hidden effect or
disturbance, the law without effects is fitted to them, and the residual is drawn. Causes and advice
are those of the reports.
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
    """Failure of a fit: the axis or kind along which it appears, its description, its values."""

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
        "Residual along speed",
        "dry friction that decreases more steeply with speed than the law",
        {"stribeck_excess.a": 0.1, "stribeck_excess.v_s": 0.006, "stribeck_excess.n": 1.5},
    ),
    Shown(
        "direction",
        "Residual by direction",
        "a force sensor with an offset of 0.6 N",
        {"sensor_offset.b": 0.6},
    ),
    Shown(
        "acceleration",
        "Residual along acceleration",
        "a mass of 3 kg between sensor and shaft",
        {"inertia.m_e": 3.0},
    ),
    Shown(
        "angle",
        "Residual along angle",
        "friction that varies by 20 % over each turn",
        {"position_ripple.a": 0.2, "position_ripple.theta_0_rad": 1.0},
    ),
    Shown("time", "Residual in time", "a sensor drift of 0.05 N/s", {"sensor_drift.d": 0.05}),
    Shown("run", "Residual by run", "a different dry level in each run", None, _levels),
    Shown(
        "time since a rest",
        "Residual after rests",
        "static friction that grows while the contact rests",
        {
            "dwell_stiction.a": 0.15,
            "dwell_stiction.t_0_s": 1.0,
            "dwell_stiction.m": 0.7,
            "dwell_stiction.s_0": 3e-3,
        },
    ),
    Shown(
        "distance since a reversal",
        "Residual after reversals",
        "a contact that deforms elastically before it slides (presliding)",
        {"presliding.sigma": 800.0},
    ),
    Shown("frequency", "Spectrum of the residual", "a vibration of 0.6 N at 7.3 Hz", None, _hum),
    Shown("bursts", "Bursts in the residual", "an impact of 5 N in each run", None, _knock),
)


def motions() -> list[tuple[str, Array, Array]]:
    """Return name, times (s) and speeds (m/s) of each motion: sines, starts and stops."""
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
    """Fit the law alone to simulated runs with the failure, and compare the two."""
    rig, random = jbf.Rig.thesis(), np.random.default_rng(11)
    effect_values = shown.effects or {}
    names = list(dict.fromkeys(name.partition(".")[0] for name in effect_values))
    truth = jbf.Model(rig, effects=names, parameters=LAW | effect_values)
    runs = []
    for number, (name, time_s, speed) in enumerate(motions()):
        path_m = np.concatenate(([0.0], np.cumsum(0.5 * STEP_S * (speed[1:] + speed[:-1]))))
        clean = jbf.Run.from_arrays(time_s, speed, angle_rad=path_m / RADIUS_M)
        force = truth.predict(clean) + random.normal(0.0, NOISE_N, len(time_s))
        if shown.spoil is not None:
            force = force + shown.spoil(number, time_s, speed)
        seen = np.where(speed == 0.0, 0.0, speed + random.normal(0.0, 1e-4, len(speed)))
        # The force at the last sample of a rest is that of the start, so it is recorded as moving.
        last = np.flatnonzero((speed[:-1] == 0.0) & (speed[1:] != 0.0))
        seen[last] = 0.5 * speed[last + 1]
        runs.append(
            jbf.Run.from_arrays(time_s, seen, force, angle_rad=path_m / RADIUS_M, name=name)
        )
    return jbf.compare(jbf.fit(rig, runs).model, runs)


def looks(shown: Shown, comparison: Comparison) -> str:
    """Describe how the failure appears in the comparison, which must report it."""
    if shown.kind == "frequency":
        return (
            "The spectrum has one line above the noise; the means along every axis are near zero."
        )
    if shown.kind == "bursts":
        return "The residual is large at some instants, and noise elsewhere."
    failure = next(f for f in comparison.failures if f.axis == shown.kind)
    share = f"{100 * failure.share:.0f} % of the mean square"
    return f"{failure.where[0].upper()}{failure.where[1:]}: {share}."


def draw(shown: Shown, comparison: Comparison, name: str) -> None:
    """Draw the picture of a failure."""
    if shown.kind == "frequency":
        ax = jbf.plot.spectrum(comparison)
    elif shown.kind == "bursts":
        ax = jbf.plot.residual_in_time(comparison)
    else:
        ax = jbf.plot.residual_along(comparison, axis=shown.kind)
    jbf.plot.save(ax, IMAGES / name)


def sentence(words: str) -> str:
    """Return a text with a capital letter and a full stop."""
    return f"{words[0].upper()}{words[1:]}."


def page(drawn: bool) -> str:
    """Return the text of docs/why/failures.md; also draw its pictures if `drawn`."""
    parts = [HEAD]
    for shown in SHOWN:
        comparison = compared(shown)
        name = f"{shown.kind.replace(' ', '_')}.png"
        if drawn:
            draw(shown, comparison, name)
        advice = advice_on(shown.kind)
        parts.append(
            f"## {shown.title}\n"
            f"![Residual of the law alone: {shown.hidden}](../images/failures/{name})\n\n"
            f"**Simulated cause:** {shown.hidden}.\n\n"
            f"**Comparison:** {looks(shown, comparison)} The RMS is "
            f"{comparison.rms / comparison.noise_rms:.2g} times the noise.\n\n"
            f"**Usual causes:** {advice.causes}.\n\n"
            f"**Next step:** {sentence(advice.to_do)}\n"
        )
    return "\n".join([*parts, TAIL])


HEAD = """# A gallery of failures

This page shows typical patterns of residuals, their usual causes, and the next step. Each picture
shows record minus model. The law alone was fitted to three simulated runs with one hidden cause. A
report of your runs contains the same pictures, and names the effect if the catalogue contains it.
Means within the noise band are not significant.
"""
TAIL = """\
*(Generated by `docs/failures.py` with the causes and next steps of the reports. Noise: 0.3 N.)*
"""


def main() -> int:
    """Write the page and its pictures; with `--check`, return 1 if the page is out of date."""
    if "--check" in sys.argv[1:]:
        return PAGE.read_text(encoding="utf-8") != page(drawn=False)
    IMAGES.mkdir(exist_ok=True)
    PAGE.write_text(page(drawn=True), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
