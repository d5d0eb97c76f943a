"""A run: what is selected, written, converted; files, folders and names; each refusal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Rig, Run
from jbf.records.csv_file import _by_its_own_clock, _near_miss, read_run
from jbf.records.drive import Drive
from jbf.records.folder import campaigns_in, read_campaign
from jbf.records.quantities import LINEAR, OF_BEARING, ROTARY
from jbf.records.run import _made_speed, _whole, require, run_on
from jbf.records.run_files import _unique_names, read_runs

N = 20
TIME: Any = 0.1 * np.arange(N)
RUN = Run.from_arrays(
    TIME, TIME + 1.0, 2.0 * TIME, angle_rad=3.0 * TIME, extra={"own": 4.0 * TIME}, name="a"
)


def refusal(ask: Callable[..., Any], *given: Any, **named: Any) -> str:
    """The one line of an error."""
    with pytest.raises(InputError) as caught:
        ask(*given, **named)
    return str(caught.value)


def test_a_run_in_a_line_its_length_and_its_columns() -> None:
    """Known columns first, under the names that tell their units."""
    assert repr(RUN) == (
        "Run('a', 20 samples, 1.9 s: time_s, angle_rad, velocity_m_s, friction_n, own)"
    )
    assert len(RUN) == 20
    assert RUN.duration_s == pytest.approx(1.9)
    turned = replace(RUN, quantities=ROTARY)
    assert repr(turned).endswith("time_s, angle_rad, velocity_rad_s, torque_n_m, own)")
    assert turned.to_csv().startswith("time_s,angle_rad,velocity_rad_s,torque_n_m,own\n")
    assert "velocity_m_s" not in replace(RUN, speed_recorded=False).columns()
    assert RUN.select(slice(0, 0)).duration_s == 0.0
    assert RUN.select(slice(3, 4)).duration_s == 0.0


def test_a_selection_is_a_run_of_all_columns() -> None:
    """By a slice or a mask; where a channel was read goes with it."""
    read = {"friction_n": np.arange(N) % 2 == 0, "own": np.arange(N) > 5}
    run = replace(RUN, read=read)
    some = run.select(slice(2, 12, 3))
    assert some.time_s.tolist() == TIME[2:12:3].tolist()
    for name, values in run.columns().items():
        assert some.columns()[name].tolist() == values[2:12:3].tolist()
        assert not some.columns()[name].flags.writeable
    assert some.read["friction_n"].tolist() == [True, False, True, False]
    assert some.read["own"].tolist() == [False, False, True, True]
    assert set(run.select(np.arange(N) > 5).read) == {"friction_n"}
    unread = replace(RUN, speed_recorded=False).select(slice(0, 3))
    assert unread.velocity_m_s.tolist() == [1.0, 1.1, 1.2]


@pytest.mark.parametrize(
    ("which", "said"),
    [
        (slice(None, None, -1), "a: a selection cannot run backwards; use a step > 0"),
        (slice(None, None, 0), "a: a selection cannot run backwards"),
        (np.arange(3), "a: a mask of int64 and shape (3,) cannot select; give a slice or a boolean "
         "mask of shape (20,)"),
        (np.ones(19, dtype=bool), "a: a mask of bool and shape (19,) cannot select"),
        (np.ma.masked_array(np.ones(N, dtype=bool), mask=[True] + [False] * 19), "a: a mask of bo"),
    ],
)  # fmt: skip
def test_what_selects_nothing(which: Any, said: str) -> None:
    """A step of one selects."""
    assert refusal(RUN.select, which).startswith(said)
    assert len(RUN.select(slice(None, None, 1))) == N


def test_a_run_of_arrays_needs_a_time_and_a_motion() -> None:
    """A known column is no extra one."""
    assert refusal(Run.from_arrays, None, TIME) == (
        "run, column time_s: is None; give the instants, s"
    )
    assert refusal(Run.from_arrays, TIME, None, TIME) == (
        "run, column velocity_m_s: is missing, and no position tells the motion; "
        "give one of velocity_m_s, position_m, angle_rad"
    )
    assert refusal(Run.from_arrays, TIME, TIME, extra={"load_n": TIME}, name="b") == (
        "b, column load_n: is a known column, not an extra one; pass it as its own argument"
    )
    assert Run.from_arrays(TIME, TIME, path="f.csv").path == Path("f.csv")
    assert Run.from_arrays(TIME, TIME).path is None
    assert refusal(Run.from_frame, {"velocity_m_s": TIME, "v": TIME}, name="f") == (
        "f, column time_s: is missing; call a column so (it has velocity_m_s, v)"
    )


def test_a_run_of_channels_or_of_a_frame_knows_its_name_and_its_file() -> None:
    """A column of which much is missing has a clock of its own."""
    channels = {"velocity_m_s": (TIME, TIME), "own": (TIME[::2], TIME[::2])}
    for path in (None, Path("f.csv")):
        run = Run.from_channels(channels, name="c", path=path)
        assert (run.name, run.path) == ("c", path)
        assert set(run.read) == {"own"}
        frame = {"time_s": TIME, "velocity_m_s": TIME, "friction_n": TIME, "own": 2.0 * TIME}
        run = Run.from_frame(frame, name="d", path=path)
        assert (run.name, run.path, run.read) == ("d", path, {})
        np.testing.assert_array_equal(run.extra["own"], 2.0 * TIME)
        assert run.friction_n is not None
        frame["own"] = np.where(np.arange(N) < 10, np.nan, TIME)
        run = Run.from_frame(frame, name="e", path=path)
        assert (run.name, run.path, set(run.read)) == ("e", path, {"own"})
    with pytest.raises(InputError, match="a, column load_n: sample 0: a load of"):
        Run.from_channels({"velocity_m_s": (TIME, TIME), "load_n": (TIME, TIME)}, name="a")


def test_a_speed_that_was_not_recorded_is_that_of_the_position() -> None:
    """By central differences; an angle alone tells none."""
    run = Run.from_arrays(TIME, position_m=TIME**2)
    assert not run.speed_recorded
    np.testing.assert_allclose(run.velocity_m_s[1:-1], 2.0 * TIME[1:-1])
    assert np.isnan(Run.from_arrays(TIME, angle_rad=TIME).velocity_m_s).all()
    made = _made_speed({"time_s": TIME, "position_m": 3.0 * TIME})
    assert not made.flags.writeable
    assert Run.from_arrays(TIME, TIME, position_m=5.0 * TIME).velocity_m_s.tolist() == TIME.tolist()


def test_gaps_of_a_temperature_are_straight_lines_and_told() -> None:
    """How many readings there are, and the longest time without."""
    celsius = np.full(N, np.nan)
    celsius[[2, 6, 15]] = [20.0, 24.0, 20.0]
    whole, (found,) = _whole("a", TIME, celsius)
    assert whole[[0, 2, 4, 6, 19]].tolist() == pytest.approx([20.0, 20.0, 22.0, 24.0, 20.0])
    assert found.words == "the temperature was read at 3 of 20 samples"
    assert (found.kind, found.channel, found.run) == ("gaps", "temperature_c", "a")
    assert (found.unit, found.done) == ("s", "straight lines between")
    assert found.size == pytest.approx(0.9)
    early = np.where(np.arange(N) < 5, 20.0, np.nan)
    assert _whole("a", TIME, early)[1][0].size == pytest.approx(1.5)
    same, nothing = _whole("a", TIME, TIME)
    assert same is TIME
    assert nothing == ()


def test_a_run_at_other_instants() -> None:
    """Its friction is given there; all else is on straight lines, and was read everywhere."""
    run = replace(RUN, read={"own": np.arange(N) > 5})
    at = np.array([0.05, 0.33, 1.9])
    found = run.at(at, np.array([7.0, 8.0, 9.0]))
    assert found.time_s.tolist() == at.tolist()
    assert found.friction_n is not None
    assert found.friction_n.tolist() == [7.0, 8.0, 9.0]
    np.testing.assert_allclose(found.velocity_m_s, at + 1.0)
    np.testing.assert_allclose(found.extra["own"], 4.0 * at)
    assert found.angle_rad is not None
    np.testing.assert_allclose(found.angle_rad, 3.0 * at)
    assert found.read == {}


def test_a_written_run_has_an_empty_cell_where_a_channel_was_not_read() -> None:
    """And every bit of what was."""
    some = replace(RUN, read={"own": np.arange(N) % 2 == 0}).select(slice(0, 3))
    assert some.to_csv() == (
        "time_s,angle_rad,velocity_m_s,friction_n,own\n"
        "0.0,0.0,1.0,0.0,0.0\n"
        "0.1,0.30000000000000004,1.1,0.2,\n"
        "0.2,0.6000000000000001,1.2,0.4,0.8\n"
    )


def test_who_needs_a_column_that_is_missing() -> None:
    """By the file where there is one."""
    require(RUN, "angle_rad", "the law")
    require(RUN, ["time_s", "own"], "the law")
    has = "it has time_s, angle_rad, velocity_m_s, friction_n, own"
    assert refusal(require, RUN, ["own", "load_n"], "the law") == (
        f"a, column load_n: is missing, and the law needs it; add the column ({has})"
    )
    filed = replace(RUN, path=Path("f.csv"))
    assert refusal(require, filed, "load_n", "x").startswith("f.csv, column load_n: is missing")


JOINT = Rig(drive=Drive("rotary", "torque"))
SLIDE = Rig(drive=Drive("linear", "force"))


def test_a_run_is_told_in_the_quantities_of_its_rig() -> None:
    """Unless it was read for another machine, or without the rig that its file needs."""
    assert run_on(Rig.thesis(), RUN) is RUN
    assert run_on(Rig(), RUN).quantities == LINEAR
    joint = run_on(JOINT, RUN)
    assert joint.quantities == JOINT.quantities
    assert run_on(JOINT, joint) is joint
    other = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=1.0))
    assert run_on(other, joint).quantities == other.quantities
    assert refusal(run_on, SLIDE, joint) == (
        "a: was read for a rotary drive, and this rig is none; give the rig that it was read with"
    )
    assert refusal(run_on, Rig.thesis(), run_on(SLIDE, RUN)).startswith(
        "a: was read for a linear drive"
    )
    filed = replace(RUN, path=Path("f.csv"))
    assert filed.quantities == OF_BEARING
    assert refusal(run_on, JOINT, filed) == (
        "f.csv: was read without the rig, whose [drive] says what its columns are; "
        "read it with the rig: jbf.read_run(path, rig)"
    )
    assert run_on(SLIDE, filed).quantities == SLIDE.quantities


def write(path: Path, *, header: str = "time_s,velocity_m_s,friction_n", rows: int = 12) -> Path:
    """A file of a run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    count = header.count(",")
    lines = [",".join([str(0.1 * i), *["1.5"] * count]) for i in range(rows)]
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def test_runs_of_files_folders_and_patterns(tmp_path: Path) -> None:
    """Folders in the order of their names; each run under a name of its own."""
    b, a = write(tmp_path / "x" / "b.csv"), write(tmp_path / "x" / "a.CSV")
    other = write(tmp_path / "y" / "a.csv")
    (tmp_path / "x" / "notes.txt").write_text("none")
    assert [run.name for run in read_runs(tmp_path / "x")] == ["a", "b"]
    assert [run.path for run in read_runs([b, tmp_path / "y"])] == [b, other]
    assert [run.name for run in read_runs(str(tmp_path / "x" / "b*"))] == ["b"]
    assert [run.name for run in read_runs([tmp_path / "x", other])] == ["x/a", "b", "y/a"]
    assert refusal(read_runs, [b, a, b]) == f"{b}: is given twice; name each run once"
    assert refusal(read_runs, []) == "no run is given; name at least one CSV file or folder"
    assert (
        refusal(read_runs, tmp_path) == f"{tmp_path}: the folder holds no .csv file; name another"
    )
    pattern = str(tmp_path / "z*")
    assert refusal(read_runs, pattern) == f"{pattern}: no file matches; correct the pattern"
    assert refusal(read_runs, 3) == "int is not a path; name a file or a folder"
    square = write(tmp_path / "s[1].csv")
    assert [run.name for run in read_runs(str(square))] == ["s[1]"]
    bare = write(tmp_path / "n" / "m.csv", header="time_s,velocity_m_s")
    assert read_runs(bare, need_friction=False)[0].friction_n is None


