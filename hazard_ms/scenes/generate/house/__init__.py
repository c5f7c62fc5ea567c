"""Homes of four to seven rooms and a hall: their rooms as data, their plans, and whole scenes."""
