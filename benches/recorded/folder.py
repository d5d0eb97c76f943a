"""Labelled campaigns that are on disk already."""

from __future__ import annotations

import json
from pathlib import Path

from case import Case


def cases(folder: Path, held_out: Path) -> list[Case]:
    """The campaigns of a folder with `NAME/rig.toml`, `NAME/*.csv` and a truth beside them.

    `truth.json` is in the folder or above it: name to `effects`, `artefacts`, `noise_n` and, where
    it is known, `strength`. Raises FileNotFoundError, in words, where something is missing.
    """
    places = [folder / "truth.json", folder.parent / "truth.json"]
    truths = next((p for p in places if p.is_file()), None)
    for needed in (folder, held_out):
        if not needed.is_dir():
            raise FileNotFoundError(f"there is no folder {needed}")
    if truths is None:
        raise FileNotFoundError(f"there is no {places[0]}, nor {places[1]}")
    found = []
    for name, truth in sorted(json.loads(truths.read_text(encoding="utf-8")).items()):
        if not (folder / name).is_dir():
            raise FileNotFoundError(
                f"{truths} knows {name}, but there is no folder {folder / name}"
            )
        found.append(
            Case(
                name,
                tuple(truth["effects"]),
                tuple(truth.get("artefacts", ())),
                truth.get("strength", "-"),
                truth["noise_n"],
                str(folder / name),
                str(held_out / name),
            )
        )
    return found
