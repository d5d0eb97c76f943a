"""Draw the architecture diagrams: `.venv/bin/python docs/architecture.py`.

`docs/images/packages.png` shows the packages of `python/jbf` from top to bottom, with the number of
imports between them; `docs/images/data_flow.png` shows the data flow of a diagnosis.
"""

from __future__ import annotations

import ast
import sys
import textwrap
from collections import Counter
from itertools import pairwise
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

ROOT = Path(__file__).resolve().parents[1]
PACKAGE, IMAGES = ROOT / "python" / "jbf", ROOT / "docs" / "images"
INK, NOTE, BOX, CORE, ARROW = "#222222", "#555555", "#e8f0f7", "#f6e7dc", "#7a8fa3"

LAYERS: list[list[tuple[str, str]]] = [
    [("cli", "arguments in, files out")],
    [("workbench", "files and clicks in;\na page in the browser out")],
    [("reporting", "results in; words, tables,\npictures, pages, JSON out")],
    [("plot", "results in;\nsingle pictures out")],
    [
        ("control", "model in; loop, bench,\ncompensators out"),
        ("diagnosis", "comparison in;\nwhat is missing out"),
        ("export", "model in;\nRust, C out"),
    ],
    [("comparison", "record - prediction in;\nwhere it fails out")],
    [("estimation", "model x runs in;\nparameters with errors out")],
    [
        ("", ""),  # placeholder: `importing` does not belong below the packages above
        ("models", "law + effects + parameters in;\nprediction out"),
        ("importing", "foreign files, a map in;\nruns, rig, ledger out"),
    ],
    [("records", "files in; runs, rig,\nestimated motion out")],
    [("_core", "crates/jbf-{py, predict, batch, catalogue, core}: the physics, once, in Rust")],
]


def imports() -> Counter[tuple[str, str]]:
    """Count the imports from each package to each other package."""
    packages = {name for layer in LAYERS for name, _ in layer if name}
    counts: Counter[tuple[str, str]] = Counter()
    for path in PACKAGE.rglob("*.py"):
        package = path.relative_to(PACKAGE).parts[0]
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.ImportFrom) or not node.module:
                continue
            names = [node.module.split(".")[1]] if node.module.startswith("jbf.") else []
            if node.module == "jbf":
                names = [a.name for a in node.names]
            for name in names:
                if package in packages and name in packages and name != package:
                    counts[package, name] += 1
    return counts


def box(ax: Axes, x: float, y: float, size: tuple[float, float], title: str, words: str) -> None:
    """Draw the box of a package or step: its name, its input and its output."""
    width, height = size
    colour = CORE if title == "_core" else BOX
    corner = (x - width / 2, y - height / 2)
    style = "round,pad=0.02,rounding_size=0.06"
    ax.add_patch(FancyBboxPatch(corner, width, height, boxstyle=style, fc=colour, ec=INK, lw=1.0))
    lines = words.count("\n") + 1
    ax.text(x, y + 0.09 * lines, title, ha="center", va="center", weight="bold", color=INK)
    ax.text(x, y - 0.14, words, ha="center", va="center", fontsize=8, color=INK)


def canvas(width: float, height: float) -> tuple[Figure, Axes]:
    """Return a figure of this size and axes that fill it, both with inches as units."""
    figure = Figure(figsize=(width, height))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_xlim(0.0, width)
    ax.set_ylim(0.0, height)
    ax.set_axis_off()
    return figure, ax


def arrow(ax: Axes, a: tuple[float, float], b: tuple[float, float], bend: float = 0.0) -> None:
    """Draw an arrow from point `a` to point `b`, curved by `bend`."""
    style = f"arc3,rad={bend}"
    ax.add_patch(
        FancyArrowPatch(
            a, b, arrowstyle="-|>", mutation_scale=11, color=ARROW, lw=1.3, connectionstyle=style
        )
    )


