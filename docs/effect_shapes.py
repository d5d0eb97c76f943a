"""Write the shape of every effect for the workbench: `.venv/bin/python docs/effect_shapes.py`.

The shapes are the right-hand curves of the pictures of the effects (`docs/effects.py`): friction
along time of the law alone and with the effect, scaled to a maximum of one.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402
from effects import models_of, motion_of  # noqa: E402
from jbf.models.catalogue import Effect, built_in  # noqa: E402

FILE = HERE.parent / "python" / "jbf" / "workbench" / "static" / "effect_shapes.json"
POINTS = 96


def shape(effect: Effect) -> list[list[float]]:
    """Friction of the law alone and with an effect along time, scaled, shape (2, POINTS)."""
    motion = motion_of(effect)
    curves = np.array([model.predict(motion) for model in models_of(effect)])
    at = np.linspace(0, curves.shape[1] - 1, POINTS).round().astype(int)
    return np.round(curves[:, at] / np.max(np.abs(curves[:, at])), 2).tolist()  # type: ignore[no-any-return]


def main() -> int:
    """Write the file with the shapes of all effects."""
    lines = [f"{json.dumps(e.name)}: {json.dumps(shape(e))}" for e in built_in().values()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
