"""Registry of file formats: a file is recognised by its first bytes, otherwise by suffix.

A format is one module with a function `open_...(path, options) -> Source`, and one line here.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.formats.table import Options, Source, library_errors
from jbf.text_files import check_readable, path_of


@dataclass(frozen=True)
class Format:
    """File format, with the function that opens it.

    Attributes
    ----------
    name
        Name for messages.
    opener
        `module:function` within this package; the module is imported at first use.
    suffixes
        Suffixes of file names, in lower case.
    magic, magic_at
        Bytes that identify the files, and their position.
    library, extra
        Library that reads the format, and the extra of jbf that installs it; empty if none is
        needed.
    """

    name: str
    opener: str
    suffixes: tuple[str, ...]
    magic: tuple[bytes, ...] = ()
    library: str = ""
    extra: str = ""
    magic_at: int = 0

    def open(self, path: Path, options: Options) -> Source:
        """Open a file; raise an InputError if the library is not installed."""
        module, _, function = self.opener.partition(":")
        try:
            opener: Callable[[Path, Options], Source] = getattr(
                import_module(f"jbf.importing.formats.{module}"), function
            )
            with library_errors(path, f"is not a complete file of its kind, {self.name}"):
                return opener(path, options)
        except ModuleNotFoundError as error:
            if not self.extra or (error.name or "").startswith("jbf"):
                raise
            raise self.absent(path) from None

    def absent(self, path: Path) -> InputError:
        """Error for a missing library, which names the package to install."""
        return InputError(
            file=path,
            problem=f"is {self.name}, which requires {self.library}; it is not installed",
            remedy=f"pip install 'jbf[{self.extra}]'",
        )


_HDF = b"\x89HDF\r\n\x1a\n"
FORMATS = (
    Format("a WPILib data log", "wpilog:open_wpilog", (".wpilog",), (b"WPILOG",)),
    Format("MCAP", "mcap_log:open_mcap", (".mcap",), (b"\x89MCAP0",), "mcap", "mcap"),
    Format("a ROS bag", "ros_bag:open_bag", (".bag", ".db3"), (b"#ROSBAG",), "rosbags", "rosbag"),
    Format("MDF", "mdf:open_mdf", (".mf4", ".mdf", ".dat4"), (b"MDF     ",), "asammdf", "mdf"),
    Format("TDMS", "tdms:open_tdms", (".tdms",), (b"TDSm",), "npTDMS", "tdms"),
    Format(
        "Parquet", "parquet:open_parquet", (".parquet", ".pq"), (b"PAR1",), "pyarrow", "parquet"
    ),
    Format("an Excel workbook", "excel:open_excel", (".xlsx", ".xlsm"), (), "openpyxl", "excel"),
    Format("MAT v7.3", "mat73:open_mat73", (), (_HDF,), "h5py", "mat73", 512),
    Format("MAT", "mat:open_mat", (".mat",), (b"MATLAB 5.0",)),
    Format("HDF5", "hdf5:open_hdf5", (".h5", ".hdf5", ".hdf", ".he5"), (_HDF,), "h5py", "hdf5"),
    Format("NumPy", "numpy_arrays:open_arrays", (".npy", ".npz"), (b"\x93NUMPY",)),
    Format(
        "JSON", "json_text:open_json", (".json", ".jsonl", ".ndjson"), (b"{", b"[{", b"[\n", b"[ ")
    ),
    Format(
        "text",
        "csv_text:open_text",
        (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".log", ".prn", ".gz"),
    ),
)


@dataclass(frozen=True)
class Unread:
    """File format that is recognised but not supported.

    Attributes
    ----------
    name
        Name for messages.
    remedy
        Remedy, such as an export to another format.
    suffixes, magic
        Suffixes of its file names, in lower case, and the first bytes of its files.
    """

    name: str
    remedy: str
    suffixes: tuple[str, ...] = ()
    magic: tuple[bytes, ...] = ()


UNREAD = (
    Unread("a TwinCAT Scope recording", "export it as CSV", (".svdx", ".svd", ".svb", ".tcscopex")),
    Unread(
        "an Excel workbook of before 2007",
        "save it as .xlsx",
        (".xls",),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",),
    ),
    Unread("an OpenDocument spreadsheet", "save it as .xlsx", (".ods",)),
    Unread(
        "a bus log of Vector", "convert it to MDF4 with its signals decoded", (".blf",), (b"LOGG",)
    ),
    Unread("a SoMat recording", "export it as CSV", (".sie",)),
    Unread("an imc FAMOS file", "export it as MDF4 or CSV", (".raw",), (b"|CF,",)),
    Unread("a Dewesoft recording", "export it as MDF4 or CSV", (".dxd", ".dxz", ".d7d")),
    Unread("a DIAdem file", "save it as TDMS", (".tdm", ".tdx")),
    Unread("a measurement of TIA Portal", "export it as CSV", (".ttrec", ".ttrecx")),
    Unread("a session of Simulink's Data Inspector", "export it as a MAT file", (".mldatx",)),
    Unread("a PX4 log", "convert it with ulog2csv", (".ulg",), (b"ULog\x01\x12\x35",)),
    Unread("an ArduPilot log", "convert it with mavlogdump.py", (), (b"\xa3\x95\x80\x80",)),
    Unread("an oscilloscope's waveform", "save it as CSV", (".isf", ".wfm", ".wdf", ".wvf")),
    Unread("an Arrow file", "save it as Parquet", (".feather", ".arrow"), (b"ARROW1",)),
    Unread("a Python pickle", "save it as Parquet or CSV", (".pkl", ".pickle")),
    Unread("an archive", "unpack it", (".zip", ".7z", ".tar", ".rar"), (b"7z\xbc\xaf", b"Rar!")),
)


def format_of(path: Path) -> Format:
    """Determine the format of a file; text if no other format matches.

    Raises
    ------
    InputError
        If the file cannot be read, or its format is not supported.
    """
    if os.path.isdir(path):
        # ROS 2 writes a folder.
        if (path / "metadata.yaml").is_file():
            return next(f for f in FORMATS if f.extra == "rosbag")
        raise InputError(file=path, problem="is a folder", remedy="name the files in it")
    check_readable(path, pipes=False)
    with path.open("rb") as file:
        begin = file.read(520)
    for candidate in FORMATS:
        if any(begin.startswith(magic, candidate.magic_at) for magic in candidate.magic):
            return candidate
    suffix = path.suffix.lower()
    for unread in UNREAD:
        by_suffix = suffix in unread.suffixes and not _is_text(begin)
        if by_suffix or begin.startswith(unread.magic):
            problem = f"is {unread.name}{f' ({suffix})' if suffix in unread.suffixes else ''}"
            raise InputError(
                file=path, problem=f"{problem}, which is not supported", remedy=unread.remedy
            )
    by_name = next((f for f in FORMATS if suffix in f.suffixes), None)
    return FORMATS[-1] if by_name is None else by_name


def _is_text(begin: bytes) -> bool:
    """Whether the first bytes of a file are printable characters only, and not XML."""
    xml = begin.lstrip().startswith(b"<")
    return bool(begin) and not xml and all(byte >= 32 or byte in b"\t\r\n" for byte in begin)


def open_source(path: str | os.PathLike[str], options: Options | None = None) -> Source:
    """Open a file of any supported format as a source of tables.

    Raises
    ------
    InputError
        If the file does not exist or is broken, or its library is not installed.
    """
    path = path_of(path)
    return format_of(path).open(path, options or Options())
