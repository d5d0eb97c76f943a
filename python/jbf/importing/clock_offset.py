"""Coarse offset between two clocks, from one signal that both recorded.

The correlation is computed at every lag on a common grid. At each lag it is the Pearson coefficient
over the samples that both records have in common (D. Padfield, "Masked object registration in the
Fourier domain", IEEE Trans. Image Process. 21, 2012). The signals may differ in sign, gain and
offset. Only the samples of a slow record are used, so that it may be aliased.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.importing.spool import Stream

MIN_CORRELATION = 0.8
"""Minimum absolute correlation that is accepted."""
MAX_RIVAL_RATIO = 1.5
"""Largest ratio of unexplained variances for a second offset to count as equally plausible.

The ratio is that of the second offset to the best offset.
"""
MIN_UNEXPLAINED_SHARE = 0.01
"""Share of unexplained variance below which offsets count as equally good."""
MIN_OVERLAP = 0.25
"""Minimum overlap in the search, as a share of the largest overlap."""
LEAST_SAMPLES = 20
"""Minimum number of common samples in an overlap."""
MIN_OVERLAP_VARIANCE = 0.02
"""Minimum variance within an overlap, as a share of the variance of the whole record."""
POINTS = 1 << 20
"""Largest number of grid points of a record."""
PIECE_S = 600.0
"""Duration of the pieces used if drift blurs the correlation of a long record, s."""
PIECES = 8
"""Largest number of such pieces."""
REMEDY = "name another common signal under [align], or the offset in seconds"


@dataclass(frozen=True)
class Offset:
    """Estimated offset between two clocks, to within one lobe of the correlation.

    Attributes
    ----------
    offset_s
        Time added to the times of the other record, s.
    lobe_s
        Largest distance of the true offset from `offset_s`, s.
    pivot_s
        Time of the other record to which the offset refers, s.
    correlation
        Correlation coefficient at this offset.
    """

    offset_s: float
    lobe_s: float
    pivot_s: float
    correlation: float


def find_offset(main: Stream, other: Stream) -> Offset:
    """Estimate the offset of the clock of `other` relative to that of `main`.

    Parameters
    ----------
    main, other
        Streams with the columns time, s, and signal; one segment each.

    Raises
    ------
    InputError
        If the correlation is weak, or several offsets fit. The error names no file.
    """
    first_s, last_s = span(other)
    refused: InputError | None = None
    for begin_s, end_s in _pieces(first_s, last_s):
        try:
            return _offset_of(main, other, begin_s, end_s)
        except InputError as error:
            refused = refused or error
    assert refused is not None
    raise refused


def span(stream: Stream) -> tuple[float, float]:
    """First and last time of a stream, s."""
    return stream.at(0), stream.at(stream.rows - 1)


def usual_step(stream: Stream) -> float:
    """Median time step of a stream, s."""
    times = stream.read(0, 20_000)[:, 0]
    return float(np.median(np.diff(times))) if len(times) > 1 else 1.0


def _pieces(first_s: float, last_s: float) -> Iterator[tuple[float, float]]:
    """Yield the begin and end, s, of pieces of a record."""
    yield first_s, last_s
    if last_s - first_s > 1.5 * PIECE_S:
        for centre in np.linspace(first_s, last_s, PIECES + 2)[1:-1].tolist():
            yield centre - 0.5 * PIECE_S, centre + 0.5 * PIECE_S


def _offset_of(main: Stream, other: Stream, begin_s: float, end_s: float) -> Offset:
    """Estimate the clock offset from the part of `other` between two times."""
    main_s, last_s = span(main)
    longest = max(last_s - main_s, end_s - begin_s)
    step = max(min(usual_step(main), usual_step(other)), longest / POINTS)
    quick = usual_step(main) <= usual_step(other)
    a, in_a = _on_grid(main, main_s, last_s, step, fill=quick)
    b, in_b = _on_grid(other, begin_s, end_s, step, fill=not quick)
    r, allowed = _correlations(a, in_a, b, in_b)
    if not allowed.any():
        raise InputError(
            problem="the common signal is constant or has too few samples", remedy=REMEDY
        )
    offsets: Array = main_s - begin_s + step * np.arange(-len(b) + 1.0, len(a))
    best, low, high = _clear_peak(r, allowed, offsets)
    lobe = step * (max(best - low, high - best) + 2)
    return Offset(float(offsets[best]), lobe, 0.5 * (begin_s + end_s), float(r[best]))


def _on_grid(
    stream: Stream, first_s: float, last_s: float, step: float, *, fill: bool
) -> tuple[Array, Mask]:
    """Standardised means of a signal in the cells of a time grid, and which cells have samples.

    Parameters
    ----------
    fill
        Whether cells between two neighbouring samples are interpolated.
    """
    count = int(np.floor((last_s - first_s) / step + 0.5)) + 1
    total, number = np.zeros(count), np.zeros(count)
    for block in stream.blocks(*stream.rows_between(0, first_s, last_s)):
        finite = block[np.isfinite(block[:, 1])]
        cell = np.clip(np.rint((finite[:, 0] - first_s) / step), 0, count - 1).astype(np.intp)
        total += np.bincount(cell, finite[:, 1], count)
        number += np.bincount(cell, minlength=count)
    has_samples = number > 0
    cells = np.flatnonzero(has_samples)
    if len(cells) < LEAST_SAMPLES:
        raise InputError(problem="the common signal has too few samples", remedy=REMEDY)
    values = total[cells] / number[cells]
    deviation = float(values.std())
    if deviation <= 1e-9 * float(np.abs(values).max()):
        raise InputError(problem="the common signal is constant", remedy=REMEDY)
    values = (values - values.mean()) / deviation
    signal = np.zeros(count)
    if fill:
        signal = np.interp(np.arange(count), cells, values)
        widest = 3.0 * max(float(np.median(np.diff(cells))), 1.0)
        gaps = np.flatnonzero(np.diff(cells) > widest)
        has_samples = np.ones(count, dtype=bool)
        for gap in gaps:
            has_samples[cells[gap] + 1 : cells[gap + 1]] = False
        has_samples[: cells[0]] = has_samples[cells[-1] + 1 :] = False
        signal[~has_samples] = 0.0
    else:
        signal[cells] = values
    return signal, has_samples


def _correlations(a: Array, in_a: Mask, b: Array, in_b: Mask) -> tuple[Array, Mask]:
    """Masked correlation coefficients of `b` with shifted `a`, and a mask of the defined lags.

    The lags are from 1 - len(b) to len(a) - 1.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    size = next_fast_len(len(a) + len(b) - 1, real=True)

    def spectrum(values: Array) -> npt.NDArray[np.complex128]:
        """Fourier transform of a real signal, zero-padded to `size` samples."""
        transform: npt.NDArray[np.complex128] = rfft(values, size)
        return transform

    def sums(left: npt.NDArray[np.complex128], right: npt.NDArray[np.complex128]) -> Array:
        """Sums of products at all lags, from two spectra."""
        circular = irfft(left * right.conj(), size)
        return np.concatenate((circular[size - len(b) + 1 :], circular[: len(a)]))

    f_a, f_aa, m_a = spectrum(a), spectrum(a * a), spectrum(in_a.astype(np.float64))
    f_b, f_bb, m_b = spectrum(b), spectrum(b * b), spectrum(in_b.astype(np.float64))
    n = np.maximum(np.rint(sums(m_a, m_b)), 0.0)
    allowed: Mask = n >= max(LEAST_SAMPLES, MIN_OVERLAP * float(n.max()))
    n = np.maximum(n, 1.0)
    mean_a, mean_b = sums(f_a, m_b) / n, sums(m_a, f_b) / n
    var_a = sums(f_aa, m_b) / n - mean_a**2
    var_b = sums(m_a, f_bb) / n - mean_b**2
    # The signals are standardised, so that the variance of a whole record is 1.
    allowed &= (var_a > MIN_OVERLAP_VARIANCE) & (var_b > MIN_OVERLAP_VARIANCE)
    r = np.zeros(len(n))
    both = np.sqrt(var_a[allowed] * var_b[allowed])
    r[allowed] = (sums(f_a, f_b) / n - mean_a * mean_b)[allowed] / both
    return np.clip(r, -1.0, 1.0), allowed


