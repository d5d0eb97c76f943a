"""Command lines: invalid words, numbers and outputs are refused; no input is overwritten."""

import json
import shutil
from pathlib import Path

import pytest
from input_checks import RMS_N, Capture, accepted, cases, csv_text, refused, with_cell

OWN = """\
import jbf

def rude(velocity_m_s, k_n):
    raise SystemExit(3)

PAGE = jbf.Parameter("k_n", "N", lower=0.0, upper=10.0, null=0.0, starts=(1.0,))
jbf.register_effect(rude, parameters=[PAGE])
"""
COMPARE = "compare model.toml a.csv"
FIT = "fit rig.toml a.csv --out new.toml"
DIAG = "diagnose rig.toml a.csv "

REFUSED = {
    "option without a command": ("--", "required: COMMAND"),
    "command misspelt": ("diagnos", 'there is no command "diagnos"; did you mean "diagnose"?'),
    "option misspelt": (f"{COMPARE} --jsn x", "did you mean --json?"),
    "value missing": (f"{COMPARE} --json", "--json: expected one argument"),
    "runs missing": ("compare model.toml", "the following arguments are required: RUN"),
    "run and model swapped": ("compare a.csv model.toml", "is a CSV file where MODEL should be"),
    "law unknown": (f"{FIT} --law stribek", 'law "stribek" is not known; did you mean "stribeck"'),
    "effect unknown": (f"{FIT} --effects sensor_ofset", 'did you mean "sensor_offset"?'),
    "bootstrap a word": (f"{FIT} --bootstrap many", "invalid int value: 'many'"),
    "bootstrap few": (f"{FIT} --bootstrap 3", "--bootstrap 3 is too small for standard errors"),
    "fix nan": (f"{FIT} --fix f_m=nan", "--fix f_m=nan: is out of range"),
    "start without a value": (f"{FIT} --start f_m", "--start f_m: has no value; write NAME=VALUE"),
    "fix twice": (f"{FIT} --fix f_m=0.2 --fix f_m=0.3", "f_m is given twice; give it once"),
    "fix of another effect": (f"{FIT} --fix coulomb_drag.F_d=1", "is not known"),
    "share 0": (f"{DIAG} --false-alarm-rate 0", "--false-alarm-rate: 0 is not a probability"),
    "size -1": (f"{DIAG} --min-effect -1", "--min-effect: -1 is not an effect size"),
    "loads nan": (f"{DIAG} --loads 5 nan", "the limit load_n = nan; must be above zero"),
    "load limits reversed": (f"{DIAG} --loads 9 5", "give the smaller load first"),
    "speed 1e300": (f"{DIAG} --max-velocity 1e300", "velocity = 1e+300 is not plausible"),
    "above a day": (f"{DIAG} --next-duration-s 1e9", "duration_s = 1e+09 exceeds one day; use"),
    "plan without noise": ("plan rig.toml --max-velocity 0.2", "--noise is missing"),
    "power with zero noise": ("power rig.toml a.csv --noise 0", "noise_rms"),
    "zero jobs": ("diagnose --many many --jobs 0", "--jobs: 0 campaigns at a time; 1 or more"),
    "folder without campaigns": ("diagnose --many nowhere", "nowhere: contains no campaign"),
    "output onto the run": (f"{COMPARE} --json a.csv", "--json a.csv: is also an input"),
    "output onto a link to the run": (f"{COMPARE} --json link.csv", "is also an input"),
    "output onto the model": (f"{COMPARE} --report model.toml", "is also an input"),
    "output of many onto a run": ("diagnose --many many --json many/one/a.csv", "is also an input"),
    "one file for two outputs": (f"{COMPARE} --json x --report x", "the file of another option"),
    "output folder missing": (f"{COMPARE} --json no/x", "its folder does not exist"),
    "output link to itself": (
        f"{COMPARE} --json loop",
        "--json loop: is a link to itself",
    ),
    "a full disk": ("predict model.toml a.csv --out /dev/full", "no space left on device"),
    "import into others": ("import a.csv --map map.toml --folder many", "many: is not empty"),
    "model misspelt": ("compare modle.toml a.csv", 'not exist; did you mean "model.toml"?'),
    "run for a rig": ("diagnose rig.toml rig.toml", "where a run should be"),
    "bounds without an interval": (
        f"{FIT} --bounds f_m=0.2",
        "--bounds f_m=0.2: is not an interval; write NAME=LOW:HIGH",
    ),
    "empty bounds": (f"{FIT} --bounds f_m=0.3:0.2", "give LOW < HIGH within"),
    "bounds that are no numbers": (
        f"{FIT} --bounds f_m=a:0.2",
        "is not a number; write NAME=LOW:HIGH",
    ),
    "same run twice": (f"{COMPARE} a.csv", "is given twice"),
    "no effects file": (f"{DIAG} --effects-from no.py", "no.py: is not a file; name a Python file"),
    "effects file exits": (f"{DIAG} --effects-from ends.py", "ends.py, row 1: fails: SystemExit"),
    "effect exits": (f"{FIT} --law coulomb --effects-from own.py --effects rude", "rude fails"),
    "unknown shell": ("--completion tcsh", "tcsh"),
    "global option": ("--versoin", "unrecognized arguments: --versoin; did you mean --version?"),
    "option of fit misspelt": ("fit --efects a", "--efects; did you mean --effects?"),
    "misspelt option with a value": ("control run --shceme=a", "did you mean --scheme?"),
    "misspelt completion": ("--complet bash", "did you mean --completion?"),
    "power without noise": ("power rig.toml a.csv", "--noise is missing"),
    "hold out no run": (f"{FIT} --hold-out x*", "--hold-out x*: matches no run"),
    "hold out every run": (f"{FIT} --hold-out a*", "matches every run"),
}
REFUSED_SLOWLY = {
    "option similar to another": (f"{DIAG} --false-alarm 0.1", "did you mean --false-alarm-rate?"),
    "fix unknown": (f"{FIT} --fix fm=0.2", 'did you mean "f_m"'),
    "fix below the bounds": (f"{FIT} --fix f_m=-1", "--fix f_m=-1: is out of range"),
    "law of a model": ("power model.toml a.csv --law coulomb", "--law"),
    "many and a rig": ("diagnose rig.toml --many many", "excludes RIG, RUN and --next-run"),
    "prediction onto its motion": ("predict model.toml a.csv --out ./a.csv", "is also an input"),
    "import onto a file": ("import a.csv --map map.toml --folder a.csv", "is a file, not a folder"),
    "folder for a motion": ("predict model.toml many --out new.csv", "many: is a folder"),
    "demo in no folder": ("demo no/such", "its parent folder does not exist"),
}


