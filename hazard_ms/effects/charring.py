"""Charring: one scalar of a thing's materials says how black and how hot it looks; see shaders/common.py."""

from __future__ import annotations

import numpy as np

from hazard_ms.hazards.fire.fire import BURNING, BURNT, FireState

CHAR_UPDATES = 45.0  # heat updates of burning after which 63 % of a thing are black [ours]
TOAST = 0.15  # char of a thing about to ignite [ours]


def char_codes(fire: FireState, times: np.ndarray) -> np.ndarray:
    """The char code of each thing, [E, B], as shaders/common.py describes it, at `times` [s], [E]."""
    status, updates = fire.status.cpu().numpy(), fire.burn_updates.cpu().numpy()
    warmth = ((fire.temperature - 20.0) / (fire.threshold - 20.0).clamp(min=1.0)).clamp(0.0, 1.0).cpu().numpy()
    charred = np.where(status == BURNING, 1.0 - np.exp(-updates / CHAR_UPDATES), TOAST * warmth**2)
    charred = np.where(status == BURNT, 1.0, np.maximum(charred, TOAST * warmth**2))
    pulse = 0.72 + 0.2 * np.sin(5.0 * times[:, None] + 2.4 * np.arange(status.shape[1]))
    code = 1.0 + np.floor(255.0 * charred) + np.where(status == BURNING, pulse, 0.0)
    return np.where(charred > 1.0 / 255.0, code, 0.0)
