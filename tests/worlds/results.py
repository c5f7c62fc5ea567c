"""Results of episodes that nobody played."""

from __future__ import annotations

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult, file_hashes
from hazard_ms.sensing.detection.perception import eyes_of


def result_of(episode: EpisodeOptions, saved: bool = False, ended: str = "time") -> EpisodeResult:
    """The result of an episode with two targets of equal value, of which one is rescued if `saved`."""
    fate = Fate("book_1", "book", 5.0, saved, False, 100 if saved else None)
    lost = Fate("pan_1", "pan", 5.0, False, False, None)
    return EpisodeResult(
        env_id=episode.env_id,
        agent=episode.agent,
        seed=episode.seed,
        scene="kitchen_b/00",
        settings=episode.settings,
        frames=1500,
        max_frames=1500,
        ended=ended,
        targets=(fate, lost),
        decisions=(),
        command="",
        clock=episode.clock,
        perception=episode.perception,
        eyes=eyes_of(episode.perception),
        files=file_hashes(episode.agent, episode.perception),
    )
