"""Access to the `InputError` of a call, for tests of the place that it names."""

from collections.abc import Callable
from typing import Any

import pytest
from jbf import InputError


def input_error(call: Callable[..., Any], *arguments: Any, **named: Any) -> InputError:
    """Return the `InputError` that the call raises; its message must be one line with a remedy."""
    with pytest.raises(InputError) as caught:
        call(*arguments, **named)
    assert "\n" not in str(caught.value)
    assert caught.value.remedy
    return caught.value
