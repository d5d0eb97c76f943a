"""Write one recording in every file format that can be imported.

Each library is imported where it is used; without it the test is skipped.
"""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

Array = npt.NDArray[np.float64]
Columns = dict[str, Array]
UNITS = {"position_m": "m", "velocity_m_s": "m/s", "friction_n": "N", "load_n": "N"}
NS = 10**9


def rows(columns: Columns) -> list[list[float]]:
    result: list[list[float]] = np.column_stack(list(columns.values())).tolist()
    return result


def stamps(columns: Columns) -> list[int]:
    """Time stamps in integer nanoseconds."""
    return [round(t * NS) for t in columns["time_s"].tolist()]


def without_time(columns: Columns) -> Columns:
    return {name: values for name, values in columns.items() if name != "time_s"}


def csv(path: Path, columns: Columns) -> None:
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows(columns))]
    path.write_text("\n".join(lines) + "\n")


def npz(path: Path, columns: Columns) -> None:
    np.savez(path, **columns)  # type: ignore[arg-type]


def json_arrays(path: Path, columns: Columns) -> None:
    content = {"rig": {"operator": "Kim"}, "data": {k: v.tolist() for k, v in columns.items()}}
    path.write_text(json.dumps(content, indent=1))


def json_records(path: Path, columns: Columns) -> None:
    path.write_text(json.dumps([dict(zip(columns, row, strict=True)) for row in rows(columns)]))


def json_lines(path: Path, columns: Columns) -> None:
    records = [json.dumps(dict(zip(columns, row, strict=True))) for row in rows(columns)]
    path.write_text("\n".join(records) + "\n")


def trace(path: Path, columns: Columns) -> None:
    lines = ["[key]; [value]", "Version; 0x03050000", "EveryNCycles; 1"]
    for number, (name, values) in enumerate(without_time(columns).items()):
        lines += [f"{number}.Variable; {name}", f"{number}.Class; 14", f"{number}.Data; "]
        pairs = zip(columns["time_s"].tolist(), values.tolist(), strict=True)
        lines += [f"; {time!r}; {value!r}" for time, value in pairs]
    path.write_text("\n".join(lines) + "\n")


def mat(path: Path, columns: Columns) -> None:
    from scipy.io import savemat

    savemat(path, columns, do_compression=True)


def mat_structure(path: Path, columns: Columns) -> None:
    from scipy.io import savemat

    savemat(path, {"log": columns})


def mat73(path: Path, columns: Columns) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in columns.items():
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM"
    with path.open("r+b") as raw:
        raw.write(head)


def hdf5(path: Path, columns: Columns) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name, values in columns.items():
            file[f"bench/{name}"] = values


def parquet(path: Path, columns: Columns) -> None:
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    pq.write_table(pa.table(columns), path, row_group_size=100_000)


def excel(path: Path, columns: Columns) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet("Run")
    sheet.append(list(columns))
    for row in rows(columns):
        sheet.append(row)
    book.save(path)


def tdms(path: Path, columns: Columns) -> None:
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([nptdms.ChannelObject("log", n, v) for n, v in columns.items()])


def tdms_waveform(path: Path, columns: Columns) -> None:
    nptdms = pytest.importorskip("nptdms")
    step = float(columns["time_s"][1] - columns["time_s"][0])
    channels = [
        nptdms.ChannelObject("log", n, v, {"wf_increment": step, "unit_string": UNITS[n]})
        for n, v in without_time(columns).items()
    ]
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(channels)


def mdf4(path: Path, columns: Columns) -> None:
    asammdf = pytest.importorskip("asammdf")
    signals = [
        asammdf.Signal(v, columns["time_s"], name=n, unit=UNITS[n])
        for n, v in without_time(columns).items()
    ]
    file = asammdf.MDF(version="4.10")
    file.append(signals)
    file.save(path, overwrite=True)
    file.close()


def mdf4_groups(path: Path, columns: Columns) -> None:
    """Write each channel into its own group with its own master."""
    asammdf = pytest.importorskip("asammdf")
    file = asammdf.MDF(version="4.10")
    for name, values in without_time(columns).items():
        file.append([asammdf.Signal(values, columns["time_s"], name=name, unit=UNITS[name])])
    file.save(path, overwrite=True)
    file.close()


def mcap_json(path: Path, columns: Columns) -> None:
    writers = pytest.importorskip("mcap.writer")
    with path.open("wb") as file:
        writer = writers.Writer(file)
        writer.start()
        schema = writer.register_schema("axis", "jsonschema", b"{}")
        channel = writer.register_channel("/axis", "json", schema)
        values = without_time(columns)
        for stamp, row in zip(stamps(columns), rows(values), strict=True):
            data = json.dumps(dict(zip(values, row, strict=True))).encode()
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()


_AXIS = "\n".join(f"float64 {name}" for name in UNITS)


def mcap_ros2(path: Path, columns: Columns) -> None:
    writers = pytest.importorskip("mcap_ros2.writer")
    with path.open("wb") as file:
        writer = writers.Writer(file)
        schema = writer.register_msgdef("bench_msgs/msg/Axis", _AXIS + "\n")
        values = without_time(columns)
        for stamp, row in zip(stamps(columns), rows(values), strict=True):
            message = dict(zip(values, row, strict=True))
            writer.write_message("/axis", schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()


def ros2_bag(path: Path, columns: Columns) -> None:
    bags = pytest.importorskip("rosbags.rosbag2")
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    kind = "bench_msgs/msg/Axis"
    store.register(typesys.get_types_from_msg(_AXIS, kind))
    with bags.Writer(path, version=8) as writer:
        connection = writer.add_connection("/axis", kind, typestore=store)
        for stamp, row in zip(stamps(columns), rows(without_time(columns)), strict=True):
            raw = store.serialize_cdr(store.types[kind](*row), kind)
            writer.write(connection, stamp, raw)


def ros1_bag(path: Path, columns: Columns) -> None:
    bags = pytest.importorskip("rosbags.rosbag1")
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
    kind = "bench_msgs/msg/Axis"
    store.register(typesys.get_types_from_msg(_AXIS, kind))
    with bags.Writer(path) as writer:
        connection = writer.add_connection("/axis", kind, typestore=store)
        for stamp, row in zip(stamps(columns), rows(without_time(columns)), strict=True):
            raw = store.serialize_ros1(store.types[kind](*row), kind)
            writer.write(connection, stamp, raw)


WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    "r.csv": csv,
    "r.npz": npz,
    "arrays.json": json_arrays,
    "records.json": json_records,
    "r.jsonl": json_lines,
    "trace.csv": trace,
    "r.mat": mat,
    "structure.mat": mat_structure,
    "r73.mat": mat73,
    "r.h5": hdf5,
    "r.parquet": parquet,
    "r.xlsx": excel,
    "r.tdms": tdms,
    "waveform.tdms": tdms_waveform,
    "r.mf4": mdf4,
    "groups.mf4": mdf4_groups,
    "json.mcap": mcap_json,
    "ros2.mcap": mcap_ros2,
    "bag": ros2_bag,
    "ros1.bag": ros1_bag,
}
"""Writers by file name."""
