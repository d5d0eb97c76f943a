"""What a fit's own process does: one order, messages on the way, one answer.

An answer is plain numbers and words; what is as long as a record goes to files.
"""

from __future__ import annotations

import _thread
import math
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Literal

import numpy as np

from jbf.comparison.axes import BOUNDARY_SHARE
from jbf.comparison.comparison import Comparison, compare
from jbf.diagnosis import Diagnosis, Step, diagnose
from jbf.diagnosis.one_round import one_round
from jbf.errors import JbfError, Stopped
from jbf.estimation.fit import Fit
from jbf.models.catalogue import transition_speed
from jbf.models.model import Model
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.words import verdict_sentence
from jbf.workbench.marks import failure_marks

Kind = Literal["round", "diagnose", "compare"]
Answer = dict[str, Any]
STOP = "stop"
"""What the server sends to a process whose fit is to end."""


@dataclass(frozen=True)
class Order:
    """What is to be done.

    Attributes
    ----------
    kind
        `round`: fit these effects and try every other; `diagnose`: all rounds; `compare`: a model
        as it is.
    folder
        Where the records as the model saw them go, one file a run.
    model
        Path of the model file that is compared.
    """

    kind: Kind
    rig: Rig
    runs: tuple[Run, ...]
    folder: Path
    law: str = "journal"
    clock: Clock = "journal"
    effects: tuple[str, ...] = ()
    model: Path | None = None


def main(connection: Connection, order: Order) -> None:
    """The process: sends `("progress", message, done, total)` and, last, `("done", answer)`,
    `("error", words)` or, when `STOP` came, `("stopped", answer)` of the best so far, if any."""

    def progress(message: str, done: int, total: int) -> None:
        connection.send(("progress", message, done, total))

    try:
        with _interrupted_by(connection):
            last: tuple[str, Answer | str] = ("done", carried_out(order, progress))
    except Stopped as stop:
        last = ("stopped", best_so_far(stop.fit, order))
    except KeyboardInterrupt:
        last = ("stopped", {})
    except JbfError as error:
        last = ("error", str(error))
    except MemoryError:
        last = ("error", "not enough memory: take fewer runs, or shorter ones")
    connection.send(last)
    connection.close()


@contextmanager
def _interrupted_by(connection: Connection) -> Iterator[None]:
    """Raises `KeyboardInterrupt`, once, when `STOP` is received; a Ctrl-C in the terminal is the
    server's, which stops what it started."""
    asked = threading.Event()

    def interrupt(*_: object) -> None:
        if asked.is_set():
            asked.clear()
            raise KeyboardInterrupt

    def listen() -> None:
        try:
            if connection.recv() == STOP:
                asked.set()
                _thread.interrupt_main()
        except (EOFError, OSError):  # the server has gone, or all is done
            pass

    signal.signal(signal.SIGINT, interrupt)
    threading.Thread(target=listen, daemon=True).start()
    try:
        yield
    finally:
        asked.clear()


def best_so_far(fit: Fit, order: Order) -> Answer:
    """What a stopped fit had come to."""
    compared = compare(fit.model, order.runs)
    return {**_of_model(compared), **_of_fit(fit), **_kept(compared, order.folder)}


def carried_out(order: Order, progress: Any = None) -> Answer:
    """The answer to an order."""
    if order.kind == "compare":
        assert order.model is not None
        compared = compare(Model.load(order.model), order.runs)
        return {**_of_model(compared), **_kept(compared, order.folder)}
    if order.kind == "round":
        found = one_round(
            order.rig,
            order.runs,
            order.effects,
            law=order.law,
            clock=order.clock,
            progress=progress,
        )
        return {
            **_of_model(found.comparison),
            **_of_fit(found.fit),
            **_of_step(found.step),
            **_kept(found.comparison, order.folder),
        }
    diagnosis = diagnose(order.rig, order.runs, law=order.law, clock=order.clock, progress=progress)
    return {
        **_of_model(diagnosis.after),
        **_of_fit(diagnosis.fit),
        **_of_step(diagnosis.steps[-1]),
        **_kept(diagnosis.after, order.folder),
        "diagnosis": _of_diagnosis(diagnosis),
        "report": diagnosis_page(diagnosis),
    }


def _of_model(comparison: Comparison) -> Answer:
    model = comparison.model
    return {
        "law": model.law,
        "effects": list(model.effects),
        "model": model.to_toml(),
        "rms_n": comparison.rms_n,
        "noise_n": comparison.noise_n,
        "runs": [{"name": r.name, "rms_n": r.rms_n} for r in comparison.runs],
        "failures": failure_marks(comparison),
        "findings": [f.to_dict() for f in comparison.findings],
        "parameters": model.told_parameters(dict(model.parameters)),
        "trials": [],
        "curve": _steady_curve(comparison),
    }


def _steady_curve(comparison: Comparison) -> Answer | None:
    """The law at steady speeds, over those of the runs; None of a law that has none."""
    model = comparison.model
    motions = [p.motion.velocity_m_s for p in comparison.campaign.prepared]
    most = max(float(np.nanmax(np.abs(v))) for v in motions)
    speeds = most * np.geomspace(1e-4, 1.0, 120)
    try:
        force = model.steady_friction(speeds)
    except JbfError:
        return None
    u_tr = transition_speed(model.law, model.values.tolist())
    regimes = [] if u_tr is None else [(BOUNDARY_SHARE * u_tr, "mixed"), (u_tr, "full film")]
    return {
        "velocity_m_s": speeds.tolist(),
        "friction_n": np.asarray(force).tolist(),
        "regimes_m_s": regimes,
    }


def _of_fit(fit: Fit) -> Answer:
    told = [name for name, p in fit.parameters.items() if not p.held]
    return {
        "parameters": fit.model.told_parameters(fit.parameters),
        "correlations": {"names": told, "matrix": np.round(fit.correlations, 3).tolist()},
        "doubtful": list(fit.doubtful),
        "converged": fit.converged,
    }


def _of_step(step: Step) -> Answer:
    return {
        "holdout_rms_n": step.holdout_rms_n if math.isfinite(step.holdout_rms_n) else None,
        "trials": [t.to_dict() for t in step.trials],
    }


def _of_diagnosis(diagnosis: Diagnosis) -> Answer:
    told = diagnosis.to_dict()
    next_run = diagnosis.experiment
    return {
        "sentence": verdict_sentence(diagnosis, ""),
        "summary": diagnosis.summary(),
        "next_run": None if next_run is None else next_run.run.to_csv(),
        **{
            key: told[key]
            for key in ("verdict", "effects", "alternatives", "weights", "steps", "unexplained",
                        "next_experiment", "power", "not_tried", "elapsed_s")
        },
    }  # fmt: skip


def _kept(comparison: Comparison, folder: Path) -> Answer:
    """Writes time, speed, friction, prediction and which samples count, a file a run."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = zip(
        comparison.campaign.prepared,
        comparison.predictions,
        comparison.samples.counted,
        strict=True,
    )
    for number, (p, predicted, counted) in enumerate(rows):
        np.save(
            folder / f"{number}.npy",
            np.vstack([p.run.time_s, p.motion.velocity_m_s, p.friction_n, predicted, counted]),
        )
    return {"record_names": [p.run.name for p in comparison.campaign.prepared]}
