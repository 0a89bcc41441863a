"""What the columns of results and of stored runs mean: one sentence, a unit and an equation for each name.

A column has one meaning wherever it appears: in a result of a Python call, in the Parquet files of a run and
in what `nearflat columns` prints. Units are those of the disk; with m = r = g = 1 they are natural ones.
"""

from dataclasses import dataclass

from explorer.errors import one_of

ANGLE, RATE, TIME, LENGTH, ENERGY, NUMBER = "rad", "rad/time", "time", "length", "energy", ""
SI = {RATE: "rad/s", TIME: "s", LENGTH: "m", ENERGY: "J"}  # of a disk in kilograms, metres and seconds


@dataclass(frozen=True)
class Column:
    """A named quantity; its first three texts stand in the metadata of a Parquet column.

    Parameters
    ----------
    meaning : str
        One sentence.
    unit : str
        'rad', 'rad/time', 'time', 'length', 'energy' in the units of the disk; empty for a pure number.
    equation : str
        Where Cushman & Duistermaat (2006) define it; empty where the paper does not.
    kind : str
        Type of its numbers in stored runs, as NumPy calls it; "status" for words.
    """

    meaning: str
    unit: str = NUMBER
    equation: str = ""
    kind: str = "float64"

    @property
    def texts(self) -> dict[str, str]:
        """What the metadata of a Parquet column say."""
        return {"meaning": self.meaning, "unit": self.unit, "equation": self.equation}


SIGN, COUNT, STEPS, TRUTH = "int8", "int64", "int32", "bool"


