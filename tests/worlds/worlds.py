"""The worlds by name: what each adds to a robot whose E_d, E_b and E_s alone are off."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, cos, pi, sin
from typing import Any, TypeAlias

from draw import around, chance, log_uniform, pick, signed
from plans import FREE, WITH_STOPS, WITHOUT_PLAN, Random
from setting import Setting

Changes: TypeAlias = dict[str, Any]
"""New values of numbers of a setting, by the names of their fields."""
Change: TypeAlias = Callable[[Setting, Random], Changes]

DEGREE = pi / 180


@dataclass(frozen=True)
class World:
    """A name, a sentence, and the change."""

    name: str
    says: str
    change: Change
    same_drive_as: str = ""
    """The world whose robots and drives this one has, seed by seed."""
    hides_law: bool = False
    """Whether a law that no catalogue lists is drawn for it (`unlisted.py`)."""


def always(**changes: Any) -> Change:
    """A change that draws nothing."""
    return lambda _setting, _random: changes


def delay(_: Setting, random: Random) -> Changes:
    """Poses are stamped too late or too early, differently in each run by up to a few ms."""
    size = log_uniform(random, 0.01, 0.3)
    return {"delay_s": signed(random, size), "delay_scatter_s": random.uniform(0, 5e-3)}


def clocks(_: Setting, random: Random) -> Changes:
    """The recorder of the poses is started anew for each run."""
    return {"delay_scatter_s": log_uniform(random, 0.05, 0.3)}


def low_pass(_: Setting, random: Random) -> Changes:
    """Poses that a first-order filter has smoothed."""
    return {"filter_s": log_uniform(random, 0.08, 0.4)}


def rate(_: Setting, random: Random) -> Changes:
    """The clock of the reference runs fast or slow."""
    return {"clock_rate": signed(random, log_uniform(random, 50e-6, 3000e-6))}


def lever(_: Setting, random: Random) -> Changes:
    """The tracked point is beside the axle's centre."""
    forward, left = around(random, log_uniform(random, 0.005, 0.15))
    return {"lever_forward_m": forward, "lever_left_m": left}


def yaw(_: Setting, random: Random) -> Changes:
    """The tracked axes are turned."""
    return {"yaw_rad": signed(random, log_uniform(random, 0.5, 180)) * DEGREE}


def jumps(_: Setting, random: Random) -> Changes:
    """One or two jumps in some runs."""
    return {
        "jumps": int(random.integers(1, 3)),
        "jumping_share": random.random(),
        "jump_of": pick(random, ["robot", "reference"]),
    }


def carried(setting: Setting, random: Random) -> Changes:
    """Robots that are lifted and carried."""
    return {**jumps(setting, random), "jump_of": "robot", "jump_lasts_s": (0.8, 2.5)}


def spinning(setting: Setting, random: Random) -> Changes:
    """A wheel that spins on the spot."""
    return {**jumps(setting, random), "jump_of": "wheel", "jump_lasts_s": (0.3, 1.5)}


def glitches(_: Setting, random: Random) -> Changes:
    """Bad poses, single or in bursts."""
    return {
        "glitch_share": log_uniform(random, 0.005, 0.05),
        "glitch_burst": int(random.integers(2, 11)) if chance(random, 0.5) else 1,
    }


def late_start(_: Setting, random: Random) -> Changes:
    """The wheels turn before the first pose."""
    return {"rest_s": 0.0, "blind_s": random.uniform(2, 5), "start": "room"}


def moving_start(setting: Setting, random: Random) -> Changes:
    """The log begins and ends while the robot moves."""
    cut = random.uniform(3, 6)
    return {
        "kind": pick(random, ["random_commands", "joystick"]),
        "controller": "open",
        "rest_s": 0.0,
        "cut_s": cut,
        "run_s": setting.drive.run_s + 2 * cut,
        "start": "room",
    }


