"""Episodes are the same with other instructions of the processor, also with those of before AVX2."""

from __future__ import annotations

import json

import pytest

from tests.env.episode_hashes import PRESETS, RECORD, TASKS, machine, recorded
from tests.env.forced_instructions import FORCED, NATIVE, NOT_PROMISED, PARTS, TOGETHER, chosen_with, forced

alike = pytest.mark.skipif(
    json.loads(RECORD.read_text())["machine"] != machine(), reason="recorded with other packages"
)


@alike
def test_numpy_and_libraries_of_algebra_may_take_any_instructions() -> None:
    assert forced(TOGETHER, TASKS[2], "realistic", (0,)) == {"0": recorded(TASKS[2], "realistic")["0"]}


@alike
@pytest.mark.long
@pytest.mark.parametrize("physics", PRESETS)
@pytest.mark.parametrize("env_id", TASKS)
@pytest.mark.parametrize("name", FORCED)
def test_episodes_do_not_depend_on_instructions(name: str, env_id: str, physics: str) -> None:
    assert forced(FORCED[name], env_id, physics, (0,)) == recorded(env_id, physics, (0,))


@pytest.fixture(scope="module")
def usual() -> dict[str, str]:
    """What is chosen where nothing is forced."""
    return chosen_with({})


@pytest.mark.long
@pytest.mark.parametrize("name", [*FORCED, *NOT_PROMISED])
def test_what_is_forced_is_chosen(name: str, usual: dict[str, str]) -> None:
    """Else the tests above would show nothing; some of what a processor takes by itself may be the usual choice."""
    variables = {**FORCED, **NOT_PROMISED}[name]
    found = chosen_with(variables)
    changed = {part for part, bits in found.items() if bits != usual[part]}
    wanted = {PARTS[variable] for variable in variables}
    assert changed & wanted if name == NATIVE else changed >= wanted
