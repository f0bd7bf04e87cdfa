"""Options of all searches of an inversion, in one frozen value."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class SearchOptions:
    """Options of the searches for heights, radii, height steps and sites.

    A misfit is a relative rms difference from the target law [-].
    """

    # -- Levenberg–Marquardt descents --
    # Damping relative to the mean square of the Jacobian: first value, bounds, factor of the step size rule.
    start_damping: float = 1e-2
    least_damping: float = 1e-12
    most_damping: float = 1e4
    damping_factor: float = 5.0
    # A descent ends when a step lowers the sum of squares by less than this fraction. Along kinks the
    # progress is slow, and a random change is faster (measured: a quarter of the time needed with 1e-4).
    least_gain: float = 0.05
    # Most steps of one descent, and of one that must converge to rounding.
    most_steps: int = 20
    most_exact_steps: int = 40
    # Misfit at operating points: a hundredth of the tolerance of an exact design.
    point_goal: float = 1e-11

    # -- random restarts --
    # Misfit at which a search ends: height errors of 1 um change A0 by more than this.
    goal: float = 6e-4
    # Below this multiple of the goal, random changes reach the goal sooner than other initial guesses.
    near: float = 2.0
    # Random changes: sizes relative to the mean spacing of the heights, fractions of the heights that move,
    # probabilities that asperities are added or that one is removed, and the most that are added.
    change_sizes: tuple[float, ...] = (0.3, 1.0, 3.0)
    change_fractions: tuple[float, ...] = (0.2, 0.5, 1.0)
    adding: float = 0.5
    removing: float = 0.3
    most_added: int = 5
    # Restarts, about 10 ms each; nearly all laws of real surfaces need none or a few.
    restarts: int = 30

    # -- initial guesses for any law --
    # Smallest indentation tried, relative to that without new asperities: below it their number would
    # exceed that of any surface.
    shallowest: float = 1e-9
    # Where the target leaves its level open, levels at these fractions of the feasible range (of its
    # logarithm) are tried.
    level_fractions: tuple[float, ...] = (0.5, 0.25, 0.75, 0.1, 0.9)
    # Where an initial guess is deeper than allowed, guesses with these fractions of the asperities that are
    # too low are tried: at the foot they all enter the contact early, and fewer of them suffice.
    low_fractions: tuple[float, ...] = (1.0, 0.75, 0.5, 0.25, 0.0)

    # -- several radii --
    # Restarts with continuous radii, before the radii are rounded to tools.
    continuous_restarts: int = 4
    # Restarts with several tools for each restart with one, because the radii are unknown too (measured on
    # 40 laws of random surfaces with radii of .1, .4 and 1.6 mm: all are recovered to .1 %; with 4 restarts
    # one is not).
    mixed_restarts: int = 10
    # Probabilities, one of which is drawn for each random change, that an asperity gets a new radius.
    new_radius: tuple[float, ...] = (0.0, 0.1, 0.3)
    # A mixture of two tools for a density is chosen only if it lowers the misfit by this factor: parts made
    # with one tool are simpler.
    mixture_gain: float = 0.5
    # Fractions of the larger of two neighbouring tools that are tried.
    mixture_fractions: tuple[float, ...] = tuple(i / 16 for i in range(1, 16))
    # Radii of a range that are tried between the best one's neighbours.
    next_radii: int = 4

    # -- operating points --
    # Distance of a level below the plane at the point before, relative to the depth of the level before.
    level_drop: float = 0.0
    # Most levels that are tried, about 0.2 ms each.
    most_levels: int = 5_000
    # Where no levels meet the points: misfits at which the random search ends and a descent to rounding
    # begins. A descent can end at a kink; the next misfit gives another initial guess.
    free_goals: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, 1e-11)
    # Largest misfit of heights without levels that is accepted: far below the effect of height errors.
    accepted: float = 1e-3

    # -- load range of a line --
    # Bisections of the logarithm of the range: to a sixtieth of it.
    bisections: int = 6
    # Restarts for each range that is tried; most ranges that are too wide use all of them.
    range_restarts: int = 4
    # Fraction of the allowed difference at which a range counts as reached: room for other models.
    range_misfit: float = 0.8
    # A range that is tried starts this factor above the load at which one asperity has the friction of the
    # line. Between the entries of the first asperities a law differs from the line by 1.1 % if it starts at
    # that load, and by .7 % if it starts here (measured; independent of slope and radius by scaling).
    range_start: float = 1.4

    # -- refinement under another model --
    # Misfit at which the search ends: a little above that of the first search, because the scatter from
    # single contacts that enter remains.
    refined_goal: float = 9e-4
    # Up to this misfit the heights of the independent inversion are the only initial guess.
    close: float = 5.0 * 9e-4
    # Restarts, whose descents cost ten times those of independent asperities.
    refined_restarts: int = 3
    # Most loads of the target that are used for other contact laws than Hertz's with interaction.
    entry_loads: int = 30
    # Restarts with adhesion, and most steps of descents under a model of adhesive asperities that interact,
    # a tenth of a second to a second each.
    adhesive_restarts: int = 1
    adhesive_steps: int = 6
    # Degree of the polynomial in the logarithm of the load that fits A0(model)/A0(independent). A low degree
    # leaves out the kinks of single contacts, which move with the heights.
    ratio_degree: int = 3
    # Restarts with independent asperities for the target divided by that ratio, about 3 ms each.
    ratio_restarts: int = 10
    # Factors on the summit depths, so that no level first touches exactly at an operating point: interaction
    # lowers open summits by a hundredth to a tenth of their depth.
    stretches: tuple[float, ...] = (1.03, 1.0, 1.06, 1.1)
    # Depth of the added summits below the last level, relative to the depth of that level.
    added_depth: float = 0.01

    # -- given heights --
    # Random changes of the other heights where they miss the target, about 5 ms each; under a model with
    # interaction there are as many as `refined_restarts`.
    pinned_changes: int = 8

    # -- robust designs --
    # Fewest and most fixed errors over which the expectation is taken, each with both signs; with as many as
    # the errors have dimensions, a linear response is exact.
    fewest_errors: int = 32
    most_errors: int = 128
    # Most asperities whose heights are changed: the errors of more average out.
    most_robust: int = 128
    # Most loads of the target that are used, and rounds of exchanges between sites, each with a new search.
    robust_loads: int = 30
    robust_rounds: int = 1
    # Number of other errors on which the gain is measured, each with both signs, for up to `few_sites`
    # asperities; with more there are fewer, but at least as many as follow.
    fresh_errors: int = 1000
    fewest_fresh: int = 20

    # -- height steps --
    # Fractions of a step by which all heights are shifted before rounding, which does not change a law.
    shifts: tuple[float, ...] = (0.0, 0.25, -0.25, 0.5, -0.5)
    # Number of single changes that are combined into pairs, and of changes evaluated under the model.
    paired_steps: int = 64
    evaluated_steps: int = 24
    # Most changes, and most asperities with which changes are tried: of more, rounding errors average out.
    most_step_changes: int = 60
    most_stepped: int = 512
    # For a law that is compared by its largest difference, the sum of this power of the differences is
    # lowered: its root is within 1.8 of the largest of a hundred. It is a power of two.
    largest_power: int = 8
    # Number of loads with the largest differences at which changes of such a law are compared first, and of
    # changes that are then evaluated at all loads together, an even number for two threads.
    largest_loads: int = 10
    steps_at_once: int = 4

    # -- assignment to sites --
    # Number of sites up to which the numbers of rounds below hold; with more sites there are fewer.
    few_sites: int = 128
    # Rounds of exchanges, from the given arrangement and then from random exchanges of the best one, as many
    # as this fraction of the sites. The forecast of the model and that of independent asperities alternate:
    # one is better for few levels, the other for many heights.
    most_rounds: int = 8
    exchanged_fraction: float = 0.1
    # Most exchanges by one forecast before the model is evaluated; with many sites a quarter of their number.
    most_exchanges: int = 16
    # Most evaluations of the model in one round.
    most_evaluations: int = 24
    # Misfit at which the search ends: height errors change A0 by tens of times more.
    arranged_goal: float = 1e-4
    # Number of exchanges, the best by the forecast, that are evaluated under the model in each last step, and
    # the most last steps.
    evaluated_exchanges: int = 40
    last_steps: int = 16
    # Number of sites whose exchanges are all forecast in one step; of more sites as many are drawn.
    forecast_sites: int = 96
    # A decrease below this fraction of the sum of squares is rounding.
    exchange_gain: float = 1e-9
    # Exchanges end where the predicted misfit is far below the error of the forecast.
    forecast_goal: float = 1e-6


DEFAULTS = SearchOptions()

# For contact laws other than Hertz's: the area of a cap flatter than a paraboloid begins with an infinite
# slope over the indentation, and with adhesion it jumps, so that entries of contacts are sharper kinks. The
# gradient does not describe the law beyond. First steps and random changes are smaller, descents longer, and
# no level of operating points touches at the point before (measured on laws of random surfaces with power
# caps of n = 3, 4, 8: the median misfit falls from .05, .07 and .5 % to .05, .05 and .4 %, in a quarter of
# the time).
OTHER_LAWS = replace(
    DEFAULTS, start_damping=1.0, least_gain=0.01, most_steps=40, change_sizes=(0.1, 0.3, 1.0), level_drop=0.05
)


def drafted(options: SearchOptions) -> SearchOptions:
    """Return the options of a quick search, for a view that follows a hand.

    It leaves out most random changes, and changes rounded heights once. On the specifications of
    `validation/benchmark/explorer.py` a design takes a half to a tenth of the time, and its misfit is at most
    1.7 times as large.
    """
    return replace(
        options, restarts=2, free_goals=(1e-2,), refined_restarts=0, ratio_restarts=2, range_restarts=0,
        pinned_changes=1, most_step_changes=1, evaluated_steps=6,
    )  # fmt: skip
