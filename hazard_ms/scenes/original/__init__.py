"""The original benchmark's scenes, read from its folders and turned into ours."""
