"""The bench of mutants drawn by lot, on a module of three: two are caught, one cannot be."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

pytest.importorskip("cosmic_ray")

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "benches" / "mutation"
MODULE = """\
from __future__ import annotations


def total(a: int | None, b: int) -> int | float:
    return (a or b) + b


def size(a: int) -> int:
    return abs(-a)
"""
"""`or` and `+` can be told from `and` and `-`; the size of a number has no sign to lose."""
TESTS = """\
from sums import size, total


def test_total():
    assert total(3, 2) == 5


def test_size():
    assert size(-2) == 2 == size(2)
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository of one module, its tests, and which of them reach it."""
    room = tmp_path / "tree" / "package" / "room"
    room.mkdir(parents=True)
    (room / "sums.py").write_text(MODULE)
    root = tmp_path / "tree"
    (root / "conftest.py").write_text("import sys\nsys.path.insert(0, 'package/room')\n")
    (root / "test_sums.py").write_text(TESTS)
    names = ["test_sums.py::test_total", "test_sums.py::test_size"]
    reach = {"seconds": dict.fromkeys(names, 0.1)}
    reach["lines"] = {"package/room/sums.py": {"5": [0], "9": [1]}}
    (tmp_path / "reach.json").write_text(json.dumps(reach))
    subprocess.run(["git", "init", "-q", str(root)], check=True)
    return root


def tried(tree: Path, *more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(BENCH), "--root", str(tree), "--package", "package"]
    command += ["--room", "room", "--out", str(tree.parent / "record.jsonl")]
    command += ["--reach", str(tree.parent / "reach.json"), *more]
    return subprocess.run(command, capture_output=True, text=True)


def test_a_caught_and_a_surviving_mutant_are_told_apart(tree: Path) -> None:
    record = tree.parent / "record.jsonl"
    tried(tree, "--sample", "1")
    first = record.read_text()
    done = tried(tree, "--sample", "9")
    assert done.returncode == 0, done.stderr
    # A longer sample begins with the shorter.
    assert record.read_text().startswith(first)
    rows = {row["operator"]: row for row in map(json.loads, record.read_text().splitlines())}
    # Three sites: the annotations' `|` is never run, and is none.
    assert {name: row["word"] for name, row in rows.items()} == {
        "ReplaceOrWithAnd": "caught",
        "ReplaceBinaryOperator_Add_Sub": "caught",
        "ReplaceUnaryOperator_Delete_USub": "survived",
    }
    plus = rows["ReplaceBinaryOperator_Add_Sub"]
    assert plus["diff"] == ["-    return (a or b) + b", "+    return (a or b) - b"]
    assert plus["by"] == "test_sums.py::test_total"
    assert "| all | 2 | 3 | 67% | 9% to 99% |" in done.stdout
    # The tree itself is left alone, and what is in the record is not tried again.
    assert (tree / "package" / "room" / "sums.py").read_text() == MODULE
    before = record.read_text()
    assert tried(tree, "--sample", "9", "--least", "0.6").returncode == 0
    assert tried(tree, "--sample", "9", "--least", "0.7").returncode == 1
    assert record.read_text() == before


def test_a_test_that_fails_anyway_notices_nothing(tree: Path) -> None:
    (tree / "test_sums.py").write_text(TESTS.replace("== 5", "== 6"))
    assert "| all | 0 | 3 | 0% | 0% to 71% |" in tried(tree, "--sample", "3").stdout


def test_nor_does_it_as_one_of_a_file(tree: Path) -> None:
    """By their imports files are asked, and one test of them may fail whatever the code is."""
    (tree / "test_sums.py").write_text(TESTS + "\n\ndef test_no():\n    assert False\n")
    done = tried(tree, "--sample", "9", "--tests", "test_sums.py")
    assert done.returncode == 0, done.stderr
    rows = map(json.loads, (tree.parent / "record.jsonl").read_text().splitlines())
    assert sorted(row["word"] for row in rows) == ["caught", "caught", "survived"]


def test_the_interval_is_clopper_and_pearsons(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its limits are the shares under which so few, or so many, have a chance of 2.5 %."""
    from scipy.stats import binom

    monkeypatch.syspath_prepend(str(BENCH))
    monkeypatch.syspath_prepend(str(BENCH.parent))
    from score import interval

    low, high = interval(27, 30)
    assert binom.sf(26, 30, low) == pytest.approx(0.025, rel=1e-6)
    assert binom.cdf(27, 30, high) == pytest.approx(0.025, rel=1e-6)
    assert interval(0, 5) == (0.0, pytest.approx(1 - 0.025**0.2))
    assert interval(5, 5) == (pytest.approx(0.025**0.2), 1.0)


def test_without_a_measurement_tests_are_those_that_import_a_module() -> None:
    sys.path.insert(0, str(BENCH))
    try:
        reach = import_module("imports").by_imports(ROOT)
    finally:
        sys.path.remove(str(BENCH))
    first = reach.chosen("python/jbf/estimation/film_rate.py", 40, 5.0)
    assert first.tests == ("python/tests/test_film_rate.py",)
    several = reach.chosen("python/jbf/estimation/problem.py", 40, 15.0)
    assert 1 < len(several.tests) <= 3
    # Of many that name it those that are called after it.
    assert several.tests[0] == "python/tests/test_problem.py"
    noise = reach.chosen("python/jbf/estimation/noise.py", 40, 60.0)
    assert {"python/tests/test_noise.py", "python/tests/test_noise_rules.py"} <= {*noise.tests}
    rooms = ("records", "estimation", "comparison", "diagnosis", "reporting", "control")
    for module, at in reach.lines.items():
        if module.split("/")[2] in rooms and not module.endswith("__init__.py"):
            assert at["0"], module
