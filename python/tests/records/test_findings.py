"""Findings of complete runs: clean records, simulated recordings, and where they are reported."""

import json
import re
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from conftest import LAW, make_runs
from jbf import Model, Rig, Run
from jbf.cli import main
from jbf.estimation.bootstrap import simulated_recording
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.prepared import Prepared
from jbf.records.findings.examine import Examined, examine, examine_readings
from jbf.records.findings.finding import Finding
from jbf.records.rig import Bearing, Load, Lubricant
from known_motions import Array, places, white
from recorded.judge import found
from rigruns import runs_of
from rigsim.recording import OFF_GRID, recorded
from scipy.signal import lfilter
from shared import shared

TIME_S: Any = 0.02 * np.arange(3000)
SEED = 1003
"""Seed of a campaign of three short runs: starts and stops, a sweep, slow and fast motion."""
FOUND_WITHOUT_A_MODEL = (
    "backward_velocity", "coarse_velocity", "dropout", "filtered_velocity", "gaps", "jitter",
    "noisy_load", "position_glitch", "quantised", "saturation", "slow_force", "spikes",
)  # fmt: skip
FOUND_WITH_A_MODEL = ("retared", "runs_differ", "drifting_clock", "gain_by_run", "long_memory")


def sine(omega: float = 0.3) -> Any:
    return 0.1 * np.sin(omega * TIME_S + 0.4)


def stribeck(speed: Array) -> Any:
    """Friction that rises fast at a reversal and falls with the speed, N."""
    size = 15.0 + 10.0 * np.exp(-np.abs(speed) / 0.02) + 40.0 * np.abs(speed)
    return np.tanh(speed / 0.002) * size


def examined(force: Array, speed: Array | None = None) -> Examined:
    return examine(Run.from_arrays(TIME_S, sine() if speed is None else speed, force))


def kinds(result: Examined) -> list[str]:
    return sorted(finding.kind for finding in result.findings)


@pytest.mark.parametrize("omega", [0.02, 3.0])
@pytest.mark.parametrize("noise_rms", [0.0, 1e-3, 0.3])
def test_stribeck_friction_with_white_noise_has_no_findings(omega: float, noise_rms: float) -> None:
    result = examined(stribeck(sine(omega)) + white(3000, 1, noise_rms), sine(omega))
    assert kinds(result) == []
    assert result.usable.all()
    assert result.native is None


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.extended) for seed in range(1, 5))]
)
def test_stribeck_friction_with_coloured_noise_has_no_findings(seed: int) -> None:
    # First-order autoregressive noise with a memory of twenty samples.
    coloured = 0.3 * np.sqrt(1.0 - 0.95**2) * lfilter([1.0], [1.0, -0.95], white(3000, seed))
    assert kinds(examined(stribeck(sine()) + coloured)) == []
    assert kinds(examined(stribeck(sine()) + coloured + white(3000, seed, 0.05))) == []


@pytest.mark.parametrize(
    "shape",
    [
        "stick and slip",
        *(pytest.param(shape, marks=pytest.mark.extended) for shape in ("triangle", "ramp")),
    ],
)
def test_corners_and_plateaus_of_a_noise_free_force_are_not_reported_as_faults(shape: str) -> None:
    phase = np.mod(TIME_S, 5.0) / 5.0
    speed = {
        "triangle": 0.1 * (2.0 * np.abs(2.0 * phase - 1.0) - 1.0),
        "stick and slip": np.where(phase < 0.15, np.sin(np.pi * phase / 0.15) ** 2, 0.0),
        "ramp": 0.1 * TIME_S / TIME_S[-1],
    }[shape]
    top = np.max(speed)
    result = examined(10.0 * np.tanh(speed / (0.01 * top)) + 2.0 * speed / top, speed)
    assert {"glitches", "saturation", "interpolated", "steps"}.isdisjoint(kinds(result))


def test_run_without_a_force_has_no_findings_and_only_usable_samples() -> None:
    result = examine(Run.from_arrays(TIME_S, sine()))
    assert (result.findings, result.usable.all()) == ((), True)


def test_force_samples_of_glitches_and_held_readings_are_not_usable() -> None:
    force = stribeck(sine()) + white(3000, 2, 0.3)
    force[300] += 20.0
    of_readings = examine_readings(Run.from_arrays(TIME_S, sine(), force), sine())
    assert [f.kind for f in of_readings.findings] == ["glitches"]
    assert places(~of_readings.usable) == [300]
    force[1001:1010] = force[1000]
    result = examined(force)
    assert kinds(result) == ["glitches", "held_samples"]
    assert places(~result.usable) == [300, *range(1001, 1010)]


def test_repeated_readings_of_a_slow_force_channel_are_reported_with_its_rate() -> None:
    last = np.floor(0.4 + np.arange(3000) / 2.7).astype(int)
    result = examined(20.0 * white(1200, 1)[last])
    (finding,) = result.findings
    assert (finding.kind, finding.unit) == ("held_samples", "Hz")
    assert finding.size == pytest.approx(1.0 / (2.7 * 0.02), rel=1e-3)
    assert result.native is not None
    assert result.usable.all()


def simulated(artefact: str, strength: str = "usual") -> Campaign:
    records, truth = recorded(SEED, (), (artefact,), strength)
    sizes = dict(truth["base"]["bearing"])
    lubricant = Lubricant(sizes.pop("viscosity_pa_s"))
    rig = Rig(Bearing(**sizes), lubricant, Load(truth["base"]["load_n"]))
    return Campaign.prepare(rig, runs_of(records))


@shared
def findings_of(artefact: str) -> tuple[Finding, ...]:
    return simulated(artefact).findings


