"""Copy of the source tree, in which one file at a time is changed and tested."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from functools import cached_property
from pathlib import Path


class TreeCopy:
    """Copy of the files that git tracks or would add, in a separate directory."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.root, self.folder = root, folder
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=root, capture_output=True, check=True).stdout
        built = [p.relative_to(root) for p in (root / "python" / "jbf").glob("_core*.so")]
        for name in [*(Path(os.fsdecode(n)) for n in names.split(b"\0") if n), *built]:
            if (root / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / name, folder / name)

    @cached_property
    def environment(self) -> dict[str, str]:
        """Environment variables with which Python imports the copy and cargo builds separately."""
        parts = ("python", "simulator", "benches", "python/tests")
        return os.environ | {
            "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"])),
            "PYTHONPATH": os.pathsep.join(str(self.folder / part) for part in parts),
            # A file that changes twice within a second would keep the bytecode of its first
            # version.
            "PYTHONDONTWRITEBYTECODE": "1",
            "CARGO_TARGET_DIR": str(self.root / "target" / "mutation"),
        }
