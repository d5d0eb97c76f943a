"""A folder with a small campaign, sessions with and without fits, and an authorised client."""

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from conftest import make_runs
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE
from starlette.testclient import TestClient
from workbench_parts import client_of, wait_until_idle


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


@pytest.fixture(scope="module")
def fitted_once(campaign: Path) -> Session:
    """A session with a fit of the base law and a fit with the missing effect."""
    session = Session(Folder.of(campaign))
    session.open("rig.toml", sorted(p.name for p in campaign.glob("*.csv")))
    for effects, parent in (((), None), (("coulomb_drag",), 1)):
        session.begin("round", effects, parent)
        wait_until_idle(session)
    return session


@pytest.fixture
def fitted(fitted_once: Session) -> Iterator[Session]:
    """The session with both fits; its state is restored after the test."""
    yield fitted_once
    fitted_once.on_bench().trim("stopgo", None)
    fitted_once.on_bench().leave_out("sine_w2.0", False)
    fitted_once.show(2)
    for name in ("model.toml", "report.html", FILE):
        (fitted_once.folder.root / name).unlink(missing_ok=True)


@pytest.fixture
def client(session: Session) -> TestClient:
    """A client with the correct host and token."""
    return client_of(session)
