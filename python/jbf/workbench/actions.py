"""Handlers of the page's requests: functions of a session and the request parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from urllib.parse import quote

from starlette.responses import Response

from jbf.errors import InputError
from jbf.workbench import channels as any_channel
from jbf.workbench import (
    choices,
    effect_views,
    importer,
    samples,
    saved_files,
    session_bundle,
    session_content,
    views,
)
from jbf.workbench.session import Session
from jbf.workbench.work import Settings

Parameters = dict[str, Any]
MOST_PIXELS = 4000


def _model(parameters: Parameters) -> int | None:
    """Number of the model that a request names; None if it names none."""
    value = parameters.get("model")
    return None if value in (None, "", "null") else int(value)


def _span(parameters: Parameters) -> tuple[float | None, float | None]:
    """Interval of a request, s; None for an open end."""
    ends = [parameters.get(key) for key in ("from_s", "to_s")]
    first, last = (None if v in (None, "") else float(v) for v in ends)
    return first, last


def _pixels(parameters: Parameters, key: str = "pixels", default: int = 1000) -> int:
    """Number of pixels that a request specifies, limited to the permitted range."""
    return min(max(int(parameters.get(key, default)), 10), MOST_PIXELS)


def state(session: Session, parameters: Parameters) -> Any:
    """State of the session for the page: rig, runs, models and running job, without plots."""
    return session.to_dict()


def listing(session: Session, parameters: Parameters) -> Any:
    """Files of the session's folder by kind, kept models of each rig, and the samples."""
    found = session.folder.listing()
    campaigns = {session_content.key_of(**c): {**c, "models": 0} for c in found["campaigns"]}
    kept = {session_content.key_of_content(c): c for c in session.kept_campaigns()}
    return {
        **found,
        "campaigns": list((campaigns | kept).values()),
        "samples": samples.listing(),
    }


def series(session: Session, parameters: Parameters) -> Any:
    """Time series of a section of a run, for a plot."""
    span = _span(parameters)
    return views.series(session, _model(parameters), parameters["run"], span, _pixels(parameters))


def signature(session: Session, parameters: Parameters) -> Any:
    """Contribution of an effect to the friction of a run, for a plot."""
    number = _number(parameters)
    span, pixels = _span(parameters), _pixels(parameters)
    return effect_views.signature(
        session, number, parameters["effect"], parameters["run"], span, pixels
    )


def map_of_runs(session: Session, parameters: Parameters) -> Any:
    """Mean residual of each run by speed range, for a map."""
    return views.map_of_runs(session, _number(parameters))


def effect(session: Session, parameters: Parameters) -> Any:
    """Catalogue entry of an effect as text."""
    return {"text": choices.effect_text(str(parameters["name"]))}


def _number(parameters: Parameters) -> int:
    """Number of the model that a request requires."""
    number = _model(parameters)
    if number is None:
        raise InputError(problem="no model is selected", remedy="fit or select one")
    return number


def plane(session: Session, parameters: Parameters) -> Any:
    """Density of the samples of runs in the friction-speed plane, for a plot."""
    return views.plane(session, _model(parameters), *_picture(parameters))


def brush(session: Session, parameters: Parameters) -> Any:
    """Statistics and positions of the selected samples, for all views."""
    return views.brushed(
        session, _model(parameters), dict(parameters["selection"]), *_picture(parameters)
    )


def _picture(parameters: Parameters) -> tuple[list[str], tuple[int, int], str]:
    """Names of the runs, size in pixels and horizontal axis of a requested plane."""
    size = (_pixels(parameters, "columns", 400), _pixels(parameters, "rows", 300))
    axis = "position" if parameters.get("axis") == "position" else "speed"
    return [str(name) for name in parameters["runs"]], size, axis


def channels(session: Session, parameters: Parameters) -> Any:
    """Names and units of the channels of a run."""
    return any_channel.channels(session, _model(parameters), str(parameters["run"]))


def channel(session: Session, parameters: Parameters) -> Any:
    """Curve of a channel of a run, its derivative or its spectrum."""
    return any_channel.channel(
        session,
        _model(parameters),
        str(parameters["run"]),
        str(parameters["channel"]),
        str(parameters.get("transform", "value")),
        _span(parameters),
        _pixels(parameters),
    )


def open_campaign(session: Session, parameters: Parameters) -> Any:
    """Open a rig and its runs in the session."""
    session.open(str(parameters["rig"]), [str(name) for name in parameters["runs"]])
    return {}


def sample(session: Session, parameters: Parameters) -> Any:
    """Open a simulated sample in the session."""
    samples.open_sample(session, str(parameters["name"]))
    return {}


def open_session(session: Session, parameters: Parameters) -> Any:
    """Continue a session that was saved as one file."""
    session_bundle.open_bundle(session, str(parameters["file"]))
    return {}


def look(session: Session, parameters: Parameters) -> Any:
    """Proposed map for a file: the assignment of its columns."""
    joint = parameters.get("joint")
    chosen = None if joint is None else str(joint)
    return importer.guess_map(session.folder, str(parameters["file"]), chosen)


def try_map(session: Session, parameters: Parameters) -> Any:
    """Runs that a map yields from files, without an import."""
    form = parameters.get("form")
    answers = None if form is None else dict(form)
    names, text = _files(parameters), str(parameters["map"])
    with session.readings.begin(f"reading {', '.join(names[:3])}") as reading:
        return importer.try_map(
            session.folder, names, text, answers, cache=session.sources, reading=reading
        )


