"""`jbf diagnose` and `jbf power`: files, false-alarm rate, minimum effect size, held-out runs."""

import json
import re
from pathlib import Path
from typing import Any

import jbf
import jsonschema
import numpy as np
import pytest
from input_checks import Capture
from jbf.cli import main
from jbf.estimation import work

LAW = ["--law", "coulomb"]
NOISE_N = 0.1
SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "schema" / "results.json"


def diagnosed(slide: Path, out: Path, *options: str) -> Any:
    """The JSON result of a diagnosis of the slide."""
    assert main(["diagnose", str(slide), *LAW, "--json", str(out), *options]) == 0
    return json.loads(out.read_text())


def test_diagnose_writes_model_json_and_page(slide: Path, tmp_path: Path, capsys: Capture) -> None:
    model, page = tmp_path / "m.toml", tmp_path / "d.html"
    options = ["--out", str(model), "--report", str(page)]
    result = diagnosed(slide, tmp_path / "d.json", *options)
    printed = capsys.readouterr()
    assert printed.out.startswith("Verdict: adequate")
    assert printed.err == ""
    assert result["verdict"] == "adequate"
    assert (result["machine"], result["effects"]) == (["inertia"], [])
    assert set(result) >= {"alternatives", "failures", "residual_structure", "next_experiment"}
    assert set(result["steps"][0]) >= {"effects", "rms", "held_out_rms", "noise_rms"}
    assert jbf.Model.load(model).effects == ("inertia",)
    assert "Diagnosis: adequate" in page.read_text()
    level = result["level"]
    assert level["false_alarm_rate"] == 0.01
    assert level["blocks"] > 0
    assert level["chance"] <= 0.01 / level["candidates"]


def test_diagnose_prints_up_to_30_lines_by_default_more_if_full_and_one_if_quiet(
    slide: Path, capsys: Capture
) -> None:
    printed = {}
    for option in ("", "--quiet", "--full"):
        assert main(["diagnose", str(slide), *LAW, *option.split()]) == 0
        printed[option] = capsys.readouterr().out.splitlines()
    assert len(printed["--quiet"]) == 1
    assert len(printed["--quiet"]) < len(printed[""]) <= 30 < len(printed["--full"])
    assert printed["--quiet"] == printed[""][:1] == printed["--full"][:1]
    assert main(["diagnose", "--many", str(slide), "--quiet"]) == 2


