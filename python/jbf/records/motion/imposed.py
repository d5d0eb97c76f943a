"""From a recorded motion to the motion that was imposed.

A recorded speed carries noise and a recorded angle carries the encoder's steps; the
friction law needs the speed, its sign and its slope. Both records see the same motion, so a
short polynomial is fitted to both at once round each sample, over the longest window that
the data allow: windows grow while the speeds they give agree within their errors (the
intersection of confidence intervals, Goldenshluger & Nemirovski 1997). So a sine is smoothed
over many samples and the corner of a trapezoid over few.

Records of real machines are less tidy than an encoder and a noise: positions finer than any step,
speeds that a filter made from positions and that disagree with them, noise that comes and goes,
rests in which the speed is a hum instead of zero. Each is looked for in the record itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.agreement import contradiction_of, disagreement_of
from jbf.records.motion.believed import NOT_AS_RECORDED, believed
from jbf.records.motion.first_stroke import begins_in_a_hum
from jbf.records.motion.rests import (
    backward_beside_rest,
    place_rests,
    rest_edges,
    resting_samples,
    still_samples,
    unsure_beside_rest,
    without_swings,
)
from jbf.records.motion.roughness import UNEVEN, local_noise, noise_of
from jbf.records.motion.smoothing import smooth
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SIGN_SIGMA = 4.0
"""A speed closer to zero than this many standard errors has no sign to rely on."""
GONE = 3.0
"""A path that has gone so many standard errors from a rest tells which way: one count has."""


@dataclass(frozen=True)
class ImposedMotion:
    """The motion that a model is driven with; all arrays of shape (n,).

    Attributes
    ----------
    velocity_m_s, acceleration_m_s2, angle_rad
        Estimates at the samples.
    velocity_error_m_s
        Standard error of the speed.
    resting
        True where the shaft was at rest.
    sign_known
        False where the sign of the motion, and so of the friction, cannot be known, and where the
        records of path and speed contradict one another.
    findings
        What the recording did to path and speed, and what was done about it.
    """

    velocity_m_s: Array
    acceleration_m_s2: Array
    angle_rad: Array
    velocity_error_m_s: Array
    resting: Mask
    sign_known: Mask
    findings: tuple[Finding, ...] = ()

    @property
    def aside(self) -> set[str]:
        """Columns that were left aside as a whole, or converted."""
        return {finding.channel for finding in self.findings if finding.kind in NOT_AS_RECORDED}

    def at(self, time_s: Array, instants_s: Array) -> ImposedMotion:
        """The motion at other instants within it: on cubics through speed and acceleration.

        Parameters
        ----------
        time_s
            The instants of this motion, s.
        """
        k = np.clip(np.searchsorted(time_s, instants_s) - 1, 0, len(time_s) - 2)
        h = time_s[k + 1] - time_s[k]
        u = np.clip((instants_s - time_s[k]) / h, 0.0, 1.0)
        v0, v1 = self.velocity_m_s[k], self.velocity_m_s[k + 1]
        a0, a1 = self.acceleration_m_s2[k], self.acceleration_m_s2[k + 1]
        rest = self.resting[k] & self.resting[k + 1]
        # Beside a rest the speed is a line from where the shaft starts, or to where it ends.
        corner = self.resting[k] | self.resting[k + 1]
        from_s, to_s = time_s[k].copy(), time_s[k + 1].copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            starts = (v0 == 0.0) & corner & (v1 * a1 > 0.0)
            from_s = np.where(starts, np.maximum(to_s - v1 / a1, from_s), from_s)
            ends = (v1 == 0.0) & corner & (v0 * a0 < 0.0)
            to_s = np.where(ends, np.minimum(from_s - v0 / a0, to_s), to_s)
            gone = np.clip((instants_s - from_s) / (to_s - from_s), 0.0, 1.0)
        line = v0 + np.where(to_s > from_s, gone, u) * (v1 - v0)
        rest |= corner & (line == 0.0)
        cubic = (
            (1.0 + 2.0 * u) * (1.0 - u) ** 2 * v0
            + u * (1.0 - u) ** 2 * h * a0
            + u**2 * (3.0 - 2.0 * u) * v1
            - u**2 * (1.0 - u) * h * a1
        )
        velocity = np.where(corner, line, cubic)
        acceleration = np.where(corner, np.where(self.resting[k], a1, a0), a0 + u * (a1 - a0))
        known = self.sign_known[k] & self.sign_known[k + 1] & (v0 * v1 >= 0.0)
        between = np.abs(u - 0.5) < 0.5
        at_sample = np.where(u < 0.5, self.sign_known[k], self.sign_known[k + 1])
        known = np.where(between, known & (rest | ~corner), at_sample)
        return replace(
            self,
            velocity_m_s=np.where(rest, 0.0, velocity),
            acceleration_m_s2=np.where(rest, 0.0, acceleration),
            angle_rad=np.interp(instants_s, time_s, self.angle_rad),
            velocity_error_m_s=np.maximum(
                self.velocity_error_m_s[k], self.velocity_error_m_s[k + 1]
            ),
            resting=rest,
            sign_known=known.astype(bool),
        )


def impose(run: Run, radius_m: float | None) -> ImposedMotion:
    """Estimate the imposed motion of a run.

    Parameters
    ----------
    run
        The record; its angle or position is used where it is there, else the speed alone.
    radius_m
        Journal radius, m: turns the angle into a path. None where it is not known: a position
        then makes the axis a linear one, which is a rotary one of radius 1 m, and an angle tells
        nothing of the speed.
    """
    records = believed(run, radius_m)
    time, path, speed, step = run.time_s, records.path, records.speed, records.step
    n = len(time)
    rest = resting_samples(speed) if records.speed_measured else np.zeros(n, dtype=bool)
    if path is not None:
        rest |= still_samples(time, path, speed, step, records.hum)
    moving = ~rest
    if path is None:
        steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
        path, sd_path = np.concatenate(([0.0], np.cumsum(steps))), 1e3
    else:
        sd_path, hum = step / np.sqrt(12.0), noise_of(path[moving])
        # Where samples are finer than any encoder's, the smallest change on record is chance.
        if hum > UNEVEN * sd_path:
            sd_path = hum
        sd_path = max(sd_path, 1e-9 * float(np.ptp(path)), 1e-15)
    top = float(np.max(np.abs(speed))) if n else 0.0
    sd_speed = noise_of(speed[moving]) if moving.any() else 0.0
    sd_speed = max(sd_speed, 1e-7 * top, 1e-15)
    beyond = disagreement_of(time, path, speed, sd_path, sd_speed) if n > 1 else 0.0
    # A speed made of the path tells nothing besides.
    usual = max(sd_speed, beyond) if records.speed_measured else 1e3 * max(top, sd_speed)

    contradiction = np.zeros(n)
    if n > 1 and records.speed_measured:
        contradiction = contradiction_of(time, path, speed, sd_path, usual)

    velocity, acceleration = np.where(rest, 0.0, speed), np.zeros(n)
    smooth_path, error = path.copy(), np.zeros(n)
    edges = np.diff(np.concatenate(([0], moving.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        part = slice(first, end)
        if end - first < 3:
            error[part] = max(sd_speed, beyond)
            continue
        local = local_noise(speed[part]) if records.speed_measured else usual
        sd: Array | float = usual
        if isinstance(local, np.ndarray):
            sd = np.maximum(local, usual)
        if contradiction[part].any():
            # A position was read; a speed was made from positions, and the making has its ends.
            sd = np.maximum(sd, contradiction[part])
        smooth_path[part], velocity[part], acceleration[part], error[part] = smooth(
            time[part], path[part], speed[part], sd_path, sd
        )
    place_rests(rest, smooth_path, velocity, acceleration, 0.5 * sd_path * np.sqrt(12.0))
    sign_known = rest | (np.abs(velocity) > SIGN_SIGMA * error)
    sign_known &= (contradiction == 0.0) & ~rest_edges(rest, time, velocity, acceleration)
    sign_known &= ~backward_beside_rest(rest, time, velocity, acceleration) & ~records.loose
    if records.path is not None and not records.speed_measured:
        sign_known &= ~unsure_beside_rest(rest, path, velocity, GONE * sd_path)
    without_swings(rest, velocity, sign_known)
    # A contact that bends begins bent where the run begins in motion: noise is none.
    if n and begins_in_a_hum(time, velocity):
        # Models begin at rest there, whatever its force is.
        sign_known[0] = False
    if n and not sign_known[0]:
        velocity[0] = 0.0
    angle = smooth_path / (radius_m or records.arm_m)
    if records.path is None and radius_m is None and run.angle_rad is not None:
        angle = np.unwrap(run.angle_rad)
    return ImposedMotion(
        velocity,
        acceleration,
        angle,
        error,
        rest,
        sign_known,
        records.findings,
    )
