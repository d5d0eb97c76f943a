"""Source-code FMUs: description, and a simulation with fmpy against the prediction."""

import io
import shutil
import subprocess
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf import export
from joint_runs import AXIS, JOINT, joint_runs

VALUES = {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "sigma_0": 2e3, "sigma_1": 3.0, "F_v": 2.0}
MODELS = {
    "lugre": jbf.Model(JOINT, "lugre", parameters=VALUES),
    "springs": jbf.Model(
        JOINT,
        "maxwell_slip",
        ["cogging", "inertia"],
        {"F_c": 5.0, "sigma_0": 2e3, "cogging.A": 0.5, "cogging.pitch": 0.9, "inertia.m_e": 0.2},
    ),
    "states": jbf.Model(
        JOINT,
        "seven_parameter",
        ["dwell_stiction", "warm_up"],
        {"F_c": 5.0, "F_s_inf": 3.0, "v_s": 0.1, "F_v": 2.0, "k_t": 2e3},
    ),
    "axis": jbf.Model(AXIS, "coulomb", parameters={"F_c": 5.0, "F_v": 2.0}),
}


VERSIONS = ("fmu2", "fmu3")


def fmu_of(name: str, target: str = "fmu2") -> export.Exported:
    model = MODELS[name]
    return export.to(model, target, joint_runs(model.rig, step_s=0.01))


def files_of(exported: export.Exported) -> dict[str, str]:
    content = exported.files[""]
    assert isinstance(content, bytes)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name).decode() for name in archive.namelist()}


@pytest.mark.parametrize(
    ("name", "inputs"),
    [
        ("lugre", {"velocity": "rad/s"}),
        ("springs", {"velocity": "rad/s", "acceleration": "rad/s2", "position": "rad"}),
        ("axis", {"velocity": "m/s"}),
    ],
)
@pytest.mark.parametrize("target", VERSIONS)
def test_description_lists_the_inputs_that_the_model_uses_with_units(
    name: str, inputs: dict[str, str], target: str
) -> None:
    root = ET.fromstring(files_of(fmu_of(name, target))["modelDescription.xml"])
    variables = [v for v in root.findall("ModelVariables/*") if "bristle" not in v.attrib["name"]]
    found = {v.attrib["name"]: (v if target == "fmu3" else v[0]).attrib["unit"] for v in variables}
    if target == "fmu3":
        assert found.pop("time") == "s"
    assert found.pop("force") == ("N" if name == "axis" else "N.m")
    assert found == inputs
    assert {unit.attrib["name"] for unit in root.iter("Unit")} >= set(inputs.values())


def test_same_model_gives_the_same_bytes() -> None:
    assert fmu_of("springs").files == fmu_of("springs").files


def test_archive_is_refused_as_text() -> None:
    with pytest.raises(jbf.InputError, match="archive"):
        _ = fmu_of("axis").text


