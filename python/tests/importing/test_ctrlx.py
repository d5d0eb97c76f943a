"""Traces of ctrlX: blocks of a PLC trace, and columns named by paths of the Data Layer."""

from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import open_source

N = 400
TIME_MS = 2.0 * np.arange(N)
POSITION = np.round(20.0 * np.sin(TIME_MS / 300.0), 4)
VELOCITY = np.round(20.0 / 0.3 * np.cos(TIME_MS / 300.0), 4)
FORCE = np.round(3.0 + np.cos(TIME_MS / 300.0), 4)
PATH = "motion/axs/Axis_X/state/values/actual"


def write_trace(path: Path) -> None:
    """Write a block for each variable; the force has every second instant."""
    variables = {"fPosition [mm]": (1, POSITION), "fVelocity [mm/s]": (1, VELOCITY)}
    variables["fForce [N]"] = (2, FORCE)
    lines = ["[key]; [value]", "DeviceName; ctrlX"]
    for number, (name, (step, values)) in enumerate(variables.items()):
        lines += [f"{number}.Variable; {name}", f"{number}.Data; "]
        samples = zip(TIME_MS[::step].tolist(), values[::step].tolist(), strict=True)
        lines += [f"; {time!r}; {value!r}" for time, value in samples]
    path.write_text("\n".join(lines) + "\n")


def test_variables_of_a_trace_with_equal_times_share_a_table(tmp_path: Path) -> None:
    write_trace(tmp_path / "trace.csv")
    with open_source(tmp_path / "trace.csv") as source:
        fast, slow = source.tables
        heads = source.head(fast), source.head(slow)
    assert [c.name for c in fast.columns] == ["time", "fPosition [mm]", "fVelocity [mm/s]"]
    np.testing.assert_array_equal(heads[0]["time"], TIME_MS)
    np.testing.assert_array_equal(heads[0]["fPosition [mm]"], POSITION)
    np.testing.assert_array_equal(heads[1]["time"], TIME_MS[::2])
    np.testing.assert_array_equal(heads[1]["fForce [N]"], FORCE[::2])


@pytest.mark.parametrize("own_times", [False, True])
def test_columns_named_by_data_layer_paths_are_guessed_without_open_questions(
    own_times: bool, tmp_path: Path
) -> None:
    channels = {"pos [mm]": POSITION, "vel [mm/s]": VELOCITY, "force [N]": FORCE}
    columns: list[list[str]] = []
    for name, values in channels.items():
        if own_times or not columns:
            columns.append(["Time [ms]", *(f"{t:g}" for t in TIME_MS.tolist())])
        columns.append([f"{PATH}/{name}", *(f"{v:.4f}" for v in values.tolist())])
    text = "\n".join(";".join(row) for row in zip(*columns, strict=True))
    (tmp_path / "recording.csv").write_text(text)
    guess = jbf.look(tmp_path / "recording.csv")
    assert guess.sure, guess.questions
    (run,) = jbf.import_files(tmp_path / "recording.csv", whole=True).runs
    np.testing.assert_allclose(run.time_s, TIME_MS / 1e3, rtol=1e-15)
    np.testing.assert_allclose(run.position_m, POSITION / 1e3, rtol=1e-15)
    np.testing.assert_array_equal(run.friction, FORCE)


@pytest.mark.parametrize("share", [0.003, 0.4, 0.8])
def test_truncated_trace_returns_its_complete_samples_or_a_one_line_error(
    share: float, tmp_path: Path
) -> None:
    path = tmp_path / "trace.csv"
    write_trace(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    if share < 0.1:
        with pytest.raises(InputError) as refused:
            open_source(path)
        assert "\n" not in str(refused.value)
        return
    with open_source(path) as source:
        position = source.head(source.tables[0])["fPosition [mm]"]
    count = len(position)
    np.testing.assert_array_equal(position[: count - 1], POSITION[: count - 1])
