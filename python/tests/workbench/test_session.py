"""A session without a browser: open, fit, add an effect, cancel, undo."""

import json
import pickle
from importlib.resources import files
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

import jbf
from conftest import NOISE_N
from jbf.cli import main
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.models.catalogue import built_in
from jbf.workbench import effect_views, saved_files
from jbf.workbench.channels import channel, channels
from jbf.workbench.jobs import Ended, Part
from jbf.workbench.models import Models
from jbf.workbench.session import Session
from jbf.workbench.session_file import load, save
from jbf.workbench.work import Settings
from starlette.testclient import TestClient
from workbench_parts import wait_until, wait_until_idle


def test_adding_missing_effect_reduces_held_out_rms_to_the_noise(fitted: Session) -> None:
    first, second = fitted.models.ledger()
    assert first["effects"] == []
    assert second["effects"] == ["coulomb_drag"]
    assert first["held_out_rms"] > 1.25 * NOISE_N
    assert second["rms"] == pytest.approx(NOISE_N, rel=0.05)
    assert second["held_out_rms"] == pytest.approx(NOISE_N, rel=0.05)


def test_size_of_an_effect_is_its_contribution_in_the_unit_of_the_rig(fitted: Session) -> None:
    assert fitted.models.node(1)["sizes"] == {}
    words = fitted.models.node(2)["sizes"]["coulomb_drag"].split()
    # A Coulomb drag contributes its constant force at every included sample.
    force = fitted.models.node(2)["parameters"]["coulomb_drag.F_d"]["value"]
    at = words.index("N")
    assert float(words[at - 1]) == pytest.approx(force, rel=0.01)
    assert float(words[at + 2]) == pytest.approx(force / NOISE_N, rel=0.06)


def test_banner_is_stale_while_a_fitted_run_is_excluded(fitted: Session) -> None:
    def stale() -> list[bool]:
        return [node["banner"]["stale"] for node in fitted.to_dict()["nodes"]]

    assert stale() == [False, False]
    fitted.on_bench().leave_out("sine_w2.0", True)
    assert stale() == [True, True]


def test_missing_effect_is_ranked_first_among_the_candidates(fitted: Session) -> None:
    trials = fitted.models.node(1)["trials"]
    assert trials[0]["effect"] == "coulomb_drag"
    assert trials[0]["outcome"] == "added"
    assert trials[0]["rms"] == pytest.approx(fitted.models.node(2)["rms"], rel=0.02)


def test_detectable_strength_falls_when_missing_effect_is_added(fitted: Session) -> None:
    powers = [fitted.models.node(number)["power"] for number in (1, 2)]
    first, last = ({p["effect"]: p["detectable"] for p in power} for power in powers)
    assert set(first) == {t["effect"] for t in fitted.models.node(1)["trials"]}
    before, after = (found["sensor_offset"].split() for found in (first, last))
    assert before[::2] == after[::2] == ["b", "N"]
    # The missing effect increases the residual; without it, weaker effects are detectable.
    assert float(after[1]) < 0.7 * float(before[1])


def test_job_that_cannot_be_started_does_not_block_the_next_one(loaded: Session) -> None:
    cannot_be_sent: Any = lambda: None  # noqa: E731
    with pytest.raises((AttributeError, pickle.PicklingError)):
        loaded.jobs.start("a fit", cannot_be_sent, lambda *_: None)
    loaded.begin("round", (), None)
    wait_until_idle(loaded)
    assert len(loaded.models.nodes) == 1


@pytest.mark.extended
def test_fitted_model_is_kept_if_trying_candidates_is_cancelled(loaded: Session) -> None:
    loaded.begin("round", (), None)
    wait_until(lambda: loaded.models.nodes)
    assert loaded.jobs.job is not None
    assert loaded.models.node()["trials"] is None
    assert loaded.models.node()["rms"] > NOISE_N
    loaded.jobs.cancel()
    wait_until_idle(loaded)
    assert loaded.models.node()["trials"] == []
    assert "cancelled" in loaded.message["words"]
    assert len(loaded.models.nodes) == 1


