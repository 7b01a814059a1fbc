"""Judges folders of answers: a line for each row, and how many passed."""

import json
import subprocess
from collections import Counter


def judged(program, cases, answers):
    """Writes ANSWERS/(cases)/(candidate).txt, the judge's page, for each candidate. Exit 0: judged, whatever the verdicts."""
    count, others = Counter(), []
    for folder in cases:
        for candidate in sorted(path for path in (answers / folder.name).glob("*") if path.is_dir()):
            command = [program, "judge", folder, candidate, "-q"]
            page = subprocess.run(command, capture_output=True, text=True, check=False)
            candidate.with_name(candidate.name + ".txt").write_text(page.stdout + page.stderr, encoding="utf-8")
            told = subprocess.run([*command, "--json"], capture_output=True, text=True, check=False)
            if not told.stdout.startswith("{"):
                others.append(f"{folder.name} {candidate.name}: {told.stderr.strip()}")
                continue
            for row in json.loads(told.stdout)["components"]:
                if row["verdict"] == "unsupported":
                    continue
                count[folder.name, candidate.name, row["verdict"] == "pass"] += 1
                if row["verdict"] != "pass":
                    others.append(f"{folder.name:8} {candidate.name:32} {row['name']} {row['kind']}: {row['verdict']}")
    for folder, name in dict.fromkeys(key[:2] for key in count):
        passed = count[folder, name, True]
        print(f"{folder:8} {name:32} {passed} of {passed + count[folder, name, False]} rows pass")
    print("\nNot a pass:" if others else "\nAll pass.", *others, sep="\n")
    return 0
