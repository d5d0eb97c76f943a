"""A held parameter in files, JSON, words, pictures and firmware: never a value, always with why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from by_hand import fit_by_hand
from jbf import InputError, Model, ParameterValue, Rig, export
from jbf.models.model_file import read_model_file
from jbf.reporting.json import json_text
from jbf.reporting.tables import parameter_rows

BOUND = "at its lower bound 0: the runs ask for less"
HELD = ParameterValue(0.0, None, BOUND, held=True)
MODEL = Model(Rig(), "coulomb", ["sensor_offset"], {"F_c": ParameterValue(5.0, 0.1), "F_v": HELD})


def test_what_is_held_has_no_error() -> None:
    with pytest.raises(InputError, match="key stderr: stands beside held = true"):
        ParameterValue(1.0, 0.1, held=True)
    with pytest.raises(InputError, match="key held: is not true or false"):
        ParameterValue(1.0, held="yes")  # type: ignore[arg-type]


def test_json_has_no_error_to_ask_for() -> None:
    assert HELD.to_dict() == {"value": 0.0, "held": True, "note": BOUND}
    assert ParameterValue(5.0, 0.1).to_dict() == {"value": 5.0, "stderr": 0.1, "note": None}
    gone = ParameterValue(float("inf"), None, "at its null: no effect", held=True)
    assert '"value": "inf"' in json_text(gone.to_dict())


def test_the_file_says_so_and_reads_back(tmp_path: Path) -> None:
    MODEL.save(tmp_path / "m.toml")
    text = (tmp_path / "m.toml").read_text()
    assert f'\nF_v_n_s_m = {{value = 0.0, note = "{BOUND}", held = true}}\n' in text
    assert "\nF_c_n = {value = 5.0, stderr = 0.1}\n" in text
    assert Model.load(tmp_path / "m.toml").parameters == MODEL.parameters


def test_a_file_from_before_reads_as_it_did(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text('format = 1\nlaw = "coulomb"\nparameters.F_s_n = {value = 6.0, note = "old"}\n')
    assert read_model_file(path).parameters["F_s_n"] == ParameterValue(6.0, None, "old")
    for said, words in (
        ('held = "yes"', "key parameters.F_s_n.held: is not true or false"),
        ("held = true, stderr = 1.0", "key parameters.F_s_n.stderr: stands beside held = true"),
    ):
        path.write_text(f'format = 1\nlaw = "c"\nparameters.F_s_n = {{value = 6.0, {said}}}\n')
        with pytest.raises(InputError, match=words):
            read_model_file(path)


def test_words_never_show_it_as_a_value() -> None:
    rows = {row[0]: row[1:] for row in parameter_rows("coulomb", (), MODEL.parameters)}
    assert rows["F_v_n_s_m"] == ("held at 0", "", "", "N s/m", BOUND)
    assert rows["F_c_n"] == ("5.00", "0.10", "2.0 %", "N", "")
    assert "F_v_n_s_m held at 0;" not in repr(MODEL)
    assert "F_c_n = 5, F_s_n = 12, F_v_n_s_m held at 0" in repr(MODEL)


def test_the_picture_names_it_and_draws_no_interval() -> None:
    left = fit_by_hand().plot()[0]
    labels = [tick.get_text() for tick in left.get_yticklabels()]
    assert labels[1] == "F_s_n\nheld at 6.0000"
    assert labels[0] == "F_c_n\n4.988 ± 0.012"
    intervals = [c for c in left.containers if c.get_label() is not None]
    assert len(intervals) == 2


def test_firmware_is_told_in_both_languages() -> None:
    rust, c = export.rust(MODEL), export.c(MODEL)
    assert f"    0.0, // F_v_n_s_m: held, {BOUND}\n" in rust
    assert f"    0.0, /* F_v_n_s_m: held, {BOUND} */\n" in c
    assert "    5.0, // F_c_n\n" in rust
    assert "    5.0, /* F_c_n */\n" in c
    assert rust.count("held") == c.count("held") == 1


def test_a_note_of_ones_own_stays_within_its_comment() -> None:
    wild = ParameterValue(1.0, None, "a\nb */ evil(); /* c", held=True)
    model = Model(MODEL.rig, "coulomb", (), {"F_c": wild, "F_s": replace(wild, note=None)})
    rust, c = export.rust(model), export.c(model)
    assert "    1.0, /* F_c_n: held, a b  evil();  c */\n    1.0, /* F_s_n: held */\n" in c
    assert "    1.0, // F_c_n: held, a b  evil();  c\n    1.0, // F_s_n: held\n" in rust
