"""Task T4: fit of four parameters to eight runs (16,000 points) by jbf and by its peers, in turn.

`python benches/peers.py FOLDER --tasks T4`. The peers' own definition of the task (`t4.py`: data,
start, fit methods) is imported from the copy of their folder. chi2 of every row is computed here
from its parameters by one accurate integration, so that no solver assesses itself.
"""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import ModuleType

import jbf
import numpy as np

RIG = jbf.Rig.thesis()
NAMES = ["f_m", "U_tr_m_s", "K0", "gamma"]
BEST, FIRST = "lmfit, numbalsoda LSODA", "lmfit, solve_ivp LSODA in Python"
CONVERGED = 0.5
"""Largest excess of chi2 over the smallest one for a fit that has converged."""

Found = tuple[np.ndarray, int]
"""Fitted parameters, and the number of simulations of all runs that the fit required."""


@dataclass
class Row:
    """Fit method with the number of timed rounds, and its results."""

    fit: Callable[[], Found]
    rounds: int
    seconds: list[float] = field(default_factory=list)
    found: Found | None = None


def fit_task(rounds: int) -> None:
    """Run the fits in turn and print a table; requires the folder of the peers in `sys.path`."""
    try:
        t4 = importlib.import_module("t4")
    except ImportError as error:
        print(f"\nT4: skipped, {error}: pip install numba numbalsoda lmfit (gfortran builds it)")
        return
    rows = _rows(t4, rounds)
    for row in rows.values():
        row.fit()  # compile, load and fill the cache
    for turn in range(max(row.rounds for row in rows.values())):
        for row in rows.values():
            if turn < row.rounds:
                begin = time.perf_counter()
                row.found = row.fit()
                row.seconds.append(time.perf_counter() - begin)
    _print(t4, rows)


def _rows(t4: ModuleType, rounds: int) -> dict[str, Row]:
    settings = {"rtol": 1e-6, "atol": 1e-8, "seg": 0}
    lsoda = t4.numbalsoda_(2, "lsoda")
    plain = t4.scipy_ivp(2, "LSODA", numba=False)

    def peer(solve: object, fit: Callable[[object], tuple[np.ndarray, float]]) -> Found:
        model = t4.Model(solve, settings)
        values, _ = fit(model)
        return values, model.n

    runs = _runs(t4)
    data = np.split(t4.DATA, len(runs))
    start = dict(zip(NAMES, t4.START.tolist(), strict=True))

    def ours(tolerance: float) -> Found:
        result = jbf.fit_trajectories(
            RIG, runs, data, start=start, tolerance=tolerance, phi_rad=0.01
        )
        return np.array([result.params[name] for name in NAMES]), result.evaluations

    return {
        "jbf.fit_trajectories, tolerance 1e-6": Row(lambda: ours(1e-6), 5 * rounds),
        "jbf.fit_trajectories, tolerance 1e-5": Row(lambda: ours(1e-5), 5 * rounds),
        BEST: Row(lambda: peer(lsoda, lambda m: t4.fit_lmfit(m, 1e-6)), 5 * rounds),
        FIRST: Row(lambda: peer(plain, lambda m: t4.fit_lmfit(m, 1e-6)), 2),
        f"{FIRST}, default epsfcn": Row(lambda: peer(plain, lambda m: t4.fit_lmfit(m, None)), 1),
        "least_squares, numbalsoda LSODA, default diff_step": Row(
            lambda: peer(lsoda, lambda m: t4.fit_ls(m, None)), 1
        ),
    }


def _runs(t4: ModuleType) -> list[tuple[np.ndarray, tuple[float, float, float]]]:
    """Return the peers' runs with shifted first and last samples.

    At these samples the speed is a rounding error, whose sign determines the friction in the data.
    The samples are shifted by 1e-7 of the run's duration in the direction of that sign.
    """
    runs = []
    for times, w in zip(t4.TS, t4.WS, strict=True):
        moved = times.copy()
        for i in (0, -1):
            moved[i] += np.copysign(1e-7 * times[-1], np.sin(w * times[i]))
        runs.append((moved, (t4.A, w, 0.0)))
    return runs


def _chi2(t4: ModuleType, values: Sequence[float]) -> float:
    """Return chi2 of all 16,000 points for the parameters `values`, by numbalsoda at 1e-11."""
    model = t4.Model(t4.numbalsoda_(2, "lsoda"), {"rtol": 1e-11, "atol": 1e-13, "seg": 1})
    return float(np.sum(((model(np.asarray(values)) - t4.DATA) / t4.SIG) ** 2))


def _print(t4: ModuleType, rows: dict[str, Row]) -> None:
    chi2 = {}
    for name, row in rows.items():
        assert row.found is not None
        chi2[name] = _chi2(t4, row.found[0])
    least = min(chi2.values())
    middle = {name: float(np.median(row.seconds)) for name, row in rows.items()}
    print(f"\nT4, 4 parameters, 8 runs, {t4.DATA.size} points; least chi2 {least:.2f}\n")
    print(f"| | median, ms | least | simulations | chi2 - least | `{BEST}` / this | first / this |")
    print("|---|---|---|---|---|---|---|")
    for name, row in rows.items():
        assert row.found is not None
        beyond = chi2[name] - least
        verdict = "" if beyond < CONVERGED else " (not converged)"
        print(
            f"| {name} | {1e3 * middle[name]:.3g} | {1e3 * min(row.seconds):.3g} "
            f"| {row.found[1]} | {beyond:.2g}{verdict} "
            f"| {middle[BEST] / middle[name]:.2f} | {middle[FIRST] / middle[name]:.1f} |"
        )
    print("\nParameters less truth, in standard errors of the fit:")
    sigma = _standard_errors(t4)
    for name, row in rows.items():
        assert row.found is not None
        off = (row.found[0] - t4.TRUE) / sigma
        print(f"  {name}: " + ", ".join(f"{n} {x:+.2f}" for n, x in zip(NAMES, off, strict=True)))
    sys.stdout.flush()


def _standard_errors(t4: ModuleType) -> np.ndarray:
    """Return the standard errors of the parameters at the true values, by exact derivatives."""
    runs = _runs(t4)
    done = jbf.trajectories(
        RIG,
        dict(zip(NAMES, t4.TRUE.tolist(), strict=True)),
        runs,
        phi_rad=0.01,
        derivatives=True,
    )
    jacobian = np.concatenate([d.derivatives for d in done]) / t4.SIG * t4.TRUE
    return t4.TRUE * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
