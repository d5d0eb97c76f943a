"""Fitted parameters, found by name: what every fit shares."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from jbf.errors import InputError
from jbf.models.catalogue import find_parameter
from jbf.models.parameter_value import ParameterValue
from jbf.results import Result


class Estimates(Result):
    """A result that holds parameters with errors.

    ``fit["presliding.sigma"]`` finds one by its full or its short name, and names the nearest
    where there is none.
    """

    parameters: dict[str, ParameterValue]

    @property
    def values(self) -> dict[str, float]:
        """Name to value."""
        return {name: p.value for name, p in self.parameters.items()}

    @property
    def stderr(self) -> dict[str, float | None]:
        """Name to standard error, None where there is none."""
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
        """What `to_dict` says beside the parameters."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        named = {name: p.to_dict() for name, p in self.parameters.items()}
        return {**self.facts(), "parameters": named}
