"""The tables of a scenario file, each with its keys."""

from ...interface.units import BASES
from .axis_tables import LOAD, SERVO
from .drive_table import DRIVE
from .encoder_table import ENCODER
from .expect_tables import AT_TIME, VALUE, WHEN, WITHIN
from .keys import Key, TableKeys, number, text, whole
from .reaction_tables import ON
from .remote_table import ACCURACY, REMOTE
from .trace_file import RECORDED

TOP = TableKeys(
    "The file",
    "Keys before the first table.",
    (
        text("title", "what the scenario shows"),
        text("source", "where it comes from: document, section", default="", absent="none"),
        text("fmu", "the block", value="name of a block"),
        text("unit", "of positions, for the report", default="mm", value=", ".join(BASES)),
        text(
            "slave_unit",
            "of the slave's positions",
            default="",
            absent="deg for a tool that turns, else as unit",
            value=", ".join(BASES),
        ),
        number("stop_time", "how long the run is", "s", above=0.0),
        number(
            "step_size",
            "between communication points, and the scan of the reactions",
            "s",
            above=0.0,
            note="up to stop_time",
        ),
        text(
            "step_bound", "reason why the scenario is valid at this step size only", default="", absent="valid at any"
        ),
        number(
            "tolerance",
            "of the reference, relative to each variable's greatest magnitude, at least 1",
            default=1e-9,
            above=0.0,
        ),
    ),
)
INTERFACE = TableKeys(
    "[interface]",
    "Variables whose causality is overridden: names or shell patterns, or a list of these.",
    tuple(
        Key(causality, f"variables that become this: {what}", "text or list of texts", "none")
        for causality, what in (
            ("input", "tunable parameters"),
            ("output", "local variables"),
            ("parameter", "inputs, but no command and no signal of the axis"),
            ("local", "outputs, but not slave.position"),
        )
    ),
)
START = TableKeys(
    "[start]",
    "Parameters and inputs before the first step.",
    (Key("NAME", "of this variable", VALUE, "the block's start value"),),
)
SET = TableKeys(
    "[[set]]",
    "Inputs and tunable parameters that are set at a time.",
    (Key("at", "the time", "number in s, > 0, below stop_time"), Key("NAME", "of this variable", VALUE)),
)
SCRIPT = TableKeys(
    "[master]",
    "The script of the master; that of [remote] has these keys, too.",
    (
        number("position", "at the start", "u", default=0.0),
        number("velocity", "at the start", "u/s", default=0.0),
        number("acceleration", "at the start", "u/s2", default=0.0),
        Key("segments", "how it moves on; after the last one the velocity stays", "list of segments", "none"),
    ),
)
CONSTANT = ("velocity", "acceleration", "jerk")  # of these a segment has at most one, which is constant in it
SEGMENT = TableKeys(
    "segments",
    "One segment, { duration, ... }: it has at most one of velocity, acceleration and jerk, which is constant in it. "
    "Without one the velocity stays as it is.",
    (
        number("duration", "how long it is", "s", above=0.0),
        *(
            number(key, "constant in the segment", unit, absent="not constant")
            for key, unit in zip(CONSTANT, ("u/s", "u/s2", "u/s3"), strict=True)
        ),
    ),
)
MOVEMENT = number(
    "movement", "how far the tool may move against the material while it cuts", "u", absent="tolerance", least=0.0
)
CUTS = TableKeys(
    "[cuts], marks",
    "The slave is a saw, and the master its material, which has marks.",
    (
        text("while", "the saw cuts while it is true", value="name of a Boolean output"),
        number("length", "distance of the marks on the material", "u", above=0.0),
        number("offset", "where one of the marks is", "u", default=0.0),
        number("ratio", "the saw's travel over the material's, not 0; of a diagonal saw 1/cos(angle)", default=1.0),
        number(
            "tolerance",
            "how far a cut may be from its mark",
            "u",
            absent="0.1 mm, or a ten-thousandth of length",
            least=0.0,
        ),
        MOVEMENT,
        whole("count", "how many cuts there must be", absent="any"),
        whole("skipped", "how many marks must pass uncut after the first cut", default=0),
    ),
)
PIECES = TableKeys(
    "[cuts], pieces",
    "What pieces there have to be, of a block that records its pieces.",
    (
        number(
            "tolerance", "how far a length may be off", "u", absent="0.1 mm; in deg, rad and 1 there is none", least=0.0
        ),
        MOVEMENT,
        whole("count", "how many pieces there must be", absent="any"),
        whole("skipped", "how many cuts must be skipped", default=0),
        whole("late", "how many cuts must be late", default=0),
        whole("orders_left", "how many orders must be left at the end", absent="any, with a note"),
        Key("lengths", "of all pieces", "list of numbers in u", "each product is as long as ordered"),
        Key("kinds", "of all pieces, as in last.kind", "list of names", "any"),
    ),
)
PICTURE = TableKeys(
    "[picture]",
    "How the run is drawn where it is the example of a block.",
    (
        text(
            "shaded",
            "the picture is shaded while it is true",
            default="",
            absent="nothing is shaded",
            value="name of a Boolean output",
        ),
        Key("curves", "further outputs, each with the label of its plot", "table", "none"),
        Key("variants", "further start values; the picture has a line for each of them", "table of tables", "none"),
    ),
)

ALL_TABLES = (
    *(TOP, INTERFACE, START, SCRIPT, SEGMENT, DRIVE, RECORDED, REMOTE, ACCURACY, ENCODER, SERVO, LOAD),
    *(SET, ON, AT_TIME, WHEN, WITHIN, CUTS, PIECES, PICTURE),
)