def test_stribeck_curves_of_model_and_record_agree_in_both_directions(fitted: Session) -> None:
    result = fitted.models.node(2)["stribeck"]
    assert [branch["direction"] for branch in result["directions"]] == [1.0, -1.0]
    for branch in result["directions"]:
        assert np.all(np.sign(branch["speed_m_s"]) == branch["direction"])
        assert np.all(np.diff(np.abs(branch["speed_m_s"])) >= 0.0)
        assert branch["modelled_n"] == pytest.approx(branch["measured_n"], abs=0.6)
    u_tr = fitted.models.node(2)["parameters"]["U_tr_m_s"]["value"]
    regimes = [(pytest.approx(0.2 * u_tr), "mixed"), (pytest.approx(u_tr), "full film")]
    assert list(result["regimes_m_s"]) == regimes


def test_model_is_not_saved_through_a_link_out_of_the_folder(fitted: Session) -> None:
    outside = fitted.folder.root.parent / "outside.toml"
    (fitted.folder.root / "model.toml").symlink_to(outside)
    with pytest.raises(InputError, match="not a name in the folder"):
        saved_files.save_as_file(fitted, "model")
    assert not outside.exists()


def test_session_fit_has_the_parameter_and_standard_error_of_jbf_fit(fitted: Session) -> None:
    bench = fitted.on_bench()
    fit = jbf.fit(bench.rig, list(bench.runs), ["coulomb_drag"])
    shown = fitted.models.node(2)["parameters"]["coulomb_drag.F_d"]
    assert shown["value"] == pytest.approx(fit.parameters["coulomb_drag.F_d"].value, rel=1e-3)
    assert shown["stderr"] == pytest.approx(fit.parameters["coulomb_drag.F_d"].stderr, rel=0.05)


def test_marked_samples_of_a_failure_move_in_direction_of_worst_bin(fitted: Session) -> None:
    node = fitted.models.node(1)
    failure = next(f for f in node["failures"] if f["axis"] == "velocity")
    centre = float(failure["bin"].split("=")[1].split()[0])
    for number, stretches in failure["ranges_s"].items():
        run = fitted.on_bench().runs[int(number)]
        inside = np.zeros(len(run), dtype=bool)
        for first, last in stretches:
            inside |= (run.time_s >= first) & (run.time_s <= last)
        # Noise changes the sign of the speed in a few samples.
        assert np.mean(np.sign(run.velocity[inside]) == np.sign(centre)) > 0.9


def test_advice_on_a_failure_names_no_option_of_the_command_line(fitted: Session) -> None:
    failures = fitted.models.node(1)["failures"]
    assert failures
    assert not [f["to_do"] for f in failures if "--" in f["to_do"]]


def test_model_is_kept_if_its_parent_is_shown(fitted: Session) -> None:
    fitted.show(fitted.models.node()["parent"])
    assert fitted.models.current == 1
    assert set(fitted.models.nodes) == {1, 2}


def test_saved_model_report_and_source_code_contain_the_effect(fitted: Session) -> None:
    assert saved_files.save_as_file(fitted, "model") == {"written": ["model.toml"], "replaced": []}
    model = jbf.Model.load(fitted.folder.root / "model.toml")
    assert model.effects == ("coulomb_drag",)
    saved_files.save_as_file(fitted, "report")
    page = (fitted.folder.root / "report.html").read_text()
    assert page.rstrip().endswith("</html>")
    assert "coulomb_drag" in page
    for what in ("rust", "c"):
        assert (
            "2.0" in saved_files.text_of(fitted, what)[1]
            or "coulomb" in saved_files.text_of(fitted, what)[1]
        )


def test_saving_the_next_run_is_refused_if_none_was_proposed(fitted: Session) -> None:
    with pytest.raises(InputError, match="no next run"):
        saved_files.text_of(fitted, "next_run")


@pytest.mark.usefixtures("inside_folder")
def test_command_line_shown_for_a_model_reproduces_the_model(fitted: Session) -> None:
    words = fitted.to_dict()["command"].split()
    assert words[0] == "jbf"
    assert main(words[1:]) == 0
    model = jbf.Model.load("model.toml")
    shown = fitted.models.node(2)["parameters"]["coulomb_drag.F_d"]["value"]
    assert model.parameters["coulomb_drag.F_d"].value == pytest.approx(shown, rel=1e-3)


