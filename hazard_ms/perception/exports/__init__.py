"""Datasets in the layouts that other people's trainers read."""
