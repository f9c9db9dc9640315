"""The sections on which the knife is: at rest, on curves and in windows, over the position of the master.

A section holds from the master's position `begin` on, up to where the next one begins; further back the one before it
holds. So the knife is where the sections have it, however far the line runs back. The sections of the last few cuts are
retained: should the line run back further, the knife comes to rest before the oldest of these cuts, as if it had
started there.

Positions of the knife count from where the blade of the next cut cuts; in a window, from where the blade in it cuts.
"""

from dataclasses import dataclass

from .. import var
from ..cutting.piece import UNLIMITED
from ..var import Enumeration
from .curves import FAR_BACK, Section, Way
from .knife import Knife
from .window import TWO_PI, Cut

CAPACITY = 8
ROW = 13  # numbers per section
OLDEST_WINDOW = 2  # where the oldest section is a window, it gets this index: a rest and the ramp up come before it

# What is where in the row of a section.
BEGIN = 0
KIND = 1
BLADE = 2
ORIGIN = 3  # where a quintic begins, or the cut of a window, as positions of the master; where the knife rests
END = 4  # of a quintic
SCALE = 5  # the length of a quintic; the slope of a window
RATE = 6
COEFFICIENTS = 7

# The kinds of sections.
AT_REST = 0.0
RAMP_UP = 1.0
IN_WINDOW = 2.0
TURNING_ON = 3.0
RAMP_DOWN = 4.0


class Stage(Enumeration):
    """What drives the knife"""

    RESTING = 0, "nothing: it rests, and the machine does not run"
    PARKING = 1, "its motion to park"
    WAITING = 2, "nothing: it rests until the ramp up to the next cut"
    ENGAGING = 3, "the ramp up"
    SYNCHRONOUS = 4, "the window of a cut"
    TURNING = 5, "the curve from one window to the next"
    DISENGAGING = 6, "the ramp down"