def one_long(_: Setting, random: Random) -> Changes:
    """One drive of 5 to 20 minutes."""
    kind = pick(random, FREE)
    return {
        "kind": kind,
        "controller": "open" if kind in WITHOUT_PLAN else pick(random, ["odometry", "truth"]),
        "control_period_s": 0.05,
        "runs": 1,
        "run_s": random.uniform(300, 1200),
    }


def long_pieces(setting: Setting, random: Random) -> Changes:
    """The same in eight files."""
    return one_long(setting, random) | {"pieces": 8}


def far_off(random: Random) -> float:
    """A factor of 0.5 to 2, at least a tenth off."""
    factor = log_uniform(random, 1.1, 2)
    return factor if chance(random, 0.5) else 1 / factor


def wheelbase_off(_: Setting, random: Random) -> Changes:
    """The nominal wheelbase is far from the true one."""
    return {"e_b": far_off(random)}


def diameter_off(_: Setting, random: Random) -> Changes:
    """The nominal wheel diameter is far from the true one."""
    return {"e_s": far_off(random)}


def sparse(_: Setting, random: Random) -> Changes:
    """Poses at stops alone."""
    return {
        "kind": pick(random, WITH_STOPS),
        "controller": pick(random, ["open", "odometry", "truth"]),
        "rest_s": random.uniform(2, 4),
        "pause_s": random.uniform(1, 3),
        "at_stops_only": True,
    }


def scanmatch(_: Setting, random: Random) -> Changes:
    """A reference that adds up relative motions, some of them wrong."""
    return {
        "reference_rate_hz": random.uniform(5, 20),
        "scan_outliers": random.uniform(0.01, 0.03),
        "scan_noise_m": log_uniform(random, 1e-4, 1e-3),
        "scan_noise_rad": log_uniform(random, 1e-4, 1e-3),
    }


def command(setting: Setting, random: Random) -> Changes:
    """Ticks that are commands; the wheels follow late."""
    wheelbase = setting.robot.wheelbase_m
    return {
        "counts_commands": True,
        "motor_lag_s": random.uniform(0.1, 0.3),
        "wheel_noise_sqrt_m": log_uniform(random, 5e-4, 2e-3) * min(1.0, wheelbase / 0.3),
    }


def rough_floor(_: Setting, random: Random) -> Changes:
    """A floor that turns the robot at random, and hardly changes its way."""
    return {
        "heading_noise_rad_sqrt_m": log_uniform(random, 4e-3, 1e-2),
        "wheel_noise_sqrt_m": log_uniform(random, 5e-5, 2e-4),
    }


def gaps(_: Setting, random: Random) -> Changes:
    """Holes in the poses."""
    return {"gaps_a_minute": random.uniform(1, 4)}


def slam(_: Setting, random: Random) -> Changes:
    """A reference that drifts and jumps back."""
    return {"slam_period_s": random.uniform(20, 40)}


def heading_walk(_: Setting, random: Random) -> Changes:
    """Headings that drift beside positions that do not."""
    return {"heading_walk_rad_sqrt_s": log_uniform(random, 0.005, 0.02)}


def stretched(_: Setting, random: Random) -> Changes:
    """A reference that shows ways longer in one direction of the room than across it."""
    share, direction = log_uniform(random, 0.001, 0.01), random.uniform(0, 2 * pi)
    return {
        "stretch_along": share * cos(direction),
        "stretch_diagonal": share * sin(direction),
    }


def filled_in(_: Setting, random: Random) -> Changes:
    """Poses that were filled in on straight lines between measured ones."""
    return {"filled_in_poses": int(random.integers(4, 11))}


def combined(setting: Setting, random: Random) -> Changes:
    """Two or three troubles at once."""
    somewhere = always(start="room")
    choices: list[Change] = [delay, lever, yaw, jumps, glitches, somewhere]
    chosen = random.choice(len(choices), size=int(random.integers(2, 4)), replace=False)
    changes: Changes = {}
    for i in sorted(chosen.tolist()):
        changes |= choices[i](setting, random)
    return changes


def slope_yaw(_: Setting, random: Random) -> Changes:
    """The floor turns the robot, depending on its heading."""
    cosine, sine = around(random, log_uniform(random, 2e-3, 3e-2))
    return {"slope_cosine_rad_m": cosine, "slope_sine_rad_m": sine}


