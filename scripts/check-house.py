#!/usr/bin/env python3
"""Checks names, doc comments and imports of the Rust sources against the lists in scripts/house.toml.

    scripts/check-house.py             fails with one line a violation: file:line, rule, correction
    scripts/check-house.py --all       lists tolerated violations, too
    scripts/check-house.py --shrink    removes entries of the baseline that no longer occur

Rules: 1. the first line of a doc comment opens with a noun or a third-person verb; 2. no definition has a banned name;
3. no crate has two types of one name; 4. imports have no circles, neither between files nor between the modules of one folder;
5. crates depend downward only.
Violations in the tables [baseline.*] are tolerated; an entry that no longer occurs fails the check, so that they only shrink.
"""

import re
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = ROOT / "scripts" / "house.toml"
HOUSE = tomllib.loads(LIST.read_text())

# ---------------------------------------------------------------- sources

TOKEN = re.compile(
    r"""(?P<doc>//[/!][^\n]*)|//[^\n]*|/\*.*?\*/|b?r(?P<h>\#*)".*?"(?P=h)|b?"(?:\\.|[^"\\])*"|'(?:\\[^\n]{1,10}?|[^\\'\n])'""",
    re.S,
)
SPACES = re.compile(r"[^\n]")
TEST_ITEM = re.compile(r"#\[cfg\((?:all\()?test\b[^\]]*\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?")


def blank(text):
    return SPACES.sub(" ", text)


def end_of_item(code, begin):
    """Index behind the item at `begin`: its semicolon or its closing brace."""
    depth = 0
    for match in re.compile(r"[{};]").finditer(code, begin):
        if match[0] == "{":
            depth += 1
        elif match[0] == "}":
            depth -= 1
            if depth == 0:
                return match.end()
        elif depth == 0:
            return match.end()
    return len(code)


class Source:
    """One file: its code without comments, texts and items for tests."""

    def __init__(self, path):
        self.path = path
        self.name = path.relative_to(ROOT).as_posix()
        text = path.read_text()
        self.docs = [(text.count("\n", 0, m.start()) + 1, m[0]) for m in TOKEN.finditer(text) if m["doc"]]
        code = TOKEN.sub(lambda m: blank(m[0]), text)
        self.test_modules = set()
        for match in TEST_ITEM.finditer(code):
            end = end_of_item(code, match.end())
            if module := re.match(r"mod\s+(\w+)\s*;", code[match.end() : end]):
                self.test_modules.add(module[1])
            code = code[: match.start()] + blank(code[match.start() : end]) + code[end:]
        self.code = code
        self.text = text
        inline = re.finditer(r"\bmod\s+\w+\s*\{", code)
        self.inline_modules = [(m.start(), end_of_item(code, m.end() - 1)) for m in inline]

    def relative(self, path, index):
        """A path within an inline module, as seen from the file's own module."""
        depth = sum(begin < index < end for begin, end in self.inline_modules)
        while depth and path[0] == "super":
            path, depth = path[1:] or ["self"], depth - 1
        return path

    def line(self, index):
        return self.code.count("\n", 0, index) + 1


class Crate:
    """A package of the workspace and the tree of its modules: path as a tuple of names -> Source."""

    def __init__(self, manifest):
        table = tomllib.loads(manifest.read_text())
        folder = manifest.parent
        self.folder = folder.relative_to(ROOT).as_posix()
        self.package = table["package"]["name"]
        self.manifest = manifest
        tables = [table, *table.get("target", {}).values()]
        self.needs = {name for t in tables for name in t.get("dependencies", {})}
        self.modules = {}
        roots = [table.get("lib", {}).get("path", "src/lib.rs")] + [b.get("path") for b in table.get("bin", [])]
        for number, root in enumerate(roots):
            if root and (folder / root).exists():
                self.add(folder / root, ("crate",) if number == 0 else (f"bin{number}",))

    def add(self, path, name):
        source = Source(path)
        self.modules[name] = source
        is_folder = len(name) == 1 or path.name == "mod.rs"
        base = path.parent if is_folder else path.parent / path.stem
        for match in re.finditer(r"\bmod\s+(\w+)\s*;", source.code):
            child = match[1]
            attribute = re.search(r'#\[path = "([^"]+)"\]\s*(?:pub(?:\([^)]*\))?\s+)?$', source.text[: match.start()])
            files = [path.parent / attribute[1]] if attribute else [base / f"{child}.rs", base / child / "mod.rs"]
            is_test = child in source.test_modules or re.search(r"(^|_)tests?(_|$)", child) is not None
            for file in files:
                if file.exists() and not is_test:
                    self.add(file, (*name, child))