def import_files(session: Session, parameters: Parameters) -> Any:
    """Import files as runs, and open these in the session; start a diagnosis if requested."""
    into, names = str(parameters["into"]), _files(parameters)
    with session.readings.begin(f"importing {', '.join(names[:3])}") as reading:
        imported = importer.import_runs(
            session.folder, names, str(parameters["map"]), into, cache=session.sources,
            reading=reading,
        )  # fmt: skip
    session.open(imported["rig"], imported["files"])
    if parameters.get("diagnose"):
        session.begin("diagnose", (), None)
    return imported


def _files(parameters: Parameters) -> list[str]:
    return [str(name) for name in parameters["files"]]


def trim(session: Session, parameters: Parameters) -> Any:
    """Restrict a run to an interval, or restore the complete run."""
    first, last = _span(parameters)
    span = None if first is None or last is None else (first, last)
    with session.lock:
        session.on_bench().trim(str(parameters["run"]), span)
    session.changed()
    return {}


def leave_out(session: Session, parameters: Parameters) -> Any:
    """Exclude a run from fits, or include it again."""
    with session.lock:
        session.on_bench().leave_out(str(parameters["run"]), bool(parameters["out"]))
    session.changed()
    return {}


def law(session: Session, parameters: Parameters) -> Any:
    """Choose the base law of new models."""
    session.choose_law(str(parameters["law"]))
    return {}


def fit(session: Session, parameters: Parameters) -> Any:
    """Start a fit of a law with effects, followed by tests of all other effects."""
    session.begin("round", [str(e) for e in parameters.get("effects", [])], _parent(parameters))
    return {}


def refit(session: Session, parameters: Parameters) -> Any:
    """Start a fit of a model's law and effects with starting values, fixed values and bounds."""
    number = _number(parameters)
    settings = Settings.of(dict(parameters["settings"]))
    session.begin("fit", session.models.node(number)["effects"], number, settings)
    return {}


def edited(session: Session, parameters: Parameters) -> Any:
    """Prediction for a run with changed parameter values, for a plot."""
    values = {str(name): float(value) for name, value in dict(parameters["values"]).items()}
    return effect_views.edited(
        session, _number(parameters), values, str(parameters["run"]), _span(parameters),
        _pixels(parameters),
    )  # fmt: skip


def label(session: Session, parameters: Parameters) -> Any:
    """Set the name and the note of a model."""
    session.models.label(
        _number(parameters), str(parameters["name"])[:80], str(parameters["note"])[:2000]
    )
    session.changed()
    return {}


def diagnose(session: Session, parameters: Parameters) -> Any:
    """Start a complete diagnosis."""
    session.begin("diagnose", (), _parent(parameters))
    return {}


def _parent(parameters: Parameters) -> int | None:
    return None if parameters.get("parent") is None else int(parameters["parent"])


def cancel(session: Session, parameters: Parameters) -> Any:
    """Cancel the running reading or job."""
    return {"cancelled": session.cancel()}


def show(session: Session, parameters: Parameters) -> Any:
    """Select the model to display."""
    session.show(_model(parameters))
    return {}


def compare_with(session: Session, parameters: Parameters) -> Any:
    """Draw a further model for comparison, or no longer."""
    session.models.compare_with(_number(parameters), bool(parameters["on"]))
    session.changed()
    return {}


def undo(session: Session, parameters: Parameters) -> Any:
    """Display the parent of the current model."""
    session.undo()
    return {}


def redo(session: Session, parameters: Parameters) -> Any:
    """Display the model that was undone last."""
    session.redo()
    return {}


def keep(session: Session, parameters: Parameters) -> Any:
    """Write a result of the displayed model (model file, report and so on) into the folder."""
    return saved_files.save_as_file(session, str(parameters["what"]))


def text(session: Session, parameters: Parameters) -> Any:
    """Content of a file that `keep` would write, or the session as one file, for a download."""
    name: str
    content: str | bytes
    if parameters["what"] == "bundle":
        name, content = "session.zip", session_bundle.bundle(session)
    else:
        name, content = saved_files.text_of(session, str(parameters["what"]))
    disposition = f"attachment; filename*=UTF-8''{quote(name)}"
    # Never displayed as a page of this server: a report is opened from disk.
    return Response(content, headers={"content-disposition": disposition}, media_type="text/plain")


QUERIES: dict[str, Callable[[Session, Parameters], Any]] = {
    "state": state,
    "files": listing,
    "series": series,
    "signature": signature,
    "map": map_of_runs,
    "text": text,
    "effect": effect,
    "channels": channels,
    "channel": channel,
}
"""Handlers of GET requests by path; these change nothing."""
COMMANDS: dict[str, Callable[[Session, Parameters], Any]] = {
    "plane": plane,
    "brush": brush,
    "open": open_campaign,
    "sample": sample,
    "open_session": open_session,
    "look": look,
    "try": try_map,
    "import": import_files,
    "trim": trim,
    "leave_out": leave_out,
    "law": law,
    "fit": fit,
    "refit": refit,
    "edited": edited,
    "label": label,
    "diagnose": diagnose,
    "cancel": cancel,
    "show": show,
    "compare_with": compare_with,
    "undo": undo,
    "redo": redo,
    "keep": keep,
}
"""Handlers of POST requests by path; these may change the session."""