def slip(_: Setting, random: Random) -> Changes:
    """Wheels lose travel in proportion to their speed."""
    return {"slip_s_m": log_uniform(random, 0.005, 0.1)}


def body_slip(_: Setting, random: Random) -> Changes:
    """Both wheels lose travel in proportion to the speed of the robot."""
    return {"body_slip_s_m": log_uniform(random, 0.005, 0.1)}


def forward_slip(_: Setting, random: Random) -> Changes:
    """The robot loses way in proportion to its speed, and no turn."""
    return {"forward_slip_s_m": log_uniform(random, 0.005, 0.1)}


def squared_slip(_: Setting, random: Random) -> Changes:
    """Wheels lose travel, or the robot way, by the square of the speed."""
    name = ["squared_slip_s2_m2", "squared_forward_slip_s2_m2"][int(random.integers(2))]
    return {name: log_uniform(random, 0.01, 0.2)}


def once_a_turn(setting: Setting, random: Random) -> Changes:
    """One or both wheels are not round."""
    size = setting.robot.nominal_radius_m * log_uniform(random, 0.003, 0.03)
    left, right = [(size, 0.0), (0.0, size), (size, size)][int(random.integers(3))]
    return {
        "eccentricity_left_m": left,
        "eccentricity_right_m": right,
        "eccentricity_phase_rad": random.uniform(-pi, pi),
    }


def time_wave(_: Setting, random: Random) -> Changes:
    """A yaw rate that swings with time."""
    return {
        "wave_rad_s": log_uniform(random, 2e-3, 2e-2),
        "wave_period_s": log_uniform(random, 5, 60),
    }


def load(_: Setting, random: Random) -> Changes:
    """Turns on the spot lose more the faster they are."""
    return {
        "kind": pick(random, ["way_points", "spins_and_straights", "squares", "random_commands"]),
        "controller": "open",
        "scrub_s_rad": log_uniform(random, 0.01, 0.1),
    }


FINEST_TICK_M = 2e-4
"""Travel of a wheel for a tick, where laws of the speed are to be read off the ticks."""


def for_a_law(setting: Setting, random: Random) -> Changes:
    """Drives and a log that a law of the motion can show in: squares of many speeds, or free."""
    robot, recording = setting.robot, setting.recording
    kind = "squares" if chance(random, 0.5) else pick(random, FREE)
    open_loop = kind in WITHOUT_PLAN
    controller = "open" if open_loop else pick(random, ["open", "odometry", "truth"])
    is_square = kind == "squares"
    return {
        "kind": kind,
        "controller": controller,
        "control_period_s": 0.02,
        "runs": 10 if is_square else int(random.integers(6, 13)),
        "run_s": random.uniform(20, 120),
        "speed_spread": 3.0 if is_square else 1.0,
        "layout": "interleaved" if recording.layout == "interleaved" else "same",
        "tick_rate_hz": max(recording.tick_rate_hz, 20.0),
        "ticks_per_revolution": max(
            robot.ticks_per_revolution, ceil(pi * robot.wheel_diameter_m / FINEST_TICK_M)
        ),
    }


PERFECT = {"e_d": 1.0, "e_b": 1.0, "e_s": 1.0}

