"""Episodes are the same with other instructions of the processor, also with those of before AVX2."""

from __future__ import annotations

import json

import pytest

from tests.env.episode_hashes import PRESETS, RECORD, TASKS, machine, recorded
from tests.env.forced_instructions import FORCED, forced

alike = pytest.mark.skipif(
    json.loads(RECORD.read_text())["machine"] != machine(), reason="recorded with other packages"
)


@alike
def test_numpy_and_libraries_of_algebra_may_take_any_instructions() -> None:
    together = {name: value for variables in list(FORCED.values())[:3] for name, value in variables.items()}
    assert forced(together, TASKS[2], "realistic", (0,)) == {"0": recorded(TASKS[2], "realistic")["0"]}


@alike
@pytest.mark.long
@pytest.mark.parametrize("physics", PRESETS)
@pytest.mark.parametrize("env_id", TASKS)
@pytest.mark.parametrize("name", FORCED)
def test_episodes_do_not_depend_on_instructions(name: str, env_id: str, physics: str) -> None:
    assert forced(FORCED[name], env_id, physics, (0,)) == recorded(env_id, physics, (0,))
