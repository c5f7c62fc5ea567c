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

# Of mitigations (hazard_ms.spec.registry.mitigations)
TOO_HEAVY = "too_heavy"  # more than the arm can carry
NO_LEAF = "no_leaf"  # a doorway, or a window or an outer door that robots cannot move
BROKEN = "broken"  # the leaf or the pane is gone
HELD_SHUT = "held_shut"  # water or air presses the leaf shut harder than the arm pulls
HELD_OPEN = "held_open"  # the same the other way
IN_THE_SWING = "in_the_swing"  # something stands where the leaf would turn
NO_EXTINGUISHER = "no_extinguisher"  # none is in the hand
EMPTY = "empty"  # the extinguisher ran out
NO_LINE_OF_SIGHT = "no_line_of_sight"  # a wall is between the nozzle and the flames wherever the robot gets
TOO_HOT = "too_hot"  # it cannot come near enough without being destroyed
NO_TOP = "no_top"  # nothing can be put there within the arm's reach
NO_ROOM = "no_room"  # its top is full, or too small
FELL_OFF = "fell_off"  # let go, but it did not stay there
NO_BOARD = "no_board"  # none is in the hand, or it is narrower than the opening
NO_RAILS = "no_rails"  # a board cannot stand there
TOO_DEEP = "too_deep"  # water presses on the board harder than the arm does
NOT_MOVABLE = "not_movable"  # no cart that could roll here
NOT_BURNING = "not_burning"  # no flame is on the thing or around it
STILL_BURNING = "still_burning"  # the jet reached the flames, but does not put them out

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
REFUSED = (NOT_A_TARGET, ALREADY_RESCUED, UNREACHABLE)