@dataclass(slots=True)
class Cycle:
    """At most 8 sections, in rows one after the other; the knife is on the present one.

    Attributes:
        sections, present: how many there are, and which one the knife is on.
        rows: all sections.
        stage: of the present section, or what drives the knife instead.
        begin: where the present section begins, as a position of the master, u.
        next_begin: where the one after it begins, if there is one.
        blade: which blade makes the next cut, or the one in whose window the knife is.
        rest: the position of the knife, if it is at rest.
        cut: the cut in whose window the knife is.
        section: the curve that the knife is on.
        forgotten, forgotten_cut: the ramp up to the oldest window that is retained.
    """

    sections: int = var.count(CAPACITY, 1)
    present: int = var.count(CAPACITY - 1)
    rows: list[float] = var.array(104)
    stage: Stage = Stage.RESTING
    begin: float = 0.0
    next_begin: float = 0.0
    blade: float = 0.0
    rest: float = 0.0
    cut: Cut = var.part(Cut)
    section: Section = var.part(Section)
    forgotten: Way = var.part(Way)
    forgotten_cut: Cut = var.part(Cut)

    def is_last(self) -> bool:
        """Whether no section comes after the present one."""
        return self.present + 1 == self.sections

    def rest_before(self) -> float:
        """How much travel of the master the knife rests before the present section, a ramp up, u."""
        if self.present <= 1:
            return UNLIMITED
        return self.begin - self.rows[ROW * (self.present - 1) + BEGIN]

    def at(self, master: float) -> tuple[float, float, float, float]:
        """The position of the knife, and its derivatives by the master's, where that has this position, u."""
        if self.stage <= Stage.WAITING:
            return self.rest, 0.0, 0.0, 0.0
        if self.stage == Stage.SYNCHRONOUS:
            return self.cut.at(master)
        return self.section.at(master)

    # --- the knife is on another section ---

    def enter(self, index: int) -> None:
        """The knife is on the section with this index."""
        self.present = index
        kind = self.rows[ROW * index + KIND]
        self.begin = self.rows[ROW * index + BEGIN]
        self.blade = self.rows[ROW * index + BLADE]
        if index + 1 < self.sections:
            self.next_begin = self.rows[ROW * (index + 1) + BEGIN]
        if kind == AT_REST:
            self.stage = Stage.WAITING
            self.rest = self.rows[ROW * index + ORIGIN]
        elif kind == IN_WINDOW:
            self.stage = Stage.SYNCHRONOUS
            self.load_window(index)
        else:
            self.load_section(index)
            if kind == RAMP_UP:
                self.stage = Stage.ENGAGING
            elif kind == TURNING_ON:
                self.stage = Stage.TURNING
            else:
                self.stage = Stage.DISENGAGING

    def load_window(self, index: int) -> None:
        """The window that is the section with this index."""
        self.cut.place = self.rows[ROW * index + ORIGIN]
        self.cut.window.slope = self.rows[ROW * index + SCALE]
        self.cut.window.rate = self.rows[ROW * index + RATE]

    def load_section(self, index: int) -> None:
        """The curve that is the section with this index."""
        section = self.section
        quintic = section.quintic
        section.begin = self.rows[ROW * index + ORIGIN]
        section.end = self.rows[ROW * index + END]
        quintic.length = self.rows[ROW * index + SCALE]
        quintic.rate = self.rows[ROW * index + RATE]
        quintic.c0 = self.rows[ROW * index + COEFFICIENTS]
        quintic.c1 = self.rows[ROW * index + COEFFICIENTS + 1]
        quintic.c2 = self.rows[ROW * index + COEFFICIENTS + 2]
        quintic.c3 = self.rows[ROW * index + COEFFICIENTS + 3]
        quintic.c4 = self.rows[ROW * index + COEFFICIENTS + 4]
        quintic.c5 = self.rows[ROW * index + COEFFICIENTS + 5]

    # --- sections are planned ---

    def rest_at(self, stage: Stage, knife: Knife, blade: float, position: float) -> None:
        """At rest from now on, wherever the master is; the curves are those of this knife."""
        self.cut.window.is_horizontal = knife.is_horizontal
        self.cut.window.radian = knife.turn / TWO_PI
        self.sections = 0
        self.append_rest(0.0, blade, position)
        self.enter(0)
        self.stage = stage

    def cut_off(self) -> None:
        """What comes after the present section holds no more."""
        self.sections = self.present + 1

    def append(self, begin: float, kind: float, blade: float) -> int:
        """Append a section that begins at a position of the master, u, and return its index."""
        index = self.sections
        self.sections += 1
        self.rows[ROW * index + BEGIN] = begin
        self.rows[ROW * index + KIND] = kind
        self.rows[ROW * index + BLADE] = blade
        if self.sections == self.present + 2:
            self.next_begin = begin
        return index

    def append_rest(self, begin: float, blade: float, position: float) -> None:
        """Append a rest of the knife at this position."""
        index = self.append(begin, AT_REST, blade)
        self.rows[ROW * index + ORIGIN] = position

    def append_window(self, cut: Cut, blade: float) -> None:
        """Append the window of a cut."""
        index = self.append(cut.begin(), IN_WINDOW, blade)
        self.rows[ROW * index + ORIGIN] = cut.place
        self.rows[ROW * index + SCALE] = cut.window.slope
        self.rows[ROW * index + RATE] = cut.window.rate

    def append_section(self, kind: float, section: Section, blade: float) -> None:
        """Append a curve."""
        quintic = section.quintic
        index = self.append(section.begin, kind, blade)
        self.rows[ROW * index + ORIGIN] = section.begin
        self.rows[ROW * index + END] = section.end
        self.rows[ROW * index + SCALE] = quintic.length
        self.rows[ROW * index + RATE] = quintic.rate
        self.rows[ROW * index + COEFFICIENTS] = quintic.c0
        self.rows[ROW * index + COEFFICIENTS + 1] = quintic.c1
        self.rows[ROW * index + COEFFICIENTS + 2] = quintic.c2
        self.rows[ROW * index + COEFFICIENTS + 3] = quintic.c3
        self.rows[ROW * index + COEFFICIENTS + 4] = quintic.c4
        self.rows[ROW * index + COEFFICIENTS + 5] = quintic.c5

    # --- old sections are forgotten ---

    def can_append(self, number: int) -> bool:
        """Whether there is capacity for more sections after the present one, when old ones have been forgotten."""
        return self.oldest_retained(number) >= 0

    def oldest_retained(self, number: int) -> int:
        """The oldest section that need not be forgotten to append that many after the present one; -1: all must be.

        Where old sections are forgotten, the oldest one is a rest, or a window: a ramp will lead up to that one."""
        retained = self.present + 1
        if retained + number <= CAPACITY:
            return 0
        for index in range(1, retained):
            kind = self.rows[ROW * index + KIND]
            if kind == AT_REST and retained - index + number <= CAPACITY:
                return index
            if kind == IN_WINDOW and retained - index + OLDEST_WINDOW + number <= CAPACITY:
                return index
        return -1

    def forget_old_sections(self, number: int, knife: Knife) -> None:
        """Forget what comes after the present section, and so many old ones that there is capacity for more."""
        self.cut_off()
        oldest = self.oldest_retained(number)
        if oldest > 0:
            is_window = self.rows[ROW * oldest + KIND] == IN_WINDOW
            self.move_rows(oldest, OLDEST_WINDOW if is_window else 0)
            if is_window:
                self.plan_ramp_to_oldest_window(knife)

    def move_rows(self, oldest: int, to: int) -> None:
        """Let the rows from the oldest one that is retained start with that index."""
        shift = ROW * (oldest - to)
        numbers = ROW * (self.sections - oldest)
        for n in range(numbers):  # each is read before another is stored in its element
            i = ROW * to + (n if shift > 0 else numbers - 1 - n)
            self.rows[i] = self.rows[i + shift]
        self.sections += to - oldest
        self.present += to - oldest

    def plan_ramp_to_oldest_window(self, knife: Knife) -> None:
        """Plan the ramp up to the oldest window, and the rest before it."""
        sections = self.sections
        blade = self.rows[ROW * OLDEST_WINDOW + BLADE]
        window = self.forgotten_cut.window
        window.is_horizontal = self.cut.window.is_horizontal
        window.radian = self.cut.window.radian
        window.slope = self.rows[ROW * OLDEST_WINDOW + SCALE]
        window.rate = self.rows[ROW * OLDEST_WINDOW + RATE]
        window.before = self.rows[ROW * OLDEST_WINDOW + ORIGIN] - self.rows[ROW * OLDEST_WINDOW + BEGIN]
        window.set_point(window.begin, -window.before)
        self.forgotten_cut.place = self.rows[ROW * OLDEST_WINDOW + ORIGIN]
        self.forgotten.plan_ramp_up(knife, FAR_BACK, self.forgotten_cut)
        self.sections = 0
        self.append_rest(0.0, blade, knife.park_angle - knife.spacing)
        self.append_section(RAMP_UP, self.forgotten.ramp_up, blade)
        self.sections = sections

    def rebase(self, distance: float) -> None:
        """Reduce all positions of the master by a distance, u: whole turns are dropped."""
        for index in range(self.sections):
            self.rows[ROW * index + BEGIN] -= distance
            if self.rows[ROW * index + KIND] != AT_REST:
                self.rows[ROW * index + ORIGIN] -= distance
                self.rows[ROW * index + END] -= distance
        self.begin -= distance
        self.next_begin -= distance
        self.cut.place -= distance
        self.section.begin -= distance
        self.section.end -= distance
