"""The description of a rescue on the page, and its journal: all that is needed to go on with it in a new process."""

from __future__ import annotations

import json
import os
import re
import secrets
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.choices import HUMAN
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.files import inside, printable
from hazard_ms.spec.registry import AGENTS, TASKS
from hazard_ms.spec.storage.files import make_folder, write

PLAY, WATCH = "play", "watch"
KINDS = (PLAY, WATCH)
ALL, ROBOT = "all", "robot"  # pictures: with the third person's, or only those of the robot
VIEWS = (ALL, ROBOT)
PACES = (1, 2, 4, 8, 16)  # frames of the episode from one picture to the next
JOURNALS = ".rescues"  # folder of journals in the folder of results
END = ".journal"  # of their names: no result ends so
LONGEST_AGENT = 120  # of its name, so that a result's file has at most 255 [bytes] [ours]
FORMAT = 1  # of journals; goes up when a field changes its meaning
NAME = re.compile(r"[0-9a-f]{16}")  # of a rescue
NAMES = ("split", "physics", "severity", "robot_uids", "lighting")
LARGEST = 8_000_000  # of a journal [bytes] [ours]
ELSEWHERE = ("base_url", "cache", "trace")  # parameters of agents by which something leaves the folder of results
EPISODE = ("env_id", *NAMES, "affects_agent", "agent", "seed", "scene")  # options that a page may choose


@dataclass(frozen=True)
class Taken:
    """One decision that was taken: the action, and the frames that passed before it."""

    verb: str
    target: str | None
    waited: int = 0
    note: str = ""


@dataclass(frozen=True)
class Rescue:
    """One rescue: who plays which episode how, and what has been decided so far."""

    kind: str
    episode: EpisodeOptions
    after: str = ""  # agent that took the first decisions of a person's rescue
    view: str = ALL
    runs_on: bool = False  # whether the world goes on while a person chooses
    every: int = 4  # frames from one picture to the next
    taken: tuple[Taken, ...] = ()
    over: bool = False  # whether the episode has ended, and only its result or its film may be missing
    gone_back: int = 0  # how often an agent that is watched was taken back to an earlier decision
    name: str = field(default_factory=lambda: secrets.token_hex(8))

    def check(self) -> None:
        """Raises ValueError for what cannot be played, or may not be asked for by a page."""
        one_of(self.kind, KINDS, "kind")
        one_of(self.view, VIEWS, "view")
        pace(self.every)
        for what in ("runs_on", "over"):
            if not isinstance(getattr(self, what), bool):
                raise ValueError(f"{what} must be true or false, got {getattr(self, what)!r:.100}")
        whole(self.gone_back, 0, 2**32 - 1, "gone_back")
        e = self.episode
        whole(e.seed, 0, 2**32 - 1, "seed")
        one_of(e.env_id, TASKS, "env_id")
        for what in NAMES:
            if not isinstance(getattr(e, what), str):
                raise ValueError(f"{what} must be a name, got {getattr(e, what)!r:.100}")
        if not isinstance(e.affects_agent, bool):
            raise ValueError(f"affects_agent must be true or false, got {e.affects_agent!r:.100}")
        if len(os.fsencode(e.agent)) > LONGEST_AGENT:
            raise ValueError(
                f"agent must have at most {LONGEST_AGENT} bytes, since its result is named after it, got "
                f"{e.agent!r:.100}"
            )
        e.check()
        if e.scene is not None and (not isinstance(e.scene, str) or e.scene.endswith(".json")):
            raise ValueError(f"scene must be the name of a scene of the split, got {e.scene!r:.100}")
        if self.kind == WATCH:
            _registered(e.agent, "agent")
        elif not isinstance(e.agent, str) or e.agent.partition(":")[0] != HUMAN:
            raise ValueError(f"agent of a person's rescue must be {HUMAN}, got {e.agent!r:.100}")
        if self.after != "":
            _registered(self.after, "after")

    def to_json(self) -> str:
        """The journal: plain data."""
        episode = {name: getattr(self.episode, name) for name in EPISODE}
        row = {f.name: getattr(self, f.name) for f in fields(self)}
        return json.dumps({**row, "format": FORMAT, "episode": episode, "taken": [asdict(t) for t in self.taken]})


