"""The story without a browser: open, fit, add what is missing, the error falls, save, go on."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

import jbf
from conftest import NOISE_N
from jbf.errors import InputError
from jbf.workbench import actions, kept, views
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE, load, save
from starlette.testclient import TestClient

Ended = Callable[[Session], None]


@pytest.fixture(scope="module")
def worked(campaign: Path) -> Session:
    """A session on which the law was fitted alone, and then with what it lacks."""
    session = Session(Folder.of(campaign))
    session.open("rig.toml", sorted(p.name for p in campaign.glob("*.csv")))
    for effects, parent in (((), None), (("coulomb_drag",), 1)):
        session.begin("round", effects, parent)
        while session.jobs.job is not None:
            time.sleep(0.02)
    return session


def test_the_error_falls_when_the_missing_effect_is_added(worked: Session) -> None:
    first, second = worked.models.ledger()
    assert first["effects"] == []
    assert second["effects"] == ["coulomb_drag"]
    assert first["holdout_rms_n"] > 1.25 * NOISE_N
    assert second["rms_n"] == pytest.approx(NOISE_N, rel=0.05)
    assert second["holdout_rms_n"] == pytest.approx(NOISE_N, rel=0.05)


def test_candidates_are_ranked_with_the_missing_one_first(worked: Session) -> None:
    trials = worked.models.node(1)["trials"]
    assert trials[0]["effect"] == "coulomb_drag"
    assert trials[0]["outcome"] == "added"
    assert trials[0]["rms_n"] == pytest.approx(worked.models.node(2)["rms_n"], rel=0.02)


def test_each_candidate_has_the_strength_from_which_it_would_show(worked: Session) -> None:
    first, last = (
        {p["effect"]: p["found"] for p in worked.models.node(number)["power"]} for number in (1, 2)
    )
    assert set(first) == {t["effect"] for t in worked.models.node(1)["trials"]}

    def newtons(words: str) -> float:
        name, value, unit = words.split()
        assert (name, unit) == ("b_n", "N")
        return float(value)

    # What is missing hides others: once it is added, weaker ones would show.
    assert newtons(last["sensor_offset"]) < 0.7 * newtons(first["sensor_offset"])


def test_a_model_is_there_before_its_rivals_are_tried(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("round", (), None)
    until = time.monotonic() + 120.0
    while not on_bench.models.nodes:
        assert time.monotonic() < until
        time.sleep(0.005)
    assert on_bench.jobs.job is not None
    assert on_bench.models.node()["trials"] is None
    assert on_bench.models.node()["rms_n"] > NOISE_N
    on_bench.jobs.cancel()
    ended(on_bench)
    assert on_bench.models.node()["trials"] == []
    assert "what else could be missing was cancelled" in on_bench.message["words"]
    assert len(on_bench.models.nodes) == 1


def test_the_stribeck_curve_is_that_of_the_records(worked: Session) -> None:
    found = worked.models.node(2)["stribeck"]
    assert [way["way"] for way in found["ways"]] == [1.0, -1.0]
    for way in found["ways"]:
        assert np.all(np.sign(way["speed_m_s"]) == way["way"])
        assert np.all(np.diff(np.abs(way["speed_m_s"])) >= 0.0)
        assert way["modelled_n"] == pytest.approx(way["measured_n"], abs=0.6)
    (mixed, film) = found["regimes_m_s"]
    u_tr = worked.models.node(2)["parameters"]["U_tr_m_s"]["value"]
    assert mixed == (pytest.approx(0.2 * u_tr), "mixed")
    assert film == (pytest.approx(u_tr), "full film")


def test_a_model_file_is_not_written_through_a_link_that_leads_outside(
    worked: Session, tmp_path: Path
) -> None:
    outside = tmp_path / "outside.toml"
    link = worked.folder.root / "model.toml"
    link.symlink_to(outside)
    with pytest.raises(InputError, match="not a name in the folder"):
        kept.keep(worked, "model")
    assert not outside.exists()
    link.unlink()


def test_a_model_is_the_library_s(worked: Session) -> None:
    bench = worked.on_bench()
    fit = jbf.fit(bench.rig, list(bench.runs), ["coulomb_drag"])
    there = worked.models.node(2)["parameters"]["coulomb_drag.F_d_n"]
    assert there["value"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].value, rel=1e-3)
    assert there["stderr"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].stderr, rel=0.05)


def test_marks_lie_where_the_pattern_s_worst_bin_is(worked: Session) -> None:
    node = worked.models.node(1)
    failure = next(f for f in node["failures"] if f["axis"] == "velocity")
    centre = float(failure["bin"].split("=")[1].split()[0])
    for number, stretches in failure["ranges_s"].items():
        run = worked.on_bench().runs[int(number)]
        inside = np.zeros(len(run), dtype=bool)
        for first, last in stretches:
            inside |= (run.time_s >= first) & (run.time_s <= last)
        # Noise in the speed apart, all samples of the bin move as its centre does.
        assert np.mean(np.sign(run.velocity_m_s[inside]) == np.sign(centre)) > 0.9


def test_a_mark_selects_its_samples_in_every_run(worked: Session) -> None:
    node = worked.models.node(1)
    names = [run.name for run in worked.on_bench().runs]
    for place, failure in enumerate(node["failures"]):
        found = views.brushed(worked, 1, {"mark": place}, names, (80, 60))
        marked = {node["record_names"][int(k)] for k in failure["ranges_s"]}
        assert set(found["by_run"]) == marked
        # Where it fails worst the residual is larger than everywhere.
        assert abs(found["mean_n"]) > 0.2 * failure["share"] * node["rms_n"]
    assert found["cells"]
    with pytest.raises(InputError, match="no such failure"):
        views.brushed(worked, 1, {"mark": len(node["failures"])}, names, (80, 60))


def test_undo_goes_back_and_keeps_the_branch(worked: Session) -> None:
    worked.show(2)
    worked.show(worked.models.node()["parent"])
    assert worked.models.current == 1
    assert set(worked.models.nodes) == {1, 2}
    worked.show(2)


def test_what_is_kept_is_whole_and_loads(worked: Session) -> None:
    assert kept.keep(worked, "model") == {"written": ["model.toml"], "replaced": []}
    model = jbf.Model.load(worked.folder.root / "model.toml")
    assert model.effects == ("coulomb_drag",)
    kept.keep(worked, "report")
    page = (worked.folder.root / "report.html").read_text()
    assert page.rstrip().endswith("</html>")
    assert "coulomb_drag" in page
    for what in ("rust", "c"):
        assert "2.0" in kept.text_of(worked, what)[1] or "coulomb" in kept.text_of(worked, what)[1]
    with pytest.raises(InputError, match="no next run"):
        kept.text_of(worked, "next_run")
    for name in ("model.toml", "report.html"):
        (worked.folder.root / name).unlink()


def test_the_command_that_is_shown_gives_the_same_model(
    worked: Session, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from jbf.cli import main

    worked.show(2)
    monkeypatch.chdir(worked.folder.root)
    words = worked.told()["command"].split()
    assert words[0] == "jbf"
    assert main(words[1:]) == 0
    model = jbf.Model.load("model.toml")
    shown = worked.models.node(2)["parameters"]["coulomb_drag.F_d_n"]["value"]
    assert model.parameters["coulomb_drag.F_d_n"].value == pytest.approx(shown, rel=1e-3)
    (worked.folder.root / "model.toml").unlink()


def test_the_python_that_is_shown_runs(worked: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    worked.show(1)
    worked.on_bench().trim("stopgo", (1.0, 20.0))
    monkeypatch.chdir(worked.folder.root)
    lines = worked.told()["python"]
    assert "(1.0, 20.0)" in lines
    space: dict[str, object] = {}
    exec(lines, space)  # what a user would paste
    found = space["found"]
    assert isinstance(found, jbf.Fit)
    assert len(space["runs"][2]) == 19 * 50 + 1  # type: ignore[index]
    worked.on_bench().trim("stopgo", None)
    (worked.folder.root / "model.toml").unlink()
    worked.show(2)


def test_a_session_goes_on_from_its_file(worked: Session, ended: Ended) -> None:
    worked.on_bench().trim("stopgo", (1.0, 20.0))
    worked.on_bench().leave_out("sine_w2.0", True)
    save(worked)
    again = Session(worked.folder)
    assert load(again)
    ended(again)
    assert again.models.ledger() == worked.models.ledger()
    assert again.on_bench().trims == {"stopgo": (1.0, 20.0)}
    assert again.on_bench().excluded == {"sine_w2.0"}
    # Its records are made anew, of the runs that are used now.
    records = again.records(2)
    assert records is not None
    assert set(records) == {"sine_w0.5", "stopgo"}
    again.close()
    worked.on_bench().trim("stopgo", None)
    worked.on_bench().leave_out("sine_w2.0", False)
    (worked.folder.root / FILE).unlink()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "is no JSON"),
        ("[]", "is not of the format"),
        ('{"format": "jbf workbench 9"}', "is not of the format"),
        ('{"format": "jbf workbench 1"}', "is broken"),
        ('{"format": "jbf workbench 1", "rig": "../rig.toml", "runs": []}', "not a name"),
        ('{"format": "jbf workbench 1", "rig": "gone.toml", "runs": ["a.csv"]}', "does not exist"),
    ],
)
def test_a_broken_session_file_is_one_line(session: Session, text: str, words: str) -> None:
    path = session.folder.root / FILE
    path.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        load(session)
    assert "\n" not in str(caught.value)
    path.unlink()


def test_a_fit_can_be_cancelled_and_leaves_what_was_there(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("diagnose", (), None)
    with pytest.raises(InputError, match="a fit is running"):
        on_bench.begin("round", (), None)
    assert on_bench.jobs.cancel()
    ended(on_bench)
    assert "cancelled" in on_bench.message["words"]
    assert on_bench.models.nodes == {}
    assert not on_bench.jobs.cancel()


def test_a_cancelled_fit_keeps_the_best_so_far(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("diagnose", (), None)
    until = time.monotonic() + 120.0
    # Candidates are counted when the law alone has been fitted.
    while on_bench.jobs.job and not on_bench.jobs.job.total:
        assert time.monotonic() < until
        time.sleep(0.01)
    assert on_bench.jobs.cancel()
    ended(on_bench)
    assert "best so far is kept" in on_bench.message["words"]
    (node,) = on_bench.models.nodes.values()
    assert node["words"] == "stopped at: journal"
    assert on_bench.records(node["id"]) is not None
    assert on_bench.model(node["id"]).law == "journal"


def test_a_fit_that_is_cancelled_twice_is_killed(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("diagnose", (), None)
    assert on_bench.jobs.cancel()
    assert on_bench.jobs.cancel()
    ended(on_bench)
    assert "cancelled before" in on_bench.message["words"]


def test_what_a_fit_refuses_is_said_and_the_records_stay(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("round", ["vogel_viscosity"], None)
    ended(on_bench)
    assert on_bench.message["kind"] == "error"
    assert "temperature" in on_bench.message["words"]
    assert len(on_bench.told()["runs"]) == 3


@pytest.mark.parametrize(
    ("span", "words"), [((0.0, 0.05), "samples would be left"), ((float("nan"), 1.0), "no number")]
)
def test_a_trim_that_leaves_too_little_is_refused(
    on_bench: Session, span: tuple[float, float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        on_bench.on_bench().trim("stopgo", span)
    assert on_bench.on_bench().trims == {}


def test_without_a_run_nothing_is_fitted(on_bench: Session) -> None:
    for run in on_bench.on_bench().runs:
        on_bench.on_bench().leave_out(run.name, True)
    with pytest.raises(InputError, match="every run is left out"):
        on_bench.begin("round", (), None)


def test_the_page_s_requests_are_checked(client: TestClient, on_bench: Session) -> None:
    for path, body in (
        ("open", {}), ("trim", {"run": "stopgo", "from_s": "x", "to_s": 2}), ("plane", {"runs": 3}),
        ("brush", {}), ("fit", {"effects": 5}), ("show", {"model": "x"}),
    ):  # fmt: skip
        answer = client.post(f"/api/{path}", json=body)
        assert answer.status_code in (400, 422), path
        assert "Traceback" not in answer.text
        assert "\n" not in answer.json()["error"]
    assert client.post("/api/open", content=b"{").status_code == 400
    assert client.post("/api/open", content=b"[]").status_code == 400
    unknown = client.post("/api/fit", json={"effects": ["presliddng"]})
    assert "did you mean" in unknown.json()["error"]


def test_the_state_is_plain_json(worked: Session) -> None:
    told = json.dumps(worked.told(), allow_nan=False)
    assert "sine_w0.5" in told


def test_the_demo_opens_where_it_lies_already(tmp_path: Path) -> None:
    from importlib.resources import files

    shipped = files("jbf") / "data" / "demo" / "hidden"
    (tmp_path / "hidden").mkdir()
    for path in shipped.iterdir():
        if path.is_file():
            (tmp_path / "hidden" / path.name).write_bytes(path.read_bytes())
    for folder, rig in ((tmp_path, "hidden/rig.toml"), (tmp_path / "empty", "jbf-demo/rig.toml")):
        folder.mkdir(exist_ok=True)
        session = Session(Folder.of(folder))
        actions.demo(session, {})
        assert session.on_bench().rig_name == rig
        session.close()
    assert not (tmp_path / "jbf-demo").exists()
