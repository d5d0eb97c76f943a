"""Bad input: exit 2, one line on stderr that names the place, and no output written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import jbf.comparison.comparison
import jbf.estimation.fit
import pytest
from jbf import Fit
from jbf.cli import main

Edit = Callable[[str], str]
Refused = Callable[..., str]


@pytest.fixture
def refused(
    campaign: Path,
    full_fit: Fit,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> Refused:
    """Run a command in the campaign's folder; gives the one line that it was refused with."""
    full_fit.model.save(campaign / "model.toml")
    monkeypatch.chdir(campaign)

    def check(*arguments: str) -> str:
        before = {p: p.read_bytes() for p in campaign.rglob("*") if p.is_file()}
        assert main(list(arguments)) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.endswith("\n")
        assert said.err.count("\n") == 1
        assert said.err.startswith("jbf: ")
        assert {p: p.read_bytes() for p in campaign.rglob("*") if p.is_file()} == before
        return said.err.strip()

    return check


def edit(path: str, change: Edit) -> None:
    file = Path(path)
    file.write_text(change(file.read_text()))


def in_cell(row: int, column: str, text: str) -> Edit:
    """Put text into a cell; the header is row 1."""

    def change(content: str) -> str:
        lines = content.splitlines()
        cells = lines[row - 1].split(",")
        cells[lines[0].split(",").index(column)] = text
        lines[row - 1] = ",".join(cells)
        return "\n".join(lines) + "\n"

    return change


def swap(old: str, new: str) -> Edit:
    """Replace every occurrence of a text that must be there."""

    def change(content: str) -> str:
        assert old in content
        return content.replace(old, new)

    return change


RUN = "runs/stopgo.csv"
FIT = ("fit", "rig.toml", "runs", "--out", "new.toml")
OUTPUTS = ("--json", "new.json", "--report", "new.html")

BAD_RUNS = [
    pytest.param(
        swap("friction_n", "fricton_n"),
        'column friction_n: is missing; did you mean "fricton_n"?',
        id="misspelt",
    ),
    pytest.param(
        swap("angle_rad,velocity_m_s", "winding,comment"),
        "row 1, column velocity_m_s: is missing",
        id="missing",
    ),
    pytest.param(
        in_cell(17, "friction_n", "abc"),
        'row 17, column friction_n: "abc" is not a number',
        id="text",
    ),
    pytest.param(
        in_cell(17, "velocity_m_s", "nan"),
        "row 17, column velocity_m_s: nan is not a finite",
        id="nan",
    ),
    pytest.param(
        in_cell(17, "friction_n", ""),
        "row 17, column friction_n: the cell is empty",
        id="hole",
    ),
    pytest.param(
        in_cell(17, "time_s", "0.1"),
        "row 17, column time_s: time runs back",
        id="back",
    ),
    pytest.param(
        in_cell(17, "time_s", "0.28"),
        "row 17, column time_s: time repeats at 0.28",
        id="repeat",
    ),
    pytest.param(
        in_cell(17, "load_n", "0"),
        "row 17, column load_n: a load of 0.0 N is not above zero",
        id="load",
    ),
    pytest.param(
        lambda _: "",
        "is empty; start with a header",
        id="empty",
    ),
    pytest.param(
        lambda s: s.splitlines()[0] + "\n",
        "has a header but no samples",
        id="header",
    ),
    pytest.param(
        lambda s: "\n".join(s.splitlines()[:5]),
        "has 4 samples; a run needs at least 10",
        id="short",
    ),
]

BAD_RIGS = [
    pytest.param(
        swap("radius_m", "radius"),
        "key bearing.radius: is not known; did you mean",
        id="unknown",
    ),
    pytest.param(
        swap("count = 4\n", ""),
        "key bearing.count: is missing",
        id="missing",
    ),
    pytest.param(
        swap("mass_kg = 2.27", "mass_kg = -2.27"),
        "key bearing.mass_kg: -2.27 is not above zero",
        id="range",
    ),
    pytest.param(
        swap("0.002", '"thin"'),
        'key lubricant.viscosity_pa_s: "thin" is not a number',
        id="text",
    ),
    pytest.param(
        swap("normal_n = 104.0", "normal_n = 0"),
        "key load.normal_n: 0.0 is not above zero",
        id="load",
    ),
    pytest.param(
        lambda s: s.partition("[load]")[0],
        "rig.toml: the rig has no [load]",
        id="section",
    ),
    pytest.param(
        lambda s: s + "[",
        "is not TOML",
        id="syntax",
    ),
]

