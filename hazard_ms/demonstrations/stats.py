"""Numbers about a dataset: `hazard-ms demos stats`."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

from hazard_ms.demonstrations.layout import Entry, shelves
from hazard_ms.demonstrations.reading import described, entries, numbered
from hazard_ms.evaluation.replay import other_versions

NUMBER = re.compile(r"\d+(\.\d+)?")


@dataclass(frozen=True)
class Stats:
    """A dataset in numbers: `entries` and `folders` of all episodes, kept ones first, and `meta` of the first."""

    dataset: Path
    entries: tuple[Entry, ...]
    folders: tuple[Path, ...]
    meta: dict[str, Any]
    damaged: int = 0  # lines of its manifests that cannot be read

    @classmethod
    def of(cls, dataset: Path) -> Stats:
        """The numbers of a dataset. Raises ValueError for a dataset of another format."""
        found = [(shelf / entry.name, entry) for shelf in shelves(dataset) for entry in entries(shelf)]
        meta = described(found[0][0])[1] if found else {}
        damaged = sum(entry is None for shelf in shelves(dataset) for _, entry in numbered(shelf))
        return cls(dataset, tuple(entry for _, entry in found), tuple(folder for folder, _ in found), meta, damaged)

    @property
    def kept(self) -> tuple[Entry, ...]:
        """The episodes that were kept."""
        return tuple(entry for entry in self.entries if not entry.reason)

    @property
    def reasons(self) -> Counter[str]:
        """Numbers of episodes that were not kept, by reason; numbers in reasons are left out."""
        return Counter(NUMBER.sub("…", entry.reason) for entry in self.entries if entry.reason)

    def rows(self) -> list[tuple[str, str]]:
        """The numbers: the name of each, and its value with its unit."""
        frames = sum(entry.frames for entry in self.entries)
        sizes = sum(entry.size for entry in self.entries)
        rows = [
            ("episodes kept", f"{len(self.kept)} of {len(self.entries)}"),
            *((f"not kept: {reason}", str(count)) for reason, count in self.reasons.most_common()),
            ("scenes", str(len({entry.scene for entry in self.entries}))),
            ("frames", str(frames)),
            ("decisions", str(sum(entry.decisions for entry in self.entries))),
            ("simulated again, and the same", f"{sum(e.verified for e in self.entries)} of {len(self.entries)}"),
            ("size", f"{sizes / 1e6:.1f} MB, {sizes / max(frames, 1):.0f} bytes per frame"),
        ]
        if self.kept:
            rows.insert(1, ("mean value of those", f"{100 * fmean(entry.value for entry in self.kept):.1f} %"))
        if self.damaged:
            rows.insert(0, ("damaged lines of manifests", f"{self.damaged}; see `hazard-ms demos verify`"))
        times = [entry.seconds for entry in self.entries if entry.seconds]
        if times:
            again = fmean(seconds.get("verify", 0.0) for seconds in times)
            whole = fmean(sum(seconds.values()) for seconds in times)
            rows.append(("wall time of an episode", f"{whole:.1f} s, of which {again:.1f} s to simulate it again"))
        return rows

    def table(self) -> str:
        """The numbers as a table in Markdown."""
        rows = self.rows()
        wide = max(len(name) for name, _ in rows)
        lines = [f"| {name:<{wide}} | {text} |" for name, text in (("number", "value"), ("-" * wide, "---"), *rows)]
        return "\n".join(lines)


def stats(dataset: Path) -> str:
    """The numbers of a dataset as text, and the packages of which this machine has another version."""
    found = Stats.of(dataset)
    others = Counter(other_versions(entry.versions) for entry in found.entries)
    told = "".join(f"\n{count} episodes recorded with {text}\n" for text, count in others.items() if text)
    return f"{dataset}\n\n{found.table()}\n{told}"
