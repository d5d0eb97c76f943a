"""Tables 6.1 and 6.2 of Cohn (1998): one column fitted, the other two predicted.

Four parameters of the bench's friction are fitted to the seven cells without compensation. The
other thirteen cells are predicted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from jbf.control.bench import FITTED, THESIS_BENCH, THESIS_RIG, Bench, thesis_model
from jbf.control.run import Result, run
from jbf.control.schemes import Coulomb, Learning, NoCompensation, Observed, Scheme
from jbf.control.task import TASKS, Task
from jbf.models.model import Model
from jbf.models.vocabulary import Clock

Report = Callable[[str, int, int], None]

COLUMNS = ("none", "learning", "coulomb")

PRINTED_RMS: dict[str, tuple[float | None, float | None, float | None]] = {
    "position triangle": (0.398, 0.0894, 0.212),
    "position square": (0.232, 0.165, 0.162),
    "position sine": (0.384, 0.0595, 0.0615),
    "velocity sine": (0.468, 0.0304, 0.0386),
    "velocity triangle": (0.359, 0.0337, 0.0482),
    "velocity square": (0.451, 0.0733, None),
    "velocity sine 20.8": (0.210, 0.025, 0.0162),
}
"""RMS errors in Cohn (1998), rad or rad/s, for the schemes none, learning and Coulomb."""

PRINTED_PEAK: dict[str, tuple[float | None, float | None, float | None]] = {
    "position triangle": (0.474, 0.454, 0.296),
    "position square": (None, None, None),
    "position sine": (0.536, 0.350, 0.356),
    "velocity sine": (0.703, 0.127, 0.223),
    "velocity triangle": (0.563, 0.205, 0.296),
    "velocity square": (None, None, None),
    "velocity sine 20.8": (0.519, 0.168, 0.0895),
}
"""Peak errors in Cohn (1998), in the same order and units as `PRINTED_RMS`."""

_FARTHEST = 3.0
"""Largest change of a fitted parameter's logarithm (a factor of 20)."""


@dataclass(frozen=True)
class Cell:
    """One cell of the tables: errors of one scheme on one task.

    Attributes
    ----------
    row, column
        Task and scheme.
    rms, peak
        Errors of the simulated bench, rad or rad/s.
    printed_rms, printed_peak
        Errors in Cohn (1998); None where none is printed.
    true_rms
        RMS of the true error of the shaft on the simulated bench.
    """

    row: str
    column: str
    rms: float
    peak: float
    printed_rms: float | None
    printed_peak: float | None
    true_rms: float

    @property
    def ratio(self) -> float | None:
        """RMS error of the bench divided by the printed one; None without a printed value."""
        return None if self.printed_rms is None else self.rms / self.printed_rms


@dataclass(frozen=True)
class Tables:
    """Both tables, and the friction model and bench with which they were computed.

    Attributes
    ----------
    cells
        Cells by row and column.
    model, bench
        Friction model and bench.
    """

    cells: dict[tuple[str, str], Cell]
    model: Model
    bench: Bench

    def __getitem__(self, key: tuple[str, str]) -> Cell:
        return self.cells[key]

    def column(self, name: str) -> list[Cell]:
        """Cells of one column, in the order of the rows."""
        return [cell for (_, column), cell in self.cells.items() if column == name]

    def replaced(self, replacement: Tables) -> Tables:
        """Return the tables with the cells of `replacement` in place of the same cells."""
        return replace(replacement, cells={**self.cells, **replacement.cells})

    def gains(self) -> dict[str, float]:
        """Improvement of the observed compensator over the schemes of Cohn (1998), by row.

        The improvement is ``min(learning, coulomb) / observed``, in true RMS errors.
        """
        return {
            row: min(self[row, "learning"].true_rms, self[row, "coulomb"].true_rms)
            / self[row, "observed"].true_rms
            for row in PRINTED_RMS
        }

    @property
    def predicted(self) -> list[Cell]:
        """Cells with a printed value that were not fitted."""
        return [c for c in self.cells.values() if c.column in COLUMNS[1:] and c.ratio is not None]

    def within(self, factor: float) -> int:
        """Number of predicted cells within a factor of the printed value."""
        ratios = [c.ratio for c in self.predicted if c.ratio is not None]
        return sum(abs(math.log(r)) <= math.log(factor) for r in ratios)


