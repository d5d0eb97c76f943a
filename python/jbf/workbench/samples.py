"""Simulated sample recordings, opened by one click."""

from __future__ import annotations

import filecmp
import shutil
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path

from jbf.errors import InputError
from jbf.workbench.session import Session


@dataclass(frozen=True)
class Sample:
    """Sample campaign of the package.

    Attributes
    ----------
    title, words
        Name and description on the page.
    source
        Folder in the data of the package.
    places
        Folders that may contain it, relative to the session's folder. The data are copied into the
        last if none does.
    """

    title: str
    words: str
    source: str
    places: tuple[str, ...]


SAMPLES = {
    "bearing": Sample(
        "Journal bearing",
        "Five runs of a bearing with oil film",
        "demo/hidden",
        # The first two apply if the session's folder is that of the demo or its parent.
        ("hidden", "jbf-demo/hidden", "jbf-demo"),
    ),
    "axis": Sample(
        "Linear axis",
        "Four runs of a slide with a linear motor",
        "samples/axis",
        ("sample-axis",),
    ),
    "joint": Sample(
        "Robot joint",
        "Four runs of a joint that lifts its arm",
        "samples/joint",
        ("sample-joint",),
    ),
}
"""Samples by name, simulated with a fixed seed (`simulator/make_sample_data.py`)."""


def open_sample(session: Session, name: str) -> None:
    """Open a sample in the session, copied into the folder if it is not there.

    Raises
    ------
    InputError
        The sample is unknown, or a folder of this name has other contents.
    """
    if name not in SAMPLES:
        raise InputError(problem=f"{name!r} is not a sample", remedy=f"choose {', '.join(SAMPLES)}")
    sample = SAMPLES[name]
    root = session.folder.root
    with as_file(files("jbf") / "data") as data:
        shipped = data / sample.source
        copies = [place for place in sample.places if _holds(root / place, shipped)]
        where = copies[0] if copies else sample.places[-1]
        if not copies:
            shutil.copytree(shipped, root / where, dirs_exist_ok=True)
    runs = sorted(path.name for path in (root / where).glob("*.csv"))
    session.open(f"{where}/rig.toml", [f"{where}/{name}" for name in runs])


def _holds(folder: Path, shipped: Path) -> bool:
    """Whether a folder contains the shipped rig and runs of a sample."""
    names = ["rig.toml", *(path.name for path in shipped.glob("*.csv"))]
    _, differ, missing = filecmp.cmpfiles(shipped, folder, names, shallow=False)
    return not differ and not missing


def listing() -> list[dict[str, str]]:
    """Name, title and description of each sample, for the page."""
    return [{"name": n, "title": s.title, "words": s.words} for n, s in SAMPLES.items()]
