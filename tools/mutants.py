"""Mutation testing of the oracle files, each against its own folder's tests: writes tests/pages/MUTANTS.md.

    cargo install cargo-mutants --locked
    python tools/mutants.py                 # everything, a few minutes
    python tools/mutants.py src/ray/mod.rs  # these files; the other rows of the page stay

cargo-mutants lists the mutants. All of a file are built together (tools/mutants/), each switched on by the environment variable
MUTANT; those that don't fit in there (in constants, or of a type that the compiler refuses) are built one by one.

A change to one line would rebuild the whole crate, harness and program included. So the oracle files and their tests are copied
to a crate of their own: bounds, cases, mistakes and registry rows, which no oracle file uses, become empty files. Tests that name
them are left out, so what is counted as killed is killed by closed forms, properties and hard cases alone.
"""

import argparse
import hashlib
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "tests" / "pages" / "MUTANTS.md"
# Files of a component that are neither oracle nor its tests.
AROUND = re.findall(r'"(\w+)"', re.search(r"AROUND: .*?\[(.*?)\];", (ROOT / "tests/architecture/around.rs").read_text(), re.S)[1])
SECONDS = 60  # a mutant whose tests take longer loops for ever

# What is added to the crate: which mutant is switched on.
SWITCH = """
pub fn mutant(id: usize) -> bool {
    static ON: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    *ON.get_or_init(|| std::env::var("MUTANT").ok().and_then(|m| m.parse().ok()).unwrap_or(usize::MAX)) == id
}
"""

# Survivors that no test can kill, and why. A survivor that isn't here is a hole in the tests.
EQUIVALENT = json.loads((ROOT / "tools" / "mutants.json").read_text())


def copy_folder(folder, target, tested):
    """Oracle files and tests as they are; what stands around them empty, unless the tests need the fast variant."""
    tests = folder / "tests.rs"
    text = tests.read_text() if tests.exists() else ""
    fast = "fast::" in text
    for path in sorted(folder.rglob("*.rs")):
        inside = path.relative_to(folder)
        first = inside.parts[0].removesuffix(".rs")
        to = target / "src" / folder.name / inside
        if first in AROUND and not (fast and first == "fast"):
            if len(inside.parts) > 1:
                continue
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_text("")
        elif inside.parts == ("tests.rs",) and ("component::" in text or not tested):
            to.write_text("")
        else:
            to.parent.mkdir(parents=True, exist_ok=True)
            # What stays out is not shown elsewhere either; lines keep their numbers, by which mutants are found.
            to.write_text(re.sub(r"(?m)^pub use (judge|bound)::.*$", "", path.read_text()))


def copy_module(name, target, tested):
    """A module of the crate: one file, a component's folder, or the few lines of the others that the oracle needs.

    Only `tested` ones keep their tests: the others' would be built with every mutant, and never run."""
    source, to = ROOT / "src" / name, target / "src" / name
    if source.with_suffix(".rs").exists():
        text = source.with_suffix(".rs").read_text()
        to.with_suffix(".rs").write_text(text if tested else text.split("#[cfg(test)]\nmod tests {")[0])
        if source.is_dir():
            shutil.copytree(source, to)
    elif name == "training":
        to.mkdir()
        shutil.copy(source / "reference.rs", to / "reference.rs")
        shutil.copytree(source / "reference", to / "reference", dirs_exist_ok=True)
        (to / "mod.rs").write_text("pub mod reference;\n")
    elif name == "contract":
        to.mkdir()
        shutil.copy(source / "testing.rs", to / "testing.rs")
        (to / "mod.rs").write_text("#[cfg(test)]\npub(crate) mod testing;\n")
    else:
        copy_folder(source, target, tested)


