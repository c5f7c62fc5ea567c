"""Every table and picture: which commands make it, out of what, and in how many hours. `./run results` reads this.

In the order in which they are made: what reads another's rows comes after it. The page docs/numbers.md shows it all.
"""

from __future__ import annotations

from dataclasses import dataclass

ORIGINAL, GPU = "$HAZARD_MS_ORIGINAL", "/dev/nvidiactl"


@dataclass(frozen=True)
class Maker:
    """What makes some files of this repository.

    Args:
        name: What `./run results` calls it.
        commands: Begin with `python`, `hazard-ms` or `cp`, and are run one after another from the checkout.
        files: Those that it writes, from the checkout; `*` stands for anything.
        hours: Of a core, about: 30 to 110 s for an episode [homes.csv, perceived.csv], and what the docs tell.
        folders: Raw results in build/, from which its commands resume. Some belong to several makers.
        rows: Those of `files` that its commands read again, and whose episodes they do not play anew.
        needs: A file, or a `$VARIABLE`, that a machine must have.
        kept: Why it is not made anew for a release; empty for all that are.
    """

    name: str
    commands: tuple[str, ...]
    files: tuple[str, ...] = ()
    hours: float = 0.0
    folders: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()
    needs: str = ""
    kept: str = ""


def table(name: str, hours: float, *folders: str, rows: tuple[str, ...] = (), also: tuple[str, ...] = ()) -> Maker:
    """What results/NAME.py makes: results/NAME.md, the csv files `rows`, and the files `also`."""
    files = (f"results/{name}.md", *rows, *also)
    return Maker(name, (f"python results/{name}.py",), files, hours, folders, rows)


def after(maker: Maker, *commands: str) -> Maker:
    """The same with commands that come first."""
    return Maker(**{**vars(maker), "commands": (*commands, *maker.commands)})


CAPTURE = "python results/detector.py capture"
UNSEEN = ("pictures", "narrow", "camera", "unseen")  # what it takes
IMITATION = "build/imitation"
TEACH = "--load hazard_ms.tasks.practice -a oracle --obs rgb --cameras head+wrist --perturb control:2 --no-verify"
BY_HAND = "assembled by hand; has no numbers"

