"""The keys that robots, paths and effects take, for static checks: written from the core's.

``SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_keys`` writes them anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

from numpy.typing import ArrayLike

Drive: TypeAlias = Literal[
    "differential",
    "synchro",
    "clapper",
    "ackermann",
    "tricycle",
    "mecanum",
    "omni3",
    "omni4",
    "dead_wheels",
    "skid_steer",
]
Shape: TypeAlias = Literal[
    "square",
    "rectangle",
    "rounded_rectangle",
    "figure_eight",
    "circle",
    "straight",
    "spin",
    "fixed_square",
    "fixed_circle",
    "diagonal_square",
    "sideways_square",
    "slide",
    "waypoints",
]
# An effect of the catalogue; those of one's own have other names.
EffectName: TypeAlias = Literal[
    "wheel_lag",
    "missed_counts",
    "encoder_skew",
    "encoder_sampling",
    "encoder_resolution",
    "lost_cycles",
    "wheel_diameter_ratio",
    "wheelbase",
    "scale",
    "wheel_eccentricity_left",
    "wheel_eccentricity_right",
    "diameter_drift",
    "centripetal_load",
    "backlash",
    "drive_scale",
    "steer_scale",
    "steer_coupling",
    "contact_trail",
    "base_yaw",
    "front_wheel_zero",
    "front_wheel_gain",
    "axle_distance",
    "steering_zero",
    "steering_gain",
    "understeer",
    "side_diameter_ratio",
    "diagonal_diameter_ratio",
    "axle_diameter_ratio",
    "front_diameter_ratio",
    "rear_diameter_ratio",
    "omni_side_ratio",
    "omni_axle_ratio",
    "omni_pair_ratio",
    "along_diameter_ratio",
    "across_diameter_ratio",
    "across_wheel_offset",
    "roller_scale",
    "lateral_scale",
    "sideways_turn_slip",
    "rear_truck",
    "link_length",
    "rotary_zero_difference",
    "rotary_zero_mean",
    "rotary_gain",
    "crab",
    "speed_slip",
    "speed_slip_left",
    "speed_slip_right",
    "body_speed_slip",
    "forward_slip",
    "squared_speed_slip",
    "squared_forward_slip",
    "acceleration_slip",
    "turn_slip",
    "turn_slip_rate",
    "direction_dependent_wheelbase",
    "caster_kick",
    "leg_kick",
    "floor_slope",
    "floor_slope_yaw",
    "carpet_nap",
    "placed_bumps",
    "bumps",
    "wheel_noise",
    "start_pose",
    "reference_delay",
    "reference_filter",
    "reference_clock_rate",
    "marker_offset",
    "marker_yaw",
    "reference_heading_drift",
    "reference_heading_scale",
    "reference_lens",
    "reference_stretch",
    "reference_noise",
]
ActsOn: TypeAlias = Literal[
    "heading_per_metre",
    "forward_scale",
    "turn_scale",
    "sideways_per_metre",
    "forward_per_radian",
    "sideways_per_radian",
    "heading_per_second",
    "forward_per_second",
    "sideways_per_second",
    "left_wheel_scale",
    "right_wheel_scale",
]
# A number, or what it is drawn from: {"mean": .., "sd": ..}, {"min": .., "max": ..}.
Drawn: TypeAlias = float | Mapping[str, float]


class RobotKeys(TypedDict, total=False):
    """Keys of ``[robot]`` in a robot.toml; which of them a robot has depends on its drive."""

    name: str | None
    drive: Drive | None
    wheels_exchanged: bool | None
    left_counts_backward: bool | None
    right_counts_backward: bool | None
    wheelbase_m: float | None
    wheel_diameter_left_m: float | None
    wheel_diameter_right_m: float | None
    wheel_separation_m: float | None
    track_width_m: float | None
    wheel_diameter_m: float | None
    wheel_radius_m: float | None
    ticks_per_revolution: float | None
    encoder_rate_hz: float | Literal["every tick"] | None
    counter_bits: int | None
    drive_counts_backward: bool | None
    steering_counts_backward: bool | None
    wheel_circle_m: float | None
    steering_ticks_per_revolution: float | None
    coupling_rad_per_m: float | None
    link_m: float | None
    rotary_ticks_per_revolution: float | None
    correction: Literal["off", "on"] | None
    rotary_zero_difference_rad: float | None
    diameter_difference: float | None
    axle_distance_m: float | None
    steering_zero_rad: float | None
    wheel_distance_length_m: float | None
    wheel_distance_width_m: float | None
    wheel_diameter_1_m: float | None
    wheel_diameter_2_m: float | None
    wheel_diameter_3_m: float | None
    wheel_diameter_4_m: float | None
    wheel_distance_m: float | None
    wheel_offset_rad: float | None
    across_wheel_ahead_m: float | None
    wheel_separation_multiplier: float | None


class MotionKeys(TypedDict, total=False):
    """Keys of ``[path]`` in a robot.toml that every path has: how it is driven."""

    speed_m_s: float | None
    acceleration_m_s2: float | None
    pause_s: float | None


class PathKeys(MotionKeys, total=False):
    """Keys of ``[path]`` in a robot.toml; which of them a path has depends on its shape."""

    side_m: float | None
    length_m: float | None
    width_m: float | None
    corner_radius_m: float | None
    radius_m: float | None
    turns: float | None
    points_m: ArrayLike | Sequence[Sequence[float]] | None


class EffectKeys(TypedDict, total=False):
    """Keys of ``[[effect]]`` in a model.toml; which of them an effect has the catalogue says."""

    acts_on: ActsOn
    formula: str | Callable[..., Any]
    parameters: Mapping[str, Drawn]
    free: bool
    fixed: Sequence[str]
    share: Drawn
    time_constant_s: Drawn
    left_s_per_m: Drawn
    right_s_per_m: Drawn
    threshold_m_s: Drawn
    delay_right_s: Drawn
    period_s: Drawn
    quantum_m: Drawn
    wheelbase_m: Drawn
    e_d: Drawn
    e_b: Drawn
    e_s: Drawn
    cosine_m: Drawn
    sine_m: Drawn
    per_m: Drawn
    per_session_m: Drawn
    mean_per_m: Drawn
    settles_per_m: Drawn
    s2_per_m: Drawn
    play_m: Drawn
    ratio: Drawn
    rad_per_m: Drawn
    trail_m: Drawn
    cosine_rad_per_m: Drawn
    sine_rad_per_m: Drawn
    angle_rad: Drawn
    rad_per_m_s2: Drawn
    ahead_m: Drawn
    s_per_m: Drawn
    s2_per_m2: Drawn
    s_per_rad: Drawn
    difference: Drawn
    kick_rad: Drawn
    back_rad: Drawn
    drift_x: Drawn
    drift_y: Drawn
    slide_x_m_per_rad: Drawn
    slide_y_m_per_rad: Drawn
    turning_cosine: Drawn
    turning_sine: Drawn
    count: Drawn
    height_m: Drawn
    wheel_radius_m: Drawn
    profile: Literal["cable", "edge"]
    lost_per_m: Drawn
    rate_per_m: Drawn
    k_sqrt_m: Drawn
    x_m: Drawn
    y_m: Drawn
    heading_rad: Drawn
    position_sd_m: Drawn
    heading_sd_rad: Drawn
    delay_s: Drawn
    forward_m: Drawn
    left_m: Drawn
    yaw_rad: Drawn
    rate_rad_s: Drawn
    k1_per_m2: Drawn
    k2_per_m4: Drawn
    centre_x_m: Drawn
    centre_y_m: Drawn
    headings: Drawn
    along_m_per_m: Drawn
    diagonal_m_per_m: Drawn
