"""What a run of the loop is given, and what is made of what it gives back."""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from jbf import InputError, Model, Rig, Run
from jbf.control import TASKS, THESIS_BENCH, Coulomb, NoCompensation, Task, thesis_model
from jbf.control.motion import follow
from jbf.control.run import Result
from jbf.control.settings import Settings
from jbf.control.task import RECORDED

RUN: Any = importlib.import_module("jbf.control.run")
SINE = Task("velocity", "sine", -1.0, 1.0, 0.25, 1.0)
NEVER = 2**62
ARRAYS = ("angle_rad", "velocity_rad_s", "friction_v", "measured_angle_rad",
          "estimated_velocity_rad_s", "error", "base_v", "compensation_v", "estimated_friction_v",
          "correction_v", "forward_v", "output_v", "learned_0", "learned_1")  # fmt: skip


def result_of(task: Task, **given: Any) -> Result:
    """Five steps of a loop, each array another."""
    arrays = {name: np.arange(5.0) + 10.0 * i for i, name in enumerate(ARRAYS)}
    arrays |= {"time_s": 0.1 * np.arange(5.0), "reference": np.ones(5)}
    flags = {"status": np.array([0, 1, 2, 0, 16], dtype=np.uint8)}
    return Result(task, "none", **cast(Any, {**arrays, **flags, **given}))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[tuple[Any, ...], dict[str, Any]]]:
    """What the core is asked for, in the place of an answer that costs time."""
    calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = []

    class Core:
        @staticmethod
        def control_run(*given: Any, **named: Any) -> dict[str, Any]:
            calls.append((given, named))
            found = {name: np.zeros(len(given[3])) for name in ARRAYS}
            return {**found, "status": np.zeros(len(given[3]), dtype=np.uint8)}

        @staticmethod
        def control_reference(*given: Any) -> tuple[np.ndarray, np.ndarray]:
            return np.full(given[5], given[1]), np.full(given[5], given[2])

    monkeypatch.setattr(RUN, "_core", Core)
    return calls


def test_errors_count_from_where_the_task_says() -> None:
    """Root mean square and largest of the loop's error, and of the shaft's."""
    error = np.array([9.0, -9.0, 3.0, -5.0, 1.0])
    task = replace(SINE, skip_s=0.2)
    found = result_of(task, error=error, velocity_rad_s=np.array([7.0, 7.0, 4.0, 1.0, 0.0]))
    assert found.rms == pytest.approx(math.sqrt(35.0 / 3.0))
    assert found.peak == 5.0
    assert found.true_error.tolist() == [6.0, 6.0, 3.0, 0.0, -1.0]
    assert found.true_rms == pytest.approx(math.sqrt(10.0 / 3.0))
    whole = replace(found, task=SINE)
    assert whole.peak == 9.0
    assert whole.rms == pytest.approx(math.sqrt(197.0 / 5.0))
    # A time that is a rounding error short of it counts.
    short = replace(found, time_s=found.time_s - 1e-12)
    assert short.rms == found.rms


def test_what_is_controlled_is_the_response() -> None:
    """The shaft's angle in position control, else its speed."""
    found = result_of(SINE)
    assert found.response is found.velocity_rad_s
    turned = replace(found, task=replace(SINE, control="position"))
    assert turned.response is turned.angle_rad


def test_a_result_in_a_line_as_data_and_as_a_file() -> None:
    """Scheme, task and error; columns in their order, every digit of each number."""
    found = result_of(SINE, error=np.array([0.5, -0.5, 0.5, 0.5, 0.5]))
    assert repr(found) == "Result(none on velocity sine: RMS error 0.5 rad/s)"
    told = found.to_dict()
    assert (told["scheme"], told["rms"], told["peak"]) == ("none", 0.5, 0.5)
    assert told["true_rms"] == found.true_rms
    assert told["task"] == {"control": "velocity", "wave": "sine", "low": -1.0, "high": 1.0,
                            "frequency_rad_s": 0.25, "seconds": 1.0, "skip_s": 0.0}  # fmt: skip
    lines = found.to_csv().splitlines()
    assert lines[0] == ",".join(found.columns())
    assert lines[0].startswith("time_s,reference,angle_rad,velocity_rad_s,friction_v,measured")
    assert lines[1].startswith("0.0,1.0,0.0,10.0,20.0,30.0,")
    assert lines[4].startswith("0.30000000000000004,1.0,3.0,13.0,")
    assert lines[5].endswith(",16")
    assert len(lines) == 6
    assert found.to_csv().endswith("16\n")


