"""Test that the source archive and the wheel are identical if they are built in another folder.

`python release/reproducible.py dist` builds the source archive and the wheel again, in folders with
names of other lengths, and compares them with those in `dist`, byte by byte.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
import zipfile
from pathlib import Path

from build import build, pack
from steps import say


def sha256(path: Path) -> str:
    """Return the SHA-256 checksum of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def differing(first: Path, second: Path) -> list[str]:
    """Return the names of the files whose content, date or permissions differ in two wheels."""
    with zipfile.ZipFile(first) as one, zipfile.ZipFile(second) as other:
        members = [
            {i.filename: (a.read(i), i.date_time, i.external_attr) for i in a.infolist()}
            for a in (one, other)
        ]
    names = members[0].keys() | members[1].keys()
    return sorted(n for n in names if members[0].get(n) != members[1].get(n))


def main() -> None:
    """Build again and compare for the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dist", type=Path)
    parser.add_argument("extra", nargs="*", help="for maturin, as for the wheel in DIST (after --)")
    chosen = parser.parse_args()
    (archive,) = chosen.dist.glob("*.tar.gz")
    (wheel,) = chosen.dist.glob("*.whl")
    with tempfile.TemporaryDirectory(prefix="jbf-once-more-in-a-folder-of-another-name-") as name:
        again = pack(Path(name))
        if sha256(again) != sha256(archive):
            sys.exit(f"{archive.name} is another one when it is packed again")
        say(f"{archive.name} {sha256(archive)}, twice")
        once_more = build(again, Path(name), ["--release", *chosen.extra])
        if names := differing(wheel, once_more):
            sys.exit(f"{wheel.name}: built again, these differ: {', '.join(names)}")
        if sha256(once_more) != sha256(wheel):
            sys.exit(f"{wheel.name}: built again, the archive differs, its files do not")
        say(f"{wheel.name} {sha256(wheel)}, twice")


if __name__ == "__main__":
    main()
