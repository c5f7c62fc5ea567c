"""Results of episodes out of folders, in groups that were played under the same settings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.agents.latency import OFF
from hazard_ms.evaluation.comparison.pairing import Episode
from hazard_ms.evaluation.metrics import value
from hazard_ms.evaluation.regret.causes import EpisodeRegret, beside
from hazard_ms.evaluation.result import DamagedResultError, EpisodeResult, result_files
from hazard_ms.sensing.detection.eyes import EYES
from hazard_ms.spec.registry.detectors import TRUTH


@dataclass(frozen=True)
class Kept:
    """A result, the file that holds it, and its regret where `hazard-ms regret` has judged it as it is."""

    result: EpisodeResult
    path: Path
    regret: EpisodeRegret | None = None

    @property
    def episode(self) -> Episode:
        """Seed and scene: agents are compared on episodes that agree in both."""
        return self.result.seed, self.result.scene


@dataclass(frozen=True)
class Group:
    """All results with the same task and settings, by agent, the best first, and then by episode."""

    title: str  # task and settings in words
    agents: dict[str, dict[Episode, Kept]]

    @property
    def results(self) -> list[EpisodeResult]:
        """All results of the group."""
        return [kept.result for made in self.agents.values() for kept in made.values()]

    @property
    def max_frames(self) -> int:
        """The greatest length of an episode [frames]."""
        return max(result.max_frames for result in self.results)

    @property
    def episodes(self) -> list[Episode]:
        """Every episode that any agent played, in order."""
        return sorted({episode for made in self.agents.values() for episode in made})

    def values(self, agent: str) -> dict[Episode, float]:
        """Value of each episode of an agent, 0 to 1."""
        return {episode: kept.result.tally.value for episode, kept in self.agents[agent].items()}

    def averted(self, agent: str) -> dict[Episode, float]:
        """The share that an agent averted in each episode where that is known and defined, at most 1."""
        every = {episode: kept.result.averted for episode, kept in self.agents[agent].items()}
        return {episode: share for episode, share in every.items() if share is not None}


def groups(folders: Sequence[Path]) -> tuple[list[Group], list[str]]:
    """The results in `folders` and the folders in them, and a line for each file that holds no whole result.

    Raises ValueError for a folder that does not exist, for results of another format, for damaged regrets, for an
    agent's episode that is there twice, and where there is no result at all.
    """
    found: list[Kept] = []
    left_out: list[str] = []
    for path in result_files(folders):
        try:
            found.append(Kept(EpisodeResult.read(path), path, beside(path)))
        except DamagedResultError as damaged:
            left_out.append(str(damaged))
    if not found:
        names = ", ".join(map(str, folders))
        raise ValueError(f"folders must hold results of `hazard-ms evaluate -o FOLDER`, got none in {names}")
    return grouped(found), left_out


def grouped(results: Iterable[Kept]) -> list[Group]:
    """Results in groups, by their titles. Raises ValueError for an agent's episode that is there twice."""
    found: dict[str, dict[str, dict[Episode, Kept]]] = {}
    for kept in results:
        own = found.setdefault(title(kept.result), {}).setdefault(kept.result.agent, {})
        if kept.episode in own:
            raise ValueError(
                f"results must hold each episode of an agent once, got {own[kept.episode].path} and {kept.path}"
            )
        own[kept.episode] = kept
    return [Group(name, _best_first(found[name])) for name in sorted(found)]


def _best_first(agents: dict[str, dict[Episode, Kept]]) -> dict[str, dict[Episode, Kept]]:
    """Agents by their mean Value, and each one's episodes in order."""
    means = {agent: value([kept.result.tally for kept in made.values()]) or 0.0 for agent, made in agents.items()}
    return {agent: dict(sorted(agents[agent].items())) for agent in sorted(agents, key=lambda a: (-means[a], a))}


def title(result: EpisodeResult) -> str:
    """Task and settings in words: "HazardFire-v1, split test, physics paper, robot fetch"."""
    words = [result.env_id]
    for name, setting in result.settings.items():
        if isinstance(setting, bool):
            words += [name.replace("_", " ")] if setting else []
        else:
            shown = " and ".join(map(str, setting)) if isinstance(setting, (list, tuple)) else str(setting)
            words.append(f"{name.removesuffix('_uids').replace('_', ' ')} {shown}")
    words += [] if result.clock == OFF else [f"clock {result.clock}"]
    words += [] if result.perception == TRUTH else [f"perception {result.perception}"]
    words += [] if result.eyes == EYES else [f"eyes {result.eyes}"]
    return ", ".join(words)
