"""Make the data that `jbf demo` ships: `python simulator/make_demo_data.py`.

Two campaigns from the independent simulator: one with hidden effects, one without. Each also has a
run with a different motion that the diagnosis does not use, and a file with the true values.
"""

from __future__ import annotations

import json
from pathlib import Path

from rigsim import Campaign
from rigsim.campaign import write_campaign
from rigsim.motions import sine, stop_and_go, triangle

OUT = Path(__file__).resolve().parents[1] / "python" / "jbf" / "data" / "demo"
SEED = 1998

MOVES = [(1.0, 1), (9.0, -1), (24.0, 1), (31.0, -1)]
TAUGHT = Campaign(
    "demo",
    (
        sine("two_way_0.25", 51.0, 0.127, 0.25),
        sine("two_way_1.0", 26.0, 0.127, 1.0),
        sine("two_way_2.0", 19.0, 0.127, 2.0),
        sine("one_way_0.5", 26.0, 0.0595, 0.5, bias=0.0728),
        stop_and_go("stop_and_go", MOVES, 0.055, 0.8, 3.5, 40.0),
    ),
)
UNSEEN = Campaign("demo_unseen", (triangle("triangle_0.5", 38.0, 0.12, 0.5),))


def main() -> None:
    """Simulate and write both campaigns."""
    for name, effects in (("hidden", ["coulomb_drag", "sensor_lag"]), ("plain", [])):
        folder = OUT / name
        truth = write_campaign(folder, SEED, effects, campaign=TAUGHT)
        write_campaign(folder / "unseen", SEED, effects, campaign=UNSEEN)
        keep = {k: truth[k] for k in ("effects", "base", "noise_n", "seed")}
        (folder / "truth.json").write_text(json.dumps(keep, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
