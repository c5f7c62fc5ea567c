"""Observations, actions, rewards and info of an environment of skills, number by number, for learners."""

from __future__ import annotations

from dataclasses import replace

from hazard_ms.sensing.observation_table import INF, Row
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.fires import FIRE_SLOTS
from hazard_ms.skills.options.options import CART_SLOTS, COUNT, LANDMARK_SLOTS, TARGET_SLOTS, option_count

INFO = (
    Row("value", (), "float", "", "", 0.0, 1.0, "value rescued so far, as a share of all"),
    Row("frame", (), "int", "frame", "", 0.0, INF, "frames since the start of the episode"),
    Row("option", (), "str", "", "", -INF, INF, 'the option that was played, "target mug_1"; empty after a reset'),
    Row("ok", (), "bool", "", "", 0.0, 1.0, "whether it worked"),
    Row("reason", (), "str", "", "", -INF, INF, "why not: a code of hazard_ms.skills.failures, or not_available"),
    Row("frames", (), "int", "frame", "", 0.0, INF, "frames that it took"),
    Row("rescued", (), "int", "", "", 0.0, TARGET_SLOTS, "targets that are safe"),
    Row("targets", (), "int", "", "", 0.0, TARGET_SLOTS, "things to rescue"),
    Row("sim_error", (), "bool", "", "", 0.0, 1.0, "the simulation broke; truncates the episode"),
    Row("action_mask", (COUNT,), "bool", "", "", 0.0, 1.0, "which options can be chosen next"),
)
OPTIONS = (
    ("target", TARGET_SLOTS, "fetch target i: walk to it, pick it up, and put it into the bag if there is one"),
    ("cart", CART_SLOTS, "carry what the hand holds to cart j and drop it there"),
    ("landmark", LANDMARK_SLOTS, "walk to landmark l, the most promising first, and look around"),
    ("look", 1, "look around on the spot"),
    ("stop", 1, "end the episode"),
)
MEASURES = (
    ("fire", FIRE_SLOTS, "put out fire k, with an extinguisher that is fetched first unless one is in the hand"),
    ("tool", 1, "fetch the nearest extinguisher, to look for fires with it in hand"),
)


def describe(encoder: Encoder) -> dict[str, list[Row]]:
    """Rows of observation, action, reward and info of an environment of skills, by section."""
    actions, start = [], 0
    for name, count, text in (*OPTIONS, *(MEASURES if encoder.measures else ())):
        actions.append(Row(f"[{start}:{start + count}] {name}", (), "int64", "", "", start, start + count - 1, text))
        start += count
    mask = replace(INFO[-1], shape=(option_count(encoder.measures),))
    rewards = [
        Row("value (default)", (), "float", "", "", 0.0, 1.0, "value that this step rescued, as a share of all"),
        Row("paper", (), "float", "", "", -INF, INF, "reward='paper': what the original's learner gets"),
    ]
    return {"observation": list(observation(encoder)), "action": actions, "reward": rewards, "info": [*INFO[:-1], mask]}


def observation(encoder: Encoder) -> list[Row]:
    """One row for each column of each table; the numbers of its further slots follow in steps of the table's width."""
    made, start = [], 0
    for table, (slots, columns) in encoder.tables.items():
        for k, column in enumerate(columns):
            unit = f"{column.scale:g} {column.unit}".strip() if column.scale != 1.0 else column.unit
            every = f" +{len(columns)} i" if slots > 1 else ""
            key = f"[{start + k}{every}] {table}/{column.name}"
            frame = "agent" if column.name in ("ahead", "left") else ""
            made.append(Row(key, (slots,), "float32", unit, frame, column.low, column.high, column.meaning))
        start += slots * len(columns)
    return made