def compiled(exported: export.Exported, folder: Path, headers: Path) -> Path:
    """Unpack an FMU and compile its sources for this machine."""
    compiler = shutil.which("cc") or pytest.skip("needs a C compiler")
    for name, text in files_of(exported).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    root = ET.fromstring((folder / "modelDescription.xml").read_text())
    simulation = root.find("CoSimulation")
    assert simulation is not None
    sources = [f.attrib["name"] for f in simulation.iter("File")]
    platform = "linux64"
    if not sources:
        build = ET.fromstring((folder / "sources" / "buildDescription.xml").read_text())
        sources = [f.attrib["name"] for f in build.iter("SourceFile")]
        platform = "x86_64-linux"
    binary = folder / "binaries" / platform / f"{simulation.attrib['modelIdentifier']}.so"
    binary.parent.mkdir(parents=True)
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off"]
    command = [compiler, *strict, "-shared", "-fPIC", f"-I{headers}", *sources, "-lm"]
    done = subprocess.run(
        [*command, "-o", str(binary)], cwd=folder / "sources", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return folder


def fmpy() -> Any:
    return pytest.importorskip("fmpy", reason="needs fmpy: pip install fmpy")


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("target", VERSIONS)
def test_fmu_is_valid_and_gives_the_prediction_in_fmpy(
    name: str, target: str, tmp_path: Path
) -> None:
    tool = fmpy()
    from fmpy.validation import validate_fmu

    exported = fmu_of(name, target)
    (tmp_path / "joint.fmu").write_bytes(exported.files[""])  # type: ignore[arg-type]
    assert validate_fmu(str(tmp_path / "joint.fmu")) == []
    headers = Path(tool.__file__).parent / "c-code"
    folder = compiled(exported, tmp_path / "fmu", headers)
    model = MODELS[name]
    (run, _) = joint_runs(model.rig, step_s=0.01)
    record = export.record(model, run)
    columns = {
        "velocity": record.velocity_m_s,
        "acceleration": record.acceleration_m_s2,
        "position": record.angle_rad,
    }
    inputs = {
        v.name: columns[v.name]
        for v in tool.read_model_description(str(folder)).modelVariables
        if v.causality == "input"
    }
    signals = np.zeros(len(run), [("time", float), *((name, float) for name in inputs)])
    signals["time"] = run.time_s
    for variable, values in inputs.items():
        signals[variable] = values[record.samples]
    result = tool.simulate_fmu(
        str(folder),
        start_time=0.0,
        stop_time=float(run.time_s[-1]),
        step_size=0.01,
        output_interval=0.01,
        input=signals,
        output=["force"],
    )
    force, expected = result["force"], model.predict(run)
    # The master sets the inputs at the beginning of a step: the force is one step later.
    count = min(len(force) - 1, len(expected))
    error = force[1 : count + 1] - expected[:count]
    scale = np.sqrt(np.mean(expected**2))
    assert np.sqrt(np.mean(error[2:] ** 2)) < 1e-3 * scale


def identifier_of(exported: export.Exported) -> str:
    root = ET.fromstring(files_of(exported)["modelDescription.xml"])
    attributes = root.attrib
    return attributes.get("guid") or attributes["instantiationToken"]


def test_archives_with_different_content_have_different_identifiers() -> None:
    exports = [fmu_of("axis", "fmu2"), fmu_of("axis", "fmu3"), fmu_of("lugre", "fmu2")]
    identifiers = [identifier_of(exported) for exported in exports]
    assert len(set(identifiers)) == 3
    for exported, identifier in zip(exports, identifiers, strict=True):
        sources = [text for name, text in files_of(exported).items() if name.endswith(".c")]
        assert any(identifier in text for text in sources)


@pytest.mark.parametrize("target", VERSIONS)
def test_voltage_of_a_motor_has_a_unit_of_the_si(target: str) -> None:
    rig = jbf.Rig(drive=jbf.Drive("rotary", "voltage"))
    model = jbf.Model(rig, "coulomb", parameters={"F_c": 0.5, "F_v": 0.2})
    exported = export.to(model, target, joint_runs(rig, step_s=0.02))
    root = ET.fromstring(files_of(exported)["modelDescription.xml"])
    (volt,) = (unit for unit in root.iter("Unit") if unit.attrib["name"] == "V")
    assert volt[0].attrib == {"kg": "1", "m": "2", "s": "-3", "A": "-1"}


CONTINUOUS = {
    "lugre": MODELS["lugre"],
    "dahl": jbf.Model(JOINT, "dahl", parameters={"F_c": 5.0, "F_v": 2.0, "sigma_0": 2e3}),
    "presliding": jbf.Model(
        JOINT, "stribeck", ["presliding"],
        {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "F_v": 2.0, "presliding.sigma": 2e3},
    ),
    "states": jbf.Model(
        JOINT, "lugre", ["running_in", "warm_up"],
        VALUES | {"running_in.a": 0.5, "warm_up.a": 0.5, "warm_up.tau_s": 2.0},
    ),
    "age": jbf.Model(
        JOINT, "rate_and_state", ["presliding"],
        {"F_0": 5.0, "a": 0.2, "b": 0.5, "D_c": 0.02, "presliding.sigma": 2e3},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CONTINUOUS)
@pytest.mark.parametrize("target", VERSIONS)
def test_model_exchange_gives_the_prediction_in_fmpy(
    name: str, target: str, tmp_path: Path
) -> None:
    tool = fmpy()
    from fmpy.validation import validate_fmu

    model = CONTINUOUS[name]
    (run, _) = joint_runs(model.rig, step_s=0.005)
    run = run.select(run.time_s < 4.0)
    exported = export.to(model, target, [run])
    (tmp_path / "joint.fmu").write_bytes(exported.files[""])  # type: ignore[arg-type]
    assert validate_fmu(str(tmp_path / "joint.fmu")) == []
    folder = compiled(exported, tmp_path / "fmu", Path(tool.__file__).parent / "c-code")
    signals = np.zeros(len(run), [("time", float), ("velocity", float)])
    signals["time"], signals["velocity"] = run.time_s, run.velocity
    result = tool.simulate_fmu(
        str(folder),
        fmi_type="ModelExchange",
        # FMPy holds inputs during a step, which its solver with variable steps does not tolerate.
        solver="Euler",
        step_size=0.00025,
        output_interval=0.00025,
        start_time=0.0,
        stop_time=float(run.time_s[-1]),
        input=signals,
        output=["force"],
    )
    force = np.interp(run.time_s, result["time"], result["force"])
    expected = model.predict(run)
    error = np.sqrt(np.mean((force - expected)[1:] ** 2))
    assert error < 1e-3 * np.sqrt(np.mean(expected**2))


def test_terminal_of_an_fmu_is_valid_and_has_output_and_inputs() -> None:
    tool = fmpy()
    lxml = pytest.importorskip("lxml.etree")
    text = files_of(fmu_of("springs", "fmu3"))["terminalsAndIcons/terminalsAndIcons.xml"]
    root = lxml.fromstring(text.encode())
    folder = Path(tool.__file__).parent / "schema" / "fmi3"
    lxml.XMLSchema(lxml.parse(str(folder / "fmi3TerminalsAndIcons.xsd"))).assertValid(root)
    members = [m.get("variableName") for m in root.iter("TerminalMemberVariable")]
    assert members == ["force", "velocity", "acceleration", "position"]


@pytest.mark.parametrize(
    "model",
    [
        MODELS["springs"],
        MODELS["axis"],
        MODELS["states"],
        jbf.Model(JOINT, "lugre", ["coulomb_drag"], VALUES),
        jbf.Model(JOINT, "coulomb", ["presliding", "backlash"], {"presliding.sigma": 2e3}),
    ],
)
def test_model_exchange_is_not_offered_for_a_force_that_jumps(model: jbf.Model) -> None:
    exported = export.to(model, "fmu2", joint_runs(model.rig, step_s=0.02))
    root = ET.fromstring(files_of(exported)["modelDescription.xml"])
    assert root.find("ModelExchange") is None
    assert root.find("CoSimulation") is not None
