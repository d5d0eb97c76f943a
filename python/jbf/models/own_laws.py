"""Laws of one's own: a function of recorded columns in the place of a law of the catalogue.

>>> import numpy as np
>>> import jbf
>>> def tanh_law(velocity_m_s, F_c_n, v_0_m_s, F_v_n_s_m):
...     return F_c_n * np.tanh(velocity_m_s / v_0_m_s) + F_v_n_s_m * velocity_m_s
>>> jbf.register_law(
...     tanh_law,
...     parameters=[
...         jbf.Parameter("F_c_n", "N", lower=0.0, upper=1e3, starts=(5.0,)),
...         jbf.Parameter("v_0_m_s", "m/s", lower=1e-5, upper=1.0, starts=(1e-3,), log=True),
...         jbf.Parameter("F_v_n_s_m", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
...     ],
... ).name
'tanh_law'
>>> jbf.forget_law("tanh_law")
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError, quoted
from jbf.models import catalogue
from jbf.models.catalogue import Law, Parameter
from jbf.models.own_effects import OwnEffect, check_pages, columns_of
from jbf.models.vocabulary import AUTO

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class OwnLaw(Law):
    """A law of one's own: its page, and the force behind it."""

    force: OwnEffect | None = None

    def steady_n(self, velocity_m_s: Array, values: Sequence[float], load_n: float | None) -> Array:
        """The force at steady speeds, N, where it asks for nothing but speed, load and time."""
        assert self.force is not None
        zero = np.zeros_like(velocity_m_s)
        columns = {"time_s": zero, "velocity_m_s": velocity_m_s, "acceleration_m_s2": zero}
        if load_n is not None:
            columns["load_n"] = np.full_like(velocity_m_s, load_n)
        return self.force.force(columns, values)


def register_law(
    function: Callable[..., Any],
    *,
    parameters: Sequence[Parameter],
    name: str | None = None,
    summary: str = "",
    equation: str = "",
    source: str = "",
    limits: str = "",
) -> Law:
    """Put a law of your own beside those of the catalogue, for machines without a journal bearing.

    It then has its name everywhere (`law=`, `--law`, `--law auto`, model files) until the process
    ends; a second law of that name takes the first one's place. The effects that add to a law's
    force or act on the sum (the stages `other friction` and `instrument`) go with it.

    Parameters
    ----------
    function
        Gives the friction force, N, at every sample, shape (n,), signed as the motion is. Its
        arguments are found by name, as those of `register_effect`: columns, arrays of shape (n,),
        and the parameters, numbers. It is called for each run alone; a law with a state can be
        computed from the whole arrays.
    parameters
        Named, bounded parameters with starting values; none needs a null.
    name
        Its name; that of the function by default.
    summary, equation, source, limits
        For `jbf effects` and reports.

    Raises
    ------
    InputError
        A name that is taken or no identifier, a parameter without bounds or start, or an argument
        of the function that is neither parameter nor column name.
    """
    own = name if name is not None else function.__name__
    pages = tuple(parameters)

    def wrong(problem: str, mend: str) -> InputError:
        return InputError(problem=f"the law {quoted(own)} {problem}", mend=mend)

    if not own.isidentifier() or own == AUTO:
        raise wrong("has no proper name", f"use letters, digits and _, not {AUTO}: name=...")
    if own in catalogue.built_in_laws():
        raise wrong("is in the catalogue already", "choose another name")
    check_pages(pages, wrong)
    words = {
        "summary": summary or (inspect.getdoc(function) or "a law of one's own").splitlines()[0],
        "equation": equation or "a function of one's own",
        "source": source or f"{getattr(function, '__module__', 'unknown')}",
        "limits": limits or "as its author knows them",
    }
    force = OwnEffect(
        name=own,
        stage="other friction",
        needs=(),
        refused={},
        moves_jumps=False,
        spreads_jumps=False,
        peaks=None,
        longest_step_s=np.inf,
        parameters=pages,
        columns=columns_of(function, pages, wrong),
        function=function,
        called="law",
        summary=words["summary"],
        equation=words["equation"],
        source=words["source"],
        limits=words["limits"],
    )
    page = OwnLaw(
        name=own,
        needs_bearing=False,
        has_film=False,
        has_bristle=False,
        rust_type="",
        parameters=pages,
        force=force,
        **words,
    )
    catalogue.put_law(page)
    return page


def forget_law(name: str) -> None:
    """Take a law of your own out again; an InputError names one that is not there."""
    if not catalogue.drop_law(name):
        raise InputError(problem=f"{quoted(name)} is no law of your own", mend="check the name")
