"""Opening a model, a recording, a folder or a map runs no code and uses no network.

Each command runs in a separate process. Its audit hook (PEP 578) stops whatever the execution of
foreign code needs, in a folder with files that Python would import.
"""

import pickle
import re
import shutil
import subprocess
import sys
from pathlib import Path

import jbf
import numpy as np
import pytest
from input_checks import cases

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
    """An object whose unpickling runs code."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return print, ("it ran",)


@pytest.fixture
def hostile(tmp_path: Path, campaign: Path, full_fit: jbf.Fit) -> Path:
    """A campaign folder with decoy modules, a pickle, and names that resemble code."""
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
    columns = "time_s = \"__import__('os').system('id')\"\nfriction_n = \"friction_n\"\n"
    (folder / "map.toml").write_text(f"[columns]\n{columns}")
    return folder


def watched(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-I", "-c", WATCHED, REFUSED, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)


@pytest.mark.extended
def test_compare_with_a_report_runs_no_code_of_a_hostile_folder(hostile: Path) -> None:
    runs = sorted(p.name for p in hostile.glob("*.csv"))
    before = {p.name for p in hostile.iterdir()}
    done = watched(hostile, "compare", "model.toml", *runs, "--json", "-", "--report", "page.html")
    assert (done.returncode, done.stderr) == (0, "")
    assert {p.name for p in hostile.iterdir()} == before | {"page.html"}
    page = (hostile / "page.html").read_text()
    assert "<script" not in page.lower()
    assert "__import__(&#x27;os&#x27;)" in page or "__import__(&#39;os&#39;)" in page


HOSTILE = {"array": ("bomb.npy",), "pickle": ("bomb.pkl",), "map": ("stopgo.csv --map map.toml",)}


@pytest.mark.parametrize("words", cases(HOSTILE, ("array", "map")))
def test_import_refuses_a_pickle_or_map_without_running_its_code(hostile: Path, words: str) -> None:
    done = watched(hostile, "import", *words.split(), "--folder", "out")
    assert done.returncode == 2
    assert done.stderr.startswith("jbf: ")
    assert not re.search("it ran|uid=", done.stdout + done.stderr)


def test_effects_from_option_runs_the_given_file_and_its_help_states_this(hostile: Path) -> None:
    (hostile / "own.py").write_text("print('own code ran')\n")
    done = watched(hostile, "compare", "model.toml", "none.csv", "--effects-from", "own.py")
    assert "SystemExit: runs own.py" in done.stderr
    assert "own code ran" not in done.stdout
    done = watched(hostile, "compare", "--help")
    assert re.search(
        r"--effects-from FILE\.py [^-]*\b(?:run|executed)\b", " ".join(done.stdout.split())
    )
