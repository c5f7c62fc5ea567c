"""Replays a log of the original benchmark: its commands (TDW's) one after the other, up to the start of the episode.

Commands that place and describe things are carried out. A thing that is moved takes along what is parented to it. Those
of IGNORED change nothing that we read: pictures, precision, and the letting go by which the original settles things
(the simulator does that here). Every other command is refused, for it could mean anything.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hazard_ms.scenes.original.axes import AXES, about, from_euler, looking, times
from hazard_ms.scenes.original.reading import Record, read_commands
from hazard_ms.scenes.original.things import Log, Thing
from hazard_ms.spec import UPRIGHT
from hazard_ms.spec.foreign.files import printable

MOST_THINGS = 1000  # that one log may add
IGNORED = frozenset(
    "set_screen_size set_target_framerate set_render_quality set_render_order set_post_process set_shadow_strength "
    "set_img_pass_encoding set_physics_solver_iterations set_time_step set_sleep_threshold set_gravity_vector "
    "step_physics simulate_physics send_log_messages set_object_collision_detection_mode set_color set_visual_material "
    "set_semantic_material_to do_nothing set_error_handling terminate".split()
)


def replay(path: Path) -> Log:
    """Everything that stands in the scene of a log.

    Raises ValueError that names file, line and command for anything that cannot be read.
    """
    log = Log()
    for r in read_commands(path):
        kind = r.data["$type"]
        if kind in IGNORED:
            continue
        if kind not in COMMANDS:
            raise ValueError(
                f"{r.place}: a command must be one of {', '.join((*COMMANDS, *sorted(IGNORED)))}, got {kind!r:.100}"
            )
        carry_out, must, may = COMMANDS[kind]
        carry_out(log, r.only(("$type", *must.split()), tuple(may.split())))
    if not log.room:
        raise ValueError(
            f"{printable(str(path))}, line 1: a log of the original benchmark must have a command add_scene, got none"
        )
    return log


def _add_scene(log: Log, r: Record) -> None:
    if log.room:
        raise ValueError(f"{r.place}: a log must have one scene, got a second one")
    log.room = r.text("name")


def _add_object(log: Log, r: Record) -> None:
    if r.id() in log.things:
        raise ValueError(f"{r.place}: ids must differ, got {r.id()} twice")
    if len(log.things) >= MOST_THINGS:
        raise ValueError(f"{r.place}: a log must have at most {MOST_THINGS} objects, got more")
    rotation = from_euler(r.vector("rotation")) if "rotation" in r.data else UPRIGHT
    scale = _positive(r, "scale_factor", 1.0)
    log.things[r.id()] = Thing(
        r.id(), r.text("name"), r.text("category"), r.place, r.vector("position"), rotation, scale
    )


def _positive(r: Record, key: str, default: float | None = None) -> float:
    if r.number(key, default) <= 0.0:
        r.refuse(key, "a number above 0")
    return r.number(key, default)


def _destroy(log: Log, r: Record) -> None:
    gone = log.thing(r)
    log.attach(gone, None)
    for child in log.children.pop(gone.id, ()):
        log.things[child].parent = None
    del log.things[gone.id]


def _scale(log: Log, r: Record) -> None:
    thing, factor = log.thing(r), r.vector("scale_factor")
    if min(factor) <= 0.0:
        r.refuse("scale_factor", "numbers above 0")
    thing.scale = thing.scale[0] * factor[0], thing.scale[1] * factor[1], thing.scale[2] * factor[2]


def _euler(log: Log, r: Record) -> None:
    log.carry(r, log.thing(r).position, from_euler(r.vector("euler_angles")))


def _rotate_to(log: Log, r: Record) -> None:
    q = r.inner("rotation").only(tuple("wxyz"))
    w, x, y, z = (q.number(key) for key in "wxyz")
    length = (w * w + x * x + y * y + z * z) ** 0.5
    if abs(length - 1.0) > 1e-3:
        r.refuse("rotation", "a unit quaternion")
    log.carry(r, log.thing(r).position, (w / length, x / length, y / length, z / length))


def _rotate_by(log: Log, r: Record) -> None:
    thing = log.thing(r)
    if r.text("axis") not in AXES:
        r.refuse("axis", ", ".join(AXES))
    if r.flag("use_centroid", False):
        r.refuse("use_centroid", "false: the pivot")
    by = about(AXES[r.text("axis")], r.number("angle"))
    log.carry(r, thing.position, times(by, thing.rotation) if r.flag("is_world", True) else times(thing.rotation, by))


def _look(log: Log, r: Record) -> None:
    thing = log.thing(r)
    log.carry(r, thing.position, looking(thing.position, r.vector("position")))


def _teleport(log: Log, r: Record) -> None:
    if not r.flag("absolute", True) or r.flag("physics", False):
        raise ValueError(f"{r.place}: absolute must be true and physics false, got other values")
    log.carry(r, r.vector("position"), log.thing(r).rotation)


def _kinematic(log: Log, r: Record) -> None:
    log.thing(r).kinematic = r.flag("is_kinematic", False)


def _mass(log: Log, r: Record) -> None:
    log.thing(r).mass = _positive(r, "mass")


def _material(log: Log, r: Record) -> None:
    if min(r.number("dynamic_friction"), r.number("static_friction")) < 0.0:
        r.refuse("dynamic_friction", "numbers from 0, for static_friction, too")
    # one number for both here
    log.thing(r).friction = round((r.number("dynamic_friction") + r.number("static_friction")) / 2, 6)


def _parent(log: Log, r: Record) -> None:
    thing, above = log.thing(r), log.thing(r, "parent_id")
    log.attach(thing, above.id)
    while above.parent is not None and above.id != thing.id:
        log.step(r.place)
        above = log.things[above.parent]
    if above.id == thing.id:
        raise ValueError(
            f"{r.place}: the parent of an object must not be attached to it, got {above.id} for {thing.id}"
        )


def _unparent(log: Log, r: Record) -> None:
    log.attach(log.thing(r), None)


def _container(log: Log, r: Record) -> None:
    """A region on or in a thing; what counts here is the height of its floor."""
    if r.text("tag") not in ("on", "inside", "enclosed"):
        r.refuse("tag", "on, inside, enclosed")
    kind = r.data["$type"]
    half = (
        r.vector("half_extents")[1]
        if "box" in kind
        else r.number("radius")
        if "sphere" in kind
        else r.number("height") / 2
    )
    log.thing(r).floors.append(r.vector("position")[1] - half)


# name: what to do, keys that it must and may have
COMMANDS: dict[str, tuple[Callable[[Log, Record], None], str, str]] = {
    "add_scene": (_add_scene, "name", "url"),
    "add_object": (_add_object, "id name category position", "url rotation scale_factor affordance_points library"),
    "destroy_object": (_destroy, "id", ""),
    "scale_object": (_scale, "id scale_factor", ""),
    "rotate_object_to_euler_angles": (_euler, "id euler_angles", "physics use_centroid"),
    "rotate_object_to": (_rotate_to, "id rotation", "physics use_centroid"),
    "rotate_object_by": (_rotate_by, "id angle axis", "is_world use_centroid"),
    "object_look_at_position": (_look, "id position", ""),
    "teleport_object": (_teleport, "id position", "physics absolute use_centroid"),
    "set_kinematic_state": (_kinematic, "id", "is_kinematic use_gravity"),
    "set_mass": (_mass, "id mass", ""),
    "set_physic_material": (_material, "id dynamic_friction static_friction", "bounciness"),
    "parent_object_to_object": (_parent, "id parent_id", ""),
    "unparent_object": (_unparent, "id", ""),
    "add_box_container": (_container, "id container_id position tag half_extents", "rotation"),
    "add_cylinder_container": (_container, "id container_id position tag radius height", "rotation"),
    "add_sphere_container": (_container, "id container_id position tag radius", "rotation"),
}
