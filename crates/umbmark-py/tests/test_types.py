"""Types as the checkers of users see them: complete, and clean on a script as users write it."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).parent / "test_user_script.py"


def pyright(folder: Path, *flags: str) -> dict[str, Any]:
    """Give what pyright says of what is installed beside this interpreter."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    # It would ask the network whether there is a newer one.
    env = {**os.environ, "PATH": path, "PYRIGHT_PYTHON_IGNORE_WARNINGS": "1"}
    command = [sys.executable, "-m", "pyright", "--outputjson", *flags]
    run = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
    assert run.stdout.startswith("{"), run.stdout + run.stderr
    told: dict[str, Any] = json.loads(run.stdout)
    return told


def test_every_symbol_has_a_type(tmp_path: Path) -> None:
    """Types of other packages are theirs: those of NumPy and matplotlib are not complete."""
    told = pyright(tmp_path, "--verifytypes", "umbmark", "--ignoreexternal")["typeCompleteness"]
    lacking = {
        symbol["name"]: said["message"]
        for symbol in told["symbols"]
        for said in symbol["diagnostics"]
        # Defaults that the compiled module gives as "..." stand so in the stub.
        if "docstring" not in said["message"] and "default values" not in said["message"]
    }
    assert lacking == {}
    assert told["completenessScore"] == 1
    assert told["exportedSymbolCounts"]["withKnownType"] > 200


def test_a_script_of_a_user_is_clean_in_strict_mode(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    shutil.copy(SCRIPT, script)
    settings = {"include": [script.name], "typeCheckingMode": "strict", "pythonVersion": "3.11"}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    told = pyright(tmp_path)
    assert told["generalDiagnostics"] == []
    assert told["summary"]["filesAnalyzed"] == 1
    wrong = "\n\nsurprise: str = umbmark.score(made()).e_max_sys_m\n"
    script.write_text(script.read_text() + wrong)
    (said,) = pyright(tmp_path)["generalDiagnostics"]
    assert said["rule"] == "reportAssignmentType"
