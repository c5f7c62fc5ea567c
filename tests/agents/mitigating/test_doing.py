"""Doors to which no way leads are not chosen, and those to which none was found are left alone for a while."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.agents.mitigating.doing import PUT_OFF, Mitigator
from hazard_ms.agents.mitigating.prospects import Prospect
from hazard_ms.simulation.world import World
from hazard_ms.sketch.futures.interventions import SHUT
from hazard_ms.skills.decision import Action, Result
from hazard_ms.skills.failures import NO_PATH, UNREACHABLE
from tests.sketch.test_clutter import CRATE, HERE, seen, world

DOORS = [Prospect(SHUT, (n,), np.zeros(2), np.zeros(2), 0.0, 200.0) for n in range(2)]
KEY = (SHUT, (0,))


def mitigator(of: World) -> Mitigator:
    base = SimpleNamespace(world=of)
    env = SimpleNamespace(base=base, seen=seen(), stage=SimpleNamespace(doors=SimpleNamespace(names=["door_0"])))
    truth: Any = SimpleNamespace(env=env, forget=lambda: None, reveal=lambda: None, also=set(), changes=0)
    brief: Any = SimpleNamespace(radius=0.29)
    return Mitigator(truth, brief)


def left_out(made: Mitigator, frame: int, monkeypatch: pytest.MonkeyPatch) -> Collection[object]:
    """What it does not consider when it chooses at a frame."""
    told: list[Collection[object]] = []

    def course(*given: Any) -> tuple[None, list[Prospect]]:
        told.append(given[-1])
        return None, []

    monkeypatch.setattr(made._chooser, "course", course)
    decision: Any = SimpleNamespace(frame=frame, held=None, agent_position=HERE)
    none: Any = None
    made._choose(decision, none, [], none)
    return told[0]


def failed(made: Mitigator, reason: str) -> None:
    made._queue, made._last = list(DOORS), Action("shut", "door_0")
    decision: Any = SimpleNamespace(last_result=Result(False, reason, 50), frame=100)
    assert made.took(decision)


def test_a_door_without_a_way_is_left_alone_for_a_while_and_so_is_what_waits_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = mitigator(world())
    failed(made, NO_PATH)
    assert not made._queue
    assert KEY in left_out(made, 100 + PUT_OFF - 1, monkeypatch)
    assert KEY not in left_out(made, 100 + PUT_OFF, monkeypatch)


def test_what_failed_otherwise_is_tried_again_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made = mitigator(world())
    failed(made, UNREACHABLE)
    assert made._queue == DOORS
    assert KEY not in left_out(made, 100, monkeypatch)


def test_a_door_behind_what_drifted_into_the_hall_is_not_considered(monkeypatch: pytest.MonkeyPatch) -> None:
    assert KEY not in left_out(mitigator(world()), 0, monkeypatch)
    near = dataclasses.replace(CRATE, position=(2.3, 2.9, 0.0))
    assert KEY in left_out(mitigator(world(near)), 0, monkeypatch)


def test_after_a_door_it_chooses_anew() -> None:
    """The second door of a course is not shut without a look at what the first has changed."""
    made = mitigator(world())
    made._queue = list(DOORS)
    made._base.world.openings.set_open(torch.arange(1), 0, 0.0)
    decision: Any = SimpleNamespace(held=None)
    scene: Any = None
    assert made.go_on(decision, scene) is None and not made._queue
