"""Offset between two clocks to a fraction of a sample, and their drift, from a common signal.

Notes
-----
The time of the main record is t + offset + drift (t - pivot), where t is the time of the other
record. The signal with fewer samples is modelled as a linear function of the other signal,
interpolated at those samples. Offset, drift, gain and zero are estimated together by least squares
(Gauss-Newton). Since the residuals are correlated, their covariance is the sandwich estimator for
clustered residuals, with windows as clusters. The drift is kept only if it is significant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.importing.clock_offset import REMEDY, Offset, span, usual_step
from jbf.importing.spool import Stream

MOST_DRIFT = 3e-4
"""Largest drift in the search; several times the drift between two quartz clocks."""
SIGNIFICANT = 5.0
"""Minimum ratio of a drift to its standard error for the drift to be significant."""
LEAST_WINDOWS = 5.0
"""Minimum effective number of windows for the estimate of a drift."""
MIN_DRIFT_STEPS = 0.02
"""Minimum effect of a drift over the record, in steps of the slower record."""
MIN_WINDOW_CORRELATION = 0.5
"""Minimum absolute correlation within windows.

Slow changes of unrelated records may be correlated by chance.
"""
WINDOWS, MOST_SLOW, MOST_FAST = 24, 2_000, 200_000
"""Number of windows, and the largest number of samples of the slow and the fast record in each."""
MAX_TRIAL_SAMPLES = 10_000_000
"""Largest number of samples evaluated on the grid of trial offsets and drifts."""
TRIAL_OFFSETS_PER_STEP = 8
"""Number of trial offsets per step of the slower record."""
ITERATIONS = 20


@dataclass(frozen=True)
class ClockFit:
    """Estimated clock of a record relative to that of the main record.

    Attributes
    ----------
    offset_s, drift, pivot_s
        As in the Notes of this module. The pivot is the middle of the time that both records cover.
    offset_std_s
        Standard error of the offset, s.
    correlation
        Correlation coefficient of the two records of the signal after the correction.
    """

    offset_s: float
    drift: float
    pivot_s: float
    offset_std_s: float
    correlation: float


@dataclass(frozen=True)
class _Window:
    """Samples of the slower record in a window, and the faster record with its slope there."""

    slow_s: Array
    slow: Array
    fast_s: Array
    fast: Array
    slope: Array

    def interpolated(self, at: Array) -> tuple[Array, Array]:
        """Interpolate the faster record and its slope at given instants (cubic Hermite)."""
        index = np.clip(np.searchsorted(self.fast_s, at, side="right") - 1, 0, len(self.fast_s) - 2)
        width = self.fast_s[index + 1] - self.fast_s[index]
        u = np.clip((at - self.fast_s[index]) / width, 0.0, 1.0)
        rise = self.fast[index + 1] - self.fast[index]
        low, high = self.slope[index] * width, self.slope[index + 1] * width
        bend, twist = 3.0 * rise - 2.0 * low - high, low + high - 2.0 * rise
        value = self.fast[index] + u * (low + u * (bend + u * twist))
        return value, (low + u * (2.0 * bend + 3.0 * u * twist)) / width

    def thinned(self, by: int) -> _Window:
        """Return the window with only every `by`-th sample of the slower record."""
        return replace(self, slow_s=self.slow_s[::by], slow=self.slow[::by])


def refine(main: Stream, other: Stream, coarse: Offset) -> ClockFit:
    """Estimate the offset and the drift of a clock, starting from a coarse offset.

    Parameters
    ----------
    main, other
        Streams with the columns time, s, and signal.

    Raises
    ------
    InputError
        If the records are correlated only in their slow changes, which may be due to chance.
    """
    return _Problem(main, other, coarse).solve()


class _Problem:
    """Least-squares problem in offset, drift, gain and zero for one pair of records."""

    def __init__(self, main: Stream, other: Stream, coarse: Offset) -> None:
        self.coarse = coarse
        self.main_is_slow = usual_step(other) < usual_step(main)
        self.step = max(usual_step(main), usual_step(other))
        (first_a, last_a), (first_b, last_b) = span(main), span(other)
        first = max(first_b, first_a - coarse.offset_s)
        last = min(last_b, last_a - coarse.offset_s)
        full_overlap = coarse.pivot_s == 0.5 * (first_b + last_b)
        self.pivot_s = 0.5 * (first + last) if full_overlap else coarse.pivot_s
        self.first_s, self.last_s = first, last
        self.reach_s = coarse.lobe_s + MOST_DRIFT * (last - first)
        self.windows = self._windows(main, other)

    def _windows(self, main: Stream, other: Stream) -> list[_Window]:
        slow, fast = (main, other) if self.main_is_slow else (other, main)
        to_slow = self.coarse.offset_s if self.main_is_slow else 0.0
        to_fast = self.coarse.offset_s - 2.0 * to_slow
        duration = self.last_s - self.first_s
        margin = min(self.reach_s + 2.0 * self.step, 0.05 * duration)
        first, last = self.first_s + margin + to_slow, self.last_s - margin + to_slow
        count = int(np.clip(duration / (20.0 * self.step), 1, WINDOWS))
        edges = np.linspace(first, last, count + 1)
        longest = min(MOST_SLOW * self.step, MOST_FAST * usual_step(fast))
        width = 2 * max(int(self.coarse.lobe_s / usual_step(fast)) // 2, 1) + 1
        windows = []
        for low, high in pairwise(edges.tolist()):
            half = 0.5 * min(high - low, longest)
            middle = 0.5 * (low + high)
            rows = _rows_between(slow, middle - half, middle + half)
            reach = half + self.reach_s + 2.0 * self.step
            around = _rows_between(fast, middle + to_fast - reach, middle + to_fast + reach)
            if len(rows) > 1 and len(around) > 4:
                smooth = _smoothed(around[:, 1], width)
                slope = np.gradient(smooth, around[:, 0])
                windows.append(_Window(rows[:, 0], rows[:, 1], around[:, 0], smooth, slope))
        return windows

    def solve(self) -> ClockFit:
        """Solve for the offset, and the drift if it is significant."""
        start = self._start()
        solution = self._minimise(start, with_drift=True)
        drift, error, clusters = solution[1], *self._drift_error(solution)
        significant = (
            clusters >= LEAST_WINDOWS
            and abs(drift) > SIGNIFICANT * error
            and abs(drift) * (self.last_s - self.first_s) > MIN_DRIFT_STEPS * self.step
        )
        if not significant:
            solution = self._minimise((start[0], 0.0), with_drift=False)
        offset = self._centred(*solution)
        within = self._correlation_within_windows(offset, solution[1])
        if abs(within) < MIN_WINDOW_CORRELATION:
            problem = (
                "the common signal agrees in slow changes only (correlation "
                f"{abs(within):.2f} within windows)"
            )
            raise InputError(problem=problem, remedy=REMEDY)
        covariance = self._covariance((offset, solution[1]), with_drift=False)
        sampling = self._sampling_error(self._effective_windows())
        middle = 0.5 * (self.first_s + self.last_s)
        return ClockFit(
            offset + solution[1] * (middle - self.pivot_s),
            solution[1],
            middle,
            float(np.hypot(covariance[0, 0] ** 0.5, sampling)),
            self._correlation(offset, solution[1]),
        )

    def _start(self) -> tuple[float, float]:
        """Offset, s, and drift with the largest absolute correlation of the records, on a grid."""
        lobe = self.coarse.lobe_s
        spacing = max(self.step / TRIAL_OFFSETS_PER_STEP, lobe / 50.0)
        reach = np.arange(0.0, lobe + spacing, spacing)
        offsets = self.coarse.offset_s + np.concatenate((-reach[:0:-1], reach))
        half = np.ceil(MOST_DRIFT * (self.last_s - self.first_s) / max(lobe, self.step))
        drifts = np.linspace(-MOST_DRIFT, MOST_DRIFT, 2 * int(half) + 1) if half > 1 else [0.0]
        trials = [(float(offset), float(drift)) for drift in drifts for offset in offsets]
        every = self.windows
        samples = sum(len(window.slow) for window in every)
        self.windows = [
            w.thinned(max(samples * len(trials) // MAX_TRIAL_SAMPLES, 1)) for w in every
        ]
        best = min(trials, key=lambda trial: 1.0 - self._correlation(*trial) ** 2)
        self.windows = every
        return best

    def _model(self, offset: float, drift: float) -> tuple[Array, Array, Array, Array]:
        """Values of both records at the samples of the slower record, and their derivatives.

        Returns
        -------
        slow, fast
            Values of the slower record, and of the faster record interpolated at the same instants.
        by_offset, by_drift
            Derivatives of `fast` with respect to the clock offset and to the clock drift.
        """
        slow, fast, by_offset, by_drift = [], [], [], []
        for window in self.windows:
            if self.main_is_slow:
                at = (window.slow_s - offset + drift * self.pivot_s) / (1.0 + drift)
                lever = -(at - self.pivot_s)
                sign = -1.0
            else:
                lever = window.slow_s - self.pivot_s
                at = window.slow_s + offset + drift * lever
                sign = 1.0
            value, slope = window.interpolated(at)
            slow.append(window.slow)
            fast.append(value)
            by_offset.append(sign * slope)
            by_drift.append(lever * slope)
        return (
            np.concatenate(slow),
            np.concatenate(fast),
            np.concatenate(by_offset),
            np.concatenate(by_drift),
        )

    def _correlation(self, offset: float, drift: float) -> float:
        slow, fast, *_ = self._model(offset, drift)
        slow, fast = slow - slow.mean(), fast - fast.mean()
        power = float(slow @ slow) * float(fast @ fast)
        return float(slow @ fast) / power**0.5 if power > 0.0 else 0.0

    def _correlation_within_windows(self, offset: float, drift: float) -> float:
        """Correlation of both records after subtraction of their means in each window."""
        slow, fast, *_ = self._model(offset, drift)
        ends = np.cumsum([len(window.slow) for window in self.windows])[:-1]
        slow, fast = (
            np.concatenate([part - part.mean() for part in np.split(values, ends)])
            for values in (slow, fast)
        )
        power = float(slow @ slow) * float(fast @ fast)
        return float(slow @ fast) / power**0.5 if power > 0.0 else 0.0

    def _linearised(self, at: tuple[float, float], *, with_drift: bool) -> tuple[Array, Array]:
        """Residuals and design matrix (zero, gain, offset, drift) at a point, shape (n, 3 or 4)."""
        slow, fast, by_offset, by_drift = self._model(*at)
        mean = fast.mean()
        centred = fast - mean
        power = float(centred @ centred)
        gain = float(centred @ slow) / power if power > 0.0 else 0.0
        columns = [np.ones(len(slow)), centred, gain * by_offset]
        if with_drift:
            columns.append(gain * by_drift)
        return slow - slow.mean() - gain * centred, np.column_stack(columns)

    def _minimise(self, start: tuple[float, float], *, with_drift: bool) -> tuple[float, float]:
        """Minimise the sum of squares by Gauss-Newton iterations; return the best point visited."""
        best = point = start
        smallest = 1.0 - self._correlation(*start) ** 2
        lever = max(self.last_s - self.first_s, self.step)
        for _ in range(ITERATIONS):
            residual, design = self._linearised(point, with_drift=with_drift)
            change = np.linalg.lstsq(design, residual, rcond=None)[0]
            by = np.clip(change[2], -self.step, self.step)
            drift_by = (
                np.clip(change[3], -self.step / lever, self.step / lever) if with_drift else 0
            )
            point = (
                float(np.clip(point[0] + by, *self._offset_bounds())),
                float(np.clip(point[1] + drift_by, -MOST_DRIFT, MOST_DRIFT)),
            )
            misfit = 1.0 - self._correlation(*point) ** 2
            if misfit < smallest:
                best, smallest = point, misfit
            if abs(by) < 1e-4 * self.step and abs(drift_by) * lever < 1e-4 * self.step:
                break
        return best

    def _offset_bounds(self) -> tuple[float, float]:
        """Lower and upper bound of the offset, s."""
        reach = self.coarse.lobe_s + self.step
        return self.coarse.offset_s - reach, self.coarse.offset_s + reach

    def _centred(self, offset: float, drift: float) -> float:
        """Middle of the range of offsets that fit equally well.

        Such a range of offsets exists between two edges of a square wave.
        """
        if self.coarse.lobe_s >= 2.0 * self.step:
            return offset  # a smooth signal: Gauss-Newton finds its minimum
        around = offset + np.linspace(-1.0, 1.0, 8 * TRIAL_OFFSETS_PER_STEP + 1) * self.step
        misfits = np.array([1.0 - self._correlation(o, drift) ** 2 for o in around])
        level = misfits.min() + 0.02 * (min(misfits[0], misfits[-1]) - misfits.min())
        alike = np.flatnonzero(misfits <= level)
        if not alike.size or np.ptp(alike) + 1 > alike.size:
            return offset
        middle = offset + (float(np.mean(alike)) / (4 * TRIAL_OFFSETS_PER_STEP) - 1.0) * self.step
        return middle if abs(middle - offset) > 0.1 * self.step else offset

    def _covariance(self, at: tuple[float, float], *, with_drift: bool) -> Array:
        """Covariance of the offset, or of offset and drift, shape (1, 1) or (2, 2)."""
        residual, design = self._linearised(at, with_drift=with_drift)
        scores = design[:, 2:] * residual[:, None]
        ends = np.cumsum([len(window.slow) for window in self.windows])[:-1]
        meat = np.zeros((scores.shape[1], scores.shape[1]))
        for part in np.split(scores, ends):
            score = part.sum(axis=0)
            meat += np.outer(score, score)
        bread = np.linalg.pinv(self._curvature(at, with_drift=with_drift))
        count = max(len(self.windows), 2)
        covariance: Array = bread @ meat @ bread * count / (count - 1)
        return covariance

    def _curvature(self, at: tuple[float, float], *, with_drift: bool) -> Array:
        """Hessian of half the sum of squares, by finite differences.

        The Gauss-Newton approximation would include the noise of the slopes, which does not
        determine the offset.
        """
        by = max(0.25 * self.step, 0.25 * self.coarse.lobe_s)
        steps = np.diag([by, 4.0 * by / max(self.last_s - self.first_s, self.step)])
        slow, *_ = self._model(*at)
        power = len(slow) * float(np.var(slow))

        def squares(change: Array) -> float:
            misfit = 1.0 - self._correlation(at[0] + change[0], at[1] + change[1]) ** 2
            return 0.5 * power * misfit

        size = 2 if with_drift else 1
        hessian = np.zeros((size, size))
        for i in range(size):
            for j in range(i + 1):
                a, b = steps[i], steps[j]
                mixed = squares(a + b) - squares(a - b) - squares(b - a) + squares(-a - b)
                hessian[i, j] = hessian[j, i] = mixed / (4.0 * a[i] * b[j])
        return hessian

    def _drift_error(self, at: tuple[float, float]) -> tuple[float, float]:
        """Standard error of the drift, and the effective number of windows."""
        covariance = self._covariance(at, with_drift=True)
        effective = self._effective_windows()
        error = float(np.sqrt(max(covariance[1, 1], 0.0)))
        # An edge is uncertain by one sample in either record.
        sampling = 7.0 * self._sampling_error(effective) / (self.last_s - self.first_s)
        return float(np.hypot(error, sampling)), effective

    def _effective_windows(self) -> float:
        """Effective number of windows with information on the drift."""
        # Weights are variances of the signal: where it is constant, its slope is mostly noise.
        weights = [float(np.var(window.slow)) for window in self.windows]
        total = sum(weight**2 for weight in weights)
        return float(sum(weights) ** 2 / total) if total > 0.0 else 0.0

    def _sampling_error(self, windows: float) -> float:
        """Standard error of the offset due to the sampling interval at edges of the signal, s."""
        if self.coarse.lobe_s >= 2.0 * self.step:
            return 0.0
        return float(self.step / np.sqrt(12.0 * max(windows, 1.0)))


def _rows_between(stream: Stream, first_s: float, last_s: float) -> Array:
    """Rows of a stream between two instants that have a value."""
    rows = stream.read(*stream.rows_between(0, first_s, last_s))
    return rows[np.isfinite(rows[:, 1])]


def _smoothed(values: Array, width: int) -> Array:
    """Smooth values by a moving mean over an odd number of samples, applied three times.

    The noise of interpolated values is then equal between samples and at samples. This prevents a
    bias of the estimate towards either.
    """
    from scipy.ndimage import uniform_filter1d

    smoothed = np.asarray(values, dtype=np.float64)
    for _ in range(3):
        smoothed = uniform_filter1d(smoothed, width, mode="nearest")
    return smoothed
