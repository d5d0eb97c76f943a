"""Handlers of the page's requests: plain functions of a session and the request parameters."""

from __future__ import annotations

import filecmp
import shutil
from collections.abc import Callable
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any
from urllib.parse import quote

from starlette.responses import Response

from jbf.errors import InputError
from jbf.workbench import importer, kept, views
from jbf.workbench.session import Session

Asked = dict[str, Any]
DEMO_PLACES = ("hidden", "jbf-demo/hidden", "jbf-demo")
"""Folders that may contain the data of `jbf demo`, relative to the session's folder.

The first two are seen from the demo's folder and from its parent. The last is where the page
copies the data.
"""
MOST_PIXELS = 4000


def _model(asked: Asked) -> int | None:
    value = asked.get("model")
    return None if value in (None, "", "null") else int(value)


def _span(asked: Asked) -> tuple[float | None, float | None]:
    ends = [asked.get(key) for key in ("from_s", "to_s")]
    first, last = (None if v in (None, "") else float(v) for v in ends)
    return first, last


def _pixels(asked: Asked, key: str = "pixels", usual: int = 1000) -> int:
    return min(max(int(asked.get(key, usual)), 10), MOST_PIXELS)


def state(session: Session, asked: Asked) -> Any:
    """Return the complete state, except the plots."""
    return session.told()


def listing(session: Session, asked: Asked) -> Any:
    """List the folder."""
    return session.folder.listing()


def series(session: Session, asked: Asked) -> Any:
    """Return a section of a run."""
    span = _span(asked)
    return views.series(session, _model(asked), asked["run"], span, _pixels(asked))


def signature(session: Session, asked: Asked) -> Any:
    """Return the signature of an effect in a run."""
    number = _number(asked)
    span, pixels = _span(asked), _pixels(asked)
    return views.signature(session, number, asked["effect"], asked["run"], span, pixels)


def map_of_runs(session: Session, asked: Asked) -> Any:
    """Return the map of the residual over runs and speeds."""
    return views.map_of_runs(session, _number(asked))


def _number(asked: Asked) -> int:
    number = _model(asked)
    if number is None:
        raise InputError(problem="no model is chosen", mend="fit one")
    return number


def plane(session: Session, asked: Asked) -> Any:
    """Return the plane of friction against speed."""
    return views.plane(session, _model(asked), *_picture(asked))


def brush(session: Session, asked: Asked) -> Any:
    """Return a selection in all views."""
    return views.brushed(session, _model(asked), dict(asked["selection"]), *_picture(asked))


def _picture(asked: Asked) -> tuple[list[str], tuple[int, int]]:
    """Return the runs and the size in pixels of a plane."""
    size = (_pixels(asked, "columns", 400), _pixels(asked, "rows", 300))
    return [str(name) for name in asked["runs"]], size


def open_campaign(session: Session, asked: Asked) -> Any:
    """Open a rig and its runs."""
    session.open(str(asked["rig"]), [str(name) for name in asked["runs"]])
    return {}


def demo(session: Session, asked: Asked) -> Any:
    """Open the demo data; copy them into the folder if `jbf demo` has not written them there."""
    with as_file(files("jbf") / "data" / "demo" / "hidden") as shipped:
        there = [name for name in DEMO_PLACES if _holds(session.folder.root / name, shipped)]
        where = there[0] if there else DEMO_PLACES[-1]
        if not there:
            shutil.copytree(shipped, session.folder.root / where, dirs_exist_ok=True)
    runs = sorted(path.name for path in (session.folder.root / where).glob("*.csv"))
    session.open(f"{where}/rig.toml", [f"{where}/{name}" for name in runs])
    return {}


def _holds(folder: Path, shipped: Path) -> bool:
    """Return whether a folder contains the shipped rig and runs."""
    names = ["rig.toml", *(path.name for path in shipped.glob("*.csv"))]
    _, differ, missing = filecmp.cmpfiles(shipped, folder, names, shallow=False)
    return not differ and not missing