@pytest.mark.parametrize("artefact", FOUND_WITHOUT_A_MODEL)
def test_findings_of_a_simulated_recording_are_those_of_its_artefact_only(artefact: str) -> None:
    assert found((artefact,), {f.kind for f in findings_of(artefact)}) == ([artefact], [], [])


@pytest.mark.parametrize(
    "artefact",
    [
        OFF_GRID,
        "skew",
        *(pytest.param(name, marks=pytest.mark.extended) for name in FOUND_WITH_A_MODEL),
    ],
)
def test_artefact_that_only_a_model_reveals_is_not_reported_without_a_fit(artefact: str) -> None:
    assert findings_of(artefact) == ()


@pytest.mark.parametrize(
    ("artefact", "kind", "size"),
    [
        ("quantised", "steps", "step_n"),
        ("saturation", "saturation", "limit_n"),
        ("jitter", "jitter", "rms_s"),
    ],
)
def test_size_of_a_finding_is_within_25_percent_of_the_simulated_size(
    artefact: str, kind: str, size: str
) -> None:
    _, truth = recorded(SEED, (), (artefact,), "usual")
    true = {done["run"]: done["size"][size] for done in truth["recording"]}
    sizes = {f.run: f.size for f in findings_of(artefact) if f.kind == kind}
    assert sizes
    assert sizes == pytest.approx({run: true[run] for run in sizes}, rel=0.25)


def test_delay_of_a_speed_filter_is_recovered_within_30_percent_in_each_run() -> None:
    """A second-order filter of 5 Hz delays by sqrt(2) / (2 pi 5 Hz) = 45 ms."""
    delays_s = [f.size for f in findings_of("filtered_velocity") if f.kind == "filtered_speed"]
    assert delays_s == [pytest.approx(0.045, rel=0.3)] * 3


def test_noisy_constant_load_is_not_counted_as_several_loads() -> None:
    assert simulated("noisy_load", "severe").has_loads == simulated(OFF_GRID).has_loads


@pytest.fixture(scope="module")
def corrupt_runs() -> list[Run]:
    """A run with two position outliers, and a clean run."""
    clean, other = make_runs(kinds=("sine_w0.5", "sine_w2.0"))
    columns: Any = {name: values.copy() for name, values in clean.columns().items()}
    columns["angle_rad"][[300, 700]] += 0.2
    return [Run.from_arrays(**columns, name=clean.name), other]


def is_reported(finding: Finding, text: str) -> bool:
    """Return whether a text, wrapped or with HTML tags, contains the sentence of a finding."""
    return finding.words in " ".join(re.sub(r"<[^>]*>", " ", text).split())


def test_comparison_finding_appears_in_text_page_json_and_command_output(
    corrupt_runs: list[Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = Model(Rig.thesis(), parameters=LAW)
    comparison = jbf.compare(model, corrupt_runs)
    (finding,) = comparison.findings
    assert (finding.kind, finding.channel, finding.run) == ("glitches", "angle_rad", "sine_w0.5")
    assert comparison.to_dict()["findings"] == [finding.to_dict()]
    assert is_reported(finding, comparison.summary())
    comparison.save_html(tmp_path / "c.html")
    assert is_reported(finding, (tmp_path / "c.html").read_text())
    model.save(tmp_path / "model.toml")
    for run in corrupt_runs:
        run.write_csv(tmp_path / f"{run.name}.csv")
    command = ["compare", str(tmp_path / "model.toml"), str(tmp_path / "*.csv")]
    assert main(command) == 0
    assert is_reported(finding, capsys.readouterr().out)
    assert main([*command, "--json", "-"]) == 0
    assert len(json.loads(capsys.readouterr().out)["findings"]) == 1
    assert jbf.compare(model, corrupt_runs[1:]).findings == ()


def test_fit_reports_position_glitches_and_hardly_changes_with_them(corrupt_runs: Any) -> None:
    clean = jbf.fit(Rig.thesis(), make_runs(kinds=("sine_w0.5", "sine_w2.0")))
    corrupt = jbf.fit(Rig.thesis(), corrupt_runs)
    (finding,) = corrupt.findings
    assert is_reported(finding, corrupt.summary())
    for name, parameter in clean.parameters.items():
        assert parameter.stderr is not None
        assert corrupt[name].value == pytest.approx(parameter.value, abs=0.2 * parameter.stderr)


@pytest.mark.parametrize("fault", ["late speed", "degrees", "mm/s", "wrong sign"])
def test_resampled_record_has_the_same_motion_fault_as_the_original(fault: str) -> None:
    """A bootstrap must not use a column that the fit excluded."""
    run: Any = make_runs(kinds=("sine_w0.5",))[0]
    speed, angle = run.velocity, run.angle_rad
    speed, angle = {
        "late speed": (np.interp(run.time_s - 0.05, run.time_s, speed), angle),
        "mm/s": (1e3 * speed, angle),
        "degrees": (speed / 10.0, np.degrees(angle / 10.0)),
        "wrong sign": (speed, -angle),
    }[fault]
    wrong = Run.from_arrays(run.time_s, speed, run.friction, angle_rad=angle, name="a")
    prepared = Prepared.of(Rig.thesis(), wrong)
    (finding,) = prepared.examined.findings
    assert finding.channel in prepared.motion.aside
    again = simulated_recording(prepared, run.friction, WHITE, 0.3, np.random.default_rng(1))
    (same,) = Prepared.of(Rig.thesis(), again).examined.findings
    assert (same.kind, same.channel) == (finding.kind, finding.channel)
    assert same.size == pytest.approx(finding.size, rel=0.1)