def test_diagnosis_beyond_the_work_limit_writes_the_partial_result_and_exits_with_2(
    slide: Path, tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work, "ANY_STEPS", 5e5)
    monkeypatch.setattr(work, "STEPS_A_SAMPLE", 0.0)
    model, page, out = tmp_path / "m.toml", tmp_path / "d.html", tmp_path / "d.json"
    options = ["--out", str(model), "--report", str(page), "--json", str(out)]
    assert main(["diagnose", str(slide), *LAW, *options]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert all(str(path) in message for path in (model, page, out))
    result = json.loads(out.read_text())
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    of_kind = {"$defs": schema["$defs"], "$ref": "#/$defs/unfinished"}
    jsonschema.validate(result, of_kind)
    assert "not finished" in result["unfinished"]
    assert result["fit"]["parameters"]["F_c"]["value"] == pytest.approx(5.0, rel=0.05)
    assert jbf.Model.load(model).law == "coulomb"
    assert "F_c" in page.read_text()


@pytest.mark.parametrize("command", ["diagnose", "fit", "diagnose --many"])
@pytest.mark.parametrize("value", ["0", "-5", "soon", "3 m", "nan"])
def test_time_limit_that_is_no_positive_duration_exits_with_2(
    command: str, value: str, slide: Path, capsys: Capture
) -> None:
    folder = slide.parent if "--many" in command else slide
    assert main([*command.split(), str(folder), *LAW, "--time-limit", value]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "--time-limit" in message


def test_time_limit_reached_at_once_exits_with_2_and_names_a_longer_one(
    slide: Path, tmp_path: Path, capsys: Capture
) -> None:
    out = tmp_path / "d.json"
    options = ["--time-limit", "1 ns", "--json", str(out)]
    assert main(["diagnose", str(slide), *LAW, *options]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert re.search(r"\b\d+ s\b", message)
    result = json.loads(out.read_text())
    assert (result["verdict"], result["fit"]) == (None, None)
    assert main(["fit", str(slide), *LAW, "--time-limit", "1 ns"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_time_limit_that_is_not_reached_leaves_the_result_unchanged(
    slide: Path, tmp_path: Path
) -> None:
    results = [
        diagnosed(slide, tmp_path / "d.json", *options) for options in ([], ["--time-limit", "9 h"])
    ]
    assert [result.pop("elapsed_s") > 0.0 for result in results] == [True, True]
    assert results[0] == results[1]


@pytest.mark.extended
def test_smaller_false_alarm_rate_raises_the_threshold(slide: Path, tmp_path: Path) -> None:
    strict = diagnosed(slide, tmp_path / "d.json", "--false-alarm-rate", "1e-15")
    assert strict["effects"] == []
    assert strict["level"]["critical"] > 60.0


@pytest.mark.extended
def test_clean_recording_option_removes_the_artefact_margin(slide: Path, tmp_path: Path) -> None:
    clean = diagnosed(slide, tmp_path / "d.json", "--no-artefact-margin")
    assert (clean["machine"], clean["effects"]) == (["inertia"], [])
    assert clean["level"]["artefact_margin"] == 0.0


@pytest.mark.extended
def test_effect_below_the_minimum_effect_size_is_not_reported(slide: Path, tmp_path: Path) -> None:
    result = diagnosed(slide, tmp_path / "d.json", "--min-effect", "0.2")
    assert result["effects"] == []
    assert result["level"]["min_gain"] > result["level"]["critical"]


def detectable_kg(slide: Path, out: Path, noise_rms: float, *options: str) -> float:
    """Mass that runs of the slide reveal with a power of 80 %."""
    command = ["power", str(slide / "rig.toml"), *map(str, slide.glob("*.csv")), *LAW]
    assert main([*command, "--noise", str(noise_rms), "--json", str(out), *options]) == 0
    rows = {row["effect"]: row for row in json.loads(out.read_text())["power"]}
    assert 0.0 < rows["inertia"]["detectable_80"] < rows["inertia"]["detectable_95"]
    return float(rows["inertia"]["detectable_80"])


def test_detectable_size_grows_with_noise_and_threshold(slide: Path, tmp_path: Path) -> None:
    out = tmp_path / "power.json"
    usual = detectable_kg(slide, out, 0.1)
    assert detectable_kg(slide, out, 0.05) == pytest.approx(0.5 * usual, rel=0.15)
    assert detectable_kg(slide, out, 0.1, "--false-alarm-rate", "1e-9") > 1.3 * usual


@pytest.mark.extended
def test_power_uses_the_noise_of_a_fitted_model_by_default(slide: Path, tmp_path: Path) -> None:
    model, out = tmp_path / "model.toml", tmp_path / "power.json"
    fit = ["fit", str(slide), *LAW, "--effects", "inertia", "--out", str(model)]
    assert main(fit) == 0

    def result(*options: str) -> Any:
        assert main(["power", str(model), str(slide), "--json", str(out), *options]) == 0
        return json.loads(out.read_text())

    fitted = result()
    assert fitted["noise_rms"] == pytest.approx(NOISE_N, rel=0.05)
    assert "inertia" not in [row["effect"] for row in fitted["power"]]
    assert result("--noise", "0.5")["noise_rms"] == 0.5


@pytest.fixture(scope="module")
def odd_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four runs of a slide; the force of the last one is three times as large."""
    folder = tmp_path_factory.mktemp("odd")
    random = np.random.default_rng(5)
    time = np.arange(0.0, 20.0, 0.01)
    for k in range(4):
        v = 0.1 * np.sin((0.9 + 0.3 * k) * time + k)
        force = (3.0 if k == 3 else 1.0) * (2.0 * np.sign(v) + 15.0 * v)
        force += NOISE_N * random.standard_normal(len(time))
        jbf.Run.from_arrays(time, v, force, name=f"r{k}").write_csv(folder / f"r{k}.csv")
    (folder / "rig.toml").write_text("")
    return folder


def test_fit_prints_rms_of_held_out_runs(odd_run: Path, tmp_path: Path, capsys: Capture) -> None:
    out, rig = tmp_path / "m.toml", str(odd_run / "rig.toml")
    assert main(["fit", rig, str(odd_run), *LAW, "--hold-out", "r3", "--out", str(out)]) == 0
    model = jbf.Model.load(out)
    assert model.parameters["F_c"].value == pytest.approx(2.0, abs=0.02)
    expected = jbf.compare(model, [jbf.read_run(odd_run / "r3.csv")]).rms
    assert expected > 20.0 * NOISE_N
    assert f"RMS {expected:.4g} N" in capsys.readouterr().out


@pytest.mark.extended
def test_diagnosis_reports_the_rms_of_held_out_runs(odd_run: Path, tmp_path: Path) -> None:
    patterns = ["--hold-out", "r1", "--hold-out", "*3.csv"]
    result = diagnosed(odd_run, tmp_path / "d.json", *patterns)
    assert (result["verdict"], result["effects"]) == ("adequate", [])
    rms = {run["run"]: run["rms"] for run in result["hold_out"]["runs"]}
    assert set(rms) == {"r1", "r3"}
    assert rms["r1"] == pytest.approx(NOISE_N, rel=0.1)
    assert rms["r3"] > 20.0 * NOISE_N
