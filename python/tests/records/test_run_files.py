"""Runs from files, folders and patterns; campaigns as folders."""

from pathlib import Path

from input_errors import input_error
from jbf import Rig
from jbf.records.folder import campaigns_in, read_campaign
from jbf.records.run_files import read_runs


def write(path: Path, header: str = "time_s,velocity_m_s,friction_n") -> Path:
    """A valid file of a run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [",".join([str(0.1 * i), *["1.5"] * header.count(",")]) for i in range(12)]
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def test_runs_are_read_in_order_from_files_folders_and_patterns(tmp_path: Path) -> None:
    b, a = write(tmp_path / "x" / "b.csv"), write(tmp_path / "x" / "a.CSV")
    other = write(tmp_path / "y" / "a.csv")
    (tmp_path / "x" / "notes.txt").write_text("none")
    bracket = write(tmp_path / "s[1].csv")
    assert [run.name for run in read_runs(tmp_path / "x")] == ["a", "b"]
    assert [run.path for run in read_runs([b, tmp_path / "y"])] == [b, other]
    assert [run.path for run in read_runs([tmp_path / "x", other])] == [a, b, other]
    assert [run.name for run in read_runs(str(tmp_path / "x" / "b*"))] == ["b"]
    assert [run.name for run in read_runs(str(bracket))] == ["s[1]"]
    bare = write(tmp_path / "n" / "m.csv", "time_s,velocity_m_s")
    assert read_runs(bare, need_friction=False)[0].friction is None


def test_runs_of_equal_file_names_are_named_with_parent_folder_or_suffix(tmp_path: Path) -> None:
    paths = [tmp_path / "p" / "a" / "r.csv", tmp_path / "q" / "a" / "r.csv", tmp_path / "s.csv"]
    assert [run.name for run in read_runs(map(write, paths))] == ["p/a/r", "q/a/r", "s"]
    paths = [tmp_path / "p" / "r.csv", tmp_path / "q" / "r.csv"]
    assert [run.name for run in read_runs(map(write, paths))] == ["p/r", "q/r"]
    paths = [tmp_path / "r.csv", tmp_path / "r.txt"]
    assert [run.name for run in read_runs(map(write, paths))] == ["r.csv", "r.txt"]


def test_missing_and_repeated_run_files_are_reported(tmp_path: Path) -> None:
    file = write(tmp_path / "x" / "b.csv")
    assert input_error(read_runs, [file, tmp_path / "x"]).file == str(file)
    assert input_error(read_runs, tmp_path).file == str(tmp_path)
    pattern = str(tmp_path / "z*")
    assert input_error(read_runs, pattern).file == pattern
    assert "no run" in input_error(read_runs, []).problem
    assert "path" in input_error(read_runs, 3).problem


def test_campaign_is_read_from_a_folder_only_if_it_has_a_rig_file(tmp_path: Path) -> None:
    folder = write(tmp_path / "one" / "a.csv").parent
    assert input_error(read_campaign, folder).file == str(folder)
    Rig.thesis().write(folder / "rig.toml")
    rig, runs = read_campaign(folder)
    assert rig == Rig.thesis()
    assert [run.name for run in runs] == ["a"]


def test_campaigns_of_a_folder_are_its_subfolders_with_a_rig_or_a_run(tmp_path: Path) -> None:
    write(tmp_path / "one" / "a.csv")
    for name in ("empty", "two"):
        (tmp_path / name).mkdir()
    Rig.thesis().write(tmp_path / "two" / "rig.toml")
    assert campaigns_in(tmp_path) == {name: tmp_path / name for name in ("one", "two")}
    for folder in (tmp_path / "empty", tmp_path / "nowhere"):
        assert input_error(campaigns_in, folder).file == str(folder)