COLUMNS = {
    # where a state is
    "phi": Column("Angle of the disk's plane to the vertical; flat at +-pi/2.", ANGLE, "section 2.3"),
    "phidot": Column("Rate of phi.", RATE, "section 2.3"),
    "sigma3": Column("cos^2(phi) times the rate at which the contact point turns in space.", RATE, "(2.14)"),
    "sigma4": Column("Spin: angular velocity about the axis of the disk.", RATE, "(2.14)"),
    "theta": Column("Angle from the flat state of `face`; pi/2 is upright.", ANGLE, "section 6"),
    "thetadot": Column("Rate of theta.", RATE, "section 6"),
    "tilt": Column("Angle of the disk's plane to the table: 0 is flat, pi/2 upright.", ANGLE),
    "tilt_rate": Column("Rate of the tilt, positive where the disk rises.", RATE),
    "precession": Column("Rate at which the contact point turns about the vertical.", RATE, "(2.14)"),
    "spin": Column("Angular velocity about the disk's own axis, sigma4.", RATE, "(2.14)"),
    "sigma3_bar": Column("Constant of motion: what sigma3 is, or would be, at the vertical.", RATE, "(3.5)"),
    "sigma4_bar": Column("Constant of motion: what sigma4 is, or would be, at the vertical.", RATE, "(3.5)"),
    "eta_hat": Column(
        "Signed distance along sigma4_bar to l_+ or l_-, the line of that face which the column `face` gives.",
        RATE,
        "(6.2)",
    ),
    "eta_hat_plus": Column("Signed distance to the line l_+, on which the disk falls on face +1.", RATE, "(6.2)"),
    "eta_hat_minus": Column("Signed distance to the line l_-, on which the disk falls on face -1.", RATE, "(6.2)"),
    "eta_plus": Column("eta_hat_plus times I3 r(0).", "mass length^2 rad/time", "(6.2)"),
    "eta_minus": Column("eta_hat_minus times I3 r(0).", "mass length^2 rad/time", "(6.2)"),
    "energy": Column("Total energy.", ENERGY, "(2.19)"),
    "face": Column(
        "Which face comes down: +1 for flat at phi = +pi/2, -1 for flat at phi = -pi/2.",
        kind=SIGN,
    ),
    "side": Column("Sign of eta on `face`: the side of the falling set on which the motion is.", kind=SIGN),
    "distance": Column(
        "Of a state: signed distance of its (sigma3_bar, sigma4_bar) to the nearer of l_+ and l_-. In the scene "
        "one-sided: the largest of the distances to the limit motion, in natural units.",
        RATE,
        "(6.2)",
    ),
    "distance_plus": Column("Signed distance of (sigma3_bar, sigma4_bar) to the line l_+.", RATE, "(6.2)"),
    "distance_minus": Column("Signed distance of (sigma3_bar, sigma4_bar) to the line l_-.", RATE, "(6.2)"),
    "could_fall": Column("Whether the disk would fall if eta were exactly 0.", NUMBER, "section 6.2", kind=TRUTH),
    "could_fall_plus": Column("Whether the disk would fall on face +1 if eta_plus were exactly 0.", kind=TRUTH),
    "could_fall_minus": Column("Whether the disk would fall on face -1 if eta_minus were exactly 0.", kind=TRUTH),
    "on_f": Column("Whether the state lies on the falling set, apart from rounding errors.", kind=TRUTH),
    # a passage near flat
    "race_angle": Column("delta_chi minus fall_angle; its limit is side times kappa pi.", ANGLE, "(7.9)"),
    "fall_angle": Column(
        "Turn of chi without the race: along the limit motion with this sigma3_bar and energy.",
        ANGLE,
        "section 7.1",
    ),
    "delta_chi": Column("Turn of the contact point in space.", ANGLE, "(2.31)"),
    "delta_psi": Column("Turn of the contact point along the rim.", ANGLE, "(2.22)"),
    "theta_min": Column("Smallest tilt: angle between the plane of the disk and the table.", ANGLE, "Lemma 5"),
    "theta_min_estimate": Column("theta_min to leading order, for states that could fall.", ANGLE, "Lemma 5"),
    "duration": Column("Duration of the passage or bounce, or of the part asked for.", TIME, "(3.12)"),
    "fall_time": Column("Time until the disk is flat, if it falls.", TIME, "(3.12)"),
    "time": Column("Time since the given state.", TIME),
    "impact_speed": Column("Rate of phi at which the limit motion meets the table.", RATE, "(7.1)"),
    "limit": Column("The limit of race_angle: side times kappa pi.", ANGLE, "(7.9)"),
    "wrong_way": Column(
        "Whether the contact point moves against the sign of eta at the flattest moment.", kind=TRUTH
    ),
    "error_estimate": Column(
        "The larger of two estimates: error of angles (rad), relative error of times and theta_min.",
    ),
    "status": Column("Outcome of the sample; `nearflat columns` lists the codes.", kind="status"),
    "steps": Column("Steps of the integration; 0 if there was none.", kind=STEPS),
    # a whole period
    "period": Column("Time from one turning point of the tilt back to it.", TIME, "(3.12)"),
    "chi": Column("Angle of the contact point in space, or its increase per period.", ANGLE, "(2.30)"),
    "psi": Column("Angle of the contact point in the body, or its increase per period.", ANGLE, "(2.21)"),
    "crosses": Column("Whether the motion passes the vertical.", kind=TRUTH),
    "min_normal_force": Column(
        "Smallest normal force, divided by m g; if it is negative, a real disk would lift off."
    ),
    "max_friction": Column("Largest friction coefficient that the motion needs."),
    # a motion at times
    "t": Column("Time since the start.", TIME),
    "path": Column("Centre of mass; it starts above the origin.", LENGTH, "(2.33)"),
    "contact": Column("Point of contact.", LENGTH, "(2.35)"),
    "radius": Column("Of the circle of the contact point, or of the centre after whole periods.", LENGTH),
    "shift": Column("Shift of the centre over the table in a period, if chi = 0 at its start.", LENGTH, "(2.33)"),
    "excess": Column("Energy of a motion that rocks near flat; 1 at the bottom of the well."),
    # how likely it is
    "value": Column("The constant C of P(theta_min < delta) = C delta, for a tilt delta in rad."),
    "error": Column("Estimate of the absolute error of value."),
    "plus": Column("Contribution of face +1 to value."),
    "minus": Column("Contribution of face -1 to value."),
    "mass": Column("Integral of the density over the box, natural units."),
    "matrix": Column("Derivative of the final (phi, phidot, sigma3, sigma4) by the initial ones, natural units."),
    "determinant": Column("Determinant of the derivative of the flow; 1 for an invariant measure."),
    "rounding": Column("Order of magnitude of the rounding error of the determinant."),
    # scenes
    "delta": Column(
        "Of a draw near F: the draw is used to estimate P(theta_min < delta) for this delta. NaN for plain "
        "draws, from the whole box.",
        ANGLE,
    ),
    "weight": Column("Weight of the draw relative to a plain draw: density times the volume it represents."),
    "base": Column("Index of the state on F near which the motion starts.", kind=COUNT),
    "distance_phi": Column("Largest difference of phi from the limit motion of the same side.", ANGLE),
    "distance_chi": Column("Largest difference of chi from the limit motion of the same side.", ANGLE),
    "distance_psi": Column("Largest difference of psi from the limit motion of the same side.", ANGLE),
    "distance_path": Column("Largest distance of the centre from that of the limit motion.", LENGTH),
    "distance_contact": Column("Largest distance of the contact point from that of the limit motion.", LENGTH),
    "chi_between": Column("chi half-way between the first two impacts.", ANGLE),
    "row": Column("Row of the given states, counted from 0.", kind=COUNT),
    "bounce": Column("Number of the approach to flat since the given state, counted from 0.", kind=COUNT),
}


def column(name: str) -> Column:
    """The column of a name; InputError with the nearest one where there is none."""
    return COLUMNS[one_of("column", name, COLUMNS)]
