"""Rescues as the server keeps them: looking at one, going back in one, and messages to its process."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from hazard_ms.cli.web.options import ServeOptions
from hazard_ms.cli.web.playing.link import LONGEST_BYTES
from hazard_ms.cli.web.rescue import Taken, asked_for, read
from hazard_ms.cli.web.session import Session
from hazard_ms.cli.web.sessions import Sessions

TAKEN = [Taken("explore", None, 3), Taken("walk_to", "mug_1"), Taken("stop", None)]


def in_loop(what: Callable[[], None]) -> None:
    """Call it in a loop, as the server does."""

    async def call() -> None:
        what()

    asyncio.run(call())


def test_a_page_that_leaves_has_looked_until_then(tmp_path: Path) -> None:
    def leaves() -> None:
        session = Session(asked_for({}, ()), tmp_path)
        page = session.show()
        session.looked_at = 0.0
        session.leave(page)
        assert not session.pages and time.monotonic() - session.looked_at < 60.0

    in_loop(leaves)


def test_going_back_forgets_the_decisions_after_it(tmp_path: Path) -> None:
    def goes_back() -> None:
        sessions = Sessions(ServeOptions(folder=(tmp_path,)))
        session = sessions.begin(asked_for({"kind": "watch", "agent": "greedy"}, ()))
        try:
            session.taken = list(TAKEN)
            sessions.jump(session.rescue.name, 1)
            assert session.rescue.taken == tuple(TAKEN[:1]) and session.rescue.gone_back == 1
            assert read(tmp_path, session.rescue.name, ()).taken == tuple(TAKEN[:1])
        finally:
            sessions.end()

    in_loop(goes_back)


def test_what_is_too_long_for_the_process_is_refused_before_it_gets_there(tmp_path: Path) -> None:
    def asks() -> None:
        session = Session(asked_for({}, ()), tmp_path)
        with pytest.raises(ValueError, match=f"a message must have at most {LONGEST_BYTES} bytes, got 24"):
            session.ask({"do": "thing", "name": "\U0001f525" * 2000})
        session.ask({"do": "thing", "name": "\U0001f525" * 1000})

    in_loop(asks)
