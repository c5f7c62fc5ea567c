"""The card of a LeRobot dataset, README.md: what the Hub and readers learn of it first."""

from __future__ import annotations

import json
from pathlib import Path

from hazard_ms.demonstrations.export.source import Source

LICENCE = (
    "cc-by-3.0"  # the Hub's name of what the strictest models that come with hazard_ms ask for: name their authors
)
TEXT = """\
---
license: {licence}
task_categories:
- robotics
tags:
- LeRobot
- hazard_ms
configs:
- config_name: default
  data_files: data/*/*.parquet
---

# {env_id} by {agent}

{count} episodes in LeRobot's format v3.0, {rate} rows a second, recorded with hazard_ms.

A row is a frame, or a picture of the head camera where pictures were recorded. Then the action of a row is the one that
was sent in the frame of its picture, and the reward is the sum over all frames up to the next picture.

The table `meta/episodes` has the seed, the scene and the settings with which an episode begins again, and the versions
of the packages with which it was recorded. With a row for every frame, its actions give its states again, too.

```python
import json
import gymnasium as gym
import hazard_ms
import pyarrow.parquet as pq

row = pq.read_table("meta/episodes").to_pylist()[0]
env = gym.make(row["env_id"], control_mode=row["control_mode"], **json.loads(row["settings"]))
obs, info = env.reset(seed=row["seed"], options={options})
```

Settings of all episodes:

```json
{settings}
```

```text
{actions}
```

Licence: {licence}. Models and textures in pictures are under CC0 and CC-BY, or our own work;
`assets/ATTRIBUTION.md` of hazard_ms names their authors. Models of your own keep their licence.
"""


def write_card(source: Source, rate: int, folder: Path) -> None:
    """Write the card of a dataset with `rate` rows a second into `folder`."""
    common = source.common
    named = "scenes" not in common.settings  # else the scene is that of a file
    text = TEXT.format(
        licence=LICENCE,
        env_id=common.env_id,
        agent=common.agent,
        count=source.count,
        rate=rate,
        options='{"scene": row["scene"]}' if named else "None",
        settings=json.dumps({"control_mode": common.control_mode, **common.settings}, indent=1),
        actions=source.action_text,
    )
    (folder / "README.md").write_text(text)
