"""Run an exported Modelica package along the motions of a reference, where Rumoca is installed."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.export.reference import Reference

MOST_SAMPLES = 5_000
"""Largest number of samples of a run; the time of a simulation grows with its square."""
TOLERANCE = 1e-7
"""Relative tolerance of the solver."""
COLUMNS = {
    "velocity": "velocity",
    "acceleration": "acceleration",
    "position": "angle_rad",
    "weight_offset": "weight_offset_rad",
    "load": "load_n",
    "temperature": "temperature_c",
}
"""Columns of a motion by the name of the input."""


class NotSimulated(Exception):
    """Error of a simulation, with the reason."""


def installed() -> bool:
    """Whether Rumoca is installed."""
    return find_spec("rumoca") is not None


def run_rumoca(
    package: str, name: str, inputs: tuple[str, ...], reference: Reference
) -> list[Array]:
    """Force of the block of a package along the motion of each run, shape (n,).

    Raises
    ------
    NotSimulated
        A run has too many samples, or the simulation fails.
    """
    if max(map(len, reference.runs)) > MOST_SAMPLES:
        raise NotSimulated(f"a run has more than {MOST_SAMPLES} samples")
    engine = import_module("rumoca")
    try:
        return [
            _along(engine, package, name, inputs, reference, i) for i in range(len(reference.runs))
        ]
    except (engine.RumocaError, ValueError) as error:
        raise NotSimulated(" ".join(str(error).split())[:200]) from None


def _along(
    engine: Any, package: str, name: str, inputs: tuple[str, ...], reference: Reference, index: int
) -> Array:
    """Force along one motion, which the model reads from tables."""
    columns = reference.motions[index].motion.columns
    time_s = columns["time_s"] - columns["time_s"][0]
    zero = np.zeros(len(time_s))
    tables = {input_: columns.get(COLUMNS[input_], zero) for input_ in inputs}
    # Between two instants the speed is linear and the position a parabola.
    lines = [
        f"  friction.{input_} = Course.at(time, {list(tables).index(input_) + 1}, "
        f"{'true' if input_ == 'position' else 'false'});"
        for input_ in inputs
    ]
    rows = ", ".join(_cells(np.asarray(values)) for values in tables.values())
    course = f"""
package Course
  constant Real times[{len(time_s)}] = {_cells(time_s)};
  constant Real rows[{len(tables)}, {len(time_s)}] = {{{rows}}};
  function at
    input Real t;
    input Integer row;
    input Boolean curved;
    output Real value;
  protected
    Integer low;
    Integer high;
    Integer middle;
    Real part;
    Real dt;
  algorithm
    low := 1;
    high := {len(time_s)};
    for i in 1:{max(int(np.ceil(np.log2(len(time_s)))), 1)} loop
      middle := div(low + high, 2);
      if high - low > 1 then
        if times[middle] <= t then
          low := middle;
        else
          high := middle;
        end if;
      end if;
    end for;
    dt := times[low + 1] - times[low];
    part := (t - times[low]) / dt;
    value := rows[row, low] + (rows[row, low + 1] - rows[row, low]) * part;
    if curved then
      value := value - 0.5 * part * (1.0 - part) * (rows[1, low + 1] - rows[1, low]) * dt;
    end if;
  end at;
end Course;
model Run
  {name}.Friction friction;
equation
{chr(10).join(lines)}
end Run;
"""
    model = engine.Session().loads(package + course, model="Run")
    config = engine.SimConfig(solver="bdf", rtol=TOLERANCE, atol=TOLERANCE * reference.friction_rms)
    end_s = float(time_s[-1])
    kept = reference.motions[index].kept
    samples = time_s if kept is None else time_s[kept]
    # Results are at uniform instants: those of the samples, where the samples are uniform.
    count = round(end_s / float(np.median(np.diff(samples))))
    result = model.simulate(t=(0.0, end_s), dt=end_s / count, config=config)
    return np.asarray(
        np.interp(samples, np.asarray(result.time), np.asarray(result["friction.force"]))
    )


def _cells(values: Array) -> str:
    return "{" + ", ".join(map(repr, values.tolist())) + "}"
