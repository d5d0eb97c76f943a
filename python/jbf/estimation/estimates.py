"""Base class of results with fitted parameters, which are accessible by name."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from statistics import NormalDist
from typing import Any

from jbf.errors import InputError
from jbf.models.catalogue import find_parameter
from jbf.models.parameter_value import ParameterValue
from jbf.records.toml_file import number
from jbf.results import Result


class Estimates(Result):
    """A result that holds parameters with standard errors.

    ``fit["presliding.sigma"]`` returns a parameter by its full or its short name. The error for an
    unknown name lists the most similar names.
    """

    parameters: dict[str, ParameterValue]
    nobs: int

    @property
    def params(self) -> dict[str, float]:
        """Parameter values by name, including parameters held fixed."""
        return {name: p.value for name, p in self.parameters.items()}

    @property
    def stderr(self) -> dict[str, float]:
        """Standard errors by parameter name; nan for a parameter held fixed."""
        errors = {name: p.stderr for name, p in self.parameters.items()}
        return {name: math.nan if error is None else error for name, error in errors.items()}

    @property
    def var_names(self) -> tuple[str, ...]:
        """Names of the estimated parameters, without parameters held fixed."""
        return tuple(name for name, p in self.parameters.items() if not p.held)

    def conf_int(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Return the confidence interval of each parameter.

        Parameters
        ----------
        level
            Confidence level, between 0 and 1.

        Returns
        -------
        dict of str to (float, float)
            Lower and upper limit by parameter name; nan where the parameter is held.

        Raises
        ------
        InputError
            The level is not between 0 and 1.

        Notes
        -----
        The interval is ``value -/+ z stderr`` with the quantile z of the standard normal
        distribution (Wald interval). The interval is not valid for parameters whose log likelihood
        is not quadratic up to one standard error (`Fit.doubtful`); use a bootstrap for them.
        """
        if not 0.0 < number(level, "level") < 1.0:
            raise InputError(
                key="level", problem=f"{level:g} is not a probability", remedy="try 0.95"
            )
        z = NormalDist().inv_cdf(0.5 + 0.5 * level)
        errors = self.stderr
        return {
            name: (value - z * errors[name], value + z * errors[name])
            for name, value in self.params.items()
        }

    def __getitem__(self, name: str) -> ParameterValue:
        return self.parameters[find_parameter(name, self.parameters)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and find_parameter(name, self.parameters) != ""
        except InputError:
            return False

    def _facts(self) -> Mapping[str, Any]:
        """Entries that a result adds to `to_dict`, in addition to its parameters."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """Return the result as a dictionary for JSON."""
        named = {name: p.to_dict() for name, p in self.parameters.items()}
        return {**self._facts(), "parameters": named}
