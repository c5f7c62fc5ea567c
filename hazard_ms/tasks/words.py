"""The sentence of each task in other words, for evaluations of policies that may know it by heart.

A reworded task has three tuples of sentences, one for each level of `words` in a perturbation: other words; another
form of sentence; a longer sentence with a clause that says nothing about the task. All sentences are [ours].
"""

from __future__ import annotations

RESCUES = (
    (
        "Get every target into {place} before the {hazards} can harm it or sweep it off.",
        "Bring each target into {place} before the {hazards} can spoil it or take it along.",
        "Stow all targets in {place} before the {hazards} can ruin them or bear them away.",
        "Move each of the targets into {place} before the {hazards} can hurt it or drag it off.",
    ),
    (
        "Before the {hazards} can damage a target or carry it away, put it into {place}.",
        "Can you put every target into {place} before the {hazards} can damage it or carry it away?",
        "Every target has to be put into {place}, or else the {hazards} can damage it or carry it away.",
        "No target may stay where the {hazards} can damage it or carry it away: it must be put into {place}.",
    ),
    (
        "There are many other things here, some of them larger and some of them closer to you, which you may leave "
        "where they are, but put every target into {place} before the {hazards} can damage it or carry it away.",
        "Nobody has tidied up since yesterday, and somebody will do that later, so do not mind it: put every target "
        "into {place} before the {hazards} can damage it or carry it away.",
        "I was on the phone with my sister when I heard of this, and she lives far from here, so please put every "
        "target into {place} before the {hazards} can damage it or carry it away.",
    ),
)
GALE = (
    (
        "Get every target into a shopping cart, or behind a shelter, before wind that shifts can sweep it off.",
        "Bring each target into a shopping trolley, or in the lee, before turning wind can take it along.",
        "Stow all targets in a shopping cart, or out of the wind, before it shifts and can blow them off.",
    ),
    (
        "Before wind that turns can carry a target away, put it into a shopping cart, or in the lee.",
        "Can you put every target into a shopping cart, or in the lee, before wind that turns can carry it away?",
        "Every target has to be put into a shopping cart, or in the lee, or else wind that turns can carry it away.",
    ),
    (
        "There are cars and houses around, which have stood here for years and need no help, but put every target into "
        "a shopping cart, or in the lee, before wind that turns can carry it away.",
        "The shops close at eight today, and nobody is going to buy anything, so put every target into a shopping "
        "cart, or in the lee, before wind that turns can carry it away.",
    ),
)
PRACTICE = {  # by the task's own sentence
    "Walk to the thing and face it.": (
        ("Go to the object and turn to it.", "Move up to the thing and look at it.", "Approach the item and face it."),
        ("Can you walk to the thing and face it?", "The thing is what you have to walk to and face."),
        (
            "There are tables here that are of no use to you; walk to the thing and face it.",
            "The floor was cleaned this morning and has dried since, so walk to the thing and face it.",
        ),
    ),
    "Take the thing before you into your hand.": (
        ("Grasp the object in front of you.", "Pick up the thing before you.", "Get hold of the item in front of you."),
        ("Can you take the thing before you into your hand?", "The thing before you has to get into your hand."),
        (
            "There are other things on other tables, which can wait; take the thing before you into your hand.",
            "The table was bought last year and is still fine, so take the thing before you into your hand.",
        ),
    ),
    "Take the thing before you, and put it into your bag.": (
        ("Grasp the object in front of you, and place it in your bag.", "Pick up the item before you, and bag it."),
        (
            "Can you take the thing before you, and put it into your bag?",
            "The thing before you has to be taken, and put into your bag.",
        ),
        (
            "There are other things on other tables, which can wait; take the thing before you, put it into your bag.",
            "The table was bought last year and is still fine, so take the thing before you, and put it into your bag.",
        ),
    ),
    "Walk to the thing, take it, and put it into your bag.": (
        ("Go to the object, grasp it, and place it in your bag.", "Move up to the item, pick it up, and bag it."),
        (
            "Can you walk to the thing, take it, and put it into your bag?",
            "The thing has to be in your bag: walk to it, and take it.",
        ),
        (
            "There are tables here that are of no use to you; walk to the thing, take it, and put it into your bag.",
            "The floor was cleaned this morning and has dried since, so walk to the thing, take it, and put it "
            "into your bag.",
        ),
    ),
    "Open the door before you.": (
        ("Get the door in front of you open.", "Pull open the door before you.", "Turn the door in front of you open."),
        ("Can you open the door before you?", "The door before you is shut, and has to be open."),
        (
            "There are tables here that are of no use to you; open the door before you.",
            "The walls were painted last year and look fine, so open the door before you.",
        ),
    ),
}


def worded(table: tuple[tuple[str, ...], ...], **names: str) -> tuple[tuple[str, ...], ...]:
    """The sentences of a table of this module, with `names` in them."""
    return tuple(tuple(sentence.format(**names) for sentence in level) for level in table)