def look(session: Session, asked: Asked) -> Any:
    """Return the guessed assignment of a file's columns."""
    return importer.looked(session.folder, str(asked["file"]))


def try_map(session: Session, asked: Asked) -> Any:
    """Return the runs that a map yields from files."""
    form = asked.get("form")
    told = None if form is None else dict(form)
    return importer.tried(session.folder, _files(asked), str(asked["map"]), told)


def import_files(session: Session, asked: Asked) -> Any:
    """Import files as runs and open them."""
    into = str(asked["into"])
    found = importer.imported(session.folder, _files(asked), str(asked["map"]), into)
    session.open(found["rig"], found["files"])
    return found


def _files(asked: Asked) -> list[str]:
    return [str(name) for name in asked["files"]]


def trim(session: Session, asked: Asked) -> Any:
    """Restrict a run to an interval, or restore all of it."""
    first, last = _span(asked)
    span = None if first is None or last is None else (first, last)
    with session.lock:
        session.on_bench().trim(str(asked["run"]), span)
    session.changed()
    return {}


def leave_out(session: Session, asked: Asked) -> Any:
    """Exclude a run from fits, or include it again."""
    with session.lock:
        session.on_bench().leave_out(str(asked["run"]), bool(asked["out"]))
    session.changed()
    return {}


def law(session: Session, asked: Asked) -> Any:
    """Choose the base law."""
    session.choose_law(str(asked["law"]))
    return {}


def fit(session: Session, asked: Asked) -> Any:
    """Fit a law with effects, and test all other effects as candidates."""
    session.begin("round", [str(e) for e in asked.get("effects", [])], _parent(asked))
    return {}


def diagnose(session: Session, asked: Asked) -> Any:
    """Run the complete diagnosis."""
    session.begin("diagnose", (), _parent(asked))
    return {}


def _parent(asked: Asked) -> int | None:
    return None if asked.get("parent") is None else int(asked["parent"])


def cancel(session: Session, asked: Asked) -> Any:
    """Cancel the running fit."""
    return {"cancelled": session.jobs.cancel()}


def show(session: Session, asked: Asked) -> Any:
    """Select the model to display."""
    session.show(_model(asked))
    return {}


def beside(session: Session, asked: Asked) -> Any:
    """Select a second model to draw for comparison."""
    session.models.put_beside(_model(asked))
    session.changed()
    return {}


def undo(session: Session, asked: Asked) -> Any:
    """Return to the parent model."""
    parent = session.models.node()["parent"]
    session.show(parent)
    return {}


def keep(session: Session, asked: Asked) -> Any:
    """Write a file into the folder."""
    return kept.keep(session, str(asked["what"]))


def text(session: Session, asked: Asked) -> Any:
    """Return the content of such a file as a download."""
    name, content = kept.text_of(session, str(asked["what"]))
    said = f"attachment; filename*=UTF-8''{quote(name)}"
    # Never displayed as a page of this server: a report is opened from disk.
    return Response(content, headers={"content-disposition": said}, media_type="text/plain")


ASKED: dict[str, Callable[[Session, Asked], Any]] = {
    "state": state,
    "files": listing,
    "series": series,
    "signature": signature,
    "map": map_of_runs,
    "text": text,
}
"""Handlers of GET requests, which change nothing."""
DONE: dict[str, Callable[[Session, Asked], Any]] = {
    "plane": plane,
    "brush": brush,
    "open": open_campaign,
    "demo": demo,
    "look": look,
    "try": try_map,
    "import": import_files,
    "trim": trim,
    "leave_out": leave_out,
    "law": law,
    "fit": fit,
    "diagnose": diagnose,
    "cancel": cancel,
    "show": show,
    "beside": beside,
    "undo": undo,
    "keep": keep,
}
"""Handlers of POST requests, which may change the session."""
