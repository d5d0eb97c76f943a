"""A small campaign of a linear slide on disk."""

from pathlib import Path

import pytest
from by_hand import coulomb, four_runs

MASS_KG = 0.05
"""Moving mass that Coulomb's law lacks; its force is half of the noise."""
NOISE_N = 0.1


@pytest.fixture(scope="session")
def slide(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with rig.toml and four runs with Coulomb and viscous friction and a small mass."""
    folder = tmp_path_factory.mktemp("campaign") / "slide"
    folder.mkdir()
    for run in four_runs(lambda t, v, a: coulomb(t, v, a) + MASS_KG * a, noise_rms=NOISE_N):
        run.write_csv(folder / f"{run.name}.csv")
    (folder / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    return folder
