"""The article says what the studies say, and cites what its bibliography has."""

import re
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
TEXT = (TOP / "paper" / "paper.md").read_text(encoding="utf-8")
STUDIES = TOP / "docs" / "studies"


def rows(heading: str) -> list[list[str]]:
    """The rows of the table that has this first heading."""
    table = TEXT.partition(f"\n| {heading} |")[2].partition("\n\n")[0]
    lines = table.splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_citation_is_in_the_bibliography_and_is_used() -> None:
    entries = re.findall(
        r"^@\w+\{(\w+),", (TOP / "paper" / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert set(re.findall(r"@([a-z]+\d{4}\w*)", TEXT)) == set(entries)


def test_calibrations_of_the_real_robot_are_those_of_the_study() -> None:
    study = (STUDIES / "optiodom.md").read_text(encoding="utf-8")
    found = rows("calibration")
    assert len(found) == 5
    for _, squares, circles, straights, all_m, all_deg in found:
        parts = [f"{length} mm, [0-9.]+ deg" for length in (squares, circles, straights)]
        line = r" \| ".join([*parts, f"{all_m} mm, {all_deg} deg"])
        assert re.search(rf"^\| both \|[^|]*\| {line} \|$", study, re.MULTILINE), line


def test_results_on_made_data_are_those_of_the_documentation() -> None:
    told = (TOP / "docs" / "diagnosis.md").read_text(encoding="utf-8")
    assert "80 of 84 sets, class right in all 80" in told
    assert "2 of 501 sets" in told
    assert "97.0 to 99.2 % of 600 sets" in told
    assert "40 of 42 sets" in told
    worlds = (STUDIES / "worlds.md").read_text(encoding="utf-8")
    assert "named by `learn` in 72 of 72" in worlds
    results = [row[2] for row in rows("data")]
    assert results == ["80, in all 80", "2", "97.0 to 99.2 %", "40", "72 of 72"]
    learners = (STUDIES / "general_learners.md").read_text(encoding="utf-8")
    for name, share in (
        ("Gaussian process", "1.84"),
        ("sparse regression", "3.22"),
        ("symbolic regression", "4.29"),
        ("umbmark", "1.03"),
    ):
        assert f"| {name} | {share} (" in learners, name
        assert share in TEXT, name
