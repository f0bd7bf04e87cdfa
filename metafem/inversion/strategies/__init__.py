"""From each kind of target to heights for independent asperities."""
