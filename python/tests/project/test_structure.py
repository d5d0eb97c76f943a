"""Structure of the package: layers of imports and sizes of files."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import jbf
import pytest

PACKAGE = Path(jbf.__file__).parent
ROOT = PACKAGE.parents[1]
MAX_LINES = 400


def modules() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def imports_of(path: Path) -> list[ast.ImportFrom]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


@pytest.mark.skipif(not (ROOT / "pyproject.toml").is_file(), reason="needs the source tree")
def test_packages_import_only_lower_layers() -> None:
    linter = Path(sys.executable).with_name("lint-imports")
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    command = [str(linter), "--no-cache"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:]


def test_modules_import_only_the_extension_from_the_top_package() -> None:
    """The import contract of the linter ignores `from jbf import ...` because of the extension."""
    for path in modules():
        if path.name != "__init__.py":
            imports = [node for node in imports_of(path) if node.module == "jbf"]
            assert {alias.name for node in imports for alias in node.names} <= {"_core"}, path


def test_no_module_exceeds_400_lines() -> None:
    lengths = {path: path.read_text().count("\n") for path in modules()}
    assert not {path.name: n for path, n in lengths.items() if n > MAX_LINES}
