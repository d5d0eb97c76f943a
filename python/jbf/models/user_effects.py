"""User-defined effects: forces computed from recorded columns by a Python function.

>>> import numpy as np
>>> import jbf
>>> def oil_cooler(temperature_c, k_n_k):
...     return k_n_k * (temperature_c - 40.0)
>>> jbf.register_effect(
...     oil_cooler,
...     parameters=[jbf.Parameter("k_n_k", "N/K", lower=-5.0, upper=5.0, null=0.0, starts=(0.1,))],
... ).name
'oil_cooler'
>>> jbf.forget_effect("oil_cooler")
"""

from __future__ import annotations

import runpy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError, JbfError, quoted
from jbf.models import catalogue
from jbf.models.catalogue import Effect, Parameter, Stage
from jbf.models.registration import Registration, Texts
from jbf.records.run import PathLike

MOTION_COLUMNS = {"velocity_m_s": "velocity", "acceleration_m_s2": "acceleration"}
"""Argument names that are column names of a file, each with the equivalent argument name."""
COLUMNS_OF_EVERY_RUN = ("time_s", "velocity", "acceleration", "load_n", *MOTION_COLUMNS)
"""Columns available for every run: recorded, estimated, or from the rig."""
STAGES: dict[str, Stage] = {"other": "other friction", "instrument": "instrument"}
AGREEMENT = 1e-5
"""Largest relative difference between a complex step and a difference quotient.

If the difference is larger, the complex step is not used.
"""


