"""Reasons for which a skill did not do all that was asked: the stable codes that a Result carries."""

from __future__ import annotations

UNKNOWN = "target_unknown"  # neither in view nor in memory
NO_PATH = "no_path"  # no passable path leads near it
MAX_FRAMES = "max_frames"  # the budget of frames is spent
BLOCKED = "blocked"  # something stands in the way that the map does not show
NOT_A_TARGET = "not_a_target"
ALREADY_RESCUED = "already_rescued"
TOO_FAR = "too_far"  # beyond the distance at which a pick-up may begin
ALREADY_HOLDING = "already_holding"
UNREACHABLE = "unreachable"  # the hand cannot get to it from anywhere near
NOT_HOLDING = "not_holding"
CART_UNREACHABLE = "cart_unreachable"  # the cart is not within reach
NOT_RESCUED = "not_rescued"  # let go, but it did not end in the bag or the cart
EPISODE_OVER = "episode_over"  # the time limit came first

FAILURES = (
    UNKNOWN,
    NO_PATH,
    MAX_FRAMES,
    BLOCKED,
    NOT_A_TARGET,
    ALREADY_RESCUED,
    TOO_FAR,
    ALREADY_HOLDING,
    UNREACHABLE,
    NOT_HOLDING,
    CART_UNREACHABLE,
    NOT_RESCUED,
    EPISODE_OVER,
)

# Of an action that was still under way, and did not fail: whoever asks for it again goes on with it
UNFINISHED = (MAX_FRAMES, EPISODE_OVER)

# Of a pick-up that may have found no target where one was believed to be
REFUSED = (NOT_A_TARGET, UNREACHABLE)
