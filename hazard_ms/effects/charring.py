"""How black and how hot a thing looks, as one scalar of its materials; see glsl.py."""

from __future__ import annotations

import numpy as np

from hazard_ms.hazards.fire import BURNING, BURNT, FireState

CHAR_UPDATES = 45.0  # heat updates of burning after which 63 % of a thing are black [ours]
TOAST = 0.15  # char of a thing about to ignite [ours]


def char_codes(fire: FireState, times: np.ndarray) -> np.ndarray:
    """How black and how glowing each thing is, [E, B], as glsl.py packs it. `times` [s], [E]."""
    status, updates = fire.status.cpu().numpy(), fire.burn_updates.cpu().numpy()
    warmth = ((fire.temperature - 20.0) / (fire.threshold - 20.0).clamp(min=1.0)).clamp(0.0, 1.0).cpu().numpy()
    charred = np.where(status == BURNING, 1.0 - np.exp(-updates / CHAR_UPDATES), TOAST * warmth**2)
    charred = np.where(status == BURNT, 1.0, np.maximum(charred, TOAST * warmth**2))
    pulse = 0.72 + 0.2 * np.sin(5.0 * times[:, None] + 2.4 * np.arange(status.shape[1]))
    code = 1.0 + np.floor(255.0 * charred) + np.where(status == BURNING, pulse, 0.0)
    return np.where(charred > 1.0 / 255.0, code, 0.0)
