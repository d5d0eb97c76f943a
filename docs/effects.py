"""Write the page and the picture of every effect: `.venv/bin/python docs/effects.py [NAME...]`.

Texts come from the catalogue (`jbf.effects()`) and curves from the library, so that nothing is
duplicated. `--check` writes nothing, and exits with 1 if a page differs from the catalogue.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import jbf
import numpy as np
from jbf.models.catalogue import Effect, Parameter, built_in
from jbf.reporting.catalogue_text import REQUIREMENTS, meaning_of, refused_words
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FOLDER = Path(__file__).resolve().parent / "effects"
RIG = jbf.Rig.thesis()
LAW = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
IN_NEWTONS = {"F_c": 12.0, "F_s": 12.0, "F_v": 60.0}
RATE_HZ = 200.0
NOISE_N = 0.1
PLAIN, WITH = "0.3", "tab:red"


@dataclass(frozen=True)
class Shown:
    """Content of the picture of an effect: its parameters, and the motion."""

    values: Mapping[str, float] = field(default_factory=dict)
    motion: str = "a sine of 1 rad/s"
    load_share: float = 1.0
    beside: Mapping[str, float] = field(default_factory=dict)
    """Parameters of other effects that the effect requires, used in both curves."""
    warms_c: tuple[float, float] | None = None
    """Temperatures at the beginning and at the end, C; None for a constant temperature."""


SHOWN = {
    "drive_compliance": Shown({"k": 12.0, "c": 0.1, "J": 2e-3}, "a sine of 2 rad/s"),
    "backlash": Shown({"gap": 0.15}, "a sine of 2 rad/s"),
    "shear_thinning": Shown({"U_c": 0.08, "n": 1.2}),
    "thermal_thinning": Shown({"beta_q": 0.15, "tau": 60.0}, "eight periods of 1 rad/s"),
    "vogel_viscosity": Shown(
        {"B": 850.0, "C": -95.0, "T_0": 20.0}, "eight periods of 1 rad/s", warms_c=(20.0, 70.0)
    ),
    "load_dependence": Shown({"p": 0.8, "q": 1.0}, load_share=0.6),
    "film_memory": Shown({"factor": 0.35}),
    "running_in": Shown({"a": 0.6, "s_0": 1.0}, "eight periods of 1 rad/s"),
    "dwell_stiction": Shown(
        {"a": 0.15, "t_0": 3.0, "m": 0.7, "s_0": 3e-3}, "starts after rests of 1, 1, 3 and 9 s"
    ),
    "stribeck_excess": Shown({"a": 0.1, "v_s": 0.012, "n": 1.5}),
    "dry_load_dependence": Shown({"mu": 0.08}),
    "viscous_load_dependence": Shown({"c": 0.8}),
    "viscous_asymmetry": Shown({"b": 40.0}),
    "dry_temperature_dependence": Shown(
        {"a": -0.008, "T_0": 20.0}, "eight periods of 1 rad/s", warms_c=(20.0, 70.0)
    ),
    "viscous_temperature_dependence": Shown(
        {"B": 600.0, "C": -95.0, "T_0": 20.0}, "eight periods of 1 rad/s", warms_c=(20.0, 70.0)
    ),
    "viscous_thinning": Shown({"w": 16.0}),
    "dry_asymmetry": Shown({"a": 0.25}),
    "stribeck_asymmetry": Shown({"c": 4.0, "v_s": 0.02, "n": 1.0}),
    "stroke_dependence": Shown(
        {
            "a_1": 0.2,
            "a_2": -0.15,
            "a_3": 0.05,
            "a_4": 0.05,
            "a_5": 0.0,
            "a_6": 0.0,
            "x_0": 0.127,
            "h": 0.127,
        }
    ),
    "pitch_ripple": Shown({"a": 0.3, "pitch": 0.02, "phase": 0.5}, "a sine of 0.5 rad/s"),
    "pitch_ripple_2": Shown(
        {"a": 0.2, "pitch": 0.01, "phase": 0.0},
        "a sine of 0.5 rad/s",
        beside={"pitch_ripple.a": 0.3, "pitch_ripple.pitch": 0.02, "pitch_ripple.phase": 0.5},
    ),
    "warm_up": Shown({"a": 0.5, "tau": 10.0}, "eight periods of 1 rad/s"),
    "torque_proportional": Shown({"mu": 0.3}, beside={"gravity.G": 20.0, "gravity.theta_0": 0.5}),
    "direction_asymmetry": Shown({"a": 0.2}),
    "position_ripple": Shown({"a": 0.25, "theta_0": 0.5}, "a sine of 0.1 rad/s"),
    "presliding": Shown({"sigma": 300.0}),
    "coulomb_drag": Shown({"F_d": 4.0}),
    "quadratic_drag": Shown({"c": 500.0}),
    "inertia": Shown({"m_e": 30.0}),
    "zero_load_dependence": Shown({"k": 0.03}),
    "gravity": Shown({"G": 4.0, "theta_0": 0.5}, "a sine of 1 rad/s"),
    "spring": Shown({"k": 40.0}),
    "cogging": Shown({"A": 2.0, "pitch": 0.02, "phase": 0.5}, "a sine of 0.5 rad/s"),
    "cogging_2": Shown(
        {"A": 1.0, "pitch": 0.01, "phase": 0.0},
        "a sine of 0.5 rad/s",
        beside={"cogging.A": 2.0, "cogging.pitch": 0.02, "cogging.phase": 0.5},
    ),
    "sensor_hysteresis": Shown({"w": 2.0}),
    "sensor_nonlinearity": Shown({"c": 5e-4}, "a sine of 0.1 rad/s"),
    "sensor_lag": Shown({"tau": 0.15}),
    "time_delay": Shown({"tau": 0.12}),
    "sensor_offset": Shown({"b": 4.0}),
    "sensor_drift": Shown({"d": 0.2}, "eight periods of 1 rad/s"),
}
"""Parameters at which an effect is visible, by name; other effects have their starting values."""


def speed_of(motion: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s) and surface speeds (m/s) of a motion by its name."""
    if motion.startswith("starts"):
        knots = [(0.0, 0.0)]
        for rest in (1.0, 1.0, 3.0, 9.0):  # the first one may have been longer
            t = knots[-1][0] + rest
            knots += [(t, 0.0), (t + 0.5, 0.05), (t + 1.5, 0.05), (t + 2.0, 0.0)]
        time = np.arange(0.0, knots[-1][0] + 0.5, 1.0 / RATE_HZ)
        speed = np.interp(time, *np.array(knots).T)
        return time, speed
    omega = float(motion.split()[-2])
    periods = 8.0 if motion.startswith("eight") else 2.0
    time = np.arange(0.0, 2.0 * np.pi / omega * periods, 1.0 / RATE_HZ)
    return time, 0.127 * np.sin(omega * time)


