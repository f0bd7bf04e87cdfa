"""The README's table of numbers that the paper prints, beside those that metafem computes."""

from __future__ import annotations

from collections.abc import Callable

from validation.published import paper
from validation.results import Evaluated
from validation.verdicts import Evidence

MARKS = ("<!-- printed numbers: python -m validation --readme -->", "<!-- end of the printed numbers -->")

# Claims that the table reads.
CLAIMS = (
    "fig3_operating_points", "fig4_linear", "bounds", "table_s1", "table_s2", "fig_s3_manufacturing",
    "interaction_error",
)  # fmt: skip


def printed_table(results: dict[str, Evaluated]) -> str:
    """Return quantity, printed number and computed number, one line each, in Markdown."""
    evidence = Evidence(results)
    lines = ["| quantity | the paper | metafem |", "|---|---|---|"]
    lines += [f"| {words} | {shown} | {computed(evidence)} |" for words, shown, computed in _rows()]
    return "\n".join(lines)


def _rows() -> list[tuple[str, str, Callable[[Evidence], str]]]:
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
            "Fig. 4: measured slopes, blue and red, and those of the designed heights",
            " and ".join(f"{slope} ± {error}" for slope, error in slopes),
            _of_both("fig4_linear", "{}: fitted slope and measured slope", "{:.2f} and {:.2f}"),
        ),
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
            "the same, Fig. 3, median of 1,000 assignments of the heights to sites; by other norms 1 to 4 %",
            limit,
            _values("interaction_error", ("Fig. 3: median rms of random assignments",), "{:.2%}"),
        ),
    ]


def _of_both(claim: str, name: str, form: str) -> Callable[[Evidence], str]:
    return _values(claim, (name.format("blue"), name.format("red")), form)


def _values(claim: str, names: tuple[str, ...], form: str) -> Callable[[Evidence], str]:
    def words(evidence: Evidence) -> str:
        return form.format(*(evidence.value(claim, name) for name in names)).replace("%", " %")

    return words
