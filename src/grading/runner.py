"""Asks one submission, in a process of its own: `runner.py PLAN`.

The plan (JSON) names the folder of cases, where answers and the log go, the limits, and the functions that are asked, component by
component. Limits come first, before anything of the submission runs. What becomes of each component is a line of the log (JSON).
"""

import ast
import functools
import importlib.util
import inspect
import json
import os
import sys
import tokenize
from pathlib import Path

SKIPPED = {"__pycache__", "__MACOSX", "venv", "env", "node_modules", "site-packages"}


def limit(memory_mib, output_mib, seconds):
    """Hard limits, which nothing here can raise again. Returns those that the system refuses, by name."""
    try:
        import resource
    except ImportError:
        return ["memory", "size of files", "processor time"]
    refused = []
    for name, what, value in [
        ("memory", "RLIMIT_AS", memory_mib << 20),
        ("size of files", "RLIMIT_FSIZE", output_mib << 20),
        # The clock ends it; this ends what has escaped from it.
        ("processor time", "RLIMIT_CPU", 2 * int(seconds) + 5),
        ("number of processes", "RLIMIT_NPROC", 4096),
        ("core", "RLIMIT_CORE", 0),
    ]:
        try:
            kind = getattr(resource, what)
            hard = resource.getrlimit(kind)[1]
            most = value if hard == resource.RLIM_INFINITY else min(value, hard)
            resource.setrlimit(kind, (most, most))
        except (AttributeError, ValueError, OSError):
            refused += [name]
    return [name for name in refused if name != "core"]


def definitions(root):
    """name -> [(file, line, whether it is defined there and not imported)] over all files, and what is wrong with files."""
    found, broken = {}, {}
    files = [p for p in root.rglob("*.py") if not any(part in SKIPPED or part.startswith(".") for part in p.relative_to(root).parts)]
    for path in sorted(files, key=lambda p: (len(p.parts), str(p))):
        name = path.relative_to(root).as_posix()
        try:
            with tokenize.open(path) as file:
                tree = ast.parse(file.read())
        except SyntaxError as error:
            broken[name] = f"{name}, line {error.lineno}: {error.msg}"
            continue
        except (OSError, ValueError, UnicodeError, RecursionError, MemoryError) as error:
            broken[name] = f"{name}: {type(error).__name__}: {error}"
            continue
        for node in tree.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                found.setdefault(node.name, []).append((name, node.lineno, True))
            elif isinstance(node, (ast.Assign, ast.AnnAssign)):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                for target in targets:
                    if isinstance(target, ast.Name):
                        found.setdefault(target.id, []).append((name, node.lineno, True))
            elif isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    found.setdefault(alias.asname or alias.name, []).append((name, node.lineno, False))
    return found, broken


class Missing(Exception):
    """A function that the submission doesn't have."""


def located(wanted, found, broken):
    """File and line of `name` or `file.py:name`."""
    file, _, name = wanted.rpartition(":")
    places = [place for place in found.get(name, []) if file in ("", place[0])]
    own = [place for place in places if place[2]] or places
    # In one file the last definition is the one that counts; of several files the one nearest to the top.
    last = {place[0]: place for place in own}
    depth = min((place.count("/") for place in last), default=0)
    nearest = [place for at, place in last.items() if at.count("/") == depth]
    if len(nearest) > 1:
        raise Missing(f"{name} is defined in {' and in '.join(place[0] for place in nearest)}: keep one")
    if nearest:
        return nearest[0][0], nearest[0][1], name
    unread = [what for at, what in broken.items() if file in ("", at)]
    if unread:
        raise Missing(f"no function {name}: Python can't read {'; '.join(unread)}")
    raise Missing(f"no function {name}" + (f" in {file}" if file else ""))


def load(root, file, modules):
    """The module that a file is, run once."""
    if file not in modules:
        path = root / file
        for folder in (str(root), str(path.parent)):
            if folder not in sys.path:
                sys.path.insert(0, folder)
        name = path.stem if path.stem not in sys.modules else f"submission_{path.stem}"
        spec = importlib.util.spec_from_file_location(name, path)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        modules[file] = module
    return modules[file]


def renamed(function, names):
    """The same function with parameters as the contract calls them."""
    if not names:
        return function
    back = {theirs: own for own, theirs in names.items()}
    signature = inspect.signature(function)

    @functools.wraps(function)
    def asked(**given):
        return function(**{back.get(name, name): x for name, x in given.items()})

    asked.__signature__ = signature.replace(
        parameters=[p.replace(name=names.get(p.name, p.name)) for p in signature.parameters.values()]
    )
    return asked


def ask(plan, part, found, broken, modules, say):
    """Asks the functions of one component. Returns what becomes of its rows, and where the functions are."""
    from candidate import run

    functions, places, missing = {}, {}, None
    for keyword, wanted in part["functions"].items():
        try:
            file, line, name = located(wanted, found, broken)
        except Missing as what:
            if keyword not in part["optional"]:
                raise
            missing = what
            continue
        say(component=part["component"], doing=f"importing {file}")
        function = getattr(load(Path.cwd(), file, modules), name)
        functions[keyword] = renamed(function, part["parameters"].get(keyword, {}))
        places[keyword] = {"file": file, "line": line, "name": name}
    if not functions:
        raise missing
    say(component=part["component"], doing=f"running {', '.join(place['name'] for place in places.values())}")
    return run(plan["cases"], plan["answers"], **functions), places


def main(plan):
    """Answers everything that the plan asks for."""
    refused = limit(plan["memory_mib"], plan["output_mib"], plan["timeout_s"])
    log = open(plan["log"], "a", encoding="utf-8")  # noqa: SIM115

    def say(**line):
        log.write(json.dumps(line) + "\n")
        log.flush()

    if plan.get("probe"):
        import numpy

        wheel = importlib.util.find_spec("nerf_oracle") is not None
        writable = [folder for folder in plan["outside"] if os.access(folder, os.W_OK)]
        say(python=sys.version.split()[0], numpy=numpy.__version__, refused=refused, wheel=wheel, writable=writable)
        return
    import candidate  # noqa: F401

    # The reference may be installed here; the student is asked, not it.
    sys.modules["nerf_oracle"] = None
    found, broken = definitions(Path.cwd())
    modules = {}
    for part in plan["components"]:
        component = part["component"]
        try:
            outcomes, places = ask(plan, part, found, broken, modules, say)
            say(component=component, outcomes=outcomes, places=places)
        except Missing as what:
            say(component=component, failed=str(what))
        except SystemExit as what:
            say(component=component, failed=f"it ended the program by itself: SystemExit({what.code!r})")
        except Exception as error:  # noqa: BLE001
            text = str(error) if type(error).__module__ == "candidate" else f"{type(error).__name__}: {error}"
            say(component=component, failed=text)
    say(done=True)


if __name__ == "__main__":
    here = Path(__file__).resolve().parent
    sys.path[0] = str(here)
    main(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    # Threads of the submission's own don't keep it.
    sys.stdout.flush()
    os._exit(0)
