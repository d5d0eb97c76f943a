"""Cutting a long recording into runs: by rests, columns, loads or motion; edited cut files."""

from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from long_recording import recording
from recording_files import Columns, csv

HEAD = """\
[columns]
time_s = "time_s"
position_m = "position_m"
velocity_m_s = "velocity_m_s"
friction_n = "friction_n"
load_n = "load_n"
[drive]
motion = "linear"
friction = "force"
"""
LONG = recording(4, 12.0, 5.0)


def imported(folder: Path, cut: str, columns: Columns, without: str = "nothing") -> jbf.Import:
    """A recording with the given cut; one column is omitted."""
    csv(folder / "log.csv", {name: v for name, v in columns.items() if name != without})
    head = "\n".join(line for line in HEAD.splitlines() if not line.startswith(without))
    (folder / "map.toml").write_text(f"{head}\n[cut]\n{cut}\n")
    return jbf.import_files(folder / "log.csv", folder / "map.toml")


def spans(result: jbf.Import) -> list[tuple[float, float]]:
    return [(p.from_s, p.to_s) for p in result.pieces if p.keep]


def assert_pieces_cover_the_recording_once(result: jbf.Import) -> None:
    """Check that each sample is in exactly one piece."""
    time = LONG.columns["time_s"]
    assert result.pieces[0].from_s == time[0]
    assert result.pieces[-1].to_s == time[-1]
    for one, other in zip(result.pieces, result.pieces[1:], strict=False):
        assert not ((time > one.to_s) & (time < other.from_s)).any()
    kept = np.concatenate([run.time_s for run in result.runs])
    assert len(np.unique(kept)) == len(kept)


@pytest.mark.parametrize("without", ["nothing", "position_m", "velocity_m_s"])
def test_recording_is_cut_at_rests_detected_from_speed_or_position(
    without: str, tmp_path: Path
) -> None:
    result = imported(tmp_path, 'by = "rests"\nkeep_rest_s = 0.5', LONG.columns, without)
    assert len(spans(result)) == len(LONG.motions)
    for (begin, end), (first, last) in zip(LONG.motions, spans(result), strict=True):
        # Half a second of each rest is kept, up to the slow start of a motion.
        assert begin - 0.8 < first < begin + 0.1
        assert end - 0.1 < last < end + 0.8
    assert_pieces_cover_the_recording_once(result)
    out = [p for p in result.pieces if not p.keep]
    assert len(out) == 5
    assert all("a rest of" in p.why for p in out)


def test_recording_is_cut_where_a_run_number_changes(tmp_path: Path) -> None:
    result = imported(tmp_path, 'by = "run"\ncolumn = "test"', LONG.columns | {"test": LONG.run})
    assert len(spans(result)) == 4
    assert_pieces_cover_the_recording_once(result)
    for number, run in enumerate(result.runs):
        np.testing.assert_array_equal(run.time_s, LONG.columns["time_s"][LONG.run == number])
        assert "cut" not in run.extra


def test_recording_is_cut_where_a_text_column_changes(tmp_path: Path) -> None:
    phases = np.array(["warm up", "slow", "fast", "end"])[LONG.run.astype(int)]
    csv(tmp_path / "log.csv", LONG.columns)
    lines = (tmp_path / "log.csv").read_text().splitlines()
    rows = [f"{line},{phase}" for line, phase in zip(lines, ["phase", *phases], strict=True)]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "map.toml").write_text(f'{HEAD}\n[cut]\nby = "run"\ncolumn = "phase"\n')
    assert len(jbf.import_files(tmp_path / "log.csv", tmp_path / "map.toml").runs) == 4


def test_recording_is_cut_where_a_set_point_changes(tmp_path: Path) -> None:
    level = np.where(LONG.run < 2, 10.0, 20.0)
    result = imported(
        tmp_path, 'by = "set_point"\ncolumn = "level"', LONG.columns | {"level": level}
    )
    assert [len(run) for run in result.runs] == [int((level == x).sum()) for x in (10.0, 20.0)]


def test_recording_is_cut_at_steps_of_the_load(tmp_path: Path) -> None:
    noise = np.random.default_rng(3).normal(0.0, 0.5, len(LONG.run))
    load = np.array([50.0, 80.0, 80.0, 65.0])[LONG.run.astype(int)] + noise
    result = imported(tmp_path, 'by = "load_step"', LONG.columns | {"load_n": load})
    edges = LONG.columns["time_s"][np.flatnonzero(np.diff(LONG.run))]
    assert [last for _, last in spans(result)[:-1]] == pytest.approx([edges[0], edges[2]], abs=0.05)
    assert_pieces_cover_the_recording_once(result)


