"""All rescues of a server: at most so many at once; those that nobody looks at give their process back."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace
from typing import Any

from hazard_ms.cli.web import rescue as rescues
from hazard_ms.cli.web.options import ServeOptions
from hazard_ms.cli.web.rescue import Rescue
from hazard_ms.cli.web.session import Session
from hazard_ms.spec.checks import whole

LOOK_ROUND = 5.0  # time between two searches for idle rescues [s] [ours]


class Sessions:
    """The rescues of one server, by name."""

    def __init__(self, options: ServeOptions) -> None:
        self._options, self._folder = options, options.folders[0]
        self._all: dict[str, Session] = {}

    def begin(self, rescue: Rescue) -> Session:
        """Begin a rescue, or continue one. Raises ValueError where there are too many."""
        self._make_room()
        rescues.keep(self._folder, rescue)
        return self._start(Session(rescue, self._folder))

    def _start(self, session: Session) -> Session:
        self._all[session.rescue.name] = session
        session.start()
        return session

    def find(self, name: str) -> Session:
        """The rescue called `name`; one whose process has ended goes on in a new one, by its journal.

        Raises ValueError where there is none, or none that can be gone on with.
        """
        rescues.journal(self._folder, name)  # refuses names that no rescue has
        if name in self._all:
            return self._all[name]
        rescue = rescues.read(self._folder, name, self._options.load)
        self._make_room()
        return self._start(Session(rescue, self._folder))

    def again(self, name: str) -> Session:
        """Let a rescue whose process has ended go on in a new one. Raises ValueError as `find` does."""
        session = self.find(name)
        if not session.alive:
            session.rescue = rescues.read(self._folder, name, self._options.load)
            self._make_room()
            session.start()
            session.post("again")
        return session

    def jump(self, name: str, decisions: Any) -> None:
        """Take a rescue that is watched back to after its first `decisions`. Raises ValueError where it cannot be."""
        session = self.find(name)
        if session.rescue.kind != rescues.WATCH:
            raise ValueError("rescue must be watched to go back in it, got one that is played")
        whole(decisions, 0, len(session.taken), "decisions")
        known = self._known(session)
        session.end()
        back = session.rescue.gone_back + 1
        session.rescue = replace(session.rescue, taken=known.taken[:decisions], over=False, gone_back=back)
        rescues.keep(self._folder, session.rescue)
        session.start()
        session.post("again")
        session.ask({"do": "pause"})

    def take_over(self, name: str, decisions: Any) -> Session:
        """A person's rescue that goes on after the first `decisions` of the one called `name`.

        Raises ValueError where that cannot be.
        """
        session = self.find(name)
        made = rescues.taken_over(self._known(session), whole(decisions, 0, len(session.taken), "decisions"))
        return self.begin(made)

    def _known(self, session: Session) -> Rescue:
        """The rescue with all its decisions."""
        return replace(session.rescue, taken=tuple(session.taken))

    def close(self, name: str) -> None:
        """End a rescue for good: nothing remains of it. Raises ValueError for a name that no rescue has."""
        path = rescues.journal(self._folder, name)
        session = self._all.pop(name, None)
        if session is not None:
            session.end()
            session.post("closed")
        path.unlink(missing_ok=True)

    def listed(self) -> list[dict[str, Any]]:
        """The rescues that can be continued, those under way first."""
        found = []
        for path in sorted((self._folder / rescues.JOURNALS).glob(f"*{rescues.END}")):
            try:
                rescue = rescues.read(self._folder, path.name.removesuffix(rescues.END), self._options.load)
            except ValueError:
                continue  # of another version; nobody can go on with it
            session = self._all.get(rescue.name)
            found.append(
                {
                    "name": rescue.name,
                    "kind": rescue.kind,
                    "task": rescue.episode.env_id,
                    "agent": rescue.episode.agent,
                    "seed": rescue.episode.seed,
                    "scene": rescue.episode.scene,
                    "decisions": len(rescue.taken),
                    "alive": session is not None and session.alive,
                    "over": rescue.over,
                }
            )
        return sorted(found, key=lambda row: not row["alive"])

    def _make_room(self) -> None:
        """Make room for one more process. Raises ValueError where all are looked at."""
        alive = [s for s in self._all.values() if s.alive]
        if len(alive) < self._options.sessions:
            return
        idle = sorted((s for s in alive if not s.pages), key=lambda s: s.looked_at)
        if not idle:
            raise ValueError(
                f"at most {self._options.sessions} rescues can run at once: end one, or start hazard-ms serve with "
                "more --sessions"
            )
        self._drop(idle[0])

    def _drop(self, session: Session) -> None:
        session.end()
        self._all.pop(session.rescue.name, None)

    async def look_round(self) -> None:
        """Give back the processes of rescues that nobody has looked at for long; runs for ever."""
        while True:
            await asyncio.sleep(LOOK_ROUND)
            for session in list(self._all.values()):
                unseen = not session.pages and time.monotonic() - session.looked_at > 60.0 * self._options.idle
                if unseen and not session.finishing:
                    self._drop(session)

    def end(self) -> None:
        """End all processes; journals stay."""
        for session in self._all.values():
            session.end()
