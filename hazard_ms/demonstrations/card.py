"""The card of a dataset, README.md: what it holds, how it was made, and how to read it."""

from __future__ import annotations

import json
from pathlib import Path

from hazard_ms.demonstrations.layout import CARD, FAILURES, FORMAT, MANIFEST
from hazard_ms.demonstrations.sound import Named
from hazard_ms.demonstrations.stats import Stats
from hazard_ms.spec.storage.files import write

TEXT = """\
# {env_id}, played by {agent}

Demonstrations of the rescue task {env_id}, recorded with hazard_ms, format {format}. Every file and array is described
in docs/demonstrations.md of hazard_ms.

{table}

Made by:

```json
{recipe}
```

Read it:

```python
from pathlib import Path
from hazard_ms.demonstrations.reading import demonstrations

for demonstration in demonstrations(Path("{folder}")):
    print(demonstration.result.scene, demonstration.frames["action"].shape)
```

Actions are those of the controllers of mode `{mode}`: `hazard-ms describe` says what every number of them is.
`features`, `mask` and prompts show what an agent without privileges has seen; {privileged}
Episodes under `{failures}/` were not kept; their `reason` says why.
"""
TOLD = "the teacher chose with more than that: its choices cannot all be learnt from them."
HONEST = "the teacher chose with that alone."


def write_card(dataset: Path) -> None:
    """Write the card of a dataset, if it has an episode. Raises ValueError where it cannot be written."""
    found = Stats.of(dataset)
    if not found.entries:
        return
    recipe = Named(f"the recipe in {dataset / MANIFEST}", found.entries[0].recipe)
    write(
        dataset / CARD,
        TEXT.format(
            env_id=recipe["env_id"],
            agent=recipe["agent"],
            format=FORMAT,
            table=found.table(),
            recipe=json.dumps(recipe, indent=1),
            folder=dataset.name,
            mode=found.meta["control_mode"],
            privileged=TOLD if found.meta["privileged"] else HONEST,
            failures=FAILURES,
        ),
    )
