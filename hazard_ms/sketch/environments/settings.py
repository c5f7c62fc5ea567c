"""Settings of environments of the sketch: a task, its scenes, a robot. Scenes are made when first played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from hazard_ms.sketch.fires.making import has_measures
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.scenes import EYES, MOST_SCENES, level_ranges, more_scenes, scenes_of
from hazard_ms.sketch.skill_times import SkillTimes, shipped
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.registry import TASKS
from hazard_ms.tasks import task_of

LONGEST = 2**31  # of an episode [frames]


@dataclass(frozen=True)
class Settings:
    """A task with some of its scenes. Scene k has the fate of seed k, as where the simulator plays a split."""

    task: str
    names: tuple[str, ...]  # of its scenes; their numbers where they are generated
    physics: str
    robot: str
    max_frames: int
    first: int | None  # number of the first of the generated scenes; None: scenes of a split
    _made: dict[int, SketchScene] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(
        cls,
        task: str,
        split: str = "train",
        scenes: Sequence[str] | None = None,
        generated: tuple[int, int] | None = None,
        physics: str = "paper",
        robot_uids: str = "fetch",
        max_frames: int | None = None,
    ) -> Settings:
        """Check what users give.

        Args:
            task: Name of the task.
            split: Split whose scenes are played.
            scenes: Names of the scenes that are played instead.
            generated: First number and count of scenes that are played instead and belong to no split: see
                `hazard_ms.sketch.scenes.more_scenes`.
            physics: Preset of the hazards.
            robot_uids: The robot.
            max_frames: Greatest length of an episode [frames]; None takes that of the task in its split.

        Raises:
            ValueError: For unknown names and impossible numbers.
        """
        known = task_of(task, physics)
        one_of(split, known.splits, "split")
        names = known.scenes(split) if scenes is None else tuple(scenes)
        for name in names:
            one_of(name, known.all_scenes, "scene")
        first = None
        if generated is not None:
            if scenes is not None or not isinstance(generated, Sequence) or len(generated) != 2:
                raise ValueError(
                    f"generated must be (first, count), and scenes must be None beside it, got {generated!r}"
                )
            first, count = generated
            more_scenes(task, physics, first, 0)  # refuses numbers of scenes that belong to a split
            names = tuple(str(first + k) for k in range(whole(count, 1, MOST_SCENES, "the count of generated")))
        if not names:
            raise ValueError("scenes must hold at least one scene, got none")
        frames = TASKS[task].frames(split) if max_frames is None else whole(max_frames, 1, LONGEST, "max_frames")
        return cls(task, names, physics, one_of(robot_uids, EYES, "robot_uids"), frames, first)

    @property
    def ranges(self) -> list[tuple[float, float]]:
        """The ends of the usual level of each hazard, in its unit."""
        return level_ranges(self.task, self.physics)

    @property
    def measures(self) -> bool:
        """Whether its options have measures about a fire."""
        return has_measures(task_of(self.task, self.physics))

    @property
    def times(self) -> SkillTimes:
        """The skill times of the robot."""
        return shipped(self.robot)

    def number(self, name: str | None) -> int | None:
        """The number of the scene called `name`; None for None. Raises ValueError for others than its own scenes."""
        return None if name is None else self.names.index(one_of(name, self.names, "reset option 'scene'"))

    def scene(self, number: int) -> SketchScene:
        """The scene with this number, made when it is first asked for."""
        if number not in self._made:
            if self.first is not None:
                (made,) = more_scenes(self.task, self.physics, self.first + number, 1, self.robot, self.max_frames)
            else:
                (made,) = scenes_of(
                    self.task, [self.names[number]], [number], self.physics, self.robot, self.max_frames
                )
            self._made[number] = made
        return self._made[number]

    def scenes(self) -> list[SketchScene]:
        """All its scenes."""
        return [self.scene(number) for number in range(len(self.names))]
