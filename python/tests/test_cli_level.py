"""`--false-alarms` and `--indifference-n` of `jbf diagnose` and `jbf power`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from by_hand import coulomb, four_runs
from jbf.cli import main

MASS_KG = 0.05


@pytest.fixture
def slide(tmp_path: Path) -> Path:
    """Four runs of a slide with a small mass beside a noise of 0.1 N."""
    folder = tmp_path / "slide"
    folder.mkdir()
    for run in four_runs(lambda t, v, a: coulomb(t, v, a) + MASS_KG * a, noise_n=0.1):
        run.write_csv(folder / f"{run.name}.csv")
    (folder / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    return folder


def named(slide: Path, *options: str) -> tuple[list[str], dict[str, float]]:
    out = slide.parent / "out.json"
    command = ["diagnose", str(slide), "--law", "coulomb", "--json", str(out), *options]
    assert main(command) == 0
    found = json.loads(out.read_text())
    return found["effects"], found["level"]


def test_an_effect_is_named_by_the_level_that_is_asked_for(slide: Path) -> None:
    effects, level = named(slide)
    assert effects == ["inertia_leak"]
    assert level["false_alarms"] == 0.01
    assert level["blocks"] > 0
    assert level["chance"] <= 0.01 / level["candidates"]
    effects, dear = named(slide, "--false-alarms", "1e-15")
    assert effects == []
    assert dear["critical"] > 60.0 > level["critical"]
    # Of a recording that is known to be clean only noise can be mistaken for an effect.
    clean = named(slide, "--clean-recording")[1]
    assert clean["imperfection"] == 0.0 < level["imperfection"]
    # Nobody would act on 0.2 N.
    effects, large = named(slide, "--indifference-n", "0.2")
    assert effects == []
    assert large["worth"] > large["critical"]


def test_what_planned_runs_show_depends_on_it(
    slide: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def found(*options: str) -> float:
        out = slide.parent / "power.json"
        command = ["power", str(slide / "rig.toml"), *map(str, slide.glob("*.csv"))]
        command += ["--law", "coulomb", "--noise-n", "0.1", "--json", str(out), *options]
        assert main(command) == 0
        rows = {row["effect"]: row for row in json.loads(out.read_text())["power"]}
        return float(rows["inertia_leak"]["found_80"])

    usual = found()
    assert found("--false-alarms", "1e-9") > 1.3 * usual
    assert "noise makes a name in at most 1e-07 % of such campaigns" in capsys.readouterr().out
    assert found("--indifference-n", "0.05") > 2.0 * usual


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--false-alarms", "0"], "--false-alarms: 0 is no share"),
        (["--false-alarms", "1"], "choose from 0 to 1"),
        (["--false-alarms", "nan"], "nan is no share"),
        (["--indifference-n", "-1"], "--indifference-n: -1 is no size"),
        (["--indifference-n", "inf"], "inf is no size"),
    ],
)
def test_what_is_no_share_and_no_size(
    slide: Path, options: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["diagnose", str(slide), *options]) == 2
    said = capsys.readouterr().err
    assert words in said
    assert len(said.strip().splitlines()) == 1


def test_a_model_has_its_law(slide: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = slide.parent / "model.toml"
    assert main(["fit", str(slide), "--law", "coulomb", "--out", str(model)]) == 0
    runs = [str(p) for p in slide.glob("*.csv")]
    assert main(["power", str(model), *runs, "--law", "coulomb"]) == 2
    assert "--law" in capsys.readouterr().err
