"""User-defined laws: friction computed from recorded columns by a Python function.

>>> import numpy as np
>>> import jbf
>>> def tanh_law(velocity, F_c, v_0, F_v):
...     return F_c * np.tanh(velocity / v_0) + F_v * velocity
>>> jbf.register_law(
...     tanh_law,
...     parameters=[
...         jbf.Parameter("F_c", "N", lower=0.0, upper=1e3, starts=(5.0,)),
...         jbf.Parameter("v_0", "m/s", lower=1e-5, upper=1.0, starts=(1e-3,), log=True),
...         jbf.Parameter("F_v", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
...     ],
... ).name
'tanh_law'
>>> jbf.forget_law("tanh_law")
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError, quoted
from jbf.models import catalogue
from jbf.models.catalogue import Law, Parameter
from jbf.models.registration import Registration
from jbf.models.user_effects import MOTION_COLUMNS, UserEffect
from jbf.models.vocabulary import AUTO


@dataclass(frozen=True, repr=False)
class UserLaw(Law):
    """User-defined law: its catalogue entry and its function."""

    force: UserEffect | None = None

    def steady_n(self, velocity: Array, values: Sequence[float], load_n: float | None) -> Array:
        """Force of the law at steady speeds, N, for a function of speed, load and time only."""
        assert self.force is not None
        zero = np.zeros_like(velocity)
        columns = {"time_s": zero, "velocity": velocity, "acceleration": zero}
        columns |= {column: columns[name] for column, name in MOTION_COLUMNS.items()}
        if load_n is not None:
            columns["load_n"] = np.full_like(velocity, load_n)
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
    """Register a user-defined law, for machines without a journal bearing.

    The law is available under its name (`law=`, `--law`, `--law auto`, model files) until the
    process ends. A second law of the same name replaces the first one. The law can be combined with
    effects that add to the force of a law or act on the sum (the stages `other friction` and
    `instrument`).

    Parameters
    ----------
    function
        Returns the friction force, N, at every sample, shape (n,), with the sign of the motion. Its
        arguments are identified by name, as those of `register_effect`: columns, arrays of shape
        (n,), and the parameters, numbers. It is called for each run separately; a law with a state
        can be computed from the complete arrays.
    parameters
        Named, bounded parameters with starting values; a null is not required.
    name
        Name of the law; by default that of the function.
    summary, equation, source, limits
        Texts for `jbf effects` and reports.

    Returns
    -------
    Law
        The catalogue entry.

    Raises
    ------
    InputError
        A name is in use or not an identifier, a parameter lacks bounds or start, or an argument of
        the function is neither a parameter nor a column name.

    Examples
    --------
    >>> import numpy as np
    >>> def dry(velocity_m_s, c_n):
    ...     return c_n * np.sign(velocity_m_s)
    >>> c = jbf.Parameter("c_n", "N", "level", lower=0.0, upper=10.0, starts=(1.0,))
    >>> jbf.register_law(dry, parameters=[c], summary="dry friction").name
    'dry'
    >>> jbf.forget_law("dry")
    """
    given = Registration.of("law", function, name, parameters)
    given.check_name(catalogue.built_in_laws(), reserved=AUTO)
    given.check_parameters()
    texts = given.texts(summary, equation, source, limits)
    page = UserLaw(
        name=given.name,
        needs_bearing=False,
        has_film=False,
        has_bristle=False,
        has_memory=False,
        rust_type="",
        parameters=given.parameters,
        force=UserEffect.registered(given, "other friction", texts),
        **texts,
    )
    catalogue.put_law(page)
    return page


def forget_law(name: str) -> None:
    """Unregister a user-defined law.

    Parameters
    ----------
    name : str
        Name of the law.

    Raises
    ------
    InputError
        No law of this name is registered.

    Examples
    --------
    >>> c = jbf.Parameter("c_n", "N", "level", lower=0.0, upper=9.0, starts=(1.0,))
    >>> _ = jbf.register_law(lambda velocity_m_s, c_n: c_n, parameters=[c], name="line")
    >>> jbf.forget_law("line")
    >>> "line" in jbf.laws()
    False
    """
    if not catalogue.drop_law(name):
        raise InputError(
            problem=f"{quoted(name)} is not a user-defined law", remedy="check the name"
        )
