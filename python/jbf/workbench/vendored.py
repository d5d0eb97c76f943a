"""Plot library uPlot, fetched once by version and hash since the repository lacks it.

`python -m jbf.workbench.vendored` stores it next to this file; wheels include it.
"""

from __future__ import annotations

import base64
import hashlib
import io
import os
import sys
import tarfile
import urllib.request
from pathlib import Path

NAME, VERSION = "uPlot", "1.6.32"
ADDRESS = f"https://registry.npmjs.org/uplot/-/uplot-{VERSION}.tgz"
SHA512 = "KIMVnG68zvu5XXUbC4LQEPnhwOxBuLyW1AHtpm6IKTXImkbLgkMy+jabjLgSLMasNuGGzQm/ep3tOkyTxpiQIw=="
"""SHA-512 hash of the archive, as stated by the registry for this version."""
FILES = {
    "package/dist/uPlot.iife.min.js": "uPlot.iife.min.js",
    "package/dist/uPlot.min.css": "uPlot.min.css",
    "package/LICENSE": "uPlot.LICENSE",
}
FOLDER = Path(__file__).resolve().parent / "vendored_files"


def file(name: str) -> Path | None:
    """Path of a file of the plot library; None if it is unknown or was not fetched.

    `name` is the name of the file.
    """
    path = FOLDER / name
    return path if name in FILES.values() and path.is_file() else None


def is_complete() -> bool:
    """Whether all files of the plot library were fetched."""
    return all(file(name) for name in FILES.values())


def unpacked(archive: bytes) -> dict[str, bytes]:
    """Required files of the library's archive, after a check of its hash.

    Raises
    ------
    ValueError
        The archive is not the one that was reviewed.
    """
    digest = base64.b64encode(hashlib.sha512(archive).digest()).decode("ascii")
    if digest != SHA512:
        raise ValueError(f"{NAME} {VERSION} has the hash {digest}, not {SHA512}")
    with tarfile.open(fileobj=io.BytesIO(archive), mode="r:gz") as tar:
        contents = {}
        for member, name in FILES.items():
            part = tar.extractfile(member)
            assert part is not None, member
            contents[name] = part.read()
        return contents


def fetch() -> None:
    """Fetch the archive of the plot library, check it, and store the required files."""
    with urllib.request.urlopen(ADDRESS, timeout=60) as answer:
        contents = unpacked(answer.read())
    FOLDER.mkdir(exist_ok=True)
    for name, content in contents.items():
        part = FOLDER / f".{name}.part"
        part.write_bytes(content)
        os.replace(part, FOLDER / name)


if __name__ == "__main__":
    if not is_complete():
        fetch()
    sys.stdout.write(f"{NAME} {VERSION} is in {FOLDER}\n")
