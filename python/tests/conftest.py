"""Fixtures: a short campaign simulated with a jbf model, a known effect and seeded noise."""

import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import Fit, Model, Rig, Run, fit
from jbf.models.catalogue import built_in
from shared import DIRECTORY

SHARED = pytest.StashKey[str]()


def pytest_configure(config: pytest.Config) -> None:
    """Create the directory of shared results; workers inherit the environment variable."""
    if DIRECTORY not in os.environ:
        config.stash[SHARED] = os.environ[DIRECTORY] = tempfile.mkdtemp(prefix="jbf-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the directory if this process created it."""
    created = config.stash.get(SHARED, None)
    if created is not None:
        shutil.rmtree(created, ignore_errors=True)
        del os.environ[DIRECTORY]


MAX_ID = 48


def pytest_make_parametrize_id(val: object) -> str | None:
    """Return an id that shows the value of a parameter, where pytest would number it."""
    text = described(val)
    if text is None:
        return None
    return text if len(text) <= MAX_ID else text[: MAX_ID - 3] + "..."


def described(value: object) -> str | None:
    """Describe containers, arrays, slices and named objects; None for what pytest describes."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key}={described(item) or item}" for key, item in value.items()) or "{}"
    if isinstance(value, list | tuple | set | frozenset):
        if hasattr(value, "_fields"):
            return repr(value)
        items = sorted(map(str, value)) if isinstance(value, set | frozenset) else value
        return ", ".join(described(item) or str(item) for item in items) or "empty"
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}" if value.size > 6 else described(value.tolist())
    if isinstance(value, slice | range):
        return repr(value)
    if isinstance(value, np.integer):
        return str(value)
    if isinstance(getattr(value, "name", None), str):
        return str(value.name)  # type: ignore[attr-defined]
    if is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: getattr(value, f.name) for f in fields(value)}
        return f"{type(value).__name__}({described({k: v for k, v in parts.items() if v})})"
    return None


LAW = {"f_m": 0.26, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
DRAG_N = 2.0
NOISE_N = 0.3
RATE_HZ = 50.0
ENCODER_RAD = 1.0 / 2387.3


def _motion(kind: str, duration_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Time (s) and shaft speed (rad/s): a reversing sine, or starts, stops and reversals."""
    time_s = np.arange(0.0, duration_s, 1.0 / RATE_HZ)
    if kind == "stopgo":
        levels = np.array([0.0, 1.5, 0.0, -3.0, 0.0, 6.0, -1.5])
        corners = np.arange(len(levels)) * duration_s / len(levels)
        held = levels[np.searchsorted(corners, time_s, side="right") - 1]
        ramp = np.ones(15) / 15
        return time_s, np.round(np.convolve(np.pad(held, 7, "edge"), ramp, "valid"), 9)
    return time_s, 8.0 * np.sin(float(kind.removeprefix("sine_w")) * time_s + 0.3)


def make_run(model: Model, kind: str, *, seed: int, duration_s: float = 24.0) -> Run:
    """Simulate one run of the model under a motion, with the noise of an instrument."""
    bearing = model.rig.bearing
    assert bearing is not None
    random = np.random.default_rng(seed)
    time_s, rate = _motion(kind, duration_s)
    speed = rate * bearing.radius_m
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) / RATE_HZ)))
    clean = Run.from_arrays(time_s, speed, angle_rad=angle, name=kind)
    return Run.from_arrays(
        time_s,
        np.where(speed == 0.0, 0.0, speed + random.normal(0.0, 1e-4, len(speed))),
        model.predict(clean) + random.normal(0.0, NOISE_N, len(speed)),
        angle_rad=np.round(angle / ENCODER_RAD) * ENCODER_RAD,
        load_n=np.full(len(speed), 104.0),
        name=kind,
    )


def make_runs(
    effects: dict[str, dict[str, float]] | None = None,
    kinds: Sequence[str] = ("sine_w0.5", "sine_w2.0", "stopgo"),
) -> list[Run]:
    """Runs of the base law with the given effects and parameters, one for each kind of motion."""
    effects = effects or {}
    values_of_effects = {f"{e}.{p}": v for e, values in effects.items() for p, v in values.items()}
    model = Model(Rig.thesis(), effects=list(effects), parameters=LAW | values_of_effects)
    return [make_run(model, kind, seed=i) for i, kind in enumerate(kinds)]


@pytest.fixture(scope="session")
def rig() -> Rig:
    """The rig of the thesis."""
    return Rig.thesis()


@pytest.fixture(scope="session")
def runs() -> list[Run]:
    """Three short runs with a load-independent drag that the base law lacks."""
    return make_runs({"coulomb_drag": {"F_d": DRAG_N}})


@pytest.fixture(scope="session")
def full_fit(rig: Rig, runs: list[Run]) -> Fit:
    """Fit of the base law with the simulated effect."""
    return fit(rig, runs, effects=["coulomb_drag"])


@pytest.fixture
def forget_user_effects() -> Iterator[None]:
    """Remove the effects that a test registers in this process."""
    yield
    for name in jbf.effects().keys() - built_in().keys():
        jbf.forget_effect(name)


@pytest.fixture
def working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in which the test runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def campaign(tmp_path: Path, rig: Rig, runs: list[Run]) -> Path:
    """A folder with rig.toml and runs/*.csv."""
    rig.write(tmp_path / "rig.toml")
    (tmp_path / "runs").mkdir()
    for run in runs:
        run.write_csv(tmp_path / "runs" / f"{run.name}.csv")
    return tmp_path