MAKERS = (
    Maker("validation", ("hazard-ms validate -o docs",), ("docs/validation.md", "docs/validation/*.png"), 0.3),
    Maker("gallery", ("hazard-ms gallery",), ("docs/gallery/README.md", "docs/gallery/*.jpg"), 1.0),
    Maker("speed", ("python results/speed.py",), ("docs/speed.md",), 0.2),
    Maker("gpu", ("python -m results.gpu",), ("docs/gpu.md",), 0.5, needs=GPU),
    table("paired", 0.5),
    table("capture", 0.5),
    Maker("benchmark", ("python results/make.py",), ("results/README.md", "results/scores.csv"), 30.0, ("results",),
          ("results/scores.csv",)),
    table("splits", 6.0, "splits", rows=("results/splits.csv",)),
    table("homes", 2.5, "homes", rows=("results/homes.csv",)),
    table("teams", 4.0, "teams", rows=("results/teams.csv",)),
    table("team_sketch", 0.5),
    Maker("original", (f"python results/original.py {ORIGINAL}",), ("results/original.md",), 10.0, ("original",),
          needs=ORIGINAL),
    Maker("latency", ("python results/latency.py",), ("results/latency.csv", "docs/latency.svg"), 4.0, ("latency",)),
    Maker("misses", ("python results/perception.py",), ("results/perception.csv", "docs/perception_value.svg"), 12.0,
          ("perception_value",)),
    after(table("eyes", 4.0, *UNSEEN), CAPTURE),
    after(table("known", 1.0, *UNSEEN, also=("docs/known.svg",)), CAPTURE),
    table("perceived", 11.5, "perceived", rows=("results/perceived.csv",)),
    table("perceived_regret", 2.0, "perceived_regret", rows=("results/perceived_regret.csv",)),
    after(table("perceived_parts", 3.0, *UNSEEN, "first_stage", "perceived_parts", also=("docs/perceived_parts.svg",)),
          CAPTURE),
    table("calm", 6.0, "seen_pictures", "calm_pictures", "detector_with_hazards", "detector_without",
          also=("docs/detector.svg",)),
    table("language_models", 3.0, "language_models"),
    table("hostile", 6.0, "hostile"),
    Maker("learned", ("python results/learned.py",),
          ("results/learned.md", "results/rl/rl-[fw]*.csv", "results/rl/rl_paper-*.csv"), 40.0, ("learned",),
          ("results/learned.md",)),
    Maker("learned_homes",
          ("hazard-ms train ppo -e HazardHouseFire-v1 --scenes 100 --decisions 400000 -o build/learned_homes",
           "cp build/learned_homes/rl_HazardHouseFire-v1.csv results/rl/rl-house_fire-0.csv"),
          ("results/rl/rl-house_fire-0.csv",), 1.2, ("learned_homes",)),
    Maker("ppo_low_level",
          ("python examples/ppo_low_level.py --task walk_to --minutes 15 --out build/ppo_low_level",
           "python examples/ppo_low_level.py --task pick_up --minutes 60 --out build/ppo_low_level",
           "cp build/ppo_low_level/walk_to.csv results/ppo_walk_to.csv",
           "cp build/ppo_low_level/pick_up.csv results/ppo_pick_up.csv",
           "python results/ppo_low_level.py"),
          ("results/ppo_walk_to.csv", "results/ppo_pick_up.csv", "docs/ppo_low_level.svg"), 2.5, ("ppo_low_level",)),
    Maker("imitation",  # one policy of each kind; of how they learned, the head in results/imitation.py tells by hand
          (f"hazard-ms demos record -e HazardPickUp-v1 {TEACH} -n 800 -o {IMITATION}/demos",
           f"python examples/act_from_pictures.py train {IMITATION}/demos/HazardPickUp-v1/oracle"
           f" --out {IMITATION}/pick_up-0",
           f"python examples/fetch_from_pictures.py look {IMITATION}/calm.npz",
           f"python examples/fetch_from_pictures.py look {IMITATION}/fire.npz --each 12 --seed 1 --hazards fire",
           f"python examples/fetch_from_pictures.py look {IMITATION}/flood.npz --each 8 --seed 2 --hazards flood",
           f"python examples/fetch_from_pictures.py walk {IMITATION}/calm.npz {IMITATION}/fire.npz"
           f" {IMITATION}/fire.npz {IMITATION}/flood.npz {IMITATION}/flood.npz --out {IMITATION}/fetch-0/walk",
           f"hazard-ms demos record -e HazardStow-v1 {TEACH} -n 300 -o {IMITATION}/demos",
           f"python examples/act_from_pictures.py train {IMITATION}/demos/HazardStow-v1/oracle"
           f" --out {IMITATION}/fetch-0/take",
           f"python examples/rescue/learn.py reach {IMITATION}/reaches.npz",
           f"python examples/rescue/learn.py demonstrate {IMITATION}/rescues.npz",
           f"python examples/rescue/learn.py train {IMITATION}/reaches.npz {IMITATION}/rescues.npz"
           f" --out {IMITATION}/first",
           f"python examples/rescue/learn.py reach {IMITATION}/more_reaches.npz --weights {IMITATION}/first"
           " --seeds 2 75 20 --seed 1",
           f"python examples/rescue/learn.py demonstrate {IMITATION}/more_rescues.npz --weights {IMITATION}/first"
           " --seeds 7 75 25 --seed 1",
           f"python examples/rescue/learn.py train {IMITATION}/reaches.npz {IMITATION}/rescues.npz"
           f" {IMITATION}/more_reaches.npz {IMITATION}/more_rescues.npz --out {IMITATION}/rescue-0",
           f"python results/imitation.py {IMITATION}/pick_up-0 {IMITATION}/fetch-0 --rescues {IMITATION}/rescue-0",
           f"cp {IMITATION}/pick_up-0/curve.csv results/imitation_curve.csv",
           *(f"cp {IMITATION}/fetch-0/{part}/curve.csv results/curves/fetch-0-{part}.csv" for part in ("walk", "take")),
           *(f"cp {IMITATION}/rescue-0/{n}.csv results/curves/rescue-0-{n}.csv" for n in ("walk", "reach", "stow"))),
          ("results/imitation.md", "results/imitation.csv", "results/rescues.csv", "results/imitation_curve.csv",
           "results/curves/*.csv"), 12.0,
          ("imitation",), ("results/imitation.csv", "results/rescues.csv")),
    Maker("detector", ("python results/detector.py",), ("results/detector.md",), 12.0,
          kept="the training of the weights of the package; results/eyes.md and results/perceived.md score these"),
    Maker("scenes", ("python -m results.scenes search 600",), ("results/scenes.md", "results/scenes.csv"), 10.0,
          kept="the search that chose the homes of `test` and `held_out`: they are as they are"),
    Maker("hidden", ("hazard-ms commitments winter.json --draw 25 --secret winter.secret.json",),
          ("results/hidden/*.json",), 0.1, kept="scenes that were drawn once, by chance"),
    Maker("leaderboard", ("hazard-ms leaderboard results/leaderboard -o site",), ("results/leaderboard/**/*",), 5.0,
          kept="submissions and signed reports, each of the version that it names"),
    Maker("killed_recordings", ("python results/killed_recordings.py DATASET -o FOLDER",), hours=1.0,
          kept="prints numbers of docs/demonstrations.md"),
    Maker("pickups", ("python results/pickups.py",), hours=2.0, kept="prints why pick-ups fail; quoted nowhere"),
    Maker("mitigations", ("python results/mitigations.py", "python results/mitigations.py doors"), hours=0.2,
          kept="prints the frames that hazard_ms/agents/mitigating/costs.py names"),
    Maker("labels", ("hazard-ms perception show build/pictures/HazardFire-v1 -o docs/labels_fire.jpg --things 100",),
          ("docs/labels_*.jpg", "docs/perception.jpg"), 0.1, kept=BY_HAND),
    Maker("indoors", ("python -m tests.effects.indoor_sheet join BEFORE AFTER docs/indoors.jpg",),
          ("docs/indoors.jpg",), 0.1, kept="compares with an older version"),
    Maker("streets", ("hazard-ms render -e HazardWind-v1 --scene street/03 --frame 150",), ("docs/streets*.jpg",), 0.1,
          kept=BY_HAND),
    Maker("home", ("hazard-ms render -e HazardHouseFire-v1 -s 3 --frame 1500 --camera home",), ("docs/homes.jpg",), 0.1,
          kept=BY_HAND),
    Maker("demo", ("hazard-ms play -e HazardFire-v1 --agent greedy -s 0 --video demo_output/fire.mp4",),
          ("docs/demo.jpg",), 0.1, kept="a frame of the film of `./run demo`"),
    Maker("architecture", (), ("docs/architecture.svg",), kept="drawn by hand; a test holds it to the imports"),
)  # fmt: skip
