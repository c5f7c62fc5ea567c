"""Perturbations by name: what their text means, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

from hazard_ms.spec.perturbation import KINDS, MOST_LEVEL, Perturbation, amount, canonical
from hazard_ms.spec.severity import SEVERITIES


def test_a_text_names_the_level_of_each_kind() -> None:
    made = Perturbation.read(" camera:1 , lighting:3,hazard:2,words:0")
    assert made == Perturbation(lighting=3, camera=1, hazard=2)
    assert Perturbation.read(str(made)) == made


def test_all_texts_of_one_perturbation_become_the_same() -> None:
    assert canonical("camera:1,lighting:2") == canonical("lighting:2, camera:1,noise:0") == "lighting:2,camera:1"
    assert canonical("") == canonical("lighting:0") == str(Perturbation()) == ""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("light:1", "a kind in perturb must be one of lighting, camera, objects, .*, got 'light' .*'lighting'"),
        ("lighting:4", "the level of lighting in perturb must be one of 0, 1, 2, 3, got '4'"),
        ("lighting:-1", "the level of lighting in perturb must be one of 0, 1, 2, 3, got '-1'"),
        ("lighting", "the level of lighting in perturb must be one of 0, 1, 2, 3, got ''"),
        ("lighting:1,camera:2,lighting:1", "perturb must name each kind once, got 'lighting' twice"),
        ("lighting:1,", "a kind in perturb must be one of .*, got ''"),
        ("noise:1" * 1000, "perturb must be text such as"),
        (None, "perturb must be text such as 'lighting:2,camera:1', got None"),
        (3, "perturb must be text such as 'lighting:2,camera:1', got 3"),
    ],
)
def test_other_texts_are_refused_and_told_what_is_allowed(text: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Perturbation.read(text)


def test_levels_of_hazard_are_the_severities_from_the_mildest() -> None:
    named = [Perturbation(hazard=level).severity("severe", "realistic") for level in range(MOST_LEVEL + 1)]
    assert named == ["severe", "moderate", "severe", "extreme"]
    winds = [SEVERITIES[name].wind for name in named[1:]]
    assert winds == sorted(winds)
    assert Perturbation().severity("extreme", "realistic") == "extreme"


def test_a_hazard_needs_a_preset_with_severities_and_no_other_severity() -> None:
    with pytest.raises(ValueError, match="hazard in perturb must be 0 for all physics but 'realistic', got 1"):
        Perturbation(hazard=1).severity("severe", "paper")
    with pytest.raises(ValueError, match="severity must be 'severe' beside hazard in perturb"):
        Perturbation(hazard=1).severity("extreme", "realistic")


def test_amounts_of_a_level_are_more_than_those_of_the_one_below_where_most_doubles() -> None:
    assert amount(2.0, 1.0) == 2.0
    assert amount(2.0, 0.0) > amount(1.0, 1.0)
    assert len(KINDS) == len(set(KINDS)) == 8