def make_crate(target, first):
    """The crate of the module `first` and of everything that it uses."""
    (target / "src").mkdir(parents=True)
    wanted, done = {first}, set()
    while wanted - done:
        name = min(wanted - done)
        helpers = f"crate::{name}::tests::" in "".join(path.read_text() for path in (ROOT / "src" / first).rglob("tests.rs"))
        copy_module(name, target, name == first or helpers)
        done.add(name)
        files = [target / "src" / f"{name}.rs", *(target / "src" / name).rglob("*.rs")]
        for file in files:
            code = re.sub(r"//.*", "", file.read_text()) if file.exists() else ""
            wanted |= {used for used in re.findall(r"crate::(\w+)", code) if used[0].islower()}
            wanted |= {used for group in re.findall(r"crate::\{(.*?)\};", code, re.S) for used in re.findall(r"(\w+)::", group)}
        wanted = {name for name in wanted if (ROOT / "src" / f"{name}.rs").exists() or (ROOT / "src" / name).is_dir()}
    lines = [f"pub mod {name};" for name in sorted(done)]
    lines += ["pub use error::{Error, Result};"] if "error" in done else []
    (target / "src/lib.rs").write_text("\n".join(lines) + "\n")
    manifest = (ROOT / "Cargo.toml").read_text()
    # The package and what it depends on: no features, programs, lints or profiles.
    sections = re.split(r"(?m)^(?=\[)", manifest)
    manifest = "".join(s for s in sections if s.startswith(("[package]", "[dependencies]", "[dev-dependencies]")))
    manifest = re.sub(r"(?m)^(default-run = .*|include = \[[^]]*\])\n", "", manifest).replace(", optional = true", "")
    for unused in ["clap", "gemm", "image", "indicatif", "npyz", "sha2", "zip", "tempfile", "half"]:
        manifest = re.sub(rf"(?m)^{unused} = .*\n", "", manifest)
    # Doctests would need the crate built twice.
    manifest += '\n[lib]\ndoctest = false\n\n[profile.dev]\ndebug = false\n[profile.dev.package."*"]\nopt-level = 1\n'
    (target / "Cargo.toml").write_text(manifest)
    shutil.copy(ROOT / "Cargo.lock", target / "Cargo.lock")


def tests_of(file):
    """The tests that must kill a file's mutants: those of its folder, or of the file itself."""
    parts = Path(file).with_suffix("").parts[1:]
    return "training::reference" if parts[0] == "training" else parts[0] + "::"


