"""The README's table of numbers that the paper prints, beside those that metafem computes."""

from __future__ import annotations

from collections.abc import Callable

from validation.published import paper
from validation.results import Evaluated
from validation.verdicts import NORMS, Evidence

MARKS = ("<!-- printed numbers: python -m validation --readme -->", "<!-- end of the printed numbers -->")

# Claims that the table reads.
CLAIMS = (
    "fig3_operating_points", "fig4_linear", "fig5_bilinear", "bounds", "table_s1", "table_s2",
    "fig_s3_manufacturing", "interaction_error", "segmented_regression",
)  # fmt: skip


# Quantity, printed number, and what reads the computed one.
Line = tuple[str, str, Callable[[Evidence], str]]

# End of the names of the deviations of slopes.
SLOPE = ", deviation from the target [%]"


def printed_table(results: dict[str, Evaluated]) -> str:
    """Return quantity, printed number and computed number, one line each, in Markdown."""
    evidence = Evidence(results)
    lines = ["| quantity | the paper | metafem |", "|---|---|---|"]
    lines += [f"| {words} | {shown} | {computed(evidence)} |" for words, shown, computed in _rows()]
    return "\n".join(lines)


def _rows() -> list[Line]:
    """Return quantities, printed numbers and what reads the computed ones."""
    printed = paper()
    slopes = (printed["fig4"][colour]["measured_slope"] for colour in ("blue", "red"))
    bounds = printed["bounds"]
    scatter = printed["manufacturing"]["slope_sd_below_at_0p9um"]
    limit = f"below {printed['interaction']['rms_area_difference_below']:.1%}".replace("%", " %")
    return [
        (
            "Fig. 3: asperities on the three levels",
            ", ".join(map(str, printed["fig3"]["counts"])),
            _values("fig3_operating_points", ("n_1", "n_2", "n_3"), "{:.0f}, {:.0f}, {:.0f}"),
        ),
        (
            "Fig. 3: heights h_2 and h_3, from points that are printed with three digits",
            "{} and {} µm".format(*printed["fig3"]["levels_um"][1:]),
            _values("fig3_operating_points", ("h_2 [µm]", "h_3 [µm]"), "{:.1f} and {:.1f} µm"),
        ),
        (
            "Fig. 3: heights of the three adjustment asperities, from the same points",
            "{}, {} and {} µm".format(*printed["fig3"]["adjustment_um"]),
            _values(
                "fig3_operating_points",
                tuple(f"h_{i},a [µm]" for i in (1, 2, 3)),
                "{:.1f}, {:.1f} and {:.1f} µm",
            ),
        ),
        (
            "Fig. 4: measured slopes, blue and red, and those of the designed heights",
            " and ".join(f"{slope} ± {error}" for slope, error in slopes),
            _of_both("fig4_linear", "{}: fitted slope and measured slope", "{:.2f} and {:.2f}"),
        ),
        *(_slopes(colour) for colour in ("red", "blue")),
        *(_crossover(colour) for colour in ("red", "blue")),
        (
            "smallest and largest friction coefficient",
            f"{bounds['smallest_friction_coefficient']:.2f} and {bounds['largest_friction_coefficient']:.2f}",
            _values(
                "bounds",
                ("smallest friction coefficient", "largest friction coefficient"),
                "{:.2f} and {:.2f}",
            ),
        ),
        (
            "Table S1: levels with another number of asperities, of 20 each, blue and red",
            "0",
            _of_both("table_s1", "{}: levels with another number of asperities", "{:.0f} and {:.0f}"),
        ),
        (
            "Table S2: largest difference of 64 heights, blue and red",
            "0",
            _of_both("table_s2", "{}: largest difference of 64 heights [µm]", "{:.2f} and {:.2f} µm"),
        ),
        (
            "Table S2: heights that differ by more than the digits explain, of 64 each, blue and red",
            "0",
            _of_both(
                "table_s2",
                "{}: heights of Table S2 that differ by more than the digits explain",
                "{:.0f} and {:.0f}",
            ),
        ),
        (
            "Fig. S3: scatter of the slope by errors of the heights of 0.9 µm, blue and red",
            f"below {100.0 * scatter:.1f} %",
            _of_both("fig_s3_manufacturing", "{}: scatter of the slope at 0.9 µm", "{:.2%} and {:.2%}"),
        ),
        (
            "change of A0 by elastic interaction, Fig. 5, blue and red, relative rms",
            limit,
            _of_both("interaction_error", "Fig. 5 {}, printed sites: rms", "{:.2%} and {:.2%}"),
        ),
        (
            "the same, Fig. 3, median of 1,000 assignments of the heights to sites, by norm: "
            + ", ".join(words for words, _ in NORMS),
            limit,
            _values(
                "interaction_error",
                tuple(f"Fig. 3: median {row} of random assignments" for _, row in NORMS),
                ", ".join(["{:.2%}"] * len(NORMS)),
            ),
        ),
    ]


def _slopes(colour: str) -> Line:
    """Return the line of the two slopes of a bilinear law."""
    numbers, name = paper()["fig5"], f"{colour}: fitted slope {{}}"
    names = [name.format(f"{i}{rest}") for rest in (" of 64 asperities", SLOPE) for i in (1, 2)]
    return (
        f"Fig. 5 {colour}: slopes, targets of the measured ones (the paper) and of the designed heights",
        "{} and {} within {:.1%}".format(*numbers["slopes"], numbers["measured_within"]).replace("%", " %"),
        _values("fig5_bilinear", tuple(names), "{:.2f} and {:.2f} ({:+.1f} and {:+.1f}%)"),
    )


def _crossover(colour: str) -> Line:
    """Return the line of a crossover load."""
    load, error = paper()["fig5"][colour]["measured_crossover_mm2"]
    lines = f"{colour}: crossover load of the predicted law [mm²]"

    def computed(evidence: Evidence) -> str:
        ruled = evidence.value("segmented_regression", f"{colour}: crossover by the paper's rule [mm²]")
        return (
            f"{evidence.value('fig5_bilinear', lines):.4f} mm² by lines, {ruled:.3f} mm² by the paper's rule"
        )

    return (
        f"Fig. 5 {colour}: crossover load, measured (the paper) and of the designed heights (metafem)",
        f"{load} ± {error} mm²",
        computed,
    )


def _of_both(claim: str, name: str, form: str) -> Callable[[Evidence], str]:
    return _values(claim, (name.format("blue"), name.format("red")), form)


def _values(claim: str, names: tuple[str, ...], form: str) -> Callable[[Evidence], str]:
    def words(evidence: Evidence) -> str:
        return (
            form.format(*(evidence.value(claim, name) for name in names)).replace("%", " %").replace("-", "−")
        )

    return words