BAD_MODELS = [
    pytest.param(
        swap("f_m = {value", "f_n = {value"),
        'key parameters.f_n: is not known; did you mean "f_m"?',
        id="parameter",
    ),
    pytest.param(
        swap("coulomb_drag", "coulomb_darg"),
        'key effects: "coulomb_darg" is not known; did you mean',
        id="effect",
    ),
    pytest.param(
        swap("F_d_n = {value = ", "F_d_n = {value = -"),
        "key parameters.coulomb_drag.F_d_n: -",
        id="range",
    ),
    pytest.param(
        swap("format = 1", "format = 9"),
        "key format: is not one this jbf reads",
        id="format",
    ),
    pytest.param(
        swap('"journal"\neff', '"jurnal"\neff'),
        'key clock: "jurnal" is not known',
        id="clock",
    ),
    pytest.param(
        swap('law = "journal"', 'law = "jurnal"'),
        'key law: "jurnal" is not known',
        id="law",
    ),
    pytest.param(
        swap("radius_m = 0.0127", "radius_m = 0.0"),
        "key rig.bearing.radius_m: 0.0 is not",
        id="rig",
    ),
]


@pytest.mark.parametrize(("change", "told"), BAD_RUNS)
@pytest.mark.parametrize("command", ["fit", "compare", "diagnose", "predict"])
def test_bad_run(command: str, change: Edit, told: str, refused: Refused) -> None:
    edit(RUN, change)
    if command == "predict":
        if "friction_n: is missing" in told:
            # A motion need not hold friction, but a slip of the pen is still told.
            told = "column fricton_n: is not a known column; did you mean"
        line = refused("predict", "model.toml", RUN, "--out", "new.csv")
    elif command == "fit":
        line = refused(*FIT)
    else:
        first = {"compare": "model.toml", "diagnose": "rig.toml"}[command]
        line = refused(command, first, "runs", *OUTPUTS)
    assert line.startswith(f"jbf: {RUN}")
    assert told in line


@pytest.mark.parametrize(("change", "told"), BAD_RIGS)
def test_bad_rig(change: Edit, told: str, refused: Refused) -> None:
    edit("rig.toml", change)
    for line in (refused(*FIT), refused("diagnose", "rig.toml", "runs", *OUTPUTS)):
        assert line.startswith("jbf: rig.toml")
        assert told in line


@pytest.mark.parametrize(("change", "told"), BAD_MODELS)
def test_bad_model(change: Edit, told: str, refused: Refused) -> None:
    edit("model.toml", change)
    for line in (
        refused("compare", "model.toml", "runs", *OUTPUTS),
        refused("predict", "model.toml", RUN, "--out", "new.csv"),
    ):
        assert line.startswith("jbf: model.toml")
        assert told in line


def test_the_wrong_kind_of_file_is_told_apart(refused: Refused) -> None:
    line = refused("compare", "rig.toml", "runs")
    assert "rig.toml: is a rig, not a model file; make a model first: jbf fit" in line
    line = refused("diagnose", "model.toml", "runs")
    assert "model.toml: is a model file, not a rig" in line
    assert "where RIG should be" in refused("fit", RUN, "rig.toml", "--out", "new.toml")
    assert "where a run should be" in refused("diagnose", "rig.toml", "rig.toml")
    assert "where MODEL should be" in refused("predict", RUN, "model.toml", "--out", "new.csv")


def test_missing_files(refused: Refused) -> None:
    assert refused("compare", "modle.toml", "runs") == (
        'jbf: modle.toml: the file does not exist; did you mean "model.toml"?'
    )
    assert "rigg.toml: the file does not exist" in refused("diagnose", "rigg.toml", "runs")
    assert "stopgoo.csv: the file does not exist" in refused(
        "compare", "model.toml", "runs/stopgoo.csv"
    )
    assert "no file matches" in refused("compare", "model.toml", "runs/*.txt")
    assert "is given twice" in refused("compare", "model.toml", RUN, RUN)
    Path("none").mkdir()
    assert "holds no .csv file" in refused("diagnose", "rig.toml", "none")
    assert "runs: is a folder" in refused("predict", "model.toml", "runs", "--out", "new.csv")


