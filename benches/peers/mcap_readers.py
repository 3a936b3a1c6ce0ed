"""The same MCAP log read into arrays by Python packages and by umbmark, one after the other.

Uses the environment of run.py. Each program gets the wheels' positions and the measured poses of a
log out of it, by messages of the two topics that hold them, in rounds that go through all programs
in turn; prints a table in Markdown.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from run import ROOT, install, say

ROUNDS = 3
TOPICS = ["/joint_states", "/ground_truth"]


def mcap_ros2(file: str) -> tuple[int, int]:
    """Read with mcap and mcap-ros2-support."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    wheels, poses = [], []
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        messages = reader.iter_decoded_messages(topics=TOPICS, log_time_order=False)
        for _, channel, _, message in messages:
            stamp = message.header.stamp
            time_s = stamp.sec + 1e-9 * stamp.nanosec
            if channel.topic == TOPICS[0]:
                wheels.append((time_s, message.position[0], message.position[1]))
            else:
                position, q = message.pose.position, message.pose.orientation
                poses.append((time_s, position.x, position.y, q.z, q.w))
    return len(wheels), len(poses)


def rosbags(file: str) -> tuple[int, int]:
    """Read with rosbags."""
    from rosbags.highlevel import AnyReader

    wheels, poses = [], []
    with AnyReader([Path(file)]) as reader:
        connections = [c for c in reader.connections if c.topic in TOPICS]
        for connection, _, raw in reader.messages(connections):
            message = reader.deserialize(raw, connection.msgtype)
            stamp = message.header.stamp
            time_s = stamp.sec + 1e-9 * stamp.nanosec
            if connection.topic == TOPICS[0]:
                wheels.append((time_s, message.position[0], message.position[1]))
            else:
                position, q = message.pose.position, message.pose.orientation
                poses.append((time_s, position.x, position.y, q.z, q.w))
    return len(wheels), len(poses)


PEERS = {"mcap + mcap-ros2-support": mcap_ros2, "rosbags": rosbags}


def build() -> str:
    """Compile the Rust side and return its program."""
    cargo = ["cargo", "build", "--release", "--package", "umbmark-benches", "--example", "mcap_log"]
    subprocess.run(cargo, check=True, cwd=ROOT)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    name = "mcap_log.exe" if os.name == "nt" else "mcap_log"
    return str(target / "release" / "examples" / name)


def words_of(command: list[str]) -> list[list[str]]:
    """The words of each line that a program prints."""
    done = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE)
    return [line.split() for line in done.stdout.splitlines()]


def peer_once(name: str, file: str) -> None:
    """Read once, and print the seconds and how much was read."""
    began = time.perf_counter()
    wheels, poses = PEERS[name](file)
    print(time.perf_counter() - began, wheels, poses)


def main() -> None:
    """Measure everything, and print the table."""
    if len(sys.argv) == 3:
        peer_once(*sys.argv[1:])
        return
    python, rust = str(install()), build()
    print("| log | program | seconds | MB/s of messages | umbmark is faster |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for file, size in words_of([rust, "write", folder]):
            commands = {name: [python, __file__, name, file] for name in PEERS}
            commands["umbmark"] = [rust, "read", file, "5"]
            seconds: dict[str, list[float]] = {name: [] for name in commands}
            counts = set()
            for turn in range(ROUNDS):
                say(f"{Path(file).name}: round {turn + 1} of {ROUNDS}")
                for name, command in commands.items():
                    for line in words_of(command):
                        seconds[name].append(float(line[0]))
                        counts.add(tuple(line[1:]))
            if len(counts) != 1:
                sys.exit(f"the programs read different numbers of messages: {counts}")
            median = {name: statistics.median(times) for name, times in seconds.items()}
            for name, s in median.items():
                rate, ratio = int(size) / s / 1e6, s / median["umbmark"]
                print(f"| {Path(file).stem} | {name} | {s:.3f} | {rate:.1f} | {ratio:.1f} |")


if __name__ == "__main__":
    main()
