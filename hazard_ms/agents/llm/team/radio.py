"""The team as one robot knows it, told to its model: where the others are, and what was told over the radio."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from hazard_ms.agents.llm.homes.rooms import Rooms
from hazard_ms.agents.llm.scene_text import Block, plain_names
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision, Message
from hazard_ms.spec.registry.mitigations import TELL

MOST = 10  # messages that are told, the newest [ours]
NEAR = 3.0  # distance of a robot from a thing within which it is told to be near it [m] [ours]

Place = tuple[float, float]  # x, y [m], world frame


@dataclass
class Radio:
    """The radio of the robot called `name`."""

    name: str
    sent: list[Message] = field(default_factory=list)  # what the robot has told itself, oldest first

    def note(self, decision: Decision) -> None:
        """Enter what the robot has just told the others."""
        action, result = decision.last_action, decision.last_result
        if action is not None and action.verb == TELL and result is not None and result.ok:
            self.sent.append(Message(decision.frame, self.name, str(action.target)))

    def added(self, told: Block, brief: Brief, decision: Decision, rooms: Rooms) -> Block:
        """The block `told` of a decision, and the team."""
        names = plain_names(decision.names)
        seen = {names[decision.names[index]]: sight.position for index, sight in decision.map.objects.items()}
        places = {name: (float(at[0]), float(at[1])) for name, at in seen.items()}
        header, *rows = told["targets"]
        thing = header.index("thing")
        targets = [[*header, *(f"metres_from_{other.name}" for other in decision.others)]]
        for row in rows:
            targets.append([*row, *(_metres(other.position, places[row[thing]]) for other in decision.others)])
        tells_rooms = bool(brief.mitigations) and brief.several_rooms
        team: list[list[Any]] = [["robot", "metres", "near", *(["room"] if tells_rooms else [])]]
        for other in decision.others:
            row = [other.name, _metres(other.position, decision.agent_position), _nearest(places, other.position)]
            team.append([*row, *([rooms.at(other.position)] if tells_rooms else [])])
        return {"robot": self.name, "team": team, "radio": self._heard(decision), **told, "targets": targets}

    def _heard(self, decision: Decision) -> list[list[Any]]:
        """The newest messages of all, oldest first."""
        every = sorted((*decision.messages, *self.sent), key=lambda message: message.frame)
        return [
            ["frames_ago", "from", "text"],
            *([decision.frame - message.frame, message.sender, message.text] for message in every[-MOST:]),
        ]


def _nearest(places: Mapping[str, Place], to: Place) -> str | None:
    """The name of the nearest of the `places` within NEAR; None for none."""
    near = {name: math.dist(place, to) for name, place in places.items() if math.dist(place, to) <= NEAR}
    return min(near, key=near.__getitem__, default=None)


def _metres(one: Place, other: Place) -> float:
    return round(math.dist(one, other), 1)
