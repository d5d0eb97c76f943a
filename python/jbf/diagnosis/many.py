"""Diagnosis of many independent campaigns in parallel processes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, as_completed
from typing import Any

from jbf.diagnosis.candidates import Progress
from jbf.diagnosis.recipe import diagnose
from jbf.diagnosis.result import Diagnosis
from jbf.errors import InputError, JbfError
from jbf.estimation.work import TimeLimit
from jbf.models.catalogue import find_clock, find_law
from jbf.models.vocabulary import AUTO
from jbf.records.arguments import check_callable, described, one_of
from jbf.records.folder import read_campaign
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run

Given = tuple[Rig, Sequence[Run]] | PathLike
"""A rig with its runs, or a folder that contains `rig.toml` and the runs as CSV."""

OPTIONS = ("law", "clock", "limits", "policy", "time_limit_s")
"""Options of `diagnose` that may be given for all campaigns."""


def diagnose_many(
    campaigns: Mapping[str, Given],
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, Diagnosis | JbfError]:
    """Diagnose many campaigns; an error in one does not stop the others.

    Parameters
    ----------
    campaigns
        Mapping of names to a rig with its runs, or to a folder that contains `rig.toml` and CSV
        files. The worker process reads the folder.
    executor
        Any `concurrent.futures` executor: processes, a Dask client's `get_executor()`, and so on;
        not shut down. Without one, campaigns are processed sequentially.
    progress
        Called with a campaign's name and verdict, the number of finished campaigns and the total.
    options
        As for `diagnose`: `law`, `clock`, `limits`, `policy`, and `time_limit_s` of each campaign.

    Returns
    -------
    dict
        Diagnosis of each campaign, or the error that it raised, in the given order.

    Raises
    ------
    InputError
        An option is invalid.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> results = jbf.diagnose_many({"slide": (jbf.Rig(), [run])}, law="coulomb")
    >>> results["slide"].verdict
    'adequate'
    """
    for option in options:
        one_of(option, OPTIONS, "option")
    if options.get("law") not in (None, AUTO):
        find_law(options["law"])
    find_clock(options.get("clock", "journal"))
    check_callable(progress, "progress")
    TimeLimit.of(options.get("time_limit_s"))
    if not isinstance(campaigns, Mapping):
        raise InputError(
            problem=f"campaigns is {described(campaigns)}",
            remedy="give a dict of names to (rig, runs), or to a folder",
        )
    results: dict[str, Diagnosis | JbfError] = {}

    def keep(name: str, result: Diagnosis | JbfError) -> None:
        """Store the result of a campaign and report progress."""
        results[name] = result
        if progress is not None:
            outcome = result.verdict if isinstance(result, Diagnosis) else str(result)
            progress(f"{name}: {outcome}", len(results), len(campaigns))

    if executor is None:
        for name, given in campaigns.items():
            keep(name, _diagnosed(given, options))
    else:
        running = {executor.submit(_diagnosed, g, options): n for n, g in campaigns.items()}
        for future in as_completed(running):
            try:
                keep(running[future], future.result())
            except Exception as error:  # a failed worker process: record the error as the result
                keep(running[future], _lost(error))
    return {name: results[name] for name in campaigns}


def _diagnosed(given: Given, options: Mapping[str, Any]) -> Diagnosis | JbfError:
    """Diagnose one campaign; an error of the package is returned, not raised."""
    try:
        pair = given if isinstance(given, tuple) else read_campaign(given)
        if len(pair) != 2:
            raise InputError(
                problem=f"a campaign has {len(pair)} elements",
                remedy="give a rig and a list of runs",
            )
        rig, runs = pair
        return diagnose(rig, runs, **options)
    except JbfError as error:
        return error


def _lost(error: BaseException) -> JbfError:
    """Convert the failure of a worker process to an error that names its cause."""
    return JbfError(f"the worker process failed: {type(error).__name__}: {error}".rstrip(": "))
