"""Access to fitted parameters by name, common to all results of a fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from jbf.errors import InputError
from jbf.models.catalogue import find_parameter
from jbf.models.parameter_value import ParameterValue
from jbf.results import Result


class Estimates(Result):
    """A result that holds parameters with standard errors.

    ``fit["presliding.sigma"]`` returns a parameter by its full or its short name. The error for an
    unknown name lists the nearest names.
    """

    parameters: dict[str, ParameterValue]

    @property
    def values(self) -> dict[str, float]:
        """Values by parameter name."""
        return {name: p.value for name, p in self.parameters.items()}

    @property
    def stderr(self) -> dict[str, float | None]:
        """Standard errors by parameter name; None where no error is known."""
        return {name: p.stderr for name, p in self.parameters.items()}

    def __getitem__(self, name: str) -> ParameterValue:
        return self.parameters[find_parameter(name, self.parameters)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and find_parameter(name, self.parameters) != ""
        except InputError:
            return False

    def facts(self) -> Mapping[str, Any]:
        """Entries of `to_dict` in addition to the parameters."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """Return the result as a dictionary for JSON."""
        named = {name: p.to_dict() for name, p in self.parameters.items()}
        return {**self.facts(), "parameters": named}