def _run_rows(work: Callable[[Task], Result], tasks: Mapping[str, Task] = TASKS) -> list[Result]:
    """Run `work` for each task in parallel, and return the results in the order of the tasks."""
    with ThreadPoolExecutor() as pool:
        return list(pool.map(work, tasks.values()))


def fit_friction(
    *,
    elastic: str = "belt",
    clock: Clock = "thesis",
    bench: Bench = THESIS_BENCH,
    report: Report | None = None,
) -> tuple[Model, Bench]:
    """Fit volts per newton, U_tr, K0 and gamma to the seven cells without compensation.

    The fit is by nonlinear least squares on the logarithm of simulated over printed RMS error. It
    starts from the parameters of an earlier fit.
    """
    from scipy.optimize import least_squares

    printed = np.array([PRINTED_RMS[row][0] for row in TASKS], dtype=float)
    calls = 0

    def built(logs: npt.NDArray[np.float64]) -> tuple[Model, Bench]:
        """Model and bench for the logarithms of the four fitted parameters."""
        volts, u_tr, k0, gamma = np.exp(logs).tolist()
        model = thesis_model(elastic=elastic, clock=clock, U_tr_m_s=u_tr, K0=k0, gamma=gamma)
        return model, replace(bench, volts_per_n=volts)

    def misses(logs: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Logarithms of simulated over printed RMS errors."""
        nonlocal calls
        calls += 1
        if report is not None:
            report(f"fitting the bench's friction, evaluation {calls}", 0, 0)
        model, drive = built(logs)
        work = partial(_run_cell, model, NoCompensation(), drive)
        simulated = np.array([r.rms for r in _run_rows(work)])
        return np.asarray(np.log(simulated / printed))

    start = [bench.volts_per_n, FITTED["U_tr_m_s"], FITTED["K0"], FITTED["gamma"]]
    # The cells have noise of order 1e-3: a difference quotient needs a long step.
    best = least_squares(
        misses,
        np.log(start),
        bounds=(np.log(start) - _FARTHEST, np.log(start) + _FARTHEST),
        diff_step=[0.01],
        xtol=1e-4,
        ftol=1e-4,
        max_nfev=20,
    )
    return built(best.x)


def _mean_square_root(values: Sequence[float]) -> float:
    """Root mean square of a sequence of numbers."""
    return float(np.sqrt(np.mean(np.square(values))))


def _run_cell(model: Model, scheme: Scheme, bench: Bench, task: Task) -> Result:
    return run(model, scheme, task, bench=bench)


def tables(
    model: Model,
    bench: Bench,
    *,
    schemes: Mapping[str, Scheme] | None = None,
    tasks: Mapping[str, Task] = TASKS,
    seeds: int = 5,
    report: Report | None = None,
) -> Tables:
    """Simulate all cells of both tables on a bench with a friction model.

    `schemes` maps the names of columns to schemes.

    A cell is the root mean square over several seeds of the noise. `seeds` is the number of runs.
    If the shaft reverses within one encoder count, the instant of the reversal depends on the
    noise, and a single run is not representative.
    """
    columns = standard_schemes(model) if schemes is None else schemes
    cells = {}
    for i, (column, scheme) in enumerate(columns.items()):
        drives = [replace(bench, seed=seed) for seed in range(1, seeds + 1)]
        runs = [_run_rows(partial(_run_cell, model, scheme, drive), tasks) for drive in drives]
        if report is not None:
            report("the tables", i + 1, len(columns))
        for row, *results in zip(tasks, *runs, strict=True):
            at = COLUMNS.index(column) if column in COLUMNS else None
            cells[row, column] = Cell(
                row,
                column,
                _mean_square_root([r.rms for r in results]),
                float(np.mean([r.peak for r in results])),
                None if at is None else PRINTED_RMS[row][at],
                None if at is None else PRINTED_PEAK[row][at],
                _mean_square_root([r.true_rms for r in results]),
            )
    return Tables(cells, model, bench)


def standard_schemes(model: Model) -> dict[str, Scheme]:
    """Schemes of the three columns of Cohn (1998), and the observed compensator, by name."""
    return {
        "none": NoCompensation(),
        "learning": Learning(),
        "coulomb": Coulomb(),
        "observed": Observed(model),
    }


__all__ = [
    "COLUMNS",
    "PRINTED_PEAK",
    "PRINTED_RMS",
    "THESIS_RIG",
    "Cell",
    "Tables",
    "fit_friction",
    "standard_schemes",
    "tables",
]