def packages() -> Figure:
    """Draw the diagram of the packages; each imports only those below it."""
    counts = imports()
    figure, ax = canvas(9.4, 1.12 * len(LAYERS) + 0.24)
    places: dict[str, tuple[float, float]] = {}
    order = [name for layer in LAYERS for name, _ in layer]
    for k, layer in enumerate(LAYERS):
        for i, (name, words) in enumerate(layer):
            if not name:
                continue
            x, y = 4.3 + 2.8 * (i - (len(layer) - 1) / 2), 1.12 * (len(LAYERS) - k) - 0.36
            places[name] = (x, y)
            box(ax, x, y, (5.2, 0.62) if name == "_core" else (2.5, 0.74), name, words)
            below = [f"{n} {counts[name, n]}" for n in order if counts[name, n]]
            if below and len(layer) == 1:
                text = textwrap.fill(", ".join(below), 46)
                note = ax.text(
                    x + 1.4, y, f"imports\n{text}", va="center", fontsize=7.5, color=NOTE
                )
                note.set_bbox({"fc": "white", "ec": "none", "pad": 1.0})  # over an arrow
                note.set_zorder(3)
    for a, b in pairwise(LAYERS):
        for name, _ in a:
            for other, _ in b:
                if name and other and counts[name, other]:
                    (xa, ya), (xb, yb) = places[name], places[other]
                    arrow(ax, (xa, ya - 0.4), (xb, yb + 0.4))
    x, y = places["models"]
    for name, side in (("control", -1.0), ("export", 1.0)):
        if counts[name, "models"]:
            arrow(ax, (places[name][0], places[name][1] - 0.4), (x + 1.3 * side, y + 0.25))
    return figure


STEPS: list[tuple[str, str]] = [
    ("records", "CSV, TOML -> Run, Rig\nmotion: rests, smoothing,\nwhere the sign is known"),
    ("Campaign, Samples", "runs made ready once;\nwhich samples count"),
    (
        "Problem, minimum",
        "law + effects: residuals and\nderivatives from the core;\nleast squares of innovations",
    ),
    ("Comparison", "noise layer;\nwhere the base law fails"),
    ("candidates", "score test -> rank ->\nconverge -> search peaks"),
    ("evidence, held_out", "likelihood gain less penalty;\nheld-out runs"),
    ("selection", "add the leader; take out,\nexchange; ties"),
    ("residual_structure", "patterns, tones, replicates,\nbursts, constancy"),
    ("verdict, policy", "adequate, missing,\nambiguous, unexplained"),
    ("Diagnosis", "ledger of errors, model,\nnext experiment -> reporting"),
]


def data_flow() -> Figure:
    """Draw the diagram of the data flow: the steps of a diagnosis in their order."""
    figure, ax = canvas(11.0, 3.9)
    places = []
    for k, (name, words) in enumerate(STEPS):
        row, column = divmod(k, 5)
        x, y = 1.15 + 2.17 * (4 - column if row else column), 3.1 - 2.2 * row
        places.append((x, y))
        box(ax, x, y, (1.9, 1.05), name, words)
    for (xa, ya), (xb, yb) in pairwise(places):
        if ya == yb:
            side = 0.98 if xb > xa else -0.98
            arrow(ax, (xa + side, ya), (xb - side, yb))
        else:
            arrow(ax, (xa, ya - 0.57), (xb, yb + 0.57))
    (xa, ya), (xb, yb) = places[6], places[4]
    arrow(ax, (xa, ya + 0.57), (xb - 0.6, yb - 0.57))
    ax.text(
        8.0, 1.93, "another round, until\nno candidate leads", fontsize=8, color=NOTE, ha="right"
    )
    return figure


def main() -> int:
    """Draw both diagrams."""
    for name, figure in (("packages", packages()), ("data_flow", data_flow())):
        figure.savefig(IMAGES / f"{name}.png", dpi=110)
        print(f"docs/images/{name}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
