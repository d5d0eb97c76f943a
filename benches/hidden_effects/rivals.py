"""Simpler rules that select effects for the same runs, each with its best setting."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import jbf
import numpy as np
import numpy.typing as npt
from motion_errors import held_out

Array = npt.NDArray[np.float64]

MOST_STEPS = 3
THRESHOLDS = (0.003, 0.01, 0.03, 0.1, 0.3)


class Rivals:
    """Simpler rules that select effects for the runs of a rig.

    Some rules also use the errors on other runs of the rig. Fits are stored and reused.
    """

    def __init__(self, rig: jbf.Rig, runs: list[jbf.Run], others: list[jbf.Run]) -> None:
        self.rig, self.runs, self.others = rig, runs, others
        self._fits: dict[frozenset[str], jbf.Fit | None] = {}

    def fit(self, effects: Sequence[str]) -> jbf.Fit | None:
        """Return the fit of the law with these effects, or None if the runs cannot show them."""
        key = frozenset(effects)
        if key not in self._fits:
            try:
                self._fits[key] = jbf.fit(self.rig, self.runs, effects=list(effects))
            except jbf.InputError:
                self._fits[key] = None
        return self._fits[key]

    @cached_property
    def bare(self) -> jbf.Fit:
        """Fit of the law without effects."""
        fitted = self.fit(())
        assert fitted is not None
        return fitted

    def always_adequate(self) -> list[str]:
        """Select no effect."""
        return []

    def lowest_mae(self) -> list[str]:
        """Select the single effect, or none, with the lowest mean absolute error on other runs.

        Complete friction models are often compared in this way.
        """
        best: list[str] = []
        lowest = held_out(self.bare.model, self.others)["mae_n"]
        for name in jbf.effects():
            fit = self.fit([name])
            error = math.inf if fit is None else held_out(fit.model, self.others)["mae_n"]
            if error < lowest:
                best, lowest = [name], error
        return best

    def bic(self) -> list[str]:
        """Add effects one by one while the BIC, with independent residuals, decreases."""

        def score(fit: jbf.Fit) -> float:
            free = len(fit.parameters)
            return fit.nobs * 2.0 * math.log(fit.rms) + free * math.log(fit.nobs)

        chosen: list[str] = []
        best = score(self.bare)
        while len(chosen) < MOST_STEPS:
            fits = {n: self.fit([*chosen, n]) for n in jbf.effects() if n not in chosen}
            scores = {n: score(fit) for n, fit in fits.items() if fit is not None}
            name = min(scores, key=scores.__getitem__)
            if scores[name] >= best:
                break
            best = scores[name]
            chosen.append(name)
        return chosen

    def sparse_regression(self) -> list[str]:
        """Select effects by sparse regression of the residual of the base law.

        The method is sequentially thresholded least squares (pysindy). The regressors are the
        changes of the prediction by each effect at its starting values. The threshold is the one
        with the smallest error on other runs.
        """
        from pysindy.optimizers import STLSQ

        library, residual = self._library(self.runs)
        seen, unseen = self._library(self.others)
        size = np.linalg.norm(library, axis=0) / math.sqrt(len(residual))
        active = np.flatnonzero(size > 1e-9)
        names = [list(jbf.effects())[i] for i in active]
        scale = float(np.std(residual))
        best, lowest = np.zeros(len(active)), float(np.mean(unseen**2))
        for threshold in THRESHOLDS:
            optimizer: Any = STLSQ(threshold=threshold, alpha=1e-3, max_iter=50)
            try:
                optimizer.fit(library[:, active] / size[active], residual[:, None] / scale)
            except Exception:  # no term survives this threshold
                continue
            weights = np.ravel(optimizer.coef_) * scale / size[active]
            error = float(np.mean((unseen - seen[:, active] @ weights) ** 2))
            if error < lowest:
                best, lowest = weights, error
        return [name for name, weight in zip(names, best, strict=True) if weight != 0.0]

    def _library(self, runs: list[jbf.Run]) -> tuple[Array, Array]:
        law_values = dict(zip(self.bare.parameters, self.bare.model.values.tolist(), strict=True))
        base = np.concatenate([self.bare.model.predict(run) for run in runs])
        record = np.concatenate([run.friction for run in runs if run.friction is not None])
        columns = []
        for effect in jbf.effects().values():
            values = {f"{effect.name}.{p.name}": p.starts[0] for p in effect.parameters}
            try:
                model = jbf.Model(self.rig, effects=[effect.name], parameters=law_values | values)
                columns.append(np.concatenate([model.predict(run) for run in runs]) - base)
            except jbf.InputError:
                columns.append(np.zeros_like(base))
        return np.stack(columns, axis=1), record - base


RULES: dict[str, Callable[[Rivals], list[str]]] = {
    "lowest_mae": Rivals.lowest_mae,
    "bic": Rivals.bic,
    "sparse_regression": Rivals.sparse_regression,
    "always_adequate": Rivals.always_adequate,
}
