"""One rescue as the server sees it: its process, what the process last said, and the pages that show it."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import os
import threading
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from hazard_ms.cli.web.playing.link import LONGEST_BYTES, PICTURES
from hazard_ms.cli.web.playing.process import main
from hazard_ms.cli.web.rescue import Rescue, Taken
from hazard_ms.machine.processes import few_threads, needs_key, without_keys

PASSING = ("pointed", "refused")  # answers that a page which comes later does not need
LAST = ("closed", "failed", "kept")  # words after which a process ends as it should
MOST_WAITING = 64  # messages of pages that the process has not read [ours]
Payload = bytes | str


class Page:
    """A page that shows a rescue: what it has not been sent yet, of each kind the latest."""

    def __init__(self, first: dict[str, Payload]) -> None:
        self._waiting = dict(first)
        self._news = asyncio.Event()
        self._news.set()

    def post(self, key: str, payload: Payload) -> None:
        """Let the page have this, in place of an older one of its kind."""
        self._waiting.pop(key, None)
        self._waiting[key] = payload
        self._news.set()

    async def next(self) -> list[Payload]:
        """What has come since the last call, at least one."""
        await self._news.wait()
        self._news.clear()
        news, self._waiting = list(self._waiting.values()), {}
        return news


class Session:
    """A rescue under way. Its methods are called in the loop of the server; threads wait for the process."""

    def __init__(self, rescue: Rescue, folder: Path) -> None:
        self.rescue, self._folder = rescue, folder
        self.pages: set[Page] = set()
        self.alive = False
        self.finishing = False  # whether its episode is over, and its process makes the film: that ends by itself
        self.looked_at = time.monotonic()
        self.taken: list[Taken] = []  # decisions that have ended
        self._latest: dict[str, Payload] = {}
        self._loop = asyncio.get_running_loop()
        self._process: Any = None
        self._waiting: list[bytes] = []
        self._sending = threading.Condition()

    def start(self) -> None:
        """Start the process."""
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        self._process = context.Process(target=main, args=(theirs, self.rescue, self._folder), daemon=True)
        agents, load = (self.rescue.episode.agent, self.rescue.after or ""), self.rescue.episode.load
        keyed = any(needs_key(agent, load) for agent in agents)
        with few_threads(drawing=os.cpu_count() or 1), without_keys(needed=keyed):
            self._process.start()
        theirs.close()
        self.alive, self.finishing, self._said_last = True, False, False
        self.taken, self._latest, self._waiting = [], {}, []
        process = self._process
        threading.Thread(target=self._read, args=(ours, process), daemon=True).start()
        threading.Thread(target=self._write, args=(ours, process), daemon=True).start()

    def end(self) -> None:
        """End the process; the journal stays."""
        if self._process is not None and self.alive:
            self._said_last = True
            self._process.kill()

    def show(self) -> Page:
        """A new page that shows the rescue."""
        page = Page(self._latest)
        self.pages.add(page)
        return page

    def leave(self, page: Page) -> None:
        """The page has gone."""
        self.pages.discard(page)
        self.looked_at = time.monotonic()

    def ask(self, message: dict[str, Any]) -> None:
        """Pass on what a page asks for. Raises ValueError where it is too long, or the process too far behind."""
        content = json.dumps(message).encode()
        if len(content) > LONGEST_BYTES:
            raise ValueError(f"a message must have at most {LONGEST_BYTES} bytes, got {len(content)}")
        with self._sending:
            if len(self._waiting) >= MOST_WAITING:
                raise ValueError(f"a page must have at most {MOST_WAITING} messages waiting, got more")
            self._waiting.append(content)
            self._sending.notify()

    def post(self, kind: str, **content: Any) -> None:
        """Tell all pages something of the server's own."""
        self._spread(kind, json.dumps({"type": kind, **content}))

    def _spread(self, key: str, payload: Payload) -> None:
        if key not in PASSING:
            self._latest.pop(key, None)
            self._latest[key] = payload
        for page in self.pages:
            page.post(key, payload)

    def _heard(self, message: bytes) -> None:
        """A message of the process has come."""
        letter = message[:1].decode("latin-1")
        if letter in PICTURES:
            self._spread(letter, message)
            return
        text = message.decode()
        row = json.loads(text)
        kind = row["type"]
        self._said_last |= kind in LAST
        self.finishing |= kind == "over" and "summary" in row
        if kind == "row":
            self.taken.append(Taken(row["verb"], row["target"], row["waited"], row["note"]))
        self._spread(f"row {row['number']}" if kind == "row" else kind, text)

    def _died(self, process: Any) -> None:
        if process is not self._process:
            return  # another one has taken its place
        self.alive = False
        if not self._said_last:
            code = process.exitcode
            self.post("died", why=f"signal {-code}" if code is not None and code < 0 else f"exit code {code}")

    def _read(self, connection: Connection, process: Any) -> None:
        """Pass messages on to the loop, in a thread of its own."""
        try:
            while True:
                message = connection.recv_bytes()
                self._loop.call_soon_threadsafe(self._heard_of, message, process)
        except (EOFError, OSError):
            process.join()
        except RuntimeError:  # the loop has ended
            return
        with self._sending:
            self._sending.notify_all()
        try:
            self._loop.call_soon_threadsafe(self._died, process)
        except RuntimeError:
            return

    def _heard_of(self, message: bytes, process: Any) -> None:
        if process is self._process:
            self._heard(message)

    def _write(self, connection: Connection, process: Any) -> None:
        """Pass messages of pages on to the process, in a thread of its own: the pipe may be full."""
        while True:
            with self._sending:
                self._sending.wait_for(lambda: self._waiting or not process.is_alive())
                if process is not self._process or not self._waiting:
                    return
                message = self._waiting.pop(0)
            try:
                connection.send_bytes(message)
            except OSError:
                return
