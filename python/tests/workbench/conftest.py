"""A folder with a small campaign, a session on it, and an authorised client."""

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from conftest import make_runs
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from starlette.testclient import TestClient
from workbench_parts import client_of


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a rig and three runs with a Coulomb drag that the base law lacks."""
    folder = tmp_path_factory.mktemp("bench")
    rig = files("jbf") / "data" / "demo" / "plain" / "rig.toml"
    (folder / "rig.toml").write_text(rig.read_text())
    for run in make_runs({"coulomb_drag": {"F_d": 2.0}}):
        (folder / f"{run.name}.csv").write_text(run.to_csv())
    return folder


@pytest.fixture
def inside_folder(campaign: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(campaign)


@pytest.fixture
def session(campaign: Path) -> Iterator[Session]:
    """A session for the folder without a loaded campaign."""
    session = Session(Folder.of(campaign))
    yield session
    session.close()


@pytest.fixture
def loaded(session: Session, campaign: Path) -> Session:
    session.open("rig.toml", sorted(path.name for path in campaign.glob("*.csv")))
    return session


@pytest.fixture
def client(session: Session) -> TestClient:
    """A client with the correct host and token."""
    return client_of(session)