def test_names_have_as_many_folders_as_tell_them_apart(tmp_path: Path) -> None:
    """The file's whole name where even all of them do not."""
    folder = tmp_path
    paths = [folder / "p" / "a" / "r.csv", folder / "q" / "a" / "r.csv", folder / "s.csv"]
    assert _unique_names(paths) == ["p/a/r", "q/a/r", "s"]
    assert _unique_names([folder / "r.csv", folder / "r.txt"]) == ["r.csv", "r.txt"]
    assert _unique_names([folder / "p" / "r.csv", folder / "q" / "r.csv"]) == ["p/r", "q/r"]


def test_a_campaign_is_a_folder_with_a_rig(tmp_path: Path) -> None:
    """And a folder of such folders has them by name."""
    one = tmp_path / "one"
    write(one / "a.csv")
    mend = "put the rig's file beside its runs"
    assert refusal(read_campaign, one) == f"{one}: holds no rig.toml; {mend}"
    Rig.thesis().write(one / "rig.toml")
    rig, runs = read_campaign(one)
    assert rig == Rig.thesis()
    assert [run.name for run in runs] == ["a"]
    (tmp_path / "empty").mkdir()
    write(tmp_path / "two" / "b.csv")
    (tmp_path / "three").mkdir()
    Rig.thesis().write(tmp_path / "three" / "rig.toml")
    assert campaigns_in(tmp_path) == {name: tmp_path / name for name in ("one", "three", "two")}
    for nothing in (tmp_path / "empty", tmp_path / "nowhere"):
        assert refusal(campaigns_in, nothing).startswith(f"{nothing}: holds no campaign; give each")


