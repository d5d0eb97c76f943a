"""File of a session with its rigs, runs and models, from which it can be continued."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.text_files import read_text, write_text
from jbf.workbench.session import Session
from jbf.workbench.session_content import Content, Key, key_of_content, read_content

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
    write_text(path, _text(session))
    return path


def save_changes(session: Session) -> Path | None:
    """Write the session file if it would change, and return its path; None if it is not written.

    A session without models, trims and exclusions is not written.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    if session.bench is None:
        return None
    contents = [session.content(), *session.kept.values()]
    if not any(c[key] for c in contents for key in ("models", "trims", "excluded")):
        return None
    path = session.folder.path(FILE)
    if path.exists() and read_text(path) == _text(session):
        return None
    return save(session)


def _text(session: Session) -> str:
    content = {**file_content(session), "others": list(session.kept.values())}
    return json.dumps(content, indent=1)


def load(session: Session) -> bool:
    """Restore a session from the file in its folder; return False if there is no file.

    If its rig or one of its runs does not exist, no rig is open, and the session keeps the content.

    Raises
    ------
    InputError
        The file is broken, or has another format.
    """
    path = session.folder.path(FILE)
    content = _read(path)
    if content is None:
        return False
    kept = _kept(content, path)
    names = [content["rig"], *content["runs"]]
    lost = next((name for name in names if not session.folder.path(name).is_file()), None)
    if lost is None:
        restore(session, content, path)
    else:
        session.kept.update(kept)
        problem = f"{FILE}: {lost} does not exist; move it back, then open {names[0]}"
        session.say("error", f"{problem} (its models are kept)")
    return True


def keep(session: Session) -> None:
    """Keep the models of the file in the folder, including those of its open rig; open no rig.

    Raises
    ------
    InputError
        The file is broken, or has another format.
    """
    path = session.folder.path(FILE)
    content = _read(path)
    if content is not None:
        session.kept.update(_kept(content, path))


def _read(path: Path) -> Content | None:
    """Content of a session file; None if there is no file."""
    if not path.exists():
        return None
    try:
        content = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        remedy = "remove it"
        raise InputError(
            file=path, row=error.lineno, problem="is not valid JSON", remedy=remedy
        ) from None
    return checked(content, path)


def _kept(content: Content, path: Path) -> dict[Key, Content]:
    """Content of each rig of a session file, read from `path`, by the files of rig and runs."""
    opened = {key: value for key, value in content.items() if key not in ("format", "others")}
    try:
        contents = [opened, *content.get("others", ())]
        for one in contents:
            for key in ("models", "trims", "excluded"):
                len(one[key])
        return {key_of_content(one): one for one in contents}
    except (KeyError, TypeError) as error:
        problem = f"is not valid ({type(error).__name__}: {error})"
        raise InputError(file=path, problem=problem, remedy="remove it") from None


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
    kept = _kept(content, path)
    kept.pop(key_of_content(content))
    session.put(bench, models, law)
    session.kept.update(kept)
    session.show(models.current)
    session.say("done", f"the session of {path.name} was restored")
