"""State of an episode in which a gust front passes."""

from __future__ import annotations

from dataclasses import dataclass

from torch import Tensor

from hazard_ms.hazards.base import quantity
from hazard_ms.hazards.wind.wind_state import WindState


@dataclass
class GaleState(WindState):
    """State of the wind with a front; what WindState has of the air is that in the middle of the scene now."""

    time: Tensor = quantity("E", "s", "time since the start", low=0.0)
    onset: Tensor = quantity("E", "s", "when the front passes the middle of the scene", low=0.0)
    way: Tensor = quantity("E 2", "", "where the front moves to, a unit vector")
    pace: Tensor = quantity("E", "m/s", "speed of the front", low=0.0)
    blown: Tensor = quantity("E 2", "m", "how far the air in the middle of the scene has come")
    lifted: Tensor = quantity("E", "m/s", "fastest mean wind in the scene and around it", low=0.0)
    first_heading: Tensor = quantity("E 2", "", "where the wind blows to before the front, a unit vector")
    first_speed: Tensor = quantity("E", "m/s", "mean wind before the front", low=0.0)
    first_loss: Tensor = quantity("E Y X", "", "share of the wind that is lost before the front")
    first_cause: Tensor = quantity("E Y X", "m", "height of what shelters the cell then")
    middle_heading: Tensor = quantity("E 2", "", "where the wind blows to right behind the front, a unit vector")
    middle_speed: Tensor = quantity("E", "m/s", "mean wind right behind the front", low=0.0)
    middle_loss: Tensor = quantity("E Y X", "", "share of the wind that is lost right behind the front")
    middle_cause: Tensor = quantity("E Y X", "m", "height of what shelters the cell then")
    last_heading: Tensor = quantity("E 2", "", "where the wind blows to in the end, a unit vector")
    last_speed: Tensor = quantity("E", "m/s", "mean wind in the end", low=0.0)
    last_loss: Tensor = quantity("E Y X", "", "share of the wind that is lost in the end")
    last_cause: Tensor = quantity("E Y X", "m", "height of what shelters the cell then")
    place: Tensor = quantity("E B 3", "m", "where each thing was last put")
    rested: Tensor = quantity("E B", "s", "time since a hand let it go", low=0.0)
