"""The paper's own agents, with the constants and the narrow view of its code, so that its order can be checked."""
