"""Opening a model, a recording, a folder or a map runs no code and asks nothing of the network.

Every command runs in a process of its own whose audit hook (PEP 578) refuses what running code
would need, in a folder full of files that Python would like to import.
"""

from __future__ import annotations

import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import jbf
import numpy as np
import pytest

REFUSED = (
    "subprocess.Popen os.system os.exec os.posix_spawn os.fork socket.connect socket.getaddrinfo "
    "pickle.find_class"
)
WATCHED = """
import sys
from pathlib import Path

REFUSED, HERE = set(sys.argv.pop(1).split()), str(Path.cwd())

def watch(event, arguments):
    if event in REFUSED:
        raise SystemExit(f"{event} {arguments}")
    if event == "exec":
        name = getattr(arguments[0], "co_filename", "<")
        if not name.startswith("<") and str(Path(name).resolve()).startswith(HERE):
            raise SystemExit(f"runs {name}")

sys.path[:] = [p for p in sys.path if p not in ("", HERE)]
from jbf.cli import main

sys.addaudithook(watch)
raise SystemExit(main(sys.argv[1:]))
"""
DECOYS = ("numpy", "scipy", "matplotlib", "jbf", "sitecustomize", "usercustomize", "conftest")


class Bomb:
    """What runs when it is unpickled."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return print, ("it ran",)


@pytest.fixture
def hostile(tmp_path: Path, campaign: Path, full_fit: jbf.Fit) -> Path:
    """A campaign's folder with decoys, a pickle, and names that look like code."""
    folder = tmp_path / "$(touch owned); __import__('os')"
    folder.mkdir()
    for file in (campaign / "rig.toml", *(campaign / "runs").glob("*.csv")):
        shutil.copy(file, folder)
    full_fit.model.save(folder / "model.toml")
    for name in DECOYS:
        (folder / f"{name}.py").write_text("raise SystemExit('a decoy ran')\n")
    run = next(iter(sorted(folder.glob("*.csv"))))
    run.rename(folder / "{{7*7}}__import__('os').system('id').csv")
    np.save(folder / "bomb.npy", np.array([Bomb()], dtype=object), allow_pickle=True)
    (folder / "bomb.pkl").write_bytes(pickle.dumps(Bomb()))
    map_file = (
        "[columns]\ntime_s = \"__import__('os').system('id')\"\nfriction_n = \"friction_n\"\n"
    )
    (folder / "map.toml").write_text(map_file)
    return folder


def watched(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-I", "-c", WATCHED, REFUSED, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_opening_runs_nothing(hostile: Path) -> None:
    runs = sorted(p.name for p in hostile.glob("*.csv"))
    before = {p.name for p in hostile.iterdir()}
    said = watched(hostile, "compare", "model.toml", *runs, "--json", "-")
    assert (said.returncode, said.stderr) == (0, "")
    said = watched(hostile, "compare", "model.toml", *runs, "--report", "page.html")
    assert (said.returncode, said.stderr) == (0, "")
    assert {p.name for p in hostile.iterdir()} == before | {"page.html"}
    page = (hostile / "page.html").read_text()
    assert "<script" not in page.lower()
    assert "__import__(&#x27;os&#x27;)" in page or "__import__(&#39;os&#39;)" in page


@pytest.mark.parametrize("file", ["bomb.npy", "bomb.pkl"])
def test_a_pickle_is_refused_unopened(hostile: Path, file: str) -> None:
    said = watched(hostile, "import", file, "--out", "out")
    assert said.returncode == 2
    assert said.stderr.startswith("jbf: ")
    assert "it ran" not in said.stdout + said.stderr


def test_an_expression_is_arithmetic_and_no_code(hostile: Path) -> None:
    run = next(iter(sorted(p.name for p in hostile.glob("*.csv") if "os" not in p.name)))
    said = watched(hostile, "import", run, "--map", "map.toml", "--out", "out")
    assert said.returncode == 2
    assert said.stderr.startswith("jbf: ")
    assert "uid=" not in said.stdout + said.stderr


def test_own_effects_do_run_and_help_says_so(hostile: Path) -> None:
    (hostile / "own.py").write_text("print('own code ran')\n")
    said = watched(hostile, "compare", "model.toml", "none.csv", "--effects-from", "own.py")
    assert "SystemExit: runs own.py" in said.stderr
    assert "own code ran" not in said.stdout
    said = watched(hostile, "compare", "--help")
    assert "run this Python file first" in " ".join(said.stdout.split())