def test_unknown_names(refused: Refused) -> None:
    assert 'there is no effect "coulomb"; did you mean "coulomb_drag"?' in refused(
        *FIT, "--effects", "coulomb"
    )
    assert 'there is no effect "nope"' in refused("effects", "nope")
    assert 'there is no law "stribek"' in refused(*FIT, "--law", "stribek")
    assert "--clock" in refused(*FIT, "--clock", "wall")
    assert 'there is no command "diagnos"; did you mean "diagnose"?' in refused("diagnos")
    assert "unrecognized arguments: --jsn" in refused("compare", "model.toml", "runs", "--jsn")
    assert "required: COMMAND" in refused()


@pytest.mark.parametrize(
    ("item", "told"),
    [
        ("f_m", "--fix f_m: has no value"),
        ("fm=0.2", "--fix fm=0.2: there is no parameter"),
        ("f_m=much", '--fix f_m=much: "much" is not a number'),
        ("f_m=nan", "--fix f_m=nan: is out of range"),
        ("f_m=-1", "--fix f_m=-1: is out of range; choose from"),
        ("coulomb_drag.F_d_n=1", "there is no parameter"),
    ],
)
def test_bad_fix(item: str, told: str, refused: Refused) -> None:
    assert told in refused(*FIT, "--fix", item)


def test_a_column_that_an_effect_needs(refused: Refused) -> None:
    edit(RUN, lambda s: s.replace("angle_rad", "winding", 1))
    line = refused(*FIT, "--effects", "position_ripple")
    assert line.startswith(f"jbf: {RUN}, column angle_rad: is missing, and the effect position_rip")


def test_a_run_in_which_nothing_moves(refused: Refused) -> None:
    rows = ["time_s,velocity_m_s,friction_n", *(f"{i / 50},0,0" for i in range(100))]
    edit(RUN, lambda _: "\n".join(rows))
    assert f"{RUN}: the shaft never moves" in refused(*FIT)


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("no/such/new.x", "its folder does not exist"),
        (".", "is a folder"),
        (RUN, "is also an input"),
        ("", "is not a file name"),
        ("n" * 300, "cannot be written (file name too long)"),
        ("rig.toml/new.x", "its folder does not exist"),
    ],
    ids=["no folder", "folder", "input", "nameless", "long", "file as folder"],
)
def test_outputs_are_refused_before_the_work(
    path: str, told: str, refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*_: object, **__: object) -> None:
        raise AssertionError("the long work began")

    monkeypatch.setattr(jbf.estimation.fit, "fit", work)
    monkeypatch.setattr(jbf.comparison.comparison, "compare", work)
    monkeypatch.setattr(jbf.diagnosis, "diagnose", work)
    for option, command in [
        ("--out", ("fit", "rig.toml", "runs")),
        ("--json", ("compare", "model.toml", "runs")),
        ("--report", ("compare", "model.toml", "runs", "--json", "-")),
        ("--out", ("diagnose", "rig.toml", "runs", "--json", "new.json")),
        ("--out", ("predict", "model.toml", RUN)),
    ]:
        line = refused(*command, option, path)
        assert line.startswith(f"jbf: {option} {path}".rstrip())
        assert told in line


def test_two_outputs_may_not_share_a_file(refused: Refused) -> None:
    line = refused("compare", "model.toml", "runs", "--json", "new.x", "--report", "./new.x")
    assert "is also the file of another option" in line
    assert "--out rig.toml: is also an input" in refused(
        "fit", "rig.toml", "runs", "--out", "rig.toml"
    )


def test_demo_wants_a_folder(refused: Refused) -> None:
    assert "DIR rig.toml: is a file, not a folder" in refused("demo", "rig.toml")
    assert "its parent folder does not exist" in refused("demo", "no/such")


def test_too_few_fits_for_an_error(refused: Refused) -> None:
    line = refused("fit", "rig.toml", "runs", "--bootstrap", "3", "--out", "new.toml")
    assert line == (
        "jbf: --bootstrap 3 is too few to tell an error; ask for 19 or more; 40 tell it better"
    )
