"""Run: construction, selection, resampling, CSV text and units."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf import InputError, Rig, Run
from jbf.records.checks import SHORTEST_S
from jbf.records.csv_file import read_run
from jbf.records.drive import Drive
from jbf.records.frames import columns_of
from jbf.records.quantities import LINEAR, ROTARY
from jbf.records.recorded_load import recorded_load
from jbf.records.run_requirements import require, run_on

SAMPLES = 20
TIME_S: Any = 0.1 * np.arange(SAMPLES)
FURTHER: Any = {"angle_rad": 3.0 * TIME_S, "extra": {"own": 4.0 * TIME_S}}
RUN = Run.from_arrays(TIME_S, TIME_S + 1.0, 2.0 * TIME_S, **FURTHER, name="a")
MASKED = np.ma.masked_array(np.ones(SAMPLES, dtype=bool), mask=np.arange(SAMPLES) == 0)
JOINT = Rig(drive=Drive("rotary", "torque"))
SLIDE = Rig(drive=Drive("linear", "force"))


def test_run_from_arrays_copies_columns_to_read_only_float64() -> None:
    given = np.zeros(10, np.float32)
    run = Run.from_arrays(range(10), given, load_n=[1] * 10, extra={"i_a": list(range(10))})
    given[0] = 5.0
    assert run.friction is None
    assert list(run.columns()) == ["time_s", "velocity_m_s", "load_n", "i_a"]
    for values in run.columns().values():
        assert values.dtype == np.float64
        assert not values.flags.writeable
    assert run.velocity[0] == 0.0
    assert (len(run), run.duration_s) == (10, 9.0)


def changed(index: int, value: float, values: Any = TIME_S) -> Any:
    """Values with one replaced sample."""
    return np.where(np.arange(SAMPLES) == index, value, values)


@pytest.mark.parametrize(
    ("columns", "column", "fact"),
    [
        ({"time_s": None}, "time_s", "is None"),
        ({"velocity_m_s": None}, "velocity_m_s", "is missing"),
        ({"velocity_m_s": changed(3, np.nan)}, "velocity_m_s", "sample 3: nan"),
        ({"friction_n": changed(7, -np.inf)}, "friction_n", "sample 7: -inf"),
        ({"friction_n": changed(2, -1.01e12)}, "friction_n", "sample 2: -1010000000000.0"),
        ({"temperature_c": np.full(SAMPLES, np.nan)}, "temperature_c", "sample 0: nan"),
        ({"load_n": changed(4, 0.0, TIME_S + 1.0)}, "load_n", "sample 4: a load of 0.0 N"),
        ({"time_s": changed(5, 0.4)}, "time_s", "sample 5: time repeats at 0.4"),
        ({"time_s": changed(5, 0.35)}, "time_s", "sample 5: time decreases from 0.4 to 0.35"),
        ({"time_s": changed(1, 0.9 * SHORTEST_S)}, "time_s", "sample 1: a time step of"),
        ({"velocity_m_s": TIME_S[:19]}, "velocity_m_s", "19 samples where time_s has 20"),
        ({"time_s": TIME_S[:9], "velocity_m_s": TIME_S[:9]}, None, "9 samples"),
        ({"velocity_m_s": ["a"] * SAMPLES}, "velocity_m_s", "not numbers"),
        ({"velocity_m_s": [1j] * SAMPLES}, "velocity_m_s", "complex128"),
        ({"velocity_m_s": np.array([1.0, "b"], dtype=object)}, "velocity_m_s", 'text "b"'),
        ({"velocity_m_s": [{}] * SAMPLES}, "velocity_m_s", "not an array of numbers"),
        ({"velocity_m_s": [TIME_S, TIME_S]}, "velocity_m_s", "shape (2, 20)"),
        ({"velocity_m_s": np.ma.masked_less(TIME_S, 0.5)}, "velocity_m_s", "masked"),
        ({"velocity_m_s": [*TIME_S[1:], np.ma.masked]}, "velocity_m_s", "masked"),
        ({"extra": {"load_n": TIME_S}}, "load_n", "a known column"),
        ({"extra": {"own": changed(0, np.inf)}}, "own", "sample 0: inf"),
    ],
)
def test_invalid_run_column_is_reported_with_its_name_and_sample(
    columns: dict[str, Any], column: str | None, fact: str
) -> None:
    given = {"time_s": TIME_S, "velocity_m_s": TIME_S + 1.0} | columns
    error = input_error(Run.from_arrays, **given, name="x")
    assert (error.file, error.column) == ("x", column)
    assert fact in error.problem


def test_speed_is_the_central_difference_of_the_position_if_not_recorded() -> None:
    run = Run.from_arrays(TIME_S, position_m=TIME_S**2)
    assert not run.speed_recorded
    assert "velocity_m_s" not in run.columns()
    np.testing.assert_allclose(run.velocity[1:-1], 2.0 * TIME_S[1:-1])
    # The speed from an angle is unknown until the radius is known.
    assert np.isnan(Run.from_arrays(TIME_S, angle_rad=TIME_S).velocity).all()


def test_temperature_gaps_are_interpolated_and_the_longest_is_reported() -> None:
    celsius = np.full(SAMPLES, np.nan)
    celsius[[2, 6, 15]] = [20.0, 24.0, 20.0]
    run: Any = Run.from_arrays(TIME_S, TIME_S, temperature_c=celsius)
    assert run.temperature_c[[0, 2, 4, 6, 19]] == pytest.approx([20.0, 20.0, 22.0, 24.0, 20.0])
    (finding,) = run.reading
    assert (finding.kind, finding.channel, finding.unit) == ("gaps", "temperature_c", "s")
    assert finding.size == pytest.approx(0.9)
    celsius = np.where(np.arange(SAMPLES) < 5, 20.0, np.nan)
    (finding,) = Run.from_arrays(TIME_S, TIME_S, temperature_c=celsius).reading
    assert finding.size == pytest.approx(1.5)
    assert Run.from_arrays(TIME_S, TIME_S, temperature_c=TIME_S).reading == ()


def test_numeric_frame_columns_become_run_columns_and_missing_time_is_reported() -> None:
    frame: dict[str, Any] = {
        "time_s": TIME_S,
        "velocity_m_s": TIME_S,
        "friction_n": np.array([*TIME_S[:-1], 3], dtype=object),
        "word": ["up"] * SAMPLES,
        "date": np.full(SAMPLES, "2020-01-01", "datetime64[D]"),
        "own": 2.0 * TIME_S,
    }
    run: Any = Run.from_frame(frame, name="d", path=Path("f.csv"))
    assert (run.name, run.path, run.read) == ("d", Path("f.csv"), {})
    assert list(run.extra) == ["own"]
    assert run.friction[-1] == 3.0
    frame["own"] = np.where(np.arange(SAMPLES) < 10, np.nan, TIME_S)
    assert set(Run.from_frame(frame).read) == {"own"}
    error = input_error(Run.from_frame, {"velocity_m_s": TIME_S, "v": TIME_S}, name="f")
    assert (error.file, error.column) == ("f", "time_s")


class ExportedByArrow:
    """An object without columns that exports an Arrow stream."""

    def __init__(self, table: Any) -> None:
        self._table = table

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self._table.__arrow_c_stream__(requested_schema)


def test_run_is_read_from_an_arrow_table_and_an_arrow_stream() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    table = pyarrow.table({"time_s": TIME_S, "velocity_m_s": TIME_S + 1.0, "note": ["x"] * SAMPLES})
    for frame in (table, ExportedByArrow(table)):
        run = Run.from_frame(frame)
        assert list(run.columns()) == ["time_s", "velocity_m_s"]
        np.testing.assert_array_equal(run.velocity, TIME_S + 1.0)


def separate_clock() -> Run:
    """A run whose friction was sampled at every second instant."""
    return Run.from_channels(
        {
            "velocity_m_s": (TIME_S, TIME_S + 1.0),
            "friction_n": (TIME_S[::2], 2.0 * TIME_S[::2]),
            "own": (TIME_S, 4.0 * TIME_S),
        },
        name="a",
    )


def assert_equal_runs(run: Run, other: Run) -> None:
    assert run.name == other.name
    assert list(run.columns()) == list(other.columns())
    for name, values in run.columns().items():
        np.testing.assert_array_equal(other.columns()[name], values, err_msg=name)
    assert {k: v.tolist() for k, v in run.read.items()} == {
        k: v.tolist() for k, v in other.read.items()
    }


@pytest.mark.parametrize("run", [RUN, separate_clock()])
def test_pandas_frame_of_a_run_is_read_back_to_the_same_bits(run: Run) -> None:
    pytest.importorskip("pandas")
    frame = run.to_frame()
    assert frame.attrs["name"] == "a"
    assert frame.attrs["units"]["velocity_m_s"] == "m/s"
    assert_equal_runs(Run.from_frame(frame, name="a"), run)
    assert_equal_runs(Run.from_frame(frame.set_index("time_s"), name="a"), run)


@pytest.mark.parametrize("run", [RUN, separate_clock()])
def test_xarray_dataset_of_a_run_is_read_back_to_the_same_bits(run: Run) -> None:
    pytest.importorskip("xarray")
    dataset = run.to_xarray()
    assert dataset["friction_n"].dims == ("time_s",)
    assert dataset["friction_n"].attrs["units"] == "N"
    assert_equal_runs(Run.from_xarray(dataset), run)
    assert Run.from_xarray(dataset, name="b").name == "b"
    wide = dataset.assign(image=(("row", "column"), np.ones((2, 3))))
    assert_equal_runs(Run.from_xarray(wide), run)


def test_units_of_a_run_are_those_of_its_rig() -> None:
    units = run_on(JOINT, RUN).units()
    assert (units["friction_n"], units["velocity_m_s"]) == ("N m", "rad/s")
    assert "own" not in units


@pytest.mark.parametrize(("method", "library"), [("to_frame", "pandas"), ("to_xarray", "xarray")])
def test_missing_optional_library_is_reported_with_its_installation(
    monkeypatch: pytest.MonkeyPatch, method: str, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    assert f"pip install {library}" in str(input_error(getattr(RUN, method)))


def test_object_without_variables_is_rejected_as_a_dataset() -> None:
    for given in (3, {"time_s": TIME_S}):
        assert "xarray" in input_error(Run.from_xarray, given).problem


def test_object_without_named_columns_is_rejected_as_a_frame() -> None:
    assert input_error(columns_of, 3, "r").file == "r"


def test_arrow_stream_is_rejected_without_pyarrow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert "pyarrow" in input_error(columns_of, ExportedByArrow(None), "r").problem


def test_selection_of_a_run_applies_to_all_columns_and_reading_masks() -> None:
    read = {"friction_n": np.arange(SAMPLES) % 2 == 0, "own": np.arange(SAMPLES) > 5}
    run = replace(RUN, read=read, path=Path("f.csv"))
    part = run.select(slice(2, 12, 3))
    assert (part.name, part.path) == ("a", Path("f.csv"))
    for name, values in run.columns().items():
        np.testing.assert_array_equal(part.columns()[name], values[2:12:3])
    assert part.read["friction_n"].tolist() == [True, False, True, False]
    assert part.read["own"].tolist() == [False, False, True, True]
    # A channel with a reading at every remaining sample is without a mask.
    assert set(run.select(np.arange(SAMPLES) > 5).read) == {"friction_n"}
    assert run.select(slice(0, 0)).duration_s == 0.0


@pytest.mark.parametrize("which", [slice(None, None, -1), np.arange(3), np.full(19, True), MASKED])
def test_run_selection_by_other_than_forward_slice_or_mask_is_rejected(which: Any) -> None:
    assert input_error(RUN.select, which).file == "a"


def test_run_at_other_instants_has_interpolated_columns_and_the_given_friction() -> None:
    instants = np.array([0.05, 0.33, 1.9])
    run = replace(RUN, read={"own": np.arange(SAMPLES) > 5})
    moved: Any = run.at(instants, np.array([7.0, 8.0, 9.0]))
    assert (moved.friction.tolist(), moved.read) == ([7.0, 8.0, 9.0], {})
    np.testing.assert_array_equal(moved.time_s, instants)
    np.testing.assert_allclose(moved.velocity, instants + 1.0)
    np.testing.assert_allclose(moved.angle_rad, 3.0 * instants)
    np.testing.assert_allclose(moved.extra["own"], 4.0 * instants)


def test_csv_round_trip_of_a_run_with_extreme_values_is_exact_to_the_bit(tmp_path: Path) -> None:
    special = [5e-324, -5e-324, 2.2e-308, 1e300, -1.797e308, -0.0, 0.1, 1 / 3, 1e22, 2**53]
    random = np.random.default_rng(7)
    powers = 10.0 ** random.integers(-300, 300, 200)
    any_size = np.array([*special, *(random.uniform(-1.0, 1.0, 200) * powers)])
    v = np.clip(any_size, -1e12, 1e12)
    time_s = np.cumsum(random.uniform(1e-9, 1.0, len(any_size)))
    further = {"load_n": np.abs(v) + 5e-324, "extra": {"odd, name": any_size}}
    run = Run.from_arrays(time_s, v, v[::-1], **further)
    run.write_csv(tmp_path / "r.csv")
    again = read_run(tmp_path / "r.csv")
    assert list(again.columns()) == list(run.columns())
    for name, values in run.columns().items():
        assert values.tobytes() == again.columns()[name].tobytes(), name
    assert [path.name for path in tmp_path.iterdir()] == ["r.csv"]


def test_failed_write_of_a_run_leaves_no_file(tmp_path: Path) -> None:
    for path in (tmp_path / "no" / "r.csv", tmp_path):
        with pytest.raises(InputError):
            RUN.write_csv(path)
    assert list(tmp_path.iterdir()) == []


def test_missing_column_is_reported_with_the_law_or_effect_that_needs_it() -> None:
    require(RUN, "angle_rad", "the law")
    require(RUN, ["time_s", "own"], "the law")
    error = input_error(require, RUN, ["own", "load_n"], "the effect sensor_lag")
    assert (error.file, error.column) == ("a", "load_n")
    assert "the effect sensor_lag" in error.problem
    assert input_error(require, replace(RUN, path=Path("f.csv")), "load_n", "x").file == "f.csv"


def test_run_assigned_to_a_rig_has_its_units_and_column_names() -> None:
    assert run_on(Rig.thesis(), RUN) is RUN
    assert run_on(Rig(), RUN).quantities == LINEAR
    joint = run_on(JOINT, RUN)
    assert joint.quantities == JOINT.quantities
    assert run_on(JOINT, joint) is joint
    assert "velocity_rad_s, torque_n_m" in repr(joint)
    assert joint.to_csv().startswith("time_s,angle_rad,velocity_rad_s,torque_n_m,own\n")
    other = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=1.0))
    assert run_on(other, joint).quantities == other.quantities
    assert ROTARY.to_dict() == {"force": "N m", "motion": "rad", "velocity": "rad/s"}


def test_run_is_rejected_by_a_rig_of_another_kind() -> None:
    filed = replace(RUN, path=Path("f.csv"))
    assert input_error(run_on, SLIDE, run_on(JOINT, RUN)).file == "a"
    assert input_error(run_on, Rig.thesis(), run_on(SLIDE, RUN)).file == "a"
    # The meaning of the columns of a file that was read without its rig is unknown.
    assert input_error(run_on, JOINT, filed).file == "f.csv"
    assert run_on(SLIDE, filed).quantities == SLIDE.quantities


def test_pressure_in_bar_is_the_load_only_without_bearing_and_load_column() -> None:
    pressure = {"pressure_pa": np.full(SAMPLES, 3e5)}
    pressed = Run.from_arrays(TIME_S, TIME_S, extra=pressure)
    loaded = Run.from_arrays(TIME_S, TIME_S, load_n=np.full(SAMPLES, 7.0), extra=pressure)
    assert recorded_load(Rig(), RUN) is None
    np.testing.assert_allclose(np.asarray(recorded_load(Rig(), pressed), float), 3.0)
    assert recorded_load(Rig.thesis(), pressed) is None
    assert recorded_load(Rig(), loaded) is loaded.load_n
