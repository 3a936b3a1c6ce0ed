"""Write made datasets whose cause is sealed: `generate.py CASE OUTFOLDER`."""

import argparse
import sys
from pathlib import Path as File

from cases import CASES, DRAWN, Case, case_of
from measure import NOISE_MODELS, Terms, end_poses, measure
from sensors import Reference
from write import write_dataset, write_returns, write_truth

LEVEL = {"dense": "tracks", "stops": "stops", "ends": "ends"}
TAPE = Reference(position_sd_m=2e-3, heading_sd_rad=2.6e-3)
PAPER_K_SQRT_M = 1e-3
PARQUET_K_SQRT_M = 4e-4
SIDE_BY_SIDE = 20


def arguments(words: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", nargs="?", metavar="CASE", help="see --list")
    parser.add_argument("out", nargs="?", type=File, metavar="OUTFOLDER")
    parser.add_argument("--list", action="store_true", help="list the cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--reference", choices=LEVEL, default="dense")
    parser.add_argument(
        "--sets", type=int, help="that many datasets OUTFOLDER/0001 .. with seeds SEED .."
    )
    parser.add_argument(
        "--nulls", type=int, metavar="N", help="the same as case none with --sets N"
    )
    parser.add_argument("--noise", choices=NOISE_MODELS, default="gaussian")
    parser.add_argument("--wheel-noise", type=float, metavar="K_SQRT_M")
    parser.add_argument("--runs", type=int, default=5, help="per direction")
    parser.add_argument(
        "--returns-only", action="store_true", help="end poses alone, by exact kinematics: fast"
    )
    chosen = parser.parse_args(words)
    if chosen.nulls is not None:
        if chosen.out is not None:
            parser.error("--nulls has its own case; give only OUTFOLDER")
        if chosen.case is None:
            parser.error("OUTFOLDER is missing")
        chosen.case, chosen.out, chosen.sets = "none", File(chosen.case), chosen.nulls
    if not chosen.list and (chosen.case not in (*CASES, DRAWN) or chosen.out is None):
        parser.error("a CASE of --list and an OUTFOLDER are needed")
    return chosen


def write_batch(
    case: Case, terms: Terms, chosen: argparse.Namespace, folders: dict[int, File]
) -> None:
    """Make the datasets of some seeds side by side and write them with their truth."""
    seeds = list(folders)
    level = "ends" if chosen.returns_only else LEVEL[chosen.reference]
    bases = []
    if chosen.returns_only:
        absolute, computed, base = end_poses(case, seeds, terms)
        each = len(terms.directions)
        for i, folder in enumerate(folders.values()):
            part = slice(i * each, (i + 1) * each)
            write_returns(folder, case, terms, absolute[:, part], computed[:, part])
            bases.append({key: float(values[i]) for key, values in base.items()})
    else:
        for data in measure(case, seeds, terms, level):
            write_dataset(folders[data.seed], case, data)
            bases.append(data.base)
    for (seed, folder), known in zip(folders.items(), bases, strict=True):
        write_truth(folder, chosen.case, case, seed, terms, level, known)


def main(words: list[str]) -> None:
    """Do what the command line says."""
    chosen = arguments(words)
    if chosen.list:
        print("\n".join((*CASES, DRAWN)))
        return
    k = chosen.wheel_noise
    if k is None:
        k = PAPER_K_SQRT_M if chosen.returns_only else PARQUET_K_SQRT_M
    reference = TAPE if chosen.returns_only else Reference()
    terms = Terms(chosen.runs, k, chosen.noise, reference)
    if chosen.sets is None:
        folders = {chosen.seed: chosen.out}
    else:
        folders = {chosen.seed + i: chosen.out / f"{i + 1:04}" for i in range(chosen.sets)}
    seeds = list(folders)
    together = 1 if chosen.case == DRAWN else SIDE_BY_SIDE
    for first in range(0, len(seeds), together):
        batch = seeds[first : first + together]
        case = case_of(chosen.case, batch[0])
        write_batch(case, terms, chosen, {seed: folders[seed] for seed in batch})


if __name__ == "__main__":
    main(sys.argv[1:])
