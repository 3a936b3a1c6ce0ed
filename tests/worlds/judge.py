"""Hold what the command says of a world against the truth."""

import json
from typing import Any, TypeAlias

import naming
import words
from replay import setting_in
from setting import Setting

Json: TypeAlias = dict[str, Any]

ERRORS = 3.0
"""Standard errors that a number may be off."""
NEAR_S = 0.5
"""A named moment belongs to a jump that is so near."""
DELAY_S = 5e-3
"""A delay may be off by so much at most."""
APART_S, CLOCK_S = 0.02, 0.02
"""Delays that scatter by more from run to run are those of clocks; each may be off by so much."""
SMALL = 5e-5
"""E_d, E_b and E_s that are off by less harm nobody, however small the standard error."""
AGREES = 0.01
"""`compare` may leave another error than `learn` says, by this share."""
WORSE, WORSE_M = 1.5, 2e-3
"""An error left out is too large beyond this factor, and by more than this, of the truth's."""


def fitted(learn: Json, effect: str, parameter: str) -> tuple[float, float] | None:
    """Value and standard error of a fitted number; none where it was not fitted."""
    for one in learn.get("fitted") or []:
        if one["effect"] == effect and one["parameter"] == parameter:
            return (one["value"], one["standard_error"]) if one["standard_error"] else None
    return None


def written(learn: Json, effect: str, parameter: str) -> float | None:
    """A value of the model, fitted or kept; none where the effect is not in it."""
    effects = (learn.get("model") or {}).get("effect") or []
    values = (one.get(parameter) for one in effects if one["name"] == effect)
    return next(values, None)


def off_by(said: tuple[float, float] | None, true: float) -> Json | None:
    """How far a fitted number is from the truth."""
    if said is None:
        return None
    value, error = said
    return {"said": value, "true": true, "standard_errors": (value - true) / error}


def ratios(learn: Json, truth: Json) -> Json:
    """E_d, E_b and E_s against the truth; none where the data cannot show it."""
    kind = truth["numbers"]["drive"]["kind"]
    said = {
        "e_d": fitted(learn, "wheel_diameter_ratio", "e_d"),
        "e_b": fitted(learn, "wheelbase", "e_b"),
        "e_s": fitted(learn, "scale", "e_s"),
    }
    if kind == "spins":
        # Turns on the spot show the quotient of E_s and E_b alone.
        scale = said["e_s"][0] if said["e_s"] else 1.0
        wheelbase = off_by(said["e_b"], truth["e_b"] / truth["e_s"] * scale)
        return {"e_d": None, "e_b": wheelbase, "e_s": None}
    if kind == "straights" or (kind == "back_and_forth" and said["e_b"] is None):
        # Straights show the turn of each metre, (E_d - 1) / E_b, where E_b is not fitted.
        believed = said["e_b"][0] if said["e_b"] else 1.0
        ratio = off_by(said["e_d"], 1.0 + (truth["e_d"] - 1.0) / truth["e_b"] * believed)
        return {"e_d": ratio, "e_b": None, "e_s": off_by(said["e_s"], truth["e_s"])}
    return {name: off_by(pair, truth[name]) for name, pair in said.items()}


def delay(learn: Json, truth: Json) -> Json | None:
    """The delay against the truth, where there is one or one was added.

    Wheels that follow late, and filters, make a delay too: that of slow motion.
    """
    said = fitted(learn, "reference_delay", "delay_s")
    true = truth["apparent_delay_s"]
    numbers = truth["numbers"]
    if numbers["reference"]["delay_scatter_s"] > APART_S:
        return own_clocks(learn, truth, said[0] if said else 0.0)
    follows = numbers["faults"]["counts_commands"] or numbers["reference"]["filter_s"]
    for effect in ("wheel_lag", "reference_filter") if follows else ():
        share, time = (written(learn, effect, name) for name in ("share", "time_constant_s"))
        if share and time:
            late = share * time + (said[0] if said else 0.0)
            return {"said": late, "true": true, "within": abs(late - true) <= DELAY_S}
    if said is None:
        return {"said": None, "true": true, "within": False} if abs(true) >= 0.01 else None
    off = off_by(said, true)
    assert off is not None
    off["within"] = abs(off["standard_errors"]) <= ERRORS and abs(off["said"] - true) <= DELAY_S
    return off


def own_clocks(learn: Json, truth: Json, common: float) -> Json | None:
    """The delay of the run that is farthest from its truth, where each has its own."""
    told = (learn.get("setup") or {}).get("delays") or []
    pairs = [(one["own_clock_s"] + common, truth["logs"][one["run"]]["delay_s"]) for one in told]
    if not pairs:
        return {"said": None, "true": 0.0, "within": False}
    said, true = max(pairs, key=lambda pair: abs(pair[0] - pair[1]))
    return {"said": said, "true": true, "within": abs(said - true) <= CLOCK_S}


