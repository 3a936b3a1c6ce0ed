"""Tables of what a study found."""

from collections import Counter
from collections.abc import Iterable, Iterator
from statistics import median

from judge import AGREES, ERRORS, Json, judged
from words import EXPLAINED
from worlds import WORLDS

COLUMNS = (
    "sets | verdicts | E_d | E_b | E_s | delay | faults | by inspect | jumps | added rightly "
    "| added wrongly | left out / truth leaves | compare | s |"
)
LAW_COLUMNS = (
    "visible sets | explained | explained and not named | named rightly | as its class | not "
    "| formula for a curve right or its class | left out / truth leaves |"
)


def with_judgement(result: Json) -> Json:
    """A result of the study with what is to be said of it."""
    found = judged(result["answers"], result["truth"], result["truth_leaves_m"])
    return result | {"judged": found}


def share(values: Iterable[bool]) -> str:
    """How many of how many are true; nothing where there are none."""
    known = list(values)
    return f"{sum(known)}/{len(known)}" if known else ""


def counted(names: Iterable[str]) -> str:
    """Names by how often they come."""
    return ", ".join(f"{n} {name}" for name, n in Counter(names).most_common())


def within(found: list[Json], name: str) -> str:
    """In how many sets a ratio is within three standard errors, of those where it was fitted."""
    offs = [one["ratios"][name] for one in found]
    return share(abs(off["standard_errors"]) <= ERRORS for off in offs if off)


def left_out(found: list[Json]) -> str:
    """Median and largest quotient of the error left out and that which the truth leaves."""
    quotients = [
        one["left_out_m"] / one["truth_leaves_m"] for one in found if one["left_out_m"] is not None
    ]
    return f"{median(quotients):.2f}, at most {max(quotients):.2f}" if quotients else ""


def jumps(found: list[Json]) -> str:
    """Jumps named, and moments that were named without a reason."""
    there = sum(one["jumps"]["there"] for one in found)
    named = sum(one["jumps"]["named"] for one in found)
    invented = sum(one["jumps"]["invented"] for one in found)
    said = f"{named}/{there}" if there else ""
    return f"{said} +{invented} invented" if invented else said


def compared(found: list[Json]) -> str:
    """In how many sets `compare` finds the error that `learn` says; their largest quotient."""
    pairs = [(one["compare_rmse_m"], one["learn_rmse_m"]) for one in found]
    quotients = [max(a / b, b / a) for a, b in pairs if a and b]
    if not quotients:
        return ""
    return f"{share(one <= 1 + AGREES for one in quotients)}, at most {max(quotients):.2f}"


def seconds(result: Json) -> float:
    """What all commands took on a set."""
    return float(sum(done["seconds"] for done in result["answers"].values()))


def row(name: str, results: list[Json]) -> str:
    """Some sets together."""
    found = [one["judged"] for one in results]
    cells = [
        name,
        str(len(found)),
        counted(one["verdict"] for one in found),
        *(within(found, name) for name in ("e_d", "e_b", "e_s")),
        share(one["delay"]["within"] for one in found if one["delay"]),
        share(said for one in found for said in one["faults"].values()),
        share(said for one in found for said in one["faults_inspected"].values()),
        jumps(found),
        counted(name for one in found for name in one["added_right"]),
        counted(name for one in found for name in one["added_wrong"]),
        left_out(found),
        compared(found),
        f"{median(seconds(one) for one in results):.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def value_of(result: Json, key: str) -> str:
    """The world of a set, or one of its numbers as a word."""
    if key == "world":
        return str(result["world"])
    return str(next(part[key] for part in result["truth"]["numbers"].values() if key in part))


def table(results: list[Json], key: str) -> Iterator[str]:
    """A row for each world, or for each value of a number."""
    header = f"| {key} | {COLUMNS}"
    yield header
    yield "|" + "---|" * (header.count("|") - 1)
    groups: dict[str, list[Json]] = {world: [] for world in WORLDS} if key == "world" else {}
    for one in results:
        groups.setdefault(value_of(one, key), []).append(one)
    for name, own in groups.items():
        if own:
            yield row(name, own)


def laws(results: list[Json]) -> Iterator[str]:
    """A row for each kind of law that no catalogue lists, and one for all of them."""
    found = [one["judged"] for one in results if "law" in one["judged"]]
    if not found:
        return
    yield ""
    header = f"| law | {LAW_COLUMNS}"
    yield header
    yield "|" + "---|" * (header.count("|") - 1)
    groups: dict[str, list[Json]] = {}
    for one in sorted(found, key=lambda one: str(one["law"])):
        groups.setdefault(one["law"], []).append(one)
    for name, own in [*groups.items(), ("all", found)]:
        yield law_row(name, own)


def law_row(name: str, found: list[Json]) -> str:
    """Some sets with a law together."""
    said = Counter(one["law_right"] for one in found)
    explained = [one for one in found if one["explained"] == EXPLAINED]
    cells = [
        name,
        str(len(found)),
        str(len(explained)),
        str(sum(one["law_right"] == "no" for one in explained)),
        *(str(said[worth]) for worth in ("right", "class", "no")),
        str(sum(one["law_suggested"] != "no" for one in found)),
        left_out(found),
    ]
    return f"| {' | '.join(cells)} |"


def weight(result: Json) -> tuple[int, int]:
    """The worst problem of a set, and all together."""
    weights = [weight for weight, _ in result["judged"]["problems"]]
    return max(weights, default=0), sum(weights)


def one_line(result: Json) -> str:
    """A set in a line."""
    found = result["judged"]
    problems = "; ".join(text for _, text in found["problems"]) or "right"
    return f"{result['world']}-{result['seed']}: {found['verdict']}: {problems}"


def worst(results: list[Json]) -> Iterator[str]:
    """The sets that went wrong, worst first, each with the command that makes it again."""
    wrong = [one for one in results if one["judged"]["problems"]]
    yield f"{len(wrong)} of {len(results)} sets went wrong"
    for result in sorted(wrong, key=weight, reverse=True):
        yield f"\n[{weight(result)[0]}] {one_line(result)}\n    {result['made_by']}"
