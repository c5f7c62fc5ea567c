"""Observation modes: their names, those that need a renderer, and the removal of numbers that are not finite."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from hazard_ms.sensing.senses.senses import DEGRADED, SENSES, THERMAL
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.undocumented import parse_obs_mode_to_struct

# names of modes, of which the first three need no renderer, and of textures, which can be joined by "+"
PLAIN_MODES = ("state", "state_dict", "none", "sensor_data", "pointcloud")
TEXTURES = ("rgb", "depth", "segmentation", "position", "normal", "albedo", "rgbd", "state")

UNCHANGED = {"sensor_data", "pointcloud", "position", "normal", "albedo"}  # what `degraded` would leave as it truly is


def check_obs_mode(mode: str) -> None:
    """Check that ManiSkill knows `mode`: a plain mode, or textures joined by "+". Raises ValueError otherwise."""
    if not isinstance(mode, str):
        raise ValueError(f"obs_mode must be one of {', '.join(PLAIN_MODES)}, or textures joined by '+', got {mode!r}")
    if mode in PLAIN_MODES:
        return
    for part in mode.split("+"):
        one_of(part, (*PLAIN_MODES, *TEXTURES), "obs_mode")
    parse_obs_mode_to_struct(mode)


def needs_pictures(mode: str | None) -> bool:
    """Whether observations of `mode` need a renderer."""
    return mode is not None and mode not in PLAIN_MODES[:3]


def check_renderer(mode: str | None, chosen: str | None) -> None:
    """Check that the renderer `chosen` can serve `mode`. Raises ValueError if `mode` needs one and there is none."""
    if chosen in ("none", None) and needs_pictures(mode):
        raise ValueError(f"obs_mode must be one of {', '.join(PLAIN_MODES[:3])} without a renderer, got {mode!r}")


def check_senses(senses: Sequence[str], mode: str | None) -> tuple[str, ...]:
    """`senses`, if observations of `mode` can have them. Raises ValueError for others."""
    if isinstance(senses, str) or not isinstance(senses, Sequence):
        raise ValueError(f"senses must be a list of some of {', '.join(SENSES)}, got {senses!r}")
    for name in senses:
        one_of(name, SENSES, "senses")
    shown = mode or PLAIN_MODES[0]
    if THERMAL in senses and not needs_pictures(mode):
        raise ValueError(f"obs_mode must be one with pictures for the sense {THERMAL}, got {shown!r}")
    if DEGRADED in senses and (wrong := UNCHANGED.intersection(shown.split("+"))):
        raise ValueError(f"obs_mode must have only colour and depth for the sense {DEGRADED}, got {min(wrong)!r}")
    return tuple(dict.fromkeys(senses))


def finite(obs: Any) -> Any:
    """`obs` with 0 in place of numbers that are not finite: a broken simulation must not reach a learner."""
    if isinstance(obs, dict):
        return {k: finite(v) for k, v in obs.items()}
    return torch.nan_to_num(obs, 0.0, 0.0, 0.0) if obs.is_floating_point() else obs
