"""Types that all packages use: arrays of numbers and of truth values, and names."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Array of numbers of any shape; the docstring of each function states shape and unit."""
Mask = npt.NDArray[np.bool_]
"""Array of truth values, for example whether a sample counts."""
Names = tuple[str, ...]
"""Names of effects, laws, runs or parameters."""
