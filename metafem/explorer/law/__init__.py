"""The plot of the law: handles to drag, the target and the achieved law."""