def shown(effect: Effect) -> Shown:
    """Return the content of the picture of an effect."""
    if effect.name in SHOWN:
        return SHOWN[effect.name]
    return Shown({p.name: p.starts[0] for p in effect.parameters})


def motion_of(effect: Effect, speed_times: float = 1.0, load_times: float = 1.0) -> jbf.Run:
    """Return the motion under which an effect is shown, as a run without friction."""
    what = shown(effect)
    time, speed = speed_of(what.motion)
    speed = speed_times * speed
    assert RIG.bearing is not None
    assert RIG.load is not None
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / RATE_HZ)))
    load = np.full(len(time), load_times * what.load_share * RIG.load.normal_n)
    return jbf.Run.from_arrays(
        time,
        speed,
        angle_rad=angle / RIG.bearing.radius_m,
        load_n=load,
        temperature_c=None if what.warms_c is None else np.linspace(*what.warms_c, len(time)),
    )


def models_of(effect: Effect) -> tuple[jbf.Model, jbf.Model]:
    """Return two models that differ by one effect, the model without the effect first."""
    what = shown(effect)
    of_effect = {f"{effect.name}.{name}": value for name, value in what.values.items()}
    law, values = ("journal", LAW) if "journal" not in effect.refused else ("coulomb", IN_NEWTONS)
    others = _others(what)
    values = {**values, **what.beside}
    return (
        jbf.Model(RIG, law, effects=others, parameters=values),
        jbf.Model(RIG, law, effects=[*others, effect.name], parameters=values | of_effect),
    )


