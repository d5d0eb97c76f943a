"""Which tests may reach a module, where nobody has measured it: those that import it.

Files that name the module come first, then those that name one that imports it, and so on; of each
those that are called after the module, and those that run no simulator and no process, which take
seconds.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path

from reach import ANY, Reach

QUICK_S, SLOW_S = 5.0, 12.0
"""What a file of tests is taken to take."""
SLOW = ("campaigns", "golden", "rigruns", "rigsim", "subprocess", "playwright")
"""Who imports one of these takes longer."""


def imported(path: Path) -> set[str]:
    """The modules that a file names, and the names that it takes from them."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def by_imports(root: Path) -> Reach:
    """A reach in files of tests and whole modules."""
    package = root / "python" / "jbf"
    modules = {path: _name(path, package.parent) for path in sorted(package.rglob("*.py"))}
    users = {name: imported(path) for path, name in modules.items()}
    tests = {
        path.relative_to(root).as_posix(): imported(path)
        for path in sorted((root / "python" / "tests").rglob("test_*.py"))
    }
    seconds = {file: SLOW_S if names & {*SLOW} else QUICK_S for file, names in tests.items()}
    lines = {}
    for path, name in modules.items():
        steps = _steps(name, users)
        far = {
            file: min((steps[n] for n in names if n in steps), default=len(steps))
            for file, names in tests.items()
        }
        reaching = [file for file in tests if far[file] < len(steps)] or _alike(path, list(tests))
        reaching.sort(key=_order(path, far, seconds))
        lines[path.relative_to(root).as_posix()] = {ANY: reaching}
    return Reach(seconds, lines)


def _order(
    module: Path, far: dict[str, int], seconds: dict[str, float]
) -> Callable[[str], tuple[int, bool, float, str]]:
    """Of a file of tests how soon it is asked about a module."""
    words = {*module.stem.split("_")}

    def order(file: str) -> tuple[int, bool, float, str]:
        return far[file], not words <= {*Path(file).stem.split("_")}, seconds[file], file

    return order


def _steps(name: str, users: dict[str, set[str]]) -> dict[str, int]:
    """How many imports lie between a module and each that it reaches, itself included."""
    steps, new = {name: 0}, {name}
    while new:
        new = {user for user, names in users.items() if user not in steps and names & new}
        steps |= dict.fromkeys(new, max(steps.values()) + 1)
    return steps


def _alike(module: Path, tests: list[str]) -> list[str]:
    """Of a module that is opened late, by its name: tests that share a word with it, else those of
    the command line."""
    words = {*module.stem.split("_")}
    return [t for t in tests if words & {*Path(t).stem.split("_")}] or [
        t for t in tests if Path(t).parent.name == "cli"
    ]


def _name(path: Path, above: Path) -> str:
    parts = path.relative_to(above).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
