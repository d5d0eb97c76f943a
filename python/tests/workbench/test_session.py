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

Wait = Callable[[Session], None]


@pytest.fixture(scope="module")
def fitted_session(campaign: Path) -> Session:
    """A session with a fit of the base law and a fit with the missing effect."""
    session = Session(Folder.of(campaign))
    session.open("rig.toml", sorted(p.name for p in campaign.glob("*.csv")))
    for effects, parent in (((), None), (("coulomb_drag",), 1)):
        session.begin("round", effects, parent)
        while session.jobs.job is not None:
            time.sleep(0.02)
    return session


def test_adding_the_missing_effect_reduces_the_held_out_rms_to_the_noise(
    fitted_session: Session,
) -> None:
    first, second = fitted_session.models.ledger()
    assert first["effects"] == []
    assert second["effects"] == ["coulomb_drag"]
    assert first["holdout_rms_n"] > 1.25 * NOISE_N
    assert second["rms_n"] == pytest.approx(NOISE_N, rel=0.05)
    assert second["holdout_rms_n"] == pytest.approx(NOISE_N, rel=0.05)


def test_missing_effect_is_ranked_first_among_the_candidates(fitted_session: Session) -> None:
    trials = fitted_session.models.node(1)["trials"]
    assert trials[0]["effect"] == "coulomb_drag"
    assert trials[0]["outcome"] == "added"
    assert trials[0]["rms_n"] == pytest.approx(fitted_session.models.node(2)["rms_n"], rel=0.02)


def test_detectable_strength_falls_once_the_missing_effect_is_added(
    fitted_session: Session,
) -> None:
    first, last = (
        {p["effect"]: p["found"] for p in fitted_session.models.node(number)["power"]}
        for number in (1, 2)
    )
    assert set(first) == {t["effect"] for t in fitted_session.models.node(1)["trials"]}

    def newtons(words: str) -> float:
        name, value, unit = words.split()
        assert (name, unit) == ("b_n", "N")
        return float(value)

    # The missing effect adds to the residual; without it, weaker effects are detectable.
    assert newtons(last["sensor_offset"]) < 0.7 * newtons(first["sensor_offset"])


@pytest.mark.extended
def test_model_is_shown_before_candidates_are_tried_and_kept_if_they_are_cancelled(
    loaded_session: Session, wait_until_idle: Wait
) -> None:
    loaded_session.begin("round", (), None)
    until = time.monotonic() + 120.0
    while not loaded_session.models.nodes:
        assert time.monotonic() < until
        time.sleep(0.005)
    assert loaded_session.jobs.job is not None
    assert loaded_session.models.node()["trials"] is None
    assert loaded_session.models.node()["rms_n"] > NOISE_N
    loaded_session.jobs.cancel()
    wait_until_idle(loaded_session)
    assert loaded_session.models.node()["trials"] == []
    assert "what else could be missing was cancelled" in loaded_session.message["words"]
    assert len(loaded_session.models.nodes) == 1


def test_modelled_stribeck_curve_agrees_with_the_measured_one_in_both_directions(
    fitted_session: Session,
) -> None:
    result = fitted_session.models.node(2)["stribeck"]
    assert [way["way"] for way in result["ways"]] == [1.0, -1.0]
    for way in result["ways"]:
        assert np.all(np.sign(way["speed_m_s"]) == way["way"])
        assert np.all(np.diff(np.abs(way["speed_m_s"])) >= 0.0)
        assert way["modelled_n"] == pytest.approx(way["measured_n"], abs=0.6)
    (mixed, film) = result["regimes_m_s"]
    u_tr = fitted_session.models.node(2)["parameters"]["U_tr_m_s"]["value"]
    assert mixed == (pytest.approx(0.2 * u_tr), "mixed")
    assert film == (pytest.approx(u_tr), "full film")


def test_model_is_not_written_through_a_link_outside_the_folder(
    fitted_session: Session, tmp_path: Path
) -> None:
    outside = tmp_path / "outside.toml"
    link = fitted_session.folder.root / "model.toml"
    link.symlink_to(outside)
    with pytest.raises(InputError, match="not a name in the folder"):
        kept.keep(fitted_session, "model")
    assert not outside.exists()
    link.unlink()


def test_session_and_jbf_fit_give_the_same_parameter_and_standard_error(
    fitted_session: Session,
) -> None:
    bench = fitted_session.on_bench()
    fit = jbf.fit(bench.rig, list(bench.runs), ["coulomb_drag"])
    shown = fitted_session.models.node(2)["parameters"]["coulomb_drag.F_d_n"]
    assert shown["value"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].value, rel=1e-3)
    assert shown["stderr"] == pytest.approx(fit.parameters["coulomb_drag.F_d_n"].stderr, rel=0.05)


def test_marked_samples_of_a_failure_move_in_the_direction_of_its_worst_bin(
    fitted_session: Session,
) -> None:
    node = fitted_session.models.node(1)
    failure = next(f for f in node["failures"] if f["axis"] == "velocity")
    centre = float(failure["bin"].split("=")[1].split()[0])
    for number, stretches in failure["ranges_s"].items():
        run = fitted_session.on_bench().runs[int(number)]
        inside = np.zeros(len(run), dtype=bool)
        for first, last in stretches:
            inside |= (run.time_s >= first) & (run.time_s <= last)
        # Noise changes the sign of the speed in a few samples.
        assert np.mean(np.sign(run.velocity_m_s[inside]) == np.sign(centre)) > 0.9