Asked = list[tuple[tuple[Any, ...], dict[str, Any]]]


def test_a_run_is_as_long_as_its_task(asked: Asked) -> None:
    """In steps of the bench, at least one; the load is the rig's; nothing fails by itself."""
    found = RUN.run(None, "none", SINE)
    ((_, loop, scheme, value, rate, load, faults), named) = asked[-1]
    assert (len(value), len(rate), len(load)) == (500, 500, 500)
    assert (set(value), set(rate), set(load)) == ({-1.0}, {1.0}, {104.0})
    assert faults == {"frozen": (NEVER, NEVER), "jump_at": NEVER, "jump_counts": 0}
    assert named == {"precision": "f64"}
    assert (scheme, loop["moving_v"]) == ({"kind": "none"}, None)
    assert found.time_s[:3].tolist() == [0.0, 0.002, 0.004]
    assert (found.scheme, found.task) == ("none", SINE)
    assert len(RUN.run(None, "none", replace(SINE, seconds=1e-4)).time_s) == 1
    assert len(RUN.run(None, "none", replace(SINE, seconds=0.0031)).time_s) == 2


def test_faults_begin_and_end_with_their_steps(asked: Asked) -> None:
    """Seconds become steps, none below zero."""
    RUN.run(None, "none", SINE, frozen_s=(0.1, 0.2), jump=(0.3, 90), precision="f32")
    (given, named) = asked[-1]
    assert given[6] == {"frozen": (50, 100), "jump_at": 150, "jump_counts": 90}
    assert named == {"precision": "f32"}
    RUN.run(None, "none", SINE, frozen_s=(-1.0, -0.5))
    assert asked[-1][0][6]["frozen"] == (0, 0)


def test_who_carries_which_model_and_is_told_of_which_drive(asked: Asked) -> None:
    """The bench has the truth; loop and scheme what they believe; a guard its limits."""
    truth, other = thesis_model(), thesis_model(K0=1e6)
    weak = replace(THESIS_BENCH, input_rad_s2_v=380.0)
    guard = Settings(60.0, 2.0, 0.7, 1.7, 0.1, 30.0, 1.0, 1.9, 0.1)
    RUN.run(truth, "observed", SINE, bench=weak, told=THESIS_BENCH, carried=other, guard=guard)
    (bench, loop, scheme, *_), _ = asked[-1]
    assert bench["model"]["parameters"][2] == truth.parameters["K0"].value
    assert scheme["model"]["parameters"][2] == 1e6
    assert (bench["drive"]["input_rad_s2_v"], loop["drive"]["input_rad_s2_v"]) == (380.0, 457.0)
    assert (loop["moving_v"], loop["patience_s"]) == (1.9, 0.1)
    RUN.run(truth, "observed", SINE, settings=guard)
    (bench, loop, scheme, *_), _ = asked[-1]
    assert scheme["model"]["parameters"][2] == truth.parameters["K0"].value
    assert scheme["settings"]["bandwidth_rad_s"] == 60.0
    assert loop["moving_v"] == 1.9
    RUN.run(truth, Coulomb(gain=0.5), SINE)
    assert asked[-1][0][2]["gain"] == 0.5


def test_a_reference_and_a_load_may_be_given(asked: Asked) -> None:
    """The run is as long as they are; one load holds all the time."""
    value, rate = np.arange(7.0), -np.arange(7.0)
    RUN.run(None, "none", replace(SINE, wave=RECORDED), reference=(value, rate), load_n=5)
    given = asked[-1][0]
    assert given[3].tolist() == value.tolist()
    assert given[4].tolist() == rate.tolist()
    assert given[5].tolist() == [5.0] * 7
    RUN.run(None, "none", SINE, reference=(value, rate), load_n=value)
    assert asked[-1][0][5].tolist() == value.tolist()
    newtons = Model(Rig(), "coulomb", parameters={"F_c_n": 5.0, "F_v_n_s_m": 20.0})
    RUN.run(newtons, "none", SINE, reference=(value, rate))
    assert asked[-1][0][5].tolist() == [1.0] * 7


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"told": replace(THESIS_BENCH, dt_s=0.001)}, "the two benches have different steps"),
        ({"reference": ([], [])}, "the reference has shapes (0,) and (0,)"),
        ({"reference": ([1.0], [1.0, 2.0])}, "the reference has shapes (1,) and (2,)"),
        ({"reference": ([[1.0]], [[1.0]])}, "the reference has shapes (1, 1) and (1, 1)"),
        ({"load_n": math.inf}, "a load is not finite; give newtons"),
        ({"task": replace(SINE, wave=RECORDED)}, "a recorded task has no wave; give its reference"),
        ({"task": "sine"}, 'the task is "sine"; name one of control.TASKS'),
        ({"scheme": 3}, "the scheme is an int; name one of none, learning, coulomb, table"),
    ],
)
def test_what_no_loop_can_run(given: dict[str, Any], said: str, asked: Asked) -> None:
    """Refused before the core is asked."""
    with pytest.raises(InputError) as refused:
        RUN.run(**{"scheme": NoCompensation(), "task": SINE, **given})
    assert said in str(refused.value)
    assert asked == []


