"""The licence of an exported dataset: that of the models in its pictures, as LICENSES.csv of a capture tells it."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from hazard_ms.perception.layout import LICENCES
from hazard_ms.spec.foreign.files import read_text

LARGEST = 10_000_000  # of the table [bytes] [ours]
HUB = {"CC0": "cc0-1.0", "CC0-1.0": "cc0-1.0", "CC-BY-4.0": "cc-by-4.0", "CC-BY-SA-4.0": "cc-by-sa-4.0"}  # its names


def licence_of(dataset: Path) -> str:
    """The lines of the front matter that tell the licence of `dataset`. Raises ValueError for a table that is broken.

    One licence that the Hub knows is told by its name; of several, the table tells which model has which.
    """
    path = dataset / LICENCES
    if not path.exists():
        return "license: unknown"
    rows = csv.DictReader(io.StringIO(read_text(path, LARGEST)))
    found = {str(row.get("licence") or "") for row in rows}
    if len(found) == 1 and (name := HUB.get(next(iter(found)))):
        return f"license: {name}"
    return f"license: other\nlicense_name: see-table\nlicense_link: {LICENCES}"
