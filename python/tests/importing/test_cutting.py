"""Cutting a long recording into runs: by rests, columns, loads or motion; edited cut files."""

from __future__ import annotations

from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from long_recording import Recording, recording
from recording_files import csv

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


@pytest.fixture(scope="module")
def long() -> Recording:
    return recording(4, 12.0, 5.0)


def imported(folder: Path, long: Recording, cut: str, **more: np.ndarray) -> jbf.Import:
    csv(folder / "log.csv", long.columns | more)
    (folder / "map.toml").write_text(f"{HEAD}\n[cut]\n{cut}\n")
    return jbf.import_files(folder / "log.csv", folder / "map.toml")


def spans(result: jbf.Import) -> list[tuple[float, float]]:
    return [(p.from_s, p.to_s) for p in result.pieces if p.keep]


def assert_pieces_cover_the_recording_once(result: jbf.Import, long: Recording) -> None:
    """No sample is lost between the pieces, and no sample is in two of them."""
    time = long.columns["time_s"]
    assert result.pieces[0].from_s == time[0]
    assert result.pieces[-1].to_s == time[-1]
    for one, other in zip(result.pieces, result.pieces[1:], strict=False):
        between = (time > one.to_s) & (time < other.from_s)
        assert not between.any()
    kept = np.concatenate([run.time_s for run in result.runs])
    assert len(np.unique(kept)) == len(kept)


@pytest.mark.parametrize("columns", ["speed and position", "speed", "position"])
def test_recording_is_cut_at_rests_detected_from_speed_or_position(
    columns: str, long: Recording, tmp_path: Path
) -> None:
    csv(tmp_path / "log.csv", long.columns)
    lines = HEAD.splitlines()
    unwanted = {"speed": "position", "position": "velocity"}.get(columns, "nothing")
    head = "\n".join(line for line in lines if not line.startswith(unwanted))
    (tmp_path / "map.toml").write_text(f'{head}\n[cut]\nby = "rests"\nkeep_rest_s = 0.5\n')
    result = jbf.import_files(tmp_path / "log.csv", tmp_path / "map.toml")
    assert len(spans(result)) == len(long.motions)
    for (begin, end), (first, last) in zip(long.motions, spans(result), strict=True):
        # Half a second of each rest is kept, up to the slow beginning of a motion.
        assert begin - 0.8 < first < begin + 0.1
        assert end - 0.1 < last < end + 0.8
    assert_pieces_cover_the_recording_once(result, long)
    out = [p for p in result.pieces if not p.keep]
    assert len(out) == 5
    assert all("a rest of" in p.why for p in out)


def test_recording_is_not_cut_at_rests_shorter_than_the_minimum(
    long: Recording, tmp_path: Path
) -> None:
    assert len(spans(imported(tmp_path, long, 'by = "rests"\nrest_s = 8.0'))) == 1


def test_recording_is_cut_where_the_run_number_column_changes(
    long: Recording, tmp_path: Path
) -> None:
    result = imported(tmp_path, long, 'by = "run"\ncolumn = "test"', test=long.run)
    assert len(spans(result)) == 4
    assert_pieces_cover_the_recording_once(result, long)
    for number, run in enumerate(result.runs):
        np.testing.assert_array_equal(run.time_s, long.columns["time_s"][long.run == number])
        assert "cut" not in run.extra


def test_recording_is_cut_where_a_text_column_changes(long: Recording, tmp_path: Path) -> None:
    rows = [",".join([*long.columns, "phase"])]
    table = np.column_stack(list(long.columns.values())).tolist()
    for row, number in zip(table, long.run, strict=True):
        rows.append(",".join([*map(repr, row), ["warm up", "slow", "fast", "end"][int(number)]]))
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "map.toml").write_text(f'{HEAD}\n[cut]\nby = "run"\ncolumn = "phase"\n')
    assert len(jbf.import_files(tmp_path / "log.csv", tmp_path / "map.toml").runs) == 4


def test_recording_is_cut_where_the_set_point_column_changes(
    long: Recording, tmp_path: Path
) -> None:
    level = np.where(long.run < 2, 10.0, 20.0)
    result = imported(tmp_path, long, 'by = "set_point"\ncolumn = "level"', level=level)
    assert [len(run) for run in result.runs] == [int((level == x).sum()) for x in (10.0, 20.0)]


