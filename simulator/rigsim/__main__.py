"""Write a simulated measurement campaign with hidden effects: `python -m rigsim OUT`.

The true values are printed.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from .campaign import write_campaign


def _names(text: str) -> list[str]:
    return [name for name in text.split(",") if name]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="rigsim", description=__doc__)
    parser.add_argument("out", type=Path, help="folder for rig.toml and the runs")
    parser.add_argument("--effects", type=_names, default=[], help="names, comma-separated")
    parser.add_argument("--foreign", type=_names, default=[], help="names, comma-separated")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--strength", type=float, default=1.0, help="0.6 to 1.5 is sensible")
    parser.add_argument("--noise", type=float, help="white sd as a share of f_m times load")
    parser.add_argument("--coloured", action="store_true", help="add noise of 0.2 s correlation")
    parser.add_argument("--campaign", default="full", help="full, heldout, loads, slow or steady")
    parser.add_argument("--heldout", type=Path, help="folder for other motions of the same rig")
    parser.add_argument("--truth", type=Path, help="write the truth here, not to stdout")
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return 0 on success, 2 on invalid input."""
    given = _parser().parse_args(arguments)
    options = (given.effects, given.strength, given.noise, given.coloured)
    try:
        truth = write_campaign(given.out, given.seed, *options, given.campaign, given.foreign)
        if given.heldout is not None:
            other = write_campaign(given.heldout, given.seed, *options, "heldout", given.foreign)
            truth["heldout_effect_to_noise"] = other["effect_to_noise"]
    except ValueError as error:
        print(f"rigsim: {error}", file=sys.stderr)
        return 2
    text = json.dumps(truth, indent=1)
    if given.truth is None:
        print(text)
    else:
        given.truth.write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