@pytest.mark.parametrize("cut", ['by = "rests"\nrest_s = 8.0', 'by = "load_step"'])
def test_recording_is_not_cut_at_short_rests_or_by_noise_of_the_load(
    cut: str, tmp_path: Path
) -> None:
    load = 20.0 + np.random.default_rng(4).normal(0.0, 4.0, len(LONG.run))
    assert len(spans(imported(tmp_path, cut, LONG.columns | {"load_n": load}))) == 1


def test_rests_are_detected_in_spite_of_noise_of_the_speed(tmp_path: Path) -> None:
    noise = np.random.default_rng(5).normal(0.0, 0.05, len(LONG.run))
    noisy = LONG.columns["velocity_m_s"] + noise
    result = imported(
        tmp_path, 'by = "rests"', LONG.columns | {"velocity_m_s": noisy}, "position_m"
    )
    assert len(spans(result)) == len(LONG.motions)


def test_recording_is_cut_where_the_kind_of_motion_changes(tmp_path: Path) -> None:
    time = np.arange(6000) / 50.0
    speed = np.where(time < 40.0, 0.1, np.where(time < 80.0, 0.1 * np.sin(3.0 * time), -0.05))
    speed[time >= 110.0] = 0.0
    path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])))) / 50.0
    columns = {
        "time_s": time, "position_m": path, "velocity_m_s": speed,
        "friction_n": 5.0 * np.sign(speed), "load_n": np.full(6000, 10.0),
    }  # fmt: skip
    cuts = [first for first, _ in spans(imported(tmp_path, 'by = "motion"', columns))[1:]]
    assert cuts == pytest.approx([40.0, 80.0, 110.0], abs=2.5)


def test_recording_is_cut_where_its_time_restarts(tmp_path: Path) -> None:
    parts = []
    for number in range(4):
        part = {n: values[LONG.run == number] for n, values in LONG.columns.items()}
        parts.append(part | {"time_s": part["time_s"] - part["time_s"][0]})
    columns = {n: np.concatenate([p[n] for p in parts]) for n in LONG.columns}
    result = imported(tmp_path, "", columns)
    assert [run.time_s[0] for run in result.runs] == [0.0] * 4
    for run, part in zip(result.runs, parts, strict=True):
        np.testing.assert_array_equal(run.friction, part["friction_n"])


def test_import_with_an_unchanged_cut_file_reproduces_its_pieces(tmp_path: Path) -> None:
    first = imported(tmp_path, 'by = "rests"', LONG.columns)
    files = (tmp_path / "log.csv", tmp_path / "map.toml")
    assert jbf.import_files(*files, cut_file=first.folder / "cut.toml").pieces == first.pieces


def test_edited_cut_file_renames_and_shortens_a_run(tmp_path: Path) -> None:
    first = imported(tmp_path, 'by = "rests"', LONG.columns)
    text = (first.folder / "cut.toml").read_text()
    _, piece, *_ = first.pieces
    text = text.replace(f'name = "{piece.name}"', 'name = "first strokes"')
    text = text.replace(f"to_s = {piece.to_s!r}, keep = true", "to_s = 12.5, keep = true")
    (tmp_path / "cut.toml").write_text(text)
    files = (tmp_path / "log.csv", tmp_path / "map.toml")
    run = jbf.import_files(*files, cut_file=tmp_path / "cut.toml").runs[0]
    assert run.name == "first strokes"
    assert run.time_s[-1] == 12.5


INVALID_CUT_FILES = {
    'pieces = [{ name = "a", file = "other.csv", from_s = 0.0, to_s = 9.0 }]': "is not imported",
    'pieces = [{ name = "a", file = "log.csv", from_s = 9.0, to_s = 1.0 }]': "contains no samples",
    'pieces = [{ name = "a/b", file = "log.csv", from_s = 0.0, to_s = 9.0 }]': "not a valid file",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0 }]': "to_s: is missing",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0, to_s = 9.0, stretch = 3 }]': "stre",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0, to_s = 9.0, kep = true }]': "kep",
    "pieces = []": "no run remains",
}


