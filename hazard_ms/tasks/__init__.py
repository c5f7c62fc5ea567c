"""Tasks by the name under which gymnasium knows them: preset of physics -> task."""

from __future__ import annotations

from collections.abc import Callable

from hazard_ms.spec import Task
from hazard_ms.tasks.fire import hazard_fire
from hazard_ms.tasks.flood import hazard_flood
from hazard_ms.tasks.wind import hazard_wind

TASKS: dict[str, Callable[[str], Task]] = {"HazardFire-v1": hazard_fire, "HazardFlood-v1": hazard_flood, "HazardWind-v1": hazard_wind}
