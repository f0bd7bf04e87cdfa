"""The law: points to drag, the target and the achieved law."""
