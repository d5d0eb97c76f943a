"""Signals in structures of MAT files keep their labels, units and clocks."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import open_source
from jbf.importing.formats.table import Values

N = 400
TIME = np.arange(N) / 100.0
POSITION = 0.05 * np.sin(TIME)
VELOCITY = 0.05 * np.cos(TIME)
FORCE = 3.0 * np.sign(VELOCITY) + 40.0 * VELOCITY


def write_v5(path: Path, content: dict[str, Any]) -> None:
    from scipy.io import savemat

    savemat(path, content)


def write_v73(path: Path, content: dict[str, Any]) -> None:
    """Write structures in the HDF5 layout of MATLAB."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        refs = file.create_group("#refs#")

        def put(parent: Any, name: str, value: Any) -> None:
            if isinstance(value, dict):
                group = parent.create_group(name)
                group.attrs["MATLAB_class"] = np.bytes_("struct")
                for field, item in value.items():
                    put(group, field, item)
            elif isinstance(value, list):
                group = parent.create_group(name)
                group.attrs["MATLAB_class"] = np.bytes_("struct")
                for field in value[0]:
                    cells = []
                    for item in value:
                        reference = f"{len(refs)}"
                        put(refs, reference, item[field])
                        cells.append(refs[reference].ref)
                    group.create_dataset(field, data=np.array(cells, dtype=h5py.ref_dtype)[:, None])
            elif isinstance(value, str):
                parent[name] = np.array([[ord(letter)] for letter in value], dtype=np.uint16)
                parent[name].attrs["MATLAB_class"] = np.bytes_("char")
            else:
                array = np.asarray(value, dtype=np.float64)
                parent[name] = array[None, :] if array.ndim == 1 else array.T
                parent[name].attrs["MATLAB_class"] = np.bytes_("double")

        for name, value in content.items():
            put(file, name, value)
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM"
    with path.open("r+b") as raw:
        raw.write(head)


def columns_of(path: Path) -> dict[str, Values]:
    """Columns of all tables by their names."""
    with open_source(path) as source:
        return {name: v for table in source.tables for name, v in source.head(table).items()}


writers = pytest.mark.parametrize("write", [write_v5, write_v73], ids=["v5", "v7.3"])
Writer = Callable[[Path, dict[str, Any]], None]


@writers
def test_simulink_structure_with_time_is_imported_by_labels_and_seconds(
    write: Writer, tmp_path: Path
) -> None:
    labelled = {"position [m]": POSITION, "<velocity [m/s]>": VELOCITY, "friction [N]": FORCE}
    signals = [
        {"values": values[:, None], "dimensions": 1.0, "label": label, "blockName": "rig/Scope"}
        for label, values in labelled.items()
    ]
    out = {"time": TIME[:, None], "signals": signals, "blockName": "rig/Scope"}
    write(tmp_path / "out.mat", {"ScopeData": out})
    with open_source(tmp_path / "out.mat") as source:
        (table,) = source.tables
    assert table.clock == "time"
    assert [c.name for c in table.columns][1:] == ["position [m]", "velocity [m/s]", "friction [N]"]
    assert jbf.look(tmp_path / "out.mat").sure
    (run,) = jbf.import_files(tmp_path / "out.mat", whole=True).runs
    np.testing.assert_array_equal(run.time_s, TIME)
    np.testing.assert_array_equal(run.position_m, POSITION)
    np.testing.assert_array_equal(run.friction, FORCE)


@writers
def test_two_simulink_structures_keep_their_separate_clocks(write: Writer, tmp_path: Path) -> None:
    slow = {"values": FORCE[::4], "label": "friction [N]"}
    fast = {"values": POSITION, "label": "position [m]"}
    content = {
        "slow": {"time": TIME[::4], "signals": slow},
        "fast": {"time": TIME, "signals": fast},
    }
    write(tmp_path / "out.mat", content)
    with open_source(tmp_path / "out.mat") as source:
        tables = {table.columns[1].name: table for table in source.tables}
        heads = {name: source.head(table) for name, table in tables.items()}
    np.testing.assert_array_equal(heads["friction [N]"]["time"], TIME[::4])
    np.testing.assert_array_equal(heads["position [m]"]["time"], TIME)
    assert jbf.look(tmp_path / "out.mat").sure


@writers
def test_timeseries_as_structures_keep_names_units_and_times(write: Writer, tmp_path: Path) -> None:
    def series(name: str, unit: str, values: Values) -> dict[str, Any]:
        return {
            "Name": name,
            "Time": TIME,
            "TimeInfo": {"Units": "seconds"},
            "Data": values,
            "DataInfo": {"Units": unit},
        }

    logged = {
        "a": series("position", "mm", 1e3 * POSITION),
        "b": {"Values": series("force", "N", FORCE)},
    }
    write(tmp_path / "out.mat", {"logsout": logged})
    with open_source(tmp_path / "out.mat") as source:
        (table,) = source.tables
        head = source.head(table)
    assert {c.name: c.unit for c in table.columns} == {"time": "s", "position": "mm", "force": "N"}
    np.testing.assert_array_equal(head["time"], TIME)
    np.testing.assert_array_equal(head["position"], 1e3 * POSITION)
    assert jbf.look(tmp_path / "out.mat").sure


@writers
def test_signal_of_several_elements_has_a_column_for_each(write: Writer, tmp_path: Path) -> None:
    signal = {"values": np.column_stack([POSITION, FORCE]), "label": "axis"}
    write(tmp_path / "out.mat", {"out": {"time": TIME, "signals": signal}})
    head = columns_of(tmp_path / "out.mat")
    np.testing.assert_array_equal(head["axis column 1"], POSITION)
    np.testing.assert_array_equal(head["axis column 2"], FORCE)


@writers
def test_labels_of_structures_without_time_name_the_columns(write: Writer, tmp_path: Path) -> None:
    content = {
        "X": [{"Name": "time", "Data": TIME}, {"Name": "index", "Data": TIME}],
        "Y": [
            {"Name": "force", "Unit": "N", "Data": FORCE},
            {"Name": "x", "Unit": "m", "Data": POSITION},
        ],
    }
    write(tmp_path / "rec.mat", {"rec": content})
    with open_source(tmp_path / "rec.mat") as source:
        (table,) = source.tables
        head = source.head(table)
    assert table.column("force").unit == "N"
    np.testing.assert_array_equal(head["time"], TIME)
    np.testing.assert_array_equal(head["x"], POSITION)


@writers
def test_truncated_structure_is_refused_in_one_line(write: Writer, tmp_path: Path) -> None:
    signal = {"values": POSITION, "label": "position [m]"}
    write(tmp_path / "out.mat", {"out": {"time": TIME, "signals": signal}})
    data = (tmp_path / "out.mat").read_bytes()
    for share in (0.2, 0.5, 0.9):
        (tmp_path / "cut.mat").write_bytes(data[: int(share * len(data))])
        with pytest.raises(InputError) as refused:
            jbf.look(tmp_path / "cut.mat")
        assert "\n" not in str(refused.value)