def crates():
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]
    return [Crate(ROOT / member / "Cargo.toml") for member in (".", *workspace["members"])]


# ---------------------------------------------------------------- imports


def use_paths(tree):
    """Paths of a use tree: `a::{b, c as d}` -> (["a", "b"], "b"), (["a", "c"], "d")."""
    tree = tree.strip()
    if "{" not in tree:
        path, _, alias = tree.partition(" as ")
        parts = [part.strip() for part in path.split("::") if part.strip()]
        if parts and parts[-1] == "self":
            parts.pop()
        if parts:
            yield parts, alias.strip() or parts[-1]
        return
    open_, close = tree.index("{"), tree.rindex("}")
    head, depth, begin, inner = tree[:open_], 0, 0, tree[open_ + 1 : close] + ","
    for i, letter in enumerate(inner):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            if inner[begin:i].strip():
                yield from use_paths(head + inner[begin:i])
            begin = i + 1


USE = re.compile(r"\b(?P<pub>pub(?:\([^)]*\))?\s+)?use\s+(?P<tree>[^;]+);")
INLINE = re.compile(r"(?<!in )(?<![\w:])(?:crate|super|self)(?:::\w+)+")


class Imports:
    """Arrows between the files of one crate, re-exports resolved: (from, to) -> line."""

    def __init__(self, crate):
        self.modules = crate.modules
        self.children = defaultdict(set)
        for name in self.modules:
            self.children[name[:-1]].add(name[-1])
        self.uses = {name: list(self.read_uses(name, source)) for name, source in self.modules.items()}
        self.names = {
            module: {alias: path for path, alias, _, _ in uses if alias not in ("*", "_")} for module, uses in self.uses.items()
        }
        self.arrows = {}
        for module, source in self.modules.items():
            for path, alias, line, is_public in self.uses[module]:
                if not is_public:
                    self.arrow(module, path, line)
            inline = [(m[0], m.start()) for m in INLINE.finditer(source.blanked)]
            local = self.children[module] | {a for a, p in self.names[module].items() if self.module_at(module, p)}
            if local:
                prefix = re.compile(r"(?<![\w:])(?:" + "|".join(map(re.escape, sorted(local))) + r")::\w+(?:::\w+)*")
                inline += [(m[0], m.start()) for m in prefix.finditer(source.blanked)]
            for path, index in inline:
                self.arrow(module, source.relative(path.split("::"), index), source.line(index))

    def read_uses(self, module, source):
        code = source.code
        for match in USE.finditer(code):
            for path, alias in use_paths(match["tree"]):
                yield source.relative(path, match.start()), alias, source.line(match.start()), match["pub"] is not None
        source.blanked = USE.sub(lambda m: blank(m[0]), code)

    def absolute(self, module, path):
        if path[0] == "crate":
            return (module[0] if ("crate",) not in self.modules else "crate", *path[1:])
        base, rest = module, list(path)
        if rest[0] == "self":
            rest.pop(0)
        elif rest[0] == "super":
            while rest and rest[0] == "super":
                base, rest = base[:-1], rest[1:]
        elif rest[0] not in self.children[module]:
            known = self.names[module].get(rest[0])
            if known is None or known[0] == rest[0]:
                return None
            resolved = self.absolute(module, known)
            return resolved and (*resolved, *rest[1:])
        return (*base, *rest)

    def module_at(self, module, path):
        found = self.absolute(module, path)
        return found if found in self.modules else None

    def target(self, module, path, depth=0):
        """The module that defines what a path names."""
        absolute = self.absolute(module, path)
        if not absolute:
            return None
        length = len(absolute)
        while length and absolute[:length] not in self.modules:
            length -= 1
        owner = absolute[:length]
        if length == 0:
            return None
        if length == len(absolute) or depth > 8:
            return owner
        known = self.names[owner].get(absolute[length])
        if known and (found := self.target(owner, known, depth + 1)):
            return found
        return owner

    def arrow(self, module, path, line):
        target = self.target(module, path)
        # A path to a folder's own head only: what is taken from it is seen where it is used.
        if target and target != module:
            self.arrows.setdefault((module, target), line)


