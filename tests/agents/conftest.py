"""Agents that ask a language model ask the scripted server here, wherever all registered agents are tested."""

from __future__ import annotations

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session", autouse=True)
def scripted_model() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HAZARD_MS_LLM_BASE_URL", "scripted")
        patch.setenv("HAZARD_MS_LLM_MODEL", "greedy")
        yield
