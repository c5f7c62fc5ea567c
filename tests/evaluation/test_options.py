"""Options of episodes: their settings, and the command that plays the same episode again."""

from __future__ import annotations

import shlex
from typing import Any

import pytest
import tyro
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.evaluation.choices import EFFECTS, LIGHTINGS, PRESETS
from hazard_ms.evaluation.options import EpisodeOptions, PlayOptions

OPTIONS = st.builds(
    EpisodeOptions,
    env_id=st.sampled_from(["HazardFire-v1", "HazardCompound-v1"]),
    split=st.sampled_from(["train", "test"]),
    physics=st.sampled_from(PRESETS),
    hazards=st.sampled_from([(), ("fire",), ("flood", "fire")]),
    robot_uids=st.sampled_from(["fetch", "g1", ("fetch", "g1"), ("fetch", "fetch", "fetch")]),
    affects_agent=st.booleans(),
    lighting=st.sampled_from(LIGHTINGS),
    effects=st.sampled_from(EFFECTS),
    load=st.sampled_from([(), ("own.py", "my module.py")]),
    agent=st.sampled_from(["greedy", "random", "own.py:Mine:depth=3"]),
    seed=st.integers(0, 10**6),
    scene=st.sampled_from([None, "kitchen_a/03"]),
    perception=st.sampled_from(["truth", "noisy:miss=0.2,erode=1", "mask_rcnn:my folder/net.pth"]),
)


@given(OPTIONS)
@settings(max_examples=60, deadline=None)
def test_the_command_plays_the_same_episode_again(options: EpisodeOptions) -> None:
    """What tyro reads from the words of the command are the options that gave them."""
    program, command, *words = shlex.split(options.command)
    assert (program, command) == ("hazard-ms", "play")
    assert tyro.cli(tyro.conf.OmitArgPrefixes[PlayOptions], args=words).episode == options


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, {}),
        ({"lighting": "night"}, {"lighting": "night"}),
        ({"effects": "off", "hazards": ("fire", "wind")}, {"effects": "off", "hazards": ["fire", "wind"]}),
    ],
)
def test_settings_hold_what_is_not_usual(changes: dict[str, Any], told: dict[str, Any]) -> None:
    usual = {"split": "train", "physics": "paper", "robot_uids": "fetch", "affects_agent": False}
    assert EpisodeOptions(**changes).settings == {**usual, **told}