def components(arrows):
    """Strongly connected components of more than one node (Tarjan)."""
    graph = defaultdict(list)
    for a, b in arrows:
        graph[a].append(b)
    index, low, stack, on_stack, found = {}, {}, [], set(), []
    sys.setrecursionlimit(10000)

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        on_stack.add(node)
        for other in graph[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in on_stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            component = set()
            while node not in component:
                component.add(stack.pop())
            on_stack.difference_update(component)
            if len(component) > 1:
                found.append(component)

    for node in list(graph):
        if node not in index:
            visit(node)
    return found


def shortest_circle(component, arrows):
    best = None
    for start in sorted(component):
        seen, queue = {start: None}, [start]
        for node in queue:
            for a, b in arrows:
                if a == node and b in component:
                    if b == start:
                        circle = [b]
                        while node is not None:
                            circle.append(node)
                            node = seen[node]
                        if best is None or len(circle) < len(best):
                            best = circle[::-1]
                        queue = []
                        break
                    if b not in seen:
                        seen[b] = node
                        queue.append(b)
            if not queue:
                break
    return best


def circles(crate):
    """(folder, members, message) of each circle between files, and between the modules of one folder."""
    imports = Imports(crate)
    levels = [("files", {pair: (pair, line) for pair, line in imports.arrows.items()})]
    folders = defaultdict(dict)
    for (a, b), line in imports.arrows.items():
        common = 0
        while common < min(len(a), len(b)) and a[common] == b[common]:
            common += 1
        if common < len(a) and common < len(b):
            folders[a[:common]].setdefault((a[: common + 1], b[: common + 1]), ((a, b), line))
    levels += [("modules", pairs) for pairs in folders.values()]
    reported = []
    for level, pairs in levels:
        for component in components(pairs):
            circle = shortest_circle(component, pairs)
            steps = []
            for a, b in zip(circle, circle[1:]):
                (source, _), line = pairs[a, b]
                steps.append(f"{imports.modules[source].name}:{line} imports {'::'.join(b[1:]) or 'the crate root'}")
            members = {"::".join(node[1:]) or "lib" for node in component}
            if any(members == other for _, other, _ in reported):
                continue
            text = f"circle of {len(members)} {level}: " + ", ".join(steps) + "; move what both need to a file below them"
            reported.append((crate.folder, members, text))
    return reported


# ---------------------------------------------------------------- names and docs

DEFINITION = re.compile(
    r"\b(?:(?P<type>struct|enum|trait|type|union)\s+(?P<typename>[A-Z]\w*)|fn\s+(?P<fn>\w+)"
    r"|(?:const|static)\s+(?:mut\s+)?(?P<const>[A-Z]\w*)\s*:|mod\s+(?P<mod>\w+))"
)
FIELD = re.compile(r"^[ \t]*(?:pub(?:\([^)]*\))?\s+)?(\w+)\s*:\s*[^,;=()]+,?$", re.M)
STRUCT = re.compile(r"\b(?:struct|union)\s+\w+[^;{(]*\{")
KINDS = {"typename": "types", "fn": "functions", "const": "constants", "mod": "modules", "field": "fields"}


def definitions(source):
    for match in DEFINITION.finditer(source.code):
        kind = next(kind for kind in ("typename", "fn", "const", "mod") if match[kind])
        yield KINDS[kind], match[kind], source.line(match.start(kind))
    for match in STRUCT.finditer(source.code):
        end = end_of_item(source.code, match.end() - 1)
        body = source.code[match.end() : end]
        for field in FIELD.finditer(body):
            yield "fields", field[1], source.line(match.end() + field.start(1))


def banned(kind, name):
    """The preferred term for a banned name; None for any other."""
    table = HOUSE["names"].get(kind, {})
    if name in table:
        return table[name]
    for pattern, preferred in HOUSE["patterns"].get(kind, {}).items():
        if re.fullmatch(pattern, name):
            return preferred
    return None


def openings(source):
    pattern = re.compile(r"//[/!] (" + "|".join(HOUSE["openings"]["banned"]) + r")\b")
    previous = (0, "")
    for line, doc in source.docs:
        continues = previous[0] == line - 1 and previous[1][:3] == doc[:3]
        if not continues and (match := pattern.match(doc)):
            yield line, match[1]
        previous = (line, doc)


def homonyms(crate):
    """(name, message) of each type that is defined in more than one file of a crate."""
    places = defaultdict(dict)
    for source in crate.modules.values():
        for match in re.finditer(r"\b(?:struct|enum|trait|union)\s+([A-Z]\w*)", source.code):
            places[match[1]].setdefault(source.name, source.line(match.start()))
    for name, files in places.items():
        if len(files) > 1 and name not in HOUSE["homonyms"].get(crate.folder, []):
            first, *others = (f"{file}:{line}" for file, line in files.items())
            yield name, f"{first}: the type '{name}' is another one in {', '.join(others)}: one name means one thing in a crate"


# ---------------------------------------------------------------- crates


def misplaced(all_crates):
    layers = {package: level for level, packages in enumerate(HOUSE["layers"]["order"]) for package in packages}
    lab = set(HOUSE["layers"]["lab"])
    may_use_lab = lab | set(HOUSE["layers"]["may_use_lab"])
    known = {crate.package for crate in all_crates}
    for crate in all_crates:
        text = crate.manifest.read_text().splitlines()
        for need in sorted(crate.needs & known):
            line = next((i for i, row in enumerate(text, 1) if row.startswith(need)), 1)
            place = f"{crate.manifest.relative_to(ROOT).as_posix()}:{line}"
            arrow = f"{crate.package} -> {need}"
            if need in lab:
                if crate.package not in may_use_lab:
                    yield arrow, f"{place}: {arrow}: a crate of the product depends on lab/; register from lab/ instead"
            elif crate.package in layers and need in layers and layers[need] > layers[crate.package]:
                yield arrow, f"{place}: {arrow}: runs against the layout; move what is needed to a lower crate"
        if crate.package not in layers and crate.package not in lab:
            yield crate.package, f"scripts/house.toml:1: [layers] does not list {crate.package}"


# ---------------------------------------------------------------- the check


def main():
    shrink = "--shrink" in sys.argv
    is_all = "--all" in sys.argv
    empty = {"openings": {}, "names": {}, "circles": [], "crates": []}
    baseline = empty if is_all else HOUSE["baseline"]
    errors, left = [], {"openings": defaultdict(int), "names": defaultdict(set), "circles": [], "crates": []}
    all_crates = crates()
    allowed = [set(entry["files"]) for entry in HOUSE.get("recursive", [])]
    seen = set()
    doc_errors, name_errors = defaultdict(list), defaultdict(list)
    for crate in all_crates:
        for module, source in crate.modules.items():
            if source.name in seen:
                continue
            seen.add(source.name)
            for line, word in openings(source):
                doc_errors[crate.folder].append(
                    f"{source.name}:{line}: a doc comment opens with '{word}'; begin with a noun phrase, a third-person verb or 'True if'"
                )
            for kind, name, line in definitions(source):
                if preferred := banned(kind, name):
                    name_errors[crate.folder, f"{kind[:-1]} {name}"].append(
                        f"{source.name}:{line}: the {kind[:-1]} '{name}': say {preferred}"
                    )
        for name, text in homonyms(crate):
            name_errors[crate.folder, f"homonym {name}"].append(text)
        for folder, members, text in circles(crate):
            if any(members <= other for other in allowed):
                continue
            entry = next((e for e in baseline["circles"] if e[0] == folder and members <= set(e[1:])), None)
            left["circles"].append([folder, *sorted(members)])
            if entry is None:
                errors.append(f"{text} [{folder}: {', '.join(sorted(members))}]")
    for folder, found in doc_errors.items():
        left["openings"][folder] = len(found)
        if len(found) > baseline["openings"].get(folder, 0):
            errors += found
    for (folder, name), found in name_errors.items():
        left["names"][folder].add(name)
        if name not in baseline["names"].get(folder, []):
            errors += found
    for arrow, text in misplaced(all_crates):
        left["crates"].append(arrow)
        if arrow not in baseline["crates"]:
            errors.append(text)

    stale = []
    for folder, count in baseline["openings"].items():
        if left["openings"].get(folder, 0) < count:
            stale.append(f"openings of {folder}: {left['openings'].get(folder, 0)} are left of {count}")
    for folder, names in baseline["names"].items():
        gone = [name for name in names if name not in left["names"].get(folder, ())]
        if gone:
            stale.append(f"names of {folder}: {', '.join(gone)}")
    for entry in baseline["circles"]:
        members = {m for other in left["circles"] if other[0] == entry[0] and set(other[1:]) <= set(entry[1:]) for m in other[1:]}
        if members != set(entry[1:]):
            stale.append(f"circle of {entry[0]}: {', '.join(sorted(set(entry[1:]) - members))}")
    stale += [f"arrow {arrow}" for arrow in baseline["crates"] if arrow not in left["crates"]]
    if shrink and stale:
        write_baseline(baseline, left, grow="--grow" in sys.argv)
        stale = []
    elif "--grow" in sys.argv:
        write_baseline(baseline, left, grow=True)
        return
    errors += [f"scripts/house.toml: mended, remove it from the baseline (scripts/check-house.py --shrink): {text}" for text in stale]
    for error in errors:
        print(error)
    if errors:
        sys.exit(f"{len(errors)} violations of scripts/house.toml")


def write_baseline(old, left, grow):
    head = LIST.read_text().partition("\n[baseline]\n")[0]
    rows = [head, "[baseline]", "# Dependencies between crates."]
    arrows = [a for a in left["crates"] if grow or a in old["crates"]]
    rows.append("crates = [" + ", ".join(f'"{arrow}"' for arrow in arrows) + "]")
    rows.append("# Folder of the crate, and the modules of a circle.")
    rows.append("circles = [")
    for entry in left["circles"]:
        if grow or any(e[0] == entry[0] and set(entry[1:]) <= set(e[1:]) for e in old["circles"]):
            rows.append("    [" + ", ".join(f'"{word}"' for word in entry) + "],")
    rows += ["]", "", "# Number of doc comments a crate.", "[baseline.openings]"]
    for folder in sorted(left["openings"]):
        count = left["openings"][folder]
        count = count if grow else min(count, old["openings"].get(folder, 0))
        if count:
            rows.append(f'"{folder}" = {count}')
    rows += ["", "# Definitions a crate.", "[baseline.names]"]
    for folder in sorted(left["names"]):
        names = sorted(n for n in left["names"][folder] if grow or n in old["names"].get(folder, []))
        if names:
            rows.append(f'"{folder}" = [')
            rows += [f'    "{name}",' for name in names]
            rows.append("]")
    LIST.write_text("\n".join(rows) + "\n")


main()
