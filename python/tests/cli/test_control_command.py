"""`jbf control`: tables, files and plots of simulated compensation; invalid arguments."""

import csv
import json
import math
from pathlib import Path

import pytest
from input_checks import Capture, refused
from jbf import Drive, Model, Rig
from jbf.cli import main


@pytest.fixture(autouse=True)
def folder(working_folder: Path) -> None:
    """Write two models, wrong settings and a motion into the working folder."""
    Model(Rig.thesis("4.2")).save("model.toml")
    Model(Rig.thesis("4.2"), law="lugre").save("lugre.toml")
    Model(Rig(drive=Drive("linear", "force")), law="coulomb").save("linear.toml")
    Path("wrong.toml").write_text("bandwidth = 3\n")
    speed = [0.02 * math.sin(0.02 * i) for i in range(300)]
    rows = [f"{0.02 * i:.2f},{v:.6f}" for i, v in enumerate(speed)]
    Path("run.csv").write_text("\n".join(["time_s,velocity_m_s", *rows]) + "\n")


def test_control_without_an_action_prints_its_help(capsys: Capture) -> None:
    assert main(["control"]) == 0
    printed = capsys.readouterr()
    assert "robustness" in printed.out
    assert printed.err == ""


def test_control_run_prints_every_scheme_and_writes_a_png(capsys: Capture) -> None:
    run = ["control", "run", "model.toml", "--task", "position sine", "--seconds", "5"]
    assert main([*run, "--plot", "p.png"]) == 0
    out = capsys.readouterr().out
    for word in ("none", "learning", "coulomb", "observed", "RMS, rad", "true RMS"):
        assert word in out
    assert Path("p.png").read_bytes().startswith(b"\x89PNG")


def test_control_run_writes_one_csv_row_for_each_sample() -> None:
    assert main(["control", "run", "--scheme", "observed", "--seconds", "4", "--csv", "r.csv"]) == 0
    with open("r.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2000
    assert float(rows[-1]["time_s"]) == pytest.approx(3.998)
    assert {"estimated_friction_v", "friction_v", "status"} <= set(rows[0])


def test_control_run_uses_a_recorded_motion_as_the_reference(capsys: Capture) -> None:
    assert main(["control", "run", "model.toml", "--motion", "run.csv"]) == 0
    assert "recorded -1.57 to 1.57 rad/s, 5.98 s" in capsys.readouterr().out


def test_control_run_omits_the_learning_scheme_for_a_law_without_a_film(capsys: Capture) -> None:
    assert main(["control", "run", "lugre.toml", "--seconds", "4"]) == 0
    assert "learning" not in capsys.readouterr().out


def test_control_run_has_the_same_result_with_tuned_and_without_settings(capsys: Capture) -> None:
    assert main(["control", "tune", "model.toml", "--toml", "s.toml"]) == 0
    run = ["control", "run", "model.toml", "--scheme", "observed", "--seconds", "5"]
    capsys.readouterr()
    assert main(run) == 0
    plain = capsys.readouterr().out
    assert main([*run, "--settings", "s.toml"]) == 0
    assert capsys.readouterr().out.split()[-6:-4] == plain.split()[-6:-4]


@pytest.mark.extended
def test_control_robustness_writes_json_and_reports_no_harmful_case(capsys: Capture) -> None:
    assert main(["control", "robustness", "model.toml", "--json", "r.json"]) == 0
    cases = json.loads(Path("r.json").read_text())["cases"]
    assert {"name", "ratios", "worst", "verdict"} <= set(cases[0])
    assert {c["verdict"] for c in cases} <= {"help", "neutral"}
    assert "harm 0" in capsys.readouterr().out


@pytest.mark.extended
def test_control_tables_reproduce_12_published_cells_within_a_factor_of_2(capsys: Capture) -> None:
    assert main(["control", "tables", "--json", "t.json", "--plot", "t.svg"]) == 0
    result = json.loads(Path("t.json").read_text())
    assert result["within_2"] >= 12
    assert len(result["cells"]) == 28
    assert min(result["times_better"].values()) > 1.3
    assert {"scale 3.5 V", "scale 25.5 V, as listed"} <= {a["name"] for a in result["assumptions"]}
    out = capsys.readouterr().out
    assert " 13 cells" in out
    assert "in 7 of 7 rows" in out


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        ("run --scheme magic", ["magic", "observed"]),
        ("run lugre.toml --scheme learning", ["lugre"]),
        ("run --task circle", ["circle", "velocity sine"]),
        ("run --seconds nan", ["nan"]),
        ("run --frequency-rad-s 0", ["frequency"]),
        ("run --settings wrong.toml", ["wrong.toml", "bandwidth"]),
        ("run --csv x.csv", ["--csv", "one scheme"]),
        ("run model.toml --scheme none --csv model.toml", ["model.toml", "input"]),
        ("run --motion run.csv --high 2", ["--high", "--motion"]),
        ("run --motion run.csv --control position", ["run.csv", "angle_rad"]),
        ("run --counts-per-rad 1e12", ["roll-over", "counts_per_rad"]),
        ("run --noise-times -1", ["--noise-times"]),
        ("tune model.toml --limit-v 0.1", ["0.1 V"]),
        ("run linear.toml", ["linear drive", "rotary", "jbf export"]),
        ("run model.toml --carried linear.toml", ["linear drive"]),
        ("tune linear.toml --toml s.toml", ["linear drive"]),
        ("robustness linear.toml", ["linear drive"]),
        ("robustness model.toml --json model.toml", ["input"]),
    ],
)
def test_invalid_control_argument_is_refused_and_changes_no_file(
    arguments: str, fragments: list[str], capsys: Capture
) -> None:
    line = refused(["control", *arguments.split()], "", capsys)
    for fragment in fragments:
        assert fragment in line
