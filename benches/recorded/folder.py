"""Reader of labelled campaigns that already exist on disk."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from case import Case
from jbf.renamed import current_effect


def cases(folder: Path, held_out: Path) -> list[Case]:
    """Read the campaigns of a folder with `NAME/rig.toml`, `NAME/*.csv` and the truth.

    `truth.json` in the folder or above it contains `effects`, `artefacts`, `noise_n` and, if known,
    `strength` by name. Alternatively each campaign has a `NAME.json` next to its folder. Raises
    FileNotFoundError with a message if something is missing.
    """
    for needed in (folder, held_out):
        if not needed.is_dir():
            raise FileNotFoundError(f"there is no folder {needed}")
    campaigns = []
    for name, truth in sorted(_truths(folder).items()):
        for needed in (folder / name, held_out / name):
            if not needed.is_dir():
                raise FileNotFoundError(f"the truth knows {name}, but there is no {needed}")
        campaigns.append(
            Case(
                name,
                tuple(map(current_effect, truth["effects"])),
                tuple(truth.get("artefacts", ())),
                truth.get("strength", "-"),
                truth["noise_n"],
                str(folder / name),
                str(held_out / name),
            )
        )
    return campaigns


def _truths(folder: Path) -> dict[str, Any]:
    places = [folder / "truth.json", folder.parent / "truth.json"]
    for place in places:
        if place.is_file():
            truths: dict[str, Any] = json.loads(place.read_text(encoding="utf-8"))
            return truths
    truth_files = [path for path in folder.glob("*.json") if path.with_suffix("").is_dir()]
    if not truth_files:
        raise FileNotFoundError(f"there is no {places[0]}, nor {places[1]}")
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in truth_files}
