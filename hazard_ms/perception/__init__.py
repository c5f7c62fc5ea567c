"""Labelled pictures of hazards for computer vision: captured, described as COCO data, checked, shown and scored."""
