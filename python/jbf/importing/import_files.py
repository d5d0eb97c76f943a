"""Import files as a campaign: read them through a map, cut them and write the runs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from jbf.errors import InputError
from jbf.importing.campaign_folder import check_folder, write_campaign
from jbf.importing.cutting.cut import cut
from jbf.importing.cutting.piece import Piece
from jbf.importing.cutting.trims import trimmed
from jbf.importing.formats.registry import format_of
from jbf.importing.formats.table import Options, Source
from jbf.importing.guess import guess
from jbf.importing.guess_align import with_alignment
from jbf.importing.guess_rig import assumed_machine
from jbf.importing.guessed import Guess
from jbf.importing.ledger import ledger_of
from jbf.importing.map_text import map_text
from jbf.importing.mapping import Map, OpenQuestions, read_map
from jbf.importing.overview import overview
from jbf.importing.recording import check_loads
from jbf.importing.recording import read_recording as spooled
from jbf.importing.result import Import
from jbf.importing.rig_columns import check_rig_columns
from jbf.importing.side_by_side import SideBySide, open_recording
from jbf.importing.spool import Recording
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run
from jbf.text_files import check_readable, path_of, read_text

Report = Callable[[str, int, int], None]
Opener = Callable[[Path, Sequence[PathLike], Options], Source]


def look(path: PathLike, joint: str | None = None, beside: Sequence[PathLike] = ()) -> Guess:
    """Propose a map for a file from its contents.

    Parameters
    ----------
    path
        The file.
    joint
        Name or number of one joint, if the file holds several.
    beside
        Further files that were recorded at the same time with separate clocks.

    Returns
    -------
    Guess
        Columns, rig and open questions; its `map()` contains the answers that are known.

    Raises
    ------
    InputError
        If the file does not exist or is broken, or its library is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> guess = jbf.look("sweep.csv")
    >>> guess.sure, [entry.key for entry in guess.entries][0]
    (True, 'time_s')
    """
    with open_recording(path, _readable_paths(beside)) as source:
        proposal = guess(source, joint)
        return with_alignment(proposal, source) if isinstance(source, SideBySide) else proposal


def import_files(
    files: PathLike | Iterable[PathLike],
    map: PathLike | Map | None = None,
    out: PathLike | None = None,
    *,
    cut_file: PathLike | None = None,
    whole: bool = False,
    replace_folder: bool = False,
    joint: str | None = None,
    beside: Sequence[PathLike] | None = None,
    progress: Report | None = None,
) -> Import:
    """Import recordings as a campaign: runs and a rig.

    Parameters
    ----------
    files : path or iterable of path
        Recordings of any format, all of which one map fits.
    map : path or Map, optional
        The map. Without a map, the contents of the files must be unambiguous.
    out : path, optional
        Folder of the campaign. By default a temporary folder, which is deleted with the result.
    cut_file : path, optional
        Trims (`cut.toml`), which replace the `[cut]` section of the map.
    whole : bool
        Whether recordings remain whole if the map has no cutting method. By default they are then
        cut at their rests.
    replace_folder : bool
        Whether an earlier import in the folder may be replaced.
    joint : str, optional
        Name or number of one joint, if the files hold several; only without a map.
    beside : sequence of path, optional
        Further files of one recording, with separate clocks, which replace those of the map;
        `files` is then one file.
    progress : callable, optional
        Function that is called with a message, the amount done and the total amount.

    Returns
    -------
    Import
        Folder, rig, runs and ledger.

    Raises
    ------
    InputError
        If a file, the map or a unit is invalid, or information is missing; nothing is written.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> imported = jbf.import_files("sweep.csv", whole=True)
    >>> [run.name for run in imported.runs]
    ['sweep']
    """
    paths = _paths(files)
    folder = None if out is None else path_of(out)
    if folder is not None:
        check_folder(folder, replace=replace_folder)
    if joint is not None and map is not None:
        remedy = "omit one of them: the map names the columns"
        raise InputError(problem="both a joint and a map are given", remedy=remedy)
    parent = None if folder is None else folder.resolve().parent
    with read_files(
        paths, map, cut_file=cut_file, whole=whole, joint=joint, beside=beside,
        progress=progress, parent=parent,
    ) as read:  # fmt: skip
        return write_import(read, folder, progress)


@dataclass(frozen=True)
class ReadFiles:
    """Recordings read through a map and cut into pieces, in temporary files.

    Attributes
    ----------
    mapping, text
        The map, and its text.
    rig
        Rig of the recordings.
    recordings, pieces
        The recordings, and their pieces, including those that are left out.
    """

    mapping: Map
    text: str
    rig: Rig
    recordings: list[Recording]
    pieces: list[Piece]


@contextmanager
def read_files(
    files: Sequence[PathLike],
    map: PathLike | Map | None = None,
    *,
    cut_file: PathLike | None = None,
    whole: bool = False,
    joint: str | None = None,
    beside: Sequence[PathLike] | None = None,
    progress: Report | None = None,
    parent: Path | None = None,
    opener: Opener = open_recording,
) -> Iterator[ReadFiles]:
    """Read and cut recordings as `import_files` does, without writing runs.

    Parameters
    ----------
    parent
        Folder in which the temporary files are created; by default that of the system.
    opener
        Function that opens a recording; the default reads it from its file.

    Raises
    ------
    InputError
        As `import_files`.
    """
    paths = _paths(files)
    mapping, text = _map(map, paths, joint, _readable_paths(beside or ()))
    if beside is not None:
        mapping = replace(mapping, beside=_readable_paths(beside))
    _check_further_files(paths, mapping)
    rig = mapping.check()
    check_rig_columns(rig, mapping)
    if cut_file is not None:
        mapping = replace(mapping, cut=replace(mapping.cut, file=path_of(cut_file)))
    if whole and mapping.cut.by is None:
        mapping = replace(mapping, cut=replace(mapping.cut, by=()))
    with TemporaryDirectory(prefix=".jbf-import-", dir=parent) as spool:
        recordings = [
            _read(path, mapping, Path(spool) / str(number), progress, opener)
            for number, path in enumerate(paths)
        ]
        machine = assumed_machine(mapping.rig) if map is None else None
        if machine is not None:
            recordings[0].notes.append(machine)
        pieces = _pieces(recordings, mapping)
        for recording in recordings:
            run_pieces = [p for p in pieces if p.keep and p.file == recording.path.name]
            check_loads(recording, run_pieces, mapping)
        yield ReadFiles(mapping, text, rig, recordings, pieces)


def write_import(
    read: ReadFiles, folder: Path | None = None, progress: Report | None = None
) -> Import:
    """Write the runs, the rig and the ledger of recordings that were read.

    Without a folder the campaign is temporary, and deleted with the result.
    """
    ledger = ledger_of(read.recordings, read.pieces, read.mapping)
    pictures = tuple(overview(recording) for recording in read.recordings)
    temporary = None
    if folder is None:
        temporary = TemporaryDirectory(prefix="jbf-import-")
        folder = Path(temporary.name) / "campaign"
    write_campaign(
        folder, read.rig, read.recordings, read.pieces, read.mapping, read.text, ledger, progress
    )
    return Import(folder, read.rig, tuple(read.pieces), ledger, pictures, temporary)


def read_recording(
    files: PathLike | Iterable[PathLike],
    map: PathLike | Map | None = None,
    *,
    whole: bool = False,
    joint: str | None = None,
    beside: Sequence[PathLike] | None = None,
    progress: Report | None = None,
) -> tuple[Rig, list[Run]]:
    """Read the rig and the runs of recordings as `import_files` does, without writing a folder.

    The parameters are those of `import_files`.

    Returns
    -------
    (Rig, list of Run)
        The rig and the runs.

    Raises
    ------
    InputError
        As `import_files`.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> rig, runs = jbf.read_recording("sweep.csv", whole=True)
    >>> rig.quantities.motion, len(runs)
    ('linear', 1)
    """
    campaign = import_files(files, map, whole=whole, joint=joint, beside=beside, progress=progress)
    return campaign.rig, campaign.runs


def _paths(files: PathLike | Iterable[PathLike]) -> list[Path]:
    """List of the given files, after a check of their types."""
    if isinstance(files, str | os.PathLike) or not isinstance(files, Iterable):
        files = [path_of(files)]
    paths = [path_of(file) for file in files]
    if not paths:
        raise InputError(problem="no file is given", remedy="name at least one recording")
    for at, path in enumerate(paths):
        if not os.path.isdir(path):
            check_readable(path, pipes=False)
        if path.name in [earlier.name for earlier in paths[:at]]:
            raise InputError(
                file=path, problem="another file has the same name", remedy="rename one of them"
            )
    return paths


def _readable_paths(files: Sequence[PathLike]) -> tuple[Path, ...]:
    """Paths of further files of a recording, after a check that each is readable."""
    given = [files] if isinstance(files, str | os.PathLike) else files
    return tuple(_paths(given)) if given else ()


def _check_further_files(paths: Sequence[Path], mapping: Map) -> None:
    """Raise an InputError if several recordings have further files, or one does not exist."""
    if mapping.beside and len(paths) > 1:
        problem = f"{len(paths)} files are given together with further files of one recording"
        remedy = f"name one main file: {paths[0].name}, or omit the others"
        raise InputError(problem=problem, remedy=remedy)
    if mapping.align and not mapping.beside:
        remedy = 'name the further files: beside = ["force.csv"] under [file]'
        raise InputError(file=mapping.path, key="align", problem="contains no files", remedy=remedy)
    _readable_paths(mapping.beside)


def _map(
    given: PathLike | Map | None,
    paths: Sequence[Path],
    joint: str | None,
    beside: Sequence[Path],
) -> tuple[Map, str]:
    """Map to use and its text: the given one, or a proposal if it is certain."""
    if isinstance(given, Map):
        text = "" if given.path is None else read_text(given.path)
        return given, text
    if given is not None:
        return read_map(given), read_text(given)
    proposal = look(paths[0], joint, beside)
    if not proposal.sure:
        lines = [f"{proposal.path}, {question}" for question in proposal.questions]
        remedy = "give a map: jbf import FILE"
        raise OpenQuestions(
            lines, file=proposal.path, problem=str(proposal.questions[0]), remedy=remedy
        )
    return proposal.map(), map_text(proposal)


def _read(
    path: Path, mapping: Map, folder: Path, progress: Report | None, opener: Opener
) -> Recording:
    """Read one recording through a map into temporary files."""
    folder.mkdir()
    with opener(path, mapping.beside, mapping.options) as source:
        recording = spooled(source, mapping, folder, progress)
    recording.format = format_of(path).name
    return recording


def _pieces(recordings: Sequence[Recording], mapping: Map) -> list[Piece]:
    """Cut all recordings into pieces as the map specifies."""
    _unique_names(recordings)
    if mapping.cut.file is not None:
        pieces = trimmed(mapping.cut.file, recordings)
    else:
        pieces = [piece for r in recordings for piece in cut(r, mapping.cut)]
    if not any(piece.keep for piece in pieces):
        why = pieces[0].why if pieces else "it is empty"
        raise InputError(
            file=recordings[0].path,
            problem=f"no run remains: {why}",
            remedy="correct [cut] in the map, or the trims",
        )
    return pieces


def _unique_names(recordings: Sequence[Recording]) -> None:
    """Add the suffix to recording names whose files have equal stems."""
    names = [recording.name for recording in recordings]
    for recording in recordings:
        if names.count(recording.name) > 1:
            recording.name = recording.path.name.replace(".", "_")