@pytest.mark.usefixtures("inside_folder")
def test_python_code_shown_for_a_model_fits_trimmed_runs(fitted: Session) -> None:
    fitted.show(1)
    fitted.on_bench().trim("stopgo", (1.0, 20.0))
    lines = fitted.to_dict()["python"]
    assert "(1.0, 20.0)" in lines
    space: dict[str, object] = {}
    exec(lines, space)
    assert isinstance(space["found"], jbf.Fit)
    assert len(space["runs"][2]) == 19 * 50 + 1  # type: ignore[index]


def test_diagnosis_has_the_chosen_law_not_that_of_the_current_model(fitted: Session) -> None:
    before = fitted.law
    fitted.choose_law("coulomb")
    fitted.begin("diagnose", (), 2)
    job = fitted.jobs.job
    fitted.jobs.cancel(at_once=True)
    wait_until_idle(fitted)
    fitted.choose_law(before)
    assert job is not None
    assert "coulomb" in job.words


@pytest.mark.extended
def test_model_selected_during_a_comparison_is_compared_later(fitted: Session) -> None:
    save(fitted)
    again = Session(fitted.folder)
    assert load(again)
    assert again.jobs.job is not None  # the comparison of the current model is running
    again.show(1)
    assert again.models.current == 1
    wait_until(lambda: again.records(1) is not None)
    assert again.records(2) is not None
    again.close()


def test_fit_with_settings_keeps_fixed_values_and_is_the_command_that_is_shown(
    fitted: Session,
) -> None:
    settings = Settings(fixed={"coulomb_drag.F_d": 1.5}, bounds={"gamma": (1.0, 300.0)})
    fitted.begin("fit", ["coulomb_drag"], 2, settings)
    wait_until_idle(fitted)
    node = fitted.models.node()
    assert node["parameters"]["coulomb_drag.F_d"]["value"] == 1.5
    assert node["rms"] > fitted.models.node(2)["rms"]
    assert node["settings"]["bounds"] == {"gamma": [1.0, 300.0]}
    command = fitted.to_dict()["command"]
    assert "--fix coulomb_drag.F_d=1.5" in command
    assert "--bounds gamma=1.0:300.0" in command
    fitted.show(2)
    del fitted.models.nodes[node["id"]]


def test_undone_model_is_restored_by_redo_until_another_is_shown(fitted: Session) -> None:
    fitted.show(2)
    fitted.undo()
    assert fitted.models.current == 1
    assert fitted.to_dict()["can_redo"]
    fitted.redo()
    assert fitted.models.current == 2
    fitted.undo()
    fitted.show(None)
    with pytest.raises(InputError, match="no model was undone"):
        fitted.redo()


def test_error_of_edited_parameters_is_least_at_the_estimates(fitted: Session) -> None:
    estimate = fitted.models.node(2)["parameters"]["coulomb_drag.F_d"]["value"]
    errors = [
        effect_views.edited(
            fitted, 2, {"coulomb_drag.F_d": times * estimate}, "stopgo", (None, None), 200
        )["rms"]
        for times in (0.5, 1.0, 1.5)
    ]
    assert errors[1] == min(errors)
    with pytest.raises(InputError, match="is not a parameter"):
        effect_views.edited(fitted, 2, {"nothing": 1.0}, "stopgo", (None, None), 200)


@pytest.mark.parametrize("transform", ["value", "derivative", "spectrum"])
def test_channel_is_drawn_as_recorded_derivative_or_spectrum(
    fitted: Session, transform: str
) -> None:
    names = channels(fitted, 2, "sine_w2.0")
    assert names["residual_n"] == names["friction_n"] == "N"
    curve = channel(fitted, 2, "sine_w2.0", "velocity_m_s", transform, (None, None), 4000)
    x, y = np.array(curve["x"]), np.array(curve["y"])
    if transform == "spectrum":
        # The run is a sine of 2 rad/s.
        assert x[np.argmax(y)] == pytest.approx(2.0 / (2.0 * np.pi), abs=2.0 * x[0])
    if transform == "derivative":
        run = fitted.on_bench().run("sine_w2.0")
        inside = slice(20, -20)
        expected = np.gradient(run.velocity, run.time_s)
        assert np.corrcoef(y[inside], expected[inside])[0, 1] > 0.7


