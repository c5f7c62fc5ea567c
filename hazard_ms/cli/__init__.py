"""The command `hazard-ms`: one module for each group of sub-commands; each imports what it needs when it is called."""
