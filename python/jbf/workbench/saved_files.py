"""Files that are saved from a session: model, report, firmware source, next run, trimmed runs."""

from __future__ import annotations

from collections.abc import Callable

from jbf.comparison.compare import compare
from jbf.errors import InputError
from jbf.export import c, rust
from jbf.reporting.comparison_page import comparison_page
from jbf.text_files import write_texts
from jbf.workbench.equivalent_commands import TRIMMED
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE, save


def model_text(session: Session) -> str:
    """Text of the model file of the displayed model."""
    return str(session.models.node()["model"])


def report_text(session: Session) -> str:
    """HTML report: of the diagnosis, or of the comparison of the fit with the runs."""
    node = session.models.node()
    if "report" in node:
        return str(node["report"])
    model = session.model(int(node["id"]))
    return comparison_page(compare(model, session.on_bench().used_runs()))


def rust_text(session: Session) -> str:
    """Rust source of the displayed model for a controller."""
    return rust(session.model(int(session.models.node()["id"])), "model.toml")


def c_text(session: Session) -> str:
    """C header of the displayed model for a controller."""
    return c(session.model(int(session.models.node()["id"])), "model.toml")


def next_run_text(session: Session) -> str:
    """Motion of the proposed next run as CSV."""
    diagnosis = session.models.node().get("diagnosis") or {}
    if not diagnosis.get("next_run"):
        raise InputError(
            problem="no next run was proposed",
            remedy="run a diagnosis; it proposes a run if effects are tied",
        )
    return str(diagnosis["next_run"])


TEXTS: dict[str, tuple[str, Callable[[Session], str]]] = {
    "model": ("model.toml", model_text),
    "report": ("report.html", report_text),
    "rust": ("model.rs", rust_text),
    "c": ("model.h", c_text),
    "next_run": ("next_run.csv", next_run_text),
}
"""File name, and function that returns the text, of each kind of file."""


def text_of(session: Session, kind: str) -> tuple[str, str]:
    """File name and text of one kind of saved file.

    Raises
    ------
    InputError
        The kind is unknown, or not available for this model.
    """
    if kind not in TEXTS:
        raise InputError(
            problem=f"{kind!r} is not known", remedy=f"choose one of {', '.join(TEXTS)}"
        )
    name, text = TEXTS[kind]
    return name, text(session)


def save_as_file(session: Session, kind: str) -> dict[str, list[str]]:
    """Write one kind of file into the folder; return the names of written and replaced files."""
    if kind == "session":
        name = FILE
        before = session.folder.path(name).exists()
        save(session)
        return {"written": [name], "replaced": [name] * before}
    if kind == "trimmed":
        session.folder.path(TRIMMED).mkdir(exist_ok=True)
        runs = session.on_bench().used_runs()
        texts = {f"{TRIMMED}/{run.name.replace('/', '-')}.csv": run.to_csv() for run in runs}
    else:
        name, text = text_of(session, kind)
        texts = {name: text}
    # If a name is a link that leads outside, nothing is written.
    paths = {name: session.folder.path(name) for name in texts}
    replaced = [name for name, path in paths.items() if path.exists()]
    write_texts({paths[name]: text for name, text in texts.items()})
    return {"written": list(texts), "replaced": replaced}
