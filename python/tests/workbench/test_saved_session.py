"""Sessions that are saved, and loaded again in the same or in another folder."""

from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.errors import InputError
from jbf.workbench import session_bundle
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE, load, save, save_changes
from workbench_parts import client_of, wait_until_idle


def test_loaded_session_has_saved_models_trims_and_exclusions(fitted: Session) -> None:
    fitted.on_bench().trim("stopgo", (1.0, 20.0))
    fitted.on_bench().leave_out("sine_w2.0", True)
    save(fitted)
    again = Session(fitted.folder)
    assert load(again)
    wait_until_idle(again)
    assert again.models.ledger() == fitted.models.ledger()
    assert again.on_bench().trims == {"stopgo": (1.0, 20.0)}
    assert again.on_bench().excluded == {"sine_w2.0"}
    # The records are recomputed from the runs that are still included.
    records = again.records(2)
    assert records is not None
    assert set(records) == {"sine_w0.5", "stopgo"}
    again.close()


def test_models_of_a_rig_return_when_it_is_opened_again(fitted: Session) -> None:
    names = list(fitted.on_bench().run_names)
    fitted.on_bench().trim("stopgo", (1.0, 20.0))
    before = fitted.models.ledger()
    fitted.open("rig.toml", names[:1])
    assert fitted.models.nodes == {}
    listed = client_of(fitted).get("/api/files").json()["campaigns"]
    assert [c["models"] for c in listed if len(c["runs"]) == len(names)] == [2]
    # A session that is saved now contains both rigs.
    save(fitted)
    again = Session(fitted.folder)
    load(again)
    for session in (fitted, again):
        session.open("rig.toml", names[::-1])
        wait_until_idle(session)
        assert session.models.ledger() == before
        assert session.on_bench().trims == {"stopgo": (1.0, 20.0)}
        assert session.records(2) is not None
    again.close()


def test_models_are_saved_only_if_the_file_lacks_them(fitted: Session) -> None:
    assert save_changes(fitted) == fitted.folder.root / FILE
    assert save_changes(fitted) is None
    again = Session(fitted.folder)
    load(again)
    wait_until_idle(again)
    assert again.models.ledger() == fitted.models.ledger()
    assert save_changes(again) is None
    again.close()


def test_session_whose_run_was_removed_keeps_its_models(fitted: Session) -> None:
    save(fitted)
    run = fitted.folder.root / fitted.on_bench().run_names[0]
    run.rename(run.with_suffix(".removed"))
    again = Session(fitted.folder)
    try:
        assert load(again)
        assert again.bench is None
        assert again.message["kind"] == "error"
        assert save_changes(again) is None
    finally:
        run.with_suffix(".removed").rename(run)
    again.open("rig.toml", fitted.on_bench().run_names)
    wait_until_idle(again)
    assert again.models.ledger() == fitted.models.ledger()
    again.close()


def test_rig_that_is_opened_twice_keeps_its_models(fitted: Session) -> None:
    before = fitted.models.ledger()
    fitted.open("rig.toml", list(fitted.on_bench().run_names))
    wait_until_idle(fitted)
    assert fitted.models.ledger() == before
    assert not any(kept["models"] for kept in fitted.kept_campaigns())


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("{", "is not valid JSON"),
        ("[]", "does not have the format"),
        ('{"format": "jbf workbench 9"}', "does not have the format"),
        ('{"format": "jbf workbench 1"}', "is not valid"),
        ('{"format": "jbf workbench 1", "rig": "gone.toml", "runs": ["a.csv"]}', "is not valid"),
        (
            '{"format": "jbf workbench 1", "rig": "../rig.toml", "runs": [], "models": [], '
            '"trims": {}, "excluded": []}',
            "not a name",
        ),
    ],
)
def test_broken_session_file_is_refused_in_one_line(session: Session, text: str, key: str) -> None:
    path = session.folder.root / FILE
    path.write_text(text)
    with pytest.raises(InputError, match=key) as caught:
        load(session)
    assert "\n" not in str(caught.value)
    path.unlink()


def test_session_as_one_file_continues_in_another_folder(fitted: Session, tmp_path: Path) -> None:
    fitted.on_bench().trim("stopgo", (1.0, 20.0))
    fitted.models.label(2, "with drag", "the seal")
    archive = session_bundle.bundle(fitted)
    (tmp_path / "saved.zip").write_bytes(archive)
    session = Session(Folder.of(tmp_path))
    answer = client_of(session).post("/api/open_session", json={"file": "saved.zip"})
    assert answer.status_code == 200
    wait_until_idle(session)
    assert session.models.ledger() == fitted.models.ledger()
    assert session.models.node(2)["note"] == "the seal"
    assert session.on_bench().trims == {"stopgo": (1.0, 20.0)}
    assert (tmp_path / "saved" / "stopgo.csv").is_file()
    session.close()
    fitted.models.label(2, "", "")


def test_session_with_equally_named_runs_of_two_folders_continues(
    fitted: Session, tmp_path: Path
) -> None:
    """The names of these runs contain their folders, which the archive does not have."""
    text = (fitted.folder.root / "stopgo.csv").read_text()
    before, after = tmp_path / "before", tmp_path / "after"
    after.mkdir()
    for name in ("monday", "friday"):
        (before / name).mkdir(parents=True)
        (before / name / "run_1.csv").write_text(text)
        text = text.replace("0.0", "0.00")
    (before / "rig.toml").write_text((fitted.folder.root / "rig.toml").read_text())
    session = Session(Folder.of(before))
    session.open("rig.toml", ["monday/run_1.csv", "friday/run_1.csv"])
    session.on_bench().trim("monday/run_1", (1.0, 20.0))
    session.on_bench().leave_out("friday/run_1", True)
    node = fitted.models.node(1)
    session.models.add(None, "saved", {**node, "runs": [{"name": "friday/run_1", "rms": 2.0}]})
    (after / "saved.zip").write_bytes(session_bundle.bundle(session))
    session.close()
    again = Session(Folder.of(after))
    session_bundle.open_bundle(again, "saved.zip")
    first, second = (run.name for run in again.on_bench().runs)
    assert again.on_bench().trims == {first: (1.0, 20.0)}
    assert again.on_bench().excluded == {second}
    assert again.models.node()["runs"] == [{"name": second, "rms": 2.0}]
    wait_until_idle(again)
    again.close()


def test_unfinished_test_of_candidates_is_not_continued_after_loading(
    fitted: Session, tmp_path: Path
) -> None:
    """A session that was saved, or whose job failed, while the candidates were being tested."""
    node = fitted.models.node(1)
    trials, node["trials"] = node["trials"], None
    try:
        (tmp_path / "saved.zip").write_bytes(session_bundle.bundle(fitted))
    finally:
        node["trials"] = trials
    session = Session(Folder.of(tmp_path))
    session_bundle.open_bundle(session, "saved.zip")
    assert session.models.node(1)["trials"] == []
    wait_until_idle(session)
    session.close()