@pytest.mark.parametrize("text", INVALID_CUT_FILES)
def test_invalid_cut_file_is_refused_and_writes_no_output(text: str, tmp_path: Path) -> None:
    csv(tmp_path / "log.csv", LONG.columns)
    (tmp_path / "map.toml").write_text(HEAD)
    (tmp_path / "cut.toml").write_text(text)
    files = (tmp_path / "log.csv", tmp_path / "map.toml", tmp_path / "out")
    with pytest.raises(InputError, match=INVALID_CUT_FILES[text]):
        jbf.import_files(*files, cut_file=tmp_path / "cut.toml")
    assert not (tmp_path / "out").exists()


def test_plot_and_repr_of_an_import_cut_at_rests_show_all_pieces_and_html_is_written(
    tmp_path: Path,
) -> None:
    result = imported(tmp_path, 'by = "rests"', LONG.columns)
    axes = result.plot()
    assert len(axes) == 3
    assert len(axes[0].patches) == len(result.pieces)
    assert "4 runs" in repr(result)
    result.save_html(tmp_path / "import.html")
    assert (tmp_path / "import.html").stat().st_size > 10_000


def to_and_fro(cycles: int = 6, period: float = 2.0) -> Columns:
    """Sine strokes of 0.1 m; forward strokes begin at 0, 2, 4, ... s."""
    time = 0.005 * np.arange(int(cycles * period / 0.005))
    phase = 2.0 * np.pi * time / period
    speed = 0.1 * np.sin(phase)
    return {
        "time_s": time,
        "position_m": -0.1 * period / (2.0 * np.pi) * np.cos(phase),
        "velocity_m_s": speed,
        "friction_n": 5.0 * np.sign(speed),
        "load_n": np.full(len(time), 20.0),
    }


@pytest.mark.parametrize("without", ["nothing", "position_m", "velocity_m_s"])
def test_reciprocating_motion_is_cut_where_each_forward_stroke_begins(
    without: str, tmp_path: Path
) -> None:
    result = imported(tmp_path, 'by = "cycles"', to_and_fro(), without)
    starts = [first for first, _ in spans(result)]
    np.testing.assert_allclose(starts, np.arange(0.0, 12.0, 2.0), atol=0.06)
    assert sum(len(run) for run in result.runs) == 2400


def test_noise_at_standstill_is_not_cut_into_cycles(tmp_path: Path) -> None:
    columns = to_and_fro(cycles=2)
    rng = np.random.default_rng(4)
    rest = {name: np.full(400, values[-1]) for name, values in columns.items()}
    rest["time_s"] = columns["time_s"][-1] + 0.005 * np.arange(1, 401)
    rest["velocity_m_s"] = np.zeros(400)
    whole = {name: np.concatenate([columns[name], rest[name]]) for name in columns}
    noise = 1e-4 * rng.normal(size=len(whole["time_s"]))
    whole["velocity_m_s"] = whole["velocity_m_s"] + noise
    assert len(spans(imported(tmp_path, 'by = "cycles"', whole))) == 2


@pytest.mark.parametrize(("cut", "count"), [('by = "parts"', 10), ("parts = 2", 2)])
def test_recording_is_cut_into_the_given_or_default_number_of_equal_parts(
    cut: str, count: int, tmp_path: Path
) -> None:
    result = imported(tmp_path, cut, to_and_fro())
    assert [len(run) for run in result.runs] == [2400 // count] * count


@pytest.mark.parametrize("parts", ["1", "2.5", "true", '"half"'])
def test_number_of_parts_that_is_not_an_integer_above_one_is_refused(
    parts: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"cut\.parts"):
        imported(tmp_path, f"parts = {parts}", to_and_fro())


def test_parts_key_is_refused_if_the_recording_is_cut_by_another_criterion(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cut\.parts"):
        imported(tmp_path, 'by = "cycles"\nparts = 3', to_and_fro())


def test_cutting_unidirectional_motion_by_cycles_reports_that_there_are_no_cycles(
    tmp_path: Path,
) -> None:
    columns = to_and_fro()
    speed = np.abs(columns["velocity_m_s"]) + 0.01
    columns |= {"velocity_m_s": speed, "position_m": np.cumsum(speed) * 0.005}
    result = imported(tmp_path, 'by = "cycles"', columns)
    assert "no cycle was found" in result.summary()