@pytest.fixture(autouse=True)
def extra_files(folder: Path) -> None:
    (folder / "many" / "one").mkdir(parents=True)
    for name in ("rig.toml", "a.csv"):
        shutil.copy(folder / name, folder / "many" / "one" / name)
    shutil.copytree(folder / "many" / "one", folder / "rigs" / "rig")
    (folder / "link.csv").symlink_to("a.csv")
    (folder / "loop").symlink_to("loop")
    (folder / "own.py").write_text(OWN)
    (folder / "ends.py").write_text("raise SystemExit(3)\n")


pytestmark = pytest.mark.usefixtures("forget_user_effects")


@pytest.mark.parametrize(("words", "fragment"), cases(REFUSED | REFUSED_SLOWLY, REFUSED))
def test_invalid_command_is_refused_in_one_line(words: str, fragment: str, capfd: Capture) -> None:
    refused(words.split(), fragment, capfd)


@pytest.mark.parametrize("command", ["fit", "compare", "diagnose", "predict"])
def test_nan_in_a_run_reports_file_row_and_column(command: str, capfd: Capture) -> None:
    Path("bad.csv").write_text(with_cell(17, "velocity_m_s", "nan"))
    first = "model.toml" if command in ("compare", "predict") else "rig.toml"
    out = "--json" if command == "compare" else "--out"
    line = refused([command, first, "bad.csv", out, "new"], "nan is not a finite", capfd)
    assert line.startswith("jbf: bad.csv, row 17, column velocity_m_s: ")


def test_motion_to_predict_with_misspelt_friction_column_is_refused(capfd: Capture) -> None:
    """The friction column of a motion to predict is optional, but a misspelt name is an error."""
    Path("bad.csv").write_text(csv_text().replace("friction_n", "fricton_n"))
    words = ["predict", "model.toml", "bad.csv", "--out", "new.csv"]
    refused(words, "column fricton_n: is not a known column; did you mean", capfd)


def test_fit_is_refused_if_the_column_that_an_effect_needs_is_missing(capfd: Capture) -> None:
    words = ["fit", "rig.toml", "a.csv", "--effects", "position_ripple", "--out", "new.toml"]
    refused(words, "column angle_rad: is missing, and the effect position_ripple", capfd)


def test_fit_of_a_run_without_motion_is_refused(capfd: Capture) -> None:
    rows = ["time_s,velocity_m_s,friction_n", *(f"{i / 50},0,0" for i in range(100))]
    Path("still.csv").write_text("\n".join(rows))
    words = ["fit", "rig.toml", "still.csv", "--out", "new.toml"]
    refused(words, "still.csv: the shaft never moves", capfd)


def test_existing_output_is_replaced_without_temporary_files(folder: Path, capfd: Capture) -> None:
    words = ["compare", "model.toml", "a.csv", "--json", "out.json"]
    accepted(words, capfd)
    accepted([*words, "--report", "out.html"], capfd)
    assert json.loads((folder / "out.json").read_text())["rms"] == pytest.approx(RMS_N, rel=5e-3)
    assert "</html>" in (folder / "out.html").read_text()
    assert [p.name for p in folder.iterdir() if p.name.startswith(".")] == []


def test_prediction_can_be_written_to_the_null_device(capfd: Capture) -> None:
    accepted(["predict", "model.toml", "a.csv", "--out", "/dev/null"], capfd)