def record(effect: Effect, folder: Path) -> None:
    """Write a rig and two runs with an effect, for the command on the effect's page.

    The runs are the picture's motion, and the same at half the speed under more load, with noise.
    """
    model = models_of(effect)[1]
    RIG.write(folder / "rig.toml")
    (folder / "runs").mkdir()
    for number, times in enumerate(((1.0, 1.0), (0.5, 1.3))):
        motion = motion_of(effect, *times)
        noise = np.random.default_rng(number).normal(0.0, NOISE_N, len(motion.time_s))
        kept = slice(None, None, 4)
        jbf.Run.from_arrays(
            motion.time_s[kept],
            motion.velocity[kept],
            (model.predict(motion) + noise)[kept],
            angle_rad=motion.angle_rad[kept],
            load_n=motion.load_n[kept],
            temperature_c=None if motion.temperature_c is None else motion.temperature_c[kept],
        ).write_csv(folder / "runs" / f"{number}.csv")


def draw(effect: Effect) -> Figure:
    """Plot friction against speed and time, without the effect and with it."""
    motion = motion_of(effect)
    plain, changed = (model.predict(motion) for model in models_of(effect))
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    plane, along = figure.subplots(1, 2)
    _curves(plane, motion.velocity, plain, changed)
    plane.set(xlabel="speed, m/s", ylabel="friction, N")
    _curves(along, motion.time_s, plain, changed)
    along.set(xlabel="time, s")
    figure.legend(*along.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _others(what: Shown) -> list[str]:
    return list(dict.fromkeys(name.split(".")[0] for name in what.beside))


def _curves(axes: Axes, x: np.ndarray, plain: np.ndarray, changed: np.ndarray) -> None:
    axes.plot(x, changed, color=WITH, linewidth=1.0, label="with the effect")
    axes.plot(x, plain, color=PLAIN, linewidth=1.0, label="law alone")
    axes.spines[["top", "right"]].set_visible(False)


def page(effect: Effect) -> str:
    """Return the page of an effect in Markdown."""
    what = shown(effect)
    units = {p.name: p.unit for p in effect.parameters}
    values = ", ".join(f"{n} = {v:g} {_unit(units, n)}".strip() for n, v in what.values.items())
    under = f"under {what.motion}"
    if what.load_share != 1.0:
        under += f" and {what.load_share:g} of the rig's load"
    if what.warms_c is not None:
        under += " while it warms from {:g} to {:g} C".format(*what.warms_c)
    if what.beside:
        named = ", ".join(f"`{n}` = {v:g}" for n, v in what.beside.items())
        under += f", both with {named}"
    chosen = sorted([*_others(what), effect.name], key=list(catalogue()).index)
    law, options = "`journal`, Table 4.2", ""
    if "journal" in effect.refused:
        options = "--law coulomb "
        law = f"`coulomb`, {IN_NEWTONS['F_c']:g} N and {IN_NEWTONS['F_v']:g} N s/m"
    lines = [
        f"# {effect.name}",
        "",
        f"{effect.summary[0].upper()}{effect.summary[1:]}. Stage: {effect.stage}.",
        "",
        "```text",
        effect.equation,
        "```",
        "",
        f"![Friction against speed and along time, without and with {effect.name}]"
        f"({effect.name}.png)",
        "",
        f"Dark: the law alone ({law}). Red: with {values}, {under}.",
        "",
        "| parameter | unit | from | to | vanishes at | meaning |",
        "| --- | --- | --- | --- | --- | --- |",
        *(_row(p) for p in effect.parameters),
        "",
        f"**Source.** {effect.source}.",
        "",
        f"**Limits of validity.** {effect.limits}.",
    ]
    if effect.needs:
        needs = [words for need, words in REQUIREMENTS.items() if need in effect.needs]
        lines += ["", f"**Requirements.** {'; '.join(needs)}."] if needs else []
    if effect.refused:
        lines += ["", f"**Cannot be combined with.** {refused_words(effect)}."]
    lines += [
        "",
        "On your rig and runs:",
        "",
        f"<!-- given: effect {effect.name} -->",
        "```sh",
        f"jbf fit rig.toml runs/ {options}--effects {','.join(chosen)} --out model.toml",
        "```",
        "```output",
        f"    effects                = {', '.join(chosen)}",
        "...",
        f"    {effect.name}.{effect.parameters[0].name} ... +/- ...",
        "```",
        "",
    ]
    return "\n".join(lines)


def _unit(units: Mapping[str, str], name: str) -> str:
    matching = [unit for full, unit in units.items() if full == name or full.startswith(f"{name}_")]
    return "" if not matching or matching[0] == "-" else matching[0]


def _row(p: Parameter) -> str:
    null = "" if p.null is None else f"{p.null:g}"
    return f"| {p.name} | {p.unit} | {p.lower:g} | {p.upper:g} | {null} | {meaning_of(p)} |"


def index() -> str:
    """Return the page that lists all effects, in the order of the signal chain."""
    lines = [
        "# Effects",
        "",
        "This page lists the effects of the catalogue: physical mechanisms that a friction law",
        "lacks. They are in the order of the signal, from the commanded motion to the record.",
        "`jbf effects` prints the same list, and `jbf effects NAME` one page of it.",
        "",
        "- Pictures of the common phenomena: [friction phenomena](../phenomena.md).",
        "- Motions that determine it: [what can be identified](../what_can_be_identified.md).",
        "- Accuracy of the fitted parameters: [validation results](../validation.md).",
        "- Effects in Python: [your own effects](../user_effects.md).",
        "",
        "| stage | effect | description |",
        "| --- | --- | --- |",
    ]
    for e in catalogue().values():
        lines.append(f"| {e.stage} | [{e.name}]({e.name}.md) | {e.summary} |")
    return "\n".join([*lines, ""])


def catalogue() -> dict[str, Effect]:
    """Return the effects of the catalogue by name."""
    return built_in()


def texts() -> dict[Path, str]:
    """Return the text of every page by its path."""
    pages = {FOLDER / f"{e.name}.md": page(e) for e in catalogue().values()}
    return {FOLDER / "README.md": index(), **pages}


def stale() -> list[str]:
    """List pages and pictures that are missing, out of date, or belong to no effect."""
    expected = texts()
    wrong = [
        p.name
        for p, text in expected.items()
        if not p.is_file() or p.read_text(encoding="utf-8") != text
    ]
    pictures = {FOLDER / f"{name}.png" for name in catalogue()}
    wrong += [p.name for p in pictures if not p.is_file()]
    wrong += [p.name for p in FOLDER.iterdir() if p not in expected and p not in pictures]
    return sorted(wrong)


def main() -> int:
    """Write the pages and pictures, or check them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="pictures of these; all by default"
    )
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args()
    if options.check:
        wrong = stale()
        print("\n".join(f"stale: {name}" for name in wrong) or "all pages are in step")
        return 1 if wrong else 0
    FOLDER.mkdir(exist_ok=True)
    for path, text in texts().items():
        path.write_text(text, encoding="utf-8")
    for name in options.names or catalogue():
        draw(catalogue()[name]).savefig(FOLDER / f"{name}.png", dpi=80)
    return 0


if __name__ == "__main__":
    sys.exit(main())