def asked_for(row: dict[str, Any], load: tuple[str, ...]) -> Rescue:
    """The rescue that a page asks for. Raises ValueError for what cannot be played."""
    known = ("kind", "view", "runs_on", "every", *EPISODE)
    for name in row:
        one_of(name, known, "a setting of a rescue")
    kind = one_of(row.get("kind", PLAY), KINDS, "kind")
    episode = {name: row[name] for name in EPISODE if row.get(name) not in (None, "")}
    episode["agent"] = HUMAN if kind == PLAY else str(row.get("agent", ""))
    others = {name: row[name] for name in ("view", "runs_on", "every") if name in row}
    made = Rescue(kind, EpisodeOptions(**episode, load=load), **others)
    made.check()
    return made


def taken_over(rescue: Rescue, decisions: int) -> Rescue:
    """A person's rescue that goes on after the first `decisions` of another one.

    Raises ValueError where that cannot be, as for agents that have told the map what is hidden.
    """
    from hazard_ms.agents.base import agent

    whole(decisions, 0, len(rescue.taken), "at")
    source = rescue.after or rescue.episode.agent
    if rescue.kind == WATCH and agent(source).privileged:
        raise ValueError(f"agent must see no more than a person does, so that a person can take over, got {source}")
    name = f"{HUMAN}:after={source.replace(',', ';')}" if rescue.kind == WATCH else rescue.episode.agent
    return Rescue(
        PLAY,
        replace(rescue.episode, agent=name),
        after=source if rescue.kind == WATCH else rescue.after,
        view=rescue.view,
        runs_on=rescue.runs_on,
        every=rescue.every,
        taken=rescue.taken[:decisions],
    )


def _registered(agent: Any, what: str) -> dict[str, str]:
    """The parameters of an agent, as text by name. Raises ValueError for all but registered ones: no file is loaded."""
    from hazard_ms.agents.base import PARAMETERS

    name, *given = PARAMETERS.split(agent, maxsplit=1) if isinstance(agent, str) else [agent]
    one_of(name, AGENTS, what)
    pairs = (part.partition("=") for part in "".join(given).replace(";", ",").split(","))
    return {key: value for key, _, value in pairs}


def _check_stays(agent: str) -> None:
    """Check that an agent of a journal, which a stranger may have written, asks nobody and writes nothing elsewhere.

    Raises ValueError for parameters that name an address or a place: the key for models would be sent there.
    """
    for key, value in _registered(agent, "agent").items():
        if key in ELSEWHERE or "/" in value:
            raise ValueError(f"an agent in a journal must not name an address or a path, got {key}; start a new rescue")


def pace(every: object) -> int:
    """The frames from one picture to the next. Raises ValueError for anything but one of PACES."""
    if not isinstance(every, int) or isinstance(every, bool) or every not in PACES:
        raise ValueError(f"every must be one of {PACES}, got {every!r:.100}")
    return every


def journal(folder: Path, name: str) -> Path:
    """The journal of a rescue in a folder of results. Raises ValueError for a name that no rescue has."""
    if not NAME.fullmatch(name):
        raise ValueError(f"the name of a rescue must be 16 hexadecimal digits, got {name!r:.100}")
    return folder / JOURNALS / f"{name}{END}"


def keep(folder: Path, rescue: Rescue) -> None:
    """Write the journal of a rescue, whole or not at all. Raises ValueError where it cannot be written."""
    make_folder(folder / JOURNALS)
    write(journal(folder, rescue.name), rescue.to_json())


def read(folder: Path, name: str, load: tuple[str, ...]) -> Rescue:
    """The rescue of a journal. Raises ValueError where there is none, or one that cannot be continued."""
    path = inside(folder, f"{JOURNALS}/{journal(folder, name).name}", "rescue")
    if not path.exists():
        raise ValueError(f"rescue must be under way, got {name}, which is over or has been deleted")
    try:
        row = plain.read(path, LARGEST)
        if row.pop("format", None) != FORMAT:
            raise ValueError("another format")
        episode = EpisodeOptions(**row.pop("episode"), load=load)
        taken = plain.made(tuple[Taken, ...], row.pop("taken"), "taken")
        made = Rescue(episode=episode, taken=taken, **row)
        made.check()
        for agent in (made.episode.agent if made.kind == WATCH else "", made.after):
            if agent:
                _check_stays(agent)
        if made.name != name:
            raise ValueError("another name")
    except (ValueError, TypeError, KeyError) as error:
        words = printable(f"{type(error).__name__}: {error}")
        raise ValueError(f"{path.name} must be the journal of a rescue, got {words}") from None
    return made