def _clear_peak(r: Array, allowed: Mask, offsets: Array) -> tuple[int, int, int]:
    """Lag of the largest absolute correlation, and the first and last lag of its lobe.

    Raises
    ------
    InputError
        If the correlation is weak, or a lag outside the lobe explains as much variance.
    """
    best = int(np.argmax(np.abs(r)))
    if abs(r[best]) < MIN_CORRELATION:
        problem = f"the signals are not proportional at any offset (correlation {abs(r[best]):.2f})"
        raise InputError(problem=problem, remedy=REMEDY)
    unexplained = 1.0 - r**2
    alike = allowed & (
        unexplained < MAX_RIVAL_RATIO * max(float(unexplained[best]), MIN_UNEXPLAINED_SHARE)
    )
    places = np.flatnonzero(alike)
    edges = np.flatnonzero(np.diff(places) > 3)
    begins = places[np.concatenate(([0], edges + 1))]
    ends = places[np.concatenate((edges, [len(places) - 1]))]
    lobe = int(np.flatnonzero((begins <= best) & (best <= ends))[0])
    low, high = int(begins[lobe]), int(ends[lobe])
    if len(begins) > 1:
        outside = alike.copy()
        outside[low : high + 1] = False
        rival = int(np.argmax(np.where(outside, np.abs(r), 0.0)))
        problem = (
            f"the common signal repeats: offsets of {offsets[best]:.4g} s and "
            f"{offsets[rival]:.4g} s fit equally (correlation {abs(r[best]):.3f} and "
            f"{abs(r[rival]):.3f})"
        )
        raise InputError(problem=problem, remedy=REMEDY)
    admissible = np.flatnonzero(allowed)
    if low <= admissible[0] + 1 or high >= admissible[-1] - 1:
        problem = (
            f"the common signal does not determine the offset: {offsets[low]:.4g} s to "
            f"{offsets[high]:.4g} s fit equally"
        )
        raise InputError(problem=problem, remedy=REMEDY)
    return best, low, high