def test_every_effect_of_the_catalogue_has_a_shape() -> None:
    file = files("jbf.workbench") / "static" / "effect_shapes.json"
    shapes = json.loads(file.read_text(encoding="utf-8"))
    assert set(shapes) == set(built_in())
    assert {np.shape(shape) for shape in shapes.values()} == {(2, 96)}


@pytest.mark.extended
def test_cancelled_diagnosis_keeps_the_best_model_so_far(loaded: Session) -> None:
    loaded.begin("diagnose", (), None)
    # The number of candidates is known after the fit of the base law.
    wait_until(lambda: not loaded.jobs.job or loaded.jobs.job.total)
    assert loaded.jobs.cancel()
    wait_until_idle(loaded)
    assert "best model so far is kept" in loaded.message["words"]
    (node,) = loaded.models.nodes.values()
    assert node["words"] == "stopped at: journal"
    assert loaded.records(node["id"]) is not None
    assert loaded.model(node["id"]).law == "journal"


@pytest.mark.extended
def test_diagnosis_cancelled_twice_ends_without_a_model(loaded: Session) -> None:
    loaded.begin("diagnose", (), None)
    assert loaded.jobs.cancel()
    assert loaded.jobs.cancel()
    wait_until_idle(loaded)
    assert "cancelled before" in loaded.message["words"]


@pytest.mark.parametrize(
    ("span", "words"),
    [((0.0, 0.05), "samples would remain"), ((float("nan"), 1.0), "not a number")],
)
def test_trim_to_few_samples_or_with_nan_is_refused(
    loaded: Session, span: tuple[float, float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        loaded.on_bench().trim("stopgo", span)
    assert loaded.on_bench().trims == {}


def test_invalid_api_requests_are_refused_in_one_line(client: TestClient, loaded: Session) -> None:
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


def test_failed_test_of_candidates_keeps_the_model_without_candidates(
    loaded: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    fitted_model = {
        "law": "journal", "effects": [], "model": "", "rms": 1.0, "noise_rms": 1.0, "trials": None,
    }  # fmt: skip

    def start(words: str, order: object, on_end: Ended, part: Part) -> None:
        part(fitted_model)
        on_end("error", "not enough memory")

    monkeypatch.setattr(loaded.jobs, "start", start)
    loaded.begin("round", (), None)
    assert loaded.models.node()["trials"] == []
    assert loaded.message["kind"] == "error"


def test_fourth_model_cannot_be_compared() -> None:
    models = Models()
    for _ in range(5):
        models.add(None, "fit", {})
    for number in (1, 2, 3):
        models.compare_with(number, True)
    models.compare_with(2, True)  # already compared
    with pytest.raises(InputError, match="compared already"):
        models.compare_with(4, True)
    models.compare_with(1, False)
    models.compare_with(4, True)
    assert models.compared == [3, 2, 4]


def test_contribution_of_an_effect_uses_the_starting_values_of_these_runs(fitted: Session) -> None:
    bench = fitted.on_bench()
    campaign = Campaign.prepare(bench.rig, bench.runs)
    problem = Problem(campaign, "journal", "journal", ["stribeck_excess"])
    starts = dict(zip(problem.names, problem.starts({})[0].tolist(), strict=True))
    # After other tests, the model is compared again once it is shown.
    fitted.show(1)
    wait_until(lambda: fitted.typical_values(1))
    values = fitted.typical_values(1)
    assert values is not None
    added = {name: v for name, v in starts.items() if name.startswith("stribeck_excess.")}
    assert {name: values[name] for name in added} == added
    answer = effect_views.signature(fitted, 1, "stribeck_excess", "stopgo", (None, None), 200)
    assert np.any(answer["contribution"])
