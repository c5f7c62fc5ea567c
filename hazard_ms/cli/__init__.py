"""The command `hazard-ms`: one module for each group of sub-commands; each imports what it needs when it is called.

`web` is the page of `hazard-ms serve`, `costs` what `hazard-ms bench` measures.
"""