@dataclass(frozen=True, repr=False)
class UserEffect(Effect):
    """User-defined effect: its catalogue entry and its function.

    Attributes
    ----------
    function
        Function of columns and parameters that returns the force, N.
    analytic
        Whether complex-step derivatives are accurate, by parameter name.
    called
        Word for the function in messages: `effect` or `law`.
    """

    function: Callable[..., Any] = field(default=lambda: 0.0, compare=False)
    analytic: dict[str, bool] = field(default_factory=dict, compare=False)
    called: str = "effect"

    @classmethod
    def registered(cls, given: Registration, stage: Stage, texts: Texts) -> UserEffect:
        """Create the entry of a function whose name and parameters have been checked.

        Raises
        ------
        InputError
            A parameter is not an argument of the function, or an argument has no name.
        """
        return cls(
            name=given.name,
            stage=stage,
            needs=(),
            refused={},
            moves_jumps=False,
            spreads_jumps=False,
            peaks=None,
            longest_step_s=np.inf,
            parameters=given.parameters,
            columns=given.columns(),
            function=given.function,
            called=given.kind,
            **texts,
        )

    def force(self, columns: Mapping[str, Array], values: Sequence[float]) -> Array:
        """Force of the effect at every sample, N, shape (n,).

        Raises
        ------
        InputError
            The function fails, or does not return n finite numbers.
        """
        return self._checked(self._call(columns, values), len(columns["time_s"]), values)

    def slope(self, columns: Mapping[str, Array], values: Sequence[float], which: int) -> Array:
        """Derivative of the force with respect to parameter number `which`, shape (n,).

        The derivative is computed with a complex step if the function accepts complex numbers,
        otherwise with fourth-order finite differences within the bounds.
        """
        page = self.parameters[which]
        if self.analytic.get(page.name) is None:
            quotient = self._difference(columns, values, which)
            step = self._complex_step(columns, values, which)
            top = float(np.max(np.abs(quotient), initial=0.0))
            agrees = step is not None and float(np.max(np.abs(step - quotient))) <= AGREEMENT * top
            if top > 0.0:  # a zero derivative gives no information
                self.analytic[page.name] = agrees
            return quotient if step is None or not agrees else step
        if self.analytic[page.name]:
            step = self._complex_step(columns, values, which)
            if step is not None:
                return step
        return self._difference(columns, values, which)

    def _complex_step(
        self, columns: Mapping[str, Array], values: Sequence[float], which: int
    ) -> Array | None:
        """Derivative by a complex step; None if the function does not accept complex numbers."""
        moved: list[complex] = [complex(v) for v in values]
        size = 1e-30 * max(abs(values[which]), 1.0)
        moved[which] += 1j * size
        try:
            with np.errstate(all="ignore"):
                force = np.asarray(self.function(**self._arguments(columns, moved)))
        except Exception:  # a function of real numbers may raise any error for complex ones
            return None
        if force.dtype.kind != "c":
            return None
        derivative: Array = np.broadcast_to(force.imag / size, np.shape(columns["time_s"])).copy()
        return derivative if np.all(np.isfinite(derivative)) else None

    def _difference(
        self, columns: Mapping[str, Array], values: Sequence[float], which: int
    ) -> Array:
        """Derivative by fourth-order finite differences within the bounds."""
        page, x = self.parameters[which], values[which]
        h = 1e-3 * max(abs(x), 1e-3 * (page.upper - page.lower))
        h = min(h, 0.1 * (page.upper - page.lower))

        def at(k: int) -> Array:
            moved = list(values)
            moved[which] = x + k * h
            return self.force(columns, moved)

        if page.lower <= x - 2 * h and x + 2 * h <= page.upper:
            return (at(-2) - 8.0 * at(-1) + 8.0 * at(1) - at(2)) / (12.0 * h)
        h = h if x + 4 * h <= page.upper else -h
        ends = -25.0 * at(0) + 48.0 * at(1) - 36.0 * at(2) + 16.0 * at(3) - 3.0 * at(4)
        return ends / (12.0 * h)

    def _arguments(self, columns: Mapping[str, Array], values: Sequence[Any]) -> dict[str, Any]:
        named = dict(zip([p.name for p in self.parameters], values, strict=True))
        return {name: columns[name] for name in self.columns} | named

    def _call(self, columns: Mapping[str, Array], values: Sequence[float]) -> Any:
        for name in self.columns:
            if name not in columns:
                raise InputError(
                    column=name,
                    problem=f"is missing, and the {self.called} {self.name} requires it",
                    remedy="add the column",
                )
        try:
            return self.function(**self._arguments(columns, values))
        except JbfError:
            raise
        except (Exception, SystemExit) as error:
            raise InputError(
                problem=f"the {self.called} {self.name} fails: {type(error).__name__}: {error}",
                remedy="correct its function",
            ) from error

    def _checked(self, returned: Any, n: int, values: Sequence[float]) -> Array:
        def wrong(problem: str) -> InputError:
            return InputError(
                problem=f"the {self.called} {self.name} {problem}",
                remedy="its function must return one finite force (N) per sample",
            )

        array = np.asarray(returned)
        if array.dtype.kind not in "fiub":
            raise wrong(f"gives {array.dtype}")
        if array.shape not in ((), (n,)):
            raise wrong(f"returns shape {array.shape} for {n} samples")
        force: Array = np.ascontiguousarray(np.broadcast_to(array.astype(float), (n,)))
        bad = np.flatnonzero(~np.isfinite(force))
        if bad.size:
            named = zip(self.parameters, values, strict=True)
            where = ", ".join(f"{p.name} = {v:g}" for p, v in named)
            raise wrong(f"returns {force[bad[0]]} at sample {bad[0]} with {where}")
        return force


