"""The bench of deliberate faults, on a tree of two files; and a few real faults, among the slow."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import tomlkit

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "benches" / "mutants"
OFTEN = (
    "the residual of a comparison is reversed",
    "the ledger shows the fit's RMS as held out",
    "the page exchanges the bare law and the final model",
    "correlations stand under reversed names",
    "bootstrap errors are twice too wide",
    "errors of a trajectory fit are 0.71",
)
"""Once all six of them at once left every test green."""


def table(what: str, old: str, test: str) -> str:
    return (
        f'[[mutant]]\nwhat = "{what}"\nfile = "sum.py"\nold = "{old}"\nnew = "a - b"\n'
        f"test = '''{test}'''\n"
    )


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository of one function and its tests."""
    root = tmp_path / "tree"
    root.mkdir()
    (root / "sum.py").write_text("def sum(a, b):\n    return a + b\n")
    (root / "good.py").write_text("from sum import sum\nassert sum(1, 2) == 3\n")
    (root / "lazy.py").write_text("from sum import sum\nassert sum(1, 0) == 1\n")
    subprocess.run(["git", "init", "-q", str(root)], check=True)
    return root


def tried(tree: Path, *tables: str) -> subprocess.CompletedProcess[str]:
    folder = tree.parent / "tables"
    folder.mkdir(exist_ok=True)
    (folder / "own.toml").write_text("\n".join(tables))
    command = [sys.executable, str(BENCH), "--tables", str(folder), "--root", str(tree)]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("table", sorted(BENCH.glob("*.toml")), ids=lambda path: path.stem)
def test_every_fault_stands_where_the_code_is_now(table: Path) -> None:
    faults = tomlkit.parse(table.read_text(encoding="utf-8")).unwrap()["mutant"]
    assert faults
    gone = [f["what"] for f in faults if (ROOT / f["file"]).read_text("utf-8").count(f["old"]) != 1]
    assert gone == []
    named = [f["test"].split() if isinstance(f["test"], str) else f["test"] for f in faults]
    tests = {word for words in named for word in words if word.endswith(".py")}
    assert [name for name in sorted(tests) if not (ROOT / name).exists()] == []


def test_a_fault_that_a_test_notices(tree: Path) -> None:
    done = tried(tree, table("minus", "a + b", "python good.py"))
    assert done.stdout.splitlines()[0].startswith("noticed ")
    assert done.stdout.splitlines()[-1] == "1 noticed"
    assert done.returncode == 0
    # The tree itself is left alone.
    assert "a + b" in (tree / "sum.py").read_text()


@pytest.mark.parametrize(
    ("old", "test", "word"),
    [
        ("a + b", "python lazy.py", "LIVES"),
        ("a * b", "python good.py", "does not apply"),
        ("a", "python good.py", "does not apply"),
        ("a + b", "false", "test fails without it"),
    ],
)
def test_what_is_not_noticed_is_a_failure(tree: Path, old: str, test: str, word: str) -> None:
    done = tried(tree, table("one", old, test), table("other", "a + b", "python good.py"))
    assert [row.split("  ")[0] for row in done.stdout.splitlines()[:2]] == [word, "noticed"]
    assert f"1 {word}" in done.stdout.splitlines()[-1]
    assert done.returncode == 1


@pytest.mark.slow
def test_faults_that_once_lived_are_noticed() -> None:
    only = [word for name in OFTEN for word in ("--only", name)]
    done = subprocess.run([sys.executable, str(BENCH), *only], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == f"{len(OFTEN)} noticed", done.stdout + done.stderr
