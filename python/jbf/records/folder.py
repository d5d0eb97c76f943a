"""Campaign folders (`rig.toml` and the runs as CSV), and folders of such folders."""

from __future__ import annotations

import os
from pathlib import Path

from jbf.errors import InputError
from jbf.records.rig import Rig, read_rig
from jbf.records.run import PathLike, Run
from jbf.records.run_files import read_runs
from jbf.text_files import path_of


def read_campaign(folder: PathLike) -> tuple[Rig, list[Run]]:
    """Read the rig and the runs of a folder that holds `rig.toml` and CSV files.

    Raises
    ------
    InputError
        There is no rig or no run, or one of them is invalid.
    """
    folder = path_of(folder)
    path = folder / "rig.toml"
    if not os.path.isfile(path):
        raise InputError(
            file=folder,
            problem="contains no rig.toml",
            remedy="put the rig file into the folder of its runs",
        )
    rig = read_rig(path)
    return rig, read_runs(folder, rig)


def campaigns_in(folder: PathLike) -> dict[str, Path]:
    """Find the subfolders of a folder that contain a rig or a run, by name.

    Raises
    ------
    InputError
        No subfolder holds a rig or a run.
    """
    folder = path_of(folder)
    campaigns = {
        path.name: path
        for path in sorted(folder.iterdir() if os.path.isdir(folder) else ())
        if path.is_dir() and ((path / "rig.toml").is_file() or any(path.glob("*.csv")))
    }
    if not campaigns:
        raise InputError(
            file=folder,
            problem="contains no campaign",
            remedy="give each campaign a subfolder with rig.toml and the runs as CSV",
        )
    return campaigns