def test_showing_the_parent_of_a_model_does_not_delete_the_model(fitted_session: Session) -> None:
    fitted_session.show(2)
    fitted_session.show(fitted_session.models.node()["parent"])
    assert fitted_session.models.current == 1
    assert set(fitted_session.models.nodes) == {1, 2}
    fitted_session.show(2)


def test_saved_model_report_and_source_code_contain_the_effect(fitted_session: Session) -> None:
    assert kept.keep(fitted_session, "model") == {"written": ["model.toml"], "replaced": []}
    model = jbf.Model.load(fitted_session.folder.root / "model.toml")
    assert model.effects == ("coulomb_drag",)
    kept.keep(fitted_session, "report")
    page = (fitted_session.folder.root / "report.html").read_text()
    assert page.rstrip().endswith("</html>")
    assert "coulomb_drag" in page
    for what in ("rust", "c"):
        assert (
            "2.0" in kept.text_of(fitted_session, what)[1]
            or "coulomb" in kept.text_of(fitted_session, what)[1]
        )
    for name in ("model.toml", "report.html"):
        (fitted_session.folder.root / name).unlink()


def test_saving_a_next_run_is_refused_if_there_is_none(fitted_session: Session) -> None:
    with pytest.raises(InputError, match="no next run"):
        kept.text_of(fitted_session, "next_run")


def test_shown_command_line_reproduces_the_model(
    fitted_session: Session, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from jbf.cli import main

    fitted_session.show(2)
    monkeypatch.chdir(fitted_session.folder.root)
    words = fitted_session.told()["command"].split()
    assert words[0] == "jbf"
    assert main(words[1:]) == 0
    model = jbf.Model.load("model.toml")
    shown = fitted_session.models.node(2)["parameters"]["coulomb_drag.F_d_n"]["value"]
    assert model.parameters["coulomb_drag.F_d_n"].value == pytest.approx(shown, rel=1e-3)
    (fitted_session.folder.root / "model.toml").unlink()


def test_shown_python_code_fits_the_trimmed_runs(
    fitted_session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    fitted_session.show(1)
    fitted_session.on_bench().trim("stopgo", (1.0, 20.0))
    monkeypatch.chdir(fitted_session.folder.root)
    lines = fitted_session.told()["python"]
    assert "(1.0, 20.0)" in lines
    space: dict[str, object] = {}
    exec(lines, space)
    result = space["found"]
    assert isinstance(result, jbf.Fit)
    assert len(space["runs"][2]) == 19 * 50 + 1  # type: ignore[index]
    fitted_session.on_bench().trim("stopgo", None)
    (fitted_session.folder.root / "model.toml").unlink()
    fitted_session.show(2)


def test_session_loaded_from_its_file_has_the_same_models_trims_and_exclusions(
    fitted_session: Session, wait_until_idle: Wait
) -> None:
    fitted_session.on_bench().trim("stopgo", (1.0, 20.0))
    fitted_session.on_bench().leave_out("sine_w2.0", True)
    save(fitted_session)
    again = Session(fitted_session.folder)
    assert load(again)
    wait_until_idle(again)
    assert again.models.ledger() == fitted_session.models.ledger()
    assert again.on_bench().trims == {"stopgo": (1.0, 20.0)}
    assert again.on_bench().excluded == {"sine_w2.0"}
    # The records are recomputed from the runs that are still included.
    records = again.records(2)
    assert records is not None
    assert set(records) == {"sine_w0.5", "stopgo"}
    again.close()
    fitted_session.on_bench().trim("stopgo", None)
    fitted_session.on_bench().leave_out("sine_w2.0", False)
    (fitted_session.folder.root / FILE).unlink()


@pytest.mark.extended
def test_model_selected_during_a_comparison_is_compared_afterwards(
    fitted_session: Session,
) -> None:
    save(fitted_session)
    again = Session(fitted_session.folder)
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
    (fitted_session.folder.root / FILE).unlink()


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
def test_cancelled_diagnosis_keeps_the_best_model(
    loaded_session: Session, wait_until_idle: Wait
) -> None:
    loaded_session.begin("diagnose", (), None)
    until = time.monotonic() + 120.0
    # The number of candidates is known after the fit of the base law.
    while loaded_session.jobs.job and not loaded_session.jobs.job.total:
        assert time.monotonic() < until
        time.sleep(0.01)
    assert loaded_session.jobs.cancel()
    wait_until_idle(loaded_session)
    assert "best so far is kept" in loaded_session.message["words"]
    (node,) = loaded_session.models.nodes.values()
    assert node["words"] == "stopped at: journal"
    assert loaded_session.records(node["id"]) is not None
    assert loaded_session.model(node["id"]).law == "journal"


@pytest.mark.extended
def test_diagnosis_cancelled_twice_ends_without_a_model(
    loaded_session: Session, wait_until_idle: Wait
) -> None:
    loaded_session.begin("diagnose", (), None)
    assert loaded_session.jobs.cancel()
    assert loaded_session.jobs.cancel()
    wait_until_idle(loaded_session)
    assert "cancelled before" in loaded_session.message["words"]


@pytest.mark.parametrize(
    ("span", "words"), [((0.0, 0.05), "samples would be left"), ((float("nan"), 1.0), "no number")]
)
def test_trim_that_leaves_too_few_samples_or_has_a_nan_limit_is_refused(
    loaded_session: Session, span: tuple[float, float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        loaded_session.on_bench().trim("stopgo", span)
    assert loaded_session.on_bench().trims == {}


def test_invalid_requests_are_refused_in_one_line(
    client: TestClient, loaded_session: Session
) -> None:
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