def test_recording_is_cut_at_steps_of_the_load(long: Recording, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    load = np.array([50.0, 80.0, 80.0, 65.0])[long.run.astype(int)] + rng.normal(
        0, 0.5, len(long.run)
    )
    result = imported(tmp_path, long, 'by = "load_step"', load_n=load)
    edges = long.columns["time_s"][np.flatnonzero(np.diff(long.run))]
    assert [last for _, last in spans(result)[:-1]] == pytest.approx([edges[0], edges[2]], abs=0.05)
    assert_pieces_cover_the_recording_once(result, long)


def test_recording_is_not_cut_by_noise_on_a_constant_load(long: Recording, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    load = 20.0 + rng.normal(0, 4.0, len(long.run))
    assert len(spans(imported(tmp_path, long, 'by = "load_step"', load_n=load))) == 1


def test_rests_are_detected_in_spite_of_noise_of_the_speed(long: Recording, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    noisy = long.columns["velocity_m_s"] + rng.normal(0.0, 0.05, len(long.run))
    columns = {k: v for k, v in long.columns.items() if k != "position_m"}
    csv(tmp_path / "log.csv", columns | {"velocity_m_s": noisy})
    head = "\n".join(line for line in HEAD.splitlines() if not line.startswith("position"))
    (tmp_path / "map.toml").write_text(f'{head}\n[cut]\nby = "rests"\n')
    result = jbf.import_files(tmp_path / "log.csv", tmp_path / "map.toml")
    assert len(spans(result)) == len(long.motions)


def test_recording_is_cut_where_the_kind_of_motion_changes(tmp_path: Path) -> None:
    time = np.arange(6000) / 50.0
    speed = np.where(time < 40.0, 0.1, np.where(time < 80.0, 0.1 * np.sin(3.0 * time), -0.05))
    speed[time >= 110.0] = 0.0
    path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])))) / 50.0
    columns = {
        "time_s": time, "position_m": path, "velocity_m_s": speed,
        "friction_n": 5.0 * np.sign(speed), "load_n": np.full(6000, 10.0),
    }  # fmt: skip
    result = imported(tmp_path, Recording(columns, [], time), 'by = "motion"')
    cuts = [first for first, _ in spans(result)[1:]]
    assert cuts == pytest.approx([40.0, 80.0, 110.0], abs=2.5)


def test_recording_is_cut_where_its_time_restarts(long: Recording, tmp_path: Path) -> None:
    parts = []
    for number in range(4):
        own = {n: values[long.run == number] for n, values in long.columns.items()}
        own["time_s"] = own["time_s"] - own["time_s"][0]
        parts.append(own)
    columns = {n: np.concatenate([p[n] for p in parts]) for n in long.columns}
    result = imported(tmp_path, Recording(columns, [], long.run), "")
    assert [run.time_s[0] for run in result.runs] == [0.0] * 4
    for run, part in zip(result.runs, parts, strict=True):
        np.testing.assert_array_equal(run.friction_n, part["friction_n"])


def test_unchanged_cut_file_reproduces_the_pieces(long: Recording, tmp_path: Path) -> None:
    first = imported(tmp_path, long, 'by = "rests"')
    (tmp_path / "cut.toml").write_text((first.folder / "cut.toml").read_text())
    arguments = (tmp_path / "log.csv", tmp_path / "map.toml")
    again = jbf.import_files(*arguments, cut_file=tmp_path / "cut.toml")
    assert again.pieces == first.pieces


def test_edited_cut_file_renames_and_shortens_a_run(long: Recording, tmp_path: Path) -> None:
    first = imported(tmp_path, long, 'by = "rests"')
    text = (first.folder / "cut.toml").read_text()
    arguments = (tmp_path / "log.csv", tmp_path / "map.toml")
    name = first.pieces[1].name
    edited = text.replace(f'name = "{name}"', 'name = "first strokes"').replace(
        f"to_s = {first.pieces[1].to_s!r}, keep = true", "to_s = 12.5, keep = true"
    )
    assert edited != text
    (tmp_path / "cut.toml").write_text(edited)
    run = jbf.import_files(*arguments, cut_file=tmp_path / "cut.toml").runs[0]
    assert run.name == "first strokes"
    assert run.time_s[-1] == 12.5


INVALID_CUT_FILES = {
    'pieces = [{ name = "a", file = "other.csv", from_s = 0.0, to_s = 9.0 }]': "is not imported",
    'pieces = [{ name = "a", file = "log.csv", from_s = 9.0, to_s = 1.0 }]': "holds nothing",
    'pieces = [{ name = "a/b", file = "log.csv", from_s = 0.0, to_s = 9.0 }]': "no name for a file",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0 }]': "to_s: is missing",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0, to_s = 9.0, stretch = 3 }]': "stre",
    'pieces = [{ name = "a", file = "log.csv", from_s = 0.0, to_s = 9.0, kep = true }]': "kep",
    "pieces = []": "nothing is left",
}


@pytest.mark.parametrize("text", INVALID_CUT_FILES)
def test_invalid_cut_file_is_refused_and_writes_no_output(
    text: str, long: Recording, tmp_path: Path
) -> None:
    csv(tmp_path / "log.csv", long.columns)
    (tmp_path / "map.toml").write_text(HEAD)
    (tmp_path / "cut.toml").write_text(text)
    with pytest.raises(InputError, match=INVALID_CUT_FILES[text]):
        jbf.import_files(
            tmp_path / "log.csv", tmp_path / "map.toml", tmp_path / "out",
            cut_file=tmp_path / "cut.toml",
        )  # fmt: skip
    assert not (tmp_path / "out").exists()


def test_import_has_a_plot_of_its_pieces_a_repr_and_an_html_page(
    long: Recording, tmp_path: Path
) -> None:
    result = imported(tmp_path, long, 'by = "rests"')
    axes = result.plot()
    assert len(axes) == 3
    assert len(axes[0].patches) == len(result.pieces)
    assert "4 runs" in repr(result)
    result.save_html(tmp_path / "import.html")
    assert (tmp_path / "import.html").stat().st_size > 10_000
