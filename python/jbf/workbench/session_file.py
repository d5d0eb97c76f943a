"""File of a session with its rigs, runs and models, from which it can be continued."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.text_files import read_text, write_text
from jbf.workbench.session import Session
from jbf.workbench.session_content import Content, key_of_content, read_content

FILE = "workbench.json"
FORMAT = "jbf workbench 1"


def file_content(session: Session) -> Content:
    """Content of the session file without the other rigs.

    Raises
    ------
    InputError
        No rig is open.
    """
    return {"format": FORMAT, **session.content()}


def save(session: Session) -> Path:
    """Write the session file into the session's folder, and return its path.

    The file also contains the models of the rigs that were opened before.

    Raises
    ------
    InputError
        No rig is open, or the file cannot be written.
    """
    path = session.folder.path(FILE)
    content = {**file_content(session), "others": list(session.kept.values())}
    write_text(path, json.dumps(content, indent=1))
    return path


def load(session: Session) -> bool:
    """Restore a session from the file in its folder; return False if there is no file.

    Raises
    ------
    InputError
        The file is broken, has another format, or names files that no longer exist.
    """
    path = session.folder.path(FILE)
    if not path.exists():
        return False
    try:
        content = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        remedy = "remove it"
        raise InputError(
            file=path, row=error.lineno, problem="is not valid JSON", remedy=remedy
        ) from None
    restore(session, checked(content, path), path)
    return True


def checked(content: object, path: Path) -> dict[str, Any]:
    """Return the content of a session file; an InputError if it has another format."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(
            file=path, problem=f"does not have the format {FORMAT!r}", remedy="remove it"
        )
    return content


def restore(session: Session, content: Content, path: Path) -> None:
    """Open the rig, the runs and the models of a session file, read from `path`.

    The other rigs of the file are read when they are opened.

    Raises
    ------
    InputError
        The content is not complete, or names files that do not exist.
    """
    bench, models, law = read_content(session.folder, content, path)
    try:
        others = {key_of_content(other): other for other in content.get("others", ())}
    except (KeyError, TypeError) as error:
        problem = f"is not valid ({type(error).__name__}: {error})"
        raise InputError(file=path, problem=problem, remedy="remove it") from None
    session.put(bench, models, law)
    session.kept.update(others)
    session.show(models.current)
    session.say("done", f"the session of {path.name} was restored")