TIME = np.arange(0.0, 10.0, 0.1)


def recorded(**columns: Any) -> Run:
    return Run.from_arrays(TIME, **{"velocity_m_s": 0.0127 * TIME, **columns})


def test_a_recorded_speed_is_followed_in_radians_of_its_journal() -> None:
    """From its own beginning, on straight lines; of a rig without a bearing metres are radians."""
    task, reference, load = follow(recorded(load_n=100.0 + TIME), Rig.thesis())
    assert reference is not None
    steps = np.arange(0.0, 9.9, 0.002)
    assert np.allclose(reference[0], steps)
    assert np.allclose(reference[1], 1.0)
    assert load is not None
    assert np.allclose(load, 100.0 + steps)
    assert (task.control, task.wave) == ("velocity", RECORDED)
    assert task.low == 0.0
    assert task.high == pytest.approx(9.898)
    assert task.seconds == pytest.approx(9.9)
    assert task.frequency_rad_s * task.seconds == pytest.approx(2.0 * math.pi)
    later = Run.from_arrays(TIME + 50.0, 0.0127 * TIME)
    task, reference, load = follow(later, Rig.thesis(), bench=replace(THESIS_BENCH, dt_s=0.01))
    assert load is None
    assert reference is not None
    assert len(reference[0]) == 990
    assert task.high == pytest.approx(9.89)
    slide = follow(recorded(), Rig()).reference
    assert slide is not None
    assert np.allclose(slide[0], 0.0127 * steps)


def test_a_speed_that_was_not_recorded_is_that_of_the_angle() -> None:
    """Across the angle's jumps, too; one that was recorded is taken as it is."""
    wavy = Run.from_arrays(TIME, angle_rad=np.mod(TIME**2, 2.0 * np.pi))
    found = follow(wavy, Rig.thesis()).reference
    assert found is not None
    steps = np.arange(0.0, 9.9, 0.002)
    inside = (steps > 0.1) & (steps < 9.8)
    assert np.allclose(found[0][inside], 2.0 * steps[inside])
    both = follow(recorded(angle_rad=5.0 * TIME), Rig.thesis()).reference
    assert both is not None
    assert np.allclose(both[0], steps)


def test_a_position_is_followed_from_where_it_begins() -> None:
    """The journal's angle, or the slider's place; a run without it is refused."""
    run = recorded(angle_rad=3.0 + TIME, position_m=7.0 + 2.0 * TIME)
    steps = np.arange(0.0, 9.9, 0.002)
    for rig, rate in ((Rig.thesis(), 1.0), (Rig(), 2.0)):
        task, reference, _ = follow(run, rig, "position")
        assert reference is not None
        assert np.allclose(reference[0], rate * steps)
        assert np.allclose(reference[1], rate)
        assert task.is_position
    for rig, there in ((Rig.thesis(), {"position_m": TIME}), (Rig(), {"angle_rad": TIME})):
        with pytest.raises(InputError, match="has no angle to follow"):
            follow(recorded(**there), rig, "position")
    with pytest.raises(InputError, match="does not move; name a run that does"):
        follow(recorded(velocity_m_s=np.full(len(TIME), 0.1)), Rig())


def test_every_task_is_run_by_its_control_law(asked: Asked) -> None:
    """Position or velocity, as its name says."""
    for name, task in TASKS.items():
        RUN.run(None, "none", replace(task, seconds=3.0))
        assert asked[-1][0][1]["position"] == name.startswith("position")