def build(target):
    """The crate's test program (none where it doesn't build), and what the compiler says."""
    cargo = [os.environ.get("CARGO", "cargo"), "test", "--lib", "--no-run", "--message-format", "json"]
    said = subprocess.run(cargo, cwd=target, capture_output=True, text=True, check=False)
    messages = [json.loads(line) for line in said.stdout.splitlines()]
    errors = [m["message"] for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"]
    programs = [m["executable"] for m in messages if m["reason"] == "compiler-artifact" and m.get("executable")]
    return (programs[-1] if programs and not errors else None), errors


def survives(program, target, file, mutant=None):
    """Whether the file's tests pass, with this mutant switched on."""

    def limit_memory():
        resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))

    switch = {} if mutant is None else {"MUTANT": str(mutant)}
    environment = os.environ | switch | {"CARGO_MANIFEST_DIR": str(target), "RUST_BACKTRACE": "0"}
    try:
        done = subprocess.run(
            [program, tests_of(file), "-q"],
            cwd=target,
            env=environment,
            capture_output=True,
            timeout=SECONDS,
            preexec_fn=limit_memory,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def together(target, file, mutants, tool):
    """A program with all mutants in it but those that it returns: those have to be built one by one."""
    source = target / file
    original, listed = source.read_text(), target / "mutants.json"
    (target / "original.rs").write_text(original)
    refused = set()
    while True:
        listed.write_text(json.dumps([m for m in mutants if m["id"] not in refused]))
        command = [tool, target / "original.rs", listed, source]
        missing = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        program, errors = build(target)
        if program is not None:
            program = shutil.copy(program, target / "together")
            source.write_text(original)
            return program, sorted(refused | set(missing))
        # The mutant in front of an error is the one that the compiler means.
        code, before = source.read_bytes(), len(refused)
        for span in (span for error in errors for span in error["spans"] if span["is_primary"] and span["file_name"] == file):
            found = re.findall(rb"crate :: mutant \((\d+)usize\)", code[: span["byte_start"]])
            refused |= {int(number) for number in found[-1:]}
        if len(refused) == before:
            sys.exit(f"{file}: its mutants don't build together: {errors[0]['rendered'] if errors else 'no message'}")


def run(target, file, cargo_mutants, tool):
    """Every mutant of one file: the row of its counts and survivors."""
    lib = target / "src/lib.rs"
    lib.write_text("#![allow(warnings)]\n" + lib.read_text() + SWITCH)
    command = [cargo_mutants, "mutants", "--list", "--json", "--no-config", "--file", file, "--dir", str(target)]
    mutants = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    mutants = [m | {"id": number} for number, m in enumerate(mutants)]
    program, apart = together(target, file, mutants, tool)
    if not survives(program, target, file):
        sys.exit(f"{file}: its tests fail without any mutant")
    counts = {"killed": 0, "viable": 0, "unviable": 0, "survivors": []}
    for mutant in mutants:
        alive = None
        if mutant["id"] not in apart:
            alive = survives(program, target, file, mutant["id"])
        elif (alone := one(target, file, mutant)) is not None:
            alive = survives(alone, target, file)
        counts["unviable" if alive is None else "viable"] += 1
        counts["killed"] += alive is False
        if alive:
            print(f"survives: {mutant['name']}", file=sys.stderr)
            # Without line and column: they move with every edit.
            counts["survivors"].append(re.sub(r"^(\S+?):\d+:\d+: ", r"\1: ", mutant["name"]))
    return counts


def one(target, file, mutant):
    """A program with this mutant written into the file; none where it doesn't build."""
    source = target / file
    original = source.read_text()
    lines = original.splitlines(keepends=True)

    def offset(place):
        return sum(map(len, lines[: place["line"] - 1])) + place["column"] - 1

    start, end = offset(mutant["span"]["start"]), offset(mutant["span"]["end"])
    source.write_text(original[:start] + mutant["replacement"] + original[end:])
    program, _ = build(target)
    source.write_text(original)
    return program


def page(rows, listed=()):
    """The page: counts by file, the survivors with their reasons, and the examined files that no run has reached."""
    text = "# Mutants\n\nWritten by `python tools/mutants.py`: every mutant that cargo-mutants lists for an oracle file, against "
    text += "the tests of its folder.\n\n"
    text += "| file | viable | killed | equivalent | survivors |\n|---|---|---|---|---|\n"
    total = [0, 0, 0, 0]
    survivors = []
    for file in sorted(rows):
        r = rows[file]
        equivalent = [name for name in r["survivors"] if name in EQUIVALENT]
        left = [name for name in r["survivors"] if name not in EQUIVALENT]
        survivors += r["survivors"]
        counts = [r["viable"], r["killed"], len(equivalent), len(left)]
        total = [a + b for a, b in zip(total, counts, strict=True)]
        current = (ROOT / file).exists() and hashlib.sha256((ROOT / file).read_bytes()).hexdigest() == r["sha256"]
        text += f"| {file}{'' if current else ' (before its last change)'} | {' | '.join(map(str, counts))} |\n"
    text += f"| all | {' | '.join(map(str, total))} |\n\n## Survivors\n\n"
    for name in survivors:
        text += f"* `{name}`: {EQUIVALENT.get(name, 'NOT EXPLAINED')}\n"
    text += "" if survivors else "None.\n"
    missing = [file for file in listed if file not in rows]
    return text + ("\n## Not run yet\n\n" + "".join(f"* {file}\n" for file in missing) if missing else "")


def read_rows():
    """Rows of the page as it is, so that a run of some files keeps the others."""
    state = PAGE.with_suffix(".json")
    return json.loads(state.read_text()) if state.exists() else {}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="oracle files (all where absent)")
    parser.add_argument("--tool", default="cargo-mutants", help="the cargo-mutants program")
    parser.add_argument("--work", type=Path, help="where the copy is made (a temporary folder)")
    args = parser.parse_args()
    work = args.work or Path(tempfile.mkdtemp())
    target = work / "crate"
    os.environ.setdefault("CARGO_TARGET_DIR", str(work / "target"))
    listed = subprocess.run(
        [args.tool, "mutants", "--list-files", "--dir", str(ROOT)], capture_output=True, text=True, check=True
    ).stdout.split()
    # Files that were renamed or deleted leave no row.
    rows = {file: row for file, row in read_rows().items() if file in listed}
    subprocess.run(["cargo", "build", "--quiet", "--locked", "--manifest-path", ROOT / "tools/mutants/Cargo.toml"], check=True)
    tool = Path(os.environ["CARGO_TARGET_DIR"]) / "debug/mutants-in-one"
    for file in args.files or listed:
        if file not in listed:
            sys.exit(f"{file}: not an examined file; expected one of: {' '.join(listed)}")
        shutil.rmtree(target, ignore_errors=True)
        make_crate(target, Path(file).with_suffix("").parts[1])
        found = run(target, file, args.tool, tool)
        print(f"{file}: {found['killed']} of {found['viable']} killed", file=sys.stderr)
        rows[file] = found | {"sha256": hashlib.sha256((ROOT / file).read_bytes()).hexdigest()}
        PAGE.with_suffix(".json").write_text(json.dumps(rows, indent=1) + "\n")
        PAGE.write_text(page(rows, listed))
    PAGE.write_text(page(rows, listed))


if __name__ == "__main__":
    main()