def right_additions(truth: Json) -> tuple[set[str], set[str]]:
    """Effects, and variables of formulas, that are right to add."""
    numbers = Setting().numbers() | truth["numbers"]
    flat = {key: value for part in numbers.values() for key, value in part.items()}
    effects: set[str] = set()
    variables: set[str] = set()
    for key, names in words.NUISANCES.items():
        effects |= names if flat[key] else set()
    for key, (names, variable) in words.LAWS.items():
        if flat[key]:
            effects |= names
            variables.add(variable)
    if truth["apparent_delay_s"]:
        effects |= words.NUISANCES["delay_s"]
    moved_start = flat["start"] == "origin" and effects & {"marker_offset", "marker_yaw"}
    if moved_start or truth["world"] in words.FREE_START:
        effects.add("start_pose")
    if truth["faults"]:
        effects |= {"marker_yaw", "crab"}
    return effects, variables


def additions(learn: Json, truth: Json, law: Json) -> tuple[list[str], list[str]]:
    """Steps that are right and steps that are not."""
    effects, variables = right_additions(truth)
    right: list[str] = []
    wrong: list[str] = []
    for number, step in enumerate(learn.get("steps") or []):
        name = step["added"]
        if name is None or name in words.ALWAYS:
            continue
        formula = (step.get("law") or {}).get("formula", "")
        is_right = ({name} | set(step["class"])) & effects or any(v in formula for v in variables)
        names_law = law and law["law_in_steps"][number] != "no"
        (right if is_right or names_law else wrong).append(name)
    return right, wrong


def text_of(learn: Json, stderr: str) -> str:
    """What `learn` says, in lower case, without what names nothing that was found."""
    said = {key: value for key, value in learn.items() if key not in words.LEFT_UNREAD}
    return (json.dumps(said, ensure_ascii=False) + "\n" + stderr).lower()


def looked_at(answers: Json) -> str:
    """What `inspect` finds wrong, in lower case."""
    inspect = (answers.get("inspect") or {}).get("answer") or {}
    checks = [check for check in inspect.get("checks") or [] if not check["ok"]]
    faults = (inspect.get("setup") or {}).get("faults")
    return json.dumps([faults, checks, inspect.get("warnings")], ensure_ascii=False).lower()


def near(moment: tuple[str, float], events: list[Json]) -> bool:
    """Whether it is near an event of that run, or while that lasts."""
    run, at = moment
    own = [one for one in events if one["run"] == run]
    begins = [one["since_s"] if "since_s" in one else one["time_s"] for one in own]
    return any(
        since - NEAR_S <= at <= one["time_s"] + NEAR_S
        for since, one in zip(begins, own, strict=True)
    )


def jumps(learn: Json, stderr: str, truth: Json) -> Json:
    """Jumps that were named, and moments that were named without a reason."""
    said = words.moments(learn) + words.moments(stderr)
    known = truth["jumps"] + truth["corrections"]
    for bad in (truth["glitches"], truth["far_poses"]):
        known += [{"run": run, "time_s": at} for run, times in bad.items() for at in times]
    named = sum(
        any(run == one["run"] and abs(at - one["time_s"]) <= NEAR_S for run, at in said)
        for one in truth["jumps"]
    )
    invented = sum(not near(moment, known) for moment in said)
    return {"there": len(truth["jumps"]), "named": named, "invented": invented}


def judged(answers: Json, truth: Json, truth_leaves_m: float) -> Json:
    """Everything about one world."""
    learn = answers["learn"]["answer"] or {}
    stderr = answers["learn"]["stderr"]
    text = text_of(learn, stderr)
    law = naming.named_law(answers, truth, setting_in(truth)) if hides_law(truth) else {}
    right, wrong = additions(learn, truth, law)
    steps = learn.get("steps") or []
    last = steps[-1] if steps else {}
    models = ((answers.get("compare") or {}).get("answer") or {}).get("models") or [{}]
    compared = (models[0].get("along") or {}).get("rmse_m")
    found: Json = {
        "verdict": learn.get("verdict") or ("timeout" if stopped(answers, "learn") else "refused"),
        "ratios": ratios(learn, truth),
        "delay": delay(learn, truth),
        "faults": {one: words.named(one, text) for one in words.as_one(truth["faults"])},
        "faults_inspected": {
            one: words.named(one, looked_at(answers)) for one in words.as_one(truth["faults"])
        },
        "jumps": jumps(learn, stderr, truth),
        "added_right": right,
        "added_wrong": wrong,
        "left_out_m": last.get("heldout_rmse_m"),
        "truth_leaves_m": truth_leaves_m,
        "learn_rmse_m": last.get("rmse_m"),
        "compare_rmse_m": compared,
    }
    if law:
        found |= law | {"law": law_of(truth), "explained": found["verdict"]}
        left = found["left_out_m"]
        found["left_out_by_truth"] = left / truth_leaves_m if left else None
    found["problems"] = problems(found, answers, truth)
    return found