def test_a_word_that_is_nearly_a_column() -> None:
    """An alias, or a slip; a word of more parts is a quantity of its own."""
    absent = ["time_s", "velocity_m_s", "friction_n", "load_n"]
    assert _near_miss("T", absent) == "time_s"
    assert _near_miss("force", absent) == "friction_n"
    assert _near_miss("force", ["time_s"]) is None
    assert _near_miss("frction_n", absent) == "friction_n"
    assert _near_miss("load_ref_n", absent) is None
    assert _near_miss("pressure", absent) is None


def test_cells_that_are_empty_are_a_clocks_or_gaps() -> None:
    """A twentieth, and ten, are a clock's; or all where a slow channel alone was read."""
    cells = ["1.5"] * 100
    for empty, own in ((9, False), (10, True)):
        some = [" "] * empty + cells[empty:]
        found = _by_its_own_clock(some, [some])
        assert (found is not None) == own
    found = _by_its_own_clock([""] * 50 + ["2.5"] * 50, [])
    assert found is not None
    values, there = found
    assert there.tolist() == [False] * 50 + [True] * 50
    assert values[there].tolist() == [2.5] * 50
    quick = ["1.0"] * 97 + [""] * 3
    slow = [""] * 60 + ["7.0"] * 40
    assert _by_its_own_clock(quick, [quick, slow]) is not None
    assert _by_its_own_clock(quick, [quick, ["7.0"] * 40 + [""] * 60]) is None
    assert _by_its_own_clock(quick, [quick]) is None
    assert _by_its_own_clock([""] * 100, []) is None
    assert _by_its_own_clock([""] * 50 + ["x"] * 50, []) is None


def test_columns_of_a_file_that_nobody_knows(tmp_path: Path) -> None:
    """Kept where all of it are finite numbers; a temperature that was never read is none."""
    path = tmp_path / "a.csv"
    lines = ["time_s,velocity_m_s,friction_n,temperature_c,word,own,"]
    lines += [f"{0.1 * i},1.0,2.0,,w,{i},5" for i in range(12)]
    path.write_text("\n".join(lines))
    run = read_run(path)
    assert list(run.extra) == ["own"]
    assert run.temperature_c is None
    assert run.read == {}
    lines[5] = "0.4,1.0,2.0,21.5,w,inf,5"
    path.write_text("\n".join(lines))
    run = read_run(path)
    assert run.extra == {}
    assert run.temperature_c is not None
    assert set(run.temperature_c.tolist()) == {21.5}
    assert [f.kind for f in run.reading] == ["gaps"]
