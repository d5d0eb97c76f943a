"""A session without a browser: open, fit, add an effect, cancel, save, resume."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

import jbf
from conftest import NOISE_N
from jbf.errors import InputError
from jbf.workbench import kept
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE, load, save
from starlette.testclient import TestClient

Ended = Callable[[Session], None]


@pytest.fixture(scope="module")
def worked(campaign: Path) -> Session:
    """A session with a fit of the law alone and a fit with the missing effect."""
    session = Session(Folder.of(campaign))
    session.open("rig.toml", sorted(p.name for p in campaign.glob("*.csv")))
    for effects, parent in (((), None), (("coulomb_drag",), 1)):
        session.begin("round", effects, parent)
        while session.jobs.job is not None:
            time.sleep(0.02)
    return session


def test_missing_effect_reduces_the_held_out_rms_to_the_noise(worked: Session) -> None:
    first, second = worked.models.ledger()
    assert first["effects"] == []
    assert second["effects"] == ["coulomb_drag"]
    assert first["holdout_rms_n"] > 1.25 * NOISE_N
    assert second["rms_n"] == pytest.approx(NOISE_N, rel=0.05)
    assert second["holdout_rms_n"] == pytest.approx(NOISE_N, rel=0.05)


def test_missing_effect_is_ranked_first(worked: Session) -> None:
    trials = worked.models.node(1)["trials"]
    assert trials[0]["effect"] == "coulomb_drag"
    assert trials[0]["outcome"] == "added"
    assert trials[0]["rms_n"] == pytest.approx(worked.models.node(2)["rms_n"], rel=0.02)


def test_detectable_strength_falls_once_the_missing_effect_is_added(worked: Session) -> None:
    first, last = (
        {p["effect"]: p["found"] for p in worked.models.node(number)["power"]} for number in (1, 2)
    )
    assert set(first) == {t["effect"] for t in worked.models.node(1)["trials"]}

    def newtons(words: str) -> float:
        name, value, unit = words.split()
        assert (name, unit) == ("b_n", "N")
        return float(value)

    # The missing effect masks others: once it is added, weaker ones are detectable.
    assert newtons(last["sensor_offset"]) < 0.7 * newtons(first["sensor_offset"])


@pytest.mark.extended
def test_model_is_shown_before_candidates_are_tried(on_bench: Session, ended: Ended) -> None:
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


def test_stribeck_curve_agrees_with_the_records(worked: Session) -> None:
    result = worked.models.node(2)["stribeck"]
    assert [way["way"] for way in result["ways"]] == [1.0, -1.0]
    for way in result["ways"]:
        assert np.all(np.sign(way["speed_m_s"]) == way["way"])
        assert np.all(np.diff(np.abs(way["speed_m_s"])) >= 0.0)
        assert way["modelled_n"] == pytest.approx(way["measured_n"], abs=0.6)
    (mixed, film) = result["regimes_m_s"]
    u_tr = worked.models.node(2)["parameters"]["U_tr_m_s"]["value"]
    assert mixed == (pytest.approx(0.2 * u_tr), "mixed")
    assert film == (pytest.approx(u_tr), "full film")


def test_model_is_not_written_through_a_link_outside_the_folder(
    worked: Session, tmp_path: Path
) -> None:
    outside = tmp_path / "outside.toml"
    link = worked.folder.root / "model.toml"
    link.symlink_to(outside)
    with pytest.raises(InputError, match="not a name in the folder"):
        kept.keep(worked, "model")
    assert not outside.exists()
    link.unlink()


def test_model_of_the_session_equals_that_of_fit(worked: Session) -> None:
    bench = worked.on_bench()
    fit = jbf.fit(bench.rig, list(bench.runs), ["coulomb_drag"])
    shown = worked.models.node(2)["parameters"]["coulomb_drag.F_d_n"]
    assert shown["value"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].value, rel=1e-3)
    assert shown["stderr"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].stderr, rel=0.05)


def test_marks_lie_in_the_worst_bin_of_a_pattern(worked: Session) -> None:
    node = worked.models.node(1)
    failure = next(f for f in node["failures"] if f["axis"] == "velocity")
    centre = float(failure["bin"].split("=")[1].split()[0])
    for number, stretches in failure["ranges_s"].items():
        run = worked.on_bench().runs[int(number)]
        inside = np.zeros(len(run), dtype=bool)
        for first, last in stretches:
            inside |= (run.time_s >= first) & (run.time_s <= last)
        # Except for noise in the speed, every sample of the bin moves in its direction.
        assert np.mean(np.sign(run.velocity_m_s[inside]) == np.sign(centre)) > 0.9


def test_undo_shows_the_parent_and_keeps_the_branch(worked: Session) -> None:
    worked.show(2)
    worked.show(worked.models.node()["parent"])
    assert worked.models.current == 1
    assert set(worked.models.nodes) == {1, 2}
    worked.show(2)


def test_saved_model_and_report_are_complete(worked: Session) -> None:
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


def test_shown_command_gives_the_same_model(
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


def test_shown_python_code_runs(worked: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    worked.show(1)
    worked.on_bench().trim("stopgo", (1.0, 20.0))
    monkeypatch.chdir(worked.folder.root)
    lines = worked.told()["python"]
    assert "(1.0, 20.0)" in lines
    space: dict[str, object] = {}
    exec(lines, space)
    result = space["found"]
    assert isinstance(result, jbf.Fit)
    assert len(space["runs"][2]) == 19 * 50 + 1  # type: ignore[index]
    worked.on_bench().trim("stopgo", None)
    (worked.folder.root / "model.toml").unlink()
    worked.show(2)


def test_session_resumes_from_its_file(worked: Session, ended: Ended) -> None:
    worked.on_bench().trim("stopgo", (1.0, 20.0))
    worked.on_bench().leave_out("sine_w2.0", True)
    save(worked)
    again = Session(worked.folder)
    assert load(again)
    ended(again)
    assert again.models.ledger() == worked.models.ledger()
    assert again.on_bench().trims == {"stopgo": (1.0, 20.0)}
    assert again.on_bench().excluded == {"sine_w2.0"}
    # Its records are computed from the runs that are in use now.
    records = again.records(2)
    assert records is not None
    assert set(records) == {"sine_w0.5", "stopgo"}
    again.close()
    worked.on_bench().trim("stopgo", None)
    worked.on_bench().leave_out("sine_w2.0", False)
    (worked.folder.root / FILE).unlink()


@pytest.mark.extended
def test_model_chosen_during_a_comparison_is_compared_afterwards(
    worked: Session,
) -> None:
    save(worked)
    again = Session(worked.folder)
    assert load(again)
    assert again.jobs.job is not None  # the current model is being compared
    again.show(1)
    assert again.models.current == 1
    until = time.monotonic() + 300.0
    while again.records(1) is None:
        assert time.monotonic() < until
        time.sleep(0.02)
    assert again.records(2) is not None
    again.close()
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
def test_broken_session_file_is_refused_in_one_line(
    session: Session, text: str, words: str
) -> None:
    path = session.folder.root / FILE
    path.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        load(session)
    assert "\n" not in str(caught.value)
    path.unlink()


@pytest.mark.extended
def test_cancelled_diagnosis_keeps_the_best_model(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("diagnose", (), None)
    until = time.monotonic() + 120.0
    # The number of candidates is known once the law alone has been fitted.
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


@pytest.mark.extended
def test_second_cancellation_kills_the_fit(on_bench: Session, ended: Ended) -> None:
    on_bench.begin("diagnose", (), None)
    assert on_bench.jobs.cancel()
    assert on_bench.jobs.cancel()
    ended(on_bench)
    assert "cancelled before" in on_bench.message["words"]


@pytest.mark.parametrize(
    ("span", "words"), [((0.0, 0.05), "samples would be left"), ((float("nan"), 1.0), "no number")]
)
def test_trim_that_leaves_too_few_samples_is_refused(
    on_bench: Session, span: tuple[float, float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        on_bench.on_bench().trim("stopgo", span)
    assert on_bench.on_bench().trims == {}


def test_bad_requests_are_refused_in_one_line(client: TestClient, on_bench: Session) -> None:
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