def stopped(answers: Json, verb: str) -> bool:
    """Whether a command ran out of time."""
    return bool(verb in answers and answers[verb]["exit"] is None)


def problems(found: Json, answers: Json, truth: Json) -> list[tuple[int, str]]:
    """What is wrong, each with a weight: 3 is wrong with confidence or no answer at all."""
    sure = found["verdict"] == words.EXPLAINED
    return [
        *broken(answers),
        *wrong_numbers(found, sure and not has_law(truth)),
        *wrong_names(found, sure),
        *wrong_verdict(found, sure, truth),
    ]


def has_law(truth: Json) -> bool:
    """Whether a law is at work that E_d, E_b and E_s may rightly take up where it does not show."""
    return hides_law(truth) or any(truth["numbers"]["laws"][key] for key in words.LAWS)


def hides_law(truth: Json) -> bool:
    """Whether a law is at work that no catalogue lists."""
    return bool(truth["numbers"]["laws"].get("law_kind"))


def law_of(truth: Json) -> str:
    """A law that no catalogue lists, in a few words."""
    laws = truth["numbers"]["laws"]
    return f"{laws['law_acts_on']} per {laws['law_per']}: {laws['law_kind']}"


def broken(answers: Json) -> list[tuple[int, str]]:
    """Commands that ended as no command should."""
    found = []
    for verb, done in answers.items():
        if done["exit"] is None:
            found.append((3, f"{verb} timed out"))
        elif done["exit"] not in (0, 1, 3) or "panicked" in done["stderr"]:
            found.append((3, f"{verb} ended with {done['exit']}"))
    return found


def wrong_numbers(found: Json, sure: bool) -> list[tuple[int, str]]:
    """Numbers that are off by more than they say."""
    wrong = []
    for name, off in found["ratios"].items():
        if off and abs(off["standard_errors"]) > ERRORS and abs(off["said"] - off["true"]) > SMALL:
            text = f"{name} {off['said']:.5f}, truly {off['true']:.5f}"
            wrong.append((3 if sure else 1, f"{text} ({off['standard_errors']:+.0f} se)"))
    late = found["delay"]
    if late and not late["within"]:
        said = "none" if late["said"] is None else f"{1e3 * late['said']:.1f} ms"
        wrong.append((2 if sure else 1, f"delay {said}, truly {1e3 * late['true']:.1f} ms"))
    compared, learnt = found["compare_rmse_m"], found["learn_rmse_m"]
    if compared and learnt and abs(compared - learnt) > AGREES * learnt:
        text = f"compare leaves {1e3 * compared:.1f} mm, learn {1e3 * learnt:.1f} mm"
        wrong.append((1, text))
    return wrong


def wrong_names(found: Json, sure: bool) -> list[tuple[int, str]]:
    """Troubles without a name, and names without a trouble."""
    wrong = [
        (3 if sure else 2, f"{fault} not named")
        for fault, said in found["faults"].items()
        if not said
    ]
    wrong += [(2 if sure else 1, f"added {name}") for name in found["added_wrong"]]
    events = found["jumps"]
    if events["named"] < events["there"]:
        text = f"{events['named']} of {events['there']} jumps named"
        wrong.append((2 if sure else 1, text))
    if events["invented"]:
        wrong.append((1, f"{events['invented']} moments named where nothing happened"))
    return wrong


def wrong_verdict(found: Json, sure: bool, truth: Json) -> list[tuple[int, str]]:
    """A verdict that is not right."""
    is_fault = truth["faults"] or truth["world"] in words.UNSTEADY or truth["jumps"]
    if found["verdict"] == "refused":
        return [] if is_fault and all(found["faults"].values()) else [(2, "refused")]
    wrong = []
    if hides_law(truth):
        if found["law_right"] == "no":
            wrong.append((3 if sure else 2, f"law not named: {found['law']}"))
        is_fault = True  # Something is missing, and no verdict but `explained` is wrong.
    left, best = found["left_out_m"], found["truth_leaves_m"]
    if left and left > WORSE * best and left > best + WORSE_M:
        text = f"leaves {1e3 * left:.1f} mm, the truth {1e3 * best:.1f} mm"
        wrong.append((3 if sure else 1, text))
    if not sure and not is_fault and found["verdict"] not in ("timeout", "not_enough_data"):
        wrong.append((2, found["verdict"]))
    return wrong
