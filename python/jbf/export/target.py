"""Export targets: what a target returns, and the result of an export."""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.export.compensator import Compensator
from jbf.export.ledger import Ledger, Term
from jbf.export.reference import Reference
from jbf.results import Result
from jbf.text_files import write_texts

STEM = "@STEM@"
"""Text in a file that stands for the name of the main file without its suffix."""
MAIN = ""
"""Key of the main file among the files of an export."""


Precision = Literal["double", "float"]


@dataclass(frozen=True)
class Settings:
    """Settings of the targets. A target refuses settings that it does not use.

    Attributes
    ----------
    points
        Largest number of points of a table, both directions together.
    joint
        Name of the joint in a simulator, and prefix of the names in code.
    mujoco
        Version of MuJoCo whose elements may be used.
    precision
        Floating-point type of C code and of an FMU.
    compensator
        Settings of the compensator in the C code; None for the friction model alone.
    """

    points: int = 20
    joint: str = "joint"
    mujoco: str = "4.0.0"
    precision: Precision = "double"
    compensator: Compensator | None = None

    def check_joint_is_identifier(self) -> None:
        """Raise an InputError if the name of the joint is not an identifier of C and Python."""
        if not re.fullmatch(r"[A-Za-z]\w*", self.joint, re.ASCII):
            raise InputError(
                problem=f'"{self.joint}" is not an identifier',
                remedy="give --joint a letter, then letters, digits and underscores",
            )


@dataclass(frozen=True)
class Written:
    """Files of a target, and the force of the exported form.

    Attributes
    ----------
    files
        Text, or bytes of an archive, of each file, by the suffix that replaces that of the main
        file; `MAIN` is the main file.
    terms
        How each term of the model is carried.
    force
        Force of the exported form along each run of the reference, shape (n,).
    evaluated_by
        The program that computed this force.
    notes
        Further properties of the export.
    """

    files: Mapping[str, str | bytes]
    terms: tuple[Term, ...]
    force: list[Array]
    evaluated_by: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """One target of `jbf export --to`.

    Attributes
    ----------
    name, summary
        Name, and a description in one line.
    suffix
        Suffix of the main file, such as `.csv`.
    write
        Function that writes the files of a reference.
    settings
        Names of the fields of `Settings` that the target uses.
    """

    name: str
    summary: str
    suffix: str
    write: Callable[[Reference, Settings], Written]
    settings: tuple[str, ...]


@dataclass(frozen=True, repr=False)
class Exported(Result):
    """Model in the form of a target, with its loss ledger.

    Attributes
    ----------
    target
        Name of the target.
    files
        Text, or bytes of an archive, of each file, by the suffix that replaces that of the main
        file; the key of the main file is empty.
    ledger
        How each term of the model is carried, and the error along the runs.
    """

    target: str
    files: Mapping[str, str | bytes] = field(repr=False)
    ledger: Ledger

    @property
    def text(self) -> str:
        """Text of the main file.

        Raises
        ------
        InputError
            The main file is an archive.
        """
        main = self.files[MAIN]
        if isinstance(main, bytes):
            raise InputError(
                problem=f"the export to {self.target} is an archive, not text",
                remedy="name a file with --out (save in Python)",
            )
        return main.replace(STEM, "model")

    def texts(self, path: str | os.PathLike[str]) -> dict[str, str | bytes]:
        """Content of each file by its path, if the main file has this path."""
        main = Path(path)
        contents: dict[str, str | bytes] = {}
        for suffix, content in self.files.items():
            target = main if suffix == MAIN else main.with_name(main.stem + suffix)
            if isinstance(content, str):
                content = content.replace(STEM, main.stem)
            contents[str(target)] = content
        return contents

    def save(self, path: str | os.PathLike[str]) -> list[str]:
        """Write all files next to each other, all or none, and return their paths.

        Parameters
        ----------
        path
            Path of the main file.

        Raises
        ------
        InputError
            A file cannot be written.
        """
        texts: dict[str | os.PathLike[str], str | bytes] = dict(self.texts(path).items())
        write_texts(texts)
        return [os.fspath(written) for written in texts]

    def to_dict(self) -> dict[str, Any]:
        """Return the target and the ledger as JSON-serialisable data."""
        return {"target": self.target, "ledger": self.ledger.to_dict()}


def xml_text(element: ET.Element) -> str:
    """Indented text of an XML element."""
    ET.indent(element)
    return ET.tostring(element, encoding="unicode") + "\n"
