"""A client of the workbench, shared by its tests."""

from __future__ import annotations

from typing import Any

from jbf.workbench.app import create_app
from jbf.workbench.session import Session
from starlette.testclient import TestClient

TOKEN, PORT = "a-token", 8123


def client_of(session: Session, **more: Any) -> TestClient:
    """A client with the correct host and token."""
    app = create_app(session, TOKEN, PORT, **more)
    headers = {"X-JBF-Token": TOKEN}
    return TestClient(app, base_url=f"http://127.0.0.1:{PORT}", headers=headers)
