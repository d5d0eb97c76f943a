"""Motion of a run in the form in which an exported model receives it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.models.chain import estimated_motion
from jbf.models.driven_motion import driven_motion
from jbf.models.model import Model
from jbf.records.run import Run


@dataclass(frozen=True)
class Record:
    """Motion of a run as columns of `jbf_core::run::Record` and of `jbf_record`, shape (m,).

    The instants are the n samples of a run, and those at which the motion starts or stops between
    two samples.

    Attributes
    ----------
    samples
        Indices of the samples of the run among the instants, shape (n,).
    time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n
        The motion and the load. For a drive the units are those of the rig.
    temperature_c, weight_offset_rad
        None if the column was not recorded.
    """

    samples: npt.NDArray[np.intp]
    time_s: Array
    velocity_m_s: Array
    acceleration_m_s2: Array
    angle_rad: Array
    load_n: Array
    temperature_c: Array | None
    weight_offset_rad: Array | None


def record(model: Model, run: Run) -> Record:
    """Compute the motion along which `model.predict` evaluates the signal chain of a model.

    The exported model computes the same bits along this motion. Models with `time_delay` are an
    exception: `predict` averages the force near a jump over its uncertain instant.

    Parameters
    ----------
    model
        The model.
    run
        The run; its friction is not used.

    Raises
    ------
    InputError
        The run lacks a column that an effect of the model requires.

    Examples
    --------
    >>> import jbf.export
    >>> import numpy as np
    >>> time_s = 0.01 * np.arange(100)
    >>> run = jbf.Run.from_arrays(time_s, 0.1 * np.maximum(time_s - 0.503, 0.0))
    >>> record = jbf.export.record(jbf.Model(jbf.Rig(), law="coulomb"), run)
    >>> [round(float(t), 3) for t in record.time_s[50:53]]  # the motion starts at 0.503 s
    [0.5, 0.503, 0.51]
    >>> record.samples[50:52].tolist()
    [50, 52]
    """
    model.require_columns(run)
    driven = driven_motion(model.rig, run, estimated_motion(model.rig, run))
    columns = driven.motion.columns
    return Record(
        samples=np.arange(len(run)) if driven.kept is None else driven.kept,
        time_s=columns["time_s"],
        velocity_m_s=columns["velocity"],
        acceleration_m_s2=columns["acceleration"],
        angle_rad=columns["angle_rad"],
        load_n=columns["load_n"],
        temperature_c=columns.get("temperature_c"),
        weight_offset_rad=columns.get("weight_offset_rad"),
    )