def register_effect(
    function: Callable[..., Any],
    *,
    parameters: Sequence[Parameter],
    name: str | None = None,
    stage: str = "other",
    summary: str = "",
    equation: str = "",
    source: str = "",
    limits: str = "",
) -> Effect:
    """Register a user-defined effect.

    The effect is available under its name in fits, comparisons, predictions, diagnoses and
    `jbf.effects()` until the process ends. A second effect of the same name replaces the first one.

    Parameters
    ----------
    function
        Returns the force of one bearing, N, at every sample: shape (n,), or a number. Its arguments
        are identified by name. Columns are arrays of shape (n,): `time_s` (s), `velocity`
        (signed), `acceleration`, `angle_rad`, `load_n`, `position_m`, `temperature_c`, or any
        other column of the records. Parameters are numbers. Speed, acceleration and angle are the
        smooth estimates that drive the models. The function is called for each run separately.
    parameters
        Named, bounded parameters with starting values; at least one of them with a finite null at
        which the force vanishes.
    name
        Name of the effect; by default that of the function.
    stage
        `other`: friction in addition to that of the bearing, to which the lag and delay of the
        instrument apply. `instrument`: added to the record directly.
    summary, equation, source, limits
        Texts for `jbf effects NAME`.

    Returns
    -------
    Effect
        The catalogue entry.

    Raises
    ------
    InputError
        A name is in use or not an identifier, the stage is unknown, or a parameter lacks bounds,
        start or null. Also if an argument of the function is neither a parameter nor a column name.

    Examples
    --------
    >>> import numpy as np
    >>> def drag(velocity_m_s, c_n):
    ...     return c_n * np.tanh(velocity_m_s / 0.01)
    >>> c = jbf.Parameter("c_n", "N", "level", lower=-10.0, upper=10.0, null=0.0, starts=(1.0,))
    >>> jbf.register_effect(drag, parameters=[c], summary="drag").name
    'drag'
    >>> "drag" in jbf.effects()
    True
    >>> jbf.forget_effect("drag")
    """
    given = Registration.of("effect", function, name, parameters)
    given.check_name(catalogue.built_in())
    if stage not in STAGES:
        known = " or ".join(STAGES)
        raise given.refused(f"cannot be at the stage {quoted(stage)}", f"choose {known}")
    if not given.parameters:
        raise given.refused("has no parameters", "give at least one jbf.Parameter with a null")
    given.check_parameters()
    if all(p.null is None for p in given.parameters):
        raise given.refused(
            "never vanishes", "give one parameter null=VALUE, at which the force is zero"
        )
    page = UserEffect.registered(
        given, STAGES[stage], given.texts(summary, equation, source, limits)
    )
    catalogue.put(page)
    return page


def forget_effect(name: str) -> None:
    """Unregister a user-defined effect.

    Parameters
    ----------
    name : str
        Name of the effect.

    Raises
    ------
    InputError
        No effect of this name is registered.

    Examples
    --------
    >>> c = jbf.Parameter("c_n", "N", "level", lower=-9.0, upper=9.0, null=0.0, starts=(1.0,))
    >>> _ = jbf.register_effect(lambda c_n: c_n, parameters=[c], name="level")
    >>> jbf.forget_effect("level")
    >>> "level" in jbf.effects()
    False
    """
    if not catalogue.drop(name):
        raise InputError(
            problem=f"{quoted(name)} is not a user-defined effect", remedy="check the name"
        )


def load_effects(path: PathLike) -> None:
    """Run a Python file that registers effects or laws, with all permissions of the user.

    Parameters
    ----------
    path : path
        The Python file.

    Raises
    ------
    InputError
        The file cannot be read, fails, or registers nothing.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("own.py").write_text('''import jbf
    ... def level(velocity_m_s, c_n):
    ...     return c_n + 0.0 * velocity_m_s
    ... c = jbf.Parameter("c_n", "N", "level", lower=-9.0, upper=9.0, null=0.0, starts=(1.0,))
    ... jbf.register_effect(level, parameters=[c])
    ... ''')
    >>> jbf.load_effects("own.py")
    >>> jbf.forget_effect("level")
    """
    before = dict(catalogue.user_effects()) | dict(catalogue.user_laws())
    file = Path(path)
    if not file.is_file():
        raise InputError(file=file, problem="is not a file", remedy="name a Python file")
    try:
        runpy.run_path(str(file))
    except InputError as error:
        raise error.within(file=file) from None
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        raise InputError(
            file=file,
            row=_line_in(error, file),
            problem=f"fails: {type(error).__name__}: {error}",
            remedy="correct the file",
        ) from None
    after = {**catalogue.user_effects(), **catalogue.user_laws()}
    if all(before.get(name) is page for name, page in after.items()):
        raise InputError(
            file=file,
            problem="registers no effect and no law",
            remedy="call jbf.register_effect or jbf.register_law in it",
        )


def _line_in(error: BaseException, file: Path) -> int | None:
    if isinstance(error, SyntaxError):
        return error.lineno
    row, trace = None, error.__traceback__
    while trace is not None:
        if Path(trace.tb_frame.f_code.co_filename) == file:
            row = trace.tb_lineno
        trace = trace.tb_next
    return row