WORLDS = {
    world.name: world
    for world in (
        World("null", "E_d, E_b and E_s alone are off", always()),
        World("perfect", "nothing is off", always(**PERFECT)),
        World("delay", "constant delay of the reference, 10 to 300 ms either way", delay),
        World("clocks", "poses of each run by a clock of its own, 50 to 300 ms off", clocks),
        World("low_pass", "poses behind a low-pass filter of 0.08 to 0.4 s", low_pass),
        World("rate", "clock of the reference 50 to 3000 ppm off", rate),
        World("lever", "tracked point 5 to 150 mm from the axle's centre", lever),
        World("yaw", "tracked heading turned by 0.5 to 180 degrees", yaw),
        World("exchanged", "columns of left and right ticks exchanged", always(exchanged=True)),
        World("left_reversed", "left ticks count down", always(left_reversed=True)),
        World("right_reversed", "right ticks count down", always(right_reversed=True)),
        World(
            "both_reversed",
            "both count down",
            always(left_reversed=True, right_reversed=True),
        ),
        World(
            "exchanged_reversed",
            "columns exchanged, both count down",
            always(exchanged=True, left_reversed=True, right_reversed=True),
        ),
        World(
            "left_doubled",
            "the left counter counts two edges where the right one counts one",
            always(left_extra_edges=1),
        ),
        World(
            "heading_clockwise",
            "heading with the wrong sign, x and y right",
            always(heading_clockwise=True),
        ),
        World("mirrored", "y and heading with the wrong sign", always(mirrored=True)),
        World("compass", "heading is a bearing, π/2 - θ", always(compass=True)),
        World("jumps", "1 or 2 jumps in some runs, 0.1 to 1 m and 3 to 60 degrees", jumps),
        World("carried", "jumps that last 0.8 to 2.5 s: the robot is carried", carried),
        World("spinning", "a wheel spins on the spot for 0.3 to 1.5 s", spinning),
        World("glitches", "0.5 to 5 % bad poses, single or in bursts", glitches),
        World(
            "rough_floor",
            "headings wander by 4 to 10 mrad per root metre, ways hardly",
            rough_floor,
        ),
        World("tails", "noise of the reference with t2 tails", always(noise="t2")),
        World("late_start", "wheels turn 2 to 5 s before the first pose", late_start),
        World("moving_start", "the log begins and ends in motion", moving_start),
        World("one_long", "one drive of 5 to 20 minutes", one_long),
        World("long_pieces", "the drive of one_long in 8 files", long_pieces, "one_long"),
        World("wheelbase_off", "true wheelbase 0.5 to 2 times the nominal", wheelbase_off),
        World("diameter_off", "true wheel diameter 0.5 to 2 times the nominal", diameter_off),
        World(
            "straights",
            "straight drives alone: E_b cannot be seen",
            always(kind="straights", controller="open"),
        ),
        World(
            "spins",
            "turns on the spot alone: E_b and E_s cannot be separated",
            always(kind="spins", controller="open"),
        ),
        World("mm_as_m", "x and y in millimetres under a header of metres", always(mm_as_m=True)),
        World(
            "deg_as_rad", "heading in degrees under a header of radians", always(deg_as_rad=True)
        ),
        World("no_heading", "no theta_ref_rad", always(has_heading=False)),
        World("sparse", "poses at stops alone", sparse),
        World("scanmatch", "relative motions added up, 1 to 3 % of them wrong", scanmatch),
        World("command", "ticks are commands; the wheels lag by 0.1 to 0.3 s", command),
        World("gaps", "holes of 0.5 to 5 s in the poses", gaps),
        World("slam", "reference drifts and jumps back every half minute", slam),
        World("heading_walk", "measured headings drift, and positions do not", heading_walk),
        World("stretched", "ways longer in one direction of the room", stretched),
        World("filled_in", "3 to 9 of 4 to 10 poses on lines between the others", filled_in),
        World(
            "combined", "2 or 3 of delay, lever, yaw, jumps, glitches, start in a room", combined
        ),
        World("slope_yaw", "law: turn per metre is a sine of the heading", slope_yaw),
        World("slip", "law: wheels lose travel in proportion to speed", slip),
        World("body_slip", "law: both wheels lose by the speed of the robot", body_slip),
        World("forward_slip", "law: way is lost by the speed of the robot", forward_slip),
        World("squared_slip", "law: slip by the square of the speed", squared_slip),
        World("once_a_turn", "law: wheels that are not round", once_a_turn),
        World("time_wave", "law: yaw rate is a sine of time", time_wave),
        World("load", "law: fast turns on the spot lose more", load),
        World("unlisted", "law: drawn from a wide family, and seen", for_a_law, hides_law=True),
        World("unlisted_null", "the drives of unlisted without its law", for_a_law, "unlisted"),
    )
}
