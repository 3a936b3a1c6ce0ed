"""Worlds as files: the folder that the command reads, and truth.json in it."""

import json
from pathlib import Path as File
from typing import Any

import numpy as np
from record import Log, Made, common_limits
from setting import Setting
from worlds import WORLDS

FAR = 8.0
"""Times the size of the noise."""
CONVENTIONS = {
    "e_d": "true right wheel diameter over true left one, beyond the nominal ratio; "
    "the mean of both stays",
    "e_b": "true wheelbase over the nominal one",
    "e_s": "true mean wheel diameter over the nominal one",
    "delay_s": "positive: a pose is older than its stamp, it shows where the robot was so long "
    "before; the mean of the runs",
    "clock_rate": "positive: the delay grows by so many seconds each second of the run",
    "lever_forward_m": "how far ahead of the axle's centre the tracked point is; lever_left_m: to "
    "its left",
    "yaw_rad": "how far the tracked heading is counter-clockwise of the robot's",
    "logs": "begin_s: time between switching on and the stamp 0; start_in_room: where the axle's "
    "centre is at the first row",
    "jumps": "moved_m and turned_rad of the measured poses, counter-clockwise positive; time_s is "
    "a time stamp of the log",
    "glitches": "time stamps of bad poses, by log",
    "far_poses": "time stamps of poses that noise alone moved by more than eight times its size",
    "law": "one that no catalogue lists: shows_m is what it adds to the positions beyond E_d, E_b, "
    "E_s and START, noise_m what the truth leaves without it; share_of_one_run: of the squares of "
    "shows_m, the run that has most; room_m: least and greatest x, least "
    "and greatest y of the drives; what the law is stands in numbers",
    "corrections": "a reference that drifts is set right by so much at these time stamps",
}


def robot_toml(setting: Setting) -> str:
    """The nominal robot; the path where it is a square."""
    robot = setting.robot
    lines = [
        "[robot]",
        'drive = "differential"',
        f"wheelbase_m = {robot.wheelbase_m}",
        f"wheel_diameter_m = {robot.wheel_diameter_m}",
        f"ticks_per_revolution = {robot.ticks_per_revolution}",
    ]
    if setting.drive.kind == "squares":
        side = common_limits(setting, 0).side_m
        lines += ["", "[path]", 'shape = "square"', f"side_m = {side:.4f}"]
    return "\n".join(lines) + "\n"


def cells(values: list[float], digits: int) -> list[str]:
    """Numbers as text; nothing where there is none."""
    return ["" if value != value else f"{value:.{digits}f}" for value in values]


def ticks(count: float) -> str:
    """A count, whole but for rows between two readings."""
    return str(int(count)) if count.is_integer() else f"{count:.3f}"


def log_text(log: Log, has_heading: bool) -> str:
    """The rows of one log."""
    columns = [
        cells(log.stamp_s.tolist(), 6),
        *([ticks(one) for one in count.tolist()] for count in log.counts.T),
        *(cells(place.tolist(), 5) for place in log.pose[:, :2].T),
    ]
    header = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m"
    if has_heading:
        columns.append(cells(log.pose[:, 2].tolist(), 6))
        header += ",theta_ref_rad"
    return "\n".join([header, *map(",".join, zip(*columns, strict=True))]) + "\n"


def jumps_in_logs(made: Made) -> list[dict[str, Any]]:
    """Each jump with the log that it is in and the time stamp there."""
    found = []
    for jump in made.jumps:
        x, y, turn = jump.shift
        begin = jump.time_s - made.begins_s[jump.run] + made.delays_s[jump.run]
        stamp = begin + jump.lasts_s
        for log in made.logs:
            if log.run == jump.run and log.stamp_s[0] <= stamp <= log.stamp_s[-1]:
                found.append(
                    {
                        "run": log.name,
                        "since_s": begin,
                        "time_s": stamp,
                        "moved_m": float(np.hypot(x, y)),
                        "turned_rad": turn,
                        "of": made.setting.faults.jump_of,
                    }
                )
    return found


def far_poses(made: Made) -> dict[str, list[float]]:
    """Poses in the tails of the noise, by log; none where the reference drifts."""
    setting = made.setting
    if setting.faults.scan_outliers or setting.faults.slam_period_s:
        return {}
    reference = setting.reference
    sizes = [reference.position_noise_m, reference.position_noise_m, reference.heading_noise_rad]
    found: dict[str, list[float]] = {}
    for log in made.logs:
        far = (np.abs(log.error) > FAR * np.array(sizes)).any(axis=1) & (log.bad == 0)
        found |= {log.name: log.stamp_s[far].tolist()} if far.any() else {}
    return found


def logs_of(made: Made) -> dict[str, dict[str, Any]]:
    """What is known of each log."""
    return {
        log.name: {
            "drive": log.run,
            "seconds": float(log.stamp_s[-1] - log.stamp_s[0]),
            "rows": len(log.stamp_s),
            "poses": int(np.isfinite(log.pose[:, 0]).sum()),
            "delay_s": made.delays_s[log.run],
            "begin_s": made.begins_s[log.run],
            "start_in_room": log.body[0].tolist(),
        }
        for log in made.logs
    }


def truth(made: Made) -> dict[str, Any]:
    """Everything that was put in."""
    setting = made.setting
    robot, reference = setting.robot, setting.reference
    names = {log.run: log.name for log in reversed(made.logs)}
    delay = float(np.mean(made.delays_s))
    late = robot.motor_lag_s if setting.faults.counts_commands else 0.0
    late += setting.reference.filter_s
    late += float(np.mean([log.late_s for log in made.logs]))
    return {
        "world": made.world,
        "says": WORLDS[made.world].says,
        "seed": made.seed,
        "e_d": robot.e_d,
        "e_b": robot.e_b,
        "e_s": robot.e_s,
        "delay_s": delay,
        "apparent_delay_s": delay + late,
        "clock_rate": reference.clock_rate,
        "lever_forward_m": reference.lever_forward_m,
        "lever_left_m": reference.lever_left_m,
        "yaw_rad": reference.yaw_rad,
        "faults": setting.faults_present(),
        "jumps": jumps_in_logs(made),
        "glitches": {
            log.name: log.stamp_s[log.bad > 0].tolist() for log in made.logs if log.bad.any()
        },
        "far_poses": far_poses(made),
        "corrections": [
            {"run": names[run], "time_s": stamp, "moved_m": moved, "turned_rad": turn}
            for run, stamp, moved, turn in made.corrections
        ],
        "logs": logs_of(made),
        "law": made.law,
        "numbers": setting.numbers(),
        "conventions": CONVENTIONS,
    }


def write(made: Made, folder: File) -> None:
    """Write the folder."""
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    (folder / "robot.toml").write_text(robot_toml(made.setting))
    for log in made.logs:
        text = log_text(log, made.setting.reference.has_heading)
        (folder / "runs" / f"{log.name}.csv").write_text(text)
    (folder / "truth.json").write_text(json.dumps(truth(made), indent=1) + "\n")
