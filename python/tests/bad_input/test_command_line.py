"""What may stand on the command line: told before the work, and no input is ever written over."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import jbf.diagnosis
import pytest
from bad_input.checking import RMS_N, Capture, accepted, compared, one_line, refused
from jbf import Limits
from jbf.cli import main

OWN = """\
import jbf

def rude(velocity_m_s, k_n):
    raise SystemExit(3)

PAGE = jbf.Parameter("k_n", "N", lower=0.0, upper=10.0, null=0.0, starts=(1.0,))
jbf.register_effect(rude, parameters=[PAGE])
"""
FIT = "fit rig.toml a.csv --out new.toml"
PLAN = "plan rig.toml --max-velocity-m-s 0.2 --noise-n 0.3 "
DIAGNOSE = "diagnose rig.toml a.csv "

REFUSED: dict[str, tuple[str, str]] = {
    # Words
    "nothing": ("", "required: COMMAND"),
    "command misspelt": ("diagnos", 'there is no command "diagnos"; did you mean "diagnose"?'),
    "command in capitals": ("FIT", 'there is no command "FIT"; did you mean "fit"?'),
    "command unknown": ("xyzzy", "known: demo, workbench, import"),
    "option misspelt": ("compare model.toml a.csv --jsn x", "did you mean --json?"),
    "option misspelt with =": ("compare model.toml a.csv --reprot=x", "did you mean --report?"),
    "option of another command": ("compare model.toml a.csv --bootstrap 20", "unrecognized argum"),
    "option cut short": (f"{FIT} --boot 20", "did you mean --bootstrap?"),
    "option twice removed": (f"{DIAGNOSE} --false-alarm 0.1", "did you mean --false-alarms?"),
    "value missing": ("compare model.toml a.csv --json", "--json: expected one argument"),
    "runs missing": ("compare model.toml", "the following arguments are required: RUN"),
    "rig missing": ("diagnose", "RIG and RUN are missing; name the rig's TOML"),
    "run missing": ("fit rig.toml --out new.toml", "RUN is missing"),
    "out missing": ("fit rig.toml a.csv", "required: --out"),
    "swapped": ("compare a.csv model.toml", "is a CSV file where MODEL should be"),
    "swapped fit": ("fit a.csv rig.toml --out n", "is a CSV file where RIG should be"),
    "law unknown": (f"{FIT} --law stribek", 'there is no law "stribek"; did you mean "stribeck"'),
    "law empty": (f"{FIT} --law=", 'there is no law ""'),
    "clock unknown": (f"{FIT} --clock wall", "--clock: invalid choice"),
    "effect unknown": (f"{FIT} --effects sensor_ofset", 'did you mean "sensor_offset"?'),
    "effect of another law": (f"{FIT} --effects dry_load_dependence", "dry_load_dependence"),
    "effect not asked": ("effects nope", 'there is no effect "nope"'),
    # Numbers
    "bootstrap a word": (f"{FIT} --bootstrap many", "invalid int value: 'many'"),
    "bootstrap a half": (f"{FIT} --bootstrap 20.5", "invalid int value: '20.5'"),
    "bootstrap few": (f"{FIT} --bootstrap 3", "--bootstrap 3 is too few to tell an error"),
    "bootstrap negative": (f"{FIT} --bootstrap -5", "--bootstrap is -5; give a whole number"),
    "bootstrap huge": (f"{FIT} --bootstrap 1000000000", "--bootstrap 1000000000 is too many"),
    "fix nothing": (f"{FIT} --fix f_m", "--fix f_m: has no value; write NAME=VALUE"),
    "fix text": (f"{FIT} --fix f_m=much", '"much" is not a number'),
    "fix nan": (f"{FIT} --fix f_m=nan", "--fix f_m=nan: is out of range"),
    "fix inf": (f"{FIT} --fix f_m=inf", "--fix f_m=inf: is out of range; choose from"),
    "fix twice": (f"{FIT} --fix f_m=0.2 --fix f_m=0.3", "f_m is fixed twice; fix it once"),
    "fix unknown": (f"{FIT} --fix fm=0.2", "--fix fm=0.2: there is no parameter"),
    "share nan": (f"{DIAGNOSE} --false-alarms nan", "--false-alarms: nan is no share"),
    "share zero": (f"{DIAGNOSE} --false-alarms 0", "--false-alarms: 0 is no share; choose from"),
    "share two": (f"{DIAGNOSE} --false-alarms 2", "--false-alarms: 2 is no share"),
    "indifference nan": (f"{DIAGNOSE} --indifference-n nan", "--indifference-n: nan is no size"),
    "indifference below": (f"{DIAGNOSE} --indifference-n -1", "--indifference-n: -1 is no size"),
    "loads nan": (f"{DIAGNOSE} --loads-n 5 nan", "the limit load_n = nan; must be above zero"),
    "loads nan first": (f"{DIAGNOSE} --loads-n nan 5", "the limit load_n = nan"),
    "loads inf": (f"{DIAGNOSE} --loads-n 5 inf", "the limit load_n = inf"),
    "loads zero": (f"{DIAGNOSE} --loads-n 0 5", "the limit load_n = 0; must be above zero"),
    "loads turned": (f"{DIAGNOSE} --loads-n 9 5", "give the smaller load first"),
    "one load": (f"{DIAGNOSE} --loads-n 5", "--loads-n: expected 2 arguments"),
    "temperatures nan": (f"{DIAGNOSE} --temperatures-c 5 nan", "the limit temperature_c"),
    "temperatures turned": (f"{DIAGNOSE} --temperatures-c 9 5", "the lower first"),
    "speed zero": (f"{DIAGNOSE} --max-velocity-m-s 0", "the limit velocity_m_s = 0; must be"),
    "speed inf": (f"{DIAGNOSE} --max-velocity-m-s inf", "the limit velocity_m_s = inf"),
    "speed 1e300": (f"{DIAGNOSE} --max-velocity-m-s 1e300", "velocity_m_s = 1e+300 is beyond"),
    "sharp nan": (f"{DIAGNOSE} --max-acceleration-m-s2 nan", "the limit acceleration_m_s2 = nan"),
    "long": (f"{DIAGNOSE} --next-duration-s 1e9", "duration_s = 1e+09 is more than a day; ask"),
    "endless": (f"{DIAGNOSE} --next-duration-s 1e300", "the limit duration_s = 1e+300 is"),
    "never": (f"{DIAGNOSE} --next-duration-s nan", "the limit duration_s = nan; must be above"),
    "no time": (f"{DIAGNOSE} --next-duration-s 0", "the limit duration_s = 0; must be above"),
    "plan minutes nan": (f"{PLAN} --minutes nan", "minutes: nan is not above zero"),
    "plan minutes zero": (f"{PLAN} --minutes 0", "minutes: 0 is not above zero"),
    "plan for ever": (f"{PLAN} --minutes 1e300", "minutes"),
    "plan no noise": ("plan rig.toml --max-velocity-m-s 0.2", "--noise-n is missing; say how"),
    "plan noise nan": ("plan rig.toml --max-velocity-m-s 0.2 --noise-n nan", "noise_n: nan is"),
    "plan run long": (f"{PLAN} --run-s 1e9", "duration_s = 1e+09 is more than a day"),
    "plan step zero": (f"{PLAN} --step-s 0", "step_s: 0 is not above zero"),
    "plan for a week": (f"{PLAN} --minutes 1e4", "hold more than 200 runs of 60 s; give less"),
    "power noise zero": ("power rig.toml a.csv --noise-n 0", "noise_n"),
    "power noise nan": ("power rig.toml a.csv --noise-n nan", "noise_n"),
    "power noise 1e300": ("power rig.toml a.csv --noise-n 1e300", "noise_n"),
    "jobs none": ("diagnose --many many --jobs 0", "--jobs: 0 campaigns at a time; 1 or more"),
    "check none": ("check model.toml a.csv -n 0 --jobs 1", "campaigns"),
    "held out none": (f"{FIT} --hold-out x*", "--hold-out x*: fits no run; there are a"),
    "held out all": (f"{FIT} --hold-out *", "--hold-out *: fits every run; leave some"),
    "task unknown": ("control run --task wobble", 'there is no task "wobble"'),
    "noise negative": ("control run --noise-times -1", "--noise-times -1 is no factor"),
    "counts zero": ("control run --counts-per-rad 0 --seconds 1", "counts_per_rad"),
    "seconds nan": ("control run --seconds nan", "nan s with 2.0 s left out is no run; give up to"),
    "seconds 1e300": ("control run --seconds 1e300", "1e+300 s with 2.0 s left out is no run"),
    "motor nan": ("control run --volts-per-n nan --seconds 1", "volts_per_n"),
    # Many rigs
    "many none": ("diagnose --many nowhere", "nowhere: holds no campaign"),
    "many a file": ("diagnose --many a.csv", "a.csv: holds no campaign"),
    "many and a rig": ("diagnose rig.toml --many many", "takes neither RIG nor RUN nor --next-run"),
    # Outputs
    "onto the run": ("compare model.toml a.csv --json a.csv", "--json a.csv: is also an input"),
    "onto the run by a detour": ("compare model.toml a.csv --json many/../a.csv", "also an input"),
    "onto the run by a link": ("compare model.toml a.csv --json link.csv", "is also an input"),
    "onto the model": ("compare model.toml a.csv --report model.toml", "is also an input"),
    "onto the map": ("compare model.toml a.csv --map map.toml --json map.toml", "also an input"),
    "onto the rig": ("fit rig.toml a.csv --out rig.toml", "--out rig.toml: is also an input"),
    "onto a rig in a folder": ("diagnose many/one --json many/one/rig.toml", "is also an input"),
    "onto a run in a folder": ("diagnose many/one --out many/one/a.csv", "is also an input"),
    "onto own effects": (f"{DIAGNOSE} --effects-from own.py --json own.py", "is also an input"),
    "plan onto the rig": (f"{PLAN} --json rig.toml", "--json rig.toml: is also an input"),
    "power onto a run": ("power rig.toml many/one --noise-n 1 --json many/one/a.csv", "an input"),
    "check onto a run": ("check model.toml many/one --resume many/one/a.csv", "an input"),
    "cut onto the map": ("import a.csv --map map.toml --plot map.toml", "is also an input"),
    "export onto the model": ("export model.toml --rust model.toml", "is also an input"),
    "many onto a rig": ("diagnose --many many --json many/one/rig.toml", "is also an input"),
    "many onto a run": ("diagnose --many many --json many/one/a.csv", "is also an input"),
    "many onto the only rig": ("diagnose --many rigs --out rigs/rig", "is also an input"),
    "motion onto itself": ("predict model.toml a.csv --out ./a.csv", "is also an input"),
    "two of one": ("compare model.toml a.csv --json x --report x", "the file of another option"),
    "nameless": ("compare model.toml a.csv --json=", "--json : is not a file name; name a file"),
    "a folder": ("compare model.toml a.csv --json many", "--json many: is a folder; name a file"),
    "no folder": ("compare model.toml a.csv --json no/x", "its folder does not exist; make"),
    "a file as folder": ("compare model.toml a.csv --json a.csv/x", "its folder does not exist"),
    "a loop": (
        "compare model.toml a.csv --json loop",
        "--json loop: is a link that leads to itself; name another",
    ),
    "a full disk": ("predict model.toml a.csv --out /dev/full", "no space left on device"),
    "a full disk beside": (
        "compare model.toml a.csv --json new.json --report /dev/full",
        "/dev/full: cannot be written (no space left on device)",
    ),
    "a long name": (f"compare model.toml a.csv --json {'n' * 300}", "file name too long"),
    "no picture": ("import a.csv --map map.toml --plot new.txt", "new.txt"),
    "import onto a file": ("import a.csv --map map.toml --out a.csv", "is a file, not a folder"),
    "import onto others": ("import a.csv --map map.toml --out many", "many: holds other files"),
    "import a folder": ("import many --map map.toml --out new", "many: is a folder"),
    "demo onto a file": ("demo a.csv", "DIR a.csv: is a file, not a folder"),
    # Own effects
    "own absent": (f"{DIAGNOSE} --effects-from no.py", "no.py: is no file; name a Python file"),
    "own a model": (f"{DIAGNOSE} --effects-from model.toml", "model.toml, row"),
    "own that ends": (f"{DIAGNOSE} --effects-from ends.py", "ends.py, row 1: fails: SystemExit"),
    "own that exits": (f"{FIT} --law coulomb --effects-from own.py --effects rude", "rude fails"),
}


@pytest.fixture(autouse=True)
def more(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Folders of campaigns, links, effects; and no diagnosis, which is long, is ever begun."""
    (folder / "many" / "one").mkdir(parents=True)
    for name in ("rig.toml", "a.csv"):
        shutil.copy(folder / name, folder / "many" / "one" / name)
    shutil.copytree(folder / "many" / "one", folder / "rigs" / "rig")
    (folder / "link.csv").symlink_to("a.csv")
    (folder / "loop").symlink_to("loop")
    (folder / "own.py").write_text(OWN)
    (folder / "ends.py").write_text("raise SystemExit(3)\n")

    def work(*_: object, **__: object) -> None:
        raise AssertionError("the long work began")

    monkeypatch.setattr(jbf.diagnosis, "diagnose", work)
    monkeypatch.setattr(jbf.diagnosis, "diagnose_many", work)


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    """What a command has registered stays: no other test may meet it."""
    yield
    with suppress(jbf.InputError):
        jbf.forget_effect("rude")


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_and_nothing_written(name: str, capfd: Capture) -> None:
    words, fragment = REFUSED[name]
    refused(words.split(), fragment, capfd)


def test_a_second_answer_is_written_over_the_first(folder: Path, capfd: Capture) -> None:
    for _ in range(2):
        accepted(
            ["compare", "model.toml", "a.csv", "--json", "out.json", "--report", "out.html"], capfd
        )
    assert json.loads((folder / "out.json").read_text())["rms_n"] == pytest.approx(RMS_N, rel=5e-3)
    assert "</html>" in (folder / "out.html").read_text()
    assert [p.name for p in folder.iterdir() if p.name.startswith(".")] == []


def test_an_output_may_be_a_device(capfd: Capture) -> None:
    accepted(["predict", "model.toml", "a.csv", "--out", "/dev/null"], capfd)
    assert compared("a.csv", capfd)["rms_n"] == pytest.approx(RMS_N, rel=5e-3)


def test_help_and_version(capfd: Capture) -> None:
    for words in (["--help"], ["--version"], ["fit", "--help"]):
        assert main(words) == 0
        assert capfd.readouterr().err == ""


def test_limits_in_python() -> None:
    one_line(lambda: Limits(load_n=(5.0, float("nan"))), "load_n = nan")
    one_line(lambda: Limits(duration_s=1e300), "duration_s = 1e+300")
    assert Limits(duration_s=86400.0).duration_s == 86400.0
