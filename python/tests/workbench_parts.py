"""A client of the workbench, shared by its tests."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from jbf.workbench.app import create_app
from jbf.workbench.session import Session
from starlette.testclient import TestClient

Array = npt.NDArray[np.float64]
TOKEN, PORT = "a-token", 8123


def client_of(session: Session, **more: Any) -> TestClient:
    """A client with the correct host and token."""
    app = create_app(session, TOKEN, PORT, **more)
    headers = {"X-JBF-Token": TOKEN}
    return TestClient(app, base_url=f"http://127.0.0.1:{PORT}", headers=headers)


def slide_log(time_s: Array, position_m: Array, force_n: Array) -> str:
    """A log of a slide in ms, mm and N, with semicolons and decimal commas."""
    rows = np.column_stack([1000.0 * time_s, 1000.0 * position_m, force_n])
    lines = [";".join(f"{value:.4f}".replace(".", ",") for value in row) for row in rows]
    return "\n".join(["Time [ms];Position [mm];Force [N]", *lines, ""])


def wait_until(condition: Callable[[], object]) -> None:
    """Wait until a condition of a running job holds, for at most 300 s."""
    limit = time.monotonic() + 300.0
    while not condition():
        assert time.monotonic() < limit, "the job did not end"
        time.sleep(0.005)


def wait_until_idle(session: Session) -> None:
    wait_until(lambda: session.jobs.job is None)
