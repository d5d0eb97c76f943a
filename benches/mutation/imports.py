"""Test files that may reach a module, estimated from imports.

They are those of its package, and those that import the module. Files of the package that share a
word with the name of the module come first. The other files of the package follow by the number of
imports between them and the module, then all other files.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path

from reach import ANY, Reach

QUICK_S, SLOW_S = 5.0, 12.0
"""Assumed durations of test files, s."""
SLOW = ("campaigns", "golden", "rigruns", "rigsim", "subprocess", "playwright")
"""Modules whose import marks a test file as slow."""


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, and the names that it imports from them."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            modules |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return modules


def by_imports(root: Path) -> Reach:
    """Build a `Reach` of test files and complete modules from the imports."""
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
        subpackage = path.relative_to(package).parts[0]
        reaching = [f for f in tests if far[f] < len(steps) or Path(f).parent.name == subpackage]
        reaching = reaching or _alike(path, list(tests))
        reaching.sort(key=_order(path, far, seconds))
        lines[path.relative_to(root).as_posix()] = {ANY: reaching}
    return Reach(seconds, lines)


def _order(
    module: Path, far: dict[str, int], seconds: dict[str, float]
) -> Callable[[str], tuple[bool, bool, int, float, str]]:
    """Return a sort key of test files for a module.

    Files named after the module come first, then those of its package, then the others by distance.
    """
    words = {*module.stem.split("_")}

    def order(file: str) -> tuple[bool, bool, int, float, str]:
        stem, folder = Path(file).stem, Path(file).parent.name
        named = bool(words & {*stem.split("_")[1:]})
        return (
            not (named and folder in module.parts),
            folder not in module.parts,
            far[file],
            (seconds[file]),
            file,
        )

    return order


def _steps(name: str, users: dict[str, set[str]]) -> dict[str, int]:
    """Return the number of imports between a module and each module that uses it, or itself."""
    steps, new = {name: 0}, {name}
    while new:
        new = {user for user, names in users.items() if user not in steps and names & new}
        steps |= dict.fromkeys(new, max(steps.values()) + 1)
    return steps


def _alike(module: Path, tests: list[str]) -> list[str]:
    """Select test files for a module that no test file imports.

    They are the files that share a word with its name, otherwise those of the command line.
    """
    words = {*module.stem.split("_")}
    return [t for t in tests if words & {*Path(t).stem.split("_")}] or [
        t for t in tests if Path(t).parent.name == "cli"
    ]


def _name(path: Path, above: Path) -> str:
    parts = path.relative_to(above).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
