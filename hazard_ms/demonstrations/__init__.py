"""Demonstrations: played episodes, frame by frame, in folders that nothing can leave half written."""
