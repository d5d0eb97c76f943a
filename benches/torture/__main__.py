"""Robustness of fits and diagnoses against campaigns with unrealistic properties.

`python benches/torture`. Every case is a rig and a campaign drawn at random (`draw.py`): scales
over six decades, one to four runs, ten to two thousand samples, no motion, one speed, noise alone,
zeros. Each case must have a result, or an error of one line that states what these runs cannot
show. Faults are other exceptions, warnings of a library, numbers that are not finite, values at a
bound, and the verdict `adequate` with an error far above the noise. The limit is `--limit` seconds
of processor time.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from types import FrameType

import jbf
import numpy as np
from draw import Case, draw
from jbf.models.catalogue import parameters_of

FAR_OFF = 3.0
"""Ratio of RMS to noise above which a model of more than a hundred samples is not adequate."""


def out_of_time(_signal: int, _frame: FrameType | None) -> None:
    """Signal handler that raises an exception because the limit of processor time is reached."""
    raise TimeoutError


def complaints(case: Case, fitted: jbf.Fit) -> Iterator[str]:
    """Generate a message for each fault in the numbers of a fit."""
    pages = parameters_of(fitted.model.law, tuple(fitted.model.effects))
    for name, known in fitted.parameters.items():
        page = pages[name]
        if known.note is not None or known.held:
            continue
        if not np.isfinite(known.value) or (known.stderr is not None and known.stderr == np.inf):
            yield f"{name} = {known.value} +/- {known.stderr} without a note"
        elif known.stderr is None:
            yield f"{name} = {known.value:g} has no error, and no note says why"
        if known.value in (page.lower, page.upper):
            yield f"{name} = {known.value:g} is its bound, and no note says so"


def judge(case: Case) -> tuple[str, list[str]]:
    """Fit and diagnose a case; return the result as text, and its faults."""
    wrong: list[str] = []
    try:
        fitted = jbf.fit(case.rig, case.runs, law="stribeck" if case.law == "auto" else case.law)
        wrong += complaints(case, fitted)
        diagnosis = jbf.diagnose(case.rig, case.runs, law=case.law)
    except jbf.JbfError as error:
        message = str(error)
        return message, [*wrong, "more than one line"] if "\n" in message else wrong
    wrong += complaints(case, diagnosis.fit)
    last = diagnosis.steps[-1]
    if not all(np.isfinite([last.rms, last.noise_rms, last.held_out_rms])):
        wrong.append(f"errors {last.rms:g}, {last.noise_rms:g}, {last.held_out_rms:g}")
    samples = sum(map(len, case.runs))
    if (
        diagnosis.verdict == "adequate"
        and samples > 100
        and last.rms > FAR_OFF * case.noise_rms > 0.0
    ):
        wrong.append(f"adequate at {last.rms / case.noise_rms:.1f} times the noise")
    json.dumps(diagnosis.to_dict(), allow_nan=False)
    return diagnosis.verdict, wrong


def tried(seed: int, limit_s: float) -> dict[str, object]:
    """Run the case of a seed; return the result, its faults and the processor time."""
    case = draw(seed)
    signal.signal(signal.SIGPROF, out_of_time)
    signal.setitimer(signal.ITIMER_PROF, limit_s)
    begun = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            message, wrong = judge(case)
        except TimeoutError:
            message, wrong = "", [f"no end in {limit_s:g} s"]
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            message, wrong = "", [f"{error!r} ({Path(place.filename).name}:{place.lineno})"]
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
    caught = [w for w in caught if not issubclass(w.category, jbf.FilmWarning)]
    wrong += sorted({f"{Path(w.filename).name}:{w.lineno}: {w.message}" for w in caught})
    seconds = time.process_time() - begun
    return {"seed": seed, "case": case.words, "said": message, "wrong": wrong, "seconds": seconds}


def kept(path: Path | None) -> list[dict[str, object]]:
    """Read the rows that earlier runs wrote to a file; incomplete lines are skipped."""
    rows = []
    for line in path.read_text("utf-8").splitlines() if path is not None and path.exists() else []:
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def main() -> int:
    """Run the cases, print the faults and count them."""
    parser = argparse.ArgumentParser(prog="torture", description=__doc__.split(":")[0])
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument(
        "--limit", type=float, default=120.0, help="processor time per case, s; default 120"
    )
    parser.add_argument(
        "--out",
        type=Path,
        help="file of JSON lines, one per case; cases that it contains are skipped",
    )
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + options.cases)
    rows = [row for row in kept(options.out) if row["seed"] in seeds]
    remaining = sorted(set(seeds) - {int(str(row["seed"])) for row in rows})
    with ProcessPoolExecutor(options.jobs) as pool:
        for future in as_completed([pool.submit(tried, seed, options.limit) for seed in remaining]):
            row = future.result()
            rows.append(row)
            if options.out is not None:
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
            if row["wrong"]:
                print(
                    f"{row['seed']}: {row['case']}\n    {'; '.join(map(str, row['wrong']))}",
                    flush=True,
                )
    bad = sum(bool(row["wrong"]) for row in rows)
    longest = max(float(str(row["seconds"])) for row in rows)
    print(f"{len(rows)} cases, {bad} with something wrong; the longest took {longest:.0f} s")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
