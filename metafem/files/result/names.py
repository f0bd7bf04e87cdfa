"""Names of the files in a result folder."""

# Names of the files of a design in its result folder, which also holds copies of its tables.
RESULT_FILES = frozenset(
    {
        *("design.json", "heights.csv", "law.csv", "mould.csv", "mould.gcode", "surface.vtu", "spec.toml"),
        *("report.html", "block.stl", "mould.stl"),
    }
)

# Names of the studies of a design; each is stored in the result folder as NAME.nc.
STUDIES = (
    *("interaction", "fidelity", "manufacturing", "misalignment", "uncertainty"),
    "measured",  # the comparison with measured laws
    "explained",  # the errors of the part that explain the difference
)

# Names in a result folder that a table must not have.
RESERVED = RESULT_FILES | {f"{name}.nc" for name in STUDIES}
