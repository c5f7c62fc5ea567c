"""The package hazard_ms, with the folder `assets/` inside it as `hazard_ms/_assets`."""

import ast
from pathlib import Path

from setuptools import find_packages, setup

ROOT = Path(__file__).resolve().parent
ASSETS = "hazard_ms._assets"


def version() -> str:
    """`__version__` of hazard_ms, read without importing it."""
    for node in ast.parse((ROOT / "hazard_ms/spec/registry/version.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__version__":
            return str(ast.literal_eval(node.value))
    raise ValueError("hazard_ms/spec/registry/version.py has no __version__")


def asset_files() -> list[str]:
    """The files of `assets/` that belong to the package: all but hidden ones and `build`, with their scripts."""
    folder = ROOT / "assets"
    files = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]
    return [str(path) for path in files if path.parts[0] != "build" and not any(part[0] in "._" for part in path.parts)]


setup(
    name="hazard_ms",
    version=version(),
    description="Fire, flood and wind rescue tasks for ManiSkill and SAPIEN",
    long_description=(ROOT / "README.md").read_text(encoding="utf-8") if (ROOT / "README.md").exists() else "",
    long_description_content_type="text/markdown",
    author="The authors of hazard_ms",
    # the licence of the code, and those of models and textures
    license_expression="Apache-2.0 AND CC-BY-3.0 AND CC-BY-3.0-US AND CC0-1.0",
    license_files=["LICENSE", "assets/ATTRIBUTION.md"],
    python_requires=">=3.10,<3.13",
    keywords=["robotics", "embodied AI", "simulation", "reinforcement learning", "imitation learning", "ManiSkill"],
    classifiers=[
        "Intended Audience :: Science/Research",
        "Operating System :: POSIX :: Linux",
        "Programming Language :: Python :: 3.10",
        "Programming Language :: Python :: 3.11",
        "Programming Language :: Python :: 3.12",
        "Topic :: Scientific/Engineering :: Artificial Intelligence",
        "Typing :: Typed",
    ],
    packages=[*find_packages(include=["hazard_ms", "hazard_ms.*"]), ASSETS],
    package_dir={ASSETS: "assets"},
    package_data={ASSETS: asset_files(), "hazard_ms": ["**/*"]},
    # a checkout's own copy gives way to `assets/`
    exclude_package_data={"hazard_ms": ["_assets/*", "_assets/**/*", "**/__pycache__/*"]},
    include_package_data=False,
    entry_points={"console_scripts": ["hazard-ms = hazard_ms.cli.__main__:main"]},
    install_requires=[
        "sapien>=3.0.3",
        "mani-skill>=3.0.1",
        "gymnasium>=1.2",
        "torch>=2.10",  # earlier ones have known holes in torch.load
        "torchvision>=0.25",
        "warp-lang>=1.19",  # compiles the laws of the hazards for CPUs and GPUs: hazard_ms/simulation/kernels/launch.py
        "opencv-python-headless>=4.10",
        "numpy>=2.0",
        "trimesh>=4.5",
        "coacd>=1.0.5",
        "scipy>=1.13",
        "h5py>=3.11",
        "jinja2>=3.1.4",
        "tqdm>=4.66",
        "imageio>=2.34",
        "imageio-ffmpeg>=0.5",
        "pillow>=10.3",
        "tyro>=0.9",
        "safetensors>=0.7",
    ],
    extras_require={
        "rl": ["stable-baselines3>=2.9", "sb3-contrib>=2.9"],  # policies over skills, with action masks
        "llm": ["openai>=3.54"],  # language models behind an OpenAI-compatible server
        "perception": ["pycocotools>=2.0.11"],  # COCO labels and average precision
        "rfdetr": ["rfdetr>=1.11,<2"],  # RF-DETR-Seg as a detector, with weights of the user's
        "demos": ["pyarrow>=25", "av>=15", "minari>=0.5.3"],  # demonstrations as LeRobot and Minari data sets
        "cluster": ["ray>=2.60"],  # episodes on many machines: hazard-ms evaluate --backend ray
        "teams": ["pettingzoo>=1.25"],  # several robots as its ParallelEnv
        "web": ["starlette>=1.0", "uvicorn>=0.50", "websockets>=16"],  # the page of hazard-ms serve
        "pictures": ["pyoidn>=2.5", "cffi>=1.0"],  # takes the grain out of ray-traced pictures
        "docs": ["sphinx>=8.1", "myst-parser>=4.0", "furo>=2025.12"],
        "test": [
            "pytest>=8",
            "pytest-timeout>=2.3",
            "pytest-xdist>=3.6",
            "hypothesis>=6.100",
            "selenium>=4.40",  # drives a browser, where there is one
            "ruff>=0.8",
            "mypy>=1.13",
        ],
    },
)
