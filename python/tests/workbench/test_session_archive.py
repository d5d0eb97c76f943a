"""Archives of a saved session that are refused: unsafe names, broken sessions, damaged files."""

import json
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.errors import InputError
from jbf.workbench import session_bundle
from jbf.workbench.files import Folder
from jbf.workbench.session import Session


@pytest.mark.parametrize("name", ["../outside.csv", "/etc/passwd", "a/b.csv", "run.py", "c\\d.csv"])
def test_session_file_that_names_another_place_is_refused(tmp_path: Path, name: str) -> None:
    content = {"format": "jbf workbench 1", "rig": "rig.toml", "runs": [name]}
    folder = tmp_path / "folder"
    folder.mkdir()
    with zipfile.ZipFile(folder / "bad.zip", "w") as archive:
        archive.writestr("workbench.json", json.dumps(content))
        archive.writestr("rig.toml", "")
        archive.writestr(name, "time_s\n")
    with pytest.raises(InputError):
        session_bundle.open_bundle(Session(Folder.of(folder)), "bad.zip")
    assert [path.name for path in folder.iterdir()] == ["bad.zip"]
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


def test_folder_of_an_archive_whose_session_is_broken_is_removed(tmp_path: Path) -> None:
    content = {"format": "jbf workbench 1", "rig": "rig.toml", "runs": ["a.csv"]}
    with zipfile.ZipFile(tmp_path / "broken.zip", "w") as archive:
        archive.writestr("workbench.json", json.dumps(content))
        archive.writestr("rig.toml", "")
        archive.writestr("a.csv", "time_s\n")
    with pytest.raises(InputError):
        session_bundle.open_bundle(Session(Folder.of(tmp_path)), "broken.zip")
    assert [path.name for path in tmp_path.iterdir()] == ["broken.zip"]


@pytest.mark.parametrize("case", ["encrypted", "unknown compression", "damaged"])
def test_archive_that_cannot_be_unpacked_is_refused(tmp_path: Path, case: str) -> None:
    path = tmp_path / "bad.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("workbench.json", json.dumps({"format": "jbf workbench 1"}) * 20)
    data = bytearray(path.read_bytes())
    central = data.index(b"PK\x01\x02")
    if case == "encrypted":
        data[6] |= 1
        data[central + 8] |= 1
    elif case == "unknown compression":
        data[8] = data[central + 10] = 99
    else:
        data[30 + len("workbench.json")] = 0xFF
    path.write_bytes(data)
    with pytest.raises(InputError, match="is not a session"):
        session_bundle.open_bundle(Session(Folder.of(tmp_path)), "bad.zip")
